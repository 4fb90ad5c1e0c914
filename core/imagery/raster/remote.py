"""Rasters on other machines: GDAL reads parts of them over HTTP, with the limits that apply to all sources.

GDAL makes the requests, so user agent, timeouts and retries are set by GDAL's options. Before, `Client` requests one
byte, because GDAL does not report whether the server is out of reach, refuses requests or sends whole files only, nor
the version of the file. GDAL's requests are then restricted to this version.
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
from .trust import CURL, fill_key

#: Seconds for which a file is assumed unchanged.
_SAME_FOR_S = 2.0
#: Most bytes to accept as the answer to a request of one byte.
_MOST_BYTES = 1 << 16
#: Numbers to make the address of each opened raster unique, as GDAL caches parts of files by address.
_opened = itertools.count(1)


class _Version(NamedTuple):
    """Version of a file: size, ETag and modification date, each empty if the server does not state it."""

    size: str
    etag: str
    changed: str

    @property
    def condition(self) -> str:
        """Header that restricts a request to this version; empty if there is no suitable ETag.

        The ETag must be strong, and have no commas, which versions of GDAL treat differently.
        """
        return f"If-Match: {self.etag}" if re.fullmatch(r'"[!#-+\--\[\]-~]+"', self.etag) else ""


class Remote:
    """A raster on another machine.

    Parameters
    ----------
    path : str
        GDAL's name of the file, ``/vsi…``.
    title : str
    transport : Transport or None
        Not closed with this object; None to create a transport.
    key : str
        Value of ``{key}`` in the path.

    Attributes
    ----------
    path : str
        Name for GDAL, different for each opening, as GDAL caches parts of files by name.
    options : dict of str to str
        GDAL's options for opening and reading the raster.

    Raises
    ------
    InvalidInput
        The server lacks the file, or sends no parts of files.
    SourceError
        The server is out of reach or refuses.
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
            # Use one connection for each open handle, as there are at most as many handles as connections.
            "GDAL_HTTP_MULTIRANGE": "SERIAL",
        }
        self._path_with_key = fill_key(path, key)
        self.path, self._url = _address(self._path_with_key)
        self._providers = list(find_providers(path))
        self._client: Client | None = None
        self._asking = threading.Lock()
        # Credentials that GDAL takes from the environment but the client does not.
        credentials = (
            "HEADERS",
            "HEADER_FILE",
            "USERPWD",
            "AUTH",
            "BEARER",
            "COOKIE",
            "COOKIEFILE",
            "SSLCERT",
        )
        if not self._url or any(f"GDAL_HTTP_{name}" in os.environ for name in credentials):
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
            # In GDAL's list of headers, a backslash escapes the quotes of an ETag.
            written = self._version.condition.replace('"', r"\"")
            self.options["GDAL_HTTP_HEADERS"] = f'"{written}"'

    @property
    def policy(self) -> Policy:
        """Strictest terms of all providers requested so far, redirects included."""
        known = strictest(self._providers)
        return Policy() if known is None else known.policy

    def leave_out_heads(self) -> bool:
        """Stop GDAL from sending HEAD requests first; return whether that changes anything.

        Servers refuse HEAD if the signature in an address is for GET only.
        """
        use_head = "CPL_VSIL_CURL_USE_HEAD"
        if not self._url or use_head in self.options:
            return False
        self.options[use_head] = "NO"
        # Use another address, as GDAL caches the failure by address.
        self.path, _ = _address(self._path_with_key)
        return True

    def masked(self, text: str) -> str:
        """Return a message of GDAL with the file name as given by the user, and with the key masked."""
        return self._secrets.masked(text.replace(self.path, self._named))

    def check(self, *, anew: bool = False) -> None:
        """Refuse a file that has changed; the server is asked at most every two seconds, or now with ``anew``.

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
                # The server is out of reach: GDAL reports this for the part that it reads.
                return
            self._asked_s = time.monotonic()
        if version != self._version:
            raise SourceError("{0}: has changed since it was opened", self._title, remedy="start anew")

    def close(self) -> None:
        """End a running request."""
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
    """A transport that only its owner closes."""

    def __init__(self, transport: Transport) -> None:
        self.get = transport.get

    def close(self) -> None:
        """Leave the transport open."""


def _address(path: str) -> tuple[str, str]:
    """Return a unique name of the file for GDAL, and the URL of the file, empty if unknown."""
    number = next(_opened)
    # Clients do not send the text after #.
    if found := re.fullmatch(r"(/vsicurl\?(?:.*&)?url=)([^&#]+)(.*)", path, re.IGNORECASE):
        before, url, after = found.groups()
        return f"{before}{url}%23{number}{after}", unquote(url)
    if found := re.fullmatch(r"/vsicurl/(https?://[^#]+)", path, re.IGNORECASE):
        return f"{path}#{number}", found.group(1)
    # A file in an archive, whose address may stand in braces.
    archive = r"(/vsi(?:zip|tar)/)\{?/vsicurl/(https?://[^{}#]+?\.(?:zip|kmz|tar|tgz|tar\.gz))\}?(/.*)"
    if found := re.fullmatch(archive, path, re.IGNORECASE):
        before, url, after = found.groups()
        return f"{before}{{{CURL}{url}#{number}}}{after}", url
    return path, ""


def _version(answer: Response) -> _Version:
    _, _, size = answer.headers.get("content-range", "").rpartition("/")
    return _Version(size, answer.headers.get("etag", ""), answer.headers.get("last-modified", ""))


def _values(message: object) -> list[object]:
    """Values of a message, including the values of nested messages."""
    found = list(getattr(message, "values", ()))
    return found + [inner for value in found for inner in _values(value)]


def _template(value: object) -> str:
    return str(getattr(value, "template", ""))
