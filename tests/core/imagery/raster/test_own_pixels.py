"""Rasters in a projected CRS: images of their own pixels, in their own CRS, wherever on Earth."""

from __future__ import annotations

import math

import numpy as np
import pyproj
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.capture.runner import capture  # noqa: E402
from terrainav.core.dataset.table import Table  # noqa: E402
from terrainav.core.errors import InvalidInput  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.mission.areas.area import Box, Points, Polygon  # noqa: E402
from terrainav.core.mission.estimate import estimate  # noqa: E402
from terrainav.core.mission.mission import Mission  # noqa: E402
from terrainav.core.mission.plan import plan  # noqa: E402
from terrainav.core.report import positions  # noqa: E402

from tests.core.geodesy.reference import see  # noqa: E402
from tests.support import rasters  # noqa: E402
from tests.support.systems import NATIONAL  # noqa: E402
from tests.support.thinning import sampled  # noqa: E402

SIDE = 1500
#: Orthophotos of 0.5 m about a place: their EPSG code, and the place.
PLACES = {
    "UTM 16 N": (32616, 35.15, -89.9),
    "88° N": (3413, 88.0, 10.0),
    "89.9° S": (3031, -89.9, 100.0),
    "the pole": (3031, -90.0, 0.0),
    "US survey feet": (2263, 40.75, -73.98),
    "rows from the south": (32616, 35.15, -89.9),
}


def noise(path, epsg, lat, lon, *, pixel=0.5, upright=True, side=SIDE):
    """White noise about a place, and its values (3, h, w); its corner is no round number."""
    values = np.random.default_rng(3).integers(0, 256, (3, side, side), np.uint8)
    x, y = pyproj.Transformer.from_crs(4326, epsg, always_xy=True).transform(lon, lat)
    west, north = x - pixel * side / 2 + 0.123, y + pixel * side / 2 - 0.077
    geotransform = (west, pixel, 0.0, north, 0.0, -pixel)
    if not upright:
        geotransform = (west, pixel, 0.0, north - pixel * side, 0.0, pixel)
    rasters.write(path, values, geotransform, epsg)
    return values, geotransform


def about(epsg, lat, lon, half_m):
    """Corners, as longitudes and latitudes, of a square of the CRS about a place, its sides cut into eighths."""
    to_crs = pyproj.Transformer.from_crs(4326, epsg, always_xy=True)
    unit = pyproj.CRS(epsg).axis_info[0].unit_conversion_factor
    x, y = to_crs.transform(lon, lat)
    share = np.linspace(-1, 1, 8, endpoint=False)
    one = np.ones_like(share)
    across, up = np.concatenate([share, one, -share, -one]), np.concatenate([-one, share, one, -share])
    lons, lats = to_crs.transform(x + across * half_m / unit, y + up * half_m / unit, direction="INVERSE")
    return lons, lats


@pytest.mark.parametrize("place", sampled([name for name in PLACES if name != "the pole"], 3))
def test_every_pixel_is_the_file_s(place, tmp_path, library):
    epsg, lat, lon = PLACES[place]
    pixel = 0.5 / pyproj.CRS(epsg).axis_info[0].unit_conversion_factor
    values, (west, _, _, y0, _, down) = noise(
        tmp_path / "noise.tif", epsg, lat, lon, pixel=pixel, upright=place != "rows from the south"
    )
    ring = tuple(zip(*(part.tolist() for part in about(epsg, lat, lon, 200.0))))
    source = open_raster(tmp_path / "noise.tif")
    worked_out = plan(Mission(Polygon((ring,)), 120.0, source="noise.tif"), source.grid)
    assert worked_out.accuracy.picture.method.name == "map"
    assert worked_out.accuracy.bound_px < 0.01
    assert worked_out.coverage.complete
    assert worked_out.imagery.share == 1.0
    assert worked_out.resolution.source_m_per_px == pytest.approx(0.5, rel=0.04)
    result = capture(worked_out, source, tmp_path / "out")
    source.close()
    assert result.written == len(worked_out) > 8
    assert result.requests == result.unique_parts == worked_out.requests
    for name in worked_out.names:
        image = gdal.Open(str(tmp_path / "out" / "satellite" / f"{name}.tif"))
        assert image.GetSpatialRef().GetAuthorityCode(None) == str(epsg)
        left, width, _, top, _, height = image.GetGeoTransform()
        assert (width, -height) == pytest.approx((pixel, pixel), rel=1e-12)
        column, row = (left - west) / pixel, (top - y0) / down
        assert abs(column - round(column)) < 1e-6
        assert abs(row - round(row)) < 1e-6
        column, row, shown = round(column), round(row), image.ReadAsArray()
        if down > 0:
            expected = values[:, row - shown.shape[1] : row, column : column + shown.shape[2]][:, ::-1]
        else:
            expected = values[:, row : row + shown.shape[1], column : column + shown.shape[2]]
        assert np.array_equal(shown, expected)


