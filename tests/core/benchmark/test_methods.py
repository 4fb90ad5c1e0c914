"""Baselines: what they find, and of what their parts are made."""

from __future__ import annotations

import math
import shutil
import sys
from dataclasses import replace

import numpy as np
import pytest
from pyproj import Geod, Transformer
from terrainav.core.benchmark import correlation, features
from terrainav.core.benchmark.answers import Answer, Query, visible_query
from terrainav.core.benchmark.folder import Benchmark
from terrainav.core.benchmark.planning import BenchmarkSettings
from terrainav.core.benchmark.running import method_named, middle, run_method
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.footprint import exact

from tests.core.benchmark.conftest import made, mission

#: A module with methods of a user's.
MINE = """
from terrainav.core.benchmark.answers import Answer
from terrainav.core.errors import InvalidInput

def constant(benchmark, gallery):
    first = benchmark.references.id[gallery[0]]
    return lambda query: Answer((first,), 35.0, -90.0)

def wrong(benchmark, gallery):
    return lambda query: 7

def divides(benchmark, gallery):
    return lambda query: 1 / 0

def no_pose(benchmark, gallery):
    return lambda query: Answer(lat_deg="north")

def unprepared(benchmark, gallery):
    return {}["weights"]

def nothing(benchmark, gallery):
    pass

def refuses(benchmark, gallery):
    raise InvalidInput("no weights")
"""


def errors_m(benchmark, predictions):
    """Distances along the ground between cameras and answers."""
    queries, at = benchmark.queries, predictions.index
    return Geod(ellps="WGS84").inv(
        queries.lon_deg[at], queries.lat_deg[at], predictions.pose[:, 1], predictions.pose[:, 0]
    )[2]


def of(benchmark, imagery):
    return np.array([name == imagery for name in benchmark.queries.imagery])


def test_correlation_finds_what_has_not_changed_within_a_pixel(benchmark):
    found = errors_m(benchmark, run_method(benchmark, correlation.correlation))
    # A pixel is 1 m. Between pixels the parabola is no more than near.
    assert found[of(benchmark, "old")].max() < 0.5
    assert found[of(benchmark, "new")].max() < 2.0


def test_correlation_finds_tilted_and_rolled_cameras(tmp_path, dates):
    queries = mission(5, tilt_deg=30.0, roll_deg=-8.0)
    settings = BenchmarkSettings(queries, (dates["old"],), dates["old"], split="none")
    tilted = made(tmp_path / "tilted", settings).benchmark
    assert errors_m(tilted, run_method(tilted, correlation.correlation)).max() < 1.0


def test_correlation_ranks_tiles_of_the_right_ground_first(benchmark):
    predictions = run_method(benchmark, correlation.correlation)
    positives = benchmark.positives()
    for at in np.flatnonzero(of(benchmark, "old")).tolist():
        if len(positives[at]):
            assert predictions.ranking[at, 0] in positives[at]


@pytest.mark.parametrize("seed", range(3))
def test_agreement_is_the_correlation_coefficient_at_every_place(seed):
    rng = np.random.default_rng(seed)
    grey, picture = rng.integers(0, 256, (23, 31), np.uint8), rng.random((7, 9))
    # One half is nearly uniform: only single pixels differ, by one grey level.
    grey[:, 16:] = 200 + (rng.random((23, 15)) < 0.02)
    reference = correlation._Reference(grey)
    first = rng.random((7, 9)) < 0.7
    # The energies of the second mask are those of the first one, adapted.
    for mask in (first, first ^ (rng.random((7, 9)) < 0.1)):
        template = np.where(mask, picture - picture[mask].mean(), 0.0)
        found = correlation._agreement(template, mask, reference)
        assert found.shape == (17, 23)
        for row, column in np.ndindex(found.shape):
            below = grey[row : row + 7, column : column + 9][mask]
            expected = np.corrcoef(below, picture[mask])[0, 1] if np.ptp(below) else -1.0
            assert found[row, column] == pytest.approx(expected, abs=1e-9)
    assert (found == -1.0).any()


