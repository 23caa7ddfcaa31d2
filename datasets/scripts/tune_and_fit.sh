#!/bin/sh
# Fits a packed dataset as `radiafit tune` recommends, chosen on training images alone, and judges it on those held out.
# Usage: tune_and_fit.sh DATASET FIT [SECONDS] [--replace]     SECONDS: about how long tune may take, default 300
#   --replace  also where FIT is there already: what tune recommends may be another fit now
set -eu
dataset=${1:?usage: tune_and_fit.sh DATASET FIT [SECONDS] [--replace]}
fit=${2:?usage: tune_and_fit.sh DATASET FIT [SECONDS] [--replace]}
root=$(cd "$(dirname "$0")/../.." && pwd)
radiafit=${RADIAFIT:-$root/build/release/bin/radiafit}
if [ -z "${4:-}" ] && [ -e "$fit" ]; then
    echo "$fit: is there already; --replace puts a new fit in its place, or choose another name" >&2
    exit 2
fi
table=$("$radiafit" tune "$dataset" --seconds "${3:-300}")
printf '%s\n' "$table"
# Its last line: radiafit fit DATASET OPTIONS -o DATASET-tuned
options=$(printf '%s\n' "$table" | sed -n '$p')
options=${options#"radiafit fit $dataset "}
options=${options%" -o $dataset-tuned"}
# shellcheck disable=SC2086  # options are words
"$radiafit" fit "$dataset" $options -o "$fit" ${4:+"$4"}
"$radiafit" judge "$fit"
