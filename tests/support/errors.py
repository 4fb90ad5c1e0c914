"""Expected errors of TerrAInav, compared by their parts and not by their wording."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from terrainav.core.errors import InvalidInput, TerrAInavError


@contextmanager
def refused(
    template: str, *values: object, field: str = "", kind: type[TerrAInavError] = InvalidInput
) -> Iterator[pytest.ExceptionInfo[TerrAInavError]]:
    """Expect an error with a kind, a field, a template and, if any are given, values."""
    with pytest.raises(kind) as caught:
        yield caught
    error = caught.value
    assert (error.message.template, error.field) == (template, field)
    assert not values or error.message.values == values
