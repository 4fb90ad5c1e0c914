"""Pixels of an image that see faces: their ground points, normals and samples of the imagery."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Flags, Floats, NDArray, Numbers
from ...external.compiling import uses_numba
from ..ellipsoid import positions
from ..local import enu_axes, geodetic
from ..mercator import PixelGrid
from ..view import Samples, plane_samples
from .faces import FaceHits
from .surface import PixelRays

#: Most ground that a pixel's sample steps over, in pixels of a face across the ray: as for relief.
_MOST_STEP = 50.0
_TINY = float(np.finfo(float).tiny)


class Painted(NamedTuple):
    """Pixels that see faces which the imagery does not show.

    Attributes
    ----------
    row, column : array (n,) of int
    which : array (n,) of int
        Index of the face's colour and normal.
    colour : array (k, 3) of uint8
        Without light.
    normals : array (k, 3)
        Unit vectors that face the camera, in its east, north and up.
    """

    row: Numbers
    column: Numbers
    which: Numbers
    colour: NDArray[np.uint8]
    normals: Floats


class SeenFaces(NamedTuple):
    """Pixels (n,) that see faces from a camera at a place: latitude, longitude, and height above the ellipsoid."""

    row: Numbers
    column: Numbers
    hits: FaceHits
    rays: PixelRays
    place: tuple[float, float, float]

    @property
    def t(self) -> Floats:
        """Distances along the rays."""
        return self.hits.t[self.row, self.column]

    @property
    def triangle(self) -> Numbers:
        """Indices of the triangles."""
        return self.hits.triangle[self.row, self.column]

    @property
    def is_shown(self) -> Flags:
        """Whether the imagery shows the face."""
        return self.hits.triangles.shows_imagery[self.triangle]

    def points(self) -> tuple[Floats, Floats, Floats]:
        """Latitudes, longitudes, continuous with the camera's, and heights."""
        lat, lon, height = self.place
        offsets = self.t[:, np.newaxis] * self.rays.directions(self.column + 0.5, self.row + 0.5)
        at_lat, dlon, at_height = positions(np.array(lat), np.array(height), offsets)
        return at_lat, lon + dlon, at_height

    def normals(self, triangle: Numbers) -> Floats:
        """Unit normals (n, 3) of triangles that face the camera, in geocentric axes."""
        one, two, three = np.moveaxis(self.hits.triangles.corners_m[triangle], 1, 0)
        normal: Floats = np.cross(two - one, three - one) * self.hits.side[triangle, np.newaxis]
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return normal

    def _distinct(self, triangle: Numbers) -> tuple[Numbers, Numbers]:
        """Indices of triangles, each once, and the place of each pixel's (n,) among them."""
        is_seen = np.zeros(len(self.hits.triangles), bool)
        is_seen[triangle] = True
        return np.flatnonzero(is_seen), (np.cumsum(is_seen) - 1)[triangle]

    def painted(self) -> Painted:
        """Pixels that see faces which the imagery does not show."""
        some = ~self.is_shown
        faces, which = self._distinct(self.triangle[some])
        normals = self.normals(faces) @ enu_axes(*self.place[:2]).T
        return Painted(self.row[some], self.column[some], which, self.hits.triangles.colour[faces], normals)

    def samples(self, grid: PixelGrid, zooms: tuple[int, int]) -> list[Samples]:
        """Samples of the pixels whose faces the imagery shows; positions count from the camera's meridian.

        Over a triangle, fractions of the world are linear in space, which leaves out a tenth of a millimetre in 100 m.
        """
        some = self.is_shown
        row, column, triangle = self.row[some], self.column[some], self.triangle[some]
        if not len(row):
            return []
        found = self._on_map(grid, row, column, triangle)
        known = np.isfinite(found[:2]).all(axis=0)
        if not known.all():
            row, column, found = row[known], column[known], found[:, known]
        du, v, across_u, across_v, down_u, down_v = found
        return plane_samples(row, column, (du, v), ((across_u, across_v), (down_u, down_v)), grid, zooms)

    def _on_map(self, grid: PixelGrid, row: Numbers, column: Numbers, triangle: Numbers) -> Floats:
        """Fractions of the world at pixels, and by how much they change along columns and rows; (6, n)."""
        faces, which = self._distinct(triangle)
        meridian = self.place[1]
        lat, lon, _ = geodetic(self.hits.triangles.corners_m[faces])
        u, v = grid.plane.forward(lat, meridian + (lon - meridian + 180.0) % 360.0 - 180.0)
        corners = np.stack([u - float(grid.meridian_u(np.asarray(meridian))), v])
        # Edge functions are for the edges from the first, second and third corner: weights of the one opposite.
        weights = self.hits.forms[faces][:, [1, 2, 0]]
        forms = np.stack([*np.einsum("afc,fcd->afd", corners, weights), weights.sum(axis=1)], axis=1)
        most = _MOST_STEP / float(grid.ground_m_per_px(np.array(self.place[0]), np.array(meridian), grid.native_zoom))
        most /= grid.world_px(grid.native_zoom)
        most_steps = np.array([most * float(np.linalg.norm(per)) for per in self.rays[1:3]])
        found = np.empty((6, len(row)))
        if uses_numba():
            from .face_kernels import on_map

            on_map(forms, which, row, column, self.hits.t, most_steps, found)
        else:
            _on_map(forms, which, (row, column), self.hits.t[row, column], most_steps, found)
        return found


def _on_map(
    forms: Floats, which: Numbers, pixels: tuple[Numbers, Numbers], t: Floats, most_steps: Floats, found: Floats
) -> None:
    """`face_kernels.on_map` in numpy."""
    y, x = (at + 0.5 for at in pixels)
    lines = [[np.take(forms[:, at, term], which) for term in range(3)] for at in range(3)]
    u, v, whole = (constant + x * per_x + y * per_y for constant, per_x, per_y in lines)
    found[:2] = u / whole, v / whole
    for term, most in enumerate(most_steps.tolist(), 1):
        step = [(lines[at][term] - found[at] * lines[2][term]) / whole for at in range(2)]
        length = np.sqrt(step[0] * step[0] + step[1] * step[1])
        share = np.minimum(most * t / np.maximum(length, _TINY), 1.0)
        found[2 * term : 2 * term + 2] = share * step[0], share * step[1]
