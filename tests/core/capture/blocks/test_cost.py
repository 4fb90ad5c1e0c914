"""What a run does with each of its images, however often it is asked how far it is."""

from concurrent.futures import Executor, Future

from terrainav.core.capture import journal, progress
from terrainav.core.capture.blocks.block import BlockResult, Record
from terrainav.core.capture.blocks.engines import Engine
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan


class _Failing(Executor):
    """Workers whose images all fail, at once."""

    def submit(self, _make, block):
        outcomes = {name: journal.Outcome(block.map_type, name, reason="none here") for name in block.plan.names}
        future = Future()
        future.set_result(BlockResult(Record(outcomes), 0, 0))
        return future


def test_progress_looks_at_each_image_a_fixed_number_of_times(tmp_path, monkeypatch):
    looked = []
    monkeypatch.setattr(progress, "_REPORT_S", 0.0)
    monkeypatch.setattr(journal.Outcome, "status", property(lambda self: looked.append(self) or journal.FAILED))
    source = named_source("world")
    worked_out = plan(Mission(Box(35.16, -89.90, 35.15, -89.885), 120.0), source.grid)
    told = []
    result = capture(
        worked_out,
        source,
        tmp_path / "out",
        executor=Engine(_Failing(), lambda: 1, in_process=True),
        blocks=Blocks(1),
        listener=Listener(progress=told.append),
    )
    assert len(worked_out) > 50
    assert len(told) > len(worked_out)
    assert told[-1].failed == len(result.failed) == len(worked_out)
    assert [one.failed for one in told] == sorted(one.failed for one in told)
    assert len(looked) < 10 * len(worked_out)
