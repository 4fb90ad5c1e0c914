"""The embedded world: a seeded procedural landscape that serves as imagery without a network.

lattice    hashed lattices and spline noise
samples    positions at which the world is evaluated, and results that neighbouring tiles share
region     land, sea, climate, relief, rivers and motorways at the scale of kilometres
climate    ground colours, forest and settlement, by climate
division   fields, towns and the roads between them
parcels    the pieces of land under samples, and distances to their edges
paint      blending of colours
rays       the sun over a chart, and rays to it over lattices
scene      coverage by water, woods, motorways and parcels, shared by all styles
objects    buildings and trees
heights    heights of the ground, and of the surface with trees
relief_light   light of the sun on the relief
shadows    shadows of houses and trees
sunlight   light of sun and sky over a picture
houses     houses as faces with walls and roofs
styles     the pictures: satellite, roadmap, terrain
ice        polar ice, with rock, crevasses and drifts
caps       the pictures about the poles: ice over the landscape
source     the world as a function of position, and as a source of tiles
"""

from __future__ import annotations

from .source import World, WorldHeights, WorldSource

__all__ = ["World", "WorldHeights", "WorldSource"]
