"""Bytes of a file of GDAL's virtual file systems, as GDAL itself reads them: in archives, and on other machines."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

#: Bytes of a row of the raster that stands for the file: as many as GDAL asks a server for at once.
ROW_BYTES = 1 << 14
#: Rows of it, whatever the file's size is: GDAL gives zeros behind the end.
_ROWS = (1 << 31) - 1
#: GDAL's option for VRTs of raw bytes that do not lie beside them, which newer versions refuse.
OPTIONS = {"GDAL_VRT_RAWRASTERBAND_ALLOWED_SOURCE": "ALL"}


def vrt_of_bytes(path: str) -> str:
    """Text of a VRT of one band whose values are a file's bytes, row by row."""
    return (
        f'<VRTDataset rasterXSize="{ROW_BYTES}" rasterYSize="{_ROWS}"><VRTRasterBand dataType="Byte" band="1" '
        f'subClass="VRTRawRasterBand"><SourceFilename relativeToVRT="0">{escape(path, quote=False)}</SourceFilename>'
        f"<ImageOffset>0</ImageOffset><PixelOffset>1</PixelOffset><LineOffset>{ROW_BYTES}</LineOffset>"
        "</VRTRasterBand></VRTDataset>"
    )


class VirtualFile:
    """A file whose size is not known; behind its end are zeros, up to the end of a row.

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
        """Read that many bytes.

        Raises
        ------
        EOFError
            There are only zeros: the file ends here, or its server has not sent them, which GDAL does not tell apart.
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
