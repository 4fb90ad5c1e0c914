"""Cleaning of datasets on the command line."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InvalidInput
from .exits import DONE

if TYPE_CHECKING:
    from ..dataset.clean import Cleaned


def run_clean(arguments: argparse.Namespace) -> int:
    """Mark or move the images with too little to see, or take that back."""
    from ..dataset.clean import clean, undo

    if arguments.plot is not None and (arguments.undo or not arguments.plot):
        raise InvalidInput(
            "--plot shows what a threshold rejects: it does not go with --undo"
            if arguments.undo
            else "--plot '': must be the name of a folder, such as . for the current one"
        )
    earlier = set() if arguments.plot is None else {*map(str, Path(arguments.plot).glob("*.png"))}
    if arguments.undo:
        cleaned = undo(arguments.folder, dry_run=arguments.dry_run)
    else:
        cleaned = clean(
            arguments.folder,
            arguments.entropy,
            move=arguments.move,
            dry_run=arguments.dry_run,
            plot=arguments.plot,
        )
    if arguments.json:
        print(json.dumps([asdict(one) for one in cleaned], indent=1))
        return DONE
    for one in cleaned:
        text = _undone(one) if arguments.undo else _cleaned(one, arguments.entropy)
        print(f"{one.map_type:11s} {text}")
    for path in (path for one in cleaned for path in one.figures):
        print(f"{'replaced' if path in earlier else 'written':12s}{path}")
    if arguments.dry_run:
        print("dry run: nothing was changed" + (" in the dataset" if arguments.plot is not None else ""))
    return DONE


def _cleaned(one: Cleaned, threshold: float) -> str:
    text = f"{one.images:,} images, {one.rejected:,} rejected (entropy below {threshold:g}"
    if one.by_roadmap:
        text += " of the roadmap" + (
            "" if one.by_roadmap == one.images else f" for {one.by_roadmap:,} of them"
        )
    text += ")"
    if one.failed:
        text += f", {one.failed:,} failed before"
    if one.moved:
        text += f", {one.moved:,} moved to rejected"
    if one.returned:
        text += f", {one.returned:,} moved back"
    if one.suggested is not None:
        text += f"; Otsu's method suggests {one.suggested:.2f}"
    return text


def _undone(one: Cleaned) -> str:
    if not (one.rejected or one.returned):
        return "nothing to undo"
    return f"{one.rejected:,} images are no longer rejected, {one.returned:,} moved back"
