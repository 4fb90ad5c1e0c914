"""A camera over the ellipsoid at 50 digits, written from the definitions and sharing nothing with the core."""

from __future__ import annotations

import mpmath

DIGITS = 50


def ground_point(lat_deg, height_m, ray_enu):
    """Latitude and longitude from the camera's (degrees, mpf) where a ray meets WGS84; None where it misses."""
    with mpmath.workdps(DIGITS):
        a = mpmath.mpf(6378137)
        f = 1 / mpmath.mpf("298.257223563")
        b = a * (1 - f)
        e2 = f * (2 - f)
        phi = mpmath.radians(mpmath.mpf(float(lat_deg)))
        h = mpmath.mpf(float(height_m))
        n = a / mpmath.sqrt(1 - e2 * mpmath.sin(phi) ** 2)
        camera = ((n + h) * mpmath.cos(phi), mpmath.mpf(0), (n * (1 - e2) + h) * mpmath.sin(phi))
        e, north, up = (mpmath.mpf(float(c)) for c in ray_enu)
        ray = (
            -mpmath.sin(phi) * north + mpmath.cos(phi) * up,
            e,
            mpmath.cos(phi) * north + mpmath.sin(phi) * up,
        )
        # The surface x²/a² + y²/a² + z²/b² = 1 along camera + t·ray, as the textbook quadratic in t.
        axes = (a, a, b)
        qa = sum((r / s) ** 2 for r, s in zip(ray, axes))
        qb = 2 * sum(c * r / s**2 for c, r, s in zip(camera, ray, axes))
        qc = sum((c / s) ** 2 for c, s in zip(camera, axes)) - 1
        disc = qb * qb - 4 * qa * qc
        if disc < 0:
            return None
        t = (-qb - mpmath.sqrt(disc)) / (2 * qa)
        if t <= 0:
            return None
        x, y, z = (c + t * r for c, r in zip(camera, ray))
        lat = mpmath.atan2(z, (1 - e2) * mpmath.hypot(x, y))
        return mpmath.degrees(lat), mpmath.degrees(mpmath.atan2(y, x))


def zone_area_m2(south_deg, north_deg):
    """Ground between two parallels over all longitudes, by the closed form of the authalic latitude."""
    with mpmath.workdps(DIGITS):
        a = mpmath.mpf(6378137)
        f = 1 / mpmath.mpf("298.257223563")
        b = a * (1 - f)
        e = mpmath.sqrt(f * (2 - f))

        def half(lat_deg):
            s = mpmath.sin(mpmath.radians(mpmath.mpf(float(lat_deg))))
            return mpmath.pi * b * b * (s / (1 - (e * s) ** 2) + mpmath.atanh(e * s) / e)

        return half(north_deg) - half(south_deg)
