"""The preview at any size: what is drawn follows the view, in bounded steps, and the layers stay the user's."""

from __future__ import annotations

import os
import threading
import time
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsDateTimeRange,
    QgsExpression,
    QgsExpressionContext,
    QgsExpressionFunction,
    QgsFeature,
    QgsGeometry,
    QgsMarkerSymbol,
    QgsPointXY,
    QgsProject,
    QgsRectangle,
    QgsRuleBasedRenderer,
    QgsSingleSymbolRenderer,
    QgsTemporalNavigationObject,
    QgsTemporalUtils,
    QgsVectorDataProvider,
    QgsVectorLayer,
    QgsVectorLayerTemporalContext,
)
from qgis.gui import QgsMapToolPan
from qgis.PyQt.QtCore import QDateTime, QPoint, QPointF, Qt
from qgis.PyQt.QtGui import QColor, QWheelEvent
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.map.mission_group import MissionGroup
from terrainav.terrainav_plugin.paths import style
from terrainav.terrainav_plugin.preview import preview
from terrainav.terrainav_plugin.preview.preview import MOST_A_STEP, Preview
from terrainav.terrainav_plugin.preview.scene import FEW, MOST_DRAWN
from terrainav.terrainav_plugin.preview.view import current_view
from terrainav.terrainav_plugin.sources import mission_grid

from tests.support.thinning import sampled

PATIENCE_MS = 60_000
# 8 by 9 images, some 20,000, and a million.
SMALL = Box(35.14, -89.87, 35.131, -89.856)
MIDDLE = Box(35.25, -90.0, 35.1, -89.75)
LARGE = Box(35.6, -90.5, 34.55, -88.75)
ALWAYS = QgsDateTimeRange(QDateTime(), QDateTime())
ROLES = ("area", "centres", "flight", "footprints", "density")


class Map:
    """A preview on the map, and what a person does with the map."""

    def __init__(self, canvas, qtbot, folder):
        self.canvas, self.qtbot = canvas, qtbot
        self.project = QgsProject.instance()
        self.group = MissionGroup(self.project, folder)
        self.preview = Preview(self.project, canvas)
        self.failures = []
        self.preview.failed.connect(self.failures.append)
        canvas.setCanvasColor(QColor("white"))

    def show(self, area, crs="EPSG:3857", rectangle=None, agl_m=120.0, **changes):
        mission = Mission(area=area, agl_m=agl_m, **changes)
        self.plan = plan(mission, mission_grid(mission))
        self.preview.show(self.group, mission, self.plan)
        # The first layer gives the project its CRS, in the next turn of the event loop.
        self.qtbot.waitUntil(lambda: self.project.crs().isValid(), timeout=PATIENCE_MS)
        self.wait()
        self.project.setCrs(QgsCoordinateReferenceSystem(crs))
        if rectangle is None:
            rectangle = self.whole()
        self.look_at(rectangle)
        return self.plan

    def whole(self):
        """The mission in the project's CRS."""
        there = QgsCoordinateTransform(self.layer("footprints").crs(), self.project.crs(), self.project)
        west, south, east, north = self.plan.edges
        return there.transformBoundingBox(QgsRectangle(west.min(), south.min(), east.max(), north.max()))

    def look_at(self, rectangle):
        self.canvas.setExtent(rectangle)
        self.wait()

    def wait(self):
        self.qtbot.waitUntil(lambda: not self.preview.busy, timeout=PATIENCE_MS)
        assert not self.failures

    def wheel(self, clicks):
        """Turn the wheel over the middle of the map; towards it zooms in."""
        viewport = self.canvas.viewport()
        at = QPointF(viewport.rect().center())
        for _ in range(abs(clicks)):
            turn = QPoint(0, 120 if clicks > 0 else -120)
            event = QWheelEvent(
                at,
                viewport.mapToGlobal(at.toPoint()),
                QPoint(),
                turn,
                Qt.MouseButton.NoButton,
                Qt.KeyboardModifier.NoModifier,
                Qt.ScrollPhase.NoScrollPhase,
                False,
            )
            QApplication.sendEvent(viewport, event)
        self.wait()

    def pan(self, share):
        """Drag the map by a share of its width with the hand."""
        viewport = self.canvas.viewport()
        tool = QgsMapToolPan(self.canvas)
        self.canvas.setMapTool(tool)
        start = viewport.rect().center()
        end = start + QPoint(int(share * viewport.width()), 0)
        QTest.mousePress(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start)
        for part in (0.3, 0.6, 1.0):
            at = QPointF(start + (end - start) * part)
            QTest.mouseMove(viewport, at.toPoint())
        QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, end)
        self.canvas.unsetMapTool(tool)
        self.wait()

    def layer(self, role):
        return self.preview.layer(role)

    def counts(self):
        layers = {role: self.layer(role) for role in ROLES}
        return {role: layer.featureCount() for role, layer in layers.items() if layer is not None}

    def names(self, role="footprints"):
        return {feature["name"] for feature in self.layer(role).getFeatures()}

    def in_view(self):
        """Captures whose centre the map shows, by QGIS's own transformation."""
        back = QgsCoordinateTransform(QgsCoordinateReferenceSystem("EPSG:4326"), self.project.crs(), self.project)
        extent = self.canvas.mapSettings().visibleExtent()
        lon = np.mod(self.plan.lon_deg + 180.0, 360.0) - 180.0
        found = []
        for index, place in enumerate(zip(lon.tolist(), self.plan.lat_deg.tolist())):
            if extent.contains(back.transform(QgsPointXY(*place))):
                found.append(index)
        return found


