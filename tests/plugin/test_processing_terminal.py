"""Algorithms from a terminal: ``qgis_process`` with the plugin in a profile of its own."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from qgis.core import QgsProcessingFeedback, QgsVectorLayer
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.tileserver import TileServer

ROOT = Path(__file__).resolve().parents[2]
#: Of a process: it starts in two seconds and works for two more.
LIMIT_S = 120.0
#: The program itself: the script around it may be broken by a system's settings of QGIS.
PROGRAM = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
BOX = Box(35.16, -89.90, 35.155, -89.89)
EXTENT = "-89.90,-89.89,35.155,35.16 [EPSG:4326]"


@pytest.fixture(scope="module")
def terminal(tmp_path_factory):
    """Run ``qgis_process`` with its arguments; the plugin is enabled."""
    if PROGRAM is None:
        pytest.skip("qgis_process is not installed")
    folder = tmp_path_factory.mktemp("terminal")
    plugins = folder / "profiles" / "default" / "python" / "plugins"
    plugins.mkdir(parents=True)
    (plugins / "terrainav").symlink_to(ROOT, target_is_directory=True)
    environment = {
        **os.environ,
        "QGIS_CUSTOM_CONFIG_PATH": str(folder),
        "QT_QPA_PLATFORM": "offscreen",
        "TERRAINAV_CACHE_DIR": str(folder / "cache"),
        "TERRAINAV_CONFIG_DIR": str(folder / "config"),
    }
    # What starts this QGIS with its tests is not for that one.
    environment.pop("PYQGIS_STARTUP", None)
    # It starts a dozen times, and compiles the plugin once.
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    environment["PYTHONPYCACHEPREFIX"] = str(folder / "bytecode")

    def run(*arguments):
        return subprocess.run(
            [PROGRAM, *arguments],
            env=environment,
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )

    enabled = run("plugins", "enable", "terrainav")
    assert enabled.returncode == 0, enabled.stderr
    return run


def results(process):
    """Results that a run has printed."""
    assert process.returncode == 0, process.stdout + process.stderr
    assert "Traceback" not in process.stderr
    _, _, text = process.stdout.partition("Results")
    return dict(re.findall(r"^(\w+):\t(.*)$", text, re.MULTILINE))


@pytest.fixture(scope="module")
def help_of_plan(terminal):
    """What is printed of the algorithm that has most choices."""
    return terminal("help", "terrainav:plan").stdout


@pytest.mark.thorough
def test_the_algorithms_are_listed_and_explained(terminal, help_of_plan):
    listed = terminal("list").stdout
    for name in (
        "plan",
        "capture",
        "capturefailed",
        "clean",
        "split",
        "mosaic",
        "export",
        "makebenchmark",
        "scorebenchmark",
        "accuracyreport",
    ):
        assert f"terrainav:{name}\t" in listed
    assert "without fetching imagery" in help_of_plan
    assert "FRONT_OVERLAP: Front overlap (percent)" in help_of_plan


def test_plan(terminal, tmp_path):
    found = results(
        terminal(
            "run",
            "terrainav:plan",
            "--COORDS=35.16_-89.90_35.155_-89.89_200",
            "--FRONT_OVERLAP=30",
            f"--FOOTPRINTS={tmp_path / 'footprints.gpkg'}",
            f"--MISSION_FILE={tmp_path / 'mission.json'}",
        )
    )
    mission = Mission(BOX, 200.0, overlap_along=0.3)
    expected = plan(mission, open_source("world").grid)
    assert found["IMAGES"] == str(len(expected))
    assert float(found["COVERAGE"]) == 100.0 * expected.coverage.share
    layer = QgsVectorLayer(str(tmp_path / "footprints.gpkg"))
    assert [feature["name"] for feature in layer.getFeatures()] == list(expected.names)
    assert Mission.load(str(tmp_path / "mission.json")) == mission


def listed(help_text, name):
    """Values of a choice, as the help of an algorithm lists them: numbers and texts."""
    about = re.search(rf"^{name}: .*?^\tAvailable values:\n((?:\t\t- [^\n]*\n)+)", help_text, re.MULTILINE | re.DOTALL)
    return re.findall(r"^\t\t- (\d+): (.*)$", about[1], re.MULTILINE)


def saved(path, parameters, terminal=None):
    """Mission that a plan is made of: from a terminal, or with the same texts in this application, which is quicker."""
    file = path / f"{len(list(path.iterdir()))}.json"
    asked = {"COORDS": "35.16_-89.90_35.155_-89.89_400", "MISSION_FILE": str(file), **parameters}
    if terminal is None:
        import processing

        processing.run("terrainav:plan", asked, feedback=QgsProcessingFeedback(False))
    else:
        results(terminal("run", "terrainav:plan", *(f"--{name}={text}" for name, text in asked.items())))
    return Mission.load(str(file))


@pytest.mark.usefixtures("plugin")
def test_every_value_that_the_help_lists_is_taken(terminal, help_of_plan, tmp_path):
    """One run for each way in which all of the choices can be named; from a terminal as its help lists them."""
    expected = {
        "LAYOUT": "paper",
        "ORDER": "one-way",
        "FORMAT": "png",
        "FRAME": "camera",
        "MAP_TYPES": "roadmap",
    }
    expected |= {"SOURCE": "world", "RESAMPLING": "nearest"}
    at = {name: {text: number for number, text in listed(help_of_plan, name)} for name in expected}
    assert "Synthetic (offline) [world]" in at["SOURCE"]
    assert "OpenStreetMap [osm]" in at["SOURCE"]
    as_listed = {**expected, "SOURCE": "Synthetic (offline) [world]"}
    ways = (
        as_listed,
        {name: at[name][text] for name, text in as_listed.items()},
        {**{name: text.upper() for name, text in expected.items()}, "SOURCE": "synthetic (OFFLINE)"},
    )
    missions = [saved(tmp_path, {"ACCEPT_ERROR": "1", **way}, terminal if way is as_listed else None) for way in ways]
    assert missions == missions[:1] * len(ways)
    one = missions[0]
    assert (one.flight.layout, one.flight.order, one.output.image_format) == ("paper", "one-way", "png")
    assert (one.imagery.source, one.imagery.map_types) == ("world", ("roadmap",))


def test_choices_that_are_none_are_refused_and_not_made_the_default(terminal):
    asked = ("--COORDS=35.16_-89.90_400", "--SOURCE=nowhere", "--FOOTPRINTS=TEMPORARY_OUTPUT")
    refused = terminal("run", "terrainav:plan", *asked)
    assert refused.returncode != 0
    assert "Source of imagery 'nowhere': must be one of world, " in refused.stdout + refused.stderr
    assert "IMAGES" not in refused.stdout


@pytest.mark.usefixtures("plugin")
def test_overlaps_are_percent(tmp_path):
    percent = saved(tmp_path, {"FRONT_OVERLAP": "60", "SIDE_OVERLAP": "0.7"})
    assert (percent.flight.overlap_along, percent.flight.overlap_across) == (0.6, 0.007)


def test_capture_of_the_embedded_world_clean_and_back(terminal, tmp_path):
    out = tmp_path / "out"
    mission = tmp_path / "mission.json"
    Mission(BOX, 200.0, map_types=("satellite", "roadmap"), image_px=160).save(str(mission))
    found = results(terminal("run", "terrainav:capture", f"--MISSION={mission}", f"--FOLDER={out}"))
    source = open_source("world")
    expected = plan(Mission.load(str(mission)), source.grid)
    assert (found["WRITTEN"], found["FAILED"]) == (str(2 * len(expected)), "0")
    # The very bytes that the library and the command write.
    capture(expected, source, tmp_path / "library")
    for path in (tmp_path / "library").rglob("*"):
        if path.is_file() and path.name != "journal.jsonl":
            assert (out / path.relative_to(tmp_path / "library")).read_bytes() == path.read_bytes()
    found = results(terminal("run", "terrainav:capturefailed", f"--DATASET={out}"))
    assert found["TOTAL"] == "0"
    found = results(terminal("run", "terrainav:clean", f"--DATASET={out}", "--ENTROPY=8", "--ACTION=move"))
    assert found["MOVED"] == str(2 * len(expected))
    results(terminal("run", "terrainav:clean", f"--DATASET={out}", "--ACTION=undo"))
    assert len(list(out.glob("*/*.tif"))) == 2 * len(expected)


@pytest.mark.thorough
def test_capture_over_the_network_does_not_wait_for_itself(terminal, tmp_path):
    """Here the main thread runs the algorithm, and QGIS's network stack needs that thread for its events."""
    with TileServer() as server:
        found = results(
            terminal(
                "run",
                "terrainav:capture",
                f"--EXTENT={EXTENT}",
                "--AGL=200",
                f"--OTHER_SOURCE={server.url_template}",
                f"--FOLDER={tmp_path / 'out'}",
            )
        )
        assert found["REQUESTS"] == str(sum(server.tile_requests.values()))
    assert (found["FAILED"], found["WRITTEN"]) == ("0", found["TOTAL"])
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert set(table.status) == {"done"}
    with Image.open(tmp_path / "out" / "satellite" / table.img_names[0]) as image:
        assert np.asarray(image).any()


def test_bad_input_is_one_line_on_the_terminal(terminal, tmp_path):
    refused = terminal("run", "terrainav:capture", f"--FOLDER={tmp_path / 'out'}")
    assert "0 areas given: needs one of extent, polygons or points, and coordinates" in (
        refused.stdout + refused.stderr
    )
    assert "Traceback" not in refused.stdout + refused.stderr
    assert not (tmp_path / "out").exists()
