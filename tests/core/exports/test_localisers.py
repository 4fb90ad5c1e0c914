"""Benchmarks in other sets' layouts, read by readers of these tests: all is where the colours say."""

from __future__ import annotations

import csv
import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal
from PIL import Image
from pyproj import Transformer
from scipy.ndimage import binary_erosion
from terrainav.core.benchmark.folder import POSITIVE, Benchmark
from terrainav.core.benchmark.making import make_benchmark
from terrainav.core.benchmark.planning import BenchmarkSettings, plan_benchmark
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.exports import localisers
from terrainav.core.exports.kinds import BENCHMARKS
from terrainav.core.exports.localisers import LAYOUTS, export_benchmark
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.imageries import NamedImagery
from terrainav.core.mission.mission import Mission
from terrainav.core.picture.heights import mission_heights

from tests.support import rasters
from tests.support.command import command
from tests.support.thinning import sampled

EPSG = 32616
WEST, NORTH, SIDE = 230_000.0, 3_890_000.0, 420
PLACED = (WEST, 1.0, 0.0, NORTH, 0.0, -1.0)
GROUND_M = 35.0
TO_UTM = Transformer.from_crs(4326, EPSG, always_xy=True)
TO_DEGREES = Transformer.from_crs(EPSG, 4326, always_xy=True)
TO_ECEF = Transformer.from_crs(4979, 4978, always_xy=True)
FROM_ECEF = Transformer.from_crs(4978, 4979, always_xy=True)
#: Eastings and southings from the raster's corner of the places that are flown over.
AT_M = ((150.0, 150.0), (230.0, 160.0), (170.0, 250.0), (260.0, 260.0))


