#!/bin/sh
# Everything compiles with clang without a warning, and clang-tidy finds nothing in src/ (.clang-tidy has its checks).
# Usage: run-clang-tidy.sh [JOBS [FILES]]    FILES: only sources whose path has this regular expression
set -eu
cd "$(dirname "$0")/.."
jobs=${1:-$(nproc)}

cmake --preset clang --log-level=WARNING
cmake --build build/clang --parallel "$jobs" --target all kernel_benches

log=build/clang/clang-tidy.log
if ! run-clang-tidy -p build/clang -quiet -j "$jobs" "^$PWD/src/.*${2:-}" >"$log" 2>&1; then
    sed -i 's/\x1b\[[0-9;]*m//g' "$log"  # it colours files, too
    sort -u "$log" | grep -E ': (error|warning): ' || tail -n 20 "$log"
    echo "clang-tidy has findings; all that it says: $log" >&2
    exit 1
fi
