#!/bin/sh
# Generates every synthetic dataset at one scale into datasets/packed, where the experiments look for them.
# Usage: generate_all.sh smoke|standard|paper [--replace]     --replace: also those that are there already
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
scale=${1:?usage: generate_all.sh smoke|standard|paper [--replace]}
radiafit=${RADIAFIT:-$root/build/release/bin/radiafit}
for shape in star bust ornament; do
    "$radiafit" generate $shape --scale "$scale" -o "$root/datasets/packed/$shape-$scale" ${2:+"$2"}
done
