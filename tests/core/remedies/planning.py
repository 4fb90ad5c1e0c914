"""What refusals of a plan advise: a mission and a grid that are refused, and what each thing advised comes to."""

from __future__ import annotations

import re
from functools import partial

import numpy as np
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.footprint import outline
from terrainav.core.geodesy.frames import map_windows
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.geodesy.ways import way_around
from terrainav.core.mission.areas.area import Box, Points, Polygon, Polygons
from terrainav.core.mission.flight.alignment import align_rows
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import LONGEST_SIDE
from terrainav.core.mission.plan import plan
from terrainav.core.world import WorldSource

from tests.support.remedies import Case, remedy

GRID = PixelGrid()
AREA, SMALL = Box(35.16, -89.90, 35.15, -89.89), Box(35.002, -89.002, 35.0, -89.0)
HIGH = {"frame": "map", "accept_error": True}
TURNED = Mission(AREA, 120.0, row_azimuth_deg=127.0)
#: Where the advice is to take the figure that the message names.
NAMED = "the figure named"


def at(lat, agl, **more):
    return Mission(Points(((lat, 0.0, agl),)), agl, **more)


def moved(lat, agl):
    return {"area": Points(((lat, 0.0, agl),)), "agl_m": agl}


def over(north, **more):
    """A box of a degree of longitude, from a latitude a degree down."""
    return Mission(Box(north, 0, north - 1.0, 1), more.pop("agl_m"), **more)


def planned(module, message, mission, ways, grid=GRID, room="mission"):
    """Enter a refusal of a plan; each way out is a grid, or what of the mission is changed."""

    def entry(case: Case) -> None:
        text = case.refused(partial(plan, mission, grid))
        # A camera that is level cannot be tilted less.
        assert mission.attitude.tilt_deg or mission.attitude.roll_deg or "tilt" not in text.partition("; ")[2]
        named = re.search(r"(?:with|are) ([0-9.e+-]+) (?:px|m)\b", text)
        for what, way in ways.items():
            if isinstance(way, PixelGrid):
                case.follow(what, partial(plan, mission, way))
                continue
            change = {name: float(named[1]) if value == NAMED else value for name, value in way.items()}
            case.follow(what, partial(plan, mission.replace(**change), grid))

    remedy(f"{room}/{module}", message)(entry)


planned(
    "layout/rows.py",
    "area reaches latitude {}: images end at ±{} (Web Mercator); choose imagery in a polar CRS, such as the "
    "synthetic world with --crs {}",
    Mission(Box(-89.9, 0.0, -89.95, 40.0), 120.0),
    {
        "choose imagery in a polar CRS": WorldSource(crs="EPSG:3031").grid,
        "such as the synthetic world with --crs EPSG:3031": WorldSource(crs="EPSG:3031").grid,
    },
)
planned(
    "methods.py",
    "pixels of {} m on the ground: degrees in float64 resolve {} m; fly higher or widen the field of view",
    at(35.0, 0.01, camera=Camera(0.01, 1.0), frame="camera", upsample=True),
    {"fly higher": moved(35.0, 10.0), "widen the field of view": {"camera": Camera(60.0, 1.0)}},
)
planned(
    "methods.py",
    "error budget {} px: no methods fit; the closest are {} with {} px, {} times as much; raise "
    "--error-budget, or go on "
    "with --accept-error",
    Mission(AREA, 120.0, error_budget_px=1e-12),
    {"raise --error-budget": {"error_budget_px": NAMED}, "go on with --accept-error": {"accept_error": True}},
)
planned(
    "methods.py",
    "image as the camera sees it: {}; choose a source of tiles",
    Mission(AREA, 120.0, tilt_deg=9.0),
    {"choose a source of tiles": GRID},
    PixelGrid(centre_decimals=6, max_size_px=640),
)

