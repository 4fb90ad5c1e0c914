"""The ground that images show, and blocks of it that separate the parts of a dataset.

The ground is divided into blocks, bands of latitude cut by meridians. Each block goes to a part, with all images
centred in it. Images whose ground overlaps that of another part, or is closer to it than the gap, are then removed:
from the training part first, from the test part never. Each image is compared with all close ones, so parts share no
ground, whatever the blocks are.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..arrays import Flags, Floats, NDArray, Numbers
from ..errors import InvalidInput
from ..geodesy.ellipsoid import sight_lines, trace
from ..geodesy.mercator import lat_to_v, lon_to_u, v_to_lat, wrap_lon_deg
from ..geodesy.planes import ProjectedPlane
from ..geodesy.reference import check_reference
from ..limits import MAX_TABLE_BYTES
from ..numbers import real_number
from ..storage.files import open_foreign, text_lines
from ..storage.stores import is_file
from .dataset import UNREADABLE, ImageSet, image_size, open_bands, open_undecoded
from .folder import MISSION_FILE, PLAN_FILE
from .published import add_windows
from .stored import ImageFile, has_sidecar
from .table import Table

#: Points along each edge of a frame at which its ground is computed.
_EDGE_POINTS = 33
#: Camera frames computed at a time, which bounds memory to about 50 MB.
_FRAMES_AT_ONCE = 4096
#: Length of the equator, for nominal sizes of blocks.
_EQUATOR_M = 40_075_017.0
#: Length of an average degree of latitude, for nominal sizes of blocks.
_DEGREE_M = 111_195.0


class GroundBoxes(NamedTuple):
    """Boxes (n,) around the ground of images, including edges.

    World fractions ``west_u`` < ``east_u`` are continuous, also across the antimeridian. Unknown ground is NaN.
    """

    west_u: Floats
    east_u: Floats
    south_deg: Floats
    north_deg: Floats

    @property
    def known(self) -> Flags:
        """Boxes (n,) with known ground."""
        found: Flags = np.isfinite(np.stack(self)).all(axis=0)
        return found

    def take(self, index: NDArray[np.intp] | Flags) -> GroundBoxes:
        """Select boxes."""
        return GroundBoxes(*(edge[index] for edge in self))


def ground_boxes(images: ImageSet, rows: NDArray[np.intp], dataset: Path, middle_lon_deg: float) -> GroundBoxes:
    """Boxes of the ground that images show.

    For map frames, the boxes are exactly the windows, or enclose them if they are in another CRS. For published
    datasets, they follow from the image sizes (see `published.add_windows`). For camera frames, they enclose the
    ground between the corners in the plan's table, with its curved edges and a margin. The ground of images that see
    the horizon or a pole, or that show no map, is unknown.

    Parameters
    ----------
    rows : array (k,)
        Rows of the table.
    dataset : Path
        Folder of the plan's table.
    middle_lon_deg : float
        Longitudes are continuous about it, up to half the world away.

    Raises
    ------
    InvalidInput
        A window is not centred on ``Lat``, ``Lon`` of its row, the plan's table is missing or lacks images, or the size
        of an image cannot be read.
    """
    table = images.table
    edges = np.full((4, len(rows)), np.nan)
    middle_u = float(lon_to_u(np.array(middle_lon_deg)))
    if not np.isfinite(table.pose_lat_deg).any() and not np.isfinite(table.left_px).any():
        # Zoom 0 means that the images show no map.
        on_map = table.zoom[rows] > 0
        if on_map.any():
            table = _published_table(images, rows[on_map])
    windows = (table.left_px, table.top_px, table.width_px, table.height_px)
    framed_rows = np.flatnonzero(np.isfinite([column[rows] for column in windows]).all(axis=0))
    # All images of a mission are frames of one kind.
    if len(framed_rows) and are_camera_frames(images, rows[framed_rows], dataset):
        edges[:, framed_rows] = _camera_boxes(table, rows[framed_rows], dataset / PLAN_FILE, middle_u)
    elif len(framed_rows) and any(table.crs):
        edges[:, framed_rows] = _plane_boxes(table, rows[framed_rows], middle_u)
    elif len(framed_rows):
        edges[:, framed_rows] = _window_boxes(table, rows[framed_rows], images.folder, middle_u)
    return GroundBoxes(*edges)


def _window_boxes(table: Table, rows: NDArray[np.intp], folder: Path, middle_u: float) -> GroundBoxes:
    """Boxes of windows in the source's pixels; the size of its tiles follows from the windows' positions."""
    left, top, width, height = (
        column[rows] for column in (table.left_px, table.top_px, table.width_px, table.height_px)
    )
    u, v = lon_to_u(table.lon_deg[rows]), lat_to_v(table.lat_deg[rows])
    tiles = np.exp2(table.zoom[rows].astype(np.float64))
    tiles_down = v * tiles
    tile_px = 256.0 * max(
        np.round(np.median((top + height / 2.0)[tiles_down > 0.0] / tiles_down[tiles_down > 0.0]) / 256.0), 1.0
    )
    world = tile_px * tiles
    off_x = (left + width / 2.0) / world - u
    off = np.maximum(np.abs(off_x - np.round(off_x)), np.abs((top + height / 2.0) / world - v)) * world
    # A window's middle and Lat, Lon may differ by a pixel, as degrees may have been written with few digits.
    is_off = ~(off <= 1.0)
    if is_off.any():
        name = table.img_names[rows[int(np.argmax(is_off))]]
        raise InvalidInput(
            "folder {0}: the window of {1} in the table lies elsewhere than its Lat and Lon",
            folder,
            name,
            remedy="put the table right, or split without blocks",
        )
    # Subtract turns as whole pixels, so that an edge shared by two windows keeps the same number in both.
    left = left - np.round((left + width / 2.0) / world - middle_u) * world
    return GroundBoxes(left / world, (left + width) / world, v_to_lat((top + height) / world), v_to_lat(top / world))


def _plane_boxes(table: Table, rows: NDArray[np.intp], middle_u: float) -> GroundBoxes:
    """Boxes of windows in other CRSs, around points along their edges, which are curved."""
    edges = np.full((4, len(rows)), np.nan)
    share = np.linspace(0.0, 1.0, _EDGE_POINTS)
    across = np.concatenate([share, np.ones_like(share), share, np.zeros_like(share)])
    down = np.concatenate([np.zeros_like(share), share, np.ones_like(share), share])
    crs = np.array(table.crs)[rows]
    for one in np.unique(crs):
        at = np.flatnonzero(crs == one)
        west, north, width, height, columns, lines = (
            values[rows[at], np.newaxis]
            for values in (
                *(table.west, table.north, table.pixel_width, table.pixel_height),
                *(table.width_px, table.height_px),
            )
        )
        plane = image_plane(table, int(rows[at[0]]))
        lat, lon = plane.from_crs(west + across * width * columns, north - down * height * lines)
        # No box holds the ground around a pole, whose longitudes add up to a turn.
        turns = wrap_lon_deg(np.roll(lon, -1, axis=1) - lon)
        known = np.isfinite(lat).all(axis=1) & (np.abs(turns.sum(axis=1)) < 180.0)
        lon = lon[:, :1] + np.concatenate([np.zeros((len(at), 1)), np.cumsum(turns[:, :-1], axis=1)], axis=1)
        u = lon_to_u(lon)
        u = u - np.round(u[:, :1] - middle_u)
        box = u.min(axis=1), u.max(axis=1), lat.min(axis=1), lat.max(axis=1)
        edges[:, at] = np.where(known, box, np.nan)
    return GroundBoxes(*edges)


def image_plane(table: Table, row: int) -> ProjectedPlane:
    """Plane of an image's CRS, in its units; raises InvalidInput, which names the image."""
    try:
        check_reference(table.crs[row])
    except InvalidInput as wrong:
        raise InvalidInput("image {0}: {1}", table.img_names[row], wrong) from wrong
    return ProjectedPlane(table.crs[row], 0.0, 0.0, 1.0, 1.0)


