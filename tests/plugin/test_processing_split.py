"""The algorithm that splits a dataset, in the real application."""

from __future__ import annotations

import json

import numpy as np
import pytest
from qgis.core import QgsProcessingException, QgsProcessingFeedback
from terrainav.core.dataset.labels import Labels
from terrainav.core.dataset.table import Table, image_parts

from tests.core.dataset.grounds import dataset_of


class Feedback(QgsProcessingFeedback):
    """Keeps what it is told."""

    def __init__(self):
        super().__init__(False)
        self.lines, self.warnings = [], []

    def pushInfo(self, text):
        self.lines.append(text)

    def pushWarning(self, text):
        self.warnings.append(text)


@pytest.fixture
def dataset(plugin, tmp_path):
    """Folder of 40 images on a row that crosses from one UTM zone into the next."""
    border_px = round(((-90.0 + 180.0) / 360.0) * 256 * 2**19)
    return dataset_of(tmp_path / "out", 19, [(border_px + 10 * (i - 25), 53_000_000, 10, 10) for i in range(40)])


def run(feedback=None, **parameters):
    import processing

    return processing.run("terrainav:split", parameters, feedback=feedback or Feedback())


def parts_in(folder):
    return image_parts(Table.load(folder / "satellite" / "meta_data.csv"))


@pytest.mark.parametrize("options", [{}, {"HOW": "in-order"}, {"HOW": "blocks", "BLOCK": 8.0, "GAP": 1.0}])
def test_split_writes_tables_and_labels_and_tells_the_shares(dataset, options):
    feedback = Feedback()
    found = run(feedback, DATASET=str(dataset), **options)
    parts = parts_in(dataset)
    names = ("train", "validation", "test", "gap")
    counts = [parts.count(name) for name in names]
    assert [found[f"{name.upper()}_IMAGES"] for name in names] == counts
    assert sum(counts) == 40
    assert (counts[3] > 0) == ("BLOCK" in options)
    assert f"Training: {counts[0]} images ({100 * counts[0] / sum(counts[:3]):.1f} %)." in feedback.lines
    assert any("2 UTM zones (15N, 16N)" in line and "EPSG:32615" in line for line in feedback.warnings)
    labels = Labels.load(dataset / "labels.json")
    assert Labels.from_json(found["LABELS"]) == labels
    assert np.isfinite(labels.scaler.mean).all()
    assert json.loads(found["LABELS"])["images"] == counts[0]


def test_split_that_cannot_be_made_is_told_in_a_line_and_changes_nothing(dataset):
    path = dataset / "satellite" / "meta_data.csv"
    before = path.read_bytes()
    with pytest.raises(QgsProcessingException, match=r"add up to 1\.1; must add up to 1"):
        run(DATASET=str(dataset), TRAIN=0.9)
    told = run(DATASET=str(dataset), DRY_RUN=True)
    assert told["TRAIN_IMAGES"] == 32
    assert path.read_bytes() == before
    assert not (dataset / "labels.json").exists()


def export(**parameters):
    import processing

    return processing.run("terrainav:export", parameters, feedback=Feedback())


def test_export_writes_beside_the_tables_unless_a_folder_is_named(dataset, tmp_path):
    found = export(DATASET=str(dataset), FORMAT="croissant")
    assert (found["FOLDER"], found["COUNT"]) == (str(dataset), 1)
    described = json.loads((dataset / "croissant.json").read_text())
    assert len(described["recordSet"]) == 1
    with pytest.raises(QgsProcessingException, match="needs the folder to write to"):
        export(DATASET=str(dataset), FORMAT="nerfstudio")


def test_export_of_map_frames_as_a_model_is_refused_in_one_line(dataset, tmp_path):
    with pytest.raises(QgsProcessingException, match=r"has no mission\.json"):
        export(DATASET=str(dataset), FORMAT="colmap", FOLDER=str(tmp_path / "model"))


def test_a_split_is_undone(dataset):
    feedback = Feedback()
    run(feedback, DATASET=str(dataset))
    assert "TRAIN_IMAGES" not in run(feedback, DATASET=str(dataset), UNDO=True)
    assert feedback.lines[-2] == "The split is undone: the images are in no part, and there are no labels."
    assert parts_in(dataset) is None
    run(feedback, DATASET=str(dataset), UNDO=True)
    assert feedback.lines[-2] == "Nothing to undo: the dataset is not split."
