"""What it costs to describe a large dataset as STAC items: seconds, memory, and the size of the table.

    python benchmarks/stac_items.py [IMAGES]    # a million unless another number is given

The dataset is that of a real plan, with table and footprints as a capture writes them, and no images: none is opened.
Reading the table and writing the items are timed in a process of their own, beside the peak of its memory.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from million import mission_of
from terrainav.core.dataset.dataset import Dataset, ImageSet
from terrainav.core.dataset.table import Table
from terrainav.core.exports.stac import ITEMS_FILE, describe
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.plan import plan


def make(folder: Path, images: int) -> None:
    """Write table, mission and footprints of a dataset."""
    mission = mission_of(images)
    made = plan(mission, PixelGrid())
    count = len(made)
    lat, lon = made.frame_centres
    left, top, width, height = (np.asarray(values, np.float64) for values in made.windows)
    poses = {
        "pose_lat_deg": made.poses.lat_deg,
        "pose_lon_deg": made.poses.lon_deg,
        **{name: getattr(made.poses, name) for name in ("agl_m", "yaw_deg", "tilt_deg", "roll_deg")},
    }
    known = {
        "img_names": tuple(f"{name}.jpg" for name in made.names),
        "columns": made.column,
        "rows": made.row,
        "lat_deg": lat,
        "lon_deg": lon,
        "zoom": np.full(count, made.zoom, np.int64),
        "entropies": np.random.default_rng(1).uniform(0.0, 8.0, count),
        **poses,
        "left_px": left,
        "top_px": top,
        "width_px": width,
        "height_px": height,
        "image_width_px": width,
        "image_height_px": height,
        "source": ("A source of imagery",) * count,
        "attribution": ("Somebody's imagery",) * count,
        "imagery_date": ("2024-06-21",) * count,
        "status": ("done",) * count,
    }
    (folder / "satellite").mkdir()
    Table.from_columns(known, {}).save(folder / "satellite" / "meta_data.csv")
    mission.save(folder / "mission.json")
    write_plan(made, folder / "footprints.geojson")
    # What tells map frames from camera frames.
    (folder / "satellite" / known["img_names"][0]).with_suffix(".jgw").touch()


def measure(folder: Path) -> dict[str, float]:
    """Read the table and write the items; figures of this process."""
    start = time.perf_counter()
    images = folder / "satellite"
    table = Table.load(images / "meta_data.csv")
    read_s, read_mb = time.perf_counter() - start, peak_mb()
    start, begun = time.perf_counter(), time.process_time()
    describe(Dataset(folder, "TerrAInav", {"satellite": ImageSet("satellite", images, table, images)}))
    return {
        "images": len(table),
        "read_s": read_s,
        "read_peak_mb": read_mb,
        "write_s": time.perf_counter() - start,
        "write_cpu_s": time.process_time() - begun,
        "peak_mb": peak_mb(),
        "items_mb": (folder / ITEMS_FILE).stat().st_size / 1e6,
        "table_mb": (images / "meta_data.csv").stat().st_size / 1e6,
        "footprints_mb": (folder / "footprints.geojson").stat().st_size / 1e6,
    }


def peak_mb() -> float:
    """Most memory that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    """Make the dataset, and measure."""
    if sys.argv[1:2] == ["--measure"]:
        print(json.dumps(measure(Path(sys.argv[2]))))
        return
    with tempfile.TemporaryDirectory(prefix="terrainav-stac-") as folder:
        make(Path(folder), int((sys.argv[1:] or ["1000000"])[0]))
        done = subprocess.run(
            [sys.executable, __file__, "--measure", folder], check=True, capture_output=True, text=True
        )
        for name, value in json.loads(done.stdout).items():
            print(f"{name:14} {value:12,.1f}")


if __name__ == "__main__":
    main()
