"""Places and ground encoded in the names of the paper's published images and folders."""

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

#: Degrees by which a position in a name may differ from the table's: names have seven decimals or more, and half of
#: the last is 5 mm on the ground.
_NAME_DEG = 6e-8
#: End of the name of a published folder of images: metres above ground, diagonal field of view in degrees, and an
#: aspect ratio that is rounded to nothing of use.
_FLIGHT = re.compile(r"raster_images_.*_(?P<agl>\d+(?:\.\d+)?)_(?P<fov>\d+(?:\.\d+)?)_[^_]+_[^_]+", re.ASCII)


def check_names(table: Table, path: Path) -> None:
    """Raise InvalidInput where the names of a published table's images say otherwise than its rows.

    Tables of captures have poses, and names of these; they are left alone.
    """
    if np.isfinite(table.pose_lat_deg).any():
        return
    faults: list[str] = []
    for index, name in enumerate(table.img_names):
        said = NAME.fullmatch(Path(name).stem)
        if said is None:
            continue
        row = (
            ("columns", float(table.columns[index]), float(said[1]), 0.0),
            ("rows", float(table.rows[index]), float(said[2]), 0.0),
            ("Lat", float(table.lat_deg[index]), float(said[3]), _NAME_DEG),
            ("Lon", float(table.lon_deg[index]), float(said[4]), _NAME_DEG),
            ("Alt", float(table.zoom[index]), float(said[5]), 0.0),
        )
        wrong = [header for header, value, in_name, slack in row if abs(value - in_name) > slack]
        faults += [Message("{0} has another {1} in its row", name, wrong[0])] if wrong else []
    if faults:
        raise InvalidInput("table {0}: {1}", path, first_faults(faults))


def framed(table: Table, folder_name: str) -> Table:
    """Published table with poses and windows; one that has poses already is left alone.

    Images look straight down with the north up, and show the ground about ``Lat``, ``Lon``. Pixels are those of 256 px
    tiles at the zoom ``Alt``, or at a higher one: the paper's repository has images made with two zooms more. The
    flight's height and field of view in the name of the image folder decide which.

    Parameters
    ----------
    table : Table
        With the sizes of the images.
    folder_name : str
        Of the folder of images. Without a flight in it, images are those of ``Alt``, as Google's Static Maps has them;
        with one that fits no whole number of zooms more, windows are not known.
    """
    if len(table) == 0 or np.isfinite(table.pose_lat_deg).any():
        return table
    flight = _FLIGHT.fullmatch(folder_name)
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
    """Zooms (n,) by which images are finer than the table's, NaN where that is no whole number of them."""
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
    # Images are cut to whole pixels in a UTM plane: 0.01 zooms off at 100 px. Other cameras are off by any amount.
    return np.where((np.abs(exact - whole) <= 0.1) & (whole >= 0.0), whole, np.nan)
