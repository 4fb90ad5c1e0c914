"""Makes requests over QGIS's network stack, several at a time, in an object of the main thread.

QGIS's network manager is made for layers: it opens dialogs about certificates and passwords, writes addresses (which
contain keys) to the message log, answers from its disk cache, and replaces the user agent. The plain managers used
here have the same proxies, certificates, authentication and hooks of other plugins, but none of this behaviour.

Replies are created, read and deleted on the main thread, with the GIL held. PyQt keeps a list of objects created by
Qt; when such an object is destroyed, PyQt removes it from the list on the main thread, without the GIL. A reply that is
created or deleted on another thread, or by Qt itself, may interrupt this, which sooner or later crashes QGIS.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from qgis.core import QgsApplication, QgsAuthCertUtils, QgsNetworkAccessManager
from qgis.PyQt import sip
from qgis.PyQt.QtCore import QCoreApplication, QObject, Qt, QTimer, QUrl, pyqtSignal, pyqtSlot
from qgis.PyQt.QtNetwork import (
    QNetworkAccessManager,
    QNetworkProxy,
    QNetworkProxyFactory,
    QNetworkProxyQuery,
    QNetworkReply,
    QNetworkRequest,
    QSslConfiguration,
)

from ...core.errors import Cancelled
from ...core.imagery.http.transport import Response, Timeouts, TransportError, too_long, too_many_headers
from .answers import has_too_many_headers, read_answer

#: Number of requests that one Qt manager sends to a server at a time; for more, managers are added.
PER_MANAGER = 6
#: All existing workers, so that the last reference to a worker is not released on another thread.
_ALIVE: set[NetworkWorker] = set()


class Terms(NamedTuple):
    """Options of all requests of a transport.

    Parameters
    ----------
    connections : int
        Largest number of open connections to a host.
    timeouts : Timeouts
        ``read_s`` also limits connecting.
    headers : mapping of str
    max_body_bytes : int
    authcfg : str
        Id of a configuration in QGIS's authentication database; empty for none.
    private : mapping of str
        Headers that, like the configuration, are only sent to the server ``home``.
    home : tuple of scheme and host
        Server for the configuration and private headers, with its subdomains; an empty host for all servers.
    """

    connections: int
    timeouts: Timeouts
    headers: Mapping[str, str]
    max_body_bytes: int
    authcfg: str
    private: Mapping[str, str] = {}
    home: tuple[str, str] = ("", "")

    def match_server(self, exchange: PendingRequest) -> bool:
        """Whether a request gets the configuration and the private headers."""
        parts = urlsplit(exchange.url)
        scheme, host = self.home
        asked = (parts.hostname or "").rstrip(".")
        at_home = not host or (
            (asked == host or asked.endswith("." + host)) and not (scheme == "https" != parts.scheme)
        )
        # Servers to which the first one redirects do not get them.
        return at_home and exchange.at_origin


class PendingRequest:
    """A request until its answer, passed from the calling thread to the main thread and back.

    Parameters
    ----------
    url : str
    headers : mapping
    origin : str
        As in `Transport.get`.

    Attributes
    ----------
    done : threading.Event
        Set once there is an outcome.
    outcome : Response, Exception or None
        Answer or error; None until ``done``, then final.
    until_s, heard_s : float
        Deadline, and time at which the server was last heard, by the worker's clock.
    """

    def __init__(self, url: str, headers: Mapping[str, str], origin: str = "") -> None:
        self.url = url
        self.headers = headers
        #: Whether this is the server that was asked first: redirects to other servers get no credentials.
        self.at_origin = urlsplit(url)[:2] == urlsplit(origin or url)[:2]
        self.received_bytes = 0
        self.until_s = self.heard_s = 0.0
        self.done = threading.Event()
        self.outcome: Response | Exception | None = None
        self._ending = threading.Lock()

    def end(self, outcome: Response | Exception) -> None:
        """Set the outcome, unless there is one."""
        with self._ending:
            if not self.done.is_set():
                self.outcome = outcome
                self.done.set()


class NetworkWorker(QObject):
    """Makes requests on the main thread, on which its slots run; other threads emit its signals.

    A slot takes a fraction of a millisecond (the first one for a TLS server, a few), which users do not notice.

    Parameters
    ----------
    terms : Terms

    Signals
    -------
    asked(PendingRequest)
        A request to start.
    dropped(PendingRequest)
        A request to abandon, as nobody waits for it any longer.
    closing()
        Cancels all requests and deletes the worker; emit nothing afterwards.
    """

    asked = pyqtSignal(object)
    dropped = pyqtSignal(object)
    closing = pyqtSignal()

    def __init__(self, terms: Terms) -> None:
        super().__init__()
        self._terms = terms
        self._usual: QNetworkRequest | None = None
        managers = -(-terms.connections // PER_MANAGER)
        self._rooms = [(terms.connections + place) // managers for place in reversed(range(managers))]
        self._managers: list[QNetworkAccessManager] = []
        self._busy: list[int] = []
        self._timer: QTimer | None = None
        #: Running requests by reply, with the index of their manager.
        self._under_way: dict[QNetworkReply, tuple[PendingRequest, int]] = {}
        self._over: list[QNetworkReply] = []
        self._tls: dict[str, QSslConfiguration] = {}
        #: Servers that have sent too many header lines, which take Qt quadratic time, mostly on the main thread.
        self._talkative: set[str] = set()
        self._clock_s = self._looked_s = 0.0
        self.asked.connect(self._start, Qt.ConnectionType.QueuedConnection)
        self.dropped.connect(self._drop, Qt.ConnectionType.QueuedConnection)
        self.closing.connect(self._close, Qt.ConnectionType.QueuedConnection)
        if not in_main_thread():
            self.moveToThread(QCoreApplication.instance().thread())
        _ALIVE.add(self)

    # --- slots

    @pyqtSlot(object)
    def _start(self, exchange: PendingRequest) -> None:
        if exchange.done.is_set():
            return
        try:
            self._turn()
            exchange.until_s = self._clock_s + self._terms.timeouts.whole_s
            self._send(exchange)
        except Exception as failure:  # noqa: BLE001  (raised in the thread that asked)
            exchange.end(failure)

    @pyqtSlot(object)
    def _drop(self, exchange: PendingRequest) -> None:
        for reply, (under_way, _) in list(self._under_way.items()):
            if under_way is exchange:
                self._abandon(reply)

    @pyqtSlot()
    def _close(self) -> None:
        for reply, (exchange, _) in list(self._under_way.items()):
            self._abandon(reply)
            exchange.end(Cancelled("cancelled while waiting for the network"))
        self._discard()
        if self._timer is not None:
            self._timer.stop()
        self.destroyed.connect(partial(_ALIVE.discard, self))
        # This also deletes its children, the managers.
        self.deleteLater()

    @pyqtSlot()
    def _look(self) -> None:
        self._discard()
        self._turn()
        for reply, (exchange, _) in list(self._under_way.items()):
            received = reply.bytesAvailable()
            if received != exchange.received_bytes:
                exchange.received_bytes = received
                exchange.heard_s = self._clock_s
            late = self._lateness(exchange)
            if late is not None:
                self._abandon(reply)
                exchange.end(late)
        if not self._under_way and not self._over:
            self._timer.stop()

    @pyqtSlot()
    def _headed(self) -> None:
        """Check the headers of an answer as soon as they arrive."""
        reply = self.sender()
        if reply in self._under_way and has_too_many_headers(reply):
            self._shun(reply.url().host(), reply)

    @pyqtSlot()
    def _finished(self) -> None:
        reply = self.sender()
        if reply not in self._under_way:
            return
        exchange = self._release(reply)
        try:
            exchange.end(read_answer(reply, exchange.url, self._terms.max_body_bytes, _has_proxy))
        except Exception as failure:  # noqa: BLE001  (raised in the thread that asked)
            exchange.end(failure)
        finally:
            # Append it last: the calls above may run an event loop, which deletes the replies in this list.
            self._over.append(reply)

    @pyqtSlot("QList<QSslError>")
    def _judge_tls(self, errors: list[Any]) -> None:
        """Ignore the certificate errors that the user has permanently accepted in QGIS for this server."""
        reply = self.sender()
        if not isinstance(reply, QNetworkReply):
            return
        certificate = reply.sslConfiguration().peerCertificate()
        known = QgsApplication.authManager().sslCertCustomConfig(
            QgsAuthCertUtils.shaHexForCert(certificate), _host_and_port(reply.url())
        )
        if not known.isNull() and {error.error() for error in errors} <= set(known.sslIgnoredErrorEnums()):
            reply.ignoreSslErrors(errors)

    # --- steps

    def _turn(self) -> None:
        """Advance the clock by the time since the last call, but at most by a quarter of a second.

        Answers arrive only in the event loop: while that is blocked, requests do not get late.
        """
        now_s = time.monotonic()
        if self._timer is None:
            self._timer = QTimer(self)
            self._timer.timeout.connect(self._look)
        if self._timer.isActive():
            # A longer interval counts as 0.25 s: the main thread was busy and received no answers.
            self._clock_s += min(now_s - self._looked_s, 0.25)
        else:
            # Every 50 ms: a body may exceed its limit for that long.
            self._timer.start(50)
        self._looked_s = now_s

    def _lateness(self, exchange: PendingRequest) -> TransportError | None:
        """Error with which a request must end now; None if it may continue."""
        timeouts = self._terms.timeouts
        if exchange.received_bytes > self._terms.max_body_bytes:
            return too_long(self._terms.max_body_bytes)
        if self._clock_s > exchange.until_s:
            return TransportError("no whole answer within {0:g} s", timeouts.whole_s, late=True)
        if self._clock_s - exchange.heard_s > timeouts.read_s:
            return TransportError(
                "no answer from {0} for {1:g} s", urlsplit(exchange.url).hostname, timeouts.read_s, late=True
            )
        return None

    def _place(self) -> int:
        """Index of the first manager with a free connection, so that no more connections are opened than needed."""
        free = (place for place, busy in enumerate(self._busy) if busy < self._rooms[place])
        place = next(free, None)
        if place is not None:
            return place
        if len(self._managers) == len(self._rooms):
            return self._busy.index(min(self._busy))
        manager = QNetworkAccessManager(self)
        manager.setRedirectPolicy(QNetworkRequest.RedirectPolicy.ManualRedirectPolicy)
        manager.setProxyFactory(_Proxies())
        self._managers.append(manager)
        self._busy.append(0)
        return len(self._managers) - 1

    def _send(self, exchange: PendingRequest) -> None:
        parts = urlsplit(exchange.url)
        url = QUrl(exchange.url)
        if parts.scheme not in ("http", "https") or not url.isValid() or not url.host():
            raise TransportError("the URL is not valid", again=False)
        if url.host() in self._talkative:
            raise too_many_headers()
        trusted = self._terms.match_server(exchange)
        private = self._terms.private if trusted else {}
        request = self._request(url, {**private, **exchange.headers}, self._terms.authcfg if trusted else "")
        exchange.received_bytes = 0
        exchange.heard_s = self._clock_s
        place = self._place()
        reply = self._managers[place].get(request)
        self._busy[place] += 1
        self._under_way[reply] = exchange, place
        # `_look` checks the limit of the body. Do not use setReadBufferSize: Qt 5.15 may crash if the request fails at
        # the same time on Qt's thread.
        if parts.scheme == "https":
            reply.sslErrors.connect(self._judge_tls)
        reply.metaDataChanged.connect(self._headed)
        reply.finished.connect(self._finished)

    def _request(self, url: QUrl, headers: Mapping[str, str], authcfg: str) -> QNetworkRequest:
        if self._usual is None:
            self._usual = QNetworkRequest()
            _set_headers(self._usual, self._terms.headers)
        request = QNetworkRequest(self._usual)
        request.setUrl(url)
        _set_headers(request, headers)
        if authcfg:
            manager = QgsApplication.authManager()
            # QGIS would open a dialog for the master password.
            if not manager.masterPasswordIsSet():
                raise TransportError(
                    "QGIS's authentication database is locked: enter its master password, then try again",
                    again=False,
                )
            applied, request = manager.updateNetworkRequest(request, authcfg)
            if not applied:
                raise TransportError("QGIS could not apply the authentication configuration {0}", authcfg, again=False)
        if url.scheme() == "https":
            request.setSslConfiguration(self._tls_configuration(request, bool(authcfg)))
        # Apply the hooks of other plugins and of the user's organisation.
        QgsNetworkAccessManager.instance().preprocessRequest(request)
        return request

    def _tls_configuration(self, request: QNetworkRequest, authenticated: bool) -> QSslConfiguration:
        """TLS settings of QGIS's authentication manager; cached by server, as the look-up is slow."""
        server = f"{_host_and_port(request.url())} {authenticated}"
        if server not in self._tls:
            configuration = request.sslConfiguration()
            manager = QgsApplication.authManager()
            if not manager.isDisabled():
                configuration.setCaCertificates(
                    QgsAuthCertUtils.casMerge(manager.trustedCaCertsCache(), configuration.caCertificates())
                )
                own = manager.sslCertCustomConfigByHost(_host_and_port(request.url()))
                if not own.isNull():
                    configuration.setProtocol(own.sslProtocol())
                    configuration.setPeerVerifyMode(own.sslPeerVerifyMode())
                    configuration.setPeerVerifyDepth(own.sslPeerVerifyDepth())
            self._tls[server] = configuration
        return self._tls[server]

    def _shun(self, host: str, talking: QNetworkReply) -> None:
        """Refuse a server from now on, and end all requests to it; ``talking`` is the reply now emitting a signal."""
        self._talkative.add(host)
        for reply, (exchange, _) in list(self._under_way.items()):
            if reply.url().host() == host:
                self._abandon(reply)
                exchange.end(too_many_headers())
        # Delete the replies at once, as more of their answers are already waiting for the main thread.
        self._over, over = [reply for reply in self._over if reply is talking], self._over
        for reply in over:
            if reply is not talking:
                sip.delete(reply)

    def _abandon(self, reply: QNetworkReply) -> None:
        self._release(reply)
        reply.metaDataChanged.disconnect(self._headed)
        reply.finished.disconnect(self._finished)
        reply.abort()
        self._over.append(reply)

    def _release(self, reply: QNetworkReply) -> PendingRequest:
        """Free the connection of a reply."""
        exchange, place = self._under_way.pop(reply)
        self._busy[place] -= 1
        return exchange

    def _discard(self) -> None:
        """Delete replies after their last signals; not by `deleteLater`, in which Qt does not hold the GIL."""
        for reply in self._over:
            sip.delete(reply)
        self._over.clear()


def in_main_thread() -> bool:
    """Whether this is the main thread, according to Python: asking Qt would add an object to PyQt's list."""
    return threading.get_ident() == threading.main_thread().ident


class _Proxies(QNetworkProxyFactory):
    """The proxies from QGIS's settings."""

    def queryProxy(self, query: QNetworkProxyQuery) -> list[QNetworkProxy]:
        return QgsNetworkAccessManager.instance().proxyFactory().queryProxy(query)


def _has_proxy(url: QUrl) -> bool:
    first = _Proxies().queryProxy(QNetworkProxyQuery(url))[0]
    return first.type() not in (QNetworkProxy.ProxyType.NoProxy, QNetworkProxy.ProxyType.DefaultProxy)


def _set_headers(request: QNetworkRequest, headers: Mapping[str, str]) -> None:
    for name, value in headers.items():
        request.setRawHeader(name.encode("latin-1"), value.encode("latin-1"))


def _host_and_port(url: QUrl) -> str:
    """Host and port of a server, as in QGIS's authentication database."""
    return f"{url.host().strip()}:{url.port(443)}"
