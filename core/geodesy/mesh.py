"""Cells of a camera's image small enough that the map under each is a plane's perspective within a bound."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .accuracy import Scene, grazing, mesh_noise_px
from .ellipsoid import GroundPoints, clearance, trace
from .mercator import lat_to_v

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]

#: Sides of the cells begun with, and of those below which every pixel gets a ray of its own, px.
_LARGEST_PX, _SMALLEST_PX = 160, 8
#: How much farther one corner of a cell may be than another: beyond, one zoom would not suit all of it.
_MOST_UNEVEN = 1.5
#: Factor on the bound for what second derivatives leave out; validated by Monte Carlo.
_BEYOND_SECOND_ORDER = 1.3
#: Rays this much longer than the view's axis, 70° off it, are beyond what the bound was validated for.
_LONGEST_RAY = 3.0
#: Longitudes of one cell farther apart than this are on two sides of a pole or of the camera's far meridian.
_FAR_SIDE_DEG = 90.0
#: Corners of a cell in the order upper left, lower left, lower right, upper right, as columns of its box.
_CORNER_X, _CORNER_Y = (0, 0, 2, 2), (1, 3, 3, 1)


class Cells(NamedTuple):
    """Cells of an image.

    ``box`` is (k, 4): left, top, right, bottom in px. ``du, v`` are (k, 4): world fractions of the corners upper left,
    lower left, lower right, upper right, from the camera's meridian and from the map's north. ``bound_px`` is (k,).
    ``loose`` is (m, 4): boxes whose pixels each need a ray. What lies in neither is sky.
    """

    box: Numbers
    du: Floats
    v: Floats
    bound_px: Floats
    loose: Numbers


class ImageRays(NamedTuple):
    """Rays of one camera's image in pixels: ``origin + x·per_x + y·per_y`` from the upper left corner, y down."""

    scene: Scene
    origin: Floats
    per_x: Floats
    per_y: Floats

    @classmethod
    def of(cls, scene: Scene) -> ImageRays:
        """Rays of a scene of one pose."""
        pose = scene.poses
        corner, right, below = scene.camera.rays_enu(
            ((-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0)), *(float(angle[0]) for angle in pose.attitude)
        )
        return cls(scene, corner, (right - corner) / scene.width_px, (below - corner) / scene.height_px)

    def at(self, x_px: Floats | Numbers, y_px: Floats | Numbers) -> Floats:
        """Rays of image points, (..., 3)."""
        x, y = (np.asarray(values, np.float64)[..., np.newaxis] for values in (x_px, y_px))
        rays: Floats = self.origin + x * self.per_x + y * self.per_y
        return rays

    def ground(self, x_px: Floats | Numbers, y_px: Floats | Numbers) -> GroundPoints:
        """Ground seen at image points."""
        pose = self.scene.poses
        return trace(pose.lat_deg[0], pose.agl_m[0], self.at(x_px, y_px), self.scene.ground)

    def map_points(
        self, x_px: Floats | Numbers, y_px: Floats | Numbers
    ) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """World fractions from the camera's meridian and from the map's north, and which rays hit."""
        seen = self.ground(x_px, y_px)
        return seen.dlon_deg / 360.0, lat_to_v(seen.lat_deg), seen.hit

    def clearance(self, x_px: Floats, y_px: Floats) -> tuple[Floats, Floats]:
        """As `ellipsoid.clearance`."""
        pose = self.scene.poses
        return clearance(pose.lat_deg[0], pose.agl_m[0], self.at(x_px, y_px), self.scene.ground)


