"""Sources for planning, capturing and display, and their terms of use."""

from __future__ import annotations

import html
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import quote

from qgis.core import QgsProject

from ..core.errors import InvalidInput, SourceError, TerrAInavError
from .credentials import credential_problem, read_key
from .form.mission_form import FormError
from .i18n import number_text, tr, translate
from .qgis_source.connections import Connection, connection, is_connection
from .qgis_source.snapshot import Snapshot, grid_of_layers, is_of_qgis, policies_of_layers, take_snapshot
from .qgis_source.source import LayerSource
from .settings import Settings, credential_home

if TYPE_CHECKING:
    from ..core.bands import Bands
    from ..core.geodesy.mercator import PixelGrid
    from ..core.imagery.http.transport import Transport
    from ..core.imagery.opening import NamedSource, SourceOptions
    from ..core.imagery.policy import Policy
    from ..core.imagery.source import Source
    from ..core.mission.estimate import Costs, Summary
    from ..core.mission.mission import Mission
    from ..core.mission.plan import Plan
    from ..core.mission.relief.ground import Heights
    from .network.transport import QgisTransport


class MissionPlans(NamedTuple):
    """A mission and its plan, or its plans by the names of several imageries.

    Parameters
    ----------
    mission : Mission
    by_imagery : dict of str to Plan
        One plan with an empty name, unless the mission has several imageries.
    """

    mission: Mission
    by_imagery: dict[str, Plan]

    @property
    def first(self) -> Plan:
        """Plan of the first imagery; all plans have the same flight."""
        return next(iter(self.by_imagery.values()))

    @property
    def captured(self) -> Mission:
        """Mission as its dataset has it."""
        return self.mission if self.mission.imagery.imageries else self.first.mission

    @property
    def images(self) -> int:
        """Number of images, of all map types and imageries."""
        return sum(self.images_each.values())

    @property
    def images_each(self) -> dict[str, int]:
        """Number of images of each imagery, of all map types."""
        return {name: len(plan) * len(plan.mission.imagery.map_types) for name, plan in self.by_imagery.items()}

    @property
    def requests(self) -> dict[str, int]:
        """Number of requests for each imagery, with those for others under the same terms."""
        from ..core.imagery.catalogue import shared_requests

        own = {name: one.requests * len(one.mission.imagery.map_types) for name, one in self.by_imagery.items()}
        if len(own) == 1:
            return own
        missions = {name: one.mission for name, one in self.by_imagery.items()}
        named = [name for name, one in missions.items() if not is_of_qgis(one.imagery.source)]
        asked = [(_named(missions[name].imagery.source, _options(missions[name])), own[name]) for name in named]
        # The layers of a project are under the terms of their own servers.
        return {**own, **dict(zip(named, shared_requests(asked)))}

    def are_in(self, folder: Path) -> bool | None:
        """Whether a folder is a dataset of the mission; None without a readable mission."""
        from ..core.capture.folder import captured_mission, holds_mission

        several = bool(self.mission.imagery.imageries)
        return holds_mission(self.mission if several else captured_mission(self.first), folder)


def each_imagery(mission: Mission) -> dict[str, Mission]:
    """Missions by the names of several imageries; the mission itself, with an empty name, if it has one."""
    return mission.missions_by_imagery or {"": mission}


WORLD = "world"
#: Public elevation tiles.
TERRARIUM = "terrarium"


def mission_grid(mission: Mission) -> PixelGrid:
    """Pixel grid of a mission's source; on the main thread if QGIS draws it.

    Raises
    ------
    FormError
        For the field ``source``, ``date`` or ``crs`` if there is no such source; for ``bands`` or ``stretch`` if the
        source does not allow them.
    """
    from ..core.imagery.systems import refused

    try:
        _check_bands(mission)
        if is_of_qgis(mission.imagery.source):
            grid = grid_of_layers(mission.imagery.source, QgsProject.instance())
            if mission.imagery.crs not in ("", grid.plane.crs):
                raise refused(mission.imagery.crs, tr("this map of QGIS"), [grid.plane.crs])
            return grid
        return _named(mission.imagery.source, _options(mission)).grid
    except (InvalidInput, SourceError) as wrong:
        entry = wrong.field if wrong.field in ("date", "crs", "bands", "stretch", "sun") else "source"
        raise FormError({entry: translate(wrong)}) from wrong


def mission_bands(mission: Mission) -> Bands:
    """Bands of a mission's images; red, green and blue if QGIS draws the source or has the connection."""
    from ..core.bands import RGB

    if is_of_qgis(mission.imagery.source) or is_connection(mission.imagery.source):
        return RGB
    return _named(mission.imagery.source, _options(mission)).bands


def grid_finder(mission: Mission) -> Callable[[], PixelGrid]:
    """Return a function that returns `mission_grid` on any thread. Call on the main thread, which owns layers."""
    if not (is_of_qgis(mission.imagery.source) or is_connection(mission.imagery.source)):
        return lambda: mission_grid(mission)
    try:
        grid = mission_grid(mission)
    except FormError as wrong:
        refusal = wrong

        def refuse() -> PixelGrid:
            raise refusal

        return refuse
    return lambda: grid


def grid_finders(mission: Mission) -> dict[str, Callable[[], PixelGrid]]:
    """Results of `grid_finder` for each imagery. Call on the main thread."""
    return {name: grid_finder(one) for name, one in each_imagery(mission).items()}


def plan_imageries(mission: Mission, find_grids: dict[str, Callable[[], PixelGrid]]) -> MissionPlans:
    """Plans of a mission for each of its imageries; on any thread.

    Raises
    ------
    InvalidInput, SourceError
        As from `plan_mission`; with the name of the imagery, unless it is the first.
    """
    plans: dict[str, Plan] = {}
    for name, one in each_imagery(mission).items():
        try:
            plan = plan_mission(one, find_grids[name])
            if plans and plan.imagery.share == 0.0:
                raise InvalidInput(tr("its source has no imagery of the area"))
        except TerrAInavError as wrong:
            if not plans:
                raise
            # Entries of the panel are of the first imagery.
            reason = next(iter(wrong.messages.values())) if isinstance(wrong, FormError) else wrong
            raise InvalidInput("{0}: {1}", name, reason, field="imageries") from wrong
        plans[name] = plan
    return MissionPlans(mission, plans)


def plan_mission(mission: Mission, find_grid: Callable[[], PixelGrid]) -> Plan:
    """Plan of a mission, over its relief if any; on any thread.

    Raises
    ------
    InvalidInput, SourceError
        As from `plan`; or the heights cannot be read.
    """
    from ..core.mission.plan import plan

    grid = find_grid()
    return plan(mission, grid, mission_heights(mission))


def mission_heights(mission: Mission) -> Heights | None:
    """Heights of a mission's relief, on any thread; None if it has no relief.

    Raises
    ------
    InvalidInput, SourceError
        The heights cannot be read.
    """
    sources = (*mission.terrain.elevation, *mission.terrain.surface)
    if not sources:
        return None
    from ..core.imagery.opening import SourceOptions
    from ..core.picture.heights import mission_heights

    is_fetched = any("://" in text or text == TERRARIUM for text in sources)
    options = SourceOptions(
        seed=mission.imagery.seed,
        connections=Settings().connections,
        transport=source_transport("") if is_fetched else None,
        cache=Settings().tile_cache(),
    )
    return mission_heights(mission, options)


def request_costs(name: str) -> Costs:
    """Cost of a request to a source, as assumed for estimates."""
    from ..core.imagery.opening import source_kind
    from ..core.mission.estimate import FROM_FILE, OFFLINE, ONLINE

    if is_of_qgis(name):
        return OFFLINE
    if is_connection(name):
        return ONLINE
    source = _named(name)
    if source.is_local:
        return FROM_FILE if source_kind(name).is_file else OFFLINE
    # The terms of a service are in its capabilities, which are not requested for an estimate.
    policy = source.stated_policy
    return ONLINE if policy is None else replace(ONLINE, requests_per_s=policy.requests_per_s)


def plan_summary(plan: Plan) -> Summary:
    """Figures of a plan, with the times of this machine's processors and of the connections chosen; on any thread."""
    from ..core.mission.estimate import estimate

    name, connections = plan.mission.imagery.source, Settings().connections
    stated = None if is_of_qgis(name) or is_connection(name) or _named(name).is_local else _named(name).stated_policy
    connections = connections if stated is None else stated.connections(connections)
    return estimate(plan, request_costs(name), connections, os.cpu_count() or 1)


def source_policy(name: str) -> Policy | None:
    """Terms of a source's provider; None if there are none, or if they must be requested."""
    if is_of_qgis(name):
        return next(iter(policies_of_layers(name, QgsProject.instance())), (None, ""))[0]
    source = _named(name)
    return None if source.is_local else source.stated_policy


def mission_snapshot(mission: Mission) -> Snapshot | None:
    """Snapshot of the layers that QGIS draws for a mission; None for other sources. Main thread only.

    Raises
    ------
    InvalidInput
        The project has no such layer.
    """
    return take_snapshot(mission.imagery.source, QgsProject.instance()) if is_of_qgis(mission.imagery.source) else None


def open_for_capture(
    mission: Mission,
    key: str | None,
    *,
    transport: Transport | None = None,
    snapshot: Snapshot | None = None,
    placeholders: tuple[str, ...] = (),
) -> Source:
    """Source of a mission, ready to fetch; raises InvalidInput or SourceError.

    Tiles whose SHA-256 is in ``placeholders`` or in the settings count as missing.
    """
    if snapshot is not None:
        return LayerSource(snapshot)
    options = _options(
        mission,
        key=key,
        transport=transport,
        cache=Settings().tile_cache(),
        placeholders=(*Settings().missing_tiles, *placeholders),
    )
    return _named(mission.imagery.source, options).open()


def source_transport(source: str, connections: int | None = None) -> QgisTransport:
    """Transport for a source, with the authentication that the user has chosen for the source.

    Parameters
    ----------
    source : str
        Name of the source, as in a mission.
    connections : int or None
        Largest number of connections; None for the number in the settings.

    Raises
    ------
    InvalidInput
        QGIS has no such connection.
    """
    from .network.transport import QgisTransport

    settings = Settings()
    wanted = settings.connections if connections is None else connections
    if is_connection(source):
        known = connection(source)
        return QgisTransport(wanted, authcfg=known.authcfg, headers=known.headers, home=credential_home(known.url))
    return QgisTransport(wanted, authcfg=authcfg_of_requests(source), home=credential_home(source))


def authcfg_of_requests(source: str) -> str:
    """Id of the configuration that authenticates a source's requests; empty if there is none, or it holds the key."""
    return "" if needs_key(source) else Settings().authcfg(source)


def source_key(source: str) -> str | None:
    """API key that the user has chosen for a source; None if the source needs no key. Main thread only."""
    return read_key(Settings().authcfg(source)) if needs_key(source) else None


def credentials_problem(source: str) -> str:
    """Reason why a run cannot use a source's key or authentication; empty if it can.

    Main thread only: QGIS may ask for its master password.
    """
    if is_connection(source):
        return credential_problem(connection(source).authcfg, is_key=False)
    authcfg, is_key = Settings().authcfg(source), needs_key(source)
    # A key may also be in the command's environment variable, for the hosts that the user has named there.
    if is_key and not authcfg:
        try:
            if _named(source).environment_key():
                return ""
        except SourceError as wrong:
            return translate(wrong)
    return credential_problem(authcfg, is_key)


def needs_key(source: str) -> bool:
    """Whether a source's addresses contain a key; makes no request."""
    if is_connection(source) or is_of_qgis(source):
        return False
    try:
        return _named(source).needs_key
    except InvalidInput:
        return False


def _options(mission: Mission, **how: Any) -> SourceOptions:
    """Options for opening a mission's source."""
    from ..core.imagery.opening import SourceOptions
    from ..core.mission.sunlight import mission_sun

    return SourceOptions(
        seed=mission.imagery.seed,
        sun=mission_sun(mission),
        date=mission.imagery.date or None,
        crs=mission.imagery.crs,
        area_deg=mission.area.bounds.edges_deg,
        connections=Settings().connections,
        bands=mission.imagery.bands,
        stretch=mission.imagery.stretch,
        as_stored=mission.output.image_format == "tif",
        **how,
    )


def _check_bands(mission: Mission) -> None:
    """Refuse bands, a stretch and a sun that are impossible if QGIS draws the source or has the connection."""
    from ..core.imagery.opening import check_colours, check_sun
    from ..core.mission.sunlight import mission_sun

    imagery = mission.imagery
    if is_of_qgis(imagery.source) or is_connection(imagery.source):
        check_colours(imagery.source, imagery.bands, imagery.stretch)
        check_sun(imagery.source, mission_sun(mission))


