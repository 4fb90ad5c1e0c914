"""The sensor against the model of EMVA 1288, by formulas of its own and the distributions of scipy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import constants, stats
from terrainav.core.camera.sensor import LEAST_NORMAL_E, Detector, Deviates, poisson_counts, read_out

SIZE = 480, 640
COUNT = SIZE[0] * SIZE[1]
IDEAL = Detector(3.45, 0.64, 10_000.0, 0.0, 0.0, 0.0, 0.0, 0.4, 0.0, 12)
REAL = Detector(3.45, 0.64, 10_000.0, 5.0, 40.0, 3.0, 0.01, 0.35, 100.0, 12)


def flat(electrons, detector=REAL, size=SIZE):
    """Exposure at which pixels hold a number of electrons on average."""
    return np.full(size, electrons / detector.electrons_per_lx_s, np.float32)


def image(electrons, name="a", detector=REAL, time_s=0.0, seed=1):
    return read_out(detector, flat(electrons, detector), time_s, seed, name).astype(np.float64)


def variance(one, other):
    """Temporal variance of two images, which cancels what they share."""
    return np.var(one - other) / 2.0


@pytest.mark.parametrize("mean", [0.0, 0.01, 0.7, 3.0, 12.0, 23.9, 24.0, 30.0, 55.5, 200.0, 3_000.0])
def test_counts_are_those_of_poisson(mean):
    # Every number of 16 bits once: shares without a sampling error.
    draws = np.arange(65536, dtype=np.uint16)
    counts = np.sort(poisson_counts(np.full(65536, mean, np.float32), draws))
    assert (counts == np.rint(counts)).all()
    assert counts[0] >= 0.0
    numbers = np.arange(0, math.ceil(mean + 10.0 * math.sqrt(mean) + 5.0))
    share = np.searchsorted(counts, numbers, side="right") / 65536.0
    # Below the limit only the width of the numbers; above it the error that docs/realism.md states.
    bound = 0.5 / 65536.0 + 1e-9 if mean < LEAST_NORMAL_E else 4e-4
    assert np.abs(share - stats.poisson.cdf(numbers, np.float32(mean))).max() <= bound
    assert counts.mean() == pytest.approx(mean, rel=2e-4, abs=2e-4)
    assert counts.var() == pytest.approx(mean, rel=1e-3, abs=1e-3)


def test_normal_deviates_are_normal():
    drawn = Deviates("normal").normal(COUNT).astype(np.float64)
    # Five standard deviations of each estimate.
    assert abs(drawn.mean()) < 5.0 / math.sqrt(COUNT)
    assert abs(drawn.var() - 1.0) < 5.0 * math.sqrt(2.0 / COUNT)
    assert abs((drawn**4).mean() - 3.0) < 5.0 * math.sqrt(96.0 / COUNT)
    assert stats.kstest(drawn, "norm").statistic < 1.63 / math.sqrt(COUNT) + 0.5 / 65536.0
    along = drawn[1:] * drawn[:-1]
    assert abs(along.mean()) < 5.0 / math.sqrt(COUNT)


def test_photons_are_those_of_light_of_555_nm():
    joule = constants.h * constants.c / 555e-9
    watts = 1.0 / 683.0
    assert IDEAL.photons_per_lx_s == pytest.approx(watts / joule * (3.45e-6) ** 2, rel=1e-9)
    assert IDEAL.electrons_per_lx_s == pytest.approx(0.64 * IDEAL.photons_per_lx_s)


def test_variance_over_mean_is_the_system_gain():
    """The photon transfer method: read noise, patterns and black level do not enter its slope."""
    electrons = np.linspace(300.0, 7_000.0, 24)
    dark = variance(image(0.0, "a"), image(0.0, "b"))
    mean, noise = [], []
    for at, value in enumerate(electrons):
        one, other = image(value, f"{at}a"), image(value, f"{at}b")
        mean.append((one.mean() + other.mean()) / 2.0 - 100.0)
        noise.append(variance(one, other) - dark)
    slope = np.dot(mean, noise) / np.dot(mean, mean)
    # Variances have a relative error of sqrt(2/n) each; the slope that of their sum weighted by the means.
    weights = np.array(mean) ** 2 / np.dot(mean, mean)
    sigma = math.sqrt(2.0 / COUNT) * math.sqrt(np.sum(weights**2))
    assert sigma < 0.001
    assert slope == pytest.approx(REAL.gain_dn_per_e, rel=5.0 * sigma)
    response = np.dot(electrons, mean) / np.dot(electrons, electrons)
    assert response == pytest.approx(REAL.gain_dn_per_e, rel=5e-4)


def test_dark_images_have_the_noise_and_the_current_of_the_dark():
    one, other = image(0.0, "a", time_s=2.0), image(0.0, "b", time_s=2.0)
    electrons = 2.0 * REAL.dark_current_e_per_s
    wanted = (REAL.read_noise_e**2 + electrons) * REAL.gain_dn_per_e**2 + 1.0 / 12.0
    assert variance(one, other) == pytest.approx(wanted, rel=5.0 * math.sqrt(2.0 / COUNT))
    spread = math.sqrt((wanted + (REAL.dsnu_e * REAL.gain_dn_per_e) ** 2) / COUNT)
    assert one.mean() == pytest.approx(100.0 + electrons * REAL.gain_dn_per_e, abs=5.0 * spread)


@pytest.mark.parametrize("electrons", [0.0, 5_000.0])
def test_patterns_have_the_spread_of_the_data_sheet(electrons):
    images = [image(electrons, str(at)) for at in range(16)]
    temporal = np.mean([variance(one, other) for one, other in zip(images[::2], images[1::2])])
    spatial = np.var(np.mean(images, axis=0)) - temporal / 16.0
    wanted = (REAL.dsnu_e**2 + (REAL.prnu * electrons) ** 2) * REAL.gain_dn_per_e**2
    # The error of the variance of a mean image, five times.
    sigma = math.sqrt(2.0 / COUNT) * (wanted + temporal / 16.0)
    assert spatial == pytest.approx(wanted, abs=5.0 * sigma)


def test_patterns_are_the_sensors_and_noise_is_the_images():
    quiet = replace(REAL, read_noise_e=0.0)
    one, again, other = image(5_000.0, "a"), image(5_000.0, "a"), image(5_000.0, "b")
    assert (one == again).all()
    assert np.corrcoef(one.ravel(), other.ravel())[0, 1] == pytest.approx(
        2500.0 / (2500.0 + 5000.0), abs=0.01
    )  # variance of the response over all variance, but for offset and read noise
    assert abs(np.corrcoef(one.ravel(), image(5_000.0, "a", seed=2).ravel())[0, 1]) < 5.0 / math.sqrt(COUNT)
    # Other sources of noise do not change the shot noise.
    assert np.abs(image(5_000.0, "a", quiet) - one).max() < 5.0 * REAL.read_noise_e * REAL.gain_dn_per_e + 1.0


def test_a_part_of_an_image_does_not_depend_on_what_follows():
    exposure = flat(4_000.0, size=(300, 640))
    whole, part = read_out(REAL, exposure, 0.0, 1, "a"), read_out(REAL, exposure[:128], 0.0, 1, "a")
    assert (whole[:128] == part).all()


@pytest.mark.parametrize("size", [(480, 640), (481, 641), (479, 639)])
def test_a_pixel_has_its_pattern_in_images_of_other_sizes(size):
    bright = replace(REAL, full_well_e=1e6, gain_dn_per_e=0.0035, prnu=0.1, read_noise_e=0.0)
    usual, other = (
        read_out(bright, flat(500_000.0, bright, one), 0.0, 1, str(one)).astype(float) for one in ((480, 640), size)
    )
    same = tuple(slice(min(sides)) for sides in zip(usual.shape, other.shape))
    assert np.corrcoef(usual[same].ravel(), other[same].ravel())[0, 1] > 0.99


def test_wells_and_converters_saturate():
    well = replace(IDEAL, gain_dn_per_e=0.3)
    assert image(20_000.0, detector=well).max() == 3_000.0
    assert (image(20_000.0, detector=well) == 3_000.0).all()
    assert well.saturation_lx_s * well.electrons_per_lx_s == pytest.approx(10_000.0)
    converter = replace(IDEAL, gain_dn_per_e=1.0, black_level_dn=95.0)
    assert (image(9_000.0, detector=converter) == 4_095.0).all()
    assert converter.saturation_lx_s * converter.electrons_per_lx_s == pytest.approx(4_000.0)
    assert (image(0.0, detector=replace(REAL, black_level_dn=0.0)) >= 0.0).all()


@pytest.mark.parametrize("gain", [0.35, 0.7])
def test_saturated_pixels_are_told_from_others_in_spite_of_noise(gain):
    detector = replace(REAL, gain_dn_per_e=gain)
    full = detector.saturation_lx_s * detector.electrons_per_lx_s
    assert (image(1.5 * full, detector=detector) >= detector.saturated_dn).mean() > 0.99
    assert (image(0.9 * full, detector=detector) >= detector.saturated_dn).mean() == 0.0


@pytest.mark.parametrize("bits", [8, 10, 12])
def test_quantisation_adds_a_twelfth(bits):
    gain = (2.0**bits - 1.0) / 10_000.0
    detector = replace(IDEAL, bits=bits, gain_dn_per_e=gain, read_noise_e=60.0)
    noise = variance(image(5_000.0, "a", detector), image(5_000.0, "b", detector))
    wanted = (5_000.0 + 3_600.0) * gain**2 + 1.0 / 12.0
    assert noise == pytest.approx(wanted, rel=5.0 * math.sqrt(2.0 / COUNT))
    assert image(20_000.0, "a", detector).max() == 2**bits - 1


def test_raw_values_stand_for_the_exposure():
    exposure = flat(4_000.0)
    found = REAL.exposure_lx_s(read_out(REAL, exposure, 0.0, 1, "a"))
    assert found.mean() == pytest.approx(float(exposure[0, 0]), rel=1e-3)


def test_raw_values_are_the_same_on_any_machine():
    exposure = (np.arange(12, dtype=np.float32) ** 2 / 121.0).reshape(3, 4) * np.float32(REAL.saturation_lx_s)
    assert read_out(REAL, exposure, 0.01, 2024, "0_0_48.1_11.5_17").tolist() == [
        [101, 125, 223, 358],
        [563, 808, 1177, 1538],
        [1937, 2505, 3021, 3583],
    ]
