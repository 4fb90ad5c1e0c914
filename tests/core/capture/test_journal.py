from __future__ import annotations

import json
import os

import pytest
from terrainav.core.capture.images import find_complete
from terrainav.core.capture.journal import Journal, Outcome
from terrainav.core.errors import OutputError
from terrainav.core.limits import MAX_TABLE_BYTES
from terrainav.core.storage.files import open_locked

DONE = Outcome("satellite", "0_0_a", 7.123456789012345)
FAILED = Outcome("roadmap", "0_0_a", reason='404 "nicht da"\r\nü')


def write(path, *outcomes):
    with Journal(path) as journal:
        for outcome in outcomes:
            journal.add(outcome)


def test_outcomes_come_back(tmp_path):
    path = tmp_path / "journal.jsonl"
    write(path, DONE, FAILED)
    assert Journal(path).outcomes == {("satellite", "0_0_a"): DONE, ("roadmap", "0_0_a"): FAILED}
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").split("\n")[:-1]]
    done = {
        "map_type": "satellite",
        "name": "0_0_a",
        "status": "done",
        "entropy": 7.123456789012345,
        "reason": "",
    }
    assert lines[0] == done
    assert (lines[1]["status"], lines[1]["entropy"], lines[1]["reason"]) == ("failed", None, FAILED.reason)


def test_a_missing_journal_is_empty(tmp_path):
    assert Journal(tmp_path / "journal.jsonl").outcomes == {}


def test_the_last_line_about_a_picture_holds(tmp_path):
    path = tmp_path / "journal.jsonl"
    write(path, Outcome("satellite", "a", reason="503"))
    write(path, Outcome("satellite", "a", 1.0))
    assert Journal(path).outcomes == {("satellite", "a"): Outcome("satellite", "a", 1.0)}
    assert len(path.read_bytes().splitlines()) == 2


@pytest.mark.parametrize("kept", range(1, len(DONE.to_line())))
def test_a_torn_line_is_as_if_never_written(tmp_path, kept):
    path = tmp_path / "journal.jsonl"
    path.write_bytes(FAILED.to_line() + DONE.to_line()[:kept])
    assert list(Journal(path).outcomes.values()) == [FAILED]
    write(path, DONE)
    assert path.read_bytes() == FAILED.to_line() + DONE.to_line()


NUMBER = DONE.to_line().rstrip().replace(b"7.123456789012345", b"%s")


@pytest.mark.parametrize(
    "rubbish",
    [
        b"\x00" * 40,
        b"[]",
        b'{"status": "done"}',
        b"\xff\xfe",
        b"a\rb",
        b"[" * 100_000,
        b"x" * (3 << 20),
        NUMBER % (b"9" * 400),
        NUMBER % b"1e999",
        DONE.to_line().rstrip()[:-1] + b', "size_bytes": 1e999}',
        DONE.to_line().rstrip()[:-1] + b', "size_bytes": Infinity}',
        DONE.to_line().rstrip()[:-1] + b', "sky_share": ' + b"9" * 400 + b"}",
        NUMBER % b'"nan"',
        DONE.to_line().rstrip()[:-1] + b', "unmapped_share": "nan"}',
        DONE.to_line().rstrip()[:-1] + b', "repeated": 5}',
        DONE.to_line().replace(b"0_0_a", b"\\ud800").rstrip(),
    ],
    ids=range(16),
)
def test_rubbish_between_lines_is_passed_over(tmp_path, rubbish):
    path = tmp_path / "journal.jsonl"
    lines = rubbish + b"\n" + DONE.to_line() + rubbish + b"\n"
    path.write_bytes(lines + b"torn\r")
    assert list(Journal(path).outcomes.values()) == [DONE]
    write(path, FAILED)
    assert path.read_bytes() == lines + FAILED.to_line()