@pytest.mark.parametrize(
    ("crs", "lat", "lon"),
    sampled([place for place in NATIONAL if pyproj.CRS(place[0]).axis_info[0].unit_name == "metre"], 5),
)
def test_orthophotos_of_national_systems_keep_their_pixels(crs, lat, lon, tmp_path):
    """A shift of the datum does not bring PROJ back to where it came from: to some millimetres."""
    for pixel in (0.25, 0.02):
        _, (west, _, _, north, _, _) = noise(tmp_path / "o.tif", int(crs[5:]), lat, lon, pixel=pixel, side=64)
        source = open_raster(tmp_path / "o.tif")
        grid = source.grid
        source.close()
        assert not grid.plane.wraps
        assert (grid.plane.crs, grid.plane.west, grid.plane.north) == (crs, west, north)
        assert grid.pixel_size(grid.native_zoom) == pytest.approx((pixel, pixel), rel=1e-12)


def test_images_about_the_pole_are_the_file_s_and_cover_it(tmp_path):
    values, (west, pixel, _, north, _, _) = noise(tmp_path / "noise.tif", 3031, -90.0, 0.0)
    lon, lat = about(3031, -90.0, 0.0, 250.0)
    order = np.argsort(lon)
    # Around the pole and back along it, as RFC 7946 draws such a ring.
    ring = [*zip(lon[order].tolist(), lat[order].tolist())]
    closing = [(float(lon[order][0]) + 360.0, float(lat[order][0]))]
    polygon = Polygon(((*ring, *closing, (closing[0][0], -90.0), (ring[0][0], -90.0)),))
    source = open_raster(tmp_path / "noise.tif")
    worked_out = plan(Mission(polygon, 120.0, source="noise.tif"), source.grid)
    assert worked_out.coverage.complete
    x = (np.array(worked_out.edges[0]) + np.array(worked_out.edges[2])) / 2
    assert x.min() < -100 < 100 < x.max()
    capture(worked_out, source, tmp_path / "out")
    source.close()
    seen = np.zeros((SIDE, SIDE), bool)
    for name in worked_out.names:
        image = gdal.Open(str(tmp_path / "out" / "satellite" / f"{name}.tif"))
        left, _, _, top, _, _ = image.GetGeoTransform()
        column, row, shown = round((left - west) / pixel), round((north - top) / pixel), image.ReadAsArray()
        rows, columns = slice(row, row + shown.shape[1]), slice(column, column + shown.shape[2])
        assert np.array_equal(shown, values[:, rows, columns])
        seen[rows, columns] = True
    middle = round(-west / pixel), round(north / pixel)
    assert seen[middle[1] - 490 : middle[1] + 490, middle[0] - 490 : middle[0] + 490].all()


