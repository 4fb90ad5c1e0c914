"""Undistorted twins: the images of an ideal camera, which OpenCV's undistortion of the distorted images confirms."""

from __future__ import annotations

import json
import multiprocessing
import tarfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.label_images import LabelImages
from terrainav.core.dataset.loading.batches import LabelledImages
from terrainav.core.dataset.split import split
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.exports.formats import colmap
from terrainav.core.exports.views import Views
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mosaic.frames import place_images
from terrainav.core.picture.heights import mission_heights

from tests.support.rasters import write

SOURCE = named_source("world")
LENSES = {
    "barrel": Camera(70.0, k1=-0.25, k2=0.06, p1=1e-3, p2=-2e-3),
    "pincushion": Camera(60.0, k1=0.25, red_scale=0.002, blue_scale=-0.002),
    "off centre": Camera(60.0, k1=-0.1, principal_x=0.03, principal_y=-0.02),
    "fisheye": Camera(100.0, lens="fisheye", k1=0.02, k2=-0.01),
    "chromatic": Camera(60.0, red_scale=0.004),
}
PLACES = ((35.1412, -89.8656, 90.0), (35.1403, -89.864, 110.0))
TURNS = {"yaw_deg": 30.0, "tilt_deg": 25.0, "roll_deg": -5.0}
NOISE = {"image_sensor": "custom", "pixel_um": 3.0, "quantum_efficiency": 0.6, "full_well_e": 1e3, "read_noise_e": 40.0}
#: Ideal missions to which twins are equal.
WAYS = {
    "level": {},
    "rays": {"mesh": "rays", "error_budget_px": 0.01},
    "area": {"sampling": "area"},
    "moving": {"row_time_us": 60.0, "motion_blur": True, "exposure_ms": 8.0, "airspeed_m_per_s": 20.0},
    "hills": {"elevation": ("world",)},
    "hills, moving": {"elevation": ("world",), "row_time_us": 60.0, "airspeed_m_per_s": 20.0},
    "light": {"visibility_km": 2.0, "vignetting": "cos4", "mtf50": 0.3, **NOISE},
}


def planned(camera=LENSES["barrel"], area=None, **values):
    mission = Mission(area or Points(PLACES), 100.0, camera, **{"image_px": 96, "frame": "camera", **values})
    return plan(mission, SOURCE.grid, mission_heights(mission) if mission.terrain.elevation else None)


def twins(camera=LENSES["barrel"], **values):
    return planned(camera, keep_undistorted=True, **values)


def captured(made, folder, **options):
    assert capture(made, options.pop("source", None) or SOURCE.open(), folder, **options).failed == ()
    return folder


def table_of(folder, map_type="satellite_undistorted"):
    return Table.load(folder / map_type / "meta_data.csv")


