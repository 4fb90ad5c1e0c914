"""A WMTS and a WMS on the loopback: capabilities written for the test, tiles whose pixels hold their own position."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, urlsplit
from xml.sax.saxutils import escape

import numpy as np

from tests.support import patterns

# Half the circumference of the sphere of EPSG:3857, by its radius.
HALF_M = math.pi * 6378137.0
# A query's parameters, in upper case, to a status, media type and body.
Answer = Callable[[str, dict], "tuple[int, str, bytes]"]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def do_GET(self):
        parts = urlsplit(self.path)
        query = {
            name.upper(): values[0] for name, values in parse_qs(parts.query, keep_blank_values=True).items()
        }
        self.server.asked.append(self.path)
        status, kind, body = self.server.owner.answer(parts.path, query)
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *args):
        """Say nothing."""


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
        self._thread = threading.Thread(
            target=self._http.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True
        )

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
    """Write a tile matrix of the Web-Mercator quad, or of one that is off it."""
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
) -> str:
    """Write a layer; ``links`` maps tile matrix sets to the matrices it is limited to, none for all."""
    texts = []
    for matrix_set_name, limited in links.items():
        limits = "".join(
            f"<TileMatrixLimits><TileMatrix>{one}</TileMatrix><MinTileRow>0</MinTileRow><MaxTileRow>1</MaxTileRow>"
            "<MinTileCol>0</MinTileCol><MaxTileCol>1</MaxTileCol></TileMatrixLimits>"
            for one in limited
        )
        limits = f"<TileMatrixSetLimits>{limits}</TileMatrixSetLimits>" if limits else ""
        texts.append(
            f"<TileMatrixSetLink><TileMatrixSet>{matrix_set_name}</TileMatrixSet>{limits}</TileMatrixSetLink>"
        )
    shown = "".join(
        f'<Style isDefault="{str(default).lower()}"><ows:Identifier>{style}</ows:Identifier></Style>'
        for style, default in styles
    )
    rest = "".join(
        f'<ResourceURL format="{kind}" resourceType="tile" template="{escape(url)}"/>'
        for kind, url in resources
    )
    listed = "".join(f"<Format>{kind}</Format>" for kind in formats)
    return (
        f"<Layer><ows:Title>{title}</ows:Title><ows:Identifier>{name}</ows:Identifier>{shown}{listed}{dimensions}"
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
    return (
        f"<Dimension><ows:Identifier>{name}</ows:Identifier><Default>{default}</Default>{listed}</Dimension>"
    )


def wms_document(
    version: str, url: str, layers: str, formats=("image/jpeg", "image/png"), fees: str = "none"
) -> bytes:
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
    """Paint what a GetMap asks for: pixels that hold their position on the grid of the zoom its BBOX is of."""
    west, south, east, north = (float(edge) for edge in query["BBOX"].split(","))
    width, height = int(query["WIDTH"]), int(query["HEIGHT"])
    size_x, size_y = (east - west) / width, (north - south) / height
    columns = np.floor((west + (np.arange(width) + 0.5) * size_x + HALF_M) / size_x)
    rows = np.floor((HALF_M - north + (np.arange(height) + 0.5) * size_y) / size_y)
    return patterns.encode_position(columns.astype(np.int64), rows.astype(np.int64))
