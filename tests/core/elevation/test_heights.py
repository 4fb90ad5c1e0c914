"""Heights of sources: those that files and tiles hold, over the ellipsoid, wherever and however they are written."""

from __future__ import annotations

import io
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import pyproj
import pytest
from osgeo import gdal
from PIL import Image
from terrainav.core.elevation.datum import Datum
from terrainav.core.elevation.heights import HeightOptions
from terrainav.core.elevation.layered import open_relief
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.raster import source as raster_source
from terrainav.core.imagery.raster.reading import GdalFile, RasterioFile

from tests.support import rasters

#: 2 m pixels in UTM 18 N, and 6" ones in degrees.
UTM, DEGREES = (320_000.0, 2.0, 0.0, 4_298_000.0, 0.0, -2.0), (-77.0, 1 / 600, 0.0, 38.9, 0.0, -1 / 600)
ROWS, COLUMNS = 60, 80
RNG = np.random.default_rng(5)
HEIGHTS = RNG.normal(100.0, 20.0, (ROWS, COLUMNS)).astype(np.float32)


def written(path, values=HEIGHTS, geotransform=UTM, crs=32618, **how):
    how.setdefault("data_type", gdal.GDT_Float32)
    return str(rasters.write(path, np.asarray(values)[np.newaxis], geotransform, crs, **how))


def asked(texts, lat, lon, cell_m=0.0, **options):
    """Heights that sources have together at positions."""
    relief = open_relief(texts, HeightOptions(**options))
    surface = relief.surface(lat, lon, cell_m)
    return surface.heights(*surface.position(lat, lon)), relief


def places(crs, column, row, geotransform=UTM):
    """Latitudes and longitudes of columns and rows that count from the outer corner of the first pixel."""
    to_degrees = pyproj.Transformer.from_crs(crs, 4326, always_xy=True)
    x0, dx, _, y0, _, dy = geotransform
    lon, lat = to_degrees.transform(x0 + dx * np.asarray(column), y0 + dy * np.asarray(row))
    return np.asarray(lat), np.asarray(lon)


def bilinear(values, column, row):
    """Heights between pixels' centres, worked out with numpy alone."""
    x, y = np.asarray(column) - 0.5, np.asarray(row) - 0.5
    j, i = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - j, y - i
    values = np.asarray(values, np.float64)
    upper = values[i, j] * (1 - u) + values[i, j + 1] * u
    return upper * (1 - v) + (values[i + 1, j] * (1 - u) + values[i + 1, j + 1] * u) * v


@pytest.mark.parametrize(
    ("geotransform", "crs"),
    [(UTM, 32618), (DEGREES, 4326), (DEGREES, 4258), ((-1000.0, 2.0, 0.0, 900.0, 0.0, -2.0), 3031)],
    ids=["UTM", "degrees", "ETRS89", "about the South Pole"],
)
@pytest.mark.parametrize("data_type", [gdal.GDT_Float32, gdal.GDT_Float64, gdal.GDT_Int16, gdal.GDT_Int32])
def test_heights_are_bilinear_between_the_pixels_of_the_files_own_crs(tmp_path, geotransform, crs, data_type):
    values = np.rint(HEIGHTS) if data_type in (gdal.GDT_Int16, gdal.GDT_Int32) else HEIGHTS
    path = written(tmp_path / "dem.tif", values, geotransform, crs, data_type=data_type)
    column, row = RNG.uniform(1.0, COLUMNS - 1.0, 200), RNG.uniform(1.0, ROWS - 1.0, 200)
    found, _ = asked([path], *places(crs, column, row, geotransform))
    # Positions in degrees are a nanometre's, and slopes some tens of metres a pixel.
    assert found == pytest.approx(bilinear(values, column, row), abs=2e-5)


def test_a_file_in_degrees_across_the_antimeridian_is_one(tmp_path):
    across = (179.95, 1 / 600, 0.0, 10.0, 0.0, -1 / 600)
    path = written(tmp_path / "dem.tif", HEIGHTS, across, 4326)
    column, row = np.array([10.2, 29.9, 30.4, 70.0]), np.array([5.0, 20.3, 30.0, 50.7])
    lat, lon = 10.0 - row / 600, 179.95 + column / 600
    wanted = bilinear(HEIGHTS, column, row)
    for turn in (0.0, -360.0):
        found, _ = asked([path], lat, lon + turn)
        assert found == pytest.approx(wanted, abs=1e-4)


