"""Parser of the command: its subcommands and their options."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Sequence
from decimal import Decimal
from typing import Any, NamedTuple, NoReturn

from ..addresses import without_credentials
from ..benchmark.choices import CROSS_AREA, POSITIVE_IOU, SEMI_POSITIVE_IOU, SPLITS, TILE_OVERLAP
from ..capture.choices import FOLDERS, IMAGES, LAYOUTS
from ..dataset.folder import PARTS
from ..geodesy.lens import LENSES
from ..live.choices import AIRSIM_PORT, FDM_PORT, HTTP_PORT, MAVLINK_ADDRESS, RTSP_PORT
from ..mission.options import OPTIONS, share
from ..mission.parts import ALIGNMENTS
from ..numbers import integer, real_number
from .dataset_options import (
    add_clean,
    add_config,
    add_consent,
    add_convert,
    add_export,
    add_json,
    add_load,
    add_mosaic,
    add_option,
    add_pairs,
    add_split,
)
from .exits import BAD_INPUT

_SERVICE_HELP = """
A source is a name or title in the list; a URL template with {z} {x} {y} (or {-y}, {q}, {bbox-epsg-3857} for a WMS),
and {s} {r} {date} {map_type} {key} where it has them; a file (GeoTIFF, VRT, MBTiles, ...); or a layer of a service:
  wmts:URL#layer=NAME[&style=...&tilematrixset=...&format=png|jpeg]
  wms:URL#layers=NAME[,NAME][&styles=...&format=png|jpeg&version=1.3.0|1.1.1]
  arcgis:URL[#layers=0,2&format=png32|jpg|...], or arcgis:URL#service=NAME/MapServer of a server
  ogcapi:URL[#collection=NAME&tilematrixset=...&format=png|jpeg]
where URL is the address of the service or of its capabilities. `terrainav sources show URL` finds out which kind of
service it is, and lists layers.
A key is written {key} in a URL, and kept in the environment as TERRAINAV_KEY.
"""


class _Parser(argparse.ArgumentParser):
    """Parser with one-line errors, which reads numbers as files of this project have them."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.register("type", float, real_number)
        self.register("type", int, integer)

    def error(self, message: str) -> NoReturn:
        # The message quotes the arguments.
        message = without_credentials(message)
        self.exit(BAD_INPUT, f"{self.prog}: error: {message}; see {self.prog} --help\n")


class _Command(NamedTuple):
    """A subcommand: the function that adds its options, and its line in the help of the whole command."""

    add_options: Callable[[argparse.ArgumentParser], None]
    help: str


def parser(command: str | None = None) -> argparse.ArgumentParser:
    """Return the parser of the whole command, with the options of one subcommand, or of all."""
    whole = _Parser(
        prog="terrainav",
        description="Plan and fly a virtual UAV over real map imagery: footprints, then georeferenced images.",
    )
    whole.add_argument("--version", action="store_true", help="print the version")
    commands = whole.add_subparsers(dest="command", metavar="COMMAND", parser_class=_Parser)
    for name, one in _COMMANDS.items():
        inner = commands.add_parser(name, help=one.help)
        if command in (None, name):
            one.add_options(inner)
    return whole


def named_command(argv: Sequence[str]) -> str:
    """Name of the subcommand among the arguments: the first that is no option, as none before it takes a value."""
    return next((argument for argument in argv if not argument.startswith("-")), "")


def normalise(argv: Sequence[str]) -> list[str]:
    """Replace underscores in option names, and join options with values that begin with a minus.

    Argparse would mistake a coordinate such as -35.1_-70.2_120 for an option, and also a number such as -1e-05, which
    is rewritten without the exponent.
    """
    with_exponent = re.compile(r"-(?:\d+\.?\d*|\.\d+)[eE][+-]?\d{1,3}", re.ASCII)
    tidy: list[str] = []
    arguments = iter(argv)
    for argument in arguments:
        name, equals, value = argument.partition("=")
        if not name.startswith("--"):
            tidy.append(f"{Decimal(argument):f}" if with_exponent.fullmatch(argument) else argument)
            continue
        name = "--" + name[2:].replace("_", "-")
        if name in ("--coords", "--area") and not equals:
            value = next(arguments, "")
            equals = "="
        tidy.append(name + equals + value)
    return tidy


def _add_plan(planning: argparse.ArgumentParser) -> None:
    _add_mission_options(planning)
    planning.add_argument(
        "more_missions",
        nargs="*",
        metavar="MISSION",
        help="further mission files, which one flight serves in this order, with safe transits between them",
    )
    planning.add_argument(
        "--output",
        metavar="FILE",
        action="append",
        default=[],
        help="write .csv, .geojson, .kml, .gpkg, .gpx, .litchi.csv, .kmz (DJI Pilot 2, FlightHub 2, DJI Fly), .plan "
        "(QGroundControl), .survey.plan (editable there as a survey) or mission .json",
    )
    planning.add_argument(
        "--profile",
        metavar="FILE",
        help="write the heights along the flight, of flight, ground and surface, and the clearance: a table (.csv) or "
        "a diagram (.png, needs matplotlib)",
    )
    planning.add_argument(
        "--to-vehicle",
        metavar="ADDRESS",
        help="upload the flight to a vehicle over MAVLink: tcp:HOST:PORT, udp:HOST:PORT (waits there for it) or "
        "udpout:HOST:PORT; needs pymavlink",
    )
    planning.add_argument("--sortie", type=int, metavar="N", help="sortie to upload, from 1, of a flight with several")
    _add_alignment(planning)
    planning.add_argument("--json", action="store_true", help="print the figures as JSON")


def _add_capture(capturing: argparse.ArgumentParser) -> None:
    _add_mission_options(capturing)
    _add_alignment(capturing)
    capturing.add_argument("--resume", action="store_true", help="continue an interrupted capture")
    capturing.add_argument("--only-failed", action="store_true", help="capture only images that failed before")
    _add_blocks(capturing)
    add_consent(capturing)
    capturing.add_argument("--json", action="store_true", help="print the result as JSON")
    capturing.add_argument("--quiet", action="store_true", help="no progress bar")


def _add_fly(flying: argparse.ArgumentParser) -> None:
    from .sequence_options import add_sequence

    _add_capture(flying)
    add_sequence(flying)


def _add_report(reporting: argparse.ArgumentParser) -> None:
    _add_mission_options(reporting)
    made = reporting.add_mutually_exclusive_group(required=True)
    made.add_argument("--output", metavar="DIR", help="folder of the page and its images")
    made.add_argument(
        "--mtf",
        metavar="IMAGE",
        help="instead, print the contrast by spatial frequency of an image of a slanted edge (ISO 12233)",
    )
    add_consent(reporting)


def _add_live(serving: argparse.ArgumentParser) -> None:
    _add_mission_options(serving)
    serving.add_argument("--host", metavar="ADDRESS", default="127.0.0.1", help="address to serve at (this machine)")
    for name, usual, text in (
        ("http", HTTP_PORT, "HTTP, with a page that shows the camera (the default interface)"),
        ("airsim", AIRSIM_PORT, "AirSim's clients"),
        ("rtsp", RTSP_PORT, "video in H.264, by GStreamer"),
        ("fdm", FDM_PORT, "simulators that send FlightGear's FDM, whose aircraft the page can follow"),
    ):
        serving.add_argument(
            f"--{name}", type=int, metavar="PORT", nargs="?", const=usual, help=f"serve {text}; port {usual} if none"
        )
    serving.add_argument(
        "--mavlink",
        metavar="ADDRESS",
        nargs="?",
        const=MAVLINK_ADDRESS,
        help="be the camera of a vehicle: udp:HOST:PORT, where it calls, or udpout:HOST:PORT or tcp:HOST:PORT, where "
        f"it is called; {MAVLINK_ADDRESS} if none",
    )
    serving.add_argument("--photos", metavar="DIR", help="folder for the photographs of the MAVLink camera")
    serving.add_argument(
        "--sea-level",
        metavar="M",
        type=float,
        default=0.0,
        help="height of sea level above the ellipsoid, which vehicles and simulators count from (0)",
    )
    serving.add_argument("--token", metavar="TEXT", default="", help="what clients must give; needed for other hosts")
    serving.add_argument("--workers", type=int, metavar="N", default=1, help="frames made at once (1)")
    add_consent(serving)


def _add_blocks(command: argparse.ArgumentParser) -> None:
    blocks = command.add_argument_group(
        "blocks",
        "any of these, or an address such as s3://bucket/folder as --data-dir, captures images in blocks",
    )
    blocks.add_argument(
        "--cluster",
        metavar="ENGINE",
        help="where to capture: local:N, N processes on this machine, or dask://HOST:PORT, a Dask scheduler",
    )
    blocks.add_argument(
        "--block",
        metavar="SIZE",
        help=f"most images in a block, or their total size such as 200MB (default {IMAGES})",
    )
    blocks.add_argument(
        "--layout-of-files",
        choices=LAYOUTS,
        default=FOLDERS,
        help="one file per image (default), or one tar shard per block, for webdataset",
    )


def _add_alignment(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--align",
        choices=ALIGNMENTS,
        help="rotate the rows to the longest side of the area, or to the shortest flight; prints the gain",
    )


def _add_mission_options(command: argparse.ArgumentParser, but: tuple[str, ...] = ()) -> None:
    """Add the mission file and all options of a mission; with ``but``, all options except these, and no file."""
    if not but:
        command.add_argument(
            "mission_file", nargs="?", metavar="MISSION", help="mission file (JSON) instead of options"
        )
    command.set_defaults(**dict.fromkeys(but))
    add_config(command)
    group = command.add_argument_group(
        "mission",
        "each also as TERRAINAV_<NAME> in the environment, or in config.json; the command line takes precedence",
    )
    for option in OPTIONS:
        if option.name not in but:
            add_option(group, option)


def _add_actions(listing: argparse.ArgumentParser) -> Any:
    """Add the action ``list`` to a command; return the group for further actions."""
    actions = listing.add_subparsers(dest="action", metavar="ACTION", parser_class=_Parser)
    every = actions.add_parser("list", help="list all (the default action)")
    add_json(every, argparse.SUPPRESS)
    return actions


def _add_poses(whole: argparse.ArgumentParser) -> None:
    from .pose_options import add_poses

    add_poses(whole, _Parser)


def _add_benchmark(whole: argparse.ArgumentParser) -> None:
    actions = whole.add_subparsers(dest="action", metavar="ACTION", parser_class=_Parser)
    _add_benchmark_make(actions)
    running = actions.add_parser("run", help="answer the queries with a baseline or your own method, and score it")
    running.add_argument("folder", metavar="BENCHMARK", help="the benchmark's folder")
    running.add_argument(
        "--method",
        required=True,
        metavar="METHOD",
        help="ncc, sift, orb, middle, prior or silhouette, or your own module:function",
    )
    running.add_argument("--quiet", action="store_true", help="no progress")
    scoring = actions.add_parser("score", help="score predictions for a benchmark or a sequence")
    scoring.add_argument("folder", metavar="BENCHMARK", help="folder of the benchmark or the sequence")
    scoring.add_argument("predictions", metavar="PREDICTIONS", help="CSV: query, references, lat_deg, lon_deg, …")
    for command in (running, scoring):
        command.add_argument("--part", choices=PARTS, help="only queries of one part")
        command.add_argument(
            "--output", metavar="DIR", help="folder of the page and its files (BENCHMARK/scores/METHOD)"
        )
        command.add_argument("--no-page", action="store_true", help="only print the figures; write no page")
        add_json(command)


def _add_benchmark_make(actions: Any) -> None:
    making = actions.add_parser(
        "make", help="capture queries from one or more imageries, and the reference to find them in"
    )
    group = making.add_argument_group("benchmark")
    group.add_argument(
        "--queries",
        nargs="+",
        required=True,
        metavar="[NAME=]SOURCE[@DATE][:MAP_TYPE]",
        help="imagery of the queries; each of several shows all of them",
    )
    group.add_argument(
        "--reference",
        required=True,
        metavar="[NAME=]SOURCE[@DATE][:MAP_TYPE]",
        help="imagery in which to find them",
    )
    group.add_argument(
        "--reference-buildings",
        nargs="+",
        default=(),
        metavar="FILE",
        help="buildings in which to find them as well, as --buildings names them; copied beside the reference, and "
        "queries have masks of buildings",
    )
    group.add_argument(
        "--tiles",
        nargs="+",
        type=float,
        metavar="M",
        help="widths of the reference's tiles (default: of a square with the area that a query shows)",
    )
    group.add_argument(
        "--tile-overlap",
        type=_share,
        default=TILE_OVERLAP,
        metavar="SHARE",
        help="share of a tile shared with its neighbour, such as 0.5 or 50%% (%(default)g)",
    )
    group.add_argument(
        "--margin",
        dest="reference_margin",
        type=float,
        metavar="M",
        help="margin of the reference around the ground of the queries (default: the width of the widest tile)",
    )
    group.add_argument(
        "--positive",
        type=float,
        default=POSITIVE_IOU,
        metavar="IOU",
        help="least intersection over union of a correct tile (%(default)g)",
    )
    group.add_argument(
        "--semi-positive",
        type=float,
        default=SEMI_POSITIVE_IOU,
        metavar="IOU",
        help="least intersection over union of a nearly correct tile (%(default)g)",
    )
    group.add_argument(
        "--split",
        choices=SPLITS,
        default=CROSS_AREA,
        help="cross-area: no ground in two parts, of queries or of tiles (default); same-area: by places, with one "
        "reference for all",
    )
    group.add_argument(
        "--inside",
        action="store_true",
        help="leave out queries that see beyond their imagery or the reference",
    )
    group.add_argument(
        "--shares",
        nargs=3,
        type=float,
        metavar=("TRAIN", "VALIDATION", "TEST"),
        help="shares of the parts (0.8 0.1 0.1)",
    )
    group.add_argument(
        "--gap", type=float, default=0.0, metavar="M", help="minimum distance between ground of two parts (0)"
    )
    but = ("preset", "source", "map_type", "date", "imagery", "frame", "margin")
    _add_mission_options(making, but=but)
    making.add_argument("--resume", action="store_true", help="continue an interrupted run")
    making.add_argument("--dry-run", action="store_true", help="print what would be captured; download nothing")
    add_consent(making)
    making.add_argument("--json", action="store_true", help="print the result as JSON")
    making.add_argument("--quiet", action="store_true", help="no progress bar")


def _share(text: str) -> float:
    try:
        return share(text)
    except ValueError as wrong:
        raise argparse.ArgumentTypeError(f"{text!r}: must be a share from 0 to below 1, such as 0.5 or 50%") from wrong


def _add_sources(listing: argparse.ArgumentParser) -> None:
    listing.epilog, listing.formatter_class = _SERVICE_HELP, argparse.RawDescriptionHelpFormatter
    add_json(listing)
    actions = _add_actions(listing)

    showing = actions.add_parser("show", help="show one source, or the layers of a service")
    showing.add_argument("source", metavar="SOURCE", help="a name, URL template, or address of a service")
    crs_help = "coordinate reference system of a service's layer, if it has several"
    showing.add_argument("--crs", metavar="EPSG:CODE", default="", help=crs_help)
    add_json(showing, argparse.SUPPRESS)

    adding = actions.add_parser(
        "add",
        help="save a source under a name",
        epilog=_SERVICE_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    adding.add_argument("name", metavar="NAME", help="lower-case letters, digits, hyphens and underscores")
    adding.add_argument("url", metavar="URL", help="URL template, or address of a service's layer")
    adding.add_argument("--crs", metavar="EPSG:CODE", default="", help=crs_help)
    for name, kind, metavar, text in (
        ("title", str, "TEXT", "title for display"),
        ("attribution", str, "TEXT", "credit written to every image"),
        ("licence", str, "TEXT", "licence of the imagery"),
        ("terms-url", str, "URL", "web page of the provider's terms"),
        ("min-zoom", int, "ZOOM", "lowest zoom (default 0)"),
        ("max-zoom", int, "ZOOM", "highest zoom (default 22)"),
        ("native-zoom", int, "ZOOM", "highest zoom with further detail (default the highest)"),
        ("tile-size", int, "PX", "width of a tile: 256 (default), 512, ..."),
        ("default-date", str, "DATE", "default date, for a URL with {date}"),
        (
            "key-env",
            str,
            "NAME",
            "environment variable that holds the key, for a URL with {key} (default TERRAINAV_KEY)",
        ),
        ("max-connections", int, "N", "most concurrent requests"),
        ("requests-per-s", float, "N", "most requests per second"),
    ):
        adding.add_argument(f"--{name}", type=kind, metavar=metavar, help=text)
    adding.add_argument(
        "--placeholder",
        metavar="SHA256",
        nargs="+",
        help="tiles to treat as missing, by 16 or more digits of the SHA-256 that a capture prints",
    )
    adding.add_argument("--no-storing", action="store_true", help="do not cache tiles, as its terms forbid it")

    removing = actions.add_parser("remove", help="remove one of your sources")
    removing.add_argument("name", metavar="NAME")


def _add_cameras(listing: argparse.ArgumentParser) -> None:
    add_json(listing)
    actions = _add_actions(listing)

    adding = actions.add_parser("add", help="save a camera under a name, by one field of view, or by sensor and lens")
    adding.add_argument("name", metavar="NAME", help="such as 'Sony RX1 35 mm'")
    pair: dict[str, Any] = {"nargs": 2, "metavar": ("W", "H")}
    point: dict[str, Any] = {"nargs": 2, "metavar": ("X", "Y")}
    options: tuple[tuple[str, str, type, dict[str, Any], str], ...] = (
        ("fov", "fov_deg", float, {"metavar": "DEG"}, "diagonal field of view in degrees"),
        ("hfov", "horizontal_fov_deg", float, {"metavar": "DEG"}, "horizontal field of view in degrees"),
        ("vfov", "vertical_fov_deg", float, {"metavar": "DEG"}, "vertical field of view in degrees"),
        ("sensor", "sensor_mm", float, pair, "width and height of the sensor in mm"),
        ("focal-length", "focal_length_mm", float, {"metavar": "MM"}, "focal length of the lens in mm, with --sensor"),
        ("aspect-ratio", "aspect_ratio", float, pair, "width and height of the image, such as 4 3"),
        ("size-px", "size_px", int, pair, "width and height of the image in pixels instead"),
        ("image-px", "image_px", int, {"metavar": "N"}, "pixels along the longer side, with --aspect-ratio"),
        ("focal-px", "focal_px", float, {"metavar": "PX"}, "focal length in pixels, with --size-px"),
        ("principal-px", "principal_px", float, point, "principal point in pixels, with --size-px"),
        ("lens", "lens", str, {"choices": LENSES}, "kind of the lens"),
        *(
            (name, name.replace("-", "_"), float, {"metavar": "X"}, text)
            for name, text in (
                *((f"k{at}", "radial coefficient of the lens, as OpenCV defines it") for at in range(1, 7)),
                *((f"p{at}", "tangential coefficient of the lens, as OpenCV defines it") for at in (1, 2)),
                *((f"{one}-scale", f"magnification of {one} relative to green, minus 1") for one in ("red", "blue")),
            )
        ),
    )
    for name, fact, kind, shown, text in options:
        adding.add_argument(f"--{name}", dest=fact, type=kind, help=text, **shown)
    adding.add_argument("--source", metavar="TEXT", help="source of these facts")

    removing = actions.add_parser("remove", help="remove one of your cameras")
    removing.add_argument("name", metavar="NAME")
    sensors = actions.add_parser("sensors", help="list image sensors, with figures of their data sheets")
    add_json(sensors, argparse.SUPPRESS)


def _add_cache(caching: argparse.ArgumentParser) -> None:
    actions = caching.add_subparsers(dest="action", metavar="ACTION", parser_class=_Parser)
    every = actions.add_parser("list", help="list files with their tiles and sizes (the default action)")
    clearing = actions.add_parser("clear", help="delete the named files, or all")
    clearing.add_argument("names", nargs="*", metavar="NAME", help="files or titles as `cache list` shows them")
    _add_cache_dir(caching, None)
    add_json(caching)
    for action in (every, clearing):
        _add_cache_dir(action, argparse.SUPPRESS)
        add_json(action, argparse.SUPPRESS)


def _add_cache_dir(command: argparse.ArgumentParser, default: Any) -> None:
    command.add_argument("--cache-dir", metavar="DIR", default=default, help="folder of the cache, if not the default")


#: Subcommands in the order of help.
_COMMANDS = {
    "plan": _Command(_add_plan, help="plan a mission and print its figures; downloads nothing"),
    "capture": _Command(_add_capture, help="capture a mission into a folder (--data-dir)"),
    "fly": _Command(
        _add_fly, help="capture a flight as a sequence: frames at a constant rate, inertial measurements and priors"
    ),
    "report": _Command(_add_report, help="measure a mission's error against run time; writes a page"),
    "clean": _Command(add_clean, help="reject low-detail images of a dataset; deletes nothing"),
    "split": _Command(add_split, help="divide the images of a dataset into training, validation and test"),
    "load": _Command(
        add_load, help="load every batch of a dataset once, as for training; prints shapes and images per second"
    ),
    "pairs": _Command(add_pairs, help="capture places from a satellite and a drone, in the layout of University-1652"),
    "convert": _Command(
        add_convert, help="make a dataset with our tables from the paper's published folders or its supplement"
    ),
    "mosaic": _Command(
        add_mosaic,
        help="write one orthophoto of all images of a dataset, including rotated and tilted ones and those over relief",
    ),
    "export": _Command(
        add_export, help="write a dataset, its camera frames and poses, or a benchmark for other programs"
    ),
    "poses": _Command(
        _add_poses,
        help="make tables of poses from trajectories, logs or lines, around structures or at random; and noisy priors",
    ),
    "benchmark": _Command(
        _add_benchmark, help="make a benchmark of queries and a reference, run a baseline over it, score predictions"
    ),
    "live": _Command(_add_live, help="serve frames from any pose to other programs and a browser"),
    "sources": _Command(_add_sources, help="list sources of imagery and their terms; show, add or remove one"),
    "cameras": _Command(_add_cameras, help="list cameras; add or remove your own"),
    "cache": _Command(_add_cache, help="list or clear the tiles cached for later captures"),
}
