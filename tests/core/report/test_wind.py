"""What a report says of wind, against the plan's poses worked out another way, and against the calm mission."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest
from pyproj import Geod, Transformer
from terrainav.core.geodesy.camera import CORNERS
from terrainav.core.geodesy.footprint import ground_corners
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.report import wind as wind_module
from terrainav.core.report.page import PAGE, write_report
from terrainav.core.report.sentences import mission_facts, mission_title, wind_effect_text, wind_notes
from terrainav.core.report.tables import air_table, displaced_text, displacement_table, share_text
from terrainav.core.report.wind import MOVED, TOGETHER, TURNED, Spread, wind_effect
from terrainav.core.world import WorldSource

from tests.core.geodesy.inverse import image_points

WORLD = WorldSource()
BOX = Box(35.1425, -89.868, 35.1385, -89.863)
GUSTY = Mission(BOX, 120.0, overlap_along=0.3, overlap_across=0.2, wind=Wind(8.0, 250.0, 0.2))
STEADY = GUSTY.replace(wind=Wind(8.0, 250.0, 0.0))


def spread(values):
    size = np.sort(np.abs(values))
    return math.sqrt(float(np.sum(size**2)) / len(size)), float(np.quantile(size, 0.95)), float(size[-1])


def by_name(effect):
    return {one.what: one for one in effect.displacements}


def rotation(yaw, tilt, roll):
    """Rotation from the camera's right, image top and back to east, north, up, each turn as a matrix of its own."""
    (cy, sy), (ct, st), (cr, sr) = ((math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (yaw, tilt, roll))
    # Clockwise from north about the vertical; the top of the image up; its right side down.
    turned = np.array([[cy, sy, 0.0], [-sy, cy, 0.0], [0.0, 0.0, 1.0]])
    tilted = np.array([[1.0, 0.0, 0.0], [0.0, ct, -st], [0.0, st, ct]])
    rolled = np.array([[cr, 0.0, sr], [0.0, 1.0, 0.0], [-sr, 0.0, cr]])
    return turned @ tilted @ rolled


@pytest.mark.parametrize("tilt_deg", [0.0, 40.0])
def test_metres_are_those_between_the_poses_in_space(tilt_deg):
    flown = plan(GUSTY.replace(tilt_deg=tilt_deg), WORLD.grid)
    found = by_name(wind_effect(flown))
    to_space = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    was, now = (
        np.stack(to_space.transform(poses.lon_deg, poses.lat_deg, poses.agl_m), axis=1)
        for poses in (flown.nominal, flown.poses)
    )
    off = now - was
    lat, lon = np.radians(flown.nominal.lat_deg), np.radians(flown.nominal.lon_deg)
    east = -np.sin(lon) * off[:, 0] + np.cos(lon) * off[:, 1]
    outward = np.cos(lon) * off[:, 0] + np.sin(lon) * off[:, 1]
    north = np.cos(lat) * off[:, 2] - np.sin(lat) * outward
    up = np.sin(lat) * off[:, 2] + np.cos(lat) * outward
    lon_deg, lat_deg = flown.nominal.lon_deg, flown.nominal.lat_deg
    azimuth, _, _ = Geod(ellps="WGS84").inv(lon_deg[:-1], lat_deg[:-1], lon_deg[1:], lat_deg[1:])
    heading = np.radians([*azimuth, azimuth[-1]])
    wanted = {
        "along the track": north * np.cos(heading) + east * np.sin(heading),
        "across the track": east * np.cos(heading) - north * np.sin(heading),
        "up": up,
        MOVED: np.linalg.norm(off, axis=1),
    }
    for name, values in wanted.items():
        # Degrees of the ground, carried to 120 m above it: a 50,000th.
        assert found[name].size == pytest.approx(spread(values), rel=1e-4)
        assert found[name].unit == "m"
    assert found[MOVED].size.rms > 0.3


@pytest.mark.parametrize("tilt_deg", [0.0, 40.0])
def test_turns_are_those_between_rotations_and_shift_rays_by_their_pixels(tilt_deg):
    flown = plan(GUSTY.replace(tilt_deg=tilt_deg), WORLD.grid)
    found = by_name(wind_effect(flown))
    was, now = (
        [rotation(*map(float, angles)) for angles in zip(*poses.attitude)] for poses in (flown.nominal, flown.poses)
    )
    turns = [before.T @ after for before, after in zip(was, now)]
    angles = [math.degrees(math.acos(min((np.trace(turn) - 1.0) / 2.0, 1.0))) for turn in turns]
    assert found[TURNED].size == pytest.approx(spread(angles), rel=1e-6)
    for name, axis in (("yaw", 0), ("tilt", 1), ("roll", 2)):
        change = flown.poses.attitude[axis] - flown.nominal.attitude[axis]
        assert found[name].size == pytest.approx(spread(change), rel=1e-9)
        assert found[name].unit == "deg"
    # A camera that turns on its spot moves what it sees by the angle alone, however far the ground is.
    (width, height), camera = flown.frames.largest_px, flown.mission.camera
    focal_px = width / 2.0 / camera.half_tangents[0]
    points = np.array([*((x * width / 2.0, y * height / 2.0) for x, y in CORNERS), (0.0, 0.0)])
    rays = np.column_stack([points, np.full(5, -focal_px)])
    shifts = []
    for turn in turns:
        seen = rays @ turn
        shifts.append(np.hypot(*(focal_px * seen[:, :2] / -seen[:, 2:] - points).T).max())
    assert found[TURNED].px == pytest.approx(spread(shifts), rel=1e-6)
    assert found[TURNED].px.rms > 5.0


def test_all_together_is_what_the_inverse_camera_sees():
    flown = plan(GUSTY, WORLD.grid)
    effect = wind_effect(flown)
    seen = ground_corners(flown.mission.camera, flown.nominal)
    x, y = (np.array(CORNERS)[:, axis] for axis in (0, 1))
    at = image_points(flown.mission.camera, flown.poses, seen.lat_deg, seen.lon_deg)
    width, height = flown.frames.largest_px
    shift = np.hypot((at[..., 0] - x) * width / 2.0, (at[..., 1] - y) * height / 2.0).max(axis=1)
    # Of a level camera the middle is never moved more than all of the corners.
    assert by_name(effect)[TOGETHER].px == pytest.approx(spread(shift), rel=1e-6)
    assert by_name(effect)[TOGETHER].size is None
    assert effect.compared == len(flown)


def test_of_many_captures_some_spread_over_the_mission_are_compared(monkeypatch):
    flown = plan(GUSTY, WORLD.grid)
    whole = by_name(wind_effect(flown))
    monkeypatch.setattr(wind_module, "_COMPARED", 7)
    effect = wind_effect(flown)
    assert effect.compared == 7 < len(flown)
    assert "of 7 captures, spread over the mission" in " ".join(wind_notes(effect))
    for name, one in by_name(effect).items():
        assert one.size == whole[name].size
        assert one.px.most <= whole[name].px.most
        assert one.px.rms == pytest.approx(whole[name].px.rms, rel=0.7)


def test_coverage_and_overlap_are_the_figures_of_the_two_plans():
    flown, calm = (plan(mission, WORLD.grid) for mission in (GUSTY, GUSTY.replace(wind=None)))
    effect = wind_effect(flown)
    figures = effect.figures
    for at, one in enumerate((calm, flown)):
        summary = estimate(one)
        assert {name: values[at] for name, values in figures.items()} == {
            "images": summary.images,
            "coverage": summary.covered_share,
            "uncovered_m2": summary.uncovered_m2,
            "least_front_overlap": summary.least_overlap_along,
            "median_front_overlap": summary.median_overlap_along,
            "least_side_overlap": summary.least_overlap_across,
            "median_side_overlap": summary.median_overlap_across,
            "flight_s": summary.flight_s,
        }
        # In the words of `terrainav plan`, too.
        for label in ("flight time", "images"):
            assert {row[0]: row[1 + at] for row in air_table(effect).rows}[label] == dict(summary.lines())[label]
    assert figures["least_front_overlap"][1] < figures["least_front_overlap"][0] - 0.05
    said = wind_effect_text(effect)[-1]
    for way in ("front", "side"):
        was, now = figures[f"least_{way}_overlap"]
        assert f"{way} overlap {share_text(now)} instead of {share_text(was)}" in said
    assert "map frames, in wind camera frames" in " ".join(wind_notes(effect))


def test_the_page_says_what_the_wind_does_in_figures(tmp_path):
    pytest.importorskip("matplotlib", reason="matplotlib, which draws the diagrams, is not installed")
    pages, gusty = {}, GUSTY.replace(image_px=160)
    for name, wind in (("gusts", GUSTY.wind), ("calm", None), ("steady", STEADY.wind)):
        folder = tmp_path / name
        write_report(plan(gusty.replace(wind=wind), WORLD.grid), WORLD, folder, quick=True)
        pages[name] = (folder / PAGE).read_text(encoding="utf-8").replace("\u00a0", " ")
    titles = {name: text.partition("<h1>")[2].partition("</h1>")[0] for name, text in pages.items()}
    assert len(set(titles.values())) == 3
    assert "wind of 8 m/s from 250°, turbulence 20 %" in titles["gusts"]
    assert "wind of 8 m/s from 250°, without gusts" in titles["steady"]
    assert "wind" not in titles["calm"]
    for name, text in pages.items():
        assert f"<title>{titles[name]}: error against run time</title>" in text
        assert ("Gusts move the camera by" in text) == (name == "gusts")
        assert ("neither moves nor turns the camera" in text) == (name == "steady")
        assert ("in still air" in text) == (name != "calm")
    effect = wind_effect(plan(gusty, WORLD.grid))
    for row in displacement_table(effect).rows:
        for cell in row:
            assert cell.replace("\u00a0", " ") in pages["gusts"]
    with (tmp_path / "gusts" / "wind-displacement.csv").open(encoding="utf-8", newline="") as file:
        written = list(csv.DictReader(file))
    assert [row["what"] for row in written] == [one.what for one in effect.displacements]
    for row, one in zip(written, effect.displacements):
        assert float(row["within_95_percent_px"]) == one.px.usual
        assert row["at_most"] == ("" if one.size is None else str(one.size.most))
    with (tmp_path / "steady" / "wind-coverage.csv").open(encoding="utf-8", newline="") as file:
        figures = {row["figure"]: (float(row["still_air"]), float(row["wind"])) for row in csv.DictReader(file)}
    assert {name for name, (calm, wind) in figures.items() if calm != wind} == {"flight_s"}
    assert not (tmp_path / "steady" / "wind-displacement.csv").exists()
    assert not list((tmp_path / "calm").glob("wind*"))


def test_points_have_no_coverage_and_are_displaced_all_the_same():
    some = Points(tuple((35.14 + 0.001 * k, -89.86, 120.0) for k in range(8)))
    flown = plan(Mission(some, 120.0, wind=GUSTY.wind), WORLD.grid)
    effect = wind_effect(flown)
    assert set(effect.figures) == {"images", "flight_s"}
    assert not any("overage" in text for text in wind_effect_text(effect))
    assert by_name(effect)[MOVED].size.rms > 0.0
    assert "8 m/s from 250°" in mission_title(flown)
    assert dict(mission_facts(flown, WORLD, "satellite"))["wind"].endswith("flown at 15 m/s")


def test_a_camera_that_looks_past_the_earth_is_displaced_by_what_it_does_see():
    tilted = plan(GUSTY.replace(tilt_deg=80.0), WORLD.grid)
    assert not tilted.corners.hit.all()
    assert all(math.isfinite(one.px.most) for one in wind_effect(tilted).displacements)


def test_displacements_have_two_digits_and_no_powers_of_ten():
    assert [displaced_text(value, "px").replace("\u00a0", " ") for value in (0.0, 3.21, 174.4, math.inf, None)] == [
        "0 px",
        "3.2 px",
        "174 px",
        "out of the image",
        "–",
    ]
    assert [displaced_text(value, unit) for value, unit in ((2.06, "m"), (0.0321, "m"), (11.3, "deg"))] == [
        "2.1 m",
        "3.2 cm",
        "11°",
    ]
    assert Spread.from_values(np.array([-3.0, 0.0, 1.0])) == (
        pytest.approx(math.sqrt(10 / 3)),
        pytest.approx(2.8),
        3.0,
    )
    assert share_text(-0.163771) == "−16.38 %"
