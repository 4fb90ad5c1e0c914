"""Pictures of one capture by any method: run time, file size, and errors in grey levels."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

from ..arrays import Bytes, Floats
from ..capture.metadata import Description
from ..capture.records import image_job
from ..capture.writers import JPEG_QUALITY, Place, encoded
from ..errors import PartError
from ..external.compiling import without_numba
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.frames import map_windows, plane_runs, quarter_turns
from ..geodesy.view import View, view
from ..imagery.source import Part, Source, Window, tile_parts
from ..mission.layout.frames import sampled_zooms
from ..mission.plan import Plan
from ..picture.camera_frame import camera_parts, render
from ..picture.map_frame import assemble, capture_window, resized, turned
from ..picture.resampling import KERNELS, sample
from ..timing import Effort, Seconds, timed_together
from ..world import WorldSource
from .positions import capture_scene, level_below, spread

#: The most exact kernel. Pillow does not warp by it, so it needs a ray for every pixel.
BY_RAYS = "lanczos"
#: Size at which larger pictures are measured, with times scaled, to bound the time of a report.
_MOST_PX = 2_000_000
#: Side of the patch that kernels are measured on.
_PATCH_PX = 112
#: Edges of the bands of spatial frequency, cycles per pixel; 0.71 is the Nyquist frequency along the diagonal.
BANDS = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.71)


class Rendering(NamedTuple):
    """How to make a camera frame.

    Attributes
    ----------
    tolerance_px : float
        Tolerance of the mesh, 0 for rays; over relief, tolerance of the rays.
    kernel : str
        Empty for the view alone, which kernels without rays share.
    level : bool
        Replace relief by level ground at the height below the camera.
    compiled : bool
        Follow rays over relief by compiled code where it is installed.
    """

    tolerance_px: float
    kernel: str = ""
    level: bool = False
    compiled: bool = True


class FrameCost(NamedTuple):
    """Run time of a picture, and the size of its file."""

    seconds: Seconds
    size_bytes: int


@dataclass(frozen=True)
class Bench:
    """A capture that pictures are measured on.

    Attributes
    ----------
    index : int
        Index of the capture.
    """

    plan: Plan
    tiles: PartCache
    effort: Effort
    index: int = 0

    @classmethod
    def from_plan(cls, plan: Plan, tiles: PartCache, effort: Effort) -> Bench:
        """Choose a capture whose imagery the source has, the middle one if possible.

        Raises
        ------
        PartError, SourceError
            The source has imagery for none of the captures tried.
        """
        # Parts of the source may be missing.
        tries = [len(plan) // 2, *spread(len(plan), 3).tolist()]
        for index in tries[:-1]:
            found = cls(plan, tiles, effort, index)
            try:
                found.own_picture()
            except PartError:
                continue
            return found
        last = cls(plan, tiles, effort, tries[-1])
        last.own_picture()
        return last

    @property
    def planned_px(self) -> tuple[int, int]:
        """Planned width and height of the capture's picture."""
        return int(self.plan.frames.width_px[self.index]), int(self.plan.frames.height_px[self.index])

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the measured pictures: as planned, or reduced to `_MOST_PX`."""
        width, height = self.planned_px
        shrink = math.sqrt(min(_MOST_PX / (width * height), 1.0))
        return max(round(width * shrink), 1), max(round(height * shrink), 1)

    @property
    def enlarged(self) -> float:
        """Pixels of the planned picture per measured pixel."""
        return math.prod(self.planned_px) / math.prod(self.size_px)

    @property
    def lon_deg(self) -> float:
        """Longitude of the camera."""
        return float(self.plan.lon_deg[self.index])

    def _scene(self) -> ImageGeometry:
        width, height = self.size_px
        scene = capture_scene(self.plan, np.array([self.index], np.intp))
        return replace(scene, width_px=float(width), height_px=float(height))

    def camera_frames(self, ways: Sequence[Rendering], *, map_frame: bool) -> tuple[list[FrameCost], FrameCost | None]:
        """Measure camera frames of the capture and, if asked for, its map frame, in the same rounds.

        Captures of a row share their view, whose time counts once a row.
        """
        plan = self.plan
        rows = len(plane_runs(plan.grid, plan.poses)[0]) if plan.relief.is_level else len(plan)
        kinds = [way._replace(kernel=way.kernel if way.kernel == BY_RAYS else "") for way in ways]
        view_makers = {kind: partial(self._view, kind) for kind in kinds}
        views = {kind: make() for kind, make in view_makers.items()}
        renders: list[Callable[[], Bytes]] = []
        for way, kind in zip(ways, kinds):
            parts = camera_parts(views[kind], self.lon_deg)
            renders.append(partial(render, views[kind], self.lon_deg, parts, self.tiles.pixels(parts), way.kernel))
        if map_frame:
            renders.append(self._map_frame())
        works: list[Callable[[], Any]] = [*view_makers.values(), *renders]
        results = timed_together(works, self.effort)
        view_seconds = {kind: seconds for kind, (_, seconds) in zip(view_makers, results)}
        found = []
        for kind, (picture, render_seconds) in zip(kinds, results[len(view_makers) :]):
            seconds = render_seconds + view_seconds[kind] * (rows / len(plan))
            found.append(FrameCost(seconds * self.enlarged, self._file_bytes(picture)))
        if not map_frame:
            return found, None
        picture, seconds = results[-1]
        return found, FrameCost(seconds * self.enlarged, self._file_bytes(picture))

    def _view(self, way: Rendering) -> View:
        plan = self.plan
        zooms = sampled_zooms(plan.mission, plan.grid)
        if not plan.relief.is_level and not way.level:
            tracing = replace(plan.views.tracing(self.index, self.size_px), tolerance_px=way.tolerance_px)
            with nullcontext() if way.compiled else without_numba():
                return tracing.view(plan.grid, zooms)
        scene = self._scene()
        if way.level:
            scene = level_below(plan, self.index, scene)
        return view(scene, plan.grid, zooms, way.tolerance_px, by_rays=way.kernel == BY_RAYS)

    def _map_frame(self) -> Callable[[], Bytes]:
        """Return a function that makes the map frame of the capture."""
        plan = self.plan
        pose = plan.poses.take(np.array([self.index]))
        turns, (width, height) = int(quarter_turns(pose, plan.grid.plane)[0]), self.size_px
        if plan.frames.on_map:
            window = capture_window(plan, self.index)
        else:
            windows = map_windows(plan.mission.camera, pose, plan.grid, plan.zoom, plan.ground)
            window = Window(plan.zoom, *(part[0].item() for part in windows))
        if self.enlarged > 1.0 and plan.grid.centre_decimals is None:
            window = _middle(window, (height, width) if turns % 2 else (width, height))
        parts = self.tiles.source.parts(window)
        pixels = self.tiles.pixels(parts)
        return lambda: turned(assemble(window, parts, pixels), turns)

    def own_picture(self) -> Bytes:
        """Picture of the capture by the plan's methods, at its output size."""
        plan = self.plan
        if plan.frames.on_map:
            return resized(self._map_frame()(), plan.mission.output.img_size)
        kernel = plan.mission.accuracy.resampling
        seen = self._view(Rendering(plan.accuracy.mesh_tolerance_px, kernel))
        parts = camera_parts(seen, self.lon_deg)
        picture = render(seen, self.lon_deg, parts, self.tiles.pixels(parts), kernel)
        return resized(picture, plan.mission.output.img_size)

    def _file_bytes(self, picture: Bytes) -> int:
        """Size of a picture's file in the mission's format and output size."""
        plan, source = self.plan, self.tiles.source
        sized = resized(picture, plan.mission.output.img_size)
        place, description = _metadata(plan, source, self.index, self.tiles.map_type)
        found = len(encoded(plan.mission.output.image_format, sized, place, description))
        return found if plan.mission.output.img_size else round(found * self.enlarged)


