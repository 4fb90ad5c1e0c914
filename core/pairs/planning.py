"""A cross-view dataset planned before anything is fetched: its missions and parts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput
from ..geodesy.camera import Camera
from ..geodesy.ellipsoid import WGS84, Ellipsoid
from ..geodesy.mercator import PixelGrid
from ..limits import MAX_PICTURE_PX
from ..mission.areas.area import Box, Points
from ..mission.imageries import NamedImagery
from ..mission.mission import Mission
from ..mission.parts import ELLIPSOID, Accuracy, Imagery, Terrain
from ..mission.plan import Plan, plan
from ..mission.relief.ground import Heights, refuse_hole
from .parts import PARTS, SHARES, check_shares, part_places
from .places import PairPlace, cartesian_m, spread_places
from .views import PairView, reach_m, spiral, standing_poses

#: Side of University-1652's images.
DEFAULT_SIZE_PX = 512
#: Side of the largest square images.
MOST_SIZE_PX = math.isqrt(MAX_PICTURE_PX)
#: Camera with the paper's field of view and University-1652's square images.
DEFAULT_CAMERA = Camera(aspect_ratio=1.0)
SATELLITE, DRONE = "satellite", "drone"
#: Decimals of computed heights and distances: 1 mm, as machines differ in the last digit.
_DECIMALS = 3


@dataclass(frozen=True)
class PairSettings:
    """Settings of a cross-view dataset.

    Parameters
    ----------
    views : tuple of PairView
        Drone views of each place, in the order of the images.
    camera : Camera
        Camera of the drone.
    size_px : int
        Longer side of the drone's images, and side of the satellite's.
    satellite_m : float or None
        Width of the satellite view on the ground; None for the width of the widest drone view at the place.
    source, map_type, date, crs
        Imagery, as in `Mission`.
    imageries : tuple of NamedImagery
        Other imagery of ``satellite``, ``drone``, or both.
    seed : int
        Seed of the embedded world, and of the order in which places are assigned to parts.
    shares : three numbers
        Shares of training, test and distractors, relative to their sum.
    gap_m : float
        Least distance between the ground of two parts, >= 0.
    allow_shared_ground : bool
        Assign places one by one, even if parts then share ground.
    terrain : Terrain
        Heights of the ground and of the surface for the drone, as in `Mission`; the satellite view is the map. Heights
        of views count from the ground at the place.
    upsample, ground_height_m, error_budget_px, accept_error, resampling
        As in `Mission`.
    """

    views: tuple[PairView, ...] = field(default_factory=spiral)
    camera: Camera = DEFAULT_CAMERA
    size_px: int = DEFAULT_SIZE_PX
    satellite_m: float | None = None
    source: str = "world"
    map_type: str = Imagery.map_types[0]
    date: str = ""
    crs: str = ""
    imageries: tuple[NamedImagery, ...] = ()
    seed: int = 2024
    shares: tuple[float, float, float] = SHARES
    gap_m: float = 0.0
    allow_shared_ground: bool = False
    upsample: bool = False
    ground_height_m: float = 0.0
    error_budget_px: float = Accuracy.error_budget_px
    accept_error: bool = False
    resampling: str = "bilinear"
    terrain: Terrain = field(default_factory=Terrain)

    def __post_init__(self) -> None:
        if not self.views:
            raise InvalidInput("no views: needs one or more")
        if not 1 <= self.size_px <= MOST_SIZE_PX:
            raise InvalidInput("size of images {0} px: must be from 1 to {1:,}", self.size_px, MOST_SIZE_PX)
        if self.satellite_m is not None and not (math.isfinite(self.satellite_m) and self.satellite_m > 0.0):
            raise InvalidInput("width of the satellite view {0} m: must be above 0", self.satellite_m)
        check_shares(self.shares)
        for one in self.imageries:
            if one.name not in (SATELLITE, DRONE):
                raise InvalidInput(
                    "imagery {0!r}: pairs have views {1} and {2}",
                    one.name,
                    SATELLITE,
                    DRONE,
                    field="imageries",
                )

    def view_imagery(self, view: str) -> NamedImagery:
        """Imagery of ``satellite`` or ``drone``."""
        named = (one for one in self.imageries if one.name == view)
        return next(named, NamedImagery(view, self.source, self.date, self.map_type))

    @property
    def two_imageries(self) -> bool:
        """Whether drone and satellite have different imageries."""
        return replace(self.view_imagery(DRONE), name=SATELLITE) != self.view_imagery(SATELLITE)

    @property
    def satellite_width_m(self) -> float:
        """Width of the satellite view on the ground."""
        if self.satellite_m is not None:
            return self.satellite_m
        slant_m = max(view.agl_m / math.cos(math.radians(view.tilt_deg)) for view in self.views)
        return round(self.camera.ground_size_m(slant_m)[0], _DECIMALS)

    @property
    def image_size_px(self) -> tuple[int, int]:
        """Width and height of the drone's images."""
        aspect = self.camera.aspect_ratio
        width, height = (1.0, 1.0 / aspect) if aspect >= 1.0 else (aspect, 1.0)
        return max(round(self.size_px * width), 1), max(round(self.size_px * height), 1)

    @property
    def ground(self) -> Ellipsoid:
        """Level ground that heights refer to."""
        return WGS84.raised(self.ground_height_m)

    def missions(self, places: Sequence[PairPlace], heights: Heights | None = None) -> dict[str, Mission]:
        """Missions by name: ``satellite``, and ``drone`` or, for several tilts, ``drone_TILT`` of each."""
        lat = np.array([place.lat_deg for place in places])
        lon = np.array([place.lon_deg for place in places])
        tilts = list(dict.fromkeys(view.tilt_deg for view in self.views))
        names = [DRONE] if len(tilts) == 1 else [f"{DRONE}_{tilt:g}" for tilt in tilts]
        ground = None if heights is None else _place_heights(places, heights)
        drones = {name: self._drone(lat, lon, tilt, ground) for name, tilt in zip(names, tilts)}
        return {SATELLITE: self._satellite(lat, lon), **drones}

    def _mission(self, view: str, points: Points, **more: Any) -> Mission:
        imagery = self.view_imagery(view)
        return Mission(
            points,
            points.poses[0][2],
            map_types=(imagery.map_type,),
            source=imagery.source,
            date=imagery.date,
            crs=self.crs,
            seed=self.seed,
            image_format="jpg",
            upsample=self.upsample,
            ground_height_m=self.ground_height_m,
            error_budget_px=self.error_budget_px,
            resampling=self.resampling,
            **more,
        )

    def _satellite(self, lat_deg: Floats, lon_deg: Floats) -> Mission:
        """Square map frames, each as wide as a camera straight above sees it."""
        camera = Camera.from_horizontal_fov(self.camera.horizontal_fov_deg, 1.0)
        agl_m = round(self.satellite_width_m / camera.ground_size_m(1.0)[0], _DECIMALS)
        shrunk = np.cos(np.radians(lat_deg))
        return self._mission(
            SATELLITE,
            Points(tuple((lat, lon, agl_m) for lat, lon in zip(lat_deg.tolist(), lon_deg.tolist()))),
            camera=camera,
            # All latitudes share the zoom nearest to pixels twice as fine as the image's, even at the lowest latitude,
            # so that images are sharp when resized.
            image_px=math.ceil(self.size_px * 2 * float(shrunk.max() / shrunk.min())),
            img_size=(self.size_px, self.size_px, 3),
            frame="map",
            # A satellite sees all ground from above: its view is not meant to resemble a camera's image.
            accept_error=True,
        )

    def _drone(self, lat_deg: Floats, lon_deg: Floats, tilt_deg: float, ground_m: Floats | None) -> Mission:
        """Mission of the views of one tilt; ``ground_m`` (n,) are heights of the places, None for level ground."""
        chosen = [view for view in self.views if view.tilt_deg == tilt_deg]
        ground, above, relief = self.ground, np.zeros(len(lat_deg)), {}
        if ground_m is not None:
            # Stand-offs hardly depend on the height of the ground: by about a millionth for each ten metres.
            ground, above = WGS84.raised(float(np.median(ground_m))), ground_m
            relief = {**vars(self.terrain), "height_above": ELLIPSOID}
        standing = [standing_poses(lat_deg, lon_deg, view, ground) for view in chosen]
        # Ordered by place, then by view.
        where = np.stack(
            [(poses.lat_deg, poses.lon_deg, np.round(poses.agl_m + above, _DECIMALS)) for poses in standing],
            axis=-1,
        )
        return self._mission(
            DRONE,
            Points(
                tuple(map(tuple, where.transpose(1, 2, 0).reshape(-1, 3).tolist())),
                tuple(view.yaw_deg for view in chosen) * len(lat_deg),
            ),
            camera=self.camera,
            tilt_deg=tilt_deg,
            image_px=self.size_px,
            img_size=(*self.image_size_px, 3),
            frame="camera",
            accept_error=self.accept_error,
            **relief,
        )


