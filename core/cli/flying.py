"""Plan, capture and report on missions on the command line."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..capture.choices import FOLDERS, IMAGES
from ..errors import InvalidInput
from ..mission.options import OPTIONS, RUN_OPTIONS
from ..mission.parts import AUTO
from ..storage.stores import is_address
from ..text.plain import printable
from ..waiting import cancellable
from .exits import DONE, INCOMPLETE, exit_code
from .listing import open_cache
from .stopping import collect_signals

if TYPE_CHECKING:
    from ..capture.blocks.engines import Engine
    from ..capture.blocks.running import Blocks
    from ..capture.progress import CaptureResult, Failure, Progress, Repeat
    from ..geodesy.mercator import PixelGrid
    from ..imagery.cache.tile_cache import TileCache
    from ..imagery.opening import NamedSource
    from ..imagery.source import Source
    from ..mission.estimate import Summary
    from ..mission.mission import Mission
    from ..mission.parts import Imagery
    from ..mission.plan import Plan
    from ..mission.relief.ground import Heights
    from ..pairs.capturing import PairResult
    from ..pairs.planning import PairSettings

#: Failed images printed; the journal and the tables list all.
NAMED_FAILURES = 10
#: Key, among the values of options, for whether the user named the source.
SOURCE_WAS_NAMED = "named_by_user"
#: Suffix of a mission file; files of plans have other suffixes.
_MISSION = ".json"


def names_source(arguments: argparse.Namespace) -> bool:
    """Whether the user named the source on the command line or in the environment, rather than in a file."""
    if getattr(arguments, "mission_file", None) is not None:
        return False
    return arguments.source is not None or bool(os.environ.get("TERRAINAV_SOURCE"))


def mission_settings(arguments: argparse.Namespace) -> tuple[Mission, dict[str, Any]]:
    """Return the requested mission, and the options of its run, including `SOURCE_WAS_NAMED`."""
    from ..mission.mission import Mission
    from ..mission.settings import build_mission, resolve

    given = {option.name: getattr(arguments, option.name) for option in OPTIONS}
    if arguments.mission_file is None:
        values = resolve(given, config=arguments.config)
        mission = build_mission({**values, "source": _source_name(values["source"])})
        return mission, {**values, SOURCE_WAS_NAMED: names_source(arguments)}
    for name, value in given.items():
        if value is not None and name not in RUN_OPTIONS:
            raise InvalidInput(
                "mission file {0!r} and --{1}: give one of the two",
                arguments.mission_file,
                name.replace("_", "-"),
            )
    mission = Mission.load(arguments.mission_file, named_by_user=True)
    return mission, {**resolve(given, config=arguments.config), SOURCE_WAS_NAMED: False}


def _source_name(source: str) -> str:
    """Name of a source given by name or title."""
    from ..mission.parts import Imagery

    if source == Imagery.source:
        return source
    from ..imagery.catalogue import source_name

    return source_name(source)


def requested_source(
    asked: Imagery | PairSettings, values: dict[str, Any], cache: TileCache | None = None, **more: Any
) -> NamedSource:
    """Return the requested source with the options of the run; ``more`` are further fields of `SourceOptions`."""
    from ..imagery.opening import SourceOptions, named_source

    return named_source(
        asked.source,
        SourceOptions(
            seed=asked.seed,
            date=asked.date or None,
            crs=asked.crs,
            connections=values["connections"],
            cache=cache,
            placeholders=tuple(values["placeholder"] or ()),
            named_by_user=values[SOURCE_WAS_NAMED],
            **more,
        ),
    )


def mission_source(
    mission: Mission, values: dict[str, Any], cache: TileCache | None = None, *, as_stored: bool = False
) -> NamedSource:
    """Return the source of a mission with the options of the run."""
    from ..mission.sunlight import mission_sun

    imagery = mission.imagery
    return requested_source(
        imagery,
        values,
        cache,
        sun=mission_sun(mission),
        area_deg=mission.area.bounds.edges_deg,
        bands=imagery.bands,
        stretch=imagery.stretch,
        as_stored=as_stored,
    )


def _as_written(mission: Mission) -> bool:
    """Whether images keep all bands of a source, in the source's data type."""
    return mission.output.image_format == "tif"


