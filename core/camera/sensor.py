"""Image sensors after the linear model of EMVA 1288 (release 4.0 Linear): photons, electrons, digital numbers."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..arrays import NDArray

Singles = NDArray[np.float32]
#: Photons of a lumen second at 555 nm, where 683 lm are 1 W: wavelength / (683 lm/W * h * c).
PHOTONS_PER_LM_S = 555e-9 / (683.0 * 6.62607015e-34 * 299_792_458.0)
#: Mean number of electrons from which counts follow from a normal deviate; see `poisson_counts`.
LEAST_NORMAL_E = 24.0
#: Values computed at a time: their arrays stay in the processor's cache, and large images take little memory.
_BLOCK = 1 << 16
_FEW = 1 << 13


@dataclass(frozen=True)
class Detector:
    """Pixels and converter of a sensor.

    Parameters
    ----------
    pixel_um : float
        Pitch of the square pixels.
    quantum_efficiency : float
        Electrons per photon, above 0 and at most 1.
    full_well_e : float
        Saturation capacity.
    read_noise_e : float
        Temporal dark noise, as a standard deviation.
    dark_current_e_per_s : float
    dsnu_e, prnu : float
        Dark signal and photo response non-uniformity, as standard deviations: in electrons, and as a share.
    gain_dn_per_e : float
        Overall system gain K.
    black_level_dn : float
    bits : int
        Bits of the converter.
    """

    pixel_um: float
    quantum_efficiency: float
    full_well_e: float
    read_noise_e: float
    dark_current_e_per_s: float
    dsnu_e: float
    prnu: float
    gain_dn_per_e: float
    black_level_dn: float
    bits: int

    @property
    def most_dn(self) -> int:
        """Largest value of the converter."""
        return int(2**self.bits - 1)

    @property
    def saturated_dn(self) -> float:
        """Value from which a pixel counts as saturated: three standard deviations of the noise below saturation."""
        full_dn = min(self.most_dn, self.black_level_dn + self.gain_dn_per_e * self.full_well_e)
        return full_dn - 3.0 * self.gain_dn_per_e * math.hypot(self.read_noise_e, self.dsnu_e)

    @property
    def photons_per_lx_s(self) -> float:
        """Photons on a pixel per lux second, as if all light were of 555 nm."""
        return PHOTONS_PER_LM_S * (self.pixel_um * 1e-6) ** 2

    @property
    def electrons_per_lx_s(self) -> float:
        """Electrons in a pixel per lux second."""
        return self.quantum_efficiency * self.photons_per_lx_s

    @property
    def saturation_lx_s(self) -> float:
        """Exposure at which the pixel or the converter saturates, whichever is first."""
        electrons = min(self.full_well_e, (self.most_dn - self.black_level_dn) / self.gain_dn_per_e)
        return electrons / self.electrons_per_lx_s

    def exposure_lx_s(self, raw: NDArray[np.uint16]) -> Singles:
        """Exposure that raw values (any shape) stand for; noise makes it negative in the dark."""
        scale = np.float32(1.0 / (self.gain_dn_per_e * self.electrons_per_lx_s))
        found: Singles = (raw.astype(np.float32) - np.float32(self.black_level_dn)) * scale
        return found


class Deviates:
    """Random numbers that depend on a key alone.

    They are bits of PCG64, which numpy keeps as they are, unlike its distributions.
    """

    def __init__(self, *key: object) -> None:
        digest = hashlib.blake2b(":".join(map(str, key)).encode("utf-8", "surrogatepass"), digest_size=16).digest()
        self._bits = np.random.PCG64(np.random.SeedSequence(int.from_bytes(digest, "big")))

    def draw(self, count: int) -> NDArray[np.uint16]:
        """The next numbers (count,), each of 16 bits."""
        raw: NDArray[np.uint64] = self._bits.random_raw(-(-count // 4))
        return raw.astype("<u8", copy=False).view("<u2")[:count]

    def normal(self, count: int) -> Singles:
        """The next standard normal deviates (count,); none is beyond 4.4."""
        found: Singles = _quantiles()[self.draw(count)]
        return found


@cache
def _quantiles() -> Singles:
    """Standard normal quantiles of the middles of 65,536 equal shares, scaled to a variance of 1."""
    # It takes longer to import than all else here.
    from statistics import NormalDist

    half = np.array([NormalDist().inv_cdf((at + 0.5) / 65536.0) for at in range(32768)])
    both = np.concatenate([half, -half[::-1]])
    found: Singles = (both / both.std()).astype(np.float32)
    return found


def poisson_counts(mean: Singles, draws: NDArray[np.uint16]) -> Singles:
    """Poisson counts (n,) of means (n,), one for each number of 16 bits.

    Below `LEAST_NORMAL_E` the exact distribution is inverted. From there on, counts are normal deviates z with the
    first term of the Cornish-Fisher expansion, rounded: mean + sqrt(mean - 5/36) z + (z² - 1)/6, whose mean, variance
    and third moment are those of the Poisson distribution.
    """
    z = _quantiles()[draws]
    spread = np.sqrt(np.maximum(mean - np.float32(5.0 / 36.0), np.float32(0.0)))
    counts: Singles = np.rint(mean + spread * z + (z * z - np.float32(1.0)) * np.float32(1.0 / 6.0))
    few = np.flatnonzero(mean < LEAST_NORMAL_E)
    for start in range(0, few.size, _FEW):
        some = few[start : start + _FEW]
        counts[some] = _inverted(mean[some].astype(np.float64), draws[some])
    return counts


def _inverted(mean: NDArray[np.float64], draws: NDArray[np.uint16]) -> Singles:
    """Smallest counts whose cumulative probability reaches the middle of each number's share."""
    share = (draws + 0.5) / 65536.0
    term = np.exp(-mean)
    total, ratio = term.copy(), np.empty_like(mean)
    counts = np.zeros(mean.shape, np.float32)
    below = np.empty(mean.shape, np.bool_)
    number = 0
    while np.greater(share, total, out=below).any():
        counts += below
        number += 1
        np.multiply(mean, 1.0 / number, out=ratio)
        term *= ratio
        total += term
    return counts


