"""The rooms of the core and the direction of its arrows, read from the source itself."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.support.trees import tree_of

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "core"
PLUGIN = ROOT / "terrainav_plugin"

FORBIDDEN = {"qgis", "PyQt4", "PyQt5", "PyQt6", "PySide2", "PySide6", "sip"}

# Modules that take long to import, and that most commands can do without.
SLOW = {"PIL", "asyncio", "concurrent.futures", "pyproj", "requests", "sqlite3", "ssl", "urllib3"}
# What may be missing on a machine where the command has to work, or is slow to import where it is not used.
ON_DEMAND = {
    "aiohttp",
    "msgpack",
    "matplotlib",
    "rasterio",
    "osgeo",
    "pyogrio",
    "shapely",
    "scipy",
    "torch",
    "keras",
    "tensorflow",
    "dask",
    "distributed",
    "fsspec",
    "upath",
    "s3fs",
    "pandas",
    "pyarrow",
    "owslib",
}

ROOMS = (
    "text",
    "external",
    "storage",
    "geodesy",
    "camera",
    "mission",
    "imagery",
    "elevation",
    "faces",
    "world",
    "vectors",
    "dataset",
    "labels",
    "picture",
    "capture",
    "live",
    "report",
    "mosaic",
    "pairs",
    "benchmark",
    "exports",
    "poses",
    "sequences",
)

# Open to all other rooms; what lies in `core` itself (errors, limits, the shipped tables) imports no room.
FLOOR = {"core", "text", "external", "storage"}
# Room -> rooms it may import.
ARROWS = {
    "core": set(),
    "text": {"core"},
    "external": {"core", "text"},
    "storage": {"core", "text", "external"},
    "geodesy": FLOOR,
    "camera": {*FLOOR, "geodesy"},
    "mission": {*FLOOR, "geodesy", "camera"},
    "imagery": {*FLOOR, "geodesy"},
    "elevation": {*FLOOR, "geodesy", "imagery"},
    "faces": {*FLOOR, "geodesy", "imagery", "elevation", "vectors"},
    "world": {*FLOOR, "geodesy", "imagery"},
    "vectors": {*FLOOR, "geodesy", "imagery"},
    "dataset": {*FLOOR, "geodesy", "labels"},
    "labels": {*FLOOR, "geodesy", "vectors"},
    "picture": {*FLOOR, "geodesy", "camera", "mission", "imagery", "elevation", "vectors", "faces", "labels"},
    "capture": {*FLOOR, "geodesy", "mission", "imagery", "dataset", "labels", "picture"},
    "live": {*FLOOR, "geodesy", "mission", "imagery", "labels", "picture", "capture"},
    "report": {*FLOOR, "geodesy", "camera", "mission", "imagery", "world", "dataset", "picture", "capture"},
    "mosaic": {*FLOOR, "geodesy", "mission", "dataset", "picture", "capture"},
    "pairs": {*FLOOR, "geodesy", "mission", "imagery", "dataset", "picture", "capture"},
    "benchmark": {
        *FLOOR,
        "geodesy",
        "mission",
        "imagery",
        "dataset",
        "faces",
        "picture",
        "capture",
        "poses",
        "sequences",
    },
    "exports": {*FLOOR, "geodesy", "mission", "dataset", "picture", "benchmark", "sequences"},
    "poses": {*FLOOR, "geodesy", "mission", "imagery", "dataset"},
    "sequences": {*FLOOR, "geodesy", "mission", "imagery", "dataset", "picture", "capture", "poses"},
    "cli": {"core", *ROOMS},
}

# Rooms whose docstring leads through their modules.
TOLD_IN_ORDER = [
    CORE / name
    for name in (
        "text",
        "external",
        "storage",
        "geodesy",
        "geodesy/raytracing",
        "camera",
        "mission",
        "mission/areas",
        "mission/relief",
        "mission/layout",
        "mission/export",
        "elevation",
        "faces",
        "labels",
        "vectors",
        "picture",
        "capture",
        "live",
        "mosaic",
        "report",
        "exports",
        "poses",
        "sequences",
    )
]

MODULES = sorted(CORE.rglob("*.py"))
PLUGIN_MODULES = sorted(PLUGIN.rglob("*.py"))


def module_name(path: Path) -> str:
    """Return ``terrainav.core.geodesy.camera`` for ``core/geodesy/camera.py``."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(["terrainav", *(parts[:-1] if parts[-1] == "__init__" else parts)])


