"""What a report says in sentences."""

from __future__ import annotations

import math

from ..imagery.source import Source
from ..mission.area import Box, Points, Polygon
from ..mission.estimate import area_text, length_text
from ..mission.mission import Mission
from ..mission.plan import Plan
from .measure import Measurement
from .tables import metres_text, px_text

#: Condition numbers up to which a scene is benign, and up to which it is only sensitive.
_BENIGN, _SENSITIVE = 10.0, 1000.0


def mission_title(plan: Plan) -> str:
    """A mission in a few words."""
    mission = plan.mission
    pictures = f"{len(plan):,} picture{'s' if len(plan) > 1 else ''}"
    return f"{pictures} from {length_text(mission.agl_m)}, {_place(mission)}{_looking(mission, ', ')}"


def _looking(mission: Mission, before: str) -> str:
    angles = (("yaw", mission.yaw_deg), ("tilt", mission.tilt_deg), ("roll", mission.roll_deg))
    turned = ", ".join(f"{name} {angle:g}°" for name, angle in angles if angle)
    return f"{before}{turned}" if turned else ""


def _place(mission: Mission) -> str:
    area = mission.area
    if isinstance(area, Points):
        lat, lon, _ = area.poses[0]
    else:
        box = area.bounds
        lat, lon = (box.north_deg + box.south_deg) / 2.0, box.west_deg + box.span_deg / 2.0
    lon = (lon + 180.0) % 360.0 - 180.0
    return (
        f"around {abs(lat):.4g}° {'N' if lat >= 0.0 else 'S'}, {abs(lon):.5g}° {'E' if lon >= 0.0 else 'W'}"
    )


def mission_facts(plan: Plan, source: Source, map_type: str) -> list[tuple[str, str]]:
    """Label and value of what the mission asks for."""
    mission, camera = plan.mission, plan.mission.camera
    width, height = int(plan.width_px.max()), int(plan.height_px.max())
    frames = "map frames: north-up rectangles of the source's own pixels"
    if plan.size_px is not None:
        frames = f"camera frames: what the camera sees, resampled ({mission.resampling})"
    facts = [
        ("area", _area(mission)),
        (
            "flight",
            (
                f"{len(plan):,} pictures in {plan.rows:,} row{'s' if plan.rows > 1 else ''}, "
                f"{length_text(mission.agl_m)} above "
                f"ground{_looking(mission, ', camera turned by ') or ', camera straight down and north-up'}"
            ),
        ),
        (
            "camera",
            (
                f"{camera.fov_deg:g}° across the diagonal, {camera.aspect_ratio:.4g} : 1, "
                f"{metres_text(plan.camera_gsd_m_per_px)} of ground a pixel straight below"
            ),
        ),
        ("pictures", f"{frames}, up to {width} × {height} px, zoom {plan.zoom}, {mission.image_format}"),
        ("source", f"{source.title}, measured on {map_type}"),
    ]
    wind = mission.wind
    if wind is not None and wind.sigma_m_per_s > 0.0:
        facts.append(
            (
                "wind",
                (
                    f"{wind.speed_m_per_s:g} m/s from {wind.from_deg:g}°, turbulence {100 * wind.turbulence:.3g} "
                    f"%, flown at {mission.airspeed_m_per_s:g} m/s"
                ),
            )
        )
    return facts


def _area(mission: Mission) -> str:
    area = mission.area
    if isinstance(area, Points):
        return f"{len(area.poses):,} point{'s' if len(area.poses) > 1 else ''}, {_place(mission)}"
    kind = "polygon" if isinstance(area, Polygon) else "box"
    box: Box = area.bounds
    return (
        f"{kind} of {area_text(area.area_m2())}, latitude {box.south_deg:g}° to {box.north_deg:g}°, longitude "
        f"{box.west_deg:g}° to {box.east_deg:g}°"
    )


