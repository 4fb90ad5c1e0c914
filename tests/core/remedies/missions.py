"""What refusals of a mission's parts, of its estimate and of its exports advise."""

from __future__ import annotations

import json
import shutil
import sys
from functools import partial
from typing import Any

import numpy as np
import pytest
from terrainav.core.bands import RGB
from terrainav.core.geodesy.mercator import PixelGrid, extent_of_box
from terrainav.core.mission import cameras, settings
from terrainav.core.mission.areas import coords
from terrainav.core.mission.areas import files as area_files
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.estimate import imagery_warnings, upsampling_warnings
from terrainav.core.mission.export import litchi, qgroundcontrol, wpml, write_plan
from terrainav.core.mission.export.rows import clock
from terrainav.core.mission.flight.joined import join_plans
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.pose_table import read_poses
from terrainav.core.picture.sensor import check_sensor

from tests.core.mission.wpml_reader import Wpml
from tests.core.remedies.files import extra_brings
from tests.support.remedies import Case, remedy

GRID = PixelGrid()
AREA = Box(35.16, -89.90, 35.155, -89.895)
POSES = ((35.0, 10.0, 120.0), (35.0, 10.1, 120.0))


@remedy(
    "mission/areas/area.py",
    "box from latitude {} down to {}: south lies above north; give the top-left corner first",
)
def _corners(case: Case) -> None:
    case.refused(lambda: Box(35.0, 10.0, 35.1, 10.1))
    case.follow("give the top-left corner first", lambda: Box(35.1, 10.0, 35.0, 10.1))


@remedy("mission/mission.py", "blur by motion: needs an exposure time; give one (--exposure-ms)")
def _no_exposure(case: Case) -> None:
    made = partial(Mission, AREA, 120.0, motion_blur=True)
    case.refused(made)
    case.follow("give one (--exposure-ms)", partial(made, exposure_ms=5.0))


@remedy(
    "mission/mission.py",
    "blur by motion: needs a stated exposure time, and a meter sets it; choose another exposure (--exposure)",
)
def _metered_exposure(case: Case) -> None:
    made = partial(Mission, AREA, 120.0, motion_blur=True, exposure_ms=5.0)
    case.refused(partial(made, exposure="time"))
    case.follow("choose another exposure (--exposure)", partial(made, exposure="iso"))


@remedy(
    "mission/areas/area.py",
    "time of point {}: is before that of the one before it; put the points in the order of their times",
)
def _times(case: Case) -> None:
    case.refused(lambda: Points(POSES, times_s=(20.0, 10.0)))
    case.follow("put the points in the order of their times", lambda: Points(POSES, times_s=(10.0, 20.0)))


@remedy(
    "mission/pose_table.py",
    "{}: its column pitch may count from the horizon or from straight down; name it tilt (0 looks straight down) or "
    "gimbal_pitch (-90 does)",
)
def _pitch(case: Case) -> None:
    case.refused(lambda: read_poses(["lat lon agl pitch", "35 10 120 0"]))

    def named(name, value):
        return read_poses([f"lat lon agl {name}", f"35 10 120 {value}"]).tilts_deg == (0.0,)

    case.follow("name it tilt (0 looks straight down)", lambda: named("tilt", 0))
    case.follow("gimbal_pitch (-90 does)", lambda: named("gimbal_pitch", -90))


@remedy("mission/areas/area.py", "{} {} of {} points: give one for each, or none")
def _yaws(case: Case) -> None:
    case.refused(lambda: Points(POSES, (10.0,)))
    case.follow("give one for each", lambda: Points(POSES, (10.0, 20.0)))
    case.follow("none", lambda: Points(POSES))


@remedy(
    "mission/areas/coords.py",
    "{} {} has {} numbers and the lines before {}: give every point its yaw, or none",
)
def _lines(case: Case) -> None:
    case.refused(lambda: coords.parse_points(["35 10 120", "35 10.1 120 90"]))
    case.follow("give every point its yaw", lambda: coords.parse_points(["35 10 120 0", "35 10.1 120 90"]))
    case.follow("none", lambda: coords.parse_points(["35 10 120", "35 10.1 120"]))


