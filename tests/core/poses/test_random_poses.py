"""Poses at random: where they are, that their numbers are of what was asked, and that they are the same everywhere."""

from __future__ import annotations

import hashlib
import json
import math

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.mission.areas.area import Box, Polygon, Polygons
from terrainav.core.mission.areas.coords import parse_coords
from terrainav.core.mission.pose_table import table_text
from terrainav.core.poses.random_poses import Distribution, PoseDistributions, random_poses

from tests.support.command import command

run = pytest.fixture(command, name="run")

HOW = PoseDistributions(
    Distribution("uniform", 80.0, 150.0),
    tilt=Distribution("normal", 10.0, 4.0),
    roll=Distribution("fixed", 2.5),
)
#: A star with a hole, across the antimeridian.
STAR = Polygon(
    (
        tuple(
            (180.0 + r * math.cos(a), -17.0 + r * math.sin(a))
            for a, r in zip(np.arange(10) * math.pi / 5, (0.5, 0.2) * 5)
        ),
        ((179.95, -17.05), (179.95, -16.95), (180.05, -16.95), (180.05, -17.05)),
    )
)


def columns(points):
    return np.array(points.poses).T


def test_places_are_even_by_the_ground():
    # From the equator to near the pole, where a degree of latitude has ever less ground.
    lat, lon, _ = columns(random_poses(Box(80.0, 10.0, 0.0, 50.0), 40_000, HOW, 1))
    edges = np.linspace(0.0, 80.0, 9)
    counts, _ = np.histogram(lat, edges)
    ground = np.array([float(WGS84.zone_area_m2_per_deg(np.array(a), np.array(b))) for a, b in zip(edges, edges[1:])])
    wanted = ground / ground.sum() * len(lat)
    # Five standard deviations of counts, of one seed for ever.
    assert (np.abs(counts - wanted) < 5.0 * np.sqrt(wanted)).all()
    across, _ = np.histogram(lon, np.linspace(10.0, 50.0, 9))
    assert (np.abs(across - 5000) < 5.0 * math.sqrt(5000)).all()


def test_places_are_in_the_polygon_and_not_in_its_holes():
    points = random_poses(STAR, 2000, HOW, 7)
    ogr = pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")
    shape = ogr.Geometry(ogr.wkbPolygon)
    for ring in STAR.rings:
        line = ogr.Geometry(ogr.wkbLinearRing)
        for lon, lat in (*ring, ring[0]):
            line.AddPoint_2D(lon, lat)
        shape.AddGeometry(line)
    for lat, lon, _ in points.poses:
        assert -180.0 <= lon <= 180.0
        place = ogr.Geometry(ogr.wkbPoint)
        place.AddPoint_2D(lon if lon > 0.0 else lon + 360.0, lat)
        assert shape.Contains(place)
    east = np.mean([lon < 0.0 for _, lon, _ in points.poses])
    assert 0.4 < east < 0.6


def test_places_are_in_several_polygons_as_their_ground_has_it():
    small, large = (
        Polygon((((west, 10.0), (east, 10.0), (east, 10.2), (west, 10.2)),))
        for west, east in ((179.8, 179.9), (-179.9, -179.6))
    )
    lat, lon, _ = columns(random_poses(Polygons((large, small)), 8_000, HOW, 3))
    assert ((lat >= 10.0) & (lat <= 10.2)).all()
    inside = ((lon >= 179.8) & (lon <= 179.9)), ((lon >= -179.9) & (lon <= -179.6))
    assert (inside[0] | inside[1]).all()
    # Three times the ground, within five standard deviations.
    assert abs(int(inside[1].sum()) - 6_000) < 5.0 * math.sqrt(8_000 * 0.75 * 0.25)


def test_heights_and_angles_are_of_their_distributions():
    count = 20_000
    points = random_poses(Box(1.0, 0.0, 0.0, 1.0), count, HOW, 3)
    _, _, agl = columns(points)
    assert 80.0 <= agl.min() < 80.1 < 149.9 < agl.max() <= 150.0
    tilt = np.array(points.tilts_deg)
    # Kolmogorov and Smirnov's greatest distance, which one sample in a thousand exceeds.
    wanted = np.array([0.5 + 0.5 * math.erf((x - 10.0) / 4.0 / math.sqrt(2.0)) for x in np.sort(tilt)])
    assert np.abs(wanted - np.arange(count) / count).max() < 1.95 / math.sqrt(count)
    assert np.abs((np.sort(agl) - 80.0) / 70.0 - np.arange(count) / count).max() < 1.95 / math.sqrt(count)
    assert set(points.rolls_deg) == {2.5}
    assert -180.0 <= min(points.yaws_deg) < -179.0 < 179.0 < max(points.yaws_deg) <= 180.0
    # Of a distribution that reaches below the ground, what lies there is drawn anew.
    low = random_poses(Box(1.0, 0.0, 0.0, 1.0), 1000, PoseDistributions(Distribution("normal", 5.0, 10.0)), 3)
    assert columns(low)[2].min() > 0.0


