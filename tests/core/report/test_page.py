"""Reports of two missions: pages that hold together, and numbers that are what they say."""

from __future__ import annotations

import csv
import io
import math
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image
from terrainav.core.errors import OutputError, PartError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.policy import Policy
from terrainav.core.imagery.source import tile_parts
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.report import pictures, plots
from terrainav.core.report.measure import measure
from terrainav.core.report.page import PAGE, write_report
from terrainav.core.report.sentences import verdict
from terrainav.core.report.tables import csv_files, methods_table, px_text
from terrainav.core.storage.files import PARTIAL_ENDING
from terrainav.core.text.markup import document, element, table
from terrainav.core.timing import Seconds
from terrainav.core.world import WorldSource

pytest.importorskip("matplotlib", reason="matplotlib, which draws the report's diagrams, is not installed")

WORLD = WorldSource()
MISSIONS = {
    "map frames": Mission(Box(35.1425, -89.866, 35.1405, -89.863), 120.0, max_px=160),
    "camera frames in wind": Mission(
        Box(35.1425, -89.868, 35.1405, -89.863),
        120.0,
        max_px=160,
        tilt_deg=55.0,
        wind=Wind(6.0, 250.0, 0.15),
        image_format="jpg",
    ),
}
VOID = {"meta", "img", "link", "br"}


