"""The plugin's main task in the real QGIS: a box, its preview, its capture from the embedded world, the result.

``make demo`` runs it. It writes the dataset, a project that can be opened anywhere, and screenshots to ``demo/``, and
prints figures.
"""

from __future__ import annotations

import json
import shutil
import sys
import time
from pathlib import Path

from qgis.core import Qgis, QgsApplication, QgsProject
from qgis.utils import iface, plugins
from stage import StageError, click, layer_names, tidy_messages, wait, wait_until_drawn, window_picture
from terrainav.terrainav_plugin.form.mission_form import FormState
from terrainav.terrainav_plugin.session import Session

DEMO = Path(__file__).resolve().parent.parent / "demo"
DATASET, BACKGROUNDS, PROJECT = DEMO / "dataset", DEMO / "background", DEMO / "terrainav-demo.qgz"
PICTURES = ("preview.png", "screenshot.png", "detail.png")
# Written first, so that only a folder made by a demo is ever cleared.
MARK = DEMO / ".made-by-terrainav-demo"

AGRICENTER = "35.16_-89.90_35.115_-89.823_120"


def clear_earlier_demo() -> None:
    """Delete the files of an earlier demo; raise if the folder was not made by one."""
    if DEMO.exists() and any(DEMO.iterdir()) and not MARK.is_file():
        raise StageError(f"folder {DEMO}: holds something that no demo made; move it away")
    DEMO.mkdir(exist_ok=True)
    MARK.touch()
    for folder in (DATASET, BACKGROUNDS):
        shutil.rmtree(folder, ignore_errors=True)
    for file in (PROJECT, *(DEMO / name for name in PICTURES)):
        file.unlink(missing_ok=True)


def take_picture(name: str) -> None:
    """Save a picture of the whole window."""
    tidy_messages()
    wait_until_drawn()
    if not window_picture().save(str(DEMO / name)):
        raise StageError(f"image {DEMO / name}: cannot be written")


def enter_mission(session: Session) -> None:
    """Paste the published mission's coordinates into the panel."""
    form = session.dock.form
    form.set_state(FormState(folder=str(DATASET)))
    form.edges["north"].setText(AGRICENTER)
    state = session.state()
    if (state.west, state.south, state.agl, state.fov_deg, state.aspect) != (
        "-89.9",
        "35.115",
        120.0,
        78.8,
        "4:3",
    ):
        raise StageError(f"pasted coordinates came out as {state}")


def show_background(session: Session) -> None:
    """Show the imagery of the source below the mission, and zoom the map to the mission."""
    form = session.dock.form
    form.pages.show_field(form.show_on_map)
    click(form.show_on_map)
    form.pages.setCurrentIndex(0)
    wait("drawing the background", lambda: "Synthetic (offline)" in layer_names())
    # The preview draws the part that the map shows at that time.
    wait_until_drawn()


def preview(session: Session) -> None:
    """Show every image before anything is fetched."""
    click(session.dock.preview)
    wait("preview", lambda: session.preview.shown and not session.preview.busy)
    planned = session.planned
    # Single images or, from afar, the number of images per place.
    drawn = {role: session.preview.layer(role).featureCount() for role in ("footprints", "density")}
    if not any(drawn.values()) or not planned.summary.complete:
        raise StageError(f"preview of {drawn}, coverage {planned.summary.covered_share}")


def capture(session: Session) -> dict[str, float]:
    """Press Capture and wait for the result on the map; returns its figures."""
    click(session.dock.capture)
    wait("start of the capture", lambda: session.runs.task is not None)
    task, started = session.runs.task, time.monotonic()
    wait("capture", lambda: session.runs.task is None)
    if task.error or task.result is None or task.result.failed or not task.mosaics:
        raise StageError(f"capture: {task.error or task.result}")
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
        raise StageError(f"project {PROJECT}: cannot be written ({project.error()})")


def check_project_elsewhere() -> None:
    """Move the folder and open its project: every layer must be found there."""
    copy = DEMO.with_name(f"{DEMO.name}-moved")
    DEMO.rename(copy)
    try:
        project = QgsProject()
        if not project.read(str(copy / PROJECT.name)):
            raise StageError(f"project {copy / PROJECT.name}: cannot be read")
        broken = [layer.name() for layer in project.mapLayers().values() if not layer.isValid()]
        outside = [
            layer.name()
            for layer in project.mapLayers().values()
            if layer.providerType() != "memory" and not layer.source().startswith(str(copy))
        ]
        if broken or outside:
            raise StageError(f"project opened elsewhere: broken {broken}, outside its folder {outside}")
    finally:
        copy.rename(DEMO)


def look_closely() -> None:
    """Zoom in until single images can be distinguished."""
    canvas = iface.mapCanvas()
    canvas.zoomScale(3500)


def main() -> int:
    """Run the demo; returns the exit code."""
    started = time.monotonic()
    clear_earlier_demo()
    # QGIS draws the surroundings of the map in advance for dragging, which nobody does here, and prints a message
    # whenever the next step interrupts that.
    iface.mapCanvas().setPreviewJobsEnabled(False)
    session = plugins["terrainav"].session
    session.settings.backgrounds_folder = str(BACKGROUNDS)
    session.show_dock(True)
    enter_mission(session)
    show_background(session)
    preview(session)
    take_picture("preview.png")
    figures = capture(session)
    take_picture("screenshot.png")
    save_project()
    look_closely()
    take_picture("detail.png")
    wait("end of all tasks", lambda: QgsApplication.taskManager().countActiveTasks() == 0)
    # Close the project before its folder, from which the map is drawn, is moved; and before QGIS ends, as QGIS 3.22 may
    # crash if it has to close a project then.
    iface.newProject(False)
    check_project_elsewhere()
    figures["whole_demo_s"] = round(time.monotonic() - started, 1)
    print(json.dumps({"qgis": Qgis.QGIS_VERSION, **figures}, indent=1))
    print(f"In {DEMO}: dataset/, {PROJECT.name}, {', '.join(PICTURES)}")
    return 0


try:
    sys.exit(main())
except StageError as error:
    sys.exit(f"demo: {error}")
