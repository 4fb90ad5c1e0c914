"""A capture into an object store whose workers, and then whose coordinator, are killed again and again.

    python benchmarks/cluster_kills.py                          # writes its part of docs/scale.md
    python benchmarks/cluster_kills.py --images 400 --kills 3 --coordinator-kills 1 --no-page

Two workers of a LocalCluster put shards into an S3 store on loopback, a process of its own, and are killed (SIGKILL) at
random moments that a seed gives. Then each image has to be there once, and every object has to be the same, byte by
byte, as that of a run in one process that nobody disturbed. The same is done to the process of the run itself, which is
resumed each time; its workers have to be gone before the next run begins.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import math
import os
import signal
import subprocess
import sys
import tarfile
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from hashlib import sha256
from typing import Any

import numpy as np
import psutil
from object_store import ObjectStore
from scale import WORLD, machine_text, planned, put_in_page

IMAGE_PX, BLOCK_IMAGES, WORKERS = 64, 100, 2
#: Share of the images by which the last kill is done, so that it finds workers at work.
_LAST = 0.95
#: Seconds in which the workers of a run that was killed have to end.
_ORPHANS_S = 20.0


def mission_of(images: int) -> tuple[Any, Any]:
    """Plan of small images, and its source."""
    return planned(WORLD, images, image_px=IMAGE_PX)


def workers() -> list[psutil.Process]:
    """Worker processes of this process' own cluster."""
    found = []
    for one in psutil.Process().children():
        # Those that were killed are there until they are waited for.
        with suppress(psutil.ZombieProcess, psutil.NoSuchProcess):
            if "multiprocessing.spawn" in " ".join(one.cmdline()):
                found.append(one)
    return found


