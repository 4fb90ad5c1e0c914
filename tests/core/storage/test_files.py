from __future__ import annotations

import os
from pathlib import Path

import pytest
from terrainav.core.errors import OutputError
from terrainav.core.storage import files
from terrainav.core.storage.files import make_folder, write_whole


def test_a_file_is_written_and_replaced(tmp_path):
    path = tmp_path / "a.bin"
    write_whole(path, b"one")
    write_whole(path, (block for block in (b"two", b" more")))
    assert path.read_bytes() == b"two more"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.bin"]


def test_a_failed_write_leaves_what_was_there(tmp_path):
    def blocks():
        yield b"half"
        raise RuntimeError("the producer broke")

    path = tmp_path / "a.bin"
    write_whole(path, b"before")
    with pytest.raises(RuntimeError):
        write_whole(path, blocks())
    assert path.read_bytes() == b"before"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.bin"]


def test_a_reader_never_sees_a_half_file(tmp_path, monkeypatch):
    path = tmp_path / "a.bin"
    seen = []

    def replace(partial, target):
        seen.append((path.exists(), Path(partial).parent == tmp_path))
        return real(partial, target)

    real = os.replace
    monkeypatch.setattr(files.os, "replace", replace)
    write_whole(path, b"all")
    assert seen == [(False, True)]


def test_errors_name_the_folder_and_the_reason(tmp_path):
    with pytest.raises(OutputError) as caught:
        write_whole(tmp_path / "no" / "a.bin", b"")
    assert str(caught.value) == f"folder {tmp_path / 'no'}: cannot write a.bin (No such file or directory)"
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError, match="a file is in its place"):
        make_folder(tmp_path / "file")
    with pytest.raises(OutputError, match=r"cannot be made \(Not a directory\)"):
        make_folder(tmp_path / "file" / "below")
    make_folder(tmp_path / "a" / "b")
    make_folder(tmp_path / "a" / "b")
    assert (tmp_path / "a" / "b").is_dir()


@pytest.mark.skipif(os.name == "nt", reason="links are for administrators")
@pytest.mark.parametrize("there", [True, False])
def test_a_link_under_the_temporary_name_is_not_followed(tmp_path, there):
    foreign, path = tmp_path / "foreign", tmp_path / "a.bin"
    if there:
        foreign.write_bytes(b"not ours")
    (tmp_path / "a.bin.part").symlink_to(foreign)
    write_whole(path, b"ours")
    assert (path.read_bytes(), path.is_symlink(), foreign.exists()) == (b"ours", False, there)
    assert not there or foreign.read_bytes() == b"not ours"


def test_what_a_killed_run_left_is_overwritten(tmp_path):
    (tmp_path / "a.bin.part").write_bytes(b"half of what was longer")
    write_whole(tmp_path / "a.bin", b"whole")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a.bin", b"whole")]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
def test_what_is_no_regular_file_is_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("pipe")
    for name in ("pipe", "link"):
        with pytest.raises(OutputError, match="it is not a regular file"):
            write_whole(tmp_path / name, b"x")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["link", "pipe"]
    assert not (tmp_path / "pipe").is_file()


@pytest.mark.skipif(os.name == "nt", reason="Windows has no pipes among its files")
def test_foreign_files_are_regular(tmp_path):
    path = tmp_path / "a.bin"
    path.write_bytes(b"one")
    (tmp_path / "link").symlink_to(path)
    for name in ("a.bin", "link"):
        with files.open_foreign(tmp_path / name) as file:
            assert file.read() == b"one"
    # With a writer that does not come, opening a pipe would wait for good.
    os.mkfifo(tmp_path / "pipe")
    for other in (tmp_path / "pipe", Path(os.devnull), tmp_path):
        with pytest.raises(OSError, match="not a regular file"):
            files.open_foreign(other)
