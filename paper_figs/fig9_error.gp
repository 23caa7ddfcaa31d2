# Figure 9: PSNR and average pixel error (APE) of every method with one term, and PSNR by number of terms.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
errors = rows . '/errors.csv'
names = system(sprintf("tail -n +2 '%s' | cut -d, -f1 | uniq", errors))
count = words(names)
lower = int((count + 1) / 2)  # rows of panels by terms, two datasets in each
height = 680 + 260 * lower
if (terminal eq 'svg') {
    set terminal svg size 1280,height font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,height font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 0.65 : 0.9
down(pixels) = 1 - real(pixels) / height
awk(program) = system(sprintf("awk -F, '%s' '%s'", program, errors))
is(dataset, method, weights) = strcol(1) eq dataset && strcol(3) eq method && strcol(4) eq weights
of(dataset, method, weights) = \
    sprintf("< awk -F, '$1 == \"%s\" && $3 == \"%s\" && $4 == \"%s\"' '%s'", dataset, method, weights, errors)
cell(method, weights, column) = awk(sprintf('$3 == "%s" && $4 == "%s" {print $%d; exit}', method, weights, column))
pair(dataset, method) = dataset . ' ' . \
    awk(sprintf('$1 == "%s" && $3 == "%s" && $4 == "chosen" {print $14 " and " $15; exit}', dataset, method))
chosen(method) = pair(word(names, 1), method) . (count > 1 ? ', ' . pair(word(names, 2), method) : '') \
    . (count > 2 ? ', ' . pair(word(names, 3), method) : '')
texels(method) = sprintf('%.0f surface and %d view texels', cell(method, 'chosen', 22) + 0, cell(method, 'chosen', 7) ** 2)
brief = cell('cg-low-brief', 'chosen', 12)

# Methods from the top, those of the high resolution and then those of the low one.
array method[9] = ['pca-published', 'pca-refilled', 'cg-high', 'cg-high', 'cg-high', 'cg-modern-high', 'cg-low', 'cg-low-brief', \
    'cg-low-fp16']
array weights[9] = ['', '', '0.0001', '0.001', 'chosen', 'chosen', 'chosen', 'chosen', 'chosen']
array what[9] = ['PCA as published', sprintf('PCA, refilled %s times', cell('pca-refilled', '', 13)), 'CG, λ = 10^{–4}', \
    'CG, λ = 10^{–3}', 'CG, λ chosen', 'modern CG, λ chosen', 'CG, CPU, 32 bits', \
    sprintf('the same, %s iterations', brief), sprintf('CG, OpenGL, 16 bits, %s it.', brief)]
place(i) = -i - (i > 6)
# Datasets are told apart by shape and colour.
array color[3] = ['#0072b2', '#d55e00', '#009e73']
array shape[3] = [7, 4, 9]
array title[4] = ['PSNR, training images', 'PSNR, held-out images', 'APE, training images', 'APE, held-out images']
array column_of[4] = [16, 18, 17, 19]
# one range for both figures of a kind
array from[2]
array to[2]
do for [kind=1:2] {
    stats sprintf("< awk -F, '$5 == 1 && $3 != \"mean\" {print $%d; print $%d}' '%s'", column_of[2 * kind - 1], \
        column_of[2 * kind], errors) using 1 nooutput name 'range'
    from[kind] = range_min - 0.05 * (range_max - range_min)
    to[kind] = range_max + 0.05 * (range_max - range_min)
}
stats errors using 5 every ::1 nooutput name 'terms'
stats sprintf("< awk -F, '$3 == \"pca-refilled\" || $3 == \"cg-low\" || $3 == \"cg-high\" && $4 == \"chosen\" " \
    . "{print $16; print $18}' '%s'", errors) using 1 nooutput name 'psnr'

set multiplot title "{/:Bold Figure 9: error of factorization (PCA) and of nonlinear optimization (CG, conjugate gradients)}\n" \
    . caption . sprintf("\nCG: the paper's mode, %s iterations (modern CG %s); OpenGL: the paper's passes, storage and sums in 16 bits\n" \
    . "λ: weights of smoothness, of surface maps and of view maps, chosen on validation images:\n" \
    . "high resolution: %s; low: %s", \
    cell('cg-high', 'chosen', 12), cell('cg-modern-high', 'chosen', 12), chosen('cg-high'), chosen('cg-low'))
set border 3
set tics nomirror
set grid lt 1 lc rgb '#cccccc'
unset key
set tmargin at screen down(185)
set bmargin at screen down(540)
set yrange [place(9) - 0.7:0.5]
set ytics scale 0 (sprintf('%s:', texels('cg-high')) 0, sprintf('%s:', texels('cg-low')) -7)
do for [i=1:9] { set ytics add (what[i] place(i)) }
set label 10 'one term; a point for each object (seed of the generator):' at screen 0.205,down(139)
do for [d=1:count] {
    set label d word(names, d) at screen 0.56 + 0.07 * (d - 1),down(139) point pt shape[d] ps 1.2 * size lc rgb color[d] offset 1.2,0
}
do for [p=1:4] {
    kind = p < 3 ? 1 : 2
    set lmargin at screen 0.205 + 0.199 * (p - 1)
    set rmargin at screen 0.205 + 0.199 * (p - 1) + 0.18
    set title title[p]
    set xlabel (kind == 1 ? 'dB' : 'mean |difference|, 0 to 255') offset 0,0.4
    set xrange [from[kind]:to[kind]]
    plot for [d=1:count] for [i=1:9] errors \
        using (is(word(names, d), method[i], weights[i]) && $5 == 1 ? column(column_of[p]) : NaN):(place(i) + 0.15 * (count + 1 - 2 * d)) \
        with points pt shape[d] ps size lw 1.5 lc rgb color[d]
    unset label
    set format y ''
    set ytics scale 0 ('' 0)
    do for [i=1:9] { set ytics add ('' place(i)) }
}

array shown[3] = ['pca-refilled', 'cg-high', 'cg-low']
array shown_as[3] = ['PCA, refilled', 'CG, high resolution', 'CG, low resolution']
array shown_weights[3] = ['', 'chosen', 'chosen']
array point[3] = [5, 7, 9]
set format y '%g'
set ytics auto scale 1
set xtics 1
set xlabel 'terms K' offset 0,0.4
set xrange [0.7:terms_max + 0.3]
set yrange [psnr_min - 0.5:psnr_max + 0.5]
do for [i=1:3] { set label i shown_as[i] at screen 0.06 + 0.14 * (i - 1),down(618) point pt point[i] ps 1.2 * size offset 1.2,0 }
do for [d=1:count] {
    seed = awk(sprintf('$1 == "%s" {print $2; exit}', word(names, d)))
    do for [part=1:2] {
        across = 2 * ((d - 1) % 2) + part - 1
        above = 260 * int((d - 1) / 2)
        set lmargin at screen 0.045 + 0.24 * across
        set rmargin at screen 0.045 + 0.24 * across + 0.205
        set tmargin at screen down(665 + above)
        set bmargin at screen down(880 + above)
        set title sprintf('%s, %s images', word(names, d), part == 1 ? 'training' : 'held-out')
        set ylabel (across == 0 ? 'PSNR, dB' : '')
        plot for [i=1:3] of(word(names, d), shown[i], shown_weights[i]) \
            using (strcol(2) eq seed ? $5 : NaN):(column(part == 1 ? 16 : 18)) \
            with linespoints pt point[i] ps 1.2 * size lw 1.5 lc rgb '#000000' dt i
        unset label
    }
}
unset multiplot
