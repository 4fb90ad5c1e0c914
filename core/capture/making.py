"""Make the images of a plan from a source with threads of this process."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple, Protocol, cast

import numpy as np

from ..arrays import NDArray, Numbers
from ..bands import RGB, source_bands
from ..errors import InvalidInput, PartError
from ..imagery.opening import NamedSource, check_sun
from ..imagery.placeholder import Provided, Repeats, corner
from ..imagery.source import Part, Source, Window
from ..labels.label_map import LabelMap
from ..limits import MAX_PICTURE_BYTES, MAX_PICTURES_AT_ONCE_PX
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..mission.sunlight import mission_sun
from ..mission.takes import shown_box
from ..picture.camera_frame import parts_of_tiles
from ..picture.effects import check_bands
from ..picture.map_frame import check_size
from ..picture.optics import Exposures
from ..picture.shot import Shot, lens_plans, picture_parts, shown_tiles
from ..storage.files import write_whole
from .journal import FAILED, Outcome
from .pipeline import Parts, Pipeline, sweep
from .records import PictureJob, image_job, make_picture
from .uses import LastUsers
from .writers import Write

#: Browsers open 6 connections to a server, and tile servers accept a few more.
DEFAULT_CONNECTIONS = 8
#: Bytes of traced images under way, and of each of their pixels: where it lies on the source, and its products' ground.
_TRACED_BYTES, _TRACED_BYTES_PER_PX = 256 << 20, 96


def check_source(plan: Plan, source: Source | NamedSource) -> None:
    """Raise InvalidInput for a source without the plan's grid or map types, or with bands that cannot be written."""
    if source.grid != plan.grid:
        raise InvalidInput("plan is for another pixel grid than that of {0}: plan with the source's own", source.title)
    for map_type in plan.mission.imagery.map_types:
        if source.map_types and map_type not in source.map_types:
            raise InvalidInput("map type {0!r}: {1} has {2}", map_type, source.title, ", ".join(source.map_types))
    bands, output = source_bands(source), plan.mission.output
    if output.image_format != "tif" and not bands.are_colours:
        raise InvalidInput(
            "image format {0}: has grey, or red, green and blue of 8 bits, and {1} gives {2}",
            output.image_format,
            source.title,
            bands,
            field="image_format",
        )
    check_size(output.img_size, bands)
    for mission in plan.mission.with_extremes:
        check_bands(mission, bands)
    _check_sun(plan.mission, source)
    if _largest_px(plan) * bands.bytes_per_px > MAX_PICTURE_BYTES:
        raise InvalidInput(
            "images of {0:,} px with {1} bands of {2}: more than {3:,} bytes each",
            _largest_px(plan),
            len(bands),
            bands.data_type,
            MAX_PICTURE_BYTES,
            field="bands",
        )


def _check_sun(mission: Mission, source: Source | NamedSource) -> None:
    """Refuse a source that is not in the light of the mission's sun."""
    sun, lit = mission_sun(mission), getattr(source, "sun", None)
    if sun != lit:
        if not hasattr(source, "sun"):
            check_sun(source.title, sun)
        raise InvalidInput(
            "sun {0}: {1} was opened in another light than the mission's",
            mission.sunlight.sun,
            source.title,
            field="sun",
        )


def _largest_px(plan: Plan) -> int:
    """Number of pixels of the largest image, planned or resized."""
    width, height, _ = plan.mission.output.img_size or (1, 1, 1)
    return max(int((plan.frames.width_px * plan.frames.height_px).max()), width * height)


class Piece(NamedTuple):
    """Images to make: indices (k,) of captures of one map type, and the number of their block."""

    map_type: str
    indices: Numbers
    number: int = 0


class Orders(Protocol):
    """Interface of a run to its maker: stop, pause and outcomes."""

    def wants_more(self) -> bool:
        """Whether to make more images."""

    def is_paused(self) -> bool:
        """Whether to wait before more images are made."""

    def note(self, outcome: Outcome) -> None:
        """Take the outcome of an image, in the thread that called `make`."""

    def repeats(self, map_type: str) -> Repeats:
        """Files that a provider has sent for a map type."""