def _published_table(images: ImageSet, rows: NDArray[np.intp]) -> Table:
    """Add windows to some rows of a published dataset, from the sizes of their images."""
    table = images.table
    width, height = table.image_width_px.copy(), table.image_height_px.copy()
    for row in rows.tolist():
        if not (np.isfinite(width[row]) and np.isfinite(height[row])):
            width[row], height[row] = _read_size(images.file(row))
    return add_windows(replace(table, image_width_px=width, image_height_px=height), images.image_folder.name)


def _camera_boxes(table: Table, rows: NDArray[np.intp], plan: Path, middle_u: float) -> GroundBoxes:
    """Boxes of camera frames from poses and ground corners."""
    corners = _read_corners(plan, [Path(table.img_names[row]).stem for row in rows.tolist()])
    edges = np.empty((4, len(rows)))
    for start in range(0, len(rows), _FRAMES_AT_ONCE):
        some = slice(start, start + _FRAMES_AT_ONCE)
        at = rows[some]
        edges[:, some] = trace_boxes(
            table.pose_lat_deg[at], table.pose_lon_deg[at], table.agl_m[at], corners[some], middle_u
        )
    return GroundBoxes(*edges)


def trace_boxes(lat_deg: Floats, lon_deg: Floats, agl_m: Floats, corners: Floats, middle_u: float) -> GroundBoxes:
    """Boxes of the ground of cameras (n,) between corners (n, 4, 2) in latitude and longitude; unknown if NaN."""
    lat, agl = lat_deg[:, np.newaxis], agl_m[:, np.newaxis]
    towards = sight_lines(lat, agl, corners[..., 0], wrap_lon_deg(corners[..., 1] - lon_deg[:, np.newaxis]))
    share: Floats = np.linspace(0.0, 1.0, _EDGE_POINTS)[np.newaxis, np.newaxis, :, np.newaxis]
    # Points between two corners of the image lie on the plane of their sight lines.
    rays: Floats = towards[:, :, np.newaxis] * (1.0 - share) + np.roll(towards, -1, axis=1)[:, :, np.newaxis] * share
    ring = trace(lat[:, :, np.newaxis], agl[:, :, np.newaxis], rays)
    ring_lat, dlon = (values.reshape(len(lat), -1) for values in (ring.lat_deg, ring.dlon_deg))
    # No box holds the ground around a pole, whose longitudes add up to a turn.
    turns = wrap_lon_deg(np.roll(dlon, -1, axis=1) - dlon)
    known = ring.hit.reshape(len(lat), -1).all(axis=1) & (np.abs(turns.sum(axis=1)) < 180.0)
    dlon = dlon[:, :1] + np.concatenate([np.zeros((len(lat), 1)), np.cumsum(turns[:, :-1], axis=1)], axis=1)
    west, east, south, north = dlon.min(axis=1), dlon.max(axis=1), ring_lat.min(axis=1), ring_lat.max(axis=1)
    # Edges bend between their points by a thousandth of their length at most, and resampling reaches some pixels
    # beyond.
    margin = 1.0 / 32.0
    more_u, more_lat = (east - west) / 360.0 * margin, (north - south) * margin
    u = lon_to_u(lon_deg)
    u = u - np.round(u - middle_u)
    edges = (u + west / 360.0 - more_u, u + east / 360.0 + more_u, south - more_lat, north + more_lat)
    return GroundBoxes(*(np.where(known, edge, np.nan) for edge in edges))