LARGER_PICTURES = "{}, or allow larger images (--max-px)"
#: What is put together of parts: how many px are too many for a mission on a grid, and each thing advised for it.
TOO_LARGE = {
    "fly lower": (Mission(AREA, 120.0, max_px=640), PixelGrid(min_zoom=19), {"agl_m": 60.0}),
    "choose a lower zoom": (Mission(AREA, 120.0, zoom=19, max_px=640), GRID, {"zoom": 18}),
    "choose a larger ground sample distance": (
        *(Mission(AREA, 120.0, gsd_m_per_px=0.3, max_px=640), GRID, {"gsd_m_per_px": 0.5}),
    ),
}


@remedy("mission/layout/framing.py", LARGER_PICTURES)
def _larger_pictures(case: Case) -> None:
    for mission, grid, _ in TOO_LARGE.values():
        case.refused(partial(plan, mission, grid))
    for mission, grid, _ in TOO_LARGE.values():
        assert len(plan(mission.replace(max_px=700), grid))
    case.follow("allow larger images (--max-px)", partial(plan, mission.replace(max_px=700), grid))


for _advice, (_mission, _grid, _change) in TOO_LARGE.items():
    planned("layout/framing.py", _advice, _mission, {_advice: _change}, _grid)

planned(
    "layout/framing.py",
    "{}, or make them smaller (--max-px)",
    at(35.0, 9e3, image_px=20_000, accept_error=True),
    {"make them smaller (--max-px)": {"max_px": 10_000}},
)
planned(
    "layout/framing.py",
    "zoom {}: the source's own pixels end at zoom {}; ask for that, or allow upsampling (--upsample)",
    Mission(AREA, 120.0, zoom=20),
    {"ask for that": {"zoom": 16}, "allow upsampling (--upsample)": {"upsample": True}},
    PixelGrid(native_zoom=16),
)
planned(
    "layout/framing.py",
    "ground sample distance {} m: the source's own pixels are {} m here; ask for that or more, or allow "
    "upsampling (--upsample)",
    Mission(AREA, 120.0, gsd_m_per_px=0.5),
    {
        "ask for that": {"gsd_m_per_px": NAMED},
        "more": {"gsd_m_per_px": 3.0},
        "allow upsampling (--upsample)": {"upsample": True},
    },
    PixelGrid(native_zoom=16),
)
planned(
    "layout/framing.py",
    "{}: lies beyond the map, which ends at ±{}; fly higher or nearer to the equator, or choose imagery in a polar CRS",
    at(86.0, 1e3),
    {
        "fly higher": moved(86.0, 1e6),
        "nearer to the equator": moved(80.0, 1e3),
        "choose imagery in a polar CRS": WorldSource(crs="EPSG:3413").grid,
    },
)
planned(
    "layout/framing.py",
    "{}: reaches beyond the map, which ends at ±{}; fly lower or nearer to the equator, or choose imagery in a polar "
    "CRS",
    at(85.0505, 300.0, **HIGH),
    {
        "fly lower": moved(85.0505, 3.0),
        "nearer to the equator": moved(84.0, 300.0),
        "choose imagery in a polar CRS": WorldSource(crs="EPSG:3413").grid,
    },
)
planned(
    "layout/framing.py",
    "image from {} m at zoom {}: under one pixel; fly higher or choose a higher zoom",
    at(35.0, 1.0, zoom=5, **HIGH),
    {"fly higher": moved(35.0, 1e5), "choose a higher zoom": {"zoom": 22}},
)
planned(
    "layout/framing.py",
    "{}; fly higher or choose a higher zoom",
    at(35.0, 1.0, zoom=5),
    {"fly higher": moved(35.0, 1e5), "choose a higher zoom": {"zoom": 22}},
)
planned(
    "layout/framing.py",
    "{}; fly higher or choose a smaller ground sample distance",
    at(35.0, 1.0, gsd_m_per_px=90.0, frame="camera"),
    {"fly higher": moved(35.0, 1e4), "choose a smaller ground sample distance": {"gsd_m_per_px": 0.5}},
)
NARROW = at(0.0, 9e4, camera=Camera(20.0, 1e4), tilt_deg=1.0, frame="camera")
planned(
    "layout/framing.py",
    "{}; choose a less extreme aspect ratio or a larger image (--image-px)",
    NARROW,
    {
        "choose a less extreme aspect ratio": {"camera": Camera(20.0, 10.0)},
        "a larger image (--image-px)": {"image_px": 9_000},
    },
)
planned(
    "layout/framing.py",
    "{}; choose a less extreme aspect ratio or larger images (--max-px)",
    NARROW.replace(image_px=9_000, max_px=640),
    {
        "choose a less extreme aspect ratio": {"camera": Camera(20.0, 10.0)},
        "larger images (--max-px)": {"max_px": 9_000},
    },
)
planned(
    "layout/rows.py",
    "mission of {} images: the limit is {}; fly higher, draw a smaller area, or raise it (--max-images)",
    Mission(AREA, 120.0, max_images=20),
    {
        "fly higher": {"agl_m": 600.0},
        "draw a smaller area": {"area": SMALL},
        "raise it (--max-images)": {"max_images": 60},
    },
)
planned(
    "layout/rows.py",
    "overlap {}: leaves under 0.001 px between captures; overlap less",
    Mission(Box(35.0001, -89.0001, 35, -89), 120.0, overlap_along=0.9999999),
    {"overlap less": {"overlap_along": 0.9}},
)
planned(
    "layout/paper.py",
    "paper layout over {} deg of longitude: its UTM grid holds to {} deg from the zone's meridian; use --layout cover",
    Mission(Box(10, -170, -10, 170), 1e5, layout="paper", accept_error=True),
    {"use --layout cover": {"layout": "cover"}},
)
planned(
    "layout/rows.py",
    "images with under 0.001 px of map in them: the camera looks past the map or the Earth; tilt it less or fly lower",
    Mission(Box(84, 0, 83.5, 1), 8e5, tilt_deg=20.0),
    {"tilt it less": {"tilt_deg": 2.0}, "fly lower": {"agl_m": 8e4}},
)
planned(
    "layout/rows.py",
    "images with under 0.001 px of map in them: the camera looks past the map or the Earth; fly lower",
    over(70.0, agl_m=3e6),
    {"fly lower": {"agl_m": 3e5}},
)
ASIDE = Mission(Box(84.5, 0, 84, 1), 3e5, yaw_deg=180.0, tilt_deg=50.0)
CONIC = PixelGrid(256, 0, 12, 12, plane=ProjectedPlane("EPSG:2154", 6e5, 7e6, 2.0**19, 2.0**19))
IN_FRANCE = {"area": Box(47.01, 3.0, 47.0, 3.01)}
planned(
    "layout/rotated.py",
    "area: the source's CRS {} does not reach latitude {}, longitude {}; choose an area that the source shows",
    Mission(Box(-89.0, 0, -90.0, 1), 120.0),
    {"choose an area that the source shows": IN_FRANCE},
    CONIC,
)
planned(
    "layout/rotated.py",
    "layout {}: lies on the Web-Mercator map, and the source has pixels of its own in {}; use --layout cover",
    Mission(IN_FRANCE["area"], 120.0, layout="paper"),
    {"use --layout cover": {"layout": "cover"}},
    CONIC,
)
planned(
    "layout/rotated.py",
    "camera with tilt {}, roll {} deg from {} m: sees past the horizon, and an area is covered by images of ground "
    "alone on a source that has its own CRS; tilt it less or fly lower",
    Mission(IN_FRANCE["area"], 4e5, tilt_deg=50.0),
    {"tilt it less": {"tilt_deg": 5.0}, "fly lower": {"agl_m": 1e3, "tilt_deg": 45.0}},
    CONIC,
)
planned(
    "planes.py",
    "image at latitude {}, longitude {}: lies beyond what the source's CRS {} can show; choose an area that the "
    "source shows",
    Mission(Points(((-90.0, 0.0, 120.0),)), 120.0),
    {"choose an area that the source shows": IN_FRANCE},
    CONIC,
    room="geodesy",
)
planned(
    "layout/parallels.py",
    "a camera at {} m with this tilt sees the area from nowhere on the map; tilt it less or fly lower",
    ASIDE,
    {"tilt it less": {"tilt_deg": 5.0}, "fly lower": {"agl_m": 1e4}},
)
planned(
    "layout/parallels.py",
    "rows from {} m cannot be placed so that their images cover this area; tilt the camera less, fly lower or take a "
    "smaller area",
    Mission(Box(84, 0, 83, 1), 1e5, yaw_deg=180.0, tilt_deg=60.0),
    {
        "tilt the camera less": {"tilt_deg": 5.0},
        "fly lower": {"agl_m": 1e4},
        "take a smaller area": {"area": Box(83.1, 0, 83, 1)},
    },
)
planned(
    "layout/parallels.py",
    "rows from {} m cannot be placed so that their images cover this area; fly lower or take a smaller area",
    Mission(Box(84.9, 0, 0, 1), 8e5),
    {"fly lower": {"agl_m": 1e5}, "take a smaller area": {"area": Box(50, 0, 0, 1)}},
)
planned(
    "layout/parallels.py",
    "rows from {} m cannot be placed so near to a pole; fly lower or farther from it",
    Mission(Box(84.9, 0, 84.4, 1), 2e6),
    {"fly lower": {"agl_m": 3e4}, "farther from it": {"area": Box(50, 0, 49.5, 1)}},
)
planned(
    "plan.py",
    "wind of {} m/s at {} m: the gusts throw the camera to the ground; fly higher or in less turbulence",
    Mission(SMALL, 3.0, wind=Wind(14.0, 250.0, 0.9), accept_error=True),
    {"fly higher": {"agl_m": 300.0}, "in less turbulence": {"wind": Wind(3.0, 250.0, 0.05)}},
)
planned(
    "layout/rotated.py",
    "{}: the layout {} is north-up; use --layout cover",
    TURNED.replace(layout="paper"),
    {"use --layout cover": {"layout": "cover"}},
)
planned(
    "layout/rotated.py",
    "camera with tilt {}, roll {} deg from {} m: sees past the horizon, where turned rows have no "
    "frames; tilt it less, "
    "fly lower or fly north-up rows",
    Mission(SMALL, 1e6, camera=Camera(60.0, 1.0), tilt_deg=40.0, row_azimuth_deg=127.0),
    {
        "tilt it less": {"tilt_deg": 5.0},
        "fly lower": {"agl_m": 1e4},
        "fly north-up rows": {"row_azimuth_deg": 90.0},
    },
)
planned(
    "layout/rotated.py",
    "camera with tilt {}, roll {} deg from {} m: sees past the horizon, where rows flown to and fro have no frames "
    "that face their track; tilt it less or fly lower",
    Mission(SMALL, 1e6, camera=Camera(60.0, 1.0), tilt_deg=40.0, facing="track"),
    {"tilt it less": {"tilt_deg": 5.0}, "fly lower": {"agl_m": 1e4}},
)


