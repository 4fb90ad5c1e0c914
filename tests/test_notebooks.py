"""The notebooks of docs/notebooks: they run on a small dataset, come to what the library comes to, and show figures."""

from __future__ import annotations

import base64
import io
import json
import os
import re
import shutil
import sys
import tokenize
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.entropy import deciding_entropies, entropy, otsu
from terrainav.core.dataset.folder import DEFAULT_ENTROPY
from terrainav.core.dataset.labels import LABELS_FILE, Labels
from terrainav.core.dataset.loading import LabelledImages
from terrainav.core.dataset.split import split
from terrainav.core.dataset.table import REJECTED, image_parts
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

nbformat = pytest.importorskip("nbformat", reason="notebooks are read with it")
nbclient = pytest.importorskip("nbclient", reason="notebooks are executed with it")
pytest.importorskip("ipykernel", reason="notebooks are executed in its kernel")

NOTEBOOKS = Path(__file__).resolve().parent.parent / "docs" / "notebooks"
NAMES = ("datacleaner", "preprocess")
#: At the edge of a town, so that entropies lie on both sides of the threshold.
AREA = Box(35.141, -89.891, 35.1352, -89.882)
#: Seconds a cell may take; all together take a few.
TIMEOUT_S = 120
#: Least standard deviation of grey levels of a figure that shows something: an empty white one has 0.
LEAST_DRAWN = 5.0


def notebook_of(name):
    return nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)


