"""Missions: what they refuse, and their way through JSON."""

from __future__ import annotations

import copy
import dataclasses
import json
import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.fields import declared_fields
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission, flat_fields
from terrainav.core.mission.parts import FLAT_PARTS, Flight, utc_time

from tests.support.missions import SEVERAL, TRIANGLE, missions, whole_file, with_other

BOX = Box(35.16, -89.90, 35.115, -89.823)


@given(missions)
def test_a_mission_comes_back_from_json(mission):
    text = mission.to_json()
    assert Mission.from_json(text) == mission
    assert Mission.from_json(text).to_json() == text
    assert json.loads(text)["schema"] == 1


def test_a_mission_comes_back_from_a_file(tmp_path):
    mission = Mission(TRIANGLE, 120.0)
    mission.save(tmp_path / "m.json")
    assert Mission.load(tmp_path / "m.json") == mission
    assert [file.name for file in tmp_path.iterdir()] == ["m.json"]


def test_null_stands_for_the_default():
    needed = {
        "schema": 1,
        "area": {"type": "points", "poses": [[35, -89, 120]]},
        "flight": {"agl_m": 120},
    }
    whole = Mission.from_dict(needed)
    for missing, nulls in (("area", {"area": None}), ("agl_m", {"flight": {"agl_m": None}})):
        with pytest.raises(InvalidInput, match=f"mission without '{missing}'"):
            Mission.from_dict({**needed, **nulls})
    for name, part in FLAT_PARTS.items():
        for field in declared_fields(part):
            if not field.needed:
                given = {**needed.get(name, {}), field.name: None}
                assert Mission.from_dict({**needed, name: given}) == whole, field.name
        nulls = dict.fromkeys(field.name for field in declared_fields(part) if not field.needed)
        nulls.update({"agl_m": 120.0} if name == "flight" else {})
        assert Mission.from_dict({**whole.to_dict(), name: nulls}) == whole
    assert Mission.from_dict({**whole.to_dict(), **dict.fromkeys(("imagery", "output", "camera", "wind"))}) == whole


@pytest.mark.parametrize(
    ("name", "part", "field"),
    [
        pytest.param(name, part, field, id=f"{name}.{field.name}")
        for name, part in {"camera": Camera, "wind": Wind, **FLAT_PARTS}.items()
        for field in declared_fields(part)
        if not field.needed
    ],
)
def test_a_mission_file_holds_a_field_only_where_it_is_used(name, part, field):
    usual = Mission(BOX, 120.0)
    assert [*usual.to_dict()] == ["schema", "area", "flight"]
    assert usual.to_dict()["flight"] == {"agl_m": 120.0}
    values = with_other(field)
    given = {name: part(**values)} if name in ("camera", "wind") else values
    mission = usual.replace(**given)
    own = {one.name for one in declared_fields(part)}
    # What a field needs may be of another part.
    needed = {key: value for key, value in values.items() if key not in own}
    usual, values = usual.replace(**needed), {key: value for key, value in values.items() if key in own}
    of_part = {"agl_m": 120.0, **values} if name == "flight" else values
    assert mission.to_dict() == {**usual.to_dict(), name: of_part}
    assert Mission.from_json(mission.to_json()) == mission != usual
    unused = {one: value for one, value in of_part.items() if one not in values}
    assert Mission.from_dict({**mission.to_dict(), name: {**unused, field.name: field.default}}) == (
        usual if name != "wind" else usual.replace(wind=Wind())
    )


def test_a_mission_file_that_states_every_default_is_read():
    for mission in (
        Mission(BOX, 120.0),
        Mission(BOX, 120.0, wind=Wind()),
        Mission(SEVERAL, 80.0, no_fly=(TRIANGLE,)),
    ):
        whole = json.loads(json.dumps(whole_file(mission)))
        assert {*whole["accuracy"]} == {field.name for field in declared_fields(FLAT_PARTS["accuracy"])}
        assert Mission.from_dict(whole) == mission == Mission.from_json(mission.to_json())
    points = Points(((35.0, -89.0, 120.0), (35.1, -89.0, 120.0)), tilts_deg=(1.0, 2.0))
    assert [*Mission(points, 120.0).to_dict()["area"]] == ["type", "poses", "tilts_deg"]


def test_a_mission_is_written_flat_and_read_by_its_parts():
    mission = Mission(BOX, 120.0, overlap_along=0.6, zoom=17)
    assert (mission.flight, mission.pixels.zoom) == (Flight(agl_m=120.0, overlap_along=0.6), 17)
    assert mission.replace(overlap_along=0.7, zoom=None, gsd_m_per_px=1.0) == Mission(
        BOX, 120.0, overlap_along=0.7, gsd_m_per_px=1.0
    )
    names = [field.name for field in flat_fields()]
    assert len(names) == len(set(names)), "a flat name has to be of one part"
    for make in (mission.replace, lambda **more: Mission(BOX, 120.0, **more)):
        with pytest.raises(TypeError, match=r"'overlap_aloong', did you mean 'overlap_along'"):
            make(overlap_aloong=0.5)
    assert pickle.loads(pickle.dumps(mission)) == copy.deepcopy(mission) == mission
    with pytest.raises(dataclasses.FrozenInstanceError):
        mission.flight = Flight(1.0)


