"""Labels of images: positions of their centres in metres of one frame, scaled for training.

Labels are float64. Converted to float32 for a network, they keep 6e-8 of their size: 0.3 mm for a standard deviation of
5 km.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import InvalidInput, Message
from ..geodesy.mercator import HALF_WORLD_M, lat_to_v, lon_to_u, u_to_lon, v_to_lat, wrap_lon_deg
from ..geodesy.projections import geodesics, transformation, utm_zone
from ..geodesy.reference import read_reference
from ..limits import MAX_SETTINGS_BYTES
from ..storage.files import read_limited, write_whole
from ..text.safe_json import decoded, parse_json
from .folder import FRAMES, TRAIN
from .table import Table, image_parts, usable_rows

if TYPE_CHECKING:
    from pyproj import CRS


#: File in a dataset's folder with the frame and the scaler of its labels.
LABELS_FILE = "labels.json"
#: Columns of labels.
NAMES = ("easting_m", "northing_m")
#: Contents of the file while a split is written; if they remain, the parts of map types may disagree.
_UNFINISHED = '{"unfinished": "split"}\n'
_WEB_MERCATOR = "EPSG:3857"
#: Latitudes at which UTM gives way to Universal Polar Stereographic, degrees (NGA.SIG.0012).
_UTM_NORTH_DEG, _UTM_SOUTH_DEG = 84.0, -80.0


@dataclass(frozen=True)
class Labels:
    """Conversion between positions and labels.

    Parameters
    ----------
    scaler : Scaler
        Scaler of eastings and northings in the frame.
    fitted_on : str
        Part of the dataset that the scaler is fitted on: ``train``, or ``all`` without such a part.
    images : int
        Number of places that the scaler is fitted on.
    """

    frame: Frame
    scaler: Scaler
    fitted_on: str
    images: int

    def __post_init__(self) -> None:
        if len(self.scaler.mean) != len(NAMES):
            raise InvalidInput("labels: scaler of {0} columns; need {1}", len(self.scaler.mean), ", ".join(NAMES))

    def transform(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Labels (n, 2) of positions (n,) in degrees: scaled eastings and northings."""
        return self.scaler.transform(self.frame.forward(lat_deg, lon_deg))

    def positions(self, values: Floats) -> tuple[Floats, Floats]:
        """Latitudes and longitudes (n,) in degrees of labels (n, 2), such as a network predicts.

        The scaler is exact (see `Scaler`), so the only error is that of the round trip through the projection: 20 nm in
        a UTM zone, in Web Mercator, and in the mission's plane up to 80° of latitude; a micrometre in UPS, and in the
        mission's plane up to half a degree from a pole; elsewhere (far from a zone, at a pole, in frames ``EPSG:…`` of
        another datum) less than a millimetre, which `choose_frame` checks for the images.
        """
        return self.frame.inverse(self.scaler.inverse(values))

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes about the frame, one line each."""
        zones = self.frame.zones
        if len(zones) < 2:
            return ()
        named = ", ".join(zones)
        return (
            Message(
                "the images lie in {0} UTM zones ({1}): one frame, {2}, is for all of them",
                len(zones),
                named,
                self.frame.crs,
            ),
        )

    def to_json(self) -> str:
        """JSON text, with all digits of numbers."""
        document = {
            "frame": self.frame.crs,
            "frame_name": self.frame.name,
            "middle_lat_deg": self.frame.middle_lat_deg,
            "middle_lon_deg": self.frame.middle_lon_deg,
            "zones": list(self.frame.zones),
            "names": list(NAMES),
            "mean": list(self.scaler.mean),
            "scale": list(self.scaler.scale),
            "fitted_on": self.fitted_on,
            "images": self.images,
        }
        return json.dumps(document, indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str, name: str = LABELS_FILE) -> Labels:
        """Parse the text of `to_json`; raises InvalidInput, which calls the text ``name``."""
        if text == _UNFINISHED:
            raise InvalidInput(
                "{0}: a split was interrupted, so the parts of its map types may disagree",
                name,
                remedy="split again, or undo the split",
            )
        try:
            document: dict[str, Any] = parse_json(text)
            if tuple(document["names"]) != NAMES:
                raise ValueError(Message("names {0}, not {1}", document["names"], list(NAMES)))
            frame = Frame(
                str(document["frame"]),
                float(document["middle_lat_deg"]),
                float(document["middle_lon_deg"]),
                tuple(map(str, document["zones"])),
            )
            # Fail now, not at the first image, if PROJ does not know the frame.
            frame.forward(np.array([frame.middle_lat_deg]), np.array([frame.middle_lon_deg]))
            scaler = Scaler(tuple(map(float, document["mean"])), tuple(map(float, document["scale"])))
            return cls(frame, scaler, str(document["fitted_on"]), int(document["images"]))
        except (KeyError, TypeError, ValueError, OverflowError, RuntimeError) as wrong:
            # pyproj's errors are RuntimeErrors.
            fault = Message("has no {0}", wrong) if isinstance(wrong, KeyError) else wrong
            raise InvalidInput("{0}: cannot be read ({1})", name, fault, remedy="have it made anew by split") from wrong

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write to a file atomically; raises OutputError."""
        write_whole(path, self.to_json().encode("utf-8"))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Labels:
        """Read labels from a file; raises InvalidInput."""
        try:
            text = decoded(read_limited(path, MAX_SETTINGS_BYTES))
        except (OSError, InvalidInput) as wrong:
            raise InvalidInput("{0}: cannot be read ({1})", path, wrong) from wrong
        return cls.from_json(text, str(path))


