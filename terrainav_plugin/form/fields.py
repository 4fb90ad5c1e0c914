"""Translated titles, tips and choices of a mission's declared fields."""

from __future__ import annotations

from ...core.fields import Field, field_named
from ...core.mission.parts import Imagery
from ..i18n import capitalized, translate


def field_label(field: Field) -> str:
    """Title at the beginning of a row, with its keyboard mnemonic."""
    return capitalized(translate(field.label or field.title))


def field_title(field: Field) -> str:
    """Title without mnemonic, followed by the unit in which numbers are typed."""
    unit = translate(field.unit.typed_words or field.unit.words)
    title = capitalized(translate(field.title))
    return f"{title} ({unit})" if unit else title


def field_sentence(field: Field) -> str:
    """Help of a field, as a sentence."""
    return capitalized(translate(field.help)) + "."


def field_tip(field: Field) -> str:
    """Help of a field, with its unit and range if numeric; without the range if numbers are typed in another unit."""
    text = capitalized(translate(field.help))
    if field.kind not in (float, int):
        return text
    details = (field.unit.typed_words,) if field.unit.typed_words else (field.unit.words, field.domain)
    shown = ", ".join(map(translate, filter(None, details)))
    return f"{text} ({shown})" if shown else text


def field_choices(field: Field) -> tuple[tuple[str, str], ...]:
    """Values of a field, each with its label."""
    return tuple((value, translate(label)) for value, label in field.choices.items())


def map_type_title(name: str) -> str:
    """Title of a map type; its name if it is unknown."""
    return translate(field_named(Imagery, "map_types").choices.get(name, name))
