"""Measurements as tables with rounded numbers, and as CSV with all digits."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Union

from ..mission.estimate import area_text, duration_text, percent, size_text
from ..mission.plan import Plan
from ..storage.files import csv_bytes
from ..timing import Seconds
from .measure import Kernel, Measured, Measurement, Saving, WholeImage, baseline
from .pictures import BANDS, Encoding, Resampling
from .wind import WindEffect

#: Text of an empty cell.
NOTHING = "–"
#: No-break space, between a number and its unit.
_GLUE = "\u00a0"
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
STAGES = {"footprint": "footprint", "image": "image", "pixels": "camera frame's pixels"}
FRAME_NAMES = {"map": "map frame", "camera": "camera frame"}
Cell = Union[str, float, int, None]
#: Three empty cells.
_NO_FIGURES = (None, None, None)


class TextTable(NamedTuple):
    """Table of texts, with the indices of the rows of chosen methods."""

    header: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    chosen: frozenset[int] = frozenset()


def number_text(value: float) -> str:
    """Number with two digits, from 1e-4 to 100 without a power of ten."""
    if value == 0.0 or 1e-4 <= abs(value) < 100.0:
        return f"{value:.2g}"
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{mantissa.removesuffix('.0')}{_GLUE}×{_GLUE}10{str(int(exponent)).translate(_SUPERSCRIPTS)}"


def px_text(value: float | None) -> str:
    """Pixels with two digits."""
    if value is None:
        return NOTHING
    if value == 0.0:
        return "0"
    if not math.isfinite(value):
        return "no bound"
    return f"{number_text(value)}{_GLUE}px"


def metres_text(value_m: float) -> str:
    """Length on the ground with two digits, in a suitable unit."""
    if not math.isfinite(value_m):
        return "without limit"
    for unit, size in (("km", 1e3), ("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("µm", 1e-6)):
        if value_m >= size:
            return f"{value_m / size:.2g} {unit}" if value_m < 100.0 * size else f"{value_m / size:.0f} {unit}"
    return f"{value_m * 1e9:.2g} nm"


def seconds_text(seconds: float | Seconds | None) -> str:
    """Time with three digits in a suitable unit; for several rounds the median and the quartiles."""
    if seconds is None:
        return NOTHING
    if isinstance(seconds, Seconds):
        low, median, high = seconds.quartiles
        unit, size = _time_unit(max(abs(low), abs(median), abs(high)))
        spread = f" ({low / size:.3g} to {high / size:.3g})" if seconds.spread_known else ""
        return f"{median / size:.3g}{_GLUE}{unit}{spread}"
    unit, size = _time_unit(abs(seconds))
    return f"{seconds / size:.3g}{_GLUE}{unit}"


def _time_unit(seconds: float) -> tuple[str, float]:
    """Name and size in seconds of a suitable unit of time."""
    for unit, size, least in (
        ("h", 3600.0, 7200.0),
        ("min", 60.0, 120.0),
        ("s", 1.0, 1.0),
        ("ms", 1e-3, 1e-3),
    ):
        if seconds >= least:
            return unit, size
    if seconds >= 1e-6:
        return "µs", 1e-6
    return ("ns", 1e-9) if seconds >= 1e-9 else ("s", 1.0)


def bytes_text(count: int | None) -> str:
    """Size in a suitable unit, with its sign."""
    if count is None:
        return NOTHING
    return size_text(count) if count >= 0 else f"−{size_text(-count)}"


def method_name(one: Measured) -> str:
    """Readable name of a method."""
    return FRAME_NAMES.get(one.method.name, one.method.name)


def methods_table(measurement: Measurement) -> TextTable:
    """Table of every method of every stage."""
    rows: list[tuple[str, ...]] = []
    chosen: set[int] = set()
    for stage, methods in measurement.stages.items():
        other = baseline(methods)
        for one in methods:
            if one.chosen:
                chosen.add(len(rows))
            rows.append(
                (
                    STAGES[stage],
                    method_name(one),
                    "no bound" if one.method.outside else px_text(one.method.bound_px),
                    NOTHING if one.method.outside else px_text(one.reached_px),
                    _error_text(one, measurement.floor_px),
                    *_quantile_texts(one, measurement.floor_px),
                    seconds_text(one.seconds),
                    _remark(one, other),
                )
            )
    return TextTable(
        (
            "stage",
            "method",
            "bound",
            "bound reached",
            "greatest error",
            "95 % below",
            "half below",
            "time per capture",
            "time compared",
        ),
        rows,
        frozenset(chosen),
    )


def _remark(one: Measured, other: Measured | None) -> str:
    """Remark on a method: why it is not usable, that it is chosen, or its time compared with ``other``."""
    if one.method.outside:
        return f"not usable here: {one.method.outside}"
    compared = "chosen" if one.chosen else compared_text(one, other)
    same = f"same positions as for {', '.join(f'{px:g}' for px in one.same_px)} px" if one.same_px else ""
    return "; ".join(filter(None, (compared, same))) if compared != NOTHING else same or NOTHING


def compared_text(one: Measured, other: Measured | None) -> str:
    """Ratio to the time of another method, if the two are distinguishable."""
    if other is None or one is other or one.seconds is None or other.seconds is None:
        return ""
    if not one.seconds.spread_known:
        return NOTHING
    if not one.seconds.is_distinct(other.seconds):
        return f"not distinguishable from {method_name(other)} in time"
    low, median, high = one.seconds.ratio(other.seconds)
    return f"{median:.3g} times {method_name(other)} ({low:.3g} to {high:.3g})"


def _error_text(one: Measured, floor_px: float) -> str:
    if one.error_px is None:
        return NOTHING
    if one.error_px == 0.0:
        return "none"
    if one.error_px <= floor_px:
        return f"≤ {px_text(floor_px)}"
    return px_text(one.error_px) + ("" if one.keeps_bound else ", above its bound")


def _quantile_texts(one: Measured, floor_px: float) -> tuple[str, str]:
    """Error that 95 % and half of the points stay below."""
    if one.errors is None:
        return NOTHING, NOTHING
    usual, median = (f"≤ {px_text(floor_px)}" if px <= floor_px else px_text(px) for px in one.errors[1::-1])
    return ("none", "none") if one.errors.most == 0.0 else (usual, median)


def pipelines_table(measurement: Measurement) -> TextTable:
    """Table of ways to make an image file: sums of bounds and errors, and the whole time."""
    rows = []
    for one in measurement.pipelines:
        share = one.encoding.seconds.ratio(one.seconds).median
        rows.append(
            (
                pipeline_name(one),
                one.encoding.name,
                px_text(one.reached_px),
                px_text(one.error_px),
                f"{one.encoding.rms:.2f}" if one.encoding.rms else "0",
                seconds_text(one.seconds),
                f"{100.0 * share:.0f} %",
            )
        )
    chosen = frozenset(index for index, one in enumerate(measurement.pipelines) if one.chosen)
    header = (
        "methods",
        "file",
        "bounds reached, sum",
        "greatest errors, sum",
        "RMS of the file, grey levels",
        "time per capture",
        "of it encoding",
    )
    return TextTable(header, rows, chosen)


def pipeline_name(one: WholeImage) -> str:
    """Readable names of the methods that differ between pipelines."""
    return ", ".join(method_name(method) for method in one.methods[1:])


def choices_table(plan: Plan, measurement: Measurement) -> TextTable:
    """Choice of the plan at each stage, and why nothing cheaper was chosen."""
    rows = []
    measured = {one.method.stage: one for one in measurement.chosen}
    for choice in plan.accuracy.choices:
        method, one = choice.method, measured.get(choice.method.stage)
        if choice.rejected is None:
            why = "the cheapest method"
        else:
            why = f"{FRAME_NAMES.get(choice.rejected.name, choice.rejected.name)} was rejected: {choice.reason}"
        rows.append(
            (
                STAGES[method.stage],
                FRAME_NAMES.get(method.name, method.name),
                f"{px_text(method.bound_px)}, {metres_text(method.bound_m)} on the ground",
                NOTHING if one is None else px_text(one.reached_px),
                NOTHING if one is None else _error_text(one, measurement.floor_px),
                NOTHING if one is None else seconds_text(one.seconds),
                why,
            )
        )
    header = ("stage", "method", "bound", "bound reached", "greatest error", "time per capture", "why")
    return TextTable(header, rows)


def savings_table(savings: Sequence[Saving]) -> TextTable:
    """Stages that were left out."""
    return TextTable(
        ("left out", "because", "saves in time", "saves in files"),
        [
            (
                one.what,
                one.why,
                seconds_text(one.seconds) if one.differs else "too small to measure",
                bytes_text(one.size_bytes) if one.size_bytes else "nothing",
            )
            for one in savings
        ],
    )


def kernels_table(kernels: Sequence[Kernel], resampling: Resampling, used: str) -> TextTable:
    """Table of resampling kernels: errors and run time."""
    seconds = {kernel.name: kernel.seconds for kernel in kernels}
    rows = [("none (map frame)", "0, exactly the source's pixels", NOTHING, NOTHING, NOTHING, "")]
    found = {kernel.kernel: kernel for kernel in resampling.kernels}
    for name, took in seconds.items():
        one = found.get(name)
        errors = (
            [
                f"{one.rms:.2f}",
                *(f"{_rms_between(one.by_band, *ends):.2f}" for ends in ((0.0, 0.15), (0.15, 0.35), (0.35, 1.0))),
            ]
            if one
            else ["0 (the reference)", NOTHING, NOTHING, NOTHING]
        )
        rows.append((name, errors[0], errors[1], errors[2], errors[3], seconds_text(took)))
    chosen = frozenset(index for index, row in enumerate(rows) if row[0].split(" ")[0] == used)
    return TextTable(
        (
            "kernel",
            "RMS error, grey levels",
            "coarse detail (to 0.15 cycles/px)",
            "medium (0.15 to 0.35)",
            "fine (0.35 and more)",
            "time per camera frame",
        ),
        rows,
        chosen,
    )


def _rms_between(by_band: Sequence[float], low: float, high: float) -> float:
    inside = [value**2 for value, edge in zip(by_band, BANDS) if low <= edge < high]
    return math.sqrt(sum(inside))


def encodings_table(encodings: Sequence[Encoding]) -> TextTable:
    """Table of file formats: errors, size and run time."""
    rows = [
        (one.name, f"{one.rms:.2f}" if one.rms else "0", size_text(one.size_bytes), seconds_text(one.seconds))
        for one in encodings
    ]
    chosen = frozenset(index for index, one in enumerate(encodings) if one.chosen)
    return TextTable(("file", "RMS error, grey levels", "size of an image", "time to encode"), rows, chosen)


def displacement_table(effect: WindEffect) -> TextTable:
    """Table of how far wind moves and turns the camera."""
    spread = ("rms", "95 % within", "at most")
    rows = [
        (
            one.what,
            *(displaced_text(size, one.unit) for size in one.size or (None, None, None)),
            *(displaced_text(px, "px") for px in one.px or (None, None, None)),
        )
        for one in effect.displacements
    ]
    return TextTable(("", *spread, *(f"{name}, in the image" for name in spread)), rows)


def displaced_text(size: float | None, unit: str) -> str:
    """Metres, degrees or pixels with two digits; infinite pixels are behind the camera."""
    if size is None:
        return NOTHING
    if unit == "m":
        return metres_text(size)
    if not math.isfinite(size):
        return "out of the image"
    digits = f"{size:.0f}" if size >= 100.0 else number_text(size)
    return f"{digits}°" if unit == "deg" else f"{digits}{_GLUE}px"


def share_text(share: float) -> str:
    """Share in per cent, with its sign."""
    return f"{100.0 * share:.2f} %".replace("-", "−")


_LABELS = {"uncovered_m2": "uncovered ground", "flight_s": "flight time"}


def air_table(effect: WindEffect) -> TextTable:
    """Table of the mission's figures in still air and in wind."""
    texts: dict[str, Callable[[Any], str]] = {
        "images": lambda count: f"{count:,}",
        "coverage": lambda share: percent(share, exact=share == 1.0),
        "uncovered_m2": area_text,
        "flight_s": duration_text,
    }
    rows = []
    for name, values in effect.figures.items():
        text = texts.get(name, share_text)
        label = _LABELS.get(name) or name.replace("_", " ")
        rows.append((label, *(text(value) for value in values)))
    return TextTable(("", "in still air", "in this wind"), rows)


