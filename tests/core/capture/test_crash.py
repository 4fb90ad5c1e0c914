"""Captures that are killed: what a resumed one leaves is what one in one go leaves, byte for byte."""

from __future__ import annotations

import json
import os
import random
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from terrainav.core.capture.journal import Journal, Outcome
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import OutputError
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.storage.files import open_locked

from tests.support.caches import check_cache
from tests.support.forks import KILLED, ROOT, Driver
from tests.support.sources import PatternSource
from tests.support.tileserver import TileServer

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system kills no processes by signals")

AREA = Box(35.16, -89.90, 35.1555, -89.895)
# Kills of each of the two ways to run a capture, and runs within which there are so many.
KILLS = pytest.mark.parametrize("most", [8, pytest.param(64, marks=pytest.mark.thorough)])
MOST_RUNS = 400
SEED = 20240229
# No run is left alone for longer, lest a busy machine makes the test long.
LONGEST_S = 0.5
# Captures whose every change to the folder a run is killed before: one has two images, of two map types.
ONE = Points(((35.0, -90.0, 60.0),))
TWO = Points(((35.0, -90.0, 60.0), (-33.0, 151.0, 60.0)))
PLACES = pytest.mark.parametrize(
    ("places", "images", "step"),
    [
        # Before each third change.
        (ONE, 2, 3),
        pytest.param(ONE, 2, 1, marks=pytest.mark.thorough),
        pytest.param(TWO, 4, 1, marks=pytest.mark.thorough),
    ],
    ids=["one, some", "one", "two"],
)
MISSIONS = {
    "tif": Mission(AREA, 120.0, map_types=("satellite", "roadmap"), overlap_along=0.1, zoom=18),
    "jpg": Mission(AREA, 120.0, map_types=("satellite", "roadmap"), overlap_along=0.1, zoom=18, image_format="jpg"),
    "camera png": Mission(
        Box(35.16, -89.90, 35.1575, -89.897),
        120.0,
        tilt_deg=20.0,
        frame="camera",
        image_format="png",
        overlap_along=0.1,
        img_size=(160, 120, 3),
    ),
    "twins": Mission(
        Box(35.16, -89.90, 35.1575, -89.897),
        120.0,
        Camera(k1=-0.2),
        keep_clean=True,
        keep_undistorted=True,
        visibility_km=5.0,
        image_px=96,
        image_format="jpg",
    ),
}


@pytest.fixture(scope="module")
def driver():
    with Driver() as running:
        yield running


def contents(folder: Path, *, noted_once: bool = True) -> dict[str, object]:
    files = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    journal = files["journal.jsonl"].splitlines()
    assert not noted_once or len(journal) == len(set(journal)), "an image was noted twice"
    return {**files, "journal.jsonl": frozenset(journal)}


def check_interrupted(folder: Path, whole: dict[str, object]) -> None:
    """A killed run leaves whole files under their names, all of them right, and notes no picture that is not there."""
    left = {str(path.relative_to(folder)): path for path in folder.rglob("*") if path.is_file()}
    journal = left.pop("journal.jsonl", None)
    lines = set()
    if journal is not None:
        lines = set(journal.read_bytes().split(b"\n")[:-1])
        assert lines <= whole["journal.jsonl"]
    assert sum(name.endswith(".part") for name in left) <= 4
    for name, path in left.items():
        if name.endswith("meta_data.csv"):
            assert set(Table.load(path).status) <= {"done"}
        elif name.endswith("geo.txt"):
            assert set(path.read_bytes().splitlines()) <= set(whole[name].splitlines())
        elif name.endswith("cameras.json"):
            assert set(json.loads(path.read_bytes())) <= set(json.loads(whole[name]))
        elif not name.endswith(".part"):
            assert path.read_bytes() == whole[name], f"{name} is torn"
    for line in lines:
        outcome = Outcome.from_line(line)
        # The whole picture and its twins, with what belongs beside them.
        beside = [name for name in whole if Path(name).name.partition(".")[0] == outcome.name]
        for one in (outcome, *outcome.twins):
            assert all(name in left for name in beside if name.startswith(one.map_type + os.sep))


