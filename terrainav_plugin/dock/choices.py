"""What the dock offers to choose from."""

from __future__ import annotations

from typing import NamedTuple

#: Groups of the source chooser, in their order.
CATALOGUE, OWN, PROJECT, FILE = range(4)


class SourceChoice(NamedTuple):
    """An entry of the source chooser.

    Parameters
    ----------
    name, title : str
    map_types : tuple of str
        Empty where the source has one kind of picture.
    needs_key : bool
    group : int
        Where it comes from: `CATALOGUE`, `OWN`, `PROJECT` or `FILE`.
    limits : str
        What its provider allows, as HTML.
    dates : str
        Dates it can be had of, in words; empty where there is but one.
    default_date : str
    """

    name: str
    title: str
    map_types: tuple[str, ...] = ()
    needs_key: bool = False
    group: int = CATALOGUE
    limits: str = ""
    dates: str = ""
    default_date: str = ""


class CameraChoice(NamedTuple):
    """An entry of the camera chooser."""

    name: str
    fov_deg: float
    aspect_ratio: float
