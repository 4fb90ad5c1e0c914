"""What a reply of Qt's says, as a response or an error of a transport."""

from __future__ import annotations

import zlib
from typing import Callable
from urllib.parse import urljoin

from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtNetwork import QNetworkReply, QNetworkRequest

from ...core.imagery.transport import Response, TransportError
from .errors import is_of_status, problem


def answer_of(
    reply: QNetworkReply, url: str, max_body_bytes: int, has_proxy: Callable[[QUrl], bool]
) -> Response:
    """Read a reply that has finished.

    Parameters
    ----------
    reply : QNetworkReply
    url : str
        What was asked.
    max_body_bytes : int
    has_proxy : callable
        Whether a URL is asked through one.

    Raises
    ------
    TransportError
        It is not whole.
    """
    error = reply.error()
    status = reply.attribute(QNetworkRequest.Attribute.HttpStatusCodeAttribute)
    body = bytes(reply.readAll())
    headers = {
        bytes(name).decode("latin-1").lower(): bytes(value).decode("latin-1")
        for name, value in reply.rawHeaderPairs()
    }
    if len(body) > max_body_bytes:
        raise too_long(max_body_bytes)
    length = headers.get("content-length", "")
    # The length of a 304 is that of the body it stands for.
    counts = status not in (None, 204, 304) and "transfer-encoding" not in headers
    if counts and length.isdigit() and len(body) < int(length):
        raise TransportError(f"body broke off after {len(body)} of {length} bytes")
    if status is None or not is_of_status(error):
        asked = QUrl(url)
        raise problem(error, asked.host(), answered=status is not None, proxy=has_proxy(asked))
    return Response(
        int(status), headers, _unpacked(body, headers.get("content-encoding", ""), max_body_bytes)
    )


def too_long(max_body_bytes: int) -> TransportError:
    """Error of a body beyond its limit."""
    return TransportError(f"body beyond {max_body_bytes} bytes", again=False)


def redirect_target(answer: Response) -> str | None:
    """Where an answer points to, as it says it; None where it is not a redirect."""
    return answer.headers.get("location") if answer.status in (301, 302, 303, 307, 308) else None


def joined(url: str, target: str) -> str:
    """URL that a redirect from ``url`` leads to.

    Raises
    ------
    TransportError
    """
    try:
        return urljoin(url, target)
    except ValueError:
        raise TransportError("redirect to something that is no URL", again=False) from None


def _unpacked(body: bytes, encoding: str, max_body_bytes: int) -> bytes:
    """Unpack a body that was packed although that was not asked for."""
    if encoding.lower() not in ("gzip", "x-gzip", "deflate"):
        return body
    try:
        # 32: zlib or gzip by its header.
        unpacked = zlib.decompressobj(32 + zlib.MAX_WBITS).decompress(body, max_body_bytes + 1)
    except zlib.error:
        raise TransportError("a packed body that is broken") from None
    if len(unpacked) > max_body_bytes:
        raise too_long(max_body_bytes)
    return unpacked
