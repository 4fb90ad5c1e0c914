"""Maintain the translations of the plugin's texts: ``resources/i18n/terrainav_LANGUAGE.ts``.

The texts are found in the source: those passed to ``tr`` in the plugin, and the templates of the core's messages and
errors, with their placeholders (``{0}``, ``{1:g}``), as ``terrainav_plugin/i18n.py`` looks them up. pylupdate finds
neither. The files have the format of Qt Linguist, and Qt's ``lrelease`` compiles them.

Examples
--------
::

    python tools/translations.py update    # after a change of texts: add new ones, remove old ones
    python tools/translations.py compile   # .ts to .qm, as QGIS loads them
    python tools/translations.py missing   # texts without a translation
"""

from __future__ import annotations

import argparse
import ast
import builtins
import re
import shutil
import subprocess  # nosec B404
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET  # nosec B405  only this project's own files are read
from xml.sax.saxutils import escape, quoteattr  # nosec B406

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "resources" / "i18n"
LANGUAGES = ("es",)
#: Contexts: texts of the plugin, and of the core.
PLUGIN, CORE = "TerrAInav", "TerrAInav core"
#: Parts of the core whose texts only the command shows; the plugin may show the texts of all other parts.
COMMAND_ONLY = (
    "core/cli",
    "core/dataset/convert.py",
    "core/dataset/loading",
    "core/dataset/vbn.py",
    "core/pairs",
    "core/sequences/flying.py",
    "core/sequences/jsbsim.py",
    "core/sequences/settings.py",
    "core/sequences/trajectory.py",
)
#: A word; texts without one are not translated.
_WORD = re.compile(r"[A-Za-z]{2,}")
_PLACE = re.compile(r"\{\d+[^{}]*\}")

Texts = dict[str, dict[str, list[str]]]


class TranslationError(Exception):
    """A text that cannot be extracted, or a file that cannot be read."""


def texts_of(node: ast.expr) -> Iterator[str]:
    """Yield the literal texts that may be the value of an expression; texts from elsewhere are found there."""
    if isinstance(node, ast.IfExp):
        yield from texts_of(node.body)
        yield from texts_of(node.orelse)
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, (ast.JoinedStr, ast.BinOp)):
        raise TranslationError("a text that is put together cannot be translated: give a template and values")


def plugin_texts(path: Path) -> Iterator[str]:
    """Yield every text passed to ``tr``."""
    for call in _translated_calls(path):
        text = call.args[0] if call.args else None
        if isinstance(text, ast.Constant) and isinstance(text.value, str):
            yield text.value
        elif path.name != "i18n.py":
            where = f"{path.relative_to(ROOT)}:{call.lineno}"
            raise TranslationError(f"{where}: tr() of something that is no plain text cannot be translated")


def core_texts(path: Path) -> Iterator[str]:
    """Yield the templates of messages, and of errors and their remedies."""
    for call in ast.walk(_tree(path)):
        if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "declared":
            yield from declared_texts(call)
        if isinstance(call, ast.Call) and _makes_message(call.func):
            remedies = [keyword.value for keyword in call.keywords if keyword.arg == "remedy"]
            try:
                for node in (*call.args[:1], *remedies):
                    yield from filter(_is_worded, texts_of(node))
            except TranslationError as wrong:
                raise TranslationError(f"{path.relative_to(ROOT)}:{call.lineno}: {wrong}") from wrong


def declared_texts(call: ast.Call) -> Iterator[str]:
    """Yield the texts of a declared field of a mission: title, label, help and labels of choices."""
    for keyword in call.keywords:
        if keyword.arg in ("title", "label", "help"):
            yield from texts_of(keyword.value)
        elif keyword.arg == "choices" and isinstance(keyword.value, ast.Dict):
            for text in keyword.value.values:
                yield from texts_of(text)


def _is_worded(text: str) -> bool:
    """Whether a text has words, not only placeholders and punctuation."""
    return _WORD.search(_PLACE.sub("", text)) is not None


def _makes_message(function: ast.expr) -> bool:
    """Whether a function's first argument is a template: `Message`, or an error of this project."""
    name = getattr(function, "id", getattr(function, "attr", ""))
    own = name.endswith("Error") and not hasattr(builtins, name)
    return own or name in ("Message", "InvalidInput", "Cancelled", "OutOfReach", "NotThere")


@cache
def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def _translated_calls(path: Path) -> Iterator[ast.Call]:
    for node in ast.walk(_tree(path)):
        if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == "tr":
            yield node


