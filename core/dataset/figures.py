"""Diagrams of a dataset's entropies: a bar for each image, and a histogram, both with the threshold of cleaning.

They follow the paper (section Post Processing). Matplotlib is imported when they are drawn.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Floats
from ..external.drawing import BLACK, BLUE, FONT, VERMILION, check_matplotlib, dress, new_figure, png
from ..storage.files import make_folder, write_whole
from .entropy import HIGHEST_ENTROPY, Deciding, deciding_entropies, otsu

#: Width of a bar of the histogram, bits.
_BIN = 0.1
#: Most bars drawn side by side, each at least a pixel wide.
_COLUMNS = 1000
#: Rows of the image that replaces more bars than that.
_ROWS = 480
#: Colours of bars, one light and one dark, which also differ in print without colours.
_REJECTED, _KEPT = "#9A9A9A", BLUE


def draw_histogram(
    axes: Any, values: Floats, threshold: float, *, suggested: float | None = None, title: str = ""
) -> None:
    """Draw a histogram of entropies, with the threshold as a red line.

    Parameters
    ----------
    values : array (n,)
        Bits; NaN is skipped.
    threshold : float
        Bits; images below it are rejected. It lies between two bars.
    suggested : float or None
        Another threshold, drawn as a dotted line.
    """
    known = values[~np.isnan(values)]
    dress(axes, title, "entropy, bits", f"images, per {_BIN:g} bit")
    steps = np.arange(np.floor(-threshold / _BIN), np.ceil((HIGHEST_ENTROPY - threshold) / _BIN) + 1.0)
    # Rounding may put the last edge just below the highest entropy, and so leave out images that have it.
    edges = np.append(threshold + steps * _BIN, HIGHEST_ENTROPY + _BIN)
    counts = np.histogram(known, edges)[0]
    low = edges[:-1] < threshold
    rejected = known < threshold
    for which, colour, label in (
        (low, _REJECTED, _count_label("rejected", int(rejected.sum()), len(known))),
        (~low, _KEPT, _count_label("kept", int((~rejected).sum()), len(known))),
    ):
        axes.bar(
            edges[:-1][which],
            counts[which],
            width=_BIN,
            align="edge",
            color=colour,
            edgecolor="white",
            linewidth=0.5,
            label=label,
        )
    axes.axvline(threshold, color=VERMILION, linewidth=2.2, label=f"threshold {threshold:g} bits")
    if suggested is not None:
        axes.axvline(suggested, color=BLACK, linewidth=1.5, linestyle=":", label=_suggestion(suggested))
    axes.set_xlim(0.0, HIGHEST_ENTROPY)
    axes.yaxis.get_major_locator().set_params(integer=True)
    _draw_legend(axes)


def draw_bars(axes: Any, values: Floats, threshold: float, *, suggested: float | None = None, title: str = "") -> None:
    """Draw the entropy of each image in the order of the table, with the threshold as a red line.

    The bars of more than a thousand images would be narrower than a pixel. Several then share a column, which is darker
    the more of them reach a height.

    Parameters
    ----------
    axes, threshold, suggested, title
        As for `draw_histogram`.
    values : array (n,)
        Bits; NaN has no bar.
    """
    per_column = max(-(-len(values) // _COLUMNS), 1)
    x_label = "image, in the order of the table"
    if per_column > 1:
        x_label += f" ({per_column:,} to a column, the darker the more of them reach there)"
    dress(axes, title, x_label, "entropy, bits")
    axes.axhline(threshold, color=VERMILION, linewidth=2.2, label=f"threshold {threshold:g} bits")
    if suggested is not None:
        axes.axhline(suggested, color=BLACK, linewidth=1.5, linestyle=":", label=_suggestion(suggested))
    known = values[~np.isnan(values)]
    low = int((known < threshold).sum())
    labels = _count_label("rejected", low, len(known)), _count_label("kept", len(known) - low, len(known))
    for kept, colour, label in zip((False, True), (_REJECTED, _KEPT), labels):
        if per_column > 1:
            axes.bar([0.0], [0.0], color=colour, label=label)
        else:
            _draw_bars(axes, np.where((values >= threshold) == kept, values, np.nan), colour, label)
    if per_column > 1:
        shades = _shades(values, threshold, per_column)
        extent = (0.0, float(shades.shape[1] * per_column), 0.0, HIGHEST_ENTROPY)
        axes.imshow(shades, extent=extent, origin="lower", aspect="auto", interpolation="nearest", zorder=1.0)
    axes.set_xlim(0.0, max(len(values), 1))
    axes.set_ylim(0.0, HIGHEST_ENTROPY)
    axes.xaxis.set_major_formatter(lambda value, _position: f"{value:,.0f}")
    axes.xaxis.get_major_locator().set_params(integer=True)
    _draw_legend(axes)


def save_figures(folder: str | os.PathLike[str], target: str | os.PathLike[str], threshold: float) -> list[Path]:
    """Write both figures of each map type of a dataset as PNG, replacing those of earlier runs.

    They show the deciding entropies (see `deciding_entropies`): what cleaning at this threshold rejects and keeps.

    Parameters
    ----------
    folder : path
        Dataset, which is only read.
    target : path
        Folder of the figures; made if it does not exist.
    threshold : float
        Bits.

    Raises
    ------
    InvalidInput
        The folder is not a dataset.
    OutputError
        The figures cannot be written, or matplotlib is not installed.
    """
    check_matplotlib()
    drawn = draw_all(deciding_entropies(folder), target, threshold)
    return [path for paths in drawn.values() for path in paths]


def draw_all(
    deciding: Mapping[str, Deciding], target: str | os.PathLike[str], threshold: float
) -> dict[str, list[Path]]:
    """Write both figures of each map type that has images; returns their paths by map type."""
    drawn = {}
    for map_type, one in deciding.items():
        made = one.entropies[one.made]
        if not len(made):
            continue
        title = f"{map_type}: {len(made):,} images by {_describe_source(one)}"
        paths = []
        for name, draw in (("histogram", draw_histogram), ("bars", draw_bars)):
            figure = new_figure(10.0, 5.0)
            draw(figure.add_subplot(), one.entropies, threshold, suggested=otsu(made), title=title)
            make_folder(target)
            path = Path(target) / f"entropy-{name}-{map_type}.png"
            write_whole(path, png(figure))
            paths.append(path)
        drawn[map_type] = paths
    return drawn


def _describe_source(deciding: Deciding) -> str:
    by_roadmap, made = int(deciding.by_roadmap.sum()), int(deciding.made.sum())
    if by_roadmap == 0:
        return "their entropies"
    if by_roadmap == made:
        return "the entropies of the roadmap"
    return f"the entropies of the roadmap, {made - by_roadmap:,} by their own"


def _count_label(what: str, count: int, total: int) -> str:
    return f"{what}: {count:,}" + (f" ({count / total:.1%})" if total else "")


def _suggestion(suggested: float) -> str:
    return f"Otsu's method: {suggested:.2f} bits"


def _draw_legend(axes: Any) -> None:
    """Draw the legend below the axes, where it covers nothing."""
    axes.legend(fontsize=FONT["note"], frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=4)


def _draw_bars(axes: Any, heights: Floats, colour: str, label: str) -> None:
    """Draw bars of one colour as a single shape, which is fast; NaN has no bar."""
    # Wide bars have gaps.
    margin = 0.1 if len(heights) <= 150 else 0.0
    left = np.arange(len(heights)) + margin
    right, tops, feet = left + 1.0 - 2.0 * margin, np.nan_to_num(heights), np.zeros(len(heights))
    x = np.stack([left, left, right, right], axis=1).ravel()
    y = np.stack([feet, tops, tops, feet], axis=1).ravel()
    axes.fill_between(x, y, color=colour, linewidth=0.0, label=label)


def _shades(values: Floats, threshold: float, per_column: int) -> Floats:
    """Colours (rows, columns, 3) of bars that share columns, each covering an equal part of its column.

    Rows go up from 0 to 8 bits; red, green and blue are from 0 to 1.
    """
    columns = np.arange(len(values)) // per_column
    images = np.bincount(columns)
    shape = len(images), _ROWS + 1
    rows = np.rint(np.nan_to_num(values) * (_ROWS / HIGHEST_ENTROPY)).astype(np.int64)
    shades = np.ones((_ROWS, shape[0], 3))
    for which, colour in ((values < threshold, _REJECTED), (values >= threshold, _KEPT)):
        tops = np.bincount(columns[which] * shape[1] + rows[which], minlength=shape[0] * shape[1])
        # A bar covers every row below its top.
        reaching = np.cumsum(tops.reshape(shape)[:, ::-1], axis=1)[:, ::-1][:, 1:].T / images
        red_green_blue = np.array([int(colour[at : at + 2], 16) for at in (1, 3, 5)]) / 255.0
        shades += reaching[..., np.newaxis] * (red_green_blue - 1.0)
    return shades
