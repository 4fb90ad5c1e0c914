"""Tiles of an OGC API (OGC 20-057, "OGC API - Tiles - Part 1"), found by following links between documents.

``ogcapi:URL`` names a landing page, a list of collections, a collection, a list of tilesets or a tileset. Choices after
``#`` are ``collection``, ``tilematrixset``, ``tilematrix`` and ``format``. Tile matrix sets are chosen and converted to
grids by the rules for WMTS (`matrices`); WebMercatorQuad is built in, others are fetched (OGC 17-083r4).
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
from .json_service import JSONService, read_number, read_objects, read_text, set_query, sound_bounds
from .matrices import SCALE_PX_M, LayerTiles, chosen_tiles

#: Relations of links, as a full URI, as a short name, and as in earlier drafts.
_TILESETS = re.compile(r"(?:^|[/:])(?:tilesets-(?:map|coverage)|tiles)\]?$")
_COLLECTIONS = re.compile(r"(?:^|[/:])(?:data|collections)\]?$")
_QUAD = "WebMercatorQuad"
_QUAD_URI = re.compile(r"/tilematrixset/OGC/1\.0/WebMercatorQuad$")
#: Most matrices of a set to consider.
_MOST_MATRICES = 100


class OGCAPITiles(JSONService):
    """Tiles of an OGC API as a mission names them."""

    def __init__(self, text: str, options: SourceOptions) -> None:
        super().__init__(text, options)
        #: Title, attribution, licence and bounds stated in documents.
        self._stated: dict[str, Any] = {}

    def _document(self) -> Document:
        return self._json(self._keyed(self.service.address), Message("description"))

    def _layers(self, document: Document) -> list[Offered] | None:
        if "collection" in self.service.choices:
            return None
        found = self._follow_links(document, to_list=True)
        if "collections" not in found.root:
            return None
        return [
            Offered(one["id"], read_text(one.get("title")) or one_line(one["id"]))
            for one in read_objects(found.root["collections"])
            if isinstance(one.get("id"), str) and _link(one, _TILESETS)
        ]

    def _entry(self, document: Document) -> CatalogueEntry:
        found = self._follow_links(document, to_list=False)
        tileset = found if _items(found.root) else self._chosen_tileset(found)
        self._note(tileset.root)
        tiles, item = self._tileset_tiles(tileset)
        filled = {"tilematrix": "{z}", "tilerow": "{y}", "tilecol": "{x}", "tilematrixsetid": tiles.name}
        url = filled_template(tileset, self._keyed(item, tileset.url), filled)
        zooms, stated = sorted(tiles.levels), self._stated
        return self._made(
            stated.get("title", ""),
            stated.get("attribution", ""),
            url,
            Policy(licence=stated.get("licence", ""), terms_url=stated.get("terms_url", "")),
            tile_px=(tiles.tile_px,),
            min_zoom=zooms[0],
            max_zoom=zooms[-1],
            native_zoom=zooms[-1],
            levels=tuple((zoom, tiles.levels[zoom]) for zoom in zooms if tiles.levels[zoom] != str(zoom)),
            plane=tiles.plane,
            tile_limits=tiles.limits,
            bounds_deg=stated.get("bounds", WORLD_DEG),
        )

    def _follow_links(self, document: Document, *, to_list: bool) -> Document:
        """Follow links to a list of tilesets or a tileset; with ``to_list``, stop at a list of collections."""
        # More links than lie between a landing page and a tileset.
        most_steps = 6
        wanted = self.service.choices.get("collection")
        for _ in range(most_steps):
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
                # This is a collection, or a landing page, which may have tiles of all collections together.
                link = _link(root, _TILESETS) or _link(root, _COLLECTIONS)
            else:
                link = _link(root, _COLLECTIONS)
            if not link:
                raise document.wrong(Message("offers no tiles of images: nothing links to tilesets-map"))
            document = self._json(self._keyed(link, document.url), Message("description"))
        raise document.wrong(Message("links to descriptions and no tiles, {0} deep", most_steps))

    def _chosen_collection(self, document: Document, wanted: str | None) -> Mapping[str, Any]:
        offered = {
            one["id"]: one
            for one in read_objects(document.root["collections"])
            if isinstance(one.get("id"), str) and (_link(one, _TILESETS) or one["id"] == wanted)
        }
        names = {name: read_text(one.get("title")) for name, one in offered.items()}
        return offered[chosen_one(document, "collection", wanted, names)]

    def _chosen_tileset(self, document: Document) -> Document:
        """Tileset of the wanted matrix set or system; otherwise the tileset of Web Mercator, otherwise the first."""
        offered: dict[str, Mapping[str, Any]] = {}
        for one in read_objects(document.root["tilesets"]):
            if read_text(one.get("dataType")) in ("", "map", "coverage") and _self(one):
                offered.setdefault(_matrix_set_name(one), one)
        wanted, crs = self.service.choices.get("tilematrixset"), self.options.crs
        if not offered:
            raise document.wrong(Message("offers tiles of data, and none of images"))
        if wanted is None:
            suited = [name for name, one in offered.items() if epsg_code(_crs_name(one)) == (crs or MAP)]
            suited.sort(key=lambda name: name != _QUAD)
            wanted = (suited or list(offered))[0]
        chosen = offered[chosen_one(document, "tilematrixset", wanted, dict.fromkeys(offered, ""))]
        link = self._keyed(_self(chosen), document.url)
        return self._json(link, Message("description of tiles"))

    def _tileset_tiles(self, tileset: Document) -> tuple[LayerTiles, str]:
        """Return the grid of a tileset, and the template of its tiles in the chosen format."""
        root = tileset.root
        items = _items(root)
        if not items:
            raise tileset.wrong(Message("a tileset without a link to its tiles"))
        kind = chosen_format(tileset, list(items))
        name, matrices, crs = self._matrices(tileset)
        limits = {}
        for one in read_objects(root.get("tileMatrixSetLimits"))[:_MOST_MATRICES]:
            names = ("minTileCol", "minTileRow", "maxTileCol", "maxTileRow")
            ends = [_whole(one.get(end)) for end in names]
            limits[str(one.get("tileMatrix"))] = SimpleNamespace(
                **dict(zip(("mintilecol", "mintilerow", "maxtilecol", "maxtilerow"), ends))
            )
        link = SimpleNamespace(tilematrixlimits=limits)
        bounds = self._stated.get("bounds", WORLD_DEG)
        layer = SimpleNamespace(
            id=self._stated.get("title") or name, tilematrixsetlinks={name: link}, boundingBoxWGS84=bounds
        )
        by_id = {one.identifier: one for one in matrices}
        sets = {name: SimpleNamespace(crs=crs, tilematrix=by_id)}
        service = SimpleNamespace(tilematrixsets=sets)
        # The set is already chosen; a link may spell its name differently.
        choices = {one: text for one, text in tileset.service.choices.items() if one != "tilematrixset"}
        document = _replace_choices(tileset, choices)
        return chosen_tiles(document, service, layer, self.options.crs, self.options.area_deg), items[kind]

    def _matrices(self, tileset: Document) -> tuple[str, list[SimpleNamespace], str]:
        """Return the name of a tileset's matrix set, the matrices in the form of OWSLib, and the system."""
        root = tileset.root
        name = _matrix_set_name(root)
        if _QUAD_URI.search(read_text(root.get("tileMatrixSetURI"))) or name == _QUAD:
            return name or _QUAD, _quad_matrices(), MAP
        link = _link(root, re.compile(r"(?:^|[/:])tiling-scheme\]?$"))
        if not link:
            raise tileset.wrong(Message("tiles of {0}, which it does not describe", name or "a matrix set"))
        scheme = self._json(self._keyed(link, tileset.url), Message("tile matrix set"))
        crs = _crs_name(scheme.root) or _crs_name(root)
        return name or read_text(scheme.root.get("id")), _read_matrices(scheme), crs

    def _note(self, root: Mapping[str, Any]) -> None:
        """Keep title, attribution, licence and bounds of a document; later documents are more specific."""
        stated = self._stated
        for name in ("title", "attribution"):
            if read_text(root.get(name)):
                stated[name] = read_text(root[name])
        for link in read_objects(root.get("links")):
            if link.get("rel") == "license" and isinstance(link.get("href"), str):
                stated["licence"] = read_text(link.get("title")) or stated.get("licence", "")
                if link["href"].startswith("https://") and link["href"].isprintable():
                    stated["terms_url"] = link["href"]
        if isinstance(root.get("license"), str):
            stated["licence"] = read_text(root["license"])
        bounds = _stated_bounds(root)
        if bounds is not None:
            stated["bounds"] = bounds

    def _keyed(self, link: str, base: str = "") -> str:
        """Target of a link; on the service's server, with the parameters of the service's address that hold the key."""
        url = urljoin(base or self.service.address, link)
        if base:
            check_address(url, Message("address in a description of {0}", self.service.host))
        address = urlsplit(self.service.address)
        query = [pair for pair in parse_qsl(address.query) if "{key}" in pair[1]]
        if query and urlsplit(url)[:2] == address[:2]:
            url = set_query(url, dict(query))
        return self._filled(url)


