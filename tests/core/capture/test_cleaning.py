"""Datasets that are cleaned: what is marked and moved, taken back, captured again, and refused."""

from __future__ import annotations

import json
import os
import shutil

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.dataset import dataset as images
from terrainav.core.dataset.clean import clean, undo
from terrainav.core.dataset.entropy import entropy
from terrainav.core.dataset.table import REJECTED, Table
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.storage.files import open_locked

from tests.support.command import command
from tests.support.sources import PatternSource, missing
from tests.support.thinning import sampled

AREA = Box(35.16, -89.90, 35.1555, -89.8945)
#: Between the entropies of the two kinds of tiles.
THRESHOLD = 3.0


class HalfBlank(PatternSource):
    """Roadmap tiles in the west have nothing to see; satellite tiles are all alike in what there is to see."""

    def __init__(self, middle_px, broken=()):
        super().__init__(("satellite", "roadmap"))
        self._middle_px, self._broken = middle_px, broken

    def paint(self, map_type, part):
        if map_type in self._broken:
            raise missing()
        pixels = super().paint(map_type, part)
        if map_type == "roadmap":
            columns = part.left_px + np.arange(part.width_px)
            pixels[:, columns < self._middle_px] = 200
        return pixels


def mission_of(image_format="jpg", map_types=("satellite", "roadmap")):
    return Mission(AREA, 120.0, image_format=image_format, map_types=map_types)


def source_of(worked_out, **options):
    left = np.asarray(worked_out.windows.left_px, np.float64)
    return HalfBlank(float(np.median(left + worked_out.windows.width_px)), **options)


@pytest.fixture(scope="module")
def captures(tmp_path_factory):
    """Folders and plans of captures of both map types, by their images' format; not to be changed."""
    made = {}
    for image_format in ("jpg", "tif"):
        folder = tmp_path_factory.mktemp("captured") / "out"
        worked_out = plan(mission_of(image_format), PatternSource().grid)
        capture(worked_out, source_of(worked_out), folder)
        made[image_format] = folder, worked_out
    return made


@pytest.fixture(params=["jpg", "tif"])
def dataset(request, captures, tmp_path):
    """Folder, plan and source of a capture of both map types."""
    folder, worked_out = captures[request.param]
    shutil.copytree(folder, tmp_path / "out", copy_function=shutil.copyfile)
    return tmp_path / "out", worked_out, source_of(worked_out)


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def table_of(folder, map_type):
    return Table.load(folder / map_type / "meta_data.csv")


def rejected_names(folder, map_type):
    table = table_of(folder, map_type)
    return {name for name, why in zip(table.img_names, table.other[REJECTED]) if why}


def low(folder, map_type):
    """Images of a map type below the threshold, worked out from their own pixels."""
    found = set()
    for path in folder.glob(f"{map_type}/*_*_*.*"):
        if path.suffix in (".tif", ".png"):
            found |= {path.name} if entropy(np.asarray(Image.open(path))[..., :3]) < THRESHOLD else set()
    return found


def test_the_roadmap_decides_for_all_and_only_marks(dataset):
    folder, worked_out, _ = dataset
    before = files(folder)
    results = {one.map_type: one for one in clean(folder, THRESHOLD)}
    roadmap = table_of(folder, "roadmap")
    expected = {name for name, bits in zip(roadmap.img_names, roadmap.entropies) if bits < THRESHOLD}
    if worked_out.mission.output.image_format == "tif":
        assert expected == low(folder, "roadmap")
        assert low(folder, "satellite") == set()
    assert 0 < len(expected) < len(worked_out)
    assert rejected_names(folder, "roadmap") == rejected_names(folder, "satellite") == expected
    assert results["satellite"].rejected == results["roadmap"].rejected == len(expected)
    assert (results["satellite"].by_roadmap, results["roadmap"].by_roadmap) == (len(worked_out), 0)
    assert results["satellite"].suggested == results["roadmap"].suggested
    reasons = set(table_of(folder, "satellite").other[REJECTED]) - {""}
    assert all(reason.startswith("roadmap entropy ") and reason.endswith(" below 3") for reason in reasons)
    # Nothing else has changed.
    after = files(folder)
    assert {name for name in before if before[name] != after[name]} == {
        "satellite/meta_data.csv",
        "roadmap/meta_data.csv",
    }
    assert set(after) == set(before)