def check_poses(images: ImageSet, rows: NDArray[np.intp], *, needed: bool) -> None:
    """Raise InvalidInput for impossible poses, which tables from elsewhere may have.

    Parameters
    ----------
    needed : bool
        Whether unknown poses are refused too. Cameras over level ground have no height above the ellipsoid.
    """
    # Longitudes are continuous along a flight, and wind adds to angles.
    limits = {"pose_lat_deg": 90.0, **dict.fromkeys(("pose_lon_deg", "yaw_deg", "tilt_deg", "roll_deg"), 720.0)}
    for name, most in {**limits, "agl_m": 1e9, "height_m": 1e9}.items():
        values = getattr(images.table, name)[rows]
        unknown = np.isnan(values)
        wrong = np.flatnonzero(~(np.abs(values) <= most) & (~unknown | (needed and name != "height_m")))
        if len(wrong):
            image, value = images.table.img_names[rows[wrong[0]]], values[wrong[0]]
            if np.isnan(value):
                raise InvalidInput("image {0}: its table has no {1} of it", image, name)
            raise InvalidInput(
                "image {0}: {1} {2:g} in its table: must be from {3:,g} to {4:,g}",
                image,
                name,
                value,
                -most,
                most,
            )


def are_camera_frames(images: ImageSet, rows: NDArray[np.intp], dataset: Path) -> bool:
    """Whether images are camera frames.

    Images of a tilted or turned camera always are. Images that look straight down, with the top to the map's north or a
    quarter turn from it, may be of either kind; of these, only map frames are georeferenced, by a GeoTIFF's tags or by
    a world file beside the image. Angles within the error budget, as on rows along meridians, count as straight down.
    """
    table = images.table
    # Map frames in another CRS point to its north.
    yaw = np.zeros(len(rows)) if any(table.crs) else np.nan_to_num(table.yaw_deg[rows])
    angles = (
        yaw - 90.0 * np.rint(yaw / 90.0),
        *(np.nan_to_num(angle[rows]) for angle in (table.tilt_deg, table.roll_deg)),
    )
    most = max(float(np.abs(angle).max()) for angle in angles)
    # By then, a map frame of 640 x 480 px is wrong by up to 35 px, more than a sensible error budget allows.
    if most > 5.0:
        return True
    path = images.file(int(rows[0]))
    if path.suffix.lower() in (".tif", ".tiff"):
        stored = open_bands(path)
        if stored is not None:
            return not stored.is_placed
        try:
            with open_undecoded(path) as image:
                # GeoTIFF tags that only map frames have: the pixel scale, or the transformation of a rotated image.
                return {33550, 34264}.isdisjoint(getattr(image, "tag_v2", {}))
        except UNREADABLE as wrong:
            raise InvalidInput("image {0}: cannot be read ({1})", path, wrong) from wrong
    captured = any(is_file(dataset / name) for name in (MISSION_FILE, PLAN_FILE))
    return (captured or most > 0.0) and not has_sidecar(path, (".jgw", ".pgw", ".wld", ".jpgw", ".pngw", ".tfw"))