def _replace_choices(document: Document, choices: Mapping[str, str]) -> Document:
    return replace(document, service=replace(document.service, choices=choices))


def _link(root: Mapping[str, Any], rel: re.Pattern[str]) -> str:
    """Address of the first link of a relation, preferably to JSON; empty without such a link."""
    links = [
        link
        for link in read_objects(root.get("links"))
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
        for link in read_objects(root.get("links"))
        if link.get("rel") == "item" and isinstance(link.get("href"), str) and "{tilematrix}" in link["href"].lower()
    }


def _matrix_set_name(tileset: Mapping[str, Any]) -> str:
    """Name of a tileset's matrix set."""
    for name in ("tileMatrixSetId", "tileMatrixSetURI", "tileMatrixSet"):
        if read_text(tileset.get(name)):
            return read_text(tileset[name]).rstrip("/").rpartition("/")[2]
    return urlsplit(_self(tileset)).path.rstrip("/").rpartition("/")[2]


def _crs_name(root: Mapping[str, Any]) -> str:
    """Name of a document's coordinate reference system, which may be stated as a string or an object."""
    crs = root.get("crs") or root.get("supportedCRS")
    if isinstance(crs, Mapping):
        crs = crs.get("uri")
    if not crs and _QUAD_URI.search(read_text(root.get("tileMatrixSetURI"))):
        return MAP
    return read_text(crs)


