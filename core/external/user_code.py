"""Code of the user's own, called within a run: it may neither end the program nor print into its output."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from ..errors import InvalidInput, TerrAInavError
from ..text.plain import safe_str

#: File descriptors of the process's output and error output, whatever Python's own are.
_OUTPUT, _ERRORS = 1, 2


def called(name: str, function: Callable[..., Any], *arguments: object) -> Any:
    """Return what a function of the user's method returns; what it prints goes to the error output.

    Parameters
    ----------
    name : str
        Of the method, as ``module:function``.

    Raises
    ------
    InvalidInput
        It raised anything but an error of ours, also ``SystemExit``: one line, with its place in the module.
    """
    try:
        with output_apart:
            return function(*arguments)
    except (TerrAInavError, MemoryError):
        raise
    except BaseException as wrong:
        if is_ctrl_c(wrong):
            raise
        frames = traceback.extract_tb(wrong.__traceback__)
        own = getattr(sys.modules.get(name.partition(":")[0]), "__file__", None)
        last = next((frame for frame in reversed(frames) if frame.filename == own), frames[-1])
        raise InvalidInput(
            "method {0}: failed with {1}: {2} ({3}, line {4})",
            name,
            type(wrong).__name__,
            safe_str(wrong),
            Path(last.filename).name,
            last.lineno,
        ) from wrong


def is_ctrl_c(wrong: BaseException) -> bool:
    """Whether an exception is the user's wish to stop, and none that his code has raised by itself.

    The command raises a kind of its own. Python's own handler raises the plain one, in the main thread alone.
    """
    if not isinstance(wrong, KeyboardInterrupt):
        return False
    in_main = threading.current_thread() is threading.main_thread()
    return type(wrong) is not KeyboardInterrupt or (
        in_main and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    )


class _OutputApart:
    """Context in which all that the process prints goes to its error output, from C as well.

    Several threads may be in it at once: the first one in leads the output away, the last one out leads it back.
    Programs without such files, as QGIS on Windows is one, have Python's own output led away alone.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._inside = 0
        self._left = contextlib.ExitStack()

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                with contextlib.ExitStack() as entered:
                    entered.enter_context(_file_apart())
                    entered.enter_context(contextlib.redirect_stdout(sys.stderr))
                    self._left = entered.pop_all()
            self._inside += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                self._left.close()


output_apart = _OutputApart()


@contextlib.contextmanager
def _file_apart() -> Iterator[None]:
    """Lead the file of the output to that of the error output, if there are both."""
    _flush()
    try:
        os.fstat(_ERRORS)
        kept = os.dup(_OUTPUT)
    except OSError:
        yield
        return
    try:
        os.dup2(_ERRORS, _OUTPUT)
        yield
    finally:
        _flush()
        os.dup2(kept, _OUTPUT)
        os.close(kept)


def _flush() -> None:
    """Have all that is printed leave the process: what waits would come out elsewhere."""
    import ctypes

    # What cannot be printed any more is found out by who prints next.
    with contextlib.suppress(OSError, ValueError, AttributeError):
        sys.stdout.flush()
    with contextlib.suppress(OSError, AttributeError):
        (ctypes.cdll.ucrtbase if sys.platform == "win32" else ctypes.CDLL(None)).fflush(None)
