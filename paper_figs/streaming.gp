# Where images come from: time of an iteration, streaming (reading and handing to OpenGL) and the rest.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
times = rows . '/times.csv'
stats times using 5 every ::1 nooutput name 'all'
# problems as they come in the rows; 16 bars of each: two kinds of passes, two optimizers, four sources
problems = all_records / 16
array longest[2]
do for [p=1:problems] {
    stats times using 5 every ::(16 * p - 15)::(16 * p) nooutput name 'of'
    longest[p] = of_max
}
if (terminal eq 'svg') {
    set terminal svg size 640 + 560 * (problems - 1),680 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 640 + 560 * (problems - 1),680 font 'DejaVu Sans,11'
}
set output output
set multiplot layout 1,problems title "{/:Bold Time of an iteration by where its images come from (Section 6.5)}\n" . caption \
    margins (problems == 1 ? 0.34 : 0.185),0.975,0.10,0.86 spacing 0.19,0.1
set style fill solid border -1
set grid x lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
set yrange [19.6:-0.7]
set xlabel 'seconds per iteration'
set key bottom right invert
place(i) = i + int(i / 4)
from(source) = source eq 'disk-cold' ? 'cold disk' : source eq 'disk' ? 'page cache' : source eq 'memory' ? 'host memory' : 'device'
name(passes, optimizer, source) = sprintf('%s, %s, %s', passes, optimizer eq 'cg' ? 'CG' : 'SD', from(source))
do for [p=0:problems - 1] {
    first = 1 + 16 * p
    last = first + 15
    set xrange [0:longest[p + 1] * 1.2]
    set title word('"light field map" "Lafortune"', p + 1)
    plot times using ($5 / 2):(place($0)):($5 / 2):(0.36):ytic(name(strcol(2), strcol(3), strcol(4))) every ::first::last \
             with boxxyerror lc rgb '#0072b2' title 'the rest', \
         times using ($6 / 2):(place($0)):($6 / 2):(0.36) every ::first::last with boxxyerror lc rgb '#56b4e9' title 'streaming', \
         times using 5:(place($0)):(sprintf(' %.3g s', $5)) every ::first::last with labels left font ',10' notitle
    unset key
}
unset multiplot
