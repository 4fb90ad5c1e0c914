"""camera.json and the table alone lead from ground points to the pixels that show them."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from uuid import uuid4

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.choices import LAYOUTS
from terrainav.core.capture.runner import capture
from terrainav.core.capture.several import capture_imageries
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.loading.batches import LabelledImages
from terrainav.core.errors import InvalidInput
from terrainav.core.exports.formats import export
from terrainav.core.exports.views import Views
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.contract import CameraContract
from terrainav.core.imagery.opening import named_source, open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import Plan, plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.products import sighting
from terrainav.core.storage.files import read_existing
from terrainav.core.storage.stores import store_path

LAT, LON = 46.2, -122.2
BROWN = Camera(70.0, k1=-0.2, k2=0.05, p1=0.002, p2=-0.001, k3=0.01, principal_x=0.02)
FISHEYE = Camera(110.0, lens="fisheye", k1=0.02, k2=-0.01, principal_y=-0.01)
TILTED = {"frame": "camera", "tilt_deg": 25.0, "roll_deg": -12.0, "yaw_deg": 33.0}
CASES = {
    "ideal": (Camera(), TILTED),
    "resized": (Camera(), {**TILTED, "img_size": (60, 40, 3)}),
    "brown": (BROWN, TILTED),
    "rational": (Camera(70.0, k1=0.2, k2=0.1, k4=0.4, k5=0.1, k6=0.02), TILTED),
    "fisheye": (FISHEYE, TILTED),
    "map": (Camera(), {}),
    "varied": (BROWN, {**TILTED, "vary": ("k1=uniform(-0.2,0.05)", "principal_x=choice(-0.04,0.04)")}),
    "zoomed": (Camera(), {**TILTED, "vary": ("fov_deg=uniform(55,80)",)}),
    "relief": (BROWN, {**TILTED, "elevation": ("world",)}),
}
_to_cart = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True).transform


def captured(folder: Path, camera: Camera, given) -> tuple[Path, Plan]:
    points = Points(((LAT, LON, 60.0), (LAT + 2e-4, LON + 1e-4, 75.0), (LAT + 3e-4, LON - 1e-4, 90.0)))
    mission = Mission(points, 60.0, camera, image_px=80, image_format="png", ground_height_m=40.0, **given)
    source = open_source("world")
    made = plan(mission, source.grid, mission_heights(mission))
    capture(made, source, folder / "out")
    return folder / "out", made


# --- What a reader writes who has only camera.json and the table


def turn(angle_deg: float, axis: int) -> np.ndarray:
    """Right-handed rotation about an axis."""
    cos, sin = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    found = np.eye(3)
    one, other = (axis + 1) % 3, (axis + 2) % 3
    found[one, one], found[one, other], found[other, one], found[other, other] = cos, -sin, sin, cos
    return found


def project(about: dict, row: dict[str, str], lon: np.ndarray, lat: np.ndarray, up_m: np.ndarray) -> np.ndarray:
    """Positions (2, n) in px of ground points by the contract's words and a row of the table."""
    columns = about["table"]
    assert about["pose"]["crs"] == "EPSG:4979"
    at_lat, at_lon, yaw, tilt, roll = (
        float(row[columns[name]]) for name in ("lat_deg", "lon_deg", "yaw_deg", "tilt_deg", "roll_deg")
    )
    height_m = (
        float(row[columns["height_m"]])
        if "height_m" in columns
        else float(row[columns["agl_m"]]) + columns["ground_height_m"]
    )
    phi, lam = np.radians([at_lat, at_lon])
    east = np.array([-np.sin(lam), np.cos(lam), 0.0])
    north = np.array([-np.sin(phi) * np.cos(lam), -np.sin(phi) * np.sin(lam), np.cos(phi)])
    ned = np.stack([north, east, -np.cross(east, north)])
    # Level and with north at the top, the image's top, right and view are north, east and down.
    body = turn(yaw, 2) @ turn(tilt, 1) @ turn(roll, 0)
    assert about["optical_axes"] == ["right", "down", "view"]
    optical = np.stack([body[:, 1], -body[:, 0], body[:, 2]]) @ ned
    away = np.stack(_to_cart(lon, lat, up_m)) - np.array(_to_cart(at_lon, at_lat, height_m))[:, np.newaxis]
    right, down, view = optical @ away
    return project_ray(about, row, right / view, down / view)


