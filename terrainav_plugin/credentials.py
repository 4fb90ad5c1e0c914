"""Keys and passwords, kept in QGIS's authentication database only."""

from __future__ import annotations

from qgis.core import QgsApplication, QgsAuthMethodConfig

from .i18n import tr

#: Authentication methods whose configurations can hold a key.
_BASIC, _HEADER = "Basic", "APIHeader"


def read_key(authcfg: str) -> str | None:
    """API key: the password of a Basic configuration, or the value of an API header; None if there is no key.

    Main thread only: QGIS may ask for the master password.
    """
    if not authcfg:
        return None
    config = QgsAuthMethodConfig()
    loaded, config = QgsApplication.authManager().loadAuthenticationConfig(authcfg, config, True)
    if not loaded:
        return None
    if config.method() == _HEADER:
        return next((value for value in config.configMap().values() if value), None)
    return config.config("password") or None


def credential_problem(authcfg: str, is_key: bool) -> str:
    """Reason why a run cannot use a configuration; empty if it can. Main thread only.

    Parameters
    ----------
    authcfg : str
        Id of the configuration; empty if none is chosen.
    is_key : bool
        Whether the configuration must hold a key; otherwise it authenticates requests.
    """
    manager = QgsApplication.authManager()
    if not authcfg:
        return tr("API key: choose a configuration, or press “+” and enter it as password") if is_key else ""
    if manager.isDisabled():
        return tr("QGIS's authentication database cannot be used: {reason}").format(reason=manager.disabledMessage())
    if authcfg not in manager.configIds():
        return tr("authentication configuration {id} does not exist (any more): choose another").format(id=authcfg)
    # Let QGIS ask for the master password now, as the user may be away during the run.
    if not manager.setMasterPassword(True):
        return tr("QGIS's authentication database is locked: press Capture again and enter its master password")
    if is_key and read_key(authcfg) is None:
        return tr("authentication configuration {id} holds no key: choose a Basic one with the key as password").format(
            id=authcfg
        )
    return ""


def store_key(title: str, key: str) -> str:
    """Store a key in QGIS's authentication database, and return the configuration's id; empty if the user refuses.

    Main thread only: QGIS may ask for the master password.
    """
    manager = QgsApplication.authManager()
    if manager.isDisabled() or not manager.setMasterPassword(True):
        return ""
    config = QgsAuthMethodConfig(_BASIC)
    config.setName(tr("TerrAInav: {title}").format(title=title))
    config.setConfig("username", "key")
    config.setConfig("password", key)
    return config.id() if manager.storeAuthenticationConfig(config) else ""
