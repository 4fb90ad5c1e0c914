"""Libraries whose own settings are wrong: one line that says so, and no fault of the program."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest
from terrainav.core.external.importing import imported

ROOT = Path(__file__).resolve().parents[4]
#: Does what needs a library, and prints the line.
_PROGRAM = """
import sys
from terrainav.core.errors import OutputError
try:
    exec(sys.argv[1])
except OutputError as wrong:
    print(wrong)
"""


@pytest.mark.parametrize(
    ("library", "variable", "value", "code", "first"),
    [
        (
            "fsspec",
            "FSSPEC_CONFIG_DIR",
            ".",
            "from terrainav.core.storage.stores import store_path; store_path('s3://a/b')",
            "fsspec: cannot be imported (JSONDecodeError: ",
        ),
        (
            "distributed",
            "DASK_CONFIG",
            "bad.json",
            "from terrainav.core.capture.blocks.engines import open_engine; open_engine('local:1').__enter__()",
            "distributed: cannot be imported (",
        ),
        (
            "keras",
            "KERAS_BACKEND",
            "nonsense",
            "from terrainav.core.dataset.loading.keras_loader import KerasDataset; KerasDataset('.')",
            "keras: cannot be imported (ValueError: ",
        ),
        (
            "matplotlib",
            "MPLBACKEND",
            "nonsense",
            "from terrainav.core.external.drawing import check_matplotlib; check_matplotlib()",
            "matplotlib.figure: cannot be imported (",
        ),
    ],
)
def test_settings_of_a_library_that_are_wrong_are_told_in_one_line(tmp_path, library, variable, value, code, first):
    if importlib.util.find_spec(library) is None:
        pytest.skip(f"needs {library}")
    (tmp_path / "bad.json").write_text("{bad: [")
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM, code],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), variable: value},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    line, rest = done.stdout.split("\n", 1)
    assert (line[: len(first)], rest) == (first, "")
    assert line.endswith("); its settings, in a file or the environment, may be wrong")


def test_a_library_that_is_missing_is_told_by_who_needs_it():
    with pytest.raises(ImportError):
        imported("no_such_library")
