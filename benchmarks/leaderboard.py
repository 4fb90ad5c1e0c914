"""Baselines on two benchmarks: the embedded world, and NAIP across eleven years.

    python benchmarks/leaderboard.py --naip shared/data/naip    # writes the tables and pictures of docs/benchmark.md

Without --naip the embedded world alone. Every benchmark is made, run and judged by the command, as docs/benchmark.md
walks through it. The tables are the same to the last digit on one machine; times are not in them.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
PAGE, PICTURES = ROOT / "docs" / "benchmark.md", ROOT / "docs" / "images"
METHODS = ("middle", "ncc", "sift", "orb")
#: Figures in the tables, and how they are headed there.
SHOWN = {
    "recall@1": "R@1",
    "recall@5": "R@5",
    "AP": "AP",
    "SDM@1 per metre": "SDM@1 /m",
    "PDM@1": "PDM@1",
    "within 5 m": "5 m",
    "within 20 m": "20 m",
    "position": "median",
}
WORLD = (
    *("--coords", "35.1575_-89.8975_35.1475_-89.8825_120", "--image-px", "320", "--yaw", "25"),
    *("--queries", "satellite=world", "roadmap=world:roadmap", "--reference", "satellite=world"),
)
DATES = {"2009": "20090818", "2014": "20140720", "2020": "20200831"}


def naip(folder: Path) -> tuple[str, ...]:
    """Options of the benchmark over NAIP: queries of three dates, and 2014 as the reference."""
    files = {date: folder / f"{name}.tif" for date, name in DATES.items()}
    queries = [f"{date}={path}" for date, path in files.items()]
    return (
        *("--coords", "47.0290_-99.1775_47.0085_-99.1330_400", "--yaw", "30", "--format", "png"),
        *("--queries", *queries, "--reference", f"2014={files['2014']}"),
    )


def terrainav(*arguments: str) -> str:
    """Run the command; what it prints."""
    done = subprocess.run(
        [sys.executable, "-m", "terrainav.core.cli", *arguments],
        check=False,
        capture_output=True,
        text=True,
        cwd=ROOT.parent,
    )
    if done.returncode:
        raise SystemExit(done.stderr or done.stdout)
    return done.stdout


def judged(folder: Path, options: tuple[str, ...]) -> dict[str, dict[str, dict[str, float | None]]]:
    """Figures by method, imagery and name, of a benchmark that is made in a folder."""
    made = terrainav("benchmark", "make", *options, "--split", "none", "--data-dir", str(folder), "--quiet")
    print(made, end="", file=sys.stderr)
    found = {}
    for method in METHODS:
        text = terrainav("benchmark", "run", str(folder), "--method", method, "--json", "--quiet")
        groups = json.loads(text)["groups"]
        found[method] = {
            name: {one["name"]: one["value"] for one in figures} for name, figures in groups.items() if name != "all"
        }
        print(f"{folder.name}: {method}", file=sys.stderr)
    return found


def table(found: dict[str, dict[str, dict[str, float | None]]]) -> str:
    """Rows of Markdown."""
    lines = ["| method | queries | " + " | ".join(SHOWN.values()) + " |", "| --- " * (len(SHOWN) + 2) + "|"]
    for method, groups in found.items():
        for imagery, figures in groups.items():
            cells = (cell(name, figures.get(name)) for name in SHOWN)
            lines.append(f"| {method} | {imagery} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def cell(name: str, value: float | None) -> str:
    """A figure as the tables have it: shares in per cent, the median in metres."""
    if value is None:
        return "–"
    if name == "position":
        return f"{value:,.0f} m" if value >= 100.0 else f"{value:.3g} m"
    return f"{value:.3f}" if name.startswith(("SDM", "PDM")) else f"{100.0 * value:.1f}"


def put(page: str, mark: str, text: str) -> str:
    """A page with what stands between two marks replaced."""
    pattern = rf"(<!-- {mark} -->\n).*?(<!-- /{mark} -->)"
    changed, count = re.subn(pattern, lambda found: f"{found[1]}{text}\n{found[2]}", page, flags=re.DOTALL)
    if count != 1:
        raise SystemExit(f"{PAGE}: has no place for {mark}")
    return changed


def main() -> None:
    """Make, run, judge, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--naip", type=Path, help="folder of 20090818.tif, 20140720.tif and 20200831.tif")
    arguments = parser.parse_args()
    page = PAGE.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        page = put(page, "world", table(judged(folder / "world", WORLD)))
        if arguments.naip is not None:
            page = put(page, "naip", table(judged(folder / "naip", naip(arguments.naip.resolve()))))
            scores = folder / "naip" / "scores" / "ncc"
            for name in ("within", "map"):
                shutil.copy(scores / f"{name}.png", PICTURES / f"benchmark-{name}.png")
            # Photographs, which PNG makes large.
            with Image.open(scores / "failures.png") as sheet:
                sheet.convert("RGB").save(PICTURES / "benchmark-failures.jpg", quality=82, optimize=True)
    PAGE.write_text(page, encoding="utf-8")
    print(f"written to {PAGE}")


if __name__ == "__main__":
    main()
