"""Every error TerrAInav raises on purpose, and texts for users that know what they were made of."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    # The command imports this before it is ready for Ctrl-C: nothing here that Python has not loaded itself.
    from collections.abc import Sequence
    from typing import Any, Callable


class OptionName(str):
    """Name of an option in advice to a user: `--max-images` as text, where the panel shows its own label.

    Parameters
    ----------
    name : str
        As ``config.json`` has it: `max_images`.
    """

    __slots__ = ("name",)
    name: str

    def __new__(cls, name: str) -> OptionName:
        """Write the name as the command takes it."""
        made = super().__new__(cls, f"--{name.replace('_', '-')}")
        made.name = name
        return made

    @property
    def in_brackets(self) -> Message:
        """Words that follow an advice which holds without them."""
        return Message(" ({0})", self)

    def __reduce__(self) -> tuple[Any, ...]:
        return OptionName, (self.name,)


class Message(str):
    """Text for users that still knows what it was made of; as a string it is the English sentence.

    Parameters
    ----------
    template : str or TerrAInavError
        English, with places as ``str.format`` has them: ``{0}``, ``{1:g}``, ``{2!r}``. Without values it is taken as it
        is, braces and all. A message or an error is taken over.
    *values : object
        What goes into the places. Messages and errors among them are texts themselves, `OptionName` names an option,
        and a plain string is data, which nobody translates. Of anything else but numbers the text is kept.
    """

    __slots__ = ("template", "values")
    template: str
    values: tuple[Any, ...]

    def __new__(cls, template: object = "", *values: object) -> Message:
        """Fill the values in."""
        if isinstance(template, TerrAInavError):
            template, values = ("{0}", (template,)) if template.remedy else (template.message, values)
        taken_over = template if isinstance(template, Message) else None
        if taken_over is not None:
            template, values = taken_over.template, taken_over.values
        text = str(template) if values or taken_over is not None else _without_credentials(str(template))
        values = tuple(map(_without_credentials, values))
        made = super().__new__(cls, text.format(*values) if values else text)
        made.template = text
        made.values = tuple(_kept(value) for value in values)
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return Message, (self.template, *self.values)

    def map_texts(self, change: Callable[[str], str]) -> Message:
        """Return this message with each string among its values changed, as by masking keys in it.

        So is a template without values, which may be somebody else's words.
        """
        if not self.values:
            return Message(change(self.template))
        return Message(self.template, *(_changed(value, change) for value in self.values))

    @classmethod
    def joined(cls, joint: str, parts: Sequence[str]) -> Message:
        """Return messages in a row, with a joint such as ``", "`` between them."""
        return cls(joint.join(f"{{{place}}}" for place in range(len(parts))), *parts) if parts else cls("")


class TerrAInavError(Exception):
    """Root of the errors TerrAInav raises on purpose; its text is one line for the user.

    Parameters
    ----------
    template : str or TerrAInavError
        What is wrong, as for `Message`; of another error its message, field and remedy are taken over.
    field : str
        Name of the one field, of a mission or a source, that is to be put right; empty where it is about no single one.
    remedy : str or None
        What helps, for those who can do it: a `Message` that names an option may be left out where there is none.
    """

    message: Message
    field: str
    remedy: Message | None

    def __init__(self, template: object = "", *values: object, field: str = "", remedy: str | None = None) -> None:
        if isinstance(template, TerrAInavError):
            field, remedy = field or template.field, remedy or template.remedy
            template = template.message
        self.message = Message(template, *values)
        self.field = field
        self.remedy = Message(remedy) if remedy else None
        super().__init__(self.message)

    def __copy__(self) -> TerrAInavError:
        """Copy without a trace, also where a library has told Python to copy errors with theirs, as Dask does."""
        made = type(self).__new__(type(self), *self.args)
        made.__dict__.update(self.__dict__)
        return made

    def map_texts(self, change: Callable[[str], str]) -> TerrAInavError:
        """Return an error of this kind with each string among its values changed, as by masking keys in it."""
        import copy

        made = copy.copy(self)
        made.message = self.message.map_texts(change)
        made.remedy = self.remedy and self.remedy.map_texts(change)
        made.args = (made.message,)
        return made

    def __str__(self) -> str:
        return f"{self.message}; {self.remedy}" if self.remedy else str(self.message)


class InvalidInput(TerrAInavError, ValueError):
    """An argument outside its domain: the message names the value and what would be right."""


class SourceError(TerrAInavError):
    """A source that cannot serve at all (missing key, refused, over quota): it stops the run."""


class PartError(TerrAInavError):
    """One part of a picture that cannot be had (missing, broken): the pictures that need it fail."""


class OutputError(TerrAInavError):
    """A folder or file that cannot be written, or that holds something else."""


class Cancelled(TerrAInavError):
    """The user stopped a run; what was finished is kept."""


def _without_credentials(value: Any) -> Any:
    """Return a value of a message; of one that shows a password or a key in an address its text, with asterisks."""
    if isinstance(value, (OptionName, Message, TerrAInavError, int, float)):
        return value
    text = str(value)
    if ":/" not in text:
        return value
    from .addresses import without_credentials

    plain = without_credentials(text)
    return value if plain == text else plain


def _kept(value: object) -> object:
    """What a message keeps of a value: light, and fit to be pickled."""
    if isinstance(value, TerrAInavError):
        import copy

        # Without its trace, which holds on to all that was under way.
        return copy.copy(value)
    if isinstance(value, Exception) and len(value.args) == 1 and isinstance(value.args[0], Message):
        return value.args[0]
    is_number = hasattr(value, "__float__") and not hasattr(value, "__len__")
    return value if is_number or isinstance(value, str) else str(value)


def _changed(value: object, change: Callable[[str], str]) -> object:
    if isinstance(value, (Message, TerrAInavError)):
        return value.map_texts(change)
    return change(value) if type(value) is str else value
