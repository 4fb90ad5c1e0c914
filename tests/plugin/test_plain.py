"""Text of servers and files is shown as it is: no file that it names is opened, and none of it becomes rich text."""

from __future__ import annotations

import ctypes
import json
import os
import struct
import sys

import pytest
from qgis.core import (
    Qgis,
    QgsApplication,
    QgsExpression,
    QgsExpressionContext,
    QgsExpressionContextUtils,
    QgsFeature,
    QgsProject,
    QgsVectorLayer,
)
from qgis.gui import QgsMessageLogViewer
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QColor, QImage, QTextDocument
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QLabel, QPlainTextEdit, QTextBrowser, QToolTip, QWidget
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.dataset.placing import _name_pictures
from terrainav.terrainav_plugin.messages import log
from terrainav.terrainav_plugin.panel.options_page import CacheDialog
from terrainav.terrainav_plugin.plain import escaped, escaped_field, plain_label, shown_plain
from terrainav.terrainav_plugin.qgis_source.connections import ServiceConnection
from terrainav.terrainav_plugin.tasks import Task

from tests.plugin.transports import Server
from tests.support.services import wms_document

_IN_OPEN, _IN_NONBLOCK = 0x20, 0o4000


class Watched:
    """A picture that nobody is to open; ``opened`` is how often that was done."""

    def __init__(self, path):
        image = QImage(8, 8, QImage.Format.Format_RGB32)
        image.fill(QColor(200, 0, 0))
        assert image.save(str(path))
        self.mark = f'<img src="file://{path}">'
        self._libc = ctypes.CDLL(None)
        self._events = self._libc.inotify_init1(_IN_NONBLOCK)
        assert self._libc.inotify_add_watch(self._events, os.fsencode(path), _IN_OPEN) > 0

    @property
    def opened(self):
        QApplication.processEvents()
        try:
            return len(os.read(self._events, 4096)) // struct.calcsize("iIII")
        except BlockingIOError:
            return 0

    def close(self):
        os.close(self._events)


@pytest.fixture
def secret(tmp_path):
    if sys.platform != "linux":
        pytest.skip("only Linux tells who opens a file")
    watched = Watched(tmp_path / "secret.png")
    yield watched
    watched.close()


def images_in(document):
    return [one for one in document.allFormats() if one.isImageFormat()]


def rich_texts(root):
    """Texts below a widget that are, or would be, shown as HTML with a picture in it."""
    for widget in [root, *root.findChildren(QWidget)]:
        texts = [widget.toolTip(), widget.statusTip(), widget.whatsThis()]
        if isinstance(widget, QLabel) and widget.textFormat() != Qt.TextFormat.PlainText:
            texts.append(widget.text())
        if isinstance(widget, QTextBrowser) and images_in(widget.document()):
            yield widget.toPlainText()
        for text in texts:
            # QGIS has pictures of its own, which are in the text.
            if "<" in text and "src='data:" not in text:
                document = QTextDocument()
                document.setHtml(text)
                if images_in(document):
                    yield text


def test_the_watch_and_the_look_find_what_they_are_for(secret, qtbot):
    label = QLabel(secret.mark)
    qtbot.addWidget(label)
    label.show()
    label.repaint()
    assert secret.opened
    assert list(rich_texts(label)) == [secret.mark]


def test_helpers(secret, qtbot):
    label = plain_label(f"no {secret.mark}")
    qtbot.addWidget(label)
    label.setToolTip(shown_plain(f"no {secret.mark}\nmore & more"))
    label.show()
    label.repaint()
    QToolTip.showText(label.mapToGlobal(label.rect().center()), label.toolTip(), label)
    QTest.qWait(50)
    assert list(rich_texts(label)) == []
    assert secret.opened == 0
    QToolTip.hideText()
    shown = QTextDocument()
    shown.setHtml(label.toolTip())
    assert shown.toPlainText() == f"no {secret.mark}\nmore & more"
    assert shown_plain("a & b") == "a & b"
    assert escaped("a & <b>") == "a &amp; &lt;b&gt;"


