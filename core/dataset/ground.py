"""The ground that images show: a box of longitude and latitude about each."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..errors import InvalidInput
from ..geodesy.ellipsoid import sight_lines, trace
from ..geodesy.mercator import lat_to_v, lon_to_u, v_to_lat, wrap_lon_deg
from .dataset import ImageSet
from .decode import UNREADABLE
from .folder import MISSION_FILE, PLAN_FILE
from .published import framed
from .table import Table

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: A window's middle and ``Lat``, ``Lon`` are the same place: they may differ by this, in px, which digits of a degree
#: that were written short make up.
_SAME_PX = 1.0
#: TIFF tag of GeoTIFF: the size of a pixel on the map, which only a map frame has.
_PIXEL_SCALE_TAG = 33550
_WORLD_FILES = (".jgw", ".pgw", ".wld", ".jpgw", ".pngw", ".tfw")
_CORNERS = ("nw", "ne", "se", "sw")
#: Points along each edge of a camera frame at which its ground is worked out.
_EDGE_POINTS = 33
#: Camera frames that are worked out at a time, to bound memory: some 50 MB.
_FRAMES = 4096
#: By this share of its size a camera frame's box is larger on each side: an edge bends between its points by a
#: thousandth of its length at most, and kernels reach some pixels beyond an image's edge.
_MARGIN = 1.0 / 32.0


class Boxes(NamedTuple):
    """Boxes (n,) that hold the ground of images, edges included.

    World fractions ``west_u`` < ``east_u`` are continuous: of images beside each other they differ by their distance,
    also across the antimeridian. NaN where the ground is not known.
    """

    west_u: Floats
    east_u: Floats
    south_deg: Floats
    north_deg: Floats

    @property
    def known(self) -> Flags:
        """Those whose ground is known."""
        found: Flags = np.isfinite(np.stack(self)).all(axis=0)
        return found

    def take(self, index: NDArray[np.intp] | Flags) -> Boxes:
        """Some of them."""
        return Boxes(*(edge[index] for edge in self))


def boxes_of(images: ImageSet, rows: NDArray[np.intp], dataset: Path, middle_lon_deg: float) -> Boxes:
    """Boxes of the ground that some images show.

    Of map frames these are their windows, exactly; of the published datasets, what `published.framed` makes of the
    images' sizes; of camera frames, the ground within the four corners of the plan's table, of which curved edges are
    followed, and a margin. Not known is the ground of an image that sees the horizon or a pole, and of one that no map
    has been the source of.

    Parameters
    ----------
    rows : array (k,)
        Of the table.
    dataset : Path
        Folder in which the plan's table lies.
    middle_lon_deg : float
        Longitudes are continuous about it, up to half the world away.

    Raises
    ------
    InvalidInput
        Rows whose window lies elsewhere than their centre, a plan's table that is missed or lacks images, images whose
        size cannot be read: they are named.
    """
    table = images.table
    edges = np.full((4, len(rows)), np.nan)
    middle_u = float(lon_to_u(np.array(middle_lon_deg)))
    if not np.isfinite(table.pose_lat_deg).any() and not np.isfinite(table.left_px).any():
        # Zoom 0 stands for no map at all.
        on_map = table.zoom[rows] > 0
        if on_map.any():
            table = _published(images, rows[on_map])
    windows = (table.left_px, table.top_px, table.width_px, table.height_px)
    framed_rows = np.flatnonzero(np.isfinite([column[rows] for column in windows]).all(axis=0))
    # All images of a mission are frames of one kind.
    if len(framed_rows) and _of_camera(images, rows[framed_rows], dataset):
        edges[:, framed_rows] = _seen(table, rows[framed_rows], dataset / PLAN_FILE, middle_u)
    elif len(framed_rows):
        edges[:, framed_rows] = _windows(table, rows[framed_rows], images.folder, middle_u)
    return Boxes(*edges)


def _windows(table: Table, rows: NDArray[np.intp], folder: Path, middle_u: float) -> Boxes:
    """Boxes of windows in the source's pixels, whose number around the world follows from where the windows lie."""
    left, top, width, height = (
        column[rows] for column in (table.left_px, table.top_px, table.width_px, table.height_px)
    )
    u, v = lon_to_u(table.lon_deg[rows]), lat_to_v(table.lat_deg[rows])
    tiles = np.exp2(table.zoom[rows].astype(np.float64))
    far = v * tiles
    tile_px = 256.0 * max(np.round(np.median((top + height / 2.0)[far > 0.0] / far[far > 0.0]) / 256.0), 1.0)
    world = tile_px * tiles
    off_x = (left + width / 2.0) / world - u
    off = np.maximum(np.abs(off_x - np.round(off_x)), np.abs((top + height / 2.0) / world - v)) * world
    if not (off <= _SAME_PX).all():
        name = table.img_names[rows[int(np.argmax(~(off <= _SAME_PX)))]]
        raise InvalidInput(
            f"folder {folder}: the window of {name} in the table lies elsewhere than its Lat and Lon; put the "
            "table right, or split without blocks"
        )
    # Whole turns are taken off whole pixels, so that edges that two windows share stay the same number.
    left = left - np.round((left + width / 2.0) / world - middle_u) * world
    return Boxes(
        left / world, (left + width) / world, v_to_lat((top + height) / world), v_to_lat(top / world)
    )