def test_one_colour_agrees_with_nothing():
    everywhere = np.ones((4, 4), bool)
    uniform = correlation._Reference(np.full((9, 9), 200, np.uint8))
    assert correlation._agreement(np.zeros((4, 4)), everywhere, uniform) is None
    assert (correlation._agreement(np.arange(16.0).reshape(4, 4) - 7.5, everywhere, uniform) == -1.0).all()


@pytest.mark.parametrize(("tilt_deg", "lat_deg"), [(0.0, 35.11), (60.0, 35.11), (60.0, -84.0)])
def test_a_view_is_where_the_camera_sees_it(benchmark, tilt_deg, lat_deg):
    """Rays through its points meet the ground in the middles of the reference's pixels."""
    mosaic, lon_deg, agl_m = benchmark.mosaic, -89.96, 120.0
    if lat_deg < 0.0:
        x, y = Transformer.from_crs(4326, 3857, always_xy=True).transform(lon_deg, lat_deg)
        values = {"west": x - 3e5, "north": y + 3e5, "pixel_width": 200.0, "pixel_height": 200.0}
        mosaic, agl_m = replace(mosaic, crs="EPSG:3857", width_px=3_000, height_px=3_000, **values), 9_000.0
    sight = correlation._Sight(Camera(30.0, 4.0 / 3.0), agl_m, 0.0, 33.0, tilt_deg, 5.0)
    view = sight.view(lat_deg, lon_deg, mosaic, 1)
    rows, columns = np.nonzero(view.mask)
    assert len(rows) > 30
    points = view.points[rows, columns] * (2.0, -2.0) + (-1.0, 1.0)
    pose = Poses.from_attitude(np.array([lat_deg]), np.array([lon_deg]), np.array([agl_m]), 33.0, tilt_deg, 5.0)
    seen = exact(sight.camera, pose, points, WGS84)
    column, row = mosaic.px(seen.lat_deg[0], seen.lon_deg[0])
    assert np.abs(column - (view.left + columns + 0.5)).max() < 1e-6
    assert np.abs(row - (view.top + rows + 0.5)).max() < 1e-6


def test_queries_come_with_priors_of_the_stated_errors(benchmark):
    queries = benchmark.queries
    asked = [visible_query(benchmark, at) for at in range(len(queries))]
    lat, lon, agl, yaw = (
        np.array([getattr(query, f"prior_{name}") for query in asked])
        for name in ("lat_deg", "lon_deg", "agl_m", "yaw_deg")
    )
    _, _, off_m = Geod(ellps="WGS84").inv(queries.lon_deg, queries.lat_deg, lon, lat)
    # Of two axes of 1.5 m; beyond five standard deviations in one of a million.
    assert 0.5 < np.sqrt(np.mean(off_m**2)) < 4.5
    assert off_m.max() < 5.0 * 1.5 * np.sqrt(2.0)
    assert 0.1 < np.abs(agl - (queries.height_m - queries.ground_m)).max() < 5.0
    assert 0.1 < np.abs((yaw - queries.yaw_deg + 180.0) % 360.0 - 180.0).max() < 15.0
    # One pose has one prior, whatever it is a picture of.
    same = {}
    for query, prior in zip(asked, zip(lat, lon, agl, yaw)):
        assert same.setdefault(query.id.partition("/")[2], prior) == prior


def test_queries_without_priors_have_none(benchmark, tmp_path):
    shutil.copytree(benchmark.folder, tmp_path / "bare")
    for path in (tmp_path / "bare").rglob("priors.csv"):
        path.unlink()
    query = visible_query(Benchmark.read(tmp_path / "bare"), 0)
    assert math.isnan(query.prior_lat_deg)
    assert math.isnan(query.prior_yaw_deg)


