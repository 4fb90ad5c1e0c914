"""Translation of what users read: the plugin's own texts, and the messages of the core."""

from __future__ import annotations

import json
import re
from functools import lru_cache, partial

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QCoreApplication, QLocale, QTranslator

from .paths import RESOURCES

_FOLDER = RESOURCES / "i18n"
#: Contexts of the translation files: texts of the plugin, and of the core.
_PLUGIN, _CORE = "TerrAInav", "TerrAInav core"
#: Numbers as English writes them, with thousands kept apart or with decimals; not parts of names and addresses.
_NUMBER = re.compile(r"(?<![\w.,])(?:\d{1,3}(?:,\d{3})+(?:\.\d+)?|\d+\.\d+)(?:e[+-]?\d+)?(?!\w|[.,]\d)")
_ENGLISH = (",", ".")
#: Places for values in a message of the core.
_PLACE = re.compile(r"\{(\d+)\}")
#: Messages within messages: this deep and no deeper.
_DEPTH = 6
#: Joints of what the core puts together of several messages, beside the colon.
_JOINTS = ("; ", ", ")
_BRACKET = " ("
#: Longest message that is taken apart; what servers say in those of the core is cut short before.
_MOST_CHARACTERS = 5000
#: What ends a reason, whatever brackets it has itself.
_TRIED = re.compile(r"(.+)( \(tried \d+ times\))", re.DOTALL)


def tr(text: str) -> str:
    """Text in the user's language; placeholders are filled in afterwards, with ``str.format``."""
    return QCoreApplication.translate(_PLUGIN, text)


def install_translator() -> QTranslator | None:
    """Have Qt speak the user's language from now on; None where there is no translation, or English will do."""
    path = _FOLDER / f"terrainav_{language()}.qm"
    if not path.is_file():
        return None
    translator = QTranslator()
    if not translator.load(str(path)):
        return None
    QCoreApplication.installTranslator(translator)
    _templates.cache_clear()
    return translator


def remove_translator(translator: QTranslator | None) -> None:
    """Undo `install_translator`."""
    if translator is not None:
        QCoreApplication.removeTranslator(translator)
        _templates.cache_clear()


def translate(message: object) -> str:
    """Message or words of the core in the user's language, its numbers as the user writes them.

    The core speaks English. Its messages are recognised by their fixed words; a value that is itself a message is
    translated too. What is not recognised stays as it is.
    """
    text = str(message)
    if len(text) > _MOST_CHARACTERS:
        return text
    return text if _is_english() and _separators() == _ENGLISH else _translated(text, _DEPTH, whole=True)


def number_text(value: float, form: str = ",") -> str:
    """Return a number as the user writes it.

    Thousands are always kept apart: these are figures to be read, whatever QGIS does in fields to be typed into.

    Parameters
    ----------
    form : str
        As for ``format``.
    """
    return localized(format(value, form))


def localized(text: str) -> str:
    """Words of the core, or of Python, with their numbers as the user writes them."""
    separators = _separators()
    if separators == _ENGLISH:
        return text
    written = dict(zip(_ENGLISH, separators))
    return _NUMBER.sub(lambda found: "".join(written.get(sign, sign) for sign in found[0]), text)


def _separators() -> tuple[str, str]:
    """What stands between thousands, and before decimals."""
    locale = QLocale()
    return locale.groupSeparator(), locale.decimalPoint()


def language() -> str:
    """Code of the application's language without that of a country: ``es`` for ``es_MX`` or ``es-419``."""
    return re.split("[_.@-]", _locale())[0].lower()


def _locale() -> str:
    # What it was started with counts before what is set; without windows there is only the latter.
    return QgsApplication.instance().translation() or QgsApplication.locale()


def _is_english() -> bool:
    # Translated as the name of the language that texts are in.
    return tr("English") == "English"


def _translated(text: str, depth: int, *, whole: bool) -> str:
    """Message in the user's language; of a value in one, ``whole`` is false: a single word may be a name."""
    if " " not in text and not whole:
        return text
    translated = QCoreApplication.translate(_CORE, text)
    if translated != text or " " not in text or not depth:
        return translated
    tried = _TRIED.fullmatch(text)
    if tried is not None:
        return _translated(tried[1], depth - 1, whole=whole) + _translated(tried[2], depth - 1, whole=True)
    for fixed, template in _templates():
        found = _values(fixed, text)
        if found is not None:
            values = [
                localized(value) if _NUMBER.fullmatch(value) else _translated(value, depth - 1, whole=False)
                for value in found
            ]
            translated = QCoreApplication.translate(_CORE, template)
            return _PLACE.sub(partial(_value_at, values), translated)
    return _joined(text, depth - 1)


def _joined(text: str, depth: int) -> str:
    """Messages that the core has put together, one by one."""
    first, found, rest = text.partition(": ")
    if found:
        return f"{_translated(first, depth, whole=True)}: {_translated(rest, depth, whole=True)}"
    for joint in _JOINTS:
        if joint in text:
            return joint.join(_translated(part, depth, whole=True) for part in text.split(joint))
    at = text.find(_BRACKET, 1)
    inner = text[at + len(_BRACKET) : -1]
    if at < 0 or not inner or not text.endswith(")"):
        return text
    return f"{_translated(text[:at], depth, whole=True)} ({_translated(inner, depth, whole=True)})"


def _value_at(values: list[str], place: re.Match[str]) -> str:
    return values[int(place[1])]


@lru_cache(maxsize=1)
def _templates() -> tuple[tuple[tuple[str, ...], str], ...]:
    """Messages with places for values, each after its fixed parts; those with the most fixed words first."""
    texts = json.loads((_FOLDER / "messages.json").read_text(encoding="utf-8"))
    # Every other part is the number of a place.
    found = [(tuple(_PLACE.split(text)[::2]), text) for text in texts if _PLACE.search(text)]
    found.sort(key=lambda one: -sum(map(len, one[0])))
    return tuple(found)


def _values(fixed: tuple[str, ...], text: str) -> list[str] | None:
    """Values that stand in a text between the fixed parts of a message; None where it is no such message.

    Each is the shortest that fits, from left to right. Not a pattern: one with several places takes time that grows
    with a power of the text's length.
    """
    first, *between, last = fixed
    begin, end = len(first), len(text) - len(last)
    if begin > end or not text.startswith(first) or not text.endswith(last):
        return None
    values = []
    if between and fixed[:2] == ("", " "):
        # What is wrong with its value after it: words, and the value is one word.
        at = end
        for part in reversed(between):
            at = text.rfind(part, 0, at)
            if at < 0:
                return None
        values.append(text[:at])
        begin = at + len(between.pop(0))
    for part in between:
        at = text.find(part, begin, end)
        if at < 0:
            return None
        values.append(text[begin:at])
        begin = at + len(part)
    return [*values, text[begin:end]]
