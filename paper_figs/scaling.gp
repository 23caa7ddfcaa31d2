# Bytes over parameters; seconds of an iteration over samples and over texels, every repetition a point, medians joined;
# and what it costs to distribute pixels for every iteration. All but the last logarithmic, with a guide of slope 1.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1280,1060 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,1060 font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 0.6 : 0.9
memory = rows . '/memory.csv'
times = rows . '/time.csv'
summary = rows . '/summary.csv'
field(of, engine, column) = system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"%s\" {printf \"%%s\", $%d}' '%s'", of, engine, column, summary))
interval(of, engine) = field(of, engine, 4) eq '' ? '' : sprintf(' (%.2f to %.2f)', real(field(of, engine, 4)), real(field(of, engine, 5)))
slope(of, engine) = sprintf('%.2f', real(field(of, engine, 3))) . interval(of, engine)
# Lines are told apart by colour, dashes and the shape of their points.
array color[5] = ['#0072b2', '#56b4e9', '#d55e00', '#e69f00', '#009e73']
array shape[5] = [7, 6, 9, 8, 5]
array dashes[5] = [1, 4, 1, 4, 1]
set multiplot layout 2,2 title "{/:Bold Memory and time against the size of the problem: the paper's conjugate gradients}\n" . caption \
    . "\npoints: repetitions, joined by their medians; slopes: of logarithms, with intervals of 95 %" \
    margins 0.075,0.975,0.065,0.865 spacing 0.095,0.115
set grid lt 1 lc rgb '#e4e4e4'
set border 3
set tics nomirror
set logscale xy
set format x '%.0s%c'
set format y '%g'

stats memory using 4 every ::1 nooutput name 'side'
set title sprintf('memory of the OpenGL engine, maps of side %d to %d (Section 6.3)', side_min, side_max)
set xlabel 'parameters N' offset 0,0.4
set ylabel 'MB'
set key bottom right samplen 4
stats memory using ($10 / 1e6) every ::1 nooutput name 'megabytes'
stats memory using 7 every ::1 nooutput name 'parameters'
star = 142  # MB
least = megabytes_min < star ? megabytes_min : star
set yrange [least / 45:megabytes_max * 4]  # room for the key
kinds = '"paper fp32" "paper fp16" "combined fp32" "combined fp16"'
kind(passes, storage) = passes . ' ' . storage
plot for [i=1:4] memory using (kind(strcol(3), strcol(2)) eq word(kinds, i) ? $7 : NaN):($10 / 1e6) \
         with linespoints lw 2 dt dashes[i] pt shape[i] ps size lc rgb color[i] \
         title sprintf('%s passes, %s: slope %.2f', word(word(kinds, i), 1), word(word(kinds, i), 2), \
                       real(field('bytes over parameters', 'fragment ' . word(kinds, i), 3))), \
     for [i=1:4] memory using (kind(strcol(3), strcol(2)) eq word(kinds, i) ? $7 : NaN):($8 / 1e6) \
         with points pt 4 ps 2 * size lc rgb color[i] title (i == 1 ? 'planned before it runs' : ''), \
     memory using (kind(strcol(3), strcol(2)) eq 'paper fp32' ? $7 : NaN):($12 / 1e6) \
         with lines lw 2 dt 2 lc rgb '#777777' title "Section 6.3's accounting, fp32", \
     [parameters_min:parameters_max] x * megabytes_min / parameters_min * 2.6 with lines lw 1 dt 3 lc rgb 'black' title 'guide: slope 1', \
     star with lines lw 1.5 dt 5 lc rgb '#009e73' title "142 MB, the paper's star"
set autoscale