def _read_matrices(scheme: Document) -> list[SimpleNamespace]:
    """Matrices of a tile matrix set in the current or the previous standard, in the form of OWSLib."""
    root = scheme.root
    stated = root.get("tileMatrices") or root.get("tileMatrix")
    matrices = []
    for one in read_objects(stated)[:_MOST_MATRICES]:
        corner = one.get("pointOfOrigin") or one.get("topLeftCorner")
        scale = read_number(one.get("scaleDenominator"))
        if scale is None or not isinstance(corner, list) or one.get("cornerOfOrigin", "topLeft") != "topLeft":
            continue
        across, down = (read_number(edge) for edge in corner)
        sizes = [_whole(one.get(name)) for name in ("tileWidth", "tileHeight", "matrixWidth", "matrixHeight")]
        if across is None or down is None or None in sizes or one.get("variableMatrixWidths"):
            continue
        matrices.append(
            SimpleNamespace(
                identifier=str(one.get("id", one.get("identifier"))),
                scaledenominator=scale,
                topleftcorner=(across, down),
                **dict(zip(("tilewidth", "tileheight", "matrixwidth", "matrixheight"), sizes)),
            )
        )
    if not matrices:
        raise scheme.wrong(Message("a tile matrix set without matrices that can be used"))
    return matrices


def _quad_matrices() -> list[SimpleNamespace]:
    """Matrices of WebMercatorQuad (OGC 17-083r4, annex D), up to the highest zoom of a template."""
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


def _stated_bounds(root: Mapping[str, Any]) -> Bounds | None:
    """West, south, east and north of a collection in degrees; None if not stated."""
    extent = root.get("extent")
    spatial = extent.get("spatial") if isinstance(extent, Mapping) else None
    boxes = spatial.get("bbox") if isinstance(spatial, Mapping) else None
    if not isinstance(boxes, list) or not boxes or not isinstance(boxes[0], list):
        return None
    if spatial is None or "CRS84" not in read_text(spatial.get("crs") or "CRS84"):
        return None
    numbers = [read_number(edge) for edge in boxes[0]]
    # Leave out the heights of a box in three dimensions.
    edges = numbers if len(numbers) == 4 else [*numbers[:2], *numbers[3:5]]
    if len(edges) != 4:
        return None
    west, south, east, north = edges
    if west is None or south is None or east is None or north is None:
        return None
    return sound_bounds(west, south, east, north)


def _whole(value: object) -> int | None:
    return value if isinstance(value, int) and not isinstance(value, bool) else None
