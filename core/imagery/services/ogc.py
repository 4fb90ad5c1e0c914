"""Layers of WMTS and WMS as sources of tiles, by the capabilities of the service.

A layer is named ``wmts:URL#layer=NAME`` or ``wms:URL#layers=NAME``. URL is the address of the service or of its
capabilities. Further choices after ``#``, joined by ``&``, are ``style, tilematrixset, format`` for a WMTS and
``styles, format, version`` for a WMS. By default, the server's defaults apply, and PNG if available, as PNG
distinguishes ground without imagery from black or white ground. A key in the address is written ``{key}``.

The coordinate reference system is the wanted one; otherwise Web Mercator if available, with any names of levels;
otherwise the projected system whose area of use suits the layer best. For a WMTS, it must be the system of a tile
matrix set (`matrices`). A WMS draws tiles of the Web-Mercator grid, or of a plane of the system, which begins 2**26
units west and north of the origin and has pixels of 1, 2, 4 … and 1/2, 1/4, 1/8 … units. OWSLib, which only this module
needs, reads the documents.
"""

from __future__ import annotations

import importlib
import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any
from urllib.parse import quote, urlencode, urljoin

from ...errors import InvalidInput, Message
from ...geodesy.mercator import HALF_WORLD_M
from ...geodesy.planes import ProjectedPlane
from ...numbers import real_number
from ...text.plain import one_line
from ...text.safe_xml import written
from ..catalogue import DEFAULT_MAX_ZOOM
from ..entry import CatalogueEntry, Dates, time_dimension_dates
from ..systems import MAP, MERCATOR_CODES, Bounds, best_system, epsg_code, is_usable, northing_first, refused
from ..tiles import BBOX, KEY_ENV, OWN_BBOX, OWN_BBOX_YX
from .capabilities import (
    NAMED,
    Document,
    Offered,
    chosen_format,
    chosen_one,
    fetch_capabilities,
    filled_template,
    media_type,
    read_bounds,
    read_credit,
    read_policy,
)
from .matrices import SCALE_PX_M, chosen_tiles
from .service import ServiceSource

#: EPSG code, as a WMS states it.
_EPSG = re.compile(r"EPSG:[1-9][0-9]{0,6}")
#: Most systems of a layer to consider, as services may list thousands.
_MOST_SYSTEMS = 500
#: Most systems and tile matrix sets of each layer in a list of layers.
_MOST_OFFERED = 50
_WMTS = "{http://www.opengis.net/wmts/1.0}"
_OWS = "{http://www.opengis.net/ows/1.1}"


class ServiceLayer(ServiceSource):
    """A layer of a WMTS or WMS as a mission names it."""

    def layers(self) -> list[Offered] | None:
        """Layers of the service if none is named yet; otherwise None."""
        if "layer" in self.service.choices or "layers" in self.service.choices:
            return None
        return super().layers()

    def _layers(self, document: Document) -> list[Offered]:
        return _wmts_layers(document) if self.service.kind == "wmts" else _wms_layers(document)

    def _entry(self, document: Document) -> CatalogueEntry:
        options = self.options
        if self.service.kind == "wmts":
            return _wmts_entry(self.text, document, options.crs, options.area_deg)
        return _wms_entry(self.text, document, options.tile_px or 256, options.crs, options.area_deg)

    def _document(self) -> Document:
        return fetch_capabilities(self.service, self.key, self.options.transport)


def _entry(name: str, service: Any, layers: Sequence[Any], url: str, **tiles: Any) -> CatalogueEntry:
    """Entry of a layer, or of several layers drawn over each other."""
    credit = getattr(layers[0], "attribution", None) or {}
    return CatalogueEntry(
        name=name,
        title=", ".join(one_line(layer.title) or one_line(layer.id) for layer in layers),
        kind="xyz",
        attribution=read_credit(credit.get("title"), getattr(service, "provider", None)),
        urls={"": url},
        policy=read_policy(getattr(service, "identification", None)),
        key_env=KEY_ENV if "{key}" in url else None,
        bounds_deg=read_bounds(layers),
        user=True,
        **tiles,
    )


def _append_query(base: str, query: dict[str, str]) -> str:
    """Add parameters to the query of an address; placeholders are kept."""
    joint = "" if base.endswith(("?", "&")) else "&" if "?" in base else "?"
    return f"{base}{joint}{urlencode(query, safe='{}:/,', quote_via=quote)}"


