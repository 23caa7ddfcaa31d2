# PyTorch and SciPy against our own fits on the same problems: PSNR of held-out samples over the time of solving, until it is a
# converged fit's but for 0.02 dB. SciPy, on a few of the problems, has no curve: what it takes is said.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1280,760 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,760 font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 0.5 : 0.8
curves = rows . '/curves.csv'
table = rows . '/peers.csv'
# Settings, and the solvers of each, in the order of the rows.
settings = ''
add(name) = strstrt(settings, '"' . name . '"') > 0 ? 0 : (settings = settings . ' "' . name . '"', 0)
stats table using (add(strcol(1))) every ::1 nooutput
# Solvers are told apart by colour and shape: PyTorch's are reddish discs and squares, ours bluish triangles.
array color[8] = ['#d55e00', '#e69f00', '#a50f15', '#cc79a7', '#0072b2', '#56b4e9', '#009e73', '#222222']
array shape[8] = [7, 6, 5, 4, 9, 8, 11, 10]
hue(k) = color[int(word(looks, k))]
form(k) = shape[int(word(looks, k))]
look(library, others, own) = library eq 'radiafit' ? 5 + own % 4 : 1 + others % 4
spelt(solver) = solver eq 'two-step cg' ? 'modern CG, two-step' : solver eq 'two-step lbfgs' ? 'L-BFGS, two-step' : \
    solver eq 'stream cg' ? 'modern CG, streaming' : solver eq 'varpro' ? 'variable projection' : \
    solver eq 'L-BFGS' ? 'L-BFGS, one step length for all' : solver eq 'LM' ? 'Levenberg–Marquardt, batched' : \
    solver eq 'LM by projection' ? 'variable projection, batched' : solver
set multiplot layout 1,words(settings) margins 0.07,0.98,0.10,0.53 spacing 0.07 \
    title "{/:Bold Light field maps by other libraries and by radiafit, on the very same problems}\n" . caption \
    . "\nours: the paper has no such figure; ×: seconds over those of the quickest of ours that arrives"
set grid lt 1 lc rgb '#e4e4e4'
set border 3
set tics nomirror
set logscale x
set format x '%g'
set xlabel 'seconds of solving; images read and samples distributed before'
set key at graph 0,1.66 left top Left reverse samplen 3
do for [panel=1:words(settings)] {
    setting = word(settings, panel)
    here(setting_of) = setting_of eq setting
    solvers = ''
    titles = ''
    looks = ''
    asides = ''
    own = 0
    target = 0
    tell(reached, seconds, times) = reached > 0.5 ? sprintf(times < 999.5 ? '%.3g s, ×%.3g' : '%.3g s, ×%.0f', seconds, times) : sprintf('not there in %.3g s', seconds)
    take(library, solver, told, db) = (target = db, solvers = solvers . ' "' . solver . '"', \
        looks = looks . ' ' . look(library, words(looks) - own, own), own = own + (library eq 'radiafit'), \
        titles = titles . sprintf(' "%s %s: %s"', library, spelt(solver), told), 0)
    aside(library, solver, reached, seconds, problems) = (asides = asides . sprintf(' "%s %s, no curve: %g problems%s in %.3g s"', \
        library, solver, problems, reached > 0.5 ? '' : ' not there', seconds), 0)
    stats table using (!here(strcol(1)) ? 0 : strcol(2) eq 'SciPy' ? aside(strcol(2), strcol(3), $4, $9, $22) : \
        take(strcol(2), strcol(3), tell($4, $9, $12), $7)) every ::1 nooutput
    set title '{/:Bold ' . setting . '}' offset 0,12.5
    set ylabel panel == 1 ? 'PSNR of held-out samples, dB' : ''
    set yrange [target - 4:target + 0.6]
    plot for [k=1:words(solvers)] curves using (here(strcol(1)) && strcol(3) eq word(solvers, k) ? $5 : NaN):6 \
            with linespoints lw 1.5 pt form(k) ps size lc rgb hue(k) title word(titles, k), \
        for [k=1:words(asides)] NaN with lines lc rgb 'white' title word(asides, k), \
        target with lines dt 2 lc rgb '#777777' title sprintf('to reach: %.2f dB, a converged fit’s but for 0.02 dB', target)
}
unset multiplot
