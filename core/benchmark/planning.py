"""A benchmark planned before anything is fetched: its queries, and the reference that covers their ground."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..arrays import NDArray
from ..dataset.folder import SHARES
from ..dataset.ground import GroundBoxes, largest_side_m, trace_boxes
from ..dataset.labels import middle_position
from ..dataset.split import checked_shares, split_blocks
from ..dataset.table import GAP
from ..errors import InvalidInput, Message
from ..geodesy.camera import Camera
from ..geodesy.ellipsoid import WGS84
from ..geodesy.frames import Windows, window_centres
from ..geodesy.mercator import MAX_LAT_DEG, PixelGrid, lon_to_u, wrap_lon_deg
from ..limits import MAX_PICTURE_PX, MAX_PICTURE_SIDE_PX
from ..mission.areas.area import Box, Points
from ..mission.imageries import NamedImagery
from ..mission.inside import captured_points, captures_inside
from ..mission.layout.frames import MapFrames
from ..mission.mission import Mission
from ..mission.parts import LABELLED
from ..mission.plan import Plan, plan
from ..mission.relief.ground import Heights
from .choices import CROSS_AREA, POSITIVE_IOU, SEMI_POSITIVE_IOU, SPLITS, TILE_OVERLAP
from .folder import MOSAIC, QUERIES_FOLDER, REFERENCE_FOLDER, SCHEMA, TILES

#: Nominal field of view of the mosaic and the tiles; any other would give the same map frames.
_FOV_DEG = 30.0
#: Least width of a tile: narrower tiles show too little to recognise, and their number would be unlimited.
_LEAST_TILE_PX = 16


@dataclass(frozen=True)
class BenchmarkSettings:
    """Settings of a benchmark.

    Parameters
    ----------
    queries : Mission
        Mission of the queries; its imagery is replaced by each of ``imageries``.
    imageries : tuple of NamedImagery
        Imageries of the queries; every query is captured from each.
    reference : NamedImagery
        Imagery in which queries are localised.
    tile_widths_m : tuple of float
        Widths of the reference's tiles on the ground; if empty, the side of a square with the median area of queries.
    tile_overlap : float
        Overlap of neighbouring tiles as a share of their width, in [0, 1).
    margin_m : float or None
        Margin of the reference around the queries' ground; None for the width of the widest tile.
    positive_iou, semi_positive_iou : float
        Least intersection over union, on the ground, of a query and a positive or semi-positive tile.
    split : str
        One of `SPLITS`.
    shares : three numbers
        Shares of training, validation and test.
    gap_m : float
        Minimum distance between the ground of two parts; for ``cross-area`` only.
    inside : bool
        Whether to leave out queries that see beyond the reference or one of the ``imageries``.
    reference_buildings : tuple of str
        Buildings in which queries are localised, as in a mission's ``buildings``. Queries then have masks of the
        buildings of their mission; if it has none, they get these.
    """

    queries: Mission
    imageries: tuple[NamedImagery, ...]
    reference: NamedImagery
    tile_widths_m: tuple[float, ...] = ()
    tile_overlap: float = TILE_OVERLAP
    margin_m: float | None = None
    positive_iou: float = POSITIVE_IOU
    semi_positive_iou: float = SEMI_POSITIVE_IOU
    split: str = CROSS_AREA
    shares: tuple[float, float, float] = SHARES
    gap_m: float = 0.0
    inside: bool = False
    reference_buildings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.reference_buildings:
            object.__setattr__(self, "queries", self._with_masks())
        if not self.imageries:
            raise InvalidInput("no imagery of queries: give one or more, such as drone=world")
        for width in self.tile_widths_m:
            if not (math.isfinite(width) and width > 0.0):
                raise InvalidInput("tiles of {0} m: must be wider than 0", width)
        if len({f"{width:g}" for width in self.tile_widths_m}) != len(self.tile_widths_m):
            raise InvalidInput("tiles of {0} m: each width may be given once", _listed(self.tile_widths_m))
        if not 0.0 <= self.tile_overlap < 1.0:
            raise InvalidInput("overlap of tiles {0}: must be from 0 to below 1", self.tile_overlap)
        if self.margin_m is not None and not (math.isfinite(self.margin_m) and self.margin_m >= 0.0):
            raise InvalidInput("margin {0} m: must be 0 or more", self.margin_m)
        if not 0.0 < self.semi_positive_iou <= self.positive_iou <= 1.0:
            raise InvalidInput(
                "intersection over union {0} and {1}: must be above 0, up to 1, and the first not below the second",
                self.positive_iou,
                self.semi_positive_iou,
            )
        if self.split not in SPLITS:
            raise InvalidInput("split {0!r}: must be one of {1}", self.split, ", ".join(SPLITS))

    def _with_masks(self) -> Mission:
        """Mission of the queries with buildings, and with the classes and instances of every pixel."""
        asked = self.queries
        if asked.labels.labels:
            raise InvalidInput(
                "labels {0}: must be left out of a benchmark with reference buildings, whose queries have the masks "
                "of buildings alone",
                ", ".join(asked.labels.labels),
                field="labels",
            )
        products = (*asked.products, *(one for one in LABELLED if one not in asked.products))
        return asked.replace(buildings=asked.terrain.buildings or self.reference_buildings, products=products)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping; equal settings give equal mappings."""
        return {
            "schema": SCHEMA,
            "queries": self.queries.to_dict(),
            "imageries": [str(one) for one in self.imageries],
            "reference": str(self.reference),
            "tile_widths_m": list(self.tile_widths_m),
            "tile_overlap": self.tile_overlap,
            "margin_m": self.margin_m,
            "positive_iou": self.positive_iou,
            "semi_positive_iou": self.semi_positive_iou,
            "split": self.split,
            "shares": list(self.shares),
            "gap_m": self.gap_m,
            # Only if set, as benchmarks of earlier versions lack it.
            **({"inside": True} if self.inside else {}),
            **({"reference_buildings": list(self.reference_buildings)} if self.reference_buildings else {}),
        }


