"""The provider's algorithms in the real application: alone, in batches and models, on the main thread and beside it."""

from __future__ import annotations

import json
import time
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from qgis.core import (
    QgsApplication,
    QgsAuthMethodConfig,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsFeature,
    QgsFeatureRequest,
    QgsGeometry,
    QgsPointXY,
    QgsProcessingAlgRunnerTask,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingModelAlgorithm,
    QgsProcessingModelChildAlgorithm,
    QgsProcessingModelChildParameterSource,
    QgsProcessingModelOutput,
    QgsProcessingModelParameter,
    QgsProcessingParameterExtent,
    QgsProject,
    QgsRasterLayer,
    QgsVectorLayer,
)
from qgis.PyQt import sip
from qgis.PyQt.QtCore import QDateTime, Qt
from qgis.PyQt.QtGui import QImage
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.fields import declared_fields
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.lens import Lens
from terrainav.core.geodesy.mercator import HALF_WORLD_M
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.cameras import add_camera, camera_named
from terrainav.core.mission.estimate import OFFLINE, estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import FLAT_PARTS, REALISM_PARTS
from terrainav.core.mission.plan import plan
from terrainav.core.poses.line import fly
from terrainav.core.poses.settings import LineFlight
from terrainav.terrainav_plugin import packages
from terrainav.terrainav_plugin.processing import imagery
from terrainav.terrainav_plugin.processing.choices import ChoiceParameter
from terrainav.terrainav_plugin.processing.provider import Provider

from tests.plugin.steps import PATIENCE_MS
from tests.plugin.transports import MASTER_PASSWORD
from tests.support.tileserver import TileServer

BOX = Box(35.16, -89.90, 35.156, -89.895)
EXTENT = "-89.90,-89.895,35.156,35.16 [EPSG:4326]"
#: Far longer than anything here takes.
NEVER_S = 60.0
NAMES = {
    *("plan", "posesalongline", "capture", "capturefailed", "accuracyreport"),
    *("clean", "split", "mosaic", "export", "makebenchmark", "scorebenchmark"),
}


