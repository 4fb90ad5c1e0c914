"""Figures of a plan: images, coverage, overlap, bytes and time, for people and scripts."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from ..bands import RGB
from ..camera.light import SRGB
from ..errors import Message, OptionName
from ..external.compiling import uses_numba
from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import wrap_lon_deg
from .areas.area import Polygon, Polygons
from .flight.pilot import (
    SpeedLimits,
    Sun,
    airborne_s,
    airborne_text,
    area_sun,
    batteries,
    interval_s,
    interval_warnings,
    sorties_text,
    speed_limits,
)
from .methods import ChosenMethods
from .mission import Mission
from .parts import IDEAL, NO_VIGNETTING
from .plan import Plan
from .takes import Timing, fastest_capture, motion_text

#: Most pixels of an orthomosaic that QGIS makes after a capture.
MOST_ORTHOMOSAIC_PX = 1 << 28
#: Largest angle from the vertical at which an orthomosaic uses images, degrees; beyond, a pixel spans over 30 times the
#: ground that it spans at the nadir.
ORTHOMOSAIC_DEG = 80.0
#: Most threads that make an orthomosaic.
ORTHOMOSAIC_THREADS = 8
#: Rows of each of four strips by which the samples of an image by area are judged.
_SAMPLED_ROWS = 16


@dataclass(frozen=True)
class Costs:
    """Assumed costs of a request and of a pixel, which estimates are based on.

    Attributes
    ----------
    request_s, request_bytes : float
        Time and size of one request, on one connection or core.
    encode_s_per_px : dict
        Time to assemble, encode and write a pixel, on one core, by image format.
    image_s : float
        Time of an image beside that of its pixels, on one core: file, metadata and journal.
    bytes_per_px : dict
        Size of a pixel in the written files, by image format.
    warp_s_per_px : float
        Time to resample a pixel of a camera frame from tiles, on one core.
    trace_s_per_px, trace_s_per_cell : float
        Time to trace the rays of a camera frame over relief, twice, on one core: per pixel of the frame, and per cell
        of the relief below.
    take_s_per_px, strip_s, traced_strip_s : float
        Time to draw a pixel once more, at another instant or in another colour, on one core; and for each strip of rows
        with a pose of its own, over level ground and over relief (`benchmarks/realism.py`).
    sample_s, sample_numpy_s : float
        Time to take a sample of a pixel's area, on one core, with numba and without.
    mosaic_s_per_px : float
        Time to read a pixel of an image for a mosaic, on one core.
    orthomosaic_s_per_px, orthomosaic_trace_s_per_px : float
        Time to make a pixel of an orthomosaic, on one core, and to trace it over relief.
    requests_per_s : float or None
        Rate limit of the source; None without one.
    pixels_from : str
        Where pixels come from: ``network``, ``file``, or ``computer`` if they are computed or drawn here.
    """

    request_s: float
    request_bytes: float
    encode_s_per_px: dict[str, float]
    bytes_per_px: dict[str, float]
    image_s: float = 1.2e-3
    warp_s_per_px: float = 1e-7
    trace_s_per_px: float = 2e-6
    trace_s_per_cell: float = 5e-7
    take_s_per_px: float = 3e-8
    strip_s: float = 1.3e-3
    traced_strip_s: float = 7e-3
    sample_s: float = 1.1e-8
    sample_numpy_s: float = 1.1e-7
    mosaic_s_per_px: float = 8e-8
    orthomosaic_s_per_px: float = 8e-7
    orthomosaic_trace_s_per_px: float = 5e-6
    requests_per_s: float | None = None
    pixels_from: str = "network"


#: Aerial photographs online: a compressed tile of 256 px has about 15 kB, a request takes about 60 ms.
ONLINE = Costs(
    request_s=0.06,
    request_bytes=15_000.0,
    encode_s_per_px={"tif": 0.9e-7, "jpg": 0.8e-7, "png": 1.2e-7},
    bytes_per_px={"tif": 1.7, "jpg": 0.55, "png": 1.6},
)
#: Aerial photographs in a local file.
FROM_FILE = replace(ONLINE, request_s=0.01, request_bytes=0.0, pixels_from="file")
#: The embedded world: tiles are computed here, and are smoother than photographs.
OFFLINE = replace(
    FROM_FILE, request_s=0.005, bytes_per_px={"tif": 0.88, "jpg": 0.31, "png": 0.69}, pixels_from="computer"
)


@dataclass(frozen=True)
class Summary:
    """Figures of a plan; shares are from 0 to 1, and figures that do not apply are None (points have no area).

    Figures of relief are None over level ground. The finest and coarsest ground sample distances are taken straight
    below the camera, at the highest and the lowest ground that its image may show. ``hidden_share`` is the share of the
    area that lies within images, but that relief hides in all of them.

    ``flight_…`` figures go from image to image without turns. ``path_…`` figures add turns and the ways to and from the
    take-off, over all sorties; None without a route. ``interval_s`` is the shortest time between two images of a row.
    ``fov_deg`` is 0 unless the camera looks straight down. ``airborne_s`` is from take-off to landing, as
    QGroundControl counts it, with ``batteries`` of the mission's ``drone``.

    ``mosaic_s`` is the time of the mosaics that QGIS makes after the ``seconds`` of the capture; JSON omits it, as the
    command makes none.

    ``polygons`` counts the polygons of the area. ``images_over_no_fly`` counts images left out because their camera
    would stand inside one of the ``no_fly_areas``. Covered and uncovered shares refer to the ground outside these;
    ``no_fly_m2`` is the area's ground inside them. ``images_in_skipped_rows`` counts the images of ``skip_rows``.

    ``own_pixels`` describes the pixels of a source whose CRS is not the map's; otherwise it is empty.
    """

    images: int
    rows: int
    columns: int
    zoom: int
    own_pixels: str
    width_px: int
    height_px: int
    requested_gsd_m_per_px: float
    delivered_gsd_m_per_px: float
    flight_distance_m: float
    flight_s: float
    area_m2: float | None
    uncovered_m2: float | None
    covered_share: float | None
    complete: bool | None
    imagery_share: float | None
    images_outside: int
    images_partly_outside: int
    least_overlap_along: float | None
    median_overlap_along: float | None
    least_overlap_across: float | None
    median_overlap_across: float | None
    unique_tiles: int
    pixels_from: str
    download_bytes: int
    output_bytes: int
    seconds: float
    map_types: tuple[str, ...]
    accuracy: ChosenMethods
    warnings: tuple[str, ...] = ()
    lowest_ground_m: float | None = None
    highest_ground_m: float | None = None
    finest_gsd_m_per_px: float | None = None
    coarsest_gsd_m_per_px: float | None = None
    clearance_m: float | None = None
    hidden_share: float | None = None
    level_ground_m: float | None = None
    filled_heights: int | None = None
    interpolated_heights: int | None = None
    heights: int | None = None
    path_m: float | None = None
    path_s: float | None = None
    sorties_s: tuple[float, ...] = ()
    battery_min: float | None = None
    interval_s: float | None = None
    sun: Sun | None = None
    fov_deg: float = 0.0
    polygons: int = 0
    no_fly_areas: int = 0
    images_over_no_fly: int = 0
    no_fly_m2: float | None = None
    airborne_s: float | None = None
    batteries: int | None = None
    speed_limits: SpeedLimits | None = None
    drone: str = ""
    motion: Message | None = None
    mosaic_s: float = 0.0
    skip_rows: str = ""
    images_in_skipped_rows: int = 0

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping."""
        plain = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in ("accuracy", "mosaic_s")}
        sun, limits = (None if one is None else one._asdict() for one in (self.sun, self.speed_limits))
        return {**plain, "sun": sun, "speed_limits": limits, "accuracy": self.accuracy.to_dict()}

    @property
    def lacks_imagery(self) -> bool:
        """Whether the source is known to lack imagery of part of the area."""
        return self.imagery_share is not None and self.imagery_share < 1.0

    def lines(self) -> list[tuple[str, str]]:
        """Label and value of each figure, for people."""
        types = len(self.map_types)
        each = Message(" for each of {0} map types", types) if types > 1 else ""
        images = Message("{0:,}{1}", self.images, each)
        shape = Message("{0} x {1} px at zoom {2}", self.width_px, self.height_px, self.zoom)
        if self.own_pixels:
            shape = Message("{0} x {1} px: {2}", self.width_px, self.height_px, self.own_pixels)
        requested, delivered = map(length_text, (self.requested_gsd_m_per_px, self.delivered_gsd_m_per_px))
        lines: list[tuple[str, str]] = [
            (Message("images"), images),
            *self._area_lines(),
            (Message("rows, columns"), f"{self.rows}, {self.columns}"),
            (Message("image"), shape),
            (
                Message("ground sample distance"),
                Message("requested {0}, delivered {1}", requested, delivered),
            ),
            *self._relief_lines(),
            (Message("flight distance"), length_text(self.flight_distance_m)),
            (Message("flight time"), duration_text(self.flight_s)),
            *self._path_lines(),
        ]
        if self.covered_share is not None and self.uncovered_m2 is not None:
            words = Message("complete but for missing imagery") if self.lacks_imagery else Message("complete")
            if not self.complete:
                words = Message("{0} uncovered", area_text(self.uncovered_m2))
            if self.hidden_share:
                words = Message("{0}; relief hides about {1:.1f} %", words, 100.0 * self.hidden_share)
            share = percent(self.covered_share, exact=bool(self.complete))
            if self.no_fly_m2:
                share = Message("{0} of the area outside no-fly areas", share)
            lines.append((Message("coverage"), Message("{0} ({1})", share, words)))
        if self.imagery_share is not None and self.lacks_imagery:
            lines.append(
                (
                    Message("imagery"),
                    Message("the source has imagery of {0} of the area", percent(self.imagery_share, exact=False)),
                )
            )
        for label, least, median in (
            (Message("front overlap"), self.least_overlap_along, self.median_overlap_along),
            (Message("side overlap"), self.least_overlap_across, self.median_overlap_across),
        ):
            if least is not None and median is not None:
                lines.append((label, Message("least {0:.2f} %, median {1:.2f} %", 100 * least, 100 * median)))
        each = Message(" a map type") if types > 1 else ""
        lines += [
            (Message("tiles"), Message("{0:,}{1}, each fetched once", self.unique_tiles, each)),
            (Message("download"), self._download()),
            (Message("files"), size_text(self.output_bytes)),
            (Message("time"), Message("about {0}", duration_text(max(self.seconds, 1.0)))),
            *self.accuracy.lines(),
            *((Message("warning"), text) for text in self.warnings),
        ]
        return lines

    def _path_lines(self) -> list[tuple[str, str]]:
        lines: list[tuple[str, str]] = []
        if self.path_m is not None and self.path_s is not None:
            path = Message("{0}, {1} with turns", length_text(self.path_m), duration_text(self.path_s))
            lines.append((Message("flight path"), path))
        return [*lines, *self.piloting()]

    def piloting(self) -> list[tuple[Message, Message]]:
        """Labels and values of the greatest speed, the time in the air, sorties and sun, if known."""
        lines = []
        if self.motion is not None:
            lines.append((Message("motion in images"), self.motion))
        if self.speed_limits is not None and self.speed_limits.least_m_per_s is not None:
            lines.append((Message("greatest speed"), self.speed_limits.text))
        if self.airborne_s is not None and self.batteries is not None:
            airborne = airborne_text(self.airborne_s, self.batteries, self.drone)
            lines.append((Message("time in the air"), airborne))
        if self.battery_min is not None or len(self.sorties_s) > 1:
            lines.append((Message("sorties"), sorties_text(self.sorties_s, self.battery_min)))
        if self.sun is not None:
            lines.append((Message("sun"), self.sun.text(self.fov_deg)))
        return lines

    def _area_lines(self) -> list[tuple[str, str]]:
        """Lines on an area of several polygons, and on images left out over no-fly areas."""
        lines: list[tuple[str, str]] = []
        if self.polygons > 1 and self.area_m2 is not None:
            lines.append((Message("area"), Message("{0:,} polygons, {1}", self.polygons, area_text(self.area_m2))))
        if self.no_fly_areas:
            words = Message("{0:,} images left out", self.images_over_no_fly)
            if self.no_fly_m2:
                words = Message("{0}, {1} of the area", words, area_text(self.no_fly_m2))
            lines.append((Message("over no-fly areas"), words))
        if self.skip_rows:
            words = Message("{0}: {1:,} images left out", self.skip_rows, self.images_in_skipped_rows)
            lines.append((Message("skipped rows"), words))
        return lines

    def _relief_lines(self) -> list[tuple[str, str]]:
        if self.level_ground_m is not None:
            level = Message("{0:,.1f} m above the ellipsoid everywhere", self.level_ground_m)
            return [(Message("ground below"), level)]
        if self.lowest_ground_m is None or self.finest_gsd_m_per_px is None:
            return []
        ground = Message(
            "from {0:,.1f} to {1:,.1f} m above the ellipsoid, captures at least {2:,.1f} m clear",
            self.lowest_ground_m,
            self.highest_ground_m,
            self.clearance_m,
        )
        finest, coarsest = map(length_text, (self.finest_gsd_m_per_px, self.coarsest_gsd_m_per_px or 0.0))
        holes = []
        if self.filled_heights and self.heights:
            share = percent(self.filled_heights / self.heights, exact=False)
            counts = Message(
                "{0:,} of {1:,} heights around the area ({2}), from the next source",
                self.filled_heights,
                self.heights,
                share,
            )
            holes.append((Message("holes filled"), counts))
        if self.interpolated_heights and self.heights:
            share = percent(self.interpolated_heights / self.heights, exact=False)
            counts = Message(
                "{0:,} of {1:,} heights around the area ({2}), from the heights around them",
                self.interpolated_heights,
                self.heights,
                share,
            )
            holes.append((Message("holes interpolated"), counts))
        return [
            (Message("ground below"), ground),
            *holes,
            (
                Message("over the relief"),
                Message("{0} per pixel at the highest point, {1} at the lowest", finest, coarsest),
            ),
        ]

    def _download(self) -> Message:
        if self.pixels_from == "file":
            return Message("nothing (read from the file)")
        return size_text(self.download_bytes) if self.download_bytes else Message("nothing (computed here)")