def _wmts_layers(document: Document) -> list[Offered]:
    """Layers of a WMTS."""
    service = _wmts(document)
    systems = {name: epsg_code(one.crs) for name, one in service.tilematrixsets.items()}
    offered = []
    for name, layer in service.contents.items():
        sets = [one for one in layer.tilematrixsetlinks if one in systems][:_MOST_OFFERED]
        codes = dict.fromkeys(systems[one] for one in sets)
        usable = tuple(code for code in codes if code == MAP or is_usable(code))
        offered.append(Offered(name, one_line(layer.title), usable, tuple(map(one_line, sets))))
    dates = _dates_of_layers(document)
    return [replace(one, dates=dates.get(one.name)) for one in offered]


def _dates_of_layers(document: Document) -> dict[str, Dates]:
    """Dates of the layers of a WMTS, by layer name."""
    found = {}
    for element in document.root.iter(f"{_WMTS}Layer"):
        times = [about for about in _read_dimensions(element).values() if isinstance(about, Dates)]
        if times:
            found[(element.findtext(f"{_OWS}Identifier") or "").strip()] = times[0]
    return found


def _wmts_entry(name: str, document: Document, crs: str, area_deg: Bounds | None) -> CatalogueEntry:
    """Entry of a layer; raises InvalidInput and SourceError as `ServiceSource._find` does."""
    service = _wmts(document)
    choices = document.service.choices
    contents = {key: layer.title for key, layer in service.contents.items()}
    layer = service.contents[chosen_one(document, "layer", choices.get("layer"), contents)]
    chosen = chosen_tiles(document, service, layer, crs, area_deg)
    kind = chosen_format(document, _formats(layer))
    # For a style without a name, GeoWebCache writes an empty identifier, which OWSLib returns as None.
    styles = {(known or "").strip(): about["isDefault"] for known, about in layer.styles.items()}
    style = choices.get("style")
    if style is None:
        style = next((known for known, is_default in styles.items() if is_default), next(iter(styles), ""))
    elif style not in styles:
        chosen_one(document, "style", style, dict.fromkeys(styles, ""))
    dimensions = _dimensions(document, layer.id)
    dates = next((about for about in dimensions.values() if isinstance(about, Dates)), None)
    filled = {
        "tilematrixset": chosen.name,
        "tilematrix": "{z}",
        "tilerow": "{y}",
        "tilecol": "{x}",
        "style": style,
        "layer": layer.id,
        **{key.lower(): "{date}" if isinstance(about, Dates) else about for key, about in dimensions.items()},
    }
    url = _rest_url(document, layer, kind, filled) or _kvp_url(document, service, layer, kind, filled, dimensions)
    zooms = sorted(chosen.levels)
    return _entry(
        name,
        service,
        [layer],
        url,
        tile_px=(chosen.tile_px,),
        min_zoom=zooms[0],
        max_zoom=zooms[-1],
        native_zoom=zooms[-1],
        dates=dates if "{date}" in url else None,
        levels=tuple((zoom, chosen.levels[zoom]) for zoom in zooms if chosen.levels[zoom] != str(zoom)),
        plane=chosen.plane,
        tile_limits=chosen.limits,
    )


def _wmts(document: Document) -> Any:
    read = importlib.import_module("owslib.wmts").WebMapTileService
    return read(document.service.address, xml=written(document.root))


def _formats(layer: Any) -> list[str]:
    resources = [resource["format"] for resource in layer.resourceURLs if resource["resourceType"] == "tile"]
    return [kind for kind in dict.fromkeys([*layer.formats, *resources]) if kind]


def _dimensions(document: Document, layer: str) -> dict[str, Dates | str]:
    """Dimensions of a layer, which OWSLib ignores: dates of the time dimension, defaults of all others."""
    found: dict[str, Dates | str] = {}
    for element in document.root.iter(f"{_WMTS}Layer"):
        if (element.findtext(f"{_OWS}Identifier") or "").strip() == layer:
            found.update(_read_dimensions(element))
    return found


def _read_dimensions(layer: Any) -> dict[str, Dates | str]:
    """Dimensions in the XML element of a layer."""
    found: dict[str, Dates | str] = {}
    for dimension in layer.findall(f"{_WMTS}Dimension"):
        name = (dimension.findtext(f"{_OWS}Identifier") or "").strip()
        default = (dimension.findtext(f"{_WMTS}Default") or "").strip()
        values = [value.text or "" for value in dimension.findall(f"{_WMTS}Value")]
        dates = time_dimension_dates(values, default) if name.lower() == "time" else None
        found[name] = dates or default or (values[0].strip() if values else "")
    return found


