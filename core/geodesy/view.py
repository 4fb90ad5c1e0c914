"""Camera frames: the source pixels and zooms that each part of a camera's image is made of."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import chain
from typing import NamedTuple, Union

import numpy as np

from ..arrays import Flags, Floats, NDArray, Numbers
from ..errors import InvalidInput
from ..external.compiling import loaded_numba
from ..limits import MAX_IMAGE_TILES
from .accuracy import ImageGeometry, grazing, mesh_noise_px
from .areas import AreaCells, Areas, area_cells, traced_areas
from .camera import Camera
from .ellipsoid import GroundPoints, clearance, trace
from .mercator import MERCATOR, PixelGrid, Plane
from .quadrilaterals import CORNER_X, CORNER_Y, Quadrilaterals

#: Largest size of source pixels in the image, px; the smallest is half of it, as zooms are rounded to the nearest.
NEAREST_PX = 2.0**0.5
#: Binary logarithm of the most samples along an axis that are averaged to a pixel of slanted ground; ground that needs
#: more has a lower zoom.
MOST_POWER = 3
#: Bits of `Detail.kinds` for the samples along each axis.
KIND_BITS = MOST_POWER + 1
#: Pixels that any kernel reaches to either side of a sample (3), and one for the mesh's error.
KERNEL_REACH_PX = 4
#: Rays traced at a time.
_BATCH = 1 << 17
#: Smallest side of a cell, px; in smaller ones every pixel is traced.
_SMALLEST_PX = 8


class Detail(NamedTuple):
    """Detail of parts of an image: zoom, and samples along x and y per pixel; (k,) each."""

    zoom: Numbers
    samples_x: Numbers
    samples_y: Numbers

    @property
    def kinds(self) -> Numbers:
        """One number (k,) for each zoom and numbers of samples."""
        kinds: Numbers = (((self.zoom << KIND_BITS) + self.samples_x) << KIND_BITS) + self.samples_y
        return kinds

    @classmethod
    def of_kinds(cls, kinds: Numbers) -> Detail:
        """Detail that `kinds` stand for."""
        most = (1 << KIND_BITS) - 1
        return cls(kinds >> 2 * KIND_BITS, kinds >> KIND_BITS & most, kinds & most)


class Patches(NamedTuple):
    """Cells of equal detail.

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
    """Pixels sampled one by one: ``row, column`` (m,), and world fractions ``du, v`` (m, samples) of their samples."""

    zoom: int
    row: Numbers
    column: Numbers
    du: Floats
    v: Floats


#: Pixels with samples, or areas from which samples follow.
Sampled = Union[Samples, Areas]


def joined(parts: Sequence[Sampled]) -> list[Sampled]:
    """Samples and areas with one part for each zoom and number of samples a pixel."""
    kinds: dict[tuple[int, ...], list[Sampled]] = {}
    for part in parts:
        kinds.setdefault((part.zoom, *part.du.shape[1:]), []).append(part)
    return [
        same[0] if len(same) == 1 else type(same[0])(zoom, *(np.concatenate(one) for one in list(zip(*same))[1:]))
        for (zoom, *_), same in kinds.items()
    ]


