"""What the plugin asks of the catalogue: choices for the dock, sources to plan with and to capture from."""

from __future__ import annotations

from typing import TYPE_CHECKING
from urllib.parse import quote

from qgis.core import QgsApplication, QgsAuthMethodConfig

from ..core.errors import InvalidInput, SourceError
from .choices import CameraChoice, SourceChoice
from .i18n import tr
from .mission_form import FormError

if TYPE_CHECKING:
    from ..core.geodesy.mercator import PixelGrid
    from ..core.imagery.source import Source
    from ..core.mission.mission import Mission

WORLD = "world"


def source_choices() -> list[SourceChoice]:
    """Entries of the source chooser, the embedded world first."""
    from ..core.imagery.catalogue import sources

    return [
        SourceChoice(entry.name, entry.title, tuple(entry.map_types), entry.key_env is not None)
        for entry in sources()
    ]


def camera_choices() -> list[CameraChoice]:
    """Entries of the camera chooser."""
    from ..core.mission.presets import cameras

    return [CameraChoice(p.name, p.camera.fov_deg, p.camera.aspect_ratio) for p in cameras()]


def grid_of(mission: Mission) -> PixelGrid:
    """Pixel grid of a mission's source; raises FormError for the field ``source`` where there is no such source."""
    from ..core.imagery.catalogue import open_source

    try:
        source = open_source(mission.source, seed=mission.seed, plan_only=True)
    except (InvalidInput, SourceError) as wrong:
        raise FormError({"source": str(wrong)}) from wrong
    grid = source.grid
    close(source)
    return grid


def open_for_capture(mission: Mission, key: str | None) -> Source:
    """Source of a mission, ready to fetch; raises InvalidInput or SourceError."""
    from ..core.imagery.catalogue import open_source

    return open_source(mission.source, seed=mission.seed, key=key)


def close(source: Source) -> None:
    """Free a source's connections, where it has any."""
    end = getattr(source, "close", None)
    if end is not None:
        end()


def terms_problem(mission: Mission, requests: int) -> tuple[str, bool] | None:
    """What the source's terms say against a run, and whether agreeing to them is enough; None where nothing."""
    from ..core.imagery.catalogue import check_policy, open_source

    source = open_source(mission.source, seed=mission.seed, plan_only=True)
    try:
        check_policy(source, requests)
    except SourceError as wrong:
        return str(wrong), source.policy.bulk_allowed == "ask"
    finally:
        close(source)
    return None


def key_in(authcfg: str) -> str | None:
    """API key: the password of a configuration of QGIS's authentication database; None where there is none."""
    if not authcfg:
        return None
    config = QgsAuthMethodConfig()
    loaded, config = QgsApplication.authManager().loadAuthenticationConfig(authcfg, config, True)
    return (config.config("password") or None) if loaded else None


def tile_layer_uri(name: str, map_type: str) -> str:
    """Data source of a QGIS layer that shows a source's tiles.

    Raises
    ------
    InvalidInput
        Where the source cannot be shown as such a layer.
    """
    from ..core.imagery.catalogue import entry_named, is_template, open_source
    from ..core.imagery.template import Template

    if is_template(name):
        template = Template(name)
        date = ""
    else:
        entry = entry_named(name)
        if not entry.urls:
            raise InvalidInput(
                tr("{title} has no tiles to show as a background; show another source and come back").format(
                    title=entry.title
                )
            )
        template = Template(entry.urls.get(map_type) or next(iter(entry.urls.values())))
        date = entry.date(None)
    if "key" in template.names:
        raise InvalidInput(
            tr(
                "{host} needs a key, which would be written into the project file: show another source"
            ).format(host=template.host)
        )
    grid = open_source(name, plan_only=True).grid
    url = template.text
    filled = {
        "{s}": template.subdomains[0] if template.subdomains else "",
        "{r}": "" if grid.scale == 1 else f"@{grid.scale}x",
        "{map_type}": map_type,
        "{date}": date,
    }
    for placeholder, value in filled.items():
        url = url.replace(placeholder, value)
    # QGIS takes braces as they are, and unpacks the rest once.
    address = quote(url, safe=":/{}?=,;@+$!*'()~")
    return f"type=xyz&url={address}&zmin={grid.min_zoom}&zmax={grid.max_zoom}&tilePixelRatio={grid.scale}"
