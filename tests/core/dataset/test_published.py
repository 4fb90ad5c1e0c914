"""The paper's published folders, read and cleaned as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from terrainav.core.dataset.clean import clean, undo
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.entropy import entropy
from terrainav.core.dataset.folder import deciding_folder, map_type_name
from terrainav.core.dataset.table import REJECTED, Table
from terrainav.core.errors import InvalidInput

from tests.support.published import FLIGHT, write_published

#: Images of the roadmap with nothing to see.
BLANK = ((0, 1), (2, 0))


@pytest.fixture(params=[("", ""), ("", FLIGHT), ("_0", ""), ("_0.6", FLIGHT)], ids=str)
def memphis(request, tmp_path):
    """Folder, and the endings of the folders of its map types and of their images."""
    ending, images = request.param
    folder = tmp_path / "Memphis"
    write_published(folder / f"roadmap{ending}", images=images, blank=BLANK)
    write_published(folder / f"satellite{ending}", images=images)
    # The program keeps a picture of the whole area beside the table.
    Image.new("RGB", (9, 9)).save(folder / f"satellite{ending}" / "35.1375_-89.8615_0_120.0_78.8_4_4.jpg")
    return folder, ending, images


def _paths(names):
    return {name: Path("dataset") / name for name in names}


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_published_folders_are_read_by_map_type(memphis):
    folder, ending, images = memphis
    read = read_dataset(folder)
    assert set(read.image_sets) == {"satellite", "roadmap"}
    satellite = read.image_sets["satellite"]
    assert satellite.map_type == "satellite"
    assert satellite.folder == folder / f"satellite{ending}"
    table = satellite.table
    assert table.columns.tolist() == [0, 0, 1, 1, 2, 2]
    assert table.rows.tolist() == [0, 1, 0, 1, 0, 1]
    assert table.img_names[3] == "1_1_35.158935_-89.8982707_17.jpg"
    assert (table.lat_deg[3], table.lon_deg[3], table.zoom[3]) == (35.158935, -89.8982707, 17)
    assert table.entropies.tolist() == [7.5] * 6
    assert dict(table.other) == {}
    assert satellite.made.all()
    assert satellite.path(3) == folder / f"satellite{ending}" / images / table.img_names[3]
    assert satellite.pixels(3).shape == (48, 64, 3)


def test_the_roadmap_of_the_same_ending_decides(memphis):
    folder, ending, images = memphis
    before = files(folder)
    counted = {one.map_type: one for one in clean(folder, 2.1, move=True, dry_run=True)}
    assert files(folder) == before
    assert {name: (one.rejected, one.by_roadmap) for name, one in counted.items()} == {
        f"roadmap{ending}": (2, 0),
        f"satellite{ending}": (2, 6),
    }
    clean(folder, 2.1, move=True)
    for map_type in ("roadmap", "satellite"):
        place = folder / f"{map_type}{ending}" / images
        assert len(list(place.glob("?_?_*.jpg"))) == 4
        names = sorted(path.name for path in (place / "rejected").iterdir())
        assert [name[:3] for name in names] == ["0_1", "2_0"]
        marks = Table.load(folder / f"{map_type}{ending}" / "meta_data.csv").other[REJECTED]
        assert [bool(mark) for mark in marks] == [False, True, False, False, True, False]
    assert read_dataset(folder).image_sets["satellite"].pixels(1).shape == (48, 64, 3)

    undo(folder)
    after = files(folder)
    assert after.keys() == before.keys()
    assert not list(folder.rglob("rejected"))
    assert all(after[name] == before[name] for name in before if name.endswith(".jpg"))


def test_entropies_that_are_missing_are_worked_out(tmp_path):
    write_published(tmp_path / "roadmap_0", entropies=False, blank=BLANK)
    images = read_dataset(tmp_path).image_sets["roadmap"]
    assert np.isnan(images.table.entropies).all()
    (cleaned,) = clean(tmp_path, 2.1)
    assert (cleaned.images, cleaned.rejected) == (6, 2)
    assert entropy(images.pixels(1)) < 2.1 <= entropy(images.pixels(0))


def test_several_overlaps_are_told_apart_and_each_has_its_own_roadmap(tmp_path):
    write_published(tmp_path / "satellite_0")
    write_published(tmp_path / "roadmap_0", blank=BLANK)
    write_published(tmp_path / "satellite_0.6")
    write_published(tmp_path / "roadmap_0.6")
    read = read_dataset(tmp_path)
    assert set(read.image_sets) == {"satellite_0", "roadmap_0", "satellite_0.6", "roadmap_0.6"}
    assert read.image_set("satellite_0.6").map_type == "satellite"
    rejected = {one.map_type: one.rejected for one in clean(tmp_path, 2.1, dry_run=True)}
    assert rejected == {"satellite_0": 2, "roadmap_0": 2, "satellite_0.6": 0, "roadmap_0.6": 0}


def test_names_of_folders():
    assert [map_type_name(name) for name in ("satellite", "satellite_0", "roadmap_0.6", "my_map", "_0")] == [
        "satellite",
        "satellite",
        "roadmap",
        "my_map",
        "_0",
    ]
    assert deciding_folder("satellite_0", _paths(["roadmap", "roadmap_0", "satellite_0"])) == "roadmap_0"
    assert deciding_folder("satellite_0", _paths(["roadmap", "satellite_0"])) == "roadmap"
    assert deciding_folder("satellite_0", _paths(["roadmap_5", "satellite_0"])) is None
    assert deciding_folder("roadmap_0", _paths(["roadmap", "roadmap_0"])) is None


def test_one_map_type_alone_is_a_dataset_unless_its_roadmap_is_beside_it(tmp_path):
    write_published(tmp_path / "a" / "satellite_0")
    assert set(read_dataset(tmp_path / "a" / "satellite_0").image_sets) == {"satellite"}
    write_published(tmp_path / "a" / "roadmap_0")
    with pytest.raises(InvalidInput, match=r"is one map type of the dataset .*a; give that one"):
        read_dataset(tmp_path / "a" / "satellite_0")
    assert set(read_dataset(tmp_path / "a" / "roadmap_0").image_sets) == {"roadmap"}


def test_the_folder_of_images_is_the_one_that_the_table_is_about(tmp_path):
    folder = tmp_path / "satellite"
    write_published(folder, images="raster_images_35.2_-89.9_0_120.0_78.8_4_4", start=(35.2, -89.9))
    (folder / "meta_data.csv").unlink()
    names = write_published(folder, images=FLIGHT)
    assert read_dataset(tmp_path).image_sets["satellite"].image_folder == folder / FLIGHT
    for name in names:
        (folder / "raster_images_35.2_-89.9_0_120.0_78.8_4_4" / name).write_bytes(b"")
    with pytest.raises(InvalidInput, match=r"are in raster_images_35\.1375.* and in raster_images_35\.2.* as well"):
        read_dataset(tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (",0.0,1.0,", ",0.0,2.0,", "has another rows in its row"),
        ("35.158935,-89.9,", "35.158936,-89.9,", "has another Lat in its row"),
        ("35.158935,-89.9,", "35.158935,-89.91,", "has another Lon in its row"),
        ("-89.9,17.0,", "-89.9,18.0,", "has another Alt in its row"),
        (",0.0,1.0,", ",first,1.0,", "line 3 has columns 'first', not a number"),
        (",0.0,1.0,", ",0.5,1.0,", r"line 3 has columns '0\.5', not a whole number"),
        ("35.158935,-89.9,", ",-89.9,", "line 3 has Lat '', not a number"),
        (",row,", ",lines,", "has no column rows"),
    ],
)
def test_rows_that_say_otherwise_are_named(tmp_path, old, new, said):
    names = write_published(tmp_path / "satellite")
    path = tmp_path / "satellite" / "meta_data.csv"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InvalidInput, match=said) as caught:
        read_dataset(tmp_path)
    if "another" in said:
        assert names[0 if "Alt" in said else 1] in str(caught.value)


def test_a_table_shifted_against_its_names_is_told_by_the_first_three(tmp_path):
    names = write_published(tmp_path / "satellite", columns=6)
    path = tmp_path / "satellite" / "meta_data.csv"
    head, *rows = path.read_text().splitlines()
    cells = [row.split(",") for row in rows]
    shifted = [[*one[:2], *other[2:]] for one, other in zip(cells, [*cells[1:], cells[0]])]
    path.write_text("\n".join([head, *map(",".join, shifted)]) + "\n")
    with pytest.raises(InvalidInput) as caught:
        read_dataset(tmp_path)
    assert all(name in str(caught.value) for name in names[:3])
    assert names[3] not in str(caught.value)
    assert str(caught.value).endswith("; and 9 more")


def test_images_without_a_row_and_rows_without_an_image_are_named(tmp_path):
    names = write_published(tmp_path / "satellite", images=FLIGHT)
    lost = tmp_path / "satellite" / FLIGHT / names[4]
    lost.rename(lost.with_name("7_7_35.1_-89.9_17.jpg"))
    with pytest.raises(InvalidInput) as caught:
        read_dataset(tmp_path)
    assert f"{names[4]} of the table is not there" in str(caught.value)
    (lost.with_name(names[4])).write_bytes(b"")
    with pytest.raises(InvalidInput, match=r"7_7_35\.1_-89\.9_17\.jpg is not in the table"):
        read_dataset(tmp_path)
