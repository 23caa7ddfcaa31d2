#!/bin/sh
# Prints the program that the scripts beside it call: $RADIAFIT, or the checkout's as `make build` leaves it.
set -eu
radiafit=${RADIAFIT:-$(cd "$(dirname "$0")/../.." && pwd)/build/release/bin/radiafit}
if [ ! -x "$radiafit" ]; then
    echo "$radiafit is missing: run make build" >&2
    exit 2
fi
printf '%s\n' "$radiafit"