def _read_size(path: ImageFile) -> tuple[int, int]:
    """Read the width and height of an image in px."""
    try:
        return image_size(path)
    except UNREADABLE as wrong:
        raise InvalidInput("image {0}: cannot be read ({1})", path, wrong) from wrong


def _read_corners(plan: Path, names: Sequence[str]) -> Floats:
    """Read latitudes and longitudes (n, 4, 2) of images' ground corners; NaN for corners that miss the Earth."""
    headers = [f"{corner}_{axis}_deg" for corner in ("nw", "ne", "se", "sw") for axis in ("lat", "lon")]
    corners = np.full((len(names), len(headers)), np.nan)
    missing = {name: at for at, name in enumerate(names)}
    try:
        with open_foreign(plan, MAX_TABLE_BYTES) as file:
            reader = csv.reader(text_lines(file, "utf-8"), strict=True)
            present = next(reader, [])
            name_at, *columns = (present.index(header) for header in ("name", *headers))
            for row in reader:
                at = missing.pop(row[name_at], None)
                if at is not None:
                    corners[at] = [real_number(row[column] or "nan") for column in columns]
    except (OSError, csv.Error, IndexError, ValueError) as wrong:
        raise InvalidInput(
            "{0}: cannot be read ({1}), and blocks need it for the ground of a turned camera's images: put it back, or "
            "split without blocks",
            plan,
            wrong,
        ) from wrong
    if missing:
        raise InvalidInput("{0}: has no row of {1}", plan, next(iter(missing)), remedy="put back the capture's own")
    return corners.reshape(-1, 4, 2)


