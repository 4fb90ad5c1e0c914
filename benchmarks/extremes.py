"""Every case of the extreme suite in one table, and what it says on one page.

python benchmarks/extremes.py           # some minutes; writes docs/extremes.md and extremes.csv
"""

from __future__ import annotations

import csv
import math
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from terrainav.core.mission.methods import bound_text  # noqa: E402

from tests.core.mission.extremes import Outcome, cases, planned_as, run  # noqa: E402

#: What map frames are refused for where their pixels are larger than the picture.
TOO_SMALL = "under one pixel"
COLUMNS = ("case", "methods", "refusal", "bound_px", "measured_px", "condition", "ms")


def number(value: float) -> str:
    """Two digits; nothing where there is no value."""
    return "" if math.isnan(value) else f"{value:.2g}"


def row(outcome: Outcome) -> tuple[str, ...]:
    """One line of the table."""
    figures = (outcome.error_px, outcome.condition)
    shown = ("",) * 3 if outcome.refusal else (bound_text(outcome.bound_px), *map(number, figures))
    return (outcome.case.name, outcome.methods, outcome.refusal, *shown, f"{outcome.seconds * 1e3:.0f}")


def page(outcomes: list[Outcome]) -> str:
    """Text of docs/extremes.md."""
    flown = [outcome for outcome in outcomes if not outcome.refusal]
    refused = [outcome for outcome in outcomes if outcome.refusal]
    worst = max(flown, key=lambda outcome: outcome.error_px)
    tightest = max(flown, key=lambda outcome: outcome.error_px / outcome.bound_px)
    slowest = max(outcomes, key=lambda outcome: outcome.seconds)
    reasons = Counter(one.refusal.partition(":")[2].partition(";")[0].strip() for one in refused)
    most_refused = "\n".join(f"| {reason[:70]} | {count} |" for reason, count in reasons.most_common(3))
    fallen_back = [one for one in outcomes if TOO_SMALL in planned_as(one.case, "map")]
    seen = sum(not one.refusal for one in fallen_back)
    missed = sum(not planned_as(one.case, "camera") for one in refused)
    return f"""# Extreme cases

{len(outcomes):,} missions from 1 cm to 36,000 km above ground, with cameras of 0.01° to 179.9° and of 1:1000 to 1000:1,
from the equator to the poles, across the antimeridian and with the horizon in the image, are planned with a budget of
0.1 px. Errors are measured in long double at the corners of up to 50 captures and across one image; times include
coverage, overlap and the first outline.

| | cases |
| --- | ---: |
| planned, each within its bound | {len(flown):,} |
| refused with one line | {len(refused):,} |
| refused, though camera frames could show them | {missed} |
| refused as map frames (“{TOO_SMALL}”) | {len(fallen_back)} |
| of these planned as camera frames | {seen} |

| worst | figure | bound | case |
| --- | ---: | ---: | --- |
| measured error, px | {number(worst.error_px)} | {bound_text(worst.bound_px)} | {worst.case.name} |
| error over its bound | {tightest.error_px / tightest.bound_px:.2f} | 1 | {tightest.case.name} |
| seconds | {slowest.seconds:.1f} | | {slowest.case.name} |

| most refused for | cases |
| --- | ---: |
{most_refused}

All cases are in [extremes.csv](extremes.csv). `python benchmarks/extremes.py` measures them again, writes both files,
and fails if a case exceeds its bound.
"""


def main() -> None:
    """Write page and table; fail where a case is outside its bound."""
    outcomes = [run(case) for case in cases()]
    broken = [o.case.name for o in outcomes if not o.refusal and not o.error_px <= o.bound_px]
    text = page(outcomes)
    (ROOT / "docs" / "extremes.md").write_text(text, encoding="utf-8")
    with (ROOT / "docs" / "extremes.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *map(row, outcomes)])
    print(text)
    if broken:
        sys.exit(f"outside their bound: {', '.join(broken)}")


if __name__ == "__main__":
    main()