@pytest.fixture
def map_(canvas, qtbot, tmp_path, clean_project):
    found = Map(canvas, qtbot, tmp_path)
    yield found
    canvas.setTemporalRange(ALWAYS)
    canvas.setRotation(0.0)
    canvas.setCanvasColor(QColor("white"))
    found.preview.close()


@pytest.fixture(scope="module")
def large():
    """A plan of a million captures, made once."""
    mission = Mission(area=LARGE, agl_m=120.0)
    return plan(mission, mission_grid(mission))


def squeeze(rectangle, share):
    """The middle of a rectangle."""
    part = QgsRectangle(rectangle)
    part.scale(share)
    return part


# --- at any size


def test_small_mission_is_drawn_whole_at_every_scale(map_, screenshot):
    planned = map_.show(SMALL)
    assert len(planned) <= FEW
    for clicks in (0, 2, -3, -8):
        map_.wheel(clicks)
        counts = map_.counts()
        assert counts["footprints"] == counts["centres"] == len(planned)
        assert counts["density"] == 0
    map_.look_at(map_.whole())
    map_.canvas.waitWhileRendering()
    screenshot("72")


def test_middle_mission_from_afar_is_density_and_near_is_images(map_, screenshot):
    planned = map_.show(MIDDLE)
    assert len(planned) > 10_000
    counts = map_.counts()
    assert counts["footprints"] == counts["centres"] == 0
    assert 0 < counts["density"] < 20
    map_.canvas.waitWhileRendering()
    screenshot("20000")
    map_.wheel(4)
    assert 0 < map_.counts()["footprints"] <= MOST_DRAWN
    assert map_.counts()["density"] == 0
    assert map_.names() >= {planned.names[index] for index in map_.in_view()}
    assert map_.names("centres") == map_.names()
    map_.canvas.waitWhileRendering()
    screenshot("20000-near")
    map_.wheel(-4)
    assert map_.counts() == counts


def test_million_captures_are_seen_in_steps_of_bounded_size(map_, large, screenshot):
    assert len(large) > 900_000
    map_.plan = large
    map_.preview.show(map_.group, large.mission, large)
    map_.wait()
    map_.look_at(map_.whole())
    most, corners = 0, 0
    seen_images = False
    for step in range(14):
        if step in (0, 7, 12):
            map_.canvas.waitWhileRendering()
            screenshot(f"million-{step}")
        layers = map_.preview.drawing.layers
        most = max(most, *(len(features) for features in layers.values()))
        corners = max(corners, sum(f.geometry().constGet().nCoordinates() for f in layers["flight"]))
        if map_.counts()["footprints"]:
            seen_images = True
            west, south, east, north = large.edges
            view = map_.preview.drawing.covers
            inside = (west < view.east) & (east > view.west) & (south < view.north) & (north > view.south)
            assert map_.counts()["footprints"] == inside.sum()
        else:
            assert map_.counts()["density"] > 0
        map_.wheel(1)
    assert seen_images
    assert most <= MOST_DRAWN
    assert corners <= 4000


