"""The settings that a capture was begun with, kept beside them: what a run that goes on is held to."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, asdict, fields
from pathlib import Path
from typing import Any

from ..dataset.folder import MISSION_FILE
from ..errors import InvalidInput, Message, OutputError
from ..geodesy.camera import Camera
from ..limits import MAX_SETTINGS_BYTES
from ..mission.mission import Mission
from ..mission.parts import FLAT_PARTS
from ..storage.files import json_bytes, read_limited, write_whole
from ..storage.stores import is_file
from ..text.plain import shortened
from ..text.safe_json import parse_json

#: Beside ``mission.json``, or what stands for it: the settings again, by their paths.
BEGUN_FILE = "begun.json"
_SCHEMA = 1
#: Longer lists are kept as their number of values and a digest: places may be millions.
_LONGEST_CHARACTERS = 200
#: Characters of a value, and changes, that a message shows.
_SHOWN_CHARACTERS, _SHOWN_CHANGES = 60, 3
#: Parts whose fields have defaults.
_DECLARED: dict[str, Any] = {**FLAT_PARTS, "camera": Camera}


def hold_to_mission(root: Path, mission: Mission) -> None:
    """Hold a run to the mission that a capture was begun with, or note it; for the run that holds the place.

    Raises
    ------
    OutputError
        ``mission.json`` was edited since; the message names each field with its old and new value.
    """
    hold_to(root, MISSION_FILE, _parts_of(mission))


def hold_to(root: Path, name: str, settings: Mapping[str, Any]) -> None:
    """Hold a run to the settings in a file of this name, or note them where no run has; raises OutputError."""
    wanted, found = _settled(settings), _kept(root)
    if found is None:
        write_whole(root / BEGUN_FILE, json_bytes({"schema": _SCHEMA, "settings": wanted}), durable=True)
        return
    changed = _changes(found, wanted)
    if changed:
        raise _edited(root, name, changed)


def edited_since(root: Path, mark: bytes, mission: Mission) -> OutputError | None:
    """Error for a ``mission.json`` that is of another mission than a capture was begun with, which is this one."""
    found = _kept(root)
    if found is None or _changes(found, _settled(_parts_of(mission))):
        return None
    try:
        now = Mission.from_json(mark.decode("utf-8"))
    except (InvalidInput, UnicodeDecodeError):
        return _edited(root, MISSION_FILE, [Message("it holds no mission")])
    return _edited(root, MISSION_FILE, _changes(found, _settled(_parts_of(now))))


def _edited(root: Path, name: str, changed: list[Message]) -> OutputError:
    more = len(changed) - _SHOWN_CHANGES
    listed = Message.joined(", ", changed[:_SHOWN_CHANGES])
    return OutputError(
        "{0}: its {1} was edited since the capture began: {2}",
        root,
        name,
        Message("{0} and {1:,} more", listed, more) if more > 0 else listed,
        remedy="put it back as it was or choose another folder",
    )


def _parts_of(mission: Mission) -> dict[str, Any]:
    """Settings of a mission part by part, with all defaults, as its own file leaves some of them out."""
    parts = {one.name: getattr(mission, one.name) for one in fields(mission)}
    plain = {
        name: asdict(part)
        for name, part in parts.items()
        if part is not None and name not in ("area", "no_fly")
    }
    area = {"type": type(mission.area).__name__.lower(), **asdict(mission.area)}
    return {"area": area, **plain, "no_fly": [asdict(polygon) for polygon in mission.no_fly]}


def _settled(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings by their paths, such as ``flight.agl_m``, as they are read again."""
    found: dict[str, Any] = json.loads(json_bytes(dict(_by_path(settings))))
    return found


def _by_path(settings: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in settings.items():
        if isinstance(value, Mapping):
            yield from _by_path(value, f"{before}{name}.")
        elif isinstance(value, (list, tuple)) and len(text := json.dumps(value)) > _LONGEST_CHARACTERS:
            digest = hashlib.sha256(text.encode("ascii")).hexdigest()
            yield f"{before}{name}", {"values": len(value), "sha256": digest}
        else:
            yield f"{before}{name}", value


def _kept(root: Path) -> dict[str, Any] | None:
    """Settings by their paths, as the run that began has kept them; None where it has not."""
    path = root / BEGUN_FILE
    if not is_file(path):
        return None
    try:
        found = parse_json(read_limited(path, MAX_SETTINGS_BYTES))
    except OSError as wrong:
        raise _unreadable(path, wrong.strerror) from wrong
    except InvalidInput as wrong:
        raise _unreadable(path, wrong) from wrong
    settings = found.get("settings") if isinstance(found, dict) else None
    if not isinstance(settings, dict) or found.get("schema") != _SCHEMA:
        raise _unreadable(path, Message("it holds no settings of this version"))
    return settings


def _unreadable(path: Path, reason: object) -> OutputError:
    return OutputError(
        "{0}: its {1} cannot be read ({2}), so it is not known how it was begun",
        path.parent,
        path.name,
        reason,
        remedy="choose another folder",
    )


def _changes(found: Mapping[str, Any], wanted: Mapping[str, Any]) -> list[Message]:
    """One message for each setting that differs; one that is not noted had its default."""
    default = _settled(
        {
            name: {one.name: one.default for one in fields(part) if one.default is not MISSING}
            for name, part in _DECLARED.items()
        }
    )
    return [
        _change(path, old, new)
        for path in dict.fromkeys((*wanted, *found))
        if (old := found.get(path, default.get(path))) != (new := wanted.get(path, default.get(path)))
    ]


def _change(path: str, old: Any, new: Any) -> Message:
    was, now = _shown(old), _shown(new)
    if was == now:
        now = Message("{0} that differ", now) if isinstance(new, dict) else Message("another one")
    return Message("{0} from {1} to {2}", path, was, now)


def _shown(value: Any) -> Message | str:
    if value is None:
        return Message("none")
    if isinstance(value, str):
        return shortened(value, _SHOWN_CHARACTERS)
    if isinstance(value, dict):
        return (
            Message("{0:,} values", value["values"])
            if isinstance(value.get("values"), int)
            else Message("others")
        )
    return shortened(json.dumps(value, ensure_ascii=False), _SHOWN_CHARACTERS)
