# Bytes over parameters; seconds of an iteration over samples and over texels, every repetition a point, medians joined;
# and what it costs to distribute pixels for every iteration. All but the last logarithmic, with a guide of slope 1.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1280,960 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,960 font 'DejaVu Sans,11'
}
set output output
memory = rows . '/memory.csv'
times = rows . '/time.csv'
summary = rows . '/summary.csv'
field(of, engine, column) = system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"%s\" {printf \"%%s\", $%d}' '%s'", of, engine, column, summary))
interval(of, engine) = field(of, engine, 4) eq '' ? '' : sprintf(' (%.2f to %.2f)', real(field(of, engine, 4)), real(field(of, engine, 5)))
slope(of, engine) = sprintf('%.2f', real(field(of, engine, 3))) . interval(of, engine)
array color[5] = ['#0072b2', '#56b4e9', '#d55e00', '#e69f00', '#009e73']
set multiplot layout 2,2 title "{/:Bold Memory and time against the size of the problem: the paper's conjugate gradients}\n" . caption \
    margins 0.07,0.975,0.07,0.885 spacing 0.085,0.125
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
set logscale xy
set format x '%.0s%c'
set format y '%g'

stats memory using 4 every ::1 nooutput name 'side'
set title sprintf('memory of the OpenGL engine, maps of side %d to %d (Section 6.3)', side_min, side_max)
set xlabel 'parameters N' offset 0,0.4
set ylabel 'MB' offset 1
set key bottom right samplen 3 opaque
stats memory using ($10 / 1e6) every ::1 nooutput name 'megabytes'
stats memory using 7 every ::1 nooutput name 'parameters'
set yrange [megabytes_min / 8:megabytes_max * 1.5]
kinds = '"paper fp32" "paper fp16" "combined fp32" "combined fp16"'
kind(passes, storage) = passes . ' ' . storage
plot for [i=1:4] memory using (kind(strcol(3), strcol(2)) eq word(kinds, i) ? $7 : NaN):($10 / 1e6) \
         with linespoints lw 2 pt 7 lc rgb color[i] \
         title sprintf('%s passes, %s: slope %.2f', word(word(kinds, i), 1), word(word(kinds, i), 2), \
                       real(field('bytes over parameters', 'fragment ' . word(kinds, i), 3))), \
     for [i=1:4] memory using (kind(strcol(3), strcol(2)) eq word(kinds, i) ? $7 : NaN):($8 / 1e6) \
         with points pt 4 ps 1.6 lc rgb color[i] title (i == 1 ? 'radiafit plan' : ''), \
     memory using (kind(strcol(3), strcol(2)) eq 'paper fp32' ? $7 : NaN):($12 / 1e6) \
         with lines lw 2 dt 2 lc rgb '#888888' title "Section 6.3's accounting, fp32", \
     [parameters_min:parameters_max] x * megabytes_min / parameters_min * 0.6 with lines lw 1 dt 3 lc rgb 'black' title 'guide: slope 1', \
     [parameters_min:parameters_max] 142 with lines lw 1 dt 4 lc rgb '#009e73' title "142 MB, the paper's star"

# Medians over repetitions by size, a column of time.csv.
medians_of(part, engine, size, seconds) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" {print $%d, $%d}' '%s' | sort -g -k 1,1 -k 2,2 | awk 'n && $1 != x {print x \",\" y[int((n + 1) / 2)]; n = 0} {x = $1; y[++n] = $2} END {print x \",\" y[int((n + 1) / 2)]}'", part, engine, size, seconds, times)
medians(part, engine, size) = medians_of(part, engine, size, 10)
sweeps(part, engine, size) = medians_of(part, engine, size, 11)
engines = '"fragment paper" "fragment combined" "cpu"'
names = '"OpenGL, the paper''s passes" "OpenGL, combined passes" "CPU, samples in memory"'
of_engine(i) = color[i == 1 ? 1 : i == 2 ? 3 : 2]
part = 'samples'
is(i) = strcol(1) eq part && strcol(2) eq word(engines, i)
set ylabel 'seconds per iteration' offset 1
set key top left Left reverse
set title 'time over samples: more images of one dataset (Section 3.2)'
set xlabel 'radiance samples S' offset 0,0.4
set autoscale
stats times using (strcol(1) eq part ? $10 : NaN) every ::1 nooutput name 'seconds'
stats times using (strcol(1) eq part ? $7 : NaN) every ::1 nooutput name 'size'
set yrange [seconds_min / 2:seconds_max * (seconds_max / seconds_min) ** 0.45]  # room for the key
plot for [i=1:3] medians(part, word(engines, i), 7) using 1:2 with lines lw 2 lc rgb of_engine(i) \
         title sprintf('%s: slope %s', word(names, i), slope('seconds over samples', word(engines, i))), \
     for [i=1:3] times using (is(i) ? $7 : NaN):10 every ::1 with points pt 7 ps 0.5 lc rgb of_engine(i) notitle, \
     [size_min:size_max] x * seconds_min / size_min * 4 with lines lw 1 dt 3 lc rgb 'black' title 'guide: slope 1'

