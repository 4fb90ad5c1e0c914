"""The ground below a mission, as a plan asks for it; and level ground, which answers without any heights."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, Protocol

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats, Numbers
from ...errors import InvalidInput, Message, OptionName
from ...geodesy.camera import Camera, Poses
from ...geodesy.ellipsoid import WGS84, Ellipsoid
from ...geodesy.footprint import Corners, ImagePoints, Outline, exact, ground_corners, image_centres
from ...geodesy.projections import LocalPlane
from ..layout.rows import Layout
from ..mission import Mission

if TYPE_CHECKING:
    from ...geodesy.raytracing.tracing import ElevationModel


@dataclass(frozen=True)
class Heights:
    """Relief that a mission is flown over: the ground that it follows, and the surface that its cameras see."""

    ground: ElevationModel
    surface: ElevationModel


class Flown(NamedTuple):
    """Captures over relief, arrays (n,).

    Attributes
    ----------
    height_m : array
        Of the cameras over the WGS 84 ellipsoid.
    ground_m : array
        Of the ground below them.
    seen_agl_m : array
        Over the highest of what they may see: their images show at least as much as they would from there.
    """

    height_m: Floats
    ground_m: Floats
    seen_agl_m: Floats


class ReliefFigures(NamedTuple):
    """A flight over relief in figures, metres.

    Attributes
    ----------
    lowest_m, highest_m : float
        Of the ground below captures, over the ellipsoid.
    nearest_m, farthest_m : float
        From a capture down to the highest and to the lowest that its image may show.
    clearance_m : float
        Least height of a capture over everything within the clearance's distance.
    hidden_share : float
        Of the area's ground: images hold it, but relief in front of it hides it from all of them.
    filled : tuple of int
        Heights about the area that further sources have filled, those that are interpolated, and all there are.
    """

    lowest_m: float
    highest_m: float
    nearest_m: float
    farthest_m: float
    clearance_m: float
    hidden_share: float
    filled: tuple[int, int, int]


class Profile(NamedTuple):
    """What lies below straight legs, at nodes (m,) in their order.

    A leg that is as high as this at each node is so between them, too.

    Attributes
    ----------
    leg : array of int64
        Number of the leg.
    share : array
        Where on the leg, 0 to 1.
    lat_deg, lon_deg : array
    highest_m : array
        Of the surface there, or within the clearance's distance; minus infinity where there is none.
    ground_m : array
        Of the ground; NaN where there is none.
    """

    leg: Numbers
    share: Floats
    lat_deg: Floats
    lon_deg: Floats
    highest_m: Floats
    ground_m: Floats


class PathGround(Protocol):
    """The ground below a path, which leads beyond the captures."""

    def ground_m(self, lat_deg: Floats, lon_deg: Floats, /) -> Floats:
        """Heights of the ground at positions (n,); NaN where there is none."""
        ...

    def highest_m(self, lat_deg: Floats, lon_deg: Floats, /) -> Floats:
        """Greatest height within the clearance's distance of positions (n,), minus infinity where there is none.

        It looks a cell farther than that, as places between the nodes of a profile have to keep it, too.
        """
        ...

    def highest_within_m(self, lat_deg: Floats, lon_deg: Floats, /) -> Floats:
        """Greatest height of the surface at positions (n,) and of its pixels within the clearance's distance, a square.

        Minus infinity where there is none.
        """
        ...

    def profiles(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane, /) -> Iterator[Profile]:
        """Profiles below straight legs from position to position (n,); none below level ground's."""
        ...


class Relief(Protocol):
    """The ground below a mission. Heights are over the WGS 84 ellipsoid, metres."""

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
        """Whether images may show places without a height."""
        ...

    @property
    def attribution(self) -> str:
        """Credit for the heights."""
        ...

    @property
    def heights(self) -> Heights:
        """Sources of the heights. Level ground has none, and raises InvalidInput."""
        ...

    @property
    def heights_m(self) -> NDArray[Any]:
        """Heights of the surface near the mission, (rows, columns); empty for level ground."""
        ...

    @property
    def is_loaded(self) -> bool:
        """Whether the heights are here; if not, as after unpickling, `load` them."""
        ...

    def load(self, heights: Heights, heights_m: NDArray[Any], /) -> None:
        """Restore heights that were left out when this was pickled."""
        ...

    def text(self) -> str:
        """Description for people; empty for level ground."""
        ...

    def covers(self, lat_deg: Floats, lon_deg: Floats, /) -> bool:
        """Whether the heights about captures (n,) were known; where not, read them now."""
        ...

    def around(self, lat_deg: Floats, lon_deg: Floats, room_m: float, /) -> PathGround:
        """Ground about positions (n,), and ``room_m`` around them, at its finest."""
        ...

    # --- what captures see

    def seen(self, poses: Poses, height_m: Floats, points: ImagePoints, /) -> tuple[Corners, Floats]:
        """Ground that captures see at image points (k,), and its heights, (n, k)."""
        ...

    def corners(self, poses: Poses, height_m: Floats, /) -> Corners:
        """Ground corners that captures see, (n, 4)."""
        ...

    def image_centres(self, poses: Poses, height_m: Floats, /) -> tuple[Floats, Floats]:
        """Latitudes and longitudes of the ground in the middle of images, (n,) each, see `footprint.image_centres`."""
        ...

    def outlines(self, poses: Poses, height_m: Floats, /) -> list[Outline | None]:
        """Outlines of the ground that captures see; None for those of level ground."""
        ...

    # --- where rows lie

    @property
    def within_m(self) -> float:
        """Distance within which rows treat positions as one."""
        ...

    @property
    def deepest_m(self) -> float:
        """Greatest height of a capture over the lowest ground that it sees."""
        ...

    def least_seen_agl_m(self, lat_deg: Floats, /) -> Floats:
        """Least height of captures at latitudes (n,) over the highest ground that they see."""
        ...

    def most_seen_agl_m(self, lat_deg: Floats, /) -> Floats:
        """Greatest height of captures at latitudes (n,) over the highest ground that they see."""
        ...

    def seen_agl_m(self, lat_deg: Floats, lon_deg: Floats, /) -> Floats:
        """Least height over the highest ground that captures within `within_m` of positions (n,) see; may be NaN."""
        ...

    # --- captures

    def flown(self, layout: Layout, /) -> Flown | None:
        """Heights of captures; None over level ground, where they are those of the layout.

        Raises
        ------
        InvalidInput
            The captures come too near to the relief.
        """
        ...

    def lone(self, layout: Layout, flown: Flown | None, /) -> Layout:
        """Captures with the heights that give their images' sizes: points as if each were flown alone."""
        ...

    def zoomed(self, layout: Layout, /) -> Layout:
        """Captures with the heights that choose their images' zoom."""
        ...

    def missed_share(self, poses: Poses, height_m: Floats, corners: Corners, /) -> float:
        """Share of the area's ground that no image holds, apart from what frames over level ground leave out."""
        ...

    def figures(self, poses: Poses, flown: Flown | None, corners: Corners, /) -> ReliefFigures | None:
        """Figures of a flight by its captures (n,) and the corners of their images (n, 4); None over level ground."""
        ...


