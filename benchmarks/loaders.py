"""What each loader delivers in images per second, beside a plain loop with Pillow.

    python benchmarks/loaders.py            # writes docs/loaders.md
    python benchmarks/loaders.py --folder OUT --map-type satellite

Without a folder, a part of the paper's Agricenter box is captured from the embedded world, in the pixels that
docs/datasets.md takes for a training. All loaders take the same images in turns within one run, after a round to warm
up in which workers start. Takes about two minutes on two cores.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.dataset import open_image, read_dataset
from terrainav.core.dataset.loading import Batches, LabelledImages
from terrainav.core.dataset.loading.augment import Augmentation
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.report.machine import machine, versions
from terrainav.core.storage.files import write_whole
from terrainav.core.timing import Effort, timed_together

ROOT = Path(__file__).resolve().parents[1]
BOX, AGL_M, ZOOM = Box(35.160, -89.900, 35.150, -89.888), 120.0, 18
SIZE, BATCH = (224, 224, 3), 8
EFFORT = Effort(5, 15, 4.0)
WORKERS = 2
SHARDS = "## Shards and object stores"


def captured(folder: Path, image_format: str) -> Path:
    """Capture the mission as files of a format; returns its folder."""
    source = open_source("world")
    target = folder / image_format
    capture(plan(Mission(BOX, AGL_M, zoom=ZOOM, image_format=image_format), source.grid), source, target)
    return target


def plain(paths: Sequence[Path]) -> None:
    """The floor: what anyone would write with Pillow and numpy, without labels, checks or augmentation."""
    for start in range(0, len(paths), BATCH):
        images = []
        for path in paths[start : start + BATCH]:
            with Image.open(path) as image:
                images.append(np.asarray(image.convert("RGB").resize(SIZE[:2], Image.BILINEAR)))
        np.stack(images).astype(np.float32) / np.float32(255.0)


def keras_training(batches: Any) -> Callable[[], object]:
    """``fit`` of a model that does nothing, so that Keras's own queue is measured."""
    import keras

    class Idle(keras.Model):
        """Takes batches and learns nothing."""

        def call(self, images: Any) -> Any:
            """Return the images."""
            return images

        def train_step(self, data: Any) -> dict[str, float]:  # noqa: ARG002 (Keras's interface)
            """Leave the batch as it is."""
            return {}

    model = Idle()
    model.compile(run_eagerly=True)
    model(np.zeros((1, SIZE[1], SIZE[0], SIZE[2]), np.float32))
    return lambda: model.fit(batches, verbose=0, shuffle=False)


def loaders(folder: Path, map_type: str | None, augment: Augmentation | None) -> dict[str, Callable[[], object]]:
    """Each loader's work: all batches once."""
    from terrainav.core.dataset.loading.keras_loader import KerasDataset
    from terrainav.core.dataset.loading.torch_loader import TorchDataset

    choice = {"map_type": map_type, "part": "all", "img_size": SIZE, "augment": augment}
    dataset = read_dataset(folder)
    of_torch, of_bytes = TorchDataset(dataset, **choice), TorchDataset(dataset, dtype="uint8", **choice)

    def every(batches: Any) -> Callable[[], object]:
        return lambda: sum(len(labels) for _, labels in batches)

    of_keras = KerasDataset(dataset, BATCH, **choice)
    return {
        "numpy": every(Batches(dataset, BATCH, **choice)),
        f"numpy, {WORKERS} threads": every(Batches(dataset, BATCH, workers=WORKERS, **choice)),
        "torch": every(of_torch.batches(BATCH)),
        f"torch, {WORKERS} processes": every(of_torch.batches(BATCH, WORKERS)),
        f"torch, {WORKERS} processes, uint8": every(of_bytes.batches(BATCH, WORKERS)),
        "keras": lambda: [of_keras[index] for index in range(len(of_keras))],
        f"keras, fit with {WORKERS} threads": keras_training(KerasDataset(dataset, BATCH, workers=WORKERS, **choice)),
    }