def room(name: str) -> str:
    """Return the room of a module of the core."""
    inner = name.split(".")[2:]
    if inner and inner[0] in (*ROOMS, "cli"):
        return inner[0]
    return "core"


@cache
def nodes_of(path: Path) -> list[ast.Import | ast.ImportFrom]:
    """Return what a file imports with, at any depth."""
    found = ast.walk(tree_of(path))
    return [node for node in found if isinstance(node, (ast.Import, ast.ImportFrom))]


def imported(path: Path) -> Iterator[tuple[int, str]]:
    """Yield line and absolute name of everything that a file imports, lazy imports included."""
    package = module_name(path).split(".")
    if path.name != "__init__.py":
        package.pop()
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            origin = ".".join([*base, *([node.module] if node.module else [])])
            # Whether `from a import b` names a module or something in it does not matter for the rooms.
            yield from ((node.lineno, f"{origin}.{alias.name}") for alias in node.names)


def identify(path: Path) -> str:
    return str(path.relative_to(ROOT))


def in_fresh_interpreter(code: str) -> list[str]:
    """Run `code` where nothing is imported yet; returns what it prints, split."""
    result = subprocess.run([sys.executable, "-c", code], cwd=ROOT.parent, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return result.stdout.split()


def test_every_room_is_there():
    assert {path.name for path in CORE.iterdir() if (path / "__init__.py").exists()} >= set(ROOMS)


@pytest.mark.parametrize("folder", TOLD_IN_ORDER, ids=identify)
def test_a_room_names_its_modules_in_reading_order(folder):
    text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8")))
    lists = [line.partition(":")[0] for line in text.splitlines() if line.startswith("- ")]
    named = [name for line in lists for name in re.findall(r"`(\w+)`", line)]
    inside = {path.stem for path in folder.glob("*.py")} - {"__init__", "__main__"}
    inside |= {path.parent.name for path in folder.glob("*/__init__.py")}
    assert len(named) == len(set(named))
    assert set(named) == inside


@pytest.mark.parametrize("path", MODULES, ids=identify)
def test_core_names_neither_qgis_nor_qt(path):
    wrong = [(line, name) for line, name in imported(path) if name.split(".")[0] in FORBIDDEN]
    assert wrong == []


@pytest.mark.parametrize("path", MODULES, ids=identify)
def test_arrows_point_one_way(path):
    here = room(module_name(path))
    wrong = []
    for line, name in imported(path):
        if not name.startswith("terrainav"):
            continue
        if not name.startswith("terrainav.core.") or room(name) not in ARROWS[here] | {here}:
            wrong.append((line, name))
    assert wrong == [], f"{here} may import from {sorted(ARROWS[here])} only"


@pytest.mark.parametrize("path", [*MODULES, *PLUGIN_MODULES], ids=identify)
def test_inside_the_package_imports_are_relative(path):
    absolute = [
        node.lineno
        for node in nodes_of(path)
        if (isinstance(node, ast.ImportFrom) and not node.level and str(node.module).partition(".")[0] == "terrainav")
        or (isinstance(node, ast.Import) and any(alias.name.partition(".")[0] == "terrainav" for alias in node.names))
    ]
    assert absolute == []


def imports_between(paths: list[Path]) -> dict[str, set[str]]:
    """Each module with those of the same set that it imports, at its top or in a function; packages by what they hold.

    What only type checkers import (under ``if TYPE_CHECKING``) counts, too: it is read together.
    """
    names = {module_name(path) for path in paths}

    def module_of(name: str) -> str:
        # `from a import b` names a module, or something in the module `a`.
        return name if name in names else name.rpartition(".")[0]

    return {
        module_name(path): {module_of(name) for _, name in imported(path)} & names - {module_name(path)}
        for path in paths
    }


def circles(imports: dict[str, set[str]]) -> list[set[str]]:
    """Sets of modules each of which is reached from every other one, by Tarjan's algorithm."""
    found: list[set[str]] = []
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []

    def visit(module: str) -> None:
        order[module] = lowest[module] = len(order)
        stack.append(module)
        for other in sorted(imports[module]):
            if other not in order:
                visit(other)
                lowest[module] = min(lowest[module], lowest[other])
            elif other in stack:
                lowest[module] = min(lowest[module], order[other])
        if lowest[module] == order[module]:
            at = stack.index(module)
            members = set(stack[at:])
            del stack[at:]
            if len(members) > 1:
                found.append(members)

    for module in sorted(imports):
        if module not in order:
            visit(module)
    return found


def test_circles_are_found_whatever_hangs_on_them():
    imports = {
        "a": {"b", "e"},
        "b": {"c"},
        "c": {"d"},
        "d": {"b"},
        "e": {"f"},
        "f": set(),
        "g": {"h"},
        "h": {"g", "a"},
    }
    assert sorted(sorted(circle) for circle in circles(imports)) == [["b", "c", "d"], ["g", "h"]]


def test_no_modules_of_the_core_import_each_other_in_a_circle():
    assert circles(imports_between(MODULES)) == []


def test_importing_all_of_core_loads_neither_qgis_nor_qt():
    names = [module_name(path) for path in MODULES if path.name != "__main__.py"]
    code = f"import importlib, sys\nfor name in {names!r}:\n    importlib.import_module(name)\nprint(*sys.modules)"
    loaded = in_fresh_interpreter(code)
    assert set(names) <= set(loaded)
    assert {name.partition(".")[0] for name in loaded} & FORBIDDEN == set()


def test_the_command_imports_nothing_that_it_may_not_need():
    loaded = in_fresh_interpreter("import sys, terrainav.core.cli\nprint(*sys.modules)")
    assert "terrainav.core.cli" in loaded
    assert {name.partition(".")[0] for name in loaded} & ON_DEMAND == set()


def loaded_by_command(*arguments: str) -> set[str]:
    """Modules that Python has loaded when a command ends."""
    return set(
        in_fresh_interpreter(
            "import contextlib, io, sys\n"
            "from terrainav.core.cli import main\n"
            "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):\n"
            f"    main({list(arguments)!r})\n"
            "print(*sys.modules)"
        )
    )


def test_help_loads_only_the_options_of_its_command():
    loaded = loaded_by_command("plan", "--help")
    assert "terrainav.core.mission.options" in loaded
    assert loaded & {"numpy", *SLOW, "logging", "terrainav.core.cli.flying", "terrainav.core.poses.settings"} == set()


def test_a_plan_of_one_image_loads_neither_proj_nor_network_nor_formats():
    loaded = loaded_by_command("plan", "--coords", "46.2_-122.2_120")
    assert "terrainav.core.mission.estimate" in loaded
    formats = {"terrainav.core.mission.export", "terrainav.core.mission.areas.files"}
    assert loaded & {*SLOW, "logging", "numpy.typing", "statistics", "zipfile", *formats} == set()


def test_importing_the_package_imports_nothing_else_of_it():
    loaded = in_fresh_interpreter("import sys, terrainav\nprint(*sys.modules)")
    assert [name for name in loaded if name.startswith("terrainav.")] == []


#: Reads by other ways than `files.open_foreign` and `files.read_limited`: by module, and why each is no stranger's.
OWN_READS = {
    "core/storage/files.py": {
        "open(path, mode, buffering, opener=_open_own)": "is the way itself",
        "open(path, 'rb', buffering, opener=_open_regular)": "is the way itself",
        "os.open(path, flags | getattr(os, 'O_NONBLOCK', 0), 438)": "is the way itself",
        "os.open(folder, os.O_RDONLY)": "a folder, to be synchronised",
        "Path(path).open('rb')": "named by the user, and read up to a limit",
    },
    "core/capture/blocks/shards.py": {
        "tarfile.open(fileobj=buffer, mode='w', format=tarfile.USTAR_FORMAT)": "is written"
    },
    "core/cli/__init__.py": {"os.open(os.devnull, os.O_WRONLY)": "is written"},
    "core/dataset/dataset.py": {
        "path.read_bytes()": "of a StoredImage, which reads up to a limit",
        "Image.open(opened.enter_context(file), formats=formats)": "of open_foreign, and asked for its size",
    },
    "core/dataset/loading/streaming.py": {"partial.open('r+b')": "a copy in a folder of ours"},
    "core/imagery/cache/database.py": {
        "sqlite3.connect(database_uri(path, mode), uri=True, timeout=wait_s, isolation_level=None, "
        "check_same_thread=False)": "callers ask whether it is a file; SQLite itself reads as it needs"
    },
    "core/imagery/raster/trust.py": {
        "sqlite3.connect(f'{file.absolute().as_uri()}?mode=ro', uri=True)": "of a file that open_foreign has opened"
    },
    "core/mission/areas/files.py": {"zipfile.ZipFile(io.BytesIO(body))": "of read_limited"},
    "core/mission/export/clearance.py": {"zipfile.ZipFile(io.BytesIO(data))": "made by this program a moment ago"},
    "core/mission/export/wpml.py": {"zipfile.ZipFile(packed, 'w', zipfile.ZIP_DEFLATED)": "is written"},
    "core/sequences/jsbsim.py": {"open(os.devnull, 'wb')": "is written"},
    "core/vectors/index.py": {
        "sqlite3.connect(f'{path.absolute().as_uri()}?mode={mode}', uri=True)": "an index of ours in the cache"
    },
    "core/report/machine.py": {"_CPUINFO.read_text(encoding='utf-8', errors='replace')": "the system's"},
    "core/report/pictures.py": {"Image.open(io.BytesIO(data))": "made by this program a moment ago"},
    "core/resources.py": {"resource(name).read_text(encoding='utf-8')": "is part of the program"},
    "terrainav_plugin/help.py": {"path.read_text(encoding='utf-8')": "is part of the program"},
    "terrainav_plugin/paths.py": {"_MOUNTS.read_text('utf-8', 'replace')": "the system's"},
}
_READERS = {"read_bytes", "read_text", "fromfile", "loadtxt", "genfromtxt", "memmap"}
#: What has an `open` that opens files, and others that read them by name.
_OPENERS = {"", "Image", "io", "os", "codecs", "gzip", "tarfile", "bz2", "lzma"}
_BY_NAME = {"zipfile.ZipFile", "np.load", "sqlite3.connect"}


def reads(path: Path) -> Iterator[str]:
    """Yield the calls of a module that may open or read a file."""
    for call in ast.walk(tree_of(path)):
        if not isinstance(call, ast.Call):
            continue
        of, _, name = ast.unparse(call.func).rpartition(".")
        texts = [one.value for one in call.args if isinstance(one, ast.Constant) and isinstance(one.value, str)]
        # Sources are opened as well, without a mode and such.
        as_file = any("r" in mode for mode in texts) or {"encoding", "newline", "buffering"} & {
            keyword.arg for keyword in call.keywords
        }
        if (
            (name in _READERS and of)
            or (name == "open" and (of in _OPENERS or as_file))
            or ast.unparse(call.func) in _BY_NAME
        ):
            yield ast.unparse(call)


@pytest.mark.parametrize("path", [*MODULES, *PLUGIN_MODULES], ids=identify)
def test_files_of_others_are_opened_one_way(path):
    """By `files.open_foreign` and `files.read_limited`: no device and no pipe, and up to a limit."""
    assert set(reads(path)) == set(OWN_READS.get(identify(path), ()))


#: Readers of JSON that is ours: resources that ship, and texts that were made a line before.
OWN_JSON = {
    "core/resources.py": 1,
    "core/benchmark/making.py": 1,
    "core/capture/begun.py": 1,
    "core/cli/datasets.py": 1,
    "core/mission/export/clearance.py": 1,
    "core/vectors/index.py": 3,
    "terrainav_plugin/processing/datasets.py": 1,
    "terrainav_plugin/remote/geoparquet.py": 1,
}


def test_json_of_others_is_read_within_limits():
    """By `safe_json` alone: Python's own reader takes numbers and depths that end the program later."""
    found = {}
    for path in (*MODULES, *PLUGIN_MODULES):
        nodes = ast.walk(tree_of(path))
        calls = [
            node
            for node in nodes
            if isinstance(node, ast.Attribute)
            and node.attr in ("load", "loads")
            and isinstance(node.value, ast.Name)
            and node.value.id == "json"
        ]
        found[path.relative_to(ROOT).as_posix()] = len(calls)
    assert {name: count for name, count in found.items() if count > OWN_JSON.get(name, 0)} == {}
