"""Solids with roofs: closed, with volumes and corners by hand."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.faces.roofs import SHAPES, Roof, build, pitched_height_m, smallest_rectangle
from terrainav.core.faces.triangulation import signed_area
from terrainav.core.geodesy.triangles import ROOF

HOUSE = np.array([[0, 0], [12, 0], [12, 8], [0, 8]], float)
YARD = np.array([[4, 3], [4, 5], [8, 5], [8, 3]], float)
ELL = np.array([[0, 0], [12, 0], [12, 5], [6, 5], [6, 9], [0, 9]], float)


def turned(ring, angle=0.7):
    c, s = np.cos(angle), np.sin(angle)
    return ring @ np.array([[c, s], [-s, c]]) + [100.0, -50.0]


def check_closed(solid):
    edges = Counter((int(t[k]), int(t[(k + 1) % 3])) for t in solid.triangles for k in range(3))
    assert set(edges.values()) == {1}
    assert all(edge[::-1] in edges for edge in edges)


def heights_at(solid, place):
    found = solid.points_m[(np.abs(solid.points_m[:, :2] - place) < 1e-9).all(axis=1), 2]
    return sorted({round(float(z), 9) for z in found})


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("rings", [[HOUSE], [HOUSE, YARD], [ELL], [turned(ELL)]], ids=["house", "yard", "L", "turned"])
def test_solids_are_closed(shape, rings):
    solid, _ = build(rings, 2.0, 10.0, Roof(shape, 3.0))
    check_closed(solid)
    area = sum(signed_area(ring) for ring in rings)
    assert 5 * area - 1e-6 <= solid.volume_m3 <= 8 * area + 1e-6


@given(st.lists(st.floats(2.0, 10.0), min_size=3, max_size=30), st.sampled_from(SHAPES), st.floats(0.0, 360.0))
def test_solids_of_stars_are_closed(radii, shape, direction):
    angle = np.arange(len(radii)) * 2 * np.pi / len(radii)
    ring = np.array(radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], -1)
    solid, _ = build([ring], 0.0, 9.0, Roof(shape, 4.0, direction))
    check_closed(solid)
    assert solid.points_m[:, 2].min() == 0.0
    assert solid.points_m[:, 2].max() <= 9.0 + 1e-9


@pytest.mark.parametrize(
    ("shape", "volume_m3"),
    [
        ("flat", 96 * 10.0),
        ("skillion", 96 * 6.0 + 96 * 4.0 / 2),
        ("gabled", 96 * 6.0 + 96 * 4.0 / 2),
        # A wedge of the ridge's 4 m and half a pyramid at either end.
        ("hipped", 96 * 6.0 + 4 * 8 * 4.0 / 2 + 8 * 8 * 4.0 / 3),
        ("pyramidal", 96 * 6.0 + 96 * 4.0 / 3),
    ],
)
def test_volumes(shape, volume_m3):
    for ring in (HOUSE, turned(HOUSE)):
        solid, asked = build([ring], 0.0, 10.0, Roof(shape, 4.0))
        assert asked
        assert solid.volume_m3 == pytest.approx(volume_m3, rel=1e-9)


def test_volume_with_a_yard():
    solid, _ = build([HOUSE, YARD], 1.5, 10.0, Roof())
    assert solid.volume_m3 == pytest.approx((96 - 8) * 8.5, rel=1e-9)


def test_corners_of_gabled_roofs():
    solid, _ = build([HOUSE], 0.0, 10.0, Roof("gabled", 4.0))
    assert heights_at(solid, (0, 4)) == heights_at(solid, (12, 4)) == [0.0, 10.0]
    assert heights_at(solid, (0, 0)) == [0.0, 6.0]
    solid, _ = build([HOUSE], 0.0, 10.0, Roof("gabled", 4.0, across=True))
    assert heights_at(solid, (6, 0)) == heights_at(solid, (6, 8)) == [0.0, 10.0]
    solid, _ = build([HOUSE], 0.0, 10.0, Roof("gabled", 4.0, direction_deg=90.0))
    assert heights_at(solid, (6, 0)) == [0.0, 10.0]


def test_corners_of_other_roofs():
    solid, _ = build([HOUSE], 0.0, 10.0, Roof("skillion", 4.0, direction_deg=180.0))
    assert heights_at(solid, (0, 0)) == [0.0, 6.0]
    assert heights_at(solid, (12, 8)) == [0.0, 10.0]
    solid, _ = build([HOUSE], 0.0, 10.0, Roof("hipped", 4.0))
    assert heights_at(solid, (4, 4)) == heights_at(solid, (8, 4)) == [0.0, 10.0]
    assert heights_at(solid, (0, 0)) == [0.0, 6.0]
    roofs = solid.points_m[solid.triangles[solid.kind == ROOF]]
    normals = np.cross(roofs[:, 1] - roofs[:, 0], roofs[:, 2] - roofs[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    assert len({tuple(np.round(n, 6) + 0.0) for n in normals}) == 4
    solid, _ = build([HOUSE], 0.0, 10.0, Roof("pyramidal", 4.0))
    assert heights_at(solid, (6, 4)) == [0.0, 10.0]
    solid, _ = build([HOUSE], 0.0, 10.0, Roof("dome", 4.0))
    assert heights_at(solid, (6, 4)) == [0.0, 10.0]
    # The third of six rings: sin 30° of the rise.
    c = np.cos(np.pi / 6)
    assert heights_at(solid, (6 - 6 * c, 4 - 4 * c)) == [0.0, 8.0]


def test_roofs_that_cannot_be_are_flat():
    bow = np.array([[0, 0], [10, 0], [10, 10], [9, 10], [9, 1], [0, 1]], float)
    for rings in ([bow], [HOUSE, YARD]):
        solid, asked = build(rings, 0.0, 5.0, Roof("dome", 2.0))
        assert not asked
        assert set(solid.points_m[:, 2]) == {0.0, 5.0}
    assert build([np.array([[0, 0], [1, 1], [1, 0], [0, 1]], float)], 0.0, 5.0, Roof()) == (None, False)


def test_rectangles_and_pitches():
    _, axis, longer, shorter = smallest_rectangle(turned(HOUSE))
    assert (longer, shorter) == pytest.approx((6.0, 4.0))
    assert abs(axis @ [np.cos(0.7), np.sin(0.7)]) == pytest.approx(1.0)
    assert pitched_height_m(HOUSE, "gabled", angle_deg=45.0) == pytest.approx(4.0)
    assert pitched_height_m(HOUSE, "gabled", True, 45.0) == pytest.approx(6.0)
    assert pitched_height_m(HOUSE, "skillion", angle_deg=45.0) == pytest.approx(8.0)
    assert pitched_height_m(HOUSE, "dome") == pytest.approx(4.0)