@dataclass(frozen=True, eq=False)
class BenchmarkPlan:
    """Plans of a benchmark's captures.

    Attributes
    ----------
    queries : mapping of str to Plan
        By name of imagery; all plans have equal poses at equal indices.
    mosaic : Plan
        Plan of the reference as one image.
    tiles : mapping of float to Plan
        By width in metres.
    left_out : int
        Number of queries of each imagery left out by ``inside``.
    """

    settings: BenchmarkSettings
    queries: Mapping[str, Plan]
    mosaic: Plan
    tiles: Mapping[float, Plan] = field(default_factory=dict)
    left_out: int = 0

    @property
    def captures(self) -> dict[str, tuple[NamedImagery, Plan]]:
        """Imagery and plan of each capture, by its folder."""
        reference = self.settings.reference
        return {
            f"{REFERENCE_FOLDER}/{MOSAIC}": (reference, self.mosaic),
            **{tiles_folder(width): (reference, one) for width, one in self.tiles.items()},
            **{f"{QUERIES_FOLDER}/{one.name}": (one, self.queries[one.name]) for one in self.settings.imageries},
        }


def tiles_folder(width_m: float) -> str:
    """Folder of the tiles of a width, relative to the benchmark's folder."""
    return f"{REFERENCE_FOLDER}/{TILES}_{width_m:g}m"


def plan_benchmark(
    settings: BenchmarkSettings, grids: Mapping[str, PixelGrid], heights: Heights | None = None
) -> BenchmarkPlan:
    """Plan a benchmark.

    Parameters
    ----------
    grids : mapping of str to PixelGrid
        Pixel grid of each imagery's source, keyed by ``str`` of the imagery.
    heights : Heights or None
        Heights of the queries' elevation model; None without one.

    Raises
    ------
    InvalidInput
        The queries cannot be flown or see the horizon, the reference exceeds the size of an image, or most queries
        would be in no part.
    """
    mission = settings.queries.replace(frame="camera")
    if mission.varied.of_lens:
        raise InvalidInput(
            "vary {0!r}: benchmarks have one camera",
            str(mission.varied.of_lens[0]),
            field="vary",
            remedy="choose other fields",
        )
    if mission.camera.distorts:
        raise InvalidInput(
            "lens that distorts: benchmarks state only focal lengths, and need a lens without distortion",
            field="k1",
        )

    def plan_imageries(mission: Mission) -> dict[str, Plan]:
        return {one.name: plan(mission.select_imagery(one), grids[str(one)], heights) for one in settings.imageries}

    queries, left_out = plan_imageries(mission), 0
    if settings.inside:
        requested = len(queries[settings.imageries[0].name])
        # Plan again until none is left out: in wind, the remaining queries move.
        while not (is_inside := _inside(settings, queries, grids)).all():
            mission = captured_points(mission, queries[settings.imageries[0].name], is_inside)
            queries = plan_imageries(mission)
        left_out = requested - len(is_inside)
    first = queries[settings.imageries[0].name]
    for name, planned in queries.items():
        beyond = np.flatnonzero(~planned.corners.hit.all(axis=1))
        if len(beyond):
            raise InvalidInput(
                "queries of {0}: {1:,} of {2:,} see the horizon, first {3}, and no reference holds their ground",
                name,
                len(beyond),
                len(planned),
                planned.names[beyond[0]],
                remedy="tilt less, or take a narrower camera",
            )
    widths = settings.tile_widths_m or (round(_median_side_m(first), 1),)
    box = _enlarged(_ground(queries), max(widths) if settings.margin_m is None else settings.margin_m)
    gsd_m = first.resolution.delivered_m_per_px
    mosaic = _mosaic(settings, box, gsd_m, grids[str(settings.reference)])
    tiles = {width: _tiles(settings, mosaic, width) for width in widths}
    if settings.split == CROSS_AREA:
        _check_parts(settings, first, tiles)
    return BenchmarkPlan(settings, queries, mosaic, tiles, left_out)