def stages(samples: LabelledImages, augment: Augmentation) -> list[tuple[str, float]]:
    """Milliseconds an image takes in each step of the way."""
    some = range(min(len(samples), 32))
    whole = [open_image(samples.path(index)) for index in some]
    sized = [image.resize(SIZE[:2], Image.BILINEAR) for image in whole]
    shaded = Augmentation(0.0, flip=False, zoom=0.0, contrast=0.1, brightness=0.1)
    works = {
        "read and decode": lambda: [open_image(samples.path(index)) for index in some],
        "resize": lambda: [image.resize(SIZE[:2], Image.BILINEAR) for image in whole],
        "rotate, flip, zoom": lambda: [augment.apply(one, samples.names[k], 1, 1) for k, one in enumerate(sized)],
        "contrast, brightness": lambda: [shaded.apply(one, samples.names[k], 1, 1) for k, one in enumerate(sized)],
        "to float32": lambda: [np.divide(np.asarray(one), np.float32(255), dtype=np.float32) for one in sized],
    }
    measured = timed_together(list(works.values()), EFFORT, time.perf_counter)
    return [(name, 1e3 * seconds.median / len(some)) for name, (_, seconds) in zip(works, measured)]


def measure(name: str, folder: Path, map_type: str | None) -> list[str]:
    """Lines of the page about one dataset."""
    samples = LabelledImages(folder, map_type=map_type, part="all", img_size=SIZE)
    paths = [samples.path(index) for index in range(len(samples))]
    with Image.open(paths[0]) as first:
        before = f"{first.width} x {first.height} px"
    augment = Augmentation()
    bare, changed = loaders(folder, map_type, None), loaders(folder, map_type, augment)
    works = [lambda: plain(paths), *bare.values(), *changed.values()]
    # By the clock on the wall: the loaders' workers are processes of their own.
    rates = [len(paths) / seconds.median for _, seconds in timed_together(works, EFFORT, time.perf_counter)]
    floor = rates[0]
    lines = [
        f"## {name}",
        "",
        f"{len(paths)} images of {before}.",
        "",
        "| loader | images/s | of the plain loop | augmented, images/s | of the plain loop |",
        "| --- | ---: | ---: | ---: | ---: |",
        f"| plain loop with Pillow | {floor:,.0f} | 100 % | | |",
    ]
    for key, plainly, augmented in zip(bare, rates[1:], rates[1 + len(bare) :]):
        lines.append(f"| {key} | {plainly:,.0f} | {plainly / floor:.0%} | {augmented:,.0f} | {augmented / floor:.0%} |")
    lines += ["", "| step | ms an image |", "| --- | ---: |"]
    lines += [f"| {step} | {ms:.2f} |" for step, ms in stages(samples, augment)]
    print("\n".join(lines), flush=True)
    return [*lines, ""]


def page(sections: Sequence[str]) -> str:
    """The page's text."""
    told = ", ".join(f"{name} {value}" for name, value in [*machine(), *versions()])
    import keras
    import torch

    told += f", torch {torch.__version__}, Keras {keras.__version__}"
    if hasattr(os, "getloadavg"):
        told += f"; load average {os.getloadavg()[0]:.1f}"
    return "\n".join(
        [
            "# Loaders",
            "",
            f"Made by `python benchmarks/loaders.py` on {told}.",
            f"Images are resized to {SIZE[0]} x {SIZE[1]} px with {SIZE[2]} channels in batches of {BATCH}, as float32",
            "unless stated; files are in the system's cache. All loaders take turns in one run; rates are from the",
            "median round. The plain loop is hand-written code with Pillow and numpy, in one thread, without labels",
            "or augmentation. Augmented images are rotated, flipped and zoomed. The images are those of",
            "[Datasets](datasets.md), captured with `--zoom 18`.",
            "",
            *sections,
        ]
    )


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--folder", type=Path, help="a dataset, instead of the embedded world's")
    parser.add_argument("--map-type")
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "loaders.md")
    asked = parser.parse_args()
    os.environ.setdefault("KERAS_BACKEND", "torch")
    lines: list[str] = []
    if asked.folder is not None:
        lines += measure("The dataset's files", asked.folder, asked.map_type)
    else:
        with tempfile.TemporaryDirectory() as name:
            for image_format, title in (("jpg", "JPEG"), ("tif", "GeoTIFF")):
                lines += measure(title, captured(Path(name), image_format), None)
    # What is said of shards stays: benchmarks/shard_loaders.py measures those.
    written = asked.output.read_text(encoding="utf-8") if asked.output.is_file() else ""
    _, heading, rest = written.partition(SHARDS)
    write_whole(asked.output, [(page(lines) + heading + rest).encode("utf-8")])


if __name__ == "__main__":
    main()
