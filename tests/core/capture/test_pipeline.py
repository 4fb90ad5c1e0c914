from __future__ import annotations

import threading
import time
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.capture import pipeline as pipeline_module
from terrainav.core.capture.pipeline import Pipeline, Spool, sweep
from terrainav.core.errors import PartError, SourceError
from terrainav.core.geodesy.frames import Windows
from terrainav.core.imagery.source import Part, Window

from tests.support.thinning import examples

# Far longer than anything here takes: a wait that lasts so long has failed.
NEVER_S = 30.0


def part(number: int) -> Part:
    return Part(Window(1, number, 0, 1, 1), 0, 0)


def pixels(window: Window):
    return np.full((1, 1, 3), int(window.left_px) % 256, np.uint8)


def last_users(pictures):
    """Numbers of the last pictures, given as lists of numbers of parts, that need a window."""
    return {part(number).window: job for job, numbers in enumerate(pictures) for number in numbers}.__getitem__


def run(pictures, *, fetch=pixels, work=None, go_on=lambda: True, connections=3, workers=2, spool=None):
    """Run pictures, given as lists of numbers of parts; returns results by picture, the pipeline, whether complete."""
    results = {}

    def finished(job, result):
        assert job not in results
        results[job] = result

    pipeline = Pipeline(
        last_users(pictures),
        fetch,
        work or (lambda job, parts, contents: sorted(int(c[0, 0, 0]) for c in contents.values())),
        finished,
        connections=connections,
        workers=workers,
        spool=spool,
    )
    jobs = ((job, [part(number) for number in numbers]) for job, numbers in enumerate(pictures))
    complete = pipeline.run(jobs, go_on)
    return results, pipeline, complete


@settings(max_examples=examples(40), deadline=None)
@given(
    st.lists(st.lists(st.integers(0, 30), min_size=1, max_size=6), max_size=60),
    st.integers(1, 5),
    st.integers(1, 4),
)
def test_each_part_is_fetched_once_and_each_picture_made(pictures, connections, workers):
    fetched = Counter()
    lock = threading.Lock()

    def fetch(window):
        with lock:
            fetched[window] += 1
        return pixels(window)

    results, pipeline, complete = run(pictures, fetch=fetch, connections=connections, workers=workers)
    assert complete
    assert results == {job: sorted(set(numbers)) for job, numbers in enumerate(pictures)}
    assert set(fetched.values()) <= {1}
    assert pipeline.requests == len(fetched) == len({number for numbers in pictures for number in numbers})
    assert pipeline._parts == {}


def test_parts_are_dropped_after_their_last_picture():
    """Pictures along a line that share a part with the next: what is kept does not grow with their number."""
    most = 0

    def go_on():
        nonlocal most
        most = max(most, len(pipeline_parts))
        return True

    pipeline_parts = {}
    pictures = [[number, number + 1] for number in range(3000)]
    pipeline = Pipeline(last_users(pictures), pixels, lambda *_: 0, lambda *_: None, connections=4, workers=2)
    pipeline_parts = pipeline._parts
    assert pipeline.run(((job, [part(n) for n in numbers]) for job, numbers in enumerate(pictures)), go_on)
    assert 0 < most < 300


def test_a_slow_part_does_not_take_the_whole_mission_into_memory():
    admitted = 0
    release = threading.Event()

    def jobs():
        nonlocal admitted
        for number in range(5000):
            admitted += 1
            yield number, [part(0), part(number + 1)]

    def fetch(window):
        if window.left_px == 0:
            assert release.wait(NEVER_S)
        return pixels(window)

    quiet = []

    def go_on():
        quiet.append(admitted)
        if len(quiet) > 5 and len(set(quiet[-5:])) == 1 and not release.is_set():
            assert 4 < admitted <= 300
            release.set()
        return True

    pictures = [[0, number + 1] for number in range(5000)]
    pipeline = Pipeline(last_users(pictures), fetch, lambda *_: 0, lambda *_: None, connections=4, workers=2)
    assert pipeline.run(jobs(), go_on)
    assert admitted == 5000


