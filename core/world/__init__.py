"""The embedded world: a seeded procedural landscape that serves as imagery without a network.

lattice    hashed lattices and spline noise, the deterministic ground that all stands on
samples    where the world is evaluated, and what neighbouring tiles have in common
region     land, sea, climate, relief and the courses of rivers at the scale of kilometres
climate    what grows where: ground colours, forest, settlement
division   fields, towns and the roads between them
parcels    the pieces of land under samples, and how far their edges are
paint      blending of colours
scene      what lies at some samples, shared by all styles
objects    buildings and trees
heights    how high the ground is, and what stands on it
styles     the pictures: satellite, roadmap, terrain
ice        where ice stays about the poles, and the rock, crevasses and drifts on it
caps       the pictures about the poles, ice over the landscape
source     the world as a function of position, and as a source of tiles
"""

from __future__ import annotations

from .source import World, WorldHeights, WorldSource

__all__ = ["World", "WorldHeights", "WorldSource"]
