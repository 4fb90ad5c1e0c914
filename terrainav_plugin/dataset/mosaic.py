"""One raster of all images of a run, with overviews.

Map frames become a GDAL virtual raster, with overviews made directly from the images; camera frames become an
orthomosaic. Runs in the background.
"""

from __future__ import annotations

import html
import os
import re
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from osgeo import gdal

from ...core.capture.folder import captured_mission
from ...core.capture.georeference import WEB_MERCATOR_WKT, wkt_1
from ...core.capture.metadata import xml_text
from ...core.dataset.folder import JOURNAL_FILE, NAME, TABLE_FILE
from ...core.errors import Cancelled, InvalidInput, Message, OutputError
from ...core.geodesy.reference import read_reference
from ...core.imagery.raster.georeference import named_crs
from ...core.limits import MAX_VRT_BYTES
from ...core.mosaic.frames import CameraImages
from ...core.mosaic.orthomosaic import mosaic_raster
from ...core.storage.files import open_foreign, partial_file, read_limited, write_whole
from ..i18n import tr
from .rectify import OpenHeights, write_mosaic
from .shown import ImageRendering, image_rendering, open_image, open_shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan

    Numbers = NDArray[np.int64]
    Floats = NDArray[np.float64]
    Sums = NDArray[np.uint32]

#: Largest number of images of a mosaic: QGIS would parse a virtual raster of more images for minutes.
MOST_PICTURES = 100_000
#: Ending of the overviews, after the mosaic's name.
_OVERVIEWS = ".ovr"
#: Ending of a new mosaic and its overviews, until they are put in place.
_MADE = ".new"
#: Ending of the orthomosaic of camera frames.
_ORTHOPHOTO = ".tif"
#: Ending of GDAL's sidecar files, whose metadata, such as statistics, may be outdated.
_NOTES = ".aux.xml"
_SOURCE = re.compile(rb"<SourceFilename[^<>]*>([^<]+)</SourceFilename>")
_SRS = re.compile(r"<SRS[^<>]*>([^<]+)</SRS>")
_COLOURS = {1: ("Gray",), 3: ("Red", "Green", "Blue")}
Progress = Callable[[float], bool]
#: Mosaic pixels along each side of a pixel of the first overview. A finer overview would take disk space and save
#: little time: at half size, a screen shows only a few dozen images.
FACTOR = 4
#: Size of the last overview in px, about a thumbnail.
_LAST_PX = 256
#: Lossless and fast: for aerial imagery, level 1 compresses within a few percent of the default.
_OPTIONS = ("COMPRESS=DEFLATE", "PREDICTOR=2", "ZLEVEL=1", "TILED=YES", "BIGTIFF=IF_SAFER")
#: Share of the first overview in the progress; the others are made from it.
_FIRST_SHARE = 0.9


class Placed(NamedTuple):
    """Positions of images in the pixels of their mosaic; arrays (n,), from north to south.

    ``width_px, height_px`` are sizes in the mosaic, which differ from those of resized files.
    """

    paths: list[Path]
    left_px: Floats
    top_px: Floats
    width_px: Numbers
    height_px: Numbers


