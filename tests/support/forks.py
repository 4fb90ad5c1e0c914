"""Captures in processes that can be killed, limited, or run with the rights of an ordinary user.

A process that has imported everything forks one child for each run, so that a run takes only the time of the capture.
The process reads one request a line from its input and answers each with one line; both are JSON.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import signal
import subprocess
import sys
import time
import traceback
from pathlib import Path

ROOT = Path(__file__).parents[2]
# Longest time that a run may take, far longer than any does.
NEVER_S = 60.0
# Longest time that processes started by a killed run may stay.
ORPHANS_S = 5.0
KILLED = -signal.SIGKILL
_FILE_EVENTS = ("open", "os.rename", "os.mkdir", "os.remove", "os.rmdir")


class Driver:
    """Forks captures while its context is open.

    Parameters
    ----------
    environment : mapping
        Variables added to the environment of the runs.
    """

    def __init__(self, environment=()):
        self._environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", **dict(environment)}

    def __enter__(self):
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.support.forks"],
            cwd=ROOT,
            env=self._environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self._process.stdout.readline() == "ready\n"
        return self

    def __exit__(self, *_):
        self._process.stdin.close()
        self._process.stdout.close()
        self._process.wait()

    def run(self, **request):
        """Run a capture; returns its outcome.

        Parameters
        ----------
        mission : str
            JSON of the mission, captured from a source whose pixels hold their position; or
        argv : list of str
            Arguments of the command. ``debug`` logs everything, ``hasty`` waits briefly and tries once.
        folder : str
            Folder of the dataset, for ``mission`` and ``kill_at_event``.
        environment : mapping
            Variables added to the driver's environment for this run.
        output : str
            File for what the run prints.
        kill_after_s : float
            Time after which the run is killed.
        kill_at_event : int
            Number, from 0, of the change to the folder before which the run is killed.
        wait_s, connections, workers
            Options of the source and the capture.
        largest_file_bytes : int
            RLIMIT_FSIZE.
        obeys_permissions : bool
            Whether a run of root obeys permissions like an ordinary user.
        closes_after : int
            Number of fetched parts after which the folder becomes read-only.

        Returns
        -------
        dict
            ``code`` (negative: the signal), ``seconds``, ``orphans`` (whether processes of the run stayed), ``events``
            (changes to the folder, of a run that ended by itself), ``error`` (of a capture that raised).
        """
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())


def _main():
    # Import everything that a run needs.
    import resource  # noqa: F401

    import PIL.Image  # noqa: F401
    import terrainav.core.cli.datasets
    import terrainav.core.cli.flying
    import terrainav.core.cli.options
    import terrainav.core.cli.stopping
    import terrainav.core.dataset.clean
    import terrainav.core.imagery.xyz
    import terrainav.core.world
    from terrainav.core.capture import runner  # noqa: F401
    from terrainav.core.picture import cost  # noqa: F401

    import tests.support.sources  # noqa: F401

    with contextlib.suppress(ImportError):
        import terrainav.core.imagery.cache.tile_cache  # noqa: F401
    print("ready", flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        read_end, write_end = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(read_end)
            _child(request, write_end)
        os.close(write_end)
        print(json.dumps(_watch(child, read_end, request)), flush=True)


def _watch(child, read_end, request):
    with contextlib.suppress(OSError):
        os.setpgid(child, child)
    began = time.monotonic()
    status = 0
    if request.get("kill_after_s") is None:
        _, status = os.waitpid(child, 0)
    else:
        time.sleep(request["kill_after_s"])
        os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    seconds = time.monotonic() - began
    deadline = time.monotonic() + ORPHANS_S
    while (orphans := _signal_group(child, 0)) and time.monotonic() < deadline:
        time.sleep(0.002)
    _signal_group(child, signal.SIGKILL)
    with os.fdopen(read_end) as pipe:
        text = pipe.read()
    code = -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
    return {"code": code, "seconds": seconds, "orphans": orphans, **(json.loads(text) if text else {})}


def _signal_group(group, number):
    """Signal the processes of a group; returns whether there are any."""
    try:
        os.killpg(group, number)
    except ProcessLookupError:
        return False
    return True


def _child(request, write_end):
    """Run a capture and end the process."""
    code, outcome = 70, {}
    try:
        with contextlib.suppress(OSError):
            os.setpgid(0, 0)
        output = os.open(request.get("output", os.devnull), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        null = os.open(os.devnull, os.O_RDONLY)
        for old, new in ((null, 0), (output, 1), (output, 2)):
            os.dup2(old, new)
        signal.alarm(int(NEVER_S))
        code = _run(request, outcome)
    except SystemExit as wrong:
        code = wrong.code
    except BaseException:  # noqa: BLE001 (the process ends here)
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os.write(write_end, json.dumps(outcome).encode())
        # End without the parent's clean-up.
        os._exit(code)


def _run(request, outcome):
    from terrainav.core.capture.runner import capture
    from terrainav.core.cli import main
    from terrainav.core.errors import TerrAInavError
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    from tests.support.sources import PatternSource

    os.environ.update(request.get("environment", {}))
    if request.get("argv"):
        if request.get("folder"):
            _kill_at(request["folder"], request.get("kill_at_event"), outcome)
        if request.get("debug"):
            logging.basicConfig(level=logging.DEBUG)
        if request.get("hasty"):
            _hurry()
        return main(request["argv"])
    source = PatternSource(wait_s=request.get("wait_s", 0.0))
    worked_out = plan(Mission.from_json(request["mission"]), source.grid)
    folder = request["folder"]
    _kill_at(folder, request.get("kill_at_event"), outcome)
    _limit(request)
    if request.get("closes_after") is not None:
        source.paint = _closing(source, folder, request["closes_after"])
    try:
        result = capture(
            worked_out,
            source,
            folder,
            connections=request.get("connections", 2),
            workers=request.get("workers", 2),
            resume=True,
        )
    except TerrAInavError as wrong:
        outcome["error"] = str(wrong)
        return 3
    outcome.update(written=result.written, skipped=result.skipped, failed=len(result.failed))
    return 0


def _hurry():
    """Try every request only once, and with short timeouts."""
    from terrainav.core.imagery.http import client, requests_transport, transport

    client.Client.__init__.__kwdefaults__["tries"] = 1
    transport.Timeouts.__new__.__defaults__ = soon = (5.0, 0.3, 0.6)
    ours = requests_transport.RequestsTransport
    ours.__init__.__defaults__ = tuple(
        transport.Timeouts(*soon) if isinstance(value, transport.Timeouts) else value
        for value in ours.__init__.__defaults__
    )


def _kill_at(folder, at, outcome):
    """Count changes to the folder, and end the process before one of them."""
    outcome["events"] = 0

    def hook(event, arguments):
        if event not in _FILE_EVENTS or not str(arguments[0]).startswith(folder):
            return
        if event == "open" and not (isinstance(arguments[1], str) and set(arguments[1]) & set("wax+")):
            return
        if outcome["events"] == at:
            os.kill(os.getpid(), signal.SIGKILL)
        outcome["events"] += 1

    sys.addaudithook(hook)


def _limit(request):
    import resource

    from tests.support.rights import obey_permissions

    if request.get("largest_file_bytes") is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (request["largest_file_bytes"],) * 2)
    if request.get("obeys_permissions"):
        obey_permissions()


def _closing(source, folder, after):
    """Return the source's painter, which also makes the folder read-only after a number of parts."""
    paint = source.paint

    def closing(map_type, part):
        if sum(source.fetched.values()) >= after:
            for path in (Path(folder), *(path for path in Path(folder).iterdir() if path.is_dir())):
                path.chmod(0o555)
        return paint(map_type, part)

    return closing


if __name__ == "__main__":
    _main()