def test_view_of_a_million_captures_looks_at_few(map_, large):
    """What a view in their midst costs does not grow with the mission."""
    map_.plan = large
    map_.preview.show(map_.group, large.mission, large)
    map_.wait()
    index = map_.preview._scene.index
    touched = []

    class Watched(type(index.boxes)):
        def take(self, ids):
            touched.append(len(ids))
            return super().take(ids)

    index.boxes = Watched(*index.boxes)
    map_.look_at(squeeze(map_.whole(), 0.02))
    assert map_.counts()["footprints"] > 0
    assert touched
    assert max(touched) <= 3 * MOST_DRAWN
    assert len(touched) <= 10


def test_small_moves_draw_nothing_anew(map_):
    map_.show(MIDDLE)
    map_.wheel(4)
    before = map_.preview.drawing
    map_.pan(0.1)
    assert map_.preview.drawing is before
    extent = map_.canvas.extent()
    map_.pan(0.9)
    map_.pan(0.9)
    assert map_.canvas.extent() != extent
    assert map_.preview.drawing is not before
    assert map_.names() >= {map_.plan.names[index] for index in map_.in_view()}


def test_last_of_many_views_wins(map_):
    map_.show(MIDDLE)
    whole = map_.whole()
    for share in (0.5, 0.3, 0.01, 0.6, 0.05):
        map_.canvas.setExtent(squeeze(whole, share))
    map_.wait()
    assert map_.preview.drawing.covers.contains(current_view(map_.canvas).rect)
    assert map_.names() >= {map_.plan.names[index] for index in map_.in_view()}


def test_far_points_are_drawn_where_they_are_large_enough(map_):
    """High captures are drawn from afar, the low ones among them are density."""
    low = [(10.0 + 0.001 * i, 20.0 + 0.001 * (i % 37), 50.0) for i in range(150)]
    planned = map_.show(Points((*low, (10.1, 20.1, 55_000.0))), layout="cover")
    map_.look_at(QgsRectangle(2_100_000, 1_000_000, 2_400_000, 1_250_000))
    assert map_.names() == {planned.names[-1]}
    assert not map_.preview.drawing.all_drawn
    assert map_.counts()["flight"] == 1
    map_.look_at(QgsRectangle(2_226_000, 1_118_000, 2_230_500, 1_121_000))
    assert planned.names[0] in map_.names()


# --- any CRS


@pytest.mark.parametrize(
    ("crs", "area"),
    sampled(
        [
            ("EPSG:32616", MIDDLE),
            ("EPSG:4326", MIDDLE),
            ("EPSG:3832", Box(-17.0, 179.9, -17.15, -179.9)),
            ("EPSG:3995", Box(80.02, -100.0, 79.9, -99.2)),
            ("EPSG:3031", Box(-79.9, 179.6, -80.02, -179.6)),
        ],
        3,
    ),
)
def test_images_in_view_are_drawn_in_any_crs(map_, crs, area):
    target = QgsCoordinateReferenceSystem(crs)
    there = QgsCoordinateTransform(QgsCoordinateReferenceSystem("EPSG:4326"), target, map_.project)
    middle = there.transform(QgsPointXY((area.west_deg + area.continuous_east_deg) / 2.0, area.north_deg - 0.05))
    size = 2000.0
    if target.isGeographic():
        size /= 111_000.0
    map_.show(area, crs, QgsRectangle.fromCenterAndSize(middle, size, size))
    expected = {map_.plan.names[index] for index in map_.in_view()}
    assert len(expected) > 20
    assert map_.names() >= expected
    assert map_.counts()["footprints"] <= MOST_DRAWN


