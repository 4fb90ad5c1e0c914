"""Every reader of files that others may have made: no device, no pipe, and nothing beyond its limit."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from terrainav.core import limits
from terrainav.core.capture.blocks.block import _read_heights
from terrainav.core.dataset.dataset import image_size, open_image, open_masked
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.storage.files import read_existing, read_limited, text_lines

ROOT = Path(__file__).resolve().parents[3]
PATIENCE_S = 240.0
#: Far less than any of the files would take.
MOST_BYTES = 3 << 30
#: What reads a file, by its name, and the limit of its length.
READERS = {
    "mission.json": ("Mission.load(path)", "MAX_MISSION_BYTES"),
    "mission.json of a run": ("folder.LocalFolder(path.parent)._read_mark()", "MAX_MISSION_BYTES"),
    "meta_data.csv": ("table.Table.load(path)", "MAX_TABLE_BYTES"),
    "meta_data.csv of others": ("table.other_columns(path)", "MAX_TABLE_BYTES"),
    "meta_data.csv described": ("croissant._headers_and_sum(path)", "MAX_TABLE_BYTES"),
    "footprints.geojson": ("next(described._features(path))", "MAX_TABLE_BYTES"),
    "plan.csv": ("ground._read_corners(path, ['a'])", "MAX_TABLE_BYTES"),
    "labels.json": ("Labels.load(path)", "MAX_SETTINGS_BYTES"),
    "image.png": ("open_image(path)", "MAX_IMAGE_FILE_BYTES"),
    "image.tif": ("open_image(path)", "MAX_IMAGE_FILE_BYTES"),
    "frame.jpg": ("frames._read_affine(path)", "MAX_SETTINGS_BYTES"),
    "benchmark.json": ("Benchmark.read(path.parent)", "MAX_SETTINGS_BYTES"),
    "queries.csv": ("next(read_rows(path))", "MAX_MISSION_BYTES"),
    "pairs.csv": ("sheet._read_places(path.parent)", "MAX_MISSION_BYTES"),
    "log.ulg": ("logs.read_ulog(path)", "MAX_MISSION_BYTES"),
    "config.json": ("config.read_named(path, 'things')", "MAX_SETTINGS_BYTES"),
    "vbn.txt": ("faults(lambda found: vbn._metadata(path, found))", "MAX_SETTINGS_BYTES"),
    "raster.vrt": ("trust._named(path)", "MAX_VRT_BYTES"),
}
#: Files that are found under another name than the one that is read.
_NAMES = {"frame.jpg": "frame.jgw"}
_PROGRAM = f"""
import os, resource, sys
from pathlib import Path
from terrainav.core.storage import config
from terrainav.core.benchmark.folder import Benchmark, read_rows
from terrainav.core.capture import folder
from terrainav.core.dataset import ground, table, vbn
from terrainav.core.dataset.dataset import open_image
from terrainav.core.dataset.labels import Labels
from terrainav.core.errors import InvalidInput, TerrAInavError
from terrainav.core.exports import croissant, tables as described
from terrainav.core.imagery.raster import trust
from terrainav.core.mission.mission import Mission
from terrainav.core.mosaic import frames
from terrainav.core.pairs import sheet
from terrainav.core.poses import logs
resource.setrlimit(resource.RLIMIT_AS, ({MOST_BYTES}, {MOST_BYTES}))
def faults(read):
    found = []
    read(found)
    raise InvalidInput("; ".join(map(str, found)) or "no fault")
for text in sys.argv[1:]:
    where, code = text.split(" ", 1)
    try:
        eval(code, {{**globals(), "path": Path(where)}})
        print("read")
    except TerrAInavError as wrong:
        print(str(wrong).replace(chr(10), "<line>"))
    except BaseException as wrong:
        print(type(wrong).__name__, wrong)
