"""Captures in blocks by one to four workers, beside the threads of one process, and what a block costs.

    python benchmarks/scale.py                        # writes build/scale.json and its parts of docs/scale.md
    python benchmarks/scale.py --small --no-page
    python benchmarks/scale.py --before 39c4f0d       # also: plain captures of a commit and of this one, in turns

Each run is a process of its own; the seconds are those of `capture` alone, with the cluster there and its workers'
imports done. Contenders take turns, and figures are medians over the rounds. Results go into memory: a folder that no
disk stands behind, or an S3 store on loopback in a process of its own, which takes processor time from the workers.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import shutil
import statistics
import subprocess
import sys
import tarfile
import tempfile
import time
from concurrent.futures import Executor, Future
from contextlib import ExitStack
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from object_store import ObjectStore

ROOT = Path(__file__).resolve().parents[1]
PAGE, FOUND = ROOT / "docs" / "scale.md", ROOT / "build" / "scale.json"
#: A folder that no disk stands behind, on Linux.
IN_MEMORY = "/dev/shm"  # noqa: S108 (holds folders of our own alone)
WORLD = "world"
#: Heights that give images of about 640 px in the world and in the raster, whose pixels are 0.5 m.
LAT_DEG, LON_DEG, AGL_M = 35.14, -89.86, 120.0
PLAIN, HERE, LOCAL = "plain", "here", "local:{}"
WORKERS = (1, 2, 4)
RASTER_PX = 12_000
#: Images of a block in the runs whose speed is compared, and in those that tell what a block costs beside its images.
BLOCK_IMAGES = 32
BLOCKS_OF = (8, 64)
#: Captures by a commit and by what is here, one after the other.
PAIRS = 60
#: Captures, blocks and workers of the run in which blocks take no time at all.
COORDINATED = ((100_000, 256, 2), (400_000, 256, 2), (400_000, 256, 1_000), (100_000, 32, 1_000))


def planned(source: str, images: int, **more: Any) -> tuple[Any, Any]:
    """Plan of about so many images, a little wider than high, and the source, named."""
    from terrainav.core.imagery.opening import SourceOptions, named_source
    from terrainav.core.mission.areas.area import Box
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    if source != WORLD:
        return _planned_in_raster(source, images, **more)
    named = named_source("world", SourceOptions())
    width_m, height_m = Mission(Box(1, 0, 0, 1), AGL_M).camera.ground_size_m(AGL_M)
    rows = max(round((images / 1.2) ** 0.5), 1)
    columns = max(round(images / rows), 1)
    half_lat = (rows - 0.5) * height_m / 111_000.0 / 2.0
    half_lon = (columns - 0.5) * width_m / 111_320.0 / np.cos(np.radians(LAT_DEG)) / 2.0
    box = Box(LAT_DEG + half_lat, LON_DEG - half_lon, LAT_DEG - half_lat, LON_DEG + half_lon)
    mission = Mission(box, AGL_M, **more)
    return plan(mission, named.grid), named


def _planned_in_raster(file: str, images: int, **more: Any) -> tuple[Any, Any]:
    from rasters import AGL_M as RASTER_AGL_M
    from rasters import OVERLAP
    from rasters import planned as planned_in
    from terrainav.core.imagery.opening import SourceOptions, named_source
    from terrainav.core.mission.plan import plan

    side = max(round(images**0.5), 1)
    worked_out, source = planned_in(file, side, max(round(images / side), 1), OVERLAP)
    source.close()
    if more:
        worked_out = plan(worked_out.mission.replace(**{"agl_m": RASTER_AGL_M, **more}), worked_out.grid)
    return worked_out, named_source(file, SourceOptions(as_stored=True))


def do(job: dict[str, Any]) -> dict[str, Any]:
    """Do a job in this process: capture, with the engine there, and tell what it took."""
    from terrainav.core.capture.runner import capture

    worked_out, named = planned(job["source"], job["images"])
    how: dict[str, Any] = {}
    with ExitStack() as opened:
        began = time.perf_counter()
        pids: list[int] = []
        if job["engine"] == PLAIN:
            source = named.open()
            opened.callback(source.close)
        else:
            from terrainav.core.capture.blocks.engines import local_engine, open_engine
            from terrainav.core.capture.blocks.running import Blocks

            source = named
            how["blocks"] = Blocks(job["block"], job["layout"])
            if job["engine"] == HERE:
                how["executor"] = opened.enter_context(local_engine())
            else:
                how["executor"] = engine = opened.enter_context(open_engine(job["engine"]))
                pids = workers_of(engine)
        start_s = time.perf_counter() - began
        before = [cpu_s(pid) for pid in pids]
        own_s, began = time.process_time(), time.perf_counter()
        result = capture(worked_out, source, job["destination"], **how)
        wall_s, own_s = time.perf_counter() - began, time.process_time() - own_s
        spent = sum(cpu_s(pid) - earlier for pid, earlier in zip(pids, before))
        peak = max((peak_bytes(pid) for pid in pids), default=0)
    if result.failed or result.written != len(worked_out):
        raise SystemExit(f"{len(result.failed)} images failed, {result.written} written")
    blocks = -(-len(worked_out) // job["block"])
    return {
        "images": len(worked_out),
        "blocks": blocks,
        "wall_s": wall_s,
        "start_s": start_s,
        "own_cpu_s": own_s,
        "workers_cpu_s": spent,
        "requests": result.requests,
        "worker_peak_mb": peak / 1e6,
    }


def workers_of(engine: Any) -> list[int]:
    """Process ids of a cluster's workers, which have imported what makes blocks."""
    return list(engine.executor._client.run(_ready).values())  # noqa: SLF001 (an Executor names no workers)