_POLYGON = '{"type": "Polygon", "coordinates": [[[10, 35], [10.1, 35], [10, 35.1], [10, 35]]]}'


@remedy("mission/areas/files.py", "{}: holds no polygon; give a GeoJSON, KML or KMZ file with one or more")
def _no_polygon(case: Case) -> None:
    path = case.tmp_path / "area.geojson"
    path.write_text('{"type": "Point", "coordinates": [10, 35]}')
    case.refused(lambda: area_files.load_area(path))
    path.write_text(_POLYGON)
    case.follow("give a GeoJSON, KML or KMZ file with one or more", lambda: area_files.load_area(path))


@remedy(
    "mission/areas/area.py",
    "polygon around a pole: its sides are straight in degrees; give its corners along the pole as well",
)
def _around_a_pole(case: Case) -> None:
    path = case.tmp_path / "area.geojson"
    ring = [[-180, 80], [-60, 80], [60, 80], [180, 80]]

    def load(corners: list[list[int]]) -> object:
        path.write_text(json.dumps({"type": "Polygon", "coordinates": [[*corners, corners[0]]]}))
        return area_files.load_area(path)

    case.refused(lambda: load(ring))
    case.follow("give its corners along the pole as well", lambda: load([*ring, [180, 90], [-180, 90]]))


@remedy(
    "mission/areas/files.py",
    "{}: lxml, which reads KML, is not installed; get it with: pip install 'terrainav[kml]', or give a GeoJSON file",
)
def _no_lxml(case: Case) -> None:
    kml, geojson = case.tmp_path / "area.kml", case.tmp_path / "area.geojson"
    kml.write_text("<kml><LinearRing><coordinates>10,35 10.1,35 10,35.1 10,35</coordinates></LinearRing></kml>")
    geojson.write_text(_POLYGON)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "lxml.etree", None)
        case.refused(lambda: area_files.load_area(kml))
        case.follow("give a GeoJSON file", lambda: area_files.load_area(geojson))
    case.follow("get it with: pip install 'terrainav[kml]'", lambda: extra_brings("kml", "lxml"))


@remedy("mission/cameras.py", "{}: give one of {}")
def _facts(case: Case) -> None:
    def made(facts):
        return cameras.CameraPreset.from_dict("own", {"source": "measured", **facts})

    lens = {"sensor_mm": [13.2, 8.8], "focal_length_mm": 8.8}
    views = {
        "fov_deg": {"fov_deg": 80.0, "aspect_ratio": [3, 2]},
        "horizontal_fov_deg": {"horizontal_fov_deg": 60.0, "aspect_ratio": [3, 2]},
        "vertical_fov_deg": {"vertical_fov_deg": 60.0, "aspect_ratio": [3, 2]},
        "sensor_mm": lens,
        "focal_px": {"focal_px": 500.0, "size_px": [640, 480]},
    }
    case.refused(lambda: made({"fov_deg": 80.0, **lens}))
    case.refused(lambda: made({"aspect_ratio": [3, 2]}))
    for name in sorted(views, key=len, reverse=True):
        case.follow(name, partial(made, views[name]))
    case.follow("give one of", lambda: set(cameras._VIEWS) == set(views))


@remedy("mission/cameras.py", "size_px and {}: give one of the two")
def _size_twice(case: Case) -> None:
    def made(facts):
        return cameras.CameraPreset.from_dict("own", {"source": "measured", **facts})

    case.refused(lambda: made({"fov_deg": 80.0, "size_px": [640, 480], "image_px": 640}))
    made({"fov_deg": 80.0, "size_px": [640, 480]})
    case.follow("give one of the two", lambda: made({"fov_deg": 80.0, "aspect_ratio": [3, 2], "image_px": 640}))