def requested_heights(mission: Mission, values: dict[str, Any]) -> Heights | None:
    """Open the heights of a mission's relief; None without one."""
    if not mission.terrain.elevation:
        return None
    from ..imagery.opening import SourceOptions
    from ..picture.heights import mission_heights

    options = SourceOptions(
        seed=mission.imagery.seed,
        connections=values["connections"],
        cache=open_cache(values),
        named_by_user=values[SOURCE_WAS_NAMED],
    )
    return mission_heights(mission, options)


def _plan_mission(mission: Mission, values: dict[str, Any], source: Source | NamedSource) -> Plan:
    """Plan a mission, over relief if it has one."""
    from ..mission.plan import plan

    return plan(mission, source.grid, requested_heights(mission, values))


def fit_flight(mission: Mission, arguments: argparse.Namespace, values: dict[str, Any], grid: PixelGrid) -> Mission:
    """Align the rows of a mission and choose its airspeed where that is requested, and print what comes of it."""
    one = mission.of_first_imagery
    way = getattr(arguments, "align", None)
    if way is not None:
        from ..mission.flight.alignment import align_rows

        found = align_rows(one, grid, requested_heights(one, values), way)
        print(printable(found.text()), file=sys.stderr)
        mission, one = (each.replace(row_azimuth_deg=found.azimuth_deg) for each in (mission, one))
    # A mission file states its speed.
    if arguments.mission_file is None and values["airspeed"] == AUTO:
        from ..mission.flight.pilot import greatest_speed_m_per_s
        from ..mission.plan import plan

        chosen = greatest_speed_m_per_s(plan(one, grid, requested_heights(one, values)))
        print(f"airspeed {chosen:g} m/s", file=sys.stderr)
        mission = mission.replace(airspeed_m_per_s=chosen)
    return mission


def open_mission_source(mission: Mission, values: dict[str, Any], *, as_stored: bool) -> closing[Source]:
    """Open the source of a mission."""
    return closing(mission_source(mission, values, open_cache(values), as_stored=as_stored).open())


def _bounds_deg(planned: Plan) -> tuple[float, float, float, float]:
    """West, south, east, north of a plan's captures."""
    lat, lon = planned.lat_deg, planned.lon_deg
    return float(lon.min()), float(lat.min()), float(lon.max()), float(lat.max())


def _check_terms(planned: Plan, source: Source, requests: int, accept_terms: bool) -> None:
    from ..imagery.catalogue import check_policy

    check_policy(
        source,
        requests,
        accept_terms=accept_terms,
        map_types=planned.mission.imagery.map_types,
        bounds_deg=_bounds_deg(planned),
    )


def _summary(planned: Plan, source: NamedSource, values: dict[str, Any]) -> Summary:
    from ..bands import RGB
    from ..imagery.opening import source_kind
    from ..mission.estimate import FROM_FILE, OFFLINE, ONLINE, estimate

    policy = source.policy
    local = FROM_FILE if source_kind(source.text).is_file else OFFLINE
    costs = replace(local if source.is_local else ONLINE, requests_per_s=policy.requests_per_s)
    # File sizes are known for 8-bit red, green and blue.
    share = source.bands.bytes_per_px / RGB.bytes_per_px
    costs = replace(costs, bytes_per_px={ending: size * share for ending, size in costs.bytes_per_px.items()})
    return estimate(planned, costs, policy.connections(values["connections"]), os.cpu_count() or 1)


def _figures(planned: Plan, source: NamedSource, values: dict[str, Any]) -> dict[str, Any]:
    """Figures of a plan as JSON data."""
    from ..bands import RGB
    from ..picture.cost import timed_cost

    source_facts = {
        "source": source.title,
        "date": source.date,
        "crs": source.grid.plane.crs,
        "policy": asdict(source.policy),
    }
    if source.bands != RGB:
        source_facts["bands"] = {"names": source.bands.names, "data_type": source.bands.data_type}
    cost = timed_cost(planned, source.bands)
    return {**source_facts, **_summary(planned, source, values).to_dict(), "cost": cost._asdict()}


def _print_figures(planned: Plan, source: NamedSource, values: dict[str, Any]) -> None:
    from ..bands import RGB
    from ..picture.cost import timed_cost

    policy = source.policy
    facts = filter(None, (source.title, source.date, planned.grid.plane.label))
    lines = [("source", ", ".join(facts))]
    if not source.is_local:
        needed = _requests(planned)
        more = f"; this mission takes {needed:,}" if policy.stops(needed) else ""
        lines.append(("terms", f"{policy.licence or 'licence not stated'}; {policy.text()}{more}"))
    if source.bands != RGB:
        lines.append(("bands", str(source.bands)))
    cost = timed_cost(planned, source.bands)
    summary = _summary(planned, source, values)
    for label, text in [*lines, *summary.lines(), ("cost", cost.text(len(planned)))]:
        print(printable(f"{label:24s}{text}"))


