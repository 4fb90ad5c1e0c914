"""What refusals of captures, of the command and of files advise."""

from __future__ import annotations

import os
import sys
from functools import partial
from pathlib import Path
from uuid import uuid4

import boto3
import numpy as np
import pytest
from terrainav.core.capture import images, writers
from terrainav.core.capture import writers as jpeg
from terrainav.core.capture.metadata import Description
from terrainav.core.capture.runner import capture
from terrainav.core.external import drawing
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.storage import config, files, stores

from tests.support.objects import s3_store
from tests.support.remedies import Case, remedy
from tests.support.sources import NamedPattern, PatternSource

MISSION = Mission(Points(((35.0, -89.9, 20.0),)), 20.0)
OTHER = MISSION.replace(agl_m=21.0)
BOX = "35.16_-89.90_35.157_-89.897_400"


def captured(folder, mission=MISSION, **options):
    source = PatternSource()
    return capture(plan(mission, source.grid), source, folder, **options)


def stored(address, mission=MISSION, **options):
    source = NamedPattern()
    return capture(plan(mission, source.grid), source, address, **options)


def new_address():
    return f"memory://{uuid4().hex}/run"


# --- capture


@remedy("capture/folder.py", "{} {}: holds another mission; choose another folder")
def _another_mission(case: Case) -> None:
    captured(case.tmp_path / "out")
    case.refused(lambda: captured(case.tmp_path / "out", OTHER))
    case.follow("choose another folder", lambda: captured(case.tmp_path / "other", OTHER))
    address = new_address()
    stored(address)
    case.refused(lambda: stored(address, OTHER))
    stored(new_address(), OTHER)


@remedy(
    "capture/folder.py",
    "{} {}: already holds this mission; resume it (--resume) or choose another folder",
)
def _already_there(case: Case) -> None:
    asked = ("capture", "--coords", BOX)
    assert case.run(*asked, "--data-dir", "out").returncode == 0
    case.refused(lambda: captured(case.tmp_path / "mine") and captured(case.tmp_path / "mine"))
    case.says(case.run(*asked, "--data-dir", "out").stderr)
    case.follow("resume it (--resume)", lambda: case.run(*asked, "--data-dir", "out", "--resume").returncode == 0)
    case.follow("choose another folder", lambda: case.run(*asked, "--data-dir", "other").returncode == 0)
    address = new_address()
    stored(address)
    case.refused(lambda: stored(address))
    stored(address, resume=True)
    stored(new_address())


@remedy(
    "capture/folder.py",
    "folder {}: holds no capture of this mission, so nothing of it has failed; capture it first",
)
def _nothing_failed(case: Case) -> None:
    case.refused(lambda: captured(case.tmp_path / "out", only_failed=True))

    def first():
        captured(case.tmp_path / "out")
        captured(case.tmp_path / "out", only_failed=True)

    case.follow("capture it first", first)


@remedy("capture/folder.py", "{} {}: holds {} but no {}, so it is not this mission's; choose another folder")
def _foreign(case: Case) -> None:
    (case.tmp_path / "satellite").mkdir()
    case.refused(lambda: captured(case.tmp_path))
    case.follow("choose another folder", lambda: captured(case.tmp_path / "other"))
    address = new_address()
    stores.put(stores.store_path(f"{address}/holiday.jpg"), b"")
    case.refused(lambda: stored(address))
    stored(new_address())


@remedy("capture/images.py", "file {}: cannot be removed ({}); close what shows it")
def _shown(case: Case) -> None:
    path = case.tmp_path / "picture.tif"
    path.write_bytes(b"")
    real = Path.unlink

    def held(self, missing_ok=False):
        # As in Windows, where a file that is open stays.
        if self == path:
            raise PermissionError(13, "The file is in use")
        real(self, missing_ok=missing_ok)

    with case.monkeypatch.context() as shown:
        shown.setattr(Path, "unlink", held)
        case.refused(lambda: images.remove_image(case.tmp_path, (".tif",), "picture"))

    def closed():
        images.remove_image(case.tmp_path, (".tif",), "picture")
        return not path.exists()

    case.follow("close what shows it", closed)


def described(attribution):
    return Description("a", "satellite", "S", attribution, zoom=18, lat_deg=35.0, lon_deg=10.0, agl_m=120.0)


@remedy(
    "capture/writers.py",
    "description of an image in {} bytes: a JPEG has room for {}; choose tif or png, or shorten the "
    "source's attribution",
)
def _long_description(case: Case) -> None:
    pixels = np.zeros((4, 4, 3), np.uint8)
    place = writers_place()
    long = described("x" * 70_000)
    case.refused(lambda: jpeg.jpeg(pixels, long))
    for ending in ("tif", "png"):
        case.follow(
            ending,
            lambda ending=ending: writers.write_picture(case.tmp_path, ending, pixels, place, long) > 0,
        )
    case.follow("shorten the source's attribution", lambda: jpeg.jpeg(pixels, described("x" * 700)))
    case.follow("choose", lambda: True)


def writers_place():
    from terrainav.core.capture.georeference import Georeference

    return Georeference(0.0, 0.0, 4.0, 4.0, 4, 4)


@remedy("capture/making.py", "plan is for another pixel grid than that of {}: plan with the source's own")
def _another_grid(case: Case) -> None:
    source = PatternSource()
    case.refused(lambda: capture(plan(MISSION, PixelGrid(tile_px=512)), source, case.tmp_path / "out"))
    case.follow(
        "plan with the source's own",
        lambda: capture(plan(MISSION, source.grid), source, case.tmp_path / "out"),
    )


