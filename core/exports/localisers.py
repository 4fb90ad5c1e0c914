"""Write benchmarks in the layouts of published sets for visual localisation.

The programs University1652-Baseline, DenseUAV, Game4Loc (GTA-UAV, UAV-VisLoc), OrthoLoC and AnyVisLoc read the files by
their names.
"""

from __future__ import annotations

import io
import math
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

from ..arrays import Bytes, Floats, NDArray
from ..benchmark.choices import CROSS_AREA
from ..benchmark.folder import POSITIVE, QUERIES_FILE, Benchmark, Queries, write_columns
from ..dataset.dataset import open_image
from ..dataset.entropy import Report
from ..dataset.folder import TEST, TRAIN, VALIDATION
from ..errors import InvalidInput
from ..geodesy.local import LocalFrame
from ..geodesy.mercator import wrap_lon_deg
from ..storage.files import (
    csv_bytes,
    json_bytes,
    link_or_copy,
    make_folder,
    partial_folder,
    write_whole,
)
from .huggingface import report_share
from .scenes import Ortho, OrthoGrid, SceneGround, local_frame
from .views import ORIGIN_FILE, origin_record

#: Pillow's formats by file ending.
_FORMATS = {".jpg": "JPEG", ".jpeg": "JPEG", ".png": "PNG"}
#: Most scenes, and most samples of a scene, that AnyVisLoc's names can number.
_SCENES, _SAMPLES = 99, 9999

_STREET = (
    "`street` and `google` hold no photographs from the ground, but stand-ins, so that programs which open them start: "
    "of each place, the most oblique query. No figure that is worked out with them says anything about street views."
)


