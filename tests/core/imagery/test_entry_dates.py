"""Dates: their forms, and what a service's time dimension says of them."""

from __future__ import annotations

import datetime as dt

import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.entry import Dates, time_dimension_dates

RELEASES = {"2014-02-20": "10", "2018-06-27": "13161", "2020-10-14": "119"}


@pytest.mark.parametrize(
    ("dates", "right", "wrong"),
    [
        (
            Dates("day", "2015-11-24", "2024-06-21"),
            ["2015-11-24", "2024-02-29"],
            ["2015-11-23", "2023-02-29", "2023", "20230101", "2024-6-1", "yesterday"],
        ),
        (
            Dates("year", "2018", "2024", "2024"),
            ["2018", "2024"],
            ["2017", "2025", "18", "2020-01-01", "MMXX"],
        ),
        (Dates("listed", default="2020-10-14", values=RELEASES), list(RELEASES), ["2014-02-21", "10", ""]),
        (Dates("any"), ["2024-06-21T12:00:00Z", "v3"], ["", "a\nb"]),
    ],
    ids=lambda value: value.kind if isinstance(value, Dates) else "",
)
def test_dates_of_each_kind(dates, right, wrong):
    for date in right:
        assert dates.checked(date) == date
    for date in wrong:
        with pytest.raises(InvalidInput) as raised:
            dates.checked(date)
        assert raised.value.field == "date"
        assert repr(date) in str(raised.value)
        assert "\n" not in str(raised.value)


def test_days_to_come_are_none_of_those_there_are():
    to_now = Dates("day", "2015-11-24", "2024-06-21")
    today = dt.datetime.now(dt.timezone.utc).date()
    assert to_now.checked(today.isoformat())
    # Somewhere it may be tomorrow already, but never the day after.
    with pytest.raises(InvalidInput, match="from 2015-11-24 to now"):
        to_now.checked((today + dt.timedelta(days=2)).isoformat())
    with pytest.raises(InvalidInput, match="from 2018 to now"):
        Dates("year", "2018", "2024").checked(str(today.year + 2))


def test_listed_dates_stand_for_what_the_address_needs():
    dates = Dates("listed", default="2020-10-14", values=RELEASES)
    assert (dates.first, dates.last) == ("2014-02-20", "2020-10-14")
    assert dates.written("2018-06-27") == "13161"
    assert Dates("year", "2018", "2024").written("2019") == "2019"


def test_the_dates_around_one_that_is_not_there_are_named():
    many = {f"20{year:02d}": str(year) for year in range(0, 90, 10)}
    with pytest.raises(InvalidInput, match="such as 2020, 2030, 2040, 2050, 2060, 2070"):
        Dates("listed", default="2000", values=many).checked("2045")


@pytest.mark.parametrize(
    "options",
    [
        {"kind": "week"},
        {"kind": "listed"},
        {"kind": "year", "first": "2018", "default": "2018", "values": {"2018": "x"}},
        {"kind": "day", "first": "2020-01-01", "default": "2019-12-31"},
        {"kind": "listed", "default": "2019", "values": {"2020": "x"}},
    ],
)
def test_dates_that_make_no_sense(options):
    with pytest.raises(InvalidInput):
        Dates(**options)


@pytest.mark.parametrize(
    ("values", "default", "expected"),
    [
        ([], "", None),
        ([], "current", ("any", "", "current", "")),
        (["2019", " 2021 "], "2021", ("listed", "2019", "2021", "2021")),
        (["2019", "2021"], "", ("listed", "2019", "2021", "2021")),
        (["2019-01-01/2020-12-31/P1D"], "2020-06-01", ("day", "2019-01-01", "2020-06-01", "2020-12-31")),
        (["2001/2020/P1Y"], "", ("year", "2001", "2020", "2020")),
        # What is no row of days or years is left to the server.
        (["2019-01-01T00Z/2020-12-31T00Z/PT1H"], "", ("any", "2019-01-01T00Z", "", "2020-12-31T00Z")),
        (["2019-01-01/2020-12-31/P1D", "2022-05-01"], "2022-05-01", ("any", "2019-01-01", "2022-05-01", "2020-12-31")),
        (["2019-01-01/2020-12-31/P1D"], "current", ("any", "2019-01-01", "current", "2020-12-31")),
    ],
)  # fmt: skip
def test_time_dimensions(values, default, expected):
    dates = time_dimension_dates(values, default)
    assert expected == (dates and (dates.kind, dates.first, dates.default, dates.last))


def test_words_for_people():
    assert Dates("day", "2015-11-24", "2024-06-21").text() == "every day from 2015-11-24 to now; 2024-06-21 by default"
    assert Dates("any").text() == "as the server takes them; one must be asked for"
    assert Dates("listed", default="2020-10-14", values=RELEASES).text().startswith("2014-02-20, 2018-06-27")
    many = {str(year): "" for year in range(2000, 2020)}
    assert Dates("listed", default="2001", values=many).text() == "20 from 2000 to 2019; 2001 by default"
