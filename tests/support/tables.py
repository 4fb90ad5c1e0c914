"""Conversion of tables to the text of their files, and back."""

from __future__ import annotations

from terrainav.core.dataset.table import Table


def text_of(table: Table) -> str:
    return "".join(table._blocks())


def table_of(text: str, name: str = "table") -> Table:
    return Table._parse([text], name)
