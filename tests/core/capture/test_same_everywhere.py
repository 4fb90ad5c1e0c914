"""The same missions with another processor's sines: the same image files, tables within 1e-10 degrees."""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rasterio
from PIL import Image

from tests.support.libraries import chosen_instructions

# Two environments are compared: `make test-elsewhere` does, whatever else it leaves out.
pytestmark = pytest.mark.thorough

ROOT = Path(__file__).resolve().parents[3]
IMAGES = (".tif", ".jpg", ".png")
#: What describes images one by one, beside them.
SIDECARS = (".aux.xml", ".pgw", ".jgw", "geo.txt")
#: Agreement of numbers in tables: degrees, and whatever else they hold. In wind, gusts follow the time between two
#: exposures, which is as good as the distance of their places: 1e-8 m of a hundred.
WITHIN, WITHIN_IN_WIND = 1e-10, 1e-9
#: Share of the grey values that may be others, by one: roundings of what lies between two.
RARE = 1e-5
#: Share of the files that are the same: a rare grey value, or a last digit rounded the other way, makes another one.
MOST = 0.9

#: Of products, a step of what they are rounded to, by band: metres of depth; degrees, and metres of height. Normals are
#: those of either cell where a ray meets the border of two; facades are there or not.
OFF_BY = {
    "depth": (5e-4,),
    "points": (4e-9, 4e-9, 5e-4),
    "normals": (1e-3, 1e-3, 1e-3),
    "facades": (0.0,),
}
#: Share of their values that may be others by that.
RARE_IN_PRODUCTS = 3e-4


def captured(folder: Path, *arguments: str, without: str = "") -> Path:
    environment = {**os.environ, **({"NPY_DISABLE_CPU_FEATURES": without} if without else {})}
    subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "tests.support.same_missions", str(folder), *arguments],
        cwd=ROOT,
        env=environment,
        check=True,
        timeout=600,
    )
    return folder


@pytest.fixture(scope="module", params=["few", pytest.param("all", marks=pytest.mark.thorough)])
def missions(request):
    """Which missions are captured, of `same_missions`."""
    return request.param


@pytest.fixture(scope="module")
def here(missions, tmp_path_factory):
    return captured(tmp_path_factory.mktemp("here"), missions)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(
            "narrow",
            marks=[
                pytest.mark.thorough,
                pytest.mark.skipif(
                    not chosen_instructions(), reason="numpy uses no instructions of this processor's own"
                ),
            ],
        ),
        "4 ulp",
    ],
)
def elsewhere(request, missions, tmp_path_factory):
    folder = tmp_path_factory.mktemp("elsewhere")
    if request.param == "narrow":
        return captured(folder, missions, without=" ".join(chosen_instructions()))
    return captured(folder, missions, "7")


def files(folder: Path) -> dict[str, Path]:
    return {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}


def greys(path: Path) -> np.ndarray:
    return np.asarray(Image.open(path)).astype(int)


def stored(path: Path) -> np.ndarray:
    """Values (h, w, bands) of a product."""
    with rasterio.open(path) as raster:
        return np.moveaxis(raster.read(), 0, -1)