def test_coarser_cells_are_means_of_the_finer(tmp_path):
    values = np.kron(HEIGHTS, np.ones((8, 8))) + RNG.normal(0.0, 1.0, (8 * ROWS, 8 * COLUMNS))
    path = written(tmp_path / "dem.tif", values)
    means = values.reshape(2 * ROWS, 4, 2 * COLUMNS, 4).mean(axis=(1, 3))
    column, row = np.array([10, 70, 150]), np.array([5, 60, 110])
    lat, lon = places(32618, 4.0 * column + 2.0, 4.0 * row + 2.0)
    found, relief = asked([path], lat, lon, 8.1)
    surface = relief.surface(lat, lon, 8.1)
    assert surface.grid.pixel_size(surface.zoom) == pytest.approx((8.0, 8.0))
    assert found == pytest.approx(means[row, column], abs=1e-3)


@pytest.mark.parametrize("library", [GdalFile, RasterioFile])
def test_values_are_scaled_as_the_file_says(tmp_path, monkeypatch, library):
    if library is RasterioFile:
        pytest.importorskip("rasterio", reason="rasterio is the extra `raster`")
    monkeypatch.setattr(raster_source, "opener", lambda: library)
    path = written(tmp_path / "scaled.tif", np.round((HEIGHTS - 50.0) / 0.01), data_type=gdal.GDT_Int32)
    dataset = gdal.Open(path, gdal.GA_Update)
    dataset.GetRasterBand(1).SetScale(0.01)
    dataset.GetRasterBand(1).SetOffset(50.0)
    dataset = None
    column, row = RNG.uniform(1.0, COLUMNS - 1.0, 50), RNG.uniform(1.0, ROWS - 1.0, 50)
    found, _ = asked([path], *places(32618, column, row))
    assert found == pytest.approx(bilinear(HEIGHTS, column, row), abs=0.006)


@pytest.mark.parametrize("void", [-9999.0, -32768.0, 3.4e38])
def test_values_that_stand_for_no_data_elsewhere_are_no_heights(tmp_path, void):
    holed = HEIGHTS.copy()
    holed[20:30, 30:50] = void
    lat, lon = places(32618, np.array([40.0]), np.array([25.0]))
    with pytest.raises(
        InvalidInput,
        match=f"^void.tif: height {void:g} m at latitude .* stands for no data".replace("+", r"\+"),
    ):
        asked([written(tmp_path / "void.tif", holed)], lat, lon)
    found, _ = asked([written(tmp_path / "said.tif", holed, nodata=void), "3"], lat, lon)
    assert found == pytest.approx(3.0)


def test_what_one_source_does_not_have_the_next_one_fills(tmp_path):
    holed = HEIGHTS.copy()
    holed[20:30, 30:50] = -9999.0
    first = written(tmp_path / "first.tif", holed, nodata=-9999.0)
    second = written(tmp_path / "second.tif", np.full((40, 40), 7.0), (319_000.0, 100.0, 0.0, 4_299_000.0, 0.0, -100.0))
    column, row = np.array([10.5, 40.5, 79.9, 200.0]), np.array([10.5, 25.5, 30.0, 30.0])
    lat, lon = places(32618, column, row)
    alone, _ = asked([first], lat, lon)
    assert np.isnan(alone).tolist() == [False, True, True, True]
    found, relief = asked([first, second], lat, lon)
    assert found[0] == pytest.approx(HEIGHTS[10, 10])
    assert found[[1, 3]] == pytest.approx(7.0)
    # Between the last pixels of one and the first of the other lies what is between their heights.
    assert min(7.0, HEIGHTS.min()) <= found[2] <= HEIGHTS.max()
    surface = relief.surface(*places(32618, [20.5, 60.5], [10.5, 40.5]))
    assert np.count_nonzero(surface.holes) == 200
    hole_lat, hole_lon = surface.places(*np.nonzero(surface.holes)[::-1])
    to_utm = pyproj.Transformer.from_crs(4326, 32618, always_xy=True)
    x, y = np.array(to_utm.transform(hole_lon, hole_lat)) - [[UTM[0]], [UTM[3]]]
    wanted = {(row, column) for row in range(20, 30) for column in range(30, 50)}
    assert set(zip((-y / 2.0).astype(int).tolist(), (x / 2.0).astype(int).tolist())) == wanted
    level, _ = asked([first, "12.5"], lat, lon)
    assert level[[1, 3]].tolist() == [12.5, 12.5]


