"""The tiles of a layer of a WMTS: the choice of a tile matrix set, and its pixel grid.

From one level of a grid to the next, pixels halve; corner and tile size stay. In Web Mercator a set must match the
quad, whatever its levels are named. In other projected systems, the levels used begin with the finest (or with the one
chosen as ``tilematrix``), and their scale denominators double; levels between are ignored.
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

#: Standardized pixel size, metres, which defines scales of WMTS and WMS (OGC 07-057r7, 6.1; OGC 06-042, 7.2.4.6.9).
SCALE_PX_M = 0.28e-3


@dataclass(frozen=True)
class LayerTiles:
    """Tiles of a layer.

    Parameters
    ----------
    name : str
        Of the tile matrix set.
    crs : str
    tile_px : int
    levels : mapping of int to str
        Identifiers of the tile matrices by zoom.
    plane : ProjectedPlane or None
        None for the Web-Mercator map.
    limits : tuple
        As `CatalogueEntry.tile_limits`.
    """

    name: str
    crs: str
    tile_px: int
    levels: Mapping[int, str]
    plane: ProjectedPlane | None = None
    limits: tuple[tuple[int, int, int, int, int], ...] = ()

    @property
    def finest(self) -> float:
        """Relative fineness of the highest zoom, to compare sets of one system."""
        highest = max(self.levels)
        return float(highest) if self.plane is None else self.tile_px * 2.0**highest / self.plane.width


def chosen_tiles(document: Document, service: Any, layer: Any, crs: str, area_deg: Bounds | None = None) -> LayerTiles:
    """Choose the tiles of a layer.

    Parameters
    ----------
    document : Document
    service, layer
        Of OWSLib.
    crs : str
        As in `SourceOptions`.

    Raises
    ------
    InvalidInput
        No set is usable, or not the wanted set or system; the error lists the usable ones.
    """
    choices = document.service.choices
    wanted, first = choices.get("tilematrixset"), choices.get("tilematrix")
    sets: dict[str, Any] = {name: service.tilematrixsets[name] for name in layer.tilematrixsetlinks}
    found: dict[str, LayerTiles] = {}
    asked_first = sorted(sets, key=lambda name: (name != wanted, epsg_code(sets[name].crs) != (crs or MAP)))
    for name in asked_first[:50]:
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
    there = list(dict.fromkeys(tiles.crs for tiles in found.values()))
    if crs and crs not in there:
        raise refused(crs, Message("layer {0!r} of {1}", layer.id, document.service.host), sorted(there))
    if wanted is not None:
        chosen = found[chosen_one(document, "tilematrixset", wanted, {name: name for name in found})]
    else:
        boxes = filter(None, (area_deg, read_bounds([layer])))
        system = crs or (MAP if MAP in there else best_system(there, *boxes))
        chosen = max(
            (tiles for tiles in found.values() if tiles.crs == system),
            key=lambda tiles: (tiles.finest, -tiles.tile_px),
        )
    if first is not None:
        matrices = sets[chosen.name].tilematrix
        chosen_one(document, "tilematrix", first, {one.identifier: one.identifier for one in matrices.values()})
    return chosen


def _matrix_tiles(matrix_set: Any, name: str, layer: Any, first: str | None) -> LayerTiles | None:
    """Tiles of a set, from the matrix ``first`` on if it exists; None where they form no grid."""
    limits = layer.tilematrixsetlinks[name].tilematrixlimits
    offered = [one for one in matrix_set.tilematrix.values() if not limits or one.identifier in limits]
    scale = next((one.scaledenominator for one in offered if one.identifier == first), 0.0)
    matrices = [one for one in offered if one.scaledenominator >= scale]
    crs = epsg_code(matrix_set.crs)
    if crs == MAP:
        return _quad(name, matrices, limits)
    if not is_usable(crs):
        return None
    by_axes = not matrix_set.crs.strip().upper().startswith("EPSG:")
    return _own(name, crs, matrices, limits, by_axes, read_bounds([layer]))


def _tile_px(matrices: Sequence[Any]) -> int | None:
    """Width of the tiles of all matrices, px; None where they differ or form no grid."""
    sizes = {size for matrix in matrices for size in (matrix.tilewidth, matrix.tileheight)}
    size = sizes.pop() if len(sizes) == 1 else 0
    return size if size >= 256 and size % 256 == 0 else None


def _quad(name: str, matrices: list[Any], limits: Mapping[str, Any]) -> LayerTiles | None:
    """Tiles of the Web-Mercator quad; None where the matrices belong to another grid."""
    # Documents round scales to eight digits or more, and corners to whole metres at worst; other grids differ by
    # percents, and by kilometres.
    scale_tolerance, corner_tolerance_m = 1e-6, 1.0
    width = _tile_px(matrices)
    if width is None:
        return None
    levels = {}
    for matrix in matrices:
        # In either axis order, as west is negative and north positive.
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
    # Zooms must be contiguous: captures cannot use those below a gap.
    highest = max(levels)
    lowest = next(zoom for zoom in range(highest, -2, -1) if zoom not in levels) + 1
    taken = {zoom: levels[zoom] for zoom in range(lowest, highest + 1)}
    return LayerTiles(
        name,
        MAP,
        width,
        {zoom: matrix.identifier for zoom, matrix in taken.items()},
        limits=tuple((zoom, *_limited(matrix, limits)) for zoom, matrix in taken.items() if limits),
    )


def _own(
    name: str,
    crs: str,
    matrices: list[Any],
    limits: Mapping[str, Any],
    by_axes: bool,
    bounds_deg: tuple[float, float, float, float],
) -> LayerTiles | None:
    """Tiles in the plane of another projected system, from the finest matrix on; None where they form no grid.

    Parameters
    ----------
    by_axes : bool
        Whether the document names the system in a form for which its axis order holds.
    """
    unit = unit_m(crs)
    chain = _halving([matrix for matrix in matrices if _is_sound(matrix)], unit)
    if not chain:
        return None
    tile_px = chain[0].tilewidth
    # Zooms at which all columns and rows lie within the plane.
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
    turned = ProjectedPlane(crs, north, west, side, side)
    ends = finest.matrixwidth / 2.0**highest, finest.matrixheight / 2.0**highest
    # The ground of the layer reveals documents that state corners in the other axis order.
    if not _meets(plane, bounds_deg, *ends) and _meets(turned, bounds_deg, *ends):
        plane = turned
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
    """Return the finest matrix, and those whose pixels are 2, 4, 8 … times as large."""
    # Pixels of the finest matrix by which others may deviate, over its whole extent and at their corners.
    tolerance_px = 0.1
    ordered = sorted(matrices, key=lambda one: one.scaledenominator)
    chain = ordered[:1]
    for matrix in ordered[1:]:
        finest, times = chain[0], 2.0 ** len(chain)
        px = finest.scaledenominator * SCALE_PX_M / unit
        across = max(finest.matrixwidth, finest.matrixheight) * finest.tilewidth
        stretched = abs(matrix.scaledenominator / finest.scaledenominator / times - 1.0) * across
        moved = max(abs(a - b) for a, b in zip(matrix.topleftcorner, finest.topleftcorner)) / px
        if matrix.tilewidth == finest.tilewidth and stretched <= tolerance_px and moved <= tolerance_px:
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
    # Limits without any tile are an error of the document.
    return (left, top, right, bottom) if left <= right and top <= bottom else (0, 0, last_column, last_row)


def _meets(plane: ProjectedPlane, bounds_deg: tuple[float, float, float, float], right: float, bottom: float) -> bool:
    """Whether a matrix that ends at ``right, bottom`` of a plane shows ground within bounds; true for the world."""
    if bounds_deg == WORLD_DEG:
        return True
    box = project_box(plane, bounds_deg)
    return box is not None and box[0] < right and box[2] > 0.0 and box[1] < bottom and box[3] > 0.0
