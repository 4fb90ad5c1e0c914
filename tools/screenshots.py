"""Take the pictures of the guide: the plugin in the real QGIS, used as by a person, over the embedded world.

``make screenshots`` runs it and writes ``docs/images/guide-*``. Given names of scenes, it plays only these.

Examples
--------
::

    python tools/qgis_app.py --timeout 1200 tools/screenshots.py
    python tools/qgis_app.py tools/screenshots.py mapping options
"""

from __future__ import annotations

import io
import re
import shutil
import sqlite3
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import processing
from osgeo import gdal, ogr, osr
from PIL import Image
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsGeometry,
    QgsLineSymbol,
    QgsPointXY,
    QgsProject,
    QgsRasterLayer,
    QgsRectangle,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QBuffer, QPoint, QRect, Qt, QTimer
from qgis.PyQt.QtGui import QPixmap
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import (
    QApplication,
    QComboBox,
    QDialogButtonBox,
    QDockWidget,
    QMenu,
    QProgressBar,
    QToolButton,
    QWidget,
)
from qgis.utils import iface, plugins
from stage import (
    StageError,
    at,
    choose,
    click,
    click_map,
    enter,
    layer_names,
    press_key,
    press_map,
    release_map,
    right_click_map,
    screen_picture,
    tidy_messages,
    wait,
    wait_until_drawn,
)
from terrainav.core.geodesy.local import geodetic
from terrainav.core.geodesy.triangles import ROOF
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.source import Window
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import Imagery
from terrainav.core.mission.relief.roofed import seen_surface
from terrainav.core.picture.heights import mission_heights
from terrainav.core.world.houses import WorldHouses
from terrainav.core.world.lattice import chart_seed
from terrainav.terrainav_plugin.form.mission_form import FormState
from terrainav.terrainav_plugin.panel.options_page import OptionsPage
from terrainav.terrainav_plugin.panel.source_dialogs import AddSourceDialog
from terrainav.terrainav_plugin.results.viewing import Viewing

IMAGES = Path(__file__).resolve().parent.parent / "docs" / "images"
#: Folder of the missions; the pictures show its name.
FOLDER = Path(tempfile.gettempdir()) / "TerrAInav"
# Written first, so that only a folder made by this script is ever cleared.
MARK = FOLDER / ".made-for-the-guide"

WINDOW_PX = (1400, 900)
PANEL_PX, LAYERS_PX = 420, 240
#: Largest size of a picture of the window; pictures are part of the plugin's zip.
MOST_BYTES = 80_000
#: Largest size of most pictures of a part of the window; all pictures together must stay below the guide's limit.
FEWER_BYTES = 78_000
#: Largest size of the smallest picture.
FEWEST_BYTES = 25_000
WIDEST_PX = 1200
QUALITIES = range(85, 20, -5)

FIRST = "35.143_-89.889_35.130_-89.867"
AGRICENTER = "35.16_-89.90_35.115_-89.823"
MIDLANDS = "52.412_-0.128_52.392_-0.090"
#: Edges of an orthophoto in the Midlands, metres of the British National Grid.
ORTHOPHOTO_M = (527_800.0, 279_200.0, 529_800.0, 280_600.0)
#: A mosaic about the South Pole: whole tiles of the embedded world.
POLAR_CRS, POLAR_ZOOM, POLAR_PX = "EPSG:3031", 17, 2048
#: A few images of a town, and its middle.
TOWN, TOWN_PLACE = "35.1414_-89.8615_35.1402_-89.8597", (35.1408, -89.8606)
LARGE = "35.35_-90.10_35.05_-89.70"
#: Fields and a wood, to be mapped.
FIELDS = "35.1400_-89.8810_35.1318_-89.8700"
#: Corners drawn there, as shares of the map's width and height.
FIELD_CORNERS = ((0.14, 0.22), (0.52, 0.12), (0.88, 0.24), (0.84, 0.74), (0.47, 0.86), (0.2, 0.72))
HOLE_CORNERS = ((0.3, 0.58), (0.42, 0.6), (0.4, 0.72), (0.3, 0.68))
NO_FLY_CORNERS = ((0.56, 0.4), (0.7, 0.38), (0.7, 0.56), (0.57, 0.58))
TAKEOFF_AT = (0.12, 0.83)
SLANTED_CORNERS = ((0.12, 0.62), (0.72, 0.14), (0.88, 0.34), (0.28, 0.84))
#: A line over fields, to be flown.
TRAJECTORY = "LineString (-89.8870 35.1322, -89.8830 35.1330, -89.8800 35.1368, -89.8740 35.1385, -89.8700 35.1362)"
#: Number of images after which the capture is paused for its picture.
HELD_AFTER = 500


