"""What was measured as tables: for people in words and rounded numbers, for programs as CSV with every digit."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import NamedTuple, Union

from ..mission.estimate import size_text
from ..mission.plan import Plan
from .flight import Flight
from .greys import BANDS, Encoding, Resampling
from .measure import Kernel, Measured, Measurement, Saving

Cell = Union[str, float, int, None]
#: What stands where there is nothing.
NOTHING = "–"
#: Space that no line is broken at: a number stays with its unit.
_GLUE = "\u00a0"
#: Sizes between which numbers are written without a power of ten.
_PLAIN_FROM, _PLAIN_TO = 1e-4, 100.0
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
STAGES = {"footprint": "footprint", "picture": "picture", "mesh": "camera-frame mesh"}
FRAME_NAMES = {"map": "map frame", "camera": "camera frame"}


class Table(NamedTuple):
    """A table for people: names of the columns, rows of text, and the rows of what was chosen."""

    header: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    chosen: frozenset[int] = frozenset()


def number_text(value: float) -> str:
    """Two digits, and powers of ten as people write them."""
    if value == 0.0 or _PLAIN_FROM <= abs(value) < _PLAIN_TO:
        return f"{value:.2g}"
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{mantissa.removesuffix('.0')}{_GLUE}×{_GLUE}10{str(int(exponent)).translate(_SUPERSCRIPTS)}"


def px_text(value: float | None) -> str:
    """Pixels in two digits."""
    if value is None:
        return NOTHING
    if value == 0.0:
        return "0"
    if not math.isfinite(value):
        return "no bound"
    return f"{number_text(value)}{_GLUE}px"


def metres_text(value_m: float) -> str:
    """Metres of ground in two digits, in the unit that suits them."""
    if not math.isfinite(value_m):
        return "without limit"
    for unit, size in (("km", 1e3), ("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("µm", 1e-6)):
        if value_m >= size:
            return (
                f"{value_m / size:.2g} {unit}" if value_m < 100.0 * size else f"{value_m / size:.0f} {unit}"
            )
    return f"{value_m * 1e9:.2g} nm"


def seconds_text(seconds: float | None) -> str:
    """Seconds in two or three digits, in the unit that suits them."""
    if seconds is None:
        return NOTHING
    size = abs(seconds)
    for unit, least in (("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)):
        if least <= size < 1e3 * least:
            return f"{seconds / least:.3g}{_GLUE}{unit}"
    if size < 1e-9:
        return "0 s"
    if size < 120.0:
        return f"{seconds:.3g}{_GLUE}s"
    return f"{seconds / 60.0:.3g}{_GLUE}min" if size < 7200.0 else f"{seconds / 3600.0:.3g}{_GLUE}h"


def bytes_text(count: int | None) -> str:
    """Bytes in the unit that suits them, with their sign."""
    if count is None:
        return NOTHING
    return size_text(count) if count >= 0 else f"−{size_text(-count)}"


def name_of(one: Measured) -> str:
    """Name of a method in words."""
    return FRAME_NAMES.get(one.rung.name, one.rung.name)


def methods_table(measurement: Measurement) -> Table:
    """Every method of every stage."""
    rows: list[tuple[str, ...]] = []
    chosen: set[int] = set()
    for stage, methods in measurement.stages.items():
        for one in methods:
            if one.chosen:
                chosen.add(len(rows))
            where = one.rung.outside and f"not usable here: {one.rung.outside}"
            rows.append(
                (
                    STAGES[stage],
                    name_of(one),
                    "no bound" if one.rung.outside else px_text(one.rung.bound_px),
                    _error_text(one, measurement.floor_px),
                    seconds_text(one.seconds),
                    where or ("chosen" if one.chosen else ""),
                )
            )
    return Table(
        ("stage", "method", "bound", "measured error", "time a capture", ""), rows, frozenset(chosen)
    )


def _error_text(one: Measured, floor_px: float) -> str:
    if one.error_px is None:
        return NOTHING
    if one.error_px == 0.0:
        return "none of its own"
    if one.error_px <= floor_px:
        return f"below {px_text(floor_px)}"
    return px_text(one.error_px) + ("" if one.within else ", above its bound")


def choices_table(plan: Plan, measurement: Measurement) -> Table:
    """What the plan chose at each stage, and why not something cheaper."""
    rows = []
    measured = {one.rung.stage: one for one in measurement.chosen}
    for choice in plan.accuracy.choices:
        rung, one = choice.rung, measured.get(choice.rung.stage)
        if choice.rejected is None:
            why = "the cheapest there is"
        else:
            why = (
                f"{FRAME_NAMES.get(choice.rejected.name, choice.rejected.name)} was rejected: {choice.reason}"
            )
        rows.append(
            (
                STAGES[rung.stage],
                FRAME_NAMES.get(rung.name, rung.name),
                f"{px_text(rung.bound_px)}, {metres_text(rung.bound_m)} on the ground",
                NOTHING if one is None else _error_text(one, measurement.floor_px),
                NOTHING if one is None else seconds_text(one.seconds),
                why,
            )
        )
    return Table(("stage", "method", "bound", "measured error", "time a capture", "why"), rows)


def savings_table(savings: Sequence[Saving]) -> Table:
    """What was left out."""
    return Table(
        ("left out", "because", "saves in time", "saves in files"),
        [
            (
                one.what,
                one.why,
                seconds_text(one.seconds),
                bytes_text(one.size_bytes) if one.size_bytes else "nothing",
            )
            for one in savings
        ],
    )


def kernels_table(kernels: Sequence[Kernel], resampling: Resampling, used: str) -> Table:
    """Resampling kernels: grey levels against seconds."""
    seconds = {kernel.name: kernel.seconds for kernel in kernels}
    rows = [("none (map frame)", "0, exactly the source's pixels", NOTHING, NOTHING, NOTHING, "")]
    found = {kernel.kernel: kernel for kernel in resampling.kernels}
    for name, took in seconds.items():
        one = found.get(name)
        errors = (
            [f"{one.rms:.2f}", *(f"{_rms_between(one.by_band, *ends):.2f}" for ends in _THIRDS)]
            if one
            else ["0 (the reference)", NOTHING, NOTHING, NOTHING]
        )
        rows.append((name, errors[0], errors[1], errors[2], errors[3], seconds_text(took)))
    chosen = frozenset(index for index, row in enumerate(rows) if row[0].split(" ")[0] == used)
    return Table(
        (
            "kernel",
            "RMS error, grey levels",
            "coarse detail (to 0.15 cycles/px)",
            "medium (0.15 to 0.35)",
            "fine (0.35 and more)",
            "time a camera frame",
        ),
        rows,
        chosen,
    )


_THIRDS = ((0.0, 0.15), (0.15, 0.35), (0.35, 1.0))


def _rms_between(by_band: Sequence[float], low: float, high: float) -> float:
    inside = [value**2 for value, edge in zip(by_band, BANDS) if low <= edge < high]
    return math.sqrt(sum(inside))


def encodings_table(encodings: Sequence[Encoding]) -> Table:
    """File formats: grey levels against bytes."""
    rows = [
        (one.name, f"{one.rms:.2f}" if one.rms else "0", size_text(one.size_bytes), seconds_text(one.seconds))
        for one in encodings
    ]
    chosen = frozenset(index for index, one in enumerate(encodings) if one.chosen)
    return Table(("file", "RMS error, grey levels", "size of a picture", "time to encode"), rows, chosen)


def flight_table(flight: Flight) -> Table:
    """Integrators of flight in wind: what each needs for one per cent, and where it is stable."""
    rows = []
    for method, limit_s in flight.limits_s.items():
        own = [one for one in flight.integrated if one.method == method]
        fitting = [one for one in own if one.error is not None and one.error <= _PER_CENT]
        best = min(fitting, key=lambda one: one.seconds) if fitting else None
        rows.append(
            (
                method,
                "any step" if math.isinf(limit_s) else f"up to {seconds_text(limit_s)}",
                NOTHING if best is None else seconds_text(best.step_s),
                "not reached" if best is None else seconds_text(best.seconds),
                NOTHING if best is None or best.error is None else number_text(best.error),
            )
        )
    header = (
        "method",
        "stable for steps of",
        "longest step for 1 %",
        "time an exposure then",
        "relative error then",
    )
    return Table(header, rows, frozenset({0}))


_PER_CENT = 0.01


def csv_files(measurement: Measurement) -> dict[str, bytes]:
    """Return the numbers behind every table and plot, by the file's name."""
    files = {
        "methods.csv": _csv(
            "stage method bound_px bound_m error_px seconds_per_capture picture_bytes chosen outside".split(),
            [
                (
                    one.rung.stage,
                    one.rung.name,
                    _finite(one.rung.bound_px),
                    _finite(one.rung.bound_m),
                    one.error_px,
                    one.seconds,
                    one.size_bytes,
                    int(one.chosen),
                    one.rung.outside,
                )
                for stage in measurement.stages.values()
                for one in stage
            ],
        ),
        "left_out.csv": _csv(
            "what why seconds bytes".split(),
            [(one.what, one.why, one.seconds, one.size_bytes) for one in measurement.left_out],
        ),
        "files.csv": _csv(
            "file rms_grey_levels bytes seconds chosen".split(),
            [
                (one.name, one.rms, one.size_bytes, one.seconds, int(one.chosen))
                for one in measurement.encodings
            ],
        ),
    }
    if measurement.resampling is not None:
        files["resampling.csv"] = _resampling_csv(measurement.resampling, measurement.kernels)
    if measurement.flight is not None:
        files["wind.csv"] = flight_csv(measurement.flight)
    return files


