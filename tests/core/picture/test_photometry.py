"""Exposure, vignetting, haze, white balance and tone of captured images, measured in the files."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from osgeo import gdal
from PIL import Image
from pyproj import Transformer
from terrainav.core.bands import Bands
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import Air, CameraOptics, ExposureControl
from terrainav.core.mission.plan import plan
from terrainav.core.picture.effects import check_bands, effects
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.photometry import exposure_s
from terrainav.core.picture.products import products, sighting
from terrainav.core.picture.scene import Light, PictureScene
from terrainav.core.picture.shot import make_shot

from tests.support import rasters
from tests.support.photos import exiftool

#: Place of the rasters' centres, in UTM zone 32 and on its central meridian.
EAST, NORTH, EPSG = 500_000.0, 5_300_000.0, 32632
LAT, LON = Transformer.from_crs(EPSG, 4326).transform(EAST, NORTH)
STEP_PX = 128
#: The steps in their raster.
SHOWN = np.s_[256:-256, 256:-256]


def light_of(values):
    """Linear light of sRGB values of 8 bits, by the formula of IEC 61966-2-1."""
    share = np.asarray(values, np.float64) / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def assert_nearest(values, light):
    """Check that sRGB values of 8 bits are those nearest to linear light."""
    shown = 255.0 * np.where(light <= 0.0031308, light * 12.92, 1.055 * np.maximum(light, 1e-9) ** (1.0 / 2.4) - 0.055)
    assert np.abs(values - shown).max() < 0.5 + 2e-3


def raster(folder, values, pixel_m, name="field"):
    """A raster (h, w) or (bands, h, w) about the place."""
    values = np.asarray(values, np.uint8)
    values = np.stack([values] * 3) if values.ndim == 2 else values
    height, width = values.shape[1:]
    transform = (EAST - width / 2 * pixel_m, pixel_m, 0.0, NORTH + height / 2 * pixel_m, 0.0, -pixel_m)
    return str(rasters.write(folder / f"{name}.tif", values, transform, EPSG))


def mission_of(source, agl_m, fov_deg=60.0, **values):
    values = {"image_px": 640, "upsample": True, "source": source, **values}
    return Mission(Points(((LAT, LON, agl_m),)), agl_m, Camera(fov_deg, 4.0 / 3.0), **values)


def captured(folder, mission):
    """The image (h, w, 3) of a mission of one, and its row of the table."""
    source = open_source(mission.imagery.source)
    planned = plan(mission, source.grid, mission_heights(mission))
    assert not capture(planned, source, folder).failed
    (path,) = (one for one in folder.glob("satellite/*.*") if one.suffix in (".tif", ".jpg", ".png"))
    other = Table.load(folder / "satellite" / "meta_data.csv").other
    return np.asarray(Image.open(path))[..., :3], {name: cells[0] for name, cells in other.items()}


# --- exposure


@pytest.fixture(scope="module")
def steps(tmp_path_factory):
    """Sixteen grey steps in squares, each of many values about its mean so that means are finer than 8 bits."""
    base = np.linspace(20, 235, 16).reshape(4, 4).repeat(STEP_PX, axis=0).repeat(STEP_PX, axis=1)
    values = np.pad(np.rint(base + np.random.default_rng(1).uniform(-15.0, 15.0, base.shape)), 256, constant_values=90)
    return raster(tmp_path_factory.mktemp("steps"), values, 1.0), values


def step_means(values):
    """Mean light of each step (16, channels) of the raster."""
    light = light_of(values[SHOWN])
    return light.reshape(4, STEP_PX, 4, STEP_PX, -1).mean(axis=(1, 3)).reshape(16, -1)


def captured_steps(folder, steps, **values):
    """The image of the steps in the places of the raster's pixels, and its row of the table."""
    source, whole = steps
    mission = mission_of(source, 760.0, image_px=700, **values)
    planned = plan(mission, open_source(source).grid)
    assert planned.frames.on_map
    image, facts = captured(folder, mission)
    left, top, width, height = (int(one[0]) for one in planned.windows)
    assert image.shape == (height, width, 3)
    assert height > 4 * STEP_PX
    placed = np.zeros((*whole.shape, 3), np.uint8)
    placed[top : top + height, left : left + width] = image
    return placed, facts


