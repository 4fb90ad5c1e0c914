"""What a reply of Qt's says, as a response or an error of a transport."""

from __future__ import annotations

from typing import Callable

from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtNetwork import QNetworkReply, QNetworkRequest

from ...core.imagery.http.transport import Response, check_length, too_long, unpacked
from ...core.limits import MAX_HEADERS
from .errors import is_of_status, problem

#: Statuses whose Content-Length is that of the body they stand for, and none of a reply that failed.
_BODILESS = (None, 204, 304)


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
    if len(body) > max_body_bytes:
        raise too_long(max_body_bytes)
    headers = {
        bytes(name).decode("latin-1").lower(): bytes(value).decode("latin-1")
        for name, value in reply.rawHeaderPairs()
    }
    if status not in _BODILESS:
        check_length(len(body), headers)
    if status is None or not is_of_status(error):
        asked = QUrl(url)
        raise problem(error, asked.host(), answered=status is not None, proxy=has_proxy(asked))
    return Response(int(status), headers, unpacked(body, headers, max_body_bytes))


def has_too_many_headers(reply: QNetworkReply) -> bool:
    """Whether an answer has more header lines than any server means to send."""
    return len(reply.rawHeaderList()) > MAX_HEADERS
