"""Raster files over GDAL's own Python bindings, which QGIS brings along."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from .files import STRICT_JPEG, Band, Box, Bytes, Facts, ReadError
from .trust import DRIVERS, NAMES_OVERVIEWS, OVERVIEW_DOMAIN, OVERVIEW_FILE


@contextmanager
def _heard() -> Iterator[list[str]]:
    """Errors of GDAL in this thread: collected instead of printed, and raised where the bindings are told to.

    Whether the bindings raise is a choice of the whole process (of QGIS, of another plugin), so both ways are met.
    A JPEG that is broken off is an error here, where GDAL may only warn and fill it with grey.
    """
    from osgeo import gdal

    # Bindings of older versions cannot set options of a thread, and those of the process are not ours.
    can_be_strict = hasattr(gdal, "SetThreadLocalConfigOption")
    before = gdal.GetThreadLocalConfigOption(STRICT_JPEG) if can_be_strict else None
    said: list[str] = []

    def hear(severity: int, _number: int, words: str) -> None:
        if severity >= gdal.CE_Failure:
            said.append(words)

    gdal.PushErrorHandler(hear)
    if can_be_strict:
        gdal.SetThreadLocalConfigOption(STRICT_JPEG, "YES")
    try:
        yield said
    except RuntimeError as wrong:
        raise ReadError(said[0] if said else wrong) from wrong
    finally:
        if can_be_strict:
            gdal.SetThreadLocalConfigOption(STRICT_JPEG, before)
        gdal.PopErrorHandler()


class GdalFile:
    """A raster, or an overview, that is open in GDAL."""

    def __init__(self, path: str, level: int, drivers: Sequence[str] = DRIVERS) -> None:
        from osgeo import gdal

        self._gdal: Any = gdal
        options = [f"OVERVIEW_LEVEL={level - 1}"] if level else []
        with _heard() as said:
            self._dataset = gdal.OpenEx(
                path, gdal.OF_RASTER, allowed_drivers=list(drivers), open_options=options
            )
        if self._dataset is None:
            raise ReadError(said[0] if said else "no format that GDAL knows")

    def facts(self) -> Facts:
        """Read what the file says of itself."""
        with _heard():
            dataset = self._dataset
            if dataset.GetMetadataItem(OVERVIEW_FILE, OVERVIEW_DOMAIN):
                raise ReadError(NAMES_OVERVIEWS)
            reference = dataset.GetSpatialRef()
            bands = [dataset.GetRasterBand(1 + i) for i in range(dataset.RasterCount)]
            overviews = [bands[0].GetOverview(i) for i in range(bands[0].GetOverviewCount())] if bands else []
            return Facts(
                bands=tuple(self._band(band) for band in bands),
                sizes=(
                    (dataset.RasterXSize, dataset.RasterYSize),
                    *((overview.XSize, overview.YSize) for overview in overviews),
                ),
                crs_wkt=reference.ExportToWkt(["FORMAT=WKT2_2019"]) if reference else "",
                geotransform=dataset.GetGeoTransform(can_return_null=True),
                tags=dict(dataset.GetMetadata()),
                by_points=dataset.GetGCPCount() > 0,
                parts=tuple(name for name, _ in dataset.GetSubDatasets()),
            )

    def _band(self, band: Any) -> Band:
        gdal = self._gdal
        table = band.GetColorTable()
        bits = band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE")
        known = gdal.GMF_ALL_VALID | gdal.GMF_ALPHA | gdal.GMF_NODATA
        data_type = gdal.GetDataTypeName(band.DataType)
        return Band(
            data_type="uint8" if band.DataType == gdal.GDT_Byte else data_type.lower(),
            colour=gdal.GetColorInterpretationName(band.GetColorInterpretation()).lower(),
            nodata=band.GetNoDataValue(),
            bits=int(bits) if bits else None,
            palette=tuple(table.GetColorEntry(i) for i in range(table.GetCount())) if table else (),
            masked=not band.GetMaskFlags() & known,
        )

    def read(self, bands: Sequence[int], box: Box) -> Bytes:
        """Values as they are stored."""
        with _heard() as said:
            values = self._dataset.ReadRaster(*box, buf_type=self._gdal.GDT_Byte, band_list=list(bands))
        return _array(values, said, (len(bands), box.height, box.width))

    def read_mask(self, band: int, box: Box) -> Bytes:
        """Mask of a band."""
        with _heard() as said:
            mask = self._dataset.GetRasterBand(band).GetMaskBand()
            values = mask.ReadRaster(*box, buf_type=self._gdal.GDT_Byte)
        return _array(values, said, (box.height, box.width))

    def close(self) -> None:
        """Free it."""
        self._dataset = None


def _array(values: bytes | None, said: list[str], shape: tuple[int, ...]) -> Bytes:
    if said or values is None:
        raise ReadError(said[0] if said else "no values")
    return np.frombuffer(values, np.uint8).reshape(shape)