@pytest.fixture(autouse=True)
def provider(plugin, tmp_path, monkeypatch):
    monkeypatch.setenv("TERRAINAV_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    return QgsApplication.processingRegistry().providerById("terrainav")


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


class Feedback(QgsProcessingFeedback):
    """Keeps what it is told, and in which thread."""

    def __init__(self):
        super().__init__(False)
        self.lines, self.warnings, self.errors = [], [], []

    def pushInfo(self, text):
        self.lines.append(text)

    def pushWarning(self, text):
        self.warnings.append(text)

    def reportError(self, text, fatalError=False):  # noqa: N803  as QGIS has it
        self.errors.append(text)


def run(name, feedback=None, **parameters):
    """Run an algorithm as a script does: on the main thread."""
    import processing

    return processing.run(f"terrainav:{name}", parameters, feedback=feedback or Feedback())


def refusal(name, **parameters):
    """What is said of parameters that are refused, on one line."""
    feedback = Feedback()
    with pytest.raises(QgsProcessingException) as refused:
        run(name, feedback, **parameters)
    # What is found out before the algorithm runs is told to the feedback alone.
    text = feedback.errors[0] if feedback.errors else str(refused.value)
    assert "\n" not in text
    return text


def run_in_background(name, qtbot, feedback=None, **parameters):
    """Run an algorithm as the toolbox does: on a thread of the task manager."""
    algorithm = QgsApplication.processingRegistry().createAlgorithmById(f"terrainav:{name}")
    context, feedback, ended = QgsProcessingContext(), feedback or QgsProcessingFeedback(False), []
    context.setProject(QgsProject.instance())
    task = QgsProcessingAlgRunnerTask(algorithm, parameters, context, feedback)
    task.executed.connect(lambda done, results: ended.append((done, results)))
    QgsApplication.taskManager().addTask(task)
    # The context has to outlive the task, which works with it to its very end.
    qtbot.waitUntil(lambda: bool(ended) and sip.isdeleted(task), timeout=int(1000 * NEVER_S))
    return (*ended[0], feedback)


def features_of(path_or_layer):
    layer = path_or_layer if isinstance(path_or_layer, QgsVectorLayer) else QgsVectorLayer(path_or_layer)
    assert layer.isValid()
    return list(layer.getFeatures())


def planned(mission):
    return plan(mission, named_source(mission.imagery.source).grid)


def memory_layer(kind, crs, geometries, fields="", rows=()):
    layer = QgsVectorLayer(f"{kind}?crs={crs}{fields}", "area", "memory")
    for index, wkt in enumerate(geometries):
        feature = QgsFeature(layer.fields())
        feature.setGeometry(QgsGeometry.fromWkt(wkt))
        if rows:
            feature.setAttributes(list(rows[index]))
        layer.dataProvider().addFeature(feature)
    layer.updateExtents()
    return layer


# --- the provider


def test_it_is_registered_with_help_for_everything(provider):
    assert {algorithm.name() for algorithm in provider.algorithms()} == NAMES
    for algorithm in provider.algorithms():
        assert algorithm.canExecute() == (True, "")
        for text in (
            algorithm.displayName(),
            algorithm.shortHelpString(),
            algorithm.shortDescription(),
            algorithm.group(),
        ):
            assert text
        assert len(algorithm.tags()) > 3
        assert algorithm.helpUrl().startswith("https://")
        # Those that Processing itself asks for, layers and files to be written, explain themselves.
        without = [p.name() for p in algorithm.parameterDefinitions() if not p.help() and not p.isDestination()]
        assert without == []
        assert not algorithm.flags() & algorithm.Flag.FlagNoThreading


def test_packages_that_are_missing_are_named(provider, monkeypatch):
    there = packages.find_spec
    monkeypatch.setattr(packages, "find_spec", lambda name: None if name in ("PIL", "matplotlib") else there(name))
    report, of_plan = (provider.algorithm(name).canExecute() for name in ("accuracyreport", "plan"))
    assert report == (False, "TerrAInav needs Python packages that this QGIS lacks: Pillow, matplotlib.")
    assert of_plan == (False, "TerrAInav needs Python packages that this QGIS lacks: Pillow.")


def test_own_sources_are_choices_of_the_copy_that_runs(provider):
    from terrainav.core.imagery.catalogue import add, described

    add("my-tiles", described("https://tiles.example.org/{z}/{x}/{y}.png"))
    listed = provider.algorithm("plan").parameterDefinition("SOURCE").options()
    copy = provider.algorithm("plan").create()
    runs = copy.parameterDefinition("SOURCE").options()
    assert "tiles.example.org [my-tiles]" not in listed
    assert "tiles.example.org [my-tiles]" in runs


def test_a_provider_that_is_taken_away_is_gone(plugin):
    registry = QgsApplication.processingRegistry()
    before = len(registry.algorithms())
    registry.removeProvider("terrainav")
    try:
        assert registry.providerById("terrainav") is None
        assert registry.algorithmById("terrainav:plan") is None
        assert len(registry.algorithms()) == before - len(NAMES)
    finally:
        plugin.initProcessing()
    assert isinstance(registry.providerById("terrainav"), Provider)


# --- plan


@pytest.mark.parametrize("empty", ["", None])
def test_an_empty_output_is_not_asked_for(tmp_path, empty):
    names = ("FOOTPRINTS", "CAPTURES", "FLIGHT", "MISSION_FILE", "EXPORT")
    results = run("plan", EXTENT=EXTENT, AGL=200, **dict.fromkeys(names, empty))
    assert not set(names) & set(results)
    assert results["IMAGES"] == len(planned(Mission(BOX, 200.0)))


def test_further_missions_are_in_the_file_of_the_plan(tmp_path):
    mission = Mission(BOX, 200.0)
    mission.replace(agl_m=150.0, airspeed_m_per_s=7.0).save(tmp_path / "low.json")
    file = tmp_path / "flight.csv"
    results = run(
        "plan", EXTENT=EXTENT, AGL=200, EXPORT=str(file), FURTHER_MISSIONS=[str(tmp_path / "low.json")], FOOTPRINTS=None
    )
    low = planned(mission.replace(agl_m=150.0))
    rows = file.read_text().splitlines()[1:]
    assert results["IMAGES"] == len(planned(mission))
    assert [row.partition(",")[0] for row in rows] == [*planned(mission).names, *low.names]


def test_plan_gives_what_the_core_plans(tmp_path):
    mission = Mission(BOX, 200.0, overlap_along=0.2, overlap_across=0.1, facing="north", start="2024-06-21T10:30:00Z")
    expected = planned(mission)
    feedback = Feedback()
    results = run(
        "plan",
        feedback,
        EXTENT=EXTENT,
        AGL=200,
        FRONT_OVERLAP=20,
        SIDE_OVERLAP=10,
        FACING="North",
        START="2024-06-21T10:30:00Z",
        FOOTPRINTS="memory:",
        CAPTURES="memory:",
        FLIGHT="memory:",
        MISSION_FILE=str(tmp_path / "m.json"),
        EXPORT=str(tmp_path / "plan.csv"),
    )
    assert Mission.load(str(tmp_path / "m.json")) == mission
    assert len((tmp_path / "plan.csv").read_text().splitlines()) == len(expected) + 1
    found = features_of(results["FOOTPRINTS"])
    assert [feature["name"] for feature in found] == list(expected.names)
    west, south, east, north = expected.edges
    for index, feature in enumerate(found):
        box = feature.geometry().boundingBox()
        edges = (box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum())
        np.testing.assert_allclose(edges, [e[index] for e in (west, south, east, north)], rtol=0, atol=1e-6)
        assert feature.geometry().isGeosValid()
    for name, values in (
        ("lat_deg", expected.lat_deg),
        ("lon_deg", expected.lon_deg),
        ("column", expected.column),
        ("row", expected.row),
        ("left_px", expected.windows.left_px),
        ("width_px", expected.frames.width_px),
        ("time_s", expected.times_s),
    ):
        assert [feature[name] for feature in found] == np.asarray(values).tolist()
    start = QDateTime.fromString("2024-06-21T10:30:00Z", Qt.DateFormat.ISODate)
    assert [start.msecsTo(feature["time"]) for feature in found] == [
        round(1000.0 * seconds) for seconds in expected.times_s.tolist()
    ]
    points = [feature.geometry().asPoint() for feature in features_of(results["CAPTURES"])]
    np.testing.assert_allclose([point.x() for point in points], expected.lon_deg / 180.0 * HALF_WORLD_M, rtol=1e-12)
    (line,) = features_of(results["FLIGHT"])
    assert line["length_m"] == expected.direct.distance_m
    assert line.geometry().constGet().vertexCount() == len(expected)
    summary = estimate(expected, OFFLINE)
    assert results["IMAGES"] == len(expected)
    assert results["COVERAGE"] == 100.0 * summary.covered_share
    assert results["LEAST_FRONT_OVERLAP"] == 100.0 * summary.least_overlap_along
    assert (results["TILES"], results["CHOSEN_ZOOM"]) == (summary.unique_tiles, expected.zoom)
    assert (results["FLIGHT_S"], results["ERROR_BOUND"]) == (summary.flight_s, summary.accuracy.bound_px)
    assert results["FILE_BYTES"] == summary.output_bytes
    assert (results["REQUESTED_GSD"], results["DELIVERED_GSD"]) == (
        summary.requested_gsd_m_per_px,
        summary.delivered_gsd_m_per_px,
    )
    assert any(line.startswith("images: ") for line in feedback.lines)


def test_a_polygon_with_a_hole_in_any_crs_is_the_same_area():
    ring = ((-89.90, 35.16), (-89.89, 35.16), (-89.89, 35.15), (-89.897, 35.152))
    hole = ((-89.895, 35.157), (-89.893, 35.157), (-89.893, 35.155))
    text = ", ".join("({})".format(", ".join(f"{lon} {lat}" for lon, lat in (*part, part[0]))) for part in (ring, hole))
    expected = planned(Mission(Polygon((ring, hole)), 150.0))
    geographic = memory_layer("Polygon", "EPSG:4326", [f"Polygon ({text})"])
    results = run("plan", AREA=geographic, AGL=150, FOOTPRINTS="memory:")
    assert [feature["name"] for feature in features_of(results["FOOTPRINTS"])] == list(expected.names)
    import processing

    projected = processing.run(
        "native:reprojectlayer", {"INPUT": geographic, "TARGET_CRS": "EPSG:32616", "OUTPUT": "memory:"}
    )["OUTPUT"]
    results = run("plan", AREA=projected, AGL=150, FOOTPRINTS="memory:")
    found = features_of(results["FOOTPRINTS"])
    assert len(found) == len(expected)
    # Corners come back from the other CRS to within nanometres, and edges bend by less than a pixel here.
    np.testing.assert_allclose([feature["lat_deg"] for feature in found], expected.lat_deg, atol=2e-5)


def test_points_with_heights_and_yaws():
    places = [(35.16, -89.90, 80.0, 10.0), (35.15, -89.89, 150.0, -45.0)]
    layer = memory_layer(
        "Point",
        "EPSG:4326",
        [f"Point ({lon} {lat})" for lat, lon, _, _ in places],
        "&field=h:double&field=turn:double",
        [(agl, yaw) for _, _, agl, yaw in places],
    )
    results = run("plan", AREA=layer, AGL_FIELD="h", YAW_FIELD="turn", FOOTPRINTS="memory:")
    found = features_of(results["FOOTPRINTS"])
    mission = Mission(Points(tuple(p[:3] for p in places), tuple(p[3] for p in places)), 80.0)
    expected = planned(mission)
    assert [feature["name"] for feature in found] == list(expected.names)
    assert [feature["agl_m"] for feature in found] == [80.0, 150.0]
    assert [feature["yaw_deg"] for feature in found] == [10.0, -45.0]
    assert "COVERAGE" not in results
    results = run("plan", AREA=layer, AGL=99, FOOTPRINTS="memory:")
    assert {feature["agl_m"] for feature in features_of(results["FOOTPRINTS"])} == {99.0}


def test_poses_along_a_line_are_an_area_with_attitudes_and_times():
    layer = memory_layer("LineString", "EPSG:4326", ["LineString (-89.9 35.15, -89.9 35.154, -89.896 35.154)"])
    log = Feedback()
    made = run(
        *("posesalongline", log),
        INPUT=layer,
        SPEED=12,
        EVERY_S=2,
        AGL=120,
        FIXED_CAMERA=True,
        START="2024-06-21T10:30:00Z",
        OUTPUT="memory:",
    )["OUTPUT"]
    assert any("misses the corners of its line by up to 13.0 m" in line for line in log.lines)
    corners = np.array([(35.15, -89.9, 120.0), (35.154, -89.9, 120.0), (35.154, -89.896, 120.0)])
    start_s = 1_718_965_800.0
    expected = fly([corners], LineFlight(12.0, every_s=2.0, fixed_camera=True), start_s).points
    results = run(
        "plan",
        AREA=made,
        AGL_FIELD="agl_m",
        YAW_FIELD="yaw_deg",
        ROLL_FIELD="roll_deg",
        TIME_FIELD="time",
        TILT=10,
        FOOTPRINTS="memory:",
    )
    found = features_of(results["FOOTPRINTS"])
    assert len(found) == len(expected.poses) > 30
    np.testing.assert_allclose([one["yaw_deg"] for one in found], expected.yaws_deg, atol=1e-9)
    np.testing.assert_allclose([one["roll_deg"] for one in found], expected.rolls_deg, atol=1e-9)
    assert {one["tilt_deg"] for one in found} == {10.0}
    times = [one["time"].toMSecsSinceEpoch() / 1000.0 for one in found]
    assert times == list(expected.times_s)
    assert times[0] == start_s


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({}, "must be either in seconds or in metres"),
        ({"EVERY_S": 1, "EVERY_M": 1}, "must be either in seconds or in metres"),
        ({"EVERY_S": 1, "START": "noon"}, "'noon': must be UTC as 2024-06-21T10:30:00Z"),
    ],
)
def test_a_flight_along_a_line_that_is_none(parameters, words):
    layer = memory_layer("LineString", "EPSG:4326", ["LineString (0 0, 0 1)"])
    assert words in refusal("posesalongline", INPUT=layer, OUTPUT="memory:", **parameters)


