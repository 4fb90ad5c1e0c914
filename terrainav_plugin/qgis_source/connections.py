"""QGIS connections to tile servers as sources; read from QGIS each time."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit, urlunsplit

from qgis.core import QgsApplication, QgsOwsConnection

from ...core.errors import InvalidInput
from ...core.geodesy.mercator import HIGHEST_ZOOM
from ...core.text.plain import whole_number
from ..i18n import tr, translate

if TYPE_CHECKING:
    from ...core.imagery.entry import CatalogueEntry

#: Prefix of sources that are QGIS connections to XYZ tiles.
XYZ = "qgis:xyz/"
#: Prefix of a service in the source chooser, before its layer is chosen; missions never contain it.
SERVICE_PREFIX = "qgis:service/"
_SERVICE_KIND = "WMS"
#: Prefix of a request header in a connection's data source; the rest differs between QGIS versions.
_HEADER = "http-header:"
#: Highest zoom of a connection that states none, as in QGIS.
_USUAL_ZOOM = 18


@dataclass(frozen=True)
class Connection:
    """A connection to XYZ tiles.

    Parameters
    ----------
    name : str
        As shown in QGIS.
    url : str
        Template, with {key} in place of a key.
    key : str
        API key; empty if there is none. Never write it to a file or log.
    min_zoom, max_zoom, tile_px : int
    any_size : bool
        Whether the connection does not state its tiles' size; QGIS then draws each tile at 256 px.
    authcfg : str
        Id of its authentication configuration; empty for none.
    headers : mapping of str
        Headers sent with each request.
    """

    name: str
    url: str
    key: str = field(default="", repr=False)
    min_zoom: int = 0
    max_zoom: int = _USUAL_ZOOM
    tile_px: int = 256
    any_size: bool = False
    authcfg: str = ""
    headers: Mapping[str, str] = field(default_factory=dict)

    def entry(self) -> CatalogueEntry:
        """Catalogue entry of the tiles, with the terms of their provider if it is known.

        Raises
        ------
        InvalidInput
            The address cannot be used.
        """
        from ...core.addresses import key_parameters
        from ...core.imagery.catalogue import described
        from ...core.imagery.entry import CatalogueEntry, under_provider

        keys = key_parameters(self.url)
        if keys:
            raise InvalidInput(
                tr(
                    "QGIS connection “{name}” holds keys in its address ({keys}), which would end up in files: take "
                    "them out of it, and give it an authentication configuration in QGIS's Browser panel"
                ).format(name=self.name, keys=", ".join(keys))
            )
        try:
            data = described(
                self.url,
                title=self.name,
                min_zoom=self.min_zoom,
                max_zoom=self.max_zoom,
                tile_px=self.tile_px,
            )
            entry = under_provider(CatalogueEntry.from_dict(XYZ + self.name, data, user=True))
            return replace(entry, any_size=self.any_size)
        except InvalidInput as wrong:
            raise InvalidInput(
                tr("QGIS connection “{name}”: {problem}").format(name=self.name, problem=translate(wrong))
            ) from wrong


def is_connection(name: str) -> bool:
    """Whether a source is a QGIS connection to XYZ tiles."""
    return name.startswith(XYZ)


def connection_names() -> list[str]:
    """Names of the XYZ connections, as in QGIS's browser."""
    return [name for name, _ in _listed()]


def connection(source: str) -> Connection:
    """Connection that a source names.

    Raises
    ------
    InvalidInput
        QGIS does not have the connection (any more), or it cannot be used.
    """
    wanted = source[len(XYZ) :]
    for name, uri in _listed():
        if name == wanted:
            return parse_connection(name, uri)
    raise InvalidInput(
        tr("source {name}: QGIS has no such XYZ connection (any more); choose another source").format(name=wanted)
    )


def service_names() -> list[str]:
    """Names of the WMS and WMTS connections."""
    return sorted(QgsOwsConnection.connectionList(_SERVICE_KIND), key=str.casefold)


@dataclass(frozen=True)
class ServiceConnection:
    """A connection to a WMS or WMTS.

    Parameters
    ----------
    name : str
    address : str
        URL, with {key} in place of a key.
    key : str
    authcfg : str
    """

    name: str
    address: str
    key: str = field(default="", repr=False)
    authcfg: str = ""


def service(name: str) -> ServiceConnection:
    """Connection of the given name, one of `service_names`."""
    uri = QgsOwsConnection(_SERVICE_KIND, name).uri()
    address, key = without_key(uri.param("url"))
    return ServiceConnection(name, address.rstrip("?&"), key, uri.authConfigId())


def without_key(url: str) -> tuple[str, str]:
    """Address with its key replaced by {key}, and the key; ``url`` and an empty text unless it has exactly one key."""
    from ...core.addresses import is_key_name

    parts = urlsplit(url)
    pieces = re.split(r"([&;])", parts.query)
    held = [
        at
        for at, piece in enumerate(pieces)
        if "=" in piece and is_key_name(piece.partition("=")[0]) and "{key}" not in piece
    ]
    # With several candidates the key is unknown; `Connection.entry` refuses them.
    if len(held) != 1 or "{key}" in url:
        return url, ""
    name, _, value = pieces[held[0]].partition("=")
    pieces[held[0]] = f"{name}={{key}}"
    return urlunsplit(parts._replace(query="".join(pieces))), unquote(value)


def _listed() -> list[tuple[str, str]]:
    """Name and data source of each connection."""
    for provider in QgsApplication.dataItemProviderRegistry().providers():
        # The browser folder of XYZ connections.
        if provider.name() == "XYZ Tiles":
            root = provider.createDataItem("", None)
            if root is not None:
                found = [(item.name(), item.uri()) for item in root.createChildren()]
                return sorted(found, key=lambda one: one[0].casefold())
    return []


def parse_connection(name: str, uri: str) -> Connection:
    """Connection from a QGIS data source; raises InvalidInput if it cannot be used."""
    options = {key: unquote(value) for key, _, value in (part.partition("=") for part in uri.split("&"))}
    if options.get("username") or options.get("password"):
        raise InvalidInput(
            tr(
                "QGIS connection “{name}” holds a user name and password in plain text: give it an "
                "authentication configuration in QGIS's Browser panel"
            ).format(name=name)
        )
    headers = {key[len(_HEADER) :]: value for key, value in options.items() if key.startswith(_HEADER)}
    if options.get("referer"):
        headers["referer"] = options["referer"]
    # QGIS decodes encoded spaces.
    url, key = without_key(options.get("url", "").replace(" ", "%20"))
    least, most = (_zoom(options.get(end, ""), usual) for end, usual in (("zmin", 0), ("zmax", _USUAL_ZOOM)))
    tile_px = {"1": 256, "2": 512}.get(options.get("tilePixelRatio", ""))
    headers = {name.title(): value for name, value in headers.items() if value}
    return Connection(
        name,
        url,
        key,
        min(least, most),
        most,
        tile_px or 256,
        tile_px is None,
        options.get("authcfg", ""),
        headers,
    )


def _zoom(text: str, usual: int) -> int:
    stated = whole_number(text)
    return usual if stated is None else min(stated, HIGHEST_ZOOM)
