# Solvers side by side: time per vertex until its three problems are within 1.01 of the least error.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
table = rows . '/solvers.csv'
stats table using ($7 / $4 * 1e3) every ::1 nooutput name 'ms'
stats table using 4 every ::1 nooutput name 'vertices'
most_vertices = vertices_max
height = int(232 + 27 * ms_records)
if (terminal eq 'svg') {
    set terminal svg size 1000,height font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1000,height font 'DejaVu Sans,11'
}
set output output
array color[5] = ['#d55e00', '#0072b2', '#56b4e9', '#009e73', '#cc79a7']
array family[5] = ['two-step', 'Ceres, line search', 'Ceres, trust region', 'alternating least squares', 'variable projection']
array start[5] = [0.06, 0.18, 0.36, 0.55, 0.77]
kind(solver, setting) = solver eq 'two-step' ? 1 : solver eq 'als' ? 4 : solver eq 'varpro' ? 5 : strstrt(setting, 'lbfgs') + strstrt(setting, 'nonlinear') > 0 ? 2 : 3
name(solver, setting) = solver eq 'two-step' ? setting : solver eq 'als' ? 'ALS' : solver eq 'varpro' ? solver : setting
span(ms) = ms < 999.5 ? sprintf('%.3g ms', ms) : sprintf('%.3g s', ms / 1e3)
low = 10 ** floor(log10(ms_min * 0.7))
set title "{/:Bold Solvers of light field maps: time per vertex to 1.01 × the least error}\n" . caption . "\n "
set lmargin 27
set logscale x
set rmargin 40  # for the longest bars' labels
set xrange [low:ms_max * 1.3]
set yrange [ms_records - 0.4:-0.6]
set format x '%g'
set xlabel "CPU time per vertex (its three problems), ms; samples in memory; ×: against cg modern on the same vertices\nproblems that don't reach it count with all their time; whiskers: least and most of the repetitions\npale: so slow that there was time for few vertices, or for one run, whose spread is not known"
set grid x lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
set style fill solid noborder
unset key
do for [k=1:5] { set label k '■ ' . family[k] at screen start[k], screen 1 - 64.0 / height tc rgb color[k] }
sure(vertices, repetitions) = vertices == most_vertices && repetitions > 1
of(k, value) = kind(strcol(1), strcol(2)) == k ? value : NaN
few(vertices, repetitions) = (vertices < most_vertices ? sprintf('; %d vertices', vertices) : '') . (repetitions == 1 ? '; one run' : '')
plot for [k=1:5] table using (of(k, sure($4, $18) ? sqrt(low * $7 / $4 * 1e3) : NaN)):0:(low):($7 / $4 * 1e3):($0 - 0.36):($0 + 0.36):ytic(name(strcol(1), strcol(2))) \
         every ::1 with boxxyerror lc rgb color[k], \
     for [k=1:5] table using (of(k, sure($4, $18) ? NaN : sqrt(low * $7 / $4 * 1e3))):0:(low):($7 / $4 * 1e3):($0 - 0.36):($0 + 0.36) \
         every ::1 with boxxyerror lc rgb color[k] fs transparent solid 0.35 noborder, \
     table using ($18 > 1 ? $7 / $4 * 1e3 : NaN):0:($8 / $4 * 1e3):($9 / $4 * 1e3) every ::1 with xerrorbars pt -1 lc rgb '#333333', \
     table using ($9 / $4 * 1e3):0:(sprintf('  %s, ×%.3g; %.3g%% reach it%s', span($7 / $4 * 1e3), $10, 100 * $6, few($4, $18))) \
         every ::1 with labels left font ',10'
