"""Fixtures of the real application; ``python tools/qgis_app.py --pytest tests/plugin`` runs these tests inside it."""

from __future__ import annotations

import os
import sys
import threading
import traceback
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pytestqt.qtbot import QtBot
    from qgis.core import QgsProject
    from qgis.gui import QgisInterface, QgsMapCanvas
    from qgis.PyQt.QtWidgets import QWidget
    from terrainav.terrainav_plugin.plugin import TerrAInavPlugin

    from tests.plugin.steps import Desk

PLUGIN = "terrainav"
OFF_MAIN = "off_main: runs its body in a thread of its own while the main one works through its events"
ANY_QGIS = "any_qgis: of sources, texts and files alone, or of other programs: tried in one QGIS, not in each"
LOOK_MS = 5
# Where the `screenshot` fixture writes; without it nothing is written.
SCREENSHOT_FOLDER = "TERRAINAV_SCREENSHOTS"


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave these tests out where there is no application for them."""
    return None if "qgis" in sys.modules else True


def pytest_configure(config: pytest.Config) -> None:
    """Make known what tests of this folder are marked with."""
    config.addinivalue_line("markers", OFF_MAIN)
    config.addinivalue_line("markers", ANY_QGIS)


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Run tests that wait, and would keep the main thread, beside it; fixtures are set up in the main one."""
    if pyfuncitem.get_closest_marker(OFF_MAIN.partition(":")[0]) is None:
        return None
    from qgis.PyQt.QtCore import QEventLoop, QTimer

    arguments = {name: pyfuncitem.funcargs[name] for name in pyfuncitem._fixtureinfo.argnames}
    raised: list[BaseException] = []

    def run() -> None:
        try:
            pyfuncitem.obj(**arguments)
        except BaseException as failure:  # noqa: BLE001  (raised again below; a skip as well)
            raised.append(failure)

    thread, loop, timer = threading.Thread(target=run), QEventLoop(), QTimer()
    timer.timeout.connect(lambda: thread.is_alive() or loop.quit())
    thread.start()
    timer.start(LOOK_MS)
    loop.exec()
    timer.stop()
    if raised:
        raise raised[0]
    return True


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say that they were left out."""
    if "qgis" not in sys.modules:
        terminalreporter.line("tests/plugin was left out, it runs inside QGIS: make test-plugin", yellow=True)


@pytest.fixture(autouse=True)
def proj_on_python_threads(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let no test pass that calls pyproj on a thread of QGIS's own, which ends QGIS where pyproj is 3.5 or later."""
    import pyproj
    from terrainav.terrainav_plugin.tasks import is_foreign

    offences: list[str] = []

    def watched(function: Callable[..., object]) -> Callable[..., object]:
        def call(*args: object, **options: object) -> object:
            if is_foreign():
                offences.append("".join(traceback.format_stack(limit=8)))
            return function(*args, **options)

        return call

    calls = ((pyproj.CRS, "__init__"), (pyproj.Proj, "__init__"), (pyproj.Proj, "__call__"))
    for kind, name in (*calls, (pyproj.Transformer, "__init__"), (pyproj.Transformer, "transform")):
        monkeypatch.setattr(kind, name, watched(getattr(kind, name)))
    yield
    assert not offences, f"pyproj was called on a thread that Python has not made:\n{offences[0]}"


@pytest.fixture(scope="session")
def iface() -> QgisInterface:
    """The running application's interface."""
    import qgis.utils

    return qgis.utils.iface


@pytest.fixture
def canvas(iface: QgisInterface) -> QgsMapCanvas:
    """The main map canvas."""
    return iface.mapCanvas()


@pytest.fixture(autouse=True)
def nothing_unfinished() -> None:
    """Forget captures that tests before broke off: the plugin would offer them when it is loaded."""
    from qgis.core import QgsApplication
    from terrainav.terrainav_plugin.paths import UNFINISHED

    for note in Path(QgsApplication.qgisSettingsDirPath(), UNFINISHED).glob("*.json"):
        note.unlink()


@pytest.fixture(scope="session")
def first_project(iface: QgisInterface) -> None:
    """A new project for the first test; each test leaves one to the next."""
    iface.newProject(False)


