"""Map and image services of ArcGIS Server, by their own REST interface.

``arcgis:URL`` names a service by its address, ``…/rest/services/NAME/MapServer`` or ``…/ImageServer``; after ``#``
stand ``layers=0,2``, those of a map service by their numbers, and ``format``. One of a server's services is named by
``arcgis:…/rest/services#service=NAME/MapServer``. A key in the address is written ``?token={key}``.

A service that has its tiles made (``singleFusedMapCache``) is asked for those, ``tile/{level}/{row}/{column}``, where
they make a grid (`matrices`) in the system that is asked for, and no layers are chosen. Every other one is asked to
draw, by ``export`` or ``exportImage``, tiles of the Web-Mercator grid or of a plane as `ogc` has it for a WMS: it draws
in any system. Documents: ArcGIS REST API, "Map Service" and "Image Service".
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any
from urllib.parse import quote, urlsplit, urlunsplit

import numpy as np

from ...errors import InvalidInput, Message
from ...geodesy.mercator import HALF_WORLD_M
from ...geodesy.projections import through_proj
from ...text.plain import one_line
from ..catalogue import DEFAULT_MAX_ZOOM
from ..entry import CatalogueEntry
from ..policy import Policy
from ..systems import MAP, WORLD_DEG, Bounds, epsg_code, is_usable, refused, unit_m
from ..tiles import BBOX, OWN_BBOX
from .capabilities import Document, Offered, chosen_one
from .json_service import JSONService, items_of, number_of, sound_bounds, text_of, with_query
from .matrices import SCALE_PX_M, chosen_tiles
from .ogc import finest_zoom, own_plane

_SERVERS = ("MapServer", "ImageServer")
_ADDRESS = re.compile(r"(?P<base>.*/(?P<kind>MapServer|ImageServer))(?:/(?P<layer>\d+))?/?$", re.IGNORECASE)
#: Operation that draws, and the capability that a service states for it.
_DRAWN = {"mapserver": ("export", "Map"), "imageserver": ("exportImage", "Image")}
#: Formats that a service draws in, the first that it offers is taken: with transparency where it has that.
_FORMATS = ("png32", "png24", "png", "png8", "jpgpng", "jpg")
#: Levels of a cache that are looked at; the server's own schemes have up to 24.
_MOST_LEVELS = 100
#: Scales are stated in whole numbers, or rounded to six digits.
_SCALE_SLACK = 1e-3
#: Metres of a degree of the equator of EPSG:3857.
_DEGREE_M = HALF_WORLD_M / 180.0
#: Points along each side of an extent at which it is looked at in degrees.
_ALONG = 9
_STEEPEST_DEG = 85.0


class ArcGISService(JSONService):
    """A map or image service of ArcGIS Server as a mission names it."""

    def _first(self) -> Document:
        return self._json(self._filled(with_query(self._base, {"f": "json"})), Message("description"))

    @property
    def _base(self) -> str:
        """Address of the service, or of the list of them where none is named, with its query."""
        parts = urlsplit(self.service.address)
        path, service = parts.path.rstrip("/"), self.service.choices.get("service")
        if service:
            # Names hold their folder, whichever list they stand in.
            root = re.match(r".*/rest/services(?=/|$)", path, re.IGNORECASE)
            path = f"{root.group() if root else path}/{quote(service, safe='/')}"
        found = _ADDRESS.fullmatch(path)
        return urlunsplit(parts._replace(path=found["base"] if found else path, fragment=""))

    @property
    def _kind(self) -> str:
        """``mapserver`` or ``imageserver``; empty for a list of services."""
        found = _ADDRESS.fullmatch(urlsplit(self._base).path)
        return found["kind"].lower() if found else ""

    @property
    def _chosen_layers(self) -> str:
        found = _ADDRESS.fullmatch(urlsplit(self.service.address).path.rstrip("/"))
        of_address = found["layer"] if found and found["layer"] else ""
        return self.service.choices.get("layers", of_address)

    def _layers(self, document: Document) -> list[Offered] | None:
        _refuse_error(document)
        if self._kind:
            return None
        return list(_services(document).values())

    def _entry(self, document: Document) -> CatalogueEntry:
        _refuse_error(document)
        if not self._kind:
            services = {name: one.title for name, one in _services(document).items()}
            chosen = chosen_one(document, "service", self.service.choices.get("service"), services)
            # The only one there is.
            named = type(self)(f"{self.service.kind}:{self.service.address}#service={chosen}", self.options)
            return named._find()  # noqa: SLF001
        info: Mapping[str, Any] = document.root
        cached = self._cached(document) if self._is_cached(info) else None
        if cached is not None:
            return cached
        operation, capability = _DRAWN[self._kind]
        stated = text_of(info.get("capabilities"))
        if stated and capability not in stated.split(","):
            raise document.wrong(
                Message(
                    "it neither has tiles nor draws maps in this system: it offers {0}", stated or "nothing"
                )
            )
        return self._drawn(document, operation)

    def _is_cached(self, info: Mapping[str, Any]) -> bool:
        """Whether a service has tiles, and those can show what is asked for."""
        tiles = info.get("tileInfo")
        return (
            info.get("singleFusedMapCache") is True
            and isinstance(tiles, Mapping)
            # Heights, which are no imagery.
            and not text_of(tiles.get("format")).upper().startswith("LERC")
            and not self._chosen_layers
            and "format" not in self.service.choices
        )

    def _cached(self, document: Document) -> CatalogueEntry | None:
        """Entry of the service's tiles; None where they make no grid in the system that is asked for."""
        info = document.root
        tiles = info["tileInfo"]
        bounds = _bounds_of(info)
        crs = _code(tiles.get("spatialReference") or info.get("spatialReference"))
        matrices = _levels(info, crs)
        name = text_of(info.get("mapName")) or "tiles"
        link = SimpleNamespace(tilematrixlimits={})
        layer = SimpleNamespace(id=name, tilematrixsetlinks={name: link}, boundingBoxWGS84=bounds)
        by_id = {one.identifier: one for one in matrices}
        sets = {name: SimpleNamespace(crs=crs, tilematrix=by_id)}
        try:
            chosen = chosen_tiles(document, SimpleNamespace(tilematrixsets=sets), layer, self.options.crs)
        except InvalidInput:
            return None
        url = self._template(document, "tile/{z}/{y}/{x}", {})
        zooms = sorted(chosen.levels)
        return self._stated(
            document,
            url,
            bounds,
            tile_px=(chosen.tile_px,),
            min_zoom=zooms[0],
            max_zoom=zooms[-1],
            native_zoom=zooms[-1],
            levels=tuple((zoom, chosen.levels[zoom]) for zoom in zooms if chosen.levels[zoom] != str(zoom)),
            plane=chosen.plane,
            tile_limits=chosen.limits,
        )

    def _drawn(self, document: Document, operation: str) -> CatalogueEntry:
        """Entry of tiles that the service draws."""
        info, crs, tile_px = document.root, self.options.crs or MAP, self.options.tile_px or 256
        if crs != MAP and not is_usable(crs):
            raise refused(crs, self._title(info), [MAP, Message("every projected system of EPSG")])
        plane = None if crs == MAP else own_plane(crs, tile_px)
        code = crs.partition(":")[2]
        layers = self._chosen_layers
        if layers:
            _check_layers(document, layers)
        query = {
            "bbox": f"{{{BBOX if plane is None else OWN_BBOX}}}",
            "bboxSR": code,
            "imageSR": code,
            "size": f"{tile_px},{tile_px}",
            "format": self._format(document),
            **({"layers": f"show:{layers}"} if layers else {}),
            # Symbols as large as on the map of a screen.
            **({"transparent": "true", "dpi": "96"} if operation == "export" else {}),
            "f": "image",
        }
        bounds = _bounds_of(info)
        highest = DEFAULT_MAX_ZOOM if plane is None else finest_zoom(plane, tile_px)
        width_m = 2.0 * HALF_WORLD_M if plane is None else plane.width * plane.unit_m
        ground_m = _pixel_m(info)
        if ground_m is not None:
            south, north = bounds[1], bounds[3]
            shrink = math.cos(math.radians(min(abs(south + north) / 2.0, _STEEPEST_DEG)))
            own_m = ground_m / (shrink if plane is None else 1.0)
            highest = min(highest, max(math.ceil(math.log2(width_m / (own_m * tile_px)) - 0.01), 0))
        least = number_of(info.get("maxScale")) or 0.0
        if least > 0.0 and ground_m is None:
            zoom = math.log2(width_m / (least * SCALE_PX_M * tile_px))
            highest = min(highest, max(math.floor(zoom + _SCALE_SLACK), 0))
        return self._stated(
            document,
            self._template(document, operation, query),
            bounds,
            tile_px=(tile_px,),
            max_zoom=highest,
            native_zoom=highest,
            plane=plane,
        )

    def _stated(self, document: Document, url: str, bounds: Bounds, **tiles: Any) -> CatalogueEntry:
        info = document.root
        about = info.get("documentInfo")
        author = text_of(about.get("Author")) if isinstance(about, Mapping) else ""
        credit = text_of(info.get("copyrightText")) or author
        return self._made(self._title(info), credit, url, Policy(), bounds_deg=bounds, **tiles)

    def _title(self, info: Mapping[str, Any]) -> str:
        about = info.get("documentInfo")
        title = text_of(about.get("Title")) if isinstance(about, Mapping) else ""
        own = urlsplit(self._base).path.rpartition("/rest/services/")[2].rpartition("/")[0]
        name = title or text_of(info.get("name")) or own or text_of(info.get("mapName"))
        chosen = self._chosen_layers.split(",") if self._chosen_layers else []
        names = {str(one.get("id")): text_of(one.get("name")) for one in items_of(info.get("layers"))}
        layers = ", ".join(names[one] for one in chosen if names.get(one))
        return f"{name}: {layers}" if layers else name

    def _format(self, document: Document) -> str:
        wanted = self.service.choices.get("format")
        stated = text_of(document.root.get("supportedImageFormatTypes")).lower().replace(" ", "").split(",")
        # Image services do not say which they have: all of them have these.
        offered = [one for one in _FORMATS if one in stated] or list(_FORMATS)
        return chosen_one(document, "format", (wanted or offered[0]).lower(), dict.fromkeys(offered, ""))

    def _template(self, document: Document, path: str, query: Mapping[str, str]) -> str:
        parts = urlsplit(self._base)
        address = urlunsplit(parts._replace(path=f"{parts.path}/{path}"))
        return document.without_key(with_query(address, query) if query else address)


