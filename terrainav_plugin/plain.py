"""Foreign text, to be shown verbatim: Qt takes text that looks like HTML for HTML, and opens the files it names."""

from __future__ import annotations

import html

from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import QLabel, QWidget


def plain_label(text: str = "", parent: QWidget | None = None) -> QLabel:
    """Label that shows any text verbatim."""
    label = QLabel(parent)
    label.setTextFormat(Qt.TextFormat.PlainText)
    label.setText(text)
    return label


def escaped(text: str) -> str:
    """Text escaped for widgets that take every text for HTML."""
    return html.escape(text, quote=False)


def shown_plain(text: str) -> str:
    """Text escaped if needed for widgets that detect HTML: tooltips and message boxes."""
    return f"<qt>{escaped(text)}</qt>".replace("\n", "<br>") if "<" in text else text


def escaped_field(name: str) -> str:
    """Value of a field, in the HTML of a map tip."""
    return f"[% {_escaped_value(name)} %]"


def image_in_tip(name: str, width_px: int) -> str:
    """Image in a map tip whose path is in the field ``name``; empty unless it is a regular file, as a pipe blocks."""
    start, end = '<img src="file:///', f'" width="{width_px}"/><br/>'
    return f"[% if(is_file(\"{name}\"), '{start}' || {_escaped_value(name)} || '{end}', '') %]"


def _escaped_value(name: str) -> str:
    value = f'"{name}"'
    for sign, written in (("&", "&amp;"), ("<", "&lt;"), ('"', "&quot;")):
        value = f"replace({value}, '{sign}', '{written}')"
    return value


def path_inside(folder: str, name: str, ending: str) -> str:
    """Expression for the path of a file in a folder; NULL if the name in the field is not a plain file name.

    Names that may lead out of the folder, such as addresses and ``..``, are refused.

    Parameters
    ----------
    folder : str
        Expression for the folder.
    name : str
        Field with the name of the file.
    ending : str
        Ending to add to the name.
    """
    # In the string of an expression, backslashes are doubled.
    refused = r"[/\\\\:%?#<>|*\\x00-\\x1f]|^\\.*$"
    return f"if(regexp_match(\"{name}\", '{refused}'), NULL, {folder} || '/' || \"{name}\" || '{ending}')"