def estimate(plan: Plan, costs: Costs = ONLINE, connections: int = 8, cores: int = 2) -> Summary:
    """Compute the figures of a plan, for all of its map types; time and bytes follow from ``costs``.

    Parameters
    ----------
    connections, cores : int
        Simultaneous requests, and cores that encode.
    """
    mission, types = plan.mission, len(plan.mission.imagery.map_types)
    pixels = _image_px(plan) * (1 + len(mission.varied.twins))
    fetch_s = plan.requests * costs.request_s / (connections if costs.request_bytes else cores)
    if costs.requests_per_s:
        fetch_s = max(fetch_s, plan.requests / costs.requests_per_s)
    pixel_s = costs.encode_s_per_px[mission.output.image_format] + _effects_s_per_px(mission)
    encode_s = (len(plan) * costs.image_s + pixels * pixel_s + _draw_s(plan, costs)) / cores
    # Computing tiles competes with encoding for cores; waiting for a server does not.
    seconds = max(fetch_s, encode_s) if costs.request_bytes else fetch_s + encode_s
    coverage, overlap, relief = plan.coverage, plan.overlap, _relief_figures(plan)
    return Summary(
        images=len(plan),
        rows=plan.rows,
        columns=int(plan.column.max()) + 1,
        zoom=plan.zoom,
        own_pixels=own_pixels_text(plan),
        width_px=int(plan.frames.width_px.max()),
        height_px=int(plan.frames.height_px.max()),
        requested_gsd_m_per_px=plan.resolution.requested_m_per_px,
        delivered_gsd_m_per_px=plan.resolution.delivered_m_per_px,
        flight_distance_m=plan.direct.distance_m,
        flight_s=plan.direct.duration_s,
        area_m2=None if coverage is None else coverage.area_m2 + coverage.no_fly_m2,
        uncovered_m2=None if coverage is None else coverage.uncovered_m2,
        covered_share=None if coverage is None else coverage.share,
        complete=None if coverage is None else coverage.complete,
        imagery_share=plan.imagery.share,
        images_outside=plan.imagery.outside,
        images_partly_outside=plan.imagery.partly,
        least_overlap_along=overlap.least_along,
        median_overlap_along=overlap.median_along,
        least_overlap_across=overlap.least_across,
        median_overlap_across=overlap.median_across,
        unique_tiles=plan.requests,
        pixels_from=costs.pixels_from,
        download_bytes=round(types * plan.requests * costs.request_bytes),
        output_bytes=round(types * pixels * costs.bytes_per_px[mission.output.image_format]),
        seconds=types * seconds,
        mosaic_s=mosaic_s(plan, costs, cores),
        map_types=mission.imagery.map_types,
        accuracy=plan.accuracy,
        polygons=_polygon_count(plan),
        no_fly_areas=len(mission.no_fly),
        images_over_no_fly=plan.left_out,
        no_fly_m2=None if coverage is None else coverage.no_fly_m2,
        skip_rows=mission.flight.skip_rows,
        images_in_skipped_rows=plan.in_skipped_rows,
        warnings=(
            *imagery_warnings(plan),
            *upsampling_warnings(plan),
            *interval_warnings(plan),
            *building_warnings(plan),
            *lens_warnings(plan),
            *variation_warnings(plan),
        ),
        **relief,
        **_flight_figures(plan),
    )