def largest_side_m(boxes: GroundBoxes) -> float:
    """Longest side of boxes (n,), n > 0, in metres on the ground."""
    shrink = np.cos(np.radians((boxes.south_deg + boxes.north_deg) / 2.0))
    width_m = (boxes.east_u - boxes.west_u) * _EQUATOR_M * shrink
    return float(max(width_m.max(), ((boxes.north_deg - boxes.south_deg) * _DEGREE_M).max()))


def assign_blocks(boxes: GroundBoxes, block_m: float, counted: Flags) -> Numbers:
    """Number (n,) of the block that holds the centre of each box; blocks are at least about ``block_m`` wide.

    Boxes beyond the rectangle around the centres of ``counted`` ones are in the blocks at its edge.
    """
    lat, u = _centres(boxes, counted)
    south, west = boxes.south_deg.min(), boxes.west_u.min()
    step_deg = block_m / _DEGREE_M
    row = _floor_rounded((lat - south) / step_deg)
    # Near a pole, use the blocks of 89.9°, where the cosine is not 0.
    middle = np.radians(np.clip(south + (row + 0.5) * step_deg, -89.9, 89.9))
    # A whole number of blocks around the world: each has two neighbours, also at the antimeridian.
    around = np.maximum(np.floor(_EQUATOR_M * np.cos(middle) / block_m), 1.0)
    column = _floor_rounded(np.mod(u - west, 1.0) * around)
    _, numbers = np.unique(np.stack([row, column]), axis=1, return_inverse=True)
    return np.asarray(numbers, np.int64).reshape(-1)


def _centres(boxes: GroundBoxes, counted: Flags) -> tuple[Floats, Floats]:
    """Latitudes and world fractions (n,) of centres, moved to the rectangle around the centres of counted boxes."""
    lat, u = (boxes.south_deg + boxes.north_deg) / 2.0, (boxes.west_u + boxes.east_u) / 2.0
    lat, u = (np.clip(at, at[counted].min(), at[counted].max()) for at in (lat, u))
    return lat, u


def assign_strips(boxes: GroundBoxes, across: bool, counted: Flags) -> tuple[Numbers, float]:
    """Number (n,) of the thin strip that holds the centre of each box, from one side to the other, and its width in m.

    ``across`` numbers strips from west to east, otherwise from south to north; ``counted`` as for `assign_blocks`.
    """
    lat, u = _centres(boxes, counted)
    at_m = u * _EQUATOR_M * math.cos(math.radians(float(lat.mean()))) if across else lat * _DEGREE_M
    # Finer strips bring the shares no closer, and take longer.
    width_m = max(float(np.ptp(at_m)) / 256.0, 1e-3)
    _, numbers = np.unique(_floor_rounded((at_m - at_m.min()) / width_m), return_inverse=True)
    return np.asarray(numbers, np.int64).reshape(-1), width_m


def assign_parts(
    boxes: GroundBoxes,
    block: Numbers,
    order: Sequence[int],
    shares: Sequence[float],
    gap_m: float,
    counted: Flags,
) -> Numbers:
    """Assign boxes (n,) to parts: 0 training, 1 validation, 2 test, -1 for the gap.

    Parameters
    ----------
    block : array (n,)
        Block of each box, from `assign_blocks`.
    order : sequence of int
        All blocks, in the order in which the test and validation parts take them.
    shares : sequence of float
        Shares of training, validation and test among the counted boxes outside the gap.
    gap_m : float
        Smallest distance between the ground of different parts.
    counted : bool array (n,)
        Boxes to share out; the others follow them. Blocks without counted boxes are in training.
    """
    sizes = np.bincount(block[counted], minlength=int(block.max()) + 1)
    order = [one for one in order if sizes[one]]
    best, best_off = np.full(len(block), -1, np.int64), math.inf
    targets = [share * int(counted.sum()) for share in shares]
    # Repeated, as the images in the gap change the shares.
    for _ in range(6):
        of_block = _assign_parts(sizes, order, shares, targets)
        part = _remove_gap(boxes, of_block[block], gap_m)
        off = deviation(part[counted], shares)
        if off < best_off:
            best, best_off = part, off
        counts = np.array([(part[counted] == one).sum() for one in range(3)], np.float64)
        # Aim higher for parts that lost images to the gap, and lower for others.
        moved = [target + (share * counts.sum() - count) / 2.0 for target, share, count in zip(targets, shares, counts)]
        if moved == targets:
            break
        targets = moved
    return best