@pytest.mark.parametrize(
    "crs", sampled(["EPSG:3857", "EPSG:4326", "EPSG:3832", "EPSG:3995", "EPSG:8857", "EPSG:32616"], 3)
)
def test_views_larger_than_the_world_show_the_mission(map_, crs):
    map_.show(MIDDLE, crs)
    map_.wheel(-30)
    assert map_.counts()["area"] == map_.counts()["flight"] == 1
    map_.look_at(map_.whole())
    assert map_.counts()["density"] > 0


def test_rotated_map_is_filled_to_its_corners(map_):
    map_.show(MIDDLE)
    map_.wheel(4)
    map_.canvas.setRotation(45.0)
    map_.wait()
    assert map_.names() >= {map_.plan.names[index] for index in map_.in_view()}


# --- the layers stay the user's


def test_layers_names_and_styles_survive_every_view(map_):
    map_.show(MIDDLE)
    layers = {role: map_.layer(role).id() for role in ROLES}
    footprints = map_.layer("footprints")
    footprints.setName("mine")
    renderer = footprints.renderer().clone()
    renderer.symbol().setColor(QColor("magenta"))
    footprints.setRenderer(renderer)
    map_.wheel(4)
    map_.wheel(-6)
    map_.preview.show(map_.group, map_.plan.mission, map_.plan)
    map_.wait()
    assert {role: map_.layer(role).id() for role in ROLES} == layers
    assert [node.layerId() for node in map_.group.find().findLayers()] == list(layers.values())
    assert footprints.name() == "mine"
    assert footprints.renderer().symbol().color() == QColor("magenta")


def test_images_can_be_coloured_by_overlap(map_, screenshot):
    planned = map_.show(SMALL, overlap_along=0.6, overlap_across=0.4)
    layer = map_.layer("footprints")
    west, south, east, north = planned.edges
    x, y = (west + east) / 2.0, (south + north) / 2.0
    shown = (west[:, None] <= x) & (x < east[:, None]) & (south[:, None] < y) & (y <= north[:, None])
    counts = dict(zip(planned.names, shown.sum(axis=0).tolist()))
    assert set(counts.values()) == {2, 3}
    assert {feature["name"]: feature["overlap"] for feature in layer.getFeatures()}.items() <= counts.items()
    styles = layer.styleManager()
    assert styles.styles() == ["Footprints", "Overlap count"]
    assert styles.currentStyle() == "Footprints"
    assert isinstance(layer.renderer(), QgsSingleSymbolRenderer)
    assert styles.setCurrentStyle("Overlap count")
    assert layer.renderer().classAttribute() == "overlap"
    map_.wheel(1)
    assert styles.currentStyle() == "Overlap count"
    # What the layer is to the plugin and to the temporal controller stays.
    assert map_.group.layer("footprints").id() == layer.id()
    assert layer.temporalProperties().isActive()
    assert layer.mapTipTemplate()
    map_.canvas.refreshAllLayers()
    map_.canvas.waitWhileRendering()
    screenshot("overlap")


def test_close_up_on_a_dark_map(map_, screenshot):
    map_.canvas.setCanvasColor(QColor(25, 25, 30))
    planned = map_.show(SMALL)
    map_.look_at(squeeze(map_.whole(), 0.3))
    map_.canvas.waitWhileRendering()
    assert len(planned) == map_.counts()["footprints"]
    screenshot("dark-close")
    map_.look_at(map_.whole())
    map_.canvas.waitWhileRendering()
    screenshot("dark")


def test_tilted_camera_is_drawn_as_it_sees(map_, screenshot):
    planned = map_.show(MIDDLE, tilt_deg=60.0, yaw_deg=30.0, agl_m=300.0)
    map_.wheel(3)
    assert 0 < map_.counts()["footprints"] <= MOST_DRAWN
    assert map_.names() >= {planned.names[index] for index in map_.in_view()}
    map_.canvas.waitWhileRendering()
    screenshot("tilted")


def test_saved_project_holds_no_features_of_the_preview(map_, tmp_path):
    map_.show(SMALL)
    assert map_.project.write(str(tmp_path / "project.qgz"))
    other = QgsProject()
    assert other.read(str(tmp_path / "project.qgz"))
    layers = other.mapLayers().values()
    assert len(layers) == len(ROLES)
    assert [layer.featureCount() for layer in layers] == [0] * len(ROLES)


