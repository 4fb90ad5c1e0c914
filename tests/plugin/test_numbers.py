"""Numbers as the user writes them, in all that the plugin shows."""

from __future__ import annotations

import re

import pytest
from qgis.PyQt.QtCore import QLocale
from qgis.PyQt.QtWidgets import QLabel
from terrainav.core.errors import InvalidInput, Message
from terrainav.terrainav_plugin.i18n import number_text, translate
from terrainav.terrainav_plugin.units import area_text, duration_text, length_text

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
        words = desk.form.findChild(QLabel, "area_words")
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
