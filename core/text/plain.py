"""Text that others wrote (servers, files, environments): read, made one plain line, and without the user's keys.

Whatever the text is, all of this takes time in proportion to its length at most.
"""

from __future__ import annotations

import html
import math
import re
from datetime import datetime
from typing import Any, Callable

from ..errors import InvalidInput
from ..limits import MAX_LINE_CHARACTERS, MAX_TEXT_CHARACTERS
from ..numbers import real_number
from .safe_json import parse_json

#: Ends what was cut short.
CUT = "…"
#: Largest number read: more than anything that is counted.
_LARGEST_DIGITS = 18
#: Characters of a text that is no number, or no time, which are shown.
_NUMBER_CHARACTERS = 80
#: A day, a time of it, decimals of a second, and a zone.
_TIME = re.compile(r"(.{10})[T ](\d{2}:\d{2}(?::\d{2})?)(?:[.,](\d{1,9}))?\s*(Z|[+-]\d{2}:?\d{2})?")
#: Halves of characters, which Python also has for bytes of names that are no UTF-8.
_HALVES = re.compile("[\ud800-\udfff]")
_TAG = re.compile(r"<(?:(!--)|/?([a-zA-Z][a-zA-Z0-9]*)|[!?/])")
#: Tags within a line of text; others stand between lines.
_INLINE = frozenset("a abbr b big cite code em font i img mark small span strong sub sup tt u".split())
#: What is no text to read up to its end tag, and how that begins.
_HIDDEN = {name: re.compile(f"</{name}", re.IGNORECASE) for name in ("script", "style")}
_TITLE = re.compile(r"<title\b", re.IGNORECASE)
_TITLE_END = re.compile("</title", re.IGNORECASE)


def time_s(text: str, where: str) -> float:
    """Seconds after 1970 of a time of ISO 8601, which Python before 3.11 knows in few of its forms.

    Raises InvalidInput, which begins with ``where``.
    """
    found = _TIME.fullmatch(text.strip())
    try:
        day, clock, decimals, zone = found.groups() if found else ("", "", "", "")
        offset = "+00:00" if zone in (None, "Z") else zone if ":" in zone else f"{zone[:3]}:{zone[3:]}"
        whole = datetime.fromisoformat(f"{day}T{clock}{offset}").timestamp()
    except ValueError as wrong:
        raise InvalidInput(
            "{0} time {1!r}: must be as 2024-06-21T10:30:00Z, or seconds after 1970",
            where,
            text[:_NUMBER_CHARACTERS],
        ) from wrong
    return whole + float(f"0.{decimals or 0}")


