"""The documentation holds together: pictures that are named are there and small enough, links lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
GUIDE = DOCS / "guide.md"
PAGES = sorted([*DOCS.glob("*.md"), ROOT / "README.md"])
#: The pictures of the guide are part of the plugin's zip.
MOST_BYTES, MOST_BYTES_TOGETHER = 150_000, 1_650_000
#: Topics that the plugin's help buttons lead to.
TOPICS = {"sources", "settings"}

_CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(!?)\[(?:[^\[\]]|!\[[^\]]*\]\([^)]*\))*\]\(([^()\s]+)\)")
_BLOCK = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
_HEADING = re.compile(r"^#+\s+(.+?)\s*$", re.MULTILINE)


def text_of(page: Path) -> str:
    """Text of a page without its code."""
    return _CODE.sub("", page.read_text(encoding="utf-8"))


def links(page: Path, pictures: bool) -> list[str]:
    """Targets of links, or of pictures."""
    return [target for mark, target in _LINK.findall(text_of(page)) if bool(mark) == pictures]


def anchors(page: Path) -> set[str]:
    """What the headings of a page are called in links."""
    headings = _HEADING.findall(_BLOCK.sub("", page.read_text(encoding="utf-8")))
    return {re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", heading.lower())) for heading in headings}


def test_pictures_of_the_guide_are_those_that_are_there():
    named = set(links(GUIDE, pictures=True))
    there = {f"images/{path.name}" for path in (DOCS / "images").glob("guide-*")}
    assert named == there
    assert len(named) > 10


def test_pictures_of_the_guide_are_small_enough():
    sizes = {path.name: path.stat().st_size for path in (DOCS / "images").glob("guide-*")}
    assert {name: size for name, size in sizes.items() if size > MOST_BYTES} == {}
    assert sum(sizes.values()) <= MOST_BYTES_TOGETHER


def test_every_picture_of_the_documentation_is_named_somewhere():
    named = {(page.parent / target).resolve() for page in PAGES for target in links(page, pictures=True)}
    assert named == {path.resolve() for path in (DOCS / "images").iterdir()}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_to_files_and_headings_that_are_there(page):
    for target in [*links(page, pictures=False), *links(page, pictures=True)]:
        if re.match(r"[a-z]+:", target):
            assert target.startswith("https://"), target
            continue
        name, _, anchor = target.partition("#")
        other = page.parent / name if name else page
        assert other.is_file(), target
        if anchor:
            assert anchor in anchors(other), target


def test_help_buttons_find_their_topics():
    sources = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "terrainav_plugin").rglob("*.py"))
    asked = set(re.findall(r'add_help_button\([\w.]+, (?:tr\()?"([\w-]+)"', sources))
    assert asked >= TOPICS
    assert asked <= anchors(GUIDE)


def test_pictures_have_words_for_those_who_do_not_see_them():
    for words in re.findall(r"!\[([^\]]*)\]", text_of(GUIDE)):
        assert len(words.split()) >= 3, words
