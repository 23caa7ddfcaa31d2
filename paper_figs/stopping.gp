# Stopping by thresholds: the share of problems that still run, and the median of their errors over the best known.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1200,760 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1200,760 font 'DejaVu Sans,11'
}
set output output
curves = rows . '/curves.csv'
stats curves using 2 every ::1 nooutput name 'levels'
array color[7] = ['#000000', '#56b4e9', '#0072b2', '#009e73', '#e69f00', '#d55e00', '#cc79a7']
# the thresholds, as they come in the rows
list = system(sprintf("awk -F, 'NR > 1 && !($2 in seen) { seen[$2]; printf \"%%s \", $2 }' '%s'", curves))
set multiplot layout 2,2 title "{/:Bold Stopping by thresholds (Section 5.3.2): problems still running, and the median problem's error}\n" . caption \
    margins 0.07,0.845,0.09,0.86 spacing 0.10,0.16
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
set xlabel 'iteration'
set logscale x
of(rule, level, value) = strcol(1) eq rule && $2 == level && strcol(3) eq 'cg' && $4 > 0 ? value : NaN
name(level) = level == 0 ? 'no threshold' : sprintf('%g/255', level)
do for [rule in '"residual" "output change"'] {
    set title sprintf('stopped by %s below a threshold', rule)
    unset logscale y
    set yrange [0:105]
    set ylabel 'problems still running, %'
    set arrow 1 from graph 0, first 50 to graph 1, first 50 nohead dt 2 lc rgb '#888888'
    unset key
    plot for [i=1:words(list)] curves using 4:(of(rule, word(list, i) + 0, 100 * $5)) with lines lw 2 lc rgb color[i] notitle
    unset arrow
    set yrange [0.2:1000]
    set logscale y
    set ylabel 'median error above best, %'
    if (rule eq 'residual') { set key at screen 0.992,0.85 right top } else { unset key }
    plot for [i=1:words(list)] curves using 4:(of(rule, word(list, i) + 0, 100 * ($6 - 1))) with lines lw 2 lc rgb color[i] \
             title name(word(list, i) + 0), \
         1 with lines dt 2 lc rgb '#888888' title '50 %, 1 %'
}
unset multiplot
