"""Docstrings and code name the same parameters and attributes."""

from __future__ import annotations

import ast
import gc
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: Sections of a docstring that list names (numpydoc), up to the next section or the end.
_SECTION = re.compile(r"^(?:Parameters|Attributes|Signals)\n-+\n(.*?)(?=^[\w ]+\n-{3,}\n|\Z)", re.MULTILINE | re.DOTALL)
#: Names that begin an entry: one or several, perhaps with a type.
_ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: : .+)?$", re.MULTILINE)


def listed(docstring: str) -> list[str]:
    """Names that the sections of a docstring list."""
    entries = (names for section in _SECTION.findall(docstring) for names in _ENTRY.findall(section))
    return [name.strip().lstrip("*") for names in entries for name in names.split(",")]


def signature(function: ast.FunctionDef | ast.AsyncFunctionDef) -> set[str]:
    """Names of a function's parameters."""
    asked = function.args
    given = (*asked.posonlyargs, *asked.args, *asked.kwonlyargs, asked.vararg, asked.kwarg)
    return {one.arg for one in given if one is not None}


def members(one: ast.ClassDef, classes: dict[str, list[ast.ClassDef]]) -> set[str]:
    """Names of a class: its fields, properties and methods, what its constructor takes and sets, and its bases' own."""
    found = set()
    for node in one.body:
        if isinstance(node, ast.FunctionDef):
            found.add(node.name)
            if node.name in ("__init__", "__new__"):
                found |= signature(node)
            found |= {
                target.attr
                for target in ast.walk(node)
                if isinstance(target, ast.Attribute) and isinstance(target.ctx, ast.Store)
            }
        elif isinstance(node, (ast.AnnAssign, ast.Assign)):
            targets = [node.target] if isinstance(node, ast.AnnAssign) else node.targets
            found |= {target.id for target in targets if isinstance(target, ast.Name)}
    bases = (base.id for base in one.bases if isinstance(base, ast.Name))
    return found.union(*(members(base, classes) for name in bases for base in classes.get(name, ())))


def definitions(node: ast.AST) -> Iterator[ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef]:
    """Yield the classes and functions of a module, however deep."""
    for one in (*getattr(node, "body", ()), *getattr(node, "orelse", ())):
        if isinstance(one, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            yield one
        yield from definitions(one)


def unknown(sources: dict[str, str]) -> list[str]:
    """Return a line for each name that a docstring lists and the code does not have."""
    # Millions of nodes that stay: looking for garbage among them takes twice as long as parsing.
    gc.disable()
    try:
        found = [(path, one) for path, text in sources.items() for one in definitions(ast.parse(text))]
    finally:
        gc.enable()
    classes: dict[str, list[ast.ClassDef]] = {}
    for _, one in found:
        if isinstance(one, ast.ClassDef):
            classes.setdefault(one.name, []).append(one)
    wrong = []
    for path, one in found:
        names = listed(ast.get_docstring(one) or "")
        if names:
            known = members(one, classes) if isinstance(one, ast.ClassDef) else signature(one)
            wrong += [f"{path}: {one.name} has no {name!r}" for name in names if name not in known]
    return wrong


def test_docstrings_list_what_the_code_has():
    paths = [path for room in ("core", "terrainav_plugin") for path in sorted((ROOT / room).rglob("*.py"))]
    wrong = unknown({str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in paths})
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    ("code", "wrong"),
    [
        ("class A:\n    {0}\n    place: int", ["A has no 'width'"]),
        ("class A:\n    {0}\n    place: int\n    @property\n    def width(self): ...", []),
        ("class A:\n    {0}\n    def __init__(self, place):\n        self.width = place", []),
        ("class B:\n    width = 1\nclass A(B):\n    {0}\n    place: int", []),
        ("class A(Protocol):\n    {0}\n    place: int\n    def width(self): ...", []),
        ("if True:\n    class B:\n        def a(self, place):\n            {0}", ["a has no 'width'"]),
        ("def a(place, *, width):\n    {0}", []),
        ("async def a(*place, **width):\n    {0}", []),
        ("def a(place):\n    width = 1\n    {0}", []),
    ],
)
def test_a_name_that_is_not_there_is_found(code, wrong):
    """The last has no docstring: it begins with a statement."""
    docstring = '"""A.\n\nParameters\n----------\nplace, width : int\n    Of it.\n\nReturns\n-------\nother : int\n"""'
    assert unknown({"a.py": code.format(docstring)}) == [f"a.py: {line}" for line in wrong]
