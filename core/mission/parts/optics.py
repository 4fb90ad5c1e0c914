"""The part of a mission that says how a camera's lens and pixels gather light."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from ...errors import InvalidInput
from ...fields import CheckedFields, declared
from ...numbers import NUMBER, real_number

#: Samplings of the imagery: interpolation at the zoom that suits a pixel, or the mean of what the pixel covers.
ZOOM, AREA = "zoom", "area"
#: No vignetting, and that of the cosine's fourth power.
NO_VIGNETTING, COS4 = "none", "cos4"
#: Most light, of that in the middle, that vignetting may leave: polynomials fitted to lenses pass 1 by little.
MOST_SHARE = 2.0
#: A keyword, or up to three coefficients.
_VIGNETTING = f"{NO_VIGNETTING}|{COS4}|{NUMBER}( {NUMBER}){{0,2}}"


def _check_vignetting(text: str) -> None:
    if not re.fullmatch(_VIGNETTING, text):
        raise InvalidInput(
            "vignetting {0!r}: must be none, cos4, or one to three coefficients of r², r⁴ and r⁶",
            text,
            field="vignetting",
        )
    if text in (NO_VIGNETTING, COS4):
        return
    terms = tuple(map(float, text.split()))
    steps = [step / 1000.0 for step in range(1001)]
    shares = [1.0 + sum(term * r ** (2 * power) for power, term in enumerate(terms, 1)) for r in steps]
    least = min(shares)
    if not all(map(math.isfinite, shares)) or least < 0.0:
        raise InvalidInput(
            "vignetting {0!r}: must leave light up to the corner; {1:.3g} of it is left at r = {2:.3g}",
            text,
            least,
            steps[shares.index(least)],
            field="vignetting",
        )
    most = max(shares)
    if most > MOST_SHARE:
        raise InvalidInput(
            "vignetting {0!r}: must leave at most {1:g} times the light of the middle, not {2:.3g} at r = {3:.2g}",
            text,
            MOST_SHARE,
            most,
            steps[shares.index(most)],
            field="vignetting",
        )


@dataclass(frozen=True)
class CameraOptics(CheckedFields):
    """Sampling of the imagery, sharpness of the lens, and vignetting."""

    sampling: str = declared(
        ZOOM,
        title="sampling",
        help="how pixels of camera frames are taken from the imagery: zoom interpolates it at the zoom that suits the "
        "pixel, and averages up to 8 samples of slanted ground; area averages all that the pixel covers, in linear "
        "light, from finer zooms: without aliases far away, with more tiles",
        choices={ZOOM: "Interpolated", AREA: "Mean over the area"},
        advanced=True,
    )
    mtf50: float | None = declared(
        None,
        title="sharpness (MTF50)",
        help="spatial frequency at which lens and pixels together leave half of the contrast (MTF50); square pixels "
        "alone do at 0.603; left out, the lens is perfectly sharp",
        unit="c/px",
        # Wider blur is no picture; beyond half a cycle per pixel, pixels do not show it.
        least=0.02,
        most=0.5,
        suggested=0.3,
        advanced=True,
    )
    diffraction: bool = declared(
        False,
        title="diffraction",
        help="blur images by the diffraction of the aperture, from f-number and pixel pitch, for green light of 555 nm",
        advanced=True,
    )
    vignetting: str = declared(
        NO_VIGNETTING,
        title="vignetting",
        help="how light falls off from the middle of the image: none; cos4, by the fourth power of the cosine of the "
        "angle to the optical axis; or up to three coefficients a b c of 1 + a r² + b r⁴ + c r⁶, from 0 to 2, where r "
        "is the distance from the principal point, 1 at half the image's diagonal",
        check=_check_vignetting,
        schema={"pattern": f"^({_VIGNETTING})$"},
        advanced=True,
    )

    def __post_init__(self) -> None:
        """Check every field; refuse two kinds of blur, and store equal coefficients as equal texts."""
        given: Any = self.vignetting
        with suppress(ValueError, AttributeError):
            terms = [real_number(one) for one in given.split()]
            if all(map(math.isfinite, terms)):
                object.__setattr__(self, "vignetting", " ".join(f"{one:.15g}" for one in terms))
        super().__post_init__()
        if self.diffraction and self.mtf50 is not None:
            raise InvalidInput(
                "diffraction, and an MTF50 of {0:g} cycles/px, which includes it: must be one of the two",
                self.mtf50,
                field="diffraction",
            )

    @property
    def by_area(self) -> bool:
        """Whether a pixel is the mean of what it covers."""
        return self.sampling == AREA

    @property
    def falloff_terms(self) -> tuple[float, ...]:
        """Coefficients of r², r⁴ and r⁶; empty without a polynomial."""
        return () if self.vignetting in (NO_VIGNETTING, COS4) else tuple(map(float, self.vignetting.split()))