part = 'texels'
engines = '"fragment paper" "fragment combined" "compute gather" "compute scatter"'
names = '"gather: the paper''s passes" "gather: combined passes" "gather: compute, texel by texel" "scatter: compute, pixel by pixel"'
of_sweeps(i) = color[i == 1 ? 1 : i == 2 ? 3 : i == 3 ? 4 : 5]
set title 'time of sweeps over the same images, finer maps (Section 6.6)'
set ylabel 'seconds of an iteration in sweeps' offset 1
set xlabel 'texels in surface location space' offset 0,0.4
set autoscale
stats times using (strcol(1) eq part && strcol(11) ne '' ? $11 : NaN) every ::1 nooutput name 'seconds'
stats times using (strcol(1) eq part ? $6 : NaN) every ::1 nooutput name 'size'
set yrange [seconds_min / 2:seconds_max * (seconds_max / seconds_min) ** 0.75]
plot for [i=1:4] sweeps(part, word(engines, i), 6) using 1:2 with lines lw 2 lc rgb of_sweeps(i) \
         title sprintf('%s: slope %s', word(names, i), slope('seconds of sweeps over texels', word(engines, i))), \
     for [i=1:4] times using (is(i) ? $6 : NaN):11 every ::1 with points pt 7 ps 0.5 lc rgb of_sweeps(i) notitle, \
     [size_min:size_max] x * seconds_min / size_min * 4 with lines lw 1 dt 3 lc rgb 'black' title 'guide: slope 1'

unset logscale
of = 'time with distribution over time without'
set title 'cost of finding the pixels of texels anew for every iteration (Section 4.3)'
set xlabel 'time of an iteration with it, over that with samples kept' offset 0,0.4
unset ylabel
unset key
set format x '%g'
set style fill solid noborder
set autoscale
stats summary using (strcol(1) eq of ? $5 : NaN) every ::1 nooutput name 'ratio'
set xrange [0:ratio_max * 1.35]
set yrange [3.7:-0.7]
set ytics scale 0
set arrow 1 from 1.1, graph 0 to 1.1, graph 1 nohead dt 2 lc rgb 'black'
set label 1 'at most 1.1: "almost no extra cost"' at 1.1, graph 0.03 offset 0.6,0
row(engine) = engine eq 'cpu' ? 3 : engine eq 'compute scatter' ? 2 : engine eq 'compute gather' ? 1 : 0
what(engine) = engine eq 'cpu' ? 'CPU' : engine eq 'fragment paper' ? "OpenGL,\nthe paper's\npasses" : engine eq 'compute gather' ? "compute,\ngather" : "compute,\nscatter"
plot summary using (strcol(1) eq of ? $3 / 2 : NaN):(row(strcol(2))):($3 / 2):(0.3):ytic(what(strcol(2))) every ::1 \
         with boxxyerror lc rgb color[2], \
     summary using (strcol(1) eq of ? $3 : NaN):(row(strcol(2))):4:5 every ::1 with xerrorbars pt -1 lw 2 lc rgb '#333333', \
     summary using (strcol(1) eq of ? $3 : NaN):(row(strcol(2))):(sprintf('%.2f%s', $3, interval(of, strcol(2)))) every ::1 \
         with labels left offset 1,-1
unset multiplot
