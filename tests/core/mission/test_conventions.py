"""Ground points projected by the words of each page that states a convention, and by nothing of the product's."""

from __future__ import annotations

import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

ROOT = Path(__file__).resolve().parents[3]
GEOCENTRIC = Transformer.from_crs(4979, 4978, always_xy=True)
LAT, LON, AGL = 47.31, 8.52, 130.0
EAST, NORTH, UP = np.eye(3)
ATTITUDES = [(0.0, 0.0, 0.0), (77.0, 0.0, 3.0), (-160.0, 30.0, 2.0), (20.0, 55.0, -5.0), (140.0, 40.0, 18.0)]
OPTION = "turned last, after yaw and tilt, about where the image's top edge points: right side down"


def turned(vector, about, angle_deg):
    """Vector turned clockwise as seen along a unit axis (Rodrigues)."""
    sine, cosine = math.sin(math.radians(angle_deg)), math.cos(math.radians(angle_deg))
    return vector * cosine + np.cross(about, vector) * sine + about * (about @ vector) * (1.0 - cosine)


def by_conventions(yaw, tilt, roll):
    """docs/poses.md: each angle turns about a direction of the image as the ones before have left it."""
    right, top, view = EAST, NORTH, -UP
    # Clockwise as seen from above is clockwise as seen along what points down.
    right, top = (turned(side, -UP, yaw) for side in (right, top))
    view, top = (turned(side, right, tilt) for side in (view, top))
    right, view = (turned(side, top, roll) for side in (right, view))
    return right, top, view


def by_options(yaw, tilt, roll):
    """The help of options: the top edge's azimuth, the view lifted towards it, a turn about it with the right down."""
    azimuth, lift, lean = map(math.radians, (yaw, tilt, roll))
    ahead = np.array([math.sin(azimuth), math.cos(azimuth), 0.0])
    view = math.sin(lift) * ahead - math.cos(lift) * UP
    top = math.cos(lift) * ahead + math.sin(lift) * UP
    beside = np.cross(view, top)
    right = math.cos(lean) * beside + math.sin(lean) * view
    return right, top, np.cross(top, right)


def by_aircraft(yaw, pitch, roll):
    """docs/photos.md: z-y'-x'' of an aircraft, x ahead, y right, z down, whose camera looks down."""

    def about(axis, angle_deg):
        sine, cosine = math.sin(math.radians(angle_deg)), math.cos(math.radians(angle_deg))
        return {
            "z": np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]),
            "y": np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]]),
            "x": np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]]),
        }[axis]

    ahead, right, down = (about("z", yaw) @ about("y", pitch) @ about("x", roll)).T
    return tuple(np.array([east, north, -down]) for north, east, down in (right, ahead, down))


#: Pages, the projection by their words, and these words.
PAGES = {
    "poses.md": (
        by_conventions,
        "All angles 0: the camera looks straight down with north at the image's top.",
        "Yaw turns it clockwise as seen from above.",
        "Then tilt turns it about the direction of the image's right, the view going towards where the top points.",
        "Then roll turns it about the direction in which the top points now, the right side going down.",
    ),
    "options.md": (
        by_options,
        OPTION,
        "lifted from straight down towards the image's top edge",
        "clockwise from north",
    ),
    "photos.md": (
        by_aircraft,
        "Yaw, pitch and roll turn an aircraft (z-y'-x'', x ahead, y right, z down) with a camera that looks down.",
        "At pitch 90 the camera looks ahead. At a positive roll the right side is down.",
    ),
    "benchmark.md": (
        by_options,
        "yaw turns the top of the image clockwise from north",
        "tilt lifts the view from straight down",
        "roll turns about the image's top, right side down",
    ),
}


@pytest.mark.parametrize("page", PAGES)
@pytest.mark.parametrize("attitude", ATTITUDES)
def test_points_are_where_the_words_of_each_page_put_them(page, attitude):
    by_words, *words = PAGES[page]
    text = " ".join((ROOT / "docs" / page).read_text(encoding="utf-8").split())
    assert [one for one in words if one not in text] == []
    yaw, tilt, roll = attitude
    points = Points(((LAT, LON, AGL),), yaws_deg=(yaw,), tilts_deg=(tilt,), rolls_deg=(roll,))
    made = plan(Mission(points, AGL, frame="camera", camera=Camera(60.0)), PixelGrid())
    width, height = made.frames.largest_px
    focal = math.hypot(width, height) / 2.0 / math.tan(math.radians(30.0))
    right, top, view = by_words(yaw, tilt, roll)
    phi, lam = math.radians(LAT), math.radians(LON)
    east = np.array([-math.sin(lam), math.cos(lam), 0.0])
    up = np.array([math.cos(phi) * math.cos(lam), math.cos(phi) * math.sin(lam), math.sin(phi)])
    to_enu = np.stack([east, np.cross(up, east), up])
    camera = np.array(GEOCENTRIC.transform(LON, LAT, AGL))
    for x, y in ((-0.9, -0.8), (0.7, -0.9), (0.0, 0.0), (0.5, 0.2)):
        seen, heights = made.views.seen(0, ((x, y),))
        ground = np.array(GEOCENTRIC.transform(seen.lon_deg[0, 0], seen.lat_deg[0, 0], heights[0, 0]))
        off = to_enu @ (ground - camera)
        column = width / 2.0 + focal * (off @ right) / (off @ view)
        row = height / 2.0 - focal * (off @ top) / (off @ view)
        assert (column, row) == pytest.approx(((x + 1.0) / 2.0 * width, (1.0 - y) / 2.0 * height), abs=2e-4)


def test_what_states_the_options_states_the_same():
    schema = (ROOT / "resources" / "mission.schema.json").read_text(encoding="utf-8")
    assert OPTION in json.dumps(json.loads(schema), ensure_ascii=False)
    translations = ET.parse(ROOT / "resources" / "i18n" / "terrainav_es.ts").getroot()
    spanish = [
        one.findtext("translation") or ""
        for one in translations.iter("message")
        if OPTION in (one.findtext("source") or "")
    ]
    assert spanish
    assert all("borde superior" in one for one in spanish)
    for path in (*ROOT.glob("docs/*.md"), ROOT / "README.md"):
        assert "line of sight, right side" not in path.read_text(encoding="utf-8"), path
