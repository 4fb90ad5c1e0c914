"""The sources TerrAInav knows by name, with what their providers allow, and how a source is opened."""

from __future__ import annotations

import datetime as dt
import difflib
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..errors import InvalidInput, SourceError
from ..geodesy.mercator import PixelGrid
from ..resources import read_json
from .decode import Placeholder
from .policy import Policy
from .source import Source
from .staticmap import GOOGLE_URL, StaticMapSource
from .template import Template
from .transport import Transport
from .xyz import XYZSource

#: Environment variable with the key of a user's own template.
KEY_ENV = "TERRAINAV_KEY"
KINDS = ("world", "xyz", "static-map")
#: Endings by which a name is known for a raster file that is not there, to say the right thing.
_RASTER_ENDINGS = frozenset(
    [".tif", ".tiff", ".vrt", ".jp2", ".img", ".png", ".jpg", ".jpeg", ".ecw", ".mbtiles", ".gpkg"]
)
#: Zooms of a user's own template when nothing is said of them.
_TEMPLATE_MAX_ZOOM = 22


@dataclass(frozen=True)
class Dates:
    """Dates a source's imagery can be had of.

    Parameters
    ----------
    kind : str
        ``day`` or ``year``: the form is YYYY-MM-DD or YYYY.
    first, default : str
    last : str or None
        None where it goes on.
    """

    kind: str
    first: str
    default: str
    last: str | None = None

    def __post_init__(self) -> None:
        self.checked(self.default)

    def checked(self, date: str) -> str:
        """Return ``date``, refused where it is of another form or out of range."""
        form = "YYYY-MM-DD" if self.kind == "day" else "YYYY"
        try:
            dt.date.fromisoformat(date if self.kind == "day" else f"{date}-01-01")
        except ValueError:
            right = False
        else:
            right = len(date) == len(form) and self.first <= date <= (self.last or "9999")
        if not right:
            raise InvalidInput(f"date {date!r}: must be {form}, from {self.first} to {self.last or 'now'}")
        return date


