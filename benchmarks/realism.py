"""What the effects of a real camera cost, beside numpy and OpenCV doing the same, and how they look.

    python benchmarks/realism.py                          # milliseconds for an image of 640 x 480 px
    python benchmarks/realism.py --pictures docs/images   # also the pictures of docs/realism.md
    python benchmarks/realism.py --only sensor

Each effect has a function that prints its cost, and mostly one that writes its picture; both stand in `EFFECTS`.
"""

from __future__ import annotations

import argparse
import math
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.source import Source
from terrainav.core.mission.plan import Plan

WIDTH, HEIGHT = 640, 480


def milliseconds(run: Callable[[], object], times: int = 15) -> float:
    """Median processor time of a function, after a first run that counts for nothing."""
    run()
    taken = []
    for _ in range(times):
        start = time.process_time()
        run()
        taken.append(1000.0 * (time.process_time() - start))
    return statistics.median(taken)


def show(effect: str, ours_ms: float, others: str = "", others_ms: float = 0.0) -> None:
    """Print a line of the table of costs."""
    beside = f"{others} {others_ms:6.1f} ms, ratio {ours_ms / others_ms:.2f}" if others else ""
    print(f"{effect:44} {ours_ms:6.1f} ms   {beside}")


def light_costs() -> None:
    """Linear light, haze, vignetting, exposure, white balance and values of an image that looks to the horizon."""
    from terrainav.core.camera.air import add_haze, extinction_per_m
    from terrainav.core.camera.light import bytes_of_linear, linear_of_bytes, metered_gain, mixed, white_balance
    from terrainav.core.camera.optics import cos4_falloff, dim
    from terrainav.core.picture.scene import PictureScene
    from terrainav.core.picture.shot import make_shot

    plan, _ = planned(tilt_deg=70.0, frame="camera")
    shot = make_shot(plan, 0)
    scene = PictureScene(plan, 0, shot)
    (height, width), (right, down) = scene.range_m.shape, scene.tangents
    pixels = np.random.default_rng(1).integers(0, 256, (height, width, 3), np.uint8)
    light = linear_of_bytes(pixels)
    table = linear_of_bytes(np.arange(256, dtype=np.uint8))
    show("linear light of 8 bits", milliseconds(lambda: linear_of_bytes(pixels)), *cv(lambda: cv2.LUT(pixels, table)))

    def encode() -> np.ndarray:
        low = cv2.multiply(light, np.full(4, 12.92))
        high = cv2.subtract(cv2.multiply(cv2.pow(light, 1.0 / 2.4), np.full(4, 1.055)), np.full(4, 0.055))
        return cv2.convertScaleAbs(np.where(light <= 0.0031308, low, high), alpha=255.0)

    show("8 bits of linear light", milliseconds(lambda: bytes_of_linear(light)), *cv(encode))
    extinction, airlight = extinction_per_m(10.0), np.array([0.5, 0.55, 0.6])
    air = np.append(airlight, 0.0)
    found = milliseconds(lambda: PictureScene(plan, 0, shot).range_m)
    show("haze: range of the pixels over level ground", found)
    range_m = scene.range_m.astype(np.float32)

    def mist() -> np.ndarray:
        share = cv2.exp(range_m * np.float32(-extinction))
        shares = cv2.merge([share, share, share])
        return cv2.add(cv2.multiply(cv2.subtract(light, air), shares), air)

    show("haze", milliseconds(lambda: add_haze(light.copy(), scene.range_m, extinction, airlight)), *cv(mist))

    def falloff() -> np.ndarray:
        return light * (1.0 / (1.0 + right**2 + down**2) ** 2).astype(np.float32)[..., np.newaxis]

    ours = milliseconds(lambda: dim(light.copy(), cos4_falloff(right, down)))
    show("vignetting", ours, "numpy", milliseconds(falloff))
    show("exposure", milliseconds(lambda: light * np.float32(0.5)), *cv(lambda: cv2.multiply(light, np.full(4, 0.5))))
    show("metering", milliseconds(lambda: metered_gain(light, "average")))
    matrix = white_balance(5000.0)
    show("white balance", milliseconds(lambda: mixed(light, matrix)), *cv(lambda: cv2.transform(light, matrix)))


def cv(run: Callable[[], object]) -> tuple[str, float]:
    """Name and time of OpenCV doing the same."""
    return "OpenCV", milliseconds(run)


def planned(agl_m: float = 120.0, **values: object) -> tuple[Plan, Source]:
    """Plan of one image of the synthetic world, and the world."""
    from terrainav.core.imagery.opening import named_source
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    source = named_source("world").open()
    fov_deg = values.pop("fov_deg", 60.0)
    mission = Mission(Points(((35.1552, -89.8935, agl_m),)), agl_m, Camera(fov_deg, 4.0 / 3.0), **values)
    return plan(mission, source.grid), source