def _requests(planned: Plan) -> int:
    return planned.requests * len(planned.mission.imagery.map_types)


def run_plan(arguments: argparse.Namespace) -> int:
    """Plan a mission for each of its imageries; print the figures and write the files."""
    if arguments.profile is not None:
        from ..report.heights import check_profile_ending

        check_profile_ending(arguments.profile)
    if arguments.more_missions:
        return _plan_joined(arguments)
    endings = {path: _ending(path, _MISSION) for path in arguments.output}
    mission, values = mission_settings(arguments)
    each = mission.missions_by_imagery
    sources = {
        name: mission_source(one, values, as_stored=_as_written(one)) for name, one in (each or {"": mission}).items()
    }
    mission = fit_flight(mission, arguments, values, next(iter(sources.values())).grid)
    each = mission.missions_by_imagery
    plans = {name: _plan_mission(each.get(name, mission), values, source) for name, source in sources.items()}
    _print_lacks(next(iter(plans.values())))
    files: list[str] = []
    for path, ending in endings.items():
        if ending == _MISSION:
            mission.save(path)
            files.append(path)
        else:
            files += _write_plans(plans, path)
    if arguments.profile is not None:
        # Several imageries share one flight.
        files.append(_write_profile(next(iter(plans.values())), arguments.profile))
    if arguments.to_vehicle is not None:
        _upload(next(iter(plans.values())), arguments.to_vehicle, arguments.sortie)
    if arguments.json:
        figures = {name: _figures(plan, sources[name], values) for name, plan in plans.items()}
        print(json.dumps({**({"imageries": figures} if each else figures[""]), "written": files}, indent=1))
        return DONE
    for number, (name, planned) in enumerate(plans.items()):
        if each:
            print("\n" * bool(number) + printable(f"{'imagery':24s}{name}"))
        _print_figures(planned, sources[name], values)
    for file in files:
        print(printable(f"{'written':24s}{file}"))
    return DONE


def _write_profile(planned: Plan, path: str) -> str:
    """Write a height profile, print its least clearance, and return the file."""
    from ..report.heights import least_clearance, write_profile

    note = least_clearance(write_profile(planned, path))
    if note:
        print(printable(f"{path}: {note}"), file=sys.stderr)
    return path


def _plan_joined(arguments: argparse.Namespace) -> int:
    """Plan several missions as one flight; print its figures and write its files."""
    from ..mission.flight.joined import join_plans, summarize

    for path in arguments.output:
        _ending(path)
    if arguments.align is not None:
        raise InvalidInput("one flight of several missions: align the rows of each mission in its file")
    plans: list[Plan] = []
    names, heights = [], None
    for file in (arguments.mission_file, *arguments.more_missions):
        one = argparse.Namespace(**{**vars(arguments), "mission_file": file})
        mission, values = mission_settings(one)
        # Several imageries share one flight.
        mission = mission.of_first_imagery
        plans.append(_plan_mission(mission, values, mission_source(mission, values, as_stored=_as_written(mission))))
        names.append(Path(file).stem)
        heights = heights or requested_heights(mission, values)
    joined = join_plans(plans, names, heights)
    files = [file for path in arguments.output for file in _write_plans({"": joined}, path)]
    if arguments.profile is not None:
        files.append(_write_profile(joined, arguments.profile))
    if arguments.to_vehicle is not None:
        _upload(joined, arguments.to_vehicle, arguments.sortie)
    summary = summarize(joined, names)
    if arguments.json:
        print(json.dumps({**summary.to_dict(), "written": files}, indent=1))
        return DONE
    for label, text in (*summary.lines(), *(("written", file) for file in files)):
        print(printable(f"{label:24s}{text}"))
    return DONE


def _upload(planned: Plan, address: str, sortie: int | None) -> None:
    """Upload a flight to a vehicle, and print notes; several imageries share one flight."""
    from ..mission.export import plan_texts
    from ..mission.export.vehicle import upload, vehicle_text

    texts, notes = plan_texts(planned)
    count = upload(vehicle_text(texts, sortie), address)
    for note in (*notes, f"{count:,} items uploaded"):
        print(printable(f"{address}: {note}"), file=sys.stderr)


