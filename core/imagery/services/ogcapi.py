"""Tiles of an OGC API (OGC 20-057, "OGC API - Tiles - Part 1"): found by following links from any of its documents.

``ogcapi:URL`` names a landing page, a list of collections, a collection, a list of tilesets or a tileset; after ``#``
stand ``collection``, ``tilematrixset``, ``tilematrix`` and ``format``. A tile matrix set is chosen as that of a WMTS
is, and made a grid of by the same rules (`matrices`): WebMercatorQuad is known, others are asked for (OGC 17-083r4).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any
from urllib.parse import parse_qsl, urljoin, urlsplit

from ...errors import Message
from ...geodesy.mercator import HALF_WORLD_M
from ...text.plain import one_line
from ..catalogue import DEFAULT_MAX_ZOOM
from ..entry import CatalogueEntry
from ..opening import SourceOptions
from ..policy import Policy
from ..systems import MAP, WORLD_DEG, Bounds, epsg_code
from ..tiles import check_address
from .capabilities import Document, Offered, chosen_format, chosen_one, filled_template
from .json_service import JSONService, items_of, number_of, sound_bounds, text_of, with_query
from .matrices import SCALE_PX_M, LayerTiles, chosen_tiles

#: How links to what is wanted are called: in full, in short, and by earlier drafts.
_TILESETS = re.compile(r"(?:^|[/:])(?:tilesets-(?:map|coverage)|tiles)\]?$")
_COLLECTIONS = re.compile(r"(?:^|[/:])(?:data|collections)\]?$")
_SCHEME = re.compile(r"(?:^|[/:])tiling-scheme\]?$")
_QUAD = "WebMercatorQuad"
_QUAD_URI = re.compile(r"/tilematrixset/OGC/1\.0/WebMercatorQuad$")
#: Documents between a landing page and a tileset, and more.
_MOST_STEPS = 6
#: Matrices of a set that are looked at.
_MOST_MATRICES = 100


class OGCAPITiles(JSONService):
    """Tiles of an OGC API as a mission names them."""

    def __init__(self, text: str, options: SourceOptions) -> None:
        super().__init__(text, options)
        #: What documents on the way state of title, credit, licence and ground.
        self._told: dict[str, Any] = {}

    def _first(self) -> Document:
        return self._json(self._with_key(self.service.address), Message("description"))

    def _layers(self, document: Document) -> list[Offered] | None:
        if "collection" in self.service.choices:
            return None
        found = self._followed(document, to_list=True)
        if "collections" not in found.root:
            return None
        return [
            Offered(one["id"], text_of(one.get("title")) or one_line(one["id"]))
            for one in items_of(found.root["collections"])
            if isinstance(one.get("id"), str) and _link(one, _TILESETS)
        ]

    def _entry(self, document: Document) -> CatalogueEntry:
        found = self._followed(document, to_list=False)
        tileset = found if _items(found.root) else self._chosen_tileset(found)
        self._note(tileset.root)
        tiles, item = self._tiles_of(tileset)
        filled = {"tilematrix": "{z}", "tilerow": "{y}", "tilecol": "{x}", "tilematrixsetid": tiles.name}
        url = filled_template(tileset, self._with_key(item, tileset.url), filled)
        zooms, told = sorted(tiles.levels), self._told
        return self._made(
            told.get("title", ""),
            told.get("attribution", ""),
            url,
            Policy(licence=told.get("licence", ""), terms_url=told.get("terms_url", "")),
            tile_px=(tiles.tile_px,),
            min_zoom=zooms[0],
            max_zoom=zooms[-1],
            native_zoom=zooms[-1],
            levels=tuple((zoom, tiles.levels[zoom]) for zoom in zooms if tiles.levels[zoom] != str(zoom)),
            plane=tiles.plane,
            tile_limits=tiles.limits,
            bounds_deg=told.get("bounds", WORLD_DEG),
        )

    def _followed(self, document: Document, *, to_list: bool) -> Document:
        """Document of tilesets, or one of them; with ``to_list``, the list of collections where one is to be chosen."""
        wanted = self.service.choices.get("collection")
        for _ in range(_MOST_STEPS):
            root = document.root
            self._note(root)
            if _items(root) or isinstance(root.get("tilesets"), list):
                return document
            if isinstance(root.get("collections"), list):
                if to_list:
                    return document
                collection = self._chosen_collection(document, wanted)
                self._note(collection)
                link = _link(collection, _TILESETS)
            elif root.get("id") == wanted or wanted is None:
                # A collection; or a landing page, which may have tiles of all of its collections together.
                link = _link(root, _TILESETS) or _link(root, _COLLECTIONS)
            else:
                link = _link(root, _COLLECTIONS)
            if not link:
                raise document.wrong(Message("offers no tiles of images: nothing links to tilesets-map"))
            document = self._json(self._with_key(link, document.url), Message("description"))
        raise document.wrong(Message("links to descriptions and no tiles, {0} deep", _MOST_STEPS))

    def _chosen_collection(self, document: Document, wanted: str | None) -> Mapping[str, Any]:
        offered = {
            one["id"]: one
            for one in items_of(document.root["collections"])
            if isinstance(one.get("id"), str) and (_link(one, _TILESETS) or one["id"] == wanted)
        }
        names = {name: text_of(one.get("title")) for name, one in offered.items()}
        return offered[chosen_one(document, "collection", wanted, names)]

    def _chosen_tileset(self, document: Document) -> Document:
        """Tileset of the matrix set or the system that is asked for; else of Web Mercator, or the first."""
        offered: dict[str, Mapping[str, Any]] = {}
        for one in items_of(document.root["tilesets"]):
            if text_of(one.get("dataType")) in ("", "map", "coverage") and _self(one):
                offered.setdefault(_name_of(one), one)
        wanted, crs = self.service.choices.get("tilematrixset"), self.options.crs
        if not offered:
            raise document.wrong(Message("offers tiles of data, and none of images"))
        if wanted is None:
            suited = [name for name, one in offered.items() if epsg_code(_crs_of(one)) == (crs or MAP)]
            suited.sort(key=lambda name: name != _QUAD)
            wanted = (suited or list(offered))[0]
        chosen = offered[chosen_one(document, "tilematrixset", wanted, dict.fromkeys(offered, ""))]
        link = self._with_key(_self(chosen), document.url)
        return self._json(link, Message("description of tiles"))

    def _tiles_of(self, tileset: Document) -> tuple[LayerTiles, str]:
        """Grid of a tileset, and its own template of the format that is chosen."""
        root = tileset.root
        items = _items(root)
        if not items:
            raise tileset.wrong(Message("a tileset without a link to its tiles"))
        kind = chosen_format(tileset, list(items))
        name, matrices, crs = self._matrices(tileset)
        limits = {}
        for one in items_of(root.get("tileMatrixSetLimits"))[:_MOST_MATRICES]:
            ends = [_whole(one.get(f"{end}Tile{axis}")) for end, axis in _ENDS]
            limits[str(one.get("tileMatrix"))] = SimpleNamespace(
                **dict(zip(("mintilecol", "mintilerow", "maxtilecol", "maxtilerow"), ends))
            )
        link = SimpleNamespace(tilematrixlimits=limits)
        bounds = self._told.get("bounds", WORLD_DEG)
        layer = SimpleNamespace(
            id=self._told.get("title") or name, tilematrixsetlinks={name: link}, boundingBoxWGS84=bounds
        )
        by_id = {one.identifier: one for one in matrices}
        sets = {name: SimpleNamespace(crs=crs, tilematrix=by_id)}
        service = SimpleNamespace(tilematrixsets=sets)
        # The set has been chosen by its name, which a link may spell otherwise.
        choices = {one: text for one, text in tileset.service.choices.items() if one != "tilematrixset"}
        document = _with_choices(tileset, choices)
        return chosen_tiles(document, service, layer, self.options.crs, self.options.area_deg), items[kind]

    def _matrices(self, tileset: Document) -> tuple[str, list[SimpleNamespace], str]:
        """Name of a tileset's matrix set, its matrices as OWSLib would have them, and its system."""
        root = tileset.root
        name = _name_of(root)
        if _QUAD_URI.search(text_of(root.get("tileMatrixSetURI"))) or name == _QUAD:
            return name or _QUAD, _quad_matrices(), MAP
        link = _link(root, _SCHEME)
        if not link:
            raise tileset.wrong(Message("tiles of {0}, which it does not describe", name or "a matrix set"))
        scheme = self._json(self._with_key(link, tileset.url), Message("tile matrix set"))
        crs = _crs_of(scheme.root) or _crs_of(root)
        return name or text_of(scheme.root.get("id")), _matrices_of(scheme), crs

    def _note(self, root: Mapping[str, Any]) -> None:
        """Keep what a document states of title, credit, licence and ground; later ones are about less."""
        told = self._told
        for name in ("title", "attribution"):
            if text_of(root.get(name)):
                told[name] = text_of(root[name])
        for link in items_of(root.get("links")):
            if link.get("rel") == "license" and isinstance(link.get("href"), str):
                told["licence"] = text_of(link.get("title")) or told.get("licence", "")
                if link["href"].startswith("https://") and link["href"].isprintable():
                    told["terms_url"] = link["href"]
        if isinstance(root.get("license"), str):
            told["licence"] = text_of(root["license"])
        bounds = _bounds_of(root)
        if bounds is not None:
            told["bounds"] = bounds

    def _with_key(self, link: str, base: str = "") -> str:
        """Address that a link leads to; with the address's own key parameters, where it leads to the same server."""
        url = urljoin(base or self.service.address, link)
        if base:
            check_address(url, Message("address in a description of {0}", self.service.host))
        own = urlsplit(self.service.address)
        query = [pair for pair in parse_qsl(own.query) if "{key}" in pair[1]]
        if query and (urlsplit(url).scheme, urlsplit(url).netloc) == (own.scheme, own.netloc):
            url = with_query(url, dict(query))
        return self._filled(url)


