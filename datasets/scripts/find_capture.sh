#!/bin/sh
# Prints the folder of a capture after comparing its files with datasets/checksums/NAME*.sha256: one of the lists must fit.
# datasets/captures.md says where captures come from and how they were prepared.
# Usage: find_capture.sh cards_blue|diligent_reading|mold_gold_cape|neural_dome
# Looks in $RADIAFIT_CAPTURES (default ../shared/data beside the checkout). RADIAFIT_OTHER_CAPTURE=1 goes on with other
# files, such as photographs that another version of COLMAP has undistorted: figures will differ from ours.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
name=${1:?usage: find_capture.sh cards_blue|diligent_reading|mold_gold_cape|neural_dome}
sums=$root/datasets/checksums/$name.sha256
if [ ! -f "$sums" ]; then
    echo "no capture is called '$name'" >&2
    exit 2
fi
capture=${RADIAFIT_CAPTURES:-$root/../shared/data}/$name
if [ ! -d "$capture" ]; then
    echo "$capture is missing: set RADIAFIT_CAPTURES to the folder that holds $name; datasets/captures.md says where it comes from" >&2
    exit 2
fi
export LC_ALL=C
same=no
for list in "$sums" "$root/datasets/checksums/$name"-*.sha256; do
    if [ -f "$list" ] && (cd "$capture" && sha256sum --check --status "$list" 2>/dev/null); then
        same=yes
    fi
done
if [ $same = no ]; then
    other=$(cd "$capture" && sha256sum --check --quiet "$sums" 2>/dev/null | grep -c .) || true
    line="$capture: $other of $(grep -c . "$sums") files are missing or not those that our figures are of"
    if [ "${RADIAFIT_OTHER_CAPTURE:-0}" != 1 ]; then
        echo "$line; compare with datasets/captures.md, or set RADIAFIT_OTHER_CAPTURE=1 to go on" >&2
        exit 2
    fi
    echo "$line" >&2
fi
printf '%s\n' "$capture"
