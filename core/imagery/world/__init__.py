"""The embedded world: a seeded procedural landscape that serves as imagery without a network."""

from __future__ import annotations

from .source import WorldSource
from .world import World

__all__ = ["World", "WorldSource"]
