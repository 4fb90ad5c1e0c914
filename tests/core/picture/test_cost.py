"""What methods cost: time of the processor, and not of the clock on the wall."""

from __future__ import annotations

import time

import pytest
from terrainav.core.bands import Bands
from terrainav.core.errors import Cancelled
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture import cost
from terrainav.core.picture.cost import timed_cost
from terrainav.core.waiting import cancellable

MISSION = Mission(Box(35.16, -89.90, 35.155, -89.893), 120.0, zoom=17)
SLEEP_S = 0.2


@pytest.mark.parametrize(("part", "changes"), [("assemble", {}), ("render", {"tilt_deg": 30.0})])
def test_waiting_for_others_costs_nothing(monkeypatch, part, changes):
    """As on a machine that gives its processors to others."""
    work = getattr(cost, part)

    def interrupted(*arguments):
        time.sleep(SLEEP_S)
        return work(*arguments)

    monkeypatch.setattr(cost, part, interrupted)
    found = timed_cost(plan(MISSION.replace(**changes), PixelGrid()))
    assert 0.0 < found.picture_s < SLEEP_S
    assert found.footprints_s > 0.0


@pytest.mark.parametrize(("part", "changes"), [("assemble", {}), ("render", {"tilt_deg": 30.0})])
def test_pictures_that_are_timed_have_the_bands_of_their_source(monkeypatch, part, changes):
    work, made = getattr(cost, part), []
    monkeypatch.setattr(cost, part, lambda *arguments: made.append(work(*arguments)))
    timed_cost(plan(MISSION.replace(**changes), PixelGrid()), Bands(("red", "green", "blue", "nir"), "uint16"))
    assert {(picture.shape[2], picture.dtype.name) for picture in made} == {(4, "uint16")}


def test_a_coarse_clock_is_given_work_enough(monkeypatch):
    steps = iter(range(10**9))
    # A clock that goes on by a step of 16 ms at every hundredth look.
    monkeypatch.setattr(cost.time, "thread_time", lambda: next(steps) // 100 * 0.016)
    done = []
    assert cost._processor_s(lambda: done.append(1)) > 0.0
    assert len(done) > 100


def test_a_picture_that_takes_long_is_timed_once(monkeypatch):
    # Each look at the clock is 0.7 s after the one before.
    looks = iter(range(10**9))
    monkeypatch.setattr(cost.time, "thread_time", lambda: next(looks) * 0.7)
    done = []
    assert cost._processor_s(lambda: (done.append(1), cost.time.thread_time())) == pytest.approx(1.4)
    assert len(done) == 1


def test_timing_ends_soon_when_it_is_cancelled():
    moved = MISSION.replace(tilt_deg=30.0, exposure_ms=20.0, motion_blur=True, row_time_us=60.0)
    looks = []
    with cancellable(lambda: looks.append(1) or len(looks) > 3), pytest.raises(Cancelled):
        timed_cost(plan(moved, PixelGrid()))
    assert len(looks) == 4
