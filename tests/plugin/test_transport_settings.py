"""What the user has set in QGIS holds for its network stack as a transport: certificates, proxy, authentication."""

from __future__ import annotations

import base64
import shutil
import socket
import ssl
import subprocess
from pathlib import Path

import pytest
from qgis.core import (
    QgsApplication,
    QgsAuthCertUtils,
    QgsAuthConfigSslServer,
    QgsAuthMethodConfig,
)
from qgis.PyQt.QtNetwork import QSslCertificate, QSslError
from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.transport import TransportError, user_agent

from tests.plugin.transports import (  # noqa: F401  (fixtures)
    MASTER_PASSWORD,
    PASSWORD,
    PICTURE,
    USER,
    Handler,
    Server,
    server_fixture,
    settings_fixture,
    told_fixture,
    transport_of_fixture,
)

# --- TLS


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    """An authority, and a certificate it has signed for the loopback."""
    if shutil.which("openssl") is None:
        pytest.skip("makes certificates with openssl, which is not installed")
    folder = tmp_path_factory.mktemp("certificates")
    names = folder / "names"
    names.write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n", encoding="utf-8")
    ca = ["-x509", "-subj", "/CN=Test authority", "-keyout", "ca.key", "-out", "ca.pem", "-days", "2"]
    own = ["-subj", "/CN=localhost", "-keyout", "own.key", "-out", "own.csr"]
    sign = [
        "-req",
        "-in",
        "own.csr",
        "-CA",
        "ca.pem",
        "-CAkey",
        "ca.key",
        "-CAcreateserial",
        "-out",
        "own.pem",
    ]
    for command in (
        ["req", "-newkey", "rsa:2048", "-nodes", *ca],
        ["req", "-newkey", "rsa:2048", "-nodes", *own],
        ["x509", *sign, "-days", "2", "-extfile", str(names)],
    ):
        subprocess.run(["openssl", *command], cwd=folder, check=True, capture_output=True)
    return folder


@pytest.fixture
def tls_server(certificates, settings):
    # The tests' own profile has a proxy that nobody is behind for all but HTTP on the loopback.
    settings("proxy/proxyEnabled", False)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificates / "own.pem", certificates / "own.key")
    with Server() as running:
        running.socket = context.wrap_socket(running.socket, server_side=True)
        running.tls_url = f"https://localhost:{running.server_address[1]}"
        yield running


def certificate_at(path: Path):
    return QSslCertificate.fromPath(str(path))[0]


def test_a_certificate_of_nobody_known_is_not_trusted(tls_server, transport_of):
    with pytest.raises(TransportError, match=r"no trusted connection to localhost \(TLS\)") as raised:
        transport_of().get(tls_server.tls_url + "/?key=secret")
    assert (raised.value.again, raised.value.away) == (False, True)
    assert tls_server.seen == []


def test_an_authority_that_qgis_trusts_is_trusted(tls_server, transport_of, certificates):
    manager, authority = QgsApplication.authManager(), certificate_at(certificates / "ca.pem")
    assert manager.storeCertAuthority(authority)
    manager.rebuildCaCertsCache()
    manager.storeCertTrustPolicy(authority, QgsAuthCertUtils.Trusted)
    manager.rebuildTrustedCaCertsCache()
    try:
        transport = transport_of()
        for _ in range(2):
            assert transport.get(tls_server.tls_url + "/").body == PICTURE
    finally:
        manager.removeCertTrustPolicy(authority)
        manager.removeCertAuthority(authority)
        manager.rebuildCaCertsCache()
        manager.rebuildTrustedCaCertsCache()
    with pytest.raises(TransportError, match="TLS"):
        transport_of().get(tls_server.tls_url + "/")


@pytest.mark.parametrize("enough", [True, False])
def test_errors_that_the_user_lets_pass_of_one_server_pass(tls_server, transport_of, certificates, enough):
    manager, certificate = QgsApplication.authManager(), certificate_at(certificates / "own.pem")
    name = f"localhost:{tls_server.server_address[1]}"
    exception = QgsAuthConfigSslServer()
    exception.setSslCertificate(certificate)
    exception.setSslHostPort(name)
    passing = [
        QSslError.SslError.UnableToGetLocalIssuerCertificate,
        QSslError.SslError.UnableToVerifyFirstCertificate,
        QSslError.SslError.CertificateUntrusted,
    ]
    exception.setSslIgnoredErrorEnums(passing if enough else [QSslError.SslError.CertificateExpired])
    assert manager.storeSslCertCustomConfig(exception)
    try:
        if enough:
            assert transport_of().get(tls_server.tls_url + "/").body == PICTURE
        else:
            with pytest.raises(TransportError, match="TLS"):
                transport_of().get(tls_server.tls_url + "/")
    finally:
        manager.removeSslCertCustomConfig(QgsAuthCertUtils.shaHexForCert(certificate), name)


# --- proxy


@pytest.fixture
def through_proxy(server, settings):
    """``server`` is the proxy of QGIS's settings."""
    settings("proxy/proxyEnabled", True)
    settings("proxy/proxyType", "HttpProxy")
    settings("proxy/proxyHost", "127.0.0.1")
    settings("proxy/proxyPort", str(server.server_address[1]))
    settings("proxy/proxyUser", "")
    settings("proxy/proxyPassword", "")
    settings("proxy/noProxyUrls", ["http://127.0.0.1"])
    return server


