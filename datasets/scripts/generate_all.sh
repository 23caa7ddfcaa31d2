#!/bin/sh
# Generates every synthetic dataset at one scale into datasets/packed, where the experiments look for them.
# Usage: generate_all.sh smoke|standard|paper
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
scale=${1:?usage: generate_all.sh smoke|standard|paper}
radiafit=${RADIAFIT:-$root/build/release/bin/radiafit}
for shape in star bust ornament; do
    "$radiafit" generate $shape --scale "$scale" -o "$root/datasets/packed/$shape-$scale"
done
