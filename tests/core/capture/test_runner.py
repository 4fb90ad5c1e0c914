from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
import threading
import time
from contextlib import closing
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from terrainav.core import limits
from terrainav.core.capture import making, pipeline, records
from terrainav.core.capture.pipeline import Spool
from terrainav.core.capture.progress import Failure, Listener
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.entropy import entropy
from terrainav.core.dataset.table import Table
from terrainav.core.errors import Cancelled, InvalidInput, OutputError, PartError, SourceError
from terrainav.core.geodesy.mercator import HALF_WORLD_M, PixelGrid
from terrainav.core.imagery.source import tile_parts
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.map_frame import capture_window

from tests.support.patterns import MODULUS, decode_position
from tests.support.sources import CentredSource, FailingSource, PatternSource, missing
from tests.support.thinning import sampled

# Far longer than anything here takes.
NEVER_S = 30.0
AREA = Box(35.16, -89.90, 35.1555, -89.892)
MISSION = Mission(AREA, 120.0, map_types=("satellite", "roadmap"), overlap_along=0.1, zoom=18)
FIJI = Box(-16.5, 179.9905, -16.505, -179.993)


def planned(mission=MISSION, source=None):
    return plan(mission, (source or PatternSource()).grid)


def contents(folder: Path) -> dict[str, bytes]:
    """Files of a folder by relative path; the journal as a set of lines, because its order is that of chance."""
    files = {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*")) if path.is_file()}
    return {
        name: frozenset(path.read_bytes().splitlines()) if name == "journal.jsonl" else path.read_bytes()
        for name, path in files.items()
    }


@pytest.fixture(scope="module")
def in_one_go(tmp_path_factory):
    """A capture without disturbance: its plan, folder, result and source."""
    source = PatternSource()
    worked_out = planned()
    folder = tmp_path_factory.mktemp("whole") / "out"
    return worked_out, folder, capture(worked_out, source, folder), source


def test_every_picture_is_there_and_each_part_was_fetched_once(in_one_go):
    worked_out, folder, result, source = in_one_go
    assert len(worked_out) > 20
    assert (result.total, result.written, result.skipped, result.failed) == (
        2 * len(worked_out),
        2 * len(worked_out),
        0,
        (),
    )
    assert not result.cancelled
    assert set(source.fetched.values()) == {1}
    assert result.requests == result.unique_parts == len(source.fetched) == 2 * worked_out.requests
    for map_type in MISSION.imagery.map_types:
        assert {path.name for path in (folder / map_type).iterdir()} == {f"{name}.tif" for name in worked_out.names} | {
            "meta_data.csv"
        }
    files = {"mission.json", "begun.json", "plan.csv", "footprints.geojson", "camera.json", "journal.jsonl"}
    assert {path.name for path in folder.iterdir()} == files | set(MISSION.imagery.map_types)


def test_pixels_are_where_the_files_say(in_one_go):
    """Positions read out of the pixels against edges read out of the files: 0.00 px."""
    gdal = pytest.importorskip("osgeo.gdal", reason="GDAL's Python modules are not installed")
    gdal.UseExceptions()
    worked_out, folder, _, _ = in_one_go
    resolution = worked_out.grid.pixel_size(worked_out.zoom)[0]
    for map_type in MISSION.imagery.map_types:
        for name in worked_out.names:
            data = gdal.Open(str(folder / map_type / f"{name}.tif"))
            west, step_x, _, north, _, step_y = data.GetGeoTransform()
            columns, rows = decode_position(data.ReadAsArray().transpose(1, 2, 0), map_type)
            stated_column = (west + (np.arange(data.RasterXSize) + 0.5) * step_x + HALF_WORLD_M) / resolution - 0.5
            stated_row = (HALF_WORLD_M - north - (np.arange(data.RasterYSize) + 0.5) * step_y) / resolution - 0.5
            assert np.abs(stated_column % MODULUS - columns).max() < 1e-4
            assert np.abs((stated_row % MODULUS)[:, np.newaxis] - rows).max() < 1e-4


def test_the_table_says_what_the_files_are(in_one_go):
    worked_out, folder, _, source = in_one_go
    for map_type in MISSION.imagery.map_types:
        table = Table.load(folder / map_type / "meta_data.csv")
        assert table.img_names == tuple(f"{name}.tif" for name in worked_out.names)
        np.testing.assert_array_equal(table.columns, worked_out.column)
        np.testing.assert_array_equal(table.rows, worked_out.row)
        np.testing.assert_array_equal((table.lat_deg, table.lon_deg), worked_out.frame_centres)
        np.testing.assert_array_equal(table.pose_lat_deg, worked_out.lat_deg)
        np.testing.assert_array_equal(table.pose_lon_deg, worked_out.lon_deg)
        assert set(table.zoom.tolist()) == {worked_out.zoom}
        assert set(table.agl_m.tolist()) == {120.0}
        assert (set(table.status), set(table.reason)) == ({"done"}, {""})
        assert (set(table.source), set(table.attribution)) == ({source.title}, {source.attribution})
        for index, name in enumerate(table.img_names):
            pixels = np.asarray(Image.open(folder / map_type / name))
            assert pixels.shape == (table.image_height_px[index], table.image_width_px[index], 3)
            assert (table.left_px[index], table.top_px[index]) == (
                worked_out.windows.left_px[index],
                worked_out.windows.top_px[index],
            )
            assert table.entropies[index] == entropy(pixels)


def test_mission_and_journal(in_one_go):
    worked_out, folder, _, _ = in_one_go
    assert Mission.load(folder / "mission.json") == worked_out.mission
    lines = [json.loads(line) for line in (folder / "journal.jsonl").read_text(encoding="utf-8").splitlines()]
    assert sorted((line["map_type"], line["name"]) for line in lines) == sorted(
        (map_type, name) for map_type in MISSION.imagery.map_types for name in worked_out.names
    )
    assert {line["status"] for line in lines} == {"done"}


@pytest.mark.parametrize(("connections", "workers"), [(1, 1), (16, 5)])
def test_bytes_do_not_depend_on_the_threads(in_one_go, tmp_path, connections, workers):
    worked_out, folder, _, _ = in_one_go
    source = PatternSource(wait_s=0.001)
    capture(worked_out, source, tmp_path / "out", connections=connections, workers=workers)
    assert contents(tmp_path / "out") == contents(folder)
    assert source.most_at_once <= connections


def test_512_px_tiles(tmp_path):
    source = PatternSource(tile_px=512)
    worked_out = planned(MISSION.replace(map_types=("terrain",)), source)
    result = capture(worked_out, source, tmp_path)
    assert result.written == len(worked_out)
    assert set(source.fetched.values()) == {1}
    assert worked_out.windows.width_px.max() > 640
    pixels = np.asarray(Image.open(tmp_path / "terrain" / f"{worked_out.names[0]}.tif"))
    columns, rows = decode_position(pixels, "terrain")
    assert (columns[0, 0], rows[0, 0]) == (
        worked_out.windows.left_px[0] % MODULUS,
        worked_out.windows.top_px[0] % MODULUS,
    )


def test_across_the_antimeridian(tmp_path):
    source = PatternSource(("satellite",))
    worked_out = planned(Mission(FIJI, 300.0))
    assert capture(worked_out, source, tmp_path).written == len(worked_out)
    world = worked_out.grid.world_px(worked_out.zoom)
    left = np.asarray(worked_out.windows.left_px)
    crossing = np.flatnonzero((left < world) & (left + worked_out.windows.width_px > world))
    assert len(crossing)
    pixels = np.asarray(Image.open(tmp_path / "satellite" / f"{worked_out.names[crossing[0]]}.tif"))
    columns, _ = decode_position(pixels)
    assert columns[0].tolist() == ((left[crossing[0]] + np.arange(pixels.shape[1])) % world % MODULUS).tolist()
    table = Table.load(tmp_path / "satellite" / "meta_data.csv")
    assert ((table.left_px >= 0) & (table.left_px < world)).all()
    assert (np.abs(table.pose_lon_deg) <= 180.0).all()


def test_pictures_by_their_centre(tmp_path):
    source = CentredSource()
    worked_out = planned(Mission(AREA, 120.0, map_types=("terrain",)), source)
    result = capture(worked_out, source, tmp_path)
    assert result.written == result.requests == len(worked_out)
    table = Table.load(tmp_path / "terrain" / "meta_data.csv")
    np.testing.assert_array_equal(table.top_px, worked_out.windows.top_px)


@pytest.mark.parametrize("image_format", ["tif", "jpg", "png"])
@pytest.mark.parametrize("img_size", [(64, 48, 1), (100, 100, 3)])
def test_sizes_formats_and_channels(tmp_path, image_format, img_size):
    mission = Mission(AREA, 120.0, image_format=image_format, img_size=img_size)
    worked_out = planned(mission)
    capture(worked_out, PatternSource(), tmp_path, only=[0, 3])
    with Image.open(tmp_path / "satellite" / f"{worked_out.names[3]}.{image_format}") as image:
        assert image.size == img_size[:2]
        assert len(image.getbands()) == img_size[2]
    table = Table.load(tmp_path / "satellite" / "meta_data.csv")
    assert table.image_width_px.tolist() == [img_size[0]] * 2
    assert table.width_px.tolist() == worked_out.windows.width_px[[0, 3]].tolist()


def test_only_some_captures(tmp_path):
    worked_out, source = planned(), PatternSource()
    result = capture(worked_out, source, tmp_path, only=[7, 2, 7])
    assert (result.total, result.written) == (4, 4)
    assert Table.load(tmp_path / "satellite" / "meta_data.csv").img_names == tuple(
        f"{worked_out.names[i]}.tif" for i in (2, 7)
    )
    for wrong in ([-1], [len(worked_out)]):
        with pytest.raises(InvalidInput, match=r"of the plan: it has 0 to"):
            capture(worked_out, source, tmp_path / "other", only=wrong)
    assert not (tmp_path / "other").exists()
    result = capture(worked_out, source, tmp_path, resume=True)
    assert (result.total, result.skipped, result.written) == (2 * len(worked_out), 4, 2 * len(worked_out) - 4)


def test_a_list_of_far_points(tmp_path):
    points = Points(((35.0, -90.0, 100.0), (-33.0, 151.0, 200.0), (60.0, 10.0, 50.0)))
    worked_out = planned(Mission(points, 100.0))
    assert capture(worked_out, PatternSource(), tmp_path).written == 3


# --- what cannot be had


def broken(worked_out, index):
    """The parts of one capture."""
    return [part.window for part in tile_parts(capture_window(worked_out, index), worked_out.grid)]


def test_failed_parts_fail_their_pictures_by_name(in_one_go, tmp_path):
    worked_out, whole, _, _ = in_one_go
    bad = broken(worked_out, 5)[0]
    source = FailingSource({bad: missing("tile 18/65608/103691: 404, not found")})
    result = capture(worked_out, source, tmp_path)
    concerned = [i for i in range(len(worked_out)) if bad in broken(worked_out, i)]
    assert 1 <= len(concerned) < len(worked_out) / 2
    reason = "tile 18/65608/103691: 404, not found"
    assert result.failed == tuple(
        Failure(map_type, worked_out.names[i], reason) for map_type in MISSION.imagery.map_types for i in concerned
    )
    assert result.written == result.total - len(result.failed)
    assert set(source.fetched.values()) == {1}
    assert result.requests == result.unique_parts
    for map_type in MISSION.imagery.map_types:
        table = Table.load(tmp_path / map_type / "meta_data.csv")
        assert len(table) == len(worked_out)
        assert [i for i, status in enumerate(table.status) if status == "failed"] == concerned
        assert {table.reason[i] for i in concerned} == {reason}
        assert np.flatnonzero(np.isnan(table.entropies)).tolist() == concerned
        for index, name in enumerate(table.img_names):
            assert (tmp_path / map_type / name).exists() == (index not in concerned)
    failed_lines = [line for line in (tmp_path / "journal.jsonl").read_text().splitlines() if '"failed"' in line]
    assert len(failed_lines) == len(result.failed)

    again = PatternSource()
    resumed = capture(worked_out, again, tmp_path, resume=True)
    assert (resumed.written, resumed.skipped, resumed.failed) == (len(result.failed), result.written, ())
    assert resumed.unique_parts == len(again.fetched) == 2 * len({w for i in concerned for w in broken(worked_out, i)})
    same, journal = contents(tmp_path), contents(whole)["journal.jsonl"]
    assert {**same, "journal.jsonl": 0} == {**contents(whole), "journal.jsonl": 0}
    assert journal < same["journal.jsonl"]


def test_a_tile_of_the_wrong_size_is_no_picture(tmp_path):
    class Cropped(PatternSource):
        def paint(self, map_type, part):
            return super().paint(map_type, part)[:-1]

    worked_out = planned(Mission(AREA, 120.0))
    result = capture(worked_out, Cropped(), tmp_path)
    assert (result.written, len(result.failed)) == (0, len(worked_out))
    assert "was asked for" in result.failed[0].reason
    assert sorted(path.name for path in (tmp_path / "satellite").iterdir()) == ["meta_data.csv"]


def test_a_source_that_refuses_stops_the_run_and_keeps_what_is_done(in_one_go, tmp_path):
    worked_out, whole, _, _ = in_one_go
    order = pipeline.sweep(worked_out.windows, np.arange(len(worked_out)))
    refusal = SourceError("Pattern: 403, over quota")
    source = FailingSource(dict.fromkeys(broken(worked_out, int(order[-1])), refusal))
    with pytest.raises(SourceError) as caught:
        capture(worked_out, source, tmp_path, connections=1, workers=1)
    assert caught.value is refusal
    table = Table.load(tmp_path / "satellite" / "meta_data.csv")
    assert 0 < len(table) < len(worked_out)
    assert set(table.status) == {"done"}
    assert not (tmp_path / "roadmap" / "meta_data.csv").exists()
    result = capture(worked_out, PatternSource(), tmp_path, resume=True)
    assert result.skipped == len(table)
    assert contents(tmp_path) == contents(whole)


def test_a_full_disk_stops_the_run(in_one_go, tmp_path, monkeypatch):
    worked_out, whole, _, _ = in_one_go
    real, count = records.write_picture, 0

    def write_picture(*arguments, **more):
        nonlocal count
        count += 1
        if count > 10:
            raise OutputError("folder x: cannot write y (No space left on device)")
        return real(*arguments, **more)

    with monkeypatch.context() as patched:
        patched.setattr(records, "write_picture", write_picture)
        with pytest.raises(OutputError, match="No space left"):
            capture(worked_out, PatternSource(), tmp_path, workers=1)
    assert capture(worked_out, PatternSource(), tmp_path, resume=True).skipped == 10
    assert contents(tmp_path) == contents(whole)


# --- stopping and going on


def test_cancel_and_resume(in_one_go, tmp_path):
    worked_out, whole, _, _ = in_one_go
    seen = []

    def cancelled():
        return bool(seen) and seen[-1].done > 3

    source = PatternSource(wait_s=0.002)
    result = capture(worked_out, source, tmp_path, listener=Listener(progress=seen.append, cancelled=cancelled))
    assert result.cancelled
    assert 3 < result.written < result.total
    table = Table.load(tmp_path / "satellite" / "meta_data.csv")
    assert len(table) == min(result.written, len(worked_out))
    resumed = capture(worked_out, PatternSource(), tmp_path, resume=True)
    assert (resumed.skipped, resumed.written, resumed.cancelled) == (
        result.written,
        result.total - result.written,
        False,
    )
    assert contents(tmp_path) == contents(whole)


def test_cancelling_waits_for_no_request(tmp_path):
    """The capture returns while requests hang; they end when its caller closes the source, and their threads go."""
    asked, closed = threading.Event(), threading.Event()
    cancelled_s = []

    class Hanging(PatternSource):
        def paint(self, map_type, part):
            asked.set()
            if closed.wait(NEVER_S):
                raise Cancelled("closed")
            return super().paint(map_type, part)

        def close(self):
            closed.set()

    def cancelled():
        if asked.is_set() and not cancelled_s:
            cancelled_s.append(time.monotonic())
        return bool(cancelled_s)

    with closing(Hanging()) as source:
        result = capture(planned(), source, tmp_path, listener=Listener(cancelled=cancelled))
        ended_s = time.monotonic()
    # It takes a fraction of a second, more on a busy machine; a wait for a request would take NEVER_S.
    assert ended_s - cancelled_s[0] < 5.0
    assert (result.cancelled, result.written) == (True, 0)
    while any(thread.name.startswith("terrainav-") for thread in threading.enumerate()):
        assert time.monotonic() - ended_s < NEVER_S / 2
        time.sleep(0.01)


def test_pictures_do_not_depend_on_where_tiles_wait(in_one_go, tmp_path, monkeypatch):
    """Without any memory for tiles that later pictures need: all of them go through a file."""
    _, whole, _, source = in_one_go
    again = PatternSource()
    monkeypatch.setattr(pipeline, "Spool", partial(Spool, 0))
    capture(planned(), again, tmp_path)
    assert contents(tmp_path) == contents(whole)
    assert sorted(again.fetched) == sorted(source.fetched)


def test_cancelled_before_it_begins(tmp_path):
    source = PatternSource()
    result = capture(planned(), source, tmp_path, listener=Listener(cancelled=lambda: True))
    assert (result.cancelled, result.written, result.requests) == (True, 0, 0)
    assert not source.fetched


def test_progress_counts_up_to_everything(tmp_path):
    seen = []
    worked_out = planned()
    source = FailingSource({broken(worked_out, 0)[0]: missing()})
    caller = threading.get_ident()
    threads = set()
    result = capture(
        worked_out,
        source,
        tmp_path,
        listener=Listener(progress=lambda p: (seen.append(p), threads.add(threading.get_ident()))),
    )
    last = seen[-1]
    assert (last.total, last.done, last.failed, last.skipped) == (
        result.total,
        result.written,
        len(result.failed),
        0,
    )
    assert last.requests == result.requests
    assert [p.done + p.failed for p in seen] == sorted(p.done + p.failed for p in seen)
    assert [p.map_type for p in seen] == sorted((p.map_type for p in seen), key=MISSION.imagery.map_types.index)
    assert len(seen) <= result.seconds / 0.1 + 2 * len(MISSION.imagery.map_types)
    assert threads == {caller}


def remove_picture(folder, name):
    (folder / "satellite" / f"{name}.jpg").unlink()


def empty_picture(folder, name):
    (folder / "satellite" / f"{name}.jpg").write_bytes(b"")


def remove_world_file(folder, name):
    (folder / "satellite" / f"{name}.jgw").unlink()


def remove_crs(folder, name):
    (folder / "satellite" / f"{name}.jpg.aux.xml").unlink()


def remove_line(folder, name):
    lines = (folder / "journal.jsonl").read_text().splitlines(keepends=True)
    (folder / "journal.jsonl").write_text("".join(line for line in lines if name not in line))


def tear_line(folder, name):
    remove_line(folder, name)
    with (folder / "journal.jsonl").open("a") as journal:
        journal.write(f'{{"map_type": "satellite", "name": "{name}", "sta')


@pytest.mark.parametrize(
    "damage",
    sampled([remove_picture, empty_picture, remove_world_file, remove_crs, remove_line, tear_line], 2),
)
def test_resuming_makes_what_is_missing_and_nothing_else(tmp_path, damage):
    worked_out = planned(Mission(AREA, 120.0, image_format="jpg"))
    capture(worked_out, PatternSource(), tmp_path)
    before = contents(tmp_path)
    damage(tmp_path, worked_out.names[4])
    source = PatternSource()
    result = capture(worked_out, source, tmp_path, resume=True)
    assert (result.written, result.skipped) == (1, len(worked_out) - 1)
    assert {window for _, window in source.fetched} == set(broken(worked_out, 4))
    assert contents(tmp_path) == before


def test_a_table_that_cannot_be_kept_is_refused_before_anything_is_fetched(tmp_path):
    worked_out = planned(Mission(AREA, 120.0, image_format="jpg"))
    capture(worked_out, PatternSource(), tmp_path)
    remove_picture(tmp_path, worked_out.names[4])
    table = tmp_path / "satellite" / "meta_data.csv"
    table.write_bytes(b"img_names,mine\n\xff\n")
    before, source = contents(tmp_path), PatternSource()
    with pytest.raises(OutputError, match="repair the table"):
        capture(worked_out, source, tmp_path, resume=True)
    assert not source.fetched
    assert contents(tmp_path) == before


def test_resuming_a_whole_dataset_asks_for_nothing(in_one_go):
    worked_out, folder, _, _ = in_one_go
    before, source = contents(folder), PatternSource()
    result = capture(worked_out, source, folder, resume=True)
    assert (result.written, result.skipped, result.requests) == (0, result.total, 0)
    assert not source.fetched
    assert contents(folder) == before


def test_resuming_what_was_never_begun_begins_it(in_one_go, tmp_path):
    worked_out, folder, _, _ = in_one_go
    capture(worked_out, PatternSource(), tmp_path / "out", resume=True)
    assert contents(tmp_path / "out") == contents(folder)


# --- folders that hold something else


def test_the_same_mission_must_be_resumed(in_one_go):
    worked_out, folder, _, _ = in_one_go
    before = contents(folder)
    with pytest.raises(
        OutputError, match=r"already holds this mission; resume it \(--resume\) or choose another folder"
    ):
        capture(worked_out, PatternSource(), folder)
    assert contents(folder) == before


@pytest.mark.parametrize("resume", [False, True])
def test_another_mission_is_left_alone(in_one_go, resume):
    _, folder, _, _ = in_one_go
    before = contents(folder)
    with pytest.raises(OutputError, match="holds another mission; choose another folder"):
        capture(planned(MISSION.replace(agl_m=121.0)), PatternSource(), folder, resume=resume)
    assert contents(folder) == before


def test_the_same_mission_planned_at_another_zoom_is_left_alone(tmp_path):
    mission = MISSION.replace(zoom=None)
    capture(planned(mission), PatternSource(), tmp_path)
    before = contents(tmp_path)

    class Coarser(PatternSource):
        def __init__(self):
            super().__init__()
            self.grid = PixelGrid(native_zoom=17)

    with pytest.raises(OutputError, match="holds this mission with other images"):
        capture(planned(mission, Coarser()), Coarser(), tmp_path, resume=True)
    assert contents(tmp_path) == before


@pytest.mark.parametrize("name", ["journal.jsonl", "plan.csv", "footprints.geojson", "camera.json", "satellite"])
def test_foreign_files_in_our_places_are_left_alone(tmp_path, name):
    (tmp_path / name).write_text("mine")
    with pytest.raises(OutputError, match=f"holds {name} but no mission.json"):
        capture(planned(), PatternSource(), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_foreign_files_elsewhere_do_not_matter(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    assert capture(planned(), PatternSource(), tmp_path).written
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_a_file_in_the_folders_place(tmp_path):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(OutputError, match=r"out: a file is in its place"):
        capture(planned(), PatternSource(), tmp_path / "out")


AS_NOBODY = """
import os, sys
from tests.core.capture.test_runner import PatternSource, capture, planned
from terrainav.core.errors import OutputError
worked_out = planned()
os.setgid(65534)
os.setuid(65534)
try:
    capture(worked_out, PatternSource(), sys.argv[1], resume=True)
except OutputError as error:
    print(error)
"""


@pytest.mark.skipif(not hasattr(os, "setuid") or os.getuid() != 0, reason="only root can become another user")
@pytest.mark.parametrize(
    ("below", "message"),
    [
        ("new", "folder {}: cannot be made (Permission denied); choose another folder"),
        ("", "folder {}: cannot write journal.jsonl (Permission denied)"),
    ],
)
def test_an_unwritable_folder_as_another_user(readable_folder, below, message):
    target = readable_folder / below
    run = subprocess.run(
        [sys.executable, "-c", AS_NOBODY, str(target)],
        cwd=Path(__file__).parents[3],
        check=False,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert run.stderr == ""
    assert run.stdout == message.format(target) + "\n"
    assert list(readable_folder.iterdir()) == []


# --- what is refused before anything is written


@pytest.mark.parametrize(
    ("source", "changes", "options", "message"),
    [
        (PatternSource(("satellite",)), {}, {}, "map type 'roadmap': Pattern has satellite"),
        (PatternSource(tile_px=512), {}, {}, "plan is for another pixel grid"),
        (PatternSource(), {}, {"connections": 0}, "0 connections"),
        (PatternSource(), {}, {"workers": 0}, "0 workers"),
    ],
)
def test_refused_before_anything_is_written(tmp_path, source, changes, options, message):
    with pytest.raises(InvalidInput, match=message):
        capture(planned(MISSION.replace(**changes)), source, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_a_source_without_map_types_writes_under_the_given_name(tmp_path):
    worked_out = planned(Mission(AREA, 120.0, map_types=("roadmap",)))
    assert capture(worked_out, PatternSource(()), tmp_path).written == len(worked_out)
    assert len(list((tmp_path / "roadmap").glob("*.tif"))) == len(worked_out)


def test_a_job_is_a_plain_value_for_any_executor(tmp_path):
    import pickle

    worked_out, source = planned(), PatternSource()
    job = records.image_job(worked_out, 3, source, "satellite", tmp_path)
    parts = source.parts(job.shot.window)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    job, parts, pixels = pickle.loads(pickle.dumps((job, parts, pixels)))
    assert records.make_picture(job, parts, pixels).entropy > 0
    assert (tmp_path / f"{worked_out.names[3]}.tif").exists()
    with pytest.raises(PartError):
        records.make_picture(job, parts[1:], pixels)
    assert dataclasses.is_dataclass(job)


def test_large_pictures_are_made_a_few_at_a_time(in_one_go, tmp_path, monkeypatch):
    worked_out, folder, _, _ = in_one_go
    asked = []

    class Watched(pipeline.Pipeline):
        def __init__(self, *arguments, at_once, **more):
            asked.append(at_once)
            super().__init__(*arguments, at_once=at_once, **more)

    monkeypatch.setattr(making, "Pipeline", Watched)
    capture(worked_out, PatternSource(), tmp_path / "many")
    largest_px = int((worked_out.frames.width_px * worked_out.frames.height_px).max())
    assert asked == [limits.MAX_PICTURES_AT_ONCE_PX // largest_px] * 2
    assert asked[0] > 256
    monkeypatch.setattr(making, "MAX_PICTURES_AT_ONCE_PX", largest_px - 1)
    capture(worked_out, PatternSource(), tmp_path / "one")
    assert asked[2:] == [1, 1]
    assert contents(tmp_path / "one") == contents(folder)