def test_a_field_that_a_layer_does_not_have_is_named():
    layer = memory_layer("Point", "EPSG:4326", ["Point (0 0)"], "&field=a:double", [(90.0,)])
    assert refusal("plan", AREA=layer, AGL_FIELD="height").endswith("has no field height")


def test_rows_are_aligned_and_the_mission_file_says_how(tmp_path):
    area = memory_layer(
        "Polygon",
        "EPSG:4326",
        ["Polygon ((-89.9 35.16, -89.898 35.165, -89.897 35.165, -89.899 35.16, -89.9 35.16))"],
    )
    path, feedback = tmp_path / "mission.json", Feedback()
    # No layer need be asked for.
    made = run("plan", feedback, AREA=area, AGL=100, ALIGN="shortest", MISSION_FILE=str(path))
    as_it_was = run("plan", AREA=area, AGL=100)
    assert made["FLIGHT_M"] < as_it_was["FLIGHT_M"]
    assert "FOOTPRINTS" not in as_it_was
    azimuth = Mission.load(path).flight.row_azimuth_deg
    assert azimuth != 90.0
    assert any(f"row azimuth {azimuth:g}°" in line and "shorter than 90°" in line for line in feedback.lines)
    again = run("plan", AREA=area, AGL=100, ROW_AZIMUTH=azimuth)
    assert again["FLIGHT_M"] == made["FLIGHT_M"]
    places = memory_layer("Point", "EPSG:4326", ["Point (0 0)"])
    assert "points have no rows" in refusal("plan", AREA=places, ALIGN="longest-side")


def test_a_tilt_is_said_once():
    layer = memory_layer("Point", "EPSG:4326", ["Point (0 0)"], "&field=a:double", [(-90.0,)])
    said = refusal("plan", AREA=layer, TILT_FIELD="a", GIMBAL_PITCH_FIELD="a", FOOTPRINTS="memory:")
    assert said.endswith("needs one of the two")
    found = features_of(run("plan", AREA=layer, GIMBAL_PITCH_FIELD="a", TILT=9, FOOTPRINTS="memory:")["FOOTPRINTS"])
    assert [feature["tilt_deg"] for feature in found] == [0.0]


def test_camera_attitude_and_antimeridian():
    results = run(
        "plan",
        COORDS="-16.5_179.9905_-16.505_-179.993_300",
        CAMERA="DJI Mini 2",
        TILT=30,
        ACCEPT_ERROR=True,
        FOOTPRINTS="memory:",
        FLIGHT="memory:",
    )
    found = features_of(results["FOOTPRINTS"])
    assert {feature["tilt_deg"] for feature in found} == {30.0}
    # 4000 px of a lens of 4.49 mm behind a sensor of 6.3 mm.
    assert results["REQUESTED_GSD"] == pytest.approx(300.0 * 6.3 / 4.49 / 4000, rel=0.01)
    parts = [feature.geometry().constGet().numGeometries() for feature in found]
    assert set(parts) == {1, 2}
    for feature in found:
        assert feature.geometry().isGeosValid()
        assert feature.geometry().boundingBox().xMaximum() <= HALF_WORLD_M + 1e-6
        assert -180.0 <= feature["lon_deg"] <= 180.0
    (line,) = features_of(results["FLIGHT"])
    assert line.geometry().boundingBox().xMaximum() <= HALF_WORLD_M + 1e-6
    assert line.geometry().constGet().numGeometries() > 1


