"""Poses of cameras: where they are and which way they look."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Poses(NamedTuple):
    """Poses as arrays (n,) in degrees and metres.

    ``agl_m`` is the height over the ground; longitudes are continuous along a mission. Yaw, tilt and roll are as
    in `Camera.rays_enu`: tilt 0 looks straight down. At ±90° of latitude the longitude says where "north" is.
    """

    lat_deg: Floats
    lon_deg: Floats
    agl_m: Floats
    yaw_deg: Floats
    tilt_deg: Floats
    roll_deg: Floats

    @classmethod
    def level(cls, lat_deg: Floats, lon_deg: Floats, agl_m: Floats) -> Poses:
        """North-up poses that look straight down."""
        return cls.turned(lat_deg, lon_deg, agl_m, 0.0, 0.0, 0.0)

    @classmethod
    def turned(
        cls, lat_deg: Floats, lon_deg: Floats, agl_m: Floats, yaw_deg: float, tilt_deg: float, roll_deg: float
    ) -> Poses:
        """Poses of one attitude; it takes no memory, however many they are."""
        attitude = (
            np.broadcast_to(np.float64(angle), np.shape(lat_deg)) for angle in (yaw_deg, tilt_deg, roll_deg)
        )
        return cls(lat_deg, lon_deg, agl_m, *attitude)

    @property
    def attitude(self) -> tuple[Floats, Floats, Floats]:
        """Yaw, tilt and roll in degrees, (n,) each."""
        return self.yaw_deg, self.tilt_deg, self.roll_deg

    def take(self, which: NDArray[Any] | slice) -> Poses:
        """Some of the poses, by index, mask or slice."""
        lat_deg = self.lat_deg[which]
        return Poses(
            lat_deg,
            *(
                values[which] if any(values.strides) else np.broadcast_to(values[:1], lat_deg.shape)
                for values in self[1:]
            ),
        )

    def runs(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Runs of neighbours that differ in longitude alone, as the captures of a row do.

        Their geometry differs by that longitude alone, too.

        Returns
        -------
        first : array (k,)
            Index of the first of each run.
        run : array (n,)
            For every pose the run it is in.
        """
        change = np.zeros(self.lat_deg.shape, bool)
        change[:1] = True
        for column in (self.lat_deg, self.agl_m, *self.attitude):
            if any(column.strides):
                change[1:] |= column[1:] != column[:-1]
        return np.flatnonzero(change), np.cumsum(change) - 1