class MosaicRaster(NamedTuple):
    """A raster of a run's images: a virtual raster with overviews, or the orthomosaic of camera frames.

    A new raster is written under another name and then put in place, so that no file is replaced while a layer has it
    open. On closing, GDAL writes a virtual raster again with the statistics that QGIS has computed, and would thus
    restore the old raster; and Windows cannot replace an open file.

    Parameters
    ----------
    is_made : bool
        Whether the raster is new and still to be put in place.
    """

    map_type: str
    path: Path
    title: str
    is_made: bool = False

    def crs(self) -> str:
        """``EPSG:code`` of the current raster, or WKT if it has no code; raises OutputError."""
        if self.path.suffix == _ORTHOPHOTO:
            raster = open_image(self.path)
            if raster is None:
                raise _failed(self.path)
            return named_crs(read_reference(raster.GetProjection()))
        try:
            with open_foreign(self.path) as file:
                # The CRS is in the part before the first band, which is shorter.
                head = file.read(1 << 16).decode("utf-8", "replace")
        except OSError as wrong:
            raise OutputError("mosaic {0}: cannot be read ({1})", self.path, wrong.strerror) from wrong
        found = _SRS.search(head)
        wkt = html.unescape(found[1]) if found else WEB_MERCATOR_WKT
        return named_crs(read_reference(wkt))

    def put_in_place(self) -> MosaicRaster:
        """Replace the old raster by the new one; return the mosaic in place.

        Raises
        ------
        OutputError
            The file cannot be replaced, for instance because a program on Windows has it open.
        """
        overviews = _add_ending(self.path, _OVERVIEWS)
        with _replacing(self.path):
            _add_ending(overviews, _NOTES).unlink(missing_ok=True)
            if _made(overviews).is_file():
                os.replace(_made(overviews), overviews)
            else:
                overviews.unlink(missing_ok=True)
            os.replace(_made(self.path), self.path)
        return self._replace(is_made=False)

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Move the raster away, and restore it on exit over any file written meanwhile; raises OutputError."""
        with _replacing(self.path):
            os.replace(self.path, _made(self.path))
            try:
                yield
            finally:
                os.replace(_made(self.path), self.path)


def build_any_mosaics(plan: Plan, folder: Path, open_heights: OpenHeights, progress: Progress) -> list[MosaicRaster]:
    """Write the mosaics of a run's images: virtual rasters or orthomosaics; none if there are too many images.

    Parameters and errors are those of `build_mosaics` and `build_orthomosaics`.
    """
    if len(plan) > MOST_PICTURES:
        return []
    if plan.frames.is_north_up:
        return build_mosaics(plan, folder, progress)
    return build_orthomosaics(folder, plan.mission, open_heights, progress)


def check_mosaics(plan: Plan, open_heights: OpenHeights) -> None:
    """Refuse a plan of which no mosaic can be made, as far as this is known before the capture.

    Raises
    ------
    InvalidInput, SourceError
        As from `build_any_mosaics`: the heights are not available to the dataset, or the images are outside the map.
    """
    if len(plan) > MOST_PICTURES or plan.frames.is_north_up:
        return
    open_heights(captured_mission(plan))
    # One image within the map suffices for a mosaic.
    problems = [_find_problem(plan, index) for index in sorted({0, len(plan) // 2, len(plan) - 1})]
    if problems[0] is not None and None not in problems:
        raise problems[0]


def _find_problem(plan: Plan, index: int) -> InvalidInput | None:
    """Reason why an image cannot contribute to a mosaic; None if it can."""
    try:
        mosaic_raster(CameraImages.from_plan(plan, index, Path(plan.names[index])))
    except InvalidInput as wrong:
        return wrong
    return None


def build_mosaics(plan: Plan, folder: Path, progress: Progress) -> list[MosaicRaster]:
    """Write a virtual raster of the existing images for every map type of a run.

    A new raster replaces an existing one only when it is put in place. A mission across the antimeridian has two
    rasters for every map type, because the map ends there.

    Parameters
    ----------
    folder : Path
        The dataset's folder.
    progress : callable
        Takes the share done, 0 to 1; stops the work by returning False.

    Raises
    ------
    Cancelled
        ``progress`` has returned False.
    OutputError
        A file cannot be read or written.
    """
    wanted = list(_mosaics(plan, folder))
    made = []
    total = sum(len(placed.paths) for _, placed in wanted) or 1
    done = 0
    for mosaic, placed in wanted:
        before, share = done / total, len(placed.paths) / total
        build_mosaic(plan, mosaic.path, placed, lambda part, at=before, of=share: progress(at + part * of))
        done += len(placed.paths)
        # If there is no old file, no layer can have it open.
        made.append(mosaic if mosaic.path.exists() else mosaic.put_in_place())
    return made


def build_orthomosaics(
    folder: Path, mission: Mission, open_heights: OpenHeights, progress: Progress
) -> list[MosaicRaster]:
    """Write an orthomosaic for every map type of a run's camera frames, as `build_mosaics` does.

    Parameters
    ----------
    open_heights : callable
        Returns the heights of a mission.

    Raises
    ------
    Cancelled, InvalidInput, OutputError, SourceError
    """
    made, map_types = [], mission.imagery.map_types
    for number, map_type in enumerate(map_types):
        mosaic = MosaicRaster(map_type, folder / f"{map_type}{_ORTHOPHOTO}", _title(map_type), is_made=True)
        write_mosaic(
            folder,
            map_type,
            _made(mosaic.path),
            open_heights,
            lambda part, before=number: progress((before + part) / len(map_types)),
        )
        made.append(mosaic if mosaic.path.exists() else mosaic.put_in_place())
    return made


def build_mosaic(plan: Plan, target: Path, placed: Placed, progress: Progress) -> None:
    """Write one virtual raster and its overviews, under the names they have until they are put in place.

    The raster names images by relative paths, so that the folder can be moved. Ground without an image is transparent;
    where images overlap, the image farther south-east is visible.
    """
    origin = float(placed.left_px.min()), float(placed.top_px.min())
    inside = placed._replace(left_px=placed.left_px - origin[0], top_px=placed.top_px - origin[1])
    size = (
        int(np.ceil((inside.left_px + inside.width_px).max())),
        int(np.ceil((inside.top_px + inside.height_px).max())),
    )
    first = open_image(placed.paths[0])
    if first is None:
        raise _failed(placed.paths[0])
    shown = image_rendering(first)
    channels = len(shown.bands)
    made, overviews = _made(target), _made(_add_ending(target, _OVERVIEWS))
    try:
        build_overviews(inside, size, channels, overviews, progress)
        text = _virtual_raster(plan, inside, origin, size, shown, target.parent)
        write_whole(made, (line.encode() for line in text))
    except BaseException:
        for path in (made, overviews):
            with suppress(OSError):
                path.unlink(missing_ok=True)
        raise


def existing_mosaics(folder: Path, mission: Mission) -> list[MosaicRaster] | None:
    """Mosaics of a dataset from an earlier run; None if they are missing or do not show the current images."""
    found: list[MosaicRaster] = []
    try:
        journal_s = (folder / JOURNAL_FILE).stat().st_mtime
        for map_type in mission.imagery.map_types:
            # Cleaning moves images away or back, and then writes their table.
            table = folder / map_type / TABLE_FILE
            newest_s = max(journal_s, table.stat().st_mtime if table.is_file() else 0.0)
            orthophoto = folder / f"{map_type}{_ORTHOPHOTO}"
            if orthophoto.is_file():
                if orthophoto.stat().st_mtime < newest_s:
                    return None
                found.append(MosaicRaster(map_type, orthophoto, _title(map_type)))
                continue
            paths = [folder / f"{map_type}.vrt"]
            parts = [folder / f"{map_type}_{number}.vrt" for number in (1, 2)]
            paths = paths if paths[0].is_file() else [path for path in parts if path.is_file()]
            shown = {name for path in paths for name in _shown_files(path)}
            if not paths or shown != _pictures(folder / map_type, mission.output.image_format):
                return None
            if any(_made_s(path) < newest_s for path in paths):
                return None
            numbers = (0,) if len(paths) == 1 else (1, 2)
            found += [MosaicRaster(map_type, path, _title(map_type, at)) for path, at in zip(paths, numbers)]
    except OSError:
        return None
    return found


def mosaic_names(folder: Path) -> list[str]:
    """Names of a dataset's mosaics."""
    return sorted(path.name for ending in (".vrt", _ORTHOPHOTO) for path in folder.glob(f"*{ending}"))


