"""What the command advises."""

from __future__ import annotations

import hashlib
import signal
from contextlib import contextmanager

import numpy as np
from terrainav.core.cli import datasets, flying, pairing
from terrainav.core.dataset.split import split

from tests.support import patterns
from tests.support.datasets import write_dataset
from tests.support.faults import flat_placeholder
from tests.support.remedies import Case, remedy
from tests.support.tileserver import TileServer

BOX = "35.16_-89.90_35.157_-89.897_400"
PAIRS = ("pairs", "35.16_-89.90_35.0_-89.7", "--views", "1", "--size", "32", "--split", "1", "1", "0")


@remedy("cli/__init__.py", "not enough memory; ask for less at a time: fewer or smaller images")
def _no_memory(case: Case) -> None:
    from terrainav.core.mission import plan as planning

    real = planning.plan

    def hungry(mission, grid, heights=None):
        # A machine that has room for ten images of 640 px.
        made = real(mission, grid)
        if len(made) * made.frames.width_px[0] > 6_400:
            raise MemoryError
        return made

    case.monkeypatch.setattr(planning, "plan", hungry)
    many = "35.16_-89.90_35.155_-89.89_120"
    case.says(case.run("plan", "--coords", many).stderr)
    case.follow("fewer", lambda: case.run("plan", "--coords", BOX).returncode == 0)
    smaller = ("--image-px", "64", "--max-px", "64")
    case.follow("smaller images", lambda: case.run("plan", "--coords", many, *smaller).returncode == 0)
    case.follow("ask for less at a time", lambda: True)


@remedy("cli/listing.py", "cache limit {} MB: must be 1 or more; --no-cache keeps nothing")
def _no_limit(case: Case) -> None:
    asked = ("capture", "--coords", BOX, "--data-dir", "out")
    case.says(case.run(*asked, "--cache-limit", "0").stderr)
    case.follow("--no-cache keeps nothing", lambda: case.run(*asked, "--no-cache").returncode == 0)


@remedy("cli/flying.py", "mission file {} and --{}: give one of the two")
def _mission_twice(case: Case) -> None:
    assert case.run("plan", "--coords", BOX, "--output", "mission.json").returncode == 0
    case.says(case.run("plan", "mission.json", "--fov", "80").stderr)
    assert case.run("plan", "mission.json").returncode == 0
    case.follow("give one of the two", lambda: case.run("plan", "--coords", BOX, "--fov", "80").returncode == 0)


@contextmanager
def pressed():
    """Ctrl+C that has been pressed."""
    yield [signal.SIGINT]


STOPPED = "terrainav: stopped; finished images are kept, continue with --resume"


@remedy("cli/flying.py", STOPPED)
def _stopped_capture(case: Case) -> None:
    asked = ("capture", "--coords", BOX, "--data-dir", "out")
    with case.monkeypatch.context() as stopped:
        stopped.setattr(flying, "collect_signals", pressed)
        case.says(case.run(*asked).stderr, only_here=False)
    case.follow(
        "finished images are kept, continue with --resume", lambda: case.run(*asked, "--resume").returncode == 0
    )


@remedy("cli/pairing.py", STOPPED)
def _stopped_pairs(case: Case) -> None:
    asked = (*PAIRS, "--count", "2", "--data-dir", "out")
    with case.monkeypatch.context() as stopped:
        stopped.setattr(pairing, "collect_signals", pressed)
        case.says(case.run(*asked).stderr, only_here=False)
    case.follow(
        "finished images are kept, continue with --resume", lambda: case.run(*asked, "--resume").returncode == 0
    )


@remedy(
    "cli/flying.py",
    "same tile: {} has the same file in {} places, shown by {} images{}. It may be water or "
    "snow; if it shows no "
    "imagery, treat it as missing: --resume --placeholder {}",
)
def _same_tile(case: Case) -> None:
    grey = np.full((256, 256, 3), 204, np.uint8)

    def paint(map_type, zoom, x, y, size_px):
        # Every second tile of a placeholder.
        return grey if (x + y) % 2 else patterns.positions(map_type, zoom, x, y, size_px)

    with TileServer(paint) as server:
        asked = (
            "capture",
            "--coords",
            BOX,
            "--source",
            server.url_template,
            "--data-dir",
            "out",
            "--image-px",
            "800",
        )
        line = case.says(case.run(*asked).stderr)
        named = line.rpartition("missing: ")[2]
        assert named.split()[-1] == hashlib.sha256(flat_placeholder()).hexdigest()[:16]
        case.follow(named, lambda: "failed" in case.run(*asked, *named.split()).stdout)