def developed(**values: object) -> tuple[Image.Image, dict[str, str]]:
    """An image of the synthetic world, and what the table states of its effects."""
    from terrainav.core.capture.runner import capture
    from terrainav.core.dataset.table import Table

    plan, source = planned(**values)
    with tempfile.TemporaryDirectory() as made:
        capture(plan, source, made)
        (path,) = Path(made).glob("satellite/*.tif")
        other = Table.load(path.parent / "meta_data.csv").other
        return Image.open(path).convert("RGB"), {name: cells[0] for name, cells in other.items()}


def light_pictures(folder: Path) -> None:
    """Images with one effect on light each, a few strengths side by side."""
    above = {"agl_m": 400.0, "image_px": 208, "frame": "camera"}
    ahead = {"agl_m": 150.0, "image_px": 208, "frame": "camera", "tilt_deg": 72.0}
    manual = {"exposure": "manual", "exposure_ms": 1.0}
    series: dict[str, tuple[list[dict[str, object]], Callable[[dict[str, str]], str]]] = {
        "exposure": (
            [
                *({**ahead, **manual, "visibility_km": 15.0, "exposure_ms": ms} for ms in (0.4, 0.8, 1.6)),
                {**ahead, "exposure": "time", "visibility_km": 15.0},
            ],
            lambda facts: (
                f"{'metered' if facts['exposure'] == 'time' else 'set'}: {float(facts['exposure_ms']):.3g} ms"
            ),
        ),
        "white-balance": (
            [{**above, **manual, "white_balance_k": kelvin} for kelvin in (3200.0, 4500.0, 6504.0, 9000.0)],
            lambda facts: f"balanced for {float(facts['white_balance_k']):,.0f} K",
        ),
        "tone": (
            [{**above, **manual, "tone": tone} for tone in ("srgb", "linear", "filmic")],
            lambda facts: f"tone {facts.get('tone', 'srgb')}",
        ),
        "vignetting": (
            [{**above, "fov_deg": 95.0, "agl_m": 220.0, "vignetting": one} for one in ("none", "cos4", "-0.8 0.2")],
            lambda facts: f"vignetting {facts.get('vignetting', 'none')}",
        ),
        "haze": (
            [ahead, *({**ahead, "visibility_km": km} for km in (20.0, 4.0, 1.0))],
            lambda facts: f"visibility {float(facts['visibility_km']):g} km" if "visibility_km" in facts else "clear",
        ),
    }
    for name, (missions, label) in series.items():
        images, facts = zip(*(developed(**values) for values in missions))
        sheet = _sheet(list(images), [label(one) for one in facts], len(images), 1)
        sheet.save(folder / f"realism-{name}.jpg", quality=78, optimize=True)


def sampled_plan(sampling: str, **values: object) -> Plan:
    """Plan of one image of the synthetic world, with a way of sampling it."""
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan
    from terrainav.core.world import WorldSource

    values = {"frame": "camera", "sampling": sampling, **values}
    return plan(Mission(Points(((35.14, -89.86, 120.0),)), 120.0, **values), WorldSource().grid)


def sampling_costs() -> None:
    """Drawing with the interpolated imagery and with means over pixels, and spreading light."""
    from functools import partial

    import numba  # noqa: F401  (as for missions of many images)
    from terrainav.core.camera.optics import diffraction_contrast, gaussian_contrast, spread_light
    from terrainav.core.picture.camera_frame import parts_of_tiles, render
    from terrainav.core.world import WorldSource

    source = WorldSource()
    for name, tilt_deg in (("straight down", 0.0), ("at a tilt of 60°", 60.0), ("at a tilt of 85°", 85.0)):
        taken, tiles = [], []
        for sampling in ("area", "zoom"):
            planned = sampled_plan(sampling, tilt_deg=tilt_deg)
            view, lon_deg = planned.views.view(0), float(planned.lon_deg[0])
            parts = parts_of_tiles(planned.grid, view.tiles(lon_deg))
            pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
            draw = partial(render, view, lon_deg, parts, pixels, "bilinear")
            taken.append(milliseconds(draw, 5))
            tiles.append(len(parts))
        show(f"sampling by area, {name} ({tiles[0]} and {tiles[1]} tiles)", taken[0], "by zoom", taken[1])
    fine = np.random.default_rng(1).integers(0, 256, (8 * HEIGHT, 8 * WIDTH, 3)).astype(np.uint8)
    turn = np.array([[1.0, 0.02, 3.0], [-0.02, 1.0, 5.0]])

    def opencvs() -> np.ndarray:
        warped = cv2.warpAffine(fine, turn, (8 * WIDTH, 8 * HEIGHT), flags=cv2.INTER_LINEAR)
        return cv2.resize(warped, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)

    show("OpenCV: 64 samples a pixel, and their mean", milliseconds(opencvs, 5))
    light = np.random.default_rng(1).uniform(0.0, 1.0, (HEIGHT, WIDTH, 3)).astype(np.float32)
    gaussian = milliseconds(lambda: spread_light(light.copy(), partial(gaussian_contrast, mtf50=0.25), None))
    deviation = float(np.sqrt(np.log(2.0 * np.sinc(0.25)) / 2.0) / (np.pi * 0.25))
    theirs = milliseconds(lambda: cv2.GaussianBlur(light, (0, 0), deviation))
    show("sharpness (MTF50 of 0.25 cycles/px)", gaussian, "OpenCV GaussianBlur", theirs)
    airy = partial(diffraction_contrast, cutoff=0.5)
    theirs = milliseconds(lambda: cv2.filter2D(light, -1, np.full((33, 33), 1.0 / 33**2, np.float32)))
    show("diffraction", milliseconds(lambda: spread_light(light.copy(), airy, None)), "OpenCV filter2D, 33 px", theirs)
    shown = np.ones((HEIGHT, WIDTH), bool)
    shown[:100] = False
    show("diffraction beside the sky", milliseconds(lambda: spread_light(light.copy(), airy, shown)))


