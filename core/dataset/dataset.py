"""Read datasets: map types, each with a table and the image files that it names."""

from __future__ import annotations

import contextlib
import io
import math
import os
import re
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

import numpy as np
from PIL import Image, UnidentifiedImageError

from ..arrays import NDArray
from ..bands import Bands
from ..errors import InvalidInput, Message, OptionName, OutputError
from ..geodesy.contract import CameraContract
from ..limits import MAX_IMAGE_FILE_BYTES, MAX_PICTURE_PX, MAX_SETTINGS_BYTES
from ..storage.files import open_foreign, read_limited
from ..storage.stores import Address, is_address, list_sizes, store_path
from .cameras import image_contract
from .folder import (
    LAYOUTS,
    NAME,
    REJECTED_FOLDER,
    TABLE_FILE,
    image_folder,
    map_type_folders,
    map_type_name,
    no_files_error,
    place_key,
    raster_folders,
)
from .geotiff import GeoTiff, parse_bands, parse_geotiff, parse_pam_bands
from .published import check_names
from .stored import ImageFile, Range, StoredImage, is_name, shard_sizes
from .table import Table
from .vbn import read_vbn

#: Pillow's modes by number of channels.
_MODES = {1: "L", 3: "RGB"}
#: Raised by Pillow for files that are damaged, too large or not images.
UNREADABLE = (OSError, ValueError, SyntaxError, Image.DecompressionBombError)
#: Pillow's grey modes with at most eight bits a channel.
_GREY = ("1", "L", "LA", "La")
#: Pillow's other modes with at most eight bits a channel, which are converted to RGB.
_COLOUR = ("RGB", "RGBA", "RGBa", "RGBX", "P", "PA", "CMYK", "YCbCr", "LAB", "HSV")
_GEOTIFF = (".tif", ".tiff")
#: Unknown size.
_UNKNOWN_PX = (math.nan, math.nan)
#: Where an image is read from.
Place = Union[str, "os.PathLike[str]", StoredImage]


@dataclass(frozen=True, eq=False)
class ImageSet:
    """The images of one map type.

    Parameters
    ----------
    map_type : str
        Such as ``satellite``, also for a published folder ``satellite_0``.
    folder : Path
        Folder of the table.
    table : Table
        All rows.
    files : Path or None
        Local folder of the images; its subfolder ``rejected`` holds the images that cleaning has moved. None if the
        images are objects of a store, or in shards.
    shards : mapping of str to int
        Sizes in bytes of the tars that hold the images, by name; empty if images are files or objects.
    """

    map_type: str
    folder: Path
    table: Table
    files: Path | None
    shards: Mapping[str, int] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.table)

    @property
    def made(self) -> NDArray[np.bool_]:
        """Rows (n,) whose image has been made."""
        return self.table.made

    @property
    def image_folder(self) -> Path:
        """Local folder of the images; raises InvalidInput if they are not local files."""
        if self.files is None:
            raise no_files_error(self.folder)
        return self.files

    def file(self, index: int) -> ImageFile:
        """File of a row's image: a path, an object or a range of a shard."""
        if self.files is not None:
            return self.path(index)
        table, name = self.table, self.table.img_names[index]
        if not self.shards:
            return StoredImage(name, self.folder / name)
        place = Range(int(table.offset_bytes[index]), int(table.size_bytes[index]))
        shard = table.shard[index]
        return StoredImage(name, self.folder / shard, place, self.shards[shard])

    def path(self, index: int) -> Path:
        """Path of a row's image, in its folder or among the rejected images.

        Raises
        ------
        InvalidInput
            The images are not files of a local folder.
        """
        name = self.table.img_names[index]
        kept = self.image_folder / name
        moved = self.image_folder / REJECTED_FOLDER / name
        return moved if not kept.exists() and moved.exists() else kept

    def pixels(self, index: int, channels: int | None = None, *, file: ImageFile | None = None) -> NDArray[Any]:
        """Read the pixels of a row's image, without a mask.

        Parameters
        ----------
        channels : int or None
            1 for 8-bit grey (ITU-R BT.601), 3 for 8-bit red, green, blue; None for the channels of the file.
        file : path, StoredImage or None
            Where to read the image from; None for the result of the method `file`.

        Returns
        -------
        array (h, w) of grey or (h, w, 3) of uint8; for GeoTIFFs with other bands, (h, w, bands) of their type

        Raises
        ------
        InvalidInput
            The image does not exist, cannot be read, or has another size than the table states.
        """
        if channels is not None and channels not in _MODES:
            raise InvalidInput("channels {0}: must be 1 or 3", channels)
        file = self.file(index) if file is None else file
        if channels is None:
            stored = open_bands(file, self.expected_px(index))
            if stored is not None:
                return stored.values()
        image = open_image(file, expected_px=self.expected_px(index), as_shown=True)
        mode = image.mode if channels is None else _MODES[channels]
        return np.asarray(image if image.mode == mode else image.convert(mode), np.uint8)

    def contract(self, index: int) -> CameraContract:
        """What the pixels of a row's image mean; see `image_contract`."""
        return image_contract(self.table, index)

    def expected_px(self, index: int) -> tuple[float, float]:
        """Width and height of a row's image as the table states them, NaN if it does not."""
        return float(self.table.image_width_px[index]), float(self.table.image_height_px[index])


