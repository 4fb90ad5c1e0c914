"""Blocks of neighbouring captures."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.capture.blocks.division import MOST_IMAGES, divide, parse_block_size
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.frames import Windows
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.sources import PatternSource
from tests.support.thinning import examples


def windows(left, top, size=640):
    left, top = np.asarray(left, np.int64), np.asarray(top, np.int64)
    return Windows(left, top, np.full(len(left), size), np.full(len(left), size))


@given(
    st.lists(st.tuples(st.integers(-(10**6), 10**6), st.integers(0, 10**6)), min_size=1, max_size=200),
    st.integers(1, 60),
)
@settings(max_examples=examples(50), deadline=None)
def test_each_capture_is_in_one_block_and_blocks_are_of_one_size(places, images):
    blocks = divide(windows(*zip(*places)), images)
    assert sorted(np.concatenate(blocks).tolist()) == list(range(len(places)))
    sizes = [len(block) for block in blocks]
    assert max(sizes) <= images
    assert len(blocks) == -(-len(places) // images)
    assert max(sizes) - min(sizes) <= int(np.ceil(np.log2(max(len(blocks), 2))))
    assert all((np.diff(block) > 0).all() for block in blocks)


def tiles_of(worked_out, indices):
    """Tiles of some captures, counted one by one."""
    found = set()
    for index in indices:
        left, top, width, height = (int(values[index]) for values in worked_out.windows)
        found |= {
            (x, y)
            for x in range(left // 256, (left + width - 1) // 256 + 1)
            for y in range(top // 256, (top + height - 1) // 256 + 1)
        }
    return found


@pytest.mark.parametrize("overlap", [0.0, 0.6])
@pytest.mark.parametrize("box", [Box(35.16, -89.90, 35.14, -89.875), Box(35.16, -89.90, 35.157, -89.78)])
def test_blocks_share_fewer_tiles_than_pieces_of_the_flight_do(box, overlap):
    worked_out = plan(Mission(box, 120.0, overlap_along=overlap), PatternSource().grid)
    images = 48
    in_all = len(tiles_of(worked_out, range(len(worked_out))))
    blocks = sum(len(tiles_of(worked_out, block)) for block in divide(worked_out.windows, images))
    pieces = sum(
        len(tiles_of(worked_out, range(start, min(start + images, len(worked_out)))))
        for start in range(0, len(worked_out), images)
    )
    assert in_all <= blocks <= pieces
    # As many as squares of so many images share on average: half a tile along each edge, and as much again.
    assert blocks / in_all < 1.35


@pytest.mark.parametrize(("size", "images"), [("256", 256), ("1", 1), ("200MB", 400), ("0.2 mb", 1), ("1.5MB", 3)])
def test_a_block_is_stated_in_images_or_megabytes(size, images):
    assert parse_block_size(size, lambda: 5e5) == images


@pytest.mark.parametrize("size", ["0", "-3", "many", "2.5", "0MB", str(MOST_IMAGES + 1), "1e3", ""])
def test_another_size_is_refused_in_one_line(size):
    with pytest.raises(InvalidInput, match=rf"^block '{size}': must be 1 to 100,000 images"):
        parse_block_size(size, lambda: 5e5)
