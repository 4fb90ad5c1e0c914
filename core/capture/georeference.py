"""Georeferences of images: the edges of a map frame, and the ground control points of a camera frame."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..arrays import Floats
from ..bands import RGB, Bands, unnamed
from ..errors import InvalidInput
from ..geodesy.mercator import WebMercator
from ..geodesy.reference import read_reference
from ..mission.plan import Plan
from .metadata import degrees, metres, xml_text
from .tiff import Tag, TagType

#: WGS 84 and Web Mercator as WKT 1, which every GDAL reads, independent of PROJ's version and database.
WGS84_WKT = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],'
    'AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],'
    'UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]]'
)
WEB_MERCATOR_WKT = (
    f'PROJCS["WGS 84 / Pseudo-Mercator",{WGS84_WKT},PROJECTION["Mercator_1SP"],PARAMETER["central_meridian",0],'
    'PARAMETER["scale_factor",1],PARAMETER["false_easting",0],PARAMETER["false_northing",0],'
    'UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],AXIS["Northing",NORTH],'
    'EXTENSION["PROJ4","+proj=merc +a=6378137 +b=6378137 +lat_ts=0 +lon_0=0 +x_0=0 +y_0=0 +k=1 +units=m '
    '+nadgrids=@null +wktext +no_defs"],AUTHORITY["EPSG","3857"]]'
)


@dataclass(frozen=True)
class Georeference:
    """Edges, size and orientation of a map frame.

    Parameters
    ----------
    west_m, south_m, east_m, north_m : float
        Outer edges of the outermost pixels in the CRS's unit; on EPSG:3857, ``east_m`` of an image across the
        antimeridian exceeds half the world's width.
    width_px, height_px : int
        Size of the image as written; the pixels need not be square.
    crs : str
        ``EPSG:code`` of a projected CRS, or its WKT.
    quarter_turns : int
        Quarter turns clockwise from the CRS's north to the top of the image.
    """

    west_m: float
    south_m: float
    east_m: float
    north_m: float
    width_px: int
    height_px: int
    crs: str = WebMercator.crs
    quarter_turns: int = 0

    def __post_init__(self) -> None:
        edges = (self.west_m, self.south_m, self.east_m, self.north_m)
        if not (all(map(math.isfinite, edges)) and self.west_m < self.east_m and self.south_m < self.north_m):
            raise InvalidInput("edges {0} m (west, south, east, north): need west < east and south < north", edges)
        if self.width_px < 1 or self.height_px < 1:
            raise InvalidInput("image of {0} x {1} px: needs at least one pixel", self.width_px, self.height_px)

    @property
    def pixel_size_m(self) -> tuple[float, float]:
        """Eastward and northward size of a pixel in the CRS's unit, both positive."""
        columns, rows = self.width_px, self.height_px
        if self.quarter_turns % 2:
            columns, rows = rows, columns
        return (self.east_m - self.west_m) / columns, (self.north_m - self.south_m) / rows

    @property
    def geotransform(self) -> tuple[float, float, float, float, float, float]:
        """GDAL's six numbers: easting of the upper left corner, and its change per column and per row; then northing.

        For a north-up image: west, pixel width, 0, north, 0, minus pixel height.
        """
        width_m, height_m = self.pixel_size_m
        if self.quarter_turns % 4 == 1:
            return (self.east_m, 0.0, -width_m, self.north_m, -height_m, 0.0)
        if self.quarter_turns % 4 == 2:
            return (self.east_m, -width_m, 0.0, self.south_m, 0.0, height_m)
        if self.quarter_turns % 4 == 3:
            return (self.west_m, 0.0, width_m, self.south_m, height_m, 0.0)
        return (self.west_m, width_m, 0.0, self.north_m, 0.0, -height_m)

    def world_file(self) -> str:
        """Text of an Esri world file of six lines; the last two are the centre of the upper left pixel."""
        x, across_x, down_x, y, across_y, down_y = self.geotransform
        middle = x + (across_x + down_x) / 2.0, y + (across_y + down_y) / 2.0
        return "".join(f"{value!r}\n" for value in (across_x, across_y, down_x, down_y, *middle))

    def aux_xml(self, metadata: Mapping[str, str], bands: Bands | None = None) -> str:
        """Text of GDAL's auxiliary file (PAM): CRS, geotransform and metadata, for formats that hold no CRS."""
        return _pam_text(
            f'  <SRS dataAxisToSRSAxisMapping="1,2">{xml_text(wkt_1(self.crs))}</SRS>\n'
            f"  <GeoTransform>{', '.join(map(repr, self.geotransform))}</GeoTransform>\n",
            metadata,
            bands,
        )

    def tags(self) -> list[Tag]:
        """GeoTIFF's tags (OGC 19-008): pixel size, position of the upper left corner, and the CRS.

        A turned image has the matrix from columns and rows to positions, in place of pixel size and position.
        """
        width_m, height_m = self.pixel_size_m
        citation = "" if self.crs.startswith("EPSG:") else _citation(self.crs)
        # Kind of CRS, pixels as areas, and the code; a CRS without a code is user-defined (32767), with a citation.
        keys = [(1024, 32767), (1025, 1)] if citation else [(1024, 1), (1025, 1), (3072, int(self.crs[5:]))]
        place = [
            Tag(33550, TagType.DOUBLE, [width_m, height_m, 0.0]),  # ModelPixelScale
            Tag(33922, TagType.DOUBLE, [0.0, 0.0, 0.0, self.west_m, self.north_m, 0.0]),  # ModelTiepoint
        ]
        if self.quarter_turns % 4:
            x, across_x, down_x, y, across_y, down_y = self.geotransform
            matrix = [across_x, down_x, 0.0, x, across_y, down_y, 0.0, y, *(0.0,) * 7, 1.0]
            place = [Tag(34264, TagType.DOUBLE, matrix)]  # ModelTransformation
        return [
            *place,
            Tag(34735, TagType.SHORT, _geo_keys(keys, citation)),
            *([Tag(34737, TagType.ASCII, citation)] if citation else []),
        ]


