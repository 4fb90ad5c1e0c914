"""Cross-view pairs on the command line."""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import ExitStack, closing
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from ..storage.files import file_exists
from ..text.plain import printable
from .dataset_options import shared_options
from .exits import DONE, INCOMPLETE, exit_code
from .flying import (
    NAMED_FAILURES,
    SOURCE_WAS_NAMED,
    Bar,
    names_source,
    print_failed,
    print_repeated,
    print_written,
    requested_source,
    result_document,
)
from .listing import open_cache
from .stopping import collect_signals

if TYPE_CHECKING:
    from ..geodesy.mercator import PixelGrid
    from ..imagery.cache.tile_cache import TileCache
    from ..imagery.opening import NamedSource
    from ..imagery.source import Source
    from ..mission.relief.ground import Heights
    from ..pairs.capturing import PairResult
    from ..pairs.places import PairPlace
    from ..pairs.planning import PairPlan, PairSettings
    from ..pairs.views import PairView


def run_pairs(arguments: argparse.Namespace) -> int:
    """Capture pairs into a folder."""
    from ..imagery.opening import SourceOptions
    from ..mission.settings import resolve
    from ..pairs.planning import DRONE
    from ..pairs.sheet import check_sheet, contact_sheet
    from ..picture.heights import landscape_crs, terrain_heights

    if not arguments.data_dir and not arguments.dry_run:
        # An empty name is probably an unset variable of the shell, which must not mean the current folder.
        raise InvalidInput("no folder for the pairs: give --data-dir, such as . for the current one")
    if arguments.sheet is not None:
        check_sheet(arguments.sheet)
    given = {option.name: getattr(arguments, option.name) for option in shared_options()}
    values = {**resolve(given, config=arguments.config), SOURCE_WAS_NAMED: names_source(arguments)}
    settings = _settings(arguments, values)
    places = _places(arguments, settings)
    sources = _sources(settings, values, None if arguments.dry_run else open_cache(values))
    options = SourceOptions(
        seed=settings.seed,
        crs=landscape_crs(settings.view_imagery(DRONE).source, settings.crs),
        connections=values["connections"],
        cache=open_cache(values) if settings.terrain.elevation else None,
        named_by_user=values[SOURCE_WAS_NAMED],
    )
    heights = terrain_heights(settings.terrain, options)
    if arguments.dry_run:
        grids = {view: source.grid for view, source in sources.items()}
        _print_plan(_plan(places, settings, grids, heights), arguments.json)
        return DONE
    with ExitStack() as stack, collect_signals() as signals:
        opened = {view: stack.enter_context(closing(source.open())) for view, source in sources.items()}
        planned = _plan(places, settings, {view: one.grid for view, one in opened.items()}, heights)
        result = _capture(planned, opened, arguments, values, signals)
    _print_result(planned, result, arguments.json)
    if result.cancelled:
        print("terrainav: stopped; finished images are kept, continue with --resume", file=sys.stderr)
        return exit_code(signals[0])
    if arguments.sheet is not None and len(result.left_out) < len(places):
        contact_sheet(result.folder, arguments.sheet)
    return INCOMPLETE if result.failed or result.left_out else DONE


def _sources(settings: PairSettings, values: dict[str, Any], cache: TileCache | None) -> dict[str, NamedSource]:
    """Source of the satellite, and of the drone if its imagery differs."""
    from ..pairs.planning import DRONE, SATELLITE

    asked = [settings.view_imagery(view) for view in (SATELLITE, DRONE)[: 1 + settings.two_imageries]]
    return {
        one.name: requested_source(
            replace(settings, source=one.source, date=one.date, map_type=one.map_type, imageries=()),
            {**values, SOURCE_WAS_NAMED: values[SOURCE_WAS_NAMED] or one in settings.imageries},
            cache,
        )
        for one in asked
    }


def _plan(
    places: tuple[PairPlace, ...],
    settings: PairSettings,
    grids: dict[str, PixelGrid],
    heights: Heights | None,
) -> PairPlan:
    from ..pairs.planning import DRONE, SATELLITE, plan_pairs

    return plan_pairs(places, settings, grids[SATELLITE], heights, drone_grid=grids.get(DRONE))


def _settings(arguments: argparse.Namespace, values: dict[str, Any]) -> PairSettings:
    from ..geodesy.camera import Camera
    from ..mission.cameras import camera_named
    from ..mission.imageries import named_imageries
    from ..mission.parts import Terrain
    from ..pairs.planning import DEFAULT_SIZE_PX, PairSettings

    (map_type,) = values["map_type"] if len(values["map_type"]) == 1 else (None,)
    if map_type is None:
        raise InvalidInput("map types {0}: pairs are of one", " ".join(values["map_type"]))
    if values["camera"] is not None and values["fov"] is not None:
        raise InvalidInput("camera {0!r} and fov {1:g}: give one of the two", values["camera"], values["fov"])
    fov_deg = Camera.fov_deg if values["fov"] is None else values["fov"]
    more: dict[str, Any] = {} if arguments.split is None else {"shares": tuple(arguments.split)}
    return PairSettings(
        views=_views(arguments),
        camera=Camera(fov_deg, 1.0) if values["camera"] is None else camera_named(values["camera"]).camera,
        size_px=DEFAULT_SIZE_PX if arguments.size is None else arguments.size,
        satellite_m=arguments.satellite_m,
        source=values["source"],
        map_type=map_type,
        date=values["date"] or "",
        crs=values["crs"] or "",
        imageries=named_imageries(values["imagery"] or ()),
        seed=values["seed"],
        gap_m=arguments.gap,
        allow_shared_ground=arguments.allow_shared_ground,
        upsample=values["upsample"],
        ground_height_m=values["ground_height"],
        error_budget_px=values["error_budget"],
        accept_error=values["accept_error"],
        resampling=values["resampling"],
        terrain=Terrain(
            elevation=tuple(values["elevation"] or ()),
            surface=tuple(values["surface"] or ()),
            vertical_datum=values["vertical_datum"],
            height_unit=values["height_unit"],
            height_offset_m=values["height_offset"],
            holes=values["holes"],
        ),
        **more,
    )


