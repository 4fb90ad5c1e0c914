"""Self-contained HTML pages: elements, tables, figures, and one style sheet."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from html import escape
from typing import Union


class Markup(str):
    """HTML written by this module; all other text is escaped."""

    __slots__ = ()


Content = Union[str, Markup]


def element(name: str, *content: Content, **attributes: str) -> Markup:
    """Write an element; trailing underscores of attribute names, as in ``class_``, are dropped."""
    marks = "".join(f' {key.rstrip("_").replace("_", "-")}="{escape(value)}"' for key, value in attributes.items())
    # These elements are void: they have neither content nor an end tag.
    if name in ("img", "meta", "link", "br"):
        return Markup(f"<{name}{marks}>")
    inside = "".join(part if isinstance(part, Markup) else escape(part) for part in content)
    return Markup(f"<{name}{marks}>{inside}</{name}>")


def table(header: Sequence[str], rows: Iterable[Sequence[str]], chosen: Container[int] = ()) -> Markup:
    """Write a table with its chosen rows marked."""
    head = element("tr", *(element("th", text, scope="col") for text in header))
    body = []
    for index, row in enumerate(rows):
        # Do not wrap short cells.
        cells = (element("td", text, class_="short") if len(text) <= 18 else element("td", text) for text in row)
        body.append(element("tr", *cells, class_="chosen") if index in chosen else element("tr", *cells))
    return element("div", element("table", element("thead", head), element("tbody", *body)), class_="scroll")


def pairs(found: list[tuple[str, str]]) -> Markup:
    """Write a list of labels and values."""
    return element("dl", *(Markup(element("dt", label) + element("dd", value)) for label, value in found))


def figure(source: str, description: str, caption: str) -> Markup:
    """Write a picture with its caption."""
    return element("figure", element("img", src=source, alt=description), element("figcaption", caption))


def document(title: str, *content: Content) -> str:
    """Write a self-contained document."""
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", name_="viewport", content="width=device-width, initial-scale=1"),
        element("meta", name_="color-scheme", content="light dark"),
        element("title", title),
        # Do not escape the style sheet, as browsers do not unescape it.
        element("style", Markup(_STYLE)),
    )
    body = element("body", element("main", *content))
    return f"<!DOCTYPE html>\n{element('html', head, body, lang='en')}\n"


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
