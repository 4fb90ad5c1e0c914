"""``terrainav poses``: tables of poses from trajectories, logs, patterns or at random, and noisy priors."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING

from ..errors import InvalidInput, Message
from ..fields import declared_fields
from ..numbers import real_number
from ..storage.files import file_exists, write_whole
from ..text.plain import printable
from .exits import DONE

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from ..geodesy.camera import Camera, Poses
    from ..mission.areas.area import Box, Points, Polygon, Polygons
    from ..poses.settings import Scan, Sensors


def run_poses(arguments: argparse.Namespace) -> int:
    """Run an action of ``terrainav poses``."""
    actions = {
        "read": _read,
        "random": _random,
        "line": _line,
        "corridor": _corridor,
        "orbit": _orbit,
        "facade": _facade,
        "structure": _structure,
        "priors": _priors,
    }
    return actions[arguments.action](arguments)


def _read(arguments: argparse.Namespace) -> int:
    from ..poses.reading import read_poses_file
    from ..poses.settings import PoseFile
    from ..text.plain import time_s

    given = {field.name: getattr(arguments, field.name_of_option) for field in declared_fields(PoseFile)}
    given["origin"] = given["origin"] or ()
    given["start_s"] = time_s(arguments.start, "--start") if arguments.start else None
    read = read_poses_file(arguments.file, PoseFile(**given))
    _write(read.points, arguments.output)
    for reason, count in read.why_left_out.items():
        print(f"{count:,} of {read.positions:,} positions left out, {reason}")
    return DONE


def _random(arguments: argparse.Namespace) -> int:
    from ..poses.random_poses import Distribution, PoseDistributions, random_poses

    distributions = PoseDistributions(
        *(Distribution.parse(getattr(arguments, name)) for name in ("agl", "yaw", "tilt", "roll"))
    )
    keep = _inside(arguments) if arguments.inside else None
    points = random_poses(_area(arguments.area), arguments.count, distributions, arguments.seed, keep)
    _write(points, arguments.output)
    return DONE


def _inside(arguments: argparse.Namespace) -> Callable[[Poses], Any]:
    """Return a function that reports which poses see only imagery of the source."""
    from ..imagery.opening import SourceOptions, named_source
    from ..mission.inside import poses_inside
    from ..mission.settings import build_camera, resolve
    from .pose_options import CAMERA

    values = resolve({name: getattr(arguments, name) for name in (*CAMERA, "source", "crs")})
    grid = named_source(values["source"], SourceOptions(crs=values["crs"] or "")).grid
    camera, image_px = build_camera(values)
    return lambda poses: poses_inside(grid, camera, poses, image_px)


def _line(arguments: argparse.Namespace) -> int:
    from ..poses.line import fly, read_lines, turn_radius_m
    from ..poses.settings import LineFlight
    from ..text.plain import time_s

    flight = LineFlight(arguments.speed, arguments.every_s, arguments.every_m, arguments.bank, arguments.fixed_camera)
    lines = read_lines(arguments.file, arguments.agl)
    flown = fly(lines, flight, time_s(arguments.start, "--start"))
    _write(flown.points, arguments.output)
    print(f"turns of {turn_radius_m(flight):,.1f} m, which miss corners by up to {flown.missed_m:,.1f} m")
    if flown.tight:
        print(f"tighter ones between short legs: {flown.tight:,}, flown at down to {flown.slowest_m_per_s:.1f} m/s")
    return DONE


def _corridor(arguments: argparse.Namespace) -> int:
    from ..poses.line import read_lines
    from ..poses.patterns import corridor
    from ..poses.settings import Corridor

    wanted = Corridor(arguments.width, arguments.offset)
    camera, overlaps = _camera(arguments)
    lines = read_lines(arguments.file, arguments.agl)
    _write(corridor(lines, camera, arguments.agl, overlaps, wanted), arguments.output)
    return DONE


def _orbit(arguments: argparse.Namespace) -> int:
    from ..poses.patterns import orbit
    from ..poses.settings import Orbit

    wanted = Orbit(
        arguments.radius,
        arguments.lowest,
        arguments.highest,
        arguments.circles,
        arguments.images,
        arguments.target,
    )
    lat_deg, lon_deg = arguments.lat_deg, arguments.lon_deg
    _write(orbit(lat_deg, lon_deg, wanted), arguments.output)
    return DONE


def _facade(arguments: argparse.Namespace) -> int:
    from ..poses.line import read_lines
    from ..poses.patterns import facade

    wanted = _scan(arguments)
    lines = read_lines(arguments.file, wanted.lowest_m)
    _write(facade(lines, *_camera(arguments), wanted, left=arguments.left), arguments.output)
    return DONE


def _structure(arguments: argparse.Namespace) -> int:
    from ..mission.areas.files import load_polygons
    from ..poses.patterns import structure

    wanted = _scan(arguments)
    outlines = load_polygons(arguments.file, Message("area file {0}", arguments.file))
    _write(structure(outlines, *_camera(arguments), wanted), arguments.output)
    return DONE


def _scan(arguments: argparse.Namespace) -> Scan:
    from ..poses.settings import Scan

    return Scan(arguments.distance, arguments.lowest, arguments.highest, arguments.tilt)


def _camera(arguments: argparse.Namespace) -> tuple[Camera, tuple[float, float]]:
    """Camera from the command's options, and overlaps along and across rows."""
    from ..mission.settings import build_camera, resolve
    from .pose_options import CAMERA

    values = resolve({name: getattr(arguments, name) for name in CAMERA})
    overlap = values["overlap"]
    return build_camera(values)[0], (overlap[0], overlap[-1])


def _area(text: str) -> Box | Polygon | Polygons:
    from ..mission.areas.area import Box, check_ground
    from ..mission.areas.files import load_area

    if file_exists(text):
        return load_area(text)
    try:
        north, west, south, east = (real_number(field) for field in re.split(r"[_,;\s]+", text.strip()))
    except ValueError as wrong:
        raise InvalidInput(
            "area {0!r}: no such file, and no box",
            text,
            remedy='give a GeoJSON, KML or KMZ file of polygons, or a box "latTL_lonTL_latBR_lonBR"',
        ) from wrong
    box = Box(north, west, south, east)
    check_ground(box)
    return box


def _write(points: Points, path: str) -> None:
    from ..mission.pose_table import table_text

    write_whole(path, table_text(points).encode())
    print(printable(f"{len(points.poses):,} poses in {path}"))


def sensor_errors(arguments: argparse.Namespace) -> Sensors:
    """Errors of GNSS receiver, barometer and compass from the command's options."""
    from ..poses.settings import Sensors

    share, seconds = arguments.outages
    return Sensors(arguments.gnss, arguments.barometer, arguments.compass, arguments.drift, share, seconds)


def _priors(arguments: argparse.Namespace) -> int:
    from ..poses.priors import PRIORS_FILE, write_priors

    for name, without_place in write_priors(arguments.folder, sensor_errors(arguments), arguments.seed).items():
        print(printable(f"{name:11s} {PRIORS_FILE} beside the table; no place in {without_place:,} rows"))
    return DONE
