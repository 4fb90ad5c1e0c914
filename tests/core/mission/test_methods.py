"""The choice of methods: against every combination there is, and in words."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.methods import bound_text
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.shot import Shot

from tests.support.errors import refused
from tests.support.thinning import examples, sampled

AGRICENTER = Box(35.16, -89.90, 35.115, -89.823)


@settings(max_examples=examples(60))
@given(st.floats(-5.0, 1.0).map(lambda power: 10.0**power), st.sampled_from(["auto", "camera"]))
def test_a_budget_buys_the_cheapest_picture_and_the_coarsest_mesh_that_fit(budget, frame):
    mission = Mission(Points(((35.14, -89.86, 120.0),)), 120.0, frame=frame)
    on_map = plan(mission.replace(frame="map", error_budget_px=1.0), PixelGrid()).accuracy
    chosen = plan(mission.replace(error_budget_px=budget), PixelGrid()).accuracy
    assert chosen.bound_px <= budget
    assert chosen.footprint.method.name == "exact"
    if frame == "auto" and on_map.bound_px <= budget:
        assert (chosen.picture.method.name, chosen.picture.rejected) == ("map", None)
        assert chosen.pixels is None
        return
    assert chosen.picture.method.name == "camera"
    assert (chosen.picture.rejected is None) == (frame == "camera")
    pixels = chosen.pixels
    if pixels.method.name == "mesh":
        # All that the other stages leave is the mesh's, up to a pixel.
        assert chosen.mesh_tolerance_px == pytest.approx(
            min(budget - (chosen.bound_px - pixels.method.bound_px), 1.0), rel=1e-6
        )
        assert pixels.rejected is None
    else:
        assert chosen.mesh_tolerance_px == 0.0
        assert chosen.bound_px + pixels.rejected.bound_px > budget
        assert "exceed the budget" in pixels.reason


@given(st.floats(1e-12, 1e12))
def test_bounds_in_words_are_never_less_than_they_are(bound):
    assert float(bound_text(bound)) >= bound * (1 - 1e-12)
    assert float(bound_text(bound)) <= bound * 1.11


@pytest.mark.parametrize(
    ("changes", "picture", "pixels", "tolerance_px"),
    sampled(
        [
            ({}, "map", None, 0.0),
            ({"error_budget_px": 0.009}, "map", None, 0.0),
            ({"error_budget_px": 0.004}, "camera", "mesh", 0.004),
            ({"error_budget_px": 1e-6}, "camera", "rays", 0.0),
            ({"error_budget_px": 3.0, "yaw_deg": 1e-4}, "map", None, 0.0),
            ({"error_budget_px": 3.0, "yaw_deg": 90.0}, "map", None, 0.0),
            ({"error_budget_px": 3.0, "yaw_deg": 45.0}, "camera", "mesh", 1.0),
            ({"tilt_deg": 85.0}, "camera", "mesh", 0.1),
            ({"wind": Wind(5.0, 0.0, 0.2)}, "camera", "mesh", 0.1),
            ({"wind": Wind(5.0, 0.0, 0.0)}, "map", None, 0.0),
            ({"frame": "camera", "mesh": "rays"}, "camera", "rays", 0.0),
        ],
        3,
    ),
)
def test_the_agricenter_takes_what_it_needs(changes, picture, pixels, tolerance_px):
    chosen = plan(Mission(AGRICENTER, 120.0, **changes), PixelGrid()).accuracy
    assert chosen.picture.method.name == picture
    assert (chosen.pixels and chosen.pixels.method.name) == pixels
    # No fixed steps: the mesh has what the budget leaves.
    assert chosen.mesh_tolerance_px == pytest.approx(tolerance_px, rel=1e-3)
    assert chosen.bound_px <= chosen.budget_px


def test_what_was_chosen_and_left_out_in_words():
    chosen = plan(Mission(AGRICENTER, 120.0), PixelGrid()).accuracy
    said = dict(chosen.lines())
    assert said["method of footprint"] == "exact, ≤ 8.3e-09 px"
    assert said["method of image"] == "map, ≤ 0.0083 px"
    assert said["left out"].startswith("resampling (")
    assert "; wind (" in said["left out"]
    assert said["terrain"] == "not bounded, up to 3.4 px per metre of relief"
    tilted = plan(Mission(AGRICENTER, 120.0, tilt_deg=85.0), PixelGrid()).accuracy
    assert tilted.condition == math.inf
    assert tilted.to_dict()["condition"] is None
    assert "without limit at the horizon" in dict(tilted.lines())["terrain"]
    assert tilted.picture.rejected.name == "map"
    assert "look straight down" in tilted.picture.reason


def test_more_than_the_budget_only_when_told_to():
    mission = Mission(Points(((35.0, -89.0, 16e3),)), 16e3, frame="map")
    over = "error budget {0:g} px: no methods fit; the closest are {1} with {2} px, {3} times as much"
    with refused(over, field="error_budget_px") as caught:
        plan(mission, PixelGrid())
    budget, closest, _, _ = caught.value.message.values
    assert (budget, closest) == (0.1, "image map")
    assert [option.name for option in caught.value.remedy.values] == ["error_budget", "accept_error"]
    accepted = plan(mission.replace(accept_error=True), PixelGrid())
    assert accepted.accuracy.bound_px > 0.1
    assert accepted.frames.on_map


@pytest.mark.parametrize("budget", [0.0, -1.0, math.nan, math.inf])
def test_budgets_that_are_no_positive_number_are_refused(budget):
    with pytest.raises(InvalidInput, match="error budget"):
        Mission(AGRICENTER, 120.0, error_budget_px=budget)


def test_camera_frames_cover_whatever_the_attitude():
    for attitude in (
        {"yaw_deg": 30.0},
        {"tilt_deg": 50.0, "yaw_deg": 200.0},
        {"tilt_deg": 84.0},
        {"roll_deg": 30.0},
    ):
        worked_out = plan(Mission(AGRICENTER, 120.0, overlap_along=0.2, **attitude), PixelGrid())
        assert worked_out.coverage.complete
        assert worked_out.overlap.least_along >= 0.19


@pytest.mark.parametrize(("agl_m", "serves"), [(120.0, True), (3e6, True), (2e7, False)])
def test_rays_are_said_to_be_left_out_where_a_mesh_has_cells(agl_m, serves):
    made = plan(Mission(Points(((40.0, -90.0, agl_m),)), agl_m, frame="camera"), PixelGrid())
    assert bool(made.views.view(0).patches) is serves
    assert ("rays for every pixel" in dict(made.accuracy.left_out)) is serves


@pytest.mark.parametrize("lat_deg", sampled([90.0, -90.0], 2))
def test_a_plan_over_a_pole_is_worked_out_without_a_warning(lat_deg):
    made = plan(Mission(Points(((lat_deg, 0.0, 3e6), (lat_deg, 40.0, 3e6))), 3e6), PixelGrid())
    tiles = {(zoom, x % 2**zoom, y) for at in (0, 1) for zoom, x, y in Shot(made, at).tiles}
    assert made.requests == len(tiles)
    assert np.isfinite(made.frame_centres).all()


def test_tiles_are_counted_as_one_by_one_and_too_many_refused_before_they_take_memory():
    def made(zoom, count=1):
        grid = PixelGrid(min_zoom=zoom, native_zoom=zoom, max_zoom=zoom)
        places = tuple((40.0 + 5.0 * at, -90.0, 1e6) for at in range(count))
        return plan(Mission(Points(places), 1e6, frame="camera", image_px=64), grid)

    for zoom in (4, 8, 11):
        few = made(zoom, 2)
        tiles = {(z, x % 2**z, y) for at in (0, 1) for z, x, y in Shot(few, at).tiles}
        assert few.requests == len(tiles)
    assert few.requests > 10_000
    for zoom in (14, 19, 22):
        large = made(zoom, 2)
        tracemalloc.start()
        with pytest.raises(InvalidInput, match="more than 32,768 tiles of the source"):
            _ = large.requests
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert peak < 200e6
