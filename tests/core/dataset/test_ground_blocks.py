"""Spatial blocks: no ground is shared between parts, as pixels, rays and geodesics say that know nothing of boxes."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from PIL import Image
from pyproj import Geod
from terrainav.core.capture.runner import capture
from terrainav.core.dataset import ground
from terrainav.core.dataset.folder import PARTS
from terrainav.core.dataset.ground import GroundBoxes, find_close
from terrainav.core.dataset.split import split
from terrainav.core.dataset.table import GAP, Table, image_parts
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.ellipsoid import trace
from terrainav.core.geodesy.mercator import PixelGrid, u_to_lon, v_to_lat
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.core.dataset.grounds import dataset_of
from tests.core.geodesy.inverse import image_points
from tests.support.sources import PatternSource
from tests.support.thinning import examples, sampled

GEOD = Geod(ellps="WGS84")
PARTS_OR_GAP = (*PARTS, GAP)


def parts_in(folder, map_type="satellite"):
    return image_parts(Table.load(folder / map_type / "meta_data.csv"))


def pixels_of(window, world):
    left, top, width, height = window
    return {((left + x) % world, top + y) for x in range(width) for y in range(height)}


def split_or_none(folder, **options):
    try:
        return split(folder, (0.5, 0.25, 0.25), how="blocks", **options)
    except InvalidInput as refused:
        if "without images" not in str(refused) and "would be in no part" not in str(refused):
            raise
        return None


@st.composite
def grids_of_windows(draw):
    """Zoom, tile size and windows of missions with overlap, of several heights, crossed or with stray images."""
    zoom, tile_px = draw(st.sampled_from([(4, 256), (10, 512), (19, 256), (19, 768), (22, 512)]))
    world = PixelGrid(tile_px).world_px(zoom)
    # At the antimeridian, or anywhere.
    left0 = draw(st.one_of(st.integers(-60, 0), st.integers(0, world - 1)))
    top0 = draw(st.integers(world // 16, world - world // 16 - 200))
    windows = []
    for _ in range(draw(st.integers(1, 2))):
        width, height = draw(st.integers(4, 16)), draw(st.integers(4, 16))
        step_x, step_y = draw(st.integers(1, width)), draw(st.integers(1, height))
        columns, rows = draw(st.integers(1, 7)), draw(st.integers(1, 5))
        x0, y0 = draw(st.integers(-5, 5)), draw(st.integers(-5, 5))
        windows += [
            (left0 + x0 + column * step_x + row % 2, top0 + y0 + row * step_y, width, height)
            for row in range(rows)
            for column in range(columns)
        ]
    strays = st.tuples(st.integers(-90, 90), st.integers(-20, 90), st.integers(1, 30), st.integers(1, 30))
    windows += [(left0 + x, top0 + y, w, h) for x, y, w, h in draw(st.lists(strays, max_size=6))]
    return zoom, tile_px, windows


@settings(max_examples=examples(22), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(grids_of_windows(), st.integers(0, 5), st.sampled_from([None, 0.5, 1.0, 3.0]))
def test_no_pixel_of_the_map_is_in_two_parts(tmp_path_factory, grounds, seed, block):
    zoom, tile_px, windows = grounds
    grid = PixelGrid(tile_px)
    folder = dataset_of(tmp_path_factory.mktemp("blocks") / "out", zoom, windows, grid)
    side_m = block and block * 12 * grid.pixel_size(zoom)[0]
    made = split_or_none(folder, seed=seed, block_m=side_m)
    assume(made is not None)
    seen = {part: set() for part in PARTS}
    parts = parts_in(folder)
    for window, part in zip(windows, parts):
        assert part in PARTS_OR_GAP
        if part != GAP:
            seen[part] |= pixels_of(window, grid.world_px(zoom))
    train, validation, test = seen.values()
    assert not train & validation
    assert not train & test
    assert not validation & test
    assert all(seen.values())
    assert {part: parts.count(part) for part in PARTS} == dict(made.images)
    assert parts.count(GAP) == made.gap


def border(window, world, points=6):
    """Longitudes and latitudes of points along a window's border."""
    left, top, width, height = window
    share = np.linspace(0.0, 1.0, points)
    x = np.concatenate(
        [left + width * share, left + width * share, np.full(points, left), np.full(points, left + width)]
    )
    y = np.concatenate(
        [np.full(points, top), np.full(points, top + height), top + height * share, top + height * share]
    )
    return u_to_lon(x / world), v_to_lat(y / world)


