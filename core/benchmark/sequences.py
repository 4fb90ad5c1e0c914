"""Predictions for the frames of a sequence, compared with its poses."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import Floats
from ..dataset.dataset import read_dataset
from ..dataset.folder import MISSION_FILE
from ..errors import InvalidInput
from ..geodesy.camera import image_axes
from ..geodesy.local import enu_axes, geocentric
from ..mission.mission import Mission
from ..sequences.files import SequenceRecord
from .answers import POSE, checked_pose
from .folder import read_number, read_rows
from .metrics import WITHIN_M, WITHIN_M_DEG, pose_figures, position_figures
from .scoring import Figure

#: Lengths of way over which drift is measured, metres, as in KITTI's odometry benchmark (Geiger et al., CVPR 2012).
DRIFT_M = (100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0)


@dataclass(frozen=True, eq=False)
class FramePoses:
    """Poses of cameras, NaN where unknown.

    Parameters
    ----------
    place_m : array (n, 3)
        Geocentric.
    rotation : array (n, 3, 3)
        Right, top and view of the images, in geocentric axes, as columns.
    """

    place_m: Floats
    rotation: Floats

    @classmethod
    def from_table(cls, pose: Floats) -> FramePoses:
        """Poses of rows (n, 6) with columns as in `POSE`."""
        lat, lon, height, yaw, tilt, roll = pose.T
        axes = np.stack(image_axes(yaw, tilt, roll), axis=-1)
        return cls(geocentric(lat, lon, height), np.swapaxes(enu_axes(lat, lon), -1, -2) @ axes)


def score_sequence(folder: str | os.PathLike[str], predictions: str | os.PathLike[str]) -> tuple[Figure, ...]:
    """Score predictions for the frames of a sequence.

    Parameters
    ----------
    folder : path
        The sequence's dataset.
    predictions : path
        CSV with the columns ``query``, the file name of a frame, and those of `POSE`; all but ``query``, ``lat_deg``
        and ``lon_deg`` are optional, and cells may be empty. Without a height, the true one counts.

    Raises
    ------
    InvalidInput
        The folder holds no sequence, or the file cannot be read, lacks columns, or names unknown frames.
    """
    SequenceRecord.read(folder)
    truth, names = _truth(Path(folder))
    found = _read(Path(predictions), names, truth)
    return compare(FramePoses.from_table(truth), FramePoses.from_table(found))


def compare(truth: FramePoses, found: FramePoses) -> tuple[Figure, ...]:
    """Figures of predicted poses against true ones, (n,) each in the order of the flight."""
    error_m = np.linalg.norm(found.place_m - truth.place_m, axis=1)
    error_deg = _angles_deg(truth.rotation, found.rotation)
    positions = position_figures(error_m)
    poses = pose_figures(error_m, error_deg)
    drift_m, drift_deg = _drift(truth, found)
    return (
        Figure("frames", float(len(error_m)), "", "frames of the sequence"),
        Figure("answered", float(np.isfinite(error_m).mean()), "", "share of frames with a position"),
        Figure("median error", positions.median, "m", "distance of the camera in space"),
        Figure("median angle", poses.median, "deg", "angle between true and predicted attitude"),
        *(
            Figure(f"within {limit:g} m", share, "", "share of all frames localised")
            for limit, share in zip(WITHIN_M, positions.within)
        ),
        *(
            Figure(f"within {m:g} m, {deg:g} deg", share, "", "share of all frames localised with their attitude")
            for (m, deg), share in zip(WITHIN_M_DEG, poses.within)
        ),
        Figure("drift", drift_m, "", "error of the way between frames 100 to 800 m apart, by that way"),
        Figure("drift of attitude", drift_deg, "deg/100 m", "error of the turn between such frames, by that way"),
    )


def _truth(folder: Path) -> tuple[Floats, dict[str, int]]:
    """Poses (n, 6) of all frames, and their numbers by file name."""
    mission = Mission.load(folder / MISSION_FILE)
    area = mission.area
    lat, lon, above = np.array(getattr(area, "poses"), np.float64).T  # noqa: B009 (of points alone)
    # Heights over relief are those above the ellipsoid.
    height = above if mission.terrain.elevation else above + mission.flight.ground_height_m
    angles = (np.array(getattr(area, f"{name}s_deg")) for name in ("yaw", "tilt", "roll"))
    table = next(iter(read_dataset(folder).image_sets.values())).table
    names = {name: int(column) for name, column in zip(table.img_names, table.columns)}
    return np.stack([lat, lon, height, *angles], axis=1), names


def _read(path: Path, names: dict[str, int], truth: Floats) -> Floats:
    """Predicted poses (n, 6) of all frames; NaN where none is predicted."""
    lines = read_rows(path, named_by_user=True)
    _, header = next(lines)
    if not {"query", "lat_deg", "lon_deg"} <= set(header):
        raise InvalidInput(
            "predictions {0}: need the columns query, lat_deg and lon_deg; its columns are {1}", path, ", ".join(header)
        )
    found = np.full(truth.shape, np.nan)
    answered: dict[int, int] = {}
    for number, row in lines:
        where = f"predictions {path}, line {number}:"
        cells = dict(zip(header, row))
        frame = names.get(Path(cells["query"]).name)
        if frame is None:
            raise InvalidInput("{0} frame {1!r} is not in the sequence", where, cells["query"])
        if answered.setdefault(frame, number) != number:
            raise InvalidInput(
                "{0} frame {1!r} is answered in line {2} already", where, cells["query"], answered[frame]
            )
        pose = checked_pose({one: read_number(cells.get(one, ""), f"{where} {one}") for one in POSE}, where)
        found[frame] = [pose[one] for one in POSE]
        if math.isnan(found[frame, 2]):
            found[frame, 2] = truth[frame, 2]
    return found


def _angles_deg(one: Floats, other: Floats) -> Floats:
    """Angles (n,) between rotations (n, 3, 3)."""
    # By the sine of half the angle, which is accurate for small angles.
    chord = np.linalg.norm(one - other, axis=(1, 2)) / math.sqrt(8.0)
    angles: Floats = 2.0 * np.degrees(np.arcsin(np.minimum(chord, 1.0)))
    return angles


def _drift(truth: FramePoses, found: FramePoses) -> tuple[float, float]:
    """Mean errors of way and turn between frames, by the way; NaN where no two answered frames are far enough apart."""
    way_m = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(truth.place_m, axis=0), axis=1)))
    shares, turns = [], []
    for length_m in DRIFT_M:
        later = np.searchsorted(way_m, way_m + length_m)
        first = np.flatnonzero(later < len(way_m))
        last = later[first]
        error_m = np.linalg.norm(
            (found.place_m[last] - found.place_m[first]) - (truth.place_m[last] - truth.place_m[first]), axis=1
        )
        true_turn, found_turn = (
            np.swapaxes(one.rotation[first], -1, -2) @ one.rotation[last] for one in (truth, found)
        )
        way = way_m[last] - way_m[first]
        shares.append(error_m / way)
        turns.append(_angles_deg(true_turn, found_turn) * 100.0 / way)
    return _mean(np.concatenate(shares)), _mean(np.concatenate(turns))


def _mean(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else math.nan
