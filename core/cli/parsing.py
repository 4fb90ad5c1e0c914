"""Options that several subcommands share."""

from __future__ import annotations

import argparse
import os
from typing import Any


def add_json(command: argparse.ArgumentParser, default: Any = False) -> None:
    """Add ``--json``; with `argparse.SUPPRESS` an action leaves what its command was given."""
    command.add_argument("--json", action="store_true", default=default, help="print as JSON")


def names_source(arguments: argparse.Namespace) -> bool:
    """Whether the user has named the source himself, on the command line or in the environment, and no file has."""
    if getattr(arguments, "mission_file", None) is not None:
        return False
    return arguments.source is not None or bool(os.environ.get("TERRAINAV_SOURCE"))
