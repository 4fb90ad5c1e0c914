"""Distortion of lenses, after Brown and Conrady and, for fisheyes, after Kannala and Brandt, as OpenCV defines them.

Coordinates are to the right and down from the principal point, in focal lengths: of directions x/z and y/z, those of an
ideal pinhole camera; of points in a picture those that the lens makes of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Flags, Floats
from ..errors import InvalidInput

#: Iterations of Newton's method; smooth lenses need about six.
_TURNS = 60
#: Last steps of Newton's method, after which its error is far smaller, and errors that are rounding.
_CLOSE, _NOISE = 1e-13, 1e-12
#: Points whose directions are found at a time: few enough for the caches of a processor.
_BATCH = 1 << 13
#: Azimuths about the optical axis at which a lens is examined.
_AZIMUTHS = 64
#: Radii examined at a time, and halvings of a bisection done at a time.
_TOGETHER, _HALVINGS = 64, 5
#: Largest angle off the axis that an ideal picture shows, radians.
_WIDEST = math.radians(89.9)
#: Angle that is given to points outside the picture whose rays do not lead ahead, radians.
_BESIDE = math.pi / 2.0 - 1e-6


@dataclass(frozen=True)
class BrownConrady:
    """Radial distortion by the rational model of k1 to k6, and the tangential one of p1 and p2."""

    k: tuple[float, ...]
    p1: float
    p2: float

    def seen(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Points of the picture."""
        r2 = x * x + y * y
        above, below = self._radial(r2)
        radial = above / below
        return (
            x * radial + 2.0 * self.p1 * x * y + self.p2 * (r2 + 2.0 * x * x),
            y * radial + self.p1 * (r2 + 2.0 * y * y) + 2.0 * self.p2 * x * y,
        )

    def slopes(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives of the picture's x by x and y, and of its y by x and y."""
        k1, k2, k3, k4, k5, k6 = self.k
        r2 = x * x + y * y
        above, below = self._radial(r2)
        radial = above / below
        # By the squared radius, twice.
        growth = (
            2.0 * ((k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3)) - radial * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6))) / below
        )
        mixed = growth * x * y + 2.0 * (self.p1 * x + self.p2 * y)
        return (
            radial + growth * x * x + 2.0 * self.p1 * y + 6.0 * self.p2 * x,
            mixed,
            mixed,
            radial + growth * y * y + 6.0 * self.p1 * y + 2.0 * self.p2 * x,
        )

    def whole(self, x: Floats, y: Floats) -> Flags:
        """Whether the polynomial in the denominator is positive."""
        return np.asarray(self._radial(x * x + y * y)[1] > 0.0)

    def _radial(self, r2: Floats) -> tuple[Floats, Floats]:
        """Numerator and denominator of the radial factor."""
        k1, k2, k3, k4, k5, k6 = self.k
        return 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)), 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6))


