"""Exports on the command line."""

from __future__ import annotations

import argparse

from ..text.plain import printable
from .exits import DONE


def run_export(arguments: argparse.Namespace) -> int:
    """Write a dataset, its camera frames, its labels or a benchmark in a format of another program."""
    from ..exports.kinds import BENCHMARKS, DATASETS, LABEL_SETS, SEQUENCES, export_as

    kind = arguments.format
    result = export_as(arguments.folder, arguments.target, kind, arguments.map_type)
    if kind in DATASETS:
        for path in result.paths:
            print(printable(f"written     {path}"))
    elif kind in LABEL_SETS or kind in SEQUENCES:
        print(printable(f"{result.written:,} images as {kind} in {result.paths[0]}"))
    elif kind in BENCHMARKS:
        print(printable(f"{result.written:,} queries as {kind} in {result.paths[0]}"))
    else:
        # Camera frames.
        where = f"the images stay in {arguments.folder}"
        print(printable(f"{result.written:,} images as {kind} in {result.paths[0]}; {where}"))
    return DONE