@remedy("mission/layout/paper.py", "{}: the layout {} does not support it; use --layout cover")
def _more_than_paper_has(case: Case) -> None:
    facing, margin = (
        Mission(AREA, 120.0, layout="paper", **asked) for asked in ({"facing": "track"}, {"margin_m": 20.0})
    )
    case.refused(partial(plan, facing, GRID))
    case.follow("use --layout cover", partial(plan, facing.replace(layout="cover"), GRID))
    assert len(plan(margin.replace(layout="cover"), GRID)) > 0


@remedy("mission/flight/alignment.py", "rows to be aligned: the layout {} is north-up; use --layout cover")
def _aligned_on_paper(case: Case) -> None:
    mission = Mission(AREA, 120.0, layout="paper")
    case.refused(partial(align_rows, mission, GRID))
    case.follow("use --layout cover", partial(align_rows, mission.replace(layout="cover"), GRID, way=LONGEST_SIDE))


planned(
    "layout/rotated.py",
    "camera from {} m: sees past the horizon, where turned rows have no frames; fly lower or fly north-up rows",
    Mission(SMALL, 2e6, camera=Camera(100.0, 1.0), row_azimuth_deg=127.0),
    {"fly lower": {"agl_m": 1e5}, "fly north-up rows": {"row_azimuth_deg": 90.0}},
)
planned(
    "layout/rotated.py",
    "row azimuth {} deg: turned rows hold to {} km from the area's middle, and the area or its images "
    "reach {} km; take a "
    "smaller area or north-up rows",
    Mission(Box(50, 0, 30, 30), 1e5, row_azimuth_deg=127.0),
    {"take a smaller area": {"area": Box(41, 10, 40, 11)}, "north-up rows": {"row_azimuth_deg": 90.0}},
)


