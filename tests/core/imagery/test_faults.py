"""Every fault of a server, through a source, over real connections."""

from __future__ import annotations

import contextlib
import gzip
import hashlib
import html
import re
import threading
import time
import traceback
import zlib

import numpy as np
import pytest
from terrainav.core.errors import Cancelled, PartError, SourceError, TerrAInavError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.requests_transport import RequestsTransport
from terrainav.core.imagery.http.transport import Timeouts
from terrainav.core.imagery.placeholder import Placeholder
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.xyz import XYZSource

from tests.support.faults import FAULTS, QUOTA_WORDS, flat_placeholder
from tests.support.patterns import positions
from tests.support.thinning import sampled
from tests.support.tileserver import TileServer

TILE = Window(12, 1000 * 256, 1500 * 256, 256, 256)
NAME = "tile 12/1000/1500"
RIGHT = positions("satellite", 12, 1000, 1500, 256)
# Long enough for any answer on the loopback, on a busy machine, too.
PATIENT = Timeouts(connect_s=30.0, read_s=30.0, whole_s=60.0)
# Where no answer comes, short enough to wait for it.
IMPATIENT = {
    "stall": Timeouts(30.0, 1.5, 60.0),
    "stall-mid-body": Timeouts(30.0, 1.5, 60.0),
    "trickle": Timeouts(30.0, 30.0, 1.5),
}
PLACEHOLDER = Placeholder(sha256=(hashlib.sha256(flat_placeholder()).hexdigest(),))
# What the promise of cancelling within half a second may miss on a busy machine, of 20 s and more.
CANCEL_S, BUSY_S = 0.5, 5.0

# Another attempt may bring these right, so they must not cost a picture.
PASSING = [
    "408", "425", "429-seconds", "429-date", "500", "502", "503", "504",
    "stall", "stall-mid-body", "reset", "short-body", "odd-retry-after",
]  # fmt: skip
# Another copy may be right: these are asked for once more, however often an answer that does not come is tried for.
SPOILT = dict.fromkeys(
    ("truncated-jpeg", "corrupt-jpeg", "corrupt", "gif-bomb", "png-without-pixels"), "broken image ("
)
# Nothing brings these right: the part fails at once, and says why.
BROKEN = {
    "204": "204 No Content",
    "404": "404 Not Found: no such tile",
    "410": "410 Gone",
    "html": "text/html instead of an image: Access blocked",
    "wrong-size": "an image of 100x120 px instead of 256x256",
    "flat": "no imagery here: the provider's placeholder image",
    "transparent": "no imagery (a transparent image)",
    "redirects": "more than 5 redirects",
    "redirect-to-file": "redirect to an address that is neither http nor https",
    "200MB": "an answer of more than 33554432 bytes",
    "bomb": "an image of 40000x40000 px instead of 256x256",
    "packed-bomb": "an answer of more than 33554432 bytes",
    "brotli": "an answer compressed as br, which was not requested",
    "redirect-to-nowhere": "redirect to something that is not a URL",
    "many-headers": "an answer of more than 100 header lines",
    "deep-json": f"400 Bad Request: {'[' * 199}…",
}
# These hold for every tile: the run stops, with the provider's own words.
REFUSED = {
    "401": "401 Unauthorized: Invalid access token",
    "403": "403 Forbidden: The provided API key is not allowed here",
    "quota": f"403 Forbidden: {QUOTA_WORDS}",
    "quota-in-400": "400 Bad Request: OVER_QUERY_LIMIT",
    "429-hour": "it asks to come back in 3600 s",
}


@contextlib.contextmanager
def sources_over(transport):
    """Give what makes sources over a transport, and close them."""
    opened = []

    def make(server, tries=2, timeouts=PATIENT, template=None, key=None, cache=None, **options):
        client = Client(
            transport(4, timeouts),
            "The provider",
            connections=4,
            secrets=(key,) if key else (),
            tries=tries,
            first_wait_s=0.01,
            **options,
        )
        opened.append(
            XYZSource(template or server.url_template, placeholder=PLACEHOLDER, client=client, key=key, cache=cache)
        )
        return opened[-1]

    yield make
    for source in opened:
        source.close()


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


@pytest.fixture
def source_of():
    with sources_over(RequestsTransport) as make:
        yield make


def test_the_list_of_faults_is_whole():
    assert {*PASSING, *SPOILT, *BROKEN, *REFUSED, "bad-copy", "trickle"} == set(FAULTS)


