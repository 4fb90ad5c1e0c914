"""Jobs that make the images of a plan, and tables of images."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray, PixelValues
from ..bands import RGB, Bands, Range, shown_in_8_bits, source_bands, source_ranges
from ..dataset.entropy import entropy
from ..dataset.folder import TABLE_FILE
from ..dataset.table import Table
from ..errors import Message, PartError
from ..geodesy.camera import Poses
from ..geodesy.contract import PIXEL_DECIMALS
from ..geodesy.mercator import wrap_lon_deg
from ..imagery.source import Part, Source, Window
from ..labels.label_map import LabelMap
from ..map_types import CLEAN, UNDISTORTED, twin_type
from ..mission.export.rows import clock
from ..mission.lenses import CaptureCameras
from ..mission.parts import CLASSES, INTERPOLATE, LABELLED, RAW
from ..mission.plan import Plan
from ..mission.takes import Facts
from ..picture.effects import Development
from ..picture.map_frame import resized
from ..picture.optics import CameraSettings, Exposure, Exposures, plan_optics
from ..picture.scene import RawValues
from ..picture.shot import MapShot, Picture, Shot, draw, make_shot
from ..storage.files import write_whole
from ..waiting import cancellable
from .georeference import ControlPoints, Georeference
from .journal import FAILED, Outcome
from .metadata import Description, degrees, figure
from .odm import write_odm_files
from .writers import Place, Write, label_format, write_labels, write_picture


@dataclass(frozen=True)
class PictureJob:
    """Job of making an image from pixels, as a plain value for any worker.

    Parameters
    ----------
    index : int
        Index of the capture in the plan.
    image_format : str
        tif, jpg or png.
    img_size : tuple (width, height, channels) or None
    shot : MapShot or Shot
        Geometry of a map frame or a camera frame.
    masked : bool
        Whether the image has a mask channel.
    bands : Bands
        Bands of the source.
    ranges : tuple of (low, high)
        Values displayed darkest and brightest, for each band.
    products : (Plan, Path) or None
        Plan from which products are computed, and the folder that holds one subfolder for each product.
    write : callable
        Writes a file.
    labels : LabelMap or None
        Labels for the products classes and instances.
    development : Development or None
        The picture's way through a real camera; None for an ideal one.
    is_clean : bool
        Whether this is a twin without effects on light and blur by motion.
    twins : tuple of PictureJob
        Jobs of the twins.
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
    write: Write = write_whole
    labels: LabelMap | None = None
    development: Development | None = None
    is_clean: bool = False
    twins: tuple[PictureJob, ...] = ()

    def failed(self, error: PartError) -> Outcome:
        """Outcome of an image that could not be made."""
        return Outcome(self.description.map_type, self.description.name, reason=Message(error))


def make_picture(job: PictureJob, parts: Sequence[Part], pixels: Mapping[Window, PixelValues]) -> Outcome:
    """Make an image and its twins, and write them; entropies are computed before JPEG compression.

    Raises
    ------
    PartError
        Parts of the image are missing; nothing is written.
    OutputError
        The image cannot be written.
    Cancelled
        The enclosing `waiting.cancellable` is cancelled while the picture is drawn; nothing is written.
    """
    is_blurred = isinstance(job.shot, Shot) and len(job.shot.instants) > 1
    drawn = _draw(job, parts, pixels)
    # All before any is written, as parts may be missing.
    of_twins = [drawn if twin.is_clean and not is_blurred else _draw(twin, parts, pixels) for twin in job.twins]
    # What is drawn is written whole, even if the run is stopped meanwhile.
    with cancellable(None):
        made = _make(job, drawn)
        twins = tuple(
            made.clean(*_write_clean(twin, seen.pixels)) if twin.is_clean else _make(twin, seen)
            for twin, seen in zip(job.twins, of_twins)
        )
    return replace(made, twins=twins)


def _draw(job: PictureJob, parts: Sequence[Part], pixels: Mapping[Window, PixelValues]) -> Picture:
    return draw(job.shot, parts, pixels, masked=job.masked, bands=job.bands, sharp=job.is_clean)


class DevelopedPicture(NamedTuple):
    """A picture that a camera has made, its raw values, what is stated of it, and its description."""

    pixels: PixelValues
    raw: RawValues | None
    facts: Facts
    description: Description


