"""Captures with classes and instances beside the same without, and the pictures of docs/labels.md and buildings.md.

    python benchmarks/labels.py                      # milliseconds an image, by frame and format, in turns
    python benchmarks/labels.py --images 10000       # as many images in all
    python benchmarks/labels.py --pictures docs/images --data ../shared/data

The pictures need orthophotos of NAIP, a surface and a ground model with footprints, and a CityJSON file of Delft: see
the paths below.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from PIL import Image, ImageDraw
from terrainav.core.capture.runner import capture
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

TOWN = (35.158, -89.897)
JPEG_QUALITY = 85
REPEATS = 3
#: Colours of instances, in the order of their numbers: safe for colour-blind readers (Okabe and Ito).
COLOURS = ((0, 114, 178), (230, 159, 0), (0, 158, 115), (204, 121, 167), (86, 180, 233), (213, 94, 0), (240, 228, 66))


def fields_file(folder: Path, across: int) -> str:
    """Write a chequered land of fields with bent edges, ``across`` in a row, of seven kinds."""
    path, some = folder / "fields.geojson", np.random.default_rng(1)
    side, features = 2e-4, []
    for row, column in np.ndindex(across, across):
        angle = np.sort(some.uniform(0.0, 2.0 * np.pi, 24))
        away = side * 0.48 * some.uniform(0.7, 1.0, 24)
        x, y = TOWN[1] + (column - across / 2.0) * side, TOWN[0] + (row - across / 2.0) * side
        ring = np.stack([x + away * np.cos(angle), y + away * np.sin(angle)], axis=1).tolist()
        geometry = {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}
        features.append({"type": "Feature", "properties": {"kind": (row + column) % 7}, "geometry": geometry})
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}), "utf-8")
    return str(path)


def mission_of(count: int, labels: tuple[str, ...], **more: object) -> Mission:
    """Mission of about ``count`` images of 640 x 480 px over the fields."""
    half = 0.006 * float(np.sqrt(count / 345.0))
    box = Box(TOWN[0] + half, TOWN[1] - 1.3 * half, TOWN[0] - half, TOWN[1] + 1.3 * half)
    camera = Camera(60.0, 4.0 / 3.0)
    overlaps = {"overlap_along": 0.6, "overlap_across": 0.3}
    return Mission(box, 120.0, labels=labels, camera=camera, image_px=640, **overlaps, **more)  # type: ignore[arg-type]


def times(count: int) -> None:
    """Print milliseconds an image with and without labels, the best of several captures in turns."""
    print("| frame | format | images | without, ms | with, ms | ratio |")
    print("| --- | --- | --- | --- | --- | --- |")
    frames: tuple[dict[str, object], ...] = (
        {"frame": "map"},
        {"frame": "camera", "tilt_deg": 30.0},
        {"frame": "camera", "tilt_deg": 30.0, "elevation": ("60",)},
    )
    with tempfile.TemporaryDirectory() as folder:
        layer = f"{fields_file(Path(folder), 100)}:kind"
        for frame in frames:
            for image_format in ("tif", "jpg"):
                taken = {False: np.inf, True: np.inf}
                images = 0
                for _ in range(REPEATS if count < 2000 else 1):
                    for has_labels in taken:
                        mission = mission_of(count, (layer,) * has_labels, image_format=image_format, **frame)
                        source = open_source("world")
                        made = plan(mission, source.grid, mission_heights(mission))
                        images = len(made)
                        begun = time.perf_counter()
                        capture(made, source, tempfile.mkdtemp(dir=folder), workers=1)
                        taken[has_labels] = min(taken[has_labels], (time.perf_counter() - begun) / images * 1e3)
                name = ", ".join(
                    f"{key} {' '.join(value) if key == 'elevation' else value}" for key, value in frame.items()
                )
                ratio = taken[True] / taken[False]
                print(
                    f"| {name} | {image_format} | {images:,} | {taken[False]:.1f} | {taken[True]:.1f} | {ratio:.2f} |"
                )


def shot(folder: Path, lat: float, lon: float, agl_m: float, **more: object) -> dict[str, np.ndarray]:
    """Image of a pose with its products, by name."""
    mission = Mission(Points(((lat, lon, agl_m),)), agl_m, image_format="png", **more)  # type: ignore[arg-type]
    source = open_source(mission.imagery.source)
    capture(plan(mission, source.grid, mission_heights(mission)), source, folder, workers=1)
    found = {}
    for name in (mission.imagery.map_types[0], *mission.products):
        (path,) = [one for one in (folder / name).iterdir() if one.suffix in (".png", ".tif")]
        with Image.open(path) as image:
            found[name] = np.asarray(image.convert("RGB") if image.mode in ("P", "RGBA") else image)
    return found


def in_colours(instances: np.ndarray) -> np.ndarray:
    """Instances in colours of their numbers; grey where there is none."""
    table = np.array(COLOURS, np.uint8)
    mixed = (instances.astype(np.int64) * 2654435761 >> 7) % len(COLOURS)
    found: np.ndarray = np.where((instances == 0)[..., np.newaxis], np.uint8(225), table[mixed])
    return found


def over(image: np.ndarray, marks: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Image with colours laid half over it at some pixels."""
    mixed = (image.astype(int) + marks) // 2
    return np.where(where[..., np.newaxis], mixed, image).astype(np.uint8)


