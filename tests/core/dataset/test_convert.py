"""Datasets of others as ours: tables, windows, and what is left where it cannot be done."""

from __future__ import annotations

import errno
import shutil

import numpy as np
import pyproj
import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.dataset import convert as module
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.convert import Converted, convert
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.published import FLIGHT, flown_size, write_published, write_vbn
from tests.support.sources import PatternSource
from tests.support.thinning import sampled

HALF_WORLD_M = 20037508.342789244


def files(folder):
    return {
        str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_mtime_ns)
        for path in folder.rglob("*")
        if path.is_file()
    }


def table_of(folder, map_type="satellite"):
    return Table.load(folder / map_type / "meta_data.csv")


def edges_m(table, zoom):
    """West, east, north and south of windows in EPSG:3857."""
    px = 2.0 * HALF_WORLD_M / (256 * 2**zoom)
    west, north = table.left_px * px - HALF_WORLD_M, HALF_WORLD_M - table.top_px * px
    return west, west + table.width_px * px, north, north - table.height_px * px


def test_a_published_folder_becomes_one_of_ours(tmp_path):
    source, target = tmp_path / "Memphis", tmp_path / "ours" / "Memphis"
    names = write_published(source / "satellite_0", blank=[(1, 1)])
    write_published(source / "roadmap_0")
    before = files(source)
    told = convert(source, target)
    assert set(told) == {Converted("satellite", 6, 0, 6), Converted("roadmap", 6, 0, 6)}
    assert files(source) == before
    assert not list(target.parent.glob("*.part"))

    read = read_dataset(target)
    assert set(read.image_sets) == {"satellite", "roadmap"}
    old = read_dataset(source).image_sets["satellite"]
    new = read.image_sets["satellite"]
    assert new.table.img_names == old.table.img_names == tuple(names)
    for index in range(6):
        assert new.path(index).read_bytes() == old.path(index).read_bytes()
    for column in ("columns", "rows", "lat_deg", "lon_deg", "zoom", "entropies"):
        np.testing.assert_array_equal(getattr(new.table, column), getattr(old.table, column))
    np.testing.assert_array_equal(new.table.pose_lat_deg, old.table.lat_deg)
    assert new.table.image_width_px.tolist() == [64.0] * 6
    assert new.table.image_height_px.tolist() == [48.0] * 6
    assert set(new.table.status) == {"done"}
    assert np.isnan(new.table.agl_m).all()


def test_a_window_is_the_image_about_its_centre(tmp_path):
    write_published(tmp_path / "a" / "satellite")
    convert(tmp_path / "a", tmp_path / "b")
    table = table_of(tmp_path / "b")
    x, y = pyproj.Transformer.from_crs(4326, 3857, always_xy=True).transform(table.lon_deg, table.lat_deg)
    west, east, north, south = edges_m(table, 17)
    px = 2.0 * HALF_WORLD_M / (256 * 2**17)
    # Tolerance: float64 keeps some nanometres of 2e7 m.
    np.testing.assert_allclose([west, east], [x - 32 * px, x + 32 * px], atol=1e-6)
    np.testing.assert_allclose([north, south], [y + 24 * px, y - 24 * px], atol=1e-6)


@pytest.mark.parametrize("finer", sampled([0, 1, 2, 5], 3))
def test_images_of_a_higher_zoom_show_the_ground_of_the_flight(tmp_path, finer):
    """Those of the paper's repository are four times as fine as ``Alt`` says."""
    agl_m = 120.0
    size = flown_size(agl_m, 78.8, 35.16, 17 + finer)
    write_published(tmp_path / "a" / "satellite", images=FLIGHT, size=size, columns=2)
    convert(tmp_path / "a", tmp_path / "b")
    table = table_of(tmp_path / "b")
    assert set(table.zoom) == {17}
    assert set(table.agl_m) == {agl_m}
    np.testing.assert_array_equal(table.width_px, size[0] / 2.0**finer)
    west, east, _, _ = edges_m(table, 17)
    shrink = np.cos(np.radians(35.16))
    # The frame of the camera itself, to a pixel or, at 120 m and zoom 17, a few per cent.
    expected = 0.8 * 2.0 * agl_m * np.tan(np.radians(39.4))
    np.testing.assert_allclose((east - west) * shrink, expected, atol=1.1 * expected / size[0])