@pytest.mark.parametrize("kind", sampled([*PASSING, *SPOILT], 4))
def test_what_passes_costs_no_picture(server, source_of, kind):
    server.fail(kind, times=1)
    began = time.monotonic()
    source = source_of(server, timeouts=IMPATIENT.get(kind, PATIENT))
    assert np.array_equal(source.fetch("satellite", TILE), RIGHT)
    assert sum(server.requests.values()) == 2
    if kind in ("429-seconds", "429-date"):
        # The server asked for a second; dates have whole seconds, so that less may be left of it.
        assert time.monotonic() - began > (0.9 if kind == "429-seconds" else 0.0)


@pytest.mark.parametrize("kind", sampled([kind for kind in PASSING if not kind.startswith("429")], 3))
def test_what_does_not_pass_fails_the_part(server, source_of, kind):
    server.fail(kind)
    source = source_of(server, timeouts=IMPATIENT.get(kind, PATIENT))
    with pytest.raises(PartError, match=rf"^{NAME}: .* \(tried 2 times\)$"):
        source.fetch("satellite", TILE)
    assert sum(server.requests.values()) == 2


def test_too_many_requests_that_do_not_pass_stop_the_run(server, source_of):
    server.fail("429-seconds")
    with pytest.raises(SourceError, match="429 Too Many Requests: slow down"):
        source_of(server).fetch("satellite", TILE)
    assert sum(server.requests.values()) == 2


@pytest.mark.parametrize(("kind", "reason"), BROKEN.items(), ids=BROKEN)
def test_what_is_broken_fails_the_part_at_once(server, source_of, kind, reason):
    server.fail(kind)
    with pytest.raises(PartError) as raised:
        source_of(server).fetch("satellite", TILE)
    assert str(raised.value).startswith(f"{NAME}: {reason}")
    assert "\n" not in str(raised.value)
    assert sum(server.requests.values()) == (6 if kind == "redirects" else 1)


@pytest.mark.parametrize("tries", [1, 2, 5])
@pytest.mark.parametrize("kind", SPOILT)
def test_a_picture_that_stays_broken_is_asked_for_twice(server, source_of, kind, tries):
    server.fail(kind)
    with pytest.raises(PartError, match=rf"^{NAME}: broken image \(.*\) \(tried 2 times\)$"):
        source_of(server, tries=tries).fetch("satellite", TILE)
    assert sum(server.requests.values()) == 2


def test_a_bad_copy_of_a_proxy_costs_no_picture(server, source_of):
    # It lasts: only a request that gets round the copy brings another.
    server.fail("bad-copy")
    assert np.array_equal(source_of(server, tries=1).fetch("satellite", TILE), RIGHT)
    assert sum(server.requests.values()) == 2


def test_the_second_request_for_a_broken_picture_waits_for_its_turn(server, source_of):
    server.fail("corrupt", times=1)
    began = time.monotonic()
    source_of(server, requests_per_s=2.0).fetch("satellite", TILE)
    assert time.monotonic() - began >= 0.5


@pytest.mark.parametrize(("kind", "reason"), [("404", "404 Not Found"), ("500", "500 .*tried 2 times")])
def test_what_becomes_of_the_second_request_for_a_broken_picture_is_the_reason(server, source_of, kind, reason):
    server.fail("corrupt", times=1)
    server.fail(kind)
    with pytest.raises(PartError, match=rf"^{NAME}: {reason}"):
        source_of(server).fetch("satellite", TILE)


@pytest.mark.parametrize(("kind", "reason"), REFUSED.items(), ids=REFUSED)
def test_a_refusal_stops_the_run(server, source_of, kind, reason):
    server.fail(kind)
    with pytest.raises(SourceError) as raised:
        source_of(server).fetch("satellite", TILE)
    assert str(raised.value).startswith("The provider")
    assert reason in str(raised.value)
    assert sum(server.requests.values()) == 1


def test_a_body_that_trickles_is_given_up(server, source_of):
    server.fail("trickle")
    source = source_of(server, tries=1, timeouts=Timeouts(60.0, 60.0, 0.5))
    began = time.monotonic()
    with pytest.raises(PartError, match=r"no whole answer within 0\.5 s"):
        source.fetch("satellite", TILE)
    assert time.monotonic() - began < 0.5 + BUSY_S


@pytest.mark.parametrize(
    "pack",
    [gzip.compress, zlib.compress, lambda body: zlib.compress(body)[2:-4]],
    ids=["gzip", "zlib", "deflate without its header"],
)
def test_a_body_packed_unasked_is_unpacked(server, source_of, monkeypatch, pack):
    coding = "gzip" if pack is gzip.compress else "deflate"

    def packed(handler, body):
        handler.answer(200, pack(body), "image/png", {"Content-Encoding": coding})

    monkeypatch.setitem(FAULTS, "brotli", packed)
    server.fail("brotli")
    assert np.array_equal(source_of(server).fetch("satellite", TILE), RIGHT)