def _check_parts(settings: BenchmarkSettings, queries: Plan, tiles: Mapping[float, Plan]) -> None:
    """Raise InvalidInput if a part would be empty or, without a gap, most queries would be in no part."""
    shares = checked_shares(settings.shares)
    _, middle_lon = middle_position(*queries.frame_centres)
    middle_u = float(lon_to_u(np.array(middle_lon)))
    poses, corners = queries.poses, queries.corners
    boxes = [
        trace_boxes(
            poses.lat_deg, poses.lon_deg, poses.agl_m, np.stack([corners.lat_deg, corners.lon_deg], axis=2), middle_u
        ),
        *(_tile_boxes(one, middle_u) for one in tiles.values()),
    ]
    # As when it is made: the order of the blocks depends on the names.
    folders = {f"{QUERIES_FOLDER}/{settings.imageries[0].name}": queries}
    folders.update((tiles_folder(width), one) for width, one in tiles.items())
    names = [f"{folder}/{name}" for folder, one in folders.items() for name in one.names]
    ground = GroundBoxes(*(np.concatenate(edges) for edges in zip(*boxes)))
    known, is_query = ground.known, np.arange(len(names)) < len(queries)
    ground, is_query = ground.take(known), is_query[known]
    named = [name for name, is_known in zip(names, known.tolist()) if is_known]
    gap_m, seed = float(settings.gap_m), settings.queries.imagery.seed
    wrong: InvalidInput | None = None
    try:
        part, _, _ = split_blocks(ground, named, shares, seed, gap_m=gap_m, counted=is_query)
        if gap_m > 0.0 or np.count_nonzero(np.array(part)[is_query] != GAP) >= len(queries) / 2:
            return
    except InvalidInput as refused:
        wrong = refused
    widest_m = largest_side_m(ground)
    # Of strips, each border between two takes the queries that a query or tile of the other reaches.
    borders = sum(share > 0.0 for share in shares) - 1
    long_m = widest_m * (1.0 + 2.0 * borders) + 2.0 * borders * gap_m
    raise InvalidInput(
        "split cross-area: most of {0:,} queries would be in no part, or a part would be empty, as queries and tiles "
        "up to {1:,.0f} m wide show the same ground",
        len(queries),
        widest_m,
        remedy=Message("choose a smaller gap, an area {0:,.0f} m long or more, or split same-area", long_m)
        if gap_m > 0.0
        else Message("take an area {0:,.0f} m long or more, or split same-area", long_m),
    ) from wrong


def _tile_boxes(tiles: Plan, middle_u: float) -> GroundBoxes:
    """Boxes of the ground of tiles; neighbours that meet share nothing by rounding."""
    lat, lon = tiles.corners.lat_deg, tiles.corners.lon_deg
    u = lon_to_u(lon[:, :1] + wrap_lon_deg(lon - lon[:, :1]))
    u = u - np.round(u[:, :1] - middle_u)
    across, up = np.ptp(u, axis=1) * 1e-6, np.ptp(lat, axis=1) * 1e-6
    return GroundBoxes(u.min(axis=1) + across, u.max(axis=1) - across, lat.min(axis=1) + up, lat.max(axis=1) - up)


