"""Options of the subcommands for datasets."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any

from ..dataset.folder import DEFAULT_ENTROPY, FRAMES, LAYOUTS, PARTS, SEED, SHARES, TARGETS, TRAIN, WAYS
from ..exports.kinds import KINDS
from ..fields import Field
from ..geodesy.lens import Lens
from ..map_types import MAP_TYPES
from ..mission.options import OPTIONS, Option

#: Options of missions that ``terrainav pairs`` also has, on the command line, in the environment or in a file.
_SHARED = (
    "source",
    "map_type",
    "date",
    "crs",
    "imagery",
    "seed",
    "camera",
    "fov",
    "upsample",
    "ground_height",
    "error_budget",
    "elevation",
    "surface",
    "vertical_datum",
    "height_unit",
    "height_offset",
    "holes",
    "accept_error",
    "resampling",
    "connections",
    "placeholder",
    "cache_dir",
    "cache_limit",
    "no_cache",
)
#: Help of shared options that mean something else for pairs.
_PAIRS_HELP = {
    "map_type": f"one of {', '.join(MAP_TYPES)}",
    "imagery": "imagery of a view, if not --source: satellite=SOURCE, drone=SOURCE[@DATE][:MAP_TYPE], or both",
    "camera": "camera by name (see terrainav cameras) instead of --fov, with its aspect ratio",
    "fov": f"diagonal field of view of a square image in degrees ({Lens.fov_deg})",
}
_EPILOG = """
PLACES is a file with a line `lat lon` or `lat lon name` for each place (`lat lon agl`, as in the paper, works too; the
height is ignored), or a box "latTL_lonTL_latBR_lonBR" with --count. Separate the numbers of a box that begins with a
minus by spaces: "-33.8 18.4 -34.0 18.7".
Without --heights, --yaws and --views the drone flies as in University-1652: 54 views along a spiral of three rounds,
from 256 down to 121.5 m. From each view the camera looks at the place.
"""


def add_option(group: Any, option: Option, text: str = "", **more: Any) -> None:
    """Add an option.

    Parameters
    ----------
    text : str
        Replaces the option's help, unless empty.
    **more
        Further arguments of `add_argument`, for options that take values.
    """
    name = "--" + option.name.replace("_", "-")
    if option.flag:
        group.add_argument(name, action="store_true", default=more.get("default"), help=text or option.full_help)
        return
    low, high = option.count or (1, 1)
    many: Any = None if option.count is None else high if low == high else "+"
    metavar = option.metavar or (f"{{{','.join(option.choices)}}}" if option.choices else None)
    group.add_argument(name, nargs=many, metavar=metavar, help=text or option.full_help, **more)


def add_field(group: Any, field: Field, default: str = "") -> None:
    """Add the option of a declared field; ``default`` describes a default that depends on other options."""
    option = Option.from_field(field)
    text = (option.full_help, *(f"{value}: {label}" for value, label in field.choices.items()), default)
    more = {"choices": option.choices} if option.choices else {}
    add_option(
        group,
        option,
        "; ".join(filter(None, text)),
        type=field.kind,
        required=field.needed,
        default=option.default,
        **more,
    )


def add_json(command: argparse.ArgumentParser, default: Any = False) -> None:
    """Add ``--json``; with the default `argparse.SUPPRESS`, ``--json`` before an action's name still counts."""
    command.add_argument("--json", action="store_true", default=default, help="print as JSON")


def add_config(command: argparse.ArgumentParser) -> None:
    """Add ``--config``."""
    command.add_argument("--config", metavar="FILE", help="JSON file of options (config.json if it is there)")


def add_consent(command: argparse.ArgumentParser) -> None:
    """Add ``--accept-terms``."""
    command.add_argument("--accept-terms", action="store_true", help="agree to the terms of a source that requires it")


def add_clean(cleaning: argparse.ArgumentParser) -> None:
    """Add the options of ``terrainav clean``."""
    cleaning.add_argument("folder", metavar="OUT", help="the dataset's folder")
    cleaning.add_argument(
        "--entropy",
        type=float,
        default=DEFAULT_ENTROPY,
        metavar="BITS",
        help="reject images below it, 0 to 8 (default %(default)s); the roadmap's entropies decide for all map types",
    )
    either = cleaning.add_mutually_exclusive_group()
    either.add_argument("--move", action="store_true", help="also move them to a folder `rejected` beside the others")
    either.add_argument("--undo", action="store_true", help="move all images back and remove the marks")
    cleaning.add_argument("--dry-run", action="store_true", help="change nothing in the dataset, print the counts")
    cleaning.add_argument(
        "--plot",
        metavar="DIR",
        help="also draw each map type's entropies and the threshold as PNG, as a histogram and as one bar per image, "
        "replacing those of an earlier run (needs matplotlib)",
    )
    add_json(cleaning)


