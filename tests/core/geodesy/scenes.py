"""Seeded draws of scenes over the whole domain, as arguments of `reference.see` and `longdouble.see`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tests.core.geodesy import longdouble

AGL_M = (1e-2, 3.6e7)
FOV_DEG = (0.01, 179.9)
ASPECT_RATIO = (1e-3, 1e3)
GROUND_M = (-430.0, 8848.0)
LATITUDES_DEG = (0.0, 60.0, 84.0, 85.05, 89.9999, 90.0)


class Scenes(NamedTuple):
    """Cameras, each with one image point; arrays (n,) in degrees and metres."""

    lat_deg: np.ndarray
    agl_m: np.ndarray
    fov_deg: np.ndarray
    aspect_ratio: np.ndarray
    yaw_deg: np.ndarray
    tilt_deg: np.ndarray
    roll_deg: np.ndarray
    x: np.ndarray
    y: np.ndarray
    ground_height_m: np.ndarray

    def rows(self):
        """Arguments of each scene as Python floats."""
        return zip(*(column.tolist() for column in self))

    def take(self, which):
        """Some of the scenes, by index or mask."""
        return Scenes(*(column[which] for column in self))


def whole_domain(seed, count):
    """Scenes of any attitude: half of them within a right angle of straight down, and a quarter level."""
    random = np.random.default_rng(seed)
    lat = _latitudes(random, count)
    anywhere = random.random(count) < 0.5
    tilt = np.where(anywhere, random.uniform(-180, 180, count), random.uniform(-89, 89, count))
    roll = np.where(anywhere, random.uniform(-180, 180, count), random.uniform(-30, 30, count))
    level = random.random(count) < 0.25
    corner = random.random(count) < 0.25
    x, y = random.uniform(-1, 1, (2, count))
    return Scenes(
        lat,
        _log_uniform(random, AGL_M, count),
        _fields_of_view(random, count),
        _log_uniform(random, ASPECT_RATIO, count),
        random.uniform(-180, 180, count),
        np.where(level, 0.0, tilt),
        np.where(level, 0.0, roll),
        np.where(corner, np.sign(x), x),
        np.where(corner, np.sign(y), y),
        np.where(random.random(count) < 0.5, 0.0, random.uniform(*GROUND_M, count)),
    )


def near_the_horizon(seed, count, inside_deg=(1e-3, 1.0)):
    """Scenes whose image centre looks some degrees below the horizon (above, where the range is negative)."""
    random = np.random.default_rng(seed)
    scenes = whole_domain(seed, count)
    flat = np.zeros(count)
    scenes = scenes._replace(roll_deg=flat, x=flat, y=flat)
    low, high = np.zeros(count, longdouble.Real), np.full(count, 90, longdouble.Real)
    for _ in range(64):
        middle = (low + high) / 2
        hit = longdouble.see(*scenes._replace(tilt_deg=middle)).hit
        low, high = np.where(hit, middle, low), np.where(hit, high, middle)
    sense = np.sign(inside_deg[1])
    inside = sense * _log_uniform(random, np.sort(np.abs(inside_deg)), count)
    return scenes._replace(tilt_deg=(low - inside).astype(np.float64))


def _log_uniform(random, ends, count):
    return np.exp(random.uniform(*np.log(ends), count))


def _fields_of_view(random, count):
    """A third uniform, a third close to the narrowest, a third close to the widest."""
    narrow = _log_uniform(random, (FOV_DEG[0], 90.0), count)
    wide = 180.0 - _log_uniform(random, (180.0 - FOV_DEG[1], 90.0), count)
    return np.choose(random.integers(0, 3, count), [random.uniform(*FOV_DEG, count), narrow, wide])


def _latitudes(random, count):
    """A third uniform, a third of the places where formulas break, a third close to the pole; both hemispheres."""
    by_kind = [
        random.uniform(0, 90, count),
        random.choice(LATITUDES_DEG, count),
        90.0 - _log_uniform(random, (1e-9, 10.0), count),
    ]
    return np.choose(random.integers(0, 3, count), by_kind) * random.choice([-1.0, 1.0], count)