def _named(name: str, options: SourceOptions | None = None) -> NamedSource:
    """Source from its name, which may name a QGIS connection."""
    from ..core.imagery.opening import DescribedSource, SourceOptions, named_source

    options = options or SourceOptions()
    if is_connection(name):
        known = connection(name)
        return DescribedSource(known.entry(), replace(options, key=known.key or None))
    return named_source(name, options)


def terms_problem(mission: Mission, requests: int) -> tuple[str, bool] | None:
    """Terms that forbid a run, as HTML, and whether the user's consent is enough; None if they allow the run."""
    from ..core.imagery.catalogue import alternatives
    from ..core.imagery.policy import TermsError

    if is_of_qgis(mission.imagery.source):
        terms = policies_of_layers(mission.imagery.source, QgsProject.instance())
    else:
        source = _named(mission.imagery.source, _options(mission))
        terms = [(source.policy, source.title)]
    try:
        for policy, title in terms:
            policy.check(title, requests)
    except TermsError as wrong:
        refused = wrong
    else:
        return None
    policy, title, can_agree = refused.policy, refused.title, refused.can_agree
    text = (
        tr("{title}: {requests} requests. Over {most} requests require accepting the terms.")
        if can_agree
        else tr("{title}: {requests} requests, but its terms allow {most}.")
    )
    text = text.format(title=title, requests=number_text(requests), most=number_text(policy.max_tiles))
    quoted = "{text} <i>{terms}</i> (<a href='{url}'>{url}</a>). ".format(
        text=html.escape(text), terms=html.escape(policy.terms), url=html.escape(policy.terms_url)
    )
    if can_agree:
        return quoted, True
    others = alternatives(mission.imagery.map_types, mission.area.bounds.edges_deg)
    instead = ", ".join(map(translate, others))
    return quoted + html.escape(tr("Sources that allow it: {names}.").format(names=instead)), False


def tile_layer_uri(name: str, map_type: str, date: str = "") -> str:
    """Data source of a QGIS layer that shows a source's tiles.

    Raises
    ------
    InvalidInput
        The source cannot be shown as a tile layer.
    """
    known = connection(name) if is_connection(name) else None
    entry = _named(name).entry
    chosen = entry.date(date or None)
    if not entry.urls:
        raise InvalidInput(
            tr("{title} has no tiles to show as a background; show another source and come back").format(
                title=entry.title
            )
        )
    templates = entry.templates(chosen)
    template = templates.get(map_type) or next(iter(templates.values()))
    if "key" in template.names:
        raise InvalidInput(
            tr("{host} needs a key, which would be written into the project file: show another source").format(
                host=template.host
            )
        )
    if template.plane is not None:
        raise InvalidInput(
            tr(
                "{title} has tiles in {crs}, which cannot be a background: add its layer with QGIS's Browser panel"
            ).format(title=entry.title, crs=template.plane.crs)
        )
    if template.levels:
        raise InvalidInput(
            tr("{title} numbers its zooms differently from QGIS: add its layer with QGIS's Browser panel").format(
                title=entry.title
            )
        )
    grid = entry.grid()
    url = template.text
    filled = {
        "{s}": template.subdomains[0] if template.subdomains else "",
        "{r}": "" if grid.scale == 1 else f"@{grid.scale}x",
        "{map_type}": map_type,
        "{date}": chosen,
    }
    for placeholder, value in filled.items():
        url = url.replace(placeholder, value)
    # Leave braces, which QGIS needs as they are, and encode the rest, which QGIS decodes once.
    address = quote(url, safe=":/{}?=,;@+$!*'()~")
    uri = f"type=xyz&url={address}&zmin={grid.min_zoom}&zmax={grid.max_zoom}&tilePixelRatio={grid.scale}"
    return uri + _authenticated(name, known)


def _authenticated(name: str, known: Connection | None) -> str:
    """Parameters of a layer's data source for authentication: a configuration's id, without secrets; and a referer."""
    authcfg = authcfg_of_requests(name) if known is None else known.authcfg
    referer = "" if known is None else known.headers.get("Referer", "")
    known_by = f"&authcfg={authcfg}" if authcfg else ""
    return f"{known_by}&referer={quote(referer, safe='')}" if referer else known_by
