"""Files that ship beside the code in ``resources/``, and the version."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def resource(name: str) -> Path:
    """Path of a file in ``resources/``."""
    return Path(__file__).resolve().parents[1] / "resources" / name


def read_text(name: str) -> str:
    """Content of a text file in ``resources/``."""
    return resource(name).read_text(encoding="utf-8")


def read_json(name: str) -> Any:
    """Content of a JSON file in ``resources/``."""
    return json.loads(read_text(name))


def version() -> str:
    """Version in ``metadata.txt``, beside this package in the plugin folder and in a wheel."""
    from configparser import ConfigParser

    metadata = ConfigParser(interpolation=None)
    metadata.read(Path(__file__).parents[1] / "metadata.txt", encoding="utf-8")
    return metadata["general"]["version"]
