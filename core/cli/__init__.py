"""The command ``terrainav``; each group of subcommands is a module."""

from __future__ import annotations

# Ctrl-C ends Python with a traceback until `main` runs, so only modules that Python has already loaded are imported.
import os
import sys

from ..errors import Cancelled, InvalidInput, TerrAInavError
from .exits import BAD_INPUT, DONE, FAILED, FAULT, STOPPED, exit_code

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

#: If set, internal errors are printed with their traceback.
DEBUG_ENV = "TERRAINAV_DEBUG"
#: Module and function of each command; only the one that runs is imported.
_COMMANDS = {
    "plan": ("flying", "run_plan"),
    "capture": ("flying", "run_capture"),
    "fly": ("sequencing", "run_fly"),
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
    "live": ("living", "run_live"),
    "sources": ("listing", "run_sources"),
    "cameras": ("listing", "run_cameras"),
    "cache": ("listing", "run_cache"),
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    code = _main(argv)
    from ..external.native_calls import set_exit_code

    set_exit_code(code)
    return code


def _main(argv: Sequence[str] | None) -> int:
    signals: list[int] = []
    try:
        from .printing import escape_output
        from .stopping import raise_signals

        with raise_signals(signals), escape_output():
            code = _run(sys.argv[1:] if argv is None else argv)
            if sys.stdout is not None:
                # Raise errors of output here rather than when Python exits.
                sys.stdout.flush()
    except KeyboardInterrupt as stopped:
        return _fail("stopped", getattr(stopped, "code", STOPPED))
    except Exception as wrong:  # noqa: BLE001 (the outermost handler)
        if signals and (isinstance(wrong, Cancelled) or not isinstance(wrong, TerrAInavError)):
            # A C module that a signal interrupts during its import raises another error.
            return _fail("stopped", exit_code(signals[0]))
        return _failed(wrong)
    else:
        return code


def _failed(wrong: Exception) -> int:
    """Print an error and return the exit code."""
    if isinstance(wrong, InvalidInput):
        return _fail(wrong, BAD_INPUT)
    if isinstance(wrong, Cancelled):
        return _fail(wrong, STOPPED)
    if isinstance(wrong, TerrAInavError):
        return _fail(wrong, FAILED)
    if isinstance(wrong, MemoryError):
        return _fail("not enough memory; ask for less at a time: fewer or smaller images", FAILED)
    if isinstance(wrong, ValueError) and "embedded null" in str(wrong):
        # The name is from a settings file, as arguments cannot hold null characters.
        return _fail("a file name holds a null character, which is not allowed", BAD_INPUT)
    if isinstance(wrong, UnicodeEncodeError):
        # Python represents undecodable bytes of names as surrogates. Show 60 characters around them.
        part = wrong.object[max(wrong.start - 60, 0) : wrong.end + 60]
        return _fail(f"{part!a}: cannot be written as {wrong.encoding.upper()}", FAILED)
    if _is_out_of_threads(wrong):
        return _fail(f"the system allows no more threads ({wrong})", FAILED)
    if isinstance(wrong, OSError):
        _drop_output()
        # The reader of our output may have closed it, as `| head` does.
        gone = isinstance(wrong, BrokenPipeError)
        return DONE if gone else _fail(f"cannot continue ({wrong})", FAILED)
    return _fault(wrong)


def _is_out_of_threads(wrong: Exception) -> bool:
    """Whether the system could not start a thread, for which Python has no specific error."""
    return isinstance(wrong, RuntimeError) and "new thread" in str(wrong)


def _run(argv: Sequence[str]) -> int:
    if list(argv) == ["--version"]:
        # Used by scripts: answer without building the parser of all options.
        return _print_version()
    import importlib

    from .options import named_command, normalise, parser

    reader = parser(named_command(argv))
    arguments = reader.parse_args(normalise(argv))
    if arguments.version:
        return _print_version()
    if arguments.command is None:
        reader.print_help()
        return DONE
    _check_addresses(vars(arguments))
    module, function = _COMMANDS[arguments.command]
    run = getattr(importlib.import_module(f".{module}", __name__), function)
    # Print notices only for the commands that print nothing before their result.
    if arguments.command not in ("plan", "poses"):
        return int(run(arguments))
    from .printing import busy_notice

    with busy_notice():
        return int(run(arguments))


def _check_addresses(values: Mapping[str, object]) -> None:
    """Refuse passwords and keys in files, folders and addresses."""
    from ..errors import Message
    from ..storage.stores import check_no_credentials

    for name, value in values.items():
        for text in value if isinstance(value, list) else [value]:
            # Credentials in sources and clusters are checked when these are opened.
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
    """Discard buffered output, so that Python does not fail again when it exits."""
    import contextlib

    with contextlib.suppress(AttributeError, OSError):
        # Output may be missing, or not a file.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _fault(error: Exception) -> int:
    """Print an internal error with its place and the address to report it."""
    import traceback
    from pathlib import Path

    if os.environ.get(DEBUG_ENV):
        from ..addresses import without_credentials

        trace = traceback.format_exception(type(error), error, error.__traceback__)
        print(without_credentials("".join(trace)), end="", file=sys.stderr)
    *_, last = traceback.extract_tb(error.__traceback__)
    words = str(error)[:200]
    return _fail(
        f"internal error: {type(error).__name__}: {words} ({Path(last.filename).name}, line {last.lineno}); please "
        "report it with the command at https://github.com/terrainav/terrainav/issues; "
        f"{DEBUG_ENV}=1 shows the traceback",
        FAULT,
    )


def _fail(error: object, code: int) -> int:
    import contextlib

    from ..addresses import without_credentials
    from ..limits import MAX_TEXT_CHARACTERS
    from ..text.plain import printable, shortened

    # File names and texts of servers may be long and hold line ends and control characters.
    line = without_credentials(shortened(printable(str(error)), MAX_TEXT_CHARACTERS))
    with contextlib.suppress(OSError):
        print(f"terrainav: {line}", file=sys.stderr)
    return code
