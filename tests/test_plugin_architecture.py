"""The rooms of the plugin, the direction of its arrows and that none leads back, read from the source itself."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from tests.support.trees import tree_of

ROOT = Path(__file__).resolve().parents[1]
PLUGIN = ROOT / "terrainav_plugin"

# What lies in the plugin's own folder, by floors.
TOP = {"plugin", "session"}
SOURCES = {"planner", "sources"}

# Floors from below. A room imports what lies on floors below its own, and of its own floor nothing but itself: rooms
# of one floor talk through signals and callables that the session joins. Of all floors only the lowest, of single
# modules, may use each other.
FLOORS = (
    {"base"},
    {"form", "map", "network"},
    {"dataset", "qgis_source", "remote"},
    {"sources"},
    {"area", "preview", "capture", "results", "missions", "dataset_window", "profile", "live"},
    {"panel", "processing"},
    {"top"},
)
#: Only what they need of the floors below: neither draws a window.
NARROW = {
    "form": {"base"},
    "map": {"base"},
    "network": {"base"},
    "dataset": {"base", "map"},
    "qgis_source": {"base", "map", "network"},
    "remote": {"base", "network"},
    "sources": {"base", "form", "qgis_source", "network"},
}
#: What stays loadable without a window's classes.
WITHOUT_WIDGETS = ("form", "dataset", "qgis_source", "network", "remote")


def module_of(path: Path) -> str:
    """``panel.dock`` for ``terrainav_plugin/panel/dock.py``, ``panel`` for the room itself."""
    parts = path.relative_to(PLUGIN).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


PATHS = {module_of(path): path for path in sorted(PLUGIN.rglob("*.py"))}


def room_of(module: str) -> str:
    first, inside, _ = module.partition(".")
    if inside or first not in PATHS or PATHS[first].name == "__init__.py":
        return first
    return "top" if first in TOP else "sources" if first in SOURCES else "base"


def imported(module: str, path: Path) -> set[str]:
    """Modules of the plugin that a module imports: when it is loaded, within functions, or for types alone."""
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    found = set()
    for node in ast.walk(tree_of(path)):
        if not isinstance(node, ast.ImportFrom) or not node.level or node.level > len(package) + 1:
            continue
        base = package[: len(package) - node.level + 1] + (node.module.split(".") if node.module else [])
        for alias in node.names:
            names = (".".join([*base, alias.name]), ".".join(base))
            found |= {next(name for name in (*names, "") if name in PATHS or not name)}
    return found - {"", module}


GRAPH = {module: imported(module, path) for module, path in PATHS.items()}
ROOMS = {room_of(module) for module in PATHS} - {""}


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Modules that lead back to themselves, those of one circle together."""
    reached: dict[str, set[str]] = {}
    for start in graph:
        found, open_ends = set(), [start]
        while open_ends:
            new = graph[open_ends.pop()] - found
            found |= new
            open_ends += new
        reached[start] = found
    rings = {
        frozenset(other for other in reached[module] if module in reached[other])
        for module in graph
        if module in reached[module]
    }
    return sorted(sorted(ring) for ring in rings)


def test_every_room_is_on_a_floor():
    assert set().union(*FLOORS) == ROOMS
    assert set(NARROW) <= ROOMS


def test_imports_are_seen():
    assert {"panel.planning", "area.control", "capture.queue"} <= GRAPH["session"]
    # Within a function, and for types alone.
    assert {"processing.provider", "session"} <= GRAPH["plugin"]


@pytest.mark.parametrize("module", sorted(PATHS), ids=str)
def test_arrows_point_one_way(module):
    here = room_of(module)
    floor = next((number for number, rooms in enumerate(FLOORS) if here in rooms), 0)
    allowed = NARROW.get(here, set().union(*FLOORS[:floor])) | {here}
    wrong = sorted(other for other in GRAPH[module] if room_of(other) not in allowed)
    assert wrong == [], f"{here} may import from {sorted(allowed)} only"


def test_nothing_leads_back_to_itself():
    assert circles(GRAPH) == []


def test_circles_are_found():
    graph = {"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}, "e": {"e"}}
    assert circles(graph) == [["a", "b", "c"], ["e"]]


@pytest.mark.parametrize("room", sorted(path.parent.name for path in PLUGIN.glob("*/__init__.py")))
def test_a_room_names_its_modules_in_reading_order(room):
    text = (PLUGIN / room / "__init__.py").read_text(encoding="utf-8")
    named = [line.split()[0] for line in ast.get_docstring(ast.parse(text)).splitlines()[2:]]
    assert sorted(named) == sorted(path.stem for path in (PLUGIN / room).glob("*.py") if path.stem != "__init__")


@pytest.mark.parametrize("module", [module for module in sorted(PATHS) if room_of(module) in WITHOUT_WIDGETS], ids=str)
def test_rooms_below_the_windows_know_no_widget(module):
    tree = tree_of(PATHS[module])
    origins = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert not any(origin.endswith(("QtWidgets", "qgis.gui")) for origin in origins)
    assert "widgets" not in GRAPH[module]


# Show the terms of a provider, and why methods were chosen, as HTML, which they make of escaped texts.
_OF_HTML = {"capture.questions", "panel.figures"}
_TIPS = {"setToolTip", "setStatusTip", "setWhatsThis"}
_BOXES = {"question", "warning", "information", "critical", "about"}


def is_of_others(text: ast.expr) -> bool:
    """Whether a text that Qt may take for HTML is put together of others, without `shown_plain`."""
    if isinstance(text, ast.IfExp):
        return is_of_others(text.body) or is_of_others(text.orelse)
    if isinstance(text, ast.Call) and isinstance(text.func, ast.Name):
        return False
    if isinstance(text, ast.Call) and isinstance(text.func, ast.Attribute) and text.func.attr == "format":
        # Numbers and keys of the keyboard are the program's own.
        own = {"step", "shift", "page", "count", "text", "keys"}
        return not {one.arg for one in text.keywords} <= own
    return not isinstance(text, (ast.Constant, ast.Name))


@pytest.mark.parametrize("module", sorted(PATHS.keys() - _OF_HTML))
def test_tips_and_message_boxes_show_texts_of_others_as_they_are(module):
    wrong = []
    for node in ast.walk(tree_of(PATHS[module])):
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
            continue
        of_box = isinstance(node.func.value, ast.Name) and node.func.value.id == "QMessageBox"
        if of_box and node.func.attr in _BOXES:
            shown = node.args[2]
            is_safe = isinstance(shown, ast.Call) and getattr(shown.func, "id", "") in ("shown_plain", "tr")
            wrong += [] if is_safe else [node.lineno]
        elif node.func.attr in _TIPS and node.args and is_of_others(node.args[0]):
            wrong.append(node.lineno)
    assert wrong == []
