"""Tab that opens Processing's benchmark windows."""

from __future__ import annotations

from qgis.PyQt.QtCore import Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QVBoxLayout

from ...core.errors import TerrAInavError
from ..i18n import number_text, tr
from ..widgets import push_button, wrapped_label
from .tab import Tab


class BenchmarkTab(Tab):
    """Make a benchmark from the panel's mission, or score one.

    Signals
    -------
    make_wanted()
    score_wanted(object)
        Folder of the open benchmark; None for another dataset.
    """

    make_wanted = pyqtSignal()
    score_wanted = pyqtSignal(object)

    def __init__(self) -> None:
        super().__init__("benchmark_tab")
        self._is_benchmark = False
        self.make = push_button(
            "make_benchmark", tr("Make benchmark…"), tr("Open Processing's window with the panel's mission")
        )
        self.make.clicked.connect(lambda _checked: self.make_wanted.emit())
        self.score = push_button(
            "score_benchmark", tr("Score benchmark…"), tr("Open Processing's window with this benchmark")
        )
        self.score.clicked.connect(lambda _checked: self.score_wanted.emit(self.folder if self._is_benchmark else None))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        for text, button in (
            (
                tr(
                    "A benchmark has images from one imagery, the queries, to find in another, the "
                    "reference, with the right answers. The queries are the images of the mission in the "
                    "panel."
                ),
                self.make,
            ),
            (
                tr(
                    "To score a benchmark, run a baseline or read your own predictions: how many queries are found, "
                    "how far off they are, and where on the map."
                ),
                self.score,
            ),
        ):
            sentence = wrapped_label(f"{button.objectName()}_text")
            sentence.setText(text)
            layout.addWidget(sentence)
            layout.addWidget(button, 0, Qt.AlignmentFlag.AlignLeft)
        layout.addWidget(self.hint)
        layout.addStretch(1)
        self.show_dataset()

    def show_dataset(self) -> None:
        """Determine whether the folder is a benchmark."""
        self._is_benchmark = False
        folder = self.folder
        self.hint.setText("")
        if folder is not None:

            def queries(_: object) -> int | None:
                from ...core.benchmark.folder import Benchmark

                try:
                    return len(Benchmark.read(folder).queries)
                except TerrAInavError:
                    # The folder is another dataset.
                    return None

            self.reader.ask(queries, self._show)
        self.enable()

    def enable(self) -> None:
        """Do nothing: both windows can always be opened."""

    def _show(self, queries: int | None) -> None:
        self._is_benchmark = queries is not None
        self.hint.setText(
            tr("This folder is not a benchmark.")
            if queries is None
            else tr("This folder is a benchmark of {count} queries.").format(count=number_text(queries))
        )
