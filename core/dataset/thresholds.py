"""Where to part the entropies of a dataset, when nobody has looked at them yet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def otsu(values: NDArray[np.float64]) -> float | None:
    """Threshold that parts values in two groups with the least variance inside them, after Otsu (1979).

    Otsu's criterion is the largest variance between the groups; here it is taken at every gap between values and not
    at the bins of a histogram, so that it does not depend on their width.

    Parameters
    ----------
    values : array (n,)
        Finite.

    Returns
    -------
    float or None
        Middle of the gap; None where there are no two different values.

    References
    ----------
    N. Otsu, "A threshold selection method from gray-level histograms", IEEE Transactions on Systems, Man, and
    Cybernetics 9(1), 1979, 62-66.
    """
    ordered = np.sort(values)
    gaps = np.flatnonzero(np.diff(ordered) > 0.0)
    if len(gaps) == 0:
        return None
    below = gaps + 1.0
    above = len(ordered) - below
    sums = np.cumsum(ordered)
    means = sums[gaps] / below, (sums[-1] - sums[gaps]) / above
    best = gaps[np.argmax(below * above * (means[1] - means[0]) ** 2)]
    return float((ordered[best] + ordered[best + 1]) / 2.0)
