#!/bin/sh
# Makes a bare Debian 12 by mmdebstrap, puts a clean checkout of HEAD there, and runs both commands of the README in it:
# `make experiments` and `make test`. Needs no root where user namespaces are allowed. The root is thrown away; figures and
# rows come back.
# Usage: bare-root.sh [OUT]    OUT: a folder for figures and rows, default build/bare-root
# Variables:
#   PROFILE=standard|smoke|paper   size of the experiments
#   RUN="experiments test"         what to run: targets of the Makefile, one after another; RUN=configure only installs
#                                  packages and configures,
#   PACKAGES=test                  namely those of this part of scripts/install-packages.sh
#   JOBS=n                         compilers at a time, a gigabyte each
#   SNAPSHOT=20250520T000000Z      day of snapshot.debian.org that packages are taken of; empty: today's, from MIRROR
#   MIRROR=http://deb.debian.org   where archives `debian` and `debian-security` are
set -eu
cd "$(dirname "$0")/.."
out=${1:-build/bare-root}
profile=${PROFILE:-standard}
jobs=${JOBS:-$(nproc)}

refuse() {
    echo "$1" >&2
    exit 2
}
case $profile in smoke | standard | paper) ;; *) refuse "PROFILE=$profile: choose smoke, standard or paper" ;; esac
for target in ${RUN:=experiments test}; do
    case $target in *[!a-z-]*) refuse "RUN: '$target' is no target of the Makefile" ;; esac
done
case ${PACKAGES:=test} in *[!a-z-]*) refuse "PACKAGES=$PACKAGES: scripts/install-packages.sh names its parts" ;; esac
sources=$(scripts/debian-sources.sh ${SNAPSHOT+"$SNAPSHOT"})
git rev-parse -q --verify HEAD >/dev/null || refuse "bare-root.sh needs a checkout of radiafit's repository"
command -v mmdebstrap >/dev/null || refuse "mmdebstrap is missing: run scripts/install-packages.sh bare-root"
if [ "$(id -u)" = 0 ]; then
    mode=root
else
    mode=unshare
    unshare --user --map-root-user true 2>/dev/null || refuse "this system does not allow user namespaces: as root, \
run sysctl -w kernel.unprivileged_userns_clone=1 (Debian) or kernel.apparmor_restrict_unprivileged_userns=0 (Ubuntu); \
or run bare-root.sh as root"
    command -v newuidmap >/dev/null || refuse "newuidmap is missing: run scripts/install-packages.sh bare-root"
    for table in /etc/subuid /etc/subgid; do
        grep -qE "^($(id -un)|$(id -u)):" "$table" 2>/dev/null || refuse "$table gives $(id -un) no ids of its own: \
as root, run usermod --add-subuids 100000-165535 --add-subgids 100000-165535 $(id -un)"
    done
fi
[ -z "$(git status --porcelain --untracked-files=no)" ] || echo "what is not committed is left out" >&2

mkdir -p "$out"
out=$(cd "$out" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"  # another user's, in a user namespace
git archive --prefix=radiafit/ -o "$work/radiafit.tar" HEAD
printf '%s\n' "$sources" >"$work/sources.list"
cat >"$work/run.sh" <<END
#!/bin/sh
# Both commands, each told how it ended; then figures and rows.
status=0
for target in $RUN; do
    started=\$(date +%s)
    if (cd /radiafit && make \$target PROFILE=$profile JOBS=$jobs PACKAGES=$PACKAGES </dev/null); then
        times >/times  # what shells print has the commands they ran in the second line: user, system
        echo "bare root: make \$target passed in \$((\$(date +%s) - started)) s; processor time so far: \$(tail -n 1 /times)"
    else
        status=\$?
        echo "bare root: make \$target failed with status \$status"
    fi
done
tar -C /radiafit -cf /results.tar paper_figs results
echo \$status >/status
END
chmod 755 "$work/run.sh"

# Nothing but what is essential, apt, and `make` to type the commands. The commands' status comes back in a file: a hook
# that fails would throw the figures away.
mmdebstrap --mode=$mode --variant=apt --include=make --format=null \
    --customize-hook="upload '$work/sources.list' /etc/apt/sources.list" \
    --customize-hook="tar-in '$work/radiafit.tar' /" \
    --customize-hook="upload '$work/run.sh' /run.sh" \
    --customize-hook='chmod 755 "$1/run.sh"' \
    --customize-hook="chroot \"\$1\" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root ${http_proxy:+http_proxy='$http_proxy'} /run.sh" \
    --customize-hook="download /results.tar '$work/results.tar'" \
    --customize-hook="download /status '$work/status'" \
    bookworm - <"$work/sources.list"
tar -C "$out" -xf "$work/results.tar"
echo "figures and rows: $out"
exit "$(cat "$work/status")"
