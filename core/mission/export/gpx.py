"""A plan as a route for navigation devices: GPX 1.1 (https://www.topografix.com/GPX/1/1/).

The ``ele`` of a route point is a height above sea level, so it is left out; the height above ground is in the
description and, for programs, in the extensions.
"""

from __future__ import annotations

import html
from collections.abc import Iterator

from ...errors import Message
from ..plan import Plan
from .rows import parts
from .waypoints import Waypoint, takeoff_deg, waypoint_notes, waypoints


def gpx_text(plan: Plan) -> Iterator[str]:
    """Text of the route, in blocks."""
    # The namespace of the extensions is a name: no page has this address.
    yield (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<gpx version="1.1" creator="TerrAInav" xmlns="http://www.topografix.com/GPX/1/1" '
        'xmlns:terrainav="https://github.com/terrainav/terrainav/gpx/1">\n'
        f"<metadata><name>TerrAInav plan</name><time>{plan.direct.start}</time></metadata>\n"
    )
    path = plan.path
    place = takeoff_deg(plan)
    if place is not None:
        yield f'<wpt lat="{place[0]:.9f}" lon="{_lon(place[1])}"><name>Take-off</name></wpt>\n'
    for sortie in range(path.sorties):
        name = "TerrAInav flight" if path.sorties == 1 else f"TerrAInav flight, sortie {sortie + 1}"
        yield f"<rte><name>{name}</name><desc>Heights are metres above ground</desc>\n"
        flown = waypoints(plan, sortie)
        for part in parts(len(path.sortie_path(sortie))):
            yield "".join(_point(next(flown)) for _ in range(part.stop - part.start))
        yield "</rte>\n"
    yield "</gpx>\n"


def gpx_notes(plan: Plan) -> tuple[str, ...]:
    """Notes on what the route leaves out, one line each."""
    return (
        *waypoint_notes(plan),
        Message("heights are above ground, in each point's description; GPX's own are above the sea"),
    )


def _point(one: Waypoint) -> str:
    details = "".join(f"<terrainav:{name}>{value}</terrainav:{name}>" for name, value in one.details.items())
    # Decimals of XML Schema have no exponent; nine decimals of a degree are a tenth of a millimetre.
    return (
        f'<rtept lat="{one.lat_deg:.9f}" lon="{_lon(one.lon_deg)}"><time>{one.time}</time>'
        f"<name>{html.escape(one.name)}</name><desc>{one.agl_m:.2f} m above ground, heading {one.heading_deg:.2f} deg, "
        f"gimbal {one.gimbal_pitch_deg:.2f} deg</desc><extensions>{details}</extensions></rtept>\n"
    )


def _lon(lon_deg: float) -> str:
    # GPX longitudes are below 180, but a longitude just west of the antimeridian may be rounded to 180.
    text = f"{lon_deg:.9f}"
    return "-180.000000000" if text == "180.000000000" else text
