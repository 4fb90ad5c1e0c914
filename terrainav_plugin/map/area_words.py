"""How large an area is, in words. Knows no widget."""

from __future__ import annotations

import math

import numpy as np

from ...core.geodesy.ellipsoid import WGS84
from ...core.mission.area import Area, Box, Points, Polygon
from ..i18n import localized, number_text, tr

_M_PER_KM, _M2_PER_KM2 = 1e3, 1e6
#: Latitudes at which a meridian's curvature is looked at, for its length to the four digits that are shown.
_LATITUDES = 17


def size_m(box: Box) -> tuple[float, float]:
    """Width along the middle parallel and height along a meridian, in metres on the ground."""
    middle = np.radians((box.north_deg + box.south_deg) / 2.0)
    radius = float(WGS84.normal_radius_m(np.degrees(middle)))
    width = radius * math.cos(float(middle)) * math.radians(box.span_deg)
    radii = WGS84.meridional_radius_m(np.linspace(box.south_deg, box.north_deg, _LATITUDES))
    return width, float(radii.mean()) * math.radians(box.north_deg - box.south_deg)


def length_text(length_m: float) -> str:
    """Length in m or km."""
    if length_m < _M_PER_KM:
        return number_text(length_m, ".1f" if length_m < 10.0 else ".0f") + " m"
    km = length_m / _M_PER_KM
    return number_text(km, ".2f" if km < 100.0 else ",.0f") + " km"


def ground_text(area_m2: float) -> str:
    """Ground in m² or km²."""
    if area_m2 < 1e4:
        return number_text(area_m2, ",.0f") + " m²"
    km2 = area_m2 / _M2_PER_KM2
    return number_text(km2, ".2g" if km2 < 0.1 else ",.0f" if km2 >= 100.0 else ".3g") + " km²"


def size_text(box: Box) -> str:
    """Width, height and ground of a box."""
    width, height = (length_text(length) for length in size_m(box))
    return f"{width} × {height}, {ground_text(box.area_m2())}"


def area_words(area: Area, m_per_unit: float = 1.0, unit: str = "m") -> str:
    """What an area is, in a line.

    Parameters
    ----------
    m_per_unit, unit
        Of the heights of points.
    """
    if isinstance(area, Box):
        return tr("Box, {size}").format(size=size_text(area))
    if isinstance(area, Polygon):
        return _polygon_words(area)
    heights = [agl / m_per_unit for _, _, agl in area.poses]
    words = [
        tr("Single capture") if len(heights) == 1 else tr("{n} points").format(n=number_text(len(heights)))
    ]
    low, high = (
        localized(f"{height:,.1f}".rstrip("0").rstrip(".")) for height in (min(heights), max(heights))
    )
    words.append((low if low == high else f"{low}–{high}") + f" {unit} AGL")
    if area.yaws_deg:
        if len(heights) == 1:
            words.append(tr("yaw {yaw}°").format(yaw=number_text(area.yaws_deg[0], "g")))
        else:
            words.append(tr("each with its yaw"))
    return ", ".join(words)


def _polygon_words(polygon: Polygon) -> str:
    corners = sum(len(ring) for ring in polygon.rings)
    words = [tr("Polygon"), tr("{n} corners").format(n=number_text(corners))]
    holes = len(polygon.rings) - 1
    if holes:
        words.append(tr("1 hole") if holes == 1 else tr("{n} holes").format(n=holes))
    words.append(ground_text(polygon.area_m2()))
    return ", ".join(words)


def readout(area: Area) -> str:
    """What is said at the cursor while an area is drawn or moved."""
    if isinstance(area, Points):
        return tr("{n} points").format(n=len(area.poses)) if len(area.poses) > 1 else tr("Single capture")
    return size_text(area) if isinstance(area, Box) else ground_text(area.area_m2())
