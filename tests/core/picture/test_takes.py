"""Motion blur and rolling shutter: edges as wide and slanted as formulas say, and points at the poses of their rows."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pyproj import Geod, Transformer
from terrainav.core.bands import RGB, Bands
from terrainav.core.camera.shutter import MOST_INSTANTS, instant_count, instants_s, strips
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.external.compiling import without_numba
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.flight.motion import fly, fly_rates
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.takes import shown_box
from terrainav.core.picture import shot as shot_module
from terrainav.core.picture.camera_frame import parts_of_tiles
from terrainav.core.picture.effects import check_bands
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.products import sighting
from terrainav.core.picture.shot import Take, draw, make_shot, picture_parts

from tests.support.sources import PatternSource

BOX = Box(35.1610, -89.9, 35.1590, -89.888)
AGL_M, SPEED_M_PER_S, PX = 100.0, 20.0, 800
#: Angle of edges to the columns of images, as ISO 12233 has them.
SLANT = math.radians(5.0)


class EdgeSource(PatternSource):
    """Black west of a slanted line on the ground, and white east of it, by the share of each pixel in linear light."""

    def __init__(self, lat_deg, lon_deg):
        super().__init__()
        self.u, self.v = (float(at) for at in self.grid.plane.forward(np.array(lat_deg), np.array(lon_deg)))

    def paint(self, map_type, part):
        world = self.grid.world_px(part.zoom)
        x = part.left_px + np.arange(part.width_px) + 0.5 - self.u * world
        y = part.top_px + np.arange(part.height_px)[:, np.newaxis] + 0.5 - self.v * world
        light = np.clip(x * math.cos(SLANT) - y * math.sin(SLANT) + 0.5, 0.0, 1.0)
        grey = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1.0 / 2.4) - 0.055)
        return np.repeat(np.rint(255.0 * grey).astype(np.uint8)[..., np.newaxis], 3, axis=2)


def planned(**values):
    given = {"image_px": PX, "airspeed_m_per_s": SPEED_M_PER_S, "frame": "camera", "overlap_along": 0.5, **values}
    area, agl_m = given.pop("area", BOX), given.pop("agl_m", AGL_M)
    mission = Mission(area, agl_m, **given)
    return plan(mission, PatternSource().grid, mission_heights(mission) if mission.terrain.elevation else None)


def edge(made, index):
    """Linear light (h, w) of a picture of an edge below the camera."""
    source = EdgeSource(made.lat_deg[index], made.lon_deg[index])
    return light_of(picture(made, source, index))


def picture(made, source, index):
    parts = picture_parts(made, source, index)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    return draw(make_shot(made, index), parts, pixels).pixels


def light_of(pixels):
    values = pixels[..., 0] / 255.0
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def edge_line(light):
    """Column of an edge in the first row, and its slope in px a row, from the light of whole rows."""
    column = light.shape[1] - light.sum(axis=1)
    slope, first = np.polyfit(np.arange(len(column)), column, 1)
    return first, slope


def edge_variance(light):
    """Variance of the line spread across a slanted edge, px²."""
    first, slope = edge_line(light)
    across = math.cos(math.atan(slope))
    rows, columns = np.mgrid[: light.shape[0], : light.shape[1]]
    away = (columns + 0.5 - first - slope * rows) * across
    near = np.abs(away) < 15.0
    missing = ((away > 0.0) - light)[near] * (across / light.shape[0])
    return 2.0 * (missing * away[near]).sum() - missing.sum() ** 2


def speed_px(made):
    """Motion of the ground below the camera in the image, px/s."""
    return SPEED_M_PER_S * PX / 2.0 / made.mission.camera.half_tangents[0] / AGL_M


@pytest.mark.parametrize("exposure_ms", [5.0, 10.0, 25.0])
def test_blur_is_as_wide_as_the_way_of_the_exposure(exposure_ms):
    still, moved = planned(), planned(motion_blur=True, exposure_ms=exposure_ms)
    index = 3
    sharp, blurred = edge(still, index), edge(moved, index)
    way = math.sqrt(12.0 * (edge_variance(blurred) - edge_variance(sharp))) / math.cos(SLANT)
    wanted = speed_px(moved) * exposure_ms / 1000.0
    assert way == pytest.approx(wanted, abs=0.05)
    # In linear light, the exposure leaves as much of it as there was, and the edge where it was.
    assert edge_line(blurred) == pytest.approx(edge_line(sharp), abs=0.01)
    facts = dict(make_shot(moved, index).timing.facts)
    assert facts["motion_blur_px"] == pytest.approx(wanted, rel=0.01)
    assert facts["exposure_ms"] == exposure_ms


@pytest.mark.parametrize("row_time_us", [20.0, 60.0])
@pytest.mark.parametrize("blur", [{}, {"motion_blur": True, "exposure_ms": 5.0}], ids=["sharp", "blurred"])
def test_rows_are_skewed_by_their_times(row_time_us, blur):
    still, rolling = planned(), planned(row_time_us=row_time_us, **blur)
    index = 3
    first, slope = edge_line(edge(rolling, index))
    first_still, slope_still = edge_line(edge(still, index))
    height = still.views.size_px(index)[1]
    wanted = -speed_px(still) * row_time_us * 1e-6 * (height - 1)
    assert abs(wanted) > 3.0 * row_time_us / 60.0
    assert (slope - slope_still) * (height - 1) == pytest.approx(wanted, abs=0.05)
    # The middle of the picture has the time of the capture.
    assert first - first_still == pytest.approx(-wanted / 2.0, abs=0.05)


def test_half_of_the_light_is_a_grey_of_188():
    made = planned(motion_blur=True, exposure_ms=100.0)
    source = EdgeSource(made.lat_deg[3], made.lon_deg[3])
    pixels = picture(made, source, 3)[..., 0].astype(np.float64)
    row = pixels[made.views.size_px(3)[1] // 2]
    # The edge passes the middle of the image; the values there are those of a ramp in linear light.
    middle = PX // 2
    assert row[middle - 1 : middle + 1].mean() == pytest.approx(188.0, abs=3.0)
    assert (row[0], row[-1]) == (0.0, 255.0)


def row_poses(made, index, size_px):
    """Latitude, longitude, height and angles of the camera at each row, from what the table states alone."""
    facts = dict(make_shot(made, index).timing.facts)
    height = size_px[1]
    seconds = (np.arange(height) + 0.5 - height / 2.0) * facts["row_time_us"] * 1e-6
    seconds *= made.views.size_px(index)[1] / height
    east, north = facts["speed_east_m_per_s"] * seconds, facts["speed_north_m_per_s"] * seconds
    lon, lat, _ = Geod(ellps="WGS84").fwd(
        np.full(height, made.lon_deg[index]),
        np.full(height, made.lat_deg[index]),
        np.degrees(np.arctan2(east, north)),
        np.hypot(east, north),
    )
    angles = [
        float(getattr(made.poses, f"{name}_deg")[index]) + facts[f"{name}_rate_deg_per_s"] * seconds
        for name in ("yaw", "tilt", "roll")
    ]
    return lat, lon, float(made.height_m[index]) + facts["speed_up_m_per_s"] * seconds, *angles


def projected_px(made, index, size_px, seen):
    """Columns and rows (h, w) of ground points, each by a pinhole camera at the pose of its row."""
    width, height = size_px
    lat, lon, up_m, *angles = (values[:, np.newaxis] for values in row_poses(made, index, size_px))
    yaw, tilt, roll = map(np.radians, angles)
    to_earth = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    ground = np.stack(to_earth.transform(seen.lon_deg, seen.lat_deg, seen.height_m), axis=-1)
    camera = np.stack(to_earth.transform(lon, lat, up_m), axis=-1)
    line = ground - camera
    sin_lat, cos_lat = np.sin(np.radians(lat)), np.cos(np.radians(lat))
    sin_lon, cos_lon = np.sin(np.radians(lon)), np.cos(np.radians(lon))
    x, y, z = np.moveaxis(line, -1, 0)
    east = -sin_lon * x + cos_lon * y
    north = -sin_lat * cos_lon * x - sin_lat * sin_lon * y + cos_lat * z
    down = -(cos_lat * cos_lon * x + cos_lat * sin_lon * y + sin_lat * z)
    # An aircraft's yaw, pitch and roll, whose camera looks down, with the top of the image ahead.
    ahead, right = north * np.cos(yaw) + east * np.sin(yaw), east * np.cos(yaw) - north * np.sin(yaw)
    ahead, down = ahead * np.cos(tilt) - down * np.sin(tilt), down * np.cos(tilt) + ahead * np.sin(tilt)
    right, down = right * np.cos(roll) + down * np.sin(roll), down * np.cos(roll) - right * np.sin(roll)
    tangent = math.tan(math.radians(made.mission.camera.fov_deg) / 2.0)
    across, along = (side / math.hypot(*made.views.size_px(index)) for side in made.views.size_px(index))
    return width * (0.5 + right / down / tangent / across / 2.0), height * (0.5 - ahead / down / tangent / along / 2.0)


TRACK = Points(
    ((35.16, -89.9, 100.0), (35.1601, -89.8997, 110.0), (35.1602, -89.8994, 105.0)),
    (350.0, 20.0, 60.0),
    (0.0, 10.0, 40.0),
    (5.0, -5.0, 0.0),
    times_s=(0.0, 1.5, 2.5),
)
MOVES = {
    "rows": {},
    "oblique": {"tilt_deg": 45.0, "yaw_deg": 30.0},
    "track": {"area": TRACK},
    "gusts": {"wind": Wind(8.0, 250.0, 0.2, 3), "tilt_deg": 20.0},
    "towards the horizon": {"tilt_deg": 80.0},
}


@pytest.mark.parametrize(
    ("elevation", "size_px"),
    [((), None), ((), (300, 200)), (("world",), None), (("world",), (150, 100))],
    ids=["level", "level, resized", "relief", "relief, resized"],
)
@pytest.mark.parametrize("values", MOVES.values(), ids=MOVES)
def test_ground_points_lie_where_the_pose_of_their_row_sees_them(values, elevation, size_px):
    given = {"image_px": 320, **values}
    if elevation:
        given.update(elevation=elevation)
    made = planned(row_time_us=90.0, motion_blur=True, exposure_ms=4.0, **given)
    index = 1
    size_px = size_px or made.views.size_px(index)
    shot = make_shot(made, index)
    assert len(shot.middle) > 2
    seen = sighting(made, index, size_px, shot)
    column, row = projected_px(made, index, size_px, seen)
    has_ground = np.isfinite(seen.depth_m)
    assert has_ground.mean() > 0.3
    rows, columns = np.nonzero(has_ground)
    scale = size_px[1] / made.views.size_px(index)[1]
    assert np.abs(column[has_ground] - columns - 0.5).max() < 0.1 * max(scale, 1.0)
    assert np.abs(row[has_ground] - rows - 0.5).max() < 0.1 * max(scale, 1.0)


def test_a_strip_is_drawn_as_the_whole_picture_from_its_pose():
    made, source = planned(row_time_us=60.0), named_source("world").open()
    shot, whole = make_shot(made, 3), picture(made, source, 3)
    for take in shot.middle[:: len(shot.middle) // 3]:
        all_rows = Take(made, 3, None, take.pose)
        parts = parts_of_tiles(made.grid, all_rows.view.tiles(all_rows.lon_deg))
        pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
        drawn = all_rows.draw(parts, pixels, RGB)[slice(*take.rows)]
        # Their meshes differ within the tolerance.
        assert np.abs(drawn.astype(int) - whole[slice(*take.rows)]).mean() < 1.0


def test_an_ideal_picture_is_one_take():
    made = planned()
    shot = make_shot(made, 2)
    assert shot.timing is None
    ((take,),) = shot.instants
    assert (take.rows, take.pose) == (None, None)
    assert "rates" not in made.__dict__


@pytest.mark.parametrize(
    "values",
    [{"trigger": "hover"}, {"area": Points(((35.16, -89.9, 100.0),))}],
    ids=["hovering", "single"],
)
def test_cameras_at_rest_are_not_blurred(values):
    made = planned(row_time_us=60.0, motion_blur=True, exposure_ms=10.0, **values)
    shot = make_shot(made, 0)
    assert not np.stack(made.rates).any()
    assert [len(takes) for takes in shot.instants] == [1]
    assert dict(shot.timing.facts)["motion_blur_px"] == 0.0
    source = named_source("world").open()
    assert np.array_equal(picture(made, source, 0), picture(planned(**values), source, 0))


def test_rows_are_flown_straight_through_their_ends():
    made = planned(row_time_us=60.0, area=Box(35.162, -89.9, 35.158, -89.895))
    assert made.rows > 2
    east, north, up = (np.asarray(rate) for rate in made.rates[:3])
    assert np.abs(np.abs(east) - SPEED_M_PER_S).max() < 1e-6
    assert np.abs(north).max() < 0.01
    assert not up.any()
    assert (np.sign(east) == np.where(made.row % 2 == made.row[0] % 2, np.sign(east[0]), -np.sign(east[0]))).all()


def test_routes_do_not_change_how_rows_are_flown():
    area = Box(35.162, -89.9, 35.158, -89.895)
    direct = planned(row_time_us=60.0, area=area)
    routed = planned(row_time_us=60.0, area=area, turnaround_m=30.0, lead_in_m=20.0, takeoff=(35.157, -89.9))
    for one, other in zip(direct.rates, routed.rates):
        assert one == pytest.approx(other, abs=1e-3)


def test_wind_changes_the_speed_over_ground():
    made = planned(row_time_us=60.0, wind=Wind(5.0, 270.0, 0.0))
    east = np.asarray(made.rates.east_m_per_s)
    assert set(np.round(np.abs(east), 3)) <= {25.0, 15.0}
    assert 25.0 in np.round(east, 3)


def test_points_turn_as_their_times_say():
    made = planned(row_time_us=60.0, area=TRACK)
    # 350 to 20 degrees in 1.5 s, and 20 to 60 in 1 s; in between, the mean.
    assert made.rates.yaw_deg_per_s == pytest.approx([20.0, 30.0, 40.0])
    assert made.rates.tilt_deg_per_s == pytest.approx([10.0 / 1.5, (10.0 / 1.5 + 30.0) / 2.0, 30.0])
    assert made.rates.up_m_per_s == pytest.approx([10.0 / 1.5, (10.0 / 1.5 - 5.0) / 2.0, -5.0])


def test_gusts_move_the_camera_as_a_finer_flight_does():
    count, step_s, after = 2000, 1e-3, 10
    given = Wind(8.0, 250.0, 0.2, 5), 15.0, np.full(count - 1, step_s), np.full(count, 90.0), np.full(count, 100.0)
    path, rates = fly(*given), fly_rates(*given)
    at = np.arange(after, count - after, 7)
    focal_px = 1000.0
    px = {"m": focal_px / 100.0, "deg": math.radians(1.0) * focal_px}
    for name, values in vars(path).items():
        rate, scale = vars(rates)[name], px[name.rpartition("_")[2]]
        for sign in (-1, 1):
            off = values[at + sign * after] - values[at] - sign * after * step_s * rate[at]
            # Gusts that arise meanwhile are left out.
            assert np.abs(off).max() * scale < 0.1
            assert np.abs(values[at + sign * after] - values[at]).max() * scale > 10.0 * np.abs(off).mean() * scale


def test_a_part_of_a_plan_moves_as_the_whole():
    made = planned(row_time_us=60.0, wind=Wind(8.0, 250.0, 0.2, 3))
    part = made.part(np.array([5, 2]))
    for one, whole in zip(part.rates, made.rates):
        assert np.array_equal(one, whole[[5, 2]])


@pytest.mark.parametrize("elevation", [(), ("world",)], ids=["level", "relief"])
def test_captures_state_the_motion_and_do_not_depend_on_blocks(elevation, tmp_path):
    given = {"elevation": elevation} if elevation else {}
    box = Box(35.1602, -89.9, 35.1598, -89.8955)
    made = planned(row_time_us=60.0, motion_blur=True, exposure_ms=8.0, image_px=160, area=box, **given)
    source = named_source("world").open()
    capture(made, source, tmp_path / "whole")
    table = Table.load(tmp_path / "whole" / "satellite" / "meta_data.csv")
    assert {float(value) for value in table.other["row_time_us"]} == {60.0}
    assert {float(value) for value in table.other["exposure_instants"]} >= {3.0}
    capture(made, named_source("world"), tmp_path / "blocks", blocks=Blocks(2))
    for path in sorted((tmp_path / "whole" / "satellite").glob("*.tif")):
        (other,) = (tmp_path / "blocks").rglob(path.name)
        assert other.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("elevation", [(), ("world",)], ids=["level", "relief"])
def test_pictures_are_the_same_without_numba(elevation):
    given = {"elevation": elevation} if elevation else {}
    made = planned(row_time_us=60.0, motion_blur=True, exposure_ms=8.0, image_px=160, tilt_deg=30.0, **given)
    source = named_source("world").open()
    compiled = picture(made, source, 2)
    with without_numba():
        differs = (picture(made, source, 2) != compiled).any(axis=2)
    # Over relief, rays end within the tolerance, which may choose another sample of an ideal picture, too.
    assert differs.mean() < (1e-3 if elevation else 1e-9)


def test_blur_needs_colours():
    with pytest.raises(InvalidInput, match="grey, or red, green and blue of 8 bits"):
        check_bands(planned(motion_blur=True, exposure_ms=1.0).mission, Bands(("red", "nir"), "uint16", (0,)))


def test_an_exposure_longer_than_the_interval_is_refused_in_one_line():
    with pytest.raises(InvalidInput) as refused:
        planned(motion_blur=True, exposure_ms=5_000.0)
    assert "exposure time 5000 ms: longer than the " in str(refused.value)
    assert "\n" not in str(refused.value)
    # Planners may state it without blur, as before.
    assert planned(exposure_ms=5_000.0)


def test_the_plan_states_the_motion_and_the_greatest_speed():
    made = planned(motion_blur=True, exposure_ms=10.0, row_time_us=60.0)
    found = estimate(made)
    lines = {str(label): str(text) for label, text in found.lines()}
    way, height = speed_px(made), made.views.size_px(0)[1]
    skew = way * 60e-6 * (height - 1)
    assert f"blur of up to {way * 0.01:.2g} px in 10 ms" in lines["motion in images"]
    assert f"skew of up to {skew:.2g} px in {60e-3 * (height - 1):.3g} ms" in lines["motion in images"]
    greatest = found.speed_limits.blur_m_per_s
    assert greatest == math.floor(SPEED_M_PER_S * 0.5 / (way * 0.01) * 10.0) / 10.0
    assert f"{greatest:g} m/s for 0.5 px of blur in 10 ms" in lines["greatest speed"]
    assert any("fly at" in warning for warning in map(str, found.warnings))
    slow = estimate(planned(motion_blur=True, exposure_ms=10.0, airspeed_m_per_s=greatest))
    assert not any("blur" in str(warning) for warning in slow.warnings)
    hovering = estimate(planned(motion_blur=True, exposure_ms=10.0, trigger="hover"))
    assert str(hovering.motion) == "none: the camera hovers"
    single = estimate(planned(motion_blur=True, exposure_ms=10.0, area=Points(((35.16, -89.9, 100.0),))))
    assert str(single.motion) == "none: the camera is at rest"
    assert estimate(planned()).motion is None


@pytest.mark.parametrize("blur_px", [0.1, 0.5, 1.0, 3.0, 20.0])
def test_instants_have_the_variance_of_the_exposure(blur_px):
    count = instant_count(blur_px)
    assert count % 2 == 1
    assert blur_px / math.sqrt(count**2 - 1.0) < 0.51
    times_s = instants_s(8.0, count)
    assert times_s.mean() == pytest.approx(0.0, abs=1e-18)
    assert times_s.var() == pytest.approx(0.008**2 / 12.0)
    assert np.abs(times_s).max() <= 0.004
    assert instant_count(1e9) == MOST_INSTANTS
    assert instant_count(0.0) == 1


def test_strips_move_by_no_more_than_is_allowed():
    moved_px = np.abs(np.sin(np.arange(500) / 80.0)) * 0.04
    found = strips(moved_px, 0.1)
    assert found[0][0] == 0
    assert found[-1][1] == 500
    for (top, bottom), (following, _) in zip(found, found[1:]):
        assert bottom == following
        assert (bottom - top) * moved_px[top:bottom].max() <= 0.1
        assert (bottom + 1 - top) * moved_px[top : bottom + 1].max() > 0.1
    assert strips(np.full(3, 5.0), 0.1) == [(0, 1), (1, 2), (2, 3)]
    assert strips(np.zeros(480), 0.1) == [(0, 480)]


@pytest.mark.parametrize("elevation", [(), ("world",)], ids=["level", "relief"])
def test_each_tile_is_fetched_once_however_far_the_camera_moves(elevation, tmp_path):
    box = Box(35.1602, -89.9, 35.1598, -89.8975)
    given = {"elevation": elevation} if elevation else {}
    made = planned(row_time_us=2_000.0, motion_blur=True, exposure_ms=50.0, image_px=48, area=box, **given)
    source = PatternSource()
    assert capture(made, source, tmp_path, connections=1).written == len(made)
    assert set(source.fetched.values()) == {1}
    for index in (0, len(made) - 1):
        west, north, east, south = shown_box(made, index)
        for zoom, column, row in make_shot(made, index).tiles:
            world, size = made.grid.world_px(zoom), made.grid.tile_px
            assert (column + 1) * size + 8.0 > west * world
            assert column * size - 8.0 < east * world
            assert (row + 1) * size + 8.0 > north * world
            assert row * size - 8.0 < south * world


def test_what_many_instants_need_is_made_again(monkeypatch):
    made, source = (
        planned(motion_blur=True, exposure_ms=20.0, image_px=160, tilt_deg=30.0),
        named_source("world").open(),
    )
    wanted = picture(made, source, 2)
    monkeypatch.setattr(shot_module, "_KEPT_BYTES", 0)
    shot = make_shot(made, 2)
    shot.trace(with_sighting=False)
    kept = [[take for take in takes if "view" in take.__dict__] for takes in shot.instants]
    assert [bool(takes) for takes in kept] == [takes is shot.middle for takes in shot.instants]
    parts = picture_parts(made, source, 2)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    assert np.array_equal(draw(shot, parts, pixels).pixels, wanted)