def mosaic_s(plan: Plan, costs: Costs = ONLINE, cores: int = 2) -> float:
    """Estimate the seconds that QGIS takes for mosaics of a plan's images, of all map types, after the capture."""
    types = len(plan.mission.imagery.map_types)
    seconds = _image_px(plan) * costs.mosaic_s_per_px / cores
    if not plan.frames.is_north_up:
        # Each image is decoded whole, and found in the blocks that it reaches into.
        seconds *= 2.0
        count_px, overlap = _orthomosaic_px(plan)
        s_per_px = costs.orthomosaic_s_per_px
        if not plan.relief.is_level:
            # The more images may show a pixel, the more are traced, the steepest first.
            s_per_px += costs.orthomosaic_trace_s_per_px * math.sqrt(overlap)
        seconds += count_px * s_per_px / min(cores, ORTHOMOSAIC_THREADS)
    return types * seconds


def _image_px(plan: Plan) -> float:
    """Number of pixels in the files of one map type."""
    size = plan.mission.output.img_size
    if size is not None:
        return float(len(plan)) * size[0] * size[1]
    return float(np.sum(plan.frames.width_px * plan.frames.height_px))


def _orthomosaic_px(plan: Plan) -> tuple[float, float]:
    """Number of pixels of an orthomosaic, and of images that show each: at least 1.

    The pixels are those of the rectangle around its images, or of their footprints if that is less, as far as an
    orthomosaic uses images: what a camera sees farther away, or above the horizon, is left out.
    """
    degree_m = math.radians(1.0) * WGS84.a_m
    reach_m = math.tan(math.radians(ORTHOMOSAIC_DEG)) * plan.poses.agl_m[:, np.newaxis]
    # Metres a degree, to the east and to the north of each camera, and of the first one.
    scales = degree_m * math.cos(math.radians(float(np.median(plan.lat_deg)))), degree_m
    places = wrap_lon_deg(plan.lon_deg - plan.lon_deg[0]), plan.lat_deg - plan.lat_deg[0]
    corners = (
        wrap_lon_deg(plan.corners.lon_deg - plan.lon_deg[:, np.newaxis]),
        plan.corners.lat_deg - plan.lat_deg[:, np.newaxis],
    )
    (east, north), sides_m = (np.clip(at * scale, -reach_m, reach_m) for at, scale in zip(corners, scales)), []
    for place, corner, scale in zip(places, (east, north), scales):
        least, most = (np.where(np.isnan(corner), sign * reach_m, corner) for sign in (-1.0, 1.0))
        middle = (place * scale)[:, np.newaxis]
        sides_m.append(float((middle + most).max() - (middle + least).min()))
    across = (east * np.roll(north, -1, axis=1) - np.roll(east, -1, axis=1) * north).sum(axis=1)
    footprints_m2 = np.where(np.isnan(across), reach_m[:, 0] ** 2, np.abs(across) / 2.0)
    area_m2 = min(float(footprints_m2.sum()), sides_m[0] * sides_m[1])
    count_px = min(area_m2 / plan.resolution.picture_m_per_px**2, float(MOST_ORTHOMOSAIC_PX))
    return count_px, max(float(footprints_m2.sum()) / area_m2, 1.0)


