"""Image sensors by name, with the figures of their EMVA 1288 data sheets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from ..errors import InvalidInput, Message
from ..resources import read_json

#: Name of a sensor without figures of its own: the mission gives them.
CUSTOM = "custom"


@dataclass(frozen=True)
class SensorPreset:
    """A sensor by name.

    Parameters
    ----------
    figures : mapping of str to float
        Figures by field of the mission's part `ImageSensor`; those that its data sheet lacks are left out.
    source : str
        Document of each figure, its date, and where it was read.
    """

    name: str
    figures: Mapping[str, float]
    source: str


@cache
def shipped_sensors() -> tuple[SensorPreset, ...]:
    """Return the sensors of ``resources/sensors.json``."""
    made = []
    for data in read_json("sensors.json"):
        name, source = data.pop("name"), data.pop("source")
        made.append(SensorPreset(name, MappingProxyType(data), source))
    return tuple(made)


def sensor_named(name: str) -> SensorPreset:
    """Find a sensor by its name, in any case; words may be left out if the rest names one sensor.

    Raises
    ------
    InvalidInput
        No such sensor, or several; suggests similar names.
    """
    presets = {_key(one.name): one for one in shipped_sensors()}
    wanted = _key(name)
    if wanted in presets:
        return presets[wanted]
    words = set(wanted.split())
    words_of = {one.name: set(_key(one.name).split()) for one in presets.values()}
    found = [one for one in presets.values() if words and words <= words_of[one.name]]
    if len(found) == 1:
        return found[0]
    import difflib

    if not found:
        known = set().union(*words_of.values())
        words = {near for word in words for near in difflib.get_close_matches(word, known, n=1, cutoff=0.7)}
    alike = sorted(words_of, key=lambda one: -len(words & words_of[one]))
    close = [one for one in alike if words & words_of[one]][:3]
    hint = (
        Message("did you mean {0}?", " or ".join(close))
        if close
        else Message("known are {0} and {1}", ", ".join(one.name for one in presets.values()), CUSTOM)
    )
    raise InvalidInput("image sensor {0!r} is unknown: {1}", name, hint, field="image_sensor")


def _key(name: str) -> str:
    return " ".join(name.casefold().split())
