"""The command ``terrainav``: plan, capture, report, sources, cameras, cache."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence

from ..errors import Cancelled, InvalidInput, TerrAInavError
from .caching import run_cache
from .exits import BAD_INPUT, DONE, FAILED, STOPPED
from .flying import run_capture, run_plan, run_report
from .listing import run_cameras, run_sources
from .options import normalised, parser

_COMMANDS: dict[str, Callable[[argparse.Namespace], int]] = {
    "plan": run_plan,
    "capture": run_capture,
    "report": run_report,
    "sources": run_sources,
    "cameras": run_cameras,
    "cache": run_cache,
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit code."""
    reader = parser()
    arguments = reader.parse_args(normalised(sys.argv[1:] if argv is None else argv))
    try:
        if arguments.version:
            from ..version import version

            print(f"terrainav {version()}")
            return DONE
        if arguments.command is None:
            reader.print_help()
            return DONE
        return _COMMANDS[arguments.command](arguments)
    except InvalidInput as wrong:
        return _fail(wrong, BAD_INPUT)
    except Cancelled as stopped:
        return _fail(stopped, STOPPED)
    except TerrAInavError as wrong:
        return _fail(wrong, FAILED)
    except BrokenPipeError:
        # The reader of our output went away, as `| head` does: nothing is left to be said.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE


def _fail(error: Exception, code: int) -> int:
    print(f"terrainav: {error}", file=sys.stderr)
    return code