@pytest.mark.parametrize("step", [1.0 / 3600.0, 1.5 / 3600.0])
@pytest.mark.parametrize("kind", ["list", "vrt"])
def test_files_beside_each_other_are_one_surface(tmp_path, step, kind):
    """As Copernicus GLO-30 is cut: centres of pixels lie on whole seconds, in longitude on fewer from 50 degrees on."""
    north = 61.0 if step > 1.0 / 3600.0 else 36.0

    def made(west):
        lon, lat = west + np.arange(50) * step, north - np.arange(40) / 3600.0
        values = 100.0 + 30.0 * np.sin(lon * 400.0) * np.cos(lat[:, np.newaxis] * 500.0)
        geotransform = (west - step / 2.0, step, 0.0, north + 0.5 / 3600.0, 0.0, -1.0 / 3600.0)
        return written(
            tmp_path / f"{west}.tif", values, geotransform, 4326, tags={"AREA_OR_POINT": "Point"}
        ), values.astype(np.float32)

    (first, left), (second, right) = made(11.0 - 50.0 * step), made(11.0)
    names = [first, second]
    if kind == "vrt":
        names = [str(tmp_path / "both.vrt")]
        gdal.BuildVRT(names[0], [first, second])
    column, row = RNG.uniform(45.0, 55.0, 300), RNG.uniform(5.0, 35.0, 300)
    lon, lat = 11.0 + (column - 50.0) * step, north - row / 3600.0
    found, _ = asked(names, lat, lon)
    assert found == pytest.approx(bilinear(np.hstack([left, right]), column + 0.5, row + 0.5), abs=1e-3)
    # Nor does a file reach farther than its pixels.
    beyond, _ = asked([*names, "7"], np.array([north - 20.0 / 3600.0]), np.array([11.0 + 53.0 * step]))
    assert beyond == pytest.approx(7.0)


def test_heights_over_a_geoid_are_taken_to_the_ellipsoid(tmp_path):
    column, row = RNG.uniform(1.0, COLUMNS - 1.0, 50), RNG.uniform(1.0, ROWS - 1.0, 50)
    for crs, options in (
        ("EPSG:32618+5773", {}),
        (32618, {"datum": "EGM96"}),
        (32618, {"datum": "epsg:5773"}),
    ):
        path = written(tmp_path / f"{len(options)}.tif", crs=crs)
        lat, lon = places(32618, column, row)
        found, _ = asked([path], lat, lon, **options)
        over = pyproj.Transformer.from_crs("EPSG:4326+5773", 4979, always_xy=True)
        geoid = over.transform(lon, lat, np.zeros_like(lat))[2]
        assert abs(geoid.mean()) > 20.0
        assert found == pytest.approx(bilinear(HEIGHTS, column, row) + geoid, abs=1e-2)


@pytest.mark.filterwarnings("ignore:Best transformation")
def test_a_geoid_without_its_grid_is_named():
    group = pyproj.transformer.TransformerGroup("EPSG:4326+3855", 4979, always_xy=True, allow_ballpark=False)
    if group.transformers:
        pytest.skip("PROJ has the grid of EGM2008 here")
    with pytest.raises(InvalidInput, match=r"EGM2008 height: PROJ has no way .* lacks the grid .*egm0?8"):
        Datum.named("EGM2008")