def develop_picture(job: PictureJob, picture: PixelValues) -> DevelopedPicture:
    """Develop a drawn picture."""
    description = job.description
    facts: Facts = ()
    raw: RawValues | None = None
    if isinstance(job.shot, Shot):
        description = replace(description, more=_camera_metadata(job.shot))
        facts = () if job.shot.timing is None else job.shot.timing.facts
    if job.development is not None:
        picture, developed, raw = job.development.develop(picture, job.shot, len(job.bands))
        facts = tuple({**dict(facts), **dict(developed)}.items())
    if facts:
        stated = tuple((name.upper(), stated_fact(value)) for name, value in facts)
        description = replace(description, more=(*description.more, *stated))
        if description.exposure is not None:
            exposure = replace(description.exposure, settings=CameraSettings.of_facts(dict(facts)))
            description = replace(description, exposure=exposure)
    return DevelopedPicture(picture, raw, facts, description)


def _make(job: PictureJob, drawn: Picture) -> Outcome:
    """Develop a drawn picture, and write it and its products."""
    picture, raw, facts, description = develop_picture(job, drawn.pixels)
    if job.products is not None:
        from ..picture.products import BANDS, products

        plan, folder = job.products
        size_px = (picture.shape[1], picture.shape[0]) if job.img_size is None else job.img_size[:2]
        for name, values in products(plan, job.index, size_px, job.shot, job.labels):
            if name in LABELLED and job.labels is not None:
                colours = job.labels.classes.colours if name == CLASSES else None
                ending = label_format(job.image_format, values.dtype)
                write_labels(folder / name, ending, values, job.place, description, colours, job.write)
                continue
            limits = value_ranges(values, BANDS[name])
            write_picture(folder / name, "tif", values, job.place, description, BANDS[name], limits, job.write)
        if raw is not None and RAW in plan.mission.products:
            limits = [(0.0, float(raw.most_dn))] * len(raw.bands)
            write_picture(folder / RAW, "tif", raw.values, job.place, description, raw.bands, limits, job.write)
    bits, size_bytes = _write_image(replace(job, description=description), picture)
    return Outcome(
        description.map_type,
        description.name,
        bits,
        sky_share=drawn.sky_share,
        unmapped_share=drawn.unmapped_share,
        facade_share=drawn.facade_share,
        size_bytes=size_bytes,
        facts=facts,
    )


def _write_clean(job: PictureJob, picture: PixelValues) -> tuple[float, int]:
    """Write a picture as it is before light has effects; see `_write_image`.

    Its pixels show the same places as the image's, so the products are those of both.
    """
    if isinstance(job.shot, Shot):
        job = replace(job, description=replace(job.description, more=_camera_metadata(job.shot)))
    return _write_image(job, picture)


def _write_image(job: PictureJob, picture: PixelValues) -> tuple[float, int]:
    """Write a picture as an image; returns its entropy and the size of its files in bytes."""
    picture = resized(picture, job.img_size, job.bands)
    if job.bands == RGB:
        size_bytes = write_picture(job.folder, job.image_format, picture, job.place, job.description, write=job.write)
        return entropy(picture[..., :3] if picture.ndim > 2 else picture), size_bytes
    bands, ranges = bands_as_written(job)
    picture = picture.reshape(*picture.shape[:2], -1)
    size_bytes = write_picture(
        job.folder, job.image_format, picture, job.place, job.description, bands, ranges, job.write
    )
    return entropy(shown_in_8_bits(picture, bands, ranges)), size_bytes


def stated_fact(value: float | str) -> str:
    """Text of a fact in tables and metadata."""
    return value if isinstance(value, str) else repr(figure(value))


def value_ranges(values: NDArray[Any], bands: Bands) -> list[Range]:
    """Minimum and maximum of the finite values of each band; 0 and 1 where there are none."""
    known = [values[..., band][np.isfinite(values[..., band])] for band in range(len(bands))]
    return [(float(one.min()), float(one.max())) if one.size else (0.0, 1.0) for one in known]


def bands_as_written(job: PictureJob) -> tuple[Bands, tuple[Range, ...]]:
    """Bands of an image file, and their displayed ranges."""
    if job.img_size is None:
        return job.bands, job.ranges
    bands = job.bands.picture_bands(job.img_size[2])
    shown = [job.ranges[at] for at in job.bands.shown]
    # Grey is the mean of the colours, and its range the mean of their ranges.
    low, high = (float(np.mean(ends)) for ends in zip(*shown))
    return bands, tuple(shown) if len(bands) == len(shown) else ((low, high),)


def plan_exposures(plan: Plan) -> Exposures | None:
    """Exposures for the images' tags; None for formats without such tags."""
    return Exposures(plan) if plan.mission.output.image_format == "jpg" else None