def exposed_share(exposure_ms, f_number=5.6, iso=100.0):
    """White has 80,000 lx / pi; 0.65 L t / N² lux seconds are compared with 78 / ISO."""
    return 0.65 * 80_000.0 / math.pi * exposure_ms / 1000.0 / f_number**2 * iso / 78.0


@pytest.mark.parametrize(("exposure_ms", "f_number", "iso"), [(0.5, 5.6, 100.0), (0.25, 4.0, 50.0), (1.2, 8.0, 200.0)])
def test_a_raster_of_grey_steps_comes_out_linear(steps, tmp_path, exposure_ms, f_number, iso):
    settings = {"exposure": "manual", "exposure_ms": exposure_ms, "f_number": f_number, "iso": iso}
    image, facts = captured_steps(tmp_path, steps, **settings)
    share = exposed_share(exposure_ms, f_number, iso)
    assert share < 1.0
    # Of full scale, as the linearity error of EMVA 1288; and each pixel has the value nearest to its light.
    assert np.abs(step_means(image) - share * step_means(steps[1])).max() < 1e-3 * share
    assert_nearest(image[SHOWN], share * light_of(steps[1])[SHOWN][..., np.newaxis])
    assert (facts["exposure"], float(facts["exposure_ms"]), float(facts["iso"])) == ("manual", exposure_ms, iso)


@pytest.mark.parametrize("metering", ["average", "highlights"])
@pytest.mark.parametrize("exposure", ["time", "iso"])
def test_a_meter_exposes_as_it_says(steps, tmp_path, exposure, metering):
    settings = {"exposure": exposure, "exposure_ms": 0.05, "f_number": 4.0, "metering": metering}
    image, facts = captured(tmp_path, mission_of(steps[0], 900.0, **settings))
    light = light_of(image)
    if metering == "average":
        luminance = light @ [0.2126, 0.7152, 0.0722]
        assert np.exp(np.log(luminance).mean()) == pytest.approx(0.18, rel=0.02)
    else:
        assert np.mean((image == 255).any(axis=2)) == pytest.approx(0.01, abs=0.01)
        assert np.quantile(image.max(axis=2), 0.97) > 240
    changed, kept = ("exposure_ms", "iso") if exposure == "time" else ("iso", "exposure_ms")
    assert float(facts[kept]) == {"exposure_ms": 0.05, "iso": 100.0}[kept]
    share = exposed_share(float(facts["exposure_ms"]), 4.0, float(facts["iso"]))
    ideal, _ = captured(tmp_path / "ideal", mission_of(steps[0], 900.0))
    below = light_of(ideal) * share < 0.98
    assert (light[below] / light_of(ideal)[below]).mean() == pytest.approx(share, rel=2e-3)
    assert facts["exposure"] == exposure
    assert changed in facts


@pytest.mark.parametrize(
    ("values", "limit"),
    [
        ({"exposure": "time", "shortest_exposure_ms": 5.0}, ("exposure_ms", 5.0)),
        ({"exposure": "time", "longest_exposure_ms": 0.2}, ("exposure_ms", 0.2)),
        ({"exposure": "iso", "exposure_ms": 0.01, "highest_iso": 800.0}, ("iso", 800.0)),
        ({"exposure": "iso", "exposure_ms": 10.0, "iso": 50.0}, ("iso", 50.0)),
    ],
)
def test_a_meter_keeps_its_limits(steps, tmp_path, values, limit):
    _, facts = captured(tmp_path, mission_of(steps[0], 900.0, image_px=64, **values))
    assert float(facts[limit[0]]) == limit[1]


def test_exposure_time_is_stated_or_that_of_white():
    assert exposure_s(mission_of("world", 100.0, exposure_ms=4.0)) == 0.004
    asked = {"f_number": 8.0, "iso": 200.0, "illuminance_lx": 10_000.0}
    assert 0.65 * 10_000.0 / math.pi * exposure_s(mission_of("world", 100.0, **asked)) / 64.0 == pytest.approx(0.39)