def level(lat, agl):
    return Poses.level(*(np.array([value]) for value in (lat, 0.0, agl)))


@remedy(
    "geodesy/frames.py",
    "height {} m with a field of view of {} deg: the image reaches past the Earth's horizon; fly lower "
    "or narrow the "
    "field of view",
)
def _past_the_horizon(case: Case) -> None:
    def frames(agl, fov):
        return map_windows(Camera(fov, 4 / 3), level(0.0, agl), GRID, 2)

    case.refused(partial(frames, 8e6, 78.8))
    case.follow("fly lower", partial(frames, 8e5, 78.8))
    case.follow("narrow the field of view", partial(frames, 8e6, 20.0))


@remedy(
    "geodesy/mercator.py",
    "image at latitude {} from {} m: it holds a pole, which Web Mercator does not; fly lower or farther from the pole",
)
def _holds_a_pole(case: Case) -> None:
    def frames(lat, agl):
        return map_windows(Camera(78.8, 4 / 3), level(lat, agl), GRID, 2)

    case.refused(partial(frames, 89.9, 1e5))
    case.follow("fly lower", partial(frames, 89.9, 1e3))
    case.follow("farther from the pole", partial(frames, 80.0, 1e5))


@remedy(
    "geodesy/footprint.py",
    "camera at height {} m, yaw {}, tilt {}, roll {} deg: no ray of its image meets the Earth; tilt it down",
)
def _sees_the_sky(case: Case) -> None:
    case.refused(lambda: outline(Camera(20.0, 1.0), 35.0, 120.0, (0.0, 120.0, 0.0)))
    case.follow("tilt it down", lambda: outline(Camera(20.0, 1.0), 35.0, 120.0, (0.0, 60.0, 0.0)))


