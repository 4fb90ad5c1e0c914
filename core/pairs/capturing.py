"""The run that makes a cross-view dataset: captures, then a layout of folders as in University-1652."""

from __future__ import annotations

import filecmp
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..capture.begun import check_settings
from ..capture.holding import LEASE_FILE, locked
from ..capture.journal import FAILED, Journal, Outcome
from ..capture.making import DEFAULT_CONNECTIONS, check_source
from ..capture.progress import SILENT, CaptureResult, Listener
from ..capture.several import capture_each, combined
from ..dataset.folder import JOURNAL_FILE, MISSION_FILE, REJECTED_FOLDER
from ..errors import InvalidInput, Message, OptionName, OutputError
from ..geodesy.mercator import wrap_lon_deg
from ..imagery.source import Source
from ..limits import MAX_MISSION_BYTES
from ..storage.files import (
    csv_bytes,
    json_bytes,
    link_or_copy,
    make_folder,
    read_limited,
    write_whole,
)
from ..text.plain import table_cell
from .parts import TEST, TRAIN
from .planning import DRONE, SATELLITE, PairPlan

SETTINGS_FILE, TABLE_FILE = "pairs.json", "pairs.csv"
CAPTURES_FOLDER = "captures"
#: Ground-level views that University-1652's baseline opens (the second one for training only); the most oblique drone
#: view stands in for them.
STAND_INS = ("street", "google")
_README = """Cross-view pairs in the layout of University-1652, made with TerrAInav.

The folders `street`, `google`, `query_street` and `gallery_street` hold no photographs from the ground, but stand-ins
for programs that open these folders: the most oblique drone view of each place, under its name in `drone`. Results
computed from them say nothing about street views.
"""
#: Locked while a run works in the folder.
_LOCK_FILE = "run.lock"
COLUMNS = (
    *("id", "name", "part", "view", "image", "status", "reason", "place_lat_deg", "place_lon_deg"),
    *("lat_deg", "lon_deg", "agl_m", "yaw_deg", "tilt_deg", "roll_deg", "width_px", "height_px"),
    *("file", "query_file", "captured"),
)


@dataclass(frozen=True)
class PairResult(CaptureResult):
    """Result of a run: the sum of all captures, with their names in place of map types.

    Parameters
    ----------
    left_out : tuple of str
        Ids of places without a satellite view or without any drone view, which are in no part.
    """

    left_out: tuple[str, ...] = ()


@dataclass(frozen=True)
class _PairImage:
    """Image of a place: its view and file name in the parts' folders, its mission, and its index in the plan."""

    view: str
    name: str
    mission: str
    index: int


def capture_pairs(
    planned: PairPlan,
    source: Source,
    folder: str | os.PathLike[str],
    *,
    drone_source: Source | None = None,
    connections: int = DEFAULT_CONNECTIONS,
    workers: int | None = None,
    resume: bool = False,
    listener: Listener = SILENT,
) -> PairResult:
    """Capture the views of all places and lay them out as in University-1652.

    The captures are ordinary datasets in ``captures/satellite`` and ``captures/drone`` (one for each tilt if there are
    several). Their images are hard-linked, or copied where the disk has no hard links, to ``train/<view>/<id>``,
    ``test/query_<view>/<id>`` and ``test/gallery_<view>/<id>``. The most oblique drone view fills the views of
    `STAND_INS`. Places without a satellite view or without any drone view are left out. The same settings write the
    same bytes, however often the run is interrupted.

    Parameters
    ----------
    source, drone_source : Source
        Imagery of the satellite, and of the drone if it differs, with the pixel grids that the plan was made for.
    resume : bool
        Continue in a folder with these settings: make missing and failed images.
    connections, workers, listener
        As in `capture`; progress has the capture's name in place of the map type.

    Raises
    ------
    InvalidInput
        The source lacks the map type, or the plan is for another pixel grid; nothing is written.
    OutputError
        The folder cannot be written, or holds other settings, these settings without ``resume``, or foreign files.
    SourceError
        The source fails; finished images are kept.
    """
    captures = {
        name: (plan, source if name == SATELLITE or drone_source is None else drone_source)
        for name, plan in planned.plans.items()
    }
    for plan, one in captures.values():
        check_source(plan, one)
    path = Path(folder)
    wanted = json_bytes(planned.to_dict())
    _refuse(path, wanted, resume=resume)
    make_folder(path / CAPTURES_FOLDER)
    lock = path / CAPTURES_FOLDER / _LOCK_FILE
    with locked(lock) as check:
        # Another run may have claimed the folder meanwhile.
        _refuse(path, wanted, resume=resume, has_lock=True)
        check_settings(path, SETTINGS_FILE, planned.to_dict())
        write_whole(path / SETTINGS_FILE, wanted, durable=True)
        results = capture_each(
            captures,
            path / CAPTURES_FOLDER,
            connections=connections,
            workers=workers,
            listener=listener.guarded(check),
        )
        check()
        total = replace(combined(path, results), total=planned.images)
        return PairResult(**vars(total), left_out=() if total.cancelled else _lay_out(path, planned))


