"""A layer of a service as a mission names it, whatever kind of service that is."""

from __future__ import annotations

from functools import cached_property

from ...errors import SourceError
from ..opening import EntrySource
from ..policy import Policy
from ..tiles import KEY_ENV, environment_key
from .capabilities import Service


class ServiceSource(EntrySource):
    """A layer of a service as a mission names it, whatever kind of service that is."""

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
        """None: the service states its terms with what it tells of itself."""
        return None

    def environment_key(self) -> str | None:
        """Return the environment's key, if that is for its host."""
        return environment_key([self.service.host], named_by_user=self.options.named_by_user)

    @property
    def key(self) -> str:
        """Key that the address needs; empty where it needs none. Raises SourceError where it is not there."""
        if not self.needs_key:
            return ""
        key = self.options.key or self.environment_key()
        if not key:
            raise SourceError(
                "{0}: needs an API key: set the environment variable {1}", self.service.host, KEY_ENV
            )
        return key
