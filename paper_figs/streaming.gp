# Where images come from: time of an iteration, streaming (reading and handing to OpenGL) and the rest.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
times = rows . '/times.csv'
stats times using 5 every ::1 nooutput name 'all'
# problems as they come in the rows; 16 bars of each: two kinds of passes, two optimizers, four sources
problems = all_records / 16
array longest[2]
do for [p=1:problems] {
    stats times using ($7 > 0 ? $7 : $5) every ::(16 * p - 15)::(16 * p) nooutput name 'of'
    longest[p] = of_max
}
width = problems == 1 ? 900 : 1280
if (terminal eq 'svg') {
    set terminal svg size width,750 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size width,750 font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 1.0 : 1.5
set multiplot layout 1,problems title "{/:Bold Time of an iteration by where its images come from (Section 6.5), the paper's mode}\n" . caption \
    margins (problems == 1 ? 0.27 : 0.185),0.975,0.10,0.79 spacing 0.20,0.1
set style fill solid border -1
set grid x lt 1 lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
set yrange [19.6:-0.7]
set xlabel 'seconds per iteration; whiskers: 95 % interval'
unset key
# One problem alone has half the width: the legend's last part goes below.
x_stated = problems == 1 ? 0.2 : 0.5
y_stated = problems == 1 ? 0.857 : 0.885
set label 1 'streaming: reading images, handing them to OpenGL' at screen 0.06,0.885 point pt 5 ps size lc rgb '#56b4e9' offset 1.2,0
set label 2 'the rest' at screen 0.06,0.857 point pt 5 ps size lc rgb '#0072b2' offset 1.2,0
set label 3 "where streaming would end by the paper's 20 %; Lafortune: 70 %" at screen x_stated,y_stated offset 1.2,0
set arrow 1 from screen x_stated,y_stated - 0.013 to screen x_stated,y_stated + 0.013 nohead lw 4 lc rgb '#e69f00'
place(i) = i + int(i / 4)
from(source) = source eq 'disk-cold' ? 'cold disk' : source eq 'disk' ? 'page cache' : source eq 'memory' ? 'host memory' : 'device'
name(passes, optimizer, source) = sprintf('%s, %s, %s', passes, optimizer eq 'cg' ? 'CG' : 'SD', from(source))
stated(problem) = problem eq 'Lafortune' ? 0.7 : 0.2
do for [p=0:problems - 1] {
    first = 1 + 16 * p
    last = first + 15
    set xrange [0:longest[p + 1] * 1.25]
    problem = system(sprintf("awk -F, 'NR == %d {print $1}' '%s'", 1 + first, times))
    set title problem . ' (passes, optimizer, source)'
    plot times using ($5 / 2):(place($0)):($5 / 2):(0.36):ytic(name(strcol(2), strcol(3), strcol(4))) every ::first::last \
             with boxxyerror lc rgb '#0072b2', \
         times using ($8 / 2):(place($0)):($8 / 2):(0.36) every ::first::last with boxxyerror lc rgb '#56b4e9', \
         times using (strcol(4) eq 'disk-cold' && strcol(2) eq 'paper' ? stated(strcol(1)) * $5 : NaN):(place($0) - 0.5):(0):(1) \
             every ::first::last with vectors nohead lw 4 lc rgb '#e69f00', \
         times using 5:(place($0)):6:7 every ::first::last with xerrorbars ps 0 lw 1.5 lc rgb 'black', \
         times using ($7 > 0 ? $7 : $5):(place($0)):(sprintf('%.3g s', $5)) every ::first::last with labels left offset 1.2,0
    unset label
    unset arrow
}
unset multiplot
