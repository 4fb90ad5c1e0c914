"""The part of a mission that varies its images at random, and keeps twins of them without effects or distortion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING, Any

from ...camera.varying import Variation
from ...errors import InvalidInput, Message
from ...fields import CheckedFields, Field, declared, declared_fields, field_named
from ...geodesy.lens import Lens
from ...map_types import TWINS
from .air import Air
from .exposure import ExposureControl
from .flown import Attitude, Flight, Route
from .optics import CameraOptics
from .sensor import ImageSensor
from .shutter import Shutter

if TYPE_CHECKING:
    from ...geodesy.camera import Camera


@dataclass(frozen=True)
class PoseOffset(CheckedFields):
    """Offset of a capture from its planned position, as far as only random poses have it."""

    east_m: float = declared(
        0.0, title="offset to the east", help="distance from the planned pose", unit="m", least=-10_000.0, most=10_000.0
    )
    north_m: float = declared(
        0.0,
        title="offset to the north",
        help="distance from the planned pose",
        unit="m",
        least=-10_000.0,
        most=10_000.0,
    )


#: Fields of poses that may vary.
_OF_POSES = {
    **{one.name: one for one in declared_fields(PoseOffset)},
    "agl_m": field_named(Flight, "agl_m"),
    **{name: field_named(Attitude, name) for name in ("yaw_deg", "tilt_deg", "roll_deg")},
}
#: Fields of lenses that may vary.
_OF_LENSES = {one.name: one for one in declared_fields(Lens) if one.kind in (float, int) and one.name != "aspect_ratio"}
#: Fields of a lens of which all combinations of extreme values are tried: more would take seconds.
_COMBINED = 6
#: Parts all of whose numbers may vary.
_PARTS: tuple[type[CheckedFields], ...] = (Air, CameraOptics, ExposureControl, Shutter, ImageSensor)


@lru_cache(maxsize=1)
def variable_fields() -> dict[str, Field]:
    """Fields that may vary from image to image, by name: of poses, light and camera."""
    numbers = (one for part in _PARTS for one in declared_fields(part) if one.kind in (float, int))
    exposure = {"exposure_ms": field_named(Route, "exposure_ms")}
    return {**_OF_POSES, **_OF_LENSES, **exposure, **{one.name: one for one in numbers}}


def _check_vary(texts: tuple[Any, ...]) -> None:
    found: set[str] = set()
    for text in texts:
        if not isinstance(text, str):
            raise InvalidInput("vary {0!r}: must be text", text, field="vary")
        variation = Variation.from_text(text)
        field = variable_fields().get(variation.field)
        if variation.field == "aspect_ratio":
            raise InvalidInput(
                "vary {0!r}: the images of a mission have one shape",
                text,
                field="vary",
                remedy="plan a mission for each",
            )
        if field is None:
            raise _unknown_field(text, variation.field)
        if variation.field in found:
            raise InvalidInput("vary {0!r}: {1} appears twice", text, variation.field, field="vary")
        found.add(variation.field)
        _check_ends(text, variation, field)


def _unknown_field(text: str, name: str) -> InvalidInput:
    import difflib

    near = difflib.get_close_matches(name, variable_fields(), n=3)
    hint = (
        Message("did you mean {0}?", " or ".join(near))
        if near
        else Message("fields that may are {0}", ", ".join(variable_fields()))
    )
    return InvalidInput("vary {0!r}: {1} may not vary: {2}", text, name, hint, field="vary")


def _check_ends(text: str, variation: Variation, field: Field) -> None:
    """Refuse a distribution without bounds where its field has limits, and values beyond them."""
    low, high = variation.ends
    # A limit after ``above`` only bounds the arithmetic, see `Field.domain`: it holds for all values that are drawn.
    has_most = field.below is not None or (field.most is not None and field.above is None)
    has_least = field.least is not None or field.above is not None
    if (low == float("-inf") and has_least) or (high == float("inf") and has_most):
        raise InvalidInput(
            "vary {0!r}: has no bounds, and {1} must be {2}",
            text,
            Message(field.title),
            field.domain,
            field="vary",
            remedy=Message("add bounds as {0}", "within(low,high)"),
        )
    try:
        for value in variation.extremes:
            field.settled(_of_kind(field, value))
    except InvalidInput as wrong:
        raise InvalidInput("vary {0!r}: {1}", text, wrong.message, field="vary") from wrong


def place_of_pose(column: int, row: int) -> str:
    """Beginning of an image's name, by which its pose and lens are drawn: the rest of the name depends on them."""
    return f"{column}_{row}"


def _of_kind(field: Field, value: float) -> float | int:
    """Value as the field has it: a whole number is the nearest one."""
    return round(value) if field.kind is int else value


def _drawn(field: Field, variation: Variation, seed: int, image: str) -> float | int:
    """Value of a field for an image; of a uniform distribution, each whole number is as likely as any other."""
    if field.kind is not int or variation.kind != "uniform":
        return _of_kind(field, variation.draw(seed, image))
    low, high = map(round, variation.parameters)
    wide = replace(variation, parameters=(low - 0.5, high + 0.5))
    return min(max(round(wide.draw(seed, image)), low), high)


