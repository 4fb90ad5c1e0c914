"""Open the heights of a mission: the ground that it flies over, and the surface that its cameras see."""

from __future__ import annotations

from dataclasses import replace

from ..elevation.heights import HeightOptions, whole_heights_path
from ..elevation.layered import LayeredElevation, open_relief
from ..errors import InvalidInput, Message, TerrAInavError
from ..geodesy.joined_faces import joined_faces
from ..geodesy.triangles import FaceModel
from ..imagery.opening import SourceOptions
from ..mission.mission import Mission
from ..mission.parts import INTERPOLATE, Terrain
from ..mission.relief.ground import Heights


def mission_heights(mission: Mission, options: SourceOptions | None = None) -> Heights | None:
    """Open the heights of a mission; None if its ground is level.

    Parameters
    ----------
    mission : Mission
    options : SourceOptions or None
        Options of the heights' sources; None for the defaults.

    Raises
    ------
    InvalidInput, SourceError
        As in `elevation.layered.open_relief`.
    """
    imagery = mission.imagery
    asked = options or SourceOptions(seed=imagery.seed)
    return terrain_heights(mission.terrain, replace(asked, crs=landscape_crs(imagery.source, imagery.crs)))


def landscape_crs(source: str, crs: str) -> str:
    """CRS of the embedded landscape's heights: that of the imagery if it is the landscape, too, else the default."""
    return crs if source.lower() == "world" else ""


def absolute_terrain(terrain: Terrain) -> Terrain:
    """Terrain with absolute paths, for processes with another current folder."""
    elevation, surface = (tuple(map(whole_heights_path, texts)) for texts in (terrain.elevation, terrain.surface))
    buildings = terrain.buildings
    if buildings:
        # Imported here, as only missions with buildings need vector files.
        from ..faces.opening import whole_building_path

        buildings = tuple(map(whole_building_path, buildings))
    return replace(terrain, elevation=elevation, surface=surface, buildings=buildings)


def terrain_heights(terrain: Terrain, asked: SourceOptions) -> Heights | None:
    """Open the heights of a terrain; None if it is level. Raises as `mission_heights` does."""
    if not terrain.elevation:
        return None
    wanted = HeightOptions(terrain.vertical_datum, terrain.height_unit, terrain.height_offset_m, asked)
    interpolates = terrain.holes == INTERPOLATE
    ground = _opened("elevation", terrain.elevation, wanted, interpolates)
    surface = ground
    if terrain.surface:
        seen = _opened("surface", terrain.surface, wanted)
        surface = LayeredElevation((*seen.layers, *ground.layers), interpolates)
    return Heights(ground, surface, joined_faces([*_open_buildings(terrain, ground, asked.seed), surface.faces]))


def _open_buildings(terrain: Terrain, ground: LayeredElevation, seed: int) -> list[FaceModel]:
    """Open the buildings of a terrain; errors name the field."""
    if not terrain.buildings:
        return []
    # Imported here, as only missions with buildings need vector files.
    from ..faces.buildings import BuildingOptions, FootprintBuildings
    from ..faces.opening import open_buildings

    options = BuildingOptions(
        terrain.building_height_field,
        terrain.building_height_m,
        seed,
        terrain.vertical_datum,
        terrain.height_unit,
        terrain.height_offset_m,
    )
    try:
        models = [open_buildings(text, ground, options) for text in terrain.buildings]
    except TerrAInavError as wrong:
        wrong.field = wrong.field or "buildings"
        raise
    named = terrain.building_height_field
    fields = {name for model in models if isinstance(model, FootprintBuildings) for name in model.fields}
    if named and named not in fields:
        known = Message.joined(", ", sorted(fields)[:30]) if fields else Message("no fields")
        raise InvalidInput(
            "field {0!r} of heights: no file of buildings has it, but {1}", named, known, field="building_height_field"
        )
    return models


def _opened(
    field: str, sources: tuple[str, ...], wanted: HeightOptions, interpolates: bool = False
) -> LayeredElevation:
    """Open sources of heights; errors name ``field``, unless they name another field of the terrain."""
    try:
        return open_relief(sources, wanted, interpolates=interpolates)
    except TerrAInavError as wrong:
        if wrong.field not in ("vertical_datum", "height_unit", "height_offset_m", "holes"):
            wrong.field = field
        raise
