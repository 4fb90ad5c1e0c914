"""The plan: a mission worked out on a source's pixel grid, as arrays. No I/O."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pyproj import Geod

from ..errors import InvalidInput
from ..geodesy.camera import Camera
from ..geodesy.ellipsoid import WGS84
from ..geodesy.frames import (
    Corners,
    Windows,
    equal_runs,
    frame_edges,
    ground_corners,
    map_windows,
    window_centres,
)
from ..geodesy.mercator import MAX_LAT_DEG, PixelGrid, fitting_zoom, wrap_lon_deg
from .area import Points
from .coverage import Coverage, Overlap, coverage, overlap, unique_tiles
from .layout import Layout, lay_out
from .mission import Mission

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Plan:
    """A mission worked out: n captures in flight order, as arrays.

    Attributes
    ----------
    mission : Mission
    grid : PixelGrid
        Pixel grid of the source the plan is for.
    zoom : int
        The one zoom of all pictures.
    column, row : array (n,) of int64
        Grid indices; each pair once.
    lat_deg, lon_deg, agl_m : array (n,)
        Poses of the nadir camera; longitudes are continuous across the antimeridian.
    windows : Windows
        What each picture shows, in the global pixel grid at ``zoom``.
    corners : Corners
        Ground corners that the exact camera sees, (n, 4).

    Everything else is worked out when first asked for, and kept.
    """

    mission: Mission
    grid: PixelGrid
    zoom: int
    column: Numbers
    row: Numbers
    lat_deg: Floats
    lon_deg: Floats
    agl_m: Floats
    windows: Windows
    corners: Corners

    def __len__(self) -> int:
        return len(self.column)

    @cached_property
    def frame_centres(self) -> tuple[Floats, Floats]:
        """Latitude and longitude (wrapped) of the pictures' own centres, degrees, (n,) each."""
        return window_centres(self.windows, self.grid, self.zoom)

    @cached_property
    def names(self) -> list[str]:
        """Name of each picture without its ending, as the published dataset has them."""
        lat, lon = self.frame_centres
        return [
            f"{column}_{row}_{lat_deg:.8f}_{lon_deg:.8f}_{self.zoom}"
            for column, row, lat_deg, lon_deg in zip(
                self.column.tolist(), self.row.tolist(), lat.tolist(), lon.tolist()
            )
        ]

    @cached_property
    def edges_m(self) -> tuple[Floats, Floats, Floats, Floats]:
        """West, south, east, north of the pictures in metres of EPSG:3857, (n,) each."""
        left, top, width, height = (np.asarray(part, np.float64) for part in self.windows)
        return self.grid.edges_m(left, top, width, height, self.zoom)

    @cached_property
    def coverage(self) -> Coverage | None:
        """What the pictures show of the area; None for points."""
        if isinstance(self.mission.area, Points):
            return None
        return coverage(self.mission.area, self.windows, self.grid, self.zoom)

    @cached_property
    def overlap(self) -> Overlap:
        """What neighbouring pictures really share; all None for points."""
        if isinstance(self.mission.area, Points):
            return Overlap(None, None, None, None)
        return overlap(self.column, self.row, self.windows, rows_are_level=self.mission.layout == "cover")

    @cached_property
    def requests(self) -> int:
        """Parts to fetch for one map type, each once: tiles, or whole pictures by their centre."""
        if self.grid.centre_decimals is not None:
            return len(np.unique(np.stack([np.asarray(part, np.float64) for part in self.windows]), axis=1).T)
        return unique_tiles(self.windows, self.grid, self.zoom)

    @cached_property
    def flight_distance_m(self) -> float:
        """Geodesic length of the way from the first capture to the last, without climbs."""
        lon, lat = wrap_lon_deg(self.lon_deg), self.lat_deg
        legs = Geod(a=WGS84.a_m, b=WGS84.b_m).inv(lon[:-1], lat[:-1], lon[1:], lat[1:])[2]
        return float(np.sum(legs))

    @property
    def rows(self) -> int:
        """Rows of captures."""
        return int(self.row.max()) + 1

    @property
    def columns(self) -> int:
        """Captures of the longest row."""
        return int(self.column.max()) + 1

    @cached_property
    def source_gsd_m_per_px(self) -> float:
        """Ground sample distance of the source's pixels, median over the pictures."""
        return float(np.median(self.grid.ground_m_per_px(self.lat_deg, self.zoom)))

    @cached_property
    def camera_gsd_m_per_px(self) -> float:
        """Ground sample distance of the exact camera with as many pixels as its picture, median."""
        width_m, _ = self.mission.camera.ground_size_m(1.0)
        return float(np.median(width_m * self.agl_m / self.windows.width_px))