@remedy("cli/datasets.py", "--no-augment: goes with neither --contrast nor --brightness; leave one out")
def _no_augment(case: Case) -> None:
    write_dataset(case.tmp_path / "OUT")
    asked = ("load", "OUT", "--part", "all", "--batch-size", "2", "--img-size", "16", "16", "3")
    case.says(case.run(*asked, "--no-augment", "--contrast", "0.2").stderr)
    assert case.run(*asked, "--no-augment").returncode == 0
    case.follow("leave one out", lambda: case.run(*asked, "--contrast", "0.2").returncode == 0)


@remedy("cli/options.py", "{}: error: {}; see {} --help\n")
def _usage(case: Case) -> None:
    line = case.says(case.run("plan", "--no-such-option").stderr)
    named = line.rpartition("; ")[2]
    case.follow(named, lambda: case.run(*named.split()[2:]).returncode == 0)


@remedy("cli/pairing.py", "no folder for the pairs: give --data-dir, such as . for the current one")
def _no_folder(case: Case) -> None:
    asked = (*PAIRS, "--count", "2")
    case.says(case.run(*asked).stderr)
    case.follow(
        "give --data-dir, such as . for the current one",
        lambda: case.run(*asked, "--data-dir", ".").returncode == 0,
    )


@remedy("cli/pairing.py", "camera {} and fov {}: give one of the two")
def _camera_twice(case: Case) -> None:
    asked = (*PAIRS, "--count", "2", "--dry-run")
    camera, fov = ("--camera", "DJI Mini 2"), ("--fov", "60")
    case.says(case.run(*asked, *camera, *fov).stderr)
    assert case.run(*asked, *camera).returncode == 0
    case.follow("give one of the two", lambda: case.run(*asked, *fov).returncode == 0)


@remedy("cli/pairing.py", "box {}: needs a number of places, --count")
def _no_count(case: Case) -> None:
    case.says(case.run(*PAIRS, "--dry-run").stderr)
    case.follow(
        "needs a number of places, --count",
        lambda: case.run(*PAIRS, "--dry-run", "--count", "2").returncode == 0,
    )


@remedy("cli/pairing.py", "--yaws and --rounds: rings have no rounds; give --views for a spiral")
def _rings(case: Case) -> None:
    asked = ("pairs", "35.16_-89.90_35.0_-89.7", "--count", "2", "--split", "1", "1", "0", "--dry-run")
    case.says(case.run(*asked, "--yaws", "3", "--rounds", "1").stderr)
    case.follow("give --views for a spiral", lambda: case.run(*asked, "--views", "3", "--rounds", "1").returncode == 0)


@remedy("cli/datasets.py", "{}that is most of them: smaller blocks lose more, so try a larger --block")
def _most_lost(case: Case) -> None:
    from tests.core.dataset.grounds import dataset_of

    windows = [(100_000_000 + 10 * (i % 12), 50_000_000 + 10 * (i // 12), 18, 18) for i in range(144)]
    folder = dataset_of(case.tmp_path / "out", 19, windows)
    shares = (0.5, 0.25, 0.25)

    def lost(block_m):
        made = split(folder, shares, how="blocks", block_m=block_m, dry_run=True)
        return made.gap, "\n".join(datasets._split_lines(made))

    most, text = lost(4.0)
    case.says(text)
    case.follow("smaller blocks lose more, so try a larger --block", lambda: lost(15.0)[0] < most)


@remedy("mission/settings.py", "area {}: needs a height, --agl")
def _no_height(case: Case) -> None:
    polygon = '{"type": "Polygon", "coordinates": [[[10, 35], [10.01, 35], [10, 35.01], [10, 35]]]}'
    (case.tmp_path / "area.geojson").write_text(polygon)
    case.says(case.run("plan", "--area", "area.geojson").stderr)
    case.follow(
        "needs a height, --agl",
        lambda: case.run("plan", "--area", "area.geojson", "--agl", "400").returncode == 0,
    )