def test_every_field_of_a_mission_has_its_parameter(tmp_path):
    path = tmp_path / "mission.json"
    run(
        "plan",
        EXTENT=EXTENT,
        AGL=200,
        FOV=60,
        ASPECT="16:9",
        FRONT_OVERLAP=30,
        SIDE_OVERLAP=20,
        ROW_AZIMUTH=110,
        CROSSHATCH=True,
        ORDER="one-way",
        MAP_TYPES=["roadmap", "terrain"],
        FORMAT="png",
        YAW=5,
        TILT=4,
        ROLL=3,
        GROUND_HEIGHT=80,
        ERROR_BUDGET=2,
        ACCEPT_ERROR=True,
        FRAME="camera",
        RESAMPLING="lanczos",
        IMAGE_PX=900,
        MAX_PX=800,
        UPSAMPLE=True,
        IMG_SIZE="256 192 3",
        WIND_SPEED=4,
        WIND_FROM=90,
        TURBULENCE=0.1,
        AIRSPEED=20,
        START="2024-06-21T10:30:00Z",
        SEED=7,
        MAX_IMAGES=5000,
        MISSION_FILE=str(path),
        FOOTPRINTS="memory:",
    )
    from terrainav.core.mission.flight.wind import Wind

    assert Mission.load(str(path)) == Mission(
        BOX,
        200.0,
        Camera(60.0, 16 / 9),
        overlap_along=0.3,
        overlap_across=0.2,
        row_azimuth_deg=110.0,
        crosshatch=True,
        order="one-way",
        map_types=("roadmap", "terrain"),
        image_format="png",
        yaw_deg=5.0,
        tilt_deg=4.0,
        roll_deg=3.0,
        ground_height_m=80.0,
        error_budget_px=2.0,
        accept_error=True,
        frame="camera",
        resampling="lanczos",
        image_px=900,
        max_px=800,
        upsample=True,
        img_size=(256, 192, 3),
        wind=Wind(4.0, 90.0, 0.1, 7),
        airspeed_m_per_s=20.0,
        start="2024-06-21T10:30:00Z",
        seed=7,
        max_images=5000,
    )
    again = tmp_path / "again.json"
    run("plan", MISSION=str(path), MISSION_FILE=str(again), FOOTPRINTS="memory:")
    assert again.read_bytes() == path.read_bytes()


def test_the_lens_and_every_field_of_a_real_camera_have_a_parameter(provider):
    ids = {one.name() for one in provider.algorithm("plan").parameterDefinitions()}
    fields = [one for part in (Lens, *map(FLAT_PARTS.get, REALISM_PARTS)) for one in declared_fields(part)]
    assert {one.name_of_option.upper() for one in fields if one.name != "aspect_ratio"} <= ids


def test_the_lens_is_that_of_the_parameters_where_they_are_given(tmp_path):
    def lens(**parameters):
        path = tmp_path / "mission.json"
        run("plan", COORDS="35.15_-89.9_200", MISSION_FILE=str(path), FOOTPRINTS="memory:", **parameters)
        return Mission.load(str(path)).camera

    assert lens(FOV=70).is_ideal
    assert lens(FOV=70, K1=-0.2, P2=0.001, PRINCIPAL_X=0.01, RED_SCALE=0.001) == Camera(
        70.0, k1=-0.2, p2=0.001, principal_x=0.01, red_scale=0.001
    )
    assert lens(FOV=150, LENS="fisheye", K4=0.001) == Camera(150.0, lens="fisheye", k4=0.001)
    named = {"focal_px": 1000.0, "size_px": [1280, 960], "k1": -0.2, "k2": 0.05}
    add_camera("Mine", named)
    made = camera_named("Mine").camera
    assert made.k1 == -0.2
    assert lens(CAMERA="Mine") == made
    # A parameter replaces what the camera has; 0 is given, too.
    assert lens(CAMERA="Mine", K1=0, K3=0.01) == replace(made, k1=0.0, k3=0.01)
    assert "folds the image" in refusal("plan", COORDS="35.15_-89.9_200", FOV=100, K1=-0.9)


def test_values_that_are_drawn_are_attributes():
    parameters = {
        "EXTENT": EXTENT,
        "EXPOSURE": "manual",
        "EXPOSURE_MS": 1,
        "VARY": "exposure_ms=uniform(1,2); east_m=uniform(-3,3)",
    }
    results = run("plan", FOOTPRINTS="memory:", CAPTURES="memory:", **parameters)
    for name in ("FOOTPRINTS", "CAPTURES"):
        found = [(one["east_m"], one["exposure_ms"]) for one in features_of(results[name])]
        assert len(set(found)) == len(found) > 10
        assert all(-3.0 <= east <= 3.0 and 1.0 <= exposure <= 2.0 for east, exposure in found)


def test_coordinates_without_a_height_take_that_of_the_parameter():
    without = run("plan", COORDS="35.143_-89.876_35.139_-89.872", AGL=300)
    assert without == run("plan", COORDS="35.143_-89.876_35.139_-89.872_300")


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({}, "0 areas given"),
        ({"EXTENT": EXTENT, "COORDS": "1_2_3"}, "2 areas given"),
        ({"COORDS": "here"}, "here"),
        ({"EXTENT": EXTENT, "ASPECT": "wide"}, "aspect ratio 'wide': must be such as 4:3"),
        ({"EXTENT": EXTENT, "IMG_SIZE": "large"}, "image size 'large'"),
        ({"EXTENT": EXTENT, "ZOOM": 19, "GSD": 0.3}, "give one of the two"),
        ({"EXTENT": EXTENT, "OTHER_SOURCE": "nowhere"}, "source 'nowhere' is unknown"),
        ({"EXTENT": EXTENT, "OTHER_SOURCE": "qgis:layer/gone"}, "layer"),
        ({"EXTENT": EXTENT, "MAX_IMAGES": 2, "AGL": 50}, "2"),
        ({"EXTENT": EXTENT, "EXPORT": "/tmp/plan.doc"}, "must end in"),
        ({"MISSION": "/nowhere/mission.json"}, "/nowhere/mission.json"),
        (
            {"EXTENT": EXTENT, "FURTHER_MISSIONS": ["/nowhere/mission.json"]},
            "further missions: need the plan as a file",
        ),
    ],
)
def test_bad_input_gives_one_line(parameters, words):
    assert words in refusal("plan", FOOTPRINTS="memory:", **parameters)


