# What parameters and sums in 16 bits change, against 32 bits throughout: E_t by iteration, as each engine sums it itself, and
# the judge's PSNR at the end. Sums in 16 bits round E_t down, so its difference says nothing about which fit is better: only
# its size is drawn.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1280,620 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,620 font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 0.5 : 0.8
curves = rows . '/curves.csv'
finals = rows . '/finals.csv'
# Parameters are told apart by colour and shape, sums by dashes and hatching.
array color[3] = ['#000000', '#0072b2', '#d55e00']
array shape[3] = [7, 9, 4]
stored = 'fp32 fp16 fp16-truncate'
kept = 'fp32 fp16'
same(s, k, optimizer) = strcol(1) eq optimizer && strcol(2) eq word(stored, s) && strcol(3) eq word(kept, k)
set multiplot title "{/:Bold What 16-bit floats cost, against 32 bits throughout: the paper's mode}\n" . caption \
    . "\nleft: the size of the difference between what the engines sum as the error E_t; sums in 16 bits round it down, which makes no fit better"
set tmargin at screen 0.73
set bmargin at screen 0.15
set grid lt 1 lc rgb '#e4e4e4'
set border 3
set tics nomirror
unset key
set xlabel 'iteration'
set logscale y
set format y '%g'
set yrange [1e-3:*]
do for [panel=1:2] {
    optimizer = word('cg sd', panel)
    set lmargin at screen (panel == 1 ? 0.075 : 0.395)
    set rmargin at screen (panel == 1 ? 0.335 : 0.655)
    set title panel == 1 ? 'conjugate gradients' : 'steepest descent'
    set ylabel panel == 1 ? "|E_t / E_t of 32 bits – 1|, %" : ''
    plot for [k=1:2] for [s=1:3] curves using (same(s, k, optimizer) ? $4 : NaN):(100 * abs($6 - 1)) \
        with linespoints lw 2 dt 2 * k - 1 pt shape[s] ps size lc rgb color[s]
}
unset logscale y
set yrange [*:*]
set format y '%g'
set lmargin at screen 0.735
set rmargin at screen 0.985
set title 'PSNR at the end (hatched: sums fp16)'
set xlabel 'parameters: fp32, fp16, fp16-truncate' offset 0,-0.7
set ylabel 'training images, less that of 32 bits, dB' offset 0.5
set xrange [-0.7:12.7]
single(optimizer) = system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"fp32\" && $3 == \"fp32\" {printf \"%%.2f\", $8}' '%s'", optimizer, finals))
set xtics (sprintf("CG\n32 bits: %s dB", single('cg')) 2.5, sprintf("SD\n32 bits: %s dB", single('sd')) 9.5) scale 0
set style fill solid border -1
place(optimizer, s, k) = (optimizer eq 'cg' ? 0 : 7) + 2 * (s - 1) + (k - 1)
in_group(s, k) = same(s, k, 'cg') || same(s, k, 'sd') ? place(strcol(1), s, k) : NaN
plot for [s=1:3] finals using (in_group(s, 1)):10:(0.7) with boxes fs solid lc rgb color[s], \
    for [s=1:3] finals using (in_group(s, 2)):10:(0.7) with boxes fs pattern 4 lc rgb color[s]
# The legend of all panels is that of a plot of nothing, as wide as the figure.
unset border
unset tics
unset xlabel
unset ylabel
unset title
set lmargin at screen 0.05
set rmargin at screen 0.98
set tmargin at screen 0.87
set bmargin at screen 0.80
set key center center horizontal maxcols 3 Left reverse samplen 5
plot [0:1] [0:1] for [s=1:3] for [k=1:2] NaN with linespoints lw 2 dt 2 * k - 1 pt shape[s] ps size lc rgb color[s] \
    title sprintf('parameters %s, sums %s', word(stored, s), word(kept, k))
unset multiplot
