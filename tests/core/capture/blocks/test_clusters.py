"""Blocks on a real cluster, with results in a real object store on loopback: killed workers, limits, the command."""

from __future__ import annotations

import io
import os
import platform
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from types import SimpleNamespace

import pytest
from terrainav.core.capture.blocks import engines
from terrainav.core.capture.blocks.engines import open_engine
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.resources import version
from terrainav.core.storage.stores import get, list_sizes, store_path

from tests.support.command import command
from tests.support.objects import SECRET, s3_store
from tests.support.sources import NamedPattern
from tests.support.thinning import sampled
from tests.support.waiting import wait_until

pytest.importorskip("distributed", reason="needs Dask's distributed")
MISSION = Mission(Box(35.16, -89.90, 35.1555, -89.892), 120.0, zoom=18, overlap_along=0.4)
PATTERN = NamedPattern()
PLAN = plan(MISSION, PATTERN.grid)
#: Dask's own warnings, of ports that are taken and workers that are slow to end, are none of ours.
pytestmark = pytest.mark.filterwarnings("default")


@pytest.fixture(scope="module")
def bucket():
    with pytest.MonkeyPatch.context() as monkeypatch, s3_store(monkeypatch) as address:
        yield address


@pytest.fixture(scope="module")
def cluster(bucket):
    with open_engine("local:2") as engine:
        yield engine


def objects(address: str) -> dict[str, bytes]:
    """All objects of a run, in folders of one level, by name."""
    root = store_path(address)
    names = [
        *list_sizes(root),
        *(f"{f}/{name}" for f in ("blocks", "satellite") for name in list_sizes(root / f)),
    ]
    return {name: get(root / name) for name in names}


@pytest.fixture(scope="module")
def whole(bucket):
    """What a run of one machine leaves."""
    capture(PLAN, PATTERN, f"{bucket}/whole", blocks=Blocks(12, "webdataset"))
    return objects(f"{bucket}/whole")


def workers_of(engine) -> list[int]:
    """Process numbers of a cluster's workers, of those that answer."""
    answers = engine.executor._client.run(os.getpid, on_error="ignore")
    return [one for one in answers.values() if isinstance(one, int)]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_workers_that_are_killed_lose_nothing(bucket, cluster, whole):
    killed, notices = [], []

    def progress(told):
        # One after each block, as soon as it is told.
        if told.done > 12 * len(killed) and len(killed) < 3:
            for victim in workers_of(cluster)[:1]:
                with suppress(ProcessLookupError):
                    os.kill(victim, signal.SIGKILL)
                    killed.append(victim)

    slow = NamedPattern(wait_s=0.02)
    result = capture(
        PLAN,
        slow,
        f"{bucket}/killed",
        executor=cluster,
        blocks=Blocks(12, "webdataset"),
        listener=Listener(progress=progress, notice=lambda text: notices.append(str(text))),
    )
    assert killed
    # Where both have died, a run waits for the first to be there again.
    of_blocks = [notice for notice in notices if not notice.startswith("workers: ")]
    assert all("its worker died: it is begun again" in notice for notice in of_blocks)
    assert (result.failed, result.written) == ((), len(PLAN))
    assert objects(f"{bucket}/killed") == whole


def test_blocks_of_a_run_that_was_stopped_end_and_leave_nothing(bucket, cluster):
    begun_s = []

    def cancelled():
        if not begun_s and any(cluster.executor._client.processing().values()):
            begun_s.append(time.monotonic())
        return bool(begun_s) and time.monotonic() - begun_s[0] > 0.5

    result = capture(
        PLAN,
        NamedPattern(wait_s=0.1),
        f"{bucket}/stopped",
        executor=cluster,
        blocks=Blocks(100),
        connections=1,
        listener=Listener(cancelled=cancelled),
    )
    assert (result.cancelled, result.written) == (True, 0)
    # What workers are handed next comes when these blocks have ended.
    pending = [cluster.executor.submit(os.getpid) for _ in range(4)]
    assert all(one.result(60.0) for one in pending)
    assert set(list_sizes(store_path(f"{bucket}/stopped/blocks"))) == {"blocks.json"}
    assert "run.lock" not in list_sizes(store_path(f"{bucket}/stopped"))


