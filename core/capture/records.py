"""What the plan says about each picture: the job of making it, and its row of the table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats, PixelValues
from ..bands import RGB, Bands, Range, bands_of, ranges_of, shown_in_8_bits
from ..dataset.entropy import entropy
from ..dataset.folder import TABLE_FILE
from ..dataset.table import Table
from ..errors import Message, PartError
from ..geodesy.camera import Poses
from ..geodesy.mercator import wrap_lon_deg
from ..imagery.source import Part, Source, Window
from ..mission.export.rows import clock
from ..mission.parts import INTERPOLATE
from ..mission.plan import Plan
from ..picture.map_frame import resized
from ..picture.optics import Exposures, optics_of
from ..picture.products import BANDS, products
from ..picture.shot import MapShot, Shot, Walls, draw, shot_of, walls_of
from ..storage.files import write_whole
from .georeference import ControlPoints, Georeference
from .journal import FAILED, Outcome
from .metadata import Description, degrees, figure
from .odm import write_odm_files
from .writers import Place, Write, write_picture

#: Decimals of focal lengths and principal points in the table.
_PX_DIGITS = 6


@dataclass(frozen=True)
class PictureJob:
    """Everything about a picture but its pixels: a plain value that any worker can take.

    Parameters
    ----------
    index : int
        Of the capture in the plan.
    image_format : str
        tif, jpg or png.
    img_size : tuple (width, height, channels) or None
    shot : MapShot or Shot
        A map frame's window, or what a camera frame is made from.
    masked : bool
        Whether the picture has a channel for what it does not show.
    bands : Bands
        Of the source.
    ranges : tuple of (low, high)
        Values of each band that are shown darkest and brightest.
    products : (Plan, Path) or None
        What they are worked out from, and the folder in which each has one of its own.
    walls : callable or None
        Colours of walls, as `draw` takes them.
    write : callable
        What takes files.
    """

    index: int
    folder: Path
    image_format: str
    img_size: tuple[int, int, int] | None
    shot: MapShot | Shot
    masked: bool
    place: Place
    description: Description
    bands: Bands = RGB
    ranges: tuple[Range, ...] = ()
    products: tuple[Plan, Path] | None = None
    walls: Walls | None = None
    write: Write = write_whole


class Made(NamedTuple):
    """What is known of a picture once it is made.

    Bits of entropy, the shares without ground, without a map and of faces that no map shows, and the bytes of its files
    together.
    """

    entropy: float
    sky_share: float = 0.0
    unmapped_share: float = 0.0
    facade_share: float = 0.0
    size_bytes: int = 0


def make_picture(job: PictureJob, parts: Sequence[Part], pixels: Mapping[Window, PixelValues]) -> Made:
    """Make a picture, write it, and say what is known of it (its entropy before a JPEG's losses).

    Raises
    ------
    PartError
        Where the parts do not make a whole picture; nothing is written.
    OutputError
        Where it cannot be written.
    """
    picture, sky, unmapped, facades = draw(
        job.shot, parts, pixels, masked=job.masked, bands=job.bands, walls=job.walls
    )
    picture = resized(picture, job.img_size, job.bands)
    description = job.description
    if isinstance(job.shot, Shot):
        description = replace(description, more=_camera_metadata(job.shot))
    if job.products is not None:
        plan, folder = job.products
        for name, values in products(plan, job.index, (picture.shape[1], picture.shape[0]), job.shot):
            limits = [_range_of(values[..., band]) for band in range(len(BANDS[name]))]
            write_picture(
                folder / name, "tif", values, job.place, description, BANDS[name], limits, job.write
            )
    if job.bands == RGB:
        size_bytes = write_picture(
            job.folder, job.image_format, picture, job.place, description, write=job.write
        )
        bits = entropy(picture[..., :3] if picture.ndim > 2 else picture)
        return Made(bits, sky, unmapped, facades, size_bytes)
    bands, ranges = _written(job)
    picture = picture.reshape(*picture.shape[:2], -1)
    size_bytes = write_picture(
        job.folder, job.image_format, picture, job.place, description, bands, ranges, job.write
    )
    bits = entropy(shown_in_8_bits(picture, bands, ranges))
    return Made(bits, sky, unmapped, facades, size_bytes)


def outcome_of(job: PictureJob, result: Made | PartError) -> Outcome:
    """What became of a picture."""
    map_type, name = job.description.map_type, job.description.name
    if isinstance(result, PartError):
        return Outcome(map_type, name, reason=Message(result))
    return Outcome(map_type, name, result.entropy, "", *result[1:])


def _range_of(values: NDArray[Any]) -> Range:
    """Least and greatest of values; 0 to 1 where there are none."""
    known = values[np.isfinite(values)]
    return (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)


def _written(job: PictureJob) -> tuple[Bands, tuple[Range, ...]]:
    """Bands of a picture's file, and their ranges."""
    if job.img_size is None:
        return job.bands, job.ranges
    bands = job.bands.of_channels(job.img_size[2])
    shown = [job.ranges[at] for at in job.bands.shown]
    # Grey is a mean of colours, and so is its range.
    low, high = (float(np.mean(ends)) for ends in zip(*shown))
    return bands, tuple(shown) if len(bands) == len(shown) else ((low, high),)


def exposures_of(plan: Plan) -> Exposures | None:
    """What the pictures' tags say of the camera, where their format has room for it."""
    return Exposures(plan) if plan.mission.output.image_format == "jpg" else None


def job_of(
    plan: Plan,
    index: int,
    source: Source,
    map_type: str,
    folder: Path,
    exposures: Exposures | None = None,
    products_in: Path | None = None,
    write: Write = write_whole,
) -> PictureJob:
    """Job of one capture; with ``exposures`` its picture is tagged as a drone's. Products go to folders of a folder."""
    mission = plan.mission
    width, height = int(plan.frames.width_px[index]), int(plan.frames.height_px[index])
    if mission.output.img_size:
        width, height = mission.output.img_size[:2]
    shot = shot_of(plan, index)
    place: Place
    if plan.frames.on_map:
        west, south, east, north = (float(edges[index]) for edges in plan.edges)
        turns = int(plan.frames.quarter_turns[index])
        place = Georeference(west, south, east, north, width, height, plan.grid.plane.crs, turns)
    else:
        place = ControlPoints.of(plan, index, width, height)
    pose: dict[str, Any] = {n: float(values[index]) for n, values in zip(plan.poses._fields, plan.poses)}
    return PictureJob(
        index,
        folder,
        mission.output.image_format,
        mission.output.img_size,
        shot,
        # The channels that were asked for are the channels that are written, and a JPEG has no room for a mask.
        plan.masked and mission.output.img_size is None and mission.output.image_format != "jpg",
        place,
        Description(
            name=plan.names[index],
            map_type=map_type,
            source=source.title,
            attribution=source.attribution,
            zoom=plan.zoom,
            imagery_date=source.date,
            effective_gsd_m_per_px=_effective_gsd_m(plan, index),
            exposure=None if exposures is None else exposures.at(index),
            **pose,
        ),
        bands_of(source),
        ranges_of(source),
        None if products_in is None else (plan, products_in),
        walls_of(plan, source, map_type),
        write,
    )


def _effective_gsd_m(plan: Plan, index: int) -> float:
    """Metres of ground that a picture tells apart in its middle: a pixel of its own, or of the source where larger."""
    mission, grid = plan.mission, plan.grid
    if plan.frames.on_map:
        lat, lon = (np.asarray(angle[index]) for angle in plan.frame_centres)
        own, zoom = float(grid.ground_m_per_px(lat, lon, plan.zoom)), plan.zoom
    else:
        lat, lon = np.asarray(plan.lat_deg[index]), np.asarray(plan.lon_deg[index])
        own = mission.camera.ground_size_m(float(plan.agl_m[index]))[0] / float(plan.frames.width_px[index])
        zoom = plan.frames.finest_zoom(plan)
    if mission.output.img_size is not None:
        own *= float(plan.frames.width_px[index]) / mission.output.img_size[0]
    return max(own, float(grid.ground_m_per_px(lat, lon, min(zoom, grid.native_zoom))))


def _camera_metadata(shot: Shot) -> tuple[tuple[str, str], ...]:
    """What a camera frame's metadata says beyond a map frame's."""
    plan, camera = shot.plan, shot.plan.mission.camera
    return (
        ("FRAME", "camera"),
        ("FOV_DEG", repr(degrees(camera.fov_deg))),
        ("ASPECT_RATIO", repr(figure(camera.aspect_ratio))),
        ("GROUND_HEIGHT_M", repr(figure(float(plan.ground_m[shot.index])))),
        ("RESAMPLING", shot.kernel),
        ("SKY_SHARE", repr(figure(shot.view.sky_share))),
        ("ERROR_BOUND_PX", repr(figure(plan.accuracy.bound_px))),
        *((("HEIGHTS", plan.relief.attribution),) if not plan.relief.is_level else ()),
        *((("MISSING_HEIGHTS", "interpolated"),) if _interpolates(plan) else ()),
    )


def _interpolates(plan: Plan) -> bool:
    """Whether heights may be interpolated: how many are is known for the area alone, and not for what images see."""
    return not plan.relief.is_level and plan.mission.terrain.holes == INTERPOLATE


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
    image_width, image_height = (
        np.asarray(size[at], np.float64) for size in (plan.frames.width_px, plan.frames.height_px)
    )
    poses = plan.poses.take(at)
    places = {"lat_deg": "pose_lat_deg", "lon_deg": "pose_lon_deg"}
    camera: dict[str, Any] = {places.get(name, name): values for name, values in _wrapped(poses).items()}
    if plan.nominal is not None:
        nominal = _wrapped(plan.nominal.take(at))
        camera.update({f"nominal_{name}": values for name, values in nominal.items()})
    if plan.direct.has_times:
        camera["time_utc"] = tuple(clock(plan.direct.start, plan.times_s[at])) if len(at) else ()
    if plan.mission.output.img_size:
        image_width, image_height = (
            np.full(len(at), float(size)) for size in plan.mission.output.img_size[:2]
        )
    if not plan.relief.is_level:
        camera.update(height_m=plan.height_m[at])
        camera.update(facade_share=np.array([row.facade_share for row in rows], np.float64))
    plane = plan.grid.plane
    if not plane.wraps:
        pixel = (np.full(len(at), size) for size in plan.grid.pixel_size(plan.zoom))
        camera.update(zip(("pixel_width", "pixel_height"), pixel))
        camera.update(west=plan.edges[0][at], north=plan.edges[3][at])
    known = {
        "img_names": tuple(f"{row.name}.{plan.mission.output.image_format}" for row in rows),
        "columns": plan.column[at],
        "rows": plan.row[at],
        "lat_deg": centre_lat[at],
        "lon_deg": centre_lon[at],
        "zoom": np.full(len(at), plan.zoom, np.int64),
        "entropies": np.array([np.nan if row.entropy is None else row.entropy for row in rows], np.float64),
        **camera,
        "left_px": np.asarray(plan.grid.wrapped_px(left, plan.zoom), np.float64),
        "top_px": top,
        "width_px": width,
        "height_px": height,
        "image_width_px": image_width,
        "image_height_px": image_height,
        **_intrinsics(plan, at),
        **({} if plane.wraps else {"crs": (plane.crs,) * len(at)}),
        "sky_share": np.array([row.sky_share for row in rows], np.float64),
        "unmapped_share": np.array([row.unmapped_share for row in rows], np.float64),
        "source": (source.title,) * len(at),
        "attribution": (source.attribution,) * len(at),
        "imagery_date": (source.date,) * len(at),
        **_shards_of(rows),
        "status": tuple(row.status for row in rows),
        "reason": tuple(row.reason for row in rows),
    }
    return Table.from_columns(known, {})


def write_tables(
    folder: Path,
    plan: Plan,
    source: Source,
    outcomes: Mapping[str, Outcome],
    others: Mapping[str, Mapping[str, str]],
    *,
    in_shards: bool = False,
) -> None:
    """Write what tells of all pictures of a map type that are done or have failed.

    Parameters
    ----------
    folder : Path
        Of the map type.
    others : mapping
        Columns that others have added to its table, as `other_columns` reads them.
    in_shards : bool
        Whether pictures have no files of their own, of which OpenDroneMap would be told.
    """
    table_of(plan, source, outcomes).join_other(others).save(folder / TABLE_FILE)
    if plan.mission.output.image_format == "jpg" and not in_shards:
        made = {name for name, one in outcomes.items() if one.status != FAILED}
        at = [index for index, name in enumerate(plan.names) if name in made]
        write_odm_files(folder, plan, np.array(at, np.int64))


def _intrinsics(plan: Plan, at: NDArray[np.int64]) -> dict[str, Floats]:
    """Columns of focal lengths and principal points, to the decimals in which all processors agree."""
    columns = (np.round(values, _PX_DIGITS) for values in optics_of(plan, at)[2:])
    return dict(zip(("fx_px", "fy_px", "cx_px", "cy_px"), columns))


def _shards_of(rows: Sequence[Outcome]) -> dict[str, Any]:
    """Columns of where images are in files of many."""
    if not any(row.shard for row in rows):
        return {}
    return {
        "shard": tuple(row.shard for row in rows),
        "offset_bytes": np.array([row.offset_bytes if row.shard else np.nan for row in rows], np.float64),
        "size_bytes": np.array([row.length_bytes if row.shard else np.nan for row in rows], np.float64),
    }


def _wrapped(poses: Poses) -> dict[str, Floats]:
    """Columns of poses by name, their longitudes wrapped."""
    return poses._replace(lon_deg=wrap_lon_deg(poses.lon_deg))._asdict()