@dataclass(frozen=True)
class PerspectiveLens:
    """A Brown–Conrady lens for a picture: beyond `limit` it goes on with the slope there.

    Parameters
    ----------
    limit : float
        Distance of a direction from the axis, in focal lengths.
    """

    model: BrownConrady
    limit: float

    @classmethod
    def fitted(cls, model: BrownConrady, border: Floats) -> PerspectiveLens:
        """Lens for a picture whose border has these points (n, 2).

        Raises
        ------
        InvalidInput
            The distortion folds the picture inside its border.
        """
        reach = float(np.hypot(*border.T).max())
        covers, fold = _examined(model, reach)
        if math.isinf(covers):
            raise _folded(float(_radii(model, np.array([fold])).max()), reach)
        whole = cls(model, covers)
        edge = float(np.hypot(*whole.ideal(*border.T)).max())
        # Half of the way to the fold, so that the inverse is smooth in the picture and around it.
        return cls(model, edge + (min(fold, 3.0 * edge) - edge) / 2.0)

    def seen(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Points of the picture that directions have."""
        beyond = np.sqrt(x * x + y * y) - self.limit
        if not (beyond > 0.0).any():
            return self.model.seen(x, y)
        beyond, at = np.maximum(beyond, 0.0), self._held(x, y)
        base, slope = self.model.seen(*at), self._outward(*at)
        return base[0] + beyond * slope[0], base[1] + beyond * slope[1]

    def seen_vectors(self, x: Floats, y: Floats, ahead: Floats) -> tuple[Floats, Floats]:
        """Points of the picture of vectors with these parts across and along the axis, times those along it.

        Smooth also beside and behind the camera.
        """
        across = np.hypot(x, y)
        inside = across <= self.limit * ahead
        depth = np.where(inside, ahead, 1.0)
        near = self.model.seen(np.where(inside, x, 0.0) / depth, np.where(inside, y, 0.0) / depth)
        some = np.where(across > 0.0, across, 1.0)
        at = self.limit * x / some, self.limit * y / some
        base, slope = self.model.seen(*at), self._outward(*at)
        far = (base[axis] * ahead + (across - self.limit * ahead) * slope[axis] for axis in (0, 1))
        x_ahead, y_ahead = (np.where(inside, one * ahead, other) for one, other in zip(near, far))
        return x_ahead, y_ahead

    def ideal(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Directions that points of the picture have; the inverse of `seen`, by Newton's method."""
        shape = np.broadcast_shapes(np.shape(x), np.shape(y))
        x, y = (np.broadcast_to(np.asarray(at, np.float64), shape).ravel() for at in (x, y))
        found = np.empty((2, len(x)))
        for start in range(0, len(x), _BATCH):
            some = slice(start, start + _BATCH)
            found[:, some] = self._ideal(x[some], y[some])
        return found[0].reshape(shape), found[1].reshape(shape)

    def _ideal(self, x: Floats, y: Floats) -> Floats:
        """`ideal` of points (n,), as an array (2, n)."""
        found, some = np.stack([x, y]), np.arange(len(x))
        off_x, off_y = self._off(x, y, x, y)
        for _ in range(_TURNS):
            at_x, at_y = found[:, some]
            xx, xy, yx, yy = self.slopes(at_x, at_y)
            area = xx * yy - xy * yx
            step_x, step_y = (yy * off_x - xy * off_y) / area, (xx * off_y - yx * off_x) / area
            error, share = off_x * off_x + off_y * off_y, np.ones(len(some))
            for _ in range(_TURNS):
                next_x, next_y = at_x - share * step_x, at_y - share * step_y
                off_x, off_y = self._off(next_x, next_y, x[some], y[some])
                worse = (off_x * off_x + off_y * off_y > error) & (error > _NOISE * _NOISE)
                if not worse.any():
                    break
                share[worse] /= 2.0
            found[:, some] = next_x, next_y
            moved = (np.abs(step_x) + np.abs(step_y)) * share > _CLOSE * (1.0 + np.abs(next_x) + np.abs(next_y))
            if not moved.any():
                break
            some, off_x, off_y = some[moved], off_x[moved], off_y[moved]
        return found

    def slopes(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives of `seen` at directions within the limit: of x by x and y, of y by x and y."""
        return self.model.slopes(*self._held(x, y))

    def _off(self, at_x: Floats, at_y: Floats, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        seen_x, seen_y = self.seen(at_x, at_y)
        return seen_x - x, seen_y - y

    def _held(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Directions, drawn in to the limit."""
        radius = np.sqrt(x * x + y * y)
        if not (radius > self.limit).any():
            return x, y
        share = np.minimum(1.0, self.limit / np.maximum(radius, self.limit))
        return x * share, y * share

    def _outward(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Derivatives of `seen` away from the axis."""
        radius = np.maximum(np.hypot(x, y), np.finfo(float).tiny)
        xx, xy, yx, yy = self.model.slopes(x, y)
        return (xx * x + xy * y) / radius, (yx * x + yy * y) / radius


def _examined(model: BrownConrady, reach: float) -> tuple[float, float]:
    """Radius of directions whose points surround a radius of the picture, and that of the first fold; else infinite."""
    folded = covers = math.inf
    radius, step = 0.0, min(reach, 1.0) / 64.0
    while math.isinf(folded) and radius < math.tan(_WIDEST) and radius <= 4.0 * covers:
        some: list[tuple[float, float]] = []
        while len(some) < _TOGETHER and radius < math.tan(_WIDEST):
            radius += step
            some.append((radius - step, radius))
            step = max(step, radius / 256.0)
        radii = np.array([high for _, high in some])
        folds, surrounds = _folds(model, radii), _radii(model, radii).min(axis=1) >= reach
        for (low, radius), is_folded, is_around in zip(some, folds.tolist(), surrounds.tolist()):
            if is_folded:
                folded = _first_fold(model, low, radius)
                break
            if math.isinf(covers) and is_around:
                covers = radius
            if radius > 4.0 * covers:
                break
    last = min(folded, radius)
    if math.isinf(covers) and float(_radii(model, np.array([last])).min()) >= reach:
        covers = last
    return covers, last if math.isinf(covers) else folded


def _first_fold(model: BrownConrady, low: float, high: float) -> float:
    """Radius of directions up to which nothing folds, by bisection between one that does not and one that does."""
    for _ in range(60 // _HALVINGS):
        # The middles of all halves that may come next, from the whole to the smallest, are examined together.
        halves = [(low, high)]
        for at in range((1 << _HALVINGS) - 1):
            left, right = halves[at]
            middle = (left + right) / 2.0
            halves += [(left, middle), (middle, right)]
        folds, at = _folds(model, np.array([sum(one) / 2.0 for one in halves[: (1 << _HALVINGS) - 1]])), 0
        for _ in range(_HALVINGS):
            at = 2 * at + (1 if folds[at] else 2)
        low, high = halves[at]
    return low


def _circles(radii: Floats) -> tuple[Floats, Floats]:
    """Directions around the axis at radii (n,), (n, azimuths) each."""
    turn = np.arange(_AZIMUTHS) * (2.0 * np.pi / _AZIMUTHS)
    return radii[:, np.newaxis] * np.cos(turn), radii[:, np.newaxis] * np.sin(turn)


def _radii(model: BrownConrady, radii: Floats) -> Floats:
    """Distances from the principal point of points at radii of directions (n,), (n, azimuths)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        found: Floats = np.hypot(*model.seen(*_circles(radii)))
    return found


def _folds(model: BrownConrady, radii: Floats) -> Flags:
    """Whether points stop moving outward, or are mirrored, at radii of directions (n,)."""
    x, y = _circles(radii)
    with np.errstate(divide="ignore", invalid="ignore"):
        xx, xy, yx, yy = model.slopes(x, y)
        seen_x, seen_y = model.seen(x, y)
        outward = (xx * x + xy * y) * seen_x + (yx * x + yy * y) * seen_y
        folds = ~model.whole(x, y) | (outward <= 0.0) | (xx * yy - xy * yx <= 0.0)
    return np.asarray(folds.any(axis=1))


def _folded(fold: float, reach: float) -> InvalidInput:
    return InvalidInput(
        "lens distortion: folds the image at {0:.3g} focal lengths from the principal point, and its farthest corner "
        "is at {1:.3g}",
        fold,
        reach,
        field="k1",
        remedy="choose a smaller field of view, or coefficients that hold in the whole image",
    )


@dataclass(frozen=True)
class FisheyeLens:
    """A Kannala–Brandt fisheye of k1 to k4: beyond the angle ``limit``, in radians, it goes on with the slope there."""

    k: tuple[float, ...]
    limit: float

    @classmethod
    def fitted(cls, k: tuple[float, ...], border: Floats) -> FisheyeLens:
        """Lens for a picture whose border has these points (n, 2).

        Raises
        ------
        InvalidInput
            The distortion folds the picture inside its border, or the picture shows directions beside the camera.
        """
        reach = float(np.hypot(*border.T).max())
        whole = cls(k, math.inf)
        angles = np.linspace(0.0, math.pi, 8193)
        falls = np.flatnonzero(whole._slope(angles) <= 0.0)
        fold = float(angles[falls[0]]) if len(falls) else math.inf
        top = min(fold, _WIDEST)
        at_top = float(whole._radius(np.array(top)))
        if at_top < reach and fold < _WIDEST:
            raise _folded(at_top, reach)
        if at_top < reach:
            raise InvalidInput(
                "fisheye: its image reaches {0:.3g} focal lengths from the principal point, where a ray is more than "
                "{1:.1f} deg off the axis ({2:.3g} focal lengths)",
                reach,
                math.degrees(_WIDEST),
                at_top,
                field="fov_deg",
                remedy="choose a smaller field of view",
            )
        edge = math.atan(float(cls(k, top).ideal(np.array([reach]), np.zeros(1))[0][0]))
        return cls(k, edge + (min(fold, math.pi) - edge) / 2.0)

    def seen(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Points of the picture that directions have."""
        return self._at_angle(x, y, np.arctan(np.hypot(x, y)))

    def seen_vectors(self, x: Floats, y: Floats, ahead: Floats) -> tuple[Floats, Floats]:
        """Points of the picture of vectors with these parts across and along the axis, also behind the camera."""
        return self._at_angle(x, y, np.arctan2(np.hypot(x, y), ahead))

    def ideal(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Directions that points of the picture have; the inverse of `seen`, by Newton's method."""
        radius = np.hypot(x, y)
        angle = np.minimum(self._angle(radius), _BESIDE)
        share = np.where(radius > 0.0, np.tan(angle) / np.where(radius > 0.0, radius, 1.0), 1.0)
        return x * share, y * share

    def slopes(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives of `seen` at directions: of x by x and y, of y by x and y."""
        r2 = x * x + y * y
        radius = np.sqrt(r2)
        angle = np.arctan(radius)
        around = np.where(radius > 0.0, self._radius(angle) / np.where(radius > 0.0, radius, 1.0), 1.0)
        outward = self._slope(angle) / (1.0 + r2)
        growth = np.where(r2 > 0.0, (outward - around) / np.where(r2 > 0.0, r2, 1.0), 0.0)
        return around + growth * x * x, growth * x * y, growth * x * y, around + growth * y * y

    def _at_angle(self, x: Floats, y: Floats, angle: Floats) -> tuple[Floats, Floats]:
        across = np.hypot(x, y)
        share = np.where(across > 0.0, self._radius(angle) / np.where(across > 0.0, across, 1.0), 1.0)
        return x * share, y * share

    def _radius(self, angle: Floats) -> Floats:
        """Radius in the picture at angles off the axis."""
        k1, k2, k3, k4 = self.k
        at = np.minimum(angle, self.limit)
        squared = at * at
        found: Floats = at * (1.0 + squared * (k1 + squared * (k2 + squared * (k3 + squared * k4))))
        found += (angle - at) * self._slope(at)
        return found

    def _slope(self, angle: Floats) -> Floats:
        """Derivative of the radius by the angle."""
        k1, k2, k3, k4 = self.k
        at = np.minimum(angle, self.limit)
        squared = at * at
        found: Floats = 1.0 + squared * (3.0 * k1 + squared * (5.0 * k2 + squared * (7.0 * k3 + squared * 9.0 * k4)))
        return found

    def _angle(self, radius: Floats) -> Floats:
        """Angles off the axis at radii in the picture."""
        low, high = np.zeros(np.shape(radius)), np.full(np.shape(radius), math.pi)
        angle: Floats = np.minimum(radius, self.limit)
        for _ in range(_TURNS):
            off = self._radius(angle) - radius
            low, high = np.where(off <= 0.0, angle, low), np.where(off >= 0.0, angle, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                tried = angle - off / self._slope(angle)
            # Newton's step, or a half where it leaves the bracket.
            tried = np.where((tried >= low) & (tried <= high), tried, (low + high) / 2.0)
            moved = np.abs(tried - angle)
            angle = np.asarray(tried, np.float64)
            if not (moved > _CLOSE * (1.0 + angle)).any():
                break
        return angle
