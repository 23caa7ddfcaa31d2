# Figure 7: convergence of three problems, the ratio of iterations over all problems, every solver, and the ends.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
set datafile columnheaders
set datafile missing NaN  # rows that a line leaves out do not break it
if (terminal eq 'svg') {
    set terminal svg size 1780,1060 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1780,1060 font 'DejaVu Sans,11'
}
set output output
array color[8] = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#e69f00', '#333333', '#999999']
problems = rows . '/problems.csv'
curves = rows . '/curves.csv'
ends = rows . '/ends.csv'
summary = rows . '/summary.csv'
# the lambdas, as they come in the rows: the first is the one that claims are judged at
lambdas = system(sprintf("awk -F, 'NR > 1 && !($2 in seen) { seen[$2]; printf \"%%s \", $2 }' '%s'", summary))
judged = word(lambdas, 1) + 0
stats summary using ($2 == judged ? column('cap') : NaN) nooutput
cap = STATS_max
floor_(x) = x < 2e-5 ? 2e-5 : x
set multiplot layout 2,4 title "{/:Bold Figure 7: how fast conjugate gradients (CG) and steepest descent (SD) converge, and to which ends}\n" . caption \
    margins 0.045,0.99,0.06,0.90 spacing 0.055,0.27
set grid lc rgb '#dddddd'
set border 3
set tics nomirror
of(name) = strcol('dataset') eq name
# The legends of both rows stand between them.
do for [shape in 'star bust'] {
    set logscale xy
    set title sprintf('%s: three problems drawn by seed', shape)
    set xlabel 'iteration'
    set ylabel 'error above the least known, as a share of it' offset 1
    set xrange [1:cap * 1.3]
    set yrange [1e-4:1e3]
    set format y '10^{%T}'
    if (shape eq 'star') { set key at screen 0.045,0.56 left top Left reverse } else { unset key }
    plot for [i=1:3] curves using (of(shape) && strcol('method') eq 'cg' && column('shown') == i ? column('iteration') : NaN):(floor_(column('error_over_best') - 1)) \
             with lines lw 2 lc rgb color[i] title sprintf('problem %d, CG', i), \
         for [i=1:3] curves using (of(shape) && strcol('method') eq 'sd' && column('shown') == i ? column('iteration') : NaN):(floor_(column('error_over_best') - 1)) \
             with lines lw 2 dt 2 lc rgb color[i] title sprintf('problem %d, SD', i), \
         curves using (of(shape) && column('iteration') == cap ? cap : NaN):(column('error_over_best') > 1.01 ? column('error_over_best') - 1 : 1e-9) \
             with points pt 6 ps 1.5 lw 2 lc rgb '#333333' title sprintf('not there after %d', cap), \
         0.01 with lines lw 1.5 lc rgb '#888888' title '1 %: converged', \
         '+' using (25):(0.01) every ::0::0 with points pt 9 ps 1.6 lc rgb '#000000' title "paper's \"Optim 2\": CG 25", \
         '+' using (250):(0.01) every ::0::0 with points pt 8 ps 1.6 lw 2 lc rgb '#000000' title "paper's \"Optim 2\": SD 250"

    unset logscale y
    set format y '%g'
    set title sprintf('%s: every problem measured', shape)
    set xlabel 'SD iterations / CG iterations, to 1 % above'
    set ylabel 'share of problems below' offset 0.5
    set yrange [0:1]
    set xrange [0.5:500]
    if (shape eq 'star') { set key at screen 0.295,0.56 left top Left reverse }
    set arrow 1 from 5,0 to 5,1 nohead dt 3 lw 1.5 lc rgb '#888888'
    set arrow 2 from 10,0 to 10,1 nohead dt 2 lw 1.5 lc rgb '#888888'
    ratio(sd, cg, cap) = (sd < 0 ? cap : sd < 1 ? 1 : sd) / 1.0 / (cg < 0 ? cap : cg < 1 ? 1 : cg)
    capof(i) = real(system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"%s\" { print $4 }' '%s'", shape, word(lambdas, i), summary)))
    array caps[words(lambdas)]
    do for [i=1:words(lambdas)] { caps[i] = capof(i) }
    at(i) = of(shape) && column('lambda') == word(lambdas, i) + 0
    plot for [i=1:words(lambdas)] problems using (at(i) ? ratio(column('sd'), column('cg_paper'), caps[i]) : NaN):(1) smooth cnormal \
             with lines lw (i == 1 ? 3 : 1.5) lc rgb color[3 + i] title sprintf('λ = %s (cap %d)', word(lambdas, i), caps[i]), \
         problems using (at(1) && column('sd') >= 0 && column('cg_paper') >= 0 ? ratio(column('sd'), column('cg_paper'), cap) : NaN):(1) smooth cnormal \
             with lines lw 2 dt 2 lc rgb color[4] title sprintf('λ = %s, both arrive', word(lambdas, 1)), \
         NaN with lines dt 2 lw 1.5 lc rgb '#888888' title "the paper's 10", NaN with lines dt 3 lw 1.5 lc rgb '#888888' title 'rule of claim C1: 5'
    unset arrow

    stats problems using (at(1) ? 1 : NaN) nooutput
    set title sprintf('%s: every solver, λ = %s', shape, word(lambdas, 1))
    set xlabel 'iteration'
    set ylabel 'share of problems within 1 %' offset 0.5
    set xrange [1:cap]
    if (shape eq 'star') { set key at screen 0.545,0.56 left top Left reverse }
    names = 'varpro cg_modern lbfgs cg_paper adam sd_growing sd'
    shown(name) = name eq 'varpro' ? "Newton's steps" : name eq 'cg_modern' ? 'our CG' : name eq 'lbfgs' ? 'L-BFGS' : name eq 'cg_paper' ? 'CG, paper' : \
                  name eq 'adam' ? 'Adam' : name eq 'sd_growing' ? 'SD, growing step' : 'SD, paper'
    plot for [i=1:words(names)] problems using (at(1) && column(word(names, i)) >= 0 ? column(word(names, i)) : NaN):(1.0 / STATS_records) smooth cumulative \
        with lines lw (word(names, i) eq 'cg_paper' || word(names, i) eq 'sd' ? 3 : 1.5) lc rgb color[i] title shown(word(names, i))

    stats ends using (of(shape) ? 1 : NaN) nooutput
    set title sprintf("%s: ends of %d problems that run on", shape, STATS_records)
    set xlabel "SD's error / CG's error"
    set ylabel 'share of problems below' offset 0.5
    set xrange [0.9:1.3]
    unset logscale x
    if (shape eq 'star') { set key at screen 0.795,0.56 left top Left reverse }
    set arrow 1 from 0.99,0 to 0.99,1 nohead dt 3 lw 1.5 lc rgb '#888888'
    set arrow 2 from 1.01,0 to 1.01,1 nohead dt 3 lw 1.5 lc rgb '#888888'
    plot ends using (of(shape) ? column('sd_error') / column('cg_error') : NaN):(1.0 / STATS_records) smooth cumulative \
             with lines lw 2 dt 2 lc rgb color[4] title "at rest, or at the cap", \
         ends using (of(shape) ? column('sd_minimum') / column('cg_minimum') : NaN):(1.0 / STATS_records) smooth cumulative \
             with lines lw 3 lc rgb color[4] title 'followed down to their minima', \
         NaN with lines dt 3 lw 1.5 lc rgb '#888888' title '1 % apart'
    unset arrow
}
unset multiplot
