"""Camera frames: pictures of a camera in any attitude above a curved Earth, resampled from tiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import chain
from typing import Any

import numpy as np

from ..arrays import Floats, NDArray, Numbers, PixelValues
from ..bands import RGB, Bands, fitted
from ..camera.light import linear, linear_of_bytes
from ..errors import PartError
from ..external.compiling import loaded_numba, uses_numba
from ..geodesy.areas import Areas, perspectives
from ..geodesy.mercator import PixelGrid
from ..geodesy.view import Patches, Samples, View
from ..imagery.source import Part, Window
from ..mission.plan import Plan
from .map_frame import checked
from .resampling import PackedImage, blank_image

#: Channels of an RGB image.
_COLOURS = 3
#: Samples taken at a time, to bound memory.
_MOST_SAMPLES = 1 << 16
#: Steps of light in which the nearest value is looked up.
_LIGHT_STEPS = 1 << 12
#: Images of level ground for which loading compiled code pays: that takes half a second, and saves 4 to 15 ms of each,
#: or most of a second where pixels average what they cover.
_WORTH_LOADING, _WORTH_LOADING_BY_AREA = 100, 1


@cache
def _light_tables() -> tuple[Floats, Numbers, Floats]:
    """Linear light of each 8-bit value, the value at each of so many steps of light, and the borders between values."""
    levels = linear_of_bytes(np.arange(256, dtype=np.uint8)).astype(np.float64)
    borders = linear((np.arange(255) + 0.5) / 255.0)
    return levels, np.searchsorted(borders, np.linspace(0.0, 1.0, _LIGHT_STEPS + 1), side="right"), borders


def load_code(plan: Plan) -> None:
    """Load the compiled code for the camera frames of a plan, if it pays, and compile it if that has not been done.

    Over relief it always pays. Level ground has the same pixels with and without.
    """
    is_level = plan.relief.is_level
    least = _WORTH_LOADING_BY_AREA if plan.mission.optics.by_area else _WORTH_LOADING
    if plan.frames.on_map or (is_level and len(plan) < least) or not uses_numba():
        return
    if not is_level:
        from ..geodesy.raytracing.tracing import compile_code

        compile_code()
        return
    view, lon_deg = plan.views.view(0), float(plan.lon_deg[0])
    parts = camera_parts(view, lon_deg)
    blank = np.zeros((plan.grid.tile_px, plan.grid.tile_px, len(RGB)), RGB.dtype)
    render(view, lon_deg, parts, {part.window: blank for part in parts}, plan.mission.accuracy.resampling)


def camera_parts(view: View, lon_deg: float) -> list[Part]:
    """Tiles of a camera frame, each once.

    Offsets of parts are positions in the world at their zoom, with ``dx_px`` not wrapped.
    """
    return parts_of_tiles(view.grid, view.tiles(lon_deg))


def parts_of_tiles(grid: PixelGrid, tiles: Sequence[Sequence[int]]) -> list[Part]:
    """Parts of tiles, given by zoom, column (not wrapped) and row, as in `camera_parts`."""
    size = grid.tile_px
    return [
        Part(
            Window(zoom, grid.wrapped(column, zoom) * size, row * size, size, size),
            column * size,
            row * size,
        )
        for zoom, column, row in tiles
    ]


@dataclass(frozen=True, eq=False)
class _Ground:
    """Pixels of one zoom that a picture needs, and the position of their upper left corner in the world."""

    pixels: PixelValues
    missing: NDArray[np.bool_] | None
    left_px: int
    top_px: int

    @cached_property
    def _packed(self) -> PackedImage:
        return PackedImage(self.pixels, is_compiled=False)

    @cached_property
    def _packed_light(self) -> PackedImage:
        return PackedImage(_light_tables()[0][self.pixels], is_compiled=False)

    def draw(
        self,
        picture: PixelValues,
        row: Numbers,
        column: Numbers,
        x: Floats,
        y: Floats,
        kernel: str,
        *,
        in_light: bool = False,
    ) -> None:
        """Fill pixels (n,) of a picture, each with the mean of its samples (n, k), in linear light or as they are."""
        x_px, y_px = x.ravel(), y.ravel()
        if self.missing is not None:
            height, width = self.missing.shape
            near = np.clip(y_px.astype(np.intp), 0, height - 1), np.clip(x_px.astype(np.intp), 0, width - 1)
            _refuse_missing(int(np.count_nonzero(self.missing[near])))
        packed = self._packed_light if in_light else self._packed
        values = packed.sample(x_px, y_px, kernel).reshape(*x.shape, picture.shape[2])
        # Summed one after the other, as compiled code does: numpy would add samples of a single band in pairs.
        sums = values[:, 0]
        for sample in range(1, x.shape[1]):
            sums = sums + values[:, sample]
        mean = sums / values.dtype.type(x.shape[1])
        if in_light:
            mean = np.searchsorted(_light_tables()[2], mean.ravel(), side="right").reshape(mean.shape)
        picture[row, column] = fitted(mean, picture.dtype)

    def average(self, picture: PixelValues, areas: Areas, u: float, world_px: int, *, in_light: bool) -> None:
        """Fill pixels of a picture, each with the mean of its area, in linear light or as values are."""
        for row, column, x, y in areas.in_pixels(u, world_px, self.left_px, self.top_px).samples(_MOST_SAMPLES):
            self.draw(picture, row, column, x, y, "bilinear", in_light=in_light)


@dataclass(frozen=True, eq=False)
class _Tiles:
    """Tiles of one zoom that a picture needs, sampled by compiled code where they are: joining takes longer.

    Attributes
    ----------
    tiles : list of array
        Pixels, kept in memory.
    addresses, depths : array (rows, columns) of int64
        Where the pixels of each tile begin in memory, and their channels. Black where there is none.
    """

    tiles: list[PixelValues]
    addresses: Numbers
    depths: Numbers
    size_px: int
    left_px: int
    top_px: int

    @classmethod
    def found(
        cls, zoom: int, parts: Sequence[Part], pixels: Mapping[Window, PixelValues], bands: Bands, size_px: int
    ) -> _Tiles:
        """Find the tiles in memory."""
        of_zoom = [part for part in parts if part.window.zoom == zoom]
        offsets = np.array([(part.dy_px, part.dx_px) for part in of_zoom])
        top, left = offsets.min(axis=0).tolist()
        place = tuple(((offsets - (top, left)) // size_px).T)
        blank = np.zeros((size_px, size_px, len(bands)), bands.dtype)
        # Compiled code reads memory by address, where all tiles must be of one size.
        windows = ((part.window, part.window._replace(width_px=size_px, height_px=size_px)) for part in of_zoom)
        tiles = [np.ascontiguousarray(checked(whole, pixels[window], bands)) for window, whole in windows]
        addresses, depths = (
            np.full([int(index.max()) + 1 for index in place], value, np.int64)
            for value in (blank.ctypes.data, len(bands))
        )
        addresses[place], depths[place] = [tile.ctypes.data for tile in tiles], [tile.shape[2] for tile in tiles]
        return cls([blank, *tiles], addresses, depths, size_px, left, top)

    def draw(self, picture: PixelValues, row: Numbers, column: Numbers, x: Floats, y: Floats, _: str) -> None:
        """Fill pixels (n,) of a picture, each with the mean of its samples (n, k)."""
        from .taps import gather

        kind = np.float32 if picture.dtype == np.uint8 else np.float64
        missing = gather(*self._memory, x, y, row, column, *self._values(picture, kind), picture)
        _refuse_missing(missing)

    def average(self, picture: PixelValues, areas: Areas, u: float, world_px: int, *, in_light: bool) -> None:
        """Fill pixels of a picture, each with the mean of its area, in linear light or as values are."""
        from .taps import average

        kind = np.float32 if picture.dtype == np.uint8 and not in_light else np.float64
        _, row, column, x, y, steps, counts = areas.in_pixels(u, world_px, self.left_px, self.top_px)
        tables = _light_tables() if in_light else (None, None, None)
        values = self._values(picture, kind)
        missing = average(*self._memory, row, column, x, y, steps, counts, *values, picture, *tables)
        _refuse_missing(missing)

    @property
    def _memory(self) -> tuple[Numbers, Numbers, int]:
        return self.addresses, self.depths, self.size_px

    def _values(self, picture: PixelValues, kind: Any) -> tuple[bool, tuple[float, float], Floats]:
        """Whether any tile has a mask, the limits of values, and room for sums."""
        channels, limits = picture.shape[2], (-np.inf, np.inf)
        if picture.dtype.kind != "f":
            limits = float(np.iinfo(picture.dtype).min), float(np.iinfo(picture.dtype).max)
        return bool((self.depths > channels).any()), limits, np.empty(channels, kind)


def render(
    view: View,
    lon_deg: float,
    parts: Sequence[Part],
    pixels: Mapping[Window, PixelValues],
    kernel: str,
    bands: Bands = RGB,
) -> PixelValues:
    """Draw a camera frame.

    Parameters
    ----------
    lon_deg : float
        Longitude of the camera.
    parts : sequence of Part
        From `camera_parts`.
    pixels : mapping of Window to array (tile_px, tile_px, bands or one more)
    kernel : str
        nearest, bilinear, bicubic or lanczos, which needs a view by rays.
    bands : Bands
        Bands of the source.

    Returns
    -------
    array (height_px, width_px, bands) of the bands' type
        0 where ``view.hidden``.

    Raises
    ------
    PartError
        A part has a wrong size, or lacks imagery that the picture shows.
    """
    u = float(view.grid.meridian_u(np.asarray(lon_deg)))
    picture = np.zeros((view.height_px, view.width_px, len(bands)), bands.dtype)
    is_compiled, is_warped = loaded_numba(), view.rays is None
    warp = _warp_compiled if is_compiled and kernel != "bicubic" else _warp
    # One zoom after the other, as its joined tiles may take a hundred megabytes.
    for zoom in view.zooms:
        patches = [some for some in view.patches if some.zoom == zoom]
        samples = [some for some in view.samples if some.zoom == zoom and isinstance(some, Samples)]
        areas = [some for some in view.samples if some.zoom == zoom and isinstance(some, Areas)]
        ground: _Ground | _Tiles | None = None
        if is_warped and patches:
            ground = _ground(zoom, parts, pixels, bands, is_warped=True)
            for some in patches:
                warp(picture, some, ground, view.grid, u, kernel)
        if is_warped and not (samples or areas or view.area_cells):
            continue
        if is_compiled and kernel == "bilinear":
            ground = _Tiles.found(zoom, parts, pixels, bands, view.grid.tile_px)
        ground = ground or _ground(zoom, parts, pixels, bands, is_warped=False)
        for one in chain(*map(view.traced, patches), samples):
            _gather(picture, one, ground, view.grid, u, kernel)
        for area in chain(areas, view.areas(zoom)):
            # Colours are averaged as a sensor collects light.
            ground.average(picture, area, u, view.grid.world_px(zoom), in_light=bands.are_colours)
    return picture


def _ground(
    zoom: int,
    parts: Sequence[Part],
    pixels: Mapping[Window, PixelValues],
    bands: Bands,
    *,
    is_warped: bool,
) -> _Ground:
    """Join the tiles of one zoom, without padding if they are warped, else for sampling."""
    of_zoom = [part for part in parts if part.window.zoom == zoom]
    left, top = min(part.dx_px for part in of_zoom), min(part.dy_px for part in of_zoom)
    right = max(part.dx_px + part.window.width_px for part in of_zoom)
    bottom = max(part.dy_px + part.window.height_px for part in of_zoom)
    count = len(bands)
    size = bottom - top, right - left, count
    ground = np.zeros(size, bands.dtype) if is_warped else blank_image(*size, bands.dtype)
    missing: NDArray[np.bool_] | None = None
    for part in of_zoom:
        tile = checked(part.window, pixels[part.window], bands)
        rows = slice(part.dy_px - top, part.dy_px - top + part.window.height_px)
        columns = slice(part.dx_px - left, part.dx_px - left + part.window.width_px)
        ground[rows, columns] = tile[..., :count]
        if tile.shape[2] > count and not tile[..., count].all():
            missing = np.zeros(ground.shape[:2], bool) if missing is None else missing
            missing[rows, columns] = tile[..., count] == 0
    return _Ground(ground, missing, left, top)


def _refuse_missing(count: int) -> None:
    if count:
        raise PartError("no imagery at {0} of the samples that the image is made of", count)


def _transforms(patches: Patches, ground: _Ground, grid: PixelGrid, u: float) -> tuple[Numbers, Floats]:
    """Sizes (k, 2) in samples, and coefficients (k, 8), of the perspective transforms through patches' corners."""
    world = grid.world_px(patches.zoom)
    x, y = (u + patches.du) * world - ground.left_px, patches.v * world - ground.top_px
    sizes = (patches.box[:, 2:] - patches.box[:, :2]) * (patches.samples_x, patches.samples_y)
    return sizes, perspectives(x, y, *sizes.T)


