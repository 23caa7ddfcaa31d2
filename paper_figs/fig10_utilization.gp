# Figure 10: share of the measured peaks, three bars for each problem, kind of passes and optimizer.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1280,680 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1280,680 font 'DejaVu Sans,11'
}
set output output
shares = rows . '/utilization.csv'
peaks = rows . '/peaks.csv'
stats shares using 4 every ::1 nooutput name 'bars'
stats shares using (strcol(1)[1:5] eq 'light' ? $0 : NaN) every ::1 nooutput name 'maps'
array color[3] = ['#0072b2', '#e69f00', '#009e73']
array amount[3] = ['operations of fragments', 'bytes', 'texture reads']
array resource[3]
do for [k=1:3] {
    stats peaks using (strcol(2) eq amount[k] && strstrt(strcol(1), 'cpu') == 0 ? 1e-9 * $4 : NaN) every ::1 nooutput name 'peak'
    resource[k] = sprintf('%s (%.3g to %.3g)', \
        k == 1 ? sprintf('arithmetic, of %.3g G operations/s', peak_median) : \
        k == 2 ? sprintf('memory traffic, of %.3g GB/s', peak_median) : sprintf('texture reads, of %.3g G/s', peak_median), \
        peak_min, peak_max)
}
set title "{/:Bold Figure 10: use of the fragment stage, share of this device's own peaks, measured in the same run}\n{/*0.85 " . caption . "}"
set label 1 "An operation is an arithmetic one, a comparison or a conversion of one component, and a multiply-add two; a texture read fetches one texel, of mostly 16 bytes." \
    at screen 0.5,0.062 center font ',10'
set label 2 "Counted from every program's compiled code and how often it ran. Whiskers: 95 % interval of the median, each repetition by its own peaks; in brackets the peaks' range." \
    at screen 0.5,0.028 center font ',10'
set style fill solid border -1
set boxwidth 0.26
set grid y lc rgb '#dddddd'
set border 3
set tics nomirror
set xtics scale 0
set ylabel 'share of the peak, %'
set yrange [0:*]
set offsets 0, 0, graph 0.35, 0
set xrange [-0.6:bars_records - 0.4]
set key top right reverse Left
name(problem, optimizer, passes) = sprintf("%s\n%s\n%s passes", problem, optimizer eq 'cg' ? 'CG' : 'SD', passes)
set bmargin 9
place(k) = $0 + 0.27 * (k - 2)
share(k) = 100 * column(3 * k + 1)
high(k) = column(3 * k + 3) > 0 ? 100 * column(3 * k + 3) : share(k)
stated = 29
plot for [k=1:3] shares using (place(k)):(share(k)) every ::1 with boxes lc rgb color[k] title resource[k], \
     shares using 0:(0):xtic(name(strcol(1), strcol(2), strcol(3))) every ::1 with dots lc rgb 'black' notitle, \
     for [k=1:3] shares using (place(k)):(100 * column(3 * k + 2)):(0):(100 * (column(3 * k + 3) - column(3 * k + 2))) every ::1 \
         with vectors heads size 0.06,90 lw 1.5 lc rgb 'black' notitle, \
     for [k=1:3] shares using (place(k)):(high(k)):(sprintf('%.2g', share(k))) \
         every ::1 with labels offset 0,0.7 font ',10' notitle, \
     [x=-0.6:maps_records - 0.5] '+' using 1:(maps_records > 0 ? stated : NaN) with lines dt 2 lw 2 lc rgb '#cc0000' \
         title sprintf("the paper's light field map: %d %%, of a Radeon 9700's peaks of 2.6 G operations/s and 0.65 G texture reads/s", stated)