@pytest.mark.parametrize("at_once", [1, 3])
def test_of_large_pictures_few_are_on_the_way(at_once):
    admitted = finished = most = 0

    def jobs():
        nonlocal admitted, most
        for number in range(50):
            admitted += 1
            most = max(most, admitted - finished)
            yield number, [part(number)]

    def note(*_):
        nonlocal finished
        finished += 1

    users = last_users([[number] for number in range(50)])
    pipeline = Pipeline(users, pixels, lambda *_: 0, note, connections=4, workers=2, at_once=at_once)
    assert pipeline.run(jobs(), lambda: True)
    assert (most, finished) == (at_once, 50)


def test_fetching_and_making_overlap():
    """A picture is made while another part is under way: each waits for the other."""
    making, fetching = threading.Event(), threading.Event()

    def fetch(window):
        if window.left_px == 1:
            fetching.set()
            assert making.wait(NEVER_S)
        return pixels(window)

    def work(job, parts, contents):
        if job == 0:
            making.set()
            assert fetching.wait(NEVER_S)
        return job

    results, _, _ = run([[0], [1]], fetch=fetch, work=work)
    assert results == {0: 0, 1: 1}


def test_a_failed_part_fails_its_pictures_and_no_other():
    fetched = Counter()
    error = PartError("404")

    def fetch(window):
        fetched[window] += 1
        if window.left_px == 5:
            raise error
        return pixels(window)

    results, _, complete = run([[1, 5], [1, 2], [5], [3], [2, 5]], fetch=fetch)
    assert complete
    assert results == {0: error, 1: [1, 2], 2: error, 3: [3], 4: error}
    assert fetched[part(5).window] == 1


def test_a_picture_that_cannot_be_assembled_fails_alone():
    def work(job, parts, contents):
        if job == 1:
            raise PartError("hole")
        return job

    results, _, _ = run([[0], [1], [2]], work=work)
    assert (results[0], str(results[1]), results[2]) == (0, "hole", 2)


@pytest.mark.parametrize("error", [RecursionError("too deep"), ZeroDivisionError(), MemoryError()])
def test_an_error_of_a_part_that_nobody_foresaw_fails_its_pictures_and_is_logged_once(error, caplog):
    def fetch(window):
        if window.left_px in (10, 40):
            raise error
        return pixels(window)

    results, _, complete = run([[number] for number in range(60)], fetch=fetch)
    assert complete
    failed = {job: str(result) for job, result in results.items() if isinstance(result, PartError)}
    assert sorted(failed) == [10, 40]
    assert failed[10].startswith(f"unexpected error ({type(error).__name__}")
    (record,) = caplog.records
    assert "Traceback" in record.getMessage()
    assert "in fetch" in record.getMessage()


def test_other_errors_stop_the_run_and_keep_what_is_done():
    seen, error = [], SourceError("403: over quota")

    def fetch(window):
        if window.left_px == 50:
            raise error
        return pixels(window)

    users = last_users([[number] for number in range(5000)])
    pipeline = Pipeline(
        users, fetch, lambda job, *_: job, lambda job, result: seen.append(job), connections=1, workers=1
    )
    with pytest.raises(SourceError) as caught:
        pipeline.run(((number, [part(number)]) for number in range(5000)), lambda: True)
    assert caught.value is error
    assert set(range(40)) <= set(seen)
    assert len(seen) < 200


def test_an_error_while_making_stops_the_run():
    def work(job, parts, contents):
        raise OSError("disk")

    with pytest.raises(OSError, match="disk"):
        run([[0], [1]], work=work)


def test_cancelling_does_not_wait_for_the_source():
    hang = threading.Event()

    def fetch(window):
        hang.wait(NEVER_S)
        return pixels(window)

    started = time.monotonic()
    asked = []
    try:
        results, _, complete = run(
            [[n] for n in range(100)], fetch=fetch, go_on=lambda: asked.append(1) or len(asked) < 4
        )
        assert time.monotonic() - started < NEVER_S / 2
        assert not complete
        assert results == {}
    finally:
        hang.set()


def test_go_on_is_asked_while_nothing_happens():
    release = threading.Event()
    asked = []

    def fetch(window):
        assert release.wait(NEVER_S)
        return pixels(window)

    def go_on():
        asked.append(release.is_set())
        if len(asked) == 10:
            release.set()
        return True

    run([[0]], fetch=fetch, go_on=go_on)
    assert asked.count(False) == 10
    assert pipeline_module._POLL_S <= 0.1