def test_without_roadmap_the_image_decides(tmp_path):
    worked_out = plan(mission_of("tif", ("satellite",)), PatternSource().grid)
    capture(worked_out, source_of(worked_out), tmp_path)
    values = table_of(tmp_path, "satellite").entropies
    middle = float(np.median(values))
    (result,) = clean(tmp_path, middle)
    assert result.rejected == (values < middle).sum()
    assert result.by_roadmap == 0


def test_where_the_roadmap_could_not_be_made_the_image_decides(tmp_path):
    worked_out = plan(mission_of("tif"), PatternSource().grid)
    capture(worked_out, source_of(worked_out, broken=("roadmap",)), tmp_path)
    satellite, roadmap = sorted(clean(tmp_path, 8.0), key=lambda one: one.map_type != "satellite")
    assert (satellite.rejected, satellite.by_roadmap, satellite.failed) == (len(worked_out), 0, 0)
    assert (roadmap.images, roadmap.rejected, roadmap.failed) == (0, 0, len(worked_out))
    assert set(table_of(tmp_path, "roadmap").status) == {"failed"}


def test_moved_files_take_what_belongs_to_them_along_and_all_comes_back(dataset):
    folder, _, _ = dataset
    before = files(folder)
    # What QGIS writes beside an image goes with it.
    name = min(low(folder, "roadmap"), default=None)
    if name:
        (folder / "satellite" / f"{name}.aux.xml").write_text("<PAMDataset/>")
        before = files(folder)
    results = clean(folder, THRESHOLD, move=True)
    for one in results:
        moved = rejected_names(folder, one.map_type)
        assert one.moved == len(moved) > 0
        stems = {image.rpartition(".")[0] for image in moved}
        for place, wanted in ((folder / one.map_type, False), (folder / one.map_type / "rejected", True)):
            lying = [path.name for path in place.iterdir() if path.is_file() and path.name != "meta_data.csv"]
            assert lying
            assert all(any(lie.startswith(f"{stem}.") for stem in stems) == wanted for lie in lying)
    moved_files = {name.replace("rejected/", ""): data for name, data in files(folder).items()}
    assert set(moved_files) == set(before)
    # Again changes nothing; a lower threshold brings all back, and undo leaves the very bytes.
    state = files(folder)
    assert [one.moved for one in clean(folder, THRESHOLD, move=True)] == [0, 0]
    assert files(folder) == state
    assert [one.returned for one in clean(folder, 0.0)] == [one.moved for one in results]
    assert not list(folder.rglob("rejected"))
    clean(folder, THRESHOLD, move=True)
    undone = undo(folder)
    assert [(one.rejected, one.returned) for one in undone] == [(one.rejected, one.moved) for one in results]
    assert files(folder) == before
    assert not list(folder.rglob("rejected"))


def test_a_dry_run_counts_and_changes_nothing(dataset):
    folder, _, _ = dataset
    before = files(folder)
    dry = clean(folder, THRESHOLD, move=True, dry_run=True)
    assert files(folder) == before
    assert clean(folder, THRESHOLD, move=True) == dry
    state = files(folder)
    dry = undo(folder, dry_run=True)
    assert files(folder) == state
    assert undo(folder) == dry
    assert [(one.rejected, one.returned) for one in undo(folder)] == [(0, 0), (0, 0)]
    assert files(folder) == before


def test_a_later_capture_knows_what_was_moved_and_keeps_the_marks(dataset):
    folder, worked_out, source = dataset
    clean(folder, THRESHOLD, move=True)
    lost = next(path for path in (folder / "satellite").iterdir() if path.suffix in (".jpg", ".tif"))
    lost_stem = lost.name.rpartition(".")[0]
    whole, state = lost.read_bytes(), files(folder)
    lost.unlink()
    source.fetched.clear()
    again = capture(worked_out, source, folder, resume=True)
    assert (again.written, again.failed) == (1, ())
    assert lost.read_bytes() == whole
    state.pop("journal.jsonl")
    after = files(folder)
    after.pop("journal.jsonl")
    assert after == state
    assert {map_type for map_type, _ in source.fetched} == {"satellite"}
    assert lost_stem in worked_out.names
    undo(folder)
    assert capture(worked_out, source, folder, resume=True).skipped == again.total


