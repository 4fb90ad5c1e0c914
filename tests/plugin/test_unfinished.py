"""Captures that did not end, as after a crash: found again at the next start, offered, and changed by nobody else."""

from __future__ import annotations

import os
import subprocess  # nosec B404
import sys
from pathlib import Path

import pytest
from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QLockFile
from terrainav.terrainav_plugin import paths
from terrainav.terrainav_plugin.capture import left, unfinished
from terrainav.terrainav_plugin.paths import UNFINISHED, is_remote

from tests.plugin.test_runs import pictures, prepared, press_capture, server  # noqa: F401  fixtures

SLOW_S = 0.5


def notes():
    return sorted(Path(QgsApplication.qgisSettingsDirPath(), UNFINISHED).glob("*.json"))


def crash(desk, run):
    """Leave what a crash leaves behind: the note of a run, whose lock nobody holds, and the images so far."""
    (note,) = notes()
    text = note.read_bytes()
    run.cancel()
    desk.wait_for_run()
    assert notes() == []
    desk.session.runs.dismiss(run)
    note.write_bytes(text)
    return note


def contents(folder):
    return {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in folder.rglob("*") if path.is_file()}


def capitalized(prepared, server, least):  # noqa: F811
    server.latency_s = SLOW_S
    run = press_capture(prepared)
    prepared.wait(lambda: len(pictures(prepared.folder)) >= least)
    return run


def start_again(desk):
    """What QGIS's next start brings: the plugin's own look at the notes."""
    desk.plugin._unfinished_soon.start()
    desk.wait(lambda: not desk.plugin._unfinished_soon.isActive())
    desk.wait(lambda: desk.session.runs._finding is None)


def offers(desk):
    return [text for text in desk.messages() if "did not end" in text]


def test_capture_is_noted_while_it_goes_on_and_no_longer(prepared, server):  # noqa: F811
    run = capitalized(prepared, server, 1)
    assert len(notes()) == 1
    # What this session has in its hands is no crash's.
    start_again(prepared)
    assert offers(prepared) == []
    server.latency_s = 0.0
    prepared.wait_for_run()
    assert notes() == []
    assert run.result.written


def test_capture_that_did_not_end_is_offered_and_resumed(prepared, server, screenshot):  # noqa: F811
    run = capitalized(prepared, server, 2)
    total = run.images
    note = crash(prepared, run)
    before = contents(prepared.folder)
    there = len(pictures(prepared.folder))
    assert 2 <= there < total
    start_again(prepared)
    assert offers(prepared) == [f"mission: its capture did not end: {there} of {total} images."]
    assert contents(prepared.folder) == before
    assert note.exists()
    screenshot("unfinished-capture")
    server.latency_s = 0.0
    prepared.buttons_in_message_bar()["Resume"].click()
    prepared.wait(lambda: len(prepared.session.runs.runs) == 1)
    prepared.wait_for_run()
    assert len(pictures(prepared.folder)) == total
    assert all(
        path.read_bytes() == before[path][1]
        for path in before
        if path.suffix == ".tif" and path.parent.name == "satellite"
    )
    assert notes() == []


def test_waiting_capture_is_offered_though_it_has_no_folder_yet(prepared, server, tmp_path):  # noqa: F811
    first = capitalized(prepared, server, 1)
    prepared.click(prepared.dock.capture)
    second = press_capture(prepared, tmp_path / "mission-2")
    assert len(notes()) == 2
    kept = {note: note.read_bytes() for note in notes()}
    prepared.session.runs.cancel()
    prepared.wait_for_run()
    for run in (first, second):
        prepared.session.runs.dismiss(run)
    for note, text in kept.items():
        note.write_bytes(text)
    start_again(prepared)
    assert f"mission-2: its capture did not end: 0 of {second.images} images." in offers(prepared)
    assert not (tmp_path / "mission-2").exists()


def test_capture_that_is_forgotten_is_offered_no_more(prepared, server):  # noqa: F811
    crash(prepared, capitalized(prepared, server, 1))
    before = contents(prepared.folder)
    start_again(prepared)
    prepared.buttons_in_message_bar()["Forget (files are kept)"].click()
    assert notes() == []
    assert contents(prepared.folder) == before