def killed_until_complete(run, folder, whole, kills, chance, longest_s):
    """Run and kill until a run gets to its end; returns the number of kills."""
    done = 0
    for _ in range(MOST_RUNS):
        # Most are short, so that starting, resuming and the tables get their share.
        after_s = min(longest_s, LONGEST_S) * chance.random() ** 2 if kills > 0 else None
        outcome = run(after_s)
        assert not outcome["orphans"], "a process of the killed run went on"
        if outcome["code"] == KILLED:
            done, kills = done + 1, kills - 1
            check_interrupted(folder, whole)
        else:
            assert outcome["code"] == 0
            assert contents(folder) == whole
            return done
    raise AssertionError(f"not complete after {MOST_RUNS} runs")


@pytest.mark.thorough
@KILLS
def test_killed_at_random_and_resumed_is_as_in_one_go(driver, tmp_path, most):
    kill_missions(driver, tmp_path, list(MISSIONS), most)


def test_killed_captures_with_twins_are_as_in_one_go(driver, tmp_path):
    kill_missions(driver, tmp_path, ["twins"], 3)


def kill_missions(driver, tmp_path, names, most):
    """Capture missions in turn until there were so many kills."""
    chance, kills, turn = random.Random(SEED), 0, 0
    wholes = {}
    while kills < most:
        name = names[turn % len(names)]
        mission = MISSIONS[name].to_json()
        if name not in wholes:
            folder = tmp_path / f"whole {name}"
            outcome = driver.run(mission=mission, folder=str(folder), wait_s=0.002)
            assert (outcome["code"], outcome["failed"]) == (0, 0)
            wholes[name] = contents(folder), outcome["seconds"]
        whole, seconds = wholes[name]
        folder = tmp_path / f"killed {turn}"

        def run(after_s, folder=folder, mission=mission):
            return driver.run(mission=mission, folder=str(folder), wait_s=0.002, kill_after_s=after_s)

        kills += killed_until_complete(run, folder, whole, most - kills, chance, seconds)
        turn += 1
        assert turn < MOST_RUNS


@pytest.mark.thorough
@KILLS
def test_the_command_killed_at_random_and_resumed_is_as_in_one_go(driver, tmp_path, most):
    chance, kills, turn = random.Random(SEED + 1), 0, 0
    with TileServer(latency_s=0.002) as server:

        def run_into(folder, after_s=None):
            argv = ["capture", "--coords=35.16_-89.90_35.1535_-89.8925_120", "--overlap", "0.1"]
            argv += [
                "--source",
                server.map_type_template,
                "--zoom",
                "18",
                "--map-type",
                "satellite",
                "roadmap",
            ]
            argv += ["--data-dir", str(folder), "--resume", "--quiet", "--format", "jpg"]
            argv += ["--cache-dir", f"{folder} cache"]
            return driver.run(argv=argv, output=str(tmp_path / "printed"), kill_after_s=after_s)

        outcome = run_into(tmp_path / "whole")
        assert outcome["code"] == 0, (tmp_path / "printed").read_text()
        whole = contents(tmp_path / "whole")
        while kills < most:
            folder = tmp_path / f"killed {turn}"
            kills += killed_until_complete(
                lambda after_s, folder=folder: run_into(folder, after_s),
                folder,
                whole,
                most - kills,
                chance,
                outcome["seconds"],
            )
            # Killed as often as the pictures' folder was, the cache holds no tile that is not right.
            assert check_cache(Path(f"{folder} cache")) <= check_cache(tmp_path / "whole cache")
            turn += 1
            assert turn < MOST_RUNS
    assert "Traceback" not in (tmp_path / "printed").read_text()


@PLACES
def test_killed_before_each_change_to_the_folder(driver, tmp_path, places, images, step):
    mission = Mission(places, 60.0, map_types=("satellite", "roadmap"), zoom=18, image_format="jpg").to_json()
    options = {"mission": mission, "connections": 1, "workers": 1}
    outcome = driver.run(folder=str(tmp_path / "whole"), **options)
    whole, events = contents(tmp_path / "whole"), outcome["events"]
    # Of each image three files are opened and renamed.
    assert (outcome["code"], outcome["written"]) == (0, images)
    assert events > 6 * images
    for at in range(0, events, step):
        folder = tmp_path / f"killed {at}"
        assert driver.run(folder=str(folder), kill_at_event=at, **options)["code"] == KILLED
        if folder.exists():
            check_interrupted(folder, whole)
        assert driver.run(folder=str(folder), **options)["code"] == 0
        assert contents(folder) == whole