def sampling_picture(folder: Path) -> None:
    """A zone plate from 120 m at a tilt of 85°, and far ground of the world: by zoom, by area, and with a lens."""
    from terrainav.core.camera.light import encoded
    from terrainav.core.capture.runner import capture
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan
    from terrainav.core.world import WorldSource

    from tests.core.picture.zone_plate import GRID as PLATE_GRID
    from tests.core.picture.zone_plate import LAT, LON, ZonePlate

    crops = []
    for plate, box, changes in (
        (ZonePlate(1.0 / 60.0), (0, 0, 160, 120), {"image_px": 160}),
        (ZonePlate(1.0 / 15_000.0, 2_000.0), (0, 51, 160, 120), {"image_px": 160, "tilt_deg": 85.0}),
    ):
        plans = [
            plan(Mission(Points(((LAT, LON, 120.0),)), 120.0, frame="camera", sampling=one, **changes), PLATE_GRID)
            for one in ("zoom", "area")
        ]
        drawn, exact = [plate.picture(one) for one in plans], np.nan_to_num(plate.truth(plans[0], 12, 64))
        pictures = (Image.fromarray(np.rint(255.0 * encoded(one)).astype(np.uint8)) for one in (*drawn, exact))
        crops += [one.convert("RGB").crop(box) for one in pictures]
    labels = ["by zoom", "by area", "exact means"]
    # The rows differ in height.
    sheets = [_sheet(crops[:3], labels, 3), _sheet(crops[3:], [f"tilt 85°, {one}" for one in labels], 3)]
    sheet = Image.new("RGB", (sheets[0].width, sum(one.height + 4 for one in sheets)), "white")
    sheet.paste(sheets[0])
    sheet.paste(sheets[1], (0, sheets[0].height + 4))
    sheet.convert("L").quantize(24).save(folder / "realism-zone-plate.png", optimize=True)
    crops = []
    for values in ({"sampling": "zoom"}, {"sampling": "area"}, {"sampling": "area", "mtf50": 0.2}):
        with tempfile.TemporaryDirectory() as made:
            capture(sampled_plan(values.pop("sampling"), tilt_deg=80.0, **values), WorldSource(), made)
            (path,) = Path(made).glob("satellite/*.tif")
            crops.append(Image.open(path).convert("RGB").crop((230, 158, 430, 278)))
    labels = ["by zoom", "by area", "by area, MTF50 of 0.2 cycles/px"]
    _sheet(crops, labels, 3).save(folder / "realism-sampling.jpg", quality=72, optimize=True)


def sensor_costs() -> None:
    """Reading out and demosaicing, of a daylight image of the sensor with every kind of noise."""
    from terrainav.core.camera.bayer import BILINEAR, MALVAR, demosaiced, mosaic
    from terrainav.core.camera.sensor import Detector, read_out

    detector = Detector(3.45, 0.64, 10_400.0, 2.1, 5.0, 1.0, 0.007, 0.39, 0.0, 12)
    bits = np.random.default_rng(1)
    colours = (bits.uniform(0.02, 1.0, (HEIGHT, WIDTH, 3)) * detector.saturation_lx_s).astype(np.float32)
    response = 1.0 + 0.007 * bits.standard_normal((HEIGHT, WIDTH, 3))
    offset = bits.standard_normal((HEIGHT, WIDTH, 3))

    def numpys(exposure: np.ndarray) -> np.ndarray:
        shape = exposure.shape
        some = (slice(None), slice(None), 0) if exposure.ndim == 2 else ()
        mean = exposure * detector.electrons_per_lx_s * response[some] + 5.0 * 0.004
        electrons = np.minimum(bits.poisson(mean), detector.full_well_e) + bits.normal(0.0, 2.1, shape) + offset[some]
        return np.clip(np.rint(electrons * 0.39), 0, 4095).astype(np.uint16)

    measured = mosaic(colours, "rggb")
    for name, exposure in (("Bayer pattern", measured), ("three colours", colours)):
        ours = milliseconds(lambda exposure=exposure: read_out(detector, exposure, 0.004, 1, "image"))
        show(f"sensor, {name}", ours, "numpy", milliseconds(lambda exposure=exposure: numpys(exposure)))
    dark = colours * np.float32(1e-3)
    show("sensor, three colours in the dark", milliseconds(lambda: read_out(detector, dark, 0.004, 1, "image")))
    whole = np.rint(measured * (4095.0 / measured.max())).astype(np.uint16)
    theirs = milliseconds(lambda: cv2.cvtColor(whole, cv2.COLOR_BayerBG2RGB))
    show("demosaicing, bilinear", milliseconds(lambda: demosaiced(measured, "rggb", BILINEAR)), "OpenCV", theirs)
    theirs = milliseconds(lambda: cv2.cvtColor(whole, cv2.COLOR_BayerBG2RGB_EA))
    ours = milliseconds(lambda: demosaiced(measured, "rggb", MALVAR))
    show("demosaicing, malvar", ours, "OpenCV edge-aware", theirs)


