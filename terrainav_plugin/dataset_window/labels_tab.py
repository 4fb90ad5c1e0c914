"""Tab that shows images of a dataset with their training data (part of the split, label and depth)."""

from __future__ import annotations

from functools import partial

import numpy as np
from qgis.PyQt.QtCore import QRect, QSignalBlocker, QSize, Qt
from qgis.PyQt.QtGui import QImage, QPainter, QPaintEvent, QPixmap
from qgis.PyQt.QtWidgets import QBoxLayout, QFrame, QHBoxLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from ...core.dataset.table import GAP
from ..dataset.picture import Depth, legend_image
from ..dataset.splitting import parts
from ..form.fields import map_type_title
from ..i18n import number_text, tr, translate
from ..widgets import combo, named, push_button, wrapped_label
from .previews import ALL, REJECTED_ONES, DatasetTables, ImagePreview
from .tab import Tab, no_folder

#: Images per page.
COUNT = 4
_IMAGE_PX = (150, 112)
_SCALE_PX = 10


class LabelsTab(Tab):
    """Show a few images of the dataset at a time."""

    def __init__(self) -> None:
        super().__init__("labels_tab")
        self.learned: DatasetTables | None = None
        self.first = 0
        self.map_type = combo("labels_map_type", [], tr("Map type shown here"))
        self.map_type.activated.connect(lambda _index: self._choose_map_type())
        self.of = combo("labels_of", [], tr("Which images are shown: all, or those of a part of the split"))
        self.of.activated.connect(lambda _index: self._show_page(0))
        self.previous = push_button("labels_previous", tr("< Previous"), tr("Images before these"))
        self.next = push_button("labels_next", tr("Next >"), tr("Images after these"))
        self.previous.clicked.connect(lambda _checked: self._show_page(self.first - COUNT))
        self.next.clicked.connect(lambda _checked: self._show_page(self.first + COUNT))
        self.place = wrapped_label("labels_place")
        self.cards = [Card(number) for number in range(COUNT)]
        self._lay_out()
        self.show_dataset()

    def show_dataset(self) -> None:
        """Read the tables."""
        self.learned, self.first = None, 0
        self._clear()
        folder = self.folder
        if folder is None:
            self.hint.setText(no_folder())
        else:
            self.hint.setText(tr("Reading {name}…").format(name=folder.name))
            self.reader.ask(lambda _: DatasetTables(folder), self._show_learned)
        self.hint.show()
        self.enable()

    def enable(self) -> None:
        """Enable the buttons of pages with images."""
        total = self._total()
        self.map_type.setEnabled(self.learned is not None)
        self.of.setEnabled(self.learned is not None)
        self.previous.setEnabled(self.first > 0)
        self.next.setEnabled(self.first + COUNT < total)

    def _total(self) -> int:
        if self.learned is None or self.map_type.currentData() is None:
            return 0
        return self.learned.counts(self.map_type.currentData()).get(self.of.currentData(), 0)

    def _show_learned(self, learned: DatasetTables) -> None:
        self.learned = learned
        self.hint.setText(self._describe_labels(learned))
        with QSignalBlocker(self.map_type):
            before = self.map_type.currentData()
            self.map_type.clear()
            for name in learned.map_types:
                self.map_type.addItem(map_type_title(name), name)
            self.map_type.setCurrentIndex(max(self.map_type.findData(before), 0))
        self._choose_map_type()

    def _describe_labels(self, learned: DatasetTables) -> str:
        if learned.fault is not None:
            return translate(learned.fault)
        if learned.labels is None:
            return tr("No labels yet: a split writes them.")
        return tr(
            "A label is the position of the image's centre, scaled by labels.json: metres in {frame} "
            "minus the mean, in standard deviations of {count} images."
        ).format(frame=learned.labels.frame.crs, count=number_text(learned.labels.images))

    def _choose_map_type(self) -> None:
        """Offer the parts that have images of the chosen map type."""
        titles = {ALL: tr("All"), **parts(), GAP: tr("In no part (gap)"), REJECTED_ONES: tr("Rejected")}
        before = self.of.currentData()
        counts = self.learned.counts(self.map_type.currentData())
        with QSignalBlocker(self.of):
            self.of.clear()
            for name, count in counts.items():
                self.of.addItem(f"{titles[name]} ({number_text(count)})", name)
            self.of.setCurrentIndex(max(self.of.findData(before), 0))
        self._show_page(0)

    def _show_page(self, first: int) -> None:
        learned = self.learned
        self.first = max(first, 0)
        total = self._total()
        if learned is None or not total:
            self._clear()
            self.place.setText(tr("No images."))
            self.enable()
            return
        chosen = self.map_type.currentData(), self.of.currentData(), self.first
        longest_px = round(max(_IMAGE_PX) * self.devicePixelRatioF())
        self.place.setText(
            tr("{first} to {last} of {total}").format(
                first=number_text(self.first + 1),
                last=number_text(min(self.first + COUNT, total)),
                total=number_text(total),
            )
        )
        self.reader.ask(lambda _: learned.previews(*chosen, COUNT, longest_px), partial(self._show_cards, learned))
        self.enable()

    def _show_cards(self, learned: DatasetTables, previews: list[ImagePreview]) -> None:
        for at, card in enumerate(self.cards):
            card.setVisible(at < len(previews))
            if at < len(previews):
                card.show_preview(previews[at], learned.is_split)

    def _clear(self) -> None:
        self.place.setText("")
        for card in self.cards:
            card.hide()
        for box in (self.map_type, self.of):
            with QSignalBlocker(box):
                box.clear()

    def _lay_out(self) -> None:
        line = QHBoxLayout()
        for title, box in ((tr("Map type"), self.map_type), (tr("Images"), self.of)):
            label = QLabel(title)
            label.setBuddy(box)
            line.addWidget(label)
            line.addWidget(box, 1)
        steps = QHBoxLayout()
        steps.addWidget(self.previous)
        steps.addWidget(self.next)
        steps.addWidget(self.place, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addLayout(line)
        layout.addWidget(self.hint)
        for card in self.cards:
            layout.addWidget(card)
        layout.addStretch(1)
        layout.addLayout(steps)


class Card(QFrame):
    """An image, its depth if any, and its data."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.setObjectName(f"card_{number}")
        self.image, self.depth_image = (
            _ImageLabel(f"card_image_{number}"),
            _ImageLabel(f"card_depth_{number}"),
        )
        self.scale = DepthScale(f"card_scale_{number}")
        self.name, self.text = wrapped_label(f"card_name_{number}"), wrapped_label(f"card_text_{number}")
        beside = QVBoxLayout()
        beside.setSpacing(1)
        beside.addWidget(self.depth_image)
        beside.addWidget(self.scale)
        beside.addStretch(1)
        pictures = QHBoxLayout()
        pictures.addWidget(self.image, 0, Qt.AlignmentFlag.AlignTop)
        pictures.addLayout(beside)
        pictures.addStretch(1)
        self._contents = QBoxLayout(QBoxLayout.Direction.LeftToRight)
        self._contents.addLayout(pictures)
        self._contents.addWidget(self.text, 1, Qt.AlignmentFlag.AlignTop)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        layout.addWidget(self.name)
        layout.addLayout(self._contents)

    def show_preview(self, preview: ImagePreview, is_split: bool) -> None:
        """Show an image of a dataset."""
        self.image.show_image(preview.picture.image)
        depth = preview.depth
        seen = depth is not None and depth.image is not None
        self.depth_image.setVisible(seen)
        self.scale.setVisible(seen)
        # In the narrow dock, two pictures leave no room for the text beside them.
        below, right = QBoxLayout.Direction.TopToBottom, QBoxLayout.Direction.LeftToRight
        self._contents.setDirection(below if seen else right)
        if seen:
            self.depth_image.show_image(depth.image)
            self.scale.show_depth(depth)
        self.name.setText(preview.name)
        self.text.setText("\n".join(_lines(preview, is_split)))
        self.image.setAccessibleName(preview.name)


def _lines(preview: ImagePreview, is_split: bool) -> list[str]:
    """Data of an image, one item per line."""
    lines = [preview.picture.problem] if preview.picture.problem else []
    if is_split:
        part = {**parts(), GAP: tr("none (gap)")}.get(preview.part, tr("none"))
        lines.append(tr("Part: {part}").format(part=part))
    if preview.label is not None:
        east, north = (number_text(one, "+.3f") for one in preview.label)
        lines.append(tr("Label: easting {east}, northing {north}").format(east=east, north=north))
    if not np.isnan(preview.entropy):
        lines.append(tr("Entropy: {bits} bits").format(bits=number_text(preview.entropy, ".3f")))
    lines.append(tr("Rejected: {reason}").format(reason=preview.rejected) if preview.rejected else tr("Not rejected"))
    if preview.depth is not None and preview.depth.problem:
        lines.append(preview.depth.problem)
    return lines


class _ImageLabel(QLabel):
    """An image in a space of fixed size."""

    def __init__(self, name: str) -> None:
        super().__init__()
        named(self, name)
        self.setFixedSize(QSize(*_IMAGE_PX))
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)

    def show_image(self, image: QImage | None) -> None:
        """Show a whole image, reduced to fit; None clears it."""
        if image is None:
            self.clear()
            return
        ratio = self.devicePixelRatioF()
        pixmap = QPixmap.fromImage(
            image.scaled(
                QSize(*_IMAGE_PX) * ratio,
                Qt.AspectRatioMode.KeepAspectRatio,
                Qt.TransformationMode.SmoothTransformation,
            )
        )
        pixmap.setDevicePixelRatio(ratio)
        self.setPixmap(pixmap)


class DepthScale(QWidget):
    """Colour scale of a depth map from near to far, with its limits in metres."""

    def __init__(self, name: str) -> None:
        super().__init__()
        named(self, name, tr("Depth along the optical axis, in colours on a logarithmic scale"))
        self.texts: list[str] = []
        self.setFixedWidth(_IMAGE_PX[0])
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        """Room for the colours and the texts below them, which are stacked if they do not fit side by side."""
        lines = 1 if self._fits() else len(self.texts)
        return QSize(_IMAGE_PX[0], _SCALE_PX + lines * self.fontMetrics().height() + 1)

    def show_depth(self, depth: Depth) -> None:
        """Show the limits of a depth."""
        ends = (depth.least_m, depth.most_m)
        self.texts = (
            [tr("no ground")]
            if np.isnan(ends[0])
            else [tr("{depth} m").format(depth=number_text(one, ",.4g" if one < 1e4 else ",.0f")) for one in ends]
        )
        self.setAccessibleName(tr("Depth: {range}").format(range=" – ".join(self.texts)))
        self.updateGeometry()
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: ARG002  Qt passes it
        """Paint."""
        painter = QPainter(self)
        painter.drawImage(QRect(0, 0, self.width(), _SCALE_PX), legend_image(max(self.width(), 2)))
        painter.setPen(self.palette().windowText().color())
        high, fits = self.fontMetrics().height(), self._fits()
        sides = (Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight)
        for line, (text, side) in enumerate(zip(self.texts, sides)):
            top = _SCALE_PX + 1 + (0 if fits else line * high)
            painter.drawText(QRect(0, top, self.width(), high), int(side | Qt.AlignmentFlag.AlignTop), text)

    def _fits(self) -> bool:
        """Whether the texts fit side by side."""
        wide = sum(self.fontMetrics().horizontalAdvance(f"{text} ") for text in self.texts)
        return wide <= _IMAGE_PX[0]
