# Figure 8: left the time of a whole fit, on a log axis; right where it goes, as shares of the total.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
times = rows . '/times.csv'
stats times using 11 every ::1 nooutput name 'total'
# The rows of conjugate gradients, then as many of steepest descent; behind each the paper's words as a bar.
half = total_records / 2
place(i) = i + (i >= half ? 2.4 : 0)
paper_place(k) = half + 0.2 + k * (half + 2.4)
if (terminal eq 'svg') {
    set terminal svg size 1280,760 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,760 font 'DejaVu Sans,11'
}
set output output
array color[5] = ['#e69f00', '#56b4e9', '#0072b2', '#d55e00', '#999999']
array part[5] = ['distribution to disk', 'streaming images or records', 'computation', 'switching passes', 'remainder']
set multiplot layout 1,2 title "{/:Bold Figure 8: where the time goes, the CPU's two steps and OpenGL, the paper's mode}\n" . caption \
    margins 0.235,0.985,0.10,0.82 spacing 0.05,0.1
set style fill solid border -1
set grid x lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
set yrange [2 * half + 3.4:-0.8]
optimizer(o) = o eq 'cg' ? 'CG' : 'SD'
name(method, o, threads) = method[1:8] eq 'two-step' ? \
    sprintf('%s, CPU, %s, %d thread%s', optimizer(o), method[11:strlen(method) - 1], threads, threads == 1 ? '' : 's') : \
    sprintf('%s, %s', optimizer(o), method)

low = 10 ** floor(log10(total_min) - 0.3)
set logscale x
set xrange [low:total_max * 6]
set xlabel 'seconds of a fit, log axis; whiskers: 95 % interval of the median'
do for [k=0:1] {
    set label 1 + k sprintf("%s, the paper: GPU more than 5 times faster;\n20 %% streaming, %d %% switching (hatched, right)", k == 0 ? 'CG' : 'SD', k == 0 ? 66 : 50) \
        at first low * 1.15,paper_place(k) - 0.2 font ',10'
}
unset key
plot times using 11:(place($0)):(low):11:(place($0) - 0.36):(place($0) + 0.36):ytic(name(strcol(1), strcol(2), $3)) every ::1 \
         with boxxyerror lc rgb '#bbccdd', \
     times using 11:(place($0)):12:13 every ::1 with xerrorbars ps 0 lw 1.5 lc rgb 'black', \
     times using ($13 > 0 ? $13 : $11):(place($0)):(sprintf('  %.3g s', $11)) every ::1 with labels left font ',10'

unset logscale x
unset label
set xrange [0:100]
set xlabel "share of the total, %\nswitching: the same commands cut to one texel"
unset ytics
# what the parts before the k-th and with it take together
sum(k) = column(6) + (k >= 2 ? column(7) : 0) + (k >= 3 ? column(8) : 0) + (k >= 4 ? column(9) : 0) + (k >= 5 ? column(10) : 0)
array at[5] = [0.05, 0.205, 0.405, 0.51, 0.65]
do for [k=1:5] { set label k "■ " . part[k] at screen at[k],0.85 tc rgb color[k] }
set label 6 "┊ the paper: distribution up to 50 %" at screen 0.75,0.85
# What the paper states of streaming and switching, and what they leave: from, to, part.
$stated << END
0,0,20,2
0,20,34,3
0,34,100,4
1,0,20,2
1,20,50,3
1,50,100,4
END
full(method) = method[1:14] eq 'two-step (full'
plot for [k=5:1:-1] times using (50 * sum(k) / $11):(place($0)):(50 * sum(k) / $11):(0.36) every ::1 \
         with boxxyerror lc rgb color[k], \
     for [k=2:4] $stated using ($4 == k ? 0.5 * ($2 + $3) : NaN):(paper_place($1)):(0.5 * ($3 - $2)):(0.36) \
         with boxxyerror fs pattern 4 border -1 lc rgb color[k], \
     times using (full(strcol(1)) ? 50 : NaN):(place($0) - 0.45):(0):(0.9) every ::1 with vectors nohead dt (4, 3) lw 3 lc rgb 'black'
unset multiplot
