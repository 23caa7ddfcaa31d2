# Digits of NIST's certified parameters: a square for each solver (column), problem and start (row).
# -e: rows (folder of the result rows), output (without extension), caption, terminal ("svg" or "png")
set datafile separator comma
set datafile columnheaders
if (terminal eq 'svg') {
    set terminal svg size 1000,1180 font 'DejaVu Sans,12' background 'white'
} else {
    set terminal pngcairo size 1000,1180 font 'DejaVu Sans,10'
}
set output output
runs = rows . '/runs.csv'
# Names in the order in which they come.
solvers = system(sprintf("awk -F, 'NR > 1 && !(($1 FS $2) in n) { n[$1 FS $2] = 1; s = $2 == \"\" ? $1 : $1 \": \" $2; gsub(\" \", \"_\", s); printf \"%%s \", s }' '%s'", runs))
problems = system(sprintf("awk -F, 'NR > 1 && !($3 in n) { n[$3] = 1; printf \"%%s \", $3 }' '%s'", runs))
place(list, name) = sum [i=1:words(list)] (word(list, i) eq name ? i : 0)
swap(text, from, to) = text eq '' ? '' : (text[1:1] eq from ? to : text[1:1]) . swap(text[2:*], from, to)
plain(text) = swap(text, '_', ' ')
solver(dummy) = place(solvers, swap(strcol('setting') eq '' ? strcol('solver') : strcol('solver') . ': ' . strcol('setting'), ' ', '_'))
row(dummy) = 2 * place(problems, strcol('problem')) - 3 + column('start')
set title "{/:Bold Digits of NIST's certified parameters: the one with the fewest right}\n" . caption
unset key
set palette defined (0 '#b2182b', 4 '#f4a582', 7.99 '#fddbc7', 8 '#d1e5f0', 11 '#2166ac')
set cbrange [0:11]
set cblabel 'digits (8 are asked for)'
set xrange [0.5:words(solvers) + 0.5]
set yrange [2 * words(problems) - 0.5:-0.5]
set xtics out rotate by -35 nomirror
set ytics out nomirror
unset grid
set xtics scale 0.5
set ytics ()
set xtics ()
do for [i=1:words(solvers)] { set xtics add (plain(word(solvers, i)) i) }
do for [i=1:words(problems)] { set ytics add (word(problems, i) . ', start 1' 2 * i - 2); set ytics add ('start 2' 2 * i - 1) }
set bmargin at screen 0.17
plot runs using (solver(0)):(row(0)):(0.5):(0.5):(column('digits')) with boxxyerror fill solid noborder lc palette, \
    '' using (solver(0)):(row(0)):(sprintf('%d', int(column('digits')))) with labels font ',8'
