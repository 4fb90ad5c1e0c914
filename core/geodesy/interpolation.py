"""Polynomials through Chebyshev nodes of an image's side, at the middles of its pixels."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Floats


class Interpolation(NamedTuple):
    """Polynomial along a side.

    Attributes
    ----------
    nodes : array (k,)
        Px from the side's begin.
    weights : array (n, k)
        Weights of the values at the nodes for the middle of each pixel.
    """

    nodes: Floats
    weights: Floats

    @classmethod
    def along(cls, length: int, count: int) -> Interpolation:
        """Interpolation along a side of ``length`` pixels through ``count`` nodes."""
        degrees = np.arange(float(count))
        nodes = np.cos((degrees + 0.5) * math.pi / count)
        middles = (2.0 * np.arange(length) + 1.0) / length - 1.0
        at_nodes, at_middles = (np.cos(np.outer(np.arccos(at), degrees)) for at in (nodes, middles))
        weights: Floats = np.matmul(at_middles, np.linalg.inv(at_nodes))
        return cls((nodes + 1.0) / 2.0 * length, weights)
