"""The part of a mission that states its relief, and what stands on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...errors import InvalidInput, Message, OptionName
from ...fields import CheckedFields, declared, is_plain
from ...geodesy.vertical import check_vertical

#: Heights of the ground, metres: the deepest ocean trench and Everest, with room for the geoid.
LOWEST_GROUND_M, HIGHEST_GROUND_M = -12_000.0, 9_000.0
#: References of the heights of captures.
GROUND, TAKEOFF, ELLIPSOID = "ground", "takeoff", "ellipsoid"
#: Treatments of holes in the first source of heights.
FILL, INTERPOLATE, REFUSE = "fill", "interpolate", "refuse"


def _check_heights(sources: tuple[Any, ...]) -> None:
    for one in sources:
        if not (one and is_plain(one)):
            raise InvalidInput("heights {0!r}: must be a file, terrarium, world or a number", one, field="elevation")


def _check_buildings(files: tuple[Any, ...]) -> None:
    for one in files:
        if not (one and is_plain(one)):
            raise InvalidInput("buildings {0!r}: must be a file, or FILE:LAYER", one, field="buildings")
    if len(set(files)) != len(files):
        raise InvalidInput("buildings {0}: each file may be named once", ", ".join(files), field="buildings")


def _check_height_field(name: str) -> None:
    if not is_plain(name):
        raise InvalidInput(
            "height field {0!r}: must be the name of a field, without spaces around it",
            name,
            field="building_height_field",
        )


@dataclass(frozen=True)
class Terrain(CheckedFields):
    """Relief of the ground, the buildings on it, and the flight above them."""

    elevation: tuple[str, ...] = declared(
        (),
        title="elevation",
        help="where heights of the ground come from: raster files, terrarium (public tiles), terrarium:SOURCE or "
        "terrain-rgb:SOURCE (tiles so encoded), world, or a number; of several the first that has a height counts; "
        "left out, the ground is level",
        check=_check_heights,
        schema={"items": {"type": "string", "minLength": 1}},
    )
    surface: tuple[str, ...] = declared(
        (),
        title="surface",
        help="heights of what cameras see, with buildings and trees, if that differs from the elevation, which the "
        "flight follows; given like the elevation, which fills its gaps",
        advanced=True,
        check=_check_heights,
        schema={"items": {"type": "string", "minLength": 1}},
    )
    buildings: tuple[str, ...] = declared(
        (),
        title="buildings",
        help="buildings that stand on the relief with walls and roofs: vector files of footprints (GeoJSON, "
        "GeoPackage, OSM …), as FILE or FILE:LAYER, or CityJSON files; over level ground, give its height as the "
        "elevation",
        advanced=True,
        check=_check_buildings,
        schema={"items": {"type": "string", "minLength": 1}, "uniqueItems": True},
    )
    building_height_field: str = declared(
        "",
        title="height field",
        help="field with the heights of buildings, in metres or with a unit; by default height, building:height, "
        "measuredHeight or the like, otherwise levels of 3 m",
        option="height_field",
        advanced=True,
        check=_check_height_field,
    )
    building_height_m: float = declared(
        6.0,
        title="default height",
        help="height of buildings for which the file has no height and no levels",
        unit="m",
        option="building_height",
        above=0.0,
        most=1000.0,
        advanced=True,
    )
    vertical_datum: str = declared(
        "",
        title="vertical datum",
        help="reference of the heights: ellipsoid, EGM96, EGM2008, or the code of a vertical system such as "
        "EPSG:5773; by default the one that the source states, otherwise the ellipsoid",
        advanced=True,
        check=check_vertical,
        schema={"pattern": "^[^\\s]*$"},
    )
    height_unit: str = declared(
        "",
        title="height unit",
        help="unit of the sources of heights; by default the one that they state, otherwise metres",
        choices={"": "As the source says", "m": "Metres", "ft": "Feet", "us-ft": "US survey feet"},
        advanced=True,
    )
    height_offset_m: float = declared(
        0.0,
        title="height offset",
        help="added to the heights of all sources, for example for a datum whose grid is missing",
        unit="m",
        option="height_offset",
        least=-1000.0,
        most=1000.0,
        advanced=True,
    )
    holes: str = declared(
        FILL,
        title="missing heights",
        help="treatment of places in the area where the first source of heights has none: filled from the next source "
        "that has one, and counted; or also interpolated where no source has one, from heights within 100 pixels on "
        "all sides; or refused",
        choices={
            FILL: "Filled from the next source",
            INTERPOLATE: "Interpolated where no source has any",
            REFUSE: "Refused",
        },
        advanced=True,
    )
    height_above: str = declared(
        GROUND,
        title="height above",
        help="over relief, reference of the heights of captures: the ground below each one; the ground at the take-"
        "off (an area's north-western corner, or the first point), for one height of all; or the ellipsoid",
        choices={GROUND: "The ground below", TAKEOFF: "The take-off", ELLIPSOID: "The ellipsoid"},
        advanced=True,
    )
    climb_m_per_s: float | None = declared(
        None,
        title="climb rate",
        help="over relief, maximum rate of climb and descent: the flight is higher where the ground is steeper",
        unit="m/s",
        option="climb",
        above=0.0,
        suggested=3.0,
        advanced=True,
    )
    height_tolerance_m: float = declared(
        0.0,
        title="height tolerance",
        help="over relief, with the trigger by distance, how far flights in files for drones may be above or below the "
        "planned ones, so that rows need fewer waypoints; 0 keeps them no lower than planned, and hardly higher",
        unit="m",
        option="height_tolerance",
        least=0.0,
        most=1000.0,
        advanced=True,
    )
    clearance_m: float = declared(
        0.0,
        title="clearance",
        help="over relief, minimum height above everything within the clearance distance",
        unit="m",
        option="clearance",
        least=0.0,
        most=HIGHEST_GROUND_M,
        advanced=True,
    )
    clearance_distance_m: float = declared(
        0.0,
        title="clearance distance",
        help="radius around each capture within which the clearance is kept",
        unit="m",
        option="clearance_distance",
        least=0.0,
        most=10_000.0,
        advanced=True,
    )

    @property
    def has_buildings(self) -> bool:
        """Whether buildings stand on the relief: those named, or the synthetic world's houses."""
        seen = next(iter((*self.surface, *self.elevation)), "")
        return bool(self.buildings) or seen.lower() == "world"

    def __post_init__(self) -> None:
        """Check every field; refuse a surface, or buildings, without an elevation."""
        super().__post_init__()
        if self.surface and not self.elevation:
            raise InvalidInput(
                "surface {0}: needs an elevation as well, the ground that the flight follows",
                ", ".join(self.surface),
                field="surface",
                remedy=Message("name it as the elevation{0}", OptionName("elevation").in_brackets),
            )
        if self.buildings and not self.elevation:
            raise InvalidInput(
                "buildings {0}: need an elevation, the ground that they stand on",
                ", ".join(self.buildings),
                field="buildings",
                remedy=Message(
                    "name a source of heights, or give the height of level ground in metres{0}",
                    OptionName("elevation").in_brackets,
                ),
            )
