# Stopping by thresholds: the share of problems that still run, and the median of their errors over the best known.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
set datafile columnheaders
set datafile missing NaN  # rows that a line leaves out do not break it
if (terminal eq 'svg') {
    set terminal svg size 1700,820 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1700,820 font 'DejaVu Sans,11'
}
set output output
curves = rows . '/curves.csv'
array color[7] = ['#000000', '#56b4e9', '#0072b2', '#009e73', '#e69f00', '#d55e00', '#cc79a7']
# the thresholds, as they come in the rows
list = system(sprintf("awk -F, 'NR > 1 && !($2 in seen) { seen[$2]; printf \"%%s \", $2 }' '%s'", curves))
set multiplot layout 2,4 title "{/:Bold Stopping each problem by a threshold (Section 5.3.2): how many still run, and how far the median one comes}\n" . caption \
    margins 0.05,0.905,0.08,0.86 spacing 0.055,0.16
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
set xlabel 'iteration'
set logscale x
set xrange [1:*]
of(rule, level, optimizer) = (strcol('rule') eq rule || strcol('rule') eq 'none') && column('levels') == level && strcol('optimizer') eq optimizer && column('iteration') > 0
name(level) = level == 0 ? 'none' : sprintf('%g/255', level)
do for [optimizer in 'cg sd'] {
    method = optimizer eq 'cg' ? 'conjugate gradients' : 'steepest descent'
    do for [rule in '"residual" "output change"'] {
        set title sprintf("%s, stopped by\n%s", method, rule eq 'residual' ? 'a small residual' : 'a small change of output')
        unset logscale y
        set format y '%g'
        set yrange [0:105]
        set ylabel 'problems still running, %'
        set arrow 1 from graph 0, first 50 to graph 1, first 50 nohead dt 2 lc rgb '#888888'
        unset key
        plot for [i=1:words(list)] curves using (of(rule, word(list, i) + 0, optimizer) ? column('iteration') : NaN):(100 * column('active_share')) with lines lw 2 lc rgb color[i] notitle
        unset arrow
        set yrange [0.2:1e4]
        set logscale y
        set ylabel "median problem's error above its best, %"
        if (optimizer eq 'cg' && rule eq 'residual') { set key at screen 0.998,0.86 right top title 'threshold' } else { unset key }
        plot for [i=1:words(list)] curves using (of(rule, word(list, i) + 0, optimizer) ? column('iteration') : NaN):(100 * (column('median_error_over_best') - 1)) with lines lw 2 lc rgb color[i] \
                 title name(word(list, i) + 0), \
             1 with lines dt 2 lc rgb '#888888' title '50 %, 1 %', \
             5 with lines dt 3 lw 1.5 lc rgb '#888888' title "C16's 5 %"
    }
}
unset multiplot
