"""Projections at 50 digits, written from their definitions and sharing nothing with the core or with PROJ."""

from __future__ import annotations

import mpmath

from tests.core.geodesy.reference import DIGITS, axes


def _eccentricity():
    a, b = axes()
    return a, mpmath.sqrt(1 - (b / a) ** 2)


def _isometric(phi, e):
    return mpmath.atanh(mpmath.sin(phi)) - e * mpmath.atanh(e * mpmath.sin(phi))


def polar_stereographic(lat_deg, lon_deg, standard_lat_deg, meridian_deg):
    """Easting and northing of the polar stereographic projection of true scale at a latitude (EPSG method 9829)."""
    with mpmath.workdps(DIGITS):
        a, e = _eccentricity()
        sign = 1 if standard_lat_deg > 0 else -1
        phi, standard = (sign * mpmath.radians(mpmath.mpf(angle)) for angle in (lat_deg, standard_lat_deg))
        turn = mpmath.radians(mpmath.mpf(lon_deg) - mpmath.mpf(meridian_deg))
        scale = mpmath.cos(standard) / mpmath.sqrt(1 - (e * mpmath.sin(standard)) ** 2)
        # Of the pole the isometric latitude is infinite, and the radius nothing.
        radius = mpmath.mpf(0)
        if phi < mpmath.pi / 2:
            radius = a * scale * mpmath.exp(_isometric(standard, e) - _isometric(phi, e))
        return radius * mpmath.sin(turn), -sign * radius * mpmath.cos(turn)


def transverse_mercator(lat_deg, lon_deg, meridian_deg, south=False):
    """Easting and northing of UTM about a meridian: its arc at the latitude whose isometric one is ψ + iλ."""
    with mpmath.workdps(DIGITS):
        a, e = _eccentricity()
        phi, turn = (
            mpmath.radians(mpmath.mpf(lat_deg)),
            mpmath.radians(mpmath.mpf(lon_deg) - mpmath.mpf(meridian_deg)),
        )
        wanted = _isometric(phi, e) + 1j * turn
        start = mpmath.mpc(phi, turn * mpmath.cos(phi))
        found = mpmath.findroot(lambda z: _isometric(z, e) - wanted, start)
        arc = mpmath.quad(lambda z: a * (1 - e**2) / (1 - (e * mpmath.sin(z)) ** 2) ** mpmath.mpf("1.5"), [0, found])
        scale = mpmath.mpf("0.9996")
        return 500000 + scale * mpmath.im(arc), scale * mpmath.re(arc) + (10_000_000 if south else 0)
