"""The rooms of the core and the direction of its arrows, read from the source itself."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "core"
PLUGIN = ROOT / "terrainav_plugin"

FORBIDDEN = {"qgis", "PyQt4", "PyQt5", "PyQt6", "PySide2", "PySide6", "sip"}

# What may be missing on a machine where the command has to work, or is slow to import where it is not used.
ON_DEMAND = {
    "matplotlib",
    "rasterio",
    "osgeo",
    "scipy",
    "torch",
    "keras",
    "tensorflow",
    "dask",
    "pandas",
    "owslib",
}

ROOMS = ("geodesy", "mission", "imagery", "dataset", "capture", "report", "pairs")

# Room -> rooms it may import. What lies in `core` itself (errors, the shipped tables) knows no room and is
# open to all.
ARROWS = {
    "core": set(),
    "geodesy": {"core"},
    "mission": {"core", "geodesy"},
    "imagery": {"core", "geodesy"},
    "dataset": {"core", "geodesy"},
    "capture": {"core", "geodesy", "mission", "imagery", "dataset"},
    "report": {"core", "geodesy", "mission", "imagery", "dataset", "capture"},
    "pairs": {"core", "geodesy", "mission", "imagery", "dataset", "capture"},
    "cli": {"core", *ROOMS},
}

MODULES = sorted(CORE.rglob("*.py"))
PLUGIN_MODULES = sorted(PLUGIN.rglob("*.py"))


def module_name(path: Path) -> str:
    """Return ``terrainav.core.geodesy.camera`` for ``core/geodesy/camera.py``."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(["terrainav", *(parts[:-1] if parts[-1] == "__init__" else parts)])


def room(name: str) -> str:
    """Return the room of a module of the core."""
    inner = name.split(".")[2:]
    if inner and inner[0] in (*ROOMS, "cli"):
        return inner[0]
    return "core"


def imported(path: Path) -> Iterator[tuple[int, str]]:
    """Yield line and absolute name of everything that a file imports, lazy imports included."""
    package = module_name(path).split(".")
    if path.name != "__init__.py":
        package.pop()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            origin = ".".join([*base, *([node.module] if node.module else [])])
            # Whether `from a import b` names a module or something in it does not matter for the rooms.
            yield from ((node.lineno, f"{origin}.{alias.name}") for alias in node.names)


def identify(path: Path) -> str:
    return str(path.relative_to(ROOT))


def in_fresh_interpreter(code: str) -> list[str]:
    """Run `code` where nothing is imported yet; returns what it prints, split."""
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT.parent, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    return result.stdout.split()


def test_every_room_is_there():
    assert {path.name for path in CORE.iterdir() if (path / "__init__.py").exists()} >= set(ROOMS)


@pytest.mark.parametrize("path", MODULES, ids=identify)
def test_core_names_neither_qgis_nor_qt(path):
    wrong = [(line, name) for line, name in imported(path) if name.split(".")[0] in FORBIDDEN]
    assert wrong == []


@pytest.mark.parametrize("path", MODULES, ids=identify)
def test_arrows_point_one_way(path):
    here = room(module_name(path))
    wrong = []
    for line, name in imported(path):
        if not name.startswith("terrainav"):
            continue
        if not name.startswith("terrainav.core.") or room(name) not in ARROWS[here] | {here}:
            wrong.append((line, name))
    assert wrong == [], f"{here} may import from {sorted(ARROWS[here])} only"


@pytest.mark.parametrize("path", [*MODULES, *PLUGIN_MODULES], ids=identify)
def test_inside_the_package_imports_are_relative(path):
    absolute = [
        node.lineno
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if (
            isinstance(node, ast.ImportFrom)
            and not node.level
            and str(node.module).partition(".")[0] == "terrainav"
        )
        or (
            isinstance(node, ast.Import)
            and any(alias.name.partition(".")[0] == "terrainav" for alias in node.names)
        )
    ]
    assert absolute == []


def test_importing_all_of_core_loads_neither_qgis_nor_qt():
    names = [module_name(path) for path in MODULES if path.name != "__main__.py"]
    code = f"import importlib, sys\nfor name in {names!r}:\n    importlib.import_module(name)\nprint(*sys.modules)"
    loaded = in_fresh_interpreter(code)
    assert set(names) <= set(loaded)
    assert {name.partition(".")[0] for name in loaded} & FORBIDDEN == set()


def test_the_command_imports_nothing_that_it_may_not_need():
    loaded = in_fresh_interpreter("import sys, terrainav.core.cli\nprint(*sys.modules)")
    assert "terrainav.core.cli" in loaded
    assert {name.partition(".")[0] for name in loaded} & ON_DEMAND == set()


def test_importing_the_package_imports_nothing_else_of_it():
    loaded = in_fresh_interpreter("import sys, terrainav\nprint(*sys.modules)")
    assert [name for name in loaded if name.startswith("terrainav.")] == []
