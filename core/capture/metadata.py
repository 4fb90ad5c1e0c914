"""Metadata of image files: description, EXIF and XMP.

EXIF holds maker, title, time, and the camera's position, heading and optics (EXIF 3.0, CIPA DC-008-2023); XMP holds the
attitude and the optics in the namespace that mapping software reads. Yaw, pitch and roll turn an aircraft whose camera
looks down, in this order about body axes (z-y'-x'' with x ahead, y to the right, z down): with all angles 0, north is
at the top of the image; with pitch 90, the camera looks ahead. The angles equal yaw, tilt and roll of
`Camera.rays_enu`; OpenSfM and OpenDroneMap read them like this (Bäumker and Heimes 2001).

Numbers are rounded, as processors differ in the last digits of sines, which would change every file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime
from html import escape
from typing import NamedTuple

import numpy as np

from ..geodesy.contract import DEGREE_DECIMALS, FIGURE_DIGITS
from ..geodesy.mercator import wrap_lon_deg
from ..picture.optics import CameraSettings, Exposure
from .tiff import HEADER_BYTES, Tag, TagType, directory, header, rational

#: Program, and maker of the simulated camera; readers turn the angles of cameras from some other makers.
SOFTWARE = MAKE = "TerrAInav"
NAMESPACE = "http://pix4d.com/camera/1.0/"


@dataclass(frozen=True)
class Description:
    """Metadata of an image.

    Parameters
    ----------
    name : str
        Name of the image, without ending.
    source, attribution : str
        Title of the source and the credit it requires; characters that files cannot hold are replaced.
    lat_deg, lon_deg, agl_m, yaw_deg, tilt_deg, roll_deg : float
        Pose of the camera; the longitude may be continuous beyond ±180.
    imagery_date : str
        Empty where unknown.
    effective_gsd_m_per_px : float or None
        Ground resolution, which enlarged pixels do not improve.
    more : tuple of (str, str)
        Names and values added to the metadata.
    exposure : Exposure or None
        Exposure of a JPEG; None for other formats.
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
        """Title in one line."""
        return f"{self.name} {self.map_type}, {self.source}"

    @property
    def wrapped_lon_deg(self) -> float:
        """Longitude in degrees, in [-180, 180)."""
        return degrees(float(wrap_lon_deg(np.asarray(degrees(self.lon_deg)))))

    def metadata(self) -> dict[str, str]:
        """Names and values that GDAL shows, the same in all formats."""
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


class FocalTags(NamedTuple):
    """Focal length in mm, and pixels per cm of the sensor, each as numerator and denominator."""

    length_mm: list[int]
    x_px_per_cm: list[int]
    y_px_per_cm: list[int]

    @classmethod
    def from_lengths(cls, focal_length_mm: float, focal_x_px: float, focal_y_px: float) -> FocalTags:
        """Tags whose product is the focal length in px to six digits (see `figure`), despite the rounding in mm."""
        length = rational(figure(focal_length_mm))
        per_px = length[0] / length[1] / 10.0  # cm
        return cls(length, rational(figure(focal_x_px) / per_px), rational(figure(focal_y_px) / per_px))

    def ratio(self, width_px: int) -> float:
        """Focal length in image widths, computed in the steps of OpenSfM and OpenDroneMap.

        Both name cameras by the first digits of this ratio.
        """
        units_per_pixel = 1.0 / (self.x_px_per_cm[0] / self.x_px_per_cm[1])
        sensor_width = width_px * units_per_pixel * 10
        return self.length_mm[0] / self.length_mm[1] / sensor_width


