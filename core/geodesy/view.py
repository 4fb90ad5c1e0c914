"""The camera frame: from which pixels of which zooms each part of a camera's image is made."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .accuracy import Scene
from .mercator import PixelGrid, lon_to_u
from .mesh import Cells, ImageRays, mesh

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]

#: A zoom serves while its pixels, seen in the image, are between this and half of it: rounding to the nearest.
_NEAREST = 2.0**0.5
#: Most samples along one axis whose mean makes a pixel that looks at the ground at a slant. More is left to the zoom.
_MOST_SAMPLES = 8
#: Pixels around a sample that kernels of any kind reach to either side (3), and one for the mesh's error.
KERNEL_REACH_PX = 4
#: Error of the mesh that says which tiles and which zoom serve a part of the image, where rays give the positions.
_EXTENT_TOLERANCE_PX = 0.1
#: Extents that tiles are counted under in one go, for any number of cameras.
_EXTENTS_COUNTED = 1 << 19
#: Rays traced in one go.
_BATCH = 1 << 17


class Detail(NamedTuple):
    """What a part of the image is sampled from: zoom, and samples along x and y for each pixel; (k,) each."""

    zoom: Numbers
    samples_x: Numbers
    samples_y: Numbers


class Patches(NamedTuple):
    """Cells that share their detail.

    ``box`` (k, 4) is left, top, right, bottom in px; ``du, v`` (k, 4) are world fractions of the corners upper left,
    lower left, lower right, upper right.
    """

    zoom: int
    samples_x: int
    samples_y: int
    box: Numbers
    du: Floats
    v: Floats


class Samples(NamedTuple):
    """Pixels made of samples one by one: ``row, column`` (m,), and world fractions ``du, v`` (m, samples) of each's."""

    zoom: int
    row: Numbers
    column: Numbers
    du: Floats
    v: Floats


