"""A plan in files: tables, layers, and missions for those who fly."""

from .rings import footprint_ring, split_at_antimeridian
from .rows import COLUMNS
from .writing import ENDINGS, Exported, check_plan_ending, write_plan

__all__ = [
    "COLUMNS",
    "ENDINGS",
    "Exported",
    "check_plan_ending",
    "footprint_ring",
    "split_at_antimeridian",
    "write_plan",
]
