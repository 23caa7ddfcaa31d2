# Performance profile of the solvers (Dolan and Moré 2002): the share of problems solved within a factor of the fastest one's time.
# -e: rows (folder of profile.csv: curves by number, the best first), output, caption, terminal ("svg" or "png")
set datafile separator comma
set datafile columnheaders
curves = rows . '/profile.csv'
stats curves using 1 nooutput name 'curve'
stats curves using 3 nooutput name 'tried'
stats curves using 4 nooutput name 'factor'
count = int(curve_max)
height = 560 > 130 + 24 * count ? 560 : 130 + 24 * count
if (terminal eq 'svg') {
    set terminal svg size 1000,height font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1000,height font 'DejaVu Sans,11'
}
set output output
array color[6] = ['#d55e00', '#0072b2', '#009e73', '#cc79a7', '#56b4e9', '#333333']
array name[count]
array vertices[count]
stats curves using (name[column(1)] = strcol(2), vertices[column(1)] = column(3), 0) nooutput
few(i) = vertices[i] < tried_max ? sprintf(' (%d vertices)', vertices[i]) : ''
set title "{/:Bold Performance profile of the solvers}\n" . caption
set xlabel "factor of the fastest solver's time on the same vertex"
set ylabel 'share of the vertices tried, solved to within 1 % of the best error'
set logscale x
set xrange [1:(factor_max > 2 ? factor_max : 2)]
set yrange [0:1.02]
set format x '%g'
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
set key outside right top Left reverse noenhanced samplen 2.5
plot for [i=1:count] curves using (column(1) == i ? column(4) : NaN):5 with steps lw 2.2 lc rgb color[(i - 1) % 6 + 1] dt 1 + (i - 1) / 6 \
     title name[i] . few(i)
