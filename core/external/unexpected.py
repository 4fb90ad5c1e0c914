"""Unforeseen errors, which must not end a run because of a single answer or file."""

from __future__ import annotations

import logging
import threading
import traceback
from typing import Callable

from ..errors import PartError
from ..text.plain import one_line

_log = logging.getLogger(__name__)


class UnexpectedErrors:
    """Converts unforeseen errors to failures of single parts; thread-safe.

    Only the first error of each kind is logged with its traceback, so that a server cannot fill the log.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._logged: set[tuple[type, str, int]] = set()

    def failure(self, wrong: BaseException, hide: Callable[[str], str] = str) -> PartError:
        """Convert an error to the failure of a part.

        Parameters
        ----------
        hide : callable
            Masks keys in a text.
        """
        at = traceback.extract_tb(wrong.__traceback__)[-1:]
        kind = (type(wrong), at[0].filename if at else "", (at[0].lineno or 0) if at else 0)
        with self._lock:
            is_new = kind not in self._logged
            self._logged.add(kind)
        if is_new:
            trace = "".join(traceback.format_exception(type(wrong), wrong, wrong.__traceback__))
            _log.error("unexpected error, further ones of its kind are not logged:\n%s", hide(trace))
        words = one_line(": ".join(filter(None, (type(wrong).__name__, hide(str(wrong))))))
        return PartError("unexpected error ({0})", words)
