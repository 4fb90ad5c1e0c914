"""Split a dataset into training, validation and test parts.

A hash of the seed and the image's name decides, so the split is the same on every machine and with every version of
every library, and does not depend on pixels.
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Flags, Numbers
from ..errors import Cancelled, InvalidInput, Message
from ..limits import MAX_SETTINGS_BYTES, MAX_TABLE_BYTES
from ..storage.files import json_bytes, read_existing, remove_file, write_whole
from ..storage.stores import is_file
from ..text.safe_json import parse_json
from .clean import locked_folder
from .dataset import Dataset, ImageSet, read_dataset
from .entropy import Report
from .folder import AUTO, PARTS, SEED, SHARES, TABLE_FILE, TEST, TRAIN, WAYS
from .ground import (
    GroundBoxes,
    assign_blocks,
    assign_parts,
    assign_strips,
    deviation,
    find_close,
    ground_boxes,
    largest_side_m,
)
from .labels import LABELS_FILE, Labels, is_unfinished, make_dataset_labels, mark_unfinished, middle_position
from .table import GAP, SPLIT, Table, image_parts, usable_rows

#: File in a dataset's folder with the parts and labels before the last split.
EARLIER_FILE = "earlier_split.json"


@dataclass(frozen=True)
class Split:
    """Result of a split, or of a dry run.

    Parameters
    ----------
    images : mapping of str to int
        Number of places in each part; a place has one image of each map type.
    gap : int
        Places in no part, as their ground overlaps that of another part or is too close to it.
    unknown : int
        Places in no part (also ``gap`` in the table), as their ground is unknown: images that see the horizon or a
        pole, or do not come from a map.
    left_out : int
        Places whose images have failed or have been rejected.
    block_m, gap_m : float or None
        Side of the blocks and minimum distance between parts; None without blocks.
    blocks : int or None
        Number of blocks.
    seen : float or None
        Share of the test's places whose ground a training image shows, too; None without a test part or if the ground
        is unknown.
    labels : Labels
        Frame and scaler of the labels, as saved.
    """

    images: Mapping[str, int]
    gap: int
    unknown: int
    left_out: int
    how: str
    seed: int
    block_m: float | None
    gap_m: float | None
    blocks: int | None
    seen: float | None
    labels: Labels

    @property
    def shares(self) -> dict[str, float]:
        """Shares of the parts reached, among the places in any part."""
        return {part: count / sum(self.images.values()) for part, count in self.images.items()}


def split(
    folder: str | os.PathLike[str],
    shares: Sequence[float] = SHARES,
    *,
    seed: int = SEED,
    how: str = AUTO,
    block_m: float | None = None,
    gap_m: float = 0.0,
    frame: str = "utm",
    dry_run: bool = False,
    progress: Report | None = None,
) -> Split:
    """Write the part of each image to a dataset's tables (column ``split``), and the frame and scaler of its labels.

    Images of one place are in the same part in all map types and imageries (see `folder.place_key`). Failed and
    rejected images are in no part. An earlier split is replaced; `undo_split` restores it. After an interruption,
    `Labels.load` refuses the labels until the dataset is split again or the split is undone.

    Parameters
    ----------
    folder : path
        Dataset.
    shares : sequence of three floats
        Shares of training, validation and test, which add up to 1; any may be 0.
    seed : int
        Seed of the order.
    how : {"auto", "shuffled", "in-order", "blocks"}
        ``shuffled`` orders images by the hash of seed and name, ``in-order`` as in the table. ``blocks`` orders blocks
        of ground by their hashes, and no two parts show the same ground. ``auto`` is ``blocks`` if images overlap, else
        ``shuffled``.
    block_m : float or None
        Side of the blocks; None chooses one.
    gap_m : float
        Smallest distance between the ground of two parts, with blocks.
    frame : str
        Frame of the labels (see `labels.choose_frame`).
    dry_run : bool
        Change no files.
    progress : callable
        Called with the share done, 0 to 1; returning False stops the split before anything is changed.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    InvalidInput
        The folder is not a dataset, a table disagrees with the files, or the split is impossible. Nothing is changed
        then.
    OutputError
        Another run works in the folder, or a file cannot be written.
    """
    wanted = _check(shares, how, block_m, gap_m)
    with locked_folder(folder, only_read=dry_run):
        dataset = read_dataset(folder)
        sets, place = list(dataset.image_sets.values()), dataset.place_key()
        _report(progress, 0.3)
        places = _places(sets, place)
        if not places:
            raise InvalidInput(
                "folder {0}: has no image that is there and not rejected, so there is nothing to split",
                folder,
            )
        boxes = _known_ground(dataset.folder, sets, places, needed=how == "blocks")
        _report(progress, 0.6)
        if how == AUTO:
            how = "blocks" if block_m is not None or gap_m or (boxes is not None and _do_overlap(boxes)) else "shuffled"
        block_side: float | None = None
        count: int | None = None
        unknown = 0
        if how == "blocks":
            of_place, block_side, count, unknown = _split_ground(
                dataset.folder, boxes, places, wanted, seed, block_m, float(gap_m)
            )
        else:
            order = shuffle(places, seed) if how == "shuffled" else list(places)
            of_place = dict(zip(order, assign_counts(len(order), wanted)))
        tables = [_add_parts(images, of_place, place) for images in sets]
        labels = make_dataset_labels(tables, frame)
        _report(progress, 0.8)
        if not dry_run:
            _keep_earlier(dataset, tables, labels)
            # Tables are written one by one: until the last one, the parts of map types may differ.
            mark_unfinished(dataset.folder / LABELS_FILE)
            for images, table in zip(sets, tables):
                table.save(images.folder / TABLE_FILE)
            labels.save(dataset.folder / LABELS_FILE)
    parts = list(of_place.values())
    everything = {place(name) for images in sets for name in images.table.img_names}
    return Split(
        images={part: parts.count(part) for part in PARTS},
        gap=parts.count(GAP) - unknown,
        unknown=unknown,
        left_out=len(everything) - len(places),
        how=how,
        seed=seed,
        block_m=block_side,
        gap_m=float(gap_m) if how == "blocks" else None,
        blocks=count,
        seen=None if boxes is None else _seen_share([of_place[name] for name in places], boxes),
        labels=labels,
    )


@dataclass(frozen=True)
class UndoneSplit:
    """Result of `undo_split`.

    Parameters
    ----------
    changed : bool
        Whether there was a split.
    parts : mapping of str to int, or None
        Number of images of the first map type in each part of the earlier split, which is back; None without one.
    """

    changed: bool
    parts: Mapping[str, int] | None


def undo_split(folder: str | os.PathLike[str], *, dry_run: bool = False) -> UndoneSplit:
    """Undo the last split: restore the parts and the labels of the one before, or remove both if there was none.

    An interrupted split can be undone, too, and an interrupted undoing repeated.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, or the record of the earlier split cannot be read. Nothing is changed then.
    OutputError
        Another run works in the folder, or a file cannot be written.
    """
    with locked_folder(folder, only_read=dry_run):
        dataset = read_dataset(folder)
        sets, labels = list(dataset.image_sets.values()), dataset.folder / LABELS_FILE
        earlier = _read_earlier(dataset.folder)
        changed = is_file(labels) or any(SPLIT in images.table.other for images in sets)
        tables = [_restored(one.table, earlier["parts"].get(name)) for name, one in dataset.image_sets.items()]
        if changed and not dry_run:
            mark_unfinished(labels)
            for images, table in zip(sets, tables):
                table.save(images.folder / TABLE_FILE)
            if earlier["labels"] is None:
                remove_file(labels)
            else:
                write_whole(labels, earlier["labels"].encode("utf-8"))
            remove_file(dataset.folder / EARLIER_FILE)
    parts = image_parts(tables[0])
    return UndoneSplit(changed, None if parts is None else {part: parts.count(part) for part in PARTS})


def _keep_earlier(dataset: Dataset, tables: Sequence[Table], new: Labels) -> None:
    """Record the current parts and labels for `undo_split`, unless the split leaves them as they are."""
    path, labels = dataset.folder / EARLIER_FILE, read_existing(dataset.folder / LABELS_FILE, MAX_SETTINGS_BYTES)
    if is_unfinished(labels) and is_file(path):
        # The record is of the state before the interrupted split.
        return
    parts = {name: image_parts(images.table) for name, images in dataset.image_sets.items()}
    if labels == new.to_json().encode("utf-8") and list(parts.values()) == [image_parts(table) for table in tables]:
        return
    text = None if labels is None or is_unfinished(labels) else labels.decode("utf-8", "replace")
    write_whole(path, json_bytes({"labels": text, "parts": parts}))


def _read_earlier(folder: Path) -> dict[str, Any]:
    """Read the labels and the parts before the last split; raises InvalidInput."""
    path = folder / EARLIER_FILE
    try:
        data = read_existing(path, MAX_TABLE_BYTES)
        found = {"labels": None, "parts": {}} if data is None else parse_json(data)
        labels, parts = found["labels"], found["parts"]
        whole = isinstance(labels, (str, type(None))) and isinstance(parts, dict)
        if not whole or not all(
            one is None or (isinstance(one, list) and all(cell in ("", *PARTS, GAP) for cell in one))
            for one in parts.values()
        ):
            raise ValueError(Message("not an earlier split"))
    except (KeyError, TypeError, ValueError, OSError) as wrong:
        raise InvalidInput("{0}: cannot be read ({1})", path, wrong) from wrong
    return dict(found)


def _restored(table: Table, parts: list[str] | None) -> Table:
    """Table with earlier parts; without parts if there are none, or none for each row."""
    others = {header: cells for header, cells in table.other.items() if header != SPLIT}
    known = parts is not None and len(parts) == len(table)
    return table.replace_other({**others, SPLIT: tuple(parts or ())} if known else others)


def _report(progress: Report | None, share: float) -> None:
    """Report the share done; raise Cancelled if asked to stop."""
    if progress is not None and not progress(share):
        raise Cancelled("stopped while images were split: nothing was changed")


def shuffle(names: Sequence[str] | Mapping[str, object], seed: int | str = SEED) -> list[str]:
    """Sort names by the SHA-256 of ``seed:name``, which is the same everywhere."""
    return sorted(names, key=lambda name: hashlib.sha256(f"{seed}:{name}".encode()).digest())


def checked_shares(shares: Sequence[float]) -> tuple[float, float, float]:
    """Return shares of training, validation and test; raises InvalidInput unless three add up to 1."""
    listed = ", ".join(f"{share:g}" for share in shares)
    if len(shares) != len(PARTS):
        raise InvalidInput("shares {0}: must be three, of {1}", listed, ", ".join(PARTS))
    if not all(math.isfinite(share) and share >= 0.0 for share in shares):
        raise InvalidInput("shares {0}: must be finite and not below 0", listed)
    # Decimal shares add up to 1 within rounding.
    if abs(math.fsum(shares) - 1.0) > 1e-9:
        raise InvalidInput("shares {0}: add up to {1:g}; must add up to 1", listed, math.fsum(shares))
    train, validation, test = map(float, shares)
    return train, validation, test


def _check(shares: Sequence[float], how: str, block_m: float | None, gap_m: float) -> tuple[float, float, float]:
    wanted = checked_shares(shares)
    if how not in WAYS:
        raise InvalidInput("split {0!r}: must be one of {1}", how, ", ".join(WAYS))
    if how not in ("blocks", AUTO) and (block_m is not None or gap_m):
        raise InvalidInput(
            "split {0!r}: has no blocks and no gap", how, remedy="choose blocks, or leave their sizes out"
        )
    if block_m is not None and not (math.isfinite(block_m) and block_m > 0.0):
        raise InvalidInput("blocks of {0} m: must be above 0 m", block_m)
    # Beyond that, the sine of the gap's angle no longer measures distances.
    widest_m = 1_000_000.0
    if not 0.0 <= gap_m <= widest_m:
        raise InvalidInput("gap of {0} m: must be from 0 to {1:,.0f} m", gap_m, widest_m)
    return wanted


def _places(sets: Sequence[ImageSet], place: Callable[[str], str]) -> dict[str, list[tuple[int, int]]]:
    """Map type and row of the usable images of each place, in the tables' order."""
    places: dict[str, list[tuple[int, int]]] = {}
    for number, images in enumerate(sets):
        for row in np.flatnonzero(usable_rows(images.table)).tolist():
            places.setdefault(place(images.table.img_names[row]), []).append((number, row))
    return places


