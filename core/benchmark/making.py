"""The run that makes a benchmark: captures of the reference and of the queries, then what is true of them."""

from __future__ import annotations

import contextlib
import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

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
#: Held while a run is at work in a folder.
_LOCK_FILE = "run.lock"


@dataclass(frozen=True)
class BenchmarkResult:
    """What a run did.

    Parameters
    ----------
    results : mapping of str to CaptureResult
        Of each capture, by its folder.
    benchmark : Benchmark or None
        None where the run was stopped.
    hint : Message or None
        How fewer queries would be in the gap between parts, where many are.
    """

    folder: Path
    results: Mapping[str, CaptureResult]
    benchmark: Benchmark | None
    hint: Message | None = None

    @property
    def total(self) -> CaptureResult:
        """All captures together; what failed or repeats is named by its folder."""
        return combined(self.folder, self.results)


def make_benchmark(
    worked_out: BenchmarkPlan,
    sources: Mapping[str, Source],
    folder: str | os.PathLike[str],
    *,
    connections: int = DEFAULT_CONNECTIONS,
    workers: int | None = None,
    resume: bool = False,
    listener: Listener = SILENT,
) -> BenchmarkResult:
    """Make a benchmark in a folder.

    The reference is captured as one image, ``reference/mosaic``, and as tiles, ``reference/tiles_…m``; the queries into
    ``queries/NAME``, with noisy priors. All are datasets as any capture leaves them. ``queries.csv``,
    ``references.csv`` and ``positives.csv`` say what is true of them, ``benchmark.json`` how all was made. The same
    settings leave the same bytes, in one go or in several.

    Parameters
    ----------
    sources : mapping of str to Source
        By the imageries' texts, with the pixel grids that the plan was made for.
    resume : bool
        Go on with a folder that holds this benchmark.
    connections, workers, listener
        As for `capture`; progress has the folder's name in place of the map type.

    Raises
    ------
    InvalidInput
        A split that cannot be made, or imagery that its source does not have.
    OutputError
        A folder that cannot be written, or holds something else, or this benchmark without ``resume``.
    SourceError
        A source cannot serve; what was finished is kept.
    """
    shares = checked_shares(worked_out.settings.shares)
    path = Path(folder)
    # As it is read again: JSON has no tuples.
    about = json.loads(json_bytes(worked_out.settings.to_dict()))
    _claim(path, about, resume=resume)
    lock = path / _LOCK_FILE
    with locked(lock) as check:
        check_settings(path, BENCHMARK_FILE, about)
        results = capture_each(
            {name: (plan, sources[str(one)]) for name, (one, plan) in worked_out.captures.items()},
            path,
            connections=connections,
            workers=workers,
            listener=listener.guarded(check),
        )
        if any(one.cancelled for one in results.values()):
            return BenchmarkResult(path, results, None)
        check()
        hint = _write_truth(path, worked_out, about, shares)
    return BenchmarkResult(path, results, Benchmark.read(path), hint)


def _claim(path: Path, about: dict[str, object], *, resume: bool) -> None:
    """Make a folder this benchmark's own, unless it holds something else."""
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
                "folder {0}: holds {1} but no {2}, so it is no benchmark's",
                path,
                foreign[0],
                BENCHMARK_FILE,
                remedy="choose another folder",
            )
        write_whole(mark, json_bytes(about), durable=True)
        return
    if not isinstance(found, dict) or {key: found.get(key) for key in about} != about:
        raise OutputError("folder {0}: holds another benchmark", path, remedy="choose another folder")
    if not resume:
        raise OutputError(
            "folder {0}: already holds this benchmark",
            path,
            remedy=Message("resume it{0} or choose another folder", OptionName("resume").in_brackets),
        )


def _write_truth(path: Path, worked_out: BenchmarkPlan, about: dict[str, object], shares: Shares) -> Message | None:
    whole = captured(path / REFERENCE_FOLDER / MOSAIC, worked_out.mosaic)
    if not len(whole.rows):
        raise OutputError(
            "folder {0}: the mosaic of the reference has failed",
            path,
            remedy=Message(
                "go on{0} once its source serves, or take a smaller margin", OptionName("resume").in_brackets
            ),
        )
    mosaic = locate_mosaic(path, worked_out.mosaic, whole)
    parts, tile_parts, hint = _parts(path, worked_out, shares)
    queries = make_queries(path, worked_out, parts)
    references = make_references(path, worked_out, tile_parts)
    for name in worked_out.queries:
        folder = path / QUERIES_FOLDER / name
        # Those that were made with other figures since are kept.
        if not any(folder.glob(f"*/{PRIORS_FILE}")):
            write_priors(folder, Sensors(), worked_out.settings.queries.imagery.seed)
    queries.write(path / QUERIES_FILE)
    references.write(path / REFERENCES_FILE)
    find_positives(worked_out, mosaic, queries, references).write(path / POSITIVES_FILE)
    # Last, so that a benchmark that says where its mosaic lies is whole.
    write_whole(path / BENCHMARK_FILE, json_bytes({**about, "mosaic": asdict(mosaic), **_credits(path, worked_out)}))
    return hint


