"""Writing plans to files, in the format of the file ending."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterable, Iterator
from itertools import chain, count, islice, takewhile
from pathlib import Path
from typing import NamedTuple

from ...arrays import Floats
from ...errors import InvalidInput, Message, OutputError
from ...storage.files import write_whole
from ...storage.stores import is_address, store_path
from ..parts import BY_DISTANCE
from ..plan import Plan
from .clearance import FlownPath, Reader, gpx_points, kml_points
from .geojson import geojson_text
from .geopackage import geopackage_notes, write_geopackage
from .gpx import gpx_notes, gpx_text
from .kml import kml_notes, kml_text
from .litchi import check_litchi, litchi_notes, litchi_texts
from .qgroundcontrol import check_qgroundcontrol, qgroundcontrol_notes, qgroundcontrol_texts
from .rows import csv_text
from .survey import check_survey, survey_notes, survey_texts
from .wpml import check_wpml, wpml_files, wpml_notes


class PlanFiles(NamedTuple):
    """Files of a plan that were written.

    Parameters
    ----------
    notes : tuple of str
        Notes on what the format cannot express, one line each.
    replaced : tuple of Path
        Existing files that parts of the flight have replaced; users do not choose the names of parts.
    """

    files: tuple[Path, ...]
    notes: tuple[str, ...] = ()
    replaced: tuple[Path, ...] = ()


class PartsAlreadyThere(OutputError):
    """Parts of a plan would replace existing files.

    Attributes
    ----------
    files : tuple of Path
    """

    def __init__(self, files: tuple[Path, ...]) -> None:
        super().__init__("parts of the plan are already there: {0}", ", ".join(file.name for file in files))
        self.files = files


class _Format(NamedTuple):
    """Format of one text; ``points`` reads the points of flight lines from a block, if the format has such lines."""

    text: Callable[[Plan], Iterator[str]]
    notes: Callable[[Plan], tuple[str, ...]] | None = None
    points: Callable[[str], Floats] | None = None


#: Formats of one text. Tables and footprints have no flight lines.
_TEXTS = {
    ".csv": _Format(csv_text),
    ".geojson": _Format(geojson_text),
    ".kml": _Format(kml_text, kml_notes, kml_points),
    ".gpx": _Format(gpx_text, gpx_notes, gpx_points),
}


class _PartedFormat(NamedTuple):
    """Format with a file for each part of a flight."""

    contents: Callable[[Plan], list[Iterable[bytes]]]
    check: Callable[[Plan], None]
    notes: Callable[[Plan], tuple[str, ...]]
    read: Callable[[Reader, bytes], list[FlownPath]]


def _encoded(texts: Callable[[Plan], list[Iterator[str]]]) -> Callable[[Plan], list[Iterable[bytes]]]:
    return lambda plan: [(block.encode() for block in text) for text in texts(plan)]


def _decoded(read: Callable[[Reader, str], list[FlownPath]]) -> Callable[[Reader, bytes], list[FlownPath]]:
    return lambda reader, data: read(reader, data.decode())


#: Formats of one file, or several for a flight in parts.
_PARTED = {
    ".litchi.csv": _PartedFormat(_encoded(litchi_texts), check_litchi, litchi_notes, _decoded(Reader.litchi)),
    ".kmz": _PartedFormat(lambda plan: [[whole] for whole in wpml_files(plan)], check_wpml, wpml_notes, Reader.kmz),
    ".plan": _PartedFormat(
        _encoded(qgroundcontrol_texts), check_qgroundcontrol, qgroundcontrol_notes, _decoded(Reader.plan)
    ),
    ".survey.plan": _PartedFormat(_encoded(survey_texts), check_survey, survey_notes, _decoded(Reader.plan)),
}
#: Endings of plan files.
ENDINGS = (".csv", ".geojson", ".kml", ".gpkg", ".gpx", *_PARTED)


def check_plan_ending(path: str | os.PathLike[str], *more: str) -> str:
    """Return the ending of a plan file; refuse endings other than of plan formats and ``more``."""
    name, known = store_path(path).name.lower(), (*ENDINGS, *more)
    # The longest match, as .litchi.csv also ends in .csv.
    ending = max((one for one in known if name.endswith(one)), key=len, default=name)
    if name != ending:
        return ending
    raise InvalidInput("plan file {0!r}: must end in {1}", str(path), ", ".join(known))


def write_plan(plan: Plan, path: str | os.PathLike[str], *, replace_parts: bool = True) -> PlanFiles:
    """Write a plan in the format of the file ending, whole or not at all.

    Formats are the table (.csv), footprints (.geojson), layers of a GIS (.gpkg), Google Earth (.kml), DJI's programs
    (.kmz), Litchi (.litchi.csv), QGroundControl (.plan; .survey.plan, which it edits as a survey) and a route (.gpx). A
    flight of several sorties, or of more waypoints than a drone accepts, is written to ``NAME-1.kmz``, ``NAME-2.kmz``
    and so on.

    Parameters
    ----------
    replace_parts : bool
        Whether parts may replace existing files; users do not choose the names of parts.

    Raises
    ------
    InvalidInput
        The ending is unknown, the format cannot hold the plan, or the flight is too close to the relief.
    PartsAlreadyThere
        Parts would replace files, but must not.
    OutputError
        The file cannot be written.
    """
    target, ending = store_path(path), check_plan_ending(path)
    if is_address(target) and ending not in _TEXTS:
        raise InvalidInput("plan file {0!r}: must be on this machine, as all {1} files", str(path), ending)
    if ending == ".gpkg":
        write_geopackage(plan, target)
        return PlanFiles((target,), geopackage_notes(plan))
    if ending in _PARTED:
        return _write_parts(plan, target, ending, replace_parts)
    form = _TEXTS[ending]
    texts = form.text(plan)
    if not plan.relief.is_level and form.points is not None:
        texts = _checked_text(plan, target.name, texts, form.points)
    write_whole(target, (text.encode() for text in texts))
    return PlanFiles((target,), () if form.notes is None else form.notes(plan))


def plan_texts(plan: Plan) -> tuple[list[str], tuple[str, ...]]:
    """Texts of QGroundControl's ``.plan`` of the sorties, checked, and notes; raises as `write_plan` does."""
    form = _PARTED[".plan"]
    form.check(plan)
    contents, read_back = form.contents(plan), tuple[Message, ...]()
    if not plan.relief.is_level:
        contents, read_back = _checked(plan, ".plan", contents, form.read)
    return [b"".join(blocks).decode() for blocks in contents], (*form.notes(plan), *read_back)


