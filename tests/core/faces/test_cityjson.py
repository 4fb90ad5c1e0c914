"""CityJSON files made here, whole and with faults, and real ones."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from shapely.geometry import Polygon
from terrainav.core.errors import InvalidInput
from terrainav.core.faces.cityjson import is_cityjson, read_city
from terrainav.core.faces.surfaces import cut, is_closed, rim, volume_m3
from terrainav.core.geodesy.triangles import FLOOR, ROOF, WALL

DATA = Path(__file__).resolve().parents[4] / "shared" / "data" / "cityjson"
CRS = "https://www.opengis.net/def/crs/EPSG/0/7415"
#: Faces of a box by its corners: floor, roof and four walls, outward.
BOX = [[[0, 3, 2, 1]], [[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7]]]


def corners(x=0, y=0, z=0, dx=10, dy=20, dz=5):
    """Vertices of a box, in millimetres."""
    ring = [(x, y), (x + dx, y), (x + dx, y + dy), (x, y + dy)]
    return [[int(1000 * a), int(1000 * b), int(1000 * c)] for c in (z, z + dz) for a, b in ring]


def shifted(boundaries, by):
    return [shifted(one, by) for one in boundaries] if isinstance(boundaries, list) else boundaries + by


def city(objects=None, vertices=None, **more):
    """A file with one box, or other objects."""
    solid = {"type": "Solid", "lod": "1.2", "boundaries": [BOX]}
    whole = {
        "type": "CityJSON",
        "version": "2.0",
        "transform": {"scale": [0.001] * 3, "translate": [85000.0, 447000.0, 1.0]},
        "metadata": {"referenceSystem": CRS},
        "CityObjects": {"a": {"type": "Building", "geometry": [solid]}} if objects is None else objects,
        "vertices": corners() if vertices is None else vertices,
        **more,
    }
    return {name: value for name, value in whole.items() if value is not None}


@pytest.fixture
def read(tmp_path):
    def of(content, **options):
        path = tmp_path / "made.city.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return read_city(str(path), **options)

    return of


def geometry(kind="Solid", boundaries=None, lod="2", **more):
    return {"type": kind, "lod": lod, "boundaries": [BOX] if boundaries is None else boundaries, **more}


def building(*geometries, kind="Building", **more):
    return {"type": kind, "geometry": list(geometries), **more}


def volumes(model):
    """Volume of each building."""
    faces = model.faces
    numbers = np.unique(faces.instance).tolist()
    return [volume_m3(faces.triangles[faces.instance == k], model.points) for k in numbers]


def kinds(model):
    return np.bincount(model.faces.kind, minlength=4).tolist()[1:]


def test_box_is_a_closed_solid(read):
    model = read(city())
    assert volumes(model) == pytest.approx([1000.0], rel=1e-9)
    assert kinds(model) == [2, 8, 2]
    assert is_closed(model.faces.triangles)
    assert model.points.min(axis=0).tolist() == [85000.0, 447000.0, 1.0]
    assert model.faces.on_ground.sum() == 2
    assert len(model.faces.feet) == 4
    assert model.counts.surfaces == 6


def test_solid_that_faces_inward_is_turned(read):
    inward = [[[ring[::-1] for ring in one] for one in BOX]]
    model = read(city({"a": building(geometry(boundaries=inward))}))
    assert volumes(model) == pytest.approx([1000.0])
    assert kinds(model) == [2, 8, 2]
    assert model.counts.turned_shells == 1


def test_courtyard(read):
    vertices = corners() + corners(3, 5, 0, 4, 6, 5)
    walls = shifted([[ring[::-1] for ring in one] for one in BOX[2:]], 8)
    shell = [[BOX[0][0], [8, 9, 10, 11]], [BOX[1][0], [15, 14, 13, 12]], *BOX[2:], *walls]
    model = read(city({"a": building(geometry(boundaries=[shell]))}, vertices))
    assert volumes(model) == pytest.approx([5.0 * (200.0 - 24.0)])
    assert model.counts.open_shells == 0
    assert len(model.faces.feet) == 8


@pytest.mark.parametrize(
    ("kind", "boundaries", "expected"),
    [
        ("MultiSolid", [[BOX], [shifted(BOX, 8)]], 1024.0),
        ("CompositeSolid", [[BOX], [shifted(BOX, 8)]], 1024.0),
        ("MultiSurface", BOX, 1000.0),
        ("CompositeSurface", BOX, 1000.0),
    ],
)
def test_types_of_geometry(read, kind, boundaries, expected):
    vertices = corners() + corners(20, 0, 0, 2, 4, 3)
    model = read(city({"a": building(geometry(kind, boundaries))}, vertices))
    assert volumes(model) == pytest.approx([expected])
    assert set(model.faces.kind.tolist()) == {ROOF, WALL, FLOOR}


def test_cavities_and_geometries_without_surfaces_are_counted(read):
    solid = geometry(boundaries=[BOX, shifted(BOX, 8)])
    model = read(city({"a": building(solid, geometry("MultiPoint", [0, 1]))}, corners() + corners(2, 2, 1, 2, 2, 2)))
    assert volumes(model) == pytest.approx([1000.0])
    assert (model.counts.cavities, model.counts.other_geometries) == (1, 1)


def test_semantics_are_kinds(read):
    names = ["GroundSurface", "RoofSurface", "WallSurface", "Window", "OuterCeilingSurface", "InteriorWallSurface"]
    semantics = {"surfaces": [{"type": name} for name in names], "values": [[0, 1, 2, 3, 4, 5]]}
    model = read(city({"a": building(geometry(semantics=semantics))}))
    assert kinds(model) == [2, 4, 4]
    assert model.faces.on_ground.sum() == 2
    assert model.counts.inside_surfaces == 1


@pytest.mark.parametrize(
    "semantics",
    [
        {"surfaces": [{"type": "+Own"}, {}], "values": [[0, 1, None, 7, -1]]},
        {"surfaces": [{"type": "RoofSurface"}], "values": None},
        {"surfaces": "RoofSurface", "values": [[0]]},
        {"surfaces": [{"type": "RoofSurface"}], "values": 3},
        [],
    ],
)
def test_surfaces_without_known_semantics_have_the_kind_of_their_slope(read, semantics):
    model = read(city({"a": building(geometry(semantics=semantics))}))
    assert kinds(model) == [2, 8, 2]


def test_parts_have_the_number_of_their_building(read):
    vertices = corners() + corners(20, 0, 0, 2, 4, 3)
    objects = {
        "part": building(geometry(), kind="BuildingPart", parents=["house"]),
        "other": building(geometry(boundaries=[shifted(BOX, 8)])),
        "house": building(kind="Building", children=["part", "balcony"]),
        "balcony": building(geometry(boundaries=[shifted(BOX, 8)]), kind="BuildingInstallation", parents=["part"]),
        "lost": building(geometry(), kind="BuildingPart", parents=["nowhere"]),
        "road": building(geometry("MultiSurface", BOX), kind="Road"),
    }
    model = read(city(objects, vertices))
    assert volumes(model) == pytest.approx([24.0, 1024.0, 1000.0])
    assert model.counts.buildings == 3
    assert model.counts.without_parent == 1
    assert dict(model.counts.other_objects) == {"Road": 1}


def test_circles_of_parents_end(read):
    objects = {
        "a": building(geometry(), kind="BuildingPart", parents=["b"]),
        "b": building(geometry(), kind="BuildingPart", parents=["a"]),
    }
    model = read(city(objects))
    assert model.counts.buildings == 1


BY_LOD = {
    "a": building(
        geometry("MultiSurface", BOX, lod="0"),
        geometry(lod=1),
        geometry(boundaries=[shifted(BOX, 8)], lod="2.2"),
    )
}


@pytest.mark.parametrize(
    ("lod", "expected"), [("", 24.0), ("2.2", 24.0), ("3", 24.0), ("1", 1000.0), ("1.9", 1000.0), ("0", 1000.0)]
)
def test_level_of_detail(read, lod, expected):
    model = read(city(BY_LOD, corners() + corners(20, 0, 0, 2, 4, 3)), lod=lod)
    assert volumes(model) == pytest.approx([expected])


def test_building_of_parts_has_no_second_solid_of_less_detail(read):
    objects = {
        "house": building(geometry(lod="1")),
        "part": building(geometry(boundaries=[shifted(BOX, 8)], lod="2"), kind="BuildingPart", parents=["house"]),
    }
    vertices = corners() + corners(0, 0, 0, 2, 4, 3)
    assert volumes(read(city(objects, vertices))) == pytest.approx([24.0])
    assert volumes(read(city(objects, vertices), lod="1")) == pytest.approx([1000.0])


def test_footprints_are_no_faces(read):
    objects = {"a": building(geometry("MultiSurface", [BOX[0]], lod="0")), "b": building(geometry())}
    model = read(city(objects))
    assert model.counts.examples["flat_only"] == ["a"]
    assert model.faces.instance.tolist() == [2] * 12


@pytest.mark.parametrize(
    ("version", "reference"),
    [("1.0", "urn:ogc:def:crs:EPSG::7415"), ("1.1", CRS), ("2.0", CRS), ("2.0.1", CRS), ("1.0.3", CRS)],
)
def test_versions(read, version, reference):
    assert volumes(read(city(version=version, metadata={"referenceSystem": reference}))) == pytest.approx([1000.0])


def test_version_1_0_may_have_no_transform(read):
    vertices = (np.array(corners()) / 1000.0 + [85000.0, 447000.0, 1.0]).tolist()
    model = read(city(version="1.0", transform=None, vertices=vertices))
    assert volumes(model) == pytest.approx([1000.0])


def test_reference_of_two_systems(read):
    url = "https://www.opengis.net/def/crs-compound?1=https://www.opengis.net/def/crs/EPSG/0/28992"
    both = f"{url}&2=https://www.opengis.net/def/crs/EPSG/0/5709"
    assert read(city(metadata={"referenceSystem": both})).crs == "EPSG:28992+5709"


def test_sequence_of_features(read):
    head = city({}, [])
    lines = [
        {"type": "CityJSONFeature", "id": k, "CityObjects": {k: building(geometry())}, "vertices": corners(dz=height)}
        for k, height in (("a", 5), ("b", 7))
    ]
    model = read("\n".join(map(json.dumps, [head, *lines])) + "\n")
    assert volumes(model) == pytest.approx([1000.0, 1400.0])
    assert len(model.points) == 16
    with pytest.raises(InvalidInput, match=r"made\.city\.json: cannot be read: line 3: "):
        read("\n".join(map(json.dumps, [head, *lines]))[:-30])


def test_degrees_are_cut_in_metres(read):
    vertices = [[10 + x * 1e-6, 47 + y * 1e-6, z] for x, y, z in (np.array(corners()) / 1000.0).tolist()]
    wgs84 = {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/4979"}
    model = read(city(version="1.0", transform=None, vertices=vertices, metadata=wgs84))
    assert kinds(model) == [2, 8, 2]


def test_faults_of_surfaces_are_repaired_and_counted(read):
    vertices = [*corners(), corners()[6], [4000, 10000, 5200], None, [1, 2], [0, 0, 5000]]
    surfaces = [
        [[0, 3, 2, 1, 0]],
        [[4, 5, 6, 8, 7]],
        [[0, 1, 5, 4]],
        [[1, 1, 2, 6, 5]],
        [[2, 3, 7, 6], [2, 2, 2]],
        [[3, 0, 12, 7]],
        [[4, 9, 6, 7]],
        [[4, 5, 7, 6]],
        [[0, 0, 1, 1]],
        [[0, 1]],
        [[0, 1, 99]],
        [[0, 1, 10]],
        [[0, 1, "2"]],
        [[0, 1, -1]],
        [[0, 1, 2.0]],
        [],
        None,
    ]
    model = read(city({"a": building(geometry(boundaries=[surfaces]), None, {"type": "Solid", "lod": 2})}, vertices))
    counts = model.counts
    assert (counts.surfaces, counts.broken_surfaces, counts.empty_surfaces) == (8, 7, 2)
    assert (counts.cleaned_surfaces, counts.off_plane_surfaces, counts.crossing_surfaces) == (3, 1, 1)
    assert (counts.merged_vertices, counts.broken_vertices, counts.broken_objects) == (2, 2, 2)
    assert counts.open_shells == 1
    assert counts.examples["broken_surfaces"] == ["a"]


def test_open_solids_stand_on_their_walls(read):
    model = read(city({"a": building(geometry(boundaries=[BOX[1:]]))}))
    assert kinds(model) == [2, 8, 0]
    assert model.counts.open_shells == 1
    feet = model.points[model.faces.feet]
    assert len(feet) == 4
    assert (feet[..., 2] == 1.0).all()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "cannot be read: "),
        ("[1]", "object 1 is of type 'list': must be CityJSON"),
        (city(type="FeatureCollection"), "object 1 is of type 'FeatureCollection': must be CityJSON"),
        (city(version="0.9"), "CityJSON of version '0.9': must be 1.0, 1.1 or 2.0"),
        (city(version=None), "CityJSON of version 'None': must be 1.0, 1.1 or 2.0"),
        (city(version=2.0), "CityJSON of version '2.0': must be 1.0, 1.1 or 2.0"),
        (city(vertices=3), "'vertices' is missing"),
        (city(CityObjects=None), "'CityObjects' is missing"),
        (city(transform=None), "'transform' is missing, which CityJSON has since version 1.1"),
        (city(transform={"scale": [1, 1]}), "'scale' of 'transform' is [1, 1]: must be three numbers"),
        (city(transform={"scale": [1, 1, "1"]}), "'scale' of 'transform' is [1, 1, '1']: must be three numbers"),
        (city(transform={"scale": [1, 0, 1], "translate": [0, 0, 0]}), "'scale' of 'transform' is [1, 0, 1]: must not"),
        (city(metadata=None), "states no coordinate reference system; write it after the name, such as "),
        (city(metadata={"referenceSystem": "EPSG:99999"}), "coordinate reference system 'EPSG:99999': "),
        (city({}), "has no buildings with surfaces"),
        (city({"a": building()}), "has no buildings with surfaces"),
        (city(vertices=[]), "has no buildings with surfaces"),
        (city({"a": building(geometry(boundaries=7))}), "has no buildings with surfaces"),
        (city({"a": 7, "b": {"type": 3}}), "has no buildings with surfaces"),
    ],
)
def test_bad_files_get_one_line(read, content, message):
    with pytest.raises(InvalidInput) as caught:
        read(content)
    assert str(caught.value).startswith(f"made.city.json: {message}")
    assert "\n" not in str(caught.value)


def test_level_of_detail_must_be_a_number(read):
    with pytest.raises(InvalidInput, match="level of detail 'high': must be a number such as 2"):
        read(city(), lod="high")


def test_missing_files_get_one_line(tmp_path):
    with pytest.raises(InvalidInput, match=r"no\.json: cannot be read: "):
        read_city(str(tmp_path / "no.json"))


def test_cityjson_is_known_by_its_content(tmp_path):
    path = tmp_path / "data.json"
    for text, is_so in (
        (json.dumps(city()), True),
        ('\n {"vertices": "%s", "type" : "CityJSON"}' % ("x" * 5_000_000), True),
        # Cut off before its type.
        ('{"vertices": [], "CityObjects" : {"one":', True),
        ('{"type": "FeatureCollection", "features": []}', False),
        ("CityJSON", False),
        ("", False),
    ):
        path.write_text(text)
        assert is_cityjson(str(path)) is is_so
    assert not is_cityjson(str(tmp_path))


def test_polygons_in_space_are_covered_exactly():
    rng = np.random.default_rng(7)
    for _ in range(200):
        turns = np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(3, 12)))
        if np.diff(turns, append=turns[0] + 2.0 * np.pi).max() > 3.0:
            continue
        radius = rng.uniform(2.0, 9.0, len(turns))
        outer = np.stack([radius * np.cos(turns), radius * np.sin(turns)], axis=1)
        hole = 0.2 * outer[:: max(1, len(outer) // 5)][:5] if len(outer) > 4 else np.empty((0, 2))
        flat = np.concatenate([outer, hole])
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        points = flat @ axes[:2] + rng.normal(size=3) * 1000.0
        rings = [list(range(len(outer)))] + ([list(range(len(outer), len(flat)))] if len(hole) > 2 else [])
        whole = Polygon(outer, [hole] if len(hole) > 2 else [])
        if not whole.is_valid:
            continue
        found = cut(rings, points)
        sides = points[found.triangles]
        area = 0.5 * np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1).sum()
        assert area == pytest.approx(whole.area, rel=1e-9)
        assert not found.off_plane
        assert not found.crosses


def test_materials_and_textures(read, tmp_path):
    pixels = np.zeros((10, 20, 3), np.uint8)
    pixels[:, :10], pixels[:, 10:] = (200, 100, 50), (10, 20, 30)
    (tmp_path / "walls").mkdir()
    Image.fromarray(pixels).save(tmp_path / "walls" / "wall.png")
    Image.fromarray(pixels).save(tmp_path.parent / "outside.png")
    (tmp_path / "broken.jpg").write_bytes(b"\xff\xd8\xff nothing")
    names = ["walls/wall.png", "gone.jpg", "broken.jpg", "../outside.png", str(tmp_path / "walls" / "wall.png"), 7]
    appearance = {
        "materials": [{"name": "m", "diffuseColor": [1.0, 0.5, 0.0]}, {"name": "none"}],
        "textures": [{"type": "PNG", "image": name} for name in names],
        "vertices-texture": [[0.05, 0.1], [0.4, 0.1], [0.4, 0.9], [0.05, 0.9], [0.6, 0.1], [0.95, 0.5], [0.6, 0.9]],
    }
    left, right = [[0, 0, 1, 2, 3]], [[0, 4, 5, 6]]
    texture = {"t": {"values": [[[[None]], left, right, [[1, 0, 1, 2, 3]], [[2, 0, 1, 2]], [[3, 0, 1, 2]]]]}}
    material = {"t": {"values": [[1, 0, 0, 0, None, None]]}}
    model = read(city({"a": building(geometry(texture=texture, material=material))}, appearance=appearance))
    colours = model.faces.colour[::2].tolist()
    assert colours == [[-1, -1, -1], [200, 100, 50], [10, 20, 30], [255, 128, 0], [-1, -1, -1], [-1, -1, -1]]
    assert (model.counts.textures, model.counts.missing_textures) == (4, 3)
    one = read(city({"a": building(geometry(material={"t": {"value": 0}}))}, appearance=appearance))
    assert (one.faces.colour == (255, 128, 0)).all()


@pytest.mark.parametrize("appearance", [7, [], {"textures": 7}, {"textures": [7], "materials": [7]}])
def test_broken_appearances_are_plain(read, appearance):
    more = {"texture": {"t": {"values": [[[[0, 0, 1, 2]]]]}}, "material": {"t": {"value": 0}, "u": 7}}
    model = read(city({"a": building(geometry(**more))}, appearance=appearance))
    assert (model.faces.colour == -1).all()


def real(name):
    path = DATA / name
    if not path.exists():
        pytest.skip(f"{path} is missing")
    return path


def shoelace_m2(ring):
    x, y = ring[:, 0] - ring[0, 0], ring[:, 1] - ring[0, 1]
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


@pytest.mark.real_data
def test_buildings_of_delft():
    path = real("delft.city.json")
    model = read_city(str(path))
    content = json.loads(path.read_text())
    assert (model.counts.buildings, model.counts.broken_surfaces, model.counts.without_faces) == (163, 0, 0)
    vertices = np.array(content["vertices"]) * content["transform"]["scale"] + content["transform"]["translate"]
    faces, standing = model.faces, ("Building", "Bridge")
    objects = [one for one in content["CityObjects"].values() if one["type"] in standing]
    seen = 0
    for number, one in enumerate(objects, 1):
        own = faces.triangles[faces.instance == number]
        assert len(own)
        if one["type"] != "Building":
            continue
        seen += 1
        # The file's solids have no floors: what lies between roofs and the walls' level feet.
        surfaces = [vertices[rings[0]] for rings in one["geometry"][0]["boundaries"][0]]
        foot = min(ring[:, 2].min() for ring in surfaces)
        below_roofs = sum(shoelace_m2(ring) * (ring[:, 2].mean() - foot) for ring in surfaces if len(ring) == 3)
        feet = rim(own)[:, ::-1]
        assert np.ptp(model.points[feet][..., 2]) < 1e-6
        assert sorted(map(tuple, feet.tolist())) == sorted(
            map(tuple, faces.feet[faces.feet_instance == number].tolist())
        )
        height = model.points[own][..., 2]
        assert height.max() == pytest.approx(one["attributes"]["measuredHeight"], abs=1e-9)
        assert height.min() == pytest.approx(one["attributes"]["min-height-surface"], abs=1e-9)
        middle = np.append(model.points[feet[0, 0], :2], foot)
        floor = sum(np.dot(a - middle, np.cross(b - middle, [0, 0, 0])) for a, b in model.points[feet])
        a, b, c = np.moveaxis(model.points[own] - middle, 1, 0)
        volume = (a * np.cross(b, c)).sum() / 6.0 + floor
        assert volume == pytest.approx(below_roofs, rel=1e-6)
        assert volume > 0.0
    assert seen == 160
    assert set(faces.kind.tolist()) == {ROOF, WALL}


@pytest.mark.real_data
def test_buildings_of_rotterdam():
    path = real("rotterdam.city.json")
    with pytest.raises(InvalidInput, match=r"states no coordinate reference system; write it after the name, such as"):
        read_city(str(path))
    model = read_city(str(path), "EPSG:7415")
    counts = model.counts
    assert (counts.buildings, counts.textures, counts.missing_textures) == (16, 73, 72)
    assert (counts.surfaces, counts.empty_surfaces, counts.broken_surfaces) == (236, 12, 0)
    content = json.loads(path.read_text())
    vertices = np.array(content["vertices"]) * content["transform"]["scale"] + content["transform"]["translate"]
    for number, one in enumerate(content["CityObjects"].values(), 1):
        shape = one["geometry"][0]
        names = [shape["semantics"]["surfaces"][k]["type"] for k in shape["semantics"]["values"]]
        own = model.faces.instance == number
        sides = model.points[model.faces.triangles[own]]
        area = 0.5 * np.cross(sides[:, 1, :2] - sides[:, 0, :2], sides[:, 2, :2] - sides[:, 0, :2])
        for name, kind in (("RoofSurface", ROOF), ("WallSurface", WALL), ("GroundSurface", FLOOR)):
            rings = [vertices[rings[0]] for rings, its in zip(shape["boundaries"], names) if its == name]
            stated = sum(shoelace_m2(ring) for ring in rings)
            assert area[model.faces.kind[own] == kind].sum() == pytest.approx(stated, rel=1e-9, abs=1e-6)
    assert (model.faces.colour >= 0).all(axis=1).any()


def damaged(content, rng):
    """Copy of a file with one to eight values replaced by others or removed."""
    content = json.loads(json.dumps(content))
    junk = [None, -1, 0, 3.5, "x", [], {}, True, 1e308, [[]], [[[0]]], "Building", 10**30]
    for _ in range(rng.integers(1, 9)):
        at, last = content, None
        for _ in range(rng.integers(1, 9)):
            keys = list(at) if isinstance(at, dict) else list(range(len(at))) if isinstance(at, list) else []
            if not keys:
                break
            last = at, keys[rng.integers(len(keys))]
            at = at[last[1]]
        if rng.random() < 0.2:
            del last[0][last[1]]
        else:
            last[0][last[1]] = junk[rng.integers(len(junk))]
        if not content:
            break
    return content


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("seed", range(60))
def test_damaged_files_are_read_or_refused_in_one_line(read, seed):
    semantics = {"surfaces": [{"type": "RoofSurface"}, {"type": "GroundSurface"}], "values": [[1, 0, None, 5, 0, 0]]}
    more = {"texture": {"t": {"values": [[[[0, 0, 1, 2]]]]}}, "material": {"t": {"value": 0}}}
    objects = {
        "a": building(geometry(semantics=semantics, **more), geometry(lod="1")),
        "b": building(geometry("MultiSurface", BOX), kind="BuildingPart", parents=["a"]),
    }
    whole = city(objects, appearance={"textures": [{"image": "x"}], "vertices-texture": [[0, 0], [1, 0], [0, 1]]})
    content = damaged(whole, np.random.default_rng(seed))
    model = None
    with contextlib.suppress(InvalidInput):
        model = read(content)
    if model is None:
        with pytest.raises(InvalidInput, match=r"^[^\n]*\Z"):
            read(content)
    else:
        assert np.isfinite(model.points).all()
        assert len(model.faces.kind) == len(model.faces.triangles) > 0