@dataclass
class _Export:
    """An export in progress; ``files`` has the file of each exported query, by row."""

    benchmark: Benchmark
    folder: Path
    files: dict[int, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    progress: Report | None = None

    def rows(self, *parts: str) -> list[int]:
        """Rows of the queries of parts; in a benchmark without a split, all queries belong to the test part."""
        return [at for at, part in enumerate(self.benchmark.queries.part) if (part or TEST) in parts]

    def scenes(self) -> list[tuple[str, list[int]]]:
        """Title and rows of queries for each scene: one imagery and one part; queries in gaps have no scene."""
        queries = self.benchmark.queries
        found = []
        for name in dict.fromkeys(queries.imagery):
            for part in (TRAIN, VALIDATION, TEST):
                rows = [at for at in self.rows(part) if queries.imagery[at] == name]
                if rows:
                    found.append((f"{name}, {part}", rows))
        return found

    def picture(self, row: int, file: str) -> None:
        """Export the image of a query as ``file``."""
        self.image(self.benchmark.queries.file[row], file)
        self.files.setdefault(row, file)

    def image(self, stored: str, file: str) -> None:
        """Export an image of the benchmark as ``file``, whose ending states the format."""
        share = min(len(self.files) / max(len(self.benchmark.queries), 1), 1.0)
        report_share(self.progress, share)
        target, source = self.folder / file, self.benchmark.folder / stored
        wanted = _FORMATS[target.suffix.lower()]
        make_folder(target.parent)
        if _FORMATS.get(source.suffix.lower()) == wanted:
            link_or_copy(source, target)
        else:
            write_whole(target, _encoded(open_image(source, as_shown=True), wanted))

    def write(self, file: str, data: bytes) -> None:
        """Write a file of the export."""
        make_folder((self.folder / file).parent)
        write_whole(self.folder / file, data)

    def finish(self) -> None:
        """Write the table of queries and their files, and a README with notes."""
        rows = sorted(self.files)
        queries = self.benchmark.queries
        columns = {"query": queries.id, "part": queries.part}
        selected = {name: [values[at] for at in rows] for name, values in columns.items()}
        write_columns(self.folder / QUERIES_FILE, {**selected, "file": [self.files[at] for at in rows]})
        imagery = self.benchmark.about.get("imagery")
        sources = imagery.values() if isinstance(imagery, dict) else ()
        named = dict.fromkeys(
            str(one.get("attribution") or one.get("source")) for one in sources if isinstance(one, dict)
        )
        lines = [
            "Made with TerrAInav from a benchmark; queries.csv says which query became which file.",
            *self.notes,
        ]
        if named:
            lines.append(f"The imagery: {'; '.join(named)}.")
        self.write("README.txt", ("\n\n".join(lines) + "\n").encode("utf-8"))


def export_benchmark(
    benchmark: Benchmark, folder: str | os.PathLike[str], kind: str, progress: Report | None = None
) -> int:
    """Write a benchmark in the layout of a published set; return the number of exported queries.

    Until everything is written, the name of the folder ends in ``.part``. Images that already have the layout's format
    become hard links or copies; other images are encoded again. The same benchmark gives the same bytes.

    Parameters
    ----------
    kind : str
        One of `LAYOUTS`.
    progress : callable
        Called with the share done, 0 to 1, before each image; returning False cancels, and removes the export.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    InvalidInput
        The layout is unknown or has too few names for the scenes, or an image or the elevation cannot be read.
    OutputError
        The folder cannot be written, or is not empty.
    """
    if kind not in LAYOUTS:
        raise InvalidInput("format {0!r}: must be one of {1}", kind, ", ".join(LAYOUTS))
    with partial_folder(folder) as partial:
        export = _Export(benchmark, partial, progress=progress)
        LAYOUTS[kind](export)
        export.finish()
    return len(export.files)


# --- Places: folders of images whose names are labels


class _QueryGroup(NamedTuple):
    """Queries of one place."""

    part: str
    rows: list[int]


def _places(export: _Export) -> list[_QueryGroup]:
    """Groups of queries whose centres agree to 0.1 m, in the order of first queries."""
    queries = export.benchmark.queries
    found: dict[tuple[str, float, float], list[int]] = {}
    for at in export.rows(TRAIN, VALIDATION, TEST):
        lat, lon = (float(angle[at]) for angle in (queries.centre_lat_deg, queries.centre_lon_deg))
        key = queries.part[at] or TEST, round(lat, 6), round(lon, 6)
        found.setdefault(key, []).append(at)
    return [_QueryGroup(key[0], rows) for key, rows in found.items()]


def _folders(part: str, view: str, label: str) -> list[str]:
    """Folders of the images of a place; except in training, queries are in the gallery, too."""
    if part == TRAIN:
        return [f"{TRAIN}/{view}/{label}"]
    return [f"{part}/{kind}_{view}/{label}" for kind in ("query", "gallery")]


def _aerial_crop(ground: SceneGround, row: int) -> Image.Image:
    """Crop of the reference around the middle of a query, as wide as a tile; black outside the reference."""
    benchmark = ground.benchmark
    mosaic, queries, tiles = benchmark.mosaic, benchmark.queries, benchmark.references
    side = round(float(tiles.east[0] - tiles.west[0]) / mosaic.pixel_width)
    column, line = mosaic.px(queries.centre_lat_deg[row : row + 1], queries.centre_lon_deg[row : row + 1])
    left, top = (round(float(at[0]) - side / 2.0) for at in (column, line))
    return Image.fromarray(ground.crop(left, top, side))


def _university(export: _Export) -> None:
    """University-1652: a folder for each place, with satellite and drone views."""
    ground, queries = SceneGround(export.benchmark, None), export.benchmark.queries
    for number, place in enumerate(_places(export)):
        label = f"{number:04d}"
        aerial = _encoded(_aerial_crop(ground, place.rows[0]), "JPEG")
        for inside in _folders(place.part, "satellite", label):
            export.write(f"{inside}/{label}.jpg", aerial)
        names = {row: f"image-{at:02d}.jpeg" for at, row in enumerate(place.rows, 1)}
        for row, name in names.items():
            for inside in _folders(place.part, "drone", label):
                export.picture(row, f"{inside}/{name}")
        oblique = max(place.rows, key=lambda row: (_off_nadir(queries, row), -row))
        for view in ("street", "google") if place.part == TRAIN else ("street",):
            for inside in _folders(place.part, view, label):
                export.picture(oblique, f"{inside}/{names[oblique]}")
    export.notes.append(_STREET)


def _off_nadir(queries: Queries, row: int) -> float:
    """Angle between the view of a query and straight down, degrees."""
    tilt, roll = (math.radians(float(angle[row])) for angle in (queries.tilt_deg, queries.roll_deg))
    return math.degrees(math.acos(min(math.cos(tilt) * math.cos(roll), 1.0)))


def _denseuav(export: _Export) -> None:
    """DenseUAV: a folder for each place; ``Dense_GPS_….txt`` lists file, longitude, latitude and height."""
    ground, queries = SceneGround(export.benchmark, None), export.benchmark.queries
    heights_m = queries.poses.agl_m
    lines: dict[str, list[str]] = {TRAIN: [], VALIDATION: [], TEST: []}
    for number, place in enumerate(_places(export)):
        label = f"{number:06d}"
        names = _names_by_height(heights_m, place.rows)
        aerial = _encoded(_aerial_crop(ground, place.rows[0]), "TIFF")
        for row, name in names.items():
            for view in ("drone", "satellite"):
                for inside in _folders(place.part, view, label):
                    file = f"{inside}/{name}"
                    if view == "drone":
                        export.picture(row, f"{file}.JPG")
                    else:
                        export.write(f"{file}.tif", aerial)
            first = _folders(place.part, "drone", label)[0]
            lat, lon = float(queries.centre_lat_deg[row]), float(queries.centre_lon_deg[row])
            lines[place.part].append(f"{first}/{name}.JPG E{lon:.9f} N{lat:.9f} {heights_m[row]:.3f}\n")
    for ending, parts in (("ALL", tuple(lines)), ("train", (TRAIN,)), ("test", (TEST,))):
        export.write(f"Dense_GPS_{ending}.txt", "".join(line for part in parts for line in lines[part]).encode())


def _names_by_height(heights_m: Floats, rows: list[int]) -> dict[int, str]:
    """Names of the images of a place: H and the height in metres, then a number if another image has this height."""
    found: dict[int, str] = {}
    for row in rows:
        name = f"H{heights_m[row]:.0f}"
        again = sum(one.partition("_")[0] == name for one in found.values())
        found[row] = f"{name}_{again + 1}" if again else name
    return found


# --- Pairs and flights


def _gta(export: _Export) -> None:
    """GTA-UAV: drone images, tiles with their position in the name, and JSON of matching tiles."""
    benchmark = export.benchmark
    queries, tiles, mosaic = benchmark.queries, benchmark.references, benchmark.mosaic
    corner = mosaic.ground(np.zeros(1), np.zeros(1))
    frame = LocalFrame(*(round(float(angle[0]), 6) for angle in corner))
    middles = frame.enu(tiles.lat_deg, tiles.lon_deg, np.zeros(len(tiles)))[:, :2] * (1.0, -1.0)
    names, places = [], []
    # Each side of GTA-UAV's map has 24576 pixels of 0.45 m and is divided into 2^zoom tiles. Names of tiles have zoom,
    # offset, column and row. At zoom 20, columns are 1.05 cm wide, so names state the middles of tiles to 8 mm.
    widths = list(dict.fromkeys(tiles.width_m.tolist()))
    for middle, width in zip(middles.tolist(), tiles.width_m.tolist()):
        zoom = 20 + widths.index(width)
        step = 24576 / 2**zoom * 0.45
        column, row = (math.floor(at / step) for at in middle)
        names.append(f"{zoom}_0_{column}_{row}.png")
        places.append([(column + 0.5) * step, (row + 0.5) * step])
    for name, file in zip(names, tiles.file):
        export.image(file, f"satellite/{name}")
    right: dict[int, list[tuple[float, int, bool]]] = {}
    truth = benchmark.truth
    for query, tile, kind, iou in zip(truth.query, truth.reference, truth.kind, truth.iou.tolist()):
        pair = (-iou, benchmark.reference_rows[tile], kind == POSITIVE)
        right.setdefault(benchmark.query_rows[query], []).append(pair)
    area = "cross" if benchmark.about.get("split") == CROSS_AREA else "same"
    seen = frame.enu(queries.centre_lat_deg, queries.centre_lon_deg, np.zeros(len(queries)))[:, :2]
    shown, poses = seen * (1.0, -1.0), queries.poses
    numbers = {name: number for number, name in enumerate(dict.fromkeys(queries.imagery), 1)}
    for part in (TRAIN, VALIDATION, TEST):
        entries = []
        for row in export.rows(part):
            height = float(poses.agl_m[row])
            name = f"{height:.0f}_{numbers[queries.imagery[row]]:04d}_{row:010d}.png"
            export.picture(row, f"drone/images/{name}")
            entry: dict[str, Any] = {
                "drone_img_dir": "drone/images",
                "drone_img_name": name,
                "drone_loc_x_y": shown[row].tolist(),
                "sate_img_dir": "satellite",
            }
            pairs = sorted(right.get(row, []))
            for key, some in (("pos", [one for one in pairs if one[2]]), ("pos_semipos", pairs)):
                entry[f"pair_{key}_sate_img_list"] = [names[at] for _, at, _ in some]
                entry[f"pair_{key}_sate_weight_list"] = [-minus for minus, _, _ in some]
                entry[f"pair_{key}_sate_loc_x_y_list"] = [places[at] for _, at, _ in some]
            yaw, tilt, roll = (float(angle[row]) for angle in poses.attitude)
            # In GTA-UAV, roll is about the wing, with -90 straight down; pitch is our roll; yaw is anticlockwise.
            turns = {"pitch": roll, "yaw": -yaw}
            entry["drone_metadata"] = {
                "height": height,
                **{f"drone_{axis}": angle for axis, angle in {"roll": tilt, **turns}.items()},
                **{f"cam_{axis}": angle for axis, angle in {"roll": tilt - 90.0, **turns}.items()},
            }
            entries.append(entry)
        if entries:
            export.write(f"{area}-area-drone2sate-{part}.json", json_bytes(entries))
    export.write(ORIGIN_FILE, json_bytes({**origin_record(frame), "axes": ["east", "south"]}))


def _visloc(export: _Export) -> None:
    """UAV-VisLoc: flights, each with a map in square pixels of degrees, and a table of the maps' corners."""
    benchmark, queries = export.benchmark, export.benchmark.queries
    image, (north, west, south, east) = _resample_degrees(SceneGround(benchmark, None))
    whole = _encoded(Image.fromarray(image), "TIFF")
    poses = queries.poses
    headings_deg = wrap_lon_deg(poses.yaw_deg)
    ranges = []
    first = ""
    for number, (title, rows) in enumerate(export.scenes(), 1):
        two = f"{number:02d}"
        name = f"satellite{two}.tif"
        if first:
            make_folder(export.folder / two)
            link_or_copy(export.folder / first, export.folder / two / name)
        else:
            first = f"{two}/{name}"
            export.write(first, whole)
        ranges.append([name, north, west, south, east, title])
        lines = []
        for at, row in enumerate(rows, 1):
            image_name = f"{two}_{at:04d}.JPG"
            export.picture(row, f"{two}/drone/{image_name}")
            height, tilt, roll, heading = (
                float(values[row]) for values in (poses.agl_m, poses.tilt_deg, poses.roll_deg, headings_deg)
            )
            lat, lon = float(queries.centre_lat_deg[row]), float(queries.centre_lon_deg[row])
            date = _date(benchmark, queries.imagery[row])
            lines.append([at, image_name, date, lat, lon, height, tilt, roll, heading, heading])
        header = ["num", "filename", "date", "lat", "lon", "height", "Omega", "Kappa", "Phi1", "Phi2"]
        export.write(f"{two}/{two}.csv", csv_bytes([header, *lines]))
    header = ["mapname", "LT_lat_map", "LT_lon_map", "RB_lat_map", "RB_lon_map", "region"]
    export.write("satellite_coordinates_range.csv", csv_bytes([header, *ranges]))


def _date(benchmark: Benchmark, imagery: str) -> str:
    """Date of an imagery; empty if unknown."""
    imageries = benchmark.about.get("imagery")
    one = imageries.get(imagery) if isinstance(imageries, dict) else None
    return str(one.get("date") or "") if isinstance(one, dict) else ""


def _resample_degrees(ground: SceneGround) -> tuple[Bytes, tuple[float, float, float, float]]:
    """Reference resampled to square pixels in degrees, and its edges: north, west, south and east."""
    mosaic = ground.benchmark.mosaic
    high, wide = ground.mosaic.shape[:2]
    lat, lon = mosaic.rim()
    # Make longitudes continuous across the antimeridian.
    lon = lon[0] + wrap_lon_deg(lon - lon[0])
    middle, _ = mosaic.ground(np.full(2, wide / 2.0), high / 2.0 + np.array([-0.5, 0.5]))
    pixel = abs(float(middle[0] - middle[1]))
    columns, rows = (math.ceil(float(np.ptp(angle)) / pixel - 1e-6) for angle in (lon, lat))
    north, west = float(lat.max()), float(lon.min())
    image = np.zeros((rows, columns, 3), np.uint8)
    x = west + (np.arange(columns) + 0.5) * pixel
    for row in range(rows):
        image[row], _ = ground.sample(np.full(columns, north - (row + 0.5) * pixel), x)
    return image, (north, west, north - rows * pixel, west + columns * pixel)


# --- Samples with heights


def _ortholoc(export: _Export) -> None:
    """OrthoLoC: a file for each query with its image, the ground of each pixel, and the reference with heights."""
    benchmark, ground = export.benchmark, SceneGround.from_benchmark(export.benchmark)
    queries = benchmark.queries
    reference = str(benchmark.about.get("reference", "")).partition("=")[2]
    named = benchmark.about.get("imageries")
    texts = [str(one).partition("=") for one in named] if isinstance(named, list) else []
    alike = {name for name, _, source in texts if source == reference}
    test = "test_outPlace" if benchmark.about.get("split") == CROSS_AREA else "test_inPlace"
    folders = {TRAIN: "train", VALIDATION: "val", TEST: test}
    origins = []
    for row in export.rows(*folders):
        lat, lon = float(queries.centre_lat_deg[row]), float(queries.centre_lon_deg[row])
        frame = local_frame(lat, lon, float(queries.ground_m[row]))
        name = f"L01_{'R' if queries.imagery[row] in alike else 'xDOP'}{row:04d}"
        file = f"{folders[queries.part[row] or TEST]}/{name}.npz"
        export.write(file, _npz({"sample_id": np.array(name), **_ortholoc_sample(ground, row, frame)}))
        export.files[row] = file
        origins.append([name, frame.lat_deg, frame.lon_deg, frame.height_m])
    export.write("origins.csv", csv_bytes([["sample_id", "lat_deg", "lon_deg", "height_m"], *origins]))


def _ortholoc_sample(ground: SceneGround, row: int, frame: LocalFrame) -> dict[str, NDArray[Any]]:
    """Arrays of a sample, by name; coordinates are in metres in the frame."""
    points, camera = ground.points(row, frame), ground.camera(row, frame)
    seen = points[np.isfinite(points[..., 0])]
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    # OrthoLoC's references are squares of up to 1024 pixels; here they have a margin of a tenth on each side.
    side = float((high - low).max()) * 1.2
    count = min(max(math.ceil(side / ground.pixel_m(frame)), 2), 1024)
    pixel = side / count
    west, north = (low[0] + high[0] - side + pixel) / 2.0, (low[1] + high[1] + side - pixel) / 2.0
    above = ground.ortho(frame, OrthoGrid(float(west), float(north), pixel, count, count))
    vertices, faces = _mesh(above)
    spread = [np.linspace(0, length - 1, min(16, length)).astype(int) for length in points.shape[:2]]
    few = points[np.ix_(*spread)].reshape(-1, 3)
    pose = np.column_stack([camera.rotation, -camera.rotation @ camera.centre_m]).astype(np.float32)
    return {
        "image_query": ground.benchmark.colours(ground.benchmark.queries.file[row]),
        "point_map": points.astype(np.float32),
        "image_dop": above.image,
        "dsm": above.points_m.astype(np.float32),
        # Rows run south.
        "scale": np.array([pixel, -pixel]),
        "extrinsics": pose,
        "intrinsics": camera.k.astype(np.float32),
        "keypoints": few[np.isfinite(few[:, 0])].astype(np.float32),
        "vertices": vertices,
        "faces": faces,
        # OrthoLoC has refined poses of a reconstruction; here, the poses are exact and need no refinement.
        "extrinsics_refined": pose,
    }


def _mesh(above: Ortho) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Vertices (m, 3) and triangles (l, 3) of the surface, from up to 33 by 33 of its pixels."""
    rows, columns = (np.linspace(0, length - 1, min(33, length)).astype(int) for length in above.image.shape[:2])
    vertices = above.points_m[np.ix_(rows, columns)].reshape(-1, 3).astype(np.float32)
    at = np.arange(len(vertices)).reshape(len(rows), len(columns))
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[:-1, 1:], at[1:, :-1], at[1:, 1:]))
    faces = np.concatenate([np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)])
    is_known = np.isfinite(vertices).all(axis=1)
    number = np.cumsum(is_known) - 1
    return vertices[is_known], number[faces[is_known[faces].all(axis=1)]].astype(np.int32)


def _anyvisloc(export: _Export) -> None:
    """AnyVisLoc: scenes of samples with a map and its heights, in metres east and south of the map's first pixel."""
    benchmark, ground = export.benchmark, SceneGround.from_benchmark(export.benchmark)
    queries, mosaic = benchmark.queries, benchmark.mosaic
    middle = mosaic.ground(np.array([mosaic.width_px / 2.0]), np.array([mosaic.height_px / 2.0]))
    lat, lon = (float(angle[0]) for angle in middle)
    frame = local_frame(lat, lon, float(np.median(queries.ground_m)))
    west, south, east, north = ground.bounds_m(frame)
    pixel = ground.pixel_m(frame)
    size = (math.ceil(length / pixel - 1e-6) for length in (east - west, north - south))
    grid = OrthoGrid(west + pixel / 2.0, north - pixel / 2.0, pixel, *size)
    above = ground.ortho(frame, grid)
    # Heights are stated above the mean height of the surface.
    base_m = round(float(np.nanmean(above.points_m[..., 2])), 3)
    first = np.array([grid.west_m, grid.north_m, base_m])
    maps = {
        "satellite_map.png": _encoded(Image.fromarray(above.image), "PNG"),
        "satellite_dsm.npy": _npy((above.points_m[..., 2] - base_m).astype(np.float32)),
    }
    mode = {
        "map_path": "satellite_map.png",
        "dsm_path": "satellite_dsm.npy",
        "map_resolution": [pixel, pixel],
        "dsm_resolution": [pixel, pixel],
        "map_origin_local": [0.0, 0.0],
        "dsm_origin_local": [0.0, 0.0],
    }
    headings_deg = wrap_lon_deg(queries.yaw_deg)
    for number, (title, rows) in _numbered(export):
        scene = f"Scene_{number:02d}"
        for name, data in maps.items():
            export.write(f"{scene}/{name}", data)
        scene_facts = {
            "scene_id": number,
            "title": title,
            "modes": {"satellite": mode, "aerial": mode},
            # pose_w2c is in metres east, north and up of `first_pixel_m` in the frame of `origin`.
            "origin": origin_record(frame),
            "first_pixel_m": first.tolist(),
        }
        export.write(f"{scene}/L{number:02d}_reference.json", json_bytes(scene_facts))
        for at, row in enumerate(rows, 1):
            name = f"L{number:02d}_{at:04d}"
            camera = ground.camera(row, frame)
            centre = camera.centre_m - first
            to_camera, to_world = np.eye(4), np.eye(4)
            to_camera[:3, :3], to_camera[:3, 3] = camera.rotation, -camera.rotation @ centre
            to_world[:3, :3], to_world[:3, 3] = camera.rotation.T, centre
            image = benchmark.colours(queries.file[row])
            tilt, roll = float(queries.tilt_deg[row]), float(queries.roll_deg[row])
            arrays = {
                "sample_id": np.array(name),
                "scene_id": np.array(number),
                "image": image,
                "image_size": np.array(image.shape[:2], np.int32),
                "original_size": np.array(image.shape[:2], np.int32),
                "uav_downsample": np.array(1.0),
                "K": camera.k,
                "dist": np.zeros(5),
                "pose_w2c": to_camera,
                "pose_c2w": to_world,
                "xyz": centre * (1.0, -1.0, 1.0),
                "euler_deg": np.array([roll, tilt, float(headings_deg[row])]),
            }
            export.write(f"{scene}/{name}.npz", _npz(arrays))
            export.files[row] = f"{scene}/{name}.npz"


def _numbered(export: _Export) -> Iterator[tuple[int, tuple[str, list[int]]]]:
    """Scenes numbered from 1; a scene with too many samples is divided."""
    cut = [
        (title, rows[start : start + _SAMPLES])
        for title, rows in export.scenes()
        for start in range(0, len(rows), _SAMPLES)
    ]
    if len(cut) > _SCENES:
        raise InvalidInput("{0:,} scenes: AnyVisLoc's names have room for {1}", len(cut), _SCENES)
    return iter(enumerate(cut, 1))


# --- Bytes


def _encoded(image: Image.Image, wanted: str) -> bytes:
    """Image encoded in one of Pillow's formats."""
    buffer = io.BytesIO()
    # JPEGs have the quality of captures.
    options: dict[str, Any] = {"quality": 95, "subsampling": 0} if wanted == "JPEG" else {}
    # Readers expect three channels.
    image.convert("RGB").save(buffer, wanted, **options)
    return buffer.getvalue()


def _npz(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def _npy(array: NDArray[Any]) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    return buffer.getvalue()


#: Writers of layouts by name.
LAYOUTS: Mapping[str, Callable[[_Export], None]] = {
    "university-1652": _university,
    "denseuav": _denseuav,
    "uav-visloc": _visloc,
    "gta-uav": _gta,
    "ortholoc": _ortholoc,
    "anyvisloc": _anyvisloc,
}
