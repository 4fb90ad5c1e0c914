"""Texts of lengths, areas and durations, in metric units or in feet and related units."""

from __future__ import annotations

from ..core.mission.estimate import area_text as metric_area_text
from ..core.mission.estimate import length_text as metric_length_text
from ..core.units import M_PER_FT
from .i18n import number_text, tr, translate

METRES, FEET = "m", "ft"
_FT_PER_MILE, _INCHES_PER_FT = 5280.0, 12.0
#: Sizes of the international acre and of the square mile.
_M2_PER_ACRE, _ACRES_PER_SQ_MI = 4046.8564224, 640.0


def length_text(value_m: float, unit: str) -> str:
    """Length in a suitable unit: kilometres to millimetres, or miles, feet and inches."""
    if unit != FEET:
        return translate(metric_length_text(value_m))
    feet = value_m / M_PER_FT
    if feet >= _FT_PER_MILE:
        return f"{_number(feet / _FT_PER_MILE)} mi"
    return f"{_number(feet)} ft" if feet >= 1.0 else f"{_number(feet * _INCHES_PER_FT)} in"


def gsd_text(value_m: float, unit: str) -> str:
    """Text of a ground sample distance; with feet, in inches up to 440 ft."""
    if unit != FEET:
        return translate(metric_length_text(value_m))
    inches = value_m / M_PER_FT * _INCHES_PER_FT
    return f"{_number(inches)} in" if inches < _FT_PER_MILE else length_text(value_m, unit)


def area_text(value_m2: float, unit: str) -> str:
    """Area in km² or m², or in square miles or acres."""
    if unit != FEET:
        return translate(metric_area_text(value_m2))
    acres = value_m2 / _M2_PER_ACRE
    return (
        tr("{count} sq mi").format(count=_number(acres / _ACRES_PER_SQ_MI))
        if acres >= _ACRES_PER_SQ_MI
        else tr("{count} acres").format(count=_number(acres))
    )


def duration_text(seconds: float) -> str:
    """Text of a duration in seconds, minutes or hours."""
    if seconds < 90.0:
        return tr("{count} s").format(count=max(round(seconds), 1))
    if seconds < 5400.0:
        return tr("{count} min").format(count=round(seconds / 60.0))
    return tr("{count} h").format(count=number_text(seconds / 3600.0, ".1f"))


def _number(value: float) -> str:
    return number_text(value, ",.0f") if value >= 1e3 else number_text(value, ".4g")
