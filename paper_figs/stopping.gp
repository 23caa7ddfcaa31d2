# Stopping by thresholds: the share of problems that still run, and the median of their errors over the best known.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
set datafile columnheaders
set datafile missing NaN  # rows that a line leaves out do not break it
if (terminal eq 'svg') {
    set terminal svg size 1280,820 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,820 font 'DejaVu Sans,11'
}
set output output
curves = rows . '/curves.csv'
# Thresholds are told apart by colour and by dashes.
array color[7] = ['#000000', '#56b4e9', '#0072b2', '#009e73', '#e69f00', '#d55e00', '#cc79a7']
array dashes[7] = [1, 2, 4, 5, 1, 2, 4]
# the thresholds, as they come in the rows
list = system(sprintf("awk -F, 'NR > 1 && !($2 in seen) { seen[$2]; printf \"%%s \", $2 }' '%s'", curves))
set multiplot title "{/:Bold Stopping each problem by a threshold (Section 5.3.2): how many still run, and how far the median one comes}\n" . caption
unset key
set grid lt 1 lc rgb '#e4e4e4'
set border 3
set tics nomirror
set logscale x
of(rule, level, optimizer) = (strcol('rule') eq rule || strcol('rule') eq 'none') && column('levels') == level && strcol('optimizer') eq optimizer && column('iteration') > 0
name(level) = level == 0 ? 'none' : level == 1 ? "1/255, claim C16's" : sprintf('%g/255', level)
wide(level) = level == 1 ? 3.5 : 2
# Columns of panels: both rules of either optimizer. Above, the problems that still run; below, the median problem's error.
do for [panel=0:3] {
    optimizer = word('cg sd', 1 + panel / 2)
    rule = panel % 2 == 0 ? 'residual' : 'output change'
    set lmargin at screen 0.08 + 0.23 * panel
    set rmargin at screen 0.08 + 0.23 * panel + 0.205
    set xrange [1:*]
    set autoscale xfixmax
    set title sprintf("%s, stopped by\n%s", optimizer eq 'cg' ? 'conjugate gradients' : 'steepest descent', rule eq 'residual' ? 'a small residual' : 'a small change of output')
    set tmargin at screen 0.75
    set bmargin at screen 0.46
    unset xlabel
    unset logscale y
    set format y (panel == 0 ? '%g' : '')
    set yrange [0:105]
    set ylabel (panel == 0 ? 'problems still running, %' : '')
    set arrow 1 from graph 0, first 50 to graph 1, first 50 nohead dt 2 lc rgb '#888888'
    plot for [i=1:words(list)] curves using (of(rule, word(list, i) + 0, optimizer) ? column('iteration') : NaN):(100 * column('active_share')) \
        with lines lw wide(word(list, i) + 0) dt dashes[i] lc rgb color[i] notitle
    unset arrow
    unset title
    set tmargin at screen 0.40
    set bmargin at screen 0.08
    set xlabel 'iteration, logarithmic'
    set yrange [0.2:1e4]
    set logscale y
    set ylabel (panel == 0 ? "median problem's error\nabove its best, %" : '')
    plot for [i=1:words(list)] curves using (of(rule, word(list, i) + 0, optimizer) ? column('iteration') : NaN):(100 * (column('median_error_over_best') - 1)) \
             with lines lw wide(word(list, i) + 0) dt dashes[i] lc rgb color[i], \
         1 with lines dt 2 lc rgb '#888888', \
         5 with lines dt 3 lw 1.5 lc rgb '#888888'
}
# The legend of all panels is that of a plot of nothing, as wide as the figure.
unset border
unset tics
unset xlabel
unset ylabel
unset logscale
set lmargin at screen 0.02
set rmargin at screen 0.98
set tmargin at screen 0.90
set bmargin at screen 0.85
set key center center horizontal Left reverse samplen 3 title 'threshold:' left
plot [0:1] [0:1] for [i=1:words(list)] NaN with lines lw wide(word(list, i) + 0) dt dashes[i] lc rgb color[i] title name(word(list, i) + 0), \
    NaN with lines dt 2 lc rgb '#888888' title 'guides: 50 %, 1 %', \
    NaN with lines dt 3 lw 1.5 lc rgb '#888888' title "claim C16's bound: 5 %"
unset multiplot
