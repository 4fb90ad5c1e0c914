"""The window that shows one captured image at a time, with its data."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from qgis.core import QgsApplication
from qgis.gui import QgsDockWidget
from qgis.PyQt.QtCore import QPointF, Qt, pyqtSignal
from qgis.PyQt.QtGui import QPainter, QPaintEvent
from qgis.PyQt.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from ...core.numbers import real_number
from ..dataset.picture import Depth, legend_image
from ..form.fields import map_type_title
from ..i18n import number_text, tr, translate
from ..picture_view import PictureView
from ..plain import plain_label
from ..units import METRES, gsd_text
from ..widgets import named, push_button, scrolled, wrapped_label
from .labels_pane import LabelsPane
from .shots import CapturedImage, ViewedImage

#: Names of metadata that other rows already show, or that only programs need.
_OMITTED = {
    "AREA_OR_POINT",
    "NAME",
    "MAP_TYPE",
    "SOURCE",
    "ATTRIBUTION",
    "ZOOM",
    "LAT_DEG",
    "LON_DEG",
    "AGL_M",
    "YAW_DEG",
    "TILT_DEG",
    "ROLL_DEG",
    "IMAGERY_DATE",
    "EFFECTIVE_GSD_M_PER_PX",
}


class Viewer(QgsDockWidget):
    """Show an image with its details, and emit requests for other images.

    Signals
    -------
    chosen(int)
        Index of an image under the click, chosen by the user.
    step_wanted(int)
        1 for the next image of the flight, -1 for the previous one.
    map_type_wanted(str)
    open_wanted(), zoom_wanted()
    on_map_wanted(bool)
        Whether to show the image on the map.
    """

    chosen = pyqtSignal(int)
    step_wanted = pyqtSignal(int)
    map_type_wanted = pyqtSignal(str)
    open_wanted = pyqtSignal()
    zoom_wanted = pyqtSignal()
    on_map_wanted = pyqtSignal(bool)

    def __init__(self) -> None:
        super().__init__(tr("Images (TerrAInav)"))
        self.setObjectName("terrainav_viewer")
        self.view = PictureView("picture")
        self.depth = DepthPane(self.view)
        self.labels = LabelsPane(self.view)
        self.under_click = named(QComboBox(), "under_click", tr("Images that show the clicked place"))
        self.under_click.activated.connect(self.chosen)
        self.map_type = named(QComboBox(), "shown_map_type", tr("Map type shown"))
        self.map_type.activated.connect(lambda index: self.map_type_wanted.emit(self.map_type.itemData(index)))
        self.details = wrapped_label("details")
        self.details.setTextFormat(Qt.TextFormat.RichText)
        self.details.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.place = named(plain_label(), "place")
        self.place.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._make_buttons()
        self.setWidget(self._contents())

    def show_hint(self, text: str) -> None:
        """Show a text instead of an image."""
        self.view.show_image(None, text)
        self.depth.show_depth(None)
        self.labels.show_labels((), "", None)
        self.details.setText("")
        self.place.setText("")
        self.under_click.hide()
        self.map_type.hide()
        for button in (self.previous, self.following, self.open, self.zoom, self.on_map):
            button.setEnabled(False)
        self.on_map.setChecked(False)

    def show_fetching(self, name: str) -> None:
        """Show that an image is being fetched; the buttons for other images stay enabled."""
        self.view.show_image(None, tr("Fetching {name}…").format(name=name))
        self.depth.show_depth(None)
        self.labels.show_labels((), "", None)
        self.details.setText("")
        self.open.setEnabled(False)
        self.on_map.setEnabled(False)

    def offer(self, shots: Sequence[CapturedImage], index: int) -> None:
        """Offer the images under a click."""
        self.under_click.clear()
        count = len(shots)
        names = [shot.name for shot in shots]
        if len(set(names)) < count:
            # Images of several imageries share their names: the folder tells which is which.
            names = [f"{shot.footprints.folder.name}/{shot.name}" for shot in shots]
        for number, name in enumerate(names):
            self.under_click.addItem(
                tr("{number} of {count} here: {name}").format(number=number + 1, count=count, name=name)
            )
        self.under_click.setCurrentIndex(index)
        self.under_click.setVisible(count > 1)

    def leave_click(self) -> None:
        """Hide the choice among the images under the click, as the image shown is no longer one of them."""
        self.under_click.hide()

    def show_seen(self, seen: ViewedImage) -> None:
        """Show an image."""
        self.view.show_image(seen.picture.image, seen.picture.problem)
        self.depth.show_depth(seen.depth)
        self.labels.show_labels(seen.label_products, seen.shown_labels, seen.labels)
        self.details.setText(details_html(seen))
        count = seen.shot.count
        self.place.setText(
            tr("{number} of {count}").format(number=number_text(seen.shot.number + 1), count=number_text(count))
        )
        self.previous.setEnabled(seen.shot.number > 0)
        self.following.setEnabled(seen.shot.number + 1 < count)
        self.open.setEnabled(seen.picture.image is not None)
        self.zoom.setEnabled(True)
        self.on_map.setEnabled(seen.picture.image is not None and not seen.rejected)
        self.map_type.clear()
        for map_type in seen.map_types:
            self.map_type.addItem(map_type_title(map_type), map_type)
        self.map_type.setCurrentIndex(seen.map_types.index(seen.map_type))
        self.map_type.setVisible(len(seen.map_types) > 1)

    def _make_buttons(self) -> None:
        of_qgis = QgsApplication.getThemeIcon
        self.previous = push_button(
            "previous",
            tr("Prev&ious"),
            tr("Previous image of the flight"),
            of_qgis("/mActionArrowLeft.svg"),
        )
        self.previous.clicked.connect(lambda: self.step_wanted.emit(-1))
        self.following = push_button(
            "next", tr("Ne&xt"), tr("Next image of the flight"), of_qgis("/mActionArrowRight.svg")
        )
        self.following.clicked.connect(lambda: self.step_wanted.emit(1))
        self.open = push_button(
            "open",
            tr("Ope&n"),
            tr("Open the image in its default program"),
            of_qgis("/mActionFileOpen.svg"),
        )
        self.open.clicked.connect(lambda _checked: self.open_wanted.emit())
        self.zoom = push_button(
            "zoom", tr("&Zoom to"), tr("Show the image's footprint on the map"), of_qgis("/mActionZoomTo.svg")
        )
        self.zoom.clicked.connect(lambda _checked: self.zoom_wanted.emit())
        self.on_map = push_button(
            "show_on_map",
            tr("Show on m&ap"),
            tr("Lay this image on the map, orthorectified where it is turned or tilted; press again to remove it"),
            of_qgis("/mActionAddRasterLayer.svg"),
        )
        self.on_map.setCheckable(True)
        self.on_map.clicked.connect(self.on_map_wanted.emit)

    def _pictures(self) -> QWidget:
        """Widget with the image, the depth next to it, and their legends below."""
        beside = QHBoxLayout()
        beside.setSpacing(4)
        beside.addWidget(self.view, 1)
        beside.addWidget(self.depth.view, 1)
        pictures = QWidget()
        layout = QVBoxLayout(pictures)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(beside, 1)
        layout.addWidget(self.depth)
        layout.addWidget(self.labels)
        return pictures

    def _contents(self) -> QWidget:
        both = QSplitter(Qt.Orientation.Vertical)
        both.addWidget(self._pictures())
        facts = scrolled(self.details)
        # A line or two at least: more would push QGIS's window off a low screen once its Results Viewer opens above.
        facts.setMinimumHeight(3 * self.fontMetrics().lineSpacing() // 2)
        both.addWidget(facts)
        for index, share in enumerate((1, 1)):
            both.setStretchFactor(index, share)
        # Initial sizes of the picture and the details, whose ratio is kept as the window grows.
        both.setSizes([300, 220])
        both.setCollapsible(0, False)
        choices = QHBoxLayout()
        choices.addWidget(self.under_click, 1)
        choices.addWidget(self.map_type)
        steps = QHBoxLayout()
        steps.addWidget(self.previous)
        steps.addWidget(self.place, 1)
        steps.addWidget(self.following)
        more = QHBoxLayout()
        more.addStretch(1)
        more.addWidget(self.on_map)
        more.addWidget(self.zoom)
        more.addWidget(self.open)
        contents = QWidget()
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addLayout(choices)
        layout.addWidget(both, 1)
        layout.addLayout(steps)
        layout.addLayout(more)
        return contents


class DepthPane(QWidget):
    """Depth next to an image, its legend, and the depth under the mouse; hidden if there is no depth.

    Parameters
    ----------
    picture : PictureView
        View of the image to which the depth belongs.

    Attributes
    ----------
    view : PictureView
        View of the depth in colours.
    here : QLabel
        Text with the depth under the mouse.
    """

    def __init__(self, picture: PictureView) -> None:
        super().__init__()
        self._picture = picture
        self.view = PictureView("depth")
        self.view.setToolTip(tr("Depth along the camera's axis; grey where no ground is seen"))
        self.near, self.middle, self.far = (named(plain_label(), name) for name in ("near", "middle", "far"))
        self.here = named(plain_label(), "depth_here")
        self.here.setAlignment(Qt.AlignmentFlag.AlignCenter)
        for view in (picture, self.view):
            view.pointed.connect(self._point)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        layout.addWidget(Legend())
        numbers = QHBoxLayout()
        for label in (self.near, self.middle, self.far):
            numbers.addWidget(label)
            if label is not self.far:
                numbers.addStretch(1)
        layout.addLayout(numbers)
        layout.addWidget(self.here)
        self.show_depth(None)

    def show_depth(self, depth: Depth | None) -> None:
        """Show a depth, or why the depth cannot be read; None hides the pane."""
        self._depth: Depth | None = None if depth is None or depth.problem else depth
        self.view.show_image(*((None,) if depth is None else (depth.image, depth.problem)))
        self.view.setVisible(depth is not None)
        self.setVisible(self._depth is not None)
        if depth is None or depth.problem:
            return
        for label, share in ((self.near, 0.0), (self.middle, 0.5), (self.far, 1.0)):
            metres = depth.to_metres(share)
            label.setText("" if math.isnan(metres) else _metres(metres))
        self._point(None)

    def _point(self, at: QPointF | None) -> None:
        if self._depth is None:
            return
        for view in (self._picture, self.view):
            view.mark(at)
        if at is None:
            self.here.setText(tr("Depth, grey where no ground is seen"))
            return
        metres = self._depth.metres_at_point(at.x(), at.y())
        self.here.setText(
            tr("No ground here") if math.isnan(metres) else tr("Depth here: {metres}").format(metres=_metres(metres))
        )


class Legend(QWidget):
    """The colours of depths from near to far."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("depth_legend")
        self.setFixedHeight(10)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: ARG002  Qt passes it
        """Paint."""
        QPainter(self).drawImage(self.rect(), legend_image(max(self.width(), 2)))