def mesh(rays: ImageRays, tolerance_px: float) -> Cells:
    """Divide an image until the map under every cell is, within a tolerance, the perspective through its corners.

    Parameters
    ----------
    rays : ImageRays
        Of one pose.
    tolerance_px : float
        What a cell's bound must not exceed; 0 leaves every pixel that sees the Earth to a ray of its own.
    """
    noise = float(mesh_noise_px(rays.scene)[0])
    box = _first_boxes(*rays.scene.one_size_px)
    fitting: list[tuple[Numbers, Floats, Floats, Floats]] = []
    loose = [np.empty((0, 4), np.int64)]
    while len(box):
        du, v, spread, hit = _corners(rays, box)
        seen = hit.any(axis=1)
        if not seen.all():
            seen |= _holds_earth(rays, box)
            box, du, v, spread, hit = (values[seen] for values in (box, du, v, spread, hit))
        (along_x, along_y), (uneven_x, uneven_y) = _errors_px(rays, box, v, hit.all(axis=1))
        size = box[:, 2:] - box[:, :2]
        # The perspective of a thin cell hangs on its short side, and enlarges that side's noise along the long one.
        thinness = size.max(axis=1) / size.min(axis=1)
        bound = _BEYOND_SECOND_ORDER * (along_x + along_y) + noise * thinness
        whole = hit.all(axis=1) & (spread <= _FAR_SIDE_DEG / 360.0) & ((v >= 0.0) & (v <= 1.0)).all(axis=1)
        even = np.maximum(uneven_x, uneven_y) <= _MOST_UNEVEN
        fits = whole & even & (bound <= tolerance_px)
        fitting.append((box[fits], du[fits], v[fits], bound[fits]))
        smallest = (size <= _SMALLEST_PX).all(axis=1) if tolerance_px > 0.0 else np.ones(len(box), bool)
        loose.append(box[~fits & smallest])
        more = ~fits & ~smallest
        across_x = np.where(bound <= tolerance_px, uneven_x >= uneven_y, along_x >= along_y)
        box = _halved(box[more], across_x[more])
    boxes, us, vs, bounds = (np.concatenate(parts) for parts in zip(*fitting))
    return Cells(boxes, us, vs, bounds, np.concatenate(loose))