@remedy(
    "capture/images.py",
    "folder {}: holds this mission with other images, such as {}, because the source or the version "
    "was another; choose "
    "another folder",
)
def _other_pictures(case: Case) -> None:
    captured(case.tmp_path / "out")
    finer = PatternSource(tile_px=512)
    again = partial(capture, plan(MISSION, finer.grid), finer)
    case.refused(lambda: again(case.tmp_path / "out", resume=True))
    case.follow("choose another folder", lambda: again(case.tmp_path / "other"))


# --- files


@remedy("storage/files.py", "it is a link to another place; remove it")
def _link(case: Case) -> None:
    own = case.tmp_path / "journal.jsonl"
    (case.tmp_path / "elsewhere").write_bytes(b"not to be written")
    try:
        own.symlink_to(case.tmp_path / "elsewhere")
    except OSError:
        pytest.skip("this user may not make links")
    case.refused(lambda: files.open_own(own, "ab").close())
    own.unlink()
    case.follow("remove it", lambda: files.open_own(own, "ab").close())


@remedy("storage/files.py", "it is not a regular file; remove it")
def _pipe(case: Case) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("this system has no pipes with a name")
    own = case.tmp_path / "journal.jsonl"
    os.mkfifo(own)
    case.refused(lambda: files.open_own(own, "rb").close())
    own.unlink()
    case.follow("remove it", lambda: files.open_own(own, "ab").close())


@remedy("storage/files.py", "folder {}: a file is in its place; choose another folder")
def _file_in_place(case: Case) -> None:
    (case.tmp_path / "file").write_text("")
    case.refused(lambda: files.make_folder(case.tmp_path / "file"))
    case.follow("choose another folder", lambda: files.make_folder(case.tmp_path / "folder"))


@remedy("storage/files.py", "folder {}: cannot be made ({}); choose another folder")
def _no_folder(case: Case) -> None:
    (case.tmp_path / "file").write_text("")
    case.refused(lambda: files.make_folder(case.tmp_path / "file" / "below"))
    case.follow("choose another folder", lambda: files.make_folder(case.tmp_path / "folder" / "below"))


@remedy(
    "storage/files.py",
    "folder {}: another run is at work in it; wait until it has ended or choose another folder",
)
def _locked(case: Case) -> None:
    path = case.tmp_path / "journal"

    def opened(where):
        files.open_locked(where).close()

    with files.open_locked(path):
        case.refused(lambda: opened(path))
        case.follow("choose another folder", lambda: opened(case.tmp_path / "other"))
    case.follow("wait until it has ended", lambda: opened(path))


def broken_file(case: Case, break_it) -> None:
    path = case.tmp_path / "things.json"

    def made():
        path.write_text("{}")
        break_it(path)

    made()
    case.refused(lambda: config.read_named(path, "things"))

    def mended():
        if path.is_dir():
            path.rmdir()
        path.write_text('{"a": 1}')
        return config.read_named(path, "things") == {"a": 1}

    case.follow("mend it", mended)
    made()

    def moved():
        path.rename(case.tmp_path / "elsewhere")
        return config.read_named(path, "things") == {}

    case.follow("move it away", moved)


@remedy("storage/config.py", "{}: cannot be read ({}); mend it, or move it away")
def _unreadable(case: Case) -> None:
    def folder_in_place(path):
        path.unlink()
        path.mkdir()

    broken_file(case, folder_in_place)


@remedy("storage/config.py", "{}: cannot be read as JSON ({}); mend it, or move it away")
def _no_json(case: Case) -> None:
    broken_file(case, lambda path: path.write_text("{"))


@remedy(
    "external/drawing.py",
    "matplotlib, which draws the diagrams, is not installed; get it with: pip install 'terrainav[report]'",
)
def _no_matplotlib(case: Case) -> None:
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "matplotlib.figure", None)
        case.refused(drawing.check_matplotlib)
    case.follow("get it with: pip install 'terrainav[report]'", lambda: extra_brings("report", "matplotlib"))
    drawing.check_matplotlib()


def extra_brings(extra, package):
    """Whether pip installs a package with an extra of ours, as pyproject.toml says."""
    text = (Path(__file__).parents[3] / "pyproject.toml").read_text(encoding="utf-8")
    extras = text.partition("[project.optional-dependencies]")[2].partition("\n[")[0]
    own = [line for line in extras.splitlines() if line.startswith(f"{extra} =")]
    return any(package in line for line in own)


# --- object stores


@remedy("storage/stores.py", "addresses of object stores: {} cannot be imported ({}); get it with: pip install {}")
def _no_fsspec(case: Case) -> None:
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "fsspec", None)
        case.refused(lambda: stores.store_path("s3://data/x"))
    case.follow("get it with: pip install 'terrainav[cluster]'", lambda: extra_brings("cluster", "fsspec"))


@remedy("storage/stores.py", "{}: is not there, or {} is not; make the bucket first")
def _no_bucket(case: Case) -> None:
    with s3_store(case.monkeypatch) as bucket:
        path = stores.store_path(f"{bucket}2/x")
        case.refused(lambda: stores.put(path, b"1"))

        def made():
            boto3.client("s3").create_bucket(Bucket="data2")
            stores.put(path, b"1")

        case.follow("make the bucket first", made)
