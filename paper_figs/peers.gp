# PyTorch against our own fits on the same problems: PSNR of held-out samples over the time of solving, until it is a converged
# fit's but for 0.02 dB.
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
# Solvers are told apart by colour and shape.
array color[6] = ['#d55e00', '#e69f00', '#0072b2', '#56b4e9', '#009e73', '#cc79a7']
array shape[6] = [7, 6, 9, 8, 5, 4]
hue(k) = color[(k - 1) % 6 + 1]
form(k) = shape[(k - 1) % 6 + 1]
spelt(solver) = solver eq 'two-step cg' ? 'modern CG, two-step' : solver eq 'two-step lbfgs' ? 'L-BFGS, two-step' : \
    solver eq 'stream cg' ? 'modern CG, streaming' : solver eq 'varpro' ? 'variable projection' : solver
set multiplot layout 1,words(settings) margins 0.07,0.98,0.10,0.63 spacing 0.07 \
    title "{/:Bold Light field maps by PyTorch and by radiafit, on the very same problems}\n" . caption \
    . "\nours: the paper has no such figure; ×: seconds over those of the quickest of ours that arrives"
set grid lt 1 lc rgb '#e4e4e4'
set border 3
set tics nomirror
set logscale x
set format x '%g'
set xlabel 'seconds of solving; images read and samples distributed before'
set key at graph 0,1.37 left top Left reverse samplen 3
do for [panel=1:words(settings)] {
    setting = word(settings, panel)
    here(setting_of) = setting_of eq setting
    solvers = ''
    titles = ''
    target = 0
    tell(reached, seconds, times) = reached > 0.5 ? sprintf(times < 999.5 ? '%.3g s, ×%.3g' : '%.3g s, ×%.0f', seconds, times) : sprintf('not there in %.3g s', seconds)
    take(library, solver, told, db) = (target = db, solvers = solvers . ' "' . solver . '"', \
        titles = titles . sprintf(' "%s %s: %s"', library, spelt(solver), told), 0)
    stats table using (here(strcol(1)) ? take(strcol(2), strcol(3), tell($4, $9, $12), $7) : 0) every ::1 nooutput
    set title '{/:Bold ' . setting . '}' offset 0,8
    set ylabel panel == 1 ? 'PSNR of held-out samples, dB' : ''
    set yrange [target - 4:target + 0.6]
    plot for [k=1:words(solvers)] curves using (here(strcol(1)) && strcol(3) eq word(solvers, k) ? $5 : NaN):6 \
            with linespoints lw 1.5 pt form(k) ps size lc rgb hue(k) title word(titles, k), \
        target with lines dt 2 lc rgb '#777777' title sprintf('converged but for 0.02 dB: %.2f dB', target)
}
unset multiplot