_ENDS = (("min", "Col"), ("min", "Row"), ("max", "Col"), ("max", "Row"))


def _with_choices(document: Document, choices: Mapping[str, str]) -> Document:
    return replace(document, service=replace(document.service, choices=choices))


def _link(root: Mapping[str, Any], rel: re.Pattern[str]) -> str:
    """Address of the first link of a kind, one to JSON before others; empty where there is none."""
    links = [
        link
        for link in items_of(root.get("links"))
        if isinstance(link.get("rel"), str)
        and rel.search(link["rel"])
        and isinstance(link.get("href"), str)
        and "{" not in link["href"]
    ]
    links.sort(key=lambda link: "json" not in str(link.get("type") or "json"))
    return str(links[0]["href"]) if links else ""


def _self(root: Mapping[str, Any]) -> str:
    return _link(root, re.compile(r"^(?:self|item|(?:.*[/:])?tilesets?(?:-map|-coverage)?\]?)$"))


def _items(root: Mapping[str, Any]) -> dict[str, str]:
    """Templates of a tileset's tiles, by media type."""
    return {
        str(link.get("type") or "image/png"): link["href"]
        for link in items_of(root.get("links"))
        if link.get("rel") == "item"
        and isinstance(link.get("href"), str)
        and "{tilematrix}" in link["href"].lower()
    }


