"""The command as a person or a script runs it: output, files, exit codes, one clear line for each mistake."""

from __future__ import annotations

import argparse
import ast
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from terrainav.core.cli.options import parser
from terrainav.core.dataset.table import Table

from tests.support.command import command
from tests.support.thinning import sampled
from tests.support.tileserver import TileServer

BOX = "35.16_-89.90_35.155_-89.89_400"


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


@pytest.fixture
def shell(tmp_path):
    """Run the command as a process of its own in an empty folder; returns the finished process."""

    def process(*arguments, **environment):
        return subprocess.run(
            [sys.executable, "-m", "terrainav.core.cli", *arguments],
            cwd=tmp_path,
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    return process


def one_line(process, code):
    """Return the only line of an error, which is no traceback."""
    assert process.returncode == code, process.stderr
    assert process.stdout == ""
    (line,) = process.stderr.splitlines()
    assert line.startswith("terrainav")
    return line


def test_plan_prints_the_figures_of_the_papers_mission(run):
    done = run("plan", "--coords", "35.16_-89.90_35.115_-89.823_120")
    assert done.returncode == 0, done.stderr
    lines = dict(line.split("  ", 1) for line in done.stdout.splitlines() if "  " in line)
    assert lines["images"].strip() == "1,935"
    assert lines["coverage"].strip() == "100 % (complete)"
    assert lines["source"].strip() == "Synthetic (offline)"
    paper = run("plan", "--coords", "35.16_-89.90_35.115_-89.823_120", "--layout", "paper")
    assert "99.7" in paper.stdout
    assert "uncovered" in paper.stdout


def test_areas_and_no_fly_areas_come_from_files(run, tmp_path):
    ring = "{0},35.1 {1},35.1 {1},35.103 {0},35.103 {0},35.1"
    shape = "<Polygon><outerBoundaryIs><LinearRing><coordinates>{}</coordinates></LinearRing></outerBoundaryIs>"
    fields = "".join(f"{shape}</Polygon>".format(ring.format(west, west + 0.003)) for west in (-89.9, -89.89))
    (tmp_path / "fields.kml").write_text(f"<kml><Placemark><MultiGeometry>{fields}</MultiGeometry></Placemark></kml>")
    corners = [[-89.8998, 35.1002], [-89.8972, 35.1002], [-89.8972, 35.1028], [-89.8998, 35.1028]]
    (tmp_path / "zone.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [corners]}))
    options = ("--area", "fields.kml", "--agl", "120", "--overlap", "0.5")
    whole = json.loads(run("plan", *options, "--json").stdout)
    assert (whole["polygons"], whole["no_fly_areas"], whole["images_over_no_fly"]) == (2, 0, 0)
    assert whole["complete"]
    outputs = ("--output", "left.csv", "--output", "left.json")
    left = json.loads(run("plan", *options, "--no-fly", "zone.geojson", *outputs, "--json").stdout)
    assert left["images_over_no_fly"] > 0
    assert left["images"] + left["images_over_no_fly"] == whole["images"]
    assert not left["complete"]
    again = json.loads(run("plan", "left.json", "--json").stdout)
    assert again["images_over_no_fly"] == left["images_over_no_fly"]
    lines = run("plan", "left.json").stdout
    assert "area                    2 polygons, " in lines
    assert f"over no-fly areas       {left['images_over_no_fly']} images left out" in lines
    captured = run("capture", "left.json", "--data-dir", "OUT", "--quiet")
    assert captured.returncode == 0, captured.stderr
    assert len(list((tmp_path / "OUT" / "satellite").glob("*.tif"))) == left["images"]


def test_what_is_wrong_with_files_of_areas_is_one_line(shell, tmp_path):
    (tmp_path / "broken.kml").write_text("<kml><Polygon>")
    told = one_line(shell("plan", "--area", "broken.kml", "--agl", "120"), 2)
    assert "area file broken.kml: cannot be read as KML" in told
    told = one_line(shell("plan", "--coords", BOX, "--no-fly", "none.kml"), 2)
    assert "no-fly file none.kml: cannot be read" in told


def test_plan_as_json_and_as_files(run, tmp_path):
    outputs = [f"--output=plan.{ending}" for ending in ("csv", "geojson", "kml", "json")]
    done = run("plan", "--coords", BOX, *outputs, "--json")
    figures = json.loads(done.stdout)
    assert figures["covered_share"] == 1.0
    assert len((tmp_path / "plan.csv").read_text().splitlines()) == figures["images"] + 1
    again = json.loads(run("plan", "plan.json", "--json").stdout)
    assert figures.pop("written") == ["plan.csv", "plan.geojson", "plan.kml", "plan.json"]
    assert again.pop("written") == []
    # Costs are timed, each time anew.
    assert figures.pop("cost")["picture_s"] > 0.0
    assert again.pop("cost")["picture_s"] > 0.0
    assert again == figures
    accuracy = figures["accuracy"]
    assert accuracy["footprint"]["chosen"]["name"] == "exact"
    assert accuracy["image"]["chosen"]["name"] == "map"
    assert 0.0 < accuracy["bound_px"] <= accuracy["budget_px"] == 0.1


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [("--agl", "1_20", "invalid float value: '1_20'"), ("--count", "\u0661", "invalid int value: '\u0661'")],
)
def test_numbers_of_options_have_plain_digits(run, option, value, said):
    refused = run(
        "poses",
        "random",
        "--area",
        "1_1_0_2",
        "--output",
        "p.csv",
        "--count",
        "3",
        "--agl",
        "90",
        option,
        value,
    )
    refused = (
        refused
        if option == "--count"
        else run("poses", "line", "l.json", "--output", "p.csv", "--speed", "9", option, value)
    )
    assert said in refused.stderr


def test_each_sortie_is_a_file_that_the_command_names(run, tmp_path):
    area = "35.16_-89.90_35.155_-89.89_200"
    flight = ["plan", "--coords", area, "--takeoff", "35.1585", "-89.901", "--battery"]
    mine = tmp_path / "survey-2.plan"
    mine.write_text("mine")
    done = run(*flight, "5", "--output", "survey.plan")
    assert done.returncode == 0, done.stderr
    sorties = int(re.search(r"^sorties +(\d+):", done.stdout, re.MULTILINE).group(1))
    assert sorties > 1
    files = [f"survey-{number}.plan" for number in range(1, sorties + 1)]
    assert re.findall(r"^written +(\S+)$", done.stdout, re.MULTILINE) == files
    assert sorted(path.name for path in tmp_path.glob("*.plan")) == sorted(files)
    # Each is a flight of its own, and what one replaces is named.
    assert len({(tmp_path / file).read_bytes() for file in files}) == sorties
    assert "survey.plan: replaced survey-2.plan\n" in done.stderr
    # A flight of one sortie leaves those of the other, and says so.
    done = run(*flight, "60", "--output", "survey.plan", "--json")
    assert json.loads(done.stdout)["written"] == ["survey.plan"]
    left = f"survey.plan: not of this flight, and left as they were: {', '.join(files)}\n"
    assert left in done.stderr
    done = run(*flight, "5", "--output", "survey.plan")
    assert "not of this flight, and left as they were: survey.plan\n" in done.stderr


def test_a_pattern_has_the_camera_of_plan_and_capture(run, tmp_path):
    line = {"type": "LineString", "coordinates": [[-89.9, 35.1], [-89.89, 35.1]]}
    (tmp_path / "line.geojson").write_text(json.dumps(line))
    (tmp_path / "config.json").write_text('{"overlap": [0.5, 0.4]}')
    asked = ("poses", "corridor", "line.geojson", "--agl", "120", "--width", "300", "--output")
    written = {}
    for name, options, environment in (
        ("options", ("--fov", "60", "--overlap", "50%", "0.4"), {}),
        ("elsewhere", (), {"TERRAINAV_FOV": "60"}),
        ("usual", ("--overlap", "50%", "0.4"), {}),
    ):
        done = run(*asked, f"{name}.csv", *options, **environment)
        assert done.returncode == 0, done.stderr
        written[name] = (tmp_path / f"{name}.csv").read_text()
    assert written["options"] == written["elsewhere"] != written["usual"]


def test_underscores_minus_signs_and_settings_by_precedence(run, tmp_path):
    (tmp_path / "config.json").write_text('{"aspect_ratio": [1, 1], "overlap": 0.5}')
    done = run("plan", "--coords", "-35.1_-70.2_120", "--agl_unit", "ft", "--json", TERRAINAV_OVERLAP="0.2")
    figures = json.loads(done.stdout)
    # A square in degrees of latitude is 0.4 % higher than wide at 35 degrees.
    assert figures["height_px"] / figures["width_px"] == pytest.approx(1.0, abs=0.005)
    assert figures["images"] == 1


def test_capture_leaves_a_dataset(run, tmp_path):
    done = run("capture", "--coords", BOX, "--map-type", "satellite", "roadmap", "--data-dir", "out", "--json")
    result = json.loads(done.stdout)
    assert done.returncode == 0, done.stderr
    assert result["written"] == result["total"] > 0
    assert result["requests"] == result["unique_parts"]
    for map_type in ("satellite", "roadmap"):
        rows = (tmp_path / "out" / map_type / "meta_data.csv").read_text().splitlines()
        assert rows[0].startswith("img_names,columns,rows,Lat,Lon,Alt,entropies")
        assert len(rows) - 1 == len(list((tmp_path / "out" / map_type).glob("*.tif"))) == result["total"] // 2

    assert "resume" in one_line(
        run("capture", "--coords", BOX, "--map-type", "satellite", "roadmap", "--data-dir", "out"), 3
    )
    assert "another mission" in one_line(run("capture", "--coords", BOX, "--data-dir", "out"), 3)
    resumed = run("capture", "out/mission.json", "--data-dir", "out", "--resume", "--json")
    assert json.loads(resumed.stdout)["skipped"] == result["total"]


def test_missing_tiles_are_named_and_the_rest_is_written(run, tmp_path):
    with TileServer() as server:
        missing = server.url_template.replace("{z}", "no/such/{z}")
        done = run("capture", "--coords", BOX, "--source", missing, "--data-dir", "none", "--json")
    assert done.returncode == 1
    result = json.loads(done.stdout)
    assert result["written"] == 0
    assert len(result["failed"]) == result["total"]
    assert all(failure["reason"] for failure in result["failed"])
    assert not list((tmp_path / "none").rglob("*.tif"))


def test_an_interrupt_stops_and_resume_goes_on(tmp_path):
    arguments = [
        sys.executable,
        "-m",
        "terrainav.core.cli",
        "capture",
        "--coords",
        "35.16_-89.90_35.154_-89.885_120",
    ]
    arguments += ["--data-dir", "out", "--quiet"]
    process = subprocess.Popen(arguments, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not list((tmp_path / "out").glob("satellite/*.tif")):
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "--resume" in errors
    written = {path: path.read_bytes() for path in (tmp_path / "out").glob("satellite/*.tif")}
    assert written
    resumed = subprocess.run(
        [*arguments, "--resume", "--json"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    result = json.loads(resumed.stdout)
    assert result["skipped"] == len(written)
    assert result["skipped"] + result["written"] == result["total"]
    assert all(path.read_bytes() == data for path, data in written.items())


@pytest.mark.skipif(os.name == "nt", reason="Windows ends processes without asking them")
@pytest.mark.parametrize(("name", "code"), sampled([("SIGTERM", 143), ("SIGHUP", 129)], 2))
def test_whatever_ends_a_capture_leaves_its_table(tmp_path, name, code):
    arguments = ["capture", "--coords", "35.16_-89.90_35.15_-89.88_120", "--data-dir", "out", "--quiet"]
    number = getattr(signal, name)
    # Whoever began the tests may have had it ignored, as nohup does, and children inherit that.
    before = signal.signal(number, signal.SIG_DFL)
    try:
        process = subprocess.Popen(
            [sys.executable, "-m", "terrainav.core.cli", *arguments],
            cwd=tmp_path,
            stderr=subprocess.PIPE,
            text=True,
        )
    finally:
        signal.signal(number, before)
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not list((tmp_path / "out").glob("satellite/*.tif")):
        time.sleep(0.02)
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    assert (process.returncode, "--resume" in errors) == (code, True), errors
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert set(table.img_names) == {path.name for path in (tmp_path / "out").glob("satellite/*.tif")}
    assert not list((tmp_path / "out").rglob("*.part"))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["plan"], "no coordinates"),
        (["plan", "--coords", "35_-89"], "2 numbers"),
        (["plan", "--coords", "95_-89_120"], "latitude 95"),
        (["plan", "--coords", "35_-89_120", "--fov", "180"], "field of view 180"),
        (["plan", "--coords", "35_-89_120", "--fov", "wide"], "'wide'"),
        (["plan", "--coords", "35_-89_120", "--aspect-ratio", "4"], "aspect-ratio"),
        (["plan", "--coords", "35_-89_-5"], "-5.0 m"),
        (["plan", "--coords", BOX, "--overlap", "1"], "overlap '1': must be a share from 0 to below 1"),
        (["plan", "--coords", BOX, "--overlap", "120%"], "overlap '120%': must be a share from 0 to below 1"),
        (["plan", "--coords", BOX, "--map-type", "hybrid"], "hybrid"),
        (["plan", "--coords", BOX, "--source", "atlantis"], "atlantis"),
        (["plan", "--coords", BOX, "--layout", "spiral"], "spiral"),
        (["plan", "--coords", BOX, "--max-images", "3"], "limit is 3"),
        (["plan", "--coords", BOX, "--output", "plan.shp"], ".kmz, .plan, .survey.plan, .json"),
        (["plan", "gone.json"], "gone.json"),
        (["plan", "--nonsense"], "--nonsense"),
        (["swim"], "swim"),
        (["capture", "--coords", BOX, "--source", "https://tiles.example/{z}/{x}.png"], "{y}"),
        (["capture", "--coords", BOX, "--img-size", "0", "5", "3"], "image size 0 5 3"),
    ],
)
def test_every_mistake_is_one_clear_line(run, arguments, says):
    line = one_line(run(*arguments), 2)
    assert says in line


def test_a_mistake_is_the_exit_code_of_the_process(shell):
    assert "no coordinates" in one_line(shell("plan"), 2)


def test_a_missing_key_names_where_it_goes(run):
    line = one_line(run("capture", "--coords", BOX, "--source", "google-static"), 3)
    assert "TERRAINAV_GOOGLE_KEY" in line


def test_a_provider_that_allows_no_bulk_download_is_quoted(run):
    line = one_line(run("capture", "--coords", "35.16_-89.90_35.115_-89.823_120", "--source", "osm"), 3)
    assert "OpenStreetMap" in line


def test_no_network_names_the_images(run):
    # Port 1 of the loopback refuses connections.
    done = run("capture", "--coords", "35_-89_120", "--source", "http://127.0.0.1:1/{z}/{x}/{y}.png", "--json")
    assert done.returncode == 1
    assert json.loads(done.stdout)["failed"][0]["reason"]


def test_sources_and_cameras_are_listed(run):
    sources = run("sources").stdout
    assert "Synthetic (offline)" in sources
    assert {"name", "attribution"} <= set(json.loads(run("sources", "--json").stdout)[0])
    assert "DJI Mini 2" in run("cameras").stdout
    assert len(json.loads(run("cameras", "--json").stdout)) > 10


def test_version_and_help(run, shell):
    assert shell("--version").stdout.startswith("terrainav 0.")
    assert "capture" in run("--help").stdout
    assert "--coords" in run("plan", "--help").stdout
    assert run().returncode == 0


def test_every_command_and_action_has_help():
    waiting, seen = [parser()], []
    while waiting:
        one = waiting.pop()
        seen.append(one.prog)
        assert one.format_help().startswith("usage: terrainav")
        inner = [action for action in one._actions if isinstance(action, argparse._SubParsersAction)]
        waiting += [command for action in inner for command in action.choices.values()]
    assert {"terrainav plan", "terrainav poses orbit", "terrainav benchmark make"} <= set(seen)


@pytest.mark.skipif(os.name == "nt" or os.geteuid() != 0, reason="needs root to become another user")
def test_a_folder_that_cannot_be_written_is_named(tmp_path):
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o755)
    # The other user may not be able to read the checkout, so the change comes when the folder is about to be made.
    script = f"""
import os, sys
from terrainav.core.capture import folder
from terrainav.core.cli import main
as_root = folder.make_folder
def as_nobody(*arguments, **options):
    os.setegid(65534), os.seteuid(65534)
    return as_root(*arguments, **options)
folder.make_folder = as_nobody
sys.exit(main(['capture', '--coords', '35_-89_120', '--data-dir', {str(locked / "out")!r}]))
"""
    process = subprocess.run(
        [sys.executable, "-c", script], cwd="/", capture_output=True, text=True, timeout=60, check=False
    )
    line = one_line(process, 3)
    assert "locked" in line
    assert "Permission denied" in line
    assert not list(Path(locked).iterdir())