def _inside(
    settings: BenchmarkSettings, queries: Mapping[str, Plan], grids: Mapping[str, PixelGrid]
) -> NDArray[np.bool_]:
    """Whether each query (n,) sees only ground within the imageries of the queries and the reference."""
    found = [captures_inside(queries[one.name], grids[str(one)]) for one in settings.imageries]
    found.append(captures_inside(queries[settings.imageries[0].name], grids[str(settings.reference)]))
    whole: NDArray[np.bool_] = np.logical_and.reduce(found)
    return whole


def _clipped(mosaic: Plan) -> Plan:
    """Plan of one map frame, clipped to its source's imagery."""
    windows, (west, top, east, bottom) = mosaic.windows, _extent_px(mosaic)
    left, upper = np.maximum(windows.left_px, west), np.maximum(windows.top_px, top)
    right = np.minimum(windows.left_px + windows.width_px, east)
    lower = np.minimum(windows.top_px + windows.height_px, bottom)
    if (right <= left).any() or (lower <= upper).any():
        raise InvalidInput("reference {0}: has no imagery where the queries are", mosaic.mission.imagery.source)
    size = (right - left).astype(np.int64), (lower - upper).astype(np.int64)
    return _with_windows(mosaic, Windows(left.astype(np.int64), upper.astype(np.int64), *size))


def _with_windows(one: Plan, windows: Windows) -> Plan:
    """Plan of map frames that show other windows."""
    return replace(one, windows=windows, frames=MapFrames.from_windows(windows, one.poses, one.grid))


def _extent_px(one: Plan) -> tuple[float, float, float, float]:
    """Left, top, right and bottom of a source's imagery at a plan's zoom.

    Infinite unless the imagery is a rectangle along the axes of the grid, like a raster.
    """
    extent, world = one.grid.extent, one.grid.world_px(one.zoom)
    corners = np.array(extent or (), np.float64).reshape(-1, 2)
    # Equal up to rounding: 1e-12 of the world's width is 40 micrometres.
    u, v = np.unique(np.round(corners, 12), axis=0).T if len(corners) else (corners[:, 0], corners[:, 1])
    if len(np.unique(u)) != 2 or len(np.unique(v)) != 2:
        return -math.inf, -math.inf, math.inf, math.inf
    # Whole pixels inside; an edge within 1e-3 px of a pixel's edge counts as equal, as fractions are rounded.
    low, high = np.ceil(corners.min(axis=0) * world - 1e-3), np.floor(corners.max(axis=0) * world + 1e-3)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _median_side_m(queries: Plan) -> float:
    """Side of a square with the median area of the queries' ground."""
    lat, lon = queries.corners.lat_deg, queries.corners.lon_deg
    ring = np.repeat(np.arange(len(lat)), lat.shape[1])
    areas = WGS84.ring_areas_m2(lon.ravel(), lat.ravel(), ring, len(lat))
    return math.sqrt(float(np.median(areas)))


def _ground(queries: Mapping[str, Plan]) -> Box:
    """Bounding box of the queries' ground; longitudes are continuous."""
    corners = [one.corners for one in queries.values()]
    lat = np.concatenate([one.lat_deg.ravel() for one in corners])
    lon = np.concatenate([one.lon_deg.ravel() for one in corners])
    return Box(float(lat.max()), float(lon.min()), float(lat.min()), float(lon.max()))


def _enlarged(box: Box, margin_m: float) -> Box:
    """Box with a margin, within the map."""
    farthest = np.array(max(abs(box.north_deg), abs(box.south_deg)))
    more_lat = math.degrees(margin_m / float(WGS84.meridional_radius_m(farthest)))
    shrink = max(math.cos(math.radians(float(farthest))), 1e-3)
    more_lon = math.degrees(margin_m / (float(WGS84.normal_radius_m(farthest)) * shrink))
    return Box(
        min(box.north_deg + more_lat, MAX_LAT_DEG),
        box.west_deg - more_lon,
        max(box.south_deg - more_lat, -MAX_LAT_DEG),
        box.east_deg + more_lon,
    )


def _reference(settings: BenchmarkSettings, area: Any, agl_m: float, **more: Any) -> Mission:
    """Mission of map frames of the reference."""
    asked = settings.queries
    values = {
        "frame": "map",
        # The reference is a map and need not resemble a camera's image.
        "accept_error": True,
        "image_format": asked.output.image_format,
        "crs": asked.imagery.crs,
        "bands": asked.imagery.bands,
        "stretch": asked.imagery.stretch,
        "seed": asked.imagery.seed,
    }
    return Mission(area, agl_m, **{**values, **more}).select_imagery(settings.reference)


