"""Train a small convolutional network to say where an image was taken; for a look at how a dataset is used.

    terrainav split OUT
    python examples/train_position.py OUT --steps 60

It shows the images of a few batches again and again, which the network learns by heart: that the loss falls tells
that images and labels belong together and reach the network, not that it would find its place on images it has not
seen. Prints the loss of each step, and ends with exit code 1 where it has not fallen to half.
"""

from __future__ import annotations

import argparse
import sys

import torch
from terrainav.core.dataset.loading.augment import Augmentation
from terrainav.core.dataset.loading.torch_loader import TorchDataset
from terrainav.core.errors import TerrAInavError
from torch import nn

#: The last steps' mean loss is to be at most so much of the first steps'.
FALLEN = 0.5


def network(channels: int) -> nn.Module:
    """Four strided convolutions, their mean over the image, and a linear layer to easting and northing."""
    layers: list[nn.Module] = []
    for width in (16, 32, 64, 64):
        layers += [nn.Conv2d(channels, width, 3, stride=2, padding=1), nn.BatchNorm2d(width), nn.ReLU()]
        channels = width
    return nn.Sequential(*layers, nn.AdaptiveAvgPool2d(2), nn.Flatten(), nn.Linear(4 * channels, 2))


def train(dataset: TorchDataset, steps: int, batch_size: int, batches: int, seed: int) -> list[float]:
    """Loss of each step, the mean squared error of the scaled labels, on the first few batches."""
    torch.manual_seed(seed)
    shown = [pair for pair, _ in zip(dataset.batches(batch_size), range(batches))]
    model = network(shown[0][0].shape[1])
    optimizer = torch.optim.Adam(model.parameters(), lr=3e-3)
    losses = []
    for step in range(steps):
        images, labels = shown[step % len(shown)]
        optimizer.zero_grad()
        loss = nn.functional.mse_loss(model(images), labels)
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
        print(f"step {step + 1}: loss {losses[-1]:.4f}", flush=True)
    return losses


def main() -> int:
    """Train, and say whether the loss has fallen."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", metavar="OUT", help="the dataset's folder")
    parser.add_argument("--part", default="train", help="default train; all for a dataset without a split")
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--batch-size", type=int, default=8)
    parser.add_argument("--batches", type=int, default=2, help="so many are learnt by heart (default 2)")
    parser.add_argument("--img-size", type=int, nargs=3, default=(64, 64, 3), metavar=("W", "H", "C"))
    parser.add_argument("--seed", type=int, default=2024)
    parser.add_argument("--augment", action="store_true", help="turn, mirror and zoom them, once for all")
    asked = parser.parse_args()
    if min(asked.steps, asked.batches) < 1:
        parser.error("--steps and --batches must be 1 or more")
    dataset = TorchDataset(
        asked.folder,
        part=asked.part,
        img_size=asked.img_size,
        seed=asked.seed,
        augment=Augmentation() if asked.augment else None,
    )
    losses = train(dataset, asked.steps, asked.batch_size, asked.batches, asked.seed)
    few = max(min(asked.batches, len(losses) // 2), 1)
    first, last = sum(losses[:few]) / few, sum(losses[-few:]) / few
    fallen = last <= FALLEN * first
    verdict = "falls" if fallen else "does not fall"
    print(f"mean loss of the first {few} steps {first:.4f}, of the last {last:.4f}: {verdict}")
    return 0 if fallen else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except TerrAInavError as wrong:
        sys.exit(f"train_position: {wrong}")