@pytest.mark.parametrize("place", ["UTM 16 N", "89.9° S", "the pole"])
def test_a_tilted_picture_shows_what_its_control_points_say(place, tmp_path):
    """A raster whose colours tell positions, against the perspective of the points in the picture's own file."""
    epsg, lat, lon = PLACES[place]
    x, y = pyproj.Transformer.from_crs(4326, epsg, always_xy=True).transform(lon, lat)
    columns, rows = np.meshgrid(np.arange(SIDE) + 0.5, np.arange(SIDE) + 0.5)
    geotransform = (x - SIDE / 4, 0.5, 0.0, y + SIDE / 4, 0.0, -0.5)
    path = rasters.write(
        tmp_path / "smooth.tif",
        [rasters.triangle(columns), rasters.triangle(rows), columns * 0],
        geotransform,
        epsg,
    )
    source = open_raster(path)
    mission = Mission(Points(((lat, lon, 120.0),)), 120.0, tilt_deg=30.0, yaw_deg=20.0, source=str(path))
    worked_out = plan(mission, source.grid)
    assert worked_out.accuracy.picture.method.name == "camera"
    capture(worked_out, source, tmp_path / "out")
    source.close()
    (picture,) = (tmp_path / "out" / "satellite").glob("*.tif")
    opened = gdal.Open(str(picture))
    shown = opened.ReadAsArray().astype(float)
    to_crs = pyproj.Transformer.from_crs(4326, epsg, always_xy=True)
    # The perspective through the points: a homography of the ground, which is flat to 2 mm here.
    points = [(p.GCPPixel, p.GCPLine, *to_crs.transform(p.GCPX, p.GCPY)) for p in opened.GetGCPs()]
    to_ground = _homography(np.array(points))
    px, py = np.meshgrid(np.arange(shown.shape[2]) + 0.5, np.arange(shown.shape[1]) + 0.5)
    there = np.stack([px, py, np.ones_like(px)], axis=-1) @ to_ground.T
    east, north = there[..., 0] / there[..., 2], there[..., 1] / there[..., 2]
    at = (east - geotransform[0]) / 0.5, (geotransform[3] - north) / 0.5
    for channel in range(2):
        # Four levels a source pixel; where the wave turns, kernels round it off.
        kept = ~rasters.turns(at[channel], 6.0)
        off = (shown[channel] - rasters.triangle(at[channel]))[kept] / 4.0
        falling = (np.mod(at[channel] / rasters.RAMP_PERIOD, 1.0) > 0.5)[kept]
        # Grey levels are whole numbers in the raster and in the picture: an eighth of a pixel each, and no shift.
        assert np.percentile(np.abs(off), 99) < 0.3
        assert abs(np.where(falling, -off, off).mean()) < 0.02


def _homography(points):
    """Least-squares perspective from image (k, 0:2) to ground (k, 2:4)."""
    centre = points[:, 2:].mean(axis=0)
    rows = []
    for column, row, x, y in points - np.array([0, 0, *centre]):
        rows.append([column, row, 1, 0, 0, 0, -x * column, -x * row, -x])
        rows.append([0, 0, 0, column, row, 1, -y * column, -y * row, -y])
    found = np.linalg.svd(np.array(rows) / np.abs(rows).max(axis=0))[2][-1] / np.abs(rows).max(axis=0)
    moved = np.array([[1, 0, centre[0]], [0, 1, centre[1]], [0, 0, 1]])
    return moved @ found.reshape(3, 3)


def test_the_distance_of_the_raster_itself_can_be_asked_for_and_no_finer(tmp_path):
    epsg, lat, lon = PLACES["UTM 16 N"]
    noise(tmp_path / "noise.tif", epsg, lat, lon)
    grid = open_raster(tmp_path / "noise.tif").grid
    ring = tuple(zip(*(part.tolist() for part in about(epsg, lat, lon, 200.0))))

    def planned(**options):
        return plan(Mission(Polygon((ring,)), 120.0, **options), grid)

    for gsd, zoom in ((0.5, 0), (0.7, 0), (1.0, 1), (2.1, 2)):
        worked_out = planned(gsd_m_per_px=gsd)
        assert worked_out.zoom == grid.native_zoom - zoom
        assert worked_out.grid.pixel_size(worked_out.zoom)[0] == 0.5 * 2**zoom
    with pytest.raises(InvalidInput) as refused:
        planned(gsd_m_per_px=0.3)
    assert refused.value.field == "gsd_m_per_px"
    assert "0.5" in str(refused.value)
    assert planned(gsd_m_per_px=0.3, upsample=True).zoom == grid.native_zoom + 1