@dataclass(frozen=True)
class LevelGround:
    """Ground of one height, a `Relief`.

    Parameters
    ----------
    camera : Camera
    lowest_m : float
        Height of the ground.
    agl_m : float
        Height of the flight above it.
    """

    camera: Camera
    lowest_m: float
    agl_m: float

    is_level = True
    is_loaded = True
    has_holes = False
    attribution = ""
    within_m = 0.0

    @property
    def highest_m(self) -> float:
        """Height of the ground."""
        return self.lowest_m

    @property
    def ellipsoid(self) -> Ellipsoid:
        """The ground."""
        return WGS84.raised(self.lowest_m) if self.lowest_m else WGS84

    @property
    def heights(self) -> Heights:
        """Raise InvalidInput: there are none."""
        raise InvalidInput("rays over relief: the ground is level")

    @property
    def heights_m(self) -> NDArray[Any]:
        """No heights."""
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

    def seen(self, poses: Poses, height_m: Floats, points: ImagePoints) -> tuple[Corners, Floats]:  # noqa: ARG002
        """Ground that captures see at image points (k,), and its height, (n, k)."""
        found = exact(self.camera, poses, points, self.ellipsoid)
        return found, np.full(found.lat_deg.shape, self.lowest_m)

    def corners(self, poses: Poses, height_m: Floats) -> Corners:  # noqa: ARG002  as over relief
        """Ground corners that captures see, (n, 4)."""
        return ground_corners(self.camera, poses, self.ellipsoid)

    def image_centres(self, poses: Poses, height_m: Floats) -> tuple[Floats, Floats]:  # noqa: ARG002
        """Latitudes and longitudes of the ground in the middle of images, (n,) each."""
        return image_centres(self.camera, poses, self.ellipsoid)

    def outlines(self, poses: Poses, height_m: Floats) -> list[Outline | None]:  # noqa: ARG002  as over relief
        """Nothing for each: those of level ground follow from the attitude."""
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
        """Return None: heights are those of the layout."""
        return None

    def lone(self, layout: Layout, flown: Flown | None) -> Layout:  # noqa: ARG002  as over relief
        """Return the captures as they are."""
        return layout

    def zoomed(self, layout: Layout) -> Layout:
        """Return the captures as they are."""
        return layout

    def missed_share(self, poses: Poses, height_m: Floats, corners: Corners) -> float:  # noqa: ARG002
        """Return 0."""
        return 0.0

    def figures(self, poses: Poses, flown: Flown | None, corners: Corners) -> ReliefFigures | None:  # noqa: ARG002
        """Return None."""
        return None


@dataclass(frozen=True)
class LevelPathGround:
    """Level ground below a path, a `PathGround`."""

    level_m: float

    def ground_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:  # noqa: ARG002  as over relief
        """Height of the ground at positions, (n,)."""
        return np.full(len(lat_deg), self.level_m)

    def highest_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:  # noqa: ARG002  as over relief
        """Minus infinity at positions, (n,): nothing stands on level ground."""
        return np.full(len(lat_deg), -np.inf)

    def highest_within_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Minus infinity at positions, (n,)."""
        return self.highest_m(lat_deg, lon_deg)

    def profiles(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane) -> Iterator[Profile]:  # noqa: ARG002
        """Nothing: no leg comes too low over level ground."""
        return iter(())


def level_ground(mission: Mission) -> LevelGround:
    """Level ground of a mission."""
    return LevelGround(mission.camera, mission.flight.ground_height_m, mission.flight.agl_m)


def refuse_hole(lat_deg: float, lon_deg: float) -> NoReturn:
    """Raise InvalidInput for a position without a height."""
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