class Stage:
    """The plugin, its panel and the map."""

    def __init__(self) -> None:
        self.plugin = plugins["terrainav"]
        self.session = self.plugin.session
        self.dock, self.form = self.session.dock, self.session.dock.form
        self.canvas, self.window = iface.mapCanvas(), iface.mainWindow()
        self.session.settings.missions_folder = str(FOLDER)
        self.session.settings.cache_folder = str(FOLDER / "cache")
        self.session.settings.backgrounds_folder = str(FOLDER / "backgrounds")

    # --- scenery

    def clear(self, name: str = "agricenter") -> None:
        """Go back to an empty project and a panel without entries, with a folder for a mission of a name."""
        for run in list(self.session.runs.runs):
            run.cancel()
        wait("end of the runs", lambda: self.session.runs.idle)
        for run in list(self.session.runs.runs):
            self.session.runs.dismiss(run)
        self.session.set_preview(False)
        iface.newProject(False)
        iface.messageBar().clearWidgets()
        shutil.rmtree(FOLDER / name, ignore_errors=True)
        self.form.set_state(FormState(folder=str(FOLDER / name)))
        self.session.show_dock(True)
        self.settle()

    def settle(self) -> None:
        """Restore the sizes of the window and its panels, which other widgets have changed."""
        self.window.resize(*WINDOW_PX)
        docks = {self.dock: PANEL_PX, self.panel("Layers"): LAYERS_PX}
        self.window.resizeDocks(list(docks), list(docks.values()), Qt.Orientation.Horizontal)
        QTest.qWait(100)

    def panel(self, name: str) -> QDockWidget:
        """Panel of QGIS."""
        return self.window.findChild(QDockWidget, name)

    def begin(self, coordinates: str, name: str = "agricenter", **entries: object) -> None:
        """Begin a mission: set entries, paste coordinates, and show the place on the map."""
        self.clear(name)
        self.form.set_state(replace(self.session.state(), **entries))
        self.paste(coordinates)
        self.show_background()

    def paste(self, coordinates: str) -> None:
        """Paste coordinates into the northern edge."""
        edge = self.form.edges["north"]
        edge.setFocus()
        edge.selectAll()
        QApplication.clipboard().setText(coordinates)
        edge.paste()
        self.plan()

    def show_background(self) -> None:
        """Press "Show on map" once earlier drawing has ended."""
        wait("Show on map", self.form.show_on_map.isEnabled)
        self.form.pages.show_field(self.form.show_on_map)
        click(self.form.show_on_map)
        self.form.pages.setCurrentIndex(0)
        wait("drawing the background", lambda: "Synthetic (offline)" in layer_names())
        wait_until_drawn()

    def background_file(self) -> str:
        """File of the background, once it is complete."""
        wait("the whole background", self.form.show_on_map.isEnabled)
        layers = QgsProject.instance().mapLayers().values()
        return next(layer.source() for layer in layers if layer.providerType() == "gdal")

    def plan(self) -> None:
        """Wait for the figures of the mission and for the timing of its cost."""
        busy = (self.session.planner, self.session.preview)
        wait("figures", lambda: not any(part.busy for part in busy))
        wait(
            "the methods' cost",
            lambda: "being timed" not in self.dock.figures.details.text() or not self.session.runs.idle,
        )

    def preview(self) -> None:
        """Press "Preview"."""
        click(self.dock.preview)
        self.wait_previewed()

    def wait_previewed(self) -> None:
        """Wait until the preview is complete."""
        preview = self.session.preview
        wait("preview", lambda: preview.shown and not preview.busy)
        self.plan()

    def capture(self) -> None:
        """Press "Capture" and wait for the end."""
        click(self.dock.capture)
        wait("start of the capture", lambda: not self.session.runs.idle)
        wait("capture", lambda: self.session.runs.idle)

    def survey(self, name: str) -> None:
        """Choose a folder, the preset for mapping, and a camera by name."""
        self.form.folder.setFilePath(str(FOLDER / name))
        choose(self.form.presets.choice, "mapping")
        cameras = self.form.camera
        cameras.setCurrentIndex(cameras.findText("DJI Mavic 3E"))
        cameras.activated.emit(cameras.currentIndex())

    def draw(self, corners: Sequence[tuple[float, float]]) -> None:
        """Click the corners of a polygon, and finish it by Enter."""
        for corner in corners:
            click_map(at(*corner))
        press_key(Qt.Key.Key_Return)
        self.plan()

    def show_role(self, role: str, shown: bool) -> None:
        """Tick or untick a layer of the preview."""
        layer = self.session.preview.layer(role)
        QgsProject.instance().layerTreeRoot().findLayer(layer).setItemVisibilityChecked(shown)

    def scroll_to(self, widget: QWidget) -> None:
        """Scroll the panel to an entry."""
        if widget is self.dock.hint:
            self.form.pages.currentWidget().verticalScrollBar().setValue(0)
            return
        area = self.form.pages.page_of(widget)
        self.form.pages.setCurrentWidget(area)
        QTest.qWait(50)
        area.verticalScrollBar().setValue(widget.mapTo(area.widget(), QPoint(0, 0)).y() - 4)

    def zoom(self, scale: float) -> None:
        """Zoom the map to a scale, and let the preview follow."""
        self.canvas.zoomScale(scale)
        QTest.qWait(200)
        if self.session.preview.shown:
            self.wait_previewed()

    def show_previewed(self, west_px: int) -> QPoint:
        """Show the whole preview to the right of ``west_px`` pixels of the map; returns the pixel of its middle."""
        layer = self.session.preview.layer("footprints")
        extent = self.canvas.mapSettings().layerExtentToOutputExtent(layer, layer.extent())
        wide, high = self.canvas.width(), self.canvas.height()
        per_px = 1.04 * max(extent.width() / (wide - west_px), extent.height() / high)
        middle = extent.center()
        west, south = middle.x() - (wide + west_px) / 2.0 * per_px, middle.y() - high / 2.0 * per_px
        self.canvas.setExtent(QgsRectangle(west, south, west + wide * per_px, south + high * per_px))
        self.canvas.refresh()
        self.wait_previewed()
        return QPoint((wide + west_px) // 2, high // 2)

    def unfold(self, role: str) -> None:
        """Show the legend of a layer of the preview."""
        layer = self.session.preview.layer(role)
        QgsProject.instance().layerTreeRoot().findLayer(layer).setExpanded(True)

    # --- pictures

    def shoot(
        self,
        name: str,
        part: QRect | None = None,
        top: QWidget | None = None,
        most_bytes: int = MOST_BYTES,
    ) -> None:
        """Write a picture of the window, or of a part of it, with the panel scrolled to its beginning or to ``top``."""
        iface.statusBarIface().clearMessage()
        # The cursor blinks, and a field in focus is marked.
        if self.window.focusWidget() is not None:
            self.window.focusWidget().clearFocus()
        self.scroll_to(top or self.dock.hint)
        wait_until_drawn()
        tidy_messages()
        for bar in self.window.statusBar().findChildren(QProgressBar):
            # QGIS hides the progress bar of drawing only after a while.
            bar.setVisible(bar.isVisible() and bar.maximum() > 0)
        QTest.qWait(100)
        picture = screen_picture(self.window.geometry())
        write(name, picture if part is None else picture.copy(part), most_bytes)

    def view_image(self, place: QPoint | None = None) -> Viewing:
        """Show the image that the map shows at a place, or at an edge of the previewed ones."""
        iface.messageBar().clearWidgets()
        self.plugin.actions["view_images"].trigger()
        viewing = self.session.viewing
        wait("image", lambda: viewing.seen is not None and not viewing.busy)
        self.settle()
        click_map(self.show_previewed(0) if place is None else place)
        wait("image", lambda: not viewing.busy)
        return viewing

    def part(self, *widgets: QWidget) -> QRect:
        """Part of the window that holds widgets."""
        whole = QRect()
        for widget in widgets:
            whole = whole.united(QRect(widget.mapTo(self.window, QPoint(0, 0)), widget.size()))
        return whole


def write(name: str, picture: QPixmap, most_bytes: int = MOST_BYTES) -> None:
    """Write a picture of limited size: parts of the panel as PNG, maps as JPEG."""
    buffer = QBuffer()
    buffer.open(QBuffer.OpenModeFlag.ReadWrite)
    picture.save(buffer, "PNG")
    image = Image.open(io.BytesIO(bytes(buffer.data()))).convert("RGB")
    path = IMAGES / f"guide-{name}"
    if image.width > WIDEST_PX:
        image = image.resize((WIDEST_PX, image.height * WIDEST_PX // image.width), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    if path.suffix == ".png":
        image.quantize(256).save(out, "PNG", optimize=True)
    for quality in QUALITIES if path.suffix == ".jpg" else ():
        out = io.BytesIO()
        image.save(out, "JPEG", quality=quality, optimize=True, progressive=True)
        if out.tell() <= most_bytes:
            break
    if out.tell() > most_bytes:
        raise StageError(f"image {path}: {out.tell():,} bytes; must be {most_bytes:,} at most")
    path.write_bytes(out.getvalue())
    print(f"{path.name}: {image.width} x {image.height}, {out.tell() / 1000:.0f} kB", flush=True)


# --- scenes: the first mission


def first_mission(stage: Stage) -> None:
    """The steps of the guide's first part."""
    stage.clear("mission-1")
    stage.shoot("panel.jpg")
    (link,) = re.findall('href="([^"]*)"', stage.dock.hint.text())
    stage.dock.hint_followed.emit(link)
    wait("background", lambda: "Synthetic (offline)" in layer_names())
    wait_until_drawn()
    start, end = at(0.34, 0.4), at(0.62, 0.62)
    press_map(start, end)
    stage.shoot("box.jpg")
    release_map(end)
    stage.plan()
    stage.capture()
    stage.session.zoom_to_box(stage.session.planned.mission.area.bounds)
    stage.shoot("results.jpg")
    stage.plugin.actions["view_images"].trigger()
    viewing = stage.session.viewing
    wait("image", lambda: viewing.seen is not None and not viewing.busy)
    click_map(at(0.55, 0.45))
    wait("image", lambda: not viewing.busy)
    stage.shoot("viewer.jpg")
    viewing.stop()
    viewing.viewer.hide()


def camera(stage: Stage) -> None:
    """The panel from its beginning, with the presets; a camera by name; the figures with their details."""
    stage.clear()
    choose(stage.form.presets.choice, "mapping")
    stage.settle()
    stage.form.presets.choice.showPopup()
    QTest.qWait(300)
    stage.shoot("presets.png", stage.part(stage.dock.missions, stage.dock.help, stage.form.area))
    stage.form.presets.choice.hidePopup()
    stage.survey("agricenter")
    stage.paste(FIRST)
    stage.scroll_to(stage.form.camera_group)
    QTest.qWait(200)
    page = stage.form.pages.currentWidget()
    bottom = stage.form.flight.mapTo(stage.form, QPoint(0, stage.form.flight.height())).y()
    write("camera.png", stage.form.grab(QRect(0, 0, stage.form.width(), min(bottom + 4, page.geometry().bottom()))))
    stage.form.pages.setCurrentIndex(0)
    stage.dock.figures.fold.setChecked(True)
    stage.settle()
    write("figures.png", stage.dock.figures.grab())
    stage.dock.figures.fold.setChecked(False)


# --- scenes: mapping


def mapping(stage: Stage) -> None:
    """A polygon with a hole and a no-fly area, drawn and being edited; then its flight, in sorties."""
    stage.begin(FIELDS, "field")
    stage.form.set_state(FormState(folder=str(FOLDER / "field")))
    stage.survey("field")
    form, areas = stage.form, stage.session.areas
    click(form.area.draw_polygon)
    stage.draw(FIELD_CORNERS)
    form.area.area_from.actions_by_name["add_hole"].trigger()
    stage.draw(HOLE_CORNERS)
    form.area.no_fly_from.actions_by_name["draw_no_fly"].trigger()
    stage.draw(NO_FLY_CORNERS)
    form.route.unfold()
    stage.scroll_to(form.route)
    QTest.qWait(200)
    click(form.route.pick_takeoff)
    wait("tool", areas.takeoff_tool.isActive)
    click_map(at(*TAKEOFF_AT))
    wait("take-off point", lambda: bool(stage.session.state().takeoff))
    stage.plan()
    if not form.area.edit.isChecked():
        click(form.area.edit)
    right_click_map(at(0.74, 0.3))
    wait(
        "menu",
        lambda: areas.tool.findChild(QMenu) is not None or QApplication.activePopupWidget() is not None,
    )
    stage.shoot("area.jpg", stage.part(stage.canvas, stage.dock), most_bytes=FEWER_BYTES)
    QApplication.activePopupWidget().close()
    areas.tool.stop()
    path = {"battery_min": 12.0, "lead_in_m": 15.0, "turnaround_m": 15.0}
    form.set_state(replace(stage.session.state(), start="2026-04-14T13:30:00Z", **path))
    stage.plan()
    stage.preview()
    stage.show_role("footprints", False)
    stage.shoot("sorties.jpg", stage.part(stage.canvas, stage.dock), form.route, FEWER_BYTES)


def rows(stage: Stage) -> None:
    """Rows of a slanted area turned to the shortest flight, and a camera that faces the flight direction."""
    stage.begin(FIELDS, "field")
    stage.form.set_state(FormState(folder=str(FOLDER / "field")))
    stage.survey("field")
    click(stage.form.area.draw_polygon)
    stage.draw(SLANTED_CORNERS)
    stage.session.areas.tool.stop()
    stage.plan()
    stage.preview()
    before = stage.session.state().row_azimuth_deg
    align = stage.form.flight.align.menu()
    next(action for action in align.actions() if action.objectName() == "shortest").trigger()
    wait("rows", lambda: stage.session.state().row_azimuth_deg != before)
    stage.wait_previewed()
    stage.shoot("rows.jpg", stage.part(stage.canvas, stage.dock), stage.form.flight, FEWER_BYTES)


def orthomosaic(stage: Stage) -> None:
    """A mission of tilted images in turned rows, and the orthomosaic of its images."""
    stage.begin(
        FIELDS,
        "tilted",
        tilt_deg=30.0,
        row_azimuth_deg=60.0,
        agl=150.0,
        overlap_along=0.6,
        overlap_across=0.5,
    )
    stage.form.attitude.unfold()
    stage.preview()
    stage.capture()
    stage.session.zoom_to_box(stage.session.planned.mission.area.bounds)
    # Hide the background, which shows the same ground.
    for layer in QgsProject.instance().mapLayers().values():
        if layer.name() in ("Captured images", "Synthetic (offline)"):
            QgsProject.instance().layerTreeRoot().findLayer(layer).setItemVisibilityChecked(False)
    stage.shoot("orthomosaic.jpg", stage.part(stage.canvas, stage.dock), stage.form.attitude, FEWER_BYTES)


# --- scenes: navigation


def trajectory(stage: Stage) -> None:
    """A line of a layer, flown at a speed by a tilted camera."""
    stage.begin(FIRST, "trajectory")
    choose(stage.form.presets.choice, "navigation")
    stage.form.set_state(replace(stage.session.state(), agl=80.0, tilt_deg=45.0))
    layer = QgsVectorLayer("LineString?crs=EPSG:4326", "trajectory", "memory")
    feature = QgsFeature()
    feature.setGeometry(QgsGeometry.fromWkt(TRAJECTORY))
    layer.dataProvider().addFeatures([feature])
    layer.renderer().setSymbol(QgsLineSymbol.createSimple({"color": "255,255,255", "width": "0.6"}))
    QgsProject.instance().addMapLayer(layer)
    iface.setActiveLayer(layer)
    stage.form.area.area_from.actions_by_name["line"].trigger()
    dialog = QApplication.activeModalWidget()
    dialog.interval.setValue(6.0)
    dialog.findChild(QDialogButtonBox).button(QDialogButtonBox.StandardButton.Ok).click()
    wait("area", lambda: "point" in stage.form.area.words.text().lower())
    stage.plan()
    stage.preview()
    stage.shoot("trajectory.jpg", stage.part(stage.canvas, stage.dock), stage.form.attitude, FEWER_BYTES)


# --- scenes: machine learning


def learning(stage: Stage) -> None:
    """Square images of two map types without overlap."""
    stage.begin(FIRST, "training")
    choose(stage.form.presets.choice, "learning")
    stage.plan()
    stage.preview()
    stage.shoot("learning.jpg", stage.part(stage.canvas, stage.dock), stage.form.imagery, FEWER_BYTES)


def labelled(stage: Stage) -> None:
    """Roofs of a layer as labels: an image with its classes."""
    path = FOLDER / "roofs.gpkg"
    world_roofs(path)
    stage.begin(TOWN, "roofs", agl=90.0, tilt_deg=35.0, image_px=800, labels=(f"{path}:roofs:kind",))
    stage.plan()
    stage.capture()
    viewing = stage.view_image(at(0.5, 0.5))
    choose(viewing.viewer.findChild(QComboBox, "shown_labels"), "classes")
    wait("labels", lambda: not viewing.busy)
    stage.shoot("classes.jpg", stage.part(viewing.viewer.view, viewing.viewer.labels), most_bytes=FEWEST_BYTES)
    viewing.stop()
    viewing.viewer.hide()


def realism(stage: Stage) -> None:
    """The group of a real camera's effects."""
    stage.begin(TOWN, "realism", agl=90.0, tilt_deg=35.0, image_px=800)
    stage.form.pages.setCurrentIndex(3)
    stage.form.realism.setCollapsed(False)
    choose(stage.form.realism.kinds.choice, "consumer-drone")
    stage.plan()
    stage.shoot("realism.png", stage.part(stage.dock), stage.form.realism)


def world_roofs(path: Path) -> None:
    """Write the outlines of the embedded world's roofs in a town, with a kind by their size, as a GeoPackage."""
    lat, lon = TOWN_PLACE
    around = np.array([lat - 0.003, lat + 0.003]), np.array([lon - 0.004, lon + 0.004])
    houses = WorldHouses(chart_seed(Imagery.seed, 0)).triangles(*around)
    roofs = houses.take(houses.kind == ROOF)
    at_lat, at_lon, _ = geodetic(roofs.corners_m)
    made = ogr.GetDriverByName("GPKG").CreateDataSource(str(path))
    spatial = osr.SpatialReference()
    spatial.ImportFromEPSG(4326)
    layer = made.CreateLayer("roofs", spatial, ogr.wkbPolygon)
    layer.CreateField(ogr.FieldDefn("kind", ogr.OFTString))
    for number in np.unique(roofs.instance).tolist():
        own = roofs.instance == number
        points = [QgsPointXY(x, y) for x, y in zip(at_lon[own].ravel().tolist(), at_lat[own].ravel().tolist())]
        outline = QgsGeometry.fromMultiPointXY(points).convexHull()
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetField("kind", "house" if outline.area() > 0.9e-8 else "outbuilding")
        feature.SetGeometry(ogr.CreateGeometryFromWkt(outline.asWkt()))
        layer.CreateFeature(feature)


# --- scenes: areas, sources and previews


def choices(stage: Stage) -> None:
    """The menu of areas, the list of sources, and the dialog that adds one."""
    stage.clear()
    menu = stage.form.area.area_from.menu()
    menu.popup(stage.canvas.mapToGlobal(QPoint(20, 20)))
    QTest.qWait(300)
    write("area-menu.png", menu.grab())
    menu.close()
    stage.form.source.showPopup()
    QTest.qWait(300)
    write("sources.png", stage.form.source.view().window().grab())
    stage.form.source.hidePopup()
    with WorldTiles() as tiles:
        dialog = AddSourceDialog(stage.window, lambda: TOWN_PLACE)
        dialog.show()
        enter(dialog.url, tiles.template)
        dialog.url.home(False)
        enter(dialog.name, "town-2024")
        enter(dialog.title, "Town, summer 2024")
        enter(dialog.attribution, "Survey department")
        enter(dialog.licence, "CC BY 4.0")
        click(dialog.test)
        wait("tile", lambda: dialog.tile.pixmap() is not None and not dialog.tile.pixmap().isNull())
        dialog.setFocus()
        QTest.qWait(300)
        write("add-source.png", dialog.grab())
        dialog.close()


class WorldTiles:
    """A server on this computer that provides tiles of the embedded world."""

    PORT = 8080

    def __enter__(self) -> WorldTiles:
        source = self._source = open_source("world")

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                zoom, x, y = map(int, re.findall(r"\d+", self.path))
                tile = Window(zoom, 256 * x, 256 * y, 256, 256)
                image = np.zeros((256, 256, 3), np.uint8)
                for part in source.parts(tile):
                    row, column = int(part.window.top_px) - 256 * y, int(part.window.left_px) - 256 * x
                    some = source.fetch("satellite", part.window)
                    image[row : row + some.shape[0], column : column + some.shape[1]] = some
                body = io.BytesIO()
                Image.fromarray(image).save(body, "PNG")
                self.send_response(200)
                self.send_header("Content-Type", "image/png")
                self.send_header("Content-Length", str(body.tell()))
                self.end_headers()
                self.wfile.write(body.getvalue())

            def log_message(self, *_: object) -> None:
                """Say nothing."""

        self._server = ThreadingHTTPServer(("127.0.0.1", self.PORT), Handler)
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        self.template = f"http://localhost:{self.PORT}/town/{{z}}/{{x}}/{{y}}.png"
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._source.close()


def live_view(stage: Stage) -> None:
    """A tilted camera over a town, turned on the map, and what it sees."""
    stage.begin(TOWN, "town", elevation=("world",), agl=120.0, tilt_deg=50.0, image_px=640)
    stage.zoom(5000)
    stage.plugin.actions["live_view"].trigger()
    live = stage.session.live
    wait("live view", lambda: live.pose is not None)
    live.dock.entries["yaw"].setValue(35.0)
    wait("picture", lambda: not live.feed.busy and live.dock.picture.image is not None)
    stage.window.resizeDocks([live.dock], [420], Qt.Orientation.Horizontal)
    stage.window.resizeDocks([live.dock], [640], Qt.Orientation.Vertical)
    QTest.qWait(500)
    stage.shoot("live-view.jpg", stage.part(live.dock, stage.canvas), None, 66_000)
    live.dock.close()
    stage.settle()


def previews(stage: Stage) -> None:
    """Images from close up, and a mission of so many that they are counted, not drawn."""
    stage.begin(FIRST, overlap_along=0.3, overlap_across=0.2)
    stage.preview()
    stage.zoom(4000)
    stage.shoot("close.jpg")
    stage.begin(LARGE, "county", overlap_along=0.8, overlap_across=0.6)
    stage.preview()
    stage.unfold("density")
    stage.shoot("afar.jpg")


# --- scenes: captures


def capturing(stage: Stage) -> None:
    """A mission that is paused, and another in the queue."""
    stage.begin(AGRICENTER)
    stage.preview()
    click(stage.dock.capture)
    runs = stage.session.runs
    wait(
        "images",
        lambda: bool(runs.runs) and runs.runs[0].progress is not None and runs.runs[0].progress.done >= HELD_AFTER,
    )
    first = runs.runs[0]
    click(stage.session.run_panel.row(first).buttons["pause"])
    wait("pause", lambda: first.progress.paused)
    stage.form.folder.setFilePath(str(FOLDER / "mission-2"))
    stage.form.agl.setValue(200.0)
    stage.plan()
    click(stage.dock.capture)
    wait("line", lambda: len(runs.runs) == 2)
    # New rows change the heights of widgets above them.
    QTest.qWait(1000)
    stage.shoot("queue.png", stage.part(stage.dock.figures, stage.dock.run_list))
    stage.clear()


def cleaning(stage: Stage) -> None:
    """The window in which a dataset is cleaned, beside the images that it would reject."""
    stage.begin(FIRST, map_types=("satellite", "roadmap"))
    stage.capture()
    iface.messageBar().clearWidgets()
    part = stage.session.datasets
    stage.plugin.actions["clean_dataset"].trigger()
    wait("entropies", lambda: not part.busy)
    click(part.cleaning.panel.suggest)
    stage.session.zoom_to_box(stage.session.planned.mission.area.bounds)
    wait("crosses", lambda: not part.busy)
    stage.shoot("clean.jpg", stage.part(stage.canvas, part.window), most_bytes=FEWER_BYTES)
    part.open(tab="split")
    wait("split", part.tabs["split"].split.isEnabled)
    click(part.tabs["split"].split)
    wait("split", lambda: not part.busy)
    part.open(tab="labels")
    wait("labels", lambda: not part.busy)
    QTest.qWait(500)
    write("labels.jpg", part.window.grab(), FEWER_BYTES)
    part.window.hide()


def failed(stage: Stage) -> None:
    """A capture from a file of tiles that lacks a tile: some images fail."""
    stage.begin(FIRST, "mission-1")
    picture = stage.background_file()
    tiles = FOLDER / "orthophoto.mbtiles"
    gdal.Translate(str(tiles), picture, format="MBTILES")
    holed(tiles)
    stage.clear("mission-1")
    stage.form.set_state(replace(stage.session.state(), source=str(tiles)))
    stage.paste(FIRST)
    stage.form.pages.show_field(stage.form.show_on_map)
    click(stage.form.show_on_map)
    wait_until_drawn()
    stage.capture()
    stage.shoot("failed.jpg")


def holed(tiles: Path) -> None:
    """Delete a tile of the finest zoom from the middle of a file of tiles."""
    with sqlite3.connect(tiles) as connection:
        ((zoom, column, row),) = connection.execute(
            "SELECT zoom_level, avg(tile_column), avg(tile_row) FROM tiles "
            "WHERE zoom_level = (SELECT max(zoom_level) FROM tiles)"
        ).fetchall()
        connection.execute(
            "DELETE FROM tiles WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?",
            (zoom, round(column), round(row)),
        )


def orthophoto(stage: Stage) -> None:
    """An orthophoto in the British National Grid, in a project of that CRS, captured in the orthophoto's pixels."""
    # The world of this seed has fields and woods there.
    stage.begin(MIDLANDS, "survey", seed=0)
    picture = stage.background_file()
    path = FOLDER / "orthophoto_osgb.tif"
    west, south, east, north = ORTHOPHOTO_M
    gdal.Warp(
        str(path),
        picture,
        dstSRS="EPSG:27700",
        outputBounds=(west, south, east, north),
        xRes=0.5,
        yRes=0.5,
        resampleAlg="bilinear",
    )
    stage.clear("survey")
    layer = QgsProject.instance().addMapLayer(QgsRasterLayer(str(path), "orthophoto_osgb"))
    stage.form.set_state(replace(stage.session.state(), source=f"qgis:layer/{layer.id()}", agl=250.0))
    wait_until_drawn()
    stage.canvas.setExtent(layer.extent())
    wait_until_drawn()
    stage.form.pages.setCurrentIndex(0)
    click(stage.form.draw_box)
    end = at(0.85, 0.72)
    press_map(at(0.15, 0.28), end)
    release_map(end)
    stage.plan()
    stage.preview()
    stage.capture()
    stage.dock.figures.fold.setChecked(True)
    stage.settle()
    stage.shoot("orthophoto.jpg", stage.part(stage.canvas, stage.dock), stage.form.source, FEWER_BYTES)
    stage.dock.figures.fold.setChecked(False)


def polar(stage: Stage) -> None:
    """A mosaic about the South Pole in a project of its CRS: a box around the pole, and its preview."""
    stage.clear("pole")
    path = FOLDER / "antarctica.tif"
    polar_mosaic(path)
    QgsProject.instance().setCrs(QgsCoordinateReferenceSystem(POLAR_CRS))
    layer = QgsProject.instance().addMapLayer(QgsRasterLayer(str(path), "antarctica"))
    stage.form.set_state(replace(stage.session.state(), source=f"qgis:layer/{layer.id()}", agl=700.0))
    # The map is a little higher than wide.
    stage.canvas.setExtent(layer.extent().scaled(0.88))
    wait_until_drawn()
    stage.form.pages.setCurrentIndex(0)
    click(stage.form.draw_box)
    end = at(0.75, 0.8)
    press_map(at(0.25, 0.2), end)
    release_map(end)
    stage.plan()
    stage.preview()
    stage.shoot("polar.jpg", stage.part(stage.canvas), most_bytes=FEWEST_BYTES)


def polar_mosaic(path: Path) -> None:
    """Write the embedded world about the South Pole as a GeoTIFF."""
    with closing(open_source("world", crs=POLAR_CRS)) as source:
        middle, half = source.grid.world_px(POLAR_ZOOM) // 2, POLAR_PX // 2
        corner = middle - half
        pixels = np.zeros((POLAR_PX, POLAR_PX, 3), np.uint8)
        for part in source.parts(Window(POLAR_ZOOM, corner, corner, POLAR_PX, POLAR_PX)):
            tile = part.window
            column, row = int(tile.left_px) - corner, int(tile.top_px) - corner
            pixels[row : row + tile.height_px, column : column + tile.width_px] = source.fetch("satellite", tile)
        size_m, _ = source.grid.pixel_size(POLAR_ZOOM)
    made = gdal.GetDriverByName("GTiff").Create(str(path), POLAR_PX, POLAR_PX, 3)
    made.SetProjection(QgsCoordinateReferenceSystem(POLAR_CRS).toWkt())
    made.SetGeoTransform((-half * size_m, size_m, 0.0, half * size_m, 0.0, -size_m))
    made.WriteArray(np.moveaxis(pixels, -1, 0))
    made.FlushCache()


def relief(stage: Stage) -> None:
    """A surface model as a layer, chosen for the elevation by its button: a tilted flight over it, and an image."""
    stage.begin(TOWN, "town", agl=60.0, tilt_deg=40.0, image_px=800, products=("depth",))
    path = FOLDER / "surface_utm.tif"
    world_surface(path)
    QgsProject.instance().addMapLayer(QgsRasterLayer(str(path), "surface_utm"), False)
    section = stage.form.relief
    section.unfold()
    button = section.findChild(QToolButton, "elevation_choose")
    button.menu().aboutToShow.emit()
    next(action for action in button.menu().actions() if action.text() == "surface_utm").trigger()
    stage.plan()
    stage.preview()
    stage.capture()
    viewing = stage.view_image()
    stage.shoot("relief.jpg", stage.part(stage.canvas, viewing.viewer), section, FEWER_BYTES)
    viewing.stop()
    viewing.viewer.hide()


def height_profile(stage: Stage) -> None:
    """The height profile of a flight over hills with a town, with the cursor at an image."""
    stage.begin(TOWN, "town")
    surface, ground = FOLDER / "surface_utm.tif", FOLDER / "hills.tif"
    world_surface(surface)
    hilly(surface, ground)
    entries = {"agl": 60.0, "image_px": 800, "overlap_along": 0.6, "overlap_across": 0.3, "clearance_m": 20.0}
    heights = {"elevation": (str(ground),), "surface": (str(surface),)}
    stage.form.set_state(replace(stage.session.state(), takeoff="35.1399 -89.8612", **entries, **heights))
    stage.plan()
    stage.preview()
    stage.show_previewed(0)
    stage.scroll_to(stage.form.flight.profile)
    click(stage.form.flight.profile)
    profiles = stage.session.profiles
    wait("height profile", lambda: not profiles.busy and profiles.dock.chart.profile is not None)
    stage.settle()
    stage.show_previewed(0)
    chart = profiles.dock.chart
    for _ in range(12):
        QTest.keyClick(chart, Qt.Key.Key_PageUp)
    # The lower part of the map is enough, and a small picture.
    part = stage.part(stage.canvas, profiles.dock)
    stage.shoot("profile.jpg", part.adjusted(0, part.height() * 2 // 5, 0, 0), stage.form.flight, 45_000)
    profiles.dock.close()


def hilly(surface: Path, ground: Path) -> None:
    """Raise a surface by hills, and write the hills alone as another file."""
    on_hills = gdal.Open(str(surface), gdal.GA_Update)
    x, y = np.meshgrid(np.arange(on_hills.RasterXSize), np.arange(on_hills.RasterYSize))
    hills = 18.0 * np.sin(x / 160.0) * np.cos(y / 210.0) + 6.0 * np.sin((x + 2.0 * y) / 190.0)
    band = on_hills.GetRasterBand(1)
    heights = band.ReadAsArray()
    known = heights != band.GetNoDataValue()
    alone = gdal.GetDriverByName("GTiff").CreateCopy(str(ground), on_hills)
    for raster, level in ((alone.GetRasterBand(1), float(np.median(heights[known]))), (band, heights)):
        raster.WriteArray(np.where(known, level + hills, heights).astype(np.float32))


def world_surface(path: Path) -> None:
    """Write the heights of the embedded world's town, with its roofs and trees, in UTM at 0.5 m per pixel."""
    lat, lon = TOWN_PLACE
    mission = Mission(Points(((lat, lon, 60.0),)), 60.0, elevation=("world",))
    around = np.array([lat - 0.0025, lat + 0.0025]), np.array([lon - 0.003, lon + 0.003])
    surface = seen_surface(mission_heights(mission)).surface(*around)
    rows, columns = surface.heights_m.shape
    size_m, _ = surface.grid.pixel_size(surface.zoom)
    half = surface.grid.world_px(surface.zoom) / 2.0
    made = gdal.GetDriverByName("MEM").Create("", columns, rows, 1, gdal.GDT_Float32)
    made.SetProjection(QgsCoordinateReferenceSystem("EPSG:3857").toWkt())
    west, north = (surface.left_px - half) * size_m, (half - surface.top_px) * size_m
    made.SetGeoTransform((west, size_m, 0.0, north, 0.0, -size_m))
    made.GetRasterBand(1).WriteArray(surface.heights_m)
    gdal.Warp(str(path), made, dstSRS="EPSG:32616", xRes=0.5, yRes=0.5, resampleAlg="bilinear", dstNodata=-9999)


# --- scenes: around the panel


def algorithms(stage: Stage) -> None:
    """The dialog of the algorithm that plans a mission."""
    stage.begin(FIRST)
    dialog = processing.createAlgorithmDialog("terrainav:plan", {"COORDS": f"{AGRICENTER}_120", "FRONT_OVERLAP": 25})
    dialog.show()
    dialog.resize(980, 640)
    dialog.setFocus()
    QTest.qWait(500)
    write("processing.png", dialog.grab())
    dialog.close()


def options(stage: Stage) -> None:
    """The plugin's page of QGIS's options."""
    wrong: list[BaseException] = []

    def look() -> None:
        dialog = QApplication.activeModalWidget()
        page = None if dialog is None else dialog.findChild(OptionsPage)
        if page is None or not page.isVisible():
            QTimer.singleShot(100, look)
            return
        try:
            dialog.resize(1000, 640)
            dialog.setFocus()
            QTest.qWait(500)
            write("options.png", dialog.grab())
        except BaseException as error:  # noqa: BLE001  raised again where the dialog was opened
            wrong.append(error)
        dialog.reject()

    QTimer.singleShot(0, look)
    stage.plugin.actions["settings"].trigger()
    if wrong:
        raise wrong[0]


SCENES: dict[str, Callable[[Stage], None]] = {
    scene.__name__: scene
    for scene in (
        first_mission,
        camera,
        mapping,
        rows,
        orthomosaic,
        trajectory,
        relief,
        height_profile,
        learning,
        labelled,
        realism,
        choices,
        live_view,
        previews,
        capturing,
        cleaning,
        failed,
        orthophoto,
        polar,
        algorithms,
        options,
    )
}


def prepare() -> None:
    """Delete the files of an earlier run; raise if the folder was not made by this script."""
    if FOLDER.exists() and any(FOLDER.iterdir()) and not MARK.is_file():
        raise StageError(f"folder {FOLDER}: holds something that was not made for the guide; move it away")
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir()
    MARK.touch()
    IMAGES.mkdir(exist_ok=True)


def main(names: list[str]) -> int:
    """Play scenes, all unless some are named; returns the exit code."""
    unknown = set(names) - set(SCENES)
    if unknown:
        raise StageError(f"scene {min(unknown)!r}: must be one of {', '.join(SCENES)}")
    prepare()
    stage = Stage()
    stage.panel("Browser").close()
    for name in names or SCENES:
        SCENES[name](stage)
    stage.clear()
    shutil.rmtree(FOLDER)
    return 0


try:
    sys.exit(main(sys.argv[1:]))
except StageError as error:
    sys.exit(f"screenshots: {error}")
