"""Run inside a bare QGIS: install the plugin from its zip as a user would, and capture a small mission.

Arguments: the zip, and the folder of the dataset.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pyplugin_installer
import qgis.utils
from qgis.core import QgsApplication, QgsProject
from qgis.PyQt.QtCore import QEventLoop, QTimer

PATIENCE_MS = 120_000
LOOK_MS = 20


def wait(condition):
    loop, look, end = QEventLoop(), QTimer(), QTimer()
    look.timeout.connect(lambda: condition() and loop.quit())
    end.timeout.connect(loop.quit)
    look.start(LOOK_MS)
    end.start(PATIENCE_MS)
    loop.exec()
    look.stop()
    end.stop()
    return condition()


def main(archive, folder):
    if "terrainav" in qgis.utils.available_plugins or "terrainav" in sys.modules:
        return "the profile is not fresh"
    pyplugin_installer.instance().installFromZipFile(archive)
    if "terrainav" not in qgis.utils.plugins:
        return "the plugin was not loaded"
    plugins = Path(QgsApplication.qgisSettingsDirPath()) / "python" / "plugins"
    if not Path(sys.modules["terrainav"].__file__).is_relative_to(plugins / "terrainav"):
        return f"the plugin came from {sys.modules['terrainav'].__file__}"
    session = qgis.utils.plugins["terrainav"].session
    from terrainav.terrainav_plugin.form.state import FormState

    session.show_dock(True)
    session.dock.form.set_state(FormState(north="35.14", west="-89.87", south="35.137", east="-89.866", folder=folder))
    session.capture()
    if not wait(lambda: (Path(folder) / "satellite" / "meta_data.csv").is_file() and session.runs.idle):
        return "no capture: " + "; ".join(item.text() for item in qgis.utils.iface.messageBar().items())
    names = [layer.name() for layer in QgsProject.instance().mapLayers().values()]
    if not any("Captured" in name for name in names):
        return f"the results are not on the map: {names}"
    return 0


sys.exit(main(*sys.argv[1:]))
