"""Image sensors by name, and the figures of a mission's sensor."""

from __future__ import annotations

import math

import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.fields import field_named
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import ImageSensor
from terrainav.core.mission.sensors import sensor_named, shipped_sensors

ALVIUM = "Allied Vision Alvium 1800 C-507m"
CUSTOM = {"image_sensor": "custom", "pixel_um": 5.0, "quantum_efficiency": 0.5, "full_well_e": 20_000.0}


def refused(**values):
    with pytest.raises(InvalidInput) as wrong:
        Mission(Box(35.16, -89.90, 35.155, -89.895), 120.0, **values)
    said = str(wrong.value)
    assert "\n" not in said
    return said


@pytest.mark.parametrize("preset", shipped_sensors(), ids=lambda one: one.name)
def test_each_sensor_that_ships_is_valid_and_names_its_sources(preset):
    for name, value in preset.figures.items():
        assert field_named(ImageSensor, name).settled(value) == value
    assert {"pixel_um", "quantum_efficiency", "full_well_e", "read_noise_e", "adc_bits"} <= {*preset.figures}
    for word in ("data sheet", "EMVA 1288", "nm", "read 2026"):
        assert word in preset.source
    figures = ImageSensor(image_sensor=preset.name).figures
    assert {name: figures[name] for name in preset.figures} == dict(preset.figures)
    # A data sheet's own redundancy: the largest number holds the full well.
    most_e = (2 ** figures["adc_bits"] - 1 - figures["black_level_dn"]) / figures["gain_dn_per_e"]
    assert figures["full_well_e"] <= most_e * (1 + 1e-12)


#: Figures that the data sheets state beside those that are used, and that must follow from them.
@pytest.mark.parametrize(
    ("name", "range_db", "snr_db"),
    [
        ("Allied Vision Alvium 1800 C-291m", 72.0, None),
        (ALVIUM, 72.0, None),
        ("Allied Vision Alvium 1800 C-2460m", 70.0, None),
        ("FRAMOS IMX900 low gain", 63.8, 39.76),
        ("FRAMOS IMX900 high gain", 59.0, 33.39),
    ],
)
def test_figures_go_with_others_of_the_same_data_sheet(name, range_db, snr_db):
    figures = ImageSensor(image_sensor=name).figures
    gain = figures["gain_dn_per_e"]
    dark_e = math.sqrt(figures["read_noise_e"] ** 2 + 1.0 / 12.0 / gain**2)
    # Dynamic range after the standard: saturation over the least signal, dark noise and half an electron.
    assert 20.0 * math.log10(figures["full_well_e"] / (dark_e + 0.5)) == pytest.approx(range_db, abs=0.8)
    if snr_db is not None:
        assert 10.0 * math.log10(figures["full_well_e"]) == pytest.approx(snr_db, abs=0.01)


@pytest.mark.parametrize("name", [ALVIUM, ALVIUM.upper(), "alvium  1800 c-507m", "c-507m"])
def test_sensors_are_found_by_what_names_one(name):
    assert sensor_named(name).name == ALVIUM


def test_an_unknown_sensor_is_refused_with_similar_ones():
    assert refused(image_sensor="Alvium 1800 C-508m").startswith(
        "image sensor 'Alvium 1800 C-508m' is unknown: did you"
    )
    assert ALVIUM in refused(image_sensor="Alvium 1800 C-508m")
    assert "low gain or FRAMOS IMX900 high gain?" in refused(image_sensor="IMX900")
    assert refused(image_sensor="alvum").endswith("C-2460m?")
    assert refused(image_sensor="alviun c507").count("Alvium") == 3
    assert refused(image_sensor="framos imx-900").endswith("FRAMOS IMX900 low gain or FRAMOS IMX900 high gain?")
    assert "known are Allied Vision" in refused(image_sensor="zzz")


def test_figures_are_the_missions_own_before_the_sheets():
    assert ImageSensor(image_sensor=ALVIUM, read_noise_e=9.0).figures["read_noise_e"] == 9.0
    assert ImageSensor(image_sensor=ALVIUM).figures["gain_dn_per_e"] == pytest.approx(4095.0 / 10_400.0)
    assert ImageSensor(image_sensor=ALVIUM, full_well_e=5_000.0).figures["gain_dn_per_e"] == pytest.approx(0.819)
    assert ImageSensor(image_sensor=ALVIUM).pitch_um == 3.45
    assert ImageSensor(image_sensor=ALVIUM, pixel_um=5.0).pitch_um == 5.0
    assert ImageSensor(pixel_um=5.0).pitch_um == 5.0
    assert ImageSensor().pitch_um is None


def test_fewer_bits_leave_out_the_lowest():
    twelve = ImageSensor(image_sensor="FRAMOS IMX900 low gain").figures
    eight = ImageSensor(image_sensor="FRAMOS IMX900 low gain", adc_bits=8).figures
    assert eight["gain_dn_per_e"] == twelve["gain_dn_per_e"] / 16.0
    assert eight["black_level_dn"] == 15.0


def test_a_sensor_of_ones_own_has_the_noise_that_is_given():
    figures = ImageSensor(**CUSTOM, dsnu_e=2.0).figures
    assert figures == {
        **{name: value for name, value in CUSTOM.items() if name != "image_sensor"},
        "read_noise_e": 0.0,
        "dark_current_e_per_s": 0.0,
        "dsnu_e": 2.0,
        "prnu": 0.0,
        "black_level_dn": 0.0,
        "adc_bits": 12,
        "gain_dn_per_e": 4095.0 / 20_000.0,
    }


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"image_sensor": ALVIUM, "read_noise_e": -3.0}, "read noise -3.0 e-: must be from 0"),
        ({"image_sensor": ALVIUM, "dsnu_e": -1.0}, "dark signal non-uniformity -1.0 e-: must be from 0"),
        ({"image_sensor": ALVIUM, "prnu": -0.01}, "photo response non-uniformity -1.0 %: must be from 0 to 25"),
        ({"image_sensor": ALVIUM, "adc_bits": 14}, "bits of the converter 14: must be from 8 to 12"),
        ({"image_sensor": ALVIUM, "adc_bits": 7}, "bits of the converter 7: must be from 8 to 12"),
        ({"image_sensor": ALVIUM, "quantum_efficiency": 1.2}, "quantum efficiency 120.0 %: must be at most 100"),
        ({"image_sensor": ALVIUM, "bayer": "rgbg"}, "colour filters 'rgbg': must be one of none, rggb"),
        (
            {"image_sensor": ALVIUM, "adc_bits": 8, "black_level_dn": 300.0},
            "black level 300 DN: must be below 255, the largest number of 8 bits",
        ),
        ({"image_sensor": "custom"}, "image sensor custom: needs its pixel pitch; give it (--pixel-um)"),
        ({"read_noise_e": 3.0}, "read noise 3.0: needs an image sensor; name one, or custom (--image-sensor)"),
        ({"bayer": "rggb"}, "colour filters rggb: needs an image sensor"),
        ({"products": ("raw",)}, "product raw: needs an image sensor; name one (--image-sensor)"),
        (
            {"products": ("raw",), "image_sensor": ALVIUM, "img_size": (64, 48, 3)},
            "product raw: has the pixels of the sensor, of which resized images have none",
        ),
        ({"image_sensor": " custom"}, "must be a name without spaces around it"),
    ],
)
def test_bad_figures_are_refused_in_one_line(values, said):
    assert said in refused(**values)
