"""The run that makes a benchmark: captures reference and queries, then writes the truth."""

from __future__ import annotations

import contextlib
import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from ..arrays import Flags
from ..capture.begun import check_settings
from ..capture.holding import locked
from ..capture.making import DEFAULT_CONNECTIONS
from ..capture.progress import SILENT, CaptureResult, Listener
from ..capture.several import capture_each, combined
from ..dataset.folder import PARTS
from ..dataset.ground import GroundBoxes, ground_boxes
from ..dataset.labels import middle_position
from ..dataset.split import assign_counts, checked_shares, shuffle, split_blocks
from ..dataset.table import GAP
from ..errors import InvalidInput, Message, OptionName, OutputError
from ..imagery.source import Source
from ..limits import MAX_SETTINGS_BYTES
from ..poses.priors import PRIORS_FILE, write_priors
from ..poses.settings import Sensors
from ..storage.files import json_bytes, make_folder, read_limited, write_whole
from ..text.safe_json import parse_json
from .choices import CROSS_AREA, NO_SPLIT
from .folder import (
    BENCHMARK_FILE,
    BUILDINGS,
    MOSAIC,
    POSITIVES_FILE,
    QUERIES_FILE,
    QUERIES_FOLDER,
    REFERENCE_FOLDER,
    REFERENCES_FILE,
    Benchmark,
)
from .planning import BenchmarkPlan, tiles_folder
from .truth import Captured, captured, find_positives, locate_mosaic, make_queries, make_references

Shares = tuple[float, float, float]
#: Locked while a run works in the folder.
_LOCK_FILE = "run.lock"


@dataclass(frozen=True)
class BenchmarkResult:
    """Result of a run.

    Parameters
    ----------
    results : mapping of str to CaptureResult
        Result of each capture, by its folder.
    benchmark : Benchmark or None
        None if the run was cancelled.
    hint : Message or None
        How to lose fewer queries to the gap between parts, if many are lost.
    """

    folder: Path
    results: Mapping[str, CaptureResult]
    benchmark: Benchmark | None
    hint: Message | None = None

    @property
    def total(self) -> CaptureResult:
        """Sum of all captures; failures and repeats have the folder of their capture."""
        return combined(self.folder, self.results)


def make_benchmark(
    planned: BenchmarkPlan,
    sources: Mapping[str, Source],
    folder: str | os.PathLike[str],
    *,
    connections: int = DEFAULT_CONNECTIONS,
    workers: int | None = None,
    resume: bool = False,
    listener: Listener = SILENT,
) -> BenchmarkResult:
    """Make a benchmark in a folder.

    The reference is captured as one image, ``reference/mosaic``, and as tiles, ``reference/tiles_…m``; queries are
    captured into ``queries/NAME``, with noisy priors. Each of these folders is a dataset, as any capture makes it.
    ``queries.csv``, ``references.csv`` and ``positives.csv`` hold the truth, ``benchmark.json`` the settings. The same
    settings write the same bytes, however often the run is interrupted.

    Parameters
    ----------
    sources : mapping of str to Source
        Sources keyed by ``str`` of their imagery, with the pixel grids that the plan was made for.
    resume : bool
        Continue in a folder that holds part of this benchmark.
    connections, workers, listener
        As in `capture`; progress has the folder's name in place of the map type.

    Raises
    ------
    InvalidInput
        The split is impossible, or a source lacks the imagery.
    OutputError
        The folder cannot be written, holds something else, or holds this benchmark and ``resume`` is false.
    SourceError
        A source fails; finished images are kept.
    """
    shares = checked_shares(planned.settings.shares)
    path = Path(folder)
    # Converted through JSON, which has no tuples, to be compared with the settings read from the folder.
    settings = json.loads(json_bytes(planned.settings.to_dict()))
    _claim(path, settings, resume=resume)
    lock = path / _LOCK_FILE
    with locked(lock) as check:
        check_settings(path, BENCHMARK_FILE, settings)
        buildings = _add_buildings(path, planned)
        results = capture_each(
            {name: (plan, sources[str(one)]) for name, (one, plan) in planned.captures.items()},
            path,
            connections=connections,
            workers=workers,
            listener=listener.guarded(check),
        )
        if any(one.cancelled for one in results.values()):
            return BenchmarkResult(path, results, None)
        check()
        hint = _write_truth(path, planned, {**settings, **buildings}, shares)
    return BenchmarkResult(path, results, Benchmark.read(path), hint)