def hills(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Heights over the ellipsoid of the relief at eastings and southings."""
    return GROUND_M + 12.0 * np.sin(x / 40.0) * np.cos(y / 55.0)


@pytest.fixture(scope="module")
def imagery(tmp_path_factory):
    """Colours that tell their place, the same on a later date but darker, and heights."""
    folder = tmp_path_factory.mktemp("imagery")
    x, y = rasters.centres(PLACED, SIDE, SIDE)
    x, y = x - WEST, NORTH - y
    colours = rasters.position_colours(x, y)
    heights = hills(x, y)[np.newaxis].astype(np.float32)
    return {
        "old": rasters.write(folder / "old.tif", colours, PLACED, EPSG),
        "new": rasters.write(folder / "new.tif", colours // 2, PLACED, EPSG),
        "heights": rasters.write(folder / "heights.tif", heights, PLACED, EPSG, data_type=gdal.GDT_Float32),
    }


def made(imagery, folder, **asked) -> Benchmark:
    lon, lat = TO_DEGREES.transform(*(WEST + np.array(AT_M)[:, 0], NORTH - np.array(AT_M)[:, 1]))
    poses = tuple((*place, 60.0) for place in zip(lat.tolist(), lon.tolist()))
    values = {"tilt_deg": 18.0, "roll_deg": -7.0, "ground_height_m": GROUND_M, "image_px": 64, **asked}
    mission = Mission(Points(poses, (20.0, -70.0, 130.0, 200.0)), 60.0, accept_error=True, mesh="rays", **values)
    old, new = (NamedImagery(name, str(imagery[name])) for name in ("old", "new"))
    settings = BenchmarkSettings(mission, (old, new), old, split="same-area", shares=(0.5, 0.25, 0.25))
    sources = {str(one): open_source(one.source) for one in (old, new)}
    grids = {name: source.grid for name, source in sources.items()}
    worked_out = plan_benchmark(settings, grids, mission_heights(mission))
    return make_benchmark(worked_out, sources, folder).benchmark


@pytest.fixture(scope="module")
def level(imagery, tmp_path_factory) -> Benchmark:
    """Over level ground, as JPEG."""
    return made(imagery, tmp_path_factory.mktemp("level") / "bench", image_format="jpg")


@pytest.fixture(scope="module")
def relief(imagery, tmp_path_factory) -> Benchmark:
    """Over hills, as PNG."""
    heights = {"elevation": (str(imagery["heights"]),), "vertical_datum": "ellipsoid"}
    folder = tmp_path_factory.mktemp("relief") / "bench"
    return made(imagery, folder, image_format="png", ground_height_m=0.0, **heights)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def queries_of(folder: Path) -> dict[str, str]:
    """Queries by the files that they have become."""
    return {row["file"]: row["query"] for row in table(folder / "queries.csv")}


def part_of(benchmark: Benchmark, query: str) -> str:
    return benchmark.queries.part[benchmark.query_rows[query]]


def geocentric(origin: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """A frame's origin, and its east, north and up as columns."""
    lat, lon = np.radians([origin["lat_deg"], origin["lon_deg"]])
    place = np.array(TO_ECEF.transform(origin["lon_deg"], origin["lat_deg"], origin["height_m"]))
    east = [-np.sin(lon), np.cos(lon), 0.0]
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    up = [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]
    return place, np.stack([east, north, up], axis=1)


def utm(points_m: np.ndarray, origin: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Eastings and southings (n, 2) from the raster's corner, and heights, of points (n, 3) of a frame."""
    place, axes = geocentric(origin)
    lon, lat, height = FROM_ECEF.transform(*(place + points_m @ axes.T).T)
    x, y = TO_UTM.transform(lon, lat)
    return np.stack([x - WEST, NORTH - y], axis=1), height


def check_colours(image: np.ndarray, at: np.ndarray, scale: float, most: float) -> None:
    """Colours of pixels (h, w, 3) are those of the raster at eastings and southings (h, w, 2), but where they turn."""
    x, y = at[..., 0], at[..., 1]
    # Within half a pixel of its rim the reference's outermost pixels go on.
    inside = binary_erosion(np.isfinite(x), iterations=2)
    straight = inside & ~np.any([rasters.turns(wave, 3.0) for wave in (x, y, x + y)], axis=0)
    assert straight.sum() > 100
    told = np.stack([rasters.triangle(wave) for wave in (x, y, x + y)], axis=-1) * scale
    off = np.abs(image[straight].astype(float) - told[straight])
    assert off.max() <= most, off.max()


def projected(points_m: np.ndarray, pose: np.ndarray, k: np.ndarray) -> np.ndarray:
    seen = (points_m @ pose[:, :3].T + pose[:, 3]) @ k.T
    return seen[..., :2] / seen[..., 2:]


@pytest.mark.parametrize("ground", sampled(["level", "relief"], 2))
def test_ortholoc(ground, request, tmp_path):
    benchmark = request.getfixturevalue(ground)
    assert export_benchmark(benchmark, tmp_path / "out", "ortholoc") == 8
    origins = {row["sample_id"]: row for row in table(tmp_path / "out" / "origins.csv")}
    named = queries_of(tmp_path / "out")
    folders = {"train": "train", "validation": "val", "test": "test_inPlace"}
    files = sorted((tmp_path / "out").glob("*/*.npz"))
    assert len(files) == len(origins) == 8
    for file in files:
        query = named[file.relative_to(tmp_path / "out").as_posix()]
        assert folders[part_of(benchmark, query)] == file.parent.name
        # The other date is another domain.
        assert ("_xDOP" in file.stem) == query.startswith("new/")
        with np.load(file) as stored:
            one = {name: stored[name] for name in stored.files}
        name = str(one["sample_id"])
        origin = {key: float(value) for key, value in origins[name].items() if key != "sample_id"}
        points, k = one["point_map"].astype(float), one["intrinsics"].astype(float)
        high, wide = points.shape[:2]
        assert one["image_query"].shape == (high, wide, 3)
        # Pixels' centres have whole numbers.
        pixels = np.stack(np.meshgrid(np.arange(wide), np.arange(high)), axis=-1)
        assert np.abs(projected(points, one["extrinsics"].astype(float), k) - pixels).max() < 0.02
        at, height = utm(points.reshape(-1, 3), origin)
        truth = hills(*at.T) if ground == "relief" else GROUND_M
        # The surface is bilinear between pixels of 1 m.
        assert np.abs(height - truth).max() < (0.02 if ground == "relief" else 1e-3)
        # A query's pixel is a metre and more: a tenth of it, in levels, and a level for rounding; JPEG some more.
        darker = 0.5 if query.startswith("new/") else 1.0
        most = 1.7 if ground == "relief" else 14.0
        check_colours(one["image_query"], at.reshape(high, wide, 2), darker, most)

        dsm, step = one["dsm"].astype(float), one["scale"]
        assert dsm.shape == one["image_dop"].shape
        across, down = (np.arange(length) for length in dsm.shape[1::-1])
        assert np.abs(dsm[..., 0] - dsm[0, 0, 0] - across * step[0]).max() < 1e-3
        assert np.abs(dsm[..., 1] - dsm[0, 0, 1] - down[:, np.newaxis] * step[1]).max() < 1e-3
        assert step[1] == -step[0] < 0.0
        at, height = utm(dsm.reshape(-1, 3), origin)
        truth = hills(*at.T) if ground == "relief" else GROUND_M
        assert np.nanmax(np.abs(height - truth)) < (0.02 if ground == "relief" else 1e-3)
        check_colours(one["image_dop"], at.reshape((*dsm.shape[:2], 2)), 1.0, 2.0)
        # What the query shows is in the reference.
        low, top = np.nanmin(dsm[..., :2], axis=(0, 1)), np.nanmax(dsm[..., :2], axis=(0, 1))
        assert (points[..., :2] > low).all()
        assert (points[..., :2] < top).all()
        assert one["faces"].max() == len(one["vertices"]) - 1
        assert len(one["keypoints"]) == 256


@pytest.mark.parametrize("ground", ["level", "relief"])
def test_anyvisloc(ground, request, tmp_path):
    benchmark = request.getfixturevalue(ground)
    export_benchmark(benchmark, tmp_path / "out", "anyvisloc")
    named = queries_of(tmp_path / "out")
    scenes = sorted((tmp_path / "out").glob("Scene_*"))
    assert [scene.name for scene in scenes] == [f"Scene_{at:02d}" for at in range(1, 7)]
    seen = set()
    for scene in scenes:
        about = json.loads((scene / f"L{scene.name[-2:]}_reference.json").read_text())
        mode = about["modes"]["aerial"]
        assert mode == about["modes"]["satellite"]
        with Image.open(scene / mode["map_path"]) as image:
            shown = np.asarray(image)
        surface = np.load(scene / mode["dsm_path"])
        assert surface.shape == shown.shape[:2]
        assert abs(np.nanmean(surface)) < 0.01
        column, row = np.meshgrid(*(np.arange(length) for length in surface.shape[::-1]))
        local = np.stack([column * mode["map_resolution"][0], row * mode["map_resolution"][1], surface], axis=-1)
        first = np.array(about["first_pixel_m"])
        # East, south and up of the map's first pixel.
        enu = local * (1.0, -1.0, 1.0) + first
        at, height = utm(enu.reshape(-1, 3), about["origin"])
        at[np.isnan(surface.ravel())] = np.nan
        check_colours(shown, at.reshape((*surface.shape, 2)), 1.0, 2.0)
        truth = hills(*at.T) if ground == "relief" else GROUND_M
        assert np.nanmax(np.abs(height - truth)) < (0.02 if ground == "relief" else 1e-3)
        for file in scene.glob("L??_????.npz"):
            query = named[file.relative_to(tmp_path / "out").as_posix()]
            seen.add(query)
            with np.load(file) as one:
                pose, back, k, xyz = one["pose_w2c"], one["pose_c2w"], one["K"], one["xyz"]
                _, tilt, yaw = one["euler_deg"]
                image = one["image"]
                assert one["image_size"].tolist() == list(image.shape[:2])
            assert np.abs(pose @ back - np.eye(4)).max() < 1e-12
            assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)
            assert back[:3, 3] == pytest.approx(xyz * (1.0, -1.0, 1.0))
            row_at = benchmark.query_rows[query]
            camera = float(benchmark.queries.lon_deg[row_at]), float(benchmark.queries.lat_deg[row_at])
            at, height = utm((back[:3, 3] + first)[np.newaxis], about["origin"])
            assert at[0] == pytest.approx(
                [TO_UTM.transform(*camera)[0] - WEST, NORTH - TO_UTM.transform(*camera)[1]], abs=1e-5
            )
            assert height[0] == pytest.approx(float(benchmark.queries.height_m[row_at]), abs=1e-5)
            assert (yaw, tilt) == pytest.approx(
                (((float(benchmark.queries.yaw_deg[row_at]) + 180.0) % 360.0) - 180.0, 18.0)
            )
            # Pixels of the map have the query's colours where the pose puts them (none is hidden by such hills).
            pixels = projected(local * (1.0, -1.0, 1.0), pose[:3], k)
            nearest = np.rint(pixels)
            inside = (np.abs(pixels - nearest) < 0.08).all(axis=-1) & (nearest >= 0).all(axis=-1)
            inside &= (nearest < (image.shape[1], image.shape[0])).all(axis=-1)
            x, y = nearest[inside].astype(int).T
            spot = utm((local[inside] * (1.0, -1.0, 1.0)) + first, about["origin"])[0]
            straight = ~np.any([rasters.turns(wave, 3.0) for wave in (*spot.T, spot.sum(axis=1))], axis=0)
            assert straight.sum() > 20
            told = np.stack([rasters.triangle(wave) for wave in (*spot.T, spot.sum(axis=1))], axis=1)
            told *= 0.5 if query.startswith("new/") else 1.0
            most = 2.5 if ground == "relief" else 15.0
            assert np.abs(image[y, x].astype(float) - told)[straight].max() <= most
    assert seen == set(benchmark.queries.id)


def test_gta_uav(relief, tmp_path):
    export_benchmark(relief, tmp_path / "out", "gta-uav")
    folder, tiles = tmp_path / "out", relief.references
    shown = {}
    for file in (folder / "satellite").iterdir():
        zoom, offset, column, row = (int(part) for part in file.name.replace(".png", "").split("_"))
        side = 24576 / 2**zoom
        shown[file.name] = [(at + 0.5 + offset / 256) * side * 0.45 for at in (column, row)]
    assert len(shown) == len(tiles)
    # Metres east and south of the frame's origin.
    origin = json.loads((folder / "origin.json").read_text())
    place, axes = geocentric(origin)

    def metres(lat, lon):
        enu = (np.array(TO_ECEF.transform(lon, lat, 0.0)) - place) @ axes
        return enu[:2] * (1.0, -1.0)

    middles = np.array([metres(*angles) for angles in zip(tiles.lat_deg.tolist(), tiles.lon_deg.tolist())])
    by_name = {name: int(np.hypot(*(middles - at).T).argmin()) for name, at in shown.items()}
    assert sorted(by_name.values()) == list(range(len(tiles)))
    off = [np.hypot(*(middles[at] - shown[name])) for name, at in by_name.items()]
    assert max(off) < 0.008
    named = queries_of(folder)
    right = set(zip(relief.truth.query, relief.truth.reference, relief.truth.kind))
    found = set()
    for part in ("train", "validation", "test"):
        for entry in json.loads((folder / f"same-area-drone2sate-{part}.json").read_text()):
            query = named[f"{entry['drone_img_dir']}/{entry['drone_img_name']}"]
            at = relief.query_rows[query]
            assert part_of(relief, query) == part
            queries = relief.queries
            centre = metres(float(queries.centre_lat_deg[at]), float(queries.centre_lon_deg[at]))
            assert entry["drone_loc_x_y"] == pytest.approx(centre, abs=1e-3)
            everything = entry["pair_pos_semipos_sate_img_list"]
            for name, weight in zip(everything, entry["pair_pos_semipos_sate_weight_list"]):
                tile = tiles.id[by_name[name]]
                kind = POSITIVE if name in entry["pair_pos_sate_img_list"] else "semi-positive"
                found.add((query, tile, kind))
                assert weight >= (0.39 if kind == POSITIVE else 0.14)
            assert set(entry["pair_pos_sate_img_list"]) <= set(everything)
            with Image.open(folder / "drone" / "images" / entry["drone_img_name"]) as image:
                assert image.format == "PNG"
    assert found == right
    assert len(named) == 8


def test_uav_visloc(level, tmp_path):
    export_benchmark(level, tmp_path / "out", "uav-visloc")
    folder, named = tmp_path / "out", queries_of(tmp_path / "out")
    ranges = table(folder / "satellite_coordinates_range.csv")
    assert [row["mapname"] for row in ranges] == [f"satellite{at:02d}.tif" for at in range(1, 7)]
    count = 0
    for row in ranges:
        number = row["mapname"][9:11]
        with Image.open(folder / number / row["mapname"]) as image:
            pixels = np.asarray(image)
        high, wide = pixels.shape[:2]
        north, west, south, east = (
            float(row[name]) for name in ("LT_lat_map", "LT_lon_map", "RB_lat_map", "RB_lon_map")
        )
        lat = north + (np.arange(high)[:, np.newaxis] + 0.5) / high * (south - north)
        lon = west + (np.arange(wide) + 0.5) / wide * (east - west)
        x, y = TO_UTM.transform(*np.broadcast_arrays(lon, lat))
        at = np.stack([x - WEST, NORTH - y], axis=-1)
        at[(pixels == 0).all(axis=-1)] = np.nan
        check_colours(pixels, at, 1.0, 2.0)
        for flown in table(folder / number / f"{number}.csv"):
            query = named[f"{number}/drone/{flown['filename']}"]
            index, queries = level.query_rows[query], level.queries
            assert float(flown["lat"]) == queries.centre_lat_deg[index]
            assert float(flown["lon"]) == queries.centre_lon_deg[index]
            assert float(flown["height"]) == pytest.approx(60.0)
            assert (float(flown["Phi1"]) - queries.yaw_deg[index]) % 360.0 == pytest.approx(0.0)
            # JPEGs are the captured files.
            assert (folder / number / "drone" / flown["filename"]).samefile(level.folder / queries.file[index])
            count += 1
    assert count == 8


def images_in(folder: Path) -> dict[str, list[Path]]:
    """Images by the names of the folders that they are in."""
    return {one.name: sorted(one.iterdir()) for one in sorted(folder.iterdir())}


@pytest.mark.parametrize("layout", ["university-1652", "denseuav"])
def test_places(layout, level, tmp_path):
    export_benchmark(level, tmp_path / "out", layout)
    folder, named, dense = tmp_path / "out", queries_of(tmp_path / "out"), layout == "denseuav"
    labels = set()
    for inside in (
        "train/{}",
        "test/query_{}",
        "test/gallery_{}",
        "validation/query_{}",
        "validation/gallery_{}",
    ):
        views = {view: images_in(folder / inside.format(view)) for view in ("satellite", "drone")}
        assert list(views["satellite"]) == list(views["drone"])
        assert len(views["drone"]) == (2 if inside == "train/{}" else 1)
        for label, drone in views["drone"].items():
            assert len(label) == (6 if dense else 4)
            labels.add(int(label))
            # Both dates, of one place.
            own = [path.name for path in drone]
            assert own == (["H60.JPG", "H60_2.JPG"] if dense else ["image-01.jpeg", "image-02.jpeg"])
            for path in drone:
                query = named.get(path.relative_to(folder).as_posix())
                if query is not None:
                    assert path.samefile(level.folder / level.queries.file[level.query_rows[query]])
                    assert part_of(level, query) == inside.partition("/")[0]
                    check_middle(level, query, views["satellite"][label][0])
        if not dense:
            for view in ("street", "google") if inside == "train/{}" else ("street",):
                stand_ins = images_in(folder / inside.format(view))
                assert list(stand_ins) == list(views["drone"])
                for label, (path,) in stand_ins.items():
                    assert path.samefile(views["drone"][label][0])
    assert labels == {0, 1, 2, 3}
    assert len(named) == 8
    if not dense:
        assert "no photographs from the ground" in (folder / "README.txt").read_text(encoding="utf-8")
        return
    told = {}
    for line in (folder / "Dense_GPS_ALL.txt").read_text().splitlines():
        file, east, north, height = line.split(" ")
        told[file.split("/")[-2]] = float(east.split("E")[-1]), float(north.split("N")[-1]), float(height)
        at = level.query_rows[named[file]]
        centre = float(level.queries.centre_lon_deg[at]), float(level.queries.centre_lat_deg[at])
        assert told[file.split("/")[-2]] == pytest.approx((*centre, 60.0), abs=1e-8)
    assert {int(label) for label in told} == labels


def check_middle(benchmark: Benchmark, query: str, file: Path) -> None:
    """The middle of a view from above has the colour of the ground in the middle of the query."""
    with Image.open(file) as image:
        pixels = np.asarray(image, float)
    side = len(pixels)
    assert pixels.shape == (side, side, 3)
    at = benchmark.query_rows[query]
    lon, lat = float(benchmark.queries.centre_lon_deg[at]), float(benchmark.queries.centre_lat_deg[at])
    x, y = TO_UTM.transform(lon, lat)
    # Cut at whole pixels of 1 m: 4 levels a metre along each axis, and JPEG's noise.
    middle = pixels[side // 2 - 1 : side // 2 + 1, side // 2 - 1 : side // 2 + 1].mean(axis=(0, 1))
    for value, wave in zip(middle, (x - WEST, NORTH - y)):
        if not rasters.turns(np.array([wave]), 4.0)[0]:
            assert abs(value - rasters.triangle(np.array([wave]))[0]) < 4.0


def test_the_same_bytes_and_nothing_half_made(level, tmp_path, monkeypatch):
    def sums(folder):
        return {
            path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).digest()
            for path in folder.rglob("*")
            if path.is_file()
        }

    export_benchmark(level, tmp_path / "a", "ortholoc")
    export_benchmark(level, tmp_path / "b", "ortholoc")
    assert sums(tmp_path / "a") == sums(tmp_path / "b")

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(localisers, "_mesh", stopped)
    with pytest.raises(KeyboardInterrupt):
        export_benchmark(level, tmp_path / "c", "ortholoc")
    assert not (tmp_path / "c").exists()
    assert not (tmp_path / "c.part").exists()


def test_refusals_and_the_command(level, tmp_path, monkeypatch, capsys):
    assert set(BENCHMARKS) == set(LAYOUTS)
    with pytest.raises(InvalidInput, match="format 'kitti': must be one of university-1652, denseuav"):
        export_benchmark(level, tmp_path / "a", "kitti")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "own.txt").write_text("own")
    with pytest.raises(OutputError, match="is not empty; choose another folder"):
        export_benchmark(level, tmp_path / "mine", "denseuav")
    (tmp_path / "b.part").mkdir()
    with pytest.raises(OutputError, match="left over from an interrupted export; remove it"):
        export_benchmark(level, tmp_path / "b", "denseuav")
    monkeypatch.setattr(localisers, "_SCENES", 3)
    with pytest.raises(InvalidInput, match="6 scenes: AnyVisLoc's names have room for 3"):
        export_benchmark(level, tmp_path / "d", "anyvisloc")
    run = command(tmp_path, monkeypatch, capsys)
    done = run("export", str(level.folder), "new", "--as", "university-1652")
    assert (done.returncode, done.stdout) == (0, "8 queries as university-1652 in new\n")
    refused = run("export", str(level.folder), "other", "--as", "denseuav", "--map-type", "roadmap")
    assert refused.returncode == 2
    assert "benchmarks have none to choose from" in refused.stderr
