"""What a picture's own metadata says about it, whatever its format."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geodesy.mercator import wrap_lon_deg
from .digits import degrees, figure
from .exposure import Exposure
from .georeference import plain_text

SOFTWARE = "TerrAInav"


@dataclass(frozen=True)
class Description:
    """What a picture's own metadata says about it.

    Parameters
    ----------
    name : str
        Of the picture, without ending.
    map_type : str
    source, attribution : str
        Title of the source as people see it, and the credit it asks for; without characters that files have no
        form for.
    zoom : int
    lat_deg, lon_deg, agl_m, yaw_deg, tilt_deg, roll_deg : float
        Pose of the camera; the longitude may be continuous beyond ±180.
    imagery_date : str
        Empty where the source does not say.
    effective_gsd_m_per_px : float or None
        Metres of ground that the picture tells apart, which enlarged pixels do not make smaller.
    more : tuple of (str, str)
        Names and values that are added to the metadata.
    exposure : Exposure or None
        What a JPEG says as a drone's does; None where the format has no room for it.
    """

    name: str
    map_type: str
    source: str
    attribution: str
    zoom: int
    lat_deg: float
    lon_deg: float
    agl_m: float
    yaw_deg: float = 0.0
    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    imagery_date: str = ""
    effective_gsd_m_per_px: float | None = None
    more: tuple[tuple[str, str], ...] = ()
    exposure: Exposure | None = None

    def __post_init__(self) -> None:
        for field in ("source", "attribution", "imagery_date"):
            object.__setattr__(self, field, plain_text(getattr(self, field)))

    @property
    def title(self) -> str:
        """One line for people."""
        return f"{self.name} {self.map_type}, {self.source}"

    @property
    def wrapped_lon_deg(self) -> float:
        """Longitude in [-180, 180), as files state it."""
        return degrees(float(wrap_lon_deg(np.asarray(degrees(self.lon_deg)))))

    def metadata(self) -> dict[str, str]:
        """Names and values as GDAL shows them, the same in every format."""
        numbers = {
            "LAT_DEG": degrees(self.lat_deg),
            "LON_DEG": self.wrapped_lon_deg,
            "AGL_M": figure(self.agl_m),
            "YAW_DEG": degrees(self.yaw_deg),
            "TILT_DEG": degrees(self.tilt_deg),
            "ROLL_DEG": degrees(self.roll_deg),
        }
        if self.effective_gsd_m_per_px is not None:
            numbers["EFFECTIVE_GSD_M_PER_PX"] = figure(self.effective_gsd_m_per_px)
        return {
            "NAME": self.name,
            "MAP_TYPE": self.map_type,
            "SOURCE": self.source,
            "ATTRIBUTION": self.attribution,
            "ZOOM": str(self.zoom),
            **{key: repr(value) for key, value in numbers.items()},
            **({"IMAGERY_DATE": self.imagery_date} if self.imagery_date else {}),
            **dict(self.more),
        }
