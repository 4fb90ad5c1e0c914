"""Sharpness of images from a slanted edge, after ISO 12233:2017 (edge-based spatial frequency response)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..camera.light import LUMINANCE, linear_of_bytes
from ..errors import InvalidInput

#: Bins per pixel across the edge.
_OVERSAMPLING = 4
#: Slants, degrees from a row or column, at which rows meet the edge at all places of a pixel, but few of them.
_LEAST_SLANT_DEG, _MOST_SLANT_DEG = 1.0, 40.0
#: Least sides of the image around an edge, px.
_LEAST_PX = 16
#: Least difference of the two sides, of white.
_LEAST_STEP = 0.02
#: Most by which the contrast is raised to correct for the difference of bins, as in the standard.
_MOST_CORRECTION = 10.0


class EdgeResponse(NamedTuple):
    """Contrast by spatial frequency across an edge.

    Attributes
    ----------
    frequency : array (n,)
        Cycles per px, from 0 to 1.
    contrast : array (n,)
        1 at a frequency of 0.
    slant_deg : float
        Angle between the edge and the image's columns, or its rows if it is nearer to them.
    """

    frequency: Floats
    contrast: Floats
    slant_deg: float

    def frequency_at(self, contrast: float) -> float:
        """Lowest frequency at which the contrast falls to this, cycles per px; NaN if it does not."""
        below = np.flatnonzero(self.contrast < contrast)
        if not len(below):
            return math.nan
        at = int(below[0])
        (before, after), (first, last) = self.contrast[at - 1 : at + 1], self.frequency[at - 1 : at + 1]
        return float(first + (last - first) * (before - contrast) / (before - after))

    def contrast_at(self, frequency: float) -> float:
        """Contrast at a frequency, cycles per px."""
        return float(np.interp(frequency, self.frequency, self.contrast))

    @property
    def mtf50(self) -> float:
        """Cycles per px at which half of the contrast is left."""
        return self.frequency_at(0.5)


def image_light(path: str) -> Floats:
    """Luminance (h, w) of an image file of sRGB values, in linear light.

    Raises
    ------
    InvalidInput
        The file cannot be read as an image.
    """
    from ..dataset.dataset import UNREADABLE, open_undecoded

    try:
        with open_undecoded(Path(path)) as image:
            values = np.asarray(image.convert("RGB"))
    except UNREADABLE as wrong:
        raise InvalidInput("image {0}: cannot be read ({1})", path, wrong) from wrong
    found: Floats = linear_of_bytes(values).astype(np.float64) @ LUMINANCE
    return found


def edge_response(light: Floats) -> EdgeResponse:
    """Contrast by spatial frequency of an image that shows one straight, slanted edge between two even sides.

    The edge is fitted to the centroids of each row's differences; distances from it, in bins of a quarter of a pixel,
    give the edge spread function; its difference in a Hamming window, the line spread function; and the modulus of its
    Fourier transform, the contrast. As in the standard, this is divided by the response of the difference; here also by
    that of the bins, which leaves 1 % less at 0.3 cycles per px.

    Parameters
    ----------
    light : array (h, w)
        Linear light, 1 for white, of one channel.

    Raises
    ------
    InvalidInput
        The image is too small, or shows no such edge.
    """
    light = np.asarray(light, np.float64)
    if light.ndim != 2 or min(light.shape) < _LEAST_PX:
        raise InvalidInput(
            "edge in an image of {0} px: needs one channel of {1} x {1} px or more",
            " x ".join(map(str, reversed(light.shape))),
            _LEAST_PX,
        )
    across = np.abs(light[:, -4:].mean() - light[:, :4].mean())
    if np.abs(light[-4:].mean() - light[:4].mean()) > across:
        light = light.T
    step = abs(float(light[:, -4:].mean() - light[:, :4].mean()))
    if not step >= _LEAST_STEP:
        raise InvalidInput("edge whose sides differ by {0:.2g} of white: must be {1:g} or more", step, _LEAST_STEP)
    start, slope = _fitted_edge(light)
    slant = math.degrees(math.atan(abs(slope)))
    if not _LEAST_SLANT_DEG <= slant <= _MOST_SLANT_DEG:
        raise InvalidInput(
            "edge slanted by {0:.2f} deg: must be {1:g} to {2:g} deg from rows or columns",
            slant,
            _LEAST_SLANT_DEG,
            _MOST_SLANT_DEG,
        )
    spread = _edge_spread(light, start, slope)
    return EdgeResponse(*_contrast(spread), slant)


def _fitted_edge(light: Floats) -> tuple[float, float]:
    """Column of the edge in the first row, from the first pixel's centre, and columns per row."""
    rows, columns = light.shape
    differences = np.diff(light, axis=1)
    x, y = np.arange(columns - 1) + 0.5, np.arange(rows)
    middle: Floats = np.full(rows, (columns - 1) / 2.0)
    slope, start = 0.0, 0.0
    # The window follows the edge; the third fit changes nothing that counts.
    for _ in range(3):
        off = (x - middle[:, np.newaxis]) / (columns - 1)
        window = np.where(np.abs(off) <= 0.5, 0.54 + 0.46 * np.cos(2.0 * np.pi * off), 0.0)
        weights = differences * window
        centroids = (weights * x).sum(axis=1) / weights.sum(axis=1)
        slope, start = (float(one) for one in np.polyfit(y, centroids, 1))
        middle = start + slope * y
    return start, slope


