"""One run at a time: a file that is opened for one process alone.

The lock is the operating system's, so that it goes with the process that holds it, however that ends.
"""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path
from typing import IO

from .errors import OutputError
from .files import open_own

if sys.platform == "win32":
    import msvcrt

    #: Windows keeps other processes from reading what is locked: a byte that no file has.
    _LOCKED_BYTE = 1 << 30

    def _lock(file: int) -> None:
        os.lseek(file, _LOCKED_BYTE, os.SEEK_SET)
        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: int) -> None:
        # flock and not lockf, whose locks do not keep two captures of one process apart.
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


#: What the systems say where somebody else has the lock. Anything else means that the file system has no locks
#: (some network drives), which is no reason to refuse a capture.
_HELD = frozenset({errno.EACCES, errno.EAGAIN, errno.EWOULDBLOCK, errno.EDEADLK})


def open_locked(path: Path) -> IO[bytes]:
    """Open a file to append to it, for this run alone; it is made if it is not there.

    Returns
    -------
    file
        Unbuffered; the lock ends when it is closed.

    Raises
    ------
    OutputError
        Another run has it, or it cannot be written.
    """
    try:
        # Not inherited by programs that the run starts, which may outlive it.
        file = open_own(path, "ab", buffering=0)
    except OSError as wrong:
        raise OutputError(f"folder {path.parent}: cannot write {path.name} ({wrong.strerror})") from wrong
    try:
        _lock(file.fileno())
    except OSError as wrong:
        if wrong.errno in _HELD:
            file.close()
            raise OutputError(
                f"folder {path.parent}: another run is at work in it; wait until it has ended or choose "
                "another folder"
            ) from wrong
    return file
