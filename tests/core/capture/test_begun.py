"""A ``mission.json`` that is edited between two runs: what would change an image is refused by name."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from terrainav.core.benchmark.planning import BenchmarkSettings
from terrainav.core.capture.begun import BEGUN_FILE
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.capture.several import capture_imageries
from terrainav.core.cli import main
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.fields import declared_fields
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import FLAT_PARTS
from terrainav.core.mission.plan import plan
from terrainav.core.pairs.capturing import SETTINGS_FILE, capture_pairs
from terrainav.core.pairs.places import PairPlace
from terrainav.core.pairs.planning import PairSettings, plan_pairs
from terrainav.core.pairs.views import spiral
from terrainav.core.picture.heights import mission_heights
from terrainav.core.storage.files import json_bytes

from tests.support.sources import NamedPattern, PatternSource
from tests.support.thinning import sampled

BOX = Box(35.142, -89.867, 35.140, -89.864)
MISSION = Mission(BOX, 120.0, wind=Wind(4.0, 250.0, 0.1), tilt_deg=20.0, max_px=160, seed=7)
#: Another value for each field, where no rule below makes one that is right.
OTHERS = {
    "map_types": ["roadmap"],
    "source": "another",
    "imageries": ["a=world", "b=world"],
    "date": "2014",
    "crs": "EPSG:2056",
    "bands": ["1"],
    "stretch": "percentile",
    "sun": "30 135",
    "start": "2030-01-01T10:00:00Z",
    "facing": "track",
    "img_size": [64, 48, 3],
    "elevation": ["100"],
    "surface": ["110"],
    "buildings": ["b.geojson"],
    "building_height_field": "HEIGHT",
    "labels": ["l.gpkg:roofs"],
    "label_order": "rank",
    "vary": ["agl_m=uniform(90,150)"],
    "products": ["depth"],
    "takeoff": [35.14, -89.86],
    "max_px": 150,
    "battery_min": 20.0,
    "row_azimuth_deg": 80.0,
    "vertical_datum": "ellipsoid",
    "image_px": [200, 150],
    "skip_rows": "1",
    "split_after": "2",
    "exposure": "time",
    "vignetting": "cos4",
    "airlight": "200 210 220",
    "image_sensor": "custom",
}
FIELDS = [(part, one) for part, kind in FLAT_PARTS.items() for one in declared_fields(kind)]


def another(one, value):
    """Value of a field that is not this one."""
    if one.name in OTHERS:
        return OTHERS[one.name]
    if one.choices:
        return next(choice for choice in one.choices if choice != value)
    if one.kind is bool:
        return not value
    if one.kind in (int, float):
        number = one.default if value is None and isinstance(one.default, (int, float)) else value
        return one.kind((number or 0) * 1.1 + 1) if one.most is None or one.most > 1 else (number or 0.0) / 2.0 + 0.1
    raise AssertionError(f"no other value of {one.name} is known")


def edited(path: Path, part: str, **values) -> None:
    document = json.loads(path.read_text("utf-8"))
    document.setdefault(part, {}).update(values)
    path.write_text(json.dumps(document), "utf-8")


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()
    }


def captured(mission: Mission, folder: Path, *, resume: bool = False, blocks: Blocks | None = None):
    source = NamedPattern() if blocks else PatternSource()
    worked_out = plan(mission, source.grid, mission_heights(mission))
    return capture(worked_out, source, folder, resume=resume, blocks=blocks)


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    folder = tmp_path_factory.mktemp("begun") / "out"
    captured(MISSION, folder)
    return folder


@pytest.mark.parametrize(("part", "one"), sampled(FIELDS, 4), ids=[f"{part}.{one.name}" for part, one in FIELDS])
def test_each_field_that_is_edited_is_refused_by_name(begun, tmp_path, part, one):
    folder = shutil.copytree(begun, tmp_path / "out")
    was = getattr(getattr(MISSION, part), one.name)
    edited(folder / "mission.json", part, **{one.name: another(one, was)})
    before = contents(folder)
    try:
        mission = Mission.load(folder / "mission.json")
        if mission.imagery.imageries:
            plans = {name: plan(each, PatternSource().grid) for name, each in mission.missions_by_imagery.items()}
            sources = {name: PatternSource() for name in plans}
            resumed = lambda: capture_imageries(mission, plans, sources, folder, resume=True)  # noqa: E731
        else:
            resumed = lambda: captured(mission, folder, resume=True)  # noqa: E731
        with pytest.raises(OutputError) as refused:
            resumed()
    except InvalidInput:
        # No mission at all with this one change; nothing was written.
        pass
    else:
        said = str(refused.value)
        assert "its mission.json was edited since the capture began" in said
        assert f"{part}.{one.name} from " in said
        assert "\n" not in said
    assert contents(folder) == before


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"area": {"type": "box", "north_deg": 35.1411}}, "area.north_deg from 35.142 to 35.1411"),
        ({"camera": {"fov_deg": 61.0}}, "camera.fov_deg from 78.8 to 61.0"),
        ({"wind": {"speed_m_per_s": 5.0}}, "wind.speed_m_per_s from 4.0 to 5.0"),
        (
            {"wind": None},
            "wind.speed_m_per_s from 4.0 to none, wind.from_deg from 250.0 to none, wind.turbulence",
        ),
    ],
)
def test_parts_that_are_given_whole_are_held_as_well(begun, tmp_path, change, said):
    folder = shutil.copytree(begun, tmp_path / "out")
    document = json.loads((folder / "mission.json").read_text())
    for name, values in change.items():
        document[name] = None if values is None else {**document.get(name, {}), **values}
    (folder / "mission.json").write_text(json.dumps(document))
    with pytest.raises(OutputError) as refused:
        captured(Mission.load(folder / "mission.json"), folder, resume=True)
    assert said in str(refused.value)


def test_the_places_of_a_list_are_held_however_many(tmp_path):
    poses = tuple((35.14 + 1e-5 * at, -89.865, 120.0) for at in range(100))
    captured(Mission(Points(poses), 120.0, max_px=32), tmp_path)
    assert (tmp_path / BEGUN_FILE).stat().st_size < 5_000
    document = json.loads((tmp_path / "mission.json").read_text())
    document["area"]["poses"][50][0] += 1e-9
    (tmp_path / "mission.json").write_text(json.dumps(document))
    with pytest.raises(OutputError, match=r"area\.poses from 100 values to 100 values that differ"):
        captured(Mission.load(tmp_path / "mission.json"), tmp_path, resume=True)


def test_edits_that_change_no_value_are_accepted(begun, tmp_path):
    folder = shutil.copytree(begun, tmp_path / "out")
    document = json.loads((folder / "mission.json").read_text())
    # Other spaces and order, whole numbers for their floats, and a default that is spelled out.
    document = dict(reversed(document.items()))
    document["flight"].update(agl_m=120, row_azimuth_deg=90)
    text = json.dumps(document, indent=7)
    (folder / "mission.json").write_text(text)
    before = contents(folder)
    assert captured(Mission.load(folder / "mission.json"), folder, resume=True).written == 0
    assert contents(folder) == before


@pytest.mark.parametrize("blocks", [None, Blocks(2), Blocks(2, "webdataset")], ids=["plain", "folders", "shards"])
def test_going_on_with_the_options_of_before_says_that_the_file_was_edited(tmp_path, blocks):
    captured(MISSION, tmp_path, blocks=blocks)
    edited(tmp_path / "mission.json", "imagery", seed=8)
    said = "its mission.json was edited since the capture began: imagery.seed from 7 to 8; put it back"
    for mission in (MISSION, MISSION.replace(seed=8)):
        with pytest.raises(OutputError, match=said):
            captured(mission, tmp_path, resume=True, blocks=blocks)
    edited(tmp_path / "mission.json", "imagery", seed=7)
    assert captured(MISSION, tmp_path, resume=True, blocks=blocks).written == 0


def test_stores_are_held_as_folders_are(tmp_path):
    from terrainav.core.storage.stores import get, put, store_path

    pytest.importorskip("upath")
    address = "memory://begun/out"
    captured(MISSION, address, blocks=Blocks(2))
    mark = store_path(address) / "mission.json"
    put(mark, get(mark).replace(b'"seed": 7', b'"seed": 8'))
    with pytest.raises(OutputError, match=r"imagery\.seed from 7 to 8"):
        captured(MISSION.replace(seed=8), address, resume=True, blocks=Blocks(2))


@pytest.mark.parametrize(
    ("field", "option", "value"),
    [
        ("seed", "imagery", 8),
        ("start", "flight", "2030-01-01T10:00:00Z"),
        ("order", "flight", "one-way"),
        ("products", "output", ["depth", "normals"]),
        ("elevation", "terrain", ["130"]),
    ],
)
def test_the_command_names_what_was_edited(tmp_path, capsys, field, option, value):
    folder = tmp_path / "out"
    coords = "--coords=35.141_-89.866_35.1405_-89.8655_120"
    make = [
        "--source",
        "world",
        "--seed",
        "7",
        "--max-px",
        "100",
        "--elevation",
        "100",
        "--products",
        "depth",
    ]
    assert main(["capture", coords, *make, "--data-dir", str(folder), "--quiet"]) == 0
    edited(folder / "mission.json", option, **{field: value})
    before = contents(folder)
    capsys.readouterr()
    code = main(["capture", str(folder / "mission.json"), "--data-dir", str(folder), "--quiet", "--resume"])
    said = capsys.readouterr().err
    assert code == 3
    assert said.count("\n") == 1
    assert f"{option}.{field} from " in said
    assert contents(folder) == before


def test_of_several_imageries_the_file_above_them_is_held(tmp_path):
    mission = MISSION.replace(imageries=("a=world", "b=world"))

    def run(asked):
        plans = {name: plan(one, PatternSource().grid) for name, one in asked.missions_by_imagery.items()}
        return capture_imageries(asked, plans, {name: PatternSource() for name in plans}, tmp_path, resume=True)

    run(mission)
    edited(tmp_path / "mission.json", "imagery", imageries=["a=world", "c=world"])
    with pytest.raises(OutputError, match=r"imagery\.imageries from .* to "):
        run(Mission.load(tmp_path / "mission.json"))


def test_pairs_are_held_to_their_settings(tmp_path):
    source = PatternSource()
    places = tuple(PairPlace(35.14 + 0.01 * at, -89.86, str(at)) for at in range(4))

    def run(**changes):
        settings = PairSettings(views=spiral((120.0,), 2, 1, (30.0,)), size_px=32, satellite_m=60.0, **changes)
        return capture_pairs(plan_pairs(places, settings, source.grid), source, tmp_path, resume=True)

    run(gap_m=0.0, seed=3)
    settings = PairSettings(
        views=spiral((120.0,), 2, 1, (30.0,)),
        size_px=32,
        satellite_m=60.0,
        gap_m=0.0,
        seed=3,
        shares=(0.25, 0.5, 0.25),
    )
    edited_settings = plan_pairs(places, settings, source.grid).to_dict()
    (tmp_path / SETTINGS_FILE).write_bytes(json_bytes(edited_settings))
    before = contents(tmp_path)
    with pytest.raises(OutputError, match=r"its pairs.json was edited since the capture began: parts.shares from"):
        run(gap_m=0.0, seed=3, shares=(0.25, 0.5, 0.25))
    assert contents(tmp_path) == before


def test_a_benchmark_is_held_to_its_settings(tmp_path):
    from terrainav.core.benchmark.making import make_benchmark
    from terrainav.core.benchmark.planning import plan_benchmark
    from terrainav.core.mission.imageries import NamedImagery

    source, one = PatternSource(), NamedImagery.parse("a=world")
    queries = Mission(Points(((35.14, -89.865, 120.0), (35.141, -89.864, 120.0))), 120.0, max_px=32)

    def run(gap_m):
        asked = BenchmarkSettings(queries, (one,), one, split="none", margin_m=10.0, gap_m=gap_m)
        return make_benchmark(plan_benchmark(asked, {str(one): source.grid}), {str(one): source}, tmp_path, resume=True)

    run(10.0)
    document = json.loads((tmp_path / "benchmark.json").read_text())
    (tmp_path / "benchmark.json").write_text(json.dumps({**document, "gap_m": 20.0}))
    with pytest.raises(OutputError, match=r"its benchmark.json was edited .*: gap_m from 10.0 to 20.0"):
        run(20.0)


# --- datasets whose first run ended before it noted its settings


@pytest.fixture
def without_record(begun, tmp_path):
    folder = shutil.copytree(begun, tmp_path / "out")
    (folder / BEGUN_FILE).unlink()
    return folder


def test_a_dataset_without_a_record_goes_on_and_is_held_from_then_on(without_record, begun):
    assert captured(MISSION, without_record, resume=True).written == 0
    assert contents(without_record) == contents(begun)
    edited(without_record / "mission.json", "imagery", seed=8)
    with pytest.raises(OutputError, match=r"imagery\.seed from 7 to 8"):
        captured(MISSION.replace(seed=8), without_record, resume=True)


@pytest.mark.parametrize(
    "text", sampled(["", "[", "[]", '{"schema": 1}', '{"schema": 9, "settings": {}}', "{" * 200], 3)
)
def test_a_record_that_cannot_be_read_is_one_line(begun, tmp_path, text):
    folder = shutil.copytree(begun, tmp_path / "out")
    (folder / BEGUN_FILE).write_text(text)
    with pytest.raises(OutputError, match=r"its begun.json cannot be read \(.*\), so it is not known"):
        captured(MISSION, folder, resume=True)