@dataclass(frozen=True, eq=False)
class Dataset:
    """A folder of images with tables.

    Parameters
    ----------
    layout : str
        One of `LAYOUTS`.
    image_sets : mapping of str to ImageSet
        By map type; by folder name if several published folders share a map type, such as with different overlaps; by
        imagery if the dataset holds several imageries.
    """

    folder: Path
    layout: str
    image_sets: Mapping[str, ImageSet]

    def place_key(self) -> Callable[[str], str]:
        """Return the function that maps an image's name to its place; see `folder.place_key`."""
        return place_key(self.folder, [one.folder for one in self.image_sets.values()])

    def image_set(self, map_type: str) -> ImageSet:
        """Images of a map type; raises InvalidInput, which lists the map types, if there are none."""
        if map_type not in self.image_sets:
            raise InvalidInput("map type {0!r}: {1} has {2}", map_type, self.folder, ", ".join(self.image_sets))
        return self.image_sets[map_type]


def read_dataset(folder: Address, layout: str = "TerrAInav") -> Dataset:
    """Read a dataset and check that its tables and files agree; reads no pixels.

    Parameters
    ----------
    folder : path
        Folder or address of an object store: a capture, the paper's published data (``Memphis_Agricenter`` with
        ``satellite`` or ``satellite_0`` in it, or one of these alone), or the Night Vision supplement.
    layout : str
        One of `LAYOUTS`.

    Raises
    ------
    InvalidInput
        The folder is not such a dataset, rows cannot be read, or table and files disagree.
    OutputError
        The object store cannot be reached.
    """
    path = store_path(folder)
    if layout not in LAYOUTS:
        raise InvalidInput("layout {0!r}: must be one of {1}", layout, ", ".join(LAYOUTS))
    if layout == "VBN":
        if is_address(path):
            raise InvalidInput("layout VBN: {0} is in an object store; must be a folder of this machine", path)
        table, images = read_vbn(path)
        return Dataset(path, layout, {"camera": ImageSet("camera", images, table, images)})
    folders = map_type_folders(path)
    counts = Counter(map(map_type_name, folders))
    sets = {}
    for name, one in folders.items():
        of_imagery = one.parent.parent == path
        map_type = one.name if of_imagery else map_type_name(name)
        key = name if of_imagery or counts[map_type] > 1 else map_type
        sets[key] = _read_set(map_type, one)
    return Dataset(path, layout, sets)


def _read_set(map_type: str, folder: Path) -> ImageSet:
    table = Table.load(folder / TABLE_FILE)
    _check_positions(table, folder / TABLE_FILE)
    check_names(table, folder / TABLE_FILE)
    if any(table.shard):
        _check_names(folder, table.img_names)
        return ImageSet(map_type, folder, table, None, shard_sizes(folder, table))
    files = None if is_address(folder) else image_folder(folder, table)
    Images(files or folder).check(table.img_names, table.made)
    return ImageSet(map_type, folder, table, files)


