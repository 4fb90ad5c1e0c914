"""Stations on the ice: rows of houses, a dome, a runway of packed snow, and what leads there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .lattice import WORLD_M, Array, bits, cell_hash, mix, pole_of, salt, unit
from .paint import Canvas, line_cover, ramp
from .region import COARSE, coarse_fields
from .samples import Points, Samples, shared
from .scene import Scene

COLOURS = 7
"""Colours that buildings differ by."""

_LEVEL, _SHARE, _REACH_M = 11, 0.22, 2600.0
"""Cells of this level, 19.6 km, hold a station each, a share of them; nothing of one is farther from its middle."""

_AT_POLE_M = (180.0, -140.0)
"""Where the South Pole's lies from the pole."""

_LARGEST_PIXEL_M, _SHADOW_M = 40.0, 5.0
"""Stations are drawn up to this pixel size; how far their shadows reach."""

_GROUND, _DOME = -1, -2


@dataclass(frozen=True)
class _Station:
    """A station: rectangles and domes in metres along its own axes, which are turned by an angle.

    Attributes
    ----------
    x, y : float
        Its middle, Metres from the chart's upper left corner.
    cosine, sine : float
    parts : float64 array (n, 4)
        Centres along and across, half lengths and half widths.
    kinds : int array (n,)
        `_GROUND` for packed snow, `_DOME`, or the number of a colour below `COLOURS`.
    """

    x: float
    y: float
    cosine: float
    sine: float
    parts: Array
    kinds: Array


def near(seed: int, samples: Samples) -> list[_Station]:
    """Stations that may reach samples."""
    side = WORLD_M / (1 << _LEVEL)
    spans = []
    for origin, local in zip(samples.origin_m, samples.local_m()):
        low, high = float(origin) + float(local.min()), float(origin) + float(local.max())
        first, last = ((end / side) for end in (low - _REACH_M, high + _REACH_M))
        spans.append(range(int(np.floor(first)), int(np.floor(last)) + 1))
    found = (_station(seed, i, j) for j in spans[1] for i in spans[0])
    return [station for station in found if station is not None]


@shared(256)
def _station(seed: int, i: int, j: int) -> _Station | None:
    """Return the station of a cell, where it has one: on thick ice on land, and right by the South Pole."""
    middle = 1 << (_LEVEL - 1)
    side = WORLD_M / (1 << _LEVEL)
    number = cell_hash(salt(seed, 23), _LEVEL, np.array([[i]]), np.array([[j]])).ravel()
    place = mix(number + np.uint32(1))
    x, y = ((n + 0.2 + 0.6 * float(bits(place, shift, 10)[0])) * side for n, shift in ((i, 0), (j, 10)))
    if (i, j) == (middle, middle) and pole_of(seed) < 0:
        x, y = (middle * side + away for away in _AT_POLE_M)
    elif float(bits(number, 0, 8)[0]) >= _SHARE or not _stands(seed, x, y):
        return None
    angle = 2.0 * np.pi * float(bits(place, 20, 10)[0])
    parts, kinds = _buildings(number)
    return _Station(x, y, float(np.cos(angle)), float(np.sin(angle)), parts, kinds)


def _stands(seed: int, x: float, y: float) -> bool:
    """Whether a place is on ice on land."""
    samples = Points(0, 0, 0, np.array([x / WORLD_M]), np.array([y / WORLD_M]))
    window = samples.cells(COARSE).support()
    fields = coarse_fields(seed, window)
    land, heat, rough = (float(samples.spline(fields[name], window)[0]) for name in ("land", "heat", "rough"))
    return land > 0.15 and heat < 0.12 and rough < 0.35


