"""The map frame: the north-up rectangle of source pixels that stands for a nadir camera's picture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from .camera import CORNERS, EDGE_MIDPOINTS, Camera
from .ellipsoid import trace
from .mercator import PixelGrid, lat_to_v, lon_to_u, u_to_lon, v_to_lat, wrap_lon_deg

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]


class FrameEdges(NamedTuple):
    """Edges of map frames as world fractions relative to nothing but the latitude of the camera.

    ``half_u`` is the distance of the west and east edges from the camera's meridian, ``top_v`` and
    ``bottom_v`` are the northern and southern edges; all have the cameras' shape.
    """

    half_u: Floats
    top_v: Floats
    bottom_v: Floats


class Windows(NamedTuple):
    """Rectangles in a source's global pixel grid at one zoom; arrays of one shape (n,).

    Left and top count from 180° W and 85.0511° N; left is continuous (below 0 or beyond the world's
    width across the antimeridian). They are whole numbers (int64), or float64 where the source places
    pictures by their centre.
    """

    left_px: Numbers | Floats
    top_px: Numbers | Floats
    width_px: Numbers
    height_px: Numbers

    @property
    def bounds_px(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Left, top, right and bottom edges as float64, (n,) each."""
        left, top = np.asarray(self.left_px, np.float64), np.asarray(self.top_px, np.float64)
        return left, top, left + self.width_px, top + self.height_px


class Corners(NamedTuple):
    """Ground corners the exact camera sees, in the order of `CORNERS`; arrays (n, 4) in degrees.

    Longitudes are continuous with the camera's.
    """

    lat_deg: Floats
    lon_deg: Floats


def equal_runs(*columns: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Index of the first of each run of equal neighbours, and for every element the run it is in."""
    change = np.zeros(columns[0].shape, bool)
    change[:1] = True
    for column in columns:
        change[1:] |= column[1:] != column[:-1]
    return np.flatnonzero(change), np.cumsum(change) - 1


def frame_edges(camera: Camera, lat_deg: Floats, agl_m: Floats) -> FrameEdges:
    """Map-frame edges of north-up nadir cameras, through the exact midpoints of the image edges.

    Parameters
    ----------
    lat_deg, agl_m : array (n,)
        Degrees, and metres above the ellipsoid.

    Raises
    ------
    InvalidInput
        Where an edge midpoint looks past the Earth: no rectangle of the map holds the picture.
    """
    ground = trace(
        np.asarray(lat_deg, np.float64)[:, np.newaxis],
        np.asarray(agl_m, np.float64)[:, np.newaxis],
        camera.rays_enu(EDGE_MIDPOINTS),
    )
    if not ground.hit.all():
        at = int(np.flatnonzero(~ground.hit.all(axis=1))[0])
        raise InvalidInput(
            f"height {float(agl_m[at]):g} m with a field of view of {camera.fov_deg:g} deg: the picture reaches "
            "past the Earth's horizon; fly lower or narrow the field of view"
        )
    north, east, south = ground.lat_deg[:, 0], ground.dlon_deg[:, 1], ground.lat_deg[:, 2]
    over_pole = (np.abs(ground.dlon_deg[:, 0]) > 90.0) | (np.abs(ground.dlon_deg[:, 2]) > 90.0)
    if over_pole.any():
        at = int(np.flatnonzero(over_pole)[0])
        raise InvalidInput(
            f"picture at latitude {float(lat_deg[at])!r} from {float(agl_m[at]):g} m: it holds a pole, which Web "
            "Mercator does not; fly lower or farther from the pole"
        )
    return FrameEdges(east / 360.0, lat_to_v(north), lat_to_v(south))


def ground_corners(camera: Camera, lat_deg: Floats, lon_deg: Floats, agl_m: Floats) -> Corners:
    """Where the corners of north-up nadir images meet the ground, (n, 4) each.

    Rays are traced once for each run of equal latitude and height, that is once for a row of captures.

    Raises
    ------
    InvalidInput
        Where a corner looks past the Earth.
    """
    first, run = equal_runs(lat_deg, agl_m)
    ground = trace(lat_deg[first, np.newaxis], agl_m[first, np.newaxis], camera.rays_enu(CORNERS))
    if not ground.hit.all():
        at = int(first[np.flatnonzero(~ground.hit.all(axis=1))[0]])
        raise InvalidInput(
            f"height {float(agl_m[at]):g} m with a field of view of {camera.fov_deg:g} deg: a corner of the picture "
            "looks past the Earth's horizon; fly lower or narrow the field of view"
        )
    return Corners(ground.lat_deg[run], lon_deg[:, np.newaxis] + ground.dlon_deg[run])


def map_windows(
    camera: Camera, lat_deg: Floats, lon_deg: Floats, agl_m: Floats, grid: PixelGrid, zoom: int
) -> Windows:
    """Map frames of north-up nadir cameras on a source's pixel grid, each edge rounded on its own.

    Parameters
    ----------
    lat_deg, lon_deg, agl_m : array (n,)
        Poses; the windows' left edges are continuous with the longitudes.
    """
    first, run = equal_runs(lat_deg, agl_m)
    edges = frame_edges(camera, lat_deg[first], agl_m[first])
    world = grid.world_px(zoom)
    u = lon_to_u(lon_deg)
    left = np.floor((u - edges.half_u[run]) * world + 0.5)
    right = np.floor((u + edges.half_u[run]) * world + 0.5)
    top = np.floor(edges.top_v * world + 0.5)[run]
    bottom = np.floor(edges.bottom_v * world + 0.5)[run]
    windows = Windows(*(edge.astype(np.int64) for edge in (left, top, right - left, bottom - top)))
    if grid.centre_decimals is None:
        return windows
    return _centred(windows, grid, zoom, grid.centre_decimals)


def _centred(windows: Windows, grid: PixelGrid, zoom: int, decimals: int) -> Windows:
    """Windows about their centre as the source will round it, grown so that none uncovers what it held."""
    lat_deg, lon_deg = window_centres(windows, grid, zoom)
    world = grid.world_px(zoom)
    shift_px = 0.5 * 10.0**-decimals / 360.0 * world
    lat, lon = np.round(lat_deg, decimals), np.round(lon_deg, decimals)
    width = _whole_units(windows.width_px + 2.0 * shift_px, grid)
    height = _whole_units(windows.height_px + 2.0 * shift_px / np.cos(np.radians(lat_deg)), grid)
    left, _, right, _ = windows.bounds_px
    # The centre of a window may lie beyond the world's edge; the whole turns it is away are exact.
    turns = np.round((left + right) / 2.0 / world - lon_to_u(lon))
    return Windows(
        (lon_to_u(lon) + turns) * world - 0.5 * width, lat_to_v(lat) * world - 0.5 * height, width, height
    )


def _whole_units(size_px: Floats, grid: PixelGrid) -> Numbers:
    """Sizes in px rounded up to whole pixels in 256 px terms, the unit such a source is asked in."""
    whole: Numbers = (np.ceil(size_px / grid.scale) * grid.scale).astype(np.int64)
    return whole


def window_centres(windows: Windows, grid: PixelGrid, zoom: int) -> tuple[Floats, Floats]:
    """Latitude and longitude (wrapped) in degrees of the windows' centres, (n,) each."""
    world = grid.world_px(zoom)
    left, top, right, bottom = windows.bounds_px
    return v_to_lat((top + bottom) / 2.0 / world), wrap_lon_deg(u_to_lon((left + right) / 2.0 / world))
