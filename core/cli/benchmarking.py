"""Make, run and score benchmarks on the command line."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from ..mission.options import OPTIONS
from ..mission.parts import AUTO
from ..text.plain import printable, writable
from .exits import DONE, INCOMPLETE, exit_code
from .flying import (
    SOURCE_WAS_NAMED,
    Bar,
    names_source,
    print_failed,
    print_repeated,
    print_written,
    requested_heights,
    requested_source,
    result_document,
)
from .listing import open_cache
from .stopping import collect_signals

if TYPE_CHECKING:
    from ..benchmark.folder import Benchmark
    from ..benchmark.making import BenchmarkResult
    from ..benchmark.planning import BenchmarkPlan, BenchmarkSettings
    from ..benchmark.scoring import Figure
    from ..imagery.source import Source
    from ..mission.imageries import NamedImagery


def run_benchmark(arguments: argparse.Namespace) -> int:
    """Make a benchmark, run a method over it, or score predictions."""
    actions = {"make": _make, "run": _run, "score": _score}
    if arguments.action is None:
        raise InvalidInput("benchmark: needs one of {0}", ", ".join(actions))
    return actions[arguments.action](arguments)


def _make(arguments: argparse.Namespace) -> int:
    from ..benchmark.planning import plan_benchmark

    values, settings = _settings(arguments)
    if not values["data_dir"]:
        raise InvalidInput("data folder '': must be the name of a folder, such as . for the current one")
    with ExitStack() as stack, collect_signals() as signals:
        sources = {
            str(imagery): stack.enter_context(closing(_open_source(imagery, settings, values)))
            for imagery in {str(one): one for one in (settings.reference, *settings.imageries)}.values()
        }
        grids = {name: source.grid for name, source in sources.items()}
        planned = plan_benchmark(settings, grids, requested_heights(settings.queries, values))
        if arguments.dry_run:
            _print_plan(planned)
            return DONE
        made = _make_benchmark(planned, sources, arguments, values, signals)
    _print_made(made, arguments.json)
    if made.benchmark is None:
        print("terrainav: stopped; finished images are kept, continue with --resume", file=sys.stderr)
        return exit_code(signals[0])
    return INCOMPLETE if made.total.failed else DONE


def _settings(arguments: argparse.Namespace) -> tuple[dict[str, Any], BenchmarkSettings]:
    from ..benchmark.planning import BenchmarkSettings
    from ..mission.imageries import NamedImagery, named_imageries
    from ..mission.settings import build_mission, resolve

    given = {option.name: getattr(arguments, option.name) for option in OPTIONS}
    values = {**resolve(given, config=arguments.config), SOURCE_WAS_NAMED: names_source(arguments)}
    if values["airspeed"] == AUTO:
        raise InvalidInput("airspeed auto: must be a number for a benchmark", field="airspeed_m_per_s")
    more: dict[str, Any] = {} if arguments.shares is None else {"shares": tuple(arguments.shares)}
    return values, BenchmarkSettings(
        build_mission({**values, "imagery": None}),
        named_imageries(arguments.queries),
        NamedImagery.parse(arguments.reference),
        tile_widths_m=tuple(arguments.tiles or ()),
        tile_overlap=arguments.tile_overlap,
        margin_m=arguments.reference_margin,
        positive_iou=arguments.positive,
        semi_positive_iou=arguments.semi_positive,
        split=arguments.split,
        gap_m=arguments.gap,
        inside=arguments.inside,
        reference_buildings=tuple(arguments.reference_buildings),
        **more,
    )


def _open_source(imagery: NamedImagery, settings: BenchmarkSettings, values: dict[str, Any]) -> Source:
    from ..mission.sunlight import mission_sun

    mission = settings.queries.select_imagery(imagery)
    asked = mission.imagery
    return requested_source(
        asked,
        {**values, SOURCE_WAS_NAMED: True},
        open_cache(values),
        sun=mission_sun(mission),
        area_deg=mission.area.bounds.edges_deg,
        bands=asked.bands,
        stretch=asked.stretch,
        as_stored=mission.output.image_format == "tif",
    ).open()


def _make_benchmark(
    planned: BenchmarkPlan,
    sources: dict[str, Source],
    arguments: argparse.Namespace,
    values: dict[str, Any],
    signals: list[int],
) -> BenchmarkResult:
    from ..benchmark.making import make_benchmark
    from ..capture.progress import Listener
    from ..imagery.catalogue import check_policy, shared_requests

    captures = [(imagery, sources[str(imagery)], plan) for imagery, plan in planned.captures.values()]
    needed = shared_requests([(source, plan.requests) for _, source, plan in captures])
    for (imagery, source, _), requests in zip(captures, needed):
        check_policy(
            source,
            requests,
            accept_terms=arguments.accept_terms,
            map_types=(imagery.map_type,),
            bounds_deg=planned.settings.queries.area.bounds.edges_deg,
        )
    bar = Bar(arguments.quiet)
    try:
        return make_benchmark(
            planned,
            sources,
            values["data_dir"],
            connections=values["connections"],
            resume=arguments.resume,
            listener=Listener(progress=bar, cancelled=lambda: bool(signals)),
        )
    finally:
        bar.close()


def _print_plan(planned: BenchmarkPlan) -> None:
    for folder, (imagery, plan) in planned.captures.items():
        size = f"{int(plan.frames.width_px.max()):,} x {int(plan.frames.height_px.max()):,} px"
        images = f"{len(plan):,} image{'s' * (len(plan) > 1)} of {size}"
        print(printable(f"{folder:28s}{images}, {plan.requests:,} requests, {imagery}"))
    if planned.left_out:
        print(f"{planned.left_out:,} queries of each imagery left out, which see beyond the imagery")


def _print_made(made: BenchmarkResult, as_json: bool) -> None:
    total = made.total
    if made.hint is not None:
        print(f"terrainav: {made.hint}", file=sys.stderr)
    if as_json:
        print(json.dumps({**result_document(total, "folder_in"), **_counts(made.benchmark)}, indent=1))
        return
    print_written(total)
    print_failed(total.failed, total.folder)
    print_repeated(total.repeated)
    if made.benchmark is not None:
        for name, text in _counts(made.benchmark).items():
            print(f"{name:24s}{text}")
        print(printable(f"benchmark in {made.folder}"))


def _counts(benchmark: Benchmark | None) -> dict[str, Any]:
    if benchmark is None:
        return {}
    positives = benchmark.positives()
    counts: dict[str, Any] = {
        "queries": len(benchmark.queries),
        "tiles": len(benchmark.references),
        "queries without a tile": sum(not len(one) for one in positives),
    }
    tile_parts = benchmark.references.part
    for part, queries in benchmark.queries_of_parts.items():
        counts[part] = f"{queries:,} queries" + (f", {tile_parts.count(part):,} tiles" if any(tile_parts) else "")
    return counts


def _run(arguments: argparse.Namespace) -> int:
    from ..benchmark.folder import Benchmark
    from ..benchmark.running import method_named, prediction_file, run_method

    benchmark = Benchmark.read(arguments.folder)
    method = method_named(arguments.method)
    target = _target(arguments, benchmark, arguments.method)
    live = not arguments.quiet and sys.stderr.isatty()

    def show(done: int, total: int) -> None:
        if live:
            print(f"\r{done:,} of {total:,} queries", end="", file=sys.stderr, flush=True)

    with collect_signals() as signals:
        predictions = run_method(
            benchmark, method, arguments.part or "", progress=show, cancelled=lambda: bool(signals)
        )
    if live:
        print(file=sys.stderr)
    if predictions is None:
        print("terrainav: stopped; nothing was written", file=sys.stderr)
        return exit_code(signals[0])
    from ..storage.files import make_folder

    make_folder(target)
    written = prediction_file(target, arguments.method)
    predictions.write(written, benchmark)
    print(f"predictions in {printable(str(written))}", file=sys.stderr)
    return _report_scores(arguments, benchmark, predictions, arguments.method, target)


def _score(arguments: argparse.Namespace) -> int:
    from ..benchmark.answers import Predictions
    from ..benchmark.folder import Benchmark
    from ..sequences.files import sequence_file

    if sequence_file(arguments.folder) is not None:
        return _score_sequence(arguments)
    benchmark = Benchmark.read(arguments.folder)
    predictions = Predictions.read(arguments.predictions, benchmark)
    name = writable(Path(arguments.predictions).stem)
    return _report_scores(arguments, benchmark, predictions, name, _target(arguments, benchmark, name))


def _score_sequence(arguments: argparse.Namespace) -> int:
    """Score predictions for the frames of a sequence."""
    from ..benchmark.page import figures_document
    from ..benchmark.sequences import score_sequence

    for name in ("part", "output"):
        if getattr(arguments, name) is not None:
            raise InvalidInput("--{0}: is for benchmarks, and not for sequences", name)
    groups = {"frames": score_sequence(arguments.folder, arguments.predictions)}
    if arguments.json:
        print(json.dumps(figures_document(groups)["frames"], indent=1))
    else:
        _print_figures(groups)
    return DONE


def _target(arguments: argparse.Namespace, benchmark: Benchmark, name: str) -> Path:
    from ..benchmark.running import scores_folder

    if arguments.output is not None:
        return Path(arguments.output)
    return scores_folder(benchmark.folder, name, arguments.part or "")


def _report_scores(
    arguments: argparse.Namespace, benchmark: Benchmark, predictions: Any, title: str, target: Path
) -> int:
    from ..benchmark.page import scores_document, write_scores
    from ..benchmark.scoring import score

    scores = score(benchmark, predictions, arguments.part or "")
    page = None if arguments.no_page else write_scores(benchmark, scores, target, title)
    if arguments.json:
        print(json.dumps(scores_document(scores, title), indent=1))
        return DONE
    _print_figures(scores.groups)
    if page is not None:
        print(f"page in {printable(str(page))}")
    return DONE


def _print_figures(groups: Mapping[str, Sequence[Figure]]) -> None:
    from ..benchmark.page import figure_rows

    rows = [("", *groups, ""), *figure_rows(groups)]
    widths = [max(len(row[at]) for row in rows) for at in range(len(rows[0]) - 1)]
    for row in rows:
        cells = (cell.rjust(width) if at else cell.ljust(width) for at, (cell, width) in enumerate(zip(row, widths)))
        print(printable("  ".join([*cells, row[-1]]).rstrip()))