def image_job(
    plan: Plan,
    index: int,
    source: Source,
    map_type: str,
    folder: Path,
    exposures: Exposures | None = None,
    products_in: Path | None = None,
    write: Write = write_whole,
    labels: LabelMap | None = None,
) -> PictureJob:
    """Return the job of a capture; ``exposures`` add EXIF and XMP as drones write them."""
    exposure = None if exposures is None else exposures.exposure(index)
    job = replace(
        _lens_job(plan, index, source, map_type, folder, exposure),
        products=None if products_in is None else (plan, products_in),
        write=write,
        labels=labels,
        development=Development.of(plan, index, map_type),
    )
    return replace(job, twins=tuple(_twin_job(job, plan, source, kind) for kind in plan.mission.varied.twins))


def _twin_job(job: PictureJob, plan: Plan, source: Source, kind: str) -> PictureJob:
    """Job of a twin of an image."""
    map_type = twin_type(job.description.map_type, kind)
    folder = job.folder.parent / map_type
    if kind == CLEAN:
        description = replace(job.description, map_type=map_type)
        return replace(
            job, folder=folder, description=description, products=None, labels=None, development=None, is_clean=True
        )
    seen, exposure = twin_plan(plan, kind), job.description.exposure
    if exposure is not None:
        exposure = exposure.through_lens(seen, job.index)
    return replace(
        _lens_job(seen, job.index, source, map_type, folder, exposure),
        write=job.write,
        # The same sensor has the same noise.
        development=Development.of(seen, job.index, job.description.map_type),
    )


def twin_plan(plan: Plan, kind: str) -> Plan:
    """Plan of the twins of a kind: with the same captures."""
    return plan.undistorted if kind == UNDISTORTED else plan


def _lens_job(
    plan: Plan, index: int, source: Source, map_type: str, folder: Path, exposure: Exposure | None
) -> PictureJob:
    """Job of a capture as the lens of its plan shows it, without products and effects on light."""
    mission = plan.mission
    width, height = int(plan.frames.width_px[index]), int(plan.frames.height_px[index])
    if mission.output.img_size:
        width, height = mission.output.img_size[:2]
    shot = make_shot(plan, index)
    place: Place
    if plan.frames.on_map:
        west, south, east, north = (float(edges[index]) for edges in plan.edges)
        turns = int(plan.frames.quarter_turns[index])
        place = Georeference(west, south, east, north, width, height, plan.grid.plane.crs, turns)
    else:
        place = ControlPoints.from_plan(plan, index, width, height)
    pose: dict[str, Any] = {n: float(values[index]) for n, values in zip(plan.poses._fields, plan.poses)}
    return PictureJob(
        index,
        folder,
        mission.output.image_format,
        mission.output.img_size,
        shot,
        # A resized image has only the channels asked for; JPEG has no mask.
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
            exposure=exposure,
            **pose,
        ),
        source_bands(source),
        source_ranges(source),
    )


def _effective_gsd_m(plan: Plan, index: int) -> float:
    """Metres of ground in the middle of an image: the larger of a pixel of the image and a pixel of the source."""
    mission, grid = plan.mission, plan.grid
    if plan.frames.on_map:
        pixel_m = float(plan.pixels_m[index])
        source_m = pixel_m * grid.world_px(plan.zoom) / grid.world_px(min(plan.zoom, grid.native_zoom))
    else:
        lat, lon = np.asarray(plan.lat_deg[index]), np.asarray(plan.lon_deg[index])
        pixel_m = plan.camera(index).ground_size_m(float(plan.agl_m[index]))[0] / float(plan.frames.width_px[index])
        zoom = min(plan.frames.finest_zoom(plan), grid.native_zoom)
        source_m = float(grid.ground_m_per_px(lat, lon, zoom))
    if mission.output.img_size is not None:
        pixel_m *= float(plan.frames.width_px[index]) / mission.output.img_size[0]
    return max(pixel_m, source_m)


def _camera_metadata(shot: Shot) -> tuple[tuple[str, str], ...]:
    """Metadata that only camera frames have."""
    plan, camera = shot.plan, shot.plan.camera(shot.index)
    return (
        ("FRAME", "camera"),
        ("FOV_DEG", repr(degrees(camera.fov_deg))),
        ("ASPECT_RATIO", repr(figure(camera.aspect_ratio))),
        ("GROUND_HEIGHT_M", repr(figure(float(plan.ground_m[shot.index])))),
        ("RESAMPLING", shot.kernel),
        ("SKY_SHARE", repr(figure(shot.sky_share))),
        ("ERROR_BOUND_PX", repr(figure(plan.accuracy.bound_px))),
        *((("HEIGHTS", plan.relief.attribution),) if not plan.relief.is_level else ()),
        *((("MISSING_HEIGHTS", "interpolated"),) if _interpolates(plan) else ()),
    )


