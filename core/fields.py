"""What a field of a mission is, declared once where it stands, and what follows from that.

`declared` is written at a dataclass field. From it follow the checks, and what the command, the plugin, mission files
and the documentation say of the field. Texts are fragments in lower case: who shows one begins it with a capital.
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
#: What a value must be, by the type that a field's annotation begins with.
_KINDS: dict[str, type] = {"float": float, "int": int, "bool": bool, "str": str, "tuple": tuple}
#: What a value of each must be, in words.
_TYPES = {
    float: Message("a number"),
    int: Message("a whole number"),
    str: Message("text"),
    bool: Message("true or false"),
    tuple: Message("a list"),
}
_TOO_LONG = Message("of more than 64 bits")


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
    """Field of a frozen dataclass, with all that there is to say of it.

    Parameters
    ----------
    default
        None where the mission goes without; left out where the field is needed.
    title : str
        What people call it: "height above ground".
    help : str
        What it does, without unit, limits and default, which are said beside it.
    label : str
        Title where it begins a row that has a key: ``&`` stands before that letter.
    unit : str
        One of `UNITS`, or none.
    least, most, above, below : float or None
        Limits; the first two are allowed themselves, the others are not.
    choices : mapping of str to str or None
        Values there are, each with what people read.
    option : str
        Name of the command's option where it is not the field's.
    suggested
        What a form begins with, where the default says nothing.
    advanced : bool
        Whether few people need it.
    check : callable or None
        Raises InvalidInput for what limits and choices do not tell.
    schema : mapping or None
        What there is to say beyond limits and choices in the schema of mission files.

    Raises
    ------
    ValueError
        A unit that is not declared.
    """
    if unit not in UNITS:
        unknown = f"unit {unit!r} of {title!r}: not one of {', '.join(filter(None, UNITS))}, as core/units.py has them"
        raise ValueError(unknown)
    said = {
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
    return dataclasses.field(default=default, metadata={_KEY: said})


@dataclass(frozen=True)
class Field:
    """A field as it is declared; see `declared`.

    Parameters
    ----------
    name : str
    kind : type
        float, int, bool, str or tuple.
    optional : bool
        Whether None is a value of it.
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
        """Whether it has no default."""
        return self.default is MISSING

    @property
    def name_of_option(self) -> str:
        """Name of the command's option, with underscores."""
        return self.option or self.name

    @property
    def unit_and_limits(self) -> str:
        """Unit and limits in words."""
        return ", ".join(filter(None, (self.unit.words, self.right)))

    @property
    def initial_value(self) -> Any:
        """What a form shows of it before anybody has entered anything."""
        return self.suggested if self.suggested is not None else self.default

    @property
    def right(self) -> Message:
        """What is right of numbers, in words; empty where every number is."""
        return self._range(1.0)

    def _range(self, times: float) -> Message:
        """What is right of numbers that are so many times the field's."""
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
            # Above something, the upper one is where the arithmetic ends, and no range to choose from.
            return Message("from {0:g} to {1:g}", low, high) if self.above is None else Message("above {0:g}", low)
        if self.above is None:
            return Message("at least {0:g} and below {1:g}", low, high)
        return Message("between {0:g} and {1:g}, both excluded", low, high)

    def settled(self, value: Any) -> Any:
        """Value as the field keeps it: whole numbers and their floats are one, lists are tuples.

        Raises
        ------
        InvalidInput
            Another type, or a value outside the domain; names the field.
        """
        if value is None and self.optional:
            return None
        value = self._typed(value)
        if self.kind in (float, int):
            self._check_limits(value)
        for one in value if self.kind is tuple else (value,):
            # What a file holds there need not be hashable.
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
                # What is no number is said below; one that no float holds is beyond every limit.
                if isinstance(value, int):
                    return math.copysign(math.inf, 1 if value > 0 else -1)
        raise self._refused(Message(self.title), repr(value), _TYPES[self.kind])

    def _check_limits(self, value: float) -> None:
        title = Message(self.title)
        if self.kind is int and value > MAX_WHOLE_NUMBER:
            raise self._refused(title, _TOO_LONG, Message("at most {0}", MAX_WHOLE_NUMBER))
        if self.kind is int and self.least is None and value < -MAX_WHOLE_NUMBER:
            raise self._refused(title, _TOO_LONG, Message("at least {0}", -MAX_WHOLE_NUMBER))
        within = (
            (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
            and (self.above is None or value > self.above)
            and (self.below is None or value < self.below)
        )
        if within and (self.kind is int or math.isfinite(value)):
            return
        # Of what is typed, such as percent.
        times, symbol = self.unit.times, self.unit.symbol
        right = self._range(times)
        if within or not right:
            right = Message("a finite number")
        elif self.above is not None and self.most is not None and value > self.most:
            right = Message("at most {0:g}", times * self.most)
        shown = value if times == 1.0 else float(f"{times * value:.12g}")
        raise self._refused(title, Message("{0} {1}", shown, symbol) if symbol else shown, right)


def declared_fields(part: Any) -> tuple[Field, ...]:
    """Fields of a dataclass that are declared, in order."""
    return _declared_fields(part)


@cache
def _declared_fields(part: Any) -> tuple[Field, ...]:
    return tuple(
        Field(
            name=one.name,
            kind=_KINDS[str(one.type).partition("[")[0].partition(" ")[0]],
            optional=str(one.type).endswith("| None"),
            default=one.default,
            **one.metadata[_KEY],
        )
        for one in dataclasses.fields(part)
        if _KEY in one.metadata
    )


def field_named(part: Any, name: str) -> Field:
    """Declared field of a dataclass by its name."""
    return next(one for one in declared_fields(part) if one.name == name)


class CheckedFields:
    """A frozen dataclass of declared fields, each checked when it is made."""

    def __post_init__(self) -> None:
        """Check every field, and keep it as it settles."""
        for one in declared_fields(type(self)):
            object.__setattr__(self, one.name, one.settled(getattr(self, one.name)))
