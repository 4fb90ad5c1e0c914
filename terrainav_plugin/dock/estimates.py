"""The figures of a plan in the user's words."""

from __future__ import annotations

import html
import math
from typing import TYPE_CHECKING

from ...core.mission.estimate import area_text, length_text, size_text
from ...core.mission.rungs import bound_text
from ..i18n import tr

if TYPE_CHECKING:
    from ...core.mission.estimate import Summary
    from ...core.mission.rungs import Accuracy


def estimate_lines(summary: Summary, cost: str = "") -> list[tuple[str, str]]:
    """Label and value of every figure; ``cost`` is what the methods were timed at, empty while that is not known."""
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
        *_accuracy_lines(summary.accuracy),
        (tr("Cost"), cost or tr("being timed…")),
        *((tr("Warning"), text) for text in summary.warnings),
    ]
    return lines


def _accuracy_lines(accuracy: Accuracy) -> list[tuple[str, str]]:
    """What was chosen, in the words of the core's own line for it."""
    # A sign stays with its number, and a number with its unit.
    text = accuracy.text().replace("≤ ", "≤\N{NO-BREAK SPACE}").replace(" px", "\N{NO-BREAK SPACE}px")
    *stages, left_out, terrain = text.split("; ")
    return [
        (tr("Methods"), "; ".join(stages)),
        (
            tr("Error"),
            tr("≤ {bound} px of a budget of {budget:g} px").format(
                bound=bound_text(accuracy.bound_px), budget=accuracy.budget_px
            )
            + ("" if accuracy.bound_px <= accuracy.budget_px else tr(", which is exceeded")),
        ),
        (tr("Left out"), left_out.partition(": ")[2]),
        (tr("Terrain"), terrain.partition(": ")[2]),
    ]


def estimate_html(summary: Summary, cost: str = "") -> str:
    """All figures as a table for a label."""
    return _table(estimate_lines(summary, cost))


def details_html(accuracy: Accuracy) -> str:
    """Why the methods were chosen, as a table for a tooltip."""
    lines = []
    for choice in accuracy.choices:
        rung, rejected = choice.rung, choice.rejected
        text = tr("{name}, ≤ {px} px, {metres} on the ground").format(
            name=rung.name, px=bound_text(rung.bound_px), metres=_ground_text(rung.bound_m)
        )
        if rejected is not None:
            text += tr("; not {name}: {reason}").format(name=rejected.name, reason=choice.reason)
        lines.append((rung.stage.capitalize(), text))
    lines += [(tr("No {what}").format(what=what), why) for what, why in accuracy.left_out]
    lines.append((tr("Condition number"), dict(accuracy.lines())["condition number"]))
    return _table(lines)


def _ground_text(bound_m: float) -> str:
    return f"≤ {length_text(bound_m)}" if math.isfinite(bound_m) else tr("without limit at the horizon")


def _table(lines: list[tuple[str, str]]) -> str:
    rows = (
        f'<tr><td style="padding-right:10px"><b>{html.escape(label)}</b></td><td>{html.escape(value)}</td></tr>'
        for label, value in lines
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
