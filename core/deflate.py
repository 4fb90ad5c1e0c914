"""Deflate streams of differences of pixels (RFC 1950 and 1951), whose Huffman codes numpy packs.

Differences of photographs hardly repeat: nearly all that compression saves is due to Huffman codes, which numpy applies
in a third of zlib's time, with the same size within a few percent. Where values do repeat, as in drawn maps, zlib's
search for runs is quick and saves more. numpy releases Python's lock, as zlib does.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from heapq import heapify, heappop, heapreplace

import numpy as np

from .arrays import Bytes, NDArray

#: Longest code, bits: four codes and a pair's length fit in 64 and 32 bits.
_MAX_BITS = 13
#: Bits of a pair's codes in its entry of the table; its length is above.
_PAIR_BITS = 2 * _MAX_BITS
#: Bytes packed at once, so that intermediate arrays stay in the processor's cache.
_CHUNK_BYTES = 1 << 16
#: Every n-th byte is counted; odd, and no multiple of 3, so that all channels and bytes of values are.
_SAMPLE_STEP = 13
#: Share of bytes equal to the three before, from which runs save more than about 5 %.
_RUNS = 0.4
#: Below this many bytes, zlib is as quick, and the codes of a block weigh more.
_FEW_BYTES = 1 << 16
_END_OF_BLOCK = 256
#: Bits that begin a dynamic block, not the last: 257 codes of literals, 2 of distances, and a code of 4 bits for each
#: of the lengths 0 to 15, so that a length is its own code.
_BLOCK_BITS = np.array([0, 0, 1, *(0,) * 5, 1, *(0,) * 4, *(1,) * 4, *(0,) * 9, *(0, 0, 1) * 16], np.uint8)
#: Length of the codes of both distances, which are never used: some readers accept no empty code.
_DISTANCES = [1, 1]
_HEADER, _LAST_BLOCK = b"\x78\x01", b"\x03\x00"


def zlib_stream(blocks: Iterable[Bytes]) -> bytes:
    """Compress blocks of bytes, each with codes for its own values, which take a millisecond to find.

    Parameters
    ----------
    blocks : iterable of contiguous array (n,) of uint8
        Each is used before the next is asked for.

    Returns
    -------
    bytes
        Stream with zlib's header and checksum.
    """
    pieces, checksum = [_HEADER], 1
    for data in blocks:
        pieces.append(_with_runs(data) if _has_runs(data) else _huffman_block(data))
        checksum = zlib.adler32(data.data, checksum)
    return b"".join([*pieces, _LAST_BLOCK, checksum.to_bytes(4, "big")])


def _has_runs(data: Bytes) -> bool:
    """Whether values repeat so often that runs save more than a few percent; also for short data."""
    if len(data) < _FEW_BYTES:
        return True
    first, *others = (data[at : len(data) - 3 + at : _SAMPLE_STEP] for at in range(4))
    return float(np.logical_and.reduce([first == other for other in others]).mean()) > _RUNS


def _with_runs(data: Bytes) -> bytes:
    """Compress with zlib's search for runs; ends at a whole byte."""
    pack = zlib.compressobj(6, zlib.DEFLATED, -zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE)
    return pack.compress(data.data) + pack.flush(zlib.Z_SYNC_FLUSH)


