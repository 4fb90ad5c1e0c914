"""Layers that Processing has loaded, in their groups: of a capture, and a benchmark's reference, queries and errors."""

from __future__ import annotations

from collections.abc import Collection
from functools import lru_cache
from pathlib import Path

from qgis.core import (
    QgsMapLayer,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingLayerPostProcessorInterface,
    QgsVectorLayer,
)
from qgis.PyQt import sip

from ..i18n import tr
from ..map.mission_group import ROLE, MissionGroup
from ..paths import style
from ..plain import escaped_field
from .layers import hide_antimeridian

#: Roles of layers in the group, and positions at its top and bottom.
REFERENCE, QUERIES, ERRORS, MOSAIC = "reference", "queries", "errors", "mosaic"
_TOP, _BOTTOM = 0, -1


def group_post_processor(folder: Path, role: str, known: Collection[str]) -> QgsProcessingLayerPostProcessorInterface:
    """Style a layer that Processing has loaded, and move it into the group of the dataset's or benchmark's folder.

    Parameters
    ----------
    role : str
        `REFERENCE`, `CAPTURED`, or `QUERIES`, `ERRORS` or `MOSAIC` with ``/`` and a name.
    known : collection of str
        Ids of the project's earlier layers; a layer of the same file is reused instead of a new one.
    """
    waiting = _waiting()
    waiting[:] = [one for one in waiting if not sip.isdeleted(one)]
    waiting.append(_IntoGroup(folder, role, known))
    return waiting[-1]


@lru_cache(None)
def _waiting() -> list[_IntoGroup]:
    """Post-processors that Processing will still use: it owns their C++ objects, but not their Python wrappers."""
    return []


class _IntoGroup(QgsProcessingLayerPostProcessorInterface):
    def __init__(self, folder: Path, role: str, known: Collection[str]) -> None:
        super().__init__()
        self._folder, self._role, self._known = folder, role, known

    def postProcessLayer(
        self,
        layer: QgsMapLayer,
        context: QgsProcessingContext,
        feedback: QgsProcessingFeedback,  # noqa: ARG002  QGIS passes it
    ) -> None:
        """Move and style the layer, on the main thread."""
        if layer.id() in self._known:
            # A layer of an earlier run, or added by the user: it keeps its place.
            layer.reload()
            layer.triggerRepaint()
            return
        kind = self._role.partition("/")[0]
        is_raster = kind in (REFERENCE, MOSAIC)
        if not is_raster:
            (_dress_errors if kind == ERRORS else _dress_footprints)(layer)
        project = context.project()
        loaded = project.layerTreeRoot().findLayer(layer.id())
        at = _BOTTOM if is_raster else _TOP
        group = MissionGroup(project, self._folder)
        group.add(layer, self._role, at).setExpanded(kind == ERRORS)
        if loaded is not None:
            loaded.parent().removeChildNode(loaded)
        if kind == ERRORS:
            # Figures of earlier scores would stand beside those of the same queries.
            for node in group.made().findLayers():
                if node.layerId() in self._known and str(node.layer().customProperty(ROLE)).startswith(ERRORS):
                    node.setItemVisibilityChecked(False)


def _dress_footprints(layer: QgsVectorLayer) -> None:
    """Style footprints as those of a capture in the panel."""
    layer.loadNamedStyle(style("captured"))
    hide_antimeridian(layer)
    layer.setMapTipTemplate(f"<b>{escaped_field('name')}</b>")


def _dress_errors(layer: QgsVectorLayer) -> None:
    """Show the true places of queries in the colour of the error, with lines to the answers."""
    layer.loadNamedStyle(style("errors"))
    classes = (
        tr("up to 1 m"),
        tr("1 to 3 m"),
        tr("3 to 5 m"),
        tr("5 to 10 m"),
        tr("10 to 20 m"),
        tr("more than 20 m"),
        tr("not answered"),
    )
    for rule, label in zip(layer.renderer().rootRule().children(), classes):
        rule.setLabel(label)
    titles = {
        "query": tr("Query"),
        "imagery": tr("Imagery"),
        "error_m": tr("Error (metres)"),
        "error_deg": tr("Error of the attitude (degrees)"),
        "rank": tr("Rank of the first right tile"),
        "predicted_lat_deg": tr("Latitude of the answer"),
        "predicted_lon_deg": tr("Longitude of the answer"),
    }
    for name, title in titles.items():
        layer.setFieldAlias(layer.fields().indexOf(name), title)
    error = "[% coalesce(format_number(\"error_m\", 2) || ' m', '–') %]"
    error_text = tr("error: {error}").format(error=error)
    layer.setMapTipTemplate(f"<b>{escaped_field('query')}</b><br/>{error_text}")
