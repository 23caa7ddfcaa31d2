#!/bin/sh
# DiLiGenT's glazed porcelain figure "reading": one view, 96 calibrated distant lights, 16 bits, scanned normals. Packs it
# into OUTPUT/reading, every eighth light held out; fits as `radiafit tune` recommends within 30 seconds; judges the held-out
# lights.
# Usage: diligent_reading.sh [--pack-only] [--replace] [OUTPUT]     OUTPUT: a folder, default datasets/packed
#   --replace  makes anew what is in OUTPUT already; else that stays, and what this script did not make is refused
# Source: DiLiGenT by Shi et al.; github.com/stevehan00/semi-calibrated-photometric-stereo, commit
# 90afe01da86fdd9fc62234426b0749479892def8, dataset/readingPNG, cropped; for research use. datasets/captures.md has the
# commands; checksums are compared.
# The capture is looked for in $RADIAFIT_CAPTURES/diligent_reading (default ../shared/data).
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
only_pack= replace=
while :; do
    case ${1:-} in
    --pack-only) only_pack=yes ;;
    --replace) replace=--replace ;;
    *) break ;;
    esac
    shift
done
out=${1:-$root/datasets/packed}
capture=$("$root/datasets/scripts/find_capture.sh" diligent_reading)
radiafit=$("$root/datasets/scripts/find_radiafit.sh")
mkdir -p "$out"
"$radiafit" import lights --images "$capture/images" --names "$capture/filenames.txt" \
    --lights "$capture/light_directions.txt" --intensities "$capture/light_intensities.txt" \
    --mask "$capture/mask.png" --normals "$capture/normal_gt.pfm" --depth 16 --transfer linear \
    --name diligent_reading -o "$out/reading" ${replace:+"$replace"}
[ -z "$only_pack" ] || exit 0
"$root/datasets/scripts/tune_and_fit.sh" "$out/reading" "$out/reading-fit" 30 ${replace:+"$replace"}
"$root/datasets/scripts/labelled_sheet.py" "$out/reading-fit" "$out/reading.png" \
    'DiLiGenT benchmark (Shi et al., CVPR 2016, TPAMI 2019): "reading", for research use' \
    ${replace:+"$replace"}