def test_words_of_a_server_that_refuses(desk, secret):
    """Message bar, row of the run, its tooltips, the panel of logs."""
    viewer = QgsMessageLogViewer()
    with Server() as server:
        server.answer = (403, {"Content-Type": "text/plain"}, f"not for you {secret.mark} at all".encode())
        desk.use_template(server.url + "/{z}/{x}/{y}.png")
        desk.enter_small_mission()
        desk.wait_planned()
        desk.click(desk.dock.capture)
        desk.wait(lambda: bool(server.seen))
        desk.wait_for_run()
        desk.wait(lambda: any("not for you" in text for text in desk.messages()))
    window = desk.iface.mainWindow()
    browsers = [item.findChild(QTextBrowser) for item in desk.iface.messageBar().items()]
    assert any(secret.mark in browser.toPlainText() for browser in browsers)
    assert list(rich_texts(window)) == []
    logged = "".join(edit.toPlainText() for edit in viewer.findChildren(QPlainTextEdit))
    assert secret.mark in logged
    assert not any(images_in(edit.document()) for edit in viewer.findChildren(QPlainTextEdit))
    assert secret.opened == 0


# OWSLib, when it is first loaded under Python 3.11.
@pytest.mark.filterwarnings("ignore:'cgi' is deprecated")
def test_names_and_titles_of_a_service_and_its_refusal(desk, secret, qtbot):
    from terrainav.terrainav_plugin.panel.source_dialogs import ServiceDialog

    mark = escaped(secret.mark)
    crs = "<CRS>EPSG:3857</CRS>"
    layer = f"<Layer><Name>a {mark}</Name><Title>{escaped(mark)} b</Title>{crs}</Layer>"
    with Server() as server:
        body = wms_document("1.3.0", f"{server.url}/wms", f"<Layer><Title>All</Title>{crs}{layer}</Layer>")
        server.answers["/wms"] = (200, {"Content-Type": "text/xml"}, body)
        server.answers["/closed"] = (403, {"Content-Type": "text/plain"}, f"no {secret.mark}".encode())
        for path in ("/wms", "/closed"):
            dialog = ServiceDialog(ServiceConnection("Survey", server.url + path), desk.iface.mainWindow())
            dialog.show()
            desk.wait(lambda shown=dialog: not shown.notice.text().startswith("Asking"))
            for row in range(dialog.list.count()):
                dialog.list.setToolTip(dialog.list.item(row).toolTip())
                assert secret.mark in dialog.list.item(row).data(Qt.ItemDataRole.UserRole)
            assert dialog.list.count() == (path == "/wms")
            assert (secret.mark in dialog.notice.text()) == (path == "/closed")
            dialog.repaint()
            assert list(rich_texts(dialog)) == []
            dialog.done(0)
            dialog.deleteLater()
    assert secret.opened == 0


def test_names_of_files_and_folders(desk, secret, tmp_path):
    """Of a raster, of a mission's folder, and of a source that the user has kept."""
    from terrainav.core.imagery.catalogue import add, described

    title = f"Own {secret.mark}"
    add("own", described("https://own.example/{z}/{x}/{y}", title=title, attribution=title))
    desk.session.source_list.refresh()
    desk.choose(desk.form.source, "own")
    chooser = desk.form.source
    tips = [chooser.itemData(row, Qt.ItemDataRole.ToolTipRole) for row in range(chooser.count())]
    assert shown_plain(title) in tips
    desk.form.folder.setFilePath(str(tmp_path / f"<img src=file:{tmp_path}>"))
    desk.enter_small_mission()
    desk.wait_planned()
    desk.session.show_on_map()
    chooser.showPopup()
    QApplication.processEvents()
    chooser.hidePopup()
    assert list(rich_texts(desk.iface.mainWindow())) == []
    assert secret.opened == 0


