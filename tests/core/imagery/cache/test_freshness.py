"""What headers say of keeping an answer (RFC 9111)."""

from __future__ import annotations

from email.utils import formatdate

import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.imagery.http.transport import (
    HEURISTIC_LIFETIME_S,
    LONGEST_LIFETIME_S,
    cache_control,
    freshness,
    http_date_s,
)

NOW_S = 1_700_000_000
WEEK_S = 7 * 86400


def date(offset_s=0):
    return formatdate(NOW_S + offset_s, usegmt=True)


@pytest.mark.parametrize(
    ("headers", "left_s"),
    [
        ({}, WEEK_S),
        ({"cache-control": "public"}, WEEK_S),
        ({"cache-control": "max-age=60"}, 60),
        ({"cache-control": 'Max-Age="60", private'}, 60),
        ({"cache-control": "max-age = 60"}, 60),
        ({"cache-control": "max-age=0"}, 0),
        ({"cache-control": "max-age=soon"}, 0),
        ({"cache-control": "max-age=-1"}, 0),
        ({"cache-control": "max-age"}, 0),
        ({"cache-control": "max-age=60, max-age=10"}, 10),
        ({"cache-control": "max-age=99999999999999999999"}, LONGEST_LIFETIME_S),
        # What is for shared caches only.
        ({"cache-control": "s-maxage=5, proxy-revalidate, max-age=60"}, 60),
        ({"cache-control": "no-cache, max-age=60"}, 0),
        ({"cache-control": 'no-cache="Set-Cookie, max-age=7"'}, 0),
        # max-age goes before Expires, and Expires is read against the server's own clock.
        ({"cache-control": "max-age=60", "expires": date(900)}, 60),
        ({"expires": date(900)}, 900),
        ({"expires": date(900), "date": date(300)}, 600),
        ({"expires": date(-900)}, 0),
        ({"expires": "0"}, 0),
        ({"expires": "-1"}, 0),
        # Time spent in caches on the way, and since the server's date.
        ({"cache-control": "max-age=60", "age": "20"}, 40),
        ({"cache-control": "max-age=60", "age": "90"}, -30),
        ({"cache-control": "max-age=60", "date": date(-50)}, 10),
        ({"cache-control": "max-age=60", "date": date(-50), "age": "20"}, 10),
        ({"cache-control": "max-age=60", "date": date(3600)}, 60),
        ({"expires": date(900), "date": date(-100)}, 900),
    ],
)
def test_how_long_an_answer_is_fresh(headers, left_s):
    found = freshness(headers, NOW_S)
    assert found.expires_s - NOW_S == left_s
    assert found.is_fresh(NOW_S) == (left_s > 0)
    assert found.is_fresh(NOW_S + left_s - 1)
    assert not found.is_fresh(NOW_S + left_s)


@pytest.mark.parametrize(
    "headers",
    [
        {"cache-control": "no-store"},
        {"cache-control": "max-age=60, NO-STORE"},
        {"vary": "*"},
        {"vary": "accept, *"},
    ],
)
def test_what_must_not_be_stored(headers):
    assert freshness(headers, NOW_S) is None


@pytest.mark.parametrize(
    ("control", "allowed"),
    [
        ("max-age=60", True),
        ("private", True),
        ("no-cache", False),
        ("must-revalidate, max-age=60", False),
        ("proxy-revalidate", True),
        ('extension="no-cache, must-revalidate"', True),
    ],
)
def test_what_may_be_used_stale(control, allowed):
    assert freshness({"cache-control": control}, NOW_S).stale_allowed is allowed


def test_conditions_are_the_validators_as_they_came():
    headers = {"etag": 'W/"a, b"', "last-modified": date(-5)}
    found = freshness(headers, NOW_S)
    assert found.conditions() == {"If-None-Match": 'W/"a, b"', "If-Modified-Since": date(-5)}
    assert freshness({}, NOW_S).conditions() == {}
    # What cannot be sent back is no validator.
    assert freshness({"etag": '"\u20ac"', "last-modified": "a\nb"}, NOW_S).conditions() == {}


def test_a_confirmation_renews():
    old = freshness({"cache-control": "max-age=60, must-revalidate", "etag": '"1"'}, NOW_S)
    later_s = NOW_S + 1000
    assert old.renewed({}, later_s) == old._replace(expires_s=later_s + 60)
    new = old.renewed({"cache-control": "max-age=5", "etag": '"2"'}, later_s)
    assert (new.expires_s, new.etag, new.stale_allowed) == (later_s + 5, '"2"', True)
    assert old.renewed({"cache-control": "no-store"}, later_s) is None


@pytest.mark.parametrize(
    "text",
    ["Sun, 06 Nov 1994 08:49:37 GMT", "Sunday, 06-Nov-94 08:49:37 GMT", "Sun Nov  6 08:49:37 1994"],
)
def test_the_three_forms_of_a_date(text):
    assert http_date_s(text) == 784111777


@given(st.text(), st.text(), st.text(), st.text())
def test_no_header_breaks_it(control, expires, age, sent):
    headers = {"cache-control": control, "expires": expires, "age": age, "date": sent}
    found = freshness(headers, NOW_S)
    if found is not None:
        assert -LONGEST_LIFETIME_S <= found.expires_s - NOW_S <= LONGEST_LIFETIME_S


@given(st.lists(st.tuples(st.sampled_from(["max-age", "public", "x"]), st.integers(0, 10**6)), max_size=5))
def test_directives_are_read_back(pairs):
    found = cache_control(", ".join(f"{name}={value}" for name, value in pairs))
    least = {name: str(min(value for other, value in pairs if other == name)) for name, _ in pairs}
    assert found == least


def test_the_heuristic_is_a_week():
    assert HEURISTIC_LIFETIME_S == WEEK_S