def _first_boxes(width: int, height: int) -> Numbers:
    x, y = (
        np.round(np.linspace(0, size, -(-size // _LARGEST_PX) + 1)).astype(np.int64)
        for size in (width, height)
    )
    left, top = np.meshgrid(x[:-1], y[:-1])
    right, bottom = np.meshgrid(x[1:], y[1:])
    return np.stack([left.ravel(), top.ravel(), right.ravel(), bottom.ravel()], axis=1)


def _halved(box: Numbers, across_x: NDArray[np.bool_]) -> Numbers:
    """Boxes cut in two across the axis that needs it more, or the other one where that is as small as can be."""
    size = box[:, 2:] - box[:, :2]
    along = np.where(across_x, 0, 1)
    along = np.where(
        np.take_along_axis(size, along[:, np.newaxis], axis=1)[:, 0] <= _SMALLEST_PX, 1 - along, along
    )
    row = np.arange(len(box))
    middle = (box[row, along] + box[row, along + 2]) // 2
    first, second = box.copy(), box.copy()
    first[row, along + 2] = middle
    second[row, along] = middle
    return np.concatenate([first, second])


def _corners(rays: ImageRays, box: Numbers) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
    """World fractions of the cells' corners, the spread of their longitudes, and which see the Earth."""
    du, v, hit = rays.map_points(box[:, _CORNER_X], box[:, _CORNER_Y])
    spread = np.ptp(np.where(hit, du, 0.0), axis=1)
    return du, v, spread, hit


def _errors_px(
    rays: ImageRays, box: Numbers, v: Floats, whole: NDArray[np.bool_]
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Bounds of the error along x and y, and how uneven the distance to the ground is along each, (k,) each.

    Infinite where the horizon is near.

    A perspective holds all that a pinhole sees of a plane. What is left is how far the ground of a sphere appears
    from the plane's: the angle β below the horizontal becomes β' = atan(h/S), S the arc to the ground point. A
    smooth function leaves its chord by an eighth of the chord's length times the difference of the slopes at its ends.
    Mercator bends straight lines of the ground 2T times as much. Across the direction to the horizon a chord leaves by
    an eighth of its squared length times (1 + 2T)/R of the ground it spans; 2(β' - β) and twice its slope are for the
    tangent between angles and pixels.
    """
    scene = rays.scene
    vectors = rays.at(box[:, _CORNER_X], box[:, _CORNER_Y])
    length = np.sqrt(np.sum(vectors * vectors, axis=-1))
    share = float(scene.height_share[0])
    lifted, grazed2 = grazing(-vectors[..., 2] / length, np.asarray(share))
    good = (
        whole
        & (grazed2 > 0.0).all(axis=1)
        & (lifted > 0.0).all(axis=1)
        & (length <= _LONGEST_RAY).all(axis=1)
    )
    lifted, grazed2, v = (
        np.where(good[:, np.newaxis], a, b) for a, b in ((lifted, 1.0), (grazed2, 1.0), (v, 0.5))
    )
    bend = (1.0 + 2.0 * np.abs(np.sinh((0.5 - v) * (2.0 * np.pi)))).max(axis=1)
    receding, steepening = _receding(lifted, np.sqrt(grazed2), share)
    focal = float(np.broadcast_to(scene.focal_px, 1)[0])
    slant = share * (2.0 + share) / (lifted + np.sqrt(grazed2))
    across = (slant * bend[:, np.newaxis] + 2.0 * (np.abs(receding) + np.abs(steepening))).max(axis=1) / focal
    uneven = (length.max(axis=1) / length.min(axis=1)) ** 2
    errors, unevenness = [], []
    for axis, edges in ((0, ((0, 3), (1, 2))), (1, ((0, 1), (3, 2)))):
        size = (box[:, axis + 2] - box[:, axis]).astype(np.float64)
        slopes = np.max([np.abs(steepening[:, start] - steepening[:, end]) for start, end in edges], axis=0)
        errors.append(np.where(good, uneven * size / 8.0 * (slopes * bend + size * across), np.inf))
        ratio = np.max(
            [np.maximum(slant[:, a] / slant[:, b], slant[:, b] / slant[:, a]) for a, b in edges], axis=0
        )
        unevenness.append(np.where(good, ratio, np.inf))
    return (errors[0], errors[1]), (unevenness[0], unevenness[1])


def _receding(lifted: Floats, grazed: Floats, share: float) -> tuple[Floats, Floats]:
    """β' - β and its slope: how far a sphere's ground lies from where it is seen, on the plane that stands for it."""
    squared = share * (2.0 + share) / (lifted + grazed)
    sine = lifted / (1.0 + share)
    cosine = np.sqrt(np.maximum(1.0 - sine**2, 0.0))
    arc = np.arctan2(cosine * squared, 1.0 + share - squared * sine)
    slope = share * squared / (grazed * (share * share + arc * arc)) - 1.0
    return np.arctan2(share, arc) - np.arctan2(sine, cosine), slope


def _holds_earth(rays: ImageRays, box: Numbers) -> NDArray[np.bool_]:
    """Which boxes hold ground though none of their corners sees any: (k,), true also for some that see it.

    What is seen is convex in the image: it reaches in across an edge, along which the discriminant is a quadratic,
    or lies inside altogether, with the point below the camera.
    """
    x, y = box[:, _CORNER_X].astype(np.float64), box[:, _CORNER_Y].astype(np.float64)
    next_x, next_y = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    start, towards = rays.clearance(x, y)
    middle, _ = rays.clearance((x + next_x) / 2.0, (y + next_y) / 2.0)
    end, towards_end = rays.clearance(next_x, next_y)
    square, slope = 2.0 * (start - 2.0 * middle + end), 4.0 * middle - 3.0 * start - end
    with np.errstate(divide="ignore", invalid="ignore"):
        at = np.where(square < 0.0, np.clip(-slope / (2.0 * square), 0.0, 1.0), 0.0)
    highest = np.maximum(start + at * (slope + at * square), np.maximum(start, end))
    ahead = towards + at * (towards_end - towards) < 0.0
    across = ((highest >= 0.0) & ahead).any(axis=1)
    nadir = np.linalg.solve(np.stack([rays.per_x, rays.per_y, rays.origin], axis=1), [0.0, 0.0, -1.0])
    if nadir[2] > 0.0:
        at_x, at_y = nadir[0] / nadir[2], nadir[1] / nadir[2]
        across |= (box[:, 0] <= at_x) & (at_x <= box[:, 2]) & (box[:, 1] <= at_y) & (at_y <= box[:, 3])
    return np.asarray(across)
