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
    SKY,
    VERMILION,
    dress,
    logarithmic,
    new_figure,
    png,
)
from ..mission.estimate import length_text
from ..mission.parts import RAYS
from ..timing import Seconds
from .conditioning import Conditioning
from .measure import Measured, Measurement, WholeImage
from .pictures import BANDS, Encoding, Resampling
from .pixels import LEVEL, NUMPY
from .tables import method_name

_GREY = "#777777"
#: Colours of up to seven lines, from coarse to fine methods.
_LINES = (ORANGE, SKY, GREEN, BLUE, VERMILION, PURPLE, BLACK)
_DASHES = ("-", "--", "-.")


class Look(NamedTuple):
    """Colour, marker and name of a line."""

    colour: str
    marker: str
    label: str


_STAGES = {
    "footprint": Look(BLUE, "o", "Footprint: where the corners are"),
    "image": Look(VERMILION, "s", "Image: map frame or camera frame"),
    "pixels": Look(GREEN, "^", "Pixels of a camera frame"),
}
_KERNELS = {
    "nearest": Look(ORANGE, "v", "nearest"),
    "bilinear": Look(BLUE, "o", "bilinear"),
    "bicubic": Look(GREEN, "s", "bicubic"),
    "lanczos": Look(PURPLE, "D", "Lanczos"),
}
_FORMATS = {"JPEG": (ORANGE, "v"), "PNG": (BLUE, "o"), "GeoT": (BLACK, "s")}


class Label(NamedTuple):
    """Label of a marker.

    Attributes
    ----------
    x, y : float
        Place of the marker.
    lines : tuple of tuple of float
        Ends (x, y) of the marker's whisker and level line, which no label crosses.
    """

    x: float
    y: float
    text: str
    colour: str
    lines: tuple[tuple[float, float], ...] = ()


class Mark(NamedTuple):
    """A marker of a diagram.

    Attributes
    ----------
    error_px, median_px, bound_px : float
        Greatest and median error, and the bound reached.
    chosen : bool
        Whether the plan uses it.
    line : str or None
        Name of the line that joins it with others; None if it is not joined.
    """

    error_px: float
    median_px: float | None
    bound_px: float
    seconds: Seconds
    label: str
    chosen: bool
    look: Look
    line: str | None = ""