# --- times


def flown(layer, times):
    """Names of a layer's features that QGIS shows in a range of time."""
    context = QgsVectorLayerTemporalContext()
    context.setLayer(layer)
    text = layer.temporalProperties().createFilterString(context, times)
    assert text
    return {feature["name"] for feature in layer.getFeatures(text)}


@pytest.fixture(params=["UTC", "America/New_York", "Asia/Kathmandu"])
def time_zone(request):
    """Time zone of the machine."""
    if not hasattr(time, "tzset"):
        pytest.skip("the time zone of a program is set once here")
    before = os.environ.get("TZ")
    os.environ["TZ"] = request.param
    time.tzset()
    yield request.param
    if before is None:
        del os.environ["TZ"]
    else:
        os.environ["TZ"] = before
    time.tzset()


def test_times_are_utc_in_every_time_zone(map_, time_zone):
    planned = map_.show(SMALL, start="2024-06-21T10:00:00Z")
    for role in ("footprints", "centres"):
        for feature in map_.layer(role).getFeatures():
            at = planned.times_s[planned.names.index(feature["name"])]
            # 2024-06-21T10:00:00Z is 1,718,964,000 s of Unix time.
            assert feature["time"].toMSecsSinceEpoch() == pytest.approx(1.718964e12 + 1000.0 * at, abs=1.0)
            text = QgsExpression("format_date(\"time\", 'yyyy-MM-dd HH:mm:ss')")
            context = QgsExpressionContext()
            context.setFeature(feature)
            wanted = time.strftime("%Y-%m-%d %H:%M:%S", time.gmtime(1_718_964_000 + int(at)))
            assert text.evaluate(context) == wanted


def test_temporal_controller_flies_the_mission(map_, time_zone):
    planned = map_.show(SMALL, start="2024-06-21T10:00:00Z")
    controller = QgsTemporalNavigationObject()
    whole = QgsTemporalUtils.calculateTemporalRangeForProject(map_.project)
    assert whole.begin().toString(Qt.DateFormat.ISODate).startswith("2024-06-21T10:00:00")
    seconds = whole.begin().secsTo(whole.end())
    assert planned.direct.duration_s <= seconds <= planned.direct.duration_s * 1.1 + 2.0
    controller.setTemporalExtents(whole)
    interval = controller.frameDuration()
    interval.setSeconds(20.0)
    controller.setFrameDuration(interval)
    until = np.append(planned.times_s[1:], np.inf)
    seen = set()
    for frame in range(controller.totalFrameCount()):
        times = controller.dateTimeRangeForFrameNumber(frame)
        begin, end = (whole.begin().msecsTo(at) / 1000.0 for at in (times.begin(), times.end()))
        shown = flown(map_.layer("footprints"), times)
        # Those taken in the range, and the last one before it. QGIS cuts moments to whole seconds.
        surely = (planned.times_s < end - 1.0) & (until > begin + 1.0)
        at_most = (planned.times_s < end + 1.0) & (until > begin - 1.0)
        names = np.array(planned.names)
        assert set(names[surely]) <= shown <= set(names[at_most])
        assert shown == flown(map_.layer("centres"), times)
        seen |= shown
    assert seen == set(planned.names)


def test_whole_flight_has_its_times_where_a_part_is_in_view(map_):
    planned = map_.show(MIDDLE)
    map_.wheel(6)
    assert 0 < map_.counts()["footprints"] < len(planned)
    whole = QgsTemporalUtils.calculateTemporalRangeForProject(map_.project)
    assert whole.begin().secsTo(whole.end()) >= planned.direct.duration_s - 1.0
    times = {feature["name"]: feature["time"] for feature in map_.layer("footprints").getFeatures()}
    expected = dict(zip(planned.names, planned.times_s.tolist()))
    start = whole.begin()
    for name, at in times.items():
        assert start.msecsTo(at) / 1000.0 == pytest.approx(expected[name], abs=1e-3)


