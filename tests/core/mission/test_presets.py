"""Presets: values for a purpose, behind everything that a user says."""

from __future__ import annotations

import json

import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.cameras import camera_named
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.mission import flat_fields
from terrainav.core.mission.plan import plan
from terrainav.core.mission.presets import CAMERA_KINDS, PRESET_NAMES, PRESETS, camera_kind_values
from terrainav.core.mission.settings import build_mission, resolve

BOX = "35.16_-89.90_35.115_-89.823_120"


def asked(environment=None, config=None, **given):
    return build_mission(resolve({"coords": BOX, **given}, environment or {}, config))


@pytest.mark.parametrize("preset", PRESETS, ids=PRESET_NAMES)
def test_a_mission_has_every_value_of_its_preset(preset):
    mission = asked(preset=preset.name)
    values = {"aspect_ratio": mission.camera.aspect_ratio}
    values.update((one.name, getattr(part, one.name)) for part, one in parts_of(mission))
    assert {name: values[name] for name in preset.values} == dict(preset.values)
    # All else is as it is without a preset.
    plain = asked()
    changed = {one.name for part, one in parts_of(mission) if getattr(part, one.name) != dict_of(plain)[one.name]}
    assert changed <= {*preset.values, *(["image_px"] if preset.camera else ())}


@pytest.mark.parametrize(
    ("given", "image_px"),
    [
        ({}, 5280),
        ({"camera": "DJI Mini 2"}, 4000),
        ({"fov": "60"}, 640),
        ({"aspect_ratio": ["3", "2"]}, 640),
        ({"image_px": "1000"}, 1000),
    ],
)
def test_a_survey_is_of_a_real_camera_unless_one_is_asked_for(given, image_px):
    mission = asked(preset="mapping", **given)
    assert mission.pixels.image_px == image_px
    assert (mission.camera == camera_named("DJI Mavic 3E").camera) is (not given)


def parts_of(mission):
    for name in ("attitude", "flight", "imagery", "pixels", "accuracy", "terrain", "output"):
        part = getattr(mission, name)
        for one in flat_fields():
            if hasattr(part, one.name):
                yield part, one


def dict_of(mission):
    return {one.name: getattr(part, one.name) for part, one in parts_of(mission)}


def test_every_other_option_comes_before_the_preset(tmp_path):
    file = tmp_path / "config.json"
    file.write_text(json.dumps({"format": "png", "preset": "navigation"}))
    mission = asked({"TERRAINAV_OVERLAP": "0.8"}, str(file), preset="mapping", frame="camera")
    assert mission.flight.overlap_along == mission.flight.overlap_across == 0.8
    assert (mission.output.image_format, mission.accuracy.frame) == ("png", "camera")
    # The preset itself follows the same order.
    assert asked({}, str(file)).flight.overlap_along == 0.5
    assert asked({"TERRAINAV_PRESET": "learning"}, str(file)).output.img_size == (256, 256, 3)


@pytest.mark.parametrize(
    ("given", "size"),
    [
        ({"camera": "DJI Mini 2"}, (256, 192, 3)),
        ({"aspect_ratio": ["2", "3"]}, (171, 256, 3)),
        ({"sensor": ["36", "24"], "focal_length": "50"}, (256, 171, 3)),
        ({"fov": "60"}, (256, 256, 3)),
        ({"img_size": ["100", "50", "1"]}, (100, 50, 1)),
    ],
)
def test_images_to_learn_from_keep_the_shape_of_the_camera_that_is_asked_for(given, size):
    mission = asked(preset="learning", **given)
    assert mission.output.img_size == size
    if "img_size" not in given:
        assert mission.camera.aspect_ratio == pytest.approx(size[0] / size[1], rel=0.005)


def test_a_source_that_is_named_has_the_map_types_that_are_asked_for():
    assert asked(preset="learning").imagery.map_types == ("satellite", "roadmap")
    assert asked(preset="learning", source="osm").imagery.map_types == ("satellite",)
    assert asked(preset="learning", source="osm", map_type=["roadmap"]).imagery.map_types == ("roadmap",)
    assert asked(preset="learning", imagery=["a=world"]).imagery.imageries == ("a=world",)


def test_an_unknown_preset_is_refused():
    with pytest.raises(InvalidInput, match="must be one of mapping, navigation, learning"):
        resolve({"preset": "racing"}, {}, None)


@pytest.mark.parametrize("kind", CAMERA_KINDS, ids=[kind.name for kind in CAMERA_KINDS])
def test_a_kind_of_camera_takes_images_without_advice(kind, tmp_path):
    source = named_source("world").open()
    mission = asked().replace(area=Box(35.16, -89.90, 35.159, -89.898), image_px=64, **camera_kind_values(kind))
    made = plan(mission, source.grid)
    assert not any("vary" in text for text in estimate(made).warnings)
    result = capture(made, source, tmp_path)
    assert result.written == len(made) > 0
    stated = Table.load(tmp_path / "satellite" / "meta_data.csv").other
    assert bool(stated) == (kind.name != "ideal")