def test_every_field_says_what_it_is():
    """Titles and help are fragments; a default is right; whoever refuses a value names its field."""
    for part in (*FLAT_PARTS.values(), Camera, Wind):
        for field in declared_fields(part):
            assert field.help == field.help.strip().rstrip(".")
            assert not field.title[0].isupper()
            assert field.needed or field.settled(field.default) == field.default
            assert field.settled(field.initial_value) == field.initial_value
            wrong = [object(), *(limit for limit in (field.above, field.below) if limit is not None)]
            wrong += [limit - 1 for limit in (field.least,) if limit is not None]
            wrong += [limit + 1 for limit in (field.most,) if limit is not None]
            for value in wrong:
                with pytest.raises(InvalidInput) as refused:
                    field.settled(value)
                assert refused.value.field == field.name


def test_defaults_may_be_left_out():
    short = '{"schema": 1, "flight": {"agl_m": 120}, "area": {"type": "points", "poses": [[35, -89, 120]]}}'
    assert Mission.from_json(short) == Mission(Points(((35, -89, 120),)), 120)


def over_a_point(parts):
    """Text of a mission file with these parts, over a point."""
    return f'{{"schema": 1, {parts}, "area": {{"type": "points", "poses": [[1, 2, 3]]}}}}'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "not JSON"),
        ("[]", "must be an object"),
        ('{"schema": 2}', "mission schema 2: this version reads schema 1"),
        ('{"schema": 1, "area": {}, "flight": {"agl": 1}}', "mission field 'flight.agl': not one of agl_m"),
        ('{"schema": 1, "area": {}, "agl_m": 1}', "mission field 'agl_m': not one of accuracy"),
        ('{"schema": 1, "area": {"type": "disc"}, "flight": {"agl_m": 1}}', "disc"),
        ('{"schema": 1, "area": {}, "flight": 1}', "mission field 'flight' is 1: must be an object"),
        ('{"agl_m": 1}', "schema None"),
        ('{"schema": 1, "flight": {"agl_m": 1}}', "'area'"),
        (
            over_a_point('"flight": {"agl_m": 1}, "colour": 1'),
            "'colour'",
        ),
        (over_a_point('"flight": {"agl_m": "x"}'), "must be a number"),
        (
            over_a_point('"flight": {"agl_m": true}'),
            "must be a number",
        ),
        (
            over_a_point('"flight": {"agl_m": 1}, "pixels": {"zoom": 1.5}'),
            "zoom 1.5: must be a whole number",
        ),
        (
            over_a_point('"flight": {"agl_m": 1}, "pixels": {"max_px": NaN}'),
            "NaN: JSON has finite numbers only",
        ),
        (
            over_a_point('"flight": {"agl_m": 1}, "imagery": {"map_types": "satellite"}'),
            "must be a list",
        ),
        (
            over_a_point('"flight": {"agl_m": 1}, "pixels": {"upsample": 1}'),
            "must be true or false",
        ),
        (
            '{"schema": 1, "flight": {"agl_m": 1}, "area": {"type": "points", "poses": [[1, "a", 3]]}}',
            "wrong type",
        ),
        (
            '{"schema": 1, "flight": {"agl_m": 1}, "area": {"type": "box", "north": 1}}',
            "'area.north': not one of",
        ),
        (
            '{"schema": 1, "flight": {"agl_m": 1}, "area": {"type": "box", "north_deg": 1}}',
            "without area.west_deg",
        ),
        ('{"schema": 1, "flight": {"agl_m": 1}, "area": ["x"]}', "must be an object"),
        ('{"schema": 1, "flight": {"agl_m": 1}, "area": {"type": "points", "poses": [[1]]}}', "wrong type"),
        ("[" * 200_000, "nested too deep"),
    ],
)
def test_json_that_is_no_mission_is_refused_in_one_line(text, says):
    with pytest.raises(InvalidInput) as refused:
        Mission.from_json(text)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_missing_mission_file_is_named(tmp_path):
    with pytest.raises(InvalidInput, match=r"gone\.json"):
        Mission.load(tmp_path / "gone.json")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"agl_m": 0.0}, "height above ground 0.0 m: must be above 0"),
        ({"agl_m": math.inf}, "height above ground inf"),
        ({"agl_m": 1e155}, "height above ground 1e+155 m: must be at most 1e+09"),
        ({"img_size": (60_000, 60_000, 3)}, "at most 20,000 px along a side and 200,000,000 px in all"),
        ({"img_size": (20_000, 10_001, 1)}, "at most 20,000 px along a side and 200,000,000 px in all"),
        ({"img_size": (1, 10**400, 3)}, "at most 20,000 px along a side"),
        (
            {"image_px": 10**400},
            "image's longer side of more than 64 bits: must be at most 18446744073709551615",
        ),
        ({"max_px": 10**400}, "maximum image side of more than 64 bits"),
        ({"zoom": 10**400}, "zoom of more than 64 bits"),
        ({"max_images": 10**400}, "maximum number of images of more than 64 bits"),
        ({"seed": 10**400}, "seed of more than 64 bits"),
        ({"seed": -1e308}, "seed of more than 64 bits: must be at least -18446744073709551615"),
        ({"seed": -(10**400)}, "seed of more than 64 bits: must be at least -18446744073709551615"),
        ({"overlap_along": 1.0}, "front overlap 100.0 %: must be at least 0 and below 100"),
        ({"overlap_across": -0.1}, "side overlap -10.0 %"),
        ({"overlap_along": math.nan}, "front overlap nan %"),
        ({"layout": "spiral"}, "layout 'spiral': must be one of cover, paper"),
        ({"map_types": ("hybrid",)}, "map types 'hybrid'"),
        ({"map_types": ()}, "no map type"),
        ({"map_types": ("terrain", "terrain")}, "once"),
        ({"map_types": (["terrain"],)}, "map types ['terrain']: must be one of"),
        ({"zoom": -(10**400)}, "must be 0 or more"),
        ({"image_format": "bmp"}, "image format 'bmp'"),
        ({"source": ""}, "source is empty"),
        ({"zoom": 3, "gsd_m_per_px": 1.0}, "give one of the two"),
        ({"zoom": -1}, "zoom -1"),
        ({"gsd_m_per_px": 0.0}, "ground sample distance 0.0"),
        ({"max_px": 0}, "maximum image side 0 px: must be 1 or more"),
        ({"image_px": 0}, "image's longer side 0 px: must be 1 or more"),
        ({"max_images": 0}, "maximum number of images 0: must be 1 or more"),
        ({"img_size": (0, 5, 3)}, "image size 0 5 3"),
        ({"img_size": (5, 5, 2)}, "1 or 3 channels"),
        ({"tilt_deg": 181.0}, "tilt 181.0 deg"),
        ({"yaw_deg": math.nan}, "yaw nan deg"),
        ({"ground_height_m": 2e4}, "ground height 20000.0 m"),
        ({"error_budget_px": 0.0}, "error budget 0.0 px: must be above 0"),
        ({"mesh": "mesh-0.1px"}, "mesh 'mesh-0.1px': must be one of auto, rays"),
        ({"frame": "round"}, "frame 'round': must be one of auto, map, camera"),
        ({"mesh": "mesh"}, "mesh 'mesh'"),
        ({"resampling": "cubic"}, "resampling 'cubic'"),
        ({"row_azimuth_deg": 361.0}, "row azimuth 361.0 deg: must be from 0 to 360"),
        ({"row_azimuth_deg": math.nan}, "row azimuth nan deg"),
        ({"order": "zigzag"}, "order of rows 'zigzag': must be one of serpentine, one-way"),
        ({"airspeed_m_per_s": 0.0}, "airspeed 0.0 m/s: must be from 0.1 to 340"),
        ({"error_budget_px": math.inf}, "error budget inf px: must be a finite number"),
        ({"gsd_m_per_px": "fine"}, "ground sample distance 'fine': must be a number"),
        ({"upsample": "yes"}, "allow upsampling 'yes': must be true or false"),
        ({"img_size": (5, 5)}, "image size (5, 5): must be three whole numbers"),
        ({"start": "2024-06-21"}, "start '2024-06-21': must be UTC as 2024-06-21T10:30:00Z"),
        ({"start": "2024-06-21T10:30:00+01:00"}, "must be UTC as"),
        ({"start": "2024-06-21 10:30:00Z"}, "must be UTC as"),
        ({"start": "2024-02-30T10:30:00Z"}, "start '2024-02-30T10:30:00Z': no such time"),
        ({"start": "2024-06-21T10:30:00.1234567Z"}, "must be UTC as"),
    ],
)
def test_values_outside_their_domain_are_named(change, says):
    with pytest.raises(InvalidInput) as refused:
        Mission(BOX, 120.0).replace(**change)
    assert says in str(refused.value)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Box(91, 0, 0, 1), "latitude 91"),
        (lambda: Box(1, 400, 0, 1), "longitude 400"),
        (lambda: Box(0, 0, 1, 1), "south lies above north"),
        (lambda: Polygon(()), "without a ring"),
        (lambda: Polygon((((0, 0), (1, 1), (0, 0)),)), "2 corners"),
        (lambda: Points(()), "empty"),
        (lambda: Points(((1, 2, 3), (1, 2, 4)), (10.0,)), "1 yaws of 2 points: give one for each, or none"),
        (lambda: Points(((1, 2, 3),), (math.nan,)), "yaw nan deg"),
    ],
)
def test_areas_outside_their_domain_are_named(make, says):
    with pytest.raises(InvalidInput, match=says):
        make()


