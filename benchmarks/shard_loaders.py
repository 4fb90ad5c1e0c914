r"""Images per second from shards, on disk and in S3: our loaders, webdataset and LitData on the same images.

    python -m venv peers && peers/bin/pip install ".[cluster,torch]" webdataset litdata "moto[server]"
    peers/bin/python benchmarks/shard_loaders.py        # writes the section of docs/loaders.md

A part of the paper's Agricenter box is captured from the embedded world into webdataset shards. Ours and webdataset
read these files; LitData needs chunks of its own, into which its own writer puts the same JPEGs, as bytes, as many a
chunk. The S3 store is moto's server on loopback, in a process of its own; webdataset reads from it by ``curl``, as from
any HTTP server, with signed addresses. An epoch begins with nothing fetched and ends with the last batch; making the
loader, and reading its table or index, is part of it. All take turns within one run, in any order, after one round to
warm up. Takes about five minutes on two cores.
"""

from __future__ import annotations

import argparse
import cProfile
import io
import json
import os
import pstats
import re
import shutil
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

import boto3
import litdata
import numpy as np
import torch
import webdataset
from litdata.streaming import downloader
from PIL import Image
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.loading import Batches
from terrainav.core.dataset.loading.torch_loader import TorchDataset
from terrainav.core.report.machine import machine, versions
from terrainav.core.storage.files import write_whole
from terrainav.core.storage.stores import put, store_path
from terrainav.core.timing import Effort, timed_together

ROOT = Path(__file__).resolve().parents[1]
MISSION = ("--coords", "35.160_-89.900_35.135_-89.870_120", "--zoom", "18", "--format", "jpg")
IMAGES_A_SHARD, SIZE, BATCH, WORKERS = 32, (224, 224), 32, 2
CHOICE = {"part": "all", "img_size": (*SIZE, 3), "shuffle": True, "augment": None}
EFFORT = Effort(5, 5, 1.0)
BUCKET = "data"
BEGIN, END = "<!-- shards: measured -->", "<!-- shards: end -->"


