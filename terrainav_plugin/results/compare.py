"""Compare two images on the map by switching between them; closing restores the map."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from qgis.core import QgsLayerTreeNode, QgsMapLayer, QgsProject
from qgis.gui import QgisInterface, QgsDockWidget, QgsMapCanvasItem, QgsRubberBand
from qgis.PyQt import sip
from qgis.PyQt.QtCore import QEvent, QObject, QSignalBlocker, Qt, QTimer, pyqtSignal
from qgis.PyQt.QtGui import QKeyEvent
from qgis.PyQt.QtWidgets import QComboBox, QHBoxLayout, QLabel, QVBoxLayout, QWidget

from ..compat import RASTER, VECTOR
from ..i18n import tr
from ..map.mission_group import mission_layers
from ..tasks import single_shot
from ..widgets import ElidedLabel, add_docked, combo, named, push_button, remove_menu_mnemonics, spin


class Compare(QObject):
    """The bar for comparing, and the visibility of layers while it is open."""

    def __init__(self, project: QgsProject, iface: QgisInterface) -> None:
        super().__init__()
        self._project, self._iface, self._canvas = project, iface, iface.mapCanvas()
        self.bar: CompareBar | None = None
        #: Index of the image shown: 0 or 1.
        self.shown = 0
        self._layers: dict[str, bool] = {}
        self._groups: list[tuple[QgsLayerTreeNode, bool]] = []
        self._marks: list[QgsMapCanvasItem] = []
        self._timer = QTimer(self)
        self._timer.timeout.connect(self.switch)
        # Wait: QGIS emits signals about layers before it inserts them into the layer tree.
        self._soon = single_shot(self._offer, self)

    def open(self) -> None:
        """Show the bar, with the first two images."""
        if self.bar is None:
            self._begin()
            remove_menu_mnemonics(self.bar, self._iface.mainWindow().menuBar())
            add_docked(self.bar, self._iface, area=Qt.DockWidgetArea.BottomDockWidgetArea)
        self.bar.setUserVisible(True)
        self.bar.switch.setFocus()

    def close(self) -> None:
        """Restore the map, and remove the bar."""
        if self.bar is None:
            return
        bar, self.bar = self.bar, None
        self._timer.stop()
        self._soon.stop()
        for item in (self._canvas, self._canvas.viewport()):
            item.removeEventFilter(self)
        for signal in (self._project.layersAdded, self._project.layersRemoved):
            signal.disconnect(self._look_soon)
        self._project.cleared.disconnect(self._forget)
        self._restore()
        bar.closed.disconnect(self.close)
        self._iface.removeDockWidget(bar)
        bar.deleteLater()

    def switch(self) -> None:
        """Show the other image."""
        self.shown = 1 - self.shown
        self._show()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Handle the space bar on the map, with which QGIS would pan."""
        kinds = (QEvent.Type.KeyPress, QEvent.Type.KeyRelease, QEvent.Type.ShortcutOverride)
        if (
            isinstance(event, QKeyEvent)
            and event.type() in kinds
            and event.key() == Qt.Key.Key_Space
            and not event.modifiers()
        ):
            if event.type() == QEvent.Type.KeyPress and not event.isAutoRepeat():
                self.switch()
            event.accept()
            return True
        return super().eventFilter(watched, event)

    # --- layers

    def _begin(self) -> None:
        self.bar = bar = CompareBar()
        self.shown = 0
        bar.closed.connect(self.close)
        bar.pair_chosen.connect(self._show)
        bar.flicker.toggled.connect(self._flicker)
        bar.pause.valueChanged.connect(lambda _seconds: self._flicker(bar.flicker.isChecked()))
        bar.switch_wanted.connect(self.switch)
        for item in (self._canvas, self._canvas.viewport()):
            item.installEventFilter(self)
        for signal in (self._project.layersAdded, self._project.layersRemoved):
            signal.connect(self._look_soon)
        self._project.cleared.connect(self._forget)
        self._offer()

    def _look_soon(self, *_: object) -> None:
        self._soon.start()

    def _forget(self) -> None:
        """Forget the visibility to restore, as the project is closed."""
        self._layers.clear()
        self._groups.clear()
        self.close()

    def _offer(self) -> None:
        """Offer the images on the map, and keep the selected ones if they still exist."""
        if self.bar is None:
            return
        there = mission_layers(self._project, RASTER)
        self.bar.offer([(layer.id(), f"{title}: {layer.name()}") for title, layer in there])
        with self._unnoticed():
            # Footprints, too, whose frames and fills would cover the images.
            frames = mission_layers(self._project, VECTOR)
            self._remember([layer for _, layer in (*there, *frames)])
        self._flicker(self.bar.flicker.isChecked())
        self._show()

    def _remember(self, layers: list[QgsMapLayer]) -> None:
        """Remember the visibility of layers and their groups, unless it is remembered already."""
        root = self._project.layerTreeRoot()
        groups = [group for group, _ in self._groups]
        for layer in layers:
            node = root.findLayer(layer.id())
            if layer.id() not in self._layers:
                self._layers[layer.id()] = node.itemVisibilityChecked()
            for group in _groups_around(node):
                if group not in groups:
                    groups.append(group)
                    self._groups.append((group, group.itemVisibilityChecked()))

    # --- display

    def _flicker(self, on: bool) -> None:
        """Switch repeatedly, or stop."""
        self._timer.stop()
        if on and self.bar is not None and self.bar.pair() is not None:
            self._timer.start(round(1000.0 * self.bar.pause.value()))

    def _show(self) -> None:
        """Show one of the two images, and hide the other layers of missions, and outlines on the map."""
        if self.bar is None:
            return
        pair = self.bar.pair()
        self.bar.show_which(self.shown if pair is not None else None)
        root = self._project.layerTreeRoot()
        with self._unnoticed():
            if pair is None:
                self._restore_nodes()
                return
            for layer_id in self._layers:
                node = root.findLayer(layer_id)
                if node is not None:
                    node.setItemVisibilityChecked(layer_id == pair[self.shown])
            for layer_id in pair:
                for group in _groups_around(root.findLayer(layer_id)):
                    group.setItemVisibilityChecked(True)
            # After the layers: while the preview is hidden, the area is outlined.
            self._hide_marks()

    def _hide_marks(self) -> None:
        """Hide what is drawn over the map: rubber bands, and items of this plugin."""
        for item in self._canvas.scene().items():
            ours = type(item).__module__.startswith(__name__.partition(".")[0])
            if item.isVisible() and (ours or isinstance(item, QgsRubberBand)):
                item.hide()
                self._marks.append(item)

    def _restore(self) -> None:
        with self._unnoticed():
            self._restore_nodes()
        self._layers.clear()
        self._groups.clear()

    def _restore_nodes(self) -> None:
        root = self._project.layerTreeRoot()
        for layer_id, seen in self._layers.items():
            node = root.findLayer(layer_id)
            if node is not None:
                node.setItemVisibilityChecked(seen)
        for group, seen in self._groups:
            if not sip.isdeleted(group):
                group.setItemVisibilityChecked(seen)
        for item in self._marks:
            if not sip.isdeleted(item) and item.scene() is not None:
                item.show()
        self._marks.clear()

    @contextmanager
    def _unnoticed(self) -> Iterator[None]:
        """Keep a saved project unmodified, as the visibility of layers will be restored."""
        dirty = self._project.isDirty()
        yield
        if not dirty:
            self._project.setDirty(False)


