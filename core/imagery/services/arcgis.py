"""Map and image services of ArcGIS Server, through its REST interface.

``arcgis:URL`` names a service by its address, ``…/rest/services/NAME/MapServer`` or ``…/ImageServer``. Choices after
``#`` are ``layers=0,2``, which selects layers of a map service by number, and ``format``. Alternatively,
``arcgis:…/rest/services#service=NAME/MapServer`` names a service of a server. A key in the address is written
``?token={key}``.

Cached tiles of a service (``singleFusedMapCache``), ``tile/{level}/{row}/{column}``, are used if they form a grid
(`matrices`) in the wanted system and no layers are chosen. Otherwise the service draws tiles by ``export`` or
``exportImage``, in the Web-Mercator grid or, as for a WMS (`ogc`), in the plane of any other system. Documentation:
ArcGIS REST API, "Map Service" and "Image Service".
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
from .json_service import JSONService, read_number, read_objects, read_text, set_query, sound_bounds
from .matrices import SCALE_PX_M, chosen_tiles
from .ogc import finest_zoom, own_plane

_ADDRESS = re.compile(r"(?P<base>.*/(?P<kind>MapServer|ImageServer))(?:/(?P<layer>\d+))?/?$", re.IGNORECASE)
#: Relative tolerance of scales, which services round to whole numbers or to six digits.
_SCALE_SLACK = 1e-3


class ArcGISService(JSONService):
    """A map or image service of ArcGIS Server as a mission names it."""

    def _document(self) -> Document:
        return self._json(self._filled(set_query(self._base, {"f": "json"})), Message("description"))

    @property
    def _base(self) -> str:
        """Address, with query, of the service or, if no service is named, of the list of services."""
        parts = urlsplit(self.service.address)
        path, service = parts.path.rstrip("/"), self.service.choices.get("service")
        if service:
            # Names include the folder, even in the list of a folder.
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
            # The chosen service may be the only one, without a name in the text.
            named = type(self)(f"{self.service.kind}:{self.service.address}#service={chosen}", self.options)
            return named._find()  # noqa: SLF001
        info: Mapping[str, Any] = document.root
        cached = self._cached(document) if self._is_cached(info) else None
        if cached is not None:
            return cached
        # The operation that draws tiles, and the capability that a service must state for it.
        operation, capability = {"mapserver": ("export", "Map"), "imageserver": ("exportImage", "Image")}[self._kind]
        stated = read_text(info.get("capabilities"))
        if stated and capability not in stated.split(","):
            raise document.wrong(
                Message("it neither has tiles nor draws maps in this system: it offers {0}", stated or "nothing")
            )
        return self._drawn(document, operation)

    def _is_cached(self, info: Mapping[str, Any]) -> bool:
        """Whether a service has cached tiles, of imagery, and neither layers nor a format are chosen."""
        tiles = info.get("tileInfo")
        return (
            info.get("singleFusedMapCache") is True
            and isinstance(tiles, Mapping)
            # LERC tiles contain heights, not imagery.
            and not read_text(tiles.get("format")).upper().startswith("LERC")
            and not self._chosen_layers
            and "format" not in self.service.choices
        )

    def _cached(self, document: Document) -> CatalogueEntry | None:
        """Entry of the cached tiles; None if they form no grid in the wanted system."""
        info = document.root
        tiles = info["tileInfo"]
        bounds = _full_bounds(info)
        crs = _code(tiles.get("spatialReference") or info.get("spatialReference"))
        matrices = _levels(info, crs)
        name = read_text(info.get("mapName")) or "tiles"
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
        """Entry of tiles drawn by the service."""
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
            # 96 dpi: draw symbols at their size on screens.
            **({"transparent": "true", "dpi": "96"} if operation == "export" else {}),
            "f": "image",
        }
        bounds = _full_bounds(info)
        highest = DEFAULT_MAX_ZOOM if plane is None else finest_zoom(plane, tile_px)
        width_m = 2.0 * HALF_WORLD_M if plane is None else plane.width * plane.unit_m
        ground_m = _pixel_m(info)
        if ground_m is not None:
            pixel_m = ground_m / (_parallel_share(bounds) if plane is None else 1.0)
            highest = min(highest, max(math.ceil(math.log2(width_m / (pixel_m * tile_px)) - 0.01), 0))
        least = read_number(info.get("maxScale")) or 0.0
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
        document_info = info.get("documentInfo")
        author = read_text(document_info.get("Author")) if isinstance(document_info, Mapping) else ""
        credit = read_text(info.get("copyrightText")) or author
        return self._made(self._title(info), credit, url, Policy(), bounds_deg=bounds, **tiles)

    def _title(self, info: Mapping[str, Any]) -> str:
        document_info = info.get("documentInfo")
        title = read_text(document_info.get("Title")) if isinstance(document_info, Mapping) else ""
        path = urlsplit(self._base).path.rpartition("/rest/services/")[2].rpartition("/")[0]
        name = title or read_text(info.get("name")) or path or read_text(info.get("mapName"))
        chosen = self._chosen_layers.split(",") if self._chosen_layers else []
        names = {str(one.get("id")): read_text(one.get("name")) for one in read_objects(info.get("layers"))}
        layers = ", ".join(names[one] for one in chosen if names.get(one))
        return f"{name}: {layers}" if layers else name

    def _format(self, document: Document) -> str:
        wanted = self.service.choices.get("format")
        stated = read_text(document.root.get("supportedImageFormatTypes")).lower().replace(" ", "").split(",")
        # In order of preference, formats with transparency first. Image services state no formats and offer all these.
        formats = ["png32", "png24", "png", "png8", "jpgpng", "jpg"]
        offered = [one for one in formats if one in stated] or formats
        return chosen_one(document, "format", (wanted or offered[0]).lower(), dict.fromkeys(offered, ""))

    def _template(self, document: Document, path: str, query: Mapping[str, str]) -> str:
        parts = urlsplit(self._base)
        address = urlunsplit(parts._replace(path=f"{parts.path}/{path}"))
        return document.without_key(set_query(address, query) if query else address)


def _refuse_error(document: Document) -> None:
    """Raise if the document, of status 200, states an error."""
    error = document.root.get("error")
    if isinstance(error, Mapping):
        code, words = error.get("code"), read_text(error.get("message"))
        reason = f"{code} {words}" if isinstance(code, int) else words
        raise document.wrong(Message("refused ({0})", reason or Message("no reason given")))


def _services(document: Document) -> dict[str, Offered]:
    """Map and image services of a server or a folder, by name."""
    root = document.root
    if not isinstance(root.get("services"), list):
        raise document.wrong(Message("neither a map service nor an image service, nor a list of them"))
    names = [
        f"{one_line(one['name'])}/{one['type']}"
        for one in read_objects(root["services"])
        if isinstance(one.get("name"), str) and one.get("type") in ("MapServer", "ImageServer")
    ]
    return {name: Offered(name, name.rpartition("/")[0]) for name in names}


def _check_layers(document: Document, layers: str) -> None:
    names = {str(one.get("id")): read_text(one.get("name")) for one in read_objects(document.root.get("layers"))}
    for one in layers.split(","):
        chosen_one(document, "layers", one.strip(), names)


def _levels(info: Mapping[str, Any], crs: str) -> list[SimpleNamespace]:
    """Tile matrices of the cached tiles within the scales of the service, in the form of OWSLib."""
    tiles = info["tileInfo"]
    least, most = (read_number(info.get(name)) or 0.0 for name in ("maxScale", "minScale"))
    x, y = (read_number(tiles["origin"].get(axis)) for axis in "xy")
    unit = unit_m(crs) if crs != MAP and is_usable(crs) else 1.0
    levels = []
    # Read at most 100 levels; ArcGIS Server's default schemes have up to 24.
    for lod in read_objects(tiles.get("lods"))[:100]:
        size, scale = read_number(lod.get("resolution")), read_number(lod.get("scale")) or 0.0
        if size is None or size <= 0.0 or x is None or y is None or not isinstance(lod.get("level"), int):
            continue
        if (least > 0.0 and scale < least * (1.0 - _SCALE_SLACK)) or (
            most > 0.0 and scale > most * (1.0 + _SCALE_SLACK)
        ):
            continue
        columns, rows = _columns(info.get("fullExtent"), x, y, size * tiles["cols"], size * tiles["rows"])
        levels.append(
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
    return levels


def _columns(extent: object, x: float, y: float, width: float, height: float) -> tuple[int, int]:
    """Numbers of columns and rows of tiles from a corner to the end of an extent; sizes are in the system's unit."""
    edges = _edges(extent)
    if edges is None:
        return 1, 1
    return max(math.ceil((edges[2] - x) / width), 1), max(math.ceil((y - edges[1]) / height), 1)