def assign_counts(count: int, shares: Sequence[float]) -> list[str]:
    """Parts (count,) in order, with sizes by largest remainder and at least 1 for shares above 0.

    Raises InvalidInput if there are fewer images than parts.
    """
    asked = [part for part, share in zip(PARTS, shares) if share > 0.0]
    if count < len(asked):
        raise InvalidInput(
            "split into {0}: needs {1} images or more; the dataset has {2}",
            ", ".join(asked),
            len(asked),
            count,
        )
    exact = [round(share * count, 6) for share in shares]
    counts = [math.floor(one) for one in exact]
    by_remainder = sorted(range(len(exact)), key=lambda one: (counts[one] - exact[one], one))
    for one in by_remainder[: count - sum(counts)]:
        counts[one] += 1
    for one, share in enumerate(shares):
        if share > 0.0 and not counts[one]:
            counts[counts.index(max(counts))] -= 1
            counts[one] = 1
    return [part for part, size in zip(PARTS, counts) for _ in range(size)]


def _known_ground(
    folder: Path, sets: Sequence[ImageSet], places: Mapping[str, list[tuple[int, int]]], *, needed: bool
) -> GroundBoxes | None:
    """Boxes of the ground of each place; None if all are unknown, or cannot be computed and are not needed."""
    try:
        boxes = _ground(folder, sets, places)
    except InvalidInput:
        if needed:
            raise
        return None
    return boxes if boxes.known.any() else None