@pytest.mark.parametrize("after", sampled([0, 1, 3, 5], 3))
@pytest.mark.parametrize("back", [False, True])
def test_what_was_interrupted_can_be_finished_or_taken_back(dataset, monkeypatch, tmp_path, after, back):
    folder, worked_out, source = dataset
    before = files(folder)
    clean(folder, THRESHOLD, move=True)
    wanted = files(folder)
    if not back:
        undo(folder)
    real, moves = images.Move.carry_out, []

    def carry_out(move):
        if len(moves) == after:
            raise KeyboardInterrupt
        moves.append(move)
        real(move)

    monkeypatch.setattr(images.Move, "carry_out", carry_out)
    with pytest.raises(KeyboardInterrupt):
        undo(folder) if back else clean(folder, THRESHOLD, move=True)
    monkeypatch.undo()
    # No picture is lost for a capture, whatever was on its way.
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    assert capture(worked_out, source, copy, resume=True).written == 0
    clean(copy, THRESHOLD, move=True)
    finished = files(copy)
    assert {name for name in finished if finished[name] != wanted.get(name)} <= {"journal.jsonl"}
    assert set(finished) == set(wanted)
    undo(folder)
    assert files(folder) == before


def test_progress_can_stop_it(dataset):
    folder, _, _ = dataset
    before = files(folder)
    shares = []

    def stop(share):
        shares.append(share)
        return len(shares) < 4

    with pytest.raises(Cancelled, match="undo"):
        clean(folder, THRESHOLD, move=True, progress=stop)
    assert shares == sorted(shares)
    assert set(files(folder)) != set(before)
    undo(folder)
    assert files(folder) == before


def test_columns_of_others_stay(dataset):
    folder, worked_out, source = dataset
    path = folder / "satellite" / "meta_data.csv"
    table = Table.load(path)
    table.replace_other({"split": ("train",) * len(table)}).save(path)
    clean(folder, THRESHOLD)
    assert list(Table.load(path).other) == ["split", REJECTED]
    capture(worked_out, source, folder, resume=True)
    assert list(Table.load(path).other) == ["split", REJECTED]
    undo(folder)
    assert list(Table.load(path).other) == ["split"]


def test_a_published_folder_is_cleaned_as_it_is(tmp_path):
    folder = tmp_path / "Memphis"
    folder.mkdir()
    rows = [",img_names,columns,row,Lat,Lon,Alt,entropies"]
    for index in range(4):
        name = f"{index}_0_35.1_-89.{index}_17.jpg"
        grey = np.full((32, 32), 128, np.uint8)
        grey[:, : 8 * index] = np.arange(8 * index, dtype=np.uint8) * 4
        Image.fromarray(grey).save(folder / name, quality=95)
        # The last one has no entropy in the table: it is worked out from the image.
        bits = "" if index == 3 else repr(entropy(grey))
        rows.append(f"{index},{name},{index},0,35.1,-89.{index},17,{bits}")
    (folder / "meta_data.csv").write_text("\n".join(rows) + "\n")
    (result,) = clean(folder, 2.1, move=True)
    assert (result.map_type, result.images, result.rejected, result.moved) == ("Memphis", 4, 2, 2)
    assert {path.name for path in (folder / "rejected").iterdir()} == {
        "0_0_35.1_-89.0_17.jpg",
        "1_0_35.1_-89.1_17.jpg",
    }
    undo(folder)
    assert not (folder / "rejected").exists()


# --- what is refused


def lose(folder):
    next((folder / "satellite").glob("*_*_*.tif")).unlink()


def add(folder):
    (folder / "roadmap" / "9_9_35.1_-89.9_18.tif").write_bytes(b"")