@pytest.fixture(autouse=True)
def clean_project(iface: QgisInterface, first_project: None) -> Iterator[QgsProject]:
    """A new, empty project, and nothing in the message bar; what the test leaves in either goes away with it.

    So do panels of QGIS's own that it opened, such as Processing's results: they would take the next one's room.
    """
    from qgis.core import QgsProject
    from qgis.PyQt.QtCore import Qt
    from qgis.PyQt.QtWidgets import QDockWidget

    def open_panels() -> set[QDockWidget]:
        panels = iface.mainWindow().findChildren(QDockWidget, options=Qt.FindChildOption.FindDirectChildrenOnly)
        return {panel for panel in panels if panel.isVisible() and not panel.objectName().startswith(PLUGIN)}

    iface.messageBar().clearWidgets()
    before = open_panels()
    yield QgsProject.instance()
    iface.mapCanvas().stopRendering()
    iface.newProject(False)
    iface.messageBar().clearWidgets()
    for panel in open_panels() - before:
        panel.close()


@pytest.fixture
def plugin(iface: QgisInterface) -> TerrAInavPlugin:
    """The plugin as QGIS itself has loaded it."""
    import qgis.utils

    if PLUGIN not in qgis.utils.plugins:
        pytest.fail("QGIS could not load the plugin; its error is at the top of the output")
    return qgis.utils.plugins[PLUGIN]


@pytest.fixture
def wait_until_drawn(canvas: QgsMapCanvas) -> Callable[[], None]:
    """Wait until the canvas shows what the project holds now."""

    def wait() -> None:
        canvas.refreshAllLayers()
        canvas.waitWhileRendering()

    return wait


@pytest.fixture
def screenshot(iface: QgisInterface, qtbot: QtBot) -> Callable[..., None]:
    """Save ``NAME.png``, for a person to look at: the whole screen with its dialogs, or one widget."""
    folder = os.environ.get(SCREENSHOT_FOLDER)

    def save(name: str, widget: QWidget | None = None) -> None:
        if not folder:
            return
        Path(folder).mkdir(parents=True, exist_ok=True)
        path = Path(folder) / f"{name}.png"
        qtbot.wait(100)  # lets what has just changed be painted
        pixmap = widget.grab() if widget else iface.mainWindow().screen().grabWindow(0)
        if not pixmap.save(str(path)):
            pytest.fail(f"the screenshot {path} could not be written")

    return save


@pytest.fixture
def ground(clean_project: QgsProject, canvas: QgsMapCanvas, qtbot: QtBot) -> None:
    """A layer, so that the map is not empty: nobody draws on what shows nothing."""
    from qgis.core import QgsVectorLayer

    layer = QgsVectorLayer("Point?crs=EPSG:4326", "ground", "memory")
    clean_project.addMapLayer(layer)
    # QGIS takes the CRS of a project's first layer a while later.
    qtbot.waitUntil(lambda: layer in canvas.layers())


@pytest.fixture
def desk(
    plugin: TerrAInavPlugin,
    iface: QgisInterface,
    qtbot: QtBot,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[Desk]:
    """The mission panel as it is at first use, in front of an empty project."""
    from terrainav.terrainav_plugin.form.state import FormState

    from tests.plugin.steps import Desk

    # Servers of the tests share their addresses with those of earlier tests.
    monkeypatch.setenv("TERRAINAV_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    desk = Desk(plugin, iface, qtbot, tmp_path / "mission")
    desk.session.settings.backgrounds_folder = str(tmp_path / "backgrounds")
    for name in ("camera", "plan_folder", "plan_ending", "forgotten"):
        setattr(desk.session.settings, name, "")
    desk.session.show_dock(True)
    desk.form.pages.setCurrentIndex(0)
    desk.form.set_state(FormState(folder=str(desk.folder)))
    yield desk
    desk.session.runs.cancel()
    desk.wait_for_tasks()
    desk.wait_for_run()
    for run in list(desk.session.runs.runs):
        desk.session.runs.dismiss(run)
    desk.session.set_preview(False)
    desk.form.set_state(FormState())
