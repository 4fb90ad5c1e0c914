r"""What other programs read from datasets that have every effect of a real camera.

    python benchmarks/realism_peers.py capture everything      # 18 images and as many twins, in some minutes
    python benchmarks/realism_peers.py loaders everything
    .venv/peers/bin/python benchmarks/realism_peers.py colmap everything      # the environment of tools/setup.sh
    .venv/peers/bin/python benchmarks/realism_peers.py tags everything
    python benchmarks/realism_peers.py nerfstudio everything   # where nerfstudio 1.1.5 is installed
    python benchmarks/realism_peers.py opendronemap everything --odm ODM --opensfm OpenSfM

The last two need nothing of TerrAInav. The folders are checkouts of OpenDroneMap/ODM, with the packages of its
``requirements.txt``, and of mapillary/OpenSfM, compiled as its documentation says; their files run as they are. Each
command prints the greatest errors beside what is allowed, and fails beyond that.

Points of `EXPECTED` are where TerrAInav says that pixels look: on their rays, and on the ground by the product
``points``, whose rows have poses of their own. Programs project them by the exported cameras and poses alone.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

#: Every effect that goes with the others, over the synthetic world with its relief.
EVERYTHING = """
--coords 35.1420_-89.8670_35.1411_-89.8655_120 --yaw 30 --roll 4 --frame camera --image-px 160 --fov 70 --overlap 0.2
--elevation world --sun 40 120 --sampling area --mtf50 0.3 --vignetting cos4 --visibility-km 5 --airlight 190 196 204
--exposure manual --exposure-ms 2 --f-number 5.6 --iso 240 --white-balance-k 5600 --tone filmic --airspeed 20
--motion-blur --row-time-us 40 --image-sensor custom --pixel-um 3.45 --quantum-efficiency 0.64 --full-well-e 10400
--read-noise-e 2.1 --dark-current-e-per-s 2 --dsnu-e 1 --prnu 0.01 --bayer rggb --demosaicing malvar
--red-scale 0.001 --blue-scale -0.001 --principal-x 0.02 --principal-y -0.015 --start 2024-06-21T15:00:00Z
--keep-clean --keep-undistorted --format jpg --products raw points
--vary white_balance_k=uniform(4500,7500) visibility_km=loguniform(2,20) exposure_ms=lognormal(2,0.3)within(1,4)
tilt_deg=uniform(10,25)
""".split()
BROWN = "--k1 -0.2 --k2 0.05 --k3 -0.01 --p1 0.002 --p2 -0.001".split()
#: What follows `EVERYTHING`; each of the varied images has a lens of its own.
LENSES = {
    "brown": BROWN,
    "fisheye": "--lens fisheye --k1 0.02 --k2 -0.01 --k3 0.002".split(),
    "varied": ["fov_deg=uniform(62,78)", "k1=uniform(-0.25,-0.15)", *BROWN],
}
#: Images of each capture whose cameras are compared.
MAP_TYPES = "satellite", "satellite_undistorted"
EXPECTED = "expected.npz"
#: Columns of the table that loaders give: random values, and angles.
RANDOM, POSE = ("white_balance_k", "visibility_km", "exposure_ms"), ("yaw_deg", "tilt_deg", "roll_deg")
#: Errors allowed: px of points on rays and on the ground, and of cameras of which files have six digits; relative
#: rounding of numbers of 32 bits; a share of a value.
RAYS_PX, GROUND_PX, SIX_DIGITS_PX, SINGLE_PX, SHARE = 1e-6, 0.1, 1e-3, 2e-3, 1e-6
#: Accuracy of positions that files state.
ACCURACY_M = 0.01


class ImageSet(NamedTuple):
    """Images of one map type of a dataset."""

    folder: Path
    map_type: str

    @property
    def name(self) -> str:
        """Name in what is printed."""
        return f"{self.folder.name}, {self.map_type}"

    @property
    def exports(self) -> Path:
        """Folder of exports and expected points."""
        return self.folder / "exports" / self.map_type

    def rows(self) -> dict[str, dict[str, str]]:
        """Rows of the table, by image name."""
        with (self.folder / self.map_type / "meta_data.csv").open(newline="") as opened:
            return {row["img_names"]: row for row in csv.DictReader(opened)}

    @property
    def is_fisheye(self) -> bool:
        """Whether the table states a fisheye."""
        return next(iter(self.rows().values())).get("lens") == "fisheye"


def image_sets(folder: Path) -> list[ImageSet]:
    """Images of all lenses and map types."""
    return [ImageSet(folder / lens, map_type) for lens in LENSES for map_type in MAP_TYPES]


class Expected(NamedTuple):
    """Where pixels (k, 2) and (j, 2) of n images look, in the frame of the exports.

    Attributes
    ----------
    names : array (n,) of str
    ray_px, seen_m, ray_m : array (k, 2), (n, k, 3), (n, k, 3)
        Points on the pixels' rays, in the axes of the camera (right, down, view) and in the frame.
    ground_px, ground_m : array (j, 2), (n, j, 3)
        Points on the ground, moved as the camera moves from the time of their row to that of the image; j is 0 for
        undistorted images, of which there are no products.
    """

    names: Any
    ray_px: Any
    seen_m: Any
    ray_m: Any
    ground_px: Any
    ground_m: Any

    @classmethod
    def read(cls, images: ImageSet) -> Expected:
        """Read those of images."""
        with np.load(images.exports / EXPECTED) as stored:
            return cls(*(stored[name] for name in cls._fields))


def check(what: str, found: float, allowed: float, unit: str = "px") -> None:
    """Print an error beside what is allowed."""
    print(f"{what}: {found:.2g} {unit}, allowed {allowed:g}")
    if not found <= allowed:
        sys.exit(f"{what}: beyond what is allowed")


def same(what: str, found: object, given: object) -> None:
    """Fail unless values are equal."""
    if not np.array_equal(np.asarray(found), np.asarray(given)):
        sys.exit(f"{what}: {found!r}, and not {given!r}")


def capture(folder: Path) -> None:
    """Capture a dataset with each lens, export it, and write where its pixels look."""
    from terrainav.core.cli import main

    def run(*arguments: str) -> None:
        if main(list(arguments)):
            sys.exit(f"terrainav {' '.join(arguments)}")

    for lens, options in LENSES.items():
        run("capture", *EVERYTHING, *options, "--data-dir", str(folder / lens))
    for images in image_sets(folder):
        for kind in ("colmap", "nerfstudio"):
            asked = "--as", kind, "--map-type", images.map_type
            run("export", str(images.folder), str(images.exports / kind), *asked)
        np.savez(images.exports / EXPECTED, **_expected(images)._asdict())
    shards = "--layout-of-files", "webdataset"
    run("capture", *EVERYTHING, *BROWN, *shards, "--data-dir", str(folder / "shards"))


def _expected(images: ImageSet) -> Expected:
    """Points of the images' pixels."""
    from terrainav.core.exports.views import Views

    views = Views.read(images.folder, images.map_type)
    size = np.array([views.width_px[0], views.height_px[0]], float)
    rng = np.random.default_rng(1)
    ray_px = rng.uniform(0.0, 1.0, (200, 2)) * size
    cameras = [views.cameras.of(at) for at in range(len(views))]
    rays = np.stack([camera.rays_enu((ray_px - size / 2.0) / (size / (2.0, -2.0))) for camera in cameras])
    # A camera that looks straight down with north at its top has its axes to the east, south and down.
    seen_m = rays * (1.0, -1.0, -1.0) * rng.uniform(5.0, 500.0, (200, 1))
    ray_m = np.einsum("nji,nkj->nki", views.rotations, seen_m) + views.centres_m[:, np.newaxis]
    ground = _ground(images, views) if images.map_type == "satellite" else (np.zeros((0, 2)), ray_m[:, :0])
    return Expected(np.array(views.names), ray_px, seen_m, ray_m, *ground)


