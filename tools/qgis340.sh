#!/usr/bin/env bash
# Runs the plugin's tests in the QGIS 3.40 of Debian 13, in a small system of its own below the user's cache folder.
# Needs root and, the first time, some minutes and 2.4 GB. Arguments, paths first, go to pytest instead of `tests/plugin`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

SYSTEM=${TERRAINAV_QGIS340:-${XDG_CACHE_HOME:-$HOME/.cache}/terrainav/debian-13}
MIRROR=http://deb.debian.org/debian
PLACE=/root/terrainav
# Slower than the tests' own limit, as the system may be new and its caches are cold.
LIMIT_S=${TERRAINAV_QGIS340_LIMIT_S:-1500}

say() { printf 'qgis340: %s\n' "$*" >&2; }

if [[ $(id -u) -ne 0 ]]; then
    say "a system of its own can only be made and entered by root; run this as root"
    exit 1
fi
if ! command -v debootstrap >/dev/null; then
    apt-get -o DPkg::Lock::Timeout=600 --quiet install --no-install-recommends --yes debootstrap
fi
if [[ ! -e $SYSTEM/made ]]; then
    if [[ -e $SYSTEM ]]; then
        say "$SYSTEM is not whole; remove it and try again"
        exit 1
    fi
    say "making Debian 13 in $SYSTEM"
    mkdir -p "$(dirname "$SYSTEM")"
    debootstrap --variant=minbase --include=ca-certificates,git,make,procps trixie "$SYSTEM" "$MIRROR" >&2
    touch "$SYSTEM/made"
fi

# What is tracked or new here, as it is now; what an earlier copy had beyond that goes, its environment stays.
mkdir -p "$SYSTEM$PLACE"
find "$SYSTEM$PLACE" -mindepth 1 -maxdepth 1 ! -name .venv -exec rm -rf {} +
git ls-files -z --cached --others --exclude-standard --deduplicate |
    while IFS= read -r -d '' file; do [[ -e $file ]] && printf '%s\0' "$file"; done |
    tar --create --null --files-from=- | tar --extract --directory="$SYSTEM$PLACE" --no-same-owner
# The way to the network is this machine's, with the certificates it trusts.
cp /etc/resolv.conf /etc/hosts "$SYSTEM/etc/"
cp --dereference /etc/ssl/certs/ca-certificates.crt "$SYSTEM/etc/ssl/certs/"

# Mounts live in a name space that ends with the last process in it: nothing stays mounted, nothing stays running.
exec unshare --mount --pid --fork --kill-child bash -euo pipefail -c '
    system=$1 place=$2 limit=$3
    shift 3
    mount -t proc proc "$system/proc"
    mount --rbind /dev "$system/dev"
    exec chroot "$system" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
        PIP_CERT=/etc/ssl/certs/ca-certificates.crt \
        bash -euo pipefail -c '\''
            cd "$1" && shift
            limit=$1 && shift
            make --silent translations
            dpkg-query --show --showformat="\${Package} \${Version}\n" qgis python3 python3-numpy >&2
            exec .venv/bin/python tools/qgis_app.py --timeout "$limit" --pytest "${@:-tests/plugin}"
        '\'' bash "$place" "$limit" "$@"
' bash "$SYSTEM" "$PLACE" "$LIMIT_S" "$@"