def _do_overlap(boxes: GroundBoxes) -> bool:
    """Whether two images share more ground than neighbours do by rounding."""
    known = boxes.take(boxes.known)
    # Rounded to pixels, neighbours share less than 1 % of their side.
    across, up = (known.east_u - known.west_u) * 0.01, (known.north_deg - known.south_deg) * 0.01
    inner = GroundBoxes(known.west_u + across, known.east_u - across, known.south_deg + up, known.north_deg - up)
    number = np.arange(len(inner.west_u))
    # Any two numbers differ in at least one binary digit.
    for digit in range(len(number).bit_length()):
        one = number >> digit & 1 == 1
        if one.any() and find_close(inner.take(one), inner.take(~one), 0.0).any():
            return True
    return False


def _seen_share(parts: Sequence[str], boxes: GroundBoxes) -> float | None:
    """Share of the test's places with known ground whose ground a training image shows; None without such places."""
    part = np.array(parts)
    test, train = (boxes.take(boxes.known & (part == one)) for one in (TEST, TRAIN))
    if not len(test.west_u):
        return None
    return float(find_close(test, train, 0.0).mean()) if len(train.west_u) else 0.0


def _split_ground(
    folder: Path,
    boxes: GroundBoxes | None,
    places: Mapping[str, list[tuple[int, int]]],
    shares: tuple[float, float, float],
    seed: int,
    block_m: float | None,
    gap_m: float,
) -> tuple[dict[str, str], float, int, int]:
    """Part of each place, side and number of the blocks, and number of places with unknown ground."""
    if boxes is None:
        raise InvalidInput(
            "folder {0}: the ground that its images show is not known (they see the horizon, or come "
            "from no map), so there are no blocks of it",
            folder,
            remedy="split shuffled or in-order",
        )
    known = boxes.known
    names = [name for name, is_known in zip(places, known.tolist()) if is_known]
    part, side, count = split_blocks(boxes.take(known), names, shares, seed, block_m, gap_m)
    if block_m is None and gap_m == 0.0 and part.count(GAP) > len(part) / 2:
        raise _too_close(boxes.take(known), shares)
    of_known = dict(zip(names, part))
    return {name: of_known.get(name, GAP) for name in places}, side, count, int((~known).sum())


