"""The plugin in Spanish: what it says itself and what the core says through it; and English again afterwards."""

from __future__ import annotations

import functools
import html
import importlib.util
import os
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from string import Formatter

import pytest
from qgis.core import QgsApplication, QgsProcessingContext, QgsProcessingException, QgsProcessingFeedback
from qgis.PyQt.QtCore import QCoreApplication
from qgis.PyQt.QtWidgets import (
    QAbstractButton,
    QComboBox,
    QDialogButtonBox,
    QGroupBox,
    QLabel,
    QLineEdit,
    QMenu,
    QWidget,
)
from terrainav.core.errors import InvalidInput, Message, OptionName, OutputError, PartError
from terrainav.core.fields import field_named
from terrainav.core.imagery.entry import Dates
from terrainav.core.mission.parts import Pixels
from terrainav.terrainav_plugin import i18n
from terrainav.terrainav_plugin.i18n import tr, translate

ROOT = Path(__file__).resolve().parents[2]
#: Of a process: it starts in two seconds.
LIMIT_S = 120.0
_PLACE = re.compile(r"\{[^{}]*\}")
_TAG = re.compile(r"<[^>]*>")


@pytest.fixture(scope="module")
def translations():
    """The tool that keeps the translations."""
    spec = importlib.util.spec_from_file_location("translations", ROOT / "tools" / "translations.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    # Sources are parsed once.
    module.found = functools.cache(module.found)
    return module


@pytest.fixture(scope="module")
def compiled(translations, tmp_path_factory):
    """Folder with the translations as they are in the source now."""
    folder = tmp_path_factory.mktemp("i18n")
    translations.compile_all(folder)
    return folder


@pytest.fixture
def spanish(compiled, monkeypatch):
    """Qt speaks Spanish, as for a user in Mexico."""
    monkeypatch.setattr(i18n, "_FOLDER", compiled)
    monkeypatch.setattr(i18n, "_locale", lambda: "es_MX")
    translator = i18n.install_translator()
    assert translator is not None
    yield
    i18n.remove_translator(translator)


@pytest.fixture
def spanish_plugin(compiled, plugin):
    """The plugin, loaded anew in a Spanish QGIS."""
    plugin.unload()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(i18n, "_FOLDER", compiled)
        patch.setattr(i18n, "_locale", lambda: "es")
        plugin.initGui()
        yield plugin
        plugin.unload()
    plugin.initGui()


@pytest.fixture
def spanish_desk(spanish_plugin, desk):
    """Its mission panel."""
    return desk


def texts_of(root: QWidget):
    """What a person can read of a widget and those in it: labels, buttons, choices, tips."""
    for widget in [root, *root.findChildren(QWidget)]:
        if isinstance(widget.parent(), QDialogButtonBox):
            # Qt's own words, in the application's language.
            continue
        yield widget.toolTip()
        yield widget.windowTitle()
        if isinstance(widget, (QLabel, QAbstractButton)):
            yield widget.text()
        elif isinstance(widget, QComboBox):
            yield from (widget.itemText(index) for index in range(widget.count()))
        elif isinstance(widget, QGroupBox):
            # Groups may have a `title` of their own.
            yield QGroupBox.title(widget)
        elif isinstance(widget, QLineEdit):
            yield widget.placeholderText()
        elif isinstance(widget, QMenu):
            for action in widget.actions():
                yield from (action.text(), action.toolTip())


def lines_of(text):
    """Lines of a text, of HTML those between its tags, without the marks of keys."""
    # Letters are underlined, or named after a tip.
    text = re.sub(r"</?u>| \(Alt\+\w\)", "", text)
    for line in _TAG.split(text) if "<" in text else [text]:
        plain = re.sub(r"&(?=\w)", "", html.unescape(line)).strip()
        if plain:
            yield plain


class English:
    """Recognises the source's texts that have another translation."""

    def __init__(self, translations):
        self.exact, self.patterns = set(), []
        for (_, text), translation in translations.translated("es").items():
            if text == translation:
                continue
            plain = text.replace("&", "").strip()
            if not _PLACE.search(plain):
                # Titles and help of declared fields begin with a capital where they are shown, tips end with a range.
                begun = plain[:1].upper() + plain[1:]
                self.exact |= {plain, begun}
                self.patterns.append(re.compile(re.escape(begun) + r" \([^()]+\)"))
            elif re.search(r"[a-z]{3}", _PLACE.sub("", plain)):
                parts = map(re.escape, _PLACE.split(plain))
                self.patterns.append(re.compile(".+".join(parts), re.DOTALL))

    def left_in(self, root: QWidget, *, names=()):
        """Lines of a widget that are English still, but for names that only look so."""
        return sorted(
            {
                line
                for text in texts_of(root)
                for line in lines_of(text)
                if line not in names
                and (line in self.exact or any(pattern.fullmatch(line) for pattern in self.patterns))
            }
        )


@pytest.fixture
def english(translations):
    return English(translations)


def test_english_would_be_found(desk, english):
    left = english.left_in(desk.dock)
    assert "Draw box" in left
    assert "Press, drag and release on the map" in left
    assert len(left) > 150


def test_the_panel_is_spanish(spanish_desk, english, screenshot):
    desk = spanish_desk
    desk.enter_small_mission()
    desk.wait_planned()
    screenshot("panel_es")
    assert desk.dock.windowTitle() == "Misión de TerrAInav"
    assert english.left_in(desk.dock, names=[desk.folder.name]) == []
    labels = {line for text in texts_of(desk.dock) for line in lines_of(text)}
    assert {
        "Dibujar recuadro",
        "Campo de visión",
        "Error admisible",
        "Fuente de imágenes",
        "Carpeta",
    } <= labels


def test_figures_are_spanish_and_have_their_values(spanish_desk):
    desk = spanish_desk
    desk.enter_small_mission()
    images = desk.wait_planned().summary.images
    figures = desk.dock.figures
    estimates = list(lines_of(figures.estimates.text()))
    assert estimates[estimates.index("Imágenes") + 1].startswith(f"{images:,} en ")
    assert estimates[estimates.index("Cobertura") + 1].startswith("100 % de ")
    details = list(lines_of(figures.details.text()))
    assert re.fullmatch(r"huella: exact, ≤\s\S+\spx; imagen: map, ≤\s\S+\spx", details[details.index("Métodos") + 1])
    assert details[details.index("Se omite") + 1] == "remuestreo, viento"
    assert details[details.index("Relieve") + 1].startswith("sin cota, hasta ")
    why = list(lines_of(figures.details.toolTip()))
    assert "Sin viento" in why
    assert "se pidió aire en calma" in why


def test_a_refusal_of_the_core_is_spanish_at_its_field(spanish_desk, english):
    desk = spanish_desk
    desk.enter_small_mission()
    state = desk.form.state()
    for field, wrong, words in (
        ("north", "95", "latitud 95.0: debe estar entre -90 y 90 grados"),
        ("tilt_deg", -200.0, "inclinación -200.0 grados: debe ser de -180 a 180"),
        ("start", "mañana", "inicio 'mañana': debe ser UTC como 2024-06-21T10:30:00Z"),
        ("image_px", 0, "lado mayor de la imagen 0 px: debe ser 1 o más"),
        ("south", "36", "el sur queda al norte del norte"),
    ):
        desk.form.set_state(replace(state, **{field: wrong}))
        desk.wait(lambda field=field: bool(desk.message(field)))
        assert words in desk.message(field)
        assert english.left_in(desk.dock, names=[desk.folder.name]) == []


def test_advice_names_the_panels_own_entries(spanish_desk):
    desk = spanish_desk
    desk.enter_small_mission()
    desk.form.set_state(replace(desk.form.state(), error_budget_px=1e-9))
    desk.wait(lambda: bool(desk.message("error_budget_px")))
    message = desk.message("error_budget_px")
    assert "suba «Error admisible», o siga con «Permitir superar el error admisible»" in message
    assert "--" not in message


def test_the_message_bar_is_spanish(spanish_desk):
    desk = spanish_desk
    desk.click(desk.dock.capture)
    assert desk.messages() == [
        "Aún no hay área; dibuje un recuadro o introduzca coordenadas. Aún no hay nada que capturar."
    ]


def test_menus_are_spanish(spanish_plugin, english):
    menu = spanish_plugin._menu
    assert english.left_in(menu) == []
    assert [action.text() for action in menu.actions() if not action.isSeparator()][:2] == [
        "&Panel de misión",
        "&Dibujar recuadro",
    ]


def test_dialogs_are_spanish(spanish_desk, english, qtbot):
    from terrainav.terrainav_plugin.panel.options_page import CacheDialog, OptionsPage
    from terrainav.terrainav_plugin.panel.source_dialogs import AddSourceDialog

    for dialog in (AddSourceDialog(None), CacheDialog(None), OptionsPage(None, lambda: None)):
        qtbot.addWidget(dialog)
        assert english.left_in(dialog) == [], type(dialog).__name__


@pytest.mark.any_qgis
def test_every_message_of_the_core_is_translated_with_its_values(spanish, translations):
    known = translations.translated("es")
    for template in translations.found()[translations.CORE]:
        # Numbers where the template has a form for them.
        values = []
        for _, place, form, _ in Formatter().parse(template) if re.search(r"\{\d", template) else ():
            if place is not None:
                values.append(1.5 if form else f"«v{len(values)}»")
        expected = known[translations.CORE, template]
        assert translate(Message(template, *values)) == (expected.format(*values) if values else expected)


TILE = Message("tile {0}/{1}/{2}", 3, 4, 5)
BROKEN = PartError("broken image ({0})", "image file is truncated")


@pytest.mark.parametrize(
    ("message", "spanish_text"),
    [
        (
            PartError("{0}: {1}", TILE, PartError("no connection to {0}", "tiles.example")),
            "tesela 3/4/5: sin conexión con tiles.example",
        ),
        (
            PartError("{0}: {1}{2}", TILE, BROKEN, Message(" (tried {0} times)", 2)),
            "tesela 3/4/5: imagen dañada (image file is truncated) (intentado 2 veces)",
        ),
        (Message("complete"), "completa"),
        # Words of the core as such; what is data in a message is left alone.
        ("complete", "completa"),
        (Message("cache {0!r}: is not there; {1} holds {2}", "time", "tiles", Message("none")), None),
        (
            Message.joined(
                "; ",
                [
                    Message("{0} ({1})", Message("wind"), Message("still air was asked for")),
                    Message("wind turns the camera"),
                ],
            ),
            "viento (se pidió aire en calma); el viento gira la cámara",
        ),
        (
            Dates("day", "2000-02-24", "2001-01-01").text(),
            "cada día de 2000-02-24 hasta hoy; 2001-01-01 por defecto",
        ),
        (
            InvalidInput("{0}: is a folder", "a.tif", remedy="name a raster file"),
            "a.tif: es una carpeta; nombre un archivo ráster",
        ),
        ("nobody said this: {0} or that", "nobody said this: {0} or that"),
        ("wind.tif", "wind.tif"),
        ("", ""),
    ],
)
@pytest.mark.any_qgis
def test_words_of_the_core(spanish, message, spanish_text):
    if spanish_text is None:
        spanish_text = "caché 'time': no existe; tiles contiene ninguno"
    assert translate(message) == spanish_text


@pytest.mark.any_qgis
def test_an_error_is_told_by_its_message(spanish):
    with pytest.raises(InvalidInput) as refused:
        field_named(Pixels, "image_px").settled(0)
    assert translate(refused.value) == "lado mayor de la imagen 0 px: debe ser 1 o más"
    # And of an error of an error all of it, with what helps.
    wrapped = InvalidInput("{0}: {1}", "f.json", InvalidInput("{0}: is a folder", "g", remedy="name a raster file"))
    assert translate(wrapped) == "f.json: g: es una carpeta; nombre un archivo ráster"


@pytest.mark.any_qgis
def test_options_are_called_what_the_panel_calls_them(spanish):
    remedy = Message("raise {0}, or go on with {1}", OptionName("error_budget"), OptionName("accept_error"))
    error = InvalidInput("{0}: is a folder", "g", remedy=remedy)
    assert translate(error) == (
        "g: es una carpeta; suba «Error admisible», o siga con «Permitir superar el error admisible»"
    )
    assert str(error).endswith("; raise --error-budget, or go on with --accept-error")


@pytest.mark.any_qgis
def test_advice_that_the_panel_has_no_entry_for_is_left_out(spanish):
    resume = OptionName("resume")
    refused = OutputError(
        "{0} {1}: holds another mission",
        Message("folder"),
        "x",
        remedy=Message("use {0} {1}", resume, "cover"),
    )
    assert translate(refused) == "carpeta x: contiene otra misión"
    # Of one that holds without it, the name alone.
    refused = OutputError(
        "{0} {1}: holds another mission",
        Message("folder"),
        "x",
        remedy=Message("resume it{0} or choose another folder", resume.in_brackets),
    )
    assert translate(refused) == "carpeta x: contiene otra misión; reanúdela o elija otra carpeta"
    assert str(refused) == "folder x: holds another mission; resume it (--resume) or choose another folder"


def test_processing_fails_in_spanish(spanish):
    from terrainav.terrainav_plugin.processing.plan import PlanAlgorithm

    algorithm = PlanAlgorithm().create()
    assert algorithm.displayName() == "Planificar una misión"
    assert "sin pedir imágenes" in algorithm.shortHelpString()
    parameters = {"COORDS": "35.16_-89.90_35.155_-89.89_120", "FRONT_OVERLAP": 0.0, "MAX_IMAGES": 3}
    with pytest.raises(QgsProcessingException, match="el límite es 3; vuele más alto"):
        algorithm.run(parameters, QgsProcessingContext(), QgsProcessingFeedback(), {}, False)


@pytest.mark.thorough
def test_a_terminal_is_spanish_too(tmp_path):
    program = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
    if program is None:
        pytest.skip("qgis_process is not installed")
    if not (ROOT / "resources" / "i18n" / "terrainav_es.qm").is_file():
        pytest.fail("the translations are not compiled; run `make translations`")
    plugins = tmp_path / "profiles" / "default" / "python" / "plugins"
    plugins.mkdir(parents=True)
    (plugins / "terrainav").symlink_to(ROOT, target_is_directory=True)
    environment = {
        **os.environ,
        "QGIS_CUSTOM_CONFIG_PATH": str(tmp_path),
        "QT_QPA_PLATFORM": "offscreen",
        "LC_ALL": "es_MX.UTF-8",
    }
    environment.pop("PYQGIS_STARTUP", None)
    # It starts several times, and compiles the plugin once.
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    environment["PYTHONPYCACHEPREFIX"] = str(tmp_path / "bytecode")

    def run(*arguments):
        return subprocess.run(
            [program, *arguments],
            env=environment,
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        ).stdout

    run("plugins", "enable", "terrainav")
    assert "Altura sobre el terreno (metros)" in run("help", "terrainav:plan")
    planned = run(
        "run",
        "terrainav:plan",
        "--",
        "EXTENT=-89.90,-89.89,35.155,35.16 [EPSG:4326]",
        "FOOTPRINTS=TEMPORARY_OUTPUT",
    )
    assert "cobertura: 100 % (completa)" in planned


@pytest.mark.parametrize(
    ("locale", "code"),
    [("es", "es"), ("es_MX", "es"), ("es-419", "es"), ("es_ES.UTF-8", "es"), ("ES", "es"), ("pt_BR", "pt")],
)
def test_language_of_a_locale(monkeypatch, locale, code):
    monkeypatch.setattr(i18n, "_locale", lambda: locale)
    assert i18n.language() == code


def test_without_a_translation_there_is_no_translator(monkeypatch, compiled):
    monkeypatch.setattr(i18n, "_FOLDER", compiled)
    monkeypatch.setattr(i18n, "_locale", lambda: "fi_FI")
    assert i18n.install_translator() is None
    monkeypatch.setattr(i18n, "_locale", lambda: "en_GB")
    assert i18n.install_translator() is None


def test_the_language_the_application_was_started_with_counts():
    assert i18n._locale() == QgsApplication.instance().translation() != ""


def test_unloading_takes_spanish_away(spanish_plugin):
    assert tr("Area") == "Área"
    assert translate(Message("wind turns the camera")) == "el viento gira la cámara"
    spanish_plugin.unload()
    assert tr("Area") == "Area"
    assert QCoreApplication.translate("TerrAInav core", "every day") == "every day"
    assert translate("wind turns the camera") == "wind turns the camera"
    spanish_plugin.initGui()


def test_english_stays_as_it_is(plugin):
    error = InvalidInput("zoom {0}: must be 0 or more", -1)
    assert translate(error) == str(error) == "zoom -1: must be 0 or more"
    assert plugin.actions["draw_box"].text() == "&Draw box"