def test_labels_say_what_they_take(desk, qtbot):
    """A label of ours that finds out by itself what its text is would find what somebody else has put there."""
    dialog = CacheDialog(desk.iface.mainWindow())
    qtbot.addWidget(dialog)
    labels = [label for root in (desk.dock, dialog) for label in root.findChildren(QLabel)]
    ours = [label for label in labels if label.objectName() and not label.objectName().startswith("qt_")]
    assert len(ours) > 10
    assert [one.objectName() for one in ours if one.textFormat() == Qt.TextFormat.AutoText] == []


def test_map_tips_and_tasks(secret):
    layer = QgsVectorLayer("Point?field=reason:string", "failed", "memory")
    feature = QgsFeature(layer.fields())
    context = QgsExpressionContext(QgsExpressionContextUtils.globalProjectLayerScopes(layer))
    for value in (secret.mark, 'a & "b"', "", None):
        feature["reason"] = value
        context.setFeature(feature)
        told = QTextDocument()
        told.setHtml(QgsExpression.replaceExpressionText(escaped_field("reason"), context))
        assert told.toPlainText() == (value or "")
        assert not images_in(told)
    assert "<" not in Task(f"Capturing {secret.mark}").description()


def test_the_log_keeps_what_it_always_showed():
    heard = []
    signal = QgsApplication.messageLog().messageReceived[str, str, Qgis.MessageLevel]
    signal.connect(lambda text, *_: heard.append(text))
    log("Tiles & more: 5 > 4")
    QApplication.processEvents()
    assert heard == ["Tiles & more: 5 > 4"]


@pytest.mark.parametrize(
    "name",
    ["../secret", "..\\secret", "/etc/secret", "a/../../secret", "%2e%2e%2fsecret", "//server/share", "\\\\server\\x",
     "http://h/x", "file:///secret", "C:secret", "x\" onerror=y", "a?b", "a#b", "..", "<img src=x>", "a\nb", "x\u0000"],
)  # fmt: skip
def test_a_map_tip_and_the_action_lead_to_images_of_the_dataset_alone(secret, tmp_path, name):
    folder = tmp_path / "run"
    folder.mkdir()
    lines = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": [1, 2]},
            "properties": {
                "name": one,
                "satellite_file": "/etc/passwd",
                "yaw_deg": 0,
                "tilt_deg": 0,
                "roll_deg": 0,
            },
        }
        for one in (name, "0_0_1_2_17", "[% 1 + 1 %] & é")
    ]
    path = folder / "footprints.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": lines}), encoding="utf-8")
    layer = QgsVectorLayer(str(path), "footprints", "ogr")
    QgsProject.instance().addMapLayer(layer)
    mission = Mission(Box(35.16, -89.90, 35.158, -89.897), 120.0, image_format="png")
    _name_pictures(layer, mission, has_paths=True)
    context = QgsExpressionContext(QgsExpressionContextUtils.globalProjectLayerScopes(layer))
    shown, opened = [], []
    for feature in layer.getFeatures():
        context.setFeature(feature)
        told = QTextDocument()
        told.setHtml(QgsExpression.replaceExpressionText(layer.mapTipTemplate(), context))
        shown += [one.toImageFormat().name() for one in images_in(told)]
        (action,) = layer.actions().actions()
        opened.append(QgsExpression.replaceExpressionText(action.command(), context))
    harmless = {'x" onerror=y': 'x" onerror=y', "x\u0000": "x"}.get(name)
    right = [f"{folder}/satellite/{one}.png" for one in ("0_0_1_2_17", "[% 1 + 1 %] & é")]
    # A sign of addresses in a name has the image not shown, rather than another one.
    # Quotes lead nowhere, and GDAL ends a name at NUL.
    assert opened == [f"{folder}/satellite/{harmless}.png" if harmless else "", right[0], ""]
    assert all(one == "file:///" or one.startswith(f"file:///{folder}/satellite/") for one in shown)
    QgsProject.instance().removeMapLayer(layer.id())
    assert secret.opened == 0
