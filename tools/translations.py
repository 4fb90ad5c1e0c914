"""Keeps the translations of what users of the plugin read: ``resources/i18n/terrainav_LANGUAGE.ts``.

The words are found in the source itself: the texts given to ``tr`` in the plugin, and the messages and words of the
core that the plugin shows, whose places for values become ``{0}``, ``{1}`` and so on. pylupdate knows neither a ``tr``
that is a function of its own nor f-strings. The files are Qt Linguist's, and Qt's ``lrelease`` compiles them.

Examples
--------
::

    python tools/translations.py update    # after a change of texts: new ones come, vanished ones go, the rest stays
    python tools/translations.py compile   # .ts to .qm, as QGIS loads them
    python tools/translations.py missing   # texts without a translation
"""

from __future__ import annotations

import argparse
import ast
import json
import re
import shutil
import subprocess  # nosec B404
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET  # nosec B405  only this project's own files are read
from xml.sax.saxutils import escape, quoteattr  # nosec B406

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "resources" / "i18n"
#: Texts of the core, which the plugin recognises in what it is told; see ``terrainav_plugin/i18n.py``.
MESSAGES = FOLDER / "messages.json"
LANGUAGES = ("es",)
#: Contexts: texts of the plugin, and of the core.
PLUGIN, CORE = "TerrAInav", "TerrAInav core"
#: Rooms of the core that are told in the plugin, and not only by the command or in its report.
TOLD = ("capture", "dataset", "geodesy", "imagery", "mission")
#: Where the core has words that are no messages, as tables of constants or the parts of a line.
WORDS = ("mission/rungs.py", "mission/choosing.py", "mission/estimate.py")
#: A text worth translating has a word in it.
_WORD = re.compile(r"[A-Za-z]{2,}")

Texts = dict[str, dict[str, list[str]]]


class TranslationError(Exception):
    """A text that cannot be extracted, or a file that cannot be read."""


def template_of(node: ast.expr) -> str | None:
    """Text of a literal, with ``{0}``, ``{1}``, ... for the values of an f-string; None for anything else."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        parts, places = [], 0
        for part in node.values:
            if isinstance(part, ast.Constant):
                parts.append(str(part.value))
            else:
                parts.append(f"{{{places}}}")
                places += 1
        return "".join(parts)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        left, right = template_of(node.left), template_of(node.right)
        return left + right if left is not None and right is not None and "{0}" not in right else None
    return None


def plugin_texts(path: Path) -> Iterator[tuple[str, int]]:
    """Yield every text given to ``tr``, with its line."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == "tr":
            text = node.args[0] if node.args else None
            if not (isinstance(text, ast.Constant) and isinstance(text.value, str)):
                if path.name == "i18n.py":
                    continue
                where = f"{path.relative_to(ROOT)}:{node.lineno}"
                raise TranslationError(
                    f"{where}: tr() of something that is no plain text cannot be translated"
                )
            yield text.value, node.lineno


def core_texts(path: Path) -> Iterator[tuple[str, int]]:
    """Yield the messages that are raised, and in modules of `WORDS` every text that has words, with their lines."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    raised = {
        id(argument)
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and _names_error(node.func)
        for argument in node.args
    }
    everything = path.relative_to(ROOT / "core").as_posix() in WORDS
    documentation = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
        and node.body
        and isinstance(node.body[0], ast.Expr)
    }
    inside = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values}
    for node in ast.walk(tree):
        if not isinstance(node, ast.expr) or id(node) in documentation | inside:
            continue
        if id(node) in raised or (everything and isinstance(node, (ast.Constant, ast.JoinedStr))):
            text = template_of(node)
            if text is not None and _WORD.search(re.sub(r"\{\d+\}", "", text)) and " " in text.strip():
                yield text, node.lineno


def _names_error(function: ast.expr) -> bool:
    name = getattr(function, "id", getattr(function, "attr", ""))
    return name in ("InvalidInput", "InvalidLayer") or name.endswith("Error")


def found() -> Texts:
    """Texts by context, each with the places it is at."""
    texts: Texts = {PLUGIN: {}, CORE: {}}
    for path in sorted((ROOT / "terrainav_plugin").rglob("*.py")):
        for text, line in plugin_texts(path):
            texts[PLUGIN].setdefault(text, []).append(f"{path.relative_to(ROOT).as_posix()}:{line}")
    for room in TOLD:
        for path in sorted((ROOT / "core" / room).rglob("*.py")):
            for text, line in core_texts(path):
                texts[CORE].setdefault(text, []).append(f"{path.relative_to(ROOT).as_posix()}:{line}")
    return texts


def translated(language: str) -> dict[tuple[str, str], str]:
    """Translations there are, by context and text."""
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
    """Write a language's file: every text once, with its places, in the order of the source."""
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
            # Without line numbers: they would change with every edit.
            files = sorted({place.partition(":")[0] for place in places})
            lines += [
                "    <message>",
                *(f"        <location filename={quoteattr('../../' + file)}/>" for file in files),
                f"        <source>{escape(text)}</source>",
                f"        {shown}",
                "    </message>",
            ]
        lines.append("</context>")
    (FOLDER / f"terrainav_{language}.ts").write_text("\n".join([*lines, "</TS>", ""]), encoding="utf-8")


def update() -> None:
    """Bring the files up to what the source says now."""
    texts = found()
    FOLDER.mkdir(exist_ok=True)
    for language in LANGUAGES:
        write(language, texts, translated(language))
    MESSAGES.write_text(json.dumps(list(texts[CORE]), indent=0, ensure_ascii=False) + "\n", encoding="utf-8")


def places_of(text: str) -> list[str]:
    """Places for values in a text, in alphabetical order."""
    return sorted(re.findall(r"\{[^{}]*\}", text))


def missing(language: str) -> list[str]:
    """Texts without a translation, or whose translation has other places for values."""
    known = translated(language)
    return [
        f"{places[0]}: {text}"
        for context, entries in found().items()
        for text, places in entries.items()
        if (context, text) not in known or places_of(known[context, text]) != places_of(text)
    ]


def compile_all() -> None:
    """Compile every language."""
    lrelease = shutil.which("lrelease", path="/usr/lib/qt5/bin:/usr/lib/qt6/bin") or shutil.which("lrelease")
    if lrelease is None:
        raise TranslationError("lrelease is not installed; run `make setup`")
    for path in sorted(FOLDER.glob("*.ts")):
        compiled = path.with_suffix(".qm")
        ran = subprocess.run(
            [lrelease, "-silent", str(path), "-qm", str(compiled)],
            capture_output=True,
            text=True,
            check=False,
        )
        if ran.returncode or not compiled.exists():
            raise TranslationError(f"{path.name}: {ran.stderr.strip() or ran.stdout.strip()}")


def main() -> int:
    """Do what the command line asks for; returns the exit code."""
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
