"""Train a small network to name the class of each pixel, and judge it on ground of another place.

    python examples/world_houses.py 35.1460_-89.8970_35.1340_-89.8670 here.geojson
    python examples/world_houses.py 48.1640_16.3300_48.1520_16.3450 there.geojson
    for place in "here 35.1460_-89.8970_35.1340_-89.8670" "there 48.1640_16.3300_48.1520_16.3450"; do set -- $place
        terrainav capture --coords "$2_100" --tilt 30 --yaw 30 --zoom 18 --labels $1.geojson:roof --data-dir $1; done
    python examples/train_segmentation.py here there

Any two datasets captured with labels of the same classes will do. A small network like U-Net (Ronneberger, Fischer,
Brox, arXiv 1505.04597) learns from all images of the first for `--minutes`, and then names the classes of the second.
The same network also learns from labels of other images, which can teach it only how frequent classes are and where in
an image: what the first network has beyond that, it has from images and labels that belong together. Ends with exit
code 1 where that is nothing.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from typing import NamedTuple

import numpy as np
import torch
from terrainav.core.dataset.loading.augment import Augmentation
from terrainav.core.dataset.loading.torch_loader import TorchDataset
from terrainav.core.errors import TerrAInavError
from torch import nn

#: Channels at a half, a quarter and an eighth of the image's size, of which its sides are multiples.
WIDTHS = (16, 32, 64)
COARSEST_PX = 2 ** len(WIDTHS)
#: Greatest rate of learning, reached after a tenth of the time.
RATE = 1e-2


class Score(NamedTuple):
    """Share of right pixels, and for each class intersection over union; NaN for a class that is not there."""

    accuracy: float
    iou: np.ndarray

    @property
    def mean_iou(self) -> float:
        """Mean over the classes."""
        return float(np.nanmean(self.iou))


def block(channels: int, width: int, stride: int = 1) -> nn.Module:
    """A convolution, normalised."""
    return nn.Sequential(nn.Conv2d(channels, width, 3, stride, 1, bias=False), nn.BatchNorm2d(width), nn.ReLU())


class Network(nn.Module):
    """Scores (b, classes, height, width): down to the coarsest scale, and up again, adding what each scale has seen."""

    def __init__(self, channels: int, classes: int) -> None:
        super().__init__()
        steps = list(zip((channels, *WIDTHS), WIDTHS))
        self.down = nn.ModuleList(nn.Sequential(block(of, to, 2), block(to, to)) for of, to in steps)
        self.fewer = nn.ModuleList(nn.Conv2d(to, of, 1) for of, to in steps[:0:-1])
        self.up = nn.ModuleList(block(of, of) for of, _ in steps[:0:-1])
        self.last = nn.Conv2d(WIDTHS[0], classes, 1)

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        """Score each class at each pixel."""
        seen = []
        for one in self.down:
            images = one(images)
            seen.append(images)
        for fewer, one, finer in zip(self.fewer, self.up, seen[-2::-1]):
            images = one(nn.functional.interpolate(fewer(images), scale_factor=2) + finer)
        return nn.functional.interpolate(self.last(images), scale_factor=2, mode="bilinear")


class Classes:
    """Classes of a dataset: ids as indices from 0, *ignore* as -1."""

    def __init__(self, dataset: TorchDataset) -> None:
        table = dataset.samples.classes
        self.names = ("background", *(one.name for one in table.classes))
        self._index = torch.full((table.ignore + 1,), -1)
        self._index[[0, *(one.id for one in table.classes)]] = torch.arange(len(self.names))

    def __len__(self) -> int:
        return len(self.names)

    def index(self, ids: torch.Tensor) -> torch.Tensor:
        """Indices of class ids."""
        return self._index[ids]


def train(dataset: TorchDataset, classes: Classes, asked: argparse.Namespace, noise: bool) -> Network:
    """Train a network for the time asked; with noise, on labels of other images of the batch."""
    torch.manual_seed(asked.seed)
    network = Network(dataset.samples.shape[2], len(classes)).to(memory_format=torch.channels_last)
    optimizer = torch.optim.AdamW(network.parameters(), weight_decay=1e-2)
    loader = dataset.batches(asked.batch_size, asked.workers, drop_last=True)
    begun, losses, epoch, share = time.monotonic(), [], 0, 0.0
    while share < 1.0:
        dataset.set_epoch(epoch)
        for images, labels in loader:
            optimizer.param_groups[0]["lr"] = RATE * min(10.0 * share + 0.01, 0.5 + 0.5 * math.cos(math.pi * share))
            wanted = classes.index(labels.roll(1, 0) if noise else labels)
            loss = nn.functional.cross_entropy(network(images), wanted, ignore_index=-1)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            losses.append(loss.item())
            share = max((time.monotonic() - begun) / 60.0 / asked.minutes, len(losses) / len(loader) / asked.epochs)
            if share >= 1.0:
                break
        epoch += 1
    name, last = "noise" if noise else "labels", np.mean(losses[-len(loader) :])
    print(f"{name}: {len(losses):,} steps, {len(losses) / len(loader):.1f} epochs, loss {last:.3f}", flush=True)
    return network.eval()


def confusion(wanted: np.ndarray, found: np.ndarray, count: int) -> np.ndarray:
    """Number of pixels (count, count) by their class and by the class found; index -1 is left out."""
    known = wanted >= 0
    return np.bincount(wanted[known] * count + found[known], minlength=count * count).reshape(count, count)


def judge(network: Network, dataset: TorchDataset, classes: Classes, batch_size: int) -> np.ndarray:
    """Confusion of all pixels of a dataset."""
    total = np.zeros((len(classes), len(classes)), np.int64)
    with torch.inference_mode():
        for images, labels in dataset.batches(batch_size):
            found = network(images).argmax(dim=1)
            total += confusion(classes.index(labels).numpy().ravel(), found.numpy().ravel(), len(classes))
    return total


def score(pixels: np.ndarray) -> Score:
    """Score of a confusion, also of an expected one."""
    right, either = np.diag(pixels), pixels.sum(axis=0) + pixels.sum(axis=1) - np.diag(pixels)
    with np.errstate(invalid="ignore"):
        iou = np.where(pixels.sum(axis=1) > 0, right / either, np.nan)
    return Score(float(right.sum() / pixels.sum()), iou)


def chance(trained_on: np.ndarray, judged_on: np.ndarray) -> dict[str, Score]:
    """Scores without looking at images, by the numbers of pixels of each class: the most frequent class, and a draw."""
    shares = trained_on / trained_on.sum()
    majority = np.eye(len(shares))[shares.argmax()]
    return {
        "majority class": score(np.outer(judged_on, majority)),
        "random by frequency": score(np.outer(judged_on, shares)),
    }


def frequencies(dataset: TorchDataset, classes: Classes) -> np.ndarray:
    """Number of pixels of each class."""
    counts = np.zeros(len(classes), np.int64)
    for _, labels in dataset.batches():
        found = classes.index(labels)
        counts += np.bincount(found[found >= 0].numpy(), minlength=len(classes))
    return counts


def main() -> int:
    """Train twice, judge, and say what that shows."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("train", metavar="HERE", help="dataset with labels to train on")
    parser.add_argument("test", metavar="THERE", help="dataset with the same classes of another place")
    parser.add_argument("--minutes", type=float, default=5.0, help="of each training (default 5)")
    parser.add_argument("--epochs", type=int, default=1_000_000, help="most epochs of each training")
    parser.add_argument("--batch-size", type=int, default=8)
    parser.add_argument("--img-size", type=int, nargs=3, default=(256, 192, 3), metavar=("W", "H", "C"))
    parser.add_argument("--workers", type=int, default=0, help="processes that load images (default 0)")
    parser.add_argument("--seed", type=int, default=2024)
    asked = parser.parse_args()
    if asked.minutes <= 0.0 or asked.epochs < 1 or asked.batch_size < 2:
        parser.error("--minutes must be above 0, --epochs 1 or more, and --batch-size 2 or more")
    if any(side % COARSEST_PX for side in asked.img_size[:2]):
        parser.error(f"--img-size must be multiples of {COARSEST_PX}")
    common = {"part": "all", "img_size": tuple(asked.img_size), "targets": ("classes",), "seed": asked.seed}
    turned = Augmentation(180.0, contrast=0.2, brightness=0.1)
    here = TorchDataset(asked.train, shuffle=True, augment=turned, **common)
    plain, there = (TorchDataset(one, augment=None, **common) for one in (asked.train, asked.test))
    classes = Classes(here)
    if Classes(there).names != classes.names:
        sys.exit(f"train_segmentation: {asked.test} has the classes {', '.join(Classes(there).names)}")
    print(f"{len(here):,} images to train on, {len(there):,} to judge by: {', '.join(classes.names)}")
    scores = {}
    for name, noise in (("network", False), ("noise labels", True)):
        scores[name] = score(judge(train(here, classes, asked, noise), there, classes, asked.batch_size))
    scores.update(chance(frequencies(plain, classes), frequencies(there, classes)))
    print(
        f"{'on other ground':20s}{'accuracy':>10s}{'mIoU':>8s}" + "".join(f"{name[:12]:>14s}" for name in classes.names)
    )
    for name, one in scores.items():
        shares = "".join(f"{value:14.3f}" for value in one.iou)
        print(f"{name:20s}{100.0 * one.accuracy:8.1f} %{one.mean_iou:8.3f}{shares}")
    network, *others = scores.values()
    better = all(network.mean_iou > one.mean_iou for one in others)
    print("better than noise and chance" if better else "no better than noise or chance")
    return 0 if better else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except TerrAInavError as wrong:
        sys.exit(f"train_segmentation: {wrong}")