def _ground(images: ImageSet, views: Any) -> tuple[Any, Any]:
    """Every eighth pixel of the images, and the ground that it sees."""
    from osgeo import gdal

    gdal.UseExceptions()
    width, height = int(views.width_px[0]), int(views.height_px[0])
    columns, rows = (at.ravel() for at in np.meshgrid(np.arange(4, width, 8), np.arange(4, height, 8)))
    table, ground_m = images.rows(), np.empty((len(views), len(rows), 3))
    for at, name in enumerate(views.names):
        file = images.folder / "points" / f"{Path(name).stem}.tif"
        lon, lat, up = gdal.Open(str(file)).ReadAsArray()[:, rows, columns]
        row = table[name]
        speed = np.array([float(row[f"speed_{axis}_m_per_s"]) for axis in ("east", "north", "up")])
        same("turn rates", [float(row[f"{angle}_rate_deg_per_s"]) for angle in ("yaw", "tilt", "roll")], [0.0] * 3)
        after_s = (rows + 0.5 - height / 2.0) * float(row["row_time_us"]) * 1e-6
        ground_m[at] = views.frame.enu(lat, lon, up) - after_s[:, np.newaxis] * speed
    return np.stack([columns, rows], axis=1) + 0.5, ground_m


def colmap(folder: Path) -> None:
    """Project points by the models that COLMAP reads."""
    import pycolmap

    for images in image_sets(folder):
        expected = Expected.read(images)
        model = pycolmap.Reconstruction(images.exports / "colmap" / "sparse" / "0")
        posed = {image.name: image for image in model.images.values()}
        same(f"{images.name}, images", sorted(posed), sorted(expected.names))
        off_rays, off_ground = [], []
        for at, name in enumerate(expected.names.tolist()):
            camera, pose = model.cameras[posed[name].camera_id], posed[name].cam_from_world()
            off_rays.append(camera.img_from_cam(pose * expected.ray_m[at]) - expected.ray_px)
            sees_ground = np.isfinite(expected.ground_m[at]).all(axis=1)
            found = camera.img_from_cam(pose * expected.ground_m[at][sees_ground])
            off_ground.append(found - expected.ground_px[sees_ground])
        what = f"COLMAP {pycolmap.__version__}, {images.name}, {camera.model.name}, {len(posed)} images"
        check(f"{what}, points on rays", np.abs(off_rays).max(), RAYS_PX)
        if len(expected.ground_px):
            check(f"{what}, ground at the time of its row", np.abs(np.concatenate(off_ground)).max(), GROUND_PX)