@pytest.mark.parametrize("name", NAMES)
def test_notebooks_are_stored_without_outputs_and_traces_of_their_making(name):
    notebook = notebook_of(name)
    nbformat.validate(notebook)
    assert set(notebook.metadata) == {"kernelspec", "language_info"}
    assert notebook.metadata.language_info == {"name": "python"}
    for cell in notebook.cells:
        assert set(cell.metadata) <= {"tags"}
        if cell.cell_type == "code":
            assert cell.outputs == []
            assert cell.execution_count is None
    text = (NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8")
    assert not re.search(r"/home/|/root/|/tmp/|/work/|[A-Z]:\\\\", text)


@pytest.mark.parametrize("name", NAMES)
def test_links_of_notebooks_lead_to_files_that_are_there(name):
    words = "\n".join(cell.source for cell in notebook_of(name).cells if cell.cell_type == "markdown")
    targets = re.findall(r"\]\(([^)]+)\)", words)
    assert targets
    for target in targets:
        assert (NOTEBOOKS / target).is_file(), target


@pytest.mark.parametrize("name", NAMES)
def test_one_cell_has_the_parameters_and_the_folder_is_where_captures_are_written(name):
    (parameters,) = [cell for cell in notebook_of(name).cells if "parameters" in cell.metadata.get("tags", ())]
    assert parameters.cell_type == "code"
    strings = [
        token.string
        for token in tokenize.generate_tokens(io.StringIO(parameters.source).readline)
        if token.type == tokenize.STRING
    ]
    assert {'"TERRAINAV_DATA_DIR"', '"agricenter"'} <= set(strings)


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    """A dataset of both map types, which tests copy."""
    folder = tmp_path_factory.mktemp("captured") / "dataset"
    source = open_source("world")
    worked_out = plan(Mission(AREA, 120.0, map_types=("satellite", "roadmap"), image_px=320), source.grid)
    result = capture(worked_out, source, folder, connections=2)
    assert not result.failed
    return folder


@pytest.fixture
def execute(tmp_path, monkeypatch):
    """Execute a notebook in a kernel of this interpreter; returns what it shows, and values of its variables."""
    kernels = tmp_path / "jupyter" / "kernels" / "python3"
    kernels.mkdir(parents=True)
    arguments = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    spec = {"argv": arguments, "display_name": "Python 3", "language": "python"}
    (kernels / "kernel.json").write_text(json.dumps(spec), encoding="utf-8")
    for name in [name for name in os.environ if name.startswith(("TERRAINAV_", "JUPYTER_", "MPL"))]:
        monkeypatch.delenv(name)
    for name in (
        "JUPYTER_DATA_DIR",
        "JUPYTER_PATH",
        "JUPYTER_CONFIG_DIR",
        "JUPYTER_RUNTIME_DIR",
        "IPYTHONDIR",
        "MPLCONFIGDIR",
    ):
        monkeypatch.setenv(
            name, str(tmp_path / "jupyter" / ("" if name.endswith(("DATA_DIR", "_PATH")) else name.lower()))
        )
    # What is written to a home folder all the same is found there.
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    (tmp_path / "home").mkdir()
    (tmp_path / "run").mkdir()

    def run(name, folder, values, *, cells=None, **parameters):
        monkeypatch.setenv("TERRAINAV_DATA_DIR", str(folder))
        notebook = notebook_of(name)
        notebook.cells = [cell for cell in notebook.cells if cells is None or cell.id in cells]
        at = next(at for at, cell in enumerate(notebook.cells) if "parameters" in cell.metadata.get("tags", ()))
        changed = "\n".join(f"{name} = {value!r}" for name, value in parameters.items())
        notebook.cells.insert(at + 1, nbformat.v4.new_code_cell(changed))
        asked = ", ".join(f"{value!r}: {value}" for value in values)
        notebook.cells.append(nbformat.v4.new_code_cell(f"import json\nprint(json.dumps({{{asked}}}))"))
        resources = {"metadata": {"path": str(tmp_path / "run")}}
        nbclient.NotebookClient(notebook, timeout=TIMEOUT_S, kernel_name="python3", resources=resources).execute()
        assert list((tmp_path / "home").iterdir()) == []
        assert list((tmp_path / "run").iterdir()) == []
        outputs = [output for cell in notebook.cells[:-1] for output in cell.get("outputs", ())]
        assert [output.text for output in outputs if output.get("name") == "stderr"] == []
        (last,) = notebook.cells[-1].outputs
        return outputs, dict(zip(values, json.loads(last.text).values()))

    return run


def figures_in(outputs):
    """Pictures that a notebook shows, as arrays of grey levels."""
    shown = [output.data for output in outputs if output.output_type == "display_data"]
    assert all("image/png" in data for data in shown)
    pictures = [Image.open(io.BytesIO(base64.b64decode(data["image/png"]))).convert("L") for data in shown]
    return [np.asarray(picture, np.float64) for picture in pictures]


def printed(outputs):
    return "".join(output.text for output in outputs if output.output_type == "stream")


def bytes_of(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.thorough
def test_datacleaner_comes_to_what_clean_does_and_changes_nothing(execute, captured):
    before = bytes_of(captured)
    values = (
        "effects",
        "sample",
        "sample_entropies['roadmap'].tolist()",
        "sample_decisive.tolist()",
        "suggested",
        "first_kept",
    )
    outputs, found = execute("datacleaner", captured, values, SAMPLES=6)
    assert bytes_of(captured) == before

    pictures = figures_in(outputs)
    assert len(pictures) == 8
    assert all(picture.std() > LEAST_DRAWN for picture in pictures)

    deciding = deciding_entropies(captured)["satellite"].entropies
    rejected = {one.map_type: one.rejected for one in clean(captured, DEFAULT_ENTROPY, dry_run=True)}
    assert 0 < rejected["satellite"] < len(deciding)
    assert found["effects"][str(DEFAULT_ENTROPY)] == rejected["satellite"] == found["first_kept"]
    assert found["effects"] == {text: int((deciding < float(text)).sum()) for text in found["effects"]}
    assert found["suggested"] == otsu(deciding)

    roadmap = read_dataset(captured).image_set("roadmap")
    row_of = {Path(name).stem: row for row, name in enumerate(roadmap.table.img_names)}
    own = [entropy(roadmap.pixels(row_of[stem], 3)) for stem in found["sample"]]
    assert len(own) == 6
    assert found["sample_entropies['roadmap'].tolist()"] == own
    # The roadmap decides.
    assert found["sample_decisive.tolist()"] == pytest.approx(own, abs=1e-12)
    text = printed(outputs)
    assert re.search(rf"^satellite +\d+ images, +{rejected['satellite']} to be rejected", text, re.MULTILINE)
    assert "nothing was changed" in text


def test_datacleaner_writes_the_marks_when_it_is_told_to(execute, captured, tmp_path):
    by_notebook, by_library = tmp_path / "by_notebook", tmp_path / "by_library"
    for folder in (by_notebook, by_library):
        shutil.copytree(captured, folder)
    needed = ("parameters", "imports", "clean")
    outputs, _ = execute("datacleaner", by_notebook, (), cells=needed, WRITE=True, THRESHOLD=1.0)
    assert "marked in the tables" in printed(outputs)
    clean(by_library, 1.0)
    marks = read_dataset(by_notebook).image_set("satellite").table.other[REJECTED]
    assert any(marks)
    assert bytes_of(by_notebook) == bytes_of(by_library)


@pytest.mark.thorough
def test_preprocess_comes_to_what_split_and_loader_do(execute, captured, tmp_path):
    by_notebook, by_library = tmp_path / "by_notebook", tmp_path / "by_library"
    for folder in (by_notebook, by_library):
        shutil.copytree(captured, folder)
        clean(folder)
    values = (
        "parts.tolist()",
        "values.tolist()",
        "there_and_back_m",
        "targets.tolist()",
        "pixels.tolist()",
        "same",
        "other",
        "[len(one) for one in shown.values()]",
    )
    size = (32, 24, 3)
    outputs, found = execute("preprocess", by_notebook, values, IMG_SIZE=size, BATCH_SIZE=4, GAP_M=20.0)

    pictures = figures_in(outputs)
    assert len(pictures) == 4
    assert all(picture.std() > LEAST_DRAWN for picture in pictures)

    split(by_library, how="blocks", gap_m=20.0)
    assert bytes_of(by_notebook) == bytes_of(by_library)
    table = read_dataset(by_library).image_set("satellite").table
    assert tuple(found["parts.tolist()"]) == image_parts(table)
    assert {"train", "validation", "test", ""} <= set(found["parts.tolist()"])

    labels = Labels.load(by_library / LABELS_FILE)
    used = [row for row, mark in enumerate(table.other[REJECTED]) if not mark]
    assert np.array_equal(found["values.tolist()"], labels.transform(table.lat_deg[used], table.lon_deg[used]))
    # Labels are exact to 10 nm; the geodesic's own rounding is of that size.
    assert found["there_and_back_m"] < 2e-8

    samples = LabelledImages(by_library, part="train", img_size=size)
    images, targets = samples.take(samples.order()[:4])
    assert np.array_equal(np.float32(found["pixels.tolist()"]), images)
    assert np.array_equal(np.float32(found["targets.tolist()"]), targets)
    assert found["same"] is True
    assert found["other"] is True
    assert found["[len(one) for one in shown.values()]"] == [min(4, len(samples))] * 7
