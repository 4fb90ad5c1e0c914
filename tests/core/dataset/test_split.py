"""Splits: who is in which part, that it is the same everywhere, and that what cannot be split is left alone."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.folder import PARTS
from terrainav.core.dataset.labels import LABELS_FILE, Labels
from terrainav.core.dataset.loading import LabelledImages
from terrainav.core.dataset.split import shuffle, split, undo_split
from terrainav.core.dataset.table import SPLIT, Table, image_parts, usable_rows
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.storage.files import open_locked

from tests.core.dataset.grounds import dataset_of
from tests.support.command import command
from tests.support.sources import PatternSource
from tests.support.thinning import examples

run = pytest.fixture(command, name="run")

AREA = Box(35.16, -89.90, 35.1555, -89.8945)


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    """Folder of a capture of two map types; not to be changed."""
    folder = tmp_path_factory.mktemp("captured") / "out"
    source = PatternSource(("satellite", "roadmap"))
    mission = Mission(AREA, 60.0, image_format="jpg", map_types=("satellite", "roadmap"), max_px=64)
    assert capture(plan(mission, source.grid), source, folder).failed == ()
    return folder


def in_row(tmp_path, count, **changes) -> Path:
    """Dataset of windows of 10 px side by side at zoom 19."""
    return dataset_of(
        tmp_path / "out", 19, [(100_000_000 + 10 * i, 50_000_000, 10, 10) for i in range(count)], **changes
    )


def parts_in(folder: Path, map_type: str = "satellite") -> dict[str, str]:
    table = Table.load(folder / map_type / "meta_data.csv")
    return {Path(name).stem: part for name, part in zip(table.img_names, image_parts(table))}


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_order_is_that_of_the_hashes_on_every_machine():
    names = [
        "0_0_35.1_-89.9_19",
        "1_0_35.1_-89.8_19",
        "2_0_35.1_-89.7_19",
        "0_1_35.0_-89.9_19",
        "1_1_35.0_-89.8_19",
    ]
    # sha256sum of `2024:0_0_35.1_-89.9_19` and so on, sorted.
    assert [names.index(name) for name in shuffle(names, 2024)] == [0, 2, 3, 1, 4]
    assert [names.index(name) for name in shuffle(names, 7)] == [3, 0, 1, 4, 2]
    assert shuffle(names[::-1], 2024) == shuffle(names, 2024)


@pytest.mark.parametrize("how", ["shuffled", "in-order"])
@pytest.mark.parametrize("count", [3, 4, 7, 10, 99])
def test_every_image_is_in_one_part_and_the_shares_are_kept(tmp_path, how, count):
    folder = in_row(tmp_path, count)
    made = split(folder, how=how)
    counts = list(made.images.values())
    assert sum(counts) == count
    assert min(counts) >= 1
    assert list(parts_in(folder).values()).count("train") == made.images["train"]
    if count >= 10:
        assert all(abs(size - share * count) < 1.0 for size, share in zip(counts, (0.8, 0.1, 0.1)))
    assert (made.gap, made.unknown, made.left_out) == (0, 0, 0)
    assert math.fsum(made.shares.values()) == pytest.approx(1.0)


def test_in_order_follows_the_table_and_shuffled_the_hashes(tmp_path):
    folder = in_row(tmp_path, 10)
    split(folder, (0.5, 0.3, 0.2), how="in-order")
    assert list(parts_in(folder).values()) == ["train"] * 5 + ["validation"] * 3 + ["test"] * 2
    split(folder, (0.5, 0.3, 0.2))
    parts = parts_in(folder)
    assert [parts[name] for name in shuffle(parts)] == ["train"] * 5 + ["validation"] * 3 + ["test"] * 2
    other = split(folder, (0.5, 0.3, 0.2), seed=1)
    assert other.seed == 1
    assert parts_in(folder) != parts


def test_part_may_have_a_share_of_none(tmp_path):
    folder = in_row(tmp_path, 5)
    assert dict(split(folder, (0.8, 0.2, 0.0)).images) == {"train": 4, "validation": 1, "test": 0}
    assert dict(split(folder, (1.0, 0.0, 0.0), how="blocks").images) == {
        "train": 5,
        "validation": 0,
        "test": 0,
    }


@pytest.mark.parametrize("how", ["shuffled", "in-order", "blocks"])
def test_same_place_has_the_same_part_in_all_map_types_and_again(captured, tmp_path, how):
    folder = tmp_path / "out"
    shutil.copytree(captured, folder, copy_function=shutil.copyfile)
    first = split(folder, how=how)
    assert parts_in(folder) == parts_in(folder, "roadmap")
    assert sum(first.images.values()) + first.gap == len(parts_in(folder))
    assert min(first.images.values()) > 0
    written = contents(folder)
    assert split(folder, how=how) == first
    assert contents(folder) == written
    assert Labels.load(folder / LABELS_FILE) == first.labels
    assert first.labels.images == first.images["train"]
    capture(
        plan(
            Mission(AREA, 60.0, image_format="jpg", map_types=("satellite", "roadmap"), max_px=64),
            PatternSource().grid,
        ),
        PatternSource(("satellite", "roadmap")),
        folder,
        resume=True,
    )
    assert contents(folder) == written


def test_failed_and_rejected_images_are_in_no_part(captured, tmp_path):
    folder = tmp_path / "out"
    shutil.copytree(captured, folder, copy_function=shutil.copyfile)
    table = Table.load(folder / "roadmap" / "meta_data.csv")
    clean(folder, float(np.median(table.entropies)), move=True)
    made = split(folder)
    table = Table.load(folder / "satellite" / "meta_data.csv")
    assert 0 < made.left_out == (~usable_rows(table)).sum() < len(table)
    assert [not part for part in image_parts(table)] == [not one for one in usable_rows(table).tolist()]


@pytest.mark.parametrize("written", [0, 1, 2])
def test_split_that_was_interrupted_is_told_until_it_is_done_again(tmp_path, monkeypatch, written):
    """Between the tables of two map types a place may be in two parts."""
    folder, done = in_row(tmp_path, 20, map_types=("satellite", "roadmap")), tmp_path / "done"
    split(folder)
    shutil.copytree(folder, done)
    split(done, seed=1)
    saved = iter(range(written))

    def save(table, path):
        if next(saved, None) is None:
            raise KeyboardInterrupt
        real(table, path)

    real = Table.save
    monkeypatch.setattr(Table, "save", save)
    monkeypatch.setattr(Labels, "save", lambda *_: save(None, None))
    with pytest.raises(KeyboardInterrupt):
        split(folder, seed=1)
    monkeypatch.undo()
    assert (parts_in(folder) == parts_in(folder, "roadmap")) == (written != 1)
    with pytest.raises(InvalidInput, match="a split was interrupted"):
        LabelledImages(folder, img_size=(8, 8, 3))
    split(folder, seed=1)
    assert {path.relative_to(folder): data for path, data in contents(folder).items()} == {
        path.relative_to(done): data for path, data in contents(done).items()
    }
    LabelledImages(folder, img_size=(8, 8, 3))


def test_dry_run_changes_nothing_and_says_the_same(tmp_path):
    folder = in_row(tmp_path, 20)
    before = contents(folder)
    told = split(folder, dry_run=True)
    assert contents(folder) == before
    assert split(folder) == told


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"shares": (0.8, 0.1)}, "must be three"),
        ({"shares": (0.8, 0.3, -0.1)}, "not below 0"),
        ({"shares": (0.8, math.nan, 0.1)}, "finite"),
        ({"shares": (0.8, 0.1, 0.2)}, r"add up to 1\.1; must add up to 1"),
        ({"how": "by-eye"}, "must be one of auto, shuffled, in-order, blocks"),
        ({"how": "shuffled", "gap_m": 5.0}, "has no blocks and no gap"),
        ({"how": "in-order", "block_m": 5.0}, "has no blocks and no gap"),
        ({"how": "blocks", "block_m": 0.0}, "must be above 0 m"),
        ({"how": "blocks", "gap_m": -1.0}, "must be from 0"),
        ({"how": "blocks", "gap_m": math.inf}, "must be from 0"),
        ({"how": "blocks", "block_m": 1e6}, "leave one of train, validation, test without images"),
        ({"how": "blocks", "gap_m": 1e5}, "leave one of train, validation, test without images"),
        ({"frame": "moon"}, "must be utm"),
    ],
)
def test_split_that_cannot_be_made_says_so_and_changes_nothing(tmp_path, options, said):
    folder = in_row(tmp_path, 20)
    split(folder, seed=5)
    before = contents(folder)
    with pytest.raises(InvalidInput, match=said):
        split(folder, **options)
    assert contents(folder) == before


def test_too_few_images_and_none_at_all_are_refused(tmp_path):
    folder = in_row(tmp_path, 2)
    before = contents(folder)
    with pytest.raises(InvalidInput, match="needs 3 images or more; the dataset has 2"):
        split(folder)
    assert contents(folder) == before
    with pytest.raises(InvalidInput, match="nothing to split"):
        split(in_row(tmp_path / "failed", 3, status=("failed",) * 3))
    with pytest.raises(InvalidInput, match="is not a dataset"):
        split(tmp_path)


def test_table_that_disagrees_with_its_files_is_refused(tmp_path):
    folder = in_row(tmp_path, 12)
    (folder / "satellite" / "p3.png").unlink()
    before = contents(folder)
    with pytest.raises(InvalidInput, match="p3"):
        split(folder)
    assert contents(folder) == before


def test_folder_at_work_is_left_alone(captured, tmp_path):
    folder = tmp_path / "out"
    shutil.copytree(captured, folder, copy_function=shutil.copyfile)
    with open_locked(folder / "journal.jsonl"), pytest.raises(OutputError, match="another run is at work"):
        split(folder)


@settings(max_examples=examples(12), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(3, 60), st.tuples(*(st.integers(0, 5),) * 3).filter(sum), st.integers(0, 3))
def test_counts_are_the_shares_to_less_than_one_image(tmp_path_factory, count, weights, seed):
    shares = [weight / sum(weights) for weight in weights]
    folder = in_row(tmp_path_factory.mktemp("row"), count)
    made = split(folder, shares, seed=seed, dry_run=True)
    for part, share in zip(PARTS, shares):
        size = made.images[part]
        assert (size > 0) == (share > 0.0)
        # Beyond rounding, only parts that would have none get one, of the largest.
        assert abs(size - share * count) < 1.0 or min(share * count for share in shares if share) < 1.0


def test_command_prints_the_shares_that_are_reached(tmp_path, run):
    folder = in_row(tmp_path, 20)
    before = contents(folder)
    said = run("split", str(folder), "--dry-run")
    assert "train       16 images (80.0 %)" in said.stdout
    assert "dry run: nothing was changed" in said.stdout
    assert contents(folder) == before
    told = run("split", str(folder), "--shares", "0.5", "0.25", "0.25", "--how", "blocks", "--frame", "mercator")
    assert told.returncode == 0
    assert "blocks" in told.stdout
    assert "labels      EPSG:3857" in told.stdout
    assert SPLIT in Table.load(folder / "satellite" / "meta_data.csv").other
    refused = run("split", str(folder), "--shares", "0.5", "0.5", "0.5")
    assert refused.returncode == 2
    assert "shares 0.5, 0.5, 0.5: add up to 1.5; must add up to 1" in refused.stderr


def overlapping(tmp_path, count: int = 60, step_px: int = 5) -> Path:
    """Dataset of windows of 10 px in a row, each with half of the one before."""
    windows = [(100_000_000 + step_px * i, 50_000_000, 10, 10) for i in range(count)]
    return dataset_of(tmp_path / "out", 19, windows)


def test_images_that_overlap_are_split_by_blocks(tmp_path):
    made = split(overlapping(tmp_path))
    assert made.how == "blocks"
    assert made.seen == 0.0


@pytest.mark.parametrize("step_px", [10, 12])
def test_images_side_by_side_are_shuffled(tmp_path, step_px):
    made = split(overlapping(tmp_path, step_px=step_px))
    assert made.how == "shuffled"
    assert made.seen == 0.0


def test_the_share_of_test_images_that_see_training_ground_is_told(tmp_path):
    folder = overlapping(tmp_path)
    made = split(folder, how="shuffled")
    part = [parts_in(folder)[name] for name in sorted(parts_in(folder), key=lambda name: int(name[1:]))]
    beside = [
        any(0 <= at + by < len(part) and part[at + by] == "train" for by in (-1, 1))
        for at, one in enumerate(part)
        if one == "test"
    ]
    assert made.seen == pytest.approx(sum(beside) / len(beside))
    assert made.seen > 0.5


def test_a_gap_asks_for_blocks(tmp_path):
    assert split(in_row(tmp_path, 60), gap_m=1.0).how == "blocks"


def test_the_command_says_what_the_test_sees(tmp_path, run):
    folder = overlapping(tmp_path)
    assert "no test image sees ground of the training part" in run("split", str(folder)).stdout
    shuffled_ = run("split", str(folder), "--how", "shuffled").stdout
    assert "% of the test images see ground of the training part (blocks leave none)" in shuffled_


@pytest.mark.parametrize("at", [0, 1, 2])
def test_a_stopped_split_changes_nothing(captured, tmp_path, at):
    folder = shutil.copytree(captured, tmp_path / "out")
    before, told = contents(folder), []

    def go_on(share):
        told.append(share)
        return len(told) <= at

    with pytest.raises(Cancelled):
        split(folder, progress=go_on)
    assert contents(folder) == before
    assert told == sorted(set(told))
    assert len(told) == at + 1


@pytest.mark.parametrize("dry_run", [True, False])
def test_undoing_brings_back_what_was_there_before(captured, tmp_path, dry_run):
    folder = tmp_path / "out"
    shutil.copytree(captured, folder)
    states = [contents(folder)]
    for seed in (1, 2):
        split(folder, how="shuffled", seed=seed)
        states.append({path: data for path, data in contents(folder).items() if path.name != "earlier_split.json"})
    undone = undo_split(folder, dry_run=dry_run)
    assert undone.changed
    assert sum(undone.parts.values()) == len(parts_in(folder))
    if dry_run:
        assert contents(folder).items() > states[2].items()
        return
    assert contents(folder) == states[1]
    # Of the first split there is no record any more, but there was nothing before it.
    assert undo_split(folder).parts is None
    assert contents(folder) == states[0]
    assert not undo_split(folder).changed
    assert contents(folder) == states[0]


@pytest.mark.parametrize("at", [0, 1])
def test_an_interrupted_split_and_an_interrupted_undoing_can_be_undone(captured, tmp_path, monkeypatch, at):
    folder = tmp_path / "out"
    shutil.copytree(captured, folder)
    split(folder, how="shuffled", seed=1)
    before = {path: data for path, data in contents(folder).items() if path.name != "earlier_split.json"}
    save, saved = Table.save, []

    def interrupted(table, path):
        if len(saved) == at:
            raise KeyboardInterrupt
        saved.append(path)
        save(table, path)

    def stop(run):
        saved.clear()
        monkeypatch.setattr(Table, "save", interrupted)
        with pytest.raises(KeyboardInterrupt):
            run()
        monkeypatch.setattr(Table, "save", save)
        with pytest.raises(InvalidInput, match="split again, or undo the split"):
            Labels.load(folder / LABELS_FILE)

    stop(lambda: split(folder, how="shuffled", seed=2))
    # Interrupted twice, the record stays that of the first split.
    stop(lambda: split(folder, how="shuffled", seed=3))
    stop(lambda: undo_split(folder))
    assert undo_split(folder).changed
    assert contents(folder) == before


def test_a_spoilt_record_of_the_earlier_split_changes_nothing(tmp_path):
    folder = in_row(tmp_path, 9)
    split(folder)
    for text in ("", "{}", '{"labels": 1, "parts": {}}', '{"labels": null, "parts": {"satellite": ["<b>"]}}'):
        (folder / "earlier_split.json").write_text(text, encoding="utf-8")
        before = contents(folder)
        with pytest.raises(InvalidInput, match=r"earlier_split\.json: cannot be read"):
            undo_split(folder)
        assert contents(folder) == before


def test_the_command_undoes_a_split(tmp_path, run):
    in_row(tmp_path, 10)
    assert run("split", "out", "--undo").stdout == "nothing to undo: the dataset is not split\n"
    for seed in ("1", "2"):
        assert run("split", "out", "--how", "shuffled", "--seed", seed).returncode == 0
    undone = run("split", "out", "--undo", "--dry-run").stdout
    assert "the parts and labels before it are back, train 8, validation 1, test 1 images\ndry run" in undone
    assert '"changed": true' in run("split", "out", "--undo", "--json").stdout
    assert run("split", "out", "--undo").stdout == "split undone: images are in no part, and there are no labels\n"
