"""The camera contract: one value that says what the pixels of a picture mean, from which all formats derive."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput
from .lens import FISHEYE, PERSPECTIVE, Lens

#: Version of the JSON form.
SCHEMA = 1
#: File of the JSON form in datasets, sequences and exports.
CAMERA_FILE = "camera.json"
#: Decimals of focal lengths and principal points in files, on which all processors agree.
PIXEL_DECIMALS = 6
#: Decimals of degrees in the metadata of images, 0.1 mm of ground, and significant digits of its other numbers.
DEGREE_DECIMALS, FIGURE_DIGITS = 9, 6
#: What holds for all pictures, JSON-ready.
CONVENTIONS: Mapping[str, Any] = {
    "pixels": {"origin": "upper left corner", "centre_of_the_first": [0.5, 0.5], "unit": "px"},
    "lenses": {PERSPECTIVE: "as in cv2.projectPoints", FISHEYE: "as in cv2.fisheye.projectPoints"},
    "optical_axes": ["right", "down", "view"],
    "pose": {
        "position": ["lat_deg", "lon_deg", "height_m"],
        "crs": "EPSG:4979",
        "vertical_datum": "WGS 84 ellipsoid",
        "attitude": ["yaw_deg", "tilt_deg", "roll_deg"],
        "yaw_deg": "turns the top of an image that looks straight down clockwise from north",
        "tilt_deg": "then raises the view towards the top of the image; 90 looks at the horizon",
        "roll_deg": "then turns the camera about the direction of the image's top, right side down",
        "local_axes": {"enu": ["east", "north", "up"], "ned": ["north", "east", "down"]},
    },
    "depth": {"kind": "along the view", "unit": "m", "without_ground": "NaN"},
    "time": {"base": "UTC", "epoch": "1970-01-01T00:00:00Z", "unit": "s"},
    "digits": {
        "intrinsics": {"decimals": PIXEL_DECIMALS},
        "poses": "float64, in the fewest digits that give the same number back",
        "metadata_of_images": {"decimals_of_degrees": DEGREE_DECIMALS, "significant_of_others": FIGURE_DIGITS},
    },
}


@dataclass(frozen=True)
class CameraContract:
    """What the pixels of a picture mean; see `CONVENTIONS` for what all pictures share.

    Parameters
    ----------
    width_px, height_px : int
    fx_px, fy_px : float
        Focal lengths along rows and columns.
    cx_px, cy_px : float
        Principal point; (0.5, 0.5) is the centre of the first pixel.
    lens : str
        ``perspective`` or ``fisheye``.
    distortion : tuple of (str, float)
        Coefficients in OpenCV's order; empty without distortion.
    """

    width_px: int
    height_px: int
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    lens: str = PERSPECTIVE
    distortion: tuple[tuple[str, float], ...] = ()

    @classmethod
    def of_lens(
        cls, lens: Lens, size_px: tuple[int, int], focal_px: tuple[float, float], centre_px: tuple[float, float]
    ) -> CameraContract:
        """Contract of a picture that a lens makes."""
        return cls(*size_px, *focal_px, *centre_px, lens.lens, stated_distortion(lens.lens, lens.coefficients))

    @property
    def rounded(self) -> CameraContract:
        """The same as files state it, with `PIXEL_DECIMALS`."""
        lengths = np.array([self.fx_px, self.fy_px, self.cx_px, self.cy_px])
        fx, fy, cx, cy = np.round(lengths, PIXEL_DECIMALS).tolist()
        return replace(self, fx_px=fx, fy_px=fy, cx_px=cx, cy_px=cy)

    @property
    def coefficients(self) -> tuple[float, ...]:
        """Coefficients in OpenCV's order, for `cv2.projectPoints` or, of a fisheye, `cv2.fisheye.projectPoints`."""
        return tuple(value for _, value in self.distortion)

    @property
    def k(self) -> Floats:
        """Intrinsics (3, 3) as OpenCV has them, with (0, 0) in the centre of the first pixel."""
        return np.array([[self.fx_px, 0.0, self.cx_px - 0.5], [0.0, self.fy_px, self.cy_px - 0.5], [0.0, 0.0, 1.0]])

    @property
    def colmap(self) -> tuple[str, tuple[float, ...]]:
        """COLMAP's model and its parameters."""
        pinhole, more = (self.fx_px, self.fy_px, self.cx_px, self.cy_px), self.coefficients
        if self.lens == FISHEYE:
            return "OPENCV_FISHEYE", (*pinhole, *more)
        if any(more[4:]):
            return "FULL_OPENCV", (*pinhole, *more)
        return ("OPENCV", (*pinhole, *more[:4])) if any(more) else ("PINHOLE", pinhole)

    @property
    def nerfstudio(self) -> dict[str, Any]:
        """Nerfstudio's model and coefficients.

        Raises
        ------
        InvalidInput
            Nerfstudio has no such lens.
        """
        values = dict(self.distortion)
        if self.lens == PERSPECTIVE:
            rational = [values.pop(name, 0.0) for name in ("k4", "k5", "k6")]
            if any(rational):
                raise InvalidInput(
                    "lens with k4 {0:g}, k5 {1:g} and k6 {2:g}: nerfstudio has no such lens, and COLMAP has",
                    *rational,
                    field="k4",
                )
            values = {name: values.get(name, 0.0) for name in ("k1", "k2", "k3", "p1", "p2")}
        model = "OPENCV_FISHEYE" if self.lens == FISHEYE else "OPENCV"
        # Nerfstudio takes k3 for 0 unless it is given.
        return {"camera_model": model, **{name: value for name, value in values.items() if name != "k3" or value}}

    @property
    def ros(self) -> dict[str, Any]:
        """Fields of the message ``sensor_msgs/CameraInfo`` besides its header, with OpenCV's pixel centres."""
        more = self.coefficients
        if self.lens == FISHEYE:
            model, values = "equidistant", more
        elif any(more[5:]):
            model, values = "rational_polynomial", more
        else:
            model, values = "plumb_bob", more[:5] or (0.0,) * 5
        k = self.k
        return {
            "height": self.height_px,
            "width": self.width_px,
            "distortion_model": model,
            "d": list(values),
            "k": k.ravel().tolist(),
            "r": np.eye(3).ravel().tolist(),
            "p": np.hstack([k, np.zeros((3, 1))]).ravel().tolist(),
        }

    @property
    def intrinsics(self) -> dict[str, Any]:
        """The part of the JSON form that differs from camera to camera."""
        return {
            "width_px": self.width_px,
            "height_px": self.height_px,
            "fx_px": self.fx_px,
            "fy_px": self.fy_px,
            "cx_px": self.cx_px,
            "cy_px": self.cy_px,
            "lens": self.lens,
            "distortion": dict(self.distortion),
        }

    def to_json(self) -> dict[str, Any]:
        """JSON form, with the conventions that all pictures share."""
        return {"schema": SCHEMA, **self.intrinsics, **CONVENTIONS}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> CameraContract:
        """Contract from its JSON form.

        Raises
        ------
        InvalidInput
            Keys are missing, or of another version.
        """
        if data.get("schema") != SCHEMA:
            raise InvalidInput("camera contract of version {0}: must be {1}", data.get("schema"), SCHEMA)
        try:
            width, height = (int(data[name]) for name in ("width_px", "height_px"))
            fx, fy, cx, cy = (float(data[name]) for name in ("fx_px", "fy_px", "cx_px", "cy_px"))
            distortion = tuple((str(name), float(value)) for name, value in data["distortion"].items())
            return cls(width, height, fx, fy, cx, cy, str(data["lens"]), distortion)
        except (KeyError, TypeError, ValueError, AttributeError) as wrong:
            raise InvalidInput("camera contract: lacks or misstates {0}", wrong) from wrong


def stated_distortion(lens: str, coefficients: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    """Coefficients by name in OpenCV's order; none for a perspective lens without distortion."""
    return tuple(coefficients.items()) if lens == FISHEYE or any(coefficients.values()) else ()