def mark_unfinished(path: str | os.PathLike[str]) -> None:
    """Mark a labels file as that of an unfinished split, which `Labels.load` refuses; raises OutputError."""
    write_whole(path, _UNFINISHED.encode("utf-8"))


def is_unfinished(content: bytes | None) -> bool:
    """Whether the content of a labels file is the mark of an unfinished split."""
    return content == _UNFINISHED.encode("utf-8")


def make_labels(
    lat_deg: Floats, lon_deg: Floats, frame: str = "utm", *, training: NDArray[np.bool_] | None = None
) -> Labels:
    """Make labels for positions.

    Parameters
    ----------
    lat_deg, lon_deg : array (n,)
        Centres of all images.
    frame : str
        See `choose_frame`.
    training : array of bool (n,) or None
        Positions that the scaler is fitted on, so that it reveals nothing of the others; None for all.

    Raises
    ------
    InvalidInput
        The frame does not exist or cannot hold the positions, or there are no positions to fit the scaler on.
    """
    lat, lon = np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64)
    found = choose_frame(lat, lon, frame)
    fitted = np.ones(lat.shape, np.bool_) if training is None else training
    if not fitted.any():
        raise InvalidInput(
            "labels: no image is in the training part, which the scaler is fitted on", remedy="split anew"
        )
    return Labels(
        found,
        Scaler.fit(found.forward(lat[fitted], lon[fitted])),
        "all" if training is None else TRAIN,
        int(fitted.sum()),
    )


def make_dataset_labels(tables: Iterable[Table], frame: str = "utm") -> Labels:
    """Make labels for the images of all map types of a dataset, each place once.

    The scaler is fitted on the places of the training part or, without one, on all that have usable images.

    Raises
    ------
    InvalidInput
        As `make_labels`.
    """
    places: dict[str, tuple[float, float, str]] = {}
    for table in tables:
        parts = image_parts(table)
        for index in np.flatnonzero(usable_rows(table)).tolist():
            part = "" if parts is None else parts[index]
            place = (float(table.lat_deg[index]), float(table.lon_deg[index]), part)
            places.setdefault(Path(table.img_names[index]).stem, place)
    if not places:
        raise InvalidInput(
            "labels: the dataset has no image that is there and not rejected", remedy="capture or clean anew"
        )
    lat, lon = (np.array([place[axis] for place in places.values()], np.float64) for axis in (0, 1))
    training = np.array([place[2] == TRAIN for place in places.values()], np.bool_)
    return make_labels(lat, lon, frame, training=training if training.any() else None)


@dataclass(frozen=True)
class Frame:
    """A plane in metres, and the position about which its longitudes are continuous.

    Parameters
    ----------
    crs : str
        ``EPSG:…``, or PROJ's text of an oblique stereographic plane.
    middle_lat_deg, middle_lon_deg : float
        Middle of the positions.
    zones : tuple of str
        UTM and UPS zones of the positions, such as ``16N``, ``UPS north``.
    """

    crs: str
    middle_lat_deg: float
    middle_lon_deg: float
    zones: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Readable name."""
        return "oblique stereographic about the middle" if self.crs.startswith("+") else _crs(self.crs).name

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Eastings and northings (n, 2) in metres of positions (n,) in degrees.

        In Web Mercator, positions across the antimeridian from the middle continue beyond the map's edge.
        """
        lat, lon = np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64)
        if self.crs == _WEB_MERCATOR:
            continuous = self.middle_lon_deg + wrap_lon_deg(lon - self.middle_lon_deg)
            # Leave longitudes that need no wrapping as they are: the detour by the middle costs their last bits.
            u = lon_to_u(np.where(np.abs(continuous - lon) < 180.0, lon, continuous))
            metres: Floats = np.stack([2.0 * u - 1.0, 1.0 - 2.0 * lat_to_v(lat)], axis=-1) * HALF_WORLD_M
            return metres
        return np.stack(transformation(self.crs).forward(lat, lon), axis=-1)

    def inverse(self, metres: Floats) -> tuple[Floats, Floats]:
        """Latitudes, and longitudes in [-180, 180), (n,) in degrees, of eastings and northings (n, 2)."""
        metres = np.asarray(metres, np.float64)
        east, north = metres[..., 0], metres[..., 1]
        if self.crs == _WEB_MERCATOR:
            lat = v_to_lat((1.0 - north / HALF_WORLD_M) / 2.0)
            return lat, wrap_lon_deg(u_to_lon((east / HALF_WORLD_M + 1.0) / 2.0))
        lat, lon = transformation(self.crs).inverse(east, north)
        return lat, wrap_lon_deg(lon)