def details_html(seen: ViewedImage) -> str:
    """Details of an image as an HTML table."""
    rows = "".join(
        f"<tr><td style='padding-right: 8px'><b>{html.escape(name)}</b></td><td>{html.escape(value)}</td></tr>"
        for name, value in details(seen)
        if value
    )
    return f"<table>{rows}</table>"


def details(seen: ViewedImage) -> Iterator[tuple[str, str]]:
    """Names and values of an image's details, the most important first."""
    pose, row, metadata = seen.shot.pose, seen.row, seen.picture.metadata
    yield tr("Image"), seen.shot.name
    if row.get("status") == "failed":
        yield tr("Failed"), translate(row.get("reason", ""))
    elif seen.picture.problem:
        yield tr("Missing"), seen.picture.problem
    if seen.rejected:
        yield tr("Rejected"), tr("by cleaning the dataset")
    yield (
        tr("Position"),
        tr("{lat}°, {lon}°").format(lat=_number(pose, "lat_deg", 7), lon=_number(pose, "lon_deg", 7)),
    )
    yield tr("Height"), _height(pose, row)
    angles = (_number(pose, name, 2) for name in ("yaw_deg", "tilt_deg", "roll_deg"))
    yield tr("Yaw, tilt, roll"), tr("{}°, {}°, {}°").format(*angles)
    yield tr("Capture time"), _time(pose)
    if seen.picture.width_px:
        yield (
            tr("Size"),
            tr("{width} × {height} px").format(width=seen.picture.width_px, height=seen.picture.height_px),
        )
    yield tr("GSD"), _gsd(seen)
    facade_share = _float(row.get("facade_share", ""))
    if facade_share > 0.0:
        yield (
            tr("Steep faces"),
            tr("{share} % of the pixels").format(share=number_text(100.0 * facade_share, ".1f")),
        )
    yield tr("Entropy"), _entropy(row.get("entropies", ""))
    yield tr("Source"), row.get("source") or metadata.get("SOURCE", "")
    yield tr("Imagery date"), row.get("imagery_date") or metadata.get("IMAGERY_DATE", "")
    yield tr("Attribution"), row.get("attribution") or metadata.get("ATTRIBUTION", "")
    if row.get("crs"):
        yield tr("Pixels"), _pixels(row)
    else:
        yield tr("Zoom"), str(pose.get("zoom", ""))
    yield tr("Column, row"), f"{pose.get('column', '')}, {pose.get('row', '')}"
    for name, value in metadata.items():
        if name not in _OMITTED and not name.startswith(("TIFFTAG_", "EXIF_")):
            yield name.replace("_", " ").capitalize(), value
    yield tr("File"), str(seen.picture.path) if seen.fetched is None else seen.fetched.place