def test_the_length_of_a_picture_is_noted_where_it_is_known(tmp_path):
    path = tmp_path / "journal.jsonl"
    sized = Outcome("satellite", "b", 1.0, size_bytes=12_345)
    write(path, DONE, sized)
    assert Journal(path).outcomes == {("satellite", DONE.name): DONE, ("satellite", "b"): sized}
    old, new = path.read_bytes().splitlines()
    # Lines of journals that know of no lengths are read as ever.
    assert b"size_bytes" not in old
    assert json.loads(new)["size_bytes"] == 12_345
    assert Outcome.from_line(new.replace(b"12345", b'"x"')) is None


@pytest.mark.parametrize(
    ("size_bytes", "lengths", "whole"),
    [
        (0, {".jgw": 1, ".jpg": 2}, True),
        (3, {".jgw": 1, ".jpg": 2}, True),
        (3, {".jgw": 1, ".jpg": 1}, False),
        (3, {".jgw": 1, ".jpg": 3}, False),
        (3, {".jgw": 0, ".jpg": 3}, False),
        (0, {".jgw": 0, ".jpg": 3}, False),
        (3, {".jpg": 3}, False),
    ],
)
def test_pictures_are_complete_where_their_files_are_as_long_as_noted(tmp_path, size_bytes, lengths, whole):
    for ending, length in lengths.items():
        (tmp_path / f"a{ending}").write_bytes(b"x" * length)
    outcome = Outcome("satellite", "a", 1.0, size_bytes=size_bytes)
    assert find_complete(tmp_path, (".jgw", ".jpg"), {"a": outcome}) == ({"a"} if whole else set())


def test_every_line_is_there_at_once(tmp_path):
    path = tmp_path / "journal.jsonl"
    with Journal(path) as journal:
        journal.add(DONE)
        assert path.read_bytes() == DONE.to_line()


class FullDisk:
    """File that takes a few bytes of a line, as a disk does that is about to be full."""

    def __init__(self, file):
        self.file = file

    def write(self, line):
        return self.file.write(line[:5])

    def truncate(self, size):
        return self.file.truncate(size)

    def fileno(self):
        return self.file.fileno()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()


def test_a_full_disk_leaves_whole_lines(tmp_path, monkeypatch):
    path = tmp_path / "journal.jsonl"
    with Journal(path) as journal:
        journal.add(DONE)
        monkeypatch.setattr(journal, "_file", FullDisk(journal._file))
        with pytest.raises(OutputError, match=r"cannot write journal.jsonl \(the disk took only a part"):
            journal.add(FAILED)
    assert path.read_bytes() == DONE.to_line()


def test_a_journal_that_cannot_be_opened_is_named(tmp_path):
    (tmp_path / "journal.jsonl").mkdir()
    with pytest.raises(OutputError, match=r"journal\.jsonl: cannot be read"):
        Journal(tmp_path / "journal.jsonl")
    with (
        pytest.raises(OutputError, match=r"nowhere: cannot write j \(No such file"),
        Journal(tmp_path / "nowhere" / "j"),
    ):
        pass
    with pytest.raises(OutputError, match="is not open"):
        Journal(tmp_path / "other.jsonl").add(DONE)


@pytest.mark.skipif(os.name == "nt", reason="files have no holes")
def test_a_journal_beyond_the_limit_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "journal.jsonl"
    path.touch()
    os.truncate(path, MAX_TABLE_BYTES + 1)
    with pytest.raises(OutputError, match=r"journal\.jsonl: cannot be read \(larger than 17,180 MB\)"):
        Journal(path)


@pytest.mark.skipif(os.name == "nt", reason="links are for administrators")
def test_a_journal_that_is_a_link_or_a_pipe_is_left_alone(tmp_path):
    foreign, path = tmp_path / "foreign", tmp_path / "journal.jsonl"
    foreign.write_bytes(b"not ours")
    path.symlink_to(foreign)
    with pytest.raises(OutputError, match="it is a link to another place"):
        Journal(path)
    with pytest.raises(OutputError, match="it is a link to another place"):
        open_locked(path)
    assert foreign.read_bytes() == b"not ours"
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(OutputError, match="it is not a regular file"):
        Journal(path)
    with pytest.raises(OutputError, match="cannot write journal"):
        open_locked(path)
