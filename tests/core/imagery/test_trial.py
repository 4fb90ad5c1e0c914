"""One tile of a source, for people to look at."""

from __future__ import annotations

import math

import pytest
from terrainav.core.errors import PartError
from terrainav.core.imagery.entry import CatalogueEntry
from terrainav.core.imagery.opening import DescribedSource, SourceOptions, named_source
from terrainav.core.imagery.trial import try_tile

from tests.support import patterns
from tests.support.tileserver import TileServer


def described(url, **more):
    data = {
        "title": "Town",
        "kind": "xyz",
        "urls": {"": url},
        "min_zoom": 0,
        "max_zoom": 18,
        "native_zoom": 18,
    }
    entry = CatalogueEntry.from_dict("own", {**data, "attribution": "© Town", **more}, user=True)
    return DescribedSource(entry, SourceOptions())


def expected(lat_deg, lon_deg, zoom):
    """Column and row by the formula of OpenStreetMap's wiki."""
    lat = math.radians(lat_deg)
    count = 2**zoom
    row = (1.0 - math.asinh(math.tan(lat)) / math.pi) / 2.0 * count
    return int((lon_deg + 180.0) / 360.0 * count), int(row)


def test_tile_at_a_place_with_what_is_told_of_it():
    with TileServer() as server:
        trial = try_tile(described(server.url_template), 35.14, -89.86)
        assert (trial.tile.x, trial.tile.y) == expected(35.14, -89.86, trial.tile.zoom)
        assert (trial.pixels == patterns.positions("satellite", *trial.tile, 256)).all()
        assert (trial.format, trial.attribution, trial.native_zoom) == ("PNG", "© Town", 18)
        assert trial.file_bytes > 0
        assert trial.seconds > 0.0
        assert sum(server.tile_requests.values()) == 1


def test_tile_in_the_middle_of_the_imagery_where_the_place_has_none():
    with TileServer() as server:
        bounds = (5.9, 45.8, 10.5, 47.9)
        source = described(server.url_template, bounds_deg=bounds)
        inside, outside = try_tile(source, 46.9, 7.4), try_tile(source, 35.14, -89.86)
    assert (inside.tile.x, inside.tile.y) == expected(46.9, 7.4, inside.tile.zoom)
    # Half-way between the edges on the map.
    rows = [expected(lat, 0.0, outside.tile.zoom)[1] for lat in (45.8, 47.9)]
    assert abs(outside.tile.y - sum(rows) / 2) <= 1
    assert outside.tile.x == expected(0.0, (5.9 + 10.5) / 2, outside.tile.zoom)[0]


def test_tile_that_is_not_there_is_one_line():
    with TileServer() as server:
        server.fail("404")
        with pytest.raises(PartError) as raised:
            try_tile(described(server.url_template))
    assert "404" in str(raised.value)
    assert "\n" not in str(raised.value)


def test_the_embedded_world_has_one_as_well():
    trial = try_tile(named_source("world"), 35.14, -89.86, zoom=17)
    assert trial.pixels.shape == (256, 256, 3)
    assert (trial.tile.x, trial.tile.y) == expected(35.14, -89.86, 17)
    assert trial.format == ""
