# PyTorch against our own fits on the same problems: PSNR of held-out samples over the time of solving, until it is a converged
# fit's but for 0.02 dB.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1500,620 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1500,620 font 'DejaVu Sans,11'
}
set output output
curves = rows . '/curves.csv'
table = rows . '/peers.csv'
# Settings, and the solvers of each, in the order of the rows.
settings = ''
add(name) = strstrt(settings, '"' . name . '"') > 0 ? 0 : (settings = settings . ' "' . name . '"', 0)
stats table using (add(strcol(1))) every ::1 nooutput
array color[6] = ['#d55e00', '#e69f00', '#0072b2', '#56b4e9', '#009e73', '#cc79a7']
hue(k) = color[(k - 1) % 6 + 1]
set multiplot layout 1,words(settings) margins 0.06,0.98,0.13,0.64 spacing 0.07 \
    title "{/:Bold Light field maps by PyTorch and by radiafit, on the very same problems}\n" . caption . "\n "
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
set logscale x
set format x '%g'
set xlabel 'seconds of solving; images read and samples distributed before'
set key at graph 0,1.36 left top vertical maxrows 4 Left reverse samplen 2 width -7 font ',10'
do for [panel=1:words(settings)] {
    setting = word(settings, panel)
    here(setting_of) = setting_of eq setting
    solvers = ''
    titles = ''
    target = 0
    tell(reached, seconds, times) = reached > 0.5 ? sprintf('%.3g s, ×%.3g', seconds, times) : sprintf('not there in %.3g s', seconds)
    take(library, solver, told, db) = (target = db, solvers = solvers . ' "' . solver . '"', \
        titles = titles . sprintf(' "%s %s: %s"', library, solver, told), 0)
    stats table using (here(strcol(1)) ? take(strcol(2), strcol(3), tell($4, $9, $12), $7) : 0) every ::1 nooutput
    set title '{/:Bold ' . setting . '}' offset 0,6.5
    set ylabel panel == 1 ? 'PSNR of held-out samples, dB' : ''
    set yrange [target - 4:target + 0.6]
    plot for [k=1:words(solvers)] curves using (here(strcol(1)) && strcol(3) eq word(solvers, k) ? $5 : NaN):6 \
            with linespoints lw 2 pt 7 ps 0.4 lc rgb hue(k) title word(titles, k), \
        target with lines dt 2 lc rgb '#777777' title sprintf('converged but for 0.02 dB: %.2f dB', target)
}
unset multiplot
