#!/bin/sh
# Prints the apt sources of the Debian 12 that results are made on, for Containerfile and bare-root.sh.
# Usage: debian-sources.sh [DATE]    DATE: of snapshot.debian.org, such as 20250520T000000Z (the default); empty: the
#                                    mirrors as they are today ($MIRROR, default http://deb.debian.org)
set -eu
date=${1-20250520T000000Z}
mirror=${MIRROR:-http://deb.debian.org}
archive=$mirror/debian security=$mirror/debian-security option=
case $date in
'') ;;
[0-9][0-9][0-9][0-9][0-9][0-9][0-9][0-9]T[0-9][0-9][0-9][0-9][0-9][0-9]Z)
    archive=http://snapshot.debian.org/archive/debian/$date
    security=http://snapshot.debian.org/archive/debian-security/$date
    option='[check-valid-until=no] '  # an old archive's lists have run out
    ;;
*)
    echo "'$date' is no date of snapshot.debian.org; give one such as 20250520T000000Z, or an empty one" >&2
    exit 2
    ;;
esac
echo "deb $option$archive bookworm main"
echo "deb $option$archive bookworm-updates main"
echo "deb $option$security bookworm-security main"
