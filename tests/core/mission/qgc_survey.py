"""A reader of QGroundControl's surveys of its own: what its loaders ask for, and the rows that it lays anew.

Written from what QGroundControl's `SurveyComplexItem`, `TransectStyleComplexItem` and `CameraCalc` do. It knows nothing
of the exporter.
"""

from __future__ import annotations

import math

from pyproj import Geod

from tests.core.mission.qgc_loaders import loaded_survey

GEOD = Geod(ellps="WGS84")
WAYPOINT, TRIGGER, PHOTO = 16, 206, 2000


def checked(survey):
    """The parts of a survey that QGroundControl loads."""
    transects = loaded_survey(survey)
    assert survey["entryLocation"] in range(4)
    assert -90.0 < survey["angle"] <= 90.0
    assert len(survey["polygon"]) >= 3
    assert transects["CameraCalc"]["CameraName"] == "Custom Camera"
    for item in transects["Items"]:
        assert item["command"] in (WAYPOINT, TRIGGER, PHOTO)
        assert item["frame"] == (3 if item["command"] == WAYPOINT else 2)
    return transects


def footprint_m(camera):
    """Side and front of an image on the ground, as QGroundControl works them out of the camera."""
    density = (
        camera["DistanceToSurface"] * camera["SensorWidth"] * 100.0 / (camera["ImageWidth"] * camera["FocalLength"])
    )
    assert math.isclose(density, camera["ImageDensity"], rel_tol=1e-9)
    wide, high = camera["ImageWidth"] * density / 100.0, camera["ImageHeight"] * density / 100.0
    return (wide, high) if camera["Landscape"] else (high, wide)


def photos(items):
    """Places of the images that items ask for, in order, each with its height and the heading there."""
    found, here, spacing = [], None, 0.0
    for item in items:
        params = item["params"]
        if item["command"] == WAYPOINT:
            there = params[4], params[5], params[6], params[3]
            if spacing:
                azimuth, _, length = GEOD.inv(here[1], here[0], there[1], there[0])
                # The last one is that which the trigger's end asks for.
                for step in range(1, math.ceil(length / spacing - 1e-6)):
                    lon, lat, _ = GEOD.fwd(here[1], here[0], azimuth, step * spacing)
                    found.append((lat, lon, *here[2:]))
            here = there
        elif item["command"] == PHOTO:
            found.append(here)
        else:
            spacing = params[0]
            assert params[2] == 1
            found.append(here)
    return found


def rows_anew(survey):
    """Ends of the rows that QGroundControl lays when a survey is edited, in the order that it flies them."""
    lat0, lon0 = survey["polygon"][0]
    camera = survey["TransectStyleComplexItem"]["CameraCalc"]
    corners = [(0.0, 0.0)]
    for lat, lon in survey["polygon"][1:]:
        azimuth, _, length = GEOD.inv(lon0, lat0, lon, lat)
        corners.append((length * math.sin(math.radians(azimuth)), length * math.cos(math.radians(azimuth))))
    corners.append(corners[0])
    easts, norths = zip(*corners)
    x0, y0 = (min(easts) + max(easts)) / 2.0, (min(norths) + max(norths)) / 2.0
    reach = max(max(easts) - min(easts), max(norths) - min(norths)) + 2000.0
    angle = math.radians(-survey["angle"])

    def turned(x, y):
        return (
            (x - x0) * math.cos(angle) - (y - y0) * math.sin(angle) + x0,
            (x - x0) * math.sin(angle) + (y - y0) * math.cos(angle) + y0,
        )

    found, x = [], x0 - reach / 2.0
    while x < x0 + reach / 2.0:
        hits = _hits(turned(x, y0 - reach / 2.0), turned(x, y0 + reach / 2.0), corners)
        if len(hits) > 1:
            pairs = [(a, b) for at, a in enumerate(hits) for b in hits[at + 1 :]]
            found.append(max(pairs, key=lambda pair: math.dist(*pair)))
        x += camera["AdjustedFootprintSide"]
    directions = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in found]
    found = [pair if math.cos(one - directions[0]) > 0.0 else pair[::-1] for pair, one in zip(found, directions)]
    # Top left, top right, bottom left, bottom right.
    if survey["entryLocation"] in (2, 3):
        found = [pair[::-1] for pair in found]
    if survey["entryLocation"] in (1, 3):
        found = found[::-1]
    found = [pair[::-1] if number % 2 else pair for number, pair in enumerate(found)]
    return [[_place(lat0, lon0, *end) for end in pair] for pair in found]


def _hits(start, end, corners):
    hits = []
    for one, other in zip(corners, corners[1:]):
        across = (end[0] - start[0]) * (other[1] - one[1]) - (end[1] - start[1]) * (other[0] - one[0])
        if abs(across) < 1e-9:
            continue
        dx, dy = one[0] - start[0], one[1] - start[1]
        on_line = (dx * (other[1] - one[1]) - dy * (other[0] - one[0])) / across
        on_side = (dx * (end[1] - start[1]) - dy * (end[0] - start[0])) / across
        if 0.0 <= on_line <= 1.0 and 0.0 <= on_side <= 1.0:
            hits.append((start[0] + on_line * (end[0] - start[0]), start[1] + on_line * (end[1] - start[1])))
    return hits


def _place(lat0, lon0, x, y):
    lon, lat, _ = GEOD.fwd(lon0, lat0, math.degrees(math.atan2(x, y)), math.hypot(x, y))
    return lat, lon


def shots_anew(survey):
    """How many images QGroundControl takes along each of its own rows, by distance."""
    spacing = survey["TransectStyleComplexItem"]["CameraCalc"]["AdjustedFootprintFrontal"]
    return [
        math.floor(GEOD.inv(start[1], start[0], end[1], end[0])[2] / spacing) + 1 for start, end in rows_anew(survey)
    ]
