"""The world as a function of position, and as a source of tiles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import NDArray, PixelValues
from ..bands import Bands
from ..errors import InvalidInput
from ..geodesy.mercator import HALF_WORLD_M, PixelGrid, WebMercator
from ..geodesy.planes import ProjectedPlane
from ..geodesy.sun import SunDirection
from ..geodesy.triangles import NO_FACES, FaceModel
from ..imagery.entry import CatalogueEntry
from ..imagery.opening import SourceOptions
from ..imagery.policy import Policy
from ..imagery.source import Part, Window, tile_parts
from ..map_types import MAP_TYPES, ROADMAP, SATELLITE, TERRAIN
from . import caps, styles
from .heights import ground_m, surface_m
from .houses import WorldHouses
from .lattice import TILE_PX, Array, chart_seed
from .rays import ChartSun
from .samples import Grid, group_points
from .scene import Scene
from .shadows import tile_scene

MAX_ZOOM = 22
#: Pole of each polar chart; see `lattice.chart_seed`.
_POLES = {"EPSG:3413": 1, "EPSG:3031": -1}
#: Painters of each style: of the map, and of polar charts.
_PAINTERS: dict[str, tuple[styles.Painter, styles.Painter]] = {
    SATELLITE: (styles.satellite, caps.satellite),
    ROADMAP: (styles.roadmap, caps.roadmap),
    TERRAIN: (styles.terrain, caps.terrain),
}


def _chart(crs: str) -> str:
    """Return the code of a chart's CRS in upper case; for an empty text, that of the map."""
    code = crs.strip().upper() or WebMercator.crs
    if code != WebMercator.crs and code not in _POLES:
        raise InvalidInput(
            "CRS {0!r}: the synthetic world has {1}",
            crs,
            ", ".join((WebMercator.crs, *_POLES)),
            field="crs",
            remedy="choose EPSG:3413 around the North Pole, EPSG:3031 around the South Pole, or none elsewhere",
        )
    return code


@dataclass(frozen=True)
class World:
    """A seeded landscape over the whole Web-Mercator square, or about a pole.

    Its value at a position and a zoom is the landscape low-passed for that zoom's pixels. It is a pure function of
    seed, style, position and zoom: the same on every machine, in any order and with any number of threads.

    Parameters
    ----------
    seed : int
        Chooses the landscape; 0 or greater, below ``2**64``.
    crs : str
        CRS of the chart: empty or ``EPSG:3857`` for Web Mercator; ``EPSG:3413`` or ``EPSG:3031`` for the polar
        stereographic square about the North or South Pole. The square is as wide as the Mercator map, in metres of its
        CRS, so that pixels of a zoom have the same size. Each of the three is a different landscape.
    sun : SunDirection or None
        Sun that lights the satellite imagery, with shadows of relief, houses and trees; None for the light of maps.
    """

    seed: int = 2024
    crs: str = ""
    sun: SunDirection | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "crs", _chart(self.crs))
        if not 0 <= self.seed < 1 << 64:
            raise InvalidInput("seed {0}: must be from 0 to 2**64 - 1", self.seed)

    def colour(self, style: str, u: Array, v: Array, zoom: Array | float) -> NDArray[np.float32]:
        """Evaluate the world at points.

        Parameters
        ----------
        style : str
            ``"satellite"``, ``"roadmap"`` or ``"terrain"``.
        u, v : float64 arrays
            World fractions east and south of the north-west corner (on the map 180° W, 85.0511° N). `u` wraps around;
            `v` in [0, 1].
        zoom : float or array
            Pixel size as a zoom, 0 to 22: ``2**-zoom / 256`` of the world. Between whole zooms the two neighbours are
            mixed. Broadcast with `u` and `v`.

        Returns
        -------
        float32 array of shape (..., 3)
            Red, green, blue in 0..255.

        Raises
        ------
        InvalidInput
            Unknown style, zoom or `v` out of range or not finite.
        """
        painter = self._painter(style)
        u, v, zoom = np.broadcast_arrays(*(np.asarray(a, dtype=np.float64) for a in (u, v, zoom)))
        if not (np.isfinite(u).all() and ((v >= 0) & (v <= 1)).all()):
            raise InvalidInput("position outside the world: u must be finite and v from 0 to 1")
        if not ((zoom >= 0) & (zoom <= MAX_ZOOM)).all():
            raise InvalidInput("zoom {0:g} to {1:g}: must be from 0 to {2}", zoom.min(), zoom.max(), MAX_ZOOM)
        shape = u.shape
        u, v, zoom = (u - np.floor(u)).ravel(), np.minimum(v, np.nextafter(1.0, 0.0)).ravel(), zoom.ravel()
        below = np.floor(zoom)
        out = self._paint_points(painter, u, v, below.astype(np.int64))
        between = np.flatnonzero(zoom > below)
        if between.size:
            above = self._paint_points(painter, u[between], v[between], below[between].astype(np.int64) + 1)
            share = (zoom - below)[between].astype(np.float32)[:, None]
            out[between] += share * (above - out[between])
        return out.reshape(*shape, 3)

    @property
    def landscape(self) -> int:
        """Number of the chart's landscape, see `lattice.chart_seed`."""
        return chart_seed(self.seed, _POLES.get(self.crs, 0))

    @cached_property
    def _chart_sun(self) -> ChartSun | None:
        return None if self.sun is None else ChartSun.of(self.sun, self.landscape)

    def heights(self, zoom: int, x: int, y: int, *, bare: bool = False) -> NDArray[np.float32]:
        """Return the heights of a tile: metres over the ellipsoid at its pixels' centres, (256, 256), from the north.

        Parameters
        ----------
        bare : bool
            Without trees, which polar charts lack in any case.

        Raises
        ------
        InvalidInput
            A tile that does not exist.
        """
        self._check_tile(zoom, x, y)
        scene = Scene(self.landscape, Grid(int(zoom), int(x), int(y)))
        return ground_m(scene) if bare or self.crs in _POLES else surface_m(scene)

    def _painter(self, style: str) -> styles.Painter:
        if style not in MAP_TYPES:
            raise InvalidInput("map type {0!r}: the synthetic world has {1}", style, ", ".join(MAP_TYPES))
        return _PAINTERS[style][self.crs in _POLES]

    def _paint_points(self, painter: styles.Painter, u: Array, v: Array, zoom: Array) -> NDArray[np.float32]:
        out = np.empty((u.size, 3), dtype=np.float32)
        for at, samples in group_points(u, v, zoom):
            out[at] = painter(Scene(self.landscape, samples, sun=self._chart_sun)).pixels()
        return out

    def tile(self, style: str, zoom: int, x: int, y: int) -> NDArray[np.uint8]:
        """Return a tile: the colour at its pixels' centres, rounded, shape (256, 256, 3), rows from the north.

        Raises
        ------
        InvalidInput
            Unknown style, or a tile that does not exist.
        """
        painter = self._painter(style)
        self._check_tile(zoom, x, y)
        return painter(tile_scene(self.landscape, self._chart_sun, int(zoom), int(x), int(y))).rounded()

    @staticmethod
    def _check_tile(zoom: int, x: int, y: int) -> None:
        if not 0 <= zoom <= MAX_ZOOM:
            raise InvalidInput("zoom {0}: must be from 0 to {1}", zoom, MAX_ZOOM)
        if not (0 <= x < 1 << zoom and 0 <= y < 1 << zoom):
            raise InvalidInput("tile x {0}, y {1} at zoom {2}: both must be from 0 to {3}", x, y, zoom, (1 << zoom) - 1)


