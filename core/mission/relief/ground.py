"""The ground below a mission: the interface that plans use, and level ground, which needs no elevation data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, Protocol

import numpy as np

from ...arrays import Floats, NDArray, Numbers
from ...errors import InvalidInput, Message, OptionName
from ...geodesy.camera import Camera, Poses
from ...geodesy.ellipsoid import WGS84, Ellipsoid
from ...geodesy.footprint import Corners, ImagePoints, Outline, exact, ground_corners, image_centres
from ...geodesy.projections import LocalPlane
from ...geodesy.triangles import NO_FACES, FaceModel
from ..layout.rows import Layout
from ..lenses import CaptureCameras
from ..mission import Mission

if TYPE_CHECKING:
    from ...geodesy.raytracing.tracing import ElevationModel


@dataclass(frozen=True)
class Heights:
    """What a mission flies over: the ground that it follows, the surface that cameras see, and buildings on it."""

    ground: ElevationModel
    surface: ElevationModel
    faces: FaceModel = NO_FACES


class Flown(NamedTuple):
    """Captures over relief, arrays (n,).

    Attributes
    ----------
    height_m : array
        Heights of the cameras above the WGS 84 ellipsoid.
    ground_m : array
        Heights of the ground below the cameras.
    seen_agl_m : array
        Heights above the highest ground that the cameras may see. Images show at least as much as from this height
        above level ground.
    """

    height_m: Floats
    ground_m: Floats
    seen_agl_m: Floats


class ReliefFigures(NamedTuple):
    """Figures of a flight over relief.

    Attributes
    ----------
    lowest_m, highest_m : float
        Heights of the ground below captures, above the ellipsoid.
    nearest_m, farthest_m : float
        Least and greatest height of a capture above the ground that its image may show.
    clearance_m : float
        Least height of a capture above everything within the clearance's distance.
    hidden_share : float
        Share of the area's ground that lies inside images, but is hidden by relief in all of them.
    filled : tuple of int
        Numbers of heights around the area: filled by further sources, interpolated, and all.
    """

    lowest_m: float
    highest_m: float
    nearest_m: float
    farthest_m: float
    clearance_m: float
    hidden_share: float
    filled: tuple[int, int, int]


class Profile(NamedTuple):
    """Heights below straight legs, at nodes (m,) in flight order.

    A straight leg that is no lower than `highest_m` at each node is no lower between nodes, either.

    Attributes
    ----------
    leg : array of int64
        Number of the leg.
    share : array
        Position along the leg, 0 to 1.
    lat_deg, lon_deg : array
    highest_m : array
        Greatest height of the surface within the clearance's distance; minus infinity where unknown.
    ground_m : array
        Height of the ground; NaN where unknown.
    surface_m : array
        Height of the surface; NaN where unknown.
    is_middle : array of bool
        Whether the node is the midpoint of its two neighbours, between which the surface below the leg is a parabola.
    """

    leg: Numbers
    share: Floats
    lat_deg: Floats
    lon_deg: Floats
    highest_m: Floats
    ground_m: Floats
    surface_m: Floats
    is_middle: NDArray[np.bool_]


class PathGround(Protocol):
    """The ground below a path, which may lead beyond the captures."""

    def ground_m(self, lat_deg: Floats, lon_deg: Floats, /) -> Floats:
        """Heights of the ground at positions (n,); NaN where unknown."""
        ...

    def highest_m(self, lat_deg: Floats, lon_deg: Floats, /) -> Floats:
        """Greatest height within the clearance's distance of positions (n,); minus infinity where unknown.

        The search reaches a cell farther, so that the clearance also holds between the nodes of a profile.
        """
        ...

    def highest_within_m(self, lat_deg: Floats, lon_deg: Floats, /) -> Floats:
        """Greatest height of the surface at positions (n,) and of its pixels in a square of the clearance's distance.

        Minus infinity where unknown.
        """
        ...

    def profiles(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane, /) -> Iterator[Profile]:
        """Profiles below straight legs from position to position (n,); none over level ground."""
        ...


class Relief(Protocol):
    """The ground below a mission. Heights are in metres above the WGS 84 ellipsoid."""

    @property
    def is_level(self) -> bool:
        """Whether the ground has one height everywhere."""
        ...

    @property
    def lowest_m(self) -> float:
        """Least height near the mission."""
        ...

    @property
    def highest_m(self) -> float:
        """Greatest height near the mission."""
        ...

    @property
    def has_holes(self) -> bool:
        """Whether images may show ground of unknown height."""
        ...

    @property
    def attribution(self) -> str:
        """Credit for the heights."""
        ...

    @property
    def heights(self) -> Heights:
        """Elevation models. Raises InvalidInput for level ground, which has none."""
        ...

    @property
    def heights_m(self) -> NDArray[Any]:
        """Heights of the surface near the mission, (rows, columns); empty for level ground."""
        ...

    @property
    def is_loaded(self) -> bool:
        """Whether the heights are in memory; after unpickling they are not, see `load`."""
        ...

    def load(self, heights: Heights, heights_m: NDArray[Any], /) -> None:
        """Restore the heights, which pickling leaves out."""
        ...

    def text(self) -> str:
        """Description for people; empty for level ground."""
        ...

    def covers(self, lat_deg: Floats, lon_deg: Floats, /) -> bool:
        """Whether the heights around captures (n,) had been read; if not, read them now."""
        ...

    def around(self, lat_deg: Floats, lon_deg: Floats, room_m: float, /) -> PathGround:
        """Ground within ``room_m`` around positions (n,), at the finest resolution."""
        ...

    # --- ground that captures see

    def seen(self, camera: Camera, poses: Poses, height_m: Floats, points: ImagePoints, /) -> tuple[Corners, Floats]:
        """Ground that captures of a camera see at image points (k,), and its heights, (n, k) each."""
        ...

    def corners(self, camera: Camera, poses: Poses, height_m: Floats, /) -> Corners:
        """Ground corners that captures see, (n, 4)."""
        ...

    def image_centres(self, camera: Camera, poses: Poses, height_m: Floats, /) -> tuple[Floats, Floats]:
        """Latitudes and longitudes of the ground in the middle of images, (n,) each; see `footprint.image_centres`."""
        ...

    def outlines(self, camera: Camera, poses: Poses, height_m: Floats, /) -> list[Outline | None]:
        """Outlines of the ground that captures see; None over level ground."""
        ...

    # --- where rows lie

    @property
    def merge_distance_m(self) -> float:
        """Distance below which rows treat positions as one."""
        ...

    @property
    def deepest_m(self) -> float:
        """Greatest height of a capture above the lowest ground that it sees."""
        ...

    def least_seen_agl_m(self, lat_deg: Floats, /) -> Floats:
        """Least height of captures at latitudes (n,) above the highest ground that they see."""
        ...

    def most_seen_agl_m(self, lat_deg: Floats, /) -> Floats:
        """Greatest height of captures at latitudes (n,) above the highest ground that they see."""
        ...

    def seen_agl_m(self, lat_deg: Floats, lon_deg: Floats, /) -> Floats:
        """Least height of captures near positions (n,) above the highest ground that they see; may be NaN.

        Near means within `merge_distance_m`.
        """
        ...

    # --- captures

    def flown(self, layout: Layout, /) -> Flown | None:
        """Heights of captures; None over level ground, where the layout has them.

        Raises
        ------
        InvalidInput
            A capture is too close to the relief.
        """
        ...

    def lone(self, layout: Layout, flown: Flown | None, /) -> Layout:
        """Captures with the heights that determine image sizes; each point as if it were flown alone."""
        ...

    def zoomed(self, layout: Layout, /) -> Layout:
        """Captures with the heights that determine the zoom."""
        ...

    def missed_share(self, cameras: CaptureCameras, poses: Poses, height_m: Floats, corners: Corners, /) -> float:
        """Share of the area's ground outside all images; 0 over level ground, where `coverage` measures it."""
        ...

    def figures(
        self, cameras: CaptureCameras, poses: Poses, flown: Flown | None, corners: Corners, /
    ) -> ReliefFigures | None:
        """Figures of a flight with captures (n,) and image corners (n, 4); None over level ground."""
        ...


