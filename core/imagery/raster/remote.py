"""Rasters on other machines: GDAL reads parts of them over HTTP, under the manners of all other requests.

The requests are GDAL's own, so what it can keep of those manners it is told by its options: who asks, how long it
waits, how often it tries again. A request of one byte before, by the client of all other sources, says what GDAL would
not: that the server is away, refuses or sends no parts of files, and which version of the file this is. Every request
of GDAL is then for this version alone.
"""

from __future__ import annotations

import itertools
import os
import re
import threading
import time
from http import HTTPStatus
from typing import NamedTuple
from urllib.parse import unquote

from ...errors import InvalidInput, PartError, SourceError
from ...text.secrets import Secrets
from ..entry import find_providers, strictest
from ..http.client import FIRST_WAIT_S, TRIES, Client, NotThere
from ..http.transport import Response, Timeouts, Transport, too_long, user_agent
from ..policy import Policy
from .trust import CURL, with_key

#: GDAL's names of files over HTTP, and of those within archives over HTTP, with and without braces.
_PLAIN = re.compile(r"()/vsicurl/(https?://[^#]+)()", re.IGNORECASE)
_WITH_OPTIONS = re.compile(r"(/vsicurl\?(?:.*&)?url=)([^&#]+)(.*)", re.IGNORECASE)
_WITHIN = re.compile(
    r"(/vsi(?:zip|tar)/)\{?/vsicurl/(https?://[^{}#]+?\.(?:zip|kmz|tar|tgz|tar\.gz))\}?(/.*)", re.IGNORECASE
)
#: Options by which a user has GDAL send something of his own, which a request of ours would lack.
_CREDENTIALS = ("HEADERS", "HEADER_FILE", "USERPWD", "AUTH", "BEARER", "COOKIE", "COOKIEFILE", "SSLCERT")
#: ETags by which a version is told byte by byte; versions of GDAL differ in what else they make of those with commas.
_STRONG = re.compile(r'"[!#-+\--\[\]-~]+"')
#: Seconds for which a file is taken to be what it was.
_SAME_FOR_S = 2.0
#: Bytes of an answer to a request of one byte.
_MOST_BYTES = 1 << 16
#: GDAL's option by which it asks for the heads of files first.
_HEAD = "CPL_VSIL_CURL_USE_HEAD"
#: Tells rasters that are opened one after the other apart, as GDAL keeps parts of files by their address.
_opened = itertools.count(1)


class _Version(NamedTuple):
    """What tells one version of a file from another; empty where a server does not say."""

    size: str
    etag: str
    changed: str

    @property
    def condition(self) -> str:
        """Header of requests for this version alone; empty where none can be made, or GDAL cannot be told of it."""
        return f"If-Match: {self.etag}" if _STRONG.fullmatch(self.etag) else ""