def sensor_picture(folder: Path) -> None:
    """Crops of one image with shorter exposures at higher speeds, without and with a Bayer pattern."""
    from terrainav.core.capture.runner import capture
    from terrainav.core.imagery.opening import named_source
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    source, crops = named_source("world").open(), []
    for bayer in ("none", "rggb"):
        for iso in SPEEDS:
            mission = Mission(
                Points(((35.1552, -89.8935, 400.0),)),
                400.0,
                Camera(60.0, 4.0 / 3.0),
                frame="camera",
                image_sensor="Alvium 1800 C-507m",
                bayer=bayer,
                exposure="manual",
                exposure_ms=150.0 / iso,
                iso=iso,
            )
            with tempfile.TemporaryDirectory() as made:
                capture(plan(mission, source.grid), source, made)
                (path,) = Path(made).glob("satellite/*.tif")
                crops.append(Image.open(path).convert("RGB").crop(CROP))
    labels = [f"{more}ISO {iso:,}, {150.0 / iso:.2g} ms" for more in ("", "Bayer, ") for iso in SPEEDS]
    _sheet(crops, labels, len(SPEEDS)).save(folder / "realism-sensor.jpg", quality=66, optimize=True)


#: Speeds of the crops of the sensor, of which each exposes for as much less time; and what they show of the image.
SPEEDS = 240, 1_900, 7_500, 30_000
CROP = 440, 110, 544, 214


