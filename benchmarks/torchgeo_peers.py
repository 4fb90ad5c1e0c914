r"""What torchgeo's reader gives of images and their labels.

    python -m venv peers && peers/bin/pip install torchgeo .
    peers/bin/python examples/world_houses.py 35.1450_-89.8620_35.1405_-89.8560 houses.geojson
    peers/bin/terrainav capture --coords "35.1450_-89.8620_35.1405_-89.8560_100" --zoom 18 --overlap 0.3 \
        --labels houses.geojson:roof --data-dir out
    peers/bin/python benchmarks/torchgeo_peers.py out

Images that look straight down are windows of the map, which torchgeo intersects with their labels. For the bounds of
each image, its pixels, classes and instances are compared with ours.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.label_images import LabelImages
from torchgeo.datasets import RasterDataset
from torchgeo.samplers import RandomGeoSampler

LABELS = ("classes", "instances")


class Images(RasterDataset):
    """GeoTIFFs of a dataset."""

    filename_glob = "*.tif"


class Masks(Images):
    """Classes or instances."""

    is_image = False


def check(what: str, found: np.ndarray, wanted: np.ndarray) -> None:
    """End the program where pixels differ."""
    if found.shape != wanted.shape:
        raise SystemExit(f"{what}: {found.shape}, where ours has {wanted.shape}")
    if not np.array_equal(found, wanted):
        raise SystemExit(f"{what}: {(found != wanted).sum():,} of {wanted.size:,} values differ")


def main(folder: Path) -> None:
    """Compare; ends the program where something differs."""
    ours = read_dataset(folder).image_set("satellite")
    labels, images = LabelImages(ours), Images(folder / "satellite")
    place = {Path(path).name: shape.bounds for path, shape in zip(images.index.filepath, images.index.geometry)}
    for kind in LABELS:
        both = images & Masks(folder / kind)
        count = 0
        for row, name in enumerate(ours.table.img_names):
            west, south, east, north = place[name]
            sample = both[west:east, south:north]
            check(f"{kind} of {name}", sample["mask"].numpy(), labels.pixels(kind, row))
            check(f"image {name}", sample["image"].numpy().transpose(1, 2, 0), ours.pixels(row))
            count += sample["mask"].numel()
        print(f"{kind:10s} {len(ours)} images, {count:,} pixels the same, {sample['mask'].dtype}")
    sampler = RandomGeoSampler(images & Masks(folder / "classes"), size=64, length=100)
    shares = [float((both[query]["mask"] > 0).float().mean()) for query in sampler]
    print(f"sampler    {len(shares)} pieces, {100.0 * np.mean(shares):.1f} % of their pixels labelled")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