@dataclass(frozen=True, eq=False)
class View:
    """How a camera's image is made from a source's pixels, but for the longitude of the camera.

    Attributes
    ----------
    width_px, height_px : int
    grid : PixelGrid
    patches : tuple of Patches
    samples : tuple of Samples
    sky : array (height, width) of bool, or None
        Pixels whose rays miss the Earth; None where there are none.
    unmapped : array (height, width) of bool, or None
        Pixels that see ground beyond Web Mercator's latitudes.
    bound_px : float
        Largest bound of a cell.
    rays : ImageRays or None
        Where every pixel's position is to be traced; None where the patches' corners say where they lie.
    """

    width_px: int
    height_px: int
    grid: PixelGrid
    patches: tuple[Patches, ...]
    samples: tuple[Samples, ...]
    sky: NDArray[np.bool_] | None
    unmapped: NDArray[np.bool_] | None
    bound_px: float
    rays: ImageRays | None = None

    @property
    def sky_share(self) -> float:
        """Share of the pixels that see no ground."""
        return 0.0 if self.sky is None else float(np.mean(self.sky))

    @property
    def unmapped_share(self) -> float:
        """Share of the pixels whose ground no Web-Mercator source has."""
        return 0.0 if self.unmapped is None else float(np.mean(self.unmapped))

    @cached_property
    def hidden(self) -> NDArray[np.bool_] | None:
        """Pixels without a picture, for whatever reason; None where there are none."""
        if self.sky is None or self.unmapped is None:
            return self.sky if self.unmapped is None else self.unmapped
        return np.asarray(self.sky | self.unmapped)

    def traced(self, patches: Patches) -> Iterator[Samples]:
        """Patches as samples whose positions are traced, a bounded number at a time."""
        if self.rays is None:
            return
        for left, top, right, bottom in patches.box.tolist():
            rows = max(_BATCH // ((right - left) * patches.samples_x * patches.samples_y), 1)
            for start in range(top, bottom, rows):
                row, column = (
                    index.ravel() for index in np.mgrid[start : min(start + rows, bottom), left:right]
                )
                x, y = _sample_points(row, column, patches.samples_x, patches.samples_y)
                du, v, _ = self.rays.map_points(x, y)
                yield Samples(patches.zoom, row, column, du, v)

    def extents(self) -> Iterator[tuple[int, Floats, Floats, Floats, Floats]]:
        """Zoom, and least and greatest du and v of each cell or pixel, of each group."""
        for part in self.patches:
            yield part.zoom, part.du.min(axis=1), part.du.max(axis=1), part.v.min(axis=1), part.v.max(axis=1)
        for sample in self.samples:
            yield (
                sample.zoom,
                sample.du.min(axis=1),
                sample.du.max(axis=1),
                sample.v.min(axis=1),
                sample.v.max(axis=1),
            )

    def tile_keys(self, lon_deg: Floats, moved_v: Floats) -> Numbers:
        """One number for every tile that cameras see, each once; columns wrapped.

        Parameters
        ----------
        lon_deg, moved_v : array (n,)
            Longitudes of cameras, and how far south of the view's own place they stand, as world fractions.
        """
        found = [np.empty(0, np.int64)]
        u = lon_to_u(lon_deg)
        for zoom, *extent in self.extents():
            step = max(_EXTENTS_COUNTED // len(extent[0]), 1)
            for start in range(0, len(u), step):
                part = slice(start, start + step)
                found.append(self._keys(zoom, u[part, np.newaxis], moved_v[part, np.newaxis], *extent))
        return np.unique(np.concatenate(found))

    def _keys(
        self, zoom: int, u: Floats, moved_v: Floats, west: Floats, east: Floats, north: Floats, south: Floats
    ) -> Numbers:
        first_x, last_x, first_y, last_y = self._tile_spans(
            zoom, u, west, east, north + moved_v, south + moved_v
        )
        columns, rows = (
            int(np.max(last - first)) + 1 for first, last in ((first_x, last_x), (first_y, last_y))
        )
        keys = [
            (zoom << 56)
            + (np.minimum(first_y + down, last_y) << 28)
            + np.minimum(first_x + across, last_x) % (1 << zoom)
            for across in range(columns)
            for down in range(rows)
        ]
        each_once: Numbers = np.unique(np.stack(keys))
        return each_once

    def _tile_spans(
        self, zoom: int, u: Floats | float, west: Floats, east: Floats, north: Floats, south: Floats
    ) -> tuple[Numbers, Numbers, Numbers, Numbers]:
        """First and last column (not wrapped) and row of the tiles under extents, for cameras at ``u``."""
        size, world = self.grid.tile_px, self.grid.world_px(zoom)
        first_x, last_x = (
            np.floor(((u + du) * world + reach) / size).astype(np.int64)
            for du, reach in ((west, -KERNEL_REACH_PX), (east, KERNEL_REACH_PX))
        )
        lowest = world // size - 1
        first_y, last_y = (
            np.clip(np.floor((v * world + reach) / size).astype(np.int64), 0, lowest)
            for v, reach in ((north, -KERNEL_REACH_PX), (south, KERNEL_REACH_PX))
        )
        return first_x, last_x, first_y, last_y

    def tiles(self, lon_deg: float) -> list[tuple[int, int, int]]:
        """Zoom, column and row of every tile that a camera at this longitude sees; columns not wrapped."""
        found: set[tuple[int, int, int]] = set()
        u = float(lon_to_u(np.asarray(lon_deg)))
        for zoom, west, east, north, south in self.extents():
            spans = self._tile_spans(zoom, u, west, east, north, south)
            for x0, x1, y0, y1 in np.unique(np.stack(spans), axis=1).T.tolist():
                found.update((zoom, x, y) for x in range(x0, x1 + 1) for y in range(y0, y1 + 1))
        return sorted(found)


def view(
    scene: Scene, grid: PixelGrid, zooms: tuple[int, int], tolerance_px: float, *, by_rays: bool = False
) -> View:
    """Work out how the image of a camera is made.

    Parameters
    ----------
    scene : Scene
        One pose; its image size is whole.
    grid : PixelGrid
        Of the source.
    zooms : tuple of int
        Lowest and highest zoom that may be used.
    tolerance_px : float
        Largest error of the mesh; 0 for a ray for every pixel.
    by_rays : bool
        Trace every pixel though the mesh would do: for kernels that only single samples can have.
    """
    rays = ImageRays.of(scene)
    by_rays = by_rays or tolerance_px == 0.0
    cells = mesh(rays, _EXTENT_TOLERANCE_PX if by_rays else tolerance_px)
    width, height = scene.one_size_px
    samples, sky, unmapped = _loose(rays, cells, grid, zooms)
    return View(
        width,
        height,
        grid,
        tuple(_patches(cells, grid, zooms)),
        tuple(samples),
        sky if sky.any() else None,
        unmapped if unmapped.any() else None,
        float(cells.bound_px.max(initial=0.0)),
        rays if by_rays else None,
    )


def _detail(per_x: Floats, per_y: Floats, grid: PixelGrid, zooms: tuple[int, int]) -> Detail:
    """Detail for pixels that span ``per_x, per_y`` of the world along the image's axes.

    The zoom suits the axis that is seen less at a slant; along the other one a pixel is the mean of several samples.
    """
    world = float(grid.world_px(0))
    short, long_ = np.minimum(per_x, per_y), np.maximum(per_x, per_y)
    finest = np.maximum(np.maximum(short, long_ / _MOST_SAMPLES) * world, np.finfo(float).tiny)
    zoom = np.clip(np.floor(np.log2(_NEAREST / finest)), *zooms)
    samples = (
        np.clip(
            2.0 ** np.ceil(np.log2(np.maximum(per * world * 2.0**zoom / _NEAREST, 1.0))), 1, _MOST_SAMPLES
        )
        for per in (per_x, per_y)
    )
    return Detail(zoom.astype(np.int64), *(count.astype(np.int64) for count in samples))


def fitting_detail(span: float, grid: PixelGrid, zooms: tuple[int, int]) -> int:
    """Zoom that suits pixels of this world fraction, between the lowest and the highest that may be used."""
    return int(_detail(np.array([span]), np.array([span]), grid, zooms).zoom[0])


def _groups(detail: Detail) -> Iterator[tuple[int, int, int, NDArray[np.intp]]]:
    """Zoom, samples along x and y, and the members, of each group of equal detail."""
    kinds, group = np.unique(np.stack(detail), axis=1, return_inverse=True)
    group = np.ravel(group)
    for index, (zoom, samples_x, samples_y) in enumerate(kinds.T.tolist()):
        yield zoom, samples_x, samples_y, np.flatnonzero(group == index)


def _patches(cells: Cells, grid: PixelGrid, zooms: tuple[int, int]) -> Iterator[Patches]:
    if not len(cells.box):
        return
    size = (cells.box[:, 2:] - cells.box[:, :2]).astype(np.float64)

    def longest(pairs: tuple[tuple[int, int], ...]) -> Floats:
        edges = [np.hypot(cells.du[:, a] - cells.du[:, b], cells.v[:, a] - cells.v[:, b]) for a, b in pairs]
        return np.asarray(np.max(edges, axis=0), np.float64)

    per_x, per_y = longest(((0, 3), (1, 2))) / size[:, 0], longest(((0, 1), (3, 2))) / size[:, 1]
    for zoom, samples_x, samples_y, at in _groups(_detail(per_x, per_y, grid, zooms)):
        yield Patches(zoom, samples_x, samples_y, cells.box[at], cells.du[at], cells.v[at])


def _loose(
    rays: ImageRays, cells: Cells, grid: PixelGrid, zooms: tuple[int, int]
) -> tuple[list[Samples], NDArray[np.bool_], NDArray[np.bool_]]:
    """Samples of the pixels that need rays of their own; the masks of the sky and of ground without a map."""
    width, height = rays.scene.one_size_px
    sky, unmapped = np.ones((height, width), bool), np.zeros((height, width), bool)
    for left, top, right, bottom in cells.box.tolist():
        sky[top:bottom, left:right] = False
    open_ = np.zeros((height, width), bool)
    for left, top, right, bottom in cells.loose.tolist():
        open_[top:bottom, left:right] = True
    rows, columns = np.nonzero(open_)
    found = []
    for start in range(0, len(rows), _BATCH):
        row, column = rows[start : start + _BATCH], columns[start : start + _BATCH]
        _, v, hit = rays.map_points(column + 0.5, row + 0.5)
        off_map = hit & ~((v >= 0.0) & (v <= 1.0))
        sky[row, column] = ~hit
        unmapped[row, column] = off_map
        found += _sampled(rays, row[hit & ~off_map], column[hit & ~off_map], grid, zooms)
    return found, sky, unmapped


def _sampled(
    rays: ImageRays, row: Numbers, column: Numbers, grid: PixelGrid, zooms: tuple[int, int]
) -> list[Samples]:
    if not len(row):
        return []
    x, y = column + 0.5, row + 0.5
    du, v, _ = rays.map_points(x, y)
    per_x, per_y = _spans(rays, x, y, du, v, 1.0, 0.0), _spans(rays, x, y, du, v, 0.0, 1.0)
    found = []
    for zoom, samples_x, samples_y, at in _groups(_detail(per_x, per_y, grid, zooms)):
        sub_du, sub_v, hit = rays.map_points(*_sample_points(row[at], column[at], samples_x, samples_y))
        inside = hit & (sub_v >= 0.0) & (sub_v <= 1.0)
        # Samples of a pixel on the very horizon, or on the map's edge, fall back on its middle.
        sub_du = np.where(inside, sub_du, du[at, np.newaxis])
        sub_v = np.where(inside, sub_v, v[at, np.newaxis])
        found.append(Samples(zoom, row[at], column[at], sub_du, sub_v))
    return found


def _sample_points(row: Numbers, column: Numbers, samples_x: int, samples_y: int) -> tuple[Floats, Floats]:
    """Image points (m, samples) spread evenly over pixels."""
    across = (np.arange(samples_x) + 0.5) / samples_x
    down = (np.arange(samples_y) + 0.5) / samples_y
    off_x, off_y = (offsets.ravel() for offsets in np.meshgrid(across, down))
    return column[:, np.newaxis] + off_x, row[:, np.newaxis] + off_y


def _spans(
    rays: ImageRays, x: Floats, y: Floats, du: Floats, v: Floats, step_x: float, step_y: float
) -> Floats:
    """World fractions from each image point to the next pixel, or from the one before where that is sky."""
    spans = np.full(len(x), 1.0)
    for sign in (-1.0, 1.0):
        next_du, next_v, hit = rays.map_points(x + sign * step_x, y + sign * step_y)
        with np.errstate(invalid="ignore"):
            way = np.abs(next_du - du)
            # Points beyond a pole, or beyond the camera's far meridian, are near though their longitudes are not.
            length = np.hypot(np.minimum(way, 1.0 - way), next_v - v)
        spans = np.where(hit & np.isfinite(length), length, spans)
    return np.asarray(spans, np.float64)