def test_bad_input_fails_in_the_toolbox_and_is_no_cancellation(qtbot):
    """A batch of QGIS 3.44 leaves out the rows after one that is cancelled."""
    feedback = Feedback()
    algorithm = QgsApplication.processingRegistry().createAlgorithmById("terrainav:plan")
    context = QgsProcessingContext()
    parameters = {"COORDS": "35.14_-89.87_north", "FOOTPRINTS": "memory:"}
    assert not QgsProcessingAlgRunnerTask(algorithm, parameters, context, feedback).isCanceled()
    done, _, feedback = run_in_background("plan", qtbot, feedback, **parameters)
    assert not done
    assert feedback.errors[0].startswith("coordinates '35.14_-89.87_north': 'north' is not a number; expected")


#: Three squares, of which two share a side.
SQUARES = [
    f"Polygon (({w} {s}, {w + 0.003} {s}, {w + 0.003} {s + 0.003}, {w} {s + 0.003}, {w} {s}))"
    for w, s in ((-89.9, 35.1), (-89.897, 35.1), (-89.88, 35.11))
]


def corners_of(feature):
    return {(round(at.x(), 6), round(at.y(), 6)) for at in feature.geometry().vertices()}


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:32616"])
def test_separate_polygons_are_one_flight_and_those_that_touch_one_polygon(crs):
    layer = memory_layer("Polygon", "EPSG:4326", SQUARES)
    if crs != "EPSG:4326":
        import processing

        layer = processing.run("native:reprojectlayer", {"INPUT": layer, "TARGET_CRS": crs, "OUTPUT": "memory:"})[
            "OUTPUT"
        ]
    found = features_of(run("plan", AREA=layer, AGL=120, FOOTPRINTS="memory:")["FOOTPRINTS"])
    squares = [QgsGeometry.fromWkt(wkt) for wkt in SQUARES]
    systems = (QgsCoordinateReferenceSystem(code) for code in ("EPSG:4326", "EPSG:3857"))
    to_map = QgsCoordinateTransform(*systems, QgsProject.instance())
    for square in squares:
        square.transform(to_map)
    whole = QgsGeometry.unaryUnion(squares)
    covered = QgsGeometry.unaryUnion([feature.geometry() for feature in found])
    # GEOS finds every place of all three in an image, but for a pixel along the rims.
    assert whole.difference(covered.buffer(0.5, 1)).isEmpty()
    there = [one for one in found if one.geometry().intersects(squares[2])]
    assert 0 < len(there) < len(found)
    # Rows go on from one polygon to the next, and pairs of column and row occur once.
    assert len({(one["column"], one["row"]) for one in found}) == len(found)


def test_a_multipolygon_is_as_good_as_its_parts_in_a_layer():
    parts = ", ".join(SQUARES[at].removeprefix("Polygon ") for at in (0, 2))
    several = memory_layer("MultiPolygon", "EPSG:4326", [f"MultiPolygon ({parts})"])
    apart = memory_layer("Polygon", "EPSG:4326", [SQUARES[0], SQUARES[2]])
    one, other = (
        [
            feature["name"]
            for feature in features_of(run("plan", AREA=layer, AGL=120, FOOTPRINTS="memory:")["FOOTPRINTS"])
        ]
        for layer in (several, apart)
    )
    assert one == other


def test_images_over_a_layer_of_no_fly_areas_are_left_out():
    area = memory_layer("Polygon", "EPSG:4326", [SQUARES[0], SQUARES[2]])
    forbidden = "Polygon ((-89.899 35.101, -89.898 35.101, -89.898 35.102, -89.899 35.102, -89.899 35.101))"
    no_fly = memory_layer("Polygon", "EPSG:4326", [forbidden])
    asked = {"AREA": area, "AGL": 120, "FRONT_OVERLAP": 60, "SIDE_OVERLAP": 60, "FOOTPRINTS": "memory:"}
    whole = features_of(run("plan", **asked)["FOOTPRINTS"])
    left = features_of(run("plan", NO_FLY=no_fly, **asked)["FOOTPRINTS"])
    inside = QgsGeometry.fromWkt(forbidden)
    out = [one for one in whole if inside.contains(QgsGeometry.fromPointXY(QgsPointXY(one["lon_deg"], one["lat_deg"])))]
    assert out
    assert len(left) == len(whole) - len(out)
    assert {(one["column"], one["row"]) for one in left} == {(one["column"], one["row"]) for one in whole} - {
        (one["column"], one["row"]) for one in out
    }


def test_layers_without_polygons_are_no_areas():
    line = memory_layer("LineString", "EPSG:4326", ["LineString (0 0, 1 1)"])
    assert "has no polygons" in refusal("plan", AREA=line, FOOTPRINTS="memory:")
    whole = memory_layer("Polygon", "EPSG:4326", [SQUARES[0]])
    assert "images lie over no-fly areas" in refusal("plan", AREA=whole, NO_FLY=whole, AGL=120, FOOTPRINTS="memory:")


BOW = "Polygon ((465250 5247000, 465450 5247200, 465450 5247000, 465250 5247200, 465250 5247000))"
SOUND = "Polygon ((465250 5247000, 465450 5247000, 465450 5247200, 465250 5247200, 465250 5247000))"


@pytest.mark.parametrize(
    "check",
    [
        QgsFeatureRequest.InvalidGeometryCheck.GeometryAbortOnInvalid,
        QgsFeatureRequest.InvalidGeometryCheck.GeometrySkipInvalid,
        QgsFeatureRequest.InvalidGeometryCheck.GeometryNoCheck,
    ],
)
def test_polygons_are_checked_whatever_qgis_s_setting_says(check):
    """By the plugin: where QGIS's own check stops an algorithm in Python, the next call ends QGIS (3.22)."""
    import processing

    def ask(name, **parameters):
        context, feedback = QgsProcessingContext(), Feedback()
        context.setProject(QgsProject.instance())
        context.setInvalidGeometryCheck(check)
        try:
            return processing.run(f"terrainav:{name}", parameters, context=context, feedback=feedback), ""
        except QgsProcessingException as wrong:
            return None, feedback.errors[0] if feedback.errors else str(wrong)

    bow, sound = (memory_layer("Polygon", "EPSG:32632", [wkt]) for wkt in (BOW, SOUND))
    for parameters in ({"AREA": bow}, {"AREA": sound, "NO_FLY": bow}):
        found, words = ask("plan", AGL=100, FOOTPRINTS="memory:", **parameters)
        assert found is None
        assert "feature 1 is not a valid polygon (Self-intersection (465350, 5247100)): repair it" in words
    place = memory_layer("LineString", "EPSG:32632", ["LineString (465250 5247000, 465250 5247000)"])
    found, words = ask("posesalongline", INPUT=place, AGL=100, EVERY_M=20, OUTPUT="memory:")
    assert (found, words) == (None, "line 1: is a single place")
    found, _ = ask("plan", AREA=sound, AGL=100, FOOTPRINTS="memory:")
    assert found["IMAGES"] > 0


