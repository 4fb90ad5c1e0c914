"""Text of others, shown as it is: Qt takes whatever looks like HTML for that, and opens the files it names."""

from __future__ import annotations

import html

from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import QLabel, QWidget


def plain_label(text: str = "", parent: QWidget | None = None) -> QLabel:
    """Label that shows any text as it is."""
    label = QLabel(parent)
    label.setTextFormat(Qt.TextFormat.PlainText)
    label.setText(text)
    return label


def escaped(text: str) -> str:
    """Text for what is always read as HTML."""
    return html.escape(text, quote=False)


def shown_plain(text: str) -> str:
    """Text for what finds out by itself whether it is HTML: tooltips and message boxes."""
    return f"<qt>{escaped(text)}</qt>".replace("\n", "<br>") if "<" in text else text


def escaped_field(name: str) -> str:
    """Value of a field in the HTML of a map tip."""
    return f"[% {_escaped_value(name)} %]"


def image_in_tip(name: str, width_px: int) -> str:
    """Image in the HTML of a map tip, by the field of its path; nothing where that is no file: a pipe has no end."""
    start, end = '<img src="file:///', f'" width="{width_px}"/><br/>'
    return f"[% if(is_file(\"{name}\"), '{start}' || {_escaped_value(name)} || '{end}', '') %]"


def _escaped_value(name: str) -> str:
    value = f'"{name}"'
    for sign, written in (("&", "&amp;"), ("<", "&lt;"), ('"', "&quot;")):
        value = f"replace({value}, '{sign}', '{written}')"
    return value


def path_inside(folder: str, name: str, ending: str) -> str:
    """Return an expression for the path of a file in a folder; NULL where a field's value is no name of a file.

    Such as one that leads elsewhere, as an address, by ``..`` or by signs that addresses are read with.

    Parameters
    ----------
    folder : str
        An expression.
    name : str
        The field.
    ending : str
        Of the file's name.
    """
    # Backslashes of the pattern are doubled for the expression's own text.
    refused = r"[/\\\\:%?#<>|*\\x00-\\x1f]|^\\.*$"
    return f"if(regexp_match(\"{name}\", '{refused}'), NULL, {folder} || '/' || \"{name}\" || '{ending}')"
