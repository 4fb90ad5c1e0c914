"""What the command imports: its words need nothing of what works on missions, and a mission only what it uses."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.support.thinning import sampled

COMMANDS = (
    "plan",
    "capture",
    "clean",
    "split",
    "convert",
    "mosaic",
    "pairs",
    "load",
    "report",
    "sources",
    "cameras",
    "cache",
)
#: What only relief needs.
TRACING = "terrainav.core.geodesy.raytracing.tracing"
#: Runs the command for each of the lines of the first argument, and prints codes, and what was imported.
PROGRAM = """
import sys
from terrainav.core.cli import main
codes = []
for line in sys.argv[1].splitlines():
    try:
        codes.append(main(line.split()))
    except SystemExit as end:
        codes.append(end.code)
print(*codes, "modules", *sys.modules, file=sys.stderr)
"""


def run(*lines, cwd):
    """Exit codes of the command for each line, and the packages and modules that all of them imported."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("TERRAINAV_")}
    environment |= {"XDG_CACHE_HOME": str(cwd), "XDG_CONFIG_HOME": str(cwd)}
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM, "\n".join(lines)],
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
        cwd=cwd,
        env=environment,
    )
    codes, _, modules = ended.stderr.splitlines()[-1].partition(" modules ")
    names = set(modules.split())
    return [int(code) for code in codes.split()], names


def test_help_imports_nothing_that_runs(tmp_path):
    codes, modules = run(*(f"{command} --help" for command in COMMANDS), cwd=tmp_path)
    assert codes == [0] * len(COMMANDS)
    runs = {f"terrainav.core.cli.{name}" for name in ("flying", "pairing", "datasets", "listing")}
    assert not modules & {*runs, "terrainav.core.text.plain", "terrainav.core.storage.files"}


def test_the_version_is_told_without_the_options(tmp_path):
    codes, modules = run("--version", cwd=tmp_path)
    assert codes == [0]
    assert not modules & {"numpy", "pyproj", "requests", "PIL", "argparse", "terrainav.core.mission"}


def test_help_and_refusals_need_no_numerics(tmp_path):
    lines = ["--help", "", *(f"{command} --help" for command in COMMANDS)]
    refused = ["--wrong", "swim", *(f"{command} --wrong" for command in COMMANDS), "load out --part none"]
    codes, modules = run(*lines, *refused, cwd=tmp_path)
    assert codes == [0] * len(lines) + [2] * len(refused)
    assert not modules & {"numpy", "pyproj", "requests", "PIL", "owslib", "matplotlib"}


@pytest.mark.parametrize(
    ("line", "unused"),
    sampled(
        [
            ("plan --coords 35.14_-89.86_120 --json", {"requests", "urllib3", "PIL", "owslib", TRACING}),
            ("plan --coords 35.14_-89.86_120 --yaw 30 --output p.csv", {"requests", "urllib3", "owslib"}),
            ("capture --coords 35.14_-89.86_120 --data-dir out", {"requests", "urllib3", "owslib", TRACING}),
            ("cameras", {"requests", "pyproj", "PIL", "owslib"}),
            ("sources", {"requests", "pyproj", "PIL", "owslib"}),
        ],
        2,
    ),
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_is_not_used_is_not_imported(line, unused, tmp_path):
    codes, modules = run(line, cwd=tmp_path)
    assert codes == [0]
    assert not modules & unused


def test_a_plain_box_on_the_web_mercator_map_is_planned_without_proj_gusts_and_relief():
    program = """
import sys
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
assert len(plan(Mission(Box(35.16, -89.90, 35.158, -89.898), 120.0), PixelGrid()))
print(*sys.modules)
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not set(ended.stdout.split()) & {"pyproj", "terrainav.core.mission.flight.gusts", TRACING}


@pytest.mark.thorough
def test_a_source_on_the_network_has_what_it_needs(tmp_path):
    """A plan asks nobody for tiles; a capture does, and so the modules that the embedded world goes without do come."""
    codes, modules = run("plan --coords 35.14_-89.86_120 --source osm --accept-error", cwd=tmp_path)
    assert codes == [0]
    assert not modules & {"requests", "urllib3", "PIL"}
    nowhere = "--source http://127.0.0.1:9/{z}/{x}/{y}.png"
    codes, modules = run(f"capture --coords 35.14_-89.86_120 --data-dir out {nowhere}", cwd=tmp_path)
    assert codes == [1]
    assert "requests" in modules
