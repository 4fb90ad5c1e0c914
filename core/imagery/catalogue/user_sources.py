"""A user's own sources: kept by name in a file of the user's configuration folder."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import InvalidInput, OutputError
from ...files import make_folder, write_whole
from ..template import Template
from .entry import KEY_ENV, CatalogueEntry, shipped, under_provider

#: Environment variable with the folder, for one elsewhere than where the platform keeps configuration.
FOLDER_ENV = "TERRAINAV_CONFIG_DIR"
FILE = "sources.json"
#: Zooms of a template of which nothing is said.
DEFAULT_MAX_ZOOM = 22
#: What names of sources look like.
NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


def default_folder() -> Path:
    """Return the folder of a user's configuration, which may not be there yet."""
    if os.environ.get(FOLDER_ENV):
        return Path(os.environ[FOLDER_ENV])
    if sys.platform == "win32":
        above = Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming")
    elif sys.platform == "darwin":
        above = Path.home() / "Library" / "Application Support"
    else:
        above = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    return above / "terrainav"


def user_sources(folder: str | os.PathLike[str] | None = None) -> tuple[CatalogueEntry, ...]:
    """Return the user's entries, each under the terms of its provider where that is known.

    Raises
    ------
    InvalidInput
        The file cannot be read, or an entry is not right; names the file.
    """
    path = _path(folder)
    known = _read(path)
    try:
        return tuple(_entry(name, data) for name, data in known.items())
    except InvalidInput as wrong:
        raise InvalidInput(f"{path}: {wrong}") from wrong


def described(
    url: str,
    *,
    title: str = "",
    attribution: str = "",
    licence: str = "",
    terms_url: str = "",
    min_zoom: int = 0,
    max_zoom: int | None = None,
    native_zoom: int | None = None,
    tile_px: int = 256,
    default_date: str = "",
    key_env: str = KEY_ENV,
    max_connections: int | None = None,
    requests_per_s: float | None = None,
    cache_allowed: bool = True,
) -> dict[str, Any]:
    """Data of an entry for a URL template, as `add` takes it.

    Parameters
    ----------
    url : str
        Template; without a key in it, {key} stands for that of ``key_env``.
    title : str
        Its host by default.
    max_zoom, native_zoom : int or None
        22, and the highest zoom.
    default_date : str
        Where the template has a {date}; without one, each mission must say which.

    Raises
    ------
    InvalidInput
        The template is not valid.
    """
    template = Template(url)
    highest = DEFAULT_MAX_ZOOM if max_zoom is None else max_zoom
    data: dict[str, Any] = {
        "title": title or template.host,
        "kind": "xyz",
        "attribution": attribution,
        "urls": {"": template.text},
        "tile_px": [tile_px],
        "min_zoom": min_zoom,
        "max_zoom": highest,
        "native_zoom": highest if native_zoom is None else native_zoom,
        "licence": licence,
        "terms_url": terms_url,
        "max_connections": max_connections,
        "requests_per_s": requests_per_s,
        "cache_allowed": cache_allowed,
    }
    if "{s}" in template.text and template.subdomains != ("a", "b", "c"):
        # As it was written, so that it says its subdomains.
        data["urls"] = {"": url.strip()}
    if "map_type" in template.names:
        data["map_types"] = ["satellite", "roadmap", "terrain"]
    if "key" in template.names:
        data["key_env"] = key_env
    if "date" in template.names:
        data["dates"] = {"kind": "any", "default": default_date}
    elif default_date:
        raise InvalidInput(f"date {default_date!r}: the URL has no {{date}} to put it in")
    return data


def add(name: str, data: Mapping[str, Any], folder: str | os.PathLike[str] | None = None) -> CatalogueEntry:
    """Keep a source under a name.

    Parameters
    ----------
    name : str
        Lower-case letters, digits, hyphens and underscores; none that is taken.
    data : mapping
        As an entry of ``resources/sources.json``: from `described`, or `CatalogueEntry.to_data`.

    Raises
    ------
    InvalidInput
        The name or the data is not right.
    OutputError
        The file cannot be written.
    """
    _check_name(name)
    if any(entry.name == name for entry in shipped()):
        raise InvalidInput(f"source name {name!r}: is one of the catalogue's; choose another")
    path = _path(folder)
    known = _read(path)
    if name in known:
        raise InvalidInput(
            f"source name {name!r}: is taken; choose another, or `terrainav sources remove` it"
        )
    entry = _entry(name, data)
    _write(path, {**known, name: dict(data)})
    return entry


def remove(name: str, folder: str | os.PathLike[str] | None = None) -> None:
    """Forget a source of the user.

    Raises
    ------
    InvalidInput
        There is no such source, or it is one of the catalogue's.
    """
    path = _path(folder)
    known = _read(path)
    if name not in known:
        if any(entry.name == name for entry in shipped()):
            raise InvalidInput(f"source {name!r}: is part of the catalogue, which stays as it is")
        raise InvalidInput(f"source {name!r}: is none of your own, which are {', '.join(known) or 'none'}")
    _write(path, {other: data for other, data in known.items() if other != name})


def _path(folder: str | os.PathLike[str] | None) -> Path:
    return (default_folder() if folder is None else Path(folder)) / FILE


def _check_name(name: str) -> None:
    if not NAME.fullmatch(name):
        raise InvalidInput(
            f"source name {name!r}: must be lower-case letters, digits, hyphens and underscores, at most 64"
        )


def _entry(name: str, data: Any) -> CatalogueEntry:
    _check_name(name)
    if not isinstance(data, Mapping):
        raise InvalidInput(f"catalogue entry {name!r}: must be an object")
    entry = CatalogueEntry.from_dict(name, data, user=True)
    if entry.kind != "xyz":
        raise InvalidInput(f"catalogue entry {name!r}: must be of kind xyz")
    return under_provider(entry)


def _read(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except OSError as wrong:
        raise InvalidInput(f"{path}: cannot be read ({wrong.strerror}); mend it, or move it away") from wrong
    except (ValueError, RecursionError) as wrong:
        raise InvalidInput(f"{path}: cannot be read as JSON ({wrong}); mend it, or move it away") from wrong
    if not isinstance(data, dict):
        raise InvalidInput(f"{path}: must hold a JSON object of sources")
    return data


def _write(path: Path, data: Mapping[str, Any]) -> None:
    try:
        make_folder(path.parent)
        write_whole(path, (json.dumps(data, indent=1, ensure_ascii=False) + "\n").encode())
    except OutputError as wrong:
        raise OutputError(f"{wrong}; {FOLDER_ENV} names another folder") from wrong
