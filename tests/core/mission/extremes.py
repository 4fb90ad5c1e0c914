"""Extreme missions: which there are, what became of each, and how wrong it measurably is."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import CORNERS, Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.view import ImageRays, mesh
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.layout.framing import ground_ellipsoid
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.outlines import footprints_deg
from terrainav.core.mission.plan import Plan, plan

from tests.core.geodesy import longdouble
from tests.core.geodesy.bounds import away_px, map_frame_points, perspective

GRID = PixelGrid()
#: What a mission may be refused for; anything else is a fault.
ALLOWED = (
    "no methods fit",
    "no ray of its image meets the Earth",
    "resolve 4e-08 m",
    "beyond the map",
    "±85.0511",
    "the limit is",
    "past the map or the Earth",
    "from nowhere on the map",
    "use --layout cover",
    "cannot be placed",
    "holds a pole",
)
LATITUDES = (0.0, 60.0, -60.0, 84.0, -84.0, 85.05, -85.05, 89.9999, -89.9999, 90.0, -90.0)
HEIGHTS_M = (0.01, 0.1, 3.0, 120.0, 1e3, 16e3, 256e3, 3e6, 8e6, 3.6e7)
CAMERAS = {
    "78.8° 4:3": Camera(78.8, 4 / 3),
    "0.01°": Camera(0.01, 1.0),
    "179.9°": Camera(179.9, 4 / 3),
    "1:1000": Camera(78.8, 1e-3),
    "1000:1": Camera(78.8, 1e3),
}
ATTITUDES = {"nadir": {}, "yaw 30 tilt 45 roll 10": {"yaw_deg": 30.0, "tilt_deg": 45.0, "roll_deg": 10.0}}
BOXES = {
    "smaller than an image": (Box(35.0001, -89.0001, 35, -89), 120.0),
    "thinner than a pixel": (Box(35.0000001, -89.02, 35, -89), 120.0),
    "as thin as a line": (Box(35.0000000001, -89.02, 35, -89), 120.0),
    "of next to no area": (Box(35.0000000001, -89.0000000001, 35, -89), 120.0),
    "the world at 60 km": (Box(85.05, -180, -85.05, 180), 60e3),
    "the world to 80° at 800 km": (Box(80, -180, -80, 180), 8e5),
    "across the antimeridian": (Box(10.1, 179.95, 10, -179.95), 1200.0),
    "east of the antimeridian": (Box(10.1, -180, 10, -179.9), 1200.0),
    "west of the antimeridian": (Box(10.1, 179.9, 10, 180), 1200.0),
    "at 84° N": (Box(84.05, 0, 84, 0.5), 1200.0),
    "at 84° S": (Box(-84, 0, -84.05, 0.5), 1200.0),
    "at the map's end": (Box(85.05, 0, 85.03, 0.2), 300.0),
    "beyond the map": (Box(86, 0, 85.5, 1), 300.0),
    "at the pole": (Box(90, 0, 89, 1), 300.0),
    "Norway, zone 32": (Box(60.05, 2.9, 60, 3.1), 1200.0),
    "Svalbard, zones 31 and 33": (Box(78.05, 8.9, 78, 9.1), 1200.0),
    "a zone's edge": (Box(40.05, -90.05, 40, -89.95), 1200.0),
    "UPS latitudes": (Box(84.6, 10, 84.5, 10.5), 1200.0),
}
#: Cameras that look past the Earth or over a pole: field of view, height, yaw, tilt; and the latitude at which the
#: tests have them, so that each way to end is among them.
ASIDE = (
    (140.0, 2.8e7, 30.0, 55.0, 0.0),
    (160.0, 3.6e7, 300.0, 65.0, 80.0),
    (160.3353, 28336680.0, 165.476, 72.5, 80.0),
    (120.0, 8e6, 165.0, 65.0, 60.0),
)
#: Pictures of one of these missions at most: the suite is of cases, not of size.
MOST = 200_000


class Case(NamedTuple):
    """A mission, and what it is called.

    Not ``tested``, and the benchmark's alone, is what ends as another does: after seconds, or on the other hemisphere.
    """

    name: str
    mission: Mission
    tested: bool = True


class Outcome(NamedTuple):
    """What became of a case; the error is measured at the corners of its first captures and across one picture."""

    case: Case
    refusal: str
    methods: str
    bound_px: float
    error_px: float
    condition: float
    seconds: float
    covered: bool = True


def cases() -> Iterator[Case]:
    """Every case of the suite."""
    yield from _single_cameras()
    yield from _boxes()


def _single_cameras() -> Iterator[Case]:
    for (height, agl), lat, (number, (camera_name, camera)), (attitude_name, attitude) in itertools.product(
        enumerate(HEIGHTS_M), LATITUDES, enumerate(CAMERAS.items()), ATTITUDES.items()
    ):
        name = f"{agl:g} m, latitude {lat:g}, {camera_name}, {attitude_name}"
        mission = Mission(Points(((lat, 179.99999, agl),)), agl, camera=camera, **attitude)
        # Of north and south by turns, so that each camera is in both.
        north = (height + number) % 2 == 0
        yield Case(name, mission, lat == 0.0 or (lat > 0.0) == north)
    for inside in (1.0, 0.1, 0.01, 0.001, -0.001, -1.0):
        for agl in (1.0, 120.0, 16e3, 8e6):
            for camera in (Camera(0.01, 1.0), Camera(78.8, 4 / 3)):
                dip = math.degrees(math.acos(6371e3 / (6371e3 + agl)))
                side = "inside" if inside > 0 else "above"
                name = f"{agl:g} m, {camera.fov_deg:g}°, looking {abs(inside):g}° {side} the horizon"
                area = Points(((35.0, -89.0, agl),))
                yield Case(name, Mission(area, agl, camera=camera, tilt_deg=90.0 - dip - inside))


def _boxes() -> Iterator[Case]:
    for name, (box, agl) in BOXES.items():
        for layout in ("cover", "paper"):
            for share in (0.0, 0.5, 0.9, 0.999):
                overlap = {"overlap_along": share, "overlap_across": share}
                mission = Mission(box, agl, layout=layout, max_images=MOST, **overlap)
                refused_late = name == "the world to 80° at 800 km" and layout == "cover" and share == 0.999
                yield Case(f"box {name}, {layout}, overlap {share:g}", mission, not refused_late)
        for attitude_name, attitude in (("yaw 45", {"yaw_deg": 45.0}), ("tilt 60", {"tilt_deg": 60.0})):
            yield Case(f"box {name}, {attitude_name}", Mission(box, agl, max_images=MOST, **attitude))
    for (fov, agl, yaw, tilt, tested), lat in itertools.product(ASIDE, (0.0, 60.0, 80.0)):
        attitude = {"yaw_deg": yaw, "tilt_deg": tilt, "roll_deg": 40.0}
        area = Box(lat + 2.5, -60, lat - 2.5, 60)
        name = f"box at {lat:g}°, {fov:g}° from {agl:g} m, yaw {yaw:g}, tilt {tilt:g}, roll 40"
        mission = Mission(area, agl, camera=Camera(fov, 1.5), max_images=MOST, **attitude)
        yield Case(name, mission, lat == tested)


def run(case: Case) -> Outcome:
    """Plan a case and measure its errors."""
    start = time.perf_counter()
    try:
        made = plan(case.mission, GRID)
        if len(made) <= MOST:
            _ = made.coverage, made.overlap, made.masked, made.names[0]
        next(footprints_deg(made, slice(0, 1)))
    except InvalidInput as refused:
        return Outcome(case, str(refused), "", math.nan, math.nan, math.nan, time.perf_counter() - start)
    seconds = time.perf_counter() - start
    covered = (
        case.mission.flight.layout != "cover" or len(made) > MOST or made.coverage is None or made.coverage.complete
    )
    chosen = made.accuracy
    methods = ", ".join(choice.method.name for choice in chosen.choices)
    return Outcome(case, "", methods, chosen.bound_px, measured_px(made), chosen.condition, seconds, covered)


def planned_as(case: Case, frame: str) -> str:
    """Why a case is refused where its pictures are of one kind; empty where it is planned."""
    try:
        plan(case.mission.replace(frame=frame, accept_error=frame == "map"), GRID)
    except InvalidInput as refused:
        return str(refused)
    return ""


def finite(made: Plan) -> bool:
    """Whether everything in a plan is a number."""
    columns = (*made.poses, *made.windows, made.corners.lat_deg, made.corners.lon_deg, *made.frame_centres)
    return all(bool(np.isfinite(np.asarray(column, float)).all()) for column in columns)


def measured_px(made: Plan) -> float:
    """Sum over the stages of the largest errors found, px of the picture: corners, and points across one picture."""
    first = np.arange(min(len(made), 50))
    poses = made.poses.take(first)
    camera = made.mission.camera
    # A map frame's pixels are the source's squares, however few rows of them a flat picture has.
    width = float(made.frames.width_px[0])
    size = (width, width / camera.aspect_ratio) if made.frames.on_map else tuple(map(float, made.frames.largest_px))
    scene = ImageGeometry(camera, *size, poses, ground_ellipsoid(made.mission))
    corners = made.corners
    error = away_px(
        scene,
        corners.lat_deg[first],
        corners.lon_deg[first] - poses.lon_deg[:, np.newaxis],
        np.array(CORNERS),
    )
    error = np.where(corners.hit[first] & np.isfinite(error), error, 0.0)
    return float(error.max()) + _picture_px(made, scene)


def _picture_px(made: Plan, scene: ImageGeometry) -> float:
    one = ImageGeometry(scene.camera, scene.width_px, scene.height_px, scene.poses.take(np.array([0])))
    if made.frames.on_map:
        lat, dlon, wanted = map_frame_points(made.mission.camera, one.poses)
        return float(away_px(one, lat, dlon, wanted).max())
    tolerance = made.accuracy.mesh_tolerance_px
    if tolerance == 0.0:
        return 0.0
    cells = mesh(ImageRays.from_scene(one), tolerance)
    if not len(cells.box):
        return 0.0
    rng = np.random.default_rng(1)
    which = rng.integers(0, len(cells.box), 1000)
    a, b = rng.random((2, 1000))
    box = cells.box[which]
    column, row = box[:, 0] + a * (box[:, 2] - box[:, 0]), box[:, 1] + b * (box[:, 3] - box[:, 1])
    du, v = perspective(cells.du[which], cells.v[which], a, b)
    wanted = np.stack([2 * column / one.width_px - 1, 1 - 2 * row / one.height_px], axis=-1)
    return float(away_px(one, longdouble.latitude_deg(v)[np.newaxis], du[np.newaxis] * 360.0, wanted).max())