def _ready() -> int:
    import s3fs  # noqa: F401
    import terrainav.core.capture.blocks.block
    import terrainav.core.imagery.raster.source
    import terrainav.core.world  # noqa: F401

    return os.getpid()


def cpu_s(pid: int) -> float:
    """Processor seconds of a process so far."""
    import psutil

    times = psutil.Process(pid).cpu_times()
    return float(times.user + times.system)


def peak_bytes(pid: int) -> int:
    """Most memory that a process has had."""
    for line in Path(f"/proc/{pid}/status").read_text("ascii").splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) * 1024
    return 0


class Instant(Executor):
    """Workers that have made a block when they are asked to: all that is left is what the run itself does.

    They unpack blocks and pack results, which takes workers' time and not the run's: ``apart_s``.
    """

    def __init__(self) -> None:
        self.packed = b""
        self.packed_bytes: list[int] = []
        self.apart_s = 0.0
        #: Processor seconds of the run when it handed out its first block, and its last.
        self.first_s = self.last_s = 0.0

    def submit(self, call: Any, data: bytes) -> Future[Any]:  # type: ignore[override]
        """Answer at once."""
        import pickle  # nosec B403

        from terrainav.core.capture.blocks import block as of_workers

        began = time.process_time()
        self.last_s = began - self.apart_s
        self.first_s = self.first_s or self.last_s
        of_workers.make_block = _made_at_once
        packed = pickle.dumps(call(data))
        self.packed = data
        self.packed_bytes.append(len(data))
        self.apart_s += time.process_time() - began
        future: Future[Any] = Future()
        # Unpacking results is the run's.
        future.set_result(pickle.loads(packed))  # noqa: S301  # nosec B301 (of this very process)
        return future


def _made_at_once(block: Any) -> Any:
    """What making a block comes to."""
    from terrainav.core.capture.blocks.block import BlockResult, Record
    from terrainav.core.capture.journal import Outcome

    outcomes = {
        name: Outcome(block.map_type, name, 7.0, size_bytes=4000, shard=block.shard, length_bytes=4000)
        for name in block.plan.names
    }
    return BlockResult(Record(outcomes, 1), 1, 1)


