"""WMTS and WMS by their capabilities: a layer of such a service becomes a source of tiles like any other.

A layer is named ``wmts:URL#layer=NAME`` or ``wms:URL#layers=NAME``: the address of the service or of its
capabilities, and after ``#`` the choices, joined by ``&``: ``style, tilematrixset, format`` of a WMTS, ``styles,
format, version`` of a WMS. What is left out is the server's default, and PNG where it is offered, because PNG
tells ground without imagery from black or white ground. A key in the address is written ``{key}``.

Of a WMTS those tile matrix sets serve that are the Web-Mercator quad, whatever their levels are called; a WMS is asked
for tiles of that grid. OWSLib reads the documents; it is needed here only.
"""

from __future__ import annotations

import importlib
import math
import re
from collections.abc import Sequence
from functools import cached_property
from typing import Any
from urllib.parse import quote, urlencode, urljoin

from ...errors import InvalidInput, Message, SourceError
from ...geodesy.mercator import HALF_WORLD_M, HIGHEST_ZOOM
from ...text import one_line
from ..catalogue import DEFAULT_MAX_ZOOM
from ..entry import CatalogueEntry, Dates, dates_of_dimension, under_provider
from ..opening import EntrySource
from ..policy import Policy
from ..template import BBOX, KEY_ENV, environment_key
from .capabilities import (
    NAMED,
    Document,
    Offered,
    Service,
    bounds_of,
    chosen_format,
    chosen_one,
    credit_of,
    fetched,
    policy_of,
    reading,
)
from .safe_xml import written

#: Metres of a pixel at scale 1:1, by which both state scales (OGC 07-057r7, 6.1; OGC 06-042, 7.2.4.6.9).
_SCALE_PX_M = 0.28e-3
_VERSIONS = ("1.3.0", "1.1.1")
#: What EPSG:3857 goes by in a WMS, best first. In each of them east comes first, in every version.
_WMS_MERCATOR = ("EPSG:3857", "EPSG:900913", "EPSG:102100", "EPSG:102113", "EPSG:3785")
#: Documents round scales to eight digits and more; sets of another grid differ by percents.
_SCALE_TOLERANCE = 1e-6
#: Documents round corners to whole metres at worst; other grids start kilometres away.
_CORNER_TOLERANCE_M = 1.0
#: How documents of a WMTS name EPSG:3857.
_MERCATOR = re.compile(r"(^|[:/])(3857|900913|102100|102113|3785)$")
_WMTS = "{http://www.opengis.net/wmts/1.0}"
_OWS = "{http://www.opengis.net/ows/1.1}"


class ServiceLayer(EntrySource):
    """A layer of a WMTS or WMS as a mission names it."""

    @cached_property
    def service(self) -> Service:
        """The service and what is wanted of it; raises InvalidInput where the text is not right."""
        return Service.named(self.text)

    @property
    def needs_key(self) -> bool:
        """Whether a key stands in its address."""
        return "{key}" in self.text

    @property
    def stated_policy(self) -> Policy | None:
        """None: the service states its terms with its capabilities."""
        return None

    def environment_key(self) -> str | None:
        """Return the environment's key, if that is for its host."""
        return environment_key([self.service.host], named_by_user=self.options.named_by_user)

    def layers(self) -> list[Offered] | None:
        """Layers that the service offers, where none is named yet."""
        if "layer" in self.service.choices or "layers" in self.service.choices:
            return None
        document = self._document()
        with reading(document):
            return _wmts_layers(document) if self.service.kind == "wmts" else _wms_layers(document)

    def _find(self) -> CatalogueEntry:
        """Entry of the layer, from the capabilities, under its provider's terms where those are known.

        Raises
        ------
        InvalidInput
            The text, or a choice in it, is not right; says which are.
        SourceError
            OWSLib is missing, or the capabilities cannot be had or read, or offer nothing in Web Mercator.
        """
        document = self._document()
        with reading(document):
            if self.service.kind == "wmts":
                entry = _wmts_entry(self.text, document)
            else:
                entry = _wms_entry(self.text, document, self.options.tile_px or 256)
        return under_provider(entry)

    def _document(self) -> Document:
        key = None
        if self.needs_key:
            key = self.options.key or self.environment_key()
            if not key:
                raise SourceError(
                    "{0}: needs an API key: set the environment variable {1}", self.service.host, KEY_ENV
                )
        return fetched(self.service, key or "", self.options.transport)


