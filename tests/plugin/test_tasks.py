"""Work beside the main thread: on threads where pyproj may be called, and of several requests the latest."""

from __future__ import annotations

import threading

import pyproj
import pytest
from qgis.core import (
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsProcessingFeedback,
    QgsProject,
)
from terrainav.core.errors import InvalidInput
from terrainav.terrainav_plugin.processing.algorithm import off_main_thread
from terrainav.terrainav_plugin.tasks import LatestWorker, Task, failure_reason, is_foreign, on_python_thread

from tests.plugin.test_capture import capture

PATIENCE_MS = 60_000
# More than the pool has threads, so that each of them is used again.
TASKS = 40


class Doing(Task):
    """A task that does as it is told."""

    def __init__(self, work):
        super().__init__("doing")
        self.work = work


class Foreign(Task):
    """A task that stays on the thread that QGIS gives it."""

    def __init__(self, work):
        super().__init__("foreign")
        self.do = work

    def run(self):
        self.do()
        return True


def run(qtbot, tasks):
    ended = []
    for task in tasks:
        task.ended.connect(ended.append)
        QgsApplication.taskManager().addTask(task)
    qtbot.waitUntil(lambda: len(ended) == len(tasks), timeout=PATIENCE_MS)


def test_projections_outlive_the_threads_of_tasks(qtbot):
    """One after the other, so that the pool's threads come by again: this ended QGIS 3.44."""
    texts = []

    def work():
        texts.append((pyproj.CRS.from_epsg(32616).to_wkt(), is_foreign()))
        return True

    for _ in range(TASKS):
        run(qtbot, [Doing(work)])
    assert texts == [(texts[0][0], False)] * TASKS


def test_task_keeps_its_error_wherever_it_ran(qtbot):
    def work():
        raise InvalidInput("no such place")

    task = Doing(work)
    run(qtbot, [task])
    assert task.error == "no such place"


def test_threads_of_qgis_are_told_from_those_of_python(qtbot):
    seen = []
    run(qtbot, [Foreign(lambda: seen.append((is_foreign(), on_python_thread(is_foreign))))])
    thread = threading.Thread(target=lambda: seen.append((is_foreign(), on_python_thread(is_foreign))))
    thread.start()
    thread.join()
    assert [is_foreign(), *seen] == [False, (True, False), (False, False)]


def test_algorithms_work_on_threads_of_python(qtbot):
    seen = []

    def algorithm():
        off_main_thread(lambda _watch: seen.append(is_foreign()), QgsProcessingFeedback())
        with pytest.raises(InvalidInput, match="no such place"):
            off_main_thread(lambda _watch: refuse(), QgsProcessingFeedback())

    def refuse():
        raise InvalidInput("no such place")

    run(qtbot, [Foreign(algorithm)])
    assert seen == [False]


@pytest.mark.thorough
def test_layers_of_a_run_are_transformed_after_its_threads_have_ended(desk):
    """Their CRSs were lost with the thread that had opened them: QGIS took metres for degrees, or the reverse."""
    desk.enter_coarse_mission()
    capture(desk)
    # A CRS that nothing else uses: QGIS keeps what it has once worked out for a pair.
    elsewhere = QgsCoordinateReferenceSystem("EPSG:6350")
    for title in ("Captured images", "Satellite images"):
        crs = desk.layer(title).crs()
        assert QgsCoordinateTransform(crs, elsewhere, QgsProject.instance()).isValid(), title


def test_latest_request_wins(qtbot):
    """What is overtaken is told so, is not begun where it still waits, and neither its answer nor its error comes."""
    worker = LatestWorker("test")
    begun, go_on = threading.Event(), threading.Event()
    answers, failures, overtaken_seen, skipped = [], [], [], []
    worker.failed.connect(failures.append)

    def slow(overtaken):
        begun.set()
        go_on.wait(PATIENCE_MS / 1000)
        overtaken_seen.append(overtaken())
        raise ValueError("nobody waits for it")

    worker.ask(slow, answers.append)
    assert begun.wait(PATIENCE_MS / 1000)
    worker.ask(lambda _: skipped.append("begun"), answers.append)
    worker.ask(lambda overtaken: ("last", overtaken()), answers.append)
    assert worker.busy
    go_on.set()
    qtbot.waitUntil(lambda: not worker.busy, timeout=PATIENCE_MS)
    assert (answers, failures, overtaken_seen, skipped) == ([("last", False)], [], [True], [])

    worker.ask(lambda _: "forgotten", answers.append)
    worker.forget()
    worker.ask(lambda _: {}["missing"], answers.append)
    qtbot.waitUntil(lambda: not worker.busy, timeout=PATIENCE_MS)
    assert answers == [("last", False)]
    assert [failure_reason(error) for error in failures] == ["KeyError('missing')"]
    assert failure_reason(InvalidInput("in words")) == "in words"

    worker.close()
    assert worker.closed
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("terrainav-test")]
