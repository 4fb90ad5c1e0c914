"""Cells of an image that a lens bends, as quadrilaterals of the image of an ideal camera."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, Numbers
from .areas import perspectives

#: Points of the ideal image that image points show, px.
Lens = Callable[[Floats, Floats], "tuple[Floats, Floats]"]
#: Corners of a cell in the order upper left, lower left, lower right, upper right, as columns of its box.
CORNER_X, CORNER_Y = (0, 0, 2, 2), (1, 3, 3, 1)
#: Shares of a cell's sides at which its bend is measured, and their weights in means (Boole's rule).
_NODES, _WEIGHTS = np.linspace(0.0, 1.0, 5), np.array([7.0, 32.0, 12.0, 32.0, 7.0]) / 90.0


class Quadrilaterals(NamedTuple):
    """Cells of an image (k,) as quadrilaterals of the ideal image.

    The perspective through the corners of a bent cell would err to one side, as a chord does. The corners are those
    whose perspective has the least mean square error, and thereby no mean error.

    Attributes
    ----------
    x, y : array (k, 4)
        Corners, px.
    around : array (k, 4)
        Left, top, right and bottom of boxes that hold the cells.
    wide, high : array (k,)
        Longest sides along the image's x and y.
    off_x, off_y : array (k,)
        How far points of cells are off the perspective through the corners, for the bend along x and along y.
    scale : array (k,)
        Most pixels of the image for one of the ideal image.
    """

    x: Floats
    y: Floats
    around: Floats
    wide: Floats
    high: Floats
    off_x: Floats
    off_y: Floats
    scale: Floats

    @classmethod
    def of_boxes(cls, boxes: Numbers, ideal_px: Lens | None) -> Quadrilaterals:
        """Quadrilaterals of boxes (k, 4), seen through a lens that distorts, if any."""
        box = boxes.astype(np.float64)
        x, y = box[:, CORNER_X], box[:, CORNER_Y]
        wide, high = (box[:, 2:] - box[:, :2]).T
        if ideal_px is None:
            none = np.zeros(len(box))
            return cls(x, y, box, wide, high, none, none, none + 1.0)
        nodes = _ideal_nodes(ideal_px, box)
        x, y, off = _best_corners(nodes)
        around = np.concatenate([nodes.min(axis=(1, 2)) - off, nodes.max(axis=(1, 2)) + off], axis=1)
        across, down = (np.diff(nodes, axis=axis) * (len(_NODES) - 1) for axis in (2, 1))
        per_x, per_y = across[:, :-1] / wide.reshape(-1, 1, 1, 1), down[:, :, :-1] / high.reshape(-1, 1, 1, 1)
        square = (per_x**2 + per_y**2).sum(axis=-1)
        area = per_x[..., 0] * per_y[..., 1] - per_x[..., 1] * per_y[..., 0]
        least = np.sqrt(np.maximum((square - np.sqrt(np.maximum(square**2 - 4.0 * area**2, 0.0))) / 2.0, 1e-300))
        share = wide**2 / (wide**2 + high**2)
        wide, high = (np.hypot(*np.moveaxis(steps, -1, 0)).max(axis=(1, 2)) for steps in (across, down))
        off_x, off_y = off[:, 0] * share, off[:, 0] * (1.0 - share)
        return cls(x, y, around, wide, high, off_x, off_y, 1.0 / least.min(axis=(1, 2)))


def _best_corners(nodes: Floats) -> tuple[Floats, Floats, Floats]:
    """Corners x and y (k, 4) of the perspectives nearest to nodes (k, n, n, 2), and how far nodes are off (k, 1)."""
    corners = nodes[:, [0, -1, -1, 0], [0, 0, -1, -1]]
    off = _off_perspective(corners, nodes)
    # To first order, a perspective moves with its corners as bilinear interpolation between them does.
    right, low = np.meshgrid(_NODES, _NODES)
    shares = np.stack([(1 - right) * (1 - low), (1 - right) * low, right * low, right * (1 - low)], axis=-1)
    weighted = shares * np.multiply.outer(_WEIGHTS, _WEIGHTS)[..., np.newaxis]
    normal = np.tensordot(shares, weighted, ((0, 1), (0, 1)))
    moved = corners - np.linalg.solve(normal, np.tensordot(off, weighted, ((1, 2), (0, 1))).swapaxes(1, 2))
    left = _off_perspective(moved, nodes)
    # Large cells may bend too much for that; they are divided.
    nearer = ((left * left).sum(axis=(1, 2, 3)) < (off * off).sum(axis=(1, 2, 3)))[:, np.newaxis, np.newaxis]
    corners, off = np.where(nearer, moved, corners), np.where(nearer[..., np.newaxis], left, off)
    return corners[..., 0], corners[..., 1], np.hypot(off[..., 0], off[..., 1]).max(axis=(1, 2))[:, np.newaxis]


def _ideal_nodes(ideal_px: Lens, box: Floats) -> Floats:
    """Points of the ideal image at nodes of boxes (k,), by rows and columns; (k, nodes, nodes, 2)."""
    left, top, right, bottom = (side[:, np.newaxis] for side in box.T)
    x, y = left + (right - left) * _NODES, top + (bottom - top) * _NODES
    return np.stack(ideal_px(x[:, np.newaxis], y[:, :, np.newaxis]), axis=-1)


def _off_perspective(corners: Floats, nodes: Floats) -> Floats:
    """Offsets (k, n, n, 2) of perspectives through corners (k, 4, 2) from nodes (k, n, n, 2)."""
    side = np.ones(len(nodes), np.int64)
    a, b, c, d, e, f, g, h = perspectives(corners[..., 0], corners[..., 1], side, side).T[..., np.newaxis, np.newaxis]
    x, y = np.meshgrid(_NODES, _NODES)
    divisor = g * x + h * y + 1.0
    off: Floats = np.stack([(a * x + b * y + c) / divisor, (d * x + e * y + f) / divisor], axis=-1) - nodes
    return off