def _warp_compiled(
    picture: PixelValues, patches: Patches, ground: _Ground, grid: PixelGrid, u: float, kernel: str
) -> None:
    """Fill patches as `_warp` does, to the last bit."""
    from .perspective import warp

    sizes, coefficients = _transforms(patches, ground, grid, u)
    if ground.missing is not None:
        _refuse_holes(sizes, coefficients, ground.missing)
    height, width, channels = ground.pixels.shape
    longest, is_whole = int(sizes[:, 0].max()) * channels, picture.dtype == np.uint8
    drawn = picture if is_whole else np.empty(picture.shape, np.float32)
    warp(
        ground.pixels.reshape(-1),
        (height, width),
        coefficients,
        patches.box,
        (patches.samples_x, patches.samples_y),
        kernel == "nearest",
        np.empty((3, longest)),
        np.empty((2, longest), np.int32 if is_whole else np.float32),
        drawn,
    )
    for left, top, right, bottom in () if is_whole else patches.box.tolist():
        picture[top:bottom, left:right] = fitted(drawn[top:bottom, left:right], picture.dtype)


def _warp(picture: PixelValues, patches: Patches, ground: _Ground, grid: PixelGrid, u: float, kernel: str) -> None:
    """Fill patches by the perspective transform through their corners."""
    from PIL import Image

    resampling: Any = {"nearest": Image.NEAREST, "bilinear": Image.BILINEAR, "bicubic": Image.BICUBIC}[kernel]
    images = _images(ground.pixels)
    wide, high = patches.samples_x, patches.samples_y
    sizes, coefficients = _transforms(patches, ground, grid, u)
    if ground.missing is not None:
        _refuse_holes(sizes, coefficients, ground.missing)
    for (left, top, right, bottom), size, perspective in zip(
        patches.box.tolist(), sizes.tolist(), coefficients.tolist()
    ):
        for channels, image in images:
            seen = image.transform(tuple(size), Image.PERSPECTIVE, perspective, resampling)
            if wide > 1 or high > 1:
                seen = seen.reduce((wide, high))
            values = np.asarray(seen)
            picture[top:bottom, left:right, channels] = values if image.mode != "F" else fitted(values, picture.dtype)


