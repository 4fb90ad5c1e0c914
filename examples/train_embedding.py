r"""Train a small embedding on images of one date, and judge how well it finds places on other dates.

    AREA=47.0290_-99.1775_47.0085_-99.1330
    terrainav benchmark make --coords ${AREA}_400 --yaw 30 --format png --split none \
        --queries 2009=2009.tif 2014=2014.tif 2020=2020.tif --reference 2014=2014.tif --data-dir bench
    WIDER="--coords ${AREA}_550 --aspect-ratio 1 1 --overlap 0.85 --img-size 128 128 3 --bands 1 2 3 --source 2014.tif"
    terrainav capture $WIDER --data-dir ideal
    for seed in 1 2 3; do terrainav capture $WIDER --seed $seed --data-dir varied-$seed \
        --exposure manual --exposure-ms 1.5 --vary "exposure_ms=lognormal(1.5,0.4) within(0.5,4)" \
        "white_balance_k=uniform(4500,9000)" "visibility_km=loguniform(2,50)"; done
    python examples/train_embedding.py bench ideal                     # from ideal images alone
    python examples/train_embedding.py bench ideal varied-?            # and from those of real cameras

The folders have the same places, in images of which each is wider than a query. The network learns from pairs of crops
of a place, up to half a tile apart, each from any of the folders, which crops belong together (InfoNCE; van den Oord,
Li, Vinyals, arXiv 1807.03748). Then it ranks the benchmark's tiles for each query, turned to the north by its compass.
Prints the share of queries with a right tile at first rank (Recall@1) for each imagery of the queries: the mean and
standard deviation over several seeds.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
import torch
from PIL import Image
from terrainav.core.benchmark.answers import visible_query
from terrainav.core.benchmark.folder import Benchmark
from terrainav.core.benchmark.metrics import hits, recall
from terrainav.core.dataset.dataset import open_image
from terrainav.core.dataset.loading.torch_loader import TorchDataset
from terrainav.core.errors import TerrAInavError
from torch import nn

#: Side of the crops, px: the largest square, north up, in queries that are turned by any angle.
SIDE_PX = 56
#: Most that two crops of a place are apart, px: half the distance between tiles.
APART_PX = 22
#: How sharply likeness counts, and length of the vectors.
TEMPERATURE, LENGTH = 0.1, 128


def network() -> nn.Module:
    """Four convolutions, three of them strided, their mean over a 4 x 4 grid, and a linear layer."""
    layers: list[nn.Module] = []
    channels = 3
    for width, stride in ((32, 2), (64, 2), (96, 2), (96, 1)):
        layers += [nn.Conv2d(channels, width, 3, stride, 1), nn.BatchNorm2d(width), nn.ReLU()]
        channels = width
    return nn.Sequential(*layers, nn.AdaptiveAvgPool2d(4), nn.Flatten(), nn.Linear(16 * channels, LENGTH))


def places(folders: list[str]) -> torch.Tensor:
    """Images (folders, places, channels, height, width) from 0 to 1 of the places that all folders have."""
    sets = [TorchDataset(folder, part="all", shuffle=False, augment=None) for folder in folders]
    where = [{name: at for at, name in enumerate(one.samples.names)} for one in sets]
    names = sorted(set.intersection(*map(set, where)))
    return torch.stack([one[[rows[name] for name in names]][0] for one, rows in zip(sets, where)])


def crops(images: torch.Tensor, left: torch.Tensor, top: torch.Tensor) -> torch.Tensor:
    """Square crops (b, channels, side, side) of images (b, channels, height, width)."""
    across, down = (start[:, None] + torch.arange(SIDE_PX) for start in (left, top))
    rows = torch.arange(len(images))[:, None, None]
    return images[rows, :, down[:, :, None], across[:, None, :]].permute(0, 3, 1, 2)


class Standardised(nn.Module):
    """Images with mean 0 and deviation 1 in each channel, which undoes most of what exposure and white balance do."""

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        """Standardise images (b, channels, height, width)."""
        spread, mean = torch.std_mean(images, dim=(2, 3), keepdim=True)
        return (images - mean) / (spread + 1e-3)


def train(images: torch.Tensor, steps: int, batch_size: int, seed: int, *, standardise: bool) -> nn.Module:
    """Network trained on pairs of crops of one place."""
    generator = torch.Generator().manual_seed(seed)
    torch.manual_seed(seed)
    net = nn.Sequential(Standardised() if standardise else nn.BatchNorm2d(3, affine=False), network())
    optimizer = torch.optim.AdamW(net.parameters(), lr=2e-3, weight_decay=1e-2)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, 2e-3, total_steps=steps)
    folders, count, _, height, width = images.shape

    def whole(most: int, low: int = 0) -> torch.Tensor:
        return torch.randint(low, most + 1, (batch_size,), generator=generator)

    for _ in range(steps):
        at = torch.randperm(count, generator=generator)[:batch_size]
        # Both crops lie inside the image.
        left, top = whole(width - SIDE_PX), whole(height - SIDE_PX)
        beside = (left + whole(APART_PX, -APART_PX)).clamp(0, width - SIDE_PX)
        below = (top + whole(APART_PX, -APART_PX)).clamp(0, height - SIDE_PX)
        pair = [
            nn.functional.normalize(net(crops(images[whole(folders - 1), at], x, y)), dim=1)
            for x, y in ((left, top), (beside, below))
        ]
        scores = pair[0] @ pair[1].T / TEMPERATURE
        right = torch.arange(batch_size)
        loss = nn.functional.cross_entropy(scores, right) + nn.functional.cross_entropy(scores.T, right)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        schedule.step()
    return net.eval()


def middle(image: Image.Image) -> torch.Tensor:
    """The square in the middle of an image (channels, side, side), from 0 to 1."""
    left, top = (image.width - SIDE_PX) // 2, (image.height - SIDE_PX) // 2
    pixels = np.asarray(image.convert("RGB").crop((left, top, left + SIDE_PX, top + SIDE_PX)), np.float32) / 255.0
    return torch.from_numpy(pixels).permute(2, 0, 1)


class Judge:
    """The queries and tiles of a benchmark, as a network sees them."""

    def __init__(self, benchmark: Benchmark) -> None:
        tiles = benchmark.references
        self.benchmark = benchmark
        self.tiles = torch.stack([middle(open_image(benchmark.folder / file, as_shown=True)) for file in tiles.file])
        self.queries = torch.stack([self._north_up(at) for at in range(len(benchmark.queries))])

    def _north_up(self, index: int) -> torch.Tensor:
        query = visible_query(self.benchmark, index)
        seen = open_image(query.image, as_shown=True).convert("RGB")
        return middle(seen.rotate(-query.yaw_deg, Image.BILINEAR, expand=True))

    def recall(self, net: nn.Module) -> dict[str, float]:
        """Recall@1 by the imagery of the queries."""
        with torch.inference_mode():
            queries, tiles = (nn.functional.normalize(net(one), dim=1) for one in (self.queries, self.tiles))
        ranking = (queries @ tiles.T).argsort(dim=1, descending=True).numpy()
        rows, positives = self.benchmark.reference_rows, self.benchmark.truth
        right: dict[str, list[int]] = {}
        for query, reference in zip(positives.query, positives.reference):
            right.setdefault(query, []).append(rows[reference])
        ids, kinds = self.benchmark.queries.id, np.array(self.benchmark.queries.imagery)
        found = hits(ranking, [np.array(right.get(one, []), np.int64) for one in ids])
        return {kind: recall(found[kinds == kind], 1) for kind in sorted(set(kinds.tolist()))}


def main() -> int:
    """Train with each seed, judge, and print what that gives."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("benchmark", help="the benchmark's folder")
    parser.add_argument("folders", metavar="OUT", nargs="+", help="datasets of the same places")
    parser.add_argument("--steps", type=int, default=500)
    parser.add_argument("--batch-size", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--standardise", action="store_true", help="give each image the same mean and contrast first")
    asked = parser.parse_args()
    if asked.steps < 1 or asked.batch_size < 2 or asked.seeds < 1:
        parser.error("--steps and --seeds must be 1 or more, and --batch-size 2 or more")
    torch.set_num_threads(1)
    judge, images = Judge(Benchmark.read(asked.benchmark)), places(asked.folders)
    if min(images.shape[3:]) < SIDE_PX or images.shape[1] < asked.batch_size:
        parser.error(f"needs {asked.batch_size} places or more, in images of {SIDE_PX} px or more")
    print(f"{images.shape[1]} places in {len(images)} datasets, {len(judge.queries)} queries, {len(judge.tiles)} tiles")
    shares = []
    for seed in range(asked.seeds):
        net = train(images, asked.steps, asked.batch_size, seed, standardise=asked.standardise)
        shares.append(judge.recall(net))
        print(
            f"seed {seed}: " + ", ".join(f"{kind} {100.0 * share:.1f} %" for kind, share in shares[-1].items()),
            flush=True,
        )
    for kind in shares[0]:
        values = 100.0 * np.array([one[kind] for one in shares])
        deviation = values.std(ddof=1) if len(values) > 1 else 0.0
        print(f"Recall@1 of {kind}: {values.mean():.1f} %, deviation {deviation:.1f}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except TerrAInavError as wrong:
        sys.exit(f"train_embedding: {wrong}")