@pytest.mark.parametrize(
    ("crs", "options", "unit_m"),
    [
        ("EPSG:32618+8228", {}, 0.3048),
        ("EPSG:2263+6360", {}, 1200 / 3937),
        (32618, {"unit": "ft"}, 0.3048),
        (2263, {"unit": "us-ft"}, 1200 / 3937),
        (2263, {"unit": "m"}, 1.0),
        (32618, {"offset_m": -3.25}, 1.0),
    ],
)
def test_heights_in_feet_and_offsets(tmp_path, crs, options, unit_m):
    geotransform = (980_000.0, 6.0, 0.0, 200_000.0, 0.0, -6.0) if "2263" in str(crs) else UTM
    path = written(tmp_path / "dem.tif", HEIGHTS, geotransform, crs)
    horizontal = 2263 if "2263" in str(crs) else 32618
    # NAVD88 needs a grid that is not here: its heights are read as if over the ellipsoid.
    options = {"datum": "ellipsoid", **options} if "+" in str(crs) else options
    lat, lon = places(horizontal, [20.5], [30.5], geotransform)
    found, _ = asked([path], lat, lon, **options)
    assert found[0] == pytest.approx(HEIGHTS[30, 20] * unit_m + options.get("offset_m", 0.0), abs=1e-3)


def test_a_file_in_feet_that_does_not_say_so_of_its_heights_is_asked_about(tmp_path):
    path = written(tmp_path / "dem.tif", HEIGHTS, (980_000.0, 6.0, 0.0, 200_000.0, 0.0, -6.0), 2263)
    with pytest.raises(InvalidInput, match="US survey foot, and it does not say whether its heights are in metres"):
        open_relief([path])


@pytest.mark.parametrize("value", [-32768.0, 1e20, -99999.0])
def test_values_that_no_ground_has_are_named_with_their_place(tmp_path, value):
    wrong = HEIGHTS.copy()
    wrong[5, 7] = value
    path = written(tmp_path / "dem.tif", wrong)
    lat, lon = places(32618, [7.5], [5.5])
    with pytest.raises(InvalidInput, match=rf"latitude {lat[0]:.6f}, longitude {lon[0]:.6f}: must be from"):
        asked([path], lat, lon)


def test_infinite_and_missing_values_are_holes(tmp_path):
    holed = HEIGHTS.copy()
    holed[5, 7], holed[5, 20], holed[5, 40] = np.nan, np.inf, -np.inf
    path = written(tmp_path / "dem.tif", holed)
    found, _ = asked([path], *places(32618, [7.5, 20.5, 40.5, 60.5], [5.5] * 4))
    assert np.isnan(found).tolist() == [True, True, True, False]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("osm", "is a source of images"),
        ("nowhere", "'nowhere': no such source is known"),
        ("missing.tif", "there is no such file"),
        ("99999", "height 99999 m: must be from -12000 to 9500"),
        (
            "terrarium:https://tiles.example/{z}/{x}/{y}.png#maxzoom=high",
            "maxzoom 'high' must be a whole number",
        ),
    ],
)
def test_what_names_no_heights_is_refused(text, said):
    with pytest.raises(InvalidInput, match=said):
        open_relief([text])


def test_a_picture_is_no_relief(tmp_path):
    path = str(rasters.write(tmp_path / "photo.tif", np.zeros((3, 50, 50), np.uint8), UTM, 32618))
    with pytest.raises(InvalidInput, match="its values are no heights"):
        open_relief([path])


def encoded_terrarium(heights):
    value = np.rint((heights + 32768.0) * 256.0).astype(np.int64)
    return np.stack([value >> 16, value >> 8 & 255, value & 255], axis=-1).astype(np.uint8)


def encoded_terrain_rgb(heights):
    value = np.rint((heights + 10000.0) * 10.0).astype(np.int64)
    return np.stack([value >> 16, value >> 8 & 255, value & 255], axis=-1).astype(np.uint8)


