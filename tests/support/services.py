"""A WMTS and a WMS on the loopback: capabilities written for the test, tiles whose pixels encode their position."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, urlsplit
from xml.sax.saxutils import escape

import numpy as np
from terrainav.core.imagery.opening import SourceOptions, named_source

from tests.support import patterns

# Half the circumference of the sphere of EPSG:3857, by its radius.
HALF_M = math.pi * 6378137.0
# Function of a path and a query's parameters, in upper case, that returns a status, media type and body.
Answer = Callable[[str, dict], "tuple[int, str, bytes]"]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def do_GET(self):
        parts = urlsplit(self.path)
        query = {name.upper(): values[0] for name, values in parse_qs(parts.query, keep_blank_values=True).items()}
        self.server.asked.append(self.path)
        status, kind, body = self.server.owner.answer(parts.path, query)
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *args):
        """Say nothing."""


def png(picture):
    """Answer with an image."""
    return 200, "image/png", patterns.to_bytes(picture, "png")


def xml(body, status=200):
    """Answer with a document."""
    return status, "text/xml", body


def service_entry(name, **options):
    """Entry of a layer, from the capabilities of its service."""
    return named_source(name, SourceOptions(**options)).entry


class ServiceServer:
    """A server that runs while its context is open; ``answer`` is set by the test and may use ``url``.

    Attributes
    ----------
    asked : list of path and query
    """

    def __init__(self, answer: Answer | None = None):
        self._http = ThreadingHTTPServer(("127.0.0.1", 0), _Handler)
        self._http.daemon_threads = True
        self._http.asked = self.asked = []
        self._http.owner = self
        self.answer = answer
        self._thread = threading.Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()

    @property
    def url(self) -> str:
        """Address of the server."""
        return f"http://127.0.0.1:{self._http.server_address[1]}"


def matrix(
    identifier: str,
    zoom: int,
    tile_px: int = 256,
    *,
    corner=None,
    scale: float = 1.0,
    width: int | None = None,
) -> str:
    """Write a tile matrix of the Web-Mercator quad, or one that differs from it."""
    # By the standard: metres of a pixel over those of a pixel at scale 1:1.
    denominator = 2 * HALF_M / (tile_px * 2**zoom) / 0.00028 * scale
    west, north = corner or (-HALF_M, HALF_M)
    return f"""<TileMatrix><ows:Identifier>{identifier}</ows:Identifier>
<ScaleDenominator>{denominator!r}</ScaleDenominator><TopLeftCorner>{west!r} {north!r}</TopLeftCorner>
<TileWidth>{tile_px}</TileWidth><TileHeight>{tile_px}</TileHeight>
<MatrixWidth>{width or 2**zoom}</MatrixWidth><MatrixHeight>{2**zoom}</MatrixHeight></TileMatrix>"""


def matrix_set(name: str, matrices: list[str], crs: str = "urn:ogc:def:crs:EPSG::3857") -> str:
    """Write a tile matrix set."""
    return (
        f"<TileMatrixSet><ows:Identifier>{name}</ows:Identifier><ows:SupportedCRS>{crs}</ows:SupportedCRS>"
        f"{''.join(matrices)}</TileMatrixSet>"
    )


def wmts_layer(
    name: str,
    links: dict[str, list[str]],
    *,
    title: str = "Orthophotos",
    formats=("image/png",),
    resources=(),
    dimensions: str = "",
    styles=(("default", True),),
    bounds=None,
) -> str:
    """Write a layer.

    ``links`` maps tile matrix sets to the matrices that the layer has: a list of names (empty for all), or a mapping of
    names to limits, which are first column and row, last column and row. ``bounds`` are west, south, east and north in
    degrees.
    """
    texts = []
    for matrix_set_name, limited in links.items():
        ends = limited if isinstance(limited, dict) else dict.fromkeys(limited, (0, 0, 1 << 24, 1 << 24))
        limits = "".join(
            f"<TileMatrixLimits><TileMatrix>{one}</TileMatrix><MinTileRow>{top}</MinTileRow>"
            f"<MaxTileRow>{bottom}</MaxTileRow><MinTileCol>{left}</MinTileCol><MaxTileCol>{right}</MaxTileCol>"
            "</TileMatrixLimits>"
            for one, (left, top, right, bottom) in ends.items()
        )
        limits = f"<TileMatrixSetLimits>{limits}</TileMatrixSetLimits>" if limits else ""
        texts.append(f"<TileMatrixSetLink><TileMatrixSet>{matrix_set_name}</TileMatrixSet>{limits}</TileMatrixSetLink>")
    shown = "".join(
        f'<Style isDefault="{str(default).lower()}"><ows:Identifier>{style}</ows:Identifier></Style>'
        for style, default in styles
    )
    rest = "".join(
        f'<ResourceURL format="{kind}" resourceType="tile" template="{escape(url)}"/>' for kind, url in resources
    )
    listed = "".join(f"<Format>{kind}</Format>" for kind in formats)
    west, south, east, north = bounds or 4 * (0,)
    box = (
        f"<ows:WGS84BoundingBox><ows:LowerCorner>{west} {south}</ows:LowerCorner>"
        f"<ows:UpperCorner>{east} {north}</ows:UpperCorner></ows:WGS84BoundingBox>"
        if bounds
        else ""
    )
    return (
        f"<Layer><ows:Title>{title}</ows:Title>{box}<ows:Identifier>{name}</ows:Identifier>{shown}{listed}{dimensions}"
        f"{''.join(texts)}{rest}</Layer>"
    )


def wmts_document(layers: list[str], sets: list[str], *, get_tile: str = "") -> bytes:
    """Write the capabilities of a WMTS; ``get_tile`` is the address of its GetTile by query."""
    operation = (
        f"""<ows:OperationsMetadata><ows:Operation name="GetTile"><ows:DCP><ows:HTTP><ows:Get xlink:href="{get_tile}">
