"""The figures of a plan in the user's words."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from .i18n import tr

if TYPE_CHECKING:
    from ..core.mission.estimate import Summary


def estimate_lines(summary: Summary) -> list[tuple[str, str]]:
    """Label and value of every figure."""
    lines = [
        (tr("Images"), _images(summary)),
        (tr("Picture"), _picture(summary)),
        (tr("Ground per px"), _gsd(summary)),
    ]
    if summary.covered_share is not None:
        lines.append((tr("Coverage"), _coverage(summary)))
    if summary.least_overlap_along is not None or summary.least_overlap_across is not None:
        lines.append((tr("Overlap"), _overlap(summary)))
    lines += [
        (tr("Tiles"), _tiles(summary)),
        (tr("On disk"), _size(summary.output_bytes)),
        (tr("Time"), tr("about {duration}").format(duration=duration_text(summary.seconds))),
        (tr("Flight"), _length(summary.flight_distance_m)),
    ]
    return lines


def estimate_html(summary: Summary) -> str:
    """All figures as a table for a label."""
    rows = (
        f'<tr><td style="padding-right:10px"><b>{html.escape(label)}</b></td><td>{html.escape(value)}</td></tr>'
        for label, value in estimate_lines(summary)
    )
    return f'<table cellspacing="1">{"".join(rows)}</table>'


def _images(summary: Summary) -> str:
    text = tr("{images} in {rows} rows").format(images=f"{summary.images:,}", rows=f"{summary.rows:,}")
    types = len(summary.map_types)
    return text if types == 1 else tr("{text}, for each of {count} map types").format(text=text, count=types)


def _picture(summary: Summary) -> str:
    return tr("{width} × {height} px at zoom {zoom}").format(
        width=summary.width_px, height=summary.height_px, zoom=summary.zoom
    )


def _gsd(summary: Summary) -> str:
    camera, source = summary.camera_gsd_m_per_px, summary.source_gsd_m_per_px
    return tr("camera {camera}, source {source}").format(camera=_length(camera), source=_length(source))


def _coverage(summary: Summary) -> str:
    if summary.complete:
        return tr("100 % of {area}").format(area=_area(summary.area_m2))
    # Rounded down: what is not complete never reads 100.
    share = int(summary.covered_share * 1e4) / 1e2
    return tr("{share:.2f} % of {area}; {uncovered} left out").format(
        share=share, area=_area(summary.area_m2), uncovered=_area(summary.uncovered_m2)
    )


def _overlap(summary: Summary) -> str:
    parts = []
    for text, least in (
        (tr("along {share}"), summary.least_overlap_along),
        (tr("across {share}"), summary.least_overlap_across),
    ):
        if least is not None:
            parts.append(text.format(share=f"{100.0 * least:.1f} %"))
    return tr("at least {shares}").format(shares=", ".join(parts))


def _tiles(summary: Summary) -> str:
    if not summary.download_bytes:
        return tr("{count}, computed here").format(count=f"{summary.unique_tiles:,}")
    return tr("{count}, about {size} to download").format(
        count=f"{summary.unique_tiles:,}", size=_size(summary.download_bytes)
    )


def _length(value_m: float) -> str:
    for unit, size in (("km", 1e3), ("m", 1.0), ("cm", 1e-2)):
        if value_m >= size:
            return f"{value_m / size:.3g} {unit}" if value_m < 1e6 else f"{value_m / size:,.0f} {unit}"
    return f"{value_m * 1e3:.3g} mm"


def _area(value_m2: float) -> str:
    return f"{value_m2 / 1e6:,.4g} km²" if value_m2 >= 1e5 else f"{value_m2:,.4g} m²"


def _size(count: float) -> str:
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{count:.0f} B"


def duration_text(seconds: float) -> str:
    """Return seconds, minutes or hours in words."""
    if seconds < 90.0:
        return tr("{count} s").format(count=max(round(seconds), 1))
    if seconds < 5400.0:
        return tr("{count} min").format(count=round(seconds / 60.0))
    return tr("{count} h").format(count=f"{seconds / 3600.0:.1f}")
