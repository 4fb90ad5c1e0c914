"""Several models of triangles as one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np

from ..arrays import Floats
from .covered_roofs import with_covered
from .triangles import NO_FACES, FaceModel, Triangles


@dataclass(frozen=True)
class _JoinedFaces:
    """Several models as one, a `FaceModel`; instances are numbered one model after the other.

    Parameters
    ----------
    models : tuple of FaceModel
    before : tuple of int
        Numbers of instances before each model.
    """

    models: tuple[FaceModel, ...]
    before: tuple[int, ...]

    @property
    def title(self) -> str:
        """Titles for users."""
        return ", ".join(model.title for model in self.models)

    @property
    def attribution(self) -> str:
        """Credits for the faces."""
        return "; ".join(dict.fromkeys(model.attribution for model in self.models if model.attribution))

    @property
    def count(self) -> int:
        """Greatest number of a building."""
        return self.before[-1] + self.models[-1].count

    @property
    def listed(self) -> int:
        """Numbers of buildings in files."""
        return self.before[-1] + self.models[-1].listed

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of all models."""
        return tuple(warning for model in self.models for warning in model.warnings)

    def triangles(self, lat_deg: Floats, lon_deg: Floats, least_m: float = 0.0) -> Triangles:
        """Triangles of all models; see `FaceModel`."""
        parts = [model.triangles(lat_deg, lon_deg, least_m) for model in self.models]
        found = Triangles.joined(
            [replace(part, instance=part.instance + before) for part, before in zip(parts, self.before)]
        )
        return with_covered(found, np.repeat(np.arange(len(parts)), [len(part) for part in parts]))


def joined_faces(models: Sequence[FaceModel]) -> FaceModel:
    """Models as one; only the last may have numbers that are not listed."""
    models = [model for model in models if model is not NO_FACES]
    if not models:
        return NO_FACES
    if len(models) == 1:
        return models[0]
    return _JoinedFaces(tuple(models), (0, *accumulate(model.count for model in models[:-1])))
