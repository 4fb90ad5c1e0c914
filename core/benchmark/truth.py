"""Ground truth: poses of queries, positions of tiles, and pairs of a query and a tile that show the same ground."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, Numbers
from ..dataset.dataset import ImageSet, read_dataset
from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import wrap_lon_deg
from ..mission.areas.area import ground_m2
from ..mission.plan import Plan
from .folder import POSITIVE, QUERIES_FOLDER, SEMI_POSITIVE, Positives, Queries, ReferenceMosaic, References
from .planning import BenchmarkPlan, tiles_folder


class Captured(NamedTuple):
    """Images that exist: their `ImageSet`, their rows in its table, and their indices in the plan."""

    images: ImageSet
    rows: Numbers
    at: Numbers

    @property
    def stems(self) -> list[str]:
        """Names of the images without extension."""
        return [Path(self.images.table.img_names[row]).stem for row in self.rows.tolist()]

    def files(self, root: Path) -> list[str]:
        """Paths of the images relative to a folder."""
        return [self.images.path(row).relative_to(root).as_posix() for row in self.rows.tolist()]


def captured(folder: Path, plan: Plan) -> Captured:
    """Find the images of a plan in the folder of its capture."""
    (images,) = read_dataset(folder).image_sets.values()
    at = {name: index for index, name in enumerate(plan.names)}
    rows = np.flatnonzero(images.made)
    index = [at[Path(images.table.img_names[row]).stem] for row in rows.tolist()]
    return Captured(images, rows, np.array(index, np.int64))


def locate_mosaic(root: Path, plan: Plan, found: Captured) -> ReferenceMosaic:
    """Georeference the mosaic."""
    west, _, _, north = (float(edge[0]) for edge in plan.edges)
    across, down = plan.grid.pixel_size(plan.zoom)
    return ReferenceMosaic(
        found.files(root)[0],
        plan.grid.plane.crs,
        west,
        north,
        across,
        down,
        int(plan.frames.width_px[0]),
        int(plan.frames.height_px[0]),
    )


def make_queries(root: Path, planned: BenchmarkPlan, parts: list[str]) -> Queries:
    """Queries whose images exist; ``parts`` has the part of each capture (equal for all imageries), or is empty."""
    found = []
    for name, plan in planned.queries.items():
        images = captured(root / QUERIES_FOLDER / name, plan)
        index = images.at
        poses = plan.poses.take(index)
        centre_lat, centre_lon = _centres(plan, index)
        width, height = (
            images.images.table.image_width_px[images.rows],
            images.images.table.image_height_px[images.rows],
        )
        tan_x, tan_y = plan.mission.camera.half_tangents
        found.append(
            Queries(
                id=tuple(f"{name}/{stem}" for stem in images.stems),
                file=tuple(images.files(root)),
                imagery=(name,) * len(index),
                part=tuple(parts[at] if parts else "" for at in index.tolist()),
                centre_lat_deg=centre_lat,
                centre_lon_deg=centre_lon,
                lat_deg=poses.lat_deg,
                lon_deg=wrap_lon_deg(poses.lon_deg),
                height_m=plan.height_m[index],
                ground_m=plan.ground_m[index],
                yaw_deg=poses.yaw_deg,
                tilt_deg=poses.tilt_deg,
                roll_deg=poses.roll_deg,
                fx_px=width / 2.0 / tan_x,
                fy_px=height / 2.0 / tan_y,
                cx_px=width / 2.0,
                cy_px=height / 2.0,
                width_px=width,
                height_px=height,
            )
        )
    return Queries.joined(found)


def _centres(plan: Plan, index: Numbers) -> tuple[Floats, Floats]:
    """Latitude and wrapped longitude of the ground at image centres."""
    middle, poses = ((0.0, 0.0),), plan.poses.take(index)
    poses = poses._replace(lon_deg=wrap_lon_deg(poses.lon_deg))
    seen, _ = plan.relief.seen(plan.mission.camera, poses, plan.height_m[index], middle)
    return seen.lat_deg[:, 0], wrap_lon_deg(seen.lon_deg[:, 0])


def make_references(root: Path, planned: BenchmarkPlan, parts: dict[str, list[str]]) -> References:
    """Tiles whose images exist; ``parts`` has the part of each capture by folder, or is empty."""
    found = []
    for width_m, plan in planned.tiles.items():
        folder = tiles_folder(width_m)
        images = captured(root / folder, plan)
        index = images.at
        lat, lon = (angle[index] for angle in plan.frame_centres)
        west, south, east, north = (edge[index] for edge in plan.edges)
        found.append(
            References(
                id=tuple(f"{Path(folder).name}/{stem}" for stem in images.stems),
                file=tuple(images.files(root)),
                part=tuple(parts[folder][at] if parts else "" for at in index.tolist()),
                width_m=np.full(len(index), width_m),
                lat_deg=lat,
                lon_deg=lon,
                west=west,
                south=south,
                east=east,
                north=north,
            )
        )
    return References.joined(found)


class _Ring(NamedTuple):
    """Outline of a query in the reference's plane."""

    x: Floats
    y: Floats

    def arrays(self) -> list[tuple[Floats, Floats]]:
        return [(self.x, self.y)]