def _ending(path: str, *more: str) -> str:
    """Ending of a plan file; other endings than of plan formats and ``more`` are refused."""
    from ..mission.export import check_plan_ending

    return check_plan_ending(path, *more)


def _write_plans(plans: Mapping[str, Plan], path: str) -> list[str]:
    """Write the plan of each imagery, print notes, and return the files."""
    from ..mission.export import write_plan

    files: list[str] = []
    for name, planned in plans.items():
        target = _imagery_path(path, name)
        exported = write_plan(planned, target)
        files += map(str, exported.files)
        for note in exported.notes:
            print(printable(f"{target}: {note}"), file=sys.stderr)
        if exported.replaced:
            names = ", ".join(file.name for file in exported.replaced)
            print(printable(f"{target}: replaced {names}"), file=sys.stderr)
    return files


def _imagery_path(path: str, name: str) -> str:
    """File of one imagery: ``plan-NAME.csv`` for ``plan.csv``; unchanged if the name is empty."""
    ending = _ending(path)
    return f"{path[: -len(ending)]}-{name}{ending}" if name else path


class Bar:
    """Progress on one line of the error output, if that is a terminal."""

    def __init__(self, quiet: bool) -> None:
        self._live, self._shown = not quiet and sys.stderr.isatty(), False

    def __call__(self, progress: Progress) -> None:
        """Show the progress of a capture."""
        if not self._live:
            return
        finished = progress.done + progress.failed + progress.skipped
        share = finished / progress.total if progress.total else 1.0
        rate = progress.done / max(progress.active_s, 1e-3)
        failed = f", {progress.failed} failed" if progress.failed else ""
        self.show(progress.map_type, share, f"{finished}/{progress.total}{failed}, {rate:.0f}/s")

    def show(self, title: str, share: float, text: str) -> None:
        """Show a bar for a share, 0 to 1."""
        if self._live:
            self._shown = True
            line = f"{title:10s}[{'#' * int(30 * share):30s}] {text}"
            self._print(f"\r{line:78s}", end="")

    def close(self) -> None:
        """End the line."""
        if self._live and self._shown:
            self._print()

    def _print(self, text: str = "", end: str = "\n") -> None:
        try:
            print(text, end=end, file=sys.stderr, flush=True)
        except OSError:
            # The terminal was closed; the run goes on.
            self._live = False


def run_capture(arguments: argparse.Namespace) -> int:
    """Capture a mission into a folder."""
    return capture_mission(*mission_settings(arguments), arguments)


def capture_mission(mission: Mission, values: dict[str, Any], arguments: argparse.Namespace) -> int:
    """Capture a mission into a folder, and print the result."""
    if not values["data_dir"]:
        # Probably an unset variable of the shell, which must not mean the current folder.
        raise InvalidInput("data folder '': must be the name of a folder, such as . for the current one")
    each = mission.missions_by_imagery or {"": mission}
    in_blocks = bool(arguments.cluster or arguments.block or arguments.layout_of_files != FOLDERS)
    in_blocks = in_blocks or is_address(values["data_dir"])
    with ExitStack() as opened, collect_signals() as signals:
        sources: dict[str, Source | NamedSource] = {}
        for name, one in each.items():
            if in_blocks:
                sources[name] = mission_source(one, values, open_cache(values), as_stored=_as_written(one))
            else:
                sources[name] = opened.enter_context(open_mission_source(one, values, as_stored=_as_written(one)))
        mission = fit_flight(mission, arguments, values, next(iter(sources.values())).grid)
        each = mission.missions_by_imagery or {"": mission}
        with cancellable(lambda: bool(signals)):
            engine = _engine(arguments, opened)
        result = _run(mission, each, sources, values, arguments, lambda: bool(signals), engine, in_blocks=in_blocks)
    if in_blocks and not result.cancelled and result.written + result.skipped:
        _describe(values["data_dir"])
    _print_result(result, arguments.json)
    if result.cancelled:
        print("terrainav: stopped; finished images are kept, continue with --resume", file=sys.stderr)
        return exit_code(signals[0])
    return INCOMPLETE if result.failed else DONE


