"""The mission panel on PyQt6, without QGIS: run by ``tests/test_qt6.py`` in a separate process.

The panel's QGIS widgets are mostly Qt widgets with small additions; here Qt's widgets replace them. This does not test
QGIS, but every line of the panel that makes, fills or reads a widget runs as in QGIS 4.
"""

from __future__ import annotations

import sys
import types
from collections.abc import Iterator
from pathlib import Path

from PyQt6 import QtCore, QtGui, QtNetwork, QtSvg, QtTest, QtWidgets, QtXml, sip
from PyQt6.QtCore import QSettings, Qt, pyqtSignal


class _Anything(type(QtCore.QObject)):
    """Type of placeholder classes, which have any attribute."""

    def __getattr__(cls, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        return _Anything(name, (QtCore.QObject,), {})


class _Nothing:
    """Placeholder object: any attribute or call returns it, and it has no items."""

    def __getattr__(self, name: str) -> _Nothing:
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __call__(self, *_: object, **__: object) -> _Nothing:
        return self

    def __iter__(self) -> Iterator[object]:
        return iter(())


class _Module(types.ModuleType):
    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        return _Anything(name, (QtCore.QObject,), {})


class QgsApplication(QtWidgets.QApplication):
    """Icons and folders of the application."""

    @staticmethod
    def getThemeIcon(_name: str) -> QtGui.QIcon:
        return QtGui.QIcon()

    @staticmethod
    def locale() -> str:
        return "en"

    @staticmethod
    def dataItemProviderRegistry() -> _Nothing:
        return _Nothing()


class Qgis:
    """Version and enumerations that the plugin reads."""

    QGIS_VERSION_INT = 40000

    class GeometryType:
        Point, Line, Polygon = range(3)

    class LayerFilter:
        PointLayer, LineLayer, PolygonLayer = range(3)

    class LayerType:
        Vector, Raster = range(2)

    class DataType:
        ARGB32_Premultiplied = 0


class QgsCollapsibleGroupBoxBasic(QtWidgets.QGroupBox):
    """A group that folds."""

    collapsedStateChanged = pyqtSignal(bool)  # noqa: N815

    def setCollapsed(self, collapsed: bool) -> None:
        self._collapsed = collapsed
        self.collapsedStateChanged.emit(collapsed)

    def isCollapsed(self) -> bool:
        return getattr(self, "_collapsed", False)

    def setScrollOnExpand(self, _on: bool) -> None:
        """Nothing scrolls."""


class _Clears:
    def setShowClearButton(self, _shown: bool) -> None:
        """Nothing to show."""

    def setClearValue(self, *_: object) -> None:
        """Nothing to clear to."""

    def setExpressionsEnabled(self, _on: bool) -> None:
        """Numbers alone."""


class QgsDoubleSpinBox(_Clears, QtWidgets.QDoubleSpinBox):
    """A number."""


class QgsSpinBox(_Clears, QtWidgets.QSpinBox):
    """A whole number."""


class QgsDateTimeEdit(QtWidgets.QDateTimeEdit):
    """A day and a time, or none."""

    valueChanged = QtCore.pyqtSignal(QtCore.QDateTime)  # noqa: N815  QGIS's name

    def __init__(self) -> None:
        super().__init__()
        self._is_null = True

    def setAllowNull(self, _on: bool) -> None:
        """It may be empty."""

    def setNullRepresentation(self, _text: str) -> None:
        """Nothing is shown."""

    def isNull(self) -> bool:
        return self._is_null

    def clear(self) -> None:
        self._is_null = True

    def setDateTime(self, time: QtCore.QDateTime) -> None:
        self._is_null = False
        super().setDateTime(time)
        self.valueChanged.emit(time)


class QgsFileWidget(QtWidgets.QWidget):
    """A path."""

    fileChanged = pyqtSignal(str)  # noqa: N815

    class StorageMode:
        GetDirectory, GetFile, SaveFile = range(3)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._edit = QtWidgets.QLineEdit(self)
        self._edit.textChanged.connect(self.fileChanged)

    def lineEdit(self) -> QtWidgets.QLineEdit:
        return self._edit

    def filePath(self) -> str:
        return self._edit.text()

    def setFilePath(self, path: str) -> None:
        self._edit.setText(path)

    def __getattr__(self, name: str) -> object:
        if name.startswith("set"):
            return lambda *_: None
        raise AttributeError(name)


class QgsAuthConfigSelect(QtWidgets.QWidget):
    """The choice of a configuration."""

    selectedConfigIdChanged = pyqtSignal(str)  # noqa: N815

    def configId(self) -> str:
        return ""

    def setConfigId(self, _authcfg: str) -> None:
        """There is none."""


class QgsProject:
    """An empty project."""

    @staticmethod
    def instance() -> _Nothing:
        return _Nothing()


class QgsOwsConnection:
    """No services."""

    @staticmethod
    def connectionList(_kind: str) -> list[str]:
        return []


def stand_in() -> None:
    """Put the modules where the plugin looks for QGIS's."""
    shown = {"QgsDockWidget": QtWidgets.QDockWidget, "QgsSettings": QSettings}
    own = {name: value for name, value in globals().items() if name.startswith("Qgs") or name == "Qgis"}
    qt = types.ModuleType("qgis.PyQt")
    sys.modules.update({"qgis": types.ModuleType("qgis"), "qgis.PyQt": qt, "qgis.PyQt.sip": sip})
    qt.sip = sip
    for module in (QtCore, QtGui, QtNetwork, QtSvg, QtTest, QtWidgets, QtXml):
        name = module.__name__.rpartition(".")[2]
        sys.modules[f"qgis.PyQt.{name}"] = module
        setattr(qt, name, module)
    for name in ("core", "gui", "utils", "analysis"):
        sys.modules[f"qgis.{name}"] = module = _Module(f"qgis.{name}")
        for known, value in {**own, **shown}.items():
            setattr(module, known, value)
    sys.modules["osgeo"] = _Module("osgeo")


def say(text: str) -> None:
    """Print a line for the test."""
    print(text, flush=True)


def main() -> int:
    """Make the panel, enter a mission as a person does, and read it back; returns the exit code."""
    application = QgsApplication(sys.argv[:1])
    stand_in()
    from terrainav.terrainav_plugin.form.state import FormState
    from terrainav.terrainav_plugin.panel.camera import camera_choices
    from terrainav.terrainav_plugin.panel.choices import source_choices
    from terrainav.terrainav_plugin.panel.dock import Dock

    dock = Dock(source_choices(QgsProject.instance())[0], camera_choices()[0])
    dock.show()
    dock.form.set_state(FormState(folder=str(Path(sys.argv[1]))))
    edit = dock.form.edges["north"]
    edit.setFocus()
    QtTest.QTest.keyClicks(edit, "35.16")
    say(dock.form.state().north)
    dock.form.set_state(FormState(west="-89.9", south="35.115", east="-89.823", north="35.16", agl=120.0))
    say(repr(dock.form.state().has_box))
    presses = []
    dock.capture_clicked.connect(lambda: presses.append("capture"))
    QtTest.QTest.mouseClick(dock.capture, Qt.MouseButton.LeftButton)
    say(" ".join(presses))
    application.processEvents()
    picture = dock.grab()
    say("drawn" if picture.save(sys.argv[2]) and picture.width() > 0 else "not drawn")
    return 0


if __name__ == "__main__":
    sys.exit(main())
