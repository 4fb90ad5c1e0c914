"""Write the table of limits in docs/security.md from core/limits.py."""

from __future__ import annotations

import ast
import runpy
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCE, PAGE = ROOT / "core" / "limits.py", ROOT / "docs" / "security.md"
_HEAD = "| limit | value | of what, and why |\n| --- | ---: | --- |\n"
_MIB = 1 << 20


def limits() -> dict[str, tuple[float, str]]:
    """Value and comment of each limit, by name."""
    text = SOURCE.read_text(encoding="utf-8")
    lines, values = text.splitlines(), runpy.run_path(str(SOURCE))
    found = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            above = node.lineno - 2
            comment: list[str] = []
            while lines[above].startswith("#:"):
                comment.insert(0, lines[above][2:].strip())
                above -= 1
            found[node.targets[0].id] = values[node.targets[0].id], " ".join(comment)
    return found


def table() -> str:
    """Text of the table."""
    rows = (f"| `{name}` | {_text(name, value)} | {comment} |\n" for name, (value, comment) in limits().items())
    return _HEAD + "".join(rows)


def _text(name: str, value: object) -> str:
    if not isinstance(value, (int, float)):
        return str(value)
    if name.endswith("_BYTES") and value >= _MIB and not value % _MIB:
        return f"{int(value) // _MIB:,} MiB"
    return f"{value:,}" if isinstance(value, int) else f"{value:g}"


def replaced(page: str) -> str:
    """Page with its table replaced by the current one."""
    start = page.index(_HEAD)
    end = page.index("\n\n", start) + 1
    return page[:start] + table() + page[end:]


if __name__ == "__main__":
    PAGE.write_text(replaced(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
