"""What all diagrams have in common: colours, figures without a display, and PNG of the same bytes every time."""

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

#: Okabe and Ito's palette, which people with any kind of colour vision tell apart.
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
#: Sizes of text, in points.
FONT = {"label": 11, "title": 13, "note": 9}
_DPI = 130
#: Powers of ten written out, and what an exponent's rounding may be.
_PLAIN, _ROUNDING = 3, 1e-9
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def check_matplotlib() -> None:
    """Raise OutputError where matplotlib is not there to draw with."""
    _figure_class()


def _figure_class() -> Any:
    # The object interface with its own canvas: no state of pyplot's, and no display.
    try:
        return imported("matplotlib.figure").Figure
    except ImportError as missing:
        raise OutputError(
            "matplotlib, which draws the diagrams, is not installed",
            remedy="get it with: pip install 'terrainav[report]'",
        ) from missing


def new_figure(width: float, height: float) -> Any:
    """Empty figure of a size in inches; raises OutputError without matplotlib."""
    figure = _figure_class()(figsize=(width, height), dpi=_DPI, facecolor="white", constrained_layout=True)
    importlib.import_module("matplotlib.backends.backend_agg").FigureCanvasAgg(figure)
    return figure


def png(figure: Any) -> bytes:
    """Figure as a file; its texts are shown as they are, whatever they are: names are somebody else's."""
    _take_literally(figure)
    buffer = io.BytesIO()
    with warnings.catch_warnings():
        # Names may be of any script, for which boxes stand where the font does not have it, and of any length.
        warnings.simplefilter("ignore", UserWarning)
        # Without the date and version that matplotlib writes by itself: the same figure gives the same bytes.
        figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


def short_label(name: str) -> str:
    """Foreign name as a diagram shows it: one short line."""
    return shortened(" ".join(printable(name[:MAX_TEXT_CHARACTERS]).split()), 60)


def _take_literally(figure: Any) -> None:
    """Have no text of a figure read as mathematical text (``$…$``) or by LaTeX.

    Labels of ticks are left alone: they are matplotlib's own, and made as it draws.
    """
    text, axis = (importlib.import_module(f"matplotlib.{name}") for name in ("text", "axis"))
    ticks = {id(one) for tick in figure.findobj(axis.Tick) for one in (tick.label1, tick.label2)}
    for one in figure.findobj(text.Text):
        one.set_usetex(False)
        if id(one) not in ticks:
            one.set_parse_math(False)
            # Controls, of which some have no glyph and others begin a line, and halves of characters.
            one.set_text("\n".join(map(printable, one.get_text().split("\n"))))


def dress(axes: Any, title: str, across: str, up: str) -> None:
    """Title, labels, a quiet grid behind what is drawn, and no frame."""
    axes.set_title(title, fontsize=FONT["title"], loc="left", pad=10)
    axes.set_xlabel(across, fontsize=FONT["label"])
    axes.set_ylabel(up, fontsize=FONT["label"])
    axes.grid(True, which="major", color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def logarithmic(axes: Any, which: str) -> None:
    """Logarithmic axes with plain text at their ticks: mathematical text warns with some versions of its parser."""
    for name in which:
        getattr(axes, f"set_{name}scale")("log")
        axis = getattr(axes, f"{name}axis")
        axis.set_major_formatter(_power_of_ten)
        axis.set_minor_formatter(lambda _value, _position: "")


def _power_of_ten(value: float, _position: int) -> str:
    if value <= 0.0:
        return ""
    exponent = math.log10(value)
    if abs(exponent - round(exponent)) > _ROUNDING:
        return f"{value:g}"
    exponent = round(exponent)
    if -_PLAIN <= exponent <= _PLAIN:
        return f"{10.0**exponent:g}"
    return "10" + str(exponent).translate(_SUPERSCRIPTS)
