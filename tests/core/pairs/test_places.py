"""Places read from files and spread over boxes."""

from __future__ import annotations

import itertools

import pytest
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box
from terrainav.core.pairs.places import PairPlace, read_box, read_places, spread_places

from tests.support.growth import PROPORTIONAL, growth

GEOD = Geod(ellps="WGS84")
BOX = Box(35.16, -89.90, 35.00, -89.70)


def written(tmp_path, text):
    path = tmp_path / "places.txt"
    path.write_text(text, encoding="utf-8")
    return path


def test_lines_of_a_file_are_places_with_or_without_names(tmp_path):
    path = written(
        tmp_path,
        "\ufeff# campus\n\n35.12 -89.93\n-33.95,18.46, Sarah Baartman Hall\n\u221233.9_18.4\n1e1;2 4\u20135 North\n",
    )
    assert read_places(path) == (
        PairPlace(35.12, -89.93),
        PairPlace(-33.95, 18.46, "Sarah Baartman Hall"),
        PairPlace(-33.9, 18.4),
        PairPlace(10.0, 2.0, "4\u20135 North"),
    )


def test_the_papers_coordinate_file_is_read_without_its_heights(tmp_path):
    path = written(tmp_path, "35.12 -89.93 120\n35.2 -89.9 150 90\n")
    assert read_places(path) == (PairPlace(35.12, -89.93), PairPlace(35.2, -89.9))


def test_numbers_are_names_where_other_lines_have_words(tmp_path):
    path = written(tmp_path, "35.12 -89.93 42\n35.2 -89.9 Library\n")
    assert [place.name for place in read_places(path)] == ["42", "Library"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("35 -89\nnorth of here\n", "line 2: 'north of here' is not"),
        ("35\n", "line 1: '35' is not"),
        ("35 -89\n95 10 Pole\n", "line 2: latitude 95.0"),
        ("86 10\n", "line 1: latitude 86.0: the map ends at"),
        ("35 -89\n1 2\n35.0 -89.0 again\n", "line 3: the place of line 1 again"),
        ("# nothing\n", "holds none"),
        # As written where commas are decimal: without the sign it could not be told from the paper's file.
        ("# decimals\n35,1 -89,9\n", "line 2: 35 1 with height -89: must be above 0; commas separate"),
        ("35 -89 120\n36 -89 0\n", "line 2: 36 -89 with height 0: must be above 0"),
    ],
)
def test_lines_that_are_no_places_are_named(tmp_path, text, told):
    with pytest.raises(InvalidInput, match=told):
        read_places(written(tmp_path, text))


@pytest.mark.parametrize(
    ("begin", "repeated", "end"), [("", "1", "x"), ("", "1.", ""), ("1 ", "2", "x"), ("1", " ", "")]
)
def test_a_line_of_any_length_is_soon_refused(tmp_path, begin, repeated, end):
    path = tmp_path / "places.txt"

    def read(length):
        path.write_text(f"{begin}{repeated * length}{end}\n", encoding="utf-8")
        with pytest.raises(InvalidInput):
            read_places(path)

    # A pattern that shares digits out in every way took minutes.
    assert growth(read, 12_500) < PROPORTIONAL


def test_a_box_is_read_as_the_paper_writes_it():
    assert read_box("35.16_-89.90_35.00_-89.70") == BOX
    assert read_box("35.16 -89.90 35.00 -89.70 120") == BOX
    with pytest.raises(InvalidInput, match="no such file, and no box"):
        read_box("places.txt")
    with pytest.raises(InvalidInput, match="3 numbers"):
        read_box("1 2 3")


def test_places_of_a_box_keep_their_distance_and_come_from_the_seed():
    places = spread_places(BOX, 12, 1500.0, 7)
    assert all(BOX.south_deg <= p.lat_deg <= BOX.north_deg for p in places)
    assert all(BOX.west_deg <= p.lon_deg <= BOX.east_deg for p in places)
    for one, other in itertools.combinations(places, 2):
        assert GEOD.inv(one.lon_deg, one.lat_deg, other.lon_deg, other.lat_deg)[2] >= 1500.0
    assert spread_places(BOX, 5, 1500.0, 7) == places[:5]
    assert spread_places(BOX, 5, 1500.0, 8) != places[:5]


def test_a_box_across_the_antimeridian_has_places_on_both_sides():
    places = spread_places(Box(-16.0, 179.9, -16.2, -179.9), 20, 0.0, 1)
    assert {place.lon_deg > 0.0 for place in places} == {True, False}
    assert all(179.9 <= abs(place.lon_deg) <= 180.0 for place in places)


def test_a_full_box_says_how_many_it_takes():
    with pytest.raises(InvalidInput, match=r"40 places 8,000 m apart: the box has room for \d"):
        spread_places(BOX, 40, 8000.0, 7)


@pytest.mark.parametrize("count", [0, 10**12])
def test_numbers_of_places_are_checked_before_memory_is_taken(count):
    with pytest.raises(InvalidInput, match="places: must be from 1 to 1,000,000"):
        spread_places(Box(1.0, 0.0, 0.0, 1.0), count, 0.0, 3)
