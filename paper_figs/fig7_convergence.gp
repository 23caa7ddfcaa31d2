# Figure 7: convergence of three problems, the ratio of iterations over all problems, and every optimizer that there is.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1500,720 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1500,720 font 'DejaVu Sans,11'
}
set output output
set linetype 5 lc rgb '#333333'  # the usual one is yellow
array color[3] = ['#0072b2', '#d55e00', '#009e73']
set multiplot layout 2,4 title "{/:Bold Figure 7: error by iteration for three problems, and the ratio of iterations over all problems}\n" . caption \
    margins 0.055,0.985,0.09,0.87 spacing 0.07,0.15
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
shapes = 'star bust'
do for [shape in shapes] {
    curves = rows . '/' . shape . '_curves.csv'
    do for [method in 'cg sd'] {
        name = method eq 'cg' ? 'conjugate gradients' : 'steepest descent'
        set title sprintf('%s, %s', shape, name)
        set xlabel 'iteration'
        set ylabel 'error E_t / best known' offset 1.5
        set logscale y; set format y "%g"
        set yrange [0.97:*]
        set xrange [0:*]
        set key top right
        plot for [i=1:3] curves using (strcol(1) eq method && $2 == i ? $5 : NaN):7 with lines lw 2 lc rgb color[i] title sprintf('problem %d', i), \
             1.01 with lines dt 2 lc rgb '#888888' title '1.01 x best'
    }
    set title sprintf('%s, all problems', shape)
    set xlabel 'SD iterations / CG iterations'
    set ylabel 'share of problems below' offset 0.5
    unset logscale y
    set yrange [0:1]
    set logscale x
    set xrange [0.5:500]
    set key bottom right
    set arrow 1 from 5,0 to 5,1 nohead dt 3 lc rgb '#888888'
    set arrow 2 from 10,0 to 10,1 nohead dt 2 lc rgb '#888888'
    plot rows . '/' . shape . '_ratio.csv' using 1:2 with steps lw 2 lc rgb '#cc79a7' title 'measured', \
         NaN with lines dt 2 lc rgb '#888888' title "the paper's tenth", NaN with lines dt 3 lc rgb '#888888' title 'rule of claim C1'
    unset arrow
    methods = rows . '/' . shape . '_methods.csv'
    stats methods using 1 nooutput
    set title sprintf('%s, every optimizer', shape)
    set xlabel 'iteration'
    set ylabel 'share within 1.01 x best' offset 0.5
    set xrange [1:*]
    set key top left
    set format x '%g'
    plot for [i=2:STATS_columns] methods using 1:i with lines lw 2 title columnheader(i)
    unset logscale x
}
unset multiplot