@remedy(
    "geodesy/lens.py",
    "sensor {} by {} mm and an image of {} to 1: pixels would not be square; give the part of the "
    "sensor that the image "
    "shows",
)
def _not_square(case: Case) -> None:
    case.refused(lambda: Camera.from_sensor((13.2, 8.8), 8.8, 16 / 9))
    case.follow(
        "give the part of the sensor that the image shows",
        lambda: Camera.from_sensor((13.2, 13.2 * 9 / 16), 8.8, 16 / 9),
    )


@remedy(
    "geodesy/lens.py",
    "field of view across the diagonal {} deg: must be between 0 and 180, both excluded; choose a less "
    "extreme field of "
    "view or aspect ratio",
)
def _too_wide(case: Case) -> None:
    case.refused(lambda: Camera.from_vertical_fov(179.999999999, 1e9))
    case.follow("choose a less extreme field of view", lambda: Camera.from_vertical_fov(60.0, 1e5))
    case.follow("aspect ratio", lambda: Camera.from_vertical_fov(179.9, 2.0))


@remedy(
    "geodesy/distortion.py",
    "lens distortion: folds the image at {} focal lengths from the principal point, and its farthest corner is at {}; "
    "choose a smaller field of view, or coefficients that hold in the whole image",
)
def _folds(case: Case) -> None:
    case.refused(lambda: Camera(80.0, k1=-0.5))
    case.follow("choose a smaller field of view", lambda: Camera(40.0, k1=-0.5))
    case.follow("coefficients that hold in the whole image", lambda: Camera(80.0, k1=-0.5, k2=0.3))


