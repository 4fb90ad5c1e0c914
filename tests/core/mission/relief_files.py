"""Relief as files near Washington, in UTM: heights by metres from the upper left corner."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pyproj
from osgeo import gdal

from tests.support import rasters

WEST, NORTH, EPSG = 320_000.0, 4_298_000.0, 32618
TO_DEGREES = pyproj.Transformer.from_crs(EPSG, 4326, always_xy=True)


def write_relief(
    folder: Path, makes: Iterable[Callable[[np.ndarray, np.ndarray], np.ndarray]], side: int, cell_m: float
) -> dict[str, str]:
    """Write each function's heights as a square file; returns the paths by the functions' names."""
    at = (np.arange(side) + 0.5) * cell_m
    x, y = np.meshgrid(at, at)
    transform = (WEST, cell_m, 0.0, NORTH, 0.0, -cell_m)
    return {
        make.__name__: str(
            rasters.write(
                folder / f"{make.__name__}.tif", make(x, y)[np.newaxis], transform, EPSG, data_type=gdal.GDT_Float32
            )
        )
        for make in makes
    }


def placed(x, y):
    """Latitude and longitude of metres from the corner of the relief, southward for the second."""
    lon, lat = TO_DEGREES.transform(WEST + x, NORTH - y)
    return lat, lon