def build_overviews(
    placed: Placed,
    size: tuple[int, int],
    channels: int,
    target: Path,
    progress: Callable[[float], bool],
) -> None:
    """Write the overviews of a raster to a sidecar file, completely or not at all.

    An overview pixel is the mean of all image pixels in it, and transparent if there are none.

    Parameters
    ----------
    placed : Placed
        Images in the pixels of the mosaic.
    size : tuple
        Width and height of the mosaic in px.
    channels : int
        Number of channels of the images: 1 or 3.
    target : Path
        Path of the file; an existing one is removed, even if the mosaic is too small for overviews.
    progress : callable
        Takes the share done, 0 to 1; stops the work by returning False.

    Raises
    ------
    Cancelled, OutputError
    """
    width, height = (-(-side // FACTOR) for side in size)
    if max(size) <= _LAST_PX:
        target.unlink(missing_ok=True)
        return
    try:
        with partial_file(target) as partial:
            raster = gdal.GetDriverByName("GTiff").Create(
                str(partial), width, height, channels + 1, gdal.GDT_Byte, [*_OPTIONS, _photometric(channels)]
            )
            if raster is None:
                raise _failed(target)
            raster.GetRasterBand(channels + 1).SetColorInterpretation(gdal.GCI_AlphaBand)
            _fill(raster, placed, (width, height), channels, progress)
            _reduce(raster, (width, height), progress)
            if raster.FlushCache() not in (None, gdal.CE_None):
                raise _failed(target)
            del raster
    except OSError as wrong:
        raise OutputError("mosaic {0}: cannot be written ({1})", target, wrong.strerror) from wrong


def _mosaics(plan: Plan, folder: Path) -> Iterator[tuple[MosaicRaster, Placed]]:
    world = plan.grid.world_px(plan.zoom)
    left_px = np.asarray(plan.windows.left_px, np.float64)
    turn = np.floor(left_px / world) if plan.grid.plane.wraps else np.zeros(len(plan))
    turns = np.unique(turn)
    order = np.lexsort((plan.windows.left_px, plan.windows.top_px))
    for map_type in plan.mission.imagery.map_types:
        for number, this in enumerate(turns):
            paths = {
                int(index): folder / map_type / f"{plan.names[index]}.{plan.mission.output.image_format}"
                for index in order[turn[order] == this]
            }
            there = {index: path for index, path in paths.items() if path.is_file()}
            if not there:
                continue
            suffix = "" if len(turns) == 1 else f"_{number + 1}"
            title = _title(map_type, 0 if len(turns) == 1 else number + 1)
            yield (
                MosaicRaster(map_type, folder / f"{map_type}{suffix}.vrt", title, is_made=True),
                _placed(plan, there, float(this) * world),
            )


def _placed(plan: Plan, pictures: dict[int, Path], turn_px: float) -> Placed:
    index = np.fromiter(pictures, np.int64, len(pictures))
    left, top, width, height = (np.asarray(values)[index] for values in plan.windows)
    return Placed(list(pictures.values()), left - turn_px, np.asarray(top, np.float64), width, height)


def _add_ending(path: Path, ending: str) -> Path:
    return path.with_name(path.name + ending)


def _made(path: Path) -> Path:
    return _add_ending(path, _MADE)


@contextmanager
def _replacing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as wrong:
        raise OutputError(
            "file {0}: cannot be replaced ({1})",
            path,
            wrong.strerror,
            remedy="close what shows it",
        ) from wrong


def _virtual_raster(
    plan: Plan,
    placed: Placed,
    origin: tuple[float, float],
    size: tuple[int, int],
    shown: ImageRendering,
    folder: Path,
) -> Iterator[str]:
    """Lines of the raster in GDAL's VRT format (gdal.org/drivers/raster/vrt.html)."""
    west, _, _, north = (float(edge) for edge in plan.grid.edges(*origin, *size, plan.zoom))
    across, down = plan.grid.pixel_size(plan.zoom)
    yield f'<VRTDataset rasterXSize="{size[0]}" rasterYSize="{size[1]}">\n'
    # Coordinates are in the order of the geotransform, whatever the order of the axes in the CRS.
    axes = "" if plan.grid.plane.wraps else ' dataAxisToSRSAxisMapping="1,2"'
    yield f"<SRS{axes}>{xml_text(wkt_1(plan.grid.plane.crs))}</SRS>\n"
    yield f"<GeoTransform>{west!r}, {across!r}, 0.0, {north!r}, 0.0, {-down!r}</GeoTransform>\n"
    sources = list(_sources(plan, placed, shown.data_type, folder))
    channels = len(shown.bands)
    for band, colour in enumerate(_COLOURS[channels], 1):
        own, kind, scaling = shown.bands[band - 1], "SimpleSource", ""
        if shown.ranges:
            low, high = shown.ranges[band - 1]
            ratio = 255.0 / (high - low)
            kind = "ComplexSource"
            scaling = f"<ScaleOffset>{-low * ratio!r}</ScaleOffset><ScaleRatio>{ratio!r}</ScaleRatio>"
        yield f'<VRTRasterBand dataType="Byte" band="{band}"><ColorInterp>{colour}</ColorInterp>\n'
        if shown.stated:
            for element, text in shown.stated[band - 1].items():
                yield f"<{element}>{xml_text(text)}</{element}>\n"
        for name, properties, places in sources:
            yield f"<{kind}>{name}<SourceBand>{own}</SourceBand>{properties}{places}{scaling}</{kind}>\n"
        yield "</VRTRasterBand>\n"
    yield f'<VRTRasterBand dataType="Byte" band="{channels + 1}"><ColorInterp>Alpha</ColorInterp>\n'
    for name, properties, places in sources:
        yield (
            f"<ComplexSource>{name}<SourceBand>1</SourceBand>{properties}{places}"
            "<ScaleOffset>255</ScaleOffset><ScaleRatio>0</ScaleRatio></ComplexSource>\n"
        )
    yield "</VRTRasterBand>\n</VRTDataset>\n"


def _sources(plan: Plan, placed: Placed, data_type: str, folder: Path) -> Iterator[tuple[str, str, str]]:
    """Name, properties and position of every image; the properties save GDAL from opening all files in advance."""
    columns = (placed.left_px, placed.top_px, placed.width_px, placed.height_px)
    for path, left, top, width, height in zip(placed.paths, *(values.tolist() for values in columns)):
        own_width, own_height = plan.mission.output.img_size[:2] if plan.mission.output.img_size else (width, height)
        name = xml_text(path.relative_to(folder).as_posix())
        properties = f'RasterXSize="{own_width}" RasterYSize="{own_height}" DataType="{data_type}"'
        source = f'xOff="0" yOff="0" xSize="{own_width}" ySize="{own_height}"'
        place = f'xOff="{left!r}" yOff="{top!r}" xSize="{width}" ySize="{height}"'
        # QGIS reads a layer in several threads. By default, GDAL shares the open images among rasters that one thread
        # has opened, which is not safe then: a hundred images hung, and QGIS crashed at times as a layer was removed.
        yield (
            f'<SourceFilename relativeToVRT="1" shared="0">{name}</SourceFilename>',
            f'<SourceProperties {properties} BlockXSize="{own_width}" BlockYSize="1"/>',
            f"<SrcRect {source}/><DstRect {place}/>",
        )


def _shown_files(mosaic: Path) -> set[str]:
    """File names of the images in a virtual raster, from its last band."""
    text = read_limited(mosaic, MAX_VRT_BYTES)
    band = text[text.rfind(b"<VRTRasterBand") :]
    return {Path(os.fsdecode(name)).name for name in _SOURCE.findall(band)}


def _pictures(folder: Path, image_format: str) -> set[str]:
    with os.scandir(folder) as there:
        paths = [Path(entry.name) for entry in there]
    return {path.name for path in paths if path.suffix == f".{image_format}" and NAME.fullmatch(path.stem)}


def _made_s(mosaic: Path) -> float:
    """Time when a mosaic was made: the time of its overviews, as GDAL may have rewritten the virtual raster."""
    overviews = _add_ending(mosaic, _OVERVIEWS)
    return (overviews if overviews.is_file() else mosaic).stat().st_mtime


def _title(map_type: str, number: int = 0) -> str:
    """Title of a mosaic's layer, or of the layer of a numbered part."""
    titles = {
        "satellite": tr("Satellite images"),
        "roadmap": tr("Roadmap images"),
        "terrain": tr("Terrain images"),
    }
    title = titles[map_type]
    return tr("{title}, part {number}").format(title=title, number=number) if number else title


def _photometric(channels: int) -> str:
    return "PHOTOMETRIC=RGB" if channels == 3 else "PHOTOMETRIC=MINISBLACK"


def _fill(
    raster: gdal.Dataset,
    placed: Placed,
    size: tuple[int, int],
    channels: int,
    progress: Callable[[float], bool],
) -> None:
    """Add up the images from north to south, and write rows that no later image reaches."""
    band_top = 0
    sums = np.zeros((0, size[0], channels + 1), np.uint32)
    tops = (placed.top_px // FACTOR).astype(np.int64)
    for index, (left, top, part) in enumerate(_reduced(placed, channels)):
        if not progress(_FIRST_SHARE * index / len(placed.paths)):
            raise Cancelled("mosaic: stopped")
        settled = int(tops[index]) - band_top
        # Write whole blocks of the file at a time, but the last row later: rounding may start an image a row above
        # the previous images.
        if settled > 256:
            _write(raster, sums[: settled - 1], band_top)
            sums, band_top = sums[settled - 1 :], band_top + settled - 1
        bottom = top + part.shape[0] - band_top
        if bottom > len(sums):
            sums = np.concatenate([sums, np.zeros((bottom - len(sums), *sums.shape[1:]), np.uint32)])
        sums[top - band_top : bottom, left : left + part.shape[1]] += part
    _write(raster, sums, band_top)


def _reduced(placed: Placed, channels: int) -> Iterator[tuple[int, int, Sums]]:
    """Left, top, and sums and counts of overview pixels, for one image after another."""
    count = os.cpu_count() or 1
    columns = (placed.left_px, placed.top_px, placed.width_px, placed.height_px)
    jobs = zip(placed.paths, *(values.astype(np.int64).tolist() for values in columns))
    with ThreadPoolExecutor(count, thread_name_prefix="terrainav-overview") as pool:
        # Each thread decodes four images ahead.
        waiting = [pool.submit(_reduce_picture, channels, *job) for job in islice(jobs, count * 4)]
        try:
            while waiting:
                yield waiting.pop(0).result()
                waiting += [pool.submit(_reduce_picture, channels, *job) for job in islice(jobs, 1)]
        finally:
            for future in waiting:
                future.cancel()


def _reduce_picture(channels: int, path: Path, left: int, top: int, width: int, height: int) -> tuple[int, int, Sums]:
    picture = open_shown(path)
    pixels = picture.ReadAsArray(buf_xsize=width, buf_ysize=height) if picture is not None else None
    if pixels is None:
        raise _failed(path)
    # Sums need 16 bits: at most FACTOR² * 255. The last channel counts pixels.
    lines = np.empty((height, width, channels + 1), np.uint16)
    lines[..., :channels] = np.moveaxis(pixels.reshape(-1, height, width)[:channels], 0, -1)
    lines[..., channels] = 1
    rows = np.add.reduceat(lines, _starts(top, height), axis=0, dtype=np.uint16)
    return left // FACTOR, top // FACTOR, np.add.reduceat(rows, _starts(left, width), axis=1, dtype=np.uint16)


def _starts(first: int, length: int) -> NDArray[np.int64]:
    """Index, along an image's side, at which each overview pixel begins."""
    return np.r_[0, np.arange(FACTOR - first % FACTOR, length, FACTOR)]


def _write(raster: gdal.Dataset, sums: Sums, top: int) -> None:
    sums = sums[: raster.RasterYSize - top]
    if not len(sums):
        return
    counts = sums[..., -1:]
    pixels = ((sums[..., :-1] + counts // 2) // np.maximum(counts, 1)).astype(np.uint8)
    alpha = np.where(counts > 0, np.uint8(255), np.uint8(0))
    bands = np.moveaxis(np.concatenate([pixels, alpha], axis=-1), -1, 0)
    if raster.WriteArray(np.ascontiguousarray(bands), 0, top) != gdal.CE_None:
        raise _failed(Path(raster.GetDescription()))


def _reduce(raster: gdal.Dataset, size: tuple[int, int], progress: Callable[[float], bool]) -> None:
    """Add further overviews to the file, each half the size of the previous one."""
    factors, factor = [], 2
    while max(size) * FACTOR // factor > _LAST_PX * FACTOR:
        factors.append(factor)
        factor *= 2

    def step(share: float, _text: str, _data: object) -> int:
        return int(progress(_FIRST_SHARE + (1.0 - _FIRST_SHARE) * share))

    raster.FlushCache()
    if factors and raster.BuildOverviews("AVERAGE", factors, callback=step) != gdal.CE_None:
        if not progress(1.0):
            raise Cancelled("mosaic: stopped")
        raise _failed(Path(raster.GetDescription()))


def _failed(path: Path) -> OutputError:
    reason = " ".join(gdal.GetLastErrorMsg().split())
    return OutputError("mosaic {0}: cannot be made ({1})", path, reason or Message("no reason given"))
