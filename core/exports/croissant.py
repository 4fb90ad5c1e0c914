"""Describe the files of a dataset, and records with typed fields, in MLCommons' format Croissant."""

from __future__ import annotations

import csv
import hashlib
import os
from pathlib import Path, PurePosixPath
from typing import Any

from ..dataset.dataset import Dataset, ImageSet, read_dataset
from ..dataset.folder import TABLE_FILE
from ..dataset.table import NUMBER, TIME, WHOLE, written_columns
from ..errors import InvalidInput
from ..limits import MAX_TABLE_BYTES
from ..storage.files import json_bytes, open_foreign, text_lines, write_whole
from ..storage.stores import Address, resolved
from ..text.plain import writable
from .huggingface import credit_line
from .tables import chosen_sets, described_folder, is_same

CROISSANT_FILE = "croissant.json"
DESCRIPTION = "Georeferenced images of the ground with the poses of a virtual UAV's camera."
#: JSON-LD context that Croissant 1.0 prescribes.
_CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "citeAs": "cr:citeAs",
    "column": "cr:column",
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "equivalentProperty": "cr:equivalentProperty",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "extract": "cr:extract",
    "field": "cr:field",
    "fileProperty": "cr:fileProperty",
    "fileObject": "cr:fileObject",
    "fileSet": "cr:fileSet",
    "format": "cr:format",
    "includes": "cr:includes",
    "isLiveDataset": "cr:isLiveDataset",
    "jsonPath": "cr:jsonPath",
    "key": "cr:key",
    "md5": "cr:md5",
    "parentField": "cr:parentField",
    "path": "cr:path",
    "recordSet": "cr:recordSet",
    "references": "cr:references",
    "regex": "cr:regex",
    "repeated": "cr:repeated",
    "replace": "cr:replace",
    "samplingRate": "cr:samplingRate",
    "sc": "https://schema.org/",
    "separator": "cr:separator",
    "source": "cr:source",
    "subField": "cr:subField",
    "transform": "cr:transform",
}
#: Media types of images by their endings.
_MEDIA = {
    ".tif": "image/tiff",
    ".tiff": "image/tiff",
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".jpeg": "image/jpeg",
}
#: Media type of shards.
TAR = "application/x-tar"
#: Glob pattern of the keys in shards: file names up to the first dot, as in WebDataset.
_KEYS = "[0-9]" * 9


def write_croissant(
    folder: str | os.PathLike[str], target: str | os.PathLike[str], map_type: str | None = None
) -> list[Path]:
    """Write ``croissant.json``, which describes the files of a dataset, into the dataset's folder; return its path.

    Each map type is a record set of images and columns of ``meta_data.csv``. An earlier description is replaced.

    Parameters
    ----------
    target : path
        The dataset's folder.
    map_type : str or None
        Map type to describe; None for all.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, lacks the map type, or differs from ``target``.
    OutputError
        The folder cannot be written.
    """
    return [describe_files(own_folder(read_dataset(folder), target, CROISSANT_FILE), map_type)]


def own_folder(dataset: Dataset, target: Address, file: str) -> Dataset:
    """Return the dataset if ``target`` is its folder; otherwise raises InvalidInput naming the ``file`` to write."""
    if not is_same(dataset.folder, target):
        raise InvalidInput(
            "folder {0}: a {1} describes the files beside it",
            target,
            file,
            remedy="give the dataset's own",
        )
    return dataset


def dataset_name(dataset: Dataset) -> str:
    """Name of a dataset, which is the name of its folder."""
    return writable(resolved(dataset.folder).name) or "dataset"


def media_type(name: str) -> str:
    """Media type of an image, by the ending of its file name."""
    return _MEDIA.get(PurePosixPath(name).suffix.lower(), "application/octet-stream")


def describe_files(dataset: Dataset, map_type: str | None = None) -> Path:
    """Write the description of a dataset (see `write_croissant`); return its path."""
    sets = chosen_sets(dataset, map_type)
    files: list[dict[str, Any]] = []
    records = []
    for name, images in sets.items():
        headers, sha256 = _headers_and_sum(images.folder / TABLE_FILE)
        files += _files(dataset, name, images, sha256)
        records.append(_records(name, images, headers))
        records += [_samples(name)] if images.shards else []
    description = {
        "@context": _CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "name": dataset_name(dataset),
        "description": DESCRIPTION,
        "license": "Terms of who made the imagery: "
        + "; ".join(f"{name}: {credit_line(images)}" for name, images in sets.items()),
        "distribution": files,
        "recordSet": records,
    }
    path = dataset.folder / CROISSANT_FILE
    write_whole(path, json_bytes(description))
    return path