@dataclass(frozen=True, eq=False)
class View:
    """Mapping of a camera's image to a source's pixels, independent of the camera's longitude.

    Attributes
    ----------
    sky : array (height, width) of bool, or None
        Pixels whose rays miss the Earth; None if there are none.
    unmapped : array (height, width) of bool, or None
        Pixels that see ground beyond Web Mercator's latitudes.
    bound_px : float
        Largest bound of a cell.
    rays : ImageRays or None
        Traces the position of every pixel; None to interpolate it between the corners of patches.
    facade_share : float
        Share of the pixels that see steep faces, whose colours no map shows.
    area_cells : tuple of AreaCells
        Cells whose pixels average what they cover.
    """

    width_px: int
    height_px: int
    grid: PixelGrid
    patches: tuple[Patches, ...]
    samples: tuple[Sampled, ...]
    sky: NDArray[np.bool_] | None
    unmapped: NDArray[np.bool_] | None
    bound_px: float
    rays: ImageRays | None = None
    facade_share: float = 0.0
    area_cells: tuple[AreaCells, ...] = ()

    @property
    def sky_share(self) -> float:
        """Share of the pixels that see no ground."""
        return 0.0 if self.sky is None else float(np.mean(self.sky))

    @property
    def size_bytes(self) -> int:
        """Memory of the positions that the view holds."""
        parts = (*self.patches, *self.samples, *self.area_cells)
        return sum(array.nbytes for part in parts for array in part if isinstance(array, np.ndarray))

    @property
    def unmapped_share(self) -> float:
        """Share of the pixels whose ground lies beyond Web-Mercator sources."""
        return 0.0 if self.unmapped is None else float(np.mean(self.unmapped))

    @cached_property
    def hidden(self) -> NDArray[np.bool_] | None:
        """Pixels without a picture, for any reason; None if all have one."""
        if self.sky is None or self.unmapped is None:
            return self.sky if self.unmapped is None else self.unmapped
        return np.asarray(self.sky | self.unmapped)

    def traced(self, patches: Patches) -> Iterator[Samples]:
        """Yield patches as samples with traced positions, a bounded number at a time."""
        if self.rays is None:
            return
        for left, top, right, bottom in patches.box.tolist():
            rows = max(_BATCH // ((right - left) * patches.samples_x * patches.samples_y), 1)
            for start in range(top, bottom, rows):
                row, column = (index.ravel() for index in np.mgrid[start : min(start + rows, bottom), left:right])
                if self.rays.distorts and patches.samples_x * patches.samples_y == 1:
                    du, v = self.rays.map_centres(row[:, np.newaxis], column[:, np.newaxis])
                else:
                    x, y = _sample_points(row, column, patches.samples_x, patches.samples_y)
                    du, v, _ = self.rays.map_points(x, y)
                yield Samples(patches.zoom, row, column, du, v)

    def areas(self, zoom: int) -> Iterator[Areas]:
        """Yield the areas of a zoom, a bounded number of pixels at a time."""
        for cells in self.area_cells:
            if cells.zoom == zoom:
                yield from cells.areas(self.grid, self.rays)

    @property
    def sample_count(self) -> int:
        """Number of samples of the source of which areas are the means."""
        loose = (one for one in self.samples if isinstance(one, Areas))
        return sum(int(one.counts.prod(axis=1).sum()) for one in chain(loose, *map(self.areas, self.zooms)))

    @property
    def zooms(self) -> list[int]:
        """Zooms of the source's pixels that the image is made of."""
        return sorted({part.zoom for part in (*self.patches, *self.samples, *self.area_cells)})

    @property
    def _parts(self) -> list[Patches | Samples]:
        """All parts; of areas, the least and greatest positions."""
        none = np.empty(0, np.int64)
        bounds = (
            *((one.zoom, one.bounds()) for one in self.samples if isinstance(one, Areas)),
            *((one.zoom, one.bounds(self.grid)) for one in self.area_cells),
        )
        return [
            *self.patches,
            *(one for one in self.samples if isinstance(one, Samples)),
            *(Samples(zoom, none, none, *ends) for zoom, ends in bounds),
        ]

    def extents(self) -> Iterator[tuple[int, Floats, Floats, Floats, Floats]]:
        """Yield for each group its zoom, and the least and greatest du and v of each cell or pixel."""
        for part in self._parts:
            yield part.zoom, *_extent(part)

    def tile_keys(self, lon_deg: Floats, moved_u: Floats, moved_v: Floats) -> Numbers:
        """Keys of all tiles that cameras see, each once, with wrapped columns.

        Parameters
        ----------
        lon_deg : array (n,)
            Longitudes of the cameras.
        moved_u, moved_v : array (n,)
            Offsets of the cameras from the view's place, as world fractions eastward and southward. On the map
            ``moved_u`` is 0, as longitudes give the offset.
        """
        found = [np.empty(0, np.int64)]
        u = self.grid.meridian_u(lon_deg) + moved_u
        is_row = bool((moved_v == moved_v[:1]).all())
        for zoom, *cells in self.extents():
            extent = self._merged(zoom, float(moved_v[0]), *cells) if is_row and len(cells[0]) else cells
            # Bounds the extents whose tiles are counted at a time.
            step = max((1 << 19) // len(extent[0]), 1)
            for start in range(0, len(u), step):
                part = slice(start, start + step)
                found.append(self._keys(zoom, u[part, np.newaxis], moved_v[part, np.newaxis], *extent))
        return np.unique(np.concatenate(found))

    def _merged(
        self, zoom: int, moved_v: float, west: Floats, east: Floats, north: Floats, south: Floats
    ) -> list[Floats]:
        """Merge extents that overlap and lie in the same rows of tiles; their tiles stay the same, for any ``u``."""
        *_, first_y, last_y = self._tile_spans(zoom, 0.0, west, east, north + moved_v, south + moved_v)
        order = np.lexsort((west, last_y, first_y))
        west, east, rows = west[order], east[order], np.stack([first_y, last_y])[:, order]
        is_apart = (np.diff(rows) != 0).any(axis=0) | (west[1:] > east[:-1])
        first = np.append(0, np.flatnonzero(is_apart) + 1)
        return [west[first], np.maximum.reduceat(east, first), north[order[first]], south[order[first]]]

    def _keys(
        self, zoom: int, u: Floats, moved_v: Floats, west: Floats, east: Floats, north: Floats, south: Floats
    ) -> Numbers:
        first_x, last_x, first_y, last_y = (
            np.ravel(one)
            for one in np.broadcast_arrays(*self._tile_spans(zoom, u, west, east, north + moved_v, south + moved_v))
        )
        wide, most = last_x - first_x + 1, MAX_IMAGE_TILES * len(u)
        counts = wide * (last_y - first_y + 1)
        if int(counts.max(initial=0)) > most:
            raise self._too_many_tiles()
        # Beyond the plane of a source's CRS tiles have negative indices: the offset allows for 1,700 km at 0.1 m a
        # pixel.
        beyond = 0 if self.grid.plane.wraps else 1 << 26
        ends, keys = np.cumsum(counts), np.empty(0, np.int64)
        start = begun = 0
        while start < len(counts):
            # A million tiles at a time bound memory to about 60 MB.
            stop = max(int(np.searchsorted(ends, begun + (1 << 20), "right")), start + 1)
            some = np.arange(start, stop)
            one = np.repeat(some, counts[some])
            at = np.arange(len(one)) - np.repeat(ends[some] - counts[some] - begun, counts[some])
            x, y = first_x[one] + at % wide[one], first_y[one] + at // wide[one]
            found = (zoom << 56) + ((y + beyond) << 28) + self.grid.wrapped(x, zoom) + beyond
            keys = np.union1d(keys, found)
            if len(keys) > most:
                raise self._too_many_tiles()
            start, begun = stop, int(ends[stop - 1])
        return keys

    def _too_many_tiles(self) -> InvalidInput:
        return InvalidInput(
            "image of {0:,} x {1:,} px: shows more than {2:,} tiles of the source, which are allowed for one",
            self.width_px,
            self.height_px,
            MAX_IMAGE_TILES,
            field="source",
            remedy="fly lower, or choose a source that has lower zooms",
        )

    def _tile_spans(
        self, zoom: int, u: Floats | float, west: Floats, east: Floats, north: Floats, south: Floats
    ) -> tuple[Numbers, Numbers, Numbers, Numbers]:
        """First and last column (not wrapped) and row of the tiles under extents, for cameras at ``u``."""
        size, world = self.grid.tile_px, self.grid.world_px(zoom)
        first_x, last_x = (
            np.floor(((u + du) * world + reach) / size).astype(np.int64)
            for du, reach in ((west, -KERNEL_REACH_PX), (east, KERNEL_REACH_PX))
        )
        first_y, last_y = (
            np.floor((v * world + reach) / size).astype(np.int64)
            for v, reach in ((north, -KERNEL_REACH_PX), (south, KERNEL_REACH_PX))
        )
        first_y, last_y = (self.grid.plane.clipped(row, world // size) for row in (first_y, last_y))
        return first_x, last_x, first_y, last_y

    def tiles(self, lon_deg: float) -> list[tuple[int, int, int]]:
        """Zoom, column (not wrapped) and row of every tile that a camera at this longitude sees."""
        found: set[tuple[int, int, int]] = set()
        u = float(self.grid.meridian_u(np.asarray(lon_deg)))
        for part in self._parts:
            found.update((part.zoom, x, y) for x, y in self._part_tiles(part, u))
        return sorted(found)

    def _part_tiles(self, part: Patches | Samples, u: float) -> Iterator[tuple[int, int]]:
        """Columns and rows of the tiles under cells or pixels, for a camera at ``u``; some more than once."""
        if not len(part.du):
            return
        extent = (np.array([end]) for end in (part.du.min(), part.du.max(), part.v.min(), part.v.max()))
        left, right, top, bottom = (int(end[0]) for end in self._tile_spans(part.zoom, u, *extent))
        # Few pixels may lie far apart.
        if loaded_numba() and (right - left) * (bottom - top) <= 1 << 22:
            from .covered import mark_tiles

            covered = np.zeros((bottom - top + 1, right - left + 1), bool)
            world = float(self.grid.world_px(part.zoom))
            mark_tiles(part.du, part.v, u, world, KERNEL_REACH_PX, self.grid.tile_px, left, top, covered)
            for y, x in np.argwhere(covered).tolist():
                yield left + x, top + y
            return
        # Many pixels have equal spans: number the spans and take each once.
        first_x, last_x, first_y, last_y = self._tile_spans(part.zoom, u, *_extent(part))
        parts = (first_x - left, first_y - top, last_x - first_x, last_y - first_y)
        sizes = [int(one.max()) + 1 for one in parts]
        for x, y, wide, high in np.stack(np.unravel_index(_distinct(parts, sizes), sizes)).T.tolist():
            for column in range(left + x, left + x + wide + 1):
                for row in range(top + y, top + y + high + 1):
                    yield column, row


def _extent(part: Patches | Samples) -> tuple[Floats, Floats, Floats, Floats]:
    """Least and greatest du and v of each cell or pixel."""
    if part.du.shape[1] == 1:
        return part.du[:, 0], part.du[:, 0], part.v[:, 0], part.v[:, 0]
    return part.du.min(axis=1), part.du.max(axis=1), part.v.min(axis=1), part.v.max(axis=1)


def _distinct(parts: tuple[Numbers, ...], sizes: list[int]) -> Numbers:
    """Distinct tuples of whole numbers (n,) below sizes, numbered as by `numpy.ravel_multi_index`."""
    numbers = np.ravel_multi_index(parts, sizes)
    # Counting is faster for small ranges, sorting for large ones.
    if math.prod(sizes) > (1 << 22):
        return np.unique(numbers)
    return np.flatnonzero(np.bincount(numbers))


def view(
    scene: ImageGeometry,
    grid: PixelGrid,
    zooms: tuple[int, int],
    tolerance_px: float,
    *,
    by_rays: bool = False,
    rows: tuple[int, int] | None = None,
    by_area: bool = False,
) -> View:
    """Map the image of a camera to source pixels.

    Parameters
    ----------
    scene : ImageGeometry
        One pose, with a whole image size.
    grid : PixelGrid
        Pixels of the source.
    zooms : tuple of int
        Lowest and highest zoom that may be used.
    tolerance_px : float
        Largest error of the mesh; 0 to trace every pixel.
    by_rays : bool
        Trace every pixel even if the mesh would do, for kernels that need single samples.
    rows : tuple of int, or None
        First row of pixels and the one after the last, for a part of the image; None for all.
    by_area : bool
        Average what each pixel covers: see `areas`.
    """
    rays = ImageRays.from_scene(scene, grid.plane, rows)
    by_rays = by_rays or tolerance_px == 0.0
    # If rays give the positions, the mesh only selects tiles and zooms, for which 0.1 px is enough.
    cells = mesh(rays, 0.1 if by_rays else tolerance_px)
    width, height = rays.size_px
    samples, sky, unmapped = _loose(rays, cells, grid, zooms, traced_areas if by_area else _sampled)
    return View(
        width,
        height,
        grid,
        () if by_area else tuple(_patches(cells, grid, zooms)),
        tuple(samples),
        sky if sky.any() else None,
        unmapped if unmapped.any() else None,
        float(cells.bound_px.max(initial=0.0)),
        rays if by_rays else None,
        area_cells=tuple(area_cells(*cells[:3], grid, zooms)) if by_area else (),
    )


def pixel_detail(per_x: Floats, per_y: Floats, grid: PixelGrid, zooms: tuple[int, int]) -> Detail:
    """Detail for pixels that span ``per_x, per_y`` of the world along the image's axes.

    The zoom suits the axis with the finer detail; along the other axis a pixel is the mean of several samples.
    """
    world = float(grid.world_px(0))
    short, long_ = np.minimum(per_x, per_y), np.maximum(per_x, per_y)
    finest = np.maximum(np.maximum(short, long_ / (1 << MOST_POWER)) * world, np.finfo(float).tiny)
    # `frexp` splits a number into a share in [1/2, 1) and a power of two.
    zoom = np.minimum(np.maximum(np.frexp(NEAREST_PX / finest)[1] - 1, zooms[0]), zooms[1])
    samples = []
    for per in (per_x, per_y):
        share, power = np.frexp(np.ldexp(per * (world / NEAREST_PX), zoom))
        powers = np.clip(power - (share == 0.5), 0, MOST_POWER).astype(np.int64)
        samples.append(np.left_shift(1, powers))
    return Detail(zoom.astype(np.int64), *samples)


def fitting_detail(span: float, grid: PixelGrid, zooms: tuple[int, int]) -> int:
    """Zoom for pixels of this world fraction, between the lowest and the highest allowed."""
    return int(pixel_detail(np.array([span]), np.array([span]), grid, zooms).zoom[0])


def detail_groups(detail: Detail) -> Iterator[tuple[int, int, int, NDArray[np.intp]]]:
    """Yield zoom, samples along x and y, and member indices of each group of equal detail."""
    kinds = detail.kinds
    found = np.flatnonzero(np.bincount(kinds))
    for kind, zoom, samples_x, samples_y in np.stack([found, *Detail.of_kinds(found)], axis=1).tolist():
        yield zoom, samples_x, samples_y, np.flatnonzero(kinds == kind)


def _patches(cells: Cells, grid: PixelGrid, zooms: tuple[int, int]) -> Iterator[Patches]:
    if not len(cells.box):
        return
    size = (cells.box[:, 2:] - cells.box[:, :2]).astype(np.float64)

    def longest(pairs: tuple[tuple[int, int], ...]) -> Floats:
        edges = [np.hypot(cells.du[:, a] - cells.du[:, b], cells.v[:, a] - cells.v[:, b]) for a, b in pairs]
        return np.asarray(np.max(edges, axis=0), np.float64)

    per_x, per_y = longest(((0, 3), (1, 2))) / size[:, 0], longest(((0, 1), (3, 2))) / size[:, 1]
    for zoom, samples_x, samples_y, at in detail_groups(pixel_detail(per_x, per_y, grid, zooms)):
        yield Patches(zoom, samples_x, samples_y, cells.box[at], cells.du[at], cells.v[at])


def _loose(
    rays: ImageRays,
    cells: Cells,
    grid: PixelGrid,
    zooms: tuple[int, int],
    sampled: Callable[[ImageRays, Numbers, Numbers, PixelGrid, tuple[int, int]], Sequence[Sampled]],
) -> tuple[list[Sampled], NDArray[np.bool_], NDArray[np.bool_]]:
    """Samples of the pixels traced one by one, and masks of the sky and of ground beyond the map."""
    width, height = rays.size_px
    sky, unmapped = np.ones((height, width), bool), np.zeros((height, width), bool)
    for left, top, right, bottom in cells.box.tolist():
        sky[top:bottom, left:right] = False
    rows, columns = _box_pixels(cells.loose)
    found: list[Sampled] = []
    for start in range(0, len(rows), _BATCH):
        row, column = rows[start : start + _BATCH], columns[start : start + _BATCH]
        _, v, hit = rays.map_points(column + 0.5, row + 0.5)
        off_map = hit & ~rays.on_map(v)
        sky[row, column] = ~hit
        unmapped[row, column] = off_map
        found += sampled(rays, row[hit & ~off_map], column[hit & ~off_map], grid, zooms)
    return found, sky, unmapped


def _box_pixels(boxes: Numbers) -> tuple[Numbers, Numbers]:
    """Rows and columns of the pixels in boxes (m, 4), row by row, each once."""
    if not len(boxes):
        return np.empty(0, np.int64), np.empty(0, np.int64)
    # Boxes usually cover a small part of a large image, at one edge: search only around them.
    (x0, y0), (x1, y1) = boxes[:, :2].min(axis=0).tolist(), boxes[:, 2:].max(axis=0).tolist()
    inside = np.zeros((y1 - y0, x1 - x0), bool)
    for left, top, right, bottom in boxes.tolist():
        inside[top - y0 : bottom - y0, left - x0 : right - x0] = True
    rows, columns = np.nonzero(inside)
    return rows + y0, columns + x0


def _sampled(rays: ImageRays, row: Numbers, column: Numbers, grid: PixelGrid, zooms: tuple[int, int]) -> list[Samples]:
    if not len(row):
        return []
    x, y = column + 0.5, row + 0.5
    du, v, _ = rays.map_points(x, y)
    per_x, per_y = _spans(rays, x, y, du, v, 1.0, 0.0), _spans(rays, x, y, du, v, 0.0, 1.0)
    found = []
    for zoom, samples_x, samples_y, at in detail_groups(pixel_detail(per_x, per_y, grid, zooms)):
        sub_du, sub_v, hit = rays.map_points(*_sample_points(row[at], column[at], samples_x, samples_y))
        inside = hit & rays.on_map(sub_v)
        # Samples beyond the horizon or the map's edge take the middle of their pixel.
        sub_du = np.where(inside, sub_du, du[at, np.newaxis])
        sub_v = np.where(inside, sub_v, v[at, np.newaxis])
        found.append(Samples(zoom, row[at], column[at], sub_du, sub_v))
    return found


def _sample_points(row: Numbers, column: Numbers, samples_x: int, samples_y: int) -> tuple[Floats, Floats]:
    """Image points (m, samples), evenly spread over pixels."""
    off_x, off_y = sample_offsets(samples_x, samples_y)
    return column[:, np.newaxis] + 0.5 + off_x, row[:, np.newaxis] + 0.5 + off_y


def sample_offsets(samples_x: int, samples_y: int) -> tuple[Floats, Floats]:
    """Offsets (samples,) from the middle of a pixel, evenly spread over it."""
    across = (np.arange(samples_x) + 0.5) / samples_x - 0.5
    down = (np.arange(samples_y) + 0.5) / samples_y - 0.5
    off_x, off_y = (offsets.ravel() for offsets in np.meshgrid(across, down))
    return off_x, off_y


def plane_samples(
    row: Numbers,
    column: Numbers,
    place: tuple[Floats, Floats],
    steps: Sequence[tuple[Floats, Floats]],
    grid: PixelGrid,
    zooms: tuple[int, int],
) -> list[Samples]:
    """Samples of pixels (n,) that see planes.

    Parameters
    ----------
    place : tuple of array (n,)
        World fractions du and v at the pixels' centres.
    steps : sequence of tuple of array (n,)
        By how much these change along columns, and along rows.
    """
    per_x, per_y = (np.sqrt(across * across + down * down) for across, down in steps)
    found = []
    for zoom, samples_x, samples_y, at in detail_groups(pixel_detail(per_x, per_y, grid, zooms)):
        off_x, off_y = sample_offsets(samples_x, samples_y)
        du, v = (
            place[axis][at, np.newaxis]
            + steps[0][axis][at, np.newaxis] * off_x
            + steps[1][axis][at, np.newaxis] * off_y
            for axis in (0, 1)
        )
        found.append(Samples(zoom, row[at], column[at], du, v))
    return found


def _spans(rays: ImageRays, x: Floats, y: Floats, du: Floats, v: Floats, step_x: float, step_y: float) -> Floats:
    """Distances, as world fractions, from image points to the next pixel, or to the one before if that is sky."""
    spans = np.full(len(x), 1.0)
    for sign in (-1.0, 1.0):
        next_du, next_v, hit = rays.map_points(x + sign * step_x, y + sign * step_y)
        with np.errstate(invalid="ignore"):
            way = np.abs(next_du - du)
            # Points across a pole, or across the meridian opposite the camera, are near although their longitudes are
            # not.
            length = np.hypot(rays.plane.shorter(way), next_v - v)
        spans = np.where(hit & np.isfinite(length), length, spans)
    return np.asarray(spans, np.float64)


class Cells(NamedTuple):
    """Cells of an image.

    ``box`` is (k, 4): left, top, right, bottom in px. ``du, v`` are (k, 4): world fractions of the corners upper left,
    lower left, lower right, upper right, from the camera's meridian and from the map's north. ``bound_px`` is (k,).
    ``loose`` is (m, 4): boxes whose pixels are traced one by one. Pixels in neither are sky.
    """

    box: Numbers
    du: Floats
    v: Floats
    bound_px: Floats
    loose: Numbers


class ImageRays(NamedTuple):
    """Rays of one camera's image in pixels: ``origin + x·per_x + y·per_y`` from the upper left corner, y down.

    x and y are pixels of the camera's ideal image, which are its own unless it distorts; see `ideal_px`.

    ``rows`` are the first row and the one after the last of a part of the image, in which y counts from its first row;
    None for the whole image.
    """

    scene: ImageGeometry
    origin: Floats
    per_x: Floats
    per_y: Floats
    plane: Plane = MERCATOR
    rows: tuple[int, int] | None = None

    @classmethod
    def from_scene(
        cls, scene: ImageGeometry, plane: Plane = MERCATOR, rows: tuple[int, int] | None = None
    ) -> ImageRays:
        """Rays of a scene of one pose, over a plane."""
        pose = scene.poses
        corner, right, below = scene.camera.ideal_rays_enu(
            np.array([(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0)]), *(float(angle[0]) for angle in pose.attitude)
        )
        return cls(scene, corner, (right - corner) / scene.width_px, (below - corner) / scene.height_px, plane, rows)

    @property
    def top_px(self) -> int:
        """First row of the image."""
        return 0 if self.rows is None else self.rows[0]

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and number of rows."""
        width, height = self.scene.one_size_px
        return width, height if self.rows is None else self.rows[1] - self.rows[0]

    @property
    def distorts(self) -> bool:
        """Whether pixels of the image differ from those of the ideal image."""
        return self.scene.camera.distorts

    def ideal_px(self, x_px: Floats | Numbers, y_px: Floats | Numbers) -> tuple[Floats, Floats]:
        """Pixels of the ideal image, right and down, that image points show; the same unless the camera distorts."""
        x, y = (np.asarray(values, np.float64) for values in (x_px, y_px))
        if not self.distorts:
            return x, y
        width, height = self.scene.one_size_px
        at = np.broadcast_arrays(2.0 * x / width - 1.0, 1.0 - 2.0 * (y + self.top_px) / height)
        ideal = self.scene.camera.ideal_xy(np.stack(at, axis=-1))
        return (ideal[..., 0] + 1.0) * (width / 2.0), (1.0 - ideal[..., 1]) * (height / 2.0) - self.top_px

    def ideal_steps(self, x_px: Floats | Numbers, y_px: Floats | Numbers) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives of `ideal_px` at image points: of x by x and y, and of y by x and y."""
        x, y = self.ideal_px(x_px, y_px)
        width, height = self.scene.one_size_px
        ideal = np.broadcast_arrays(2.0 * x / width - 1.0, 1.0 - 2.0 * (y + self.top_px) / height)
        slopes = self.scene.camera.seen_slopes(np.stack(ideal, axis=-1))
        xx, yy, ratio = slopes[..., 0, 0], slopes[..., 1, 1], height / width
        # Half images are up, pixels down.
        xy, yx = -slopes[..., 0, 1] / ratio, -slopes[..., 1, 0] * ratio
        area = xx * yy - xy * yx
        return yy / area, -xy / area, -yx / area, xx / area

    def directions(self, x_px: Floats | Numbers, y_px: Floats | Numbers) -> Floats:
        """Rays of image points, (..., 3)."""
        return self.ideal_directions(*self.ideal_px(x_px, y_px)) if self.distorts else self.ideal_directions(x_px, y_px)

    def ideal_directions(self, x_px: Floats | Numbers, y_px: Floats | Numbers) -> Floats:
        """Rays of points of the ideal image, (..., 3)."""
        rays = np.empty((*np.broadcast_shapes(np.shape(x_px), np.shape(y_px)), 3))
        # Component by component: broadcasting a last axis of 3 is several times as slow.
        for axis in range(3):
            rays[..., axis] = self.component(axis, x_px, y_px)
        return rays

    def component(self, axis: int, x_px: Floats | Numbers, y_px: Floats | Numbers) -> Floats:
        """One component of rays of points of the ideal image: 0 east, 1 north, 2 up."""
        x, y = (np.asarray(values, np.float64) for values in (x_px, y_px))
        origin = self.origin[axis] + self.top_px * self.per_y[axis]
        found: Floats = origin + x * self.per_x[axis] + y * self.per_y[axis]
        return found

    def ideal_centres(self, top: int, bottom: int) -> tuple[Floats, Floats]:
        """Points of the ideal image that the centres of some rows of pixels show; they broadcast to (rows, width)."""
        if not self.distorts:
            width, _ = self.size_px
            return np.arange(width) + 0.5, np.arange(top, bottom)[:, np.newaxis] + 0.5
        x, y = _ideal_centres(self.scene.camera, *self.scene.one_size_px)
        some = slice(self.top_px + top, self.top_px + bottom)
        return x[some], y[some] - self.top_px

    def ground(self, x_px: Floats | Numbers, y_px: Floats | Numbers) -> GroundPoints:
        """Ground seen at image points."""
        return self._ground(self.directions(x_px, y_px))

    def ideal_ground(self, x_px: Floats, y_px: Floats) -> GroundPoints:
        """Ground seen at points of the ideal image."""
        return self._ground(self.ideal_directions(x_px, y_px))

    def _ground(self, rays: Floats) -> GroundPoints:
        pose = self.scene.poses
        return trace(pose.lat_deg[0], pose.agl_m[0], rays, self.scene.ground)

    def map_points(self, x_px: Floats | Numbers, y_px: Floats | Numbers) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """World fractions from the camera's meridian (or the plane's west) and from the north, and which rays hit."""
        return self.ideal_map_points(*self.ideal_px(x_px, y_px))

    def ideal_map_points(self, x_px: Floats, y_px: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """`map_points` of points of the ideal image."""
        seen = self.ideal_ground(x_px, y_px)
        return *self.plane.seen(seen.lat_deg, self.scene.poses.lon_deg[0], seen.dlon_deg), seen.hit

    def map_centres(self, row: Numbers, column: Numbers) -> tuple[Floats, Floats]:
        """World fractions, as `map_points` has them, seen by the centres of pixels of a distorted image."""
        x, y = _ideal_centres(self.scene.camera, *self.scene.one_size_px)
        return self.ideal_map_points(x[row + self.top_px, column], y[row + self.top_px, column] - self.top_px)[:2]

    def on_map(self, v: Floats) -> NDArray[np.bool_]:
        """Whether positions lie on the map, or within the plane's projection."""
        return self.plane.shows(v)

    def bends(self, x_px: Floats, y_px: Floats, v: Floats) -> Floats:
        """Bend of the plane at points of the ideal image; see `ProjectedPlane.bend`."""

        def places() -> tuple[Floats, Floats]:
            seen = self.ideal_ground(x_px, y_px)
            return seen.lat_deg, self.scene.poses.lon_deg[0] + seen.dlon_deg

        return self.plane.bends(v, places)

    def clearance(self, x_px: Floats, y_px: Floats) -> tuple[Floats, Floats]:
        """Clearance of rays at points of the ideal image; see `ellipsoid.clearance`."""
        pose = self.scene.poses
        return clearance(pose.lat_deg[0], pose.agl_m[0], self.ideal_directions(x_px, y_px), self.scene.ground)


@lru_cache(maxsize=3)
def _ideal_centres(camera: Camera, width: int, height: int) -> tuple[Floats, Floats]:
    """Points of the ideal image, px, that the pixels of an image show, (height, width) each."""
    x, y = np.meshgrid((np.arange(width) * 2.0 + 1.0) / width - 1.0, 1.0 - (np.arange(height) * 2.0 + 1.0) / height)
    ideal = camera.ideal_xy(np.stack([x, y], axis=-1))
    return (ideal[..., 0] + 1.0) * (width / 2.0), (1.0 - ideal[..., 1]) * (height / 2.0)


def mesh(rays: ImageRays, tolerance_px: float) -> Cells:
    """Divide an image into cells whose map positions are, within a tolerance, a perspective through their corners.

    Corners of cells that a lens bends are moved, so that the error has no mean: see `Quadrilaterals`.

    Parameters
    ----------
    rays : ImageRays
        Rays of one pose.
    tolerance_px : float
        Largest bound of a cell; 0 to trace every pixel that sees the Earth.
    """
    box = _first_boxes(*rays.size_px)
    fitting: list[tuple[Numbers, Floats, Floats, Floats]] = []
    loose = [np.empty((0, 4), np.int64)]
    while len(box):
        ideal = Quadrilaterals.of_boxes(box, rays.ideal_px if rays.distorts else None)
        du, v, spread, hit = _corners(rays, ideal)
        seen = hit.any(axis=1)
        if not seen.all():
            seen |= _holds_earth(rays, ideal.around)
            box, du, v, spread, hit = (values[seen] for values in (box, du, v, spread, hit))
            ideal = Quadrilaterals(*(values[seen] for values in ideal))
        errors, uneven = _errors_px(rays, ideal, v, hit.all(axis=1))
        (along_x, along_y), (uneven_x, uneven_y) = errors, uneven
        size = box[:, 2:] - box[:, :2]
        bound, fits = _fitting(rays, box, (v, spread, hit), (errors, uneven), tolerance_px)
        fitting.append((box[fits], du[fits], v[fits], bound[fits]))
        smallest = (size <= _SMALLEST_PX).all(axis=1) if tolerance_px > 0.0 else np.ones(len(box), bool)
        loose.append(box[~fits & smallest])
        more = ~fits & ~smallest
        across_x = np.where(bound <= tolerance_px, uneven_x >= uneven_y, along_x >= along_y)
        box = _halved(box[more], across_x[more])
    boxes, us, vs, bounds = (np.concatenate(parts) for parts in zip(*fitting))
    return Cells(boxes, us, vs, bounds, np.concatenate(loose))


def _fitting(
    rays: ImageRays,
    box: Numbers,
    seen: tuple[Floats, Floats, Flags],
    errors: tuple[tuple[Floats, Floats], tuple[Floats, Floats]],
    tolerance_px: float,
) -> tuple[Floats, Flags]:
    """Bounds of cells, and whether each is, within a tolerance, the perspective through its corners."""
    (v, spread, hit), ((along_x, along_y), (uneven_x, uneven_y)) = seen, errors
    size = box[:, 2:] - box[:, :2]
    # The perspective of a thin cell enlarges the noise of its short side along the long one.
    thinness = size.max(axis=1) / size.min(axis=1)
    # 30 % more for terms beyond second derivatives, as validated by Monte Carlo.
    bound = 1.3 * (along_x + along_y) + float(mesh_noise_px(rays.scene)[0]) * thinness
    whole = hit.all(axis=1) & rays.on_map(v).all(axis=1)
    whole &= spread <= rays.plane.widest_cell
    # One zoom suits a cell only if its corners are about equally far.
    even = np.maximum(uneven_x, uneven_y) <= 1.5
    return bound, whole & even & (bound <= tolerance_px)


def mesh_serves(rays: ImageRays, tolerance_px: float) -> bool:
    """Whether the mesh of an image would have any cells, judged by cells of the smallest size spread over the image."""
    x, y = (
        np.unique(np.linspace(0, max(side - _SMALLEST_PX, 0), 24).astype(np.int64)) for side in rays.scene.one_size_px
    )
    left, top = (at.ravel() for at in np.meshgrid(x, y))
    right, bottom = (np.minimum(at + _SMALLEST_PX, side) for at, side in zip((left, top), rays.scene.one_size_px))
    box = np.stack([left, top, right, bottom], axis=1)
    ideal = Quadrilaterals.of_boxes(box, rays.ideal_px if rays.distorts else None)
    _, v, spread, hit = _corners(rays, ideal)
    errors = _errors_px(rays, ideal, v, hit.all(axis=1))
    return bool(_fitting(rays, box, (v, spread, hit), errors, tolerance_px)[1].any())


def _first_boxes(width: int, height: int) -> Numbers:
    """Divide an image into boxes of up to 160 px, from which the mesh is refined."""
    x, y = (np.round(np.linspace(0, size, -(-size // 160) + 1)).astype(np.int64) for size in (width, height))
    left, top = np.meshgrid(x[:-1], y[:-1])
    right, bottom = np.meshgrid(x[1:], y[1:])
    return np.stack([left.ravel(), top.ravel(), right.ravel(), bottom.ravel()], axis=1)


def _halved(box: Numbers, across_x: NDArray[np.bool_]) -> Numbers:
    """Halve boxes across the axis that needs it more, or across the other if that is as small as allowed."""
    size = box[:, 2:] - box[:, :2]
    along = np.where(across_x, 0, 1)
    along = np.where(np.take_along_axis(size, along[:, np.newaxis], axis=1)[:, 0] <= _SMALLEST_PX, 1 - along, along)
    row = np.arange(len(box))
    middle = (box[row, along] + box[row, along + 2]) // 2
    first, second = box.copy(), box.copy()
    first[row, along + 2] = middle
    second[row, along] = middle
    return np.concatenate([first, second])


def _corners(rays: ImageRays, ideal: Quadrilaterals) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
    """World fractions of the cells' corners, the spread of u, and whether each corner sees the Earth."""
    du, v, hit = rays.ideal_map_points(ideal.x, ideal.y)
    spread = np.ptp(np.where(hit, du, 0.0), axis=1)
    return du, v, spread, hit


def _errors_px(
    rays: ImageRays, ideal: Quadrilaterals, v: Floats, whole: NDArray[np.bool_]
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Bounds of the error along x and y, and ratios of the distances to the ground along each, (k,) each.

    Infinite near the horizon.

    A perspective is exact for a plane. The error is the offset between the ground of a sphere and that plane: the angle
    β below the horizontal becomes β' = atan(h/S), where S is the arc to the ground point. A smooth function leaves its
    chord by an eighth of the chord's length times the difference of the slopes at its ends. Mercator bends straight
    lines on the ground 2T times as much. Across the direction to the horizon a curve leaves its chord by an eighth of
    its squared length times (1 + 2T)/R of the ground it spans; 2(β' - β) and twice its slope account for the tangent
    between angles and pixels.
    """
    scene = rays.scene
    vectors = rays.ideal_directions(ideal.x, ideal.y)
    length = np.sqrt(np.sum(vectors * vectors, axis=-1))
    share = float(scene.height_share[0])
    lifted, grazed2 = grazing(-vectors[..., 2] / length, np.asarray(share))
    # The bound is validated up to 70° off the axis, where rays are three times as long.
    good = whole & (grazed2 > 0.0).all(axis=1) & (lifted > 0.0).all(axis=1) & (length <= 3.0).all(axis=1)
    lifted, grazed2, v = (np.where(good[:, np.newaxis], a, b) for a, b in ((lifted, 1.0), (grazed2, 1.0), (v, 0.5)))
    bend = (1.0 + 2.0 * rays.bends(ideal.x, ideal.y, v)).max(axis=1)
    receding, steepening = _receding(lifted, np.sqrt(grazed2), share)
    focal = float(np.broadcast_to(scene.focal_px, 1)[0])
    slant = share * (2.0 + share) / (lifted + np.sqrt(grazed2))
    across = (slant * bend[:, np.newaxis] + 2.0 * (np.abs(receding) + np.abs(steepening))).max(axis=1) / focal
    uneven = (length.max(axis=1) / length.min(axis=1)) ** 2
    errors, unevenness = [], []
    for size, off, edges in (
        (ideal.wide, ideal.off_x, ((0, 3), (1, 2))),
        (ideal.high, ideal.off_y, ((0, 1), (3, 2))),
    ):
        slopes = np.max([np.abs(steepening[:, start] - steepening[:, end]) for start, end in edges], axis=0)
        errors.append(
            np.where(good, ideal.scale * (uneven * size / 8.0 * (slopes * bend + size * across) + off), np.inf)
        )
        ratio = np.max([np.maximum(slant[:, a] / slant[:, b], slant[:, b] / slant[:, a]) for a, b in edges], axis=0)
        unevenness.append(np.where(good, ratio, np.inf))
    return (errors[0], errors[1]), (unevenness[0], unevenness[1])


def _receding(lifted: Floats, grazed: Floats, share: float) -> tuple[Floats, Floats]:
    """β' - β, the angle between ground points of the sphere and of the plane, and its slope; see `_errors_px`."""
    squared = share * (2.0 + share) / (lifted + grazed)
    sine = lifted / (1.0 + share)
    cosine = np.sqrt(np.maximum(1.0 - sine**2, 0.0))
    arc = np.arctan2(cosine * squared, 1.0 + share - squared * sine)
    slope = share * squared / (grazed * (share * share + arc * arc)) - 1.0
    return np.arctan2(share, arc) - np.arctan2(sine, cosine), slope


def _holds_earth(rays: ImageRays, box: Floats) -> NDArray[np.bool_]:
    """Whether boxes (k,) of the ideal image show ground although their corners do not; may be True without any.

    The part of the ideal image that shows ground is convex: it enters a box across an edge, along which the
    discriminant is quadratic, or lies inside, with the point below the camera.
    """
    x, y = box[:, CORNER_X], box[:, CORNER_Y]
    next_x, next_y = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    start, towards = rays.clearance(x, y)
    middle, _ = rays.clearance((x + next_x) / 2.0, (y + next_y) / 2.0)
    end, towards_end = rays.clearance(next_x, next_y)
    square, slope = 2.0 * (start - 2.0 * middle + end), 4.0 * middle - 3.0 * start - end
    with np.errstate(divide="ignore", invalid="ignore"):
        at = np.where(square < 0.0, np.clip(-slope / (2.0 * square), 0.0, 1.0), 0.0)
    highest = np.maximum(start + at * (slope + at * square), np.maximum(start, end))
    ahead = towards + at * (towards_end - towards) < 0.0
    across = ((highest >= 0.0) & ahead).any(axis=1)
    nadir = np.linalg.solve(np.stack([rays.per_x, rays.per_y, rays.origin], axis=1), [0.0, 0.0, -1.0])
    if nadir[2] > 0.0:
        at_x, at_y = nadir[0] / nadir[2], nadir[1] / nadir[2] - rays.top_px
        across |= (box[:, 0] <= at_x) & (at_x <= box[:, 2]) & (box[:, 1] <= at_y) & (at_y <= box[:, 3])
    return np.asarray(across)