def add_split(splitting: argparse.ArgumentParser) -> None:
    """Add the options of ``terrainav split``."""
    splitting.add_argument("folder", metavar="OUT", help="the dataset's folder")
    splitting.add_argument(
        "--shares",
        nargs=3,
        type=float,
        default=SHARES,
        metavar=("TRAIN", "VALIDATION", "TEST"),
        help="shares of the three parts, with sum 1 (default 0.8 0.1 0.1)",
    )
    splitting.add_argument(
        "--how",
        choices=WAYS,
        default=WAYS[0],
        help="shuffled by seed and image name, in the table's order, or by blocks of ground, so that no ground is in "
        "two parts; auto (default) uses blocks if images overlap, and shuffles otherwise",
    )
    splitting.add_argument(
        "--block",
        type=float,
        metavar="METRES",
        dest="block_m",
        help="side of the blocks (default: the largest whose parts approximate the shares, between 16 images and "
        "half of one)",
    )
    splitting.add_argument(
        "--gap",
        type=float,
        default=0.0,
        metavar="METRES",
        dest="gap_m",
        help="minimum distance between the ground of two parts, with blocks (default %(default)s)",
    )
    splitting.add_argument("--seed", type=int, default=SEED, help="seed of the order (default %(default)s)")
    splitting.add_argument(
        "--frame",
        default=FRAMES[0],
        help="frame of the labels: utm (default), mercator, mission (a plane about its middle) or EPSG:CODE",
    )
    splitting.add_argument(
        "--undo", action="store_true", help="restore the parts and labels before the last split, if there were any"
    )
    splitting.add_argument("--dry-run", action="store_true", help="change nothing, print the counts")
    add_json(splitting)


def add_load(loading: argparse.ArgumentParser) -> None:
    """Add the options of ``terrainav load``."""
    loading.add_argument("folder", metavar="OUT", help="the dataset's folder")
    loading.add_argument(
        "--loader",
        choices=("numpy", "torch", "keras"),
        default="numpy",
        help="default %(default)s; without TensorFlow, use keras with KERAS_BACKEND=torch in the environment",
    )
    loading.add_argument("--map-type", metavar="TYPE", help="default satellite, or else the first")
    loading.add_argument(
        "--part", choices=(*PARTS, "all"), default=TRAIN, help="default %(default)s; all needs no split"
    )
    loading.add_argument(
        "--img-size",
        nargs=3,
        metavar=("W", "H", "C"),
        help="resize images to width, height and channels (1 or 3); otherwise they must be of one size",
    )
    loading.add_argument(
        "--targets",
        nargs="+",
        metavar="TARGET",
        default=TARGETS[:1],
        help="labels, of image, camera, height, attitude, classes and instances: the image's centre, the camera's "
        "place, its height, its attitude, the class and the instance of each pixel; or further columns of the table, "
        "such as exposure_ms (default image)",
    )
    loading.add_argument("--batch-size", metavar="N", help="images in a batch (default 8)")
    loading.add_argument("--seed", metavar="N", help="of order and augmentation (default 2024)")
    loading.add_argument(
        "--dataset",
        metavar="{TerrAInav,VBN}",
        help="layout of the folder: TerrAInav (default), including the paper's published data, or VBN, its supplement",
    )
    add_config(loading)
    loading.add_argument(
        "--workers", type=int, default=0, metavar="N", help="threads of numpy, processes of torch (default 0)"
    )
    loading.add_argument("--no-augment", action="store_true", help="do not augment images of the training part")
    for name in ("contrast", "brightness"):
        loading.add_argument(
            f"--{name}",
            type=float,
            metavar="SHARE",
            help=f"also augment {name} by up to this share, 0 to 1, either way",
        )
    add_json(loading)


