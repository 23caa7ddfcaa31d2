#!/bin/sh
# DiLiGenT's glazed porcelain figure "reading": one view, 96 calibrated distant lights, 16 bits, scanned normals. Packs it
# into OUTPUT/reading, every eighth light held out; chooses which samples count on every eighth training light, by
# Lafortune's own error there; fits; judges the held-out lights.
# Usage: diligent_reading.sh [--pack-only] [OUTPUT]     OUTPUT: a folder, default datasets/packed
# Source: DiLiGenT by Shi et al.; github.com/stevehan00/semi-calibrated-photometric-stereo, commit
# 90afe01da86fdd9fc62234426b0749479892def8, dataset/readingPNG, cropped; for research use. datasets/captures.md has the
# commands; checksums are compared.
# The capture is looked for in $RADIAFIT_CAPTURES/diligent_reading (default ../shared/data).
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
only_pack=
if [ "${1:-}" = --pack-only ]; then
    only_pack=yes
    shift
fi
out=${1:-$root/datasets/packed}
capture=$("$root/datasets/scripts/find_capture.sh" diligent_reading)
radiafit=${RADIAFIT:-$root/build/release/src/app/radiafit}
if [ ! -x "$radiafit" ]; then
    echo "$radiafit is missing: run make build" >&2
    exit 2
fi
mkdir -p "$out"
"$radiafit" import lights --images "$capture/images" --names "$capture/filenames.txt" \
    --lights "$capture/light_directions.txt" --intensities "$capture/light_intensities.txt" \
    --mask "$capture/mask.png" --normals "$capture/normal_gt.pfm" --depth 16 --transfer linear \
    --name diligent_reading -o "$out/reading"
[ -z "$only_pack" ] || exit 0

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
best=0 choice=
for clip in 0 0.98; do
    for shadow in 0 0.1 0.2 0.3; do
        options="--clip-above $clip --shadow-below $shadow"
        "$radiafit" fit "$out/reading" --model lafortune --validation 8 $options -o "$work/fit" 2>"$work/log" ||
            { cat "$work/log" >&2; exit 1; }
        psnr=$("$radiafit" judge "$work/fit" --split validation --json | sed -n '1,/"psnr"/s/^  "psnr": \([0-9.]*\),$/\1/p')
        printf "validation, %s: %.2f dB\n" "$options" "$psnr"
        if awk "BEGIN { exit !($psnr > $best) }"; then
            best=$psnr choice=$options
        fi
    done
done
echo "chosen: $choice"
"$radiafit" fit "$out/reading" --model lafortune $choice -o "$out/reading-fit"
"$radiafit" judge "$out/reading-fit"
"$radiafit" render "$out/reading-fit" -o "$out/reading-view"
