"""Every error TerrAInav raises on purpose."""

from __future__ import annotations


class TerrAInavError(Exception):
    """Root of the errors TerrAInav raises on purpose; its text is one line for the user."""


class InvalidInput(TerrAInavError, ValueError):
    """An argument outside its domain: the message names the value and what would be right.

    Parameters
    ----------
    message : str
    field : str
        Name of the one field of a mission that is to be put right; empty where it is about no single one.
    """

    def __init__(self, message: str = "", field: str = "") -> None:
        super().__init__(message)
        self.field = field


class SourceError(TerrAInavError):
    """A source that cannot serve at all (missing key, refused, over quota): it stops the run."""


class PartError(TerrAInavError):
    """One part of a picture that cannot be had (missing, broken): the pictures that need it fail."""


class OutputError(TerrAInavError):
    """A folder or file that cannot be written, or that holds something else."""


class Cancelled(TerrAInavError):
    """The user stopped a run; what was finished is kept."""