class WellFormed(HTMLParser):
    """Checks that elements are closed in the order they were opened, and collects what they refer to."""

    def __init__(self):
        super().__init__()
        self.open, self.links, self.ids, self.text = [], [], [], []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        self.links += [value for name, value in attrs if name in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not self.open or self.open[-1] != "style":
            self.text.append(data)


def read(text):
    parser = WellFormed()
    parser.feed(text)
    parser.close()
    assert parser.open == []
    return parser


@pytest.fixture(scope="module", params=MISSIONS, ids=str)
def report(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report") / "of a mission"
    said = []
    worked_out = plan(MISSIONS[request.param], WORLD.grid)
    target = write_report(worked_out, WORLD, folder, progress=said.append, quick=True)
    assert said
    return worked_out, folder, target


def rows(folder, name):
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_page_is_well_formed_and_needs_nothing_from_elsewhere(report):
    _worked_out, folder, target = report
    assert target == folder / PAGE
    text = target.read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>")
    parsed = read(text)
    assert not [link for link in parsed.links if "/" in link or ":" in link]
    assert set(parsed.links) == {path.name for path in folder.iterdir()} - {PAGE}
    assert not re.search(r"@import|url\(|<script|https?://", text)
    assert not [path for path in folder.iterdir() if path.name.endswith(PARTIAL_ENDING)]


def test_the_page_says_what_was_chosen_and_whether_it_held(report):
    worked_out, _, target = report
    words = " ".join(" ".join(read(target.read_text(encoding="utf-8")).text).split())
    assert "within the bounds" in words
    assert "NOT within" not in words
    assert "nan" not in words.lower().split()
    names = {"map": "map frame", "camera": "camera frame"}
    for choice in worked_out.accuracy.choices:
        assert names.get(choice.method.name, choice.method.name) in words
        assert choice.reason in words
    for what, why in worked_out.accuracy.left_out:
        assert what in words
        assert why in words
    for name in ("numpy", "pyproj", "Pillow", "PROJ", "processor", "cores"):
        assert name in words


def test_the_pictures_are_pictures(report):
    _, folder, _ = report
    found = sorted(path.name for path in folder.glob("*.png"))
    assert found == ["conditioning.png", "errors.png", "resampling.png", "work-precision.png"]
    for name in found:
        with Image.open(folder / name) as picture:
            assert picture.format == "PNG"
            picture.load()
            assert picture.width > 1000
            # White paper, and something drawn on it.
            assert np.ptp(np.asarray(picture.convert("L"))) > 200


def test_labels_cross_no_whisker():
    figure = plots.new_figure(6.0, 4.0)
    axes = figure.subplots()
    axes.set(xlim=(0.0, 4.0), ylim=(0.0, 4.0))
    places = [(1.0, 1.0), (2.0, 1.6), (2.1, 2.0)]
    # Whiskers reach above the markers, where labels stand first, and level lines to their right.
    labels = [
        plots.Label(x, y, f"label {x:g}", plots.BLACK, ((x, y - 0.1), (x, y + 0.9), (x + 1.0, y))) for x, y in places
    ]
    figure.draw_without_rendering()
    plots._place_labels(axes, labels)
    renderer = figure.canvas.get_renderer()
    boxes = [note.get_window_extent(renderer) for note in axes.texts if note.get_text()]
    assert len(boxes) == len(labels)
    for label in labels:
        place = axes.transData.transform((label.x, label.y))
        for end in map(axes.transData.transform, label.lines):
            for share in np.linspace(0.0, 1.0, 50):
                assert not any(box.contains(*(place + share * (end - place))) for box in boxes)


def test_errors_are_within_their_bounds_and_times_are_times(report):
    worked_out, folder, _ = report
    methods = rows(folder, "methods.csv")
    measured = [row for row in methods if row["error_px"]]
    # Equal methods are merged: each mesh reaches another bound, and what it reaches holds.
    meshes = [float(row["reached_px"]) for row in measured if row["method"].startswith("mesh")]
    assert len(meshes) >= 4
    assert len(set(meshes)) == len(meshes)
    assert len(measured) == len({(row["stage"], row["method"]) for row in measured}) >= 8
    for row in methods:
        assert bool(row["outside"]) == (row["bound_px"] == "") == (row["error_px"] == "")
    for row in measured:
        assert 0.0 <= float(row["error_px"]) <= float(row["reached_px"]) <= float(row["bound_px"])
        assert float(row["median_px"]) <= float(row["usual_px"]) <= float(row["error_px"])
        low, median, high = (float(row[f"seconds_per_capture{end}"]) for end in ("_low", "", "_high"))
        assert 0.0 < low <= median <= high < 60.0
    chosen = {row["stage"]: row["method"] for row in methods if row["chosen"] == "1"}
    assert chosen == {choice.method.stage: choice.method.name for choice in worked_out.accuracy.choices}
    for choice in worked_out.accuracy.choices:
        row = next(
            row for row in methods if row["method"] == choice.method.name and row["stage"] == choice.method.stage
        )
        assert float(row["bound_px"]) == pytest.approx(choice.method.bound_px)
    exact = [row for row in measured if row["method"] in ("exact", "rays")]
    assert len(exact) == 2
    assert all(float(row["error_px"]) < 1e-6 for row in exact)


def test_every_csv_is_read_back(report):
    worked_out, folder, _ = report
    names = sorted(path.name for path in folder.glob("*.csv"))
    wind = ["wind-coverage.csv", "wind-displacement.csv"] if worked_out.mission.wind else []
    assert names == sorted(
        ["errors.csv", "files.csv", "left_out.csv", "methods.csv", "pipelines.csv", "resampling.csv", *wind]
    )
    assert all(rows(folder, name) for name in names)
    left_out = {row["what"]: row for row in rows(folder, "left_out.csv")}
    assert left_out.keys() == {what for what, _ in worked_out.accuracy.left_out}
    if "resampling" in left_out:
        assert float(left_out["resampling"]["seconds"]) > 0.0
    files = rows(folder, "files.csv")
    kept = {row["file"]: float(row["rms_grey_levels"]) for row in files}
    assert [name for name, rms in kept.items() if rms == 0.0] == [
        "PNG, lossless",
        "GeoTIFF, deflate, lossless",
    ]
    assert kept["JPEG, quality 75"] > kept["JPEG, quality 85"] > kept["JPEG, quality 95"] > 0.0
    assert sum(int(row["chosen"]) for row in files) == 1


def test_finer_kernels_are_nearer_to_the_worlds_true_values(report):
    _, folder, _ = report
    found = rows(folder, "resampling.csv")
    rms = {row["kernel"]: float(row["rms_of_all_bands"]) for row in found if row["kernel"] != "signal"}
    assert rms["nearest"] > rms["bilinear"] > rms["bicubic"]
    assert rms["bilinear"] > rms["lanczos"]
    for kernel, whole in rms.items():
        bands = [float(row["rms_grey_levels"]) for row in found if row["kernel"] == kernel]
        # The window of the spectrum weighs the middle of the patch more than its edges.
        assert math.sqrt(sum(band**2 for band in bands)) == pytest.approx(whole, rel=0.35)


@pytest.mark.parametrize("where", ["file", "under a file"])
def test_a_folder_that_cannot_be_is_refused_before_anything_is_measured(tmp_path, where):
    taken = tmp_path / "taken"
    taken.write_text("something else", encoding="utf-8")
    worked_out = plan(MISSIONS["map frames"], WORLD.grid)

    def never(_):
        raise RuntimeError("measured although there is nowhere to write to")

    with pytest.raises(OutputError, match="taken"):
        write_report(worked_out, WORLD, taken if where == "file" else taken / "below", progress=never)
    assert taken.read_text(encoding="utf-8") == "something else"


def test_without_matplotlib_the_error_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(OutputError, match=r"pip install 'terrainav\[report\]'"):
        write_report(plan(MISSIONS["map frames"], WORLD.grid), WORLD, tmp_path / "out")
    assert not (tmp_path / "out").exists()


class Patchy(WorldSource):
    """The world without some of its tiles."""

    def __init__(self, missing):
        super().__init__()
        self.missing = missing

    def fetch(self, map_type, part):
        if self.missing(part):
            raise PartError("no tile here")
        return super().fetch(map_type, part)


def test_a_capture_without_imagery_is_passed_over_and_a_source_without_any_is_an_error():
    # Far apart, so that they share no tile.
    far = Points(((35.1425, -89.866, 120.0), (35.2425, -89.866, 120.0), (35.3425, -89.866, 120.0)))
    worked_out = plan(Mission(far, 120.0, max_px=160), WORLD.grid)
    middle = float(np.median(worked_out.windows.top_px))
    found = measure(worked_out, Patchy(lambda part: abs(part.top_px - middle) < 1000), quick=True)
    assert found.keeps_bounds
    with pytest.raises(PartError, match="no tile here"):
        measure(worked_out, Patchy(lambda part: True), quick=True)


class ByCentre:
    """A source that gives pictures by their centre, grey ones."""

    name, title, attribution, map_types = "grey", "Grey <b>& co</b>", "nobody", ("satellite",)
    grid = PixelGrid(max_zoom=21, native_zoom=21, centre_decimals=6, max_size_px=640)
    policy, date = Policy(), ""

    def parts(self, window):
        whole = window._replace(left_px=round(window.left_px), top_px=round(window.top_px))
        return [part._replace(window=window, dx_px=0, dy_px=0) for part in tile_parts(whole, self.grid)[:1]]

    def fetch(self, map_type, part):
        return np.full((part.height_px, part.width_px, 3), 128, np.uint8)

    def close(self):
        """Nothing is held."""


def test_a_source_by_centre_has_no_camera_frames_and_its_title_is_escaped(tmp_path):
    source = ByCentre()
    worked_out = plan(MISSIONS["map frames"], source.grid)
    target = write_report(worked_out, source, tmp_path, quick=True)
    text = target.read_text(encoding="utf-8")
    read(text)
    assert "Grey &lt;b&gt;&amp; co&lt;/b&gt;" in text
    methods = rows(tmp_path, "methods.csv")
    assert {row["stage"] for row in methods} == {"footprint", "image"}
    camera = next(row for row in methods if row["method"] == "camera")
    assert "by their centre" in camera["outside"]
    assert not (tmp_path / "resampling.csv").exists()


def test_a_budget_that_was_exceeded_and_a_bound_that_was_broken_are_said():
    high = Mission(Points(((40.0, -90.0, 16e3),)), 16e3, accept_error=True)
    worked_out = plan(high, ByCentre.grid)
    found = measure(worked_out, ByCentre(), quick=True)
    kept, sentence = verdict(worked_out, found)
    assert kept
    assert "more than the budget of 0.1 px: that was accepted" in sentence
    assert 0.1 < found.error_px <= worked_out.accuracy.bound_px
    on_map = found.stages["image"][0]
    broken = replace(on_map, error_px=2.0 * on_map.method.bound_px)
    wrong = replace(found, stages={**found.stages, "image": (broken, *found.stages["image"][1:])})
    kept, sentence = verdict(worked_out, wrong)
    assert not kept
    # The sums alone may look as if all were well: the method is named with the two figures that say otherwise.
    figures = f"map by {px_text(broken.error_px)} where {px_text(on_map.method.bound_px)} were its bound"
    assert f"NOT within the bounds, {figures}." in sentence
    assert any("above its bound" in row[4] for row in methods_table(wrong).rows)


@pytest.mark.parametrize(
    "scene", ["-47.33_149.15_80", pytest.param("35.14_-89.86_20", marks=pytest.mark.thorough), "84.9_10_30"]
)
def test_traced_pixels_are_within_their_bound_which_counts_their_place_on_the_map(scene):
    lat, lon, agl = map(float, scene.split("_"))
    turned = Mission(Points(((lat, lon, agl),)), agl, yaw_deg=30.0)
    worked_out = plan(turned, WORLD.grid)
    found = measure(worked_out, WORLD, quick=True)
    camera = next(one for one in found.stages["image"] if one.method.name == "camera")
    assert camera.chosen
    # Between positions in float64 and their bound lie no orders of magnitude.
    assert 0.02 * camera.method.bound_px < camera.error_px <= camera.method.bound_px
    kept, sentence = verdict(worked_out, found)
    assert kept, sentence


@pytest.mark.parametrize("frame", ["map", "camera"])
def test_large_pictures_are_timed_on_a_part(monkeypatch, frame):
    monkeypatch.setattr(pictures, "_MOST_PX", 2_000)
    worked_out = plan(MISSIONS["map frames"].replace(frame=frame), WORLD.grid)
    found = measure(worked_out, WORLD, quick=True)
    wide, high = found.planned_px
    assert wide * high > 4_000
    assert 1_800 < found.timed_px[0] * found.timed_px[1] <= 2_100
    assert found.keeps_bounds
    # Bytes are those of whole pictures: some two a pixel of this landscape as a GeoTIFF.
    assert all(1.0 < (one.size_bytes or 0) / (wide * high) < 8.0 for one in found.stages["image"])


def test_text_is_escaped_wherever_it_stands():
    nasty = "<script>'\"&"
    made = document(nasty, element("p", nasty, title=nasty), table((nasty,), [(nasty,)]))
    assert "<script>" not in made
    assert read(made).text.count(nasty) == 4


def test_the_same_diagram_has_the_same_bytes():
    found = measure(plan(MISSIONS["map frames"], WORLD.grid), WORLD, quick=True)
    once, again, wide = (
        plots.work_precision(replace(found, stages={**found.stages, "footprint": (one,), "pixels": ()}), 0.1, "title")
        for one in (
            replace(found.stages["footprint"][2], seconds=Seconds((1.0, 1.0 - half, 1.0 + half) * 2))
            for half in (0.01, 0.01, 0.5)
        )
    )
    assert once == again
    assert once != wide
    text = csv_files(found)["methods.csv"].decode("utf-8")
    assert len(list(csv.reader(io.StringIO(text)))) == 1 + sum(map(len, found.stages.values()))
