"""Known vulnerabilities of the dependencies, in the lowest versions that pyproject.toml allows and in those installed.

The data is that of `pip-audit -s pypi`: the vulnerabilities that the registry's JSON lists for each version. If the
registry cannot be reached, or has no answer, this is printed, as an unchecked version is not a safe one. A finding
fails the run only with ``--strict``, because new ones are published every day.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import requests

_PYPROJECT = Path(__file__).resolve().parent.parent / "pyproject.toml"
_REGISTRY = "https://pypi.org/pypi/{name}/{version}/json"
_TIMEOUT_S = 10.0
#: Dependencies and extras that users install; those of tests and linters are not among them.
_LISTS = re.compile(r"^(?:dependencies|report|raster|ogc|torch|keras) = \[(.*?)\]$", re.MULTILINE | re.DOTALL)
_FLOOR = re.compile(r'"([A-Za-z0-9_.-]+)>=([0-9.]+)')


def floors(text: str) -> dict[str, str]:
    """Lowest version of each dependency, by name."""
    return dict(pair for names in _LISTS.findall(text) for pair in _FLOOR.findall(names))


def versions(text: str) -> Iterator[tuple[str, str]]:
    """Yield names and versions to check: the lowest allowed, and the installed one if it differs."""
    for name, lowest in floors(text).items():
        yield name, lowest
        try:
            installed = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
        if installed != lowest:
            yield name, installed


def known(session: requests.Session, name: str, version: str) -> list[str] | None:
    """One line for each known vulnerability of a version; None if the registry has no answer."""
    answer = session.get(_REGISTRY.format(name=name, version=version), timeout=_TIMEOUT_S)
    if answer.status_code != requests.codes.ok:
        return None
    found = answer.json().get("vulnerabilities", [])
    return [
        f"{one['id']} ({', '.join(one.get('aliases', []))}), mended in {', '.join(one.get('fixed_in', [])) or 'none'}"
        for one in found
        if not one.get("withdrawn")
    ]


def main(arguments: list[str] | None = None) -> int:
    """Print the known vulnerabilities; returns 1 if there are any and ``--strict`` is given."""
    reader = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("--strict", action="store_true", help="fail where a vulnerability is known")
    strict = reader.parse_args(arguments).strict
    unknown: list[str] = []
    findings = looked_at = 0
    with requests.Session() as session:
        for name, version in versions(_PYPROJECT.read_text(encoding="utf-8")):
            try:
                lines = known(session, name, version)
            except requests.RequestException as wrong:
                print(f"audit: the registry cannot be reached ({type(wrong).__name__}); nothing more is checked")
                break
            if lines is None:
                unknown.append(f"{name} {version}")
                continue
            looked_at += 1
            findings += len(lines)
            for line in lines:
                print(f"audit: {name} {version}: {line}")
    if unknown:
        print(f"audit: the registry says nothing of {', '.join(unknown)}: not checked")
    print(f"audit: {looked_at} versions checked, {findings} vulnerabilities known")
    return 1 if strict and findings else 0


if __name__ == "__main__":
    sys.exit(main())