@remedy("mission/cameras.py", "camera {} is unknown: {}`terrainav cameras` lists the names")
def _camera_unknown(case: Case) -> None:
    text = case.refused(lambda: cameras.camera_named("Mavic 2 Prow"))
    meant = text.partition("did you mean ")[2].partition("?")[0]
    case.follow(f"did you mean {meant}?", lambda: [cameras.camera_named(name) for name in meant.split(" or ")])
    names = case.run("cameras").stdout
    case.follow("terrainav cameras` lists the names", lambda: "DJI Mavic 2 Pro" in names)
    cameras.camera_named("DJI Mavic 2 Pro")


@remedy("mission/cameras.py", "camera name {}: {} is taken; choose another")
def _camera_taken(case: Case) -> None:
    case.monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(case.tmp_path))
    facts = {"source": "measured", "fov_deg": 80.0, "aspect_ratio": [3, 2]}
    case.refused(lambda: cameras.add_camera("dji mavic 2 pro", facts))
    case.follow("choose another", lambda: cameras.add_camera("My own", facts))


@remedy("mission/settings.py", "area {} and coords {}: give one of the two")
def _area_twice(case: Case) -> None:
    path = case.tmp_path / "area.geojson"
    path.write_text('{"type": "Polygon", "coordinates": [[[10, 35], [10.1, 35], [10, 35.1], [10, 35]]]}')
    case.refused(lambda: _asked(area=str(path), coords="35_10_120", agl=120.0))
    _asked(area=str(path), agl=120.0)
    case.follow("give one of the two", lambda: _asked(coords="35_10_120"))


@remedy(
    "mission/settings.py",
    'no coordinates: give --coords, such as --coords "35.16_-89.90_35.115_-89.823_120"',
)
def _no_coords(case: Case) -> None:
    case.refused(_asked)
    named = ("--coords", "35.16_-89.90_35.115_-89.823_120")
    case.follow(
        'give --coords, such as --coords "35.16_-89.90_35.115_-89.823_120"',
        lambda: case.run("plan", *named).returncode == 0,
    )


@remedy("mission/settings.py", "{} and {}: give one of the two")
def _camera_twice(case: Case) -> None:
    case.refused(lambda: _asked(coords="35_10_120", fov=80.0, hfov=60.0))
    _asked(coords="35_10_120", fov=80.0)
    case.follow("give one of the two", lambda: _asked(coords="35_10_120", hfov=60.0))


def _asked(**values):
    return settings.build_mission(settings.resolve(values, environment={}))


@remedy("mission/parts/pictures.py", "no map type: give one or more of {}")
def _no_map_type(case: Case) -> None:
    case.refused(lambda: Mission(AREA, 120.0, map_types=()))
    made = partial(Mission, AREA, 120.0)
    for name in ("satellite", "roadmap", "terrain"):
        case.follow(name, partial(made, map_types=(name,)))
    case.follow("give one or more of", lambda: made(map_types=("terrain", "roadmap")))


@remedy("mission/mission.py", "product {}: needs labels or buildings; name vector layers (--labels)")
def _no_labels(case: Case) -> None:
    case.refused(lambda: Mission(AREA, 120.0, products=("classes",)))
    named = partial(Mission, AREA, 120.0, products=("classes",), labels=("fields.geojson",))
    case.follow("name vector layers (--labels)", named)


@remedy("mission/parts/pictures.py", "source is empty: name one, or give a URL template or a file")
def _no_source(case: Case) -> None:
    case.refused(lambda: Mission(AREA, 120.0, source=""))
    case.follow("name one", lambda: Mission(AREA, 120.0, source="usgs"))
    case.follow("give a URL template", lambda: Mission(AREA, 120.0, source="https://h/{z}/{x}/{y}.png"))
    case.follow("a file", lambda: Mission(AREA, 120.0, source="ortho.tif"))


@remedy("mission/parts/pictures.py", "zoom {} and ground sample distance {} m: give one of the two")
def _pixels_twice(case: Case) -> None:
    case.refused(lambda: Mission(AREA, 120.0, zoom=18, gsd_m_per_px=0.5))
    Mission(AREA, 120.0, zoom=18)
    case.follow("give one of the two", lambda: Mission(AREA, 120.0, gsd_m_per_px=0.5))


