"""Priors: simulated readings of a GNSS receiver, a barometer and a compass for the poses of a dataset.

Each error is normal with a given standard deviation: half of its variance is white, and half drifts as a first-order
Gauss-Markov process with a given time constant. Outages of the receiver follow a two-state Markov process: the lengths
of outages, and of the times between them, are exponentially distributed.
"""

from __future__ import annotations

import math
import os
from dataclasses import asdict

import numpy as np

from ..arrays import Floats, NDArray
from ..dataset.dataset import ImageSet, read_dataset
from ..dataset.folder import MISSION_FILE
from ..dataset.table import unix_seconds
from ..errors import InvalidInput
from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import wrap_lon_deg
from ..mission.flight.deviates import normal, uniform
from ..mission.flight.legs import intervals_s, legs
from ..mission.mission import Mission
from ..mission.parts import Flight
from ..storage.files import csv_bytes, json_bytes, write_whole
from .settings import Sensors

PRIORS_FILE, SETTINGS_FILE = "priors.csv", "priors.json"
COLUMNS = ("img_names", "prior_lat_deg", "prior_lon_deg", "prior_agl_m", "prior_yaw_deg")
#: Number of errors per pose: east, north, up and heading.
_ERRORS = 4


def write_priors(folder: str | os.PathLike[str], sensors: Sensors, seed: int) -> dict[str, int]:
    """Write ``priors.csv`` beside each table of a dataset, and ``priors.json`` with the sensors and the seed.

    Rows match those of the table. The same row of two tables, such as of two map types, has the same errors. In an
    outage, the place is empty; if an image has no pose, the whole row is empty.

    Parameters
    ----------
    seed : int
        At least 0.

    Returns
    -------
    dict of str to int
        Number of rows without a place, by map type.

    Raises
    ------
    InvalidInput
        The folder holds no capture with poses.
    OutputError
        The files cannot be written.
    """
    if seed < 0:
        raise InvalidInput("seed {0}: must be 0 or more", seed)
    lost = {}
    for name, images in read_dataset(folder).image_sets.items():
        table = images.table
        if not np.isfinite(table.pose_lat_deg).any():
            raise InvalidInput("folder {0}: its table has no poses of a camera", images.folder)
        rows, lost[name] = _rows(images, sensors, seed)
        write_whole(images.folder / PRIORS_FILE, csv_bytes([COLUMNS, *rows]))
        write_whole(images.folder / SETTINGS_FILE, json_bytes({**asdict(sensors), "seed": seed}))
    return lost


def draw_errors(times_s: Floats, sensors: Sensors, seed: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Errors (n, 4) of east, north, up and heading at ascending times (n,), and whether the receiver has a fix (n,)."""
    first, second = (np.random.PCG64(one) for one in np.random.SeedSequence(seed).spawn(2))
    count = len(times_s)
    deviates = normal(first, count, 2 * _ERRORS)
    deviation = np.array([sensors.gnss_m, sensors.gnss_m, sensors.barometer_m, sensors.compass_deg])
    white, drift = deviates[:, :_ERRORS], deviates[:, _ERRORS:]
    gaps_s = np.diff(times_s)
    if sensors.drift_s:
        with np.errstate(over="ignore"):
            # A tiny time constant makes gaps infinite, and so the states independent.
            drift = _drift(gaps_s / sensors.drift_s, drift)
    errors = (white + drift) * math.sqrt(0.5) * deviation
    return errors, _fixed(gaps_s, sensors, uniform(second, count))


def _drift(gaps: Floats, deviates: Floats) -> Floats:
    """Stationary Gauss-Markov process (n, m) of standard deviation 1, with gaps (n - 1,) in time constants.

    Each state is a share of the previous state plus new noise. The recurrence is solved by doubling (the scan of Hillis
    and Steele), in which products of shares only decrease and nothing overflows.
    """
    share = np.concatenate([[0.0], np.exp(-gaps)])[:, np.newaxis]
    states = deviates.copy()
    states[1:] *= np.sqrt(-np.expm1(-2.0 * gaps))[:, np.newaxis]
    step = 1
    while step < len(states) and share.any():
        states[step:] += share[step:] * states[:-step]
        share[step:] = share[step:] * share[:-step]
        step *= 2
    return states


def _fixed(gaps_s: Floats, sensors: Sensors, chance: Floats) -> NDArray[np.bool_]:
    """Whether there is a fix: a stationary two-state Markov process, sampled after each gap."""
    share = sensors.outage_share
    # Probability that the state was not drawn anew: the rates into and out of an outage add up.
    kept = np.concatenate([[0.0], np.exp(-gaps_s / (sensors.outage_s * (1.0 - share)))])
    # Probabilities of an outage after a fix and after an outage; a draw between them keeps the state.
    after_fix, after_outage = share * (1.0 - kept), share + (1.0 - share) * kept
    settled = (chance < after_fix) | (chance >= after_outage)
    settled[0] = True
    last = np.maximum.accumulate(np.where(settled, np.arange(len(chance)), 0))
    fixed: NDArray[np.bool_] = (chance >= after_fix)[last]
    return fixed


def _rows(images: ImageSet, sensors: Sensors, seed: int) -> tuple[list[tuple[object, ...]], int]:
    """Rows of the table of priors, and the number without a place."""
    table = images.table
    errors, fixed = draw_errors(_times_s(images), sensors, seed)
    lat, lon = table.pose_lat_deg, table.pose_lon_deg
    north = np.degrees(errors[:, 1] / WGS84.meridional_radius_m(lat))
    east = np.degrees(errors[:, 0] / (WGS84.normal_radius_m(lat) * np.cos(np.radians(lat))))
    has_place = np.isfinite(lat) & fixed
    # Degrees are rounded to 1 mm, like heights.
    place_digits, digits = 8, 3
    columns = (
        np.round(np.where(has_place, np.clip(lat + north, -90.0, 90.0), np.nan), place_digits),
        np.round(np.where(has_place, wrap_lon_deg(lon + east), np.nan), place_digits),
        np.round(table.agl_m + errors[:, 2], digits),
        np.round(wrap_lon_deg(table.yaw_deg + errors[:, 3]), digits),
    )
    cells = ([value if value == value else "" for value in column.tolist()] for column in columns)
    return list(zip(table.img_names, *cells)), int((~has_place).sum())


def _times_s(images: ImageSet) -> Floats:
    """Ascending times of the rows in seconds: from the table, or of a flight from row to row at the airspeed."""
    table = images.table
    if all(table.time_utc):
        return np.maximum.accumulate(unix_seconds(table.time_utc))
    path = images.folder.parent / MISSION_FILE
    airspeed = Mission.load(path).flight.airspeed_m_per_s if path.is_file() else Flight.airspeed_m_per_s
    known = np.isfinite(table.pose_lat_deg)
    # Rows without a pose get the place of the first pose.
    lat, lon, agl = (
        np.where(known, column, column[np.argmax(known)])
        for column in (table.pose_lat_deg, table.pose_lon_deg, table.agl_m)
    )
    gaps = intervals_s(legs(lat, lon), agl, airspeed, None)
    return np.concatenate([[0.0], np.cumsum(gaps)])
