"""The command ``terrainav``: plan, capture, clean, split, load, convert, pairs, report, sources, cameras, cache."""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
from collections.abc import Callable, Sequence

from ..errors import Cancelled, InvalidInput, TerrAInavError
from .caching import run_cache
from .cameras import run_cameras
from .cleaning import run_clean
from .converting import run_convert
from .exits import BAD_INPUT, DONE, FAILED, STOPPED
from .flying import run_capture, run_plan, run_report
from .listing import run_sources
from .loading import run_load
from .options import normalised, parser
from .pairing import run_pairs
from .splitting import run_split

_COMMANDS: dict[str, Callable[[argparse.Namespace], int]] = {
    "plan": run_plan,
    "capture": run_capture,
    "clean": run_clean,
    "split": run_split,
    "convert": run_convert,
    "pairs": run_pairs,
    "load": run_load,
    "report": run_report,
    "sources": run_sources,
    "cameras": run_cameras,
    "cache": run_cache,
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
    reader = parser()
    arguments = reader.parse_args(normalised(argv))
    if arguments.version:
        from ..version import version

        print(f"terrainav {version()}")
        return DONE
    if arguments.command is None:
        reader.print_help()
        return DONE
    return _COMMANDS[arguments.command](arguments)


def _drop_output() -> None:
    """Lead what is still to be printed nowhere, so that Python does not fail at it once more when it ends."""
    with contextlib.suppress(AttributeError, OSError):
        # There may be no output, or one that is no file.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _fail(error: object, code: int) -> int:
    # Names of files and words of servers may hold line ends and the terminal's control characters.
    text = "".join(one if one.isprintable() else " " for one in str(error))
    print(f"terrainav: {text}", file=sys.stderr)
    return code
