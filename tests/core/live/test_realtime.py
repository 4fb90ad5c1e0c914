"""Frames by a deadline: what stands in for what is not there in time, what is said of it, and providers' terms."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager

import numpy as np
import pytest
from terrainav.core.errors import PartError, SourceError
from terrainav.core.imagery.entry import shipped_entry
from terrainav.core.imagery.opening import named_source
from terrainav.core.imagery.policy import Policy, TermsError
from terrainav.core.live.encoding import encode
from terrainav.core.live.realtime import RealTime, RecentPoses

from tests.core.live.scenes import HERE, live_camera, random_requests
from tests.support.sources import FailingSource, PatternSource

REQUEST = random_requests(1, 5)[0]._replace(lat_deg=HERE[0], lon_deg=HERE[1], up_m=150.0, tilt_deg=30.0)
SOURCE = "https://tile.example/{z}/{x}/{y}.png"


class NoiseSource(PatternSource):
    """Tiles of noise, which differs from tile to tile."""

    def __init__(self, policy=None, **options):
        super().__init__(map_types=("satellite",), **options)
        self.policy = policy or Policy()

    def paint(self, map_type, part):
        return np.random.default_rng(abs(hash(part))).integers(0, 256, (part.height_px, part.width_px, 3), np.uint8)


@contextmanager
def real_time(source, **more):
    camera = live_camera(source, **{"source": SOURCE, **more})
    with closing(RealTime(camera)) as made, closing(camera.tiles):
        yield made


def flight(count, step_s, speed_m_s=30.0):
    """Requests of a flight to the north."""
    per_step = speed_m_s * step_s / 111_200.0
    return [REQUEST._replace(lat_deg=HERE[0] + step * per_step, yaw_deg=0.0, roll_deg=0.0) for step in range(count)]


def test_in_flight_over_slow_tiles_no_frame_is_late_unmarked_and_each_share_is_right():
    source, step_s, deadline_s = NoiseSource(wait_s=0.04), 0.1, 0.02
    with real_time(source) as live:
        recent, frames, begun_s = RecentPoses(), [], time.monotonic()
        for number, request in enumerate(flight(30, step_s)):
            time.sleep(max(begun_s + number * step_s - time.monotonic(), 0.0))
            asked_s = time.monotonic()
            made = live.frame(request, encode, deadline_s, asked_s, recent)
            took_s = time.monotonic() - asked_s
            assert 0.0 < made.age_s <= took_s
            assert made.is_late == (made.age_s > deadline_s)
            frames.append(made)
        # No tile can be there in half its time.
        assert max(made.frame.coarse_share for made in frames) > 0.0
        for made in frames[::5]:
            whole = live.camera.take(made.frame.request)
            differs = (made.frame.picture != whole.picture).any(axis=-1).mean()
            assert made.frame.coarse_share == pytest.approx(differs, abs=1e-3)
    assert source.most_at_once <= 8
    assert max(source.fetched.values()) == 1


def test_a_frame_that_takes_longer_than_allowed_is_marked():
    with real_time(NoiseSource()) as live:
        live.frame(REQUEST, encode)
        slow = live.frame(REQUEST, lambda frame: time.sleep(0.2) or b"", 0.1)
        assert slow.is_late
        assert slow.age_s >= 0.2
        stated = slow.to_json()
        assert stated["late"] is True
        assert {"method", "error_bound_px", "age_s", "deadline_s", "coarse_share"} <= set(stated)
        waited = live.frame(REQUEST, encode, 5.0, time.monotonic() - 6.0)
        assert waited.is_late
        assert waited.age_s > 6.0


def test_frames_without_a_deadline_are_never_late():
    with real_time(NoiseSource()) as live:
        made = live.frame(REQUEST, encode)
        assert not made.is_late
        assert made.frame.coarse_share == 0.0
        assert made.data == encode(live.camera.take(REQUEST))


def test_tiles_that_fail_count_as_coarse_and_are_not_asked_for_with_each_frame():
    known = NoiseSource()
    with real_time(known) as live:
        live.frame(REQUEST, encode)
    lost = {part for _, part in known.fetched}
    source = FailingSource({part: PartError("tile: is missing") for part in lost}, map_types=("satellite",))
    with real_time(source) as live:
        for _ in range(4):
            made = live.frame(REQUEST, encode, 2.0)
        assert made.frame.failed_tiles == len(lost)
        assert made.frame.coarse_share == 1.0 - made.frame.sky_share
        assert {source.fetched["satellite", part] for part in lost} == {1}


def test_holes_of_tiles_count_as_coarse():
    class Holed(PatternSource):
        def paint(self, map_type, part):
            tile = np.full((part.height_px, part.width_px, 4), 255, np.uint8)
            tile[100:, 100:, 3] = 0
            return tile

    with real_time(Holed(map_types=("satellite",))) as live:
        with pytest.raises(PartError):
            live.frame(REQUEST, encode)
        made = live.frame(REQUEST, encode, 1.0)
        assert made.frame.failed_tiles > 0
        assert made.frame.coarse_share > 0.5


def test_tiles_ahead_are_fetched_along_the_velocity():
    source = NoiseSource()
    with real_time(source) as live:
        recent = RecentPoses()
        steps = flight(4, 0.3)
        for number, request in enumerate(steps):
            live.frame(request, encode, 1.0, time.monotonic() - 1.0 + 0.3 * number, recent)
        waits_until(lambda: not live.camera.tiles._running)
        later = steps[-1]._replace(lat_deg=steps[-1].lat_deg + 30.0 / 111_200.0)
        made = live.frame(later, encode, 0.0)
        assert made.frame.coarse_share == 0.0
        sideways = live.frame(later._replace(lon_deg=later.lon_deg + 0.01), encode, 0.0)
        assert sideways.frame.coarse_share > 0.0


@pytest.mark.parametrize("title", ["osm", "no", "ask"])
def test_nothing_is_fetched_ahead_where_terms_forbid_it(title):
    policies = {"osm": shipped_entry("osm").policy, "no": Policy("no", 1000), "ask": Policy("ask", 1000)}
    source = NoiseSource(policies[title])
    with real_time(source) as live:
        recent = RecentPoses()
        shown = set()
        for number, request in enumerate(flight(4, 0.3)):
            made = live.frame(request, encode, 5.0, time.monotonic() - 1.0 + 0.3 * number, recent)
            shown |= {part.window for part in live.camera.prepare(made.frame.request).parts}
        waits_until(lambda: not live.camera.tiles._running)
        # Besides what is shown, coarse tiles that stand in.
        more = {part for _, part in source.fetched} - shown
        zooms = {window.zoom for window in shown}
        assert {window.zoom for window in more} <= {zoom - 3 for zoom in zooms}
        assert len(more) <= 2 * len(zooms)
    assert source.most_at_once <= (policies[title].max_connections or 8)


@pytest.mark.parametrize("name", ["google-static", "esri-world-imagery", "esri-wayback"])
def test_providers_that_forbid_it_are_refused_in_their_words_before_any_request(name):
    source = NoiseSource(shipped_entry(name).policy)
    with pytest.raises(SourceError) as wrong:
        live_camera(source, source=SOURCE)
    assert source.policy.terms in str(wrong.value)
    assert not source.fetched


@pytest.mark.parametrize("host", ["mt1.google.com", "tile.googleapis.com", "khms0.google.com"])
def test_tiles_of_google_are_refused_by_their_address(host):
    opened = named_source(f"https://{host}/{{z}}/{{x}}/{{y}}").open()
    with closing(opened), pytest.raises(SourceError, match="Google's terms allow no bulk download"):
        live_camera(opened, source=SOURCE)


@pytest.mark.parametrize("deadline_s", [None, 1.0])
def test_a_session_makes_no_more_requests_than_terms_allow(deadline_s):
    policy = Policy("no", 40, terms="no bulk downloads")
    source = NoiseSource(policy)

    def fly():
        for request in random_requests(40, 2):
            live.frame(request, encode, deadline_s)

    with real_time(source) as live, pytest.raises(TermsError, match="no bulk downloads"):
        fly()
    assert sum(source.fetched.values()) <= 40


def test_agreeing_to_terms_lifts_the_limit_of_requests():
    policy = Policy("ask", 2, terms="ask first")
    with pytest.raises(TermsError):
        live_camera(NoiseSource(policy), source=SOURCE, image_px=640).take(REQUEST)
    camera = live_camera(NoiseSource(policy), source=SOURCE, image_px=640, accept_terms=True)
    assert camera.may_prefetch
    assert camera.take(REQUEST).coarse_share == 0.0


def test_level_ground_stands_in_for_heights_that_are_not_there_yet():
    with real_time(NoiseSource(), elevation=("world",)) as live:
        known = live.frame(REQUEST, encode, 30.0)
        assert known.frame.level_m is None
        assert known.frame.coarse_share == 0.0
        held, read = threading.Event(), live.camera.heights.surface.surface

        def slowly(*positions, **more):
            assert held.wait(30.0)
            return read(*positions, **more)

        live.camera.heights.surface.surface = slowly
        try:
            ready = [live.frame(REQUEST, encode, 0.5) for _ in range(2)]
        finally:
            held.set()
        whole = live.camera.take(REQUEST)
        for made in ready:
            assert made.frame.level_m == pytest.approx(float(known.frame.plan.ground_m[0]))
            assert made.frame.coarse_share == 1.0
            assert made.to_json()["error_bound_px"] is None
            assert (made.frame.picture != whole.picture).any(axis=-1).mean() > 0.9
            assert made.frame.height_m == pytest.approx(whole.height_m, abs=1e-6)


def test_level_ground_stands_in_for_heights_that_cannot_be_had_and_they_are_not_asked_for_with_each_frame():
    with real_time(NoiseSource(), elevation=("world",)) as live:
        known = live.frame(REQUEST, encode, 30.0).frame
        surface, asked = live.camera.heights.surface, []

        def failing(*_, **__):
            asked.append(1)
            raise PartError("heights: are missing")

        surface.surface = failing
        low = REQUEST._replace(up_m=known.height_m - REQUEST.up_m - 20.0, above_ellipsoid=True)
        begun_s = live.clock()
        for request in (REQUEST, REQUEST, low, REQUEST):
            assert live.frame(request, encode, 30.0).frame.level_m is not None
        # Tried at once, and again each second.
        assert 1 <= len(asked) <= 1 + int(live.clock() - begun_s)
        del surface.surface
        live._tried_s = -np.inf
        waits_until(lambda: live.frame(REQUEST, encode, 30.0).frame.level_m is None)


def test_frames_made_at_once_do_not_stand_in_for_each_other():
    with real_time(NoiseSource(), elevation=("world",)) as live:
        live.frame(REQUEST, encode, 30.0)
        requests = [REQUEST._replace(yaw_deg=float(yaw)) for yaw in range(0, 120, 30)]
        with ThreadPoolExecutor(2) as pool:
            made = list(pool.map(lambda request: live.frame(request, encode, 30.0), requests))
        assert [one.frame.level_m for one in made] == [None] * 4


def test_jumps_give_no_velocity():
    recent = RecentPoses()
    recent.add(0.0, REQUEST)
    assert recent.per_s() is None
    recent.add(0.5, REQUEST._replace(lat_deg=REQUEST.lat_deg + 1e-4))
    assert recent.per_s() == pytest.approx((2e-4, 0.0), rel=1e-6)
    recent.add(0.6, REQUEST._replace(lat_deg=REQUEST.lat_deg + 0.1))
    assert recent.per_s() is None
    recent.add(9.0, REQUEST)
    assert recent.per_s() is None


def waits_until(condition):
    until_s = time.monotonic() + 30.0
    while not condition():
        assert time.monotonic() < until_s
        time.sleep(0.01)
