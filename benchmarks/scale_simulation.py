"""A hundred million images over a thousand workers, simulated, with what benchmarks/scale.py has measured of a block.

    python benchmarks/scale_simulation.py     # writes its parts of docs/scale.md and docs/images/scale-*.png; minutes
    python benchmarks/scale_simulation.py --images 1000000 --no-page

Events are the ends of blocks, deaths of workers and their replacement. The rules are the product's own: images of a
block, blocks begun at most so often, as many blocks under way as a provider's limits have shares for, each share as
`Policy.shared` gives it. The coordinator takes one block after the other, for what that costs it. What is assumed of
workers and of a provider stands in `Assumed`. All random numbers are of one seed.
"""

from __future__ import annotations

import argparse
import heapq
import json
import math
import statistics
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from cloud_prices import LOOKED_UP, PRICES
from scale import FOUND, ROOT, TITLE_OF, WORLD, put_in_page
from terrainav.core.capture.blocks.running import TRIES
from terrainav.core.capture.choices import IMAGES
from terrainav.core.capture.making import DEFAULT_CONNECTIONS
from terrainav.core.imagery.policy import Policy

PICTURES = ROOT / "docs" / "images"
IMAGES_IN_ALL, WORKERS, SEED = 100_000_000, 1_000, 1
#: Of colour-blind-safe colours (Okabe and Ito).
BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#777777"


@dataclass(frozen=True)
class Measured:
    """What benchmarks/scale.py has measured.

    Parameters
    ----------
    image_s, block_s : float
        Processor seconds of a worker, of an image and of a block beside its images.
    image_requests, block_requests : float
        To the source.
    image_bytes, block_bytes, block_puts : float
        Put into the store.
    few_s, many_s : float
        Processor seconds of the coordinator for a block of `IMAGES`, with 2 workers and with 1,000.
    image_ends_s : float
        Of the coordinator for an image, before the first block and after the last.
    image_memory_bytes : float
        Of the coordinator for an image.
    """

    image_s: float
    block_s: float
    image_requests: float
    block_requests: float
    image_bytes: float
    block_bytes: float
    block_puts: float
    few_s: float
    many_s: float
    image_ends_s: float
    image_memory_bytes: float

    @classmethod
    def of(cls, found: dict[str, Any], source: str) -> Measured:
        """From the figures of `FOUND`, for ``world`` or ``raster``."""
        costs = found["costs"][source]
        small, large, many = found["coordinated"][:3]
        handed = {
            row["workers"]: row["handing_out_s"] / row["blocks"] + found["round_trip_cpu_s"] for row in (large, many)
        }
        return cls(
            costs["workers_cpu_s_an_image"],
            max(costs["workers_cpu_s_a_block"], 0.0),
            costs["requests_an_image"],
            costs["requests_a_block"],
            costs["received_bytes_an_image"],
            costs["received_bytes_a_block"],
            costs["PUT_a_block"] + costs["POST_a_block"],
            handed[large["workers"]],
            handed[many["workers"]],
            (large["run_s"] - large["handing_out_s"]) / large["images"],
            (large["peak_mb"] - small["peak_mb"]) * 1e6 / (large["images"] - small["images"]),
        )

    def coordinator_s(self, workers: int) -> float:
        """Of a block, with so many workers: in proportion between what was measured, and beyond."""
        return self.few_s + (self.many_s - self.few_s) * max(workers - 2, 0) / (1_000 - 2)


@dataclass(frozen=True)
class Assumed:
    """What is assumed, and not measured.

    Parameters
    ----------
    straggler_sigma : float
        Of the natural logarithm of how much longer than its processor time a block takes; its median is 1.
    deaths_per_worker_hour : float
    replaced_s : float
        Seconds from a worker's death until another has taken its place.
    latency_s : float
        Of a request to a provider.
    connections : int
        Of the whole run, as ``--connections`` says.
    """

    straggler_sigma: float = 0.3
    deaths_per_worker_hour: float = 0.01
    replaced_s: float = 120.0
    latency_s: float = 0.1
    connections: int = DEFAULT_CONNECTIONS


@dataclass(frozen=True)
class Job:
    """What is to be done, and by whom.

    Parameters
    ----------
    images, block, workers : int
    policy : Policy or None
        Of the provider; None for imagery at hand, which is asked for nothing.
    coordinator : bool
        Whether its time counts.
    """

    images: int = IMAGES_IN_ALL
    block: int = IMAGES
    workers: int = WORKERS
    policy: Policy | None = None
    coordinator: bool = True


