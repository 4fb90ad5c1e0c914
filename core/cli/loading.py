"""Loading of datasets on the command line: every batch once, as a training would have it, and how long that takes."""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from .exits import DONE

if TYPE_CHECKING:
    from ..dataset.loading import Samples
    from ..dataset.loading.augment import Augmentation

#: Options that are also read from the environment and ``config.json``.
_SETTINGS = ("img_size", "batch_size", "seed", "dataset")


def run_load(arguments: argparse.Namespace) -> int:
    """Take all batches of one epoch, and print their shapes and the images per second."""
    from ..mission.settings import resolve

    values = resolve({name: getattr(arguments, name) for name in _SETTINGS}, config=arguments.config)
    samples, batches = _opened(arguments, values)
    shapes: Counter[tuple[tuple[int, ...], tuple[int, ...]]] = Counter()
    begun = time.perf_counter()
    try:
        for images, labels in batches:
            shapes[tuple(images.shape), tuple(labels.shape)] += 1
    except InvalidInput as wrong:
        # From a process of PyTorch's it comes with that one's traceback, in whose last line it is.
        raise InvalidInput(str(wrong).strip().rpartition("\n")[2].rpartition("InvalidInput: ")[2]) from wrong
    seconds = time.perf_counter() - begun
    if arguments.json:
        print(json.dumps(_document(arguments, samples, shapes, seconds), indent=1))
    else:
        _print(arguments, samples, shapes, seconds)
    return DONE


def _opened(
    arguments: argparse.Namespace, values: dict[str, Any]
) -> tuple[Samples, Iterable[tuple[Any, Any]]]:
    """The samples, and the iterable of batches of the loader that was chosen."""
    size, workers = values["batch_size"], arguments.workers
    choice = {
        "map_type": arguments.map_type,
        "part": arguments.part,
        "img_size": values["img_size"],
        "seed": values["seed"],
        "layout": values["dataset"],
        "augment": _augmentation(arguments),
    }
    if arguments.loader == "torch":
        from ..dataset.loading import torch_loader

        of_torch = torch_loader.TorchDataset(arguments.folder, **choice)
        return of_torch.samples, of_torch.batches(size, workers)
    if arguments.loader == "keras":
        from ..dataset.loading import keras_loader

        if workers:
            raise InvalidInput(
                "workers {0}: must be 0 with keras, which starts its own when it trains", workers
            )
        of_keras = keras_loader.KerasDataset(arguments.folder, size, **choice)
        return of_keras.samples, (of_keras[index] for index in range(len(of_keras)))
    from ..dataset.loading import Batches

    of_numpy = Batches(arguments.folder, size, workers=workers, **choice)
    return of_numpy.samples, of_numpy


def _augmentation(arguments: argparse.Namespace) -> Augmentation | str | None:
    from ..dataset.loading.augment import Augmentation

    contrast, brightness = arguments.contrast, arguments.brightness
    if arguments.no_augment:
        if contrast is not None or brightness is not None:
            raise InvalidInput(
                "--no-augment: goes with neither --contrast nor --brightness",
                remedy="leave one out",
            )
        return None
    if contrast is None and brightness is None:
        return "auto"
    return Augmentation(contrast=contrast or 0.0, brightness=brightness or 0.0)


def _document(
    arguments: argparse.Namespace, samples: Samples, shapes: Counter[Any], seconds: float
) -> dict[str, Any]:
    return {
        "folder": arguments.folder,
        "loader": arguments.loader,
        "workers": arguments.workers,
        "map_type": samples.images.map_type,
        "part": samples.part,
        "images": len(samples),
        "dtype": str(samples.dtype),
        "augmented": samples.augment is not None,
        "frame": samples.labels.frame.crs,
        "fitted_on": samples.labels.fitted_on,
        "batches": [
            {"count": count, "images": list(images), "labels": list(labels)}
            for (images, labels), count in shapes.items()
        ],
        "seconds": seconds,
        "images_per_s": len(samples) / seconds,
    }


def _print(arguments: argparse.Namespace, samples: Samples, shapes: Counter[Any], seconds: float) -> None:
    height, width, channels = samples.shape
    part = "all parts" if samples.part == "all" else f"part {samples.part}"
    print(
        f"{samples.images.map_type}, {part}: {len(samples):,} images of {width} x {height} px and {channels} "
        f"channel{'s' * (channels > 1)}, {'augmented' if samples.augment is not None else 'not augmented'}"
    )
    print(f"labels in {samples.labels.frame.crs}, scaled by the images of {samples.labels.fitted_on}")
    for note in samples.labels.notes:
        print(note)
    for (images, labels), count in shapes.items():
        print(
            f"{count:,} batch{'es' * (count > 1)}: images {images} {samples.dtype}, labels {labels} float32"
        )
    print(f"{len(samples) / seconds:,.0f} images per second ({arguments.loader}, {seconds:.2f} s)")
