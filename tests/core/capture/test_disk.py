"""Disks that fill up and folders that close: one clear message, and what was finished is gone on with."""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from pathlib import Path

import pytest
from terrainav.core.errors import OutputError
from terrainav.core.mission.mission import Mission
from terrainav.core.storage.files import make_folder, write_whole

from tests.core.capture.test_crash import AREA, check_interrupted, contents
from tests.support.forks import Driver
from tests.support.thinning import sampled

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system sets no limits on processes")

MISSION = Mission(AREA, 120.0, map_types=("satellite", "roadmap"), overlap_along=0.1, zoom=18, image_format="jpg")
AS_ROOT = hasattr(os, "getuid") and os.getuid() == 0


@pytest.fixture(scope="module")
def driver():
    with Driver() as running:
        yield running


@pytest.fixture(scope="module")
def whole(driver, tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "out"
    outcome = driver.run(mission=MISSION.to_json(), folder=str(folder))
    assert outcome["code"] == 0
    return contents(folder)


@pytest.fixture
def open_folder():
    """A folder that every user may enter; pytest's own are closed to others."""
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        yield Path(name)


@pytest.fixture
def small_disk(tmp_path):
    """A file system in memory whose size can be told."""
    if not AS_ROOT:
        pytest.skip("only root may mount a file system")
    mounted = tmp_path / "disk"
    mounted.mkdir()

    def resize(kilobytes, how="remount,"):
        run = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"{how}size={kilobytes}k", "tmpfs", str(mounted)],
            check=False,
            capture_output=True,
            text=True,
        )
        if run.returncode != 0:
            pytest.skip(f"no file system can be mounted here: {run.stderr.strip()}")

    resize(4, how="")
    yield mounted, resize
    subprocess.run(["umount", str(mounted)], check=True)


def check_message(outcome, folder, reason):
    assert outcome["code"] == 3
    pattern = rf"folder {re.escape(str(folder))}(/\w+)?: (cannot (write [\w.-]+|be made)|cannot be made) \({reason}\)"
    assert re.match(pattern, outcome["error"]), outcome["error"]
    assert "\n" not in outcome["error"]


def test_a_full_disk_ends_in_a_clear_message_and_is_resumed(driver, small_disk, whole):
    disk, resize = small_disk
    needed = sum(len(data) for data in whole.values() if isinstance(data, bytes)) // 1024
    folder = disk / "out"
    stops = []
    # The disk grows a little each time, so that it is full at another point: before the mission is written, amid the
    # plan's files, amid pictures, at the tables.
    for kilobytes in [4, 8, 12, 24, 40, 60, *(int(needed * share) for share in (0.2, 0.5, 0.8, 0.95))]:
        resize(kilobytes)
        outcome = driver.run(mission=MISSION.to_json(), folder=str(folder))
        if outcome["code"] == 0:
            break
        check_message(outcome, folder, r"No space left on device|the disk took only a part of a line")
        stops.append(outcome["error"])
        if folder.exists():
            assert not list(folder.rglob("*.part"))
            check_interrupted(folder, whole)
    assert len({stop.partition("cannot write ")[2] for stop in stops}) >= 3
    resize(4 * needed)
    outcome = driver.run(mission=MISSION.to_json(), folder=str(folder))
    assert outcome["code"] == 0
    assert contents(folder) == whole


@pytest.mark.parametrize("largest_file_bytes", sampled([0, 100, 1200, 4000, 15_000, -1], 3))
def test_files_that_may_not_grow_end_in_a_clear_message_and_are_resumed(driver, tmp_path, whole, largest_file_bytes):
    folder = tmp_path / "out"
    if largest_file_bytes < 0:
        largest_file_bytes += max(len(data) for data in whole.values() if isinstance(data, bytes))
    outcome = driver.run(mission=MISSION.to_json(), folder=str(folder), largest_file_bytes=largest_file_bytes)
    check_message(outcome, folder, "File too large|the disk took only a part of a line")
    assert not list(folder.rglob("*.part"))
    check_interrupted(folder, whole)
    assert driver.run(mission=MISSION.to_json(), folder=str(folder))["code"] == 0
    assert contents(folder) == whole


@pytest.mark.parametrize("closes_after", sampled([1, 7, 25], 3))
def test_a_folder_that_turns_read_only_ends_in_a_clear_message_and_is_resumed(driver, open_folder, whole, closes_after):
    folder = open_folder / "out"
    folder.mkdir()
    job = {"mission": MISSION.to_json(), "folder": str(folder), "obeys_permissions": True}
    outcome = driver.run(**job, closes_after=closes_after)
    check_message(outcome, folder, "Permission denied")
    check_interrupted(folder, whole)
    outcome = driver.run(**job)
    assert outcome["code"] == 3, "a folder that stays closed"
    for path in (folder, *(path for path in folder.iterdir() if path.is_dir())):
        path.chmod(0o755)
    assert driver.run(**job)["code"] == 0
    assert contents(folder) == whole


def test_a_file_that_must_last_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    """The order of a durable write: its bytes, its name, the folder that holds the name."""
    done = []
    real_sync, real_replace = os.fsync, os.replace

    def fsync(descriptor):
        done.append("folder" if os.path.isdir(f"/proc/self/fd/{descriptor}") else "bytes")  # noqa: PTH112
        real_sync(descriptor)

    def replace(partial, target):
        done.append("name")
        real_replace(partial, target)

    monkeypatch.setattr(os, "fsync", fsync)
    monkeypatch.setattr(os, "replace", replace)
    write_whole(tmp_path / "a", b"all", durable=True)
    assert done == ["bytes", "name", "folder"]
    write_whole(tmp_path / "b", b"all")
    assert done[3:] == ["name"]


def test_a_folder_below_a_file_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OutputError, match="cannot be made"):
        make_folder(tmp_path / "file" / "out")
