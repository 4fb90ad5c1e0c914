"""Paths of files of the plugin and of the user."""

from __future__ import annotations

import ctypes
import os
import re
import sys
from collections.abc import Collection
from pathlib import Path

from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtGui import QDesktopServices, QIcon

#: Folder of the user's profile for copies of remote datasets.
COPIES = "TerrAInav/addresses"
#: Folder of the user's profile for notes on unfinished captures.
UNFINISHED = "TerrAInav/unfinished"
#: List of mounted file systems on Linux.
_MOUNTS = Path("/proc/self/mounts")
#: Types of network file systems in that list, or the beginning of their names.
_SERVED = (
    "nfs",
    "cifs",
    "smb",
    "9p",
    "afs",
    "ncpfs",
    "davfs",
    "fuse.sshfs",
    "fuse.rclone",
    "fuse.s3fs",
    "fuse.gvfs",
)
RESOURCES = Path(__file__).resolve().parent.parent / "resources"


def entered_folder(text: str) -> Path:
    """Folder that a user has entered; ``~name`` of an unknown user is taken literally."""
    path = Path(text.strip())
    try:
        return path.expanduser()
    except RuntimeError:
        return path


def is_remote(folder: str | os.PathLike[str]) -> bool:
    """Whether a folder is on another machine; determined without contacting that machine."""
    text = str(folder).replace("\\", "/")
    if "://" in text or text.startswith("//"):
        return True
    if sys.platform == "win32":
        # 4 is DRIVE_REMOTE, a network drive.
        return bool(ctypes.windll.kernel32.GetDriveTypeW(f"{Path(folder).drive}\\") == 4)
    try:
        mounts = [line.split(" ") for line in _MOUNTS.read_text("utf-8", "replace").splitlines()]
    except OSError:
        return False
    # The list has spaces in octal.
    places = [(kind, at.replace("\\040", " ").rstrip("/")) for _, at, kind, *_ in mounts]
    above = [(len(at), kind) for kind, at in places if f"{text}/".startswith(f"{at}/")]
    return bool(above) and max(above)[1].startswith(_SERVED)


def path_key(path: Path) -> str:
    """Key that is the same for all spellings of a path."""
    return os.path.normcase(os.path.realpath(path))


def icon(name: str) -> QIcon:
    """Icon of an action."""
    return QIcon(str(RESOURCES / f"{name}.svg"))


def symbol(name: str) -> str:
    """Path of an image that marks a place on the map."""
    return str(RESOURCES / f"{name}.svg")


def style(name: str) -> str:
    """Path of a layer style."""
    return str(RESOURCES / f"{name}.qml")


def open_in_system(path: Path) -> None:
    """Open a folder or file with the system's default program."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))


def exists(path: Path) -> bool:
    """Whether a file or folder exists.

    Where `Path.exists` raises, return False: in a folder that may not be read, or for a name too long for the system.
    The same holds for `is_folder` and `files.file_exists`.
    """
    return os.path.exists(path)  # noqa: PTH110


def is_folder(path: Path) -> bool:
    """Whether a path is a folder."""
    return os.path.isdir(path)  # noqa: PTH112


def next_folder(folder: Path, taken: Collection[Path] = ()) -> Path:
    """Folder with the next number that neither exists nor is ``taken``: mission-2 or mission-3 for mission."""
    stem = re.sub(r"-\d+$", "", folder.name)
    number = 2
    while exists(candidate := folder.with_name(f"{stem}-{number}")) or candidate in taken:
        number += 1
    return candidate
