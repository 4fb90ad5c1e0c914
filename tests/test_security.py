"""What docs/security.md says, and what the look at the dependencies makes of the registry's answers."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest
import requests
from terrainav.core.cli import exits

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "security.md").read_text(encoding="utf-8")


def tool(name):
    found = importlib.util.spec_from_file_location(name, ROOT / "tools" / f"{name}.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_the_page_states_every_limit_as_the_program_has_it():
    limits = tool("limits")
    assert len(limits.limits()) >= 9
    assert all(comment.endswith(".") for _, comment in limits.limits().values())
    assert limits.replaced(PAGE) == PAGE, "run tools/limits.py"


def test_the_page_states_every_exit_code():
    stated = {int(code) for row in re.findall(r"^\| ([\d, ]+) \|", PAGE, re.MULTILINE) for code in row.split(",")}
    codes = {value for name, value in vars(exits).items() if name.isupper()}
    assert codes | {exits.exit_code(number) for number in (1, 15)} == stated


class Registry:
    """Session whose answers are known: of a name and version, or an error."""

    def __init__(self, answers):
        self.answers = answers

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def get(self, url, timeout):
        answer = requests.Response()
        *_, name, version, _ = url.split("/")
        found = self.answers.get((name, version)) if isinstance(self.answers, dict) else None
        if isinstance(self.answers, Exception):
            raise self.answers
        answer.status_code = 404 if found is None else 200
        answer._content = (found or "").encode()
        return answer


BAD = (
    '{"vulnerabilities": [{"id": "X-1", "aliases": ["CVE-1"], "fixed_in": ["3"]}, {"id": "X-2", "withdrawn": "2024"}]}'
)


@pytest.mark.parametrize(
    ("answers", "strict", "code", "says"),
    [
        (requests.ConnectionError(), True, 0, "the registry cannot be reached (ConnectionError)"),
        ({}, True, 0, "the registry says nothing of numpy 1.2, nobodys-package 3: not checked"),
        (
            {("numpy", "1.2"): '{"vulnerabilities": []}'},
            True,
            0,
            "1 versions checked, 0 vulnerabilities known",
        ),
        ({("numpy", "1.2"): BAD}, False, 0, "audit: numpy 1.2: X-1 (CVE-1), mended in 3\n"),
        ({("numpy", "1.2"): BAD}, True, 1, "1 versions checked, 1 vulnerabilities known"),
    ],
)
def test_the_look_at_the_dependencies_says_what_it_knows_and_what_not(
    tmp_path, monkeypatch, capsys, answers, strict, code, says
):
    audit = tool("audit")
    pyproject = tmp_path / "pyproject.toml"
    pyproject.write_text('dependencies = ["numpy>=1.2"]\nraster = ["nobodys-package>=3,<4"]\nlint = ["ruff>=9"]\n')
    monkeypatch.setattr(audit, "_PYPROJECT", pyproject)
    monkeypatch.setattr(audit.importlib.metadata, "version", lambda name: {"numpy": "1.2"}[name])
    monkeypatch.setattr(audit.importlib.metadata, "PackageNotFoundError", KeyError)
    monkeypatch.setattr(audit.requests, "Session", lambda: Registry(answers))
    assert audit.main(["--strict"] if strict else []) == code
    assert says in capsys.readouterr().out


def test_the_look_at_the_dependencies_finds_them_all():
    audit = tool("audit")
    found = audit.floors((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert {
        "numpy",
        "pyproj",
        "requests",
        "pillow",
        "matplotlib",
        "rasterio",
        "owslib",
        "torch",
        "keras",
    } <= set(found)
