# Figure 7, star beside bust, from above: convergence of three problems, the ratio of iterations over all problems, every solver,
# and the ends. The legend of a row stands right of it.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
set datafile columnheaders
set datafile missing NaN  # rows that a line leaves out do not break it
height = 1450
if (terminal eq 'svg') {
    set terminal svg size 1280,height font 'DejaVu Sans,13' background 'white'
    size = 0.6
} else {
    set terminal pngcairo size 1280,height font 'DejaVu Sans,11'
    size = 0.9
}
set output output
# Lines are told apart by colour and by dashes, the three problems by shapes.
array color[8] = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#e69f00', '#333333', '#999999']
array shape[3] = [7, 9, 4]
array dashes[7] = [1, 2, 4, 1, 5, 2, 1]
problems = rows . '/problems.csv'
curves = rows . '/curves.csv'
ends = rows . '/ends.csv'
summary = rows . '/summary.csv'
# the lambdas, as they come in the rows: the first is the one that claims are judged at
lambdas = system(sprintf("awk -F, 'NR > 1 && !($2 in seen) { seen[$2]; printf \"%%s \", $2 }' '%s'", summary))
judged = word(lambdas, 1) + 0
stats summary using ($2 == judged ? column('cap') : NaN) nooutput
cap = STATS_max
down(pixels) = 1 - real(pixels) / height
set multiplot title "{/:Bold Figure 7: how fast conjugate gradients (CG) and steepest descent (SD) converge, and to which ends}\n" . caption
set grid lt 1 lc rgb '#e4e4e4'
set border 3
set tics nomirror
of(name) = strcol('dataset') eq name
floor_(x) = x < 1e-7 ? 1e-7 : x  # out of the figure
above(over_best) = floor_(over_best - 1)
curve(method, i) = of(name) && strcol('method') eq method && column('shown') == i ? column('iteration') : NaN
is_power_of_two(x) = x > 0 && 2 ** floor(log(x) / log(2) + 0.5) == x
mark(method, i) = is_power_of_two(column('iteration')) ? curve(method, i) : NaN
# The arrows of a dataset's first panel are what the paper tells of its "Optim 2": iterations, and no level of error.
do for [at_right=0:1] {
    name = word('star bust', 1 + at_right)
    set lmargin at screen 0.075 + 0.36 * at_right
    set rmargin at screen 0.075 + 0.36 * at_right + 0.305

    set tmargin at screen down(118)
    set bmargin at screen down(375)
    set logscale xy
    set title sprintf('%s: three problems drawn by seed', name)
    set xlabel 'iteration, logarithmic: the start is left out' offset 0,0.4
    set ylabel (at_right == 0 ? "error above the least known,\nas a share of it" : '')
    set xrange [1:cap * 1.3]
    set yrange [1e-5:1e3]
    set format x '%g'
    set format y '10^{%T}'
    set arrow 1 from 25, graph 0 to 25, graph 0.07 nohead lw 3 lc rgb 'black'
    set arrow 2 from 250, graph 0 to 250, graph 0.07 nohead lw 3 lc rgb 'black'
    set label 1 'CG 25' at 25, graph 0.105 center
    set label 2 'SD 250' at 250, graph 0.105 center
    if (at_right) { set key at screen 0.752,down(118) left top Left reverse samplen 3 } else { unset key }
    plot for [i=1:3] curves using (curve('cg', i)):(above(column('error_over_best'))) with lines lw 2 lc rgb color[i] notitle, \
         for [i=1:3] curves using (curve('sd', i)):(above(column('error_over_best'))) with lines lw 2 dt 2 lc rgb color[i] notitle, \
         for [i=1:3] curves using (mark('cg', i)):(above(column('error_over_best'))) with points pt shape[i] ps size lc rgb color[i] notitle, \
         for [i=1:3] curves using (mark('sd', i)):(above(column('error_over_best'))) with points pt shape[i] ps size lc rgb color[i] notitle, \
         for [i=1:3] NaN with linespoints lw 2 pt shape[i] ps size lc rgb color[i] title sprintf('problem %d, CG', i), \
         for [i=1:3] NaN with linespoints lw 2 dt 2 pt shape[i] ps size lc rgb color[i] title sprintf('problem %d, SD', i), \
         curves using (of(name) && column('iteration') == cap ? cap : NaN):(column('error_over_best') > 1.01 ? column('error_over_best') - 1 : 1e-9) \
             with points pt 6 ps 2 * size lw 2 lc rgb '#333333' title sprintf('not there after %d', cap), \
         0.01 with lines lw 1.5 lc rgb '#888888' title '1 %: converged (our choice)', \
         NaN with lines lw 3 lc rgb 'black' title "at the axis: the paper's “Optim 2”", \
         NaN with lines lc rgb 'white' title 'needs about 25 iterations of CG,', \
         NaN with lines lc rgb 'white' title '250 of SD, to an error not told'
    unset arrow
    unset label

    unset logscale y
    set format y '%g'
    set tmargin at screen down(473)
    set bmargin at screen down(710)
    set title sprintf('%s: every problem measured', name)
    set xlabel 'SD iterations / CG iterations, to 1 % above'
    set ylabel (at_right == 0 ? 'share of problems below' : '')
    set yrange [0:1]
    set xrange [0.5:500]
    if (at_right) { set key at screen 0.752,down(473) }
    set arrow 1 from 5,0 to 5,1 nohead dt 3 lw 2 lc rgb '#666666'
    set arrow 2 from 10,0 to 10,1 nohead lw 1.5 lc rgb '#666666'
    ratio(sd, cg, cap) = (sd < 0 ? cap : sd < 1 ? 1 : sd) / 1.0 / (cg < 0 ? cap : cg < 1 ? 1 : cg)
    capof(i) = real(system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"%s\" { print $4 }' '%s'", name, word(lambdas, i), summary)))
    array caps[words(lambdas)]
    do for [i=1:words(lambdas)] { caps[i] = capof(i) }
    at(i) = of(name) && column('lambda') == word(lambdas, i) + 0
    plot for [i=1:words(lambdas)] problems using (at(i) ? ratio(column('sd'), column('cg_paper'), caps[i]) : NaN):(1) smooth cnormal \
             with lines lw (i == 1 ? 3 : 2) dt 1 + (i > 1) * (1 + i) lc rgb color[3 + i] title sprintf('λ = %s (cap %d)', word(lambdas, i), caps[i]), \
         problems using (at(1) && column('sd') >= 0 && column('cg_paper') >= 0 ? ratio(column('sd'), column('cg_paper'), cap) : NaN):(1) smooth cnormal \
             with lines lw 2 dt 2 lc rgb color[4] title sprintf('λ = %s, both arrive', word(lambdas, 1)), \
         NaN with lines lw 1.5 lc rgb '#666666' title "the paper's 10", NaN with lines dt 3 lw 2 lc rgb '#666666' title 'rule of claim C1: 5', \
         NaN with lines lc rgb 'white' title 'cap: who is not there by then', \
         NaN with lines lc rgb 'white' title 'counts as arriving then'
    unset arrow

    set tmargin at screen down(808)
    set bmargin at screen down(1045)
    stats problems using (at(1) ? 1 : NaN) nooutput
    set title sprintf('%s: every solver, λ = %s', name, word(lambdas, 1))
    set xlabel 'iteration, logarithmic'
    set ylabel (at_right == 0 ? 'share of problems within 1 %' : '')
    set xrange [1:cap]
    if (at_right) { set key at screen 0.752,down(808) }
    names = 'varpro cg_modern lbfgs cg_paper adam sd_growing sd'
    shown(name) = name eq 'varpro' ? "Newton's steps" : name eq 'cg_modern' ? 'modern CG' : name eq 'lbfgs' ? 'L-BFGS' : name eq 'cg_paper' ? "the paper's CG" : \
                  name eq 'adam' ? 'Adam' : name eq 'sd_growing' ? 'SD, growing step' : "the paper's SD"
    plot for [i=1:words(names)] problems using (at(1) && column(word(names, i)) >= 0 ? column(word(names, i)) : NaN):(1.0 / STATS_records) smooth cumulative \
        with lines lw (word(names, i) eq 'cg_paper' || word(names, i) eq 'sd' ? 3.5 : 2) dt dashes[i] lc rgb color[i] title shown(word(names, i))

    set tmargin at screen down(1143)
    set bmargin at screen down(1390)
    stats ends using (of(name) ? 1 : NaN) nooutput
    set title sprintf('%s: ends of %d problems that run on', name, STATS_records)
    set xlabel "SD's error / CG's error"
    set ylabel (at_right == 0 ? 'share of problems below' : '')
    set xrange [0.9:1.3]
    unset logscale x
    if (at_right) { set key at screen 0.752,down(1143) }
    set arrow 1 from 0.99,0 to 0.99,1 nohead dt 3 lw 2 lc rgb '#666666'
    set arrow 2 from 1.01,0 to 1.01,1 nohead dt 3 lw 2 lc rgb '#666666'
    plot ends using (of(name) ? column('sd_error') / column('cg_error') : NaN):(1.0 / STATS_records) smooth cumulative \
             with lines lw 2 dt 2 lc rgb color[4] title "at rest, or at the cap", \
         ends using (of(name) ? column('sd_minimum') / column('cg_minimum') : NaN):(1.0 / STATS_records) smooth cumulative \
             with lines lw 3 lc rgb color[4] title 'followed down to their minima', \
         NaN with lines dt 3 lw 2 lc rgb '#666666' title '1 % apart', \
         NaN with lines lc rgb 'white' title 'right of 1: CG ends lower'
    unset arrow
}
unset multiplot
