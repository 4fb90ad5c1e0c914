"""Lenses that spread light: against exact transforms, and slanted edges captured through the whole chain."""

from __future__ import annotations

import csv
import math

import numpy as np
import pyproj
import pytest
from PIL import Image
from scipy import integrate, special
from terrainav.core.camera.light import encoded, linear
from terrainav.core.camera.optics import (
    cutoff_frequency,
    diffraction_contrast,
    gaussian_contrast,
    half_contrast,
    spread_light,
)
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.report.sharpness import edge_response

from tests.support.rasters import write

#: Centre of the raster, near the central meridian of UTM zone 31, its pixels in metres, and their number along a side.
EAST, NORTH, PIXEL_M, SIDE_PX = 500_000.0, 5_400_000.0, 0.04, 2700
LON, LAT = pyproj.Transformer.from_crs(32631, 4326, always_xy=True).transform(EAST, NORTH)
SLANT_DEG = 5.0


@pytest.fixture(scope="module")
def edge(tmp_path_factory):
    """Raster with an edge from 0.04 to 0.9 of white, each pixel the share of its area on either side."""
    at = (np.arange(SIDE_PX) + 0.5 - SIDE_PX / 2.0) * PIXEL_M
    turn = math.radians(SLANT_DEG)
    away = (at * math.cos(turn) - at[:, np.newaxis] * math.sin(turn)) / PIXEL_M
    light = 0.04 + 0.86 * np.clip(away + 0.5, 0.0, 1.0)
    path = tmp_path_factory.mktemp("edge") / "edge.tif"
    half = SIDE_PX / 2.0 * PIXEL_M
    corner = (EAST - half, PIXEL_M, 0.0, NORTH + half, 0.0, -PIXEL_M)
    write(path, np.stack([np.rint(255.0 * encoded(light)).astype(np.uint8)] * 3), corner, 32631)
    return named_source(str(path)).open()


def captured(source, folder, agl_m=60.0, **changes):
    """Linear light (h, w) of the captured image, and its row of the table."""
    changes = {"frame": "camera", "image_px": 240, "sampling": "area", **changes}
    mission = Mission(Points(((LAT, LON, agl_m),)), agl_m, **changes)
    assert not capture(plan(mission, source.grid), source, folder).failed
    (path,) = folder.glob("satellite/*.tif")
    (row,) = csv.DictReader((folder / "satellite" / "meta_data.csv").read_text().splitlines())
    return linear(np.asarray(Image.open(path), np.float64)[..., 1] / 255.0), row


@pytest.mark.parametrize("agl_m", [52.0, 72.0])
@pytest.mark.parametrize(
    ("changes", "contrast"),
    [
        ({"mtf50": 0.15}, lambda f: gaussian_contrast(f, 0.15)),
        ({"mtf50": 0.3}, lambda f: gaussian_contrast(f, 0.3)),
        ({"mtf50": 0.45}, lambda f: gaussian_contrast(f, 0.45)),
        ({"diffraction": True, "f_number": 8.0, "pixel_um": 2.4}, lambda f: diffraction_contrast(f, 2.4 / 8.0 / 0.555)),
        ({"diffraction": True, "f_number": 5.6, "pixel_um": 1.4}, lambda f: diffraction_contrast(f, 1.4 / 5.6 / 0.555)),
    ],
    ids=["0.15", "0.3", "0.45", "f8", "f5.6"],
)
def test_a_captured_edge_is_as_sharp_as_lens_and_pixels_together(edge, tmp_path, agl_m, changes, contrast):
    light, _ = captured(edge, tmp_path, agl_m, **changes)
    rows, columns = light.shape
    found = edge_response(light[rows // 2 - 75 : rows // 2 + 75, columns // 2 - 105 : columns // 2 + 105])
    assert abs(found.slant_deg - SLANT_DEG) < 0.1
    assert abs(found.mtf50 / half_contrast(contrast) - 1.0) < 0.02


def test_diffraction_is_the_transform_of_airys_disc():
    """Hankel transform of (2 J1(πrν)/(πrν))², with ν the cutoff frequency, by numerical integration."""
    cutoff = cutoff_frequency(8.0, 2.4)
    assert cutoff == pytest.approx(2.4 / 8.0 / 0.555)
    density = np.pi * cutoff**2 / 4.0
    # Beyond this radius the rings hold 0.1 % of the light.
    radius = np.linspace(1e-9, 400.0, 400_001)
    disc = (2.0 * special.j1(np.pi * radius * cutoff) / (np.pi * radius * cutoff)) ** 2
    for frequency in (0.05, 0.2, 0.4, 0.5, 0.6):
        value = radius * density * disc * special.j0(2.0 * np.pi * frequency * radius)
        wanted = 2.0 * np.pi * integrate.simpson(value, x=radius)
        assert float(diffraction_contrast(np.array(frequency), cutoff)) == pytest.approx(wanted, abs=2e-3)


def test_a_wave_keeps_the_contrast_of_the_lens():
    for period in (4, 8, 20):
        x = np.arange(240)
        wave = 0.5 + 0.3 * np.cos(2.0 * np.pi * (x + 0.5) / period)
        light = np.repeat(np.repeat(wave[np.newaxis, :, np.newaxis], 120, axis=0), 3, axis=2).astype(np.float32)
        spread_light(light, lambda f: gaussian_contrast(f, 0.2), None)
        wanted = 0.5 + (wave - 0.5) * gaussian_contrast(np.array(1.0 / period), 0.2)
        assert np.abs(light - wanted[:, np.newaxis])[:, 40:-40].max() < 1e-5


def test_even_light_stays_even_to_the_edges_and_beside_the_sky():
    rng = np.random.default_rng(2)
    for contrast in (lambda f: gaussian_contrast(f, 0.05), lambda f: diffraction_contrast(f, 0.4)):
        light = np.full((90, 130, 3), 0.6, np.float32)
        spread_light(light, contrast, None)
        assert np.abs(light - 0.6).max() < 1e-6
        shown = np.ones((90, 130), bool)
        shown[:30] = False
        shown[rng.integers(0, 90, 300), rng.integers(0, 130, 300)] = False
        light = np.where(shown[..., np.newaxis], np.float32(0.6), np.float32(0.0)).repeat(3, axis=2)
        spread_light(light, contrast, shown)
        assert np.abs(light[shown] - 0.6).max() < 1e-5
        assert not light[~shown].any()


def test_the_table_states_the_sharpness(edge, tmp_path):
    _, row = captured(edge, tmp_path / "stated", mtf50=0.3)
    assert float(row["mtf50"]) == pytest.approx(0.3)
    _, row = captured(edge, tmp_path / "found", diffraction=True, f_number=8.0, pixel_um=2.4)
    wanted = half_contrast(lambda f: diffraction_contrast(f, 2.4 / 8.0 / 0.555))
    assert float(row["mtf50"]) == pytest.approx(wanted, rel=1e-5)


def test_blur_is_stated_once_and_diffraction_needs_a_pitch():
    area = Points(((LAT, LON, 100.0),))
    with pytest.raises(InvalidInput, match="must be one of the two"):
        Mission(area, 100.0, mtf50=0.3, diffraction=True, pixel_um=3.0)
    with pytest.raises(InvalidInput, match="diffraction: needs the pixel pitch"):
        Mission(area, 100.0, diffraction=True)
    with pytest.raises(InvalidInput, match=r"must be from 0\.02 to 0\.5"):
        Mission(area, 100.0, mtf50=0.7)
