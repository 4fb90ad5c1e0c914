"""Errors in grey levels: of the kernels that resample, by spatial frequency, and of what JPEG leaves out."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..capture.description import Description
from ..capture.jpeg import JPEG_QUALITY, jpeg
from ..capture.picture import assemble
from ..capture.records import job_of
from ..capture.resample import KERNELS, sample
from ..capture.writers import Place, geotiff, png
from ..imagery.source import Source, Window, tile_parts
from ..mission.plan import Plan
from ..world import World, WorldSource
from .tiles import Tiles
from .timing import Effort, Seconds, timed_together

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]

#: Side of the patch that kernels are measured on, px, and what it is taken with around it for their reach.
_PATCH_PX, _MARGIN_PX = 112, 8
#: Where between four pixels the samples lie: halfway is worst for every kernel, the others are what pictures hold, too.
_OFFSETS = ((0.5, 0.5), (0.25, 0.5), (0.25, 0.75))
#: Edges of the bands of spatial frequency, cycles a px; the last is that of the finest pattern that pixels hold.
BANDS = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.71)
#: JPEG qualities that are compared; that of the project's own files is among them.
_QUALITIES = (75, 85, JPEG_QUALITY)
#: Kernel that stands for the truth where nothing better is known.
_FINEST = "lanczos"


@dataclass(frozen=True)
class KernelError:
    """Error of one kernel in grey levels: RMS of all, and by `BANDS`."""

    kernel: str
    rms: float
    by_band: tuple[float, ...]


@dataclass(frozen=True)
class Resampling:
    """Errors of the kernels between the pixels of one zoom of a source.

    Attributes
    ----------
    zoom : int
    truth : str
        What the errors are against.
    signal : tuple of float
        RMS of the picture itself about its mean, by band.
    kernels : tuple of KernelError
    """

    zoom: int
    truth: str
    signal: tuple[float, ...]
    kernels: tuple[KernelError, ...]


@dataclass(frozen=True)
class Encoding:
    """A way to store a picture: its error in grey levels, bytes, and seconds; whether the mission has it."""

    name: str
    rms: float
    size_bytes: int
    seconds: Seconds
    chosen: bool


def resampling(plan: Plan, tiles: Tiles, index: int) -> Resampling:
    """Errors of the kernels at the zoom, and around the middle, of a capture's window.

    Raises
    ------
    PartError, SourceError
        As `Source.fetch` does.
    """
    side = _PATCH_PX + 2 * _MARGIN_PX
    world = plan.grid.world_px(plan.zoom)
    left, top, width, height = (float(values[index]) for values in plan.windows)
    x0 = round(left + (width - side) / 2.0)
    y0 = min(max(round(top + (height - side) / 2.0), 0), world - side)
    window = Window(plan.zoom, x0, y0, side, side)
    parts = tile_parts(window, plan.grid)
    image = assemble(window, parts, tiles.of(parts))
    known = _world_of(tiles.source)
    kernels = [kernel for kernel in KERNELS if known is not None or kernel != _FINEST]
    errors: dict[str, list[Floats]] = {kernel: [] for kernel in kernels}
    signals = []
    row, column = np.mgrid[0:_PATCH_PX, 0:_PATCH_PX] + _MARGIN_PX
    for across, down in _OFFSETS:
        x, y = column.ravel() + 0.5 + across, row.ravel() + 0.5 + down
        if known is None:
            truth = np.asarray(sample(image, x, y, _FINEST), np.float64)
        else:
            u, v = (x0 + x) / world, (y0 + y) / world
            truth = np.asarray(known.colour(tiles.map_type, u, v, plan.zoom), np.float64)
        signals.append(_spectrum(truth - truth.mean(axis=0)))
        for kernel in kernels:
            errors[kernel].append(sample(image, x, y, kernel).astype(np.float64) - truth)
    return Resampling(
        plan.zoom,
        "the embedded world's own continuous value"
        if known
        else f"{_FINEST} resampling, as the source's truth between its pixels is not known",
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


def _world_of(source: Source) -> World | None:
    return source.world if isinstance(source, WorldSource) else None


def _spectrum(values: Floats) -> Floats:
    """Mean square of a patch (pixels, channels) in each band; the bands sum to about that of the whole patch."""
    patch = values.reshape(_PATCH_PX, _PATCH_PX, -1)
    # Hann's window keeps the patch's edges from spilling into all bands.
    hann = np.hanning(_PATCH_PX + 2)[1:-1]
    weight = hann[:, np.newaxis] * hann
    power = np.abs(np.fft.fft2(patch * weight[..., np.newaxis], axes=(0, 1))) ** 2
    power = power.mean(axis=-1) / (_PATCH_PX**2 * np.sum(weight**2))
    frequency = np.fft.fftfreq(_PATCH_PX, 1.0)
    radius = np.hypot(frequency[:, np.newaxis], frequency)
    return np.histogram(radius, bins=np.array(BANDS), weights=power)[0]


def encodings(
    plan: Plan, source: Source, index: int, map_type: str, picture: Pixels, effort: Effort
) -> list[Encoding]:
    """What a picture loses and takes as each kind of file.

    Parameters
    ----------
    picture : array (h, w), (h, w, 3) of uint8
        Of capture ``index``, as it would be written.
    """
    place, about = _about(plan, source, index, map_type)
    own = plan.mission.image_format
    ways: list[tuple[str, bool, Callable[[], bytes]]] = [
        (
            f"JPEG, quality {quality}",
            own == "jpg" and quality == JPEG_QUALITY,
            partial(_jpeg, picture, quality),
        )
        for quality in _QUALITIES
    ]
    for name, ending in (("PNG, lossless", "png"), ("GeoTIFF, deflate, lossless", "tif")):
        ways.append((name, own == ending, partial(encoded, ending, picture, place, about)))
    timed = timed_together([way for _, _, way in ways], effort)
    return [
        Encoding(name, _loss(picture, data), len(data), seconds, chosen)
        for (name, chosen, _), (data, seconds) in zip(ways, timed)
    ]


def encoded(ending: str, picture: Pixels, place: Place, about: Description) -> bytes:
    """Return the bytes of a picture's own file."""
    if ending == "tif":
        return geotiff(picture, place, about)
    return jpeg(picture, about) if ending == "jpg" else png(picture, about)


def file_bytes(plan: Plan, source: Source, index: int, map_type: str, picture: Pixels) -> int:
    """Size of a picture in the mission's format."""
    place, about = _about(plan, source, index, map_type)
    return len(encoded(plan.mission.image_format, picture, place, about))


def _about(plan: Plan, source: Source, index: int, map_type: str) -> tuple[Place, Description]:
    job = job_of(plan, index, source, map_type, Path())
    return job.place, job.description


def _jpeg(picture: Pixels, quality: int) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, "JPEG", quality=quality, subsampling=0)
    return buffer.getvalue()


def _loss(picture: Pixels, data: bytes) -> float:
    """RMS difference of a picture and what is read back."""
    with Image.open(io.BytesIO(data)) as opened:
        read = np.asarray(opened, np.float64)
    return float(np.sqrt(np.mean(np.square(read - picture))))
