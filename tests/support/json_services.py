"""Documents of ArcGIS REST services and of an OGC API, in the form that real servers send."""

from __future__ import annotations

import json
import math

#: Half the circumference of the sphere of EPSG:3857, by its radius; ArcGIS Server writes it with 17 digits.
HALF_M = math.pi * 6378137.0
MERCATOR = {"wkid": 102100, "latestWkid": 3857}
#: Extent of these services' imagery, around Memphis.
EXTENT_M = {"xmin": -10_040_000.0, "ymin": 4_160_000.0, "xmax": -9_980_000.0, "ymax": 4_200_000.0}
DEGREES = "http://www.opengis.net/def/crs/OGC/1.3/CRS84"
REL = "http://www.opengis.net/def/rel/ogc/1.0/"


def answer_of(document: object) -> tuple[int, str, bytes]:
    """Write a JSON answer."""
    return 200, "application/json", json.dumps(document).encode()


def lods(levels=range(24), first=156543.03392800014):
    """Levels of a cache, as ArcGIS Online has them."""
    return [
        {"level": level, "resolution": first / 2**level, "scale": first / 2**level * 96 / 0.0254} for level in levels
    ]


def map_service(*, cached: bool = True, **more) -> dict:
    """Describe a map service (``MapServer?f=json``)."""
    document = {
        "currentVersion": 10.91,
        "serviceDescription": "<b>Orthophotos</b>",
        "mapName": "Layers",
        "description": "",
        "copyrightText": "Survey of Somewhere",
        "layers": [
            {"id": 0, "name": "Imagery", "parentLayerId": -1, "defaultVisibility": True, "subLayerIds": None},
            {"id": 2, "name": "Parcels", "parentLayerId": -1, "defaultVisibility": True, "subLayerIds": None},
        ],
        "tables": [],
        "spatialReference": MERCATOR,
        "singleFusedMapCache": cached,
        "initialExtent": {**EXTENT_M, "spatialReference": MERCATOR},
        "fullExtent": {**EXTENT_M, "spatialReference": MERCATOR},
        "minScale": 5.91657527591555e8,
        "maxScale": 1128.4994,
        "units": "esriMeters",
        "supportedImageFormatTypes": "PNG32,PNG24,PNG,JPG,DIB,TIFF,EMF,PS,PDF,GIF,SVG,SVGZ,BMP",
        "documentInfo": {"Title": "Orthophotos 2023", "Author": "Mapping", "Comments": ""},
        "capabilities": "Map,Query,Data",
        "maxImageHeight": 4096,
        "maxImageWidth": 4096,
    }
    if cached:
        document["tileInfo"] = {
            "rows": 256,
            "cols": 256,
            "dpi": 96,
            "format": "JPEG",
            "compressionQuality": 90,
            "origin": {"x": -20037508.342787, "y": 20037508.342787},
            "spatialReference": MERCATOR,
            "lods": lods(),
        }
    return {**document, **more}


def image_service(**more) -> dict:
    """Describe an image service (``ImageServer?f=json``)."""
    utm = {"wkid": 26916, "latestWkid": 26916}
    return {
        "currentVersion": 10.81,
        "serviceDescription": "",
        "name": "Ortho/Shelby",
        "description": "",
        "extent": {
            "xmin": 225_000.0,
            "ymin": 3_880_000.0,
            "xmax": 235_000.0,
            "ymax": 3_890_000.0,
            "spatialReference": utm,
        },
        "pixelSizeX": 0.3,
        "pixelSizeY": 0.3,
        "bandCount": 3,
        "pixelType": "U8",
        "copyrightText": "County of Shelby",
        "serviceDataType": "esriImageServiceDataTypeRGB",
        "singleFusedMapCache": False,
        "capabilities": "Image,Metadata",
        "maxImageHeight": 4100,
        "maxImageWidth": 15000,
        "spatialReference": utm,
        **more,
    }


def landing(url: str, *links: dict) -> dict:
    """Write a landing page of an OGC API."""
    return {
        "title": "Maps of Somewhere",
        "description": "",
        "links": [
            {"rel": "self", "type": "application/json", "href": f"{url}/"},
            {"rel": "conformance", "type": "application/json", "href": f"{url}/conformance"},
            {"rel": "data", "type": "application/json", "href": f"{url}/collections"},
            *links,
        ],
    }


def collection(url: str, name: str, *, kind: str = "map", **more) -> dict:
    """Describe a collection, with links to its tiles."""
    return {
        "id": name,
        "title": name.title(),
        "attribution": "Survey of Somewhere",
        "extent": {"spatial": {"bbox": [[-90.2, 34.9, -89.6, 35.3]], "crs": DEGREES}},
        "links": [
            {"rel": "self", "type": "application/json", "href": f"{url}/collections/{name}"},
            {"rel": "license", "title": "CC BY 4.0", "href": "https://creativecommons.org/licenses/by/4.0/"},
            {"rel": f"{REL}tilesets-{kind}", "type": "text/html", "href": f"{url}/nowhere.html"},
            {
                "rel": f"{REL}tilesets-{kind}",
                "type": "application/json",
                "href": f"/collections/{name}/{kind}/tiles",
            },
        ],
        **more,
    }


def tileset(url: str, base: str, name: str, crs: str, *, limits=(), data: str = "map", **more) -> dict:
    """Describe a tileset; ``limits`` are a matrix, first row, last row, first column and last column."""
    return {
        "title": "Tiles",
        "dataType": data,
        "crs": crs,
        "tileMatrixSetURI": f"http://www.opengis.net/def/tilematrixset/OGC/1.0/{name}",
        "tileMatrixSetLimits": [
            {
                "tileMatrix": one,
                "minTileRow": top,
                "maxTileRow": bottom,
                "minTileCol": left,
                "maxTileCol": right,
            }
            for one, top, bottom, left, right in limits
        ],
        "links": [
            {"rel": "self", "type": "application/json", "href": f"{url}{base}/{name}"},
            {
                "rel": f"{REL}tiling-scheme",
                "type": "application/json",
                "href": f"{url}/tileMatrixSets/{name}",
            },
            *(
                {
                    "rel": "item",
                    "type": f"image/{kind}",
                    "href": f"{url}{base}/{name}/{{tileMatrix}}/{{tileRow}}/{{tileCol}}?f={kind}",
                    "templated": True,
                }
                for kind in ("jpeg", "png")
            ),
        ],
        **more,
    }


def matrix_set(name: str, crs: str, corner, sizes, tile_px: int = 256, span: float = 1.0) -> dict:
    """Describe a tile matrix set with pixels of sizes in metres; ``corner`` has the axis order of the CRS."""
    return {
        "id": name,
        "crs": crs,
        "tileMatrices": [
            {
                "id": f"L{at}",
                "scaleDenominator": size / 0.00028,
                "cellSize": size,
                "cornerOfOrigin": "topLeft",
                "pointOfOrigin": list(corner),
                "tileWidth": tile_px,
                "tileHeight": tile_px,
                "matrixWidth": math.ceil(span / (size * tile_px)),
                "matrixHeight": math.ceil(span / (size * tile_px)),
            }
            for at, size in enumerate(sizes)
        ],
    }
