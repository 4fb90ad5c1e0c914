"""A capture in a separate process that waits for files: ``python -m tests.support.overtaken KIND PLACE SIGNALS``.

It creates the file ``asked`` when it first needs imagery, and continues once ``go`` exists. KIND is the file system:
``flock`` an ordinary one, ``no-locks`` one without locks, and ``lost`` one that loses a lock without notice, like that
of a file server after a restart. With ``-blocks`` the capture is in blocks.
"""

from __future__ import annotations

import errno
import fcntl
import sys
import time
from pathlib import Path

from terrainav.core.capture import holding
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.errors import TerrAInavError
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.storage.stores import is_address

from tests.support.sources import NamedPattern, PatternSource

MISSION = Mission(Box(35.142, -89.867, 35.140, -89.864), 120.0, max_px=100)
PATIENCE_S = 120.0


class Waiting(PatternSource):
    """A source that answers once the file ``go`` exists."""

    def paint(self, map_type, part):
        signals = Path(sys.argv[3])
        (signals / "asked").touch()
        until_s = time.monotonic() + PATIENCE_S
        while not (signals / "go").exists() and time.monotonic() < until_s:
            time.sleep(0.01)
        return super().paint(map_type, part)


def main() -> int:
    """Capture; returns 3, as the command does, if the capture is refused."""
    kind, place, _ = sys.argv[1:]
    # A stopped process soon counts as dead; a process that only waits on a busy machine does not.
    holding.BEAT_S, holding.DEAD_S = 0.05, 10.0 if is_address(place) else 4.0
    if not kind.startswith("flock"):
        fcntl.flock = _no_locks if kind.startswith("no-locks") else _lost_locks()
    blocks = Blocks(2) if kind.endswith("-blocks") else None
    source = NamedPattern(opens=Waiting) if blocks else Waiting()
    try:
        result = capture(plan(MISSION, source.grid), source, place, resume=True, blocks=blocks, workers=1)
    except TerrAInavError as wrong:
        print(wrong, file=sys.stderr)
        return 3
    print(f"{result.written} written, {len(result.failed)} failed")
    return 0


def _no_locks(_file, _how):
    raise OSError(errno.ENOLCK, "No locks available")


def _lost_locks():
    """Return a lock function that works only within this process: others can take the locks, too."""
    held = {}

    def path_of(file):
        return Path(f"/proc/self/fd/{file}").resolve()

    def flock(file, how):
        path = path_of(file)
        if how & fcntl.LOCK_UN:
            held.pop(path)
            return
        # A file that was closed no longer holds its lock.
        if held.get(path, file) != file and path_of(held[path]) == path:
            raise OSError(errno.EAGAIN, "held")
        held[path] = file

    return flock


if __name__ == "__main__":
    sys.exit(main())
