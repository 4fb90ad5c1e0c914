"""WMTS and WMS by their capabilities: a layer of such a service becomes a source of tiles like any other.

A layer is named ``wmts:URL#layer=NAME`` or ``wms:URL#layers=NAME``: the address of the service or of its
capabilities, and after ``#`` the choices, joined by ``&``: ``style, tilematrixset, format`` of a WMTS, ``styles,
format, version`` of a WMS. What is left out is the server's default, and PNG where it is offered, because PNG
tells ground without imagery from black or white ground. A key in the address is written ``{key}``.

OWSLib reads the documents; it is needed here only.
"""

from __future__ import annotations

from functools import cached_property

from ...errors import SourceError
from ..entry import CatalogueEntry, under_provider
from ..opening import EntrySource
from ..policy import Policy
from ..template import KEY_ENV, environment_key
from .capabilities import Document, Offered, Service, fetched, reading
from .wms import wms_entry, wms_layers
from .wmts import wmts_entry, wmts_layers


class ServiceLayer(EntrySource):
    """A layer of a WMTS or WMS as a mission names it."""

    @cached_property
    def service(self) -> Service:
        """The service and what is wanted of it; raises InvalidInput where the text is not right."""
        return Service.named(self.text)

    @property
    def needs_key(self) -> bool:
        """Whether a key stands in its address."""
        return "{key}" in self.text

    @property
    def stated_policy(self) -> Policy | None:
        """None: the service states its terms with its capabilities."""
        return None

    def environment_key(self) -> str | None:
        """Return the environment's key, if that is for its host."""
        return environment_key([self.service.host], named_by_user=self.options.named_by_user)

    def layers(self) -> list[Offered] | None:
        """Layers that the service offers, where none is named yet."""
        if "layer" in self.service.choices or "layers" in self.service.choices:
            return None
        document = self._document()
        with reading(document):
            return wmts_layers(document) if self.service.kind == "wmts" else wms_layers(document)

    def _find(self) -> CatalogueEntry:
        """Entry of the layer, from the capabilities, under its provider's terms where those are known.

        Raises
        ------
        InvalidInput
            The text, or a choice in it, is not right; says which are.
        SourceError
            OWSLib is missing, or the capabilities cannot be had or read, or offer nothing in Web Mercator.
        """
        document = self._document()
        with reading(document):
            if self.service.kind == "wmts":
                entry = wmts_entry(self.text, document)
            else:
                entry = wms_entry(self.text, document, self.options.tile_px or 256)
        return under_provider(entry)

    def _document(self) -> Document:
        key = None
        if self.needs_key:
            key = self.options.key or self.environment_key()
            if not key:
                raise SourceError(
                    "{0}: needs an API key: set the environment variable {1}", self.service.host, KEY_ENV
                )
        return fetched(self.service, key or "", self.options.transport)