def _check_positions(table: Table, path: Path) -> None:
    off = np.flatnonzero((np.abs(table.lat_deg) > 90.0) | (np.abs(table.lon_deg) > 360.0))
    if off.size:
        names = [table.img_names[row] for row in off.tolist()]
        raise InvalidInput(
            "table {0}: {1} is not on the Earth, first at Lat {2:g}, Lon {3:g}; Lat must be within 90 degrees, "
            "Lon within 360"
            if len(names) == 1
            else "table {0}: {1} are not on the Earth, first at Lat {2:g}, Lon {3:g}; Lat must be within 90 "
            "degrees, Lon within 360",
            path,
            first_names(names),
            table.lat_deg[off[0]],
            table.lon_deg[off[0]],
        )


@dataclass(frozen=True)
class Move:
    """A file of the image ``stem``, and where to move it within a file system."""

    stem: str
    origin: Path
    target: Path

    def carry_out(self) -> None:
        """Move the file; raises OutputError."""
        try:
            self.target.parent.mkdir(exist_ok=True)
            os.replace(self.origin, self.target)
        except OSError as wrong:
            raise OutputError(
                "file {0}: cannot be moved to {1} ({2})",
                self.origin,
                self.target.parent,
                wrong.strerror,
                remedy="run it again to finish, or undo to put all back",
            ) from wrong