def split_blocks(
    boxes: GroundBoxes,
    names: Sequence[str],
    shares: tuple[float, float, float],
    seed: int = SEED,
    block_m: float | None = None,
    gap_m: float = 0.0,
    counted: Flags | None = None,
) -> tuple[list[str], float, int]:
    """Part of each box, or `GAP`, such that no ground is in two parts; also the side and number of the blocks.

    Parameters
    ----------
    boxes : GroundBoxes
        Boxes (n,) of known ground.
    names : sequence of str
        Distinct names of the boxes. With the seed, their hashes give the order of the blocks.
    shares, seed, block_m, gap_m
        As for `split`.
    counted : bool array (n,) or None
        Boxes that the shares are of, such as the queries among the tiles of a benchmark; None for all.

    Raises
    ------
    InvalidInput
        A part would be empty.
    """
    if counted is None:
        counted = np.ones(len(names), np.bool_)
    base, is_default = largest_side_m(boxes) + gap_m, block_m is None and gap_m == 0.0
    best: _Division | None = None
    # Sides to try, relative to the longest image side and the gap. Larger blocks lose fewer images to the gap, so the
    # first side is taken that comes within 2 % of the shares, or else the one that comes closest; without a gap, of
    # those that leave half of the images or more in parts.
    sides = [times * base for times in (16.0, 12.0, 8.0, 6.0, 4.0, 3.0, 2.0, 1.5, 1.0, 0.75, 0.5)]
    asked_sides = sides if block_m is None else [float(block_m)]
    for made in _divisions(boxes, names, shares, seed, asked_sides, gap_m, counted):
        best = made if best is None or made.rank < best.rank else best
        if best.rank <= (False, False, 0.02):
            break
    if is_default and (best is None or any(best.rank[:2])):
        # Over little ground, three strips side by side have the shortest borders, or other blocks fit better.
        more = _strips(boxes, shares, seed, gap_m, counted)
        for other in range(1, 25):
            more = chain(more, _divisions(boxes, names, shares, f"{seed}.{other}", sides, gap_m, counted))
        for made in more:
            best = made if best is None or made.rank < best.rank else best
            if not any(best.rank[:2]):
                break
    if best is None and is_default and int(counted.sum()) > len(PARTS):
        raise _too_close(boxes, shares)
    if best is None:
        tried = Message("blocks of {0:g} m", block_m) if block_m is not None else Message("blocks")
        asked = ", ".join(part for part, share in zip(PARTS, shares) if share > 0.0)
        raise InvalidInput(
            "split by {0}: {1} images up to {2:.0f} m wide with a gap of {3:g} m leave one of {4} without images",
            tried,
            len(names),
            base - gap_m,
            gap_m,
            asked,
            remedy="choose a smaller gap, other blocks or shares, a dataset of more ground, or split shuffled"
            if gap_m > 0.0
            else "choose other blocks or shares, a dataset of more ground, or split shuffled",
        )
    return [PARTS[one] if one >= 0 else GAP for one in best.part.tolist()], best.side_m, best.blocks


