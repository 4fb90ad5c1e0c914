"""``geo.txt`` and ``cameras.json`` read as OpenDroneMap reads them, beside the tags of the photos themselves."""

from __future__ import annotations

import json

import numpy as np
import pytest
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.table import Table
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.photos import SIXTH_DIGIT, angles, camera_id, exiftool, focal_ratio, position
from tests.support.sources import FailingSource, PatternSource, missing
from tests.support.thinning import sampled

AREA = Box(35.1425, -89.866, 35.1395, -89.861)
MISSION = Mission(AREA, 120.0, image_format="jpg", ground_height_m=80.0)
FILES = ("geo.txt", "cameras.json")


def planned(mission=MISSION):
    return plan(mission, PatternSource().grid)


def geo(folder) -> dict[str, list[float]]:
    """Numbers by image: the loop of `GeoFile` in opendm/geo.py."""
    crs, *lines = (folder / "geo.txt").read_text().strip().split("\n")
    assert crs == "EPSG:4326"
    rows = {parts[0]: [float(part) for part in parts[1:]] for parts in map(str.split, lines)}
    assert {len(row) for row in rows.values()} <= {8}
    assert len(rows) == len(lines)
    return rows


def cameras(folder) -> dict[str, dict]:
    """Cameras as `get_opensfm_camera_models` of opendm/camera.py wants them."""
    read = json.loads((folder / "cameras.json").read_text())
    assert all(name.startswith("v2 ") and len(name.split(" ")) >= 6 for name in read)
    return read


def written(folder) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in (*FILES, "meta_data.csv")}


@pytest.mark.parametrize(
    "mission",
    sampled(
        [
            MISSION,
            MISSION.replace(img_size=(200, 77, 3)),
            MISSION.replace(yaw_deg=200.0, tilt_deg=25.0, roll_deg=-10.0, max_px=120),
            MISSION.replace(camera=Camera(70.0, 0.7), frame="camera", max_px=120),
            MISSION.replace(wind=Wind(8.0, 250.0, 0.1), max_px=120),
            Mission(Points(((-16.5, 179.9999, 60.0), (-16.5, -179.9999, 500.0))), 60.0, image_format="jpg"),
        ],
        2,
    ),
    ids=["map frames", "resized", "turned", "upright", "wind", "heights across the antimeridian"],
)
def test_both_files_say_what_the_photos_say(tmp_path, mission):
    worked_out = planned(mission)
    assert capture(worked_out, PatternSource(), tmp_path).failed == ()
    folder = tmp_path / "satellite"
    rows, models = geo(folder), cameras(folder)
    names = [f"{name}.jpg" for name in worked_out.names]
    assert list(rows) == names
    used = set()
    for name, tags in zip(names, exiftool(*(folder / name for name in names))):
        lon, lat, altitude, yaw, pitch, roll, across, in_height = rows[name]
        # Half of the last digits of the tags.
        assert position(tags) == pytest.approx((lat, lon, altitude), abs=2e-11)
        assert angles(tags) == [yaw, pitch, roll]
        assert across == tags["XMP-Camera:GPSXYAccuracy"]
        assert in_height == tags["XMP-Camera:GPSZAccuracy"]
        model = models[camera_id(tags)]
        used.add(camera_id(tags))
        width, height = tags["ExifIFD:ExifImageWidth"], tags["ExifIFD:ExifImageHeight"]
        assert (model["width"], model["height"]) == (width, height)
        # Names are cut after four decimals, and cameras that share one stand in its middle.
        cut = 1e-4 * width / max(width, height)
        assert model["focal_x"] == pytest.approx(focal_ratio(tags) * width / max(width, height), abs=cut)
        shape = tags["ExifIFD:FocalPlaneYResolution"] / tags["ExifIFD:FocalPlaneXResolution"]
        assert model["focal_y"] / model["focal_x"] == pytest.approx(shape, rel=4 * SIXTH_DIGIT)
        assert {model[name] for name in ("c_x", "c_y", "k1", "k2", "k3", "p1", "p2")} == {0.0}
    assert used == set(models)
    if not worked_out.frames.on_map:
        camera = mission.camera
        (model,) = models.values()
        longer = max(worked_out.frames.largest_px)
        exact = [size / longer / 2.0 / tan for size, tan in zip(worked_out.frames.largest_px, camera.half_tangents)]
        assert [model["focal_x"], model["focal_y"]] == pytest.approx(exact, rel=SIXTH_DIGIT)


LENSES = {
    "brown": ({"k1": -0.2, "k2": 0.05, "k3": -0.01, "p1": 0.002, "p2": -0.001}, "perspective"),
    "fisheye_opencv": ({"k1": 0.02, "k2": -0.01, "k3": 0.002}, "fisheye"),
}


