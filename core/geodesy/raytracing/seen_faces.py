"""Pixels of an image that see faces: their ground points, normals and samples of the imagery."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Flags, Floats, NDArray, Numbers
from ...external.compiling import uses_numba
from ..areas import plane_areas
from ..ellipsoid import positions
from ..local import enu_axes, geodetic
from ..mercator import PixelGrid
from ..skins import Skin
from ..view import Sampled, plane_samples
from .faces import FaceHits
from .pixel_rays import PixelRays

#: Most ground that a pixel's sample steps over, in pixels of a face across the ray: as for relief.
_MOST_STEP = 50.0
#: Most where nothing is too much, and no product of it infinite.
_ENDLESS = 1e140
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
    is_lit : array (k,) of bool
        Whether the colour is one in light, of a texture.
    """

    row: Numbers
    column: Numbers
    which: Numbers
    colour: NDArray[np.uint8]
    normals: Floats
    is_lit: Flags


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
        offsets = self.t[:, np.newaxis] * self.rays.through(self.row, self.column)
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
        row, column, triangle = self.row[some], self.column[some], self.triangle[some]
        faces, which = self._distinct(triangle)
        normals = self.normals(faces) @ enu_axes(*self.place[:2]).T
        colour, is_lit = self.hits.triangles.colour[faces], np.zeros(len(faces), np.bool_)
        painted = Painted(row, column, which, colour, normals, is_lit)
        skin = self.hits.triangles.skin
        return painted if skin is None else self._textured(painted, triangle, skin)

    def _textured(self, painted: Painted, triangle: Numbers, skin: Skin) -> Painted:
        """Add a colour of its own for each pixel whose triangle has a texture."""
        some = np.flatnonzero(skin.texture[triangle] >= 0)
        if not len(some):
            return painted
        textured = triangle[some]
        faces, which = self._distinct(textured)
        corners = np.moveaxis(skin.places[faces], 2, 0)
        found = self._interpolated(
            corners, faces, which, (painted.row[some], painted.column[some]), np.full(2, _ENDLESS)
        )
        colours = skin.colours(textured, found, self.hits.triangles.colour[textured])
        places = painted.which.copy()
        places[some] = len(painted.colour) + np.arange(len(some))
        return painted._replace(
            which=places,
            colour=np.concatenate([painted.colour, colours]),
            normals=np.concatenate([painted.normals, painted.normals[painted.which[some]]]),
            is_lit=np.append(painted.is_lit, np.ones(len(some), np.bool_)),
        )

    def samples(self, grid: PixelGrid, zooms: tuple[int, int], *, by_area: bool = False) -> Sequence[Sampled]:
        """Samples or areas of the pixels whose faces the imagery shows; positions count from the camera's meridian.

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
        sampled = plane_areas if by_area else plane_samples
        return sampled(row, column, (du, v), ((across_u, across_v), (down_u, down_v)), grid, zooms)

    def _on_map(self, grid: PixelGrid, row: Numbers, column: Numbers, triangle: Numbers) -> Floats:
        """Fractions of the world at pixels, and by how much they change along columns and rows; (6, n)."""
        faces, which = self._distinct(triangle)
        meridian = self.place[1]
        lat, lon, _ = geodetic(self.hits.triangles.corners_m[faces])
        u, v = grid.plane.forward(lat, meridian + (lon - meridian + 180.0) % 360.0 - 180.0)
        corners = np.stack([u - float(grid.meridian_u(np.asarray(meridian))), v])
        most = _MOST_STEP / float(grid.ground_m_per_px(np.array(self.place[0]), np.array(meridian), grid.native_zoom))
        most /= grid.world_px(grid.native_zoom)
        most_steps = np.array([most * float(np.linalg.norm(per)) for per in self.rays.ways[1:]])
        return self._interpolated(corners, faces, which, (row, column), most_steps)

    def _interpolated(
        self, corners: Floats, faces: Numbers, which: Numbers, pixels: tuple[Numbers, Numbers], most_steps: Floats
    ) -> Floats:
        """Two values linear over triangles at pixels, and by how much they change along columns and rows; (6, n).

        Parameters
        ----------
        corners : array (2, k, 3)
            Values at the corners of triangles.
        faces : array (k,)
            Indices of the triangles.
        which : array (n,)
            Place of each pixel's triangle among them.
        pixels : pair of arrays (n,)
            Rows and columns.
        most_steps : array (2,)
            Greatest changes along columns and rows of the ideal image, for each unit of distance.
        """
        # Edge functions are for the edges from the first, second and third corner: weights of the one opposite.
        weights = self.hits.forms[faces][:, [1, 2, 0]]
        forms = np.stack([*np.einsum("afc,fcd->afd", corners, weights), weights.sum(axis=1)], axis=1)
        row, column = pixels
        found = np.empty((6, len(row)))
        if uses_numba():
            from .face_kernels import interpolate

            interpolate(forms, which, row, column, self.rays.points, self.hits.t, most_steps, found)
        else:
            _interpolate(forms, which, pixels, self.rays, self.hits.t[row, column], most_steps, found)
        return found


def _interpolate(
    forms: Floats,
    which: Numbers,
    pixels: tuple[Numbers, Numbers],
    rays: PixelRays,
    t: Floats,
    most_steps: Floats,
    found: Floats,
) -> None:
    """`face_kernels.interpolate` in numpy."""
    x, y = rays.centres(*pixels)
    lines = [[np.take(forms[:, at, term], which) for term in range(3)] for at in range(3)]
    u, v, whole = (constant + x * per_x + y * per_y for constant, per_x, per_y in lines)
    found[:2] = u / whole, v / whole
    changes = [rays.changes(*pixels, per_x, per_y) for _, per_x, per_y in lines]
    ends = [rays.changes(*pixels, *at) for at in ((most_steps[0], 0.0), (0.0, most_steps[1]))]
    for term in range(2):
        step = [(changes[at][term] - found[at] * changes[2][term]) / whole for at in range(2)]
        length = np.sqrt(step[0] * step[0] + step[1] * step[1])
        most = np.hypot(ends[0][term], ends[1][term])
        share = np.minimum(most * t / np.maximum(length, _TINY), 1.0)
        found[2 * term + 2 : 2 * term + 4] = share * step[0], share * step[1]
