"""Plans written to files, in the format that their ending names."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from ...errors import InvalidInput, Message
from ...files import write_whole
from ..plan import Plan
from .geojson import geojson_text
from .geopackage import geopackage_notes, write_geopackage
from .gpx import gpx_notes, gpx_text
from .kml import kml_notes, kml_text
from .litchi import check_litchi, litchi_notes, litchi_texts
from .qgroundcontrol import check_qgroundcontrol, qgroundcontrol_notes, qgroundcontrol_text
from .rows import csv_text

LITCHI_ENDING, GEOPACKAGE_ENDING = ".litchi.csv", ".gpkg"


class Exported(NamedTuple):
    """What was written.

    Parameters
    ----------
    notes : tuple of str
        What the format cannot say of the plan, one line each.
    """

    files: tuple[Path, ...]
    notes: tuple[str, ...] = ()


class _Format(NamedTuple):
    text: Callable[[Plan], Iterator[str]]
    check: Callable[[Plan], None] | None = None
    notes: Callable[[Plan], tuple[str, ...]] | None = None


#: Formats of one text each.
_TEXTS = {
    ".csv": _Format(csv_text),
    ".geojson": _Format(geojson_text),
    ".kml": _Format(kml_text, notes=kml_notes),
    ".plan": _Format(qgroundcontrol_text, check_qgroundcontrol, qgroundcontrol_notes),
    ".gpx": _Format(gpx_text, notes=gpx_notes),
}
#: What a plan's file may end in.
ENDINGS = (".csv", ".geojson", ".kml", GEOPACKAGE_ENDING, ".gpx", LITCHI_ENDING, ".plan")


def check_plan_ending(path: str | os.PathLike[str]) -> str:
    """Return the ending of a plan's file; refuse one that names no format a plan can be written in."""
    name = Path(path).name.lower()
    # The longest one that it ends in: Litchi's table is a .csv as well.
    ending = max((one for one in ENDINGS if name.endswith(one)), key=len, default=name)
    if name != ending:
        return ending
    raise InvalidInput("plan file {0!r}: must end in {1}", os.fspath(path), ", ".join(ENDINGS))


def write_plan(plan: Plan, path: str | os.PathLike[str]) -> Exported:
    """Write a plan in the format that the file's ending names, whole or not at all.

    They are the table (.csv), footprints (.geojson), layers of a GIS (.gpkg), Google Earth (.kml), and for those who
    fly: Litchi (.litchi.csv), QGroundControl (.plan) and a route (.gpx). A flight of more waypoints than a drone takes
    at once is for Litchi cut into ``NAME-1.litchi.csv``, ``NAME-2.litchi.csv`` and so on.

    Raises
    ------
    InvalidInput
        Any other ending, and a plan that the format cannot hold.
    OutputError
        Where the file cannot be written.
    """
    target, ending = Path(path), check_plan_ending(path)
    if ending == GEOPACKAGE_ENDING:
        write_geopackage(plan, target)
        return Exported((target,), geopackage_notes(plan))
    if ending == LITCHI_ENDING:
        return _write_litchi(plan, target)
    form = _TEXTS[ending]
    if form.check is not None:
        form.check(plan)
    write_whole(target, (text.encode() for text in form.text(plan)))
    return Exported((target,), () if form.notes is None else form.notes(plan))


def _write_litchi(plan: Plan, target: Path) -> Exported:
    check_litchi(plan)
    texts = litchi_texts(plan)
    stem, ending = target.name[: -len(LITCHI_ENDING)], target.name[-len(LITCHI_ENDING) :]
    files = [target]
    if len(texts) > 1:
        files = [target.with_name(f"{stem}-{number}{ending}") for number in range(1, len(texts) + 1)]
    written: list[Path] = []
    try:
        for file, text in zip(files, texts):
            write_whole(file, (block.encode() for block in text))
            written.append(file)
    except BaseException:
        # Part of a flight would pass for the whole of it.
        for file in written:
            with contextlib.suppress(OSError):
                file.unlink()
        raise
    notes = litchi_notes(plan)
    if len(files) > 1:
        notes = (
            Message("{0} parts of one flight, {1} to {2}", len(files), files[0].name, files[-1].name),
            *notes,
        )
    return Exported(tuple(files), notes)
