"""A method for `terrainav benchmark run`: the tile whose embedding is nearest, by any network that gives one.

    terrainav benchmark run BENCHMARK --method locate_by_embedding:dinov2     # in the folder of this file

`dinov2` takes its weights from PyTorch Hub (facebookresearch/dinov2), which needs the network once, and PyTorch.
`mean_colours` needs neither: it shows the way, and what a method without a network gets.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image
from terrainav.core.benchmark.answers import Answer, Query
from terrainav.core.benchmark.folder import Benchmark
from terrainav.core.dataset.dataset import open_image

#: An image to a vector.
Embed = Callable[[Image.Image], np.ndarray]
#: Tiles that are ranked for a query.
RANKED = 100
#: What DINOv2 was trained with: pixels of a patch, mean and spread of ImageNet's colours.
SIDE_PX, MEAN, SPREAD = 224, (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)


def by_embedding(embed: Embed, benchmark: Benchmark, gallery: np.ndarray) -> Callable[[Query], Answer]:
    """Locate queries by the cosine of the angle between their embedding and that of each tile."""
    tiles = benchmark.references
    ids = [tiles.id[at] for at in gallery]
    known = np.stack([unit(embed(picture(benchmark.folder / tiles.file[at]))) for at in gallery])

    def locate(query: Query) -> Answer:
        # North up, as the tiles are, by the compass that every drone has.
        seen = picture(query.image).rotate(-query.yaw_deg, Image.BILINEAR, expand=True)
        nearness = known @ unit(embed(seen))
        order = np.argsort(-nearness, kind="stable")[:RANKED]
        best = gallery[order[0]]
        return Answer([ids[at] for at in order], float(tiles.lat_deg[best]), float(tiles.lon_deg[best]))

    return locate


def picture(path: Path) -> Image.Image:
    """An image as red, green and blue."""
    return open_image(path, as_shown=True).convert("RGB")


def unit(vector: np.ndarray) -> np.ndarray:
    """A vector of length 1."""
    return vector / max(float(np.linalg.norm(vector)), 1e-12)


def mean_colours(benchmark: Benchmark, gallery: np.ndarray) -> Callable[[Query], Answer]:
    """Colours of 4 x 4 parts of the middle, less their mean."""

    def embed(image: Image.Image) -> np.ndarray:
        side = min(image.size) // 2
        left, top = (image.width - side) // 2, (image.height - side) // 2
        parts = np.asarray(image.crop((left, top, left + side, top + side)).resize((4, 4), Image.BOX), float)
        return (parts - parts.mean()).ravel()

    return by_embedding(embed, benchmark, gallery)


def dinov2(benchmark: Benchmark, gallery: np.ndarray) -> Callable[[Query], Answer]:
    """DINOv2's class token (Oquab et al., arXiv 2304.07193), the small network."""
    import torch

    network = torch.hub.load("facebookresearch/dinov2", "dinov2_vits14").eval()

    def embed(image: Image.Image) -> np.ndarray:
        values = (np.asarray(image.resize((SIDE_PX, SIDE_PX)), np.float32) / 255.0 - MEAN) / SPREAD
        with torch.inference_mode():
            batch = torch.from_numpy(values.transpose(2, 0, 1)[np.newaxis].astype(np.float32))
            return network(batch)[0].numpy()

    return by_embedding(embed, benchmark, gallery)