@pytest.mark.parametrize(
    "flight",
    [
        "raster_images_35_-89_0_170.0_78.8_4_4",
        "raster_images_35_-89_0_0_78.8_4_4",
        "raster_images_x_120.0_180_4_4",
    ],
)
def test_ground_that_the_flight_does_not_tell_is_left_unknown(tmp_path, flight):
    size = flown_size(120.0, 78.8, 35.16, 19)
    write_published(tmp_path / "a" / "satellite", images=flight, size=size, columns=1)
    assert convert(tmp_path / "a", tmp_path / "b") == (Converted("satellite", 2, 0, 0),)
    table = table_of(tmp_path / "b")
    assert np.isnan(table.left_px).all()
    assert table.image_width_px.tolist() == [size[0]] * 2


def test_windows_at_the_antimeridian_start_inside_the_world(tmp_path):
    write_published(tmp_path / "a" / "satellite", columns=1, start=(10.0, -180.0), zoom=3)
    convert(tmp_path / "a", tmp_path / "b")
    assert table_of(tmp_path / "b").left_px[0] == 256 * 2**3 - 32


def test_rejected_images_stay_rejected_and_several_overlaps_apart(tmp_path):
    for ending in ("_0", "_0.6"):
        write_published(tmp_path / "a" / f"satellite{ending}", images=FLIGHT)
        write_published(tmp_path / "a" / f"roadmap{ending}", images=FLIGHT, blank=[(0, 0)])
    clean(tmp_path / "a", 2.1, move=True)
    convert(tmp_path / "a", tmp_path / "b")
    read = read_dataset(tmp_path / "b")
    assert set(read.image_sets) == {"satellite_0", "roadmap_0", "satellite_0.6", "roadmap_0.6"}
    for images in read.image_sets.values():
        places = [images.path(index).parent.name for index in range(6)]
        assert places == ["rejected", *[images.folder.name] * 5]
        assert sum(map(bool, images.table.other["rejected"])) == 1


def test_a_supplement_becomes_a_dataset_of_ours(tmp_path):
    write_vbn(tmp_path / "a", ["1", "2", "3"], texts=["1", "2", "3", "4"])
    assert convert(tmp_path / "a", tmp_path / "b", "VBN") == (Converted("camera", 3, 1, 0),)
    images = read_dataset(tmp_path / "b").image_sets["camera"]
    old = read_dataset(tmp_path / "a", "VBN").image_sets["camera"].table
    np.testing.assert_array_equal(images.table.lat_deg, old.lat_deg)
    assert dict(images.table.other) == dict(old.other)
    assert images.made.tolist() == [True, True, True, False]
    assert images.table.image_width_px.tolist()[:3] == [64.0] * 3
    assert np.isnan(images.table.image_width_px[3])
    assert images.pixels(2).shape == (48, 64, 3)
    (cleaned,) = clean(tmp_path / "b", 2.1, dry_run=True)
    assert (cleaned.images, cleaned.failed, cleaned.rejected) == (3, 1, 0)


def test_what_was_converted_converts_to_the_same(tmp_path):
    write_published(tmp_path / "a" / "satellite", images=FLIGHT, size=flown_size(120.0, 78.8, 35.16, 18))
    convert(tmp_path / "a", tmp_path / "b")
    convert(tmp_path / "b", tmp_path / "c")
    ours, again = (files(tmp_path / name) for name in "bc")
    assert {name: data for name, (data, _) in ours.items()} == {name: data for name, (data, _) in again.items()}


