"""Every thing that a message of the plugin advises is done in the real QGIS, and works; a new one has to be put in."""

from __future__ import annotations

import pytest

from tests.plugin.remedies import areas, layers, live, missions, panel  # noqa: F401
from tests.plugin.remedies.areas import small_pictures  # noqa: F401
from tests.plugin.remedies.layers import connections, project  # noqa: F401
from tests.plugin.remedies.missions import _provider, cleaning, looking  # noqa: F401
from tests.plugin.test_live_view import opened_live  # noqa: F401
from tests.plugin.test_sources_keys import configured  # noqa: F401
from tests.plugin.transports import server_fixture, transport_of_fixture  # noqa: F401
from tests.support.remedies import ENTRIES, Case, places, unknown_beginnings
from tests.support.thinning import sampled

PACKAGE = "terrainav_plugin"


@pytest.mark.any_qgis
def test_each_place_with_advice_has_its_entry():
    found = places(PACKAGE)
    assert [str(place) for place in found if place not in ENTRIES] == []
    assert [str(place) for place in ENTRIES if place not in found] == []
    # One of two alike in a module would go untried.
    assert [str(place) for place, times in found.items() if times > 1] == []


@pytest.mark.any_qgis
def test_advice_is_known_by_its_first_word():
    assert unknown_beginnings(PACKAGE) == set()


# OWSLib, when it is first loaded under Python 3.11.
@pytest.mark.filterwarnings("ignore:'cgi' is deprecated")
@pytest.mark.parametrize(
    "place",
    sampled([pytest.param(place) for place in ENTRIES], 3),
    ids=lambda place: f"{place.module}: {place.message[place.advice_at :]}",
)
def test_what_is_advised_works(place, request):
    case = Case(place, PACKAGE, request)
    ENTRIES[place](case)
    case.check()