@dataclass(frozen=True)
class LevelGround:
    """Ground of one height, a `Relief`.

    Parameters
    ----------
    lowest_m : float
        Height of the ground.
    agl_m : float
        Height of the flight above the ground.
    """

    lowest_m: float
    agl_m: float

    is_level = True
    is_loaded = True
    has_holes = False
    attribution = ""
    merge_distance_m = 0.0

    @property
    def highest_m(self) -> float:
        """Height of the ground."""
        return self.lowest_m

    @property
    def ellipsoid(self) -> Ellipsoid:
        """Ellipsoid through the ground."""
        return WGS84.raised(self.lowest_m) if self.lowest_m else WGS84

    @property
    def heights(self) -> Heights:
        """Raise InvalidInput: level ground has no elevation models."""
        raise InvalidInput("rays over relief: the ground is level")

    @property
    def heights_m(self) -> NDArray[Any]:
        """Empty array."""
        return np.empty((0, 0), np.float32)

    @property
    def deepest_m(self) -> float:
        """Height of the flight."""
        return self.agl_m

    def load(self, heights: Heights, heights_m: NDArray[Any]) -> None:
        """Do nothing."""

    def text(self) -> str:
        """Return an empty text."""
        return ""

    def covers(self, lat_deg: Floats, lon_deg: Floats) -> bool:  # noqa: ARG002  as over relief
        """Return True."""
        return True

    def around(self, lat_deg: Floats, lon_deg: Floats, room_m: float) -> LevelPathGround:  # noqa: ARG002  as over relief
        """Ground below a path."""
        return LevelPathGround(self.lowest_m)

    def seen(
        self,
        camera: Camera,
        poses: Poses,
        height_m: Floats,  # noqa: ARG002  as over relief
        points: ImagePoints,
    ) -> tuple[Corners, Floats]:
        """Ground that captures see at image points (k,), and its height, (n, k)."""
        found = exact(camera, poses, points, self.ellipsoid)
        return found, np.full(found.lat_deg.shape, self.lowest_m)

    def corners(self, camera: Camera, poses: Poses, height_m: Floats) -> Corners:  # noqa: ARG002  as over relief
        """Ground corners that captures see, (n, 4)."""
        return ground_corners(camera, poses, self.ellipsoid)

    def image_centres(self, camera: Camera, poses: Poses, height_m: Floats) -> tuple[Floats, Floats]:  # noqa: ARG002
        """Latitudes and longitudes of the ground in the middle of images, (n,) each."""
        return image_centres(camera, poses, self.ellipsoid)

    def outlines(self, camera: Camera, poses: Poses, height_m: Floats) -> list[Outline | None]:  # noqa: ARG002
        """None for each: outlines over level ground follow from the attitude."""
        return [None] * len(poses.lat_deg)

    def least_seen_agl_m(self, lat_deg: Floats) -> Floats:
        """Height of the flight, (n,)."""
        return np.broadcast_to(np.float64(self.agl_m), lat_deg.shape)

    def most_seen_agl_m(self, lat_deg: Floats) -> Floats:
        """Height of the flight, (n,)."""
        return self.least_seen_agl_m(lat_deg)

    def seen_agl_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:  # noqa: ARG002  as over relief
        """Height of the flight, (n,)."""
        return self.least_seen_agl_m(lat_deg)

    def flown(self, layout: Layout) -> Flown | None:  # noqa: ARG002  as over relief
        """Return None: the layout has the heights."""
        return None

    def lone(self, layout: Layout, flown: Flown | None) -> Layout:  # noqa: ARG002  as over relief
        """Return the captures unchanged."""
        return layout

    def zoomed(self, layout: Layout) -> Layout:
        """Return the captures unchanged."""
        return layout

    def missed_share(
        self,
        cameras: CaptureCameras,  # noqa: ARG002  as over relief
        poses: Poses,  # noqa: ARG002
        height_m: Floats,  # noqa: ARG002
        corners: Corners,  # noqa: ARG002
    ) -> float:
        """Return 0."""
        return 0.0

    def figures(
        self,
        cameras: CaptureCameras,  # noqa: ARG002  as over relief
        poses: Poses,  # noqa: ARG002
        flown: Flown | None,  # noqa: ARG002
        corners: Corners,  # noqa: ARG002
    ) -> ReliefFigures | None:
        """Return None."""
        return None


