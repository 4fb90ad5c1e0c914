"""Import of libraries that read settings of their own."""

from __future__ import annotations

import importlib
from typing import Any

from ..errors import OutputError


def imported(name: str) -> Any:
    """Import a library that may be missing.

    Some read files and environment variables of their own meanwhile, and raise whatever they like where one is wrong.

    Raises
    ------
    ImportError
        It is missing.
    OutputError
        It fails for another reason, which is shown.
    """
    try:
        return importlib.import_module(name)
    except (ImportError, MemoryError):
        raise
    except Exception as wrong:
        # Only where something is wrong: the command imports this for its help.
        from ..text.plain import one_line, safe_str

        # A library's text may be pages long.
        raise OutputError(
            "{0}: cannot be imported ({1}: {2}); its own settings, in a file or the environment, may be wrong",
            name,
            type(wrong).__name__,
            one_line(safe_str(wrong), 120),
        ) from wrong
