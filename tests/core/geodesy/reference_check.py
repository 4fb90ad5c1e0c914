"""How far long double and the core are from 50 digits: ``python -m tests.core.geodesy.reference_check [SCENES]``."""

from __future__ import annotations

import math
import sys
import time

import mpmath
import numpy as np
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import WGS84, trace

from tests.core.geodesy import longdouble, reference, scenes

#: Rounding of float64 relative to a number.
EPS = 2.0**-53
#: Half of the last place of a float64 longitude beyond 128 degrees, on the equator.
DEGREES_FLOOR_M = 1.6e-9


def exact(value):
    """A long double or float as mpf, losing nothing."""
    if isinstance(value, longdouble.Real):
        high = float(value)
        with mpmath.workdps(reference.DIGITS):
            return mpmath.mpf(high) + mpmath.mpf(float(value - longdouble.Real(high)))
    return mpmath.mpf(float(value))


def core_sees(drawn):
    """Ground points of the core's camera, scene by scene as its API has it; arrays (n,)."""
    lat, dlon = np.empty(len(drawn.x)), np.empty(len(drawn.x))
    hit = np.empty(len(drawn.x), bool)
    for at, row in enumerate(drawn.rows()):
        camera_lat, agl, fov, ratio, yaw, tilt, roll, x, y, height = row
        ray = Camera(fov, ratio).rays_enu(((x, y),), yaw, tilt, roll)
        ground = trace(np.array([camera_lat]), np.array([agl]), ray, WGS84.raised(height))
        lat[at], dlon[at], hit[at] = ground.lat_deg[0], ground.dlon_deg[0], ground.hit[0]
    return lat, dlon, hit


def rounding_m(slant_m, grazing):
    """What one float64 rounding of a ray's direction, and one of the degrees that state its end, move that end."""
    return EPS * slant_m / grazing + DEGREES_FLOOR_M


def compare(drawn, lat, dlon, hit):
    """Worst figures of computed ground points: metres, and share of what the inputs' own rounding costs."""
    found = []
    wrong = []
    for at, row in enumerate(drawn.rows()):
        point = reference.see(*row)
        if (point is not None) != bool(hit[at]):
            wrong.append((row, bool(hit[at])))
            continue
        if point is None:
            continue
        error = reference.distance_m((exact(lat[at]), exact(dlon[at])), point, row[-1])
        slant, grazing = reference.slant_and_grazing(*row[:2], point, row[-1])
        found.append((float(error), float(slant), float(grazing), at))
    return np.array(found), wrong


def report(title, drawn, seen):
    """Print the figures of a draw by how steeply the ray meets the ground."""
    start = time.perf_counter()
    found, wrong = compare(drawn, *seen)
    print(f"{title}: {len(drawn.x)} scenes, {len(found)} seen, {len(wrong)} decided otherwise", end="")
    print(f" ({time.perf_counter() - start:.0f} s)")
    for row, hit in wrong[:10]:
        print(f"  hit={hit}: {row}")
    if not len(found):
        return
    error, slant, grazing, at = found.T
    print(f"  not a number: {int(np.isnan(error).sum())}")
    edges = [0.0, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0 + 1e-9]
    for low, high in zip(edges[:-1], edges[1:]):
        inside = (grazing >= low) & (grazing < high)
        if not inside.any():
            continue
        where = np.flatnonzero(inside)
        worst = where[np.argmax(error[where])]
        ratio = (error / rounding_m(slant, grazing))[where]
        print(
            f"  sine of incidence {low:g}..{high:g}: {len(where):6d}  worst {error[worst]:.2e} m, median "
            f"{np.median(error[where]):.1e} m; of the inputs' rounding: worst {ratio.max():.2g}, median "
            f"{np.median(ratio):.2g}"
        )
        scene = drawn.take(int(at[worst]))
        print("     ", ", ".join(f"{name}={float(v)!r}" for name, v in zip(scenes.Scenes._fields, scene)))


def report_look(title, drawn):
    """Print how far long double's image points of float64 ground points are from 50 digits, in px of 640."""
    seen = longdouble.see(*drawn)
    keep = np.flatnonzero(seen.hit)
    drawn = drawn.take(keep)
    points = [c[keep].astype(np.float64) for c in (seen.lat_deg, seen.dlon_deg)]
    looked = longdouble.look(*drawn[:7], *points, drawn.ground_height_m)
    worst, decided, relative = 0.0, 0, 0.0
    for at, row in enumerate(drawn.rows()):
        image = reference.look(*row[:7], float(points[0][at]), float(points[1][at]), row[-1])
        if (image is not None) != bool(looked.visible[at]):
            decided += 1
        elif image is not None:
            off = math.hypot(float(image[0] - exact(looked.x[at])), float(image[1] - exact(looked.y[at]))) * 320
            worst = max(worst, off)
            relative = max(relative, off / 320 / max(1.0, math.hypot(*map(float, image))))
    print(
        f"{title}: {len(keep)} points, {decided} decided otherwise, worst {worst:.2e} px of 640, "
        f"{relative:.2e} of the image point"
    )


def main():
    """Check both on draws of the given size."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    for title, drawn in (
        ("whole domain", scenes.whole_domain(1, count)),
        ("1e-3 to 1 degree inside the horizon", scenes.near_the_horizon(2, count // 2)),
        ("1e-9 to 1e-3 degree inside the horizon", scenes.near_the_horizon(3, count // 4, (1e-9, 1e-3))),
        ("1e-9 to 1 degree above the horizon", scenes.near_the_horizon(4, count // 4, (-1.0, -1e-9))),
    ):
        report(f"long double, {title}", drawn, longdouble.see(*drawn))
        report_look(f"long double's look, {title}", drawn)
        report(f"core, {title}", drawn, core_sees(drawn))


if __name__ == "__main__":
    main()
