"""Base class of sources from services of any kind."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

from ...errors import SourceError
from ..entry import CatalogueEntry, under_provider
from ..opening import EntrySource
from ..policy import Policy
from ..tiles import KEY_ENV, environment_key
from .capabilities import Document, Offered, Service, reading


class ServiceSource(EntrySource):
    """A layer of a service of any kind, as a mission names it."""

    @cached_property
    def service(self) -> Service:
        """Service and choices; raises InvalidInput for an invalid text."""
        return Service.named(self.text)

    @property
    def needs_key(self) -> bool:
        """Whether the address contains {key}."""
        return "{key}" in self.text

    @property
    def stated_policy(self) -> Policy | None:
        """None, as only the service states the terms."""
        return None

    def layers(self) -> list[Offered] | None:
        """Layers to choose from if a layer is needed and none is named; otherwise None."""
        document = self._document()
        with reading(document):
            return self._layers(document)

    def _find(self) -> CatalogueEntry:
        """Entry of the layer, with the terms of its provider if these are known.

        Raises
        ------
        InvalidInput
            The text or a choice in it is invalid; the error lists the valid choices.
        SourceError
            The documents cannot be fetched or read, or offer no usable tiles.
        """
        document = self._document()
        with reading(document):
            return under_provider(self._entry(document))

    @abstractmethod
    def _document(self) -> Document:
        """Fetch the document at the service's address."""

    @abstractmethod
    def _layers(self, document: Document) -> list[Offered] | None:
        """Layers in a document; None if no layer has to be named."""

    @abstractmethod
    def _entry(self, document: Document) -> CatalogueEntry:
        """Entry of the wanted layer."""

    def environment_key(self) -> str | None:
        """Return the environment's key if the host may receive it."""
        return environment_key([self.service.host], named_by_user=self.options.named_by_user)

    @property
    def key(self) -> str:
        """Key for the address; empty if it needs none. Raises SourceError if the key is missing."""
        if not self.needs_key:
            return ""
        key = self.options.key or self.environment_key()
        if not key:
            raise SourceError("{0}: needs an API key: set the environment variable {1}", self.service.host, KEY_ENV)
        return key
