"""Work of readers of foreign text grows with its length, whatever it is made of: a new reader is one of `READERS`."""

from __future__ import annotations

import contextlib

import pytest
from terrainav.core.capture.blocks.block import Record
from terrainav.core.dataset.geotiff import parse_bands, parse_pam_bands
from terrainav.core.dataset.labels import Labels
from terrainav.core.dataset.table import Table
from terrainav.core.errors import TerrAInavError
from terrainav.core.external.drawing import short_label
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.coords import parse_coords, parse_points
from terrainav.core.mission.areas.files import load_area
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.pose_table import read_poses
from terrainav.core.pairs.places import read_box, read_places
from terrainav.core.poses.gpx import read_gpx
from terrainav.core.poses.trajectories import read_trajectory
from terrainav.core.text.plain import finite_number, first_words, one_line, time_s, without_markup
from terrainav.core.text.safe_json import parse_json
from terrainav.core.text.safe_xml import UnreadableXMLError, parse_xml
from terrainav.core.text.secrets import Secrets

from tests.support.growth import PROPORTIONAL, growth

#: Characters and words that patterns begin, go on or end with.
PIECES = (
    *" \"',;:\n\t[]{}<>&01-+.e%_#/\\=|@?*\u0301",
    *(
        ", ",
        " ,",
        "1,",
        "1 ",
        "1,2 ",
        '"a",',
        '""',
        "{a}",
        "<a ",
        "<a>",
        "<!--",
        "&amp;",
        "&#0",
        "%25",
        "\\u00",
    ),
    *(
        "<title",
        "<script>",
        '<Item name="A" sample="1"',
        '<PAMRasterBand band="1">',
        "EPSG:",
        "A:b:",
        "2024-01-",
    ),
    *('{"a":', "[1,", '\\"', 'a="b" ', "http://", "\n1 2 3", "1 2\n", "\r\n", "&a", "-- ", "1e", ".1"),
)
KEY = Secrets(["aaaa", "{%}", "0" * 50])


def of_file(read, name, before=""):
    """What reads a file of a text, behind a beginning without which it would not be looked at."""

    def from_file(text, folder):
        path = folder / name
        path.write_text(before + text, encoding="utf-8")
        return read(path)

    return from_file


def of_text(read, before="", after=""):
    return lambda text, _folder: read(before + text + after)


def tiff(text: str) -> bytes:
    """A GeoTIFF of two bands with GDAL's tag of such a text."""
    import struct

    data = text.encode()
    tags = ((258, 3, 1, 8), (259, 3, 1, 8), (277, 3, 1, 2), (42112, 2, len(data), 8))
    entries = b"".join(struct.pack("<HHII", *tag) for tag in tags)
    at = 8 + len(data)
    return struct.pack("<2sHI", b"II", 42, at) + data + struct.pack("<H", len(tags)) + entries


KML = (
    "<kml><Polygon><outerBoundaryIs><LinearRing><coordinates>",
    ("</coordinates></LinearRing></outerBoundaryIs></Polygon></kml>"),
)
READERS = {
    "KML": lambda text, folder: of_file(load_area, "a.kml")(text.join(KML), folder),
    "XML": of_text(lambda text: parse_xml(text.encode()), "<a>", "</a>"),
    "XML, head": of_text(lambda text: parse_xml(text.encode()), "<?xml "),
    "GPX": of_text(
        lambda text: read_gpx(text.encode()),
        "<gpx><trk><trkseg><trkpt lat='1' lon='2'><time>",
        "</time></trkpt></trkseg></trk></gpx>",
    ),
    "GeoJSON": of_file(load_area, "a.geojson"),
    "JSON": of_text(parse_json),
    "coordinates": of_text(parse_coords, "1"),
    "points": of_text(lambda text: parse_points(text.splitlines()), "1 2 3\n"),
    "poses": of_text(lambda text: read_poses(text.splitlines()), "lat,lon,agl,time\n1,2,3,"),
    **{
        form: of_text(lambda text, form=form: read_trajectory(text, form, (1.0, 2.0, 3.0), body="urf"))
        for form in ("tum", "kitti", "euroc")
    },
    "places": of_file(read_places, "p.txt", "1 2 a\n3 4 "),
    "box of places": of_text(read_box),
    "table": of_file(Table.load, "m.csv", "img_name,x\na.png,"),
    "labels": of_file(Labels.load, "l.json"),
    "mission": of_file(Mission.load, "m.json"),
    "record of a block": of_text(lambda text: Record.from_bytes(text.encode())),
    "source": of_text(named_source),
    "raster in a file": of_text(named_source, "GPKG:"),
    "template": of_text(named_source, "https://h.example/{z}/{x}/{y}?a="),
    "GDAL's notes": of_text(lambda text: parse_pam_bands(text, 3)),
    "GDAL's tag": of_text(lambda text: parse_bands(tiff(text))),
    "time": of_text(lambda text: time_s(text, "x"), "2024-06-21T10:30:00"),
    "number": of_text(lambda text: finite_number(text, "x"), "1"),
    "page of a server": of_text(lambda text: first_words(text.encode(), "text/html")),
    "markup": of_text(without_markup),
    "line": of_text(one_line),
    "label of a diagram": of_text(short_label),
    "keys": of_text(KEY.masked),
}
CHARACTERS = 8_000


# Each reader with some of the pieces, each piece with some of the readers.
@pytest.mark.parametrize("step", [4, pytest.param(1, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("name", READERS)
def test_work_grows_with_the_length(name, step, tmp_path):
    read = READERS[name]
    slow = {}
    for piece in PIECES[list(READERS).index(name) % step :: step]:

        def work(size, piece=piece):
            with contextlib.suppress(TerrAInavError, UnreadableXMLError, ValueError):
                read(piece * (size // len(piece)), tmp_path)

        grown = growth(work, CHARACTERS)
        if grown >= PROPORTIONAL:
            slow[piece] = grown
    assert not slow
