"""CityJSON buildings placed at their heights and on the ground."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyproj
import pytest
from shapely.geometry import Polygon
from terrainav.core.elevation.datum import Datum
from terrainav.core.errors import InvalidInput
from terrainav.core.faces.buildings import BuildingOptions, FootprintBuildings
from terrainav.core.faces.city_buildings import CityBuildings
from terrainav.core.faces.cityjson import read_city
from terrainav.core.faces.opening import open_buildings, parse_city, whole_building_path
from terrainav.core.faces.surfaces import is_closed
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.geodesy.triangles import FLOOR, ROOF, WALL

DATA = Path(__file__).resolve().parents[4] / "shared" / "data" / "cityjson"
BOX = [[[0, 3, 2, 1]], [[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7]]]
UTM, ELLIPSOIDAL, DUTCH = "EPSG:32632", "EPSG:4979", "EPSG:7415"
EAST, NORTH = 500_000.0, 5_205_000.0
TO_ECEF = pyproj.Transformer.from_crs(4979, 4978, always_xy=True)
FROM_ECEF = pyproj.Transformer.from_crs(4978, 4979, always_xy=True)


class Ground:
    """A steep rough slope, on pixels of about 3 m, by default about 500 m high."""

    title, attribution = "slope", ""
    grid = PixelGrid(max_zoom=16, native_zoom=16)

    def __init__(self, height_m=500.0, slope=1.0):
        self.height_m, self.slope = height_m, slope

    def surface(self, lat_deg, lon_deg, cell_m=0.0):
        probe = Surface(self.grid, 16, 0, 0, np.zeros((2, 2)))
        x, y = probe.position(np.asarray(lat_deg), np.asarray(lon_deg))
        left, top = int(x.min()) - 3, int(y.min()) - 3
        columns, rows = np.meshgrid(np.arange(left, x.max() + 4), np.arange(top, y.max() + 4))
        rough = 2.0 * (columns % 50) + 1.5 * (rows % 50) + 3 * np.sin(columns) * np.cos(2 * rows)
        return Surface(self.grid, 16, left, top, self.height_m + self.slope * rough)


def boxes(*heights, x=EAST, y=NORTH, apart=30.0):
    """Vertices of boxes of 10 m x 20 m x 5 m, whose floors are at some heights."""
    found = []
    for k, z in enumerate(heights):
        ring = [(0, 0), (10, 0), (10, 20), (0, 20)]
        found += [[x + apart * k + a, y + b, z + c] for c in (0, 5) for a, b in ring]
    return found


@pytest.fixture
def made(tmp_path):
    def of(vertices, crs=UTM, kind="Building", faces=BOX, **more):
        def numbered(one, by):
            return [numbered(inner, by) for inner in one] if isinstance(one, list) else one + by

        objects = {
            str(k): {"type": kind, "geometry": [{"type": "Solid", "lod": 1, "boundaries": [numbered(faces, 8 * k)]}]}
            for k in range(len(vertices) // 8)
        }
        content = {"type": "CityJSON", "version": "1.0", "CityObjects": objects, "vertices": vertices, **more}
        if crs:
            content["metadata"] = {"referenceSystem": crs}
        path = tmp_path / "made.json"
        path.write_text(json.dumps(content))
        return str(path)

    return of


def everything(model):
    return model.triangles(np.array([-89.0, 89.0]), np.array([-179.0, 179.0]))


def geodetic(triangles):
    lon, lat, height = FROM_ECEF.transform(*np.moveaxis(triangles.corners_m, -1, 0))
    return lon, lat, height


def test_boxes_stand_on_the_lowest_ground(made):
    model = open_buildings(made(boxes(0.0, 100.0)), Ground())
    assert model.heights == "ground"
    triangles = everything(model)
    assert model.counts.placed == 2
    to_degrees = pyproj.Transformer.from_crs(UTM, 4326, always_xy=True)
    for number in (1, 2):
        own = triangles.take(triangles.instance == number)
        height = geodetic(own)[2]
        t = np.linspace(0.0, 1.0, 4001)[:, None]
        ring = np.array(boxes(0.0, 0.0))[8 * (number - 1) : 8 * (number - 1) + 4, :2]
        edges = np.concatenate([a + t * (b - a) for a, b in zip(ring, np.roll(ring, -1, axis=0))])
        at_lon, at_lat = to_degrees.transform(*edges.T)
        surface = Ground().surface(at_lat, at_lon)
        lowest = surface.heights(*surface.position(np.asarray(at_lat), np.asarray(at_lon))).min()
        roof = height[own.kind == ROOF]
        assert roof == pytest.approx(np.full(roof.shape, lowest + 5.0), abs=2e-3)
        # Walls go on 2 m below the lowest ground, so that no gap is left at any place.
        assert height.min() == pytest.approx(lowest - 2.0, abs=2e-3)
        assert not (own.kind == FLOOR).any()
        assert (own.kind == WALL).sum() == 16
        # Together with the floor, which is left out, these are closed.
        names = {
            corner: k for k, corner in enumerate(sorted(map(tuple, own.corners_m.round(4).reshape(-1, 3).tolist())))
        }
        index = np.array([[names[tuple(c)] for c in one] for one in own.corners_m.round(4).tolist()])
        deep = [k for k in np.unique(index) if height.ravel()[index.ravel() == k][0] < lowest - 1.0]
        assert len(deep) == 4
        low = np.isin(index, deep)
        edges = [
            (one[k], one[k - 1]) for one, is_low in zip(index, low) for k in range(3) if is_low[k] and is_low[k - 1]
        ]
        after = dict(edges)
        a = edges[0][0]
        b, c, d = after[a], after[after[a]], after[after[after[a]]]
        assert is_closed(np.concatenate([index, [(a, b, c), (a, c, d)]]))


def test_heights_over_the_ellipsoid_are_kept(made):
    lon, lat = 9.0, 47.0
    vertices = [[lon + (x - EAST) * 1e-5, lat + (y - NORTH) * 1e-5, z] for x, y, z in boxes(480.0, 900.0)]
    model = open_buildings(made(vertices, ELLIPSOIDAL), Ground())
    assert model.heights == "file"
    triangles = everything(model)
    corners = np.stack(TO_ECEF.transform(*np.array(vertices).T), axis=-1)
    above = triangles.corners_m.reshape(-1, 3)
    apart = np.linalg.norm(above[:, None] - corners, axis=2).min(axis=1)
    # Corners are those of the file, but for the feet of walls that go on below.
    _, _, height = geodetic(triangles)
    assert apart[(height > 479.9).ravel() & (np.abs(height - 900).ravel() > 1e-3)].min() < 1e-6
    roofs = (triangles.kind == ROOF)[:, None] & np.ones(3, bool)
    assert apart[roofs.ravel()].max() < 1e-6
    assert sorted(set(height[roofs].round(3).tolist())) == [485.0, 905.0]
    # One is below the ground, and the walls of the other are made longer to reach it.
    assert (model.counts.placed, model.counts.raised, model.counts.sunk) == (2, 1, 1)
    low = [height[triangles.instance == k].min() for k in (1, 2)]
    assert low[0] == pytest.approx(478.0, abs=1e-3)
    assert low[1] < 900.0 - 2.0 - 100.0


def test_ground_can_be_asked_for(made):
    lon, lat = 9.0, 47.0
    vertices = [[lon + (x - EAST) * 1e-5, lat + (y - NORTH) * 1e-5, z] for x, y, z in boxes(900.0)]
    path = made(vertices, ELLIPSOIDAL)
    model = open_buildings(f"{path}#heights=ground", Ground())
    assert model.heights == "ground"
    assert geodetic(everything(model))[2].max() < 700.0


def test_datum_whose_grid_is_missing(made, monkeypatch):
    def check(self):
        raise InvalidInput("heights over {0}: no grid", self.name)

    monkeypatch.setattr(Datum, "check", check)
    path = made(boxes(0.0, x=85_000.0, y=447_000.0), DUTCH)
    assert open_buildings(path, Ground()).heights == "ground"
    with pytest.raises(InvalidInput, match="no grid"):
        open_buildings(f"{path}#heights=file", Ground())
    model = open_buildings(path, Ground(40.0, 0.0), BuildingOptions(height_offset_m=43.0))
    assert model.heights == "file"
    height = geodetic(everything(model))[2]
    assert (height.min(), height.max()) == pytest.approx((38.0, 48.0), abs=1e-3)
    model = open_buildings(f"{path}#heights=file", Ground(), BuildingOptions(datum="ellipsoid"))
    assert geodetic(everything(model))[2].max() == pytest.approx(5.0, abs=1e-3)


def test_datum_that_proj_knows(made):
    try:
        Datum.named("EGM96").check()
    except InvalidInput:
        pytest.skip("PROJ has no grid of EGM96")
    model = open_buildings(made(boxes(10.0), f"{UTM}+5773"), Ground())
    assert model.heights == "file"
    to = pyproj.Transformer.from_crs(f"{UTM}+5773", 4979, always_xy=True)
    assert geodetic(everything(model))[2].max() == pytest.approx(to.transform(EAST, NORTH, 15.0)[2], abs=0.01)


def test_units_of_heights(made):
    path = made(boxes(10.0, x=2_000_000.0, y=700_000.0), "EPSG:2263")
    with pytest.raises(InvalidInput, match="does not say whether its heights are in metres"):
        open_buildings(path, Ground())
    model = open_buildings(path, Ground(0.0, 0.0), BuildingOptions(height_unit="us-ft"))
    height = geodetic(everything(model))[2]
    assert height.max() == pytest.approx(5.0 * 1200.0 / 3937.0, abs=1e-3)


def test_buildings_without_ground(made):
    class Nothing(Ground):
        def surface(self, lat_deg, lon_deg, cell_m=0.0):
            found = super().surface(lat_deg, lon_deg, cell_m)
            return Surface(found.grid, found.zoom, found.left_px, found.top_px, np.full(found.heights_m.shape, np.nan))

    model = open_buildings(made(boxes(0.0)), Nothing())
    assert len(everything(model)) == 0
    assert (model.counts.placed, model.counts.without_ground) == (0, 1)
    model = open_buildings(made(boxes(7.0)), Nothing(), BuildingOptions(height_offset_m=1.0))
    height = geodetic(everything(model))[2]
    assert (height.min(), height.max()) == pytest.approx((6.0, 13.0), abs=1e-3)


def test_vertices_out_of_range(made):
    with pytest.raises(InvalidInput, match=r"no vertex lies where .* is defined; write the right system"):
        open_buildings(made(boxes(0.0, x=1e8)), Ground())
    vertices = boxes(0.0)
    vertices[6] = [1e15, 1e15, 5.0]
    model = open_buildings(made(vertices), Ground())
    assert model.model.counts.broken_surfaces == 3
    assert any("3 surfaces are missing" in warning for warning in model.warnings)
    for place in ([1e8, NORTH, 5.0], [EAST + 20_000.0, NORTH, 5.0], [EAST, NORTH, 1e6]):
        vertices[6] = place
        model = open_buildings(made(vertices), Ground())
        assert 0 < model.out_of_range < 12
        assert np.isfinite(everything(model).corners_m).all()
        assert any("triangles are missing, as they lie far off" in warning for warning in model.warnings)


def test_a_city_across_the_antimeridian(made):
    lat = -17.0
    vertices = [
        [(179.9999 + (x - EAST) * 1e-5 + 180.0) % 360.0 - 180.0, lat + (y - NORTH) * 1e-5, z] for x, y, z in boxes(0.0)
    ]
    model = open_buildings(f"{made(vertices, ELLIPSOIDAL)}#heights=ground", Ground())
    for lon in (180.0, -180.0):
        assert len(model.triangles(np.array([lat, lat + 1e-3]), lon + np.array([-1e-3, 1e-3]))) == 18
    assert len(model.triangles(np.array([lat, lat + 1e-3]), np.array([0.0, 1.0]))) == 0


def test_only_what_is_in_view_and_large_enough(made):
    model = open_buildings(made(boxes(0.0, 0.0, 0.0, apart=2000.0)), Ground())
    lon, lat = pyproj.Transformer.from_crs(UTM, 4326, always_xy=True).transform(EAST + 2000.0, NORTH)
    around = lat + np.array([-1e-3, 1e-3]), lon + np.array([-1e-3, 1e-3])
    assert set(model.triangles(*around).instance.tolist()) == {2}
    assert set(model.triangles(around[0], around[1] + 360.0).instance.tolist()) == {2}
    assert len(model.triangles(*around, 21.0)) == 0
    assert len(model.triangles(*around, 19.0)) == len(model.triangles(*around))
    assert len(everything(model)) == 3 * 18
    assert model.counts.placed == 3
    assert model.count == 3


def test_bridges_have_no_walls_below(made):
    model = open_buildings(made(boxes(0.0), kind="Bridge"), Ground())
    triangles = everything(model)
    assert np.bincount(triangles.kind, minlength=4).tolist() == [0, 2, 8, 2]


@pytest.mark.parametrize("is_one", [False, True])
def test_roofs_below_others_show_no_imagery(made, is_one):
    # A box, a smaller one that floats above its middle, and one that stands beside it, edge to edge.
    small = [(EAST + 3 + x, NORTH + 9 + y, 28 + z) for z in (0, 2) for x, y in ((0, 0), (3, 0), (3, 3), (0, 3))]
    vertices = [*boxes(20.0), *small, *boxes(24.0, x=EAST + 10)]
    objects = {}
    if is_one:
        solids = [[[[[at + 8 * k for at in ring] for ring in face] for face in BOX]] for k in range(3)]
        geometry = {"type": "MultiSolid", "lod": 2, "boundaries": solids}
        objects = {"CityObjects": {"a": {"type": "Building", "geometry": [geometry]}}}
    found = everything(CityBuildings(read_city(made(vertices, **objects)), Ground(slope=0.0), None, "file"))
    lon, lat, up = geodetic(found)
    east, north = pyproj.Transformer.from_crs(4326, UTM, always_xy=True).transform(lon, lat)
    above = Polygon([(EAST + x, NORTH + y) for x, y in ((3, 9), (6, 9), (6, 12), (3, 12))])
    roofs = np.flatnonzero(found.kind == ROOF)
    assert len(roofs) == 6
    for one in roofs.tolist():
        overlap = Polygon(np.stack([east[one], north[one]], axis=1)).intersection(above).area
        assert found.shows_imagery[one] == (up[one].max() > 28 or overlap < 0.01)
    assert not found.shows_imagery[found.kind != ROOF].any()
    assert (~found.shows_imagery[roofs]).sum() == 2


def test_colours_are_plain_by_seed(made):
    path = made(boxes(*[0.0] * 20))
    first, again, other = (everything(open_buildings(path, Ground(), BuildingOptions(seed=k))) for k in (1, 1, 2))
    assert (first.colour == again.colour).all()
    assert (first.colour != other.colour).any()
    assert not first.shows_imagery[first.kind == WALL].any()
    assert first.shows_imagery[first.kind == ROOF].all()


def test_names_of_files(made, tmp_path, monkeypatch):
    path = made(boxes(0.0), "")
    with pytest.raises(InvalidInput, match=r"write it after the name, such as made\.json#crs=EPSG:7415"):
        open_buildings(path, Ground())
    assert isinstance(open_buildings(f"{path}#crs={UTM}", Ground()), CityBuildings)
    assert parse_city(f"{path}#crs={UTM}&lod=2.2&heights=file")[1:] == (UTM, "2.2", "file")
    for word in ("crs=", "lod", "heights=sea", "x=1", "crs=A&crs=B"):
        with pytest.raises(InvalidInput, match="behind # must be crs=CODE"):
            parse_city(f"{path}#{word}")
    monkeypatch.chdir(tmp_path)
    assert whole_building_path(f"made.json#crs={UTM}") == f"{tmp_path / 'made.json'}#crs={UTM}"
    hashed = tmp_path / "a#lod=x.json"
    hashed.write_text(Path(path).read_text())
    assert parse_city(str(hashed))[0] == str(hashed)


def test_footprints_stay_footprints(tmp_path):
    ring = [[9.0, 47.0], [9.001, 47.0], [9.001, 47.001], [9.0, 47.0]]
    feature = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
    path = tmp_path / "houses.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    assert parse_city(str(path)) is None
    assert isinstance(open_buildings(str(path), Ground()), FootprintBuildings)
    assert whole_building_path(str(path)) == str(path)


@pytest.mark.real_data
def test_delft_keeps_its_volumes_on_the_ground():
    path = DATA / "delft.city.json"
    if not path.exists():
        pytest.skip(f"{path} is missing")
    model = open_buildings(str(path), Ground(43.0, 0.0))
    triangles = everything(model)
    city = model.model
    assert len(set(triangles.instance.tolist())) == 163
    for number in np.unique(city.faces.instance[city.faces.feet_instance]).tolist():
        own = triangles.corners_m[triangles.instance == number]
        flat = city.points[city.faces.triangles[city.faces.instance == number]]
        middle = own.reshape(-1, 3).mean(axis=0)
        a, b, c = np.moveaxis(own - middle, 1, 0)
        roofs = triangles.kind[triangles.instance == number] == ROOF
        area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)[roofs].sum()
        a, b, c = np.moveaxis(flat - flat[0, 0], 1, 0)
        stated = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        kind = city.faces.kind[city.faces.instance == number]
        # The scale of the Dutch grid is within 1e-4 of 1.
        assert area == pytest.approx(stated[kind == ROOF].sum(), rel=3e-4)