def _buildings(number: Array) -> tuple[Array, Array]:
    """Parts of a station by its hash, shape (n, 4), and their kinds, what lies below first."""

    def random(count: int, use: int) -> Array:
        return np.asarray(
            unit(mix(number + np.arange(count, dtype=np.uint32) * np.uint32(7919) + np.uint32(use))), float
        )

    runway = 650.0 + 650.0 * random(1, 1)[0]
    away = 260.0 + 240.0 * random(1, 2)[0]
    ground = [
        (0.0, away, runway, 26.0),
        (-70.0, away / 2.0, 4.0, away / 2.0),
        (150.0, 6.0, 260.0, 3.2),
        (0.0, 0.0, 118.0, 34.0),
        (12.0, -78.0, 92.0, 22.0),
    ]
    count = 4 + int(5 * random(1, 3)[0])
    halves = np.stack([8.0 + 8.0 * random(count, 4), 4.5 + 2.0 * random(count, 5)], axis=1)
    along = np.cumsum(2.0 * halves[:, 0] + 7.0) - halves[:, 0]
    modules = np.column_stack([along - along.mean(), np.zeros(count), halves])
    huts = 5 + int(7 * random(1, 6)[0])
    small = np.column_stack(
        [
            -88.0 + 186.0 * (np.arange(huts) + 0.5 * random(huts, 7)) / huts,
            -70.0 - 16.0 * random(huts, 8),
            3.0 + 5.0 * random(huts, 9),
            2.4 + 2.4 * random(huts, 10),
        ]
    )
    containers = np.column_stack(
        [
            300.0 + 8.0 * np.arange(14) + 0 * random(14, 11),
            np.full(14, 16.0),
            np.full(14, 1.3),
            np.full(14, 3.1),
        ]
    )
    containers = containers[random(14, 12) < 0.8]
    dome = np.array([[-95.0 - 20.0 * random(1, 13)[0], 2.0, 9.0, 9.0]])
    own = int(random(1, 14)[0] * COLOURS)
    kinds = [
        np.full(len(ground), _GROUND),
        np.full(count, own),
        (random(huts, 15) * COLOURS).astype(int),
        (random(len(containers), 16) * COLOURS).astype(int),
        np.array([_DOME]),
    ]
    return np.concatenate([ground, modules, small, containers, dome]), np.concatenate(kinds)


def paint(
    canvas: Canvas, scene: Scene, inks: Sequence[Sequence[float]], shadow: Sequence[float] | None
) -> None:
    """Draw stations: packed snow in the first ink, buildings in the `COLOURS` others, and shadows in theirs."""
    samples, p = scene.samples, scene.pixel_m
    if p > _LARGEST_PIXEL_M:
        return
    for station in near(scene.seed, samples):
        east, south = (
            local - np.float32(place - float(origin))
            for local, place, origin in zip(samples.local_m(), (station.x, station.y), samples.origin_m)
        )
        east, south = (c.ravel() for c in np.broadcast_arrays(east, south))
        along = east * np.float32(station.cosine) + south * np.float32(station.sine)
        across = south * np.float32(station.cosine) - east * np.float32(station.sine)
        moved = np.array([station.cosine + station.sine, station.cosine - station.sine]) * _SHADOW_M
        ends = (along.min() - p, along.max() + p), (across.min() - p, across.max() + p)
        reach = station.parts[:, 2:] + np.abs(moved)
        in_reach = np.all(
            [(c + r >= low) & (c - r <= high) for c, r, (low, high) in zip(station.parts.T, reach.T, ends)],
            axis=0,
        )
        parts, kinds = station.parts[in_reach], station.kinds[in_reach]
        grounds, houses = kinds == _GROUND, kinds != _GROUND
        layers: list[tuple[Array, Array, Sequence[float] | None, float]] = [
            (grounds, np.zeros(2), inks[0], 0.55)
        ]
        if shadow is not None:
            layers.append((houses, moved, shadow, 0.6))
        layers.append((houses, np.zeros(2), None, 1.0))
        for chosen, by, ink, opacity in layers:
            for (x, y, length, width), kind in zip(parts[chosen], kinds[chosen]):
                at, cover = _cover(
                    along - np.float32(x + by[0]), across - np.float32(y + by[1]), length, width, kind, p
                )
                if at.size:
                    canvas.touch(
                        at, (cover * np.float32(opacity), inks[max(kind, 0) + 1] if ink is None else ink)
                    )


def _cover(
    along: Array, across: Array, length: float, width: float, kind: int, pixel_m: float
) -> tuple[Array, Array]:
    """Flat indices of the samples under a part of a station, whose middle they are told from, and its coverage."""
    across, along = np.abs(across, out=across), np.abs(along, out=along)
    at = np.flatnonzero((across < np.float32(width + pixel_m)) & (along < np.float32(length + pixel_m)))
    along, across = along[at], across[at]
    if kind == _DOME:
        return at, ramp(np.float32(length) - np.hypot(along, across), pixel_m)
    return at, line_cover(along, length, pixel_m) * line_cover(across, width, pixel_m)
