"""Services that describe themselves in JSON: fetching of documents, and reading of values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode, urlsplit, urlunsplit

from ...errors import InvalidInput, Message
from ...limits import MAX_SERVICE_JSON_BYTES
from ...text.plain import one_line
from ...text.safe_json import parse_json
from ..entry import CatalogueEntry
from ..policy import Policy
from ..systems import WORLD_DEG, Bounds
from ..tiles import KEY_ENV
from .capabilities import Document, fetch_document
from .service import ServiceSource


class JSONService(ServiceSource):
    """A layer of a service that describes itself in JSON, as a mission names it."""

    def _filled(self, url: str) -> str:
        """Fill the key into an address."""
        return url.replace("{key}", quote(self.key, safe="")) if self.key else url

    def _json(self, url: str, what: Message) -> Document:
        """Fetch a JSON document; request JSON by header and, if the answer is not JSON, by query.

        Raises
        ------
        SourceError
            The document is not available, too large, or not a JSON object.
        """
        key, accept = self.key, {"Accept": "application/json"}
        document, body, words = fetch_document(self.service, url, key, self.options.transport, what, accept)
        if not _begins_as_json(body) and "f=" not in urlsplit(url).query:
            # Some servers ignore the Accept header.
            url = set_query(url, {"f": "json"})
            document, body, words = fetch_document(self.service, url, key, self.options.transport, what, accept)
        if len(body) > MAX_SERVICE_JSON_BYTES:
            raise document.wrong(Message("a description of more than {0} MB", MAX_SERVICE_JSON_BYTES >> 20))
        if not _begins_as_json(body):
            raise document.wrong(Message("no description in JSON at this address{0}", f": {words}" if words else ""))
        try:
            root = parse_json(body)
        except InvalidInput as wrong:
            raise document.wrong(Message("JSON that cannot be read: {0}", wrong)) from None
        if not isinstance(root, Mapping):
            raise document.wrong(Message("JSON that does not describe a service"))
        return replace(document, root=_mark_keys(root, document))

    def _made(self, title: str, credit: str, url: str, policy: Policy, **tiles: Any) -> CatalogueEntry:
        """Entry of tiles with a URL template."""
        return CatalogueEntry(
            name=self.text,
            title=title or self.service.host,
            kind="xyz",
            attribution=credit,
            urls={"": url},
            policy=policy,
            key_env=KEY_ENV if "{key}" in url else None,
            user=True,
            **tiles,
        )


def set_query(url: str, query: Mapping[str, str]) -> str:
    """Set parameters in the query of an address; placeholders are kept."""
    parts = urlsplit(url)
    given = [(name, value) for name, value in parse_qsl(parts.query, keep_blank_values=True)]
    kept = [(name, value) for name, value in given if name.lower() not in query]
    return urlunsplit(parts._replace(query=urlencode([*kept, *query.items()], safe="{}:/,-")))


def read_objects(value: object) -> list[Mapping[str, Any]]:
    """Objects in a list, up to 10,000; empty for other values."""
    if not isinstance(value, Sequence) or isinstance(value, str):
        return []
    return [one for one in value[:10_000] if isinstance(one, Mapping)]


def read_text(value: object) -> str:
    """Text in one line; empty for other values."""
    return one_line(value) if isinstance(value, str) else ""


def read_number(value: object) -> float | None:
    """Finite number; None for other values."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    return float(value) if math.isfinite(value) else None


def sound_bounds(west: float, south: float, east: float, north: float) -> Bounds:
    """Clip bounds in degrees to the Earth; the world if they are invalid."""
    box = max(west, -180.0), max(south, -90.0), min(east, 180.0), min(north, 90.0)
    return box if box[0] < box[2] and box[1] < box[3] else WORLD_DEG


def _begins_as_json(body: bytes) -> bool:
    return body.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in (b"{", b"[")


def _mark_keys(value: Any, document: Document) -> Any:
    """Replace the key in all texts by {key}; a literal {key} is escaped."""
    if isinstance(value, str):
        return document.without_key(value.replace("{key}", "%7Bkey%7D"))
    if isinstance(value, list):
        return [_mark_keys(one, document) for one in value]
    if isinstance(value, Mapping):
        return {name: _mark_keys(one, document) for name, one in value.items()}
    return value
