from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod, Transformer
from terrainav.core.dataset.folder import FRAMES
from terrainav.core.dataset.labels import (
    Labels,
    choose_frame,
    make_dataset_labels,
    make_labels,
    mark_unfinished,
    middle_position,
)
from terrainav.core.errors import InvalidInput

from tests.core.dataset.test_table import make_table
from tests.support.thinning import examples

LAT, LON = np.array([35.10, 35.14, 35.19]), np.array([-89.91, -89.88, -89.80])
GEOD = Geod(ellps="WGS84")
#: What `Labels.positions` promises: in zones and the like, beside the poles, and wherever a frame is made.
POSITION_M, BY_POLES_M, ANYWHERE_M = 2e-8, 1e-6, 1e-3


@pytest.mark.parametrize(
    ("lat", "lon", "crs"),
    [
        (35.1, -89.9, "EPSG:32616"),
        (-33.9, 151.2, "EPSG:32756"),
        (60.4, 5.3, "EPSG:32632"),
        (78.2, 15.6, "EPSG:32633"),
        (0.0, 180.0, "EPSG:32601"),
        (84.0, 10.0, "EPSG:5041"),
        (83.9, 10.0, "EPSG:32633"),
        (-80.0, 10.0, "EPSG:32732"),
        (-80.1, 10.0, "EPSG:5042"),
        (90.0, 0.0, "EPSG:5041"),
    ],
)
def test_utm_zone_or_ups_of_the_middle(lat, lon, crs):
    assert choose_frame(np.array([lat]), np.array([lon])).crs == crs


def test_labels_are_what_proj_makes_of_the_centres_scaled():
    labels = make_labels(LAT, LON)
    east, north = Transformer.from_crs(4326, 32616, always_xy=True).transform(LON, LAT)
    metres = np.stack([east, north], axis=-1)
    np.testing.assert_allclose(labels.frame.forward(LAT, LON), metres, atol=1e-8)
    np.testing.assert_allclose(
        labels.transform(LAT, LON), (metres - metres.mean(axis=0)) / metres.std(axis=0), atol=1e-12
    )


def off_m(lat, lon, frame):
    """How far positions are from what their labels give back, metres."""
    labels = make_labels(lat, lon, frame)
    back_lat, back_lon = labels.positions(labels.transform(lat, lon))
    assert ((back_lon >= -180.0) & (back_lon < 180.0)).all()
    return np.max(GEOD.inv(*(values.tolist() for values in (lon, lat, back_lon, back_lat)))[2])


def wrapped(lon):
    return (lon + 180.0) % 360.0 - 180.0


@settings(max_examples=examples(60))
@given(
    st.sampled_from(FRAMES),
    st.floats(-84.0, 84.0),
    st.floats(-180.0, 180.0),
    st.lists(st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)), min_size=1, max_size=8),
)
def test_labels_give_the_positions_back(frame, lat, lon, offsets):
    step = np.array(offsets)
    off = off_m(lat + step[:, 0], wrapped(lon + step[:, 1]), frame)
    assert off <= (POSITION_M if abs(lat) < 79.0 or frame == "mercator" else BY_POLES_M)


@settings(max_examples=examples(30))
@given(
    st.sampled_from(("utm", "mission")),
    st.floats(-90.0, 90.0),
    st.floats(-180.0, 180.0),
    st.floats(0.01, 70.0),
    st.integers(0, 9),
)
def test_labels_of_any_place_come_back_or_are_refused(frame, lat, lon, spread, seed):
    step = np.random.default_rng(seed).uniform(-spread, spread, (2, 20))
    lats, lons = np.clip(lat + step[0], -90.0, 90.0), wrapped(lon + step[1])
    try:
        off = off_m(lats, lons, frame)
    except InvalidInput:
        # At a pole, or over half the world.
        assert abs(lat) + spread > 80.0 or spread > 40.0
        return
    assert off <= ANYWHERE_M


@pytest.mark.parametrize("frame", FRAMES)
def test_labels_are_continuous_across_the_antimeridian(frame):
    lat, lon = np.array([10.0, 10.0]), np.array([179.999, -179.999])
    metres = make_labels(lat, lon, frame).frame.forward(lat, lon)
    east, north = metres[1] - metres[0]
    assert east == pytest.approx(219.3, rel=0.03)
    # In UTM north leans by the meridians' convergence, half a degree here.
    assert abs(north) < 3.0


def test_middle_is_that_of_the_smallest_box():
    assert middle_position(np.array([1.0, 2.0]), np.array([179.0, -177.0])) == (1.5, -179.0)
    assert middle_position(np.array([1.0, 1.0, 2.0]), np.array([0.0, 0.1, 10.0])) == (1.5, 5.0)


