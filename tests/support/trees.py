"""Syntax trees of the project's files, each of which is parsed once."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path


@cache
def tree_of(path: Path) -> ast.Module:
    """Syntax tree of a file; for reading only."""
    return ast.parse(path.read_text(encoding="utf-8"))