def _engine(arguments: argparse.Namespace, opened: ExitStack) -> Engine | None:
    """Open the cluster, if one is named, and print the address of its dashboard."""
    if arguments.cluster is None:
        return None
    from ..capture.blocks.engines import open_engine

    engine = opened.enter_context(open_engine(arguments.cluster))
    shown = f"; dashboard at {engine.dashboard}" if engine.dashboard else ""
    print(f"cluster of {engine.slots()} workers{shown}", file=sys.stderr)
    return engine


def _describe(place: str) -> None:
    """Describe a dataset as STAC items in one table."""
    from importlib.util import find_spec

    if find_spec("pyarrow") is None:
        print("no items.parquet: the Python package pyarrow is not installed", file=sys.stderr)
        return
    from ..exports.kinds import export_as

    export_as(place, None, "stac")


def _blocks(arguments: argparse.Namespace, planned: Plan, source: NamedSource, values: Any) -> Blocks:
    """Division of a plan into blocks."""
    from ..capture.blocks.division import parse_block_size
    from ..capture.blocks.running import Blocks

    def image_bytes() -> float:
        summary = _summary(planned, source, values)
        return summary.output_bytes / max(summary.images, 1)

    images = IMAGES if arguments.block is None else parse_block_size(arguments.block, image_bytes)
    return Blocks(images, arguments.layout_of_files)


def _run(
    mission: Mission,
    each: Mapping[str, Mission],
    sources: Mapping[str, Any],
    values: dict[str, Any],
    arguments: argparse.Namespace,
    cancelled: Callable[[], bool],
    engine: Engine | None,
    *,
    in_blocks: bool,
) -> CaptureResult:
    from ..capture.progress import Listener
    from ..capture.runner import capture
    from ..capture.several import capture_imageries
    from ..imagery.catalogue import shared_requests

    plans = {name: _plan_mission(one, values, sources[name]) for name, one in each.items()}
    needed = shared_requests([(sources[name], _requests(one)) for name, one in plans.items()])
    for (name, planned), requests in zip(plans.items(), needed):
        _check_terms(planned, sources[name], requests, arguments.accept_terms)
    _print_lacks(next(iter(plans.values())))
    bar = Bar(arguments.quiet)
    options: Any = {
        "connections": values["connections"],
        "resume": arguments.resume,
        "only_failed": arguments.only_failed,
        "listener": Listener(
            progress=bar,
            cancelled=cancelled,
            notice=lambda text: print(printable(str(text)), file=sys.stderr),
        ),
        "executor": engine,
    }
    if in_blocks:
        name = next(iter(plans))
        options["blocks"] = _blocks(arguments, plans[name], sources[name], values)
    try:
        if mission.imagery.imageries:
            result = capture_imageries(mission, plans, sources, values["data_dir"], **options)
        else:
            result = capture(plans[""], sources[""], values["data_dir"], **options)
    finally:
        bar.close()
    for name, source in sources.items():
        if not source.map_types:
            kinds = ", ".join(each[name].imagery.map_types)
            print(
                f"{printable(source.title)} has one kind of image; it is written as {kinds}",
                file=sys.stderr,
            )
    return result


def _print_lacks(planned: Plan) -> None:
    """Print what files of labels and buildings lack, which other missions need not open."""
    if planned.mission.labels.labels:
        _print_left_out(planned)
    if planned.mission.terrain.buildings and not planned.relief.is_level:
        _print_unread(planned)


def _print_left_out(planned: Plan) -> None:
    """Print the numbers of features of labels that were repaired, left out, or have no value."""
    from ..picture.labels import plan_labels

    labels = plan_labels(planned)
    for layer in labels.layers:
        source = layer.source
        for count, what in (
            (source.repaired, "features repaired, as they cross themselves"),
            (source.dropped, "features left out, as they are empty or have no area or length"),
        ):
            if count:
                print(printable(f"labels {layer.name}: {what}: {count:,}"), file=sys.stderr)
    if labels.classes.unlabelled:
        print(
            f"labels: features without a value, whose pixels are ignore: {labels.classes.unlabelled:,}", file=sys.stderr
        )


