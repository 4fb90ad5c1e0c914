"""Cross-view pairs on the command line."""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import closing
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from ..files import is_there
from ..geodesy.lens import Lens
from ..map_types import MAP_TYPES
from ..mission.options import OPTIONS, Option
from .caching import opened_cache
from .exits import DONE, INCOMPLETE, exit_code
from .flying import NAMED_FAILURES, Bar, print_failed, print_repeated, print_written
from .parsing import add_json, names_source
from .stopping import collected

if TYPE_CHECKING:
    from ..imagery.source import Source
    from ..pairs.capturing import PairResult
    from ..pairs.places import Place
    from ..pairs.planning import PairPlan, PairSettings
    from ..pairs.views import View

#: Options of missions that a set of pairs has as well, from the command line, the environment or a file.
_SHARED = (
    *(
        "source",
        "map_type",
        "date",
        "crs",
        "seed",
        "camera",
        "fov",
        "upsample",
        "ground_height",
        "error_budget",
    ),
    *("accept_error", "resampling", "connections", "placeholder", "cache_dir", "cache_limit", "no_cache"),
)
_HELP = """
PLACES is a file of lines `lat lon` or `lat lon name` (the paper's `lat lon agl` too, whose heights are not used), or
a box "latTL_lonTL_latBR_lonBR" with --count; write a box that begins with a minus with spaces: "-33.8 18.4 -34.0 18.7".
Without --heights, --yaws and --views the drone flies as in University-1652: 54 views along three rounds that fall from
256 to 121.5 m. Its camera looks at the place from every view.
"""


