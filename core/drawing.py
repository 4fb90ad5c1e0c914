"""What all diagrams have in common: colours, figures without a display, and PNG of the same bytes every time."""

from __future__ import annotations

import importlib
import io
from typing import Any

from .errors import OutputError
from .limits import MAX_TEXT_CHARACTERS
from .text import printable, shortened

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
#: Characters of a foreign name in a diagram.
_LABEL_CHARACTERS = 60


def check_matplotlib() -> None:
    """Raise OutputError where matplotlib is not there to draw with."""
    _figure_class()


def _figure_class() -> Any:
    # The object interface with its own canvas: no state of pyplot's, and no display.
    try:
        return importlib.import_module("matplotlib.figure").Figure
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
    """Figure as a file."""
    buffer = io.BytesIO()
    # Without the date and version that matplotlib writes by itself: the same figure gives the same bytes.
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


def label_of(name: str) -> str:
    """Foreign name as a diagram shows it: one short line, and no formula, which stands between dollars."""
    plain = " ".join(printable(name[:MAX_TEXT_CHARACTERS]).split())
    return shortened(plain, _LABEL_CHARACTERS).replace("$", r"\$")


def dress(axes: Any, title: str, across: str, up: str) -> None:
    """Title, labels, a quiet grid behind what is drawn, and no frame."""
    axes.set_title(title, fontsize=FONT["title"], loc="left", pad=10)
    axes.set_xlabel(across, fontsize=FONT["label"])
    axes.set_ylabel(up, fontsize=FONT["label"])
    axes.grid(True, which="major", color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
