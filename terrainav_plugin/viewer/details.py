"""What is told of an image beside its picture. Knows no widget."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator
from typing import Any

from ..i18n import number_text, told, tr
from .shots import Seen

#: Metadata that the rows above tell already, or that concern programs only.
_TOLD = {
    "AREA_OR_POINT",
    "NAME",
    "MAP_TYPE",
    "SOURCE",
    "ATTRIBUTION",
    "ZOOM",
    "LAT_DEG",
    "LON_DEG",
    "AGL_M",
    "YAW_DEG",
    "TILT_DEG",
    "ROLL_DEG",
    "IMAGERY_DATE",
    "EFFECTIVE_GSD_M_PER_PX",
}


def details_html(seen: Seen) -> str:
    """Table of what is known of an image."""
    rows = "".join(
        f"<tr><td style='padding-right: 8px'><b>{html.escape(name)}</b></td><td>{html.escape(value)}</td></tr>"
        for name, value in details(seen)
        if value
    )
    return f"<table>{rows}</table>"


def details(seen: Seen) -> Iterator[tuple[str, str]]:
    """Names and values, in the order in which they are asked for most."""
    pose, row, metadata = seen.shot.pose, seen.row, seen.picture.metadata
    yield tr("Image"), seen.shot.name
    if row.get("status") == "failed":
        yield tr("Failed"), told(row.get("reason", ""))
    elif seen.picture.problem:
        yield tr("Missing"), seen.picture.problem
    if seen.rejected:
        yield tr("Rejected"), tr("by cleaning the dataset")
    yield (
        tr("Position"),
        tr("{lat}°, {lon}°").format(lat=_number(pose, "lat_deg", 7), lon=_number(pose, "lon_deg", 7)),
    )
    yield tr("Height"), tr("{agl} m above ground").format(agl=_number(pose, "agl_m", 2))
    angles = (_number(pose, name, 2) for name in ("yaw_deg", "tilt_deg", "roll_deg"))
    yield tr("Yaw, tilt, roll"), tr("{}°, {}°, {}°").format(*angles)
    yield tr("Time"), _time(pose)
    if seen.picture.width_px:
        yield (
            tr("Size"),
            tr("{width} × {height} px").format(width=seen.picture.width_px, height=seen.picture.height_px),
        )
    yield tr("Ground sample distance"), _gsd(metadata.get("EFFECTIVE_GSD_M_PER_PX", ""))
    yield tr("Entropy"), _entropy(row.get("entropies", ""))
    yield tr("Source"), row.get("source") or metadata.get("SOURCE", "")
    yield tr("Imagery date"), row.get("imagery_date") or metadata.get("IMAGERY_DATE", "")
    yield tr("Attribution"), row.get("attribution") or metadata.get("ATTRIBUTION", "")
    yield tr("Zoom"), str(pose.get("zoom", ""))
    yield tr("Column, row"), f"{pose.get('column', '')}, {pose.get('row', '')}"
    for name, value in metadata.items():
        if name not in _TOLD and not name.startswith(("TIFFTAG_", "EXIF_")):
            yield name.replace("_", " ").capitalize(), value
    yield tr("File"), str(seen.picture.path)


def _number(values: dict[str, Any], name: str, decimals: int) -> str:
    value = values.get(name)
    return f"{value:.{decimals}f}" if isinstance(value, (int, float)) else ""


def _time(pose: dict[str, Any]) -> str:
    """When it is exposed, as far as the footprint says so."""
    value = pose.get("time")
    if value is None:
        return ""
    text = value.toString("yyyy-MM-dd HH:mm:ss.zzz t") if hasattr(value, "toString") else str(value)
    return text if text != "NULL" else ""


def _gsd(text: str) -> str:
    value = _float(text)
    return "" if math.isnan(value) else tr("{gsd} m/px").format(gsd=number_text(value, ".4g"))


def _entropy(text: str) -> str:
    value = _float(text)
    return "" if math.isnan(value) else tr("{bits} bits").format(bits=number_text(value, ".3f"))


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
