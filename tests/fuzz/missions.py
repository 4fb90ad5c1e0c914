"""What is asked for: missions, their places, options and configurations."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.areas.coords import parse_coords, parse_points
from terrainav.core.mission.areas.files import load_area
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.options import OPTIONS
from terrainav.core.mission.plan import plan
from terrainav.core.mission.relief.ground import Heights
from terrainav.core.mission.settings import build_mission, resolve

from tests.fuzz.support import Target, altered, any_of, as_json, as_text, mutated
from tests.support.missions import whole_file

BOX = Mission(Box(35.16, -89.90, 35.155, -89.895), 120.0)
LIST = Mission(Points(((35.1, -89.8, 120.0), (-33.0, 151.0, 60.0)), (5.0, -5.0)), 120.0, Camera(60.0, 1.5), zoom=18)
TRIANGLE = Polygon((((-89.90, 35.16), (-89.895, 35.16), (-89.895, 35.155)),))
TILTED = Mission(TRIANGLE, 120.0, tilt_deg=20.0, wind=Wind(5.0, 90.0, 0.2), accept_error=True, img_size=(64, 48, 3))
TURNED = Mission(BOX.area, 120.0, row_azimuth_deg=120.0, crosshatch=True, gsd_m_per_px=0.5, max_px=640)
OVER_RELIEF = Mission(
    BOX.area,
    300.0,
    elevation=("12.5",),
    tilt_deg=20.0,
    climb_m_per_s=3.0,
    clearance_m=20.0,
    clearance_distance_m=50.0,
    image_px=64,
    products=("depth",),
)
DOCUMENTS = tuple(map(whole_file, (BOX, LIST, TILTED, TURNED, OVER_RELIEF)))
# Few, so that what is found is about values, and not about the number of images.
MOST_IMAGES = 200
#: Pixels of camera frames whose tiles are counted, which takes up to about a second a megapixel.
MOST_TRACED_PX = 2e6
#: The same over relief, where each ray is followed; how high that is, and its cells along a side.
MOST_OVER_RELIEF_PX, BUMPS_M, MOST_CELLS = 1e5, 30.0, 64
GRIDS = (PixelGrid(), PixelGrid(512, 2, 19, 17), PixelGrid(max_size_px=640, centre_decimals=6))
COORDS = ("35.16_-89.90_120", "35.16_-89.90_35.155_-89.895_120", "35.1 -89.8 120\n35.2 -89.7 120 5\n# no\n")
RING = [[-89.90, 35.16], [-89.895, 35.16], [-89.895, 35.155], [-89.90, 35.16]]
AREAS = (
    {"type": "Polygon", "coordinates": [RING]},
    {"type": "MultiPolygon", "coordinates": [[RING]]},
    {
        "type": "FeatureCollection",
        "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [RING]}}],
    },
)
CONFIG = {
    "coords": "35.16_-89.90_35.155_-89.895_120",
    "fov": 78.8,
    "aspect-ratio": [4, 3],
    "overlap": [0.1, 0.2],
    "map_type": ["satellite"],
    "img_size": "64 48 3",
    "zoom": 18,
    "wind": [5, 90, 0.2],
    "crosshatch": "yes",
    "max_images": 100,
    "camera": None,
    "date": "2024-06-21",
    "start": "2024-06-21T10:30:00Z",
}


class Bumps:
    """Relief everywhere, of few cells: heights up to so many metres, and a hole or two."""

    title, attribution = "bumps", ""

    def __init__(self, high_m: float) -> None:
        self._high_m = high_m

    def surface(self, lat_deg: Any, lon_deg: Any, cell_m: float = 0.0) -> Surface:
        """Heights about positions, of at most some forty cells a side."""
        grid = PixelGrid()
        u, v = grid.plane.forward(np.clip(lat_deg, -85.0, 85.0), np.asarray(lon_deg))
        span = max(float(np.ptp(u)), float(np.ptp(v)), 2.0**-30)
        zoom = int(np.clip(np.floor(np.log2(32.0 / span / 256.0)), 0, 22))
        world = grid.world_px(zoom)
        left, top = int(u.min() * world) - 2, int(v.min() * world) - 2
        i, j = np.indices([min(int(np.ptp(at) * world) + 6, MOST_CELLS) for at in (v, u)])
        heights = self._high_m * ((7 * i + 13 * j) % 5) / 4.0
        return Surface(grid, zoom, left, top, np.where((i * j) % 97 == 96, np.nan, heights).astype(np.float32))

    def end_m(self, lat_deg: float, lon_deg: float) -> float:
        """Distance beyond which there is no ground."""
        return np.inf

    def cell_m(self, lat_deg: float, lon_deg: float) -> float:
        """Size of a cell near the camera."""
        return 10.0


def work_out(mission: Mission, grids: Iterable[PixelGrid] = GRIDS) -> None:
    """All that the command and the panel say of a mission."""
    assert Mission.from_json(mission.to_json()) == mission

    def on(grid: PixelGrid) -> None:
        heights = None
        if mission.terrain.elevation:
            heights = Heights(Bumps(BUMPS_M), Bumps(BUMPS_M))
        few = mission.replace(max_images=min(mission.output.max_images, MOST_IMAGES))
        worked_out = plan(few, grid, heights)
        if not worked_out.relief.is_level and not worked_out.frames.on_map:
            if math.prod(worked_out.frames.largest_px) <= MOST_OVER_RELIEF_PX:
                worked_out.views.view(0)
            worked_out.views.outline(0)
            worked_out.relief.figures(worked_out.cameras, worked_out.poses, worked_out.flown, worked_out.corners)
        elif worked_out.frames.on_map or worked_out.frames.width_px @ worked_out.frames.height_px <= MOST_TRACED_PX:
            estimate(worked_out).lines()

    any_of(partial(on, grid) for grid in grids)


def mission_file(data: bytes) -> None:
    path = Path("mission.json")
    path.write_bytes(data)
    work_out(Mission.load(path))


def mission_document(document: Any) -> None:
    """As the panel has it from a project, without a text between."""
    if isinstance(document, dict):
        work_out(Mission.from_dict(document))


def coordinates(data: bytes) -> None:
    def of(kind: str | None) -> None:
        area, agl_m = parse_coords(as_text(data), kind, "ft")
        work_out(Mission(area, agl_m))

    any_of(partial(of, kind) for kind in (None, "single", "list", "raster"))


@st.composite
def _coordinates(draw: Any) -> bytes:
    """Numbers that may be right, as people write them apart."""
    number = st.floats(-200.0, 200.0) | st.integers(-90, 9000) | st.sampled_from((120.0, 1e-9, 1e9, 90, -90, 180))
    numbers = draw(st.lists(number, min_size=3, max_size=5))
    return draw(st.sampled_from(("_", ",", " ", ", "))).join(map(str, numbers)).encode()


def lines(data: bytes) -> None:
    parse_points(as_text(data).splitlines())


def places_file(data: bytes) -> None:
    path = Path("places.txt")
    path.write_bytes(data)
    area, agl_m = parse_coords(str(path))
    work_out(Mission(area, agl_m))


def area_file(data: bytes) -> None:
    path = Path("area.geojson")
    path.write_bytes(data)
    work_out(Mission(load_area(str(path)), 120.0))


def config_file(data: bytes) -> None:
    path = Path("options.json")
    path.write_bytes(data)
    work_out(build_mission(resolve({}, {}, str(path))))


def environment(given: dict[str, str]) -> None:
    values = {f"TERRAINAV_{name.upper()}": value for name, value in given.items()}
    work_out(build_mission(resolve({"coords": COORDS[0]}, values)))


def targets() -> Iterator[Target]:
    documents, numbers = altered(*DOCUMENTS), _extreme()
    texts = st.text(max_size=20) | mutated("0.5", "3 4", "64 48 3", "satellite").map(as_text)
    names = st.sampled_from([option.name for option in OPTIONS if option.name not in ("coords", "area", "source")])
    deep = b'{"a":' * 100_000
    yield Target("mission file", mission_file, documents.map(as_json) | mutated(*map(as_json, DOCUMENTS)), (deep,))
    yield Target("mission", mission_document, documents)
    yield Target("mission of extremes", work_out_extreme, numbers)
    yield Target(
        "coordinates",
        coordinates,
        mutated(*COORDS) | _coordinates(),
        (b"1_2_3\xff", b"35_-89_1e155", b"x" * 300),
    )
    yield Target("lines of points", lines, mutated(*COORDS))
    yield Target("file of places", places_file, mutated(*COORDS))
    twice = as_json({"type": "Polygon", "coordinates": [[*RING, RING[0]]]})
    areas = altered(*AREAS).map(as_json) | mutated(*map(as_json, AREAS))
    yield Target("GeoJSON", area_file, areas, (deep, twice))
    yield Target("config.json", config_file, altered(CONFIG).map(as_json) | mutated(as_json(CONFIG)), (deep,))
    yield Target("environment", environment, st.dictionaries(names, texts, max_size=3))


def _extreme() -> st.SearchStrategy[dict[str, Any]]:
    """Changes to a mission that each may be right, but far from what is flown."""
    any_size = st.floats(-6.0, 9.0).map(lambda exponent: 10.0**exponent)
    number = any_size | st.floats(0.0, 180.0) | st.sampled_from((0.0, 1e-300, 179.99999, 1e9, 1e300))
    angle = st.floats(-360.0, 360.0) | st.sampled_from((0.0, 90.0, 180.0, -90.0, 1e-300))
    return st.fixed_dictionaries(
        {
            "lat": st.floats(-90.0, 90.0) | st.sampled_from((90.0, -90.0, 0.0)),
            "lon": angle,
            "agl": number,
            "grid": st.sampled_from(GRIDS),
        },
        optional={
            "fov": number,
            "ratio": number,
            "yaw_deg": angle,
            "tilt_deg": angle,
            "roll_deg": angle,
            "ground_height_m": st.floats(-12e3, 9e3),
            "overlap_along": st.floats(0.0, 1.0),
            "image_px": st.integers(1, 10**9),
            "max_px": st.integers(1, 10**9),
            "zoom": st.integers(0, 40),
            "gsd_m_per_px": number,
            "frame": st.sampled_from(("auto", "map", "camera")),
            "mesh": st.sampled_from(("auto", "rays")),
            "upsample": st.booleans(),
            "error_budget_px": number,
            "box_deg": number,
            "row_azimuth_deg": angle,
            "crosshatch": st.booleans(),
            "layout": st.sampled_from(("cover", "paper")),
            "elevation": st.just(("12.5",)),
            "height_above": st.sampled_from(("ground", "takeoff", "ellipsoid")),
            "climb_m_per_s": number,
            "clearance_m": number,
            "clearance_distance_m": number,
        },
    )


def work_out_extreme(values: dict[str, Any]) -> None:
    values = dict(values)
    lat, lon, agl, grid = (values.pop(name) for name in ("lat", "lon", "agl", "grid"))
    camera = Camera(values.pop("fov", 78.8), values.pop("ratio", 4 / 3))
    size = values.pop("box_deg", None)
    area = Points(((lat, lon, agl),)) if size is None else Box(lat, lon, lat - size, lon + size)
    work_out(Mission(area, agl, camera, accept_error=True, **values), (grid,))
