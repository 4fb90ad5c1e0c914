"""What went wrong on the network, in words of our own: those of Qt quote addresses, which hold keys."""

from __future__ import annotations

from typing import Any

from qgis.PyQt.QtNetwork import QNetworkReply

from ...core.imagery.http.transport import TransportError

_Error = QNetworkReply.NetworkError
#: Answers with a status that says what is wrong: to be judged by those who asked.
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
        # What Qt makes of 400 and 418.
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


def is_of_status(error: Any) -> bool:
    """Whether an error says no more than the status of an answer that came whole."""
    return error in _OF_STATUS


def problem(error: Any, host: str, *, answered: bool, proxy: bool) -> TransportError:
    """Error of a transport.

    Parameters
    ----------
    error : QNetworkReply.NetworkError
    host : str
    answered : bool
        Whether an answer had begun.
    proxy : bool
        Whether the host is asked through one.
    """
    if error == _Error.SslHandshakeFailedError:
        return TransportError(f"no trusted connection to {host} (TLS)", again=False, away=True)
    if error == _Error.ProxyAuthenticationRequiredError:
        return TransportError("the proxy asks for a user name and password", again=False, away=True)
    if error in _NOT_A_URL:
        return TransportError("the URL is not valid", again=False)
    if error in _PROXY or (error in _AWAY and proxy and not answered):
        return TransportError("the proxy does not answer", away=True)
    if error in _AWAY and not answered:
        return TransportError(f"no connection to {host}", away=True, late=error == _Error.TimeoutError)
    return TransportError(f"connection to {host} broke off")
