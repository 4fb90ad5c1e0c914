"""Numbers as the user writes them, in all that the plugin shows."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from qgis.PyQt.QtCore import QLocale
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QLabel, QLineEdit
from terrainav.core.errors import InvalidInput, Message
from terrainav.core.mission.areas.area import Box, Points
from terrainav.terrainav_plugin.form import mission_form
from terrainav.terrainav_plugin.form.area import area_of_text
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.form.text import (
    looks_like_coordinates,
    short_aspect,
    short_degrees,
    short_place,
)
from terrainav.terrainav_plugin.i18n import number_text, translate
from terrainav.terrainav_plugin.panel.elevation import HeightsLine
from terrainav.terrainav_plugin.units import area_text, duration_text, length_text
from terrainav.terrainav_plugin.widgets import spin

#: Narrow no-break space, between thousands in French.
THIN = "\N{NARROW NO-BREAK SPACE}"


@pytest.fixture
def country():
    """Sets a country's way to write numbers; the language stays."""
    before = QLocale()

    def write_as(name):
        locale = QLocale(name)
        # As QGIS does unless the user ticks "show group separator", for the fields that are typed into.
        locale.setNumberOptions(locale.numberOptions() | QLocale.NumberOption.OmitGroupSeparator)
        QLocale.setDefault(locale)

    yield write_as
    QLocale.setDefault(before)


@pytest.mark.parametrize(
    ("name", "whole", "share", "small"),
    [
        ("en_US", "72,883", "1,234.50", "0.5"),
        ("es_ES", "72.883", "1.234,50", "0,5"),
        ("es_MX", "72,883", "1,234.50", "0.5"),
        ("fr_FR", f"72{THIN}883", f"1{THIN}234,50", "0,5"),
        ("de_CH", "72’883", "1’234.50", "0.5"),
    ],
)
def test_numbers_of_a_country(country, name, whole, share, small):
    country(name)
    assert number_text(72883) == whole
    assert number_text(1234.5, ",.2f") == share
    assert number_text(0.5, "g") == small


@pytest.mark.parametrize(
    ("message", "spanish"),
    [
        (Message("{0:,.0f} {1}", 72_883.0, "m²"), "72.883 m²"),
        (Message("≤ {0:.2g} px, {1:,} of {2!r}", 1.2e-9, 3_329, 0.5), "≤ 1,2e-09 px, 3.329 of 0,5"),
        (Message("{0} deg", 95.0), "95,0 deg"),
        # Names, addresses and versions are no numbers, and words of the core have none of their own.
        (Message("{0}: {1!r}, QGIS 3.22.16", "127.0.0.1", "1,234.5"), "127.0.0.1: '1,234.5', QGIS 3.22.16"),
        ("2.525 km", "2.525 km"),
    ],
)
def test_numbers_in_messages(country, message, spanish):
    country("es_ES")
    assert translate(message) == spanish
    country("en_US")
    assert translate(message) == str(message)


def test_one_way_for_all_figures(country):
    country("es_ES")
    assert area_text(7_288.3, "m") == "7.288 m²"
    assert area_text(72_883.0, "m") == "72.883 m²"
    assert length_text(2_525.0, "m") == "2,525 km"
    assert length_text(2_525.0, "ft") == "1,569 mi"
    assert duration_text(9_000.0) == "2,5 h"
    # Numbers in what the core says.
    assert translate(InvalidInput("tile size {0:,} px: must be {1} or less", 5000.5, 512)) == (
        "tile size 5.000,5 px: must be 512 or less"
    )


def swapped(text):
    """Text with Spanish numbers in place of English ones: points and commas between digits change places."""
    return re.sub(r"(?<=\d)[.,](?=\d)", lambda sign: "," if sign[0] == "." else ".", text)


def test_all_that_the_panel_shows_is_written_one_way(desk, country):
    """The same figures in two countries differ in their signs between digits, and in nothing else."""

    def shown():
        for north in ("35.17", "35.16"):
            desk.enter_box(north, "-89.90", "35.115", "-89.823")
            desk.wait_planned()
        figures = desk.dock.figures
        words = desk.form.findChild(QLabel, "describe_area")
        # Without what was timed, which is another each time.
        details = re.sub(r"<tr><td[^>]*>Cost.*?</tr>", "", figures.details.text())
        return [figures.estimates.text(), details, figures.warnings.text(), words.text()]

    desk.form.overlap_along.setValue(25.0)
    country("en_US")
    english = shown()
    country("es_ES")
    spanish = shown()
    country("en_US")
    assert any(re.search(r"\d,\d{3}", text) for text in english)
    assert any(re.search(r"\d\.\d", text) for text in english)
    assert spanish == [swapped(text) for text in english]


# --- typed


PLACE = Points(((35.14, -89.9, 50.0),))
#: A box and a height, in which each number has decimals.
WHOLE = (Box(35.16, -89.9, 35.115, -89.823), 120.5)


