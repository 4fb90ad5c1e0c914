"""The files at an address, whole or in part, over QGIS's own network stack: its proxies and certificates hold.

Files are asked for in pieces, so that long ones show their progress, are cancelled soon and are never in memory whole.
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

#: Bytes of one request: a moment's work for a slow line, and few requests for long files.
_PIECE_BYTES = 4 << 20
#: Python reads whole numbers of some thousand digits only; no file has a length of more than these.
_RANGE = re.compile(r"bytes ([0-9]{1,18})-([0-9]{1,18})/([0-9]{1,18})")


class _Piece(NamedTuple):
    """Bytes of a file from a place on, the size of all of it, its version, and whether a part was sent."""

    data: bytes
    size: int
    version: str
    is_part: bool


class _Transport:
    """QGIS's transport, except for two kinds of answers.

    A part that begins at the end of a file is empty, not a failure. And what a store says of a refusal is kept back, as
    it may quote keys.
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

    `close` ends what is under way from any thread; what is asked then raises `Cancelled`.
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
        # A user waits: few attempts, enough for a hitch.
        self._client = Client(_Transport(transport, may_quote_keys=address.is_s3), address.server, tries=3)

    def close(self) -> None:
        """End it."""
        self._client.close()

    def pieces(
        self,
        name: str,
        go_on: Callable[[float], bool] = lambda _: True,
        most_bytes: int = MAX_FETCHED_FILE_BYTES,
    ) -> Iterator[bytes]:
        """All of a file, piece by piece.

        Parameters
        ----------
        name : str
            In the folder.
        go_on : callable
            Told the share that has come, 0 to 1; returns whether to go on.
        most_bytes : int
            How long it may be.

        Raises
        ------
        NotThere
        PartError, SourceError, Cancelled
            As `Client.get` does.
        OutputError
            A file that is too long, or becomes another one meanwhile.
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
        """Bytes of a file from a place on; fewer where it ends before.

        Raises
        ------
        NotThere
        OutputError
            A server that sends whole files only.
        PartError, SourceError, Cancelled
        """
        if self._sends_parts is None:
            # Not asked of the file itself, which may be long: one that sends no parts would send all of it.
            self._piece(MISSION_FILE, 0, 1)
        if not self._sends_parts:
            raise OutputError(
                "{0}: sends whole files only, and images in shards are parts of files", self.address.server
            )
        pieces = range(start, start + length, _PIECE_BYTES)
        return b"".join(self._piece(name, at, min(at + _PIECE_BYTES, start + length)).data for at in pieces)

    def _refuse_redirects(self, url: str) -> Callable[[str], None]:
        """Refuse redirects of a store to another server, as requests carry the user's credentials."""

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
        # A part without a byte would be asked for again and again.
        length = len(response.body)
        if stated is None or not length or int(stated[1]) != start or int(stated[2]) + 1 - start != length:
            raise PartError("{0}: the server sent another part than asked for", what)
        return _Piece(response.body, int(stated[3]), version, is_part)
