"""Layers of a WMS, asked for as tiles of the Web-Mercator grid."""

from __future__ import annotations

import importlib
import math
from collections.abc import Sequence
from typing import Any
from urllib.parse import urljoin

from ...errors import InvalidInput, Message
from ...geodesy.mercator import HALF_WORLD_M
from ...text import one_line
from ..catalogue import DEFAULT_MAX_ZOOM
from ..entry import CatalogueEntry, Dates, dates_of_dimension
from ..placeholder import Placeholder
from ..template import BBOX, KEY_ENV
from .capabilities import (
    NAMED,
    Document,
    Offered,
    bounds_of,
    chosen_format,
    chosen_one,
    credit_of,
    policy_of,
)
from .safe_xml import written
from .wmts import with_query

VERSIONS = ("1.3.0", "1.1.1")
#: What EPSG:3857 goes by, best first. In each of them east comes first, in every version (EPSG lists its axes so).
MERCATOR = ("EPSG:3857", "EPSG:900913", "EPSG:102100", "EPSG:102113", "EPSG:3785")
#: Metres of a pixel at scale 1:1, by which WMS states scales (OGC 06-042, 7.2.4.6.9).
_SCALE_PX_M = 0.28e-3


def wms_layers(document: Document) -> list[Offered]:
    """Layers a WMS offers."""
    _, service = _service(document)
    return [Offered(name, one_line(layer.title)) for name, layer in service.contents.items()]


def wms_entry(name: str, document: Document, tile_px: int) -> CatalogueEntry:
    """Entry of one layer or several above each other; raises as `ogc.ServiceLayer` does."""
    version, service = _service(document)
    choices = document.service.choices
    contents = {key: layer.title for key, layer in service.contents.items()}
    wanted = choices.get("layers")
    names = [
        chosen_one(document, "layers", one, contents) for one in (wanted.split(",") if wanted else [None])
    ]
    layers = [service.contents[one] for one in names]
    styles = choices.get("styles", "," * (len(layers) - 1)).split(",")
    _check_styles(document, layers, styles)
    get_map = service.getOperationByName("GetMap")
    kind = chosen_format(document, list(get_map.formatOptions))
    dates = _dates(layers)
    query = {
        "SERVICE": "WMS",
        "VERSION": version,
        "REQUEST": "GetMap",
        "LAYERS": ",".join(names),
        "STYLES": ",".join(styles),
        "CRS" if version == "1.3.0" else "SRS": _crs(document, layers),
        "BBOX": f"{{{BBOX}}}",
        "WIDTH": str(tile_px),
        "HEIGHT": str(tile_px),
        "FORMAT": kind,
        "TRANSPARENT": "TRUE" if "png" in kind else "FALSE",
        **({"TIME": "{date}"} if dates else {}),
    }
    address = next(method["url"] for method in get_map.methods if method["type"] == "Get")
    url = document.without_key(with_query(urljoin(document.url, address), query))
    highest = _highest_zoom(layers, tile_px)
    return CatalogueEntry(
        name=name,
        title=", ".join(one_line(layer.title) or one_line(layer.id) for layer in layers),
        kind="xyz",
        area="",
        attribution=credit_of((getattr(layers[0], "attribution", None) or {}).get("title"), service.provider),
        map_types=(),
        urls={"": url},
        hosts=(),
        tile_px=(tile_px,),
        min_zoom=0,
        max_zoom=highest,
        native_zoom=highest,
        dates=dates,
        policy=policy_of(service.identification),
        placeholder=Placeholder(),
        key_env=KEY_ENV if "{key}" in url else None,
        bounds_deg=bounds_of(layers),
        user=True,
    )


def _service(document: Document) -> tuple[str, Any]:
    """Version the server answered in, and its capabilities."""
    read = importlib.import_module("owslib.wms").WebMapService
    version = document.root.get("version") or VERSIONS[0]
    if version not in VERSIONS:
        raise document.wrong(Message("speaks version {0}; must be {1}", version, " or ".join(VERSIONS)))
    return version, read(document.service.address, version=version, xml=written(document.root))


def _crs(document: Document, layers: Sequence[Any]) -> str:
    offered = set.intersection(*({crs.upper() for crs in layer.crsOptions} for layer in layers))
    for crs in MERCATOR:
        if crs in offered:
            return crs
    names = ", ".join(sorted(offered)[:NAMED]) or Message("none")
    raise InvalidInput(
        "layer {0!r} of {1}: is offered in {2}; needs {3}",
        layers[0].id,
        document.service.host,
        names,
        MERCATOR[0],
    )


def _check_styles(document: Document, layers: Sequence[Any], styles: Sequence[str]) -> None:
    if len(styles) != len(layers):
        raise InvalidInput("styles {0!r}: must be one for each of {1} layers", ",".join(styles), len(layers))
    for layer, style in zip(layers, styles):
        if style and style not in layer.styles:
            chosen_one(document, "styles", style, layer.styles)


def _dates(layers: Sequence[Any]) -> Dates | None:
    """Dates of the first layer that has a time."""
    for layer in layers:
        default = getattr(layer, "defaulttimeposition", None) or ""
        dates = dates_of_dimension(layer.timepositions or [], default)
        if dates is not None:
            return dates
    return None


def _highest_zoom(layers: Sequence[Any], tile_px: int) -> int:
    """Highest zoom at which every layer is drawn, as far as the service says so."""
    highest = DEFAULT_MAX_ZOOM
    for layer in layers:
        stated = getattr(layer, "min_scale_denominator", None)
        least = float(stated.text) if stated is not None else 0.0
        if least > 0.0:
            zoom = math.log2(2.0 * HALF_WORLD_M / (least * _SCALE_PX_M * tile_px))
            highest = min(highest, max(math.floor(zoom + 1e-9), 0))
    return highest