class Remote:
    """A raster on another machine.

    Parameters
    ----------
    path : str
        GDAL's name of it, ``/vsi…``.
    title : str
    transport : Transport or None
        Left open; None for one of its own.
    key : str
        What ``{key}`` stands for in the path.

    Attributes
    ----------
    path : str
        Name for GDAL to open it by: parts that it keeps of others with this address are not taken for this one's.
    options : dict of str to str
        GDAL's, wherever it opens or reads the raster.

    Raises
    ------
    InvalidInput
        The server has no such file, or sends no parts of files.
    SourceError
        It is out of reach, or refuses.
    """

    def __init__(self, path: str, title: str, transport: Transport | None = None, key: str = "") -> None:
        self._title = title
        self._named, self._secrets = path, Secrets((key,) if key else ())
        timeouts = Timeouts()
        self.options = {
            "GDAL_HTTP_USERAGENT": user_agent(),
            "GDAL_HTTP_CONNECTTIMEOUT": f"{timeouts.connect_s:g}",
            "GDAL_HTTP_LOW_SPEED_TIME": f"{timeouts.read_s:g}",
            "GDAL_HTTP_LOW_SPEED_LIMIT": "1",
            "GDAL_HTTP_TIMEOUT": f"{timeouts.whole_s:g}",
            "GDAL_HTTP_MAX_RETRY": str(TRIES - 1),
            "GDAL_HTTP_RETRY_DELAY": f"{FIRST_WAIT_S:g}",
            # One connection for each raster that is open, and these are as many as there are connections.
            "GDAL_HTTP_MULTIRANGE": "SERIAL",
        }
        self._path_with_key = with_key(path, key)
        self.path, self._url = _address(self._path_with_key)
        self._providers = list(find_providers(path))
        self._client: Client | None = None
        self._asking = threading.Lock()
        if not self._url or any(f"GDAL_HTTP_{name}" in os.environ for name in _CREDENTIALS):
            return
        if transport is None:
            from ..http.requests_transport import RequestsTransport

            transport = RequestsTransport(1, timeouts, _MOST_BYTES)
        else:
            transport = _Lent(transport)
        self._client = Client(transport, title, connections=1, secrets=(key,) if key else ())
        try:
            self._version = self._ask(self._client)
        except NotThere as wrong:
            self.close()
            raise InvalidInput("{0}", wrong) from wrong
        except PartError as wrong:
            self.close()
            raise SourceError("{0}", wrong) from wrong
        except BaseException:
            self.close()
            raise
        self._asked_s = time.monotonic()
        if self._version.condition:
            # A list of headers: quotes, as ETags have them, stand in it with a backslash.
            written = self._version.condition.replace('"', r"\"")
            self.options["GDAL_HTTP_HEADERS"] = f'"{written}"'

    @property
    def policy(self) -> Policy:
        """Terms of the providers that were asked so far, wherever a redirect led; of several the strictest."""
        known = strictest(self._providers)
        return Policy() if known is None else known.policy

    def leave_out_heads(self) -> bool:
        """Have GDAL not ask for the head of the file first; False where it does not, or may not be told so.

        Servers do not answer that where an address is signed for its content alone.
        """
        if not self._url or _HEAD in self.options:
            return False
        self.options[_HEAD] = "NO"
        # GDAL keeps what it has been told of an address.
        self.path, _ = _address(self._path_with_key)
        return True

    def masked(self, text: str) -> str:
        """GDAL's words with the name of the file as it was given, and nothing of a key."""
        return self._secrets.masked(text.replace(self.path, self._named))

    def check(self, *, anew: bool = False) -> None:
        """Refuse a file that is another one by now; asks for it again after seconds, or where it is to.

        Raises
        ------
        SourceError
            The file is gone, or has changed since it was opened.
        Cancelled
            The raster is closed.
        """
        if self._client is None:
            return
        with self._asking:
            if not anew and time.monotonic() < self._asked_s + _SAME_FOR_S:
                return
            try:
                version = self._ask(self._client)
            except NotThere as wrong:
                raise SourceError("{0}: is gone", self._title) from wrong
            except PartError:
                # Out of reach, which GDAL says of the part that it is asked for.
                return
            self._asked_s = time.monotonic()
        if version != self._version:
            raise SourceError("{0}: has changed since it was opened", self._title, remedy="start anew")

    def close(self) -> None:
        """End a request under way."""
        if self._client is not None:
            self._client.close()

    def _ask(self, client: Client) -> _Version:
        try:
            answer = client.get(
                self._url,
                self._title,
                {"Range": "bytes=0-0"},
                lambda asked: self._providers.extend(find_providers(asked)),
            )
        except PartError as wrong:
            if too_long(_MOST_BYTES).message.template in map(_template, _values(wrong.message)):
                raise self._without_parts() from wrong
            raise
        if answer.status != HTTPStatus.PARTIAL_CONTENT:
            raise self._without_parts()
        return _version(answer)

    def _without_parts(self) -> InvalidInput:
        return InvalidInput(
            "{0}: its server sends whole files only, and a raster is read in parts (HTTP Range)",
            self._title,
            remedy="name a copy of it on this machine",
        )


class _Lent:
    """A transport that others close."""

    def __init__(self, transport: Transport) -> None:
        self.get = transport.get

    def close(self) -> None:
        """Leave it open."""


def _address(path: str) -> tuple[str, str]:
    """Name for GDAL that no other raster was opened by, and the URL of the file; empty where that is not known."""
    number = next(_opened)
    # What follows # is for the reader, and not sent.
    if found := _WITH_OPTIONS.fullmatch(path):
        before, url, after = found.groups()
        return f"{before}{url}%23{number}{after}", unquote(url)
    if found := _PLAIN.fullmatch(path):
        return f"{path}#{number}", found.group(2)
    if found := _WITHIN.fullmatch(path):
        before, url, after = found.groups()
        return f"{before}{{{CURL}{url}#{number}}}{after}", url
    return path, ""


def _version(answer: Response) -> _Version:
    _, _, size = answer.headers.get("content-range", "").rpartition("/")
    return _Version(size, answer.headers.get("etag", ""), answer.headers.get("last-modified", ""))


def _values(message: object) -> list[object]:
    """Return the values of a message, and those of messages among them."""
    found = list(getattr(message, "values", ()))
    return found + [inner for value in found for inner in _values(value)]


def _template(value: object) -> str:
    return str(getattr(value, "template", ""))
