"""Units of the numbers in a mission, each declared once: a line here is all that a new one needs."""

from __future__ import annotations

from dataclasses import dataclass

from .errors import Message

#: International foot.
M_PER_FT = 0.3048
#: Units that heights may be given in, each in metres.
LENGTHS_M = {"m": 1.0, "ft": M_PER_FT}


@dataclass(frozen=True)
class Unit:
    """A unit in words, and how numbers in it are typed.

    Parameters
    ----------
    symbol : Message or str
        Behind a number in a sentence, as it is typed; empty where numbers stand alone.
    words : Message or str
        In full, as it stands in brackets behind what is measured.
    suffix : str
        Behind a number that is typed.
    decimals : int
        Most digits after the point that people type.
    typed_words : Message or str
        What is typed, where that is not the number itself.
    times : float
        What is typed is so many times the number: 100 for percent.
    """

    symbol: str = ""
    words: str = ""
    suffix: str = ""
    decimals: int = 4
    typed_words: str = ""
    times: float = 1.0


#: By the name that declared fields give.
UNITS = {
    "": Unit(),
    "m": Unit(Message("m"), Message("metres"), " m", 6),
    "deg": Unit(Message("deg"), Message("degrees"), " °", 6),
    "px": Unit(Message("px"), Message("px"), " px", 12),
    "m/s": Unit(Message("m/s"), Message("metres per second"), " m/s", 3),
    "s": Unit(Message("s"), Message("seconds"), " s", 3),
    "min": Unit(Message("min"), Message("minutes"), " min", 1),
    "share": Unit(Message("%"), Message("share"), suffix=" %", decimals=1, typed_words=Message("percent"), times=100.0),
}
