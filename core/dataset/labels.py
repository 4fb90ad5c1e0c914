"""Labels of images: where their centres are, in metres of one frame, scaled for training.

Labels are float64. A network's float32 keeps them to 6e-8 of their size: 0.3 mm where the standard deviation is 5 km.
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
from numpy.typing import NDArray

from ..arrays import Floats
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


#: In a dataset's folder: the frame and the scaler of its labels.
LABELS_FILE = "labels.json"
#: Columns of labels.
NAMES = ("easting_m", "northing_m")
#: What stands in the file while a split is being written: where it is left, parts of map types may disagree.
_UNFINISHED = '{"unfinished": "split"}\n'
MERCATOR = "EPSG:3857"
#: Where UTM ends and the Universal Polar Stereographic system begins, degrees (NGA.SIG.0012).
_UTM_NORTH_DEG, _UTM_SOUTH_DEG = 84.0, -80.0
#: WGS 84 / UPS with easting before northing.
_UPS_NORTH, _UPS_SOUTH = "EPSG:5041", "EPSG:5042"
#: Most that a position may be off after the way to a frame and back, metres: projections in their domain keep
#: nanometres, shifts between datums, and an oblique plane beside a pole, some tenths of a millimetre.
_ROUND_TRIP_M = 1e-3
#: Labels that spread less than this, in their unit, are all the same: for metres, a thousandth of a millimetre is noise
#: of the projection, and to enlarge it to a standard deviation of 1 would teach noise.
CONSTANT = 1e-6


@dataclass(frozen=True)
class Labels:
    """Conversion between positions and labels.

    Parameters
    ----------
    scaler : Scaler
        Of eastings and northings in the frame.
    fitted_on : str
        Part of the dataset that the scaler is fitted on: ``train``, or ``all`` where there is no such part.
    images : int
        Number of places that it is fitted on.
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
        """Latitudes and longitudes (n,) in degrees of labels (n, 2), such as those that a network predicts.

        The scaler is exact (see `Scaler`), and what the projection is off there and back is all that labels as `of`
        makes them are: 20 nm in a UTM zone, in Web Mercator, and in the mission's plane up to 80° of latitude; a
        micrometre in UPS, and in the mission's plane up to half a degree from a pole. Elsewhere, tens of degrees from
        a zone, at a pole, and in frames ``EPSG:…`` of another datum, it is less than a millimetre, which is checked for
        the images when the frame is made.
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
        """Text in which every number has all its digits."""
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
        """Labels of the text of `to_json`; raises InvalidInput, in which ``name`` is what the text is called."""
        if text == _UNFINISHED:
            raise InvalidInput(
                "{0}: a split was interrupted, so the parts of its map types may disagree",
                name,
                remedy="split again",
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
            # A frame that PROJ does not know is found out here, and not at the first image.
            frame.forward(np.array([frame.middle_lat_deg]), np.array([frame.middle_lon_deg]))
            scaler = Scaler(tuple(map(float, document["mean"])), tuple(map(float, document["scale"])))
            return cls(frame, scaler, str(document["fitted_on"]), int(document["images"]))
        except (KeyError, TypeError, ValueError, OverflowError, RuntimeError) as wrong:
            # pyproj's errors are RuntimeErrors.
            fault = Message("has no {0}", wrong) if isinstance(wrong, KeyError) else wrong
            raise InvalidInput("{0}: cannot be read ({1})", name, fault, remedy="have it made anew by split") from wrong

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write to a file, whole or not at all; raises OutputError."""
        write_whole(path, self.to_json().encode("utf-8"))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Labels:
        """Labels of a file; raises InvalidInput."""
        try:
            text = decoded(read_limited(path, MAX_SETTINGS_BYTES))
        except (OSError, InvalidInput) as wrong:
            raise InvalidInput("{0}: cannot be read ({1})", path, wrong) from wrong
        return cls.from_json(text, str(path))


def mark_unfinished(path: str | os.PathLike[str]) -> None:
    """Write to a labels' file that a split is under way, which `Labels.load` refuses; raises OutputError."""
    write_whole(path, _UNFINISHED.encode("utf-8"))


