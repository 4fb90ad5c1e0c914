"""Import of libraries that read the user's settings."""

from __future__ import annotations

import importlib
from typing import Any

from ..errors import OutputError


def imported(name: str) -> Any:
    """Import a library that may be missing.

    Some libraries read configuration files and environment variables on import, and raise errors of any type if these
    are wrong.

    Raises
    ------
    ImportError
        The library is missing.
    OutputError
        The import fails for another reason, which the message states.
    """
    try:
        return importlib.import_module(name)
    except (ImportError, MemoryError):
        raise
    except Exception as wrong:
        # Import this late, as the command imports this module even to print its help.
        from ..text.plain import error_text

        raise OutputError(
            "{0}: cannot be imported ({1}); its settings, in a file or the environment, may be wrong",
            name,
            error_text(wrong),
        ) from wrong
