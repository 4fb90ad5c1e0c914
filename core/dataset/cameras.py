"""What the pixels of a dataset's images mean, by the columns of their table."""

from __future__ import annotations

import math

from ..errors import InvalidInput
from ..geodesy.contract import CameraContract, stated_distortion
from ..geodesy.lens import COEFFICIENTS, PERSPECTIVE
from ..numbers import real_number
from .table import Table

#: Columns of the size, the focal lengths and the principal point, by their names in a contract.
INTRINSICS = {
    **{name: f"image_{name}" for name in ("width_px", "height_px")},
    **{name: name for name in ("fx_px", "fy_px", "cx_px", "cy_px")},
}
#: Column of the kind of lens, beside columns of its coefficients; tables have them only if a lens distorts.
LENS = "lens"


def image_contract(table: Table, row: int) -> CameraContract:
    """What the pixels of a row's image mean.

    Raises
    ------
    InvalidInput
        The table does not state it, such as tables of published datasets.
    """
    name = table.img_names[row]
    numbers = {one: float(getattr(table, column)[row]) for one, column in INTRINSICS.items()}
    missing = [INTRINSICS[one] for one, value in numbers.items() if not math.isfinite(value)]
    if missing:
        raise InvalidInput("image {0}: the table does not state its {1}", name, ", ".join(missing))
    lens = table.other[LENS][row] if LENS in table.other else PERSPECTIVE
    if lens not in COEFFICIENTS:
        raise InvalidInput("image {0}: has lens {1!r}, and must have one of {2}", name, lens, ", ".join(COEFFICIENTS))
    distortion = stated_distortion(lens, _coefficients(table, row, lens) if LENS in table.other else {})
    width, height, fx, fy, cx, cy = numbers.values()
    return CameraContract(int(width), int(height), fx, fy, cx, cy, lens, distortion)


def _coefficients(table: Table, row: int, lens: str) -> dict[str, float]:
    """Coefficients of a row's lens; 0 without a column."""
    found = {}
    for name in COEFFICIENTS[lens]:
        cell = table.other[name][row] if name in table.other else "0"
        try:
            found[name] = real_number(cell)
        except ValueError as wrong:
            raise InvalidInput("image {0}: has {1} {2!r}, not a number", table.img_names[row], name, cell) from wrong
    return found
