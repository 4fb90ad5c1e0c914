"""Bytes of a file of GDAL's virtual file systems, as GDAL itself reads them: in archives, and on other machines."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

#: Bytes of a row of the raster that represents the file: as many as GDAL requests at once.
ROW_BYTES = 1 << 14
#: Rows of that raster, for a file of any size: GDAL returns zeros after its end.
_ROWS = (1 << 31) - 1
#: GDAL's option to allow VRTs of raw bytes in other places, which newer versions refuse.
OPTIONS = {"GDAL_VRT_RAWRASTERBAND_ALLOWED_SOURCE": "ALL"}


def raw_bytes_vrt(path: str) -> str:
    """Text of a VRT of one band with the bytes of a file, row by row."""
    return (
        f'<VRTDataset rasterXSize="{ROW_BYTES}" rasterYSize="{_ROWS}"><VRTRasterBand dataType="Byte" band="1" '
        f'subClass="VRTRawRasterBand"><SourceFilename relativeToVRT="0">{escape(path, quote=False)}</SourceFilename>'
        f"<ImageOffset>0</ImageOffset><PixelOffset>1</PixelOffset><LineOffset>{ROW_BYTES}</LineOffset>"
        "</VRTRasterBand></VRTDataset>"
    )


class VirtualFile:
    """A file of unknown size, followed by zeros up to the end of a row.

    Parameters
    ----------
    read_row : callable
        Bytes of a row, `ROW_BYTES`.
    """

    def __init__(self, read_row: Callable[[int], bytes]) -> None:
        self._read_row = read_row
        self._at = 0

    def seek(self, offset: int) -> None:
        """Go to an offset from the beginning."""
        self._at = offset

    def tell(self) -> int:
        """Offset of the next byte."""
        return self._at

    def read(self, size: int) -> bytes:
        """Read a number of bytes.

        Raises
        ------
        EOFError
            There are only zeros: the file has ended, or its server has not sent them; GDAL does not distinguish these.
        """
        first, last = self._at // ROW_BYTES, (self._at + size - 1) // ROW_BYTES
        rows = []
        for number in range(first, last + 1):
            row = self._read_row(number) if number < _ROWS else b""
            if not row.strip(b"\0"):
                raise EOFError(self._at)
            rows.append(row)
        start = self._at - first * ROW_BYTES
        self._at += size
        return b"".join(rows)[start : start + size]
