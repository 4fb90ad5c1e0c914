"""Raster files over rasterio, where QGIS is not."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from .files import STRICT_JPEG, Band, Box, Bytes, Facts, ReadError
from .trust import DRIVERS, NAMES_OVERVIEWS, OVERVIEW_DOMAIN, OVERVIEW_FILE

#: What GDAL gives as the geotransform of a raster that has none.
_NO_GEOTRANSFORM = (0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@contextmanager
def _refused() -> Iterator[None]:
    """Errors of rasterio as ReadError; a JPEG that is broken off is one."""
    import rasterio
    from rasterio.errors import RasterioError

    try:
        with rasterio.Env(**{STRICT_JPEG: True}):
            yield
    except (RasterioError, OSError) as wrong:
        # What GDAL said first is the cause of what rasterio says.
        root: BaseException = wrong
        while root.__cause__ is not None:
            root = root.__cause__
        raise ReadError(root) from wrong


class RasterioFile:
    """A raster, or an overview, that is open in rasterio."""

    # Python's filters of warnings belong to the process: two threads must not put them back in the wrong order.
    _opening = threading.Lock()

    def __init__(self, path: str, level: int, drivers: Sequence[str] = DRIVERS) -> None:
        import rasterio
        from rasterio.errors import NotGeoreferencedWarning

        options = {"overview_level": level - 1} if level else {}
        with _refused(), self._opening, warnings.catch_warnings():
            # Said in words of our own.
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            # As rasterio.open does, which takes one driver only.
            self._dataset: Any = rasterio.DatasetReader(path, driver=list(drivers), **options)
        self._path, self._drivers = path, drivers

    def facts(self) -> Facts:
        """Read what the file says of itself."""
        with _refused():
            dataset = self._dataset
            if any(name.upper() == OVERVIEW_FILE for name in dataset.tags(ns=OVERVIEW_DOMAIN)):
                raise ReadError(NAMES_OVERVIEWS)
            geotransform = tuple(dataset.transform.to_gdal())
            return Facts(
                bands=tuple(self._band(index) for index in dataset.indexes),
                sizes=((dataset.width, dataset.height), *self._overview_sizes()),
                crs_wkt=dataset.crs.to_wkt(version="WKT2_2019") if dataset.crs else "",
                geotransform=None if geotransform == _NO_GEOTRANSFORM else geotransform,
                tags=dict(dataset.tags()),
                by_points=bool(dataset.gcps[0]),
                parts=tuple(dataset.subdatasets),
            )

    def _overview_sizes(self) -> Iterator[tuple[int, int]]:
        for level in range(len(self._dataset.overviews(1)) if self._dataset.count else 0):
            overview = RasterioFile(self._path, 1 + level, self._drivers)
            yield overview._dataset.width, overview._dataset.height
            overview.close()

    def _band(self, index: int) -> Band:
        from rasterio.enums import MaskFlags

        dataset = self._dataset
        colour = dataset.colorinterp[index - 1].name
        bits = dataset.tags(index, ns="IMAGE_STRUCTURE").get("NBITS")
        known = {MaskFlags.all_valid, MaskFlags.alpha, MaskFlags.nodata}
        palette = dataset.colormap(index) if colour == "palette" else {}
        return Band(
            data_type=dataset.dtypes[index - 1],
            colour=colour,
            nodata=dataset.nodatavals[index - 1],
            bits=int(bits) if bits else None,
            palette=tuple(palette[i] for i in sorted(palette)),
            masked=not known & set(dataset.mask_flag_enums[index - 1]),
        )

    def read(self, bands: Sequence[int], box: Box) -> Bytes:
        """Values as they are stored."""
        with _refused():
            return np.asarray(self._dataset.read(list(bands), window=_window(box)), np.uint8)

    def read_mask(self, band: int, box: Box) -> Bytes:
        """Mask of a band."""
        with _refused():
            return np.asarray(self._dataset.read_masks(band, window=_window(box)), np.uint8)

    def close(self) -> None:
        """Free it."""
        self._dataset.close()


def _window(box: Box) -> Any:
    from rasterio.windows import Window

    return Window(*box)
