"""Declared fields: what follows from a declaration."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from terrainav.core.fields import CheckedFields, declared, field_named
from terrainav.core.mission.mission import flat_fields
from terrainav.core.mission.options import Option
from terrainav.core.units import UNITS, Unit


def test_an_option_keeps_the_unit_of_its_field_s_name_unless_it_is_named(monkeypatch):
    monkeypatch.setitem(UNITS, "ms", Unit("ms", "milliseconds", " ms", 3))

    @dataclass(frozen=True)
    class Exposing(CheckedFields):
        exposure_ms: float = declared(2.0, title="exposure", help="how long", unit="ms", above=0.0)
        pause_s: float = declared(1.0, title="pause", help="how long", unit="s", option="pause")

    exposure = Option.from_field(field_named(Exposing, "exposure_ms"))
    assert (exposure.name, exposure.about) == ("exposure_ms", "milliseconds, above 0")
    assert field_named(Exposing, "pause_s").name_of_option == "pause"


def test_a_unit_that_is_not_declared_is_named():
    with pytest.raises(ValueError, match=r"unit 'furlong' of 'length': not one of .*\bm, deg, .* core/units\.py"):
        declared(2.0, title="length", help="how long", unit="furlong")


def test_the_option_of_a_list_says_how_many_values_it_takes():
    without = [one.name for one in flat_fields() if one.kind is tuple and Option.from_field(one).count is None]
    assert not without, "Option.from_field in core/mission/options.py has to know them"
