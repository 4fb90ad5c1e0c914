"""The parts of a mission whose fields are plain values, each declared once; without numpy, so that help is quick.

In reading order:

- `flown`: attitude, flight and route
- `terrain`: relief and buildings
- `pictures`: imagery, pixels, accuracy and files
- `labels`: labels of pixels
- `air`: haze
- `optics`: sampling, sharpness and vignetting
- `exposure`: exposure, white balance and tone
- `shutter`: motion blur and rolling shutter
- `sensor`: pixels, noise and converter of the image sensor
- `sunlight`: sun and sky over the synthetic world
- `varied`: random values of images
"""

from __future__ import annotations

from ...fields import CheckedFields
from .air import Air
from .exposure import BY_ISO, BY_TIME, IDEAL, MANUAL, ExposureControl
from .flown import (
    ALIGNMENTS,
    BY_DISTANCE,
    BY_WAYPOINT,
    COMPASS_CORNERS,
    COVER,
    DJI_FLY,
    EASTWARD_DEG,
    FIRST,
    HIGHEST_AGL_M,
    HOVER,
    LONGEST_SIDE,
    MOST_SORTIES,
    NEAREST,
    NORTH,
    ONE_WAY,
    PAPER,
    SERPENTINE,
    SHORTEST,
    TRACK,
    Attitude,
    Flight,
    Route,
    utc_time,
)
from .labels import PixelLabels
from .optics import AREA, COS4, NO_VIGNETTING, ZOOM, CameraOptics
from .pictures import (
    AUTO,
    CLASSES,
    INSTANCES,
    LABELLED,
    RAW,
    RAYS,
    Accuracy,
    Imagery,
    Output,
    Pixels,
)
from .sensor import NO_BAYER, ImageSensor
from .shutter import Shutter
from .sunlight import BY_START, NO_SUN, Sunlight
from .terrain import (
    ELLIPSOID,
    FILL,
    GROUND,
    HIGHEST_GROUND_M,
    INTERPOLATE,
    LOWEST_GROUND_M,
    REFUSE,
    TAKEOFF,
    Terrain,
)
from .varied import Varied

__all__ = [
    "ALIGNMENTS",
    "AREA",
    "AUTO",
    "BY_DISTANCE",
    "BY_ISO",
    "BY_START",
    "BY_TIME",
    "BY_WAYPOINT",
    "CLASSES",
    "COMPASS_CORNERS",
    "COS4",
    "COVER",
    "DJI_FLY",
    "EASTWARD_DEG",
    "ELLIPSOID",
    "FILL",
    "FIRST",
    "FLAT_PARTS",
    "GROUND",
    "HIGHEST_AGL_M",
    "HIGHEST_GROUND_M",
    "HOVER",
    "IDEAL",
    "INSTANCES",
    "INTERPOLATE",
    "LABELLED",
    "LONGEST_SIDE",
    "LOWEST_GROUND_M",
    "MANUAL",
    "MOST_SORTIES",
    "NEAREST",
    "NORTH",
    "NO_BAYER",
    "NO_SUN",
    "NO_VIGNETTING",
    "ONE_WAY",
    "PAPER",
    "RAW",
    "RAYS",
    "REALISM_PARTS",
    "REFUSE",
    "SERPENTINE",
    "SHORTEST",
    "TAKEOFF",
    "TRACK",
    "ZOOM",
    "Accuracy",
    "Air",
    "Attitude",
    "CameraOptics",
    "ExposureControl",
    "Flight",
    "ImageSensor",
    "Imagery",
    "Output",
    "PixelLabels",
    "Pixels",
    "Route",
    "Shutter",
    "Sunlight",
    "Terrain",
    "Varied",
    "utc_time",
]

#: Parts whose fields a mission takes by name; no two parts share a name.
FLAT_PARTS: dict[str, type[CheckedFields]] = {
    "attitude": Attitude,
    "flight": Flight,
    "imagery": Imagery,
    "pixels": Pixels,
    "accuracy": Accuracy,
    "terrain": Terrain,
    "route": Route,
    "labels": PixelLabels,
    "sunlight": Sunlight,
    "air": Air,
    "optics": CameraOptics,
    "exposure": ExposureControl,
    "shutter": Shutter,
    "sensor": ImageSensor,
    "varied": Varied,
    "output": Output,
}

#: Parts of a real camera's effects, in the order in which light meets them; with their defaults a camera is ideal.
REALISM_PARTS: tuple[str, ...] = ("sunlight", "air", "optics", "exposure", "shutter", "sensor", "varied")
