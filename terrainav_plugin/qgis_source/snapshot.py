"""The project's layers at the start of a capture: copied on the main thread, drawn on others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple, Optional

import numpy as np
from qgis.core import (
    Qgis,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsExpressionContextUtils,
    QgsLabelingEngineSettings,
    QgsMapLayer,
    QgsMapSettings,
    QgsProject,
    QgsRasterLayer,
    QgsRasterMinMaxOrigin,
    QgsRasterProjector,
    QgsReadWriteContext,
)
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QColor
from qgis.PyQt.QtXml import QDomDocument

from ...core.errors import InvalidInput
from ...core.geodesy.mercator import HALF_WORLD_M, HIGHEST_ZOOM, PixelGrid, extent_of_outline, fitting_zoom
from ...core.imagery.policy import Policy
from ...core.imagery.raster.georeference import RasterGeoreference
from ...core.imagery.raster.reading import Facts
from ...core.imagery.raster.sizes import check_block, check_counts
from ..compat import RASTER, attribution
from ..i18n import tr
from ..map.mission_group import ROLE
from ..tasks import crs_named, required_crs
from .connections import is_connection
from .renderer import Pipes
from .terms import policies
from .tiles import ServerTiles, TileAddress, tile_address

#: Prefix of sources that QGIS draws.
PREFIX = "qgis:"
PROJECT_SOURCE = f"{PREFIX}project"
_LAYER = f"{PREFIX}layer/"
#: QGIS's provider of raster files, which reads files directly; other raster providers request a service.
FILE_PROVIDER = "gdal"
_MERCATOR = "EPSG:3857"
#: Highest zoom of layers without a resolution.
_MAX_ZOOM = 22
#: Tile address by layer id; None for layers that have no tile address.
Addresses = dict[str, Optional[TileAddress]]


class LayerChoice(NamedTuple):
    """A layer of the project, or all of them, as a source."""

    name: str
    title: str


@dataclass(frozen=True)
class Snapshot:
    """Copies of the layers to draw, independent of the project. Create and release on the main thread.

    Parameters
    ----------
    name, title, attribution, date : str
        As in a source.
    grid : PixelGrid
    ground : tuple of Pipes or ServerTiles
        Rasters that have only rasters below them, the lowest first.
    policy : Policy
        The strictest policy of the tiles' providers.
    drawing : tuple of QgsMapLayer
        The layers above the ground, the uppermost first.
    settings : QgsMapSettings
        Settings of the map, without layers, extent and size.
    paper : QColor
        Background colour of the map.
    """

    name: str
    title: str
    attribution: str
    date: str
    grid: PixelGrid
    ground: tuple[Pipes | ServerTiles, ...]
    policy: Policy
    drawing: tuple[QgsMapLayer, ...]
    settings: QgsMapSettings
    paper: QColor


def is_of_qgis(name: str) -> bool:
    """Whether QGIS draws a source."""
    return name.startswith(PREFIX) and not is_connection(name)


def source_name(layer: QgsMapLayer) -> str:
    """Name of the source for a layer."""
    return f"{_LAYER}{layer.id()}"


def layer_choices(project: QgsProject) -> list[LayerChoice]:
    """Sources of a project: the whole map, and each layer that can be drawn; empty if there is no such layer."""
    layers = list(_layers_that_show(project))
    if not layers:
        return []
    whole = LayerChoice(PROJECT_SOURCE, tr("Whole map"))
    return [whole, *(LayerChoice(source_name(layer), layer.name()) for layer in layers)]


def raster_around(layer: QgsMapLayer, project: QgsProject) -> str:
    """Source of the uppermost raster on the map that holds a layer's extent; empty without one."""
    root = project.layerTreeRoot()
    for raster in _layers_that_show(project):
        node = root.findLayer(raster)
        if raster.type() != RASTER or node is None or not node.isVisible():
            continue
        try:
            way = QgsCoordinateTransform(layer.crs(), raster.crs(), project)
            if raster.extent().contains(way.transformBoundingBox(layer.extent())):
                return source_name(raster)
        except QgsCsException:
            # The layer's ground has no place in the raster's system.
            continue
    return ""