def test_what_was_being_made_when_cancelled_is_reported():
    making, go = threading.Event(), threading.Event()

    def work(job, parts, contents):
        making.set()
        assert go.wait(NEVER_S)
        return job

    def go_on():
        if making.is_set():
            go.set()
            return False
        return True

    results, _, complete = run([[0]], work=work, go_on=go_on, workers=1)
    assert not complete
    assert results == {0: 0}


def kept_at_most(order, windows, tile=256) -> int:
    """Most tiles that have been fetched and are still needed, over a run in this order."""
    tiles = [
        {
            (x, y)
            for x in range(
                int(windows.left_px[i]) // tile, int(windows.left_px[i] + windows.width_px[i] - 1) // tile + 1
            )
            for y in range(
                int(windows.top_px[i]) // tile, int(windows.top_px[i] + windows.height_px[i] - 1) // tile + 1
            )
        }
        for i in order
    ]
    last = {t: at for at, needed in enumerate(tiles) for t in needed}
    kept, most = set(), 0
    for at, needed in enumerate(tiles):
        kept |= needed
        most = max(most, len(kept))
        kept = {t for t in kept if last[t] > at}
    return most


@pytest.mark.parametrize(("rows", "columns"), [(3, 200), (200, 3)])
def test_a_sweep_keeps_little_of_long_missions(rows, columns):
    row, column = (index.ravel() for index in np.mgrid[:rows, :columns])
    windows = Windows(column * 300 + row % 2 * 40, row * 220, np.full(row.size, 323), np.full(row.size, 242))
    chosen = np.random.default_rng(5).permutation(row.size)
    order = sweep(windows, chosen)
    assert sorted(order.tolist()) == sorted(chosen.tolist())
    assert kept_at_most(order, windows) <= 30


def test_sweeps_of_nothing_and_of_one():
    windows = Windows(*(np.array([5, 9]) for _ in range(4)))
    assert sweep(windows, np.array([], np.int64)).tolist() == []
    assert sweep(windows, np.array([1])).tolist() == [1]


def test_pictures_that_wait_for_the_workers_are_bounded_however_long_the_mission():
    """Workers slower than the source: fetching pauses, and what is kept does not grow with the mission."""
    kept = {}
    for length in (400, 4000):
        slow, most = threading.Semaphore(0), 0

        def work(job, parts, contents, slow=slow):
            assert slow.acquire(timeout=NEVER_S)
            return job

        pipeline = Pipeline(
            last_users([[number] for number in range(length)]),
            pixels,
            work,
            lambda *_: None,
            connections=4,
            workers=2,
        )

        def go_on(pipeline=pipeline, slow=slow):
            nonlocal most
            most = max(most, len(pipeline._making) + len(pipeline._parts))
            slow.release()
            return True

        assert pipeline.run(((number, [part(number)]) for number in range(length)), go_on)
        kept[length] = most
    # Ready pictures and requests ahead of need, each of which may hand one more picture on.
    ahead = 2 * pipeline_module._READY_PER_WORKER + 2 * 4 * pipeline_module._FETCHES_PER_CONNECTION
    assert max(kept.values()) <= ahead
    assert min(kept.values()) >= 2 * pipeline_module._READY_PER_WORKER


