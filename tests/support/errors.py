"""What an error of TerrAInav's is about, compared by its parts and not by its wording."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from terrainav.core.errors import InvalidInput, TerrAInavError


@contextmanager
def refused(
    template: str, *values: object, field: str = "", kind: type[TerrAInavError] = InvalidInput
) -> Iterator[pytest.ExceptionInfo[TerrAInavError]]:
    """Expect an error of a kind, about a field, of a template, and of these values where some are given."""
    with pytest.raises(kind) as caught:
        yield caught
    error = caught.value
    assert (error.message.template, error.field) == (template, field)
    assert not values or error.message.values == values
