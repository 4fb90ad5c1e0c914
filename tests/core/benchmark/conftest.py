"""Small benchmarks over rasters of two dates in UTM."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.benchmark.making import make_benchmark
from terrainav.core.benchmark.planning import BenchmarkSettings, plan_benchmark
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.imageries import NamedImagery
from terrainav.core.mission.mission import Mission

from tests.support import rasters

EPSG = 32616
WEST, NORTH, WIDTH, HEIGHT = 230_000.0, 3_890_000.0, 700, 600
#: Pixels of 1 m.
PLACED = (WEST, 1.0, 0.0, NORTH, 0.0, -1.0)
_TO_DEGREES = Transformer.from_crs(EPSG, 4326, always_xy=True)


def texture(seed: int) -> np.ndarray:
    """Grey noise (1, h, w) of details of some pixels."""
    rng = np.random.default_rng(seed)
    rough = rng.random((HEIGHT // 4 + 2, WIDTH // 4 + 2))
    fine = np.kron(rough, np.ones((4, 4)))
    for _ in range(3):
        fine = (fine + np.roll(fine, 1, 0) + np.roll(fine, 1, 1) + np.roll(fine, -1, 0) + np.roll(fine, -1, 1)) / 5.0
    fine = fine[:HEIGHT, :WIDTH]
    return np.uint8(255.0 * (fine - fine.min()) / np.ptp(fine))[np.newaxis]


def places(count: int, seed: int = 3, rim_m: float = 130.0) -> list[tuple[float, float]]:
    """Latitudes and longitudes inside the rasters."""
    rng = np.random.default_rng(seed)
    x = WEST + rim_m + rng.random(count) * (WIDTH - 2.0 * rim_m)
    y = NORTH - rim_m - rng.random(count) * (HEIGHT - 2.0 * rim_m)
    lon, lat = _TO_DEGREES.transform(x, y)
    return list(zip(lat.tolist(), lon.tolist()))


def mission(count: int = 12, **values: Any) -> Mission:
    """Views of 75 m of ground, turned this way and that."""
    yaws = tuple(float(yaw) for yaw in np.random.default_rng(4).uniform(0.0, 360.0, count))
    poses = tuple((lat, lon, 60.0) for lat, lon in places(count))
    asked = {"image_px": 80, "image_format": "png", "accept_error": True, **values}
    return Mission(Points(poses, yaws), 60.0, **asked)


def made(folder: Path, settings: BenchmarkSettings, **options: Any) -> Any:
    """Make a benchmark; what `make_benchmark` returns."""
    sources = {str(one): open_source(one.source) for one in (settings.reference, *settings.imageries)}
    worked_out = plan_benchmark(settings, {name: source.grid for name, source in sources.items()})
    return make_benchmark(worked_out, sources, folder, **options)


@pytest.fixture(scope="session")
def dates(tmp_path_factory: pytest.TempPathFactory) -> dict[str, NamedImagery]:
    """Imagery of one ground on two dates: a third of what is seen on the second one has changed."""
    folder = tmp_path_factory.mktemp("dates")
    first, other = texture(1), texture(2)
    second = np.uint8(0.66 * first + 0.34 * other)
    return {
        name: NamedImagery(name, str(rasters.write(folder / f"{name}.tif", values, PLACED, EPSG)))
        for name, values in (("old", first), ("new", second))
    }


@pytest.fixture(scope="session")
def settings(dates: dict[str, NamedImagery]) -> BenchmarkSettings:
    """Queries of both dates, and the first one as the reference."""
    return BenchmarkSettings(
        mission(), tuple(dates.values()), dates["old"], split="same-area", shares=(0.5, 0.25, 0.25)
    )


@pytest.fixture(scope="session")
def benchmark(tmp_path_factory: pytest.TempPathFactory, settings: BenchmarkSettings) -> Any:
    """The benchmark of these settings; for reading only."""
    return made(tmp_path_factory.mktemp("benchmark") / "made", settings).benchmark
