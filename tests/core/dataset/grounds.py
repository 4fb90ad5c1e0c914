"""Small datasets whose images show given windows of the map."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from terrainav.core.dataset.table import HEADERS, Table
from terrainav.core.geodesy.frames import Windows, window_centres
from terrainav.core.geodesy.mercator import PixelGrid


def dataset_of(folder: Path, zoom: int, windows, grid=None, map_types=("satellite",), **changes) -> Path:
    """Folder of a dataset whose images p0, p1, …, empty files, show windows (left, top, width, height) in px."""
    grid = grid or PixelGrid()
    left, top, width, height = np.array(windows, np.float64).T
    lat, lon = window_centres(Windows(left, top, width, height), grid, zoom)
    count = len(windows)
    values = {
        **{name: np.full(count, np.nan) for name in HEADERS},
        **dict.fromkeys(("source", "attribution", "imagery_date", "reason"), ("",) * count),
        "img_names": tuple(f"p{index}.png" for index in range(count)),
        "columns": np.arange(count),
        "rows": np.zeros(count, np.int64),
        "lat_deg": lat,
        "lon_deg": lon,
        "zoom": np.full(count, zoom),
        "left_px": np.mod(left, grid.world_px(zoom)),
        "top_px": top,
        "width_px": width,
        "height_px": height,
        "status": ("done",) * count,
        **changes,
    }
    for map_type in map_types:
        (folder / map_type).mkdir(parents=True)
        for name in values["img_names"]:
            (folder / map_type / name).touch()
        Table(**values).save(folder / map_type / "meta_data.csv")
    return folder
