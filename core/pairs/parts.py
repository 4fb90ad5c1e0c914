"""Split of places into training and test without shared ground."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, Numbers
from ..errors import InvalidInput, Message
from .places import PairPlace, cartesian_m

#: Distractors are in the gallery only.
PARTS = TRAIN, TEST, DISTRACTOR = ("train", "test", "distractor")
#: University-1652's buildings: 701 for training, 701 for test, 250 distractors.
SHARES = (701.0, 701.0, 250.0)


class PlaceParts(NamedTuple):
    """Part of each place, and whether places of two parts show the same ground."""

    part: tuple[str, ...]
    ground_shared: bool


def check_shares(shares: Sequence[float]) -> None:
    """Raise InvalidInput unless shares are three numbers >= 0 with a positive sum."""
    if len(shares) != len(PARTS):
        raise InvalidInput("split {0}: give three shares, for {1}s", _text(shares), ", ".join(PARTS))
    if not all(share >= 0.0 for share in shares) or not 0.0 < sum(shares) < math.inf:
        raise InvalidInput("split {0}: shares must be 0 or more and finite, and one above 0", _text(shares))
    if shares[2] > 0.0 and shares[1] == 0.0:
        raise InvalidInput(
            "split {0}: distractors are of a test", _text(shares), remedy="give it a share, or them none"
        )


def _text(shares: Sequence[float]) -> str:
    return " ".join(f"{share:g}" for share in shares)


def part_places(
    places: Sequence[PairPlace],
    shares: Sequence[float],
    seed: int,
    reach_m: Floats,
    *,
    gap_m: float = 0.0,
    allow_shared_ground: bool = False,
) -> PlaceParts:
    """Assign places to parts.

    Places whose views share ground, directly or through others, go to the same part. Places are taken in the order of a
    hash of seed and coordinates, whatever the order of the list.

    Parameters
    ----------
    shares : three numbers
        Shares of training, test and distractors, relative to their sum.
    reach_m : array (n,)
        Distance of the farthest ground in any view of each place.
    gap_m : float
        Least distance between the ground of two parts, >= 0.
    allow_shared_ground : bool
        Assign places one by one; parts then may share ground, but no places.

    Raises
    ------
    InvalidInput
        A part with a positive share would be empty.
    """
    check_shares(shares)
    if not (math.isfinite(gap_m) and gap_m >= 0.0):
        raise InvalidInput("gap {0} m: must be 0 or more", gap_m)
    wanted = _counts(len(places), shares)
    for name, share, count in zip(PARTS[:2], shares, wanted):
        if share > 0.0 and count == 0:
            raise InvalidInput(
                "{0} places, split {1}: none is left for {2}",
                len(places),
                _text(shares),
                name,
                remedy="give more places, or other shares",
            )
    together = _neighbours(places, reach_m, gap_m)
    order = _order(places, seed)
    groups = np.arange(len(places)) if allow_shared_ground else together
    part = _filled(groups, order, wanted)
    for index, name in enumerate(PARTS):
        if wanted[index] and not (part == index).any():
            apart = "" if math.isinf(float(np.max(reach_m))) else "places farther apart, "
            nearer = "a smaller --gap, " if apart and gap_m > 0.0 else ""
            raise InvalidInput(
                "{0} places, split {1}: {2}, and none is left for {3}",
                len(places),
                _text(shares),
                _crowd(reach_m, gap_m),
                name,
                remedy=Message(
                    "give {0}views that see less (lower, less tilted), {1}or --allow-shared-ground",
                    apart,
                    nearer,
                ),
            )
    shared = any(len(set(part[together == group].tolist())) > 1 for group in np.unique(together))
    return PlaceParts(tuple(PARTS[index] for index in part.tolist()), shared)


def _crowd(reach_m: Floats, gap_m: float) -> str:
    farthest_m = float(np.max(reach_m))
    if math.isinf(farthest_m):
        return "some views see the horizon, so that all places share ground"
    return f"places nearer than {2.0 * farthest_m + gap_m:,.0f} m share ground and stay together"


def _counts(count: int, shares: Sequence[float]) -> list[int]:
    """Whole numbers in proportion to shares, by the largest remainders."""
    exact = [count * share / sum(shares) for share in shares]
    counts = [math.floor(one) for one in exact]
    by_remainder = sorted(range(len(shares)), key=lambda at: counts[at] - exact[at])
    for at in by_remainder[: count - sum(counts)]:
        counts[at] += 1
    return counts


def _order(places: Sequence[PairPlace], seed: int) -> list[int]:
    def key(index: int) -> bytes:
        text = f"{seed}:{places[index].lat_deg!r}:{places[index].lon_deg!r}"
        return hashlib.blake2b(text.encode(), digest_size=16).digest()

    return sorted(range(len(places)), key=key)


def _filled(groups: Numbers, order: list[int], wanted: list[int]) -> Numbers:
    """Index of the part of each place: groups are assigned, largest first, to the part that lacks most places."""
    members: dict[int, list[int]] = {}
    for index in order:
        members.setdefault(int(groups[index]), []).append(index)
    part = np.zeros(len(groups), np.int64)
    missing = list(wanted)
    for group in sorted(members.values(), key=len, reverse=True):
        chosen = max(range(len(missing)), key=missing.__getitem__)
        part[group] = chosen
        missing[chosen] -= len(group)
    return part


def _neighbours(places: Sequence[PairPlace], reach_m: Floats, gap_m: float) -> Numbers:
    """Group of each place: places whose views share ground, directly or through others."""
    points = cartesian_m(np.array([p.lat_deg for p in places]), np.array([p.lon_deg for p in places]))
    group = np.arange(len(places))
    # At most 4 million distances at a time, 32 MB an array.
    rows = max((1 << 22) // len(places), 1)
    for start in range(0, len(places), rows):
        block = slice(start, start + rows)
        distance = np.sqrt(sum((points[block, np.newaxis, axis] - points[:, axis]) ** 2 for axis in range(3)))
        near = distance < reach_m[block, np.newaxis] + reach_m + gap_m
        for others in near:
            met = np.unique(group[others])
            group[np.isin(group, met)] = met[0]
    return group