def _name_of(tileset: Mapping[str, Any]) -> str:
    """Name of a tileset's matrix set."""
    for name in ("tileMatrixSetId", "tileMatrixSetURI", "tileMatrixSet"):
        if text_of(tileset.get(name)):
            return text_of(tileset[name]).rstrip("/").rpartition("/")[2]
    return urlsplit(_self(tileset)).path.rstrip("/").rpartition("/")[2]


def _crs_of(root: Mapping[str, Any]) -> str:
    """Name of a document's system, which may stand in an object of its own."""
    crs = root.get("crs") or root.get("supportedCRS")
    if isinstance(crs, Mapping):
        crs = crs.get("uri")
    if not crs and _QUAD_URI.search(text_of(root.get("tileMatrixSetURI"))):
        return MAP
    return text_of(crs)


def _matrices_of(scheme: Document) -> list[SimpleNamespace]:
    """Matrices of a tile matrix set: of the current standard, or of the one before it."""
    root = scheme.root
    stated = root.get("tileMatrices") or root.get("tileMatrix")
    made = []
    for one in items_of(stated)[:_MOST_MATRICES]:
        corner = one.get("pointOfOrigin") or one.get("topLeftCorner")
        scale = number_of(one.get("scaleDenominator"))
        if scale is None or not isinstance(corner, list) or one.get("cornerOfOrigin", "topLeft") != "topLeft":
            continue
        across, down = (number_of(edge) for edge in corner)
        sizes = [_whole(one.get(name)) for name in ("tileWidth", "tileHeight", "matrixWidth", "matrixHeight")]
        if across is None or down is None or None in sizes or one.get("variableMatrixWidths"):
            continue
        made.append(
            SimpleNamespace(
                identifier=str(one.get("id", one.get("identifier"))),
                scaledenominator=scale,
                topleftcorner=(across, down),
                **dict(zip(("tilewidth", "tileheight", "matrixwidth", "matrixheight"), sizes)),
            )
        )
    if not made:
        raise scheme.wrong(Message("a tile matrix set without matrices that can be used"))
    return made


def _quad_matrices() -> list[SimpleNamespace]:
    """Matrices of WebMercatorQuad, as OGC 17-083r4 (annex D) has it, up to what a template is taken to have."""
    return [
        SimpleNamespace(
            identifier=str(zoom),
            scaledenominator=2.0 * HALF_WORLD_M / (256 << zoom) / SCALE_PX_M,
            topleftcorner=(-HALF_WORLD_M, HALF_WORLD_M),
            tilewidth=256,
            tileheight=256,
            matrixwidth=1 << zoom,
            matrixheight=1 << zoom,
        )
        for zoom in range(DEFAULT_MAX_ZOOM + 1)
    ]


def _bounds_of(root: Mapping[str, Any]) -> Bounds | None:
    """West, south, east and north in degrees that a collection states; None where it does not."""
    extent = root.get("extent")
    spatial = extent.get("spatial") if isinstance(extent, Mapping) else None
    boxes = spatial.get("bbox") if isinstance(spatial, Mapping) else None
    if not isinstance(boxes, list) or not boxes or not isinstance(boxes[0], list):
        return None
    if spatial is None or "CRS84" not in text_of(spatial.get("crs") or "CRS84"):
        return None
    numbers = [number_of(edge) for edge in boxes[0]]
    # Of a box with heights, those are left out.
    edges = numbers if len(numbers) == 4 else [*numbers[:2], *numbers[3:5]]
    if len(edges) != 4:
        return None
    west, south, east, north = edges
    if west is None or south is None or east is None or north is None:
        return None
    return sound_bounds(west, south, east, north)


def _whole(value: object) -> int | None:
    return value if isinstance(value, int) and not isinstance(value, bool) else None
