#!/bin/sh
# Installs the Debian packages that a command needs: the only list of them. Says nothing and changes nothing where all are
# there. RADIAFIT_SKIP_PACKAGES=1 leaves the system alone.
# Usage: install-packages.sh [PART]            PART: test (the default), or another one of the list below
#        install-packages.sh PART -- COMMAND   runs COMMAND meanwhile; fails if the command or the installation does
set -eu
part=${1:-test}
[ $# = 0 ] || shift
[ "${1:-}" != -- ] || shift  # what remains is the command

compiler="g++ cmake ninja-build make pkg-config ccache"
[ ! -e "${0%/*}/../.git" ] || compiler="$compiler git"  # to tell the revision, which an archive of a commit has in a file
core="libfmt-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libeigen3-dev zlib1g-dev
    libegl-dev libgl-dev libosmesa6-dev"
# `make experiments`, `make report`, `make compare`.
experiments="$compiler $core
    libopenexr-dev libpng-dev libjpeg-dev libwebp-dev liblcms2-dev libutf8proc-dev libceres-dev libqhull-dev libgsl-dev libnlopt-dev
    libegl1 libegl-mesa0 libosmesa6 libgl1-mesa-dri
    gnuplot-nox fonts-dejavu-core python3"
# `make build`: the program with all that it can do on one machine.
build="$experiments libopenimageio-dev libheif-dev"
command -v npm >/dev/null || build="$build nodejs npm"  # of the published page; another source's nodejs has npm in it
# `make python`.
python="$experiments python3-dev pybind11-dev python3-numpy"
# What compiles in `make test`, and what only runs there.
test_programs="$build $python libgtest-dev libopenmpi-dev"
clang="clang clang-tidy libbenchmark-dev"
test="$test_programs git chromium clang-format glslang-tools glslc spirv-tools mesa-vulkan-drivers"

case $part in
experiments) packages=$experiments ;;
build) packages=$build ;;
python) packages=$python ;;
test-programs) packages=$test_programs ;;
test) packages=$test ;;
faults) packages="$build strace" ;;
clang) packages="$test_programs $clang" ;;
check) packages="$test strace $clang vulkan-validationlayers" ;;
fuzz) packages="$build libgtest-dev clang-16 libclang-rt-16-dev" ;;
bench) packages="$experiments libbenchmark-dev" ;;
peers) packages="$experiments python3-numpy python3-torch python3-scipy libopenblas0-pthread" ;;  # else by ATLAS, in twice the time
article) packages="$experiments pandoc texlive-latex-recommended texlive-fonts-recommended librsvg2-bin" ;;
format) packages="clang-format" ;;
radiafit-bench) packages="$compiler $core" ;;
capture) packages=colmap ;;                    # datasets/scripts/capture.sh, beside a built radiafit
bare-root) packages="git mmdebstrap uidmap" ;; # scripts/bare-root.sh; the rest is for the root
*)
    echo "install-packages.sh has no part '$part'; choose experiments, build, python, test-programs, test, faults, clang," \
        "check, fuzz, bench, peers, article, format, radiafit-bench, capture or bare-root" >&2
    exit 2
    ;;
esac

missing=""
if [ "${RADIAFIT_SKIP_PACKAGES:-0}" != 1 ]; then
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        echo "no apt-get here: install what stands for these Debian packages, then set RADIAFIT_SKIP_PACKAGES=1:" $packages >&2
        exit 1
    fi
    for package in $packages; do
        case " $missing " in *" $package "*) continue ;; esac
        status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null) || status=""
        [ "$status" = "install ok installed" ] || missing="$missing $package"
    done
fi
if [ -z "$missing" ]; then
    [ $# = 0 ] || exec "$@"
    exit 0
fi

if [ "$(id -u)" = 0 ]; then
    root=env
elif command -v sudo >/dev/null; then
    root="sudo env"
    [ -t 0 ] || root="sudo -n env"  # nobody is there to type a password
else
    echo "cannot install without sudo: as root, run: apt-get install$missing" >&2
    exit 1
fi

# What apt-get says goes to descriptor 3.
apt() { $root DEBIAN_FRONTEND=noninteractive apt-get -y -qq --no-install-recommends -o DPkg::Lock::Timeout=600 "$@" </dev/null >&3 2>&3; }
install() {
    apt update || echo "apt-get update failed; trying with the lists at hand" >&2
    size=$(apt-get install --print-uris -y -qq --no-install-recommends $missing | awk '{ sum += $3 } END { printf "%.0f", sum / 1e6 }')
    echo "installing, $size MB to download:$missing" >&2
    apt install $missing
}
fail() {
    echo "could not install:$missing; install them by hand, or set RADIAFIT_SKIP_PACKAGES=1 to do without" >&2
    exit 1
}

if [ $# = 0 ]; then
    install 3>&2 || fail
    exit 0
fi
$root true  # asks for a password, if any, before the command writes
log=$(mktemp)
trap 'rm -f "$log"' EXIT
trap 'exit 130' INT
install 3>"$log" &
status=0
"$@" || status=$?
wait $! || { cat "$log" >&2 && fail; }
exit "$status"
