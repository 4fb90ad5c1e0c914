#!/usr/bin/env bash
# Runs the plugin's tests in another QGIS than this machine's: 3.40, which Debian 13 has, or 3.44 of its backports, each in
# a small system of its own below the user's cache folder. Needs root and, the first time, some minutes and 2.4 GB.
#
#     tools/debian13.sh 3.44                              tests/plugin, but for what is thorough or the same in any QGIS
#     tools/debian13.sh 3.40 tests/plugin/test_dock.py    what pytest is given
#     tools/debian13.sh 3.44 -- COMMAND …                 a command in the copy of this folder there
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf 'debian13: %s\n' "$*" >&2; }

VERSION=${1:-}
case $VERSION in
    3.40 | 3.44) shift ;;
    *)
        say "QGIS '$VERSION': there are 3.40 and 3.44"
        exit 2
        ;;
esac
SYSTEM=${TERRAINAV_SYSTEMS:-${XDG_CACHE_HOME:-$HOME/.cache}/terrainav}/debian-13-qgis-$VERSION
MIRROR=http://deb.debian.org/debian
PLACE=/root/terrainav
# For a run that hangs.
LIMIT_S=${TERRAINAV_LIMIT_S:-3600}

if [[ $(id -u) -ne 0 ]]; then
    say "a system of its own can only be made and entered by root; run this as root"
    exit 1
fi
if ! command -v debootstrap >/dev/null; then
    apt-get -o DPkg::Lock::Timeout=600 --quiet update || say "apt-get update failed; going on with the package lists at hand"
    apt-get -o DPkg::Lock::Timeout=600 --quiet install --no-install-recommends --yes debootstrap
fi
if [[ ! -e $SYSTEM/made ]]; then
    # Made beside its place, so that one that was interrupted is never taken for a whole one.
    say "making Debian 13 in $SYSTEM"
    rm -rf "$SYSTEM" "$SYSTEM.part"
    mkdir -p "$(dirname "$SYSTEM")"
    debootstrap --variant=minbase --include=ca-certificates,git,make,procps trixie "$SYSTEM.part" "$MIRROR" >&2
    # A system that is not whole is made anew, so nothing has to be on the disk at once; nobody reads its manuals.
    printf '%s\n' force-unsafe-io 'path-exclude=/usr/share/doc/*' 'path-exclude=/usr/share/man/*' \
        >"$SYSTEM.part/etc/dpkg/dpkg.cfg.d/quick"
    if [[ $VERSION == 3.44 ]]; then
        printf 'deb %s trixie-backports main\n' "$MIRROR" >"$SYSTEM.part/etc/apt/sources.list.d/backports.list"
        printf 'Package: src:qgis\nPin: release n=trixie-backports\nPin-Priority: 990\n' \
            >"$SYSTEM.part/etc/apt/preferences.d/qgis"
    fi
    touch "$SYSTEM.part/made"
    mv "$SYSTEM.part" "$SYSTEM"
fi

# One run at a time: the copy and its environment are shared.
exec 9>"$SYSTEM.lock"
flock 9

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
    exec chroot "$system" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 \
        PIP_CERT=/etc/ssl/certs/ca-certificates.crt \
        bash -euo pipefail -c '\''
            cd "$1" && shift
            limit=$1 && shift
            # The package is made of a commit.
            git init --quiet && git add --all && git -c user.name=- -c user.email=- commit --quiet --message copy
            bash tools/setup.sh plugin-tests
            make --silent translations
            dpkg-query --show --showformat="\${Package} \${Version}\n" qgis python3 python3-numpy >&2
            if [[ ${1:-} == -- ]]; then
                shift
                exec "$@"
            fi
            # What says the same in every QGIS is tried in the one of the machine.
            (($#)) || set -- tests/plugin -m "not thorough and not any_qgis"
            exec .venv/bin/python tools/qgis_app.py --timeout "$limit" --pytest "$@"
        '\'' bash "$place" "$limit" "$@"
' bash "$SYSTEM" "$PLACE" "$LIMIT_S" "$@"