def _mosaic(settings: BenchmarkSettings, box: Box, gsd_m: float, grid: PixelGrid) -> Plan:
    """Plan of the reference as one image."""
    middle = (box.north_deg + box.south_deg) / 2.0
    # A box is widest at its latitude nearest to the equator.
    widest = 0.0 if box.south_deg <= 0.0 <= box.north_deg else min(abs(box.south_deg), abs(box.north_deg))
    width_m = (
        math.radians(box.span_deg) * float(WGS84.normal_radius_m(np.array(widest))) * math.cos(math.radians(widest))
    )
    height_m = math.radians(box.north_deg - box.south_deg) * float(WGS84.meridional_radius_m(np.array(middle)))
    # One percent more, as a camera above the middle sees the midpoints of the sides outside the box.
    width_m, height_m = width_m * 1.01, height_m * 1.01
    px = math.ceil(max(width_m, height_m) / gsd_m)
    camera = Camera.from_horizontal_fov(_FOV_DEG, width_m / height_m)
    agl_m = width_m / camera.ground_size_m(1.0)[0]
    lon = box.west_deg + box.span_deg / 2.0
    mission = _reference(
        settings, Points(((middle, lon, agl_m),)), agl_m, camera=camera, image_px=px, image_format="tif"
    )
    wrong: InvalidInput | None = None
    if px <= MAX_PICTURE_SIDE_PX:
        try:
            return _clipped(plan(mission, grid))
        except InvalidInput as refused:
            if refused.field != "max_px":
                raise
            wrong = refused
    raise InvalidInput(
        "reference of {0:,.0f} x {1:,.0f} m in pixels of {2:.3g} m: more than {3:,} px along a side or {4:,} px",
        width_m,
        height_m,
        gsd_m,
        MAX_PICTURE_SIDE_PX,
        MAX_PICTURE_PX,
        remedy="choose a smaller area, or coarser pixels of the queries (--gsd)",
    ) from wrong


def _tiles(settings: BenchmarkSettings, mosaic: Plan, width_m: float) -> Plan:
    """Plan of tiles: windows of equal size that cover the mosaic exactly, with at least the requested overlap."""
    grid, zoom = mosaic.grid, mosaic.zoom
    left, top, wide, high = (int(part[0]) for part in mosaic.windows)
    lat, lon = (angle[:1] for angle in mosaic.frame_centres)
    m_per_px = float(grid.ground_m_per_px(lat, lon, zoom)[0])
    side = round(width_m / m_per_px)
    if side < _LEAST_TILE_PX:
        raise InvalidInput(
            "tiles of {0:g} m: the reference has pixels of {1:.3g} m; must be {2:.3g} m wide or wider",
            width_m,
            m_per_px,
            _LEAST_TILE_PX * m_per_px,
        )
    across, down = (_steps(length, min(side, length), settings.tile_overlap) for length in (wide, high))
    row, column = (part.ravel() for part in np.meshgrid(np.arange(len(down)), np.arange(len(across)), indexing="ij"))
    size = tuple(np.full(len(row), min(side, length), np.int64) for length in (wide, high))
    windows = Windows(left + across[column], top + down[row], *size)
    lat, lon = window_centres(windows, grid, zoom)
    camera = Camera.from_horizontal_fov(_FOV_DEG, 1.0)
    agl_m = width_m / camera.ground_size_m(1.0)[0]
    places = tuple((*place, agl_m) for place in zip(lat.tolist(), lon.tolist()))
    found = plan(_reference(settings, Points(places), agl_m, camera=camera, zoom=zoom), grid)
    return replace(_with_windows(found, windows), column=column.astype(np.int64), row=row.astype(np.int64))


def _steps(length_px: int, side_px: int, overlap: float) -> NDArray[np.int64]:
    """First pixels of tiles along a side of the mosaic, evenly spaced from end to end."""
    count = math.ceil((length_px - side_px) / max(side_px * (1.0 - overlap), 1.0)) + 1
    starts: NDArray[np.int64] = np.round(np.linspace(0.0, length_px - side_px, count)).astype(np.int64)
    return starts


def _listed(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:g}" for value in values)
