"""Diagrams of a measurement, as PNG; the only module of the report that needs matplotlib."""

from __future__ import annotations

import importlib
import math
import textwrap
from collections.abc import Sequence
from typing import Any, NamedTuple

from ..external.drawing import (
    BLACK,
    BLUE,
    FONT,
    GREEN,
    ORANGE,
    PURPLE,
    VERMILION,
    dress,
    logarithmic,
    new_figure,
    png,
)
from ..timing import Seconds
from .measure import Measured
from .pictures import BANDS, Resampling

_GREY = "#777777"
#: Least error drawn; smaller errors are drawn at the edge.
_LEAST_PX = 1e-11


class Look(NamedTuple):
    """Colour, marker and name of a line."""

    colour: str
    marker: str
    label: str


_STAGES = {
    "footprint": Look(BLUE, "o", "footprint: where the corners are"),
    "image": Look(VERMILION, "s", "image: map frame or camera frame"),
    "pixels": Look(GREEN, "^", "camera frame: mesh or rays"),
}
_KERNELS = {
    "nearest": Look(ORANGE, "v", "nearest"),
    "bilinear": Look(BLUE, "o", "bilinear"),
    "bicubic": Look(GREEN, "s", "bicubic"),
    "lanczos": Look(PURPLE, "D", "Lanczos"),
}