def _published(images: ImageSet, rows: NDArray[np.intp]) -> Table:
    """Table of a published dataset with the windows of some rows, which the sizes of their images tell."""
    table = images.table
    width, height = table.image_width_px.copy(), table.image_height_px.copy()
    for row in rows.tolist():
        if not (np.isfinite(width[row]) and np.isfinite(height[row])):
            width[row], height[row] = _size(images.path(row))
    return framed(replace(table, image_width_px=width, image_height_px=height), images.image_folder.name)


def _seen(table: Table, rows: NDArray[np.intp], plan: Path, middle_u: float) -> Boxes:
    """Boxes of camera frames, from their poses and ground corners."""
    corners = _corners(plan, [Path(table.img_names[row]).stem for row in rows.tolist()])
    edges = np.empty((4, len(rows)))
    for start in range(0, len(rows), _FRAMES):
        some = slice(start, start + _FRAMES)
        at = rows[some]
        edges[:, some] = _traced(
            table.pose_lat_deg[at], table.pose_lon_deg[at], table.agl_m[at], corners[some], middle_u
        )
    return Boxes(*edges)


def _traced(lat_deg: Floats, lon_deg: Floats, agl_m: Floats, corners: Floats, middle_u: float) -> Boxes:
    """Boxes of the ground of cameras (n,) between corners (n, 4, 2) in latitude and longitude, of which NaN is none."""
    lat, agl = lat_deg[:, np.newaxis], agl_m[:, np.newaxis]
    towards = sight_lines(lat, agl, corners[..., 0], wrap_lon_deg(corners[..., 1] - lon_deg[:, np.newaxis]))
    share: Floats = np.linspace(0.0, 1.0, _EDGE_POINTS)[np.newaxis, np.newaxis, :, np.newaxis]
    # What lies between two corners in the image lies on the plane of their sight lines.
    rays: Floats = (
        towards[:, :, np.newaxis] * (1.0 - share) + np.roll(towards, -1, axis=1)[:, :, np.newaxis] * share
    )
    ring = trace(lat[:, :, np.newaxis], agl[:, :, np.newaxis], rays)
    ring_lat, dlon = (values.reshape(len(lat), -1) for values in (ring.lat_deg, ring.dlon_deg))
    # Around a pole the longitudes go on and on, and no box holds the ground.
    way = wrap_lon_deg(np.roll(dlon, -1, axis=1) - dlon)
    known = ring.hit.reshape(len(lat), -1).all(axis=1) & (np.abs(way.sum(axis=1)) < 180.0)
    dlon = dlon[:, :1] + np.concatenate([np.zeros((len(lat), 1)), np.cumsum(way[:, :-1], axis=1)], axis=1)
    west, east, south, north = dlon.min(axis=1), dlon.max(axis=1), ring_lat.min(axis=1), ring_lat.max(axis=1)
    more_u, more_lat = (east - west) / 360.0 * _MARGIN, (north - south) * _MARGIN
    u = lon_to_u(lon_deg)
    u = u - np.round(u - middle_u)
    edges = (u + west / 360.0 - more_u, u + east / 360.0 + more_u, south - more_lat, north + more_lat)
    return Boxes(*(np.where(known, edge, np.nan) for edge in edges))


def _of_camera(images: ImageSet, rows: NDArray[np.intp], dataset: Path) -> bool:
    """Whether images are camera frames.

    A turned camera's are, whatever lies beside them. One that looks straight down may have made either kind: of the
    two, only map frames have a place on the map of their own, which a GeoTIFF says itself, and of others the world file
    that a capture leaves beside each.
    """
    table = images.table
    turned = [np.nan_to_num(angle[rows]) != 0.0 for angle in (table.yaw_deg, table.tilt_deg, table.roll_deg)]
    if np.any(turned):
        return True
    path = images.path(int(rows[0]))
    if path.suffix.lower() in (".tif", ".tiff"):
        try:
            with Image.open(path) as image:
                return _PIXEL_SCALE_TAG not in getattr(image, "tag_v2", {})
        except UNREADABLE as wrong:
            raise InvalidInput(f"image {path}: cannot be read ({wrong})") from wrong
    captured = any((dataset / name).is_file() for name in (MISSION_FILE, PLAN_FILE))
    return captured and not any(path.with_suffix(ending).exists() for ending in _WORLD_FILES)


def _size(path: Path) -> tuple[int, int]:
    """Width and height of an image in px."""
    try:
        with Image.open(path) as image:
            return image.size
    except UNREADABLE as wrong:
        raise InvalidInput(f"image {path}: cannot be read ({wrong})") from wrong


def _corners(plan: Path, names: Sequence[str]) -> Floats:
    """Latitudes and longitudes (n, 4, 2) of images' ground corners; NaN where one looks past the Earth."""
    headers = [f"{corner}_{axis}_deg" for corner in _CORNERS for axis in ("lat", "lon")]
    corners = np.full((len(names), len(headers)), np.nan)
    missing = {name: at for at, name in enumerate(names)}
    try:
        with plan.open(encoding="utf-8", newline="") as file:
            reader = csv.reader(file, strict=True)
            present = next(reader, [])
            name_at, *columns = (present.index(header) for header in ("name", *headers))
            for row in reader:
                at = missing.pop(row[name_at], None)
                if at is not None:
                    corners[at] = [float(row[column] or "nan") for column in columns]
    except (OSError, csv.Error, IndexError, ValueError) as wrong:
        raise InvalidInput(
            f"{plan}: cannot be read ({wrong}); it tells the ground of a turned camera's images, without which there "
            "are no blocks of it: put it back, or split without blocks"
        ) from wrong
    if missing:
        raise InvalidInput(f"{plan}: has no row of {next(iter(missing))}; put back the capture's own")
    return corners.reshape(-1, len(_CORNERS), 2)
