"""Natural ground colours, woods and settlement, as functions of warmth, moisture and height."""

from __future__ import annotations

import numpy as np

from .lattice import Array
from .region import smoothstep

#: Ground colours: rows by warmth, from ice to equator; columns dry, medium, wet.
_BIOMES = (
    ((236, 240, 245), (238, 242, 247), (240, 244, 248)),
    ((136, 128, 110), (122, 121, 98), (104, 111, 88)),
    ((126, 119, 88), (88, 101, 66), (60, 82, 54)),
    ((170, 153, 108), (118, 127, 76), (82, 106, 58)),
    ((208, 181, 132), (152, 144, 88), (88, 112, 56)),
    ((216, 188, 138), (140, 142, 78), (58, 94, 46)),
)
#: Share of land with fields per share of settled land: fields reach farther than towns.
RURAL_PER_SETTLED = 1.6
_SNOW = (240, 244, 250)


def _stops(x: Array, stops: tuple[float, ...]) -> list[Array]:
    """Weights of a piecewise linear scale at its stops."""
    weights = []
    for n, stop in enumerate(stops):
        rise = 1.0 if n == 0 else np.clip((x - stops[n - 1]) * (1.0 / (stop - stops[n - 1])), 0.0, 1.0)
        fall = 1.0 if n == len(stops) - 1 else np.clip((stops[n + 1] - x) * (1.0 / (stops[n + 1] - stop)), 0.0, 1.0)
        weights.append(np.minimum(rise, fall))
    return weights


def height(f: dict[str, Array]) -> Array:
    """Height above the sea, in units of high mountains."""
    return np.clip(f["land"], 0.0, None) * 0.16 + np.clip(f["relief"], -0.02, None) * 1.9


def natural_colour(f: dict[str, Array]) -> Array:
    """Colour of land that is not farmed, shape (3, ...), in grey levels."""
    up = height(f)
    heat = f["heat"] - np.clip(up, 0.0, 2.0) * 0.35
    heats = _stops(heat, (0.05, 0.2, 0.36, 0.55, 0.78, 1.0))
    wets = _stops(f["wet"] * 0.9, (-0.55, 0.0, 0.5))
    out = np.zeros((3, *up.shape), dtype=np.float32)
    for row, a in zip(_BIOMES, heats):
        for biome, b in zip(row, wets):
            weight = a * b
            for channel in range(3):
                out[channel] += np.float32(biome[channel]) * weight
    rock = smoothstep(0.35, 0.85, up) * np.float32(0.75)
    snow = smoothstep(0.30, 0.16, heat)
    for channel, bare, white in zip(range(3), (122, 112, 102), _SNOW):
        out[channel] += rock * (np.float32(bare) - out[channel])
        out[channel] += snow * (np.float32(white) - out[channel])
    return out


def settled(f: dict[str, Array]) -> Array:
    """Share of the land that is farmed or built on, 0..1."""
    share: Array = (
        smoothstep(0.28, 0.44, f["heat"]) * smoothstep(-0.5, -0.1, f["wet"]) * smoothstep(0.01, 0.06, f["land"])
    )
    share *= np.float32(1) - smoothstep(0.30, 0.55, f["rough"])
    jungle = smoothstep(0.35, 0.6, f["wet"]) * smoothstep(0.75, 0.95, f["heat"])
    share *= np.float32(1) - np.float32(0.8) * jungle
    return share


def rural_share(f: dict[str, Array]) -> Array:
    """Share of the land that is divided into fields."""
    return np.clip(settled(f) * np.float32(RURAL_PER_SETTLED), 0.0, 1.0)


def dryness(f: dict[str, Array]) -> Array:
    """Dryness of farmland, 0..1."""
    return smoothstep(0.15, -0.4, f["wet"])


def wateriness(f: dict[str, Array]) -> Array:
    """Factor on the width of rivers and lakes: 0 on ice and in deserts, less in mountains."""
    return (
        smoothstep(-0.6, 0.1, f["wet"]) * smoothstep(0.12, 0.24, f["heat"])
        * (np.float32(1) - np.float32(0.6) * smoothstep(0.2, 0.6, f["rough"]))
    )  # fmt: skip


def open_water(f: dict[str, Array]) -> Array:
    """Colour of water by its depth, shape (3, ...): pale shelves."""
    depth = np.clip(-f["land"], 0.0, None)
    shelf, deep = np.exp(depth * np.float32(-14.0)), smoothstep(0.05, 0.7, depth)
    out = np.empty((3, *depth.shape), dtype=np.float32)
    deepest, middle, shore = (9, 26, 52), (20, 56, 86), (66, 118, 128)
    for channel in range(3):
        c = middle[channel] + deep * np.float32(deepest[channel] - middle[channel])
        out[channel] = c + shelf * (np.float32(shore[channel]) - c)
    return out


def sea_colour(f: dict[str, Array]) -> Array:
    """Colour of the sea, shape (3, ...): water, and ice near the poles."""
    out = open_water(f)
    ice = smoothstep(0.14, 0.06, f["heat"]) * np.float32(0.92)
    for channel in range(3):
        out[channel] += ice * (np.float32(_SNOW[channel]) - out[channel])
    return out


def wood_threshold(f: dict[str, Array]) -> Array:
    """Value of the wood field above which woods grow: high in deserts and farmland, low in wet wilderness."""
    wild = np.float32(1) - settled(f)
    wetness = smoothstep(-0.5, 0.5, f["wet"])
    cold = smoothstep(0.30, 0.2, f["heat"]) + smoothstep(0.4, 0.6, f["rough"]) * np.float32(0.6)
    threshold: Array = np.float32(1.25) - np.float32(0.75) * wetness + cold
    threshold -= np.float32(0.75) * wild * (wetness - np.float32(0.35))
    return threshold
