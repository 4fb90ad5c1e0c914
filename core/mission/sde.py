"""Linear stochastic differential equations, discretised exactly for any step.

dx = A x dt + dw, with ``w`` a Wiener process of covariance rate N. Over a step x(t + dt) = (I + E) x(t) + v, where
E = exp(A dt) - I and v is normal with covariance Q = ∫ exp(A s) N exp(A s)ᵀ ds from 0 to dt (Van Loan 1978,
"Computing integrals involving the matrix exponential", IEEE Trans. Automatic Control 23(3)). Van Loan's block
exponential taken in one go fails where dt is long beside the fastest time constant, and taking Q from the stationary P,
as P - exp(A dt) P exp(A dt)ᵀ, cancels where it is short. Here the series of both are summed at dt / 2^k, where they
converge at once, and doubled k times.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput

Floats = NDArray[np.float64]

#: Largest ‖A‖ dt that the series are summed at: every term is then at most half the one before it.
SERIES_NORM = 0.5
#: Terms of the series. The variance of a state that noise reaches through m integrations starts only at term 2m + 1
#: (m is 4 for the integral of a position), and 16 more bring it to rounding; that leaves room for m = 5.
SERIES_TERMS = 28
#: 2^64 steps of the series outlast the slowest time constant of any system that float64 can hold beside its fastest.
MOST_DOUBLINGS = 64
#: Largest entry of exp(A dt) from which on doubling no longer changes the covariance: it enters squared, and leaves
#: room for states whose sigmas are up to 1e6 apart.
FORGOTTEN = 1e-14
#: Largest entry of exp(A dt) that no stable system reaches on its way to rest.
RUNAWAY = 1e12
#: Rounding of a pivot of a correlation matrix, in units of the matrix's size: what lies below is noise of the
#: arithmetic, not noise of the process.
PIVOT_ROUNDING = 4.0 * float(np.finfo(np.float64).eps)


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """dx = A x dt + dw, stable (every eigenvalue of A left of the imaginary axis).

    Parameters
    ----------
    drift_per_s : array (d, d)
        A.
    noise_per_s : array (d, d)
        Covariance rate N of the driving Wiener process, in squared units of the states a second.
    """

    drift_per_s: Floats
    noise_per_s: Floats

    def discretise(self, step_s: Floats) -> tuple[Floats, Floats]:
        """Exact discretisation for each of many steps.

        Parameters
        ----------
        step_s : array (k,)
            0 or more.

        Returns
        -------
        tuple of array (k, d, d)
            E = exp(A dt) - I, whose small entries keep their digits where dt is short, and Q, symmetric.
        """
        step_s = np.asarray(step_s, np.float64)
        if not bool(np.all(np.isfinite(step_s) & (step_s >= 0.0))):
            raise InvalidInput(f"steps of {step_s.min()} to {step_s.max()} s: must be 0 or more, and finite")
        doublings = np.array([self._doublings(step) for step in step_s.tolist()], np.int64)
        change, covariance = self._series(np.ldexp(step_s, -doublings))
        for done in range(int(doublings.max(initial=0))):
            due = np.flatnonzero(doublings > done)
            change[due], covariance[due] = _doubled(change[due], covariance[due])
        return change, covariance

    def stationary_covariance(self) -> Floats:
        """Covariance (d, d) that the system tends to from anywhere: the solution of A P + P Aᵀ + N = 0.

        Raises
        ------
        InvalidInput
            When A is not stable, so that there is none.
        """
        fastest = float(np.abs(self.drift_per_s).sum(axis=1).max())
        change, covariance = self._series(np.array([SERIES_NORM / fastest]))
        unit = np.eye(len(self.drift_per_s))
        for _ in range(MOST_DOUBLINGS):
            remembered = float(np.abs(change + unit).max())
            if remembered < FORGOTTEN:
                settled: Floats = covariance[0]
                return settled
            if remembered > RUNAWAY:
                break
            change, covariance = _doubled(change, covariance)
        raise InvalidInput("system without a stationary covariance: it must be stable")

    def _doublings(self, step_s: float) -> int:
        norm_per_s = float(np.abs(self.drift_per_s).sum(axis=1).max())
        if step_s == 0.0 or norm_per_s == 0.0:
            return 0
        # Logarithms are added because the product may overflow.
        return max(0, math.ceil(math.log2(norm_per_s) + math.log2(step_s) - math.log2(SERIES_NORM)))

    def _series(self, step_s: Floats) -> tuple[Floats, Floats]:
        """E and Q of short steps from their Taylor series: dQ/dt = A Q + Q Aᵀ + N, term by term."""
        drift = self.drift_per_s * step_s[:, np.newaxis, np.newaxis]
        term_of_change = drift
        term_of_covariance = self.noise_per_s * step_s[:, np.newaxis, np.newaxis]
        change, covariance = term_of_change.copy(), term_of_covariance.copy()
        for order in range(2, SERIES_TERMS + 1):
            term_of_change = drift @ term_of_change / order
            half = drift @ term_of_covariance / order
            term_of_covariance = half + half.swapaxes(-1, -2)
            change += term_of_change
            covariance += term_of_covariance
        return change, covariance


def _doubled(change: Floats, covariance: Floats) -> tuple[Floats, Floats]:
    """E and Q of twice the step, without ever adding I to E: slow states would lose digits at every squaring."""
    carried = change @ covariance
    later = carried @ change.swapaxes(-1, -2)
    # carried @ changeᵀ is symmetric but for rounding, which would grow with the doublings.
    added = carried + carried.swapaxes(-1, -2) + 0.5 * (later + later.swapaxes(-1, -2))
    return 2.0 * change + change @ change, 2.0 * covariance + added


def factor(covariance: Floats) -> Floats:
    """Matrices L with L Lᵀ = Q, for positive semidefinite Q of any scale and rank.

    Cholesky's method on the correlation matrix (states whose variances are many orders apart weigh the same), large
    pivots first, and pivots that are nothing but rounding taken as zero. It is written out rather than left to
    LAPACK because that gives up on a semidefinite matrix, and because eigenvectors, the usual way out, come with
    signs that change from one machine to the next. For the same reason the pivot is not the largest one but the
    first of at least half its size: every first pivot is 1, and rounding must not choose among equals.

    Parameters
    ----------
    covariance : array (k, d, d)

    Returns
    -------
    array (k, d, d)
        Columns in the order of the pivots, and zeros from the rank on.
    """
    count, size, _ = covariance.shape
    every = np.arange(count)
    sigma = np.sqrt(np.maximum(np.diagonal(covariance, axis1=1, axis2=2), 0.0))
    scale = np.where(sigma > 0.0, sigma, 1.0)
    left = covariance / scale[:, :, np.newaxis] / scale[:, np.newaxis, :]
    columns = np.zeros_like(left)
    for step in range(size):
        pivots = np.diagonal(left, axis1=1, axis2=2)
        largest = pivots.max(axis=1)
        chosen = np.argmax(pivots >= 0.5 * largest[:, np.newaxis], axis=1)
        pivot = left[every, chosen, chosen]
        sound = pivot > size * PIVOT_ROUNDING
        if not bool(sound.any()):
            break
        root = np.sqrt(np.where(sound, pivot, 1.0))
        column = np.where(sound[:, np.newaxis], left[every, :, chosen] / root[:, np.newaxis], 0.0)
        columns[:, :, step] = column
        left = left - column[:, :, np.newaxis] * column[:, np.newaxis, :]
        # What is explained is exactly so: rounding must not bring it back as a pivot.
        left[every, chosen, :] = 0.0
        left[every, :, chosen] = 0.0
    factored: Floats = columns * scale[:, :, np.newaxis]
    return factored
