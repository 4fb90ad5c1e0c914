"""Where a user's configuration is, and files of it that are broken."""

from __future__ import annotations

import json

import pytest
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.storage.config import config_file, default_folder, read_named, write_named


def test_where_the_folder_is(monkeypatch, tmp_path):
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    assert default_folder() == tmp_path / "config"
    monkeypatch.delenv("TERRAINAV_CONFIG_DIR")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "xdg"))
    monkeypatch.setattr("sys.platform", "linux")
    assert default_folder() == tmp_path / "xdg" / "terrainav"
    monkeypatch.setattr("sys.platform", "win32")
    monkeypatch.setenv("APPDATA", str(tmp_path / "roaming"))
    assert default_folder() == tmp_path / "roaming" / "terrainav"
    monkeypatch.setattr("sys.platform", "darwin")
    assert default_folder().parts[-3:] == ("Library", "Application Support", "terrainav")
    assert config_file("things.json", tmp_path) == tmp_path / "things.json"
    assert config_file("things.json") == default_folder() / "things.json"


def test_what_is_written_is_read_and_nothing_stays_beside_it(tmp_path):
    path = tmp_path / "new" / "things.json"
    assert read_named(path, "things") == {}
    write_named(path, {"ü": {"a": 1}})
    assert read_named(path, "things") == {"ü": {"a": 1}}
    assert json.loads(path.read_bytes()) == {"ü": {"a": 1}}
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize(
    ("content", "says"),
    [(b"[]", "object of things"), (b"{", "as JSON"), (b"\xff", "as JSON"), (b"[" * 99_999, "JSON")],
)
def test_a_broken_file_is_named_in_one_line(tmp_path, content, says):
    path = tmp_path / "things.json"
    path.write_bytes(content)
    with pytest.raises(InvalidInput, match=says) as raised:
        read_named(path, "things")
    assert str(path) in str(raised.value)
    assert "\n" not in str(raised.value)
    assert path.read_bytes() == content


def test_a_folder_that_cannot_be_made_is_named_with_the_way_out(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"file.*TERRAINAV_CONFIG_DIR names another folder"):
        write_named(tmp_path / "file" / "things.json", {})
