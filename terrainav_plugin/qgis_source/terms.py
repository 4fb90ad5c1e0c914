"""Terms of use of a layer's providers, for any kind of layer and any form of its addresses.

Addresses are searched in the layer's data source, in the service's capabilities, and in files that describe data
elsewhere: GDAL's descriptions of WMS and tiles, VRTs that name such descriptions, and sidecar files.
"""

from __future__ import annotations

import html
import re
import stat
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING
from urllib.parse import parse_qsl

from osgeo import gdal
from qgis.core import QgsMapLayer, QgsProviderRegistry, QgsRasterLayer

from ...core.imagery.entry import find_providers
from ...core.imagery.policy import BULK, Policy
from ...core.imagery.raster.trust import FETCHED
from ...core.limits import MAX_VRT_BYTES

if TYPE_CHECKING:
    from ...core.imagery.entry import CatalogueEntry

#: Referer headers in a data source: sent along, never fetched.
_REFERRED = re.compile(r"(http-header:)?refer+er=('[^']*'|\"[^\"]*\"|[^&\s]*)", re.IGNORECASE)
#: URL elements without a scheme, which GDAL allows.
_BARE = re.compile(r"<(\w*url)\b[^<>]*>\s*(?!\w+:/)([^<>\s]+)", re.IGNORECASE)
_MARKUP = re.compile(r"<!--.*?-->|<!\[CDATA\[|\]\]>", re.DOTALL)
#: File names in a description: text of an element, and values of attributes and of JSON.
_VALUES = re.compile(r">([^<>]{1,1024})<|\"([^\"<>]{1,1024})\"|'([^'<>]{1,1024})'")
#: Largest number of files searched for one layer.
_MOST_FILES = 10_000
#: Deepest nesting of descriptions that is followed.
_MOST_DEPTH = 8


def policies(layers: Iterable[QgsMapLayer]) -> list[tuple[Policy, str]]:
    """Terms that limit the use of layers, each with the layers' names.

    Terms that forbid bulk download come first, then terms that require asking. Layers of one provider share its limits.
    """
    found: dict[str, tuple[CatalogueEntry, list[str]]] = {}
    for layer in layers:
        for provider in known_providers(layer):
            found.setdefault(provider.name, (provider, []))[1].append(layer.name())
    terms = [(_divided(one.policy, len(names)), ", ".join(names)) for one, names in found.values()]
    limited = [one for one in terms if one[0].bulk_allowed != "yes"]
    return sorted(limited, key=lambda one: (-BULK.index(one[0].bulk_allowed), one[0].max_tiles or 0))


def known_providers(layer: QgsMapLayer) -> list[CatalogueEntry]:
    """Known providers of a layer, each once. Main thread only."""
    inner = getattr(layer, "childLayers", list)()
    found = {one.name: one for child in inner for one in known_providers(child)}
    found.update((one.name, one) for text in _texts(layer) for one in find_providers(text))
    names = _names(layer)
    stamps = tuple((one.mtime, one.size) if one else None for one in map(_file_status, names))
    found.update((one.name, one) for one in _described(names, stamps))
    return list(found.values())


@lru_cache(maxsize=64)
def _described(names: tuple[str, ...], _stamps: tuple[object, ...]) -> tuple[CatalogueEntry, ...]:
    """Providers found in descriptions; cached while the files are unchanged, as a VRT may name thousands of files."""
    texts = _Descriptions().texts(names)
    return tuple({one.name: one for text in texts for one in find_providers(text)}.values())


def _divided(policy: Policy, count: int) -> Policy:
    if count == 1 or policy.max_tiles is None:
        return policy
    return replace(policy, max_tiles=max(policy.max_tiles // count, 1))


def _texts(layer: QgsMapLayer) -> Iterator[str]:
    """Texts that may contain a layer's addresses."""
    source = _REFERRED.sub("", layer.source())
    yield source
    if not isinstance(layer, QgsRasterLayer):
        return
    provider = layer.dataProvider()
    if layer.providerType() == "wms" and provider is not None:
        # A service's capabilities contain the addresses of its images.
        yield provider.htmlMetadata()


def _names(layer: QgsMapLayer) -> tuple[str, ...]:
    """Parts of a raster layer's data source that may be a description or name a file with one."""
    if not isinstance(layer, QgsRasterLayer):
        return ()
    source = layer.source()
    decoded = QgsProviderRegistry.instance().decodeUri(layer.providerType(), source).get("path", "")
    names = [source, decoded, *(value for _, value in parse_qsl(source))]
    return tuple(name for name in dict.fromkeys(names) if isinstance(name, str))


def _file_status(name: str) -> gdal.StatBuf | None:
    """Status of a regular local file; None for other names, and for pipes, which would block."""
    found = None if FETCHED.search(name) or "\0" in name else gdal.VSIStatL(name)
    return found if found is not None and stat.S_ISREG(found.mode) else None


class _Descriptions:
    """Files that describe data elsewhere, and the files they name; each is read once."""

    def __init__(self) -> None:
        self._seen: set[str] = set()

    def texts(self, names: Iterable[str], depth: int = 0) -> Iterator[str]:
        """Texts of descriptions; each of ``names`` may be a description or name a file with one."""
        for name in names:
            if name.lstrip().startswith("<"):
                text, folder = name, ""
            else:
                text, folder = self._text(name), name.rpartition("/")[0]
            if not text:
                continue
            plain = html.unescape(_MARKUP.sub("", text))
            yield plain
            yield " ".join(f"http://{address}" for _, address in _BARE.findall(plain))
            if depth < _MOST_DEPTH:
                named = dict.fromkeys("".join(values).strip() for values in _VALUES.findall(plain))
                inside = (one for one in named if "://" not in one and not one.isdecimal())
                yield from self.texts((path for one in inside for path in _paths(one, folder)), depth + 1)
        if depth == 0:
            # GDAL opens these sidecar files together with a raster.
            sidecars = [name + ending for name in list(self._seen) for ending in (".aux.xml", ".ovr", ".msk")]
            yield from self.texts(sidecars, depth + 1)

    def _text(self, name: str) -> str:
        """Text of a local description; empty for another file, such as an image, and for a file already read."""
        if name in self._seen or len(self._seen) >= _MOST_FILES or _file_status(name) is None:
            return ""
        self._seen.add(name)
        head = _read(name, 256).lstrip(b"\xef\xbb\xbf \t\r\n")
        if not head.startswith((b"<", b"{", b"[")):
            return ""
        return _read(name, MAX_VRT_BYTES).decode("utf-8", "replace")


def _paths(name: str, folder: str) -> list[str]:
    """Paths to which a name in a description may refer."""
    return [name, f"{folder}/{name}"] if folder else [name]


def _read(name: str, size: int) -> bytes:
    file = gdal.VSIFOpenL(name, "rb")
    if file is None:
        return b""
    try:
        return bytes(gdal.VSIFReadL(1, size, file) or b"")
    finally:
        gdal.VSIFCloseL(file)
