"""The environment of programs that results are compared with, whose numpy must not meet QGIS's."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[2]
_PYTHON = _ROOT / ".venv" / "peers" / "bin" / "python"
BENCHMARKS = _ROOT / "benchmarks"


def told_by_peers(*arguments: str | os.PathLike[str]) -> str:
    """Run Python with arguments in the environment that the set-up of the tests makes; return what it prints."""
    if not _PYTHON.is_file():
        if os.environ.get("CI") == "true":
            pytest.fail(f"{_PYTHON} is not there")
        pytest.skip(f"{_PYTHON} is not there; tools/setup.sh makes it")
    return _told(_PYTHON, *arguments)


def told_by_benchmark(name: str, *arguments: str | os.PathLike[str]) -> str:
    """Run a script of the folder ``benchmarks`` in this environment; return what it prints."""
    return _told(sys.executable, BENCHMARKS / name, *arguments)


def _told(*command: str | os.PathLike[str]) -> str:
    run = subprocess.run(command, check=False, capture_output=True, text=True, timeout=1200)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout
