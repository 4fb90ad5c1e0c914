"""An entry of the catalogue: URLs, dates, grid and terms of a source; the shipped entries, and providers by host."""

from __future__ import annotations

import bisect
import datetime as dt
import html
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from functools import cache, lru_cache
from typing import Any
from urllib.parse import quote, unquote

from ..errors import InvalidInput, Message, OptionName
from ..geodesy.mercator import PixelGrid, extent_of_box
from ..geodesy.planes import ProjectedPlane
from ..limits import MAX_TILE_PX
from ..resources import read_json
from ..text.plain import listed
from .placeholder import Placeholder
from .policy import BULK, Policy
from .systems import WORLD_DEG, Bounds, project_box, read_plane
from .tiles import KEY_ENV, Template, url_host

_FORMS = {"day": "YYYY-MM-DD", "year": "YYYY"}
#: Kinds of sources, each with the module whose `open_entry` opens one. Modules are named and not imported, as they
#: import large libraries, and this room must not import the world.
PIXELS = {"world": "..world.source", "xyz": ".xyz", "static-map": ".staticmap"}
#: Types of the fields of an entry, and their names in errors.
_FIELD_TYPES: dict[str, tuple[tuple[type, ...], str]] = {
    **dict.fromkeys(
        (
            *("title", "kind", "area", "attribution", "key_env", "signing_env"),
            *("bulk_allowed", "licence", "terms", "terms_url"),
        ),
        ((str,), Message("text of one line")),
    ),
    **dict.fromkeys(
        ("min_zoom", "max_zoom", "native_zoom", "max_tiles", "max_connections"),
        ((int,), Message("a whole number")),
    ),
    "requests_per_s": ((int, float), Message("a number")),
    "cache_allowed": ((bool,), Message("true or false")),
    **dict.fromkeys(
        ("map_types", "hosts", "tile_px", "bounds_deg", "levels", "tile_limits"),
        ((list, tuple), Message("a list")),
    ),
    **dict.fromkeys(("urls", "dates", "placeholder", "plane"), ((Mapping,), Message("an object"))),
}
#: Names of sources.
NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