def captured(folder: Path) -> Path:
    """Capture the mission into shards."""
    command = [
        sys.executable,
        "-m",
        "terrainav.core.cli",
        "capture",
        *MISSION,
        "--cluster",
        f"local:{WORKERS}",
    ]
    command += ["--block", str(IMAGES_A_SHARD), "--layout-of-files", "webdataset", "--data-dir", str(folder)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return folder


def as_chunks(dataset: Path, folder: Path) -> Path:
    """Put the same images as bytes, with their labels, into LitData's chunks of as many images."""
    (images,) = read_dataset(dataset).image_sets.values()
    made = litdata.streaming.Cache(str(folder), chunk_size=IMAGES_A_SHARD)
    for row in range(len(images)):
        made[row] = {
            "jpg": images.file(row).read_bytes(),
            "label": [images.table.lat_deg[row], images.table.lon_deg[row]],
        }
    made.done()
    made.merge()
    return folder


@contextmanager
def store() -> Iterator[None]:
    """Run a store in a process of its own, to which the environment leads."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    url = f"http://127.0.0.1:{port}"
    keys = dict.fromkeys(("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"), "benchmark")
    os.environ.update(keys, AWS_DEFAULT_REGION="us-east-1", AWS_ENDPOINT_URL=url)
    command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as server:
        try:
            for _ in range(600):
                with suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=5):
                    break
                time.sleep(0.1)
            boto3.client("s3").create_bucket(Bucket=BUCKET)
            yield
        finally:
            server.terminate()


def uploaded(folder: Path, name: str) -> str:
    """Put the files of a folder into the store; returns the address."""
    for path in (one for one in folder.rglob("*") if one.is_file()):
        put(store_path(f"s3://{BUCKET}/{name}/{path.relative_to(folder).as_posix()}"), path.read_bytes())
    return f"s3://{BUCKET}/{name}"


def signed(tars: list[str]) -> list[str]:
    """Addresses by which shards can be had without a key."""
    client = boto3.client("s3")
    keys = [f"shards/satellite/{one}" for one in tars]
    return [client.generate_presigned_url("get_object", {"Bucket": BUCKET, "Key": key}) for key in keys]


def pixels(data: bytes) -> np.ndarray:
    """An image as all peers decode it: by Pillow, bilinear, float32 of 0 to 1."""
    with Image.open(io.BytesIO(data)) as image:
        sized = image.convert("RGB").resize(SIZE, Image.BILINEAR)
    return np.asarray(sized).astype(np.float32) / np.float32(255.0)


def of_webdataset(sample: dict[str, bytes]) -> tuple[np.ndarray, np.ndarray]:
    """Image and label of a sample of shards."""
    row = json.loads(sample["json"])
    return pixels(sample["jpg"]), np.array([row["Lat"], row["Lon"]], np.float32)


def of_litdata(sample: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Image and label of a sample of chunks."""
    return pixels(sample["jpg"]), np.array(sample["label"], np.float32)


def total(batches: Iterable[Any]) -> int:
    """Take an epoch; returns its number of images."""
    return sum(len(labels) for _, labels in batches)


def ours(place: str) -> Callable[[], int]:
    """Our iterator of arrays, in one thread."""
    return lambda: total(Batches(place, BATCH, **CHOICE))


def ours_in_threads(place: str) -> Callable[[], int]:
    """Our iterator of arrays."""
    return lambda: total(Batches(place, BATCH, workers=WORKERS, **CHOICE))


def ours_with_torch(place: str, workers: int) -> Callable[[], Iterable[Any]]:
    """Our dataset with PyTorch's loader."""
    return lambda: TorchDataset(place, **CHOICE).batches(BATCH, workers, persistent_workers=False)


def webdatasets(urls: list[str], workers: int) -> Callable[[], Iterable[Any]]:
    """Make webdataset's pipeline and loader, as its documentation has them."""

    def epoch() -> Iterable[Any]:
        found = (
            webdataset.WebDataset(urls, shardshuffle=len(urls), seed=1)
            .shuffle(8 * IMAGES_A_SHARD)
            .map(of_webdataset)
            .batched(BATCH)
        )
        loader: Iterable[Any] = webdataset.WebLoader(found, batch_size=None, num_workers=workers)
        return loader

    return epoch


def litdatas(place: str, folder: Path, workers: int) -> Callable[[], int]:
    """LitData's dataset and loader, with an empty cache each time."""
    numbers = count()

    def epoch() -> int:
        cache = folder / f"cache-{next(numbers)}"
        cache.mkdir(parents=True)
        options = {"endpoint_url": os.environ["AWS_ENDPOINT_URL"]} if place.startswith("s3:") else {}
        found = litdata.StreamingDataset(
            place,
            cache_dir=str(cache),
            shuffle=True,
            drop_last=False,
            transform=of_litdata,
            storage_options=options,
        )
        images = total(litdata.StreamingDataLoader(found, batch_size=BATCH, num_workers=workers))
        shutil.rmtree(cache)
        return images

    return epoch


def profile(work: Callable[[], int]) -> list[str]:
    """Lines of what takes most time in a work of one thread."""
    profiler = cProfile.Profile()
    profiler.runcall(work)
    stats = pstats.Stats(profiler)
    whole = stats.total_tt
    spent = sorted(((row[2], name) for name, row in stats.stats.items()), reverse=True)[:6]
    return [
        f"| `{re.sub('[<>]', '', function)}` ({Path(file).name}) | {seconds / whole:.0%} |"
        for seconds, (file, _, function) in spent
    ]


def parts_of_an_epoch(loaders: dict[str, Callable[[], Iterable[Any]]]) -> list[str]:
    """Lines of how long each takes to its first batch, and how fast it is from there on; medians, in turns."""
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in loaders}
    for _ in range(5):
        for name, make in loaders.items():
            began = time.perf_counter()
            batches = iter(make())
            next(batches)
            first = time.perf_counter()
            images = total(batches)
            taken[name].append((first - began, images / (time.perf_counter() - first)))
    lines = ["| from S3 | first batch after, s | images/s from there on |", "| --- | ---: | ---: |"]
    for name, each in taken.items():
        first_s, rate = (statistics.median(one) for one in zip(*each))
        lines.append(f"| {name} | {first_s:.2f} | {rate:,.0f} |")
    return [*lines, ""]


