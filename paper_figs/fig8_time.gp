# Figure 8: stacked bars of run time; left in seconds, right as shares of the total.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1200,560 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1200,560 font 'DejaVu Sans,11'
}
set output output
array color[5] = ['#e69f00', '#56b4e9', '#0072b2', '#d55e00', '#999999']
array part[5] = ['distribution to disk', 'streaming images or records', 'computation', 'switching passes', 'remainder']
times = rows . '/times.csv'
stats times using 10 every ::1::8 nooutput name 'total'
set multiplot layout 1,2 title "{/:Bold Figure 8: where the time goes, CPU two-step and OpenGL, the paper's mode}\n" . caption \
    margins 0.21,0.985,0.13,0.80 spacing 0.05,0.1
set style fill solid border -1
set grid x lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
set yrange [8.6:-0.6]
# The figure's rows come first: four of conjugate gradients, a gap, four of steepest descent. Times and the total are
# columns 5 to 10; sum(k) is what the first k parts take together.
place(i) = i + (i >= 4 ? 1 : 0)
name(method, optimizer) = sprintf('%s, %s', method, optimizer eq 'cg' ? 'CG' : 'SD')
sum(k) = column(5) + (k >= 2 ? column(6) : 0) + (k >= 3 ? column(7) : 0) + (k >= 4 ? column(8) : 0) + (k >= 5 ? column(9) : 0)
set xrange [0:total_max * 1.18]
set xlabel 'seconds'
unset key
array at[5] = [0.21, 0.36, 0.56, 0.67, 0.79]
do for [k=1:5] { set label k "■ " . part[k] at screen at[k],0.845 tc rgb color[k] }
plot for [k=5:1:-1] times using (sum(k) / 2):(place($0)):(sum(k) / 2):(0.36):ytic(name(strcol(2), strcol(3))) \
         every ::1::8 with boxxyerror lc rgb color[k], \
     times using 10:(place($0)):(sprintf(' %.3g s', $10)) every ::1::8 with labels left font ',10'
set xrange [0:100]
unset label
set xlabel 'share of the total, %'
unset ytics
plot for [k=5:1:-1] times using (50 * sum(k) / $10):(place($0)):(50 * sum(k) / $10):(0.36) every ::1::8 \
         with boxxyerror lc rgb color[k]
unset multiplot