class Images:
    """Files of a map type, in its folder and among its rejected images.

    Raises
    ------
    InvalidInput
        A folder cannot be read, or a file is in both folders.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        has_rejected = is_address(folder) or (folder / REJECTED_FOLDER).is_dir()
        self._kept, others = _list_folder(folder)
        self._rejected, rejected_others = _list_folder(folder / REJECTED_FOLDER) if has_rejected else (set(), set())
        self._blocked = REJECTED_FOLDER in self._kept | others and not has_rejected
        in_both = sorted(self._kept & (self._rejected | rejected_others) | self._rejected & others)
        if in_both:
            raise InvalidInput(
                "folder {0}: {1} is in it and in {2} as well"
                if len(in_both) == 1
                else "folder {0}: {1} are in it and in {2} as well",
                folder,
                first_names(in_both),
                REJECTED_FOLDER,
                remedy="remove one of the two",
            )

    def check(self, names: Sequence[str], made: NDArray[np.bool_]) -> None:
        """Raise InvalidInput if a table and the files disagree.

        Parameters
        ----------
        names : sequence of str
            Images of all rows of the table.
        made : array of bool
            Rows whose images have been made.
        """
        endings, stems = _check_names(self._folder, names)
        has_one_ending = len(endings) == 1
        files = self._kept | self._rejected if self._rejected else self._kept
        lost = [name for name, is_made in zip(names, made.tolist()) if is_made and name not in files]
        if lost:
            raise InvalidInput(
                "folder {0}: {1} of the table is not there"
                if len(lost) == 1
                else "folder {0}: {1} of the table are not there",
                self._folder,
                first_names(lost),
                remedy=Message(
                    "put it back, or capture again{0}" if len(lost) == 1 else "put them back, or capture again{0}",
                    OptionName("resume").in_brackets,
                ),
            )
        unknown = sorted(
            name
            for name in files
            if (name if has_one_ending else _plain_stem(name)) not in stems
            and name[len(_plain_stem(name)) :] in endings
            and NAME.fullmatch(_plain_stem(name))
        )
        if unknown:
            raise InvalidInput(
                "folder {0}: {1} is not in the table" if len(unknown) == 1 else "folder {0}: {1} are not in the table",
                self._folder,
                first_names(unknown),
                remedy=Message(
                    "finish the capture{0}, or remove what does not belong to it",
                    OptionName("resume").in_brackets,
                ),
            )

    def path(self, name: str) -> Path:
        """Path of an image."""
        return self._folder / (REJECTED_FOLDER if name in self._rejected else "") / name

    def moves(self, out: Iterable[str], back: Iterable[str]) -> tuple[list[Move], list[Move]]:
        """Moves that reject and restore images, with all files that belong to them.

        Files already in place are left out. An image leaves before its other files and returns after them, so images in
        the folder are always complete.

        Parameters
        ----------
        out, back : iterable of str
            Names of the images to reject, and to restore.

        Raises
        ------
        InvalidInput
            A file has the name of the folder for rejected images.
        """
        leaving, returning = set(out), set(back)
        if leaving and self._blocked:
            raise InvalidInput(
                "folder {0}: {1} in it is not a folder, so images cannot be moved to it",
                self._folder,
                REJECTED_FOLDER,
                remedy="move it away",
            )
        return (
            self._moves(self._kept, leaving, self._folder, self._folder / REJECTED_FOLDER),
            self._moves(self._rejected, returning, self._folder / REJECTED_FOLDER, self._folder)[::-1],
        )

    def moves_back(self) -> list[Move]:
        """Moves that restore everything among the rejected images."""
        origin = self._folder / REJECTED_FOLDER
        return [
            Move(_stem(name, NAME.fullmatch), origin / name, self._folder / name) for name in sorted(self._rejected)
        ]

    @staticmethod
    def _moves(files: set[str], images: set[str], origin: Path, target: Path) -> list[Move]:
        stems = {Path(name).stem: name for name in images}
        found = []
        for name in files:
            stem = _stem(name, stems.__contains__)
            if stem in stems:
                found.append((stem, name != stems[stem], name))
        return [Move(stem, origin / name, target / name) for stem, _, name in sorted(found)]

    @staticmethod
    def remove_if_empty(folder: Path) -> None:
        """Remove the folders of rejected images of a map type if they are empty."""
        for one in (folder, *raster_folders(folder)):
            with contextlib.suppress(OSError):
                (one / REJECTED_FOLDER).rmdir()


def _check_names(folder: Path, names: Sequence[str]) -> tuple[set[str], set[str]]:
    """Check names of images; return their endings, and the set of names, without endings if these differ.

    Raises
    ------
    InvalidInput
        A text is not a file name, or a name is in several rows.
    """
    foreign = [name for name in names if not is_name(name)]
    if foreign:
        raise InvalidInput("folder {0}: {1!r} in the table is not a file name", folder, foreign[0])
    endings = {name[len(_plain_stem(name)) :] for name in names}
    stems = set(names) if len(endings) == 1 else set(map(_plain_stem, names))
    if len(stems) < len(names):
        twice = [stem for stem, count in Counter(map(_plain_stem, names)).items() if count > 1]
        raise InvalidInput("folder {0}: the table has {1} in more than one row", folder, first_names(twice))
    return endings, stems


def _plain_stem(name: str) -> str:
    """Name of a file without its ending: like `Path.stem`, but much faster."""
    end = name.rfind(".")
    return name[:end] if 0 < end < len(name) - 1 else name


def _stem(name: str, known: Callable[[str], object]) -> str:
    """Name of the image that a file belongs to: ``a.b`` of ``a.b.tif`` and of ``a.b.tif.aux.xml``."""
    end = name.rfind(".")
    while end > 0:
        if known(name[:end]):
            return name[:end]
        end = name.rfind(".", 0, end)
    return Path(name).stem


def _list_folder(folder: Path) -> tuple[set[str], set[str]]:
    """Names of the files in a folder, and of everything else in it."""
    if is_address(folder):
        return set(list_sizes(folder)), set()
    try:
        files: set[str] = set()
        others: set[str] = set()
        with os.scandir(folder) as entries:
            for entry in entries:
                (files if entry.is_file() else others).add(entry.name)
    except OSError as wrong:
        raise InvalidInput("folder {0}: cannot be read ({1})", folder, wrong.strerror) from wrong
    return files, others


def first_names(names: Sequence[str]) -> str:
    """First three names, with the number of others."""
    more = len(names) - 3
    first = ", ".join(names[:3])
    return Message("{0} and {1:,} more", first, more) if more > 0 else first


def open_image(
    path: Place,
    img_size: tuple[int, int, int] | None = None,
    expected_px: tuple[float, float] = _UNKNOWN_PX,
    *,
    as_shown: bool = False,
) -> Image.Image:
    """Read an image, grey (``L``) or ``RGB``, and decode it.

    Transparency is dropped: pixels keep their colours. Colours become grey by ITU-R BT.601. Images are resized
    with Pillow's bilinear filter, which averages all pixels merged into one.

    Parameters
    ----------
    path : path or StoredImage
        GeoTIFF, JPEG, PNG or TIFF.
    img_size : tuple (width, height, channels) or None
        In px, and 1 (grey) or 3 (colour); None leaves both as they are.
    expected_px : tuple (width, height)
        Size that the table states, NaN if it states none.
    as_shown : bool
        Convert a GeoTIFF with bands other than 8-bit grey or colour to what is displayed, instead of refusing it.

    Raises
    ------
    InvalidInput
        The file cannot be read, has more than eight bits a channel, or another size than expected.
    """
    try:
        # Decode from memory: libtiff and Pillow both close the file of a compressed TIFF, and the second call may close
        # a file that another thread has opened in between.
        data = read_image_file(path)
        stored = _parse_bands(path, data, expected_px)
        if stored is not None:
            return _shown(path, stored, img_size, as_shown=as_shown)
        with open_undecoded(path, data) as image:
            if image.mode not in _GREY + _COLOUR:
                raise InvalidInput(
                    "image {0}: has pixels of Pillow's mode {1}; must be 8-bit grey or colour",
                    path,
                    image.mode,
                )
            check_px(path, image.size, expected_px)
            if img_size is None:
                return _convert_mode(image, "L" if image.mode in _GREY else "RGB")
            width, height, channels = img_size
            mode = "L" if channels == 1 else "RGB"
            # Decode a JPEG at a half, quarter or eighth of its size if that is at least twice the size asked for; with
            # less, the result would differ.
            image.draft(mode, (2 * width, 2 * height))
            found = _convert_mode(image, mode)
            return found if found.size == (width, height) else found.resize((width, height), Image.BILINEAR)
    except InvalidInput:
        raise
    except FileNotFoundError as wrong:
        raise InvalidInput(
            "image {0}: is not there",
            path,
            remedy=Message("put it back, or capture it again{0}", OptionName("resume").in_brackets),
        ) from wrong
    except UnidentifiedImageError as wrong:
        raise InvalidInput("image {0}: cannot be read (it is not a JPEG, PNG or TIFF)", path) from wrong
    except UNREADABLE as wrong:
        # For a damaged compressed TIFF, Pillow reports a bare libtiff error number.
        is_number = re.fullmatch(r"(decoder error )?-?\d+", str(wrong))
        reason = Message("its pixels are damaged or cut off") if is_number else wrong
        raise InvalidInput("image {0}: cannot be read ({1})", path, reason) from wrong


def open_masked(
    path: Place, expected_px: tuple[float, float] = _UNKNOWN_PX
) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None]:
    """Read the displayed pixels (h, w, 1 or 3) of a file, and its mask (h, w), 0 for pixels without data, or None.

    Raises
    ------
    InvalidInput
        As `open_image`.
    """
    pixels = np.asarray(open_image(path, expected_px=expected_px, as_shown=True), np.uint8)
    pixels = pixels.reshape(*pixels.shape[:2], -1)
    stored = open_bands(path)
    if stored is not None:
        seen = stored.seen()
        return pixels, None if seen is None else seen.astype(np.uint8) * np.uint8(255)
    with open_undecoded(path, read_image_file(path)) as image:
        masked = "A" in image.getbands()
        return pixels, np.asarray(image.getchannel("A"), np.uint8) if masked else None


def open_bands(path: Place, expected_px: tuple[float, float] = _UNKNOWN_PX) -> GeoTiff | None:
    """Read a GeoTIFF with bands other than 8-bit grey or colour; None for other and for unreadable files.

    Raises
    ------
    InvalidInput
        The GeoTIFF is damaged, or has another size than expected.
    """
    if _suffix(path) not in _GEOTIFF:
        return None
    try:
        data = read_image_file(path)
    except OSError:
        return None
    return _parse_bands(path, data, expected_px)


def read_band_metadata(path: Place, channels: int) -> Bands | None:
    """Read the bands stated by an image or by GDAL's file beside it; None if neither states any.

    Parameters
    ----------
    channels : int
        1 or 3, for images other than GeoTIFFs.
    """
    if _suffix(path) in _GEOTIFF:
        return parse_bands(read_image_file(path))
    if isinstance(path, StoredImage):
        return None
    sidecar = Path(f"{path}.aux.xml")
    if not sidecar.is_file():
        return None
    return parse_pam_bands(read_limited(sidecar, MAX_SETTINGS_BYTES).decode("utf-8", "replace"), channels)


def _parse_bands(path: Place, data: bytes, expected_px: tuple[float, float]) -> GeoTiff | None:
    try:
        stored = parse_geotiff(data)
        if stored is not None:
            stored.values()
    except (ValueError, zlib.error) as wrong:
        raise InvalidInput("image {0}: cannot be read ({1})", path, wrong) from wrong
    if stored is not None:
        check_px(path, stored.size, expected_px)
    return stored


def _shown(path: Place, stored: GeoTiff, img_size: tuple[int, int, int] | None, *, as_shown: bool) -> Image.Image:
    if not as_shown:
        raise InvalidInput(
            "image {0}: has {1}, and not grey or colours of 8 bits",
            path,
            stored.bands,
            remedy=Message("take the dtype stored, or capture with a stretch{0}", OptionName("stretch").in_brackets),
        )
    image = Image.fromarray(stored.shown())
    if img_size is None:
        return image
    width, height, channels = img_size
    found = _convert_mode(image, "L" if channels == 1 else "RGB")
    return found if found.size == (width, height) else found.resize((width, height), Image.BILINEAR)


def image_size(path: Place) -> tuple[int, int]:
    """Read the width and height of an image in px; raises InvalidInput or one of `UNREADABLE`."""
    if _suffix(path) in _GEOTIFF:
        # Do not decode pixels: many images are read.
        stored = parse_geotiff(read_image_file(path))
        if stored is not None:
            return stored.size
    with open_undecoded(path) as image:
        return image.size


@contextmanager
def open_undecoded(path: Place, data: bytes | None = None) -> Iterator[Image.Image]:
    """Open an image without decoding it; of a local file, only the header is read.

    Parameters
    ----------
    data : bytes or None
        Contents of the file, if they have been read.

    Raises
    ------
    InvalidInput
        The image is too large; other errors are those of `UNREADABLE`.
    """
    with ExitStack() as opened:
        if data is None and not isinstance(path, StoredImage):
            file = open_foreign(path)
        else:
            file = io.BytesIO(read_image_file(path) if data is None else data)
        # Only formats that captures write: each of Pillow's decoders is a risk.
        formats = ("JPEG", "PNG", "TIFF")
        image = opened.enter_context(Image.open(opened.enter_context(file), formats=formats))
        width, height = image.size
        if width * height > MAX_PICTURE_PX:
            raise InvalidInput(
                "image {0}: has {1:,} x {2:,} px, more than {3:,} in all", path, width, height, MAX_PICTURE_PX
            )
        yield image


def read_image_file(path: Place) -> bytes:
    """Read the bytes of an image; raises InvalidInput or OSError."""
    if isinstance(path, StoredImage):
        return path.read_bytes()
    try:
        return read_limited(path, MAX_IMAGE_FILE_BYTES)
    except InvalidInput as wrong:
        raise InvalidInput("image {0}: cannot be read ({1})", path, wrong) from wrong


def _suffix(path: Place) -> str:
    return (path if isinstance(path, StoredImage) else Path(path)).suffix.lower()


def check_px(path: Place, size: tuple[int, int], expected_px: tuple[float, float]) -> None:
    """Raise InvalidInput if an image has another width and height than the table states; NaN is unknown."""
    if any(expected == expected and expected != length for expected, length in zip(expected_px, size)):
        raise InvalidInput(
            "image {0}: has {1} x {2} px, and {3:g} x {4:g} px in the table",
            path,
            size[0],
            size[1],
            expected_px[0],
            expected_px[1],
            remedy="capture it again, or put the table right",
        )


def _convert_mode(image: Image.Image, mode: str) -> Image.Image:
    image.load()
    return image if image.mode == mode else image.convert(mode)