def test_a_query_wider_than_the_reference_has_no_answer(benchmark):
    query = visible_query(benchmark, 0)
    high = Query(**{**vars(query), "height_m": query.ground_m + 5_000.0})
    answer = correlation.correlation(benchmark, benchmark.gallery(""))(high)
    # Numbers that are not there are NaN, which equals nothing.
    assert repr(answer) == repr(Answer())


def test_features_tell_the_whole_pose(benchmark):
    pytest.importorskip("cv2")
    predictions = run_method(benchmark, features.sift)
    own = of(benchmark, "old")
    found = errors_m(benchmark, predictions)[own]
    said = np.isfinite(found)
    # Of 80 x 60 px; on the noise of this raster nearly all have matches enough.
    assert said.sum() >= 9
    assert np.median(found[said]) < 2.0
    queries = benchmark.queries
    yaw = predictions.pose[own][said, 3] - queries.yaw_deg[own][said]
    assert np.abs((yaw + 180.0) % 360.0 - 180.0).max() < 3.0
    assert np.abs(predictions.pose[own][said, 2] - queries.height_m[own][said]).max() < 6.0
    assert np.abs(predictions.pose[own][said, 4:]).max() < 5.0


def test_orb_runs(benchmark):
    pytest.importorskip("cv2")
    assert len(run_method(benchmark, features.orb, "test").index) == 6


def test_the_same_method_answers_the_same(benchmark):
    once, again = (run_method(benchmark, correlation.correlation, "test") for _ in range(2))
    assert np.array_equal(once.pose, again.pose, equal_nan=True)
    assert np.array_equal(once.ranking, again.ranking)


def test_without_opencv_features_say_how_to_get_it(benchmark, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "cv2", None)
    with pytest.raises(OutputError, match="OpenCV, which finds and matches features, is not installed"):
        features.sift(benchmark, benchmark.gallery(""))


def test_the_middle_is_what_others_have_to_beat(benchmark):
    predictions = run_method(benchmark, middle)
    assert len(np.unique(predictions.pose[:, :2], axis=0)) == 1
    assert errors_m(benchmark, predictions).min() > 1.0


def test_queries_do_not_tell_where_they_were_taken(benchmark):
    query = visible_query(benchmark, 0)
    secret = {round(float(angle[0]), 4) for angle in (benchmark.queries.lat_deg, benchmark.queries.lon_deg)}
    told = {name: value for name, value in vars(query).items() if isinstance(value, float)}
    assert not secret & {round(value, 4) for name, value in told.items() if not name.startswith("prior")}
    assert query.prior_lat_deg != benchmark.queries.lat_deg[0]


def test_methods_of_the_users_are_run(benchmark, tmp_path, monkeypatch):
    (tmp_path / "mine.py").write_text(MINE)
    monkeypatch.chdir(tmp_path)
    predictions = run_method(benchmark, method_named("mine:constant"))
    assert (predictions.pose[:, :2] == (35.0, -90.0)).all()
    assert math.isnan(predictions.pose[0, 2])
    with pytest.raises(InvalidInput, match=r"answers .* with 7, not an Answer"):
        run_method(benchmark, method_named("mine:wrong"))
    for name, said in {
        "divides": "method mine:divides: failed with ZeroDivisionError: division by zero (mine.py, line 13)",
        "unprepared": "method mine:unprepared: failed with KeyError: 'weights' (mine.py, line 19)",
        "no_pose": "method mine:no_pose: failed with ValueError: could not convert string to float: 'north' "
        "(mine.py, line 16)",
        "nothing": "method mine:nothing: returns None, not a function of a query",
        "refuses": "no weights",
    }.items():
        with pytest.raises(InvalidInput) as refused:
            run_method(benchmark, method_named(f"mine:{name}"))
        assert str(refused.value) == said
    (tmp_path / "broken.py").write_text("1 / 0\n")
    said = r"method 'broken:any': cannot be imported \(ZeroDivisionError: division by zero\)"
    with pytest.raises(InvalidInput, match=said):
        method_named("broken:any")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("surf", "must be one of ncc, sift, orb, middle, prior, silhouette, or module:function"),
        ("no_such_module:locate", "cannot be imported"),
        ("math:no_such_function", "cannot be imported"),
        ("math:pi", "is not a function"),
        (":x", "cannot be imported"),
    ],
)
def test_methods_that_are_none_are_refused(name, said):
    with pytest.raises(InvalidInput, match=said):
        method_named(name)