@pytest.mark.parametrize(
    ("name", "text", "area", "agl_m"),
    [
        # Points before decimals are understood everywhere; commas are then between numbers.
        *((name, "35.14, -89.9", PLACE, None) for name in ("en_US", "es_ES", "de_DE")),
        *((name, "35.16,-89.9,35.115,-89.823,120.5", *WHOLE) for name in ("en_US", "es_ES", "de_DE")),
        *((name, "35.16_-89.90_35.115_-89.823_120.5", *WHOLE) for name in ("en_US", "es_ES", "de_DE")),
        *((name, "1, 2, 3", Points(((1.0, 2.0, 3.0),)), 3.0) for name in ("en_US", "es_ES", "de_DE")),
        # Without points commas are before decimals where the user writes them so, and other signs between numbers.
        *((name, "35,14, -89,9", PLACE, None) for name in ("es_ES", "de_DE")),
        *((name, "35,14 -89,9", PLACE, None) for name in ("es_ES", "de_DE")),
        ("es_ES", "35,14;\u221289,9", PLACE, None),
        ("fr_FR", "35,16_-89,9_35,115_-89,823_120,5", *WHOLE),
        ("de_DE", "35,14 -89,9 50\n36 -89,5 50", Points(((35.14, -89.9, 50.0), (36.0, -89.5, 50.0))), 50.0),
        # Elsewhere they are between numbers.
        ("en_US", "36,-90 35,-89", Box(36.0, -90.0, 35.0, -89.0), None),
    ],
)
def test_coordinates_of_a_country(country, name, text, area, agl_m):
    country(name)
    assert area_of_text(text, 50.0, "m") == (area, agl_m)


def test_commas_that_could_be_either_are_refused(country):
    country("es_ES")
    for text in ("35,14,-89,9", "36,7,35,8"):
        assert looks_like_coordinates(text)
        with pytest.raises(InvalidInput, match="a comma may stand between numbers or before decimals"):
            area_of_text(text, 50.0, "m")
    # One number, which is being typed.
    assert not looks_like_coordinates("35,14")


@pytest.mark.parametrize(
    ("name", "sign", "between"), [("en_US", ".", ", "), ("es_ES", ",", "; "), ("de_DE", ",", "; ")]
)
def test_texts_of_numbers_are_shown_as_the_user_writes_them(country, name, sign, between):
    country(name)
    assert short_degrees("35.1454915269515") == f"35{sign}1454915"
    assert short_degrees("-89,86") == f"-89{sign}86"
    assert short_degrees("35") == "35"
    assert short_aspect("1320:989") == f"1{sign}335"
    assert short_aspect("4:3") == "4:3"
    assert short_place("35.1454915269515, -90") == f"35{sign}1454915{between}-90"


@pytest.mark.parametrize("name", ["en_US", "es_ES", "de_DE"])
def test_a_take_off_point_as_it_is_shown(country, name):
    country(name)
    exact = mission_form.takeoff_text((35.14, -89.9))
    for text in (exact, short_place(exact), "35.14 -89.9"):
        assert mission_form.takeoff(FormState(takeoff=text)) == (35.14, -89.9)
    with pytest.raises(InvalidInput, match=re.escape(short_place("35.15, -89.9"))):
        mission_form.takeoff(FormState(takeoff="35 north"))


def test_edges_and_heights_are_shown_and_typed_with_the_users_sign(desk, country):
    country("es_ES")
    state = replace(desk.session.state(), north="35.16", west="-89.9", south="35.115", east="-89.823")
    state = replace(state, aspect="1.5", takeoff="35.14, -89.9", elevation=("12.5",))
    desk.form.set_state(state)
    assert desk.session.state() == state
    assert [edit.text() for edit in desk.form.edges.values()] == ["35,16", "-89,9", "35,115", "-89,823"]
    assert (desk.form.aspect.text(), desk.form.route.takeoff.text()) == ("1,5", "35,14; -89,9")
    assert desk.form.findChild(HeightsLine, "elevation").text() == "12,5"
    for typed in ("35,17", "35.17"):
        desk.type_text(desk.form.edges["north"], typed)
        assert mission_form.mission(desk.session.state()).area.north_deg == 35.17


@pytest.mark.parametrize("name", ["en_US", "es_ES", "de_DE", "fr_FR"])
def test_spin_boxes_take_points_everywhere(country, name):
    country(name)
    box = spin("azimuth", -1e6, 1e6, 7, " °", "")
    sign = QLocale().decimalPoint()
    for typed in ("35.146", f"35{sign}146"):
        line = box.findChild(QLineEdit)
        line.selectAll()
        QTest.keyClicks(line, typed)
        box.interpretText()
        assert (box.value(), box.text()) == (35.146, f"35{sign}146 °")
