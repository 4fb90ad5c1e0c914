"""Colours of what is kept and what is rejected: in the charts, below the pictures and on the map."""

from __future__ import annotations

from qgis.PyQt.QtGui import QColor

#: To be told apart with any colour vision, on light and dark windows and over imagery.
KEPT = QColor(42, 134, 220)
REJECTED = QColor(230, 40, 150)
