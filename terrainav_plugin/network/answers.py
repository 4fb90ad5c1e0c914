"""Conversion of Qt's replies to a transport's responses or errors, without Qt's terms."""

from __future__ import annotations

from typing import Any, Callable

from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtNetwork import QNetworkReply, QNetworkRequest

from ...core.imagery.http.transport import Response, TransportError, check_length, too_long, unpacked
from ...core.limits import MAX_HEADERS

_Error = QNetworkReply.NetworkError
#: Errors that stand for a complete answer with an error status, which the caller handles.
_OF_STATUS = frozenset(
    [
        _Error.NoError,
        _Error.ContentAccessDenied,
        _Error.ContentOperationNotPermittedError,
        _Error.ContentNotFoundError,
        _Error.AuthenticationRequiredError,
        _Error.ContentReSendError,
        _Error.ContentConflictError,
        _Error.ContentGoneError,
        _Error.UnknownContentError,
        _Error.InternalServerError,
        _Error.OperationNotImplementedError,
        _Error.ServiceUnavailableError,
        _Error.UnknownServerError,
        _Error.ProxyAuthenticationRequiredError,
        # Qt's error for status 400 and 418.
        _Error.ProtocolInvalidOperationError,
    ]
)
_PROXY = frozenset(
    [
        _Error.ProxyConnectionRefusedError,
        _Error.ProxyConnectionClosedError,
        _Error.ProxyNotFoundError,
        _Error.ProxyTimeoutError,
        _Error.UnknownProxyError,
    ]
)
_AWAY = frozenset(
    [
        _Error.ConnectionRefusedError,
        _Error.HostNotFoundError,
        _Error.TimeoutError,
        _Error.TemporaryNetworkFailureError,
        _Error.NetworkSessionFailedError,
        _Error.UnknownNetworkError,
    ]
)
_NOT_A_URL = frozenset([_Error.ProtocolUnknownError, _Error.ProtocolInvalidOperationError])


def read_answer(reply: QNetworkReply, url: str, max_body_bytes: int, has_proxy: Callable[[QUrl], bool]) -> Response:
    """Read a reply that has finished.

    Parameters
    ----------
    reply : QNetworkReply
    url : str
        Address requested.
    max_body_bytes : int
    has_proxy : callable
        Returns whether a URL is requested through a proxy.

    Raises
    ------
    TransportError
        The answer is incomplete.
    """
    error = reply.error()
    status = reply.attribute(QNetworkRequest.Attribute.HttpStatusCodeAttribute)
    body = bytes(reply.readAll())
    if len(body) > max_body_bytes:
        raise too_long(max_body_bytes)
    headers = {
        bytes(name).decode("latin-1").lower(): bytes(value).decode("latin-1") for name, value in reply.rawHeaderPairs()
    }
    if status not in (None, 204, 304):
        check_length(len(body), headers)
    if status is None or not is_of_status(error):
        asked = QUrl(url)
        raise problem(error, asked.host(), answered=status is not None, proxy=has_proxy(asked))
    return Response(int(status), headers, unpacked(body, headers, max_body_bytes))


def has_too_many_headers(reply: QNetworkReply) -> bool:
    """Whether an answer has more header lines than regular servers send."""
    return len(reply.rawHeaderList()) > MAX_HEADERS


def is_of_status(error: Any) -> bool:
    """Whether an error only reflects the status of a complete answer."""
    return error in _OF_STATUS


def problem(error: Any, host: str, *, answered: bool, proxy: bool) -> TransportError:
    """Error of a transport.

    Parameters
    ----------
    error : QNetworkReply.NetworkError
    host : str
    answered : bool
        Whether the answer had begun.
    proxy : bool
        Whether the host is reached through a proxy.
    """
    if error == _Error.SslHandshakeFailedError:
        return TransportError("no trusted connection to {0} (TLS)", host, again=False, away=True)
    if error == _Error.ProxyAuthenticationRequiredError:
        return TransportError("the proxy asks for a user name and password", again=False, away=True)
    if error in _NOT_A_URL:
        return TransportError("the URL is not valid", again=False)
    if error in _PROXY or (error in _AWAY and proxy and not answered):
        return TransportError("the proxy does not answer", away=True)
    if error in _AWAY and not answered:
        return TransportError("no connection to {0}", host, away=True, late=error == _Error.TimeoutError)
    return TransportError("connection to {0} was lost", host)
