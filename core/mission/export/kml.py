"""A plan for Google Earth: KML 2.2."""

from __future__ import annotations

import html
from collections.abc import Iterator

from ...errors import Message
from ..plan import Plan
from .rows import Corners, closed_rings, parts
from .waypoints import Waypoint, flight_line, takeoff_deg, waypoints

#: Most captures whose footprints and waypoints a file holds: 40 MB, about as much as Google Earth opens.
MAX_PLACEMARKS = 50_000

_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"><Document>\n'
    "<name>TerrAInav plan</name>\n"
    '<Style id="footprint"><LineStyle><color>ff00a5ff</color><width>1</width></LineStyle>'
    "<PolyStyle><color>3300a5ff</color></PolyStyle></Style>\n"
    '<Style id="flight"><LineStyle><color>ffffffff</color><width>2</width></LineStyle></Style>\n'
)


def kml_text(plan: Plan) -> Iterator[str]:
    """Text of footprints, waypoints and flight line, in blocks."""
    yield _HEAD
    if len(plan) <= MAX_PLACEMARKS:
        yield "<Folder><name>Footprints</name>\n"
        for part in parts(len(plan)):
            marks = zip(plan.names[part], closed_rings(plan, part))
            yield "".join(_footprint(name, rings) for name, rings in marks)
        yield "</Folder>\n<Folder><name>Waypoints</name>\n"
        yield from (_waypoint(one) for one in waypoints(plan) if one.is_capture)
        yield "</Folder>\n"
    yield "<Folder><name>Flight line</name>\n"
    place = takeoff_deg(plan)
    if place is not None:
        yield (
            f"<Placemark><name>Take-off</name><Point><coordinates>{place[1]},{place[0]}</coordinates>"
            "</Point></Placemark>\n"
        )
    count = plan.path.sorties
    for sortie in range(count):
        yield _line(plan, sortie, "Flight line" if count == 1 else f"Sortie {sortie + 1}")
    yield "</Folder>\n</Document></kml>\n"


def kml_notes(plan: Plan) -> tuple[str, ...]:
    """Notes on what the file leaves out or mixes, one line each."""
    notes = []
    if plan.nominal is not None and plan.mission.wind is None:
        notes.append(
            Message("footprints are those of the random poses, waypoints and flight line are the planned ones")
        )
    elif plan.nominal is not None:
        notes.append(
            Message("footprints are those of the flight in wind, waypoints and flight line are those that were meant")
        )
    if len(plan) > MAX_PLACEMARKS:
        notes.append(
            Message(
                "{0:,} captures are more than Google Earth opens: the file has the flight line alone; footprints and "
                "waypoints come with up to {1:,}",
                len(plan),
                MAX_PLACEMARKS,
            )
        )
    return tuple(notes)


def _footprint(name: str, rings: list[Corners]) -> str:
    polygons = "".join(
        "<Polygon><tessellate>1</tessellate><outerBoundaryIs><LinearRing><coordinates>"
        + " ".join(f"{lon},{lat}" for lon, lat in ring)
        + "</coordinates></LinearRing></outerBoundaryIs></Polygon>"
        for ring in rings
    )
    shape = polygons if len(rings) == 1 else f"<MultiGeometry>{polygons}</MultiGeometry>"
    return f"<Placemark><name>{html.escape(name)}</name><styleUrl>#footprint</styleUrl>{shape}</Placemark>\n"


def _waypoint(one: Waypoint) -> str:
    data = "".join(
        f'<Data name="{name}"><value>{value}</value></Data>'
        for name, value in {**one.details, "time": one.time}.items()
    )
    return (
        f"<Placemark><name>{html.escape(one.name)}</name><ExtendedData>{data}</ExtendedData>"
        "<Point><altitudeMode>relativeToGround</altitudeMode>"
        f"<coordinates>{one.lon_deg},{one.lat_deg},{one.agl_m}</coordinates></Point></Placemark>\n"
    )


def _line(plan: Plan, sortie: int, name: str) -> str:
    lines = "".join(
        "<LineString><altitudeMode>relativeToGround</altitudeMode><coordinates>"
        + " ".join(f"{x},{y},{z}" for x, y, z in zip(lon.tolist(), lat.tolist(), agl.tolist()))
        + "</coordinates></LineString>"
        for lon, lat, agl in flight_line(plan, sortie)
        if len(lon) > 1
    )
    if not lines:
        return ""
    return (
        f"<Placemark><name>{name}</name><styleUrl>#flight</styleUrl>"
        f"<MultiGeometry>{lines}</MultiGeometry></Placemark>\n"
    )
