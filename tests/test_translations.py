"""The translation files hold what the source says now, all of it translated; Qt's own compiler takes them."""

from __future__ import annotations

import functools
import importlib.util
import re
import shutil
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def translations():
    """The tool as a module."""
    spec = importlib.util.spec_from_file_location("translations", ROOT / "tools" / "translations.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    # Sources are parsed once.
    module.found = functools.cache(module.found)
    return module


@pytest.fixture
def module_of(translations, tmp_path, monkeypatch):
    """Write a module's source where the tool looks for those of the core and of the plugin."""
    monkeypatch.setattr(translations, "ROOT", tmp_path)

    def write(source, name="core/mission/some.py"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(source, encoding="utf-8")
        return path

    return write


def test_files_are_what_an_update_writes(translations, tmp_path, monkeypatch):
    there = {path.name: path.read_bytes() for path in translations.FOLDER.glob("*.ts")}
    for name in there:
        shutil.copy(translations.FOLDER / name, tmp_path)
    monkeypatch.setattr(translations, "FOLDER", tmp_path)
    translations.update()
    assert "terrainav_es.ts" in there
    assert {path.name for path in tmp_path.iterdir()} == set(there)
    changed = [name for name, content in there.items() if (tmp_path / name).read_bytes() != content]
    assert changed == [], "run `python tools/translations.py update` and translate what is new"


def test_every_text_is_translated_with_its_places_and_keys(translations):
    assert translations.missing("es") == []


def test_what_would_be_wrong_is_named(translations, monkeypatch):
    known = translations.translated("es")
    for text, wrong in (
        ("Area &from", "Área desde"),
        ("{n} holes", "{m} huecos"),
        ("Area", None),
    ):
        assert ("TerrAInav", text) in known
        faulty = {key: value for key, value in {**known, ("TerrAInav", text): wrong}.items() if value}
        monkeypatch.setattr(translations, "translated", lambda _, faulty=faulty: faulty)
        assert [line.partition(": ")[2] for line in translations.missing("es")] == [text]


def test_surroundings_of_a_text_are_kept(translations):
    for (_, text), translated in translations.translated("es").items():
        before, after = len(text) - len(text.lstrip()), len(text) - len(text.rstrip())
        assert len(translated) - len(translated.lstrip()) == before, text
        assert len(translated) - len(translated.rstrip()) == after, text
        assert translated.endswith("…") == text.endswith("…"), text


_PANEL = "panel/dock.py area/entries.py panel/camera.py panel/sections.py"
_DATASET = " ".join(
    f"dataset_window/{name}.py"
    for name in ("window", "clean_tab", "split_tab", "benchmark_tab", "export_tab", "labels_tab")
)
#: Letters of QGIS's own menus, with those that its own plugins bring.
_MENUS = {"en": "jevlspormchwd", "es": "yevcfmorwb"}


def test_keys_of_a_menu_or_form_differ(translations):
    known = translations.translated("es")
    together = {
        "menu": "plugin.py",
        "ways to an area": "area/menu.py",
        "ways to no-fly areas": "area/no_fly.py",
        "changes of an area": "area/tools.py",
        "missions": "missions/missions.py",
        "viewer": "results/viewer.py",
        "area dialogs": "area/dialogs.py",
        "dataset window": _DATASET,
        "panel": _PANEL,
    }
    declared = _declared_with_keys(translations)
    for name, files in together.items():
        texts = {text for file in files.split() for text in translations.plugin_texts(ROOT / "terrainav_plugin" / file)}
        keys = [
            known["TerrAInav", text].partition("&")[2][0].lower()
            for text in sorted(texts)
            if translations.mnemonics_of(text)
        ]
        if name == "panel":
            keys += [known["TerrAInav core", title].partition("&")[2][0].lower() for title in declared]
        assert keys, name
        assert sorted(keys) == sorted(set(keys)), f"{name}: {keys}"


def _declared_with_keys(translations):
    """Titles with a key of the fields that a mission declares: they stand in the panel, too."""
    parts = (ROOT / "core" / "mission" / "parts").glob("*.py")
    found = {text for part in parts for text in translations.core_texts(part) if translations.mnemonics_of(text)}
    assert found
    return sorted(found)


@pytest.mark.parametrize("panel", ["panel", "viewer", "dataset window"])
def test_keys_of_a_panel_open_no_menu_of_qgis(translations, panel):
    """A panel shares the window of QGIS; there it drops what collides, and would have fewer keys than it should."""
    files = {"panel": _PANEL, "viewer": "results/viewer.py", "dataset window": _DATASET}[panel]
    known = translations.translated("es")
    for file in files.split():
        for text in translations.plugin_texts(ROOT / "terrainav_plugin" / file):
            if translations.mnemonics_of(text):
                assert text.partition("&")[2][0].lower() not in _MENUS["en"], text
                assert known["TerrAInav", text].partition("&")[2][0].lower() not in _MENUS["es"], text
    for title in _declared_with_keys(translations) if panel == "panel" else ():
        assert title.partition("&")[2][0] not in _MENUS["en"]
        assert known["TerrAInav core", title].partition("&")[2][0].lower() not in _MENUS["es"]


@pytest.mark.parametrize(
    ("source", "texts"),
    [
        ('raise InvalidInput("zoom {0}: must be {1:g}", zoom, least)', ["zoom {0}: must be {1:g}"]),
        ('raise SourceError("is gone" if gone else "has changed")', ["is gone", "has changed"]),
        ('raise errors.PartError("{0}: {1}", what, wrong, remedy="resume")', ["resume"]),
        ('raise InvalidInput("bad value", field="zoom level")', ["bad value"]),
        ('words = Message("wind")', ["wind"]),
        ('raise InvalidInput("{0}", what, remedy=Message("use {0}", OptionName("zoom")))', ["use {0}"]),
        ('raise InvalidInput("{0} {1:.3g} ({2!r})", name, value, text)', []),
        ("raise InvalidInput(problem)", []),
        ('raise ValueError("for nobody here")', []),
        ('print("for nobody here")', []),
    ],
)
def test_messages_found_in_the_core(translations, module_of, source, texts):
    assert sorted(translations.core_texts(module_of(source))) == sorted(texts)


def test_texts_found_in_the_plugin(translations, module_of):
    path = module_of('tr("one {z}")\nlabel.setText(tr("two"))\nsetText("three")', "terrainav_plugin/some.py")
    assert list(translations.plugin_texts(path)) == ["one {z}", "two"]


def test_a_text_that_cannot_be_extracted_is_refused(translations, module_of):
    path = module_of('tr(f"{count} images")', "terrainav_plugin/some.py")
    with pytest.raises(translations.TranslationError, match=r"some.py:1: .* no plain text"):
        list(translations.plugin_texts(path))


@pytest.mark.parametrize("put_together", ['f"zoom {zoom}"', '"zoom " + zoom'])
def test_a_message_that_is_put_together_is_refused(translations, module_of, put_together):
    path = module_of(f"raise InvalidInput({put_together})")
    with pytest.raises(translations.TranslationError, match=r"some.py:1: .* give a template and values"):
        list(translations.core_texts(path))


def test_qt_compiles_them(translations, tmp_path):
    if shutil.which("lrelease") is None:
        pytest.skip("lrelease is not installed")
    translations.compile_all(tmp_path)
    compiled = tmp_path / "terrainav_es.qm"
    # What a file of Qt's begins with.
    assert compiled.read_bytes().startswith(bytes.fromhex("3cb86418caef9c95cd211cbf60a1bddd"))
    texts = ET.parse(translations.FOLDER / "terrainav_es.ts").getroot().iter("message")
    assert compiled.stat().st_size > 40 * len(list(texts))


def headings(path):
    """Levels and titles of a page's headings, as those of code blocks are none."""
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    return re.findall(r"^(#+) (.+)$", text, re.MULTILINE)


def anchor(title):
    """Name of a heading in links."""
    return re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", title.strip().lower()))


def test_the_guide_has_the_same_parts_in_spanish():
    english, spanish = ROOT / "docs" / "guide.md", ROOT / "docs" / "guide.es.md"
    assert [level for level, _ in headings(spanish)] == [level for level, _ in headings(english)]
    pictures = re.compile(r"!\[.+?\]\((.+?)\)")
    assert pictures.findall(spanish.read_text(encoding="utf-8")) == pictures.findall(
        english.read_text(encoding="utf-8")
    )


def test_links_of_the_spanish_guide_lead_somewhere(translations):
    page = ROOT / "docs" / "guide.es.md"
    anchors = {anchor(title) for _, title in headings(page)}
    links = re.findall(r"\]\((.+?)\)", page.read_text(encoding="utf-8"))
    assert {link[1:] for link in links if link.startswith("#")} <= anchors
    files = [link.partition("#")[0] for link in links if not link.startswith(("#", "https://"))]
    assert all((page.parent / file).is_file() for file in files)
    # Where the Help buttons of dialogs lead.
    known = translations.translated("es")
    assert {known["TerrAInav", topic] for topic in ("sources", "settings")} <= anchors


def test_the_spanish_guide_names_things_as_the_plugin_does(translations):
    """What is bold there is what is to be pressed, so that it is read somewhere: in the plugin, or in QGIS."""
    texts = {text.replace("&", "") for text in translations.translated("es").values()}
    # Titles of declared fields begin with a capital where they are shown.
    texts |= {text[:1].upper() + text[1:] for text in texts}
    of_qgis = set(
        "Complementos|Administrar e instalar complementos…|Instalar a partir de ZIP|Instalar complemento|Ráster|"
        "TerrAInav|Ver|Paneles|Controlador temporal|Opciones…|Configuración|Atajos de teclado…|Estilos|"
        "Mensajes del registro|Proyecto|Nuevo".split("|")
    )
    of_the_guide = {"N", "Esc", "+", "…", "Claves", "Fechas"}
    page = (ROOT / "docs" / "guide.es.md").read_text(encoding="utf-8")
    pressed = {
        part.strip()
        for bold in re.findall(r"\*\*(.+?)\*\*", page, re.DOTALL)
        for part in " ".join(bold.split()).split("▸")
    }
    assert pressed - texts - of_qgis - of_the_guide == set()
