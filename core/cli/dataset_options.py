"""What the subcommands for datasets take."""

from __future__ import annotations

from typing import Any

from ..dataset.folder import DEFAULT_ENTROPY, LAYOUTS, PARTS, TRAIN
from .pairing import add_pairs
from .parsing import add_json
from .splitting import add_split


def add_dataset_commands(commands: Any) -> None:
    """Add the parsers of the subcommands that work on a dataset."""
    _add_clean(commands)
    add_split(commands)
    _add_load(commands)
    add_pairs(commands)
    _add_convert(commands)


def _add_clean(commands: Any) -> None:
    cleaning = commands.add_parser(
        "clean", help="reject the images of a dataset with too little to see; deletes nothing"
    )
    cleaning.add_argument("folder", metavar="OUT", help="the dataset's folder")
    cleaning.add_argument(
        "--entropy",
        type=float,
        default=DEFAULT_ENTROPY,
        metavar="BITS",
        help="reject images below it, 0 to 8 (default %(default)s); the roadmap's entropies decide for all map types",
    )
    what = cleaning.add_mutually_exclusive_group()
    what.add_argument(
        "--move", action="store_true", help="also move them to a folder `rejected` beside the others"
    )
    what.add_argument("--undo", action="store_true", help="move all images back, and take the marks away")
    cleaning.add_argument(
        "--dry-run", action="store_true", help="change nothing in the dataset, print the counts"
    )
    cleaning.add_argument(
        "--plot",
        metavar="DIR",
        help="also write each map type's entropies with the threshold as PNG: a histogram, and a bar an image; those "
        "of an earlier run are replaced (needs matplotlib)",
    )
    add_json(cleaning)


def _add_load(commands: Any) -> None:
    loading = commands.add_parser(
        "load",
        help="take every batch of a dataset once, as a training does; prints shapes and images per second",
    )
    loading.add_argument("folder", metavar="OUT", help="the dataset's folder")
    loading.add_argument(
        "--loader",
        choices=("numpy", "torch", "keras"),
        default="numpy",
        help="default %(default)s; keras with KERAS_BACKEND=torch in the environment where there is no TensorFlow",
    )
    loading.add_argument("--map-type", metavar="TYPE", help="default satellite, or the first of others")
    loading.add_argument(
        "--part", choices=(*PARTS, "all"), default=TRAIN, help="default %(default)s; all needs no split"
    )
    loading.add_argument(
        "--img-size",
        nargs=3,
        metavar=("W", "H", "C"),
        help="resize images: width, height, channels (1 or 3); else they have to be alike",
    )
    loading.add_argument("--batch-size", metavar="N", help="images in a batch (default 8)")
    loading.add_argument("--seed", metavar="N", help="of order and augmentation (default 2024)")
    loading.add_argument(
        "--dataset",
        metavar="{TerrAInav,VBN}",
        help="layout of the folder: TerrAInav (default), also the paper's published one, or VBN, its supplement",
    )
    loading.add_argument("--config", metavar="FILE", help="JSON file of options (config.json if it is there)")
    loading.add_argument(
        "--workers", type=int, default=0, metavar="N", help="threads of numpy, processes of torch (default 0)"
    )
    loading.add_argument(
        "--no-augment", action="store_true", help="show images of the training part as they are, too"
    )
    for name in ("contrast", "brightness"):
        loading.add_argument(
            f"--{name}", type=float, metavar="SHARE", help=f"augment {name} as well, 0 to 1 either way"
        )
    add_json(loading)


def _add_convert(commands: Any) -> None:
    converting = commands.add_parser(
        "convert", help="make a dataset with our tables from the paper's published folders or its supplement"
    )
    converting.add_argument("folder", metavar="FOLDER", help="the published data; it is only read")
    converting.add_argument("target", metavar="OUT", help="folder of the new dataset, not there yet or empty")
    converting.add_argument(
        "--dataset",
        type=_layout,
        choices=LAYOUTS,
        default=LAYOUTS[0],
        help="how the folder is laid out: map types with a meta_data.csv, or JPG2 and MetaData2 (default %(default)s)",
    )
    add_json(converting)


def _layout(text: str) -> str:
    """Layout however its letters are written; one that is none as it is, for the parser to refuse."""
    return next((layout for layout in LAYOUTS if layout.lower() == text.lower()), text)
