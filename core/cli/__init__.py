"""The command ``terrainav``: plan, capture, clean, split, load, convert, pairs, report, sources, cameras, cache."""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
from collections.abc import Sequence

from ..errors import Cancelled, InvalidInput, TerrAInavError
from ..text import printable
from .exits import BAD_INPUT, DONE, FAILED, STOPPED

#: The module of each command and its function there; only the one that is run is imported.
_COMMANDS = {
    "plan": ("flying", "run_plan"),
    "capture": ("flying", "run_capture"),
    "clean": ("cleaning", "run_clean"),
    "split": ("splitting", "run_split"),
    "convert": ("converting", "run_convert"),
    "pairs": ("pairing", "run_pairs"),
    "load": ("loading", "run_load"),
    "report": ("flying", "run_report"),
    "sources": ("listing", "run_sources"),
    "cameras": ("cameras", "run_cameras"),
    "cache": ("caching", "run_cache"),
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit code."""
    try:
        code = _run(sys.argv[1:] if argv is None else argv)
        if sys.stdout is not None:
            # What cannot be printed is found out here, and not when Python ends.
            sys.stdout.flush()
    except InvalidInput as wrong:
        return _fail(wrong, BAD_INPUT)
    except Cancelled as stopped:
        return _fail(stopped, STOPPED)
    except KeyboardInterrupt:
        return _fail("stopped", STOPPED)
    except TerrAInavError as wrong:
        return _fail(wrong, FAILED)
    except MemoryError:
        return _fail("not enough memory; ask for less at a time: fewer or smaller images", FAILED)
    except BrokenPipeError:
        # The reader of our output went away, as `| head` does: nothing is left to be said.
        _drop_output()
        return DONE
    except OSError as wrong:
        _drop_output()
        return _fail(f"cannot go on ({wrong})", FAILED)
    else:
        return code


def _run(argv: Sequence[str]) -> int:
    if list(argv) == ["--version"]:
        # Asked for by scripts: it need not wait for the parser of all options.
        return _print_version()
    from .options import normalised, parser

    reader = parser()
    arguments = reader.parse_args(normalised(argv))
    if arguments.version:
        return _print_version()
    if arguments.command is None:
        reader.print_help()
        return DONE
    module, function = _COMMANDS[arguments.command]
    code: int = getattr(importlib.import_module(f".{module}", __name__), function)(arguments)
    return code


def _print_version() -> int:
    from ..version import version

    print(f"terrainav {version()}")
    return DONE


def _drop_output() -> None:
    """Lead what is still to be printed nowhere, so that Python does not fail at it once more when it ends."""
    with contextlib.suppress(AttributeError, OSError):
        # There may be no output, or one that is no file.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _fail(error: object, code: int) -> int:
    # Names of files and words of servers may hold line ends and the terminal's control characters.
    print(f"terrainav: {printable(str(error))}", file=sys.stderr)
    return code