# --- estimates


@remedy(
    "mission/estimate.py",
    "of {} images {} lie outside the source's imagery, and {} reach beyond it; choose an area that it "
    "has imagery of, or "
    "another source",
)
def _beyond(case: Case) -> None:
    mission = Mission(AREA, 120.0)
    part = PixelGrid(extent=extent_of_box(-89.9, 35.1575, -89.89, 35.17))

    def warned(mission, grid):
        return "\n".join(imagery_warnings(plan(mission, grid)))

    case.says(warned(mission, part))
    inside = mission.replace(area=Box(35.165, -89.897, 35.162, -89.894))
    case.follow("choose an area that it has imagery of", lambda: not warned(inside, part))
    case.follow("another source", lambda: not warned(mission, GRID))


UPSAMPLED = (
    "requested {}, but the source has {} here (zoom {}): upsampled {} times, images show no more detail; ask for {}"
)


@remedy("mission/estimate.py", UPSAMPLED)
def _enlarged(case: Case) -> None:
    mission, coarse = Mission(AREA, 120.0, zoom=19, upsample=True), PixelGrid(native_zoom=17)
    case.says(_warned(mission, coarse))
    case.follow("ask for --zoom 17", lambda: not _warned(mission.replace(zoom=17), coarse))
    case.follow("a finer source", lambda: not _warned(mission, PixelGrid(native_zoom=20)))


@remedy("mission/estimate.py", "--img-size {} {} {} or less")
def _enlarged_size(case: Case) -> None:
    mission, coarse = Mission(AREA, 120.0, img_size=(640, 480, 3)), PixelGrid(native_zoom=17)
    case.says(_warned(mission, coarse))
    width, height, channels = map(int, case.advice.split()[1:4])
    size = f"--img-size {width} {height} {channels}"
    case.follow(size, lambda: not _warned(mission.replace(img_size=(width, height, channels)), coarse))
    case.follow("less", lambda: not _warned(mission.replace(img_size=(width - 9, height - 9, 3)), coarse))