def test_images_of_the_moment_are_drawn_where_all_are_too_many(map_, time_zone):
    planned = map_.show(MIDDLE)
    assert map_.counts()["footprints"] == 0
    start = QgsTemporalUtils.calculateTemporalRangeForProject(map_.project).begin()
    begin, end = planned.times_s[5000], planned.times_s[5100]
    times = QgsDateTimeRange(start.addMSecs(int(begin * 1000)), start.addMSecs(int(end * 1000)))
    map_.canvas.setTemporalRange(times)
    map_.wait()
    assert map_.names() >= set(planned.names[5001:5100])
    assert len(map_.names()) <= 110
    assert map_.counts()["density"] > 0
    map_.canvas.setTemporalRange(ALWAYS)
    map_.wait()
    assert map_.counts()["footprints"] == 0


# --- the flight line


def test_flight_line_has_every_leg_in_view_and_few_elsewhere(map_):
    planned = map_.show(MIDDLE)
    from_afar = next(map_.layer("flight").getFeatures())
    assert from_afar.geometry().constGet().nCoordinates() <= 4000
    map_.wheel(6)
    near = next(map_.layer("flight").getFeatures())
    assert near["length_m"] == from_afar["length_m"] == planned.direct.distance_m
    assert (near["images"], near["start"], near["end"]) == (
        len(planned),
        from_afar["start"],
        from_afar["end"],
    )
    corners = {(round(p.x(), 3), round(p.y(), 3)) for p in near.geometry().vertices()}
    places = (feature.geometry().asPoint() for feature in map_.layer("centres").getFeatures())
    centres = {(round(place.x(), 3), round(place.y(), 3)) for place in places}
    assert centres <= corners
    assert len(corners) <= len(centres) + 4 * planned.rows


# --- missions of every kind, as they look


def painted(map_):
    """Share of the map's pixels that are not its background."""
    map_.canvas.refreshAllLayers()
    map_.canvas.waitWhileRendering()
    return share_painted(map_.canvas)


def share_painted(canvas):
    image = canvas.grab().toImage()
    background = QColor("white").rgb()
    spots = [(x, y) for x in range(0, image.width(), 3) for y in range(0, image.height(), 3)]
    return sum(image.pixel(x, y) != background for x, y in spots) / len(spots)


@pytest.mark.parametrize("name", ["area", "centres", "flight", "footprints", "density", "overlap"])
def test_expressions_of_styles_are_expressions(name):
    tree = ET.parse(style(name))
    options = [node.get("value") for node in tree.iter("Option") if node.get("name") == "expression"]
    labels = [node.get("fieldName") for node in tree.iter("text-style") if node.get("isExpression") == "1"]
    wrong = [text for text in [*options, *labels] if text and QgsExpression(text).hasParserError()]
    assert not wrong


@pytest.mark.parametrize(
    ("changes", "clicks"),
    sampled(
        [
            ({"tilt_deg": 60.0, "yaw_deg": 30.0, "agl_m": 300.0}, 3),
            ({"tilt_deg": 30.0, "overlap_along": 0.6, "overlap_across": 0.6}, 5),
            ({"overlap_along": 0.8, "overlap_across": 0.8}, 6),
        ],
        3,
    ),
)
def test_ground_is_seen_below_hundreds_of_footprints(map_, screenshot, changes, clicks):
    map_.show(MIDDLE, **changes)
    map_.wheel(clicks)
    boxes = np.array(
        [
            [b.xMinimum(), b.yMinimum(), b.xMaximum(), b.yMaximum()]
            for b in (feature.geometry().boundingBox() for feature in map_.layer("footprints").getFeatures())
        ]
    )
    west, south, east, north = boxes.T
    x, y = (west + east) / 2.0, (south + north) / 2.0
    over = ((west[:, None] <= x) & (x <= east[:, None]) & (south[:, None] <= y) & (y <= north[:, None])).sum(axis=0)
    crowd = np.array([feature["crowd"] for feature in map_.layer("footprints").getFeatures()])
    # Rectangles are taken a hundredth wider where edges may bulge.
    assert (np.abs(crowd - over) <= 0.1 * over + 2).all()
    assert crowd.max() > 12
    assert 0.02 < painted(map_) < 0.5
    screenshot(f"crowd-{int(crowd.max())}")


