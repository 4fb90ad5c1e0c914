"""Where in the dock a mission that cannot be planned is put right."""

from __future__ import annotations

from ...core.errors import TerrAInavError
from ..i18n import tr

#: How the core's messages begin that are about one entry, and that entry.
_FIELDS = (
    ("error budget ", "error_budget_px"),
    ("picture 'map' was asked for", "frame"),
    ("picture as the camera sees it:", "source"),
    ("camera with tilt ", "tilt_deg"),
    ("camera at height ", "tilt_deg"),
    ("wind of ", "turbulence"),
)


def refused_fields(error: TerrAInavError) -> dict[str, str]:
    """Message at the field that a refusal is about; empty where it is about no single one."""
    text = str(error)
    words = {
        "raise --error-budget, or go on with --accept-error": tr(
            "raise the budget, or tick “Go on beyond the budget”"
        )
    }
    for option, entry in words.items():
        text = text.replace(option, entry)
    return next(({field: text} for beginning, field in _FIELDS if text.startswith(beginning)), {})
