"""What ships beside the code, in ``resources/``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parent.parent


def resource(name: str) -> Path:
    """Path of a file in ``resources/``."""
    return _PACKAGE / "resources" / name


def read_json(name: str) -> Any:
    """Content of a JSON file in ``resources/``."""
    return json.loads(resource(name).read_text(encoding="utf-8"))
