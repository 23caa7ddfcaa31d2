#!/bin/sh
# The sample that NeuralRTI ships: a surface of 320 x 320 pixels under 49 lamps, to be fitted, and under 20 others of its
# authors' choice, to be held out. Packs it into OUTPUT/neural_dome; fits as `radiafit fit` chooses; judges the held-out lamps.
# Usage: neural_dome.sh [--pack-only] [--replace] [OUTPUT]     OUTPUT: a folder, default datasets/packed
#   --replace  makes anew what is in OUTPUT already; else that stays, and what this script did not make is refused
# Source: github.com/univr-GRAIL/NeuralRTI, commit 94a0194, modules/test_dataset, as it stands there. datasets/captures.md has
# the commands; checksums are compared. All models and other programs' pictures: make experiments ONLY=relighting
# The capture is looked for in $RADIAFIT_CAPTURES/neural_dome (default ../shared/data).
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
capture=$("$root/datasets/scripts/find_capture.sh" neural_dome)
radiafit=$("$root/datasets/scripts/find_radiafit.sh")
mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Both folders name their images alike: those to be held out are called Test_.
mkdir "$work/images"
for set in Dome Test; do
    for image in "$capture/$set"/*.jpg; do
        cp "$image" "$work/images/${set}_${image##*/}"
    done
    awk -v set=$set 'NR > 1 && NF == 4 { print set "_" $0 }' "$capture/$set/dirs.lp" >>"$work/lamps"
done
{ grep -c . "$work/lamps" && cat "$work/lamps"; } >"$work/lamps.lp"
sed -n 's/^\(Test_[^ ]*\).*/\1/p' "$work/lamps" >"$work/held_out.txt"
"$radiafit" import lights --images "$work/images" --lights "$work/lamps.lp" --normals flat --holdout "$work/held_out.txt" \
    --name neural_dome -o "$out/neural_dome" ${replace:+"$replace"}
[ -z "$only_pack" ] || exit 0
"$radiafit" fit "$out/neural_dome" -o "$out/neural_dome-fit" ${replace:+"$replace"}
"$radiafit" judge "$out/neural_dome-fit"