def test_a_message_that_quotes_a_whole_file_is_cut_short(run, tmp_path):
    (tmp_path / "places.txt").write_text("x" * 100_000)
    said = run("plan", "--coords", str(tmp_path / "places.txt"))
    assert one_line(said, 2).startswith("terrainav: file ")
    assert len(said.stderr) < 20_000


def test_what_cannot_be_printed_does_not_break_the_line_of_an_error(run):
    said = run("plan", "--coords", "35_-89_120", "--source", "a\nb\x1b[31m.tif")
    assert (said.returncode, said.stderr) == (2, "terrainav: a b [31m.tif: there is no such file\n")
    too_long = run("plan", "--coords", "35_-89_120", "--source", "x" * 5000 + ".tif")
    assert "cannot be read" in one_line(too_long, 2)


@pytest.mark.parametrize("option", ["--data-dir", "--cache-dir"])
def test_a_folder_without_a_name_is_not_the_current_one(run, tmp_path, option):
    before = sorted(tmp_path.iterdir())
    assert "folder '': must be the name of a folder" in one_line(run("capture", "--coords", BOX, option, ""), 2)
    assert sorted(tmp_path.iterdir()) == before


def test_tiles_are_kept_on_this_machine_only(run):
    for words in (("capture", "--coords", BOX), ("cache", "list")):
        refused = run(*words, "--cache-dir", "s3://bucket/tiles")
        assert "cache folder s3://bucket/tiles: must be on this machine" in one_line(refused, 2)