class Maker(Protocol):
    """Maker of the images of a run.

    Attributes
    ----------
    requests, unique_parts : int
        Numbers of parts requested from the source so far, and of distinct parts needed.
    parts : ImageParts
    """

    parts: ImageParts
    requests: int
    unique_parts: int

    @property
    def under_way(self) -> int:
        """Number of images made that the run has not noted yet."""

    @property
    def map_type(self) -> str:
        """Map type being made."""

    def rounds(self, map_types: tuple[str, ...]) -> Iterable[tuple[str, ...]]:
        """Map types that are made together, round by round."""

    def prepare(self) -> None:
        """Write files that makers need, once, before the first image."""

    def make(self, pieces: Sequence[Piece], orders: Orders) -> bool:
        """Make images; returns False if the run stopped it."""


class ImageParts:
    """Parts of a source that the images of a plan show; if they are traced, those of images made are remembered.

    Parameters
    ----------
    plan : Plan
    source : Source
    """

    def __init__(self, plan: Plan, source: Source) -> None:
        self.plan, self.source = plan, source
        # Zoom, column and row (n, 3) of the tiles that each traced image shows.
        self._tiles: dict[int, NDArray[np.int32]] = {}

    @property
    def are_traced(self) -> bool:
        """Whether the parts of an image are found with its rays: over relief, or while the camera moves."""
        return not self.plan.relief.is_level or self.plan.mission.takes_time

    def find(self, index: int) -> list[Part]:
        """Return the parts of an image."""
        if not self.are_traced:
            return picture_parts(self.plan, self.source, index)
        if index not in self._tiles:
            return self.keep(index, shown_tiles(self.plan, index))
        return parts_of_tiles(self.plan.grid, self._tiles[index].tolist())

    def keep(self, index: int, tiles: list[tuple[int, int, int]]) -> list[Part]:
        """Remember the tiles of an image whose rays are traced, and return its parts."""
        self._tiles[index] = np.array(tiles, np.int32).reshape(-1, 3)
        return parts_of_tiles(self.plan.grid, tiles)

    def find_images(
        self, repeated: Mapping[str, frozenset[Window]], outcomes: Mapping[str, Outcome]
    ) -> dict[str, tuple[str, ...]]:
        """Find the images made that show repeated files.

        Parameters
        ----------
        repeated : mapping of str to frozenset of Window
            Places by digest, from `Repeats.found`.
        outcomes : mapping of str to Outcome
            Outcomes by image name.

        Returns
        -------
        dict of str to tuple of str
            Digests of the repeated files, by image name.
        """
        digests = {place: digest for digest, places in repeated.items() for place in places}
        by_name: dict[str, tuple[str, ...]] = {}
        for index, name in enumerate(self.plan.names if repeated else ()):
            outcome = outcomes.get(name)
            if outcome is None or outcome.status == FAILED:
                continue
            corners = (corner(*part.window[:3]) for part in self.find(index))
            shown = tuple(sorted({digests[place] for place in corners if place in digests}))
            if shown:
                by_name[name] = shown
        return by_name


