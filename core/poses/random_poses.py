"""Random poses inside an area: places uniform over its ground, heights and angles from given distributions.

Random numbers are raw words of numpy's PCG64, whose stream numpy guarantees (NEP 19), and results are rounded: the same
seed gives the same poses everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Flags, Floats
from ..errors import InvalidInput, Message
from ..geodesy.camera import Poses
from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import wrap_lon_deg
from ..limits import MAX_POSES
from ..mission.areas.area import ANGLES, Box, Points, Polygon, Polygons, area_contains, check_agl, check_area
from ..mission.flight.deviates import normal, uniform
from ..numbers import real_number
from .track import ANGLE_DIGITS, PLACE_DIGITS

FIXED, UNIFORM, NORMAL = "fixed", "uniform", "normal"
#: Number of draws after which drawing may be given up.
_TRIES = 100_000
#: Share of accepted draws below which drawing is given up.
_LEAST_SHARE = 1e-3


@dataclass(frozen=True)
class Distribution:
    """A fixed number, or a uniform or normal distribution.

    Parameters
    ----------
    kind : {"fixed", "uniform", "normal"}
    first, second : float
        Fixed: the number, and 0. Uniform: the lower and the upper end. Normal: the mean and the standard deviation.

    Raises
    ------
    InvalidInput
        An unknown kind, numbers that are not finite, an upper end below the lower end, or a negative standard
        deviation.
    """

    kind: str
    first: float
    second: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in (FIXED, UNIFORM, NORMAL):
            raise InvalidInput("distribution {0!r}: must be a number, uniform or normal", self.kind)
        if not (math.isfinite(self.first) and math.isfinite(self.second)):
            raise InvalidInput("distribution {0}: its numbers must be finite", self)
        if self.kind == UNIFORM and self.second < self.first:
            raise InvalidInput("distribution {0}: the lower end comes first", self)
        if self.kind == NORMAL and self.second < 0.0:
            raise InvalidInput("distribution {0}: the standard deviation must be 0 or more", self)

    def __str__(self) -> str:
        return f"{self.first:g}" if self.kind == FIXED else f"{self.kind} {self.first:g} {self.second:g}"

    @classmethod
    def parse(cls, words: Sequence[str]) -> Distribution:
        """Parse ``120``, ``uniform 80 150`` or ``normal 0 5``, split into words; raises InvalidInput."""
        kind, *texts = words if len(words) == 3 else (FIXED, *words)
        try:
            numbers = [real_number(text) for text in texts]
        except ValueError:
            numbers = []
        if len(numbers) != 1 + (kind != FIXED):
            raise InvalidInput(
                "distribution {0!r}: must be a number, uniform LOW HIGH or normal MEAN DEVIATION",
                " ".join(words),
            )
        return cls(kind, *numbers)

    def draw(self, bits: np.random.PCG64, count: int) -> Floats:
        """Draw numbers (count,)."""
        if self.kind == FIXED:
            return np.full(count, self.first)
        if self.kind == UNIFORM:
            return self.first + (self.second - self.first) * uniform(bits, count)
        return self.first + self.second * normal(bits, count, 1)[:, 0]


@dataclass(frozen=True)
class PoseDistributions:
    """Distributions of heights above ground, in metres, and of angles, in degrees."""

    agl: Distribution
    yaw: Distribution = field(default_factory=lambda: Distribution(UNIFORM, -180.0, 180.0))
    tilt: Distribution = field(default_factory=lambda: Distribution(FIXED, 0.0))
    roll: Distribution = field(default_factory=lambda: Distribution(FIXED, 0.0))


def random_poses(
    area: Box | Polygon | Polygons,
    count: int,
    distributions: PoseDistributions,
    seed: int,
    keep: Callable[[Poses], Flags] | None = None,
) -> Points:
    """Draw random poses inside an area.

    Heights that are not above 0, and tilts and rolls beyond 180 degrees, are drawn again; yaws are wrapped. A larger
    count begins with the poses of a smaller one.

    Parameters
    ----------
    count : int
        At least 1.
    seed : int
        At least 0.
    keep : callable or None
        Returns which poses (n,) to keep; the others are drawn again. See `mission.inside`.

    Raises
    ------
    InvalidInput
        A count or seed out of range; fewer than one in a thousand numbers of a distribution, places of the box around a
        polygon, or poses are usable.
    """
    if keep is not None:
        return _draw_kept(area, count, distributions, seed, keep)
    if not 1 <= count <= MAX_POSES:
        raise InvalidInput("{0:,} poses: must be from 1 to {1:,}", count, MAX_POSES)
    if seed < 0:
        raise InvalidInput("seed {0}: must be 0 or more", seed)
    # One stream for each, so that changing one distribution leaves the numbers of others unchanged.
    streams = [np.random.PCG64(sequence) for sequence in np.random.SeedSequence(seed).spawn(5)]
    lat, lon = _places(area, streams[0], count)
    # Check after drawing, which refuses needle-shaped areas with a clearer message.
    check_area(area)
    agl = _numbers("agl", distributions.agl, streams[1], count)
    check_agl(float(agl.max()))
    angles = {
        f"{name}s_deg": tuple(_numbers(name, getattr(distributions, name), bits, count).tolist())
        for name, bits in zip(ANGLES, streams[2:])
    }
    return Points(tuple(zip(lat.tolist(), lon.tolist(), agl.tolist())), **angles)


def _draw_kept(
    area: Box | Polygon | Polygons,
    count: int,
    distributions: PoseDistributions,
    seed: int,
    keep: Callable[[Poses], Flags],
) -> Points:
    """First ``count`` poses to keep, the same however many are drawn at a time."""
    drawn = count
    while True:
        points = random_poses(area, drawn, distributions, seed)
        at = np.flatnonzero(keep(_make_poses(points)))[:count].tolist()
        if len(at) == count:
            break
        if drawn == MAX_POSES or (drawn >= _TRIES and len(at) < _LEAST_SHARE * drawn):
            raise InvalidInput(
                "{0:,} of {1:,} poses lie within the imagery with all that they see",
                len(at),
                drawn,
                remedy="choose an area that lies farther inside, lower heights, or less tilt",
            )
        drawn = min(max(2 * drawn, math.ceil(1.1 * drawn * count / max(len(at), 1))), 8 * drawn + 100, MAX_POSES)
    angles = {f"{name}s_deg": tuple(points.stated_deg(name)[one] for one in at) for name in ANGLES}
    return Points(tuple(points.poses[one] for one in at), **angles)


def _make_poses(points: Points) -> Poses:
    lat, lon, agl = np.array(points.poses, np.float64).T
    return Poses(lat, lon, agl, *(np.array(points.stated_deg(name), np.float64) for name in ANGLES))


def _numbers(name: str, distribution: Distribution, bits: np.random.PCG64, count: int) -> Floats:
    """Heights or angles (count,)."""

    def draw(batch: int) -> tuple[Floats, Flags]:
        with np.errstate(over="ignore", invalid="ignore"):
            # Numbers that overflow become infinite and are refused.
            numbers = np.round(distribution.draw(bits, batch), ANGLE_DIGITS)
            if name == "yaw":
                # A direction has no limits.
                return np.round(wrap_lon_deg(numbers), ANGLE_DIGITS), np.isfinite(numbers)
        return numbers, numbers > 0.0 if name == "agl" else np.abs(numbers) <= 180.0

    wanted = Message("above 0 m") if name == "agl" else Message("within 180 degrees")
    return _first_accepted(
        draw, count, InvalidInput("{0} {1}: hardly any of its numbers are {2}", name, distribution, wanted)
    )


def _places(area: Box | Polygon | Polygons, bits: np.random.PCG64, count: int) -> tuple[Floats, Floats]:
    """Latitudes and longitudes (count,), uniform over the ellipsoid's area."""
    box = area.bounds
    south, north = (math.sin(math.radians(angle)) for angle in (box.south_deg, box.north_deg))
    # Places uniform in the sine of latitude are uniform over a sphere. On the ellipsoid, area per sine grows toward the
    # poles, by 1.3 % in all: some candidates nearer to the equator are rejected to make up for it.
    poleward = np.array(max(box.south_deg, box.north_deg, key=abs))
    most = WGS84.meridional_radius_m(poleward) * WGS84.normal_radius_m(poleward)

    def draw(batch: int) -> tuple[Floats, Flags]:
        across, up, chance = uniform(bits, 3 * batch).reshape(batch, 3).T
        lat = np.degrees(np.arcsin(south + (north - south) * up))
        lat = np.clip(np.round(lat, PLACE_DIGITS), box.south_deg, box.north_deg)
        lon = np.round(box.west_deg + box.span_deg * across, PLACE_DIGITS)
        accepted = chance * most <= WGS84.meridional_radius_m(lat) * WGS84.normal_radius_m(lat)
        if not isinstance(area, Box):
            accepted &= area_contains(area, lat, lon)
        return np.column_stack([lat, lon]), accepted

    refusal = InvalidInput(
        "area: fills hardly any of the box around it",
        remedy="give a polygon that is less narrow",
    )
    lat, lon = _first_accepted(draw, count, refusal).T
    return lat, np.round(np.where(lon > 180.0, lon - 360.0, lon), PLACE_DIGITS)


def _first_accepted(draw: Callable[[int], tuple[Floats, Flags]], count: int, refusal: InvalidInput) -> Floats:
    """First accepted rows (count, ...), the same however many are drawn at a time; raises if hardly any are."""
    kept: list[Floats] = []
    tried = found = 0
    while found < count:
        share = max(found / tried, _LEAST_SHARE) if tried else 1.0
        # A million at a time bound memory to 32 MB.
        drawn, accepted = draw(min(math.ceil((count - found) / share), 1_000_000))
        kept.append(drawn[accepted])
        tried += len(drawn)
        found += len(kept[-1])
        if tried >= _TRIES and found < _LEAST_SHARE * tried:
            raise refusal
    return np.concatenate(kept)[:count]