def _print_unread(planned: Plan) -> None:
    """Print what of the buildings in view could not be read or placed."""
    from ..faces.buildings import FootprintBuildings

    faces = planned.relief.heights.faces
    for model in getattr(faces, "models", (faces,)):
        if not isinstance(model, FootprintBuildings):
            continue
        counts = model.counts
        unread = [
            (count, f"values of {name} that cannot be read, such as {counts.examples[name][0]!r}")
            for name, count in sorted(counts.unread.items())
        ]
        for count, what in (
            (counts.by_default, f"buildings without height, {model.options.default_height_m:g} m instead"),
            (counts.without_ground, "buildings left out, as there is no ground below"),
            (counts.not_solid, "buildings left out, as they have no area"),
            (sum(counts.unknown_roofs.values()), "buildings with unknown shapes of roofs"),
            *unread,
        ):
            if count:
                print(printable(f"buildings {model.title}: {what}: {count:,}"), file=sys.stderr)


def _print_result(result: CaptureResult, as_json: bool) -> None:
    if as_json:
        print(json.dumps({"total": result.total, **result_document(result, "map_type")}, indent=1))
        return
    print_written(result)
    requests = f"{result.requests:,} requests for {result.unique_parts:,} unique parts"
    print(printable(f"{requests}; dataset in {result.folder}"))
    print_failed(result.failed, result.folder)
    print_repeated(result.repeated)


def result_document(result: CaptureResult | PairResult, kind: str) -> dict[str, Any]:
    """Result of a capture as JSON data; ``kind`` is the key of the map type."""
    return {
        "folder": str(result.folder),
        "written": result.written,
        "skipped": result.skipped,
        "failed": [{kind: one.map_type, "name": one.name, "reason": one.reason} for one in result.failed],
        "requests": result.requests,
        "unique_parts": result.unique_parts,
        "seconds": result.seconds,
        "cancelled": result.cancelled,
        "repeated": [
            {kind: one.map_type, "sha256": one.sha256, "places": one.places, "images": one.images}
            for one in result.repeated
        ],
    }


def print_written(result: CaptureResult | PairResult) -> None:
    """Print the numbers of images written and failed, and the rate."""
    rate = result.written / result.seconds if result.seconds > 0 else 0.0
    already = f", {result.skipped:,} already there" if result.skipped else ""
    print(
        f"{result.written:,} images written{already}, {len(result.failed):,} failed, "
        f"in {result.seconds:.1f} s ({rate:.1f}/s)"
    )


def print_failed(failed: Sequence[Failure], named_in: Path) -> None:
    """Print the first failed images, and the place of the whole list."""
    for failure in failed[:NAMED_FAILURES]:
        print(printable(f"failed: {failure.map_type}/{failure.name}: {failure.reason}"), file=sys.stderr)
    if len(failed) > NAMED_FAILURES:
        print(f"failed: {len(failed) - NAMED_FAILURES:,} more, listed in {named_in}", file=sys.stderr)


def print_repeated(repeated: Sequence[Repeat]) -> None:
    """Print files that a provider sent for places far apart, with the option to treat a file as missing imagery."""
    for repeat in repeated:
        named = f", such as {repeat.images[0]}" if repeat.images else ""
        print(
            f"same tile: {repeat.map_type} has the same file in {repeat.places:,} places, shown by "
            f"{len(repeat.images):,} images{named}. It may be water or snow; if it shows no imagery, treat it as "
            f"missing: --resume --placeholder {repeat.sha256}",
            file=sys.stderr,
        )


def _say(what: str) -> None:
    print(f"measuring: {what}", file=sys.stderr)


def run_report(arguments: argparse.Namespace) -> int:
    """Measure a mission's error against run time, or the sharpness of an image."""
    if arguments.mtf is not None:
        return _print_sharpness(arguments.mtf)
    from ..report.page import write_report

    mission, values = mission_settings(arguments)
    # Errors are measured on 8-bit images, as displayed.
    with open_mission_source(mission, values, as_stored=False) as source:
        mission = fit_flight(mission, arguments, values, source.grid)
        planned = _plan_mission(mission, values, source)
        # A report measures only a few images, which take at most 200 requests.
        _check_terms(planned, source, 200, arguments.accept_terms)
        page = write_report(planned, source, arguments.output, progress=_say)
    print(printable(f"report in {page}"))
    return DONE


def _print_sharpness(path: str) -> int:
    """Print the contrast by spatial frequency of an image of an edge."""
    from ..report.sharpness import edge_response, image_light

    found = edge_response(image_light(path))
    print(f"MTF50 {found.mtf50:.4f} cycles/px, edge slanted by {found.slant_deg:.2f} deg")
    for frequency in (step / 20.0 for step in range(1, 11)):
        print(f"{frequency:.2f} cycles/px  contrast {found.contrast_at(frequency):.3f}")
    return DONE