@dataclass(frozen=True)
class Varied(CheckedFields):
    """Values that vary from image to image at random."""

    vary: tuple[str, ...] = declared(
        (),
        title="random values",
        help="fields of camera, light and pose that have a random value in each image, by the seed, as "
        "FIELD=DISTRIBUTION: uniform(low,high), normal(mean,sd), lognormal(median,sigma), loguniform(low,high), "
        "triangular(low,mode,high) or choice(value,…), and within(low,high) after it as bounds",
        advanced=True,
        check=_check_vary,
        schema={"items": {"type": "string", "minLength": 1}, "uniqueItems": True},
    )
    keep_clean: bool = declared(
        False,
        title="keep clean images",
        help="also write each image without noise, blur and other effects on light, under the same name into the "
        "folder of its map type with _clean appended",
        advanced=True,
    )
    keep_undistorted: bool = declared(
        False,
        title="keep undistorted images",
        help="also write each image without the lens's distortion, drawn from the imagery with the same focal length, "
        "under the same name into the folder of its map type with _undistorted appended",
        advanced=True,
    )

    @property
    def twins(self) -> tuple[str, ...]:
        """Kinds of twins that each image has, of `TWINS`."""
        return tuple(kind for kind in TWINS if getattr(self, f"keep_{kind}"))

    @property
    def of_poses(self) -> tuple[Variation, ...]:
        """Distributions of the fields of poses."""
        return self._variations(lambda name: name in _OF_POSES)

    @property
    def of_lens(self) -> tuple[Variation, ...]:
        """Distributions of the fields of the lens."""
        return self._variations(lambda name: name in _OF_LENSES)

    @property
    def besides_lens(self) -> tuple[str, ...]:
        """`vary` without the fields of the lens."""
        return tuple(text for text in self.vary if Variation.from_text(text).field not in _OF_LENSES)

    @property
    def of_camera(self) -> tuple[Variation, ...]:
        """Distributions of the fields of light and camera but for the lens."""
        return self._variations(lambda name: name not in _OF_POSES and name not in _OF_LENSES)

    @property
    def turns_images(self) -> bool:
        """Whether an angle varies."""
        return any(one.field.endswith("_deg") for one in self.of_poses)

    def greatest(self, field: str, otherwise: float | None) -> float | None:
        """Greatest value that a field has in an image; ``otherwise``, the mission's, if it does not vary."""
        return next((one.extremes[1] for one in self.of_camera if one.field == field), otherwise)

    def extremes(self) -> Iterator[tuple[Variation, float]]:
        """Yield the least and the greatest value of each field of `of_camera`."""
        fields = variable_fields()
        yield from ((one, _of_kind(fields[one.field], value)) for one in self.of_camera for value in one.extremes)

    def draw(self, seed: int, image: str) -> dict[str, float]:
        """Values of the fields of `of_camera` for an image, by field."""
        fields = variable_fields()
        return {one.field: _drawn(fields[one.field], one, seed, image) for one in self.of_camera}

    def draw_pose(self, seed: int, column: int, row: int) -> dict[str, float]:
        """Values of a pose, by field."""
        return {one.field: one.draw(seed, place_of_pose(column, row)) for one in self.of_poses}

    def draw_lens(self, seed: int, column: int, row: int) -> dict[str, float]:
        """Values of the lens of a capture, by field."""
        return {one.field: one.draw(seed, place_of_pose(column, row)) for one in self.of_lens}

    def extreme_cameras(self, camera: Camera) -> tuple[Camera, ...]:
        """Cameras with each combination of least and greatest values of the lens; the camera itself if it is fixed.

        Raises
        ------
        InvalidInput
            One of them is no camera, such as one whose lens folds the image.
        """
        return _extreme_cameras(camera, self.of_lens)

    def _variations(self, is_wanted: Callable[[str], bool]) -> tuple[Variation, ...]:
        found = map(Variation.from_text, self.vary)
        return tuple(one for one in found if is_wanted(one.field))


def drawn_camera(camera: Camera, values: Mapping[str, Any], variations: tuple[Variation, ...]) -> Camera:
    """Camera with some values of its lens; raises InvalidInput that names the variations if there is none."""
    try:
        made = replace(camera, **values)
        for colour in ("red", "blue"):
            made.of_colour(colour)
    except InvalidInput as wrong:
        raise InvalidInput(
            "vary {0}: with {1}, {2}",
            " ".join(repr(str(one)) for one in variations),
            ", ".join(f"{name} {value:g}" for name, value in values.items()),
            wrong,
            field="vary",
        ) from wrong
    return made


@lru_cache(maxsize=8)
def _extreme_cameras(camera: Camera, variations: tuple[Variation, ...]) -> tuple[Camera, ...]:
    """`Varied.extreme_cameras`; fields after the first few have all their least or all their greatest values."""
    each, others = variations[:_COMBINED], variations[_COMBINED:]
    made = []
    for ends in product((0, 1), repeat=len(each) + bool(others)):
        values = {one.field: one.extremes[end] for one, end in zip(variations, (*ends, *ends[-1:] * len(others)))}
        made.append(drawn_camera(camera, values, variations))
    return tuple(made)
