"""Sharing places out: by the seed, in the shares asked for, and no ground in two parts."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box
from terrainav.core.pairs.parts import SHARES, part_places
from terrainav.core.pairs.places import PairPlace, spread_places

GEOD = Geod(ellps="WGS84")
# 30 km by 27 km.
BOX = Box(35.25, -90.0, 35.0, -89.67)


def parted(places, reach=0.5, shares=SHARES, seed=2024, **options):
    return part_places(places, shares, seed, np.full(len(places), reach), **options)


def test_shares_are_those_of_university_1652():
    places = spread_places(BOX, 1652, 1.0, 3)
    parts = parted(places, reach=0.5)
    assert [parts.part.count(part) for part in ("train", "test", "distractor")] == [701, 701, 250]
    assert not parts.ground_shared


def test_the_seed_decides_and_not_the_order_of_the_list():
    places = spread_places(BOX, 60, 1.0, 3)
    part = dict(zip(places, parted(places).part))
    backwards = places[::-1]
    assert dict(zip(backwards, parted(backwards).part)) == part
    assert dict(zip(places, parted(places, seed=1).part)) != part


@pytest.mark.parametrize("gap_m", [0.0, 400.0])
def test_no_two_parts_share_ground(gap_m):
    places, reach = spread_places(BOX, 150, 0.0, 3), 350.0
    parts = parted(places, reach, gap_m=gap_m)
    distance = {
        (one, other): GEOD.inv(one.lon_deg, one.lat_deg, other.lon_deg, other.lat_deg)[2]
        for one, other in itertools.combinations(places, 2)
    }
    of = dict(zip(places, parts.part))
    apart = min(metres for (one, other), metres in distance.items() if of[one] != of[other])
    assert apart >= 2.0 * reach + gap_m
    # The places are dense enough that this was not so by chance.
    assert min(distance.values()) < 2.0 * reach
    assert not parts.ground_shared


def test_shared_ground_is_allowed_where_asked_for_and_told():
    places = [PairPlace(35.0 + 1e-4 * at, -89.0) for at in range(10)]
    with pytest.raises(InvalidInput, match=r"places nearer than 1,000 m share ground .* none is left for"):
        parted(places, 500.0)
    parts = parted(places, 500.0, allow_shared_ground=True)
    assert parts.ground_shared
    assert [parts.part.count(part) for part in ("train", "test", "distractor")] == [4, 4, 2]


def test_views_of_the_horizon_share_all_ground():
    with pytest.raises(InvalidInput, match="see the horizon"):
        parted(spread_places(BOX, 10, 1.0, 3), np.inf)


@pytest.mark.parametrize(
    ("shares", "told"),
    [
        ((1.0, -1.0, 0.0), "split 1 -1 0: shares must be 0 or more"),
        ((0.0, 0.0, 0.0), "one above"),
        ((np.inf, 1.0, 0.0), "0 or more and finite"),
        ((1e308, 1e308, 1e308), "0 or more and finite"),
        ((1.0, 0.0, 1.0), "distractors are of a test"),
        ((1.0, 1.0), "give three shares"),
        ((99.0, 1.0, 0.0), "none is left for test"),
    ],
)
def test_shares_that_cannot_be_had_are_refused(shares, told):
    with pytest.raises(InvalidInput, match=told):
        parted(spread_places(BOX, 10, 1.0, 3), shares=shares)


def test_all_places_may_be_of_one_part():
    assert set(parted([PairPlace(1.0, 2.0)], shares=(1.0, 0.0, 0.0)).part) == {"train"}
