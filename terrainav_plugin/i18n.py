"""Translation of user-visible texts of the plugin, and of the core's messages."""

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
#: Contexts of the translation files, for texts of the plugin and of the core.
_PLUGIN, _CORE = "TerrAInav", "TerrAInav core"
#: Options that advice of the core may name and that have entries in the panel, with their declared titles.
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
    "labels",
    "exposure",
    "exposure_ms",
    "image_sensor",
    "pixel_um",
    "quantum_efficiency",
    "full_well_e",
)


def tr(text: str) -> str:
    """Text in the user's language; fill in its placeholders with ``str.format`` afterwards."""
    return QCoreApplication.translate(_PLUGIN, text)


def install_translator() -> QTranslator | None:
    """Install the translation to the user's language in Qt; None if it is missing or not needed."""
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
    """Message, error or word of the core in the user's language, with numbers in the user's format.

    Options are named as in the panel. Advice and nested messages that name an option without an entry in the panel are
    left out. A plain string is looked up as a whole.
    """
    from ..core.errors import Message, TerrAInavError

    if isinstance(message, TerrAInavError):
        parts = [message.message]
        if message.remedy is not None and not _names_no_entry(message.remedy):
            parts.append(message.remedy)
        return "; ".join(map(translate, parts))
    template = message.template if isinstance(message, Message) else str(message)
    # Replace lone surrogates, which users can paste and Qt cannot convert.
    template = QCoreApplication.translate(_CORE, template.encode("utf-8", "replace").decode())
    if not isinstance(message, Message):
        return template
    if not message.values:
        return template
    return _FORMATTER.vformat(template, [_shown(value) for value in message.values], {})


def option_label(name: str) -> str:
    """Name of a mission option in the panel, quoted; empty if it has no entry."""
    if name == "max_images":
        return tr("“Maximum number of images” of the algorithm “Plan a mission”, or max_images in the mission's file")
    from ..core.fields import declared_fields
    from ..core.mission.parts import FLAT_PARTS

    own = {"img_size": tr("Resize images"), "date": tr("Date")}
    if name in own:
        return tr("“{entry}”").format(entry=own[name])
    parts = FLAT_PARTS.values() if name in _ENTERED else ()
    fields = (field for part in parts for field in declared_fields(part) if field.name_of_option == name)
    return next((tr("“{entry}”").format(entry=capitalized(translate(one.title))) for one in fields), "")


def capitalized(text: str) -> str:
    """Text with its first letter, after any mnemonic mark, in upper case."""
    at = 1 if text.startswith("&") else 0
    return text[:at] + text[at : at + 1].upper() + text[at + 1 :]


def number_text(value: float, form: str = ",") -> str:
    """Return a number in the user's format.

    By default, thousands are grouped, as the text is for reading and not for an entry.

    Parameters
    ----------
    form : str
        Format specification, as for ``format``.
    """
    return localized(format(value, form))


def localized(number: str) -> str:
    """Convert a number formatted by Python to the user's format."""
    locale = QLocale()
    written = {",": locale.groupSeparator(), ".": decimal_sign()}
    return "".join(written.get(sign, sign) for sign in number)


def plain_number(text: str) -> float:
    """Read a number with a point, a comma or the locale's sign as decimal mark, and ASCII or Unicode minus.

    Raises
    ------
    ValueError
        The text is not a number.
    """
    # QGIS imports this module at start-up: import the core only on first use.
    from ..core.numbers import real_number

    plain = text.strip().replace("\u2212", "-").replace(decimal_sign(), ".")
    if "," in plain and "." not in plain:
        plain = plain.replace(",", ".")
    value = real_number(plain)
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def decimal_sign() -> str:
    """Decimal mark of the user's locale."""
    return str(QLocale().decimalPoint())


def language() -> str:
    """Language code of the application without a country: ``es`` for ``es_MX`` or ``es-419``."""
    return re.split("[_.@-]", _locale())[0].lower()


def _locale() -> str:
    # The locale with which QGIS was started overrides the setting; without windows, only the setting exists.
    return QgsApplication.instance().translation() or QgsApplication.locale()


class _Formatter(Formatter):
    """Fill values into a message, with numbers in the user's format."""

    def convert_field(self, value: Any, conversion: str) -> Any:
        converted = super().convert_field(value, conversion)
        return converted if isinstance(value, str) or conversion is None else localized(converted)

    def format_field(self, value: Any, form: str) -> str:
        text = super().format_field(value, form)
        return text if isinstance(value, str) else localized(text)


_FORMATTER = _Formatter()


def _shown(value: object) -> object:
    """Value of a message, translated for display."""
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
    """Title of the layer that a source names by QGIS's identifier."""
    from qgis.core import QgsProject

    if QThread.currentThread() != QCoreApplication.instance().thread():
        # Other threads must not use the project.
        return tr("a layer of the project")
    layer = QgsProject.instance().mapLayer(found["id"])
    return tr("a layer that is not in the project") if layer is None else f"“{layer.name()}”"


def _names_no_entry(message: Message) -> bool:
    """Whether a message names an option that has no entry in the panel."""
    from ..core.errors import OptionName

    return any(isinstance(value, OptionName) and not option_label(value.name) for value in message.values)
