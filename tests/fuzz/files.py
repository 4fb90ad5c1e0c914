"""Files that a folder may hold: journals, tables, labels, and a user's own sources and cameras."""

from __future__ import annotations

import importlib.util
import io
import os
import shutil
import tarfile
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import numpy as np
from hypothesis import strategies as st
from PIL import Image
from terrainav.core.capture.journal import Journal, Outcome
from terrainav.core.dataset.geotiff import parse_bands, parse_pam_bands
from terrainav.core.dataset.label_images import read_label_image
from terrainav.core.dataset.labels import Labels, make_labels
from terrainav.core.dataset.stored import Range, StoredImage
from terrainav.core.dataset.table import Table, other_columns
from terrainav.core.imagery.catalogue import described, shelf
from terrainav.core.imagery.decode import refuse_flat, refuse_marked
from terrainav.core.labels.classes import read_classes
from terrainav.core.mission.cameras import camera_shelf
from terrainav.core.poses.logs import read_dataflash, read_ulog
from terrainav.core.text.safe_json import parse_json

from tests.fuzz.support import Target, altered, any_of, as_json, as_text, mutated
from tests.support.logs import FLIGHT, copter, dataflash, flight, ulog
from tests.support.tables import table_of, text_of

NOTES = (b'<PAMRasterBand band="1"><Description>a</Description></PAMRasterBand>', b"II*\0\x08\0\0\0\0\0")


def _member(name: str, size: int, kind: bytes = tarfile.REGTYPE) -> bytes:
    about = tarfile.TarInfo(name)
    about.size, about.type = size, kind
    return about.tobuf(tarfile.GNU_FORMAT)


_IMAGE = _member("0.png", 5) + b"image" + bytes(507)
SHARDS = tuple(
    _IMAGE + _member("0.jgw", size, kind) * 3
    for size, kind in (
        (0, b"0"),
        (-512, b"0"),
        (2**70, b"0"),
        (-(2**70), b"x"),
        (9, b"S"),
        (512, b"L"),
        (0, b"2"),
    )
)
OUTCOMES = (
    Outcome("satellite", "0_0_35.10000000_-89.90000000_19", 7.123456789, size_bytes=12345, sky_share=0.25),
    Outcome("roadmap", "1_0_35.10000000_-89.90000000_19", reason='404 "not found"', repeated=("0" * 64,)),
)
TABLE = text_of(
    Table.from_columns(
        {
            "img_names": ("a.tif", "b.tif"),
            "columns": np.array([0, 1]),
            "rows": np.array([0, 0]),
            "lat_deg": np.array([35.1, 35.2]),
            "lon_deg": np.array([-89.9, -89.8]),
            "zoom": np.array([19, 19]),
            "status": ("done", "failed"),
            "reason": ("", "404"),
        },
        {"rejected": ("", "dark")},
    )
)
LABELS = make_labels(np.array([35.1, 35.2]), np.array([-89.9, -89.8])).to_json()
CLASSES = {
    "background": 0,
    "ignore": 255,
    "classes": [{"id": 1, "name": "field", "color": "#e69f00"}, {"id": 254, "name": "wood", "color": "#009e73"}],
}
SOURCES = {
    "mine": described("https://tiles.example/{z}/{x}/{y}.png", title="Mine"),
    "dated": described("https://tiles.example/{date}/{map_type}/{z}/{x}/{y}.png?key={key}", default_date="2024"),
    "levels": {
        **described("https://tiles.example/{z}/{x}/{y}.png", max_connections=2, requests_per_s=3.5),
        "bounds_deg": [-10, -10, 10, 10],
        "levels": [[0, "a"], [1, "b"]],
        "hosts": ["tiles.example"],
        "placeholder": {"sha256": ["0" * 64], "header": {"a": "*"}, "flat_rgb": [[0, 0, 0]]},
        "dates": {"kind": "listed", "default": "a", "values": {"a": "b"}},
        "bulk_allowed": "ask",
        "max_tiles": 9,
    },
}
SOURCES["levels"]["urls"] = {"": "https://tiles.example/{date}/{z}/{x}/{y}.png"}
CAMERAS = {
    "Mine": {"fov_deg": 60.0, "aspect_ratio": [4, 3], "image_px": 4000, "source": "me"},
    "Sensor": {"sensor_mm": [13.2, 8.8], "focal_length_mm": 8.8, "size_px": [5472, 3648]},
}


# A date that stands for a number in the URL.
_NUMBERED = {"levels": {**SOURCES["levels"], "dates": {"kind": "listed", "default": "a", "values": {"a": 5}}}}


def journal(data: bytes) -> None:
    path = Path("journal.jsonl")
    path.write_bytes(data)
    with Journal(path) as opened:
        before = dict(opened.outcomes)
        opened.add(OUTCOMES[0])
    after = Journal(path).outcomes
    assert after == {**before, (OUTCOMES[0].map_type, OUTCOMES[0].name): OUTCOMES[0]}
    for outcome in before.values():
        outcome.to_line()


