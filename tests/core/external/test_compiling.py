"""Code compiled by numba: when it is used, and why not."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys

import pytest
from terrainav.core.external import compiling

REPORT = (
    "import sys; from terrainav.core.external import compiling as c; print(c.code_in_use(), 'numba' in sys.modules)"
)


@pytest.fixture
def afresh():
    compiling.numba_problem.cache_clear()
    yield
    compiling.numba_problem.cache_clear()


def test_the_environment_switches_it_off():
    environment = {**os.environ, compiling.FAST: "0"}
    run = subprocess.run([sys.executable, "-c", REPORT], env=environment, capture_output=True, text=True, check=True)
    assert run.stdout.startswith("numpy (TERRAINAV_FAST is 0 in the environment); several times as fast with numba")
    assert run.stdout.endswith("False\n")


def test_without_numba_numpy_is_used(monkeypatch, afresh):
    monkeypatch.setattr(compiling, "find_spec", lambda name: None)
    assert not compiling.uses_numba()
    assert compiling.code_in_use().startswith("numpy (numba is not installed); ")


def test_numba_that_cannot_be_imported_is_not_used(monkeypatch, afresh):
    """Releases of numba refuse numpy that is newer than they know."""
    monkeypatch.setattr(compiling, "find_spec", lambda name: importlib.util.spec_from_loader(name, None))
    monkeypatch.setitem(sys.modules, "numba.core.registry", None)
    assert not compiling.uses_numba()
    assert "numba cannot be used: ModuleNotFoundError: " in compiling.code_in_use()


def test_what_is_compiled_need_not_be_kept(tmp_path):
    """Folders that cannot be written, as those of some installations, only cost the time to compile again."""
    if not compiling.uses_numba():
        pytest.skip("numba is not installed")
    (tmp_path / "sums.py").write_text(
        "from terrainav.core.external.compiling import compiled\n"
        "@compiled\n"
        "def total(values):\n"
        "    result = 0.0\n"
        "    for value in values:\n"
        "        result += value\n"
        "    return result\n"
    )
    environment = {**os.environ, "NUMBA_CACHE_DIR": os.devnull + "/none", "PYTHONPATH": str(tmp_path)}
    code = "import numpy, sums; print(sums.total(numpy.arange(4.0)))"
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (0, "6.0\n"), run.stderr


def test_what_an_earlier_release_has_kept_is_compiled_anew(tmp_path):
    """Kept code is found by its file and line; it may be for a class that has another name now."""
    if not compiling.uses_numba():
        pytest.skip("numba is not installed")
    source = (
        "import numpy\n"
        "from typing import NamedTuple\n"
        "from terrainav.core.external.compiling import compiled\n"
        "class {0}(NamedTuple):\n"
        "    values: object\n"
        "@compiled\n"
        "def first(given):\n"
        "    return given.values[0]\n"
        "print(first({0}(numpy.arange(2.0) + 1.0)), sum(first.stats.cache_hits.values()))\n"
    )
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kept"), "PYTHONPATH": str(tmp_path)}
    for name, hits in (("Pair", 0), ("Pair", 1), ("Other", 0), ("Other", 1)):
        (tmp_path / "pairs_of.py").write_text(source.format(name))
        command = [sys.executable, "-B", "-c", "import pairs_of"]
        run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert (run.returncode, run.stdout) == (0, f"1.0 {hits}\n"), run.stderr
