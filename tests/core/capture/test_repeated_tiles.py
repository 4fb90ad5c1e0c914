"""The same file for places far apart: told, and treated as missing where the user says so."""

from __future__ import annotations

import hashlib
import json
import math
import threading
from contextlib import closing

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.progress import Listener, Repeat
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.placeholder import PLACEHOLDER_REASON, Provided
from terrainav.core.imagery.source import tile_parts
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.map_frame import capture_window

from tests.support.command import command
from tests.support.faults import FAULTS, flat_placeholder
from tests.support.patterns import positions, to_bytes
from tests.support.rasters import write
from tests.support.thinning import sampled
from tests.support.tileserver import TileServer

MISSION = Mission(Box(35.16, -89.90, 35.155, -89.893), 120.0, zoom=18)
PLAN = plan(MISSION, PixelGrid())
NEEDED = [
    {
        (part.window.zoom, int(part.window.left_px) // 256, int(part.window.top_px) // 256)
        for part in tile_parts(capture_window(PLAN, index), PLAN.grid)
    }
    for index in range(len(PLAN))
]
TILES = sorted(set().union(*NEEDED))
# At both ends and amid the mission.
GREY = {TILES[0], TILES[1], TILES[len(TILES) // 2], TILES[-1]}
SHOWING = tuple(name for name, tiles in zip(PLAN.names, NEEDED) if tiles & GREY)
GREY_FILE = flat_placeholder()
DIGEST = hashlib.sha256(GREY_FILE).hexdigest()[:16]
FOUND = (Repeat("satellite", DIGEST, len(GREY), SHOWING),)


def paint(grey):
    def tile(map_type, zoom, x, y, size_px):
        if (zoom, x, y) in grey:
            return np.full((size_px, size_px, 3), 204, np.uint8)
        return positions(map_type, zoom, x, y, size_px)

    return tile


@pytest.fixture
def server():
    with TileServer(paint(GREY)) as running:
        yield running


def run(server, folder, *, cache=None, placeholders=(), connections=4, **options):
    with closing(
        open_source(server.url_template, cache=cache, placeholders=placeholders, connections=connections, tile_px=256)
    ) as source:
        return capture(PLAN, source, folder, connections=connections, **options)


def noted(folder):
    """Digests that the journal has of each picture that is done."""
    lines = map(json.loads, (folder / "journal.jsonl").read_text(encoding="utf-8").splitlines())
    last = {line["name"]: line for line in lines}
    return {name: tuple(line.get("repeated", ())) for name, line in last.items() if line["status"] == "done"}


def pictures(folder):
    return {path.stem: path.read_bytes() for path in (folder / "satellite").glob("*.tif")}


def test_the_mission_is_what_these_tests_need():
    assert len(SHOWING) >= 4
    assert len(PLAN) > len(SHOWING) + 4


def test_the_same_file_in_several_places_is_told_and_nothing_left_out(server, tmp_path):
    result = run(server, tmp_path / "out")
    assert result.repeated == FOUND
    assert (result.written, result.failed) == (len(PLAN), ())
    assert noted(tmp_path / "out") == {name: (DIGEST,) * (name in SHOWING) for name in PLAN.names}


def test_it_is_the_same_on_every_way_to_the_tiles(server, tmp_path):
    cache = TileCache(tmp_path / "cache")
    results = [
        run(server, tmp_path / str(connections), connections=connections, workers=1 + connections % 3)
        for connections in (1, 16)
    ]
    results += [run(server, tmp_path / name, cache=cache) for name in ("cold", "warm")]
    # From the second on the server is asked for nothing.
    assert sum(server.requests.values()) == 3 * len(TILES)
    assert {result.repeated for result in results} == {FOUND}
    assert len({tuple(sorted(pictures(folder).items())) for folder in map(tmp_path.joinpath, ("1", "warm"))}) == 1


def test_two_places_and_neighbours_are_not_told(tmp_path):
    pond = {tile for tile in TILES if tile[1] <= TILES[0][1] + 2 and tile[2] <= TILES[0][2] + 2}
    assert len(pond) >= 6
    for grey in (pond, {TILES[0], TILES[-1]}):
        with TileServer(paint(grey)) as server:
            assert run(server, tmp_path / f"{len(grey)}").repeated == ()


def test_a_mission_of_nothing_else_is_told(tmp_path):
    with TileServer(paint(set(TILES))) as server:
        (repeat,) = run(server, tmp_path / "out").repeated
    assert (repeat.places, repeat.images) == (len(TILES), tuple(PLAN.names))


def test_each_map_type_has_its_own(tmp_path):
    mission = MISSION.replace(map_types=("satellite", "roadmap"))
    worked_out = plan(mission, PixelGrid())

    def blank_roads(map_type, zoom, x, y, size_px):
        return paint(set(TILES) if map_type == "roadmap" else GREY)(map_type, zoom, x, y, size_px)

    with TileServer(blank_roads) as server, closing(open_source(server.map_type_template)) as source:
        result = capture(worked_out, source, tmp_path / "out")
    assert [(repeat.map_type, repeat.places) for repeat in result.repeated] == [
        ("satellite", len(GREY)),
        ("roadmap", len(TILES)),
    ]


@pytest.mark.parametrize(
    ("digest", "only_failed"),
    sampled([(DIGEST, False), (DIGEST.upper(), True), (hashlib.sha256(GREY_FILE).hexdigest(), False)], 2),
)
def test_what_is_named_a_placeholder_is_missing_from_then_on(server, tmp_path, only_failed, digest):
    folder, cache = tmp_path / "out", TileCache(tmp_path / "cache")
    run(server, folder, cache=cache)
    before = pictures(folder)
    again = run(server, folder, cache=cache, placeholders=[digest], resume=not only_failed, only_failed=only_failed)
    assert {failure.name for failure in again.failed} == set(SHOWING)
    assert all(failure.reason.endswith(PLACEHOLDER_REASON) for failure in again.failed)
    assert (again.written, again.repeated) == (0, ())
    assert again.total == (len(SHOWING) if only_failed else len(PLAN))
    # What shows no placeholder is as it was; what does is gone, and named in the table.
    assert pictures(folder) == {name: data for name, data in before.items() if name not in SHOWING}
    table = Table.load(folder / "satellite" / "meta_data.csv")
    failed = {name[:-4] for name, status in zip(table.img_names, table.status) if status == "failed"}
    assert failed == set(SHOWING)
    # The provider has imagery there later on.
    server.paint = paint(())
    healed = run(server, folder, cache=cache, placeholders=[digest], resume=True)
    assert (healed.written, healed.failed) == (len(SHOWING), ())
    whole = tmp_path / "whole"
    run(server, whole)
    assert pictures(folder) == pictures(whole)


def test_a_known_placeholder_is_missing_at_once(server, tmp_path):
    result = run(server, tmp_path / "out", placeholders=[DIGEST])
    assert {failure.name for failure in result.failed} == set(SHOWING)
    assert result.repeated == ()


def test_a_run_that_is_stopped_tells_what_it_has_seen(tmp_path):
    last_row, stopped = max(y for _, _, y in TILES), threading.Event()
    before_it = [name for name, tiles in zip(PLAN.names, NEEDED) if all(y < last_row for _, _, y in tiles)]

    def slow(map_type, zoom, x, y, size_px):
        if y == last_row:
            stopped.wait(30.0)
        return paint(set(TILES))(map_type, zoom, x, y, size_px)

    def cancelled():
        return len(pictures(tmp_path / "out")) == len(before_it)

    with TileServer(slow) as server:
        first = run(server, tmp_path / "out", listener=Listener(cancelled=cancelled), connections=16)
        stopped.set()
        assert first.cancelled
        (repeat,) = first.repeated
        assert (repeat.sha256, repeat.images) == (DIGEST, tuple(before_it))
        again = run(server, tmp_path / "out", placeholders=[DIGEST], resume=True)
    assert len(again.failed) == len(PLAN)
    assert pictures(tmp_path / "out") == {}


def test_what_an_earlier_run_has_noted_stays_noted(tmp_path):
    folder, half = tmp_path / "out", range(len(PLAN) // 2)
    blue_file = to_bytes(np.full((256, 256, 3), (0, 0, 204), np.uint8), "png")
    blue = hashlib.sha256(blue_file).hexdigest()[:16]
    with TileServer(paint(set(TILES))) as server:
        run(server, folder, only=half)
    with TileServer(lambda *_: np.full((256, 256, 3), (0, 0, 204), np.uint8)) as server:
        run(server, folder, resume=True)
    digests = noted(folder)
    assert all(DIGEST in digests[PLAN.names[index]] for index in half)
    assert {digests[name] for index, name in enumerate(PLAN.names) if index not in half} == {(blue,)}


def test_pictures_of_static_maps_are_compared_as_well(tmp_path, monkeypatch):
    def grey(handler, body):
        width, height = handler.picture(body).size
        handler.answer(200, to_bytes(np.full((height, width, 3), 204, np.uint8), "png"), "image/png")

    monkeypatch.setitem(FAULTS, "flat", grey)
    # Wide enough for pictures of each size: they differ by a pixel.
    mission = Mission(Box(35.16, -89.90, 35.157, -89.88), 120.0, source="google-static")
    with TileServer() as server:
        monkeypatch.setenv("TERRAINAV_GOOGLE_URL", server.static_map_url)
        server.fail("flat")
        with closing(open_source("google-static", key="k")) as source:
            worked_out = plan(mission, source.grid)
            result = capture(worked_out, source, tmp_path / "out")
        sizes = set(zip(worked_out.frames.width_px.tolist(), worked_out.frames.height_px.tolist()))
        assert len(result.repeated) == len(sizes) > 1
        assert sum(repeat.places for repeat in result.repeated) == len(worked_out)
        digests = [repeat.sha256 for repeat in result.repeated]
        with closing(open_source("google-static", key="k", placeholders=digests)) as source:
            again = capture(worked_out, source, tmp_path / "out", resume=True)
    assert len(again.failed) == len(worked_out)


def test_the_embedded_world_sends_no_files():
    with closing(open_source("world")) as source:
        assert not isinstance(source, Provided)


def test_a_raster_file_is_not_told(tmp_path):
    path = tmp_path / "snow.tif"
    box = MISSION.area
    west_m = math.radians(box.west_deg) * 6_378_137.0
    north_m = math.asinh(math.tan(math.radians(box.north_deg))) * 6_378_137.0
    snow = np.full((3, 1200, 1200), 255, np.uint8)
    write(path, snow, (west_m - 200.0, 1.0, 0.0, north_m + 200.0, 0.0, -1.0), 3857)
    mission = Mission(box, 120.0, source=str(path))
    with closing(open_source(str(path))) as source:
        worked_out = plan(mission, source.grid)
        result = capture(worked_out, source, tmp_path / "out")
    assert (result.written, result.repeated) == (len(worked_out), ())


@pytest.mark.parametrize("wrong", ["", "3f2a", "g" * 16, "3f2a91c04be17d55" * 5])
def test_what_is_no_digest_is_refused(wrong):
    for name in ("world", "https://example.org/{z}/{x}/{y}.png"):
        with pytest.raises(
            InvalidInput,
            match=rf"^placeholder '{wrong}': must be the SHA-256 of a tile's file, or the first 16",
        ):
            open_source(name, placeholders=[wrong])


def test_the_command_says_it_and_does_it(server, tmp_path, monkeypatch, capsys):
    shell = command(tmp_path, monkeypatch, capsys)
    asked = (
        "capture",
        "--coords",
        "35.16_-89.90_35.155_-89.893_120",
        "--source",
        server.url_template,
        "--zoom",
        "18",
        "--quiet",
    )
    first = shell(*asked, "--data-dir", "out")
    assert first.returncode == 0, first.stderr
    (line,) = [line for line in first.stderr.splitlines() if line.startswith("same tile: ")]
    assert f"in {len(GREY)} places, shown by {len(SHOWING)} images, such as {SHOWING[0]}" in line
    assert line.endswith(f"--resume --placeholder {DIGEST}")
    # As it says.
    again = shell(*asked, "--data-dir", "out", *line.split(": ")[-1].split())
    assert again.returncode == 1
    assert f"{len(SHOWING)} failed" in again.stdout
    assert "same tile" not in again.stderr
    shown = json.loads(shell(*asked, "--data-dir", "other", "--json").stdout)
    assert shown["repeated"] == [
        {"map_type": "satellite", "sha256": DIGEST, "places": len(GREY), "images": list(SHOWING)}
    ]
    for variable in (DIGEST, f"{'0' * 16} {DIGEST}"):
        by_variable = shell(*asked, "--data-dir", f"by {variable}", "--json", TERRAINAV_PLACEHOLDER=variable)
        assert len(json.loads(by_variable.stdout)["failed"]) == len(SHOWING)


def test_a_source_of_one_s_own_knows_its_placeholders(server, tmp_path, monkeypatch, capsys):
    shell = command(tmp_path, monkeypatch, capsys)
    added = shell("sources", "add", "town", server.url_template, "--placeholder", DIGEST, "0" * 64)
    assert added.returncode == 0, added.stderr
    assert "2 known" in shell("sources", "show", "town").stdout
    asked = (
        "capture",
        "--coords",
        "35.16_-89.90_35.155_-89.893_120",
        "--source",
        "town",
        "--zoom",
        "18",
        "--quiet",
    )
    shown = json.loads(shell(*asked, "--data-dir", "out", "--json").stdout)
    assert ({failure["name"] for failure in shown["failed"]}, shown["repeated"]) == (set(SHOWING), [])
    wrong = shell("sources", "add", "other", server.url_template, "--placeholder", "grey")
    assert wrong.returncode == 2
    assert "placeholder 'grey': must be the SHA-256 of a tile's file, or the first 16" in wrong.stderr


def test_the_file_that_is_named_is_the_one_that_was_sent(server, tmp_path):
    """What the digest stands for, without the code that makes it."""
    (repeat,) = run(server, tmp_path / "out").repeated
    with Image.open(tmp_path / "out" / "satellite" / f"{repeat.images[0]}.tif") as picture:
        assert (np.asarray(picture) == 204).all(axis=2).any()
    assert hashlib.sha256(GREY_FILE).hexdigest().startswith(repeat.sha256)