def test_images_that_cannot_be_read_are_named_and_nothing_is_written(tmp_path):
    names = write_published(tmp_path / "a" / "satellite")
    for name in names[:5]:
        (tmp_path / "a" / "satellite" / name).write_bytes(b"no image")
    with pytest.raises(InvalidInput) as caught:
        convert(tmp_path / "a", tmp_path / "b")
    assert f"no images that can be read: {', '.join(names[:3])} and 2 more" in str(caught.value)
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_images_that_are_cut_off_are_named(tmp_path):
    names = write_published(tmp_path / "a" / "satellite")
    path = tmp_path / "a" / "satellite" / names[2]
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InvalidInput, match=f"no images that can be read: {names[2]}$"):
        convert(tmp_path / "a", tmp_path / "b")
    assert not (tmp_path / "b").exists()


def test_a_table_without_images_is_refused(tmp_path):
    write_published(tmp_path / "a" / "satellite")
    table = tmp_path / "a" / "satellite" / "meta_data.csv"
    table.write_text(table.read_text().partition("\n")[0] + "\n")
    with pytest.raises(InvalidInput, match=r"meta_data\.csv: names no image that is there"):
        convert(tmp_path / "a", tmp_path / "b")
    assert not (tmp_path / "b").exists()


def test_a_link_to_a_folder_is_that_folder(tmp_path):
    write_published(tmp_path / "a" / "satellite")
    (tmp_path / "real").mkdir()
    link = tmp_path / "link"
    try:
        link.symlink_to(tmp_path / "real", target_is_directory=True)
    except OSError:
        pytest.skip("no symbolic links here")
    convert(tmp_path / "a", link)
    assert link.is_symlink()
    assert len(read_dataset(tmp_path / "real").image_sets["satellite"]) == 6


def test_targets_that_are_in_use_are_refused(tmp_path, monkeypatch):
    write_published(tmp_path / "a" / "satellite")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("x")
    (tmp_path / "file").write_text("x")
    (tmp_path / "left.part").mkdir()
    before = files(tmp_path)
    for target, said in (
        ("full", "is there already"),
        ("file", "is there already"),
        ("left", "is left over from an interrupted conversion"),
    ):
        with pytest.raises(OutputError, match=said):
            convert(tmp_path / "a", tmp_path / target)
    for target in ("a", "a/inside", "."):
        with pytest.raises(InvalidInput, match="must lie outside"):
            convert(tmp_path / "a", tmp_path / target)
    assert files(tmp_path) == before
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path / "empty")
    for target in (".", "", "new/.."):
        with pytest.raises(InvalidInput, match="is the current one, which is in use"):
            convert(tmp_path / "a", target)
    monkeypatch.chdir(tmp_path)
    convert(tmp_path / "a", tmp_path / "empty")
    assert len(read_dataset(tmp_path / "empty").image_sets["satellite"]) == 6


def test_captures_need_no_converting(tmp_path):
    source = PatternSource()
    capture(
        plan(Mission(Box(35.16, -89.90, 35.159, -89.899), 120.0, image_format="jpg"), source.grid),
        source,
        tmp_path / "a",
    )
    with pytest.raises(InvalidInput, match="is a capture, whose tables are ours already"):
        convert(tmp_path / "a", tmp_path / "b")


def test_a_full_disk_leaves_nothing(tmp_path, monkeypatch):
    write_published(tmp_path / "a" / "satellite")
    copied, copyfile = [], shutil.copyfile

    def full(origin, place):
        copied.append(place)
        if len(copied) == 4:
            raise OSError(errno.ENOSPC, "No space left on device")
        return copyfile(origin, place)

    monkeypatch.setattr(module.shutil, "copyfile", full)
    with pytest.raises(OutputError, match=r"b: cannot be written \(No space left on device\)"):
        convert(tmp_path / "a", tmp_path / "b")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