def coordinate(images: int, block: int, workers: int) -> dict[str, Any]:
    """What the run itself takes, in processor seconds and memory, where blocks take none."""
    from terrainav.core.capture.blocks.engines import Engine
    from terrainav.core.capture.blocks.running import Blocks
    from terrainav.core.capture.progress import Listener
    from terrainav.core.capture.runner import capture

    began = time.process_time()
    worked_out, named = planned(WORLD, images)
    plan_s = time.process_time() - began
    instant = Instant()
    with tempfile.TemporaryDirectory(dir=in_memory()) as folder:
        began = time.process_time()
        capture(
            worked_out,
            named,
            folder,
            executor=Engine(instant, lambda: workers),
            blocks=Blocks(block, "webdataset"),
            listener=Listener(progress=lambda _: None),
        )
        run_s = time.process_time() - began - instant.apart_s
    return {
        "images": len(worked_out),
        "blocks": len(instant.packed_bytes),
        "workers": workers,
        "plan_s": plan_s,
        "run_s": run_s,
        "handing_out_s": instant.last_s - instant.first_s,
        "packed_bytes": statistics.median(instant.packed_bytes),
        "peak_mb": peak_bytes(os.getpid()) / 1e6,
    }


def round_trip(blocks: int = 500) -> dict[str, float]:
    """Seconds of a call with a packed block to a worker and back, and processor seconds on this side."""
    from terrainav.core.capture.blocks.engines import Engine, open_engine
    from terrainav.core.capture.blocks.running import Blocks
    from terrainav.core.capture.runner import capture

    worked_out, named = planned(WORLD, BLOCK_IMAGES)
    instant = Instant()
    with tempfile.TemporaryDirectory(dir=in_memory()) as folder:
        size = Blocks(len(worked_out), "webdataset")
        capture(worked_out, named, folder, executor=Engine(instant, lambda: 1), blocks=size)
    data = instant.packed
    with open_engine(LOCAL.format(1)) as engine:
        workers_of(engine)
        taken, own_s = [], time.process_time()
        for _ in range(blocks):
            began = time.perf_counter()
            engine.executor.submit(len, data).result()
            taken.append(time.perf_counter() - began)
        own_s = time.process_time() - own_s
    return {"round_trip_s": statistics.median(taken), "round_trip_cpu_s": own_s / blocks}


def in_memory() -> str | None:
    """A folder that no disk stands behind, where there is one."""
    return IN_MEMORY if os.access(IN_MEMORY, os.W_OK) else None


