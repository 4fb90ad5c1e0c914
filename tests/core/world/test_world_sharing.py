"""What tiles of the embedded world share, and the quick ways to draw them: the same landscape, worked out once."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from terrainav.core.world import World, objects, parcels
from terrainav.core.world.parcels import Parcels, root_squares
from terrainav.core.world.region import Region
from terrainav.core.world.samples import Grid, TilePositions, shared

from tests.support.thinning import sampled

SEED = 2024
#: The paper's Agricenter, as world fractions.
AGRICENTER = (0.25038, 0.39581)
#: Tiles and sums of their grey levels over squares of 64 px, made before tiles shared anything: columns style, seed,
#: zoom, x, y, then the 16 sums by rows. Running this file makes it anew, from another landscape.
SUMS = Path(__file__).with_name("world_sums.csv")
STYLES = ("satellite", "roadmap", "terrain")
#: Grey values of the 12,288 of a square that may be rounded the other way where a processor has other sines, and
#: exponentials, than the one that made the sums; a tree more or less makes thousands.
OTHER_SINES = 8


def sums(style, seed, zoom, x, y):
    tile = World(seed).tile(style, zoom, x, y).astype(np.int64)
    return tile.reshape(4, 64, 4, 64, 3).sum(axis=(1, 3, 4)).ravel()


def places():
    """Tiles of all styles at zooms 3 to 21: about the Agricenter, and anywhere."""
    random = np.random.default_rng(20)
    for zoom in range(3, 22):
        for style in range(3):
            for n in range(3 if zoom < 14 else 6):
                spread = random.normal(size=2) * 3e-4
                u, v = np.array(AGRICENTER) + spread if n % 2 else random.uniform((0, 0.1), (1, 0.85))
                yield style, SEED if n % 3 else 7, zoom, int(u % 1 * 2**zoom), int(v * 2**zoom)


@pytest.mark.parametrize("step", [5, pytest.param(1, marks=pytest.mark.thorough)])
def test_the_landscape_is_the_one_it_was(step):
    known = np.loadtxt(SUMS, dtype=np.int64, delimiter=",")
    assert {tuple(row) for row in known[:, 2:3].tolist()} == {(zoom,) for zoom in range(3, 22)}
    for style, seed, zoom, x, y, *wanted in known[::step].tolist():
        moved = np.abs(sums(STYLES[style], seed, zoom, x, y) - wanted)
        assert moved.max() <= OTHER_SINES, f"{STYLES[style]} {zoom}/{x}/{y}: {moved}"


def at_a_corner_of_root_squares(zoom):
    """A tile that four root squares meet in, and its neighbours."""
    x, y = (int(place * 2**zoom) for place in AGRICENTER)
    side = 2 ** max(zoom - 13, 0)
    for dx in range(-side, side):
        for dy in range(-side, side):
            grid = Grid(zoom, x + dx, y + dy)
            squares = root_squares(Region.around(SEED, grid), grid)[0]
            if squares[0] < squares[1] and squares[2] < squares[3]:
                return x + dx, y + dy
    raise AssertionError


@pytest.mark.parametrize("zoom", sampled([15, 16, 17, 18, 20, 22], 2))
def test_pieces_found_by_their_lines_are_those_found_by_walking_down(zoom, monkeypatch):
    x, y = at_a_corner_of_root_squares(min(zoom, 17))
    more = max(zoom - 17, 0)
    here = [(x << more, y << more), *((int(u * 2**zoom) + 3, int(v * 2**zoom)) for u, v in [AGRICENTER])]
    for tile in here:
        found = []
        for few in (10**6, 0):
            monkeypatch.setattr(parcels, "_FEW", few)
            grid = Grid(zoom, *tile)
            pieces = Parcels(SEED, Region.around(SEED, grid), grid)
            found.append(pieces.at[pieces.index])
        np.testing.assert_array_equal(*found)
        assert zoom > 18 or found[0].min() < found[0].max()


def test_samples_right_on_a_line_are_on_the_same_side_of_it():
    grid = Grid(17, *at_a_corner_of_root_squares(17))
    pieces = Parcels(SEED, Region.around(SEED, grid), grid)
    leaves, at = pieces.division.leaves, pieces.at
    ends = [edges[at] + pieces.corner[0] for edges in (leaves.x0, leaves.x1)]
    inside = [end[(end > pieces.x.min()) & (end < pieces.x.max())] for end in ends]
    on_lines = np.unique(np.concatenate(inside)).astype(np.float32)
    assert np.float32(parcels.ROOT_M + pieces.corner[0]) in on_lines
    pieces.x[:, : on_lines.size] = on_lines
    assert pieces._find_few(at)
    drawn = at[pieces.index]
    pieces.index = np.zeros(pieces.shape, dtype=np.intp)
    walked = pieces._descend()[pieces.index]
    np.testing.assert_array_equal(drawn, walked)


@pytest.mark.parametrize("count", [0, 1, 5, 21, 400])
def test_lines_are_counted_as_one_by_one(count):
    random = np.random.default_rng(count)
    c = random.uniform(-3, 150, (40, 50)).astype(np.float32)
    # Some right on a sample, some next to each other, some beyond all.
    lines = np.unique(np.concatenate([random.choice(c.ravel(), count), random.normal(70, 1e-4, count), [170.0]]))
    lines = lines[lines >= c.min()].astype(np.float32)
    np.testing.assert_array_equal(parcels._count_passed(c, lines), sum((c > line).astype(int) for line in lines))


@pytest.mark.parametrize("zoom", [16, 17, 19, 22])
def test_trees_are_planted_for_many_tiles_as_for_one(zoom, monkeypatch):
    """On the land as it is divided for each tile alone, too."""
    squares, chance = [], objects._chance

    def noted(scene):
        squares.append((len(scene.samples.columns), scene.parcels.roots))
        return chance(scene)

    monkeypatch.setattr(objects, "_chance", noted)
    corner = at_a_corner_of_root_squares(min(zoom, 17))
    step = np.arange(2 if zoom == 16 else 4)
    x, y = (
        (place << max(zoom - 17, 0)) // step.size * step.size + shift.ravel()
        for place, shift in zip(corner, np.meshgrid(step, step))
    )
    together = objects._chances(SEED, zoom, x, y)[0]
    of_all = [roots for count, roots in squares for _ in range(count)]
    squares.clear()
    for n in range(x.size):
        alone = objects._chances(SEED, zoom, x[n : n + 1], y[n : n + 1])[0]
        np.testing.assert_array_equal(together[n : n + 1], alone)
    assert sorted(of_all, key=str) == sorted((roots for _, roots in squares), key=str)
    assert zoom > 17 or len(set(of_all)) > 1
    assert zoom > 19 or np.ptp(together) > 0


def test_cells_of_many_tiles_lie_where_those_of_one_do():
    region = Region.around(SEED, Grid(18, *(int(place * 2**18) for place in AGRICENTER)))
    x, y = (int(place * 2**18) // 4 * 4 + np.arange(4) for place in AGRICENTER)
    tiles = TilePositions(18, x, y, 22)
    centres = np.arange(-1, 17) + 0.5
    assert tiles.shape == (4, 18, 18)
    for n in range(4):
        east, south = (metres[n].ravel() for metres in tiles.local_m())
        np.testing.assert_allclose(east, centres * 2**-22 * 40075016.685578488, rtol=1e-6)
        np.testing.assert_array_equal(east, south)
        np.testing.assert_array_equal(
            region.value("warp_x", tiles)[n],
            region.value("warp_x", TilePositions(18, x[n : n + 1], y[n : n + 1], 22))[0],
        )


def test_threads_that_ask_for_the_same_wait_for_the_one_that_works_it_out():
    asked, others = [], threading.Barrier(8)

    @shared(4)
    def slow(key):
        asked.append(key)
        threading.Event().wait(0.05)
        return [key]

    def ask(key):
        others.wait()
        return slow(key)

    with ThreadPoolExecutor(8) as pool:
        results = list(pool.map(ask, [1, 2] * 4))
    assert sorted(asked) == [1, 2]
    assert all(result is slow(1 + n % 2) for n, result in enumerate(results))


def test_only_the_last_results_are_kept():
    asked = []

    @shared(2)
    def noted(key):
        asked.append(key)
        return key

    assert [noted(key) for key in (1, 2, 1, 3, 1, 2)] == [1, 2, 1, 3, 1, 2]
    assert asked == [1, 2, 3, 2]


def test_what_went_wrong_is_tried_again():
    asked = []

    @shared(2)
    def fails_once(key):
        asked.append(key)
        if len(asked) == 1:
            raise MemoryError
        return key

    with pytest.raises(MemoryError):
        fails_once(5)
    assert fails_once(5) == 5


def test_connections_share_what_tiles_have_in_common(monkeypatch):
    x, y = (int(place * 2**18) // 4 * 4 for place in AGRICENTER)
    asked = []
    stand = objects._stand.__wrapped__

    @shared(32)
    def counted(*arguments):
        asked.append(arguments)
        return stand(*arguments)

    monkeypatch.setattr(objects, "_stand", counted)
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda n: World(SEED).tile("satellite", 18, x + n % 8, y + n // 8), range(32)))
    assert len(asked) == 2
    assert len(set(asked)) == 2


if __name__ == "__main__":
    rows = [[*place, *sums(STYLES[place[0]], *place[1:])] for place in places()]
    np.savetxt(SUMS, np.array(rows), fmt="%d", delimiter=",")
