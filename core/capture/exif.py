"""EXIF of a picture: who, what, when, and the camera's place, heading and optics (EXIF 3.0, CIPA DC-008-2023)."""

from __future__ import annotations

from datetime import datetime
from typing import NamedTuple

from .description import SOFTWARE, Description
from .digits import degrees, figure
from .exposure import Exposure
from .tiff import HEADER_BYTES, Kind, Tag, directory, header, rational

#: The camera is a simulated one, and its maker this program. Readers turn the angles of some makers' cameras.
MAKE = SOFTWARE
#: Denominator of the seconds of arc in positions: 3 micrometres of ground, and the numerator fits 32 bits.
_ARC_SECOND_SHARE = 10_000_000
#: Denominator of a heading.
_HEADING_SHARE = 1_000_000
_MICROSECONDS = 1_000_000
_CENTIMETRE = 3
_MM_PER_CM = 10.0


class FocalTags(NamedTuple):
    """Focal length in mm and px of the picture per cm of the sensor, each as numerator and denominator."""

    length_mm: list[int]
    x_px_per_cm: list[int]
    y_px_per_cm: list[int]

    @classmethod
    def of(cls, focal_length_mm: float, focal_x_px: float, focal_y_px: float) -> FocalTags:
        """Tags whose product is the focal length in px, to the digits of a figure, however that in mm is rounded."""
        length = rational(figure(focal_length_mm))
        per_px = length[0] / length[1] / _MM_PER_CM
        return cls(length, rational(figure(focal_x_px) / per_px), rational(figure(focal_y_px) / per_px))

    def ratio(self, width_px: int) -> float:
        """Focal length in widths of the picture, in the steps in which OpenSfM and OpenDroneMap work it out.

        They name cameras by its first digits.
        """
        units_per_pixel = 1.0 / (self.x_px_per_cm[0] / self.x_px_per_cm[1])
        sensor_width = width_px * units_per_pixel * int(_MM_PER_CM)
        return self.length_mm[0] / self.length_mm[1] / sensor_width


def exif(description: Description) -> bytes:
    """TIFF structure with the directories of the picture, its exposure and its position."""
    exposure = description.exposure
    own = [
        Tag(270, Kind.ASCII, description.title),
        Tag(274, Kind.SHORT, [1]),  # orientation: as it is
        Tag(305, Kind.ASCII, SOFTWARE),
        Tag(33432, Kind.ASCII, description.attribution),
    ]
    below = [(34853, _position(description))]
    if exposure is not None:
        own += [Tag(271, Kind.ASCII, MAKE), Tag(272, Kind.ASCII, exposure.body.model)]
        below.insert(0, (34665, _exposure(exposure)))

    def root(offsets: list[int]) -> bytes:
        pointers = [Tag(number, Kind.LONG, [at]) for (number, _), at in zip(below, offsets)]
        return directory([*own, *pointers], HEADER_BYTES)

    at, parts, offsets = HEADER_BYTES + len(root([0] * len(below))), [], []
    for _, tags in below:
        offsets.append(at)
        parts.append(directory(tags, at))
        at += len(parts[-1])
    return b"".join([header(), root(offsets), *parts])


def _exposure(exposure: Exposure) -> list[Tag]:
    focal = FocalTags.of(exposure.body.focal_length_mm, *exposure.focal_px)
    tags = [
        Tag(36864, Kind.UNDEFINED, b"0300"),  # ExifVersion
        Tag(37386, Kind.RATIONAL, focal.length_mm),
        Tag(40961, Kind.SHORT, [1]),  # sRGB
        Tag(40962, Kind.LONG, [exposure.size_px[0]]),
        Tag(40963, Kind.LONG, [exposure.size_px[1]]),
        Tag(41486, Kind.RATIONAL, focal.x_px_per_cm),
        Tag(41487, Kind.RATIONAL, focal.y_px_per_cm),
        Tag(41488, Kind.SHORT, [_CENTIMETRE]),
    ]
    if exposure.taken is not None:
        tags += [
            Tag(36867, Kind.ASCII, f"{_date(exposure.taken)} {exposure.taken:%H:%M:%S}"),
            Tag(36881, Kind.ASCII, "+00:00"),
            Tag(37521, Kind.ASCII, f"{exposure.taken.microsecond:06d}"),
        ]
    return tags


def _position(description: Description) -> list[Tag]:
    """Tags of the camera's place; the altitude counts from the ellipsoid.

    That is what references 0 and 1 mean since version 2.4 of these tags; before, they counted from the sea.
    """
    lat, lon, exposure = degrees(description.lat_deg), description.wrapped_lon_deg, description.exposure
    altitude_m = figure(description.agl_m if exposure is None else exposure.altitude_m)
    heading = round(description.yaw_deg % 360.0 * _HEADING_SHARE) % (360 * _HEADING_SHARE)
    tags = [
        Tag(0, Kind.BYTE, [2, 4, 0, 0]),  # GPSVersionID
        Tag(1, Kind.ASCII, "S" if lat < 0.0 else "N"),
        Tag(2, Kind.RATIONAL, _degrees_minutes_seconds(lat)),
        Tag(3, Kind.ASCII, "W" if lon < 0.0 else "E"),
        Tag(4, Kind.RATIONAL, _degrees_minutes_seconds(lon)),
        Tag(5, Kind.BYTE, [int(altitude_m < 0.0)]),
        Tag(6, Kind.RATIONAL, rational(abs(altitude_m))),
        Tag(16, Kind.ASCII, "T"),  # heading from true north
        Tag(17, Kind.RATIONAL, [heading, _HEADING_SHARE]),
        Tag(18, Kind.ASCII, "WGS-84"),
    ]
    if exposure is not None and exposure.taken is not None:
        taken = exposure.taken
        seconds = taken.second * _MICROSECONDS + taken.microsecond
        time = [taken.hour, 1, taken.minute, 1, seconds, _MICROSECONDS]
        tags += [Tag(7, Kind.RATIONAL, time), Tag(29, Kind.ASCII, _date(taken))]
    return tags


def _date(day: datetime) -> str:
    # `strftime` fills up years before 1000 on some systems only.
    return f"{day.year:04d}:{day.month:02d}:{day.day:02d}"


def _degrees_minutes_seconds(angle_deg: float) -> list[int]:
    """Numerators and denominators of degrees, minutes and seconds."""
    shares = round(abs(angle_deg) * 3600 * _ARC_SECOND_SHARE)
    minutes, seconds = divmod(shares, 60 * _ARC_SECOND_SHARE)
    degrees, minutes = divmod(minutes, 60)
    return [degrees, 1, minutes, 1, seconds, _ARC_SECOND_SHARE]