@dataclass(frozen=True)
class Run:
    """What a simulated run came to.

    Parameters
    ----------
    hours : float
        From the first block to the last.
    worker_hours, busy_hours, useful_hours : float
        Of workers that were there; that made blocks; of blocks that were committed.
    coordinator : float
        Share of the time in which the coordinator was busy.
    deaths, again, given_up : int
        Of workers; blocks begun again; blocks given up.
    tail_hours : float
        From when no block was left to hand out.
    """

    hours: float
    worker_hours: float
    busy_hours: float
    useful_hours: float
    coordinator: float
    deaths: int
    again: int
    given_up: int
    tail_hours: float

    @property
    def utilisation(self) -> float:
        """Share of the workers' time that went into blocks that were committed."""
        return self.useful_hours / self.worker_hours


def simulate(job: Job, measured: Measured, assumed: Assumed, seed: int = SEED) -> Run:
    """Simulate a run."""
    random = np.random.default_rng(seed)
    blocks = -(-job.images // job.block)
    sharers = min(filter(None, (job.workers, job.policy and job.policy.most_sharers)))
    work_s = job.block * measured.image_s + measured.block_s
    wait_s = least_s = 0.0
    if job.policy is not None:
        requests = job.block * measured.image_requests + measured.block_requests
        share = job.policy.shared(sharers)
        wait_s = requests * assumed.latency_s / share.connections(max(assumed.connections // sharers, 1))
        if share.requests_per_s:
            least_s = requests / share.requests_per_s + share.rest_s
    coordinator_s = measured.coordinator_s(job.workers) if job.coordinator else 0.0
    factors = _drawn(lambda n: np.exp(random.standard_normal(n) * assumed.straggler_sigma))
    lives = _drawn(lambda n: random.exponential(1.0, n))
    death_s = 3600.0 / assumed.deaths_per_worker_hour if assumed.deaths_per_worker_hour else math.inf

    # When each worker wants a block next, and how many times that block was begun already.
    free: list[tuple[float, int]] = [(0.0, 0)] * sharers
    row, again_s = blocks, []  # type: int, list[tuple[float, int]]
    coordinator_free_s = busy_s = useful_s = coordinated_s = end_s = tail_s = 0.0
    deaths = again = given_up = 0
    # A worker's end of a block, or replacement after a death, is when the next block is handed to it; a block whose
    # worker died is handed to the next that asks, as the product puts it in front of the row.
    while free:
        now_s, _ = heapq.heappop(free)
        tried = 0
        if again_s and again_s[0][0] <= now_s:
            _, tried = heapq.heappop(again_s)
        elif row:
            row -= 1
            tail_s = now_s
        elif again_s:
            # Blocks whose workers will die are known only then: until that this worker waits.
            heapq.heappush(free, (again_s[0][0], 0))
            continue
        else:
            continue
        begun_s = max(now_s, coordinator_free_s) + coordinator_s
        coordinator_free_s = begun_s
        coordinated_s += coordinator_s
        takes_s = max(work_s * (factor := next(factors)), wait_s * factor, least_s)
        lives_s = next(lives) * death_s
        if lives_s >= takes_s:
            end_s = max(end_s, begun_s + takes_s)
            busy_s, useful_s = busy_s + takes_s, useful_s + takes_s
            heapq.heappush(free, (begun_s + takes_s, 0))
            continue
        busy_s += lives_s
        deaths += 1
        if tried + 1 < TRIES:
            again += 1
            heapq.heappush(again_s, (begun_s + lives_s, tried + 1))
        else:
            given_up += 1
        end_s = max(end_s, begun_s + lives_s)
        heapq.heappush(free, (begun_s + lives_s + assumed.replaced_s, 0))
    hours = end_s / 3600.0
    return Run(
        hours,
        hours * job.workers,
        busy_s / 3600.0,
        useful_s / 3600.0,
        coordinated_s / end_s,
        deaths,
        again,
        given_up,
        (end_s - tail_s) / 3600.0,
    )


def _drawn(draw: Any) -> Any:
    """Random numbers, one after the other, drawn many at a time."""
    while True:
        yield from draw(1 << 16).tolist()


def validation(found: dict[str, Any]) -> list[dict[str, Any]]:
    """What the simulation says of the runs that were measured, from the run of one worker alone.

    The cores are shared by the workers, the coordinator and the store: what these two take is taken from all workers.
    """
    rows = []
    for one in found["compared"]:
        by_engine = {(row["engine"], row["layout"]): row for row in one["rows"] if row["engine"].startswith("local:")}
        for layout in ("folders", "webdataset"):
            first = by_engine["local:1", layout]
            of_one = Measured.of(found, "world" if one["source"] == WORLD else "raster")
            own_s = first["own_cpu_s"] + (first["store_cpu_s"] if layout == "webdataset" else 0.0)
            for workers in (1, 2, 4):
                row = by_engine[f"local:{workers}", layout]
                # Processor time there is beside what the coordinator and the store take, over what workers want.
                wanted = workers * first["workers_cpu_s"] / first["wall_s"] + own_s / first["wall_s"]
                slower = max(wanted / found["cores"], 1.0)
                block_s = first["wall_s"] / first["blocks"] * slower
                job = Job(int(row["blocks"]), 1, workers, coordinator=False)
                calm = Assumed(straggler_sigma=0.0, deaths_per_worker_hour=0.0)
                run = simulate(job, replace(of_one, image_s=block_s, block_s=0.0), calm)
                rows.append(
                    {
                        "source": one["source"], "layout": layout, "workers": workers,
                        "simulated_s": run.hours * 3600.0, "measured_s": row["wall_s"],
                    }
                )  # fmt: skip
    return rows


CASES = (
    ("local imagery (no requests)", None, DEFAULT_CONNECTIONS),
    ("a provider without limits, 8 connections", Policy(), DEFAULT_CONNECTIONS),
    ("a provider without limits, 8,000 connections", Policy(), 8_000),
    ("1,000 requests/s, 8,000 connections", Policy(requests_per_s=1_000.0), 8_000),
    ("100 requests/s, 8,000 connections", Policy(requests_per_s=100.0), 8_000),
)
CALM = {"straggler_sigma": 0.0, "deaths_per_worker_hour": 0.0}


def cases(images: int, measured: Measured) -> list[dict[str, Any]]:
    """Runs of each case, with stragglers and deaths, with one of them, and without."""
    rows = []
    for title, policy, connections in CASES:
        job, assumed = Job(images, policy=policy), Assumed(connections=connections)
        run = simulate(job, measured, assumed)
        calm = simulate(job, measured, replace(assumed, **CALM))
        rows.append(
            {
                "title": title,
                "run": run,
                "calm": calm,
                "stragglers": simulate(job, measured, replace(assumed, deaths_per_worker_hour=0.0)),
                "deaths": simulate(job, measured, replace(assumed, straggler_sigma=0.0)),
            }
        )
        print(title, run, flush=True)
    return rows


def sensitivity(images: int, measured: Measured) -> list[tuple[str, str, Run]]:
    """Runs with one assumption changed, imagery at hand."""
    job, usual = Job(images), Assumed()
    changed: list[tuple[str, str, Job, Measured, Assumed]] = [
        ("as above", "", job, measured, usual),
        *(
            ("stragglers", f"σ {sigma:g}", job, measured, replace(usual, straggler_sigma=sigma))
            for sigma in (0.0, 0.6, 1.0)
        ),
    ]
    for deaths in (0.0, 0.1, 1.0, 10.0):
        more = replace(usual, deaths_per_worker_hour=deaths)
        changed.append(("deaths", f"{deaths:g} per worker and hour", job, measured, more))
    for block in (64, 1_024):
        of_size = replace(job, block=block)
        changed.append(("images a block", f"{block:,}", of_size, _for(measured, block), usual))
    for factor in (0.5, 2.0, 10.0):
        dearer = replace(measured, few_s=measured.few_s * factor, many_s=measured.many_s * factor)
        changed.append(("coordinator's time", f"× {factor:g}", job, dearer, usual))
    for factor in (0.5, 2.0):
        slower = replace(measured, image_s=measured.image_s * factor)
        changed.append(("worker's time of an image", f"× {factor:g}", job, slower, usual))
    return [(what, value, simulate(*how)) for what, value, *how in changed]  # type: ignore[arg-type]


def _for(measured: Measured, block: int) -> Measured:
    """With the coordinator's time for a block of another size: no more than in proportion, and no less than as much."""
    # What it notes of images grows with them; handing out does not. Both ways of dividing it were too much to measure.
    factor = max(block / IMAGES, 1.0)
    return replace(measured, few_s=measured.few_s * factor, many_s=measured.many_s * factor)


def of_workers(images: int, measured: Measured) -> list[tuple[int, Run, Run]]:
    """Runs of ever more workers, with the coordinator's time and without, imagery at hand."""
    rows = []
    for workers in (100, 200, 500, 1_000, 2_000, 5_000):
        job = Job(images, workers=workers)
        timeless = replace(job, coordinator=False)
        rows.append((workers, *(simulate(one, measured, Assumed()) for one in (job, timeless))))
    return rows


def bottleneck(measured: Measured) -> int:
    """Workers whose blocks take the coordinator all its time."""
    block_s = IMAGES * measured.image_s + measured.block_s
    return next(n for n in range(1, 1_000_000) if n * measured.coordinator_s(n) >= block_s)


def costs(run: Run, images: int, measured: Measured) -> list[dict[str, Any]]:
    """US dollars by cloud: processors of workers, puts, and a month of storage."""
    blocks = -(-images // IMAGES)
    stored_gb = (images * measured.image_bytes + blocks * measured.block_bytes) / 1e9
    rows = []
    for cloud, prices in PRICES.items():
        parts = {
            "processors": run.worker_hours * prices["vcpu_hour"].usd,
            "puts": blocks * measured.block_puts / 1e3 * prices["put_1000"].usd,
            "a month of storage": stored_gb * prices["storage_gb_month"].usd,
        }
        rows.append({"cloud": cloud, "stored_gb": stored_gb, **parts})
    return rows


def draw(workers: list[tuple[int, Run, Run]], rows: list[dict[str, Any]], limit: int) -> None:
    """Hours against workers, and in each case."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.25))
    counts = [each[0] for each in workers]
    left.loglog(counts, [each[1].hours for each in workers], "o-", color=BLUE, label="with the coordinator's time")
    left.loglog(counts, [each[2].hours for each in workers], "--", color=GREY, label="without")
    left.axvline(limit, color=ORANGE, linewidth=1, label=f"coordinator always busy: {limit:,}")
    left.set(title="Time of 100 million local images", xlabel="workers", ylabel="hours")
    left.grid(visible=True, which="major", color="#dddddd")
    left.legend(edgecolor="none", framealpha=1.0, fontsize=8, loc="lower left")
    at = np.arange(len(rows))
    bars = right.barh(at, [row["run"].hours for row in rows], color=GREEN)
    right.bar_label(bars, [f"{row['run'].hours:,.1f}" for row in rows], padding=3, fontsize=8)
    right.set_yticks(at, [row["title"].replace(", ", ",\n").replace(" (", "\n(") for row in rows], fontsize=8)
    right.invert_yaxis()
    right.set(title="1,000 workers, by source", xlabel="hours", xscale="log")
    right.margins(x=0.15)
    PICTURES.mkdir(exist_ok=True)
    figure.savefig(PICTURES / "scale-simulation.png", dpi=110)


def simulation_text(
    rows: list[dict[str, Any]],
    changed: list[tuple[str, str, Run]],
    workers: list[tuple[int, Run, Run]],
    measured: Measured,
    images: int,
) -> str:
    """Tables of the simulation."""
    usual = Assumed()
    text = f"""\
Made by `python benchmarks/scale_simulation.py` from the costs above: {images:,} images of a local raster's size in
{-(-images // IMAGES):,} blocks of {IMAGES}, {WORKERS:,} workers with a core each. A block takes a worker
{IMAGES * measured.image_s + measured.block_s:.1f} s of processor time and the coordinator
{measured.coordinator_s(WORKERS) * 1e3:.0f} ms with so many workers. Assumed, not measured: a block takes longer than
its processor time by a log-normal factor of median 1 and σ {usual.straggler_sigma:g}; a worker dies
{usual.deaths_per_worker_hour:g} times per hour and is replaced after {usual.replaced_s:g} s; a provider responds after
{usual.latency_s * 1e3:g} ms. *In use* is the share of worker hours that went into committed blocks, including waits for
a provider; *lost* is how much shorter the run would be without.

| source | hours | worker hours | in use | lost to stragglers | lost to deaths | coordinator busy | deaths | abandoned |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""
    for row in rows:
        run = row["run"]
        text += (
            f"| {row['title']} | {run.hours:,.1f} | {run.worker_hours:,.0f} | {run.utilisation:.0%} | "
            f"{1 - row['deaths'].hours / run.hours:.1%} | {1 - row['stragglers'].hours / run.hours:.1%} | "
            f"{run.coordinator:.0%} | {run.deaths:,} | {run.given_up:,} |\n"
        )
    busiest = bottleneck(measured)
    ends_h, memory_gb = images * measured.image_ends_s / 3600.0, images * measured.image_memory_bytes / 1e9
    text += f"""
![Hours against workers, and by source](images/scale-simulation.png)

The coordinator can hand out blocks for {busiest:,} workers, and more do not help. Larger blocks are assumed to cost it
proportionally more, which is the worst case, and smaller ones no less. In addition to the hours above, planning such a
run and writing its tables takes one process {ends_h:.1f} h, and its state for all images takes {memory_gb:.0f} GB of
memory. Missions of ten million images, the most without `--max-images`, take {ends_h / images * 1e7 * 60:.0f} min and
{memory_gb / images * 1e7:.0f} GB each.

Local imagery, with one assumption changed at a time:

| assumption | value | hours | in use | coordinator busy | repeated | abandoned |
| --- | --- | ---: | ---: | ---: | ---: | ---: |
"""
    for what, value, run in changed:
        text += (
            f"| {what} | {value} | {run.hours:,.2f} | {run.utilisation:.0%} | {run.coordinator:.0%} | "
            f"{run.again:,} | {run.given_up:,} |\n"
        )
    text += "\n| workers | hours | hours without the coordinator's time | coordinator busy |\n"
    text += "| ---: | ---: | ---: | ---: |\n"
    for count, run, without in workers:
        text += f"| {count:,} | {run.hours:,.2f} | {without.hours:,.2f} | {run.coordinator:.0%} |\n"
    return text


def validation_text(rows: list[dict[str, Any]]) -> str:
    """Table of simulated beside measured seconds."""
    text = (
        "| source | results | workers | simulated, s | measured, s | ratio |\n"
        "| --- | --- | ---: | ---: | ---: | ---: |\n"
    )
    for row in rows:
        text += (
            f"| {TITLE_OF[row['source'] == WORLD]} | {'S3' if row['layout'] == 'webdataset' else 'folder'} | "
            f"{row['workers']} | {row['simulated_s']:.1f} | {row['measured_s']:.1f} | "
            f"{row['simulated_s'] / row['measured_s']:.2f} |\n"
        )
    return text


def costs_text(rows: list[dict[str, Any]]) -> str:
    """Table of costs, and the prices they are made of."""
    stored = rows[0]["stored_gb"]
    text = (
        f"List prices in US dollars, looked up on {LOOKED_UP} (`benchmarks/cloud_prices.py`), of the first row above: "
        f"a vCPU for each worker, no coordinator, no source; {stored:,.0f} GB stored.\n\n"
        "| cloud | processors | puts | a month of storage | together |\n| --- | ---: | ---: | ---: | ---: |\n"
    )
    for row in rows:
        parts = [row[name] for name in ("processors", "puts", "a month of storage")]
        text += f"| {row['cloud']} | {' | '.join(f'{each:,.2f}' for each in (*parts, sum(parts)))} |\n"
    text += "\n| cloud | price | of | what | stated | source |\n| --- | ---: | --- | --- | --- | --- |\n"
    for cloud, prices in PRICES.items():
        for name in ("vcpu_hour", "put_1000", "storage_gb_month", "egress_gb"):
            one = prices[name]
            text += f"| {cloud} | {one.usd:g} | {one.unit} | {one.what} | {one.stated or 'no date'} | {one.source} |\n"
    return text


def main() -> None:
    """Simulate, and write the page's parts."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--images", type=int, default=IMAGES_IN_ALL)
    parser.add_argument("--found", type=Path, default=FOUND, help="figures of benchmarks/scale.py")
    parser.add_argument("--only", choices=("validation",), help="one part")
    parser.add_argument("--no-page", action="store_true", help="write nothing into docs/")
    asked = parser.parse_args()
    found = json.loads(asked.found.read_text("utf-8"))
    checked = validation(found)
    print(validation_text(checked), flush=True)
    print(
        "median of |ratio - 1|:",
        statistics.median(abs(r["simulated_s"] / r["measured_s"] - 1) for r in checked),
    )
    if asked.only:
        put_in_page(validation=validation_text(checked))
        return
    measured = Measured.of(found, "raster")
    print(measured, flush=True)
    rows = cases(asked.images, measured)
    changed, workers = sensitivity(asked.images, measured), of_workers(asked.images, measured)
    parts = {
        "simulation": simulation_text(rows, changed, workers, measured, asked.images),
        "validation": validation_text(checked),
        "costs": costs_text(costs(rows[0]["run"], asked.images, measured)),
    }
    if asked.no_page:
        print("\n".join(parts.values()))
        return
    draw(workers, rows, bottleneck(measured))
    put_in_page(**parts)


if __name__ == "__main__":
    main()
