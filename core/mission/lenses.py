"""Cameras of captures: one for all, or each with a lens of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np

from ..arrays import Floats, NDArray, Numbers
from ..geodesy.camera import Camera
from ..map_types import is_undistorted
from .mission import Mission
from .parts.varied import drawn_camera

#: Indices of captures.
Which = Union[slice, NDArray[np.intp]]


@dataclass(frozen=True, eq=False)
class CaptureCameras:
    """Cameras of n captures.

    Parameters
    ----------
    distinct : tuple of Camera
        The different cameras.
    number : array (n,) or None
        The camera of each capture, by its index among these; None if all captures have the first.
    """

    distinct: tuple[Camera, ...]
    number: NDArray[np.intp] | None = None

    @classmethod
    def drawn(cls, mission: Mission, column: Numbers, row: Numbers, map_type: str = "") -> CaptureCameras:
        """Cameras of captures by their columns and rows, (n,) each, for the images of a map type or its twins."""
        varied, seed = mission.varied, mission.imagery.seed
        found = cls((mission.camera,))
        if varied.of_lens:
            numbers: dict[tuple[float, ...], int] = {}
            lenses = (varied.draw_lens(seed, *place) for place in zip(column.tolist(), row.tolist()))
            number = [numbers.setdefault(tuple(values.values()), len(numbers)) for values in lenses]
            names = [one.field for one in varied.of_lens]
            made = (drawn_camera(mission.camera, dict(zip(names, values)), varied.of_lens) for values in numbers)
            found = cls(tuple(made), np.array(number, np.intp))
        return found.undistorted if is_undistorted(map_type) else found

    @classmethod
    def joined(cls, parts: Sequence[tuple[CaptureCameras, int]]) -> CaptureCameras:
        """Cameras of missions that share one unless their lenses vary, each with its number of captures."""
        if not any(one.vary for one, _ in parts):
            return parts[0][0]
        distinct: tuple[Camera, ...] = ()
        numbers = []
        for one, count in parts:
            numbers.append(len(distinct) + (np.zeros(count, np.intp) if one.number is None else one.number))
            distinct += one.distinct
        return cls(distinct, np.concatenate(numbers))

    @property
    def undistorted(self) -> CaptureCameras:
        """Cameras of the same focal lengths that do not distort."""
        return CaptureCameras(tuple(one.undistorted for one in self.distinct), self.number)

    @property
    def vary(self) -> bool:
        """Whether captures have lenses of their own."""
        return self.number is not None

    @property
    def distort(self) -> bool:
        """Whether any of the cameras distorts."""
        return any(one.distorts for one in self.distinct)

    def of(self, index: int) -> Camera:
        """Camera of a capture."""
        return self.distinct[0 if self.number is None else self.number[index]]

    def __getitem__(self, which: NDArray[Any] | slice) -> CaptureCameras:
        """Cameras of some captures, by index, mask or slice."""
        if self.number is None:
            return self
        used, number = np.unique(self.number[which], return_inverse=True)
        return CaptureCameras(tuple(self.distinct[at] for at in used.tolist()), np.ravel(number))

    def groups(self) -> Iterator[tuple[Camera, Which]]:
        """Each camera, and the indices of its captures."""
        if self.number is None:
            yield self.distinct[0], slice(None)
            return
        order = np.argsort(self.number, kind="stable")
        for which in np.split(order, np.flatnonzero(np.diff(self.number[order])) + 1):
            yield self.distinct[self.number[which[0]] if len(which) else 0], which

    def together(self, of_camera: Callable[[Camera, Which], Sequence[NDArray[Any]]]) -> tuple[NDArray[Any], ...]:
        """Arrays (n, …) that a function returns for a camera and the indices of its captures, put together."""
        if self.number is None:
            return tuple(of_camera(self.distinct[0], slice(None)))
        found = [of_camera(*group) for group in self.groups()]
        # The inverse of the order of the groups.
        back = np.argsort(np.argsort(self.number, kind="stable"))
        return tuple(np.concatenate(parts)[back] for parts in zip(*found))

    def each(self, of_camera: Callable[[Camera], Sequence[float]]) -> Floats:
        """Numbers (k, n) that a function returns for each camera; (k,) if all captures have one."""
        found = np.array([of_camera(one) for one in self.distinct]).T
        return found[:, 0] if self.number is None else found[:, self.number]
