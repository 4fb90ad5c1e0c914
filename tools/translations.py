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
from collections.abc import Iterable, Iterator
from functools import cache
from itertools import count
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
#: Rooms whose errors are told in the plugin, and not only by the command.
TOLD = (
    "core/capture",
    "core/dataset",
    "core/drawing.py",
    "core/fields.py",
    "core/geodesy",
    "core/imagery",
    "core/mission",
    "core/picture",
    "core/report",
    "core/safe_json.py",
    "core/unexpected.py",
    "terrainav_plugin",
)
#: Modules in them of which the plugin makes no use.
UNTOLD = (
    "core/dataset/convert.py",
    "core/dataset/loading/augment.py",
    "core/dataset/loading/batches.py",
    "core/dataset/loading/keras_loader.py",
    "core/dataset/loading/torch_loader.py",
    "core/dataset/vbn.py",
)
#: Modules whose texts are all for users: the parts of messages and figures, and reasons that others put into theirs.
WORDS = (
    "core/picture/cost.py",
    "core/capture/pipeline.py",
    "core/dataset/clean.py",
    "core/dataset/entropy.py",
    "core/dataset/dataset.py",
    "core/dataset/table.py",
    "core/geodesy/accuracy.py",
    "core/imagery/cache/tilestore.py",
    "core/imagery/entry.py",
    "core/imagery/catalogue.py",
    "core/imagery/policy.py",
    "core/imagery/raster/source.py",
    "core/imagery/services/capabilities.py",
    "core/imagery/services/wms.py",
    "core/imagery/source.py",
    "core/mission/cameras.py",
    "core/mission/coords.py",
    "core/mission/estimate.py",
    "core/mission/export/waypoints.py",
    "core/mission/export/writing.py",
    "core/mission/layout/framing.py",
    "core/mission/methods.py",
    "core/mission/earlier.py",
    "core/mission/layout/rotated.py",
    "terrainav_plugin/network/answers.py",
    "terrainav_plugin/network/worker.py",
    "terrainav_plugin/qgis_source/renderer.py",
    "terrainav_plugin/qgis_source/source.py",
    "terrainav_plugin/settings.py",
)
#: Single words for users, which nothing tells apart from names, and phrases of modules that have other texts too.
PHRASES = {
    "core/imagery/http/client.py": (
        " (tried {0} times)",
        "{0}: not asked for, as the last {1} parts had no answer in time; resume later",
    ),
    "core/imagery/decode.py": (
        "a WebP picture, which libwebp {0} would not read safely: install Pillow 10.0.1 or later",
    ),
    "core/imagery/placeholder.py": ("no imagery here: the provider's placeholder picture",),
    "core/imagery/staticmap.py": ("picture at {0},{1} zoom {2}",),
    "core/imagery/template.py": ("URL template",),
    "core/imagery/mbtiles.py": ("the source was closed",),
    "core/mission/estimate.py": (
        "images",
        "picture",
        "coverage",
        "imagery",
        "tiles",
        "download",
        "files",
        "time",
        "warning",
        "complete",
        "complete but for missing imagery",
    ),
    "core/mission/methods.py": (
        "footprint",
        "picture",
        "pixels",
        "error",
        "terrain",
        "nothing",
        "resampling",
        "wind",
    ),
    "core/report/measure.py": (
        "footprints",
        "a picture",
        "camera frames",
        "resampling",
        "file formats",
        "wind",
        "what was left out",
    ),
    "core/report/page.py": ("page",),
}
#: What the core says with a word in place of a value, and what Python says in its messages.
BESIDES = (
    "tilt {0} deg: must be from {1} to {2}",
    "roll {0} deg: must be from {1} to {2}",
    "{0} from {1} to now; {2}",
    "date {0}: must be {1}, from {2} to now",
    "could not convert string to float: {0}",
)
#: A text worth translating has a word in it, and is no query, markup or pattern.
_WORD = re.compile(r"[A-Za-z]{2,}")
_CODE = re.compile(r"^(SELECT|PRAGMA) |[<>\\|]|\n")
_PLACE = re.compile(r"\{\d+\}")
_VALUE = re.compile(r"\{(\d+)[!:][^{}]*\}")
_FIELD = re.compile(r"(\{\w*\})")

Texts = dict[str, dict[str, list[str]]]


class TranslationError(Exception):
    """A text that cannot be extracted, or a file that cannot be read."""


def templates_of(node: ast.expr) -> Iterator[str]:
    """Yield the texts that an expression may give, with ``{0}``, ``{1}``, ... for the values in them."""
    for parts in _variants(node):
        places = count()
        yield "".join(f"{{{next(places)}}}" if part is None else part for part in parts)


