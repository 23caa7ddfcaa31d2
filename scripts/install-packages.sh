#!/bin/sh
# Installs every Debian package that the build, the tests and the figures need: the only list of them.
# `install-packages.sh fuzz`, `check` or `peers`: what `make fuzz`, `make check` or `make peers` needs, too; `bench`,
# `bare-root` or `capture`: only what `make radiafit-bench`, scripts/bare-root.sh or datasets/scripts/capture.sh needs.
# Says nothing and changes nothing where all are there. RADIAFIT_SKIP_PACKAGES=1 leaves the system alone.
set -eu

packages="
    g++ cmake ninja-build make git pkg-config ccache
    libfmt-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libeigen3-dev
    libopenimageio-dev libopenexr-dev libpng-dev libjpeg-dev zlib1g-dev
    libwebp-dev chromium
    libgtest-dev libbenchmark-dev libceres-dev libqhull-dev
    libegl-dev libgl-dev libosmesa6-dev
    libegl1 libegl-mesa0 libosmesa6 libgl1-mesa-dri
    gnuplot-nox fonts-dejavu-core strace
    libopenmpi-dev openmpi-bin
    clang-format glslang-tools spirv-tools python3 python3-numpy python3-matplotlib python3-dev pybind11-dev
"
command -v npm >/dev/null || packages="$packages nodejs npm"  # of the published page; another source's nodejs has npm in it
[ "${1:-}" != fuzz ] || packages="$packages clang-16 libclang-rt-16-dev"
[ "${1:-}" != check ] || packages="$packages clang clang-tidy"
[ "${1:-}" != bench ] || packages="
    g++ cmake ninja-build make git ccache
    libfmt-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libeigen3-dev zlib1g-dev
    libegl-dev libgl-dev libosmesa6-dev
"
[ "${1:-}" != peers ] || packages="$packages python3-torch"
[ "${1:-}" != capture ] || packages="colmap"
[ "${1:-}" != bare-root ] || packages="git mmdebstrap uidmap"  # the rest is for the root

[ "${RADIAFIT_SKIP_PACKAGES:-0}" = 1 ] && exit 0

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "no apt-get here: install what stands for these Debian packages, then set RADIAFIT_SKIP_PACKAGES=1:" $packages >&2
    exit 1
fi

missing=""
for package in $packages; do
    status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null) || status=""
    [ "$status" = "install ok installed" ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

echo "installing:$missing" >&2
if [ "$(id -u)" = 0 ]; then
    root=env
elif command -v sudo >/dev/null; then
    root="sudo env"
    [ -t 0 ] || root="sudo -n env"  # nobody is there to type a password
else
    echo "cannot install without sudo: as root, run: apt-get install$missing" >&2
    exit 1
fi
$root DEBIAN_FRONTEND=noninteractive apt-get update -qq </dev/null ||
    echo "apt-get update failed; trying with the lists at hand" >&2
if ! $root DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing </dev/null >&2; then
    echo "could not install:$missing; install them by hand, or set RADIAFIT_SKIP_PACKAGES=1 to do without" >&2
    exit 1
fi
