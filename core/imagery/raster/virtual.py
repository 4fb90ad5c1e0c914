"""Reading of bytes through GDAL, from files in its virtual file systems: in archives, and on other machines."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

#: Bytes of a row of the raster that represents the file, equal to the bytes that GDAL requests at once.
ROW_BYTES = 1 << 14
#: Rows of this raster, enough for any file; GDAL returns zeros after the end of the file.
_ROWS = (1 << 31) - 1
#: GDAL's option to allow VRTs of raw bytes of any file, which newer versions refuse by default.
OPTIONS = {"GDAL_VRT_RAWRASTERBAND_ALLOWED_SOURCE": "ALL"}


def raw_bytes_vrt(path: str) -> str:
    """Text of a VRT whose single band has the bytes of a file, row by row."""
    return (
        f'<VRTDataset rasterXSize="{ROW_BYTES}" rasterYSize="{_ROWS}"><VRTRasterBand dataType="Byte" band="1" '
        f'subClass="VRTRawRasterBand"><SourceFilename relativeToVRT="0">{escape(path, quote=False)}</SourceFilename>'
        f"<ImageOffset>0</ImageOffset><PixelOffset>1</PixelOffset><LineOffset>{ROW_BYTES}</LineOffset>"
        "</VRTRasterBand></VRTDataset>"
    )


class VirtualFile:
    """A file of unknown size; zeros follow its end up to the end of a row.

    Parameters
    ----------
    read_row : callable
        Returns the `ROW_BYTES` bytes of a row, given by its number.
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
            A row has only zeros: the file has ended, or the server did not send bytes, which GDAL does not
            distinguish.
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