@dataclass(frozen=True)
class CatalogueEntry:
    """A source by name.

    Parameters
    ----------
    name, title, area, attribution : str
    kind : str
        world, xyz or static-map.
    map_types : tuple of str
    urls : mapping of map type to URL template
        Empty but for xyz.
    hosts : tuple of str
        Hosts the policy holds for, even in a user's own template; their subdomains as well.
    tile_px : tuple of int
        Sizes of tiles to choose from, the first by default.
    min_zoom, max_zoom, native_zoom : int
    dates : Dates or None
    policy : Policy
    placeholder : Placeholder
    key_env, secret_env : str or None
        Environment variables of the key, where one is needed, and of the signing secret.
    """

    name: str
    title: str
    kind: str
    area: str
    attribution: str
    map_types: tuple[str, ...]
    urls: Mapping[str, str]
    hosts: tuple[str, ...]
    tile_px: tuple[int, ...]
    min_zoom: int
    max_zoom: int
    native_zoom: int
    dates: Dates | None
    policy: Policy
    placeholder: Placeholder
    key_env: str | None = None
    secret_env: str | None = None

    @classmethod
    def from_dict(cls, name: str, data: Mapping[str, Any]) -> CatalogueEntry:
        """Entry of ``resources/sources.json``; raises InvalidInput on what is unknown or missing."""
        data = dict(data)
        terms = {field: data.pop(field) for field in Policy.__dataclass_fields__ if field in data}
        marks = dict(data.pop("placeholder", {}))
        dates = data.pop("dates", None)
        urls = dict(data.pop("urls", {}))
        try:
            return cls(
                name=name,
                urls=urls,
                map_types=tuple(data.pop("map_types", urls)),
                hosts=tuple(data.pop("hosts", ())),
                tile_px=tuple(data.pop("tile_px", (256, 512) if data["kind"] == "static-map" else (256,))),
                dates=Dates(**dates) if dates else None,
                policy=Policy(**terms),
                placeholder=Placeholder(
                    tuple(marks.pop("sha256", ())),
                    tuple((key, value) for key, value in marks.pop("header", {}).items()),
                    tuple((r, g, b) for r, g, b in marks.pop("flat_rgb", ())),
                    **marks,
                ),
                **data,
            )
        except (TypeError, KeyError) as wrong:
            raise InvalidInput(f"catalogue entry {name!r}: {wrong}") from wrong

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InvalidInput(
                f"catalogue entry {self.name!r} of kind {self.kind!r}: must be {', '.join(KINDS)}"
            )
        if not (self.title and self.attribution and self.policy.licence):
            raise InvalidInput(f"catalogue entry {self.name!r}: needs title, attribution and licence")
        if (self.kind == "xyz") != bool(self.urls):
            raise InvalidInput(f"catalogue entry {self.name!r}: URLs are for xyz, which needs them")
        if self.kind != "world" and not (self.policy.terms and self.policy.terms_url.startswith("https://")):
            raise InvalidInput(f"catalogue entry {self.name!r}: needs terms and terms_url")
        for url in self.urls.values():
            names = Template(url).names
            needed, stated = (
                ("date" in names, "key" in names),
                (self.dates is not None, self.key_env is not None),
            )
            if needed != stated:
                raise InvalidInput(
                    f"catalogue entry {self.name!r}: {{date}} needs dates, {{key}} needs key_env"
                )

    @property
    def bulk_allowed(self) -> str:
        """Whether much may be downloaded: yes, ask or no."""
        return self.policy.bulk_allowed

    @property
    def licence(self) -> str:
        """Licence of the imagery."""
        return self.policy.licence

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping of what a user may want to know."""
        plain = asdict(self)
        return {**plain, **plain.pop("policy")}

    def grid(self, tile_px: int | None = None) -> PixelGrid:
        """Pixel grid for a tile size; None for the entry's own."""
        size = tile_px or self.tile_px[0]
        if size not in self.tile_px:
            raise InvalidInput(f"tiles of {size} px: {self.title} has {', '.join(map(str, self.tile_px))}")
        return PixelGrid(size, self.min_zoom, self.max_zoom, self.native_zoom)

    def serves(self, host: str) -> bool:
        """Whether a host is this provider's."""
        return any(host == own or host.endswith("." + own) for own in self.hosts)

    def date(self, wanted: str | None) -> str:
        """Date of the imagery; empty where there is but one."""
        if self.dates is None:
            if wanted:
                raise InvalidInput(f"date {wanted!r}: {self.title} has no dates to choose from")
            return ""
        return self.dates.checked(wanted or self.dates.default)


def sources() -> tuple[CatalogueEntry, ...]:
    """Return the catalogue, the embedded world first."""
    table = read_json("sources.json")
    return tuple(CatalogueEntry.from_dict(name, data) for name, data in table.items())


def entry_named(name: str) -> CatalogueEntry:
    """Entry of a name, in any case.

    Raises
    ------
    InvalidInput
        Naming those that are close.
    """
    entries = {entry.name: entry for entry in sources()}
    if name.lower() in entries:
        return entries[name.lower()]
    close = difflib.get_close_matches(name.lower(), entries, n=3, cutoff=0.5)
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    raise InvalidInput(
        f"source {name!r} is unknown: {hint}`terrainav sources` lists the names; a URL template with {{z}}, "
        "{{x}}, {{y}} works as well"
    )


def is_template(name: str) -> bool:
    """Whether a source is named by its URL template."""
    return "://" in name or "{" in name


