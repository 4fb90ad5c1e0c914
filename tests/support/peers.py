"""The environment of programs that results are compared with, whose numpy must not meet QGIS's."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

_PYTHON = Path(__file__).parents[2] / ".venv" / "peers" / "bin" / "python"


def told_by_peers(*arguments: str | os.PathLike[str]) -> str:
    """Run Python with arguments in the environment that the set-up of the tests makes; return what it prints."""
    if not _PYTHON.is_file():
        if os.environ.get("CI") == "true":
            pytest.fail(f"{_PYTHON} is not there")
        pytest.skip(f"{_PYTHON} is not there; tools/setup.sh makes it")
    run = subprocess.run([_PYTHON, *arguments], check=False, capture_output=True, text=True, timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout
