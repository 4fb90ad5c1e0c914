"""Several missions in one flight: every waypoint of each in order, with transits that keep clear of the relief."""

from __future__ import annotations

import csv
import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their relief by GDAL's Python module")

from hypothesis import given, settings  # noqa: E402
from hypothesis import strategies as st  # noqa: E402
from pyproj import Geod  # noqa: E402
from terrainav.core.errors import InvalidInput  # noqa: E402
from terrainav.core.geodesy.camera import Camera  # noqa: E402
from terrainav.core.geodesy.mercator import PixelGrid  # noqa: E402
from terrainav.core.mission.areas.area import Box, Points, Polygon  # noqa: E402
from terrainav.core.mission.export import plan_texts, write_plan  # noqa: E402
from terrainav.core.mission.flight.joined import join_plans, summarize  # noqa: E402
from terrainav.core.mission.flight.path import LANDING, TAKEOFF, TRANSIT  # noqa: E402
from terrainav.core.mission.flight.wind import Wind  # noqa: E402
from terrainav.core.mission.mission import Mission  # noqa: E402
from terrainav.core.mission.plan import plan  # noqa: E402
from terrainav.core.mission.profile import height_profile  # noqa: E402
from terrainav.core.picture.heights import mission_heights  # noqa: E402

from tests.core.mission.flown_reader import KML, Ground, least_clearance_m, legs_of  # noqa: E402
from tests.core.mission.wpml_reader import Wpml  # noqa: E402
from tests.support import rasters  # noqa: E402
from tests.support.command import command  # noqa: E402
from tests.support.thinning import examples  # noqa: E402

GEOD = Geod(ellps="WGS84")
GRID = PixelGrid(max_zoom=20, native_zoom=20)
ONE = Mission(Box(47.402, 8.500, 47.400, 8.503), 60.0, overlap_along=0.3, airspeed_m_per_s=12.0)
OTHER = ONE.replace(area=Box(47.407, 8.506, 47.405, 8.509), agl_m=90.0, airspeed_m_per_s=7.0, row_azimuth_deg=40.0)
SPOTS = ONE.replace(area=Points(((47.41, 8.5, 50.0), (47.411, 8.502, 70.0))))
HOME = (47.399, 8.499)
NAMES = ("one", "other", "third")
FLIGHT_FILES = (".plan", ".kmz", ".litchi.csv", ".gpx", ".kml", ".gpkg")


def joined(*missions):
    heights = mission_heights(missions[0]) if missions[0].terrain.elevation else None
    plans = [plan(mission, GRID, heights) for mission in missions]
    return join_plans(plans, NAMES[: len(plans)], heights)


def seconds(lat, lon, height, speed):
    """Time of legs at a speed of each, with climbs of 3 m/s, by another geodesic."""
    way = GEOD.inv(lon[:-1], lat[:-1], lon[1:], lat[1:])[2]
    return np.maximum(way / speed, np.abs(np.diff(height)) / 3.0)