def work_precision(stages: dict[str, tuple[Measured, ...]], budget_px: float, floor_px: float, title: str) -> bytes:
    """Draw a work-precision diagram: error against run time, a line for each stage.

    Filled markers are measured, whiskers reach to the bounds, and rings mark the chosen methods.
    """
    figure = new_figure(10.0, 6.6)
    axes = figure.add_subplot()
    dress(axes, textwrap.fill(title, 85), "error in the image, px", "processor seconds a capture")
    logarithmic(axes, "xy")
    least = _left_edge(stages, floor_px)
    drawn: list[tuple[float, float]] = []
    lines: list[tuple[str, list[tuple[float, float, Measured]], bool]] = []
    for stage, methods in stages.items():
        look = _STAGES[stage]
        points = [
            (max(one.error_px, least), one.seconds.median, one)
            for one in methods
            if one.error_px is not None and one.seconds is not None
        ]
        if not points:
            continue
        axes.plot(
            [x for x, _, _ in points],
            [y for _, y, _ in points],
            color=look.colour,
            marker=look.marker,
            markersize=8,
            linewidth=1.8,
            label=look.label,
            zorder=3,
        )
        for x, y, one in points:
            whisker(axes, x, one.seconds, look.colour)
            if 0.0 < one.method.bound_px < math.inf:
                axes.plot([x, one.method.bound_px], [y, y], color=look.colour, linewidth=0.9, alpha=0.7, zorder=2)
                axes.plot([one.method.bound_px], [y], color=look.colour, marker="|", markersize=10, zorder=2)
            if one.chosen:
                axes.plot([x], [y], "o", markersize=17, markerfacecolor="none", markeredgecolor=BLACK, zorder=4)
        drawn += [(x, y) for x, y, _ in points]
        lines.append((look.colour, points, stage != "image"))
    axes.axvline(budget_px, color=BLACK, linestyle="--", linewidth=1.3, zorder=1)
    axes.annotate(
        f"budget {budget_px:g} px",
        (budget_px, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(4, -4),
        textcoords="offset points",
        va="top",
        fontsize=FONT["note"],
    )
    bounds = [one.method.bound_px for stage in stages.values() for one in stage if one.error_px is not None]
    right = max([budget_px, *(bound for bound in bounds if math.isfinite(bound)), *(x for x, _ in drawn)])
    axes.set_xlim(min([x for x, _ in drawn], default=least) / 6.0, right * 6.0)
    if drawn:
        axes.set_ylim(min(y for _, y in drawn) / 5.0, max(y for _, y in drawn) * 12.0)
    for colour, points, above in lines:
        _label_points(axes, colour, points, above=above)
    _draw_legend(axes)
    return png(figure)


def whisker(axes: Any, x: float, seconds: Seconds | None, colour: str) -> None:
    """Draw a vertical line from the lower to the upper quartile of a time."""
    if seconds is not None and seconds.spread_known:
        ends = seconds.quartiles
        # Caps are smaller than markers, which hide them where quartiles are close.
        axes.plot([x, x], [ends.low, ends.high], color=colour, marker="_", markersize=5, linewidth=1.1, zorder=2)


def _left_edge(stages: dict[str, tuple[Measured, ...]], floor_px: float) -> float:
    """Error at which methods without error are drawn: the least measured error, or the error of the reference."""
    errors = [one.error_px for stage in stages.values() for one in stage if one.error_px]
    return max(_LEAST_PX, floor_px, min(errors, default=_LEAST_PX))


def _label_points(axes: Any, colour: str, points: Sequence[tuple[float, float, Measured]], *, above: bool) -> None:
    """Label markers with the names of their methods; close markers share a label."""
    groups: list[tuple[float, float, list[str]]] = []
    # Points within 3 % of both axes share a label.
    wide, high = (0.03 * math.log10(ends[1] / ends[0]) for ends in (axes.get_xlim(), axes.get_ylim()))
    for x, y, one in points:
        name = one.method.name.removeprefix("mesh, ").removeprefix("relief, ")
        for at_x, at_y, names in groups:
            if abs(math.log10(x / at_x)) < wide and abs(math.log10(y / at_y)) < high:
                names.append(name)
                break
        else:
            groups.append((x, y, [name]))
    for x, y, names in groups:
        # Label beside the marker if another marker is right above, within four times the distance of shared labels.
        level = any(abs(math.log10(at / x)) < wide and 0.0 < math.log10(up / y) < 4.0 * high for at, up, _ in groups)
        axes.annotate(
            _joined(names),
            (x, y),
            xytext=((12, 4) if level else (2, 10)) if above else (0, -13),
            textcoords="offset points",
            ha="left" if above else "center",
            va="bottom" if above else "top",
            rotation=40 if above and not level else 0,
            rotation_mode="anchor",
            fontsize=FONT["note"],
            color=colour,
            zorder=5,
        )


def _joined(names: Sequence[str]) -> str:
    first, last = names[0], names[-1]
    if len(names) == 1:
        return first
    if first.endswith(" px") and last.endswith(" px"):
        first = first[:-3]
    return f"{first} {'and' if len(names) == 2 else 'to'} {last}"


def _draw_legend(axes: Any) -> None:
    lines, paths = (importlib.import_module(f"matplotlib.{name}") for name in ("lines", "path"))
    upright = paths.Path(((-1, -3), (1, -3), (0, -3), (0, 3), (-1, 3), (1, 3)), (1, 2, 1, 2, 1, 2))
    handles, _ = axes.get_legend_handles_labels()
    hollow = {"color": "none", "markerfacecolor": "none"}
    marks: tuple[dict[str, Any], ...] = (
        {"color": _GREY, "marker": "|", "markersize": 10, "linewidth": 0.9},
        {**hollow, "marker": upright, "markersize": 9, "markeredgecolor": _GREY},
        {**hollow, "marker": "o", "markersize": 13, "markeredgecolor": BLACK},
    )
    words = ("level whisker: up to its bound", "upright whisker: quartiles of the time", "ring: chosen")
    handles += [lines.Line2D([], [], label=label, **mark) for mark, label in zip(marks, words)]
    axes.legend(
        handles=handles,
        fontsize=FONT["note"],
        frameon=False,
        loc="upper center",
        ncol=3,
        bbox_to_anchor=(0.5, -0.11),
    )


def resampling(found: Resampling) -> bytes:
    """Draw errors in grey levels against spatial frequency, a line for each kernel, over the picture's detail."""
    figure = new_figure(10.0, 5.2)
    axes = figure.add_subplot()
    dress(
        axes,
        f"Resampling between the pixels of zoom {found.zoom}: error by detail",
        "spatial frequency, cycles a source pixel (0.5 is the finest pattern along one axis)",
        "RMS in the band, grey levels of 255",
    )
    logarithmic(axes, "y")
    middle = [(low + high) / 2.0 for low, high in zip(BANDS, BANDS[1:])]
    axes.fill_between(middle, found.signal, 1e-3, color="#e9e9e9", zorder=1, label="the image itself")
    for kernel in found.kernels:
        look = _KERNELS[kernel.kernel]
        axes.plot(
            middle,
            kernel.by_band,
            color=look.colour,
            marker=look.marker,
            linewidth=1.8,
            label=f"{look.label}: {kernel.rms:.2f} in all",
            zorder=3,
        )
    values = [value for one in found.kernels for value in one.by_band if value > 0.0]
    axes.set_ylim(min(values, default=0.1) / 2.0, max([*found.signal, *values, 1.0]) * 1.6)
    axes.set_xlim(0.0, BANDS[-1])
    axes.legend(fontsize=FONT["note"], frameon=False, ncol=3)
    return png(figure)