def add_pairs(commands: Any) -> None:
    """Add the parser of ``terrainav pairs``."""
    command = commands.add_parser(
        "pairs",
        help="capture places from a satellite and a drone, laid out as University-1652",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.add_argument("places", metavar="PLACES", help="file of places, or a box with --count")
    command.add_argument("--data-dir", metavar="OUT", help="folder of the pairs")
    where = command.add_argument_group("places of a box")
    where.add_argument("--count", type=int, metavar="N", help="places to spread over the box, by the seed")
    where.add_argument(
        "--spacing",
        type=float,
        metavar="M",
        help="least distance between them (default: no two see the same ground)",
    )
    _add_views(command.add_argument_group("views"))
    parts = command.add_argument_group("parts")
    parts.add_argument(
        "--split",
        nargs=3,
        type=float,
        metavar=("TRAIN", "TEST", "DISTRACTORS"),
        help="places of each part, relative to their sum (default 701 701 250); distractors are in galleries only",
    )
    parts.add_argument(
        "--gap",
        type=float,
        default=0.0,
        metavar="M",
        help="ground left between what is seen in two parts (0)",
    )
    parts.add_argument(
        "--allow-shared-ground",
        action="store_true",
        help="share places out one by one, even where the same ground is seen in two parts",
    )
    _add_shared(
        command.add_argument_group("imagery and camera", "each also in the environment or config.json")
    )
    command.add_argument("--config", metavar="FILE", help="JSON file of options (config.json if it is there)")
    command.add_argument("--resume", action="store_true", help="go on with what is missing or has failed")
    command.add_argument("--dry-run", action="store_true", help="print what would be captured; fetch nothing")
    command.add_argument(
        "--sheet",
        metavar="FILE.jpg",
        help="also draw a contact sheet of some of the pairs, of each part in turn",
    )
    command.add_argument(
        "--accept-terms", action="store_true", help="agree to the terms of a source that asks for it"
    )
    command.add_argument("--quiet", action="store_true", help="no progress bar")
    add_json(command)


def _add_views(group: Any) -> None:
    group.add_argument("--heights", nargs="+", type=float, metavar="M", help="above the ground (256 121.5)")
    how = group.add_mutually_exclusive_group()
    how.add_argument("--yaws", type=int, metavar="N", help="a ring of N views at each height")
    how.add_argument(
        "--views", type=int, metavar="N", help="N views along a spiral from the greatest height (54)"
    )
    group.add_argument("--rounds", type=float, metavar="N", help="of the spiral (3)")
    group.add_argument(
        "--tilt",
        nargs="+",
        type=float,
        metavar="DEG",
        help="from straight down, 0 to 80 (45); with several, the flight is repeated at each",
    )
    group.add_argument("--size", type=int, metavar="PX", help="longer side of the images (512)")
    group.add_argument(
        "--satellite-m",
        type=float,
        metavar="M",
        help="ground that the satellite view is wide (default: as the widest drone view at the place)",
    )


def _add_shared(group: Any) -> None:
    for option in _shared_options():
        name = "--" + option.name.replace("_", "-")
        if option.flag:
            group.add_argument(name, action="store_true", default=None, help=option.told)
        else:
            group.add_argument(name, metavar=option.metavar, help=_help_of(option))


def _help_of(option: Option) -> str:
    if option.name == "map_type":
        return f"one of {', '.join(MAP_TYPES)} (default {MAP_TYPES[0]})"
    if option.name == "camera":
        return "camera by name (see terrainav cameras) instead of --fov, with its own aspect ratio"
    if option.name == "fov":
        return f"diagonal field of view of a square picture in degrees ({Lens.fov_deg})"
    return option.told


def _shared_options() -> list[Option]:
    return [option for option in OPTIONS if option.name in _SHARED]


def run_pairs(arguments: argparse.Namespace) -> int:
    """Capture pairs into a folder."""
    from ..imagery.opening import SourceOptions, named_source
    from ..mission.settings import resolve
    from ..pairs.planning import plan_pairs
    from ..pairs.sheet import check_sheet, contact_sheet

    if not arguments.data_dir and not arguments.dry_run:
        # An empty one is of a variable that is not set: the current folder, which it would stand for, is not meant.
        raise InvalidInput("no folder for the pairs: give --data-dir, such as . for the current one")
    if arguments.sheet is not None:
        check_sheet(arguments.sheet)
    given = {option.name: getattr(arguments, option.name) for option in _shared_options()}
    values = resolve(given, config=arguments.config)
    settings = _settings(arguments, values)
    places = _places(arguments, settings)
    named = named_source(
        settings.source,
        SourceOptions(
            seed=settings.seed,
            date=settings.date or None,
            crs=settings.crs,
            connections=values["connections"],
            cache=None if arguments.dry_run else opened_cache(values),
            placeholders=tuple(values["placeholder"] or ()),
            named_by_user=names_source(arguments),
        ),
    )
    if arguments.dry_run:
        _print_plan(plan_pairs(places, settings, named.grid), arguments.json)
        return DONE
    with closing(named.open()) as source, collected() as signals:
        worked_out = plan_pairs(places, settings, source.grid)
        result = _capture(worked_out, source, arguments, values, signals)
    _print_result(worked_out, result, arguments.json)
    if result.cancelled:
        print("terrainav: stopped; what is finished is kept, go on with --resume", file=sys.stderr)
        return exit_code(signals[0])
    if arguments.sheet is not None and len(result.left_out) < len(places):
        contact_sheet(result.folder, arguments.sheet)
    return INCOMPLETE if result.failed or result.left_out else DONE


def _settings(arguments: argparse.Namespace, values: dict[str, Any]) -> PairSettings:
    from ..geodesy.camera import Camera
    from ..mission.cameras import camera_named
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
        seed=values["seed"],
        gap_m=arguments.gap,
        allow_shared_ground=arguments.allow_shared_ground,
        upsample=values["upsample"],
        ground_height_m=values["ground_height"],
        error_budget_px=values["error_budget"],
        accept_error=values["accept_error"],
        resampling=values["resampling"],
        **more,
    )


def _views(arguments: argparse.Namespace) -> tuple[View, ...]:
    from ..pairs.views import DEFAULT_TILT_DEG, HEIGHTS_M, ROUNDS, VIEWS, rings, spiral

    heights, tilts = arguments.heights or HEIGHTS_M, arguments.tilt or (DEFAULT_TILT_DEG,)
    if arguments.yaws is not None:
        if arguments.rounds is not None:
            raise InvalidInput(
                "--yaws and --rounds: rings have no rounds",
                remedy="give --views for a spiral",
            )
        return rings(heights, arguments.yaws, tilts)
    count = VIEWS if arguments.views is None else arguments.views
    rounds = min(ROUNDS, count) if arguments.rounds is None else arguments.rounds
    return spiral(heights, count, rounds, tilts)