def _groups_around(node: QgsLayerTreeNode | None) -> Iterator[QgsLayerTreeNode]:
    """Yield the groups that hold a node, without the root of the tree; none for a layer that was removed."""
    group = None if node is None else node.parent()
    while group is not None and group.parent() is not None:
        yield group
        group = group.parent()


class CompareBar(QgsDockWidget):
    """Choose two images, and how to switch between them.

    Signals
    -------
    pair_chosen(), switch_wanted()
    """

    pair_chosen = pyqtSignal()
    switch_wanted = pyqtSignal()

    def __init__(self) -> None:
        super().__init__(tr("Compare images (TerrAInav)"))
        self.setObjectName("terrainav_compare")
        tip = tr("An image layer of a mission or dataset on the map")
        self.boxes: tuple[QComboBox, QComboBox] = (
            combo("compare_first", [], tip),
            combo("compare_second", [], tip),
        )
        for box in self.boxes:
            box.currentIndexChanged.connect(lambda _index: self._chosen())
        self.state = named(ElidedLabel(Qt.TextElideMode.ElideMiddle, 10), "compare_state")
        self.switch = push_button("compare_switch", tr("S&witch"), tr("Show the other image (space bar)"))
        self.switch.clicked.connect(lambda _checked: self.switch_wanted.emit())
        self.flicker = push_button("compare_flicker", tr("&Flicker"), tr("Switch again and again"))
        self.flicker.setCheckable(True)
        self.pause = spin("compare_pause", 0.2, 10.0, 1, tr(" s"), tr("Time that each image is shown"))
        self.pause.setValue(1.0)
        self.closing = push_button("compare_close", tr("&Close"), tr("Show the map as it was before"))
        self.closing.clicked.connect(lambda _checked: self.close())
        self.setWidget(self._contents())

    def offer(self, layers: list[tuple[str, str]]) -> None:
        """Offer layers, pairs (id, title); keep the selected ones if they are still offered."""
        for number, box in enumerate(self.boxes):
            before = box.currentData()
            with QSignalBlocker(box):
                box.clear()
                for layer_id, title in layers:
                    box.addItem(title, layer_id)
                index = box.findData(before) if before is not None else -1
                box.setCurrentIndex(index if index >= 0 else min(number, len(layers) - 1))
        first, second = self.boxes
        if len(layers) > 1 and first.currentIndex() == second.currentIndex():
            with QSignalBlocker(second):
                second.setCurrentIndex(1 if first.currentIndex() == 0 else 0)
        self._enable()

    def pair(self) -> tuple[str, str] | None:
        """Ids of the two layers; None unless two different ones are selected."""
        first, second = (box.currentData() for box in self.boxes)
        return (first, second) if first and second and first != second else None

    def show_which(self, shown: int | None) -> None:
        """Show the name of the image on the map."""
        if shown is None:
            self.state.say(
                tr("Both are the same image.")
                if self.boxes[0].count() > 1
                else tr("There are no two images on the map: open two datasets by “Missions”.")
            )
        else:
            self.state.say(tr("Shown: {image}").format(image=self.boxes[shown].currentText()))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Switch the images by the space bar, unless an entry has taken the key."""
        if event.key() == Qt.Key.Key_Space and not event.isAutoRepeat():
            self.switch_wanted.emit()
        else:
            super().keyPressEvent(event)

    def _chosen(self) -> None:
        self._enable()
        self.pair_chosen.emit()

    def _enable(self) -> None:
        has_pair = self.pair() is not None
        for widget in (self.switch, self.flicker):
            widget.setEnabled(has_pair)

    def _contents(self) -> QWidget:
        images = QHBoxLayout()
        for title, widget in ((tr("F&irst image"), self.boxes[0]), (tr("Seco&nd image"), self.boxes[1])):
            label = QLabel(title)
            label.setBuddy(widget)
            images.addWidget(label)
            images.addWidget(widget, 1)
        every = QLabel(tr("&every"))
        every.setBuddy(self.pause)
        buttons = QHBoxLayout()
        for widget in (self.switch, self.flicker, every, self.pause):
            buttons.addWidget(widget)
        buttons.addWidget(self.state, 1)
        buttons.addWidget(self.closing)
        contents = QWidget()
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(6, 2, 6, 2)
        layout.addLayout(images)
        layout.addLayout(buttons)
        # The map keeps all other room.
        contents.setMaximumHeight(contents.sizeHint().height())
        return contents