def _rest_url(document: Document, layer: Any, kind: str, filled: dict[str, str]) -> str:
    """Template of tiles as REST resources; empty if the service has none in this format."""
    tiles = [one for one in layer.resourceURLs if one["resourceType"] == "tile"]
    # Some servers spell a format differently in the list of formats and in the resource.
    same = [one for one in tiles if one["format"] == kind]
    same += [one for one in tiles if media_type(one["format"]) == media_type(kind)]
    return filled_template(document, same[0]["template"], filled) if same else ""


def _kvp_url(
    document: Document,
    service: Any,
    layer: Any,
    kind: str,
    filled: dict[str, str],
    dimensions: dict[str, Dates | str],
) -> str:
    """Template of tiles requested by GetTile, with parameters in the query."""
    base = document.url.partition("?")[0]
    for operation in service.operations:
        if operation.name == "GetTile":
            gets = [method for method in operation.methods if method["type"] == "Get"]
            preferred = [method for method in gets if "kvp" in str(method["constraints"]).lower()] or gets
            base = urljoin(document.url, preferred[0]["url"]) if preferred else base
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
    return document.without_key(_append_query(base, query))


def _wms_layers(document: Document) -> list[Offered]:
    """Layers of a WMS."""
    _, service = _wms(document)
    # Layers share lists of systems, so examine each list once.
    known: dict[tuple[str, ...], tuple[str, ...]] = {}
    offered = []
    for name, layer in service.contents.items():
        named = tuple(layer.crsOptions)
        if named not in known:
            known[named] = _usable_systems(named)
        offered.append(Offered(name, one_line(layer.title), known[named], dates=_dates([layer])))
    return offered


def _usable_systems(named: Sequence[str]) -> tuple[str, ...]:
    """Usable systems of a layer, Web Mercator first, up to `_MOST_OFFERED`."""
    codes = {epsg_code(one.upper()) for one in named}
    projected = sorted((one for one in codes if one != MAP and _EPSG.fullmatch(one)), key=lambda one: int(one[5:]))
    usable = itertools.islice(filter(is_usable, projected[:_MOST_SYSTEMS]), _MOST_OFFERED)
    return (*((MAP,) if MAP in codes else ()), *usable)


def _wms_entry(name: str, document: Document, tile_px: int, wanted_crs: str, area_deg: Bounds | None) -> CatalogueEntry:
    """Entry of a layer, or of several layers drawn over each other; raises as `ServiceSource._find` does."""
    version, service = _wms(document)
    choices = document.service.choices
    contents = {key: layer.title for key, layer in service.contents.items()}
    wanted = choices.get("layers")
    names = [chosen_one(document, "layers", one, contents) for one in (wanted.split(",") if wanted else [None])]
    layers = [service.contents[one] for one in names]
    styles = choices.get("styles", "," * (len(layers) - 1)).split(",")
    _check_styles(document, layers, styles)
    get_map = service.getOperationByName("GetMap")
    kind = chosen_format(document, [one for one in get_map.formatOptions if one])
    dates = _dates(layers)
    crs = _crs(document, layers, wanted_crs, area_deg)
    plane = None if crs in MERCATOR_CODES else own_plane(crs, tile_px)
    by_northing = plane is not None and version == "1.3.0" and northing_first(crs)
    box = BBOX if plane is None else OWN_BBOX_YX if by_northing else OWN_BBOX
    query = {
        "SERVICE": "WMS",
        "VERSION": version,
        "REQUEST": "GetMap",
        "LAYERS": ",".join(names),
        "STYLES": ",".join(styles),
        "CRS" if version == "1.3.0" else "SRS": crs,
        "BBOX": f"{{{box}}}",
        "WIDTH": str(tile_px),
        "HEIGHT": str(tile_px),
        "FORMAT": kind,
        "TRANSPARENT": "TRUE" if "png" in kind.lower() else "FALSE",
        **({"TIME": "{date}"} if dates else {}),
    }
    address = next(method["url"] for method in get_map.methods if method["type"] == "Get")
    url = document.without_key(_append_query(urljoin(document.url, address), query))
    highest = _highest_zoom(layers, tile_px, plane)
    return _entry(
        name,
        service,
        layers,
        url,
        tile_px=(tile_px,),
        max_zoom=highest,
        native_zoom=highest,
        dates=dates,
        plane=plane,
    )