def work_precision(found: Measurement, budget_px: float, title: str) -> bytes:
    """Draw work-precision diagrams: error against run time, a panel for each stage and one for whole images."""
    panels: list[tuple[str, list[Mark]]] = []
    for stage, methods in found.stages.items():
        look = _STAGES[stage]
        marks = [
            Mark(
                one.error_px,
                one.errors.median if one.errors else None,
                one.reached_px,
                one.seconds,
                _short_name(one),
                one.chosen,
                look,
                _line(one),
            )
            for one in methods
            if one.error_px is not None and one.seconds is not None
        ]
        panels.append((look.label, marks))
    whole = [
        Mark(
            one.error_px,
            None,
            one.reached_px,
            one.seconds,
            _pipeline_label(one),
            one.chosen,
            _format_look(one.encoding),
            _line(one.methods[-1]) if one.encoding.chosen else None,
        )
        for one in found.pipelines
    ]
    panels = [(name, marks) for name, marks in [*panels, ("Whole images, with their files", whole)] if marks]
    rows, columns = -(-len(panels) // 2), min(len(panels), 2)
    figure = new_figure(12.5, 1.2 + 4.4 * rows)
    # The last row is for the legend.
    grid = figure.add_gridspec(rows + 1, columns, height_ratios=[1.0] * rows + [0.12])
    figure.suptitle(textwrap.fill(title, 110), fontsize=FONT["title"], x=0.01, ha="left")
    labels = []
    for number, (name, marks) in enumerate(panels):
        axes = figure.add_subplot(grid[number // columns, number % columns])
        dress(axes, name, "error in the image, px", "processor seconds per capture")
        logarithmic(axes, "xy")
        labels.append((axes, _draw_marks(axes, marks, found.floor_px, budget_px)))
    _draw_legend(figure.add_subplot(grid[rows, :]), whole)
    _lay_out(figure)
    for axes, names in labels:
        _place_labels(axes, names)
    return png(figure)


def _line(one: Measured) -> str:
    """Name of the line that joins a method with others: rays without compiled code have their own."""
    return NUMPY if one.method.name.startswith(NUMPY) else ""


def _pipeline_label(one: WholeImage) -> str:
    """Short name of a pipeline's last method; empty for those that another panel or the legend names."""
    last = one.methods[-1]
    is_named = one.encoding.chosen and (one.chosen or last.method.name in ("map", RAYS, LEVEL, NUMPY))
    return _short_name(last) if is_named else ""


def _short_name(one: Measured) -> str:
    return method_name(one).removeprefix("mesh, ").removeprefix("relief, ")


def _format_look(one: Encoding) -> Look:
    colour, marker = next(look for name, look in _FORMATS.items() if one.name.startswith(name))
    return Look(colour, marker, one.name.split(", lossless")[0].replace(", quality", ""))


def _draw_marks(axes: Any, marks: Sequence[Mark], floor_px: float, budget_px: float) -> list[Label]:
    """Draw the markers of a panel, with whiskers and bounds; return their labels."""
    above = [max(one.error_px, floor_px) for one in marks if one.error_px > 0.0]
    left = min(above, default=floor_px)
    none_px = left / 8.0
    points = [(max(one.error_px, floor_px) if one.error_px else none_px, one) for one in marks]
    for name in dict.fromkeys(one.line for one in marks if one.line is not None):
        joined = [(x, one.seconds.median) for x, one in points if one.line == name]
        axes.plot([x for x, _ in joined], [y for _, y in joined], color="#bbbbbb", linewidth=1.2, zorder=1)
    labels = []
    for x, one in points:
        y, colour = one.seconds.median, one.look.colour
        measured, ends = one.error_px > floor_px, []
        axes.plot(
            [x],
            [y],
            color=colour,
            marker=one.look.marker,
            markersize=8,
            markerfacecolor=colour if measured else "white",
            zorder=3,
        )
        whisker(axes, x, one.seconds, colour)
        if measured:
            ends = [px for px in (one.median_px, one.bound_px) if px and math.isfinite(px)]
            axes.plot([x, *ends], [y] * (1 + len(ends)), color=colour, linewidth=1.0, alpha=0.8, zorder=2)
            if math.isfinite(one.bound_px) and one.bound_px > 0.0:
                axes.plot([one.bound_px], [y], color=colour, marker="|", markersize=11, zorder=2)
        if one.chosen:
            axes.plot([x], [y], "o", markersize=16, markerfacecolor="none", markeredgecolor=BLACK, zorder=4)
        word = "none added" if one.error_px == 0.0 else f"≤ {floor_px:.1g} px"
        text = one.label if measured or not one.label else f"{one.label}: {word}"
        labels.append(Label(x, y, text, colour, (*_whisker_ends(x, one.seconds), *((px, y) for px in ends))))
    bounds = [one.bound_px for one in marks if math.isfinite(one.bound_px)]
    right = max([left, *bounds, *(x for x, _ in points)])
    near = budget_px <= 1e3 * right
    if near:
        axes.axvline(budget_px, color=BLACK, linestyle="--", linewidth=1.2, zorder=1)
        right = max(right, budget_px)
    ends = [px for _, one in points for px in (one.median_px,) if px and one.error_px > floor_px]
    axes.set_xlim(min([*ends, *(x for x, _ in points)]) / 4.0, right * 8.0)
    times = [one.seconds.median for one in marks]
    middle = math.sqrt(min(times) * max(times))
    # At least a decade, so that equal times look equal.
    wide = max(math.sqrt(max(times) / min(times)) * 2.5, math.sqrt(10.0))
    axes.set_ylim(middle / wide, middle * wide)
    _tick(axes.xaxis, axes.get_xlim())
    _tick(axes.yaxis, axes.get_ylim())
    axes.annotate(
        f"budget {budget_px:g} px" + ("" if near else " →"),
        (budget_px, 1.0) if near else (1.0, 1.0),
        xycoords=("data" if near else "axes fraction", "axes fraction"),
        xytext=(-4, -2),
        textcoords="offset points",
        va="top",
        ha="right",
        fontsize=FONT["note"],
    ).set_in_layout(False)
    return labels


def _lay_out(figure: Any) -> None:
    """Lay out a figure once and for all, as labels are placed by where its axes are."""
    figure.draw_without_rendering()
    if hasattr(figure, "set_layout_engine"):
        figure.set_layout_engine("none")
    else:
        # matplotlib 3.5
        figure.set_constrained_layout(False)


def _tick(axis: Any, ends: tuple[float, float]) -> None:
    """Label more than powers of ten on a short logarithmic axis; leave out small ticks on a long one."""
    ticker = importlib.import_module("matplotlib.ticker")
    if ends[1] < 100.0 * ends[0]:
        axis.set_major_locator(ticker.LogLocator(subs=(1.0, 2.0, 5.0)))
    if ends[1] > 1e3 * ends[0]:
        axis.set_minor_locator(ticker.NullLocator())


def _place_labels(axes: Any, labels: Sequence[Label]) -> None:
    """Label markers of a figure that has been laid out; labels overlap neither markers nor one another."""
    figure = axes.figure
    renderer, room = figure.canvas.get_renderer(), axes.get_window_extent()
    # Boxes that are taken: left, bottom, right, top.
    point = figure.dpi / 72.0
    size = 7.0 * point
    places = [axes.transData.transform((one.x, one.y)) for one in labels]
    taken = [(x - size, y - size, x + size, y + size) for x, y in places]
    for one, (at_x, at_y) in zip(labels, places):
        for x, y in map(axes.transData.transform, one.lines):
            cap = 3.0 * point
            taken.append((min(x, at_x) - cap, min(y, at_y) - cap, max(x, at_x) + cap, max(y, at_y) + cap))
    # Paper behind labels, as lines between markers may cross them.
    paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    offsets = [(aside, sign * far) for far in (10, 24, 38, 52, 66) for sign in (1, -1) for aside in (0, far, -far)]
    for (x, y, text, colour, _), (at_x, at_y) in zip(labels, places):
        if not text:
            continue
        style = {"textcoords": "offset points", "color": colour, "zorder": 5}
        place = {"xytext": (0, 0), "ha": "left", "va": "bottom"}
        note = axes.annotate(text, (x, y), fontsize=FONT["note"], bbox=paper, **place, **style)
        note.set_in_layout(False)
        extent = note.get_window_extent(renderer)
        for aside, up in offsets:
            left = at_x + aside * point - (0.0 if aside > 0 else extent.width if aside < 0 else extent.width / 2.0)
            bottom = at_y + up * point - (extent.height if up < 0 else 0.0)
            box = (left, bottom, left + extent.width, bottom + extent.height)
            inside = room.x0 <= box[0] and box[2] <= room.x1 and room.y0 <= box[1] and box[3] <= room.y1
            if inside and not any(_overlap(box, other) for other in taken):
                # Two labels side by side need a gap.
                taken.append((box[0] - size / 2.0, box[1], box[2] + size / 2.0, box[3]))
                note.set_position(((left - at_x) / point, (bottom - at_y) / point))
                if abs(up) > offsets[0][1]:
                    leader = {"arrowstyle": "-", "color": colour, "linewidth": 0.6}
                    axes.annotate("", (x, y), xytext=(aside, up), arrowprops=leader, **style).set_in_layout(False)
                break
        else:
            note.remove()


def _overlap(one: Sequence[float], other: Sequence[float]) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def whisker(axes: Any, x: float, seconds: Seconds | None, colour: str) -> None:
    """Draw a vertical line from the lower to the upper quartile of a time."""
    ends = _whisker_ends(x, seconds)
    if ends:
        # Caps are smaller than markers, which hide them where quartiles are close.
        axes.plot(*zip(*ends), color=colour, marker="_", markersize=5, linewidth=1.1, zorder=2)


def _whisker_ends(x: float, seconds: Seconds | None) -> tuple[tuple[float, float], ...]:
    """Ends of a `whisker`, empty where too few rounds were timed."""
    if seconds is None or not seconds.spread_known:
        return ()
    ends = seconds.quartiles
    return (x, ends.low), (x, ends.high)


def _draw_legend(axes: Any, whole: Sequence[Mark]) -> None:
    lines, paths = (importlib.import_module(f"matplotlib.{name}") for name in ("lines", "path"))
    upright = paths.Path(((-1, -3), (1, -3), (0, -3), (0, 3), (-1, 3), (1, 3)), (1, 2, 1, 2, 1, 2))
    hollow = {"color": "none", "markerfacecolor": "none"}
    marks: list[tuple[str, dict[str, Any]]] = [
        ("level line: median error to bound reached", {"color": _GREY, "marker": "|", "markersize": 10}),
        (
            "upright line: quartiles of the time",
            {**hollow, "marker": upright, "markersize": 9, "markeredgecolor": _GREY},
        ),
        ("ring: used by the plan", {**hollow, "marker": "o", "markersize": 13, "markeredgecolor": BLACK}),
        ("hollow: at most the reference's error", {**hollow, "marker": "o", "markersize": 8, "markeredgecolor": _GREY}),
    ]
    for name, (colour, marker) in _FORMATS.items():
        if any(one.look.label.startswith(name) for one in whole):
            word = "GeoTIFF" if name == "GeoT" else name
            marks.append((f"file: {word}", {"color": "none", "marker": marker, "markerfacecolor": colour}))
    handles = [lines.Line2D([], [], label=label, **mark) for label, mark in marks]
    axes.set_axis_off()
    axes.legend(handles=handles, fontsize=FONT["note"], frameon=False, loc="center", ncol=4)


def distributions(found: Measurement) -> bytes:
    """Draw the share of points whose error is below a value, a panel for each stage."""
    panels = [
        (_STAGES[stage].label, [one for one in methods if one.errors and one.errors.most > found.floor_px])
        for stage, methods in found.stages.items()
    ]
    panels = [(name, methods) for name, methods in panels if methods]
    figure = new_figure(1.0 + 4.6 * max(len(panels), 1), 5.6)
    figure.suptitle("Errors of the measured points; dotted: bound reached", fontsize=FONT["title"], x=0.01, ha="left")
    for number, (name, methods) in enumerate(panels):
        axes = figure.add_subplot(1, len(panels), number + 1)
        dress(axes, name, "error in the image, px", "share of points below, %" if number == 0 else "")
        logarithmic(axes, "x")
        for index, one in enumerate(methods):
            quantiles = one.errors.quantiles if one.errors else ()
            points = [(max(px, found.floor_px), percent) for percent, px in enumerate(quantiles)]
            colour = _LINES[index % len(_LINES)]
            axes.plot(
                [px for px, _ in points],
                [percent for _, percent in points],
                color=colour,
                linestyle=_DASHES[index % len(_DASHES)],
                linewidth=2.6 if one.chosen else 1.5,
                label=method_name(one) + (" (used)" if one.chosen else ""),
            )
            if math.isfinite(one.reached_px) and one.reached_px > 0.0:
                axes.axvline(one.reached_px, color=colour, linestyle=":", linewidth=1.2)
        axes.set_ylim(0.0, 102.0)
        # The corners of cells have no error; the least third may lie decades below the rest.
        least = min(one.errors.quantiles[35] for one in methods if one.errors)
        most = max(*(one.errors.most for one in methods if one.errors), *_finite_bounds(methods))
        axes.set_xlim(max(least, found.floor_px) / 2.0, most * 2.0)
        _tick(axes.xaxis, axes.get_xlim())
        # Below the panel, as curves may lead anywhere.
        axes.legend(fontsize=FONT["note"], frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncol=2)
    return png(figure)


def _finite_bounds(methods: Sequence[Measured]) -> list[float]:
    return [0.0, *(one.reached_px for one in methods if math.isfinite(one.reached_px))]


def conditioning(found: Conditioning) -> bytes:
    """Draw the condition number over tilt and over height, with the mission's own curve and place."""
    figure = new_figure(12.5, 4.8)
    over_tilt, over_height = figure.subplots(1, 2, sharey=True)
    dress(over_tilt, "Condition number over tilt", "angle off nadir, °", "condition number")
    dress(over_height, "Condition number over height", "height above ground, m", "")
    logarithmic(over_tilt, "y")
    logarithmic(over_height, "xy")
    for axes, curves, at in (
        (over_tilt, found.over_tilt, found.tilt_deg),
        (over_height, found.over_height, found.height_m),
    ):
        for index, curve in enumerate(curves):
            own = index == 0
            colour = BLACK if own else (BLUE, ORANGE, GREEN)[(index - 1) % 3]
            axes.plot(
                curve.x,
                curve.condition,
                color=colour,
                linestyle="-" if own else _DASHES[index % len(_DASHES)],
                linewidth=2.4 if own else 1.6,
                label=(
                    f"tilt {curve.parameter:.3g}°" if axes is over_height else f"from {length_text(curve.parameter)}"
                )
                + (" (this mission)" if own else ""),
                zorder=3 - index,
            )
            known = [(x, y) for x, y in zip(curve.x.tolist(), curve.condition.tolist()) if math.isfinite(y)]
            if known and len(known) < len(curve.x):
                axes.plot(*known[-1], color=colour, marker="x", markersize=8, zorder=4)
        if axes is over_height:
            _tick(axes.xaxis, axes.get_xlim())
        axes.axvline(at, color=_GREY, linestyle=":", linewidth=1.4)
        axes.annotate(
            "this mission",
            (at, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(4, -2),
            textcoords="offset points",
            va="top",
            fontsize=FONT["note"],
            color=_GREY,
        )
        handles, labels = axes.get_legend_handles_labels()
        lines = importlib.import_module("matplotlib.lines")
        handles.append(lines.Line2D([], [], color=_GREY, marker="x", linestyle="none"))
        axes.legend(handles, [*labels, "beyond: horizon in the image"], fontsize=FONT["note"], frameon=False)
    return png(figure)


def resampling(measured: Measurement, found: Resampling) -> bytes:
    """Draw errors in grey levels: by spatial frequency over the picture's detail, and against run time."""
    figure = new_figure(13.5, 5.4)
    axes, work = figure.subplots(1, 2, gridspec_kw={"width_ratios": (1.35, 1.0)})
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
    axes.set_ylim(min(values, default=0.1) / 2.0, max([*found.signal, *values, 1.0]) * 3.0)
    axes.set_xlim(0.0, BANDS[-1])
    axes.legend(fontsize=FONT["note"], frameon=False, ncol=3, loc="upper center")
    labels = _draw_grey_levels(work, measured, found)
    _lay_out(figure)
    _place_labels(work, labels)
    return png(figure)


def _draw_grey_levels(axes: Any, measured: Measurement, found: Resampling) -> list[Label]:
    """Draw RMS errors in grey levels of kernels and of file formats against their times; return labels."""
    dress(axes, "Grey levels against time", "RMS error, grey levels of 255", "processor seconds per capture")
    logarithmic(axes, "y")
    seconds = {kernel.name: kernel.seconds for kernel in measured.kernels}
    points = [(one.rms, seconds[one.kernel], _KERNELS[one.kernel]) for one in found.kernels if one.kernel in seconds]
    axes.plot(
        [x for x, _, _ in points],
        [taken.median for _, taken, _ in points],
        color="#bbbbbb",
        linewidth=1.2,
        zorder=1,
        label="camera frame with a kernel",
    )
    files = [(one.rms, one.seconds, _format_look(one)) for one in measured.encodings]
    labels = []
    for x, taken, look in [*points, *files]:
        hollow = look.label not in {one.label for one in _KERNELS.values()}
        axes.plot(
            [x],
            [taken.median],
            color=look.colour,
            marker=look.marker,
            markersize=8,
            linestyle="none",
            markerfacecolor="white" if hollow else look.colour,
            zorder=3,
        )
        whisker(axes, x, taken, look.colour)
        labels.append(Label(x, taken.median, look.label, look.colour, _whisker_ends(x, taken)))
    times = [taken.median for _, taken, _ in [*points, *files]]
    axes.set_ylim(min(times) / 3.0, max(times) * 6.0)
    axes.set_xlim(-0.3, max(x for x, _, _ in [*points, *files]) * 1.25 + 0.2)
    axes.plot([], [], color=_GREY, marker="o", linestyle="none", markerfacecolor="white", label="encoding a file")
    axes.legend(fontsize=FONT["note"], frameon=False, loc="upper right")
    return labels
