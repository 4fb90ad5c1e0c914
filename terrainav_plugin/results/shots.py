"""Captured images under a click, and their data. On any thread; no widgets."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from qgis.core import QgsGeometry, QgsPointXY, QgsVectorLayer

from ...core.dataset.folder import MISSION_FILE, REJECTED_FOLDER, TABLE_FILE
from ...core.dataset.stored import is_name
from ...core.errors import Cancelled, InvalidInput, TerrAInavError
from ...core.limits import MAX_TABLE_BYTES
from ...core.mission.mission import Mission
from ...core.mission.parts import LABELLED
from ...core.storage.files import file_exists, open_foreign, text_lines
from ...core.text.plain import one_line
from ..dataset.footprints import FootprintFile, file_stamp, polygon_rings
from ..dataset.overlay import LabelOverlay, read_labels
from ..dataset.picture import Depth, DisplayImage, read_depth, read_picture
from ..i18n import tr, translate
from ..map.mission_group import layer_dataset
from ..remote.images import DEPTH, Fetched, ImageFetcher


class FootprintLayer(NamedTuple):
    """A layer of captured footprints.

    Parameters
    ----------
    layer_id : str
        Id of the layer.
    folder : Path
        Folder of the dataset.
    """

    layer_id: str
    folder: Path

    @classmethod
    def read(cls, layer: QgsVectorLayer) -> FootprintLayer:
        """Values of a QGIS layer. Main thread only."""
        return cls(layer.id(), layer_dataset(layer))


class CapturedImage(NamedTuple):
    """One captured image.

    Parameters
    ----------
    footprints : FootprintLayer
        Layer with the footprint of the image.
    number, count : int
        Index of the image in the plan, from 0, and number of images of the plan.
    name : str
    pose : dict
        Attributes of the footprint.
    outline : QgsGeometry
        Outline of the footprint in EPSG:4326.
    """

    footprints: FootprintLayer
    number: int
    count: int
    name: str
    pose: dict[str, Any]
    outline: QgsGeometry


class ViewedImage(NamedTuple):
    """An image with the data to show.

    Parameters
    ----------
    shot : CapturedImage
    map_types : tuple of str
        Available map types.
    map_type : str
        Map type shown.
    picture : DisplayImage
    row : dict of str to str
        Row of the image in the dataset's table; empty until the table is written.
    rejected : bool
        Whether cleaning has moved the image.
    depth : Depth or None
        Depth of the image, if the mission wrote it.
    fetched : Fetched or None
        Contents of an image that is not a file in the dataset's folder.
    label_products : tuple of str
        Products of labels that the mission wrote: classes, instances.
    shown_labels : str
        The one that is shown; empty for none.
    labels : LabelOverlay or None
        Labels of the image, if asked for.
    """

    shot: CapturedImage
    map_types: tuple[str, ...]
    map_type: str
    picture: DisplayImage
    row: dict[str, str]
    rejected: bool
    depth: Depth | None = None
    fetched: Fetched | None = None
    label_products: tuple[str, ...] = ()
    shown_labels: str = ""
    labels: LabelOverlay | None = None


class Finder:
    """Find images; footprint files are read again only when they change. Use on one thread only.

    Parameters
    ----------
    cancelled : callable
        Returns whether to stop reading a long file because nobody waits for it any longer.
    """

    def __init__(self, cancelled: Callable[[], bool]) -> None:
        self._cancelled = cancelled
        self._files: dict[Path, FootprintFile] = {}

    def find_shots(self, footprints: Sequence[FootprintLayer], lat_deg: float, lon_deg: float) -> list[CapturedImage]:
        """Images whose footprints contain a place, layer by layer in the order of the plan."""
        point = QgsGeometry.fromPointXY(QgsPointXY(lon_deg, lat_deg))
        found = []
        for these in footprints:
            for number in self._file(these).covering(lat_deg, lon_deg):
                shot = self._shot(these, number)
                # Not `contains`, as a pole is on the edge of a footprint that contains it.
                if shot.outline.intersects(point):
                    found.append(shot)
                    # A click offers at most 200 images.
                    if len(found) >= 200:
                        return found
        return found

    def first(self, footprints: Sequence[FootprintLayer]) -> list[CapturedImage]:
        """First image of the first layer that has images; empty if no layer has images."""
        for layer in footprints:
            if len(self._file(layer)):
                return [self._shot(layer, 0)]
        return []

    def neighbour(self, shot: CapturedImage, step: int) -> CapturedImage | None:
        """Image ``step`` places after ``shot`` in the plan; None beyond either end of the plan."""
        number = shot.number + step
        return self._shot(shot.footprints, number) if 0 <= number < shot.count else None

    def _file(self, footprints: FootprintLayer) -> FootprintFile:
        known = self._files.get(footprints.folder)
        if known is None or known.stamp != file_stamp(known.path):
            known = self._files[footprints.folder] = FootprintFile(footprints.folder, self._cancelled)
        return known

    def _shot(self, footprints: FootprintLayer, number: int) -> CapturedImage:
        file = self._file(footprints)
        feature = file.read(number)
        try:
            pose = feature["properties"]
            name = str(pose["name"])
            polygons = [[[QgsPointXY(*at) for at in ring] for ring in polygon] for polygon in polygon_rings(feature)]
        except (KeyError, TypeError) as wrong:
            raise InvalidInput(tr("footprints {path}: have no poses").format(path=file.path)) from wrong
        # A foreign footprint may only name a file in its own folder.
        if not (is_name(name) and name.isprintable()):
            raise InvalidInput(
                tr("footprints {path}: {name} is not the name of an image").format(
                    path=file.path, name=one_line(repr(name))
                )
            )
        return CapturedImage(footprints, number, len(file), name, pose, QgsGeometry.fromMultiPolygonXY(polygons))


def view_image(
    shot: CapturedImage, map_type: str, longest_px: int, images: ImageFetcher, labels: str = ""
) -> ViewedImage:
    """Read an image, its depth and labels, reduced to the size shown, and its row in the table.

    Parameters
    ----------
    shot : CapturedImage
    map_type : str
    longest_px : int
    images : ImageFetcher
        Fetches images that are remote or in shards; a failure becomes the ``problem`` of the picture.
    labels : str
        Product of labels to show, if the mission wrote it; empty for none.

    Raises
    ------
    InvalidInput
        The dataset's mission cannot be read.
    Cancelled
        Nobody waits for the image any longer.
    """
    folder = shot.footprints.folder
    mission = Mission.load(folder / MISSION_FILE)
    map_type = map_type if map_type in mission.imagery.map_types else mission.imagery.map_types[0]
    file = f"{shot.name}.{mission.output.image_format}"
    path, rejected = folder / map_type / file, folder / map_type / REJECTED_FOLDER / file
    moved = file_exists(rejected) and not file_exists(path)
    row = _row(folder / map_type / TABLE_FILE, file)
    offered = tuple(one for one in LABELLED if one in mission.products)
    read = offered if labels in offered else ()
    labels = labels if read else ""
    seen = ViewedImage(shot, mission.imagery.map_types, map_type, DisplayImage(path, None), row, False)._replace(
        label_products=offered, shown_labels=labels
    )
    try:
        fetched = images.fetch(folder, map_type, file, row, (*({DEPTH} & {*mission.products}), *read))
    except Cancelled:
        raise
    except TerrAInavError as wrong:
        return seen._replace(picture=DisplayImage(path, None, problem=translate(wrong)))
    content = None if fetched is None else fetched.data
    products = {} if fetched is None else fetched.products
    return seen._replace(
        picture=read_picture(rejected if moved and fetched is None else path, longest_px, content),
        rejected=moved,
        depth=read_depth(folder / DEPTH / f"{shot.name}.tif", longest_px, products.get(DEPTH)),
        fetched=fetched,
        labels=read_labels(folder, shot.name, labels, longest_px, products) if read else None,
    )


def _row(table: Path, name: str) -> dict[str, str]:
    """Row of an image in a table, searched as text, as tables are long and only one row is needed."""
    try:
        with open_foreign(table, MAX_TABLE_BYTES) as file:
            lines = text_lines(file, "utf-8-sig")
            headers = next(csv.reader([next(lines, "")]), [])
            if not headers or headers[0] != "img_names":
                return {}
            for line in lines:
                if line.startswith(f"{name},"):
                    return dict(zip(headers, next(csv.reader([line]))))
    except (OSError, UnicodeDecodeError, csv.Error, InvalidInput):
        # A run writes the table at its end; until then, only the footprint has data.
        return {}
    return {}