def tags(folder: Path) -> None:
    """Compare EXIF with the table, by piexif and ExifTool, which must be installed (Debian: libimage-exiftool-perl)."""
    import piexif

    off: dict[str, float] = {}
    for images in image_sets(folder):
        table = images.rows()
        files = [images.folder / images.map_type / name for name in table]
        command = ["exiftool", "-json", "-n", "-G1", *map(str, files)]
        read = json.loads(subprocess.run(command, check=True, capture_output=True, timeout=60).stdout)
        for file, row, found in zip(files, table.values(), read):
            settings = piexif.load(str(file))["Exif"]
            times = [1e3 * _ratio(settings[33434]), 1e3 * found["ExifIFD:ExposureTime"]]
            numbers = {
                "exposure_ms": times,
                "f_number": [_ratio(settings[33437]), found["ExifIFD:FNumber"]],
                "iso": [settings[34855], found["ExifIFD:ISO"]],
            }
            for name, values in numbers.items():
                off[name] = max(off.get(name, 0.0), *(abs(value / float(row[name]) - 1.0) for value in values))
            # Exposure and white balance are manual.
            same("ExposureMode", [settings[41986], found["ExifIFD:ExposureMode"]], [1, 1])
            same("WhiteBalance", [settings[41987], found["ExifIFD:WhiteBalance"]], [1, 1])
            same("ModelType", found["XMP-Camera:ModelType"], "fisheye" if images.is_fisheye else "perspective")
    for name, share in off.items():
        check(f"piexif and ExifTool, {name}", share, SHARE, "of it")


