"""Panel and Processing say of a mission's fields what is declared of them, and have all of them."""

from __future__ import annotations

import math

import pytest
from qgis.core import QgsApplication, QgsProcessingParameterDefinition
from qgis.PyQt.QtWidgets import QCheckBox, QComboBox
from terrainav.core.fields import declared_fields, field_named
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import flat_fields
from terrainav.core.mission.parts import Flight
from terrainav.terrainav_plugin.form.fields import (
    field_choices,
    field_label,
    field_sentence,
    field_tip,
    field_title,
)
from terrainav.terrainav_plugin.form.state import DECLARED, ENTERED_AS_DECLARED, WITHOUT_ENTRY, FormState

#: What models and scripts of users name.
IDS = set(
    "EXTENT AREA COORDS AGL CAMERA FOV ASPECT LAYOUT CROSSHATCH ORDER "
    "ROW_AZIMUTH FACING MARGIN SOURCE "
    "OTHER_SOURCE MAP_TYPES FORMAT AGL_FIELD YAW_FIELD YAW TILT ROLL GROUND_HEIGHT ERROR_BUDGET ACCEPT_ERROR FRAME "
    "TILT_FIELD GIMBAL_PITCH_FIELD ROLL_FIELD TIME_FIELD "
    "FRONT_OVERLAP SIDE_OVERLAP "
    "RESAMPLING IMAGE_PX ZOOM GSD MAX_PX UPSAMPLE IMG_SIZE DATE CRS WIND_SPEED WIND_FROM TURBULENCE AIRSPEED START "
    "SEED MAX_IMAGES MISSION".split()
)


def test_every_field_has_its_place_in_the_panel(desk):
    entered = {name for group in desk.form.groups for name in group.entries}
    entered |= {"source", "date", "map_types"}
    assert set(ENTERED_AS_DECLARED) - entered == set(WITHOUT_ENTRY)
    assert not entered & set(WITHOUT_ENTRY)


def test_entries_say_what_is_declared(desk):
    entries = {name: widget for group in desk.form.groups for name, widget in group.entries.items()}
    for name, field in DECLARED.items():
        if name not in entries or name in ("agl", "fov_deg"):
            continue
        widget = entries[name]
        assert widget.toolTip().startswith(field_sentence(field)[:-1]), name
        if isinstance(widget, QCheckBox):
            assert widget.text().replace("&", "") == field_title(field)
        if isinstance(widget, QComboBox):
            shown = [(widget.itemData(at), widget.itemText(at)) for at in range(widget.count())]
            assert tuple(shown) == field_choices(field)
        if name in ENTERED_AS_DECLARED:
            assert getattr(FormState(), name) == field.default


def test_words_of_a_field():
    agl, tilt = field_named(Flight, "agl_m"), DECLARED["tilt_deg"]
    assert field_label(agl).replace("&", "") == "Height above ground"
    assert field_title(agl) == "Height above ground (metres)"
    assert field_tip(tilt).endswith("90 looks level (degrees, from -180 to 180)")
    assert field_tip(DECLARED["overlap_along"]).endswith("also shows (percent)")


def test_numbers_that_may_be_left_out_are_entered_as_such(desk):
    desk.enter_small_mission()
    entries = {name: widget for group in desk.form.groups for name, widget in group.entries.items()}
    left_out = {name for name, field in ENTERED_AS_DECLARED.items() if field.optional}
    assert "max_px" in left_out
    for name in left_out:
        entry = entries[name]
        assert getattr(desk.session.state(), name) is entry.number() is None
        assert entry.text() == "not set"
        field = ENTERED_AS_DECLARED[name]
        value = min(max(700.0, field.least or 0.0), field.most or math.inf)
        # As typed: percent of a share.
        entry.setValue(field.unit.times * value)
        assert getattr(desk.session.state(), name) == value
        entry.setValue(entry.minimum())
        assert getattr(desk.session.state(), name) is None


@pytest.fixture
def parameters(plugin):
    algorithm = QgsApplication.processingRegistry().createAlgorithmById("terrainav:plan")
    # It owns them.
    yield {one.name(): one for one in algorithm.parameterDefinitions() if not one.isDestination()}
    del algorithm


def test_parameters_keep_their_ids_and_have_all_fields(parameters):
    assert set(parameters) >= IDS
    # The mesh had been forgotten here.
    assert "MESH" in parameters


def test_parameters_have_the_declared_defaults_and_ranges(parameters):
    for field in flat_fields():
        name = {
            "overlap_along": "FRONT_OVERLAP",
            "overlap_across": "SIDE_OVERLAP",
            "map_types": "MAP_TYPES",
        }.get(field.name, field.name_of_option.upper())
        parameter = parameters[name]
        advanced = bool(parameter.flags() & QgsProcessingParameterDefinition.Flag.FlagAdvanced)
        assert advanced == field.advanced, name
        if name in ("SOURCE", "START", "DATE", "BANDS", "IMG_SIZE", "IMAGE_PX", "CRS"):
            # A list with sources of the user's own, texts that say nothing where they are empty, a camera's own.
            continue
        assert parameter.description() == field_title(field)
        usual = list(field.default) if field.name == "map_types" else field.default
        if usual in ((), ""):
            # What stands for nothing is given by leaving it out.
            assert not parameter.defaultValue(), name
        else:
            assert parameter.defaultValue() == (field.initial_value if field.needed else usual), name
        if field.choices:
            assert parameter.options() == list(filter(None, field.choices))
        if field.least is not None:
            assert parameter.minimum() == field.least * field.unit.times
        if field.most is not None:
            assert parameter.maximum() == field.most * field.unit.times
    turbulence = next(one for one in declared_fields(Wind) if one.name == "turbulence")
    assert parameters["TURBULENCE"].defaultValue() == turbulence.initial_value == FormState().turbulence