def deviation(part: Numbers, shares: Sequence[float]) -> float:
    """Largest difference between the shares reached and those asked for; infinite if a part has no images."""
    counts = [int((part == one).sum()) for one in range(3)]
    if any(share > 0.0 and not count for share, count in zip(shares, counts)):
        return math.inf
    return max(abs(count / sum(counts) - share) for share, count in zip(shares, counts))


def _assign_parts(sizes: Numbers, order: Sequence[int], shares: Sequence[float], targets: Sequence[float]) -> Numbers:
    """Assign blocks to parts so that each part has about its target number of images."""
    of_block = np.zeros(len(sizes), np.int64)
    left = list(order)
    for part in (2, 1):
        if shares[part] <= 0.0:
            continue
        taken = 0
        kept: list[int] = []
        others_need = int(shares[0] > 0.0) + (int(shares[1] > 0.0) if part == 2 else 0)
        for at, one in enumerate(left):
            size = int(sizes[one])
            room = len(left) - at - 1 + len(kept) >= others_need
            if room and (not taken or taken + size / 2.0 <= targets[part]) and taken < targets[part]:
                taken += size
                of_block[one] = part
            else:
                kept.append(one)
        left = kept
    if shares[0] <= 0.0:
        of_block[left] = 1 if shares[1] > 0.0 else 2
    return of_block


def _remove_gap(boxes: GroundBoxes, part: Numbers, gap_m: float) -> Numbers:
    """Copy parts (n,) with -1 for boxes too close to a box of a later part."""
    part = part.copy()
    for low, high in ((1, (2,)), (0, (1, 2))):
        mine, others = np.flatnonzero(part == low), np.flatnonzero(np.isin(part, high))
        if len(mine) and len(others):
            part[mine[find_close(boxes.take(mine), boxes.take(others), gap_m)]] = -1
    return part


def find_close(boxes: GroundBoxes, others: GroundBoxes, gap_m: float) -> Flags:
    """Find boxes (n,) that share ground with one of others (m,), or are closer than the gap to one of them.

    Boxes that only touch share nothing. Cases of doubt, at corners and by the shape of the Earth, count as close.
    """
    wide = _enlarge(others, gap_m)
    found = np.zeros(len(boxes.west_u), np.bool_)
    for mine in _size_classes(boxes):
        for theirs in _size_classes(wide):
            some = boxes.take(mine)
            # Longitudes repeat after a turn.
            for turn in (-1.0, 0.0, 1.0):
                turned = wide.take(theirs)._replace(
                    west_u=wide.west_u[theirs] + turn, east_u=wide.east_u[theirs] + turn
                )
                within = (turned.east_u > some.west_u.min()) & (turned.west_u < some.east_u.max())
                if within.any():
                    found[mine] |= _find_overlapping(some, turned.take(within))
    return found


def _enlarge(boxes: GroundBoxes, gap_m: float) -> GroundBoxes:
    """Enlarge boxes by all ground within a gap around them.

    On a sphere, the ground within the angle d of a point at latitude φ reaches asin(sin d / cos φ) east and west of it.
    """
    if gap_m == 0.0:
        return boxes
    # Less than the ellipsoid's smallest radius of curvature, 6335 km, so that angles are never too small.
    angle = gap_m / 6_330_000.0
    farthest = np.radians(np.maximum(np.abs(boxes.south_deg), np.abs(boxes.north_deg)))
    ratio = math.sin(angle) / np.maximum(np.cos(farthest), 1e-12)
    over_pole = farthest + angle >= math.pi / 2.0
    more_u = np.where(over_pole, 0.5, np.arcsin(np.minimum(ratio, 1.0)) / (2.0 * math.pi))
    more_deg = math.degrees(angle)
    return GroundBoxes(
        boxes.west_u - more_u, boxes.east_u + more_u, boxes.south_deg - more_deg, boxes.north_deg + more_deg
    )


