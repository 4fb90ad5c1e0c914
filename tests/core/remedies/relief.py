"""What refusals of heights advise."""

from __future__ import annotations

from functools import partial

import numpy as np
import pyproj
import pytest
from osgeo import gdal
from terrainav.core.elevation.datum import Datum
from terrainav.core.elevation.heights import HeightOptions
from terrainav.core.elevation.layered import open_relief
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

from tests.core.elevation.test_height_tiles import surface_of, tiles
from tests.support import rasters
from tests.support.remedies import Case, remedy

UTM = (320_000.0, 2.0, 0.0, 4_298_000.0, 0.0, -2.0)
FEET = (980_000.0, 6.0, 0.0, 200_000.0, 0.0, -6.0)
#: A tower in the middle of level ground.
HEIGHTS = np.full((200, 200), 10.0)
HEIGHTS[95:105, 95:105] = 120.0


def written(case: Case, name: str, values=HEIGHTS, geotransform=UTM, crs=32618, **how):
    path = case.tmp_path / name
    rasters.write(path, values[np.newaxis], geotransform, crs, data_type=gdal.GDT_Float32, **how)
    return path


def above(east, south, agl=60.0, **values):
    """A mission of one point, by metres from the corner of the heights."""
    to_degrees = pyproj.Transformer.from_crs(32618, 4326, always_xy=True)
    lon, lat = to_degrees.transform(UTM[0] + east, UTM[3] - south)
    return Mission(Points(((lat, lon, agl),)), agl, **values)


def flown(mission):
    return plan(mission, PixelGrid(max_zoom=20, native_zoom=20), mission_heights(mission))


@remedy(
    "elevation/datum.py",
    "{}: its coordinates are in {}, and it does not say whether its heights are in metres; say which (--height-unit)",
)
def _feet_or_metres(case: Case) -> None:
    path = str(written(case, "feet.tif", geotransform=FEET, crs=2263))
    case.refused(lambda: open_relief([path]))
    case.follow("say which (--height-unit)", lambda: open_relief([path], HeightOptions(unit="us-ft")))


@remedy("elevation/datum.py", "{}: heights in {}: must be one of {}; say which (--height-unit)")
def _unknown_unit(case: Case) -> None:
    path = written(case, "fathoms.tif")
    dataset = gdal.Open(str(path), gdal.GA_Update)
    dataset.GetRasterBand(1).SetUnitType("fathom")
    dataset = None
    case.refused(lambda: open_relief([str(path)]))
    case.follow("say which (--height-unit)", lambda: open_relief([str(path)], HeightOptions(unit="m")))


@remedy(
    "elevation/datum.py",
    "heights over {}: PROJ has no way to the ellipsoid here{}; install it, for example with projsync, or take the "
    "ellipsoid and say how far heights are off it (--height-offset)",
)
def _no_grid(case: Case) -> None:
    # No PROJ has a grid for the heights of this system.
    case.refused(lambda: Datum.named("EPSG:5711"))
    # Its own command brings grids over the network.
    case.follow("install it, for example with projsync", lambda: Datum.named("EGM96"))
    options = HeightOptions("ellipsoid", offset_m=-3.0)
    path = str(written(case, "heights.tif"))
    case.follow(
        "take the ellipsoid and say how far heights are off it (--height-offset)",
        lambda: open_relief([path], options),
    )


@remedy(
    "elevation/heights.py",
    "heights {}: is a source of images; name a raster file of heights, terrarium or world, or write terrarium: or "
    "terrain-rgb: before the address of tiles whose colours are heights",
)
def _pictures(case: Case) -> None:
    address = "https://tiles.example/{z}/{x}/{y}.png"
    case.refused(lambda: open_relief([address]))
    path = str(written(case, "heights.tif"))
    case.follow("name a raster file of heights", lambda: open_relief([path]))
    for name in ("terrarium", "world"):
        case.follow(name, partial(open_relief, [name]))
    for name in ("write terrarium:", "terrain-rgb: before the address of tiles whose colours are heights"):
        word = name.replace("write ", "").split(":")[0]
        case.follow(name, partial(open_relief, [f"{word}:{address}"]))


@remedy(
    "elevation/heights.py",
    "heights {}: no such source is known; name a raster file of heights, terrarium, world or a number of metres",
)
def _unknown(case: Case) -> None:
    case.refused(lambda: open_relief(["copernicus"]))
    path = str(written(case, "heights.tif"))
    case.follow("name a raster file of heights", lambda: open_relief([path]))
    for name, what in (("terrarium", "terrarium"), ("world", "world"), ("12.5", "a number of metres")):
        case.follow(what, partial(open_relief, [name]))


@remedy(
    "elevation/heights.py",
    "heights {}: are several sources in one; write a semicolon between them in QGIS, and a space in a command "
    "(--elevation)",
)
def _several(case: Case) -> None:
    path = str(written(case, "heights.tif"))
    case.refused(lambda: open_relief([f"{path}, 10"]))
    # The panel's entry makes the same value of what stands between ;.
    case.follow("write a semicolon between them in QGIS", lambda: open_relief([path, "10"]))
    case.follow("a space in a command (--elevation)", lambda: open_relief([path, "10"]))