@pytest.mark.parametrize("off", [7, 200, -2])
def test_parts_go_when_the_last_image_that_may_need_them_has_begun_whether_it_did_or_not(off):
    pictures = [[number // 3, 1000 + number] for number in range(300)]
    exact, spool = last_users(pictures), Watched(20 * 3)
    fetched, made = Counter(), {}

    def fetch(window):
        fetched[window] += 1
        return pixels(window)

    pipeline = Pipeline(
        lambda window: exact(window) + off,
        fetch,
        lambda job, parts, contents: sorted(int(c[0, 0, 0]) for c in contents.values()),
        made.__setitem__,
        connections=3,
        workers=2,
        spool=spool,
    )
    jobs = ((job, lambda numbers=numbers: [part(n) for n in numbers]) for job, numbers in enumerate(pictures))
    assert pipeline.run(jobs, lambda: True)
    assert made == {job: sorted(n % 256 for n in numbers) for job, numbers in enumerate(pictures)}
    if off > 0:
        assert set(fetched.values()) == {1}
        assert pipeline.unique_parts == len(fetched) == 400
        # What images beyond the last one might still need.
        assert len(pipeline._parts) <= 2 * off
    else:
        assert pipeline.unique_parts >= len(fetched) == 400


def across(columns, rows):
    """Pictures in strips along the columns, each with a part of its own and one it shares with the next strip."""
    return [
        [strip * columns + column, (strip + 1) * columns + column] for strip in range(rows) for column in range(columns)
    ]


class Watched(Spool):
    """A spool that counts what it holds, and where."""

    def __init__(self, memory_bytes):
        super().__init__(memory_bytes)
        self.held = Counter()
        self.most = Counter()

    def put(self, pixels):
        slot = super().put(pixels)
        self._count(slot, 1)
        return slot

    def take(self, slot):
        self._count(slot, -1)
        return super().take(slot)

    def _count(self, slot, by):
        where = "file" if slot.held is None else "memory"
        self.held[where] += by
        self.most[where] = max(self.most[where], self.held[where])


@pytest.mark.parametrize("columns", [300, 900])
def test_what_is_kept_in_memory_does_not_grow_with_the_width_of_a_mission(columns):
    tile = np.zeros((4, 4, 3), np.uint8)
    spool, most = Watched(40 * tile.nbytes), 0
    pictures = across(columns, 4)
    fetched, made = Counter(), []

    def fetch(window):
        fetched[window] += 1
        return np.full_like(tile, int(window.left_px) % 251)

    def go_on():
        nonlocal most
        most = max(most, sum(isinstance(p.content, np.ndarray) for p in pipeline._parts.values()))
        return True

    pipeline = Pipeline(
        last_users(pictures),
        fetch,
        lambda job, parts, contents: [int(contents[p.window].mean()) for p in parts],
        lambda job, result: made.append((job, result)),
        connections=4,
        workers=2,
        spool=spool,
    )
    jobs = ((job, [part(n) for n in numbers]) for job, numbers in enumerate(pictures))
    assert pipeline.run(jobs, go_on)
    assert sorted(made) == [(job, [n % 251 for n in numbers]) for job, numbers in enumerate(pictures)]
    assert set(fetched.values()) == {1}
    assert spool.most["memory"] == 40
    # What a strip shares with the next, less what is in memory and what pictures on the way have.
    assert columns - 40 - 100 < spool.most["file"] <= columns - 40
    assert +spool.held == Counter()
    # Parts of pictures that are on the way: ready ones, and those whose parts are being fetched ahead.
    ahead = 2 * pipeline_module._READY_PER_WORKER + 4 * pipeline_module._FETCHES_PER_CONNECTION
    assert most <= 2 * ahead


@settings(max_examples=examples(30), deadline=None)
@given(
    st.lists(st.lists(st.integers(0, 30), min_size=1, max_size=6), max_size=60),
    st.integers(0, 40),
    st.sets(st.integers(1, 30)),
    st.sets(st.integers(1, 30)),
)
def test_results_do_not_depend_on_where_parts_are_put_aside(pictures, memory_bytes, no_puts, no_takes):
    """With any memory, and a disk that fails now and then: more is fetched or kept, and every picture is made."""

    class Failing(Spool):
        puts = takes = 0

        def put(self, pixels):
            self.puts += 1
            if self.puts in no_puts:
                raise OSError("full")
            return super().put(pixels)

        def take(self, slot):
            self.takes += 1
            if self.takes in no_takes:
                raise OSError("unreadable")
            return super().take(slot)

    spool = Failing(memory_bytes)
    results, pipeline, complete = run(pictures, spool=spool)
    assert complete
    assert results == {job: sorted(set(numbers)) for job, numbers in enumerate(pictures)}
    unreadable = len([n for n in no_takes if n <= spool.takes])
    assert pipeline.requests == len({n for numbers in pictures for n in numbers}) + unreadable
    assert pipeline._parts == {}
