"""Checks of foreign files before QGIS opens them: GDAL detects formats by content and follows references."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from osgeo import gdal
from qgis.core import QgsProviderRegistry

from ..core.dataset.vectors import check_geojson
from ..core.errors import InvalidInput
from ..core.imagery.raster.trust import allowed_drivers
from .i18n import tr, translate


def check_vector(path: Path) -> None:
    """Refuse a file unless QGIS would read it as GeoJSON without references to other files; on any thread.

    Raises
    ------
    InvalidInput
    """
    check_geojson(path)
    check_driver(path)


def check_raster(path: Path) -> None:
    """Refuse a file unless QGIS would read it as a local image; on any thread.

    Raises
    ------
    InvalidInput
    """
    try:
        allowed = allowed_drivers(str(path))
    except InvalidInput as wrong:
        reason = translate(wrong)
        raise InvalidInput(tr("image {path}: {reason}").format(path=path, reason=reason)) from wrong
    _check_path("gdal", path)
    _check_kind(path, gdal.OF_RASTER, allowed)


def check_driver(path: Path) -> None:
    """Refuse a checked GeoJSON file if QGIS would open it with another driver, or read its path as another path."""
    _check_path("ogr", path)
    _check_kind(path, gdal.OF_VECTOR, ["GeoJSON"])


def _check_path(provider: str, path: Path) -> None:
    read = QgsProviderRegistry.instance().decodeUri(provider, str(path)).get("path", "")
    if Path(read) != path:
        raise InvalidInput(
            tr("{path}: QGIS would open {other} in its place; rename the folder").format(path=path, other=read)
        )


def _check_kind(path: Path, kind: int, allowed: Sequence[str]) -> None:
    driver = gdal.IdentifyDriverEx(str(path), kind)
    if driver is None or driver.ShortName not in allowed:
        raise InvalidInput(
            tr("{path}: QGIS would open it as {kind}; must be {right}").format(
                path=path,
                kind=tr("an unknown format") if driver is None else driver.ShortName,
                right=" or ".join(allowed[:3]),
            )
        )