def _metres(value: float) -> str:
    return tr("{metres} m").format(metres=number_text(value, ",.0f" if value >= 1e3 else ".1f"))


def _number(values: dict[str, Any], name: str, decimals: int) -> str:
    value = values.get(name)
    return number_text(value, f".{decimals}f") if isinstance(value, (int, float)) else ""


def _height(pose: dict[str, Any], row: dict[str, str]) -> str:
    """Height above the ground and, over relief, above the ellipsoid."""
    agl, height_m = _number(pose, "agl_m", 2), _float(row.get("height_m", ""))
    if math.isnan(height_m):
        return tr("{agl} m above ground").format(agl=agl)
    return tr("{agl} m above ground, {height} m above the ellipsoid").format(
        agl=agl, height=number_text(height_m, ".2f")
    )


def _time(pose: dict[str, Any]) -> str:
    """Time of exposure, with the precision of the footprint's attribute."""
    value = pose.get("time")
    if value is None:
        return ""
    text = value.toString("yyyy-MM-dd HH:mm:ss.zzz t") if hasattr(value, "toString") else str(value)
    return text if text != "NULL" else ""


def _gsd(seen: ViewedImage) -> str:
    """Ground sample distance of the file, with a hint if the source is coarser."""
    detail_m = _float(seen.picture.metadata.get("EFFECTIVE_GSD_M_PER_PX", ""))
    if math.isnan(detail_m):
        return ""
    own_m = _file_gsd_m(seen) or detail_m
    text = gsd_text(own_m, METRES)
    # Ignore a difference of up to 2 %.
    if detail_m <= 1.02 * own_m:
        return text
    hint = tr("the source's GSD is {source}: images show no finer detail")
    return f"{text} ({hint.format(source=gsd_text(detail_m, METRES))})"


