"""Manners: rates, waits, what providers say. The transport is a list of answers: no network."""

from __future__ import annotations

import threading
import time
from email.utils import formatdate

import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import Cancelled, PartError, SourceError
from terrainav.core.imagery.http import client as client_module
from terrainav.core.imagery.http.client import LONGEST_WAIT_S, Client, OutOfReach, Pace, retry_after_s
from terrainav.core.imagery.http.transport import Response, TransportError, user_agent
from terrainav.core.limits import MAX_LATE_PARTS
from terrainav.core.text.plain import first_words


class Answers:
    """A transport that gives what it was told to, in turn; the last one for ever."""

    def __init__(self, *answers):
        self.answers = list(answers)
        self.asked = []
        self.most_at_once = self.at_once = 0
        self.lock = threading.Lock()

    def get(self, url, headers=None, origin=""):
        with self.lock:
            self.asked.append((time.monotonic(), url))
            self.at_once += 1
            self.most_at_once = max(self.most_at_once, self.at_once)
            answer = self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]
        time.sleep(0.005)
        with self.lock:
            self.at_once -= 1
        if isinstance(answer, Exception):
            raise answer
        return answer

    def close(self):
        pass


def answer(status=200, body=b"", **headers):
    return Response(status, {name.replace("_", "-"): value for name, value in headers.items()}, body)


def client_of(*answers, **options):
    transport = Answers(*answers)
    return Client(transport, "P", **{"first_wait_s": 0.001, **options}), transport


def test_we_say_who_we_are():
    assert user_agent().startswith("TerrAInav/")
    assert "https://github.com/terrainav/terrainav" in user_agent()