def test_mission_file_with_a_bow_tie_is_refused(tmp_path):
    bow = Polygon((((-89.9, 35.1), (-89.89, 35.11), (-89.89, 35.1), (-89.9, 35.11)),))
    Mission(bow, 120.0).save(tmp_path / "bow.json")
    words = refusal("plan", MISSION=str(tmp_path / "bow.json"), FOOTPRINTS="memory:")
    assert "area: polygon whose sides cross at latitude 35.105000, longitude -89.895000" in words


# --- capture


def tables(folder):
    return {path.parent.name: path.read_bytes() for path in folder.glob("*/meta_data.csv")}


def test_a_capture_over_qgis_network_is_the_same_on_the_main_thread_and_beside_it(server, tmp_path, qtbot):
    common = {"EXTENT": EXTENT, "AGL": 120, "OTHER_SOURCE": server.url_template}
    here = run("capture", FOLDER=str(tmp_path / "here"), **common)
    requests = sum(server.tile_requests.values())
    assert here["WRITTEN"] == here["TOTAL"] > 10
    assert (here["FAILED"], here["SKIPPED"]) == (0, 0)
    assert here["REQUESTS"] == requests
    assert QgsRasterLayer(here["MOSAIC"]).isValid()
    assert len(features_of(here["FOOTPRINTS"])) == here["TOTAL"]

    # What is in the cache is not asked for again: another folder of tiles.
    other = server.url_template + "?again"
    done, beside, _ = run_in_background(
        "capture", qtbot, **{**common, "OTHER_SOURCE": other, "FOLDER": str(tmp_path / "beside")}
    )
    assert done
    assert beside["WRITTEN"] == here["WRITTEN"]
    for path in (tmp_path / "here" / "satellite").glob("*.tif"):
        with Image.open(path) as one, Image.open(tmp_path / "beside" / "satellite" / path.name) as other_one:
            assert np.array_equal(np.asarray(one), np.asarray(other_one))
    table = Table.load(tmp_path / "here" / "satellite" / "meta_data.csv")
    assert set(table.status) == {"done"}
    again = run("capture", FOLDER=str(tmp_path / "here"), **common)
    assert (again["WRITTEN"], again["SKIPPED"]) == (0, here["WRITTEN"])


@pytest.mark.parametrize("load", [True, False])
def test_results_of_a_capture_are_added_to_the_project_where_that_is_wanted(server, tmp_path, load):
    """Named as in the panel; QGIS adds them once the algorithm has ended."""
    context = QgsProcessingContext()
    context.setProject(QgsProject.instance())
    algorithm = QgsApplication.processingRegistry().createAlgorithmById("terrainav:capture")
    parameters = {
        "EXTENT": EXTENT,
        "AGL": 120,
        "OTHER_SOURCE": server.url_template,
        "FOLDER": str(tmp_path),
        "LOAD": load,
    }
    results, done = algorithm.run(parameters, context, QgsProcessingFeedback())
    assert done
    wanted = {details.name: path for path, details in context.layersToLoadOnCompletion().items()}
    assert wanted == ({"Captured images": results["FOOTPRINTS"], "Satellite images": results["MOSAIC"]} if load else {})


def test_layers_of_two_captures_stand_in_two_groups_with_the_outlines_above(server, tmp_path):
    """As after a batch, whose layers have the same names; a second run into a folder adds nothing."""
    from processing.gui.Postprocessing import handleAlgorithmResults

    algorithm = QgsApplication.processingRegistry().createAlgorithmById("terrainav:capture")
    parameters = {"EXTENT": EXTENT, "AGL": 120, "OTHER_SOURCE": server.url_template}
    root = QgsProject.instance().layerTreeRoot()
    for name in ("one", "two", "one"):
        context = QgsProcessingContext()
        context.setProject(QgsProject.instance())
        _, done = algorithm.run({**parameters, "FOLDER": str(tmp_path / name)}, context, QgsProcessingFeedback())
        assert done
        assert handleAlgorithmResults(algorithm, context, QgsProcessingFeedback())
    found = {group.name(): [node.layer() for node in group.findLayers()] for group in root.findGroups()}
    assert set(found) == {"TerrAInav: one", "TerrAInav: two"}
    for layers in found.values():
        assert [layer.name() for layer in layers] == ["Captured images", "Satellite images"]
        # Outlines, through which the mosaic below is seen.
        assert layers[0].renderer().symbol().symbolLayer(0).brushStyle() == Qt.BrushStyle.NoBrush
    assert len(QgsProject.instance().mapLayers()) == 4


@pytest.mark.parametrize("beside", [False, True])
def test_a_capture_is_cancelled_and_goes_on(server, tmp_path, qtbot, beside):
    server.fail("stall")
    feedback = Feedback()
    from qgis.PyQt.QtCore import QTimer

    QTimer.singleShot(700, feedback.cancel)
    parameters = {
        "EXTENT": EXTENT,
        "AGL": 120,
        "OTHER_SOURCE": server.url_template,
        "FOLDER": str(tmp_path / "out"),
    }
    started = time.monotonic()
    if beside:
        run_in_background("capture", qtbot, feedback, **parameters)
    else:
        result = run("capture", feedback, **parameters)
        assert result["WRITTEN"] < result["TOTAL"]
        # What is captured is told at the beginning, and where it is.
        assert feedback.lines[0] == f"{result['TOTAL']} images into {tmp_path / 'out'}."
        assert f"of {result['TOTAL']} images. Enter {tmp_path / 'out'} as the folder" in feedback.warnings[-1]
    assert time.monotonic() - started < NEVER_S / 4
    server.heal()
    result = run("capture", **parameters)
    assert result["WRITTEN"] + result["SKIPPED"] == result["TOTAL"]
    assert result["FAILED"] == 0


@pytest.mark.parametrize("beside", [False, True])
def test_the_project_s_map_as_a_source(tmp_path, qtbot, beside):
    layer = memory_layer("Polygon", "EPSG:4326", ["Polygon ((-90 35, -89 35, -89 36, -90 36, -90 35))"])
    QgsProject.instance().addMapLayer(layer)
    parameters = {
        "COORDS": "35.158_-89.898_300",
        "OTHER_SOURCE": "qgis:project",
        "FOLDER": str(tmp_path / "out"),
    }
    if beside:
        done, result, _ = run_in_background("capture", qtbot, **parameters)
        assert done
    else:
        result = run("capture", **parameters)
    assert result["WRITTEN"] == 1
    # Copies of the project's layers are let go of, and by the main thread.
    qtbot.waitUntil(lambda: not imagery._keeper()._kept, timeout=PATIENCE_MS)


