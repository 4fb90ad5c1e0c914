"""Texts about a split, for forms and Processing: choices, ranges and results. No widgets."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ...core.dataset.folder import AUTO, FRAMES, PARTS
from ..i18n import number_text, tr

if TYPE_CHECKING:
    from ...core.dataset.split import Split, UndoneSplit

HIGHEST_SEED = 2**31 - 1
#: Largest block, and largest gap, in metres.
WIDEST_M = 1_000_000.0
UTM, *_ = FRAMES


class Line(NamedTuple):
    """A line of text, and whether it is a warning."""

    text: str
    warns: bool = False


def split_methods() -> dict[str, str]:
    """Methods of splitting, with titles."""
    return {
        AUTO: tr("Automatic: blocks where images overlap"),
        "shuffled": tr("Shuffled"),
        "in-order": tr("In the order of the table"),
        "blocks": tr("Blocks of ground"),
    }


def frames() -> dict[str, str]:
    """Named frames of labels, with titles."""
    return {
        UTM: tr("UTM zone of the middle"),
        "mercator": tr("Web Mercator"),
        "mission": tr("Plane about the middle"),
    }


def parts() -> dict[str, str]:
    """Parts of a dataset, with titles."""
    return dict(zip(PARTS, (tr("Training"), tr("Validation"), tr("Test"))))


def titles() -> dict[str, str]:
    """Labels of the entries of a split."""
    return {
        "how": tr("Splitting method"),
        "train": tr("Share of training"),
        "validation": tr("Share of validation"),
        "test": tr("Share of test"),
        "seed": tr("Seed"),
        "block": tr("Block size (metres)"),
        "gap": tr("Gap between parts (metres)"),
        "frame": tr("Frame of the labels"),
        "dry_run": tr("Only count"),
        "undo": tr("Undo the last split"),
    }


def helps() -> dict[str, str]:
    """Help for the entries of a split."""
    shares = tr("The three shares add up to 1.")
    return {
        "how": tr(
            "By a hash of seed and name, in the table's order, or by blocks of ground, as overlapping images need."
        ),
        "train": shares,
        "validation": shares,
        "test": shares,
        "seed": tr("The same seed gives the same split."),
        "block": tr("With blocks only. If empty, a size is found that gives parts close to the shares."),
        "gap": tr("With blocks only: minimum distance between the ground of two parts."),
        "frame": tr("utm, mercator, mission, or a projected system in metres such as EPSG:32616."),
        "dry_run": tr("Nothing is changed."),
        "undo": tr("Restores the parts and labels before the last split, or removes both if there were none."),
    }


def outcome(made: Split) -> list[Line]:
    """Shares reached by a split, number of images in no part, and warnings."""
    lines = [
        Line(
            tr("{part}: {images} images ({share} %).").format(
                part=title,
                images=number_text(made.images[part]),
                share=number_text(100.0 * made.shares[part], ".1f"),
            )
        )
        for part, title in parts().items()
    ]
    if made.gap:
        lines.append(
            Line(
                tr("{images} images are in no part: too near to another part's ground.").format(
                    images=number_text(made.gap)
                )
            )
        )
    if made.unknown:
        text = tr("{images} images are in no part: they see the horizon or a pole.")
        lines.append(Line(text.format(images=number_text(made.unknown)), warns=True))
    if made.seen:
        text = tr("{share} % of the test images see ground of the training part: blocks leave none.")
        lines.append(Line(text.format(share=number_text(100.0 * made.seen, ".1f")), warns=True))
    zones = made.labels.frame.zones
    if len(zones) > 1:
        text = tr("The images lie in {count} UTM zones ({zones}); one frame covers them all: {frame}.")
        lines.append(
            Line(text.format(count=len(zones), zones=", ".join(zones), frame=made.labels.frame.crs), warns=True)
        )
    return lines


def undone_text(undone: UndoneSplit) -> str:
    """Sentence about a split that was undone."""
    if not undone.changed:
        return tr("Nothing to undo: the dataset is not split.")
    if undone.parts is None:
        return tr("The split is undone: the images are in no part, and there are no labels.")
    each = ", ".join(f"{title} {number_text(undone.parts[part])}" for part, title in parts().items())
    return tr("The split is undone. Parts before it: {parts}.").format(parts=each)
