"""Linear light and the values of images that show it: sRGB, tone curves, exposure, metering and white balance.

Values of images are sRGB (IEC 61966-2-1). Light of 1 is the white of the image; in an exposed image, white is the light
that saturates the sensor.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from ..arrays import Flags, Floats, NDArray, PixelValues

#: Tone curves from linear light to values: that of sRGB, none, and Narkowicz's fit to the curve of ACES.
SRGB, LINEAR, FILMIC = "srgb", "linear", "filmic"
#: Shares of red, green and blue light in luminance, those of sRGB (IEC 61966-2-1).
LUMINANCE = (0.2126, 0.7152, 0.0722)
#: What a meter brings to its target: the mean of the logarithms of luminance, or the brightest part of the image.
AVERAGE, HIGHLIGHTS = "average", "highlights"
#: Average luminance as a share of saturation: that of a grey card of 18 %, after Reinhard et al. (2002).
MIDDLE_GREY = 0.18
#: Percentile of the luminance that the metering of highlights brings to saturation.
HIGHLIGHT_PERCENT = 99.0
#: Illuminance of a sensor in lux for a luminance of 1 cd/m² and an f-number of 1 (q of ISO 12232): pi/4 times what a
#: lens transmits, 0.9, what its barrel leaves, 0.98, and cos⁴ of 10°.
LENS_SHARE = 0.65
#: Exposure in lux seconds that saturates a sensor, times its ISO speed (ISO 12232, saturation-based speed).
SATURATION_LX_S = 78.0
#: Steps of linear light in which the nearest value is looked up: each holds at most one border between two values.
_STEPS = 1 << 12
#: Values of an image that are encoded together, which fit in the processor's cache.
_BATCH = 1 << 16
#: Coefficients of Narkowicz's curve x(a x + b) / (x(c x + d) + e).
_FILMIC = 2.51, 0.03, 2.43, 0.59, 0.14
#: Luminance added to avoid the logarithm of 0, after Reinhard et al. (2002), as a share of white.
_BLACK = 1e-4


def linear(values: Floats) -> Floats:
    """Linear light (any shape) of sRGB values; both are 0 for black and 1 for white."""
    found: Floats = np.where(values <= 0.04045, values / 12.92, ((np.maximum(values, 0.0) + 0.055) / 1.055) ** 2.4)
    return found


def encoded(light: Floats) -> Floats:
    """SRGB values (any shape) of linear light, the inverse of `linear`; light beyond 0 and 1 is cut off."""
    cut = np.clip(light, 0.0, 1.0)
    found: Floats = np.where(cut <= 0.0031308, cut * 12.92, 1.055 * cut ** (1.0 / 2.4) - 0.055)
    return found


def linear_of_bytes(pixels: PixelValues) -> NDArray[np.float32]:
    """Linear light of sRGB values of 8 bits."""
    return _levels().take(pixels, mode="clip")


def bytes_of_linear(light: NDArray[np.float32], tone: str = SRGB) -> NDArray[np.uint8]:
    """The 8-bit values nearest to linear light after a tone curve; light beyond 0 and 1 is cut off.

    A table gives the value at the beginning of the step that holds the light. Comparing with the border above it makes
    it exact, and needs no power, of which processors differ.
    """
    values, (first, borders) = np.empty(light.shape, np.uint8), _table(tone)
    light, flat = np.ascontiguousarray(light).reshape(-1), values.reshape(-1)
    cut, step = np.empty(_BATCH, np.float32), np.empty(_BATCH, np.intp)
    for start in range(0, flat.size, _BATCH):
        found = flat[start : start + _BATCH]
        some, at = cut[: found.size], step[: found.size]
        np.clip(light[start : start + _BATCH], 0.0, 1.0, out=some)
        np.multiply(some, np.float32(_STEPS), out=at, casting="unsafe")
        first.take(at, out=found, mode="clip")
        found += some >= borders.take(found, mode="clip")
    return values


def saturation_share(illuminance_lx: float, exposure_s: float, f_number: float, iso: float) -> float:
    """Share of a sensor's saturation that a white diffuser reaches.

    White has the luminance E/pi. The sensor gets 0.65 L t / N² lux seconds of it, and saturates at 78/S (ISO 12232).

    Parameters
    ----------
    illuminance_lx : float
        Illuminance of the scene E in lux.
    exposure_s : float
        Exposure time t in seconds.
    """
    exposure_lx_s = LENS_SHARE * illuminance_lx / math.pi * exposure_s / f_number**2
    return exposure_lx_s * iso / SATURATION_LX_S


def white_exposure_s(illuminance_lx: float, f_number: float, iso: float) -> float:
    """Exposure time in seconds at which a white diffuser just saturates a sensor; see `saturation_share`."""
    return 1.0 / saturation_share(illuminance_lx, 1.0, f_number, iso)


def metered_gain(light: NDArray[np.float32], metering: str, seen: Flags | None = None) -> float:
    """Factor that exposes light as a meter asks; 1 for an image without light.

    Parameters
    ----------
    light : array (h, w, channels)
        Grey, or red, green and blue.
    metering : str
        `AVERAGE`: the mean of the logarithms of luminance becomes `MIDDLE_GREY`. `HIGHLIGHTS`: the
        `HIGHLIGHT_PERCENT` percentile of the brightest channel becomes 1.
    seen : array (h, w) or None
        Pixels that count; None for all.
    """
    # Some ten thousand pixels are enough for a meter.
    stride = max(math.isqrt(light.shape[0] * light.shape[1]) // 128, 1)
    some = light[::stride, ::stride].astype(np.float64)
    if seen is not None:
        some = some[seen[::stride, ::stride]]
    some = some.reshape(-1, light.shape[2])
    if not some.any():
        return 1.0
    if metering == HIGHLIGHTS:
        level, target = float(np.percentile(some.max(axis=1), HIGHLIGHT_PERCENT)), 1.0
    else:
        luminance = some @ np.array(LUMINANCE) if light.shape[2] == 3 else some[:, 0]
        level, target = float(np.exp(np.mean(np.log(luminance + _BLACK)))) - _BLACK, MIDDLE_GREY
    return target / max(level, _BLACK)


def chromaticity(temperature_k: float) -> tuple[float, float]:
    """CIE 1931 x and y of light of a colour temperature.

    Daylight from 4,000 K (CIE 15:2018, 3.1), a Planckian radiator below (Krystek 1985, within 4e-4 of Planck's law).
    """
    t = temperature_k
    if t < 4000.0:
        u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t) / (1 + 8.42420235e-4 * t + 7.08145163e-7 * t * t)
        v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t) / (1 - 2.89741816e-5 * t + 1.61456053e-7 * t * t)
        return 3.0 * u / (2.0 * u - 8.0 * v + 4.0), 2.0 * v / (2.0 * u - 8.0 * v + 4.0)
    if t <= 7000.0:
        x = 0.244063 + 0.09911e3 / t + 2.9678e6 / t**2 - 4.6070e9 / t**3
    else:
        x = 0.237040 + 0.24748e3 / t + 1.9018e6 / t**2 - 2.0064e9 / t**3
    return x, -3.000 * x * x + 2.870 * x - 0.275


def white_balance(temperature_k: float) -> Floats:
    """Matrix (3, 3) that takes linear sRGB to a camera whose white balance is set to a colour temperature.

    The camera shows light of this temperature as white; the scene is lit by D65, the white of sRGB, which is daylight
    of 6,504 K. It is the adaptation of Bradford (Lam 1985), as in ICC profiles, from the one white to the other.
    """
    to_xyz, bradford = _srgb_to_xyz(), np.array(_BRADFORD)
    source, target = bradford @ _white_xyz(*chromaticity(temperature_k)), bradford @ _white_xyz(*_D65)
    adapted = np.linalg.inv(bradford) @ np.diag(target / source) @ bradford
    matrix: Floats = np.linalg.inv(to_xyz) @ adapted @ to_xyz
    return matrix


def mixed(light: NDArray[np.float32], matrix: Floats) -> NDArray[np.float32]:
    """Light (h, w, 3) of channels that are mixed by a matrix (3, 3); negative light becomes 0."""
    found, factors = np.empty(light.shape, np.float32), matrix.astype(np.float32)
    rows = max(_BATCH // max(light.shape[1], 1), 1)
    for top in range(0, len(light), rows):
        some = light[top : top + rows]
        channels = [np.ascontiguousarray(some[..., channel]) for channel in range(3)]
        # Sums in a stated order, which libraries of linear algebra choose by processor.
        for channel, (red, green, blue) in enumerate(factors):
            total = channels[0] * red
            total += channels[1] * green
            total += channels[2] * blue
            np.maximum(total, np.float32(0.0), out=found[top : top + rows, :, channel])
    return found


#: Chromaticities of the primaries and the white of sRGB (IEC 61966-2-1).
_PRIMARIES = (0.64, 0.33), (0.30, 0.60), (0.15, 0.06)
_D65 = 0.3127, 0.3290
#: Responses of Bradford's cones to X, Y and Z.
_BRADFORD = (0.8951, 0.2664, -0.1614), (-0.7502, 1.7135, 0.0367), (0.0389, -0.0685, 1.0296)


def _white_xyz(x: float, y: float) -> Floats:
    """X, Y and Z of light of luminance 1."""
    return np.array([x / y, 1.0, (1.0 - x - y) / y])


def _srgb_to_xyz() -> Floats:
    """Matrix (3, 3) from linear sRGB to X, Y and Z: the primaries, so strong that together they are white."""
    primaries = np.stack([_white_xyz(*one) for one in _PRIMARIES], axis=1)
    matrix: Floats = primaries * np.linalg.solve(primaries, _white_xyz(*_D65))
    return matrix


@cache
def _levels() -> NDArray[np.float32]:
    return linear(np.arange(256) / 255.0).astype(np.float32)


@cache
def _table(tone: str) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """The value at the beginning of each step of light, and the light at which each value ends."""
    ends = (np.arange(255) + 0.5) / 255.0
    if tone == SRGB:
        ends = linear(ends)
    elif tone == FILMIC:
        ends = _filmic_light(linear(ends))
    borders = ends.astype(np.float32)
    first = np.searchsorted(borders, (np.arange(_STEPS + 1) / _STEPS).astype(np.float32), side="right")
    return first.astype(np.uint8), np.append(borders, np.float32(np.inf))


def _filmic_light(shown: Floats) -> Floats:
    """Light of what the filmic curve shows, both linear; the curve takes white to white."""
    a, b, c, d, e = _FILMIC
    white = (a + b) / (c + d + e)
    y = shown * white
    # The positive root of (a - c y) x² + (b - d y) x - e y = 0.
    square, half = a - c * y, (b - d * y) / 2.0
    found: Floats = (np.sqrt(half * half + square * e * y) - half) / square
    return found
