"""What loading the plugin adds to QGIS's start.

    python benchmarks/startup.py              # writes docs/startup.md

QGIS is started again and again in an X server of its own, each time a new process. Before QGIS loads its plugins, a
hook replaces the two functions it loads one with, so that they note how long each step takes for TerrAInav: importing
the package (`loadPlugin`), and ``classFactory`` with ``initGui`` (`startPlugin`). Cold starts come first:
Linux is asked to drop the plugin's files from its page cache, and Python has no compiled modules of them; warm starts
have both.
"""

from __future__ import annotations

import json
import os
import shutil
import statistics
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))
import qgis_app  # noqa: E402

RESULT = ROOT / "docs" / "startup.md"
STARTS = 7
LIMIT_MS = 50.0
#: What ships in the plugin's zip, as far as it may be read at the start.
SHIPPED = ("__init__.py", "metadata.txt", "core", "terrainav_plugin", "resources")
_ABOUT = (
    f"Written by `python benchmarks/startup.py`: median (and range) of {STARTS} starts of QGIS each, in "
    "milliseconds. Cold: the plugin's files are neither in the page cache nor compiled, as at the first start after an "
    "installation. Warm: every later start."
)
#: Told by the hook to the script that runs inside.
TOLD = "TERRAINAV_STARTUP_TIMES"
HOOK = """
import json, os, sys, time
import qgis.utils

def timed(name, original):
    def run(package):
        if package != "terrainav":
            return original(package)
        before, started = set(sys.modules), time.perf_counter()
        done = original(package)
        note(name, started, before)
        return done
    return run

def note(name, started, before):
    took = 1e3 * (time.perf_counter() - started)
    times = json.loads(os.environ.get("TERRAINAV_STARTUP_TIMES", "{}"))
    times[name] = {"ms": took, "modules": sorted(set(sys.modules) - before)}
    os.environ["TERRAINAV_STARTUP_TIMES"] = json.dumps(times)

def watch_processing():
    kind = sys.modules["terrainav.terrainav_plugin.plugin"].TerrAInavPlugin
    original = kind.initProcessing
    def run(plugin):
        before, started = set(sys.modules), time.perf_counter()
        original(plugin)
        note("after the start: Processing provider", started, before)
    kind.initProcessing = run

def with_class(original):
    def run(package):
        done = original(package)
        if package == "terrainav":
            watch_processing()
        return done
    return run

qgis.utils._startPlugin = with_class(qgis.utils._startPlugin)

qgis.utils.loadPlugin = timed("import of the package", qgis.utils.loadPlugin)
qgis.utils.startPlugin = timed("classFactory and initGui", qgis.utils.startPlugin)
"""


def main() -> int:
    """Measure, write the page, and say whether the plugin keeps to its limit."""
    with tempfile.TemporaryDirectory(prefix="terrainav-startup-") as temporary:
        folder = Path(temporary)
        cold = [_start(folder / f"cold-{number}", cold=True) for number in range(STARTS)]
        warm_folder = folder / "warm"
        _start(warm_folder, cold=False)
        warm = [_start(warm_folder, cold=False) for _ in range(STARTS)]
    text = _page(cold, warm)
    RESULT.write_text(text, encoding="utf-8")
    print(text)
    return 0 if max(_median(cold), _median(warm)) < LIMIT_MS else 1


def _start(folder: Path, *, cold: bool) -> dict[str, dict[str, object]]:
    """Start QGIS with a copy of the plugin; returns the steps' times and what they imported."""
    plugin = folder / "plugin"
    if not plugin.exists():
        for name in SHIPPED:
            source, target = ROOT / name, plugin / name
            if source.is_dir():
                shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(source, target)
    if cold:
        _drop_from_cache(plugin)
    result, script = folder / "times.json", folder / "tell.py"
    script.write_text(
        f"import os, pathlib\npathlib.Path({str(result)!r}).write_text(os.environ[{TOLD!r}])\n",
        encoding="utf-8",
    )
    _run(script, plugin, folder / "profiles")
    return dict(json.loads(result.read_text(encoding="utf-8")))


def _run(script: Path, plugin: Path, profiles: Path) -> None:
    write_hooks, link_of = qgis_app.write_hooks, qgis_app.ROOT

    def with_hook(folder, job):  # type: ignore[no-untyped-def]
        before, after = write_hooks(folder, {**job, "root": str(link_of)})
        before.write_text(before.read_text(encoding="utf-8") + HOOK, encoding="utf-8")
        return before, after

    make_profile = qgis_app.make_profile

    def with_copy(folder: Path, settings: str, **options: bool) -> None:
        make_profile(folder, settings, **options)
        link = folder / "profiles" / "default" / "python" / "plugins" / qgis_app.PLUGIN
        link.unlink()
        link.symlink_to(plugin, target_is_directory=True)

    qgis_app.write_hooks, qgis_app.make_profile = with_hook, with_copy
    try:
        # Compiled modules are kept, as they are on a user's disk.
        code = qgis_app.run(
            [str(script)], timeout_s=120, profiles=profiles, extra_environment={"PYTHONDONTWRITEBYTECODE": ""}
        )
    finally:
        qgis_app.write_hooks, qgis_app.make_profile = write_hooks, make_profile
    if code:
        raise SystemExit(f"QGIS ended with code {code}")


def _drop_from_cache(folder: Path) -> None:
    for path in folder.rglob("*"):
        if path.is_file():
            descriptor = os.open(path, os.O_RDONLY)
            try:
                os.fsync(descriptor)
                os.posix_fadvise(descriptor, 0, 0, os.POSIX_FADV_DONTNEED)
            finally:
                os.close(descriptor)


def _total(start: dict[str, dict[str, object]]) -> float:
    """Milliseconds that QGIS waits for the plugin."""
    return sum(float(str(step["ms"])) for name, step in start.items() if not name.startswith("after"))


def _median(starts: list[dict[str, dict[str, object]]]) -> float:
    return statistics.median(_total(start) for start in starts)


def _page(cold: list[dict[str, dict[str, object]]], warm: list[dict[str, dict[str, object]]]) -> str:
    from terrainav.core.report.machine import machine

    lines = [
        "# Time that the plugin adds to QGIS's start",
        "",
        _ABOUT,
        "",
        "| step | cold | warm |",
        "| --- | ---: | ---: |",
    ]
    steps = list(warm[0])
    rows = [(step, [[float(str(one[step]["ms"])) for one in starts] for starts in (cold, warm)]) for step in steps]
    rows.append(("together, while QGIS starts", [[_total(one) for one in starts] for starts in (cold, warm)]))
    for name, columns in rows:
        cells = (f"{statistics.median(ms):.1f} ({min(ms):.1f} to {max(ms):.1f})" for ms in columns)
        lines.append(f"| {name} | {' | '.join(cells)} |")
    steps_of_start = [step for name, step in warm[0].items() if not name.startswith("after")]
    modules = sorted({str(name) for step in steps_of_start for name in list(step["modules"])})  # type: ignore[call-overload]
    others = [name for name in modules if name.partition(".")[0] != "terrainav"]
    own = [name for name in modules if name not in others]
    lines += [
        "",
        f"Loaded modules of the plugin: {len(own)} ({', '.join(own)}).",
        f"Other modules that were not loaded before: {', '.join(others) or 'none'}.",
        "",
        *(f"- {name}: {value}" for name, value in machine()),
        f"- load average: {os.getloadavg()[0]:.1f}",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
