"""Captures that are killed: what a resumed one leaves is what one in one go leaves, byte for byte."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.mission.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.sources import PatternSource

ROOT = Path(__file__).parents[3]
AREA = Box(35.16, -89.90, 35.148, -89.886)
# Lines of the journal after which a run is killed; 0 is as soon as the mission is there.
KILLS = (0, 1, 17, 60)
# Far longer than a run takes.
NEVER_S = 60.0

CAPTURE = """
import sys
from tests.core.capture.test_crash import capture, planned, PatternSource
print("ready", flush=True)
capture(planned(sys.argv[2]), PatternSource(wait_s=0.004), sys.argv[1], connections=2, resume=True)
"""


def planned(image_format):
    mission = Mission(AREA, 120.0, map_types=("satellite", "roadmap"), image_format=image_format)
    return plan(mission, PatternSource().grid)


def contents(folder: Path) -> dict[str, object]:
    files = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    return {**files, "journal.jsonl": frozenset(files["journal.jsonl"].splitlines())}


def reached(folder: Path, lines: int) -> bool:
    journal = folder / "journal.jsonl"
    return journal.exists() and journal.read_bytes().count(b"\n") >= lines


@pytest.mark.parametrize("image_format", ["tif", "jpg"])
def test_killed_and_resumed_is_as_in_one_go(tmp_path, image_format):
    whole, folder = tmp_path / "whole", tmp_path / "killed"
    result = capture(planned(image_format), PatternSource(), whole)
    assert result.total > max(KILLS)
    for lines in KILLS:
        with subprocess.Popen(
            [sys.executable, "-c", CAPTURE, str(folder), image_format],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            text=True,
        ) as run:
            assert run.stdout.readline() == "ready\n"
            deadline = time.monotonic() + NEVER_S
            while not reached(folder, lines):
                assert run.poll() is None, "the run ended before it was killed"
                assert time.monotonic() < deadline
                time.sleep(0.001)
            run.kill()
        assert run.returncode != 0
    resumed = capture(planned(image_format), PatternSource(), folder, resume=True)
    assert resumed.skipped >= max(KILLS)
    assert contents(folder) == contents(whole)
