from __future__ import annotations

import math

import pyproj
import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.tiles import Template, bbox, check_address, quadkey, url_host


def test_each_placeholder_gets_its_value():
    template = Template("https://{s}.example.org/{map_type}/{date}/{z}/{x}/{y}{r}.png?tms={-y}&q={q}&token={key}")
    url = template.url(3, 3, 5, scale=2, map_type="terrain", date="2024-06-21", key="a&b")
    assert url == "https://c.example.org/terrain/2024-06-21/3/3/5@2x.png?tms=2&q=213&token=a%26b"


def test_quadkeys_are_those_of_the_published_example():
    # Bing Maps Tile System: tile (3, 5) at level 3.
    assert quadkey(3, 3, 5) == "213"
    assert quadkey(0, 0, 0) == ""


@given(st.integers(0, 22).flatmap(lambda z: st.tuples(st.just(z), *[st.integers(0, (1 << z) - 1)] * 2)))
def test_quadkeys_can_be_read_back(tile):
    z, x, y = tile
    digits = quadkey(z, x, y)
    assert len(digits) == z
    assert int("".join(str(int(digit) & 1) for digit in digits) or "0", 2) == x
    assert int("".join(str(int(digit) >> 1) for digit in digits) or "0", 2) == y


@given(st.integers(0, 22).flatmap(lambda z: st.tuples(st.just(z), st.integers(0, (1 << z) - 1))))
def test_rows_from_the_south_mirror_those_from_the_north(row):
    z, y = row
    south = int(Template("http://h/{z}/{x}/{-y}").url(z, 0, y).rpartition("/")[2])
    assert south + y == 2**z - 1


@pytest.mark.parametrize(
    ("text", "hosts"),
    [
        ("https://{s}.h.org/{z}/{x}/{y}", ["a", "b", "c"]),
        ("https://t{1-4}.h.org/{z}/{x}/{y}", ["t1", "t2", "t3", "t4"]),
        ("https://[a-c].h.org/{z}/{x}/{y}", ["a", "b", "c"]),
        ("https://{switch:north,south}.h.org/{z}/{x}/{y}", ["north", "south"]),
    ],
)
def test_subdomains_take_turns_and_a_tile_keeps_its_own(text, hosts):
    template = Template(text)
    urls = [template.url(10, x, 0) for x in range(len(hosts) * 2)]
    assert [url.split("//")[1].split(".")[0] for url in urls] == hosts * 2
    assert template.url(10, 5, 7) == template.url(10, 5, 7)
    assert template.host == f"{hosts[0]}.h.org"


def test_other_programs_spelling_is_read():
    assert Template("http://h/${z}/${x}/${y}").url(1, 0, 1) == "http://h/1/0/1"
    assert Template("http://h/{zoom}/{x}/{y}").url(1, 0, 1) == "http://h/1/0/1"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("http://h/{z}/{x}.png", r"without \{y\}"),
        ("http://h/tiles", r"without \{z\} \{x\} \{y\}"),
        ("http://h/{z}/{x}/{y}/{style}", r"\{style\} is unknown; known are \{z\} \{x\}"),
        ("http://h/{z}/{x}/{y", "an unmatched brace"),
        ("file:///tiles/{z}/{x}/{y}.png", "of file scheme: must start with http:// or https://"),
        ("ftp://h/{z}/{x}/{y}.png", "must start with http"),
        ("tiles/{z}/{x}/{y}.png", "of no scheme"),
        ("https:///{z}/{x}/{y}.png", "must start with http"),
        ("https://{4-1}.h/{z}/{x}/{y}", "the first comes after the last"),
    ],
)
def test_templates_that_cannot_work_say_why(text, message):
    with pytest.raises(InvalidInput, match=message):
        Template(text)


@pytest.mark.parametrize("name", ["key", "access_token", "apikey", "Token", "api-key", "signature"])
def test_a_key_in_a_template_is_refused_without_being_told(name):
    with pytest.raises(InvalidInput) as raised:
        Template(f"https://h.org/{{z}}/{{x}}/{{y}}?style=a&{name}=AIzaSecret")
    assert "AIzaSecret" not in str(raised.value)
    assert f"{name}={{key}}" in str(raised.value)


@pytest.mark.parametrize(
    ("url", "host"),
    [
        ("https://tile.example/1", "tile.example"),
        ("https://TILE.Example:443/1", "tile.example"),
        ("https://tile.example./1", "tile.example"),
        ("https://tile%2Eexample/1", "tile.example"),
        ("https://%74ile%2eexampl%65/1", "tile.example"),
        ("https://user@tile.example/1", "tile.example"),
        ("https://\N{FULLWIDTH LATIN SMALL LETTER T}ile\N{IDEOGRAPHIC FULL STOP}example/1", "tile.example"),
        ("https://tile\N{VARIATION SELECTOR-1}.example/1", "tile.example"),
        ("https://München.example/1", "xn--mnchen-3ya.example"),
        ("http://[::1]:8000/1", "::1"),
        ("http://127.0.0.1:8000/1", "127.0.0.1"),
        ("http://under_scored.example/1", "under_scored.example"),
        # Older programs ask strasse.example, requests asks xn--strae-oqa.example.
        ("https://stra\N{LATIN SMALL LETTER SHARP S}e.example/1", ""),
        ("https://stra%C3%9Fe.example/1", ""),
        ("https://a\N{GREEK SMALL LETTER FINAL SIGMA}.example/1", ""),
        ("https://tile\N{ZERO WIDTH JOINER}.example/1", ""),
        # Where it ends is another place to every program.
        ("https://tile.example\\.other.example/1", ""),
        ("https://tile.example%2F.other.example/1", ""),
        ("https://tile..example/1", ""),
        (f"https://{'a' * 300}/1", ""),
        ("https://[::1/1", ""),
        ("nothing", ""),
    ],
)
def test_a_host_is_the_same_however_it_is_written(url, host):
    assert url_host(url) == host