@settings(max_examples=examples(8), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(grids_of_windows(), st.floats(0.1, 40.0))
def test_gap_is_kept_on_the_ground(tmp_path_factory, grounds, gap_px):
    zoom, tile_px, windows = grounds
    grid = PixelGrid(tile_px)
    world = grid.world_px(zoom)
    gap_m = min(gap_px * grid.pixel_size(zoom)[0], 1e6)
    # Where images far apart are near each other in no other way, some parts can be made.
    windows = windows + [(left + step, top, w, h) for step in (200, 400) for left, top, w, h in windows[:6]]
    folder = dataset_of(tmp_path_factory.mktemp("gap") / "out", zoom, windows, grid)
    made = split_or_none(folder, gap_m=gap_m)
    assume(made is not None)
    assert made.gap_m == gap_m
    borders = {}
    for window, part in zip(windows, parts_in(folder)):
        borders.setdefault(part, []).append(border(window, world))
    joined = {part: np.concatenate(borders[part], axis=1) for part in PARTS}
    for one, other in (("train", "validation"), ("train", "test"), ("validation", "test")):
        (lon0, lat0), (lon1, lat1) = joined[one], joined[other]
        pairs = np.broadcast_arrays(lon0[:, None], lat0[:, None], lon1, lat1)
        if pairs[0].size > 400_000:
            pairs = [values[:: pairs[0].size // 400_000 + 1] for values in map(np.ravel, pairs)]
        assert GEOD.inv(*map(np.ravel, pairs))[2].min() >= gap_m


@pytest.mark.parametrize(("left", "tile_px"), [(100_000_000, 256), (-60, 256), (-61, 768)])
def test_frames_that_only_touch_lose_nothing_to_the_gap(tmp_path, left, tile_px):
    windows = [(left + 10 * x, 50_000_000 + 10 * y, 10, 10) for y in range(12) for x in range(12)]
    made = split(dataset_of(tmp_path / "out", 19, windows, PixelGrid(tile_px)), how="blocks")
    assert made.gap == 0
    assert all(abs(share - asked) < 0.02 for share, asked in zip(made.shares.values(), (0.8, 0.1, 0.1)))


def test_overlap_of_80_percent_leaves_most_images_in_parts(tmp_path):
    windows = [(100_000_000 + 100 * x, 50_000_000 + 100 * y, 500, 500) for y in range(40) for x in range(40)]
    made = split(dataset_of(tmp_path / "out", 19, windows), how="blocks")
    assert made.gap < 0.5 * len(windows)
    assert all(abs(share - asked) < 0.05 for share, asked in zip(made.shares.values(), (0.8, 0.1, 0.1)))


@settings(max_examples=examples(30), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.integers(1, 14), st.integers(1, 14), st.integers(40, 500), st.integers(0, 9))
def test_by_default_half_of_the_images_or_more_are_in_parts_or_the_length_is_stated(
    tmp_path_factory, columns, rows, step, seed
):
    windows = [(100_000_000 + step * x, 50_000_000 + step * y, 500, 500) for y in range(rows) for x in range(columns)]
    folder = dataset_of(tmp_path_factory.mktemp("default") / "out", 19, windows)
    try:
        made = split(folder, seed=seed)
    except InvalidInput as refused:
        # A row of images of this length, that overlap as much, can be split.
        if found := re.search(r"take an area ([\d,]+) m long", str(refused)):
            ground_m = 500 * PixelGrid().pixel_size(19)[0] * (1.0 + (max(columns, rows) - 1) * step / 500)
            assert ground_m < 1.1 * float(found[1].replace(",", ""))
            count = 4 * 500 // step + 2
            longer = dataset_of(
                tmp_path_factory.mktemp("longer") / "out",
                19,
                [(100_000_000 + step * x, 50_000_000, 500, 500) for x in range(max(count, 12))],
            )
            made = split(longer, seed=seed)
        else:
            assert columns * rows <= 3
            return
    assert 2 * made.gap <= sum(made.images.values()) + made.gap
    if sum(made.images.values()) >= 20:
        assert made.shares["train"] == pytest.approx(0.8, abs=0.11)


BOX = st.tuples(st.floats(-0.6, 0.6), st.floats(-84, 84), st.floats(1e-6, 0.3), st.floats(1e-6, 10.0))


@given(st.lists(BOX, min_size=1, max_size=12), st.lists(BOX, min_size=1, max_size=12))
def test_near_is_what_each_pair_says(first, second):
    def boxes(tuples):
        u, lat, width, height = np.array(tuples).T
        return GroundBoxes(u, u + width, lat, lat + height)

    mine, theirs = boxes(first), boxes(second)
    west, east, south, north = (edge[:, np.newaxis] for edge in mine)
    met = np.zeros((len(first), len(second)), bool)
    for turn in (-1.0, 0.0, 1.0):
        met |= (
            (west < theirs.east_u + turn)
            & (east > theirs.west_u + turn)
            & (south < theirs.north_deg)
            & (north > theirs.south_deg)
        )
    np.testing.assert_array_equal(find_close(mine, theirs, 0.0), met.any(axis=1))


TURNED = [
    {"yaw_deg": 30.0, "tilt_deg": 20.0},
    {"yaw_deg": -75.0, "tilt_deg": 45.0, "roll_deg": 10.0, "ground_height_m": 300.0},
    {"frame": "camera", "overlap_along": 0.5, "overlap_across": 0.3},
    {"row_azimuth_deg": 127.0, "crosshatch": True, "overlap_along": 0.3},
]


@pytest.mark.parametrize(
    ("changes", "image_format"),
    sampled([*((one, "jpg") for one in TURNED), (TURNED[0], "tif"), (TURNED[2], "png")], 2),
)
def test_no_ground_of_a_turned_camera_is_seen_from_another_part(tmp_path, changes, image_format):
    area = Points(
        tuple(
            (
                10.0 + 0.0011 * row,
                179.998 + 0.0009 * column - (360.0 if column > 2 else 0.0),
                60.0 + 25.0 * (row % 2),
            )
            for row in range(6)
            for column in range(6)
        )
    )
    if "overlap_along" in changes:
        area = Box(10.005, 179.998, 10.0, -179.9975)
    mission = Mission(area, 80.0, image_format=image_format, max_px=32, accept_error=True, **changes)
    source = PatternSource()
    worked_out = plan(mission, source.grid)
    folder = tmp_path / "out"
    capture(worked_out, source, folder)
    made = split(folder, (0.6, 0.2, 0.2), how="blocks")
    assert made.unknown == 0
    parts = dict(zip(names_in(folder), parts_in(folder)))
    part = np.array([parts[name] for name in worked_out.names])
    # Rays through a grid of the image's points, and whether another camera's image has the ground they meet.
    share = np.linspace(-1.0, 1.0, 17)
    points = [(x, y) for x in share for y in share]
    poses = worked_out.poses
    rays = mission.camera.rays_enu(points, *poses.attitude)
    seen = trace(poses.lat_deg[:, None], poses.agl_m[:, None], rays)
    lon = poses.lon_deg[:, None] + seen.dlon_deg
    for index in np.flatnonzero(np.isin(part, PARTS)):
        others = np.flatnonzero(np.isin(part, PARTS) & (part != part[index]))
        ground = (np.broadcast_to(values[index], (len(others), len(points))) for values in (seen.lat_deg, lon))
        in_other = image_points(mission.camera, poses.take(others), *ground)
        assert not (np.abs(in_other) <= 1.0).all(axis=-1).any()


def names_in(folder):
    return [Path(name).stem for name in Table.load(folder / "satellite" / "meta_data.csv").img_names]


def test_images_that_see_the_horizon_are_in_no_part(tmp_path):
    lats = [10.0 + 0.02 * index for index in range(8)]
    area = Points(tuple((lat, 20.0, 60.0) for lat in lats))
    source = PatternSource()
    mission = Mission(area, 60.0, image_format="jpg", max_px=32, tilt_deg=80.0, accept_error=True)
    folder = tmp_path / "out"
    capture(plan(mission, source.grid), source, folder)
    with pytest.raises(InvalidInput, match="see the horizon"):
        split(folder, how="blocks")
    # One that does not, as the plan has it.
    text = (folder / "plan.csv").read_text().splitlines()
    header = text[0].split(",")
    for line in (1, 2, 3):
        cells = text[line].split(",")
        lat, lon = (float(cells[header.index(name)]) for name in ("lat_deg", "lon_deg"))
        for corner, (north, east) in {"nw": (2, -1), "ne": (2, 1), "se": (1, 1), "sw": (1, -1)}.items():
            cells[header.index(f"{corner}_lat_deg")] = repr(lat + 1e-3 * north)
            cells[header.index(f"{corner}_lon_deg")] = repr(lon + 1e-3 * east)
        text[line] = ",".join(cells)
    (folder / "plan.csv").write_text("\n".join(text) + "\n")
    made = split(folder, how="blocks")
    assert (sum(made.images.values()), made.unknown) == (3, 5)
    assert parts_in(folder).count(GAP) == 5
    (folder / "plan.csv").unlink()
    with pytest.raises(InvalidInput, match=r"plan\.csv: cannot be read"):
        split(folder, how="blocks")


@pytest.fixture(scope="module")
def oblique(tmp_path_factory):
    """Folder of a capture by a turned camera, with images that overlap; not to be changed."""
    folder, source = tmp_path_factory.mktemp("oblique") / "out", PatternSource()
    area = Box(10.006, 179.998, 10.0, -179.997)
    mission = Mission(area, 80.0, image_format="png", max_px=32, accept_error=True, tilt_deg=25.0, roll_deg=20.0)
    capture(plan(mission, source.grid), source, folder)
    return folder


def test_turned_cameras_images_are_no_windows_whatever_lies_beside_them(oblique, tmp_path):
    """Not where a program has left a world file, nor where nothing but table and images is there any more."""
    folder = tmp_path / "out"
    shutil.copytree(oblique, folder)
    made = split(folder, (0.6, 0.2, 0.2), how="blocks", dry_run=True)
    for image in (folder / "satellite").glob("*.png"):
        image.with_suffix(".pgw").write_text("1\n0\n0\n-1\n0\n0\n")
    assert split(folder, (0.6, 0.2, 0.2), how="blocks", dry_run=True) == made
    (folder / "mission.json").unlink()
    (folder / "plan.csv").unlink()
    with pytest.raises(InvalidInput, match=r"plan\.csv: cannot be read"):
        split(folder, (0.6, 0.2, 0.2), how="blocks")


def test_camera_frames_are_worked_out_some_at_a_time(oblique, monkeypatch):
    whole = split(oblique, how="blocks", dry_run=True)
    monkeypatch.setattr(ground, "_FRAMES_AT_ONCE", 7)
    assert split(oblique, how="blocks", dry_run=True) == whole


def test_plan_that_lacks_an_image_or_a_column_is_refused(oblique, tmp_path):
    folder = tmp_path / "out"
    shutil.copytree(oblique, folder)
    lines = (folder / "plan.csv").read_text().splitlines(keepends=True)
    lost = lines[5].partition(",")[0]
    for text, said in (
        ("".join(lines[:5] + lines[6:]), f"has no row of {lost}"),
        ("".join(lines).replace("se_lat_deg", "se", 1), "cannot be read .*se_lat_deg"),
        ("".join([*lines[:3], lines[3][: len(lines[3]) // 2]]), "cannot be read"),
    ):
        (folder / "plan.csv").write_text(text)
        with pytest.raises(InvalidInput, match=re.escape(lost) if lost in said else said):
            split(folder, how="blocks")


def test_published_images_show_the_map_about_their_centre(tmp_path):
    windows = [(100_000_000 + 8 * x, 50_000_000, 10, 10) for x in range(20)]
    folder = dataset_of(tmp_path / "out", 19, windows, left_px=np.full(20, np.nan))
    for path in folder.glob("*/*.png"):
        Image.new("RGB", (10, 10)).save(path)
    split(folder, (0.6, 0.2, 0.2), how="blocks", block_m=15.0)
    parts = parts_in(folder)
    neighbours = {frozenset(pair) for pair in zip(parts, parts[1:])}
    assert {"train", "validation", "test"} <= set(parts)
    assert all(len(pair - {GAP}) < 2 for pair in neighbours)


def test_window_that_lies_elsewhere_than_its_centre_is_named(tmp_path):
    windows = [(100_000_000 + 8 * x, 50_000_000, 10, 10) for x in range(20)]
    folder = dataset_of(tmp_path / "out", 19, windows)
    path = folder / "satellite" / "meta_data.csv"
    table = Table.load(path)
    table.left_px[4] += 5.0
    table.save(path)
    with pytest.raises(InvalidInput, match=r"window of p4\.png .* elsewhere"):
        split(folder, how="blocks")
