#!/bin/sh
# MaterialGAN's "cards-blue": nine flash photographs of a flat card, rectified to its plane; lamp and camera near, places
# in cm. Packs it into OUTPUT/cards, every eighth photograph held out.
# Usage: cards_blue.sh [--leave-out I | --leave-one-out | --picture] [--replace] [OUTPUT]     OUTPUT: a folder, default datasets/packed
#   --leave-out I      holds out photograph I (00 to 08) alone, and packs into OUTPUT/cards-without-I
#   --leave-one-out    does so for each of the nine in turn, fits the other eight as `radiafit tune` recommends within 20
#                      seconds, judges the one, and prints the mean; keeps nothing
#   --picture          fits them as `radiafit tune` recommends within 20 seconds, judges, and draws OUTPUT/cards.png
#   --replace          makes anew what is in OUTPUT already; else that stays, and what this script did not make is refused
# Source: github.com/tflsguoyu/materialgan, commit 74d1f4857a3fef83a102764f047dd5ed2f953710, data/in/real_cards-blue, as it
# stands there; no licence stated, for research use. datasets/captures.md has the commands; checksums are compared.
# The capture is looked for in $RADIAFIT_CAPTURES/cards_blue (default ../shared/data).
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
if [ "${1:-}" = --leave-one-out ]; then
    shift
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    for i in 00 01 02 03 04 05 06 07 08; do
        sh "$0" --leave-out $i "$work" >/dev/null 2>"$work/log" || { cat "$work/log" >&2; exit 2; }
        "$root/datasets/scripts/tune_and_fit.sh" "$work/cards-without-$i" "$work/fit" 20 --replace >"$work/said" 2>"$work/log" ||
            { cat "$work/log" >&2; exit 1; }
        echo "without $i: $(sed -n '/(test): /p' "$work/said")" | tee -a "$work/all"
        rm -rf "$work/cards-without-$i"
    done
    awk '{ for (i = 1; i <= NF; ++i) if ($i == "PSNR") p[++k % 2] += $(i + 1) }
         END { printf "mean: PSNR %.2f dB, Lambertian %.2f dB, %+.2f dB\n", p[1] / NR, p[0] / NR, (p[1] - p[0]) / NR }' \
        "$work/all"
    exit 0
fi
picture=
if [ "${1:-}" = --picture ]; then
    picture=yes
    shift
fi
left_out=
if [ "${1:-}" = --leave-out ]; then
    left_out=${2:?--leave-out takes the number of a photograph, 00 to 08}
    shift 2
fi
replace=
if [ "${1:-}" = --replace ]; then
    replace=--replace
    shift
fi
out=${1:-$root/datasets/packed}
capture=$("$root/datasets/scripts/find_capture.sh" cards_blue)
radiafit=$("$root/datasets/scripts/find_radiafit.sh")
mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The authors' model is pixel = brdf power (n.l) / distance^2, and a white diffuse surface has brdf 1 / pi: what radiafit
# calls a lamp's intensity, that surface's value, is power / pi.
awk -F, '{ pi = atan2(0, -1); printf "%.9g %.9g %.9g\n", $1 / pi, $2 / pi, $3 / pi }' \
    "$capture/light_power.txt" >"$work/intensities.txt"
holdout=every:8 name=cards
if [ -n "$left_out" ]; then
    echo "$left_out.png" >"$work/held_out.txt"
    holdout=$work/held_out.txt name=cards-without-$left_out
fi
# The photographs are stored as they are. Their authors decode them with gamma 2.2; sRGB's curve, which stands for it
# here, differs from it by less than 0.01 of white.
"$radiafit" import lights --images "$capture/images" --light-positions "$capture/light_pos.txt" \
    --camera-positions "$capture/camera_pos.txt" --intensities "$work/intensities.txt" \
    --sample-width "$(cat "$capture/image_size.txt")" --depth 8 --transfer srgb --holdout "$holdout" \
    --name cards_blue -o "$out/$name" ${replace:+"$replace"}
[ -n "$picture" ] || exit 0
"$root/datasets/scripts/tune_and_fit.sh" "$out/cards" "$out/cards-fit" 20 ${replace:+"$replace"}
"$root/datasets/scripts/labelled_sheet.py" "$out/cards-fit" "$out/cards.png" \
    'MaterialGAN (Guo et al., SIGGRAPH Asia 2020): "cards-blue", for research use' --panel 225 ${replace:+"$replace"}