def _middle(window: Window, size_px: tuple[int, int]) -> Window:
    """Crop a window to a size about its middle."""
    width, height = (min(side, most) for side, most in zip(window[3:], size_px))
    left = window.left_px + (window.width_px - width) // 2
    top = window.top_px + (window.height_px - height) // 2
    return Window(window.zoom, left, top, width, height)


class PartCache:
    """Cache of pixels of a source's parts."""

    def __init__(self, source: Source, map_type: str) -> None:
        self.source = source
        self.map_type = map_type
        self._pixels: dict[Window, Bytes] = {}

    def __len__(self) -> int:
        return len(self._pixels)

    def pixels(self, parts: Sequence[Part]) -> dict[Window, Bytes]:
        """Pixels of some parts, fetched if necessary.

        Raises
        ------
        PartError, SourceError
            As `Source.fetch` does.
        """
        for part in parts:
            if part.window not in self._pixels:
                self._pixels[part.window] = self.source.fetch(self.map_type, part.window)
        return {part.window: self._pixels[part.window] for part in parts}


@dataclass(frozen=True)
class KernelError:
    """RMS error of a kernel in grey levels, overall and by band of `BANDS`."""

    kernel: str
    rms: float
    by_band: tuple[float, ...]


@dataclass(frozen=True)
class Resampling:
    """Errors of the kernels between the pixels of one zoom of a source.

    Attributes
    ----------
    truth : str
        Reference of the errors.
    signal : tuple of float
        RMS of the picture about its mean, by band.
    """

    zoom: int
    truth: str
    signal: tuple[float, ...]
    kernels: tuple[KernelError, ...]


@dataclass(frozen=True)
class Encoding:
    """A file format: RMS error in grey levels, size and run time of a picture, and whether the mission uses it."""

    name: str
    rms: float
    size_bytes: int
    seconds: Seconds
    chosen: bool