def leave(folder, run):
    """Make a folder look as after a crash of another program: images and their journal, and no table since."""
    (folder / "satellite" / "meta_data.csv").unlink()
    gone = pictures(folder)[0]
    gone.unlink()
    (folder / "journal.jsonl").touch()
    return run.images - 1


def test_capture_without_a_note_is_found_in_its_folder_and_resumed(prepared, server):  # noqa: F811
    run = press_capture(prepared)
    prepared.wait_for_run()
    start_again(prepared)
    assert offers(prepared) == []
    there = leave(prepared.folder, run)
    before = contents(prepared.folder)
    prepared.session.memory.write()
    start_again(prepared)
    assert offers(prepared) == [f"mission: its capture did not end: {there} of {there + 1} images."]
    assert contents(prepared.folder) == before
    prepared.buttons_in_message_bar()["Resume"].click()
    prepared.wait(lambda: not prepared.session.runs.idle)
    prepared.wait_for_run()
    assert len(pictures(prepared.folder)) == there + 1
    assert left.left_folders() == []


def test_capture_found_in_its_folder_is_forgotten_until_it_is_captured_again(prepared, server):  # noqa: F811
    run = press_capture(prepared)
    prepared.wait_for_run()
    leave(prepared.folder, run)
    prepared.session.memory.write()
    start_again(prepared)
    before = contents(prepared.folder)
    prepared.buttons_in_message_bar()["Forget (files are kept)"].click()
    assert left.left_folders() == []
    assert contents(prepared.folder) == before
    prepared.click(prepared.dock.capture)
    prepared.wait(lambda: prepared.session.runs.runs[-1] is not run)
    prepared.wait_for_run()
    leave(prepared.folder, run)
    assert left.left_folders() == [prepared.folder]


def test_folder_of_another_machine_is_asked_nothing(prepared, server, monkeypatch):  # noqa: F811
    crash(prepared, capitalized(prepared, server, 1))
    monkeypatch.setattr(unfinished, "is_remote", lambda _folder: True)

    def refuse(_left):
        raise AssertionError("it was looked into")

    monkeypatch.setattr(unfinished.UnfinishedCapture, "count", refuse)
    start_again(prepared)
    assert offers(prepared) == ["mission: its capture did not end."]


def test_lock_of_a_process_that_has_died_is_free(tmp_path):
    """And one of a process that lives is not."""
    lock = unfinished._make_lock(tmp_path / "a.json")
    held = (
        "import os, sys; from PyQt5.QtCore import QCoreApplication, QLockFile; app = QCoreApplication([]); "
        f"lock = QLockFile({str(tmp_path / 'a.lock')!r}); assert lock.tryLock(0); print('held', flush=True); "
        "sys.stdin.readline(); os._exit(1)"
    )
    python = Path(sys.executable) if "python" in Path(sys.executable).name else Path("/usr/bin/python3")
    with subprocess.Popen(  # nosec B603
        [str(python), "-c", held], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "held\n"
        assert not lock.tryLock(0)
        process.stdin.write("\n")
        process.stdin.flush()
        process.wait()
    assert isinstance(lock, QLockFile)
    assert lock.tryLock(0)
    lock.unlock()


def test_lock_of_an_earlier_process_with_the_number_of_this_one_is_free(tmp_path):
    """As in a sandbox, where QGIS has the same number each time."""
    note = tmp_path / "a.json"
    lock = unfinished._make_lock(note)
    assert lock.tryLock(0)
    assert unfinished._is_held(note)
    os.utime(tmp_path / "a.lock", (unfinished._BEGAN - 60.0,) * 2)
    assert not unfinished._is_held(note)
    lock.unlock()


@pytest.mark.parametrize(
    ("folder", "remote"),
    [
        ("//server/share/mission", True),
        ("s3://bucket/mission", True),
        ("/mnt/nas/missions/mission-2", True),
        ("/mnt/my disk/mission", True),
        ("/mnt/nasty/mission", False),
        ("/home/me/mission", False),
    ],
)
def test_folders_of_other_machines_are_known_without_asking_them(tmp_path, monkeypatch, folder, remote):
    mounts = tmp_path / "mounts"
    mounts.write_text("/dev/sda1 / ext4 rw 0 0\nnas:/all /mnt/nas nfs4 rw 0 0\n//nas/my /mnt/my\\040disk cifs rw 0 0\n")
    monkeypatch.setattr(paths, "_MOUNTS", mounts)
    assert is_remote(folder) == remote
