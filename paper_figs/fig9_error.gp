# Figure 9: PSNR and average pixel error by number of terms, one row of panels per dataset.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
errors = rows . '/errors.csv'
names = system(sprintf("tail -n +2 '%s' | cut -d, -f1 | uniq", errors))
count = words(names)
height = 120 + 280 * count
if (terminal eq 'svg') {
    set terminal svg size 1300,height font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1300,height font 'DejaVu Sans,11'
}
set output output
array method[4] = ['pca', 'cpu-high', 'cpu-low', 'fragment-fp16']
array what[4] = ['factorization (PCA), fp32', 'nonlinear, CPU, fp32', 'nonlinear, CPU, fp32', 'nonlinear, OpenGL, fp16']
array color[4] = ['#d55e00', '#0072b2', '#009e73', '#cc79a7']
array point[4] = [5, 7, 9, 6]
array size[4] = [1, 1, 1.2, 1.9]
array title[4] = ['PSNR, training views', 'PSNR, held-out views', 'APE, training views', 'APE, held-out views']
array unit[4] = ['dB', 'dB', 'APE (0 to 255)', 'APE (0 to 255)']
array value[4] = [8, 10, 9, 11]
of(dataset, m) = sprintf("< grep '^%s,%s,' '%s'", dataset, m, errors)
texels(n, m) = sprintf('%d surface, %d view texels', n * (n + 1) / 2, m * m)
set multiplot layout count,4 title "{/:Bold Figure 9: error of factorization and of nonlinear optimization, by terms K}\n" . caption \
    margins 0.05,0.99,60.0/height,1-136.0/height spacing 0.055,92.0/height
set border 3
set tics nomirror
set grid ytics lc rgb '#dddddd'
set offsets 0,0,graph 0.08,graph 0.08
set xtics 1
set xlabel 'terms K' offset 0,0.5
unset key
array at[5] = [0.03, 0.25, 0.455, 0.655, 0.87]
do for [k=1:4] {
    stats of('[^,]*', method[k]) using 4:5 nooutput name 'side'
    set label k sprintf("%s\n%s", what[k], texels(side_max_x, side_max_y)) at screen at[k],1-62.0/height tc rgb color[k] point pt point[k] ps size[k] lc rgb color[k] offset 1.2,0
}
set label 5 "– – mean colour\nper texel" at screen at[5],1-62.0/height tc rgb '#777777'
stats of('[^,]*', 'pca') using 3 nooutput name 'terms'
do for [d=1:count] {
    name = word(names, d)
    do for [p=1:4] {
        set title sprintf('%s: %s', name, title[p])
        set ylabel unit[p] offset 1.5
        stats of(name, 'mean') using (column(value[p])) nooutput name 'mean'
        plot [0.7:terms_max + 0.3] mean_max with lines dt 2 lc rgb '#777777', \
             for [k=1:4] of(name, method[k]) using 3:(column(value[p])) with linespoints pt point[k] ps size[k] lw 1.5 lc rgb color[k]
        unset for [k=1:5] label k
    }
}
unset multiplot