class Killer:
    """Kills a worker of this process whenever enough images are done."""

    def __init__(self, images: int, kills: int, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self._at = np.sort(self._random.uniform(0.0, _LAST * images, kills)).tolist()
        self.killed: list[int] = []

    def __call__(self, progress: Any) -> None:
        """Kill one, if it is time."""
        if not self._at or progress.done < self._at[0]:
            return
        # A worker that begins anew is a while on its way.
        alive = [one for one in workers() if one.pid not in self.killed]
        if alive:
            self._at.pop(0)
            chosen = alive[int(self._random.integers(len(alive)))]
            chosen.kill()
            self.killed.append(chosen.pid)


def captured(images: int, address: str, engine: str, kills: int, seed: int, resume: bool) -> dict[str, Any]:
    """Capture in this process; the images done are printed, as a line a second at most."""
    from terrainav.core.capture.blocks.engines import local_engine, open_engine
    from terrainav.core.capture.blocks.running import Blocks
    from terrainav.core.capture.progress import Listener
    from terrainav.core.capture.runner import capture

    worked_out, named = mission_of(images)
    killer, notices = Killer(len(worked_out), kills, seed), []
    told_s = 0.0

    def progress(now: Any) -> None:
        nonlocal told_s
        killer(now)
        if time.monotonic() - told_s > 0.2:
            told_s = time.monotonic()
            print(
                json.dumps({"done": now.done + now.skipped, "workers": [one.pid for one in workers()]}),
                flush=True,
            )

    with local_engine() if engine == "here" else open_engine(engine) as opened:
        result = capture(
            worked_out,
            named,
            address,
            executor=opened,
            blocks=Blocks(BLOCK_IMAGES, "webdataset"),
            resume=resume,
            listener=Listener(progress=progress, notice=lambda text: notices.append(str(text))),
        )
    return {
        "written": result.written,
        "skipped": result.skipped,
        "failed": len(result.failed),
        "seconds": result.seconds,
        "killed": len(killer.killed),
        "begun_again": len(notices),
        "notices": sorted({one.partition(": ")[2] for one in notices}),
    }


def in_own_process(job: dict[str, Any], watch: Callable[[dict[str, Any]], bool] | None = None) -> dict[str, Any]:
    """Run `captured` in a process of its own; ``watch`` sees what it prints, and says whether to kill it."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, __file__, "--job", json.dumps(job)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        told: dict[str, Any] = {}
        for line in process.stdout or ():
            told = json.loads(line)
            if watch is not None and "done" in told and watch(told):
                os.kill(process.pid, signal.SIGKILL)
                process.wait()
                return {**told, "was_killed": True}
    if process.returncode or "written" not in told:
        raise SystemExit(f"{job}: ended with {process.returncode}")
    return told


def with_dying_coordinator(job: dict[str, Any], images: int, kills: int, seed: int) -> dict[str, Any]:
    """Capture by processes that are killed, and resumed, so many times."""
    random = np.random.default_rng(seed)
    at = np.sort(random.uniform(0.05, 0.8, kills) * images).tolist()
    found: dict[str, Any] = {"kills": 0, "orphans": 0}
    while True:
        until = at[found["kills"]] if found["kills"] < kills else math.inf
        began = time.monotonic()
        told = in_own_process(
            {**job, "resume": found["kills"] > 0},
            partial(is_due, until),
        )
        if not told.get("was_killed"):
            return {**found, **told}
        found["kills"] += 1
        _, alive = psutil.wait_procs(list(filter(None, map(process_of, told["workers"]))), timeout=_ORPHANS_S)
        found["orphans"] += len(alive)
        print(f"coordinator killed at {told['done']} images after {time.monotonic() - began:.0f} s", flush=True)


def is_due(until: float, told: dict[str, Any]) -> bool:
    """Whether a run has done so many images, and has workers."""
    return told["done"] >= until and bool(told["workers"])


def process_of(pid: int) -> psutil.Process | None:
    """Process, where it is there."""
    try:
        return psutil.Process(pid)
    except psutil.NoSuchProcess:
        return None


def objects(address: str) -> dict[str, bytes]:
    """All objects below an address, by name."""
    import s3fs

    store = s3fs.S3FileSystem()
    store.invalidate_cache()
    root = address.partition("://")[2]
    return {name[len(root) + 1 :]: store.cat_file(name) for name in store.find(root)}


def check_images(found: dict[str, bytes], names: list[str]) -> dict[str, int]:
    """Refuse results in which an image is missing, is there twice, or is not where the table says."""
    rows = list(csv.DictReader(io.StringIO(found["satellite/meta_data.csv"].decode("utf-8"))))
    in_table = Counter(row["img_names"].rpartition(".")[0] for row in rows)
    if in_table != Counter(names):
        raise SystemExit(f"the table has {len(rows)} rows of {len(in_table)} images, and not {len(names)}")
    keys: Counter[str] = Counter()
    for name, data in found.items():
        if name.endswith(".tar"):
            with tarfile.open(fileobj=io.BytesIO(data)) as tar:
                keys.update(one.name.partition(".")[0] for one in tar.getmembers() if one.name.endswith(".tif"))
    if keys != Counter(f"{index:09d}" for index in range(len(names))):
        raise SystemExit(f"the shards have {sum(keys.values())} images, {len(keys)} different ones")
    for row in rows:
        offset, size = int(row["offset_bytes"]), int(row["size_bytes"])
        image = found[f"satellite/{row['shard']}"][offset : offset + size]
        if image[:4] not in (b"II*\0", b"MM\0*") or len(image) != size:
            raise SystemExit(f"{row['img_names']}: is not where the table says")
    return {
        "rows": len(rows),
        "images": sum(keys.values()),
        "shards": sum(name.endswith(".tar") for name in found),
    }


def differing(one: dict[str, bytes], other: dict[str, bytes]) -> list[str]:
    """Names of objects that only one has, or that differ."""
    digests = [{name: sha256(data).hexdigest() for name, data in each.items()} for each in (one, other)]
    return sorted({name for name, _ in digests[0].items() ^ digests[1].items()})


TEXT = """\
Measured by `python benchmarks/cluster_kills.py` on {machine}: {images:,} images of about {px} px in {shards} blocks of
{block} at most, {workers} workers, shards into S3 on loopback.

| killed with SIGKILL | times | images in the table | images in the shards | objects | objects that differ |
| --- | ---: | ---: | ---: | ---: | ---: |
{rows}
Objects are compared by SHA-256 with those of an undisturbed run in one process. No image is missing, none appears
twice, {failed} failed, and each is in its shard at the position in the table. Blocks were repeated {begun_again} times
after {killed} workers were killed; a worker may briefly hold two. The run took {seconds:.0f} s with these kills, and
{calm_s:.0f} s undisturbed in one process. The coordinator's last run found {skipped:,} existing images; {orphans}
workers outlived their coordinator.
"""
ROW = "| {what} | {times} | {rows:,} | {images:,} | {objects:,} | {differ} |\n"


def main() -> None:
    """Capture three times, and compare."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--images", type=int, default=20_000)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--coordinator-kills", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--no-page", action="store_true", help="write nothing into docs/")
    parser.add_argument("--job", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.job:
        print(json.dumps(captured(**json.loads(asked.job))))
        return
    names = list(mission_of(asked.images)[0].names)
    job = {"images": asked.images, "kills": 0, "seed": asked.seed, "resume": False}
    cluster = f"local:{WORKERS}"
    with ObjectStore() as store:
        places = {name: f"{store.address}/{name}" for name in ("calm", "killed", "resumed")}
        calm = in_own_process({**job, "address": places["calm"], "engine": "here"})
        print(calm, flush=True)
        killed = in_own_process({**job, "address": places["killed"], "engine": cluster, "kills": asked.kills})
        print(killed, flush=True)
        again = {**job, "address": places["resumed"], "engine": cluster}
        resumed = with_dying_coordinator(again, len(names), asked.coordinator_kills, asked.seed)
        print(resumed, flush=True)
        kept = {name: objects(place) for name, place in places.items()}
    checked = {name: check_images(each, names) for name, each in kept.items()}
    differ = {name: differing(kept["calm"], kept[name]) for name in ("killed", "resumed")}
    print(json.dumps({"checked": checked, "differ": differ}), flush=True)
    if any(differ.values()) or killed["killed"] != asked.kills or killed["failed"] or resumed["failed"]:
        raise SystemExit("not as it should be")
    if asked.no_page:
        return
    rows = ""
    for name, what, times in (
        ("killed", "workers", killed["killed"]),
        ("resumed", "the coordinator", resumed["kills"]),
    ):
        rows += ROW.format(what=what, times=times, objects=len(kept[name]), differ=len(differ[name]), **checked[name])
    put_in_page(
        kills=TEXT.format(
            machine=machine_text(),
            px=IMAGE_PX,
            block=BLOCK_IMAGES,
            workers=WORKERS,
            images=len(names),
            shards=checked["calm"]["shards"],
            rows=rows,
            failed=killed["failed"] + resumed["failed"],
            calm_s=calm["seconds"],
            orphans=resumed["orphans"],
            skipped=resumed["skipped"],
            **{key: killed[key] for key in ("killed", "begun_again", "seconds")},
        )
    )


if __name__ == "__main__":
    main()
