# Lafortune's model on the ornament: which share of the texels each solver fits as well as Ceres, how well held-out images are
# reproduced, and how many texels are fitted in a second.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1280,660 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,660 font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 0.65 : 1.0
fits = rows . '/fits.csv'
times = rows . '/times.csv'
images = rows . '/images.csv'
# Methods in the order of the rows, from the top.
methods = ''
add(name) = strstrt(methods, '"' . name . '"') ? 0 : (methods = methods . ' "' . name . '"', 0)
stats times using (add(strcol(2))) every ::1 nooutput
count = words(methods)
place(name) = -(sum [i=1:count] (word(methods, i) eq name ? i : 0))
is_opengl(name) = strstrt(name, 'OpenGL') > 0
stats fits using (is_opengl(strcol(2)) ? $4 : NaN) name 'OPENGL' nooutput
spelt(name) = name eq 'cg modern' ? 'modern CG' : name eq 'cg paper' ? "the paper's CG" : name eq 'sd' ? "the paper's SD" : \
    name eq 'lbfgs' ? 'L-BFGS' : name eq 'adam' ? 'Adam' : name eq 'cg modern OpenGL' ? 'modern CG, OpenGL' : \
    name eq 'Ceres varpro' ? 'Ceres, varpro' : name eq 'TinySolver' ? "Ceres' TinySolver" : name eq 'Lambertian' ? 'Lambertian model' : name
told(name) = is_opengl(name) ? sprintf('%s, %d it.', spelt(name), int(OPENGL_max)) : spelt(name)
set multiplot title "{/:Bold Nine parameters of Lafortune's model in every texel: what each solver reaches}\n" . caption \
    . "\nfound: a root mean square error of at most 1.05 times Ceres'. White is made by another model (Oren–Nayar and Blinn)" \
    . "\nours: the paper has no such figure; what is not Ceres' is radiafit's own"
set tmargin at screen 0.75
set bmargin at screen 0.10
set grid lt 1 lc rgb '#cccccc'
set border 3
set tics nomirror
unset key
set yrange [-count - 0.6:-0.4]
set ytics scale 0 ('' 0)
do for [i=1:count] { set ytics add (told(word(methods, i)) -i) }
# Materials are told apart by shape and colour.
array color[3] = ['#b8860b', '#009e73', '#555555']
array shape[3] = [7, 9, 4]
array left[4] = [0.185, 0.39, 0.595, 0.80]
array part[3] = ['gold', 'green', 'white']
do for [k=1:3] {
    set label k part[k] at screen left[1] + 0.065 * (k - 1) + 0.01,0.82 point pt shape[k] ps 1.2 * size lc rgb color[k] offset 1.2,0
}
array kind[2] = ['noise-free', 'noisy']
found(n, k) = strcol(1) eq kind[n] && strcol(5) eq part[k] ? place(strcol(2)) + 0.22 * (2 - k) : NaN
seen(n, k) = strcol(1) eq kind[n] && strcol(4) eq part[k] ? place(strcol(2)) + 0.22 * (2 - k) : NaN
set xlabel 'texels, %' offset 0,0.4
set xrange [-3:103]
do for [n=1:2] {
    set lmargin at screen left[n]
    set rmargin at screen left[n] + 0.18
    set title 'found, ' . kind[n] . ' images'
    plot for [k=1:3] fits using (100 * $9):(found(n, k)) with points pt shape[k] ps size lc rgb color[k]
    unset label
    set ytics scale 0 ('' 0)
    do for [i=1:count] { set ytics add ('' -i) }
}
set lmargin at screen left[3]
set rmargin at screen left[3] + 0.18
set title 'held-out noisy images'
set xlabel 'PSNR, dB'
set xrange [*:*]
plot for [k=1:3] images using 6:(seen(2, k)) with points pt shape[k] ps size lc rgb color[k]
set lmargin at screen left[4]
set rmargin at screen left[4] + 0.18
set title 'speed, one run'
set xlabel 'texels fitted in a second'
set logscale x
set format x '10^{%L}'
at(n) = strcol(1) eq kind[n] ? place(strcol(2)) : NaN
do for [n=1:2] { set label n kind[n] at screen left[4] + 0.1 * (n - 1),0.82 point pt 5 * n - 4 ps 1.2 * size offset 1.2,0 }
plot for [n=1:2] times using 10:(at(n)) with points pt 5 * n - 4 ps 1.2 * size lc rgb '#000000'
unset multiplot
