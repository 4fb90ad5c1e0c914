"""Each wrong text in each numeric entry of the panel is refused in words beside it, or taken as the number that it is.

Short texts are typed key by key, as an entry that is written anew amid typing makes another number of them; others
are pasted.
"""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from qgis.PyQt.QtCore import QLocale, Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QLabel
from terrainav.core.errors import InvalidInput
from terrainav.terrainav_plugin.form.area import area_of_text, edge_deg
from terrainav.terrainav_plugin.form.mission_form import takeoff, unread_text
from terrainav.terrainav_plugin.form.state import BOX_FIELDS, FormState
from terrainav.terrainav_plugin.form.text import parse_aspect
from terrainav.terrainav_plugin.panel.entries import FacingBox
from terrainav.terrainav_plugin.widgets import NumberBox, spin

#: Wrong and unusual texts, and the numbers that they are; None if they are none.
TEXTS = {
    "-5": -5.0,
    "-0,004": -0.004,
    "abc": None,
    "1e300": 1e300,
    "12,5": 12.5,
    "47 01 30": None,
    "1e-8": 1e-8,
}
MORE_TEXTS = {
    "-0": 0.0,
    "": None,
    "12 metres": None,
    "9" * 40: 1e40,
    "1e999": None,
    "nan": None,
    "1,500": 1.5,
    "1.234,5": None,
    "1,234.5": None,
    "47°01'30\"N": None,
    "47:01:30": None,
    "12,5 * 2": 25.0,
    "1/0": None,
    "\N{ARABIC-INDIC DIGIT FOUR}": None,
}
#: Choices that between them show every number entry.
CHOICES = (
    {"facing": "10", "resize": True, "wind": True},
    {
        "exposure": "time",
        "exposure_ms": 1.0,
        "visibility_km": 10.0,
        "k1": 1e-6,
        "image_sensor": "custom",
        "pixel_um": 3.0,
        "quantum_efficiency": 0.6,
        "full_well_e": 10_000.0,
        "read_noise_e": 2.0,
        "adc_bits": 12,
    },
    {"exposure": "iso", "exposure_ms": 1.0},
    {"elevation": ("60",), "labels": ("fields.gpkg",), "buildings": ("houses.gpkg",)},
    {"fov_mode": "horizontal", "fov_typed_deg": 60.0, "resolution": "zoom", "zoom": 17},
    {
        "fov_mode": "sensor",
        "focal_length_mm": 24.0,
        "sensor_width_mm": 36.0,
        "sensor_height_mm": 24.0,
        "aspect": "3:2",
        "resolution": "gsd",
        "gsd_m_per_px": 0.5,
    },
)


def put(desk, line, text):
    """Type a short text, or paste another, and press Enter."""
    if len(text) <= 6 and text.isascii():
        desk.type_text(line, text)
    else:
        line.setFocus()
        line.selectAll()
        line.insert(text)
    QTest.keyClick(line, Qt.Key.Key_Return)


def number_boxes(desk):
    """All number entries of the panel, by field."""
    found = {}
    for group in desk.form.groups:
        for name, entry in group.entries.items():
            box = entry.azimuth if isinstance(entry, FacingBox) else entry
            if isinstance(box, NumberBox):
                found[name] = box
    return found


def is_shown(desk, widget):
    """Whether a widget is to be seen in its tab."""
    return widget.isVisibleTo(desk.form.pages.page_of(widget))


def said(desk, name):
    """Message that is shown beside a field."""
    label = desk.form.findChild(QLabel, f"{name}_message")
    return label.text() if is_shown(desk, label) else ""


def silent(desk, name, box, texts):
    """Texts of a number entry that are neither refused in words nor taken as they are."""
    found = []
    for text, number in texts.items():
        put(desk, box.lineEdit(), text)
        taken = number is not None and box.unread() is None and abs(box.value() - number) < 1e-12
        left_out = text == "" and box.is_optional and box.text() == "not set"
        if not (said(desk, name) or taken or left_out):
            found.append((name, text, box.text(), box.value()))
    return found


@pytest.mark.parametrize("texts", [TEXTS, pytest.param(MORE_TEXTS, marks=pytest.mark.thorough)])
def test_every_wrong_text_in_every_number_entry_has_its_message(desk, texts):
    desk.enter_small_mission()
    start, walked, wrong = desk.session.state(), set(), []
    for choice in CHOICES:
        desk.form.set_state(replace(start, **choice))
        begun = desk.session.state()
        for name, box in number_boxes(desk).items():
            desk.form.pages.show_field(box)
            if name not in walked and is_shown(desk, box):
                walked.add(name)
                wrong += silent(desk, name, box, texts)
                desk.form.set_state(begun)
                assert said(desk, name) == ""
    assert wrong == []
    assert walked == set(number_boxes(desk))