class WorldSource:
    """The embedded world as a source of tiles, computed on request."""

    name = "world"
    title = "Synthetic (offline)"
    attribution = "Synthetic landscape, TerrAInav"
    map_types = MAP_TYPES
    grid = PixelGrid(tile_px=TILE_PX, max_zoom=MAX_ZOOM, native_zoom=MAX_ZOOM)
    policy = Policy()
    date = ""

    def __init__(self, seed: int = 2024, crs: str = "", sun: SunDirection | None = None) -> None:
        self.world = World(seed, crs, sun)
        self.grid = chart_grid(crs)
        # After each tile glibc returns its memory to the system, and allocating it again takes a quarter of a tile's
        # time. Freeing one large block raises the threshold for that (mallopt(3), M_TRIM_THRESHOLD).
        np.empty(1 << 24, dtype=np.uint8)

    @property
    def sun(self) -> SunDirection | None:
        """Sun that lights the satellite imagery; None for the light of maps."""
        return self.world.sun

    def parts(self, window: Window) -> list[Part]:
        """Return the tiles that fill a window."""
        return tile_parts(window, self.grid)

    def fetch(self, map_type: str, part: Window) -> PixelValues:
        """Pixels of a tile, (256, 256, 3).

        Raises
        ------
        InvalidInput
            Unknown map type, or a tile that does not exist.
        """
        return self.world.tile(map_type, part.zoom, int(part.left_px) // TILE_PX, int(part.top_px) // TILE_PX)

    def close(self) -> None:
        """Do nothing: there is nothing to close."""


class WorldHeights(WorldSource):
    """The heights of the embedded world as a source, without its houses, which are faces."""

    bands = Bands(("height",), "float32", (0,))

    def __init__(self, seed: int = 2024, crs: str = "") -> None:
        super().__init__(seed, crs)
        # Pixels of 0.3 m show the shapes of trees.
        self.grid = replace(self.grid, max_zoom=19, native_zoom=19)
        self.faces: FaceModel = NO_FACES if self.world.crs in _POLES else WorldHouses(self.world.landscape)

    def fetch(self, map_type: str, part: Window) -> PixelValues:  # noqa: ARG002 (all map types have the same heights)
        """Heights of a tile, (256, 256, 1); raises InvalidInput for a tile that does not exist."""
        column, row = int(part.left_px) // TILE_PX, int(part.top_px) // TILE_PX
        return self.world.heights(part.zoom, column, row)[..., np.newaxis]


def chart_grid(crs: str) -> PixelGrid:
    """Pixel grid of the chart in a CRS; raises InvalidInput for a CRS that `World` lacks."""
    code = _chart(crs)
    if code == WebMercator.crs:
        return WorldSource.grid
    side = 2.0 * HALF_WORLD_M
    plane = ProjectedPlane(code, -HALF_WORLD_M, HALF_WORLD_M, side, side)
    whole = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    return replace(WorldSource.grid, plane=plane, extent=whole)


def open_entry(_entry: CatalogueEntry, _date: str, _key: str | None, options: SourceOptions) -> WorldSource:
    """Open the world of the seed and CRS in the options, in the light of their sun."""
    return WorldSource(options.seed, options.crs, options.sun)
