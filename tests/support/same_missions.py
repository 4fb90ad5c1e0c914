"""Missions captured in a separate process: ``python -m tests.support.same_missions FOLDER [few|all] [SEED]``.

With a seed, results of its mathematical library are up to 4 units in the last place off.
"""

from __future__ import annotations

import contextlib
import importlib
import pkgutil
import sys
from pathlib import Path

import terrainav.core
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.world import WorldSource

from tests.support.libraries import inexact

#: Few poses, as every pixel over relief is traced.
HILLS = Points(((35.1412, -89.8656, 90.0), (35.1408, -89.8648, 70.0)))
LEANING = {"yaw_deg": 213.0, "tilt_deg": 31.0, "roll_deg": 4.0}
BOX = Box(35.1425, -89.866, 35.1405, -89.8625)
TURNED = {"yaw_deg": 33.0, "tilt_deg": 24.0, "roll_deg": -7.0}
MISSIONS = {
    "map": Mission(BOX, 120.0, overlap_along=0.25),
    "photos": Mission(BOX, 120.0, image_format="jpg", ground_height_m=81.3, max_px=320),
    "turned": Mission(BOX, 120.0, image_format="jpg", max_px=320, **TURNED),
    "grid": Mission(BOX, 150.0, image_format="png", row_azimuth_deg=127.0, max_px=320),
    "wind": Mission(BOX, 120.0, wind=Wind(8.0, 250.0, 0.2), max_px=320, resampling="lanczos"),
    "paper": Mission(BOX, 120.0, layout="paper", image_format="png", camera=Camera(70.0, 1.5)),
    "horizon": Mission(
        Points(((40.0, -90.0, 3.0e6), (-62.0, 179.99, 2.0e6))),
        3.0e6,
        image_format="png",
        max_px=320,
        frame="camera",
    ),
    "relief": Mission(HILLS, 90.0, elevation=("world",), max_px=240, **LEANING),
    "products": Mission(
        HILLS,
        70.0,
        elevation=("world",),
        image_format="jpg",
        max_px=160,
        products=("depth", "points", "normals", "facades"),
        **LEANING,
    ),
    "level_products": Mission(
        HILLS, 110.0, image_format="png", max_px=400, products=("depth", "points", "normals"), **LEANING
    ),
}
#: One mission for each kind of layout, frame and product; the others take most of the time.
FEW = tuple(name for name in MISSIONS if name not in ("relief", "horizon", "grid"))
#: Missions that are also captured in blocks.
IN_BLOCKS = ("products", "turned")


def _load_core() -> None:
    """Import all modules of the core, so that their mathematical library can be replaced."""
    for found in pkgutil.walk_packages(terrainav.core.__path__, "terrainav.core."):
        # Loaders need packages that are not always installed.
        if not any(part in found.name for part in ("_loader", "__main__")):
            with contextlib.suppress(ImportError):
                importlib.import_module(found.name)


def main() -> None:
    """Capture the missions."""
    folder, which, *seed = sys.argv[1:]
    _load_core()
    source = WorldSource()
    with inexact(int(seed[0]), but="terrainav.core.imagery") if seed else contextlib.nullcontext():
        for name in FEW if which == "few" else MISSIONS:
            mission = MISSIONS[name]
            worked_out = plan(mission, source.grid, mission_heights(mission))
            capture(worked_out, source, Path(folder) / name)
            if name in IN_BLOCKS:
                blocks = Path(folder) / f"{name}_in_blocks"
                capture(worked_out, named_source("world"), blocks, blocks=Blocks(images=2))


if __name__ == "__main__":
    main()
