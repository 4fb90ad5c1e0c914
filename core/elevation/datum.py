"""Vertical datums, and heights of their zero surfaces over the ellipsoid. PROJ is loaded when used."""

from __future__ import annotations

import math
import threading
import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, Message, OptionName
from ..geodesy.reference import read_reference
from ..geodesy.vertical import vertical_code, vertical_crs

if TYPE_CHECKING:
    from pyproj import CRS

#: Metres per unit of heights, by the names that files and users write.
UNITS_M = {
    **dict.fromkeys(("m", "metre", "meter", "metres", "meters"), 1.0),
    **dict.fromkeys(("ft", "foot", "feet"), 0.3048),
    **dict.fromkeys(("us-ft", "sft", "us survey foot", "ussurveyfoot", "foot_us"), 1200.0 / 3937.0),
}
#: Held while a transformer of PROJ is used, which allows one thread at a time.
_ONE_AT_A_TIME = threading.Lock()


@dataclass(frozen=True)
class Datum:
    """A vertical coordinate reference system and the unit of its heights.

    Parameters
    ----------
    code : str
        ``EPSG:code`` or WKT of a vertical system; empty for the WGS 84 ellipsoid.
    unit_m : float
        Metres per unit of the values; negative for depths.
    """

    code: str = ""
    unit_m: float = 1.0

    @classmethod
    def named(cls, text: str, unit_m: float = 1.0) -> Datum:
        """Datum by name: ``ellipsoid``, ``EGM96``, ``EGM2008`` or the code of a vertical system.

        If the axis of the system points down, values are depths, in the unit ``unit_m``.

        Raises
        ------
        InvalidInput
            The name is unknown.
        """
        code = vertical_code(text)
        if not code:
            return cls("", unit_m)
        found = cls(code, math.copysign(unit_m, _up_m(vertical_crs(code).axis_info[0], text)))
        found.check()
        return found

    @classmethod
    def from_crs(cls, wkt: str, unit: str, title: str) -> Datum | None:
        """Datum of a file's coordinate reference system; None if it has no heights.

        Parameters
        ----------
        wkt : str
            Coordinate reference system of the file.
        unit : str
            Unit of the values that the file states, or empty.
        title : str
            Name of the file for errors.

        Raises
        ------
        InvalidInput
            The unit is unknown, or missing with coordinates in feet (heights may then be in metres or feet); or the
            axis points neither up nor down.
        """
        crs = read_reference(wkt)
        vertical = crs.sub_crs_list[1] if crs.is_compound and len(crs.sub_crs_list) > 1 else None
        # The third axis of three is the height over the ellipsoid.
        axes = crs.axis_info[2:3] if vertical is None else vertical.axis_info[:1]
        stated = _up_m(axes[0], title) if axes else None
        if unit and vertical is None:
            unit_m = UNITS_M.get(unit.strip().lower())
            if unit_m is None:
                raise InvalidInput(
                    "{0}: heights in {1!r}: must be one of {2}",
                    title,
                    unit,
                    ", ".join(("m", "ft", "us-ft")),
                    remedy=Message("say which{0}", OptionName("height_unit").in_brackets),
                )
            stated = math.copysign(unit_m, stated or 1.0)
        if vertical is not None:
            # Older versions of GDAL wrap the system to add a grid, which the code implies.
            vertical = vertical.source_crs or vertical
            code = vertical.to_epsg()
            return cls(f"EPSG:{code}" if code else str(vertical.to_wkt()), stated or 1.0)
        if stated is None and crs.is_projected and abs(crs.axis_info[0].unit_conversion_factor - 1.0) > 1e-3:
            raise InvalidInput(
                "{0}: its coordinates are in {1}, and it does not say whether its heights are in metres",
                title,
                crs.axis_info[0].unit_name,
                remedy=Message("say which{0}", OptionName("height_unit").in_brackets),
            )
        return None if stated is None else cls("", stated)

    @property
    def name(self) -> str:
        """Name of the datum, for people."""
        return str(self._vertical.name) if self.code else Message("WGS 84 ellipsoid")

    def heights_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Heights of the datum's zero surface over the WGS 84 ellipsoid, in metres, at positions of any shape."""
        if not self.code:
            return np.zeros(np.broadcast_shapes(np.shape(lat_deg), np.shape(lon_deg)))
        from ..geodesy.mercator import wrap_lon_deg
        from ..geodesy.projections import through_proj

        with _ONE_AT_A_TIME:
            _, _, found = through_proj(self._transformer.transform, wrap_lon_deg(lon_deg), lat_deg, 0.0)
        if not np.isfinite(found).all():
            raise InvalidInput("heights over {0}: it does not reach here", self.name)
        return found

    @cached_property
    def _vertical(self) -> CRS:
        return vertical_crs(self.code)

    def check(self) -> None:
        """Raise InvalidInput, naming a missing grid, if PROJ cannot transform the heights."""
        _ = self._transformer

    @cached_property
    def _transformer(self) -> Any:
        from pyproj import CRS
        from pyproj.crs.crs import CompoundCRS
        from pyproj.transformer import TransformerGroup

        both = CompoundCRS(self.name, [CRS.from_epsg(4326), self._vertical])
        with warnings.catch_warnings():
            # Missing grids are reported below if they are needed.
            warnings.simplefilter("ignore")
            found = TransformerGroup(both, CRS.from_epsg(4979), always_xy=True, allow_ballpark=False)
        if not found.transformers:
            grids = sorted({grid.short_name for one in found.unavailable_operations for grid in one.grids})
            raise InvalidInput(
                "heights over {0}: PROJ has no way to the ellipsoid here{1}",
                self.name,
                Message(", as it lacks the grid {0}", " or ".join(grids)) if grids else "",
                field="vertical_datum",
                remedy=Message(
                    "install it, for example with projsync, or take the ellipsoid and say how far heights are off it "
                    "({0})",
                    OptionName("height_offset"),
                ),
            )
        return found.transformers[0]


def _up_m(axis: Any, title: str) -> float:
    """Metres per unit of a vertical axis, negative if it points down; raises InvalidInput for other directions."""
    directions = {"up": 1.0, "down": -1.0}
    if axis.direction.lower() not in directions:
        raise InvalidInput(
            "{0}: axis {1!r} of its heights points {2}: must be up or down",
            title,
            axis.name,
            axis.direction,
        )
    return directions[axis.direction.lower()] * float(axis.unit_conversion_factor)
