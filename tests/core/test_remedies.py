"""Every thing that a message of the core advises is done, and works; a new message of the kind has to be put here."""

from __future__ import annotations

import pytest

from tests.core.remedies import (  # noqa: F401
    benchmarks,
    blocks,
    buildings,
    commands,
    datasets,
    files,
    foreign,
    imagery,
    labels,
    lines,
    live,
    missions,
    pairs,
    planning,
    poses,
    relief,
    routes,
    sequences,
    sunlight,
    varied,
)
from tests.support.remedies import ENTRIES, Case, places, unknown_beginnings
from tests.support.thinning import sampled


def test_each_place_with_advice_has_its_entry():
    found = places("core")
    assert [str(place) for place in found if place not in ENTRIES] == []
    assert [str(place) for place in ENTRIES if place not in found] == []
    # One of two alike in a module would go untried.
    assert [str(place) for place, times in found.items() if times > 1] == []


def test_advice_is_known_by_its_first_word():
    assert unknown_beginnings("core") == set()


@pytest.mark.parametrize(
    "place",
    sampled([pytest.param(place) for place in ENTRIES], 4),
    ids=lambda place: f"{place.module}: {place.message[place.advice_at :]}",
)
def test_what_is_advised_works(place, request):
    case = Case(place, "core", request)
    ENTRIES[place](case)
    case.check()
