"""Every fault of a server through a whole capture: right pixels or a named reason, nothing else, and no hang."""

from __future__ import annotations

import hashlib
import json
import threading
import time
from contextlib import closing, contextmanager

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import SourceError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.requests_transport import RequestsTransport
from terrainav.core.imagery.http.transport import Timeouts
from terrainav.core.imagery.placeholder import Placeholder
from terrainav.core.imagery.source import tile_parts
from terrainav.core.imagery.xyz import XYZSource
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.map_frame import capture_window

from tests.core.imagery.test_faults import BROKEN, PASSING, REFUSED, SPOILT
from tests.support.caches import check_cache
from tests.support.faults import FAULTS, flat_placeholder
from tests.support.patterns import MODULUS, decode_position
from tests.support.thinning import named, sampled, thinned
from tests.support.tileserver import TileServer
from tests.support.waiting import PATIENCE_S, wait_until

MISSION = Mission(Box(35.16, -89.90, 35.1568, -89.8963), 120.0, overlap_along=0.1, zoom=18)
PLAN = plan(MISSION, PixelGrid())
WINDOWS = [capture_window(PLAN, index) for index in range(len(PLAN))]
NEEDED = [
    {
        (part.window.zoom, int(part.window.left_px) // 256, int(part.window.top_px) // 256)
        for part in tile_parts(window, PLAN.grid)
    }
    for window in WINDOWS
]
TILES = sorted(set().union(*NEEDED))
# A few tiles, each of which several pictures need.
BAD = set(TILES[3::9])
CONCERNED = {PLAN.names[index] for index, tiles in enumerate(NEEDED) if tiles & BAD}
PLACEHOLDER = Placeholder(sha256=(hashlib.sha256(flat_placeholder()).hexdigest(),))
# Servers answer as soon as a busy machine lets them. Silence, and answers drop by drop, are not waited for long.
PATIENT = Timeouts(connect_s=30.0, read_s=30.0, whole_s=60.0)
TIMEOUTS = {
    "stall": Timeouts(connect_s=30.0, read_s=1.5, whole_s=60.0),
    "stall-mid-body": Timeouts(connect_s=30.0, read_s=1.5, whole_s=60.0),
    "trickle": Timeouts(connect_s=30.0, read_s=30.0, whole_s=1.5),
}
# What the promise of cancelling within half a second may miss on a busy machine, of 20 s and more.
CANCEL_S, BUSY_S = 0.5, 5.0
# Long enough to hang in, were there anything to hang in.
HANG = Timeouts(connect_s=60.0, read_s=60.0, whole_s=120.0)
# What does not pass fails the pictures as the reason says.
LASTING = {
    **BROKEN,
    **SPOILT,
    **{kind: "(tried 2 times)" for kind in PASSING if not kind.startswith("429")},
    "trickle": "no whole answer within 1.5 s",
}


@contextmanager
def opened(server, cache=None, timeouts=PATIENT, tries=2, template=None, connections=4):
    client = Client(
        RequestsTransport(connections, timeouts),
        "The provider",
        connections=connections,
        tries=tries,
        first_wait_s=0.01,
    )
    with closing(
        XYZSource(
            template or server.url_template,
            name="provider",
            title="The provider",
            attribution="© provider",
            placeholder=PLACEHOLDER,
            client=client,
            cache=TileCache(cache) if cache else None,
        )
    ) as source:
        yield source


def run(server, folder, *, resume=False, connections=4, listener=None, **options):
    with opened(server, connections=connections, **options) as source:
        return capture(
            PLAN,
            source,
            folder,
            connections=connections,
            workers=2,
            resume=resume,
            listener=listener or Listener(),
        )


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "out"
    with TileServer() as server:
        result = run(server, folder)
    assert (result.written, result.requests) == (len(PLAN), len(TILES))
    return files(folder)


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


def files(folder):
    """All files but the journal, whose lines are in the order of chance."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != "journal.jsonl"
    }


def last_outcomes(folder):
    lines = (folder / "journal.jsonl").read_text(encoding="utf-8").splitlines()
    return {line["name"]: line for line in map(json.loads, lines)}


def check(folder, failed=frozenset(), reason="", *, stopped=False):
    """Pictures that are there are right to the last pixel, and those that are not are named with the reason."""
    table = Table.load(folder / "satellite" / "meta_data.csv")
    rows = {name.partition(".tif")[0]: (table.status[i], table.reason[i]) for i, name in enumerate(table.img_names)}
    outcomes = last_outcomes(folder)
    assert set(rows) == set(outcomes)
    there = {path.name.partition(".tif")[0] for path in (folder / "satellite").glob("*.tif")}
    assert not list(folder.rglob("*.part"))
    for index, name in enumerate(PLAN.names):
        if stopped and name not in rows:
            assert name not in there
            continue
        if name in failed:
            assert rows[name][0] == outcomes[name]["status"] == "failed"
            assert rows[name][1] == outcomes[name]["reason"]
            assert rows[name][1].startswith("tile ")
            assert reason in rows[name][1]
            assert name not in there
            continue
        assert rows[name] == ("done", "")
        columns, lines = decode_position(np.asarray(Image.open(folder / "satellite" / f"{name}.tif")))
        window = WINDOWS[index]
        expected = (
            np.arange(window.width_px) + int(window.left_px),
            np.arange(window.height_px) + int(window.top_px),
        )
        assert columns.shape == (window.height_px, window.width_px)
        assert (columns == expected[0] % MODULUS).all()
        assert (lines == (expected[1] % MODULUS)[:, np.newaxis]).all()


def test_the_list_of_faults_is_whole():
    assert {*LASTING, *PASSING, *REFUSED, "bad-copy"} == set(FAULTS)
    assert 0 < len(CONCERNED) < len(PLAN)


# Each fault is tried on the source alone (test_faults); here those that stand for a kind.
@pytest.mark.parametrize(
    "kind",
    thinned(
        named([*PASSING, *SPOILT, "bad-copy"]),
        ("503", "429-seconds", "stall-mid-body", "reset", "truncated-jpeg", "bad-copy"),
    ),
)
def test_what_passes_costs_nothing(server, tmp_path, whole, kind):
    server.fail(kind, *BAD, times=None if kind == "bad-copy" else 1)
    options = {"cache": tmp_path / "cache", "timeouts": TIMEOUTS.get(kind, PATIENT)}
    result = run(server, tmp_path / "out", **options)
    assert (result.written, result.failed) == (len(PLAN), ())
    check(tmp_path / "out")
    assert files(tmp_path / "out") == whole
    # Each tile once, and once more where it failed.
    assert server.tile_requests == {("", *tile): 1 + (tile in BAD) for tile in TILES}
    assert check_cache(tmp_path / "cache") == len(TILES)


@pytest.mark.parametrize(
    ("kind", "reason"),
    thinned(
        {kind: (kind, reason) for kind, reason in LASTING.items()},
        (
            "404",
            "204",
            "500",
            "trickle",
            "reset",
            "truncated-jpeg",
            "wrong-size",
            "flat",
            "bomb",
            "redirects",
        ),
    ),
)
def test_what_lasts_fails_the_pictures_it_concerns_until_it_is_over(server, tmp_path, whole, kind, reason):
    server.fail(kind, *BAD)
    options = {"cache": tmp_path / "cache"}
    result = run(server, tmp_path / "out", timeouts=TIMEOUTS.get(kind, PATIENT), **options)
    assert {failure.name for failure in result.failed} == CONCERNED
    assert result.written == len(PLAN) - len(CONCERNED)
    check(tmp_path / "out", CONCERNED, reason)
    assert check_cache(tmp_path / "cache") == len(TILES) - len(BAD)

    server.heal()
    before = server.tile_requests
    if kind in SPOILT:
        assert {before[("", *tile)] for tile in BAD} == {2}
    resumed = run(server, tmp_path / "out", resume=True, **options)
    assert (resumed.written, resumed.skipped, resumed.failed) == (len(CONCERNED), result.written, ())
    check(tmp_path / "out")
    assert files(tmp_path / "out") == whole
    # Nothing of the fault was kept, and all else was.
    assert {tile[1:] for tile in server.tile_requests - before} == BAD
    assert check_cache(tmp_path / "cache") == len(TILES)


@pytest.mark.parametrize(
    ("kind", "words"),
    sampled(
        [
            *REFUSED.items(),
            ("429-seconds", "429 Too Many Requests: slow down"),
            ("429-date", "429 Too Many Requests"),
        ],
        3,
    ),
    ids=[*REFUSED, "429-seconds", "429-date"],
)
def test_a_refusal_stops_the_run_with_the_provider_s_words(server, tmp_path, whole, kind, words):
    bad = max(BAD)
    server.fail(kind, bad)
    with pytest.raises(SourceError) as refused:
        run(server, tmp_path / "out", cache=tmp_path / "cache")
    assert str(refused.value).startswith("The provider")
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
    # Asked once, or as often as is polite, and no more.
    assert server.tile_requests["", bad[0], bad[1], bad[2]] <= 2
    check(tmp_path / "out", stopped=True)
    check_cache(tmp_path / "cache")
    server.heal()
    resumed = run(server, tmp_path / "out", resume=True, cache=tmp_path / "cache")
    assert (resumed.written + resumed.skipped, resumed.failed) == (len(PLAN), ())
    assert files(tmp_path / "out") == whole


def test_a_refusal_of_everything_costs_a_handful_of_requests(server, tmp_path):
    server.fail("quota")
    with pytest.raises(SourceError, match="quota"):
        run(server, tmp_path / "out")
    # Those under way at once, and those handed to the connections ahead of them.
    assert sum(server.requests.values()) <= 3 * 4


def test_many_faults_at_rates(server, tmp_path, whole):
    for kind in ("500", "503", "408", "reset", "short-body", "bad-copy"):
        server.fail(kind, share=0.1, times=1)
    for kind in ("404", "corrupt", "truncated-jpeg", "html", "flat", "wrong-size"):
        server.fail(kind, share=0.04)
    result = run(server, tmp_path / "out", cache=tmp_path / "cache", tries=6)
    assert 0 < len(result.failed) < len(PLAN)
    check(tmp_path / "out", {failure.name for failure in result.failed})
    server.heal()
    resumed = run(server, tmp_path / "out", resume=True, cache=tmp_path / "cache")
    assert resumed.failed == ()
    assert files(tmp_path / "out") == whole
    assert check_cache(tmp_path / "cache") == len(TILES)


def test_a_server_that_dies_amid_a_capture(tmp_path, whole):
    with TileServer() as server:
        seen = []
        real = server.tile

        def tile(handler, *address):
            seen.append(address)
            if len(seen) > len(TILES) // 2:
                handler.server.socket.close()
                handler.close_connection = True
                return
            real(handler, *address)

        server.tile = tile
        result = run(server, tmp_path / "out", cache=tmp_path / "cache")
    failed = {failure.name for failure in result.failed}
    assert 0 < len(failed) <= len(PLAN)
    check(tmp_path / "out", failed)
    with TileServer() as server:
        run(server, tmp_path / "out", resume=True, cache=tmp_path / "cache")
    assert files(tmp_path / "out") == whole


def fetching():
    """Threads of captures."""
    return {t for t in threading.enumerate() if t.name.startswith(("terrainav-fetch", "terrainav-work"))}


@pytest.mark.parametrize("kind", ["stall", "stall-mid-body", "trickle", "429-seconds", "503", "unfinished-connection"])
def test_every_wait_of_a_capture_ends_when_it_is_cancelled(server, deaf_template, tmp_path, kind):
    template = deaf_template if kind == "unfinished-connection" else None
    if template is None:
        server.fail(kind)
    stop, before = threading.Event(), fetching()
    ended = {}

    def work():
        with opened(server, timeouts=HANG, tries=50, template=template) as source:
            result = capture(PLAN, source, tmp_path / "out", connections=4, listener=Listener(cancelled=stop.is_set))
            ended.update(capture=time.monotonic(), cancelled=result.cancelled)
        ended["source"] = time.monotonic()

    running = threading.Thread(target=work)
    running.start()
    # Until it waits: for the server, for its turn to try again, or for a connection.
    requests = {"429-seconds": 2, "503": 2, "unfinished-connection": 0}.get(kind, 1)
    wait_until(lambda: fetching() - before and sum(server.requests.values()) >= requests)
    time.sleep(0.1)
    assert running.is_alive()
    asked = time.monotonic()
    stop.set()
    running.join(PATIENCE_S)
    assert not running.is_alive()
    assert ended["cancelled"]
    assert ended["source"] - asked < CANCEL_S + BUSY_S
    # No thread stays behind in a request.
    wait_until(lambda: fetching() <= before)
    if template is None:
        server.heal()
        resumed = run(server, tmp_path / "out", resume=True)
        assert resumed.written == len(PLAN)
        check(tmp_path / "out")
