"""The entries of what is written: folder and format."""

from __future__ import annotations

from qgis.gui import QgsFileWidget

from ..i18n import tr
from ..widgets import FieldMarks, combo
from .entries import Entries


class OutputEntries(Entries):
    """Group of the output."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("output", tr("Output"), marks)
        self.folder = QgsFileWidget()
        self.folder.setObjectName("folder")
        self.folder.setStorageMode(QgsFileWidget.StorageMode.GetDirectory)
        self.folder.setDialogTitle(tr("Folder for the pictures"))
        self.folder.setToolTip(tr("Folder for the pictures; its last part names the mission on the map"))
        # A label's key goes to what is typed into.
        self.folder.setFocusProxy(self.folder.lineEdit())
        self.add("folder", tr("Folder"), self.folder)
        formats = (
            ("tif", tr("GeoTIFF (lossless)")),
            ("jpg", tr("JPEG (smaller)")),
            ("png", tr("PNG")),
        )
        tip = tr("Format of the pictures; all three know their coordinate reference system")
        self.image_format = combo("image_format", formats, tip)
        self.add("image_format", tr("Format"), self.image_format)
