"""Shards that strangers made: whatever their headers say, reading an image ends, or says why not in one line."""

from __future__ import annotations

import io
import itertools
import tarfile
from pathlib import Path

import pytest
from terrainav.core.dataset.stored import Range, StoredImage, members
from terrainav.core.errors import InvalidInput
from terrainav.core.limits import MAX_IMAGE_FILE_BYTES, MAX_IMAGE_MEMBERS

BLOCK = tarfile.BLOCKSIZE
#: More endings than any image has.
ENDLESS = 1000


def header(name: str, size: int, kind: bytes = tarfile.REGTYPE, form: int = tarfile.GNU_FORMAT) -> bytes:
    """Header of a member as tarfile writes it; sizes that octal digits cannot have in base 256, as GNU does."""
    member = tarfile.TarInfo(name)
    member.size, member.type = size, kind
    return member.tobuf(form, "utf-8", "surrogateescape")


def padded(data: bytes) -> bytes:
    return data + b"\0" * (-len(data) % BLOCK)


def shard(folder: Path, *after: bytes, data: bytes = b"image") -> StoredImage:
    """An image at a shard's beginning, with anything after it."""
    path = folder / "x-000000.tar"
    path.write_bytes(header("0.png", len(data)) + padded(data) + b"".join(after) + b"\0" * 2 * BLOCK)
    return StoredImage("a.png", path, Range(BLOCK, len(data)), path.stat().st_size)


def test_the_files_of_an_image_are_found(tmp_path):
    notes = header("0.png.aux.xml", 5) + padded(b"notes")
    image = shard(tmp_path, header("0.json", 2), padded(b"{}"), notes, header("1.png", 0))
    assert list(image.endings()) == [".png", ".json", ".png.aux.xml"]
    assert image.read_bytes() == b"image"


@pytest.mark.parametrize("form", [tarfile.GNU_FORMAT, tarfile.PAX_FORMAT])
def test_headers_for_long_names_and_times_are_passed_over(tmp_path, form):
    """As GNU tar and Python's tarfile write them, of names longer than the first tars could have."""
    path = tmp_path / "x.tar"
    key = "0" * 120
    with tarfile.open(path, "w", format=form) as tar:
        for ending in (".png", ".json"):
            member = tarfile.TarInfo(key + ending)
            member.size, member.mtime = 5, 1.5
            tar.addfile(member, io.BytesIO(b"image"))
    with tarfile.open(path) as tar:
        begin = tar.getmember(key + ".png").offset_data
    image = StoredImage("a.png", path, Range(begin, 5), path.stat().st_size)
    # The names in the headers themselves are cut short.
    assert list(image.endings()) == ["", ""]


@pytest.mark.parametrize("size", [-1, -BLOCK, -2 * BLOCK, -(2**63), -(2**80)])
def test_a_negative_size_is_refused_with_its_place(tmp_path, size):
    image = shard(tmp_path, header("0.jgw", size))
    with pytest.raises(InvalidInput, match=rf"^shard .*x-000000\.tar: states {size:,} bytes .* byte 1,024$"):
        list(itertools.islice(image.endings(), ENDLESS))


@pytest.mark.parametrize("size", [BLOCK * 10, 2**33, 2**63, 2**64, 2**80])
def test_a_file_beyond_the_shards_end_is_refused(tmp_path, size):
    image = shard(tmp_path, header("0.jgw", size))
    with pytest.raises(InvalidInput, match=r"^shard .*: its part of image a\.png at byte 1,024 is not"):
        list(itertools.islice(image.endings(), ENDLESS))


@pytest.mark.parametrize(
    "kind",
    [
        tarfile.LNKTYPE,
        tarfile.SYMTYPE,
        tarfile.CHRTYPE,
        tarfile.BLKTYPE,
        tarfile.DIRTYPE,
        tarfile.FIFOTYPE,
        tarfile.GNUTYPE_SPARSE,
    ],
)
def test_what_is_no_file_is_refused(tmp_path, kind):
    image = shard(tmp_path, header("0.jgw", 0, kind))
    with pytest.raises(InvalidInput, match=r"^shard .*: its part of image a\.png at byte 1,024 is not"):
        list(image.endings())
    image.place.write_bytes(header("0.png", 5, kind) + padded(b"image"))
    with pytest.raises(InvalidInput, match=r"^image a\.png in .*: is not where the table says it is"):
        image.read_bytes()


@pytest.mark.parametrize("kind", [tarfile.REGTYPE, tarfile.XHDTYPE, tarfile.GNUTYPE_LONGNAME])
def test_an_image_has_few_files(tmp_path, kind):
    image = shard(tmp_path, header("0.txt", 0, kind) * 100_000)
    asked = []

    def read(start, length):
        asked.append(start)
        return image._part(start, length)

    with pytest.raises(InvalidInput, match=rf"^shard X: has more than {MAX_IMAGE_MEMBERS} files of one image"):
        list(members(read, "X", 0, image.shard_bytes))
    assert len(asked) == MAX_IMAGE_MEMBERS + 1
    with pytest.raises(InvalidInput, match=r"^shard .*x-000000\.tar: has more than"):
        list(image.endings())


def test_a_header_is_read_before_memory_is_taken(tmp_path, monkeypatch):
    """Of 1 GB with holes; what is read is counted."""
    size = 10**9
    path = tmp_path / "x.tar"
    with path.open("wb") as file:
        file.write(header("0.jpg", 5) + padded(b"image"))
        file.truncate(BLOCK + size)
    asked = []
    part = StoredImage._part
    monkeypatch.setattr(StoredImage, "_part", lambda *args: asked.append(args[2]) or part(*args))
    for image in (
        StoredImage("a.png", path, Range(BLOCK, size), BLOCK + size),
        StoredImage("a.jpg", path, Range(BLOCK, size), BLOCK + size),
    ):
        with pytest.raises(InvalidInput, match="is not where the table says it is"):
            image.read_bytes()
    assert sum(asked) == 2 * BLOCK
    huge = StoredImage("a.png", path, Range(BLOCK, MAX_IMAGE_FILE_BYTES + 1), BLOCK + size)
    with pytest.raises(InvalidInput, match=r"^image a\.png in .*: has 1,604,194,305 bytes; must have"):
        huge.read_bytes()


def test_a_large_image_is_in_memory_once(tmp_path):
    import tracemalloc

    size = 40_000_000
    path = tmp_path / "x.tar"
    with path.open("wb") as file:
        file.write(header("0.png", size))
        file.truncate(BLOCK + size)
    image = StoredImage("a.png", path, Range(BLOCK, size), BLOCK + size)
    tracemalloc.start()
    try:
        assert len(image.read_bytes()) == size
        assert tracemalloc.get_traced_memory()[1] < 1.2 * size
    finally:
        tracemalloc.stop()