def find_positives(
    planned: BenchmarkPlan, mosaic: ReferenceMosaic, queries: Queries, references: References
) -> Positives:
    """Pairs of queries and tiles that are positive or semi-positive.

    Outlines of queries are traced by the exact camera, onto the relief if there is one. Areas are measured on the
    ellipsoid.
    """
    settings = planned.settings
    edges = references.west, references.south, references.east, references.north
    areas = _rectangles_m2(mosaic, *edges)
    rows: list[tuple[str, str, str, float]] = []
    for index, (lat, lon) in enumerate(_outlines(planned, queries)):
        x, y = mosaic.xy(lat, lon)
        near = np.flatnonzero((edges[0] < x.max()) & (edges[2] > x.min()) & (edges[1] < y.max()) & (edges[3] > y.min()))
        if not len(near):
            continue
        west, south, east, north = (edge[near] for edge in edges)
        geodetic = partial(_continuous, mosaic, float(lon[0]))
        both = ground_m2(_Ring(x, y), west, south, east, north, geodetic)
        either = areas[near] + WGS84.ring_area_m2(lon, lat) - both
        iou = both / either
        for at in np.flatnonzero(iou >= settings.semi_positive_iou).tolist():
            kind = POSITIVE if iou[at] >= settings.positive_iou else SEMI_POSITIVE
            rows.append((queries.id[index], references.id[near[at]], kind, float(iou[at])))
    query, reference, kinds, values = (list(column) for column in zip(*rows)) if rows else ([], [], [], [])
    return Positives(tuple(query), tuple(reference), tuple(kinds), np.array(values, np.float64))


def _outlines(planned: BenchmarkPlan, queries: Queries) -> Iterator[tuple[Floats, Floats]]:
    """Yield latitudes and longitudes of the outline of each query."""
    at = {
        (name, stem): (plan, index) for name, plan in planned.queries.items() for index, stem in enumerate(plan.names)
    }
    for one in queries.id:
        name, _, stem = one.partition("/")
        plan, index = at[name, stem]
        outline = plan.views.outline(index)
        yield outline.lat_deg, plan.lon_deg[index] + outline.dlon_deg


def _rectangles_m2(mosaic: ReferenceMosaic, west: Floats, south: Floats, east: Floats, north: Floats) -> Floats:
    """Areas (r,) on the ellipsoid of rectangles in the reference's plane."""
    x, y = np.stack([west, east, east, west], axis=1), np.stack([south, south, north, north], axis=1)
    lat, lon = mosaic.lat_lon(x, y)
    lon = lon - 360.0 * np.rint((lon - lon[:, :1]) / 360.0)
    ring = np.repeat(np.arange(len(west)), 4)
    return WGS84.ring_areas_m2(lon.ravel(), lat.ravel(), ring, len(west))


def _continuous(mosaic: ReferenceMosaic, about_deg: float, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Latitudes and longitudes of points in the reference's plane, continuous about a meridian."""
    lat, lon = mosaic.lat_lon(x, y)
    return lat, lon - 360.0 * np.rint((lon - about_deg) / 360.0)
