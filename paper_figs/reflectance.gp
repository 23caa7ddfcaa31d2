# Lafortune's model on the ornament: which share of the texels each solver fits as well as Ceres, and how many it fits in a
# second.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1400,560 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1400,560 font 'DejaVu Sans,11'
}
set output output
fits = rows . '/fits.csv'
times = rows . '/times.csv'
# Methods in the order of the rows. OpenGL's, the last, is stopped early, for its time: its rate is not one of finished
# fits, and says so.
methods = ''
add(name) = strstrt(methods, '"' . name . '"') ? 0 : (methods = methods . ' "' . name . '"', 0)
stats times using (add(strcol(2))) every ::1 nooutput
index_of(name) = sum [i=1:words(methods)] (word(methods, i) eq name ? i : 0)
in_lines(name) = strstrt(name, ' ') ? name[1:strstrt(name, ' ') - 1] . "\n" . in_lines(name[strstrt(name, ' ') + 1:]) : name
count = words(methods)
is_opengl(name) = strstrt(name, 'OpenGL') > 0
finished = is_opengl(word(methods, count)) ? count - 1 : count
stats fits using (is_opengl(strcol(2)) ? $4 : NaN) name 'OPENGL' nooutput
early(name) = is_opengl(name) ? sprintf(",\n%d iterations\nonly", int(OPENGL_max)) : ''
set multiplot title "{/:Bold Nine parameters of Lafortune's model per texel: what each solver reaches}\n" . caption
set tmargin at screen 0.76
set bmargin at screen 0.17
set grid y lc rgb '#dddddd'
set border 3
set tics nomirror
set style fill solid 0.9 border -1
set xtics () scale 0
do for [i=1:count] { set xtics add (in_lines(word(methods, i)) . early(word(methods, i)) i) }
set lmargin at screen 0.08
set rmargin at screen 0.52
set yrange [0:105]
set xrange [0.4:finished + 0.6]
set ylabel "texels within 1.05 of Ceres, noisy images, %" offset 1
set key at screen 0.52, screen 0.85 right horizontal
of(group) = strcol(1) eq 'noisy' && strcol(5) eq group ? index_of(strcol(2)) : NaN
plot fits using (of('moderate lobes') - 0.2):(100 * $9):(0.38) with boxes lc rgb '#0072b2' title 'moderate lobes', \
    fits using (of('sharp lobes') + 0.2):(100 * $9):(0.38) with boxes lc rgb '#d55e00' title 'sharp lobes'
set lmargin at screen 0.61
set rmargin at screen 0.98
set key at screen 0.98, screen 0.85 right
set ylabel 'texels fitted in a second' offset 1
set xrange [0.4:count + 0.6]
set logscale y
set yrange [10:*]
set format y '10^{%L}'
at(images) = strcol(1) eq images ? index_of(strcol(2)) : NaN
plot times using (at('noise-free') - 0.2):10:(0.38) with boxes lc rgb '#999999' title 'noise-free images', \
    times using (at('noisy') + 0.2):10:(0.38) with boxes lc rgb '#555555' title 'noisy images'
unset multiplot
