"""Priors: that errors are as large and as slow as was stated, and that outages last as long."""

from __future__ import annotations

import csv
import json
import math

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.poses.priors import Sensors, draw_errors, write_priors

from tests.support.command import command
from tests.support.datasets import write_dataset
from tests.support.sources import PatternSource

run = pytest.fixture(command, name="run")

COUNT = 40_000
SECONDS = np.arange(COUNT) * 1.0


def lagged(values, lag):
    return float(np.mean(values[lag:] * values[:-lag]) / np.mean(values * values))


def test_errors_have_the_stated_deviations_and_half_of_them_wanders():
    sensors = Sensors(2.0, 1.5, 4.0, drift_s=20.0)
    errors, fixed = draw_errors(SECONDS, sensors, 5)
    assert fixed.all()
    # Some thousand independent stretches: four per cent are two standard deviations and more.
    np.testing.assert_allclose(errors.std(axis=0), (2.0, 2.0, 1.5, 4.0), rtol=0.04)
    for axis in range(4):
        for lag in (1, 10, 20):
            assert lagged(errors[:, axis], lag) == pytest.approx(0.5 * math.exp(-lag / 20.0), abs=0.05)
    assert np.abs(np.corrcoef(errors.T) - np.eye(4)).max() < 0.06
    white, _ = draw_errors(SECONDS, Sensors(2.0, drift_s=0.0), 5)
    assert abs(lagged(white[:, 0], 1)) < 0.03
    assert white[:, 0].std() == pytest.approx(2.0, rel=0.02)


def test_uneven_gaps_forget_as_much_as_they_last():
    gaps = np.tile((1.0, 30.0), COUNT // 2)
    sensors = Sensors(2.0, drift_s=20.0, outage_share=0.3, outage_s=20.0)
    errors, fixed = draw_errors(np.cumsum(gaps), sensors, 3)
    for first, gap in ((1, 1.0), (0, 30.0)):
        before, after = errors[first:-1:2, 0], errors[first + 1 :: 2, 0]
        wanted = 0.5 * math.exp(-gap / 20.0)
        assert np.mean(before * after) / 4.0 == pytest.approx(wanted, abs=0.04)
        # The two rates out of an outage and into one: 1 / 20 s and 3 / 7 of it.
        both = 0.3 * (0.3 + 0.7 * math.exp(-gap / 20.0 / 0.7))
        assert np.mean(~fixed[first:-1:2] & ~fixed[first + 1 :: 2]) == pytest.approx(both, abs=0.015)


def test_outages_are_as_often_and_as_long_as_stated():
    for step in (1.0, 4.0):
        _, fixed = draw_errors(SECONDS * step, Sensors(outage_share=0.2, outage_s=5.0), 9)
        assert (~fixed).mean() == pytest.approx(0.2, abs=0.03)
        begins = np.flatnonzero(fixed[:-1] & ~fixed[1:])
        lasts = (~fixed).sum() * step / len(begins)
        # Seen every so often, a short one may be missed, and others look longer.
        assert lasts == pytest.approx(step / -math.expm1(-step / 5.0 / 0.8) / 0.8, rel=0.1)


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flown") / "out"
    mission = Mission(
        Box(35.16, -89.90, 35.155, -89.894),
        60.0,
        map_types=("satellite", "roadmap"),
        image_px=32,
        image_format="png",
    )
    capture(plan(mission, PatternSource().grid), PatternSource(), folder)
    return folder


def rows_of(folder, map_type="satellite"):
    with (folder / map_type / "priors.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_rows_are_those_of_the_table_and_errors_are_metres(run, flown):
    said = run("poses", "priors", str(flown), "--gnss", "3", "--outages", "0.25", "20", "--seed", "4")
    assert said.returncode == 0
    rows, table = rows_of(flown), Table.load(flown / "satellite" / "meta_data.csv")
    assert rows == rows_of(flown, "roadmap")
    assert [row["img_names"] for row in rows] == list(table.img_names)
    there = [at for at, row in enumerate(rows) if row["prior_lat_deg"]]
    assert 0 < len(there) < len(rows)
    assert f"no place in {len(rows) - len(there)} rows" in said.stdout
    assert all(row["prior_agl_m"] and row["prior_yaw_deg"] for row in rows)
    lat, lon = (np.array([float(rows[at][f"prior_{axis}_deg"]) for at in there]) for axis in ("lat", "lon"))
    _, _, off_m = Geod(ellps="WGS84").inv(table.pose_lon_deg[there], table.pose_lat_deg[there], lon, lat)
    # The mean square of a distance on a plane is twice that of an axis.
    assert math.sqrt(np.mean(off_m**2) / 2.0) == pytest.approx(3.0, rel=0.35)
    said = json.loads((flown / "satellite" / "priors.json").read_text())
    assert (said["gnss_m"], said["outage_share"], said["seed"]) == (3.0, 0.25, 4)
    before = (flown / "satellite" / "priors.csv").read_bytes()
    write_priors(flown, Sensors(3.0, outage_share=0.25, outage_s=20.0), 4)
    assert (flown / "satellite" / "priors.csv").read_bytes() == before


def test_what_cannot_be_is_refused(run, flown, tmp_path):
    for option, value, said in (
        ("--gnss", "-1", "gnss_m -1.0: must be from 0 to 10,000"),
        ("--drift", "inf", "drift_s inf: must be from 0 to 1e+06"),
        ("--gnss", "1e300", "gnss_m 1e+300: must be from 0 to 10,000"),
        ("--compass", "nan", "compass_deg nan: must be from 0 to 180"),
        ("--seed", "-3", "seed -3: must be 0 or more"),
    ):
        refused = run("poses", "priors", str(flown), option, value)
        assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
        assert said in refused.stderr
    assert "must be from 0 to below 1" in run("poses", "priors", str(flown), "--outages", "1", "5").stderr
    assert "must be above 0" in run("poses", "priors", str(flown), "--outages", "0.1", "0").stderr
    with pytest.raises(InvalidInput, match="its table has no poses of a camera"):
        write_priors(write_dataset(tmp_path / "OUT"), Sensors(), 1)


def test_drift_of_next_to_no_time_is_white():
    errors, _ = draw_errors(SECONDS[:2000], Sensors(2.0, drift_s=5e-324), 5)
    assert np.isfinite(errors).all()
    assert abs(lagged(errors[:, 0], 1)) < 0.1