def _too_close(boxes: GroundBoxes, shares: Sequence[float]) -> InvalidInput:
    """Error for images of which no blocks leave half in parts, with the length of ground that would."""
    widest_m = largest_side_m(boxes)
    # Of strips, each border between two loses the images that reach across it.
    borders = sum(share > 0.0 for share in shares) - 1
    return InvalidInput(
        "split by blocks: most of {0:,} images up to {1:,.0f} m wide would be in no part, as they show the same ground",
        len(boxes.west_u),
        widest_m,
        remedy=Message(
            "take an area {0:,.0f} m long or more, smaller images or less overlap, or split shuffled",
            widest_m * (1.0 + 2.0 * borders),
        ),
    )


class _Division(NamedTuple):
    """Part of each box, side and number of the blocks, and rank: the lowest is the best."""

    rank: tuple[bool, bool, float]
    part: Numbers
    side_m: float
    blocks: int

    @classmethod
    def ranked(
        cls, part: Numbers, shares: Sequence[float], side_m: float, block: Numbers, gap_m: float, counted: Flags
    ) -> _Division:
        """Ranked by whether half of the images are lost, whether shares are off by 10 %, and by how far they are off.

        With a gap, users choose how many images are lost.
        """
        off, is_free = deviation(part[counted], shares), gap_m == 0.0
        # Each part also needs some of the others, such as tiles to find its queries in.
        if not counted.all() and math.isinf(deviation(part[~counted], shares)):
            off = math.inf
        is_lost = is_free and float((part[counted] < 0).mean()) > 0.5
        return cls((is_lost, is_free and off > 0.1, off), part, side_m, int(block.max()) + 1)


