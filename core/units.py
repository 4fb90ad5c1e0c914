"""Units of the numbers in a mission; a new unit is one line here."""

from __future__ import annotations

from dataclasses import dataclass

from .errors import Message

#: International foot.
M_PER_FT = 0.3048
#: Units of heights in input, each in metres.
LENGTHS_M = {"m": 1.0, "ft": M_PER_FT}


@dataclass(frozen=True)
class Unit:
    """Names of a unit, and the form in which users type numbers.

    Parameters
    ----------
    symbol : Message or str
        Follows a number in a sentence; empty for none.
    words : Message or str
        Name in full, in brackets after a title.
    suffix : str
        Follows the number in an entry field.
    decimals : int
        Decimals of an entry field.
    typed_words : Message or str
        Unit of the typed number, if it differs.
    times : float
        Factor from the number to the typed one: 100 for percent.
    """

    symbol: str = ""
    words: str = ""
    suffix: str = ""
    decimals: int = 4
    typed_words: str = ""
    times: float = 1.0


#: Units by the names used in `fields.declared`.
UNITS = {
    "": Unit(),
    "coefficient": Unit(decimals=12),
    "m": Unit(Message("m"), Message("metres"), " m", 6),
    "deg": Unit(Message("deg"), Message("degrees"), " °", 6),
    "px": Unit(Message("px"), Message("px"), " px", 12),
    "c/px": Unit(Message("cycles/px"), Message("cycles per px"), " c/px", 4),
    "km": Unit(Message("km"), Message("kilometres"), " km", 3),
    "m/s": Unit(Message("m/s"), Message("metres per second"), " m/s", 3),
    "s": Unit(Message("s"), Message("seconds"), " s", 3),
    "ms": Unit(Message("ms"), Message("milliseconds"), " ms", 3),
    "us": Unit(Message("µs"), Message("microseconds"), " µs", 3),
    "um": Unit(Message("µm"), Message("micrometres"), " µm", 3),
    "e": Unit(Message("e-"), Message("electrons"), " e⁻", 1),
    "e/s": Unit(Message("e-/s"), Message("electrons per second"), " e⁻/s", 3),
    "DN": Unit(Message("DN"), Message("digital numbers"), " DN", 1),
    "DN/e": Unit(Message("DN/e-"), Message("digital numbers per electron"), " DN/e⁻", 4),
    "min": Unit(Message("min"), Message("minutes"), " min", 1),
    "Hz": Unit(Message("Hz"), Message("hertz"), " Hz", 3),
    "lx": Unit(Message("lx"), Message("lux"), " lx", 1),
    "K": Unit(Message("K"), Message("kelvins"), " K", 0),
    "share": Unit(Message("%"), Message("share"), suffix=" %", decimals=1, typed_words=Message("percent"), times=100.0),
}
