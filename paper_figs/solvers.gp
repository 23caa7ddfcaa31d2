# Solvers side by side, the quickest first: time per vertex until its three problems are within 1.01 of the least error.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
# Rows by their time per vertex, which is what is drawn.
set print $sorted
print system(sprintf("tail -n +2 '%s/solvers.csv' | awk -F, '{print $7 / $4 \",\" $0}' | sort -g -t , -k 1,1 | cut -d , -f 2-", rows))
unset print
stats $sorted using ($7 / $4 * 1e3) nooutput name 'ms'
stats $sorted using 4 nooutput name 'vertices'
most_vertices = vertices_max
height = int(260 + 28 * ms_records)
if (terminal eq 'svg') {
    set terminal svg size 1280,height font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,height font 'DejaVu Sans,11'
}
set output output
size = terminal eq 'svg' ? 0.85 : 1.3
down(pixels) = 1 - real(pixels) / height
array what[3] = ["radiafit's own", 'Ceres, line search', 'Ceres, trust region']
array color[3] = ['#d55e00', '#0072b2', '#009e73']
array full[3] = [7, 5, 9]   # shapes: filled
array empty[3] = [6, 4, 8]  # and hollow
kind(solver, setting) = solver ne 'ceres' ? 1 : strstrt(setting, 'lbfgs') + strstrt(setting, 'nonlinear') > 0 ? 2 : 3
spelt(setting) = setting eq 'lbfgs' ? 'L-BFGS' : setting eq 'adam' ? 'Adam' : setting eq 'cg modern' ? 'modern CG' : \
    setting eq 'cg paper' ? "the paper's CG" : setting eq 'sd' ? "the paper's SD" : setting eq 'nonlinear-cg' ? 'nonlinear CG' : setting
name(solver, setting) = solver eq 'ceres' ? 'Ceres ' . spelt(setting) : solver eq 'als' ? 'alternating least squares' : \
    solver eq 'varpro' ? 'variable projection' . (setting eq '' ? '' : ', ' . setting) : spelt(setting)
span(ms) = ms < 999.5 ? sprintf('%.3g ms', ms) : sprintf('%.3g s', ms / 1e3)
times(factor) = factor < 999.5 ? sprintf('×%.3g', factor) : sprintf('×%.0f', factor)
set multiplot layout 1,1 title "{/:Bold Solvers of light field maps: time per vertex to 1.01 × the least error}\n" . caption \
    . "\nours: the paper has no such figure" margins 0.205,0.67,100.0 / height,down(126)
set logscale x
set xrange [ms_min / 2:ms_max * 1.5]
set yrange [ms_records - 0.4:-0.6]
set format x '%g'
set xlabel "CPU time per vertex (its three problems), ms, logarithmic; samples in memory; ×: against modern CG on the same vertices\nproblems that do not reach it count with all their time; whiskers: least and most of the repetitions\nhollow: so slow that there was time for few vertices, or for one run, whose spread is not known"
set grid x lt 1 lc rgb '#dddddd'
set border 3
set tics nomirror
set ytics scale 0
unset key
do for [k=1:3] { set label k what[k] at screen 0.22 + 0.19 * (k - 1), screen down(107) point pt full[k] ps size lc rgb color[k] offset 1.2,0 }
sure(vertices, repetitions) = vertices == most_vertices && repetitions > 1
of(k, value) = kind(strcol(1), strcol(2)) == k ? value : NaN
few(vertices, repetitions) = (vertices < most_vertices ? sprintf('; %d vert%s', vertices, vertices == 1 ? 'ex' : 'ices') : '') . (repetitions == 1 ? '; one run' : '')
plot $sorted using (ms_min / 2):0:($8 / $4 * 1e3 - ms_min / 2):(0):ytic(name(strcol(1), strcol(2))) with vectors nohead dt 3 lc rgb '#999999', \
     $sorted using ($18 > 1 ? $7 / $4 * 1e3 : NaN):0:($8 / $4 * 1e3):($9 / $4 * 1e3) with xerrorbars pt -1 lc rgb '#333333', \
     for [k=1:3] $sorted using (of(k, sure($4, $18) ? $7 / $4 * 1e3 : NaN)):0 with points pt full[k] ps size lc rgb color[k], \
     for [k=1:3] $sorted using (of(k, sure($4, $18) ? NaN : $7 / $4 * 1e3)):0 with points pt empty[k] ps size lw 1.5 lc rgb color[k], \
     $sorted using ($9 / $4 * 1e3):0:(sprintf('%s, %s; %.3g %% reach it%s', span($7 / $4 * 1e3), times($10), 100 * $6, few($4, $18))) \
         with labels left offset 1.5,0
unset multiplot
