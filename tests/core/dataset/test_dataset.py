"""Datasets of ours that are read: what is in them, and what of them is refused."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.sources import PatternSource

AREA = Box(35.16, -89.90, 35.1575, -89.8965)


@pytest.fixture(scope="module", params=["jpg", "tif", "png"])
def captured(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("captured") / "out"
    source = PatternSource(("satellite", "roadmap"))
    mission = Mission(AREA, 120.0, image_format=request.param, map_types=("satellite", "roadmap"))
    capture(plan(mission, source.grid), source, folder)
    return folder


@pytest.fixture
def dataset(tmp_path):
    source = PatternSource()
    mission = Mission(AREA, 120.0, image_format="png", map_types=("satellite",))
    capture(plan(mission, source.grid), source, tmp_path / "out")
    return tmp_path / "out"


def edit(folder, change):
    """Change the rows, as lists of cells, of a map type's table; the first are its headers."""
    path = folder / "meta_data.csv"
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    change(rows)
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(rows)


def test_every_map_type_and_pixel_is_read(captured):
    read = read_dataset(captured)
    assert (read.folder, read.layout, set(read.image_sets)) == (
        captured,
        "TerrAInav",
        {"satellite", "roadmap"},
    )
    for map_type, images in read.image_sets.items():
        assert images.map_type == map_type
        assert len(images) > 3
        assert images.made.all()
        for index, name in enumerate(images.table.img_names):
            path = captured / map_type / name
            assert images.path(index) == path
            with Image.open(path) as image:
                expected = np.asarray(image.convert("RGB"))
                grey = np.asarray(image.convert("RGB").convert("L"))
            np.testing.assert_array_equal(images.pixels(index), expected)
            np.testing.assert_array_equal(images.pixels(index, 1), grey)


def test_a_map_type_that_is_not_there(captured):
    with pytest.raises(InvalidInput, match=r"map type 'terrain': .* has roadmap, satellite"):
        read_dataset(captured).image_set("terrain")


def test_images_that_cleaning_has_moved_are_read(dataset):
    before = read_dataset(dataset).image_sets["satellite"]
    pixels = [before.pixels(index) for index in range(len(before))]
    clean(dataset, 8.0, move=True)
    after = read_dataset(dataset).image_sets["satellite"]
    assert {after.path(index).parent.name for index in range(len(after))} == {"rejected"}
    for index, expected in enumerate(pixels):
        np.testing.assert_array_equal(after.pixels(index), expected)


def test_rows_that_failed_have_no_image(dataset):
    folder = dataset / "satellite"

    def fail(rows):
        rows[2][rows[0].index("status")] = "failed"

    edit(folder, fail)
    lost = read_dataset(dataset).image_sets["satellite"].path(1)
    lost.unlink()
    images = read_dataset(dataset).image_sets["satellite"]
    assert np.flatnonzero(~images.made).tolist() == [1]
    with pytest.raises(InvalidInput, match=lost.name.replace(".", r"\.")):
        images.pixels(1)


def test_a_masked_image_has_three_channels_and_a_grey_one_none(dataset):
    images = read_dataset(dataset).image_sets["satellite"]
    width, height = int(images.table.image_width_px[0]), int(images.table.image_height_px[0])
    for mode, shape in (("RGBA", (height, width, 3)), ("LA", (height, width)), ("L", (height, width))):
        Image.new(mode, (width, height)).save(images.path(0))
        assert images.pixels(0).shape == shape
        assert images.pixels(0, 3).shape == (height, width, 3)
    with pytest.raises(InvalidInput, match="channels 4: must be 1 or 3"):
        images.pixels(0, 4)


@pytest.mark.parametrize("count", [1, 3, 5])
def test_missing_and_unknown_images_are_named(dataset, count):
    images = read_dataset(dataset).image_sets["satellite"]
    found = [images.path(index) for index in range(len(images))]
    for path in found[:count]:
        path.rename(path.with_name("9" + path.name))
    with pytest.raises(InvalidInput) as caught:
        read_dataset(dataset)
    named = ", ".join(path.name for path in found[: min(count, 3)])
    more = f" and {count - 3} more" if count > 3 else ""
    verb = "is" if count == 1 else "are"
    assert f"satellite: {named}{more} of the table {verb} not there" in str(caught.value)

    for path in found[:count]:
        path.with_name("9" + path.name).rename(path)
    extra = sorted(path.with_name("9" + path.name) for path in found[:count])
    for path in extra:
        path.write_bytes(b"")
    with pytest.raises(InvalidInput, match=f"{more} {verb} not in the table") as caught:
        read_dataset(dataset)
    assert ", ".join(path.name for path in extra[:3]) in str(caught.value)


def test_an_image_of_another_size_than_the_table_says_is_named(dataset):
    images = read_dataset(dataset).image_sets["satellite"]
    Image.new("RGB", (7, 5)).save(images.path(1))
    with pytest.raises(InvalidInput, match=r"\.png: has 7 x 5 px, and \d+ x \d+ px in the table"):
        images.pixels(1)


def test_an_image_that_cannot_be_read_is_named(dataset):
    images = read_dataset(dataset).image_sets["satellite"]
    path = images.path(2)
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(InvalidInput, match="cannot be read") as caught:
        images.pixels(2)
    assert path.name in str(caught.value)


@pytest.mark.parametrize("other", ["BMP", "GIF", "PPM", "TGA"])
def test_images_of_other_formats_are_refused_whatever_their_names(dataset, other):
    images = read_dataset(dataset).image_sets["satellite"]
    Image.new("RGB", (64, 48)).save(images.path(2), other)
    with pytest.raises(InvalidInput, match=r"cannot be read \(it is not a JPEG, PNG or TIFF\)"):
        images.pixels(2)


def test_bad_rows_are_named(dataset):
    def spoil(rows):
        rows[1][rows[0].index("Lat")] = "north"
        del rows[3][-1]

    edit(dataset / "satellite", spoil)
    with pytest.raises(InvalidInput, match="line 2 has Lat 'north', not a number; line 4 has"):
        read_dataset(dataset)


@pytest.mark.parametrize("layout", ["TerrAInav", "VBN"])
def test_folders_that_are_no_dataset_are_refused(tmp_path, layout):
    with pytest.raises(InvalidInput, match=r"nothing: (cannot be read|is not a VBN dataset)"):
        read_dataset(tmp_path / "nothing", layout)
    with pytest.raises(InvalidInput, match=r"is not a (dataset|VBN dataset)"):
        read_dataset(tmp_path, layout)


def test_one_map_type_of_a_dataset_and_unknown_layouts_are_refused(captured):
    with pytest.raises(InvalidInput, match="is one map type of the dataset"):
        read_dataset(captured / "satellite")
    with pytest.raises(InvalidInput, match="layout 'Other': must be one of TerrAInav, VBN"):
        read_dataset(captured, "Other")


@pytest.mark.parametrize(("header", "value"), [("Lat", "91"), ("Lat", "-1e300"), ("Lon", "361")])
def test_places_that_are_not_on_the_earth_are_named(dataset, header, value):
    def spoil(rows):
        rows[2][rows[0].index(header)] = value

    edit(dataset / "satellite", spoil)
    name = read_name(dataset / "satellite", 2)
    with pytest.raises(InvalidInput, match=f"{name} is not on the Earth, first at Lat .* must be within 90"):
        read_dataset(dataset)


def read_name(folder, row):
    with (folder / "meta_data.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))[row][0]