def _refuse(path: Path, wanted: bytes, *, resume: bool, has_lock: bool = False) -> None:
    """Raise OutputError for a folder that these settings may not be written to."""
    mark = path / SETTINGS_FILE
    try:
        found = read_limited(mark, MAX_MISSION_BYTES) if mark.exists() else None
    except (OSError, InvalidInput) as wrong:
        raise OutputError(
            "folder {0}: cannot read {1} ({2})",
            path,
            SETTINGS_FILE,
            getattr(wrong, "strerror", None) or wrong,
        ) from wrong
    if found is not None:
        if found != wanted:
            raise OutputError("folder {0}: holds pairs of other settings", path, remedy="choose another folder")
        if not resume:
            raise OutputError(
                "folder {0}: already holds these pairs",
                path,
                remedy=Message("resume them{0} or choose another folder", OptionName("resume").in_brackets),
            )
        return
    inside = path / CAPTURES_FOLDER
    foreign = [path / name for name in (TRAIN, TEST, TABLE_FILE, MISSION_FILE) if (path / name).exists()]
    if inside.exists() and not has_lock:
        # A run that was killed at its start leaves its lock.
        foreign += (
            [one for one in sorted(inside.iterdir()) if one.name not in (_LOCK_FILE, LEASE_FILE)]
            if inside.is_dir()
            else [inside]
        )
    if foreign:
        raise OutputError(
            "folder {0}: holds {1} but no {2}, so it is not of these pairs",
            path,
            foreign[0].relative_to(path).as_posix(),
            SETTINGS_FILE,
            remedy="choose another folder",
        )


def _lay_out(path: Path, planned: PairPlan) -> tuple[str, ...]:
    """Place the images and write their table; returns the ids of the places left out."""
    outcomes: dict[str, dict[str, Outcome]] = {}
    for name in planned.plans:
        journal = Journal(path / CAPTURES_FOLDER / name / JOURNAL_FILE)
        outcomes[name] = {picture: outcome for (_, picture), outcome in journal.outcomes.items()}
    rows: list[dict[str, object]] = []
    left_out: list[str] = []
    for place, place_id in enumerate(planned.ids):
        images = list(_images(planned, place))
        found = [outcomes[image.mission].get(_picture(planned, image)) for image in images]
        made = [outcome is not None and outcome.status != FAILED for outcome in found]
        complete = made[0] and any(made[1:])
        if not complete:
            left_out.append(place_id)
        oblique = _most_oblique(planned, made[1:])
        for view in STAND_INS if planned.parts[place] == TRAIN else STAND_INS[:1]:
            for at, image in enumerate(images[1 : 1 + len(planned.settings.views)]):
                stand_in = replace(image, view=view)
                if at == oblique:
                    images.append(stand_in)
                    found.append(found[1 + at])
                    made.append(made[1 + at])
                else:
                    # This view may have stood in while a more oblique one was missing.
                    for file in _files(planned.parts[place], place_id, stand_in):
                        _withdraw(path / file)
        for image, outcome, is_made in zip(images, found, made):
            captured = _captured(path, planned, image) if is_made else None
            files = _files(planned.parts[place], place_id, image)
            for file in files:
                if captured is not None and complete:
                    _put(path / file, captured)
                else:
                    _withdraw(path / file)
            reason = "" if outcome is None else outcome.reason
            source = captured.relative_to(path).as_posix() if captured is not None else ""
            rows.append(_row(planned, place, image, reason, is_made, files if is_made and complete else [], source))
    cells = ([row[name] for name in COLUMNS] for row in rows)
    write_whole(path / TABLE_FILE, csv_bytes([COLUMNS, *cells]))
    write_whole(path / "README.txt", _README.encode("utf-8"))
    return tuple(left_out)


