#!/bin/sh
# The Mold gold cape from photographs to a judged light field map: the figures and the picture of the README.
# Usage: gold_cape.sh [--select | --pack-only] [OUTPUT]     OUTPUT: a folder, default datasets/packed
#   --select    chooses terms and weights anew, on every eighth training photograph (takes long); otherwise the choice
#               made so earlier is used. The held-out photographs have no part in it.
# Source: github.com/vork/moldGoldCape, commit c7ef1f0f2a7c2ec5ea7fa3fb43a01ed56fc5216b, undistorted by COLMAP, the museum's
# mesh moved into COLMAP's frame; CC BY-NC-SA 4.0, copyright the Trustees of the British Museum. datasets/captures.md has
# what is known of the steps; checksums are compared.
# The capture is looked for in $RADIAFIT_CAPTURES/mold_gold_cape (default ../shared/data).
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
select=0 only_pack=
case ${1:-} in
--select) select=1 && shift ;;
--pack-only) only_pack=yes && shift ;;
esac
out=${1:-$root/datasets/packed}
capture=$("$root/datasets/scripts/find_capture.sh" mold_gold_cape)
radiafit=${RADIAFIT:-$root/build/release/src/app/radiafit}
if [ ! -x "$radiafit" ]; then
    echo "$radiafit is missing: run make build" >&2
    exit 2
fi
mkdir -p "$out"

import() {  # MODEL DATASET
    "$radiafit" import colmap --model "$1" --images "$capture/images" --masks "$capture/masks" \
        --mesh "$capture/mesh.obj" --gains estimate --name gold_cape -o "$2"
}

terms=3 surface=1e-3 view=0.1
if [ $select = 1 ]; then
    # The training photographs alone, every eighth of them held out in turn.
    model=$(mktemp -d)
    trap 'rm -rf "$model"' EXIT
    cp "$capture/sparse/cameras.txt" "$model/"
    grep -v '^#' "$capture/sparse/images.txt" | grep . | sort -k 10 | awk 'NR % 8 != 1 { print; print "" }' >"$model/images.txt"
    import "$model" "$out/cape-selection" >/dev/null
    best=-1
    for k in 1 2 3; do
        for ls in 1e-3 1e-2; do
            for lv in 0.03 0.1 0.3; do
                "$radiafit" fit "$out/cape-selection" --terms $k --lambda-surface $ls --lambda-view $lv -o "$out/cape-selection-fit" 2>/dev/null
                psnr=$("$radiafit" judge "$out/cape-selection-fit" --json | python3 -c 'import json, sys; print(json.load(sys.stdin)["psnr"])')
                echo "terms $k, lambda-surface $ls, lambda-view $lv: $psnr dB"
                if [ "$(echo "$psnr $best" | awk '{ print ($1 > $2) }')" = 1 ]; then
                    best=$psnr terms=$k surface=$ls view=$lv
                fi
            done
        done
    done
    echo "chosen: terms $terms, lambda-surface $surface, lambda-view $view"
fi

import "$capture/sparse" "$out/cape"
[ -z "$only_pack" ] || exit 0
"$radiafit" fit "$out/cape" --terms 1 --lambda-surface $surface --lambda-view $view -o "$out/cape-fit1"
"$radiafit" judge "$out/cape-fit1"
"$radiafit" fit "$out/cape" --terms $terms --lambda-surface $surface --lambda-view $view -o "$out/cape-fit"
"$radiafit" judge "$out/cape-fit"
"$radiafit" fit "$out/cape" --terms 6 --lambda-surface $surface --lambda-view $view -o "$out/cape-fit6"
"$radiafit" judge "$out/cape-fit6"
for rank in 10 28; do
    "$radiafit" fit "$out/cape" --model viewbasis --rank $rank -o "$out/cape-basis$rank"
    "$radiafit" judge "$out/cape-basis$rank"
done

psnr() { "$radiafit" judge "$1" --json | python3 -c 'import json, sys; print("%.1f dB" % json.load(sys.stdin)["psnr"])'; }
"$radiafit" render "$out/cape-fit" -o "$out/cape-map"
"$radiafit" render "$out/cape-basis10" -o "$out/cape-view"
set -- $(od -An -tu1 -j16 -N8 "$out/cape-view.png")  # width and height, in the PNG's header
gnuplot -e "map='$out/cape-map_sheet.png'; basis='$out/cape-view_sheet.png'; width=$(($3 * 256 + $4)); height=$(($7 * 256 + $8))" \
    -e "map_says='light field map, $terms terms: $(psnr "$out/cape-fit")'; basis_says='view basis, rank 10: $(psnr "$out/cape-basis10")'" \
    -e "output='$out/cape.png'" "$root/datasets/scripts/gold_cape.gp"
echo "the README's picture: $out/cape.png"
