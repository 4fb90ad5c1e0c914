"""The main job, in the real QGIS: a box, its preview, its capture from the embedded world, the result on the map.

``make demo`` runs it. It leaves ``demo/`` with the dataset, a project that a person can open anywhere, and pictures of
what was on the screen, and it prints figures.
"""

from __future__ import annotations

import json
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path

from qgis.core import Qgis, QgsApplication, QgsProject
from qgis.PyQt.QtCore import QEventLoop, Qt, QTimer
from qgis.PyQt.QtTest import QTest
from qgis.utils import iface, plugins
from terrainav.terrainav_plugin.dock.mission_form import FormState
from terrainav.terrainav_plugin.workflow import Workflow

DEMO = Path(__file__).resolve().parent.parent / "demo"
DATASET, BACKGROUNDS, PROJECT = DEMO / "dataset", DEMO / "background", DEMO / "terrainav-demo.qgz"
PICTURES = ("preview.png", "screenshot.png", "detail.png")
# Written first of all, so that only what a demo made is ever cleared away.
MARK = DEMO / ".made-by-terrainav-demo"

AGRICENTER = "35.16_-89.90_35.115_-89.823_120"
# The capture itself may take minutes on a slow machine; nothing else comes near.
PATIENCE_S = 900
POLL_MS = 20


class DemoError(Exception):
    """Something did not come out as it should."""


def wait(what: str, condition: Callable[[], bool]) -> None:
    """Let the application run until ``condition`` holds."""
    loop, timer, started = QEventLoop(), QTimer(), time.monotonic()
    timer.timeout.connect(
        lambda: loop.quit() if condition() or time.monotonic() - started > PATIENCE_S else None
    )
    timer.start(POLL_MS)
    loop.exec()
    timer.stop()
    if not condition():
        raise DemoError(f"{what}: nothing after {PATIENCE_S} s")


def wait_until_drawn() -> None:
    """Let the map be drawn to its end, and its widgets be painted."""
    canvas = iface.mapCanvas()
    drawn: list[bool] = []
    canvas.mapCanvasRefreshed.connect(lambda: drawn.append(True))
    canvas.refreshAllLayers()
    wait("drawing the map", lambda: bool(drawn) and not canvas.isDrawing())
    canvas.mapCanvasRefreshed.disconnect()
    QTest.qWait(10 * POLL_MS)


def clear_earlier_demo() -> None:
    """Start afresh: what an earlier demo made goes, anything else stays and stops this one."""
    if DEMO.exists() and any(DEMO.iterdir()) and not MARK.is_file():
        raise DemoError(f"folder {DEMO}: holds something that no demo made; move it away")
    DEMO.mkdir(exist_ok=True)
    MARK.touch()
    for folder in (DATASET, BACKGROUNDS):
        shutil.rmtree(folder, ignore_errors=True)
    for file in (PROJECT, *(DEMO / name for name in PICTURES)):
        file.unlink(missing_ok=True)


def take_picture(name: str) -> None:
    """Save the whole window as it is on the screen."""
    bar = iface.messageBar()
    for item in bar.items():
        # QGIS's own word about every task, where the desktop has no notifications.
        if item.title() != "TerrAInav":
            bar.popWidget(item)
    wait_until_drawn()
    window = iface.mainWindow()
    if not window.grab().save(str(DEMO / name)):
        raise DemoError(f"picture {DEMO / name}: cannot be written")


def enter_mission(workflow: Workflow) -> None:
    """Paste the published mission's coordinates into the panel."""
    form = workflow.dock.form
    form.set_state(FormState(folder=str(DATASET)))
    form.edges["north"].setText(AGRICENTER)
    state = workflow.state()
    if (state.west, state.south, state.agl, state.fov_deg, state.aspect) != (
        "-89.9",
        "35.115",
        120.0,
        78.8,
        "4:3",
    ):
        raise DemoError(f"pasted coordinates came out as {state}")


def show_background(workflow: Workflow) -> None:
    """Put the source below the mission, and its place on the screen."""
    QTest.mouseClick(workflow.dock.form.show_on_map, Qt.MouseButton.LeftButton)
    wait("drawing the background", lambda: "Synthetic (offline)" in layer_names())


def preview(workflow: Workflow) -> None:
    """Show every image before anything is fetched."""
    QTest.mouseClick(workflow.dock.preview, Qt.MouseButton.LeftButton)
    wait("preview", lambda: workflow.preview.shown and not workflow.preview.busy)
    planned = workflow.planned
    drawn = workflow.preview.layer("footprints").featureCount()
    if drawn != planned.summary.images or not planned.summary.complete:
        raise DemoError(
            f"{drawn} footprints for {planned.summary.images} images, coverage {planned.summary.covered_share}"
        )


def capture(workflow: Workflow) -> dict[str, float]:
    """Press Capture and wait for the result on the map; returns its figures."""
    QTest.mouseClick(workflow.dock.capture, Qt.MouseButton.LeftButton)
    wait("start of the capture", lambda: workflow.runs.task is not None)
    task, started = workflow.runs.task, time.monotonic()
    wait("capture", lambda: workflow.runs.task is None)
    if task.error or task.result is None or task.result.failed or not task.mosaics:
        raise DemoError(f"capture: {task.error or task.result}")
    result = task.result
    return {
        "images": result.written,
        "capture_s": round(result.seconds, 1),
        "images_per_s": round(result.written / result.seconds, 1),
        "requests": result.requests,
        "requests_per_unique_tile": round(result.requests / result.unique_parts, 4),
        "mosaic_s": round(time.monotonic() - started - result.seconds, 1),
    }


def save_project() -> None:
    """Save the project with paths relative to it."""
    project = QgsProject.instance()
    project.setTitle("TerrAInav: Memphis Agricenter from the synthetic world")
    if not project.write(str(PROJECT)):
        raise DemoError(f"project {PROJECT}: cannot be written ({project.error()})")


def check_project_elsewhere() -> None:
    """Open a copy of the folder in another place: every layer must be found there."""
    copy = DEMO.with_name(f"{DEMO.name}-moved")
    DEMO.rename(copy)
    try:
        project = QgsProject()
        if not project.read(str(copy / PROJECT.name)):
            raise DemoError(f"project {copy / PROJECT.name}: cannot be read")
        broken = [layer.name() for layer in project.mapLayers().values() if not layer.isValid()]
        outside = [
            layer.name()
            for layer in project.mapLayers().values()
            if layer.providerType() != "memory" and not layer.source().startswith(str(copy))
        ]
        if broken or outside:
            raise DemoError(f"project opened elsewhere: broken {broken}, outside its folder {outside}")
    finally:
        copy.rename(DEMO)


def layer_names() -> list[str]:
    """Names of the project's layers."""
    return [layer.name() for layer in QgsProject.instance().mapLayers().values()]


def look_closely() -> None:
    """Zoom to where single images can be told apart."""
    canvas = iface.mapCanvas()
    canvas.zoomScale(3500)


def main() -> int:
    """Do the job; returns the exit code."""
    started = time.monotonic()
    clear_earlier_demo()
    workflow = plugins["terrainav"].workflow
    workflow.settings.backgrounds_folder = str(BACKGROUNDS)
    workflow.show_dock(True)
    enter_mission(workflow)
    show_background(workflow)
    preview(workflow)
    take_picture("preview.png")
    figures = capture(workflow)
    take_picture("screenshot.png")
    save_project()
    look_closely()
    take_picture("detail.png")
    wait("end of all tasks", lambda: QgsApplication.taskManager().countActiveTasks() == 0)
    check_project_elsewhere()
    # QGIS 3.22 may crash where it has to close a project while it ends.
    iface.newProject(False)
    figures["whole_demo_s"] = round(time.monotonic() - started, 1)
    print(json.dumps({"qgis": Qgis.QGIS_VERSION, **figures}, indent=1))
    print(f"In {DEMO}: dataset/, {PROJECT.name}, {', '.join(PICTURES)}")
    return 0


try:
    sys.exit(main())
except DemoError as error:
    sys.exit(f"demo: {error}")