@dataclass(frozen=True, eq=False)
class ControlPoints:
    """Points of an image, each with the ground position that the exact camera sees there.

    Parameters
    ----------
    points : array (k, 5)
        Column and row in px from the upper left corner, longitude and latitude in degrees, height above
        the ellipsoid in metres. Longitudes are continuous with the camera's longitude.
    """

    points: Floats

    @classmethod
    def from_plan(cls, plan: Plan, index: int, width_px: int, height_px: int) -> ControlPoints:
        """Control points of a capture, evenly spread over the part of its image that sees the ground.

        Parameters
        ----------
        width_px, height_px : int
            Size of the image as written.
        """
        across, down = (9, 7) if width_px >= height_px else (7, 9)
        found = np.empty((0, 5))
        # Refine the grid if fewer points see the ground than a perspective view of a plane needs.
        fewest, doublings = 4, 4
        for doubling in range(doublings + 1):
            x, y = (
                values.ravel()
                for values in np.meshgrid(
                    np.linspace(-1.0, 1.0, (across << doubling) + 1),
                    np.linspace(1.0, -1.0, (down << doubling) + 1),
                )
            )
            seen, heights = plan.views.seen(index, tuple(zip(x.tolist(), y.tolist())))
            hit = seen.hit[0]
            lon, lat = ([degrees(angle) for angle in angles[0]] for angles in (seen.lon_deg, seen.lat_deg))
            columns = (
                (x + 1.0) / 2.0 * width_px,
                (1.0 - y) / 2.0 * height_px,
                np.array(lon),
                np.array(lat),
                np.array([metres(height) for height in heights[0]]),
            )
            found = np.stack(columns, axis=1)[hit]
            if len(found) >= fewest:
                break
        return cls(found)

    def aux_xml(self, metadata: Mapping[str, str], bands: Bands | None = None) -> str:
        """Text of GDAL's auxiliary file (PAM): the points, their CRS, and metadata."""
        points = "".join(
            f'    <GCP Id="{number}" Pixel="{column!r}" Line="{row!r}" X="{lon!r}" Y="{lat!r}" Z="{height!r}" />\n'
            for number, (column, row, lon, lat, height) in enumerate(self.points.tolist(), 1)
        )
        crs = xml_text(WGS84_WKT)
        place = f'  <GCPList Projection="{crs}" dataAxisToSRSAxisMapping="2,1">\n{points}  </GCPList>\n'
        return _pam_text(place, metadata, bands)

    def tags(self) -> list[Tag]:
        """GeoTIFF's tags: tie points, and the code of their geographic CRS."""
        ties = np.insert(self.points, 2, 0.0, axis=1).ravel().tolist()
        return [
            Tag(33922, TagType.DOUBLE, ties),  # ModelTiepoint
            Tag(34735, TagType.SHORT, _geo_keys([(1024, 2), (1025, 1), (2048, 4326)])),
        ]


def _citation(crs: str) -> str:
    """WKT of a CRS in the form that Esri and GDAL use in a GeoTIFF without code."""
    return f"ESRI PE String = {read_reference(crs).to_wkt('WKT1_ESRI')}|"


@lru_cache(maxsize=8)
def wkt_1(crs: str) -> str:
    """CRS as WKT 1, which every GDAL reads."""
    return WEB_MERCATOR_WKT if crs == WebMercator.crs else str(read_reference(crs).to_wkt("WKT1_GDAL"))


def _geo_keys(keys: list[tuple[int, int]], citation: str = "") -> list[int]:
    """GeoKey directory: keys with one number each, and a key for the CRS's citation, which is in another tag."""
    cited = [3073, 34737, len(citation), 0] if citation else []
    count = len(keys) + bool(cited)
    return [1, 1, 0, count, *(number for key, value in keys for number in (key, 0, 1, value)), *cited]


def _pam_text(place: str, metadata: Mapping[str, str], bands: Bands | None) -> str:
    """Text of GDAL's auxiliary file; ``place`` has the elements that georeference the image."""
    items = "".join(f'    <MDI key="{xml_text(key)}">{xml_text(value)}</MDI>\n' for key, value in metadata.items())
    of_bands = "" if bands is None else _pam_bands(bands)
    return f"<PAMDataset>\n{place}  <Metadata>\n{items}  </Metadata>\n{of_bands}</PAMDataset>\n"


def _pam_bands(bands: Bands) -> str:
    """Elements for bands with names, units or scales."""
    lines = []
    # These names say no more than the order of the bands.
    plain = (RGB.names, ("grey",), ("grey",) * len(RGB))
    names = [""] * len(bands) if bands.names in plain else bands.names
    for number, (name, about) in enumerate(zip(names, bands.each_metadata), 1):
        known = {"Description": name} if name not in ("", unnamed(number - 1)) else {}
        if about.unit:
            known["UnitType"] = about.unit
        if about.is_scaled:
            known.update(Offset=repr(about.offset), Scale=repr(about.scale))
        if known:
            inside = "".join(f"<{element}>{xml_text(text)}</{element}>" for element, text in known.items())
            lines.append(f'  <PAMRasterBand band="{number}">{inside}</PAMRasterBand>\n')
    return "".join(lines)
