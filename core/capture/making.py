"""Pictures of a plan and a source, one after the other: what a whole run and a block of one have in common."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..arrays import Numbers
from ..bands import RGB, bands_of
from ..errors import InvalidInput, PartError
from ..imagery.opening import NamedSource
from ..imagery.placeholder import Provided, Received, corner
from ..imagery.source import Part, Source, Window
from ..limits import MAX_PICTURE_BYTES, MAX_PICTURES_AT_ONCE_PX
from ..mission.plan import Plan
from ..picture.camera_frame import parts_of_tiles
from ..picture.map_frame import check_size
from ..picture.optics import Exposures
from ..picture.shot import parts_of, tiles_of
from ..storage.files import write_whole
from .journal import FAILED, Outcome
from .pipeline import Pipeline, sweep
from .progress import Repeat
from .records import Made, PictureJob, job_of, make_picture
from .writers import Write

#: Connections where nothing else is said: what browsers open to a server is 6, tile servers bear a few more.
DEFAULT_CONNECTIONS = 8
#: Pictures that are traced ahead of each other before it is asked whether to go on.
_TRACED_AT_ONCE = 64


def check_source(plan: Plan, source: Source | NamedSource) -> None:
    """Raise InvalidInput where a source has not what a plan needs: its grid, map types, bands that can be written."""
    if source.grid != plan.grid:
        raise InvalidInput(
            "plan is for another pixel grid than that of {0}: plan with the source's own", source.title
        )
    for map_type in plan.mission.imagery.map_types:
        if source.map_types and map_type not in source.map_types:
            raise InvalidInput(
                "map type {0!r}: {1} has {2}", map_type, source.title, ", ".join(source.map_types)
            )
    bands, output = bands_of(source), plan.mission.output
    if output.image_format != "tif" and not bands.are_colours:
        raise InvalidInput(
            "image format {0}: has grey, or red, green and blue of 8 bits, and {1} gives {2}",
            output.image_format,
            source.title,
            bands,
            field="image_format",
        )
    check_size(output.img_size, bands)
    if _largest_px(plan) * bands.bytes_per_px > MAX_PICTURE_BYTES:
        raise InvalidInput(
            "images of {0:,} px with {1} bands of {2}: more than {3:,} bytes each",
            _largest_px(plan),
            len(bands),
            bands.data_type,
            MAX_PICTURE_BYTES,
            field="bands",
        )


def _largest_px(plan: Plan) -> int:
    """Pixels of the largest picture, as it is planned or as it is resized to."""
    width, height, _ = plan.mission.output.img_size or (1, 1, 1)
    return max(int((plan.frames.width_px * plan.frames.height_px).max()), width * height)


def chosen_of(plan: Plan, only: Iterable[int] | None) -> Numbers:
    """Indices of the captures to make, each once; raises InvalidInput for one that there is not."""
    if only is None:
        return np.arange(len(plan), dtype=np.int64)
    chosen = np.unique(np.array(list(only), np.int64))
    outside = chosen[(chosen < 0) | (chosen >= len(plan))]
    if len(outside):
        raise InvalidInput("capture {0} of the plan: it has 0 to {1}", outside[0], len(plan) - 1)
    return chosen


class Making:
    """The making of pictures, of one map type after the other.

    Parameters
    ----------
    plan : Plan
    source : Source
    folder : Path
        In which each map type and product has one of its own.
    connections, workers : int
        Parts fetched at once, and pictures made at once.
    finished : callable
        Called in the calling thread with each job and what is known of its picture, or why there is none.
    exposures : Exposures or None
        What the pictures' tags say of the camera.
    write : callable
        What takes files.

    Attributes
    ----------
    requests, unique_parts : int
        Parts asked of the source, and different ones that were needed, so far.
    """

    def __init__(
        self,
        plan: Plan,
        source: Source,
        folder: Path,
        connections: int,
        workers: int,
        finished: Callable[[PictureJob, Made | PartError], None],
        *,
        exposures: Exposures | None,
        write: Write = write_whole,
    ) -> None:
        self._plan, self._source, self._folder = plan, source, folder
        self._connections, self._workers = connections, workers
        self._finished, self._exposures, self._write = finished, exposures, write
        self.requests = self.unique_parts = 0
        #: Zooms, columns and rows of the tiles that captures over relief see, which take long to tell.
        self._tiles: dict[int, NDArray[np.int32]] = {}

    def make(
        self,
        map_type: str,
        indices: Numbers,
        go_on: Callable[[], bool],
        held: Callable[[], bool],
        received: Received,
    ) -> bool:
        """Make pictures of a map type, by their indices (k,); False where ``go_on`` stopped it.

        Parameters
        ----------
        received : callable
            Told of each file that a provider sends.
        """
        order = sweep(self._plan.windows, indices).tolist()
        users = self._users(order, go_on)
        if users is None:
            return False
        self.unique_parts += len(users)
        pipeline: Pipeline[PictureJob, Made] = Pipeline(
            users,
            lambda window: self._source.fetch(map_type, window),
            make_picture,
            self._finished,
            connections=self._connections,
            workers=self._workers,
            at_once=max(MAX_PICTURES_AT_ONCE_PX * RGB.bytes_per_px // self._largest_bytes(), 1),
        )
        earlier = self.requests

        def counted() -> bool:
            self.requests = earlier + pipeline.requests
            return go_on()

        try:
            with _received_by(received, self._source):
                return pipeline.run(self._jobs(map_type, order), counted, held)
        finally:
            self.requests = earlier + pipeline.requests

    def parts(self, index: int) -> list[Part]:
        """Parts that the picture of a capture is made of."""
        if self._plan.relief.is_level:
            return parts_of(self._plan, self._source, index)
        if index not in self._tiles:
            self._tiles[index] = np.array(tiles_of(self._plan, index), np.int32).reshape(-1, 3)
        return parts_of_tiles(self._plan.grid, self._tiles[index].tolist())

    def shown(
        self, found: Mapping[str, frozenset[Window]], outcomes: Mapping[str, Outcome]
    ) -> dict[str, tuple[str, ...]]:
        """Pictures that are there and show files that `Repeats.found`: by name, the digests of these."""
        digests = {place: digest for digest, places in found.items() for place in places}
        by_name: dict[str, tuple[str, ...]] = {}
        for index, name in enumerate(self._plan.names if found else ()):
            outcome = outcomes.get(name)
            if outcome is None or outcome.status == FAILED:
                continue
            corners = (corner(*part.window[:3]) for part in self.parts(index))
            shown = tuple(sorted({digests[place] for place in corners if place in digests}))
            if shown:
                by_name[name] = shown
        return by_name

    def _jobs(self, map_type: str, order: list[int]) -> Iterator[tuple[PictureJob, list[Part]]]:
        # Products are those of all map types, and made with the first one's pictures.
        is_first = map_type == self._plan.mission.imagery.map_types[0]
        products_in = self._folder if is_first and self._plan.mission.output.products else None
        for index in order:
            job = job_of(
                self._plan,
                index,
                self._source,
                map_type,
                self._folder / map_type,
                exposures=self._exposures,
                products_in=products_in,
                write=self._write,
            )
            yield job, self.parts(index)

    def _users(self, order: list[int], go_on: Callable[[], bool]) -> Counter[Window] | None:
        """How many of the pictures to be made need each part; None where stopped meanwhile."""
        users: Counter[Window] = Counter()
        with ThreadPoolExecutor(self._workers, "terrainav-trace") as threads:
            # Over relief every picture is traced to tell, so all processors do.
            ahead = threads.map if not self._plan.relief.is_level else map
            for start in range(0, len(order), _TRACED_AT_ONCE):
                for parts in ahead(self.parts, order[start : start + _TRACED_AT_ONCE]):
                    users.update({part.window for part in parts})
                    if not go_on():
                        return None
        return users

    def _largest_bytes(self) -> int:
        return _largest_px(self._plan) * max(bands_of(self._source).bytes_per_px, RGB.bytes_per_px)


def repeats_of(
    map_type: str, found: Mapping[str, frozenset[Window]], shown: Mapping[str, tuple[str, ...]]
) -> list[Repeat]:
    """What `Repeats.found`, with the pictures that show it, as `Making.shown` gives them."""
    return [
        Repeat(map_type, digest, len(places), tuple(name for name, one in shown.items() if digest in one))
        for digest, places in found.items()
    ]


@contextmanager
def _received_by(note: Received, source: Source) -> Iterator[None]:
    """Have a source tell which files a provider sends it, if one does."""
    if not isinstance(source, Provided):
        yield
        return
    source.received = note
    try:
        yield
    finally:
        source.received = None
