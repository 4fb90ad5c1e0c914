"""What refusals of benchmarks and exports advise."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace

from terrainav.core.benchmark.answers import Predictions
from terrainav.core.benchmark.features import sift
from terrainav.core.benchmark.folder import Benchmark
from terrainav.core.benchmark.making import make_benchmark
from terrainav.core.benchmark.planning import BenchmarkSettings, plan_benchmark
from terrainav.core.benchmark.running import method_named
from terrainav.core.benchmark.scoring import score
from terrainav.core.benchmark.silhouettes import copy_buildings
from terrainav.core.capture.progress import Listener
from terrainav.core.cli import benchmarking
from terrainav.core.errors import PartError
from terrainav.core.exports.croissant import write_croissant
from terrainav.core.exports.formats import export
from terrainav.core.exports.localisers import export_benchmark
from terrainav.core.exports.tables import write_parquet
from terrainav.core.exports.views import Views
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.imageries import NamedImagery
from terrainav.core.mission.mission import Mission

from tests.core.remedies.commands import STOPPED, pressed
from tests.core.remedies.files import extra_brings
from tests.support.datasets import write_dataset
from tests.support.remedies import Case, remedy

WORLD = NamedImagery("air", "world")
QUERIES = Mission(Box(35.150, -89.900, 35.149, -89.899), 60.0, image_px=40, image_format="png")
SETTINGS = BenchmarkSettings(QUERIES, (WORLD,), WORLD, split="none")
COMMAND = (
    *(
        "benchmark",
        "make",
        "--coords",
        "35.150_-89.900_35.149_-89.899_60",
        "--image-px",
        "40",
        "--split",
        "none",
    ),
    *("--queries", "air=world", "--reference", "map=world:roadmap", "--data-dir", "out", "--quiet"),
)


def made(folder, settings=SETTINGS, source=None, **options):
    source = source or open_source("world")
    names = [str(one) for one in (*settings.imageries, settings.reference)]
    worked_out = plan_benchmark(settings, dict.fromkeys(names, source.grid))
    return make_benchmark(worked_out, dict.fromkeys(names, source), folder, **options)


@remedy(
    "benchmark/features.py",
    "OpenCV, which finds and matches features, is not installed; get it with: pip install opencv-python-headless",
)
def _no_opencv(case: Case) -> None:
    benchmark = made(case.tmp_path / "out").benchmark
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "cv2", None)
        case.refused(lambda: sift(benchmark, benchmark.gallery("")))
    case.follow(
        "get it with: pip install opencv-python-headless",
        lambda: extra_brings("benchmark", "opencv-python-headless"),
    )


@remedy("benchmark/folder.py", "folder {}: is not finished; go on (--resume)")
def _not_finished(case: Case) -> None:
    made(case.tmp_path / "out", listener=Listener(cancelled=lambda: True))
    case.refused(lambda: Benchmark.read(case.tmp_path / "out"))
    case.follow("go on (--resume)", lambda: made(case.tmp_path / "out", resume=True))
    Benchmark.read(case.tmp_path / "out")


@remedy(
    "benchmark/folder.py",
    "folder {}: is not a benchmark, as {} cannot be read ({}); make one first (terrainav benchmark make)",
)
def _no_benchmark(case: Case) -> None:
    case.refused(lambda: Benchmark.read(case.tmp_path / "out"))
    case.follow("make one first (terrainav benchmark make)", lambda: case.run(*COMMAND).returncode == 0)
    Benchmark.read(case.tmp_path / "out")


_CROSS_AREA = (
    "split cross-area: most of {} queries would be in no part, or a part would be empty, as queries and tiles up to {} "
    "m wide show the same ground; "
)


def _taken_area(case: Case, asked: BenchmarkSettings) -> None:
    grid = {str(WORLD): open_source("world").grid}
    case.refused(lambda: plan_benchmark(asked, grid))
    found = re.search(r"an area ([\d,]+) m long or more", case.advice)
    # A degree of longitude is 91 km there.
    long_deg = float(found[1].replace(",", "")) / 91_000.0
    longer = replace(asked, queries=QUERIES.replace(area=Box(35.15, -89.9, 35.1495, -89.9 + long_deg)))
    case.follow(("take " if case.advice.startswith("take") else "") + found[0], lambda: plan_benchmark(longer, grid))
    case.follow("split same-area", lambda: plan_benchmark(replace(asked, split="same-area"), grid))


@remedy("benchmark/planning.py", _CROSS_AREA + "take an area {} m long or more, or split same-area")
def _little_ground(case: Case) -> None:
    small = QUERIES.replace(area=Box(35.15, -89.9, 35.1495, -89.8992))
    _taken_area(case, replace(SETTINGS, queries=small, split="cross-area"))


@remedy(
    "benchmark/planning.py",
    _CROSS_AREA + "choose a smaller gap, an area {} m long or more, or split same-area",
)
def _wide_gap(case: Case) -> None:
    box = QUERIES.replace(area=Box(35.15, -89.9, 35.146, -89.894))
    asked = replace(SETTINGS, queries=box, split="cross-area", gap_m=400.0)
    _taken_area(case, asked)
    case.follow(
        "choose a smaller gap",
        lambda: plan_benchmark(replace(asked, gap_m=0.0), {str(WORLD): open_source("world").grid}),
    )


@remedy("benchmark/making.py", "folder {}: holds another benchmark; choose another folder")
def _another(case: Case) -> None:
    made(case.tmp_path / "out")
    other = replace(SETTINGS, tile_overlap=0.0)
    case.refused(lambda: made(case.tmp_path / "out", other))
    case.follow("choose another folder", lambda: made(case.tmp_path / "other", other))


@remedy(
    "benchmark/making.py",
    "folder {}: already holds this benchmark; resume it (--resume) or choose another folder",
)
def _already(case: Case) -> None:
    made(case.tmp_path / "out")
    case.refused(lambda: made(case.tmp_path / "out"))
    case.follow("resume it (--resume)", lambda: made(case.tmp_path / "out", resume=True))
    case.follow("choose another folder", lambda: made(case.tmp_path / "other"))


@remedy("benchmark/making.py", "folder {}: holds {} but no {}, so it is not a benchmark; choose another folder")
def _foreign(case: Case) -> None:
    (case.tmp_path / "mine.txt").write_text("mine")
    case.refused(lambda: made(case.tmp_path))
    case.follow("choose another folder", lambda: made(case.tmp_path / "other"))


class Failing:
    """The embedded world, of which one tile cannot be had for a while."""

    def __init__(self):
        self._world = open_source("world")
        self.fails = True

    def __getattr__(self, name):
        return getattr(self._world, name)

    def fetch(self, map_type, part):
        if self.fails:
            raise PartError("it does not serve")
        return self._world.fetch(map_type, part)


@remedy(
    "benchmark/making.py",
    "folder {}: the mosaic of the reference has failed; go on (--resume) once its source serves, or take a smaller "
    "margin",
)
def _no_mosaic(case: Case) -> None:
    source = Failing()
    case.refused(lambda: made(case.tmp_path / "out", source=source))
    source.fails = False
    case.follow(
        "go on (--resume) once its source serves",
        lambda: made(case.tmp_path / "out", source=source, resume=True).benchmark is not None,
    )
    smaller = replace(SETTINGS, margin_m=0.0)
    case.follow("take a smaller margin", lambda: made(case.tmp_path / "other", smaller, source))


@remedy("benchmark/planning.py", "vary {}: benchmarks have one camera; choose other fields")
def _varied_lens(case: Case) -> None:
    def planned(text: str) -> None:
        queries = SETTINGS.queries.replace(vary=(text,))
        plan_benchmark(replace(SETTINGS, queries=queries), {str(WORLD): open_source("world").grid})

    case.refused(lambda: planned("fov_deg=uniform(60,80)"))
    case.follow("choose other fields", lambda: planned("yaw_deg=uniform(-5,5)"))


@remedy(
    "benchmark/planning.py",
    "reference of {} x {} m in pixels of {} m: more than {} px along a side or {} px; choose a smaller area, or "
    "coarser pixels of the queries (--gsd)",
)
def _too_large(case: Case) -> None:
    wide = Mission(Box(35.2, -90.0, 35.0, -89.8), 300.0, image_px=1_000)
    grid = {str(WORLD): open_source("world").grid}
    case.refused(lambda: plan_benchmark(replace(SETTINGS, queries=wide), grid))
    smaller = wide.replace(area=Box(35.004, -90.0, 35.0, -89.995))
    case.follow("choose a smaller area", lambda: plan_benchmark(replace(SETTINGS, queries=smaller), grid))
    coarser = wide.replace(gsd_m_per_px=20.0)
    case.follow(
        "coarser pixels of the queries (--gsd)",
        lambda: plan_benchmark(replace(SETTINGS, queries=coarser), grid),
    )


@remedy("benchmark/planning.py", "no imagery of queries: give one or more, such as drone=world")
def _no_imagery(case: Case) -> None:
    case.refused(lambda: replace(SETTINGS, imageries=()))
    case.follow(
        "give one or more, such as drone=world",
        lambda: replace(SETTINGS, imageries=(NamedImagery.parse("drone=world"),)),
    )


@remedy(
    "benchmark/planning.py",
    "queries of {}: {} of {} see the horizon, first {}, and no reference holds their ground; tilt less, or take a "
    "narrower camera",
)
def _horizon(case: Case) -> None:
    grid = {str(WORLD): open_source("world").grid}
    tilted = QUERIES.replace(tilt_deg=75.0, accept_error=True)
    case.refused(lambda: plan_benchmark(replace(SETTINGS, queries=tilted), grid))
    less = tilted.replace(tilt_deg=40.0)
    case.follow("tilt less", lambda: plan_benchmark(replace(SETTINGS, queries=less), grid))
    narrower = tilted.replace(camera=replace(tilted.camera, fov_deg=20.0))
    case.follow("take a narrower camera", lambda: plan_benchmark(replace(SETTINGS, queries=narrower), grid))


@remedy(
    "benchmark/scoring.py",
    "{}: rank {}, which is of another part than the queries; leave the tiles of other parts out, or run the method on "
    "the part (terrainav benchmark run --part)",
)
def _tiles_of_others(case: Case) -> None:
    box = QUERIES.replace(area=Box(35.15, -89.9, 35.147, -89.897))
    asked = replace(SETTINGS, queries=box, split="cross-area", tile_widths_m=(80.0,), margin_m=0.0)
    benchmark = made(case.tmp_path / "out", asked).benchmark
    path = case.tmp_path / "mine.csv"

    def judged(gallery):
        tiles = " ".join(benchmark.references.id[at] for at in gallery)
        query = benchmark.queries.id[benchmark.query_rows_in("test")[0]]
        path.write_text(f"query,references\n{query},{tiles}\n", encoding="utf-8")
        return score(benchmark, Predictions.read(path, benchmark), "test")

    assert case.refused(lambda: judged(benchmark.gallery(""))).startswith(f"predictions {path}: rank ")
    case.follow("leave the tiles of other parts out", lambda: judged(benchmark.gallery("test")))
    case.follow(
        "run the method on the part (terrainav benchmark run --part)",
        lambda: (
            case.run(
                *("benchmark", "run", "out", "--method", "middle", "--part", "test", "--no-page", "--quiet")
            ).returncode
            == 0
        ),
    )


@remedy("cli/benchmarking.py", STOPPED)
def _stopped(case: Case) -> None:
    with case.monkeypatch.context() as stopped:
        stopped.setattr(benchmarking, "collect_signals", pressed)
        case.says(case.run(*COMMAND).stderr, only_here=False)
    case.follow(
        "finished images are kept, continue with --resume",
        lambda: case.run(*COMMAND, "--resume").returncode == 0,
    )


@remedy("storage/files.py", "folder {}: is not empty; choose another folder")
def _not_empty(case: Case) -> None:
    made(case.tmp_path / "out")
    views = Views.read(case.tmp_path / "out" / "queries" / "air")
    case.refused(lambda: export(views, case.tmp_path, "tum"))
    case.follow("choose another folder", lambda: export(views, case.tmp_path / "other", "tum"))


@remedy("exports/croissant.py", "folder {}: a {} describes the files beside it; give the dataset's own")
def _elsewhere(case: Case) -> None:
    folder = write_dataset(case.tmp_path / "out")
    case.refused(lambda: write_croissant(folder, case.tmp_path / "other"))
    case.follow("give the dataset's own", lambda: write_croissant(folder, folder))


@remedy(
    "exports/tables.py",
    "format {}: pyarrow cannot be imported ({}); get it with: pip install 'terrainav[parquet]'",
)
def _no_pyarrow(case: Case) -> None:
    folder = write_dataset(case.tmp_path / "out")
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "pyarrow", None)
        case.refused(lambda: write_parquet(folder, folder))
    case.follow("get it with: pip install 'terrainav[parquet]'", lambda: extra_brings("parquet", "pyarrow"))


@remedy("storage/files.py", "folder {}: left over from an interrupted export; remove it")
def _left_of_an_export(case: Case) -> None:
    benchmark = made(case.tmp_path / "out").benchmark
    (case.tmp_path / "other.part").mkdir()
    case.refused(lambda: export_benchmark(benchmark, case.tmp_path / "other", "denseuav"))
    (case.tmp_path / "other.part").rmdir()
    case.follow("remove it", lambda: export_benchmark(benchmark, case.tmp_path / "other", "denseuav"))


@remedy(
    "exports/views.py",
    "folder {}: its images are windows of the map, which no camera takes; capture camera frames (--frame camera)",
)
def _windows(case: Case) -> None:
    asked = ("capture", "--coords", "35.15_-89.9_60", "--image-px", "40", "--quiet")
    case.run(*asked, "--data-dir", "out")
    case.refused(lambda: Views.read(case.tmp_path / "out"))
    case.run(*asked, "--data-dir", "other", "--frame", "camera")
    case.follow("capture camera frames (--frame camera)", lambda: Views.read(case.tmp_path / "other"))


FOOTPRINT = {
    "type": "Feature",
    "geometry": {
        "type": "Polygon",
        "coordinates": [[[-89.8996, 35.1494], [-89.8994, 35.1494], [-89.8994, 35.1496], [-89.8996, 35.1494]]],
    },
    "properties": {"height": 8},
}


def _footprints(folder, name="houses.geojson"):
    """File of one building."""
    folder.mkdir(exist_ok=True)
    (folder / name).write_text(json.dumps({"type": "FeatureCollection", "features": [FOOTPRINT]}))
    return str(folder / name)


@remedy("benchmark/silhouettes.py", "reference buildings {}: another file has this name, too; rename one of them")
def _two_of_one_name(case: Case) -> None:
    first, second = (_footprints(case.tmp_path / name) for name in ("one", "two"))
    case.refused(lambda: copy_buildings((first, second), case.tmp_path / "out"))
    other = _footprints(case.tmp_path / "two", "others.geojson")
    case.follow("rename one of them", lambda: copy_buildings((first, other), case.tmp_path / "out"))


@remedy(
    "benchmark/silhouettes.py",
    "benchmark {}: has no buildings; make one with buildings (terrainav benchmark make --reference-buildings)",
)
def _no_buildings(case: Case) -> None:
    benchmark = made(case.tmp_path / "out").benchmark
    case.refused(lambda: method_named("silhouette")(benchmark, benchmark.gallery("")))
    houses = _footprints(case.tmp_path / "houses")
    case.follow(
        "make one with buildings (terrainav benchmark make --reference-buildings)",
        lambda: (
            case.run(
                *(one if one != "out" else str(case.tmp_path / "with") for one in COMMAND),
                *("--elevation", "20", "--reference-buildings", houses),
            ).returncode
            == 0
        ),
    )
    again = Benchmark.read(case.tmp_path / "with")
    method_named("silhouette")(again, again.gallery(""))