"""


def refusals(tmp_path, make):
    """What each reader says of its file, which is made by a function of its path and its limit."""
    tasks = []
    for number, (name, (code, limit)) in enumerate(READERS.items()):
        folder = tmp_path / str(number)
        folder.mkdir()
        file = name.partition(" ")[0]
        make(folder / _NAMES.get(file, file), getattr(limits, limit))
        tasks.append(f"{folder / file} {code}")
    ran = subprocess.run(
        [sys.executable, "-c", _PROGRAM, *tasks],
        cwd=ROOT,
        env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        timeout=PATIENCE_S,
        capture_output=True,
        text=True,
        check=True,
    )
    return dict(zip(READERS, ran.stdout.splitlines()))


@pytest.mark.skipif(os.name == "nt", reason="Windows has no pipes and devices among its files")
@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_no_reader_opens_what_is_no_regular_file(tmp_path, kind):
    """Pipes without a writer are waited for for good, and devices have no end."""

    def make(path, _):
        if kind == "pipe":
            os.mkfifo(path)
        else:
            path.symlink_to("/dev/zero")

    said = refusals(tmp_path, make)
    assert set(said) == set(READERS)
    wrong = {
        name: line
        for name, line in said.items()
        if "regular file" not in line and "no pairs.csv that can be read" not in line
    }
    assert wrong == {}


@pytest.mark.skipif(os.name == "nt", reason="Windows makes no sparse files by itself")
def test_no_reader_reads_beyond_its_limit(tmp_path):
    said = refusals(tmp_path, lambda path, most: os.truncate(os.open(path, os.O_CREAT | os.O_WRONLY), most + 1))
    assert set(said) == set(READERS)
    wrong = {
        name: line
        for name, line in said.items()
        if not any(words in line for words in ("larger than", "more than 64 MB", "no pairs.csv that can be read"))
    }
    assert wrong == {}


def _png(width, height):
    """The head of a PNG, and the first of its pixels."""
    chunks = (b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0), b"IDAT" + zlib.compress(b"\0"))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(one) - 4) + one + struct.pack(">I", zlib.crc32(one)) for one in chunks
    )


@pytest.mark.parametrize("read", [open_image, image_size, open_masked])
@pytest.mark.filterwarnings("ignore::PIL.Image.DecompressionBombWarning")
def test_pictures_are_asked_for_their_size_before_they_are_decoded(tmp_path, monkeypatch, read):
    # Other programs in the same process, such as plugins of QGIS, switch Pillow's own limit off.
    monkeypatch.setattr("PIL.Image.MAX_IMAGE_PIXELS", None)
    path = tmp_path / "image.png"
    path.write_bytes(_png(20_000, 10_001))
    with pytest.raises(InvalidInput, match=r"image\.png: has 20,000 x 10,001 px, more than 200,000,000 in all"):
        read(path)


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000, 1000000000), }", "cut short"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }", "no heights"),
        ("{'descr': '|O', 'fortran_order': False, 'shape': (1, 1), }", "no heights"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (1, " + "9" * 5000 + "), }", "."),
    ],
)
def test_heights_are_as_many_as_there_are_bytes(header, said):
    head = header.encode()
    with pytest.raises(ValueError, match=said):
        _read_heights(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + bytes(16))


@pytest.mark.parametrize("order", ["C", "F"])
def test_heights_are_read_as_numpy_writes_them(tmp_path, order):
    heights_m = np.asarray(np.arange(6.0).reshape(2, 3), order=order)
    np.save(tmp_path / "a.npy", heights_m)
    assert np.array_equal(_read_heights((tmp_path / "a.npy").read_bytes()), heights_m)


def test_files_are_read_up_to_their_limit(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"12345")
    assert read_limited(path, 5) == read_limited(path, 5, named_by_user=True) == b"12345"
    for by_user in (False, True):
        with pytest.raises(InvalidInput, match=r"^larger than 0 MB$"):
            read_limited(path, 4, named_by_user=by_user)
    assert read_existing(tmp_path / "none", 4) is None
    with pytest.raises(InvalidInput, match=rf"^file {path}: cannot be read \(larger than"):
        read_existing(path, 4)
    with pytest.raises(OutputError, match="cannot be read"):
        read_existing(path / "b", 4)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
def test_a_pipe_is_read_where_the_user_names_one(tmp_path):
    read_end, write_end = os.pipe()
    os.write(write_end, b"lat lon")
    os.close(write_end)
    try:
        assert read_limited(f"/dev/fd/{read_end}", 100, named_by_user=True) == b"lat lon"
        with pytest.raises(OSError, match="not a regular file"):
            read_limited(f"/dev/fd/{read_end}", 100)
    finally:
        os.close(read_end)


def test_lines_of_text_end_as_they_are_written(tmp_path):
    path = tmp_path / "a"
    path.write_bytes("\ufeffa,é\r\nb\rc\n\nd".encode())
    with path.open("rb") as file:
        assert list(text_lines(file, "utf-8-sig")) == ["a,é\r\n", "b\r", "c\n", "\n", "d"]
    path.write_bytes(b"x" * (limits.MAX_LINE_BYTES + 1))
    with path.open("rb") as file, pytest.raises(InvalidInput, match=r"^a line is longer than 1024 kB$"):
        list(text_lines(file, "utf-8"))
