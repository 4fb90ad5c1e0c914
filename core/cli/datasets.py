"""Clean, split, load and convert datasets, and write orthophotos of them, on the command line."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..dataset.folder import ATTITUDE, HEIGHT, IMAGE
from ..errors import InvalidInput
from ..text.plain import printable
from .exits import DONE

if TYPE_CHECKING:
    from ..dataset.clean import Cleaned
    from ..dataset.loading import LabelledImages
    from ..dataset.loading.augment import Augmentation
    from ..dataset.split import Split, UndoneSplit


#: Descriptions of the entropies in a table, by their measure.
_MEASURES = {
    "grey": "of grey levels (the paper's equation 10)",
    "pooled": "of red, green and blue in one histogram, as the paper's published tables have them; thresholds of the "
    "paper's equation 10 do not fit these",
    "unknown": "by a measure of the table's own; thresholds of the paper's equation 10 do not fit these",
}


def run_clean(arguments: argparse.Namespace) -> int:
    """Mark or move images with too little detail, or undo that."""
    from ..dataset.clean import clean, undo

    if arguments.plot is not None and (arguments.undo or not arguments.plot):
        raise InvalidInput(
            "--plot shows what a threshold rejects: it does not go with --undo"
            if arguments.undo
            else "--plot '': must be the name of a folder, such as . for the current one"
        )
    earlier = set() if arguments.plot is None else {*map(str, Path(arguments.plot).glob("*.png"))}
    if arguments.undo:
        cleaned = undo(arguments.folder, dry_run=arguments.dry_run)
    else:
        cleaned = clean(
            arguments.folder,
            arguments.entropy,
            move=arguments.move,
            dry_run=arguments.dry_run,
            plot=arguments.plot,
        )
    if arguments.json:
        print(json.dumps([asdict(one) for one in cleaned], indent=1))
        return DONE
    for one in cleaned:
        text = _undone(one) if arguments.undo else _cleaned(one, arguments.entropy)
        print(f"{one.map_type:11s} {text}")
    if not arguments.undo:
        for measure in dict.fromkeys(one.measure for one in cleaned):
            print(f"{'entropies':11s} {_MEASURES[measure]}")
        for one in cleaned:
            if one.is_one_sided:
                what = "nearly all" if one.rejected else "nothing"
                print(f"warning: {one.map_type}: the threshold rejects {what}", file=sys.stderr)
    for path in (path for one in cleaned for path in one.figures):
        print(printable(f"{'replaced' if path in earlier else 'written':12s}{path}"))
    if arguments.dry_run:
        print("dry run: nothing was changed" + (" in the dataset" if arguments.plot is not None else ""))
    return DONE


def _cleaned(one: Cleaned, threshold: float) -> str:
    text = f"{one.images:,} images, {one.rejected:,} rejected (entropy below {threshold:g}"
    if one.by_roadmap:
        text += " of the roadmap" + ("" if one.by_roadmap == one.images else f" for {one.by_roadmap:,} of them")
    text += ")"
    if one.failed:
        text += f", {one.failed:,} failed before"
    if one.moved:
        text += f", {one.moved:,} moved to rejected"
    if one.returned:
        text += f", {one.returned:,} moved back"
    if one.suggested is not None:
        text += f"; Otsu's method suggests {one.suggested:.2f}"
        if not one.groups:
            text += ", but the entropies form one group: nothing stands out"
    return text


def _undone(one: Cleaned) -> str:
    if not (one.rejected or one.returned):
        return "nothing to undo"
    return f"{one.rejected:,} images are no longer rejected, {one.returned:,} moved back"


def run_split(arguments: argparse.Namespace) -> int:
    """Divide a dataset into parts and write them to its tables, or undo that."""
    from ..dataset.split import split, undo_split

    if arguments.undo:
        undone = undo_split(arguments.folder, dry_run=arguments.dry_run)
        print(json.dumps(asdict(undone), indent=1) if arguments.json else _undone_split(undone))
        if arguments.dry_run and not arguments.json:
            print("dry run: nothing was changed")
        return DONE
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
        print(json.dumps(_split_document(made), indent=1))
        return DONE
    for line in _split_lines(made):
        print(line)
    if arguments.dry_run:
        print("dry run: nothing was changed")
    return DONE


def _undone_split(undone: UndoneSplit) -> str:
    if not undone.changed:
        return "nothing to undo: the dataset is not split"
    if undone.parts is None:
        return "split undone: images are in no part, and there are no labels"
    counts = ", ".join(f"{part} {count:,}" for part, count in undone.parts.items())
    return f"split undone: the parts and labels before it are back, {counts} images"


def _split_lines(made: Split) -> list[str]:
    shares = made.shares
    lines = [f"{part:12s}{count:,} images ({100.0 * shares[part]:.1f} %)" for part, count in made.images.items()]
    if made.gap:
        lines.append(f"{'gap':12s}{made.gap:,} images in no part: too close to another part's ground")
        if made.gap > sum(made.images.values()):
            lines.append(f"{'':12s}that is most of them: smaller blocks lose more, so try a larger --block")
    if made.unknown:
        lines.append(f"{'unknown':12s}{made.unknown:,} images in no part: they see the horizon or a pole")
    if made.left_out:
        lines.append(f"{'left out':12s}{made.left_out:,} images that failed or are rejected")
    if made.images["test"]:
        lines.append(f"{'ground':12s}{_seen_text(made)}")
    if made.blocks is not None:
        lines.append(f"{'blocks':12s}{made.blocks:,} of {made.block_m:,.0f} m, gap {made.gap_m:g} m")
    labels = made.labels
    lines.append(f"{'labels':12s}{labels.frame.crs} ({labels.frame.name}), scaled by {labels.images:,} images")
    return [*lines, *(f"{'':12s}{note}" for note in labels.notes)]


def _seen_text(made: Split) -> str:
    if made.seen is None:
        return "not known: the test images may see ground of the training part"
    if made.seen == 0.0:
        return "no test image sees ground of the training part"
    advice = "" if made.how == "blocks" else " (blocks leave none)"
    return f"{100.0 * made.seen:.1f} % of the test images see ground of the training part{advice}"


def _split_document(made: Split) -> dict[str, object]:
    names = ("how", "seed", "images", "gap", "unknown", "left_out", "blocks", "block_m", "gap_m", "seen")
    document: dict[str, object] = {name: getattr(made, name) for name in names}
    document.update(images=dict(made.images), shares=made.shares, labels=json.loads(made.labels.to_json()))
    return document


def run_load(arguments: argparse.Namespace) -> int:
    """Load all batches of one epoch; print their shapes and the images per second."""
    from ..mission.settings import resolve

    # These options may also come from the environment and ``config.json``.
    values = resolve(
        {name: getattr(arguments, name) for name in ("img_size", "batch_size", "seed", "dataset")},
        config=arguments.config,
    )
    samples, batches = _loader(arguments, values)
    shapes: Counter[tuple[tuple[int, ...], tuple[tuple[int, ...], ...]]] = Counter()
    begun = time.perf_counter()
    try:
        for images, labels in batches:
            arrays = labels if isinstance(labels, (tuple, list)) else (labels,)
            shapes[tuple(images.shape), tuple(tuple(one.shape) for one in arrays)] += 1
    except InvalidInput as wrong:
        # An error of a PyTorch worker process contains its traceback, whose last line has the message.
        raise InvalidInput(str(wrong).strip().rpartition("\n")[2].rpartition("InvalidInput: ")[2]) from wrong
    seconds = time.perf_counter() - begun
    if arguments.json:
        print(json.dumps(_load_document(arguments, samples, shapes, seconds), indent=1))
    else:
        _print_load(arguments, samples, shapes, seconds)
    return DONE


def _loader(arguments: argparse.Namespace, values: dict[str, Any]) -> tuple[LabelledImages, Iterable[tuple[Any, Any]]]:
    """Samples and batches of the chosen loader."""
    size, workers = values["batch_size"], arguments.workers
    choice = {
        "map_type": arguments.map_type,
        "part": arguments.part,
        "img_size": values["img_size"],
        "seed": values["seed"],
        "layout": values["dataset"],
        "augment": _augmentation(arguments),
        "targets": tuple(arguments.targets),
    }
    if arguments.loader == "torch":
        from ..dataset.loading import torch_loader

        of_torch = torch_loader.TorchDataset(arguments.folder, **choice)
        return of_torch.samples, of_torch.batches(size, workers)
    if arguments.loader == "keras":
        from ..dataset.loading import keras_loader

        if workers:
            raise InvalidInput("workers {0}: must be 0 with keras, which starts its own when it trains", workers)
        of_keras = keras_loader.KerasDataset(arguments.folder, size, **choice)
        return of_keras.samples, (of_keras[index] for index in range(len(of_keras)))
    from ..dataset.loading import Batches, LabelledImages

    samples = LabelledImages(arguments.folder, **choice)
    return samples, Batches(samples, size, workers=workers)


def _augmentation(arguments: argparse.Namespace) -> Augmentation | str | None:
    from ..dataset.loading.augment import Augmentation

    contrast, brightness = arguments.contrast, arguments.brightness
    if arguments.no_augment:
        if contrast is not None or brightness is not None:
            raise InvalidInput("--no-augment: goes with neither --contrast nor --brightness", remedy="leave one out")
        return None
    if contrast is None and brightness is None:
        return "auto"
    shaded = Augmentation(contrast=contrast or 0.0, brightness=brightness or 0.0)
    if {HEIGHT, ATTITUDE} & set(arguments.targets):
        return replace(shaded, rotation_deg=0.0, flip=False, zoom=0.0)
    return shaded


def _load_document(
    arguments: argparse.Namespace, samples: LabelledImages, shapes: Counter[Any], seconds: float
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
        "columns": list(samples.columns),
        "batches": [
            {"count": count, "images": images, "labels": labels[0] if len(labels) == 1 else labels}
            for (images, labels), count in shapes.items()
        ],
        **({"classes": samples.classes.to_json()} if samples.pixel_targets else {}),
        "seconds": seconds,
        "images_per_s": len(samples) / seconds,
    }


def _print_load(arguments: argparse.Namespace, samples: LabelledImages, shapes: Counter[Any], seconds: float) -> None:
    height, width, channels = samples.shape
    part = "all parts" if samples.part == "all" else f"part {samples.part}"
    print(
        f"{samples.images.map_type}, {part}: {len(samples):,} images of {width} x {height} px and {channels} "
        f"channel{'s' * (channels > 1)}, {'augmented' if samples.augment is not None else 'not augmented'}"
    )
    if samples.columns:
        columns = "" if tuple(arguments.targets) == (IMAGE,) else f": {', '.join(samples.columns)}"
        print(f"labels in {samples.labels.frame.crs}, scaled by the images of {samples.labels.fitted_on}{columns}")
        for note in samples.labels.notes:
            print(note)
    if samples.pixel_targets:
        table = samples.classes
        named = "".join(f", {one.id} {one.name}" for one in table.classes)
        print(printable(f"classes 0 background{named}, {table.ignore} ignore"))
    names = (*samples.pixel_targets, *(["labels"] if samples.columns else []))
    types = (*["int64"] * len(samples.pixel_targets), "float32")
    for (images, shape), count in shapes.items():
        labels = ", ".join(f"{name} {of} {dtype}" for name, of, dtype in zip(names, shape, types))
        print(f"{count:,} batch{'es' * (count > 1)}: images {images} {samples.dtype}, {labels}")
    print(f"{len(samples) / seconds:,.0f} images per second ({arguments.loader}, {seconds:.2f} s)")


def run_convert(arguments: argparse.Namespace) -> int:
    """Convert a published dataset to one with TerrAInav's tables."""
    from ..dataset.convert import convert

    converted = convert(arguments.folder, arguments.target, arguments.dataset)
    if arguments.json:
        print(json.dumps([asdict(one) for one in converted], indent=1))
        return DONE
    for one in converted:
        text = f"{one.map_type:11s} {one.images:,} images, {one.framed:,} of which show known ground"
        if one.failed:
            text += f", {one.failed:,} without an image"
        print(text)
    print(printable(f"dataset in {arguments.target}"))
    return DONE


def run_mosaic(arguments: argparse.Namespace) -> int:
    """Write one orthophoto of all images of a dataset."""
    from ..mosaic.orthomosaic import check_ending, make_orthomosaic
    from .flying import Bar

    if arguments.output is not None:
        check_ending(arguments.output)
    bar = Bar(arguments.quiet)

    def progress(share: float) -> bool:
        bar.show("mosaic", share, f"{100.0 * share:.0f} %")
        return True

    try:
        made = make_orthomosaic(
            arguments.folder,
            arguments.output,
            map_type=arguments.map_type,
            gsd_m=arguments.gsd_m,
            progress=progress,
        )
    finally:
        bar.close()
    if arguments.json:
        print(json.dumps(asdict(made), indent=1))
        return DONE
    crs = made.crs if made.crs.startswith("EPSG:") else "the CRS of the source"
    print(
        f"{made.map_type:11s} {made.used:,} of {made.images:,} images, {made.width_px:,} x {made.height_px:,} px of "
        f"{made.gsd_m_per_px:.3g} m in {crs}; {100.0 * made.shown_share:.1f} % of it shows ground"
    )
    print(printable(f"{'written':11s} {made.path}"))
    return DONE
