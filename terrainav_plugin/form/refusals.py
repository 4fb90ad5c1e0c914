"""Where the dock says what the core refuses: at the entry in which it is put right."""

from __future__ import annotations

from ...core.errors import TerrAInavError
from ..i18n import translate
from .mission_form import entry_of


def refused_fields(error: TerrAInavError) -> dict[str, str]:
    """Message at the entry that a refusal is about; empty where it is about no single one."""
    entry = entry_of(error.field) if error.field else ""
    return {entry: translate(error)} if entry else {}