@pytest.mark.parametrize(
    ("encoding", "encode", "step_m"),
    [("terrarium", encoded_terrarium, 1 / 256), ("terrain-rgb", encoded_terrain_rgb, 0.1)],
)
def test_tiles_with_encoded_heights_over_http(encoding, encode, step_m):
    """Heights that are a plane on the map, a kilometre high and below the sea."""

    def height(zoom, column, row):
        return 1000.0 * (column / 2.0**zoom / 256.0) - 1200.0 * (row / 2.0**zoom / 256.0)

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            zoom, x, y = (int(part) for part in self.path[1:-4].split("/"))
            column, row = np.meshgrid(x * 256 + np.arange(256) + 0.5, y * 256 + np.arange(256) + 0.5)
            body = io.BytesIO()
            Image.fromarray(encode(height(zoom, column, row))).save(body, "PNG")
            self.send_response(200)
            self.send_header("Content-Type", "image/png")
            self.send_header("Content-Length", str(len(body.getvalue())))
            self.end_headers()
            self.wfile.write(body.getvalue())

        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        address = f"{encoding}:http://127.0.0.1:{server.server_port}/{{z}}/{{x}}/{{y}}.png#maxzoom=12"
        lat, lon = np.array([40.0, 40.05, 39.97]), np.array([179.9, 180.1, 180.02])
        relief = open_relief([address])
        surface = relief.surface(lat, lon)
        assert surface.zoom == 12
        found = surface.heights(*surface.position(lat, lon))
        v = 0.5 - np.arcsinh(np.tan(np.radians(lat))) / (2 * np.pi)
        east = np.mod(lon / 360.0 + 0.5, 1.0) * 2.0**12 * 256
        # Where the map begins anew the plane of the test falls by a kilometre.
        wanted = height(12, east, v * 2.0**12 * 256)
        assert found == pytest.approx(wanted, abs=step_m)
    finally:
        server.shutdown()
        server.server_close()


_GEOGRAPHIC = pyproj.CRS.from_epsg(4326).to_wkt()
_DEPTH = 'VERTCRS["EGM96 depth",VDATUM["EGM96 geoid",ID["EPSG",5171]],CS[vertical,1],AXIS["depth",down],{unit}]'


def _compound(vertical):
    return f'COMPOUNDCRS["x",{pyproj.CRS.from_epsg(32618).to_wkt()},{vertical}]'


def _described(path, system):
    """Give a raster a coordinate reference system by the file beside it, as GDAL does that cannot write it inside."""
    import html

    Path(path + ".aux.xml").write_text(f"<PAMDataset><SRS>{html.escape(system)}</SRS></PAMDataset>")
    return path


@pytest.mark.parametrize("library", [GdalFile, RasterioFile])
@pytest.mark.parametrize(
    ("unit", "unit_m"),
    [('LENGTHUNIT["metre",1]', 1.0), ('LENGTHUNIT["foot",0.3048]', 0.3048)],
    ids=["m", "ft"],
)
def test_values_along_an_axis_that_points_down_are_depths(tmp_path, monkeypatch, library, unit, unit_m):
    if library is RasterioFile:
        pytest.importorskip("rasterio", reason="rasterio is the extra `raster`")
    monkeypatch.setattr(raster_source, "opener", lambda: library)
    system = _compound(_DEPTH.replace("{unit}", unit))
    assert pyproj.CRS.from_wkt(system).sub_crs_list[1].axis_info[0].direction == "down"
    path = _described(written(tmp_path / "dem.tif", HEIGHTS, crs=None), system)
    column, row = RNG.uniform(1.0, COLUMNS - 1.0, 50), RNG.uniform(1.0, ROWS - 1.0, 50)
    lat, lon = places(32618, column, row)
    found, _ = asked([path], lat, lon)
    vertical = _DEPTH.replace("{unit}", unit)
    to_ellipsoid = pyproj.Transformer.from_crs(f'COMPOUNDCRS["y",{_GEOGRAPHIC},{vertical}]', 4979, always_xy=True)
    wanted = to_ellipsoid.transform(lon, lat, bilinear(HEIGHTS, column, row))[2]
    assert found == pytest.approx(wanted, abs=0.02)
    assert (wanted - to_ellipsoid.transform(lon, lat, 0.0 * lat)[2] < 0.0).all()
    # A unit of the user's is one of depths, too.
    found, _ = asked([path], lat, lon, unit="us-ft")
    wanted = to_ellipsoid.transform(lon, lat, bilinear(HEIGHTS, column, row) * (1200.0 / 3937.0) / unit_m)[2]
    assert found == pytest.approx(wanted, abs=0.02)
    with pytest.raises(InvalidInput, match=r"^dem\.tif: its vertical axis points down, and that of EGM96 height up"):
        asked([path], lat, lon, datum="EGM96")