def _checked_text(plan: Plan, name: str, texts: Iterable[str], points: Callable[[str], Floats]) -> Iterator[str]:
    """Yield blocks of a text, and check the flight in them before the end."""
    found = []
    for text in texts:
        found.append(points(text))
        yield text
    reader = Reader(plan)
    reader.check(reader.above_ground(found), name)


def _checked(
    plan: Plan, name: str, contents: list[Iterable[bytes]], read: Callable[[Reader, bytes], list[FlownPath]]
) -> tuple[list[Iterable[bytes]], tuple[Message, ...]]:
    """Contents of files, read back and checked, and a note on the heights in them if rows have few waypoints."""
    reader, wholes = Reader(plan), [b"".join(blocks) for blocks in contents]
    ways = [read(reader, whole) for whole in wholes]
    for number, one in enumerate(ways, 1):
        reader.check(one, name if len(wholes) == 1 else Message("{0}, part {1}", name, number))
    notes = (reader.departure_note(chain.from_iterable(ways), plan),) if plan.mission.trigger == BY_DISTANCE else ()
    return [[whole] for whole in wholes], notes


def _write_parts(plan: Plan, target: Path, lowered: str, replace_parts: bool) -> PlanFiles:
    form = _PARTED[lowered]
    form.check(plan)
    contents = form.contents(plan)
    read_back: tuple[Message, ...] = ()
    if not plan.relief.is_level:
        contents, read_back = _checked(plan, target.name, contents, form.read)
    stem, ending = target.name[: -len(lowered)], target.name[-len(lowered) :]
    parts = (target.with_name(f"{stem}-{number}{ending}") for number in count(1))
    files, existing = [target], tuple[Path, ...]()
    if len(contents) > 1:
        files = list(islice(parts, len(contents)))
        existing = tuple(file for file in files if file.exists())
        if existing and not replace_parts:
            raise PartsAlreadyThere(existing)
    # Files of an earlier flight that had more parts, or only one.
    leftover = [file for file in [target] if file not in files and file.exists()]
    leftover += takewhile(Path.exists, parts)
    written: list[Path] = []
    try:
        for file, blocks in zip(files, contents):
            write_whole(file, blocks)
            written.append(file)
    except BaseException:
        # An incomplete flight could be mistaken for the whole one.
        for file in written:
            with contextlib.suppress(OSError):
                file.unlink()
        raise
    notes = (*form.notes(plan), *read_back)
    if len(files) > 1:
        notes = (
            Message("{0} parts of one flight, {1} to {2}", len(files), files[0].name, files[-1].name),
            *notes,
        )
    if leftover:
        names = ", ".join(file.name for file in leftover)
        notes = (*notes, Message("not of this flight, and left as they were: {0}", names))
    return PlanFiles(tuple(files), notes, existing)