def numbers(path: Path) -> list[float]:
    """Numbers of a table or a JSON file, in their order, but for what is worked out from grey values."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".csv":
        cells = [cell for row in csv.DictReader(text.splitlines()) for key, cell in row.items() if key != "entropies"]
    else:
        cells = list(map(str, _leaves(json.loads(text))))
    return [number for number in map(_number, cells) if number is not None]


def _leaves(value):
    if isinstance(value, dict):
        value = list(value.values())
    if not isinstance(value, list):
        return [value]
    return [leaf for one in value for leaf in _leaves(one)]


def _number(cell):
    try:
        return float(cell)
    except ValueError:
        return None


def texts(path: Path) -> list[str]:
    """What an image or a file beside it says in words and numbers, in its order."""
    if path.suffix not in IMAGES:
        return re.split(r"[\s\"<>,]+", path.read_text(encoding="utf-8"))
    with Image.open(path) as image:
        said = {**image.info, **dict(getattr(image, "tag_v2", {}))}
        # Lengths and offsets of strips follow from the pixels.
        said = {key: value for key, value in said.items() if key not in (273, 279)}
        return re.split(r"[\s\"<>,()]+", repr(sorted(said.items(), key=str)))


def is_product(name: str) -> bool:
    return any(f"/{product}/" in name for product in OFF_BY)


def test_products_are_the_same_on_other_processors_but_for_rare_last_digits(here, elsewhere):
    ours, theirs = files(here), files(elsewhere)
    names = [name for name in ours if is_product(name)]
    assert {name.split("/")[-2] for name in names} == OFF_BY.keys()
    values = differing = beyond = 0
    for name in names:
        if ours[name].read_bytes() == theirs[name].read_bytes():
            values += stored(ours[name]).size
            continue
        one, other = (stored(path[name]) for path in (ours, theirs))
        off = np.abs(one.astype(float) - other.astype(float))
        most = next(most for product, most in OFF_BY.items() if f"/{product}/" in name)
        values, differing = values + off.size, differing + int(np.count_nonzero(off > 0.0))
        beyond += int(np.count_nonzero(off[..., : len(most)] > most))
    assert values > 1e6
    assert differing <= RARE_IN_PRODUCTS * values
    # A ray that grazes an edge may meet what is behind it.
    assert beyond <= RARE * values


@pytest.mark.parametrize("mission", ["products", "turned"])
def test_blocks_leave_the_same_images_as_a_run_without(here, elsewhere, mission):
    for folder in (here, elsewhere):
        alone, blocks = files(folder / mission), files(folder / f"{mission}_in_blocks")
        images = [name for name in alone if name.endswith((*IMAGES, *SIDECARS))]
        assert images
        for name in images:
            assert alone[name].read_bytes() == blocks[name].read_bytes(), name


def test_missions_leave_the_same_images_on_other_processors(here, elsewhere, missions):
    ours, theirs = files(here), files(elsewhere)
    assert ours.keys() == theirs.keys()
    values = differing = count = same = 0
    for name in ours:
        if not name.endswith((*IMAGES, *SIDECARS)) or is_product(name):
            continue
        count += 1
        if ours[name].read_bytes() == theirs[name].read_bytes():
            same += 1
            if name.endswith(IMAGES):
                values += greys(ours[name]).size
            continue
        if name.endswith(IMAGES):
            one, other = greys(ours[name]), greys(theirs[name])
            off = np.abs(one - other)
            # A grey value before a JPEG's losses is a block of others after them.
            assert off.max() <= (4 if name.endswith(".jpg") else 1), name
            values, differing = values + off.size, differing + int(np.count_nonzero(off))
        if name.endswith(".jpg"):
            continue
        # Of two that stand on either side of a rounding, the last digit differs.
        for one, other in zip(texts(ours[name]), texts(theirs[name])):
            if one != other:
                assert float(one) == pytest.approx(float(other), rel=2e-6, abs=1.1e-9), name
    assert values > (5e6 if missions == "all" else 3e6)
    assert differing <= RARE * values
    assert same >= MOST * count, f"{count - same} of {count} files differ"


def test_tables_agree(here, elsewhere):
    ours, theirs = files(here), files(elsewhere)
    compared = 0
    for name in ours:
        if Path(name).suffix not in (".csv", ".json", ".geojson"):
            continue
        one, other = numbers(ours[name]), numbers(theirs[name])
        within = WITHIN_IN_WIND if name.startswith("wind/") else WITHIN
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=within, err_msg=name)
        compared += len(one)
    assert compared > 3000


def test_map_frames_are_the_same_to_the_last_byte(here, elsewhere):
    for mission in ("map", "photos", "paper"):
        ours, theirs = files(here / mission), files(elsewhere / mission)
        for name in ours:
            if name.endswith((*IMAGES, *SIDECARS)):
                assert ours[name].read_bytes() == theirs[name].read_bytes(), name