@remedy(
    "mission/mission.py",
    "undistorted images: the lens does not distort, so they would be the images themselves; "
    "choose a lens with distortion, or leave them out",
)
def _is_ideal(case: Case) -> None:
    ideal = at(35.0, 120.0)
    case.refused(lambda: ideal.replace(keep_undistorted=True))
    case.follow(
        "choose a lens with distortion", lambda: ideal.replace(keep_undistorted=True, camera=Camera(60.0, k1=-0.2))
    )
    case.follow("leave them out", lambda: ideal.replace(keep_undistorted=False))


@remedy(
    "geodesy/distortion.py",
    "fisheye: its image reaches {} focal lengths from the principal point, where a ray is more than {} deg off the "
    "axis ({} focal lengths); choose a smaller field of view",
)
def _beside(case: Case) -> None:
    case.refused(lambda: Camera(179.9, lens="fisheye", k1=-0.01))
    case.follow("choose a smaller field of view", lambda: Camera(170.0, lens="fisheye", k1=-0.01))


planned(
    "plan.py",
    "imagery {}: a mission of several imageries needs a plan for each of them; choose one of them as the source",
    Mission(SMALL, 120.0, imageries=("a=world",)),
    {"choose one of them as the source": {"imageries": (), "source": "world"}},
)


TWO = Polygons(
    tuple(
        Polygon((((west, 35.0), (west + 0.002, 35.0), (west + 0.002, 35.002), (west, 35.002)),))
        for west in (-89.0, -88.99)
    )
)
planned(
    "layout/polygons.py",
    "layout {}: lays one grid over one polygon, and there are {}; use --layout cover",
    Mission(TWO, 120.0, layout="paper"),
    {"use --layout cover": {"layout": "cover"}},
)
planned(
    "layout/no_fly.py",
    "all {} images lie over no-fly areas; choose another area, or smaller no-fly areas",
    Mission(TWO.parts[0], 120.0, no_fly=(TWO.parts[0],), overlap_along=0.2),
    {
        "choose another area": {"area": TWO.parts[1]},
        "smaller no-fly areas": {"no_fly": (Polygon((((-89.0, 35.0), (-88.9999, 35.0), (-88.9999, 35.0001)),)),)},
    },
)


@remedy("geodesy/ways.py", "{}: lies inside a no-fly area; move it outside")
def _inside_no_fly(case: Case) -> None:
    square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    end = np.array([20.0, 5.0])
    case.refused(lambda: way_around(np.array([5.0, 5.0]), end, [[square]]))
    case.follow("move it outside", lambda: way_around(np.array([-5.0, 5.0]), end, [[square]]))


@remedy(
    "geodesy/ways.py",
    "no way leads around the no-fly areas; leave room between them, or keep less distance",
)
def _no_way(case: Case) -> None:
    def around(opening, clearance):
        walls = [(0, 0, 30, 5), (0, 25, 30, 30), (0, 5, 5, 25), (25, 5, 30, 15 - opening / 2)]
        walls.append((25, 15 + opening / 2, 30, 25))
        rings = [[np.array([[w, s], [e, s], [e, n], [w, n]], np.float64)] for w, s, e, n in walls]
        way_around(np.array([15.0, 15.0]), np.array([50.0, 15.0]), rings, clearance)

    case.refused(lambda: around(2.0, 2.0))
    case.follow("leave room between them", lambda: around(6.0, 2.0))
    case.follow("keep less distance", lambda: around(2.0, 0.5))


@remedy(
    "geodesy/view.py",
    "image of {} x {} px: shows more than {} tiles of the source, which are allowed for one; fly lower, or choose a "
    "source that has lower zooms",
)
def _tiles_of_one(case: Case) -> None:
    def counted(agl_m: float, zoom: int) -> int:
        grid = PixelGrid(min_zoom=zoom, native_zoom=14, max_zoom=14)
        return plan(at(40.0, agl_m, frame="camera", image_px=64), grid).requests

    case.refused(partial(counted, 1e6, 14))
    case.follow("fly lower", partial(counted, 1e4, 14))
    case.follow("choose a source that has lower zooms", partial(counted, 1e6, 0))
