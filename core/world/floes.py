"""Pack ice: floes of several sizes, and the leads between them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .lattice import WORLD_M, Array, Window, bits, cell_hash, mix, salt, unit
from .paint import clip01, ramp
from .parcels import bent_plane
from .region import smoothstep
from .samples import Samples
from .scene import Scene


class _Size(NamedTuple):
    """Floes of one size, the cells of a level.

    Attributes
    ----------
    level : int
    bend : float
        How far their edges are bent on their own, in cells, beside the bend of the plane.
    narrowest_m, widest_m : float
        Half widths of the leads along them; none where that is below 0.
    leads : float
        Share of the sea that these cover.
    lightness : float
        By how much floes differ.
    missing : bool
        Whether each is there or not.
    refrozen : bool
        Whether the leads are.
    """

    level: int
    bend: float
    narrowest_m: float
    widest_m: float
    leads: float
    lightness: float
    missing: bool = False
    refrozen: bool = False


_SIZES = (
    _Size(12, 0.05, 20.0, 260.0, 0.04, 0.04),
    _Size(14, 0.15, -25.0, 90.0, 0.03, 0.06, missing=True),
    _Size(17, 0.45, -1.5, 4.0, 0.01, 0.03, refrozen=True),
)
_INSIDE = 0.2
"""How far inside its cell a point lies: so far that the nearest one is in the cell of a sample or in one around it."""

_FEW_POINTS = 64
"""Up to so many floes are looked at one by one."""


def floes(scene: Scene, speckle: Array, whole: Array) -> tuple[Array, Array, Array]:
    """Coverage of the sea by floes, by ice that has grown between them, and lightness of the floes, about 1.

    Parameters
    ----------
    scene : Scene
    speckle : array
        Texture of all scales.
    whole : array
        Share of the sea that floes cover as seen from afar.
    """
    one = np.float32(1)
    cover, tone = whole, np.ones_like(whole)
    between = np.minimum(whole * np.float32(3), one) * np.float32(0.4)
    young = between
    samples, pixel_m = scene.samples, scene.pixel_m
    plane = bent_plane(scene.region, samples)
    bent = (scene.region.value("wood", samples), scene.region.value("brook", samples))
    for size in _SIZES:
        cell_m = WORLD_M / (1 << size.level)
        shown = np.float32(smoothstep(0.5, 0.2, np.array(pixel_m / cell_m)))
        lead: Array | np.float32 = np.float32(size.leads)
        if shown > 0:
            edge, own = _nearest(scene, size, plane, bent)
            edge *= np.float32(cell_m)
            edge += speckle * np.float32(min(1.2, 0.25 * size.widest_m))
            narrowest, widest = np.float32(size.narrowest_m), np.float32(size.widest_m)
            drawn = _narrow(edge, narrowest + (widest - narrowest) * bits(own, 0, 8) ** 3, pixel_m)
            lead = lead + (drawn - lead) * shown
            tone = tone + (bits(own, 16, 8) - np.float32(0.5)) * (np.float32(size.lightness) * shown)
            if size.missing:
                # A floe is there or not; what is missing has frozen over, or is open water.
                there = ramp(whole - unit(mix(own)) * np.float32(0.97), 0.01)
                cover = cover * (one + (there / np.maximum(whole, np.float32(1e-3)) - one) * shown)
                frozen = (bits(own, 8, 8) < between) * (one - there)
                young = between + (frozen - between) * shown
        if size.refrozen:
            young = np.maximum(young, lead * np.float32(0.55))
            cover = cover * (one - lead * np.float32(0.55))
        else:
            cover = cover * (one - lead)
    return cover, young, tone


def _nearest(
    scene: Scene, size: _Size, plane: tuple[Array, Array], bent: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Distance to the edge of the floe that each sample is in, in cells, and the floe's hash.

    A floe is what is nearer to its lattice cell's point than to any other's.
    """
    samples, level = scene.samples, size.level
    (i0, fx), (j0, fy) = (
        _in_cells(samples, level, tile, local) for tile, local in zip((samples.x, samples.y), plane)
    )
    fx, fy = (f.ravel() + np.float32(size.bend) * b.ravel() for f, b in zip((fx, fy), bent))
    left, top = int(np.floor(fx.min())) - 1, int(np.floor(fy.min())) - 1
    columns, rows = int(np.floor(fx.max())) + 2 - left, int(np.floor(fy.max())) + 2 - top
    window = Window(level, i0 + left, j0 + top, columns, rows)
    i, j = window.indices()
    own = cell_hash(salt(scene.seed, 21), level, i, j)
    h = cell_hash(salt(scene.seed, 22), level, i, j)
    x = (np.arange(columns)[None, :] + left + _INSIDE + (1 - 2 * _INSIDE) * bits(h, 0, 12)).astype(np.float32)
    y = (np.arange(rows)[:, None] + top + _INSIDE + (1 - 2 * _INSIDE) * bits(h, 12, 12)).astype(np.float32)
    if x.size > _FEW_POINTS:
        near, far, at = _among_neighbours(fx, fy, left, top, x, y)
    else:
        near, far, at = _among_all(fx, fy, x.ravel(), y.ravel())
    edge = (np.sqrt(far) - np.sqrt(near)) * np.float32(0.5)
    return edge.reshape(samples.shape), own.ravel()[at].reshape(samples.shape)