@dataclass
class ImageMaker:
    """Maker with threads of this process, one map type after the other.

    Parameters
    ----------
    parts : ImageParts
    folder : Path
        Folder with one folder for each map type and product.
    connections, workers : int
        Parts fetched at once, and images made at once.
    exposures : Exposures or None
        Exposures to write into the images' tags.
    write : callable
        Writes a file.
    labels : LabelMap or None
        Labels for the products classes and instances.
    """

    parts: ImageParts
    folder: Path
    connections: int
    workers: int
    exposures: Exposures | None = None
    write: Write = write_whole
    labels: LabelMap | None = None
    map_type: str = ""
    requests: int = 0
    unique_parts: int = 0
    under_way: int = 0

    def rounds(self, map_types: tuple[str, ...]) -> Iterable[tuple[str, ...]]:
        """One map type at a time."""
        return [(map_type,) for map_type in map_types]

    def prepare(self) -> None:
        """Do nothing: threads need no files."""

    def make(self, pieces: Sequence[Piece], orders: Orders) -> bool:
        """Make images; returns False if the run stopped it."""
        return all(self._make_piece(piece, orders) for piece in pieces)

    def _make_piece(self, piece: Piece, orders: Orders) -> bool:
        self.map_type = piece.map_type
        source = self.parts.source
        order = sweep(self.parts.plan.windows, piece.indices).tolist()
        last_user = self._find_last_users(order, orders)
        if last_user is None:
            return False

        def finished(job: PictureJob, result: Outcome | PartError) -> None:
            orders.note(job.failed(result) if isinstance(result, PartError) else result)

        pipeline: Pipeline[PictureJob, Outcome] = Pipeline(
            last_user,
            lambda window: source.fetch(piece.map_type, window),
            make_picture,
            finished,
            connections=self.connections,
            workers=self.workers,
            at_once=self._at_once(),
        )
        earlier = self.requests, self.unique_parts

        def wants_more() -> bool:
            self.requests = earlier[0] + pipeline.requests
            return orders.wants_more()

        try:
            with _noting(orders.repeats(piece.map_type), source):
                return pipeline.run(self._jobs(piece.map_type, order), wants_more, orders.is_paused)
        finally:
            self.requests, self.unique_parts = earlier[0] + pipeline.requests, earlier[1] + pipeline.unique_parts

    def _at_once(self) -> int:
        """Most images under way: few if they are large, or if their rays are traced."""
        pixels, band_bytes = _largest_px(self.parts.plan), source_bands(self.parts.source).bytes_per_px
        # The limit of pixels under way is for images of three bytes a pixel.
        most = MAX_PICTURES_AT_ONCE_PX * RGB.bytes_per_px // (pixels * max(band_bytes, RGB.bytes_per_px))
        if self.parts.are_traced:
            traced_bytes = pixels * _TRACED_BYTES_PER_PX * len(lens_plans(self.parts.plan))
            most = min(most, max(_TRACED_BYTES // traced_bytes, 2 * self.workers))
        return max(most, 1)

    def _jobs(self, map_type: str, order: list[int]) -> Iterator[tuple[PictureJob, Parts]]:
        plan = self.parts.plan
        # Products are the same for all map types and made with the first.
        is_first = map_type == plan.mission.imagery.map_types[0]
        products_in = self.folder if is_first and plan.mission.products else None
        for index in order:
            job = image_job(
                plan,
                index,
                self.parts.source,
                map_type,
                self.folder / map_type,
                exposures=self.exposures,
                products_in=products_in,
                write=self.write,
                labels=self.labels,
            )
            yield job, partial(self._trace, job) if self.parts.are_traced else self.parts.find(index)

    def _trace(self, job: PictureJob) -> list[Part]:
        """Trace the rays of an image and its twins, once, and find their parts."""
        needs_range = job.development is not None and job.development.needs_range
        tiles: set[tuple[int, int, int]] = set()
        for of_shot in {id(one.shot): one for one in (*job.twins, job)}.values():
            shot = cast(Shot, of_shot.shot)
            tiles.update(shot.trace(with_sighting=of_shot.products is not None or needs_range))
        return self.parts.keep(job.index, sorted(tiles))

    def _find_last_users(self, order: list[int], orders: Orders) -> Callable[[Window], int] | None:
        """Find the last image of an order that may need a part; None if the run was stopped."""
        plan, boxes = self.parts.plan, np.empty((len(order), 4))
        found: dict[Window, int] = {}
        for number, index in enumerate(order):
            if self.parts.are_traced:
                ends = np.array([shown_box(one, index) for one in lens_plans(plan)])
                boxes[number] = *ends[:, :2].min(axis=0), *ends[:, 2:].max(axis=0)
            else:
                found.update((part.window, number) for part in self.parts.find(index))
            if not orders.wants_more():
                return None
        return LastUsers(plan.grid, boxes).last_user if self.parts.are_traced else found.__getitem__


@contextmanager
def _noting(repeats: Repeats, source: Source) -> Iterator[None]:
    """Note the files that a provider sends, if the source has a provider."""
    if not isinstance(source, Provided):
        yield
        return
    source.received = repeats.note
    try:
        yield
    finally:
        source.received = None
