# Left: bytes of the fragment engine over parameters. Right: seconds of an iteration over samples. Both logarithmic.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1200,560 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1200,560 font 'DejaVu Sans,11'
}
set output output
memory = rows . '/memory.csv'
times = rows . '/time.csv'
slopes = rows . '/slopes.csv'
slope(of, engine) = system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"%s\" {printf \"%%s\", $3}' '%s'", of, engine, slopes))
stats times using 5 every ::1 nooutput name 'seconds'
array color[4] = ['#0072b2', '#56b4e9', '#d55e00', '#e69f00']
set multiplot layout 1,2 title "{/:Bold Memory over parameters, time over samples: the paper's conjugate gradients}\n" . caption \
    margins 0.07,0.97,0.12,0.80 spacing 0.085,0.1
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
set logscale xy
set key bottom right samplen 3
set title 'memory of the fragment engine'
set xlabel 'parameters N'
set ylabel 'MB' offset 1
set format x '%.0s%c'
set format y '%g'
set yrange [*<20:*]
kinds = '"paper fp32" "paper fp16" "combined fp32" "combined fp16"'
plot for [i=1:4] memory using (strcol(3) . ' ' . strcol(2) eq word(kinds, i) ? $5 : NaN):($7 / 1e6) \
         with linespoints lw 2 pt 7 lc rgb color[i] \
         title sprintf('%s passes, %s: slope %s', word(word(kinds, i), 1), word(word(kinds, i), 2), slope('bytes', 'fragment ' . word(kinds, i))), \
     for [i=1:4] memory using (strcol(3) . ' ' . strcol(2) eq word(kinds, i) ? $5 : NaN):($6 / 1e6) \
         with points pt 4 ps 1.6 lc rgb color[i] title (i == 1 ? 'radiafit plan' : ''), \
     memory using (strcol(3) . ' ' . strcol(2) eq 'paper fp32' ? $5 : NaN):($8 / 1e6) \
         with lines lw 2 dt 2 lc rgb '#888888' title "Section 6.3's accounting, fp32"
set title 'time of an iteration'
set xlabel 'radiance samples S'
set ylabel 'seconds' offset 1
engines = '"fragment paper" "fragment combined" "cpu"'
set yrange [seconds_min / 6:*]  # room for the key
set key bottom left Left reverse
plot for [i=1:3] times using (strcol(1) eq word(engines, i) ? $3 : NaN):5 \
    with linespoints lw 2 pt 7 lc rgb color[i == 1 ? 1 : i == 2 ? 3 : 2] \
    title sprintf('%s: slope %s', word(engines, i), slope('seconds', word(engines, i)))
unset multiplot