def _huffman_block(data: Bytes) -> bytes:
    """Code each byte by itself; ends at a whole byte, with an empty block."""
    counts = np.bincount(data[::_SAMPLE_STEP], minlength=256)
    lengths = _code_lengths([*counts.tolist(), 1])
    codes = _codes(np.array(lengths))
    table = _pair_table(codes[:256], np.array(lengths[:256], np.uint32))
    of_lengths = np.array([*lengths, *_DISTANCES], np.uint8)[:, np.newaxis] >> np.array([3, 2, 1, 0], np.uint8) & 1
    head = np.concatenate([_BLOCK_BITS, of_lengths.ravel()])
    begun = int.from_bytes(np.packbits(head, bitorder="little").tobytes(), "little")
    whole = len(head) // 64
    pieces = [(begun & ((1 << 64 * whole) - 1)).to_bytes(8 * whole, "little")]
    carry, at = begun >> 64 * whole, len(head) % 64
    fours = len(data) // 4 * 4
    for start in range(0, fours, _CHUNK_BYTES):
        words, carry, at = _packed(data[start : min(start + _CHUNK_BYTES, fours)], table, carry, at)
        pieces.append(words)
    for symbol in [*data[fours:].tolist(), _END_OF_BLOCK]:
        carry |= int(codes[symbol]) << at
        at += lengths[symbol]
    # An empty stored block: three bits, the rest of the byte, and its length twice.
    pieces.append(carry.to_bytes((at + 3 + 7) // 8, "little"))
    pieces.append(b"\x00\x00\xff\xff")
    return b"".join(pieces)


def _packed(data: Bytes, table: NDArray[np.uint32], carry: int, at: int) -> tuple[bytes, int, int]:
    """Pack the codes of bytes, whose number is a multiple of 4, behind the ``at`` bits of a word begun."""
    pairs = table.take(data.view("<u2")).view("<u8").astype(np.uint64, copy=False)
    mask, length_of_first = np.uint64((1 << _PAIR_BITS) - 1), (pairs >> np.uint64(_PAIR_BITS)) & np.uint64(63)
    codes = (pairs >> np.uint64(32)) & mask
    codes <<= length_of_first
    codes |= pairs & mask
    pairs >>= np.uint64(32 + _PAIR_BITS)
    pairs += length_of_first
    ends = np.cumsum(pairs)
    ends += np.uint64(at)
    starts = ends - pairs
    word, shift = starts >> np.uint64(6), starts & np.uint64(63)
    # The last code that begins in each word; as codes are shorter than words, one begins in each.
    last = np.append(np.flatnonzero(word[1:] != word[:-1]), len(word) - 1)
    # Codes share no bit, so that a word is the sum of its codes, which wraps around.
    totals = np.cumsum(codes << shift)[last]
    words = np.zeros(len(last) + 1, np.uint64)
    words[0] = carry
    words[:-1] += totals
    words[1:-1] -= totals[:-1]
    words[1:] += codes[last] >> np.uint64(1) >> (np.uint64(63) - shift[last])
    whole, at = divmod(int(ends[-1]), 64)
    return words[:whole].astype("<u8", copy=False).tobytes(), int(words[whole]), at


def _code_lengths(counts: list[int]) -> list[int]:
    """Lengths of Huffman's codes, 1 to `_MAX_BITS`; rare values count as more frequent until codes are short enough."""
    least = max(sum(counts) >> _MAX_BITS, 1)
    while True:
        lengths = _huffman_lengths([max(count, least) for count in counts])
        if max(lengths) <= _MAX_BITS:
            return lengths
        least *= 2


def _huffman_lengths(counts: list[int]) -> list[int]:
    number = len(counts)
    parents = [0] * (2 * number - 1)
    heap = [(count, node) for node, count in enumerate(counts)]
    heapify(heap)
    for node in range(number, 2 * number - 1):
        count, low = heappop(heap)
        other, high = heap[0]
        parents[low] = parents[high] = node
        heapreplace(heap, (count + other, node))
    depths = [0] * (2 * number - 1)
    for node in range(2 * number - 3, -1, -1):
        depths[node] = depths[parents[node]] + 1
    return depths[:number]


def _codes(lengths: NDArray[np.int64]) -> NDArray[np.uint16]:
    """Canonical codes of lengths (n,), which form a complete code; a code's first bit is its lowest."""
    order = np.argsort(lengths, kind="stable")
    shares = 1 << (16 - lengths[order])
    from_top = np.empty(len(lengths), ">u2")
    from_top[order] = np.cumsum(shares) - shares
    bits = np.unpackbits(from_top.view(np.uint8).reshape(-1, 2), axis=1)
    return np.packbits(bits, axis=1, bitorder="little").view("<u2").astype(np.uint16)[:, 0]


def _pair_table(codes: NDArray[np.uint16], lengths: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Codes of all pairs of bytes, at first + 256 * second, and their length above; little-endian."""
    wide = codes.astype(np.uint32)
    both = (wide[:, np.newaxis] << lengths) | wide
    both |= (lengths[:, np.newaxis] + lengths) << np.uint32(_PAIR_BITS)
    return both.ravel().astype("<u4", copy=False)
