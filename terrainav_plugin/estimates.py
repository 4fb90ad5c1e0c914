"""The figures of a plan in the user's words."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from ..core.mission.estimate import area_text, length_text, size_text
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
        (tr("On disk"), size_text(summary.output_bytes)),
        (tr("Time"), tr("about {duration}").format(duration=duration_text(summary.seconds))),
        (tr("Flight"), length_text(summary.flight_distance_m)),
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
    return tr("camera {camera}, source {source}").format(
        camera=length_text(camera), source=length_text(source)
    )


def _coverage(summary: Summary) -> str:
    if summary.complete:
        return tr("100 % of {area}").format(area=area_text(summary.area_m2))
    # Rounded down: what is not complete never reads 100.
    share = int(summary.covered_share * 1e4) / 1e2
    return tr("{share:.2f} % of {area}; {uncovered} left out").format(
        share=share, area=area_text(summary.area_m2), uncovered=area_text(summary.uncovered_m2)
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
    """Tiles of all map types together."""
    count = f"{summary.unique_tiles * len(summary.map_types):,}"
    if not summary.download_bytes:
        return tr("{count}, computed here").format(count=count)
    size = size_text(summary.download_bytes)
    return tr("{count}, about {size} to download").format(count=count, size=size)


def duration_text(seconds: float) -> str:
    """Return seconds, minutes or hours in words."""
    if seconds < 90.0:
        return tr("{count} s").format(count=max(round(seconds), 1))
    if seconds < 5400.0:
        return tr("{count} min").format(count=round(seconds / 60.0))
    return tr("{count} h").format(count=f"{seconds / 3600.0:.1f}")
