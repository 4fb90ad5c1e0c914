"""Error against run time of a fixed set of scenes, from an ordinary one to the hardest.

    python benchmarks/work_precision.py            # writes docs/accuracy.md and docs/images/accuracy-*.png

Every method of every stage is timed and measured on each scene, as `terrainav report` does for one mission.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from integrators import Flight, flight_diagram, flight_of, flight_table, integrators_text
from pyproj import CRS
from terrainav.core.arrays import Floats
from terrainav.core.external.drawing import check_matplotlib
from terrainav.core.mission.areas.area import Area, Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import Plan, plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.report import plots, sentences
from terrainav.core.report.conditioning import conditioning
from terrainav.core.report.machine import machine, versions
from terrainav.core.report.measure import Measurement, measure
from terrainav.core.report.tables import (
    TextTable,
    air_table,
    displacement_table,
    encodings_table,
    kernels_table,
    methods_table,
    number_text,
    pipelines_table,
    px_text,
    savings_table,
    seconds_text,
)
from terrainav.core.storage.files import make_folder, write_whole
from terrainav.core.timing import QUICK, THOROUGH
from terrainav.core.world import WorldSource

ROOT = Path(__file__).resolve().parents[1]
AGRICENTER = Box(35.16, -89.90, 35.115, -89.823)
#: Where scenes of relief are seen from.
RELIEF = Points(((35.1408, -89.8606, 120.0),))
#: A fresh breeze over fields.
WIND = Wind(8.0, 250.0, 0.2)


class Scene(NamedTuple):
    """A mission with a name for people and one for files, and the heights of its relief at metres east and north."""

    name: str
    title: str
    mission: Mission
    heights_m: Callable[[Floats, Floats], Floats] | None = None


def flat(east_m: Floats, north_m: Floats) -> Floats:
    """Fields: waves of half a metre."""
    return 100.0 + 0.25 * np.sin(east_m / 40.0) * np.cos(north_m / 55.0)


def hilly(east_m: Floats, north_m: Floats) -> Floats:
    """Hills of 40 m, with slopes up to 40 %."""
    return 100.0 + 12.0 * np.sin(east_m / 60.0) * np.cos(north_m / 75.0) + 8.0 * np.cos((east_m + north_m) / 45.0)


def steep(east_m: Floats, north_m: Floats) -> Floats:
    """Terraces with walls of 25 m, on hills."""
    walls = 25.0 * (np.sin(east_m / 25.0) * np.sin(north_m / 30.0) > 0.3)
    return walls + hilly(east_m, north_m)


def write_heights(path: Path, heights_m: Callable[[Floats, Floats], Floats]) -> None:
    """Write heights around the relief scenes' point, in cells of about 2 m, as an ASCII grid in degrees."""
    ((lat, lon, _),) = RELIEF.poses
    side, cell_deg = 700, 2e-5
    offset_deg = (np.arange(side) + 0.5 - side / 2) * cell_deg
    east_m, north_m = np.meshgrid(offset_deg * 111e3 * math.cos(math.radians(lat)), offset_deg[::-1] * 111e3)
    corner = f"xllcorner {lon - side / 2 * cell_deg:.9f}\nyllcorner {lat - side / 2 * cell_deg:.9f}"
    header = f"ncols {side}\nnrows {side}\n{corner}\ncellsize {cell_deg}\nNODATA_value -9999"
    np.savetxt(path, heights_m(east_m, north_m), fmt="%.3f", header=header, comments="")
    path.with_suffix(".prj").write_text(CRS(4326).to_wkt("WKT1_ESRI"), encoding="utf-8")


