"""The report of a mission: a page with its diagrams, and the numbers behind them."""

from __future__ import annotations

import os
from html import escape
from pathlib import Path
from typing import Union

from ..drawing import check_matplotlib
from ..errors import Message
from ..files import make_folder, write_whole
from ..imagery.source import Source
from ..mission.plan import Plan
from . import plots, sentences
from .machine import machine, versions
from .measure import Measurement, Progress, measure
from .tables import (
    Table,
    air_table,
    choices_table,
    csv_files,
    displacement_table,
    encodings_table,
    kernels_table,
    methods_table,
    savings_table,
)
from .wind import WindEffect

PAGE = "index.html"
WORK_PRECISION, RESAMPLING = "work-precision.png", "resampling.png"


def write_report(
    plan: Plan,
    source: Source,
    folder: str | os.PathLike[str],
    *,
    progress: Progress | None = None,
    quick: bool = False,
) -> Path:
    """Measure a mission's methods on its own captures and write a page about them.

    Parameters
    ----------
    source : Source
        That the plan is for.
    folder : path
        Made unless it is there; files of an earlier report are replaced.
    progress : callable, optional
        Called with what is being measured, in words.
    quick : bool
        Time every method in one round only; times are then not compared.

    Returns
    -------
    Path
        Of the page, which is written last: where it is there, all of the report is.

    Raises
    ------
    OutputError
        The folder cannot be written, or matplotlib is not installed.
    PartError, SourceError
        No picture can be had from the source.
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
    """Return the diagrams of a measurement as PNG, by the file's name."""
    drawn = {
        WORK_PRECISION: plots.work_precision(
            found.stages, plan.accuracy.budget_px, found.floor_px, sentences.mission_title(plan)
        )
    }
    if found.resampling is not None:
        drawn[RESAMPLING] = plots.resampling(found.resampling)
    return drawn


class Markup(str):
    """HTML that was made here; any other text is escaped before it goes into a page."""

    __slots__ = ()


Content = Union[str, Markup]


#: Elements without an end.
_VOID = ("img", "meta", "link", "br")


#: Cells of so many characters are not broken into lines.
_SHORT = 18


def element(name: str, *content: Content, **attributes: str) -> Markup:
    """Return an element; a trailing underscore of an attribute's name, as in ``class_``, is dropped."""
    marks = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape(value)}"' for key, value in attributes.items()
    )
    if name in _VOID:
        return Markup(f"<{name}{marks}>")
    inside = "".join(part if isinstance(part, Markup) else escape(part) for part in content)
    return Markup(f"<{name}{marks}>{inside}</{name}>")


def table(found: Table) -> Markup:
    """Return a table, its chosen rows marked."""
    head = element("tr", *(element("th", text, scope="col") for text in found.header))
    rows = []
    for index, row in enumerate(found.rows):
        cells = (
            element("td", text, class_="short") if len(text) <= _SHORT else element("td", text)
            for text in row
        )
        rows.append(
            element("tr", *cells, class_="chosen") if index in found.chosen else element("tr", *cells)
        )
    return element("div", element("table", element("thead", head), element("tbody", *rows)), class_="scroll")


def pairs(found: list[tuple[str, str]]) -> Markup:
    """Return a list of labels and values."""
    return element("dl", *(Markup(element("dt", label) + element("dd", value)) for label, value in found))


def figure(source: str, description: str, caption: str) -> Markup:
    """Return a picture with its caption."""
    return element("figure", element("img", src=source, alt=description), element("figcaption", caption))


def document(title: str, style: str, *content: Content) -> str:
    """Return a whole document that needs nothing from elsewhere."""
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", name_="viewport", content="width=device-width, initial-scale=1"),
        element("meta", name_="color-scheme", content="light dark"),
        element("title", title),
        # The style is the project's own: it is not escaped, as a browser does not undo that there.
        element("style", Markup(style)),
    )
    body = element("body", element("main", *content))
    return f"<!DOCTYPE html>\n{element('html', head, body, lang='en')}\n"


