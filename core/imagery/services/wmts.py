"""Layers of a WMTS: tile matrix sets that are the Web-Mercator quad, whatever their levels are called."""

from __future__ import annotations

import importlib
import math
import re
from typing import Any
from urllib.parse import quote, urlencode, urljoin

from ...errors import InvalidInput
from ...geodesy.mercator import HALF_WORLD_M
from ...text import one_line
from ..entry import CatalogueEntry, Dates, dates_of_dimension
from ..placeholder import Placeholder
from ..template import KEY_ENV
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

#: Metres of a pixel at scale 1:1, by which WMTS states scales (OGC 07-057r7, 6.1).
_SCALE_PX_M = 0.28e-3
#: Highest zoom a pixel grid has.
_HIGHEST_ZOOM = 30
#: Documents round scales to eight digits and more; sets of another grid differ by percents.
_SCALE_TOLERANCE = 1e-6
#: Documents round corners to whole metres at worst; other grids start kilometres away.
_CORNER_TOLERANCE_M = 1.0
#: What EPSG:3857 goes by in documents.
_MERCATOR = re.compile(r"(^|[:/])(3857|900913|102100|102113|3785)$")
_WMTS = "{http://www.opengis.net/wmts/1.0}"
_OWS = "{http://www.opengis.net/ows/1.1}"


def wmts_layers(document: Document) -> list[Offered]:
    """Layers a WMTS offers."""
    return [Offered(name, one_line(layer.title)) for name, layer in _service(document).contents.items()]


def wmts_entry(name: str, document: Document) -> CatalogueEntry:
    """Entry of a layer; raises InvalidInput and SourceError as `ogc.ServiceLayer` does."""
    service = _service(document)
    choices = document.service.choices
    contents = {key: layer.title for key, layer in service.contents.items()}
    layer = service.contents[chosen_one(document, "layer", choices.get("layer"), contents)]
    matrix_set, tile_px, levels = _quad(document, service, layer)
    kind = chosen_format(document, _formats(layer))
    style = choices.get("style")
    if style is None:
        defaults = [known for known, about in layer.styles.items() if about["isDefault"]]
        style = (defaults or list(layer.styles) or [""])[0]
    elif style not in layer.styles:
        chosen_one(document, "style", style, layer.styles)
    dimensions = _dimensions(document, layer.id)
    dates = next((about for about in dimensions.values() if isinstance(about, Dates)), None)
    filled = {
        "tilematrixset": matrix_set,
        "tilematrix": "{z}",
        "tilerow": "{y}",
        "tilecol": "{x}",
        "style": style,
        "layer": layer.id,
        **{key.lower(): "{date}" if isinstance(about, Dates) else about for key, about in dimensions.items()},
    }
    url = _rest_url(document, layer, kind, filled) or _kvp_url(
        document, service, layer, kind, filled, dimensions
    )
    zooms = sorted(levels)
    return CatalogueEntry(
        name=name,
        title=one_line(layer.title) or one_line(layer.id),
        kind="xyz",
        area="",
        attribution=credit_of(None, getattr(service, "provider", None)),
        map_types=(),
        urls={"": url},
        hosts=(),
        tile_px=(tile_px,),
        min_zoom=zooms[0],
        max_zoom=zooms[-1],
        native_zoom=zooms[-1],
        dates=dates if "{date}" in url else None,
        policy=policy_of(getattr(service, "identification", None)),
        placeholder=Placeholder(),
        key_env=KEY_ENV if "{key}" in url else None,
        bounds_deg=bounds_of([layer]),
        levels=tuple((zoom, levels[zoom]) for zoom in zooms if levels[zoom] != str(zoom)),
        user=True,
    )


def _service(document: Document) -> Any:
    read = importlib.import_module("owslib.wmts").WebMapTileService
    return read(document.service.address, xml=written(document.root))


def _formats(layer: Any) -> list[str]:
    resources = [resource["format"] for resource in layer.resourceURLs if resource["resourceType"] == "tile"]
    return list(dict.fromkeys([*layer.formats, *resources]))


def _quad(document: Document, service: Any, layer: Any) -> tuple[str, int, dict[int, str]]:
    """Tile matrix set to ask for: its name, size of tiles in px, and its levels by zoom."""
    found: dict[str, tuple[int, dict[int, str]]] = {}
    for name, link in layer.tilematrixsetlinks.items():
        matrices = service.tilematrixsets[name]
        if _MERCATOR.search(matrices.crs):
            limited = link.tilematrixlimits
            quad = _levels(
                [one for one in matrices.tilematrix.values() if not limited or one.identifier in limited]
            )
            if quad is not None:
                found[name] = quad
    wanted = document.service.choices.get("tilematrixset")
    if not found:
        offered = ", ".join(
            f"{name} ({service.tilematrixsets[name].crs})" for name in list(layer.tilematrixsetlinks)[:NAMED]
        )
        raise InvalidInput(
            "layer {0!r} of {1}: has tiles in {2} only; needs a Web-Mercator quad, such as WebMercatorQuad "
            "or GoogleMapsCompatible",
            layer.id,
            document.service.host,
            one_line(offered),
        )
    if wanted is not None:
        name = chosen_one(document, "tilematrixset", wanted, {name: name for name in found})
    else:
        name = max(found, key=lambda known: (max(found[known][1]), -found[known][0]))
    return (name, *found[name])


