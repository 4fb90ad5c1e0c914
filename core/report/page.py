"""The report of a mission: a page with its diagrams, and the numbers behind them."""

from __future__ import annotations

import os
from pathlib import Path

from ..errors import Message
from ..external.drawing import check_matplotlib
from ..imagery.source import Source
from ..mission.plan import Plan
from ..storage.files import make_folder, write_whole
from ..text.markup import Content, Markup, document, element, figure, pairs, table
from . import plots, sentences
from .conditioning import conditioning
from .machine import machine, versions
from .measure import Measurement, Progress, measure
from .tables import (
    air_table,
    choices_table,
    csv_files,
    displacement_table,
    encodings_table,
    kernels_table,
    methods_table,
    pipelines_table,
    savings_table,
)
from .wind import WindEffect

PAGE = "index.html"
WORK_PRECISION, DISTRIBUTIONS = "work-precision.png", "errors.png"
CONDITIONING, RESAMPLING = "conditioning.png", "resampling.png"


def write_report(
    plan: Plan,
    source: Source,
    folder: str | os.PathLike[str],
    *,
    progress: Progress | None = None,
    quick: bool = False,
) -> Path:
    """Measure the methods of a mission on its captures and write a page about them.

    Parameters
    ----------
    source : Source
        Source of the plan.
    folder : path
        Created if missing; files of an earlier report are replaced.
    progress : callable, optional
        Called with the name of each step.
    quick : bool
        Time every method in a single round; times are then not compared.

    Returns
    -------
    Path
        The page, which is written last: if it exists, the report is complete.

    Raises
    ------
    OutputError
        The folder cannot be written, or matplotlib is not installed.
    PartError, SourceError
        No picture can be made from the source.
    """
    check_matplotlib()
    make_folder(folder)
    found = measure(plan, source, quick=quick, progress=progress)
    if progress is not None:
        progress(Message("page"))
    files = {**csv_files(found), **drawings(plan, found)}
    text = _page(plan, source, found, sorted(name for name in files if name.endswith(".csv")))
    for name, data in files.items():
        write_whole(Path(folder) / name, data)
    target = Path(folder) / PAGE
    write_whole(target, text.encode("utf-8"))
    return target


def drawings(plan: Plan, found: Measurement) -> dict[str, bytes]:
    """Draw the diagrams of a measurement; returns PNG by file name."""
    drawn = {
        WORK_PRECISION: plots.work_precision(found, plan.accuracy.budget_px, sentences.mission_title(plan)),
        DISTRIBUTIONS: plots.distributions(found),
        CONDITIONING: plots.conditioning(conditioning(plan)),
    }
    if found.resampling is not None:
        drawn[RESAMPLING] = plots.resampling(found, found.resampling)
    return drawn


def _page(plan: Plan, source: Source, found: Measurement, csv_names: list[str]) -> str:
    kept, sentence = sentences.verdict(plan, found)
    sections = [
        element("p", "TerrAInav: error against run time", class_="kicker"),
        element("h1", sentences.mission_title(plan)),
        element("p", sentence, class_="verdict kept" if kept else "verdict broken"),
        _section("The mission", pairs(sentences.mission_facts(plan, source, found.map_type))),
        *([_section("Effect of the wind", *_wind(found.wind))] if found.wind is not None else []),
        _section(
            "Chosen methods",
            element(
                "p",
                "Every stage uses the cheapest method whose bound, added to the others', fits the error budget. "
                "Bounds are known before anything is computed, and hold for all captures of the mission.",
            ),
            table(*choices_table(plan, found)),
        ),
        _section("Error against run time", *_work_precision(plan, found)),
        _section("Left out, and time saved", *_left_out(plan, found)),
        _section("Not in the bounds", *_conditioning(plan)),
        _section("Grey levels", *_greys(plan, found)),
    ]
    sections += [
        _section(
            "How it was measured",
            element("ul", *(element("li", text) for text in sentences.how_measured(found))),
            pairs([*machine(), *versions()]),
        ),
        _section(
            "The numbers",
            element("ul", *(element("li", element("a", name, href=name)) for name in csv_names)),
        ),
    ]
    return document(f"{sentences.mission_title(plan)}: error against run time", *sections)


def _section(title: str, *content: Content) -> Markup:
    return element("section", element("h2", title), *content)


def _work_precision(plan: Plan, found: Measurement) -> list[Markup]:
    content = [
        figure(
            WORK_PRECISION,
            "Diagram: error in px against seconds per capture, a panel for each stage and one for whole images",
            sentences.DIAGRAM,
        ),
        table(*methods_table(found)),
        figure(
            DISTRIBUTIONS,
            "Diagram: share of points against error in px, a panel for each stage",
            sentences.DISTRIBUTIONS,
        ),
        element("h3", "Whole images"),
        element("p", sentences.PIPELINES),
        table(*pipelines_table(found)),
    ]
    rejected = plan.accuracy.picture.rejected
    if rejected is not None and not rejected.outside:
        content.append(
            element(
                "p",
                "Errors and bounds of the map frame are given here in pixels of the planned image; in the reason of "
                "its rejection, in pixels of the rejected map frame, which is smaller.",
                class_="note",
            )
        )
    return content


def _left_out(plan: Plan, found: Measurement) -> list[Markup]:
    if not found.left_out:
        return [element("p", "Nothing: this mission needs every stage.")]
    pictures = len(plan) * len(plan.mission.imagery.map_types)
    lead = (
        f"For the whole mission, {pictures:,} image{'s' if pictures > 1 else ''}, on one core: the extra "
        "cost of the omitted method over the chosen one, both measured here."
    )
    return [
        element("p", lead),
        table(*savings_table(found.left_out)),
        *(element("p", note, class_="note") for note in sentences.saving_notes(plan, found)),
    ]


def _conditioning(plan: Plan) -> list[Markup]:
    accuracy = plan.accuracy
    return [
        element("h3", "Condition number of the scene"),
        element("p", sentences.condition_text(accuracy.condition)),
        figure(
            CONDITIONING,
            "Diagram: condition number against tilt and against height",
            sentences.CONDITIONING,
        ),
        element("h3", "Terrain"),
        element("p", sentences.terrain_text(accuracy.terrain_px_per_m, accuracy.relief)),
    ]


def _greys(plan: Plan, found: Measurement) -> list[Markup]:
    content = []
    if found.resampling is not None:
        used = plan.frames.kernel(plan.mission)
        content += [
            element(
                "p",
                "Resampling affects grey levels, not positions, and is not in the bounds. "
                "Errors are RMS over points between the source's pixels, of 255 grey levels, against "
                f"{found.resampling.truth}.",
            ),
            figure(
                RESAMPLING,
                "Diagrams: RMS grey levels of error against spatial frequency, and seconds against RMS grey levels",
                "Left: error of each kernel in bands of spatial frequency; the grey area is the detail of the image "
                "in each band. Where a line meets it, that detail is lost. Right: kernels and file formats against "
                "their time.",
            ),
            table(*kernels_table(found.kernels, found.resampling, used)),
        ]
    content += [
        element("p", "Error and size of each file format, for one image of this mission:"),
        table(*encodings_table(found.encodings)),
    ]
    return content


def _wind(effect: WindEffect) -> list[Markup]:
    return [
        *(element("p", text) for text in sentences.wind_effect_text(effect)),
        *([table(*displacement_table(effect))] if effect.displacements else []),
        table(*air_table(effect)),
        *(element("p", note, class_="note") for note in sentences.wind_notes(effect)),
    ]
