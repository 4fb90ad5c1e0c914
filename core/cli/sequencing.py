"""Fly sequences on the command line."""

from __future__ import annotations

import argparse
import sys
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from ..fields import declared_fields
from ..storage.stores import is_address
from ..text.plain import printable
from .flying import capture_mission, fit_flight, mission_settings, mission_source, requested_heights
from .posing import sensor_errors

if TYPE_CHECKING:
    from ..geodesy.mercator import PixelGrid
    from ..mission.areas.area import Points
    from ..mission.mission import Mission
    from ..mission.plan import Plan
    from ..mission.relief.ground import Heights
    from ..poses.track import Track
    from ..sequences.settings import SequenceSettings
    from ..sequences.trajectory import Rig, Trajectory

#: Most positions of a track that a mission's area has.
_POSITIONS = 500


def run_fly(arguments: argparse.Namespace) -> int:
    """Capture the frames of a flight, and write the tables of its sensors beside them."""
    from ..mission.plan import plan
    from ..sequences.flying import Sequence
    from ..sequences.settings import InertialErrors, SequenceSettings, inertial_errors
    from ..sequences.trajectory import Rig

    settings = SequenceSettings(
        **{one.name: getattr(arguments, one.name_of_option) for one in declared_fields(SequenceSettings)}
    )
    rig = Rig(settings.imu_axes, tuple(arguments.lever_arm))
    figures = {one.name: getattr(arguments, one.name) for one in fields(InertialErrors)}
    errors = inertial_errors(settings.imu, {name: value for name, value in figures.items() if value is not None})
    sensors = sensor_errors(arguments)
    track = _track(arguments)
    if track is not None:
        if arguments.coords is not None:
            raise InvalidInput("coordinates: the flight has its own", field="coords", remedy="leave them out")
        if arguments.mission_file is None:
            # For the mission, whose area follows.
            arguments.coords = f"{track.lat_deg[0]:.9f}_{track.lon_deg[0]:.9f}_100"
    mission, values = mission_settings(arguments)
    if track is not None:
        mission = mission.replace(area=_area(track), wind=None)
    if is_address(values["data_dir"] or ""):
        raise InvalidInput("data folder {0}: must be one of this machine for a sequence", values["data_dir"])
    grid = mission_source(mission.of_first_imagery, values).grid
    mission = fit_flight(mission, arguments, values, grid)
    # Frames have neither rows to align nor an airspeed to choose.
    arguments.align, values["airspeed"] = None, mission.flight.airspeed_m_per_s
    one = mission.of_first_imagery
    heights = requested_heights(one, values)
    if track is None:
        trajectory, note = _planned(plan(one, grid, heights), settings, rig)
    else:
        trajectory, note = _followed(track, arguments, one, grid, heights, settings, rig), ""
        # The tilt of a mission is that of its poses, and that of a track how the camera sits on the aircraft.
        rig = replace(rig, tilt_deg=one.attitude.tilt_deg)
    sequence = Sequence(trajectory, rig, settings, *errors, sensors)
    frames = sequence.frames_mission(mission)
    planned = plan(frames.of_first_imagery, grid, heights)
    print(printable(f"{sequence.text(len(planned))}{note}"), file=sys.stderr)
    code = capture_mission(frames, values, arguments)
    sequence.write_tables(values["data_dir"], planned, _flight(arguments, mission))
    return code


def _track(arguments: argparse.Namespace) -> Track | None:
    """Track of a file or of an aircraft; None for a mission's flight."""
    if arguments.jsbsim is not None:
        from ..sequences.jsbsim import fly_script

        place = arguments.jsbsim_place
        return fly_script(arguments.jsbsim, arguments.jsbsim_root, None if place is None else tuple(place))
    if arguments.trajectory is None:
        return None
    from ..poses.reading import likely_format, read_track
    from ..poses.settings import PoseFile
    from .sequence_options import TRACK_FIELDS

    given = {name: getattr(arguments, option) for name, option in TRACK_FIELDS.items()}
    given.update(format=given["format"] or likely_format(arguments.trajectory), origin=given["origin"] or ())
    return read_track(arguments.trajectory, PoseFile(**given))


def _area(track: Track) -> Points:
    """Points along a track, at any height, with its times if these are dates."""
    import numpy as np

    from ..mission.areas.area import Points
    from ..mission.clock import is_dated

    some = track.take(np.unique(np.linspace(0, len(track) - 1, _POSITIONS).astype(np.intp)))
    has_dates = some.time_s is not None and bool(is_dated(some.time_s).all())
    return Points(
        tuple((lat, lon, 100.0) for lat, lon in zip(some.lat_deg.tolist(), some.lon_deg.tolist())),
        times_s=tuple(np.asarray(some.time_s).tolist()) if has_dates else (),
    )


def _planned(flown: Plan, settings: SequenceSettings, rig: Rig) -> tuple[Trajectory, str]:
    """Trajectory of a planned flight, and how far it passes captures."""
    from ..sequences.flying import passed_m, plan_trajectory

    trajectory = plan_trajectory(flown, settings, rig)
    return trajectory, f"; passes planned captures within {passed_m(flown, trajectory, rig):.2g} m"


def _followed(
    track: Track,
    arguments: argparse.Namespace,
    mission: Mission,
    grid: PixelGrid,
    heights: Heights | None,
    settings: SequenceSettings,
    rig: Rig,
) -> Trajectory:
    """Trajectory of a track, whose heights are above the ground at its start unless the mission's are absolute."""
    from ..mission.parts import ELLIPSOID, utc_time
    from ..mission.plan import plan
    from ..sequences.flying import track_trajectory

    if mission.terrain.elevation and mission.terrain.height_above == ELLIPSOID:
        above = track.height_m
    else:
        start = plan(mission.replace(area=_area(track).take([0])), grid, heights)
        ground_m = arguments.trajectory_ground_height
        if ground_m is None and track.ground_m is None:
            raise InvalidInput(
                "trajectory: does not say how high its ground is", remedy="give that (--trajectory-ground-height)"
            )
        above = track.above_ground_m(ground_m) + float(start.ground_m[0])
    start_us = round(utc_time(mission.flight.start).timestamp() * 1e6)
    return track_trajectory(track, above + arguments.raised_m, settings, rig, start_us)


def _flight(arguments: argparse.Namespace, mission: Mission) -> dict[str, Any]:
    """Where the trajectory comes from."""
    for kind in ("jsbsim", "trajectory"):
        if getattr(arguments, kind) is not None:
            return {kind: Path(getattr(arguments, kind)).name, "raised_m": arguments.raised_m}
    return {"mission": mission.to_dict()}