# --- vignetting


@pytest.fixture(scope="module")
def white(tmp_path_factory):
    return raster(tmp_path_factory.mktemp("white"), np.full((600, 600), 250), 20.0)


def angles(fov_deg, height, width, *_):
    """Tangents (h, w) of the angles between the axis of a pinhole camera and the middles of its pixels."""
    focal_px = math.hypot(width, height) / 2.0 / math.tan(math.radians(fov_deg) / 2.0)
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    return np.hypot(x, y) / focal_px


def rings(radius, count=8):
    """Masks of equally wide rings about the middle of an image."""
    number = np.minimum((radius / radius.max() * count).astype(int), count - 1)
    return [number == ring for ring in range(count)]


@pytest.mark.parametrize("tilt_deg", [0.0, 20.0])
def test_light_falls_off_by_the_fourth_power_of_the_cosine(white, tmp_path, tilt_deg):
    asked = {"vignetting": "cos4", "frame": "camera", "tilt_deg": tilt_deg}
    image, facts = captured(tmp_path, mission_of(white, 500.0, 100.0, **asked))
    tangent = angles(100.0, *image.shape)
    wanted = light_of(250) * np.cos(np.arctan(tangent)) ** 4
    assert_nearest(image, wanted[..., np.newaxis])
    for ring in rings(tangent):
        assert light_of(image[ring]).mean() == pytest.approx(wanted[ring].mean(), rel=1e-3)
    assert facts["vignetting"] == "cos4"


def test_light_falls_off_by_a_polynomial(white, tmp_path):
    asked = {"vignetting": "-0.4 0.2 -0.1", "frame": "camera"}
    image, _ = captured(tmp_path, mission_of(white, 500.0, 70.0, **asked))
    r = angles(70.0, *image.shape) / math.tan(math.radians(35.0))
    wanted = light_of(250) * (1.0 - 0.4 * r**2 + 0.2 * r**4 - 0.1 * r**6)
    assert_nearest(image, wanted[..., np.newaxis])
    for ring in rings(r):
        assert light_of(image[ring]).mean() == pytest.approx(wanted[ring].mean(), rel=1e-3)


def test_a_lens_that_distorts_dims_by_the_true_angle(white, tmp_path):
    """Of an equidistant fisheye, whose angles are proportional to the distance from the middle."""
    camera = Camera(120.0, 4.0 / 3.0, lens="fisheye")
    mission = mission_of(white, 500.0, vignetting="cos4", frame="camera").replace(camera=camera)
    image, _ = captured(tmp_path, mission)
    height, width, _ = image.shape
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    angle = np.hypot(x, y) / math.hypot(width / 2, height / 2) * math.radians(60.0)
    wanted = light_of(250) * np.cos(angle) ** 4
    assert_nearest(image, wanted[..., np.newaxis])
    for ring in rings(angle):
        assert light_of(image[ring]).mean() == pytest.approx(wanted[ring].mean(), rel=1e-3)


# --- haze


def ranges_m(tilt_deg, agl_m, height, width, *_, fov_deg=60.0):
    """Distances (h, w) along the rays of a tilted camera to the ellipsoid, in Earth-centred coordinates."""
    focal_px = math.hypot(width, height) / 2.0 / math.tan(math.radians(fov_deg) / 2.0)
    x, y = np.meshgrid(
        (np.arange(width) + 0.5 - width / 2) / focal_px, (height / 2 - np.arange(height) - 0.5) / focal_px
    )
    sin, cos = math.sin(math.radians(tilt_deg)), math.cos(math.radians(tilt_deg))
    enu = np.stack([x, cos * y + sin, sin * y - cos], axis=-1)
    enu /= np.linalg.norm(enu, axis=-1, keepdims=True)
    lat, lon = math.radians(LAT), math.radians(LON)
    east = [-math.sin(lon), math.cos(lon), 0.0]
    north = [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)]
    up = [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]
    rays = enu @ np.array([east, north, up])
    place = np.array(Transformer.from_crs(4979, 4978).transform(LAT, LON, agl_m))
    # The ellipsoid as the unit sphere.
    axes = np.array([6_378_137.0, 6_378_137.0, 6_356_752.314245])
    rays, place = rays / axes, place / axes
    square, half, excess = (rays**2).sum(-1), rays @ place, place @ place - 1.0
    with np.errstate(invalid="ignore"):
        found = (-half - np.sqrt(half**2 - square * excess)) / square
    return np.where(np.isfinite(found) & (found > 0.0), found, np.inf)