def found() -> Texts:
    """Texts by context, each with the files it is in."""
    texts: Texts = {PLUGIN: {}, CORE: {}}
    for path in sorted((ROOT / "terrainav_plugin").rglob("*.py")):
        _add(texts[PLUGIN], plugin_texts(path), path)
    for room in ("core", "terrainav_plugin"):
        for path in sorted((ROOT / room).rglob("*.py")):
            if not path.relative_to(ROOT).as_posix().startswith(COMMAND_ONLY):
                _add(texts[CORE], core_texts(path), path)
    return texts


def _add(texts: dict[str, list[str]], more: Iterable[str], path: Path) -> None:
    name = path.relative_to(ROOT).as_posix()
    # Sorted, so that moving code changes nothing.
    for text in sorted(set(more)):
        texts.setdefault(text, []).append(name)


def translated(language: str) -> dict[tuple[str, str], str]:
    """Existing translations, by context and text."""
    path = FOLDER / f"terrainav_{language}.ts"
    if not path.exists():
        return {}
    known = {}
    for context in ET.parse(path).getroot().iter("context"):  # noqa: S314  # nosec B314
        for message in context.iter("message"):
            translation = message.find("translation")
            if translation is not None and translation.get("type") is None and translation.text:
                known[context.findtext("name") or "", message.findtext("source") or ""] = translation.text
    return known


def write(language: str, texts: Texts, known: dict[tuple[str, str], str]) -> None:
    """Write a language's file: every text once, with the files that have it, in the order of the source."""
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        "<!DOCTYPE TS>",
        f'<TS version="2.1" language={quoteattr(language)} sourcelanguage="en">',
    ]
    for context, entries in texts.items():
        lines += ["<context>", f"    <name>{escape(context)}</name>"]
        for text, places in entries.items():
            translation = known.get((context, text))
            shown = (
                f"<translation>{escape(translation)}</translation>"
                if translation
                else '<translation type="unfinished"></translation>'
            )
            lines += [
                "    <message>",
                *(f"        <location filename={quoteattr('../../' + file)}/>" for file in places),
                f"        <source>{escape(text)}</source>",
                f"        {shown}",
                "    </message>",
            ]
        lines.append("</context>")
    (FOLDER / f"terrainav_{language}.ts").write_text("\n".join([*lines, "</TS>", ""]), encoding="utf-8")


def update() -> None:
    """Update the files to the texts that are in the source now."""
    texts = found()
    FOLDER.mkdir(exist_ok=True)
    for language in LANGUAGES:
        write(language, texts, translated(language))


def places_of(text: str) -> list[str]:
    """Placeholders of a text, in alphabetical order."""
    return sorted(re.findall(r"\{[^{}]*\}", text))


def mnemonics_of(text: str) -> int:
    """Number of mnemonics in a text: letters after ``&``."""
    return len(re.findall(r"&(?=\w)", text))


def missing(language: str) -> list[str]:
    """Texts without a translation, or whose translation has other placeholders or mnemonics."""
    known = translated(language)
    return [
        f"{places[0]}: {text}"
        for context, entries in found().items()
        for text, places in entries.items()
        if (context, text) not in known
        or places_of(known[context, text]) != places_of(text)
        or mnemonics_of(known[context, text]) != mnemonics_of(text)
    ]


def compile_all(folder: Path = FOLDER) -> None:
    """Compile every language into a folder."""
    lrelease = shutil.which("lrelease", path="/usr/lib/qt5/bin:/usr/lib/qt6/bin") or shutil.which("lrelease")
    if lrelease is None:
        raise TranslationError("lrelease is not installed; run `make setup`")
    for path in sorted(FOLDER.glob("*.ts")):
        compiled = folder / f"{path.stem}.qm"
        ran = subprocess.run(  # nosec B603
            [lrelease, "-silent", str(path), "-qm", str(compiled)],
            capture_output=True,
            text=True,
            check=False,
        )
        if ran.returncode or not compiled.exists():
            raise TranslationError(f"{path.name}: {ran.stderr.strip() or ran.stdout.strip()}")


def main() -> int:
    """Run the command line; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("what", choices=("update", "compile", "missing"))
    what = parser.parse_args().what
    try:
        if what == "update":
            update()
        elif what == "compile":
            compile_all()
        lines = [] if what == "compile" else [line for language in LANGUAGES for line in missing(language)]
    except TranslationError as wrong:
        print(f"translations: {wrong}", file=sys.stderr)
        return 1
    if what == "missing":
        print("\n".join(lines) or "none")
        return int(bool(lines))
    if lines:
        print(f"translations: {len(lines)} texts are not translated", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