def finite_number(text: str, where: str) -> float:
    """Finite number that a text states in plain digits; raises InvalidInput, which begins with ``where``."""
    try:
        value = real_number(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidInput("{0} {1!r}: must be a number", where, text[:_NUMBER_CHARACTERS])
    return value


def whole_number(text: str) -> int | None:
    """Whole number that a text of decimal digits states, 10^18 at most; None of any other text."""
    digits = text.strip()
    if not (digits.isascii() and digits.isdigit()):
        return None
    return int(digits) if len(digits) <= _LARGEST_DIGITS else 10**_LARGEST_DIGITS


def one_line(text: str | None, most: int = MAX_LINE_CHARACTERS) -> str:
    """Text in one line of ``most`` printable characters at most, without markup."""
    plain = _unescaped(without_markup((text or "")[:MAX_TEXT_CHARACTERS]))
    return shortened(" ".join(printable(plain).split()), most)


def safe_str(thing: object, shown: Callable[[Any], str] = str) -> str:
    """Text of an object of somebody else's code, which may fail to make one.

    Parameters
    ----------
    shown : callable
        `str` or `repr`.
    """
    try:
        return shown(thing)
    except (Exception, SystemExit):  # noqa: BLE001  (whatever it is, it is theirs)
        return f"<{type(thing).__name__}, which cannot be printed>"


def error_text(error: BaseException) -> str:
    """Type and text of an error that somebody else's code raised, in one line of `MAX_LINE_CHARACTERS` at most."""
    text = printable(safe_str(error)[:MAX_TEXT_CHARACTERS])
    return shortened(": ".join(filter(None, (type(error).__name__, " ".join(text.split())))), MAX_LINE_CHARACTERS)


def listed(name: str, title: str) -> str:
    """What lists show of a thing that has a title and a name, and what it can be named by, too.

    ``Synthetic (offline) [world]`` of a source.
    """
    return f"{title} [{name}]"


def printable(text: str) -> str:
    """Text with spaces for characters that steer terminals or the direction of writing, and other invisible ones."""
    return text if text.isprintable() else "".join(one if one.isprintable() else " " for one in text)


def writable(name: str) -> str:
    """Name of a file as text that can be written in UTF-8: what is none of it in the name is shown as U+FFFD."""
    return _HALVES.sub("\ufffd", name)


def table_cell(text: str) -> str:
    """Text for a table, which no program takes for a formula: an apostrophe stands before one."""
    plain = printable(text)
    # Spreadsheets take such a text as a formula.
    return f"'{plain}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else plain


def shortened(text: str, most: int) -> str:
    """Text of ``most`` characters at most; the last of one that is longer says so."""
    return text if len(text) <= most else text[: most - 1] + CUT


def without_markup(text: str, between: str = " ") -> str:
    """Text of HTML or XML without its tags, comments, scripts and styles.

    Parameters
    ----------
    between : str
        What stands for tags that end a line.
    """
    pieces, at = [], 0
    while (begin := text.find("<", at)) >= 0:
        pieces.append(text[at:begin])
        tag = _TAG.match(text, begin)
        if tag is None:
            pieces.append("<")
            at = begin + 1
            continue
        end = text.find("-->" if tag[1] else ">", begin)
        if end < 0:
            # A comment without its end hides the rest, as browsers have it; any other such bracket is text.
            return "".join(pieces) if tag[1] else "".join([*pieces, text[begin:]])
        name = (tag[2] or "").lower()
        pieces.append("" if name in _INLINE else between)
        at = end + (len("-->") if tag[1] else 1)
        if name in _HIDDEN and text[begin + 1] != "/":
            ending = _HIDDEN[name].search(text, at)
            if ending is None:
                return "".join(pieces)
            at = ending.start()
    return "".join([*pieces, text[at:]])


def first_words(body: bytes, content_type: str, hide: Callable[[str], str] = str) -> str:
    """First line of a text, HTML or JSON body, at most 200 characters; empty for anything else.

    Parameters
    ----------
    hide : callable
        Masks what must not be shown, before anything is cut.
    """
    # A key that begins before the limit ends within 4,096 more characters.
    told = body[: MAX_TEXT_CHARACTERS + 4096].decode("utf-8", "replace")
    text = hide(told)[:MAX_TEXT_CHARACTERS].lstrip("\ufeff").strip()
    if text.count("\ufffd") > len(text) // 20 or "\0" in text:
        return ""
    if "json" in content_type or text[:1] in ("{", "["):
        text = _json_message(text)
    elif "html" in content_type or "xml" in content_type or text[:1] == "<":
        text = _unescaped(_title(text) or without_markup(text, "\n"))
    line = next((line.strip() for line in text.splitlines() if line.strip()), "")
    return shortened(hide(printable(line)), 200)


def _title(text: str) -> str:
    """Title of an HTML document; empty without one."""
    begin = _TITLE.search(text)
    inside = text.find(">", begin.end()) if begin else -1
    end = _TITLE_END.search(text, inside) if inside >= 0 else None
    return text[inside + 1 : end.start()].strip() if end else ""


def _unescaped(text: str) -> str:
    try:
        return html.unescape(text)
    except ValueError:
        # A number of more digits than Python reads.
        return text


def _json_message(text: str) -> str:
    try:
        found = parse_json(text)
    except InvalidInput:
        return text
    while isinstance(found, (dict, list)):
        if isinstance(found, list):
            found = found[0] if found else ""
            continue
        names = ("message", "error_message", "error", "errors", "detail", "title", "reason")
        found = next((found[name] for name in names if name in found), "")
    return str(found)