def test_images_that_a_file_does_not_cover_are_counted_before(tmp_path):
    epsg, lat, lon = PLACES["89.9° S"]
    noise(tmp_path / "noise.tif", epsg, lat, lon)
    source = open_raster(tmp_path / "noise.tif")
    lons, lats = about(epsg, lat, lon, 500.0)
    worked_out = plan(Mission(Polygon((tuple(zip(lons.tolist(), lats.tolist())),)), 120.0), source.grid)
    summary = estimate(worked_out)
    # 750 m of the 1,000 m along each side.
    assert worked_out.imagery.share == pytest.approx(0.75**2, rel=1e-3)
    result = capture(worked_out, source, tmp_path / "out")
    source.close()
    assert worked_out.imagery.outside + worked_out.imagery.partly == len(result.failed) > 0
    assert any(f"{worked_out.imagery.outside:,} lie outside" in text for text in summary.warnings)


def test_tables_say_where_images_lie(tmp_path):
    epsg, lat, lon = PLACES["88° N"]
    noise(tmp_path / "noise.tif", epsg, lat, lon)
    source = open_raster(tmp_path / "noise.tif")
    ring = tuple(zip(*(part.tolist() for part in about(epsg, lat, lon, 200.0))))
    worked_out = plan(Mission(Polygon((ring,)), 120.0), source.grid)
    capture(worked_out, source, tmp_path / "out")
    source.close()
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert set(table.crs) == {f"EPSG:{epsg}"}
    for index, name in enumerate(table.img_names):
        image = gdal.Open(str(tmp_path / "out" / "satellite" / name))
        left, width, _, top, _, height = image.GetGeoTransform()
        stated = table.west[index], table.pixel_width[index], table.north[index], -table.pixel_height[index]
        assert stated == pytest.approx((left, width, top, height), abs=1e-9)
    assert table.yaw_deg == pytest.approx(-worked_out.grid.plane.north_deg(table.pose_lat_deg, table.pose_lon_deg))


def test_a_layout_of_the_map_and_the_horizon_are_refused(tmp_path):
    epsg, lat, lon = PLACES["UTM 16 N"]
    noise(tmp_path / "noise.tif", epsg, lat, lon)
    grid = open_raster(tmp_path / "noise.tif").grid
    box = Box(lat + 0.001, lon - 0.001, lat - 0.001, lon + 0.001)
    for options, field in (({"layout": "paper"}, "layout"), ({"tilt_deg": 80.0}, "tilt_deg")):
        with pytest.raises(InvalidInput) as refused:
            plan(Mission(box, 120.0, **options), grid)
        assert refused.value.field == field


def test_degrees_and_turned_rasters_become_pixels_of_the_map(tmp_path):
    values = np.zeros((3, 64, 64), np.uint8)
    turned = (505_000.0, math.sqrt(3.0), 1.0, 5_317_000.0, 1.0, -math.sqrt(3.0))
    for name, geotransform, epsg in (
        ("degrees", (9.0, 3e-5, 0.0, 48.0, 0.0, -2e-5), 4326),
        ("turned", turned, 32632),
    ):
        path = rasters.write(tmp_path / f"{name}.tif", values, geotransform, epsg)
        assert open_raster(path).grid.plane.wraps
    # So do pixels that are the map's own.
    size = 2 * math.pi * 6378137 / 2**8 / 2**15
    corner = (-math.pi * 6378137 + 5000 * size, size, 0.0, math.pi * 6378137 - 7000 * size, 0.0, -size)
    assert open_raster(rasters.write(tmp_path / "map.tif", values, corner, 3857)).grid.plane.wraps
    off = (corner[0] + 0.3 * size, *corner[1:])
    assert not open_raster(rasters.write(tmp_path / "off.tif", values, off, 3857)).grid.plane.wraps


def test_a_report_measures_pictures_in_the_raster_s_crs(tmp_path):
    epsg, lat, lon = PLACES["89.9° S"]
    noise(tmp_path / "noise.tif", epsg, lat, lon)
    source = open_raster(tmp_path / "noise.tif")
    ring = tuple(zip(*(part.tolist() for part in about(epsg, lat, lon, 100.0))))
    for tilt_deg in (0.0, 20.0):
        worked_out = plan(Mission(Polygon((ring,)), 120.0, tilt_deg=tilt_deg), source.grid)
        # Before their edges are rounded to pixels, which moves frames and not what they show.
        mesh = positions.mesh_errors(worked_out, 0.1)
        errors = mesh.errors_px if tilt_deg else positions.map_frame_errors_px(worked_out)
        assert 0.0 < errors.max() <= worked_out.accuracy.bound_px
    source.close()


