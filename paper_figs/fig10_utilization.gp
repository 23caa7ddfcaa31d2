# Figure 10: share of the measured peaks, three bars for each problem, optimizer and kind of passes.
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
if (terminal eq 'svg') {
    set terminal svg size 1280,740 font 'DejaVu Sans,13' background 'white'
    small = ',12'
} else {
    set terminal pngcairo size 1280,740 font 'DejaVu Sans,11'
    small = ',10'
}
set output output
shares = rows . '/utilization.csv'
peaks = rows . '/peaks.csv'
# What the paper's figure is of; its 29 % stand beside these bars alone.
stated = 29
of_paper(problem, optimizer, passes) = problem eq 'light field map' && optimizer eq 'sd' && passes eq 'paper'
stats shares using 4 every ::1 nooutput name 'bars'
stats shares using (of_paper(strcol(1), strcol(2), strcol(3)) ? 1 : 0) every ::1 nooutput name 'paper'
# Bars are told apart by colour, filling and order.
array color[3] = ['#0072b2', '#e69f00', '#009e73']
array amount[3] = ['operations of fragments', 'bytes', 'texture reads']
array resource[3]
do for [k=1:3] {
    stats peaks using (strcol(2) eq amount[k] && strstrt(strcol(1), 'cpu') == 0 ? 1e-9 * $4 : NaN) every ::1 nooutput name 'peak'
    resource[k] = sprintf('%s (%.3g to %.3g)', \
        k == 1 ? sprintf('left: arithmetic, of %.3g G operations/s', peak_median) : \
        k == 2 ? sprintf('middle: memory traffic, of %.3g GB/s', peak_median) : sprintf('right: texture reads, of %.3g G/s', peak_median), \
        peak_min, peak_max)
}
set multiplot layout 1,1 title "{/:Bold Figure 10: use of the fragment stage, share of this device's own peaks, measured in the same run}\n" . caption \
    margins 0.055,0.985,0.215,0.755
set label 1 "An operation is an arithmetic one, a comparison or a conversion of one component, and a multiply-add two; a texture read fetches one texel, of 32-bit floats mostly 16 bytes." \
    at screen 0.5,0.058 center font small
set label 2 "Counted from every program's compiled code and how often it ran. Whiskers: 95 % interval of the median, each repetition by its own peaks; in brackets the peaks' range." \
    at screen 0.5,0.025 center font small
# Where some passes are named as of 32 bits, the others are of 16.
if (system(sprintf("grep -c ' in 32 bits' '%s'", shares)) > 0) { set label 3 'Parameters are 16-bit floats, if not told to be in 32 bits.' at screen 0.5,0.091 center font small }
set boxwidth 0.26
set grid y lt 1 lc rgb '#dddddd'
set border 3
set tics nomirror
set xtics scale 0 font small
set ylabel 'share of the peak, %'
set yrange [0:*]
set offsets 0, 0, graph 0.06, 0
set xrange [-0.6:bars_records - 0.4]
set key at screen 0.075,0.895 left top reverse Left width -2
ends(passes) = strstrt(passes, ' in ') > 0 ? strstrt(passes, ' in ') - 1 : strlen(passes)
kind(passes) = passes[1:ends(passes)] . (ends(passes) < strlen(passes) ? " passes\n" . passes[ends(passes) + 2:strlen(passes)] : "\npasses")
name(problem, optimizer, passes) = sprintf("%s\n%s\n%s", problem eq 'light field map' ? 'light field' : problem, optimizer eq 'cg' ? 'CG' : 'SD', kind(passes))
place(k) = $0 + 0.27 * (k - 2)
share(k) = 100 * column(3 * k + 1)
high(k) = column(3 * k + 3) > 0 ? 100 * column(3 * k + 3) : share(k)
plot shares using (place(1)):(share(1)) every ::1 with boxes fs solid border -1 lc rgb color[1] title resource[1], \
     shares using (place(2)):(share(2)) every ::1 with boxes fs pattern 4 border -1 lc rgb color[2] title resource[2], \
     shares using (place(3)):(share(3)) every ::1 with boxes fs solid 0.5 border -1 lc rgb color[3] title resource[3], \
     shares using 0:(0):xtic(name(strcol(1), strcol(2), strcol(3))) every ::1 with dots lc rgb 'black' notitle, \
     for [k=1:3] shares using (place(k)):(100 * column(3 * k + 2)):(0):(100 * (column(3 * k + 3) - column(3 * k + 2))) every ::1 \
         with vectors heads size 0.06,90 lw 1.5 lc rgb 'black' notitle, \
     for [k=1:3] shares using (place(k)):(high(k)):(sprintf('%.2g', share(k))) every ::1 with labels offset 0,0.7 font small notitle, \
     for [k=1:3:2] shares using (of_paper(strcol(1), strcol(2), strcol(3)) ? place(k) - 0.14 : NaN):(stated):(0.28):(0) every ::1 \
         with vectors nohead lw 4 lc rgb '#cc0000' notitle, \
     NaN with lines lw (paper_max > 0 ? 4 : 0) lc rgb '#cc0000' \
         title (paper_max > 0 ? sprintf("the paper's light field map by SD: %d %% of a Radeon 9700's 2.6 G operations/s or 0.65 G texture reads/s; which, our text does not say", stated) : '')
unset multiplot
