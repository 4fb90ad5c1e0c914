"""Triangles drawn one by one, compiled: the same pixels as numpy's in `faces`. Needs numba; see `compiling`."""

from __future__ import annotations

from ...arrays import Floats, Numbers
from ...external.compiling import compiled


@compiled
def draw(forms: Floats, boxes: Numbers, nearness: Floats, triangle: Numbers) -> None:
    """Draw triangles into an image (height, width) of the nearness 1/t of its hits, and of the triangles' numbers.

    Parameters
    ----------
    forms : array (n, 4, 3)
        Three edge functions and the nearness of each triangle: constants, and changes per column and per row.
    boxes : array (n, 4)
        First column, first row, and the ones after the last.
    """
    for one in range(len(boxes)):
        left, top, right, bottom = boxes[one]
        f = forms[one]
        for row in range(top, bottom):
            y = row + 0.5
            a, b = f[0, 0] + y * f[0, 2], f[1, 0] + y * f[1, 2]
            c, near = f[2, 0] + y * f[2, 2], f[3, 0] + y * f[3, 2]
            for column in range(left, right):
                x = column + 0.5
                if a + x * f[0, 1] >= 0.0 and b + x * f[1, 1] >= 0.0 and c + x * f[2, 1] >= 0.0:
                    value = near + x * f[3, 1]
                    if value > nearness[row, column]:
                        nearness[row, column], triangle[row, column] = value, one
