"""Diagrams: colours, figures without a display, and reproducible PNG files."""

from __future__ import annotations

import importlib
import io
import math
import warnings
from typing import Any

from ..errors import OutputError
from ..limits import MAX_TEXT_CHARACTERS
from ..text.plain import printable, shortened
from .importing import imported

#: The palette of Okabe and Ito, distinct for all kinds of colour vision.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, VERMILION, PURPLE = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#F0E442",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)
_DPI = 130
#: Font sizes in points.
FONT = {"label": 11, "title": 13, "note": 9}


def check_matplotlib() -> None:
    """Raise OutputError if matplotlib is missing."""
    _figure_class()


def _figure_class() -> Any:
    # Do not use pyplot, which keeps global state and may open a display.
    try:
        return imported("matplotlib.figure").Figure
    except ImportError as missing:
        raise OutputError(
            "matplotlib, which draws the diagrams, is not installed",
            remedy="get it with: pip install 'terrainav[report]'",
        ) from missing


def new_figure(width: float, height: float) -> Any:
    """Create an empty figure of a size in inches; raises OutputError without matplotlib."""
    figure = _figure_class()(figsize=(width, height), dpi=_DPI, facecolor="white", constrained_layout=True)
    importlib.import_module("matplotlib.backends.backend_agg").FigureCanvasAgg(figure)
    return figure


def png(figure: Any) -> bytes:
    """Write a figure as PNG; texts, which may hold foreign names, are drawn literally."""
    _disable_markup(figure)
    buffer = io.BytesIO()
    with warnings.catch_warnings():
        # Ignore warnings of missing glyphs, which are drawn as boxes, and of labels that are too long.
        warnings.simplefilter("ignore", UserWarning)
        # Leave out matplotlib's version, so that the same figure gives the same bytes.
        figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


def short_label(name: str) -> str:
    """Shorten a foreign name to one line for a diagram."""
    return shortened(" ".join(printable(name[:MAX_TEXT_CHARACTERS]).split()), 60)


def _disable_markup(figure: Any) -> None:
    """Turn off LaTeX for all texts of a figure, and mathematical text (``$…$``) for all except tick labels."""
    text, axis = (importlib.import_module(f"matplotlib.{name}") for name in ("text", "axis"))
    ticks = {id(one) for tick in figure.findobj(axis.Tick) for one in (tick.label1, tick.label2)}
    for one in figure.findobj(text.Text):
        one.set_usetex(False)
        if id(one) not in ticks:
            one.set_parse_math(False)
            # Replace control characters and surrogates.
            one.set_text("\n".join(map(printable, one.get_text().split("\n"))))


def dress(axes: Any, title: str, across: str, up: str) -> None:
    """Set title and labels, a light grid in the background, and no frame."""
    axes.set_title(title, fontsize=FONT["title"], loc="left", pad=10)
    axes.set_xlabel(across, fontsize=FONT["label"])
    axes.set_ylabel(up, fontsize=FONT["label"])
    axes.grid(True, which="major", color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def logarithmic(axes: Any, which: str) -> None:
    """Make axes logarithmic, with plain tick labels, as some parsers of mathematical text warn."""
    for name in which:
        getattr(axes, f"set_{name}scale")("log")
        axis = getattr(axes, f"{name}axis")
        axis.set_major_formatter(_power_of_ten)
        axis.set_minor_formatter(lambda _value, _position: "")


def _power_of_ten(value: float, _position: int) -> str:
    if value <= 0.0:
        return ""
    exponent = math.log10(value)
    # log10 of a power of ten may be off by rounding.
    whole = math.floor(exponent + 1e-9)
    if -3 <= whole <= 3:
        return f"{value:g}"
    power = "10" + str(whole).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return power if abs(exponent - whole) <= 1e-9 else f"{value / 10.0**whole:.3g} × {power}"
