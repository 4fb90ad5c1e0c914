"""Settings that the plugin keeps between sessions, as typed properties over QGIS's settings."""

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
from .paths import exists

if TYPE_CHECKING:
    from ..core.imagery.cache.tile_cache import TileCache

_ROOT = "TerrAInav/"
_KEYS = f"{_ROOT}authcfg"
UNITS = tuple(LENGTHS_M)
_ADDRESS = re.compile(r"(https?)://([^/?#]*)", re.IGNORECASE)
#: As `Placeholder` takes them.
_DIGEST = re.compile(r"\b[0-9a-f]{16,64}\b")


class _Text:
    """A setting that is a text; ``choices`` are those it may be, empty for any."""

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
    """A setting that is a whole number of a range; what is not, in the file of settings, counts as the default."""

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

    An API key itself is never here: it lives in QGIS's authentication database, and only the id of its
    configuration is kept.
    """

    form = _Text()
    """The dock's last entries, as JSON."""

    recent = _Text()
    """Mission files and datasets opened last, as JSON."""

    agreed = _Text()
    """Servers and files that the user has agreed to, as JSON; see `remote.trust`."""

    suggested_folder = _Text()
    """Folder that the panel has proposed last: it counts on where it is taken, and nobody is asked."""

    missions_folder = _Text()
    """Where missions are captured to by default; empty for a folder of the user's home."""

    backgrounds_folder = _Text()
    """Where rendered backgrounds are kept; empty for a folder of the user's profile."""

    cache_folder = _Text()
    """Where tiles are kept for later runs; empty for the platform's own place."""

    cache_limit_mb = _Whole(4_000, 10, 10_000_000)
    """Most that the cache may take, in megabytes."""

    connections = _Whole(8, 1, 64)
    """Requests under way at once, where the provider allows so many."""

    plan_ending = _Text()
    """Ending of the plan that was exported last; empty for none yet."""

    placeholders = _Text()
    """SHA-256 of tiles that count as missing, with spaces between them."""

    units = _Text("m", UNITS)
    """Unit of heights in a mission that begins: m or ft."""

    def authcfg(self, source: str) -> str:
        """Id of the authentication configuration of a source; empty for none."""
        name = credential_name(source)
        return str(QgsSettings().value(f"{_KEYS}/{name}", "") or "") if name else ""

    def set_authcfg(self, source: str, authcfg: str) -> None:
        """Remember which authentication configuration is a source's; empty for none."""
        name = credential_name(source)
        if name and authcfg:
            QgsSettings().setValue(f"{_KEYS}/{name}", authcfg)
        elif name:
            QgsSettings().remove(f"{_KEYS}/{name}")

    def authcfgs(self) -> dict[str, str]:
        """Ids of authentication configurations by what `credential_name` calls their sources."""
        settings = QgsSettings()
        settings.beginGroup(_KEYS)
        names = settings.childKeys()
        settings.endGroup()
        found = {name: self.authcfg(name) for name in sorted(names)}
        return {name: authcfg for name, authcfg in found.items() if authcfg}

    @property
    def missing_tiles(self) -> tuple[str, ...]:
        """SHA-256, or first digits of it, of tiles that count as missing; what is none, in the file, is left out."""
        return tuple(_DIGEST.findall(self.placeholders.lower()))

    def treat_as_missing(self, digest: str) -> None:
        """Have a tile count as missing from now on."""
        self.placeholders = " ".join(dict.fromkeys((*self.missing_tiles, digest)))

    @property
    def missions(self) -> Path:
        """Folder below which missions are captured."""
        chosen = self.missions_folder
        return Path(chosen).expanduser() if chosen else self.home

    @property
    def home(self) -> Path:
        """Folder for missions where none is chosen."""
        return Path.home() / "TerrAInav"

    @property
    def profile(self) -> Path:
        """Folder for rendered backgrounds where none is chosen."""
        return Path(QgsApplication.qgisSettingsDirPath()) / "TerrAInav" / "backgrounds"

    @property
    def backgrounds(self) -> Path:
        """Folder for rendered backgrounds."""
        chosen = self.backgrounds_folder
        return Path(chosen).expanduser() if chosen else self.profile

    @property
    def cache(self) -> Path | None:
        """Folder of the tile cache; None for the platform's own, or that of the environment."""
        chosen = self.cache_folder
        return Path(chosen).expanduser() if chosen and not os.environ.get("TERRAINAV_CACHE_DIR") else None

    @property
    def cache_limit_bytes(self) -> int:
        """Most that the cache may take."""
        return int(self.cache_limit_mb) * 1_000_000

    def tile_cache(self) -> TileCache:
        """Cache of tiles."""
        from ..core.imagery.cache.tile_cache import TileCache

        return TileCache(self.cache, self.cache_limit_bytes)


def credential_name(source: str) -> str:
    """Name that a source's credentials go by.

    Addresses go by their host, so that credentials given for one are not sent to another. Layers of the project, files
    and connections of QGIS have none here.
    """
    address = _ADDRESS.search(source)
    if address:
        host = address.group(2).rpartition("@")[2].lower()
        # Host names have up to 253 characters; templates add braces.
        if len(host) > 1000:
            return ""
        return re.sub(r"[\w-]*(\{[^{}]*\}|\[[^\[\]]*\])[\w-]*\.?", "", host)
    known = re.fullmatch(r"[a-z0-9][a-z0-9_.:-]*", source) and not source.startswith("qgis:")
    return source if known else ""


def credential_home(source: str) -> tuple[str, str]:
    """Scheme and host that a source's credentials are for; empty for a source that is no address."""
    address = _ADDRESS.search(source)
    if address is None:
        return "", ""
    return address.group(1).lower(), credential_name(source).partition(":")[0]


def recent() -> list[Path]:
    """Those that are still there, the latest first."""
    try:
        paths = parse_json(Settings().recent or "[]")
    except InvalidInput:
        return []
    return [Path(path) for path in paths if isinstance(path, str) and exists(Path(path))]


def remember(path: Path) -> None:
    """Put a file or folder to the front."""
    others = [other for other in recent() if other != path]
    Settings().recent = json.dumps([str(path), *map(str, others)][:8])
