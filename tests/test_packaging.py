"""The repository is at once a Python package and a QGIS plugin; both descriptions agree with what is there."""

from __future__ import annotations

import configparser
import importlib.metadata
import importlib.util
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PYPROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")

REQUIRED_BY_QGIS = (
    "name qgisMinimumVersion qgisMaximumVersion description about version author email tracker repository homepage "
    "category tags icon changelog license hasProcessingProvider experimental"
).split()


@pytest.fixture(scope="module")
def metadata():
    parser = configparser.ConfigParser(interpolation=None)
    parser.optionxform = str
    parser.read(ROOT / "metadata.txt", encoding="utf-8")
    return parser["general"]


@pytest.fixture(scope="module")
def wheel_names(tmp_path_factory):
    """Build the wheel of a copy of the tree, with the setuptools at hand and without network; list its files."""
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "a clone-1.0"
    source.mkdir()
    for name in ("pyproject.toml", "metadata.txt", "__init__.py", "LICENSE", "README.md"):
        shutil.copy(ROOT / name, source)
    for name in ("core", "resources", "terrainav_plugin"):
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for stray in (".venv/lib", "demo", "tests", "terrainav/core"):
        (source / stray).mkdir(parents=True)
        (source / stray / "stray.py").touch()
        (source / stray / "__init__.py").touch()
    build = [sys.executable, "-m", "pip", "--isolated", "wheel", "--quiet", "--no-index", "--no-deps"]
    subprocess.run([*build, "--no-build-isolation", "--wheel-dir", str(folder), str(source)], check=True)
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        return [name for name in archive.namelist() if ".dist-info/" not in name]


def listed_packages():
    block = re.search(r"^packages = \[(.*?)\]", PYPROJECT, re.DOTALL | re.MULTILINE)
    return set(re.findall(r'"([^"]+)"', block.group(1)))


def packages_on_disk():
    folders = [path.parent for top in ("core", "terrainav_plugin") for path in (ROOT / top).rglob("__init__.py")]
    return {"terrainav"} | {".".join(["terrainav", *folder.relative_to(ROOT).parts]) for folder in folders}


def test_every_package_is_listed():
    assert listed_packages() == packages_on_disk()


def test_no_module_lies_outside_a_package():
    folders = {path.parent for top in ("core", "terrainav_plugin") for path in (ROOT / top).rglob("*.py")}
    assert [folder for folder in sorted(folders) if not (folder / "__init__.py").exists()] == []


def test_versions_agree(metadata):
    (version,) = re.findall(r'^version = "(.+)"', PYPROJECT, re.MULTILINE)
    assert metadata["version"] == version
    assert importlib.metadata.version("terrainav") == version


def test_changelog_tells_of_this_version(metadata):
    assert metadata["changelog"].strip().startswith(metadata["version"])


def test_plugin_metadata_is_complete(metadata):
    assert [key for key in REQUIRED_BY_QGIS if not metadata.get(key)] == []
    assert metadata["qgisMinimumVersion"] == "3.22"
    assert metadata["qgisMaximumVersion"] == "4.99"
    assert metadata["category"] == "Raster"
    assert (ROOT / metadata["icon"]).is_file()
    for key in ("homepage", "repository", "tracker"):
        assert metadata[key].startswith("https://")


def test_processing_provider_is_announced_when_there_is_one(metadata):
    code = (ROOT / "terrainav_plugin" / "plugin.py").read_text(encoding="utf-8")
    assert metadata["hasProcessingProvider"] == ("yes" if "initProcessing" in code else "no")


def test_licence_is_there():
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert "GNU GENERAL PUBLIC LICENSE" in text
    assert "Version 2, June 1991" in text


def test_wheel_holds_all_that_is_needed(wheel_names):
    files = [path for path in (ROOT / "resources").rglob("*") if path.is_file()]
    files += [path for top in ("core", "terrainav_plugin") for path in (ROOT / top).rglob("*.py")]
    files += [ROOT / name for name in ("__init__.py", "metadata.txt", "core/py.typed")]
    wanted = {f"terrainav/{path.relative_to(ROOT).as_posix()}" for path in files}
    assert wanted - set(wheel_names) == set()


def test_wheel_holds_nothing_else(wheel_names):
    rooms = ("terrainav/core/", "terrainav/resources/", "terrainav/terrainav_plugin/")
    own = {"terrainav/__init__.py", "terrainav/metadata.txt"}
    assert [name for name in wheel_names if not name.startswith(rooms) and name not in own] == []


def test_root_package_is_imported_under_its_own_name_only(request):
    packages = [node for node in request.node.listchain() if isinstance(node, pytest.Package)]
    assert packages == []
    assert Path(importlib.util.find_spec("terrainav").origin).resolve() == ROOT / "__init__.py"