def choose_frame(lat_deg: Floats, lon_deg: Floats, frame: str = "utm") -> Frame:
    """Choose one frame for positions (n,) in degrees, n > 0.

    Parameters
    ----------
    frame : str
        ``utm``: the UTM zone of their middle, with the exceptions of Norway and Svalbard, or UPS if the middle is north
        of 84° N or south of 80° S. ``mercator``: EPSG:3857. ``mission``: an oblique stereographic plane about their
        middle, which has no zones and suits any place but a pole. Or a projected system in metres as ``EPSG:…``.

    Raises
    ------
    InvalidInput
        The frame does not exist, there are no positions, or the frame cannot hold some positions.
    """
    lat, lon = np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64)
    if not lat.size or not (np.isfinite(lat) & np.isfinite(lon) & (np.abs(lat) <= 90.0)).all():
        raise InvalidInput(
            "frame {0}: of {1} positions; needs one or more, with latitudes from -90 to 90", frame, lat.size
        )
    middle_lat, middle_lon = middle_position(lat, lon)
    found = Frame(_frame_crs(frame, middle_lat, middle_lon), middle_lat, middle_lon, grid_zones(lat, lon))
    _check_holds(found, frame, lat, lon)
    return found


def middle_position(lat_deg: Floats, lon_deg: Floats) -> tuple[float, float]:
    """Middle of the smallest box of latitude and longitude around positions (n,), in degrees."""
    lon = np.sort(wrap_lon_deg(lon_deg))
    gaps = np.append(np.diff(lon), lon[0] + 360.0 - lon[-1])
    widest = int(np.argmax(gaps))
    west = float(lon[(widest + 1) % len(lon)])
    middle = west + (360.0 - float(gaps[widest])) / 2.0
    return float(lat_deg.min() + lat_deg.max()) / 2.0, float(wrap_lon_deg(np.array(middle)))


def grid_zones(lat_deg: Floats, lon_deg: Floats) -> tuple[str, ...]:
    """UTM and UPS zones of positions (n,) in degrees, sorted."""
    places = set(zip(np.floor(lat_deg).tolist(), np.floor(wrap_lon_deg(lon_deg)).tolist()))
    # All zones begin at whole degrees: the corner of a one-degree square decides for all of it.
    return tuple(sorted({_zone_name(lat, lon) for lat, lon in places}))


def _zone_name(lat_deg: float, lon_deg: float) -> str:
    if not _UTM_SOUTH_DEG <= lat_deg < _UTM_NORTH_DEG:
        return "UPS north" if lat_deg > 0.0 else "UPS south"
    zone = utm_zone(lat_deg, lon_deg)
    return f"{zone.number:02d}{'S' if zone.south else 'N'}"


def _frame_crs(frame: str, lat_deg: float, lon_deg: float) -> str:
    if frame == "mercator":
        return _WEB_MERCATOR
    if frame == "mission":
        return f"+proj=sterea +lat_0={lat_deg!r} +lon_0={lon_deg!r} +k=1 +ellps=WGS84 +units=m +type=crs"
    if frame == "utm":
        # UPS with easting before northing.
        if lat_deg >= _UTM_NORTH_DEG:
            return "EPSG:5041"
        return "EPSG:5042" if lat_deg < _UTM_SOUTH_DEG else f"EPSG:{utm_zone(lat_deg, lon_deg).epsg}"
    if re.fullmatch(r"EPSG:\d+", frame, re.IGNORECASE) is None:
        raise InvalidInput("frame {0!r}: must be {1} or a code like EPSG:32616", frame, ", ".join(FRAMES))
    code = frame.upper()
    try:
        crs = _crs(code)
    except InvalidInput as wrong:
        raise InvalidInput(
            "frame {0}: PROJ knows no such system", frame, remedy="give the code of another one"
        ) from wrong
    if not crs.is_projected or any(axis.unit_name != "metre" for axis in crs.axis_info):
        raise InvalidInput(
            "frame {0}: is {1}, not a projected system in metres, which labels need",
            frame,
            crs.name,
            remedy="give the code of one",
        )
    return code