def _views(arguments: argparse.Namespace) -> tuple[PairView, ...]:
    from ..pairs.views import DEFAULT_TILT_DEG, HEIGHTS_M, ROUNDS, VIEWS, rings, spiral

    heights, tilts = arguments.heights or HEIGHTS_M, arguments.tilt or (DEFAULT_TILT_DEG,)
    if arguments.yaws is not None:
        if arguments.rounds is not None:
            raise InvalidInput("--yaws and --rounds: rings have no rounds", remedy="give --views for a spiral")
        return rings(heights, arguments.yaws, tilts)
    count = VIEWS if arguments.views is None else arguments.views
    rounds = min(ROUNDS, count) if arguments.rounds is None else arguments.rounds
    return spiral(heights, count, rounds, tilts)


def _places(arguments: argparse.Namespace, settings: PairSettings) -> tuple[PairPlace, ...]:
    from ..pairs.places import read_box, read_places
    from ..pairs.planning import places_in_box

    text = arguments.places
    if file_exists(text):
        if arguments.count is not None or arguments.spacing is not None:
            option = "count" if arguments.count is not None else "spacing"
            raise InvalidInput("--{0} and the file {1}: it is for places of a box", option, text)
        return read_places(text)
    box = read_box(text)
    if arguments.count is None:
        raise InvalidInput("box {0!r}: needs a number of places, --count", text)
    return places_in_box(box, arguments.count, settings, arguments.spacing)


def _capture(
    planned: PairPlan,
    sources: dict[str, Source],
    arguments: argparse.Namespace,
    values: dict[str, Any],
    signals: list[int],
) -> PairResult:
    from ..capture.progress import Listener
    from ..imagery.catalogue import check_policy, shared_requests
    from ..pairs.capturing import capture_pairs
    from ..pairs.planning import DRONE, SATELLITE

    needed = shared_requests(
        [
            (source, planned.count_requests(view) if len(sources) > 1 else planned.requests)
            for view, source in sources.items()
        ]
    )
    for (view, source), requests in zip(sources.items(), needed):
        check_policy(
            source,
            requests,
            accept_terms=arguments.accept_terms,
            map_types=(planned.settings.view_imagery(view).map_type,),
            bounds_deg=planned.bounds_deg,
        )
    bar = Bar(arguments.quiet)
    try:
        return capture_pairs(
            planned,
            sources[SATELLITE],
            arguments.data_dir,
            drone_source=sources.get(DRONE),
            connections=values["connections"],
            resume=arguments.resume,
            listener=Listener(progress=bar, cancelled=lambda: bool(signals)),
        )
    finally:
        bar.close()


def _counts(planned: PairPlan) -> str:
    counts = planned.counts
    ground = "ground is seen in two parts" if planned.ground_shared else "no ground is seen in two parts"
    return f"{counts['train']:,} to train, {counts['test']:,} to test, {counts['distractor']:,} distractors; {ground}"


def _print_plan(planned: PairPlan, as_json: bool) -> None:
    if as_json:
        print(json.dumps({**_figures(planned), "requests": planned.requests}, indent=1))
        return
    views = len(planned.settings.views)
    print(f"places      {len(planned.places):,}: {_counts(planned)}")
    print(f"images      {planned.images:,}: for each place 1 of the satellite and {views:,} of the drone")
    print(f"satellite   {planned.settings.satellite_width_m:,.1f} m wide")
    print(f"views reach {planned.reach_m:,.0f} m from their place")
    print(f"requests    {planned.requests:,}")


def _figures(planned: PairPlan) -> dict[str, Any]:
    return {
        "places": planned.counts,
        "ground_shared": planned.ground_shared,
        "images": planned.images,
    }


def _print_result(planned: PairPlan, result: PairResult, as_json: bool) -> None:
    if as_json:
        document = {**result_document(result, "capture"), **_figures(planned), "left_out": list(result.left_out)}
        print(json.dumps(document, indent=1))
        return
    print_written(result)
    print(f"{len(planned.places):,} places: {_counts(planned)}")
    requests = f"{result.requests:,} requests for {result.unique_parts:,} unique parts"
    print(printable(f"{requests}; pairs in {result.folder}"))
    print_failed(result.failed, result.folder / "pairs.csv")
    print_repeated(result.repeated)
    if result.left_out:
        shown = ", ".join(result.left_out[:NAMED_FAILURES])
        rest = len(result.left_out) - NAMED_FAILURES
        print(
            f"left out, as views are missing: {shown}" + (f" and {rest:,} more" if rest > 0 else ""),
            file=sys.stderr,
        )
