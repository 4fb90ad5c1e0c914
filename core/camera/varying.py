"""Random values of images: distributions as text, and draws by seed, field and image.

A draw is the quantile of a distribution at a share that a hash makes of seed, field and image. So it depends on no
other image or field, on no order and on no number of workers. Values are rounded to the six significant digits with
which files state them, as processors differ in digits far beyond.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

from ..errors import InvalidInput, Message
from ..numbers import real_number

#: A field, a distribution with its parameters, and bounds.
_TEXT = re.compile(r"\s*(\w+)\s*=\s*(\w+)\s*\(([^()]*)\)\s*(?:within\s*\(([^()]*)\)\s*)?", re.ASCII)
#: Least share of a distribution that bounds may leave: in smaller ones, few digits of the shares remain.
_LEAST_SHARE = 1e-9


@dataclass(frozen=True)
class Kind:
    """A kind of distribution, as functions of its parameters.

    Attributes
    ----------
    parameters : tuple of str
        Names of the parameters; empty for any number of values.
    right : Message
        Condition on the parameters, in words.
    is_valid : callable
        Whether parameters meet the condition.
    ends : callable
        Least and greatest value; infinite where there is none.
    value : callable
        Value at a share from 0 to 1, the argument after the parameters; where there is ``deviate``, at a standard
        normal deviate.
    deviate : callable or None
        The inverse of ``value``, of distributions that are normal or a function of a normal one.
    """

    parameters: tuple[str, ...]
    right: Message
    is_valid: Callable[..., bool]
    ends: Callable[..., tuple[float, float]]
    value: Callable[..., float]
    deviate: Callable[..., float] | None = None


def _triangular(low: float, mode: float, high: float, share: float) -> float:
    if share * (high - low) <= mode - low:
        return low + math.sqrt(share * (high - low) * (mode - low))
    return high - math.sqrt((1.0 - share) * (high - low) * (high - mode))


def _choice(*values_and_share: float) -> float:
    *values, share = values_and_share
    return values[int(share * len(values))]


KINDS = {
    "uniform": Kind(
        ("low", "high"),
        Message("low below high"),
        lambda low, high: low < high,
        lambda low, high: (low, high),
        lambda low, high, share: low + (high - low) * share,
    ),
    "normal": Kind(
        ("mean", "sd"),
        Message("sd above 0"),
        lambda _, sd: sd > 0.0,
        lambda *_: (-math.inf, math.inf),
        lambda mean, sd, deviate: mean + sd * deviate,
        lambda mean, sd, value: (value - mean) / sd,
    ),
    "lognormal": Kind(
        ("median", "sigma"),
        Message("median and sigma above 0"),
        lambda median, sigma: median > 0.0 and sigma > 0.0,
        lambda *_: (0.0, math.inf),
        lambda median, sigma, deviate: median * math.exp(sigma * deviate),
        lambda median, sigma, value: math.log(value / median) / sigma if value > 0.0 else -math.inf,
    ),
    "loguniform": Kind(
        ("low", "high"),
        Message("low above 0 and below high"),
        lambda low, high: 0.0 < low < high,
        lambda low, high: (low, high),
        lambda low, high, share: low * math.exp(math.log(high / low) * share),
    ),
    "triangular": Kind(
        ("low", "mode", "high"),
        Message("low below high, and mode from low to high"),
        lambda low, mode, high: low <= mode <= high and low < high,
        lambda low, _, high: (low, high),
        _triangular,
    ),
    "choice": Kind(
        (),
        Message("at least one value"),
        lambda *values: bool(values),
        lambda *values: (min(values), max(values)),
        _choice,
    ),
}


@dataclass(frozen=True)
class Variation:
    """The distribution of a field's values.

    Parameters
    ----------
    field : str
    kind : str
        One of `KINDS`.
    parameters : tuple of float
    within : (float, float) or None
        Bounds beyond which there are no values; between them the distribution keeps its shape.
    """

    field: str
    kind: str
    parameters: tuple[float, ...]
    within: tuple[float, float] | None = None

    def __str__(self) -> str:
        kept = "" if self.within is None else f"within({_listed(self.within)})"
        return f"{self.field}={self.kind}({_listed(self.parameters)}){kept}"

    @classmethod
    def from_text(cls, text: str) -> Variation:
        """Parse ``FIELD=KIND(parameters)``, which ``within(low,high)`` may follow.

        Raises
        ------
        InvalidInput
            Another form, an unknown kind, wrong parameters, or bounds that leave no values.
        """
        return _parsed(text)

    @property
    def ends(self) -> tuple[float, float]:
        """Least and greatest value; infinite where there is none."""
        return self.within or KINDS[self.kind].ends(*self.parameters)

    @property
    def extremes(self) -> tuple[float, float]:
        """Least and greatest value that a draw can have, which are finite."""
        return self._rounded(_share(0)), self._rounded(_share((1 << 64) - 1))

    def quantile(self, share: float) -> float:
        """Value below which a share of all values lies, above 0 and below 1."""
        kind = KINDS[self.kind]
        if kind.deviate is None:
            return kind.value(*self.parameters, share)
        # Imported here, as it takes long and most missions draw nothing. It is Wichura's algorithm AS 241.
        from statistics import NormalDist

        sign, low, high = self._tails
        found = NormalDist().inv_cdf(low + (high - low) * (share if sign > 0.0 else 1.0 - share))
        value = kind.value(*self.parameters, sign * found)
        return value if self.within is None else min(max(value, self.within[0]), self.within[1])

    @property
    def kept_share(self) -> float:
        """Share of the values that lie within the bounds."""
        _, low, high = self._tails
        return high - low

    @cached_property
    def _tails(self) -> tuple[float, float, float]:
        """Shares of the normal distribution below the bounds; after -1.0 above them, which has the digits there."""
        deviate = KINDS[self.kind].deviate
        if self.within is None or deviate is None:
            return 1.0, 0.0, 1.0
        low, high = (deviate(*self.parameters, bound) for bound in self.within)
        sign = -1.0 if low > 0.0 else 1.0
        low, high = sorted((sign * low, sign * high))
        return sign, 0.5 * math.erfc(-low / math.sqrt(2.0)), 0.5 * math.erfc(-high / math.sqrt(2.0))

    def draw(self, seed: int, image: str) -> float:
        """Value of an image, the same wherever and whenever it is drawn."""
        digest = hashlib.blake2b(f"{seed} {self.field} {image}".encode(), digest_size=8).digest()
        return self._rounded(_share(int.from_bytes(digest, "big")))

    def _rounded(self, share: float) -> float:
        value = self.quantile(share)
        if not KINDS[self.kind].parameters:
            return value
        low, high = self.ends
        return min(max(float(f"{value:.6g}"), low), high)


def _share(word: int) -> float:
    """Share between 0 and 1, both excluded, of a word of 64 bits: the middle of one of 2^52 equal parts."""
    return ((word >> 12) + 0.5) * 2.0**-52


def _listed(numbers: tuple[float, ...]) -> str:
    return ",".join(f"{number:.12g}" for number in numbers)


@lru_cache(maxsize=256)
def _parsed(text: str) -> Variation:
    found = _TEXT.fullmatch(text)
    if found is None:
        raise _refused(text, Message("must be as {0}", "exposure_ms=lognormal(4,0.5)"))
    field, name, *numbers = found.groups()
    kind = KINDS.get(name)
    if kind is None:
        raise _refused(text, Message("{0} must be one of {1}", name, ", ".join(KINDS)))
    parameters = _numbers(text, numbers[0])
    if kind.parameters and len(parameters) != len(kind.parameters):
        raise _refused(text, Message("{0} takes {1}", name, ",".join(kind.parameters)))
    if not kind.is_valid(*parameters):
        raise _refused(text, Message("{0} needs {1}", name, kind.right))
    made = Variation(field, name, parameters, None if numbers[1] is None else _bounds(text, kind, numbers[1]))
    _check_values(text, made)
    return made


def _numbers(text: str, numbers: str) -> tuple[float, ...]:
    try:
        found = tuple(real_number(one.strip()) for one in numbers.split(",")) if numbers.strip() else ()
    except ValueError:
        found = (math.nan,)
    if not all(map(math.isfinite, found)):
        raise _refused(text, Message("{0} must be numbers", numbers))
    return found


def _bounds(text: str, kind: Kind, numbers: str) -> tuple[float, float]:
    found = _numbers(text, numbers)
    if len(found) != 2:
        raise _refused(text, Message("{0} takes {1}", "within", "low,high"))
    if not found[0] < found[1]:
        raise _refused(text, Message("{0} needs {1}", "within", KINDS["uniform"].right))
    if kind.deviate is None:
        raise _refused(text, Message("only distributions without bounds are cut off"))
    return found[0], found[1]


def _check_values(text: str, made: Variation) -> None:
    """Refuse bounds that leave hardly any values, and values beyond floating-point numbers."""
    if not made.kept_share >= _LEAST_SHARE:
        raise _refused(text, Message("hardly any values lie within these bounds"))
    try:
        is_finite = all(map(math.isfinite, made.extremes))
    except OverflowError:
        is_finite = False
    if not is_finite:
        raise _refused(text, Message("its values are not finite"))


def _refused(text: str, why: Message) -> InvalidInput:
    return InvalidInput("vary {0!r}: {1}", text, why, field="vary")
