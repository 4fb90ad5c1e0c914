"""Calls of the user's code, which must neither end the program nor print into its output."""

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
from ..text.plain import error_text

#: File descriptors of the process's output and error output, which `sys.stdout` and `sys.stderr` may not use.
_OUTPUT, _ERRORS = 1, 2


def called(name: str, function: Callable[..., Any], *arguments: object) -> Any:
    """Call a function of the user's method, with its output redirected to the error output.

    Parameters
    ----------
    name : str
        Name of the method, ``module:function``.

    Raises
    ------
    InvalidInput
        The function raised an exception other than `TerrAInavError`, ``SystemExit`` included; the message has the line
        in the module.
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
        module_file = getattr(sys.modules.get(name.partition(":")[0]), "__file__", None)
        last = next((frame for frame in reversed(frames) if frame.filename == module_file), frames[-1])
        raise InvalidInput(
            "method {0}: failed with {1} ({2}, line {3})",
            name,
            error_text(wrong),
            Path(last.filename).name,
            last.lineno,
        ) from wrong


def is_ctrl_c(wrong: BaseException) -> bool:
    """Whether an exception stems from Ctrl-C rather than from the user's code.

    The command's handler raises a subclass of KeyboardInterrupt; Python's handler raises KeyboardInterrupt itself, in
    the main thread only.
    """
    if not isinstance(wrong, KeyboardInterrupt):
        return False
    in_main = threading.current_thread() is threading.main_thread()
    return type(wrong) is not KeyboardInterrupt or (
        in_main and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    )


class _OutputApart:
    """Context that redirects the output of the process, including that of C code, to the error output.

    Several threads may be inside: the first to enter redirects, and the last to leave restores. In programs without
    the file descriptors, such as QGIS on Windows, only `sys.stdout` is redirected.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._inside = 0
        self._left = contextlib.ExitStack()

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                with contextlib.ExitStack() as entered:
                    entered.enter_context(_redirected_descriptor())
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
def _redirected_descriptor() -> Iterator[None]:
    """Redirect the output's descriptor to the error output's, if both exist."""
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
    """Flush the buffers of Python and C, whose content would otherwise go to the other file."""
    import ctypes

    # Ignore a closed or broken output here; the next print reports it.
    with contextlib.suppress(OSError, ValueError, AttributeError):
        sys.stdout.flush()
    with contextlib.suppress(OSError, AttributeError):
        (ctypes.cdll.ucrtbase if sys.platform == "win32" else ctypes.CDLL(None)).fflush(None)
