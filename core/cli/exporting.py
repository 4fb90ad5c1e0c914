"""Exports on the command line."""

from __future__ import annotations

import argparse

from ..text.plain import printable
from .exits import DONE


def run_export(arguments: argparse.Namespace) -> int:
    """Write a dataset, its camera frames or a benchmark in a format of another program."""
    from ..exports.kinds import BENCHMARKS, DATASETS, export_as

    kind = arguments.format
    done = export_as(arguments.folder, arguments.target, kind, arguments.map_type)
    if kind in DATASETS:
        for path in done.paths:
            print(printable(f"written     {path}"))
    elif kind in BENCHMARKS:
        print(printable(f"{done.written:,} queries as {kind} in {done.paths[0]}"))
    else:
        where = f"the images stay in {arguments.folder}"
        print(printable(f"{done.written:,} images as {kind} in {done.paths[0]}; {where}"))
    return DONE