def _file_gsd_m(seen: ViewedImage) -> float | None:
    """Ground sample distance at nadir, in metres; None if neither the footprint nor the file states it."""
    from ...core.geodesy.camera import Camera
    from ...core.geodesy.mercator import PixelGrid

    pose, metadata, wide_px = seen.shot.pose, seen.picture.metadata, seen.picture.width_px
    if not wide_px or seen.row.get("crs"):
        return None
    if metadata.get("FRAME") == "camera":
        fov_deg, ratio = _float(metadata.get("FOV_DEG", "")), _float(metadata.get("ASPECT_RATIO", ""))
        if math.isnan(fov_deg + ratio):
            return None
        return float(Camera(fov_deg, ratio).ground_size_m(float(pose["agl_m"]))[0]) / wide_px
    place = (seen.row.get("Lat", ""), seen.row.get("Lon", ""), pose.get("zoom"))
    lat, lon, zoom = (_float(str(value)) for value in place)
    planned_px = _float(str(pose.get("width_px", wide_px)))
    if math.isnan(lat + lon + zoom + planned_px):
        return None
    pixel_m = PixelGrid().ground_m_per_px(np.asarray(lat), np.asarray(lon), int(zoom))
    return float(pixel_m) * planned_px / wide_px


def _pixels(row: dict[str, str]) -> str:
    """Pixel size, in its CRS, of a source that is not on the grid of web maps."""
    width, height = _float(row.get("pixel_width", "")), _float(row.get("pixel_height", ""))
    crs = row["crs"]
    # A CRS without a code is stated as WKT, which begins with the CRS's name.
    name = crs.split('"')[1] if "[" in crs and '"' in crs else crs
    if math.isnan(width) or math.isnan(height):
        return name
    return tr("{width} × {height} of {crs}").format(
        width=number_text(width, ".9g"), height=number_text(height, ".9g"), crs=name
    )


def _entropy(text: str) -> str:
    value = _float(text)
    return "" if math.isnan(value) else tr("{bits} bits").format(bits=number_text(value, ".3f"))


def _float(text: str) -> float:
    try:
        return real_number(text)
    except ValueError:
        return math.nan