def _places(arguments: argparse.Namespace, settings: PairSettings) -> tuple[Place, ...]:
    from ..pairs.places import read_box, read_places
    from ..pairs.planning import places_in_box

    text = arguments.places
    if is_there(text):
        if arguments.count is not None or arguments.spacing is not None:
            option = "count" if arguments.count is not None else "spacing"
            raise InvalidInput("--{0} and the file {1}: it is for places of a box", option, text)
        return read_places(text)
    box = read_box(text)
    if arguments.count is None:
        raise InvalidInput("box {0!r}: needs a number of places, --count", text)
    return places_in_box(box, arguments.count, settings, arguments.spacing)


def _capture(
    worked_out: PairPlan,
    source: Source,
    arguments: argparse.Namespace,
    values: dict[str, Any],
    signals: list[int],
) -> PairResult:
    from ..imagery.catalogue import check_policy
    from ..pairs.capturing import capture_pairs

    check_policy(
        source,
        worked_out.requests,
        accept_terms=arguments.accept_terms,
        map_types=(worked_out.settings.map_type,),
        bounds_deg=worked_out.bounds_deg,
    )
    bar = Bar(arguments.quiet)
    try:
        return capture_pairs(
            worked_out,
            source,
            arguments.data_dir,
            connections=values["connections"],
            resume=arguments.resume,
            progress=bar,
            cancelled=lambda: bool(signals),
        )
    finally:
        bar.close()


def _counts(worked_out: PairPlan) -> str:
    counts = worked_out.counts
    ground = "ground is seen in two parts" if worked_out.ground_shared else "no ground is seen in two parts"
    return f"{counts['train']:,} to train, {counts['test']:,} to test, {counts['distractor']:,} distractors; {ground}"


def _print_plan(worked_out: PairPlan, as_json: bool) -> None:
    if as_json:
        print(json.dumps({**_figures(worked_out), "requests": worked_out.requests}, indent=1))
        return
    views = len(worked_out.settings.views)
    print(f"places      {len(worked_out.places):,}: {_counts(worked_out)}")
    print(f"images      {worked_out.images:,}: for each place 1 of the satellite and {views:,} of the drone")
    print(f"satellite   {worked_out.settings.satellite_width_m:,.1f} m wide")
    print(f"views reach {worked_out.reach_m:,.0f} m from their place")
    print(f"requests    {worked_out.requests:,}")


def _figures(worked_out: PairPlan) -> dict[str, Any]:
    return {
        "places": worked_out.counts,
        "ground_shared": worked_out.ground_shared,
        "images": worked_out.images,
    }


def _print_result(worked_out: PairPlan, result: PairResult, as_json: bool) -> None:
    if as_json:
        about = {
            "folder": str(result.folder),
            **_figures(worked_out),
            "written": result.written,
            "skipped": result.skipped,
            "failed": [{"capture": f.map_type, "name": f.name, "reason": f.reason} for f in result.failed],
            "left_out": list(result.left_out),
            "requests": result.requests,
            "unique_parts": result.unique_parts,
            "seconds": result.seconds,
            "cancelled": result.cancelled,
            "repeated": [
                {
                    "capture": repeat.map_type,
                    "sha256": repeat.sha256,
                    "places": repeat.places,
                    "images": repeat.images,
                }
                for repeat in result.repeated
            ],
        }
        print(json.dumps(about, indent=1))
        return
    print_written(result)
    print(f"{len(worked_out.places):,} places: {_counts(worked_out)}")
    print(f"{result.requests:,} requests for {result.unique_parts:,} unique parts; pairs in {result.folder}")
    print_failed(result.failed, result.folder / "pairs.csv")
    print_repeated(result.repeated)
    if result.left_out:
        shown = ", ".join(result.left_out[:NAMED_FAILURES])
        rest = len(result.left_out) - NAMED_FAILURES
        print(
            f"left out, for want of views: {shown}" + (f" and {rest:,} more" if rest > 0 else ""),
            file=sys.stderr,
        )