@remedy("mission/estimate.py", "--image-px {} or less, or fly higher")
def _enlarged_image(case: Case) -> None:
    mission = Mission(AREA, 120.0, tilt_deg=20.0, upsample=True)
    coarse = PixelGrid(native_zoom=17)
    case.says(_warned(mission, coarse))
    longest = int(case.advice.split()[1])
    case.follow(f"--image-px {longest}", lambda: not _warned(mission.replace(image_px=longest), coarse))
    case.follow("less", lambda: not _warned(mission.replace(image_px=longest // 2), coarse))
    case.follow("fly higher", lambda: not _warned(mission.replace(agl_m=1000.0), coarse))


@remedy("mission/estimate.py", "--zoom {} or a finer source")
def _enlarged_zoom(case: Case) -> None:
    mission, coarse = (
        Mission(AREA, 120.0, gsd_m_per_px=0.2, tilt_deg=10.0, upsample=True),
        PixelGrid(native_zoom=17),
    )
    case.says(_warned(mission, coarse))
    case.follow("--zoom 17", lambda: not _warned(mission.replace(gsd_m_per_px=None, zoom=17), coarse))
    case.follow("a finer source", lambda: not _warned(mission, GRID))


def _warned(mission, grid):
    return "\n".join(upsampling_warnings(plan(mission, grid)))


# --- exports


@remedy(
    "mission/export/geopackage.py",
    "{}: GeoPackages need GDAL's Python module (osgeo), which QGIS brings along; install it, or choose .geojson",
)
def _no_gdal(case: Case) -> None:
    made = plan(Mission(AREA, 400.0), GRID)
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "osgeo", None)
        case.refused(lambda: write_plan(made, case.tmp_path / "plan.gpkg"))
        case.follow("choose .geojson", lambda: write_plan(made, case.tmp_path / "plan.geojson"))
    case.follow("install it", lambda: write_plan(made, case.tmp_path / "plan.gpkg"))


@remedy("mission/export/litchi.py", "Litchi mission of one waypoint: takes two or more; plan a list or an area")
def _one_waypoint(case: Case) -> None:
    def write(area):
        return write_plan(plan(Mission(area, 120.0), GRID), case.tmp_path / "flight.litchi.csv")

    case.refused(lambda: write(Points(POSES[:1])))
    case.follow("plan a list", lambda: write(Points(POSES)))
    case.follow("an area", lambda: write(AREA))


@remedy(
    "mission/export/litchi.py",
    "Litchi mission of {} waypoints: takes {} or fewer; plan a smaller area, a greater height or less overlap",
)
def _litchi(case: Case) -> None:
    case.monkeypatch.setattr(litchi, "MAX_PARTS", 1)
    _fewest(case, "flight.litchi.csv")


@remedy(
    "mission/export/qgroundcontrol.py",
    "QGroundControl plan of {} waypoints: takes {} or fewer; plan a smaller area, a greater height or less overlap",
)
def _qgroundcontrol(case: Case) -> None:
    case.monkeypatch.setattr(qgroundcontrol, "MAX_ITEMS", 204)
    _fewest(case, "flight.plan")


@remedy("mission/export/wpml.py", "DJI mission of one waypoint: takes two or more; plan a list or an area")
def _one_waypoint_of_dji(case: Case) -> None:
    def write(area):
        return write_plan(plan(Mission(area, 120.0), GRID), case.tmp_path / "flight.kmz")

    case.refused(lambda: write(Points(POSES[:1])))
    case.follow("plan a list", lambda: write(Points(POSES)))
    case.follow("an area", lambda: write(AREA))


@remedy(
    "mission/export/wpml.py",
    "DJI mission of {} waypoints: takes {} or fewer, in {} files; plan a smaller area, a greater height or less "
    "overlap",
)
def _wpml(case: Case) -> None:
    case.monkeypatch.setattr(wpml, "MAX_FILES", 1)
    _fewest(case, "flight.kmz", drone="dji-fly")


@remedy(
    "mission/export/wpml.py",
    "DJI Fly opens no files: put this one in the place of a mission that you made there",
)
def _into_dji_fly(case: Case) -> None:
    made = plan(Mission(AREA, 120.0, drone="dji-fly"), GRID)
    exported = write_plan(made, case.tmp_path / "flight.kmz")
    (file,) = exported.files
    case.says("\n".join(exported.notes))
    # As the program keeps a mission that was made in it.
    kept = case.tmp_path / "waypoint" / "4C0B9E6B" / "4C0B9E6B.kmz"
    kept.parent.mkdir(parents=True)
    kept.write_bytes(b"made there")
    case.follow(
        "put this one in the place of a mission that you made there",
        lambda: shutil.copy(file, kept) and len(Wpml(kept).marks) == len(made),
    )


def _not_a_survey(case: Case, area: Any, **changes: Any) -> None:
    flown = plan(Mission(area, 120.0, **changes), GRID)
    case.refused(lambda: write_plan(flown, case.tmp_path / "flight.survey.plan"))
    case.follow("choose the ending .plan", lambda: write_plan(flown, case.tmp_path / "flight.plan").files)


@remedy(
    "mission/export/survey.py",
    "QGroundControl survey: needs an area of one polygon without holes; choose the ending .plan",
)
def _survey_of_points(case: Case) -> None:
    _not_a_survey(case, Points(POSES))


@remedy(
    "mission/export/survey.py",
    "QGroundControl survey: takes one mission, and {} are joined; choose the ending .plan",
)
def _survey_joined(case: Case) -> None:
    flown = plan(Mission(AREA, 120.0), GRID)
    joined = join_plans([flown, flown], ["one", "other"])
    case.refused(lambda: write_plan(joined, case.tmp_path / "flight.survey.plan"))
    case.follow("choose the ending .plan", lambda: write_plan(joined, case.tmp_path / "flight.plan").files)


@remedy(
    "mission/export/survey.py",
    "QGroundControl survey with a tilt of {} and a roll of {} deg: must look straight down; choose the ending .plan",
)
def _survey_tilted(case: Case) -> None:
    _not_a_survey(case, AREA, tilt_deg=20.0)


@remedy(
    "mission/export/survey.py",
    "QGroundControl survey with images {} deg off the direction of rows: must be along or across them; choose the "
    "ending .plan",
)
def _survey_turned(case: Case) -> None:
    _not_a_survey(case, AREA, yaw_deg=30.0)


def _fewest(case: Case, name: str, **more: Any) -> None:
    """A flight of some hundred waypoints too many, and one of fewer in each of the ways advised."""
    mission = Mission(AREA, 60.0, overlap_along=0.6, overlap_across=0.6, **more)

    def write(**changes):
        return write_plan(plan(mission.replace(**changes), GRID), case.tmp_path / name)

    case.refused(write)
    case.follow("plan a smaller area", lambda: write(area=Box(35.156, -89.896, 35.155, -89.895)))
    case.follow("a greater height", lambda: write(agl_m=240.0))
    case.follow("less overlap", lambda: write(overlap_along=0.0, overlap_across=0.0))


@remedy("mission/export/rows.py", "start {}: the flight of {} s goes beyond the year 9999; start earlier")
def _year_10000(case: Case) -> None:
    times = np.array([0.0, 3600.0])
    case.refused(lambda: clock("9999-12-31T23:30:00Z", times))
    case.follow("start earlier", lambda: clock("9999-12-31T21:30:00Z", times))


@remedy("mission/parts/sensor.py", "{} {}: needs an image sensor; name one, or {} (--image-sensor)")
def _no_sensor(case: Case) -> None:
    case.refused(lambda: Mission(AREA, 120.0, read_noise_e=3.0))
    case.follow("name one", lambda: Mission(AREA, 120.0, read_noise_e=3.0, image_sensor="Alvium 1800 C-507m"))
    own = {"image_sensor": "custom", "pixel_um": 3.45, "quantum_efficiency": 0.6, "full_well_e": 10_000.0}
    case.follow("or custom (--image-sensor)", lambda: Mission(AREA, 120.0, read_noise_e=3.0, **own))


@remedy("mission/parts/sensor.py", "image sensor {}: needs its {}; give it ({})")
def _figure_of_custom(case: Case) -> None:
    own = {"image_sensor": "custom", "pixel_um": 3.45, "quantum_efficiency": 0.6}
    case.refused(lambda: Mission(AREA, 120.0, **own))
    case.follow("give it (--full-well-e)", lambda: Mission(AREA, 120.0, full_well_e=10_000.0, **own))


@remedy("mission/mission.py", "product {}: needs an image sensor; name one (--image-sensor)")
def _no_raw(case: Case) -> None:
    case.refused(lambda: Mission(AREA, 120.0, products=("raw",)))
    named = {"image_sensor": "Alvium 1800 C-507m"}
    case.follow("name one (--image-sensor)", lambda: Mission(AREA, 120.0, products=("raw",), **named))


@remedy("picture/sensor.py", "sensitivity ISO {}: below that of the image sensor; give {} or more")
def _too_low_speed(case: Case) -> None:
    def check(iso: float) -> None:
        mission = Mission(AREA, 120.0, image_sensor="Alvium 1800 C-507m", exposure="time", iso=iso)
        check_sensor(mission, RGB)

    case.refused(lambda: check(100.0))
    case.follow("give 234 or more", lambda: check(234.0))


@remedy("mission/mission.py", "diffraction: needs the pixel pitch; give it (--pixel-um)")
def _no_pitch(case: Case) -> None:
    case.refused(lambda: Mission(AREA, 120.0, diffraction=True))
    case.follow("give it (--pixel-um)", lambda: Mission(AREA, 120.0, diffraction=True, pixel_um=3.45))