@pytest.mark.parametrize("broken", [b"not packed", gzip.compress(bytes(9000))[:-9], gzip.compress(b"x") * 2])
def test_a_packed_body_that_is_not_whole_is_no_picture(server, source_of, monkeypatch, broken):
    def packed(handler, _body):
        handler.answer(200, broken, "image/png", {"Content-Encoding": "gzip"})

    monkeypatch.setitem(FAULTS, "brotli", packed)
    server.fail("brotli")
    with pytest.raises(PartError, match="a compressed answer that is damaged"):
        source_of(server).fetch("satellite", TILE)


@pytest.mark.parametrize(
    "headers", [{"Cache-Control": "max-age=²"}, {"Content-Length": "²"}, {"Age": "²"}, {"Expires": "9" * 999}]
)
def test_numbers_of_no_digits_cost_no_picture(server, tmp_path, headers, monkeypatch, source_of):
    def odd(handler, body):
        handler.send_response(200)
        for name, value in {"Content-Length": str(len(body)), **headers}.items():
            handler.send_header(name, value)
        handler.end_headers()
        handler.wfile.write(body)
        handler.close_connection = True

    monkeypatch.setitem(FAULTS, "brotli", odd)
    server.fail("brotli")
    source = source_of(server, cache=TileCache(tmp_path))
    assert np.array_equal(source.fetch("satellite", TILE), RIGHT)


def test_each_redirect_waits_for_its_turn(server, source_of):
    server.fail("redirects")
    began = time.monotonic()
    with pytest.raises(PartError, match="more than 5 redirects"):
        source_of(server, requests_per_s=10.0).fetch("satellite", TILE)
    # Six requests, five tenths of a second apart from each other.
    assert time.monotonic() - began >= 0.5
    assert sum(server.requests.values()) == 6


def test_one_fault_costs_no_other_tile(server, source_of):
    server.fail("404", (12, 1000, 1500))
    source = source_of(server)
    with pytest.raises(PartError):
        source.fetch("satellite", TILE)
    assert source.fetch("satellite", TILE._replace(left_px=1001 * 256)).shape == (256, 256, 3)


def test_connections_are_kept_through_faults_that_end_well(server, source_of):
    server.fail("404", share=0.5)
    source = source_of(server)
    answered = 0
    for x in range(40):
        with contextlib.suppress(PartError):
            source.fetch("satellite", TILE._replace(left_px=x * 256))
            answered += 1
    assert 5 < answered < 35
    assert server.connections == 1


def test_no_server_fails_the_part_and_does_not_try_long_for_the_others(source_of):
    with TileServer() as gone:
        template = gone.url_template
    source = source_of(None, tries=3, template=template)
    with pytest.raises(PartError, match=rf"^{NAME}: no connection to 127\.0\.0\.1 \(tried 3 times\)$"):
        source.fetch("satellite", TILE)
    with pytest.raises(PartError, match=r"no connection to 127\.0\.0\.1$"):
        source.fetch("satellite", TILE._replace(left_px=0))


def test_the_whole_server_rests_when_one_request_is_asked_to(server, source_of):
    server.fail("429-seconds", (12, 1000, 1500), times=1)
    source = source_of(server)
    answered = {}

    def fetch(x):
        source.fetch("satellite", TILE._replace(left_px=x * 256))
        answered[x] = time.monotonic()

    first = threading.Thread(target=fetch, args=(1000,))
    began = time.monotonic()
    first.start()
    while not sum(server.requests.values()):
        time.sleep(0.005)
    time.sleep(0.1)
    fetch(1001)
    first.join()
    assert answered[1001] - began > 0.9


@pytest.mark.parametrize(
    "kind",
    ["stall", "stall-mid-body", "trickle", "429-seconds", "corrupt, then stall", "unfinished-connection"],
)
def test_every_wait_ends_when_the_source_is_closed(server, source_of, deaf_template, kind):
    template = deaf_template if kind == "unfinished-connection" else None
    if template is None:
        *once, lasting = kind.split(", then ")
        for passing in once:
            server.fail(passing, times=1)
        server.fail(lasting)
    source = source_of(server, timeouts=Timeouts(20.0, 20.0, 60.0), template=template)
    outcome = []

    def fetch():
        try:
            source.fetch("satellite", TILE)
        except TerrAInavError as failure:
            outcome.append((time.monotonic(), failure))

    fetching = threading.Thread(target=fetch)
    fetching.start()
    time.sleep(0.25)
    assert fetching.is_alive()
    asked = time.monotonic()
    source.close()
    fetching.join(10.0)
    assert not fetching.is_alive()
    ended, failure = outcome[0]
    assert isinstance(failure, Cancelled)
    assert ended - asked < CANCEL_S + BUSY_S


