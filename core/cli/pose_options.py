"""Options of the actions of ``terrainav poses``."""

from __future__ import annotations

import argparse
from typing import Any

from ..fields import declared_fields
from ..mission.options import OPTIONS
from ..mission.parts import Flight
from ..poses.settings import Corridor, LineFlight, Orbit, PoseFile, Scan, Sensors
from .dataset_options import add_field, add_option

#: Names of a mission's options for the camera and its overlaps.
CAMERA = ("camera", "fov", "hfov", "vfov", "sensor", "focal_length", "aspect_ratio", "overlap")


def add_poses(whole: argparse.ArgumentParser, parser_class: Any) -> None:
    """Add the actions of ``terrainav poses`` and their options."""
    actions = whole.add_subparsers(dest="action", metavar="ACTION", required=True, parser_class=parser_class)
    _add_read(actions)
    _add_random(actions)
    _add_line(actions)
    _add_corridor(actions)
    _add_orbit(actions)
    _add_scans(actions)
    _add_priors(actions)


def _add_read(actions: Any) -> None:
    reading = actions.add_parser("read", help="make a table of poses from a trajectory or a flight log")
    reading.add_argument(
        "file", metavar="FILE", help="TUM, KITTI, EuRoC, GPX (.gpx), ULog (.ulg), DataFlash (.bin, .log)"
    )
    _add_output(reading)
    fields = {field.name: field for field in declared_fields(PoseFile)}
    add_field(reading, fields["format"])
    local = reading.add_argument_group("tum, kitti and euroc, in metres of a local frame")
    # Any number of values, as PoseFile refuses wrong numbers with a better message.
    local.add_argument(
        "--origin",
        nargs="+",
        type=float,
        metavar="DEG",
        help=f"LAT LON [HEIGHT]: {fields['origin'].help} (0)",
    )
    add_field(local, fields["body"], "default camera; needed for euroc")
    add_field(local, fields["world"], "default enu, or rdf for kitti")
    others = reading.add_argument_group("heights, times and attitude")
    for name in ("ground_height_m", "agl_m", "nadir", "every_s", "every_m", "times", "flight"):
        add_field(others, fields[name])
    others.add_argument("--start", metavar="TIME", help="time of the first position (ISO 8601), if not the file's")


def _add_random(actions: Any) -> None:
    drawing = actions.add_parser("random", help="make a table of random poses inside an area")
    drawing.add_argument(
        "--area",
        required=True,
        metavar="AREA",
        help='GeoJSON, KML or KMZ file of polygons, or a box "latTL_lonTL_latBR_lonBR"',
    )
    drawing.add_argument("--count", type=int, required=True, metavar="N", help="number of poses")
    _add_output(drawing)
    for name, default, what in (
        ("agl", None, "height above ground in metres"),
        ("yaw", ("uniform", "-180", "180"), "degrees from north to the image's top edge"),
        ("tilt", ("0",), "degrees of tilt, 0 straight down"),
        ("roll", ("0",), "degrees of roll about the direction of the image's top edge, right side down"),
    ):
        by_default = "" if default is None else f" ({' '.join(default)})"
        drawing.add_argument(
            f"--{name}",
            nargs="+",
            default=default,
            required=default is None,
            metavar="X",
            help=f"{what}: a number, uniform LOW HIGH, or normal MEAN DEVIATION{by_default}",
        )
    _add_seed(drawing)
    drawing.add_argument(
        "--inside",
        action="store_true",
        help="draw only poses whose camera sees nothing but ground, taken as level, with imagery of the source",
    )
    _add_camera(drawing, "source", "crs")


def _add_line(actions: Any) -> None:
    flying = actions.add_parser("line", help="make a table of poses along a line flown at a speed")
    flying.add_argument("file", metavar="LINE", help=_LINES)
    _add_output(flying)
    every = flying.add_mutually_exclusive_group(required=True)
    for field in declared_fields(LineFlight):
        add_field(every if field.optional else flying, field)
    flying.add_argument(
        "--agl", type=float, metavar="M", help="height above ground (default: the line's third coordinates)"
    )
    flying.add_argument(
        "--start",
        default=Flight.start,
        metavar="TIME",
        help="time of the first pose in UTC, such as 2024-06-21T10:30:00Z (%(default)s)",
    )