def table(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


missions = st.builds(
    ONE.replace,
    area=st.builds(
        lambda north, west, high, wide: Box(north + high, west, north, west + wide),
        st.floats(47.39, 47.41),
        st.floats(8.49, 8.51),
        st.floats(0.001, 0.002),
        st.floats(0.002, 0.003),
    ),
    agl_m=st.floats(40.0, 120.0),
    airspeed_m_per_s=st.floats(3.0, 15.0),
    row_azimuth_deg=st.sampled_from([90.0, 0.0]),
)


@settings(max_examples=examples(12), deadline=None)
@given(
    st.lists(missions, min_size=2, max_size=3),
    st.sampled_from([{}, {"turnaround_m": 10.0, "lead_in_m": 15.0}, {"takeoff": HOME}]),
)
def test_a_flight_has_every_waypoint_of_each_in_order_and_the_sum_of_their_times(each, route):
    each = [mission.replace(**route) for mission in each]
    made = joined(*each)
    path, taken = made.path, made.path.capture >= 0
    assert path.capture[taken].tolist() == list(range(len(made)))
    for name, of in (("lat_deg", lambda one: one.meant.lat_deg), ("lon_deg", lambda one: one.meant.lon_deg)):
        np.testing.assert_array_equal(getattr(path, name)[taken], np.concatenate([of(one) for one in made.plans]))
    assert path.kind.tolist().count(TAKEOFF) == path.kind.tolist().count(LANDING) == int("takeoff" in route)
    # Between missions: level, as high as the higher one.
    at = np.flatnonzero(taken)
    between_s = 0.0
    for joint, before, after in zip(made.joints, made.plans, made.plans[1:]):
        last, first = at[joint - 1], at[joint]
        inside = slice(last + 1, first)
        heights = path.height_m[inside][path.kind[inside] == TRANSIT]
        assert heights == pytest.approx(max(before.mission.flight.agl_m, after.mission.flight.agl_m))
        way = slice(last, first + 1)
        legs_s = seconds(
            path.lat_deg[way], path.lon_deg[way], path.height_m[way], after.mission.flight.airspeed_m_per_s
        )
        between_s += legs_s.sum()
    own_s = sum(
        float(one.path.time_s[one.path.capture >= 0][-1] - one.path.time_s[one.path.capture >= 0][0])
        for one in made.plans
    )
    assert path.time_s[at[-1]] - path.time_s[at[0]] == pytest.approx(own_s + between_s, rel=1e-9)
    np.testing.assert_array_equal(made.times_s, path.time_s[taken])
    assert summarize(made, NAMES).images == sum(len(one) for one in made.plans)


@pytest.mark.parametrize("ending", FLIGHT_FILES)
def test_files_lead_through_all_images_in_order(tmp_path, ending):
    made = joined(ONE.replace(takeoff=HOME), OTHER, SPOTS)
    flat = Flat()
    files = write_plan(made, tmp_path / f"flight{ending}").files
    places = [leg.end for file in files for leg in legs_of(file, flat, HOME)]
    at = 0
    for lat, lon in zip(made.lat_deg.tolist(), made.lon_deg.tolist()):
        near = (
            index
            for index in range(at, len(places))
            if GEOD.inv(places[index][1], places[index][0], lon, lat)[2] < 0.02
        )
        found = next(near, None)
        assert found is not None, (lat, lon)
        at = found


class Flat:
    """Level ground for the reader of files."""

    def at(self, lat, _lon):
        return np.zeros_like(np.asarray(lat, np.float64))


# --- relief


@pytest.fixture(scope="module")
def hill(tmp_path_factory):
    """Path of a hill of 60 m between the two missions."""
    at = (np.arange(500) + 0.5) * 2.0
    x, y = np.meshgrid(at, at)
    heights = 100.0 + 60.0 * np.exp(-((x - 500.0) ** 2 + (y - 500.0) ** 2) / (2.0 * 100.0**2))
    transform = (320_000.0, 2.0, 0.0, 4_298_000.0, 0.0, -2.0)
    path = tmp_path_factory.mktemp("dem") / "hill.tif"
    return str(rasters.write(path, heights[np.newaxis], transform, 32618, data_type=gdal.GDT_Float32))


def box_on_relief(west, south, east, north):
    from pyproj import Transformer

    to_degrees = Transformer.from_crs(32618, 4326, always_xy=True)
    west_lon, north_lat = to_degrees.transform(320_000.0 + west, 4_298_000.0 - north)
    east_lon, south_lat = to_degrees.transform(320_000.0 + east, 4_298_000.0 - south)
    return Box(north_lat, west_lon, south_lat, east_lon)


@pytest.mark.parametrize("trigger", ["waypoint", "distance"])
def test_transits_keep_clear_of_a_hill_in_every_file(hill, tmp_path, trigger):
    west = Mission(
        box_on_relief(100.0, 540.0, 170.0, 460.0),
        30.0,
        Camera(78.8, 4 / 3),
        elevation=(hill,),
        clearance_m=20.0,
        clearance_distance_m=10.0,
        trigger=trigger,
    )
    east = west.replace(area=box_on_relief(830.0, 540.0, 900.0, 460.0), agl_m=40.0)
    made = joined(west, east)
    ground = Ground(hill)
    for ending in FLIGHT_FILES:
        for file in write_plan(made, tmp_path / f"flight{ending}").files:
            least, where = least_clearance_m(legs_of(file, ground), ground, 10.0)
            assert least >= 20.0 - 0.06, where
    # The way across is level and above the hilltop, and the figures state the least.
    crossing = made.path.kind == TRANSIT
    assert made.path.height_m[crossing].max() >= 160.0 + 30.0
    summary = summarize(made, NAMES)
    assert summary.clearance_m >= 20.0
    profile = height_profile(made)
    assert summary.clearance_m == profile.clearance_m[profile.lowest]
    lines = {str(label) for label, _ in summary.lines()}
    assert "least clearance" in lines
    if trigger == "distance":
        notes = write_plan(made, tmp_path / "again.kmz").notes
        assert any(f"{len(made):,} images at most" in str(note) for note in notes)


def test_flat_missions_are_joined_over_the_hill_between_them(hill):
    one = Mission(box_on_relief(40.0, 80.0, 90.0, 40.0), 20.0, elevation=(hill,))
    other = one.replace(area=box_on_relief(910.0, 960.0, 960.0, 910.0))
    heights = mission_heights(one)
    made = join_plans([plan(one, GRID, heights), plan(other, GRID, heights)], NAMES, heights)
    assert made.path.height_m.max() >= 160.0 + 19.9


# --- what a flight has in common, and what may differ


def test_each_mission_keeps_its_speed_in_files(tmp_path):
    made = joined(ONE, OTHER)
    first = len(made.plans[0])
    (text,), _ = plan_texts(made)
    speed, found = None, []
    for item in json.loads(text)["mission"]["items"]:
        if item["command"] == 178:
            speed = item["params"][1]
        elif item["command"] == 16:
            found.append((tuple(np.round(item["params"][4:], 6).tolist()), speed))
    speeds = dict(found)
    for at, place in enumerate(np.round([made.lat_deg, made.lon_deg, made.meant.agl_m], 6).T.tolist()):
        assert speeds[tuple(place)] == (12.0 if at < first else 7.0)
    marks = Wpml(write_plan(made, tmp_path / "flight.kmz").files[0]).marks
    assert [mark.speed_m_per_s for mark in (marks[0], marks[-1])] == [12.0, 7.0]
    file = write_plan(made, tmp_path / "flight.litchi.csv").files[0]
    rows = table(file)
    assert (rows[0]["speed(m/s)"], rows[-1]["speed(m/s)"]) == ("12.00", "7.00")


def test_tables_hold_the_images_of_all_with_their_names_and_footprints(tmp_path):
    made = joined(ONE, OTHER)
    for ending in (".csv", ".geojson"):
        write_plan(made, tmp_path / f"flight{ending}")
        for number, one in enumerate(made.plans):
            write_plan(one, tmp_path / f"{number}{ending}")
    rows, *each = (table(tmp_path / f"{name}.csv") for name in ("flight", "0", "1"))
    numbers = [int(row.pop("row")) for row in rows]
    assert rows == [{name: cell for name, cell in row.items() if name != "row"} for part in each for row in part]
    pairs = {(row["column"], number) for row, number in zip(rows, numbers)}
    assert len(pairs) == len(rows)
    shapes, *own = (
        [one["geometry"] for one in json.loads((tmp_path / f"{name}.geojson").read_text())["features"]]
        for name in ("flight", "0", "1")
    )
    assert shapes == [shape for part in own for shape in part]
    write_plan(made, tmp_path / "flight.kml")
    placemarks = [one.text for one in ET.parse(tmp_path / "flight.kml").getroot().iter(f"{KML}name")]
    assert [name for name in placemarks if name in set(made.names)] == 2 * made.names


def test_splits_count_the_images_of_their_mission_and_may_lie_between_missions():
    count = len(plan(ONE, GRID))
    made = joined(ONE.replace(takeoff=HOME, split_after=f"5,{count - 1}"), OTHER.replace(takeoff=HOME, split_after="3"))
    path = made.path
    ends = [int(path.capture[path.sortie == one].max()) + 1 for one in range(path.sorties)]
    assert ends == [5, count - 1, count + 3, len(made)]
    assert summarize(made, NAMES).batteries >= 4


def test_batteries_split_the_whole_flight():
    made = joined(ONE.replace(takeoff=HOME, battery_min=7.0), OTHER)
    assert made.path.sorties > 1
    assert (made.path.sorties_s <= 420.0 + 1e-6).all()


def test_a_flight_avoids_the_no_fly_areas_of_all():
    ring = ((8.5040, 47.3995), (8.5050, 47.3995), (8.5050, 47.4065), (8.5040, 47.4065))
    made = joined(ONE, OTHER.replace(row_azimuth_deg=90.0, no_fly=(Polygon((ring,)),)))
    path = made.path
    share = np.linspace(0.0, 1.0, 200)[:, np.newaxis]
    lat = path.lat_deg[:-1] + share * np.diff(path.lat_deg)
    lon = path.lon_deg[:-1] + share * np.diff(path.lon_deg)
    assert not ((lat > 47.3995) & (lat < 47.4065) & (lon > 8.504) & (lon < 8.505)).any()


def test_a_flight_across_the_antimeridian_takes_the_short_way():
    made = joined(
        ONE.replace(area=Box(0.001, 179.996, -0.001, 179.998)), ONE.replace(area=Box(0.001, -179.998, -0.001, -179.996))
    )
    assert made.path.distance_m < 4000.0
    assert np.ptp(made.lon_deg) < 0.01


@pytest.mark.parametrize(
    ("changes", "title"),
    [
        ({"camera": Camera(60.0, 1.5)}, "camera"),
        ({"trigger": "distance"}, "trigger"),
        ({"drone": "m300"}, "drone"),
        ({"lead_in_m": 5.0}, "lead-in"),
        ({"ground_height_m": 5.0}, "ground height"),
        ({"takeoff": (47.39, 8.49)}, "take-off"),
        ({"clearance_m": 5.0}, "clearance"),
        ({"wind": Wind(1.0, 0.0, 0.0)}, "wind"),
    ],
)
def test_what_a_flight_has_in_common_is_named_in_one_line(changes, title):
    with pytest.raises(InvalidInput) as refused:
        joined(ONE.replace(takeoff=HOME), OTHER.replace(**changes))
    assert str(refused.value) == f"one flight of one and other: they differ in {title}, which a flight has in common"


def test_later_missions_are_compared_with_each_other():
    with pytest.raises(InvalidInput, match="one flight of other and third: they differ in take-off"):
        joined(ONE, OTHER.replace(takeoff=HOME), OTHER.replace(takeoff=(47.39, 8.49)))


def test_one_mission_is_no_flight_of_several():
    with pytest.raises(InvalidInput, match="needs two or more"):
        joined(ONE)


def test_the_command_joins_mission_files(tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    ONE.replace(takeoff=HOME).save(tmp_path / "one.json")
    OTHER.save(tmp_path / "other.json")
    done = run("plan", "one.json", "other.json", "--output", "flight.kmz", "--output", "flight.gpkg")
    assert done.returncode == 0
    assert "between missions" in done.stdout
    assert (tmp_path / "flight.kmz").exists()
    figures = json.loads(run("plan", "one.json", "other.json", "--json").stdout)
    assert figures["images"] == sum(figures["images_each"])
    for more, words in (
        (("--output", "flight.json"), "must end in"),
        (("--align", "shortest"), "align the rows of each mission"),
        (("--agl", "50"), "give one of the two"),
    ):
        done = run("plan", "one.json", "other.json", *more)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert words in done.stderr
