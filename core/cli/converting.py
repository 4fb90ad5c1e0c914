"""Datasets of others, on the command line."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from .exits import DONE


def run_convert(arguments: argparse.Namespace) -> int:
    """Make a dataset of ours from one of another's."""
    from ..dataset.convert import convert

    converted = convert(arguments.folder, arguments.target, arguments.dataset)
    if arguments.json:
        print(json.dumps([asdict(one) for one in converted], indent=1))
        return DONE
    for one in converted:
        text = f"{one.map_type:11s} {one.images:,} images, {one.framed:,} of which show known ground"
        if one.failed:
            text += f", {one.failed:,} without an image"
        print(text)
    print(f"dataset in {arguments.target}")
    return DONE
