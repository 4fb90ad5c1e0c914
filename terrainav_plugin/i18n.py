"""Translation of what users read: the plugin's own texts, and the messages of the core."""

from __future__ import annotations

import json
import re
from functools import lru_cache, partial

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QCoreApplication, QTranslator

from .paths import RESOURCES

_FOLDER = RESOURCES / "i18n"
#: Contexts of the translation files: texts of the plugin, and of the core.
_PLUGIN, _CORE = "TerrAInav", "TerrAInav core"
#: Places for values in a message of the core.
_PLACE = re.compile(r"\{(\d+)\}")
#: Values that are themselves messages: this deep and no deeper.
_DEPTH = 4
_WORDS = re.compile(r"[A-Za-z]{2,} ")


def tr(text: str) -> str:
    """Text in the user's language; placeholders are filled in afterwards, with ``str.format``."""
    return QCoreApplication.translate(_PLUGIN, text)


def install_translator() -> QTranslator | None:
    """Have Qt speak the user's language from now on; None where there is no translation, or English will do."""
    language = QgsApplication.locale()[:2]
    path = _FOLDER / f"terrainav_{language}.qm"
    if not path.is_file():
        return None
    translator = QTranslator()
    if not translator.load(str(path)):
        return None
    QCoreApplication.installTranslator(translator)
    return translator


def remove_translator(translator: QTranslator | None) -> None:
    """Undo `install_translator`."""
    if translator is not None:
        QCoreApplication.removeTranslator(translator)
    _templates.cache_clear()


def told(message: object) -> str:
    """Message or words of the core in the user's language, its values as they are.

    The core speaks English. Its messages are recognised by their fixed words; a value that is itself a message is
    translated too. What is not recognised stays as it is.
    """
    return _told(str(message), _DEPTH)


def _told(text: str, depth: int) -> str:
    if not _templates() or not _WORDS.search(text):
        return text
    for pattern, template in _templates():
        match = pattern.fullmatch(text)
        if match is None:
            continue
        values = [_told(value, depth - 1) if depth else value for value in match.groups()]
        translated = QCoreApplication.translate(_CORE, template)
        return _PLACE.sub(partial(_value_at, values), translated)
    return text


def _value_at(values: list[str], place: re.Match[str]) -> str:
    return values[int(place[1])]


@lru_cache(maxsize=1)
def _templates() -> tuple[tuple[re.Pattern[str], str], ...]:
    """Patterns of the messages there are translations of, those with the most fixed words first."""
    path = _FOLDER / "messages.json"
    texts = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else []
    known = [text for text in texts if QCoreApplication.translate(_CORE, text) != text]
    known.sort(key=lambda text: -len(_PLACE.sub("", text)))
    return tuple((_pattern(text), text) for text in known)


def _pattern(template: str) -> re.Pattern[str]:
    parts = _PLACE.split(template)
    # Every other part is the number of a place.
    return re.compile("(.*?)".join(re.escape(part) for part in parts[::2]), re.DOTALL)