def make_labels(
    lat_deg: Floats, lon_deg: Floats, frame: str = "utm", *, training: NDArray[np.bool_] | None = None
) -> Labels:
    """Labels for positions.

    Parameters
    ----------
    lat_deg, lon_deg : array (n,)
        Centres of all images.
    frame : str
        See `choose_frame`.
    training : array of bool (n,) or None
        Those that the scaler is fitted on: what is to be found out about the others stays unseen. None for all.

    Raises
    ------
    InvalidInput
        No such frame, positions that it cannot hold, or none to fit the scaler on.
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
    """Labels for the images of a dataset's map types together, each place once.

    The scaler is fitted on the places of the training part; where there is none, as without a split, on all that are
    there and not rejected.

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
    """A plane in metres, and the place that its longitudes are continuous with.

    Parameters
    ----------
    crs : str
        ``EPSG:…``, or PROJ's text of an oblique stereographic plane.
    middle_lat_deg, middle_lon_deg : float
        Middle of the positions it is for.
    zones : tuple of str
        UTM and UPS zones that these lie in, such as ``16N``, ``UPS north``.
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

        In Web Mercator, positions beyond the antimeridian from the middle go on beyond the map's edge.
        """
        lat, lon = np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64)
        if self.crs == MERCATOR:
            continuous = self.middle_lon_deg + wrap_lon_deg(lon - self.middle_lon_deg)
            # The way to the middle and back would cost the last bits where nothing has to be wrapped.
            u = lon_to_u(np.where(np.abs(continuous - lon) < 180.0, lon, continuous))
            metres: Floats = np.stack([2.0 * u - 1.0, 1.0 - 2.0 * lat_to_v(lat)], axis=-1) * HALF_WORLD_M
            return metres
        return np.stack(transformation(self.crs).forward(lat, lon), axis=-1)

    def inverse(self, metres: Floats) -> tuple[Floats, Floats]:
        """Latitudes and longitudes (n,) in degrees, the latter in [-180, 180), of eastings and northings (n, 2)."""
        metres = np.asarray(metres, np.float64)
        east, north = metres[..., 0], metres[..., 1]
        if self.crs == MERCATOR:
            lat = v_to_lat((1.0 - north / HALF_WORLD_M) / 2.0)
            return lat, wrap_lon_deg(u_to_lon((east / HALF_WORLD_M + 1.0) / 2.0))
        lat, lon = transformation(self.crs).inverse(east, north)
        return lat, wrap_lon_deg(lon)