def _divisions(
    boxes: GroundBoxes,
    names: Sequence[str],
    shares: Sequence[float],
    seed: int | str,
    sides_m: Sequence[float],
    gap_m: float,
    counted: Flags,
) -> Iterator[_Division]:
    """Yield the divisions by blocks of each side that leave no part empty."""
    for side in sides_m:
        block = assign_blocks(boxes, side, counted)
        part = assign_parts(boxes, block, _block_order(names, block, seed), shares, gap_m, counted)
        made = _Division.ranked(part, shares, side, block, gap_m, counted)
        if math.isfinite(made.rank[-1]):
            yield made


def _strips(
    boxes: GroundBoxes, shares: Sequence[float], seed: int, gap_m: float, counted: Flags
) -> Iterator[_Division]:
    """Yield the divisions by strips along and across, from either end, that leave no part empty."""
    for which in shuffle([f"strips {number}" for number in range(4)], seed):
        across, backwards = divmod(int(which[-1]), 2)
        block, side = assign_strips(boxes, bool(across), counted)
        order = range(int(block.max()) + 1)
        part = assign_parts(boxes, block, order[::-1] if backwards else order, shares, gap_m, counted)
        made = _Division.ranked(part, shares, side, block, gap_m, counted)
        if math.isfinite(made.rank[-1]):
            yield made


def _block_order(names: Sequence[str], block: Numbers, seed: int | str) -> list[int]:
    """Sort blocks by the hashes of their first names."""
    first: dict[str, int] = {}
    seen: set[int] = set()
    for name, one in sorted(zip(names, block.tolist())):
        if one not in seen:
            seen.add(one)
            first[name] = one
    return [first[name] for name in shuffle(first, seed)]


def _ground(folder: Path, sets: Sequence[ImageSet], places: Mapping[str, list[tuple[int, int]]]) -> GroundBoxes:
    """Boxes around the ground of each place, over the images of all map types."""
    number = {name: index for index, name in enumerate(places)}
    of_set: list[list[tuple[int, int]]] = [[] for _ in sets]
    for name, found in places.items():
        for one, row in found:
            of_set[one].append((row, number[name]))
    rows = [np.array([row for row, _ in pairs], np.intp) for pairs in of_set]
    lat, lon = (
        np.concatenate([getattr(images.table, name)[at] for images, at in zip(sets, rows)])
        for name in ("lat_deg", "lon_deg")
    )
    _, middle_lon = middle_position(lat, lon)
    edges = np.array([[np.inf], [-np.inf], [np.inf], [-np.inf]]).repeat(len(places), axis=1)
    for images, at, pairs in zip(sets, rows, of_set):
        place = np.array([one for _, one in pairs], np.intp)
        # If the dataset holds several imageries, each has its plan.
        dataset = folder if images.folder == folder else images.folder.parent
        boxes = ground_boxes(images, at, dataset, middle_lon)
        # minimum and maximum propagate NaN: a place with one unknown image is unknown.
        with np.errstate(invalid="ignore"):
            for lowest in (0, 2):
                np.minimum.at(edges[lowest], place, boxes[lowest])
                np.maximum.at(edges[lowest + 1], place, boxes[lowest + 1])
    return GroundBoxes(*edges)


def _add_parts(images: ImageSet, of_place: Mapping[str, str], place: Callable[[str], str]) -> Table:
    """Add the column of parts to a map type's table."""
    table = images.table
    cells = tuple(
        of_place[place(name)] if is_usable else ""
        for name, is_usable in zip(table.img_names, usable_rows(table).tolist())
    )
    return table.replace_other({**table.other, SPLIT: cells})