def _draw_s(plan: Plan, costs: Costs) -> float:
    """Seconds that drawing the camera frames of one map type, with all of their takes, needs on one core."""
    if plan.frames.on_map:
        return 0.0
    mission, index = plan.mission, fastest_capture(plan) if plan.mission.takes_time else 0
    timing = Timing.of(plan, index)
    instants, strips = (1, 1) if timing is None else (timing.instants, timing.strip_count)
    takes = instants * (len(RGB) if plan.camera(index).splits_colours else 1)
    per_px = costs.warp_s_per_px + (takes - 1) * costs.take_s_per_px
    if mission.optics.by_area:
        sample_s = costs.sample_s if uses_numba() else costs.sample_numpy_s
        per_px += takes * _samples_a_px(plan, index) * sample_s
    strip_s = costs.strip_s if plan.relief.is_level else costs.traced_strip_s
    seconds = plan.frames.resampled_px() * per_px
    seconds += takes * (_trace_s(plan, costs) + len(plan) * (strips - 1) * strip_s)
    return seconds * (2 if mission.varied.keep_undistorted else 1)


def _samples_a_px(plan: Plan, index: int) -> float:
    """Samples of which a pixel of a capture is the mean, by area, judged by some strips of its rows."""
    width, height = plan.views.size_px(index)
    tops = [(2 * part + 1) * height // 8 for part in range(4)]
    strips = [(top, min(top + _SAMPLED_ROWS, height)) for top in tops]
    samples = sum(plan.views.view(index, rows=rows).sample_count for rows in strips)
    return samples / (width * sum(bottom - top for top, bottom in strips))


def _effects_s_per_px(mission: Mission) -> float:
    """Seconds that the effects of a real camera on the light of a pixel take on one core; 0 without effects."""
    # By `benchmarks/realism.py`, for 640 x 480 px.
    air, optics, exposure = mission.air, mission.optics, mission.exposure
    asked = (
        (air.visibility_km is not None, 1.7e-8),
        (optics.vignetting != NO_VIGNETTING, 0.15e-8),
        (optics.diffraction or optics.mtf50 is not None, 7e-8),
        (exposure.exposure != IDEAL, 0.1e-8),
        (bool(mission.sensor.image_sensor), 2.4e-8),
        (exposure.white_balance_k is not None, 0.4e-8),
        (exposure.tone != SRGB, 0.0),
    )
    each = [seconds for is_asked, seconds in asked if is_asked]
    # To linear light and back.
    return sum(each, 0.9e-8) if each else 0.0


def _trace_s(plan: Plan, costs: Costs) -> float:
    """Seconds that tracing rays over relief takes on one core; 0 over level ground."""
    if plan.relief.is_level:
        return 0.0
    from ..geodesy.raytracing.tracing import MOST_CELLS

    pixels = (plan.frames.width_px * plan.frames.height_px).astype(np.float64)
    cell_m = plan.relief.heights.surface.cell_m(float(plan.lat_deg[0]), float(plan.lon_deg[0]))
    # From high up, tracing uses coarser cells.
    cells = np.minimum(pixels * (plan.resolution.requested_m_per_px / cell_m) ** 2, MOST_CELLS)
    seconds = float(np.sum(pixels * costs.trace_s_per_px + cells * costs.trace_s_per_cell))
    return seconds / 3.0 if uses_numba() else seconds


def _flight_figures(plan: Plan) -> dict[str, Any]:
    path, attitude = plan.path, plan.mission.attitude
    figures: dict[str, Any] = {"interval_s": interval_s(plan), "sun": area_sun(plan)}
    if attitude.tilt_deg == 0.0 and attitude.roll_deg == 0.0:
        figures["fov_deg"] = plan.mission.camera.fov_deg
    figures.update(speed_limits=speed_limits(plan), drone=plan.mission.route.drone, motion=motion_text(plan))
    if len(plan) > 1:
        airborne = airborne_s(plan)
        figures.update(airborne_s=float(airborne.sum()), batteries=batteries(plan, airborne))
    if not path.is_captures:
        seconds = tuple(path.sorties_s.tolist())
        figures.update(path_m=path.distance_m, path_s=sum(seconds), sorties_s=seconds)
        figures["battery_min"] = plan.mission.route.battery_min
    return figures


def _polygon_count(plan: Plan) -> int:
    area = plan.mission.area
    return len(area.parts) if isinstance(area, Polygons) else int(isinstance(area, Polygon))


def _relief_figures(plan: Plan) -> dict[str, Any]:
    found = plan.relief.figures(plan.cameras, plan.poses, plan.flown, plan.corners)
    if found is None:
        return {"level_ground_m": plan.level_m} if plan.mission.terrain.elevation else {}
    filled, interpolated, count = found.filled
    finest, coarsest = (
        plan.mission.camera.ground_size_m(1.0)[0] / width
        for width in (plan.frames.width_px.max(), plan.frames.width_px.min())
    )
    return {
        "lowest_ground_m": found.lowest_m,
        "highest_ground_m": found.highest_m,
        "finest_gsd_m_per_px": found.nearest_m * float(finest),
        "coarsest_gsd_m_per_px": found.farthest_m * float(coarsest),
        "clearance_m": found.clearance_m,
        "hidden_share": found.hidden_share,
        "filled_heights": filled,
        "interpolated_heights": interpolated,
        "heights": count,
    }


def own_pixels_text(plan: Plan) -> str:
    """Describe the pixels of images from a source whose CRS is not the map's; otherwise return an empty text."""
    plane, native = plan.grid.plane, plan.grid.native_zoom
    if plane.wraps:
        return ""
    size = length_text(plan.grid.pixel_size(native)[0] * plane.unit_m)
    if plan.zoom == native:
        return Message("the source's own pixels, {0} in {1}", size, plane.name)
    if plan.zoom > native:
        return Message(
            "the source's own pixels, {0} in {1}, upsampled {2} times",
            size,
            plane.name,
            1 << (plan.zoom - native),
        )
    each = 1 << (native - plan.zoom)
    return Message("means of {2} x {2} of the source's own pixels, {0} in {1}", size, plane.name, each)


def imagery_warnings(plan: Plan) -> tuple[str, ...]:
    """Warn of images that lie partly or wholly outside the source's imagery."""
    _, outside, partly = plan.imagery
    if not outside and not partly:
        return ()
    text = Message(
        "of {0:,} images {1:,} lie outside the source's imagery, and {2:,} reach beyond it; "
        "choose an area that it has imagery of, or another source",
        len(plan),
        outside,
        partly,
    )
    return (text,)


def building_warnings(plan: Plan) -> tuple[str, ...]:
    """Warnings of what files of buildings lack."""
    # Level ground without buildings in any image has no heights.
    stand = plan.mission.terrain.buildings and not plan.relief.is_level
    return plan.relief.heights.faces.warnings if stand else ()


def lens_warnings(plan: Plan) -> tuple[str, ...]:
    """Warn of lenses that OpenDroneMap cannot tell apart: it knows cameras by focal length and image size alone."""
    if plan.mission.output.image_format != "jpg" or not (plan.cameras.vary and plan.cameras.distort):
        return ()
    return (Message("cameras.json for OpenDroneMap is empty where different lenses have one focal length"),)


def variation_warnings(plan: Plan) -> tuple[str, ...]:
    """Warn of values that vary, but change no image as the exposure is that of the imagery."""
    mission = plan.mission
    if mission.exposure.exposure != IDEAL:
        return ()
    unused = {"iso", "illuminance_lx", *(() if mission.shutter.motion_blur else ("exposure_ms",))}
    return tuple(
        Message(
            "vary {0!r}: changes no image while the exposure is {1}; choose another one{2}",
            str(one),
            IDEAL,
            OptionName("exposure").in_brackets,
        )
        for one in mission.varied.of_camera
        if one.field in unused
    )


def upsampling_warnings(plan: Plan) -> tuple[str, ...]:
    """Warn of images whose pixels are finer than the source's.

    Compares the median ground sample distance of the written images with the distance of the highest native zoom that
    the images read.
    """
    mission, grid = plan.mission, plan.grid
    written_m = plan.resolution.picture_m_per_px
    if mission.output.img_size is not None:
        width, height, _ = mission.output.img_size
        written_m *= float(min(np.median(plan.frames.width_px) / width, np.median(plan.frames.height_px) / height))
    # Camera frames read every zoom up to the zoom that suits them.
    zoom = min(grid.native_zoom, plan.frames.finest_zoom(plan))
    source_m = float(np.median(grid.ground_m_per_px(plan.lat_deg, plan.lon_deg, zoom)))
    factor = source_m / written_m
    # Rounding of sizes to whole pixels is not upsampling.
    if factor <= 1.0 + 0.02:
        return ()
    text = Message(
        "requested {0}, but the source has {1} here (zoom {2}): upsampled {3:.3g} times, images show no more "
        "detail; ask for {4}",
        length_text(written_m),
        length_text(source_m),
        zoom,
        factor,
        _upsampling_remedy(plan, zoom, factor),
    )
    return (text,)


def _upsampling_remedy(plan: Plan, zoom: int, factor: float) -> Message:
    """Remedy: the options that avoid upsampling."""
    mission = plan.mission
    if mission.output.img_size is not None and plan.zoom <= zoom:
        width, height = (max(int(size / factor), 1) for size in mission.output.img_size[:2])
        return Message("{0} {1} {2} {3} or less", OptionName("img_size"), width, height, mission.output.img_size[2])
    if not plan.frames.on_map and mission.pixels.zoom is None and mission.pixels.gsd_m_per_px is None:
        return Message(
            "{0} {1} or less, or fly higher",
            OptionName("image_px"),
            max(int(max(plan.frames.largest_px) / factor), 1),
        )
    return Message("{0} {1} or a finer source", OptionName("zoom"), zoom)


def percent(share: float, exact: bool) -> Message:
    """Share in percent: 100 if ``exact``, else rounded to four decimals."""
    return Message("{0:.7g} %", 100 if exact else round(100 * share, 4))


def length_text(value_m: float) -> Message:
    """Length in km, m, cm or mm."""
    for unit, size in (("km", 1e3), ("m", 1.0), ("cm", 1e-2)):
        if value_m >= size:
            value = value_m / size
            return Message("{0:,.0f} {1}" if value >= 1e3 else "{0:.4g} {1}", value, unit)
    return Message("{0:.3g} {1}", value_m * 1000.0, "mm")


def area_text(value_m2: float) -> Message:
    """Area in km², or in m² below 0.1 km²."""
    value, unit = (value_m2 / 1e6, "km²") if value_m2 >= 1e5 else (value_m2, "m²")
    # Four digits, without an exponent.
    return Message("{0:,.0f} {1}" if value >= 1e4 else "{0:,.4g} {1}", value, unit)


def size_text(count: float) -> Message:
    """Size of files in GB, MB, kB or bytes."""
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= size:
            return Message("{0:.3g} {1}", count / size, unit)
    return Message("{0:.0f} bytes", count)


def duration_text(seconds: float) -> Message:
    """Duration in seconds, minutes or hours."""
    if seconds < 90:
        return Message("{0} {1}", math.ceil(seconds - 0.5), "s")
    if seconds < 5400:
        return Message("{0:.0f} {1}", seconds / 60, "min")
    return Message("{0:.1f} {1}", seconds / 3600, "h")