@dataclass(frozen=True)
class Dates:
    """Dates for which a source has imagery.

    Parameters
    ----------
    kind : str
        ``day``: every day, as YYYY-MM-DD; ``year``: every year, as YYYY; ``listed``: the dates of ``values``; ``any``:
        any text that the server accepts.
    first, last : str
        Empty if unknown or open.
    default : str
        Date used if none is given. Empty if a date must be given, for ``any`` only.
    values : mapping
        For ``listed``: maps each date to its form in the URL.
    """

    kind: str
    first: str = ""
    default: str = ""
    last: str = ""
    values: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        kinds = ("day", "year", "listed", "any")
        if self.kind not in kinds:
            raise InvalidInput("dates of kind {0!r}: must be one of {1}", self.kind, ", ".join(kinds))
        if (self.kind == "listed") != bool(self.values):
            raise InvalidInput("dates of kind {0!r}: values are for listed ones, which need them", self.kind)
        if not all(isinstance(text, str) for pair in self.values.items() for text in pair):
            raise InvalidInput("dates of kind {0!r}: values must be text", self.kind)
        if self.kind == "listed":
            object.__setattr__(self, "first", min(self.values))
            object.__setattr__(self, "last", max(self.values))
        if self.default or self.kind != "any":
            self.checked(self.default)

    def checked(self, date: str) -> str:
        """Return ``date``; raises InvalidInput for another form, or a date that is not available."""
        if self.kind == "listed":
            if date not in self.values:
                raise InvalidInput(
                    "date {0!r}: must be one of those there are, such as {1}",
                    date,
                    self._closest(date),
                    field="date",
                )
        elif self.kind == "any":
            if not date or not date.isprintable():
                raise InvalidInput(
                    "date {0!r}: must be one the server takes",
                    date,
                    field="date",
                    remedy=Message("say which{0}", OptionName("date").in_brackets),
                )
        elif not self._is_available(date):
            raise InvalidInput(
                "date {0!r}: must be {1}, from {2} to {3}",
                date,
                _FORMS[self.kind],
                self.first,
                self.last or Message("now"),
                field="date",
            )
        return date

    def written(self, date: str) -> str:
        """Form of a date in the URL."""
        return self.values.get(date, date)

    def text(self) -> Message:
        """Description for people."""
        default = Message("{0} by default", self.default) if self.default else Message("one must be asked for")
        if self.kind == "listed":
            if len(self.values) <= 6:
                return Message("{0}; {1}", ", ".join(sorted(self.values)), default)
            return Message("{0} from {1} to {2}; {3}", len(self.values), self.first, self.last, default)
        span = Message(" from {0} to {1}", self.first, self.last or Message("now")) if self.first else ""
        form = {
            "day": Message("every day"),
            "year": Message("every year"),
            "any": Message("as the server takes them"),
        }[self.kind]
        return Message("{0}{1}; {2}", form, span, default)

    def _is_available(self, date: str) -> bool:
        try:
            dt.date.fromisoformat(date if self.kind == "day" else f"{date}-01-01")
        except ValueError:
            return False
        return len(date) == len(_FORMS[self.kind]) and self.first <= date <= (self.last or _now())

    def _closest(self, date: str, count: int = 6) -> str:
        ordered = sorted(self.values)
        at = bisect.bisect(ordered, date)
        start = max(0, min(at - count // 2, len(ordered) - count))
        return ", ".join(ordered[start : start + count])


def _now() -> str:
    """Latest current date on Earth."""
    return (dt.datetime.now(dt.timezone.utc) + dt.timedelta(hours=14)).date().isoformat()


def time_dimension_dates(values: Iterable[str], default: str) -> Dates | None:
    """Dates of the time dimension of a WMS or WMTS layer.

    Parameters
    ----------
    values : iterable of str
        Single times, and intervals written ``first/last/step``.
    default : str
        Empty if the server states none.
    """
    times = [value.strip() for value in values if value.strip()]
    default = default.strip()
    intervals = [time.split("/") for time in times if "/" in time]
    if not times:
        return Dates("any", default=default) if default else None
    if not intervals:
        listed = {time: time for time in (*times, default) if time}
        return Dates("listed", default=default or max(times), values=listed)
    first, last = min(ends[0] for ends in intervals), max(ends[1] for ends in intervals)
    # Steps of ISO 8601.
    steps = {"P1D": "day", "P1Y": "year"}
    kinds = {steps.get(ends[2] if len(ends) == 3 else "") for ends in intervals}
    kind = kinds.pop() if len(kinds) == 1 and len(intervals) == len(times) else None
    pattern = {"day": r"\d{4}-\d\d-\d\d", "year": r"\d{4}"}.get(kind or "", "(?!)")
    if kind and re.fullmatch(f"{pattern} {pattern}", f"{first} {last}") and first <= (default or last) <= last:
        return Dates(kind, first, default or last, last)
    return Dates("any", first, default, last)


@dataclass(frozen=True)
class CatalogueEntry:
    """A source of the catalogue or of the user.

    Parameters
    ----------
    name, title, area, attribution : str
    kind : str
        world, xyz or static-map.
    map_types : tuple of str
        Empty if there is a single kind of picture.
    urls : mapping of map type to URL template
        For xyz only. The map type "" stands for a single kind of picture, or for a URL with {map_type}.
    hosts : tuple of str
        Hosts to which the policy applies, subdomains included, also in a user's template.
    tile_px : tuple of int
        Available tile sizes, the default first.
    min_zoom, max_zoom, native_zoom : int
    dates : Dates or None
    policy : Policy
    placeholder : Placeholder
    key_env, signing_env : str or None
        Environment variables of the key, if the source needs one, and of the signing secret.
    bounds_deg : tuple of float
        West, south, east, north of the ground for which the source is suggested as an alternative.
    levels : tuple of (zoom, name) pairs
        As in `Template`.
    plane : ProjectedPlane or None
        Plane divided into tiles, four times as many at each zoom; None for the Web-Mercator map.
    tile_limits : tuple of (zoom, first column, first row, last column, last row)
        Available tiles of a zoom, both ends included; other zooms extend over the whole plane.
    user : bool
        Whether a user has added the entry, which may then state less.
    any_size : bool
        Whether tiles of another size are resized to the grid's. Set by programs only, never in a file.
    """

    name: str
    title: str
    kind: str
    max_zoom: int
    native_zoom: int
    min_zoom: int = 0
    area: str = ""
    attribution: str = ""
    map_types: tuple[str, ...] = ()
    urls: Mapping[str, str] = field(default_factory=dict)
    hosts: tuple[str, ...] = ()
    tile_px: tuple[int, ...] = (256,)
    dates: Dates | None = None
    policy: Policy = field(default_factory=Policy)
    placeholder: Placeholder = field(default_factory=Placeholder)
    key_env: str | None = None
    signing_env: str | None = None
    bounds_deg: tuple[float, float, float, float] = WORLD_DEG
    levels: tuple[tuple[int, str], ...] = ()
    plane: ProjectedPlane | None = None
    tile_limits: tuple[tuple[int, int, int, int, int], ...] = ()
    user: bool = False
    any_size: bool = False

    @classmethod
    def from_dict(cls, name: str, data: Mapping[str, Any], *, user: bool = False) -> CatalogueEntry:
        """Entry of ``resources/sources.json``; raises InvalidInput for unknown, missing or wrong fields."""
        try:
            _check_types(data)
            # Null stands for the default.
            data = {field: value for field, value in data.items() if value is not None}
            terms = {field: data.pop(field) for field in Policy.__dataclass_fields__ if field in data}
            marks = dict(data.pop("placeholder", {}))
            dates = data.pop("dates", None)
            urls = dict(data.pop("urls", {}))
            plane = data.pop("plane", None)
            return cls(
                name=name,
                urls=urls,
                map_types=tuple(data.pop("map_types", [known for known in urls if known])),
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
                bounds_deg=tuple(data.pop("bounds_deg", WORLD_DEG)),
                levels=tuple((int(zoom), str(level)) for zoom, level in data.pop("levels", ())),
                plane=read_plane(plane) if plane else None,
                tile_limits=tuple(
                    (int(zoom), int(left), int(top), int(right), int(bottom))
                    for zoom, left, top, right, bottom in data.pop("tile_limits", ())
                ),
                user=user,
                **data,
            )
        except InvalidInput as wrong:
            raise InvalidInput("catalogue entry {0!r}: {1}", name, wrong, field=wrong.field) from wrong
        except (AttributeError, TypeError, KeyError, ValueError, OverflowError) as wrong:
            raise InvalidInput("catalogue entry {0!r}: wrong or missing: {1}", name, wrong) from wrong

    def __post_init__(self) -> None:
        if self.kind not in PIXELS:
            raise InvalidInput("kind {0!r}: must be one of {1}", self.kind, ", ".join(PIXELS))
        if (self.kind == "xyz") != bool(self.urls):
            raise InvalidInput("URLs are for xyz, which needs them")
        if not self.title:
            raise InvalidInput("needs a title")
        if not self.user:
            self._check_stated()
        west, south, east, north = self.bounds_deg
        if not (-180.0 <= west < east <= 180.0 and -90.0 <= south < north <= 90.0):
            raise InvalidInput("bounds {0}: must be west, south, east, north in degrees", self.bounds_deg)
        if not self.tile_px:
            raise InvalidInput("tile_px []: needs the width of its tiles, such as [256]")
        for size in self.tile_px:
            if size > MAX_TILE_PX:
                raise InvalidInput("tile size {0} px: must be {1} or less", size, MAX_TILE_PX)
            self.grid(size)
        for variable in (self.key_env, self.signing_env):
            if variable is not None and not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", variable):
                raise InvalidInput(
                    "environment variable {0!r}: must be letters, digits and underscores, such as {1}",
                    variable,
                    KEY_ENV,
                )
        self._check_urls()

    def _check_stated(self) -> None:
        if not (self.attribution and self.policy.licence):
            raise InvalidInput("needs attribution and licence")
        if self.kind != "world" and not (self.policy.terms and self.policy.terms_url.startswith("https://")):
            raise InvalidInput("needs terms and terms_url")

    def _check_urls(self) -> None:
        templates = [Template(url, levels=self.levels, plane=self.plane) for url in self.urls.values()]
        needed = {name: any(name in template.names for template in templates) for name in ("date", "key")}
        if needed["date"] != (self.dates is not None) or (needed["key"] and self.key_env is None):
            raise InvalidInput("{date} in a URL needs dates, {key} needs key_env")

    @property
    def listed(self) -> str:
        """Title and name, as lists show them."""
        return listed(self.name, self.title)

    @property
    def bulk_allowed(self) -> str:
        """Whether bulk downloads are allowed: yes, ask or no."""
        return self.policy.bulk_allowed

    @property
    def licence(self) -> str:
        """Licence of the imagery."""
        return self.policy.licence

    def to_dict(self) -> dict[str, Any]:
        """Fields of the entry, ready for JSON."""
        plain = asdict(self)
        return {**plain, **plain.pop("policy")}

    def to_data(self) -> dict[str, Any]:
        """Fields that differ from the defaults, for `from_dict`."""
        data = {
            one.name: getattr(self, one.name)
            for one in fields(self)
            if one.name not in ("name", "dates", "policy", "placeholder", "plane", "user", "any_size")
        }
        data["plane"] = None if self.plane is None else asdict(self.plane)
        data = {name: value for name, value in data.items() if value not in (None, "", (), {}, WORLD_DEG)}
        data.update(_differing(self.policy, Policy()))
        if self.dates is not None:
            data["dates"] = {"kind": self.dates.kind, **_differing(self.dates, Dates("any"))}
        return data

    def grid(self, tile_px: int | None = None) -> PixelGrid:
        """Pixel grid for a tile size; None for the default size."""
        size = tile_px or self.tile_px[0]
        if size not in self.tile_px:
            raise InvalidInput("tiles of {0} px: {1} has {2}", size, self.title, ", ".join(map(str, self.tile_px)))
        # Shipped entries state the bounds of a country; services state the bounds of the imagery.
        ends = self.user and self.bounds_deg != WORLD_DEG
        extent = extent_of_box(*self.bounds_deg) if ends else None
        # Static Maps limits the size of its pictures, and the decimals of their centres.
        more: dict[str, Any] = {"max_size_px": 640, "centre_decimals": 6} if self.kind == "static-map" else {}
        if self.plane is not None:
            box = None if self.bounds_deg == WORLD_DEG else project_box(self.plane, self.bounds_deg)
            extent, more = self._extent(box), {"plane": self.plane}
        elif self.tile_limits:
            extent = self._limited(extent)
        return PixelGrid(size, self.min_zoom, self.max_zoom, self.native_zoom, extent=extent, **more)

    def _limited(self, extent: tuple[tuple[float, float], ...] | None) -> tuple[tuple[float, float], ...] | None:
        """Part of an extent on the map that has tiles; unchanged if the extent crosses the antimeridian."""
        whole_map = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
        u, v = zip(*(extent or whole_map))
        if min(u) < 0.0 or max(u) > 1.0:
            return extent
        found = self._extent((min(u), min(v), max(u), max(v)))
        return extent if found == whole_map else found

    def _extent(self, stated: Bounds | None) -> tuple[tuple[float, float], ...] | None:
        """Corners of the extent of the tiles within a box, both as fractions of the plane; None for the whole plane."""
        boxes = [
            (left / (1 << zoom), top / (1 << zoom), (right + 1) / (1 << zoom), (bottom + 1) / (1 << zoom))
            for zoom, left, top, right, bottom in self.tile_limits
            if zoom == self.native_zoom
        ]
        boxes += [] if stated is None else [stated]
        if not boxes:
            return None
        west, north = (max(edges) for edges in list(zip(*boxes))[:2])
        east, south = (min(edges) for edges in list(zip(*boxes))[2:])
        # Ignore a box without any tile.
        if not (west < east and north < south):
            west, north, east, south = boxes[0]
        return ((west, north), (east, north), (east, south), (west, south))

    def date(self, wanted: str | None) -> str:
        """Date of the imagery, by default the default; empty if the source has only one."""
        if self.dates is None:
            if wanted:
                raise InvalidInput("date {0!r}: {1} has no dates to choose from", wanted, self.title, field="date")
            return ""
        if not wanted and not self.dates.default:
            raise InvalidInput(
                "{0}: has imagery of several dates",
                self.title,
                field="date",
                remedy=Message("say which{0}", OptionName("date").in_brackets),
            )
        return self.dates.checked(wanted or self.dates.default)

    def templates(self, date: str) -> dict[str, Template]:
        """Templates of the tiles of a date, by map type."""
        written = self.dates.written(date) if self.dates else ""
        return {
            map_type: Template(
                url.replace("{date}", quote(written, safe=":/&=,.")), levels=self.levels, plane=self.plane
            )
            for map_type, url in self.urls.items()
        }

    def credit(self, date: str) -> str:
        """Attribution of the imagery of a date."""
        return self.attribution.replace("{date}", date)

    def covers(self, bounds_deg: tuple[float, float, float, float]) -> bool:
        """Whether the entry's bounds contain a box of west, south, east, north."""
        west, south, east, north = self.bounds_deg
        return bounds_deg[0] >= west and bounds_deg[1] >= south and bounds_deg[2] <= east and bounds_deg[3] <= north


def _differing(value: Policy | Dates, default: Policy | Dates) -> dict[str, Any]:
    """Fields that differ from the default."""
    return {name: stated for name, stated in asdict(value).items() if stated != getattr(default, name)}


def _check_types(data: Mapping[str, Any]) -> None:
    """Refuse unknown and missing fields, and values of another type; errors use the terms of JSON."""
    required = ("title", "kind", "min_zoom", "max_zoom", "native_zoom")
    for name in required:
        if name not in data:
            raise InvalidInput("{0} is missing", name, field=name)
    for one, value in data.items():
        if one not in _FIELD_TYPES:
            raise InvalidInput("{0!r} is unknown; known are {1}", one, ", ".join(_FIELD_TYPES))
        types, words = _FIELD_TYPES[one]
        # A bool is an int in Python.
        right = isinstance(value, types) and (bool in types or not isinstance(value, bool))
        if isinstance(value, str):
            right = right and value.isprintable()
        if value is None:
            right = one not in required
        if not right:
            raise InvalidInput("{0} {1!r}: must be {2}", one, value, words, field=one)
    for one, kind, words in (
        ("urls", str, Message("text")),
        ("hosts", str, Message("text")),
        ("tile_px", int, Message("whole numbers")),
    ):
        values = data.get(one) or ()
        for value in values.values() if isinstance(values, Mapping) else values:
            if not isinstance(value, kind):
                raise InvalidInput("{0} with {1!r}: must be {2}", one, value, words, field=one)


def shipped() -> tuple[CatalogueEntry, ...]:
    """Return the entries of ``resources/sources.json``, the embedded world first."""
    return tuple(map(shipped_entry, shipped_data()))


@lru_cache(maxsize=1)
def shipped_data() -> Mapping[str, Mapping[str, Any]]:
    """Content of ``resources/sources.json``: the fields of each source, by name."""
    data: Mapping[str, Mapping[str, Any]] = read_json("sources.json")
    return data


@cache
def shipped_entry(name: str) -> CatalogueEntry:
    """Entry of ``resources/sources.json`` by name."""
    return CatalogueEntry.from_dict(name, shipped_data()[name])


def serving(host: str) -> CatalogueEntry | None:
    """Shipped entry of the provider of a host, or None."""
    for name, data in shipped_data().items():
        if any(host == domain or host.endswith("." + domain) for domain in data.get("hosts", ())):
            return shipped_entry(name)
    return None


def find_providers(text: str) -> tuple[CatalogueEntry, ...]:
    """Shipped entries of the providers whose hosts occur in the addresses of a text, in any spelling.

    Parameters
    ----------
    text : str
        An address, or text with addresses, such as a data source of QGIS, a name of GDAL, or XML. User names,
        passwords, ports, percent-encoding, XML entities and placeholders do not matter.
    """
    # User, host and port of an address, after one or more slashes. A single letter before the colon is a drive.
    authority = r"(?<=[A-Za-z0-9+.-]{2}):[/\\]{1,9}([^\s/\\?#&|'\"<>,]+)"
    # Placeholders of templates, such as ${z}, {switch:a,b} and [1-4].
    placeholder = r"\$?\{[\w:,.-]*\}|\[\w-\w\]"
    found: dict[str, None] = {}
    for written in _readings(text):
        found.update(dict.fromkeys(re.findall(authority, re.sub(placeholder, "0", written))))
    hosts = dict.fromkeys(url_host(f"//{authority.rpartition('@')[2]}") for authority in found)
    known = map(serving, hosts)
    return tuple({one.name: one for one in known if one is not None}.values())


def _readings(text: str) -> list[str]:
    """Return a text, and the text decoded up to three times, as data sources may be nested."""
    readings = [text]
    for decode in (html.unescape, unquote):
        for written in list(readings):
            for _ in range(3):
                decoded = decode(written)
                if decoded == written:
                    break
                readings.append(written := decoded)
    return readings


def strictest(providers: Iterable[CatalogueEntry]) -> CatalogueEntry | None:
    """The provider with the strictest terms; None without providers."""
    return max(
        providers,
        key=lambda one: (BULK.index(one.policy.bulk_allowed), -(one.policy.max_tiles or 0)),
        default=None,
    )


def under_provider(entry: CatalogueEntry) -> CatalogueEntry:
    """Return an entry with its provider's terms, which apply in whatever way tiles are requested."""
    templates = (Template(url, levels=entry.levels, plane=entry.plane) for url in entry.urls.values())
    hosts = (host for template in templates for host in template.hosts)
    known = strictest(provider for provider in map(serving, hosts) if provider is not None)
    if known is None:
        return entry
    return replace(
        entry,
        policy=known.policy,
        placeholder=known.placeholder.extended(entry.placeholder.sha256),
        attribution=entry.attribution or known.attribution,
    )
