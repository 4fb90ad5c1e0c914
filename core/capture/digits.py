"""Digits that mean something: what images say of themselves is the same wherever they are made.

Sines of other processors differ in the last places; numbers with all of theirs would make every file another one.
"""

from __future__ import annotations

#: Decimals of degrees, 0.1 mm of ground, and digits of other figures.
DECIMALS_OF_DEGREES, _DIGITS = 9, 6
#: Decimals of an accuracy in metres, of which 0.01 is the finest that is stated.
_DECIMALS_OF_ACCURACY = 4


def degrees(angle_deg: float) -> float:
    """Angle in degrees as files state it; never -0."""
    return round(float(angle_deg), DECIMALS_OF_DEGREES) + 0.0


def accuracy(metres: float) -> float:
    """Accuracy of a position as files state it, to a hundredth of the finest."""
    return round(float(metres), _DECIMALS_OF_ACCURACY)


def figure(value: float) -> float:
    """Any other number as files state it; never -0."""
    return float(f"{value:.{_DIGITS}g}") + 0.0
