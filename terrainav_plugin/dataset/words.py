"""What cleaning has done, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..i18n import tr
from .clean_task import UNDO

if TYPE_CHECKING:
    from ...core.dataset.clean import Cleaned


def cleaned_text(deed: str, cleaned: Sequence[Cleaned]) -> str:
    """Sentence about all map types."""
    images, rejected, moved, returned = (
        f"{sum(values):,}"
        for values in zip(*((one.images, one.rejected, one.moved, one.returned) for one in cleaned))
    )
    if deed == UNDO:
        return tr("{rejected} images are no longer marked, {returned} moved back.").format(
            rejected=rejected, returned=returned
        )
    text = tr("{rejected} of {images} images are marked as rejected.").format(
        rejected=rejected, images=images
    )
    if any(one.moved for one in cleaned):
        text += " " + tr("{moved} moved away.").format(moved=moved)
    if any(one.returned for one in cleaned):
        text += " " + tr("{returned} moved back.").format(returned=returned)
    return text