@pytest.mark.parametrize("host", ["tile.example\\.other.example", "tile.example%2F.other", "a..b", "a" * 300])
def test_a_host_that_programs_read_differently_is_refused(host):
    with pytest.raises(InvalidInput, match="invalid host or port"):
        Template(f"https://{host}/{{z}}/{{x}}/{{y}}")


def test_hosts_are_known_before_a_tile_is_asked_for():
    template = Template("https://{s}.{map_type}til{r}e.example/{z}/{x}/{y}", subdomains=("a", "b"))
    assert {"a.satellitetile.example", "b.terraintile.example"} <= set(template.hosts)


def test_credentials_in_a_template_are_refused_without_being_told():
    with pytest.raises(InvalidInput, match="credentials") as raised:
        Template("https://user:pass-word@h.org/{z}/{x}/{y}")
    assert "pass-word" not in str(raised.value)


def test_parameters_that_are_no_keys_are_let_be():
    Template("https://h.org/wmts?LAYER=ortho&STYLE=normal&TILEMATRIX={z}&TILEROW={y}&TILECOL={x}&tokenized=1")


# --- WMS, and levels with names of their own

MERCATOR = pyproj.Transformer.from_crs(4326, 3857, always_xy=True)


@given(st.integers(0, 20).flatmap(lambda z: st.tuples(st.just(z), *[st.integers(0, (1 << z) - 1)] * 2)))
def test_edges_of_a_tile_are_those_of_its_corners(tile):
    z, x, y = tile

    def corner(column, row):
        # The textbook's formula for a tile's corner, then PROJ: nothing of ours.
        lat_deg = math.degrees(math.atan(math.sinh(math.pi * (1 - 2 * row / 2**z))))
        return MERCATOR.transform(column / 2**z * 360 - 180, lat_deg)

    west, south, east, north = (float(edge) for edge in bbox(z, x, y).split(","))
    assert (west, north) == pytest.approx(corner(x, y), abs=1e-6)
    assert (east, south) == pytest.approx(corner(x + 1, y + 1), abs=1e-6)


def test_a_wms_may_be_written_as_a_template():
    text = "https://h.example/wms?LAYERS=a&BBOX={bbox-epsg-3857}&WIDTH=256&HEIGHT=256"
    assert Template(text).url(1, 1, 0) == text.replace("{bbox-epsg-3857}", bbox(1, 1, 0))


def test_levels_with_names_of_their_own():
    template = Template("https://h.example/{z}/{x}/{y}", levels=((3, "L 03"), (4, "EPSG:3857:4")))
    assert template.url(3, 1, 2) == "https://h.example/L%2003/1/2"
    assert template.url(4, 1, 2) == "https://h.example/EPSG:3857:4/1/2"
    assert template.url(5, 1, 2) == "https://h.example/5/1/2"


def test_addresses_are_held_to_the_same_as_templates():
    check_address("https://h.example/wmts?key={key}", "address")
    for wrong in ("ftp://h.example", "https://me@h.example", "https://h.example?token=abc"):
        with pytest.raises(InvalidInput, match=r"^address "):
            check_address(wrong, "address")


@pytest.mark.parametrize(
    "wrong",
    [
        "http://[::1/",
        "http://h.example:abc/",
        "http://h.example:99999/",
        "http://h h/",
        "http://h/\n",
        "http://h/\x1b",
    ],
)
def test_addresses_that_no_server_can_have(wrong):
    with pytest.raises(InvalidInput, match=r"^address (with spaces|of an invalid host)"):
        check_address(wrong, "address")


@pytest.mark.parametrize(
    "query",
    [
        "?access-token=",
        "?X-Api-Key=",
        "?subscription_key=",
        "?access_key=",
        "?tk=",
        "?ak=",
        "?a=1;key=",
        "#key=",
        "?%6bey=",
    ],
)
def test_keys_are_found_by_whatever_name_and_place(query):
    with pytest.raises(InvalidInput, match="holds a key") as raised:
        check_address(f"https://h.example/{query}abc123", "address")
    assert "abc123" not in str(raised.value)


def test_hosts_are_those_of_every_subdomain_without_the_dot_of_the_root():
    template = Template("https://{switch:a,tile}.h.example./{z}/{x}/{y}")
    assert (template.host, template.hosts) == ("a.h.example", ("a.h.example", "tile.h.example"))
