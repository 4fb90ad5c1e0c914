"""Find the advice in the messages of the code, and try it.

A message gives advice if one of its clauses begins with a verb ("; choose another folder"), or if it names an option or
a command. For each such message an entry provokes it, and does everything that it advises.
"""

from __future__ import annotations

import ast
import re
import string
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from traceback import walk_tb
from typing import Any, NamedTuple

import pytest
from terrainav.core.errors import OptionName

from tests.support.command import Finished, command
from tests.support.trees import tree_of

ROOT = Path(__file__).parents[2]

#: First words of clauses that give advice.
VERBS = frozenset(
    "add agree allow ask capture choose clean click close copy correct cut drag draw enter finish fix fly get give go "
    "have install leave make mend move name overlap pip plan press put raise remove rename repair resize resume run "
    "save say select set shorten show split start take tick tilt try use wait write".split()
)
#: First words of clauses that state the fault, or the condition that was not met.
STATEMENTS = frozenset(
    "a an commas dates did expected it its known left lat must need needs no nothing the this which".split()
)
_FIRST = re.compile(r"^(?:\{\}, )?(?:or )?([a-z]+)\b(?!.*:)")
_CLAUSE = re.compile(r"[;:] (?:or |\{\})?([a-z]+)\b")
#: Sentences that give advice, and conditions before a clause that does.
_SENTENCE = re.compile(r"(?:^|\. )([A-Z][a-z]+)\b(?=.*\.$)|[;:] if [^,;]*, ([a-z]+)\b", re.DOTALL)
_NAMED = re.compile(r"^(--[a-z-]+ \{\})|[;:] ([^;:]*?(?:--[a-z]|`?\bterrainav [a-z]))")
#: Modules whose texts are help of options and parameters.
_HELP = frozenset(["mission/options.py", "processing/mission_parameters.py"])
#: The function that describes an algorithm.
_DESCRIPTION = "texts"
#: Texts that only look like advice.
NO_ADVICE = frozenset(
    [
        "shares {}: add up to {}; must add up to 1",
        "cache %s: is damaged; set aside as %s and begun anew",
        "--plot shows what a threshold rejects: it does not go with --undo",
        "footprints {path}: have no poses",
        "Plan exported as {names}.",
        # Groups of entries in a few words.
        "tilt {angle}",
        "overlap {share} %",
        (
            "The entropies form one group: nothing stands out, and the threshold stays as it is. Cut in two at {bits} "
            "bits (Otsu's method, the dotted line), {rejected} of {count} images ({percent} %) would be rejected, "
            "which may all be good."
        ),
        # Descriptions of parts of a window, and a question that a window asks.
        (
            "Drag the line: images with less entropy (bits) are rejected.\nArrow keys move it by {step}, with Shift by "
            "{shift}, Page keys by {page} bits."
        ),
        (
            "Draw a polygon: click each corner on the map; a double click, a right click or Enter finishes, Backspace "
            "removes the last corner, Esc cancels"
        ),
        (
            "Change the area on the map: drag inside it to move it; drag the edges and corners of a box, or the "
            "corners of a polygon. Dragging a polygon's edge adds a corner, a right click on a corner or Delete "
            "removes it; a right click elsewhere cuts holes and adds polygons. Arrow keys move the area by a "
            "pixel of the screen, with Shift by ten; Esc ends it."
        ),
        "Set take-off point, by a click on the map",
        "Click a row of the preview to skip it, and again to bring it back; Shift-click takes all rows up to it.",
        "Click the last image of a sortie; click it again to go on without landing.",
        "Missions in the order of the flight: drag them to change it",
        "Lay this image on the map, orthorectified where it is turned or tilted; press again to remove it",
        "{name}\n{bits} bits; press to show it on the map",
        "Remove “{title}” from your sources? Captured images stay.",
        # Titles of windows.
        "TerrAInav: add imagery",
        "TerrAInav: add missions",
        "TerrAInav: add source",
        "TerrAInav: clean dataset",
        "TerrAInav: remove source",
        "TerrAInav: save height profile",
        "TerrAInav: save mission",
        # Steps that are undone.
        "add a corner",
        "add a polygon",
        "cut a hole",
        "drag an edge",
        "draw a no-fly area",
        "draw box",
        "draw polygon",
        "make it a box",
        "make it a polygon",
        "move a corner",
        "move by arrow keys",
        "move the area",
        "remove a corner",
        "remove a hole",
        "remove a polygon",
        "set take-off point",
        "split the flight",
    ]
)
#: Text between two pieces of advice.
_BETWEEN = re.compile(r"\b(?:or|and)\b|\W")