def _sheet(crops: list[Image.Image], labels: list[str], columns: int, times: int = 2) -> Image.Image:
    """Crops in rows, enlarged, each below its label."""
    width, height = (times * side for side in crops[0].size)
    rows, gap, head = -(-len(crops) // columns), 4, 22
    sheet = Image.new("RGB", (columns * (width + gap) - gap, rows * (head + height + gap) - gap), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.truetype("DejaVuSans.ttf", 14)
    for number, (crop, label) in enumerate(zip(crops, labels)):
        left, top = number % columns * (width + gap), number // columns * (head + height + gap)
        pen.text((left + 2, top + 3), label, fill="black", font=font)
        sheet.paste(crop.resize((width, height), Image.Resampling.NEAREST), (left, top + head))
    return sheet


#: Fields that vary in the pictures of randomisation.
VARIED = (
    "yaw_deg=uniform(-180,180)",
    "agl_m=uniform(250,500)",
    "tilt_deg=normal(0,8)within(-25,25)",
    "exposure_ms=lognormal(1.2,0.5)",
    "white_balance_k=uniform(4500,7500)",
    "visibility_km=loguniform(1,20)",
)


def varied_costs() -> None:
    """Drawing the values of an image, and the settings of its camera."""
    from scipy import stats
    from terrainav.core.camera.varying import Variation
    from terrainav.core.geodesy.mercator import PixelGrid
    from terrainav.core.mission.areas.area import Box
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    count, known = 2_000, stats.lognorm(0.5, scale=4.0)
    variation, bits = Variation.from_text("exposure_ms=lognormal(4,0.5)"), np.random.default_rng(1)
    names = [f"{number}_0_48.137_11.575_17" for number in range(count)]
    ours = milliseconds(lambda: [variation.draw(0, name) for name in names])
    show(f"{count:,} values of one field", ours, "scipy, together", milliseconds(lambda: known.ppf(bits.random(count))))
    mission = Mission(Box(35.16, -89.90, 35.14, -89.87), 120.0, exposure="manual", exposure_ms=1.0, vary=VARIED)
    made = plan(mission, PixelGrid())
    show("settings of one image, of three fields", milliseconds(lambda: made.settings(0)))


def varied_picture(folder: Path) -> None:
    """Images of one place whose pose, light and air vary, above the same without effects on light."""
    from terrainav.core.capture.runner import capture
    from terrainav.core.dataset.dataset import read_dataset
    from terrainav.core.imagery.opening import named_source
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    source = named_source("world").open()
    mission = Mission(
        Points(((35.1552, -89.8935, 400.0),) * 4),
        400.0,
        Camera(60.0, 4.0 / 3.0),
        image_px=208,
        image_format="png",
        exposure="manual",
        exposure_ms=1.0,
        vary=VARIED,
        keep_clean=True,
    )
    with tempfile.TemporaryDirectory() as made:
        capture(plan(mission, source.grid), source, made)
        sets = read_dataset(made).image_sets
        tables = [sets[name] for name in ("satellite", "satellite_clean")]
        crops = [Image.open(one.folder / name).convert("RGB") for one in tables for name in one.table.img_names]
        stated = [sets["satellite"].table.other[name] for name in ("exposure_ms", "white_balance_k", "visibility_km")]
        stated_texts = [
            f"{float(ms):.2g} ms, {float(kelvin):,.0f} K, {float(km):.2g} km" for ms, kelvin, km in zip(*stated)
        ]
    labels = [*stated_texts, *("clean" for _ in stated_texts)]
    _sheet(crops, labels, len(stated_texts), 1).save(folder / "realism-varied.jpg", quality=75, optimize=True)


def moving(**values: object) -> Plan:
    """Plan of two points that a camera passes at 20 m/s, turning to a yaw in a second."""
    from terrainav.core.geodesy.mercator import PixelGrid
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    yaw_deg = float(values.pop("yaw_deg", 0.0))
    way_deg = 20.0 / 111_320.0 / math.cos(math.radians(35.155))
    area = Points(((35.1550, -89.8935, 80.0), (35.1550, -89.8935 + way_deg, 80.0)), (0.0, yaw_deg), times_s=(0.0, 1.0))
    camera = Camera(60.0, 4.0 / 3.0)
    return plan(Mission(area, 80.0, camera, image_px=WIDTH, frame="camera", **values), PixelGrid())


def drawn(made: Plan) -> np.ndarray:
    """Image of the first point of a plan."""
    from terrainav.core.imagery.opening import named_source
    from terrainav.core.picture.shot import draw, make_shot, picture_parts

    source, parts = named_source("world").open(), picture_parts(made, named_source("world").open(), 0)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    return draw(make_shot(made, 0), parts, pixels).pixels


def shutter_costs() -> None:
    """Drawing an image of instants and of strips, and the mean of instants in linear light."""
    from terrainav.core.camera.light import bytes_of_linear, linear_of_bytes
    from terrainav.core.picture.shot import draw, make_shot, picture_parts

    source = None
    for name, values in (
        ("an ideal image", {}),
        ("blur", {"motion_blur": True, "exposure_ms": 5.0}),
        ("blur", {"motion_blur": True, "exposure_ms": 20.0}),
        ("rolling shutter", {"row_time_us": 20.0}),
        ("rolling shutter", {"row_time_us": 60.0}),
        ("both", {"motion_blur": True, "exposure_ms": 5.0, "row_time_us": 20.0}),
    ):
        made = moving(**values)
        parts = picture_parts(made, source, 0)
        blank = np.zeros((made.grid.tile_px, made.grid.tile_px, 3), np.uint8)
        pixels = {part.window: blank for part in parts}
        shot = make_shot(made, 0)
        instants, strips = len(shot.instants), len(shot.middle)
        ours = milliseconds(lambda made=made, parts=parts, pixels=pixels: draw(make_shot(made, 0), parts, pixels))
        show(f"{name}: {instants} instants, {strips} strips", ours)
    images = np.random.default_rng(1).integers(0, 256, (9, HEIGHT, WIDTH, 3), np.uint8)
    table = linear_of_bytes(np.arange(256, dtype=np.uint8))

    def mean() -> np.ndarray:
        total = np.zeros(images.shape[1:], np.float32)
        for image in images:
            total += linear_of_bytes(image)
        return bytes_of_linear(total / np.float32(len(images)))

    def opencvs() -> np.ndarray:
        total = np.zeros(images.shape[1:], np.float32)
        for image in images:
            cv2.accumulate(cv2.LUT(image, table), total)
        total /= len(images)
        return np.rint(255.0 * np.where(total <= 0.0031308, total * 12.92, 1.055 * total ** (1 / 2.4) - 0.055))

    show("mean of 9 images in linear light", milliseconds(mean), "OpenCV", milliseconds(opencvs))


def shutter_picture(folder: Path) -> None:
    """Crops of one image: at rest, blurred, by a rolling shutter, and by one that turns."""
    images = {
        "global shutter, at rest": moving(),
        "20 m/s, 60 ms": moving(motion_blur=True, exposure_ms=60.0),
        "20 m/s, 200 µs a row": moving(row_time_us=200.0),
        "turning by 60°/s": moving(row_time_us=200.0, yaw_deg=60.0),
    }
    crops = [Image.fromarray(drawn(made)).resize((304, 228)) for made in images.values()]
    _sheet(crops, list(images), len(crops), 1).save(folder / "realism-shutter.jpg", quality=72, optimize=True)


def level_lens_costs() -> None:
    """Images of level ground through lenses, beside an ideal camera and OpenCV finding the rays of the pixels."""
    from terrainav.core.picture.shot import draw, make_shot, picture_parts

    def image(camera: Camera) -> Callable[[], object]:
        made, source = _above(camera, 640)
        parts = picture_parts(made, source, 0)
        pixels = {part.window: source.fetch("satellite", part.window) for part in parts}

        def drawn() -> object:
            # Views are kept for the images of a row: this one is made anew.
            made.views.__dict__.pop("_kept_views", None)
            return draw(make_shot(made, 0), parts, pixels)

        return drawn

    ideal_ms = milliseconds(image(Camera(60.0, 4.0 / 3.0)))
    for name, camera in LEVEL_LENSES.items():
        show(f"lens over level ground, {name}", milliseconds(image(camera)), "ideal", ideal_ms)
    camera = LEVEL_LENSES["k1 = -0.3"]
    x, y = np.meshgrid((np.arange(WIDTH) * 2.0 + 1.0) / WIDTH - 1.0, 1.0 - (np.arange(HEIGHT) * 2.0 + 1.0) / HEIGHT)
    points, (half, _) = np.stack([x, y], axis=-1), camera.half_tangents
    matrix, factors = np.array([[320 / half, 0, 320], [0, 320 / half, 240], [0, 0, 1]]), np.array([-0.3, 0, 0, 0, 0])
    grid = np.mgrid[:HEIGHT, :WIDTH][::-1].reshape(2, -1).T.astype(np.float64)[:, np.newaxis] + 0.5
    exact = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 60, 1e-12)
    theirs = milliseconds(lambda: cv2.undistortPointsIter(grid, matrix, factors, None, None, exact))
    show("  rays of the pixels, once for a camera", milliseconds(lambda: camera.ideal_xy(points)), "OpenCV", theirs)


def level_lens_picture(folder: Path) -> None:
    """Level ground, ideal and through lenses, and a corner of an image whose red and blue are of another size."""
    from terrainav.core.picture.shot import draw, make_shot, picture_parts

    crops = []
    for camera in (Camera(60.0, 4.0 / 3.0), *LEVEL_LENSES.values()):
        made, source = _above(camera, 208)
        parts = picture_parts(made, source, 0)
        pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
        crops.append(Image.fromarray(draw(make_shot(made, 0), parts, pixels).pixels[..., :3]))
    crops[-1] = crops[-1].crop((0, 0, 52, 39)).resize(crops[0].size, Image.Resampling.NEAREST)
    _sheet(crops, ["ideal, 60°", *LEVEL_LENSES], len(crops), 1).save(
        folder / "realism-lens.jpg", quality=80, optimize=True
    )


def undistorted_costs() -> None:
    """Drawing the undistorted twin of an image of level ground, beside OpenCV's bending of the image."""
    from terrainav.core.picture.shot import Shot, draw

    for name in UNDISTORTED:
        made, pixels = _seen_above(LEVEL_LENSES[name], 640)

        def drawn(of: Plan = made.undistorted, pixels: dict = pixels) -> object:
            of.views.__dict__.pop("_kept_views", None)
            return draw(Shot(of, 0), *pixels)

        image = draw(Shot(made, 0), *pixels).pixels
        show(f"undistorted twin, {name}", milliseconds(drawn), *cv(lambda image=image, made=made: _bent(image, made)))


def undistorted_picture(folder: Path) -> None:
    """Images of lenses, bent by OpenCV, and their undistorted twins."""
    from terrainav.core.picture.shot import Shot, draw

    crops = []
    for name in UNDISTORTED:
        made, pixels = _seen_above(LEVEL_LENSES[name], 248)
        seen, twin = (draw(Shot(one, 0), *pixels).pixels[..., :3] for one in (made, made.undistorted))
        crops += [Image.fromarray(one) for one in (seen, _bent(seen, made), twin)]
    labels = ["image", "resampled by OpenCV", "undistorted twin"]
    _sheet(crops, labels, 3, 1).save(folder / "realism-undistorted.jpg", quality=72, optimize=True)


def _seen_above(camera: Camera, image_px: int) -> tuple[Plan, tuple[list, dict]]:
    """Plan of one image of level ground with an undistorted twin, and the parts and pixels of both."""
    from terrainav.core.mission.plan import plan
    from terrainav.core.picture.shot import picture_parts

    alone, source = _above(camera, image_px)
    made = plan(alone.mission.replace(keep_undistorted=True), source.grid)
    parts = picture_parts(made, source, 0)
    return made, (parts, {part.window: source.fetch("satellite", part.window) for part in parts})


def _bent(image: np.ndarray, made: Plan) -> np.ndarray:
    """Undistort an image by OpenCV, with the camera matrix of its twin."""
    camera, (height, width) = made.mission.camera, image.shape[:2]
    focal = width / 2.0 / camera.half_tangents[0]
    matrix = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    if camera.lens == "fisheye":
        return cv2.fisheye.undistortImage(image, matrix, np.zeros(4), Knew=matrix)
    return cv2.undistort(image, matrix, np.array([camera.k1, 0.0, 0.0, 0.0]))


def _above(camera: Camera, image_px: int) -> tuple[Plan, Source]:
    """Plan of one image of level ground, and its source."""
    from terrainav.core.imagery.opening import open_source
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    source = open_source("world")
    mission = Mission(
        Points(((35.1408, -89.8606, 250.0),)), 250.0, camera, frame="camera", upsample=True, image_px=image_px
    )
    return plan(mission, source.grid), source


def lens_costs() -> None:
    """Tracing an image over relief with houses through lenses, beside ideal cameras and OpenCV's maps of a lens."""
    for name, (camera, ideal) in LENSES.items():
        views, ideals = (_town(one, 640)[0].views for one in (camera, ideal))
        ours = milliseconds(lambda views=views: views.view(0))
        show(f"lens over relief, {name}", ours, "ideal", milliseconds(lambda ideals=ideals: ideals.view(0)))
    matrix, factors = np.array([[690.0, 0, 320], [0, 690.0, 240], [0, 0, 1]]), np.array([-0.3, 0, 0, 0, 0])
    grid = np.mgrid[:HEIGHT, :WIDTH][::-1].reshape(2, -1).T.astype(np.float32)
    points = cv2.undistortPoints(grid[:, np.newaxis], matrix, factors, P=matrix).reshape(HEIGHT, WIDTH, 2)
    image, (x, y) = np.zeros((HEIGHT, WIDTH, 3), np.uint8), np.moveaxis(points, 2, 0).copy()
    show("  OpenCV bending an ideal image, by its maps", milliseconds(lambda: cv2.remap(image, x, y, cv2.INTER_LINEAR)))


def lens_picture(folder: Path) -> None:
    """A town of the embedded world, ideal and through two lenses."""
    from terrainav.core.picture.shot import draw, make_shot, picture_parts

    cameras = {"ideal, 79°": Camera(78.8, 4.0 / 3.0), **{name: camera for name, (camera, _) in LENSES.items()}}
    crops = []
    for camera in cameras.values():
        made, source = _town(camera, 280)
        parts = picture_parts(made, source, 0)
        pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
        crops.append(Image.fromarray(draw(make_shot(made, 0), parts, pixels).pixels[..., :3]))
    _sheet(crops, list(cameras), len(crops), 1).save(folder / "realism-lens-town.jpg", quality=80, optimize=True)


def _town(camera: Camera, image_px: int) -> tuple[Plan, Source]:
    """Plan of one image of houses, and its source."""
    from terrainav.core.imagery.opening import open_source
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan
    from terrainav.core.picture.heights import mission_heights

    mission = Mission(
        Points(((35.1408, -89.8606, 60.0),)), 60.0, camera, source="world", elevation=("world",), tilt_deg=50.0,
        yaw_deg=20.0, upsample=True, image_px=image_px,
    )  # fmt: skip
    source = open_source("world")
    return plan(mission, source.grid, mission_heights(mission)), source


#: Lenses, and ideal cameras that see about as much.
LENSES = {
    "k1 = -0.3, 60°": (Camera(60.0, 4.0 / 3.0, k1=-0.3), Camera(65.0, 4.0 / 3.0)),
    "fisheye, 150°": (Camera(150.0, 4.0 / 3.0, lens="fisheye"), Camera(120.0, 4.0 / 3.0)),
}

#: Lenses over level ground.
LEVEL_LENSES = {
    "k1 = -0.3": Camera(60.0, 4.0 / 3.0, k1=-0.3),
    "k1 = 0.3": Camera(60.0, 4.0 / 3.0, k1=0.3),
    "fisheye, 150°": Camera(150.0, 4.0 / 3.0, lens="fisheye"),
    "red +0.5 %, blue -0.5 %": Camera(60.0, 4.0 / 3.0, red_scale=5e-3, blue_scale=-5e-3),
}

#: Lenses whose images are shown with undistorted twins.
UNDISTORTED = ("k1 = 0.3", "fisheye, 150°")

#: Where the sun of pictures stands, and the tilts of the camera, 120 m above the edge of a town.
SUN_SHOWN, SUN_TILTS, SUN_PLACE = ("off", "15 95", "60 180", "8 285"), (0.0, 45.0, 75.0), (35.1412, -89.8656)


def sunlight_costs() -> None:
    """Tiles of the synthetic world: 64 that adjoin, without a sun and with suns 45 and 10 degrees high."""
    from terrainav.core.geodesy.mercator import MERCATOR
    from terrainav.core.geodesy.sun import SunDirection
    from terrainav.core.world import World

    u, v = (float(at) for at in MERCATOR.forward(*(np.array(one) for one in SUN_PLACE)))
    for zoom in (12, 14, 16, 18, 19, 20):
        taken = []
        for sun in (None, SunDirection(45.0, 135.0), SunDirection(10.0, 280.0)):
            made, x, y = World(sun=sun), int(u * 2**zoom), int(v * 2**zoom)
            made.tile("satellite", zoom, x - 1, y - 1)
            start = time.process_time()
            for n in range(64):
                made.tile("satellite", zoom, x + n % 8, y + n // 8)
            taken.append((time.process_time() - start) * 1000.0 / 64.0)
        ratios = ", ".join(f"{one / taken[0]:.2f}" for one in taken[1:])
        print(
            f"tile at zoom {zoom}: without a sun {taken[0]:5.1f} ms, 45 and 10 degrees high times {ratios}", flush=True
        )


def sunlight_picture(folder: Path) -> None:
    """A town's edge without a sun, in the morning, at noon and in the evening, at three tilts."""
    from terrainav.core.capture.runner import capture
    from terrainav.core.imagery.opening import open_source
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan
    from terrainav.core.mission.sunlight import mission_sun
    from terrainav.core.picture.heights import mission_heights

    crops = []
    for tilt_deg in SUN_TILTS:
        for sun in SUN_SHOWN:
            mission = Mission(
                Points(((*SUN_PLACE, 120.0),)),
                120.0,
                tilt_deg=tilt_deg,
                sun=sun,
                elevation=("world",),
                image_px=480,
                frame="camera",
                image_format="png",
            )
            source = open_source("world", sun=mission_sun(mission))
            with tempfile.TemporaryDirectory() as made:
                capture(plan(mission, source.grid, mission_heights(mission)), source, made)
                image = Image.open(next(Path(made).rglob("*.png"))).convert("RGB")
                crops.append(image.resize((208, 156), Image.Resampling.LANCZOS))
    suns = ["no sun", *("sun {}° high at {}°".format(*sun.split()) for sun in SUN_SHOWN[1:])]
    labels = [f"tilt {tilt:g}°, {suns[0]}" if sun == suns[0] else sun for tilt in SUN_TILTS for sun in suns]
    _sheet(crops, labels, len(SUN_SHOWN), 1).save(folder / "realism-sun.jpg", quality=56, optimize=True)


def together_costs() -> None:
    """Tracing, tiles and drawing of an image over the sunlit world's relief: areas, colours apart, blur and strips."""
    from terrainav.core.imagery.opening import open_source
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan
    from terrainav.core.mission.sunlight import mission_sun
    from terrainav.core.picture.camera_frame import load_code, parts_of_tiles
    from terrainav.core.picture.heights import mission_heights
    from terrainav.core.picture.shot import draw, make_shot

    way = Points(((35.1420, -89.8670, 120.0), (35.1411, -89.8655, 120.0)))
    camera = Camera(70.0, 4.0 / 3.0, k1=-0.2, k2=0.05, red_scale=1e-3, blue_scale=-1e-3)
    mission = Mission(
        way, 120.0, camera, source="world", elevation=("world",), sun="40 120", frame="camera", sampling="area",
        yaw_deg=30.0, tilt_deg=18.0, roll_deg=4.0, airspeed_m_per_s=20.0, exposure_ms=2.0, motion_blur=True,
        row_time_us=40.0, image_px=WIDTH,
    )  # fmt: skip
    source = open_source("world", sun=mission_sun(mission))
    made = plan(mission, source.grid, mission_heights(mission))
    load_code(made)
    taken = []
    for _ in range(4):
        shot, times = make_shot(made, 0), [time.process_time()]
        parts = parts_of_tiles(made.grid, shot.trace(with_sighting=False))
        times.append(time.process_time())
        pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
        times.append(time.process_time())
        draw(shot, parts, pixels)
        taken.append(np.diff([*times, time.process_time()]))
    takes = 3 * sum(len(strips) for strips in shot.instants)
    names = f"tracing {takes} takes", f"painting {len(parts)} tiles", "drawing"
    # The first run compiles code, and finds houses.
    for name, seconds in zip(names, np.median(taken[1:], axis=0)):
        show(f"all together, {name}", 1000.0 * float(seconds))


#: Costs and picture of each effect.
EFFECTS: dict[str, tuple[Callable[[], None], Callable[[Path], None] | None]] = {
    "lens": (level_lens_costs, level_lens_picture),
    "undistorted": (undistorted_costs, undistorted_picture),
    "lens over relief": (lens_costs, lens_picture),
    "sunlight": (sunlight_costs, sunlight_picture),
    "light": (light_costs, light_pictures),
    "sampling": (sampling_costs, sampling_picture),
    "shutter": (shutter_costs, shutter_picture),
    "sensor": (sensor_costs, sensor_picture),
    "randomisation": (varied_costs, varied_picture),
    "together": (together_costs, None),
}


def main() -> None:
    """Print the costs, and write the pictures where they are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pictures", type=Path, help="folder for the pictures")
    parser.add_argument("--only", choices=EFFECTS, help="one effect")
    asked = parser.parse_args()
    cv2.setNumThreads(1)
    for name, (costs, picture) in EFFECTS.items():
        if asked.only in (None, name):
            costs()
            if picture is not None and asked.pictures is not None:
                picture(asked.pictures)


if __name__ == "__main__":
    main()