def _ratio(parts: tuple[int, int]) -> float:
    return parts[0] / parts[1]


def nerfstudio(folder: Path) -> None:
    """Compare rays of the cameras that nerfstudio's parser reads, of single precision, with the pixels'."""
    import torch
    from nerfstudio.data.dataparsers.nerfstudio_dataparser import NerfstudioDataParserConfig

    for images in image_sets(folder):
        expected = Expected.read(images)
        told = NerfstudioDataParserConfig(
            data=images.exports / "nerfstudio",
            orientation_method="none",
            center_method="none",
            auto_scale_poses=False,
            eval_mode="all",
            downscale_factor=1,
        ).setup()
        parsed = told.get_dataparser_outputs()
        order = np.argsort(expected.names)
        same("nerfstudio, images", [file.name for file in parsed.image_filenames], expected.names[order])
        row_column = torch.from_numpy(expected.ray_px[:, ::-1].copy()).float()
        off = 0.0
        for at, points_m in enumerate(expected.ray_m[order]):
            rays = parsed.cameras.generate_rays(camera_indices=at, coords=row_column)
            towards = points_m - rays.origins.double().numpy()
            towards /= np.linalg.norm(towards, axis=1, keepdims=True)
            angle = np.linalg.norm(np.cross(rays.directions.double().numpy(), towards), axis=1)
            off = max(off, float((angle * parsed.cameras.fx[at].item()).max()))
        check(f"nerfstudio, {images.name}, {len(order)} images, points on rays", off, SINGLE_PX)


def opendronemap(folder: Path, odm: Path, opensfm: Path) -> None:
    """Read photos and both files with the code of OpenDroneMap and OpenSfM, and project points with their cameras."""
    sys.path[:0] = [str(odm), str(opensfm)]
    from opendm.camera import get_opensfm_camera_models
    from opendm.geo import GeoFile
    from opendm.photo import ODM_Photo
    from opensfm.io import cameras_from_json

    for images in image_sets(folder):
        photos, expected = images.folder / images.map_type, Expected.read(images)
        told = json.loads((photos / "cameras.json").read_text())
        cameras = cameras_from_json(get_opensfm_camera_models(told))
        places = GeoFile(str(photos / "geo.txt"))
        off_px, off_exposure, off_place_m = np.zeros((3, len(expected.names)))
        for at, (name, row) in enumerate(images.rows().items()):
            photo = ODM_Photo(str(photos / name))
            off_exposure[at] = _exposure_error(photo, row)
            photo.update_with_geo_entry(places.get_entry(name))
            off_place_m[at] = _place_error_m(photo, row)
            camera = cameras[photo.camera_id()]
            # OpenSfM counts from the middle of the image in units of its longer side.
            size = np.array([camera.width, camera.height])
            seen = camera.project_many(expected.seen_m[at]) * size.max() + size / 2.0
            off_px[at] = np.abs(seen - expected.ray_px).max()
        what = f"OpenDroneMap and OpenSfM, {images.name}, {camera.projection_type}, {len(off_px)} images"
        check(f"{what}, points on rays", off_px.max(), SIX_DIGITS_PX)
        check(f"{what}, exposure time, f-number and ISO", off_exposure.max(), SHARE, "of them")
        check(f"{what}, positions", off_place_m.max(), ACCURACY_M, "m")


def _exposure_error(photo: Any, row: dict[str, str]) -> float:
    """Greatest relative error of a photo's settings; its time of reading is that which OpenDroneMap is told."""
    readout_ms = float(row["row_time_us"]) * 1e-3 * float(row["image_height_px"])
    same("rolling shutter", photo.to_opensfm_exif(True, readout_ms)["rolling_shutter"], readout_ms)
    read = {"exposure_ms": photo.exposure_time * 1e3, "f_number": photo.fnumber, "iso": photo.iso_speed}
    return max(abs(value / float(row[name]) - 1.0) for name, value in read.items())


