r"""What the reference program of EMVA 1288 finds in images of TerrAInav's sensor.

    python benchmarks/emva_peers.py capture flats
    .venv/peers/bin/python benchmarks/emva_peers.py analyse flats      # the environment that tools/setup.sh makes

The first command captures even rasters, white and black, with each of `SENSORS`: two images of each at 50 exposure
times up to saturation, and 32 of each at half of it. The second gives the files to ``emva1288``, the program of the
standard's committee, and compares what it finds with the figures that the sensor was given. A Bayer pattern makes the
raw values one band; all colours of the rasters are alike. Photons are computed here
from the light of the scene, by the formulas of docs/realism.md and not by those of the program.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

STEPS, STACK = 50, 32
#: Light of the scene in lux, and f-number of the lens.
ILLUMINANCE_LX, F_NUMBER = 80_000.0, 8.0
#: Sensors, with figures beside or instead of those of their data sheets.
SENSORS = {
    "imx900-low": {"image_sensor": "FRAMOS IMX900 low gain"},
    "imx900-high": {"image_sensor": "FRAMOS IMX900 high gain"},
    "alvium-c291": {
        "image_sensor": "Allied Vision Alvium 1800 C-291m",
        "dsnu_e": 6.0,
        "prnu": 0.01,
        "black_level_dn": 60.0,
    },
    "eight-bits": {
        "image_sensor": "custom",
        "pixel_um": 5.0,
        "quantum_efficiency": 0.5,
        "full_well_e": 2000.0,
        "read_noise_e": 20.0,
        "dsnu_e": 15.0,
        "prnu": 0.02,
        "black_level_dn": 16.0,
        "adc_bits": 8,
    },
}
#: Lux seconds of a white diffuser in an exposure of a millisecond.
LX_S_PER_MS = 0.65 * ILLUMINANCE_LX / math.pi / F_NUMBER**2 / 1000.0
#: Height at which images have the rasters' ground sample distance, and 640 px.
AGL_M = 173.2


def poses(number: int, count: int) -> tuple[tuple[float, float, float], ...]:
    """Places of the images of a step, of which no other step has one, as places name images and names seed noise."""
    return tuple((48.1490 + 2e-5 * at, 11.5560 + 1e-5 * number, AGL_M) for at in range(count))


#: Greatest errors in percent.
ALLOWED = {"K": 1.0, "QE": 1.0, "dark noise": 1.0, "PRNU": 1.0, "DSNU": 3.0}


def photons(pixel_um: float, exposure_ms: float) -> float:
    """Photons on a pixel: lux seconds, lumens on its area, watts at 555 nm, photons."""
    joules = LX_S_PER_MS * exposure_ms * (pixel_um * 1e-6) ** 2 / 683.0
    return joules * 555e-9 / (6.62607015e-34 * 299_792_458.0)


def capture_flats(folder: Path) -> None:
    """Capture the images of each sensor, and write a descriptor file for each."""
    import numpy as np
    from osgeo import gdal, osr
    from terrainav.core.imagery.opening import open_source

    folder.mkdir(parents=True)
    system = osr.SpatialReference()
    system.ImportFromEPSG(32632)
    for name, value in (("white", 255), ("black", 0)):
        raster = gdal.GetDriverByName("GTiff").Create(str(folder / f"{name}.tif"), 4000, 4000)
        raster.SetProjection(system.ExportToWkt())
        raster.SetGeoTransform((689_600.0, 0.25, 0.0, 5_336_500.0, 0.0, -0.25))
        raster.GetRasterBand(1).WriteArray(np.full((4000, 4000), value, np.uint8))
        raster.FlushCache()
    sources = {name: open_source(str(folder / f"{name}.tif")) for name in ("white", "black")}

    for sensor, figures in SENSORS.items():
        _capture_sensor(folder, sensor, figures, sources)


def _capture_sensor(folder: Path, sensor: str, figures: dict[str, object], sources: dict[str, object]) -> None:
    from osgeo import gdal
    from terrainav.core.capture.runner import capture
    from terrainav.core.geodesy.camera import Camera
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.parts import ImageSensor
    from terrainav.core.mission.plan import plan

    asked = ImageSensor(**figures).figures
    room_dn = 2 ** asked["adc_bits"] - 1 - asked["black_level_dn"]
    electrons = min(asked["full_well_e"], room_dn / asked["gain_dn_per_e"])
    full_ms = electrons / asked["quantum_efficiency"] / photons(asked["pixel_um"], 1.0)
    # The speed at which the gain is that of the data sheet.
    iso = 78.0 / (LX_S_PER_MS * full_ms)
    settings = {**figures, "exposure": "manual", "f_number": F_NUMBER, "illuminance_lx": ILLUMINANCE_LX, "iso": iso}

    def images(number: int, exposure_ms: float, name: str, count: int) -> list[str]:
        mission = Mission(
            Points(poses(number, count)),
            AGL_M,
            Camera(60.0, 4.0 / 3.0),
            exposure_ms=exposure_ms,
            products=("raw",),
            frame="camera",
            bayer="rggb",
            **settings,
        )
        out = Path(sensor) / f"{exposure_ms:.6f}-{name}-{count}"
        capture(plan(mission, sources[name].grid), sources[name], folder / out)
        return [one.relative_to(folder).as_posix() for one in sorted((folder / out / "raw").glob("*.tif"))]

    lines = []
    # The last steps saturate, as the program looks for the maximum of the noise.
    times = [full_ms * 1.1 * step / STEPS for step in range(1, STEPS + 1)]
    for number, (exposure_ms, count) in enumerate([*((one, 2) for one in times), (full_ms / 2.0, STACK)]):
        nanoseconds = f"{exposure_ms * 1e6:.3f}"
        for head, name in (
            (f"b {nanoseconds} {photons(asked['pixel_um'], exposure_ms):.6f}", "white"),
            (f"d {nanoseconds}", "black"),
        ):
            files = images(number, exposure_ms, name, count)
            lines += [head, *(f"i {one}" for one in files)]
    first = gdal.Open(str(folder / files[0]))
    size = first.RasterXSize, first.RasterYSize
    lines = ["v 4.0", f"n {asked['adc_bits']:.0f} {size[0]} {size[1]}", *lines, ""]
    (folder / f"{sensor}.txt").write_text("\n".join(lines))
    (folder / f"{sensor}.json").write_text(json.dumps(asked))
    print(f"{sensor}: {size[0]} x {size[1]} px, {full_ms:.4f} ms to saturation, ISO {iso:.0f}")


def analyse(folder: Path) -> bool:
    """Compare what the program finds with what the sensors were given; return whether all is within `ALLOWED`."""
    import logging

    import numpy as np

    # It is written for numpy 1, which has this name.
    np.asfarray = lambda values: np.asarray(values, float)  # noqa: NPY201
    from emva1288.process.data import Data1288
    from emva1288.process.loader import LoadImageData
    from emva1288.process.parser import ParseEmvaDescriptorFile
    from emva1288.process.results import Results1288

    logging.disable(logging.CRITICAL)
    good = True
    for sensor in SENSORS:
        asked = json.loads((folder / f"{sensor}.json").read_text())
        parsed = ParseEmvaDescriptorFile(str(folder / f"{sensor}.txt"))
        data = Data1288(LoadImageData(parsed.images).data)
        results = Results1288(data.data, pixel_area=asked["pixel_um"] ** 2)
        for name, found, given in (
            ("K", results.K, asked["gain_dn_per_e"]),
            ("QE", results.QE / 100.0, asked["quantum_efficiency"]),
            ("dark noise", results.sigma_d, asked["read_noise_e"]),
            ("PRNU", results.PRNU1288 / 100.0, asked["prnu"]),
            ("DSNU", results.DSNU1288, asked["dsnu_e"]),
        ):
            error = 100.0 * (found / given - 1.0)
            good &= abs(error) <= ALLOWED[name]
            print(f"{sensor:12} {name:10} given {given:8.4f}  found {found:8.4f}  {error:+.2f} %")
    return good


if __name__ == "__main__":
    action, flats = sys.argv[1:]
    if action == "capture":
        capture_flats(Path(flats))
    elif not analyse(Path(flats)):
        sys.exit("beyond what is allowed")