def _refuse_error(document: Document) -> None:
    """Refuse what the server answers, with status 200, where it will not."""
    error = document.root.get("error")
    if isinstance(error, Mapping):
        code, words = error.get("code"), text_of(error.get("message"))
        told = f"{code} {words}" if isinstance(code, int) else words
        raise document.wrong(Message("refused ({0})", told or Message("no reason given")))


def _services(document: Document) -> dict[str, Offered]:
    """Services of a server or of a folder that have images, by their names."""
    root = document.root
    if not isinstance(root.get("services"), list):
        raise document.wrong(Message("neither a map service nor an image service, nor a list of them"))
    names = [
        f"{one_line(one['name'])}/{one['type']}"
        for one in items_of(root["services"])
        if isinstance(one.get("name"), str) and one.get("type") in _SERVERS
    ]
    return {name: Offered(name, name.rpartition("/")[0]) for name in names}


def _check_layers(document: Document, layers: str) -> None:
    names = {str(one.get("id")): text_of(one.get("name")) for one in items_of(document.root.get("layers"))}
    for one in layers.split(","):
        chosen_one(document, "layers", one.strip(), names)


def _levels(info: Mapping[str, Any], crs: str) -> list[SimpleNamespace]:
    """Tile matrices of a service's tiles, as OWSLib would have them; those that its scales leave out are not made."""
    tiles = info["tileInfo"]
    least, most = (number_of(info.get(name)) or 0.0 for name in ("maxScale", "minScale"))
    x, y = (number_of(tiles["origin"].get(axis)) for axis in "xy")
    unit = unit_m(crs) if crs != MAP and is_usable(crs) else 1.0
    made = []
    for lod in items_of(tiles.get("lods"))[:_MOST_LEVELS]:
        size, scale = number_of(lod.get("resolution")), number_of(lod.get("scale")) or 0.0
        if size is None or size <= 0.0 or x is None or y is None or not isinstance(lod.get("level"), int):
            continue
        if (least > 0.0 and scale < least * (1.0 - _SCALE_SLACK)) or (
            most > 0.0 and scale > most * (1.0 + _SCALE_SLACK)
        ):
            continue
        columns, rows = _columns(info.get("fullExtent"), x, y, size * tiles["cols"], size * tiles["rows"])
        made.append(
            SimpleNamespace(
                identifier=str(lod["level"]),
                scaledenominator=size * unit / SCALE_PX_M,
                topleftcorner=(x, y),
                tilewidth=tiles["cols"],
                tileheight=tiles["rows"],
                matrixwidth=columns,
                matrixheight=rows,
            )
        )
    return made