def _resampling_csv(resampling: Resampling, kernels: Sequence[Kernel]) -> bytes:
    seconds = {kernel.name: kernel.seconds for kernel in kernels}
    rows: list[tuple[Cell, ...]] = []
    for name, rms, by_band in [
        ("signal", None, resampling.signal),
        *((kernel.kernel, kernel.rms, kernel.by_band) for kernel in resampling.kernels),
    ]:
        for low, high, value in zip(BANDS, BANDS[1:], by_band):
            rows.append((name, low, high, value, rms, seconds.get(name)))
    header = "kernel from_cycles_per_px to_cycles_per_px rms_grey_levels rms_of_all_bands seconds_per_picture"
    return _csv(header.split(), rows)


def flight_csv(flight: Flight) -> bytes:
    """Points of both plots of the integrators."""
    rows: list[tuple[Cell, ...]] = [
        ("covariance at the next exposure", one.method, one.step_s, one.error, one.seconds)
        for one in flight.integrated
    ]
    rows += [("covariance settled at", one.method, one.step_s, one.error, None) for one in flight.settled]
    return _csv("what method step_s relative_error seconds_per_exposure".split(), rows)


def _csv(header: Sequence[str], rows: Sequence[Sequence[Cell]]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(["" if cell is None else cell for cell in row] for row in rows)
    return text.getvalue().encode("utf-8")


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