def exif(description: Description) -> bytes:
    """TIFF structure with directories of the image, its exposure and its position."""
    exposure = description.exposure
    image_tags = [
        Tag(270, TagType.ASCII, description.title),
        Tag(274, TagType.SHORT, [1]),  # orientation: as it is
        Tag(305, TagType.ASCII, SOFTWARE),
        Tag(33432, TagType.ASCII, description.attribution),
    ]
    below = [(34853, _position(description))]
    if exposure is not None:
        image_tags += [Tag(271, TagType.ASCII, MAKE), Tag(272, TagType.ASCII, exposure.body.model)]
        below.insert(0, (34665, _exposure(exposure)))

    def root(offsets: list[int]) -> bytes:
        pointers = [Tag(number, TagType.LONG, [at]) for (number, _), at in zip(below, offsets)]
        return directory([*image_tags, *pointers], HEADER_BYTES)

    at, parts, offsets = HEADER_BYTES + len(root([0] * len(below))), [], []
    for _, tags in below:
        offsets.append(at)
        parts.append(directory(tags, at))
        at += len(parts[-1])
    return b"".join([header(), root(offsets), *parts])


def xmp(description: Description, exposure: Exposure) -> bytes:
    """XMP packet (ISO 16684-1) with names of the ``Camera`` namespace as attributes, in one line.

    OpenSfM searches for the element ``x:xmpmeta`` in ``str`` of the file's bytes, where line ends are not white space.
    """
    length = exposure.body.focal_length_mm
    x_mm, y_mm = (at * length / focal for at, focal in zip(exposure.centre_px, exposure.focal_px))
    across_m, in_height_m = exposure.accuracy_m
    values = {
        "Yaw": repr(degrees(description.yaw_deg)),
        "Pitch": repr(degrees(description.tilt_deg)),
        "Roll": repr(degrees(description.roll_deg)),
        "GPSXYAccuracy": repr(accuracy(across_m)),
        "GPSZAccuracy": repr(accuracy(in_height_m)),
        "ModelType": exposure.body.lens,
        "PrincipalPoint": f"{figure(x_mm)!r},{figure(y_mm)!r}",
        "PerspectiveFocalLength": repr(figure(length)),
        "AboveGroundAltitude": repr(figure(description.agl_m)),
    }
    attributes = " ".join(f'Camera:{name}="{value}"' for name, value in values.items())
    return (
        '<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>'
        '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
        f'<rdf:Description rdf:about="" xmlns:Camera="{NAMESPACE}" {attributes}/>'
        '</rdf:RDF></x:xmpmeta><?xpacket end="r"?>'
    ).encode()


def degrees(angle_deg: float) -> float:
    """Round an angle in degrees for files; never -0."""
    return round(float(angle_deg), DEGREE_DECIMALS) + 0.0


def metres(length_m: float) -> float:
    """Round a height or depth for files to 0.1 mm, like `degrees`; never -0."""
    return round(float(length_m), 4) + 0.0


def accuracy(metres: float) -> float:
    """Round the accuracy of a position for files to 0.1 mm, a hundredth of the finest accuracy, 0.01 m."""
    return round(float(metres), 4)


def figure(value: float) -> float:
    """Round other numbers for files to `FIGURE_DIGITS` significant digits; never -0."""
    return float(f"{value:.{FIGURE_DIGITS}g}") + 0.0


def plain_text(text: str) -> str:
    """Replace characters that XML 1.0 excludes: control characters and unpaired surrogates."""
    excluded = "[\0-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]"
    return re.sub(excluded, "\N{REPLACEMENT CHARACTER}", text)


def xml_text(text: str) -> str:
    """Escape text for XML 1.0."""
    return escape(plain_text(text), quote=True)


def _exposure(exposure: Exposure) -> list[Tag]:
    focal = FocalTags.from_lengths(exposure.body.focal_length_mm, *exposure.focal_px)
    tags = [
        Tag(36864, TagType.UNDEFINED, b"0300"),  # ExifVersion
        Tag(37386, TagType.RATIONAL, focal.length_mm),
        Tag(40961, TagType.SHORT, [1]),  # sRGB
        Tag(40962, TagType.LONG, [exposure.size_px[0]]),
        Tag(40963, TagType.LONG, [exposure.size_px[1]]),
        Tag(41486, TagType.RATIONAL, focal.x_px_per_cm),
        Tag(41487, TagType.RATIONAL, focal.y_px_per_cm),
        Tag(41488, TagType.SHORT, [3]),  # resolution unit: cm
    ]
    tags += _settings(exposure.settings)
    if exposure.taken is not None:
        tags += [
            Tag(36867, TagType.ASCII, f"{_date(exposure.taken)} {exposure.taken:%H:%M:%S}"),
            Tag(36881, TagType.ASCII, "+00:00"),
            Tag(37521, TagType.ASCII, f"{exposure.taken.microsecond:06d}"),
        ]
    return tags


