"""Files that come for places far apart, against pairs of places looked at one by one."""

from __future__ import annotations

import hashlib
import itertools
import random
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.placeholder import Repeats, corner
from terrainav.core.imagery.source import Window

ZOOM = 6
COLUMNS = 1 << ZOOM
GRID = PixelGrid()
GREY, BLUE = b"nothing here", b"open water"


def tile(x, y, size=256, zoom=ZOOM):
    return Window(zoom, x * size, y * size, size, size)


def place(x, y, size=256, zoom=ZOOM):
    return corner(zoom, x * size, y * size)


def digest(file):
    return hashlib.sha256(file).hexdigest()[:16]


def found(files, grid=GRID):
    """What is found of a mapping of (column, row) to files."""
    repeats = Repeats(grid)
    for (x, y), file in files.items():
        repeats.note(tile(x, y, grid.tile_px), file)
    return repeats.found()


def ground(columns, rows):
    """Files of ground that is nowhere the same."""
    return {(x % COLUMNS, y): f"{x} {y}".encode() for x in columns for y in rows}


def expected(files):
    """By looking at every pair of places: those far apart lie four tiles apart, or as far as any do."""

    def apart(places):
        steps = [(abs(a[0] - b[0]), abs(a[1] - b[1])) for a, b in itertools.combinations(places, 2)]
        return max([max(min(across, COLUMNS - across), down) for across, down in steps], default=0)

    by_file = {}
    for where, file in files.items():
        by_file.setdefault(file, []).append(where)
    far = min(4, apart(list(files)))
    return {
        digest(file): {place(*where) for where in places}
        for file, places in by_file.items()
        if len(places) >= 3 and apart(places) >= far
    }


@given(
    st.dictionaries(
        # Less than half way around the world, where the nearer way is the one that shows.
        st.tuples(st.integers(-10, 10).map(lambda x: x % COLUMNS), st.integers(3, 20)),
        st.sampled_from([GREY, BLUE, b"1", b"2", b"3", b"4"]),
        max_size=40,
    )
)
def test_every_pair_of_places_says_the_same(files):
    assert found(files) == expected(files)


def test_scattered_places_are_found_and_counted_whole():
    grey = [(3, 3), (9, 4), (17, 12), (4, 3)]
    files = {**ground(range(20), range(15)), **dict.fromkeys(grey, GREY)}
    assert found(files) == {digest(GREY): {place(*where) for where in grey}}


def test_a_pond_is_none():
    pond = [(x, y) for x in range(5, 9) for y in range(5, 9)]
    files = {**ground(range(20), range(15)), **dict.fromkeys(pond, BLUE)}
    assert found(files) == {}
    # One more tile makes it five wide.
    assert set(found({**files, (9, 5): BLUE})) == {digest(BLUE)}


def test_a_pond_where_the_map_s_edges_meet_is_none():
    pond = [(x % COLUMNS, 7) for x in (-2, -1, 0, 1)]
    files = {**ground(range(-8, 8), range(15)), **dict.fromkeys(pond, BLUE)}
    assert found(files) == {}
    assert set(found({**files, (2, 7): BLUE})) == {digest(BLUE)}


@pytest.mark.parametrize(("columns", "rows"), [(3, 1), (2, 2), (3, 3), (4, 3)])
def test_nothing_but_the_same_is_found_however_few_it_is(columns, rows):
    files = dict.fromkeys(itertools.product(range(columns), range(rows)), GREY)
    assert set(found(files)) == {digest(GREY)}


def test_two_are_not_several():
    assert found({(0, 0): GREY, (30, 0): GREY, (15, 0): b"ground"}) == {}
    repeats = Repeats(GRID)
    for _ in range(3):
        # Asked for anew, as when the disk has lost it.
        repeats.note(tile(0, 0), GREY)
        repeats.note(tile(30, 0), GREY)
    assert repeats.found() == {}


def test_that_of_the_most_places_comes_first():
    files = {(x, 0): GREY for x in range(5)} | {(x, 9): BLUE for x in range(6)}
    assert list(found(files)) == [digest(BLUE), digest(GREY)]


def test_tiles_of_other_sizes_and_zooms_lie_as_far_apart():
    assert set(found(dict.fromkeys([(0, 0), (1, 0), (9, 0)], GREY), PixelGrid(tile_px=768))) == {digest(GREY)}
    repeats = Repeats(GRID)
    for x, zoom in ((0, 6), (0, 7), (1, 7), (20, 7)):
        repeats.note(tile(x, 3, zoom=zoom), GREY)
    assert repeats.found() == {digest(GREY): {place(0, 3), *(place(x, 3, zoom=7) for x in (0, 1, 20))}}


def test_the_order_that_threads_come_in_changes_nothing():
    tiles = list(itertools.product(range(40), range(20)))
    files = {(x, y): (GREY if (x * 7 + y) % 5 == 0 else f"{x} {y}".encode()) for x, y in tiles}
    files.update(dict.fromkeys([(3, 3), (30, 4), (12, 18)], BLUE))
    in_order, in_threads = Repeats(GRID), Repeats(GRID)
    for where, file in files.items():
        in_order.note(tile(*where), file)
    random.Random(12).shuffle(tiles)

    def note(share):
        for where in share:
            in_threads.note(tile(*where), files[where])

    threads = [threading.Thread(target=note, args=(tiles[at::6],)) for at in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert list(in_order.found().items()) == list(in_threads.found().items())
    assert list(in_order.found()) == [digest(GREY), digest(BLUE)]