def project_ray(about: dict, row: dict[str, str], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """OpenCV's equations, as its documentation of camera calibration states them."""
    columns = about["table"]
    k = {name: float(row[name]) for name in columns.get("distortion", ())}
    if "lens" in columns and row[columns["lens"]] == "fisheye":
        r = np.hypot(x, y)
        angle = np.arctan(r)
        scale = angle * (1.0 + sum(k[f"k{at}"] * angle ** (2 * at) for at in (1, 2, 3, 4))) / r
        x, y = x * scale, y * scale
    elif k:
        r2 = x * x + y * y
        scale = (1.0 + k["k1"] * r2 + k["k2"] * r2**2 + k["k3"] * r2**3) / (
            1.0 + k["k4"] * r2 + k["k5"] * r2**2 + k["k6"] * r2**3
        )
        x, y = (
            x * scale + 2.0 * k["p1"] * x * y + k["p2"] * (r2 + 2.0 * x * x),
            y * scale + k["p1"] * (r2 + 2.0 * y * y) + 2.0 * k["p2"] * x * y,
        )
    fx, fy, cx, cy = (float(row[columns[name]]) for name in ("fx_px", "fy_px", "cx_px", "cy_px"))
    return np.stack([fx * x + cx, fy * y + cy])


@pytest.fixture(scope="module", params=CASES)
def case(request, tmp_path_factory):
    return captured(tmp_path_factory.mktemp(request.param), *CASES[request.param])


def rows_of(folder: Path, map_type: str = "satellite") -> list[dict[str, str]]:
    with (folder / map_type / "meta_data.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_ground_points_are_projected_to_their_pixels(case):
    folder, made = case
    about = json.loads((folder / "camera.json").read_text())
    rows = rows_of(folder)
    assert len(rows) == 3
    for row in rows:
        wide, high = (int(row[about["table"][name]]) for name in ("width_px", "height_px"))
        # What the product `points` has.
        points = sighting(made, made.names.index(Path(row[about["table"]["image"]]).stem), (wide, high))
        x, y = np.meshgrid(np.arange(wide) + 0.5, np.arange(high) + 0.5)
        seen = np.isfinite(points.height_m)
        assert seen.sum() > 0.9 * seen.size
        found = project(about, row, points.lon_deg[seen], points.lat_deg[seen], points.height_m[seen])
        # Rays through relief are traced to about a thousandth of a pixel.
        assert np.abs(found - np.stack([x[seen], y[seen]])).max() < (1e-3 if made.relief.is_level else 2e-3)


def test_tables_loaders_exports_and_the_file_state_one_contract(case, tmp_path):
    folder, made = case
    about = json.loads((folder / "camera.json").read_text())
    images = read_dataset(folder).image_set("satellite")
    contracts = [images.contract(row) for row in range(len(images))]
    samples = LabelledImages(folder, part="all", img_size=(8, 8, 3))
    assert [samples.contract(index) for index in range(len(samples))] == contracts
    is_one = not made.cameras.vary and not made.frames.on_map
    assert ("fx_px" in about) == is_one == (len({*contracts}) == 1)
    if is_one:
        assert CameraContract.from_json(about) == contracts[0]
    if made.frames.on_map:
        return
    exported = json.loads((export(Views.read(folder), tmp_path / "tum", "tum") / "camera.json").read_text())
    stated = {key: value for key, value in exported.items() if key in about}
    assert stated == {key: about[key] for key in stated}
    if is_one:
        assert CameraContract.from_json(exported) == contracts[0]
    else:
        of_images = {name: {"schema": 1, **one} for name, one in exported["images"].items()}
        found = [CameraContract.from_json(of_images[name]) for name in images.table.img_names]
        assert found == contracts


def test_undistorted_twins_have_a_contract_of_their_own(tmp_path):
    folder, _ = captured(tmp_path, BROWN, {**TILTED, "keep_undistorted": True})
    about = json.loads((folder / "camera.json").read_text())
    sets = read_dataset(folder).image_sets
    found = {name: one.contract(0) for name, one in sets.items()}
    assert found.pop("satellite") == CameraContract.from_json(about)
    (twin,) = found.values()
    assert twin == CameraContract.from_json({"schema": 1, **about["undistorted"]})
    assert (twin.lens, twin.distortion, twin.cx_px) == ("perspective", (), twin.width_px / 2.0)


def test_datasets_from_before_the_file_are_resumed(tmp_path):
    folder, made = captured(tmp_path, FISHEYE, TILTED)
    before = (folder / "camera.json").read_bytes()
    (folder / "camera.json").unlink()
    assert capture(made, open_source("world"), folder, resume=True).written == 0
    assert (folder / "camera.json").read_bytes() == before


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"fx_px": "", "cy_px": ""}, r"does not state its fx_px, cy_px"),
        ({"lens": "mirror"}, r"has lens 'mirror', and must have one of perspective, fisheye"),
        ({"k2": "much"}, r"has k2 'much', not a number"),
    ],
)
def test_tables_that_do_not_state_a_camera_are_refused(tmp_path, changed, message):
    folder, _ = captured(tmp_path, FISHEYE, TILTED)
    rows = [{**row, **changed} for row in rows_of(folder)]
    with (folder / "satellite" / "meta_data.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    with pytest.raises(InvalidInput, match=message):
        read_dataset(folder).image_set("satellite").contract(0)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_blocks_in_folders_and_stores_state_the_same(tmp_path, layout):
    pytest.importorskip("upath")
    whole, made = captured(tmp_path, BROWN, TILTED)
    for place in (tmp_path / "blocks", f"memory://{uuid4().hex}/run"):
        capture(made, named_source("world"), place, blocks=Blocks(2, layout))
        assert read_existing(store_path(place) / "camera.json", 1 << 20) == (whole / "camera.json").read_bytes()
        images = read_dataset(place).image_set("satellite")
        assert images.contract(2) == read_dataset(whole).image_set("satellite").contract(2)


def test_each_imagery_has_the_cameras_of_its_pixels(tmp_path):
    imageries = ("photo=world", "streets=world:roadmap")
    mission = Mission(Points(((LAT, LON, 60.0),)), 60.0, image_px=80, imageries=imageries, frame="camera")
    sources = {name: open_source("world") for name in mission.missions_by_imagery}
    plans = {name: plan(one, sources[name].grid) for name, one in mission.missions_by_imagery.items()}
    capture_imageries(mission, plans, sources, tmp_path / "out")
    for name, images in read_dataset(tmp_path / "out").image_sets.items():
        about = json.loads((tmp_path / "out" / name / "camera.json").read_text())
        assert CameraContract.from_json(about) == images.contract(0)