def sheet(path: Path, pictures: list[tuple[str, np.ndarray]], legend: list[tuple[str, str]] | None = None) -> None:
    """Write pictures beside each other with titles above, and a legend below: names and colours."""
    from PIL import ImageFont

    font = ImageFont.truetype("DejaVuSans.ttf", 17)
    high, wide = pictures[0][1].shape[:2]
    page = Image.new("RGB", ((wide + 8) * len(pictures) - 8, high + 30 + 30 * bool(legend)), "white")
    pen = ImageDraw.Draw(page)
    for k, (title, pixels) in enumerate(pictures):
        pen.text((k * (wide + 8) + 4, 5), title, fill="black", font=font)
        page.paste(Image.fromarray(pixels), (k * (wide + 8), 30))
    left = 4
    for name, colour in legend or []:
        pen.rectangle((left, high + 38, left + 16, high + 54), fill=colour, outline="black")
        pen.text((left + 24, high + 36), name, fill="black", font=font)
        left += 54 + int(pen.textlength(name, font=font))
    page.save(path, quality=JPEG_QUALITY)
    print(path)


def legend_of(folder: Path) -> list[tuple[str, str]]:
    """Names and colours of a dataset's classes."""
    told = json.loads((folder / "classes.json").read_text("utf-8"))
    return [(one["name"], one["color"]) for one in told["classes"]]


def land_cover(naip: Path, path: Path) -> None:
    """Draw polygons around what an orthophoto's bands tell apart: water, bare soil, grass and crops."""
    import rasterio
    from rasterio import features
    from scipy import ndimage

    with rasterio.open(naip) as file:
        red, _, _, infrared = file.read().astype(float)
        transform, crs = file.transform, file.crs
    # Smoothed and four times as fine, for edges without steps.
    greenness, bright, infrared = (
        ndimage.zoom(ndimage.gaussian_filter(band, 2.0), 4, order=1, grid_mode=True, mode="nearest")
        for band in ((infrared - red) / np.maximum(infrared + red, 1.0), red, infrared)
    )
    kinds = np.select([infrared < 60.0, (greenness < 0.15) & (bright > 110.0), greenness < 0.3], [1, 2, 3], 4)
    kinds = features.sieve(kinds.astype(np.uint8), 2400)
    names = {1: "water", 2: "bare soil", 3: "grass", 4: "crops"}
    shapes = [
        {"type": "Feature", "properties": {"cover": names[int(value)]}, "geometry": shape}
        for shape, value in features.shapes(kinds, transform=transform * transform.scale(0.25))
    ]
    named = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{crs.to_epsg()}"}}
    path.write_text(
        json.dumps({"type": "FeatureCollection", "crs": {"type": "name", **named}, "features": shapes}), "utf-8"
    )


def draw_fields(pages: Path, data: Path, folder: Path) -> None:
    """Picture of docs/labels.md: fields of NAIP from above at a tilt, their classes and instances."""
    layer = folder / "land.geojson"
    naip = data / "naip" / "20200831.tif"
    land_cover(naip, layer)
    table = {
        "background": 0,
        "ignore": 255,
        "classes": [
            {"id": k, "name": name, "color": colour}
            for k, (name, colour) in enumerate(
                (("water", "#0072b2"), ("bare soil", "#d55e00"), ("grass", "#f0e442"), ("crops", "#009e73")), 1
            )
        ],
    }
    layer.with_suffix(".classes.json").write_text(json.dumps(table), "utf-8")
    camera = {"camera": Camera(70.0, 4.0 / 3.0), "image_px": 560, "tilt_deg": 45.0, "yaw_deg": 0.0}
    found = shot(
        folder / "fields",
        47.0070,
        -99.1480,
        600.0,
        source=str(naip),
        labels=(f"{layer}:cover",),
        upsample=True,
        **camera,
    )
    sheet(
        pages / "labels-fields.jpg",
        [
            ("image, tilt 45°", found["satellite"]),
            ("classes", found["classes"]),
            (
                "instances over the image",
                over(found["satellite"], in_colours(found["instances"]), found["instances"] > 0),
            ),
        ],
        legend_of(folder / "fields"),
    )


def shaded(surface: Path, path: Path) -> None:
    """Draw a surface model in the light of shaded maps, as imagery of four times its resolution."""
    import rasterio
    from rasterio.transform import Affine

    with rasterio.open(surface) as file:
        heights_m, transform, crs = file.read(1).astype(float), file.transform, file.crs
    down, across = np.gradient(np.kron(heights_m, np.ones((4, 4))), transform.a)
    grey = np.clip(150.0 - 60.0 * (across + down), 0.0, 255.0)
    pixels = (grey * np.array([[[1.0]], [[0.97]], [[0.88]]])).astype(np.uint8)
    made = {"count": 3, "height": grey.shape[0], "width": grey.shape[1], "dtype": "uint8", "crs": crs}
    with rasterio.open(path, "w", driver="GTiff", transform=transform * Affine.scale(0.25), **made) as file:
        file.write(pixels)