def places_in_box(
    box: Box, count: int, settings: PairSettings, spacing_m: float | None = None
) -> tuple[PairPlace, ...]:
    """Spread places over a box by the settings' seed.

    Parameters
    ----------
    spacing_m : float or None
        Least distance between places; None for a distance at which no two places share ground.

    Raises
    ------
    InvalidInput
        The box has no room for so many places, or no spacing is given and a view sees the horizon.
    """
    by_views = spacing_m is None
    if spacing_m is None:
        lat = np.array([box.south_deg, box.north_deg, min(max(0.0, box.south_deg), box.north_deg)])
        for one in lat:
            PairPlace(float(one), box.west_deg)
        # Add a hundredth for the satellite's window, whose edges are rounded to pixels.
        satellite_m = settings.satellite_width_m * math.sqrt(0.5) * 1.01
        farthest_m = max(float(reach_m(lat, settings.views, settings.camera, settings.ground).max()), satellite_m)
        if math.isinf(farthest_m):
            raise InvalidInput(
                "some views see the horizon, so that all places share ground: give --spacing, or tilt less"
            )
        spacing_m = 2.0 * farthest_m + settings.gap_m
    return spread_places(box, count, spacing_m, settings.seed, by_views=by_views)


@dataclass(frozen=True, eq=False)
class PairPlan:
    """Plans of a cross-view dataset: n places with k views each.

    Attributes
    ----------
    plans : mapping of str to Plan
        By name of the mission, the satellite's first.
    parts : tuple of str
        ``train``, ``test`` or ``distractor`` for each place.
    ground_shared : bool
        Whether two parts may show the same ground.
    reach_m : float
        Greatest distance of a place from the ground in its images.
    """

    settings: PairSettings
    places: tuple[PairPlace, ...]
    plans: Mapping[str, Plan]
    parts: tuple[str, ...]
    ground_shared: bool
    reach_m: float

    @cached_property
    def ids(self) -> tuple[str, ...]:
        """Names of the places' folders: four digits, or more for more than 10,000 places."""
        digits = max(4, len(str(len(self.parts) - 1)))
        return tuple(f"{index:0{digits}d}" for index in range(len(self.parts)))

    @property
    def images(self) -> int:
        """Number of images."""
        return sum(len(one) for one in self.plans.values())

    @property
    def requests(self) -> int:
        """Number of parts to fetch; parts of both satellite and drone count twice."""
        return sum(one.requests for one in self.plans.values())

    def count_requests(self, view: str) -> int:
        """Number of parts to fetch for ``satellite`` or ``drone``."""
        return sum(one.requests for name, one in self.plans.items() if (name == SATELLITE) == (view == SATELLITE))

    @property
    def bounds_deg(self) -> tuple[float, float, float, float]:
        """West, south, east, north of the places."""
        return Points(tuple((place.lat_deg, place.lon_deg, 1.0) for place in self.places)).bounds.edges_deg

    @property
    def counts(self) -> dict[str, int]:
        """Number of places in each part."""
        return {part: self.parts.count(part) for part in PARTS}

    def shots(self, place: int) -> list[tuple[str, int]]:
        """Mission and index in its plan of each view of a place, in the order of ``settings.views``."""
        tilts: dict[float, str] = {
            one.mission.attitude.tilt_deg: name for name, one in self.plans.items() if name != SATELLITE
        }
        counts = dict.fromkeys(tilts.values(), 0)
        found = []
        for view in self.settings.views:
            name = tilts[view.tilt_deg]
            found.append((name, place * (len(self.plans[name]) // len(self.parts)) + counts[name]))
            counts[name] += 1
        return found

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping; equal settings give equal mappings."""
        settings = self.settings
        left_out = ("agl_m", "tilt_deg", "image_px", "max_px", "frame")
        drone = self.plans[self.shots(0)[0][0]].mission.to_dict()
        shared = {
            part: {name: value for name, value in values.items() if name not in left_out}
            for part, values in drone.items()
            if part not in ("schema", "area")
        }
        return {
            "schema": 1,
            "layout": "University-1652",
            "parts": {
                "shares": list(settings.shares),
                "places": self.counts,
                "gap_m": settings.gap_m,
                "ground_shared": self.ground_shared,
                "reach_m": round(self.reach_m, 1) if math.isfinite(self.reach_m) else None,
            },
            **({"imageries": [str(one) for one in settings.imageries]} if settings.imageries else {}),
            "size_px": settings.size_px,
            "satellite_m": settings.satellite_width_m,
            "mission": {part: values for part, values in shared.items() if values},
            "missions": {name: f"captures/{name}/mission.json" for name in self.plans},
            "views": [
                {"agl_m": view.agl_m, "yaw_deg": view.yaw_deg, "tilt_deg": view.tilt_deg} for view in settings.views
            ],
            "places": [
                {
                    "id": one,
                    "lat_deg": place.lat_deg,
                    "lon_deg": place.lon_deg,
                    "name": place.name,
                    "part": part,
                }
                for one, place, part in zip(self.ids, self.places, self.parts)
            ],
        }


def plan_pairs(
    places: Sequence[PairPlace],
    settings: PairSettings,
    grid: PixelGrid,
    heights: Heights | None = None,
    *,
    drone_grid: PixelGrid | None = None,
) -> PairPlan:
    """Plan a cross-view dataset; fetches no imagery.

    Parameters
    ----------
    places : sequence of PairPlace
        In the order of their ids.
    grid, drone_grid : PixelGrid
        Pixel grids of the satellite's imagery, and of the drone's if it differs.
    heights : Heights or None
        Heights of the settings' terrain (`picture.heights.terrain_heights`); None if it is level.

    Raises
    ------
    InvalidInput
        There are no places, a mission cannot be planned, or a part would be empty.
    """
    if not places:
        raise InvalidInput("no places: needs one or more")
    missions = settings.missions(places, heights)
    plans = {
        name: plan(
            mission,
            grid if name == SATELLITE else drone_grid or grid,
            heights if mission.terrain.elevation else None,
        )
        for name, mission in missions.items()
    }
    lat = np.array([place.lat_deg for place in places])
    seen_m = reach_m(lat, settings.views, settings.camera, settings.ground)
    for one in plans.values():
        if not one.relief.is_level:
            seen_m = np.maximum(seen_m, _relief_reach_m(one, places))
    farthest_m = np.maximum(seen_m, _window_reach_m(plans[SATELLITE]))
    parts = part_places(
        places,
        settings.shares,
        settings.seed,
        farthest_m,
        gap_m=settings.gap_m,
        allow_shared_ground=settings.allow_shared_ground,
    )
    return PairPlan(settings, tuple(places), plans, parts.part, parts.ground_shared, float(farthest_m.max()))


def _place_heights(places: Sequence[PairPlace], heights: Heights) -> Floats:
    """Heights (n,) of the ground at places, each from the finest cells around it."""
    found = np.empty(len(places))
    for index, place in enumerate(places):
        at = np.array([place.lat_deg]), np.array([place.lon_deg])
        surface = heights.ground.surface(*at)
        found[index] = surface.heights(*surface.position(*at))[0]
        if math.isnan(found[index]):
            refuse_hole(place.lat_deg, place.lon_deg)
    return found


def _relief_reach_m(drone: Plan, places: Sequence[PairPlace]) -> Floats:
    """Greatest distance (n,) of each place from the ground at the edges of its images over relief; metres."""
    along = np.linspace(-1.0, 1.0, 9)
    edge = [(x, y) for x in along for y in along if max(abs(x), abs(y)) == 1.0]
    each = len(drone) // len(places)
    found = np.empty(len(places))
    for index, place in enumerate(places):
        part = slice(index * each, (index + 1) * each)
        seen, _ = drone.relief.seen(drone.mission.camera, drone.poses.take(part), drone.height_m[part], tuple(edge))
        middle = cartesian_m(np.array(place.lat_deg), np.array(place.lon_deg))
        distance = np.sqrt(np.sum((cartesian_m(seen.lat_deg, seen.lon_deg) - middle) ** 2, axis=-1))
        # Between the nine points of an edge, relief may reach a little farther.
        found[index] = np.where(seen.hit, distance * 1.05, np.inf).max()
    return found


def _window_reach_m(satellite: Plan) -> Floats:
    """Distance (n,) from each place to the farthest corner of its satellite view."""
    world = satellite.grid.world_px(satellite.zoom)
    left, top, right, bottom = (np.asarray(edge, np.float64) / world for edge in satellite.windows.bounds_px)
    middle = cartesian_m(satellite.lat_deg, satellite.lon_deg)
    corners = [cartesian_m(*satellite.grid.plane.inverse(u, v)) for u in (left, right) for v in (top, bottom)]
    distances = [np.sqrt(np.sum((corner - middle) ** 2, axis=-1)) for corner in corners]
    farthest: Floats = np.max(distances, axis=0)
    return farthest
