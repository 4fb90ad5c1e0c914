"""A contact sheet of cross-view pairs: some places, each with its satellite view and some drone views."""

from __future__ import annotations

import csv
import io
import os
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from ..dataset.dataset import open_image
from ..errors import InvalidInput
from ..limits import MAX_MISSION_BYTES
from ..storage.files import read_limited, write_whole
from ..text.safe_json import decoded
from .capturing import TABLE_FILE
from .planning import DRONE, SATELLITE

#: Most places shown.
PLACES = 3
#: Most drone views of a place shown.
VIEWS = 6
#: Side of a cell.
_CELL_PX = 200
#: Height of the caption below a cell.
_CAPTION_PX = 16
#: Gap between cells.
_GAP_PX = 6
_PAPER, _INK = (255, 255, 255), (32, 32, 32)

Row = dict[str, str]


def contact_sheet(folder: str | os.PathLike[str], target: str | os.PathLike[str]) -> Path:
    """Draw a contact sheet of a dataset of `capture_pairs` as a JPEG, with a ring around each place.

    It shows up to `PLACES` places, of each part in turn, and `VIEWS` drone views of each, evenly along the flight.

    Parameters
    ----------
    target : path
        File of the sheet, ``.jpg``.

    Returns
    -------
    Path
        ``target``.

    Raises
    ------
    InvalidInput
        The folder is not such a dataset, has no images, or an image cannot be read.
    OutputError
        The target cannot be written.
    """
    path, file = Path(folder), Path(target)
    check_sheet(file)
    rows = _read_places(path)
    chosen = [_select_evenly(one) for one in _alternate_parts(rows)[:PLACES]]
    step = _CELL_PX + _GAP_PX
    height = _CELL_PX + _CAPTION_PX + _GAP_PX
    columns = max(map(len, chosen))
    sheet = Image.new("RGB", (columns * step + _GAP_PX, len(chosen) * height + _GAP_PX), _PAPER)
    draw = ImageDraw.Draw(sheet)
    for line, shown in enumerate(chosen):
        for column, row in enumerate(shown):
            left, top = _GAP_PX + column * step, _GAP_PX + line * height
            sheet.paste(_cell(path / row["file"]), (left, top))
            draw.text((left, top + _CELL_PX + 2), _caption(row), fill=_INK)
    buffer = io.BytesIO()
    # Captions stay legible in a small file.
    sheet.save(buffer, "JPEG", quality=85)
    write_whole(file, buffer.getvalue())
    return file


def check_sheet(target: str | os.PathLike[str]) -> None:
    """Raise InvalidInput unless the name is that of a JPEG."""
    if Path(target).suffix.lower() not in (".jpg", ".jpeg"):
        raise InvalidInput("sheet {0!r}: must end in .jpg", os.fspath(target))


def _read_places(folder: Path) -> list[list[Row]]:
    """Rows of the existing images of each place, the satellite's first."""
    try:
        text = decoded(read_limited(folder / TABLE_FILE, MAX_MISSION_BYTES))
    except (OSError, InvalidInput) as wrong:
        raise InvalidInput(
            "folder {0}: holds no {1} that can be read", folder, TABLE_FILE, remedy="capture pairs first"
        ) from wrong
    places: dict[str, list[Row]] = {}
    for row in csv.DictReader(io.StringIO(text)):
        if row.get("file") and row.get("view") in (SATELLITE, DRONE):
            places.setdefault(row["id"], []).append(row)
    if not places:
        raise InvalidInput("folder {0}: its {1} names no image", folder, TABLE_FILE)
    return list(places.values())


def _alternate_parts(places: list[list[Row]]) -> list[list[Row]]:
    """Places of all parts in turn, so that the first few show every part."""
    met: dict[str, int] = {}
    order = []
    for rows in places:
        part = rows[0]["part"]
        met[part] = met.get(part, -1) + 1
        order.append(met[part])
    return [places[at] for at in sorted(range(len(places)), key=order.__getitem__)]


def _select_evenly(rows: list[Row]) -> list[Row]:
    """Select the satellite's row and up to `VIEWS` of the drone's rows, evenly from first to last."""
    satellite, drone = rows[:1], rows[1:]
    count = min(VIEWS, len(drone))
    return satellite + [drone[at * (len(drone) - 1) // max(count - 1, 1)] for at in range(count)]


def _cell(file: Path) -> Image.Image:
    cell = open_image(file).convert("RGB")
    cell.thumbnail((_CELL_PX, _CELL_PX), Image.LANCZOS)
    # The place is at the centre of every view.
    middle = np.array(cell.size) / 2.0
    draw = ImageDraw.Draw(cell)
    for radius, colour in ((7, _INK), (6, _PAPER)):
        draw.ellipse([*(middle - radius), *(middle + radius)], outline=colour)
    return cell


def _caption(row: Row) -> str:
    if row["view"] == SATELLITE:
        return f"{row['id']} {row['part']}, satellite"
    return f"{float(row['agl_m']):.0f} m, yaw {float(row['yaw_deg']):.0f}, tilt {float(row['tilt_deg']):.0f}"
