"""WMTS and WMS by their capabilities: a layer of such a service becomes a source of tiles like any other.

A layer is named ``wmts:URL#layer=NAME`` or ``wms:URL#layers=NAME``: the address of the service or of its
capabilities, and after ``#`` the choices, joined by ``&``: ``style, tilematrixset, format`` of a WMTS, ``styles,
format, version`` of a WMS. What is left out is the server's default, and PNG where it is offered, because PNG
tells ground without imagery from black or white ground. A key in the address is written ``{key}``.

OWSLib reads the documents; it is needed here only.
"""

from __future__ import annotations

from ..catalogue.entry import CatalogueEntry, under_provider
from ..transport import Transport
from .capabilities import CHOICES, Offered, Service, fetched, reading
from .wms import wms_entry, wms_layers
from .wmts import wmts_entry, wmts_layers


def is_service(name: str) -> bool:
    """Whether a source is named by a WMTS or WMS."""
    return name.partition(":")[0].lower() in CHOICES and "://" in name


def names_layer(name: str) -> bool:
    """Whether a service's name says which layer is wanted."""
    return any(choice in Service.named(name).choices for choice in ("layer", "layers"))


def service_entry(
    name: str,
    *,
    key: str | None = None,
    tile_px: int | None = None,
    transport: Transport | None = None,
    named_by_user: bool = False,
) -> CatalogueEntry:
    """Entry of a layer of a WMTS or WMS, from its capabilities.

    Parameters
    ----------
    name : str
        As this module's description says.
    key : str or None
        None for that of the environment variable TERRAINAV_KEY.
    tile_px : int or None
        Size of tiles asked of a WMS; that of a WMTS is as it is.
    transport : Transport or None
        None for one of its own.
    named_by_user : bool
        As for `open_source`.

    Raises
    ------
    InvalidInput
        The name, or a choice in it, is not right; says which are.
    SourceError
        OWSLib is missing, or the capabilities cannot be had or read, or offer nothing in Web Mercator.
    """
    document = fetched(Service.named(name), key, transport, named_by_user=named_by_user)
    with reading(document):
        if document.service.kind == "wmts":
            entry = wmts_entry(name, document)
        else:
            entry = wms_entry(name, document, tile_px or 256)
    return under_provider(entry)


def layers(
    name: str,
    *,
    key: str | None = None,
    transport: Transport | None = None,
    named_by_user: bool = False,
) -> list[Offered]:
    """Layers a service offers; raises as `service_entry` does."""
    document = fetched(Service.named(name), key, transport, named_by_user=named_by_user)
    with reading(document):
        if document.service.kind == "wmts":
            return wmts_layers(document)
        return wms_layers(document)
