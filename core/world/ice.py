"""Permanent ice about the poles, with rock, crevasses and snow drifts."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from .climate import height
from .lattice import Array, bits, mix, salt, signed
from .paint import clip01, ramp
from .region import COARSE, coarse_fields, smoothstep
from .samples import shared
from .scene import Scene
from .styles import speckle

#: Number of entries of periodic tables.
_TABLE = 1 << 16
#: Distance between two entries.
_TABLE_STEP_M = 0.025
_PERIOD_M = _TABLE * _TABLE_STEP_M
#: Spacing in metres and strength of bands of snow drifts: sastrugi, and ridges of the ice below them.
_DRIFTS = (
    (256.0, 1.0),
    (128.0, 0.9),
    (64.0, 0.8),
    (27.0, 0.8),
    (11.0, 0.7),
    (4.6, 0.6),
    (1.9, 0.5),
    (0.8, 0.45),
    (0.35, 0.4),
)


def icy(f: dict[str, Array]) -> Array:
    """Coldness, above 0 where permanent ice forms."""
    cold: Array = np.float32(0.17) - _warmth(f) + np.float32(0.35) * np.clip(height(f), 0.0, 2.0)
    return cold


def _warmth(f: dict[str, Array]) -> Array:
    """Warmth varied by moisture, so that ice does not end along a parallel."""
    return np.asarray(f["heat"] + np.float32(0.11) * f["wet"])


def packed(f: dict[str, Array]) -> Array:
    """Share of the sea covered by pack ice, 0..1."""
    return smoothstep(0.16, 0.05, _warmth(f)) * np.float32(0.97)


def blue(f: dict[str, Array]) -> Array:
    """Share of bare, blue ice, 0..1: in fields of a few kilometres, and more where it is rough."""
    bare: Array = smoothstep(0.42, 0.95, f["lake"]) * (
        np.float32(0.45) + np.float32(0.4) * smoothstep(0.0, 0.5, f["rough"])
    )
    return bare


def rugged(f: dict[str, Array]) -> Array:
    """Height of mountains above the ice, 0..1; 0 where none rise out of it."""
    out: Array = smoothstep(0.12, 0.7, f["rough"])
    return out


def broken(f: dict[str, Array]) -> Array:
    """Width of crevasses, at most 1; not above 0 outside fields of crevasses."""
    gape: Array = np.minimum((f["brook"] - np.float32(0.34)) * np.float32(2.2), np.float32(1))
    return gape


class Ice:
    """Ice at samples; coverages are float32, 0..1, of the samples' shape, or None where all are 0."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.region, self.samples = scene, scene.region, scene.samples
        self.seed, self.pixel_m, self.zoom = scene.seed, scene.pixel_m, scene.samples.zoom

    @cached_property
    def sea(self) -> Array | None:
        """Coverage by the sea, with or without pack ice."""
        return self.scene.sea

    @cached_property
    def on_land(self) -> bool:
        """Whether there is any land."""
        return self.sea is None or bool((self.sea < 1).any())

    @cached_property
    def speckle(self) -> Array:
        """Texture of all scales, 0 at zooms that show none."""
        texture = speckle(self.seed, self.samples, min(self.zoom + 6, 28))
        return np.zeros(self.samples.shape, np.float32) if texture is None else texture

    def rock(self) -> Array | None:
        """Coverage by peaks and ridges that rise out of the ice."""
        if self.region.derived_span(rugged, self.samples)[1] <= 0:
            return None
        window = self.samples.cells(min(COARSE, self.region.level)).support()
        above = self.region.value("relief", self.samples)
        above -= self.samples.spline(coarse_fields(self.seed, window)["relief"], window)
        crest = 100.0  # scales the relief of ridges, below the scale of a region
        above *= np.float32(crest)
        above += self.speckle * np.float32(0.3)
        above -= np.float32(2.6) - np.float32(2.2) * self.region.smooth(rugged, self.samples)
        return ramp(above, 0.5 + crest * self.region.blur("relief"))

    def crevasses(self) -> Array | None:
        """Coverage by crevasses: parallel lenses in a bent plane, wider inside a field of them."""
        if self.region.derived_span(broken, self.samples)[1] <= 0:
            return None
        gape = self.region.smooth(broken, self.samples)
        shown = np.float32(smoothstep(26.0, 9.0, np.array(self.pixel_m)))
        # Wide pixels show the mean: crevasses cover 7 % of a field.
        mean = clip01(gape * np.float32(2.0)) * np.float32(0.07)
        if shown == 0:
            return mean
        across = self._across(2.05)
        across += self.region.value("wood", self.samples) * np.float32(110.0)
        across += self.speckle * np.float32(1.1)
        depth = _look_up(_crevasse_table(self.seed), across)
        # Noise limits the length of cracks, which become lenses, shorter near the edge of their field.
        ends = speckle(self.seed, self.samples, min(self.zoom + 6, 18))
        if ends is not None:
            depth += ends * np.float32(15.0)
        depth -= np.float32(3.0) + np.float32(9.0) * np.maximum(np.float32(0.5) - gape, np.float32(0))
        cover = ramp(depth, max(self.pixel_m, 0.05))
        cover *= np.minimum(gape * np.float32(12.0), np.float32(1))
        if shown < 1:
            cover = mean + (cover - mean) * np.float32(shown)
        return np.asarray(np.maximum(cover, np.float32(0)))

    def drifts(self) -> Array | None:
        """Lightness of snow drifts, centred on 0; None if pixels are too wide for them."""
        if self.pixel_m > _DRIFTS[0][0] / 2.0:
            return None
        across = self._across(0.52)
        across += self.speckle * np.float32(14.0)
        out = _look_up(_drift_table(self.seed, self.pixel_m), across)
        out *= np.float32(0.15) + np.float32(2.0) * np.abs(self.speckle)
        return out

    def _across(self, angle: float) -> Array:
        """Metres along a direction, less a whole number of periods."""
        cosine, sine = float(np.cos(angle)), float(np.sin(angle))
        east, south = self.samples.local_m()
        x, y = self.samples.origin_m
        start = (float(x) * cosine + float(y) * sine) % _PERIOD_M
        return np.asarray(east * np.float32(cosine) + south * np.float32(sine) + np.float32(start), np.float32)

    def pack(self) -> Array:
        """Share of the sea that pack ice covers."""
        return np.asarray(self.region.smooth(packed, self.samples))


