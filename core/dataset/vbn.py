"""Read the paper's Night Vision supplement: simulated camera images, each with a metadata text."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..errors import InvalidInput
from ..limits import MAX_SETTINGS_BYTES
from ..numbers import real_number
from ..storage.files import read_limited
from ..text.safe_json import decoded
from .folder import SUPPLEMENT_FOLDER
from .table import HEADERS, Table, first_faults

_TEXT_FOLDER = "MetaData2"
#: Key of the camera's position in a text: latitude and longitude in degrees, altitude in metres, between two words.
_POSITION = "Platform_position_LatLongAlt"
_IMAGE_ENDING = ".jpg"


class CameraPosition(NamedTuple):
    """Position of a camera."""

    lat_deg: float
    lon_deg: float
    altitude_m: float


def read_vbn(folder: Path) -> tuple[Table, Path]:
    """Read the table of a supplement's images, and return the folder of the images.

    Images and texts are matched by their names without ending or, if no names match, by their order (2 before 10). A
    text without an image gives a failed row. In order, one text may be left over, as in the supplement.

    The table has TerrAInav's columns, with positions both as ``Lat``, ``Lon`` and as the camera's pose; the column
    ``altitude_m`` (datum unknown); and a column for each other key of the texts. As there is no grid and no map,
    ``columns`` counts the images, and rows and zoom are 0.

    Raises
    ------
    InvalidInput
        The folder does not exist, images have no text, or texts cannot be read.
    """
    images = _files(folder, SUPPLEMENT_FOLDER, _IMAGE_ENDING)
    texts = _files(folder, _TEXT_FOLDER, ".txt")
    if not images:
        raise InvalidInput("folder {0}: has no {1} images", folder / SUPPLEMENT_FOLDER, _IMAGE_ENDING)
    pairs = _paired(folder, images, texts)
    faults: list[str] = []
    found = [_metadata(folder / _TEXT_FOLDER / text, faults) for _, text in pairs]
    if faults:
        raise InvalidInput("folder {0}: {1}", folder / _TEXT_FOLDER, first_faults(faults))
    rows = [one for one in found if one is not None]
    return _table([image for image, _ in pairs], set(images), rows), folder / SUPPLEMENT_FOLDER


def parse_position(value: str) -> CameraPosition:
    """Parse the position after the colon of a line of metadata.

    The numbers are the pieces between spaces, without the first and the last piece, which may be empty.

    Raises
    ------
    InvalidInput
    """
    for pieces in (_without_words(value), value.split(" ")[1:-1]):
        numbers = [_number(piece) for piece in pieces]
        if len(numbers) == 3 and all(map(math.isfinite, numbers)):
            position = CameraPosition(*numbers)
            if abs(position.lat_deg) > 90.0 or abs(position.lon_deg) > 360.0:
                raise InvalidInput("{0} {1!r} is not on the Earth", _POSITION, value.strip())
            return position
    raise InvalidInput("{0} {1!r} is not a word and latitude, longitude, altitude", _POSITION, value.strip())


def _without_words(value: str) -> list[str]:
    """Pieces of a value, without the first and the last if they are not numbers."""
    pieces = value.split()
    if pieces and math.isnan(_number(pieces[0])):
        pieces = pieces[1:]
    if pieces and math.isnan(_number(pieces[-1])):
        pieces = pieces[:-1]
    return pieces


def _number(text: str) -> float:
    try:
        return real_number(text)
    except ValueError:
        return math.nan


def _files(folder: Path, name: str, ending: str) -> list[str]:
    """Names of the files in a folder of the supplement, in natural order."""
    try:
        found = [one.name for one in (folder / name).iterdir() if one.suffix.lower() == ending and one.is_file()]
    except OSError as wrong:
        raise InvalidInput(
            "folder {0}: is not a VBN dataset, as {1} in it cannot be read ({2})", folder, name, wrong.strerror
        ) from wrong
    return sorted(found, key=_natural)


def _natural(name: str) -> list[tuple[int, str]]:
    """Key that sorts names by the numbers in them, 2 before 10."""
    return [(int(piece), "") if piece.isdigit() else (-1, piece) for piece in re.findall(r"[0-9]+|[^0-9]+", name)]


def _paired(folder: Path, images: Sequence[str], texts: Sequence[str]) -> list[tuple[str, str]]:
    """Image and text of each row; a text without an image is paired with the name that the image would have."""
    by_stem = {Path(image).stem: image for image in images}
    stems = {Path(text).stem for text in texts}
    if len(by_stem) < len(images) or len(stems) < len(texts):
        counts = Counter((Path(one).suffix.lower(), Path(one).stem) for one in (*images, *texts))
        twice = [stem + ending for (ending, stem), count in counts.items() if count > 1]
        raise InvalidInput(
            "folder {0}: {1} more than once",
            folder,
            first_faults(twice, ", "),
            remedy="remove or rename all but one",
        )
    if not stems & by_stem.keys():
        if len(texts) - len(images) not in (0, 1):
            raise InvalidInput(
                "folder {0}: has {1:,} images in {2} and {3:,} texts in {4}, with no name in common; needs "
                "one text for each image",
                folder,
                len(images),
                SUPPLEMENT_FOLDER,
                len(texts),
                _TEXT_FOLDER,
            )
        spare = [Path(text).stem + _IMAGE_ENDING for text in texts[len(images) :]]
        return list(zip([*images, *spare], texts))
    without = [image for stem, image in by_stem.items() if stem not in stems]
    if without:
        raise InvalidInput(
            "folder {0}: {1} of {2} without a text in {3}",
            folder,
            first_faults(without, ", "),
            SUPPLEMENT_FOLDER,
            _TEXT_FOLDER,
            remedy="put it there, or remove the image",
        )
    return [(by_stem.get(Path(text).stem, Path(text).stem + _IMAGE_ENDING), text) for text in texts]


def _metadata(path: Path, faults: list[str]) -> tuple[CameraPosition, dict[str, str]] | None:
    """Read position and all other keys of a text; faults are appended to ``faults``."""
    try:
        lines = decoded(read_limited(path, MAX_SETTINGS_BYTES)).splitlines()
    except (OSError, InvalidInput) as wrong:
        faults.append(f"{path.name} cannot be read ({wrong})")
        return None
    pairs = [line.partition(":") for line in lines if line.strip()]
    bad = [key for key, colon, _ in pairs if not colon]
    if bad:
        faults.append(f"{path.name} has {bad[0].strip()!r}, not key: value")
        return None
    values = {key.strip(): value for key, _, value in pairs}
    if len(values) < len(pairs):
        faults.append(f"{path.name} has a key more than once")
        return None
    if _POSITION not in values:
        faults.append(f"{path.name} has no {_POSITION}")
        return None
    try:
        position = parse_position(values.pop(_POSITION))
    except InvalidInput as wrong:
        faults.append(f"{path.name}: {wrong}")
        return None
    return position, {key: value.strip() for key, value in values.items()}


def _table(names: Sequence[str], images: set[str], rows: Sequence[tuple[CameraPosition, Mapping[str, str]]]) -> Table:
    count = len(names)
    lat, lon, altitude = np.array([position for position, _ in rows], np.float64).reshape(count, 3).T
    made = [name in images for name in names]
    other = {"altitude_m": tuple(map(repr, altitude.tolist()))}
    for key in dict.fromkeys(key for _, values in rows for key in values):
        header = key
        # Rename keys that are headers of the table (also in an older spelling), or that clean and split write.
        while not header or header in {*HEADERS.values(), "row", "rejected", "split"} or header in other:
            header = f"VBN {header}"
        other[header] = tuple(values.get(key, "") for _, values in rows)
    return Table.from_columns(
        {
            "img_names": tuple(names),
            "columns": np.arange(count, dtype=np.int64),
            "rows": np.zeros(count, np.int64),
            "zoom": np.zeros(count, np.int64),
            "lat_deg": lat,
            "lon_deg": lon,
            "pose_lat_deg": lat,
            "pose_lon_deg": lon,
            "status": tuple("done" if one else "failed" for one in made),
            "reason": tuple("" if one else f"no image in {SUPPLEMENT_FOLDER}" for one in made),
        },
        other,
    )
