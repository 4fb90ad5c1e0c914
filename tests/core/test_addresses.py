"""Keys, passwords and signatures in addresses: refused wherever an address is taken, and shown nowhere."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from terrainav.core.addresses import without_credentials
from terrainav.core.capture.blocks.engines import open_engine
from terrainav.core.cli import main
from terrainav.core.cli.exits import BAD_INPUT, FAILED, FAULT
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.folder import map_type_folders
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput, Message, OutputError, TerrAInavError
from terrainav.core.exports.kinds import export_as
from terrainav.core.mission.export.writing import write_plan
from terrainav.core.storage.files import read_limited
from terrainav.core.storage.stores import check_no_credentials, store_errors, store_path

from tests.support.growth import PROPORTIONAL, growth
from tests.support.thinning import sampled

SECRET = "SENTINEL0nobody0may0see"
COORDS = "35.16_-89.90_35.1597_-89.8997_120"
#: Every way that a store's address may hold one.
STORES = [
    f"s3://KEY:{SECRET}@data/run",
    f"S3://KEY:{SECRET}@data/run",
    f"s3://KEY:with/slash+{SECRET}@data/run",
    f"s3://KEY%3A{SECRET}%40data/run",
    f"s3://KEY%253A{SECRET}%2540data/run",
    f"s3://{SECRET}@data/run",
    f"s3://KEY:{SECRET}/run",
    f"s3a://KEY:{SECRET}@data/run",
    f"s3://data/run?key={SECRET}",
    f"s3://data/run?X-Amz-Expires=9&X-Amz-Signature={SECRET}",
    f"s3://data/run?aws_secret_access_key={SECRET}",
    f"s3://data/run#Token={SECRET}",
    f"gs://data/run?access_token={SECRET}",
    f"gcs://u:{SECRET}@data/run",
    f"az://data/run?sv=2024&SIG={SECRET}",
    f"az://data/run;AccountKey={SECRET}",
    f"az://data/run?AccountName=a;AccountKey={SECRET}",
    f"abfs://data@account.dfs.core.windows.net/run?sig={SECRET}",
    f"abfss://data:{SECRET}@account.dfs.core.windows.net/run",
    f"https://u:{SECRET}@host.example/run",
    f"HTTPS://host.example/run?to%6ben={SECRET}",
    f"http://host.example:8080/run?api_key={SECRET}",
    f"sftp://u:{SECRET}@host.example/run",
    f"ftp://u:{SECRET}@host.example/run",
    f"memory://u:{SECRET}@data/run",
    f"unknown://u:{SECRET}@data/run",
]
CLUSTERS = [
    f"dask://u:{SECRET}@127.0.0.1:9",
    f"DASK://{SECRET}@127.0.0.1:9",
    f"tcp://u:{SECRET}@127.0.0.1:9",
    f"tls://127.0.0.1:9?token={SECRET}",
    f"dask://u%3A{SECRET}%40127.0.0.1:9",
]
#: Addresses that hold none.
PLAIN = [
    "s3://data/run",
    "s3://data/a@b/c=d",
    "s3://data/key=5/x",
    "s3://data/run?versionId=3",
    "s3://arn:aws:s3:us-west-2:123456789012:accesspoint/mine/run",
    "gs://data/run at 5:30",
    "az://data/run",
    "abfs://data@account.dfs.core.windows.net/run",
    "sftp://user@host.example/run",
    "http://host.example:8080/run/a@b",
    "http://[::1]:8080/run",
    "memory://data/run",
    "dask://127.0.0.1:8786",
    "C:\\data\\a@b",
    "C:/u:x@y",
    "/data/u:x@y?key=5",
    "data?token=5",
]
FOLDERS = {
    "store_path": store_path,
    "of a path": lambda text: store_path(Path(text)),
    "read_dataset": read_dataset,
    "map_type_folders": map_type_folders,
    "Table.load": Table.load,
    "read_limited": lambda text: read_limited(text, 9),
    "export_as": lambda text: export_as(text, None, "stac"),
    "write_plan": lambda text: write_plan(None, f"{text}.csv"),
}


def shown(wrong: BaseException) -> str:
    """Everything that an error, and what it was raised from, may show."""
    each, found = wrong, []
    while each is not None:
        found += [str(each), repr(each), repr(each.args)]
        if isinstance(each, TerrAInavError):
            found += [repr(each.message.values), each.message.template]
        each = each.__cause__ or (None if each.__suppress_context__ else each.__context__)
    return "".join(found)


@pytest.mark.parametrize("text", STORES)
@pytest.mark.parametrize("door", FOLDERS)
def test_every_door_of_a_store_refuses_credentials_and_does_not_repeat_them(door, text):
    with pytest.raises(InvalidInput, match="no user name, password, key or signature may stand in it") as wrong:
        FOLDERS[door](text)
    assert SECRET not in shown(wrong.value)
    assert "\n" not in str(wrong.value)


@pytest.mark.parametrize("text", CLUSTERS)
def test_a_cluster_with_credentials_is_refused_and_not_repeated(text):
    with pytest.raises(InvalidInput, match="from Dask's own configuration") as wrong, open_engine(text):
        pass
    assert SECRET not in shown(wrong.value)
    assert wrong.value.field == "cluster"


@pytest.mark.parametrize("text", PLAIN)
def test_addresses_without_credentials_are_taken(text):
    check_no_credentials(text, "address", "leave them out")
    assert without_credentials(text) == text or "token" in text or "key=5" in text


@pytest.mark.parametrize("text", [*STORES, *CLUSTERS])
def test_what_libraries_say_is_shown_without_credentials(text):
    for said in (text, f"<Error> cannot open '{text}'", f"GET {text}, again", f"x={text};{text}"):
        # A secret in the place of a user's name, or of a port, is none that a text shows to be one.
        if f"//{SECRET}@" not in text and f"{SECRET}/" not in text:
            assert SECRET not in without_credentials(said)
            assert SECRET not in shown(OutputError("cannot: {0}", said))
            assert SECRET not in shown(OutputError("cannot: {0}", OSError(said)))
            assert SECRET not in shown(OutputError(said))
            assert SECRET not in Message("{0!r}", said)


@pytest.mark.parametrize("joint", [",", ";", " "])
def test_a_password_that_is_cut_where_a_list_is_split_is_not_shown(joint):
    for address in (f"s3://KEY:{SECRET}", f"https://me:{SECRET}", f"gs://me:{SECRET[1:]}%2"):
        said = f"coordinates '50{joint}{address}{joint}more@bucket'"
        for text in (said, *said.split(joint), f"no float: {address!r}", f"({address})"):
            assert SECRET[1:] not in without_credentials(text)


def test_what_a_text_may_show_stays():
    for text in (
        "no answer of tcp://scheduler:8786, nor of https://[::1]:8080: wait",
        "s3://bucket: no such bucket (s3://arn:aws:s3:eu-1:5:accesspoint/x)",
        "write token={key} and set TERRAINAV_KEY",
        "https://tiles.example/{z}/{x}/{y}.png?token={key}",
        "time 5:30 by u@example.org, see https://tiles.example:8080/a?style=dark&format=png",
        "C:\\data: cannot be read",
    ):
        assert without_credentials(text) == text
        assert Message("{0}", text) == text


def test_a_url_that_is_signed_is_shown_without_its_signature():
    url = f"http://h:9/b/k?X-Amz-Credential={SECRET}&X-Amz-Signature={SECRET}&X-Amz-Security-Token={SECRET}"
    with pytest.raises(OutputError) as wrong, store_errors(store_path("memory://data/x")):
        raise OSError(5, f"404 for {url}")
    assert SECRET not in shown(wrong.value)
    assert SECRET not in without_credentials(f"ClientError: {url}")


@pytest.mark.parametrize("piece", ["a:/", "a:b@", "s3://", "?key=", "://@:", "x://y:z@", "%3A%40", "&sig=&"])
def test_the_work_grows_with_the_length(piece):
    def read(times):
        without_credentials(piece * times)
        if piece in ("a:/", "s3://"):
            check_no_credentials("s3:" + piece * times, "x", "y")

    assert growth(read, 4000) < PROPORTIONAL


def searched(folder, said):
    """Look for the secret in all that was printed and written; names of files are such, too."""
    assert SECRET not in said
    for path in folder.rglob("*"):
        assert SECRET not in str(path)
        assert not path.is_file() or SECRET.encode() not in path.read_bytes()


@pytest.fixture
def command(tmp_path, monkeypatch, capfd):
    """Run the command in a folder of its own, and search what is left of it."""
    monkeypatch.chdir(tmp_path)
    for name in ("CONFIG_DIR", "CACHE_DIR"):
        monkeypatch.setenv(f"TERRAINAV_{name}", str(tmp_path / name))
    monkeypatch.setenv("TERRAINAV_DEBUG", "1")

    def run(*argv):
        try:
            code = main([str(one) for one in argv])
        except SystemExit as ended:
            code = ended.code
        printed = capfd.readouterr()
        searched(tmp_path, printed.out + printed.err)
        return code, printed.err

    return run


@pytest.mark.parametrize("text", sampled(STORES, 5))
def test_a_capture_into_an_address_with_credentials_leaves_nothing_of_them(command, text):
    for more in ([], ["--json"], ["--resume"]):
        code, said = command("capture", "--coords", COORDS, "--data-dir", text, *more)
        assert code == BAD_INPUT
        assert "may stand in it" in said
        assert said.count("\n") == 1


@pytest.mark.parametrize("text", CLUSTERS)
def test_a_capture_on_a_cluster_with_credentials_leaves_nothing_of_them(command, text):
    code, said = command("capture", "--coords", COORDS, "--data-dir", "out", "--cluster", text)
    assert code == BAD_INPUT
    assert "cluster" in said


@pytest.mark.parametrize("text", [STORES[2], STORES[19]])
@pytest.mark.parametrize(
    "argv",
    sampled([
        ["clean"], ["split"], ["load"], ["mosaic"], ["export", "--as", "stac"], ["poses", "read", "--output", "x.csv"],
        ["plan"], ["capture", "--data-dir", "out"], ["convert", "out"], ["sources", "show"], ["sources", "add", "x"],
        ["benchmark", "run", "--method", "pixels"], ["benchmark", "score"], ["benchmark", "make"],
        ["plan", "--coords"], ["pairs", "--data-dir", "out"],
        *(
            ["plan", "--coords", COORDS, option]
            for option in (
                "--source", "--elevation", "--surface", "--imagery", "--output", "--config", "--camera", "--no-fly",
                "--area", "--bogus", "--zoom", "--map-type", "--preset", "--cache-dir",
            )
        ),
        ["report", "--coords", COORDS, "--output"],
    ], 5),
    ids=" ".join,
)  # fmt: skip
def test_no_option_repeats_credentials(command, argv, text):
    code, _ = command(*argv, text)
    assert code != FAULT


@pytest.mark.parametrize("name", ["source", "data_dir", "elevation", "cache_dir", "no_fly", "camera"])
def test_no_setting_repeats_credentials(command, tmp_path, monkeypatch, name):
    (tmp_path / "settings.json").write_text(json.dumps({name: STORES[0].replace(SECRET, "other")}))
    assert command("capture", "--coords", COORDS, "--config", "settings.json")[0] in (0, BAD_INPUT, FAILED)
    monkeypatch.setenv(f"TERRAINAV_{name.upper()}", STORES[0])
    assert command("plan", "--coords", COORDS)[0] in (0, BAD_INPUT, FAILED)


@pytest.mark.parametrize("text", sampled([STORES[0], STORES[19], STORES[20]], 3))
def test_a_mission_that_names_credentials_is_refused_without_them(command, tmp_path, text):
    given = tmp_path.parent / f"{tmp_path.name}.json"
    assert command("plan", "--coords", COORDS, "--output", given)[0] == 0
    mission = json.loads(given.read_text())

    def with_text(value, path=()):
        """The mission with the address in the place of each of its texts and numbers."""
        if isinstance(value, dict):
            for name, inner in value.items():
                yield from ({**value, name: one} for one in with_text(inner))
        elif not isinstance(value, list):
            yield text

    for one in with_text(mission):
        given.write_text(json.dumps(one))
        code, said = command("plan", given)
        assert code in (BAD_INPUT, FAILED)
        assert said.startswith("terrainav: ")
