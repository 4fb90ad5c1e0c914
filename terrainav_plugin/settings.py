"""Persistent settings of the plugin, as typed properties stored in QGIS's settings."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import QgsApplication, QgsSettings

from ..core.errors import InvalidInput
from ..core.text.safe_json import parse_json
from ..core.units import LENGTHS_M
from .paths import exists, path_key

if TYPE_CHECKING:
    from ..core.imagery.cache.tile_cache import TileCache

_ROOT = "TerrAInav/"
_KEYS = f"{_ROOT}authcfg"
UNITS = tuple(LENGTHS_M)
_ADDRESS = re.compile(r"(https?)://([^/?#]*)", re.IGNORECASE)
#: SHA-256 of a tile, or its first digits, as for `Placeholder`.
_DIGEST = re.compile(r"\b[0-9a-f]{16,64}\b")


class _Text:
    """A text setting; ``choices`` are the allowed values, empty if any is allowed."""

    def __init__(self, default: str = "", choices: tuple[str, ...] = ()) -> None:
        self.default = default
        self.choices = choices

    def __set_name__(self, owner: type, name: str) -> None:
        self.key = _ROOT + name

    def __get__(self, instance: object, owner: type) -> str:
        text = str(QgsSettings().value(self.key, self.default) or "")
        return text if not self.choices or text in self.choices else self.default

    def __set__(self, instance: object, value: str) -> None:
        if self.choices and value not in self.choices:
            raise ValueError(f"{self.key} {value!r}: must be one of {', '.join(self.choices)}")
        QgsSettings().setValue(self.key, value)


class _Whole:
    """An integer setting in a range; any other value in the settings file counts as the default."""

    def __init__(self, default: int, least: int, most: int) -> None:
        self.default, self.least, self.most = default, least, most

    def __set_name__(self, owner: type, name: str) -> None:
        self.key = _ROOT + name

    def __get__(self, instance: object, owner: type) -> Any:
        if instance is None:
            return self
        try:
            number = int(QgsSettings().value(self.key, self.default))
        except (TypeError, ValueError):
            return self.default
        return number if self.least <= number <= self.most else self.default

    def __set__(self, instance: object, value: int) -> None:
        if not self.least <= value <= self.most:
            raise ValueError(f"{self.key} {value}: must be from {self.least} to {self.most}")
        QgsSettings().setValue(self.key, value)


class Settings:
    """The plugin's settings.

    API keys are in QGIS's authentication database; only the ids of their configurations are kept here.
    """

    form = _Text()
    """The dock's last entries, as JSON."""

    recent = _Text()
    """Mission files and datasets opened last, as JSON."""

    agreed = _Text()
    """Servers and files the user has agreed to, as JSON; see `remote.trust`."""

    forgotten = _Text()
    """Folders whose unfinished captures the user does not want to resume, as JSON; see `dismissed`."""

    suggested_folder = _Text()
    """Folder proposed last by the panel, which is numbered on without asking if it is taken."""

    missions_folder = _Text()
    """Default folder for missions; empty for one in the user's home."""

    backgrounds_folder = _Text()
    """Folder for rendered backgrounds; empty for one in the user's profile."""

    cache_folder = _Text()
    """Folder for cached tiles; empty for the platform's default."""

    cache_limit_mb = _Whole(4_000, 10, 10_000_000)
    """Largest size of the cache, in megabytes."""

    camera = _Text()
    """Name of the real camera chosen last."""

    connections = _Whole(8, 1, 64)
    """Most concurrent requests, as far as the provider allows."""

    plan_ending = _Text()
    """File ending of the latest plan export; empty if there is none yet."""

    plan_folder = _Text()
    """Folder of the latest plan export; empty if there is none yet."""

    vehicle = _Text()
    """Address of the vehicle that a flight was last uploaded to; empty if there is none yet."""

    placeholders = _Text()
    """SHA-256 of tiles that count as missing, separated by spaces."""

    units = _Text("m", UNITS)
    """Unit of heights in a new mission: m or ft."""

    def authcfg(self, source: str) -> str:
        """Id of a source's authentication configuration; empty if there is none."""
        name = credential_name(source)
        return str(QgsSettings().value(f"{_KEYS}/{name}", "") or "") if name else ""

    def set_authcfg(self, source: str, authcfg: str) -> None:
        """Set a source's authentication configuration; an empty id removes it."""
        name = credential_name(source)
        if name and authcfg:
            QgsSettings().setValue(f"{_KEYS}/{name}", authcfg)
        elif name:
            QgsSettings().remove(f"{_KEYS}/{name}")

    def authcfgs(self) -> dict[str, str]:
        """Ids of authentication configurations, by the `credential_name` of the source."""
        settings = QgsSettings()
        settings.beginGroup(_KEYS)
        names = settings.childKeys()
        settings.endGroup()
        found = {name: self.authcfg(name) for name in sorted(names)}
        return {name: authcfg for name, authcfg in found.items() if authcfg}

    @property
    def missing_tiles(self) -> tuple[str, ...]:
        """SHA-256 digests, or first digits, of tiles that count as missing; malformed entries are ignored."""
        return tuple(_DIGEST.findall(self.placeholders.lower()))

    def treat_as_missing(self, digest: str) -> None:
        """Count a tile as missing from now on."""
        self.placeholders = " ".join(dict.fromkeys((*self.missing_tiles, digest)))

    @property
    def dismissed(self) -> tuple[str, ...]:
        """Folders, as by `path_key`, whose unfinished captures are not offered again."""
        try:
            return tuple(map(str, parse_json(self.forgotten or "[]")))
        except (InvalidInput, TypeError):
            return ()

    def dismiss(self, folder: Path, *, again: bool = False) -> None:
        """Offer the unfinished capture of a folder no more, or ``again``."""
        key = path_key(folder)
        others = [other for other in self.dismissed if other != key]
        if again and len(others) == len(self.dismissed):
            return
        self.forgotten = json.dumps([*others, *(() if again else (key,))][-100:])

    @property
    def missions(self) -> Path:
        """Folder that contains the missions."""
        chosen = self.missions_folder
        return Path(chosen).expanduser() if chosen else self.home

    @property
    def home(self) -> Path:
        """Default folder for missions."""
        return Path.home() / "TerrAInav"

    @property
    def profile(self) -> Path:
        """Default folder for rendered backgrounds."""
        return Path(QgsApplication.qgisSettingsDirPath()) / "TerrAInav" / "backgrounds"

    @property
    def backgrounds(self) -> Path:
        """Folder for rendered backgrounds."""
        chosen = self.backgrounds_folder
        return Path(chosen).expanduser() if chosen else self.profile

    @property
    def cache(self) -> Path | None:
        """Folder of the tile cache; None for the default of the platform or environment."""
        chosen = self.cache_folder
        return Path(chosen).expanduser() if chosen and not os.environ.get("TERRAINAV_CACHE_DIR") else None

    @property
    def cache_limit_bytes(self) -> int:
        """Largest size of the tile cache."""
        return int(self.cache_limit_mb) * 1_000_000

    def tile_cache(self) -> TileCache:
        """Tile cache with these settings."""
        from ..core.imagery.cache.tile_cache import TileCache

        return TileCache(self.cache, self.cache_limit_bytes)