def test_a_box_across_the_antimeridian():
    box = Box(1, 179, -1, -179)
    assert box.span_deg == 2
    assert box.continuous_east_deg == 181
    assert Box(1, -180, -1, 180).span_deg == 360
    assert box.area_m2() == pytest.approx(Box(1, 9, -1, 11).area_m2())


@pytest.mark.parametrize(
    ("lons", "west", "east"),
    [
        ((10.0,), 10.0, 10.0),
        ((10.0, -20.0, 5.0), -20.0, 10.0),
        ((179.5, -179.9), 179.5, -179.9),
        ((179.5, -179.9, 0.0), 0.0, -179.9),
        ((170.0, 190.5), 170.0, -169.5),
        ((-120.0, 0.0, 120.0), -120.0, 120.0),
        ((-180.0, 180.0), 180.0, -180.0),
    ],
)
def test_the_smallest_box_around_points(lons, west, east):
    bounds = Points(tuple((float(index), lon, 1.0) for index, lon in enumerate(lons))).bounds
    assert bounds == Box(len(lons) - 1.0, west, 0.0, east)


@given(st.lists(st.floats(-180, 180), min_size=1, max_size=5))
def test_the_box_around_points_holds_them_and_none_is_smaller(lons):
    bounds = Points(tuple((0.0, lon, 1.0) for lon in lons)).bounds
    away = [(lon - bounds.west_deg) % 360.0 for lon in lons]
    assert max(away) <= bounds.span_deg + 1e-9 or min(away) > 360.0 - 1e-9
    assert bounds.span_deg <= min(max((lon - west) % 360.0 for lon in lons) for west in lons) + 1e-9


