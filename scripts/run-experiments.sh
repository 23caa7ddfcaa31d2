#!/bin/sh
# Runs the experiments one after another: one per experiments/NAME.toml, table1_datasets and fig7_convergence first,
# claims and report (which read the others' results) last.
# Usage: run-experiments.sh BUILD PROFILE [ONLY]    ONLY: a part of the names to run, such as fig7
#        run-experiments.sh --list [ONLY]           prints the names in order
# An experiment that fails doesn't keep the others from running; the exit status is that of the first failure. Ctrl-C ends
# the one that runs, SIGTERM to this script lets it end, and either leaves out the rest; what is done stays. The paper
# profile, which takes hours, says before it starts what it needs, and goes on where it was broken off: what this revision has
# run already is not run again.
set -eu
cd "$(dirname "$0")/.."

names() {  # in order, those that contain $1
    set -- "${1:-}" "$(for config in experiments/*.toml; do basename "$config" .toml; done | sort)"
    {
        printf '%s\n' table1_datasets fig7_convergence
        printf '%s\n' "$2" | grep -vxE 'table1_datasets|fig7_convergence|claims|report' || true
        printf '%s\n' claims report
    } | while read -r name; do
        [ -f "experiments/$name.toml" ] || continue
        case $name in *"$1"*) echo "$name" ;; esac
    done
}

only=${3:-}
[ "${1:-}" = --list ] && only=${2:-}
list=$(names "$only")
if [ -z "$list" ]; then
    echo "no experiment's name contains '$only'; there are:" $(names) >&2
    exit 2
fi
if [ "${1:-}" = --list ]; then
    printf '%s\n' "$list"
    exit 0
fi
if [ $# -lt 2 ]; then
    echo "usage: run-experiments.sh BUILD PROFILE [ONLY] | --list [ONLY]" >&2
    exit 2
fi
build=$1 profile=$2

# Mesa keeps compiled shaders here rather than in the user's home.
MESA_SHADER_CACHE_DIR=${MESA_SHADER_CACHE_DIR:-$(cd "$build" && pwd)/shader-cache}
export MESA_SHADER_CACHE_DIR
mkdir -p "$MESA_SHADER_CACHE_DIR"

resume=""
if [ "$profile" = paper ]; then
    resume=--resume
    python3 -B scripts/profile-needs.py "$profile" $list >&2
fi
figures=paper_figs page=results/report/index.html
[ "$profile" = standard ] || figures=paper_figs/$profile page=results/report/$profile/index.html

started=$(date +%s)
first_failure=0
failed=""
begun=""
stopped=""
trap 'stopped=130' INT
trap 'stopped=143' TERM
for name in $list; do
    [ -z "$stopped" ] || break
    begun="$begun $name"
    echo "== $name ($profile)" >&2
    status=0
    "$build/experiments/$name" --config "experiments/$name.toml" --profile "$profile" $resume </dev/null ||
        status=$?
    case $status in 130 | 143) stopped=$status ;; esac
    if [ "$status" != 0 ]; then
        echo "$name failed with status $status" >&2
        failed="$failed $name"
        [ "$first_failure" != 0 ] || first_failure=$status
    fi
done

echo
echo "took $(($(date +%s) - started)) s; where to look:"
for name in $list; do
    case " $failed " in *" $name "*) echo "  $name: failed" && continue ;; esac
    case " $begun " in *" $name "*) ;; *) echo "  $name: not run" && continue ;; esac
    for drawn in "$figures/$name".*; do
        case $drawn in *.gp | *'*') ;; *) echo "  $drawn" ;; esac
    done
    # Names of runs begin with their time, in a form that sorts.
    newest=$(for run in results/"$name"/*/*/run.json; do
        [ -f "$run" ] && echo "$(basename "$(dirname "$run")") $(dirname "$run")"
    done | sort | tail -n 1 | cut -d ' ' -f 2-)
    [ -z "$newest" ] || echo "  $newest/  (rows)"
    [ "$name" != report ] || echo "  $page  (all of it on one page, for a browser)"
done
exit "${stopped:-$first_failure}"