def test_a_run_is_cancelled_between_queries(benchmark):
    asked = iter([False, False, True])
    told = []
    found = run_method(
        benchmark,
        middle,
        progress=lambda done, total: told.append((done, total)),
        cancelled=lambda: next(asked),
    )
    assert found is None
    assert told == [(1, 24), (2, 24)]


#: Methods whose answers are of other types than plain ones, or whose faults cannot be printed.
ODD = """
import itertools
import numpy as np
from terrainav.core.benchmark.answers import Answer

def generator(benchmark, gallery):
    ids = [benchmark.references.id[at] for at in gallery]
    return lambda query: Answer((name for name in ids), np.float32(35.0), np.array([-90.0]))

def answers(benchmark, gallery):
    yield Answer()

def gives(benchmark, gallery):
    return lambda query: (one for one in [Answer()])

def endless(benchmark, gallery):
    return lambda query: Answer(itertools.cycle(["a"]))

def lists(benchmark, gallery):
    return lambda query: Answer([["a"]])

def numbers(benchmark, gallery):
    return lambda query: Answer([7])

def far(benchmark, gallery):
    return lambda query: Answer(lat_deg=91.0, lon_deg=0.0)

def infinite(benchmark, gallery):
    return lambda query: Answer(height_m=float("inf"))

class Mute(Exception):
    def __str__(self):
        raise ValueError("no words")

class Wrong(Exception):
    def __str__(self):
        return 7

class Shy:
    def __repr__(self):
        raise ValueError("no words")

def mute(benchmark, gallery):
    def locate(query):
        raise Mute()
    return locate

def wrong(benchmark, gallery):
    raise Wrong()

def shy(benchmark, gallery):
    return lambda query: Shy()

def shy_itself(benchmark, gallery):
    return Shy()

def late(benchmark, gallery):
    def names():
        yield benchmark.references.id[0]
        raise Mute()
    return lambda query: Answer(names())
"""


@pytest.fixture
def odd(tmp_path, monkeypatch):
    (tmp_path / "odd.py").write_text(ODD)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "odd", raising=False)


def test_answers_may_be_of_any_type_that_can_be_read(odd, benchmark):
    found = run_method(benchmark, method_named("odd:generator"))
    assert (found.ranking >= 0).all()
    assert found.ranking.shape[1] == len(benchmark.gallery(""))
    assert found.pose[:, :2].tolist() == [[35.0, -90.0]] * len(found.index)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("answers", "not a function of a query"),
        ("gives", "not an Answer"),
        ("endless", "more references than there are"),
        ("lists", "not a text"),
        ("numbers", "not a text"),
        ("far", "91, 0 is not on the Earth"),
        ("infinite", "height_m inf: must be a finite number"),
        ("mute", "failed with Mute: <Mute, which cannot be printed>"),
        ("wrong", "failed with Wrong: <Wrong, which cannot be printed>"),
        ("shy", "<Shy, which cannot be printed>, not an Answer"),
        ("shy_itself", "<Shy, which cannot be printed>, not a function of a query"),
        ("late", "cannot be read (Mute: <Mute, which cannot be printed>)"),
    ],
)
def test_a_method_of_another_kind_is_refused_in_one_line(odd, benchmark, name, said):
    with pytest.raises(InvalidInput, match="method") as refused:
        run_method(benchmark, method_named(f"odd:{name}"))
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