def verdict(plan: Plan, found: Measurement) -> tuple[bool, str]:
    """Whether all that was measured kept its bounds, and the sentence that says so."""
    accuracy = plan.accuracy
    budget = f"budget of {accuracy.budget_px:g} px"
    if accuracy.bound_px <= accuracy.budget_px:
        sums = f"The methods' bounds sum to {px_text(accuracy.bound_px)}, within the {budget}."
    else:
        sums = f"The methods' bounds sum to {px_text(accuracy.bound_px)}, more than the {budget}: that was accepted."
    error = f"Measured on this mission's own captures their errors sum to {px_text(found.error_px)}"
    own = all(one.within for one in found.chosen)
    words = f"{sums} {error}: {'within' if own else 'NOT within'} the bounds."
    if own and not found.within:
        words += " A method that was not chosen broke its bound; the table below says which."
    return own and found.within, words


def condition_text(condition: float) -> str:
    """What the condition number of a scene means."""
    if math.isinf(condition):
        return (
            "The condition number is infinite: the horizon is in the picture, where the least change of the camera's "
            "attitude moves the ground that a pixel sees without limit. The arithmetic stays exact there; it is the "
            "pose that no one knows that well."
        )
    effect = (
        f"The condition number is {condition:.3g}: what goes in (height, angles, latitude) wrong by a millionth moves "
        f"the ground seen by up to {condition:.3g} millionths of its distance."
    )
    if condition <= _BENIGN:
        return f"{effect} That is benign: errors of the pose are hardly enlarged."
    if condition <= _SENSITIVE:
        return f"{effect} That is sensitive: positions far from the camera need a well-known pose."
    return f"{effect} That is ill-conditioned: positions near the horizon are no better than the pose."


def terrain_text(px_per_m: float) -> str:
    """What relief may add to the errors."""
    if math.isinf(px_per_m):
        return (
            "The ground is taken as smooth, at one height. Relief is not in the bounds: at the horizon it "
            "may move what is seen without limit."
        )
    return (
        "The ground is taken as smooth, at one height. Relief is not in the bounds: every metre that the "
        f"real ground is higher or lower may add up to {px_per_m:.2g} px, {10.0 * px_per_m:.2g} px for a "
        "house or a tree of 10 m."
    )


def saving_notes(plan: Plan, found: Measurement) -> list[str]:
    """What has to be said about what was left out."""
    notes = []
    left = {one.what for one in found.left_out}
    if "resampling" in left:
        notes.append(
            "Without resampling a map frame shows exactly the source's pixels; with it every picture would "
            "have been a camera frame, and its grey levels off by what the table of kernels says."
        )
    if "wind" in left and plan.size_px is None:
        notes.append(
            "Wind would also turn the camera, and so need camera frames; its own row counts the flight alone."
        )
    return notes


def how_measured(found: Measurement) -> list[str]:
    """How times and errors were measured."""
    width, height = found.planned_px
    notes = [
        (
            "An error is the distance in the image between where a method puts a ground point and where the "
            "exact camera, worked out anew in long double, sees it. That reference is itself good to "
            f"{px_text(found.floor_px)}; smaller ones are shown as below it."
        ),
        (
            "Errors are the greatest over captures spread over the mission's rows; pixels are those of the "
            f"planned picture, {width} × {height} px."
        ),
        (
            "Rounding a map frame's edges to whole source pixels is not an error: the picture says where it "
            "lies, exactly."
        ),
        (
            "A time is the median of repeated runs after one to warm up, on one core, without fetching and "
            "without writing files. What the captures of a row share is counted once a row. The source's parts "
            f"were fetched beforehand ({found.parts} of them) and kept in memory."
        ),
    ]
    if found.timed_px != found.planned_px:
        wide, high = found.timed_px
        notes.append(
            f"Pictures were timed at {wide} × {high} px, and seconds and bytes scaled by the number of pixels."
        )
    return notes