def source_layers(name: str, project: QgsProject) -> list[QgsMapLayer]:
    """Layers of a source, the uppermost first.

    Raises
    ------
    InvalidInput
        The layer does not exist, or cannot be drawn.
    """
    if name == PROJECT_SOURCE:
        root = project.layerTreeRoot()
        shown = [
            layer
            for layer in _layers_that_show(project)
            if (node := root.findLayer(layer)) is not None and node.isVisible()
        ]
        if not shown:
            raise InvalidInput(tr("the map shows no layer: tick one in the Layers panel"))
        return shown
    layer = project.mapLayer(name[len(_LAYER) :]) if name.startswith(_LAYER) else None
    if layer is None:
        raise InvalidInput(
            tr("source {name}: the project has no such layer (any more); choose another source").format(name=name)
        )
    if not (layer.isValid() and layer.isSpatial()):
        raise InvalidInput(tr("layer {name}: shows nothing; repair its data source").format(name=layer.name()))
    return [layer]


def source_title(name: str, project: QgsProject) -> str:
    """Title of a source, shown to users."""
    return tr("Whole map") if name == PROJECT_SOURCE else source_layers(name, project)[0].name()


def grid_of_layers(name: str, project: QgsProject) -> PixelGrid:
    """Pixel grid of a source; raises InvalidInput as `source_layers`. Main thread only."""
    layers = source_layers(name, project)
    return _grid(name, layers, _addresses(layers), project)


def _grid(name: str, layers: list[QgsMapLayer], addresses: Addresses, project: QgsProject) -> PixelGrid:
    _refuse_placeless(layers)
    _refuse_large(layers)
    own = None if name == PROJECT_SOURCE else _raster_grid(layers[0])
    if own is not None:
        return own
    native = max(_native_zoom(layer, addresses[layer.id()], project) for layer in layers)
    extent = _extent(layers[0], project) if len(layers) == 1 else None
    return PixelGrid(max_zoom=max(native, _MAX_ZOOM), native_zoom=native, extent=extent)


def take_snapshot(name: str, project: QgsProject) -> Snapshot:
    """Snapshot of a source's layers as shown now; raises InvalidInput as `source_layers`. Main thread only."""
    layers = source_layers(name, project)
    addresses, ground = _addresses(layers), _ground(layers)
    grid = _grid(name, layers, addresses, project)
    drawing = layers[: len(layers) - len(ground)]
    return Snapshot(
        name=name,
        title=source_title(name, project),
        attribution=_attribution(layers),
        date=_date(layers[0]) if len(layers) == 1 else "",
        grid=grid,
        ground=tuple(_drawn(layer, addresses[layer.id()], project) for layer in ground),
        policy=next((policy for policy, _ in policies(layers)), Policy()),
        drawing=tuple(_copy(layer, project) for layer in drawing),
        settings=_settings(project, crs_named(grid.plane.crs)),
        paper=project.backgroundColor(),
    )


def policies_of_layers(name: str, project: QgsProject) -> list[tuple[Policy, str]]:
    """Terms of all providers that a source uses, as from `terms.policies`.

    Raises InvalidInput as `source_layers`.
    """
    return policies(source_layers(name, project))


def _addresses(layers: Iterable[QgsMapLayer]) -> Addresses:
    """Tile addresses by layer id."""
    return {layer.id(): tile_address(layer) if isinstance(layer, QgsRasterLayer) else None for layer in layers}


def _drawn(layer: QgsRasterLayer, address: TileAddress | None, project: QgsProject) -> Pipes | ServerTiles:
    copy = _copy(layer, project)
    return Pipes(copy) if address is None else address.tiles(copy)


def _layers_that_show(project: QgsProject) -> Iterator[QgsMapLayer]:
    for layer in project.layerTreeRoot().layerOrder():
        role = str(layer.customProperty(ROLE) or "")
        # Of the plugin's layers, only backgrounds are imagery; the others are results.
        if layer.isValid() and layer.isSpatial() and (not role or role.startswith("background/")):
            yield layer


def _ground(layers: list[QgsMapLayer]) -> list[QgsRasterLayer]:
    ground: list[QgsRasterLayer] = []
    for layer in reversed(layers):
        if not isinstance(layer, QgsRasterLayer):
            break
        ground.append(layer)
    return ground


def _copy(layer: QgsMapLayer, project: QgsProject) -> QgsMapLayer:
    """Copy of a layer for drawing on any thread, with all settings that affect its pixels."""
    copy = layer.clone()
    times = layer.temporalProperties()
    if times is not None and times.isActive():
        # Before 3.40, QGIS's copies lack the temporal settings.
        style, kind = QDomDocument(), QgsMapLayer.StyleCategory.Temporal
        layer.exportNamedStyle(style, QgsReadWriteContext(), kind)
        copy.importNamedStyle(style, kind)
    if isinstance(copy, QgsRasterLayer):
        _keep_reading(layer, copy)
        _fix_style(copy, project)
    copy.moveToThread(None)
    return copy


