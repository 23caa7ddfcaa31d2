# Performance profile of the solvers (Dolan and Moré 2002): the share of problems solved within a factor of the fastest one's time.
# -e: rows (folder of profile.csv: curves by number, the best first), output, caption, terminal ("svg" or "png")
set datafile separator comma
set datafile columnheaders
curves = rows . '/profile.csv'
stats curves using 1 nooutput name 'curve'
stats curves using 3 nooutput name 'tried'
stats curves using 4 nooutput name 'factor'
count = int(curve_max)
height = 580 > 150 + 24 * count ? 580 : 150 + 24 * count
if (terminal eq 'svg') {
    set terminal svg size 1280,height font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,height font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 0.6 : 0.9
# Solvers are told apart by colour, dashes and shape.
array shape[10] = [7, 9, 5, 11, 13, 6, 8, 4, 10, 12]
array color[6] = ['#d55e00', '#0072b2', '#009e73', '#cc79a7', '#56b4e9', '#333333']
array name[count]
array vertices[count]
stats curves using (name[column(1)] = strcol(2), vertices[column(1)] = column(3), 0) nooutput
few(i) = vertices[i] < tried_max ? sprintf(' (%d vert%s)', vertices[i], vertices[i] == 1 ? 'ex' : 'ices') : ''
set multiplot layout 1,1 title "{/:Bold Performance profile of the solvers}\n" . caption \
    . "\nours: the paper has no such figure; what is not Ceres' is radiafit's own" margins 0.065,0.675,62.0 / height,1 - 98.0 / height
set xlabel "factor of the fastest solver's time on the same vertex"
set ylabel 'share of the vertices tried, solved to within 1 % of the best error'
set logscale x
set xrange [1:(factor_max > 2 ? factor_max : 2)]
set yrange [0:1.02]
set format x '%g'
set grid lt 1 lc rgb '#e4e4e4'
set border 3
set tics nomirror
set key at screen 0.688,1 - 98.0 / height left top Left reverse noenhanced samplen 3
hue(i) = color[(i - 1) % 6 + 1]
form(i) = shape[(i - 1) % 10 + 1]
plot for [i=1:count] curves using (column(1) == i ? column(4) : NaN):5 with steps lw 2 lc rgb hue(i) dt 1 + (i - 1) / 6 notitle, \
     for [i=1:count] curves using (column(1) == i ? column(4) : NaN):5 every (vertices[i] > 20 ? 6 : 1) with points pt form(i) ps size lc rgb hue(i) notitle, \
     for [i=1:count] NaN with linespoints lw 2 lc rgb hue(i) dt 1 + (i - 1) / 6 pt form(i) ps size title name[i] . few(i)
unset multiplot