def _page(plan: Plan, source: Source, found: Measurement, csv_names: list[str]) -> str:
    kept, sentence = sentences.verdict(plan, found)
    sections = [
        element("p", "TerrAInav: error against run time", class_="kicker"),
        element("h1", sentences.mission_title(plan)),
        element("p", sentence, class_="verdict kept" if kept else "verdict broken"),
        _section("The mission", pairs(sentences.mission_facts(plan, source, found.map_type))),
        *([_section("What the wind does", *_wind(found.wind))] if found.wind is not None else []),
        _section(
            "What was chosen",
            element(
                "p",
                "Every stage takes the cheapest method whose bound, together with the others', fits the "
                "error budget. Bounds are worked out before anything is computed; they hold for all of the "
                "mission's captures.",
            ),
            table(choices_table(plan, found)),
        ),
        _section("Error against run time", *_work_precision(plan, found)),
        _section("What was left out, and what that saves", *_left_out(plan, found)),
        _section("What is not in the bounds", *_conditioning(plan)),
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
    return document(f"{sentences.mission_title(plan)}: error against run time", _STYLE, *sections)


def _section(title: str, *content: Content) -> Markup:
    return element("section", element("h2", title), *content)


def _work_precision(plan: Plan, found: Measurement) -> list[Markup]:
    content = [
        figure(
            WORK_PRECISION,
            "Diagram: error in px against seconds a capture, one line for each stage through its methods",
            sentences.DIAGRAM,
        ),
        table(methods_table(found)),
    ]
    rejected = plan.accuracy.picture.rejected
    if rejected is not None and not rejected.outside:
        content.append(
            element(
                "p",
                "Errors and bounds of the map frame are given here in pixels of the planned picture; where it was "
                "rejected, in pixels of the map frame that would have been, which is smaller.",
                class_="note",
            )
        )
    return content


def _left_out(plan: Plan, found: Measurement) -> list[Markup]:
    if not found.left_out:
        return [element("p", "Nothing: this mission needs everything there is.")]
    pictures = len(plan) * len(plan.mission.imagery.map_types)
    lead = (
        f"For the whole mission, {pictures:,} picture{'s' if pictures > 1 else ''}, on one core: what the "
        "left-out method takes beyond the chosen one, both measured here."
    )
    return [
        element("p", lead),
        table(savings_table(found.left_out)),
        *(element("p", note, class_="note") for note in sentences.saving_notes(plan, found)),
    ]


def _conditioning(plan: Plan) -> list[Markup]:
    accuracy = plan.accuracy
    return [
        element("h3", "Condition number of the scene"),
        element("p", sentences.condition_text(accuracy.condition)),
        element("h3", "Terrain"),
        element("p", sentences.terrain_text(accuracy.terrain_px_per_m, accuracy.relief)),
    ]


def _greys(plan: Plan, found: Measurement) -> list[Markup]:
    content = []
    if found.resampling is not None:
        used = "none" if plan.size_px is None else plan.mission.accuracy.resampling
        content += [
            element(
                "p",
                "What resampling does to the picture is not a matter of position and not in the bounds. "
                "Errors are RMS over points between the source's pixels, of 255 grey levels, against "
                f"{found.resampling.truth}.",
            ),
            figure(
                RESAMPLING,
                "Diagram: RMS grey levels of error against spatial frequency, one line for each kernel",
                "Error of each kernel in bands of spatial frequency; the grey area is the picture's own "
                "detail there. Where a line meets it, that detail is lost.",
            ),
            table(kernels_table(found.kernels, found.resampling, used)),
        ]
    content += [
        element("p", "What each kind of file keeps of one picture of this mission, beside its size:"),
        table(encodings_table(found.encodings)),
    ]
    return content


def _wind(effect: WindEffect) -> list[Markup]:
    return [
        *(element("p", text) for text in sentences.wind_effect_text(effect)),
        *([table(displacement_table(effect))] if effect.displacements else []),
        table(air_table(effect)),
        *(element("p", note, class_="note") for note in sentences.wind_notes(effect)),
    ]


_STYLE = """
:root { --ink: #1b1f24; --soft: #59636e; --paper: #ffffff; --rule: #d8dee4; --tint: #f3f6f9; --mark: #e3effa;
  --good: #1a7f4b; --bad: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ec; --soft: #9aa5b1; --paper: #14181d; --rule: #313943; --tint: #1c222a; --mark: #16324a;
    --good: #5fd49a; --bad: #ff8a80; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "Noto Sans", "DejaVu Sans", sans-serif; }
main { max-width: 62rem; margin: 0 auto; padding: 2.5rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 1rem; font-weight: 650; }
h2 { font-size: 1.25rem; margin: 2.75rem 0 .6rem; padding-top: 1rem; border-top: 1px solid var(--rule); }
h3 { font-size: 1rem; margin: 1.2rem 0 .2rem; }
p, ul { max-width: 46rem; margin: .4rem 0 .9rem; }
ul { padding-left: 1.2rem; }
.kicker { color: var(--soft); letter-spacing: .04em; margin: 0 0 .3rem; }
.note, figcaption { color: var(--soft); font-size: .9rem; }
.verdict { border-left: 4px solid var(--good); background: var(--tint); padding: .8rem 1rem; max-width: none; }
.verdict.broken { border-color: var(--bad); }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .3rem 1.4rem; margin: .6rem 0; }
dt { color: var(--soft); }
dd { margin: 0; }
.scroll { overflow-x: auto; margin: .8rem 0; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .4rem .7rem .4rem .5rem;
  border-bottom: 1px solid var(--rule); }
td.short { white-space: nowrap; }
th { font-weight: 600; color: var(--soft); }
tr.chosen td { background: var(--mark); }
figure { margin: 1.2rem 0; }
img { display: block; width: 100%; height: auto; background: #fff; padding: .6rem; border: 1px solid var(--rule);
  border-radius: 6px; }
figcaption { margin-top: .5rem; max-width: 46rem; }
a { color: inherit; }
"""