def _size_classes(boxes: GroundBoxes) -> Iterator[NDArray[np.intp]]:
    """Yield indices of boxes of about the same size."""
    size = np.maximum(boxes.east_u - boxes.west_u, (boxes.north_deg - boxes.south_deg) / 360.0)
    # Sizes in a class differ by up to a factor of 4, so bins as large as the largest box hold few of the others.
    kind = np.floor(np.log(np.maximum(size, 1e-12)) / math.log(4.0))
    for one in np.unique(kind):
        yield np.flatnonzero(kind == one)


def _find_overlapping(boxes: GroundBoxes, others: GroundBoxes) -> Flags:
    """Find boxes (n,) that share ground with one of others (m,), n and m > 0."""
    bin_u = max(_widest(boxes.east_u - boxes.west_u), _widest(others.east_u - others.west_u))
    bin_deg = max(_widest(boxes.north_deg - boxes.south_deg), _widest(others.north_deg - others.south_deg))
    west, south = others.west_u.min() - bin_u, others.south_deg.min() - bin_deg

    def columns(u: Floats) -> Numbers:
        return np.asarray(np.floor((u - west) / bin_u), np.int64)

    def rows(lat_deg: Floats) -> Numbers:
        return np.asarray(np.floor((lat_deg - south) / bin_deg), np.int64)

    # Each box is in the bin of its south-west corner; bins of overlapping boxes are at most one apart.
    first_column, last_column = columns(others.west_u) - 1, columns(others.east_u)
    first_row, last_row = rows(others.south_deg) - 1, rows(others.north_deg)
    across = max(int(last_column.max()), int(columns(boxes.west_u).max())) + 3
    inside = columns(boxes.west_u) >= -1
    # Boxes west of the first column overlap none.
    candidates = np.flatnonzero(inside)
    keys = rows(boxes.south_deg[candidates]) * across + columns(boxes.west_u[candidates]) + 1
    sorting = np.argsort(keys, kind="stable")
    candidates, keys = candidates[sorting], keys[sorting]
    found = np.zeros(len(boxes.west_u), np.bool_)
    for step in range(int((last_row - first_row).max()) + 1):
        row = first_row + step
        start = np.searchsorted(keys, row * across + first_column + 1, "left")
        stop = np.searchsorted(keys, row * across + last_column + 1, "right")
        stop = np.where(row <= last_row, np.maximum(stop, start), start)
        for other, mine in _pairs(start, stop):
            at = candidates[mine]
            met = (
                (boxes.west_u[at] < others.east_u[other])
                & (boxes.east_u[at] > others.west_u[other])
                & (boxes.south_deg[at] < others.north_deg[other])
                & (boxes.north_deg[at] > others.south_deg[other])
            )
            found[at[met]] = True
    return found


def _pairs(start: Numbers, stop: Numbers) -> Iterator[tuple[Numbers, Numbers]]:
    """Yield pairs of i and each number from start[i] up to stop[i], some at a time."""
    counts = stop - start
    ends = np.cumsum(counts)
    first = 0
    while first < len(counts):
        before = int(ends[first - 1]) if first else 0
        # Bounds memory to about 100 MB.
        last = max(int(np.searchsorted(ends, before + 2_000_000, "right")), first + 1)
        some = np.arange(first, last)
        index = np.repeat(some, counts[first:last])
        offset = np.arange(len(index)) - np.repeat(ends[first:last] - counts[first:last] - before, counts[first:last])
        yield index, start[index] + offset
        first = last


def _widest(sizes: Floats) -> float:
    """Largest size and a little more, so that rounding does not put overlapping boxes two bins apart."""
    return max(float(sizes.max()), 1e-12) * (1.0 + 1e-6)


def _floor_rounded(values: Floats) -> Floats:
    # Centres of regular missions often lie on the border of two blocks: round, so that every machine chooses the same.
    step = 2.0**-20
    whole: Floats = np.floor(np.round(values / step) * step)
    return whole