def scenes() -> list[Scene]:
    """Return the scenes, from the ordinary to the extreme."""

    def scene(name: str, title: str, area: Area, agl_m: float, **more: Any) -> Scene:
        return Scene(name, title, Mission(area, agl_m, **more))

    return [
        scene("agricenter", "Agricenter, 120 m", AGRICENTER, 120.0),
        scene("latitude-80", "Latitude 80°, 120 m", Box(80.02, 15.0, 80.0, 15.2), 120.0),
        scene("antimeridian", "Across the antimeridian, 120 m", Box(-16.5, 179.98, -16.52, -179.98), 120.0),
        scene("16-km", "From 16 km", Box(35.6, -90.2, 35.0, -89.4), 16e3),
        scene("8000-km", "From 8,000 km", Points(((40.1, -90.0, 8e6),)), 8e6),
        scene("tilt-60", "Tilt 60°, 120 m", AGRICENTER, 120.0, tilt_deg=60.0),
        scene("tilt-85", "Tilt 85°, 120 m", AGRICENTER, 120.0, tilt_deg=85.0),
        scene("wind", "In wind, 120 m", AGRICENTER, 120.0, overlap_along=0.25, overlap_across=0.25, wind=WIND),
        *(
            Scene(
                f"relief-{heights.__name__}",
                f"Over {heights.__name__} relief, tilt 60°",
                Mission(RELIEF, 120.0, tilt_deg=60.0),
                heights,
            )
            for heights in (flat, hilly, steep)
        ),
    ]


class Result(NamedTuple):
    """A scene with its plan and what was measured."""

    scene: Scene
    plan: Plan
    found: Measurement


def run(quick: bool) -> Iterator[Result]:
    """Measure all scenes, saying which on the error output."""
    for scene in scenes():
        print(f"{scene.title} …", file=sys.stderr, flush=True)
        source, mission = WorldSource(scene.mission.imagery.seed), scene.mission
        with tempfile.TemporaryDirectory() as folder:
            if scene.heights_m is not None:
                path = Path(folder) / f"{scene.name}.asc"
                write_heights(path, scene.heights_m)
                mission = mission.replace(elevation=(str(path),))
            worked_out = plan(mission, source.grid, mission_heights(mission))
            yield Result(scene, worked_out, measure(worked_out, source, quick=quick))


def summary(results: list[Result]) -> TextTable:
    """One row a scene."""
    rows = []
    for scene, worked_out, found in results:
        accuracy = worked_out.accuracy
        methods = ", ".join(choice.method.name for choice in accuracy.choices)
        seconds = next(one.seconds for one in found.chosen if one.method.stage == "image")
        kept = "" if all(one.keeps_bound for one in found.chosen) else " (above its bound)"
        rows.append(
            (
                f"[{scene.title}](#{anchor(scene.title)})",
                f"{len(worked_out):,}",
                methods,
                px_text(accuracy.bound_px),
                px_text(found.reached_px),
                px_text(found.error_px) + kept,
                seconds_text(seconds),
                number_text(accuracy.condition) if math.isfinite(accuracy.condition) else "infinite (horizon)",
                f"{number_text(accuracy.terrain_px_per_m)} px"
                if math.isfinite(accuracy.terrain_px_per_m)
                else "without limit",
            )
        )
    header = (
        "scene",
        "captures",
        "chosen: footprint, image, pixels",
        "bound",
        "bound reached",
        "measured error",
        "time an image",
        "condition number",
        "a metre of relief adds up to",
    )
    return TextTable(header, rows)


def anchor(title: str) -> str:
    """Name that GitHub gives a heading."""
    kept = "".join(letter for letter in title.lower() if letter.isalnum() or letter in " -")
    return kept.replace(" ", "-")


def markdown(found: TextTable) -> str:
    """Table in Markdown; what was chosen is bold."""
    lines = [" | ".join(found.header), " | ".join("---" for _ in found.header)]
    for index, row in enumerate(found.rows):
        cells = [cell.replace("|", "\\|") for cell in row]
        if index in found.chosen:
            cells = [f"**{cell}**" if cell else cell for cell in cells]
        lines.append(" | ".join(cells))
    return "\n".join(f"| {line} |" for line in lines)


def document(results: list[Result], flight: Flight) -> str:
    """Text of docs/accuracy.md."""
    return (
        "\n\n".join(
            [
                "# Error against run time",
                (
                    "Made by `python benchmarks/work_precision.py`; `terrainav report MISSION --output DIR` makes "
                    "the same for any mission."
                ),
                (
                    "An error is the distance, in px of the planned image, between where a method puts a ground "
                    "point and where the exact camera over the ellipsoid, computed independently in long double, sees "
                    "it. Every stage uses the cheapest method whose bound, added to the others', fits the error "
                    "budget of 0.1 px; bounds are known before anything is computed."
                ),
                markdown(summary(results)),
                f"{sentences.TIMES} Relief is not in the bounds: the last column is its possible effect.",
                f"{sentences.DIAGRAM} {sentences.DISTRIBUTIONS}",
                f"Whole images: {sentences.PIPELINES[0].lower()}{sentences.PIPELINES[1:]}",
                *(_scene_text(result) for result in results),
                "## Conditioning",
                f"The camera of the first scene. {sentences.CONDITIONING}",
                "![Condition number against tilt and against height](images/accuracy-conditioning.png)",
                *_grey_text(results),
                *_integrators_text(flight),
                "## Machine and versions",
                markdown(TextTable(("", ""), [*machine(), *versions()])),
            ]
        )
        + "\n"
    )