@pytest.mark.parametrize("model", LENSES)
def test_lenses_have_the_coefficients_that_opendronemap_keeps(tmp_path, model):
    coefficients, lens = LENSES[model]
    camera = Camera(70.0, lens=lens, principal_x=0.02, principal_y=-0.01, **coefficients)
    worked_out = planned(MISSION.replace(camera=camera, max_px=120))
    capture(worked_out, PatternSource(), tmp_path, only=[0])
    (photo,) = (tmp_path / "satellite").glob("*.jpg")
    (tags,) = exiftool(photo)
    assert tags["XMP-Camera:ModelType"] == lens
    told = cameras(tmp_path / "satellite")[camera_id(tags)]
    # Keys that `get_opensfm_camera_models` of opendm/camera.py keeps.
    kept = {"projection_type", "width", "height", "focal_x", "focal_y", "c_x", "c_y", "k1", "k2", "k3", "p1", "p2"}
    assert set(told) <= kept
    assert told["projection_type"] == model
    assert {name: told[name] for name in coefficients} == coefficients
    # In units of the longer side.
    assert (told["c_x"], told["c_y"]) == (0.02, pytest.approx(-0.01 * told["height"] / told["width"], rel=SIXTH_DIGIT))


@pytest.mark.parametrize("lens", ["perspective", "fisheye"])
def test_a_lens_that_opendronemap_would_cut_short_has_no_camera(tmp_path, lens):
    camera = Camera(70.0, lens=lens, k1=0.01, k4=0.001)
    capture(planned(MISSION.replace(camera=camera, max_px=120)), PatternSource(), tmp_path, only=[0])
    assert cameras(tmp_path / "satellite") == {}


def test_poses_have_the_digits_that_mean_something(tmp_path):
    worked_out = planned()
    capture(worked_out, PatternSource(), tmp_path)
    rows = np.array(list(geo(tmp_path / "satellite").values()))
    np.testing.assert_allclose(rows[:, 0], worked_out.lon_deg, rtol=0, atol=0.51e-9)
    np.testing.assert_allclose(rows[:, 1], worked_out.lat_deg, rtol=0, atol=0.51e-9)
    assert np.array_equal(rows[:, 2], worked_out.agl_m + 80.0)
    texts = [line.split()[1:3] for line in (tmp_path / "satellite" / "geo.txt").read_text().splitlines()[1:]]
    assert max(len(text.partition(".")[2]) for row in texts for text in row) == 9


def test_only_images_that_are_there_are_listed_until_all_are(tmp_path):
    """In one go, in two with an interruption, and with failures that are made good: the same bytes in the end."""
    worked_out = planned()
    capture(worked_out, PatternSource(), tmp_path / "whole")
    whole = written(tmp_path / "whole" / "satellite")
    assert set(whole) == {*FILES, "meta_data.csv"}

    parts, interrupted = tmp_path / "parts", iter([False] * 20)
    capture(worked_out, PatternSource(), parts, only=[1, 4], listener=Listener(cancelled=lambda: False))
    assert list(geo(parts / "satellite")) == [f"{worked_out.names[index]}.jpg" for index in (1, 4)]
    capture(
        worked_out,
        PatternSource(wait_s=0.01),
        parts,
        resume=True,
        listener=Listener(cancelled=lambda: next(interrupted, True)),
    )
    assert set(geo(parts / "satellite")) == {path.name for path in (parts / "satellite").glob("*.jpg")}
    capture(worked_out, PatternSource(), parts, resume=True)
    assert written(parts / "satellite") == whole

    source, holes = PatternSource(), tmp_path / "holes"
    window = source.parts(_window(worked_out, 0))[0].window
    result = capture(worked_out, FailingSource({window: missing()}), holes)
    failed = {f"{failure.name}.jpg" for failure in result.failed}
    assert failed
    there = {path.name for path in (holes / "satellite").glob("*.jpg")}
    assert set(geo(holes / "satellite")) == there == {f"{name}.jpg" for name in worked_out.names} - failed
    capture(worked_out, PatternSource(), holes, only_failed=True)
    assert written(holes / "satellite") == whole


def _window(worked_out, index):
    from terrainav.core.picture.map_frame import capture_window

    return capture_window(worked_out, index)


def test_a_run_of_which_nothing_came_lists_nothing(tmp_path):
    worked_out = planned()
    capture(worked_out, PatternSource(), tmp_path, only=[])
    assert (tmp_path / "satellite" / "geo.txt").read_text() == "EPSG:4326\n"
    assert cameras(tmp_path / "satellite") == {}


def test_each_map_type_has_its_own_and_other_formats_none(tmp_path):
    capture(planned(MISSION.replace(map_types=("satellite", "roadmap"))), PatternSource(), tmp_path / "jpg")
    for map_type in ("satellite", "roadmap"):
        assert len(geo(tmp_path / "jpg" / map_type)) == len(planned())
    capture(planned(MISSION.replace(image_format="png")), PatternSource(), tmp_path / "png")
    assert not {path.name for path in (tmp_path / "png" / "satellite").iterdir()} & set(FILES)


def test_cleaning_leaves_them_and_they_still_tell_of_what_is_there(tmp_path):
    """Images are looked up by name, so that lines of those that were moved away are left alone."""
    worked_out = planned()
    capture(worked_out, PatternSource(), tmp_path)
    folder = tmp_path / "satellite"
    before = written(folder)
    entropies = Table.load(folder / "meta_data.csv").entropies
    clean(tmp_path, float(np.median(entropies)), move=True)
    left = {path.name for path in folder.glob("*.jpg")}
    assert 0 < len(left) < len(worked_out)
    assert left < set(geo(folder))
    assert {name: (folder / name).read_bytes() for name in FILES} == {name: before[name] for name in FILES}
    capture(worked_out, PatternSource(), tmp_path, resume=True)
    assert {name: (folder / name).read_bytes() for name in FILES} == {name: before[name] for name in FILES}
