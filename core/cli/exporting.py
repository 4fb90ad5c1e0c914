"""Exports on the command line."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..errors import InvalidInput
from ..text import printable
from .dataset_options import BENCHMARK_EXPORTS, BESIDE_TABLES, DATASET_EXPORTS
from .exits import DONE


def run_export(arguments: argparse.Namespace) -> int:
    """Write a dataset, its views, or a benchmark in a format of other programs."""
    if arguments.target is None:
        if arguments.format not in BESIDE_TABLES:
            raise InvalidInput("format {0}: needs the folder to write to", arguments.format)
        arguments.target = arguments.folder
    if arguments.format in DATASET_EXPORTS:
        return _export_dataset(arguments)
    if arguments.format in BENCHMARK_EXPORTS:
        return _export_benchmark(arguments)
    from ..exports.formats import export
    from ..exports.views import Views

    views = Views.read(arguments.folder, arguments.map_type)
    path = export(views, arguments.target, arguments.format)
    print(
        printable(f"{len(views):,} images as {arguments.format} in {path}; the images stay in {views.folder}")
    )
    return DONE


def _export_dataset(arguments: argparse.Namespace) -> int:
    from ..exports.croissant import write_croissant
    from ..exports.huggingface import write_huggingface
    from ..exports.tables import write_parquet

    write = {"parquet": write_parquet, "huggingface": write_huggingface, "croissant": write_croissant}
    for path in write[arguments.format](arguments.folder, arguments.target, arguments.map_type):
        print(printable(f"written     {path}"))
    return DONE


def _export_benchmark(arguments: argparse.Namespace) -> int:
    from ..benchmark.folder import Benchmark
    from ..exports.localisers import export_benchmark

    if arguments.map_type is not None:
        raise InvalidInput("map type {0!r}: benchmarks have none to choose from", arguments.map_type)
    benchmark = Benchmark.read(arguments.folder)
    count = export_benchmark(benchmark, arguments.target, arguments.format)
    print(printable(f"{count:,} queries as {arguments.format} in {Path(arguments.target)}"))
    return DONE
