#!/bin/sh
# Fits a packed dataset as `radiafit tune` recommends, chosen on training images alone, and judges it on those held out.
# Usage: tune_and_fit.sh DATASET FIT [SECONDS]     SECONDS: about how long tune may take, default 300
set -eu
dataset=${1:?usage: tune_and_fit.sh DATASET FIT [SECONDS]}
fit=${2:?usage: tune_and_fit.sh DATASET FIT [SECONDS]}
root=$(cd "$(dirname "$0")/../.." && pwd)
radiafit=${RADIAFIT:-$root/build/release/bin/radiafit}
table=$("$radiafit" tune "$dataset" --seconds "${3:-300}")
printf '%s\n' "$table"
# Its last line: radiafit fit DATASET OPTIONS -o DATASET-fit
options=$(printf '%s\n' "$table" | sed -n '$p')
options=${options#"radiafit fit $dataset "}
options=${options%" -o $dataset-fit"}
# shellcheck disable=SC2086  # options are words
"$radiafit" fit "$dataset" $options -o "$fit"
"$radiafit" judge "$fit"