def _in_cells(samples: Samples, level: int, tile: int, local_m: Array) -> tuple[int, Array]:
    """Where samples lie along one axis of a lattice: the cell of their tile's edge, and float32 cells from that."""
    shift = level - samples.zoom
    base = tile << shift if shift >= 0 else tile >> -shift
    start = 0.0 if shift >= 0 else (tile - (base << -shift)) / (1 << -shift)
    return base, local_m * np.float32((1 << level) / WORLD_M) + np.float32(start)


def _among_all(fx: Array, fy: Array, x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Squares of the distances to the nearest and the next of a few points, and the nearest one's number."""
    box = (fx.min(), fx.max(), fy.min(), fy.max())
    # Points that are farther from all samples than two others are from each are neither.
    least = [np.maximum(np.maximum(low - c, c - high), 0) for c, (low, high) in ((x, box[:2]), (y, box[2:]))]
    most = [np.maximum(np.abs(c - low), np.abs(c - high)) for c, (low, high) in ((x, box[:2]), (y, box[2:]))]
    farthest = np.partition(np.hypot(*most), 1)[1]
    near, far = np.full(fx.shape, np.inf, np.float32), np.full(fx.shape, np.inf, np.float32)
    at = np.zeros(fx.shape, dtype=np.intp)
    for n in np.flatnonzero(np.hypot(*least) <= farthest * 1.001 + 1e-3):
        _take_in(near, far, at, _square(fx - x[n], fy - y[n]), n)
    return near, far, at


def _among_neighbours(
    fx: Array, fy: Array, left: int, top: int, x: Array, y: Array
) -> tuple[Array, Array, Array]:
    """As `_among_all`, of the points in the nine cells around each sample's."""
    columns = x.shape[1]
    cell = (np.floor(fy).astype(np.intp) - top) * columns + np.floor(fx).astype(np.intp) - left
    near, far = np.full(fx.shape, np.inf, np.float32), np.full(fx.shape, np.inf, np.float32)
    at = np.zeros(fx.shape, dtype=np.intp)
    flat_x, flat_y = x.ravel(), y.ravel()
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            n = cell + (down * columns + right)
            _take_in(near, far, at, _square(fx - flat_x[n], fy - flat_y[n]), n)
    return near, far, at


def _narrow(distance_m: Array, half_width_m: Array, pixel_m: float) -> Array:
    """Coverage by a line whose half width differs from place to place, by the distance to its middle."""
    d, w = distance_m * np.float32(1.0 / pixel_m), half_width_m * np.float32(1.0 / pixel_m)
    cover = clip01(np.float32(0.5) + w - d)
    cover -= clip01(np.float32(0.5) - w - d)
    return np.asarray(np.maximum(cover, np.float32(0), out=cover))


def _square(dx: Array, dy: Array) -> Array:
    dx *= dx
    dy *= dy
    dx += dy
    return dx


def _take_in(near: Array, far: Array, at: Array, d: Array, n: Array | int) -> None:
    """Take in a further point, one or one a sample, by the squares of its distances."""
    np.minimum(far, np.maximum(near, d), out=far)
    nearer = d < near
    np.copyto(at, n, where=nearer)
    np.minimum(near, d, out=near)