def test_heights_named_by_the_code_of_depths_are_depths(tmp_path, monkeypatch):
    path = written(tmp_path / "dem.tif")
    column, row = np.array([10.0, 60.0]), np.array([20.0, 30.0])
    # PROJ has no way from any code of depths to the ellipsoid here: that of EGM96 stands in for it.
    monkeypatch.setattr(Datum, "check", lambda _: None)
    datum = Datum.named("EPSG:5715", 0.3048)
    assert datum.unit_m == -0.3048
    assert Datum.named("EGM96", 0.3048).unit_m == 0.3048
    monkeypatch.setattr(Datum, "heights_m", lambda _, lat, __: np.full(np.shape(lat), 7.0))
    found, _ = asked([path], *places(32618, column, row), datum="EPSG:5715")
    assert found == pytest.approx(7.0 - bilinear(HEIGHTS, column, row), abs=1e-4)


def test_a_file_of_heights_is_no_file_of_depths(tmp_path, monkeypatch):
    monkeypatch.setattr(Datum, "check", lambda _: None)
    path = _described(written(tmp_path / "dem.tif", crs=None), _compound(pyproj.CRS.from_epsg(5773).to_wkt()))
    with pytest.raises(InvalidInput, match=r"^dem\.tif: its vertical axis points up, and that of MSL depth down"):
        asked([path], *places(32618, np.array([10.0]), np.array([20.0])), datum="EPSG:5715")


@pytest.mark.parametrize("unit", ["0", "-1"])
def test_units_of_heights_that_are_none_are_refused(tmp_path, unit):
    vertical = f'VERTCRS["v",VDATUM["v"],CS[vertical,1],AXIS["h",up],LENGTHUNIT["x",{unit}]]'
    path = _described(written(tmp_path / "dem.tif", crs=None), _compound(vertical))
    with pytest.raises(InvalidInput, match=f"unit 'x' of {unit}: must be greater than 0"):
        asked([path], *places(32618, np.array([10.0]), np.array([20.0])))


@pytest.mark.parametrize(("scale", "offset"), [(0.0, 1.0), (np.nan, 0.0), (np.inf, 0.0), (1.0, np.nan)])
def test_a_scale_that_leaves_no_heights_is_refused(tmp_path, scale, offset):
    path = written(tmp_path / "dem.tif")
    dataset = gdal.Open(path, gdal.GA_Update)
    dataset.GetRasterBand(1).SetScale(scale)
    dataset.GetRasterBand(1).SetOffset(offset)
    dataset = None
    with pytest.raises(InvalidInput, match=r"^dem\.tif: its heights have the scale .*: must be finite"):
        asked([path], *places(32618, np.array([10.0]), np.array([20.0])))


@pytest.mark.parametrize("nodata", [None, -32768.0])
def test_a_scaled_band_s_stored_void_is_no_ground(tmp_path, nodata):
    stored = np.rint(HEIGHTS * 10.0)
    stored[20:30, 30:50] = -9999.0
    path = written(tmp_path / "dem.tif", stored, data_type=gdal.GDT_Int16, nodata=nodata)
    dataset = gdal.Open(path, gdal.GA_Update)
    dataset.GetRasterBand(1).SetScale(0.1)
    dataset = None
    lat, lon = places(32618, np.array([40.0]), np.array([25.0]))
    if nodata is None:
        with pytest.raises(InvalidInput, match=r"^dem\.tif: height -999\.9 m at .*stands for no data"):
            asked([path], lat, lon)
    else:
        # Another value stands for no data: this one is a height.
        found, _ = asked([path], lat, lon)
        assert found == pytest.approx([-999.9], abs=1e-3)