@pytest.fixture(scope="module")
def halves(tmp_path_factory):
    """White ground east of the camera, and black ground west of it, for 60 km to the north."""
    values = np.zeros((1200, 1200))
    values[:, 600:] = 255
    return raster(tmp_path_factory.mktemp("halves"), values, 100.0)


@pytest.mark.parametrize("visibility_km", [4.0, 15.0])
def test_contrast_at_ten_ranges_is_koschmieders(halves, tmp_path, visibility_km):
    agl_m, tilt_deg = 200.0, 84.0
    asked = {"visibility_km": visibility_km, "airlight": "180 190 200", "tilt_deg": tilt_deg, "frame": "camera"}
    image, facts = captured(tmp_path, mission_of(halves, agl_m, **asked))
    light, range_m = light_of(image), ranges_m(tilt_deg, agl_m, *image.shape)
    # 5 % of the contrast is left at the visibility (WMO).
    left = 0.05 ** (range_m / 1000.0 / visibility_km)
    middle = image.shape[1] // 2
    # The border of the two halves is as wide as a pixel of the raster, 100 m, at 500 m and more.
    west, east = slice(0, middle - 100), slice(middle + 100, None)
    for rows in np.array_split(np.flatnonzero((left[:, middle] > 0.1) & (range_m[:, middle] > 0.0)), 10):
        dark, bright = (light[rows, side].mean(axis=(0, 1)) for side in (west, east))
        assert bright - dark == pytest.approx(np.full(3, left[rows, east].mean()), rel=5e-3)
        assert dark == pytest.approx(light_of([180, 190, 200]) * (1.0 - left[rows, west].mean()), rel=5e-3)
    assert (image[np.isinf(range_m)] == [180, 190, 200]).all()
    assert np.isinf(range_m).mean() > 0.1
    assert (float(facts["visibility_km"]), facts["airlight"]) == (visibility_km, "180 190 200")


@pytest.mark.parametrize("tilt_deg", [0.0, 35.0, 80.0])
def test_ranges_are_those_to_the_ellipsoid(halves, tilt_deg):
    mission = mission_of(halves, 400.0, tilt_deg=tilt_deg, frame="camera")
    planned = plan(mission, open_source(halves).grid)
    scene = PictureScene(planned, 0, make_shot(planned, 0))
    assert scene.range_m == pytest.approx(ranges_m(tilt_deg, 400.0, *scene.range_m.shape), rel=1e-7)


@pytest.mark.parametrize("yaw_deg", [0.0, 90.0])
def test_ranges_of_map_frames_are_those_of_their_depth(white, yaw_deg):
    planned = plan(mission_of(white, 3000.0, yaw_deg=yaw_deg), open_source(white).grid)
    assert planned.frames.on_map
    scene = PictureScene(planned, 0, make_shot(planned, 0))
    right, down = scene.tangents
    depth_m = sighting(planned, 0, scene.size_px, scene.shot).depth_m
    assert scene.range_m == pytest.approx(depth_m * np.sqrt(1.0 + right**2 + down**2), rel=1e-6)