def test_a_signal_that_an_import_turns_into_another_error_stops_all_the_same(run, monkeypatch):
    def interrupted(*_):
        try:
            signal.raise_signal(signal.SIGTERM)
        except BaseException as wrong:
            raise ImportError("numpy.core.multiarray failed to import") from wrong

    monkeypatch.setattr("terrainav.core.mission.plan.plan", interrupted)
    assert one_line(run("plan", "--coords", BOX), 143) == "terrainav: stopped"
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


def test_what_the_program_itself_does_wrong_has_a_code_of_its_own(run, monkeypatch):
    def broken(*found):
        return found[9]

    monkeypatch.setattr("terrainav.core.mission.plan.plan", broken)
    line = one_line(run("plan", "--coords", BOX), 70)
    assert "IndexError: tuple index out of range (test_cli.py, line " in line
    assert "please report it" in line
    said = run("plan", "--coords", BOX, TERRAINAV_DEBUG="1")
    assert said.returncode == 70
    assert "Traceback" in said.stderr
    assert said.stderr.endswith(line + "\n")


@pytest.mark.parametrize(
    "name", ["__init__.py", "core/__init__.py", "core/cli/__init__.py", "core/cli/exits.py", "core/errors.py"]
)
def test_until_the_command_runs_nothing_is_imported_that_takes_time(name):
    # What is imported before `main` cannot answer Ctrl-C with one line.
    tree = ast.parse((Path(__file__).parents[2] / name).read_text(encoding="utf-8"))
    imports = [node for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
    outside = {
        alias.name if isinstance(node, ast.Import) else node.module
        for node in imports
        for alias in node.names
        if isinstance(node, ast.Import) or not node.level
    }
    assert outside <= {"__future__", "os", "sys"}


def test_an_interrupt_while_planning_is_one_line(run, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("terrainav.core.mission.plan.plan", interrupted)
    assert one_line(run("plan", "--coords", BOX), 130) == "terrainav: stopped"


def test_too_little_memory_is_one_line(run, monkeypatch):
    def exhausted(*_):
        raise MemoryError

    monkeypatch.setattr("terrainav.core.mission.plan.plan", exhausted)
    assert one_line(run("plan", "--coords", BOX), 3).startswith("terrainav: not enough memory; ask for less")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("arguments", [("cameras",), ("--help",)])
def test_output_that_cannot_be_written_is_one_line(tmp_path, arguments):
    with Path("/dev/full").open("w") as full:
        process = subprocess.run(
            [sys.executable, "-m", "terrainav.core.cli", *arguments],
            cwd=tmp_path,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
            check=False,
        )
    assert (process.returncode, len(process.stderr.splitlines())) == (3, 1), process.stderr
    assert "No space left on device" in process.stderr


def test_rows_are_aligned_and_the_gain_is_said(run, tmp_path):
    field = [[-89.866, 35.1385], [-89.8585, 35.1425], [-89.8597, 35.1440], [-89.8672, 35.1400]]
    text = json.dumps({"type": "Polygon", "coordinates": [[*field, field[0]]]})
    (tmp_path / "field.geojson").write_text(text)
    asked = ("plan", "--area", "field.geojson", "--agl", "250", "--align", "longest-side")
    _, out, told = run(*asked, "--output", "mission.json", "--json")
    assert "row azimuth 57°" in told
    assert "% shorter than 90°" in told
    azimuth = json.loads((tmp_path / "mission.json").read_text())["flight"]["row_azimuth_deg"]
    assert f"row azimuth {azimuth:g}°" in told
    assert json.loads(out)["images"] > 0
