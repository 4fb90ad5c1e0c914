"""Masking of keys in texts, in any usual encoding."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterable
from typing import Callable
from urllib.parse import quote, quote_plus

from .plain import CUT

#: Text in place of a key.
MASK = "***"
#: A character encoded for URLs (up to nine times), HTML or JSON.
_ENCODED = re.compile(
    rb"%(?:25){0,8}([0-9a-f]{2})|(&(?:#[0-9]{1,7}|#x[0-9a-f]{1,6}|[a-z]{2,8});)|\\u([0-9a-f]{4})|\\(?=[/\"\\])",
    re.IGNORECASE,
)


class Secrets:
    """Keys to mask in texts, plain or encoded (also repeatedly) for URLs, HTML or JSON."""

    def __init__(self, values: Iterable[str]) -> None:
        forms = set()
        for value in filter(None, values):
            written = (value, quote(value), quote(value, safe=""), quote_plus(value), html.escape(value))
            forms |= {_folded(value.encode("utf-8", "replace"))}
            forms |= {_read(one)[0] for one in (*written, json.dumps(value)[1:-1])}
        self._forms = sorted(forms - {b""}, key=len, reverse=True)

    def __repr__(self) -> str:
        return f"Secrets of {len(self._forms)} forms"

    def __bool__(self) -> bool:
        return bool(self._forms)

    def masked(self, text: str) -> str:
        """Mask the keys, and the beginning of a key if the text was shortened within the key."""
        return self._replace(MASK, text, lambda plain, form: _places(plain, form) + _cut_short(plain, form))

    def replaced(self, text: str, by: str) -> str:
        """Replace the keys with ``by``."""
        return self._replace(by, text, _places)

    def _replace(self, by: str, text: str, places: Callable[[bytes, bytes], list[tuple[int, int]]]) -> str:
        if not self._forms:
            return text
        plain, starts = _read(text)
        found = [place for form in self._forms for place in places(plain, form)]
        if not found:
            return text
        written, pieces, at = text.encode("utf-8", "replace"), [], 0
        for begin, end in sorted(found):
            if starts[end] > at:
                # Replace overlapping keys once.
                pieces += [written[at : starts[begin]], by.encode()] if starts[begin] >= at else []
                at = starts[end]
        return b"".join([*pieces, written[at:]]).decode("utf-8", "replace")


def _folded(plain: bytes) -> bytes:
    """Fold upper case and + for a space, in which encodings of a key differ."""
    return plain.lower().replace(b"+", b" ")


def _read(text: str) -> tuple[bytes, list[int] | range]:
    """Decode and fold a text; return UTF-8, and for each byte its index in the UTF-8 of the original."""
    written = text.encode("utf-8", "replace")
    if not _ENCODED.search(written):
        return _folded(written), range(len(written) + 1)
    plain, starts, at = bytearray(), [], 0
    for found in _ENCODED.finditer(written):
        percent, entity, code = found.groups()
        if percent:
            read = bytes([int(percent, 16)])
        elif entity:
            read = html.unescape(entity.decode("ascii")).encode("utf-8", "replace")
        else:
            read = chr(int(code, 16)).encode("utf-8", "replace") if code else b""
        plain += written[at : found.start()] + read
        starts += [*range(at, found.start()), *(found.start(),) * len(read)]
        at = found.end()
    plain += written[at:]
    return _folded(bytes(plain)), [*starts, *range(at, len(written) + 1)]


def _places(plain: bytes, form: bytes) -> list[tuple[int, int]]:
    """Begin and end of each occurrence of a key."""
    found, at = [], plain.find(form)
    while at >= 0:
        found.append((at, at + len(form)))
        at = plain.find(form, at + len(form))
    return found


def _cut_short(plain: bytes, form: bytes) -> list[tuple[int, int]]:
    """Begin and end of the part of a key before the last mark of a shortened text."""
    found = []
    cut = plain.rfind(CUT.encode())
    # The cut may lie within an encoded character.
    encoded_part = re.compile(rb"(?:%[0-9a-f]{0,18}|&#?[0-9a-z]{0,8}|\\u?[0-9a-f]{0,3})\Z", re.IGNORECASE)
    partly = encoded_part.search(plain, max(cut - 20, 0), cut) if cut >= 0 else None
    for end in {cut, partly.start() if partly else cut} - {-1}:
        before = plain[max(end - len(form), 0) : end]
        length = next((n for n in range(len(before), 0, -1) if before.endswith(form[:n])), 0)
        if length:
            found.append((end - length, cut))
    return found
