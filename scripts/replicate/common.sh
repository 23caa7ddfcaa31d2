# What the scripts beside this one share. On a bare Debian 12 it installs what is missing, make among it, builds, runs one experiment
# and says where its figure lies.
# Usage: . common.sh, then: replicate EXPERIMENT [ENDING]    ENDING: of the file to look at, png or md
set -eu
cd "$(dirname "$0")/../.."

replicate() {
    scripts/install-packages.sh experiments
    make experiments ONLY="$1"
    figures=paper_figs
    [ "${PROFILE:-standard}" = standard ] || figures=paper_figs/$PROFILE
    echo "the paper's figure, as it comes out here: $(pwd)/$figures/$1.${2:-png}"
}