def test_points_keep_yaws_of_their_own_and_missions_count_theirs_from_grid_north(tmp_path):
    epsg, lat, lon = PLACES["88° N"]
    noise(tmp_path / "noise.tif", epsg, lat, lon)
    grid = open_raster(tmp_path / "noise.tif").grid
    place = ((lat, lon, 60.0),)
    north_deg = float(grid.plane.north_deg(np.array(lat), np.array(lon)))
    assert abs(north_deg) > 40.0
    assert plan(Mission(Points(place, (30.0,)), 60.0), grid).poses.yaw_deg == pytest.approx([30.0])
    assert plan(Mission(Points(place), 60.0, yaw_deg=30.0), grid).poses.yaw_deg == pytest.approx([30.0 - north_deg])


def test_a_crs_without_a_code_is_written_whole(tmp_path):
    crs = "+proj=tmerc +lat_0=47.1 +lon_0=11.3 +k=1 +x_0=0 +y_0=0 +ellps=GRS80 +units=m +no_defs"
    values = np.random.default_rng(3).integers(0, 256, (3, SIDE, SIDE), np.uint8)
    geotransform = (-375.0, 0.5, 0.0, 375.0, 0.0, -0.5)
    path = rasters.write(tmp_path / "own.tif", values, geotransform, crs)
    source = open_raster(path)
    area = Box(47.101, 11.2985, 47.099, 11.3015)
    for image_format in ("tif", "jpg"):
        worked_out = plan(Mission(area, 120.0, image_format=image_format), source.grid)
        assert capture(worked_out, source, tmp_path / image_format).written == len(worked_out)
        image = gdal.Open(str(tmp_path / image_format / "satellite" / f"{worked_out.names[0]}.{image_format}"))
        left, _, _, top, _, _ = image.GetGeoTransform()
        lon, lat = pyproj.Transformer.from_crs(image.GetProjection(), 4326, always_xy=True).transform(left, top)
        x, y = pyproj.Transformer.from_crs(4326, crs, always_xy=True).transform(lon, lat)
        assert (x, y) == pytest.approx((left, top), abs=1e-6)
        assert "Transverse_Mercator" in image.GetProjection()
    source.close()


def rational(lat, lon, x_px, y_px, width, height):
    """GDAL's RPC metadata of a camera, from where it sees ground points, and the largest residual in px.

    Cubics over cubics of latitude and longitude alone, as the ground is level.
    """
    terms = np.array([0, 1, 2, 4, 7, 8, 11, 12, 14, 15])  # of RPC00B's twenty, those without a height
    offset = {"LAT": lat.mean(), "LONG": lon.mean(), "SAMP": (width - 1) / 2, "LINE": (height - 1) / 2}
    scale = {"LAT": np.ptp(lat) / 2, "LONG": np.ptp(lon) / 2, "SAMP": width / 2, "LINE": height / 2}
    y, x = (lat - offset["LAT"]) / scale["LAT"], (lon - offset["LONG"]) / scale["LONG"]
    powers = np.stack([x**0, x, y, x * y, x * x, y * y, x**3, x * y * y, x * x * y, y**3], axis=1)
    rpc, residual = {"HEIGHT_OFF": "0", "HEIGHT_SCALE": "1"}, 0.0
    # RPCs count from the first pixel's centre.
    for name, at in (("SAMP", x_px - 0.5), ("LINE", y_px - 0.5)):
        wanted = (at - offset[name]) / scale[name]
        system = np.concatenate([powers, -wanted[:, np.newaxis] * powers[:, 1:]], axis=1)
        found = np.linalg.lstsq(system, wanted, rcond=None)[0]
        for part, values in (("NUM", found[:10]), ("DEN", np.concatenate([[1.0], found[10:]]))):
            every = np.zeros(20)
            every[terms] = values
            rpc[f"{name}_{part}_COEFF"] = " ".join(repr(float(value)) for value in every)
        off = powers @ found[:10] / (1.0 + powers[:, 1:] @ found[10:]) - wanted
        residual = max(residual, float(np.abs(off).max()) * scale[name])
    for name in offset:
        rpc[f"{name}_OFF"], rpc[f"{name}_SCALE"] = repr(float(offset[name])), repr(float(scale[name]))
    return rpc, residual


