"""Every Qt name that the plugin uses exists in Qt 6, too, and the panel works there: by the PyQt6 that is on PyPI.

QGIS 3.22 to 3.44 have Qt 5 and QGIS 4 has Qt 6. mypy resolves the plugin's names, and its attributes wherever the type
of a value is known, against PyQt6's stubs; QGIS's own names are not looked at. The panel is made and used on PyQt6
itself, with stand-ins for QGIS's widgets.
"""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image

from tests.support.trees import tree_of

ROOT = Path(__file__).resolve().parents[1]
PLUGIN = ROOT / "terrainav_plugin"
#: Where the set-up puts PyQt6.
PYQT6 = Path(sys.prefix) / "qt6" / "PyQt6"
MODULES = sorted(PLUGIN.rglob("*.py"))
#: Where old and new names stand beside each other.
COMPAT = PLUGIN / "compat.py"
SUBMODULES = ("QtCore", "QtGui", "QtNetwork", "QtPrintSupport", "QtSvg", "QtTest", "QtWidgets", "QtXml")
ANYTHING = "from typing import Any\ndef __getattr__(name: str) -> Any: ...\n"


def qt_imports(path: Path) -> Iterator[tuple[str, str, int]]:
    """Yield module below ``qgis.PyQt``, name and line of everything imported from there."""
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("qgis.PyQt"):
            yield from ((node.module[len("qgis.PyQt") :].lstrip("."), a.name, node.lineno) for a in node.names)


@pytest.fixture(scope="module")
def stubs() -> Path:
    if not (PYQT6 / "QtCore.pyi").is_file():
        pytest.fail(f"{PYQT6} is not there; run `make setup`")
    return PYQT6


@pytest.fixture(scope="module")
def settings(stubs: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Configuration of mypy that takes PyQt6 for ``qgis.PyQt``."""
    folder = tmp_path_factory.mktemp("qt6")
    shim = folder / "stubs" / "qgis"
    (shim / "PyQt").mkdir(parents=True)
    for name in SUBMODULES:
        (shim / "PyQt" / f"{name}.pyi").write_text(f"from PyQt6.{name} import *\n")
    (shim / "PyQt" / "__init__.pyi").write_text("from PyQt6 import sip as sip\n")
    for name in ("core", "gui", "utils", "analysis"):
        (shim / f"{name}.pyi").write_text(ANYTHING)
    (shim / "__init__.pyi").write_text("")
    (folder / "stubs" / "PyQt6").symlink_to(stubs, target_is_directory=True)
    path = folder / "mypy.ini"
    path.write_text(
        f"[mypy]\nmypy_path = {folder / 'stubs'}\ncache_dir = {folder / 'cache'}\nexplicit_package_bases = true\n"
        "check_untyped_defs = true\nfollow_imports = silent\nignore_missing_imports = true\n"
        "implicit_optional = true\nstrict_optional = false\n"
    )
    return path


def misuses(settings: Path, *paths: Path) -> list[str]:
    """Lines of mypy that tell of a name or attribute that is not there."""
    ran = subprocess.run(
        [
            sys.executable,
            "-m",
            "mypy",
            "--config-file",
            str(settings),
            "--no-error-summary",
            *map(str, paths),
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode in (0, 1), ran.stdout[-2000:] + ran.stderr
    return [line for line in ran.stdout.splitlines() if "[attr-defined]" in line or "[name-defined]" in line]


def test_imported_names_exist(stubs: Path) -> None:
    known: dict[str, set[str]] = {}
    for path in MODULES:
        for module, name, line in qt_imports(path):
            if path == COMPAT:
                continue
            if not module:
                assert name in (*SUBMODULES, "sip"), f"{path.relative_to(ROOT)}:{line}: {name}"
                continue
            if module not in known:
                # What stands at the beginning of a line: to parse them takes long.
                text = (stubs / f"{module}.pyi").read_text(encoding="utf-8")
                known[module] = set(re.findall(r"^(?:(?:class|def) )?(\w+)(?= *[(:=])", text, re.MULTILINE))
            assert name in known[module], f"{path.relative_to(ROOT)}:{line}: {name} is not in PyQt6.{module}"


def test_only_through_qgis() -> None:
    for path in MODULES:
        for node in ast.walk(tree_of(path)):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            assert not [name for name in names if name.split(".")[0] in ("PyQt5", "PyQt6", "sip")], path


def test_attributes_exist(settings: Path) -> None:
    compat = str(COMPAT.relative_to(ROOT))
    wrong = [
        line
        for line in misuses(settings, PLUGIN)
        if line.startswith("terrainav_plugin/") and not line.startswith(compat)
    ]
    assert not wrong, "\n".join(wrong)


def test_what_qt6_lacks_is_noticed(settings: Path, tmp_path: Path) -> None:
    sample = tmp_path / "sample.py"
    sample.write_text(
        "from qgis.PyQt.QtCore import Qt, QVariant\n"
        "from qgis.PyQt.QtWidgets import QAction, QDialog\n"
        "Qt.LeftButton\nQVariant.String\nQDialog().exec_()\nQt.MouseButton.LeftButton\nQDialog().exec()\n"
    )
    found = [line for line in misuses(settings, sample) if line.startswith(str(sample))]
    assert [line.split(":")[1] for line in found] == ["2", "3", "4", "5"]


def test_panel_works_on_qt6(stubs: Path, tmp_path: Path) -> None:
    """In a process without QGIS: made, typed into, filled, asked, pressed and painted."""
    picture = tmp_path / "panel.png"
    ran = subprocess.run(
        [sys.executable, str(ROOT / "tests" / "support" / "panel_on_qt6.py"), str(tmp_path), str(picture)],
        env={
            **os.environ,
            "PYTHONPATH": str(stubs.parent),
            "QT_QPA_PLATFORM": "offscreen",
            "HOME": str(tmp_path),
        },
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr[-3000:]
    assert ran.stdout.split("\n")[:4] == ["35.16", "True", "capture", "drawn"]
    with Image.open(picture) as shown:
        colours = shown.convert("RGB").getcolors(maxcolors=1 << 24)
    # Letters, frames and fields: not one flat colour.
    assert colours is not None
    assert len(colours) > 20
