"""Captures whose images vary at random: tables, metadata, blocks, shards and resuming; and images without effects."""

from __future__ import annotations

import json
import multiprocessing
import tarfile
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.loading.batches import LabelledImages
from terrainav.core.dataset.split import split
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture import effects

SOURCE = named_source("world")
POSES = (
    "east_m=normal(0,4)within(-9,9)",
    "north_m=uniform(-9,9)",
    "agl_m=uniform(90,150)",
    "yaw_deg=uniform(-180,180)",
)


class Halved:
    """Half of the light."""

    def apply(self, light):
        light.values *= np.float32(0.5)
        light.facts["light"] = 0.5


@pytest.fixture
def halved(monkeypatch):
    monkeypatch.setattr(effects, "effects", lambda mission: (Halved(),))


def planned(*vary, **values):
    mission = Mission(Box(35.12, -89.85, 35.118, -89.846), 120.0, vary=vary or POSES, **{"image_px": 48, **values})
    return plan(mission, SOURCE.grid)


def table_of(folder, map_type="satellite"):
    return Table.load(folder / map_type / "meta_data.csv")


def contents(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


def values_of(path):
    with Image.open(path) as image:
        return np.asarray(image).astype(float)


def test_tables_and_images_state_the_poses_of_the_plan(tmp_path):
    made = planned()
    capture(made, SOURCE.open(), tmp_path)
    table = table_of(tmp_path)
    np.testing.assert_array_equal(table.agl_m, made.agl_m)
    np.testing.assert_array_equal(table.pose_lat_deg, made.lat_deg)
    np.testing.assert_array_equal(table.nominal_agl_m, np.full(len(made), 120.0))
    assert [float(cell) for cell in table.other["east_m"]] == [made.drawn(at)["east_m"] for at in range(len(made))]
    assert [name.rpartition(".")[0] for name in table.img_names] == made.names
    with Image.open(tmp_path / "satellite" / table.img_names[3]) as image:
        (text,) = (value for value in image.tag_v2.values() if isinstance(value, str) and "EAST_M" in value)
    assert f'<Item name="EAST_M">{made.drawn(3)["east_m"]!r}</Item>' in text


def test_an_image_has_its_values_in_any_run(tmp_path):
    """Of all captures, of some, resumed, in blocks of any size: the same images and the same table."""
    made = planned()
    capture(made, SOURCE.open(), tmp_path / "all")
    capture(made, SOURCE.open(), tmp_path / "parts", only=range(2, 5))
    capture(made, SOURCE.open(), tmp_path / "parts", only=[5, 1], resume=True)
    capture(made, SOURCE.open(), tmp_path / "parts", resume=True)
    whole = contents(tmp_path / "all" / "satellite")
    assert contents(tmp_path / "parts" / "satellite") == whole
    for size in (2, 3):
        capture(made, SOURCE, tmp_path / str(size), blocks=Blocks(size))
        assert contents(tmp_path / str(size) / "satellite") == whole


def test_other_processes_make_the_same_images(tmp_path):
    sensor = {"image_sensor": "custom", "pixel_um": 3.0, "quantum_efficiency": 0.6, "full_well_e": 1000.0}
    made = planned("read_noise_e=uniform(1,60)", "white_balance_k=uniform(4500,7500)", keep_clean=True, **sensor)
    capture(made, SOURCE.open(), tmp_path / "here")
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        capture(made, SOURCE, tmp_path / "there", executor=pool, blocks=Blocks(3))
    for map_type in ("satellite", "satellite_clean"):
        assert contents(tmp_path / "there" / map_type) == contents(tmp_path / "here" / map_type)


def test_rows_in_shards_have_the_columns_of_tables(tmp_path):
    made = planned()
    capture(made, SOURCE, tmp_path, blocks=Blocks(4, layout="webdataset"))
    stated = {}
    for path in sorted((tmp_path / "satellite").glob("*.tar")):
        with tarfile.open(path) as tar:
            rows = [json.load(tar.extractfile(one)) for one in tar.getmembers() if one.name.endswith(".json")]
            stated.update((row["img_names"], row["east_m"]) for row in rows)
    table = table_of(tmp_path)
    assert stated == dict(zip(table.img_names, table.other["east_m"]))
    assert len(stated) == len(made)


@pytest.mark.parametrize("image_format", ["tif", "png", "jpg"])
def test_clean_images_are_those_of_an_ideal_camera(tmp_path, monkeypatch, image_format):
    made = planned(keep_clean=True, image_format=image_format, map_types=("satellite", "roadmap"))
    capture(planned(image_format=image_format), SOURCE.open(), tmp_path / "ideal")
    monkeypatch.setattr(effects, "effects", lambda mission: (Halved(),))
    capture(made, SOURCE.open(), tmp_path / "real")
    read = read_dataset(tmp_path / "real")
    assert list(read.image_sets) == ["roadmap", "roadmap_clean", "satellite", "satellite_clean"]
    ideal, clean, real = (
        read_dataset(tmp_path / where).image_set(map_type).table
        for where, map_type in (("ideal", "satellite"), ("real", "satellite_clean"), ("real", "satellite"))
    )
    assert ideal.img_names == clean.img_names == real.img_names
    np.testing.assert_array_equal(ideal.entropies, clean.entropies)
    assert (real.entropies < clean.entropies).all()
    assert real.other["light"] == ("0.5",) * len(made)
    assert "light" not in clean.other
    for name in ideal.img_names:
        wanted = values_of(tmp_path / "ideal" / "satellite" / name)
        np.testing.assert_array_equal(values_of(tmp_path / "real" / "satellite_clean" / name), wanted)
        assert values_of(tmp_path / "real" / "satellite" / name).mean() < 0.9 * wanted.mean()


def test_clean_images_state_their_geometry(tmp_path):
    flight = {"exposure_ms": 1.0, "motion_blur": True, "visibility_km": 9.0, "keep_clean": True}
    capture(planned("row_time_us=uniform(10,60)", "east_m=uniform(-5,5)", **flight), SOURCE.open(), tmp_path)
    real, clean = (table_of(tmp_path, name).other for name in ("satellite", "satellite_clean"))
    assert {"row_time_us", "east_m", "speed_east_m_per_s", "yaw_rate_deg_per_s"} <= set(clean)
    assert {"exposure_ms", "motion_blur_px", "visibility_km", "airlight"} == set(real) - set(clean) - {
        "exposure_instants"
    }
    assert all(clean[name] == real[name] for name in clean)


def test_clean_images_are_sharp(tmp_path):
    """In the middle of the exposure: what an ideal camera sees from there."""
    flight = {"frame": "camera", "airspeed_m_per_s": 20.0, "exposure_ms": 100.0}
    capture(planned(**flight), SOURCE.open(), tmp_path / "ideal")
    capture(planned(**flight, motion_blur=True, keep_clean=True), SOURCE.open(), tmp_path / "real")
    for name in table_of(tmp_path / "ideal").img_names:
        ideal = values_of(tmp_path / "ideal" / "satellite" / name)
        np.testing.assert_array_equal(values_of(tmp_path / "real" / "satellite_clean" / name), ideal)
        assert (values_of(tmp_path / "real" / "satellite" / name) != ideal).any()


def test_sensors_have_the_values_of_their_image(tmp_path):
    """The noise of each image, in linear light, is what was drawn for it."""
    sensor = {"image_sensor": "custom", "pixel_um": 3.0, "quantum_efficiency": 0.6, "full_well_e": 1000.0}
    made = planned("read_noise_e=uniform(20,120)", keep_clean=True, image_px=160, **sensor)
    capture(made, SOURCE.open(), tmp_path)
    table = table_of(tmp_path)
    noise_e = np.array([float(cell) for cell in table.other["read_noise_e"]])
    assert noise_e.tolist() == [made.drawn(index)["read_noise_e"] for index in range(len(made))]
    for name, wanted_e in zip(table.img_names, noise_e):
        real, clean = (
            ((values_of(tmp_path / folder / name) / 255.0 + 0.055) / 1.055) ** 2.4
            for folder in ("satellite", "satellite_clean")
        )
        # Light that noise does not take below black or beyond white.
        away_e = ((real - clean) * 1000.0)[(clean > 0.3) & (clean < 0.7)]
        assert len(away_e) > 300
        assert away_e.std() == pytest.approx(np.sqrt(wanted_e**2 + 500.0), rel=0.1)


def test_speeds_that_a_sensor_lacks_are_refused_before_the_first_image(tmp_path):
    sensor = {"image_sensor": "FRAMOS IMX900 low gain", "exposure": "manual", "exposure_ms": 0.2}
    with pytest.raises(InvalidInput, match="ISO 120: below that of the image sensor"):
        capture(planned("iso=choice(400,120)", **sensor), SOURCE.open(), tmp_path / "low")
    assert not (tmp_path / "low").exists()
    # The mission's own speed, which is too low, is that of no image.
    assert capture(planned("iso=choice(200,400)", **sensor), SOURCE.open(), tmp_path / "high").failed == ()


def test_clean_images_are_resized_as_well(tmp_path, halved):
    capture(planned(keep_clean=True, img_size=(20, 16, 1)), SOURCE.open(), tmp_path)
    name = table_of(tmp_path).img_names[0]
    assert values_of(tmp_path / "satellite" / name).shape == values_of(tmp_path / "satellite_clean" / name).shape


@pytest.mark.parametrize("blocks", [None, Blocks(3)])
def test_a_lost_clean_image_is_made_again(tmp_path, halved, blocks):
    made = planned(keep_clean=True)
    source = SOURCE.open() if blocks is None else SOURCE
    capture(made, source, tmp_path / "out", blocks=blocks)
    before = contents(tmp_path / "out" / "satellite_clean")
    lost = next((tmp_path / "out" / "satellite_clean").glob("*.tif"))
    lost.unlink()
    result = capture(made, source, tmp_path / "out", blocks=blocks, resume=True)
    assert result.written == (1 if blocks is None else 3)
    assert contents(tmp_path / "out" / "satellite_clean") == before
    assert capture(made, source, tmp_path / "out", blocks=blocks, resume=True).written == 0


def test_shards_hold_clean_images_beside_the_others(tmp_path, halved):
    made = planned(keep_clean=True)
    capture(made, SOURCE.open(), tmp_path / "folders")
    capture(made, SOURCE, tmp_path / "shards", blocks=Blocks(100, layout="webdataset"))
    (path,) = (tmp_path / "shards" / "satellite").glob("*.tar")
    with tarfile.open(path) as tar:
        clean = {
            one.name.partition(".")[0]: tar.extractfile(one).read()
            for one in tar.getmembers()
            if one.name.endswith(".satellite_clean.tif")
        }
    wanted = [(tmp_path / "folders" / "satellite_clean" / f"{name}.tif").read_bytes() for name in made.names]
    assert [clean[f"{index:09d}"] for index in range(len(made))] == wanted


def test_nothing_is_kept_unless_asked(tmp_path, halved):
    capture(planned(), SOURCE.open(), tmp_path)
    assert not (tmp_path / "satellite_clean").exists()


@pytest.mark.parametrize("blocks", [None, Blocks(4, layout="webdataset")])
def test_what_varies_is_read_as_labels(tmp_path, blocks):
    made = planned("exposure_ms=lognormal(4,0.5)", "white_balance_k=uniform(4500,7500)", "east_m=uniform(-9,9)")
    capture(made, SOURCE if blocks else SOURCE.open(), tmp_path, blocks=blocks)
    targets = ("white_balance_k", "height", "exposure_ms", "east_m")
    samples = LabelledImages(tmp_path, part="all", img_size=(16, 12, 3), targets=targets)
    assert samples.columns == ("white_balance_k", "agl_m", "exposure_ms", "east_m")
    wanted = [
        [values["white_balance_k"], made.agl_m[index], values["exposure_ms"], values["east_m"]]
        for index, values in ((index, made.drawn(index)) for index in map(made.names.index, samples.names))
    ]
    np.testing.assert_array_equal(samples.values, np.float32(wanted))
    _, labels = samples.take([2, 0])
    np.testing.assert_array_equal(labels, np.float32([wanted[2], wanted[0]]))


def test_columns_that_are_not_numbers_are_no_labels(tmp_path):
    capture(planned(visibility_km=20.0), SOURCE.open(), tmp_path)
    with pytest.raises(InvalidInput, match=r"targets airlight: the table of .* does not have it for 0_0"):
        LabelledImages(tmp_path, part="all", img_size=(16, 12, 3), targets=("airlight",))
    with pytest.raises(InvalidInput, match=r"further columns of .*: east_m, north_m, visibility_km, airlight"):
        LabelledImages(tmp_path, part="all", img_size=(16, 12, 3), targets=("exposure_ms",))


@pytest.mark.parametrize("map_types", [("satellite",), ("satellite", "roadmap")])
def test_clean_images_decide_what_cleaning_rejects(tmp_path, map_types):
    """Noise looks like detail, and pairs stay together."""
    noisy = {"image_sensor": "custom", "pixel_um": 3.0, "quantum_efficiency": 0.6, "full_well_e": 1e3}
    capture(planned(keep_clean=True, read_noise_e=200.0, map_types=map_types, **noisy), SOURCE.open(), tmp_path)
    deciding = f"{map_types[-1]}_clean"
    threshold = float(np.median(table_of(tmp_path, deciding).entropies))
    clean(tmp_path, threshold=threshold)
    wanted = table_of(tmp_path, deciding).entropies < threshold
    assert 0 < wanted.sum() < len(wanted)
    for one in map_types:
        assert table_of(tmp_path, one).entropies.min() > threshold
        for map_type in (one, f"{one}_clean"):
            assert [bool(mark) for mark in table_of(tmp_path, map_type).other["rejected"]] == wanted.tolist()


def test_clean_images_are_loaded_in_pairs(tmp_path, halved):
    capture(planned(keep_clean=True), SOURCE.open(), tmp_path)
    split(tmp_path, (0.5, 0.0, 0.5))
    chosen = {"part": "train", "img_size": (16, 12, 3), "augment": None}
    real, clean = (LabelledImages(tmp_path, map_type=name, **chosen) for name in ("satellite", "satellite_clean"))
    assert real.names == clean.names
    np.testing.assert_array_equal(real.order(3), clean.order(3))
    np.testing.assert_array_equal(real.values, clean.values)
    assert (real.take([0])[0] < clean.take([0])[0]).all()