def own_environment() -> dict[str, str]:
    """Environment of a process that measures."""
    return {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def in_own_process(what: str, *arguments: Any) -> Any:
    """Run one measurement of this file in a fresh interpreter."""
    done = subprocess.run(
        [sys.executable, __file__, "--measure", what, json.dumps(arguments)],
        capture_output=True, text=True, check=False, env=own_environment(),
    )  # fmt: skip
    if done.returncode:
        raise SystemExit(f"{what} {arguments}: {done.stderr[-3000:]}")
    return json.loads(done.stdout.splitlines()[-1])


def contenders(store: str, folder: str) -> list[tuple[str, str, str]]:
    """Engine, layout and destination of each."""
    clusters = [LOCAL.format(workers) for workers in WORKERS]
    return [
        *((engine, "folders", folder) for engine in (PLAIN, HERE, *clusters)),
        *((engine, "webdataset", store) for engine in clusters),
    ]


def compare(source: str, images: int, rounds: int, store: ObjectStore, folder: Path) -> list[dict[str, Any]]:
    """All contenders, in turns; medians."""
    runs: dict[tuple[str, str], list[dict[str, Any]]] = {}
    contents: dict[str, dict[str, str]] = {}
    for number in range(rounds):
        for engine, layout, to in contenders(store.address, str(folder)):
            destination = f"{to}/{engine.replace(':', '-')}-{Path(source).stem}-{number}"
            job = {"source": source, "images": images, "engine": engine, "layout": layout}
            store.counts()
            found = in_own_process("do", {**job, "destination": destination, "block": BLOCK_IMAGES})
            found.update(store=store.counts(), mb=0.0)
            if layout == "folders":
                content = content_of(Path(destination))
                found["mb"] = sum(path.stat().st_size for path in Path(destination).rglob("*.tif")) / 1e6
                shutil.rmtree(destination)
            else:
                content = emptied(destination)
            first = contents.setdefault(layout, content)
            differ = [name for name in {**first, **content} if first.get(name) != content.get(name)]
            if differ:
                raise SystemExit(f"{destination}: {len(differ)} files differ from the first contender's, {differ[:5]}")
            found["store_cpu_s"], found["puts"] = found["store"]["cpu_s"], sum_of(found, "PUT", "POST")
            found["gets"] = sum_of(found, "GET", "HEAD", "DELETE")
            found["put_mb"] = found.pop("store")["received_bytes"] / 1e6
            runs.setdefault((engine, layout), []).append(found)
            print(f"{source} {engine} {layout}: {found['images'] / found['wall_s']:.1f} images/s", flush=True)
    rows = []
    for (engine, layout), each in runs.items():
        row: dict[str, Any] = {key: statistics.median(one[key] for one in each) for key in each[0]}
        row.update(engine=engine, layout=layout, rates=sorted(one["images"] / one["wall_s"] for one in each))
        # In the same round, so that what slows the machine down slows both.
        plain = [one["images"] / one["wall_s"] for one in runs[PLAIN, "folders"]]
        one_worker = [one["wall_s"] for one in runs[LOCAL.format(1), layout]]
        row["to_plain"] = statistics.median(one["images"] / one["wall_s"] / rate for one, rate in zip(each, plain))
        row["speed_up"] = statistics.median(wall / one["wall_s"] for one, wall in zip(each, one_worker))
        rows.append(row)
    return rows


def sum_of(found: dict[str, Any], *methods: str) -> int:
    """Requests of some methods."""
    return sum(found["store"]["requests"].get(one, 0) for one in methods)


def content_of(folder: Path) -> dict[str, str]:
    """Digests of all images and tables of a folder, by name."""
    found = sorted([*folder.rglob("*.tif"), *folder.rglob("meta_data.csv")])
    return {str(path.relative_to(folder)): sha256(path.read_bytes()).hexdigest() for path in found}


def emptied(address: str) -> dict[str, str]:
    """Digests of all shards and tables at an address, by name; all there is is removed."""
    from terrainav.core.storage.stores import get, list_sizes, remove, store_path

    found = {}
    for place in (store_path(address) / "satellite", store_path(address) / "blocks", store_path(address)):
        for name in sorted(list_sizes(place)):
            data = get(place / name) or b""
            if name.endswith(".tar"):
                with tarfile.open(fileobj=io.BytesIO(data)) as tar:
                    tar.getmembers()
            if place.name == "satellite":
                found[name] = sha256(data).hexdigest()
            remove(place / name)
    return found


def block_costs(source: str, images: int, rounds: int, store: ObjectStore) -> dict[str, float]:
    """Cost of a block beside its images, and of an image: of the same images in few blocks and in many, by one worker.

    The medians over the rounds of slopes and intercepts: tiles along cuts are fetched by both neighbours, so that part
    of a block's cost are images'.
    """
    methods = dict.fromkeys(("PUT", "POST", "GET", "HEAD", "DELETE"), 0)
    keys = ("wall_s", "own_cpu_s", "workers_cpu_s", "requests", "received_bytes", "cpu_s", *methods)
    slopes: dict[str, list[float]] = {key: [] for key in keys}
    each: dict[str, list[float]] = {key: [] for key in keys}
    for number in range(rounds):
        runs = []
        for block in BLOCKS_OF:
            destination = f"{store.address}/cost-{Path(source).stem}-{number}-{block}"
            job = {"source": source, "images": images, "engine": LOCAL.format(1), "layout": "webdataset"}
            store.counts()
            found = in_own_process("do", {**job, "destination": destination, "block": block})
            told = store.counts()
            emptied(destination)
            runs.append({**found, **methods, **told.pop("requests"), **told})
        small, large = runs
        for key in keys:
            slope = (small[key] - large[key]) / (small["blocks"] - large["blocks"])
            slopes[key].append(slope)
            each[key].append((large[key] - slope * large["blocks"]) / large["images"])
    found = {f"{key}_a_block": statistics.median(values) for key, values in slopes.items()}
    return {**found, **{f"{key}_an_image": statistics.median(values) for key, values in each.items()}}


def before_and_now(commit: str, source: str, images: int, pairs: int, folder: Path) -> dict[str, Any]:
    """Plain captures by a commit and by what is here: ratio of seconds of each pair, now to before.

    Each has one process for all its captures, which are short and take turns: what slows the machine down slows both.
    """
    other = folder / "before"
    (other / "terrainav").mkdir(parents=True)
    packed = subprocess.run(["git", "archive", commit], cwd=ROOT, capture_output=True, check=True).stdout  # noqa: S607
    with tarfile.open(fileobj=io.BytesIO(packed)) as tar:
        tar.extractall(other / "terrainav")  # noqa: S202  # nosec B202 (of this very repository)
    ratios: dict[str, list[float]] = {"wall_s": [], "own_cpu_s": []}
    content = []
    job = {"source": source, "images": images, "engine": PLAIN, "layout": "folders", "block": images}
    with ExitStack() as opened:
        # With keys of S3 in the environment, rasters were read more slowly then, by rasterio and boto3.
        environment = {name: value for name, value in own_environment().items() if not name.startswith("AWS_")}
        sides = {
            "before": opened.enter_context(Side({**environment, "PYTHONPATH": str(other)})),
            "now": opened.enter_context(Side(environment)),
        }
        for number in range(pairs + 1):
            taken = {}
            # Which is first changes from pair to pair.
            for name in sorted(sides, reverse=bool(number % 2)):
                destination = folder / f"{name}-out"
                taken[name] = sides[name].do({**job, "destination": str(destination)})
                content.append(content_of(destination))
                shutil.rmtree(destination)
            # The first pair imports.
            if number:
                for key, each in ratios.items():
                    each.append(taken["now"][key] / taken["before"][key])
    if any(one != content[0] for one in content):
        raise SystemExit("the commit makes other images")
    found = {key: sorted(each) for key, each in ratios.items()}
    print(f"{source}: now to before {of_ratios(found['wall_s'])}", flush=True)
    return {"commit": commit, "ratios": found, "images": images}


class Side:
    """A process that does one job after the other, of the TerrAInav that an environment leads to."""

    def __init__(self, environment: dict[str, str]) -> None:
        self._process: Any = subprocess.Popen(
            [sys.executable, __file__, "--serve"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment,
        )  # fmt: skip

    def do(self, job: dict[str, Any]) -> dict[str, Any]:
        """Have a job done."""
        print(json.dumps(job), file=self._process.stdin, flush=True)
        found: dict[str, Any] = json.loads(self._process.stdout.readline())
        return found

    def __enter__(self) -> Side:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()


def serve() -> None:
    """Do the jobs that come by standard input."""
    for line in sys.stdin:
        print(json.dumps(do(json.loads(line))), flush=True)


TITLES = {PLAIN: "threads, image by image", HERE: "one process, in blocks"}
RATES_HEAD = """\
Measured by `python benchmarks/scale.py` on {machine}; medians of {rounds} rounds, all contenders in turns. *To threads*
is the ratio to the rate of `terrainav capture` without blocks in the same round, which uses both cores; *speed-up* is
relative to one worker. The last three columns are processor seconds: of the run with Dask's scheduler, of all workers,
and of the store, which uses the same two cores. Images and tables of all contenders of a layout are byte for byte the
same.
"""
RATES = """
{images:,.0f} images of {source} as GeoTIFF in {blocks:.0f} blocks. Two workers can be {most:.2f} times as fast as
one, as one of them makes {first:.0f} blocks:

| results | who captures | images/s (least, most) | to threads | speed-up | run, s | workers, s | store, s |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |
"""
RATE = (
    "| {to} | {who} | {rate:.1f} ({low:.1f}, {high:.1f}) | {to_plain:.2f} | {speed_up} | {own_cpu_s:.1f} | "
    "{workers} | {store} |\n"
)


def rates_text(found: dict[str, Any]) -> str:
    """Tables of the rates."""
    text = RATES_HEAD.format(**found)
    for one in found["compared"]:
        rows = one["rows"]
        text += RATES.format(
            images=rows[0]["images"],
            source=TITLE_OF[one["source"] == WORLD],
            blocks=rows[0]["blocks"],
            first=-(-rows[0]["blocks"] // 2),
            most=rows[0]["blocks"] / -(-rows[0]["blocks"] // 2),
        )
        for row in rows:
            is_cluster = row["engine"] not in TITLES
            text += RATE.format(
                to="S3, shards" if row["layout"] == "webdataset" else "folder",
                who=TITLES.get(row["engine"], f"`--cluster {row['engine']}`"),
                rate=statistics.median(row["rates"]),
                low=row["rates"][0],
                high=row["rates"][-1],
                to_plain=row["to_plain"],
                speed_up=f"{row['speed_up']:.2f}" if is_cluster else "",
                own_cpu_s=row["own_cpu_s"],
                workers=f"{row['workers_cpu_s']:.1f}" if is_cluster else "",
                store=f"{row['store_cpu_s']:.1f}" if row["layout"] == "webdataset" else "",
            )
    text += f"\nThe cluster starts in {found['start_s']:.1f} s, including the imports of its workers.\n"
    if found.get("before"):
        text += "\nA capture without blocks, compared with the commit before blocks were introduced: "
        text += "; ".join(
            f"for {TITLE_OF[one['source'] == WORLD]} {of_ratios(one['ratios']['wall_s'])} of the seconds and "
            f"{of_ratios(one['ratios']['own_cpu_s'])} of the processor time, in {len(one['ratios']['wall_s'])} pairs "
            f"of about {one['images']:,} images"
            for one in found["before"]
        )
        text += (
            "; medians with 95 % confidence intervals "
            f"(`python benchmarks/scale.py --before {found['before'][0]['commit']}`).\n"
        )
    return text


def of_ratios(ratios: list[float]) -> str:
    """Median of sorted ratios, with its interval of 95 % by the order statistics of a binomial."""
    low = round(len(ratios) / 2 - 0.98 * len(ratios) ** 0.5)
    return f"{statistics.median(ratios):.3f} ({ratios[low]:.3f} to {ratios[-1 - low]:.3f})"


TITLE_OF = {True: "the embedded world", False: "a local raster"}
COST = """\
Measured by `python benchmarks/scale.py`, one worker, shards into S3 on loopback: about {images:,} images in blocks of
{large} and of {small}; medians. The part that grows with the number of blocks is the cost of a block, the rest the cost
of an image. Blocks share tiles at their borders, which both fetch, so part of the cost of a block is repeated work for
images.

| | a block, world | an image, world | a block, raster | an image, raster |
| --- | ---: | ---: | ---: | ---: |
"""
#: Key, what it is called, factor and digits.
COSTS = (
    ("workers_cpu_s", "processor of the worker, ms", 1e3, 1),
    ("own_cpu_s", "processor of the run and the scheduler, ms", 1e3, 2),
    ("cpu_s", "processor of the store, ms", 1e3, 1),
    ("requests", "requests to the source", 1, 2),
    ("PUT", "objects put", 1, 2),
    ("POST", "POST requests to the store", 1, 2),
    ("GET", "GET requests to the store", 1, 2),
    ("HEAD", "HEAD requests to the store", 1, 2),
    ("received_bytes", "bytes put, kB", 1e-3, 1),
)
COORDINATED_HEAD = """
Cost of the run itself, with an executor that returns immediately: processor seconds and memory for dividing, handing
out, recording and writing the tables. A block of {packed_images} images is {packed:.0f} kB when it is sent. Dask adds
{cpu:.1f} ms of processor time, client and scheduler together, and {trip:.1f} ms until an empty call returns from its
worker.

| images | blocks | workers | plan, s | run, s | of this handing out, ms a block | all else, ms an image | peak MB |
| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""


def costs_text(found: dict[str, Any]) -> str:
    """Tables of what a block costs."""
    costs = [found["costs"][name] for name in ("world", "raster")]
    text = COST.format(images=found["cost_images"], large=max(BLOCKS_OF), small=min(BLOCKS_OF))
    for key, title, factor, digits in COSTS:
        cells = [f"{one[f'{key}_{each}'] * factor:,.{digits}f}" for one in costs for each in ("a_block", "an_image")]
        text += f"| {title} | {' | '.join(cells)} |\n"
    cores = [one["workers_cpu_s_an_image"] / one["wall_s_an_image"] for one in costs]
    text += (
        f"\nWhile making images, the worker used {cores[0]:.2f} cores with the world and {cores[1]:.2f} with the "
        "raster, because tiles are fetched in several threads.\n"
    )
    last = found["coordinated"][0]
    text += COORDINATED_HEAD.format(
        packed_images=round(last["images"] / last["blocks"]),
        packed=last["packed_bytes"] / 1e3,
        trip=found["round_trip_s"] * 1e3,
        cpu=found["round_trip_cpu_s"] * 1e3,
    )
    for row in found["coordinated"]:
        text += (
            f"| {row['images']:,} | {row['blocks']:,} | {row['workers']:,} | {row['plan_s']:.1f} | "
            f"{row['run_s']:.1f} | {row['handing_out_s'] / row['blocks'] * 1e3:.1f} | "
            f"{(row['run_s'] - row['handing_out_s']) / row['images'] * 1e3:.3f} | {row['peak_mb']:,.0f} |\n"
        )
    return text


def put_in_page(**parts: str) -> None:
    """Put parts of the page in their places."""
    from leaderboard import put

    page = PAGE.read_text("utf-8")
    for mark, text in parts.items():
        page = put(page, mark.replace("_", "-"), text)
    PAGE.write_text(page, "utf-8")


def machine_text() -> str:
    """The machine, on one line."""
    from terrainav.core.report.machine import machine

    return ", ".join(f"{what} {value}" for what, value in machine())


MEASURES = {"do": do, "coordinate": coordinate, "round_trip": round_trip}


def main() -> None:
    """Measure, and write the page's parts."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--images", type=int, default=512, help="of each run")
    parser.add_argument("--before", metavar="COMMIT", help="compare plain captures with those of a commit, too")
    parser.add_argument("--only", choices=("rates", "costs", "before"), help="one part")
    parser.add_argument("--small", action="store_true", help="one round of few images: does it work?")
    parser.add_argument("--no-page", action="store_true", help="write nothing into docs/")
    parser.add_argument("--measure", nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.serve:
        serve()
        return
    if asked.measure:
        print(json.dumps(MEASURES[asked.measure[0]](*json.loads(asked.measure[1]))))
        return
    if asked.small:
        asked.rounds, asked.images = 1, 128
    file = ROOT / "build" / f"raster-{RASTER_PX}.tif"
    if not file.exists():
        from rasters import paint

        file.parent.mkdir(exist_ok=True)
        paint(file, RASTER_PX)
    found: dict[str, Any] = json.loads(FOUND.read_text("utf-8")) if FOUND.exists() and asked.only else {}
    with tempfile.TemporaryDirectory(dir=in_memory()) as name, ObjectStore() as store:
        measure(found, asked, str(file), store, Path(name))
    found.update(machine=machine_text(), cores=os.cpu_count())
    FOUND.write_text(json.dumps(found, indent=1), "utf-8")
    if not asked.no_page:
        parts = {"rates": rates_text(found)} if "compared" in found else {}
        parts.update({"block_costs": costs_text(found)} if "costs" in found else {})
        put_in_page(**parts)


def measure(found: dict[str, Any], asked: argparse.Namespace, file: str, store: ObjectStore, folder: Path) -> None:
    """Measure what is asked for."""
    # Painting the world takes about twice as long as reading a raster.
    sources = {WORLD: asked.images // 2, file: asked.images}
    if asked.only in (None, "rates"):
        rows = [compare(source, images, asked.rounds, store, folder) for source, images in sources.items()]
        found["compared"] = [{"source": source, "rows": each} for source, each in zip(sources, rows)]
        found["start_s"] = statistics.median(one["start_s"] for one in rows[0] if one["engine"] not in TITLES)
        found["rounds"] = asked.rounds
    if asked.only in (None, "costs"):
        found["cost_images"] = asked.images // 2
        found["costs"] = {
            name: block_costs(source, found["cost_images"], asked.rounds, store)
            for name, source in zip(("world", "raster"), sources)
        }
        print(json.dumps(found["costs"], indent=1), flush=True)
        share = 100 if asked.small else 1
        found["coordinated"] = [
            in_own_process("coordinate", images // share, block, workers) for images, block, workers in COORDINATED
        ]
        print(json.dumps(found["coordinated"]), flush=True)
        found.update(in_own_process("round_trip"))
    if asked.before and asked.only in (None, "before"):
        found["before"] = [
            {
                **before_and_now(asked.before, source, images // 8, PAIRS, folder / name),
                "source": source,
            }
            for name, (source, images) in zip(("world", "raster"), sources.items())
        ]


if __name__ == "__main__":
    main()