def test_a_seed_gives_the_same_poses_everywhere_and_another_one_others():
    text = table_text(random_poses(STAR, 50, HOW, 2024))
    assert text == table_text(random_poses(STAR, 50, HOW, 2024))
    assert text != table_text(random_poses(STAR, 50, HOW, 2025))
    # More poses are the same ones first; other tilts leave the rest as it was.
    more = random_poses(STAR, 80, HOW, 2024)
    assert table_text(more).startswith(text)
    other = random_poses(STAR, 50, PoseDistributions(HOW.agl, HOW.yaw, Distribution("fixed", 0.0), HOW.roll), 2024)
    assert (other.poses, other.yaws_deg) == (
        random_poses(STAR, 50, HOW, 2024).poses,
        random_poses(STAR, 50, HOW, 2024).yaws_deg,
    )
    box = random_poses(Box(35.16, -89.90, 35.115, -89.823), 3, PoseDistributions(Distribution("fixed", 120.0)), 2024)
    assert hashlib.sha256(table_text(box).encode()).hexdigest()[:16] == "936e47d92f5a9935"


def test_the_command_writes_what_missions_are_flown_from(run, tmp_path):
    said = run(
        *(
            "poses",
            "random",
            "--area",
            "35.16_-89.90_35.15_-89.89",
            "--count",
            "12",
            "--agl",
            "uniform",
            "80",
            "120",
        ),
        *("--tilt", "normal", "0", "5", "--yaw", "90", "--output", "p.csv"),
    )
    assert said.stdout == "12 poses in p.csv\n"
    points, _ = parse_coords(str(tmp_path / "p.csv"))
    assert set(points.yaws_deg) == {90.0}
    polygon = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}
    (tmp_path / "area.geojson").write_text(json.dumps(polygon))
    run("poses", "random", "--area", "area.geojson", "--count", "30", "--agl", "100", "--output", "q.csv")
    points, _ = parse_coords(str(tmp_path / "q.csv"))
    assert all(0.0 < lat < lon < 1.0 for lat, lon, _ in points.poses)
    assert json.loads(run("plan", "--coords", "p.csv", "--json").stdout)["images"] == 12


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--agl", "even", "1", "2"), "distribution 'even': must be a number, uniform or normal"),
        (("--agl", "uniform", "1"), "must be a number, uniform LOW HIGH or normal MEAN DEVIATION"),
        (("--agl", "uniform", "9", "2"), "the lower end comes first"),
        (("--agl", "normal", "9", "-2"), "the standard deviation must be 0 or more"),
        (("--agl", "nan"), "its numbers must be finite"),
        (("--agl", "0"), "agl 0: hardly any of its numbers are above 0 m"),
        (("--agl", "normal", "-90", "2"), "hardly any of its numbers are above 0 m"),
        (("--agl", "1e12"), "height above ground"),
        (("--agl", "normal", "0", "1e308"), "height above ground inf m: must be at most 1e+09"),
        (("--agl", "9", "--yaw", "normal", "0", "1e308"), "hardly any of its numbers are within 180 degrees"),
        (("--agl", "9", "--yaw", "uniform", "-1e308", "1e308"), "hardly any of its numbers are within"),
        (("--agl", "9", "--tilt", "200"), "tilt 200: hardly any of its numbers are within 180 degrees"),
        (("--agl", "9", "--count", "0"), "0 poses: must be from 1"),
        (("--agl", "9", "--seed", "-1"), "seed -1: must be 0 or more"),
        (
            ("--agl", "9", "--area", "1_0_0"),
            "area '1_0_0': no such file, and no box; give a GeoJSON, KML or KMZ file",
        ),
        (("--agl", "9", "--area", "-95_0_-96_1"), "latitude -95.0: must be within"),
    ],
)
def test_what_cannot_be_drawn_is_refused(run, options, said):
    refused = run("poses", "random", "--area", "1_0_0_1", "--count", "5", "--output", "p.csv", *options)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert said in refused.stderr


def test_narrow_polygons_have_poses_and_needles_are_refused():
    # A corridor that takes a hundredth of its box, whatever the count.
    corridor = Polygon((((0.0, 0.0), (10.0, 10.0), (10.0, 10.1), (0.0, 0.1)),))
    lat, lon, _ = columns(random_poses(corridor, 3000, HOW, 1))
    assert ((lat >= lon) & (lat <= lon + 0.1)).all()
    needle = Polygon((((0.0, 0.0), (10.0, 10.0), (10.0, 10.000000001)),))
    with pytest.raises(InvalidInput, match=r"fills hardly any of the box around it.*less narrow"):
        random_poses(needle, 5, HOW, 1)