def _levels(matrices: list[Any]) -> tuple[int, dict[int, str]] | None:
    """Size of tiles, and the levels of the Web-Mercator quad by zoom; None where the matrices are of another grid."""
    sizes = {(matrix.tilewidth, matrix.tileheight) for matrix in matrices}
    if len(sizes) != 1:
        return None
    ((width, height),) = sizes
    if width != height or width < 256 or width % 256:
        return None
    levels = {}
    for matrix in matrices:
        x_m, y_m = matrix.topleftcorner
        zoom = math.log2(2.0 * HALF_WORLD_M / (matrix.scaledenominator * _SCALE_PX_M * width))
        if (
            abs(x_m + HALF_WORLD_M) <= _CORNER_TOLERANCE_M
            and abs(y_m - HALF_WORLD_M) <= _CORNER_TOLERANCE_M
            and abs(2.0 ** (zoom - round(zoom)) - 1.0) <= _SCALE_TOLERANCE
            and 0 <= round(zoom) <= _HIGHEST_ZOOM
        ):
            levels[round(zoom)] = matrix.identifier
    if not levels:
        return None
    # Zooms have to follow each other; what lies below a gap is of no use for captures.
    highest = max(levels)
    lowest = next(zoom for zoom in range(highest, -2, -1) if zoom not in levels) + 1
    return width, {zoom: levels[zoom] for zoom in range(lowest, highest + 1)}


def _dimensions(document: Document, layer: str) -> dict[str, Dates | str]:
    """Dimensions of a layer, which OWSLib leaves out: dates of the time, the default value of any other."""
    found: dict[str, Dates | str] = {}
    for element in document.root.iter(f"{_WMTS}Layer"):
        if (element.findtext(f"{_OWS}Identifier") or "").strip() != layer:
            continue
        for dimension in element.findall(f"{_WMTS}Dimension"):
            name = (dimension.findtext(f"{_OWS}Identifier") or "").strip()
            default = (dimension.findtext(f"{_WMTS}Default") or "").strip()
            values = [value.text or "" for value in dimension.findall(f"{_WMTS}Value")]
            dates = dates_of_dimension(values, default) if name.lower() == "time" else None
            found[name] = dates or default or (values[0].strip() if values else "")
    return found


def _rest_url(document: Document, layer: Any, kind: str, filled: dict[str, str]) -> str:
    """Template of the tiles as resources; empty where the service has none of this format."""
    for resource in layer.resourceURLs:
        if resource["resourceType"] == "tile" and resource["format"] == kind:
            text = urljoin(document.url, resource["template"])
            # What is no placeholder is text, braces included, and so is what stands for one: nothing is filled twice.
            pieces = re.split(r"\{([^{}]*)\}", text)
            pieces[::2] = [piece.replace("{", "%7B").replace("}", "%7D") for piece in pieces[::2]]
            pieces[1::2] = [_quoted(filled.get(name.lower(), f"{{{name}}}")) for name in pieces[1::2]]
            return document.without_key("".join(pieces))
    return ""


def _kvp_url(
    document: Document,
    service: Any,
    layer: Any,
    kind: str,
    filled: dict[str, str],
    dimensions: dict[str, Dates | str],
) -> str:
    """Template of the tiles by GetTile with its parameters in the query."""
    base = document.url.partition("?")[0]
    for operation in service.operations:
        if operation.name == "GetTile":
            gets = [method for method in operation.methods if method["type"] == "Get"]
            asked = [method for method in gets if "kvp" in str(method["constraints"]).lower()] or gets
            base = urljoin(document.url, asked[0]["url"]) if asked else base
    query = {
        "SERVICE": "WMTS",
        "REQUEST": "GetTile",
        "VERSION": "1.0.0",
        "LAYER": layer.id,
        "STYLE": filled["style"],
        "TILEMATRIXSET": filled["tilematrixset"],
        "TILEMATRIX": "{z}",
        "TILEROW": "{y}",
        "TILECOL": "{x}",
        "FORMAT": kind,
        **{name: filled[name.lower()] for name in dimensions},
    }
    return document.without_key(with_query(base, query))


def with_query(base: str, query: dict[str, str]) -> str:
    """Address with a query after what it may already have; placeholders stay as they are."""
    joint = "" if base.endswith(("?", "&")) else "&" if "?" in base else "?"
    return f"{base}{joint}{urlencode(query, safe='{}:/,', quote_via=quote)}"


def _quoted(value: str) -> str:
    return quote(value, safe="{}:")
