"""How long commands take to start, beside Python with numpy alone.

    python benchmarks/command_start.py              # writes docs/command_start.md

Whole processes run in turn, with compiled modules and files in the page cache, as on a user's second start. Processor
time is that of the process until it ends or, for a capture, until it opens its first connection.
"""

from __future__ import annotations

import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from terrainav.core.report.machine import machine

RESULT = Path(__file__).resolve().parents[1] / "docs" / "command_start.md"
ROUNDS = 15
PLACE = ("--coords", "46.2_-122.2_120")
_COMMAND = "import sys; from terrainav.core.cli import main; sys.exit(main())"


class Start(NamedTuple):
    """A start of a process: processor time and time that passed, in seconds."""

    processor_s: float
    passed_s: float


def run(code: str, arguments: tuple[str, ...], folder: Path, listener: socket.socket | None = None) -> Start:
    """Run a process to its end or, with a listener, until it connects there."""
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(folder / "compiled"), "OMP_NUM_THREADS": "1"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    began_s = time.monotonic()
    process = subprocess.Popen(
        [sys.executable, "-c", code, *arguments], cwd=folder, env=environment, stdout=subprocess.DEVNULL
    )
    if listener is not None:
        connection, _ = listener.accept()
        process.kill()
        connection.close()
    _, status, used = os.wait4(process.pid, 0)
    passed_s = time.monotonic() - began_s
    if listener is None and status != 0:
        raise SystemExit(f"{' '.join(arguments)}: ended with status {status}")
    process.returncode = status
    return Start(used.ru_utime + used.ru_stime, passed_s)


def measure(folder: Path) -> dict[str, list[Start]]:
    """Starts of every command, in turn."""
    found: dict[str, list[Start]] = {}
    for number in range(ROUNDS + 1):
        # A listener for each round, as a capture opens several connections.
        with socket.create_server(("127.0.0.1", 0)) as listener:
            listener.settimeout(60.0)
            tiles = f"http://127.0.0.1:{listener.getsockname()[1]}/{{z}}/{{x}}/{{y}}.jpg"
            capture = ("capture", *PLACE, "--no-cache", "--source", tiles, "--data-dir", f"out-{number}")
            each = {
                "Python with numpy": run("import numpy", (), folder),
                "`terrainav --version`": run(_COMMAND, ("--version",), folder),
                "`terrainav plan --help`": run(_COMMAND, ("plan", "--help"), folder),
                "`terrainav plan` of one image": run(_COMMAND, ("plan", *PLACE), folder),
                "`terrainav capture` until its first request": run(_COMMAND, capture, folder, listener),
            }
        # The first round compiles the modules.
        if number:
            for name, start in each.items():
                found.setdefault(name, []).append(start)
    return found


def page(found: dict[str, list[Start]]) -> str:
    """The page of the figures."""
    numpy, *_ = found.values()
    lines = [
        "# How long commands take to start",
        "",
        f"Written by `python benchmarks/command_start.py`: medians of {ROUNDS} rounds of whole processes in turn, with",
        "compiled modules. Ratios are of processor time, within each round, to a Python that only imports numpy.",
        "",
        "| process | processor time, s | passed, s | ratio |",
        "| --- | ---: | ---: | ---: |",
    ]
    for name, starts in found.items():
        processor_s, passed_s = (statistics.median(values) for values in zip(*starts))
        ratio = statistics.median(own.processor_s / its.processor_s for own, its in zip(starts, numpy))
        lines.append(f"| {name} | {processor_s:.2f} | {passed_s:.2f} | {ratio:.2f} |")
    facts = [f"- {name}: {value}" for name, value in machine()]
    return "\n".join([*lines, "", *facts, f"- load average: {os.getloadavg()[0]:.1f}", ""])


def main() -> None:
    """Measure, and write the page."""
    with tempfile.TemporaryDirectory(prefix="terrainav-start-") as folder:
        text = page(measure(Path(folder)))
    RESULT.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
