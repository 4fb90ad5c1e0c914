"""Silhouettes of the reference's buildings, rendered at any pose, and the masks of queries to compare them with."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Flags
from ..dataset.label_images import read_label_image
from ..errors import InvalidInput
from ..faces.opening import split_building_path
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.camera import Poses
from ..geodesy.ellipsoid import WGS84
from ..geodesy.local import geocentric
from ..geodesy.raytracing.tracing import Tracing, settled
from ..geodesy.triangles import RELIEF
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..mission.relief.ground import Heights
from ..picture.heights import mission_heights
from ..storage.files import make_folder, open_foreign, write_whole
from .folder import BUILDINGS, REFERENCE_FOLDER, Benchmark

#: Distance from the true camera beyond which nothing is rendered, in heights above the ground: such answers count 0,
#: and cost no time and no tiles of heights.
_MOST_HEIGHTS = 10.0
#: Blocks in which files are copied.
_BLOCK = 1 << 20
#: Share of the tolerance for the rounding of poses, as for the queries.
_SETTLING = 2.0**-7


class Traced(NamedTuple):
    """How the rays of an imagery's queries were traced, so that silhouettes are those of the queries to the pixel.

    Attributes
    ----------
    tolerance_px : float
        Largest error of hits along their rays.
    lowest_m : float
        Lower bound of the ground.
    """

    tolerance_px: float
    lowest_m: float


def copy_buildings(texts: Sequence[str], root: Path) -> list[str]:
    """Copy files of buildings into a benchmark's folder of the reference.

    Parameters
    ----------
    texts : sequence of str
        As in a mission's ``buildings``.

    Returns
    -------
    list of str
        The same buildings, with paths relative to ``root``.

    Raises
    ------
    InvalidInput
        A file does not exist, or two have one name.
    OutputError
        The folder cannot be written.
    """
    copies: list[str] = []
    folder = root / REFERENCE_FOLDER / BUILDINGS
    for text in texts:
        path, rest = split_building_path(text)
        copy = f"{REFERENCE_FOLDER}/{BUILDINGS}/{Path(path).name}{rest}"
        if copy in copies:
            raise InvalidInput(
                "reference buildings {0}: another file has this name, too",
                text,
                remedy="rename one of them",
                field="reference_buildings",
            )
        if not Path(path).is_file():
            raise InvalidInput(
                "reference buildings {0}: must be a file on this computer", text, field="reference_buildings"
            )
        copies.append(copy)
        make_folder(folder)
        for file in _files_of(Path(path)):
            write_whole(folder / file.name, _blocks(file))
    return copies


def _files_of(path: Path) -> list[Path]:
    """Files that belong together: a Shapefile consists of several."""
    if path.suffix.lower() != ".shp":
        return [path]
    return sorted(one for one in path.parent.iterdir() if one.stem == path.stem and one.is_file())


def _blocks(path: Path) -> Iterator[bytes]:
    with open_foreign(path) as file:
        while block := file.read(_BLOCK):
            yield block


def describe_buildings(root: Path, queries: Mission, files: Sequence[str], plans: Mapping[str, Plan]) -> dict[str, Any]:
    """Content of ``benchmark.json`` about buildings: files, credit, and how each imagery's queries were traced."""
    faces = _open_heights(root, queries.to_dict(), tuple(files)).faces
    traced = {
        name: Traced(plan.views.tolerance_px, float(plan.relief.lowest_m))._asdict() for name, plan in plans.items()
    }
    return {"files": list(files), "attribution": faces.attribution, "traced": traced}


def _open_heights(root: Path, queries: Mapping[str, Any], files: tuple[str, ...]) -> Heights:
    """Relief of the queries' mission, with the reference's buildings on it."""
    mission = Mission.from_dict(dict(queries)).replace(buildings=tuple(str(root / file) for file in files))
    heights = mission_heights(mission)
    if heights is None:
        raise InvalidInput("benchmark {0}: has buildings, but no elevation that they stand on", root)
    return heights