<ows:Constraint name="GetEncoding"><ows:AllowedValues><ows:Value>KVP</ows:Value></ows:AllowedValues></ows:Constraint>
</ows:Get></ows:HTTP></ows:DCP></ows:Operation></ows:OperationsMetadata>"""
        if get_tile
        else ""
    )
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<Capabilities xmlns="http://www.opengis.net/wmts/1.0" xmlns:ows="http://www.opengis.net/ows/1.1"
 xmlns:xlink="http://www.w3.org/1999/xlink" version="1.0.0">
<ows:ServiceIdentification><ows:Title>Tiles</ows:Title><ows:ServiceType>OGC WMTS</ows:ServiceType>
<ows:ServiceTypeVersion>1.0.0</ows:ServiceTypeVersion><ows:Fees>none</ows:Fees>
<ows:AccessConstraints>name the
 survey</ows:AccessConstraints></ows:ServiceIdentification>
<ows:ServiceProvider><ows:ProviderName>Survey of Somewhere</ows:ProviderName></ows:ServiceProvider>
{operation}<Contents>{"".join(layers)}{"".join(sets)}</Contents></Capabilities>""".encode()


def dimension(name: str, default: str, *values: str) -> str:
    """Write a dimension of a WMTS layer."""
    listed = "".join(f"<Value>{value}</Value>" for value in values)
    return f"<Dimension><ows:Identifier>{name}</ows:Identifier><Default>{default}</Default>{listed}</Dimension>"


def wms_document(version: str, url: str, layers: str, formats=("image/jpeg", "image/png"), fees: str = "none") -> bytes:
    """Write the capabilities of a WMS of either version."""
    listed = "".join(f"<Format>{kind}</Format>" for kind in formats)
    where = f'<OnlineResource xmlns:xlink="http://www.w3.org/1999/xlink" xlink:href="{escape(url)}"/>'
    new = version == "1.3.0"
    root = "WMS_Capabilities" if new else "WMT_MS_Capabilities"
    space = ' xmlns="http://www.opengis.net/wms"' if new else ""
    get = f"<DCPType><HTTP><Get>{where}</Get></HTTP></DCPType>"
    return f"""<?xml version="1.0"?>
<{root} version="{version}"{space}><Service><Name>WMS</Name><Title>Maps</Title>{where}
<ContactInformation><ContactPersonPrimary><ContactPerson>-</ContactPerson>
<ContactOrganization>Survey of Somewhere</ContactOrganization></ContactPersonPrimary></ContactInformation>
<Fees>{fees}</Fees><AccessConstraints>None</AccessConstraints></Service>
<Capability><Request><GetCapabilities><Format>text/xml</Format>{get}</GetCapabilities>
<GetMap>{listed}{get}</GetMap></Request><Exception><Format>XML</Format></Exception>
{layers}</Capability></{root}>""".encode()


def painted(query: dict) -> np.ndarray:
    """Paint the answer to a GetMap: pixels hold their position on the pixel grid that its BBOX and size imply."""
    west, south, east, north = (float(edge) for edge in query["BBOX"].split(","))
    width, height = int(query["WIDTH"]), int(query["HEIGHT"])
    size_x, size_y = (east - west) / width, (north - south) / height
    columns = np.floor((west + (np.arange(width) + 0.5) * size_x + HALF_M) / size_x)
    rows = np.floor((HALF_M - north + (np.arange(height) + 0.5) * size_y) / size_y)
    return patterns.encode_position(columns.astype(np.int64), rows.astype(np.int64))