@pytest.mark.parametrize("place", sampled(["UTM 16 N", "88° N", "89.9° S"], 3))
def test_gdalwarp_puts_a_tilted_picture_back_where_the_file_has_it(place, tmp_path):
    """By rational functions of the 50-digit camera's rays: each pixel of the file tells its own column and row."""
    epsg, lat, lon = PLACES[place]
    agl = 70.0
    west, across, _, north, _, down = noise(tmp_path / "noise.tif", epsg, lat, lon)[1]
    index = np.arange(SIDE) + 0.5
    values = np.stack(np.broadcast_arrays(index, index[:, np.newaxis])).astype(np.float32)
    file = tmp_path / "positions.tif"
    rasters.write(file, values, (west, across, 0, north, 0, down), epsg, data_type=gdal.GDT_Float32)
    source = open_raster(file, as_stored=True)
    mission = Mission(Points(((lat, lon, agl),)), agl, tilt_deg=45.0, yaw_deg=30.0, resampling="bilinear")
    worked_out = plan(mission, source.grid)
    capture(worked_out, source, tmp_path / "out")
    (image,) = (tmp_path / "out").rglob("*.tif")
    picture = gdal.Open(str(image))
    width, height = picture.RasterXSize, picture.RasterYSize
    camera = worked_out.mission.camera
    attitude = [float(angle[0]) for angle in worked_out.poses.attitude]
    x_px, y_px = (at.ravel() for at in np.meshgrid(np.linspace(0, width, 13), np.linspace(0, height, 13)))
    seen = [
        see(lat, agl, camera.fov_deg, camera.aspect_ratio, *attitude, x / width * 2 - 1, 1 - y / height * 2)
        for x, y in zip(x_px.tolist(), y_px.tolist())
    ]
    ground = np.array([[float(at), lon + float(turn)] for at, turn in seen])
    rpc, residual = rational(ground[:, 0], ground[:, 1], x_px, y_px, width, height)
    shown = picture.ReadAsArray()
    # Pixels of the file along a pixel of the picture, by which what is off becomes pixels of the picture.
    along, down_it = (np.hypot(*np.gradient(shown, axis=axis)) for axis in (1, 2))
    scale = np.full((height, width), -1e9)  # its edge, where gdalwarp has no neighbours
    scale[2:-2, 2:-2] = np.minimum(along, down_it)[2:-2, 2:-2]
    bare = gdal.GetDriverByName("MEM").Create("", width, height, 3, gdal.GDT_Float32)
    for band, values_of in enumerate((*shown, scale), 1):
        bare.GetRasterBand(band).WriteArray(values_of)
    bare.SetMetadata(rpc, "RPC")
    back = gdal.Warp(
        "", bare, format="MEM", rpc=True, dstSRS=f"EPSG:{epsg}", errorThreshold=0, resampleAlg="bilinear",
        outputBounds=(west, north + SIDE * down, west + SIDE * across, north), width=SIDE, height=SIDE,
        transformerOptions=["RPC_HEIGHT=0"], warpOptions=["XSCALE=1", "YSCALE=1"], dstNodata=-1,
    )  # fmt: skip
    column, row, scale = back.ReadAsArray()
    inside = scale > 0
    off = np.hypot(column - values[0], row - values[1])[inside]
    assert len(off) > 100_000
    # Between pixels gdalwarp goes straight, and ours are means over a pixel where they see more of the ground.
    curved = sum(np.hypot(*np.abs(np.diff(shown, 2, axis=axis))).max() for axis in (1, 2)) * (1 / 8 + 1 / 24)
    bound = worked_out.views.view(0).bound_px + worked_out.accuracy.picture.method.bound_px + residual
    assert (off <= bound * scale[inside] + curved).all()
    assert np.median(off / scale[inside]) < 0.006