class Place(NamedTuple):
    """A message and its module; values in the message are {}, or have a name in braces."""

    module: str
    message: str

    @property
    def advice_at(self) -> int:
        """Index in the message at which the advice begins; -1 without advice."""
        clauses = [match.start(1) for match in _CLAUSE.finditer(self.message) if match[1] in VERBS]
        first = _FIRST.match(self.message)
        starts = clauses or [first.start(1)] if first is not None and first[1] in VERBS else clauses
        said = [match for match in _SENTENCE.finditer(self.message) if match[match.lastindex].lower() in VERBS]
        starts += [match.start(match.lastindex) for match in said]
        starts = starts or [match.start(match.lastindex) for match in _NAMED.finditer(self.message)]
        return min(starts, default=-1)

    def advice_of(self, text: str) -> str:
        """Advice in a text with this message; empty if it is another message."""
        head, tail = (
            re.sub(r"\\\{\w*\\\}|%s", "(?:.|\\n)*?", re.escape(part))
            for part in (self.message[: self.advice_at], self.message[self.advice_at :].rstrip(", "))
        )
        # Advice that ends with a value extends to the end of the text, or of the line in a command's output.
        whole = f"({tail[:-1]})$" if tail.endswith("*?") else f"({tail})(?=$|[,;.] )"
        # The panel begins its sentences with a capital.
        found = re.search(head + whole, text, re.IGNORECASE)
        return found[1] if found else ""


def _words(node: ast.AST) -> str:
    """Text of a constant, or of an f-string, with {} for its values."""
    if isinstance(node, ast.JoinedStr):
        return "".join("{}" if isinstance(part, ast.FormattedValue) else _words(part) for part in node.values)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def _named(function: ast.AST) -> str:
    return getattr(function, "id", getattr(function, "attr", ""))


def _option(node: ast.AST) -> str:
    """Text of a value in a template if it is a literal or the name of an option, else {}."""
    form = "{}"
    if isinstance(node, ast.Attribute) and node.attr == "in_brackets":
        node, form = node.value, " ({})"
    if isinstance(node, ast.Call) and _named(node.func) == "OptionName":
        name = _words(node.args[0])
        return form.format(OptionName(name) if name else "{}")
    return _words(node) if isinstance(node, ast.Constant) else "{}"


def _filled(template: ast.AST, values: list[ast.expr]) -> list[str]:
    """Texts of a template (several if it is conditional), with names of options filled in and {} for other values."""
    if isinstance(template, ast.IfExp):
        return _filled(template.body, values) + _filled(template.orelse, values)
    if isinstance(template, ast.Call) and _named(template.func) == "Message":
        return _filled(template.args[0], template.args[1:])
    text = _words(template)
    if not text or not values:
        return [text] if text else []
    options = dict(enumerate(map(_option, values)))
    parts = string.Formatter().parse(text)
    return ["".join(fixed if at is None else fixed + options.get(int(at), "{}") for fixed, at, _, _ in parts)]


def _of_call(call: ast.Call) -> list[str]:
    """Texts of a message, or of an error with its remedy, in a call."""
    if (
        not re.search(r"^(Message|InvalidInput|Cancelled|OutOfReach|NotThere)$|Error$", _named(call.func))
        or not call.args
    ):
        return []
    remedies = [word.value for word in call.keywords if word.arg == "remedy"]
    advice = [text for remedy in remedies for text in _filled(remedy, [])]
    texts = _filled(call.args[0], call.args[1:])
    if len(texts) == len(advice) > 1:
        # The text and the remedy are both conditional, as for one thing and for several: pair them.
        return [f"{text}; {one}" for text, one in zip(texts, advice)]
    return [f"{text}; {one}" for text in texts or ["{}"] for one in advice] or texts


def _messages(tree: ast.Module) -> Iterator[str]:
    """Texts of a module that are neither docstrings nor the help of options and algorithms."""
    aside: set[ast.AST] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            aside.add(node.value)
        elif isinstance(node, ast.FunctionDef) and node.name == _DESCRIPTION:
            aside.update(ast.walk(node))
        elif isinstance(node, ast.JoinedStr):
            aside.update(node.values)
        elif isinstance(node, ast.keyword) and node.arg in (
            "help",
            "title",
            "label",
            "description",
            "epilog",
        ):
            aside.update(ast.walk(node.value))
    for node in ast.walk(tree):
        texts = _of_call(node) if isinstance(node, ast.Call) and node not in aside else []
        if texts:
            remedies = [word.value for word in node.keywords if word.arg == "remedy"]
            for taken in (node.args[0], *remedies):
                aside.update(ast.walk(taken))
        elif isinstance(node, (ast.JoinedStr, ast.Constant)) and node not in aside:
            texts = [_words(node)]
        yield from (text for text in texts if " " in text)


