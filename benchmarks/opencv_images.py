r"""The images of an exported dataset, drawn anew by OpenCV: what is left in COLMAP's residuals is COLMAP's.

    terrainav capture --coords "35.1450_-89.8620_35.1435_-89.8600_100" --frame camera --tilt 10 --yaw 20 \
        --overlap 0.7 --format jpg --fov 80 --lens fisheye --k1 0.03 --k2=-0.01 --sampling area --data-dir out
    terrainav export out model --as colmap && terrainav export out tum --as tum && terrainav export out kitti --as kitti
    python benchmarks/opencv_images.py out/satellite model drawn
    peers/bin/python benchmarks/export_peers.py drawn model tum kitti

Needs opencv-python. Camera and poses are those of COLMAP's files; OpenCV inverts the lens and samples the embedded
world at zoom 22; the ellipsoid's ground and Web Mercator are written out here. A pixel is the mean of 8 x 8 samples in
linear light.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import cv2
import numpy as np
from PIL import Image
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.source import Window

ZOOM, TILE_PX, SAMPLES = 22, 256, 8
WORLD_PX = TILE_PX << ZOOM
#: WGS 84: axes in metres, and the first eccentricity squared.
A_M, B_M = 6378137.0, 6378137.0 * (1.0 - 1.0 / 298.257223563)
E2 = 1.0 - (B_M / A_M) ** 2


def lines(path):
    """Fields of the lines of a file of COLMAP."""
    return [line.split() for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]


def rotation(w, x, y, z):
    """Matrix of a unit quaternion."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def rays(camera):
    """Directions (height + 2, width + 2, 3) of pixels and of those around the image, in the camera's axes."""
    _, model, width, height, *values = camera
    fx, fy, cx, cy, *lens = map(float, values)
    x, y = np.meshgrid(np.arange(-1, int(width) + 1) + 0.5, np.arange(-1, int(height) + 1) + 0.5)
    pixels, matrix = np.stack([x, y], axis=-1).reshape(-1, 1, 2), np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    until = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-12)
    if "FISHEYE" in model:
        seen = cv2.fisheye.undistortPoints(pixels, matrix, np.array(lens), criteria=until)
    else:
        seen = cv2.undistortPointsIter(pixels, matrix, np.array(lens or [0.0] * 4), None, None, until)
    return np.concatenate([seen[:, 0], np.ones((len(seen), 1))], axis=1).reshape(*x.shape, 3)


def on_map(seen, pose, origin):
    """Pixels x and y of the map that rays of a pose see."""
    turn, shift = rotation(*pose[:4]), pose[4:]
    lat, lon = np.radians((origin["lat_deg"], origin["lon_deg"]))
    (sin_lat, sin_lon), (cos_lat, cos_lon) = np.sin((lat, lon)), np.cos((lat, lon))
    east_north_up = np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    )
    normal = A_M / np.sqrt(1.0 - E2 * sin_lat**2)
    place = normal * np.array([cos_lat * cos_lon, cos_lat * sin_lon, (1.0 - E2) * sin_lat])
    start, ahead = place - turn.T @ shift @ east_north_up, seen @ turn @ east_north_up
    # The nearer end of the ray through the ellipsoid, which is a ball of 1 in these units.
    p, d = start / (A_M, A_M, B_M), ahead / (A_M, A_M, B_M)
    square, slope = (d * d).sum(axis=-1), d @ p
    way = (-slope - np.sqrt(slope**2 - square * (p @ p - 1.0))) / square
    x, y, z = np.moveaxis(start + way[..., np.newaxis] * ahead, -1, 0)
    lat, lon = np.arctan2(z, (1.0 - E2) * np.hypot(x, y)), np.arctan2(y, x)
    return np.stack([0.5 + lon / (2.0 * np.pi), 0.5 - np.arcsinh(np.tan(lat)) / (2.0 * np.pi)]) * WORLD_PX


def light(values):
    """Linear light of sRGB values of 0 to 1."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def ground(source, left, top, right, bottom):
    """Linear light of part of the map."""
    found = np.zeros((bottom - top, right - left, 3), np.float32)
    table = light(np.arange(256) / 255.0).astype(np.float32)
    for part in source.parts(Window(ZOOM, left, top, right - left, bottom - top)):
        tile = source.fetch("satellite", part.window)
        x, y = max(-part.dx_px, 0), max(-part.dy_px, 0)
        place = found[part.dy_px + y : part.dy_px + TILE_PX, part.dx_px + x : part.dx_px + TILE_PX]
        place[...] = table[tile[y : y + place.shape[0], x : x + place.shape[1], :3]]
    return found


def drawn(source, position):
    """Values of an image whose pixels, and those around it, see positions (2, height + 2, width + 2) of the map."""
    left, top = (np.floor(position.min(axis=(1, 2))).astype(int) - 4).tolist()
    right, bottom = (np.ceil(position.max(axis=(1, 2))).astype(int) + 4).tolist()
    seen = ground(source, left, top, right, bottom)
    # OpenCV counts from the middle of the first pixel.
    position = position - np.array([left + 0.5, top + 0.5])[:, np.newaxis, np.newaxis]
    middle = position[:, 1:-1, 1:-1]
    before_x, after_x = position[:, 1:-1, :-2], position[:, 1:-1, 2:]
    before_y, after_y = position[:, :-2, 1:-1], position[:, 2:, 1:-1]
    total, offsets = 0.0, (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
    for y in offsets:
        for x in offsets:
            at = middle + x * (after_x - before_x) / 2.0 + y * (after_y - before_y) / 2.0
            at = (
                at
                + x * x / 2.0 * (before_x - 2.0 * middle + after_x)
                + y * y / 2.0 * (before_y - 2.0 * middle + after_y)
            )
            total = total + cv2.remap(seen, *at.astype(np.float32), cv2.INTER_LINEAR)
    mean = total / SAMPLES**2
    values = np.where(mean <= 0.0031308, 12.92 * mean, 1.055 * np.maximum(mean, 0.0031308) ** (1.0 / 2.4) - 0.055)
    return np.rint(values * 255.0).astype(np.uint8)


def main():
    """Draw them, and print how far they are from the dataset's."""
    images, model, folder = map(Path, sys.argv[1:4])
    (camera,) = lines(model / "sparse" / "0" / "cameras.txt")
    origin = json.loads((model / "origin.json").read_text())
    source, seen, off = open_source("world"), rays(camera), []
    folder.mkdir(parents=True)
    for _, *pose, _, name in lines(model / "sparse" / "0" / "images.txt"):
        picture = drawn(source, on_map(seen, np.array(pose, float), origin))
        Image.fromarray(picture).save(folder / name, quality=95, subsampling=0)
        off.append(np.mean((np.asarray(Image.open(images / name), float) - picture) ** 2))
    print(f"{len(off)} images, {np.mean(off) ** 0.5:.2f} grey levels (root mean square) from those of {images}")


if __name__ == "__main__":
    main()