#: Wrong texts of entries other than spin boxes, and words of their messages.
EDGE = {
    **dict.fromkeys(
        ("abc", "", "12 metres", "nan", "1e999", "1.234,5", "1,234.5", "47:01:30", "1/0"), "must be a number"
    ),
    **dict.fromkeys(("47 61 30", "47 01 60", "47°61'30\""), "minutes and seconds must be below 60"),
    "1e300": "1e+300: must be within",
    "-400": "-400.0: must be within",
    "35,14,-89,9": "a comma may stand between numbers or before decimals",
    "47 01 30 8 30 15": "6 numbers",
}
LINES = {
    **dict.fromkeys(BOX_FIELDS, EDGE),
    "aspect": {
        "-5": "must be above 0",
        "-4:3": "must be above 0",
        **dict.fromkeys(("1e300", "1e-8", "100000:3"), "must be from 0.001 to 1000"),
        **dict.fromkeys(("abc", "", "0", "47 01 30", "4:0", "1,234.5"), "aspect ratio"),
    },
    "takeoff": dict.fromkeys(
        ("-5", "abc", "1e300", "12,5", "35,14,-89,9", "47 01 30", "1,500", "1e300, 5", "35.1"),
        "take-off",
    ),
}


@pytest.mark.parametrize("name", LINES)
def test_every_wrong_text_in_every_line_of_numbers_has_its_message(desk, name):
    desk.enter_small_mission()
    begun = desk.session.state()
    line = {**desk.form.edges, "aspect": desk.form.aspect, "takeoff": desk.form.route.takeoff}[name]
    desk.form.pages.show_field(line)
    for text, words in LINES[name].items():
        put(desk, line, text)
        assert words in said(desk, name), text
        assert line.text() == text
        desk.form.set_state(begun)
        assert said(desk, name) == ""


def test_wrong_heights_of_the_ground_have_their_message(desk):
    desk.enter_small_mission()
    for name in ("elevation", "surface"):
        desk.form.set_state(replace(desk.session.state(), elevation=("12",), surface=()))
        line = desk.form.relief.entries[name]
        desk.form.pages.show_field(line)
        for text in ("abc", "1e300", "47 01 30"):
            put(desk, line, text)
            desk.wait(lambda name=name: said(desk, name) != "")
            put(desk, line, "12,5")
            desk.wait(lambda name=name: said(desk, name) == "")
        assert getattr(desk.session.state(), name) == ("12.5",)


@pytest.mark.parametrize("country", ["en_US", "es_ES"])
@pytest.mark.parametrize("grouped", [False, True])
def test_a_comma_is_a_decimal_sign_in_every_entry(country, grouped):
    before, locale = QLocale(), QLocale(country)
    omit = QLocale.NumberOption.OmitGroupSeparator
    locale.setNumberOptions(QLocale.NumberOption.DefaultNumberOptions if grouped else omit)
    QLocale.setDefault(locale)
    try:
        for text in ("1,500", "1.500"):
            box = spin("tilt", -1e6, 1e6, 2, " °", "")
            box.setValue(1234.5)
            assert box.text() == f"1234{locale.decimalPoint()}5 °"
            box.lineEdit().selectAll()
            QTest.keyClicks(box.lineEdit(), text)
            assert (box.value(), box.problem()) == (1.5, "")
            assert edge_deg("north", text) == edge_deg("west", text) == parse_aspect(text) == 1.5
            assert takeoff(FormState(takeoff=f"{text} -{text}")) == (1.5, -1.5)
            with pytest.raises(InvalidInput, match=re.escape(text)):
                takeoff(FormState(takeoff=text))
            assert area_of_text(f"{text} -89", 50.0, "m")[0].poses == ((1.5, -89.0, 50.0),)
    finally:
        QLocale.setDefault(before)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("climb_m_per_s", "0.00000001", "climb rate “0.00000001”: is too small"),
        ("climb_m_per_s", "1234567.5", "climb rate “1234567.5”: is too large"),
        ("resize_width_px", "0.5", "image width “0.5”: must be a whole number"),
        ("overlap_along", "-0", "front overlap “-0”: must be 0 or more"),
        ("camera_gsd", "-0.00001", "GSD “-0.00001”: must be 0 or more"),
    ],
)
def test_what_is_wrong_with_a_number_is_said_as_it_is(name, text, words):
    assert unread_text(name, text) == words


def test_boxes_of_dialogs_refuse_what_would_become_0():
    box = spin("spacing", 0.0, 100.0, 2, " m", "")
    for text, words in (("0.001", "is too small"), ("-0", "must be from 0 to 100"), ("-0.001", "is too small")):
        box.lineEdit().selectAll()
        QTest.keyClicks(box.lineEdit(), text)
        assert words in box.problem()
        assert box.lineEdit().text().startswith(text)