def double(folder):
    picture = next((folder / "satellite").glob("*_*_*.tif"))
    (folder / "satellite" / "rejected").mkdir()
    shutil.copy(picture, folder / "satellite" / "rejected")


def damage(folder):
    path = folder / "roadmap" / "meta_data.csv"
    path.write_text(path.read_text().replace(",19,", ",nineteen,", 1))


def repeat(folder):
    path = folder / "roadmap" / "meta_data.csv"
    text = path.read_text()
    path.write_text(text + text.splitlines()[1] + "\n")


def lead_away(folder):
    path = folder / "roadmap" / "meta_data.csv"
    path.write_text(path.read_text().replace("\n", "\n../", 1))


def column_twice(folder):
    path = folder / "roadmap" / "meta_data.csv"
    headers, *rows = path.read_text().splitlines()
    path.write_text("\n".join([f"{headers},split,split", *(f"{row},train,test" for row in rows)]) + "\n")


def file_in_the_way(folder):
    (folder / "roadmap" / "rejected").write_text("what somebody noted")


def folder_in_the_way(folder):
    picture = next((folder / "satellite").glob("*_*_*.tif"))
    (folder / "satellite" / "rejected" / picture.name).mkdir(parents=True)


def unreadable(folder):
    path = folder / "satellite" / "meta_data.csv"
    table = Table.load(path)
    table.entropies[2] = np.nan
    table.save(path)
    (folder / "satellite" / table.img_names[2]).write_bytes(b"no image")


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lose, r"of the table is not there; put it back"),
        (add, r"9_9_35\.1_-89\.9_18\.tif is not in the table; finish the capture"),
        (double, r"in rejected as well"),
        (column_twice, r"has column split more than once; rename or remove all but one"),
        (file_in_the_way, r"rejected in it is not a folder, so images cannot be moved to it; move it away"),
        (folder_in_the_way, r"in rejected as well"),
        (damage, r"line 2 has Alt 'nineteen', not a number"),
        (repeat, r"in more than one row"),
        (lead_away, r"'\.\./.*' in the table is not a file name"),
        (unreadable, r"image .*: cannot be read"),
    ],
)
def test_bad_input_gives_one_line_and_changes_nothing(captures, tmp_path, spoil, words):
    shutil.copytree(captures["tif"][0], tmp_path / "out", copy_function=shutil.copyfile)
    spoil(tmp_path / "out")
    before = files(tmp_path / "out")
    with pytest.raises(InvalidInput, match=words) as refused:
        clean(tmp_path / "out", THRESHOLD, move=True)
    assert "\n" not in str(refused.value)
    assert files(tmp_path / "out") == before


def test_what_is_no_dataset_is_refused(tmp_path, dataset):
    folder, _, _ = dataset
    with pytest.raises(InvalidInput, match="is not a dataset"):
        clean(tmp_path)
    with pytest.raises(InvalidInput, match="cannot be read"):
        clean(tmp_path / "nowhere")
    with pytest.raises(InvalidInput, match="is one map type of the dataset"):
        clean(folder / "satellite")
    for threshold in (-0.1, 8.1, float("nan")):
        with pytest.raises(InvalidInput, match="must be from 0 to 8 bits"):
            clean(folder, threshold)


def test_no_capture_runs_meanwhile(dataset):
    folder, _, _ = dataset
    with open_locked(folder / "journal.jsonl"), pytest.raises(OutputError, match="another run is at work"):
        clean(folder)


def test_a_capture_does_not_write_over_a_table_that_it_cannot_read(dataset):
    folder, worked_out, source = dataset
    clean(folder, THRESHOLD)
    path = folder / "satellite" / "meta_data.csv"
    path.write_text(path.read_text().replace(",19,", ",nineteen,", 1))
    before = path.read_bytes()
    with pytest.raises(OutputError, match="repair the table, or remove it"):
        capture(worked_out, source, folder, resume=True)
    assert path.read_bytes() == before