@PLACES
@pytest.mark.parametrize("back", [False, True], ids=["clean", "undo"])
def test_cleaning_killed_before_each_change_can_be_finished_or_taken_back(driver, tmp_path, back, places, images, step):
    def files(folder):
        return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    def ran(folder, arguments, code=0, **options):
        argv = ["clean", str(folder), *arguments]
        outcome = driver.run(argv=argv, folder=str(folder), output=str(tmp_path / "printed"), **options)
        assert outcome["code"] == code, (tmp_path / "printed").read_text()
        return outcome.get("events")

    cleaning, undoing = ["--entropy", "8", "--move"], ["--undo"]
    there, cleaned = tmp_path / "there", tmp_path / "cleaned"
    mission = Mission(places, 60.0, map_types=("satellite", "roadmap"), zoom=18, image_format="jpg")
    capture(plan(mission, PatternSource().grid), PatternSource(), there)
    shutil.copytree(there, cleaned)
    ran(cleaned, cleaning)
    before, after = files(there), files(cleaned)
    assert len(list(cleaned.glob("*/rejected/*"))) == 3 * images
    start, arguments = (cleaned, undoing) if back else (there, cleaning)
    events = ran(shutil.copytree(start, tmp_path / "counted"), arguments)
    # Two tables are opened and renamed, and three files of each image moved.
    assert events >= 4 + 3 * images
    for at in range(0, events, step):
        finished = shutil.copytree(start, tmp_path / f"finished {at}")
        ran(finished, arguments, KILLED, kill_at_event=at)
        # Every picture is in one of its two places, whole, and every table is that of before or after.
        left = {name: data for name, data in files(finished).items() if not name.endswith(".part")}
        assert {name.replace("rejected" + os.sep, "") for name in left} == set(before)
        assert len(left) == len(before)
        for name, data in left.items():
            assert data in (before.get(name), after.get(name))
        taken_back = shutil.copytree(finished, tmp_path / f"taken back {at}")
        for folder, way, wanted in ((finished, cleaning, after), (taken_back, undoing, before)):
            ran(folder, way)
            assert files(folder) == wanted
            assert (folder / "satellite" / "rejected").exists() == (way is cleaning)


def test_a_power_failure_that_tore_pictures_is_found(tmp_path):
    """A disk that had taken a picture's name and line, but not all of its bytes."""
    worked_out = plan(MISSIONS["jpg"], PatternSource().grid)
    capture(worked_out, PatternSource(), tmp_path / "out")
    whole = contents(tmp_path / "out")
    pictures = sorted((tmp_path / "out" / "roadmap").glob("*.jpg"))
    for picture, kept in ((pictures[0], 0), (pictures[1], 4096)):
        with picture.open("r+b") as file:
            file.truncate(kept)
    with pictures[2].with_suffix(".jgw").open("r+b") as file:
        file.truncate(10)
    resumed = capture(worked_out, PatternSource(), tmp_path / "out", resume=True)
    assert (resumed.written, resumed.skipped) == (3, resumed.total - 3)
    # Those that were made again are noted again, in the same words.
    assert contents(tmp_path / "out", noted_once=False) == whole


def test_what_a_killed_run_was_writing_goes_even_where_it_cannot_be_made_again(tmp_path):
    worked_out = plan(MISSIONS["tif"], PatternSource().grid)
    capture(worked_out, PatternSource(), tmp_path, only=[0])
    left = tmp_path / "satellite" / f"{worked_out.names[1]}.tif.part"
    foreign = tmp_path / "satellite" / "notes.part"
    left.write_bytes(b"II*")
    foreign.write_bytes(b"mine")
    capture(worked_out, PatternSource(), tmp_path, only=[0], resume=True)
    assert not left.exists()
    assert foreign.read_bytes() == b"mine"


