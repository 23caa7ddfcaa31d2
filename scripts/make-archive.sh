#!/bin/sh
# Packs HEAD for a deposit: what git has of it, results/reference included, and a SHA256SUMS of it all, as
# OUT/radiafit-VERSION-DATE-REVISION.tar.gz, DATE being the commit's. The same commit gives the same bytes (under the same
# versions of git, tar and gzip). Prints its SHA-256, size and name, and leaves them beside it.
# Usage: make-archive.sh [OUT]    OUT: a folder, default build/archive
set -eu
cd "$(dirname "$0")/.."
out=${1:-build/archive}
export LC_ALL=C TZ=UTC
if ! commit=$(git rev-parse -q --verify HEAD); then
    echo "make-archive.sh needs a checkout of radiafit's repository" >&2
    exit 2
fi
if [ -n "$(git status --porcelain --untracked-files=no)" ]; then
    echo "some files differ from HEAD, which alone is packed: commit or stash them" >&2
    exit 2
fi
time=$(git log -1 --format=%ct)
version=$(sed -n 's/^project(radiafit VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
name=radiafit-$version-$(date -d "@$time" +%Y%m%d)-$(printf %.12s "$commit")

mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
git archive --prefix="$name/" -o "$work/git.tar" HEAD
tar -C "$work" -xf "$work/git.tar"
(cd "$work/$name" && find . -type f | sort | xargs -d '\n' sha256sum >../sums && mv ../sums SHA256SUMS)
tar -C "$work" --format=ustar --sort=name --mtime="@$time" --owner=0 --group=0 --numeric-owner --mode=u+rw,go+r,go-w,a+X \
    -cf "$work/sorted.tar" "$name"
gzip -9 -n <"$work/sorted.tar" >"$work/$name.tar.gz"
(cd "$work" && sha256sum "$name.tar.gz" >"$name.tar.gz.sha256")
mv "$work/$name.tar.gz" "$work/$name.tar.gz.sha256" "$out/"
echo "$(cut -d ' ' -f 1 "$out/$name.tar.gz.sha256")  $(wc -c <"$out/$name.tar.gz") bytes  $out/$name.tar.gz"
