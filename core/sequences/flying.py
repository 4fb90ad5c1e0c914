"""A flight as a sequence: its trajectory, the mission that captures its frames, and the tables of its sensors."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Floats, Numbers
from ..errors import InvalidInput, Message, OptionName
from ..fields import declared_fields
from ..geodesy.ellipsoid import WGS84, arctan2
from ..geodesy.local import enu_axes, geocentric, geodetic
from ..geodesy.quaternions import quaternions_from_matrices
from ..mission.areas.area import Points
from ..mission.clock import is_dated
from ..mission.flight.legs import legs
from ..mission.flight.motion import Disturbance, fly
from ..mission.flight.path import CAPTURE, FlightPath
from ..mission.mission import Mission
from ..mission.parts import BY_TIME, ELLIPSOID, IDEAL, Attitude, Flight, Route, utc_time
from ..mission.plan import Plan
from ..poses.settings import Sensors
from ..poses.track import ANGLE_DIGITS, PLACE_DIGITS, Track
from ..storage.files import json_bytes, write_whole
from .files import (
    BAROMETER_FILE,
    GNSS_FILE,
    INERTIAL_FILE,
    MAGNETOMETER_FILE,
    SCHEMA,
    SEQUENCE_FILE,
    TRAJECTORY_FILE,
    write_table,
)
from .inertial import exact_inertial, measured_inertial
from .priors import gnss_places, magnetic_fields_nt, pressures_pa
from .settings import InertialErrors, SequenceSettings
from .trajectory import Motion, Rig, Trajectory, uniform_b_spline

#: Acceleration in turns of a path without times, m/s²: a bank of about 25 degrees.
TURNING_M_PER_S2 = 4.5
#: Time between knots of such a path, s.
KNOTS_S = 0.1
#: Least interval of its control points, s.
_BRISKEST_S = 0.5


@dataclass(frozen=True, eq=False)
class Sequence:
    """A flight with a camera and sensors on one clock.

    Parameters
    ----------
    trajectory : Trajectory
        Path of the inertial unit.
    rig : Rig
    settings : SequenceSettings
    errors : InertialErrors
        Errors of the inertial unit.
    source : str
        Where the figures of the errors come from.
    sensors : Sensors
        Errors of GNSS receiver, barometer and magnetometer.
    """

    trajectory: Trajectory
    rig: Rig
    settings: SequenceSettings
    errors: InertialErrors
    source: str
    sensors: Sensors

    def times_us(self, rate_hz: float) -> Numbers:
        """Times of samples after the start, in whole microseconds (n,)."""
        count = int(np.floor(self.trajectory.duration_s * rate_hz + 1e-6)) + 1
        spaced = np.rint(np.arange(count) * (1e6 / rate_hz))
        times: Numbers = np.minimum(spaced, np.floor(self.trajectory.duration_s * 1e6)).astype(np.int64)
        return times

    def frame_times_us(self) -> Numbers:
        """Times of the frames after the start (n,), on whole milliseconds of the day, as tables state them."""
        times_us = self.times_us(self.settings.rate_hz) + self.trajectory.start_us
        whole_us = -(-times_us // 1000) * 1000 - self.trajectory.start_us
        return whole_us[whole_us <= self.trajectory.duration_s * 1e6]

    def motion(self, times_us: Numbers) -> Motion:
        """Motion of the inertial unit at times in microseconds after the start."""
        return self.trajectory.at(times_us * 1e-6)

    def stamps_ns(self, times_us: Numbers) -> Numbers:
        """Nanoseconds after 1970 of times in microseconds after the start."""
        return (self.trajectory.start_us + times_us) * 1000

    def frames_mission(self, mission: Mission) -> Mission:
        """The mission that captures one image for each frame, from the exact pose of the camera.

        Parameters
        ----------
        mission : Mission
            Camera, imagery, relief, products and effects of the frames.

        Raises
        ------
        InvalidInput
            Frames are faster than exposures, are map frames, vary in pose, or are not above the ground.
        """
        _check_frames(mission, self.settings)
        times_us = self.frame_times_us()
        lat, lon, height, (yaw, tilt, roll) = self.rig.camera(self.motion(times_us))
        over_relief = bool(mission.terrain.elevation)
        above = np.round(height if over_relief else height - mission.flight.ground_height_m, ANGLE_DIGITS)
        low = np.flatnonzero(above <= 0.0)
        if len(low):
            raise InvalidInput(
                "frame {0:,}, {1:g} s after the start: is {2:.2f} m below the ground or the ellipsoid",
                int(low[0]) + 1,
                times_us[low[0]] * 1e-6,
                -above[low[0]],
                remedy="fly higher",
            )
        places = np.round(lat, PLACE_DIGITS), np.round(lon, PLACE_DIGITS), above
        angles = (tuple((np.round(angle, ANGLE_DIGITS) + 0.0).tolist()) for angle in (yaw, tilt, roll))
        points = Points(
            tuple(zip(*(one.tolist() for one in places))),
            **dict(zip(("yaws_deg", "tilts_deg", "rolls_deg"), angles)),
            times_s=tuple(((self.trajectory.start_us + times_us) / 1e6).tolist()),
        )
        kept = ("agl_m", "ground_height_m", "start", "airspeed_m_per_s")
        unused = {
            one.name: one.default
            for part in (Attitude, Flight, Route)
            for one in declared_fields(part)
            if one.name not in (*kept, "exposure_ms")
        }
        changes: dict[str, Any] = {**unused, "frame": "camera"}
        if over_relief:
            changes["height_above"] = ELLIPSOID
        return mission.replace(area=points, wind=None, no_fly=(), **changes)

    def write_tables(self, folder: str | os.PathLike[str], frames: Plan, flight: Mapping[str, Any]) -> None:
        """Write the sequence's files into the folder of its dataset.

        Parameters
        ----------
        frames : Plan
            Plan of the frames' mission.
        flight : mapping
            Where the trajectory comes from; JSON-ready.

        Raises
        ------
        OutputError
            The folder cannot be written.
        """
        root, settings = Path(folder), self.settings
        times_us = self.times_us(settings.imu_rate_hz)
        motion = self.motion(times_us)
        measured, biases = measured_inertial(
            exact_inertial(motion), self.errors, settings.imu_rate_hz, settings.sensor_seed
        )
        stamps = self.stamps_ns(times_us)
        # Far below the noise of any unit.
        write_table(root, INERTIAL_FILE, stamps, (measured.rate_rad_per_s, 12), (measured.force_m_per_s2, 9))
        lat, lon, height = geodetic(motion.place_m)
        axes = enu_axes(lat, lon)
        speed = np.einsum("nij,nj->ni", axes, motion.velocity_m_per_s)
        turned = quaternions_from_matrices(axes @ motion.rotation)
        # 11 decimals of degrees are a micrometre.
        columns = ((lat, 11), (lon, 11), (height, 6), (speed, 9), (turned, 12), *((bias, 12) for bias in biases))
        write_table(root, TRAJECTORY_FILE, stamps, *columns)
        self._write_priors(root)
        write_whole(root / SEQUENCE_FILE, json_bytes(self.to_json(len(frames), flight)))

    def _write_priors(self, root: Path) -> None:
        """Write the tables of GNSS receiver, barometer and magnetometer, whose errors are independent."""
        settings, sensors = self.settings, self.sensors
        seeds = [int(one.generate_state(1)[0]) for one in np.random.SeedSequence(settings.sensor_seed).spawn(6)[3:]]
        times_us = self.times_us(settings.gnss_rate_hz)
        places = gnss_places(self.motion(times_us), times_us * 1e-6, sensors, seeds[0])
        # To 0.1 mm.
        columns = zip(places, (PLACE_DIGITS, PLACE_DIGITS, 4))
        write_table(root, GNSS_FILE, self.stamps_ns(times_us), *columns)
        times_us = self.times_us(settings.air_rate_hz)
        motion, stamps = self.motion(times_us), self.stamps_ns(times_us)
        pressures = pressures_pa(motion, times_us * 1e-6, sensors, seeds[1])
        write_table(root, BAROMETER_FILE, stamps, (pressures, 3))
        fields = magnetic_fields_nt(motion, times_us * 1e-6, self.trajectory.start_us, sensors, seeds[2])
        write_table(root, MAGNETOMETER_FILE, stamps, (fields, 3))

    def text(self, frames: int) -> str:
        """Figures in one line."""
        settings = self.settings
        return (
            f"{frames:,} frames at {settings.rate_hz:g} Hz in {self.trajectory.duration_s:.1f} s, inertial unit "
            f"{settings.imu} at {settings.imu_rate_hz:g} Hz"
        )

    def to_json(self, frames: int, flight: Mapping[str, Any]) -> dict[str, Any]:
        """JSON form of all but the trajectory."""
        start_us = np.datetime64(self.trajectory.start_us, "us")
        body_camera = np.eye(4)
        body_camera[:3, :3], body_camera[:3, 3] = self.rig.camera_axes, self.rig.lever_m
        return {
            "schema": SCHEMA,
            "start_utc": f"{start_us}Z",
            "duration_s": self.trajectory.duration_s,
            "frames": frames,
            **asdict(self.settings),
            "imu_errors": asdict(self.errors),
            "imu_source": self.source,
            "prior_errors": asdict(self.sensors),
            "camera_to_imu": body_camera.tolist(),
            "flight": dict(flight),
        }


def _check_frames(mission: Mission, settings: SequenceSettings) -> None:
    if mission.accuracy.frame == "map":
        raise InvalidInput(
            "frame {0}: frames of a sequence are perspectives",
            mission.accuracy.frame,
            field="frame",
            remedy="choose camera",
        )
    if mission.varied.of_poses:
        raise InvalidInput(
            "{0} at random: frames of a sequence have the poses of its trajectory",
            mission.varied.of_poses[0].field,
            field="vary",
            remedy="leave it out",
        )
    exposure = mission.exposure.exposure
    open_ms = mission.exposure.longest_exposure_ms if exposure == BY_TIME else mission.route.exposure_ms
    if (exposure != IDEAL or mission.takes_time) and (open_ms or 0.0) * settings.rate_hz > 1000.0:
        raise InvalidInput(
            "exposure time {0:g} ms: longer than the {1:.4g} ms between two frames",
            open_ms,
            1000.0 / settings.rate_hz,
            field="exposure_ms",
            remedy=Message("shorten the exposure, or take fewer frames ({0})", OptionName("rate")),
        )


def plan_trajectory(flown: Plan, settings: SequenceSettings, rig: Rig) -> Trajectory:
    """Trajectory of a planned flight from the first capture of a sortie to its last.

    Points with times are gone through. Other flights follow the path, with its corners rounded, and gusts.

    Raises
    ------
    InvalidInput
        No such sortie, fewer than two captures in it, or a trajectory that jumps.
    """
    mission = flown.mission
    start_us = round(utc_time(flown.direct.start).timestamp() * 1e6)
    if flown.direct.has_times:
        if mission.wind is not None:
            raise InvalidInput(
                "wind: poses with times are flown as they are", field="wind_speed", remedy="leave the wind out"
            )
        if settings.sortie > 1:
            raise InvalidInput("sortie {0}: the flight has one", settings.sortie, field="sortie")
        meant, height = flown.meant, np.asarray(flown.ground_m) + flown.meant.agl_m
        track = Track(meant.lat_deg, meant.lon_deg, height, None, flown.direct.exposures_s, meant.attitude)
        return track_trajectory(track, height, settings, rig, start_us)
    path = flown.path
    if settings.sortie > path.sorties:
        raise InvalidInput("sortie {0}: the flight has {1}", settings.sortie, path.sorties, field="sortie")
    return _rounded_path(flown, path.sortie_path(settings.sortie - 1), settings, rig, start_us)


def track_trajectory(track: Track, height_m: Floats, settings: SequenceSettings, rig: Rig, start_us: int) -> Trajectory:
    """Trajectory through the positions of a track.

    Parameters
    ----------
    height_m : array (n,)
        Heights above the ellipsoid.
    start_us : int
        Time of the first position, microseconds after 1970, where the track's times are not dates.

    Raises
    ------
    InvalidInput
        The track has no times, or jumps.
    """
    if track.time_s is None:
        raise InvalidInput("trajectory: has no times, which a sequence needs")
    if is_dated(track.time_s).all():
        start_us = round(float(track.time_s[0]) * 1e6)
    level = np.zeros(len(track))
    attitude = track.attitude_deg or (track.headings_deg(), level, level)
    # Files state at most microseconds, which float64 seconds after 1970 keep to a quarter.
    time_s = np.round(track.time_s - track.time_s[0], 6)
    places = track.lat_deg, track.lon_deg, height_m
    return Trajectory.through_cameras(time_s, *places, attitude, rig, start_us, settings.smooth_s or 0.0)


def _rounded_path(flown: Plan, path: FlightPath, settings: SequenceSettings, rig: Rig, start_us: int) -> Trajectory:
    """Path as a uniform cubic B-spline, which rounds its corners."""
    taken = np.flatnonzero(path.kind == CAPTURE)
    first_s, last_s = (float(path.time_s[taken[at]]) for at in (0, -1))
    if last_s - first_s < _BRISKEST_S:
        raise InvalidInput("flight of {0:.2g} s: a sequence needs captures that are apart", last_s - first_s)
    # Normals of the ellipsoid rather than angles, so that poles and the antimeridian are places like others.
    normals = enu_axes(path.lat_deg, path.lon_deg)[:, 2]
    angles = np.stack(
        [np.interp(path.time_s, path.time_s[taken], angle) for angle in _captured_angles(flown, path.capture[taken])]
    )
    values = np.concatenate([normals, path.height_m[:, np.newaxis], angles.T, path.agl_m[:, np.newaxis]], axis=1)
    interval_s = settings.smooth_s or _turn_interval_s(path, normals, first_s, last_s)
    steps = max(round((last_s - first_s) / interval_s), 1)
    control_s = np.linspace(first_s, last_s, steps + 1)
    control = np.stack([np.interp(control_s, path.time_s, column) for column in values.T], axis=1)
    count = max(int(np.ceil((last_s - first_s) / KNOTS_S)), 3)
    time_s = np.linspace(0.0, last_s - first_s, count + 1)
    smooth = uniform_b_spline(control, steps, time_s * (steps / time_s[-1]))
    lat, lon = _places(smooth[:, :3])
    attitude = smooth[:, 4], smooth[:, 5], smooth[:, 6]
    gust = _gusts(flown, lat, lon, time_s, smooth[:, 7], smooth[:, 4])
    lat = lat + np.degrees(gust.north_m / WGS84.meridional_radius_m(lat))
    lon = lon + np.degrees(gust.east_m / (WGS84.normal_radius_m(lat) * np.cos(np.radians(lat))))
    turned = (gust.yaw_deg, gust.tilt_deg, gust.roll_deg)
    return Trajectory.through_cameras(
        time_s,
        lat,
        lon,
        smooth[:, 3] + gust.up_m,
        (attitude[0] + turned[0], attitude[1] + turned[1], attitude[2] + turned[2]),
        rig,
        start_us + round(first_s * 1e6),
    )


def _captured_angles(flown: Plan, capture: Numbers) -> tuple[Floats, ...]:
    """Yaw, tilt and roll of captures, turned the shorter way from each to the next."""
    return tuple(np.unwrap(angle[capture], period=360.0) for angle in flown.meant.attitude)


def _turn_interval_s(path: FlightPath, normals: Floats, first_s: float, last_s: float) -> float:
    """Interval of control points with which the sharpest corner of a path is turned at `TURNING_M_PER_S2`."""
    places = normals * (WGS84.a_m + path.height_m)[:, np.newaxis]
    seconds = np.diff(path.time_s)
    moving = seconds > 0.0
    velocities = np.diff(places, axis=0)[moving] / seconds[moving, np.newaxis]
    corners_s = path.time_s[:-1][moving][1:]
    within = (corners_s > first_s) & (corners_s < last_s)
    changes = np.linalg.norm(np.diff(velocities, axis=0), axis=1)[within]
    return max(float(changes.max(initial=0.0)) / TURNING_M_PER_S2, _BRISKEST_S)


def _places(normals: Floats) -> tuple[Floats, Floats]:
    """Latitudes and longitudes (n,) in degrees of directions (n, 3) normal to the ellipsoid."""
    x, y, z = normals.T
    return np.degrees(arctan2(z, np.hypot(x, y))), np.degrees(arctan2(y, x))


def _gusts(flown: Plan, lat: Floats, lon: Floats, time_s: Floats, agl_m: Floats, yaw_deg: Floats) -> Disturbance:
    """What gusts do to the camera, at times (n,) of a path."""
    wind = flown.mission.wind
    if wind is None:
        return Disturbance(*np.zeros((6, len(time_s))))
    interval_s = np.full(len(time_s) - 1, time_s[1] - time_s[0])
    airspeed = flown.mission.flight.airspeed_m_per_s
    return fly(wind, airspeed, interval_s, legs(lat, lon).headings_deg(), agl_m, yaw_deg)


def passed_m(flown: Plan, trajectory: Trajectory, rig: Rig) -> float:
    """Greatest distance from a planned capture to where the camera is at its time."""
    path = flown.path
    after_s = path.time_s - (trajectory.start_us - round(utc_time(flown.direct.start).timestamp() * 1e6)) / 1e6
    taken = (path.kind == CAPTURE) & (after_s >= 0.0) & (after_s <= trajectory.duration_s)
    motion = trajectory.at(after_s[taken])
    camera = motion.place_m + motion.rotation @ np.array(rig.lever_m)
    meant = geocentric(path.lat_deg[taken], path.lon_deg[taken], path.height_m[taken])
    return float(np.linalg.norm(camera - meant, axis=1).max(initial=0.0))