def _variants(node: ast.expr) -> list[list[str | None]]:
    """Parts of each text that an expression may give; None for a value."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [[node.value]]
    if isinstance(node, ast.JoinedStr):
        return [[str(part.value) if isinstance(part, ast.Constant) else None for part in node.values]]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return [left + right for left in _variants(node.left) for right in _variants(node.right)]
    if isinstance(node, ast.IfExp):
        return _variants(node.body) + _variants(node.orelse)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "format":
        return [
            [None if place % 2 else part for place, part in enumerate(_FIELD.split(text))]
            for text in templates_of(node.func.value)
        ]
    return [[None]]


def plugin_texts(path: Path) -> Iterator[str]:
    """Yield every text given to ``tr``."""
    for call in _translated_calls(path):
        text = call.args[0] if call.args else None
        if isinstance(text, ast.Constant) and isinstance(text.value, str):
            yield text.value
        elif path.name != "i18n.py":
            where = f"{path.relative_to(ROOT)}:{call.lineno}"
            raise TranslationError(f"{where}: tr() of something that is no plain text cannot be translated")


def core_texts(path: Path) -> Iterator[str]:
    """Yield the messages of errors, and of modules in `WORDS` and `PHRASES` what these say."""
    name, tree = path.relative_to(ROOT).as_posix(), _tree(path)
    phrases = PHRASES.get(name, ())
    left_out = _left_out(tree)
    seen = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "declared":
            yield from declared_texts(node)
        if isinstance(node, ast.Call) and _names_error(node.func) and node.args:
            texts = templates_of(node.args[0])
            if len(node.args) > 1:
                plain = (_VALUE.sub(r"{\1}", text) for text in texts)
                texts = (text.replace("{{", "{").replace("}}", "}") for text in plain)
            yield from filter(_is_worded, texts)
        if id(node) in left_out or not isinstance(node, (ast.Constant, ast.JoinedStr)):
            continue
        for text in templates_of(node):
            seen.add(text)
            if text in phrases or (name in WORDS and _is_worded(text)):
                yield text
    if not seen.issuperset(phrases):
        raise TranslationError(f"{name}: has no text {min(set(phrases) - seen)!r} any more")


def declared_texts(call: ast.Call) -> Iterator[str]:
    """Yield what is said of a field of a mission where it is declared: title, help, and what its choices are called."""
    for keyword in call.keywords:
        if keyword.arg in ("title", "help") and isinstance(keyword.value, ast.Constant):
            yield str(keyword.value.value)
        elif keyword.arg == "choices" and isinstance(keyword.value, ast.Dict):
            yield from (str(text.value) for text in keyword.value.values if isinstance(text, ast.Constant))


def _is_worded(text: str) -> bool:
    """Whether a text has words, and so is no name, number or mark."""
    words = _PLACE.sub("", text)
    return " " in text.strip() and _WORD.search(words) is not None and not _CODE.search(words)


@cache
def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def _translated_calls(path: Path) -> Iterator[ast.Call]:
    for node in ast.walk(_tree(path)):
        if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == "tr":
            yield node


def _left_out(tree: ast.Module) -> set[int]:
    """Nodes that are no texts of their own: documentation, parts of f-strings, what ``tr`` takes, ``__repr__``."""
    found: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr):
            found.add(id(node.value))
        elif isinstance(node, ast.JoinedStr):
            found.update(id(part) for part in node.values)
        elif isinstance(node, ast.Call) and (
            getattr(node.func, "id", "") == "tr" or (_names_error(node.func) and len(node.args) > 1)
        ):
            found.update(id(part) for part in node.args)
        elif isinstance(node, ast.FunctionDef) and node.name == "__repr__":
            found.update(id(part) for part in ast.walk(node))
    return found


def _names_error(function: ast.expr) -> bool:
    name = getattr(function, "id", getattr(function, "attr", ""))
    return name in ("InvalidInput", "Cancelled", "Message") or name.endswith("Error")


def found() -> Texts:
    """Texts by context, each with the files it is in."""
    texts: Texts = {PLUGIN: {}, CORE: {}}
    for path in sorted((ROOT / "terrainav_plugin").rglob("*.py")):
        _add(texts[PLUGIN], plugin_texts(path), path)
    for room in TOLD:
        for path in sorted((ROOT / room).rglob("*.py")) or [ROOT / room]:
            if path.relative_to(ROOT).as_posix() not in UNTOLD:
                _add(texts[CORE], core_texts(path), path)
    _add(texts[CORE], BESIDES, Path(__file__).resolve())
    return texts


def _add(texts: dict[str, list[str]], more: Iterable[str], path: Path) -> None:
    name = path.relative_to(ROOT).as_posix()
    # In a fixed order, whatever the order of the code: moved code changes nothing.
    for text in sorted(set(more)):
        texts.setdefault(text, []).append(name)


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
    """Bring the files up to what the source says now."""
    texts = found()
    FOLDER.mkdir(exist_ok=True)
    for language in LANGUAGES:
        write(language, texts, translated(language))
    MESSAGES.write_text(json.dumps(list(texts[CORE]), indent=0, ensure_ascii=False) + "\n", encoding="utf-8")


def places_of(text: str) -> list[str]:
    """Places for values in a text, in alphabetical order."""
    return sorted(re.findall(r"\{[^{}]*\}", text))


def mnemonics_of(text: str) -> int:
    """How many letters of a text are keys that choose it."""
    return len(re.findall(r"&(?=\w)", text))


def missing(language: str) -> list[str]:
    """Texts without a translation, or whose translation has other places for values or keys."""
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
