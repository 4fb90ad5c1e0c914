"""The numbers behind every table and diagram as CSV, with every digit, for programs."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import Union

from ..timing import Seconds
from .greys import BANDS, Resampling
from .measure import Kernel, Measured, Measurement, compared_with

Cell = Union[str, float, int, None]
#: Cells of what was not measured: three figures.
NOTHING = (None, None, None)


def csv_files(measurement: Measurement) -> dict[str, bytes]:
    """Return the numbers by the file's name."""
    files = {
        "methods.csv": _csv(
            (
                f"stage method bound_px bound_m error_px {_timed('seconds_per_capture')} rounds "
                "compared_with ratio ratio_low ratio_high told_apart picture_bytes chosen outside"
            ).split(),
            [
                (
                    one.method.stage,
                    one.method.name,
                    _finite(one.method.bound_px),
                    _finite(one.method.bound_m),
                    one.error_px,
                    *_quartiles(one.seconds),
                    len(one.seconds.rounds) if one.seconds else None,
                    *_compared(one, compared_with(stage)),
                    one.size_bytes,
                    int(one.chosen),
                    one.method.outside,
                )
                for stage in measurement.stages.values()
                for one in stage
            ],
        ),
        "left_out.csv": _csv(
            f"what why {_timed('seconds')} told_apart bytes".split(),
            [
                (one.what, one.why, *_quartiles(one.seconds), int(one.told), one.size_bytes)
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
                    (one.what, one.unit, *(one.size or NOTHING), *(one.px or NOTHING))
                    for one in measurement.wind.displacements
                ],
            )
    return files


def _timed(name: str) -> str:
    """Names of the columns of a median and its quartiles."""
    return f"{name} {name}_low {name}_high"


def _quartiles(seconds: Seconds | None) -> tuple[Cell, Cell, Cell]:
    if seconds is None:
        return NOTHING
    low, median, high = seconds.quartiles
    return median, low, high


def _compared(one: Measured, other: Measured | None) -> tuple[Cell, ...]:
    """Name of another method, median and quartiles of the ratio of times, and whether they can be told apart."""
    if other is None or one is other or one.seconds is None or other.seconds is None:
        return (None, *NOTHING, None)
    low, median, high = one.seconds.ratio(other.seconds)
    return other.method.name, median, low, high, int(one.seconds.told_from(other.seconds))


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
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(["" if cell is None else cell for cell in row] for row in rows)
    return text.getvalue().encode("utf-8")


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
