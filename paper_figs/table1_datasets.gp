# Above: one photograph of each dataset. Below: the share of its texels that get at most so many samples (Section 5.1.1).
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
datasets = rows . '/datasets.csv'
# all cells as words, row by row, empty ones as -
cells = system(sprintf("awk -F, '{for (i = 1; i <= NF; ++i) printf \"%%s \", $i == \"\" ? \"-\" : $i}' '%s'", datasets))
across = int(system(sprintf("awk -F, 'NR == 1 {print NF}' '%s'", datasets)))
n = words(cells) / across - 1
# of the i-th dataset and way to choose sides
text(i, column) = word(cells, i * across + (sum [k=1:across] (word(cells, k) eq column ? k : 0)))
field(i, column) = real(text(i, column))
width = n < 3 ? 820 : n * 256 > 1280 ? 256 * n : 1280
if (terminal eq 'svg') {
    set terminal svg size width,820 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size width,820 font 'DejaVu Sans,11'
}
set output output
set multiplot title "{/:Bold Datasets, and how many samples their texels get}\n" . caption . "\nred, dashed: 10 samples; grey, dotted: the median"
left(i) = 0.025 + 0.97 * (i - 1.0) / n + 0.03
right(i) = 0.025 + 0.97 * real(i) / n - 0.01
count(x) = x < 9999.5 ? sprintf('%d', x) : x < 999999.5 ? sprintf('%.3g thousand', x / 1e3) : sprintf('%.3g million', x / 1e6)
do for [i=1:n] {
    name = text(i, 'dataset')
    own_sides = text(i, 'sides') eq 'own'
    set lmargin at screen left(i)
    set rmargin at screen right(i)
    set tmargin at screen 0.76
    set bmargin at screen 0.515
    unset border
    unset tics
    unset key
    unset arrow
    unset label
    set size ratio -1
    set autoscale
    set title sprintf("{/:Bold %s}%s\n%d triangles,\n%d images, %.1f MB;\n%s problems,\n%s parameters", name, own_sides ? ', sides by size' : '', field(i, 'triangles'), \
        field(i, 'images'), field(i, 'image_bytes') / 1e6, count(field(i, 'problems')), count(field(i, 'parameters')))
    unset xlabel
    unset ylabel
    plot rows . '/' . name . '.png' binary filetype=png with rgbimage
    middle = field(i, 'median_samples_per_texel')
    file = rows . '/' . name . (own_sides ? '_own_sides' : '') . '_samples_per_texel.csv'
    stats file using 2 every ::1 nooutput name 'texels'
    set size noratio
    set tmargin at screen 0.375
    set bmargin at screen 0.09
    set border 3
    set ytics nomirror
    set grid lt 1 lc rgb '#e4e4e4'
    set title sprintf("%.2f texels per covered pixel;\n%.0f %% of the pixels are taken;\na texel gets %g samples\n(median), %.1f %% get none", \
        field(i, 'texels_per_pixel'), 100 * field(i, 'kept_share'), middle, 100 * field(i, 'without_samples_share'))
    set xlabel 'samples of a texel'
    if (i == 1) { set ylabel 'texels with at most so many, %' offset 1 }
    most = middle < 10 ? 30 : 3 * middle
    set xrange [0:most]
    step = most > 250 ? 100 : most > 100 ? 50 : most > 40 ? 20 : 10
    set xtics step nomirror
    set yrange [0:100]
    set arrow from 10,0 to 10,100 nohead dt 2 lc rgb '#d55e00'
    set label '10' at 10,100 offset 0.4,-0.6 tc rgb '#d55e00'
    set arrow from 0,50 to middle,50 nohead dt 3 lc rgb '#888888'
    set arrow from middle,0 to middle,50 nohead dt 3 lc rgb '#888888'
    plot file using 1:(100 * $2 / texels_sum) every ::1 smooth cumulative with steps lw 2 lc rgb '#0072b2'
}
unset multiplot
