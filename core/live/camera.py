"""A camera that takes a picture from any pose when asked: what every live interface translates."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from ..arrays import Floats, NDArray, PixelValues
from ..bands import Bands
from ..capture.making import check_source
from ..capture.records import PictureJob, develop_picture, image_job
from ..errors import InvalidInput
from ..external.compiling import uses_numba
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.contract import CameraContract
from ..geodesy.view import ImageRays
from ..imagery.source import Part, Source
from ..labels.label_map import LabelMap
from ..mission.areas.area import Points
from ..mission.mission import Mission
from ..mission.parts import ELLIPSOID, LABELLED
from ..mission.plan import Plan, plan
from ..mission.relief.ground import Heights
from ..mission.takes import Facts
from ..picture.camera_frame import parts_of_tiles
from ..picture.map_frame import resized
from ..picture.optics import plan_contract
from ..picture.products import BANDS, products
from ..picture.shot import Shot, draw
from .terms import check_live, may_prefetch
from .tiles import ReadyTiles, TileMemory

#: A band that tells stand-ins from other tiles.
_MARK = Bands(("coarse",), "uint8", (0,))
#: Default number of tiles fetched at once.
CONNECTIONS = 8


class FrameRequest(NamedTuple):
    """What is asked of a camera.

    Attributes
    ----------
    lat_deg, lon_deg : float
        Position of the camera.
    up_m : float
        Height of the camera: above ground, or above the WGS 84 ellipsoid if ``above_ellipsoid``.
    yaw_deg, tilt_deg, roll_deg : float
        As for `Camera.rays_enu`.
    time_s : float
        Time of the pose, Unix seconds; returned with the frame.
    products : tuple of str
        What the frame has beside the picture, such as ``depth``; as a mission names them.
    above_ellipsoid : bool
    """

    lat_deg: float
    lon_deg: float
    up_m: float
    yaw_deg: float = 0.0
    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    time_s: float = 0.0
    products: tuple[str, ...] = ()
    above_ellipsoid: bool = False


@dataclass(frozen=True, eq=False)
class LiveFrame:
    """A picture on request, with all that belongs to its pose.

    Attributes
    ----------
    request : FrameRequest
    plan : Plan
        Plan of the one capture.
    picture : array (h, w, bands)
    products : mapping of str to array
        As `picture.products.products` gives them.
    contract : CameraContract
    job : PictureJob
        The image that a capture would write.
    facts : tuple
        What is stated of the effects of a real camera.
    coarse_share : float
        Share of the pixels that are not at full resolution; 1 if level ground stands in for heights.
    failed_tiles : int
        Tiles that the source lacks, or has with holes, and coarser ones stand in for.
    level_m : float or None
        Height of the level ground that is shown in place of relief whose heights are not there yet.
    sky_share : float
    made_s : float
        Seconds that the frame took.
    """

    request: FrameRequest
    plan: Plan
    picture: PixelValues
    products: Mapping[str, NDArray[Any]]
    contract: CameraContract
    job: PictureJob
    facts: Facts = ()
    coarse_share: float = 0.0
    failed_tiles: int = 0
    level_m: float | None = None
    sky_share: float = 0.0
    made_s: float = field(default=0.0, compare=False)

    @property
    def height_m(self) -> float:
        """Height of the camera above the WGS 84 ellipsoid."""
        return float(self.plan.height_m[0])

    @property
    def per_depth(self) -> Floats:
        """Length of each pixel's ray for each metre of depth along the view, (h, w)."""
        camera, size = self.plan.camera(0), (self.contract.width_px, self.contract.height_px)
        rays = ImageRays.from_scene(ImageGeometry(camera, *size, self.plan.poses, self.plan.ground))
        x_px, y_px = rays.ideal_centres(0, size[1])
        right, down = ((2.0 * at / side - 1.0) * tan for at, side, tan in zip((x_px, y_px), size, camera.half_tangents))
        return np.sqrt(1.0 + right**2 + down**2)

    def to_json(self) -> dict[str, Any]:
        """What the frame is, without its pixels."""
        asked = self.request
        return {
            "time_s": asked.time_s,
            "pose": {
                "lat_deg": asked.lat_deg,
                "lon_deg": asked.lon_deg,
                "height_m": self.height_m,
                "agl_m": self.height_m - float(self.plan.ground_m[0]),
                "yaw_deg": asked.yaw_deg,
                "tilt_deg": asked.tilt_deg,
                "roll_deg": asked.roll_deg,
            },
            "camera": self.contract.intrinsics,
            "footprint": _footprint(self.plan),
            "method": "; ".join(str(one.method.name) for one in self.plan.accuracy.choices),
            # How far the ground is from level is unknown where it stands in.
            "error_bound_px": self.plan.accuracy.bound_px if self.level_m is None else None,
            "level_ground_m": self.level_m,
            "coarse_share": self.coarse_share,
            "failed_tiles": self.failed_tiles,
            "sky_share": self.sky_share,
            "facts": dict(self.facts),
            "made_s": self.made_s,
        }


