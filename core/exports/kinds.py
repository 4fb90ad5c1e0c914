"""Formats by name, and export to any format. The names can be imported without numpy."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import InvalidInput, Message, TerrAInavError

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..dataset.entropy import Report

#: Titles of formats by name, for camera frames, datasets, datasets with labels, sequences and benchmarks.
VIEWS: dict[str, str] = {
    "colmap": "COLMAP",
    "nerfstudio": "nerfstudio",
    "tum": Message("TUM trajectory"),
    "kitti": Message("KITTI trajectory"),
}
DATASETS: dict[str, str] = {
    "parquet": Message("Parquet tables"),
    "huggingface": Message("Hugging Face datasets"),
    "croissant": Message("Croissant description"),
    "stac": Message("STAC collection"),
}
LABEL_SETS = {
    "coco": "COCO",
    "yolo": "YOLO",
}
SEQUENCES: dict[str, str] = {
    "euroc": Message("EuRoC dataset (ASL)"),
    "rosbag2": Message("ROS 2 bag"),
    "mcap": Message("ROS 2 bag as MCAP"),
}
BENCHMARKS = {
    "university-1652": "University-1652",
    "denseuav": "DenseUAV",
    "uav-visloc": "UAV-VisLoc",
    "gta-uav": "GTA-UAV",
    "ortholoc": "OrthoLoC",
    "anyvisloc": "AnyVisLoc",
}
KINDS: dict[str, str] = {**VIEWS, **DATASETS, **LABEL_SETS, **SEQUENCES, **BENCHMARKS}
#: Formats that are written into the dataset's folder by default.
BESIDE_TABLES = ("parquet", "croissant", "stac")


class Exported(NamedTuple):
    """Result of an export.

    Parameters
    ----------
    written : int
        Number of camera frames, of files of a dataset, of images with labels, or of queries of a benchmark.
    paths : tuple of Path
        The files written, or the folder that holds them.
    """

    written: int
    paths: tuple[Path, ...]


def export_as(
    folder: str | os.PathLike[str],
    target: str | os.PathLike[str] | None,
    kind: str,
    map_type: str | None = None,
    progress: Report | None = None,
) -> Exported:
    """Write a dataset, or a benchmark, in a format of other programs.

    Parameters
    ----------
    target : path or None
        Folder to write to; formats in `BESIDE_TABLES` also take None, for the dataset's folder.
    kind : str
        One of `KINDS`.
    map_type : str or None
        Map type to export; None for all map types or, for camera frames and labels, for one.
    progress : callable
        Called with the share done, 0 to 1, after each image; returning False cancels, and removes the export.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    InvalidInput
        The format, map type, dataset or benchmark is unknown, or the format needs a target.
    OutputError
        The folder cannot be written.
    """
    if kind not in KINDS:
        raise InvalidInput("format {0!r}: must be one of {1}", kind, ", ".join(KINDS))
    if target is None:
        if kind not in BESIDE_TABLES:
            raise InvalidInput("format {0}: needs the folder to write to", kind)
        target = folder
    if kind in DATASETS:
        return _export_dataset(folder, target, kind, map_type, progress)
    if kind in LABEL_SETS:
        from .label_sets import write_coco, write_yolo

        write = {"coco": write_coco, "yolo": write_yolo}[kind]
        return Exported(write(folder, target, map_type, progress), (Path(target),))
    if kind in SEQUENCES:
        from .sequences import write_sequence

        return Exported(write_sequence(folder, target, kind, map_type, progress), (Path(target),))
    if kind in BENCHMARKS:
        from ..benchmark.folder import Benchmark
        from .localisers import export_benchmark

        if map_type is not None:
            raise InvalidInput("map type {0!r}: benchmarks have none to choose from", map_type)
        return Exported(export_benchmark(Benchmark.read(folder), target, kind, progress), (Path(target),))
    from .formats import export
    from .views import Views

    views = Views.read(folder, map_type)
    return Exported(len(views), (export(views, target, kind),))


def refusals(folder: str | os.PathLike[str]) -> dict[str, TerrAInavError | None]:
    """Reasons why a folder cannot be exported, by format; None if it can. Reads tables but no images.

    An export may still fail for other reasons, such as a target folder that is not empty.
    """
    from ..benchmark.folder import Benchmark
    from ..dataset.dataset import read_dataset
    from .label_sets import LabelledSet
    from .sequences import RecordedSequence
    from .views import Views

    checks: tuple[tuple[dict[str, str], Callable[[], Any]], ...] = (
        (VIEWS, lambda: Views.read(folder)),
        (DATASETS, lambda: read_dataset(folder)),
        (LABEL_SETS, lambda: LabelledSet.read(folder)),
        (SEQUENCES, lambda: RecordedSequence.read(folder)),
        (BENCHMARKS, lambda: Benchmark.read(folder)),
    )
    found: dict[str, TerrAInavError | None] = {}
    for kinds, check in checks:
        reason: TerrAInavError | None = None
        try:
            check()
        except TerrAInavError as wrong:
            reason = wrong
        found.update(dict.fromkeys(kinds, reason))
    for kind, package in (("parquet", "pyarrow"), ("stac", "pyarrow"), ("rosbag2", "rosbags"), ("mcap", "rosbags")):
        if found[kind] is None and find_spec(package) is None:
            found[kind] = InvalidInput(
                "format {0}: needs the Python package {1}, which is not installed", kind, package
            )
    return found


def _export_dataset(
    folder: str | os.PathLike[str],
    target: str | os.PathLike[str],
    kind: str,
    map_type: str | None,
    progress: Report | None,
) -> Exported:
    from .croissant import write_croissant
    from .huggingface import write_huggingface
    from .stac import write_stac
    from .tables import write_parquet

    if kind == "huggingface":
        paths = tuple(write_huggingface(folder, target, map_type, progress))
        # The folder was empty before, so the export wrote all files in it.
        return Exported(sum(one.is_file() for one in Path(target).rglob("*")), paths)
    write = {"parquet": write_parquet, "croissant": write_croissant, "stac": write_stac}
    paths = tuple(write[kind](folder, target, map_type))
    return Exported(len(paths), paths)
