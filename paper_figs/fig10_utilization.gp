# Figure 10: share of the measured peaks, three bars for each problem, kind of passes and optimizer.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1200,560 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1200,560 font 'DejaVu Sans,11'
}
set output output
shares = rows . '/utilization.csv'
stats shares using 4 every ::1 nooutput name 'bars'
array color[3] = ['#0072b2', '#e69f00', '#009e73']
# the renderer's peaks come first in their file, in this order
peak(k) = real(system(sprintf("awk -F, 'NR == %d { print $NF }' '%s'", k + 1, rows . '/peaks.csv')))
array resource[3]
resource[1] = sprintf('computation, of %.3g G operations/s', 1e-9 * peak(1))
resource[2] = sprintf('memory bandwidth, of %.3g GB/s', 1e-9 * peak(3))
resource[3] = sprintf('texture reads, of %.3g G/s', 1e-9 * peak(2))
set title "{/:Bold Figure 10: use of the fragment stage, share of the peaks measured in the same run}\n" . caption
set style fill solid border -1
set boxwidth 0.26
set grid y lc rgb '#dddddd'
set border 3
set tics nomirror
set xtics scale 0
set ylabel 'share of the peak, %'
set yrange [0:*]
set offsets 0, 0, graph 0.3, 0
set xrange [-0.6:bars_records - 0.4]
set key top right
name(problem, optimizer, passes) = sprintf("%s\n%s\n%s passes", problem, optimizer eq 'cg' ? 'CG' : 'SD', passes)
set bmargin 5
plot for [k=1:3] shares using ($0 + 0.27 * (k - 2)):(100 * column(3 + k)) every ::1 with boxes lc rgb color[k] title resource[k], \
     shares using 0:(0):xtic(name(strcol(1), strcol(2), strcol(3))) every ::1 with dots lc rgb 'black' notitle, \
     for [k=1:3] shares using ($0 + 0.27 * (k - 2)):(100 * column(3 + k)):(sprintf('%.2g', 100 * column(3 + k))) \
         every ::1 with labels offset 0,0.7 font ',10' notitle