class Prepared(NamedTuple):
    """A frame before it is drawn: its parts are known, and over relief its rays are traced."""

    request: FrameRequest
    plan: Plan
    job: PictureJob
    shot: Shot
    parts: list[Part]
    begun_s: float
    level_m: float | None = None


def _footprint(plan: Plan) -> list[list[float]]:
    """Longitudes and latitudes of the ground that the image's corners see; those that see none are left out."""
    corners = plan.corners
    places = zip(corners.lon_deg[0].tolist(), corners.lat_deg[0].tolist(), corners.hit[0].tolist())
    return [[lon, lat] for lon, lat, is_seen in places if is_seen]


class LiveCamera:
    """Camera of a mission that takes pictures on request; the mission's area and route do not matter.

    A frame has the pixels that a capture of a mission with this one pose writes. Threads may share the camera.

    Parameters
    ----------
    mission : Mission
    source : Source
        Source of the imagery; stays open.
    heights : Heights or None
        Heights of the mission's elevation, if it has one.
    labels : LabelMap or None
        Labels for the products classes and instances.
    connections : int
        Tiles fetched at once.
    accept_terms : bool
        Whether the user has agreed to the provider's terms.

    Raises
    ------
    InvalidInput
        The source lacks what the mission asks for.
    SourceError
        The provider's terms forbid live frames.
    """

    def __init__(
        self,
        mission: Mission,
        source: Source,
        heights: Heights | None = None,
        labels: LabelMap | None = None,
        connections: int = CONNECTIONS,
        *,
        accept_terms: bool = False,
    ) -> None:
        check_live(source)
        if mission.accuracy.frame == "map":
            raise InvalidInput(
                "frame {0}: a live camera sees perspectives",
                mission.accuracy.frame,
                field="frame",
                remedy="choose camera",
            )
        self.mission = mission.replace(frame="camera", keep_clean=False, keep_undistorted=False)
        self.source, self.heights, self.labels = source, heights, labels
        self.tiles = TileMemory(source, mission.imagery.map_types[0], connections, accept_terms=accept_terms)
        #: Whether tiles may be fetched before a frame needs them.
        self.may_prefetch = may_prefetch(source.policy, accept_terms)
        west, south, east, north = mission.area.bounds.edges_deg
        #: Where a client may begin: in the middle of the mission's area, as its flight and attitude say.
        attitude = mission.attitude
        self.start = FrameRequest(
            (south + north) / 2.0,
            (west + east) / 2.0,
            mission.flight.agl_m,
            attitude.yaw_deg,
            attitude.tilt_deg,
            attitude.roll_deg,
        )
        if uses_numba():
            # Loading it takes half a second, once, and saves milliseconds of each frame.
            import_module("numba")
        first = self.plan(self.start)
        check_source(first, source)
        self.contract = plan_contract(first, 0)

    @property
    def offered(self) -> tuple[str, ...]:
        """Products that frames may have."""
        return (*BANDS, *(LABELLED if self.labels is not None else ()))

    def plan(self, request: FrameRequest, level_m: float | None = None) -> Plan:
        """Plan of the capture from a pose.

        Parameters
        ----------
        level_m : float or None
            Height of level ground in place of the mission's relief.

        Raises
        ------
        InvalidInput
            The pose is invalid, or sees nothing that can be drawn.
        PartError, SourceError
            Heights are not available.
        """
        mission, heights, up_m, more = self.mission, self.heights, request.up_m, {}
        if level_m is not None:
            mission = mission.replace(elevation=(), surface=(), buildings=(), ground_height_m=level_m)
            heights = None
        if request.above_ellipsoid:
            if heights is None:
                up_m -= mission.flight.ground_height_m
            else:
                more = {"height_above": ELLIPSOID}
        mission = mission.replace(
            area=Points(
                ((request.lat_deg, request.lon_deg, up_m),),
                yaws_deg=(request.yaw_deg,),
                tilts_deg=(request.tilt_deg,),
                rolls_deg=(request.roll_deg,),
            ),
            products=tuple(request.products),
            **more,
        )
        return plan(mission, self.source.grid, heights)

    def take(self, request: FrameRequest, wait_s: float | None = None) -> LiveFrame:
        """Take a picture.

        Parameters
        ----------
        wait_s : float or None
            Longest wait for tiles, after which coarser ones stand in for them; None to wait for all.

        Raises
        ------
        InvalidInput
            The pose is invalid.
        PartError, SourceError
            Imagery or heights are not available.
        """
        prepared = self.prepare(request)
        tiles, parts = self.tiles, prepared.parts
        return self.draw(prepared, tiles.whole(parts) if wait_s is None else tiles.until(parts, wait_s))

    def prepare(self, request: FrameRequest, level_m: float | None = None) -> Prepared:
        """Plan a frame and find its tiles; parameters and errors are those of `plan`."""
        begun_s = time.perf_counter()
        planned = self.plan(request, level_m)
        job = image_job(planned, 0, self.source, self.tiles.map_type, Path(), labels=self.labels)
        shot = cast(Shot, job.shot)
        needs_range = job.development is not None and job.development.needs_range
        parts = parts_of_tiles(planned.grid, shot.trace(with_sighting=bool(request.products) or needs_range))
        return Prepared(request, planned, job, shot, parts, begun_s, level_m)

    def draw(self, prepared: Prepared, ready: ReadyTiles) -> LiveFrame:
        """Draw a frame from its tiles."""
        request, planned, job, shot, parts, begun_s, level_m = prepared
        drawn = draw(shot, parts, ready.pixels, masked=job.masked, bands=job.bands)
        picture, _, facts, description = develop_picture(job, drawn.pixels)
        picture = resized(picture, job.img_size, job.bands)
        size = picture.shape[1], picture.shape[0]
        return LiveFrame(
            request,
            planned,
            picture,
            dict(products(planned, 0, size, shot, self.labels)) if request.products else {},
            plan_contract(planned, 0),
            replace(job, description=description),
            facts,
            self._coarse_share(shot, parts, ready) if level_m is None else 1.0,
            len(ready.failed),
            level_m,
            drawn.sky_share,
            time.perf_counter() - begun_s,
        )

    def _coarse_share(self, shot: Shot, parts: Sequence[Part], ready: ReadyTiles) -> float:
        """Share of a picture's pixels that stand-ins show, whole or in part."""
        if not ready.stand_ins:
            return 0.0
        size = self.source.grid.tile_px
        coarse, whole = np.ones((size, size, 1), np.uint8), np.zeros((size, size, 1), np.uint8)
        marks = {window: coarse if window in ready.stand_ins else whole for window in ready.pixels}
        mark = draw(shot, parts, marks, bands=_MARK)
        return float(np.mean(mark.pixels > 0))
