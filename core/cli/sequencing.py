"""Fly sequences on the command line."""

from __future__ import annotations

import argparse
import sys
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..dataset.folder import MISSION_FILE
from ..fields import declared_fields
from ..text.plain import printable
from .flying import capture_mission, mission_settings, requested_heights
from .posing import sensor_errors

if TYPE_CHECKING:
    from ..geodesy.mercator import PixelGrid
    from ..mission.mission import Mission
    from ..mission.plan import Plan
    from ..sequences.flying import Sequence


def run_fly(arguments: argparse.Namespace) -> int:
    """Capture the frames of a flight, and write the tables of its sensors beside them."""
    from ..mission.plan import plan
    from ..sequences.flying import Sequence, passed_m, plan_trajectory
    from ..sequences.settings import InertialErrors, SequenceSettings, inertial_errors
    from ..sequences.trajectory import Rig

    settings = SequenceSettings(
        **{one.name: getattr(arguments, one.name_of_option) for one in declared_fields(SequenceSettings)}
    )
    rig = Rig(settings.body, tuple(arguments.lever_arm))
    figures = {one.name: getattr(arguments, one.name) for one in fields(InertialErrors)}
    errors = inertial_errors(settings.imu, {name: value for name, value in figures.items() if value is not None})
    mission, values = mission_settings(arguments)
    made: list[tuple[Sequence, Plan, dict[str, Any]]] = []

    def change(asked: Mission, grid: PixelGrid) -> Mission:
        one = asked.of_first_imagery
        heights = requested_heights(one, values)
        flown = plan(one, grid, heights)
        sequence = Sequence(plan_trajectory(flown, settings, rig), rig, settings, *errors, sensor_errors(arguments))
        frames = sequence.frames_mission(asked)
        planned = plan(frames.of_first_imagery, grid, heights)
        made.append((sequence, planned, {"mission": asked.to_dict()}))
        _print_figures(sequence, planned, passed_m(flown, sequence))
        return frames

    code = capture_mission(mission, values, arguments, change)
    folder = Path(values["data_dir"])
    if made and (folder / MISSION_FILE).is_file():
        sequence, planned, flight = made[0]
        sequence.write_tables(folder, planned, flight)
    return code


def _print_figures(sequence: Sequence, frames: Plan, passed_m: float) -> None:
    settings, seconds = sequence.settings, sequence.trajectory.duration_s
    print(
        printable(
            f"{len(frames):,} frames at {settings.rate_hz:g} Hz in {seconds:.1f} s; passes planned captures within "
            f"{passed_m:.2g} m; inertial unit {settings.imu} at {settings.imu_rate_hz:g} Hz"
        ),
        file=sys.stderr,
    )
