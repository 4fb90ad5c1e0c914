"""The choice of methods: against every combination there is, and in words."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.rungs import Rung, bound_text, choose
from terrainav.core.mission.wind import Wind

AGRICENTER = Box(35.16, -89.90, 35.115, -89.823)
bounds = st.one_of(st.just(math.inf), st.floats(1e-9, 10.0))
ladders = st.lists(st.lists(bounds, min_size=1, max_size=4), min_size=1, max_size=3)


def rungs(stage, bounds_px):
    return [
        Rung(stage, str(i), px, px, "" if math.isfinite(px) else "no bound") for i, px in enumerate(bounds_px)
    ]


@given(ladders, st.floats(1e-6, 20.0))
def test_the_choice_is_the_first_of_all_combinations_that_fits(bounds_px, budget):
    made = [rungs(f"stage {index}", ladder) for index, ladder in enumerate(bounds_px)]
    found = choose(budget, made, ["auto"] * len(made))
    # Cheapest first: in the order of the products, a step on an earlier ladder costs more than all later ones.
    fitting = [
        combination
        for combination in itertools.product(*made)
        if sum(r.bound_px for r in combination) <= budget
    ]
    near = any(abs(sum(r.bound_px for r in c) - budget) <= 1e-9 * budget for c in itertools.product(*made))
    if near:
        return
    if not fitting:
        assert found is None
        return
    choices, total = found
    assert tuple(choice.rung for choice in choices) == fitting[0]
    assert total <= budget
    for choice, ladder in zip(choices, made):
        assert (choice.rejected is None) == (choice.rung is ladder[0])
        assert bool(choice.reason) == (choice.rejected is not None)


@given(st.floats(1e-12, 1e12))
def test_bounds_in_words_are_never_less_than_they_are(bound):
    assert float(bound_text(bound)) >= bound * (1 - 1e-12)
    assert float(bound_text(bound)) <= bound * 1.11


@pytest.mark.parametrize(
    ("changes", "footprint", "picture", "mesh"),
    [
        ({}, "loc1", "map", None),
        ({"error_budget_px": 0.016}, "loc2", "map", None),
        ({"error_budget_px": 0.009}, "exact", "map", None),
        ({"error_budget_px": 0.004}, "exact", "camera", "mesh-0.003px"),
        ({"error_budget_px": 1e-6}, "exact", "camera", "rays"),
        ({"error_budget_px": 3.0, "yaw_deg": 1e-4}, "loc1", "map", None),
        ({"error_budget_px": 3.0, "yaw_deg": 90.0}, "loc1", "camera", "mesh-1px"),
        ({"tilt_deg": 85.0}, "exact", "camera", "mesh-0.03px"),
        ({"wind": Wind(5.0, 0.0, 0.2)}, "exact", "camera", "mesh-0.03px"),
        ({"wind": Wind(5.0, 0.0, 0.0)}, "loc1", "map", None),
        ({"frame": "camera", "mesh": "rays", "footprint": "loc2"}, "loc2", "camera", "rays"),
    ],
)
def test_the_agricenter_takes_what_it_needs(changes, footprint, picture, mesh):
    chosen = plan(Mission(AGRICENTER, 120.0, **changes), PixelGrid()).accuracy
    assert chosen.footprint.rung.name == footprint
    assert chosen.picture.rung.name == picture
    assert (chosen.mesh and chosen.mesh.rung.name) == mesh
    assert chosen.bound_px <= chosen.budget_px


def test_what_was_chosen_and_left_out_in_words():
    chosen = plan(Mission(AGRICENTER, 120.0), PixelGrid()).accuracy
    assert chosen.text() == (
        "footprint: loc1, ≤ 0.0082 px; picture: map, ≤ 0.0083 px; left out: resampling, exact footprints, wind; "
        "terrain: not bounded, up to 3.4 px per metre of relief"
    )
    tilted = plan(Mission(AGRICENTER, 120.0, tilt_deg=85.0), PixelGrid()).accuracy
    assert tilted.condition == math.inf
    assert tilted.to_dict()["condition"] is None
    assert "without limit at the horizon" in tilted.text()
    assert tilted.picture.rejected.name == "map"
    assert "look straight down" in tilted.picture.reason


def test_more_than_the_budget_only_when_told_to():
    mission = Mission(Points(((35.0, -89.0, 16e3),)), 16e3, frame="map")
    with pytest.raises(
        InvalidInput, match=r"error budget 0.1 px: no methods fit; the closest are picture map"
    ) as refused:
        plan(mission, PixelGrid())
    assert "--accept-error" in str(refused.value)
    accepted = plan(mission.with_(accept_error=True), PixelGrid())
    assert accepted.accuracy.bound_px > 0.1
    assert accepted.size_px is None


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
