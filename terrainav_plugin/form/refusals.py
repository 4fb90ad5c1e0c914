"""What the core says of a mission, at the entry where it is put right and in the panel's own words."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from ...core.errors import InvalidInput, TerrAInavError
from ..i18n import tr, translate
from .mission_form import entry_of

if TYPE_CHECKING:
    pass

#: An option of the command, as the core's advice names it.
_OPTION = re.compile(r"--[a-z][a-z-]*")


def refused_fields(error: TerrAInavError) -> dict[str, str]:
    """Message at the entry that a refusal is about; empty where it is about no single one."""
    entry = entry_of(error.field) if isinstance(error, InvalidInput) and error.field else ""
    return {entry: in_words_of_the_panel(error)} if entry else {}


def in_words_of_the_panel(message: object) -> str:
    """Message of the core that names entries of the dock instead of options of the command."""
    names = {
        "--error-budget": tr("Error budget"),
        "--accept-error": tr("Go on beyond the budget"),
        "--upsample": tr("Allow enlarged pixels"),
        "--image-px": tr("Image's longer side"),
        "--max-px": tr("Longest side"),
        "--zoom": tr("Zoom"),
        "--gsd": tr("Source's ground per px"),
        "--img-size": tr("Resize pictures"),
        "--layout": tr("Layout"),
        "--date": tr("Date"),
    }
    elsewhere = tr("“Most images” of the algorithm “Plan a mission”, or max_images in the mission's file")
    text = translate(message).replace("--max-images", elsewhere)
    for option in sorted(set(_OPTION.findall(text)) - set(names), key=len, reverse=True):
        # What the dock has no entry for is no advice here.
        text = re.sub(rf" ?\({option}\)", "", text)
    return _OPTION.sub(lambda option: tr("“{entry}”").format(entry=names.get(option[0], option[0])), text)
