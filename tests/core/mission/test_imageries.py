"""Texts that name several imageries."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.map_types import MAP_TYPES
from terrainav.core.mission.imageries import NamedImagery, named_imageries


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("here=world", NamedImagery("here", "world")),
        ("map=world:roadmap", NamedImagery("map", "world", "", "roadmap")),
        ("2014=naip/2014.tif", NamedImagery("2014", "naip/2014.tif")),
        ("old=esri-wayback@2014-02-20", NamedImagery("old", "esri-wayback", "2014-02-20")),
        (
            "old=wmts:https://a.org/x?a=b#layer=c@2019:terrain",
            NamedImagery("old", "wmts:https://a.org/x?a=b#layer=c", "2019", "terrain"),
        ),
        # What is no date and no map type belongs to the source: hosts with users, tiles of twice the size, drives.
        ("a=https://me@host/{z}/{x}/{y}@2x.png", NamedImagery("a", "https://me@host/{z}/{x}/{y}@2x.png")),
        # Without a name: that of source, date and map type.
        ("world", NamedImagery("world", "world")),
        ("Synthetic (offline)", NamedImagery("Synthetic-offline", "Synthetic (offline)")),
        ("world@2020:roadmap", NamedImagery("world-2020-roadmap", "world", "2020", "roadmap")),
        ("naip/old 2014.tif", NamedImagery("old-2014", "naip/old 2014.tif")),
        (r"C:\maps\a.tif", NamedImagery("a", r"C:\maps\a.tif")),
        ("wms:https://a.org/x?a=b#layers=c", NamedImagery("a.org", "wms:https://a.org/x?a=b#layers=c")),
        ("https://me:secret@h/{z}/{x}/{y}.png", NamedImagery("h", "https://me:secret@h/{z}/{x}/{y}.png")),
        ("(?)", NamedImagery("imagery", "(?)")),
        (r"a=C:\maps\a.tif", NamedImagery("a", r"C:\maps\a.tif")),
        ("a=https://host:8080/{z}/{x}/{y}.png", NamedImagery("a", "https://host:8080/{z}/{x}/{y}.png")),
        ("a=world@2020-06-01T12:00:00Z:satellite", NamedImagery("a", "world", "2020-06-01T12:00:00Z")),
    ],
)
def test_a_text_is_name_source_date_and_map_type(text: str, wanted: NamedImagery) -> None:
    assert NamedImagery.parse(text) == wanted


@given(
    st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_-]{0,8}", fullmatch=True).filter(
        lambda name: name.lower()[:3] not in ("con", "prn", "aux", "nul", "com", "lpt")
    ),
    st.sampled_from(["world", "a b.tif", "https://h/{z}/{x}/{y}", "wms:http://h#layers=a"]),
    st.sampled_from(["", "2014", "2014-05-06"]),
    st.sampled_from(MAP_TYPES),
)
def test_its_text_is_read_back(name: str, source: str, date: str, map_type: str) -> None:
    one = NamedImagery(name, source, date, map_type)
    assert NamedImagery.parse(str(one)) == one


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "imagery 'imagery': has no source"),
        ("=world", "imagery '': must be named by"),
        ("../up=world", "imagery '../up': must be named by"),
        ("a.=world", "imagery 'a.': must be named by"),
        ("nul=world", "imagery 'nul': is the name of a device"),
        ("COM1.x=world", "imagery 'COM1.x': is the name of a device"),
        ("a=", "imagery 'a': has no source, such as a=world"),
    ],
)
def test_what_names_no_imagery_is_refused(text: str, said: str) -> None:
    with pytest.raises(InvalidInput, match="^" + said.replace(".", r"\.")):
        NamedImagery.parse(text)


def test_two_imageries_do_not_share_a_folder() -> None:
    with pytest.raises(InvalidInput, match="imagery 'A': is named twice"):
        named_imageries(["a=world", "b=world:roadmap", "A=world@2014"])