def _edges(extent: object) -> tuple[float, float, float, float] | None:
    if not isinstance(extent, Mapping):
        return None
    edges = [read_number(extent.get(name)) for name in ("xmin", "ymin", "xmax", "ymax")]
    west, south, east, north = (math.nan if edge is None else edge for edge in edges)
    return (west, south, east, north) if west < east and south < north else None


def _code(reference: object) -> str:
    """``EPSG:code`` of a spatial reference; empty without one."""
    if not isinstance(reference, Mapping):
        return ""
    for name in ("latestWkid", "wkid"):
        if isinstance(reference.get(name), int):
            return epsg_code(f"EPSG:{reference[name]}")
    return ""


def _full_bounds(info: Mapping[str, Any]) -> Bounds:
    """West, south, east and north of a service's full extent in degrees; the world if unknown."""
    extent = info.get("fullExtent") or info.get("extent")
    edges = _edges(extent)
    code = _code(extent.get("spatialReference")) if isinstance(extent, Mapping) else ""
    if edges is None or not code:
        return WORLD_DEG
    from pyproj import Transformer
    from pyproj.exceptions import ProjError

    try:
        to_degrees = Transformer.from_crs(code, "EPSG:4326", always_xy=True)
        x, y = np.meshgrid(np.linspace(edges[0], edges[2], 9), np.linspace(edges[1], edges[3], 9))
        lon, lat = through_proj(to_degrees.transform, x, y)
    except ProjError:
        return WORLD_DEG
    if not (np.isfinite(lon) & np.isfinite(lat)).all():
        return WORLD_DEG
    return sound_bounds(float(lon.min()), float(lat.min()), float(lon.max()), float(lat.max()))


def _parallel_share(bounds: Bounds) -> float:
    """Length of the parallel through the middle of bounds (at most 85 degrees) as a fraction of the equator's."""
    return math.cos(math.radians(min(abs(bounds[1] + bounds[3]) / 2.0, 85.0)))


def _pixel_m(info: Mapping[str, Any]) -> float | None:
    """Approximate ground size of an image service's pixels in metres; None if unknown."""
    size, extent = read_number(info.get("pixelSizeX")), info.get("extent") or info.get("fullExtent")
    code = _code(extent.get("spatialReference")) if isinstance(extent, Mapping) else ""
    if size is None or size <= 0.0 or not code:
        return None
    if code == MAP:
        return size * _parallel_share(_full_bounds(info))
    # Systems that are not usable have degrees.
    return size * unit_m(code) if is_usable(code) else size * HALF_WORLD_M / 180.0
