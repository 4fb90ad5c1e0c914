"""What is made from the declared fields of a mission: the schema of its files, and the page of options."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import jsonschema
import pytest
from hypothesis import given, settings
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission

from tests.support.missions import TRIANGLE, missions
from tests.support.thinning import examples

ROOT = Path(__file__).resolve().parents[1]
PLAIN = json.loads(Mission(Box(35.16, -89.90, 35.115, -89.823), 120.0).to_json())


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("options", ROOT / "tools" / "options.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def schema():
    published = json.loads((ROOT / "resources" / "mission.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(published)
    return jsonschema.Draft202012Validator(published)


def test_files_are_what_the_tool_writes(tool):
    advice = "run `python tools/options.py`"
    assert tool.SCHEMA_FILE.read_text(encoding="utf-8") == tool.schema_text(), advice
    assert tool.PAGE.read_text(encoding="utf-8") == tool.page(), advice


@settings(max_examples=examples(50))
@given(missions)
def test_what_is_written_is_of_the_schema(schema, mission):
    schema.validate(json.loads(mission.to_json()))


def test_no_fly_areas_are_of_the_schema(schema):
    written = json.loads(Mission(TRIANGLE, 120.0, no_fly=(TRIANGLE,)).to_json())
    schema.validate(written)
    for wrong in ([{"rings": []}], [{}], [{"rings": [[[0, 0], [1, 1]]]}], {"rings": []}):
        assert not schema.is_valid({**written, "no_fly": wrong})


def changed(part, **values):
    return {**PLAIN, part: {**PLAIN.get(part, {}), **values}}


@pytest.mark.parametrize(
    "data",
    [
        {**PLAIN, "schema": 2},
        {**PLAIN, "colour": 1},
        {name: part for name, part in PLAIN.items() if name != "flight"},
        {**PLAIN, "area": {"type": "disc"}},
        {**PLAIN, "area": {"type": "box", "north_deg": 91, "west_deg": 0, "south_deg": 0, "east_deg": 1}},
        {**PLAIN, "area": {"type": "points", "poses": [[1, 2, 0]]}},
        {**PLAIN, "area": {"type": "points", "poses": []}},
        {**PLAIN, "area": {"type": "polygon", "rings": [[[0, 0], [1, 1]]]}},
        {**PLAIN, "camera": {"fov_deg": 180}},
        {**PLAIN, "camera": 1},
        {**PLAIN, "wind": {"turbulence": -1}},
        {**PLAIN, "wind": {"seed": 1.5}},
        changed("flight", agl_m=0),
        changed("flight", agl_m=None),
        changed("flight", agl_m="high"),
        changed("flight", agl_m=True),
        changed("flight", overlap_along=1),
        changed("flight", layout="spiral"),
        changed("flight", crosshatch=1),
        changed("flight", start="2024-06-21"),
        changed("flight", colour=1),
        changed("attitude", tilt_deg=181),
        changed("imagery", map_types=[]),
        changed("imagery", map_types=["hybrid"]),
        changed("imagery", map_types=["terrain", "terrain"]),
        changed("imagery", map_types="terrain"),
        changed("imagery", source=""),
        changed("imagery", seed=2**64),
        changed("pixels", zoom=1.5),
        changed("pixels", zoom=3, gsd_m_per_px=1),
        changed("pixels", image_px=0),
        changed("accuracy", error_budget_px=0),
        changed("accuracy", frame="round"),
        changed("output", img_size=[5, 5]),
        changed("output", img_size=[5, 5, 2]),
        changed("output", img_size=[0, 5, 3]),
        changed("output", max_images=0),
    ],
    ids=lambda data: json.dumps({name: part for name, part in data.items() if PLAIN.get(name) != part})[:60],
)
def test_what_is_refused_is_not_of_the_schema(schema, data):
    assert not schema.is_valid(data)
    with pytest.raises(InvalidInput):
        Mission.from_dict(data)


@pytest.mark.parametrize(
    "data",
    [
        PLAIN,
        {"schema": 1, "area": PLAIN["area"], "flight": {"agl_m": 120}},
        {**PLAIN, **dict.fromkeys(("camera", "wind", "imagery", "pixels", "accuracy", "output", "attitude"))},
        changed("accuracy", frame=None, mesh=None),
        changed("pixels", zoom=3, gsd_m_per_px=None),
        changed("pixels", zoom=17.0),
        changed("imagery", map_types=None, seed=2**64 - 1),
        changed("output", img_size=[256, 256, 1]),
        {**PLAIN, "wind": {}},
    ],
    ids=range(9),
)
def test_what_is_read_is_of_the_schema(schema, data):
    schema.validate(data)
    Mission.from_dict(data)
