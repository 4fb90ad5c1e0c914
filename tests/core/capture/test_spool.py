from __future__ import annotations

import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.capture.pipeline import Spool

from tests.support.thinning import examples

SHAPES = ((4, 4, 3), (4, 4, 4), (1, 1, 3), (8, 2, 3))


def array(number):
    """Pixels that no other number has; every other one a view with gaps."""
    height, width, channels = SHAPES[number % len(SHAPES)]
    rng = np.random.default_rng(number)
    if number % 2:
        return rng.integers(0, 256, (height, width, channels + 1), np.uint8)[..., :channels]
    return rng.integers(0, 256, (height, width, channels), np.uint8)


@settings(max_examples=examples(60), deadline=None)
@given(st.integers(0, 300), st.lists(st.integers(-5, 5), max_size=60))
def test_what_is_taken_is_what_was_put(memory_bytes, steps):
    """Steps put (from 0) or take the array put so many before the last."""
    spool, held, number = Spool(memory_bytes), [], 0
    for step in steps:
        if step >= 0 or not held:
            held.append((number, spool.put(array(number))))
            number += 1
        else:
            taken, slot = held.pop(step % len(held))
            back = spool.take(slot)
            wanted = array(taken)
            assert (back.shape, back.dtype) == (wanted.shape, wanted.dtype)
            assert np.array_equal(back, wanted)
        assert sum(slot.held.nbytes for _, slot in held if slot.held is not None) <= memory_bytes
        spans = sorted((slot.at, slot.at + array(n).nbytes) for n, slot in held if slot.held is None)
        assert all(end <= start for (_, end), (start, _) in zip(spans, spans[1:]))
    for left, slot in held:
        assert np.array_equal(spool.take(slot), array(left))
    spool.close()


def test_the_room_of_what_was_taken_is_used_again(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    pixels = np.ones((16, 16, 3), np.uint8)
    spool = Spool(2 * pixels.nbytes)
    for _ in range(50):
        slots = [spool.put(pixels) for _ in range(5)]
        for slot in slots:
            spool.take(slot)
    assert sorted(slot.at // pixels.nbytes for slot in slots if slot.held is None) == [0, 1, 2]
    assert os.fstat(spool._file.fileno()).st_size == 3 * pixels.nbytes
    assert [spool.put(pixels).held is None for _ in range(3)] == [False, False, True]
    spool.close()
    assert list(tmp_path.iterdir()) == []


def test_no_file_is_made_while_memory_suffices(monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("a file was made")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    spool = Spool(48)
    spool.take(spool.put(np.ones((4, 4, 3), np.uint8)))
    spool.close()


def test_a_full_disk_is_an_oserror_and_keeps_nothing():
    spool = Spool(0)
    kept = spool.put(np.full((4, 4, 3), 7, np.uint8))
    whole = spool._file

    class Full:
        def seek(self, at):
            return whole.seek(at)

        def write(self, data):
            whole.write(bytes(data)[:10])
            return 10

    spool._file = Full()
    with pytest.raises(OSError, match="part of an array"):
        spool.put(np.ones((4, 4, 3), np.uint8))
    spool._file = whole
    again = spool.put(np.full((4, 4, 3), 9, np.uint8))
    assert again.at == 48
    assert (spool.take(kept) == 7).all()
    assert (spool.take(again) == 9).all()
    spool.close()


def test_a_folder_that_takes_no_file_is_an_oserror(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "not there"))
    with pytest.raises(FileNotFoundError):
        Spool(0).put(np.ones((4, 4, 3), np.uint8))
