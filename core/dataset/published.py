"""Positions and flights encoded in the names of the paper's published images and folders."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, Message
from ..geodesy.mercator import PixelGrid, lat_to_v, lon_to_u
from .folder import NAME
from .table import Table, first_faults


def check_names(table: Table, path: Path) -> None:
    """Raise InvalidInput if the image names of a published table disagree with its rows.

    Tables with poses, as captures write them, are not checked.
    """
    if np.isfinite(table.pose_lat_deg).any():
        return
    faults: list[str] = []
    # Names have at least seven decimals of a degree; half of the last is 5 mm on the ground.
    tolerance_deg = 6e-8
    for index, name in enumerate(table.img_names):
        found = NAME.fullmatch(Path(name).stem)
        if found is None:
            continue
        row = (
            ("columns", float(table.columns[index]), float(found[1]), 0.0),
            ("rows", float(table.rows[index]), float(found[2]), 0.0),
            ("Lat", float(table.lat_deg[index]), float(found[3]), tolerance_deg),
            ("Lon", float(table.lon_deg[index]), float(found[4]), tolerance_deg),
            ("Alt", float(table.zoom[index]), float(found[5]), 0.0),
        )
        wrong = [header for header, value, in_name, slack in row if abs(value - in_name) > slack]
        faults += [Message("{0} has another {1} in its row", name, wrong[0])] if wrong else []
    if faults:
        raise InvalidInput("table {0}: {1}", path, first_faults(faults))


def add_windows(table: Table, folder_name: str) -> Table:
    """Add poses and windows to a published table; tables with poses are returned unchanged.

    Images look straight down with north up, and show the ground about ``Lat``, ``Lon``. Pixels are those of 256 px
    tiles at zoom ``Alt`` or a higher one: the paper's repository has images made two zooms higher. The flight's height
    and field of view in the name of the image folder decide which.

    Parameters
    ----------
    table : Table
        Table with the sizes of the images.
    folder_name : str
        Name of the folder of images. Without a flight in the name, images are of zoom ``Alt``, as from Google's Static
        Maps; if the flight fits no whole number of zooms, windows are unknown.
    """
    if len(table) == 0 or np.isfinite(table.pose_lat_deg).any():
        return table
    # Names end in metres above ground, diagonal field of view in degrees, and an aspect ratio, rounded too much.
    number = r"\d+(?:\.\d+)?"
    flight = re.fullmatch(rf"raster_images_.*_(?P<agl>{number})_(?P<fov>{number})_[^_]+_[^_]+", folder_name, re.ASCII)
    agl_m = float(flight["agl"]) if flight else math.nan
    finer = _levels(table, agl_m, float(flight["fov"])) if flight else np.zeros(len(table))
    width, height = table.image_width_px / 2.0**finer, table.image_height_px / 2.0**finer
    world = 256.0 * 2.0**table.zoom
    straight = np.zeros(len(table))
    return replace(
        table,
        pose_lat_deg=table.lat_deg,
        pose_lon_deg=table.lon_deg,
        agl_m=np.full(len(table), agl_m),
        yaw_deg=straight,
        tilt_deg=straight,
        roll_deg=straight,
        left_px=np.mod(lon_to_u(table.lon_deg) * world - width / 2.0, world),
        top_px=lat_to_v(table.lat_deg) * world - height / 2.0,
        width_px=width,
        height_px=height,
    )


def _levels(table: Table, agl_m: float, fov_deg: float) -> Floats:
    """Number of zooms (n,) by which images are finer than the table's zoom, NaN if it is not whole."""
    if not (agl_m > 0.0 and 0.0 < fov_deg < 180.0):
        return np.full(len(table), np.nan)
    ground_m = 2.0 * agl_m * math.tan(math.radians(fov_deg) / 2.0)
    diagonal_px = np.hypot(table.image_width_px, table.image_height_px)
    grid = PixelGrid()
    coarse = np.array(
        [
            float(grid.ground_m_per_px(lat, lon, zoom))
            for lat, lon, zoom in zip(table.lat_deg, table.lon_deg, table.zoom.tolist())
        ]
    )
    exact = np.log2(coarse * diagonal_px / ground_m)
    whole = np.round(exact)
    # Cutting images to whole pixels in a UTM plane changes this by 0.01 at 100 px; other cameras differ by any amount.
    return np.where((np.abs(exact - whole) <= 0.1) & (whole >= 0.0), whole, np.nan)