def choose_frame(lat_deg: Floats, lon_deg: Floats, frame: str = "utm") -> Frame:
    """One frame for all of some positions (n,) in degrees, n > 0.

    Parameters
    ----------
    frame : str
        ``utm``: the UTM zone of their middle, with the exceptions of Norway and Svalbard, and UPS where the middle is
        north of 84° or south of 80° S. ``mercator``: EPSG:3857. ``mission``: an oblique stereographic plane about their
        middle, which has no zones and suits any place but a pole. Or a projected system in metres as ``EPSG:…``.

    Raises
    ------
    InvalidInput
        No such frame, no positions, or some that the frame cannot hold.
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
    """Middle of the smallest box of latitude and longitude that holds positions (n,), in degrees."""
    lon = np.sort(wrap_lon_deg(lon_deg))
    gaps = np.append(np.diff(lon), lon[0] + 360.0 - lon[-1])
    widest = int(np.argmax(gaps))
    west = float(lon[(widest + 1) % len(lon)])
    middle = west + (360.0 - float(gaps[widest])) / 2.0
    return float(lat_deg.min() + lat_deg.max()) / 2.0, float(wrap_lon_deg(np.array(middle)))


def grid_zones(lat_deg: Floats, lon_deg: Floats) -> tuple[str, ...]:
    """UTM and UPS zones that positions (n,) in degrees lie in, sorted."""
    places = set(zip(np.floor(lat_deg).tolist(), np.floor(wrap_lon_deg(lon_deg)).tolist()))
    # All borders of zones are whole degrees: the corner of a one-degree square stands for all of it.
    return tuple(sorted({_zone_name(lat, lon) for lat, lon in places}))


def _zone_name(lat_deg: float, lon_deg: float) -> str:
    if not _UTM_SOUTH_DEG <= lat_deg < _UTM_NORTH_DEG:
        return "UPS north" if lat_deg > 0.0 else "UPS south"
    zone = utm_zone(lat_deg, lon_deg)
    return f"{zone.number:02d}{'S' if zone.south else 'N'}"


def _frame_crs(frame: str, lat_deg: float, lon_deg: float) -> str:
    if frame == "mercator":
        return MERCATOR
    if frame == "mission":
        return f"+proj=sterea +lat_0={lat_deg!r} +lon_0={lon_deg!r} +k=1 +ellps=WGS84 +units=m +type=crs"
    if frame == "utm":
        if lat_deg >= _UTM_NORTH_DEG:
            return _UPS_NORTH
        return _UPS_SOUTH if lat_deg < _UTM_SOUTH_DEG else f"EPSG:{utm_zone(lat_deg, lon_deg).epsg}"
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
            "frame {0}: is {1}, no projected system in metres, which labels need",
            frame,
            crs.name,
            remedy="give the code of one",
        )
    return code


def _check_holds(frame: Frame, asked: str, lat: Floats, lon: Floats) -> None:
    """Raise InvalidInput unless a frame has a place for each position, from which it is found again."""
    metres = frame.forward(lat, lon)
    # What has no place is found by that, and not by a warning.
    with np.errstate(invalid="ignore"):
        back_lat, back_lon = frame.inverse(metres)
    # PROJ's word for what cannot be projected is infinity.
    held = np.isfinite(metres).all(axis=-1) & np.isfinite(back_lat) & np.isfinite(back_lon)
    if held.all():
        middle = frame.forward(np.array([frame.middle_lat_deg]), np.array([frame.middle_lon_deg]))
        away = np.hypot(*(metres - middle).T)
        middle_lon, middle_lat = (
            np.full_like(lon, frame.middle_lon_deg),
            np.full_like(lat, frame.middle_lat_deg),
        )
        ground = geodesics(middle_lat, middle_lon, lat, lon)[2]
        held &= geodesics(lat, lon, back_lat, back_lon)[2] <= _ROUND_TRIP_M
        # NaN where the middle has no place in the frame.
        # Web Mercator enlarges distances from the middle by up to 11.6, where its map ends; a frame cut by a seam
        # enlarges them far more.
        held &= ~(away > 16.0 * ground + _ROUND_TRIP_M)
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
    """Systems are costly to make (some ms)."""
    return read_reference(code)


@dataclass(frozen=True)
class Scaler:
    """Means and standard deviations of labels, by column.

    `inverse` gives back what `transform` was given: to the last bit where a value is at least 8 times as far from 0 as
    from the mean (eastings and northings of a mission, as a rule), as the three roundings in between are then less than
    half of the value's last bit; elsewhere within 2⁻⁵¹ of the distance from the mean, 0.4 nm at 1000 km.

    Parameters
    ----------
    scale : tuple of float
        Standard deviations (of the population, as scikit-learn's ``StandardScaler`` has them), all above 0.
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
        """Scaler of these values (n, k), n > 0.

        Sums are exact before they are rounded (`math.fsum`), so that every machine finds the same numbers. A column
        that is constant (see `CONSTANT`) has scale 1: it becomes 0, and comes back.

        Raises
        ------
        InvalidInput
            No values, or some that are not finite.
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
    if max(column) - min(column) <= CONSTANT:
        return column[0], 1.0
    mean = math.fsum(column) / len(column)
    # Products are rounded alike everywhere; powers are as good as the machine's library of mathematics.
    squares = ((value - mean) * (value - mean) for value in column)
    return mean, math.sqrt(math.fsum(squares) / len(column))