@remedy("imagery/xyz.py", "{}; write #tilesize={} behind its address")
def _tiles_of_512_px(case: Case) -> None:
    with tiles("terrain-rgb", 512) as address:
        case.refused(lambda: surface_of(f"{address}.png#maxzoom=12"))
        case.follow(
            "write #tilesize=512 behind its address",
            lambda: surface_of(f"{address}.png#maxzoom=12&tilesize=512"),
        )


@remedy(
    "elevation/heights.py",
    "{}: height {} m at latitude {}, longitude {}: must be from {} to {}, and not {}, which stands for no data "
    "elsewhere; say so in the file where the value stands for no data, for example with gdal_edit.py -a_nodata",
)
def _no_data(case: Case) -> None:
    holed = HEIGHTS.copy()
    holed[:20, :20] = -32768.0
    path = written(case, "holed.tif", holed)
    mission = above(300.0, 300.0, elevation=(str(path),))
    case.refused(lambda: flown(mission))
    dataset = gdal.Open(str(path), gdal.GA_Update)
    dataset.GetRasterBand(1).SetNoDataValue(-32768.0)
    dataset = None
    case.follow(
        "say so in the file where the value stands for no data, for example with gdal_edit.py -a_nodata",
        lambda: flown(mission),
    )


@remedy(
    "mission/relief/ground.py",
    "no height at latitude {}, longitude {}: the elevation ends there, or has a hole; name a further source that fills "
    "it (--elevation), or have holes interpolated (--holes)",
)
def _hole(case: Case) -> None:
    path = str(written(case, "heights.tif"))
    mission = above(-900.0, 300.0, elevation=(path,))
    case.refused(lambda: flown(mission))
    case.follow(
        "name a further source that fills it (--elevation)",
        lambda: flown(mission.replace(elevation=(path, "10"))),
    )
    holed = HEIGHTS.copy()
    holed[140:160, 140:160] = -9999.0
    mission = above(300.0, 300.0, elevation=(str(written(case, "holed.tif", holed, nodata=-9999.0)),))
    case.refused(lambda: flown(mission))
    case.follow("have holes interpolated (--holes)", lambda: flown(mission.replace(holes="interpolate")))


@remedy(
    "mission/relief/modelled.py",
    "hole in the heights at latitude {}, longitude {}: the first source has none there; take a further source that "
    "fills it (--holes)",
)
def _refused_hole(case: Case) -> None:
    path = str(written(case, "heights.tif"))
    mission = above(-900.0, 300.0, elevation=(path, "10"), holes="refuse")
    case.refused(lambda: flown(mission))
    case.follow("take a further source that fills it (--holes)", lambda: flown(mission.replace(holes="fill")))


@remedy(
    "mission/relief/modelled.py",
    "capture at latitude {}, longitude {}, {} m above the ellipsoid: the surface there rises to {} m, and {} m of "
    "clearance are to be kept; fly {} m higher, or above the ground below",
)
def _into_the_tower(case: Case) -> None:
    path = str(written(case, "heights.tif"))
    mission = above(200.0, 200.0, 60.0, elevation=(path,), height_above="ellipsoid")
    text = case.refused(lambda: flown(mission))
    higher = float(text.rpartition("fly ")[2].split(" m")[0])
    assert higher == pytest.approx(60.0, abs=1.0)
    again = above(200.0, 200.0, 60.0 + higher + 30.0, elevation=(path,), height_above="ellipsoid")
    case.follow(f"fly {higher:.0f} m higher", lambda: flown(again))
    case.follow("above the ground below", lambda: flown(mission.replace(height_above="ground")))


@remedy(
    "mission/relief/modelled.py",
    "capture at latitude {}, longitude {}, {} m above the ellipsoid: what its image may see there rises to {} m; fly "
    "higher, or keep a clearance (--clearance)",
)
def _beside_the_tower(case: Case) -> None:
    path = str(written(case, "heights.tif"))
    mission = above(170.0, 200.0, 60.0, elevation=(path,))
    case.refused(lambda: flown(mission))
    case.follow("fly higher", lambda: flown(above(170.0, 200.0, 200.0, elevation=(path,))))
    kept = mission.replace(clearance_m=20.0, clearance_distance_m=80.0)
    case.follow("keep a clearance (--clearance)", lambda: flown(kept))


@remedy(
    "mission/parts/terrain.py",
    "surface {}: needs an elevation as well, the ground that the flight follows; name it as the elevation "
    "(--elevation)",
)
def _surface_over_nothing(case: Case) -> None:
    path = str(written(case, "heights.tif"))
    case.refused(lambda: above(170.0, 200.0, 200.0, surface=(path,)))
    case.follow("name it as the elevation (--elevation)", lambda: above(170.0, 200.0, 200.0, elevation=(path,)))


@remedy(
    "mission/parts/terrain.py",
    "buildings {}: need an elevation, the ground that they stand on; name a source of heights, or give the height of "
    "level ground in metres (--elevation)",
)
def _buildings_on_nothing(case: Case) -> None:
    path = str(written(case, "heights.tif"))
    case.refused(lambda: above(170.0, 200.0, 200.0, buildings=("houses.geojson",)))
    on = partial(above, 170.0, 200.0, 200.0, buildings=("houses.geojson",))
    case.follow("name a source of heights", lambda: on(elevation=(path,)))
    case.follow("give the height of level ground in metres (--elevation)", lambda: on(elevation=("60",)))
