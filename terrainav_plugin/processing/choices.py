"""Parameters for choices, which a script, a model or a terminal may give by value, title or number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from qgis.core import QgsProcessingContext, QgsProcessingParameterEnum, QgsProperty

from ...core.errors import InvalidInput
from ...core.text.plain import listed
from ..i18n import tr

#: Types of values from which QGIS determines a choice at run time.
_LATER = (QgsProperty,)


class ChoiceParameter(QgsProcessingParameterEnum):
    """A choice of words: given by value, title, list entry or number, in upper or lower case.

    The list shows the values; with ``titled``, it shows the titles, with the values in square brackets.

    Parameters
    ----------
    name, description : str
    choices : mapping
        Titles by value.
    usual : object
        Default value, or a list of default values; None for an optional choice.
    several : bool
        Whether several values may be chosen.
    titled : bool
    more : bool
        Whether the copy that runs may have more choices; QGIS then accepts any value, and the run checks it.
    """

    def __init__(
        self,
        name: str,
        description: str,
        choices: Mapping[str, str],
        usual: object = None,
        *,
        several: bool = False,
        titled: bool = False,
        more: bool = False,
    ) -> None:
        self._made_of = (name, description, dict(choices), usual)
        self._how = {"several": several, "titled": titled, "more": more}
        self.values = tuple(choices)
        shows = [listed(value, title) if titled else value for value, title in choices.items()]
        # `_found` tries numbers last: a value may be a number.
        self._names: dict[str, set[str]] = {}
        for at, (value, title) in enumerate(choices.items()):
            for known in (value, title, shows[at]):
                self._names.setdefault(_plain(known), set()).add(value)
        shown = dict(zip(choices, shows))
        if isinstance(usual, (list, tuple)):
            default: object = [shown.get(one, one) for one in usual]
        else:
            default = shown.get(usual, usual) if isinstance(usual, str) else usual
        super().__init__(
            name,
            description,
            options=shows,
            allowMultiple=several,
            defaultValue=default,
            optional=usual is None,
            usesStaticStrings=True,
        )

    def clone(self) -> ChoiceParameter:
        """Return a copy with the same choices."""
        made = ChoiceParameter(*self._made_of, **self._how)
        made.setFlags(self.flags())
        made.setHelp(self.help())
        made.setMetadata(self.metadata())
        return made

    def checkValueIsAcceptable(self, value: object, _context: QgsProcessingContext | None = None) -> bool:
        """Whether a value names one of the choices, or several if allowed."""
        if isinstance(value, _LATER):
            return True
        given = self._given(value)
        if not given:
            return bool(self.flags() & self.Flag.FlagOptional) or (value is None and self.defaultValue() is not None)
        return self._how["more"] or all(self._found(one) is not None for one in given)

    def chosen(self, value: object) -> tuple[str, ...]:
        """Values of the choices given by name; raises InvalidInput for an unknown name."""
        found = []
        for one in self._given(value):
            known = self._found(one)
            if known is None:
                raise InvalidInput(
                    tr("{title} {value!r}: must be one of {choices}").format(
                        title=self.description(), value=str(one), choices=", ".join(self.values)
                    )
                )
            found.append(known)
        return tuple(found)

    def _given(self, value: object) -> list[Any]:
        if value is None or value == "":
            return []
        if isinstance(value, (list, tuple)):
            return list(value)
        if self.allowMultiple() and isinstance(value, str) and self._found(value) is None:
            return [part for part in (part.strip() for part in value.replace(";", ",").split(",")) if part]
        return [value]

    def _found(self, one: object) -> str | None:
        """Value of the choice given by name; None if the name is ambiguous or unknown."""
        text = str(one)
        if text in self.values:
            return text
        named = self._names.get(_plain(text), set())
        if len(named) == 1:
            return next(iter(named))
        number = text.removesuffix(".0") if isinstance(one, float) else text
        # Numbers of choices are short; Python refuses to convert thousands of digits.
        is_number = number.isascii() and number.isdigit() and len(number) <= 9
        if not named and is_number and int(number) < len(self.values):
            return self.values[int(number)]
        return None


def _plain(text: str) -> str:
    return " ".join(text.split()).casefold()