def test_failed_ones_are_named_and_captured_again(server, tmp_path, qtbot):
    server.fail("404", share=0.2)
    feedback = Feedback()
    first = run(
        "capture",
        feedback,
        EXTENT=EXTENT,
        AGL=100,
        OTHER_SOURCE=server.url_template,
        FOLDER=str(tmp_path / "out"),
    )
    assert 0 < first["FAILED"] < first["TOTAL"]
    assert any("404" in warning for warning in feedback.warnings)
    server.heal()
    again = run("capturefailed", DATASET=str(tmp_path / "out"))
    assert (again["TOTAL"], again["WRITTEN"], again["FAILED"]) == (first["FAILED"], first["FAILED"], 0)
    done, nothing, _ = run_in_background("capturefailed", qtbot, DATASET=str(tmp_path / "out"))
    assert done
    assert nothing["TOTAL"] == 0
    assert "holds no capture" in refusal("capturefailed", DATASET=str(tmp_path))


def test_terms_are_asked_for(tmp_path):
    with pytest.raises(QgsProcessingException, match="tile"):
        run(
            "capture",
            EXTENT="-90.2,-89.2,35,35.7 [EPSG:4326]",
            AGL=300,
            SOURCE="osm",
            FOLDER=str(tmp_path / "o"),
        )
    assert not (tmp_path / "o").exists()


def test_a_key_comes_out_of_the_authentication_database(server, tmp_path):
    manager = QgsApplication.authManager()
    manager.setMasterPassword(MASTER_PASSWORD, True)
    config = QgsAuthMethodConfig("Basic")
    config.setName("terrainav test")
    config.setConfig("password", "s3cret-key")
    stored = manager.storeAuthenticationConfig(config)
    assert stored[0] if isinstance(stored, tuple) else stored
    feedback = Feedback()
    try:
        result = run(
            "capture",
            feedback,
            COORDS="35.158_-89.898_120",
            OTHER_SOURCE=server.url_template + "?key={key}",
            AUTHCFG=config.id(),
            FOLDER=str(tmp_path / "out"),
        )
        said = refusal(
            "capture",
            COORDS="35.158_-89.898_120",
            OTHER_SOURCE=server.url_template + "?key={key}",
            AUTHCFG="1234567",
            FOLDER=str(tmp_path / "other"),
        )
        assert "1234567 does not exist" in said
    finally:
        manager.removeAuthenticationConfig(config.id())
    assert result["WRITTEN"] == 1
    assert any("key=s3cret-key" in path for path in server.requests)
    for path in (tmp_path / "out").rglob("*"):
        assert path.is_dir() or b"s3cret-key" not in path.read_bytes()
    assert not any("s3cret-key" in line for line in [*feedback.lines, *feedback.warnings])


# --- clean and report


def test_progress_of_several_map_types_is_that_of_all(tmp_path):
    feedback, shares = Feedback(), []
    feedback.progressChanged.connect(shares.append)
    folder = str(tmp_path / "out")
    run(
        "capture",
        feedback,
        EXTENT=EXTENT,
        AGL=200,
        MAP_TYPES=["satellite", "roadmap"],
        MAKE_MOSAIC=False,
        FOLDER=folder,
    )
    # The mosaic would have the rest.
    assert 0.0 < max(shares) <= 90.0


def test_cleaning_marks_moves_and_puts_back(tmp_path):
    folder = tmp_path / "out"
    run("capture", EXTENT=EXTENT, AGL=200, MAP_TYPES=["satellite", "roadmap"], FOLDER=str(folder))
    before = tables(folder)
    counted = run("clean", DATASET=str(folder), ENTROPY=8, ACTION="move", DRY_RUN=True)
    assert tables(folder) == before
    assert 0 < counted["REJECTED"] == counted["MOVED"] == counted["IMAGES"]
    assert 0.0 < counted["SUGGESTED"] < 8.0
    moved = run("clean", DATASET=str(folder), ENTROPY=8, ACTION="move")
    assert moved == counted
    assert len(list(folder.glob("*/rejected/*.tif"))) == moved["MOVED"]
    back = run("clean", DATASET=str(folder), ACTION="undo")
    assert (back["REJECTED"], back["MOVED"]) == (moved["REJECTED"], moved["MOVED"])
    assert tables(folder) == before
    assert "is not a dataset" in refusal("clean", DATASET=str(tmp_path))


def test_cleaning_draws_its_diagrams(tmp_path):
    pytest.importorskip("matplotlib")
    folder, diagrams = tmp_path / "out", tmp_path / "diagrams"
    run("capture", EXTENT=EXTENT, AGL=200, FOLDER=str(folder))
    before = tables(folder)
    result = run("clean", DATASET=str(folder), ENTROPY=3, DRY_RUN=True, DIAGRAMS=str(diagrams))
    assert tables(folder) == before
    assert {result["HISTOGRAM"], result["BARS"]} == {str(path) for path in diagrams.iterdir()}
    for path in diagrams.iterdir():
        assert not QImage(str(path)).isNull()
    without = run("clean", DATASET=str(folder), DRY_RUN=True)
    assert not {"HISTOGRAM", "BARS", "DIAGRAMS"} & set(without)
    feedback = Feedback()
    run("clean", feedback, DATASET=str(folder), ACTION="undo", DIAGRAMS=str(tmp_path / "none"))
    assert any("no diagrams" in text for text in feedback.warnings)


@pytest.mark.thorough
def test_the_report_is_a_page(tmp_path):
    pytest.importorskip("matplotlib")
    result = run("accuracyreport", COORDS="35.158_-89.898_300", QUICK=True, FOLDER=str(tmp_path / "r"))
    page = (tmp_path / "r" / "index.html").read_text(encoding="utf-8")
    assert result["HTML"] == str(tmp_path / "r" / "index.html")
    assert "error against run time" in page


# --- batches and models


def test_a_batch(tmp_path):
    heights = (100, 150, 300)
    results = [run("plan", EXTENT=EXTENT, AGL=agl, FOOTPRINTS=str(tmp_path / f"{agl}.gpkg")) for agl in heights]
    counts = [len(features_of(str(tmp_path / f"{agl}.gpkg"))) for agl in heights]
    assert counts == [result["IMAGES"] for result in results] == sorted(counts, reverse=True)


