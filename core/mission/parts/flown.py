"""The parts of a mission that say how it is flown: attitude, flight and route."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...errors import InvalidInput, Message, OptionName
from ...fields import CheckedFields, declared
from ...numbers import NUMBER
from ...text.ranges import RANGES, count, ranges_text, read_ranges
from .terrain import HIGHEST_GROUND_M, LOWEST_GROUND_M

if TYPE_CHECKING:
    from datetime import datetime

#: Orders of rows: flown to and fro, or all in the same direction.
SERPENTINE, ONE_WAY = "serpentine", "one-way"
#: Directions of the images' top edge: north, or the flight direction of each row.
NORTH, TRACK = "north", "track"
#: Ways to align rows with their area.
ALIGNMENTS = LONGEST_SIDE, SHORTEST = ("longest-side", "shortest")
#: Azimuth of rows along parallels.
EASTWARD_DEG = 90.0
#: Layouts: rows without gaps, or the UTM grid of the published paper.
COVER, PAPER = "cover", "paper"
#: Greatest height above ground, metres: up to it, float64 resolves the ground to less than a micrometre.
HIGHEST_AGL_M = 1e9
#: Entry into the rows as they are laid out.
FIRST = "first"
#: Entry into the rows at the corner nearest to the take-off.
NEAREST = "nearest"
#: Entries into the rows at a compass corner, with its direction (east, north).
COMPASS_CORNERS = {"north-west": (-1, 1), "north-east": (1, 1), "south-east": (1, -1), "south-west": (-1, -1)}
#: Trigger of the camera at each waypoint, flown through.
BY_WAYPOINT = "waypoint"
#: Trigger of the camera by the distance flown along a row.
BY_DISTANCE = "distance"
#: Trigger of the camera at each waypoint, with a stop.
HOVER = "hover"
#: The drones that are flown with DJI Fly, as target of a file for DJI's programs.
DJI_FLY = "dji-fly"
#: Limit of the sorties of a flight; more indicate an input error.
MOST_SORTIES = 999
#: UTC in ISO 8601, to the second or with up to six decimals.
_UTC = r"[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}(\.[0-9]{1,6})?Z"


def utc_time(text: str) -> datetime:
    """Parse an ISO 8601 text in UTC, such as 2024-06-21T10:30:00Z, as a time in the zone UTC.

    Raises
    ------
    InvalidInput
        Another format, or an impossible date or time.
    """
    from datetime import datetime, timezone

    if re.fullmatch(_UTC, text):
        form = "%Y-%m-%dT%H:%M:%S.%fZ" if "." in text else "%Y-%m-%dT%H:%M:%SZ"
        try:
            return datetime.strptime(text, form).replace(tzinfo=timezone.utc)
        except ValueError as wrong:
            raise InvalidInput("start {0!r}: no such time ({1})", text, wrong, field="start") from wrong
    raise InvalidInput("start {0!r}: must be UTC as 2024-06-21T10:30:00Z", text, field="start")


def _check_start(text: str) -> None:
    utc_time(text)


def _check_facing(text: str) -> None:
    if text in (NORTH, TRACK):
        return
    if re.fullmatch(NUMBER, text) and abs(float(text)) <= 360.0:
        return
    raise InvalidInput(
        "camera faces {0!r}: must be {1}, {2} or an azimuth from -360 to 360",
        text,
        NORTH,
        TRACK,
        field="facing",
    )


def _check_skip_rows(text: str) -> None:
    try:
        read_ranges(text)
    except ValueError as wrong:
        raise InvalidInput(
            "skipped rows {0!r}: must be numbers and ranges such as 3,7-9", text, field="skip_rows"
        ) from wrong


def _check_split_after(text: str) -> None:
    try:
        found = read_ranges(text)
    except ValueError as wrong:
        raise InvalidInput(
            "split after {0!r}: must be numbers of images such as 120,340", text, field="split_after"
        ) from wrong
    splits = count(found)
    if splits >= MOST_SORTIES:
        raise InvalidInput(
            "split after {0:,} images: a flight has at most {1:,} sorties", splits, MOST_SORTIES, field="split_after"
        )


def _check_takeoff(place: tuple[Any, ...] | None) -> None:
    if place is None:
        return
    is_pair = len(place) == 2 and all(type(one) in (int, float) for one in place)
    if not (is_pair and abs(place[0]) <= 90.0 and abs(place[1]) <= 360.0):
        raise InvalidInput(
            "take-off {0}: must be a latitude from -90 to 90 and a longitude from -360 to 360 degrees",
            " ".join(map(str, place)),
            field="takeoff",
        )


@dataclass(frozen=True)
class Attitude(CheckedFields):
    """Attitude of the camera: yaw, then tilt, then roll, as in `Camera.rays_enu`."""

    yaw_deg: float = declared(
        0.0,
        title="yaw",
        help="direction of the image's top edge, clockwise from north, or from grid north of the source's CRS; "
        "images turn with rotated rows, and points may state other yaws",
        unit="deg",
        option="yaw",
        least=-360.0,
        most=360.0,
        advanced=True,
    )
    tilt_deg: float = declared(
        0.0,
        title="tilt",
        help="how far the view is lifted from straight down towards the image's top edge; 90 looks level",
        unit="deg",
        option="tilt",
        least=-180.0,
        most=180.0,
        advanced=True,
    )
    roll_deg: float = declared(
        0.0,
        title="roll",
        help="how far the camera is turned last, after yaw and tilt, about where the image's top edge points: right "
        "side down",
        unit="deg",
        option="roll",
        least=-180.0,
        most=180.0,
        advanced=True,
    )
    random_yaw: bool = declared(
        False,
        title="random yaw",
        help="each image of an area has a yaw at random, by the seed, and rows are as close as that takes; not for "
        "tilted cameras, nor for points, which state their yaws",
        advanced=True,
    )


@dataclass(frozen=True)
class Flight(CheckedFields):
    """How an area is flown: heights, overlaps, rows, speed and time."""

    agl_m: float = declared(
        title="height above ground",
        label="height above gro&und",
        help="height of the captures above ground (AGL); coordinates and points may state other heights",
        unit="m",
        option="agl",
        above=0.0,
        most=HIGHEST_AGL_M,
        suggested=120.0,
    )
    ground_height_m: float = declared(
        0.0,
        title="ground height",
        help="height of the ground above the WGS84 ellipsoid",
        unit="m",
        option="ground_height",
        least=LOWEST_GROUND_M,
        most=HIGHEST_GROUND_M,
        advanced=True,
    )
    overlap_along: float = declared(
        0.0,
        title="front overlap",
        help="share of an image that the next one in its row also shows",
        unit="share",
        least=0.0,
        below=1.0,
        option="overlap",
    )
    overlap_across: float = declared(
        0.0,
        title="side overlap",
        help="share of an image that the next row also shows",
        unit="share",
        least=0.0,
        below=1.0,
        option="overlap",
    )
    layout: str = declared(
        COVER,
        title="layout",
        label="la&yout",
        help="cover: rows without gaps; paper: the UTM grid of the published paper",
        choices={COVER: "Cover (no gaps)", PAPER: "Paper (UTM grid)"},
    )
    row_azimuth_deg: float = declared(
        EASTWARD_DEG,
        title="row azimuth",
        help="direction of an area's rows, clockwise from north: 90 flies them east; not for points",
        unit="deg",
        option="row_azimuth",
        least=0.0,
        most=360.0,
    )
    facing: str = declared(
        NORTH,
        title="camera faces",
        help="direction of the top of the images, to which the yaw is added: north, which turns with rotated rows; "
        "track, the flight direction of each row; or an azimuth in degrees, the same for all images",
        check=_check_facing,
        schema={"pattern": f"^({NORTH}|{TRACK}|{NUMBER})$"},
    )
    crosshatch: bool = declared(
        False,
        title="crosshatch",
        help="fly the area a second time, in rows across the first: about twice as many images",
    )
    order: str = declared(
        SERPENTINE,
        title="order of rows",
        help="serpentine: every other row is flown back; one-way: every row is flown from its beginning",
        choices={SERPENTINE: "Serpentine (to and fro)", ONE_WAY: "One way"},
    )
    margin_m: float = declared(
        0.0,
        title="margin",
        help="width of the ground around an area that is also covered; not for points",
        unit="m",
        option="margin",
        least=0.0,
        most=100_000.0,
    )
    airspeed_m_per_s: float = declared(
        15.0,
        title="airspeed",
        help="speed of the flight through the air",
        unit="m/s",
        option="airspeed",
        # From hovering drift to the speed of sound, where the wind model holds.
        least=0.1,
        most=340.0,
        advanced=True,
    )
    start: str = declared(
        "2000-01-01T00:00:00Z",
        title="start",
        help="capture time of the first image, in UTC as 2024-06-21T10:30:00Z; the clock of the simulated "
        "flight starts then",
        advanced=True,
        check=_check_start,
        schema={"pattern": f"^{_UTC}$"},
    )
    skip_rows: str = declared(
        "",
        title="skipped rows",
        help="rows of an area that are not flown, by their numbers in the names of images, such as 3,7-9: the other "
        "images keep their names; not for points",
        advanced=True,
        check=_check_skip_rows,
        schema={"pattern": f"^{RANGES}$"},
    )

    def __post_init__(self) -> None:
        """Check every field; store a ``facing`` given as a number as text, and equal sets of rows as equal texts."""
        given: Any = self.facing
        if isinstance(given, (int, float)) and not isinstance(given, bool):
            object.__setattr__(self, "facing", f"{given:.15g}")
        super().__post_init__()
        object.__setattr__(self, "skip_rows", ranges_text(read_ranges(self.skip_rows)))

    @property
    def faced_deg(self) -> float | None:
        """Azimuth that the yaw counts from; None where it counts from the track of each row."""
        return None if self.facing == TRACK else 0.0 if self.facing == NORTH else float(self.facing)

    @property
    def alternates_facing(self) -> bool:
        """Whether cameras of every other row face the opposite direction."""
        return self.facing == TRACK and self.order == SERPENTINE


@dataclass(frozen=True)
class Route(CheckedFields):
    """The way to, between and from the rows, and the trigger of the camera."""

    takeoff: tuple[float, float] | None = declared(
        None,
        title="take-off",
        help="latitude and longitude where the flight begins and ends; left out, it goes from the first capture to the "
        "last",
        check=_check_takeoff,
        schema={
            "prefixItems": [
                {"type": "number", "minimum": -90, "maximum": 90},
                {"type": "number", "minimum": -360, "maximum": 360},
            ],
            "items": False,
            "minItems": 2,
        },
        advanced=True,
    )
    entry: str = declared(
        FIRST,
        title="entry",
        help="corner of the rows where the flight begins; for rotated rows the corner nearest to that direction. "
        "first: as the rows are laid out; nearest: the corner nearest to the take-off. Points keep their order",
        choices={
            FIRST: "As laid out",
            "north-west": "North-west",
            "north-east": "North-east",
            "south-east": "South-east",
            "south-west": "South-west",
            NEAREST: "Nearest to take-off",
        },
        advanced=True,
    )
    turnaround_m: float = declared(
        0.0,
        title="turnaround",
        help="distance flown beyond the end of each row before the turn",
        unit="m",
        option="turnaround",
        least=0.0,
        most=10_000.0,
        advanced=True,
    )
    lead_in_m: float = declared(
        0.0,
        title="lead-in",
        help="distance flown on the line of each row before its first capture",
        unit="m",
        option="lead_in",
        least=0.0,
        most=10_000.0,
        advanced=True,
    )
    trigger: str = declared(
        BY_WAYPOINT,
        title="trigger",
        help="waypoint: an image at each waypoint, flown through; distance: the camera is released by the distance "
        "flown along each row; hover: the aircraft stops at each waypoint",
        choices={
            BY_WAYPOINT: "At each waypoint",
            BY_DISTANCE: "By distance along rows",
            HOVER: "Hover and capture",
        },
        advanced=True,
    )
    photo_interval_s: float | None = declared(
        None,
        title="minimum image interval",
        help="shortest time between two images that the camera can sustain",
        unit="s",
        option="photo_interval",
        above=0.0,
        suggested=1.0,
        advanced=True,
    )
    exposure_ms: float | None = declared(
        None,
        title="exposure time",
        help="time that the shutter is open; with the greatest motion blur it limits the speed of the flight",
        unit="ms",
        above=0.0,
        most=10_000.0,
        suggested=1.0,
        advanced=True,
    )
    blur_px: float = declared(
        0.5,
        title="greatest motion blur",
        help="greatest motion of the ground in an image during the exposure time, straight below the camera",
        unit="px",
        above=0.0,
        most=1000.0,
        advanced=True,
    )
    drone: str = declared(
        "mavic-3e",
        title="drone",
        help="drone for DJI files (.kmz); M300 and M350 with the camera P1; dji-fly for drones that use DJI Fly, "
        "such as Mini 4 Pro, Air 3 and Mavic 3",
        choices={
            "mavic-3e": "Mavic 3E",
            "mavic-3t": "Mavic 3T",
            "mavic-3m": "Mavic 3M",
            "m30": "M30",
            "m30t": "M30T",
            "m300": "M300 RTK (P1)",
            "m350": "M350 RTK (P1)",
            "m4e": "M4E",
            "m4t": "M4T",
            DJI_FLY: "DJI Fly (Mini 4 Pro, Air 3, Mavic 3)",
        },
        advanced=True,
    )
    battery_min: float | None = declared(
        None,
        title="battery",
        help="flight time of one battery, without the reserve: the flight is split into sorties that begin and end "
        "at the take-off",
        unit="min",
        option="battery",
        above=0.0,
        suggested=20.0,
        advanced=True,
    )
    split_after: str = declared(
        "",
        title="split after",
        help="numbers of images in flight order, from 1, after which the aircraft lands at the take-off and a new "
        "sortie begins, such as 120,340; each part is split further where the battery requires it",
        advanced=True,
        check=_check_split_after,
        schema={"pattern": f"^{RANGES}$"},
    )

    def __post_init__(self) -> None:
        """Check every field; refuse values that need a take-off point without one."""
        super().__post_init__()
        object.__setattr__(self, "split_after", ranges_text(read_ranges(self.split_after)))
        if self.takeoff is not None:
            object.__setattr__(self, "takeoff", tuple(map(float, self.takeoff)))
        remedy = Message("set a take-off point{0}", OptionName("takeoff").in_brackets)
        if self.takeoff is None and self.entry == NEAREST:
            raise InvalidInput("entry nearest: needs a take-off point to be near to", field="entry", remedy=remedy)
        if self.takeoff is None and self.battery_min is not None:
            raise InvalidInput(
                "battery of {0:g} min: needs a take-off point, where each sortie begins and ends",
                self.battery_min,
                field="battery_min",
                remedy=remedy,
            )
        if self.takeoff is None and self.split_after:
            raise InvalidInput(
                "split after image {0}: needs a take-off point, where each sortie begins and ends",
                self.split_after,
                field="split_after",
                remedy=remedy,
            )