def _wms(document: Document) -> tuple[str, Any]:
    """Return the version of the server's answer, and the capabilities."""
    read = importlib.import_module("owslib.wms").WebMapService
    versions = ("1.3.0", "1.1.1")
    version = document.root.get("version") or versions[0]
    if version not in versions:
        raise document.wrong(Message("speaks version {0}; must be {1}", version, " or ".join(versions)))
    return version, read(document.service.address, version=version, xml=written(document.root))


def _crs(document: Document, layers: Sequence[Any], wanted: str, area_deg: Bounds | None) -> str:
    """System to request, as the service names it: the wanted system, Web Mercator, or the best suited one."""
    offered = set.intersection(*({crs.upper() for crs in layer.crsOptions} for layer in layers))
    mercator = next((crs for crs in MERCATOR_CODES if crs in offered), None)
    if wanted in ("", MAP) and mercator is not None:
        return mercator
    projected = sorted((crs for crs in offered if _EPSG.fullmatch(crs)), key=lambda crs: int(crs[5:]))
    if wanted:
        if wanted in projected and is_usable(wanted):
            return wanted
        on_map = [MAP] if mercator is not None else []
        raise refused(wanted, _named(document, layers[0]), [*on_map, *filter(is_usable, projected[:_MOST_SYSTEMS])])
    usable = [crs for crs in projected[:_MOST_SYSTEMS] if is_usable(crs)]
    if usable:
        return best_system(usable, *filter(None, (area_deg, read_bounds(layers))))
    names = ", ".join(sorted(offered)[:NAMED]) or Message("none")
    raise InvalidInput(
        "layer {0!r} of {1}: is offered in {2}; needs {3} or another projected system of EPSG",
        layers[0].id,
        document.service.host,
        names,
        MAP,
    )


def _named(document: Document, layer: Any) -> str:
    return Message("layer {0!r} of {1}", layer.id, document.service.host)


def own_plane(crs: str, tile_px: int) -> ProjectedPlane:
    """Plane for the pixels of a WMS: pixel sizes and edges are powers of two of the system's unit.

    The plane does not depend on the layer, so that missions and cached tiles stay valid. Its corner lies so far out
    that eastings prefixed with a zone number fit, too.
    """
    farthest, side = 2.0**26, float(tile_px)
    while side < 2.0 * farthest:
        side *= 2.0
    return ProjectedPlane(crs, -farthest, farthest, side, side)


def _check_styles(document: Document, layers: Sequence[Any], styles: Sequence[str]) -> None:
    if len(styles) != len(layers):
        raise InvalidInput("styles {0!r}: must be one for each of {1} layers", ",".join(styles), len(layers))
    for layer, style in zip(layers, styles):
        if style and style not in layer.styles:
            chosen_one(document, "styles", style, layer.styles)


def _dates(layers: Sequence[Any]) -> Dates | None:
    """Dates of the first layer with a time dimension; None if there is none."""
    for layer in layers:
        default = getattr(layer, "defaulttimeposition", None) or ""
        dates = time_dimension_dates(layer.timepositions or [], default)
        if dates is not None:
            return dates
    return None


def _highest_zoom(layers: Sequence[Any], tile_px: int, plane: ProjectedPlane | None) -> int:
    """Highest zoom at which every layer is drawn, by the scales that the service states."""
    width_m = 2.0 * HALF_WORLD_M if plane is None else plane.width * plane.unit_m
    highest = DEFAULT_MAX_ZOOM if plane is None else finest_zoom(plane, tile_px)
    for layer in layers:
        stated = getattr(layer, "min_scale_denominator", None)
        least = real_number(stated.text) if stated is not None else 0.0
        if least > 0.0:
            zoom = math.log2(width_m / (least * SCALE_PX_M * tile_px))
            highest = min(highest, max(math.floor(zoom + 1e-9), 0))
    return highest


def finest_zoom(plane: ProjectedPlane, tile_px: int) -> int:
    """Highest zoom of a plane for a service that states no scale: pixels of 1/32 unit, about `DEFAULT_MAX_ZOOM`."""
    return math.floor(math.log2(plane.width / (2.0**-5 * tile_px)) + 1e-9)