def _keep_reading(layer: QgsRasterLayer, copy: QgsRasterLayer) -> None:
    """Apply to a copy the settings with which its layer reads the raster: QGIS opens copies with defaults."""
    own, new = layer.dataProvider(), copy.dataProvider()
    for band in range(1, min(own.bandCount(), new.bandCount()) + 1):
        new.setUserNoDataValue(band, own.userNoDataValues(band))
        new.setUseSourceNoDataValue(band, own.useSourceNoDataValue(band))
    new.enableProviderResampling(own.isProviderResamplingEnabled())
    new.setZoomedInResamplingMethod(own.zoomedInResamplingMethod())
    new.setZoomedOutResamplingMethod(own.zoomedOutResamplingMethod())
    new.setMaxOversampling(own.maxOversampling())
    copy.setResamplingStage(layer.resamplingStage())


def _fix_style(copy: QgsRasterLayer, project: QgsProject) -> None:
    """Make the style of a raster independent of the extent drawn."""
    projector = copy.pipe().projector()
    if projector is not None:
        projector.setPrecision(QgsRasterProjector.Precision.Exact)
    context = project.createExpressionContext()
    context.appendScope(QgsExpressionContextUtils.layerScope(copy))
    copy.pipe().evaluateDataDefinedProperties(context)
    # A contrast stretch that follows the map's extent would differ between the parts of an image.
    origin = QgsRasterMinMaxOrigin(copy.renderer().minMaxOrigin())
    origin.setExtent(QgsRasterMinMaxOrigin.Extent.WholeRaster)
    copy.renderer().setMinMaxOrigin(origin)


def _refuse_placeless(layers: list[QgsMapLayer]) -> None:
    """Refuse layers without a CRS, which QGIS would draw as if they had the map's CRS."""
    for layer in layers:
        required_crs(layer.crs(), layer.name())


def _refuse_large(layers: list[QgsMapLayer]) -> None:
    """Refuse raster files of which QGIS would decode too much for each part, on every drawing thread."""
    for layer in layers:
        if isinstance(layer, QgsRasterLayer) and layer.providerType() == FILE_PROVIDER:
            raster = layer.dataProvider()
            try:
                check_counts(raster.bandCount(), 0)
                check_block(raster.xBlockSize(), raster.yBlockSize(), raster.dataTypeSize(1))
            except InvalidInput as wrong:
                raise InvalidInput("{0}: {1}", layer.name(), wrong) from wrong


def _settings(project: QgsProject, crs: QgsCoordinateReferenceSystem) -> QgsMapSettings:
    from qgis.utils import iface

    settings = QgsMapSettings()
    settings.setDestinationCrs(crs)
    settings.setTransformContext(project.transformContext())
    settings.setEllipsoid(project.ellipsoid())
    # As on screen: the resolution determines sizes in millimetres and scale-dependent visibility.
    settings.setOutputDpi(96)
    settings.setBackgroundColor(QColor(Qt.GlobalColor.transparent))
    # Images adjoin: fills and lines must continue in the next image.
    for flag in ("Antialiasing", "DrawLabeling", "UseAdvancedEffects", "RenderMapTile"):
        settings.setFlag(getattr(QgsMapSettings.Flag, flag), True)
    labels = project.labelingEngineSettings()
    labels.setFlag(QgsLabelingEngineSettings.Flag.UsePartialCandidates, False)
    settings.setLabelingEngineSettings(labels)
    settings.setExpressionContext(project.createExpressionContext())
    shown = None if iface is None else iface.mapCanvas().mapSettings()
    if shown is not None and shown.isTemporal():
        settings.setIsTemporal(True)
        settings.setTemporalRange(shown.temporalRange())
    return settings