def _claim(path: Path, settings: dict[str, object], *, resume: bool) -> None:
    """Claim a folder for a benchmark; raises OutputError for other content, or this benchmark without ``resume``."""
    make_folder(path)
    mark = path / BENCHMARK_FILE
    try:
        found = parse_json(read_limited(mark, MAX_SETTINGS_BYTES)) if mark.exists() else None
        foreign = sorted(one.name for one in path.iterdir() if one.name != _LOCK_FILE)
    except (OSError, ValueError) as wrong:
        raise OutputError("folder {0}: cannot read {1} ({2})", path, BENCHMARK_FILE, wrong) from wrong
    if found is None:
        if foreign:
            raise OutputError(
                "folder {0}: holds {1} but no {2}, so it is not a benchmark",
                path,
                foreign[0],
                BENCHMARK_FILE,
                remedy="choose another folder",
            )
        write_whole(mark, json_bytes(settings), durable=True)
        return
    if not isinstance(found, dict) or {key: found.get(key) for key in settings} != settings:
        raise OutputError("folder {0}: holds another benchmark", path, remedy="choose another folder")
    if not resume:
        raise OutputError(
            "folder {0}: already holds this benchmark",
            path,
            remedy=Message("resume it{0} or choose another folder", OptionName("resume").in_brackets),
        )


def _add_buildings(path: Path, planned: BenchmarkPlan) -> dict[str, object]:
    """Copy the buildings of the reference, and describe them; empty without any."""
    asked = planned.settings
    if not asked.reference_buildings:
        return {}
    # Imported here, as only such benchmarks need vector files.
    from .silhouettes import copy_buildings, describe_buildings

    copies = copy_buildings(asked.reference_buildings, path)
    return {BUILDINGS: describe_buildings(path, asked.queries, copies, planned.queries)}


def _write_truth(path: Path, planned: BenchmarkPlan, settings: dict[str, object], shares: Shares) -> Message | None:
    whole = captured(path / REFERENCE_FOLDER / MOSAIC, planned.mosaic)
    if not len(whole.rows):
        raise OutputError(
            "folder {0}: the mosaic of the reference has failed",
            path,
            remedy=Message(
                "go on{0} once its source serves, or take a smaller margin", OptionName("resume").in_brackets
            ),
        )
    mosaic = locate_mosaic(path, planned.mosaic, whole)
    parts, tile_parts, hint = _parts(path, planned, shares)
    queries = make_queries(path, planned, parts)
    references = make_references(path, planned, tile_parts)
    for name in planned.queries:
        folder = path / QUERIES_FOLDER / name
        # Keep priors that a user rewrote with other settings.
        if not any(folder.glob(f"*/{PRIORS_FILE}")):
            write_priors(folder, Sensors(), planned.settings.queries.imagery.seed)
    queries.write(path / QUERIES_FILE)
    references.write(path / REFERENCES_FILE)
    find_positives(planned, mosaic, queries, references).write(path / POSITIVES_FILE)
    # Written last: `Benchmark.read` treats a benchmark without a mosaic as unfinished.
    write_whole(path / BENCHMARK_FILE, json_bytes({**settings, "mosaic": asdict(mosaic), **_credits(path, planned)}))
    return hint


def _credits(path: Path, planned: BenchmarkPlan) -> dict[str, object]:
    """Source, attribution and date of each imagery."""
    found = {}
    for name, (imagery, plan) in planned.captures.items():
        table = captured(path / name, plan).images.table
        if len(table):
            found[imagery.name] = {
                "source": table.source[0],
                "attribution": table.attribution[0],
                "date": table.imagery_date[0],
            }
    return {"imagery": found}