def _scene_text(result: Result) -> str:
    scene, worked_out, found = result
    _, verdict = sentences.verdict(worked_out, found)
    parts = [
        f"## {scene.title}",
        f"{sentences.mission_title(worked_out)}. {verdict}",
        f"![Error in px against seconds per capture, a panel a stage](images/accuracy-{scene.name}.png)",
        markdown(methods_table(found)),
        f"![Share of points against error](images/accuracy-{scene.name}-errors.png)",
        "Whole images:",
        markdown(pipelines_table(found)),
    ]
    parts += [
        f"{choice.method.stage.capitalize()}: {choice.rejected.name} was rejected: {choice.reason}."
        for choice in worked_out.accuracy.choices
        if choice.rejected is not None
    ]
    if found.left_out:
        parts += [
            "Left out, and savings for the whole mission:",
            markdown(savings_table(found.left_out)),
        ]
    if found.wind is not None:
        parts += [
            *sentences.wind_effect_text(found.wind),
            markdown(displacement_table(found.wind)),
            markdown(air_table(found.wind)),
            *sentences.wind_notes(found.wind),
        ]
    parts.append(sentences.condition_text(worked_out.accuracy.condition))
    parts += sentences.circumstances(found)
    return "\n\n".join(parts)


def _grey_text(results: list[Result]) -> Iterator[str]:
    _, worked_out, found = results[0]
    if found.resampling is None:
        return
    yield "## Grey levels"
    yield (
        "Resampling affects grey levels, not positions, and is not in the bounds. RMS errors of "
        f"255 grey levels between the pixels of the first scene, against {found.resampling.truth}:"
    )
    yield "![RMS grey levels of error against spatial frequency, and against time](images/accuracy-resampling.png)"
    yield markdown(kernels_table(found.kernels, found.resampling, "none" if worked_out.frames.on_map else ""))
    yield "Files of one image of the first scene:"
    yield markdown(encodings_table(found.encodings))


def _integrators_text(flight: Flight) -> Iterator[str]:
    yield "## Computing flight in wind"
    yield (f"{integrators_text(flight)} In the scene in wind, by the covariance of the state at the next exposure:")
    yield "![Error against run time and against the step of four integrators](images/accuracy-integrators.png)"
    yield markdown(flight_table(flight))
    yield (
        "The trapezoid converges to the right covariance at any step, but not to the right correlation in time, as the "
        "left diagram shows. Implicit Euler is stable at any step, but damps the gusts."
    )


def main() -> int:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder to write to (default docs)")
    parser.add_argument("--quick", action="store_true", help="time every method once")
    arguments = parser.parse_args()
    check_matplotlib()
    images = arguments.docs / "images"
    make_folder(images)
    results = list(run(arguments.quick))
    drawn = {}
    for scene, worked_out, found in results:
        drawn[scene.name] = plots.work_precision(found, worked_out.accuracy.budget_px, scene.title)
        drawn[f"{scene.name}-errors"] = plots.distributions(found)
    _, first, found = results[0]
    drawn["conditioning"] = plots.conditioning(conditioning(first))
    if found.resampling is not None:
        drawn["resampling"] = plots.resampling(found, found.resampling)
    windy = next(result.plan for result in results if result.scene.name == "wind")
    flight = flight_of(windy, QUICK if arguments.quick else THOROUGH)
    drawn["integrators"] = flight_diagram(flight)
    for name, data in drawn.items():
        write_whole(images / f"accuracy-{name}.png", data)
    write_whole(arguments.docs / "accuracy.md", document(results, flight).encode("utf-8"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