def table(data: bytes) -> None:
    path = Path("meta_data.csv")
    path.write_bytes(data)
    other_columns(path)
    read = Table.load(path)
    assert text_of(table_of(text_of(read))) == text_of(read)


def labels(data: bytes) -> None:
    path = Path("labels.json")
    path.write_bytes(data)
    read = Labels.load(path)
    read.positions(read.transform(np.array([35.1]), np.array([-89.9])))
    assert Labels.from_json(read.to_json()) == read


def classes(data: bytes) -> None:
    read_classes(data, "classes.json")


def label_image(data: bytes) -> None:
    path = Path("a.png")
    path.write_bytes(data)
    with warnings.catch_warnings():
        # Pillow warns of what it reads of a damaged file.
        warnings.simplefilter("ignore")
        read_label_image(path)


def _label_images() -> Iterator[bytes]:
    """PNG with 8 and 16 bits, and a TIFF with 32."""
    for dtype, ending in ((np.uint8, "png"), (np.uint16, "png"), (np.int32, "tiff")):
        buffer = io.BytesIO()
        Image.fromarray(np.arange(12).reshape(3, 4).astype(dtype)).save(buffer, ending)
        yield buffer.getvalue()


def sources(data: bytes) -> None:
    path = Path("sources.json")
    path.write_bytes(data)
    for entry in shelf(".").entries:
        as_json([entry.to_dict(), entry.to_data()])
        entry.grid()
        entry.templates(entry.date("2024-06-21" if entry.dates and not entry.dates.default else None))
        entry.policy.text()
        entry.policy.connections(8)
        entry.policy.stops(1000)
        if entry.dates:
            entry.dates.text()
        refuse_marked(b"body", {"a": "b"}, entry.placeholder)
        refuse_flat(np.zeros((2, 2, 3), np.uint8), entry.placeholder)
        entry.credit("2024")


def cameras(data: bytes) -> None:
    Path("cameras.json").write_bytes(data)
    with mock.patch.dict(os.environ, {"TERRAINAV_CONFIG_DIR": "."}):
        camera_shelf()


def shard(data: bytes) -> None:
    path = Path("x.tar")
    path.write_bytes(data)
    image = StoredImage("a.png", path, Range(512, 5), len(data))
    any_of((image.read_bytes, lambda: list(image.endings())))


def gdal_notes(data: bytes) -> None:
    parse_pam_bands(as_text(data), 3)
    parse_bands(data)


def px4_log(data: bytes) -> None:
    path = Path("a.ulg")
    path.write_bytes(data)
    read_ulog(path)


def ardupilot_log(data: bytes) -> None:
    path = Path("a.bin")
    path.write_bytes(data)
    read_dataflash(path)


def logs() -> Iterator[Target]:
    """Flight logs, where what reads them is installed."""
    folder = Path(tempfile.mkdtemp(prefix="terrainav-fuzz-logs-"))
    px4 = ulog(folder / "a.ulg", list(flight(FLIGHT))).read_bytes()
    ardupilot = dataflash(folder / "a.bin", copter()).read_bytes()
    shutil.rmtree(folder)
    if importlib.util.find_spec("pyulog"):
        yield Target("PX4 log", px4_log, mutated(px4), (px4[:56] + bytes(100_000),), quick=10)
    if importlib.util.find_spec("pymavlink"):
        yield Target("ArduPilot log", ardupilot_log, mutated(ardupilot), (bytes(100_000),), quick=10)


def json_text(data: bytes) -> None:
    parse_json(data)


def targets() -> Iterator[Target]:
    lines = b"".join(outcome.to_line() for outcome in OUTCOMES)
    outcomes = st.lists(altered(*map(parse_json, lines.splitlines())).map(as_json), max_size=3).map(b"\n".join)
    deep = b"[" * 100_000
    yield from logs()
    yield Target("shard", shard, mutated(*SHARDS) | st.binary(max_size=2000), SHARDS)
    yield Target("notes of bands", gdal_notes, mutated(*NOTES), (b'<PAMRasterBand band="1">' * 50_000,))
    yield Target("journal", journal, mutated(lines) | outcomes, (deep + b"\n",))
    yield Target("table", table, mutated(TABLE, TABLE[:200]), (b'a,"b\n' * 9,))
    yield Target("labels", labels, mutated(LABELS) | altered(parse_json(LABELS)).map(as_json), (deep,))
    yield Target("classes.json", classes, mutated(as_json(CLASSES)) | altered(CLASSES).map(as_json), (deep,))
    yield Target("image of labels", label_image, mutated(*_label_images()), (b"II*\0",))
    numbered = as_json(_NUMBERED)
    stated = mutated(as_json(SOURCES)) | altered(SOURCES).map(as_json)
    yield Target("sources.json", sources, stated, (deep, numbered), quick=60)
    yield Target("cameras.json", cameras, mutated(as_json(CAMERAS)) | altered(CAMERAS).map(as_json), (deep,))
    yield Target("JSON", json_text, mutated(as_json(SOURCES), LABELS) | st.binary(), (deep,))