# --- two captures into one folder


class Waiting(PatternSource):
    """A source that answers once it is told to."""

    def __init__(self):
        super().__init__()
        self.asked, self.go_on = threading.Event(), threading.Event()

    def paint(self, map_type, part):
        self.asked.set()
        assert self.go_on.wait(60.0)
        return super().paint(map_type, part)


def test_a_second_capture_into_the_folder_is_refused(driver, tmp_path):
    mission = MISSIONS["tif"]
    worked_out, first = plan(mission, PatternSource().grid), Waiting()
    results = []
    running = threading.Thread(target=lambda: results.append(capture(worked_out, first, tmp_path / "out")))
    running.start()
    try:
        assert first.asked.wait(60.0)
        refused = (
            f"folder {tmp_path / 'out'}: another run is at work in it; wait until it has ended or choose another folder"
        )
        # In this process and in another.
        with pytest.raises(OutputError) as caught:
            capture(worked_out, PatternSource(), tmp_path / "out", resume=True)
        assert str(caught.value) == refused
        outcome = driver.run(mission=mission.to_json(), folder=str(tmp_path / "out"))
        assert (outcome["code"], outcome["error"]) == (3, refused)
    finally:
        first.go_on.set()
        running.join()
    assert results[0].written == results[0].total
    again = capture(worked_out, PatternSource(), tmp_path / "out", resume=True)
    assert again.skipped == again.total


def test_the_lock_of_a_killed_process_is_free(tmp_path):
    held = "from terrainav.core.storage.files import open_locked; from pathlib import Path; import sys, time;"
    held += "file = open_locked(Path(sys.argv[1])); print('held', flush=True); time.sleep(60)"
    path = tmp_path / "journal.jsonl"
    with subprocess.Popen(
        [sys.executable, "-c", held, str(path)], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as holder:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(OutputError, match="another run is at work in it"):
            open_locked(path)
        holder.kill()
    open_locked(path).close()


def test_a_file_system_without_locks_is_no_reason_to_refuse(tmp_path, monkeypatch):
    import errno
    import fcntl

    def flock(_file, _how):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", flock)
    worked_out = plan(MISSIONS["tif"], PatternSource().grid)
    assert capture(worked_out, PatternSource(), tmp_path, only=[0]).written == 2


def test_what_another_run_has_noted_since_the_journal_was_read_is_known(tmp_path):
    path = tmp_path / "journal.jsonl"
    early = Journal(path)
    with Journal(path) as journal:
        journal.add(Outcome("satellite", "a", 1.0))
    with early:
        early.add(Outcome("satellite", "b", 2.0))
    assert set(early.outcomes) == set(Journal(path).outcomes) == {("satellite", "a"), ("satellite", "b")}
    assert len(path.read_bytes().splitlines()) == 2


def test_of_two_missions_that_begin_in_one_folder_at_once_one_gets_it(tmp_path):
    """Whichever run is first, the folder's mark and its pictures are of the same mission."""
    missions = [MISSIONS["tif"].replace(agl_m=agl_m) for agl_m in (100.0, 110.0, 120.0, 130.0)]
    worked_out = [plan(mission, PatternSource().grid) for mission in missions]
    for turn in range(10):
        folder, start, outcomes = tmp_path / str(turn), threading.Barrier(len(missions)), {}

        def run(number, folder=folder, start=start, outcomes=outcomes):
            start.wait()
            try:
                outcomes[number] = capture(worked_out[number], PatternSource(), folder, only=[0])
            except OutputError as refused:
                outcomes[number] = refused

        threads = [threading.Thread(target=run, args=(number,)) for number in range(len(missions))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        (first,) = [number for number, outcome in outcomes.items() if not isinstance(outcome, OutputError)]
        assert Mission.load(folder / "mission.json") == missions[first]
        assert {path.stem for path in folder.glob("*/*.tif")} == {worked_out[first].names[0]}
        for number, outcome in outcomes.items():
            if number != first:
                assert "holds another mission" in str(outcome) or "another run is at work" in str(outcome)
