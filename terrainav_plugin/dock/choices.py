"""What the dock offers to choose from."""

from __future__ import annotations

from typing import NamedTuple

#: Groups of the source chooser, in their order.
CATALOGUE, REGIONAL, OWN, CONNECTION, SERVICE, PROJECT, FILE, OTHER = range(8)


class SourceChoice(NamedTuple):
    """An entry of the source chooser.

    Parameters
    ----------
    name, title : str
    map_types : tuple of str
        Empty where the source has one kind of picture.
    needs_key : bool
    group : int
        Where it comes from: one of the groups above.
    limits : str
        What its provider allows, as HTML.
    dates : str
        Dates it can be had of, in words; empty where there is but one.
    default_date : str
    may_authenticate : bool
        Whether an authentication configuration can be chosen for its requests.
    """

    name: str
    title: str
    map_types: tuple[str, ...] = ()
    needs_key: bool = False
    group: int = CATALOGUE
    limits: str = ""
    dates: str = ""
    default_date: str = ""
    may_authenticate: bool = False


class CameraChoice(NamedTuple):
    """An entry of the camera chooser.

    Parameters
    ----------
    name : str
    fov_deg : float
        Diagonal field of view.
    aspect_ratio : float
    sensor_mm : (width, height) or None
        Where it is known.
    image_px : int or None
        Pixels along the longer side of its image, where they are known.
    tip : str
        What is known of the camera, and from where.
    user : bool
        Whether it is one that the user has saved.
    """

    name: str
    fov_deg: float
    aspect_ratio: float
    sensor_mm: tuple[float, float] | None = None
    image_px: int | None = None
    tip: str = ""
    user: bool = False
