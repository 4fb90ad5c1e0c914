"""What a mission's options choose among, and what they are where nothing is said; without what works on them.

Options are listed, as for help, from here alone.
"""

from __future__ import annotations

FEET_IN_METRES = 0.3048
UNITS = {"m": 1.0, "ft": FEET_IN_METRES}
KINDS = ("single", "list", "raster")
MAP_TYPES = ("satellite", "roadmap", "terrain")
LAYOUTS = ("cover", "paper")
#: Whether rows are flown to and fro, or each from its beginning.
SERPENTINE, ONE_WAY = ORDERS = ("serpentine", "one-way")
FORMATS = ("tif", "jpg", "png")
#: How a camera frame takes its pixels from the source's.
RESAMPLINGS = ("nearest", "bilinear", "bicubic", "lanczos")
AUTO = "auto"
#: Kinds of pictures, from cheap to exact.
FRAMES = ("map", "camera")
#: A ray for every pixel of a camera frame, in place of a mesh that is as coarse as the error budget allows.
RAYS = "rays"
#: What the sum of the stages' errors may be where nothing else is said, px.
DEFAULT_BUDGET_PX = 0.1
#: Pixels along the longer side of a camera's image where nothing else is known of the camera.
DEFAULT_IMAGE_PX = 640
#: Longest side of a picture in the paper's layout where no other limit is given.
PAPER_MAX_PX = 640
DEFAULT_MAX_IMAGES = 10_000_000
DEFAULT_AIRSPEED_M_PER_S = 15.0
#: The flight's clock starts here where nothing else is said.
DEFAULT_START = "2000-01-01T00:00:00Z"