def _entry(name: str, service: Any, layers: Sequence[Any], url: str, **tiles: Any) -> CatalogueEntry:
    """Entry of layers above each other, with what both kinds of services state of them."""
    credit = getattr(layers[0], "attribution", None) or {}
    return CatalogueEntry(
        name=name,
        title=", ".join(one_line(layer.title) or one_line(layer.id) for layer in layers),
        kind="xyz",
        attribution=credit_of(credit.get("title"), getattr(service, "provider", None)),
        urls={"": url},
        policy=policy_of(getattr(service, "identification", None)),
        key_env=KEY_ENV if "{key}" in url else None,
        bounds_deg=bounds_of(layers),
        user=True,
        **tiles,
    )


def _with_query(base: str, query: dict[str, str]) -> str:
    """Address with a query after what it may already have; placeholders stay as they are."""
    joint = "" if base.endswith(("?", "&")) else "&" if "?" in base else "?"
    return f"{base}{joint}{urlencode(query, safe='{}:/,', quote_via=quote)}"


def _quoted(value: str) -> str:
    return quote(value, safe="{}:")


def _wmts_layers(document: Document) -> list[Offered]:
    """Layers a WMTS offers."""
    return [Offered(name, one_line(layer.title)) for name, layer in _wmts(document).contents.items()]


def _wmts_entry(name: str, document: Document) -> CatalogueEntry:
    """Entry of a layer; raises InvalidInput and SourceError as `ogc.ServiceLayer` does."""
    service = _wmts(document)
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
    return _entry(
        name,
        service,
        [layer],
        url,
        tile_px=(tile_px,),
        min_zoom=zooms[0],
        max_zoom=zooms[-1],
        native_zoom=zooms[-1],
        dates=dates if "{date}" in url else None,
        levels=tuple((zoom, levels[zoom]) for zoom in zooms if levels[zoom] != str(zoom)),
    )


def _wmts(document: Document) -> Any:
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
            and 0 <= round(zoom) <= HIGHEST_ZOOM
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
    return document.without_key(_with_query(base, query))


def _wms_layers(document: Document) -> list[Offered]:
    """Layers a WMS offers."""
    _, service = _wms(document)
    return [Offered(name, one_line(layer.title)) for name, layer in service.contents.items()]


def _wms_entry(name: str, document: Document, tile_px: int) -> CatalogueEntry:
    """Entry of one layer or several above each other; raises as `ogc.ServiceLayer` does."""
    version, service = _wms(document)
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
    url = document.without_key(_with_query(urljoin(document.url, address), query))
    highest = _highest_zoom(layers, tile_px)
    return _entry(
        name, service, layers, url, tile_px=(tile_px,), max_zoom=highest, native_zoom=highest, dates=dates
    )


def _wms(document: Document) -> tuple[str, Any]:
    """Version the server answered in, and its capabilities."""
    read = importlib.import_module("owslib.wms").WebMapService
    version = document.root.get("version") or _VERSIONS[0]
    if version not in _VERSIONS:
        raise document.wrong(Message("speaks version {0}; must be {1}", version, " or ".join(_VERSIONS)))
    return version, read(document.service.address, version=version, xml=written(document.root))


def _crs(document: Document, layers: Sequence[Any]) -> str:
    offered = set.intersection(*({crs.upper() for crs in layer.crsOptions} for layer in layers))
    for crs in _WMS_MERCATOR:
        if crs in offered:
            return crs
    names = ", ".join(sorted(offered)[:NAMED]) or Message("none")
    raise InvalidInput(
        "layer {0!r} of {1}: is offered in {2}; needs {3}",
        layers[0].id,
        document.service.host,
        names,
        _WMS_MERCATOR[0],
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
