"""Sentences of a report."""

from __future__ import annotations

import math
import statistics

from ..imagery.source import Source
from ..mission.areas.area import Box, Points, Polygon, Polygons
from ..mission.estimate import area_text, length_text, percent
from ..mission.flight.wind import Wind
from ..mission.mission import Mission
from ..mission.plan import Plan
from .measure import Measurement
from .tables import displaced_text, metres_text, px_text, share_text
from .wind import MOVED, TOGETHER, TURNED, Spread, WindEffect

#: Explanation of a work-precision diagram.
DIAGRAM = (
    "A panel for each stage, and one for whole images with their files. Methods further left are more exact, further "
    "down cheaper. Markers are the greatest measured errors, level lines reach from the median error to the bound that "
    "is reached (bar), upright ones span the quartiles of the time, and rings mark what the plan uses. Hollow markers "
    'at "≤" are no larger than the error of the reference. The dashed line is the error budget.'
)
#: Explanation of a diagram of distributions.
DISTRIBUTIONS = (
    "Share of the measured points whose error is below a value; dotted lines are the bounds reached. Errors no larger "
    "than that of the reference are not shown."
)
#: Explanation of whole images.
PIPELINES = (
    "The footprint, the image with the pixels of its frame, and its file: the mission's format for each method, then "
    "other formats for the methods that the plan uses."
)
#: Explanation of the curves of condition numbers.
CONDITIONING = (
    "Condition number of this camera at the mission's highest latitude and greatest roll. Curves end where the horizon "
    "enters the image."
)
#: Explanation of the times.
TIMES = (
    "Times are processor times of one thread, without fetching tiles and writing files: the median of several rounds "
    "and, in brackets, the quartiles. Methods of a stage take turns in each round, in random order, and are compared "
    "round by round. They are not distinguishable if the quartiles of their ratio lie on either side of 1, or if two "
    "equally fast methods would agree in as many rounds in more than one case of twenty."
)


def mission_title(plan: Plan) -> str:
    """Short description of a mission."""
    mission = plan.mission
    pictures = f"{len(plan):,} image{'s' if len(plan) > 1 else ''}"
    above = f"{pictures} from {length_text(mission.flight.agl_m)}, {_place(mission)}{_looking(mission, ', ')}"
    return ", ".join(filter(None, (above, wind_text(mission.wind))))


def _looking(mission: Mission, before: str) -> str:
    angles = (
        ("yaw", mission.attitude.yaw_deg),
        ("tilt", mission.attitude.tilt_deg),
        ("roll", mission.attitude.roll_deg),
    )
    turned = ", ".join(f"{name} {angle:g}°" for name, angle in angles if angle)
    return f"{before}{turned}" if turned else ""


def wind_text(wind: Wind | None) -> str:
    """Short description of wind; empty in still air."""
    if wind is None or wind.speed_m_per_s == 0.0:
        return ""
    gusts = f"turbulence {100.0 * wind.turbulence:.3g} %" if wind.turbulence else "without gusts"
    return f"wind of {wind.speed_m_per_s:g} m/s from {wind.from_deg:g}°, {gusts}"


def _place(mission: Mission) -> str:
    area = mission.area
    if isinstance(area, Points):
        lat, lon, _ = area.poses[0]
    else:
        box = area.bounds
        lat, lon = (box.north_deg + box.south_deg) / 2.0, box.west_deg + box.span_deg / 2.0
    lon = (lon + 180.0) % 360.0 - 180.0
    return f"around {abs(lat):.4g}° {'N' if lat >= 0.0 else 'S'}, {abs(lon):.5g}° {'E' if lon >= 0.0 else 'W'}"


def mission_facts(plan: Plan, source: Source, map_type: str) -> list[tuple[str, str]]:
    """Label and value of the mission's main settings."""
    mission, camera = plan.mission, plan.mission.camera
    width, height = int(plan.frames.width_px.max()), int(plan.frames.height_px.max())
    frames = (
        "map frames: rectangles of the source's own pixels"
        if plan.frames.on_map
        else f"camera frames: what the camera sees, resampled ({mission.accuracy.resampling})"
    )
    facts = [
        ("area", _area(mission)),
        (
            "flight",
            (
                f"{len(plan):,} images in {plan.rows:,} row{'s' if plan.rows > 1 else ''}, "
                f"{length_text(mission.flight.agl_m)} above "
                f"ground{_looking(mission, ', camera turned by ') or ', camera straight down and north-up'}"
            ),
        ),
        (
            "camera",
            (
                f"{camera.fov_deg:g}° across the diagonal, {camera.aspect_ratio:.4g} : 1, "
                f"{metres_text(plan.resolution.camera_m_per_px)} of ground a pixel straight below"
            ),
        ),
        (
            "images",
            f"{frames}, up to {width} × {height} px, zoom {plan.zoom}, {mission.output.image_format}",
        ),
        ("source", f"{source.title}, measured on {map_type}"),
    ]
    wind = wind_text(mission.wind)
    if wind:
        facts.append(("wind", f"{wind}, flown at {mission.flight.airspeed_m_per_s:g} m/s"))
    return facts


