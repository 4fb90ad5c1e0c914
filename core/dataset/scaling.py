"""Standard scaling of labels: to mean 0 and standard deviation 1, and back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput

Floats = NDArray[np.float64]

#: Labels that spread less than this, in their unit, are all the same: for metres, a thousandth of a millimetre is noise
#: of the projection, and to enlarge it to a standard deviation of 1 would teach noise.
CONSTANT = 1e-6


@dataclass(frozen=True)
class Scaler:
    """Means and standard deviations of labels, by column.

    `inverse` gives back what `transform` was given: to the last bit where a value is at least 8 times as far from 0 as
    from the mean (eastings and northings of a mission, as a rule), as the three roundings in between are then less than
    half of the value's last bit; elsewhere within 2⁻⁵¹ of the distance from the mean, 0.4 nm at 1000 km.

    Parameters
    ----------
    mean : tuple of float
    scale : tuple of float
        Standard deviations (of the population, as scikit-learn's ``StandardScaler`` has them), all above 0.
    """

    mean: tuple[float, ...]
    scale: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.mean) != len(self.scale):
            raise InvalidInput(
                f"scaler: has {len(self.mean)} means and {len(self.scale)} scales; need as many of each"
            )
        if not all(map(math.isfinite, self.mean)):
            raise InvalidInput(f"scaler: mean {list(self.mean)}; must be finite numbers")
        if not all(math.isfinite(one) and one > 0.0 for one in self.scale):
            raise InvalidInput(f"scaler: scale {list(self.scale)}; must be finite numbers above 0")

    @classmethod
    def fit(cls, values: Floats) -> Scaler:
        """Scaler of these values (n, k), n > 0.

        Sums are exact before they are rounded (`math.fsum`), so that every machine finds the same numbers. A column
        that is constant (see `CONSTANT`) has scale 1: it becomes 0, and comes back.

        Raises
        ------
        InvalidInput
            No values, or some that are not finite.
        """
        if not len(values) or not np.isfinite(values).all():
            raise InvalidInput(
                f"scaler: {len(values)} values to fit it to; needs one or more, all finite numbers"
            )
        fitted = [_fitted(column) for column in values.T.tolist()]
        return cls(tuple(mean for mean, _ in fitted), tuple(scale for _, scale in fitted))

    def transform(self, values: Floats) -> Floats:
        """Scaled values (..., k) of values (..., k)."""
        scaled: Floats = (np.asarray(values, np.float64) - np.array(self.mean)) / np.array(self.scale)
        return scaled

    def inverse(self, scaled: Floats) -> Floats:
        """Values (..., k) of scaled values (..., k)."""
        values: Floats = np.asarray(scaled, np.float64) * np.array(self.scale) + np.array(self.mean)
        return values


def _fitted(column: Sequence[float]) -> tuple[float, float]:
    """Mean and standard deviation of a column."""
    if max(column) - min(column) <= CONSTANT:
        return column[0], 1.0
    mean = math.fsum(column) / len(column)
    # Products are rounded alike everywhere; powers are as good as the machine's library of mathematics.
    squares = ((value - mean) * (value - mean) for value in column)
    return mean, math.sqrt(math.fsum(squares) / len(column))