def _parts(
    path: Path, planned: BenchmarkPlan, shares: Shares
) -> tuple[list[str], dict[str, list[str]], Message | None]:
    """Part of each query of the first imagery, and of each tile by folder (both empty without a split), and a hint."""
    settings = planned.settings
    first = settings.imageries[0].name
    plan = planned.queries[first]
    if settings.split == NO_SPLIT:
        return [], {}, None
    if settings.split != CROSS_AREA:
        order = shuffle(plan.names, settings.queries.imagery.seed)
        of_name = dict(zip(order, assign_counts(len(order), shares)))
        return [of_name[name] for name in plan.names], {}, None
    sets = {f"{QUERIES_FOLDER}/{first}": plan}
    sets.update((tiles_folder(width), tiles) for width, tiles in planned.tiles.items())
    captures = {name: captured(path / name, one) for name, one in sets.items()}
    boxes, names = _ground(path, captures)
    is_query = np.array([name.startswith(f"{QUERIES_FOLDER}/") for name in names], np.bool_)
    seed = settings.queries.imagery.seed
    part, _, _ = split_blocks(boxes, names, shares, seed, gap_m=float(settings.gap_m), counted=is_query)
    of_image = dict(zip(names, part))
    found = {name: [of_image.get(f"{name}/{stem}", GAP) for stem in one.names] for name, one in sets.items()}
    hint = _hint(planned, boxes, names, shares, part, is_query)
    return found.pop(f"{QUERIES_FOLDER}/{first}"), found, hint


def _hint(
    planned: BenchmarkPlan, boxes: GroundBoxes, names: list[str], shares: Shares, part: list[str], is_query: Flags
) -> Message | None:
    """Hint at settings that leave fewer queries in the gap; None unless more than a tenth of them are there."""
    settings = planned.settings
    lost, count = int(np.count_nonzero(is_query & (np.array(part) == GAP))), int(np.count_nonzero(is_query))
    if lost <= 0.1 * count:
        return None
    gap_m, (train, validation, test) = float(settings.gap_m), shares
    ways = []
    if gap_m > 0.0:
        ways.append((Message("with a gap of 0 m"), shares, 0.0))
    if validation > 0.0:
        ways.append((Message("without a validation part"), (train + validation, 0.0, test), gap_m))
    found = []
    for words, other_shares, other_gap_m in ways:
        with contextlib.suppress(InvalidInput):
            seed = settings.queries.imagery.seed
            other, _, _ = split_blocks(boxes, names, other_shares, seed, gap_m=other_gap_m, counted=is_query)
            counts = Counter(np.array(other)[is_query].tolist())
            every_part = all(counts[name] for name, share in zip(PARTS, other_shares) if share > 0.0)
            if counts[GAP] < lost and every_part:
                found.append(Message("{0:,} {1}", counts[GAP], words))
    if not found:
        return Message(
            "{0:,} of {1:,} queries are in the gap between parts; smaller tiles or a larger area leave fewer there",
            lost,
            count,
        )
    return Message(
        "{0:,} of {1:,} queries are in the gap between parts; it would be {2}, and fewer with smaller tiles or over a "
        "larger area",
        lost,
        count,
        Message.joined(", ", found),
    )


def _ground(path: Path, captures: Mapping[str, Captured]) -> tuple[GroundBoxes, list[str]]:
    """Boxes and names of the images whose ground is known."""
    tables = [(one.images.table, one.rows) for one in captures.values()]
    _, middle_lon = middle_position(
        np.concatenate([table.lat_deg[rows] for table, rows in tables]),
        np.concatenate([table.lon_deg[rows] for table, rows in tables]),
    )
    pieces = [ground_boxes(one.images, one.rows, path / name, middle_lon) for name, one in captures.items()]
    names = [f"{name}/{stem}" for name, one in captures.items() for stem in one.stems]
    boxes = GroundBoxes(*(np.concatenate(edges) for edges in zip(*pieces)))
    known = boxes.known
    return boxes.take(known), [name for name, is_known in zip(names, known.tolist()) if is_known]
