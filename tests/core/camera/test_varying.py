"""Random values of images: their distributions against scipy's, and what they depend on."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest
from terrainav.core.camera.varying import KINDS, Variation
from terrainav.core.errors import InvalidInput

#: Each kind of distribution, with the same one of scipy.
KNOWN = {
    "f=uniform(4500,7500)": lambda stats: stats.uniform(4500.0, 3000.0),
    "f=normal(-2,0.5)": lambda stats: stats.norm(-2.0, 0.5),
    "f=normal(4,1)within(2.5,5)": lambda stats: stats.truncnorm(-1.5, 1.0, 4.0, 1.0),
    "f=normal(0,1)within(4,9)": lambda stats: stats.truncnorm(4.0, 9.0),
    "f=normal(0,1)within(-9,-4)": lambda stats: stats.truncnorm(-9.0, -4.0),
    "f=lognormal(4,0.5)": lambda stats: stats.lognorm(0.5, scale=4.0),
    "f=loguniform(0.1,40)": lambda stats: stats.loguniform(0.1, 40.0),
    "f=triangular(1,2,6)": lambda stats: stats.triang(0.2, 1.0, 5.0),
    "f=triangular(1,6,6)": lambda stats: stats.triang(1.0, 1.0, 5.0),
}
NAMES = [f"{column}_{row}_48.12345678_11.5_18" for column in range(50) for row in range(40)]


@pytest.mark.parametrize("text", KNOWN)
def test_quantiles_are_scipys(text):
    known = KNOWN[text](pytest.importorskip("scipy.stats"))
    shares = np.array([1e-12, 1e-6, 0.001, 0.1, 0.3, 0.5, 0.8, 0.99, 1.0 - 1e-6])
    found = [Variation.from_text(text).quantile(share) for share in shares]
    assert found == pytest.approx(known.ppf(shares), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("text", KNOWN)
@pytest.mark.parametrize("seed", [0, 2024])
def test_images_have_the_distribution_that_was_asked_for(text, seed):
    stats = pytest.importorskip("scipy.stats")
    variation = Variation.from_text(text)
    drawn = [variation.draw(seed, name) for name in NAMES]
    assert stats.kstest(drawn, KNOWN[text](stats).cdf).pvalue > 0.01


def test_bounded_lognormal_values_have_its_shape():
    stats = pytest.importorskip("scipy.stats")
    variation, whole = Variation.from_text("f=lognormal(4,0.5)within(3,9)"), stats.lognorm(0.5, scale=4.0)
    low, high = whole.cdf([3.0, 9.0])
    drawn = [variation.draw(7, name) for name in NAMES]
    assert min(drawn) >= 3.0
    assert max(drawn) <= 9.0
    assert stats.kstest(drawn, lambda x: np.clip((whole.cdf(x) - low) / (high - low), 0.0, 1.0)).pvalue > 0.01


def test_choices_are_equally_likely():
    stats = pytest.importorskip("scipy.stats")
    variation = Variation.from_text("f=choice(100,200.1234567,400)")
    _, counts = np.unique([variation.draw(3, name) for name in NAMES], return_counts=True)
    assert {variation.draw(3, name) for name in NAMES} == {100.0, 200.1234567, 400.0}
    assert stats.chisquare(counts).pvalue > 0.01


def test_fields_and_seeds_are_independent():
    stats = pytest.importorskip("scipy.stats")
    one, other = Variation.from_text("f=uniform(0,1)"), Variation.from_text("g=uniform(0,1)")
    columns = [
        [one.draw(0, name) for name in NAMES],
        [other.draw(0, name) for name in NAMES],
        [one.draw(1, name) for name in NAMES],
    ]
    for first, second in ((0, 1), (0, 2), (1, 2)):
        assert stats.spearmanr(columns[first], columns[second]).pvalue > 0.01


def test_a_value_is_the_same_everywhere():
    """Written down once: of no other process, order, machine or version may it be another."""
    drawn = {text: Variation.from_text(text).draw(2024, "3_7_48.1_11.5_18") for text in KNOWN}
    assert drawn == WRITTEN_DOWN
    code = (
        "from terrainav.core.camera.varying import Variation\n"
        f"for text in {list(reversed(list(KNOWN)))!r}:\n"
        "    print(text, Variation.from_text(text).draw(2024, '3_7_48.1_11.5_18'))"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert dict(line.rsplit(" ", 1) for line in result.stdout.splitlines()) == {
        text: repr(value) for text, value in drawn.items()
    }


def test_values_have_the_digits_that_files_state():
    variation = Variation.from_text("f=uniform(0,1)")
    drawn = [variation.draw(0, name) for name in NAMES]
    assert [float(f"{value:.6g}") for value in drawn] == drawn


def test_no_value_is_beyond_the_ends():
    # The bounds have more digits than values.
    variation = Variation.from_text("f=uniform(0.12345649,0.12345651)")
    assert {variation.draw(0, name) for name in NAMES} <= {0.12345649, 0.123456, 0.123457, 0.12345651}
    assert variation.extremes == (0.12345649, 0.12345651)


@pytest.mark.parametrize("text", [*KNOWN, "f=choice(1,2)"])
def test_the_text_of_a_distribution_is_read_as_it(text):
    variation = Variation.from_text(text)
    assert Variation.from_text(str(variation)) == variation
    spaced = text.replace("(", " ( ").replace(",", " , ").replace("=", " = ")
    assert Variation.from_text(spaced) == variation


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("f", "must be as exposure_ms=lognormal"),
        ("f=4", "must be as"),
        ("f=uniform(1,2", "must be as"),
        ("f=uniform(1,2)) ", "must be as"),
        ("f=gauss(1,2)", "gauss must be one of uniform, normal"),
        ("f=uniform(1)", "uniform takes low,high"),
        ("f=uniform()", "uniform takes low,high"),
        ("f=normal(1,2,3)", "normal takes mean,sd"),
        ("f=triangular(1,2)", "triangular takes low,mode,high"),
        ("f=uniform(2,1)", "low below high"),
        ("f=uniform(1,1)", "low below high"),
        ("f=normal(1,-1)", "sd above 0"),
        ("f=lognormal(0,1)", "median and sigma above 0"),
        ("f=loguniform(0,1)", "low above 0 and below high"),
        ("f=triangular(1,5,4)", "mode from low to high"),
        ("f=choice()", "at least one value"),
        ("f=uniform(1,two)", "1,two must be numbers"),
        ("f=uniform(1,inf)", "1,inf must be numbers"),
        ("f=uniform(nan,1)", "nan,1 must be numbers"),
        ("f=normal(1,2)within(3)", "within takes low,high"),
        ("f=normal(1,2)within(3,2)", "within needs low below high"),
        ("f=uniform(1,2)within(1,3)", "only distributions without bounds"),
        ("f=normal(0,1)within(20,30)", "hardly any values"),
        ("f=lognormal(1,1)within(-2,-1)", "hardly any values"),
        ("f=lognormal(1,1000)", "not finite"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(text, why):
    with pytest.raises(InvalidInput) as wrong:
        Variation.from_text(text)
    assert why in str(wrong.value)
    assert repr(text) in str(wrong.value)
    assert "\n" not in str(wrong.value)
    assert wrong.value.field == "vary"


def test_every_kind_is_tested():
    assert {Variation.from_text(text).kind for text in KNOWN} | {"choice"} == set(KINDS)


def test_a_standard_deviate_of_a_far_tail_is_exact():
    """Against the integral's asymptotic series, as shares near 1 have no digits for it."""
    variation = Variation.from_text("f=normal(0,1)within(5,50)")
    tail = 0.5 * math.erfc(5.0 / math.sqrt(2.0))
    value = variation.quantile(0.25)
    assert 0.5 * math.erfc(value / math.sqrt(2.0)) == pytest.approx(0.75 * tail, rel=1e-10)


#: As `draw` gave them first.
WRITTEN_DOWN = {
    "f=uniform(4500,7500)": 7109.19,
    "f=normal(-2,0.5)": -1.43744,
    "f=normal(4,1)within(2.5,5)": 4.64472,
    "f=normal(0,1)within(4,9)": 4.45855,
    "f=normal(0,1)within(-9,-4)": -4.03291,
    "f=lognormal(4,0.5)": 7.02061,
    "f=loguniform(0.1,40)": 18.3269,
    "f=triangular(1,2,6)": 4.38587,
    "f=triangular(1,6,6)": 5.66296,
}
