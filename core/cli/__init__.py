"""The command ``terrainav``, of which each group of subcommands is a module."""

from __future__ import annotations

# Until `main` runs, Ctrl-C ends Python with a traceback: nothing is imported here that Python has not loaded itself.
import os
import sys

from ..errors import Cancelled, InvalidInput, TerrAInavError
from .exits import BAD_INPUT, DONE, FAILED, FAULT, STOPPED, exit_code

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

#: Set, the trace of a fault of the program is printed.
DEBUG_ENV = "TERRAINAV_DEBUG"
#: Characters shown before and after one that cannot be written.
_AROUND = 60
_ISSUES = "https://github.com/terrainav/terrainav/issues"
#: The module of each command and its function there; only the one that is run is imported.
_COMMANDS = {
    "plan": ("flying", "run_plan"),
    "capture": ("flying", "run_capture"),
    "clean": ("datasets", "run_clean"),
    "split": ("datasets", "run_split"),
    "convert": ("datasets", "run_convert"),
    "mosaic": ("datasets", "run_mosaic"),
    "pairs": ("pairing", "run_pairs"),
    "export": ("exporting", "run_export"),
    "poses": ("posing", "run_poses"),
    "benchmark": ("benchmarking", "run_benchmark"),
    "load": ("datasets", "run_load"),
    "report": ("flying", "run_report"),
    "sources": ("listing", "run_sources"),
    "cameras": ("listing", "run_cameras"),
    "cache": ("listing", "run_cache"),
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit code."""
    code = _main(argv)
    from ..external.native_calls import set_exit_code

    set_exit_code(code)
    return code


def _main(argv: Sequence[str] | None) -> int:
    signals: list[int] = []
    try:
        from .printing import anything_printed
        from .stopping import raised

        with raised(signals), anything_printed():
            code = _run(sys.argv[1:] if argv is None else argv)
            if sys.stdout is not None:
                # What cannot be printed is found out here, and not when Python ends.
                sys.stdout.flush()
    except KeyboardInterrupt as stopped:
        return _fail("stopped", getattr(stopped, "code", STOPPED))
    except Exception as wrong:  # noqa: BLE001 (the last door)
        if signals and (isinstance(wrong, Cancelled) or not isinstance(wrong, TerrAInavError)):
            # Modules written in C that a signal met while they were imported raise something else instead.
            return _fail("stopped", exit_code(signals[0]))
        return _failed(wrong)
    else:
        return code


def _failed(wrong: Exception) -> int:
    """Say what is wrong; returns the exit code."""
    if isinstance(wrong, InvalidInput):
        return _fail(wrong, BAD_INPUT)
    if isinstance(wrong, Cancelled):
        return _fail(wrong, STOPPED)
    if isinstance(wrong, TerrAInavError):
        return _fail(wrong, FAILED)
    if isinstance(wrong, MemoryError):
        return _fail("not enough memory; ask for less at a time: fewer or smaller images", FAILED)
    if isinstance(wrong, ValueError) and "embedded null" in str(wrong):
        # Of a name in a file of settings: no argument can have it.
        return _fail("the name of a file holds a null character, which no name has", BAD_INPUT)
    if isinstance(wrong, UnicodeEncodeError):
        # Python has halves of characters for bytes of names that are no text in UTF-8, which no file takes.
        part = wrong.object[max(wrong.start - _AROUND, 0) : wrong.end + _AROUND]
        return _fail(f"{part!a}: cannot be written, as it is no text in {wrong.encoding.upper()}", FAILED)
    if _is_out_of_threads(wrong):
        return _fail(f"the system gives no more threads ({wrong})", FAILED)
    if isinstance(wrong, OSError):
        _drop_output()
        # The reader of our output may have gone away, as `| head` does: nothing is left to be said.
        gone = isinstance(wrong, BrokenPipeError)
        return DONE if gone else _fail(f"cannot go on ({wrong})", FAILED)
    return _fault(wrong)


def _is_out_of_threads(wrong: Exception) -> bool:
    """Whether the system has given no thread, for which Python has no error of its own."""
    return isinstance(wrong, RuntimeError) and "new thread" in str(wrong)


def _run(argv: Sequence[str]) -> int:
    if list(argv) == ["--version"]:
        # Asked for by scripts: it need not wait for the parser of all options.
        return _print_version()
    import importlib

    from .options import normalised, parser

    reader = parser()
    arguments = reader.parse_args(normalised(argv))
    if arguments.version:
        return _print_version()
    if arguments.command is None:
        reader.print_help()
        return DONE
    _check_addresses(vars(arguments))
    module, function = _COMMANDS[arguments.command]
    run = getattr(importlib.import_module(f".{module}", __name__), function)
    # These commands print nothing before their result.
    if arguments.command not in ("plan", "poses"):
        return int(run(arguments))
    from .printing import busy_notice

    with busy_notice():
        return int(run(arguments))


def _check_addresses(values: Mapping[str, object]) -> None:
    """Refuse passwords and keys in what is to be a file, a folder or an address; sources refuse theirs themselves."""
    from ..errors import Message
    from ..storage.stores import check_no_credentials

    for name, value in values.items():
        for text in value if isinstance(value, list) else [value]:
            # These options name sources.
            if isinstance(text, str) and name not in ("source", "url", "imagery", "elevation", "surface", "cluster"):
                check_no_credentials(
                    text,
                    "address",
                    Message("credentials are taken from where the store's own tools have them"),
                )


def _print_version() -> int:
    from ..resources import version

    print(f"terrainav {version()}")
    return DONE


def _drop_output() -> None:
    """Lead what is still to be printed nowhere, so that Python does not fail at it once more when it ends."""
    import contextlib

    with contextlib.suppress(AttributeError, OSError):
        # There may be no output, or one that is no file.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _fault(error: Exception) -> int:
    """Say that the program is at fault, where, and what to do about it."""
    import traceback
    from pathlib import Path

    if os.environ.get(DEBUG_ENV):
        from ..addresses import without_credentials

        trace = traceback.format_exception(type(error), error, error.__traceback__)
        print(without_credentials("".join(trace)), end="", file=sys.stderr)
    *_, last = traceback.extract_tb(error.__traceback__)
    said = str(error)[:200]
    return _fail(
        f"a fault of the program, not yours: {type(error).__name__}: {said} ({Path(last.filename).name}, line "
        f"{last.lineno}); please report it with the command at {_ISSUES}; {DEBUG_ENV}=1 shows the trace",
        FAULT,
    )


def _fail(error: object, code: int) -> int:
    import contextlib

    from ..addresses import without_credentials
    from ..limits import MAX_TEXT_CHARACTERS
    from ..text.plain import printable, shortened

    # Names of files and words of servers may hold line ends and the terminal's control characters, without end.
    said = without_credentials(shortened(printable(str(error)), MAX_TEXT_CHARACTERS))
    with contextlib.suppress(OSError):
        print(f"terrainav: {said}", file=sys.stderr)
    return code
