"""Foreign text (of servers, files, the environment): parsing numbers and times, removing markup, making one plain line.

The time of every function is at most linear in the length of the text.
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

#: Last character of a shortened text.
CUT = "…"


def time_s(text: str, where: str) -> float:
    """Parse an ISO 8601 time to seconds after 1970; Python before 3.11 reads only few forms.

    Raises InvalidInput, which begins with ``where``.
    """
    # Groups are date, time, decimals of a second, and zone.
    pattern = r"(.{10})[T ](\d{2}:\d{2}(?::\d{2})?)(?:[.,](\d{1,9}))?\s*(Z|[+-]\d{2}:?\d{2})?"
    found = re.fullmatch(pattern, text.strip())
    try:
        day, clock, decimals, zone = found.groups() if found else ("", "", "", "")
        offset = "+00:00" if zone in (None, "Z") else zone if ":" in zone else f"{zone[:3]}:{zone[3:]}"
        seconds = datetime.fromisoformat(f"{day}T{clock}{offset}").timestamp()
    except ValueError as wrong:
        raise InvalidInput(
            "{0} time {1!r}: must be as 2024-06-21T10:30:00Z, or seconds after 1970",
            where,
            text[:80],
        ) from wrong
    return seconds + float(f"0.{decimals or 0}")


def finite_number(text: str, where: str) -> float:
    """Parse a finite number of plain digits; raises InvalidInput, which begins with ``where``."""
    try:
        value = real_number(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidInput("{0} {1!r}: must be a number", where, text[:80])
    return value


def whole_number(text: str) -> int | None:
    """Parse a whole number of decimal digits, limited to 10^18; None for other text."""
    digits = text.strip()
    if not (digits.isascii() and digits.isdigit()):
        return None
    return int(digits) if len(digits) <= 18 else 10**18


def one_line(text: str | None, most: int = MAX_LINE_CHARACTERS) -> str:
    """Reduce a text to one line of at most ``most`` printable characters, without markup."""
    plain = _unescaped(without_markup((text or "")[:MAX_TEXT_CHARACTERS]))
    return shortened(" ".join(printable(plain).split()), most)


def safe_str(thing: object, shown: Callable[[Any], str] = str) -> str:
    """Convert a foreign object to text, even if its ``__str__`` raises.

    Parameters
    ----------
    shown : callable
        Conversion, `str` or `repr`.
    """
    try:
        return shown(thing)
    except (Exception, SystemExit):  # noqa: BLE001  (foreign code may raise anything)
        return f"<{type(thing).__name__}, which cannot be printed>"


def error_text(error: BaseException) -> str:
    """Type and text of an error of foreign code, in one line of at most `MAX_LINE_CHARACTERS`."""
    text = printable(safe_str(error)[:MAX_TEXT_CHARACTERS])
    return shortened(": ".join(filter(None, (type(error).__name__, " ".join(text.split())))), MAX_LINE_CHARACTERS)


def listed(name: str, title: str) -> str:
    """Title and name as lists show them and input accepts them: ``Synthetic (offline) [world]``."""
    return f"{title} [{name}]"


def printable(text: str) -> str:
    """Replace control characters, changes of writing direction and other invisible characters with spaces."""
    return text if text.isprintable() else "".join(one if one.isprintable() else " " for one in text)


def writable(name: str) -> str:
    """Name of a file as valid UTF-8: surrogates, which Python uses for undecodable bytes, become U+FFFD."""
    return re.sub("[\ud800-\udfff]", "\ufffd", name)


def table_cell(text: str) -> str:
    """Text for a cell of a table; an apostrophe before it keeps spreadsheets from reading it as a formula."""
    plain = printable(text)
    return f"'{plain}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else plain


def shortened(text: str, most: int) -> str:
    """Cut a text to at most ``most`` characters, the last of which is then ``…``."""
    return text if len(text) <= most else text[: most - 1] + CUT


def without_markup(text: str, between: str = " ") -> str:
    """Remove tags, comments, scripts and styles from HTML or XML.

    Parameters
    ----------
    between : str
        Replaces tags, except of inline elements, which are just removed.
    """
    start = re.compile(r"<(?:(!--)|/?([a-zA-Z][a-zA-Z0-9]*)|[!?/])")
    inline = "a abbr b big cite code em font i img mark small span strong sub sup tt u".split()
    pieces, at = [], 0
    while (begin := text.find("<", at)) >= 0:
        pieces.append(text[at:begin])
        tag = start.match(text, begin)
        if tag is None:
            pieces.append("<")
            at = begin + 1
            continue
        end = text.find("-->" if tag[1] else ">", begin)
        if end < 0:
            # As in browsers, an unclosed comment hides the rest; other unclosed brackets are text.
            return "".join(pieces) if tag[1] else "".join([*pieces, text[begin:]])
        name = (tag[2] or "").lower()
        pieces.append("" if name in inline else between)
        at = end + (len("-->") if tag[1] else 1)
        if name in ("script", "style") and text[begin + 1] != "/":
            ending = re.compile(f"</{name}", re.IGNORECASE).search(text, at)
            if ending is None:
                return "".join(pieces)
            at = ending.start()
    return "".join([*pieces, text[at:]])


def first_words(body: bytes, content_type: str, hide: Callable[[str], str] = str) -> str:
    """First line of a text, HTML or JSON body, at most 200 characters; empty for anything else.

    Parameters
    ----------
    hide : callable
        Masks keys; called before the text is cut.
    """
    # Decode 4,096 characters more, so that a key that begins before the limit is complete.
    beginning = body[: MAX_TEXT_CHARACTERS + 4096].decode("utf-8", "replace")
    text = hide(beginning)[:MAX_TEXT_CHARACTERS].lstrip("\ufeff").strip()
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
    begin = re.search(r"<title\b", text, re.IGNORECASE)
    inside = text.find(">", begin.end()) if begin else -1
    end = re.compile("</title", re.IGNORECASE).search(text, inside) if inside >= 0 else None
    return text[inside + 1 : end.start()].strip() if end else ""


def _unescaped(text: str) -> str:
    try:
        return html.unescape(text)
    except ValueError:
        # A character reference has more digits than Python reads.
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