def _area(mission: Mission) -> str:
    area = mission.area
    if isinstance(area, Points):
        return f"{len(area.poses):,} point{'s' if len(area.poses) > 1 else ''}, {_place(mission)}"
    kind = "polygon" if isinstance(area, Polygon) else "box"
    if isinstance(area, Polygons):
        kind = f"{len(area.parts):,} polygons"
    box: Box = area.bounds
    return (
        f"{kind} of {area_text(area.area_m2())}, latitude {box.south_deg:g}° to {box.north_deg:g}°, longitude "
        f"{box.west_deg:g}° to {box.east_deg:g}°"
    )


def verdict(plan: Plan, found: Measurement) -> tuple[bool, str]:
    """Whether all measurements are within their bounds, and a sentence with the result."""
    accuracy = plan.accuracy
    budget = f"budget of {accuracy.budget_px:g} px"
    if accuracy.bound_px <= accuracy.budget_px:
        sums = f"The methods' bounds sum to {px_text(accuracy.bound_px)}, within the {budget}."
    else:
        sums = f"The methods' bounds sum to {px_text(accuracy.bound_px)}, more than the {budget}: that was accepted."
    if found.reached_px < 0.95 * accuracy.bound_px:
        sums += f" What they reach sums to {px_text(found.reached_px)}."
    error = f"Measured on this mission's captures, their greatest errors sum to {px_text(found.error_px)}"
    broken = [
        f"{one.method.name} by {px_text(one.error_px)} where {px_text(one.reached_px)} were its bound"
        for one in found.chosen
        if not one.keeps_bound and one.error_px is not None
    ]
    if broken:
        return False, f"{sums} {error}: NOT within the bounds, {' and '.join(broken)}."
    words = f"{sums} {error}: within the bounds."
    if not found.keeps_bounds:
        words += " A method that was not chosen broke its bound; the table below says which."
    return found.keeps_bounds, words


def condition_text(condition: float) -> str:
    """Meaning of the condition number of a scene."""
    if math.isinf(condition):
        return (
            "The condition number is infinite: the horizon is in the image, where the smallest change of the camera's "
            "attitude moves the visible ground without limit. The arithmetic remains exact there, but no pose is known "
            "that precisely."
        )
    effect = (
        f"The condition number is {condition:.3g}: an error of one millionth in the input (height, angles, latitude) "
        f"moves the visible ground by up to {condition:.3g} millionths of its distance."
    )
    # Benign up to 10, ill-conditioned above 1,000.
    if condition <= 10.0:
        return f"{effect} That is benign: errors of the pose are hardly amplified."
    if condition <= 1000.0:
        return f"{effect} That is sensitive: positions far from the camera need an accurate pose."
    return f"{effect} That is ill-conditioned: positions near the horizon depend strongly on the pose."


def terrain_text(px_per_m: float, relief: str = "") -> str:
    """Effect of relief on the errors, or of errors in its heights."""
    if relief:
        shift = "without limit at the horizon" if math.isinf(px_per_m) else f"up to {px_per_m:.2g} px"
        return (
            f"The ground is {relief}. The bounds are those of the methods for these heights: every metre of error in "
            f"the heights adds {shift}."
        )
    if math.isinf(px_per_m):
        return (
            "The ground is assumed to be smooth, at one height. Relief is not in the bounds: at the horizon it "
            "may move the visible ground without limit."
        )
    return (
        "The ground is assumed to be smooth, at one height. Relief is not in the bounds: every metre by which "
        f"the real ground is higher or lower may add up to {px_per_m:.2g} px, {10.0 * px_per_m:.2g} px for a "
        "house or a tree of 10 m."
    )


def saving_notes(plan: Plan, found: Measurement) -> list[str]:
    """Notes on the stages that were left out."""
    notes = []
    left = {one.what for one in found.left_out}
    if "resampling" in left:
        notes.append(
            "Without resampling, a map frame shows exactly the source's pixels. With it, every image would be a camera "
            "frame, and its grey levels would have the errors in the table of kernels."
        )
    if "wind" in left and plan.frames.on_map:
        notes.append("Wind would also turn the camera, and so need camera frames; its row counts only the flight.")
    return notes


