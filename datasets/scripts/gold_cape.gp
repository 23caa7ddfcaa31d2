# The README's picture of the gold cape, from two sheets of `radiafit render` (photograph, baseline, fit, error).
# -e: map, basis (the sheets: a light field map's and a view basis's), width, height (pixels of one picture), map_says,
# basis_says (labels), output
gap = 4
crop(k) = k * (width + gap)
set terminal pngcairo size int(2.053 * width + 0.5), int(0.566 * height + 0.5) font 'DejaVu Sans,11' background 'white'
set output output
unset key; unset border; unset tics
set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0
set xrange [0:crop(4) - gap]
set yrange [0:1.11 * height]
word_of(k) = k == 0 ? 'photograph, held out' : k == 1 ? map_says : k == 2 ? basis_says : 'four times its error'
do for [k=0:3] {
    set label k + 1 word_of(k) at crop(k) + 0.5 * width, 1.05 * height center
}
plot basis binary filetype=png every 1:1:crop(0):0:crop(0) + width - 1:height - 1 with rgbimage, \
     map binary filetype=png origin=(-crop(1),0) every 1:1:crop(2):0:crop(2) + width - 1:height - 1 with rgbimage, \
     basis binary filetype=png every 1:1:crop(2):0:crop(2) + width - 1:height - 1 with rgbimage, \
     basis binary filetype=png every 1:1:crop(3):0:crop(3) + width - 1:height - 1 with rgbimage