def _credits(path: Path, worked_out: BenchmarkPlan) -> dict[str, object]:
    """Who made the imagery, by its name."""
    found = {}
    for name, (imagery, plan) in worked_out.captures.items():
        table = captured(path / name, plan).images.table
        if len(table):
            found[imagery.name] = {
                "source": table.source[0],
                "attribution": table.attribution[0],
                "date": table.imagery_date[0],
            }
    return {"imagery": found}


def _parts(
    path: Path, worked_out: BenchmarkPlan, shares: Shares
) -> tuple[list[str], dict[str, list[str]], Message | None]:
    """Parts of the queries of one imagery, and of the tiles of each folder, empty where there are none; and a hint."""
    settings = worked_out.settings
    first = settings.imageries[0].name
    plan = worked_out.queries[first]
    if settings.split == NO_SPLIT:
        return [], {}, None
    if settings.split != CROSS_AREA:
        order = shuffle(plan.names, settings.queries.imagery.seed)
        of_name = dict(zip(order, assign_counts(len(order), shares)))
        return [of_name[name] for name in plan.names], {}, None
    sets = {f"{QUERIES_FOLDER}/{first}": plan}
    sets.update((tiles_folder(width), tiles) for width, tiles in worked_out.tiles.items())
    there = {name: captured(path / name, one) for name, one in sets.items()}
    boxes, names = _ground(path, there)
    part, _, _ = split_blocks(boxes, names, shares, settings.queries.imagery.seed, gap_m=float(settings.gap_m))
    of_image = dict(zip(names, part))
    found = {name: [of_image.get(f"{name}/{stem}", GAP) for stem in one.names] for name, one in sets.items()}
    hint = _hint(worked_out, boxes, names, shares, part)
    return found.pop(f"{QUERIES_FOLDER}/{first}"), found, hint


def _hint(
    worked_out: BenchmarkPlan, boxes: GroundBoxes, names: list[str], shares: Shares, part: list[str]
) -> Message | None:
    """How many queries other settings would leave in the gap, where that is a good part of them."""
    settings = worked_out.settings
    is_query = np.array([name.startswith(f"{QUERIES_FOLDER}/") for name in names], np.bool_)
    lost, count = int(np.count_nonzero(is_query & (np.array(part) == GAP))), int(np.count_nonzero(is_query))
    # A hint is worth its line where more than a tenth of the queries is lost.
    if lost <= 0.1 * count:
        return None
    gap_m, (train, validation, test) = float(settings.gap_m), shares
    ways = []
    if gap_m > 0.0:
        ways.append((Message("with a gap of 0 m"), shares, 0.0))
    if validation > 0.0:
        ways.append((Message("without a validation part"), (train + validation, 0.0, test), gap_m))
    found = []
    for words, own_shares, own_gap_m in ways:
        with contextlib.suppress(InvalidInput):
            own, _, _ = split_blocks(boxes, names, own_shares, settings.queries.imagery.seed, gap_m=own_gap_m)
            counts = Counter(np.array(own)[is_query].tolist())
            # What leaves a part without queries is no way out.
            serves = all(counts[name] for name, share in zip(PARTS, own_shares) if share > 0.0)
            if counts[GAP] < lost and serves:
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


def _ground(path: Path, there: Mapping[str, Captured]) -> tuple[GroundBoxes, list[str]]:
    """Boxes of the ground of images, and their names; of those whose ground is known."""
    tables = [(one.images.table, one.rows) for one in there.values()]
    _, middle_lon = middle_position(
        np.concatenate([table.lat_deg[rows] for table, rows in tables]),
        np.concatenate([table.lon_deg[rows] for table, rows in tables]),
    )
    pieces = [ground_boxes(one.images, one.rows, path / name, middle_lon) for name, one in there.items()]
    names = [f"{name}/{stem}" for name, one in there.items() for stem in one.stems]
    boxes = GroundBoxes(*(np.concatenate(edges) for edges in zip(*pieces)))
    known = boxes.known
    return boxes.take(known), [name for name, there in zip(names, known.tolist()) if there]
