"""Plans written to files, in the format that their ending names."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterable, Iterator
from itertools import count, islice, takewhile
from pathlib import Path
from typing import NamedTuple

from ...arrays import Floats
from ...errors import InvalidInput, Message, OutputError
from ...storage.files import write_whole
from ...storage.stores import is_address, store_path
from ..plan import Plan
from .flown import FlownPath, Reader, places_of_gpx, places_of_kml
from .geojson import geojson_text
from .geopackage import geopackage_notes, write_geopackage
from .gpx import gpx_notes, gpx_text
from .kml import kml_notes, kml_text
from .litchi import check_litchi, litchi_notes, litchi_texts
from .qgroundcontrol import check_qgroundcontrol, qgroundcontrol_notes, qgroundcontrol_texts
from .rows import csv_text
from .survey import check_survey, survey_notes, survey_texts
from .wpml import check_wpml, wpml_files, wpml_notes

LITCHI_ENDING, GEOPACKAGE_ENDING = ".litchi.csv", ".gpkg"


class PlanFiles(NamedTuple):
    """What was written.

    Parameters
    ----------
    notes : tuple of str
        What the format cannot say of the plan, one line each.
    replaced : tuple of Path
        Parts of a flight, whose names nobody has chosen, that took the place of files that were there.
    """

    files: tuple[Path, ...]
    notes: tuple[str, ...] = ()
    replaced: tuple[Path, ...] = ()


class PartsAlreadyThere(OutputError):
    """Files that parts of a plan would replace.

    Attributes
    ----------
    files : tuple of Path
    """

    def __init__(self, files: tuple[Path, ...]) -> None:
        super().__init__("parts of the plan are already there: {0}", ", ".join(file.name for file in files))
        self.files = files


class _Format(NamedTuple):
    """Format of one text; and what reads the places of its ways, where it has any, of a block."""

    text: Callable[[Plan], Iterator[str]]
    notes: Callable[[Plan], tuple[str, ...]] | None = None
    places: Callable[[str], Floats] | None = None


#: Formats of one text each. Tables and footprints have captures alone, and no way between them.
_TEXTS = {
    ".csv": _Format(csv_text),
    ".geojson": _Format(geojson_text),
    ".kml": _Format(kml_text, kml_notes, places_of_kml),
    ".gpx": _Format(gpx_text, gpx_notes, places_of_gpx),
}


class _Parted(NamedTuple):
    """Format of a file for each part of a flight."""

    contents: Callable[[Plan], list[Iterable[bytes]]]
    check: Callable[[Plan], None]
    notes: Callable[[Plan], tuple[str, ...]]
    read: Callable[[Reader, bytes], list[FlownPath]]


def _encoded(texts: Callable[[Plan], list[Iterator[str]]]) -> Callable[[Plan], list[Iterable[bytes]]]:
    return lambda plan: [(block.encode() for block in text) for text in texts(plan)]


def _decoded(read: Callable[[Reader, str], list[FlownPath]]) -> Callable[[Reader, bytes], list[FlownPath]]:
    return lambda reader, data: read(reader, data.decode())


#: Formats of one file, or of several where the flight is in parts.
_PARTED = {
    LITCHI_ENDING: _Parted(_encoded(litchi_texts), check_litchi, litchi_notes, _decoded(Reader.litchi)),
    ".kmz": _Parted(lambda plan: [[whole] for whole in wpml_files(plan)], check_wpml, wpml_notes, Reader.kmz),
    ".plan": _Parted(_encoded(qgroundcontrol_texts), check_qgroundcontrol, qgroundcontrol_notes, _decoded(Reader.plan)),
    ".survey.plan": _Parted(_encoded(survey_texts), check_survey, survey_notes, _decoded(Reader.plan)),
}
#: What a plan's file may end in.
ENDINGS = (".csv", ".geojson", ".kml", GEOPACKAGE_ENDING, ".gpx", *_PARTED)


def check_plan_ending(path: str | os.PathLike[str], *more: str) -> str:
    """Return the ending of a plan's file; refuse one that is neither of a plan's format nor one of ``more``."""
    name, known = store_path(path).name.lower(), (*ENDINGS, *more)
    # The longest one that it ends in: Litchi's table is a .csv as well.
    ending = max((one for one in known if name.endswith(one)), key=len, default=name)
    if name != ending:
        return ending
    raise InvalidInput("plan file {0!r}: must end in {1}", str(path), ", ".join(known))


def write_plan(plan: Plan, path: str | os.PathLike[str], *, replace_parts: bool = True) -> PlanFiles:
    """Write a plan in the format that the file's ending names, whole or not at all.

    They are the table (.csv), footprints (.geojson), layers of a GIS (.gpkg), Google Earth (.kml), and for those who
    fly: DJI's programs (.kmz), Litchi (.litchi.csv), QGroundControl (.plan; .survey.plan, which it edits as a survey)
    and a route (.gpx). A flight of several sorties, or of more waypoints than a drone takes at once, is cut into
    ``NAME-1.kmz``, ``NAME-2.kmz`` and so on.

    Parameters
    ----------
    replace_parts : bool
        Whether such parts replace files that are there, whose names nobody has chosen.

    Raises
    ------
    InvalidInput
        Any other ending, a plan that the format cannot hold, and a file whose flight comes too near to the relief.
    PartsAlreadyThere
        Some parts would replace files, and must not.
    OutputError
        Where the file cannot be written.
    """
    target, ending = store_path(path), check_plan_ending(path)
    if is_address(target) and ending not in _TEXTS:
        raise InvalidInput("plan file {0!r}: must be on this machine, as all {1} files", str(path), ending)
    if ending == GEOPACKAGE_ENDING:
        write_geopackage(plan, target)
        return PlanFiles((target,), geopackage_notes(plan))
    if ending in _PARTED:
        return _write_parts(plan, target, ending, replace_parts)
    form = _TEXTS[ending]
    texts = form.text(plan)
    if not plan.relief.is_level and form.places is not None:
        texts = _read_back(plan, target.name, texts, form.places)
    write_whole(target, (text.encode() for text in texts))
    return PlanFiles((target,), () if form.notes is None else form.notes(plan))


def _read_back(plan: Plan, name: str, texts: Iterable[str], places_of: Callable[[str], Floats]) -> Iterator[str]:
    """Hand blocks of a text on, and check the flight that they say before they end."""
    places = []
    for text in texts:
        places.append(places_of(text))
        yield text
    reader = Reader(plan)
    reader.check(reader.above_ground(places), name)


def _checked(
    plan: Plan, name: str, contents: list[Iterable[bytes]], read: Callable[[Reader, bytes], list[FlownPath]]
) -> list[Iterable[bytes]]:
    """Contents of files, each of which was read back and checked."""
    reader, wholes = Reader(plan), [b"".join(blocks) for blocks in contents]
    for number, whole in enumerate(wholes, 1):
        part = name if len(wholes) == 1 else Message("{0}, part {1}", name, number)
        reader.check(read(reader, whole), part)
    return [[whole] for whole in wholes]


def _write_parts(plan: Plan, target: Path, lowered: str, replace_parts: bool) -> PlanFiles:
    form = _PARTED[lowered]
    form.check(plan)
    contents = form.contents(plan)
    if not plan.relief.is_level:
        contents = _checked(plan, target.name, contents, form.read)
    stem, ending = target.name[: -len(lowered)], target.name[-len(lowered) :]
    parts = (target.with_name(f"{stem}-{number}{ending}") for number in count(1))
    files, there = [target], tuple[Path, ...]()
    if len(contents) > 1:
        files = list(islice(parts, len(contents)))
        there = tuple(file for file in files if file.exists())
        if there and not replace_parts:
            raise PartsAlreadyThere(there)
    # Of an earlier flight in fewer parts, or in more.
    left = [file for file in [target] if file not in files and file.exists()]
    left += takewhile(Path.exists, parts)
    written: list[Path] = []
    try:
        for file, blocks in zip(files, contents):
            write_whole(file, blocks)
            written.append(file)
    except BaseException:
        # Part of a flight would pass for the whole of it.
        for file in written:
            with contextlib.suppress(OSError):
                file.unlink()
        raise
    notes = form.notes(plan)
    if len(files) > 1:
        notes = (
            Message("{0} parts of one flight, {1} to {2}", len(files), files[0].name, files[-1].name),
            *notes,
        )
    if left:
        names = ", ".join(file.name for file in left)
        notes = (*notes, Message("not of this flight, and left as they were: {0}", names))
    return PlanFiles(tuple(files), notes, there)