def test_second_pass_of_a_turned_grid_is_drawn_turned(map_, screenshot):
    planned = map_.show(SMALL, crosshatch=True, row_azimuth_deg=127.0)
    # Rows are straight over the whole area, whose meridians converge by hundredths of a degree.
    yaws = {round(feature["yaw"], 1) % 360.0 for feature in map_.layer("centres").getFeatures()}
    assert yaws == {37.0, 127.0}
    assert map_.names() == map_.names("centres") == set(planned.names)
    # A camera that looks straight down is over the middle of what it sees.
    seen = {feature["name"]: feature.geometry() for feature in map_.layer("footprints").getFeatures()}
    for feature in map_.layer("centres").getFeatures():
        outline = seen[feature["name"]]
        assert outline.centroid().distance(feature.geometry()) < 1.0
        # Its edges are turned: the box around it is half as large again.
        assert outline.boundingBox().area() > 1.5 * outline.area()
    flight = next(map_.layer("flight").getFeatures())
    assert flight.geometry().constGet().nCoordinates() == len(planned)
    painted(map_)
    screenshot("crosshatch")


def test_wind_moves_centres_and_outlines_together(map_, screenshot):
    planned = map_.show(SMALL, wind=Wind(6.0, 300.0, 0.2), overlap_along=0.6, overlap_across=0.4)
    attitudes = {
        feature["name"]: (feature["yaw"], feature["tilt"], feature["roll"])
        for feature in map_.layer("footprints").getFeatures()
    }
    assert attitudes == dict(zip(planned.names, zip(*(part.tolist() for part in planned.poses.attitude))))
    assert len(set(attitudes.values())) == len(planned)
    seen = {feature["name"]: feature.geometry() for feature in map_.layer("footprints").getFeatures()}
    centres = list(map_.layer("centres").getFeatures())
    assert len(centres) == len(planned)
    assert all(seen[feature["name"]].contains(feature.geometry()) for feature in centres)
    painted(map_)
    screenshot("wind")


# --- steps


def test_features_come_in_steps_and_are_shown_at_once(map_, monkeypatch):
    map_.show(SMALL)
    steps, turn, repainted = [], [0], []
    add = QgsVectorDataProvider.addFeatures

    def counted(provider, features, *flags):
        steps.append((turn[0], len(features)))
        return add(provider, features, *flags)

    monkeypatch.setattr(QgsVectorDataProvider, "addFeatures", counted)
    map_.preview._turn.timeout.connect(lambda: turn.__setitem__(0, turn[0] + 1))
    for role in ROLES:
        map_.layer(role).repaintRequested.connect(lambda *_, role=role: repainted.append((role, len(steps))))
    mission = Mission(area=SMALL, agl_m=120.0, overlap_along=0.7, overlap_across=0.7)
    planned = plan(mission, mission_grid(mission))
    assert 500 < len(planned) < MOST_DRAWN
    map_.preview.show(map_.group, mission, planned)
    map_.wait()
    # Area and flight line, centres and footprints.
    assert sum(count for _, count in steps) == 2 + 2 * len(planned)
    assert max(count for _, count in steps) <= MOST_A_STEP
    # The first step is taken when the features come, each of the others in a turn of the event loop of its own.
    # Where layers are still being made when they come, that is a turn as well.
    assert len({turn for turn, _ in steps}) >= len(steps) - 1
    # A layer that is emptied may be painted so, before the first step or, in the same turn, after it.
    painted = [(role, step) for role, step in repainted if step > 1]
    # On a busy machine the map's own changes may have them painted once more.
    assert set(painted) == {(role, len(steps)) for role in ("area", "centres", "flight", "footprints")}


class Hold(QgsExpressionFunction):
    """A function of expressions that lasts until it is let go."""

    def __init__(self):
        super().__init__("terrainav_hold", 0, "tests")
        self.begun, self.leave = threading.Event(), threading.Event()

    def func(self, values, context, parent, node):
        self.begun.set()
        self.leave.wait(PATIENCE_MS / 1000.0)
        return True

    def isStatic(self, node, parent, context):
        return False