@dataclass(frozen=True)
class NationalSet:
    """A tile matrix set in a projected CRS, as of a real service.

    Parameters
    ----------
    name : str
    epsg : int
    west, north : float
        Easting and northing of the upper left corner.
    width, height : float
        Size of the set, in the CRS's unit.
    resolutions : mapping of identifier to units a pixel
    tile_px : int
    unit_m : float
        Metres of the unit.
    """

    name: str
    epsg: int
    west: float
    north: float
    width: float
    height: float
    resolutions: dict[str, float]
    tile_px: int = 256
    unit_m: float = 1.0

    def text(self, *, northing_first: bool = False, crs: str = "urn:ogc:def:crs:EPSG::{}") -> str:
        """Write the set, with its corner in either axis order."""
        corner = (self.north, self.west) if northing_first else (self.west, self.north)
        matrices = [
            f"<TileMatrix><ows:Identifier>{name}</ows:Identifier>"
            f"<ScaleDenominator>{size * self.unit_m / 0.00028!r}</ScaleDenominator>"
            f"<TopLeftCorner>{corner[0]!r} {corner[1]!r}</TopLeftCorner>"
            f"<TileWidth>{self.tile_px}</TileWidth><TileHeight>{self.tile_px}</TileHeight>"
            f"<MatrixWidth>{self.columns(name)[0]}</MatrixWidth><MatrixHeight>{self.columns(name)[1]}</MatrixHeight>"
            "</TileMatrix>"
            for name, size in self.resolutions.items()
        ]
        return matrix_set(self.name, matrices, crs.format(self.epsg))

    def columns(self, name: str) -> tuple[int, int]:
        """Columns and rows of tiles of a matrix."""
        across = self.resolutions[name] * self.tile_px
        return math.ceil(self.width / across), math.ceil(self.height / across)

    def tile(self, name: str, column: int, row: int) -> np.ndarray:
        """Paint a tile, whose pixels hold their column and row from the corner."""
        steps = np.arange(self.tile_px)
        return patterns.encode_position(column * self.tile_px + steps, row * self.tile_px + steps)


#: Set of swisstopo, in which few levels halve the pixels of the level before.
SWISS = NationalSet(
    "2056_28",
    2056,
    2_420_000.0,
    1_350_000.0,
    480_000.0,
    320_000.0,
    {
        str(at): float(size)
        for at, size in enumerate(
            "4000 3750 3500 3250 3000 2750 2500 2250 2000 1750 1500 1250 1000 750 650 500 250 100 50 20 10 5 2.5 2 1.5 "
            "1 0.5 0.25 0.1".split()
        )
    },
)
#: Set of PDOK.
DUTCH = NationalSet(
    "EPSG:28992",
    28992,
    -285_401.92,
    903_401.92,
    880_803.84,
    880_803.84,
    {f"{zoom:02d}": 3440.64 / 2**zoom for zoom in range(17)},
)
#: Sets of NASA GIBS about both poles.
ANTARCTIC = NationalSet(
    "250m",
    3031,
    -4_194_304.0,
    4_194_304.0,
    8_388_608.0,
    8_388_608.0,
    {str(zoom): 8192.0 / 2**zoom for zoom in range(6)},
    512,
)
ARCTIC = NationalSet(
    "31.25m",
    3413,
    -4_194_304.0,
    4_194_304.0,
    8_388_608.0,
    8_388_608.0,
    {str(zoom): 8192.0 / 2**zoom for zoom in range(9)},
    512,
)
#: Set in a CRS whose axis order is northing, easting.
EUROPEAN = NationalSet(
    "inspire",
    3035,
    900_000.0,
    5_500_000.0,
    6_500_000.0,
    4_600_000.0,
    {f"L{zoom}": 4096.0 / 2**zoom for zoom in range(13)},
)


def painted_by(query: dict, pixel: float, west: float, north: float, *, northing_first: bool = False) -> np.ndarray:
    """Paint the answer to a GetMap: pixels, ``pixel`` units wide, hold their column and row from a corner."""
    edges = [float(edge) for edge in query["BBOX"].split(",")]
    x0, y0, x1, y1 = (edges[at] for at in ((1, 0, 3, 2) if northing_first else (0, 1, 2, 3)))
    width, height = int(query["WIDTH"]), int(query["HEIGHT"])
    assert abs((x1 - x0) / width / pixel - 1.0) < 1e-12
    assert abs((y1 - y0) / height / pixel - 1.0) < 1e-12
    columns = np.floor((x0 - west) / pixel + np.arange(width) + 0.5)
    rows = np.floor((north - y1) / pixel + np.arange(height) + 0.5)
    return patterns.encode_position(columns.astype(np.int64), rows.astype(np.int64))
