"""What the plugin remembers between sessions, as typed properties over QGIS's settings."""

from __future__ import annotations

from pathlib import Path

from qgis.core import QgsApplication, QgsSettings

_ROOT = "TerrAInav/"


class _Text:
    """A setting that is a text."""

    def __init__(self, default: str = "") -> None:
        self.default = default

    def __set_name__(self, owner: type, name: str) -> None:
        self.key = _ROOT + name

    def __get__(self, instance: object, owner: type) -> str:
        return str(QgsSettings().value(self.key, self.default) or "")

    def __set__(self, instance: object, value: str) -> None:
        QgsSettings().setValue(self.key, value)


class Settings:
    """The plugin's settings.

    An API key itself is never here: it lives in QGIS's authentication database, and only the id of its
    configuration is kept.
    """

    form = _Text()
    """The dock's last entries, as JSON."""

    backgrounds_folder = _Text()
    """Where rendered backgrounds are kept; empty for a folder of the user's profile."""

    def authcfg(self, source: str) -> str:
        """Id of the authentication configuration that holds the key of a source; empty for none."""
        return str(QgsSettings().value(f"{_ROOT}authcfg/{source}", "") or "")

    def set_authcfg(self, source: str, authcfg: str) -> None:
        """Remember which authentication configuration holds the key of a source."""
        QgsSettings().setValue(f"{_ROOT}authcfg/{source}", authcfg)

    @property
    def backgrounds(self) -> Path:
        """Folder for rendered backgrounds."""
        chosen = self.backgrounds_folder
        return (
            Path(chosen)
            if chosen
            else Path(QgsApplication.qgisSettingsDirPath()) / "TerrAInav" / "backgrounds"
        )
