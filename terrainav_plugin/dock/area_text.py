"""Areas from text that people paste: the paper's formats, on one line or several. Knows no widget."""

from __future__ import annotations

from ...core.errors import InvalidInput
from ...core.mission.area import Area, Points
from ...core.mission.coords import parse_coords
from ..i18n import tr
from .form_text import SEPARATORS

#: Of a corner, of a point with its height and yaw, and of two corners.
_POINT, _POSE, _POSE_AND_YAW, _CORNERS = 2, 3, 4, 4


def area_of_text(text: str, agl: float, agl_unit: str) -> tuple[Area, float | None]:
    """Area of pasted text.

    Parameters
    ----------
    text : str
        ``north_west_south_east_agl`` or ``lat_lon_agl``, or several lines of ``lat lon agl [yaw]``. Commas,
        semicolons and spaces do as well as underscores, and the height may be left out of one line.
    agl : float
        Height where the text has none.
    agl_unit : str
        m or ft, of all heights.

    Returns
    -------
    area : Box or Points
    agl_m : float or None
        Height in the text, metres; of the first point where there are several; None where it has none.

    Raises
    ------
    InvalidInput
        Names what cannot be read, with its line.
    """
    lines = [
        (number, _without_separators(line))
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(lines) > 1:
        return _points(lines, agl, agl_unit)
    line = lines[0][1] if lines else ""
    parts = SEPARATORS.split(line)
    given = len(parts) not in (_POINT, _CORNERS)
    area, agl_m = parse_coords(line if given else "_".join([*parts, repr(agl)]), agl_unit=agl_unit)
    return area, agl_m if given else None


def _without_separators(line: str) -> str:
    """Line without what separates at its ends; a pattern for its end would take time that grows with its square."""
    first, after = (found.end() if found else 0 for found in map(SEPARATORS.match, (line, line[::-1])))
    return line[first : len(line) - after]


def _points(lines: list[tuple[int, str]], agl: float, agl_unit: str) -> tuple[Points, float | None]:
    """Points of several lines, all with a yaw or all without."""
    poses: list[tuple[float, float, float]] = []
    yaws: list[float] = []
    given = False
    for number, line in lines:
        parts = SEPARATORS.split(line)
        where = tr("line {number}:").format(number=number)
        try:
            if len(parts) not in (_POINT, _POSE, _POSE_AND_YAW):
                found = tr("“{line}” has {count} numbers; several lines must be of lat lon agl [yaw]")
                raise InvalidInput(found.format(line=line, count=len(parts)))
            given = given or len(parts) >= _POSE
            first = parts[:_POSE] if len(parts) >= _POSE else [*parts, repr(agl)]
            point, _ = parse_coords("_".join(first), agl_unit=agl_unit)
            poses += point.poses
            if len(parts) == _POSE_AND_YAW:
                yaws += Points(point.poses, (_number(parts[3]),)).yaws_deg
        except InvalidInput as wrong:
            raise InvalidInput(f"{where} {wrong}") from wrong
        if yaws and len(yaws) != len(poses):
            raise InvalidInput(f"{where} " + tr("give every point a yaw, or none"))
    return Points(tuple(poses), tuple(yaws)), poses[0][2] if given else None


def _number(text: str) -> float:
    try:
        return float(text.replace("\u2212", "-"))
    except ValueError as wrong:
        raise InvalidInput(tr("yaw “{text}”: must be a number of degrees").format(text=text)) from wrong