def _edge_spread(light: Floats, start: float, slope: float) -> Floats:
    """Means of pixels by their distance from the edge, in bins of a quarter of a pixel, centred on the edge."""
    rows, columns = light.shape
    # Whole numbers of columns that the edge crosses meet all places of a pixel equally often.
    crossed = math.floor((rows - 1) * abs(slope))
    rows = min(rows, round(crossed / abs(slope))) if crossed else rows
    y = np.arange(rows)[:, np.newaxis]
    distance = (np.arange(columns) - start - slope * y) / math.hypot(1.0, slope)
    ends = min(-float(distance[:, 0].max()), float(distance[:, -1].min()))
    half = math.floor(ends * _OVERSAMPLING)
    if half < 2 * _OVERSAMPLING:
        raise InvalidInput("edge {0:.1f} px from the image's side: must be 2 px or more", max(ends, 0.0))
    at = np.floor(distance * _OVERSAMPLING).astype(np.int64) + half
    inside = (at >= 0) & (at < 2 * half)
    counts = np.bincount(at[inside], minlength=2 * half)
    sums = np.bincount(at[inside], light[:rows][inside], minlength=2 * half)
    known = np.flatnonzero(counts)
    # Where few rows cross a pixel's edge, the distances in a bin lie to one side of its middle.
    places = np.bincount(at[inside], distance[inside] * _OVERSAMPLING, minlength=2 * half)[known] / counts[known]
    found: Floats = np.interp(np.arange(2 * half) - half + 0.5, places, sums[known] / counts[known])
    return found


def _contrast(spread: Floats) -> tuple[Floats, Floats]:
    """Frequencies and contrast from an edge spread function."""
    line = (spread[2:] - spread[:-2]) / 2.0
    count = len(line)
    # The window stands on the centroid of the difference.
    places = np.arange(count)
    centre = float((places * line).sum() / line.sum())
    off = (places - centre) / count
    window = np.where(np.abs(off) <= 0.5, 0.54 + 0.46 * np.cos(2.0 * np.pi * off), 0.0)
    frequency = np.fft.rfftfreq(count, 1.0 / _OVERSAMPLING)
    contrast = np.abs(np.fft.rfft(line * window))
    kept = frequency <= 1.0
    frequency, contrast = frequency[kept], contrast[kept] / contrast[0]
    response = np.sinc(2.0 * frequency / _OVERSAMPLING) * np.sinc(frequency / _OVERSAMPLING)
    return frequency, contrast / np.maximum(response, 1.0 / _MOST_CORRECTION)
