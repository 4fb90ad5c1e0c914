"""Translation of what users read: the plugin's own texts, and the messages of the core."""

from __future__ import annotations

import math
import re
from string import Formatter
from typing import TYPE_CHECKING, Any

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QCoreApplication, QLocale, QThread, QTranslator

from .paths import RESOURCES

if TYPE_CHECKING:
    from ..core.errors import Message

_FOLDER = RESOURCES / "i18n"
#: Contexts of the translation files: texts of the plugin, and of the core.
_PLUGIN, _CORE = "TerrAInav", "TerrAInav core"
#: Options in advice of the core that the panel has an entry for under the declared title.
_ENTERED = (
    "error_budget",
    "accept_error",
    "upsample",
    "image_px",
    "max_px",
    "zoom",
    "gsd",
    "layout",
    "stretch",
    "crs",
    "format",
    "elevation",
    "height_unit",
    "height_offset",
    "clearance",
    "holes",
)


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
    return translator


def remove_translator(translator: QTranslator | None) -> None:
    """Undo `install_translator`."""
    if translator is not None:
        QCoreApplication.removeTranslator(translator)


def translate(message: object) -> str:
    """Message, error or word of the core in the user's language, its numbers as the user writes them.

    Options are called what the panel calls them. An advice that names one which the panel has no entry for is left
    out, and so is a message within another that does. A plain string is looked up as a whole.
    """
    from ..core.errors import Message, TerrAInavError

    if isinstance(message, TerrAInavError):
        parts = [message.message]
        if message.remedy is not None and not _names_no_entry(message.remedy):
            parts.append(message.remedy)
        return "; ".join(map(translate, parts))
    template = message.template if isinstance(message, Message) else str(message)
    # Half of a character, which a user can paste, is none of Qt's.
    template = QCoreApplication.translate(_CORE, template.encode("utf-8", "replace").decode())
    if not isinstance(message, Message):
        return template
    if not message.values:
        return template
    return _FORMATTER.vformat(template, [_shown(value) for value in message.values], {})


def option_label(name: str) -> str:
    """The panel's name of an option of a mission, quoted; empty where it has no entry for it."""
    if name == "max_images":
        return tr("“Maximum number of images” of the algorithm “Plan a mission”, or max_images in the mission's file")
    from ..core.fields import declared_fields
    from ..core.mission.parts import FLAT_PARTS

    own = {"img_size": tr("Resize images"), "date": tr("Date")}
    if name in own:
        return tr("“{entry}”").format(entry=own[name])
    parts = FLAT_PARTS.values() if name in _ENTERED else ()
    fields = (field for part in parts for field in declared_fields(part) if field.name_of_option == name)
    return next((tr("“{entry}”").format(entry=begun(translate(one.title))) for one in fields), "")


def begun(text: str) -> str:
    """Text with a capital at its beginning, after the mark of a key."""
    at = 1 if text.startswith("&") else 0
    return text[:at] + text[at : at + 1].upper() + text[at + 1 :]


def number_text(value: float, form: str = ",") -> str:
    """Return a number as the user writes it.

    Thousands are always kept apart: these are figures to be read, whatever QGIS does in fields to be typed into.

    Parameters
    ----------
    form : str
        As for ``format``.
    """
    return localized(format(value, form))


def localized(number: str) -> str:
    """Number that Python has written, as the user writes it."""
    locale = QLocale()
    written = {",": locale.groupSeparator(), ".": decimal_sign()}
    return "".join(written.get(sign, sign) for sign in number)


def plain_number(text: str) -> float:
    """Read a number with decimals behind a point, a comma or the user's own sign; a Unicode minus is understood.

    Raises
    ------
    ValueError
        Where there is no number.
    """
    # QGIS loads this module at its start, and the core only when it is used.
    from ..core.numbers import real_number

    plain = text.strip().replace("\u2212", "-").replace(decimal_sign(), ".")
    if "," in plain and "." not in plain:
        plain = plain.replace(",", ".")
    value = real_number(plain)
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def decimal_sign() -> str:
    """Decimal mark of the user's language."""
    return str(QLocale().decimalPoint())


def language() -> str:
    """Code of the application's language without that of a country: ``es`` for ``es_MX`` or ``es-419``."""
    return re.split("[_.@-]", _locale())[0].lower()


def _locale() -> str:
    # What it was started with counts before what is set; without windows there is only the latter.
    return QgsApplication.instance().translation() or QgsApplication.locale()


class _Formatter(Formatter):
    """Fills values into a message; numbers come out as the user writes them."""

    def convert_field(self, value: Any, conversion: str) -> Any:
        converted = super().convert_field(value, conversion)
        return converted if isinstance(value, str) or conversion is None else localized(converted)

    def format_field(self, value: Any, form: str) -> str:
        text = super().format_field(value, form)
        return text if isinstance(value, str) else localized(text)


_FORMATTER = _Formatter()


def _shown(value: object) -> object:
    """Value of a message as it is put into the translation."""
    from ..core.errors import Message, OptionName, TerrAInavError

    if isinstance(value, OptionName):
        return option_label(value.name) or str(value)
    if isinstance(value, Message):
        return "" if _names_no_entry(value) else translate(value)
    if isinstance(value, TerrAInavError):
        return translate(value)
    # Show a layer's title in place of QGIS's identifier.
    return re.compile(r"qgis:layer/(?P<id>[\w-]+)").sub(_layer_title, value) if isinstance(value, str) else value


def _layer_title(found: re.Match[str]) -> str:
    """Title of a layer that a source is named by, in place of QGIS's identifier."""
    from qgis.core import QgsProject

    if QThread.currentThread() != QCoreApplication.instance().thread():
        # The project is the main thread's.
        return tr("a layer of the project")
    layer = QgsProject.instance().mapLayer(found["id"])
    return tr("a layer that is not in the project") if layer is None else f"“{layer.name()}”"


def _names_no_entry(message: Message) -> bool:
    """Whether a message names an option that the panel has no entry for."""
    from ..core.errors import OptionName

    return any(isinstance(value, OptionName) and not option_label(value.name) for value in message.values)
