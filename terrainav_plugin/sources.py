"""Sources to plan with, to capture from and to show, and what their terms say."""

from __future__ import annotations

import html
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING
from urllib.parse import quote

from qgis.core import QgsApplication, QgsAuthMethodConfig, QgsProject

from ..core.errors import InvalidInput, SourceError
from .dock import mission_form
from .dock.choices import CameraChoice
from .dock.mission_form import FormError
from .i18n import tr
from .layers.snapshot import Snapshot, grid_of_layers, is_of_qgis, take_snapshot
from .layers.source import LayerSource

if TYPE_CHECKING:
    from ..core.geodesy.mercator import PixelGrid
    from ..core.imagery.source import Source
    from ..core.imagery.transport import Transport
    from ..core.mission.estimate import Costs
    from ..core.mission.mission import Mission

WORLD = "world"


def camera_choices() -> list[CameraChoice]:
    """Entries of the camera chooser."""
    from ..core.mission.presets import cameras

    return [CameraChoice(p.name, p.camera.fov_deg, p.camera.aspect_ratio) for p in cameras()]


def grid_of(mission: Mission) -> PixelGrid:
    """Pixel grid of a mission's source, on the main thread where QGIS draws it.

    Raises
    ------
    FormError
        For the field ``source`` or ``date``, where there is no such source.
    """
    from ..core.imagery.opening import open_source

    try:
        if is_of_qgis(mission.source):
            return grid_of_layers(mission.source, QgsProject.instance())
        source = open_source(mission.source, seed=mission.seed, date=mission.date or None, plan_only=True)
    except (InvalidInput, SourceError) as wrong:
        field = "date" if str(wrong).startswith("date ") else "source"
        raise FormError({field: str(wrong).replace(" (--date)", "")}) from wrong
    grid = source.grid
    source.close()
    return grid


def grid_finder(mission: Mission) -> Callable[[], PixelGrid]:
    """Return what gives `grid_of` on any thread; made on the main thread, which the project's layers belong to."""
    if not is_of_qgis(mission.source):
        return lambda: grid_of(mission)
    try:
        grid = grid_of(mission)
    except FormError as wrong:
        refusal = wrong

        def refuse() -> PixelGrid:
            raise refusal

        return refuse
    return lambda: grid


def costs_of(name: str) -> Costs:
    """What a request to a source is assumed to take, for estimates."""
    from ..core.imagery.opening import entry_of, is_file
    from ..core.mission.estimate import OFFLINE, ONLINE

    if name == WORLD or is_of_qgis(name) or is_file(name):
        return OFFLINE
    # The entry of a service is in its capabilities, which planning has read and an estimate does not read again.
    if name.startswith(("wmts:", "wms:")):
        return ONLINE
    return replace(ONLINE, requests_per_s=entry_of(name).policy.requests_per_s)


def snapshot_for(mission: Mission) -> Snapshot | None:
    """What QGIS is to draw for a mission, as it is now; on the main thread. None for every other source.

    Raises
    ------
    InvalidInput
        Where the project has no such layer.
    """
    return take_snapshot(mission.source, QgsProject.instance()) if is_of_qgis(mission.source) else None


def open_for_capture(
    mission: Mission,
    key: str | None,
    *,
    transport: Transport | None = None,
    snapshot: Snapshot | None = None,
) -> Source:
    """Source of a mission, ready to fetch; raises InvalidInput or SourceError."""
    if snapshot is not None:
        return LayerSource(snapshot)
    from ..core.imagery.cache.tile_cache import TileCache
    from ..core.imagery.opening import open_source

    return open_source(
        mission.source,
        seed=mission.seed,
        key=key,
        date=mission.date or None,
        transport=transport,
        cache=TileCache(),
    )


def terms_problem(mission: Mission, requests: int) -> tuple[str, bool] | None:
    """What the source's terms say against a run, as HTML, and whether agreeing is enough; None where nothing."""
    if is_of_qgis(mission.source):
        return None
    from ..core.imagery.catalogue.listing import alternatives
    from ..core.imagery.opening import open_source

    source = open_source(mission.source, seed=mission.seed, date=mission.date or None, plan_only=True)
    policy, title = source.policy, source.title
    source.close()
    if not policy.stops(requests):
        return None
    can_agree = policy.bulk_allowed == "ask"
    without = tr("agreeing to its terms") if can_agree else tr("breaking its terms")
    text = tr("{title}: {requests} requests, and {most} at most pass without {without}.").format(
        title=title, requests=f"{requests:,}", most=f"{policy.max_tiles:,}", without=without
    )
    quoted = "{text} <i>{terms}</i> (<a href='{url}'>{url}</a>). ".format(
        text=html.escape(text), terms=html.escape(policy.terms), url=html.escape(policy.terms_url)
    )
    if can_agree:
        return quoted, True
    bounds = mission_form.bounds_of(mission.area)
    east_deg = bounds.east_deg + (360.0 if bounds.east_deg < bounds.west_deg else 0.0)
    others = alternatives(mission.map_types, (bounds.west_deg, bounds.south_deg, east_deg, bounds.north_deg))
    instead = ", ".join(other.partition(" (")[0] for other in others)
    return quoted + html.escape(tr("Sources that allow it: {names}.").format(names=instead)), False


def key_in(authcfg: str) -> str | None:
    """API key: the password of a configuration of QGIS's authentication database; None where there is none."""
    if not authcfg:
        return None
    config = QgsAuthMethodConfig()
    loaded, config = QgsApplication.authManager().loadAuthenticationConfig(authcfg, config, True)
    return (config.config("password") or None) if loaded else None


def tile_layer_uri(name: str, map_type: str, date: str = "") -> str:
    """Data source of a QGIS layer that shows a source's tiles.

    Raises
    ------
    InvalidInput
        Where the source cannot be shown as such a layer.
    """
    from ..core.imagery.opening import entry_of, open_source

    entry = entry_of(name)
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
            tr(
                "{host} needs a key, which would be written into the project file: show another source"
            ).format(host=template.host)
        )
    grid = open_source(name, date=date or None, plan_only=True).grid
    url = template.text
    filled = {
        "{s}": template.subdomains[0] if template.subdomains else "",
        "{r}": "" if grid.scale == 1 else f"@{grid.scale}x",
        "{map_type}": map_type,
        "{date}": chosen,
    }
    for placeholder, value in filled.items():
        url = url.replace(placeholder, value)
    # QGIS takes braces as they are, and unpacks the rest once.
    address = quote(url, safe=":/{}?=,;@+$!*'()~")
    return f"type=xyz&url={address}&zmin={grid.min_zoom}&zmax={grid.max_zoom}&tilePixelRatio={grid.scale}"