def _columns(extent: object, x: float, y: float, width: float, height: float) -> tuple[int, int]:
    """Columns and rows of tiles, of a size in the system's unit, from a corner to the end of an extent."""
    edges = _edges(extent)
    if edges is None:
        return 1, 1
    return max(math.ceil((edges[2] - x) / width), 1), max(math.ceil((y - edges[1]) / height), 1)


def _edges(extent: object) -> tuple[float, float, float, float] | None:
    if not isinstance(extent, Mapping):
        return None
    edges = [number_of(extent.get(name)) for name in ("xmin", "ymin", "xmax", "ymax")]
    west, south, east, north = (math.nan if edge is None else edge for edge in edges)
    return (west, south, east, north) if west < east and south < north else None


def _code(reference: object) -> str:
    """``EPSG:code`` of a spatial reference; empty where it names none."""
    if not isinstance(reference, Mapping):
        return ""
    for name in ("latestWkid", "wkid"):
        if isinstance(reference.get(name), int):
            return epsg_code(f"EPSG:{reference[name]}")
    return ""


def _bounds_of(info: Mapping[str, Any]) -> Bounds:
    """West, south, east and north in degrees of a service's full extent; the world where it is not known."""
    extent = info.get("fullExtent") or info.get("extent")
    edges = _edges(extent)
    code = _code(extent.get("spatialReference")) if isinstance(extent, Mapping) else ""
    if edges is None or not code:
        return WORLD_DEG
    from pyproj import Transformer
    from pyproj.exceptions import ProjError

    try:
        to_degrees = Transformer.from_crs(code, "EPSG:4326", always_xy=True)
        x, y = np.meshgrid(np.linspace(edges[0], edges[2], _ALONG), np.linspace(edges[1], edges[3], _ALONG))
        lon, lat = through_proj(to_degrees.transform, x, y)
    except ProjError:
        return WORLD_DEG
    there = np.isfinite(lon) & np.isfinite(lat)
    if not there.all():
        return WORLD_DEG
    return sound_bounds(float(lon.min()), float(lat.min()), float(lon.max()), float(lat.max()))


def _pixel_m(info: Mapping[str, Any]) -> float | None:
    """Metres of ground of an image service's own pixels, about; None where it does not say it."""
    size, extent = number_of(info.get("pixelSizeX")), info.get("extent") or info.get("fullExtent")
    code = _code(extent.get("spatialReference")) if isinstance(extent, Mapping) else ""
    if size is None or size <= 0.0 or not code:
        return None
    if code == MAP:
        _, south, _, north = _bounds_of(info)
        return size * math.cos(math.radians(min(abs(south + north) / 2.0, _STEEPEST_DEG)))
    return size * unit_m(code) if is_usable(code) else size * _DEGREE_M
