"""Scores as files: figures as JSON, errors of each query as CSV and GeoJSON, diagrams, and a page."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from ..arrays import Floats, NDArray
from ..dataset.dataset import open_image
from ..external.drawing import (
    BLACK,
    BLUE,
    FONT,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    dress,
    logarithmic,
    new_figure,
    png,
    short_label,
)
from ..storage.files import json_bytes, make_folder, write_whole
from ..text.markup import Markup, document, element, figure, pairs, table
from ..text.plain import shortened
from .folder import Benchmark
from .scoring import ALL, Errors, Figure, Scores

PAGE, FIGURES_FILE, ERRORS_FILE, MAP_FILE = "index.html", "scores.json", "errors.csv", "errors.geojson"
RECALL, WITHIN, MAP, FAILURES = "recall.png", "within.png", "map.png", "failures.png"
_COLOURS = (BLUE, VERMILION, GREEN, ORANGE, SKY, PURPLE)
#: Range of the diagram's axis of errors, metres.
_LEAST_M, _GREATEST_M = 0.1, 10_000.0
#: Side of cut-outs of the mosaic in the diagram of failures.
_CUT_PX = 300


def write_scores(
    benchmark: Benchmark,
    scores: Scores,
    folder: str | os.PathLike[str],
    title: str,
    *,
    diagrams: bool = True,
) -> Path:
    """Write figures, errors, diagrams and a page into a folder; returns the page, which is written last.

    Parameters
    ----------
    diagrams : bool
        Whether to draw diagrams, which needs matplotlib.

    Raises
    ------
    OutputError
        The folder cannot be written, or matplotlib is needed and not installed.
    """
    target = Path(folder)
    errors = scores.errors
    headline = f"{title}, part {scores.part}" if scores.part else title
    drawn: dict[str, bytes] = {}
    if diagrams and scores.recall:
        drawn[RECALL] = _recall(scores.recall, headline)
    if diagrams and np.isfinite(errors.error_m).any():
        drawn[WITHIN] = _draw_shares(errors, headline)
        drawn[MAP] = _map(benchmark, errors, headline)
        drawn[FAILURES] = _failures(benchmark, errors, headline)
    make_folder(target)
    write_whole(target / FIGURES_FILE, json_bytes(scores_document(scores, title)))
    errors.write(target / ERRORS_FILE)
    write_whole(target / MAP_FILE, json_bytes(_geojson(errors)))
    for name, data in drawn.items():
        write_whole(target / name, data)
    text = _page(benchmark, scores, headline, set(drawn))
    write_whole(target / PAGE, text.encode("utf-8"))
    return target / PAGE


def scores_document(scores: Scores, title: str) -> dict[str, Any]:
    """Figures as JSON-ready values; NaN becomes null."""
    return {
        "method": title,
        "part": scores.part or ALL,
        "tiles": scores.tiles,
        "groups": figures_document(scores.groups),
    }


def figures_document(groups: Mapping[str, Sequence[Figure]]) -> dict[str, Any]:
    """Figures of groups as JSON-ready values; NaN becomes null."""
    return {
        name: [{**one._asdict(), "value": one.value if math.isfinite(one.value) else None} for one in figures]
        for name, figures in groups.items()
    }


def value_text(one: Figure) -> str:
    """Value of a figure as text: shares in per cent, numbers with units to three digits."""
    if not math.isfinite(one.value):
        return "–"
    if one.name in ("queries", "frames"):
        return f"{one.value:,.0f}"
    if one.unit:
        return f"{one.value:.3g} {one.unit}" if one.value < 1000.0 else f"{one.value:,.0f} {one.unit}"
    return f"{100.0 * one.value:.1f} %" if _is_share(one) else f"{one.value:.3f}"


def _is_share(one: Figure) -> bool:
    return one.name.startswith(("recall", "within", "AP", "mask"))


def figure_rows(groups: Mapping[str, Sequence[Figure]]) -> list[tuple[str, ...]]:
    """Rows of a table: name of a figure, its value in each group, its definition."""
    names: dict[str, Figure] = {}
    for figures in groups.values():
        for one in figures:
            names.setdefault(one.name, one)
    by_name = {group: {one.name: one for one in figures} for group, figures in groups.items()}
    return [
        (
            name,
            *(value_text(found[name]) if name in found else "–" for found in by_name.values()),
            one.definition,
        )
        for name, one in names.items()
    ]


def _geojson(errors: Errors) -> dict[str, Any]:
    """Positions of queries, with errors as properties."""
    features, has_masks = [], bool(np.isfinite(errors.mask_iou).any())
    for at, name in enumerate(errors.query):
        values = {
            "error_m": errors.error_m[at],
            "error_deg": errors.error_deg[at],
            "rank": errors.rank[at],
            "predicted_lat_deg": errors.predicted_lat_deg[at],
            "predicted_lon_deg": errors.predicted_lon_deg[at],
            **({"mask_iou": errors.mask_iou[at]} if has_masks else {}),
        }
        known = {key: float(value) if math.isfinite(value) else None for key, value in values.items()}
        place = [float(errors.lon_deg[at]), float(errors.lat_deg[at])]
        features.append(
            {
                "type": "Feature",
                "geometry": {"type": "Point", "coordinates": place},
                "properties": {"query": name, "imagery": errors.imagery[at], **known},
            }
        )
    return {"type": "FeatureCollection", "features": features}


def _recall(recall: Mapping[str, Floats], title: str) -> bytes:
    drawing = new_figure(8.0, 4.6)
    axes = drawing.add_subplot()
    colours = _colours(name for name in recall if name != ALL)
    for name, shares in recall.items():
        ranks = np.arange(1, len(shares) + 1)
        colour = colours.get(name, BLACK)
        axes.step(ranks, 100.0 * shares, where="post", color=colour, linewidth=1.8, label=short_label(name))
    axes.set_ylim(0.0, 103.0)
    dress(axes, f"Queries with a right tile among the first, {title}", "first tiles", "queries in %")
    axes.legend(frameon=False, fontsize=FONT["note"])
    return png(drawing)


def _draw_shares(errors: Errors, title: str) -> bytes:
    drawing = new_figure(8.0, 4.6)
    axes = drawing.add_subplot()
    for name, colour in _colours(errors.imagery).items():
        values = errors.error_m[_rows(errors, name)]
        known = np.sort(np.clip(values[np.isfinite(values)], _LEAST_M, None))
        share = 100.0 * np.arange(1, len(known) + 1) / len(values)
        ends = [_LEAST_M, *known, _GREATEST_M], [0.0, *share, share[-1] if len(share) else 0.0]
        axes.step(*ends, where="post", color=colour, linewidth=1.8, label=short_label(name))
    logarithmic(axes, "x")
    axes.set_xlim(_LEAST_M, _GREATEST_M)
    axes.set_ylim(0.0, 103.0)
    dress(axes, f"Queries found within an error, {title}", "error along the ground in m", "queries in %")
    axes.legend(frameon=False, fontsize=FONT["note"])
    return png(drawing)


def _colours(names: Iterable[str]) -> dict[str, str]:
    """Colour of each imagery, the same in all diagrams."""
    return dict(zip(dict.fromkeys(names), cycle(_COLOURS)))


def _rows(errors: Errors, imagery: str) -> NDArray[np.intp]:
    """Rows of the queries of an imagery."""
    return np.flatnonzero([one == imagery for one in errors.imagery])


def _map(benchmark: Benchmark, errors: Errors, title: str) -> bytes:
    """Positions of queries over the reference, coloured by error; a map for each imagery."""
    mosaic = benchmark.mosaic
    grey = Image.fromarray(benchmark.grey(mosaic.file))
    ground = np.asarray(grey.reduce(max(max(grey.size) // 1200, 1)))
    x, y = mosaic.px(errors.lat_deg, errors.lon_deg)
    names = list(dict.fromkeys(errors.imagery))
    across = min(len(names), 3)
    down = -(-len(names) // across)
    shape = min(max(grey.height / grey.width, 0.4), 1.4)
    drawing = new_figure(4.6 * across + 0.2, (4.6 * shape + 0.4) * down + 0.8)
    drawing.suptitle(f"Where queries were taken, by error, {title}", fontsize=FONT["title"])
    bounds, shades = (0.0, 5.0, 20.0, 100.0, math.inf), (BLUE, SKY, ORANGE, VERMILION)
    for at, name in enumerate(names):
        axes = drawing.add_subplot(down, across, at + 1)
        size = (0.0, mosaic.width_px, mosaic.height_px, 0.0)
        axes.imshow(ground, cmap="gray", extent=size, alpha=0.55, vmin=0, vmax=255)
        rows = _rows(errors, name)
        for low, high, colour in zip(bounds, bounds[1:], shades):
            some = rows[(errors.error_m[rows] >= low) & (errors.error_m[rows] < high)]
            label = f"up to {high:g} m" if math.isfinite(high) else f"farther than {low:g} m"
            axes.scatter(x[some], y[some], s=28, color=colour, edgecolors="white", linewidths=0.6, label=label)
        some = rows[~np.isfinite(errors.error_m[rows])]
        axes.scatter(x[some], y[some], s=22, color=BLACK, marker="x", linewidths=1.2, label="no answer")
        axes.set_title(short_label(name), fontsize=FONT["label"], loc="left")
        axes.set_xticks([])
        axes.set_yticks([])
    handles, labels = axes.get_legend_handles_labels()
    drawing.legend(handles, labels, loc="lower center", ncol=5, fontsize=FONT["note"], frameon=False)
    return png(drawing)


def _failures(benchmark: Benchmark, errors: Errors, title: str) -> bytes:
    """The four queries with the largest errors, each beside the reference at its true and predicted position."""
    known = np.flatnonzero(np.isfinite(errors.error_m))
    worst = known[np.argsort(-errors.error_m[known], kind="stable")][:4]
    whole = Image.fromarray(benchmark.colours(benchmark.mosaic.file))
    drawing = new_figure(7.6, 2.75 * len(worst) + 0.6)
    drawing.suptitle(f"Farthest off, {title}", fontsize=FONT["title"])
    for row, at in enumerate(worst.tolist()):
        index = benchmark.query_rows[errors.query[at]]
        query, side_m = _north_up(benchmark, index)
        centre = benchmark.queries.centre_lat_deg[index], benchmark.queries.centre_lon_deg[index]
        # Shift the true image centre by the error of the camera's position.
        moved = (
            centre[0] + float(errors.predicted_lat_deg[at] - errors.lat_deg[at]),
            centre[1] + float(errors.predicted_lon_deg[at] - errors.lon_deg[at]),
        )
        shown = (
            # Titles of up to 40 characters fit over a picture.
            (query, f"{short_label(shortened(errors.query[at], 40))}\nnorth up"),
            (_cut_out(whole, benchmark, centre, side_m), "reference where it was taken"),
            (_cut_out(whole, benchmark, moved, side_m), f"at the answer, {errors.error_m[at]:,.0f} m off"),
        )
        for column, (picture, title) in enumerate(shown):
            axes = drawing.add_subplot(len(worst), len(shown), row * len(shown) + column + 1)
            axes.imshow(picture)
            axes.set_title(title, fontsize=7)
            axes.set_axis_off()
    return png(drawing)


def _north_up(benchmark: Benchmark, index: int) -> tuple[Image.Image, float]:
    """A query rotated to north up and padded to a square, and the approximate width of the square in metres."""
    queries = benchmark.queries
    picture = open_image(benchmark.folder / queries.file[index], as_shown=True).convert("RGB")
    turned = picture.rotate(-float(queries.yaw_deg[index]), Image.BILINEAR, expand=True, fillcolor="white")
    side = max(turned.size)
    square = Image.new("RGB", (side, side), "white")
    square.paste(turned, ((side - turned.width) // 2, (side - turned.height) // 2))
    above_m = queries.height_m[index] - queries.ground_m[index]
    return square, float(side / queries.fx_px[index] * above_m)


def _cut_out(whole: Image.Image, benchmark: Benchmark, place: tuple[float, float], side_m: float) -> Image.Image:
    """Square of the mosaic around a position; black outside the mosaic."""
    mosaic = benchmark.mosaic
    lat, lon = place
    x, y = (float(value) for value in mosaic.px(np.array(lat), np.array(lon)))
    # Derive the size of a pixel from the latitude 100 px farther north; a degree has 111,195 m on average.
    farther_lat, _ = mosaic.ground(np.array(x), np.array(y - 100.0))
    half = side_m / 2.0 * 100.0 / max(abs(float(farther_lat) - lat) * 111_195.0, 1e-6)
    # Larger cut-outs would take memory and show nothing more.
    half = min(half, 2.0 * max(whole.size))
    if not (-half < x < whole.width + half and -half < y < whole.height + half):
        return Image.new("RGB", (_CUT_PX, _CUT_PX))
    box = round(x - half), round(y - half), round(x + half), round(y + half)
    return whole.crop(box).resize((_CUT_PX, _CUT_PX), Image.BILINEAR)


def _page(benchmark: Benchmark, scores: Scores, title: str, drawn: set[str]) -> str:
    settings = benchmark.about
    groups = {"all" if name == ALL else name: figures for name, figures in scores.groups.items()}
    facts = [
        ("Reference", str(settings.get("reference", ""))),
        ("Queries", ", ".join(map(str, named if isinstance(named := settings.get("imageries"), list) else ()))),
        ("Tiles", f"{scores.tiles:,}"),
        ("Split", str(settings.get("split", ""))),
    ]
    if benchmark.has_buildings:
        named = settings.get("reference_buildings")
        facts.insert(1, ("Buildings", ", ".join(map(str, named if isinstance(named, list) else ()))))
    captions = {
        RECALL: "Share of queries that have a right tile among the first so many.",
        WITHIN: "Share of all queries whose camera is found within an error; queries without an answer count.",
        MAP: "The reference, and where queries were taken.",
        FAILURES: "The queries that are farthest off.",
    }
    sections: list[Markup] = [
        element("p", "TerrAInav: benchmark", class_="kicker"),
        element("h1", title),
        pairs(facts),
        element("h2", "Figures"),
        table(("", *groups, "what it is"), figure_rows(groups)),
    ]
    for name, caption in captions.items():
        if name in drawn:
            sections.append(figure(name, caption, caption))
    files = (FIGURES_FILE, ERRORS_FILE, MAP_FILE)
    sections += [
        element("h2", "The numbers"),
        element("ul", *(element("li", element("a", name, href=name)) for name in files)),
    ]
    return document(f"{title}: benchmark", *sections)