@cache
def places(package: str) -> Counter[Place]:
    """Every message of a package that gives advice, and how often its module has it."""
    found: Counter[Place] = Counter()
    for path in sorted((ROOT / package).rglob("*.py")):
        module = path.relative_to(ROOT / package).as_posix()
        if module in _HELP:
            continue
        tree = tree_of(path)
        # Texts that begin with a line feed are help or style sheets.
        texts = (text for text in _messages(tree) if text not in NO_ADVICE and not text.startswith("\n"))
        found.update(place for place in (Place(module, text) for text in texts) if place.advice_at >= 0)
    return found


def unknown_beginnings(package: str) -> set[str]:
    """First words of clauses of refusals that are in neither `VERBS` nor `STATEMENTS`."""
    found: set[str] = set()
    for path in (ROOT / package).rglob("*.py"):
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Call) and _named(node.func) != "Message":
                texts = _of_call(node)
                found.update(word.lower() for text in texts for word in re.findall(r"; (?:or )?([A-Za-z]+)\b", text))
    return found - VERBS - STATEMENTS


Entry = Callable[["Case"], None]
#: Entries that try the advice, by place.
ENTRIES: dict[Place, Entry] = {}


def remedy(module: str, message: str) -> Callable[[Entry], Entry]:
    """Register a function as the entry that tries the advice of a message."""

    def enter(entry: Entry) -> Entry:
        place = Place(module, message)
        if place in ENTRIES:
            raise ValueError(f"two entries of {place}")
        ENTRIES[place] = entry
        return entry

    return enter


class Case:
    """One message that is provoked, and the part of its advice that remains to be tried."""

    def __init__(self, place: Place, package: str, request: pytest.FixtureRequest) -> None:
        self.place = place
        self._package, self._request = package, request
        self._left: str | None = None
        self._run: Callable[..., Finished] | None = None
        self.advice = ""

    @property
    def tmp_path(self) -> Path:
        return self._request.getfixturevalue("tmp_path")

    @property
    def monkeypatch(self) -> pytest.MonkeyPatch:
        return self._request.getfixturevalue("monkeypatch")

    def fixture(self, name: str) -> Any:
        """A fixture of the tests that run the entries."""
        return self._request.getfixturevalue(name)

    @property
    def run(self) -> Callable[..., Finished]:
        """The command, in ``tmp_path`` and as a user with nothing configured or cached."""
        if self._run is None:
            capsys = self._request.getfixturevalue("capsys")
            self._run = command(self.tmp_path, self.monkeypatch, capsys)
        return self._run

    def refused(self, action: Callable[[], Any], kind: type[BaseException] = Exception) -> str:
        """Run an action that raises the message in its module; returns the text."""
        with pytest.raises(kind) as caught:
            action()
        assert self._passed(caught.value), f"not raised in {self.place.module}: {caught.value}"
        return self._heard(str(caught.value))

    def says(self, text: str, *, only_here: bool = True) -> str:
        """Find the message in a text; returns its line. ``only_here`` states that only this module has it."""
        same = [place for place in places(self._package) if place.message == self.place.message]
        assert (same == [self.place]) == only_here, "said at several places: provoke it by `refused`"
        lines = [line for line in text.splitlines(keepends=True) if self.place.advice_of(line)]
        assert lines, f"{self.place.message!r} is not in:\n{text}"
        return self._heard(lines[0]).rstrip("\n")

    def _passed(self, wrong: BaseException | None) -> bool:
        """Whether an error, or one that it is raised from, came from the place's module."""
        own = (ROOT / self._package / self.place.module).resolve()
        while wrong is not None:
            for frame, _ in walk_tb(wrong.__traceback__):
                if Path(frame.f_code.co_filename).resolve() == own:
                    return True
            wrong = wrong.__cause__
        return False

    def _heard(self, text: str) -> str:
        advice = self.place.advice_of(text)
        assert advice, f"another message: {text}"
        if self._left is None:
            self.advice = self._left = advice
        return text

    def follow(self, what: str, action: Callable[[], Any]) -> None:
        """Follow a part of the advice, quoted in ``what``; fails if the action raises or returns False."""
        assert self._left is not None, "nothing was refused before"
        assert what in self._left, f"{what!r} is not in what is left of the advice: {self._left!r}"
        assert action() is not False, f"{what!r} did not help"
        self._left = self._left.replace(what, " ", 1)

    def check(self) -> None:
        """Fail if a part of the advice was not followed."""
        assert self._left is not None, "the message was not provoked"
        assert not _BETWEEN.sub("", self._left), f"not tried of the advice: {self._left!r}"
