"""The heights of a mission, opened: what it flies over, and what its cameras see."""

from __future__ import annotations

from dataclasses import replace

from ..elevation.heights import HeightOptions, whole_heights_path
from ..elevation.layered import LayeredElevation, open_relief
from ..errors import TerrAInavError
from ..imagery.opening import SourceOptions
from ..mission.mission import Mission
from ..mission.parts import INTERPOLATE, Terrain
from ..mission.relief.ground import Heights


def heights_of(mission: Mission, options: SourceOptions | None = None) -> Heights | None:
    """Open the heights of a mission; None where its ground is level.

    Parameters
    ----------
    mission : Mission
    options : SourceOptions or None
        How sources are to be asked; None for the usual way.

    Raises
    ------
    InvalidInput, SourceError
        As `elevation.heights.open_heights` does.
    """
    asked = options or SourceOptions(seed=mission.imagery.seed)
    return heights_for(mission.terrain, replace(asked, crs=landscape_crs(mission.imagery.source, mission.imagery.crs)))


def landscape_crs(source: str, crs: str) -> str:
    """CRS of the embedded landscape's heights: that of the imagery where this is the landscape, too, else its own."""
    return crs if source.lower() == "world" else ""


def with_whole_paths(terrain: Terrain) -> Terrain:
    """Terrain that names the same heights in processes with another current folder."""
    elevation, surface = (tuple(map(whole_heights_path, texts)) for texts in (terrain.elevation, terrain.surface))
    return replace(terrain, elevation=elevation, surface=surface)


def heights_for(terrain: Terrain, asked: SourceOptions) -> Heights | None:
    """Open the heights that a terrain names; as `heights_of`."""
    if not terrain.elevation:
        return None
    wanted = HeightOptions(terrain.vertical_datum, terrain.height_unit, terrain.height_offset_m, asked)
    interpolates = terrain.holes == INTERPOLATE
    ground = _opened("elevation", terrain.elevation, wanted, interpolates)
    if not terrain.surface:
        return Heights(ground, ground)
    seen = _opened("surface", terrain.surface, wanted)
    return Heights(ground, LayeredElevation((*seen.layers, *ground.layers), interpolates))


def _opened(
    field: str, sources: tuple[str, ...], wanted: HeightOptions, interpolates: bool = False
) -> LayeredElevation:
    """Open sources of heights; errors that name no other field of the terrain name this one."""
    try:
        return open_relief(sources, wanted, interpolates=interpolates)
    except TerrAInavError as wrong:
        # Errors of sources may be about these fields.
        if wrong.field not in ("vertical_datum", "height_unit", "height_offset_m", "holes"):
            wrong.field = field
        raise
