"""Images through a sensor: what a capture writes of them."""

from __future__ import annotations

import math
import tarfile

import numpy as np
import pytest
from osgeo import gdal
from PIL import Image
from scipy import constants
from terrainav.core.bands import Bands
from terrainav.core.camera.bayer import mosaic
from terrainav.core.camera.light import linear_of_bytes
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.effects import Development, check_bands
from terrainav.core.picture.scene import Light, PictureScene
from terrainav.core.picture.sensor import SensorReadout
from terrainav.core.picture.shot import make_shot

ALVIUM = "Allied Vision Alvium 1800 C-507m"
FRAMOS = "FRAMOS IMX900 low gain"
POSES = ((48.1, 11.5, 150.0), (48.1, 11.5001, 150.0))


@pytest.fixture
def source():
    return named_source("world").open()


def mission_of(poses=POSES, **values):
    return Mission(Points(poses), 150.0, Camera(60.0, 4.0 / 3.0), **{"image_px": 128, "frame": "camera", **values})


def captured(source, folder, mission):
    capture(plan(mission, source.grid), source, folder)
    return [np.asarray(Image.open(path)) for path in sorted(folder.glob("satellite/*.tif"))]


def raws(folder):
    """Raw values (h, w) or (bands, h, w)."""
    return [gdal.Open(str(path)).ReadAsArray() for path in sorted(folder.glob("raw/*.tif"))]


def test_a_sensor_without_noise_leaves_images_as_they_are(source, tmp_path):
    ideal = captured(source, tmp_path / "ideal", mission_of())
    figures = {"image_sensor": "custom", "pixel_um": 5.0, "quantum_efficiency": 1.0, "full_well_e": 1e7}
    fine = captured(source, tmp_path / "fine", mission_of(**figures))
    for before, after in zip(ideal, fine):
        # Only twelve bits, of which the darkest values of sRGB have less than one each.
        difference = np.abs(before[..., :3].astype(int) - after[..., :3])
        assert difference[before[..., :3] > 30].max() <= 1
        assert difference.max() <= 4
        assert (before[..., 3:] == after[..., 3:]).all()


def test_without_a_sensor_images_have_the_same_bytes(source, tmp_path):
    for name, values in (("ideal", {}), ("pitch", {"pixel_um": 3.45})):
        captured(source, tmp_path / name, mission_of(**values))
    for path in (tmp_path / "ideal").glob("satellite/*"):
        assert path.read_bytes() == (tmp_path / "pitch" / "satellite" / path.name).read_bytes()


def test_raw_values_are_kept_as_16_bits(source, tmp_path):
    ideal = captured(source, tmp_path / "ideal", mission_of())
    captured(source, tmp_path / "raw", mission_of(image_sensor=FRAMOS, products=("raw",), bayer="grbg"))
    for before, raw in zip(ideal, raws(tmp_path / "raw")):
        assert raw.dtype == np.uint16
        assert raw.shape == before.shape[:2]
        light = mosaic(linear_of_bytes(before[..., :3]), "grbg")
        wanted = 240.0 + 0.399 * 9458.0 * light
        # Shot noise, read noise, DSNU and PRNU.
        electrons = 9458.0 * light
        sigma = 0.399 * np.sqrt(electrons + 5.56**2 + 3.7**2 + (0.007 * electrons) ** 2 + 1.0 / 12.0 / 0.399**2)
        away = (raw - wanted) / sigma
        assert abs(away.mean()) < 5.0 / np.sqrt(away.size)
        assert away.std() == pytest.approx(1.0, abs=5.0 / np.sqrt(2.0 * away.size))


def test_noise_is_of_the_seed_and_the_image_alone(source, tmp_path):
    noisy = {"image_sensor": FRAMOS, "products": ("raw",)}
    captured(source, tmp_path / "both", mission_of(**noisy))
    captured(source, tmp_path / "one", mission_of(POSES[:1], **noisy))
    captured(source, tmp_path / "seed", mission_of(POSES[:1], seed=7, **noisy))
    both, one, other = (raws(tmp_path / name) for name in ("both", "one", "seed"))
    assert (both[0] == one[0]).all()
    assert (one[0] != other[0]).mean() > 0.9
    assert (both[0] != both[1]).mean() > 0.9


def test_the_table_states_what_the_sensor_did(source, tmp_path):
    captured(source, tmp_path, mission_of(image_sensor=ALVIUM))
    other = Table.load(tmp_path / "satellite" / "meta_data.csv").other
    assert [float(one) for one in other["gain_dn_per_e"]] == pytest.approx([4095.0 / 10_400.0] * 2, rel=1e-5)
    assert all(0.0 <= float(one) < 0.2 for one in other["saturated_share"])


def test_bayer_patterns_need_colours():
    mission = mission_of(image_sensor=ALVIUM, bayer="rggb")
    check_bands(mission, Bands(("red", "green", "blue")))
    with pytest.raises(InvalidInput, match="colour filters rggb: need red, green and blue, and the source gives grey"):
        check_bands(mission, Bands(("grey",), "uint8", (0,)))
    check_bands(mission_of(image_sensor=ALVIUM), Bands(("grey",), "uint8", (0,)))


