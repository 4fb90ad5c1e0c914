"""Exports on the command line."""

from __future__ import annotations

import argparse

from ..text import printable
from .exits import DONE


def run_export(arguments: argparse.Namespace) -> int:
    """Write the views of a dataset in a format of other programs."""
    from ..exports.formats import export
    from ..exports.views import Views

    views = Views.read(arguments.folder, arguments.map_type)
    path = export(views, arguments.target, arguments.format)
    print(
        printable(f"{len(views):,} images as {arguments.format} in {path}; the images stay in {views.folder}")
    )
    return DONE