def test_several_zones_have_one_frame_which_is_said():
    lon = np.array([-90.5, -90.1, -89.9])
    labels = make_labels(LAT, lon)
    assert labels.frame.crs == "EPSG:32615"
    assert labels.frame.zones == ("15N", "16N")
    assert labels.notes == ("the images lie in 2 UTM zones (15N, 16N): one frame, EPSG:32615, is for all of them",)
    assert make_labels(LAT, LON).notes == ()


def test_file_keeps_all_digits_and_says_what_it_is(tmp_path):
    for frame in (*FRAMES, "EPSG:32615"):
        labels = make_labels(LAT, LON, frame, training=np.array([True, True, False]))
        labels.save(tmp_path / "labels.json")
        assert Labels.load(tmp_path / "labels.json") == labels
        document = json.loads((tmp_path / "labels.json").read_text())
        assert document["names"] == ["easting_m", "northing_m"]
        assert document["mean"] == list(labels.scaler.mean)
        assert (document["fitted_on"], document["images"]) == ("train", 2)


def test_scaler_sees_the_training_part_only():
    training = np.array([True, True, False])
    labels = make_labels(LAT, LON, training=training)
    scaled = labels.transform(LAT, LON)
    np.testing.assert_allclose(scaled[training].mean(axis=0), 0.0, atol=1e-12)
    assert abs(scaled[2]).max() > 1.0
    with pytest.raises(InvalidInput, match="training part"):
        make_labels(LAT, LON, training=np.zeros(3, np.bool_))


def test_labels_of_tables_leave_failed_and_rejected_images_out_and_count_places_once():
    where = {"lat_deg": LAT, "lon_deg": LON}
    table = make_table(**where, other={"split": ("train", "test", "")})
    labels = make_dataset_labels([table, table])
    assert (labels.fitted_on, labels.images) == ("train", 1)
    assert make_dataset_labels([make_table(**where)]).images == 2
    assert make_dataset_labels([make_table(**where, other={"rejected": ("dull", "", "")})]).images == 1
    with pytest.raises(InvalidInput, match="no image that is there"):
        make_dataset_labels([make_table(**where, status=("failed",) * 3)])


@pytest.mark.parametrize(
    ("frame", "said"),
    [
        ("moon", "must be utm, mercator, mission or a code"),
        ("EPSG:4326", "WGS 84, not a projected system in metres"),
        ("EPSG:2264", "ftUS"),
        ("EPSG:1", "PROJ knows no such system"),
    ],
)
def test_frames_that_are_none_are_refused(frame, said):
    with pytest.raises(InvalidInput, match=said):
        make_labels(LAT, LON, frame)


def test_frame_that_cannot_hold_the_images_is_refused():
    lat, lon = np.array([10.0, 10.0]), np.array([179.999, -179.999])
    with pytest.raises(InvalidInput, match=r"EPSG:3395 cannot hold all positions, such as 10\.0"):
        make_labels(lat, lon, "EPSG:3395")
    with pytest.raises(InvalidInput, match="cannot hold"):
        make_labels(np.array([90.0]), np.array([0.0]), "mercator")
    with pytest.raises(InvalidInput, match="needs one or more"):
        make_labels(np.array([np.nan]), np.array([0.0]))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"scale": [0.0, 1.0]}, "above 0"),
        ({"names": ["x"]}, "names"),
        ({"frame": "EPSG:1"}, "cannot be read"),
        ({"mean": None}, "cannot be read"),
        ({"mean": [1.0], "scale": [1.0]}, "1 columns"),
    ],
)
def test_file_that_is_none_is_refused(tmp_path, change, said):
    path = tmp_path / "labels.json"
    path.write_text(json.dumps({**json.loads(make_labels(LAT, LON).to_json()), **change}))
    with pytest.raises(InvalidInput, match=said):
        Labels.load(path)


def test_file_that_is_not_there_or_lacks_something_is_refused(tmp_path):
    with pytest.raises(InvalidInput, match="cannot be read"):
        Labels.load(tmp_path / "labels.json")
    (tmp_path / "labels.json").write_text("{}")
    with pytest.raises(InvalidInput, match="has no 'names'"):
        Labels.load(tmp_path / "labels.json")
    mark_unfinished(tmp_path / "labels.json")
    with pytest.raises(InvalidInput, match=r"labels\.json: a split was interrupted, .*; split again"):
        Labels.load(tmp_path / "labels.json")