def credential_name(source: str) -> str:
    """Name under which a source's credentials are stored; empty if it has none.

    For an address, the name is its host, so that credentials for one host are not sent to another. Project layers,
    files and QGIS connections have no credentials here.
    """
    address = _ADDRESS.search(source)
    if address:
        host = address.group(2).rpartition("@")[2].lower()
        # Host names have up to 253 characters; placeholders of templates may add some.
        if len(host) > 1000:
            return ""
        return re.sub(r"[\w-]*(\{[^{}]*\}|\[[^\[\]]*\])[\w-]*\.?", "", host)
    known = re.fullmatch(r"[a-z0-9][a-z0-9_.:-]*", source) and not source.startswith("qgis:")
    return source if known else ""


def credential_home(source: str) -> tuple[str, str]:
    """Scheme and host for which a source's credentials are; both empty unless the source is an address."""
    address = _ADDRESS.search(source)
    if address is None:
        return "", ""
    return address.group(1).lower(), credential_name(source).partition(":")[0]


def recent() -> list[Path]:
    """Recent missions and datasets that still exist, the latest first."""
    try:
        paths = parse_json(Settings().recent or "[]")
    except InvalidInput:
        return []
    return [Path(path) for path in paths if isinstance(path, str) and exists(Path(path))]


def remember(path: Path) -> None:
    """Put a file or folder first among the recent ones."""
    others = [other for other in recent() if other != path]
    Settings().recent = json.dumps([str(path), *map(str, others)][:8])
