"""Which groups of the dock a person has folded, kept from one session to the next."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.core import QgsSettings
from qgis.gui import QgsCollapsibleGroupBoxBasic

_KEY = "TerrAInav/folded/{name}"


class Folds:
    """Remembers what is folded and unfolded by hand, by the names of the groups."""

    def __init__(self, boxes: Sequence[QgsCollapsibleGroupBoxBasic]) -> None:
        self._boxes = boxes
        self._restored = False
        for box in boxes:
            box.collapsedStateChanged.connect(
                lambda folded, box=box: QgsSettings().setValue(_KEY.format(name=box.objectName()), folded)
            )

    def restore(self) -> None:
        """Fold as it was when the last session ended; once, as soon as the entries are those of that session."""
        if self._restored:
            return
        self._restored = True
        settings = QgsSettings()
        for box in self._boxes:
            key = _KEY.format(name=box.objectName())
            if settings.contains(key):
                box.setCollapsed(settings.value(key, box.isCollapsed(), type=bool))
