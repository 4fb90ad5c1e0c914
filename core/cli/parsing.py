"""Options that several subcommands share."""

from __future__ import annotations

import argparse
from typing import Any


def add_json(command: argparse.ArgumentParser, default: Any = False) -> None:
    """Add ``--json``; with `argparse.SUPPRESS` an action leaves what its command was given."""
    command.add_argument("--json", action="store_true", default=default, help="print as JSON")
