"""Labels over an image: which, how opaque, their colours, and what is under the mouse."""

from __future__ import annotations

import html

from qgis.PyQt.QtCore import QPointF, Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QComboBox, QHBoxLayout, QSlider, QVBoxLayout, QWidget

from ...core.mission.parts import CLASSES, INSTANCES
from ..dataset.overlay import IGNORE_COLOUR, LabelOverlay, LegendEntry
from ..i18n import number_text, tr
from ..picture_view import PictureView
from ..plain import plain_label
from ..widgets import named, wrapped_label

#: Classes listed in the legend; the largest come first.
_MOST_LISTED = 20
#: Smallest opacity of the slider, which is still visible, and that at first, in per cent.
_LEAST, _FIRST = 10, 50


class LabelsPane(QWidget):
    """Choice of labels and their opacity, legend, and the label under the mouse; hidden if there are no labels.

    Parameters
    ----------
    picture : PictureView
        View of the image over which labels are drawn.

    Signals
    -------
    wanted(str)
        The user wants to see a product of labels; an empty text for none.

    Attributes
    ----------
    choice : QComboBox
    opacity : QSlider
    legend, here : QLabel
        Colours of the classes in the image with their shares; text on the labels under the mouse.
    """

    wanted = pyqtSignal(str)

    def __init__(self, picture: PictureView) -> None:
        super().__init__()
        self._picture = picture
        self._labels: LabelOverlay | None = None
        self.choice = named(QComboBox(), "shown_labels", tr("Labels drawn over the image"))
        self.choice.activated.connect(lambda index: self.wanted.emit(self.choice.itemData(index)))
        self.opacity = named(QSlider(Qt.Orientation.Horizontal), "label_opacity", tr("Opacity of the labels"))
        self.opacity.setRange(_LEAST, 100)
        self.opacity.setValue(_FIRST)
        self.opacity.valueChanged.connect(self._draw)
        self.legend = wrapped_label("label_legend")
        self.legend.setTextFormat(Qt.TextFormat.RichText)
        self.here = named(plain_label(), "label_here")
        self.here.setAlignment(Qt.AlignmentFlag.AlignCenter)
        picture.pointed.connect(self._point)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        choices = QHBoxLayout()
        choices.addWidget(self.choice)
        choices.addWidget(self.opacity, 1)
        layout.addLayout(choices)
        layout.addWidget(self.legend)
        layout.addWidget(self.here)
        self.show_labels((), "", None)

    def show_labels(self, offered: tuple[str, ...], shown: str, labels: LabelOverlay | None) -> None:
        """Show the labels of an image.

        Parameters
        ----------
        offered : tuple of str
            Products of labels that the dataset has; without any, the pane is hidden.
        shown : str
            The one that is shown; empty for none.
        labels : LabelOverlay or None
        """
        self._labels = labels
        self.setVisible(bool(offered))
        self.choice.clear()
        titles = {"": tr("No labels"), CLASSES: tr("Classes"), INSTANCES: tr("Instances")}
        for product in ("", *offered):
            self.choice.addItem(titles[product], product)
        self.choice.setCurrentIndex(max(self.choice.findData(shown), 0))
        self.opacity.setVisible(labels is not None and labels.image is not None)
        self.legend.setText("" if labels is None else _legend_html(labels, shown))
        self.legend.setVisible(labels is not None)
        self.here.setVisible(self.opacity.isVisibleTo(self))
        self._draw()
        self._point(None)

    def _draw(self) -> None:
        image = None if self._labels is None else self._labels.image
        self._picture.lay_over(image, self.opacity.value() / 100.0)

    def _point(self, at: QPointF | None) -> None:
        if self._labels is None:
            return
        if at is None:
            self.here.setText(tr("Point at the image to see its labels"))
            return
        self.here.setText(self._labels.text_at(at.x(), at.y()) or tr("Background here"))


def _legend_html(labels: LabelOverlay, shown: str) -> str:
    """Legend of the labels in an image, or why they cannot be read."""
    if labels.problem:
        return html.escape(labels.problem)
    parts = [_entry_html(one) for one in labels.legend[:_MOST_LISTED]] if shown == CLASSES else []
    more = len(labels.legend) - _MOST_LISTED
    if parts and more > 0:
        parts.append(html.escape(tr("and {count} more classes").format(count=number_text(more))))
    if shown == INSTANCES:
        parts.append(html.escape(tr("{count} instances in this image").format(count=number_text(labels.count))))
    return " &nbsp; ".join(parts)


def _entry_html(one: LegendEntry) -> str:
    """Square in the colour of a class, its name and share, kept on one line."""
    # White is not visible on most panels.
    square = "&#9633;" if one.colour == IGNORE_COLOUR else f"<span style='color:{one.colour}'>&#9632;</span>"
    percent = 100.0 * one.share
    # A class that is there is not shown as 0.0 %.
    share = number_text(percent, ".1f") if percent >= 0.05 else f"< {number_text(0.1, '.1f')}"
    text = tr("{name} {share} %").format(name=one.name, share=share)
    return f"{square}&nbsp;" * bool(one.colour) + html.escape(text).replace(" ", "&nbsp;")