def test_requests_keep_the_rate():
    client, transport = client_of(answer(), requests_per_s=50.0)
    threads = [threading.Thread(target=client.get, args=("u", "w")) for _ in range(11)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    times = sorted(asked for asked, _ in transport.asked)
    assert len(times) == 11
    assert times[-1] - times[0] > 0.95 * 10 / 50.0


def test_no_more_requests_at_once_than_connections():
    client, transport = client_of(answer(), connections=3)
    threads = [threading.Thread(target=client.get, args=("u", "w")) for _ in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(transport.asked) == 20
    assert transport.most_at_once <= 3


@given(st.floats(0.1, 1000.0), st.integers(1, 50))
def test_turns_are_a_step_apart(requests_per_s, turns):
    pace = Pace(requests_per_s)
    waits = [pace.turn_s() for _ in range(turns)]
    assert waits[0] == 0.0
    # The clock runs on between two turns, so that waits grow by at most a step each.
    assert waits[-1] <= (turns - 1) / requests_per_s + 1e-6


def test_a_hold_outlives_a_shorter_one():
    pace = Pace()
    pace.hold(5.0)
    pace.hold(0.1)
    assert 4.0 < pace.held_s() <= 5.0


@pytest.mark.parametrize(
    ("headers", "seconds"),
    [
        ({}, 0.0),
        ({"retry_after": "7"}, 7.0),
        ({"retry_after": formatdate(1_000_060, usegmt=True)}, 60.0),
        ({"retry_after": formatdate(999_000, usegmt=True)}, 0.0),
        # A server whose clock is an hour ahead means what its own date says.
        (
            {"retry_after": formatdate(1_003_630, usegmt=True), "date": formatdate(1_003_600, usegmt=True)},
            30.0,
        ),
        ({"retry_after": "soon"}, 0.0),
        ({"retry_after": "-3"}, 0.0),
        ({"retry_after": "²"}, 0.0),
        ({"retry_after": "9" * 5000}, 1e18),
        ({"retry_after": "Mon, 01 Jan 99999999999 00:00:00 GMT"}, 0.0),
    ],
)
def test_retry_after_in_seconds_and_as_a_date(headers, seconds):
    assert retry_after_s(answer(429, **headers), 1_000_000.0) == seconds


def test_a_wait_that_is_too_long_stops_the_run():
    client, transport = client_of(answer(503, b"maintenance", retry_after="121"))
    with pytest.raises(SourceError, match="P: 503 Service Unavailable: maintenance; it asks to come back in 121 s"):
        client.get("u", "w")
    assert len(transport.asked) == 1


def test_waits_grow_and_are_spread_and_capped():
    client, _ = client_of(answer(), first_wait_s=1.0)
    for attempt in range(12):
        waits = {client._backoff_s(f"https://h/{x}", attempt) for x in range(50)}
        middle = min(2.0**attempt, LONGEST_WAIT_S)
        assert len(waits) > 40
        assert 0.5 * middle <= min(waits) < 0.75 * middle
        assert 1.25 * middle < max(waits) <= 1.5 * middle
    assert client._backoff_s("https://h/1", 3) == client._backoff_s("https://h/1", 3)


def test_away_is_remembered_until_an_answer_comes():
    gone = TransportError("no connection", away=True)
    client, transport = client_of(gone, gone, gone, gone, gone, answer(), gone, tries=3)
    for tries in (3, 1, 1):
        before = len(transport.asked)
        with pytest.raises(PartError):
            client.get("u", "w")
        assert len(transport.asked) - before == tries
    client.get("u", "w")
    before = len(transport.asked)
    with pytest.raises(PartError):
        client.get("u", "w")
    assert len(transport.asked) - before == 3


LATE = TransportError("no whole answer within 60 s", late=True)


def test_a_server_that_keeps_everybody_waiting_is_left_alone():
    client, transport = client_of(LATE, tries=2)
    for _ in range(MAX_LATE_PARTS):
        with pytest.raises(OutOfReach, match=r"^w: no whole answer within 60 s \(tried 2 times\)$"):
            client.get("u", "w")
    for _ in range(100):
        with pytest.raises(OutOfReach, match=r"^w: not requested, as the last 5 requests had no answer in time"):
            client.get("u", "w")
    assert len(transport.asked) == 2 * MAX_LATE_PARTS
    assert client.out_of_reach()


def test_a_server_that_was_left_alone_is_tried_again_later(monkeypatch):
    client, transport = client_of(*[LATE] * (MAX_LATE_PARTS + 1), answer(), tries=1)
    for _ in range(MAX_LATE_PARTS + 1):
        with pytest.raises(OutOfReach):
            client.get("u", "w")
    assert len(transport.asked) == MAX_LATE_PARTS
    monkeypatch.setattr(client, "out_of_reach", lambda: False)
    with pytest.raises(OutOfReach, match="no whole answer"):
        client.get("u", "w")
    assert client.get("u", "w").status == 200
    monkeypatch.undo()
    assert client.get("u", "w").status == 200


def test_an_answer_now_and_then_keeps_a_slow_server_in_use():
    client, transport = client_of(*[LATE, LATE, LATE, answer(404)] * 5, answer(), tries=1)
    for _ in range(20):
        with pytest.raises(PartError):
            client.get("u", "w")
    assert len(transport.asked) == 20


def test_a_refused_connection_is_not_waited_for_and_leaves_nothing_out():
    client, transport = client_of(TransportError("no connection", away=True), tries=1)
    for _ in range(3 * MAX_LATE_PARTS):
        with pytest.raises(PartError, match="no connection"):
            client.get("u", "w")
    assert len(transport.asked) == 3 * MAX_LATE_PARTS


def test_no_further_attempt_begins_once_a_part_has_taken_its_time(monkeypatch):
    # A request of the transport here takes 5 ms at least.
    monkeypatch.setattr(client_module, "MAX_PART_S", 0.012)
    client, transport = client_of(LATE, tries=50)
    with pytest.raises(OutOfReach, match=r"no whole answer within 60 s \(tried \d times\)|within 60 s$"):
        client.get("u", "w")
    assert 1 <= len(transport.asked) <= 3


def test_waits_that_a_server_asks_for_count_for_no_limit(monkeypatch):
    monkeypatch.setattr(client_module, "MAX_PART_S", 0.5)
    client, transport = client_of(answer(503, retry_after="1"), answer())
    assert client.get("u", "w").status == 200
    assert len(transport.asked) == 2


def redirect(target, status=302):
    return answer(status, location=target)


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_redirects_are_requests_with_a_turn_each(status):
    client, transport = client_of(redirect("/b", status), redirect("c", status), answer(), requests_per_s=20.0)
    allowed = []
    began = time.monotonic()
    client.get("http://h/a", "w", allow=allowed.append)
    assert [url for _, url in transport.asked] == ["http://h/a", "http://h/b", "http://h/c"] == allowed
    # Turns are counted from the first: on a busy machine a late request may come close before the next.
    assert all(asked >= began + turn / 20.0 for turn, (asked, _) in enumerate(transport.asked))


def test_where_a_redirect_may_not_lead_it_is_not_followed():
    client, transport = client_of(redirect("http://other/b"), answer())

    def allow(url):
        if "other" in url:
            raise SourceError("not there")

    with pytest.raises(SourceError, match="not there"):
        client.get("http://h/a", "w", allow=allow)
    assert len(transport.asked) == 1


@pytest.mark.parametrize("wrong", [ZeroDivisionError("of k€y/1"), RecursionError("k€y/1"), MemoryError()])
def test_what_nobody_foresaw_is_the_failure_of_a_part_and_shows_no_key(caplog, wrong):
    client, _ = client_of(wrong, secrets=("k€y/1",))
    for _ in range(2):
        with pytest.raises(PartError, match=rf"^w: unexpected error \({type(wrong).__name__}") as raised:
            client.get("http://h/?key=k%e2%82%acy%2F1", "w")
        assert raised.value.__cause__ is raised.value.__context__ is None
        assert "y/1" not in str(raised.value)
    (record,) = caplog.records
    assert "Traceback" in record.getMessage()
    assert "y/1" not in record.getMessage()


def test_what_nobody_foresaw_in_reading_a_picture_is_the_failure_of_a_part(caplog):
    def read(response):
        raise AssertionError(f"of {response.body!r}")

    client, _ = client_of(answer(body=b"secret"), secrets=("secret",))
    with pytest.raises(PartError, match=r"^w: unexpected error \(AssertionError: of b'\*\*\*'\)$"):
        client.picture("u", "w", read)
    assert "Traceback" in caplog.text
    assert "secret" not in caplog.text


def test_what_another_attempt_cannot_mend_is_not_tried_again():
    client, transport = client_of(TransportError("more than 5 redirects", again=False))
    with pytest.raises(PartError, match=r"^w: more than 5 redirects$"):
        client.get("u", "w")
    assert len(transport.asked) == 1


def test_a_long_wait_is_left_when_the_client_is_closed():
    client, _ = client_of(answer(503), first_wait_s=20.0)
    threading.Timer(0.1, client.close).start()
    began = time.monotonic()
    with pytest.raises(Cancelled):
        client.get("u", "w")
    assert time.monotonic() - began < 10.0


@pytest.mark.parametrize("status", [401, 402, 403, 407, 451])
def test_refusals(status):
    client, _ = client_of(answer(status, b"Pay first"))
    with pytest.raises(SourceError, match=f"P refuses: {status} .*: Pay first"):
        client.get("u", "w")


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (400, "API key not valid"),
        (404, "rate limit exceeded"),
        (429, "Daily quota reached"),
        (500, "OVER_QUERY_LIMIT"),
    ],
)
def test_quota_by_its_words(status, words):
    client, transport = client_of(answer(status, words.encode()))
    with pytest.raises(SourceError, match=words):
        client.get("u", "w")
    assert len(transport.asked) == 1


