# A ladder of bars, logarithmic: milliseconds of an image and a sweep, step by step, and the factor to the step before.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1180,640 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1180,640 font 'DejaVu Sans,11'
}
set output output
ladder = rows . '/ladder.csv'
set title "{/:Bold From the paper's passes to cached samples: light field map, the paper's conjugate gradients}\n" . caption
set lmargin at screen 0.25
set rmargin at screen 0.975
set style fill solid noborder
set grid x lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
set logscale x
set format x '%g'
set xlabel 'milliseconds of an image and a sweep over it (an iteration has two); whiskers: 95 % interval'
unset key
stats ladder using 3 every ::1 nooutput name 'ms'
set xrange [ms_min / 3:ms_max * 4]
set yrange [ms_records - 0.4:-0.9]
set label 1 '■ fragment programs' at graph 0.30,0.965 tc rgb '#0072b2'
set label 2 '■ compute shaders' at graph 0.53,0.965 tc rgb '#d55e00'
set label 3 '■ CPU, C++' at graph 0.74,0.965 tc rgb '#009e73'
kind(name) = name[1:3] eq 'CPU' ? 0x009e73 : name[1:7] eq 'compute' ? 0xd55e00 : 0x0072b2
change(step, over) = step == 0 ? '' : over < 1 ? sprintf(', %.3g times as fast as the step before', 1 / over) : sprintf(', %.3g times as long as the step before', over)
plot ladder using (ms_min / 3):1:(ms_min / 3):3:($1 - 0.32):($1 + 0.32):(kind(strcol(2))):ytic(2) every ::1 \
         with boxxyerror lc rgb variable, \
     ladder using 3:1:4:5 every ::1 with xerrorbars ps 0 lw 1.5 lc rgb 'black', \
     ladder using ($5 > 0 ? $5 : $3):1:(sprintf('  %.3g ms%s', $3, change($1, $6))) every ::1 with labels left font ',10'