def read_out(detector: Detector, exposure_lx_s: Singles, time_s: float, seed: int, image: str) -> NDArray[np.uint16]:
    """Raw values of an exposed sensor, of the same shape as the exposure.

    Parameters
    ----------
    exposure_lx_s : array of float32
        Illuminance on each pixel times exposure time.
    time_s : float
        Exposure time, in which the dark current flows.
    seed : int
        Seed of everything random; that of the patterns, which all images share.
    image : str
        Text that names the image, on which its temporal noise depends.
    """
    height, width, *colours = exposure_lx_s.shape
    of_pixel = colours[0] if colours else 1
    exposure = exposure_lx_s.reshape(height, width * of_pixel)
    raw = np.empty(exposure.shape, np.uint16)
    # Each source of noise has its own numbers, so that they stay the same if another one is switched off.
    shot, read = Deviates(seed, image, "shot"), Deviates(seed, image, "read")
    response, offset = (_Pattern(Deviates(seed, name), width, of_pixel) for name in ("prnu", "dsnu"))
    rows = max(_BLOCK // max(width * of_pixel, 1), 1)
    for start in range(0, height, rows):
        part = slice(start, start + rows)
        electrons = exposure[part] * np.float32(detector.electrons_per_lx_s)
        shape, count = electrons.shape, electrons.size
        if detector.prnu:
            electrons *= np.float32(1.0) + np.float32(detector.prnu) * response.next_rows(shape[0])
        electrons += np.float32(detector.dark_current_e_per_s * time_s)
        np.maximum(electrons, np.float32(0.0), out=electrons)
        electrons = poisson_counts(electrons.reshape(-1), shot.draw(count)).reshape(shape)
        np.minimum(electrons, np.float32(detector.full_well_e), out=electrons)
        if detector.read_noise_e:
            electrons += np.float32(detector.read_noise_e) * read.normal(count).reshape(shape)
        if detector.dsnu_e:
            electrons += np.float32(detector.dsnu_e) * offset.next_rows(shape[0])
        electrons *= np.float32(detector.gain_dn_per_e)
        electrons += np.float32(detector.black_level_dn)
        raw[part] = np.clip(np.rint(electrons), 0, detector.most_dn)
    return raw.reshape(exposure_lx_s.shape)


class _Pattern:
    """Deviates of pixels by their rows and columns, which are the same in images of a few columns more or less."""

    def __init__(self, deviates: Deviates, width: int, of_pixel: int) -> None:
        self._deviates, self._count = deviates, width * of_pixel
        # Rows of the next multiple of 128 with some columns to spare, as usual widths are multiples themselves.
        self._length = 128 * (-(-(width + 41) // 128)) * of_pixel

    def next_rows(self, rows: int) -> Singles:
        """The next rows (rows, values)."""
        found: Singles = self._deviates.normal(rows * self._length).reshape(rows, self._length)[:, : self._count]
        return found