def _interpolates(plan: Plan) -> bool:
    """Whether heights may be interpolated; which images that concerns is not known."""
    return not plan.relief.is_level and plan.mission.terrain.holes == INTERPOLATE


def image_table(plan: Plan, source: Source, outcomes: Mapping[str, Outcome]) -> Table:
    """Return the table of the images with an outcome, in the plan's order.

    Parameters
    ----------
    outcomes : mapping of str to Outcome
        Outcomes by image name.
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
    headers = {"lat_deg": "pose_lat_deg", "lon_deg": "pose_lon_deg"}
    camera: dict[str, Any] = {headers.get(name, name): values for name, values in _wrapped(poses).items()}
    if plan.nominal is not None:
        nominal = _wrapped(plan.nominal.take(at))
        camera.update({f"nominal_{name}": values for name, values in nominal.items()})
    if plan.direct.has_times:
        camera["time_utc"] = tuple(clock(plan.direct.start, plan.times_s[at])) if len(at) else ()
    if plan.mission.output.img_size:
        image_width, image_height = (np.full(len(at), float(size)) for size in plan.mission.output.img_size[:2])
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
        **_shard_columns(rows),
        "status": tuple(row.status for row in rows),
        "reason": tuple(row.reason for row in rows),
    }
    return Table.from_columns(known, {**_lens_columns(plan.cameras, at), **_fact_columns(rows)})


def write_tables(
    folder: Path,
    plan: Plan,
    source: Source,
    outcomes: Mapping[str, Outcome],
    others: Mapping[str, Mapping[str, str]],
    *,
    in_shards: bool = False,
) -> None:
    """Write the table of a map type, and files for OpenDroneMap if its images are separate JPEG files.

    Parameters
    ----------
    folder : Path
        Folder of the map type.
    others : mapping
        Additional columns of the table, as `dataset.table.other_columns` reads them.
    in_shards : bool
        Whether images are stored in shards.
    """
    table = image_table(plan, source, outcomes)
    table.replace_other({**table.join_other(others).other, **table.other}).save(folder / TABLE_FILE)
    if plan.mission.output.image_format == "jpg" and not in_shards:
        made = {name for name, one in outcomes.items() if one.status != FAILED}
        at = [index for index, name in enumerate(plan.names) if name in made]
        write_odm_files(folder, plan, np.array(at, np.int64))


def _intrinsics(plan: Plan, at: NDArray[np.int64]) -> dict[str, Floats]:
    """Columns of focal lengths and principal points."""
    columns = (np.round(values, PIXEL_DECIMALS) for values in plan_optics(plan, at)[2:])
    return dict(zip(("fx_px", "fy_px", "cx_px", "cy_px"), columns))


def _fact_columns(rows: Sequence[Outcome]) -> dict[str, tuple[str, ...]]:
    """Columns of what is stated of a real camera's effects on the images, by header."""
    stated = [dict(row.facts) for row in rows]
    headers = dict.fromkeys(header for facts in stated for header in facts)
    return {header: tuple(stated_fact(facts.get(header, "")) for facts in stated) for header in headers}


def _lens_columns(cameras: CaptureCameras, at: NDArray[np.int64]) -> dict[str, tuple[str, ...]]:
    """Columns of lenses by header, as OpenCV defines their coefficients; none for lenses without distortion."""
    if not cameras.distort:
        return {}
    lenses = [cameras.of(index) for index in at.tolist()]
    stated = [{"lens": one.lens, **one.coefficients} for one in lenses]
    return {name: tuple(str(one[name]) for one in stated) for name in ("lens", *cameras.distinct[0].coefficients)}


def _shard_columns(rows: Sequence[Outcome]) -> dict[str, Any]:
    """Columns of the images' positions in shards."""
    if not any(row.shard for row in rows):
        return {}
    return {
        "shard": tuple(row.shard for row in rows),
        "offset_bytes": np.array([row.offset_bytes if row.shard else np.nan for row in rows], np.float64),
        "size_bytes": np.array([row.length_bytes if row.shard else np.nan for row in rows], np.float64),
    }


def _wrapped(poses: Poses) -> dict[str, Floats]:
    """Columns of poses by name, with wrapped longitudes."""
    return poses._replace(lon_deg=wrap_lon_deg(poses.lon_deg))._asdict()
