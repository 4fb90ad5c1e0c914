"""What refusals of pairs advise."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.pairs.capturing import capture_pairs
from terrainav.core.pairs.parts import check_shares, part_places
from terrainav.core.pairs.places import PairPlace, read_box, read_places, spread_places
from terrainav.core.pairs.planning import PairSettings, places_in_box, plan_pairs
from terrainav.core.pairs.sheet import contact_sheet
from terrainav.core.pairs.views import PairView, rings, standing_poses

from tests.support.remedies import Case, remedy
from tests.support.sources import PatternSource

PLACES = tuple(PairPlace(35.0 + 0.02 * at, -89.9, f"place {at}") for at in range(2))
SETTINGS = PairSettings(views=rings((100.0,), 1, (0.0,)), size_px=32, source="pattern", shares=(1.0, 1.0, 0.0))
OTHER = replace(SETTINGS, size_px=48)
BOX = Box(35.25, -90.0, 35.0, -89.67)


def paired(folder, settings=SETTINGS, **options):
    source = PatternSource()
    return capture_pairs(plan_pairs(PLACES, settings, source.grid), source, folder, **options)


@remedy("pairs/capturing.py", "folder {}: holds {} but no {}, so it is not of these pairs; choose another folder")
def _foreign(case: Case) -> None:
    (case.tmp_path / "train").mkdir()
    case.refused(lambda: paired(case.tmp_path))
    case.follow("choose another folder", lambda: paired(case.tmp_path / "other"))


@remedy("pairs/capturing.py", "folder {}: holds pairs of other settings; choose another folder")
def _other_settings(case: Case) -> None:
    paired(case.tmp_path / "out")
    case.refused(lambda: paired(case.tmp_path / "out", OTHER))
    case.follow("choose another folder", lambda: paired(case.tmp_path / "other", OTHER))


@remedy(
    "pairs/capturing.py",
    "folder {}: already holds these pairs; resume them (--resume) or choose another folder",
)
def _already_there(case: Case) -> None:
    paired(case.tmp_path / "out")
    case.refused(lambda: paired(case.tmp_path / "out"))
    case.follow("resume them (--resume)", lambda: paired(case.tmp_path / "out", resume=True))
    case.follow("choose another folder", lambda: paired(case.tmp_path / "other"))


@remedy(
    "pairs/capturing.py",
    "image {}: is not the one that was captured ({}), and nothing is overwritten; move it away",
)
def _not_captured(case: Case) -> None:
    folder = case.tmp_path / "out"
    paired(folder)
    image = next(iter(sorted((folder / "train").rglob("*.jpg"))))
    image.unlink()
    image.write_bytes(b"somebody's own")
    case.refused(lambda: paired(folder, resume=True))

    def moved():
        image.rename(case.tmp_path / "own.jpg")
        paired(folder, resume=True)
        return image.read_bytes()[:2] == b"\xff\xd8"

    case.follow("move it away", moved)


def shared(places, shares, reach, **options):
    return part_places(places, shares, 2024, np.full(len(places), reach), **options)


@remedy("pairs/parts.py", "split {}: give three shares, for {}s")
def _three(case: Case) -> None:
    case.refused(lambda: check_shares((1.0, 1.0)))
    case.follow("give three shares, for train, test, distractors", lambda: check_shares((1.0, 1.0, 0.0)))


@remedy("pairs/parts.py", "split {}: distractors are of a test; give it a share, or them none")
def _of_a_test(case: Case) -> None:
    case.refused(lambda: check_shares((1.0, 0.0, 1.0)))
    case.follow("give it a share", lambda: check_shares((1.0, 1.0, 1.0)))
    case.follow("them none", lambda: check_shares((1.0, 0.0, 0.0)))


@remedy("pairs/parts.py", "{} places, split {}: none is left for {}; give more places, or other shares")
def _none_is_left(case: Case) -> None:
    places, shares = spread_places(BOX, 200, 1.0, 3), (99.0, 1.0, 0.0)
    case.refused(lambda: shared(places[:10], shares, 0.5))
    case.follow("give more places", lambda: shared(places, shares, 0.5))
    case.follow("other shares", lambda: shared(places[:10], (1.0, 1.0, 0.0), 0.5))


CROWDED = (
    "{} places, split {}: {}, and none is left for {}; give {}views that see less (lower, less tilted), {}or "
    "--allow-shared-ground"
)


@remedy("pairs/parts.py", CROWDED)
def _crowded(case: Case) -> None:
    shares = (1.0, 1.0, 0.0)
    near, far = ([PairPlace(35.0 + step * at, -89.0) for at in range(4)] for step in (1e-2, 1e-1))
    case.refused(lambda: shared(near, shares, 500.0, gap_m=400.0))
    case.follow("places farther apart", lambda: shared(far, shares, 500.0, gap_m=400.0))
    case.follow("give", lambda: True)
    case.follow("a smaller --gap", lambda: shared(near, shares, 500.0, gap_m=10.0))
    case.follow("--allow-shared-ground", lambda: shared(near, shares, 500.0, gap_m=400.0, allow_shared_ground=True))

    def from_above(agl, tilt):
        return plan_pairs(near, replace(SETTINGS, gap_m=400.0, views=rings((agl,), 1, (tilt,))), PixelGrid())

    case.follow("lower", lambda: from_above(100.0, 0.0))
    case.follow("less tilted", lambda: from_above(100.0, 0.0))
    for agl, tilt in ((1000.0, 0.0), (100.0, 70.0)):
        case.refused(partial(from_above, agl, tilt))
    case.follow("views that see less", lambda: from_above(100.0, 0.0))
    # What cannot help is not advised: where the horizon is seen, distance, and no gap where there is none.
    for reach, gap in ((math.inf, 400.0), (600.0, 0.0)):
        text = case.refused(lambda reach=reach, gap=gap: shared(near, shares, reach, gap_m=gap))
        assert "--gap" not in text
        assert ("farther" in text) == (reach < math.inf)


def spread(case: Case, count=40, spacing=None, box=BOX, agl=3000.0):
    return places_in_box(box, count, replace(SETTINGS, views=rings((agl,), 1, (0.0,))), spacing)


@remedy(
    "pairs/places.py",
    "{} places {} m apart: the box has room for {}; give a larger box, fewer places, {}or a smaller --spacing",
)
def _no_room(case: Case) -> None:
    larger = Box(36.5, -91.0, 35.0, -89.0)
    case.refused(lambda: spread(case, agl=6000.0))
    case.follow("give a larger box", lambda: spread(case, agl=6000.0, box=larger))
    case.follow("fewer places", lambda: spread(case, agl=6000.0, count=4))
    case.follow("views that see less", lambda: spread(case, agl=600.0))
    case.follow("a smaller --spacing", lambda: spread(case, agl=6000.0, spacing=1000.0))
    # A distance that was given is not that of the views.
    assert "views" not in case.refused(lambda: spread(case, spacing=8000.0))


FORMS = (
    "give a file of lines `lat lon` or `lat lon name` (or the paper's `lat lon agl`), or a box "
    "latTL_lonTL_latBR_lonBR "
    "with a number of places"
)


def forms(case: Case) -> None:
    """Do what is said of places: each form of a file, and a box."""
    for text in ("35 -89\n", "35 -89 north\n", "35 -89 120\n"):
        path = case.tmp_path / "right.txt"
        path.write_text(text)
        assert len(read_places(path)) == 1
    assert case.advice.startswith(FORMS[:60]), case.advice
    case.follow(case.advice, lambda: spread_places(read_box("35.25_-90_35_-89.67"), 3, 0.0, 1))


def places_of(case: Case, data: bytes):
    path = case.tmp_path / "places.txt"
    path.write_bytes(data)
    return read_places(path)


@remedy("pairs/places.py", "places {}: cannot be read as text ({}); give {}")
def _no_text(case: Case) -> None:
    case.refused(lambda: places_of(case, b"\xff\xff"))
    forms(case)


@remedy("pairs/places.py", "places {}: holds none; give {}")
def _no_places(case: Case) -> None:
    case.refused(lambda: places_of(case, b"# none\n"))
    forms(case)


@remedy("pairs/places.py", "places {}: no such file, and no box; give {}")
def _no_such_file(case: Case) -> None:
    case.refused(lambda: read_box("places.txt"))
    forms(case)


@remedy("pairs/places.py", "places {}: {} numbers; give {}")
def _numbers(case: Case) -> None:
    case.refused(lambda: read_box("1 2 3"))
    forms(case)


@remedy("pairs/places.py", "places {}, line {}: the place of line {} again; give each once")
def _again(case: Case) -> None:
    case.refused(lambda: places_of(case, b"35 -89\n35 -89\n"))
    case.follow("give each once", lambda: places_of(case, b"35 -89\n"))


@remedy(
    "pairs/planning.py",
    "some views see the horizon, so that all places share ground: give --spacing, or tilt less",
)
def _horizon(case: Case) -> None:
    tilted = replace(SETTINGS, views=rings((100.0,), 1, (80.0,)))
    case.refused(lambda: places_in_box(BOX, 3, tilted))
    case.follow("give --spacing", lambda: places_in_box(BOX, 3, tilted, 500.0))
    case.follow("tilt less", lambda: places_in_box(BOX, 3, SETTINGS))


@remedy("pairs/sheet.py", "folder {}: holds no {} that can be read; capture pairs first")
def _no_pairs(case: Case) -> None:
    folder = case.tmp_path / "out"
    case.refused(lambda: contact_sheet(folder, case.tmp_path / "sheet.jpg"))

    def first():
        paired(folder)
        contact_sheet(folder, case.tmp_path / "sheet.jpg")

    case.follow("capture pairs first", first)


@remedy(
    "pairs/views.py",
    "view from {} m at a tilt of {} deg: the camera cannot look at the place; fly lower or tilt less",
)
def _cannot_look(case: Case) -> None:
    def poses(agl, tilt):
        return standing_poses(np.array([35.0]), np.array([10.0]), PairView(agl, 0.0, tilt))

    case.refused(lambda: poses(1e6, 75.0))
    case.follow("fly lower", lambda: poses(1e3, 75.0))
    case.follow("tilt less", lambda: poses(1e6, 30.0))


@remedy("pairs/views.py", "no {}: give one or more")
def _no_views(case: Case) -> None:
    case.refused(lambda: rings((), 1, (0.0,)))
    case.follow("give one", lambda: rings((100.0,), 1, (0.0,)))
    case.follow("more", lambda: rings((100.0, 120.0), 1, (0.0, 10.0)))