@pytest.mark.skipif(os.name == "nt", reason="Windows opens no folder")
def test_a_table_that_is_no_file_is_named(dataset):
    folder, worked_out, source = dataset
    path = folder / "satellite" / "meta_data.csv"
    path.unlink()
    path.mkdir()
    with pytest.raises(OutputError, match=r"table .*meta_data\.csv: cannot be read \(it is not a regular file\)"):
        capture(worked_out, source, folder, resume=True)


# --- the command


def test_the_command(dataset, tmp_path, monkeypatch, capsys):
    folder, worked_out, _ = dataset
    before = files(folder)
    run = command(tmp_path, monkeypatch, capsys)
    dry = run("clean", str(folder), "--entropy", "3", "--move", "--dry-run")
    assert dry.returncode == 0
    assert "dry run: nothing was changed" in dry.stdout
    assert files(folder) == before
    done = run("clean", str(folder), "--entropy", "3", "--move")
    assert done.stdout.splitlines() == dry.stdout.splitlines()[:-1]
    satellite = next(line for line in done.stdout.splitlines() if line.startswith("satellite"))
    assert f"{len(worked_out)} images" in satellite
    assert "of the roadmap" in satellite
    assert "Otsu" in satellite
    figures = json.loads(run("clean", str(folder), "--entropy", "3", "--json").stdout)
    assert {one["map_type"] for one in figures} == {"satellite", "roadmap"}
    undone = run("clean", str(folder), "--undo")
    assert "moved back" in undone.stdout
    assert files(folder) == before
    assert "nothing to undo" in run("clean", str(folder), "--undo").stdout
    wrong = run("clean", str(tmp_path))
    assert wrong.returncode == 2
    assert wrong.stderr.startswith("terrainav: folder ")
    assert len(wrong.stderr.splitlines()) == 1


def with_entropies(folder, of):
    """A dataset of somebody's, whose table of the satellite images has other entropies."""
    shutil.rmtree(folder / "roadmap")
    (folder / "mission.json").unlink()
    path = folder / "satellite" / "meta_data.csv"
    table = Table.load(path)
    values = [of(np.asarray(Image.open(folder / "satellite" / name).convert("RGB"))) for name in table.img_names]
    Table(**{**vars(table), "entropies": np.array(values)}).save(path)


@pytest.mark.parametrize(
    ("of", "measure", "said"),
    [
        (entropy, "grey", "of grey levels (the paper's equation 10)"),
        (
            lambda image: entropy(image.reshape(image.shape[0], -1)),
            "pooled",
            "of red, green and blue in one histogram",
        ),
        (lambda image: entropy(image) / 2.0 + 0.9, "unknown", "by a measure of the table's own"),
    ],
)
def test_which_entropies_a_table_holds_is_told(dataset, tmp_path, monkeypatch, capsys, of, measure, said):
    folder, _, _ = dataset
    with_entropies(folder, of)
    (cleaned,) = clean(folder, 1.0, dry_run=True)
    assert cleaned.measure == measure
    found = command(tmp_path, monkeypatch, capsys)("clean", str(folder), "--entropy", "1", "--dry-run")
    assert said in found.stdout


def test_a_capture_holds_those_of_grey_levels_whatever_its_jpegs_have_lost(dataset):
    folder, _, _ = dataset
    for path in folder.glob("*/meta_data.csv"):
        table = Table.load(path)
        Table(**{**vars(table), "entropies": table.entropies - 0.5}).save(path)
    assert {one.measure for one in clean(folder, 1.0, dry_run=True)} == {"grey"}


@pytest.mark.parametrize(("threshold", "said"), [(0.0, "rejects nothing"), (8.0, "rejects nearly all")])
def test_a_threshold_that_tells_nothing_apart_is_warned_of(dataset, tmp_path, monkeypatch, capsys, threshold, said):
    folder, _, _ = dataset
    found = command(tmp_path, monkeypatch, capsys)("clean", str(folder), "--entropy", str(threshold), "--dry-run")
    assert found.returncode == 0
    assert f"warning: satellite: the threshold {said}" in found.stderr
    quiet = command(tmp_path, monkeypatch, capsys)("clean", str(folder), "--entropy", str(THRESHOLD), "--dry-run")
    assert "warning" not in quiet.stderr
