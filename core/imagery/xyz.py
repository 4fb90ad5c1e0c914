"""Tiles by URL template."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import astuple
from typing import Callable

from ..arrays import PixelValues
from ..errors import InvalidInput, Message, PartError, SourceError
from ..geodesy.mercator import PixelGrid
from ..map_types import MAP_TYPES
from .cache.tile_cache import TileCache
from .cache.tilestore import TileStore
from .decode import WrongSizeError, decode
from .entry import CatalogueEntry, serving
from .http.client import Client, NotThere
from .http.requests_transport import RequestsTransport
from .http.transport import Response, Transport
from .opening import SourceOptions
from .placeholder import Placeholder, Received
from .policy import Policy
from .source import Part, Window, tile_address, tile_parts
from .template import Template, host_of

#: Hosts whose terms are kept at hand; a template has a few.
_HOSTS = 64


class XYZSource:
    """Tiles of 256 or 512 px (or any multiple of 256) by URL template; PNG, JPEG, WebP or GIF.

    Parameters
    ----------
    templates : str, Template, or mapping of map type to either
    name, title, attribution : str
        Name defaults to the template, title to its host.
    grid : PixelGrid
        Tile size and zooms.
    key : str or None
        What {key} stands for.
    date : str
        What {date} stands for.
    placeholder : Placeholder
    policy : Policy
    client : Client or None
        None for one over ``transport``.
    transport : Transport or None
        None for requests.
    connections : int
        Requests under way at once, where the policy allows them.
    cache : TileCache or None
        Where tiles are kept for later runs, if the policy allows it; None for nowhere.
    limits : tuple
        Tiles there are, as `CatalogueEntry.tile_limits`.
    alpha : bool
        Whether the fourth channel is what the tiles have, for who lays them over something else.
    encoded : bool
        Whether colours are numbers, such as heights: as ``alpha``, and named in ways of their own.
    any_size : bool
        As `CatalogueEntry.any_size`; numbers are never resized.

    Attributes
    ----------
    placeholder, received
        As for `Provided`.
    """

    def __init__(
        self,
        templates: str | Template | Mapping[str, str | Template],
        *,
        name: str = "",
        title: str = "",
        attribution: str = "",
        grid: PixelGrid = PixelGrid(),  # noqa: B008 (an immutable value)
        key: str | None = None,
        date: str = "",
        placeholder: Placeholder = Placeholder(),  # noqa: B008
        policy: Policy = Policy(),  # noqa: B008
        client: Client | None = None,
        transport: Transport | None = None,
        connections: int = 8,
        cache: TileCache | None = None,
        limits: Iterable[tuple[int, int, int, int, int]] = (),
        alpha: bool = False,
        encoded: bool = False,
        any_size: bool = False,
    ) -> None:
        given = dict(templates) if isinstance(templates, Mapping) else {"": templates}
        self._templates = {
            map_type: text if isinstance(text, Template) else Template(text)
            for map_type, text in given.items()
        }
        if not self._templates:
            raise InvalidInput("source without a URL template: needs one")
        first = next(iter(self._templates.values()))
        self.name = name or first.text
        self.title = title or first.host
        self.attribution = attribution
        self.grid = grid
        self.date = date
        self.policy = policy
        self.map_types = self._map_types_of_templates()
        self.placeholder = placeholder
        self._alpha, self._encoded = alpha or encoded, encoded
        self._any_size = any_size and not encoded
        self._limits = {zoom: ends for zoom, *ends in limits}
        self.received: Received | None = None
        self._key = key or ""
        if not date and any("date" in template.names for template in self._templates.values()):
            raise InvalidInput(
                "source {0}: its URL has a {{date}}", self.title, field="date", remedy="say which"
            )
        self._fetched: Counter[str] = Counter()
        self._terms: dict[str, tuple[str, Policy]] = {}
        self._lock = threading.Lock()
        self._cache = cache if policy.cache_allowed else None
        self._stores: dict[str, TileStore] = {}
        connections = policy.connections(connections)
        self._client = client or Client(
            transport or RequestsTransport(connections),
            self.title,
            connections=connections,
            requests_per_s=policy.requests_per_s,
            first_after_s=policy.rest_s,
            secrets=(key,) if key else (),
        )

    def __repr__(self) -> str:
        return f"XYZSource({self.title!r}, {self.grid})"

    def parts(self, window: Window) -> list[Part]:
        """Tiles that fill ``window``."""
        return tile_parts(window, self.grid)

    def fetch(self, map_type: str, part: Window) -> PixelValues:
        """Pixels of a tile, (tile_px, tile_px, 3) uint8.

        Parameters
        ----------
        map_type : str
            One of ``map_types``; anything where that is empty.
        part : Window
            A tile of ``grid``.

        Raises
        ------
        InvalidInput
            ``part`` is no tile of the grid, or the map type is unknown.
        PartError, SourceError
            As for every source.
        Cancelled
            Within half a second of `close`.
        """
        tile = tile_address(part, self.grid, self.title)
        left, top, right, bottom = self._limits.get(tile.zoom, (tile.x, tile.y, tile.x, tile.y))
        if not (left <= tile.x <= right and top <= tile.y <= bottom):
            raise NotThere("{0}: beyond the tiles of {1}", tile, self.title)
        url = self._template(map_type).url(
            *tile, scale=self.grid.scale, map_type=map_type, date=self.date, key=self._key_needed(map_type)
        )

        counted: set[str] = set()

        def ask(
            headers: Mapping[str, str], read: Callable[[Response], PixelValues]
        ) -> tuple[Response, PixelValues]:
            return self._client.picture(
                url, str(tile), read, headers, lambda asked: self._count(asked, counted)
            )

        # What was read last, of the cache or of an answer, is what is returned.
        file = b""

        def read(body: bytes, headers: Mapping[str, str]) -> PixelValues:
            nonlocal file
            pixels, file = self._read(body, headers), body
            return pixels

        store = self._store(map_type)
        if store is not None:
            pixels = store.fetch(tile, ask, read, self._client.out_of_reach)
        else:
            _, pixels = ask({}, lambda response: read(response.body, response.headers))
        received = self.received
        if received is not None:
            received(part, file)
        return pixels

    def close(self) -> None:
        """End what is under way (it raises `Cancelled`) and free the connections."""
        self._client.close()
        with self._lock:
            self._cache = None
            stores = list(self._stores.values())
            self._stores.clear()
        for store in stores:
            store.close()

    def _read(self, body: bytes, headers: Mapping[str, str]) -> PixelValues:
        """Pixels of an answer or of a stored tile; raises PartError for what is no imagery."""
        self.placeholder.refuse(body, headers)
        size, kind = self.grid.tile_px, headers.get("content-type", "")
        try:
            pixels = decode(body, size, size, kind, alpha=self._alpha, any_size=self._any_size)
        except WrongSizeError as wrong:
            if not self._encoded:
                raise
            raise PartError(
                wrong, remedy=Message("write #tilesize={0} behind its address", wrong.message.values[0])
            ) from wrong
        self.placeholder.refuse_flat(pixels)
        return pixels

    def _store(self, map_type: str) -> TileStore | None:
        """Tiles kept of a map type; None where none are to be kept."""
        # A source without map types has the same tiles whatever they are asked for as.
        kept_as = map_type if self.map_types else ""
        with self._lock:
            if kept_as not in self._stores and self._cache is not None:
                own = self.grid.own
                self._stores[kept_as] = self._cache.store(
                    # A tile of the same number is another one in another plane.
                    self._template(map_type).text + (f"\n{astuple(own)}" if own else ""),
                    # A template may hold in its path what is not for everyone to see.
                    source=self._template(map_type).host if "{" in self.name else self.name,
                    title=f"{self.title} ({own.crs})" if own else self.title,
                    attribution=self.attribution,
                    map_type=kept_as,
                    date=self.date,
                    tile_px=self.grid.tile_px,
                )
            return self._stores.get(kept_as)

    def _map_types_of_templates(self) -> tuple[str, ...]:
        if "" not in self._templates:
            return tuple(self._templates)
        return MAP_TYPES if "map_type" in self._templates[""].names else ()

    def _template(self, map_type: str) -> Template:
        if self.map_types and map_type not in self.map_types:
            raise InvalidInput("map type {0!r}: {1} has {2}", map_type, self.title, ", ".join(self.map_types))
        return self._templates.get(map_type) or self._templates[""]

    def _key_needed(self, map_type: str) -> str:
        if not self._key and "key" in self._template(map_type).names:
            raise SourceError("{0}: needs an API key, and none is set", self.title)
        return self._key

    def _count(self, url: str, counted: set[str]) -> None:
        """Hold to the limit of the provider who is asked: a library's caller, odd templates and redirects, too.

        Parameters
        ----------
        url : str
            As it is sent.
        counted : set of str
            Providers of whom the tile was asked before, as attempts and redirects of theirs are no further tile.
        """
        title, policy = self._terms_of(host_of(url))
        if policy.bulk_allowed != "no" or title in counted:
            return
        counted.add(title)
        with self._lock:
            self._fetched[title] += 1
            policy.check(title, self._fetched[title])

    def _terms_of(self, host: str) -> tuple[str, Policy]:
        """Who is asked at a host, and under which terms: the source's own, but for a provider who allows no bulk."""
        found = self._terms.get(host)
        if found is None:
            if len(self._terms) >= _HOSTS:
                self._terms.clear()
            provider = serving(host)
            if provider is None or provider.policy.bulk_allowed != "no" or provider.policy == self.policy:
                found = self.title, self.policy
            else:
                found = provider.title, provider.policy
            self._terms[host] = found
        return found


def open_entry(entry: CatalogueEntry, date: str, key: str | None, options: SourceOptions) -> XYZSource:
    """Source of the tiles that an entry describes, of a date, asked for with a key."""
    return XYZSource(
        entry.templates(date),
        name=entry.name,
        title=entry.title,
        attribution=entry.credit(date),
        grid=entry.grid(options.tile_px),
        key=key,
        date=date,
        placeholder=entry.placeholder.with_files(options.placeholders),
        policy=entry.policy.shared(options.sharers),
        transport=options.transport,
        cache=options.cache,
        connections=options.connections,
        limits=entry.tile_limits,
        encoded=options.encoded,
        any_size=entry.any_size,
    )