def test_in_a_model(tmp_path, qtbot):
    """The plan's mission file is captured, and its footprints are dissolved."""
    model = QgsProcessingModelAlgorithm("plan, capture and dissolve", "tests")
    model.addModelParameter(QgsProcessingParameterExtent("where", "Where"), QgsProcessingModelParameter("where"))
    source = QgsProcessingModelChildParameterSource

    def child(name, algorithm, **sources):
        one = QgsProcessingModelChildAlgorithm(algorithm)
        one.setChildId(name)
        for definition in one.algorithm().parameterDefinitions():
            # As the model designer fills them in.
            usual = source.fromStaticValue(definition.defaultValue())
            if definition.name() in sources or not (definition.isDestination() or definition.defaultValue() is None):
                one.addParameterSources(definition.name(), [sources.get(definition.name(), usual)])
        model.addChildAlgorithm(one)

    child(
        "plan",
        "terrainav:plan",
        EXTENT=source.fromModelParameter("where"),
        AGL=source.fromStaticValue(200),
        FOOTPRINTS=source.fromStaticValue("TEMPORARY_OUTPUT"),
        MISSION_FILE=source.fromStaticValue(str(tmp_path / "mission.json")),
    )
    child(
        "capture",
        "terrainav:capture",
        MISSION=source.fromChildOutput("plan", "MISSION_FILE"),
        FOLDER=source.fromStaticValue(str(tmp_path / "out")),
    )
    child("dissolve", "native:dissolve", INPUT=source.fromChildOutput("plan", "FOOTPRINTS"))
    output = QgsProcessingModelOutput("whole", "Whole")
    output.setChildId("dissolve")
    output.setChildOutputName("OUTPUT")
    dissolve = model.childAlgorithm("dissolve")
    dissolve.setModelOutputs({"whole": output})
    model.setChildAlgorithm(dissolve)
    model.updateDestinationParameters()
    valid, problems = model.validate()
    assert valid, problems
    assert model.canExecute()[0]

    expected = planned(Mission(BOX, 200.0))
    for beside in (False, True):
        context, feedback, ended = QgsProcessingContext(), QgsProcessingFeedback(False), []
        context.setProject(QgsProject.instance())
        parameters = {"where": EXTENT, "dissolve:whole": str(tmp_path / f"whole-{beside}.gpkg")}
        if beside:
            task = QgsProcessingAlgRunnerTask(model.create(), parameters, context, feedback)
            task.executed.connect(lambda done, _results, ended=ended: ended.append(done))
            QgsApplication.taskManager().addTask(task)
            qtbot.waitUntil(lambda ended=ended: bool(ended), timeout=int(1000 * NEVER_S))
            done = ended[0]
        else:
            _, done = model.run(parameters, context, feedback)
        assert done, feedback.textLog()
        (whole,) = features_of(str(tmp_path / f"whole-{beside}.gpkg"))
        west, south, east, north = expected.edges
        box = whole.geometry().boundingBox()
        np.testing.assert_allclose(
            (box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum()),
            (west.min(), south.min(), east.max(), north.max()),
            atol=1e-6,
        )
        pictures = list((tmp_path / "out" / "satellite").glob("*.tif"))
        assert len(pictures) == len(expected)


def test_the_main_thread_is_never_kept_by_an_algorithm_beside_it(tmp_path, qtbot):
    from qgis.PyQt.QtCore import QTimer

    turns, timer = [], QTimer()
    timer.timeout.connect(lambda: turns.append(time.monotonic()))
    timer.start(10)
    done, _, _ = run_in_background("capture", qtbot, EXTENT=EXTENT, AGL=120, FOLDER=str(tmp_path / "out"))
    timer.stop()
    assert done
    assert len(turns) > 10
    assert json.loads((tmp_path / "out" / "mission.json").read_text())["flight"]["agl_m"] == 120.0


def test_overlap_beyond_its_unit_is_refused_and_not_made_another():
    text = refusal("plan", EXTENT=EXTENT, AGL=120, FRONT_OVERLAP=100, FOOTPRINTS="memory:")
    assert "overlap" in text
    assert "100" in text


# --- parameters of strangers


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("SEED", 2**31, "whole number"),
        ("SEED", float("nan"), "whole number"),
        ("IMAGE_PX", "x", "Image's longer side (px) x"),
        ("TAKEOFF", "-89.9,35.2 [EPSG:0]", "must be one of the Earth"),
        ("TAKEOFF", "-89.9,35.2 [IAU_2015:49900]", "must be one of the Earth"),
        ("EXTENT", EXTENT.replace("4326", "999999"), "must be one of the Earth"),
        ("EXTENT", EXTENT.replace("EPSG:4326", "IAU_2015:30100"), "must be one of the Earth"),
        ("ELEVATION", "a\0b", "has a character"),
        ("EXPORT", "/a\0b.kml", "has a character"),
    ],
)
def test_what_qgis_reads_as_something_else_is_refused(name, value, said):
    """It takes numbers beyond 32 bits for 0, and those of an unknown CRS or of another planet for degrees."""
    assert said in refusal("plan", **{"EXTENT": EXTENT, "AGL": 150, "FOOTPRINTS": "memory:", name: value})


@pytest.mark.parametrize(
    ("crs", "said"),
    [("", "has no CRS"), ("IAU_2015:49900", "of the Earth"), ("IAU_2015:30100", "of the Earth")],
)
def test_layers_of_no_crs_or_of_another_planet_are_refused(crs, said):
    polygon = memory_layer("Polygon", crs, ["Polygon ((-89.9 35.15, -89.89 35.15, -89.89 35.16, -89.9 35.15))"])
    line = memory_layer("LineString", crs, ["LineString (-89.9 35.15, -89.89 35.15)"])
    point = memory_layer("Point", crs, ["Point (-89.9 35.15)"])
    for layer in (polygon, point):
        assert said in refusal("plan", AREA=layer, AGL=150, FOOTPRINTS="memory:")
    assert said in refusal("plan", EXTENT=EXTENT, NO_FLY=polygon, AGL=150, FOOTPRINTS="memory:")
    assert said in refusal("posesalongline", INPUT=line, AGL=150, SPEED=10, EVERY_S=1, OUTPUT="memory:")


@pytest.mark.parametrize("name", ["clean", "split", "capturefailed"])
@pytest.mark.parametrize("folder", ["a\0b", "a" * 300, "a\ud800"])
def test_a_folder_that_no_system_takes_is_refused_in_a_line(name, folder):
    text = refusal(name, DATASET=folder)
    assert "Traceback" not in text
    assert "Error" not in text


def test_a_number_of_thousands_of_digits_names_no_choice():
    choice = ChoiceParameter("X", "X", {"a": "A", "b": "B"}, "a")
    assert not choice.checkValueIsAcceptable("9" * 5000)
    assert choice.checkValueIsAcceptable("1")
    with pytest.raises(InvalidInput, match="must be one of a, b"):
        choice.chosen("9" * 5000)
