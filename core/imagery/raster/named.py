"""A raster file as a mission names it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..named import FileSource

if TYPE_CHECKING:
    from .source import RasterSource


class RasterFile(FileSource):
    """A raster file, or a path of such files with {date} in it."""

    def open(self) -> RasterSource:
        """Open the file, of the date that is asked for; raises InvalidInput as `open_raster` does."""
        from .source import open_raster

        return open_raster(self.text, date=self.options.date or "")