def _refuse_holes(sizes: Numbers, coefficients: Floats, missing: NDArray[np.bool_]) -> None:
    """Raise PartError if patches show ground without imagery."""
    from PIL import Image

    absent = Image.fromarray(missing.astype(np.uint8) * 255)
    for size, perspective in zip(sizes.tolist(), coefficients.tolist()):
        hole = absent.transform(tuple(size), Image.PERSPECTIVE, perspective, Image.BILINEAR)
        _refuse_missing(int(np.count_nonzero(np.asarray(hole))))


def _images(pixels: PixelValues) -> list[tuple[Any, Any]]:
    """Channels and images that Pillow can transform: RGB and single channels of 8 bits, else single floats."""
    from PIL import Image

    count = pixels.shape[2]
    if pixels.dtype != np.uint8:
        floats = (np.ascontiguousarray(pixels[..., channel], np.float32) for channel in range(count))
        return [(channel, Image.fromarray(one)) for channel, one in enumerate(floats)]
    if count == _COLOURS:
        return [(slice(None), Image.fromarray(pixels))]
    whole = count - count % _COLOURS
    found: list[tuple[Any, Any]] = [
        (
            slice(first, first + _COLOURS),
            Image.fromarray(np.ascontiguousarray(pixels[..., first : first + _COLOURS])),
        )
        for first in range(0, whole, _COLOURS)
    ]
    return [
        *found,
        *((channel, Image.fromarray(np.ascontiguousarray(pixels[..., channel]))) for channel in range(whole, count)),
    ]


def _gather(
    picture: PixelValues, samples: Samples, ground: _Ground | _Tiles, grid: PixelGrid, u: float, kernel: str
) -> None:
    """Fill single pixels, each with the mean of its samples."""
    world = grid.world_px(samples.zoom)
    count = samples.du.shape[1]
    batch = max(_MOST_SAMPLES // count, 1)
    for start in range(0, len(samples.row), batch):
        part = slice(start, start + batch)
        x = (u + samples.du[part]) * world - ground.left_px
        y = samples.v[part] * world - ground.top_px
        ground.draw(picture, samples.row[part], samples.column[part], x, y, kernel)