def exposed(folder, iso, exposure_ms, **values):
    """Values of an even image under a sensor without patterns, and its facts."""
    mission = mission_of(
        POSES[:1],
        image_sensor=ALVIUM,
        products=("raw",),
        exposure="manual",
        exposure_ms=exposure_ms,
        iso=iso,
        f_number=8.0,
        illuminance_lx=50_000.0,
        **values,
    )
    made = plan(mission, named_source("world").open().grid)
    white = np.full((96, 128, 3), 255, np.uint8)
    development = Development.of(made, 0)
    pixels, facts, raw = development.develop(white, make_shot(made, 0), 3)
    return pixels, dict(facts), raw.values.astype(np.float64)


def test_exposed_light_gives_the_electrons_of_the_formula(tmp_path):
    # White reflects all light: 0.65 E/pi t/N² lux seconds on the sensor.
    lux_seconds = 0.65 * 50_000.0 / math.pi / 64.0 * 0.5e-3
    photons = lux_seconds / 683.0 / (constants.h * constants.c / 555e-9) * (3.45e-6) ** 2
    electrons = 0.64 * photons
    assert 2_000.0 < electrons < 5_000.0
    lowest = 78.0 / (10_400.0 / (electrons / lux_seconds))
    for iso in (lowest, 2.0 * lowest):
        pixels, facts, raw = exposed(tmp_path, iso, 0.5)
        gain = 4095.0 / 10_400.0 * iso / lowest
        assert facts["gain_dn_per_e"] == pytest.approx(gain, rel=1e-6)
        sigma = math.sqrt(electrons / raw.size)
        assert raw.mean() / gain == pytest.approx(electrons, abs=5.0 * sigma)
        noise = gain**2 * (electrons + 2.1**2) + 1.0 / 12.0
        assert raw.var() == pytest.approx(noise, rel=5.0 * math.sqrt(2.0 / raw.size))
        # 78/S lux seconds are white.
        share = lux_seconds * iso / 78.0
        assert linear_of_bytes(pixels).mean() == pytest.approx(share, rel=0.01)


def test_more_light_than_a_sensor_holds_is_white(tmp_path):
    pixels, facts, raw = exposed(tmp_path, 234.0, 5.0)
    assert facts["saturated_share"] == 1.0
    assert (pixels == 255).all()
    assert (raw == 4095.0).all()


def test_speeds_below_the_sensors_are_refused():
    mission = mission_of(image_sensor=ALVIUM, exposure="time", iso=100.0)
    with pytest.raises(InvalidInput, match=r"sensitivity ISO 100: below that of the image sensor; give 234 or more"):
        check_bands(mission, Bands(("red", "green", "blue")))
    check_bands(mission.replace(iso=234.0), Bands(("red", "green", "blue")))
    check_bands(mission_of(image_sensor=ALVIUM, iso=100.0), Bands(("red", "green", "blue")))


def test_any_blocks_make_the_same_images_and_raw_values(tmp_path):
    named = named_source("world")
    values = {"image_sensor": FRAMOS, "bayer": "gbrg", "products": ("raw",), "vary": ("read_noise_e=uniform(2,20)",)}
    made = plan(mission_of(**values, image_px=48), named.open().grid)
    capture(made, named.open(), tmp_path / "whole")
    capture(made, named, tmp_path / "blocks", blocks=Blocks(1))
    for folder in ("satellite", "raw"):
        whole, blocks = (
            {path.name: path.read_bytes() for path in (tmp_path / name / folder).iterdir()}
            for name in ("whole", "blocks")
        )
        assert whole == blocks
        assert len([name for name in whole if name.endswith(".tif")]) == 2
    capture(made, named, tmp_path / "shards", blocks=Blocks(2, layout="webdataset"))
    (shard,) = (tmp_path / "shards").glob("satellite/*.tar")
    with tarfile.open(shard) as members:
        kept = {name: members.extractfile(name).read() for name in members.getnames() if name.endswith(".raw.tif")}
    assert sorted(kept.values()) == sorted(path.read_bytes() for path in (tmp_path / "whole" / "raw").glob("*.tif"))


def test_imageries_of_one_place_have_noise_of_their_own():
    named = named_source("world").open()
    values = {"image_sensor": "custom", "pixel_um": 5.0, "quantum_efficiency": 0.5, "full_well_e": 5_000.0}

    def noise(map_type="satellite", **imagery):
        made = plan(mission_of(POSES[:1], **values, **imagery), named.grid)
        light = Light(np.full((96, 128, 3), 0.5, np.float32), PictureScene(made, 0, make_shot(made, 0), map_type))
        SensorReadout.of(made.mission).apply(light)
        return light.values.ravel()

    usual = noise()
    for other in (noise("roadmap"), noise(date="2014"), noise(source="other.tif")):
        assert abs(np.corrcoef(usual, other)[0, 1]) < 5.0 / math.sqrt(usual.size)
    assert (noise(source="here/naip.tif") == noise(source="C:\\there\\naip.tif")).all()
    assert (usual == noise()).all()
