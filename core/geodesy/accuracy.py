"""Error bounds of each method in pixels and metres, in closed form, before anything is computed.

An error is the distance in the planned image between a ground point and its position in the image of the ideal pinhole
over the ellipsoid. Symbols of the bounds: R = b²/a the least radius of curvature, ε = h/R, t the tangent of half the
diagonal field of view, ρ half the diagonal in px, κ = εt, T = |tan φ|.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Floats
from ..errors import Message
from .camera import Camera, Poses
from .ellipsoid import WGS84, Ellipsoid

#: Largest expansion parameters for which the flat model's series is a bound.
FLAT_DOMAIN = 0.1
#: Rounding of the series of level cameras in float64, px.
_SERIES_ROUNDING_PX = 1e-6
#: Rounding of ground positions in degrees, in metres. Half the last digit is 0.8e-9 m of latitude and 1.6e-9 m of
#: longitude; no other error of `ellipsoid.trace` grows with the Earth's size.
_GROUND_ROUNDING_M = 2e-9
#: Rounding of positions on the map, in metres of ground. If functions are within 4 units in the last place (8·2⁻⁵³),
#: asinh tan φ is off by 8·2⁻⁵³(ψ + sin φ), at most 6.5e-9 m. Rounding of φ, 2π and the world fraction adds 3e-9 m,
#: rounding of the position in pixels 9e-9 m.
_MAP_ROUNDING_M = 1.6e-8
#: Smallest ground size of a pixel, in metres: rounding of degrees is a twentieth of it, rounding on the map two fifths.
RESOLVED_M = 4e-8
#: Poses whose corner rays are computed at a time, to bound memory.
_BATCH = 1 << 14


@dataclass(frozen=True, eq=False)
class ImageGeometry:
    """Camera, image size, poses and ground: the inputs of the bounds.

    Parameters
    ----------
    width_px, height_px : float or array (n,)
        Size of the planned image.
    poses : Poses
        Poses (n,).
    """

    camera: Camera
    width_px: float | Floats
    height_px: float | Floats
    poses: Poses
    ground: Ellipsoid = WGS84

    @property
    def one_size_px(self) -> tuple[int, int]:
        """Width and height of the images, which must have one size."""
        return int(np.ravel(self.width_px)[0]), int(np.ravel(self.height_px)[0])

    @property
    def radius_m(self) -> float:
        """Least radius of curvature of the ground, R = b²/a."""
        return self.ground.b_m**2 / self.ground.a_m

    @property
    def diagonal_tangent(self) -> float:
        """Tangent of half the diagonal field of view, t; of a camera that distorts, the greatest in its image."""
        return self.camera.extremes.tangent if self.camera.distorts else math.hypot(*self.camera.half_tangents)

    @property
    def half_diagonal_px(self) -> Floats:
        """ρ, (n,); one number if all images have one size."""
        return np.asarray(np.hypot(self.width_px, self.height_px) / 2.0, np.float64)

    @property
    def focal_px(self) -> Floats:
        """Focal length in px, (n,)."""
        return self.half_diagonal_px / math.hypot(*self.camera.half_tangents)

    @property
    def magnification(self) -> float:
        """Greatest number of pixels for one of the ideal image; 1 unless the camera distorts."""
        return float(self.camera.extremes.greatest_scale.max())

    @property
    def focal_column(self) -> Floats:
        """Focal lengths as a column, (n, 1)."""
        return np.broadcast_to(self.focal_px, self.poses.lat_deg.shape)[:, np.newaxis]

    @property
    def height_share(self) -> Floats:
        """ε, (n,)."""
        return self.poses.agl_m / self.radius_m

    @property
    def size_share(self) -> Floats:
        """κ, (n,)."""
        return self.height_share * self.diagonal_tangent

    @property
    def lat_tangent(self) -> Floats:
        """T, (n,); finite, as no float64 is π/2."""
        return np.asarray(np.abs(np.tan(np.radians(self.poses.lat_deg))), np.float64)

    @property
    def nadir_px_m(self) -> Floats:
        """Metres of flat ground that a pixel spans straight below the camera, (n,)."""
        return self.poses.agl_m / self.focal_px

    def parts(self) -> Iterator[ImageGeometry]:
        """Geometry of the poses, a bounded number at a time."""
        for start in range(0, max(len(self.poses.lat_deg), 1), _BATCH):
            some = slice(start, start + _BATCH)
            width, height = (
                side[some] if isinstance(side, np.ndarray) else side for side in (self.width_px, self.height_px)
            )
            yield replace(self, width_px=width, height_px=height, poses=self.poses.take(some))


def bound_px(scene: ImageGeometry, series: Floats) -> Floats:
    """Bound of a truncated series, with its remainder and float64 rounding, (n,).

    The remainder is at most 15 % of the series, as validated by Monte Carlo over the whole domain.
    """
    return 1.15 * series + _SERIES_ROUNDING_PX + _GROUND_ROUNDING_M / scene.nadir_px_m


def flat_bending_px(scene: ImageGeometry) -> Floats:
    """Error of a flat image over the curved Earth, ρεt²/2, (n,)."""
    return scene.half_diagonal_px * scene.height_share * scene.diagonal_tangent**2 / 2.0


def map_frame_px(scene: ImageGeometry) -> Floats:
    """Bound of the error of a map frame through the edge midpoints that ignores a small attitude, (n,).

    ρεt²/2 + 1.05(T/R)[W·h/4 + (W·w + H·h)/8] + ρ(max(w, h)/R)²(1 + T²) for footprints of w by h metres and images of
    W by H px. A yaw of α radians moves a corner by up to ρα, a tilt or roll of α by up to f(1 + t²)α.
    """
    radius, bend = scene.radius_m, scene.lat_tangent
    width_m, height_m = (2.0 * scene.poses.agl_m * tangent for tangent in scene.camera.half_tangents)
    width_px, height_px = scene.width_px, scene.height_px
    across = np.rint(scene.poses.yaw_deg / 90.0) % 2.0 == 1.0
    width_m, height_m = np.where(across, height_m, width_m), np.where(across, width_m, height_m)
    width_px, height_px = np.where(across, height_px, width_px), np.where(across, width_px, height_px)
    converging = 1.05 * bend / radius * (width_px * height_m / 4.0 + (width_px * width_m + height_px * height_m) / 8.0)
    second = scene.half_diagonal_px * (np.maximum(width_m, height_m) / radius) ** 2 * (1.0 + bend**2)
    flat = flat_bending_px(scene) + converging + second
    return bound_px(scene, flat) + map_noise_px(scene) + _attitude_px(scene)


def map_noise_px(scene: ImageGeometry) -> Floats:
    """Error of level images from rounding of map positions, (n,)."""
    noise: Floats = _MAP_ROUNDING_M / scene.nadir_px_m
    return noise


def _attitude_px(scene: ImageGeometry) -> Floats:
    """Largest difference between the image of a small attitude and the nearest level quarter turn, (n,)."""
    off_yaw, *off_level = (np.mod(angle + 180.0, 360.0) - 180.0 for angle in scene.poses.attitude)
    off_yaw = off_yaw - 90.0 * np.rint(off_yaw / 90.0)
    yaw, tilt, roll = (np.abs(np.radians(angle)) for angle in (off_yaw, *off_level))
    across = scene.focal_px * (1.0 + scene.diagonal_tangent**2)
    turned: Floats = scene.half_diagonal_px * yaw + across * (tilt + roll)
    return turned


def finest_px_m(scene: ImageGeometry) -> Floats:
    """Least metres of ground spanned by a pixel of the image, (n,).

    For a ray of length L and drop D, both per unit along the axis, the image magnifies the ground by up to L·D relative
    to the nadir; this is largest at a corner, and 1 in a level image. A distortion magnifies it further.
    """
    spread = np.concatenate([_corner_spread(part) for part in scene.parts()])
    level = (scene.poses.tilt_deg == 0.0) & (scene.poses.roll_deg == 0.0)
    level_spread = scene.magnification if scene.camera.distorts else 1.0
    return np.asarray(scene.nadir_px_m / np.where(level, level_spread, np.maximum(spread, level_spread)), np.float64)


def _corner_spread(scene: ImageGeometry) -> Floats:
    sin_below, squared = corner_angles(scene)
    spread: Floats = np.max(squared * np.clip(sin_below, 0.0, 1.0), axis=1) * scene.magnification
    return spread


def exact_px(scene: ImageGeometry) -> Floats:
    """Bound of the exact camera in float64 anywhere in the image: rounding of ground positions and of rays, (n,).

    A ray of length L per unit along the axis, turned by an angle, moves by up to f·L² times that angle in the image.
    Rays are rounded at most 128 times (2⁻⁵³ each): 8 for the sine of each of three angles, 6 for their products, 16 for
    the tangent of the field of view, 64 for `ellipsoid.trace`.
    """
    squared = np.concatenate([np.max(corner_angles(part)[1], axis=1) for part in scene.parts()])
    noise: Floats = _GROUND_ROUNDING_M / finest_px_m(scene) + 2.0**-46 * scene.focal_px * squared * scene.magnification
    return noise


def camera_frame_px(scene: ImageGeometry) -> Floats:
    """Bound of a camera frame that traces every pixel: `exact_px` plus rounding of map positions, (n,)."""
    on_map: Floats = _MAP_ROUNDING_M / finest_px_m(scene)
    return exact_px(scene) + on_map


def mesh_noise_px(scene: ImageGeometry) -> Floats:
    """Least bound of a mesh cell: rounding of the map positions of its four corners, (n,)."""
    return scene.magnification * (_SERIES_ROUNDING_PX + 4.0 * _MAP_ROUNDING_M / scene.nadir_px_m)


def outside_flat_domain(scene: ImageGeometry, bend: Floats | float | None = None) -> str:
    """Reason why flat-ground methods have no bound, with value and limit; empty if they have one.

    Parameters
    ----------
    bend : array (n,), float, or None
        Largest curvature of straight ground lines in the plane of the map, relative to the Earth's; None for Mercator,
        where it is the tangent of the latitude.
    """
    bends = scene.lat_tangent if bend is None else bend
    stretch = float(np.max(scene.height_share)) * scene.diagonal_tangent**2
    size = float(np.max(scene.size_share * np.maximum(bends, 1.0)))
    tilted = float(max(np.max(np.abs(scene.poses.tilt_deg)), np.max(np.abs(scene.poses.roll_deg))))
    if tilted > 0.0:
        return Message("tilt or roll of {0:g} deg: holds for cameras that look straight down", tilted)
    if not stretch <= FLAT_DOMAIN:
        return Message(
            "height over Earth's radius times tan²(FOV/2) is {0:.3g}: holds up to {1:g}", stretch, FLAT_DOMAIN
        )
    if not size <= FLAT_DOMAIN:
        return Message(
            "footprint over Earth's radius times tan(latitude) is {0:.3g}: holds up to {1:g}",
            size,
            FLAT_DOMAIN,
        )
    return ""


def corner_angles(scene: ImageGeometry) -> tuple[Floats, Floats]:
    """Sines of the corner rays' angles below the horizontal, and squared lengths per unit along the axis, (n, 4).

    Of a camera that distorts, those of its `Camera.extremes`.
    """
    # Yaw does not matter: if all poses share one tilt and roll, one pose gives the result for all.
    leans = scene.poses.tilt_deg, scene.poses.roll_deg
    if not any(any(angle.strides) for angle in leans):
        leans = leans[0][:1], leans[1][:1]
    points = scene.camera.extremes.ideal_xy
    rays = scene.camera.ideal_rays_enu(points, 0.0, *leans)
    squared = np.sum(rays * rays, axis=-1)
    shape = len(scene.poses.tilt_deg), len(points)
    return np.broadcast_to(-rays[..., 2] / np.sqrt(squared), shape), np.broadcast_to(squared, shape)


def grazing(sin_below: Floats, height_share: Floats) -> tuple[Floats, Floats]:
    """(1 + ε) sin β of rays over a sphere, and the squared sine of the grazing angle at the ground.

    β is the angle below the horizontal. The squared sine is negative for rays that miss the sphere.
    """
    reach = 1.0 + height_share
    return reach * sin_below, 1.0 - reach**2 * (1.0 - sin_below**2)


def condition_number(scene: ImageGeometry, *, on_mercator: bool = True) -> float:
    """Largest relative change of a ground position per relative change of its inputs.

    The larger of two condition numbers. For images on the Mercator map, that of Mercator's latitude, sec φ. For the ray
    that meets the ground at the flattest angle, that of the ground distance as a function of the angle off nadir, on a
    sphere. Infinite if the image shows the horizon.
    """
    nearest_pole = float(np.max(np.abs(scene.poses.lat_deg))) if on_mercator else 0.0
    mercator = 1.0 / float(np.cos(np.radians(nearest_pole)))
    return max(mercator, *(_ray_condition(part) for part in scene.parts()))


def _ray_condition(scene: ImageGeometry) -> float:
    sin_below, _ = corner_angles(scene)
    share = scene.height_share[:, np.newaxis]
    lifted, squared = grazing(sin_below, share)
    if (squared <= 0.0).any() or (sin_below <= 0.0).any():
        return math.inf
    grazed = np.sqrt(squared)
    off_nadir = np.arccos(np.clip(sin_below, -1.0, 1.0))
    # ds/dβ = R((1 + ε) sin β / c - 1), where (1 + ε) sin β - c = ε(2 + ε)/((1 + ε) sin β + c) avoids cancellation.
    slope = share * (2.0 + share) / ((lifted + grazed) * grazed)
    arc = np.arctan2(np.sqrt(1.0 - sin_below**2) * share * (2.0 + share) / (lifted + grazed), 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        rays = np.where(arc > 0.0, off_nadir * slope / arc, 1.0)
    return float(np.max(rays))


def terrain_px_per_m(scene: ImageGeometry) -> float:
    """Displacement in the image per metre of unmodelled relief, at the worst corner.

    At an angle α off nadir, a point higher by dz moves by the angle dz·sin α·cos α / h; infinite at the horizon.
    """
    return max(_corner_terrain_px_per_m(part) for part in scene.parts())


def _corner_terrain_px_per_m(scene: ImageGeometry) -> float:
    sin_below, squared = corner_angles(scene)
    if (sin_below <= 0.0).any():
        return math.inf
    across = np.sqrt(1.0 - np.minimum(sin_below, 1.0) ** 2)
    angle_per_m = sin_below * across / scene.poses.agl_m[:, np.newaxis]
    return float(np.max(angle_per_m * squared * scene.focal_column * scene.camera.extremes.greatest_scale))


def ground_m_per_px(scene: ImageGeometry) -> float:
    """Metres of ground that a pixel spans at the farthest corner, the most in the image; infinite at the horizon."""
    return max(_corner_m_per_px(part) for part in scene.parts())


def _corner_m_per_px(scene: ImageGeometry) -> float:
    sin_below, squared = corner_angles(scene)
    share = scene.height_share[:, np.newaxis]
    lifted, grazed2 = grazing(sin_below, share)
    if (grazed2 <= 0.0).any() or (sin_below <= 0.0).any():
        return math.inf
    grazed = np.sqrt(grazed2)
    slant = scene.radius_m * share * (2.0 + share) / (lifted + grazed)
    per_px = slant / grazed / (np.sqrt(squared) * scene.focal_column) / scene.camera.extremes.least_scale
    return float(max(np.max(per_px * np.sqrt(squared)), np.max(scene.nadir_px_m)))
