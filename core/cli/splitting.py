"""Splitting of datasets on the command line."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

from ..dataset.folder import FRAMES, SEED, SHARES, WAYS
from .exits import DONE
from .parsing import add_json

if TYPE_CHECKING:
    from ..dataset.split import Split


def add_split(commands: Any) -> None:
    """Add the parser of ``split``."""
    splitting = commands.add_parser(
        "split", help="divide the images of a dataset into training, validation and test"
    )
    splitting.add_argument("folder", metavar="OUT", help="the dataset's folder")
    splitting.add_argument(
        "--shares",
        nargs=3,
        type=float,
        default=SHARES,
        metavar=("TRAIN", "VALIDATION", "TEST"),
        help="shares of the three parts, which add up to 1 (default 0.8 0.1 0.1)",
    )
    splitting.add_argument(
        "--how",
        choices=WAYS,
        default=WAYS[0],
        help="shuffled by seed and image name (default), in the table's order, or by blocks of ground, so that no "
        "ground is in two parts",
    )
    splitting.add_argument(
        "--block",
        type=float,
        metavar="METRES",
        dest="block_m",
        help="side of the blocks (default: the largest whose parts come near the shares, between 16 images and half "
        "of one)",
    )
    splitting.add_argument(
        "--gap",
        type=float,
        default=0.0,
        metavar="METRES",
        dest="gap_m",
        help="least distance between the ground of two parts, with blocks (default %(default)s)",
    )
    splitting.add_argument("--seed", type=int, default=SEED, help="of the order (default %(default)s)")
    splitting.add_argument(
        "--frame",
        default=FRAMES[0],
        help="frame of the labels: utm (default), mercator, mission (a plane about its middle) or EPSG:CODE",
    )
    splitting.add_argument("--dry-run", action="store_true", help="change nothing, print the counts")
    add_json(splitting)


def run_split(arguments: argparse.Namespace) -> int:
    """Write the parts of a dataset's images to its tables."""
    from ..dataset.split import split

    made = split(
        arguments.folder,
        arguments.shares,
        seed=arguments.seed,
        how=arguments.how,
        block_m=arguments.block_m,
        gap_m=arguments.gap_m,
        frame=arguments.frame,
        dry_run=arguments.dry_run,
    )
    if arguments.json:
        print(json.dumps(_document(made), indent=1))
        return DONE
    for line in _lines(made):
        print(line)
    if arguments.dry_run:
        print("dry run: nothing was changed")
    return DONE


def _lines(made: Split) -> list[str]:
    shares = made.shares
    lines = [
        f"{part:12s}{count:,} images ({100.0 * shares[part]:.1f} %)" for part, count in made.images.items()
    ]
    if made.gap:
        lines.append(f"{'gap':12s}{made.gap:,} images in no part: too near to another part's ground")
        if made.gap > sum(made.images.values()):
            lines.append(f"{'':12s}that is most of them: smaller blocks lose more, so try a larger --block")
    if made.unknown:
        lines.append(f"{'unknown':12s}{made.unknown:,} images in no part: they see the horizon or a pole")
    if made.left_out:
        lines.append(f"{'left out':12s}{made.left_out:,} images that failed or are rejected")
    if made.blocks is not None:
        lines.append(f"{'blocks':12s}{made.blocks:,} of {made.block_m:,.0f} m, gap {made.gap_m:g} m")
    labels = made.labels
    lines.append(
        f"{'labels':12s}{labels.frame.crs} ({labels.frame.name}), scaled by {labels.images:,} images"
    )
    return [*lines, *(f"{'':12s}{note}" for note in labels.notes)]


def _document(made: Split) -> dict[str, object]:
    document: dict[str, object] = {name: getattr(made, name) for name in _WRITTEN}
    document.update(images=dict(made.images), shares=made.shares, labels=json.loads(made.labels.to_json()))
    return document


_WRITTEN = ("how", "seed", "images", "gap", "unknown", "left_out", "blocks", "block_m", "gap_m")
