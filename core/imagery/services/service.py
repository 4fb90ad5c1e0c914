"""The base of all kinds of services: a layer as a mission names it."""

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
        """Whether its address contains {key}."""
        return "{key}" in self.text

    @property
    def stated_policy(self) -> Policy | None:
        """None: the documents of the service state its terms."""
        return None

    def layers(self) -> list[Offered] | None:
        """Layers to choose from, where a layer is needed and none is named."""
        document = self._document()
        with reading(document):
            return self._layers(document)

    def _find(self) -> CatalogueEntry:
        """Entry of the layer, under its provider's terms where those are known.

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
        """Layers in a document; None where no layer has to be named."""

    @abstractmethod
    def _entry(self, document: Document) -> CatalogueEntry:
        """Entry of the wanted layer."""

    def environment_key(self) -> str | None:
        """Return the environment's key, if it is for its host."""
        return environment_key([self.service.host], named_by_user=self.options.named_by_user)

    @property
    def key(self) -> str:
        """Key for the address; empty where it needs none. Raises SourceError where it is missing."""
        if not self.needs_key:
            return ""
        key = self.options.key or self.environment_key()
        if not key:
            raise SourceError("{0}: needs an API key: set the environment variable {1}", self.service.host, KEY_ENV)
        return key