def how_measured(found: Measurement) -> list[str]:
    """Explanation of how times and errors were measured."""
    width, height = found.planned_px
    notes = [
        (
            "An error is the distance in the image between where a method puts a ground point and where the "
            "exact camera, computed independently in long double, sees it. The accuracy of this reference is "
            f"{px_text(found.floor_px)}; smaller errors are shown as below it."
        ),
        (
            "Errors are those of points in captures spread over the mission's rows; pixels are those of the "
            f"planned image, {width} × {height} px. Tolerances that give the same positions are one method."
        ),
        ("Rounding a map frame's edges to whole source pixels is not an error: the image states its exact position."),
        (
            f"{TIMES} Rounds after one to warm up: {_rounds(found)}. Work shared by the captures of a row is counted "
            f"once per row. The source's {found.parts} tiles were fetched beforehand and kept in memory."
        ),
    ]
    notes += circumstances(found)
    if found.timed_px != found.planned_px:
        wide, high = found.timed_px
        notes.append(f"Images were timed at {wide} × {high} px, and seconds and bytes scaled by the number of pixels.")
    return notes


def circumstances(found: Measurement) -> list[str]:
    """Scatter of repeated runs, load of the machine, and seeds."""
    notes = []
    scatter = [
        (one.seconds.quartiles.high - one.seconds.quartiles.low) / one.seconds.median
        for stage in found.stages.values()
        for one in stage
        if one.seconds is not None and one.seconds.spread_known
    ]
    if scatter:
        usual, most = (f"{100.0 * share:.2g} %" for share in (statistics.median(scatter), max(scatter)))
        notes.append(f"Repeated runs scatter by {usual} (quartiles apart, over the median; {most} at most).")
    if found.load:
        before, after = found.load
        notes.append(
            f"Load of the machine, processes in the last minute: {before:.1f} before, {after:.1f} after. Processor "
            "times do not count the others, but share caches and memory with them."
        )
    seeds = ", ".join(f"{name} {seed}" for name, seed in found.seeds.items())
    notes.append(f"Seeds: {seeds}. Positions and grey levels are the same in each report, times are not.")
    return notes


def _rounds(found: Measurement) -> str:
    seconds = [one.seconds for stage in found.stages.values() for one in stage if one.seconds]
    fewest, most = (end(len(one.rounds) for one in seconds) for end in (min, max))
    few = "" if all(one.spread_known for one in seconds) else ", too few for quartiles"
    return (f"{fewest} to {most}" if fewest < most else f"{most}") + few


def wind_effect_text(effect: WindEffect) -> list[str]:
    """Effect of wind on the camera and on coverage."""
    text = []
    if not effect.displacements:
        text.append(
            "Steady wind neither moves nor turns the camera: the aircraft holds its position, and the camera mount "
            "compensates tilt and crab. It changes only the flight time."
        )
    else:
        moved, turned, together = (
            next(one for one in effect.displacements if one.what == what) for what in (MOVED, TURNED, TOGETHER)
        )
        text.append(
            f"Gusts move the camera by {_spread_text(moved.size, 'm')}, which shifts the ground in the image by "
            f"{_spread_text(moved.px)}. They turn it by {_spread_text(turned.size, 'deg')}, which shifts the ground by "
            f"{_spread_text(turned.px)}. Both together shift it by {_spread_text(together.px)}. "
            "The images show what the camera sees from its real pose, and state that pose: the shift does not affect "
            "their georeference, but it changes which ground they show."
        )
    figures = effect.figures
    if "coverage" in figures:
        calm, wind = map(str, (percent(share, exact=share == 1.0) for share in figures["coverage"]))
        clauses = [f"Coverage is {wind} in this wind, {calm} in still air"]
        for way in ("front", "side"):
            if f"least_{way}_overlap" in figures:
                calm, wind = (share_text(share) for share in figures[f"least_{way}_overlap"])
                clauses.append(f"the least {way} overlap {wind} instead of {calm}")
        text.append("; ".join(clauses) + ".")
    return text


def _spread_text(found: Spread | None, unit: str = "px") -> str:
    if found is None:
        return "an unknown amount, because no corner shows ground"
    rms, usual, most = (displaced_text(size, unit) for size in found)
    return f"{rms} (rms; {usual} for 95 % of the captures, {most} at most)"


def wind_notes(effect: WindEffect) -> list[str]:
    """Notes on the figures of wind."""
    notes = []
    if effect.displacements:
        notes.append(
            "The shift in the image is the largest of five: for the ground points that the nominal camera sees in its "
            "corners and its middle."
        )
        if effect.compared < len(effect.flown):
            notes[0] += (
                f" It is that of {effect.compared:,} captures, spread over the mission; metres and degrees are of all."
            )
    if effect.calm.frames.on_map != effect.flown.frames.on_map:
        notes.append(
            "In still air the images are map frames, in wind camera frames, which cover the largest north-up rectangle "
            "inside their footprints."
        )
    return notes