def _look_up(table: Array, along_m: Array) -> Array:
    """Return the entries of a periodic table at positions in metres."""
    index = (along_m * np.float32(1.0 / _TABLE_STEP_M)).astype(np.int32)
    index &= _TABLE - 1
    return np.asarray(table.take(index.astype(np.intp), mode="clip"))


@shared(32)
def _drift_table(seed: int, pixel_m: float) -> Array:
    """One period of snow drifts, without bands too narrow for a pixel."""
    at = np.arange(_TABLE)
    out = np.zeros(_TABLE, dtype=np.float32)
    for band, (spacing_m, strength) in enumerate(_DRIFTS):
        weight = min(max(spacing_m / pixel_m / 2.0 - 1.0, 0.0), 1.0) * strength
        if weight == 0.0:
            continue
        count = round(_PERIOD_M / spacing_m)
        cell = at * (count / _TABLE)
        k = np.floor(cell).astype(np.int64)
        f = (cell - k).astype(np.float32)
        f = f * f * (np.float32(3) - np.float32(2) * f)
        value = signed(mix((np.arange(count + 1) % count).astype(np.uint32) + np.uint32(salt(seed, 24, band))))
        out += np.float32(weight) * (value[k] * (np.float32(1) - f) + value[k + 1] * f)
    out.flags.writeable = False
    return out


@shared(4)
def _crevasse_table(seed: int) -> Array:
    """One period of crevasses, 51.2 m apart and 2 to 14 m wide: the depth inside the nearest one, in metres."""
    count = round(_PERIOD_M / 51.2)
    h = mix(np.arange(count, dtype=np.uint32) + np.uint32(salt(seed, 25)))
    side = _TABLE // count
    middle = (np.arange(count) + 0.2 + 0.6 * bits(h, 0, 10)) * side
    half_m = 1.0 + 6.0 * bits(h, 10, 8) ** 2
    at = np.arange(_TABLE)
    depth = np.full(_TABLE, -np.inf)
    for nth in (-1, 0, 1):
        n = at // side + nth
        away = np.abs(at - (middle[n % count] + (n - n % count) * side)) * _TABLE_STEP_M
        depth = np.maximum(depth, half_m[n % count] - away)
    return depth.astype(np.float32)