def csv_files(measurement: Measurement) -> dict[str, bytes]:
    """CSV files of a measurement by name."""
    files = {
        "methods.csv": _csv(
            (
                "stage method bound_px reached_px bound_m error_px usual_px median_px same_px "
                f"{_timed('seconds_per_capture')} rounds "
                "compared_with ratio ratio_low ratio_high told_apart picture_bytes chosen outside"
            ).split(),
            [
                (
                    one.method.stage,
                    one.method.name,
                    _finite(one.method.bound_px),
                    _finite(one.reached_px),
                    _finite(one.method.bound_m),
                    one.error_px,
                    *(one.errors[1::-1] if one.errors else (None, None)),
                    " ".join(f"{px:g}" for px in one.same_px),
                    *_quartiles(one.seconds),
                    len(one.seconds.rounds) if one.seconds else None,
                    *_compared(one, baseline(stage)),
                    one.size_bytes,
                    int(one.chosen),
                    one.method.outside,
                )
                for stage in measurement.stages.values()
                for one in stage
            ],
        ),
        "errors.csv": _csv(
            ("stage", "method", "percent_below", "error_px"),
            [
                (one.method.stage, one.method.name, percent, px)
                for stage in measurement.stages.values()
                for one in stage
                if one.errors
                for percent, px in enumerate(one.errors.quantiles)
            ],
        ),
        "pipelines.csv": _csv(
            f"methods file reached_px error_px rms_grey_levels {_timed('seconds_per_capture')} chosen".split(),
            [
                (
                    pipeline_name(one),
                    one.encoding.name,
                    _finite(one.reached_px),
                    one.error_px,
                    one.encoding.rms,
                    *_quartiles(one.seconds),
                    int(one.chosen),
                )
                for one in measurement.pipelines
            ],
        ),
        "left_out.csv": _csv(
            f"what why {_timed('seconds')} told_apart bytes".split(),
            [
                (one.what, one.why, *_quartiles(one.seconds), int(one.differs), one.size_bytes)
                for one in measurement.left_out
            ],
        ),
        "files.csv": _csv(
            f"file rms_grey_levels bytes {_timed('seconds')} chosen".split(),
            [
                (one.name, one.rms, one.size_bytes, *_quartiles(one.seconds), int(one.chosen))
                for one in measurement.encodings
            ],
        ),
    }
    if measurement.resampling is not None:
        files["resampling.csv"] = _resampling_csv(measurement.resampling, measurement.kernels)
    if measurement.wind is not None:
        files["wind-coverage.csv"] = _csv(
            ("figure", "still_air", "wind"),
            [(name, *values) for name, values in measurement.wind.figures.items()],
        )
        if measurement.wind.displacements:
            files["wind-displacement.csv"] = _csv(
                "what unit rms within_95_percent at_most rms_px within_95_percent_px at_most_px".split(),
                [
                    (one.what, one.unit, *(one.size or _NO_FIGURES), *(one.px or _NO_FIGURES))
                    for one in measurement.wind.displacements
                ],
            )
    return files


