"""Servers of datasets that lead elsewhere: no request goes to another host than the user has named."""

from __future__ import annotations

import pickle
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from terrainav.core.errors import OutputError
from terrainav.core.storage import stores

from tests.support.thinning import sampled

REGION = {"x-amz-bucket-region": "eu-west-1"}
ERROR = "<?xml version='1.0'?><Error><Code>{code}</Code><Message>m</Message><Endpoint>{host}</Endpoint></Error>"


class Server(ThreadingHTTPServer):
    """Answers as it is told, and notes what it is asked."""

    daemon_threads = True

    def __init__(self, answer):
        super().__init__(("127.0.0.1", 0), Handler)
        self.answer, self.asked = answer, []
        threading.Thread(target=self.serve_forever, args=(0.01,), daemon=True).start()

    def __exit__(self, *_):
        self.shutdown()
        self.server_close()


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def answer(self):
        self.rfile.read(int(self.headers.get("Content-Length") or 0))
        self.server.asked.append(f"{self.command} {self.path}")
        code, headers, body = self.server.answer(self.path)
        self.send_response(code)
        for name, value in {**headers, "Content-Length": str(len(body))}.items():
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)


for method in ("GET", "HEAD", "PUT", "POST", "DELETE"):
    setattr(Handler, f"do_{method}", Handler.answer)


@pytest.fixture
def other():
    """Return what would answer wherever it is asked, by another name of this machine."""
    with Server(lambda _: (200, {"ETag": '"x"'}, b"another's")) as server:
        yield server


def leading(kind, port):
    """Answers that lead to another host, in the ways that HTTP and S3 have."""
    host = f"localhost:{port}"
    if isinstance(kind, int):
        return lambda path: (kind, {"Location": f"http://{host}{path}"}, b"")
    code = {"PermanentRedirect": 301, "TemporaryRedirect": 307}[kind]
    body = ERROR.format(code=kind, host=host).encode()
    return lambda path: (code, {**REGION, "Location": f"http://{host}{path}"}, body)


def opened(path):
    with path.open("rb") as file:
        return file.read()


ASKED = {
    "get": stores.get,
    "part": lambda path: stores.get_range(path, 0, 1),
    "list": stores.list_sizes,
    "is file": stores.is_file,
    "put": lambda path: stores.put(path, b"mine"),
    "put new": lambda path: stores.put_new(path, b"mine"),
    "remove": stores.remove,
    "in another process": lambda path: stores.get(pickle.loads(pickle.dumps(path))),
}
READ = {name: ASKED[name] for name in ("get", "part", "list", "is file", "in another process")}


def refused(ask, path, other, first):
    """Ask, and find that nothing went to the other server, and that this is said."""
    with pytest.raises(OutputError, match="its server leads to another one, which is not asked"):
        ask(path)
    assert other.asked == []
    assert 0 < len(first.asked) < 12


@pytest.fixture
def s3(monkeypatch):
    s3fs = pytest.importorskip("s3fs", reason="needs s3fs")
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN"):
        monkeypatch.setenv(name, "MINE")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")

    def use(server):
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{server.server_port}")
        s3fs.S3FileSystem.clear_instance_cache()
        return stores.store_path("s3://data/run/a")

    yield use
    s3fs.S3FileSystem.clear_instance_cache()


@pytest.mark.parametrize("ask", sampled(ASKED, 4))
@pytest.mark.parametrize("kind", [307, "PermanentRedirect"])
def test_s3_is_asked_where_the_user_has_said(s3, other, kind, ask):
    with Server(leading(kind, other.server_port)) as first:
        refused(ASKED[ask], s3(first), other, first)


@pytest.mark.parametrize("kind", [301, 302, 303, 308, "TemporaryRedirect"])
def test_s3_follows_no_kind_of_redirect(s3, other, kind):
    with Server(leading(kind, other.server_port)) as first:
        refused(stores.get, s3(first), other, first)


def test_what_opens_an_object_by_itself_is_led_nowhere_either(s3, other):
    with Server(leading(307, other.server_port)) as first:
        path = s3(first)
        with pytest.raises(OutputError, match="which is not asked"), stores.store_errors(path):
            opened(path)
    assert other.asked == []


@pytest.mark.parametrize("region", ["x@localhost:{port}/", "localhost:{port}/", "eu-west-1"])
def test_s3_goes_to_no_host_that_a_region_names(s3, other, region):
    region = region.format(port=other.server_port)
    with Server(lambda _: (301, {"x-amz-bucket-region": region}, b"")) as first:
        with pytest.raises(OutputError):
            stores.get(s3(first))
        assert 0 < len(first.asked) < 12
    assert other.asked == []


def test_options_that_the_user_has_set_for_s3_stay(s3, monkeypatch):
    fsspec = pytest.importorskip("fsspec")
    monkeypatch.setitem(fsspec.config.conf, "s3", {"config_kwargs": {"max_pool_connections": 7}})
    with Server(lambda _: (200, {"ETag": '"x"'}, b"mine")) as first:
        path = s3(first)
        assert stores.get(path) == b"mine"
        assert path.fs.config_kwargs["max_pool_connections"] == 7


@pytest.mark.parametrize("ask", READ)
@pytest.mark.parametrize("kind", [302, 307])
def test_a_dataset_on_a_web_server_is_read_from_there(other, kind, ask):
    pytest.importorskip("aiohttp", reason="needs aiohttp")
    with Server(leading(kind, other.server_port)) as first:
        path = stores.store_path(f"http://127.0.0.1:{first.server_port}/run/a")
        refused(READ[ask], path, other, first)


def test_a_web_server_may_lead_to_itself():
    pytest.importorskip("aiohttp", reason="needs aiohttp")
    with Server(lambda path: (302, {"Location": "/b"}, b"") if path == "/a" else (200, {}, b"mine")) as first:
        assert stores.get(stores.store_path(f"http://127.0.0.1:{first.server_port}/a")) == b"mine"


@pytest.mark.parametrize("ask", ASKED)
@pytest.mark.parametrize("kind", ["gs", "az"])
def test_other_stores_are_asked_where_the_user_has_said(monkeypatch, other, kind, ask):
    pytest.importorskip({"gs": "gcsfs", "az": "adlfs"}[kind], reason="needs the store's package")
    with Server(leading(307, other.server_port)) as first:
        server = f"http://127.0.0.1:{first.server_port}"
        monkeypatch.setenv("STORAGE_EMULATOR_HOST", server)
        account = f"AccountName=dev;AccountKey=c2VjcmV0;BlobEndpoint={server}/dev;"
        monkeypatch.setenv("AZURE_STORAGE_CONNECTION_STRING", f"DefaultEndpointsProtocol=http;{account}")
        refused(ASKED[ask], stores.store_path(f"{kind}://data/run/a"), other, first)
