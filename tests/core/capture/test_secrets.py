"""Keys leave the machine in requests and nowhere else: neither in what is printed nor in any file."""

from __future__ import annotations

import base64
import contextlib
import html
import json
import os
import subprocess
import sys
import zlib
from pathlib import Path
from urllib.parse import quote, quote_plus, unquote

import pytest
from PIL import Image

from tests.support.faults import FAULTS
from tests.support.forks import ROOT, Driver
from tests.support.thinning import named, sampled, thinned
from tests.support.tileserver import TileServer

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system forks no processes")

KEY = "AIza-secret/+key with=odd&characters"
SECRET = base64.urlsafe_b64encode(b"the signing secret of a test").decode()
COORDS = "--coords=35.16_-89.90_35.1585_-89.8982_120"
# A key is no less told where some of it is.
SHORTEST = 8


def spellings(secret):
    """Every way a key may be written."""
    plain = {secret, quote(secret), quote(secret, safe=""), quote_plus(secret), html.escape(secret)}
    plain |= {json.dumps(secret)[1:-1], secret[:SHORTEST], secret[-SHORTEST:]}
    found = {text.encode() for text in plain} | {secret.encode("utf-16-le"), secret.encode().hex().encode()}
    for before in range(3):
        # Base64 of a text that holds the key somewhere: what does not depend on what is beside it.
        for encode in (base64.b64encode, base64.urlsafe_b64encode):
            coded = encode(b"x" * before + secret.encode())
            found.add(coded[4 if before else 0 : len(coded) // 4 * 4 - 4])
    return {text.lower() for text in found}


FORBIDDEN = spellings(KEY) | spellings(SECRET) | spellings(base64.urlsafe_b64decode(SECRET).decode())


def texts_of(path):
    """Bytes of a file, and what is packed in it."""
    data = path.read_bytes()
    yield data
    if data.startswith(b"\x89PNG"):
        with Image.open(path) as image:
            image.load()
            yield "\n".join(f"{key}={value}" for key, value in image.info.items()).encode()
    at = data.find(b"\x78")
    while at >= 0 and not data.startswith((b"\x89PNG", b"\xff\xd8", b"II*")):
        with contextlib.suppress(zlib.error):
            yield zlib.decompressobj().decompress(data[at:])
        at = data.find(b"\x78", at + 1)


def searched(folder):
    """Search every file below a folder, names included; returns how many there are."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    for path in files:
        for text in (str(path.relative_to(folder)).encode(), *texts_of(path)):
            lowered = text.lower()
            for spelling in FORBIDDEN:
                assert spelling not in lowered, f"{path} holds {spelling!r}"
    return len(files)


def sent(server):
    """Whether the key was in the requests, so that there was something to hide."""
    return any(KEY in unquote(path) for path in server.requests)


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    home = tmp_path_factory.mktemp("home")
    return {
        "HOME": str(home),
        "TERRAINAV_CACHE_DIR": str(home / "cache"),
        "TERRAINAV_CONFIG_DIR": str(home / "config"),
        "TERRAINAV_KEY": KEY,
        "TERRAINAV_GOOGLE_KEY": KEY,
        "TERRAINAV_GOOGLE_SECRET": SECRET,
        "MPLCONFIGDIR": str(home / "matplotlib"),
    }


@pytest.fixture(scope="module")
def driver(environment):
    with Driver(environment) as running:
        yield running


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


def source_of(server):
    return f"{server.map_type_template}?token={{key}}"


def arguments(command, server, folder, *more):
    given = [command, COORDS, "--overlap", "0.1", "--zoom", "17", "--map-type", "satellite"]
    given += ["--source", source_of(server)]
    return [*given, *(["--data-dir", str(folder / "out")] if command == "capture" else []), *more]


def run(driver, folder, argv, **environment):
    """Run the command; returns its exit code after everything was searched."""
    printed = folder / "printed.txt"
    outcome = driver.run(argv=argv, output=str(printed), debug=True, hasty=True, environment=environment)
    text = printed.read_text(encoding="utf-8")
    assert "Traceback" not in text
    assert text
    assert searched(folder)
    return outcome["code"]


def test_the_search_finds_what_it_is_for(tmp_path):
    from PIL.PngImagePlugin import PngInfo

    for number, text in enumerate(
        [
            KEY,
            quote(KEY, safe=""),
            base64.b64encode(b"token=" + KEY.encode()).decode(),
            base64.b64encode(b"a token=" + KEY.encode() + b"&b").decode(),
            KEY.upper(),
            f"key {SECRET}",
        ]
    ):
        folder = tmp_path / str(number)
        folder.mkdir()
        (folder / "log").write_text(f"before {text} after")
        with pytest.raises(AssertionError):
            searched(folder)
    for name, write in {
        "picture.png": lambda path, info: Image.new("L", (9, 9)).save(path, pnginfo=info),
        "packed.bin": lambda path, _: path.write_bytes(b"some" + zlib.compress(KEY.encode() * 3) + b"more"),
    }.items():
        folder = tmp_path / name
        folder.mkdir()
        info = PngInfo()
        info.add_text("Comment", f"url?token={KEY}", zip=True)
        write(folder / name, info)
        with pytest.raises(AssertionError):
            searched(folder)


@pytest.mark.parametrize("image_format", sampled(["tif", "jpg", "png"], 3))
def test_a_capture_tells_no_key(driver, environment, server, tmp_path, image_format):
    argv = arguments("capture", server, tmp_path, "--format", image_format, "--json")
    assert run(driver, tmp_path, argv) == 0
    assert sent(server)
    assert run(driver, tmp_path, [*argv, "--resume"]) == 0
    assert searched(Path(environment["HOME"])), "no cache was left to be searched"


@pytest.mark.parametrize("more", [[], ["--json"]], ids=["text", "json"])
def test_a_plan_and_its_files_tell_no_key(driver, server, tmp_path, more):
    outputs = [f"--output={tmp_path / name}" for name in ("p.csv", "p.geojson", "p.kml", "p.json")]
    assert run(driver, tmp_path, arguments("plan", server, tmp_path, *outputs, *more)) == 0
    assert len(list(tmp_path.iterdir())) == 5


@pytest.mark.thorough
def test_a_report_tells_no_key(driver, server, tmp_path):
    pytest.importorskip("matplotlib", reason="the report draws with matplotlib")
    argv = arguments("report", server, tmp_path, f"--output={tmp_path / 'report'}")
    assert run(driver, tmp_path, argv) == 0
    assert (tmp_path / "report").is_dir()


# Of each kind of answer one; that errors of the source hold no key is tried with all of them (test_faults).
@pytest.mark.parametrize(
    "kind",
    thinned(
        named(sorted(FAULTS)),
        (
            "401",
            "404",
            "500",
            "bad-copy",
            "bomb",
            "deep-json",
            "flat",
            "quota",
            "redirects",
            "reset",
            "stall",
        ),
    ),
)
def test_a_capture_that_fails_tells_no_key(driver, server, tmp_path, kind):
    server.fail(kind)
    argv = arguments("capture", server, tmp_path, "--no-cache", *(["--json"] if len(kind) % 2 else []))
    # A grey tile is a picture like others to a source of which no placeholder is known, and a bad copy is got round.
    assert run(driver, tmp_path, argv) in ((0,) if kind in ("flat", "bad-copy") else (1, 3))
    assert sent(server)


def echo(handler, code, kind, form, headers=()):
    path = unquote(handler.path)
    handler.answer(code, form.format(path=path, raw=handler.path).encode(), kind, dict(headers))


# Servers that quote what they were asked for.
ECHOES = {
    "403 text": (403, "text/plain", "not allowed: {path}"),
    "403 raw": (403, "text/plain", "not allowed: {raw}"),
    "403 html": (403, "text/html", "<html><title>No {path} here</title></html>"),
    "400 json": (400, "application/json", '{{"error": {{"message": "bad request {raw}"}}}}'),
    "404 text": (404, "text/plain", "{path}"),
    "503 text": (503, "text/plain", "try {raw} later"),
    "429 text": (429, "text/plain", "{path} too often"),
    "200 html": (200, "text/html", "<html><body>{path}</body></html>"),
    "200 text": (200, "text/plain; charset=utf-8", "{raw}"),
    # What is told of a long answer ends within the key.
    **{
        f"{code} cut {where}": (code, "text/plain", "." * where + " {path}")
        for code in (403, 404, 200)
        for where in (135, 145)
    },
}


@pytest.mark.parametrize(
    "kind",
    thinned(
        named(ECHOES),
        (
            "403 raw",
            "403 html",
            "400 json",
            "503 text",
            "200 html",
            "403 cut 135",
            "404 cut 145",
            "200 cut 145",
        ),
    ),
)
def test_a_server_that_quotes_the_key_is_not_quoted(driver, server, tmp_path, monkeypatch, kind):
    monkeypatch.setitem(FAULTS, "404", lambda handler, _body: echo(handler, *ECHOES[kind]))
    server.fail("404")
    assert run(driver, tmp_path, arguments("capture", server, tmp_path)) in (1, 3)
    assert sent(server)


def test_a_redirect_with_the_key_is_not_quoted(driver, server, tmp_path, monkeypatch):
    def elsewhere(handler, _body):
        handler.answer(302, b"", "text/plain", {"Location": f"http://127.0.0.1:9{handler.path}"})

    monkeypatch.setitem(FAULTS, "404", elsewhere)
    server.fail("404")
    assert run(driver, tmp_path, arguments("capture", server, tmp_path)) == 1


def test_no_server_no_name_and_no_folder_tell_no_key(driver, tmp_path):
    with TileServer() as gone:
        pass
    assert run(driver, tmp_path, arguments("capture", gone, tmp_path)) == 1
    argv = arguments("capture", gone, tmp_path, "--source=https://no-such-host.invalid/{z}/{x}/{y}?key={key}")
    assert run(driver, tmp_path, [*argv, "--resume"]) in (1, 3)
    (tmp_path / "file").write_text("mine")
    argv = arguments("capture", gone, tmp_path, f"--data-dir={tmp_path / 'file'}")
    assert run(driver, tmp_path, argv) == 3


@pytest.mark.parametrize(
    "source",
    sampled(
        [
            "http://127.0.0.1:{port}/{{z}}/{{x}}/{{y}}.png?token={key}",
            "http://127.0.0.1:{port}/{{z}}/{{x}}/{{oops}}.png?token={key}",
            "http://user:{key}@127.0.0.1:{port}/{{z}}/{{x}}/{{y}}.png",
            "wms:http://127.0.0.1:{port}/wms?apikey={key}",
            "wmts:http://127.0.0.1:{port}/wmts?apikey={key}",
        ],
        3,
    ),
)
def test_a_key_written_into_the_address_is_refused_and_not_quoted(driver, server, tmp_path, source):
    text = source.format(port=server.port, key=quote(KEY, safe=""))
    for command in ("plan", "capture"):
        argv = arguments(command, server, tmp_path)
        argv[argv.index("--source") + 1] = text
        assert run(driver, tmp_path, argv) in (2, 3)


@pytest.mark.parametrize("fault", sampled([None, "403", "404", "html", "bomb"], 4))
def test_google_static_maps_tell_neither_key_nor_secret(driver, server, tmp_path, fault):
    server.key, server.secret = KEY, SECRET
    if fault:
        server.fail(fault)
    service = {"TERRAINAV_GOOGLE_URL": server.static_map_url}
    argv = arguments("capture", server, tmp_path, "--format=png")
    argv[argv.index("--source") + 1] = "google-static"
    assert run(driver, tmp_path, argv, **service) == (0 if fault is None else 3 if fault == "403" else 1)
    assert sent(server)
    if fault is None:
        # The wrong key: the server quotes it in its refusal.
        server.key = "another"
        argv += ["--resume", f"--data-dir={tmp_path / 'again'}"]
        assert run(driver, tmp_path, argv, **service) == 3


def test_the_command_itself_tells_no_key(environment, server, tmp_path):
    """The installed command, as a person runs it, stopped by the provider."""
    server.fail("401")
    done = subprocess.run(
        [sys.executable, "-m", "terrainav.core.cli", *arguments("capture", server, tmp_path)],
        cwd=ROOT,
        env={**os.environ, **environment},
        check=False,
        capture_output=True,
        timeout=120,
    )
    (tmp_path / "printed").write_bytes(done.stdout + done.stderr)
    assert done.returncode in (1, 3)
    assert b"401" in done.stderr
    assert searched(tmp_path) >= 5
