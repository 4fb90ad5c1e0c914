"""Tiles by URL template."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import astuple
from functools import partial
from http import HTTPStatus

from ..arrays import PixelValues
from ..errors import InvalidInput, Message, PartError, SourceError
from ..geodesy.mercator import PixelGrid
from ..map_types import MAP_TYPES
from .cache.tile_cache import TileCache
from .cache.tilestore import Kept, NoStore
from .decode import WrongSizeError, read_answer
from .entry import CatalogueEntry, serving
from .http.client import Client, NotThere, OutOfReach
from .http.requests_transport import RequestsTransport
from .http.transport import Response, Transport
from .opening import SourceOptions
from .placeholder import Placeholder, Received
from .policy import Policy
from .source import Part, Window, tile_parts
from .tiles import Template, Tile, tile_address, url_host


class XYZSource:
    """Tiles by URL template, of 256 px or a multiple, as PNG, JPEG, WebP or GIF.

    Parameters
    ----------
    templates : str, Template, or mapping of map type to either
    name, title, attribution : str
        By default, the name is the template, and the title its host.
    grid : PixelGrid
        Tile size and zooms.
    key : str or None
        Value of {key}.
    date : str
        Value of {date}.
    placeholder : Placeholder
    policy : Policy
    client : Client or None
        None to create a client that uses ``transport``.
    transport : Transport or None
        None to create a `RequestsTransport`.
    connections : int
        Most simultaneous requests; the policy may allow fewer.
    cache : TileCache or None
        Keeps tiles for later runs, if the policy allows it; None to keep none.
    limits : tuple
        Available tiles; see `CatalogueEntry.tile_limits`.
    alpha : bool
        Whether to return the alpha channel of tiles, which are then laid over other pixels.
    encoded : bool
        Whether colours encode numbers such as heights: tiles have alpha and are never resized.
    any_size : bool
        See `CatalogueEntry.any_size`.

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
            map_type: text if isinstance(text, Template) else Template(text) for map_type, text in given.items()
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
        self.map_types = self._template_map_types()
        self.placeholder = placeholder
        self._alpha, self._encoded = alpha or encoded, encoded
        self._any_size = any_size and not encoded
        self._limits = {zoom: ends for zoom, *ends in limits}
        self.received: Received | None = None
        self._key = key or ""
        if not date and any("date" in template.names for template in self._templates.values()):
            raise InvalidInput("source {0}: its URL has a {{date}}", self.title, field="date", remedy="say which")
        self._fetched: Counter[str] = Counter()
        self._terms: dict[str, tuple[str, Policy]] = {}
        self._lock = threading.Lock()
        self._cache = cache if policy.cache_allowed else None
        self._stores: dict[str, NoStore] = {}
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
            One of ``map_types``; any text if there are none.
        part : Window
            A tile of ``grid``.

        Raises
        ------
        InvalidInput
            ``part`` is not a tile of the grid, or the map type is unknown.
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
        file, pixels = self._tile(tile, url, self._store(map_type))
        received = self.received
        if received is not None:
            received(part, file)
        return pixels

    def close(self) -> None:
        """End running requests, which raise `Cancelled`, and close connections and stores."""
        self._client.close()
        with self._lock:
            self._cache = None
            stores = list(self._stores.values())
            self._stores.clear()
        for store in stores:
            store.close()

    def _tile(self, tile: Tile, url: str, store: NoStore) -> tuple[bytes, PixelValues]:
        """Return file and pixels of a tile: stored if fresh or confirmed by the server, otherwise the server's."""
        kept = store.find(tile)
        stored = None if kept is None else self._stored_pixels(tile, kept, store)
        if kept is None or stored is None:
            response, pixels = self._client.picture(url, tile, self._read, allow=partial(self._count, set()))
            store.keep(tile, response)
            return response.body, pixels
        stale_allowed = kept.freshness.stale_allowed
        if not store.is_fresh(kept) and not (stale_allowed and self._client.out_of_reach()):
            try:
                conditions, allow = kept.freshness.conditions(), partial(self._count, set())
                response, changed = self._client.picture(url, tile, self._read_change, conditions, allow)
            except OutOfReach:
                if not stale_allowed:
                    raise
            except NotThere:
                store.remove(tile)
                raise
            else:
                if changed is not None:
                    store.keep(tile, response)
                    return response.body, changed
                store.renew(tile, kept, response.headers)
                return kept.body, stored
        store.note_use(tile, kept)
        return kept.body, stored

    def _stored_pixels(self, tile: Tile, kept: Kept, store: NoStore) -> PixelValues | None:
        """Pixels of a stored tile; None if it has no imagery, and the tile is removed."""
        try:
            return self._read(Response(HTTPStatus.OK, {}, kept.body))
        except PartError:
            store.remove(tile)
            return None

    def _read_change(self, response: Response) -> PixelValues | None:
        """Pixels of an answer; None if it confirms the stored tile (304)."""
        return None if response.status == HTTPStatus.NOT_MODIFIED else self._read(response)

    def _read(self, response: Response) -> PixelValues:
        """Pixels of a tile; raises PartError for an answer without imagery."""
        size = self.grid.tile_px
        try:
            return read_answer(response, size, size, self.placeholder, alpha=self._alpha, any_size=self._any_size)
        except WrongSizeError as wrong:
            if not self._encoded:
                raise
            raise PartError(
                wrong, remedy=Message("write #tilesize={0} behind its address", wrong.message.values[0])
            ) from wrong

    def _store(self, map_type: str) -> NoStore:
        """Store of the tiles of a map type."""
        # A source without map types has the same tiles for every map type.
        kept_as = map_type if self.map_types else ""
        with self._lock:
            store = self._stores.get(kept_as)
            if store is None:
                store = self._stores[kept_as] = self._opened_store(kept_as)
            return store

    def _opened_store(self, map_type: str) -> NoStore:
        if self._cache is None:
            return NoStore()
        template, plane = self._template(map_type), self.grid.plane
        key, title = template.text, self.title
        if not plane.wraps:
            # In another plane, the same numbers address another tile, so the plane is part of the key.
            key, title = f"{key}\n{astuple(plane)}", f"{title} ({plane.crs})"
        return self._cache.store(
            key,
            # Do not write the template, whose path may hold secrets.
            source=template.host if "{" in self.name else self.name,
            title=title,
            attribution=self.attribution,
            map_type=map_type,
            date=self.date,
            tile_px=self.grid.tile_px,
        )

    def _template_map_types(self) -> tuple[str, ...]:
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

    def _count(self, counted: set[str], url: str) -> None:
        """Count a request, and check it against the limit of the provider that receives it, also after a redirect.

        Parameters
        ----------
        counted : set of str
            Providers already requested for this tile, so that further attempts and redirects do not count.
        url : str
            URL of the request.
        """
        title, policy = self._host_terms(url_host(url))
        if policy.bulk_allowed != "no" or title in counted:
            return
        counted.add(title)
        with self._lock:
            self._fetched[title] += 1
            policy.check(title, self._fetched[title])

    def _host_terms(self, host: str) -> tuple[str, Policy]:
        """Return title and terms for a host: the source's, unless the host's provider forbids bulk downloads."""
        found = self._terms.get(host)
        if found is None:
            # A template has a few hosts, but redirects may lead to any number of hosts.
            if len(self._terms) >= 64:
                self._terms.clear()
            provider = serving(host)
            if provider is None or provider.policy.bulk_allowed != "no" or provider.policy == self.policy:
                found = self.title, self.policy
            else:
                found = provider.title, provider.policy
            self._terms[host] = found
        return found


def open_entry(entry: CatalogueEntry, date: str, key: str | None, options: SourceOptions) -> XYZSource:
    """Open the source described by an entry, for a date and with a key."""
    return XYZSource(
        entry.templates(date),
        name=entry.name,
        title=entry.title,
        attribution=entry.credit(date),
        grid=entry.grid(options.tile_px),
        key=key,
        date=date,
        placeholder=entry.placeholder.extended(options.placeholders),
        policy=entry.policy.shared(options.sharers),
        transport=options.transport,
        cache=options.cache,
        connections=options.connections,
        limits=entry.tile_limits,
        encoded=options.encoded,
        any_size=entry.any_size,
    )