@dataclass(frozen=True)
class LevelPathGround:
    """Level ground below a path, a `PathGround`."""

    level_m: float

    def ground_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:  # noqa: ARG002  as over relief
        """Height of the ground at positions (n,)."""
        return np.full(len(lat_deg), self.level_m)

    def highest_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:  # noqa: ARG002  as over relief
        """Minus infinity at positions (n,): nothing stands on level ground."""
        return np.full(len(lat_deg), -np.inf)

    def highest_within_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Minus infinity at positions (n,)."""
        return self.highest_m(lat_deg, lon_deg)

    def profiles(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane) -> Iterator[Profile]:  # noqa: ARG002
        """No profiles: legs over level ground are never too low."""
        return iter(())


def level_ground(mission: Mission) -> LevelGround:
    """Level ground at the mission's ground height."""
    return LevelGround(mission.flight.ground_height_m, mission.flight.agl_m)


def refuse_hole(lat_deg: float, lon_deg: float) -> NoReturn:
    """Raise InvalidInput for a position of unknown height."""
    raise InvalidInput(
        "no height at latitude {0:.6f}, longitude {1:.6f}: the elevation ends there, or has a hole",
        lat_deg,
        lon_deg,
        field="elevation",
        remedy=Message(
            "name a further source that fills it{0}, or have holes interpolated{1}",
            OptionName("elevation").in_brackets,
            OptionName("holes").in_brackets,
        ),
    )
