"""All errors that TerrAInav raises on purpose, and messages that keep their template and values."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    # The command imports this module before it handles Ctrl-C, so at run time it must load no others.
    from collections.abc import Sequence
    from typing import Any, Callable


class OptionName(str):
    """Name of an option in a remedy: `--max-images` as text; the panel shows its label instead.

    Parameters
    ----------
    name : str
        As in ``config.json``: `max_images`.
    """

    __slots__ = ("name",)
    name: str

    def __new__(cls, name: str) -> OptionName:
        """Write the name as an option of the command."""
        made = super().__new__(cls, f"--{name.replace('_', '-')}")
        made.name = name
        return made

    @property
    def in_brackets(self) -> Message:
        """Option in brackets, for a remedy that makes sense without it."""
        return Message(" ({0})", self)

    def __reduce__(self) -> tuple[Any, ...]:
        return OptionName, (self.name,)


class Message(str):
    """Text for users that keeps its template and values; as a string it is the English sentence.

    Parameters
    ----------
    template : str or TerrAInavError
        English, with the fields of ``str.format``: ``{0}``, ``{1:g}``, ``{2!r}``. Without values it is used literally,
        braces included. A message or an error is copied.
    *values : object
        Values of the fields. Messages, errors and `OptionName` among them are translated, plain strings are data.
        Numbers are kept; any other object is kept as its text.
    """

    __slots__ = ("template", "values")
    template: str
    values: tuple[Any, ...]

    def __new__(cls, template: object = "", *values: object) -> Message:
        """Format the template."""
        if isinstance(template, TerrAInavError):
            template, values = ("{0}", (template,)) if template.remedy else (template.message, values)
        copied = template if isinstance(template, Message) else None
        if copied is not None:
            template, values = copied.template, copied.values
        text = str(template) if values or copied is not None else _without_credentials(str(template))
        values = tuple(map(_without_credentials, values))
        made = super().__new__(cls, text.format(*values) if values else text)
        made.template = text
        made.values = tuple(_kept(value) for value in values)
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return Message, (self.template, *self.values)

    def map_texts(self, change: Callable[[str], str]) -> Message:
        """Apply a change, such as masking keys, to each string among the values; return the new message.

        A template without values, which may be foreign text, is changed too.
        """
        if not self.values:
            return Message(change(self.template))
        return Message(self.template, *(_changed(value, change) for value in self.values))

    @classmethod
    def joined(cls, joint: str, parts: Sequence[str]) -> Message:
        """Join messages with a separator such as ``", "``."""
        return cls(joint.join(f"{{{place}}}" for place in range(len(parts))), *parts) if parts else cls("")


class TerrAInavError(Exception):
    """Root of the errors TerrAInav raises on purpose; its text is one line for the user.

    Parameters
    ----------
    template : str or TerrAInavError
        What is wrong, as for `Message`; of another error, its message, field and remedy are copied.
    field : str
        Name of the invalid field of a mission or a source; empty if the error concerns no single field.
    remedy : str or None
        What the user can do; a `Message` that names an option is omitted if the user interface lacks the option.
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
        """Copy without the traceback; libraries such as Dask may register copies that keep it."""
        made = type(self).__new__(type(self), *self.args)
        made.__dict__.update(self.__dict__)
        return made

    def map_texts(self, change: Callable[[str], str]) -> TerrAInavError:
        """Apply a change, such as masking keys, to each string among the values; return the new error."""
        import copy

        made = copy.copy(self)
        made.message = self.message.map_texts(change)
        made.remedy = self.remedy and self.remedy.map_texts(change)
        made.args = (made.message,)
        return made

    def __str__(self) -> str:
        return f"{self.message}; {self.remedy}" if self.remedy else str(self.message)


class InvalidInput(TerrAInavError, ValueError):
    """An argument outside its domain: the message names the value and the domain."""


class SourceError(TerrAInavError):
    """A source that fails altogether (missing key, access refused, over quota): it stops the run."""


class PartError(TerrAInavError):
    """A part of a picture that is missing or broken: the pictures that need it fail."""


class OutputError(TerrAInavError):
    """A folder or file that cannot be written, or has unexpected content."""


class Cancelled(TerrAInavError):
    """The user stopped a run; finished images are kept."""


def _without_credentials(value: Any) -> Any:
    """Return a value of a message, as text with passwords and keys of addresses masked if it contains any."""
    if isinstance(value, (OptionName, Message, TerrAInavError, int, float)):
        return value
    text = str(value)
    if ":/" not in text:
        return value
    from .addresses import without_credentials

    plain = without_credentials(text)
    return value if plain == text else plain


def _kept(value: object) -> object:
    """Convert a value of a message to one that is small and can be pickled."""
    if isinstance(value, TerrAInavError):
        import copy

        # The error's traceback would keep every frame alive.
        return copy.copy(value)
    if isinstance(value, Exception) and len(value.args) == 1 and isinstance(value.args[0], Message):
        return value.args[0]
    is_number = hasattr(value, "__float__") and not hasattr(value, "__len__")
    return value if is_number or isinstance(value, str) else str(value)


def _changed(value: object, change: Callable[[str], str]) -> object:
    if isinstance(value, (Message, TerrAInavError)):
        return value.map_texts(change)
    return change(value) if type(value) is str else value