def _files(dataset: Dataset, name: str, images: ImageSet, sha256: str) -> list[dict[str, Any]]:
    """File objects of a map type: the table with its checksum, and the sets of images and shards."""
    place = described_folder(dataset, images.folder)
    endings = {PurePosixPath(one).suffix: media_type(one) for one in images.table.img_names}
    table = {
        "@type": "cr:FileObject",
        "@id": f"{name}/table",
        "name": TABLE_FILE,
        "contentUrl": (place / TABLE_FILE).as_posix(),
        "encodingFormat": "text/csv",
        "sha256": sha256,
    }
    files = {
        "@type": "cr:FileSet",
        "@id": f"{name}/files",
        "name": f"images of {name}",
        "encodingFormat": [*endings.values()],
    }
    if not images.shards:
        pictures = described_folder(dataset, images.files or images.folder)
        return [table, {**files, "includes": [(pictures / f"*{one}").as_posix() for one in endings]}]
    shards = {
        "@type": "cr:FileSet",
        "@id": f"{name}/shards",
        "name": f"tars of {name}",
        "encodingFormat": TAR,
        "includes": (place / "*.tar").as_posix(),
    }
    inside = {"containedIn": {"@id": shards["@id"]}}
    rows = {
        "@type": "cr:FileSet",
        "@id": f"{name}/json",
        "name": f"rows of the table of {name}",
        "encodingFormat": "application/json",
        "includes": f"{_KEYS}.json",
    }
    # Products, whose names have two endings, do not match the patterns.
    return [
        table,
        shards,
        {**files, **inside, "includes": [f"{_KEYS}{one}" for one in endings]},
        {**rows, **inside},
    ]


def _samples(name: str) -> dict[str, Any]:
    """Record set of a map type's shards: each image with its row of the table, joined by key."""
    keys = {"extract": {"fileProperty": "filename"}, "transform": {"regex": r"^(\d{9})\."}}
    files, rows = ({"fileSet": {"@id": f"{name}/{one}"}} for one in ("files", "json"))
    content = {"extract": {"fileProperty": "content"}}
    record = f"{name}/samples"
    return {
        "@type": "cr:RecordSet",
        "@id": record,
        "name": record,
        "key": {"@id": f"{record}/key"},
        "field": [
            {**_field(record, "key", "sc:Text"), "source": {**files, **keys}, "references": {**rows, **keys}},
            {**_field(record, "image", "sc:ImageObject"), "source": {**files, **content}},
            {**_field(record, "row", "sc:Text"), "source": {**rows, **content}},
        ],
    }


def _records(name: str, images: ImageSet, headers: list[str]) -> dict[str, Any]:
    """Record set of a map type: the table and, unless images are in shards, the images."""
    table, files = {"@id": f"{name}/table"}, {"@id": f"{name}/files"}
    types = {WHOLE: "sc:Integer", NUMBER: "sc:Float", TIME: "sc:DateTime"}
    # Foreign tables may lack columns.
    first, *columns = (one for one in written_columns(images.table) if one.header in headers)
    names = {"fileObject": table, "extract": {"column": first.header}}
    fields = [{**_field(name, "file", "sc:Text"), "source": names}]
    if not images.shards:
        paths = {"fileSet": files, "extract": {"fileProperty": "filename"}}
        fields = [
            {**fields[0], "source": paths, "references": names},
            {
                **_field(name, "image", "sc:ImageObject"),
                "source": {"fileSet": files, "extract": {"fileProperty": "content"}},
            },
        ]
    fields += [
        {
            **_field(name, one.header, types.get(one.kind, "sc:Text")),
            "source": {"fileObject": table, "extract": {"column": one.header}},
        }
        for one in columns
    ]
    return {
        "@type": "cr:RecordSet",
        "@id": name,
        "name": name,
        "key": {"@id": f"{name}/file"},
        "field": fields,
    }


def _field(record: str, name: str, kind: str) -> dict[str, Any]:
    return {"@type": "cr:Field", "@id": f"{record}/{name}", "name": name, "dataType": kind}


def _headers_and_sum(path: Path) -> tuple[list[str], str]:
    """Headers of a table, and the SHA-256 of its file."""
    digest = hashlib.sha256()
    try:
        with open_foreign(path, MAX_TABLE_BYTES) as file:
            headers = next(csv.reader(text_lines(file, "utf-8-sig")))
            file.seek(0)
            while block := file.read(1 << 20):
                digest.update(block)
    except (OSError, InvalidInput) as wrong:
        raise InvalidInput("table {0}: cannot be read ({1})", path, wrong) from wrong
    return headers, digest.hexdigest()
