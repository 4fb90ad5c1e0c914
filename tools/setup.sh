#!/usr/bin/env bash
# Installs what is missing on Debian or Ubuntu. Safe to run again; quick when nothing is to be done.
#
#     tools/setup.sh                 QGIS and what the plugin needs beside it, from the distribution alone
#     tools/setup.sh tests           what the tests need as well, and .venv with their packages
#     tools/setup.sh plugin-tests    the same for the tests inside QGIS alone
#     tools/setup.sh newest          beside .venv of the tests: one with the newest numpy and Pillow, without QGIS's modules
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# QGIS is built against the distribution's Python and its modules, so no other Python will do.
PYTHON=/usr/bin/python3
PACKAGES=(
    qgis python3-qgis xvfb git qttools5-dev-tools
    python3-gdal python3-matplotlib python3-numpy python3-owslib python3-pil python3-pyproj python3-pyqt5.qtsvg python3-requests
    ca-certificates fonts-dejavu-core libgl1-mesa-dri
)
WANTED=${1:-}
if [[ -n $WANTED ]]; then
    # proj-bin: inside a virtual environment the distribution's pyproj finds its data by where the `proj` command is.
    PACKAGES+=(python3-venv libegl1 libimage-exiftool-perl proj-bin)
fi
if [[ $WANTED == tests ]]; then
    # Shadows are compared with GRASS's, a page is opened in Chromium, and video is streamed by GStreamer.
    PACKAGES+=(
        grass-core chromium ffmpeg gir1.2-gst-rtsp-server-1.0 python3-gst-1.0
        gstreamer1.0-plugins-base gstreamer1.0-plugins-good gstreamer1.0-plugins-ugly
    )
fi
STAMP=.venv/terrainav-setup-$WANTED

say() { printf 'set-up: %s\n' "$*" >&2; }

# What this set-up depends on. `.venv` records absolute paths, so a moved folder needs a new one.
fingerprint() {
    { pwd; cat tools/setup.sh pyproject.toml; dpkg-query --show "${PACKAGES[@]}" 2>/dev/null || true; } | sha256sum
}

missing_packages() {
    local package
    for package in "${PACKAGES[@]}"; do
        [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
            printf '%s\n' "$package"
    done
}

install_packages() {
    local -a missing as_root=()
    mapfile -t missing < <(missing_packages)
    [[ ${#missing[@]} -eq 0 ]] && return

    if [[ $(id -u) -ne 0 ]]; then
        # sudo can ask for a password only where somebody is there to type it.
        if command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [[ -t 0 ]]; }; then
            as_root=(sudo)
        else
            say "these packages are missing and this user may not install them; run this as root, then try again:"
            printf 'apt-get update && apt-get install --no-install-recommends --yes %s\n' "${missing[*]}" >&2
            exit 1
        fi
    fi
    say "installing ${missing[*]}"
    local -a apt=(
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive NEEDRESTART_MODE=a
        apt-get -o DPkg::Lock::Timeout=600 -o Acquire::Retries=3 --quiet
    )
    "${apt[@]}" update || say "apt-get update failed; going on with the package lists at hand"
    "${apt[@]}" install --no-install-recommends --yes "${missing[@]}"
}

# Versions that pip must leave alone: QGIS was built with them, and shares them with what is installed here.
write_constraints() {
    "$PYTHON" -I - >.venv/constraints.txt <<'PY'
from importlib.metadata import PackageNotFoundError, version

for name in ("numpy", "Pillow", "pyproj", "requests", "urllib3", "certifi", "idna", "chardet", "charset-normalizer"):
    try:
        print(f"{name}=={version(name)}")
    except PackageNotFoundError:
        continue
# Debian has the compiled half of cffi alone; the other half fits one release of it, and numba needs both.
try:
    import _cffi_backend
except ImportError:
    pass
else:
    print(f"cffi=={_cffi_backend.__version__}")
PY
}

verify_shared_modules() {
    .venv/bin/python -I - <<'PY'
import importlib
import subprocess
import sys

for name in ("numpy", "PIL", "pyproj", "requests", "urllib3"):
    here = importlib.import_module(name).__file__
    code = f"import {name}; print({name}.__file__)"
    system = subprocess.run(["/usr/bin/python3", "-Ic", code], check=True, capture_output=True, text=True).stdout.strip()
    if here != system:
        sys.exit(f"set-up: {name} is imported from {here}, but QGIS uses {system}; remove .venv and try again")

import pyproj

pyproj.CRS.from_epsg(3857)  # fails where pyproj does not find its data
PY
}

make_environment() {
    say "making .venv"
    "$PYTHON" -m venv --clear --system-site-packages .venv
    write_constraints
    local extras=test,lint
    [[ $WANTED == plugin-tests ]] && extras=test-plugin
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-input \
        --constraint .venv/constraints.txt --editable ".[$extras]"
    verify_shared_modules
    [[ $WANTED == plugin-tests ]] && return
    # The Qt of QGIS 4; in a folder of its own nothing takes it for the Qt that this QGIS has.
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-input --no-deps \
        --target .venv/qt6 'PyQt6==6.8.*' 'PyQt6-sip>=13.8,<14' 'PyQt6-Qt6==6.8.*'
    # What results are compared with; it brings a numpy of its own, which must not meet QGIS's.
    "$PYTHON" -m venv .venv/peers
    .venv/peers/bin/python -m pip install --quiet --disable-pip-version-check --no-input \
        'scikit-image>=0.24,<1' 'colour-science>=0.4.6,<0.5' lxml 'pvlib>=0.11,<1' 'pycolmap>=4.2,<5' piexif 'evo>=1.31,<2'
    # Of what it requires besides, its reports alone have a use.
    .venv/peers/bin/python -m pip install --quiet --disable-pip-version-check --no-input --no-deps 'emva1288==1.0.2'
}

if [[ $WANTED == newest ]]; then
    # What is newest changes by the day: made anew by the day.
    newest=.venv/newest made=$(date +%F)$(cat tools/setup.sh pyproject.toml | sha256sum)
    [[ -f $newest/made && $(<$newest/made) == "$made" ]] && exit 0
    "$PYTHON" -m venv --clear $newest
    $newest/bin/python -m pip install --quiet --disable-pip-version-check --no-input --upgrade \
        --editable ".[cluster,raster]" numpy pillow pyproj pytest hypothesis mpmath matplotlib scipy pyulog pymavlink
    printf %s "$made" >$newest/made
    exit 0
fi
if [[ -n $WANTED && -f $STAMP && $(<"$STAMP") == "$(fingerprint)" ]]; then
    exit 0
fi
if ! command -v apt-get >/dev/null; then
    say "this set-up installs with apt-get, which is not here; it needs Debian 12, Ubuntu 24.04, or newer ones"
    exit 1
fi
install_packages
if [[ -n $WANTED ]]; then
    make_environment
    fingerprint >"$STAMP"
    say "done"
fi