def add_pairs(command: argparse.ArgumentParser) -> None:
    """Add the options of ``terrainav pairs``."""
    command.epilog, command.formatter_class = _EPILOG, argparse.RawDescriptionHelpFormatter
    command.add_argument("places", metavar="PLACES", help="file of places, or a box with --count")
    command.add_argument("--data-dir", metavar="OUT", help="folder of the pairs")
    where = command.add_argument_group("places of a box")
    where.add_argument("--count", type=int, metavar="N", help="number of random places in the box")
    where.add_argument(
        "--spacing",
        type=float,
        metavar="M",
        help="minimum distance between places (default: so that no two show the same ground)",
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
        help="minimum distance between ground seen in two parts (0)",
    )
    parts.add_argument(
        "--allow-shared-ground",
        action="store_true",
        help="assign each place separately, even if the same ground is then seen in two parts",
    )
    shared = command.add_argument_group("imagery and camera", "each also in the environment or config.json")
    for option in shared_options():
        add_option(shared, option)
    add_config(command)
    command.add_argument("--resume", action="store_true", help="capture what is missing or failed")
    command.add_argument("--dry-run", action="store_true", help="print what would be captured; download nothing")
    command.add_argument(
        "--sheet",
        metavar="FILE.jpg",
        help="also draw a contact sheet of some pairs of each part",
    )
    add_consent(command)
    command.add_argument("--quiet", action="store_true", help="no progress bar")
    add_json(command)


def _add_views(group: Any) -> None:
    group.add_argument("--heights", nargs="+", type=float, metavar="M", help="heights above ground (256 121.5)")
    either = group.add_mutually_exclusive_group()
    either.add_argument("--yaws", type=int, metavar="N", help="a ring of N views at each height")
    either.add_argument("--views", type=int, metavar="N", help="N views along a spiral from the greatest height (54)")
    group.add_argument("--rounds", type=float, metavar="N", help="rounds of the spiral (3)")
    group.add_argument(
        "--tilt",
        nargs="+",
        type=float,
        metavar="DEG",
        help="tilt from straight down, 0 to 80 (45); the flight is repeated at each of several",
    )
    group.add_argument("--size", type=int, metavar="PX", help="longer side of the images (512)")
    group.add_argument(
        "--satellite-m",
        type=float,
        metavar="M",
        help="width of the ground in the satellite view (default: that of the widest drone view at the place)",
    )


def shared_options() -> list[Option]:
    """Options of missions that ``terrainav pairs`` also has, with help for pairs; ``map_type`` takes one value."""
    return [
        replace(
            option,
            help=_PAIRS_HELP.get(option.name, option.help),
            count=None if option.name == "map_type" else option.count,
        )
        for option in OPTIONS
        if option.name in _SHARED
    ]


def add_convert(converting: argparse.ArgumentParser) -> None:
    """Add the options of ``terrainav convert``."""
    converting.add_argument("folder", metavar="FOLDER", help="the published data; it is only read")
    converting.add_argument("target", metavar="OUT", help="folder of the new dataset, new or empty")
    converting.add_argument(
        "--dataset",
        type=_layout,
        choices=LAYOUTS,
        default=LAYOUTS[0],
        help="layout of the folder: map types with a meta_data.csv, or JPG2 and MetaData2 (default %(default)s)",
    )
    add_json(converting)


def add_mosaic(mosaicking: argparse.ArgumentParser) -> None:
    """Add the options of ``terrainav mosaic``."""
    mosaicking.add_argument("folder", metavar="OUT", help="the dataset's folder")
    mosaicking.add_argument(
        "--output", metavar="FILE", help="GeoTIFF to write (default MAP_TYPE.tif in the dataset's folder)"
    )
    mosaicking.add_argument(
        "--gsd",
        type=float,
        metavar="METRES",
        dest="gsd_m",
        help="ground sample distance (default: that of the images directly below their cameras)",
    )
    mosaicking.add_argument("--map-type", help="map type (default: the dataset's first)")
    mosaicking.add_argument("--quiet", action="store_true", help="no progress bar")
    add_json(mosaicking)


def add_export(exporting: argparse.ArgumentParser) -> None:
    """Add the options of ``terrainav export``."""
    exporting.add_argument("folder", metavar="OUT", help="the folder of the dataset or benchmark; it is only read")
    exporting.add_argument(
        "target",
        nargs="?",
        metavar="FOLDER",
        help="folder of the files, new or empty; without it parquet, croissant and stac are written into OUT",
    )
    exporting.add_argument(
        "--as",
        dest="format",
        required=True,
        choices=tuple(KINDS),
        help="for camera frames: the model of COLMAP or nerfstudio, or a trajectory; for a dataset: tables as "
        "Parquet, image folders for Hugging Face datasets, a description of the files, or STAC items and their "
        "collection; for a dataset with labels: a training set of COCO or YOLO; for a sequence: EuRoC or a ROS 2 bag; "
        "for a benchmark: the layout of a set that localisers are evaluated on",
    )
    exporting.add_argument(
        "--map-type",
        metavar="TYPE",
        help="default satellite, or else the first; all for formats of datasets",
    )


def _layout(text: str) -> str:
    """Layout in any case; other text is returned unchanged, for the parser to refuse."""
    return next((layout for layout in LAYOUTS if layout.lower() == text.lower()), text)
