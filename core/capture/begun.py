"""The settings that a capture was begun with, which later runs must match."""

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

#: File of the settings by path, beside ``mission.json`` or a similar file.
BEGUN_FILE = "begun.json"
_SCHEMA = 1


def check_mission(root: Path, mission: Mission) -> None:
    """Check a mission against the mission that the first run noted, or note it.

    Only for the run that holds the place.

    Raises
    ------
    OutputError
        ``mission.json`` was edited since the first run; the message has the first three changed settings, old and new.
    """
    check_settings(root, MISSION_FILE, _mission_settings(mission))


def check_settings(root: Path, name: str, settings: Mapping[str, Any]) -> None:
    """Check settings against the settings that the first run noted, or note them; OutputError names the file."""
    wanted, found = _flatten(settings), _read_settings(root)
    if found is None:
        write_whole(root / BEGUN_FILE, json_bytes({"schema": _SCHEMA, "settings": wanted}), durable=True)
        return
    changed = _changes(found, wanted)
    if changed:
        raise _edited(root, name, changed)


def edited_since(root: Path, mark: bytes, mission: Mission) -> OutputError | None:
    """Error for a ``mission.json`` edited since the first run; None if the first run had another mission."""
    found = _read_settings(root)
    if found is None or _changes(found, _flatten(_mission_settings(mission))):
        return None
    try:
        now = Mission.from_json(mark.decode("utf-8"))
    except (InvalidInput, UnicodeDecodeError):
        return _edited(root, MISSION_FILE, [Message("it holds no mission")])
    return _edited(root, MISSION_FILE, _changes(found, _flatten(_mission_settings(now))))


def _edited(root: Path, name: str, changed: list[Message]) -> OutputError:
    more = len(changed) - 3
    listed = Message.joined(", ", changed[:3])
    return OutputError(
        "{0}: its {1} was edited since the capture began: {2}",
        root,
        name,
        Message("{0} and {1:,} more", listed, more) if more > 0 else listed,
        remedy="put it back as it was or choose another folder",
    )


def _mission_settings(mission: Mission) -> dict[str, Any]:
    """Settings of a mission by part, including defaults, which mission files leave out."""
    parts = {one.name: getattr(mission, one.name) for one in fields(mission)}
    plain = {name: asdict(part) for name, part in parts.items() if part is not None and name not in ("area", "no_fly")}
    area = {"type": type(mission.area).__name__.lower(), **asdict(mission.area)}
    return {"area": area, **plain, "no_fly": [asdict(polygon) for polygon in mission.no_fly]}


def _flatten(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings by path, such as ``flight.agl_m``, converted through JSON."""
    found: dict[str, Any] = json.loads(json_bytes(dict(_flat_items(settings))))
    return found


def _flat_items(settings: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in settings.items():
        if isinstance(value, Mapping):
            yield from _flat_items(value, f"{before}{name}.")
        elif isinstance(value, (list, tuple)) and len(text := json.dumps(value)) > 200:
            # A list may have millions of values: its digest is enough.
            digest = hashlib.sha256(text.encode("ascii")).hexdigest()
            yield f"{before}{name}", {"values": len(value), "sha256": digest}
        else:
            yield f"{before}{name}", value


def _read_settings(root: Path) -> dict[str, Any] | None:
    """Read the settings noted by the first run, by path; None if it noted nothing."""
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
    """Messages for the settings that differ; settings that were not noted had their defaults."""
    parts: dict[str, Any] = {**FLAT_PARTS, "camera": Camera}
    default = _flatten(
        {
            name: {one.name: one.default for one in fields(part) if one.default is not MISSING}
            for name, part in parts.items()
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
        return shortened(value, 60)
    if isinstance(value, dict):
        return Message("{0:,} values", value["values"]) if isinstance(value.get("values"), int) else Message("others")
    return shortened(json.dumps(value, ensure_ascii=False), 60)