def test_the_proxy_of_qgis_s_settings_is_asked(through_proxy, transport_of):
    assert transport_of().get("http://tiles.invalid/1/2/3.png").body == PICTURE
    path, headers = through_proxy.seen[0]
    assert (path, headers["host"]) == ("http://tiles.invalid/1/2/3.png", "tiles.invalid")
    assert headers["user-agent"] == user_agent()


def test_addresses_without_proxy_are_asked_themselves(through_proxy, transport_of):
    with Server() as direct:
        assert transport_of().get(direct.url + "/").body == PICTURE
        assert len(direct.seen) == 1
    assert through_proxy.seen == []


def test_name_and_password_of_the_proxy_are_sent(through_proxy, transport_of, settings, monkeypatch):
    expected = "Basic " + base64.b64encode(f"{USER}:{PASSWORD}".encode()).decode()
    right = Handler.do_GET

    def guarded(handler):
        if handler.headers.get("Proxy-Authorization") == expected:
            right(handler)
            return
        handler.send_response(407)
        handler.send_header("Proxy-Authenticate", 'Basic realm="proxy"')
        handler.send_header("Content-Length", "0")
        handler.end_headers()

    monkeypatch.setattr(Handler, "do_GET", guarded)
    monkeypatch.setattr(Handler, "do_CONNECT", guarded)
    assert transport_of().get("http://tiles.invalid/").status == 407
    with pytest.raises(TransportError, match="the proxy asks for a user name and password") as raised:
        transport_of().get("https://tiles.invalid/")
    assert (raised.value.again, raised.value.away) == (False, True)
    settings("proxy/proxyUser", USER)
    settings("proxy/proxyPassword", PASSWORD)
    assert transport_of().get("http://tiles.invalid/").body == PICTURE


def test_a_proxy_that_is_not_there_is_named(through_proxy, transport_of, settings):
    with socket.create_server(("127.0.0.1", 0)) as gone:
        settings("proxy/proxyPort", str(gone.getsockname()[1]))
    for scheme in ("http", "https"):
        with pytest.raises(TransportError, match="the proxy does not answer") as raised:
            transport_of().get(f"{scheme}://tiles.invalid/")
        assert raised.value.away


# --- authentication configurations


@pytest.fixture
def authcfg():
    manager = QgsApplication.authManager()
    manager.setMasterPassword(MASTER_PASSWORD, True)
    config = QgsAuthMethodConfig("Basic")
    config.setName("tiles")
    config.setConfig("username", USER)
    config.setConfig("password", PASSWORD)
    assert manager.storeAuthenticationConfig(config)
    yield config.id()
    manager.setMasterPassword(MASTER_PASSWORD, True)
    manager.removeAuthenticationConfig(config.id())


def test_an_authentication_configuration_is_applied(server, transport_of, authcfg):
    transport = transport_of(authcfg=authcfg)
    for _ in range(2):
        transport.get(server.url + "/")
    sent = {headers.get("authorization") for _, headers in server.seen}
    assert sent == {"Basic " + base64.b64encode(f"{USER}:{PASSWORD}".encode()).decode()}


def test_credentials_are_not_for_the_server_that_another_points_to(server, transport_of, authcfg):
    with Server() as other:
        server.answer = (302, {"Location": other.url + "/there"}, b"")
        client = Client(transport_of(authcfg=authcfg), "P")
        assert client.get(server.url + "/", "w").body == PICTURE
        assert "authorization" in server.seen[0][1]
        assert "authorization" not in other.seen[0][1]


def test_credentials_are_not_for_a_server_that_capabilities_name(server, transport_of, authcfg):
    """Neither the configuration nor the connection's own headers: another host, and the same one in the open."""
    options = {"authcfg": authcfg, "headers": {"X-Api-Key": "own"}}
    for home in (("http", "tiles.example"), ("https", "127.0.0.1"), ("http", "0.0.1")):
        transport_of(**options, home=home).get(server.url + "/")
    transport_of(**options, home=("http", "127.0.0.1")).get(server.url + "/")
    sent = [("authorization" in headers, "x-api-key" in headers) for _, headers in server.seen]
    # The third is a subdomain by its name.
    assert sent == [(False, False), (False, False), (True, True), (True, True)]


def test_a_connection_s_headers_are_not_for_the_server_that_another_points_to(server, transport_of):
    with Server() as other:
        server.answer = (302, {"Location": other.url + "/there"}, b"")
        client = Client(transport_of(headers={"X-Api-Key": "own"}), "P")
        assert client.get(server.url + "/", "w").body == PICTURE
        assert server.seen[0][1]["x-api-key"] == "own"
        assert "x-api-key" not in other.seen[0][1]


def test_a_configuration_that_is_not_there_is_said(server, transport_of, authcfg):
    with pytest.raises(TransportError, match="could not apply the authentication configuration 0000000") as raised:
        transport_of(authcfg="0000000").get(server.url + "/")
    assert not raised.value.again
    assert server.seen == []


def test_a_locked_database_opens_no_dialog(server, transport_of, authcfg):
    QgsApplication.authManager().clearMasterPassword()
    with pytest.raises(TransportError, match="authentication database is locked"):
        transport_of(authcfg=authcfg).get(server.url + "/")
    assert server.seen == []
