"""Exact position of a raster's pixels on the Web-Mercator map."""

from __future__ import annotations

import math

import numpy as np
from pyproj import CRS, Transformer
from pyproj.enums import TransformDirection
from pyproj.exceptions import ProjError

from ...arrays import Floats
from ...errors import InvalidInput
from ...geodesy.mercator import HALF_WORLD_M, PixelGrid, extent_of_outline, fitting_zoom
from ...geodesy.planes import ProjectedPlane
from ...geodesy.projections import through_proj
from ...geodesy.reference import read_reference
from ..source import Window
from ..systems import MAP
from .reading import Facts

TILE_PX = 256
#: Pixels closer than this coincide, px.
_SAME_PX = 1e-3


class RasterGeoreference:
    """Geotransform and coordinate reference system of a raster.

    PROJ transforms every pixel of a picture, without interpolation between points.

    Raises
    ------
    InvalidInput
        The raster has no georeference, or lies off the map. Names the reason, not the file.
    """

    def __init__(self, facts: Facts) -> None:
        if facts.geotransform is None:
            if facts.by_points:
                raise InvalidInput("only ground control points place it: make a map of it first, with gdalwarp")
            raise InvalidInput("it does not say where its pixels lie: it has no geotransform and no world file")
        if not facts.crs_wkt:
            raise InvalidInput(
                "it states no coordinate reference system: say which, for example with gdal_edit.py -a_srs EPSG:32632"
            )
        x, x_column, x_row, y, y_column, y_row = facts.geotransform
        self._origin = np.array([x, y])
        self._steps = np.array([[x_column, x_row], [y_column, y_row]])
        # Absurd steps overflow; the checks below refuse them.
        with np.errstate(over="ignore", invalid="ignore"):
            is_valid = np.isfinite(facts.geotransform).all() and np.linalg.det(self._steps) != 0.0
            # Refuse steps near the resolution of float64 coordinates, which are lost in rounding.
            finest = 16.0 * np.spacing(np.abs(self._origin).max())
            is_valid = is_valid and bool((np.abs(self._steps).max(axis=0) > finest).all())
        if not is_valid:
            raise InvalidInput("its geotransform {0} places no pixel", facts.geotransform)
        self._width, self._height = facts.sizes[0]
        self._crs = _horizontal(facts.crs_wkt)
        if self._crs.is_geocentric or self._crs.is_engineering:
            raise InvalidInput(
                "its coordinate reference system, {0}, is not one of maps: say which, for example "
                "with gdal_edit.py -a_srs EPSG:32632",
                self._crs.name,
            )
        try:
            self._to_map: Transformer | None = Transformer.from_crs(self._crs, MAP, always_xy=True)
        except ProjError as wrong:
            raise InvalidInput("{0}: {1}", self._crs.name, " ".join(str(wrong).split())) from wrong
        self._period = self._full_turn()
        if self._is_on_the_map_grid():
            self._to_map, self._period = None, 2.0 * HALF_WORLD_M
        self._centre_x = float(self._coordinates(self._width / 2.0, self._height / 2.0)[0])

    @property
    def is_warped(self) -> bool:
        """Whether the raster's CRS differs from the map's."""
        return self._to_map is not None

    def own_plane(self, *, of_degrees: bool = False) -> tuple[ProjectedPlane, int] | None:
        """Plane whose pixels at the returned zoom are the raster's; None if pictures have the pixels of the map.

        The result is None for a rotated raster, a raster in degrees unless ``of_degrees``, and a raster whose pixels
        coincide with the map's.
        """
        across, down = (abs(float(step)) for step in self._steps.diagonal())
        in_degrees = of_degrees and self._crs.is_geographic and self._full_turn() == 360.0
        if not (self._crs.is_projected or in_degrees):
            return None
        if self._steps[0, 1] or self._steps[1, 0] or self._is_on_tiles():
            return None
        zoom = max(math.ceil(math.log2(max(self._width, self._height, TILE_PX) / TILE_PX)), 0)
        size = TILE_PX << zoom
        x, y = self._coordinates(np.array([0.0, self._width]), np.array([0.0, self._height]))
        plane = ProjectedPlane(named_crs(self._crs), float(x.min()), float(y.max()), across * size, down * size)
        middle = x.mean(), y.mean()
        back = plane.to_crs(*plane.from_crs(*middle))
        # A round trip moves the centre only if it lies beyond the domain of the projection.
        if not np.allclose(back, middle, rtol=1e-9, atol=_SAME_PX * min(across, down)):
            raise InvalidInput("its centre lies beyond what {0} reaches", self._crs.name)
        return plane, zoom

    def own_extent(self, zoom: int) -> tuple[tuple[float, float], ...]:
        """Corners of the raster as fractions of its plane."""
        right, bottom = (side / (TILE_PX << zoom) for side in (self._width, self._height))
        return ((0.0, 0.0), (right, 0.0), (right, bottom), (0.0, bottom))

    def _is_on_tiles(self) -> bool:
        """Whether the raster's pixels coincide with the map's at some zoom."""
        if self._to_map is not None or self._steps[0, 1] or self._steps[1, 0]:
            return False
        across, down = (abs(float(step)) for step in self._steps.diagonal())
        zoom = math.log2(2.0 * HALF_WORLD_M / TILE_PX / across)
        first = (self._origin - np.array([-HALF_WORLD_M, HALF_WORLD_M])) / across
        return (
            abs(across - down) * max(self._width, self._height) <= _SAME_PX * across
            and abs(zoom - round(zoom)) * max(self._width, self._height) <= _SAME_PX
            and bool((np.abs(first - np.rint(first)) <= _SAME_PX).all())
        )

    @property
    def is_upright(self) -> bool:
        """Whether the raster's columns and rows are parallel to the map's."""
        return not self.is_warped and not self._steps[0, 1] and not self._steps[1, 0]

    def native_zoom(self) -> int:
        """Highest zoom at which the map's pixels at the raster's centre are no smaller than the raster's, on both axes.

        The next zoom would enlarge the raster along at least one axis.
        """
        column, row = self._width / 2.0, self._height / 2.0
        x, y = self._on_map(np.array([column, column + 1.0, column]), np.array([row, row, row + 1.0]))
        # The position of a centre off the map is not finite.
        with np.errstate(invalid="ignore"):
            steps = np.array([x[1:] - x[0], y[1:] - y[0]])
            steps[0] -= np.rint(steps[0] / (2.0 * HALF_WORLD_M)) * (2.0 * HALF_WORLD_M)
        if not np.isfinite(steps).all() or abs(y[0]) > HALF_WORLD_M:
            raise InvalidInput("its centre does not lie on the Web-Mercator map")
        try:
            inverse = np.linalg.inv(steps)
        except np.linalg.LinAlgError as wrong:
            raise InvalidInput("its pixels are as wide as the whole map, or have no width there") from wrong
        finest = 1.0 / float(np.hypot(*inverse.T).min())
        return fitting_zoom(finest / (2.0 * HALF_WORLD_M), 1.0)

    def extent(self) -> tuple[tuple[float, float], ...] | None:
        """Corners of the raster as world fractions; None if they do not give its outline (`extent_of_outline`)."""
        width, height = float(self._width), float(self._height)
        return extent_of_outline(
            *self._on_map(
                np.array([0.0, width, width, 0.0, width / 2.0, width, width / 2.0, 0.0]),
                np.array([0.0, 0.0, height, height, 0.0, height / 2.0, height, height / 2.0]),
            )
        )

    def positions(self, window: Window, grid: PixelGrid) -> tuple[Floats, Floats]:
        """Columns and rows of the raster at the pixel centres of a window of ``grid``, with a margin of one pixel.

        Returns
        -------
        column_px, row_px : array (height_px + 2, width_px + 2) of float64
            Measured from the outer corner of the raster's first pixel; not finite beyond the domain of the raster's
            CRS. The shapes are (1, width_px + 2) and (height_px + 2, 1) if the raster is upright.
        """
        across, down = grid.pixel_size(window.zoom)
        x = grid.plane.west + (window.left_px + np.arange(-1, window.width_px + 1) + 0.5) * across
        y = grid.plane.north - (window.top_px + np.arange(-1, window.height_px + 1) + 0.5) * down
        to_map, period, upright = self._to_map, self._period, self.is_upright
        if not grid.plane.wraps:
            # The raster's own plane differs from its pixels in steps and origin only.
            to_map, period, upright = None, None, True
        if upright:
            x, y = x[np.newaxis, :], y[:, np.newaxis]
        else:
            x, y = np.meshgrid(x, y)
        if to_map is not None:
            x, y = through_proj(to_map.transform, x, y, direction=TransformDirection.INVERSE)
        if period is not None:
            # A raster that crosses the antimeridian continues at the other edge of the map.
            away = np.abs(x - self._centre_x) > period / 2.0
            if away.any():
                turns = np.rint((x - self._centre_x) / period)
                x = np.where(away & np.isfinite(x), x - turns * period, x)
        if upright:
            return (x - self._origin[0]) / self._steps[0, 0], (y - self._origin[1]) / self._steps[1, 1]
        to_pixels = np.linalg.inv(self._steps)
        right, up = x - self._origin[0], y - self._origin[1]
        with np.errstate(invalid="ignore"):
            return to_pixels[0, 0] * right + to_pixels[0, 1] * up, to_pixels[1, 0] * right + to_pixels[1, 1] * up

    def _coordinates(self, column: Floats | float, row: Floats | float) -> tuple[Floats, Floats]:
        x, y = (origin + steps[0] * column + steps[1] * row for origin, steps in zip(self._origin, self._steps))
        return np.asarray(x, np.float64), np.asarray(y, np.float64)

    def _on_map(self, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        x, y = self._coordinates(column, row)
        if self._to_map is None:
            return x, y
        x, y = through_proj(self._to_map.transform, x, y)
        return x, y

    def _full_turn(self) -> float | None:
        """Full turn of longitude in the unit of a geographic CRS; None for other systems."""
        if not self._crs.is_geographic:
            return None
        return 2.0 * math.pi / float(self._crs.axis_info[0].unit_conversion_factor)

    def _is_on_the_map_grid(self) -> bool:
        # About 1/1000 px at zoom 23, and a thousand times the noise of a transformation to degrees and back.
        tolerance_m = 1e-5
        columns, rows = np.meshgrid(np.linspace(0.0, self._width, 5), np.linspace(0.0, self._height, 5))
        x, y = self._coordinates(columns, rows)
        map_x, map_y = self._on_map(columns, rows)
        with np.errstate(invalid="ignore"):
            difference = map_x - x
            difference = difference - np.rint(difference / (2.0 * HALF_WORLD_M)) * (2.0 * HALF_WORLD_M)
            return bool((np.abs(difference) <= tolerance_m).all() and (np.abs(map_y - y) <= tolerance_m).all())


def named_crs(crs: CRS) -> str:
    """``EPSG:code`` of a CRS if it has one, otherwise its WKT."""
    code = crs.to_epsg()
    return f"EPSG:{code}" if code else str(crs.to_wkt())


def _horizontal(wkt: str) -> CRS:
    crs = read_reference(wkt)
    return crs.sub_crs_list[0] if crs.is_compound else crs
