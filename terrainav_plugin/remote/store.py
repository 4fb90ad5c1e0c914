"""Files at an address, whole or in part, over QGIS's network stack.

Files are requested in pieces, so that long files show progress, can be cancelled, and do not fill the memory.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from http import HTTPStatus
from typing import NamedTuple
from urllib.parse import urlsplit

from ...core.dataset.folder import MISSION_FILE
from ...core.errors import Cancelled, OutputError, PartError
from ...core.imagery.http.client import Client
from ...core.imagery.http.transport import Response
from ...core.limits import MAX_FETCHED_FILE_BYTES, MAX_WHOLE_ANSWER_BYTES
from ...core.storage.redirects import led_elsewhere
from ..i18n import tr
from ..network.transport import QgisTransport
from ..settings import Settings, credential_home
from .address import DatasetAddress

#: Number of bytes per request: little on a slow line, but enough for few requests per file.
_PIECE_BYTES = 4 << 20
#: Range header of a response. Lengths of files have at most 18 digits; Python refuses to convert thousands of digits.
_RANGE = re.compile(r"bytes ([0-9]{1,18})-([0-9]{1,18})/([0-9]{1,18})")


class _Piece(NamedTuple):
    """Bytes of a file from an offset, the file's size and version, and whether the server sent only a part."""

    data: bytes
    size: int
    version: str
    is_part: bool


class _Transport:
    """QGIS's transport, except for two kinds of responses.

    A part that begins at the end of a file is empty, not an error. The error texts of an object store are withheld, as
    they may quote keys.
    """

    def __init__(self, transport: QgisTransport, *, may_quote_keys: bool) -> None:
        self._transport, self._may_quote_keys = transport, may_quote_keys
        self.close = transport.close

    def get(self, url: str, headers: Mapping[str, str] | None = None, *, origin: str = "") -> Response:
        response = self._transport.get(url, headers, origin=origin)
        if response.status == HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE:
            return response._replace(status=HTTPStatus.PARTIAL_CONTENT, body=b"")
        if self._may_quote_keys and response.status >= HTTPStatus.BAD_REQUEST:
            return response._replace(body=b"")
        return response


class Store:
    """The files at an address.

    `close` cancels requests, on any thread; later requests raise `Cancelled`.
    """

    def __init__(self, address: DatasetAddress) -> None:
        self.address = address
        self._sends_parts: bool | None = None
        web = "" if address.is_s3 else address.url
        transport = QgisTransport(
            2,
            max_body_bytes=MAX_WHOLE_ANSWER_BYTES,
            authcfg=Settings().authcfg(web),
            home=credential_home(web),
        )
        # Only three attempts, for brief failures, as the user waits.
        self._client = Client(_Transport(transport, may_quote_keys=address.is_s3), address.server, tries=3)

    def close(self) -> None:
        """Cancel all requests."""
        self._client.close()

    def pieces(
        self,
        name: str,
        go_on: Callable[[float], bool] = lambda _: True,
        most_bytes: int = MAX_FETCHED_FILE_BYTES,
    ) -> Iterator[bytes]:
        """Contents of a file, in pieces.

        Parameters
        ----------
        name : str
            Path relative to the folder.
        go_on : callable
            Takes the share received, 0 to 1; returns whether to continue.
        most_bytes : int
            Largest length accepted.

        Raises
        ------
        NotThere
        PartError, SourceError, Cancelled
            As from `Client.get`.
        OutputError
            The file is too long, or has changed between two requests.
        """
        start, version = 0, ""
        while True:
            piece = self._piece(name, start, start + _PIECE_BYTES)
            if piece.size > most_bytes:
                raise OutputError(
                    "{0}: has {1} bytes, more than {2}",
                    self.address.file(name),
                    piece.size,
                    most_bytes,
                )
            if start and (piece.version != version or not piece.is_part):
                raise OutputError("{0}: has changed while it was read", self.address.file(name))
            version = piece.version
            yield piece.data
            start += len(piece.data)
            if not go_on(start / max(piece.size, 1)):
                raise Cancelled(tr("fetching: stopped"))
            if start >= piece.size:
                return

    def part(self, name: str, start: int, length: int) -> bytes:
        """Bytes of a file from an offset; fewer at its end.

        Raises
        ------
        NotThere
        OutputError
            The server can only send whole files.
        PartError, SourceError, Cancelled
        """
        if self._sends_parts is None:
            # Test first with the mission file, which is short, as a server without range requests sends whole files.
            self._piece(MISSION_FILE, 0, 1)
        if not self._sends_parts:
            raise OutputError(
                "{0}: sends whole files only, and images in shards are parts of files", self.address.server
            )
        pieces = range(start, start + length, _PIECE_BYTES)
        return b"".join(self._piece(name, at, min(at + _PIECE_BYTES, start + length)).data for at in pieces)

    def _refuse_redirects(self, url: str) -> Callable[[str], None]:
        """Function that refuses redirects to other servers, as requests carry the user's credentials."""

        def allow(asked: str) -> None:
            if urlsplit(asked)[:2] != urlsplit(url)[:2]:
                raise led_elsewhere(self.address.server)

        return allow

    def _piece(self, name: str, start: int, end: int) -> _Piece:
        what = self.address.file(name)
        wanted = {"Range": f"bytes={start}-{end - 1}"}
        url = self.address.request_url(name)
        response = self._client.get(url, what, wanted, self._refuse_redirects(url) if self.address.is_s3 else None)
        version = response.headers.get("etag", "")
        is_part = response.status == HTTPStatus.PARTIAL_CONTENT
        self._sends_parts = is_part
        if not is_part:
            return _Piece(response.body, len(response.body), version, is_part)
        stated = _RANGE.fullmatch(response.headers.get("content-range", ""))
        if stated is None and not response.body:
            return _Piece(b"", start, version, is_part)
        # An empty part would be requested again and again.
        length = len(response.body)
        if stated is None or not length or int(stated[1]) != start or int(stated[2]) + 1 - start != length:
            raise PartError("{0}: the server sent another part than asked for", what)
        return _Piece(response.body, int(stated[3]), version, is_part)
