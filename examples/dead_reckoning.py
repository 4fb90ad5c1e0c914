"""Locate the frames of a sequence from its first pose and its inertial unit alone, with numpy and nothing else.

terrainav fly --coords "46.2120_-122.2000_46.2070_-122.1930_150" --data-dir flight
python examples/dead_reckoning.py flight predictions.csv
terrainav benchmark score flight predictions.csv
"""

from __future__ import annotations

import csv
import sys
from datetime import datetime
from pathlib import Path

import numpy as np

#: WGS 84: gravitational constant, equatorial radius, eccentricity squared, dynamic form factor and rate of turn.
GM, A, E2, J2, OMEGA = 3.986004418e14, 6_378_137.0, 6.69437999014e-3, 1.082629821e-3, 7.292115e-5
EARTH = np.array([0.0, 0.0, OMEGA])


def read(path: Path) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names of the columns, times in nanoseconds, and values of a table."""
    with path.open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    return head[1:], np.array([int(row[0]) for row in rows]), np.array([row[1:] for row in rows], np.float64)


def local_axes(lat: float, lon: float) -> np.ndarray:
    """East, north and up in geocentric axes, as columns; angles in radians."""
    (sy, cy), (sx, cx) = ((np.sin(one), np.cos(one)) for one in (lat, lon))
    return np.array([[-sx, -sy * cx, cy * cx], [cx, -sy * sx, cy * sx], [0.0, cy, sy]])


def place(lat: float, lon: float, height: float) -> np.ndarray:
    """Geocentric coordinates."""
    normal = A / np.sqrt(1.0 - E2 * np.sin(lat) ** 2)
    up = local_axes(lat, lon)[:, 2]
    return np.array([normal + height, normal + height, normal * (1.0 - E2) + height]) * up


def geodetic(point: np.ndarray) -> tuple[float, float, float]:
    """Latitude and longitude in radians, and height above the ellipsoid."""
    across = np.hypot(*point[:2])
    lat = np.arctan2(point[2], across * (1.0 - E2))
    for _ in range(5):
        normal = A / np.sqrt(1.0 - E2 * np.sin(lat) ** 2)
        lat = np.arctan2(point[2] + E2 * normal * np.sin(lat), across)
    return lat, np.arctan2(point[1], point[0]), across * np.cos(lat) + point[2] * np.sin(lat) - A * A / normal


def gravity(point: np.ndarray) -> np.ndarray:
    """Gravity with the centrifugal acceleration, to the Earth's flattening."""
    r = np.linalg.norm(point)
    polar = 5.0 * (point[2] / r) ** 2
    shape = 1.0 + 1.5 * J2 * (A / r) ** 2 * (np.array([1.0, 1.0, 3.0]) - polar)
    return -GM / r**3 * point * shape - np.cross(EARTH, np.cross(EARTH, point))


def rotation(vector: np.ndarray) -> np.ndarray:
    """Rotation about a vector by its length (Rodrigues)."""
    angle = np.linalg.norm(vector)
    x, y, z = vector
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sinc(angle / np.pi) * k + 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2 * k @ k


def main(folder: Path, target: Path) -> None:
    """Integrate the inertial unit, and write where it was at each frame."""
    names, _, truth = read(folder / "trajectory.csv")
    start = dict(zip(names, truth[0].tolist()))
    _, stamps, imu = read(folder / "imu.csv")
    lat, lon = np.radians(start["lat_deg"]), np.radians(start["lon_deg"])
    w, x, y, z = (start[f"q_{name}"] for name in "wxyz")
    turn = local_axes(lat, lon) @ np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
    speed = local_axes(lat, lon) @ np.array([start[f"{name}_m_per_s"] for name in ("east", "north", "up")])
    point = place(lat, lon, start["height_m"])
    points = [point]
    for step, one, two in zip(np.diff(stamps) * 1e-9, imu[:-1], imu[1:]):
        rate, force = (one[:3] + two[:3]) / 2.0, (one[3:] + two[3:]) / 2.0
        middle = turn @ rotation(rate * step / 2.0)
        change = middle @ force + gravity(point) - 2.0 * np.cross(EARTH, speed)
        turn = rotation(-EARTH * step) @ turn @ rotation(rate * step)
        point = point + speed * step + 0.5 * change * step * step
        speed = speed + change * step
        points.append(point)
    table = next(folder.glob("*/meta_data.csv"), None) or next(folder.glob("*/*/meta_data.csv"))
    with table.open(encoding="utf-8") as file:
        frames = [(row["img_names"], row["time_utc"]) for row in csv.DictReader(file)]
    at = [datetime.fromisoformat(time.replace("Z", "+00:00")).timestamp() for _, time in frames]
    found = np.stack([np.interp(at, stamps * 1e-9, column) for column in np.array(points).T], axis=1)
    lines = ["query,lat_deg,lon_deg,height_m"]
    for (name, _), one in zip(frames, found):
        lat, lon, height = geodetic(one)
        lines.append(f"{name},{np.degrees(lat):.9f},{np.degrees(lon):.9f},{height:.3f}")
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