def _settings(settings: CameraSettings) -> list[Tag]:
    """Tags of the settings of the camera that are stated."""
    tags = []
    if settings.exposure_ms is not None:
        tags.append(Tag(33434, TagType.RATIONAL, rational(settings.exposure_ms / 1000.0)))
        tags.append(Tag(41986, TagType.SHORT, [int(not settings.is_automatic)]))  # ExposureMode
    if settings.f_number is not None:
        tags.append(Tag(33437, TagType.RATIONAL, rational(settings.f_number)))
    if settings.iso is not None:
        speed = max(round(settings.iso), 1)
        tags.append(Tag(34855, TagType.SHORT, [min(speed, (1 << 16) - 1)]))  # PhotographicSensitivity
        tags.append(Tag(34864, TagType.SHORT, [3]))  # SensitivityType: ISO speed
        tags.append(Tag(34867, TagType.LONG, [speed]))  # ISOSpeed
    if settings.white_balance_k is not None:
        tags.append(Tag(41987, TagType.SHORT, [1]))  # WhiteBalance: manual
    return tags


def _position(description: Description) -> list[Tag]:
    """Tags of the camera's position; the altitude is above the ellipsoid, as GPS tags allow since version 2.4."""
    lat, lon, exposure = degrees(description.lat_deg), description.wrapped_lon_deg, description.exposure
    altitude_m = figure(description.agl_m if exposure is None else exposure.altitude_m)
    million = 1_000_000
    heading = round(description.yaw_deg % 360.0 * million) % (360 * million)
    tags = [
        Tag(0, TagType.BYTE, [2, 4, 0, 0]),  # GPSVersionID
        Tag(1, TagType.ASCII, "S" if lat < 0.0 else "N"),
        Tag(2, TagType.RATIONAL, _degrees_minutes_seconds(lat)),
        Tag(3, TagType.ASCII, "W" if lon < 0.0 else "E"),
        Tag(4, TagType.RATIONAL, _degrees_minutes_seconds(lon)),
        Tag(5, TagType.BYTE, [int(altitude_m < 0.0)]),
        Tag(6, TagType.RATIONAL, rational(abs(altitude_m))),
        Tag(16, TagType.ASCII, "T"),  # heading from true north
        Tag(17, TagType.RATIONAL, [heading, million]),
        Tag(18, TagType.ASCII, "WGS-84"),
    ]
    if exposure is not None and exposure.taken is not None:
        taken = exposure.taken
        time = [taken.hour, 1, taken.minute, 1, taken.second * million + taken.microsecond, million]
        tags += [Tag(7, TagType.RATIONAL, time), Tag(29, TagType.ASCII, _date(taken))]
    return tags


def _date(day: datetime) -> str:
    # Some systems' `strftime` does not pad years before 1000.
    return f"{day.year:04d}:{day.month:02d}:{day.day:02d}"


def _degrees_minutes_seconds(angle_deg: float) -> list[int]:
    """Numerators and denominators of degrees, minutes and seconds."""
    # A unit is 3 micrometres of ground, and the numerator of the seconds fits in 32 bits.
    denominator = 10_000_000
    minutes, seconds = divmod(round(abs(angle_deg) * 3600 * denominator), 60 * denominator)
    degrees, minutes = divmod(minutes, 60)
    return [degrees, 1, minutes, 1, seconds, denominator]
