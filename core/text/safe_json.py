"""Foreign JSON, parsed within limits, so that no text can hang the program, crash it or fill its memory."""

from __future__ import annotations

import json
import math
from typing import Any, NoReturn

from ..errors import InvalidInput
from ..limits import MAX_JSON_DEPTH, MAX_JSON_DIGITS


def parse_json(text: str | bytes) -> Any:
    """Parse JSON more strictly than `json.loads`.

    Numbers must be finite and fit a float, nesting is limited to `MAX_JSON_DEPTH`, and strings must be encodable.

    Parameters
    ----------
    text : str or bytes
        Bytes are UTF-8, with or without a byte order mark.

    Raises
    ------
    InvalidInput
        The message has a few words, without the name of the file.
    """
    if isinstance(text, bytes):
        text = decoded(text)
    try:
        value = _DECODER.decode(text)
    except json.JSONDecodeError as wrong:
        raise InvalidInput(str(wrong)) from wrong
    except RecursionError as wrong:
        raise _too_deep() from wrong
    # Skip the check for most texts, which have too few brackets to be nested too deep, and no escaped surrogates.
    if text.count("[") + text.count("{") > MAX_JSON_DEPTH or "\\ud" in text or "\\uD" in text:
        _check(value)
    return value


def decoded(data: bytes) -> str:
    """Decode UTF-8 without its byte order mark; raises InvalidInput in a few words."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as wrong:
        raise InvalidInput("not UTF-8: byte {0} is invalid", wrong.start) from wrong


def _check(value: Any) -> None:
    """Refuse nesting that is too deep, and surrogates, which cannot be encoded."""
    level, depth = [value], 0
    while level:
        inner: list[Any] = []
        for one in level:
            if isinstance(one, str):
                _check_text(one)
            elif isinstance(one, (dict, list)):
                if depth == MAX_JSON_DEPTH:
                    raise _too_deep()
                inner += one
                inner += one.values() if isinstance(one, dict) else ()
        level, depth = inner, depth + 1


def _check_text(text: str) -> None:
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as wrong:
        half = f"\\u{ord(text[wrong.start]):04x}"
        raise InvalidInput("{0} alone is half a character", half) from wrong


def _too_deep() -> InvalidInput:
    return InvalidInput("nested too deep: {0} levels at most", MAX_JSON_DEPTH)


def _whole(digits: str) -> int:
    if len(digits) > MAX_JSON_DIGITS:
        raise InvalidInput("a whole number of {0:,} digits: {1} at most", len(digits), MAX_JSON_DIGITS)
    return int(digits)


def _real(digits: str) -> float:
    number = float(digits)
    if math.isinf(number):
        shown = digits if len(digits) <= MAX_JSON_DIGITS else f"{digits[:20]}…"
        raise InvalidInput("number {0}: too large", shown)
    return number


def _no_constant(name: str) -> NoReturn:
    raise InvalidInput("{0}: JSON has finite numbers only", name)


_DECODER = json.JSONDecoder(parse_int=_whole, parse_float=_real, parse_constant=_no_constant)