def plan(mission: Mission, grid: PixelGrid) -> Plan:
    """Work out a mission on a source's pixel grid.

    Raises
    ------
    InvalidInput
        Where the mission cannot be flown: too many captures, an area or pictures beyond Web Mercator, a
        camera that sees past the horizon, a zoom the source does not have, pictures under one pixel.
    """
    layout = lay_out(mission, 0.0)
    zoom = _zoom(mission, grid, layout)
    if not isinstance(mission.area, Points):
        # Outer frames need room for their rounding, a share of a pixel; that may, at the border of two zooms,
        # take the lower one, whose pixels are larger.
        layout = lay_out(mission, 1.0 / grid.world_px(zoom))
        lower = _zoom(mission, grid, layout)
        if lower != zoom:
            zoom = min(zoom, lower)
            layout = lay_out(mission, 1.0 / grid.world_px(zoom))
    windows = map_windows(mission.camera, layout.lat_deg, layout.lon_deg, layout.agl_m, grid, zoom)
    _check_windows(windows, layout, grid, zoom)
    corners = ground_corners(mission.camera, layout.lat_deg, layout.lon_deg, layout.agl_m)
    return Plan(mission, grid, zoom, *layout, windows=windows, corners=corners)


def _zoom(mission: Mission, grid: PixelGrid, layout: Layout) -> int:
    """Return the zoom asked for, or the highest one at which every picture fits its longest side."""
    highest = grid.max_zoom if mission.upsample else grid.native_zoom
    if mission.zoom is not None:
        if not grid.min_zoom <= mission.zoom <= grid.max_zoom:
            raise InvalidInput(f"zoom {mission.zoom}: the source has {grid.min_zoom} to {grid.max_zoom}")
        return mission.zoom
    if mission.gsd_m_per_px is not None:
        return _zoom_for_gsd(mission.gsd_m_per_px, grid, layout.lat_deg, highest)
    limit = mission.max_px if grid.max_size_px is None else min(mission.max_px, grid.max_size_px)
    zoom = min(_highest_guess(mission.camera, layout, limit) + 1, highest)
    while zoom > grid.min_zoom and _longest_px(mission, grid, layout, zoom) > limit * grid.scale:
        zoom -= 1
    if _longest_px(mission, grid, layout, zoom) > limit * grid.scale:
        raise InvalidInput(
            f"pictures from {mission.agl_m:g} m are larger than {limit} px at zoom {zoom}, the source's lowest; fly "
            "lower or allow larger pictures (--max-px)"
        )
    return zoom


def _highest_guess(camera: Camera, layout: Layout, limit_px: int) -> int:
    first, _ = equal_runs(layout.lat_deg, layout.agl_m)
    edges = frame_edges(camera, layout.lat_deg[first], layout.agl_m[first])
    span = max(float((2.0 * edges.half_u).max()), float((edges.bottom_v - edges.top_v).max()))
    return fitting_zoom(span, limit_px)


def _longest_px(mission: Mission, grid: PixelGrid, layout: Layout, zoom: int) -> int:
    windows = map_windows(mission.camera, layout.lat_deg, layout.lon_deg, layout.agl_m, grid, zoom)
    return int(max(windows.width_px.max(), windows.height_px.max()))


def _zoom_for_gsd(gsd_m_per_px: float, grid: PixelGrid, lat_deg: Floats, highest: int) -> int:
    """Return the lowest zoom whose pixels are nowhere larger than asked for."""
    for zoom in range(grid.min_zoom, highest + 1):
        if float(grid.ground_m_per_px(lat_deg, zoom).max()) <= gsd_m_per_px:
            return zoom
    finest = float(grid.ground_m_per_px(lat_deg, highest).max())
    raise InvalidInput(
        f"ground sample distance {gsd_m_per_px} m: the source's own pixels are {finest:.3g} m here; ask for that or "
        "more, or allow enlarged pixels (--upsample)"
    )


def _check_windows(windows: Windows, layout: Layout, grid: PixelGrid, zoom: int) -> None:
    """Refuse pictures that reach beyond the map or are under one pixel, or larger than the source serves."""
    world = grid.world_px(zoom)
    _, top, _, bottom = windows.bounds_px
    outside = (top < 0) | (bottom > world) | (windows.width_px > world)
    if outside.any():
        at = int(np.flatnonzero(outside)[0])
        raise InvalidInput(
            f"picture at latitude {float(layout.lat_deg[at])!r} from {float(layout.agl_m[at]):g} m: reaches beyond the "
            f"map, which ends at ±{MAX_LAT_DEG:.4f}; fly lower or nearer to the equator"
        )
    small = np.minimum(windows.width_px, windows.height_px) < 1
    if small.any():
        at = int(np.flatnonzero(small)[0])
        raise InvalidInput(
            f"picture from {float(layout.agl_m[at]):g} m at zoom {zoom}: under one pixel; fly higher or "
            "choose a higher zoom"
        )
    if grid.max_size_px is not None and max(windows.width_px.max(), windows.height_px.max()) > (
        grid.max_size_px * grid.scale
    ):
        raise InvalidInput(
            f"pictures at zoom {zoom}: larger than the {grid.max_size_px} px the source serves; choose a lower zoom"
        )
