"""What the plan says about each picture: the job of making it, and its row of the table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..dataset.entropy import entropy
from ..dataset.table import Table
from ..geodesy.mercator import wrap_lon_deg
from ..imagery.source import Part, Source, Window
from ..mission.plan import Plan
from .georeference import Georeference
from .journal import Outcome
from .picture import assemble, resized
from .writers import Description, write_picture

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]


@dataclass(frozen=True)
class PictureJob:
    """Everything about a picture but its pixels: a plain value that any worker can take.

    Parameters
    ----------
    index : int
        Of the capture in the plan.
    folder : Path
    image_format : str
        tif, jpg or png.
    img_size : tuple (width, height, channels) or None
    window : Window
    georeference : Georeference
    description : Description
    """

    index: int
    folder: Path
    image_format: str
    img_size: tuple[int, int, int] | None
    window: Window
    georeference: Georeference
    description: Description


def make_picture(job: PictureJob, parts: Sequence[Part], pixels: Mapping[Window, Pixels]) -> float:
    """Assemble a picture, write it, and return its entropy in bits (before a JPEG's losses).

    Raises
    ------
    PartError
        Where the parts do not make a whole picture; nothing is written.
    OutputError
        Where it cannot be written.
    """
    picture = resized(assemble(job.window, parts, pixels), job.img_size)
    write_picture(job.folder, job.image_format, picture, job.georeference, job.description)
    return entropy(picture)


def window_of(plan: Plan, index: int) -> Window:
    """Window of one capture; its left and top are int where the source's grid is."""
    left, top, width, height = (values[index].item() for values in plan.windows)
    return Window(plan.zoom, left, top, width, height)


def job_of(plan: Plan, index: int, source: Source, map_type: str, folder: Path) -> PictureJob:
    """Job of one capture."""
    mission = plan.mission
    window = window_of(plan, index)
    width, height = mission.img_size[:2] if mission.img_size else (window.width_px, window.height_px)
    west, south, east, north = (float(edges[index]) for edges in plan.edges_m)
    return PictureJob(
        index,
        folder,
        mission.image_format,
        mission.img_size,
        window,
        Georeference(west, south, east, north, width, height),
        Description(
            name=plan.names[index],
            map_type=map_type,
            source=source.title,
            attribution=source.attribution,
            zoom=plan.zoom,
            lat_deg=float(plan.lat_deg[index]),
            lon_deg=float(plan.lon_deg[index]),
            agl_m=float(plan.agl_m[index]),
        ),
    )


def table_of(plan: Plan, source: Source, outcomes: Mapping[str, Outcome]) -> Table:
    """Table of the pictures that are done or have failed, in the plan's order.

    Parameters
    ----------
    outcomes : mapping of str to Outcome
        By the picture's name.
    """
    names = plan.names
    at = np.array([index for index, name in enumerate(names) if name in outcomes], np.int64)
    rows = [outcomes[names[index]] for index in at.tolist()]
    centre_lat, centre_lon = plan.frame_centres
    left, top, width, height = (np.asarray(values, np.float64)[at] for values in plan.windows)
    level = np.zeros(len(at))
    image_width, image_height = width, height
    if plan.mission.img_size:
        image_width, image_height = (np.full(len(at), float(size)) for size in plan.mission.img_size[:2])
    return Table(
        img_names=tuple(f"{row.name}.{plan.mission.image_format}" for row in rows),
        columns=plan.column[at],
        rows=plan.row[at],
        lat_deg=centre_lat[at],
        lon_deg=centre_lon[at],
        zoom=np.full(len(at), plan.zoom, np.int64),
        entropies=np.array([np.nan if row.entropy is None else row.entropy for row in rows], np.float64),
        pose_lat_deg=plan.lat_deg[at],
        pose_lon_deg=wrap_lon_deg(plan.lon_deg[at]),
        agl_m=plan.agl_m[at],
        yaw_deg=level,
        tilt_deg=level,
        roll_deg=level,
        left_px=np.mod(left, plan.grid.world_px(plan.zoom)),
        top_px=top,
        width_px=width,
        height_px=height,
        image_width_px=image_width,
        image_height_px=image_height,
        source=(source.title,) * len(at),
        attribution=(source.attribution,) * len(at),
        status=tuple(row.status for row in rows),
        reason=tuple(row.reason for row in rows),
    )
