"""HTML out of text: everything is escaped unless it was made here."""

from __future__ import annotations

from html import escape
from typing import Union

from .tables import Table


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


def page(title: str, style: str, *content: Content) -> str:
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