def open_source(
    name: str,
    *,
    seed: int = 2024,
    key: str | None = None,
    secret: str | None = None,
    date: str | None = None,
    tile_px: int | None = None,
    max_zoom: int | None = None,
    connections: int = 8,
    transport: Transport | None = None,
    plan_only: bool = False,
) -> Source:
    """Open a source by name.

    Parameters
    ----------
    name : str
        A name of the catalogue, or a URL template.
    seed : int
        Of the embedded world.
    key, secret : str or None
        API key and signing secret; None for those of the environment.
    date : str or None
        Of the imagery, where the source has several; None for its default.
    tile_px : int or None
        Size of tiles; None for the source's own, 256 for a template.
    max_zoom : int or None
        Highest zoom of a template; None for 22. Catalogue entries know theirs.
    connections : int
        Requests under way at once, where the provider allows so many.
    transport : Transport or None
        None for one of its own over requests.
    plan_only : bool
        The source's grid and terms are wanted, nothing will be fetched: no key is needed.

    Raises
    ------
    InvalidInput
        The name, date or tile size is unknown, or the template is not valid.
    SourceError
        A key is needed and missing.
    """
    if is_template(name):
        return _open_template(name, key, date, tile_px, max_zoom, connections, transport)
    if Path(name).suffix.lower() in _RASTER_ENDINGS or Path(name).is_file():
        raise InvalidInput(
            f"source {name}: raster files are not supported by this version; serve it as tiles, or take "
            "a source that `terrainav sources` lists"
        )
    entry = entry_named(name)
    if entry.kind == "world":
        from .world import WorldSource

        return WorldSource(seed)
    key = key or (os.environ.get(entry.key_env) if entry.key_env else None)
    if entry.key_env and not key and not plan_only:
        raise SourceError(f"{entry.title}: needs an API key: set the environment variable {entry.key_env}")
    grid, chosen = entry.grid(tile_px), entry.date(date)
    if entry.kind == "static-map":
        return StaticMapSource(
            key or "",
            secret or (os.environ.get(entry.secret_env) if entry.secret_env else None),
            scale=grid.scale,
            name=entry.name,
            title=entry.title,
            attribution=entry.attribution,
            policy=entry.policy,
            url=os.environ.get("TERRAINAV_GOOGLE_URL", GOOGLE_URL),
            transport=transport,
            connections=connections,
        )
    return XYZSource(
        entry.urls,
        name=entry.name,
        title=entry.title,
        attribution=entry.attribution.replace("{date}", chosen),
        grid=grid,
        key=key,
        date=chosen,
        placeholder=entry.placeholder,
        policy=entry.policy,
        transport=transport,
        connections=connections,
    )


def _open_template(
    text: str,
    key: str | None,
    date: str | None,
    tile_px: int | None,
    max_zoom: int | None,
    connections: int,
    transport: Transport | None,
) -> XYZSource:
    template = Template(text)
    highest = _TEMPLATE_MAX_ZOOM if max_zoom is None else max_zoom
    # A provider's terms hold however its tiles are asked for.
    known = next((entry for entry in sources() if entry.serves(template.host)), None)
    return XYZSource(
        template,
        attribution=known.attribution.replace("{date}", date or "") if known else "",
        grid=PixelGrid(tile_px or 256, max_zoom=highest, native_zoom=highest),
        key=key or os.environ.get(KEY_ENV),
        date=date or "",
        placeholder=known.placeholder if known else Placeholder(),
        policy=known.policy if known else Policy(),
        connections=connections,
        transport=transport,
    )


def check_policy(source: Source, requests: int, *, accept_terms: bool = False) -> None:
    """Refuse a run of more requests than the source's terms let pass.

    Parameters
    ----------
    source : Source
    requests : int
        Unique parts of the run, over all map types.
    accept_terms : bool
        The user has agreed to the terms.

    Raises
    ------
    SourceError
        Quoting the terms and, where nothing can be done about them, naming sources that allow it.
    """
    policy = getattr(source, "policy", None)
    if isinstance(policy, Policy):
        instead = tuple(entry.name for entry in sources() if entry.policy.bulk_allowed == "yes")
        policy.check(source.title, requests, accept_terms, instead)