def resampling(plan: Plan, tiles: PartCache, index: int) -> Resampling:
    """Measure the errors of kernels at a capture's zoom, around the middle of its window.

    Raises
    ------
    PartError, SourceError
        As `Source.fetch` does.
    """
    # The patch with a margin for the kernels' radius.
    margin = 8
    side = _PATCH_PX + 2 * margin
    world = plan.grid.world_px(plan.zoom)
    left, top, width, height = (float(values[index]) for values in plan.windows)
    x0 = round(left + (width - side) / 2.0)
    y0 = min(max(round(top + (height - side) / 2.0), 0), world - side)
    window = Window(plan.zoom, x0, y0, side, side)
    parts = tile_parts(window, plan.grid)
    image = assemble(window, parts, tiles.pixels(parts))
    known = tiles.source.world if isinstance(tiles.source, WorldSource) else None
    kernels = [kernel for kernel in KERNELS if known is not None or kernel != BY_RAYS]
    errors: dict[str, list[Floats]] = {kernel: [] for kernel in kernels}
    signals = []
    row, column = np.mgrid[0:_PATCH_PX, 0:_PATCH_PX] + margin
    # Halfway between four pixels is the worst case of every kernel; the other two offsets are typical.
    for across, down in ((0.5, 0.5), (0.25, 0.5), (0.25, 0.75)):
        x, y = column.ravel() + 0.5 + across, row.ravel() + 0.5 + down
        if known is None:
            truth = np.asarray(sample(image, x, y, BY_RAYS), np.float64)
        else:
            u, v = (x0 + x) / world, (y0 + y) / world
            truth = np.asarray(known.colour(tiles.map_type, u, v, plan.zoom), np.float64)
        signals.append(_spectrum(truth - truth.mean(axis=0)))
        for kernel in kernels:
            errors[kernel].append(sample(image, x, y, kernel).astype(np.float64) - truth)
    return Resampling(
        plan.zoom,
        "the embedded world's continuous value"
        if known
        else f"{BY_RAYS} resampling, as the source's truth between its pixels is not known",
        tuple(np.sqrt(np.mean(signals, axis=0)).tolist()),
        tuple(
            KernelError(
                kernel,
                float(np.sqrt(np.mean(np.square(errors[kernel])))),
                tuple(np.sqrt(np.mean([_spectrum(error) for error in errors[kernel]], axis=0)).tolist()),
            )
            for kernel in kernels
        ),
    )


def _spectrum(values: Floats) -> Floats:
    """Mean square of a patch (pixels, channels) by band; bands sum to about the mean square of the patch."""
    patch = values.reshape(_PATCH_PX, _PATCH_PX, -1)
    # The Hann window prevents leakage between bands.
    hann = np.hanning(_PATCH_PX + 2)[1:-1]
    weight = hann[:, np.newaxis] * hann
    power = np.abs(np.fft.fft2(patch * weight[..., np.newaxis], axes=(0, 1))) ** 2
    power = power.mean(axis=-1) / (_PATCH_PX**2 * np.sum(weight**2))
    frequency = np.fft.fftfreq(_PATCH_PX, 1.0)
    radius = np.hypot(frequency[:, np.newaxis], frequency)
    return np.histogram(radius, bins=np.array(BANDS), weights=power)[0]


def encodings(bench: Bench, effort: Effort) -> list[Encoding]:
    """Measure error, size and run time of the picture of a capture in each file format."""
    plan, picture = bench.plan, bench.own_picture()
    # Pictures of an output size are written whole.
    enlarged = 1.0 if plan.mission.output.img_size else bench.enlarged
    place, description = _metadata(plan, bench.tiles.source, bench.index, bench.tiles.map_type)
    used = plan.mission.output.image_format
    formats: list[tuple[str, bool, Callable[[], bytes]]] = [
        (
            f"JPEG, quality {quality}",
            used == "jpg" and quality == JPEG_QUALITY,
            partial(_jpeg, picture, quality),
        )
        for quality in (75, 85, JPEG_QUALITY)
    ]
    for name, ending in (("PNG, lossless", "png"), ("GeoTIFF, deflate, lossless", "tif")):
        formats.append((name, used == ending, partial(encoded, ending, picture, place, description)))
    timed = timed_together([encode for _, _, encode in formats], effort)
    return [
        Encoding(name, _loss(picture, data), round(len(data) * enlarged), seconds * enlarged, chosen)
        for (name, chosen, _), (data, seconds) in zip(formats, timed)
    ]


def _metadata(plan: Plan, source: Source, index: int, map_type: str) -> tuple[Place, Description]:
    job = image_job(plan, index, source, map_type, Path())
    return job.place, job.description


def _jpeg(picture: Bytes, quality: int) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, "JPEG", quality=quality, subsampling=0)
    return buffer.getvalue()


def _loss(picture: Bytes, data: bytes) -> float:
    """RMS difference between a picture and its decoded file."""
    with Image.open(io.BytesIO(data)) as opened:
        read = np.asarray(opened, np.float64)
    return float(np.sqrt(np.mean(np.square(read - picture))))