def draw_buildings(pages: Path, data: Path, folder: Path) -> None:
    """Picture of docs/buildings.md: houses near Washington at a tilt, their walls and instances."""
    shade, place = folder / "shade.tif", data / "elevation"
    shaded(place / "dsm.tif", shade)
    found = shot(
        folder / "houses", 38.8092, -77.0531, 90.0, source=str(shade), elevation=(str(place / "dtm.tif"),),
        buildings=(str(place / "buildings.geojson"),), products=("facades", "instances"), upsample=True,
        camera=Camera(45.0, 4.0 / 3.0), image_px=560, tilt_deg=60.0,
    )  # fmt: skip
    marks = np.broadcast_to(np.array([230, 159, 0]), found["satellite"].shape)
    sheet(
        pages / "buildings-washington.jpg",
        [
            ("image, tilt 60°", found["satellite"]),
            ("façades over the image", over(found["satellite"], marks, found["facades"] > 0)),
            ("instances", in_colours(found["instances"])),
        ],
    )


def land_use(city: Path, path: Path) -> None:
    """Draw the surfaces of a CityJSON file as a map, which its buildings stand on."""
    import rasterio
    from rasterio import features
    from rasterio.transform import from_origin

    model = json.loads(city.read_text("utf-8"))
    vertices = np.array(model["vertices"]) * model["transform"]["scale"] + model["transform"]["translate"]
    colours = {
        "GenericCityObject": (176, 168, 156), "LandUse": (171, 166, 140), "PlantCover": (122, 142, 92),
        "Road": (128, 126, 124), "WaterBody": (86, 112, 130), "Bridge": (150, 144, 138), "Building": (164, 112, 88),
    }  # fmt: skip
    (west, south), (east, north) = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
    shape, step = (int((north - south) / 0.25), int((east - west) / 0.25)), from_origin(west, north, 0.25, 0.25)
    some = np.random.default_rng(4)
    pixels = np.full((3, *shape), 160.0)
    for kind, colour in colours.items():
        for thing in (one for one in model["CityObjects"].values() if one["type"] == kind):
            shell = thing["geometry"][0]["boundaries"]
            faces = shell[0] if thing["geometry"][0]["type"] == "Solid" else shell
            rings = [
                {"type": "Polygon", "coordinates": [vertices[[*face[0], face[0][0]], :2].tolist()]} for face in faces
            ]
            # Walls have no area seen from above, and draw a line.
            mask = features.rasterize(rings, out_shape=shape, transform=step)
            pixels[:, mask > 0] = np.array(colour)[:, np.newaxis] * some.uniform(0.93, 1.07)
    pixels += some.normal(0.0, 3.0, shape)
    made = {"count": 3, "height": shape[0], "width": shape[1], "dtype": "uint8", "crs": "EPSG:28992"}
    with rasterio.open(path, "w", driver="GTiff", transform=step, **made) as file:
        file.write(np.clip(pixels, 0, 255).astype(np.uint8))


def draw_city(pages: Path, data: Path, folder: Path) -> None:
    """Picture of docs/buildings.md: Delft from its CityJSON file, with depth and instances."""
    city, photo = data / "cityjson" / "delft.city.json", folder / "land.tif"
    land_use(city, photo)
    found = shot(
        folder / "delft", 52.0111, 4.3663, 80.0, source=str(photo), elevation=("43",), upsample=True,
        buildings=(f"{city}#heights=ground",), products=("depth", "instances"), camera=Camera(50.0, 4.0 / 3.0),
        image_px=560, tilt_deg=55.0, yaw_deg=10.0,
    )  # fmt: skip
    depth = found["depth"][..., 0] if found["depth"].ndim > 2 else found["depth"]
    near, far = np.nanmin(depth), np.nanmax(depth)
    grey = np.clip(255.0 - 215.0 * np.log(depth / near) / np.log(far / near), 0.0, 255.0).astype(np.uint8)
    sheet(
        pages / "buildings-delft.jpg",
        [
            ("image, tilt 55°", found["satellite"]),
            ("depth, near is bright", np.repeat(grey[..., np.newaxis], 3, axis=2)),
            ("instances", in_colours(found["instances"])),
        ],
    )


def main() -> None:
    """Measure, or make pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--images", type=int, default=350, help="about how many images a capture has")
    parser.add_argument("--pictures", type=Path, help="folder to make the pages' images in")
    parser.add_argument("--data", type=Path, default=Path("../shared/data"), help="folder of the pictures' data")
    asked = parser.parse_args()
    if not asked.pictures:
        times(asked.images)
        return
    with tempfile.TemporaryDirectory() as folder:
        draw_fields(asked.pictures, asked.data, Path(folder))
        draw_buildings(asked.pictures, asked.data, Path(folder))
        draw_city(asked.pictures, asked.data, Path(folder))


if __name__ == "__main__":
    main()