def _raster_grid(layer: QgsMapLayer) -> PixelGrid | None:
    """Pixel grid of a raster file in a projected CRS, in any style; None for layers drawn on the map's grid."""
    if not isinstance(layer, QgsRasterLayer) or layer.providerType() != FILE_PROVIDER:
        return None
    box, width, height = layer.extent(), layer.width(), layer.height()
    wkt = layer.crs().toWkt(QgsCoordinateReferenceSystem.WktVariant.WKT_PREFERRED)
    if not wkt or width < 1 or height < 1:
        return None
    corner = (box.xMinimum(), box.width() / width, 0.0, box.yMaximum(), 0.0, -box.height() / height)
    try:
        place = RasterGeoreference(Facts((), ((width, height),), wkt, corner, {}))
        own = place.own_plane()
    except InvalidInput:
        # The layer is outside the domain of a CRS, which is reported elsewhere.
        return None
    if own is None:
        return None
    plane, native = own
    # Images on the raster's grid can be enlarged by up to 6 zooms.
    highest = min(native + 6, HIGHEST_ZOOM)
    return PixelGrid(max_zoom=highest, native_zoom=native, extent=place.own_extent(native), plane=plane)


def _native_zoom(layer: QgsMapLayer, address: TileAddress | None, project: QgsProject) -> int:
    """Highest zoom at which the layer gains detail; `_MAX_ZOOM` if it has detail at every scale."""
    if not isinstance(layer, QgsRasterLayer):
        return _MAX_ZOOM
    if layer.providerType() != FILE_PROVIDER:
        stated = None if address is None else address.highest_zoom
        return _MAX_ZOOM if stated is None else min(stated, _MAX_ZOOM)
    share = _mercator_m_per_px(layer, project) / (2.0 * HALF_WORLD_M)
    # Zoom 27 has a millimetre per pixel, like the finest rasters.
    # Files round their resolution: 0.1 % off a zoom's resolution still counts as that zoom.
    return min(max(fitting_zoom(share, 1.0, 1e-3), 0), 27)


def _mercator_m_per_px(layer: QgsRasterLayer, project: QgsProject) -> float:
    """Metres of EPSG:3857 per px near the middle of a raster; raises InvalidInput outside its domain."""
    transform = QgsCoordinateTransform(layer.crs(), QgsCoordinateReferenceSystem(_MERCATOR), project)
    middle = layer.extent().center()
    try:
        here = transform.transform(middle)
        east = transform.transform(middle.x() + layer.rasterUnitsPerPixelX(), middle.y())
        north = transform.transform(middle.x(), middle.y() + layer.rasterUnitsPerPixelY())
    except QgsCsException as wrong:
        raise InvalidInput(
            tr("layer {name}: its place on the globe is not known; set its CRS").format(name=layer.name())
        ) from wrong
    size = min(here.distance(east), here.distance(north))
    if not (0.0 < size < 2.0 * HALF_WORLD_M):
        raise InvalidInput(tr("layer {name}: its pixels have no size").format(name=layer.name()))
    return size


def _extent(layer: QgsMapLayer, project: QgsProject) -> tuple[tuple[float, float], ...] | None:
    """Extent of a raster file's imagery in world fractions; None for other layers."""
    if not isinstance(layer, QgsRasterLayer) or layer.providerType() != FILE_PROVIDER:
        return None
    transform = QgsCoordinateTransform(layer.crs(), QgsCoordinateReferenceSystem(_MERCATOR), project)
    box, middle = layer.extent(), layer.extent().center()
    west, south, east, north = box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum()
    outline = [(west, north), (east, north), (east, south), (west, south)]
    outline += [(middle.x(), north), (east, middle.y()), (middle.x(), south), (west, middle.y())]
    try:
        places = [transform.transform(x, y) for x, y in outline]
    except QgsCsException:
        return None
    return extent_of_outline(np.array([place.x() for place in places]), np.array([place.y() for place in places]))


def _attribution(layers: list[QgsMapLayer]) -> str:
    """Rights and attributions of layers, without repetition."""
    words: dict[str, None] = {}
    for layer in layers:
        stated = [*layer.metadata().rights(), attribution(layer)]
        words.update(dict.fromkeys(text.strip() for text in stated if text and text.strip()))
    return "; ".join(words)


def _date(layer: QgsMapLayer) -> str:
    """Date of a layer's metadata as YYYY-MM-DD; empty if there is none."""
    times = layer.temporalProperties()
    if not (isinstance(layer, QgsRasterLayer) and times is not None and times.isActive()):
        return ""
    if times.mode() != Qgis.RasterTemporalMode.FixedTemporalRange:
        return ""
    begin = times.fixedTemporalRange().begin()
    return begin.date().toString(Qt.DateFormat.ISODate) if begin.isValid() else ""
