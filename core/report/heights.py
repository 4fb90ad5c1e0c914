"""Height profiles as files: a table, or a diagram."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np

from ..errors import InvalidInput
from ..external.drawing import BLACK, BLUE, FONT, GREEN, ORANGE, VERMILION, check_matplotlib, dress, new_figure, png
from ..geodesy.mercator import wrap_lon_deg
from ..mission.export.waypoints import NAMES
from ..mission.flight.path import CAPTURE
from ..mission.plan import Plan
from ..mission.profile import HeightProfile, height_profile
from ..storage.files import write_whole
from ..storage.stores import store_path

_CSV, _PNG = ".csv", ".png"
_GROUND = "#d9cfc1"
_COLUMNS = (
    "distance_m",
    "lat_deg",
    "lon_deg",
    "height_m",
    "ground_m",
    "surface_m",
    "clearance_m",
    "point",
    "image",
    "sortie",
)


def check_profile_ending(path: str | os.PathLike[str]) -> str:
    """Return the ending of a profile's file; refuse unknown ones, and a diagram if matplotlib is missing."""
    name = store_path(path).name.lower()
    ending = next((one for one in (_CSV, _PNG) if name.endswith(one) and name != one), "")
    if not ending:
        raise InvalidInput("profile {0!r}: must end in {1}", str(path), f"{_CSV}, {_PNG}")
    if ending == _PNG:
        check_matplotlib()
    return ending


def write_profile(plan: Plan, path: str | os.PathLike[str]) -> HeightProfile:
    """Write the height profile of a plan as a table (.csv) or a diagram (.png), and return it.

    Raises
    ------
    InvalidInput
        The ending is unknown.
    OutputError
        The file cannot be written, or matplotlib, which draws diagrams, is missing.
    """
    ending = check_profile_ending(path)
    profile = height_profile(plan)
    data = [profile_diagram(profile)] if ending == _PNG else (line.encode() for line in profile_table(profile))
    write_whole(store_path(path), data)
    return profile


def profile_table(profile: HeightProfile) -> Iterator[str]:
    """Lines of a profile as CSV, with a header. Unknown heights are empty; images and sorties are numbered from 1."""
    yield ",".join(_COLUMNS) + "\n"
    names = {CAPTURE: "image", **NAMES}
    points = [names.get(kind, "") for kind in profile.kind.tolist()]
    heights = (profile.height_m, profile.ground_m, profile.surface_m, profile.clearance_m)
    columns = (
        [f"{value:.2f}" for value in profile.distance_m.tolist()],
        [f"{value:.9f}" for value in profile.lat_deg.tolist()],
        [f"{value:.9f}" for value in wrap_lon_deg(profile.lon_deg).tolist()],
        *(["" if np.isnan(value) else f"{value:.3f}" for value in values.tolist()] for values in heights),
        points,
        [str(image + 1) if image >= 0 else "" for image in profile.image.tolist()],
        [str(sortie + 1) for sortie in profile.sortie.tolist()],
    )
    for row in zip(*columns):
        yield ",".join(row) + "\n"


def least_clearance(profile: HeightProfile) -> str:
    """Text on the place of the least clearance; empty if no clearance is known."""
    at = profile.lowest
    if at is None:
        return ""
    lat_deg, lon_deg = float(profile.lat_deg[at]), float(wrap_lon_deg(profile.lon_deg[at]))
    return (
        f"least clearance {profile.clearance_m[at]:.1f} m, {profile.distance_m[at]:,.0f} m along the flight, at "
        f"latitude {lat_deg:.6f}, longitude {lon_deg:.6f}"
    )


def profile_diagram(profile: HeightProfile) -> bytes:
    """Draw a profile as PNG: heights of flight, surface and ground over the distance, and the clearance below."""
    figure = new_figure(13.0, 7.0)
    heights, clear = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": (2.2, 1.0)})
    unit_m, unit = (1000.0, "km") if profile.length_m >= 2000.0 else (1.0, "m")
    across = f"distance flown, {unit}"
    dress(heights, "Heights along the flight", "", "height above the ellipsoid, m")
    dress(clear, "Clearance: flight above " + ("surface" if profile.has_surface else "ground"), across, "clearance, m")
    breaks = np.flatnonzero(np.diff(profile.sortie)) + 1
    x = np.insert(profile.distance_m / unit_m, breaks, np.nan)
    flown, ground, surface, clearance = (
        np.insert(values, breaks, np.nan)
        for values in (profile.height_m, profile.ground_m, profile.surface_m, profile.clearance_m)
    )
    low = float(np.nanmin(np.append(ground, profile.height_m)))
    room = 0.06 * max(float(np.nanmax(flown)) - low, 1.0)
    heights.fill_between(x, ground, low - room, color=_GROUND, linewidth=0.0, zorder=1)
    heights.plot(x, ground, color=BLACK, linewidth=1.0, label="ground", zorder=2)
    if profile.has_surface:
        heights.plot(x, surface, color=GREEN, linewidth=1.0, label="surface", zorder=3)
    heights.plot(x, flown, color=BLUE, linewidth=1.6, label="flight", zorder=4)
    is_image = profile.kind == CAPTURE
    if 0 < is_image.sum() <= 400:
        at = (profile.distance_m[is_image] / unit_m, profile.height_m[is_image])
        heights.plot(*at, color=BLUE, marker=".", linestyle="none", markersize=4, label="images", zorder=5)
    heights.set_ylim(low - room, float(np.nanmax(np.append(flown, surface))) + 3.0 * room)
    clear.plot(x, clearance, color=ORANGE, linewidth=1.4, zorder=3)
    lowest = profile.lowest
    if lowest is not None:
        _mark_lowest(heights, clear, profile, lowest, unit_m)
    for start in breaks.tolist():
        for axes in (heights, clear):
            axes.axvline(profile.distance_m[start] / unit_m, color="#777777", linewidth=0.8, linestyle=":", zorder=1)
    clear.set_ylim(bottom=min(0.0, float(np.nanmin(np.append(clearance, 0.0)))))
    clear.set_xlim(0.0, max(profile.length_m / unit_m, 1e-6))
    heights.legend(fontsize=FONT["note"], frameon=False, ncol=5, loc="upper right")
    return png(figure)


def _mark_lowest(heights: Any, clear: Any, profile: HeightProfile, lowest: int, unit_m: float) -> None:
    x, clearance = float(profile.distance_m[lowest]) / unit_m, float(profile.clearance_m[lowest])
    label = f"least clearance {clearance:.1f} m"
    heights.plot([x], [profile.height_m[lowest]], color=VERMILION, marker="v", linestyle="none", label=label, zorder=6)
    clear.plot([x], [clearance], color=VERMILION, marker="v", linestyle="none", zorder=6)