@dataclass(frozen=True, eq=False)
class Silhouettes:
    """Silhouettes of a benchmark's buildings. A mask (h, w) is true where a pixel shows a building."""

    benchmark: Benchmark
    mission: Mission
    heights: Heights
    traced: Mapping[str, Traced]

    @classmethod
    def from_benchmark(cls, benchmark: Benchmark) -> Silhouettes:
        """Open the buildings of a benchmark, and the elevation that they stand on.

        Raises
        ------
        InvalidInput, SourceError
            The benchmark has no buildings, or they or the elevation cannot be opened.
        """
        if not benchmark.has_buildings:
            raise InvalidInput(
                "benchmark {0}: has no buildings",
                benchmark.folder,
                remedy="make one with buildings (terrainav benchmark make --reference-buildings)",
            )
        asked, about = benchmark.about.get("queries"), benchmark.about[BUILDINGS]
        try:
            files = tuple(map(str, about["files"]))
            traced = {
                name: Traced(float(one["tolerance_px"]), float(one["lowest_m"]))
                for name, one in about["traced"].items()
            }
            if not all(np.isfinite(one).all() and one.tolerance_px >= 0.0 for one in traced.values()):
                raise ValueError(about["traced"])
            if {*benchmark.queries.imagery} - {*traced} or not isinstance(asked, dict):
                raise KeyError("traced")
        except (KeyError, TypeError, ValueError, AttributeError) as wrong:
            raise InvalidInput("benchmark {0}: does not say how to render its buildings", benchmark.folder) from wrong
        if any(Path(one).is_absolute() or ".." in Path(one).parts for one in files):
            raise InvalidInput("benchmark {0}: names buildings outside of it", benchmark.folder)
        heights = _open_heights(benchmark.folder, asked, files)
        return cls(benchmark, Mission.from_dict(asked), heights, traced)

    def mask(self, index: int) -> Flags:
        """Read the true mask of a query; raises InvalidInput if it cannot be read."""
        queries = self.benchmark.queries
        size = float(queries.width_px[index]), float(queries.height_px[index])
        found: Flags = read_label_image(self.benchmark.instance_file(index), size) > 0
        return found

    def render(self, index: int, pose: Sequence[float], size_px: tuple[int, int] | None = None) -> Flags:
        """Render what the camera of a query sees from a pose; nothing if that is below the ground or far away.

        Parameters
        ----------
        pose : sequence of float
            As in `answers.POSE`.
        size_px : tuple (width, height)
            Another size than the query's.
        """
        queries = self.benchmark.queries
        size = size_px or (int(queries.width_px[index]), int(queries.height_px[index]))
        lat, lon, height_m, *attitude = (float(value) for value in pose)
        if not np.isfinite(pose).all() or not self._is_near(index, lat, lon, height_m):
            return np.zeros(size[::-1], bool)
        tolerance_px, lowest_m = self.traced[queries.imagery[index]]
        # The steps of the rounding are the query's: those of nearly the same height may differ by a factor of two.
        above_m = round(float(queries.height_m[index] - queries.ground_m[index]), 6)
        one = Poses(*(np.array([value]) for value in (lat, lon, above_m, *attitude)))
        scene = ImageGeometry(self.mission.camera, *size, one, WGS84.raised(lowest_m))
        tracing = Tracing(
            *settled(scene, height_m, tolerance_px * _SETTLING),
            self.heights.surface,
            lowest_m,
            tolerance_px * (1.0 - _SETTLING),
            self.heights.faces,
        )
        found: Flags = tracing.sighting.kind != RELIEF
        return found

    def _is_near(self, index: int, lat_deg: float, lon_deg: float, height_m: float) -> bool:
        """Whether a camera is above the ground and not far from a query's."""
        queries = self.benchmark.queries
        true_lat, true_lon, true_m = (float(at[index]) for at in (queries.lat_deg, queries.lon_deg, queries.height_m))
        place = np.array([lat_deg]), np.array([lon_deg])
        off_m = geocentric(lat_deg, lon_deg, height_m) - geocentric(true_lat, true_lon, true_m)
        if np.linalg.norm(off_m) > _MOST_HEIGHTS * (true_m - float(queries.ground_m[index])):
            return False
        surface = self.heights.ground.surface(*place)
        ground_m = float(surface.heights(*surface.position(*place))[0])
        # Where the height of the ground is unknown, the least one counts.
        lowest_m = self.traced[queries.imagery[index]].lowest_m
        return height_m > (lowest_m if math.isnan(ground_m) else ground_m)


def overlap(mask: Flags, other: Flags) -> float:
    """Intersection over union of two masks; NaN if both are empty."""
    either = int(np.count_nonzero(mask | other))
    return int(np.count_nonzero(mask & other)) / either if either else math.nan
