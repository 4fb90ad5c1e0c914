"""Where the plugin's own files are, and the user's."""

from __future__ import annotations

import ctypes
import os
import re
import sys
from collections.abc import Collection
from pathlib import Path

from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtGui import QDesktopServices, QIcon

#: Folder of the user's profile with what was copied of datasets at addresses.
COPIES = "TerrAInav/addresses"
#: Folder of the user's profile with notes of captures that have not ended.
UNFINISHED = "TerrAInav/unfinished"
#: Where Linux lists what is mounted, and kinds of file systems there that another machine serves.
_MOUNTS = Path("/proc/self/mounts")
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
    """Folder that a user has entered; one that begins with nobody's ``~name`` is taken as it stands."""
    path = Path(text.strip())
    try:
        return path.expanduser()
    except RuntimeError:
        return path


def is_remote(folder: str | os.PathLike[str]) -> bool:
    """Whether another machine has a folder, by what is known here: that machine is asked nothing."""
    text = str(folder).replace("\\", "/")
    if "://" in text or text.startswith("//"):
        return True
    if sys.platform == "win32":
        # DRIVE_REMOTE: a drive of another machine.
        return bool(ctypes.windll.kernel32.GetDriveTypeW(f"{Path(folder).drive}\\") == 4)
    try:
        mounts = [line.split(" ") for line in _MOUNTS.read_text("utf-8", "replace").splitlines()]
    except OSError:
        return False
    # Spaces are written in octal there.
    places = [(kind, at.replace("\\040", " ").rstrip("/")) for _, at, kind, *_ in mounts]
    above = [(len(at), kind) for kind, at in places if f"{text}/".startswith(f"{at}/")]
    return bool(above) and max(above)[1].startswith(_SERVED)


def path_key(path: Path) -> str:
    """Key of a path, the same for all ways of writing it."""
    return os.path.normcase(os.path.realpath(path))


def icon(name: str) -> QIcon:
    """Icon of an action."""
    return QIcon(str(RESOURCES / f"{name}.svg"))


def symbol(name: str) -> str:
    """Path of an image that a place is marked by on the map."""
    return str(RESOURCES / f"{name}.svg")


def style(name: str) -> str:
    """Path of a layer style."""
    return str(RESOURCES / f"{name}.qml")


def open_in_system(path: Path) -> None:
    """Open a folder or file with the program that the system has for it."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))


def exists(path: Path) -> bool:
    """Whether something is at a path.

    Not for one that nobody can look at, where `Path.exists` raises: in a folder of another user, or with a name longer
    than systems take. The same holds for `is_folder`, and for files of `files.is_there`.
    """
    return os.path.exists(path)  # noqa: PTH110


def is_folder(path: Path) -> bool:
    """Whether a path is that of a folder."""
    return os.path.isdir(path)  # noqa: PTH112


def next_folder(folder: Path, taken: Collection[Path] = ()) -> Path:
    """Folder beside ``folder`` that does not exist yet and is not ``taken``: mission, mission-2, mission-3."""
    stem = re.sub(r"-\d+$", "", folder.name)
    number = 2
    while exists(candidate := folder.with_name(f"{stem}-{number}")) or candidate in taken:
        number += 1
    return candidate
