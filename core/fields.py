"""Fields of a mission, each declared once as a dataclass field.

The checks, the command's options, the plugin's form, mission files and the documentation all follow from `declared`.
Titles and help are lower-case fragments, capitalised where they are shown.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass
from functools import cache
from typing import Any

from .errors import InvalidInput, Message
from .limits import MAX_WHOLE_NUMBER
from .units import UNITS, Unit

_KEY = "declared"
#: Types of fields, in words for errors.
_TYPES = {
    float: Message("a number"),
    int: Message("a whole number"),
    str: Message("text"),
    bool: Message("true or false"),
    tuple: Message("a list"),
}


def declared(
    default: Any = MISSING,
    *,
    title: str,
    help: str,  # noqa: A002  as argparse calls it
    label: str = "",
    unit: str = "",
    least: float | None = None,
    most: float | None = None,
    above: float | None = None,
    below: float | None = None,
    choices: Mapping[str, str] | None = None,
    option: str = "",
    suggested: Any = None,
    advanced: bool = False,
    check: Callable[[Any], None] | None = None,
    schema: Mapping[str, Any] | None = None,
) -> Any:
    """Declare a field of a frozen dataclass.

    Parameters
    ----------
    default
        None for an optional field; omitted for a required one.
    title : str
        Name for users, such as "height above ground".
    help : str
        Effect of the field, without unit, limits and default, which are shown beside it.
    label : str
        Title in a form, with ``&`` before the letter of its keyboard shortcut.
    unit : str
        One of `UNITS`; empty for none.
    least, most, above, below : float or None
        Limits, the first two inclusive, the others exclusive.
    choices : mapping of str to str or None
        Allowed values, each with its text for users.
    option : str
        Name of the command's option, if it differs from the field's.
    suggested
        Initial value in a form, if the default is None.
    advanced : bool
        Whether only few users need the field.
    check : callable or None
        Raises InvalidInput for values that limits and choices do not exclude.
    schema : mapping or None
        Keywords for the schema of mission files beyond limits and choices.

    Raises
    ------
    ValueError
        The unit is not declared.
    """
    if unit not in UNITS:
        unknown = f"unit {unit!r} of {title!r}: not one of {', '.join(filter(None, UNITS))}, as core/units.py has them"
        raise ValueError(unknown)
    metadata = {
        "title": title,
        "help": help,
        "label": label,
        "unit": UNITS[unit],
        "least": least,
        "most": most,
        "above": above,
        "below": below,
        "choices": dict(choices or {}),
        "option": option,
        "suggested": suggested,
        "advanced": advanced,
        "check": check,
        "schema": dict(schema or {}),
    }
    return dataclasses.field(default=default, metadata={_KEY: metadata})


def is_plain(value: Any) -> bool:
    """Whether a value is printable text without spaces around it; it may be empty."""
    return isinstance(value, str) and value == value.strip() and value.isprintable()


@dataclass(frozen=True)
class Field:
    """A declared field; see `declared`.

    Parameters
    ----------
    name : str
    kind : type
        float, int, bool, str or tuple.
    optional : bool
        Whether None is allowed.
    """

    name: str
    kind: type
    optional: bool
    default: Any
    title: str
    help: str
    label: str
    unit: Unit
    least: float | None
    most: float | None
    above: float | None
    below: float | None
    choices: Mapping[str, str]
    option: str
    suggested: Any
    advanced: bool
    check: Callable[[Any], None] | None
    schema: Mapping[str, Any]

    @property
    def needed(self) -> bool:
        """Whether the field has no default."""
        return self.default is MISSING

    @property
    def name_of_option(self) -> str:
        """Name of the command's option, with underscores."""
        return self.option or self.name

    @property
    def unit_and_limits(self) -> str:
        """Unit and limits, in words."""
        return ", ".join(filter(None, (self.unit.words, self.domain)))

    @property
    def initial_value(self) -> Any:
        """Value that a form begins with."""
        return self.suggested if self.suggested is not None else self.default

    @property
    def domain(self) -> Message:
        """Limits in words; empty if there are none."""
        return self._range(1.0)

    def _range(self, times: float) -> Message:
        """Limits in words, multiplied by a factor."""
        low, high = (
            None if limit is None else times * limit
            for limit in (
                self.least if self.above is None else self.above,
                self.most if self.below is None else self.below,
            )
        )
        if low is None and high is None:
            return Message()
        if high is None:
            return Message("{0:g} or more", low) if self.above is None else Message("above {0:g}", low)
        if low is None:
            return Message("at most {0:g}", high) if self.below is None else Message("below {0:g}", high)
        if self.below is None:
            # Such an upper limit only bounds the arithmetic; users need not see it.
            return Message("from {0:g} to {1:g}", low, high) if self.above is None else Message("above {0:g}", low)
        if self.above is None:
            return Message("at least {0:g} and below {1:g}", low, high)
        return Message("between {0:g} and {1:g}, both excluded", low, high)

    def settled(self, value: Any) -> Any:
        """Convert a value to the field's type and check it; whole floats become integers, lists become tuples.

        Raises
        ------
        InvalidInput
            Wrong type, or outside the domain; names the field.
        """
        if value is None and self.optional:
            return None
        value = self._typed(value)
        if self.kind in (float, int):
            self._check_limits(value)
        for one in value if self.kind is tuple else (value,):
            # A value from a file may be unhashable.
            if self.choices and one not in tuple(self.choices):
                raise self._refused(Message(self.title), repr(one), Message("one of {0}", ", ".join(self.choices)))
        if self.check is not None:
            self.check(value)
        return value

    def _refused(self, title: Message, value: object, right: Message) -> InvalidInput:
        return InvalidInput("{0} {1}: must be {2}", title, value, right, field=self.name)

    def _typed(self, value: Any) -> Any:
        if self.kind is bool and isinstance(value, bool):
            return value
        if self.kind is str and isinstance(value, str):
            return value
        if self.kind is tuple and isinstance(value, (list, tuple)):
            return tuple(value)
        if self.kind in (float, int) and not isinstance(value, (bool, str, bytes, list, tuple)):
            try:
                if self.kind is float:
                    return float(value)
                if value == int(value):
                    return int(value)
            except (TypeError, ValueError, OverflowError):
                # An integer too large for a float exceeds every limit; other values are refused below.
                if isinstance(value, int):
                    return math.copysign(math.inf, 1 if value > 0 else -1)
        raise self._refused(Message(self.title), repr(value), _TYPES[self.kind])

    def _check_limits(self, value: float) -> None:
        title, too_long = Message(self.title), Message("of more than 64 bits")
        if self.kind is int and value > MAX_WHOLE_NUMBER:
            raise self._refused(title, too_long, Message("at most {0}", MAX_WHOLE_NUMBER))
        if self.kind is int and self.least is None and value < -MAX_WHOLE_NUMBER:
            raise self._refused(title, too_long, Message("at least {0}", -MAX_WHOLE_NUMBER))
        within = (
            (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
            and (self.above is None or value > self.above)
            and (self.below is None or value < self.below)
        )
        if within and (self.kind is int or math.isfinite(value)):
            return
        # Report limits in the unit that users type, such as percent.
        times, symbol = self.unit.times, self.unit.symbol
        right = self._range(times)
        if within or not right:
            right = Message("a finite number")
        elif self.above is not None and self.most is not None and value > self.most:
            right = Message("at most {0:g}", times * self.most)
        shown = value if times == 1.0 else float(f"{times * value:.12g}")
        raise self._refused(title, Message("{0} {1}", shown, symbol) if symbol else shown, right)


def declared_fields(part: Any) -> tuple[Field, ...]:
    """Declared fields of a dataclass, in order."""
    return _declared_fields(part)


@cache
def _declared_fields(part: Any) -> tuple[Field, ...]:
    kinds = {kind.__name__: kind for kind in _TYPES}
    return tuple(
        Field(
            name=one.name,
            # Annotations are text: `float | None`, `tuple[str, ...]`.
            kind=kinds[str(one.type).partition("[")[0].partition(" ")[0]],
            optional=str(one.type).endswith("| None"),
            default=one.default,
            **one.metadata[_KEY],
        )
        for one in dataclasses.fields(part)
        if _KEY in one.metadata
    )


def field_named(part: Any, name: str) -> Field:
    """Declared field of a dataclass, by name."""
    return next(one for one in declared_fields(part) if one.name == name)


class CheckedFields:
    """Base of frozen dataclasses whose declared fields are checked on creation."""

    def __post_init__(self) -> None:
        """Convert and check every field."""
        for one in declared_fields(type(self)):
            object.__setattr__(self, one.name, one.settled(getattr(self, one.name)))