def test_the_start_is_a_time_in_utc():
    assert utc_time("2024-06-21T10:30:00Z").isoformat() == "2024-06-21T10:30:00+00:00"
    assert utc_time("2024-06-21T10:30:00.25Z").isoformat() == "2024-06-21T10:30:00.250000+00:00"


def test_a_polygon_is_the_same_however_it_is_written():
    square = ((179.0, -1.0), (181.0, -1.0), (181.0, 1.0), (179.0, 1.0))
    jumping = tuple((x if x < 180 else x - 360, y) for x, y in square)
    closed = (*square, square[0])
    shifted = tuple((x - 360, y) for x, y in square)
    assert Polygon((square,)) == Polygon((jumping,)) == Polygon((closed,)) == Polygon((shifted,))
    bounds = Polygon((jumping,)).bounds
    assert (bounds.west_deg, bounds.east_deg, bounds.span_deg) == (179.0, -179.0, 2.0)


def test_holes_are_not_ground():
    outer, hole = ((0, 0), (4, 0), (4, 4), (0, 4)), ((-359, 1), (-358, 1), (-358, 2), (-359, 2))
    whole, hollow = Polygon((outer,)), Polygon((outer, hole))
    assert hollow.area_m2() == pytest.approx(whole.area_m2() - Box(2, 1, 1, 2).area_m2(), rel=1e-12)


def test_kinds():
    assert Mission(BOX, 1.0).kind == "raster"
    assert Mission(Points(((1, 2, 3),)), 3.0).kind == "single"
    assert Mission(Points(((1, 2, 3), (1, 2, 4))), 3.0).kind == "list"


@pytest.mark.parametrize("date", [" 2020", "2020\n", "20\x0020"])
def test_a_date_is_one_line_of_text(date):
    with pytest.raises(InvalidInput, match=r"date .*: must be text without spaces around it"):
        Mission(BOX, 120.0, date=date)


def test_a_file_of_coordinates_is_told_from_a_mission(tmp_path):
    (tmp_path / "places.txt").write_text("35.16 -89.90 120\n")
    with pytest.raises(InvalidInput, match=r"holds no mission.*given as coordinates"):
        Mission.load(tmp_path / "places.txt")


@pytest.mark.parametrize("imagery", [{"source": "a\0b"}, {"imageries": ("x=a\0b",)}])
def test_a_source_with_a_nul_is_refused_in_a_line(imagery):
    with pytest.raises(InvalidInput, match="holds a NUL character") as wrong:
        Mission(Box(35.14, -89.87, 35.13, -89.86), 120.0, **imagery)
    assert "\0" not in str(wrong.value)
