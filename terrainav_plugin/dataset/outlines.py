"""The outlines of a dataset's footprints, and a picture of those that would be rejected. On any thread."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS, Transformer
from pyproj.exceptions import ProjError
from qgis.PyQt.QtCore import QLineF, QPointF, QRectF, Qt
from qgis.PyQt.QtGui import QColor, QImage, QPainter, QPen, QPolygonF

from ...core.dataset.folder import FOOTPRINTS_FILE
from ...core.errors import Cancelled, InvalidInput
from ...core.safe_json import parse_json
from ..i18n import tr
from .colours import REJECTED
from .footprints import rings_of, stamp_of

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]
Bounds = tuple[float, float, float, float]

#: Footprints smaller than this on the screen are blots; larger ones are crossed out.
_BLOT_PX = 6.0
_LINE_PX = 2.0
_VEIL_ALPHA = 70
#: Read in one go.
_BLOCK_BYTES = 1 << 20
#: How the lines of footprints begin.
_FEATURE = b'{"type": "Feature",'
#: Footprints after which it is asked whether to go on.
_LOOK = 500


class View(NamedTuple):
    """What the map shows: a rectangle in its CRS, north up, and the size of a pixel.

    Parameters
    ----------
    west, south, east, north : float
        Map units.
    units_per_px : float
    ratio : float
        Pixels of the screen for each of Qt's.
    """

    west: float
    south: float
    east: float
    north: float
    units_per_px: float
    ratio: float


@dataclass(frozen=True, eq=False)
class Outlines:
    """Outlines of the footprints of a dataset, as rings of places one after the other.

    Parameters
    ----------
    stems : tuple of str
        Names of the images, without ending.
    x, y : array (n,)
        Of all rings: degrees of longitude and latitude, or what they have been projected to.
    starts : array (r + 1,)
        Where each ring begins.
    owners : array (r,)
        Number of the image that a ring is of.
    """

    stems: tuple[str, ...]
    x: Floats
    y: Floats
    starts: Numbers
    owners: Numbers

    def projected(self, wkt: str) -> Outlines:
        """Outlines in another CRS, by its WKT; places that have none in it are infinite.

        Raises
        ------
        InvalidInput
            A CRS that cannot be projected to.
        """
        try:
            transformer = Transformer.from_crs("EPSG:4326", CRS.from_wkt(wkt), always_xy=True)
            x, y = transformer.transform(self.x, self.y)
        except ProjError as wrong:
            raise InvalidInput(
                tr("the map's CRS cannot be drawn in ({reason})").format(reason=wrong)
            ) from wrong
        return Outlines(self.stems, np.asarray(x), np.asarray(y), self.starts, self.owners)

    def bounds_of(self, stem: str) -> Bounds | None:
        """West, south, east and north of an image; None where it has no outline here."""
        if stem not in self.stems:
            return None
        rings = np.flatnonzero(self.owners == self.stems.index(stem))
        if not len(rings):
            return None
        places = slice(int(self.starts[rings[0]]), int(self.starts[rings[-1] + 1]))
        x, y = self.x[places], self.y[places]
        if not (np.isfinite(x).all() and np.isfinite(y).all()):
            return None
        return float(x.min()), float(y.min()), float(x.max()), float(y.max())


def read_outlines(folder: Path, cancelled: Callable[[], bool] = lambda: False) -> Outlines:
    """Outlines of the footprints that a capture has left; none where there is no such file.

    Raises
    ------
    InvalidInput
        A file that cannot be read.
    Cancelled
        When ``cancelled`` said so.
    """
    path = folder / FOOTPRINTS_FILE
    stems: list[str] = []
    x: list[float] = []
    y: list[float] = []
    starts, owners = [0], []
    try:
        for feature in _features(path):
            if len(stems) % _LOOK == 0 and cancelled():
                raise Cancelled(tr("footprints: stopped"))
            for ring in chain.from_iterable(rings_of(feature)):
                x += [at[0] for at in ring]
                y += [at[1] for at in ring]
                starts.append(len(x))
                owners.append(len(stems))
            stems.append(str(feature["properties"]["name"]))
    except (OSError, ValueError, KeyError, TypeError, IndexError) as wrong:
        raise InvalidInput(
            tr("footprints {path}: cannot be read ({reason})").format(path=path, reason=wrong)
        ) from wrong
    return Outlines(
        tuple(stems),
        np.array(x, np.float64),
        np.array(y, np.float64),
        np.array(starts, np.int64),
        np.array(owners, np.int64),
    )


def _features(path: Path) -> Iterator[dict[str, Any]]:
    """Features of a file that has one a line; none of a file that is not there, as with images from elsewhere."""
    if not path.is_file():
        return
    # A thread that reads little at a time gives Python's lock away and takes it back before another one wakes: the main
    # one would wait for most of a second.
    with path.open("rb", buffering=_BLOCK_BYTES) as file:
        for line in file:
            if line.startswith(_FEATURE):
                yield parse_json(line.rstrip().rstrip(b","))


class Drawer:
    """Draws what would be rejected; knows the footprints of one dataset until another is asked for. On one thread.

    Parameters
    ----------
    closed : callable
        Whether nobody waits any more; reading a long file ends then.
    """

    def __init__(self, closed: Callable[[], bool]) -> None:
        self._closed = closed
        self._of: tuple[Path, tuple[int, int]] | None = None
        self._outlines: Outlines | None = None
        self._projected: tuple[str, Outlines] | None = None

    def draw(
        self,
        folder: Path,
        wkt: str,
        stems: Callable[[], Collection[str]],
        view: View,
        cancelled: Callable[[], bool],
    ) -> Drawn | None:
        """Draw a view of a dataset; None where it is wanted no more. Raises InvalidInput."""
        try:
            return self._drawn(folder, wkt, stems, view, cancelled)
        except Cancelled:
            return None

    def bounds_of(self, folder: Path, wkt: str, stem: str) -> Bounds | None:
        """West, south, east and north of an image in a CRS; None where it has no outline there. Raises InvalidInput."""
        try:
            return self._outlines_in(folder, wkt).bounds_of(stem)
        except Cancelled:
            return None

    def _drawn(
        self,
        folder: Path,
        wkt: str,
        stems: Callable[[], Collection[str]],
        view: View,
        cancelled: Callable[[], bool],
    ) -> Drawn:
        outlines, chosen = self._outlines_in(folder, wkt), stems()
        return Drawn(draw(outlines, chosen, view, cancelled), len(chosen))

    def _outlines_in(self, folder: Path, wkt: str) -> Outlines:
        """Outlines of a dataset in a CRS."""
        of = folder, stamp_of(folder / FOOTPRINTS_FILE)
        if self._outlines is None or of != self._of:
            self._outlines, self._projected = read_outlines(folder, self._closed), None
            self._of = of
        if self._projected is None or self._projected[0] != wkt:
            self._projected = wkt, self._outlines.projected(wkt)
        return self._projected[1]


class Drawn(NamedTuple):
    """A picture, and how many outlines it was to show."""

    image: QImage
    count: int


def draw(
    outlines: Outlines, stems: Collection[str], view: View, cancelled: Callable[[], bool] = lambda: False
) -> QImage:
    """Picture of a view with some of the outlines crossed out, clear elsewhere.

    Parameters
    ----------
    outlines : Outlines
        In the map's CRS.
    stems : collection of str
        Names of the images.

    Raises
    ------
    Cancelled
        When ``cancelled`` said so.
    """
    wide = max(round((view.east - view.west) / view.units_per_px * view.ratio), 1)
    high = max(round((view.north - view.south) / view.units_per_px * view.ratio), 1)
    image = QImage(wide, high, QImage.Format.Format_ARGB32_Premultiplied)
    image.fill(Qt.GlobalColor.transparent)
    if not len(outlines.owners):
        return image
    scale = view.ratio / view.units_per_px
    x, y = (outlines.x - view.west) * scale, (view.north - outlines.y) * scale
    first = outlines.starts[:-1]
    left, top = np.minimum.reduceat(x, first), np.minimum.reduceat(y, first)
    right, bottom = np.maximum.reduceat(x, first), np.maximum.reduceat(y, first)
    wanted = set(stems)
    chosen = np.array([stem in wanted for stem in outlines.stems], np.bool_)[outlines.owners]
    # Whatever is infinite compares as outside.
    seen = chosen & (left < wide) & (right > 0.0) & (top < high) & (bottom > 0.0) & np.isfinite(left + top)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    veil = QColor(REJECTED)
    veil.setAlpha(_VEIL_ALPHA)
    try:
        for done, ring in enumerate(np.flatnonzero(seen).tolist()):
            if done % _LOOK == 0 and cancelled():
                raise Cancelled(tr("footprints: stopped"))
            box = QRectF(left[ring], top[ring], right[ring] - left[ring], bottom[ring] - top[ring])
            if max(box.width(), box.height()) < _BLOT_PX * view.ratio:
                painter.fillRect(box, REJECTED)
                continue
            places = range(int(outlines.starts[ring]), int(outlines.starts[ring + 1]))
            painter.setPen(QPen(REJECTED, _LINE_PX * view.ratio))
            painter.setBrush(veil)
            painter.drawPolygon(QPolygonF([QPointF(x[at], y[at]) for at in places]))
            painter.drawLines(_cross(x, y, places))
    finally:
        painter.end()
    return image


def _cross(x: Floats, y: Floats, places: range) -> list[QLineF]:
    """Lines between opposite corners of a ring, which ends where it begins."""
    half, count = (len(places) - 1) // 2, len(places) - 1
    corners = (0, count // 4, half, half + count // 4)
    a, b, c, d = (QPointF(x[places[at]], y[places[at]]) for at in corners)
    return [QLineF(a, c), QLineF(b, d)]
