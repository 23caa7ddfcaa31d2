# A ladder of steps on a logarithmic axis: milliseconds of an image and a sweep, step by step, and the factor to the step before.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1280,640 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,640 font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 0.85 : 1.3
ladder = rows . '/ladder.csv'
set multiplot layout 1,1 title "{/:Bold From the paper's passes to cached samples: light field map, the paper's conjugate gradients}\n" . caption \
    . "\nours: the paper has no such figure" margins 0.285,0.80,0.13,0.80
set grid x lt 1 lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
set logscale x
set format x '%g'
set xlabel "milliseconds of an image and a sweep over it (an iteration has two), logarithmic\nwhiskers: 95 % interval of the median; times: against the step above"
unset key
stats ladder using 3 every ::1 nooutput name 'ms'
set xrange [ms_min / 2:ms_max * 2]
set yrange [ms_records - 0.4:-0.6]
# Steps are told apart by shape and colour.
array what[3] = ['fragment programs', 'compute shaders', 'CPU, C++']
array color[3] = ['#0072b2', '#d55e00', '#009e73']
array shape[3] = [7, 9, 5]
kind(name) = name[1:3] eq 'CPU' ? 3 : name[1:7] eq 'compute' ? 2 : 1
do for [k=1:3] { set label k what[k] at screen 0.30 + 0.17 * (k - 1),0.835 point pt shape[k] ps size lc rgb color[k] offset 1.2,0 }
change(step, over) = step == 0 ? '' : over < 1 ? sprintf(', %.3g times as fast', 1 / over) : sprintf(', %.3g times as long', over)
plot ladder using (ms_min / 2):1:($4 > 0 ? $4 - ms_min / 2 : $3 - ms_min / 2):(0) every ::1 with vectors nohead dt 3 lc rgb '#999999', \
     for [k=1:3] ladder using (kind(strcol(2)) == k ? $3 : NaN):1:4:5 every ::1 with xerrorbars pt -1 lw 1.5 lc rgb color[k], \
     for [k=1:3] ladder using (kind(strcol(2)) == k ? $3 : NaN):1:ytic(2) every ::1 with points pt shape[k] ps size lc rgb color[k], \
     ladder using ($5 > 0 ? $5 : $3):1:(sprintf('%.3g ms%s', $3, change($1, $6))) every ::1 with labels left offset 1.5,0
unset multiplot