#: Once QGIS has it, it stays: drawings that go on in the background may still come to it.
HOLD = Hold()


@pytest.fixture
def held_up(map_):
    """What adds a layer whose drawing lasts until it is let go, and what lets it go."""
    if not QgsExpression.isFunctionName(HOLD.name()):
        assert QgsExpression.registerFunction(HOLD)
    HOLD.begun.clear()
    HOLD.leave.clear()
    layer = QgsVectorLayer("Point?crs=EPSG:3857", "held up", "memory")
    layer.setRenderer(QgsRuleBasedRenderer(QgsMarkerSymbol.createSimple({"size": "0.1"})))
    layer.renderer().rootRule().children()[0].setFilterExpression("terrainav_hold()")

    def add():
        map_.canvas.clearCache()
        feature = QgsFeature()
        feature.setGeometry(QgsGeometry.fromPointXY(map_.canvas.extent().center()))
        layer.dataProvider().addFeatures([feature])
        map_.project.addMapLayer(layer)
        map_.qtbot.waitUntil(HOLD.begun.is_set, timeout=PATIENCE_MS)

    yield add, HOLD.leave.set
    HOLD.leave.set()


def test_change_under_a_running_drawing_comes_to_the_map(map_, held_up, monkeypatch):
    map_.show(MIDDLE)
    assert map_.counts()["density"] > 0
    assert painted(map_) > 0.5
    add, let_go = held_up
    add()
    map_.qtbot.wait(300)  # the preview's own layers are drawn now; the map waits for the last one
    repaint = map_.preview._repaint

    def end_before_the_next_begins(*arguments):
        # First all layers are drawn, then their labels; of each end QGIS hears in a turn of the event loop.
        let_go()
        time.sleep(0.3)
        QApplication.processEvents()
        repaint(*arguments)
        time.sleep(0.3)

    monkeypatch.setattr(map_.preview, "_repaint", end_before_the_next_begins)
    mission = Mission(area=SMALL, agl_m=120.0)
    map_.preview.show(map_.group, mission, plan(mission, mission_grid(mission)))
    map_.wait()
    assert map_.counts()["density"] == 0
    map_.qtbot.wait(300)
    map_.canvas.waitWhileRendering()
    assert share_painted(map_.canvas) < 0.2


@pytest.mark.parametrize("way", ["preview", "layer", "project"])
def test_styles_outlive_their_layers(map_, iface, monkeypatch, way):
    """QGIS ends where a drawing begins to copy the expressions of a style of which nobody holds another copy."""
    kept = []
    monkeypatch.setattr(preview.QTimer, "singleShot", lambda wait_ms, clear: kept.append((wait_ms, clear.__self__)))
    map_.show(SMALL)
    layer = map_.layer("footprints")
    wanted = expressions(layer.renderer())
    assert wanted
    if way == "preview":
        map_.preview.remove()
    elif way == "layer":
        map_.project.removeMapLayer(layer.id())
    else:
        iface.newProject(False)
    assert map_.layer("footprints") is None
    found = [
        expressions(style)
        for wait_ms, styles in kept
        if wait_ms >= 10_000
        for style in styles
        if isinstance(style, QgsSingleSymbolRenderer)
    ]
    assert wanted in found


def expressions(renderer):
    """Data-defined expressions of a style of one symbol."""
    properties = renderer.symbol().symbolLayer(0).dataDefinedProperties()
    return [properties.property(key).expressionString() for key in sorted(properties.propertyKeys())]


def test_view_left_while_it_is_filled_leaves_no_half_of_it(map_):
    map_.show(MIDDLE)
    filled = map_.counts()
    extent = squeeze(map_.whole(), 0.05)
    map_.canvas.setExtent(extent)
    # In the middle of filling, the layers hold some of what is to come.
    layer = map_.layer("centres")
    map_.qtbot.waitUntil(lambda: layer.featureCount() > 0, timeout=PATIENCE_MS)
    map_.canvas.setExtent(map_.whole())
    map_.wait()
    assert map_.counts() == filled
    map_.look_at(extent)
    assert map_.names("centres") == map_.names()