def test_ranges_end_at_buildings(tmp_path, white):
    """A tower of 60 m, 100 m ahead of a camera at 80 m that looks at its wall."""
    from_east_north = Transformer.from_crs(EPSG, 4326, always_xy=True)
    corners = [(-40, 100), (40, 100), (40, 140), (-40, 140), (-40, 100)]
    ring = [from_east_north.transform(EAST + east, NORTH + north) for east, north in corners]
    house = {"type": "Feature", "properties": {"HEIGHT": 60.0}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
    (tmp_path / "tower.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [house]}))
    flat = np.zeros((1, 100, 100))
    transform = (EAST - 2000.0, 40.0, 0.0, NORTH + 2000.0, 0.0, -40.0)
    heights = rasters.write(tmp_path / "flat.tif", flat, transform, EPSG, data_type=gdal.GDT_Float32)
    asked = {"elevation": (str(heights),), "buildings": (str(tmp_path / "tower.geojson"),), "tilt_deg": 60.0}
    mission = mission_of(white, 80.0, building_height_field="HEIGHT", image_px=160, **asked)
    planned = plan(mission, open_source(white).grid, mission_heights(mission))
    scene = PictureScene(planned, 0, make_shot(planned, 0))
    right, down = scene.tangents
    # The wall is a plane 100 m to the north; rays have the component sin(tilt) + up cos(tilt) along it.
    north = math.sin(math.radians(60.0)) - down * math.cos(math.radians(60.0))
    wall_m = 100.0 / north * np.sqrt(1.0 + right**2 + down**2)
    width, height = scene.size_px
    middle = np.s_[height * 15 // 32 : height * 17 // 32, width * 2 // 5 : width * 3 // 5]
    assert scene.range_m[middle] == pytest.approx(np.broadcast_to(wall_m, scene.range_m.shape)[middle], rel=1e-3)


@pytest.mark.parametrize("frame", ["camera", "rolling"])
def test_ranges_of_relief_are_those_of_its_depth(tmp_path, white, frame):
    east, north = np.meshgrid(np.linspace(-3.0, 3.0, 400), np.linspace(-3.0, 3.0, 400))
    hills = 150.0 * np.sin(east * 3.0) * np.cos(north * 2.0)
    transform = (EAST - 4000.0, 20.0, 0.0, NORTH + 4000.0, 0.0, -20.0)
    heights = rasters.write(tmp_path / "hills.tif", hills[np.newaxis], transform, EPSG, data_type=gdal.GDT_Float32)
    timed = {"row_time_us": 50.0} if frame == "rolling" else {}
    mission = mission_of(white, 500.0, tilt_deg=60.0, elevation=(str(heights),), image_px=160, **timed)
    planned = plan(mission.replace(products=("depth",)), open_source(white).grid, mission_heights(mission))
    scene = PictureScene(planned, 0, make_shot(planned, 0))
    ((_, depth),) = products(planned, 0, scene.size_px, scene.shot)
    wanted = depth[..., 0] * np.sqrt(1.0 + angles(60.0, *depth.shape) ** 2)
    seen = depth[..., 1] > 0
    assert seen.mean() > 0.6
    assert scene.range_m[seen] == pytest.approx(wanted[seen], rel=1e-6)
    assert np.isinf(scene.range_m[~seen]).all()


# --- white balance and tone

#: Light of a D65 scene in linear sRGB at white balances of 2,856, 4,500 and 7,500 K: sums of the rows of the matrices
#: that colour-science 0.4.7 gives for the adaptation of Bradford.
BALANCED = {
    4_500.0: (0.73960640, 1.03612300, 1.59478970),
    7_500.0: (1.07186672, 0.99294719, 0.87268283),
}


@pytest.mark.parametrize("temperature_k", BALANCED)
def test_grey_has_the_colour_of_the_white_balance(steps, tmp_path, temperature_k):
    asked = {"exposure": "manual", "exposure_ms": 0.5, "white_balance_k": temperature_k}
    image, facts = captured_steps(tmp_path, steps, **asked)
    share = exposed_share(0.5)
    wanted = step_means(steps[1]) * BALANCED[temperature_k]
    assert np.abs(step_means(image) / share - wanted).max() < 1e-3
    assert_nearest(image[SHOWN], share * light_of(steps[1])[SHOWN][..., np.newaxis] * BALANCED[temperature_k])
    assert float(facts["white_balance_k"]) == temperature_k


def test_linear_tone_makes_values_proportional_to_light(steps, tmp_path):
    image, facts = captured(tmp_path, mission_of(steps[0], 900.0, tone="linear"))
    ideal, _ = captured(tmp_path / "ideal", mission_of(steps[0], 900.0))
    assert np.abs(image - 255.0 * light_of(ideal)).max() < 0.5 + 1e-3
    assert facts["tone"] == "linear"


# --- what else is written


def exif_of(path):
    """Tags by number, as Pillow reads them."""
    with Image.open(path) as image:
        return dict(image.getexif().get_ifd(0x8769))


def test_exif_states_the_settings(steps, tmp_path):
    asked = {"exposure": "manual", "exposure_ms": 0.625, "f_number": 2.8, "iso": 160.0, "white_balance_k": 5000.0}
    captured(tmp_path, mission_of(steps[0], 900.0, image_format="jpg", **asked))
    (path,) = tmp_path.glob("satellite/*.jpg")
    tags = exif_of(path)
    # ExposureTime, FNumber, PhotographicSensitivity, ISOSpeed, ExposureMode and WhiteBalance, both manual.
    found = [float(tags[number]) for number in (33434, 33437, 34855, 34867, 41986, 41987)]
    assert found == pytest.approx([0.000625, 2.8, 160.0, 160.0, 1.0, 1.0])
    by_gdal = gdal.Open(str(path)).GetMetadata()
    assert by_gdal["EXIF_ExposureTime"].startswith("(0.000625")
    assert by_gdal["EXIF_FNumber"] == "(2.8)"
    assert by_gdal["EXIF_ISOSpeedRatings"] == "160"


def test_exiftool_reads_the_settings_of_a_meter(steps, tmp_path):
    _, facts = captured(tmp_path, mission_of(steps[0], 900.0, image_format="jpg", exposure="time"))
    (path,) = tmp_path.glob("satellite/*.jpg")
    (found,) = exiftool(path)
    assert found["ExifIFD:ExposureTime"] == pytest.approx(float(facts["exposure_ms"]) / 1000.0)
    assert (found["ExifIFD:FNumber"], found["ExifIFD:ISO"], found["ExifIFD:ExposureMode"]) == (5.6, 100, 0)
    assert "ExifIFD:WhiteBalance" not in found


def test_an_ideal_camera_has_no_effects_and_states_nothing(steps, tmp_path):
    mission = mission_of(steps[0], 900.0, image_format="jpg")
    assert effects(mission) == ()
    _, facts = captured(tmp_path, mission)
    assert facts == {}
    (path,) = tmp_path.glob("satellite/*.jpg")
    assert not {33434, 33437, 34855, 41986, 41987} & set(exif_of(path))


# --- bad input


@pytest.mark.parametrize(
    ("part", "values", "says"),
    [
        (Air, {"visibility_km": 0.0}, "visibility 0.0 km: must be above 0"),
        (Air, {"airlight": "white"}, "airlight 'white': must be red, green and blue from 0 to 255"),
        (Air, {"airlight": "256 0 0"}, "airlight '256 0 0': must be red, green and blue"),
        (CameraOptics, {"vignetting": "strong"}, "vignetting 'strong': must be none, cos4, or one to three coeff"),
        (CameraOptics, {"vignetting": "-1.5"}, r"must leave light up to the corner; -0.5 of it is left at r = 1"),
        (CameraOptics, {"vignetting": "-2.5 1.5"}, r"must leave light up to the corner"),
        (CameraOptics, {"vignetting": "5000"}, r"at most 2 times the light of the middle, not 5e\+03 at r = 1"),
        (CameraOptics, {"vignetting": "5 -5"}, r"not 2.25 at r = 0.71"),
        (CameraOptics, {"vignetting": "1 2 3 4"}, "must be none, cos4, or one to three coefficients"),
        (CameraOptics, {"vignetting": "1e999"}, "vignetting '1e999': must leave light"),
        (ExposureControl, {"exposure": "bright"}, "exposure 'bright': must be one of ideal, manual, time, iso"),
        (ExposureControl, {"f_number": 0.0}, "f-number 0.0: must be from 0.5 to 64"),
        (ExposureControl, {"iso": -100.0}, "sensitivity .ISO. -100.0: must be from 1"),
        (ExposureControl, {"white_balance_k": 500.0}, "white balance 500.0 K: must be from 2000 to 25000"),
        (ExposureControl, {"shortest_exposure_ms": 20.0}, "shortest exposure time 20 ms: must be at most the longest"),
        (ExposureControl, {"exposure": "iso", "iso": 9999.0}, "sensitivity ISO 9999: must be at most the highest one"),
        (ExposureControl, {"tone": "gamma"}, "tone curve 'gamma': must be one of srgb, linear, filmic"),
    ],
)
def test_bad_values_get_one_line(part, values, says):
    with pytest.raises(InvalidInput, match=says) as refused:
        part(**values)
    assert "\n" not in str(refused.value)
    assert refused.value.field in values


def test_coefficients_are_kept_in_one_form():
    assert CameraOptics(vignetting=" -.30  0.1 ").vignetting == "-0.3 0.1"
    assert CameraOptics(vignetting="1.0").falloff_terms == (1.0,)
    assert CameraOptics(vignetting="-3e-1 0.10") == CameraOptics(vignetting="-0.3 0.1")


@pytest.mark.parametrize("exposure", ["manual", "iso"])
def test_an_exposure_needs_its_time(exposure):
    with pytest.raises(InvalidInput, match=f"exposure {exposure}: needs an exposure time"):
        mission_of("world", 100.0, exposure=exposure)


def test_the_shutter_closes_before_the_next_image(white):
    area = Box(LAT + 0.01, LON - 0.01, LAT - 0.01, LON + 0.01)
    flown = Mission(area, 300.0, source=white, overlap_along=0.9, airspeed_m_per_s=20.0, frame="camera")
    grid = open_source(white).grid
    between_ms = 1000.0 * np.diff(plan(flown, grid).times_s).min()
    for values, named in (
        ({"exposure": "manual", "exposure_ms": between_ms + 1.0}, "exposure_ms"),
        ({"exposure": "time", "longest_exposure_ms": between_ms + 1.0}, "longest_exposure_ms"),
    ):
        with pytest.raises(InvalidInput, match=r"longer than the .* ms between two images") as refused:
            plan(flown.replace(**values), grid)
        assert refused.value.field == named
        plan(flown.replace(**{**values, named: between_ms - 1.0}), grid)
    # Without an effect on the images, a mission stays as it was.
    plan(flown.replace(exposure_ms=between_ms + 1.0), grid)


def test_white_balance_needs_colours():
    grey = Bands(("grey",), "uint8", (0,))
    check_bands(mission_of("world", 100.0, visibility_km=5.0), grey)
    with pytest.raises(InvalidInput, match="white balance 5000 K: needs red, green and blue"):
        check_bands(mission_of("world", 100.0, white_balance_k=5000.0), grey)


def test_light_of_one_channel_has_haze_and_exposure(white):
    asked = {"visibility_km": 5.0, "airlight": "100 150 200", "exposure": "manual", "exposure_ms": 0.7}
    mission = mission_of(white, 1000.0, frame="camera", **asked)
    planned = plan(mission, open_source(white).grid)
    scene = PictureScene(planned, 0, make_shot(planned, 0))
    light = Light(np.full((*scene.range_m.shape, 1), 0.6, np.float32), scene)
    for effect in effects(mission):
        effect.apply(light)
    left = 0.05 ** (ranges_m(0.0, 1000.0, *scene.range_m.shape) / 5000.0)
    # As bright as the airlight.
    air = light_of([100, 150, 200]) @ [0.2126, 0.7152, 0.0722]
    assert light.values[..., 0] == pytest.approx(exposed_share(0.7) * (0.6 * left + air * (1.0 - left)), rel=1e-5)