def _timed(name: str) -> str:
    """Column names of a median and its quartiles."""
    return f"{name} {name}_low {name}_high"


def _quartiles(seconds: Seconds | None) -> tuple[Cell, Cell, Cell]:
    if seconds is None:
        return _NO_FIGURES
    low, median, high = seconds.quartiles
    return median, low, high


def _compared(one: Measured, other: Measured | None) -> tuple[Cell, ...]:
    """Name of another method, median and quartiles of the ratio of times, and whether they differ significantly."""
    if other is None or one is other or one.seconds is None or other.seconds is None:
        return (None, *_NO_FIGURES, None)
    low, median, high = one.seconds.ratio(other.seconds)
    return other.method.name, median, low, high, int(one.seconds.is_distinct(other.seconds))


def _resampling_csv(resampling: Resampling, kernels: Sequence[Kernel]) -> bytes:
    seconds = {kernel.name: kernel.seconds for kernel in kernels}
    rows: list[tuple[Cell, ...]] = []
    for name, rms, by_band in [
        ("signal", None, resampling.signal),
        *((kernel.kernel, kernel.rms, kernel.by_band) for kernel in resampling.kernels),
    ]:
        for low, high, value in zip(BANDS, BANDS[1:], by_band):
            rows.append((name, low, high, value, rms, *_quartiles(seconds.get(name))))
    header = "kernel from_cycles_per_px to_cycles_per_px rms_grey_levels rms_of_all_bands"
    return _csv(f"{header} {_timed('seconds_per_picture')}".split(), rows)


def _csv(header: Sequence[str], rows: Sequence[Sequence[Cell]]) -> bytes:
    return csv_bytes([header, *rows])


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
