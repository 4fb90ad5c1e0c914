"""Every case of the extreme suite in one table.

python benchmarks/extremes.py           # some minutes; writes docs/extremes.md
"""

from __future__ import annotations

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


def number(value: float) -> str:
    """Two digits, or a word."""
    if math.isinf(value):
        return "∞"
    return "" if math.isnan(value) else f"{value:.2g}"


def row(outcome: Outcome) -> str:
    """One line of the table."""
    name, mission, _ = outcome.case
    if outcome.refusal:
        return (
            f"| {name} | refused: {outcome.refusal.replace('|', '/')} | | | | {outcome.seconds * 1e3:.0f} |"
        )
    bound = bound_text(outcome.bound_px) if mission.accuracy.error_budget_px else ""
    return (
        f"| {name} | {outcome.methods} | {bound} | {number(outcome.error_px)} | {number(outcome.condition)} | "
        f"{outcome.seconds * 1e3:.0f} |"
    )


def page(outcomes: list[Outcome]) -> str:
    """Text of docs/extremes.md."""
    flown = [outcome for outcome in outcomes if not outcome.refusal]
    worst = max(flown, key=lambda outcome: outcome.error_px)
    tightest = max(flown, key=lambda outcome: outcome.error_px / outcome.bound_px)
    slowest = max(outcomes, key=lambda outcome: outcome.seconds)
    reasons = Counter(
        outcome.refusal.partition(":")[2].partition(";")[0].strip() for outcome in outcomes if outcome.refusal
    )
    most_refused = ", ".join(f"{count} × “{reason[:70]}”" for reason, count in reasons.most_common(3))
    small = sum(TOO_SMALL in outcome.refusal for outcome in outcomes)
    fallen_back = [o for o in outcomes if TOO_SMALL in planned_as(o.case, "map")]
    seen = sum(not outcome.refusal for outcome in fallen_back)
    missed = sum(not planned_as(outcome.case, "camera") for outcome in outcomes if outcome.refusal)
    rows = "\n".join(map(row, outcomes))
    return f"""# Extreme cases

Made by `python benchmarks/extremes.py`, with a budget of 0.1 px. Errors are measured in long double at the corners of
up to 50 captures and across one picture; times are those of the plan with its coverage, overlap and first outline.

{len(outcomes):,} cases: {len(flown):,} were planned, all of them within their bound, and
{len(outcomes) - len(flown):,} were refused with one line. The worst measured error is {worst.error_px:.2g} px
({worst.case.name}); the one nearest to its bound is {tightest.error_px / tightest.bound_px:.2f} of it
({tightest.case.name}). The slowest case took {slowest.seconds:.1f} s ({slowest.case.name}).
Most refusals: {most_refused}.

Map frames alone would refuse {len(fallen_back)} cases as “{TOO_SMALL}”; {seen} of them are planned as camera frames,
and {small} end so. Of the {len(outcomes) - len(flown)} that are refused, {missed} could be shown by camera frames.

| case | methods (footprint, picture, mesh) or refusal | bound, px | measured, px | condition | ms |
| --- | --- | ---: | ---: | ---: | ---: |
{rows}
"""


def main() -> None:
    """Write the page; fail where a case is outside its bound."""
    outcomes = [run(case) for case in cases()]
    broken = [o.case.name for o in outcomes if not o.refusal and not o.error_px <= o.bound_px]
    text = page(outcomes)
    (ROOT / "docs" / "extremes.md").write_text(text, encoding="utf-8")
    print(text.partition("| case |")[0])
    if broken:
        sys.exit(f"outside their bound: {', '.join(broken)}")


if __name__ == "__main__":
    main()
