"""Deflate streams: zlib reads them back, and they are hardly larger than its own."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
import pytest
from terrainav.core.arrays import Bytes
from terrainav.core.deflate import zlib_stream

RANDOM = np.random.default_rng(35)


def photograph(count: int) -> Bytes:
    """Differences as photographs have them: few are large."""
    return np.round(RANDOM.laplace(0.0, 6.0, count)).astype(np.int64).astype(np.uint8)


def rare_values(count: int) -> Bytes:
    """Values of which each is half as frequent as the one before, so that Huffman's codes would be too long."""
    return np.minimum(RANDOM.geometric(0.5, count), 40).astype(np.uint8) * np.uint8(37)


CASES: dict[str, Any] = {
    "photograph": photograph(300_000),
    "noise": RANDOM.integers(0, 256, 150_001, np.uint8),
    "rare values": rare_values(200_003),
    "one value": np.full(100_002, 7, np.uint8),
    "drawn map": np.repeat(RANDOM.integers(0, 4, 4_000, np.uint8), 40),
    "16 bits": RANDOM.poisson(900, 60_000).astype("<u2").view(np.uint8),
    **{f"{count} bytes": photograph(count) for count in (0, 1, 3, 65_535, 65_536, 65_537, 65_539, 131_072, 131_075)},
}


@pytest.mark.parametrize("name", CASES)
def test_zlib_reads_the_stream(name: str) -> None:
    data = CASES[name]
    stream = zlib_stream([data])
    assert zlib.decompress(stream) == data.tobytes()
    packer = zlib.compressobj(6, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE)
    assert len(stream) <= 1.05 * len(packer.compress(data.tobytes()) + packer.flush()) + 16


def test_blocks_of_a_stream_have_codes_of_their_own() -> None:
    blocks = [CASES[name] for name in ("photograph", "drawn map", "noise", "3 bytes")]
    stream = zlib_stream(blocks)
    assert zlib.decompress(stream) == np.concatenate(blocks).tobytes()
    assert len(stream) <= sum(len(zlib_stream([block])) for block in blocks)
