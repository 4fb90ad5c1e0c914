"""Tiles of a layer of a WMTS: choice of a tile matrix set, and its pixel grid.

Pixels halve from one level of a grid to the next; corner and tile size stay the same. In Web Mercator, a set must match
the quad, with any names of levels. In other projected systems, the finest level (or the level chosen as ``tilematrix``)
is used, and all levels whose scale denominators are 2, 4, 8 … times as large; other levels are ignored.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ...errors import InvalidInput, Message
from ...geodesy.mercator import HALF_WORLD_M, HIGHEST_ZOOM
from ...geodesy.planes import ProjectedPlane
from ...limits import MAX_TILE_PX
from ...text.plain import one_line
from ..systems import (
    MAP,
    WORLD_DEG,
    Bounds,
    best_system,
    epsg_code,
    is_usable,
    northing_first,
    project_box,
    refused,
    unit_m,
)
from .capabilities import NAMED, Document, chosen_one, read_bounds

#: Standardized pixel size in metres, which defines scales of WMTS and WMS (OGC 07-057r7, 6.1; OGC 06-042, 7.2.4.6.9).
SCALE_PX_M = 0.28e-3


@dataclass(frozen=True)
class LayerTiles:
    """Tiles of a layer.

    Parameters
    ----------
    name : str
        Name of the tile matrix set.
    crs : str
    tile_px : int
    levels : mapping of int to str
        Maps each zoom to the identifier of its tile matrix.
    plane : ProjectedPlane or None
        Plane of the tiles; None for the Web-Mercator map.
    limits : tuple
        See `CatalogueEntry.tile_limits`.
    """

    name: str
    crs: str
    tile_px: int
    levels: Mapping[int, str]
    plane: ProjectedPlane | None = None
    limits: tuple[tuple[int, int, int, int, int], ...] = ()

    @property
    def finest(self) -> float:
        """Relative fineness of the highest zoom, comparable between sets of the same system."""
        highest = max(self.levels)
        return float(highest) if self.plane is None else self.tile_px * 2.0**highest / self.plane.width


def chosen_tiles(document: Document, service: Any, layer: Any, crs: str, area_deg: Bounds | None = None) -> LayerTiles:
    """Choose the tiles of a layer.

    Parameters
    ----------
    document : Document
    service, layer
        Service and layer of OWSLib.
    crs : str
        See `SourceOptions`.

    Raises
    ------
    InvalidInput
        No set is usable, or the wanted set or system is not; the error lists the usable ones.
    """
    choices = document.service.choices
    wanted, first = choices.get("tilematrixset"), choices.get("tilematrix")
    sets: dict[str, Any] = {name: service.tilematrixsets[name] for name in layer.tilematrixsetlinks}
    found: dict[str, LayerTiles] = {}
    by_priority = sorted(sets, key=lambda name: (name != wanted, epsg_code(sets[name].crs) != (crs or MAP)))
    for name in by_priority[:50]:
        tiles = _matrix_tiles(sets[name], name, layer, first)
        if tiles is not None:
            found[name] = tiles
    if not found:
        raise InvalidInput(
            "layer {0!r} of {1}: has tiles in {2} only; needs a Web-Mercator quad, such as WebMercatorQuad "
            "or GoogleMapsCompatible, or a projected system of EPSG, with square tiles of 256 px or a multiple",
            layer.id,
            document.service.host,
            one_line(", ".join(f"{name} ({one.crs})" for name, one in list(sets.items())[:NAMED])),
        )
    systems = list(dict.fromkeys(tiles.crs for tiles in found.values()))
    if crs and crs not in systems:
        raise refused(crs, Message("layer {0!r} of {1}", layer.id, document.service.host), sorted(systems))
    if wanted is not None:
        chosen = found[chosen_one(document, "tilematrixset", wanted, {name: name for name in found})]
    else:
        boxes = filter(None, (area_deg, read_bounds([layer])))
        system = crs or (MAP if MAP in systems else best_system(systems, *boxes))
        chosen = max(
            (tiles for tiles in found.values() if tiles.crs == system),
            key=lambda tiles: (tiles.finest, -tiles.tile_px),
        )
    if first is not None:
        matrices = sets[chosen.name].tilematrix
        chosen_one(document, "tilematrix", first, {one.identifier: one.identifier for one in matrices.values()})
    return chosen


def _matrix_tiles(matrix_set: Any, name: str, layer: Any, first: str | None) -> LayerTiles | None:
    """Tiles of a set, without matrices finer than ``first`` (if it exists); None if they form no grid."""
    limits = layer.tilematrixsetlinks[name].tilematrixlimits
    offered = [one for one in matrix_set.tilematrix.values() if not limits or one.identifier in limits]
    scale = next((one.scaledenominator for one in offered if one.identifier == first), 0.0)
    matrices = [one for one in offered if one.scaledenominator >= scale]
    crs = epsg_code(matrix_set.crs)
    if crs == MAP:
        return _quad_tiles(name, matrices, limits)
    if not is_usable(crs):
        return None
    by_axes = not matrix_set.crs.strip().upper().startswith("EPSG:")
    return _plane_tiles(name, crs, matrices, limits, by_axes, read_bounds([layer]))


def _tile_px(matrices: Sequence[Any]) -> int | None:
    """Width of the tiles of all matrices, px; None if sizes differ or are not multiples of 256."""
    sizes = {size for matrix in matrices for size in (matrix.tilewidth, matrix.tileheight)}
    size = sizes.pop() if len(sizes) == 1 else 0
    return size if size >= 256 and size % 256 == 0 else None


def _quad_tiles(name: str, matrices: list[Any], limits: Mapping[str, Any]) -> LayerTiles | None:
    """Tiles of the Web-Mercator quad; None if the matrices belong to another grid."""
    # Documents round scales to eight digits or more, and corners at worst to whole metres; scales of other grids differ
    # by percents, and corners by kilometres.
    scale_tolerance, corner_tolerance_m = 1e-6, 1.0
    width = _tile_px(matrices)
    if width is None:
        return None
    levels = {}
    for matrix in matrices:
        # Sorting accepts either axis order, as west is negative and north positive.
        x_m, y_m = sorted(matrix.topleftcorner)
        zoom = math.log2(2.0 * HALF_WORLD_M / (matrix.scaledenominator * SCALE_PX_M * width))
        if (
            abs(x_m + HALF_WORLD_M) <= corner_tolerance_m
            and abs(y_m - HALF_WORLD_M) <= corner_tolerance_m
            and abs(2.0 ** (zoom - round(zoom)) - 1.0) <= scale_tolerance
            and 0 <= round(zoom) <= HIGHEST_ZOOM
        ):
            levels[round(zoom)] = matrix
    if not levels:
        return None
    # Zooms must be contiguous: captures cannot use zooms below a gap.
    highest = max(levels)
    lowest = next(zoom for zoom in range(highest, -2, -1) if zoom not in levels) + 1
    contiguous = {zoom: levels[zoom] for zoom in range(lowest, highest + 1)}
    return LayerTiles(
        name,
        MAP,
        width,
        {zoom: matrix.identifier for zoom, matrix in contiguous.items()},
        limits=tuple((zoom, *_limited(matrix, limits)) for zoom, matrix in contiguous.items() if limits),
    )


def _plane_tiles(
    name: str,
    crs: str,
    matrices: list[Any],
    limits: Mapping[str, Any],
    by_axes: bool,
    bounds_deg: tuple[float, float, float, float],
) -> LayerTiles | None:
    """Tiles in the plane of another projected system, from the finest matrix on; None if they form no grid.

    Parameters
    ----------
    by_axes : bool
        Whether the document names the system in a form that implies the axis order of EPSG.
    """
    unit = unit_m(crs)
    chain = _halving([matrix for matrix in matrices if _is_sound(matrix)], unit)
    if not chain:
        return None
    tile_px = chain[0].tilewidth
    # Find the highest zoom such that the columns and rows of every matrix lie within the plane.
    most = (max(one.matrixwidth, one.matrixheight) for one in chain)
    highest = max((count - 1).bit_length() + at for at, count in enumerate(most))
    if highest > HIGHEST_ZOOM:
        return None
    finest = chain[0]
    side = finest.scaledenominator * SCALE_PX_M / unit * tile_px * 2.0**highest
    west, north = finest.topleftcorner
    if by_axes and northing_first(crs):
        west, north = north, west
    plane = ProjectedPlane(crs, west, north, side, side)
    swapped = ProjectedPlane(crs, north, west, side, side)
    ends = finest.matrixwidth / 2.0**highest, finest.matrixheight / 2.0**highest
    # Some documents state corners in the other axis order, which the bounds of the layer reveal.
    if not _meets(plane, bounds_deg, *ends) and _meets(swapped, bounds_deg, *ends):
        plane = swapped
    zooms = [highest - at for at in range(len(chain))]
    return LayerTiles(
        name,
        crs,
        tile_px,
        {zoom: one.identifier for zoom, one in zip(zooms, chain)},
        plane,
        tuple(sorted((zoom, *_limited(one, limits)) for zoom, one in zip(zooms, chain))),
    )


def _is_sound(matrix: Any) -> bool:
    """Whether a matrix has usable tiles."""
    largest = 1e12
    return (
        0.0 < matrix.scaledenominator < largest
        and all(abs(edge) < largest for edge in matrix.topleftcorner)
        and 0 < matrix.matrixwidth <= 1 << HIGHEST_ZOOM
        and 0 < matrix.matrixheight <= 1 << HIGHEST_ZOOM
        and matrix.tilewidth <= MAX_TILE_PX
        and _tile_px([matrix]) is not None
    )


def _halving(matrices: list[Any], unit: float) -> list[Any]:
    """Return the finest matrix, and the matrices whose pixels are 2, 4, 8 … times as large."""
    # Tolerance in pixels of the finest matrix, for the deviation of other matrices over the extent and at the corner.
    tolerance_px = 0.1
    ordered = sorted(matrices, key=lambda one: one.scaledenominator)
    chain = ordered[:1]
    for matrix in ordered[1:]:
        finest, times = chain[0], 2.0 ** len(chain)
        px = finest.scaledenominator * SCALE_PX_M / unit
        across = max(finest.matrixwidth, finest.matrixheight) * finest.tilewidth
        scale_error_px = abs(matrix.scaledenominator / finest.scaledenominator / times - 1.0) * across
        shift_px = max(abs(a - b) for a, b in zip(matrix.topleftcorner, finest.topleftcorner)) / px
        if matrix.tilewidth == finest.tilewidth and scale_error_px <= tolerance_px and shift_px <= tolerance_px:
            chain.append(matrix)
    return chain


def _limited(matrix: Any, limits: Mapping[str, Any]) -> tuple[int, int, int, int]:
    """First column and row, last column and row of the available tiles of a matrix."""
    last_column, last_row = matrix.matrixwidth - 1, matrix.matrixheight - 1
    limit = limits.get(matrix.identifier)
    stated = limit and (limit.mintilecol, limit.mintilerow, limit.maxtilecol, limit.maxtilerow)
    if not stated or None in stated:
        return 0, 0, last_column, last_row
    left, top, right, bottom = max(stated[0], 0), max(stated[1], 0), stated[2], stated[3]
    right, bottom = min(right, last_column), min(bottom, last_row)
    # Ignore limits without any tile, which are an error of the document.
    return (left, top, right, bottom) if left <= right and top <= bottom else (0, 0, last_column, last_row)


def _meets(plane: ProjectedPlane, bounds_deg: tuple[float, float, float, float], right: float, bottom: float) -> bool:
    """Whether a matrix that ends at ``right, bottom`` of a plane overlaps bounds; True for the bounds of the world."""
    if bounds_deg == WORLD_DEG:
        return True
    box = project_box(plane, bounds_deg)
    return box is not None and box[0] < right and box[2] > 0.0 and box[1] < bottom and box[3] > 0.0
