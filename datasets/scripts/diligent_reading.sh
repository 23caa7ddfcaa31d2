#!/bin/sh
# DiLiGenT's glazed porcelain figure "reading": one view, 96 calibrated distant lights, 16 bits, scanned normals. Packs it
# into OUTPUT/reading; every eighth light is held out.
# Usage: diligent_reading.sh [OUTPUT]     OUTPUT: a folder, default datasets/packed
# The capture is looked for in $RADIAFIT_CAPTURES/diligent_reading (default ../shared/data).
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
out=${1:-$root/datasets/packed}
capture=${RADIAFIT_CAPTURES:-$root/../shared/data}/diligent_reading
radiafit=${RADIAFIT:-$root/build/release/src/app/radiafit}
if [ ! -d "$capture" ]; then
    echo "$capture is missing: set RADIAFIT_CAPTURES to the folder that holds diligent_reading" >&2
    exit 2
fi
if [ ! -x "$radiafit" ]; then
    echo "$radiafit is missing: run make build" >&2
    exit 2
fi
mkdir -p "$out"
"$radiafit" import lights --images "$capture/images" --names "$capture/filenames.txt" \
    --lights "$capture/light_directions.txt" --intensities "$capture/light_intensities.txt" \
    --mask "$capture/mask.png" --normals "$capture/normal_gt.pfm" --depth 16 --transfer linear \
    --name diligent_reading -o "$out/reading"
