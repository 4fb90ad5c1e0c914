"""What the live view advises."""

from __future__ import annotations

from tests.support.remedies import Case, remedy


@remedy("live/view.py", "Name a folder for the recording.")
def _no_folder(case: Case) -> None:
    desk, live = case.fixture("desk"), case.fixture("live")
    live.dock.folder.setFilePath("")
    desk.click(live.dock.record)
    case.says(live.dock.problem.text())
    live.dock.folder.setFilePath(str(case.tmp_path / "recorded"))
    case.follow("Name a folder for the recording.", lambda: _records(desk, live))


@remedy("live/view.py", "{folder} holds a mission already: name another folder.")
def _taken_folder(case: Case) -> None:
    desk, live = case.fixture("desk"), case.fixture("live")
    (case.tmp_path / "mission.json").write_text("{}")
    live.dock.folder.setFilePath(str(case.tmp_path))
    desk.click(live.dock.record)
    case.says(live.dock.problem.text())
    live.dock.folder.setFilePath(str(case.tmp_path / "another"))
    case.follow("name another folder.", lambda: _records(desk, live))


@remedy("live/view.py", "There is no flight to follow: enter a mission in the panel first.")
def _no_flight(case: Case) -> None:
    desk, live = case.fixture("desk"), case.fixture("live")
    desk.enter_box("", "", "", "")
    desk.wait(lambda: desk.session.planned is None)
    desk.click(live.dock.follow)
    case.says(live.dock.problem.text())
    desk.enter_small_mission()
    # What is said then is which time the flight has.
    desk.wait(lambda: "temporal controller" in live.dock.problem.text())
    case.follow("enter a mission in the panel first.", lambda: live.follows)


def _records(desk, live) -> bool:
    """Whether a press on *Record* begins a recording, which is then dropped."""
    desk.click(live.dock.record)
    begun = live.recording is not None
    live._drop_recording()
    return begun
