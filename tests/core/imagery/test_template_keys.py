"""A key goes to the hosts that the user has named: not to those that a file or another server names."""

from __future__ import annotations

import json

import pytest
from terrainav.core.cli import main
from terrainav.core.cli.exits import DONE, FAILED
from terrainav.core.errors import InvalidInput, SourceError
from terrainav.core.imagery.catalogue import add, described
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.tiles import Template
from terrainav.core.mission.settings import build_mission, resolve

from tests.support.tileserver import TileServer

KEY = "s3cret-of-the-user"
COORDS = "35.16_-89.90_35.1597_-89.8997_120"


@pytest.fixture(autouse=True)
def _a_key(monkeypatch, tmp_path):
    for name in ("TERRAINAV_KEY_HOSTS", "TERRAINAV_SOURCE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERRAINAV_KEY", KEY)
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    monkeypatch.setenv("TERRAINAV_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


def template_of(server):
    return server.url_template + "?token={key}"


def mission_file(folder, source):
    path = folder / "mission.json"
    build_mission(resolve({"coords": COORDS, "source": source, "zoom": 17}, {})).save(path)
    return path


def run(capsys, *argv):
    code = main([str(one) for one in argv])
    return code, capsys.readouterr().err


def test_a_shared_mission_does_not_get_the_key(server, tmp_path, capsys):
    path = mission_file(tmp_path, template_of(server))
    code, said = run(capsys, "capture", path, "--data-dir", tmp_path / "out")
    assert code == FAILED
    assert said.count("\n") == 1
    assert "127.0.0.1: TERRAINAV_KEY is not sent there" in said
    assert "set TERRAINAV_KEY_HOSTS=127.0.0.1" in said
    assert not server.requests


def test_a_host_that_the_user_names_gets_it(server, tmp_path, capsys, monkeypatch):
    path = mission_file(tmp_path, template_of(server))
    monkeypatch.setenv("TERRAINAV_KEY_HOSTS", "tiles.example, 127.0.0.1")
    assert run(capsys, "capture", path, "--data-dir", tmp_path / "out")[0] == DONE
    assert all(f"token={KEY}" in asked for asked in server.requests)
    assert server.requests
    # And the plan alone, which sends nothing, needs no naming.
    monkeypatch.delenv("TERRAINAV_KEY_HOSTS")
    assert run(capsys, "plan", path)[0] == DONE


@pytest.mark.parametrize("way", ["option", "environment", "config"])
def test_naming_the_source_is_naming_its_host_unless_a_file_does(server, tmp_path, capsys, monkeypatch, way):
    argv = ["capture", "--coords", COORDS, "--zoom", "17", "--data-dir", tmp_path / "out"]
    if way == "option":
        argv += ["--source", template_of(server)]
    elif way == "environment":
        monkeypatch.setenv("TERRAINAV_SOURCE", template_of(server))
    else:
        # As it may lie in a folder that was downloaded.
        (tmp_path / "config.json").write_text(json.dumps({"source": template_of(server)}))
    code, said = run(capsys, *argv)
    assert code == (FAILED if way == "config" else DONE)
    assert bool(server.requests) == (way != "config")
    assert ("TERRAINAV_KEY is not sent there" in said) == (way == "config")


def test_an_own_source_is_named_by_adding_it(server, tmp_path, capsys):
    add("mine", described(template_of(server)))
    path = mission_file(tmp_path, "mine")
    assert run(capsys, "capture", path, "--data-dir", tmp_path / "out")[0] == DONE
    assert server.requests


@pytest.mark.parametrize("kind", ["wmts", "wms"])
def test_a_service_of_a_file_does_not_get_the_key(server, kind):
    with pytest.raises(SourceError, match="TERRAINAV_KEY is not sent there"):
        open_source(f"{kind}:{server.url}/caps?apikey={{key}}#layers=a".replace("#layers=a", ""))
    assert not server.requests


@pytest.mark.parametrize(
    ("hosts", "host", "goes"),
    [
        ("tiles.example", "tiles.example", True),
        ("tiles.example", "a.tiles.example", True),
        ("Tiles.Example.", "tiles.example", True),
        ("tiles.example", "eviltiles.example", False),
        ("tiles.example", "tiles.example.evil.example", False),
        ("", "tiles.example", False),
        (",", "tiles.example", False),
        (". ,", "tiles.example", False),
        ("example", "", False),
    ],
)
def test_hosts_that_are_named(monkeypatch, hosts, host, goes):
    from terrainav.core.imagery.tiles import environment_key

    monkeypatch.setenv("TERRAINAV_KEY_HOSTS", hosts)
    if goes:
        assert environment_key([host], named_by_user=False) == KEY
    else:
        with pytest.raises(SourceError):
            environment_key([host], named_by_user=False)


@pytest.mark.parametrize("mark", ["{date}", "{map_type}", "{r}", "{key}", "{z}", "{q}"])
def test_the_host_that_gets_a_key_is_written_out(mark):
    """A date of `evil.example/` would make another host of it, and {r} a user name of what stands before."""
    with pytest.raises(InvalidInput, match="in its host; a key goes to a host that is written out"):
        Template(f"https://{mark}.tiles.example/{{z}}/{{x}}/{{y}}?k={{key}}")
    Template("https://{s}.tiles.example/{z}/{x}/{y}?k={key}")


def test_a_redirect_does_not_carry_the_key(server):
    """Its target is what the server says, and nothing of the address that was asked."""
    from terrainav.core.imagery.http.client import Client
    from terrainav.core.imagery.http.requests_transport import RequestsTransport

    from tests.support.services import ServiceServer

    with ServiceServer() as other:
        other.answer = lambda *_: (200, "text/plain", b"here")

        class Redirecting(ServiceServer):
            """A server that points to the other one."""

        with Redirecting() as first:
            first.answer = lambda *_: (302, "text/plain", b"")
            handler = first._http.RequestHandlerClass

            class Pointing(handler):
                def end_headers(self):
                    self.send_header("Location", other.url + "/elsewhere")
                    super().end_headers()

            first._http.RequestHandlerClass = Pointing
            client = Client(RequestsTransport(1), "first")
            assert client.get(f"{first.url}/tile?token={KEY}", "tile").body == b"here"
            client.close()
        assert other.asked == ["/elsewhere"]


def test_the_library_takes_a_key_that_it_is_given(server):
    source = open_source(template_of(server), key="given")
    source.fetch("", Window(1, 0, 0, 256, 256))
    assert list(server.requests) == ["/1/0/0.png?token=given"]
    source.close()
