"""Raster files in any coordinate reference system as sources of imagery."""

from __future__ import annotations

from .source import RasterSource, open_raster

__all__ = ["RasterSource", "open_raster"]