def _check_holds(frame: Frame, asked: str, lat: Floats, lon: Floats) -> None:
    """Raise InvalidInput unless positions survive the round trip through a frame."""
    # Projections are exact to nanometres in their domain; shifts between datums, and an oblique plane beside a pole,
    # to some tenths of a millimetre.
    tolerance_m = 1e-3
    metres = frame.forward(lat, lon)
    with np.errstate(invalid="ignore"):
        back_lat, back_lon = frame.inverse(metres)
    # PROJ returns infinity for positions that it cannot project.
    held = np.isfinite(metres).all(axis=-1) & np.isfinite(back_lat) & np.isfinite(back_lon)
    if held.all():
        middle = frame.forward(np.array([frame.middle_lat_deg]), np.array([frame.middle_lon_deg]))
        away = np.hypot(*(metres - middle).T)
        middle_lon, middle_lat = (
            np.full_like(lon, frame.middle_lon_deg),
            np.full_like(lat, frame.middle_lat_deg),
        )
        ground = geodesics(middle_lat, middle_lon, lat, lon)[2]
        held &= geodesics(lat, lon, back_lat, back_lon)[2] <= tolerance_m
        # Web Mercator enlarges distances from the middle up to 11.6 times, at the map's edge; a frame cut by a seam
        # enlarges them far more. NaN, if the frame cannot hold the middle, passes.
        held &= ~(away > 16.0 * ground + tolerance_m)
    if not held.all():
        worst = int(np.flatnonzero(~held)[0])
        place = f"{lat[worst]:.6f} {lon[worst]:.6f}"
        if asked in ("mission", "utm"):
            other = "utm" if asked == "mission" else "mission"
            raise InvalidInput(
                "frame {0}: {1} cannot hold all positions, such as {2}",
                asked,
                frame.crs,
                place,
                remedy=Message("choose {0}", other),
            )
        raise InvalidInput(
            "frame {0}: {1} cannot hold all positions, such as {2}",
            asked,
            frame.crs,
            place,
            remedy="choose mission or utm",
        )


@lru_cache(maxsize=8)
def _crs(code: str) -> CRS:
    """Read a CRS; cached, as this takes some milliseconds."""
    return read_reference(code)


@dataclass(frozen=True)
class Scaler:
    """Means and standard deviations of labels, by column.

    `inverse` reverts `transform` to the last bit if a value is at least 8 times as far from 0 as from the mean, like
    most eastings and northings: the three roundings in between are then less than half of the value's last bit.
    Otherwise, the error is within 2⁻⁵¹ of the distance from the mean, 0.4 nm at 1000 km.

    Parameters
    ----------
    scale : tuple of float
        Standard deviations of the population, as in scikit-learn's ``StandardScaler``, all above 0.
    """

    mean: tuple[float, ...]
    scale: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.mean) != len(self.scale):
            raise InvalidInput(
                "scaler: has {0} means and {1} scales; need as many of each", len(self.mean), len(self.scale)
            )
        if not all(map(math.isfinite, self.mean)):
            raise InvalidInput("scaler: mean {0}; must be finite numbers", list(self.mean))
        if not all(math.isfinite(one) and one > 0.0 for one in self.scale):
            raise InvalidInput("scaler: scale {0}; must be finite numbers above 0", list(self.scale))

    @classmethod
    def fit(cls, values: Floats) -> Scaler:
        """Fit a scaler to values (n, k), n > 0.

        Sums are exact before they are rounded (`math.fsum`), so every machine finds the same numbers. A column that
        spreads by at most 1e-6 counts as constant: it has scale 1 and becomes 0.

        Raises
        ------
        InvalidInput
            There are no values, or some are not finite.
        """
        if not len(values) or not np.isfinite(values).all():
            raise InvalidInput("scaler: {0} values to fit it to; needs one or more, all finite numbers", len(values))
        fitted = [_fit_column(column) for column in values.T.tolist()]
        return cls(tuple(mean for mean, _ in fitted), tuple(scale for _, scale in fitted))

    def transform(self, values: Floats) -> Floats:
        """Scaled values (..., k) of values (..., k)."""
        scaled: Floats = (np.asarray(values, np.float64) - np.array(self.mean)) / np.array(self.scale)
        return scaled

    def inverse(self, scaled: Floats) -> Floats:
        """Values (..., k) of scaled values (..., k)."""
        values: Floats = np.asarray(scaled, np.float64) * np.array(self.scale) + np.array(self.mean)
        return values


def _fit_column(column: Sequence[float]) -> tuple[float, float]:
    """Mean and standard deviation of a column."""
    # A micrometre is noise of the projection; scaling it to a standard deviation of 1 would teach noise.
    if max(column) - min(column) <= 1e-6:
        return column[0], 1.0
    mean = math.fsum(column) / len(column)
    # Products are rounded alike everywhere; powers depend on the machine's mathematics library.
    squares = ((value - mean) * (value - mean) for value in column)
    return mean, math.sqrt(math.fsum(squares) / len(column))