def section(works: dict[tuple[str, str], Callable[[], int]], profiled: dict[str, Callable[[], int]]) -> list[str]:
    """Lines of the page."""
    measured = timed_together(list(works.values()), EFFORT, time.perf_counter)
    counts = {images for images, _ in measured}
    if len(counts) != 1:
        raise SystemExit(f"not all have delivered each image once: {dict(zip(works, (one for one, _ in measured)))}")
    (images,) = counts
    rate = {key: images / seconds.median for key, (_, seconds) in zip(works, measured)}
    lines = []
    for place in dict.fromkeys(place for place, _ in works):
        base = {mode: rate[place, f"webdataset, {mode}"] for mode in ("one process", f"{WORKERS} processes")}
        lines += [f"From {place}:", "", "| loader | images/s | of webdataset's |", "| --- | ---: | ---: |"]
        for (where, name), value in rate.items():
            if where == place:
                mode = "one process" if name.endswith("one process") else f"{WORKERS} processes"
                lines.append(f"| {name} | {value:,.0f} | {value / base[mode]:.0%} |")
        lines.append("")
    for name, work in profiled.items():
        lines += [
            f"Where the time of {name} goes:",
            "",
            "| function | share |",
            "| --- | ---: |",
            *profile(work),
            "",
        ]
    return [f"{images} images of {IMAGES_A_SHARD} a shard; {len(measured[0][1].rounds)} rounds.", "", *lines]


def main() -> None:
    """Measure, and write the section."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "loaders.md")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    # LitData's downloader would have HTTPS, which a store on loopback does not speak.
    downloader._OBSTORE_CLIENT_OPTIONS["allow_http"] = True  # noqa: SLF001
    with tempfile.TemporaryDirectory() as name, store():
        folder = Path(name)
        shards = captured(folder / "shards")
        chunks = as_chunks(shards, folder / "chunks")
        tars = sorted(one.name for one in (shards / "satellite").glob("*.tar"))
        remote, remote_chunks = uploaded(shards, "shards"), uploaded(chunks, "chunks")
        places = {
            "local disk": (str(shards), [str(shards / "satellite" / one) for one in tars], str(chunks)),
            "S3": (remote, signed(tars), remote_chunks),
        }
        works: dict[tuple[str, str], Callable[[], int]] = {}
        loaders: dict[tuple[str, str], Callable[[], Iterable[Any]]] = {}
        for place, (own, urls, packed) in places.items():
            works[place, "ours, numpy, one process"] = ours(own)
            works[place, f"ours, numpy, {WORKERS} threads"] = ours_in_threads(own)
            for workers, mode in ((0, "one process"), (WORKERS, f"{WORKERS} processes")):
                for whose, make in (
                    ("ours, torch", ours_with_torch(own, workers)),
                    ("webdataset", webdatasets(urls, workers)),
                ):
                    loaders[place, f"{whose}, {mode}"] = make
                    works[place, f"{whose}, {mode}"] = lambda make=make: total(make())
                works[place, f"LitData, {mode}"] = litdatas(packed, folder / "caches", workers)
        lines = section(works, {f"`Batches` from {place}": ours(own) for place, (own, _, _) in places.items()})
        lines += parts_of_an_epoch({name: make for (place, name), make in loaders.items() if place == "S3"})
    told = ", ".join(f"{name} {value}" for name, value in [*machine(), *versions()])
    told += f", torch {torch.__version__}, webdataset {webdataset.__version__}, LitData {litdata.__version__}"
    told += f"; load average {os.getloadavg()[0]:.1f}"
    text = "\n".join([BEGIN, f"Made by `python benchmarks/shard_loaders.py` on {told}.", "", *lines, END])
    print(text)
    page = asked.output.read_text(encoding="utf-8")
    before, _, rest = page.partition(BEGIN)
    write_whole(asked.output, [(before + text + rest.partition(END)[2]).encode("utf-8")])


if __name__ == "__main__":
    main()
