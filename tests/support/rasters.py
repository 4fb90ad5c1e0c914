"""Raster files made for tests, by GDAL."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from osgeo import gdal, osr

#: Period, px, of the triangle wave that gives the colours of `position_colours`.
RAMP_PERIOD = 125.0


def write(
    path: Path,
    values: np.ndarray,
    geotransform: tuple[float, ...] | None,
    epsg: int | str | None,
    *,
    colours: tuple[int, ...] = (),
    nodata: float | None = None,
    options: tuple[str, ...] = (),
    tags: dict[str, str] | None = None,
    data_type: int = gdal.GDT_Byte,
) -> Path:
    """Write bands (n, h, w) as a GeoTIFF."""
    values = np.asarray(values)
    bands, height, width = values.shape
    dataset = gdal.GetDriverByName("GTiff").Create(str(path), width, height, bands, data_type, options=list(options))
    if geotransform is not None:
        dataset.SetGeoTransform(geotransform)
    if epsg is not None:
        system = osr.SpatialReference()
        system.SetFromUserInput(f"EPSG:{epsg}" if isinstance(epsg, int) else epsg)
        dataset.SetProjection(system.ExportToWkt())
    for index, band in enumerate(values, 1):
        if colours:
            dataset.GetRasterBand(index).SetColorInterpretation(colours[index - 1])
        if nodata is not None:
            dataset.GetRasterBand(index).SetNoDataValue(nodata)
        dataset.GetRasterBand(index).WriteArray(band)
    dataset.SetMetadata(tags or {})
    dataset.FlushCache()
    return path


def centres(geotransform: tuple[float, ...], width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates x, y (height, width) of a raster's pixels' centres."""
    x0, xc, xr, y0, yc, yr = geotransform
    column, row = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return x0 + xc * column + xr * row, y0 + yc * column + yr * row


def triangle(position: np.ndarray) -> np.ndarray:
    """A wave between 2 and 252 that rises or falls by 4 per px; its turns are `RAMP_PERIOD` / 2 px apart."""
    phase = np.mod(position / RAMP_PERIOD, 1.0)
    return 2.0 + 500.0 * np.minimum(phase, 1.0 - phase)


def turns(position: np.ndarray, within_px: float) -> np.ndarray:
    """Whether the wave turns within ``within_px``, so that means over pixels are not linear."""
    phase = np.mod(position / (RAMP_PERIOD / 2.0), 1.0)
    return np.minimum(phase, 1.0 - phase) * (RAMP_PERIOD / 2.0) < within_px


def position_colours(x_px: np.ndarray, y_px: np.ndarray) -> np.ndarray:
    """Bands (3, h, w) that encode positions in px of the ground's system: red eastward, green northward."""
    bands = np.stack([triangle(x_px), triangle(y_px), triangle(x_px + y_px)])
    return np.rint(bands).astype(np.uint8)