@pytest.mark.parametrize(
    ("body", "kind", "words"),
    [
        (b"\n\n  plain words\nmore", "text/plain", "plain words"),
        (b"<html><head><title> The\ttitle </title></head><body>x</body></html>", "text/html", "The title"),
        (b"<p>a &lt; b</p>", "", "a < b"),
        (b'{"error": {"code": 7, "message": "Over quota"}}', "application/json", "Over quota"),
        (b'["nothing here"]', "", "nothing here"),
        (b"{not json", "application/json", "{not json"),
        (b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "image/png", ""),
        ("überlastet".encode(), "", "überlastet"),
        (b"bell\x07 and \x1b[31mred", "", "bell  and  [31mred"),
        (b"", "", ""),
    ],
)
def test_first_words(body, kind, words):
    assert first_words(body, kind) == words


def test_long_words_are_cut():
    assert len(first_words(b"x" * 5000, "")) == 200


@given(st.text(min_size=6, max_size=40))
def test_secrets_are_redacted_however_they_are_quoted(secret):
    from urllib.parse import quote, quote_plus

    client, _ = client_of(answer(), secrets=(secret,))
    for written in (secret, quote(secret), quote(secret, safe=""), quote_plus(secret)):
        assert client.redacted(f"before\0{written}\0after").split("\0")[1:-1] == ["***"] or "\0" in secret