def _most_oblique(planned: PairPlan, made: Sequence[bool]) -> int:
    """Index of the most oblique drone view, the lowest of several; among the views made, if any."""
    views = planned.settings.views
    among = [at for at, is_made in enumerate(made) if is_made] or list(range(len(views)))
    return max(among, key=lambda at: (views[at].tilt_deg, -views[at].agl_m, -at))


def _images(planned: PairPlan, place: int) -> Iterator[_PairImage]:
    """Yield the images of a place, the satellite's first."""
    yield _PairImage(SATELLITE, f"{planned.ids[place]}.jpg", SATELLITE, place)
    shots = planned.shots(place)
    digits = max(2, len(str(len(shots))))
    for number, (mission, index) in enumerate(shots, 1):
        yield _PairImage(DRONE, f"image-{number:0{digits}d}.jpeg", mission, index)


def _picture(planned: PairPlan, image: _PairImage) -> str:
    return planned.plans[image.mission].names[image.index]


def _captured(path: Path, planned: PairPlan, image: _PairImage) -> Path:
    """File of a captured image, which cleaning may have moved."""
    view = SATELLITE if image.mission == SATELLITE else DRONE
    folder = path / CAPTURES_FOLDER / image.mission / planned.settings.view_imagery(view).map_type
    name = f"{_picture(planned, image)}.jpg"
    moved = folder / REJECTED_FOLDER / name
    return moved if moved.exists() and not (folder / name).exists() else folder / name


def _files(part: str, place_id: str, image: _PairImage) -> list[str]:
    """Paths of an image in the parts' folders: test images are both in the gallery and among the queries."""
    if part == TRAIN:
        return [f"{TRAIN}/{image.view}/{place_id}/{image.name}"]
    kinds = ("gallery", "query") if part == TEST else ("gallery",)
    return [f"{TEST}/{kind}_{image.view}/{place_id}/{image.name}" for kind in kinds]


def _put(target: Path, captured: Path) -> None:
    """Link or copy a captured image to a target; raises OutputError if the target exists and differs."""
    try:
        if target.exists():
            if target.samefile(captured) or filecmp.cmp(target, captured, shallow=False):
                return
            raise OutputError(
                "image {0}: is not the one that was captured ({1}), and nothing is overwritten",
                target,
                captured,
                remedy="move it away",
            )
        link_or_copy(captured, target)
    except OSError as wrong:
        raise OutputError("image {0}: cannot be placed ({1})", target, wrong.strerror) from wrong


def _withdraw(target: Path) -> None:
    """Remove an image that an earlier run placed, if it exists."""
    try:
        target.unlink(missing_ok=True)
    except OSError as wrong:
        raise OutputError("image {0}: cannot be removed ({1})", target, wrong.strerror) from wrong


def _row(
    planned: PairPlan,
    place: int,
    image: _PairImage,
    reason: str,
    is_made: bool,
    files: list[str],
    captured: str,
) -> dict[str, object]:
    plan, where = planned.plans[image.mission], planned.places[place]
    width, height, _ = plan.mission.output.img_size or (0, 0, 0)
    pose = {name: float(values[image.index]) for name, values in zip(plan.poses._fields, plan.poses)}
    pose["lon_deg"] = float(wrap_lon_deg(plan.lon_deg[image.index : image.index + 1])[0])
    return {
        "id": planned.ids[place],
        "name": table_cell(where.name),
        "part": planned.parts[place],
        "view": image.view,
        "image": image.name,
        "status": "done" if is_made else "failed",
        "reason": table_cell(reason),
        "place_lat_deg": where.lat_deg,
        "place_lon_deg": where.lon_deg,
        **pose,
        "width_px": width,
        "height_px": height,
        "file": files[0] if files else "",
        "query_file": files[1] if len(files) > 1 else "",
        "captured": captured,
    }
