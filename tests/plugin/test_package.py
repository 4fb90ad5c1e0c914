"""The zip that people install: built from the files as they are, and used in a QGIS that has nothing else of ours."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ROOT / ".venv" / "bin" / "python"
SCRIPT = ROOT / "tests" / "support" / "zip_capture.py"
LIMIT_S = 300


def run(*arguments):
    """Output and errors of one of the project's tools."""
    ran = subprocess.run(
        [str(PYTHON), *map(str, arguments)], capture_output=True, text=True, timeout=2 * LIMIT_S, check=False
    )
    assert ran.returncode == 0, ran.stdout[-3000:] + ran.stderr[-3000:]
    return ran.stdout


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    folder = tmp_path_factory.mktemp("package")
    run(ROOT / "tools" / "translations.py", "compile")
    # Bandit and detect-secrets search it in `make lint`.
    run(ROOT / "tools" / "package.py", "--working-tree", "--unsearched", "--folder", folder)
    (made,) = folder.glob("*.zip")
    return made


@pytest.mark.any_qgis
def test_zip_holds_the_plugin_and_nothing_else(archive):
    with zipfile.ZipFile(archive) as whole:
        names = [name for name in whole.namelist() if not name.endswith("/")]
    assert {name.split("/")[0] for name in names} == {"terrainav"}
    shipped = {"core", "docs", "resources", "terrainav_plugin"}
    files = {"__init__.py", "CHANGELOG.md", "LICENSE", "README.md", "metadata.txt"}
    assert {name.split("/")[1] for name in names} == shipped | files
    for needed in (
        "docs/guide.md",
        "resources/i18n/terrainav_es.qm",
        "core/cli/__main__.py",
        "resources/icon.svg",
    ):
        assert f"terrainav/{needed}" in names
    assert not [name for name in names if name.endswith((".pyc", ".ts~")) or "/tests/" in name]


def test_installed_from_the_zip_it_captures(archive, tmp_path):
    dataset = tmp_path / "dataset"
    run(ROOT / "tools" / "qgis_app.py", "--bare", "--timeout", LIMIT_S, SCRIPT, archive, dataset)
    rows = (dataset / "satellite" / "meta_data.csv").read_text().splitlines()[1:]
    pictures = list((dataset / "satellite").glob("*.tif"))
    assert len(rows) == len(pictures) > 3
