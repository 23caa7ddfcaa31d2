#!/bin/sh
# The Mold gold cape from photographs to judged fits: what `radiafit tune` recommends within 300 seconds, on training
# photographs alone, and the figures and the picture of the README.
# Usage: gold_cape.sh [--pack-only] [--replace] [OUTPUT]     OUTPUT: a folder, default datasets/packed
#   --replace  makes anew what is in OUTPUT already; else that stays, and what this script did not make is refused
# Source: github.com/vork/moldGoldCape, commit c7ef1f0f2a7c2ec5ea7fa3fb43a01ed56fc5216b, undistorted by COLMAP, the museum's
# mesh moved into COLMAP's frame; CC BY-NC-SA 4.0, copyright the Trustees of the British Museum. datasets/captures.md has
# what is known of the steps; checksums are compared.
# The capture is looked for in $RADIAFIT_CAPTURES/mold_gold_cape (default ../shared/data).
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
capture=$("$root/datasets/scripts/find_capture.sh" mold_gold_cape)
radiafit=$("$root/datasets/scripts/find_radiafit.sh")
mkdir -p "$out"

"$radiafit" import colmap --model "$capture/sparse" --images "$capture/images" --masks "$capture/masks" \
    --mesh "$capture/mesh.obj" --gains estimate --name gold_cape -o "$out/cape" ${replace:+"$replace"}
[ -z "$only_pack" ] || exit 0
"$root/datasets/scripts/tune_and_fit.sh" "$out/cape" "$out/cape-tuned" 300 ${replace:+"$replace"}
for terms in 1 3 6; do
    "$radiafit" fit "$out/cape" --model lfm --terms $terms -o "$out/cape-fit$terms" ${replace:+"$replace"}
    "$radiafit" judge "$out/cape-fit$terms"
done
for rank in 10 28; do
    "$radiafit" fit "$out/cape" --model viewbasis --rank $rank -o "$out/cape-basis$rank" ${replace:+"$replace"}
    "$radiafit" judge "$out/cape-basis$rank"
done

"$root/datasets/scripts/labelled_sheet.py" "$out/cape-basis10" "$out/cape.png" \
    'Mold gold cape. Photographs: Daniel Pett, copyright the Trustees of the British Museum, CC BY-NC-SA 4.0' \
    ${replace:+"$replace"} --words 'view basis, rank 10' --beside "$out/cape-fit3" 'light field map, 3 terms'
