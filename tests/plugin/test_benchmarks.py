"""Benchmarks in the real application: made of a mission, answered, judged, their errors on the map."""

from __future__ import annotations

import csv
import json
import shutil
import sys

import numpy as np
import pytest
from pyproj import Geod
from qgis.core import (
    QgsApplication,
    QgsExpression,
    QgsExpressionContext,
    QgsExpressionContextUtils,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProject,
    QgsRasterLayer,
)
from qgis.PyQt import sip
from terrainav.core.benchmark.folder import Benchmark
from terrainav.core.benchmark.making import make_benchmark
from terrainav.core.benchmark.planning import SPLITS, BenchmarkSettings, plan_benchmark
from terrainav.core.benchmark.running import METHODS
from terrainav.core.dataset.folder import PARTS
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.imageries import NamedImagery
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin import packages

from tests.plugin.test_loading import settle
from tests.plugin.test_processing import Feedback, refusal, run
from tests.plugin.test_processing import provider as _provider  # noqa: F401  (a fixture)

MISSION = Mission(Box(35.150, -89.900, 35.1490, -89.8985), 60.0, image_px=40, image_format="png")
AIR, MAP = NamedImagery("air", "world"), NamedImagery("map", "world", map_type="roadmap")
SETTINGS = BenchmarkSettings(MISSION, (AIR, MAP), AIR, split="none")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Folder of a benchmark that the core has made."""
    folder, source = tmp_path_factory.mktemp("benchmarks") / "core", open_source("world")
    names = [str(one) for one in (AIR, MAP)]
    worked_out = plan_benchmark(SETTINGS, dict.fromkeys(names, source.grid))
    make_benchmark(worked_out, dict.fromkeys(names, source), folder)
    return folder


@pytest.fixture
def mission_file(tmp_path):
    MISSION.save(str(tmp_path / "mission.json"))
    return str(tmp_path / "mission.json")


def predictions_of(folder, path, errors_m):
    """Write answers that are so far east of the truth, None for no answer; returns their queries."""
    queries = Benchmark.read(folder).queries
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["query", "lat_deg", "lon_deg"])
        for at, metres in enumerate(errors_m):
            if metres is not None:
                lon, lat, _ = Geod(ellps="WGS84").fwd(queries.lon_deg[at], queries.lat_deg[at], 90.0, metres)
                writer.writerow([queries.id[at], repr(lat), repr(lon)])
    return queries.id[: len(errors_m)]


def tables_of(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*.*")) if path.name != "run.lock"}


# --- made


def test_choices_and_defaults_are_those_of_the_core():
    from terrainav.terrainav_plugin.processing.benchmarks import MakeBenchmark, ScoreBenchmark

    asked, judged = (algorithm(listed=True).create() for algorithm in (MakeBenchmark, ScoreBenchmark))
    assert tuple(asked.parameterDefinition("SPLIT").options()) == SPLITS
    assert judged.parameterDefinition("METHOD").options() == list(METHODS)
    assert tuple(judged.parameterDefinition("PART").options()) == tuple(PARTS)
    usual = BenchmarkSettings(MISSION, (AIR,), AIR)
    assert [
        asked.parameterDefinition(name).defaultValue() for name in ("POSITIVE", "SEMI_POSITIVE", "TILE_OVERLAP")
    ] == [usual.positive_iou, usual.semi_positive_iou, 100.0 * usual.tile_overlap]


def test_it_is_the_benchmark_that_the_core_makes(made, mission_file, tmp_path):
    folder, feedback = tmp_path / "out", Feedback()
    asked = {
        "MISSION": mission_file,
        "QUERIES": "air=world\nmap=world:roadmap\n",
        "REFERENCE": "air=world",
        "SPLIT": "none",
        "FOLDER": str(folder),
    }
    counted = run("makebenchmark", feedback, **asked, DRY_RUN=True)
    assert not folder.exists()
    assert any(line.startswith("queries/map: map=world:roadmap; images: ") for line in feedback.lines)
    found = run("makebenchmark", **asked)
    benchmark = Benchmark.read(folder)
    assert tables_of(folder) == tables_of(made)
    for number in ("QUERY_COUNT", "TILE_COUNT", "IMAGES", "REQUESTS"):
        assert counted[number] == found[number]
    assert (found["QUERY_COUNT"], found["TILE_COUNT"]) == (len(benchmark.queries), len(benchmark.references))
    assert found["FAILED"] == 0
    # Again, which goes on with what is there.
    again = Feedback()
    assert run("makebenchmark", again, **asked)["QUERY_COUNT"] == found["QUERY_COUNT"]
    assert any(line.startswith("0 images written") for line in again.lines)


def test_buildings_of_the_reference_give_masks_and_figures(mission_file, tmp_path, without_matplotlib):
    """Answers are the priors, and the judge renders the buildings there."""
    mission = Mission.load(mission_file)
    west, south, east, north = mission.area.bounds.edges_deg
    lon, lat = np.meshgrid(np.linspace(west, east, 6), np.linspace(south, north, 6))
    corners = ((0, 0), (1e-4, 0), (1e-4, 1e-4), (0, 1e-4), (0, 0))
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Polygon", "coordinates": [[[x + dx, y + dy] for dx, dy in corners]]},
            "properties": {"height": 7},
        }
        for x, y in zip(lon.ravel().tolist(), lat.ravel().tolist())
    ]
    houses = tmp_path / "houses.geojson"
    houses.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    mission.replace(elevation=("20",)).save(tmp_path / "level.json")
    folder = tmp_path / "out"
    asked = {"MISSION": str(tmp_path / "level.json"), "SPLIT": "none", "FOLDER": str(folder), "REFERENCE": "air=world"}
    run("makebenchmark", **asked, QUERIES="air=world", REFERENCE_BUILDINGS=f" {houses} ;")
    assert (folder / "reference" / "buildings" / houses.name).read_bytes() == houses.read_bytes()
    found = run("scorebenchmark", BENCHMARK=str(folder), METHOD="prior", FOLDER=str(tmp_path / "scores"))
    assert 0.0 < found["MASK_IOU"] < 1.0
    assert 0.0 <= found["POSE_2"] <= found["POSE_3"] <= found["POSE_5"] <= 1.0


def test_rasters_of_the_project_are_queries_and_reference(made, mission_file, tmp_path):
    """By their files; a layer that is none is drawn by QGIS."""
    path = made / Benchmark.read(made).mosaic.file
    layer = QgsRasterLayer(str(path), "NAIP: 2014/7", "gdal")
    QgsProject.instance().addMapLayer(layer)
    asked = {"MISSION": mission_file, "SPLIT": "none", "FOLDER": str(tmp_path / "out"), "MARGIN": 0.0}
    run("makebenchmark", **asked, QUERY_LAYERS=[layer.id()], REFERENCE_LAYER=layer.id())
    about = json.loads((tmp_path / "out" / "benchmark.json").read_text())
    assert about["imageries"] == [f"NAIP-2014-7={path}"]
    assert about["reference"] == f"NAIP-2014-7={path}"


def test_queries_beyond_a_raster_are_left_out_where_that_is_asked_for(made, mission_file, tmp_path):
    path = made / Benchmark.read(made).mosaic.file
    layer = QgsRasterLayer(str(path), "ortho", "gdal")
    QgsProject.instance().addMapLayer(layer)
    mission = Mission.load(mission_file)
    north, west, south, east = (mission.area.bounds.edges_deg[at] for at in (3, 0, 1, 2))
    corner = Points(
        ((north, west, 60.0), ((north + south) / 2.0, (west + east) / 2.0, 60.0), (north + 0.1, east, 60.0))
    )
    mission.replace(area=corner).save(tmp_path / "corner.json")
    asked = {"MISSION": str(tmp_path / "corner.json"), "SPLIT": "none", "FOLDER": str(tmp_path / "out")}
    asked.update(QUERY_LAYERS=[layer.id()], REFERENCE_LAYER=layer.id(), DRY_RUN=True)
    feedback = Feedback()
    found = run("makebenchmark", feedback, **asked, INSIDE=True)
    left_out = [line for line in feedback.lines if "left out, as they show ground beyond the imagery" in line]
    assert len(left_out) == 1
    assert int(left_out[0].rpartition(" ")[2]) == 3 - found["QUERY_COUNT"] >= 1


def test_imagery_without_a_name_is_called_as_its_source(mission_file, tmp_path):
    asked = {"MISSION": mission_file, "QUERIES": "Synthetic (offline)", "REFERENCE": "world", "SPLIT": "none"}
    feedback = Feedback()
    run("makebenchmark", feedback, **asked, FOLDER=str(tmp_path / "out"), DRY_RUN=True)
    assert [line.partition(":")[0] for line in feedback.lines if line.startswith("queries/")] == [
        "queries/Synthetic-offline"
    ]


def test_without_imagery_queries_are_those_of_the_mission(tmp_path):
    file = tmp_path / "mission.json"
    MISSION.replace(map_types=("satellite", "roadmap")).save(str(file))
    asked = {"MISSION": str(file), "REFERENCE": "air=world", "FOLDER": str(tmp_path / "out")}
    # Four images are too few for parts that share no ground, which is told at once.
    with pytest.raises(QgsProcessingException, match=r"take an area [0-9,]+ m long or more, or split same-area"):
        run("makebenchmark", Feedback(), **asked, DRY_RUN=True)
    feedback = Feedback()
    run("makebenchmark", feedback, **asked, SPLIT="none", DRY_RUN=True)
    assert [line.partition(":")[0] for line in feedback.lines if line.startswith("queries/")] == [
        "queries/satellite",
        "queries/roadmap",
    ]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"REFERENCE": ""}, "0 references given: needs one, a raster or an imagery by name"),
        ({"QUERIES": "a=world\na=world:roadmap"}, "imagery 'a': is named twice"),
        ({"TILES": "wide"}, "widths of tiles 'wide': must be numbers, such as 200 400"),
        ({"TRAIN": 0.5, "SPLIT": "same-area"}, "must add up to 1"),
        ({"QUERIES": "a=nowhere.tif"}, "nowhere.tif"),
    ],
)
def test_what_cannot_be_made_is_one_line(mission_file, tmp_path, wrong, said):
    asked = {"MISSION": mission_file, "REFERENCE": "air=world", "FOLDER": str(tmp_path / "out")}
    assert said in refusal("makebenchmark", **{**asked, **wrong})


class Cancelling(Feedback):
    """Cancels as soon as something is done."""

    def __init__(self):
        super().__init__()
        self.progressChanged.connect(lambda percent: self.cancel() if percent > 0 else None)


def test_cancelled_it_goes_on_where_it_was(made, mission_file, tmp_path):
    asked = {"MISSION": mission_file, "QUERIES": str(AIR) + "\n" + str(MAP), "REFERENCE": str(AIR)}
    asked.update(SPLIT="none", FOLDER=str(tmp_path / "out"))
    feedback = Cancelling()
    found = run("makebenchmark", feedback, **asked)
    assert "MOSAIC" not in found
    assert any(line.startswith("Stopped") for line in feedback.warnings)
    run("makebenchmark", **asked)
    assert tables_of(tmp_path / "out") == tables_of(made)


# --- judged


@pytest.mark.thorough
def test_a_baseline_finds_queries_of_the_reference_itself(made, tmp_path):
    feedback = Feedback()
    found = run("scorebenchmark", feedback, BENCHMARK=str(made), METHOD="ncc", FOLDER=str(tmp_path / "ncc"))
    figures = json.loads((tmp_path / "ncc" / "scores.json").read_text())["groups"]["all"]
    by_name = {one["name"]: one["value"] for one in figures}
    assert found["QUERY_COUNT"] == by_name["queries"]
    assert (found["WITHIN_5"], found["MEDIAN_M"]) == (by_name["within 5 m"], by_name["position"])
    assert found["WITHIN_5"] >= 0.5
    assert (tmp_path / "ncc" / "index.html").samefile(found["HTML"])
    assert any(
        line.startswith("recall@1: all ") and "a right tile among the first 1" in line for line in feedback.lines
    )


@pytest.fixture
def without_matplotlib(monkeypatch):
    there = packages.find_spec
    monkeypatch.setattr(packages, "find_spec", lambda name: None if name == "matplotlib" else there(name))


def test_without_matplotlib_there_are_figures_and_a_warning(made, tmp_path, without_matplotlib):
    feedback = Feedback()
    found = run("scorebenchmark", feedback, BENCHMARK=str(made), METHOD="middle", FOLDER=str(tmp_path / "out"))
    assert feedback.warnings == ["The page has no diagrams: QGIS's Python lacks the package matplotlib."]
    assert found["MEDIAN_M"] > 0.0
    assert "<img" not in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    assert not list((tmp_path / "out").glob("*.png"))


def test_answers_without_positions_have_figures_and_no_map(made, tmp_path):
    benchmark, path = Benchmark.read(made), tmp_path / "ranks.csv"
    path.write_text(f"query,references\n{benchmark.queries.id[0]},{benchmark.references.id[0]}\n")
    feedback = Feedback()
    found = run("scorebenchmark", feedback, BENCHMARK=str(made), PREDICTIONS=str(path), FOLDER=str(tmp_path / "o"))
    assert "ERRORS" not in found
    assert "RECALL_1" in found
    assert feedback.warnings == ["The answers have no positions: there are no errors to show on the map."]


def test_what_cannot_be_judged_is_one_line(made, tmp_path, monkeypatch):
    assert "is not a benchmark" in refusal("scorebenchmark", BENCHMARK=str(tmp_path))
    assert "was made without parts" in refusal("scorebenchmark", BENCHMARK=str(made), PART="test")
    monkeypatch.setitem(sys.modules, "cv2", None)
    assert "OpenCV, which finds and matches features, is not installed" in refusal(
        "scorebenchmark", BENCHMARK=str(made), METHOD="sift"
    )


def run_and_load(name, **parameters):
    """Run an algorithm as its window does, which adds the results to the project."""
    import processing

    context = QgsProcessingContext()
    context.setProject(QgsProject.instance())
    return processing.runAndLoadResults(f"terrainav:{name}", parameters, feedback=Feedback(), context=context)


def length_drawn(lines, context):
    """Metres of the line that a symbol draws for the feature of a context."""
    start, end = QgsExpression(lines.geometryExpression()).evaluate(context).asPolyline()
    return Geod(ellps="WGS84").inv(start.x(), start.y(), end.x(), end.y())[2]


def test_errors_are_on_the_map_in_the_group_of_the_benchmark(
    made, tmp_path, without_matplotlib, iface, screenshot, wait_until_drawn
):
    # The benchmark's own folder is named by its group.
    folder, path = tmp_path / "fields", tmp_path / "mine.csv"
    shutil.copytree(made, folder)
    predictions_of(folder, path, [60.0])
    run_and_load("scorebenchmark", BENCHMARK=str(folder), PREDICTIONS=str(path))
    # Judged anew, the same layers show what is true now.
    metres = [0.5, 2.0, 4.0, 8.0, 15.0, 60.0, None]
    named = predictions_of(folder, path, metres)
    run_and_load("scorebenchmark", BENCHMARK=str(folder), PREDICTIONS=str(path))
    (group,) = QgsProject.instance().layerTreeRoot().children()
    assert group.name() == "TerrAInav: fields"
    *errors, reference = (node.layer() for node in group.children())
    assert {layer.name() for layer in errors} == {"fields: Errors of mine, air", "fields: Errors of mine, map"}
    assert (reference.name(), reference.isValid()) == ("fields: Reference", True)
    assert len(QgsProject.instance().mapLayers()) == 3
    shown, lengths = {}, {}
    for layer in errors:
        assert {feature["imagery"] for feature in layer.getFeatures()} == {layer.name().rpartition(", ")[2]}
        context = QgsExpressionContext(QgsExpressionContextUtils.globalProjectLayerScopes(layer))
        for feature in layer.getFeatures():
            context.setFeature(feature)
            rules = layer.renderer().rootRule().children()
            (rule,) = (one for one in rules if one.filter().evaluate(context))
            shown[feature["query"]] = rule.label()
            if rule.label() != "not answered":
                lengths[feature["query"]] = length_drawn(rule.symbol().symbolLayer(0), context)
    classes = [
        "up to 1 m",
        "1 to 3 m",
        "3 to 5 m",
        "5 to 10 m",
        "10 to 20 m",
        "more than 20 m",
        "not answered",
    ]
    assert [shown[name] for name in named] == classes
    assert set(shown.values()) == set(classes)
    # From the true place to that of the answer.
    np.testing.assert_allclose([lengths[name] for name in named[:-1]], metres[:-1], atol=1e-3)
    iface.mapCanvas().setDestinationCrs(reference.crs())
    iface.mapCanvas().setExtent(reference.extent())
    wait_until_drawn()
    screenshot("benchmark-errors")


def test_errors_of_one_method_at_a_time_are_seen(made, tmp_path, without_matplotlib):
    path = tmp_path / "mine.csv"
    predictions_of(made, path, [60.0])
    run_and_load("scorebenchmark", BENCHMARK=str(made), METHOD="middle", FOLDER=str(tmp_path / "middle"))
    run_and_load("scorebenchmark", BENCHMARK=str(made), PREDICTIONS=str(path), FOLDER=str(tmp_path / "mine"))
    (group,) = QgsProject.instance().layerTreeRoot().children()
    seen = {node.name() for node in group.children() if node.isVisible()}
    assert seen == {f"{made.name}: {title}" for title in ("Errors of mine, air", "Errors of mine, map", "Reference")}
    assert len(group.children()) == 5


def test_layers_of_the_user_s_own_stay_as_they_are(made, tmp_path, without_matplotlib):
    project = QgsProject.instance()
    own = QgsRasterLayer(str(made / Benchmark.read(made).mosaic.file), "mine", "gdal")
    project.addMapLayer(own)
    run_and_load("scorebenchmark", BENCHMARK=str(made), METHOD="middle", FOLDER=str(tmp_path / "out"))
    group, mine = project.layerTreeRoot().children()
    assert mine.layer() is own
    names = {f"{made.name}: Errors of middle, {imagery}" for imagery in ("air", "map")}
    assert {node.name() for node in group.children()} == names


# --- from toolbar and menu


def test_the_panel_s_mission_is_asked_for_the_rest(desk, screenshot):
    desk.enter_coarse_mission()
    desk.session.settings.missions_folder = str(desk.folder.parent)
    try:
        desk.plugin.actions["make_benchmark"].trigger()
        windows = desk.session.benchmarks
        desk.wait(lambda: bool(windows.windows))
        (dialog,) = windows.windows
        asked = dialog.createProcessingParameters()
        assert Mission.load(asked["MISSION"]) == desk.session.planned.mission
        assert asked["FOLDER"] == str(desk.folder.parent / "benchmark-1")
        # What the mission says is not asked again.
        assert {"QUERIES", "REFERENCE", "MISSION", "SPLIT"} <= set(dialog.mainWidget().wrappers)
        assert not {"EXTENT", "CAMERA", "AGL", "SOURCE"} & set(dialog.mainWidget().wrappers)
        screenshot("benchmark-make", dialog)
        dialog.setParameters({**asked, "REFERENCE": "map=world:roadmap", "DRY_RUN": True})
        ended = []
        dialog.algorithmFinished.connect(lambda done, results: ended.append((done, results)))
        dialog.runButton().click()
        desk.wait(lambda: bool(ended))
        assert ended[0][0]
        assert ended[0][1]["QUERY_COUNT"] == len(desk.session.planned.plan)
        screenshot("benchmark-counted", dialog)
    finally:
        desk.session.settings.missions_folder = ""
        desk.session.benchmarks.close()
    settle()
    assert sip.isdeleted(dialog)


def test_without_the_provider_there_is_a_line(desk):
    QgsApplication.processingRegistry().removeProvider("terrainav")
    try:
        desk.plugin.actions["score_benchmark"].trigger()
    finally:
        desk.plugin.initProcessing()
    assert desk.session.benchmarks.windows == []
    assert any("one is not enabled" in text for text in desk.messages())


def test_what_is_wrong_in_the_panel_is_said_first(desk):
    desk.plugin.actions["make_benchmark"].trigger()
    assert desk.session.benchmarks.windows == []
    assert any("No benchmark yet." in text for text in desk.messages())


def test_a_benchmark_that_is_made_is_offered_to_be_scored(desk, made, tmp_path, without_matplotlib, screenshot):
    windows = desk.session.benchmarks
    windows._made(True, {"FOLDER": str(made), "MOSAIC": "m", "QUERY_COUNT": 12, "TILE_COUNT": 3456, "FAILED": 0})
    assert desk.messages() == ["core: 12 queries, and 3,456 tiles of the reference."]
    desk.click(desk.buttons_in_message_bar()["Score"])
    (dialog,) = windows.windows
    asked = dialog.createProcessingParameters()
    assert asked["BENCHMARK"] == str(made)
    screenshot("benchmark-score", dialog)
    ended = []
    dialog.setParameters({**asked, "METHOD": "middle", "FOLDER": str(tmp_path / "scores")})
    dialog.algorithmFinished.connect(lambda done, results: ended.append((done, results)))
    dialog.runButton().click()
    desk.wait(lambda: bool(ended))
    assert ended[0][0]
    names = {f"{made.name}: {title}" for title in ("Errors of middle, air", "Errors of middle, map", "Reference")}
    assert set(desk.layer_names()) == names
    assert desk.layer(f"{made.name}: Reference").isValid()
    windows.close()
    settle()
    assert sip.isdeleted(dialog)
