"""Attack for a time: ``python -m tests.fuzz [TARGET …]``, for TERRAINAV_FUZZ_S seconds (600).

A failure is printed with its seed, and tried again by ``python -m tests.fuzz --seed SEED TARGET``.
"""

from __future__ import annotations

import argparse
import logging
import os
import secrets
import sys
import tempfile
import time
import traceback

from tests.fuzz.support import all_targets, peak_bytes, settled

#: Examples of a draw: a seed, and what is printed with it.
_EXAMPLES = 100


def main() -> int:
    """Draw from one target after the other until the time is over; returns 1 where something was found."""
    reader = argparse.ArgumentParser(prog="python -m tests.fuzz")
    reader.add_argument("names", nargs="*", metavar="TARGET")
    reader.add_argument("--seed", type=int, help="draw this one, once")
    arguments = reader.parse_args()
    chosen = [one for one in all_targets() if not arguments.names or one.name in arguments.names]
    if not chosen:
        reader.error(f"no such target; there are {', '.join(one.name for one in all_targets())}")
    until_s = time.monotonic() + float(os.environ.get("TERRAINAV_FUZZ_S", "600"))
    found: set[str] = set()
    failures = 0
    logging.disable(logging.CRITICAL)
    with tempfile.TemporaryDirectory(prefix="terrainav-fuzz-") as folder:
        os.chdir(folder)
        os.environ["TERRAINAV_CONFIG_DIR"] = folder
        while True:
            for target in chosen:
                seed = secrets.randbits(32) if arguments.seed is None else arguments.seed
                try:
                    target.draw(_EXAMPLES, seed)
                except Exception as wrong:  # noqa: BLE001 (each is a finding)
                    failures += 1
                    place = traceback.extract_tb(wrong.__traceback__)[-1]
                    key = f"{target.name}: {type(wrong).__name__} in {place.filename}:{place.lineno}"
                    if key not in found:
                        found.add(key)
                        print(f"FOUND {key}, --seed {seed}", flush=True)
                        traceback.print_exception(type(wrong), wrong, wrong.__traceback__)
                settled()
            if arguments.seed is not None or time.monotonic() > until_s:
                break
        os.chdir("/")
    for target in chosen:
        counts = f"{target.examples:10,} examples, {target.accepted:8,} accepted"
        print(f"{target.name:24s}{counts}, slowest {target.slowest_s:.2f} s")
    total = sum(target.examples for target in chosen)
    print(f"{total:,} examples, {len(found)} findings in {failures} draws, peak {peak_bytes() / 1e6:,.0f} MB")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
