# Figure 8: left the time of a whole fit, on a log axis; right where it goes, as shares of the total.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
times = rows . '/times.csv'
stats times using 11 every ::1 nooutput name 'total'
# The rows of conjugate gradients, then as many of steepest descent; behind each what the paper says, and its bar.
half = total_records / 2
place(i) = i + (i >= half ? 2.9 : 0)
paper_place(k) = half + 0.2 + k * (half + 2.9)
# Where some passes are named as of 32 bits, the others are of 16.
narrow = system(sprintf("grep -c ' in 32 bits' '%s'", times)) > 0
below = narrow ? 104 : 84
height = int(108 + below + 34 * (2 * half + 5.4))
if (terminal eq 'svg') {
    set terminal svg size 1280,height font 'DejaVu Sans,13' background 'white'
    size = 0.85
} else {
    set terminal pngcairo size 1280,height font 'DejaVu Sans,11'
    size = 1.3
}
set output output
# Parts are told apart by colour, by their order and by the letter in them.
array color[5] = ['#e69f00', '#56b4e9', '#0072b2', '#d55e00', '#bbbbbb']
array letter[5] = ['D', 'S', 'C', 'W', 'R']
array ink[5] = [0x000000, 0x000000, 0xffffff, 0xffffff, 0x000000]
array part[5] = ['D: distribution to disk', 'S: streaming images or records', 'C: computation', 'W: switching passes', 'R: remainder']
set multiplot layout 1,2 title "{/:Bold Figure 8: where the time goes, the CPU's two steps and OpenGL, the paper's mode}\n" . caption \
    margins 0.235,0.98,1.0 * below / height,1 - 109.0 / height spacing 0.05,0.1
set grid x lt 1 lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
set yrange [2 * half + 4.6:-0.8]
optimizer(o) = o eq 'cg' ? 'CG' : 'SD'
name(method, o, threads) = method[1:8] eq 'two-step' ? \
    sprintf('%s, CPU, %s, %d thread%s', optimizer(o), method[11:strlen(method) - 1], threads, threads == 1 ? '' : 's') : \
    sprintf('%s, %s', optimizer(o), method)
full(method) = method[1:14] eq 'two-step (full'

low = 10 ** floor(log10(total_min) - 0.3)
set logscale x
set xrange [low:total_max * 6]
set format x '%g'
set xlabel "seconds of a fit, logarithmic\nwhiskers: 95 % interval of the median" . (narrow ? "\nOpenGL: 16-bit floats, if not 32" : '')
# One thread with the full record may wait longer for its records than it computes.
one_thread(o, column) = real(system(sprintf("awk -F, '$1 == \"two-step (full record)\" && $2 == \"%s\" && $3 == 1 {print $%d}' '%s'", o, column, times)))
waits(o) = one_thread(o, 7) <= one_thread(o, 8) ? '' : \
    sprintf("\nfull record, 1 thread: reads for %.2g s, computes for %.2g s", one_thread(o, 7), one_thread(o, 8))
do for [k=0:1] {
    set label 1 + k sprintf("%s, the paper: GPU more than 5 times faster;\n20 %% streaming, %d %% switching (hatched, right)", k == 0 ? 'CG' : 'SD', k == 0 ? 66 : 50) \
        . waits(k == 0 ? 'cg' : 'sd') at first low * 1.15,paper_place(k) - 0.2
}
unset key
plot times using (low):(place($0)):(($12 > 0 ? $12 : $11) - low):(0):ytic(name(strcol(1), strcol(2), $3)) every ::1 with vectors nohead dt 3 lc rgb '#999999', \
     times using 11:(place($0)):12:13 every ::1 with xerrorbars pt -1 lw 1.5 lc rgb '#0072b2', \
     times using (strcol(1)[1:8] eq 'two-step' ? $11 : NaN):(place($0)) every ::1 with points pt 7 ps size lc rgb '#0072b2', \
     times using (strcol(1)[1:8] eq 'two-step' ? NaN : $11):(place($0)) every ::1 with points pt 9 ps size lc rgb '#d55e00', \
     times using ($13 > 0 ? $13 : $11):(place($0)):(sprintf('%.3g s', $11)) every ::1 with labels left offset 1.5,0

unset logscale x
unset label
set style fill solid border -1
set xrange [0:100]
set xlabel "share of the total, %\nswitching: the same commands cut to one texel"
unset ytics
# what the parts before the k-th and with it take together
sum(k) = column(6) + (k >= 2 ? column(7) : 0) + (k >= 3 ? column(8) : 0) + (k >= 4 ? column(9) : 0) + (k >= 5 ? column(10) : 0)
of(k) = 100 * column(5 + k) / column(11)
told(k) = of(k) < 3.5 ? '' : of(k) < 11 ? letter[k] : sprintf('%s %.0f', letter[k], of(k))
# beside the paper's mark of 50 %
aside(x) = full(strcol(1)) && abs(x - 50) < 5 ? (x < 50 ? 45 : 55) : x
array at[5] = [0.03, 0.19, 0.405, 0.525, 0.67]
do for [k=1:5] { set label k part[k] at screen at[k],1 - 90.0 / height point pt 5 ps 1.3 * size lc rgb color[k] offset 1.2,0 }
set label 6 "┊ the paper: distribution up to 50 %" at screen 0.78,1 - 87.0 / height
# What the paper states of streaming and switching, and what they leave: from, to, part.
$stated << END
0,0,20,2
0,20,34,3
0,34,100,4
1,0,20,2
1,20,50,3
1,50,100,4
END
plot for [k=5:1:-1] times using (50 * sum(k) / $11):(place($0)):(50 * sum(k) / $11):(0.36) every ::1 \
         with boxxyerror lc rgb color[k], \
     for [k=2:4] $stated using ($4 == k ? 0.5 * ($2 + $3) : NaN):(paper_place($1)):(0.5 * ($3 - $2)):(0.36) \
         with boxxyerror fs pattern 4 border -1 lc rgb color[k], \
     times using (full(strcol(1)) ? 50 : NaN):(place($0) - 0.45):(0):(0.9) every ::1 with vectors nohead dt (4, 3) lw 3 lc rgb 'black', \
     for [k=1:5] times using (aside(100 * sum(k) / $11 - 0.5 * of(k))):(place($0)):(told(k)):(ink[k]) every ::1 with labels tc rgb variable, \
     $stated using (0.5 * ($2 + $3)):(paper_place($1) + 0.7):(sprintf('%s %d', letter[$4], $3 - $2)) with labels
unset multiplot
