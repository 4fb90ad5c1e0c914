"""What heights count from, and how far that is from the ellipsoid. PROJ is loaded where used."""

from __future__ import annotations

import threading
import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput, Message, OptionName
from ..geodesy.vertical import vertical_code, vertical_crs

if TYPE_CHECKING:
    from pyproj import CRS

Floats = NDArray[np.float64]
#: Metres of units that heights come in, by the names that files and people give them.
UNITS_M = {
    **dict.fromkeys(("m", "metre", "meter", "metres", "meters"), 1.0),
    **dict.fromkeys(("ft", "foot", "feet"), 0.3048),
    **dict.fromkeys(("us-ft", "sft", "us survey foot", "ussurveyfoot", "foot_us"), 1200.0 / 3937.0),
}
#: PROJ's transformations are for one thread at a time.
_ONE_AT_A_TIME = threading.Lock()


@dataclass(frozen=True)
class Datum:
    """A vertical coordinate reference system: what its heights are over, and their unit.

    Parameters
    ----------
    code : str
        ``EPSG:code`` or WKT of a vertical system; empty for the WGS 84 ellipsoid.
    unit_m : float
        Metres of the unit that values are in.
    """

    code: str = ""
    unit_m: float = 1.0

    @classmethod
    def named(cls, text: str, unit_m: float = 1.0) -> Datum:
        """Datum of a name: ``ellipsoid``, ``EGM96``, ``EGM2008`` or the code of a vertical system.

        Raises
        ------
        InvalidInput
            Neither.
        """
        code = vertical_code(text)
        if not code:
            return cls("", unit_m)
        found = cls(code, unit_m)
        found.check()
        return found

    @classmethod
    def of_file(cls, wkt: str, unit: str, title: str) -> Datum | None:
        """Datum that a file's coordinate reference system has; None where that says nothing of heights.

        Parameters
        ----------
        wkt : str
            Of the file.
        unit : str
            That it states for its values; empty for none.
        title : str
            The file, as errors name it.

        Raises
        ------
        InvalidInput
            A unit that is not known, or none beside coordinates in feet: heights may be in either.
        """
        from pyproj import CRS

        crs = CRS.from_wkt(wkt)
        vertical = crs.sub_crs_list[1] if crs.is_compound and len(crs.sub_crs_list) > 1 else None
        stated = None if vertical is None else float(vertical.axis_info[0].unit_conversion_factor)
        if unit and stated is None:
            stated = UNITS_M.get(unit.strip().lower())
            if stated is None:
                raise InvalidInput(
                    "{0}: heights in {1!r}: must be one of {2}",
                    title,
                    unit,
                    ", ".join(("m", "ft", "us-ft")),
                    remedy=Message("say which{0}", OptionName("height_unit").in_brackets),
                )
        if vertical is not None:
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
        """What heights are over, for people."""
        return str(self._vertical.name) if self.code else Message("WGS 84 ellipsoid")

    def heights_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Heights of what these count from over the WGS 84 ellipsoid, metres, at positions (any shape)."""
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
        """Refuse what PROJ cannot transform here; raises InvalidInput with the grid that it lacks."""
        _ = self._transformer

    @cached_property
    def _transformer(self) -> Any:
        from pyproj import CRS
        from pyproj.crs.crs import CompoundCRS
        from pyproj.transformer import TransformerGroup

        both = CompoundCRS(self.name, [CRS.from_epsg(4326), self._vertical])
        with warnings.catch_warnings():
            # That grids are missing is said below, where they are needed.
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