def _place_error_m(photo: Any, row: dict[str, str]) -> float:
    """Error of a photo's position; its angles have the table's digits."""
    given = [round(float(row[f"{angle}_deg"]), 9) for angle in ("yaw", "tilt", "roll")]
    same("yaw, pitch and roll", [photo.yaw, photo.pitch, photo.roll], given)
    off_deg = photo.latitude - float(row["pose_lat_deg"]), photo.longitude - float(row["pose_lon_deg"])
    return float(np.hypot(111_320.0 * np.hypot(*off_deg), photo.altitude - float(row["height_m"])))


def loaders(folder: Path) -> None:
    """Compare images and random values of the loaders with files and tables."""
    from PIL import Image

    os.environ.setdefault("KERAS_BACKEND", "torch")
    names = list(ImageSet(folder / "brown", "satellite").rows())
    # Clean images have no random values.
    for kind, columns in (("satellite", RANDOM), ("satellite_clean", POSE), ("satellite_undistorted", RANDOM)):
        table = ImageSet(folder / "brown", kind).rows()
        same(f"{kind}, names", list(table), names)
        targets = RANDOM if columns is RANDOM else ("attitude",)
        given = np.array([[row[name] for name in columns] for row in table.values()], np.float32)
        stored = np.stack([np.asarray(Image.open(folder / "brown" / kind / name)) for name in names])
        # In shards, twins are members of their image, and no map types of their own.
        for layout in ("brown", "shards") if kind == "satellite" else ("brown",):
            choice = {"map_type": kind, "part": "all", "shuffle": False, "dtype": "uint8", "targets": targets}
            for loader, batches in _all_batches(folder / layout, choice):
                images, values = (np.concatenate(parts) for parts in zip(*batches))
                same(f"{loader}, {layout}, {kind}", images, stored)
                same(f"{loader}, {layout}, {kind}", values, given)
                print(f"{loader}, {layout}, {kind}: {len(images)} images and {', '.join(columns)}, all alike")
        images, rows = _webdataset(folder / "shards", "jpg" if kind == "satellite" else f"{kind}.jpg")
        same("webdataset, names", [row["img_names"] for row in rows], names)
        same(f"webdataset, {kind}", images, stored)
        print(f"webdataset, shards, {kind}: {len(images)} images and rows, all alike")


def _all_batches(folder: Path, choice: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Batches of each loader, in numpy with channels last."""
    from terrainav.core.dataset.loading import Batches
    from terrainav.core.dataset.loading.keras_loader import KerasDataset
    from terrainav.core.dataset.loading.torch_loader import TorchDataset

    yield "numpy", list(Batches(folder, 4, **choice))
    from_torch = TorchDataset(folder, **choice).batches(4)
    yield "PyTorch", [(images.permute(0, 2, 3, 1).numpy(), values.numpy()) for images, values in from_torch]
    yield "Keras", [(np.asarray(images), np.asarray(values)) for images, values in KerasDataset(folder, 4, **choice)]


def _webdataset(folder: Path, ending: str) -> tuple[Any, list[dict[str, Any]]]:
    """Images (n, h, w, 3) of shards, and rows of their table, by webdataset."""
    import webdataset
    from PIL import Image

    shards = sorted(str(path) for path in (folder / "satellite").glob("*.tar"))
    samples = list(webdataset.WebDataset(shards, shardshuffle=False))
    images = np.stack([np.asarray(Image.open(io.BytesIO(sample[ending]))) for sample in samples])
    return images, [json.loads(sample["json"]) for sample in samples]


def main() -> None:
    """Do what the command says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    actions = {"capture": capture, "loaders": loaders, "colmap": colmap, "tags": tags, "nerfstudio": nerfstudio}
    parser.add_argument("action", choices=[*actions, "opendronemap"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--odm", type=Path)
    parser.add_argument("--opensfm", type=Path)
    chosen = parser.parse_args()
    if chosen.action == "opendronemap":
        opendronemap(chosen.folder, chosen.odm, chosen.opensfm)
    else:
        actions[chosen.action](chosen.folder)


if __name__ == "__main__":
    main()