# Medians over repetitions by size, a column of time.csv.
medians(part, engine, size, seconds) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" {print $%d, $%d}' '%s' | sort -g -k 1,1 -k 2,2 | awk 'n && $1 != x {print x \",\" y[int((n + 1) / 2)]; n = 0} {x = $1; y[++n] = $2} END {print x \",\" y[int((n + 1) / 2)]}'", part, engine, size, seconds, times)
is(part, engine) = strcol(1) eq part && strcol(2) eq engine
engines = '"fragment paper" "fragment combined" "cpu" "compute gather" "compute scatter"'
look(i) = i == 1 ? 1 : i == 2 ? 3 : i == 3 ? 2 : i
set ylabel 'seconds per iteration'
set key top left Left reverse samplen 4
names = '"OpenGL, the paper''s passes" "OpenGL, combined passes" "CPU, samples in memory"'
set title 'time over samples: more images of one dataset (Section 3.2)'
set xlabel 'radiance samples S' offset 0,0.4
stats times using (strcol(1) eq 'samples' ? $10 : NaN) every ::1 nooutput name 'seconds'
stats times using (strcol(1) eq 'samples' ? $7 : NaN) every ::1 nooutput name 'size'
set yrange [seconds_min / 2:seconds_max * (seconds_max / seconds_min) ** 0.45]  # room for the key
plot for [i=1:3] medians('samples', word(engines, i), 7, 10) using 1:2 with lines lw 2 dt dashes[look(i)] lc rgb color[look(i)] notitle, \
     for [i=1:3] times using (is('samples', word(engines, i)) ? $7 : NaN):10 every ::1 with points pt shape[look(i)] ps size lc rgb color[look(i)] notitle, \
     for [i=1:3] NaN with linespoints lw 2 dt dashes[look(i)] pt shape[look(i)] ps size lc rgb color[look(i)] \
         title sprintf('%s: slope %s', word(names, i), slope('seconds over samples', word(engines, i))), \
     [size_min:size_max] x * seconds_min / size_min * 4 with lines lw 1 dt 3 lc rgb 'black' title 'guide: slope 1'

# Runs that did not time sweeps by themselves have whole iterations of fewer engines.
swept = system(sprintf("head -1 '%s' | grep -c sweep_seconds", times)) > 0
measured = swept ? '1 2 4 5' : '1 2 3'
column_of = swept ? 11 : 10
of = swept ? 'seconds of sweeps over texels' : 'seconds over texels'
names = '"gather: the paper''s passes" "gather: combined passes" "CPU, samples in memory" "gather: compute, texel by texel" "scatter: compute, pixel by pixel"'
set title swept ? 'time of sweeps over the same images, finer maps (Section 6.6)' : 'time of whole iterations (sweeps were not timed), finer maps'
set ylabel (swept ? 'seconds of an iteration in sweeps' : 'seconds per iteration')
set xlabel 'texels in surface location space' offset 0,0.4
set autoscale
stats times using (strcol(1) eq 'texels' && strcol(column_of) ne '' ? column(column_of) : NaN) every ::1 nooutput name 'seconds'
stats times using (strcol(1) eq 'texels' ? $6 : NaN) every ::1 nooutput name 'size'
set yrange [seconds_min / 2:seconds_max * (seconds_max / seconds_min) ** (swept ? 0.75 : 0.45)]
plot for [e in measured] medians('texels', word(engines, e + 0), 6, column_of) using 1:2 with lines lw 2 dt dashes[look(e + 0)] lc rgb color[look(e + 0)] notitle, \
     for [e in measured] times using (is('texels', word(engines, e + 0)) ? $6 : NaN):(column(column_of)) every ::1 \
         with points pt shape[look(e + 0)] ps size lc rgb color[look(e + 0)] notitle, \
     for [e in measured] NaN with linespoints lw 2 dt dashes[look(e + 0)] pt shape[look(e + 0)] ps size lc rgb color[look(e + 0)] \
         title sprintf('%s: slope %s', word(names, e + 0), slope(of, word(engines, e + 0))), \
     [size_min:size_max] x * seconds_min / size_min * 4 with lines lw 1 dt 3 lc rgb 'black' title 'guide: slope 1'

unset logscale
of = 'time with distribution over time without'
costs = sprintf("< grep '^%s,' '%s'", of, summary)
set autoscale
stats costs using 5 nooutput name 'ratio'
set title "finding the pixels of texels anew for every iteration (Section 4.3)\nthe paper: “almost no extra cost”"
set xlabel 'time with it over time with samples kept; whiskers: 95 % interval' offset 0,0.4
unset ylabel
unset key
set format x '%g'
set style fill solid noborder
set xrange [0:ratio_max * 1.4]
set yrange [ratio_records - 0.4:-0.9]
set ytics scale 0
set grid noytics
set arrow 1 from 1.1, graph 0 to 1.1, graph 1 nohead dt 2 lc rgb 'black'
set label 1 'dashed: 1.1 times' at 1.1, graph 0.97 offset 0.6,0
what(engine) = engine eq 'cpu' ? 'CPU' : engine eq 'fragment paper' ? "OpenGL,\nthe paper's\npasses" : engine eq 'compute gather' ? "compute,\ngather" : "compute,\nscatter"
plot costs using ($3 / 2):0:($3 / 2):(0.3):ytic(what(strcol(2))) with boxxyerror lc rgb color[2], \
     costs using 3:0:4:5 with xerrorbars pt -1 lw 2 lc rgb '#333333', \
     costs using 5:0:(sprintf('%.2f%s', $3, interval(of, strcol(2)))) with labels left offset 1,0
unset multiplot
