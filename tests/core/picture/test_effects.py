"""Pictures on their way through a camera: what effects are given, and what is stated of them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from PIL import Image
from terrainav.core.bands import Bands
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.folder import JOURNAL_FILE
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture import effects
from terrainav.core.picture.shot import make_shot

HEIGHT_M = 150.0


class Halved:
    """Half of the light, and the farthest ground."""

    def apply(self, light):
        light.values *= np.float32(0.5)
        light.facts["farthest_m"] = float(light.scene.range_m.max())


@pytest.fixture
def source():
    return named_source("world").open()


@pytest.fixture
def halved(monkeypatch):
    monkeypatch.setattr(effects, "effects", lambda mission: (Halved(),))


def planned(source, tilt_deg, **values):
    camera = Camera(60.0, 4.0 / 3.0)
    mission = Mission(Points(((48.1, 11.5, HEIGHT_M),)), HEIGHT_M, camera, image_px=64, tilt_deg=tilt_deg, **values)
    return plan(mission, source.grid)


def image_of(folder):
    (path,) = folder.glob("satellite/*.tif")
    return np.asarray(Image.open(path))


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0])
def test_effects_change_linear_light(source, monkeypatch, tmp_path, tilt_deg):
    made = planned(source, tilt_deg, frame="camera")
    capture(made, source, tmp_path / "ideal")
    monkeypatch.setattr(effects, "effects", lambda mission: (Halved(),))
    capture(made, source, tmp_path / "half")
    ideal, half = image_of(tmp_path / "ideal"), image_of(tmp_path / "half")
    share = np.where(ideal / 255.0 <= 0.04045, ideal / 255.0 / 12.92, ((ideal / 255.0 + 0.055) / 1.055) ** 2.4) / 2.0
    wanted = np.where(share <= 0.0031308, share * 12.92, 1.055 * share ** (1.0 / 2.4) - 0.055) * 255.0
    assert np.abs(half - wanted).max() < 0.5 + 1e-3
    table = Table.load(tmp_path / "half" / "satellite" / "meta_data.csv")
    (stated,) = table.other["farthest_m"]
    tan = math.tan(math.radians(30.0))
    # The upper corners of the image are farthest.
    right, up = tan * 0.8, tan * 0.6
    down = math.cos(math.radians(tilt_deg)) - up * math.sin(math.radians(tilt_deg))
    wanted_m = HEIGHT_M / down * math.sqrt(1.0 + right**2 + up**2)
    assert float(stated) == pytest.approx(wanted_m, rel=0.02)
    assert "farthest_m" not in Table.load(tmp_path / "ideal" / "satellite" / "meta_data.csv").other


def test_facts_are_kept_when_a_capture_is_resumed(source, halved, tmp_path):
    made = planned(source, 0.0)
    capture(made, source, tmp_path)
    table = tmp_path / "satellite" / "meta_data.csv"
    before = table.read_bytes()
    (line,) = (tmp_path / JOURNAL_FILE).read_text().splitlines()
    assert set(json.loads(line)["facts"]) == {"farthest_m"}
    capture(made, source, tmp_path, resume=True)
    assert table.read_bytes() == before


def test_sky_has_no_end(source):
    made = planned(source, 80.0)
    scene = effects.PictureScene(made, 0, make_shot(made, 0))
    assert np.isinf(scene.range_m[0]).all()
    assert np.isfinite(scene.range_m[-1]).all()


def test_effects_need_colours(source, halved):
    bands = Bands(("red", "nir"), "uint16", (0,))
    with pytest.raises(InvalidInput, match="grey, or red, green and blue of 8 bits"):
        effects.check_bands(planned(source, 0.0).mission, bands)