def test_a_closed_source_starts_nothing(server, source_of):
    source = source_of(server)
    source.close()
    with pytest.raises(Cancelled):
        source.fetch("satellite", TILE)
    assert not server.requests


KEY = "AIza-secret/+key with=odd&characters"


def translate(failure):
    """All that a careless program may print of an exception: itself, its chain, the frames' lines."""
    seen, texts = failure, []
    while seen is not None:
        texts += [str(seen), repr(seen), *(str(argument) for argument in seen.args)]
        seen = seen.__cause__ or seen.__context__
    return "\n".join([*texts, *traceback.format_exception(type(failure), failure, failure.__traceback__)])


@pytest.mark.parametrize("kind", sampled([*sorted(set(FAULTS) - {"bad-copy"}), "no server"], 5))
def test_no_error_holds_the_key(server, source_of, kind, caplog):
    from urllib.parse import quote, quote_plus

    caplog.set_level("DEBUG")
    template = server.url_template + "?token={key}"
    if kind == "no server":
        with TileServer() as gone:
            template = gone.url_template + "?token={key}"
    else:
        server.fail(kind)
    timeouts = IMPATIENT.get(kind, PATIENT)
    source = source_of(server, tries=1, timeouts=timeouts, template=template, key=KEY)
    with pytest.raises(TerrAInavError) as raised:
        source.fetch("satellite", TILE)
    everything = "\n".join([translate(raised.value), repr(source), source.name, source.title, caplog.text])
    for written in (KEY, quote(KEY), quote(KEY, safe=""), quote_plus(KEY)):
        assert written not in everything
    if kind != "no server":
        # It was sent, so there was something to hide.
        assert any(quote(KEY, safe="") in path for path in server.requests)


def spelled(text):
    """A key in the spellings that servers echo one in."""
    from urllib.parse import quote, quote_plus

    return {
        "as it is": text,
        "encoded": quote(text, safe=""),
        "lower case": re.sub("%..", lambda found: found[0].lower(), quote(text, safe="")),
        "twice encoded": quote(quote(text, safe=""), safe=""),
        "three times, and lower case": quote(quote(quote(text, safe=""), safe=""), safe="").lower(),
        "a form's": quote_plus(text),
        "upper case": text.upper(),
        "html": html.escape(text),
        "html by numbers": "".join(f"&#x{ord(one):X};" for one in text),
        "json": text.replace("/", "\\/"),
        "json by numbers": "".join(f"\\u{ord(one):04x}" for one in text),
    }


@pytest.mark.parametrize(("how", "written"), spelled(KEY).items(), ids=spelled(KEY))
def test_the_provider_s_own_words_do_not_tell_the_key(server, source_of, monkeypatch, how, written):
    def quote_key(handler, _body):
        handler.answer(403, f"API key {written} is invalid".encode(), "text/plain")

    monkeypatch.setitem(FAULTS, "403", quote_key)
    server.fail("403")
    source = source_of(server, template=server.url_template + "?token={key}", key=KEY)
    with pytest.raises(SourceError, match=r"API key \*\*\* is invalid"):
        source.fetch("satellite", TILE)


def test_many_threads_get_every_pixel_right_through_a_mix_of_faults(server, source_of):
    for kind in ("500", "503", "short-body", "reset"):
        server.fail(kind, share=0.1, times=1)
    source = source_of(server, tries=5)
    failures = []

    def fetch(xs):
        for x in xs:
            pixels = source.fetch("satellite", TILE._replace(left_px=x * 256))
            if not np.array_equal(pixels, positions("satellite", 12, x, 1500, 256)):
                failures.append(x)

    threads = [threading.Thread(target=fetch, args=(range(start, 120, 8),)) for start in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    assert len(server.tile_requests) == 120
    # Eight threads share four connections; those that were torn were made anew.
    assert server.connections < 60


def test_zoom_and_row_beyond_the_map(server, source_of):
    source = source_of(server)
    with pytest.raises(PartError, match="tile 3/1/8: beyond the edge of the map"):
        source.fetch("satellite", Window(3, 256, 8 * 256, 256, 256))
    with pytest.raises(PartError, match="tile 3/1/-1: beyond the edge of the map"):
        source.fetch("satellite", Window(3, 256, -256, 256, 256))
    assert source.grid == PixelGrid()
    assert not server.requests