@pytest.mark.thorough
def test_the_command_captures_on_a_cluster_into_a_store(bucket, tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    asked = ("capture", "--coords", "35.16_-89.90_35.158_-89.898_120", "--max-px", "200")
    shards = ("--block", "4", "--layout-of-files", "webdataset")
    done = run(*asked, "--data-dir", f"{bucket}/command", "--cluster", "local:1", *shards)
    assert done.returncode == 0, done.stderr
    assert "cluster of 1 workers" in done.stderr
    assert f"dataset in {bucket}/command" in done.stdout
    assert get(store_path(f"{bucket}/command/satellite/meta_data.csv")).count(b"done") > 3
    pq = pytest.importorskip("pyarrow.parquet", reason="needs pyarrow")
    described = pq.read_table(io.BytesIO(get(store_path(f"{bucket}/command/items.parquet"))))
    assert described.num_rows == len(read_dataset(f"{bucket}/command").image_set("satellite"))
    again = run(*asked, "--data-dir", f"{bucket}/command", *shards)
    assert (again.returncode, again.stdout) == (3, "")
    assert "already holds this mission; resume it (--resume)" in again.stderr


@pytest.mark.thorough
def test_what_a_cluster_has_captured_is_streamed_into_a_training_step(bucket, cluster):
    torch = pytest.importorskip("torch", reason="needs PyTorch")
    from terrainav.core.dataset.loading.torch_loader import TorchDataset

    capture(PLAN, PATTERN, f"{bucket}/trained", executor=cluster, blocks=Blocks(12, "webdataset"))
    dataset = TorchDataset(f"{bucket}/trained", part="all", img_size=(32, 24, 3), shuffle=True)
    model = torch.nn.Sequential(torch.nn.Flatten(), torch.nn.Linear(3 * 24 * 32, 2))
    optimiser, seen = torch.optim.SGD(model.parameters(), lr=1e-4), 0
    before = model[1].weight.detach().clone()
    for images, labels in dataset.batches(batch_size=8):
        optimiser.zero_grad()
        loss = torch.nn.functional.mse_loss(model(images), labels)
        loss.backward()
        optimiser.step()
        seen += len(images)
    assert seen == len(PLAN)
    assert torch.isfinite(loss)
    assert not torch.equal(before, model[1].weight)


#: Begins a worker of Dask's; in that without TerrAInav it cannot be imported.
WORKER = "from distributed.cli.dask_worker import main; main()"
WITHOUT = f"import sys; sys.modules['terrainav'] = None; {WORKER}"


@contextmanager
def process(*arguments: str) -> Iterator[None]:
    """A process of this Python's that lasts as long as it is needed."""
    with subprocess.Popen([sys.executable, *arguments], stderr=subprocess.DEVNULL) as begun:
        try:
            yield
        finally:
            begun.terminate()


@contextmanager
def scheduler() -> Iterator[int]:
    """A scheduler of Dask's; yields its port."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    module = ("-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port))
    with process(*module, "--no-dashboard"):
        yield port


def worker(program: str, port: int) -> AbstractContextManager[None]:
    return process("-c", program, f"tcp://127.0.0.1:{port}", "--nthreads", "1", "--no-nanny", "--no-dashboard")


@pytest.mark.thorough
def test_workers_of_a_scheduler_that_is_there(tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)

    def captured():
        asked = ("capture", "--coords", "35.16_-89.90_35.158_-89.898_120", "--max-px", "200")
        return run(*asked, "--block", "8", "--cluster", f"dask://127.0.0.1:{port}", "--data-dir", "out", "--resume")

    with scheduler() as port:
        with worker(WITHOUT, port), worker_there(port):
            refused = captured()
        assert refused.returncode == 3
        last = refused.stderr.splitlines()[-1]
        assert last.startswith("terrainav: cluster: 1 of 1 workers cannot make blocks: tcp://127.0.0.1:")
        assert last.endswith(f" has no TerrAInav; install it there: pip install 'terrainav[cluster]=={version()}'")
        assert not (tmp_path / "out").exists()
        with worker(WORKER, port):
            done = captured()
    assert done.returncode == 0, done.stderr
    assert "4 images written, 0 failed" in done.stdout


@contextmanager
def worker_there(port: int) -> Iterator[None]:
    """Wait until a scheduler has a worker."""
    from distributed import Client

    with Client(f"tcp://127.0.0.1:{port}", set_as_default=False) as client:
        wait_until(lambda: len(client.nthreads()) == 1)
    yield


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (ModuleNotFoundError("No module named 'numpy'", name="numpy"), "has no numpy, which TerrAInav needs"),
        (AttributeError("no version"), "cannot import TerrAInav (AttributeError: no version)"),
        ((platform.python_version(), "0.0.9", True), f"has TerrAInav 0.0.9, and the run has {version()}"),
        (("3.8.2", version(), True), f"has Python 3.8.2, and the run has {platform.python_version()}"),
        ((platform.python_version(), version(), True), None),
        (OSError("it has gone"), None),
    ],
)
def test_what_a_worker_lacks_is_named(answer, said):
    assert engines._problem(answer) == said


def test_a_worker_is_asked_when_it_comes_and_not_again():
    there, asked = {"tcp://a": 2}, []

    def run(_function, _argument, workers, on_error):
        asked.append(workers)
        return dict.fromkeys(workers, (platform.python_version(), version(), True))

    workers = engines._Workers(SimpleNamespace(nthreads=lambda: there, run=run))
    assert [workers.slots() for _ in range(3)] == [2] * 3
    there["tcp://b"] = 1
    assert [workers.slots() for _ in range(3)] == [3] * 3
    assert asked == [["tcp://a"], ["tcp://b"]]


@pytest.mark.thorough
def test_each_worker_is_asked_once_also_one_that_comes_later():
    with scheduler() as port, worker(WORKER, port), open_engine(f"dask://127.0.0.1:{port}") as engine:
        wait_until(lambda: engine.slots() == 1)
        client = engine.executor._client
        asked = []
        run = client.run
        client.run = lambda *arguments, **how: asked.append(how["workers"]) or run(*arguments, **how)
        assert [engine.slots() for _ in range(5)] == [1] * 5
        assert asked == []
        with worker(WITHOUT, port):
            wait_until(lambda: len(client.nthreads()) == 2)
            with pytest.raises(OutputError, match=r"cluster: 1 of 1 workers cannot make blocks: tcp://.* has no"):
                engine.slots()
        assert len(asked) == 1


@pytest.mark.parametrize(
    ("options", "said"),
    sampled(
        [
            (("--cluster", "dask://127.0.0.1:9"), "cluster dask://127.0.0.1:9: no scheduler answers there"),
            (("--cluster", "local:0"), "cluster 'local:0': must be local:N"),
            (("--cluster", "kubernetes"), "up to 1,024, or such as dask://127.0.0.1:8786\n"),
            (
                ("--cluster", "local:1", "--data-dir", "memory://x/y"),
                "address memory://x/y: is of this process alone, and workers are others: must be a folder",
            ),
            (("--block", "many"), "block 'many': must be 1 to 100,000 images"),
            (("--data-dir", "s3://nobody/x"), "s3://nobody/x/mission.json: is not there, or s3://nobody is not"),
            (("--data-dir", "foo://x/y"), "address 'foo://x/y': must be a folder, or begin with s3://"),
        ],
        3,
    ),
)
def test_bad_input_is_one_line(options, said, bucket, tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    monkeypatch.setattr("terrainav.core.capture.blocks.engines.MAX_SCHEDULER_SILENCE_S", 0.5)
    places = () if "--data-dir" in options else ("--data-dir", "out")
    done = run("capture", "--coords", "35.16_-89.90_35.158_-89.898_120", *places, *options)
    assert done.returncode in (2, 3), done.stderr
    assert said in done.stderr
    assert len([line for line in done.stderr.splitlines() if not line.startswith("cluster of")]) == 1
    assert SECRET not in done.stderr
    assert bucket.startswith("s3:")


def test_credentials_that_are_missing_or_wrong_are_one_line(bucket, monkeypatch):
    import s3fs

    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.delenv(name)
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    s3fs.S3FileSystem.clear_instance_cache()
    with pytest.raises(OutputError, match=r"^s3://data/nobody/.*: no valid credentials"):
        capture(PLAN, PATTERN, f"{bucket}/nobody")
    s3fs.S3FileSystem.clear_instance_cache()


def test_another_engine_is_refused():
    with pytest.raises(InvalidInput, match=r"^cluster 'local:0': must be local:N"), open_engine("local:0"):
        pass
