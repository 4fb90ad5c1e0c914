"""Labels of images: where their centres are, in metres of one frame, scaled for training.

Labels are float64. A network's float32 keeps them to 6e-8 of their size: 0.3 mm where the standard deviation is 5 km.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from ..files import read_limited, write_whole
from ..limits import MAX_SETTINGS_BYTES
from ..safe_json import decoded, parse_json
from .choices import TRAIN
from .frames import Frame, frame_of
from .parts import part_of, taken
from .scaling import Scaler
from .table import Table

Floats = NDArray[np.float64]

#: In a dataset's folder: the frame and the scaler of its labels.
LABELS_FILE = "labels.json"
#: Columns of labels.
NAMES = ("easting_m", "northing_m")
#: What stands in the file while a split is being written: where it is left, parts of map types may disagree.
_UNFINISHED = '{"unfinished": "split"}\n'


@dataclass(frozen=True)
class Labels:
    """What makes labels of positions, and positions of labels.

    Parameters
    ----------
    frame : Frame
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
            raise InvalidInput(f"labels: scaler of {len(self.scaler.mean)} columns; need {', '.join(NAMES)}")

    def of(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
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
        """What is to be said about the frame, one line each."""
        zones = self.frame.zones
        if len(zones) < 2:
            return ()
        named = ", ".join(zones)
        return (
            f"the images lie in {len(zones)} UTM zones ({named}): one frame, {self.frame.crs}, is for all of them",
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
                f"{name}: a split was interrupted, so the parts of its map types may disagree; split again"
            )
        try:
            document: dict[str, Any] = parse_json(text)
            if tuple(document["names"]) != NAMES:
                raise ValueError(f"names {document['names']}, not {list(NAMES)}")
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
            fault = f"has no {wrong}" if isinstance(wrong, KeyError) else str(wrong)
            raise InvalidInput(f"{name}: cannot be read ({fault}); have it made anew by split") from wrong

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write to a file, whole or not at all; raises OutputError."""
        write_whole(path, self.to_json().encode("utf-8"))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Labels:
        """Labels of a file; raises InvalidInput."""
        try:
            text = decoded(read_limited(path, MAX_SETTINGS_BYTES))
        except (OSError, InvalidInput) as wrong:
            raise InvalidInput(f"{path}: cannot be read ({wrong})") from wrong
        return cls.from_json(text, str(path))


def mark_unfinished(path: str | os.PathLike[str]) -> None:
    """Write to a labels' file that a split is under way, which `Labels.load` refuses; raises OutputError."""
    write_whole(path, _UNFINISHED.encode("utf-8"))


def labels_of(
    lat_deg: Floats, lon_deg: Floats, frame: str = "utm", *, training: NDArray[np.bool_] | None = None
) -> Labels:
    """Labels for positions.

    Parameters
    ----------
    lat_deg, lon_deg : array (n,)
        Centres of all images.
    frame : str
        See `frame_of`.
    training : array of bool (n,) or None
        Those that the scaler is fitted on: what is to be found out about the others stays unseen. None for all.

    Raises
    ------
    InvalidInput
        No such frame, positions that it cannot hold, or none to fit the scaler on.
    """
    lat, lon = np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64)
    found = frame_of(lat, lon, frame)
    fitted = np.ones(lat.shape, np.bool_) if training is None else training
    if not fitted.any():
        raise InvalidInput(
            "labels: no image is in the training part, which the scaler is fitted on; split anew"
        )
    return Labels(
        found,
        Scaler.fit(found.forward(lat[fitted], lon[fitted])),
        "all" if training is None else TRAIN,
        int(fitted.sum()),
    )


def labels_of_tables(tables: Iterable[Table], frame: str = "utm") -> Labels:
    """Labels for the images of a dataset's map types together, each place once.

    The scaler is fitted on the places of the training part; where there is none, as without a split, on all that are
    there and not rejected.

    Raises
    ------
    InvalidInput
        As `labels_of`.
    """
    places: dict[str, tuple[float, float, str]] = {}
    for table in tables:
        parts = part_of(table)
        for index in np.flatnonzero(taken(table)).tolist():
            part = "" if parts is None else parts[index]
            place = (float(table.lat_deg[index]), float(table.lon_deg[index]), part)
            places.setdefault(Path(table.img_names[index]).stem, place)
    if not places:
        raise InvalidInput(
            "labels: the dataset has no image that is there and not rejected; capture or clean anew"
        )
    lat, lon = (np.array([place[axis] for place in places.values()], np.float64) for axis in (0, 1))
    training = np.array([place[2] == TRAIN for place in places.values()], np.bool_)
    return labels_of(lat, lon, frame, training=training if training.any() else None)