def contents(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


def pixels(folder, map_type="satellite_undistorted"):
    return [
        np.asarray(Image.open(folder / map_type / name)).astype(float) for name in table_of(folder, map_type).img_names
    ]


@pytest.mark.parametrize(
    ("lens", "way"),
    [*(("barrel", way) for way in WAYS), *((lens, way) for lens in LENSES for way in ("level", "hills"))],
)
def test_twins_are_the_images_of_the_ideal_camera(tmp_path, lens, way):
    camera, values = LENSES[lens], {**TURNS, **WAYS[way]}
    captured(twins(camera, **values), tmp_path / "lens")
    ideal = Camera(2.0 * np.degrees(np.arctan(np.hypot(*camera.half_tangents))).item(), camera.aspect_ratio)
    captured(planned(ideal, **values), tmp_path / "ideal")
    found, wanted = pixels(tmp_path / "lens"), pixels(tmp_path / "ideal", "satellite")
    for one, other, real in zip(found, wanted, pixels(tmp_path / "lens", "satellite")):
        off = np.abs(one - other)
        # Relief is read as far as the lens sees, and its lowest height there settles the last digits of poses.
        assert (off > 1.0).mean() < 1e-3
        assert (off > 0.0).mean() <= (0.01 if "hills" in way else 0.0)
        assert (one != real).mean() > 0.02
    real, stated, of_ideal = (
        table_of(tmp_path / folder, name)
        for folder, name in (("lens", "satellite"), ("lens", "satellite_undistorted"), ("ideal", "satellite"))
    )
    assert stated.img_names == real.img_names
    assert {*stated.other} == {*of_ideal.other}
    for name in ("fx_px", "fy_px", "cx_px", "cy_px", "sky_share"):
        np.testing.assert_array_equal(getattr(stated, name), getattr(of_ideal, name))
    np.testing.assert_allclose(stated.entropies, of_ideal.entropies, rtol=1e-3 if "hills" in way else 0.0)
    # Windows are whole pixels of the source.
    rounded = 1.0 if "hills" in way else 0.0
    for name, most in (("lat_deg", 1e-7), ("lon_deg", 1e-7), ("left_px", rounded), ("top_px", rounded)):
        np.testing.assert_allclose(getattr(stated, name), getattr(of_ideal, name), rtol=0.0, atol=most)


@pytest.mark.parametrize("lens", ["barrel", "pincushion", "off centre", "fisheye"])
def test_opencv_undistorts_images_to_their_twins(tmp_path, lens):
    """Within what resampling twice changes, where the image shows all that the twin shows."""
    cv2 = pytest.importorskip("cv2")
    side, pixel_m, corner = 2000, 0.5, (499_500.0, 5_400_500.0)
    at = (np.arange(side) + 0.5) * pixel_m
    grey = 128.0 + 60.0 * np.sin(at / 9.0) + 60.0 * np.cos(at / 7.0)[:, np.newaxis]
    image = np.stack([np.rint(grey).astype(np.uint8)] * 3)
    write(tmp_path / "waves.tif", image, (corner[0], pixel_m, 0.0, corner[1], 0.0, -pixel_m), 32631)
    source = named_source(str(tmp_path / "waves.tif")).open()
    camera = replace(LENSES[lens], red_scale=0.0, blue_scale=0.0)
    place = Points(((48.7535, 3.0, 250.0),))
    mission = Mission(place, 250.0, camera, keep_undistorted=True, mesh="rays", image_px=640, upsample=True)
    made = plan(mission, source.grid)
    captured(made, tmp_path / "out", source=source)
    (seen,), (twin,) = (pixels(tmp_path / "out", name) for name in ("satellite", "satellite_undistorted"))
    (height, width), table = seen.shape[:2], table_of(tmp_path / "out", "satellite")
    stated = table_of(tmp_path / "out")
    # OpenCV counts from the centre of the first pixel.
    matrices = [
        np.array([[one.fx_px[0], 0.0, one.cx_px[0] - 0.5], [0.0, one.fy_px[0], one.cy_px[0] - 0.5], [0.0, 0.0, 1.0]])
        for one in (table, stated)
    ]
    if camera.lens == "fisheye":
        names, undistort = ("k1", "k2", "k3", "k4"), cv2.fisheye.initUndistortRectifyMap
    else:
        names, undistort = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"), cv2.initUndistortRectifyMap
    k = np.array([float(table.other[name][0]) for name in names])
    places = undistort(matrices[0], k, np.eye(3), matrices[1], (width, height), cv2.CV_32FC1)
    remapped = cv2.remap(seen[..., 0].astype(np.float32), *places, cv2.INTER_CUBIC)
    inside = (places[0] > 2) & (places[0] < width - 3) & (places[1] > 2) & (places[1] < height - 3)
    away = (remapped - twin[..., 0])[inside]
    assert inside.mean() > 0.85
    # Two roundings to whole numbers have a deviation of 0.41.
    assert away.std() < 0.5
    assert np.abs(away).max() < 3.0
    # How far the twin would have to be moved.
    slopes = np.stack([slope[inside] for slope in np.gradient(twin[..., 0])], axis=1)
    moved, *_ = np.linalg.lstsq(slopes, away, rcond=None)
    assert np.abs(moved).max() < 0.005


def test_each_twin_leaves_one_thing_out(tmp_path):
    """The light of the image is on the undistorted one, and its distortion in the clean one."""
    made = twins(keep_clean=True, **TURNS, **WAYS["light"])
    assert [one.name for one in sorted(captured(made, tmp_path).iterdir()) if one.is_dir()] == [
        "satellite",
        "satellite_clean",
        "satellite_undistorted",
    ]
    captured(planned(**TURNS), tmp_path / "clean")
    captured(planned(made.undistorted.mission.camera, **TURNS, **WAYS["light"]), tmp_path / "ideal")
    for map_type, wanted in (("satellite_clean", "clean"), ("satellite_undistorted", "ideal")):
        for one, other in zip(pixels(tmp_path, map_type), pixels(tmp_path / wanted, "satellite")):
            np.testing.assert_array_equal(one, other)
    real, clean_one, undistorted = (
        table_of(tmp_path, f"satellite{kind}").other for kind in ("", "_clean", "_undistorted")
    )
    assert {*real} - {*undistorted} == {"lens", *made.mission.camera.coefficients}
    assert undistorted["visibility_km"] == real["visibility_km"]
    assert "k1" in clean_one
    assert "visibility_km" not in clean_one


@pytest.mark.parametrize("blocks", [None, Blocks(2)])
def test_a_lost_twin_is_made_again(tmp_path, blocks):
    made, source = twins(keep_clean=True), SOURCE if blocks else SOURCE.open()
    captured(made, tmp_path, source=source, blocks=blocks)
    before = contents(tmp_path / "satellite_undistorted")
    next((tmp_path / "satellite_undistorted").glob("*.tif")).unlink()
    assert capture(made, source, tmp_path, blocks=blocks, resume=True).written == (2 if blocks else 1)
    assert contents(tmp_path / "satellite_undistorted") == before
    assert capture(made, source, tmp_path, blocks=blocks, resume=True).written == 0


@pytest.mark.parametrize("elevation", [(), ("world",)], ids=["level", "hills"])
def test_blocks_in_other_processes_have_the_same_twins(tmp_path, elevation):
    made = twins(LENSES["off centre"], elevation=elevation, row_time_us=60.0, airspeed_m_per_s=20.0, **TURNS)
    captured(made, tmp_path / "here")
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        captured(made, tmp_path / "there", source=SOURCE, executor=pool, blocks=Blocks(2))
    here, there = (contents(tmp_path / folder / "satellite_undistorted") for folder in ("here", "there"))
    assert here == there
    assert len(here) == len(PLACES) + 1


def test_shards_hold_twins_beside_the_others(tmp_path):
    made = twins(keep_clean=True)
    captured(made, tmp_path / "folders")
    captured(made, tmp_path / "shards", source=SOURCE, blocks=Blocks(100, layout="webdataset"))
    (path,) = (tmp_path / "shards" / "satellite").glob("*.tar")
    with tarfile.open(path) as tar:
        for map_type in ("satellite_clean", "satellite_undistorted"):
            found = [tar.extractfile(f"{index:09d}.{map_type}.tif").read() for index in range(len(made))]
            assert found == [(tmp_path / "folders" / map_type / f"{name}.tif").read_bytes() for name in made.names]


def test_random_values_are_those_of_the_image(tmp_path):
    values = {"vary": ("visibility_km=uniform(1,9)", "agl_m=uniform(80,130)"), **TURNS}
    made = twins(**values)
    captured(made, tmp_path / "lens")
    captured(planned(made.undistorted.mission.camera, **values), tmp_path / "ideal")
    for one, other in zip(pixels(tmp_path / "lens"), pixels(tmp_path / "ideal", "satellite")):
        np.testing.assert_array_equal(one, other)
    real = table_of(tmp_path / "lens", "satellite")
    assert table_of(tmp_path / "lens").other["visibility_km"] == real.other["visibility_km"]


def test_lenses_that_vary_have_twins_of_their_focal_length(tmp_path):
    """Also where some images, or the mission's own lens, do not distort."""
    values = {"visibility_km": 5.0, **TURNS}
    made = twins(Camera(60.0), vary=("k1=choice(0,-0.2)", "fov_deg=uniform(50,70)"), seed=4, **values)
    captured(made, tmp_path / "lens")
    distorts = [made.camera(index).distorts for index in range(len(made))]
    assert {*distorts} == {False, True}
    twin, real = (pixels(tmp_path / "lens", name) for name in ("satellite_undistorted", "satellite"))
    for index, (place, is_distorted) in enumerate(zip(PLACES, distorts)):
        ideal = made.camera(index).undistorted
        folder = captured(planned(ideal, area=Points((place,)), **values), tmp_path / str(index))
        (wanted,) = pixels(folder, "satellite")
        np.testing.assert_array_equal(twin[index], wanted)
        assert (twin[index] != real[index]).any() == is_distorted
    assert "k1" not in table_of(tmp_path / "lens").other
    np.testing.assert_array_equal(table_of(tmp_path / "lens").fx_px, table_of(tmp_path / "lens", "satellite").fx_px)


def test_files_for_other_programs_state_the_ideal_camera(tmp_path):
    camera = LENSES["off centre"]
    captured(twins(camera, image_format="jpg"), tmp_path)
    lens, ideal = (
        json.loads((tmp_path / name / "cameras.json").read_text()) for name in ("satellite", "satellite_undistorted")
    )
    assert [one["k1"] for one in lens.values()] == [-0.1]
    (stated,) = ideal.values()
    assert [stated[name] for name in ("k1", "k2", "p1", "p2", "c_x", "c_y")] == [0.0] * 6
    assert stated["focal_x"] == next(iter(lens.values()))["focal_x"]
    # Opened by the name that the tags of the image have.
    path = next((tmp_path / "satellite_undistorted").glob("*.jpg"))
    assert b"FOV 60 deg, 1.33333 to 1 (simulated)" in path.read_bytes()
    views = Views.read(tmp_path, "satellite_undistorted")
    (line,) = colmap(views, tmp_path)["sparse/0/cameras.txt"].splitlines()[1:]
    focal = 96 / 2.0 / camera.half_tangents[0]
    number, model, *numbers = line.split()
    assert (number, model) == ("1", "PINHOLE")
    np.testing.assert_allclose([float(one) for one in numbers], [96, 72, focal, focal, 48, 36], rtol=1e-12)
    (line,) = colmap(Views.read(tmp_path, "satellite"), tmp_path)["sparse/0/cameras.txt"].splitlines()[1:]
    assert line.startswith("1 OPENCV 96 72 ")


def test_mosaics_of_twins_have_no_distortion(tmp_path):
    captured(twins(), tmp_path)
    frames = [place_images(tmp_path, name)[0] for name in ("satellite", "satellite_undistorted")]
    assert [one.cameras.of(0) for one in frames] == [LENSES["barrel"], LENSES["barrel"].undistorted]


def test_twins_are_loaded_and_cleaned_in_pairs(tmp_path):
    captured(twins(area=Box(35.1412, -89.8656, 35.139, -89.862)), tmp_path)
    read = read_dataset(tmp_path)
    assert list(read.image_sets) == ["satellite", "satellite_undistorted"]
    split(tmp_path, (0.5, 0.0, 0.5))
    chosen = {"part": "train", "img_size": (16, 12, 3), "augment": None}
    real, twin = (LabelledImages(tmp_path, map_type=name, **chosen) for name in read.image_sets)
    assert real.names == twin.names
    np.testing.assert_array_equal(real.order(3), twin.order(3))
    threshold = float(np.median(table_of(tmp_path, "satellite").entropies))
    clean(tmp_path, threshold=threshold)
    marks = [[bool(mark) for mark in table_of(tmp_path, name).other["rejected"]] for name in read.image_sets]
    assert any(marks[0])
    assert marks[0] == marks[1]


def test_labels_of_the_image_are_not_those_of_its_twin(tmp_path):
    captured(twins(products=("depth",)), tmp_path)
    images = read_dataset(tmp_path).image_set("satellite_undistorted")
    with pytest.raises(InvalidInput, match="satellite_undistorted: labels are those of the images with distortion"):
        _ = LabelImages(images).classes


def test_a_fisheye_that_sees_180_degrees_has_a_twin():
    """With its focal length, an ideal image of the same size shows less."""
    camera = Camera(179.0, lens="fisheye")
    assert camera.undistorted.fov_deg == pytest.approx(2.0 * np.degrees(np.arctan(np.radians(179.0) / 2.0)))
    assert twins(camera).undistorted.corners.hit.all()


def test_estimates_count_twins():
    alone, kept, both = (estimate(made) for made in (planned(), twins(), twins(keep_clean=True)))
    assert kept.output_bytes == pytest.approx(2.0 * alone.output_bytes, abs=1.0)
    assert both.output_bytes == pytest.approx(3.0 * alone.output_bytes, abs=1.0)
    # The axis is at the edge of the image, and so is the middle of the twin.
    values = {"camera": Camera(60.0, principal_x=0.5), "image_px": 640}
    assert planned(**values).requests < twins(**values).requests < 2 * planned(**values).requests


def test_a_lens_that_does_not_distort_has_no_twin():
    with pytest.raises(InvalidInput, match="undistorted images: the lens does not distort") as refused:
        twins(Camera(60.0))
    assert refused.value.field == "keep_undistorted"
    with pytest.raises(InvalidInput, match="image 'map' was asked for"):
        twins(frame="map")
