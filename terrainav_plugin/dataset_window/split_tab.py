"""Tab for dividing images into training, validation and test parts."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from qgis.PyQt.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QVBoxLayout

from ...core.dataset.folder import AUTO, PARTS, SEED, SHARES
from ..dataset.splitting import (
    HIGHEST_SEED,
    UTM,
    WIDEST_M,
    Line,
    frames,
    helps,
    outcome,
    parts,
    split_methods,
    titles,
    undone_text,
)
from ..i18n import number_text, tr
from ..widgets import (
    NumberBox,
    combo,
    first_problem,
    growing_form,
    push_button,
    spin,
    tick,
    whole_spin,
    wrapped_label,
)
from .tab import Tab, no_folder
from .tasks import SplitTask, UndoSplitTask, Work

_SHARE_DECIMALS = 2
#: Methods with blocks and a gap between them.
_BY_GROUND = (AUTO, "blocks")


class Counts(NamedTuple):
    """Number of images by part, None before a split; and whether there is a split to undo, even an interrupted one."""

    images: int
    of_parts: dict[str, int] | None
    can_undo: bool


def read_counts(folder: Path) -> Counts:
    """Count the images of the first map type by their part in the table; raises InvalidInput."""
    from ...core.dataset.dataset import read_dataset
    from ...core.dataset.labels import LABELS_FILE
    from ...core.dataset.table import image_parts, usable_rows
    from ...core.storage.stores import is_file

    dataset = read_dataset(folder)
    table = next(iter(dataset.image_sets.values())).table
    usable, part = usable_rows(table), image_parts(table)
    if part is None:
        return Counts(int(usable.sum()), None, is_file(dataset.folder / LABELS_FILE))
    mine = [one for one, is_usable in zip(part, usable.tolist()) if is_usable]
    return Counts(len(mine), {name: mine.count(name) for name in PARTS}, True)


class SplitTab(Tab):
    """Entries of a split, as in Processing, and the result of the split."""

    def __init__(self, work: Work) -> None:
        super().__init__("split_tab")
        self._work = work
        self._known = self._can_undo = False
        self._make_entries()
        self.state = wrapped_label("split_state")
        self.result = wrapped_label("split_result")
        self.split = push_button(
            "split", tr("Split"), tr("Write the part of each image to the tables, and labels.json")
        )
        self.split.clicked.connect(lambda _checked: self._split())
        self.undo = push_button("undo_split", tr("Undo split"), helps()["undo"])
        self.undo.clicked.connect(lambda _checked: self._undo())
        self._lay_out()
        self.show_dataset()

    def show_dataset(self) -> None:
        """Read the current split."""
        self._known = self._can_undo = False
        self.result.setText("")
        folder = self.folder
        if folder is None:
            self.state.setText(no_folder())
        else:
            self.state.setText(tr("Reading {name}…").format(name=folder.name))
            self._read()
        self.enable()

    def _read(self) -> None:
        folder = self.folder
        self.reader.ask(lambda _: read_counts(folder), self._show_counts)

    def show_refused(self, reason: str) -> None:
        """Show why the dataset cannot be split."""
        self._known = self._can_undo = False
        self.state.setText(reason)
        self.enable()

    def options(self) -> tuple[tuple[float, ...], dict[str, Any]]:
        """Shares and the other entries, as arguments of `split`."""
        by_ground = self.how.currentData() in _BY_GROUND
        frame = self.frame.currentText().strip()
        known = self.frame.findText(frame)
        return tuple(round(self.shares[part].value(), _SHARE_DECIMALS) for part in PARTS), {
            "how": self.how.currentData(),
            "seed": self.seed.value(),
            "block_m": self.block.number() if by_ground else None,
            "gap_m": self.gap.value() if by_ground else 0.0,
            "frame": frame if known < 0 else self.frame.itemData(known),
            "dry_run": self.dry_run.isChecked(),
        }

    def enable(self) -> None:
        """Enable the actions that are possible now."""
        self.split.setEnabled(self._known and not self.working)
        self.undo.setEnabled(self._can_undo and not self.working)
        by_ground = self.how.currentData() in _BY_GROUND
        for widget in (self.block, self.gap):
            widget.setEnabled(by_ground)

    def _show_counts(self, counts: Counts) -> None:
        self._known, self._can_undo = True, counts.can_undo
        if counts.of_parts is None:
            text = tr("Not split yet: {count} images.").format(count=number_text(counts.images))
        else:
            each = ", ".join(f"{title} {number_text(counts.of_parts[part])}" for part, title in parts().items())
            text = tr("Parts now: {parts}.").format(parts=each)
            rest = counts.images - sum(counts.of_parts.values())
            if rest:
                text += " " + tr("{count} images in no part.").format(count=number_text(rest))
        self.state.setText(text)
        self.enable()

    def _split(self) -> None:
        problem = first_problem(self)
        if problem:
            self.show_result(problem)
        elif self.folder is not None:
            shares, options = self.options()
            self._work.start(SplitTask(self.folder, shares, options), self._done, self._refused)

    def _undo(self) -> None:
        if self.folder is not None:
            self._work.start(UndoSplitTask(self.folder), self._undone, self._refused)

    def _undone(self, task: UndoSplitTask) -> None:
        self._read()
        if task.undone is not None:
            self.show_result(undone_text(task.undone))

    def _refused(self, reason: str) -> None:
        self.show_result(reason)
        self._read()

    def _done(self, task: SplitTask) -> None:
        self._read()
        if task.made is None:
            self.show_result(tr("Stopped: nothing was changed."))
            return
        first = (
            tr("Only counted, nothing was changed: {how}.")
            if task.options["dry_run"]
            else tr("Written to the tables: {how}.")
        )
        how = split_methods()[task.made.how]
        if task.made.blocks is not None:
            how = tr("{count} blocks with sides of {side} m").format(
                count=number_text(task.made.blocks), side=number_text(task.made.block_m, ",.0f")
            )
        lines = [Line(first.format(how=how)), *outcome(task.made)]
        self.show_result("\n".join(f"⚠ {line.text}" if line.warns else line.text for line in lines))

    def show_result(self, text: str) -> None:
        """Show the result, or why the split failed."""
        self.result.setText(text)

    def _make_entries(self) -> None:
        text = helps()
        self.how = combo("split_how", list(split_methods().items()), text["how"])
        self.how.currentIndexChanged.connect(lambda _index: self.enable())
        self.shares: dict[str, NumberBox] = {}
        for part, share in zip(PARTS, SHARES):
            box = spin(f"share_{part}", 0.0, 1.0, _SHARE_DECIMALS, "", text[part])
            box.setSingleStep(0.05)
            box.setStepType(box.StepType.DefaultStepType)
            box.setValue(share)
            self.shares[part] = box
        self.seed = whole_spin("split_seed", 0, HIGHEST_SEED, text["seed"])
        self.seed.setValue(SEED)
        self.block = spin("split_block", 0.0, WIDEST_M, 1, "", text["block"])
        self.block.is_optional = True
        self.block.setSpecialValueText(tr("automatic"))
        self.gap = spin("split_gap", 0.0, WIDEST_M, 1, "", text["gap"])
        self.frame = combo("split_frame", [(value, title) for value, title in frames().items()], text["frame"])
        self.frame.setEditable(True)
        self.frame.setInsertPolicy(self.frame.InsertPolicy.NoInsert)
        self.frame.setCurrentIndex(self.frame.findData(UTM))
        self.dry_run = tick("split_dry_run", titles()["dry_run"], text["dry_run"])

    def _lay_out(self) -> None:
        form = growing_form()
        title = titles()
        # Below each other, as the names of methods are long.
        label = QLabel(title["how"])
        label.setBuddy(self.how)
        form.addRow(label)
        form.addRow(self.how)
        shares = QGridLayout()
        for column, part in enumerate(PARTS):
            label = QLabel(title[part])
            label.setWordWrap(True)
            label.setBuddy(self.shares[part])
            shares.addWidget(label, 0, column)
            shares.addWidget(self.shares[part], 1, column)
        form.addRow(shares)
        _add(form, title["seed"], self.seed)
        _add(form, title["block"], self.block)
        _add(form, title["gap"], self.gap)
        _add(form, title["frame"], self.frame)
        buttons = QHBoxLayout()
        buttons.addWidget(self.dry_run)
        buttons.addStretch(1)
        buttons.addWidget(self.undo)
        buttons.addWidget(self.split)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addWidget(self.state)
        layout.addLayout(form)
        layout.addLayout(buttons)
        layout.addWidget(self.result)
        layout.addStretch(1)


def _add(form: Any, title: str, widget: Any) -> None:
    label = QLabel(title)
    label.setBuddy(widget)
    form.addRow(label, widget)
