"""Mission files and dataset folders that were opened last."""

from __future__ import annotations

import json
from pathlib import Path

from ...core.errors import InvalidInput
from ...core.safe_json import parse_json
from ..settings import Settings

_MOST = 8


def recent() -> list[Path]:
    """Those that are still there, the latest first."""
    try:
        paths = parse_json(Settings().recent or "[]")
    except InvalidInput:
        return []
    return [Path(path) for path in paths if isinstance(path, str) and Path(path).exists()]


def remember(path: Path) -> None:
    """Put a file or folder to the front."""
    others = [other for other in recent() if other != path]
    Settings().recent = json.dumps([str(path), *map(str, others)][:_MOST])
