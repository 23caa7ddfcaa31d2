# Many small fits: fits a second by all threads of the run, a group of bars for each problem.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
set datafile columnheaders
if (terminal eq 'svg') {
    set terminal svg size 1100,620 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1100,620 font 'DejaVu Sans,11'
}
set output output
fits = rows . '/fits.csv'
set title "{/:Bold Fits a second, at equal error}\n" . caption
stats fits using (column('threads')) nooutput
most = STATS_max
names = system(sprintf("awk -F, 'NR > 1 { n = $1 \"_\" $2; gsub(\" \", \"-\", n); if (!(n in seen)) { seen[n]; printf \"%%s \", n } }' '%s'", fits))
place(name) = sum [i=1:words(names)] (word(names, i) eq name ? i : 0)
swap(text, from, to) = text eq '' ? '' : (text[1:1] eq from ? to : text[1:1]) . swap(text[2:*], from, to)
group(dummy) = place(swap(sprintf('%s_%d', strcol('problem'), column('samples')), ' ', '-'))
shown(text) = swap(swap(text, '-', ' '), '_', ', ') . ' samples'
set logscale y
set format y '10^{%T}'
set ylabel sprintf('fits a second, %d threads', most)
set grid y lt 1 lc rgb '#e4e4e4'
set border 3
set tics nomirror
set xrange [0.4:words(names) + 0.6]
set xtics () rotate by 20 right
do for [i=1:words(names)] { set xtics add (shown(word(names, i)) i) }
set key top right
set boxwidth 0.26
set lmargin 16
set style fill solid
pick(solver, precision) = strcol('solver') eq solver && strcol('precision') eq precision && column('threads') == most ? column('fits_per_second') : NaN
plot fits using (group(0) - 0.28):(pick('radiafit solve', 'float')) with boxes lc rgb '#0072b2' title 'radiafit solve, floats', \
    '' using (group(0)):(pick('radiafit solve', 'double')) with boxes lc rgb '#56b4e9' title 'radiafit solve, doubles', \
    '' using (group(0) + 0.28):(pick('TinySolver', 'double')) with boxes lc rgb '#e69f00' title "Ceres' TinySolver, doubles"
