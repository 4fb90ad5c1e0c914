"""Pixels of an image that see faces: their ground points, normals and samples of the imagery."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Flags, Floats, NDArray, Numbers
from ..ellipsoid import positions
from ..local import enu_axes, geocentric
from ..mercator import PixelGrid
from ..view import Samples, plane_samples
from .faces import FaceHits
from .surface import PixelRays

#: Most ground that a pixel's sample steps over, in pixels of a face across the ray: as for relief.
_MOST_STEP = 50.0


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
        Unit vectors that face the camera, in east, north and up at the face.
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

    def normals(self, triangle: Numbers, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Unit normals (n, 3) of triangles that face the camera, in east, north and up at positions."""
        one, two, three = np.moveaxis(self.hits.triangles.corners_m[triangle], 1, 0)
        normal = np.cross(two - one, three - one) * self.hits.side[triangle, np.newaxis]
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        found: Floats = np.einsum("nij,nj->ni", enu_axes(lat_deg, lon_deg), normal)
        return found

    def _places(self, points_m: Floats) -> tuple[Floats, Floats]:
        """Latitudes and longitudes, continuous with the camera's, of geocentric points (n, 3)."""
        lat, lon, height = self.place
        offsets = (points_m - geocentric(*self.place)) @ enu_axes(lat, lon).T
        at_lat, dlon, _ = positions(np.array(lat), np.array(height), offsets)
        return at_lat, lon + dlon

    def _distinct(self, triangle: Numbers) -> tuple[Numbers, Numbers]:
        """Indices of triangles, each once, and the place of each pixel's (n,) among them."""
        is_seen = np.zeros(len(self.hits.triangles), bool)
        is_seen[triangle] = True
        return np.flatnonzero(is_seen), (np.cumsum(is_seen) - 1)[triangle]

    def painted(self) -> Painted:
        """Pixels that see faces which the imagery does not show."""
        some = ~self.is_shown
        faces, which = self._distinct(self.triangle[some])
        lat, lon = self._places(self.hits.triangles.corners_m[faces, 0])
        colour = self.hits.triangles.colour[faces]
        return Painted(self.row[some], self.column[some], which, colour, self.normals(faces, lat, lon))

    def samples(self, grid: PixelGrid, zooms: tuple[int, int]) -> list[Samples]:
        """Samples of the pixels whose faces the imagery shows; positions count from the camera's meridian.

        Over a triangle, fractions of the world are linear in space, which leaves out a tenth of a millimetre in 100 m.
        """
        some = self.is_shown
        row, column, triangle = self.row[some], self.column[some], self.triangle[some]
        if not len(row):
            return []
        place, steps = self._on_map(grid, row, column, triangle)
        known = np.isfinite(place).all(axis=0)
        du, v = place[:, known]
        across, down = (step[:, known] for step in steps)
        return plane_samples(row[known], column[known], (du, v), (tuple(across), tuple(down)), grid, zooms)

    def _on_map(self, grid: PixelGrid, row: Numbers, column: Numbers, triangle: Numbers) -> tuple[Floats, list[Floats]]:
        """Fractions (2, n) of the world at pixels, and by how much they change along columns and rows."""
        faces, which = self._distinct(triangle)
        u, v = grid.plane.forward(*self._places(self.hits.triangles.corners_m[faces].reshape(-1, 3)))
        corners = np.stack([u - float(grid.meridian_u(np.asarray(self.place[1]))), v]).reshape(2, -1, 3)
        # Edge functions are for the edges from the first, second and third corner: weights of the one opposite.
        weights = self.hits.forms[faces][:, [1, 2, 0]]
        sums = weights.sum(axis=1)
        forms = np.stack([*np.einsum("afc,fcd->afd", corners, weights), sums])
        x, y = column + 0.5, row + 0.5
        at_u, at_v, whole = (form[which, 0] + x * form[which, 1] + y * form[which, 2] for form in forms)
        place = np.stack([at_u, at_v]) / whole
        steps = []
        most_px = _MOST_STEP / float(
            grid.ground_m_per_px(np.array(self.place[0]), np.array(self.place[1]), grid.native_zoom)
        )
        for term, per in ((1, self.rays.per_x), (2, self.rays.per_y)):
            step = (forms[:2, which, term] - place * forms[2, which, term]) / whole
            most = most_px / grid.world_px(grid.native_zoom) * float(np.linalg.norm(per)) * self.hits.t[row, column]
            steps.append(step * np.minimum(1.0, most / np.maximum(np.hypot(*step), np.finfo(float).tiny)))
        return place, steps
