"""Train a small network to find the roadmap of a satellite image, and judge it on ground that it has not seen.

    terrainav capture … --map-type satellite roadmap --data-dir OUT
    terrainav split OUT
    python examples/train_matching.py OUT

Two towers learn one vector for an image and for its roadmap, from the training part alone (InfoNCE; van den Oord, Li,
Vinyals, arXiv 1807.03748). The judge gives each satellite image of the test part all roadmaps of that part to rank.
What is found at first rank beyond what chance finds shows that images, places and parts belong together: with --noise
the training's roadmaps are shuffled, and the network has to fail. Ends with exit code 1 where it is no better than
chance.
"""

from __future__ import annotations

import argparse
import math
import sys

import numpy as np
import torch
from terrainav.core.dataset.loading.torch_loader import TorchDataset
from terrainav.core.errors import TerrAInavError
from torch import nn

#: Better than chance is what chance would reach once in a thousand runs.
CHANCE = 1e-3
#: How sharply likeness counts, and length of the vectors.
TEMPERATURE, LENGTH = 0.1, 64


def tower(channels: int) -> nn.Module:
    """Four strided convolutions, their mean over a 2 x 2 grid, and a linear layer."""
    layers: list[nn.Module] = []
    for width in (16, 32, 64, 64):
        layers += [nn.Conv2d(channels, width, 3, stride=2, padding=1), nn.BatchNorm2d(width), nn.ReLU()]
        channels = width
    return nn.Sequential(*layers, nn.AdaptiveAvgPool2d(4), nn.Flatten(), nn.Linear(16 * channels, LENGTH))


def pairs(folder: str, part: str, img_size: tuple[int, int, int]) -> tuple[torch.Tensor, torch.Tensor]:
    """Satellite images and roadmaps (n, channels, height, width) of the same places, in one order."""
    satellite, roadmap = (
        TorchDataset(folder, map_type=name, part=part, img_size=img_size, shuffle=False, augment=None)
        for name in ("satellite", "roadmap")
    )
    where = {name: at for at, name in enumerate(roadmap.samples.names)}
    both = [(at, where[name]) for at, name in enumerate(satellite.samples.names) if name in where]
    return satellite[[one for one, _ in both]][0], roadmap[[other for _, other in both]][0]


def likeness(towers: nn.ModuleList, images: torch.Tensor, maps: torch.Tensor) -> torch.Tensor:
    """Cosines (n, m) between the vectors of images and of maps."""
    vectors = (nn.functional.normalize(one(values), dim=1) for one, values in zip(towers, (images, maps)))
    first, second = vectors
    return first @ second.T


def turned(images: torch.Tensor, how: int) -> torch.Tensor:
    """Images turned by quarters and mirrored in one of eight ways."""
    quarter = torch.rot90(images, how % 4, (2, 3)) if images.shape[2] == images.shape[3] else images
    return quarter.flip(3) if how >= 4 else quarter


def train(images: torch.Tensor, maps: torch.Tensor, epochs: int, batch_size: int, seed: int) -> nn.ModuleList:
    """Towers trained on pairs, each turned and mirrored as one."""
    generator = torch.Generator().manual_seed(seed)
    torch.manual_seed(seed)
    towers = nn.ModuleList([tower(images.shape[1]), tower(maps.shape[1])])
    optimizer = torch.optim.AdamW(towers.parameters(), lr=2e-3, weight_decay=1e-2)
    for epoch in range(epochs):
        losses = []
        for some in torch.randperm(len(images), generator=generator).split(batch_size):
            how = int(torch.randint(8, (), generator=generator))
            scores = likeness(towers, turned(images[some], how), turned(maps[some], how)) / TEMPERATURE
            right = torch.arange(len(some))
            loss = (nn.functional.cross_entropy(scores, right) + nn.functional.cross_entropy(scores.T, right)) / 2.0
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            losses.append(loss.item())
        if epoch % 10 == 9 or epoch == epochs - 1:
            print(f"epoch {epoch + 1}: loss {np.mean(losses):.3f}", flush=True)
    return towers.eval()


def found(towers: nn.ModuleList, images: torch.Tensor, maps: torch.Tensor) -> int:
    """How many images have their own map as the likest one."""
    with torch.inference_mode():
        return int((likeness(towers, images, maps).argmax(dim=1) == torch.arange(len(images))).sum())


def by_chance(hits: int, count: int) -> float:
    """Probability of so many hits or more where each of so many maps is as likely as the others."""
    share = 1.0 / count
    return sum(math.comb(count, one) * share**one * (1.0 - share) ** (count - one) for one in range(hits, count + 1))


def main() -> int:
    """Train, judge, and say what that shows."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", metavar="OUT", help="the dataset's folder, with satellite images and roadmaps")
    parser.add_argument("--epochs", type=int, default=40)
    parser.add_argument("--batch-size", type=int, default=32)
    parser.add_argument("--img-size", type=int, nargs=3, default=(64, 64, 3), metavar=("W", "H", "C"))
    parser.add_argument("--seed", type=int, default=2024)
    parser.add_argument(
        "--noise", action="store_true", help="shuffle the roadmaps of the training part: it has to fail"
    )
    asked = parser.parse_args()
    if asked.epochs < 1 or asked.batch_size < 2:
        parser.error("--epochs must be 1 or more, and --batch-size 2 or more")
    size = tuple(asked.img_size)
    images, maps = pairs(asked.folder, "train", size)
    test = pairs(asked.folder, "test", size)
    if asked.noise:
        maps = maps[torch.randperm(len(maps), generator=torch.Generator().manual_seed(asked.seed))]
    print(f"{len(images)} places to train on, {len(test[0])} to test with")
    towers = train(images, maps, asked.epochs, asked.batch_size, asked.seed)
    hits, count = found(towers, *test), len(test[0])
    better = by_chance(hits, count) < CHANCE
    verdict = "better than chance" if better else "no better than chance"
    print(f"test, on ground not seen before: {hits} of {count} at first rank, 1 by chance: {verdict}")
    return 0 if better else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except TerrAInavError as wrong:
        sys.exit(f"train_matching: {wrong}")