_LINES = "GeoJSON file of LineStrings, flown one after another"


def _add_corridor(actions: Any) -> None:
    corridor = actions.add_parser("corridor", help="make a table of rows along a line that cover a strip")
    corridor.add_argument("file", metavar="LINE", help=_LINES)
    _add_output(corridor)
    corridor.add_argument("--agl", type=float, required=True, metavar="M", help="height above ground in metres")
    for field in declared_fields(Corridor):
        add_field(corridor, field)
    _add_camera(corridor)


def _add_orbit(actions: Any) -> None:
    orbit = actions.add_parser("orbit", help="make a table of circles around a place, looking at it")
    # Two arguments, as argparse cannot show two names for one positional argument.
    for axis in ("lat", "lon"):
        orbit.add_argument(f"{axis}_deg", type=float, metavar=axis.upper(), help="of the centre, in degrees")
    _add_output(orbit)
    for field in declared_fields(Orbit):
        add_field(orbit, field)


def _add_scans(actions: Any) -> None:
    facade = actions.add_parser("facade", help="make a table of flights along walls, looking at them")
    facade.add_argument("file", metavar="LINE", help="GeoJSON file of LineStrings: the bases of the walls")
    facade.add_argument(
        "--left",
        action="store_true",
        help="fly to the left of the lines, not to the right",
    )
    structure = actions.add_parser("structure", help="make a table of flights around structures, looking at them")
    structure.add_argument("file", metavar="AREA", help="GeoJSON, KML or KMZ file of polygons: outlines of structures")
    for command in (facade, structure):
        _add_output(command)
        for field in declared_fields(Scan):
            add_field(command, field)
        _add_camera(command)


def _add_camera(command: argparse.ArgumentParser, *more: str) -> None:
    """Add the options of a camera and its overlaps, and ``more`` options of a mission, by name."""
    group = command.add_argument_group("camera", "as for plan and capture, each also in the environment or config.json")
    for option in OPTIONS:
        if option.name in (*CAMERA, *more):
            add_option(group, option)


def _add_priors(actions: Any) -> None:
    measuring = actions.add_parser(
        "priors",
        help="write simulated measurements of GNSS, barometer and compass beside a dataset's tables",
    )
    measuring.add_argument("folder", metavar="OUT", help="the dataset's folder")
    add_sensor_errors(measuring)
    _add_seed(measuring)


def add_sensor_errors(group: Any) -> None:
    """Add the options of `Sensors`."""
    for name, default, what in (
        ("gnss", Sensors.gnss_m, "standard deviation of the place along each of east and north, m"),
        ("barometer", Sensors.barometer_m, "standard deviation of the height, m"),
        ("compass", Sensors.compass_deg, "standard deviation of the heading, degrees"),
        (
            "drift",
            Sensors.drift_s,
            "time constant of drift, which is half of each variance, s; 0 for white noise only",
        ),
    ):
        group.add_argument(f"--{name}", type=float, default=default, metavar="X", help=f"{what} (%(default)g)")
    group.add_argument(
        "--outages",
        nargs=2,
        type=float,
        default=(Sensors.outage_share, Sensors.outage_s),
        metavar=("SHARE", "S"),
        help="share of the time without a GNSS fix, and mean length of an outage, s "
        f"({Sensors.outage_share:g} {Sensors.outage_s:g})",
    )


def _add_seed(command: argparse.ArgumentParser) -> None:
    command.add_argument("--seed", type=int, default=2024, metavar="N", help="seed of the random numbers (2024)")


def _add_output(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--output", required=True, metavar="FILE", help="table to write, for --coords of plan and capture"
    )
