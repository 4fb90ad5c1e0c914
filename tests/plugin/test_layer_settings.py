"""What a layer's properties change of its pixels holds in captures as on the map: held against QGIS's own rendering."""

from __future__ import annotations

import numpy as np
import pytest
from osgeo import gdal, osr
from pyproj import Transformer
from qgis.core import (
    Qgis,
    QgsBilinearRasterResampler,
    QgsCategorizedSymbolRenderer,
    QgsColorRampShader,
    QgsContrastEnhancement,
    QgsCoordinateReferenceSystem,
    QgsCubicRasterResampler,
    QgsDateTimeRange,
    QgsFeature,
    QgsFillSymbol,
    QgsGeometry,
    QgsHillshadeRenderer,
    QgsHueSaturationFilter,
    QgsLineSymbol,
    QgsMapRendererSequentialJob,
    QgsMapSettings,
    QgsMeshLayer,
    QgsPalettedRasterRenderer,
    QgsProject,
    QgsProperty,
    QgsRasterContourRenderer,
    QgsRasterDataProvider,
    QgsRasterLayer,
    QgsRasterMinMaxOrigin,
    QgsRasterPipe,
    QgsRasterRange,
    QgsRasterShader,
    QgsRasterTransparency,
    QgsRectangle,
    QgsRendererCategory,
    QgsSingleBandGrayRenderer,
    QgsSingleBandPseudoColorRenderer,
    QgsVectorFileWriter,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QDate, QDateTime, QSize, QTime
from qgis.PyQt.QtGui import QColor, QImage, QPainter
from terrainav.core.errors import InvalidInput, PartError
from terrainav.core.geodesy.mercator import HALF_WORLD_M
from terrainav.core.imagery.source import Window
from terrainav.terrainav_plugin.qgis_source.renderer import Jobs, to_array
from terrainav.terrainav_plugin.qgis_source.snapshot import (
    PROJECT_SOURCE,
    grid_of_layers,
    source_name,
    take_snapshot,
)
from terrainav.terrainav_plugin.qgis_source.source import LayerSource

from tests.plugin.test_qgis_source import box_wkt, off_the_main_thread, picture
from tests.support.thinning import sampled

SIZE_PX, WEST, NORTH = 600, 465_050.0, 5_247_406.0
PAPER = QColor(150, 200, 100)
#: Over the edges of tiles, and of no raster's; on the coarser grid that QGIS draws contours on.
WINDOW = (176, 168, 200, 192)
#: Pixels that QGIS draws around what is looked at: slopes at the edge of its own picture are others.
AROUND = 32
FLAT, NODATA = 90, 40


def write(path, bands, kind, nodata=None):
    """GeoTIFF of smooth waves in UTM 32 N at a metre a pixel, with a square of `FLAT` and one of `NODATA`."""
    file = gdal.GetDriverByName("GTiff").Create(str(path), SIZE_PX, SIZE_PX, bands, kind)
    file.SetGeoTransform((WEST, 1.0, 0.0, NORTH, 0.0, -1.0))
    crs = osr.SpatialReference()
    crs.ImportFromEPSG(32632)
    file.SetProjection(crs.ExportToWkt())
    rows, columns = np.mgrid[:SIZE_PX, :SIZE_PX]
    for band in range(bands):
        waves = 140.0 + 90.0 * np.sin(columns / (17.0 + 5.0 * band)) * np.cos(rows / (23.0 - 4.0 * band))
        waves[200:230, 190:280], waves[300:330, 240:300] = FLAT, NODATA
        file.GetRasterBand(band + 1).WriteArray(waves if kind == gdal.GDT_Float32 else np.rint(waves))
        if nodata is not None:
            file.GetRasterBand(band + 1).SetNoDataValue(nodata)
    return path


def layer_of(tmp_path, bands=3, nodata=None):
    path = write(tmp_path / f"{bands}.tif", bands, gdal.GDT_Float32 if bands == 1 else gdal.GDT_Byte, nodata)
    QgsProject.instance().setBackgroundColor(PAPER)
    return QgsProject.instance().addMapLayer(QgsRasterLayer(str(path), "layer", "gdal"))


def shown_by_qgis(layers, extent, size, background, crs=None):
    settings = QgsMapSettings()
    settings.setLayers(layers)
    settings.setDestinationCrs(QgsCoordinateReferenceSystem(crs) if crs else layers[0].crs())
    settings.setExtent(extent.buffered(AROUND * extent.width() / size[0]))
    settings.setOutputSize(QSize(*(side + 2 * AROUND for side in size)))
    settings.setOutputImageFormat(QImage.Format.Format_ARGB32_Premultiplied)
    settings.setBackgroundColor(background)
    settings.setOutputDpi(96)
    job = QgsMapRendererSequentialJob(settings)
    job.start()
    job.waitForFinished()
    assert not job.errors()
    return to_array(job.renderedImage()).astype(int)[AROUND:-AROUND, AROUND:-AROUND]


def captured(layer, zoomed_in=0, window=WINDOW, source_of=source_name):
    """Colours of a window, (height, width, 3), and where there are any; and the window's extent and size."""
    source = LayerSource(take_snapshot(source_of(layer), QgsProject.instance()))
    left, top, width, height = (value << zoomed_in for value in window)
    asked = Window(source.grid.native_zoom + zoomed_in, left, top, width, height)

    def work():
        pixels = np.zeros((height, width, 4), np.uint8)
        for part in source.parts(asked):
            try:
                tile = source.fetch("", part.window)
            except PartError:
                continue
            tile = tile if tile.shape[2] == 4 else np.dstack([tile, np.full(tile.shape[:2], 255, np.uint8)])
            x, y = max(part.dx_px, 0), max(part.dy_px, 0)
            cut = tile[y - part.dy_px :, x - part.dx_px :][: height - y, : width - x]
            pixels[y : y + cut.shape[0], x : x + cut.shape[1]] = cut
        return pixels

    try:
        pixels = off_the_main_thread(work)
    finally:
        source.close()
    west, north = WEST + window[0], NORTH - window[1]
    extent = QgsRectangle(west, north - window[3], west + window[2], north)
    return pixels[..., :3].astype(int), pixels[..., 3] > 0, extent, (width, height)


def hold_against_qgis(layer, *, differ=0, share=0.0, **how):
    """A capture is what QGIS shows: all of it, but for a ``share`` of pixels, within a difference of colours."""
    colours, there, extent, size = captured(layer, **how)
    expected = shown_by_qgis([layer], extent, size, PAPER)[..., :3]
    covered = shown_by_qgis([layer], extent, size, QColor(0, 0, 0, 0))[..., 3] > 0
    assert (there != covered).mean() <= share
    off = np.abs(colours - expected).max(axis=-1) > differ
    assert (off & there & covered).mean() <= share
    return colours, there


def no_data(values, unticked=False):
    def set_no_data(layer):
        provider = layer.dataProvider()
        for band in range(1, layer.bandCount() + 1):
            provider.setUserNoDataValue(band, [QgsRasterRange(*one) for one in values])
            provider.setUseSourceNoDataValue(band, not unticked)

    return set_no_data


def transparent_values(layer):
    pixel = QgsRasterTransparency.TransparentThreeValuePixel()
    pixel.red = pixel.green = pixel.blue = FLAT
    pixel.percentTransparent = 60.0
    transparency = QgsRasterTransparency()
    transparency.setTransparentThreeValuePixelList([pixel])
    layer.renderer().setRasterTransparency(transparency)


def no_data_colour(layer):
    no_data([(FLAT, FLAT)])(layer)
    layer.renderer().setNodataColor(QColor(250, 10, 10))


def other_bands(layer):
    renderer = layer.renderer()
    renderer.setRedBand(3)
    renderer.setBlueBand(1)


def alpha_band(layer):
    layer.renderer().setAlphaBand(2)


def stretched(layer):
    for band, colour in enumerate(("Red", "Green", "Blue"), 1):
        contrast = QgsContrastEnhancement(layer.dataProvider().dataType(band))
        contrast.setMinimumValue(80.0 + band)
        contrast.setMaximumValue(180.0 + band)
        contrast.setContrastEnhancementAlgorithm(
            QgsContrastEnhancement.ContrastEnhancementAlgorithm.StretchToMinimumMaximum
        )
        getattr(layer.renderer(), f"set{colour}ContrastEnhancement")(contrast)


def light(layer):
    light = layer.brightnessFilter()
    light.setBrightness(20)
    light.setContrast(-30)
    light.setGamma(1.7)


def saturated(layer):
    layer.hueSaturationFilter().setSaturation(60)


def colourised(layer):
    hue = layer.hueSaturationFilter()
    hue.setColorizeOn(True)
    hue.setColorizeColor(QColor(30, 90, 220))
    hue.setColorizeStrength(70)


def grey(layer):
    layer.hueSaturationFilter().setGrayscaleMode(QgsHueSaturationFilter.GrayscaleMode.GrayscaleLuminosity)


def inverted(layer):
    if not hasattr(layer.hueSaturationFilter(), "setInvertColors"):
        pytest.skip("colours are inverted from QGIS 3.24 on")
    layer.hueSaturationFilter().setInvertColors(True)


def translucent(layer):
    layer.setOpacity(0.4)


def opacity_by_expression(layer):
    layer.pipe().dataDefinedProperties().setProperty(
        QgsRasterPipe.Property.RendererOpacity, QgsProperty.fromExpression("20 + 10")
    )


def multiplied(layer):
    layer.setBlendMode(QPainter.CompositionMode.CompositionMode_Multiply)


def seen_from_near(layer):
    layer.setScaleBasedVisibility(True)
    layer.setMinimumScale(10_000.0)


def seen_from_afar(layer):
    layer.setScaleBasedVisibility(True)
    layer.setMaximumScale(10_000.0)


def grey_of_one_band(layer):
    layer.setRenderer(QgsSingleBandGrayRenderer(layer.dataProvider(), 2))


def palette(layer):
    classes = [
        QgsPalettedRasterRenderer.Class(value, QColor(value, 255 - value, 3 * value % 256), str(value))
        for value in range(0, 256, 2)
    ]
    layer.setRenderer(QgsPalettedRasterRenderer(layer.dataProvider(), 1, classes))


@pytest.mark.parametrize(
    ("change", "differ"),
    sampled(
        [
            (lambda _layer: None, 0),
            (no_data([(FLAT, FLAT)]), 0),
            (no_data([(60, 80), (200, 210)]), 0),
            (transparent_values, 1),
            (no_data_colour, 0),
            (other_bands, 0),
            (alpha_band, 2),
            (stretched, 0),
            (light, 0),
            (saturated, 0),
            (colourised, 0),
            (grey, 0),
            (inverted, 0),
            (translucent, 2),
            (opacity_by_expression, 2),
            (multiplied, 1),
            (seen_from_near, 0),
            (seen_from_afar, 0),
            (grey_of_one_band, 0),
            (palette, 0),
        ],
        3,
    ),
)
def test_photo_is_captured_as_qgis_shows_it(tmp_path, change, differ):
    layer = layer_of(tmp_path)
    change(layer)
    hold_against_qgis(layer, differ=differ)


@pytest.mark.parametrize("unticked", [False, True])
@pytest.mark.parametrize("more", [[], [(FLAT, FLAT)]])
def test_no_data_of_the_file_counts_where_it_is_ticked(tmp_path, unticked, more):
    layer = layer_of(tmp_path, nodata=NODATA)
    no_data(more, unticked=unticked)(layer)
    _, there = hold_against_qgis(layer)
    assert there.all() == (unticked and not more)


def ramp(layer):
    shader, colours = QgsRasterShader(), QgsColorRampShader(0.0, 255.0)
    colours.setColorRampType(QgsColorRampShader.Type.Interpolated)
    items = [(40.0, QColor(0, 0, 90)), (120.0, QColor(200, 240, 20)), (240.0, QColor(255, 255, 255))]
    colours.setColorRampItemList([QgsColorRampShader.ColorRampItem(*item) for item in items])
    shader.setRasterShaderFunction(colours)
    layer.setRenderer(QgsSingleBandPseudoColorRenderer(layer.dataProvider(), 1, shader))


def hillshade(layer):
    layer.setRenderer(QgsHillshadeRenderer(layer.dataProvider(), 1, 315.0, 45.0))


def several_hillshades(layer):
    hillshade(layer)
    layer.renderer().setMultiDirectional(True)
    layer.renderer().setZFactor(3.0)


def contours(layer):
    renderer = QgsRasterContourRenderer(layer.dataProvider())
    renderer.setContourInterval(40.0)
    # A renderer that is made anew has a colour of chance.
    for name in ("setContourSymbol", "setContourIndexSymbol"):
        getattr(renderer, name)(QgsLineSymbol.createSimple({"color": "200,30,60,255", "width": "0.5"}))
    layer.setRenderer(renderer)


@pytest.mark.parametrize("change", [ramp, hillshade, several_hillshades, contours])
def test_heights_are_captured_as_qgis_shows_them(tmp_path, change):
    """Slopes and contours have no seams where tiles meet."""
    layer = layer_of(tmp_path, bands=1)
    change(layer)
    # What is smoothed may be rounded twice.
    hold_against_qgis(layer, differ=2 if change is contours else 0)


@pytest.mark.parametrize("early", [False, True])
@pytest.mark.parametrize("kind", sampled(["nearest", "bilinear", "cubic"], 2))
@pytest.mark.parametrize("change", [lambda _layer: None, ramp])
def test_enlarged_pixels_are_resampled_as_qgis_does(tmp_path, early, kind, change):
    layer = layer_of(tmp_path, bands=3 if change is not ramp else 1)
    change(layer)
    if early:
        layer.setResamplingStage(Qgis.RasterResamplingStage.Provider)
        layer.dataProvider().enableProviderResampling(True)
        method = getattr(QgsRasterDataProvider.ResamplingMethod, kind.title())
        layer.dataProvider().setZoomedInResamplingMethod(method)
    elif kind != "nearest":
        resampler = QgsBilinearRasterResampler() if kind == "bilinear" else QgsCubicRasterResampler()
        layer.resampleFilter().setZoomedInResampler(resampler)
    # After styling QGIS resamples with weights of a few bits.
    hold_against_qgis(layer, differ=0 if early else 2, zoomed_in=2)


def map_of(_layer):
    return PROJECT_SOURCE


def test_stretch_that_follows_the_map_stays_as_the_map_has_it(tmp_path):
    """Each part drawn in a stretch of its own would have seams; below a vector layer and above one."""
    layer = layer_of(tmp_path, bands=1)
    contrast = QgsContrastEnhancement(layer.dataProvider().dataType(1))
    contrast.setMinimumValue(60.0)
    contrast.setMaximumValue(230.0)
    contrast.setContrastEnhancementAlgorithm(
        QgsContrastEnhancement.ContrastEnhancementAlgorithm.StretchToMinimumMaximum
    )
    layer.renderer().setContrastEnhancement(contrast)
    expected = captured(layer)[0]
    origin = QgsRasterMinMaxOrigin()
    origin.setLimits(QgsRasterMinMaxOrigin.Limits.MinMax)
    origin.setExtent(QgsRasterMinMaxOrigin.Extent.UpdatedCanvas)
    layer.renderer().setMinMaxOrigin(origin)
    assert np.array_equal(captured(layer)[0], expected)
    patch(layer, box_wkt(0.0, 0.0, 1.0, 1.0), below=True)
    found, settings = take_snapshot(PROJECT_SOURCE, QgsProject.instance()), QgsMapSettings()
    assert [one.name() for one in found.drawing] == ["layer", "patch"]
    settings.setDestinationCrs(layer.crs())
    settings.setOutputSize(QSize(50, 50))
    # A small part of it, whose own values have another range.
    settings.setExtent(QgsRectangle(WEST + 200.0, NORTH - 250.0, WEST + 250.0, NORTH - 200.0))
    image = QImage(50, 50, QImage.Format.Format_ARGB32_Premultiplied)
    image.fill(0)
    jobs = Jobs()
    off_the_main_thread(lambda: jobs.draw(image, settings, found.drawing[:1]))
    jobs.close()
    whole = captured(layer, window=(200, 200, 50, 50))[0]
    assert np.array_equal(to_array(image)[..., :3], whole)


def patch(layer, wkt, below=False):
    """Polygon layer of the raster's CRS, above it or below it."""
    one = QgsVectorLayer(f"Polygon?crs={layer.crs().authid()}&field=kind:int", "patch", "memory")
    add_feature(one, wkt, 1)
    QgsProject.instance().addMapLayer(one, False)
    root = QgsProject.instance().layerTreeRoot()
    root.insertLayer(len(root.children()) if below else 0, one)
    return one


def add_feature(layer, wkt, kind):
    feature = QgsFeature(layer.fields())
    feature.setGeometry(QgsGeometry.fromWkt(wkt))
    feature.setAttributes([kind])
    layer.dataProvider().addFeature(feature)
    layer.updateExtents()


def fixed_times(layer, year):
    times, day = layer.temporalProperties(), QDateTime(QDate(year, 6, 1), QTime(0, 0))
    times.setMode(Qgis.RasterTemporalMode.FixedTemporalRange)
    times.setFixedTemporalRange(QgsDateTimeRange(day, day.addDays(1)))
    times.setIsActive(True)


@pytest.mark.parametrize(("year", "shown"), [(2023, True), (2024, False)])
def test_map_of_a_time_is_captured_at_that_time(desk, tmp_path, year, shown):
    layer = layer_of(tmp_path)
    fixed_times(layer, year)
    day = QDateTime(QDate(2023, 6, 1), QTime(0, 0))
    desk.canvas.setTemporalRange(QgsDateTimeRange(day, day.addSecs(3600)))
    try:
        assert captured(layer)[1].all() == shown
        assert captured(layer)[1].any() == shown
    finally:
        desk.canvas.setTemporalRange(QgsDateTimeRange(QDateTime(), QDateTime()))
    assert captured(layer)[1].all()


@pytest.mark.parametrize("source_of", [source_name, map_of])
@pytest.mark.parametrize("is_raster", [True, False])
def test_layer_without_a_crs_is_refused_by_name(tmp_path, source_of, is_raster):
    layer = layer_of(tmp_path) if is_raster else patch(layer_of(tmp_path), box_wkt(0.0, 0.0, 1.0, 1.0))
    layer.setCrs(QgsCoordinateReferenceSystem())
    with pytest.raises(InvalidInput, match=f"layer “{layer.name()}” has no CRS: set it in"):
        grid_of_layers(source_of(layer), QgsProject.instance())


def shapes(layer):
    """Polygons of two kinds over a raster's middle."""
    west, north = WEST + 180.0, NORTH - 180.0
    one = patch(layer, box_wkt(west, north - 90.0, west + 90.0, north))
    add_feature(one, box_wkt(west + 40.0, north - 170.0, west + 180.0, north - 60.0), 2)
    one.renderer().setSymbol(QgsFillSymbol.createSimple({"color": "220,40,30,255", "outline_style": "no"}))
    return one


def by_kind(layer):
    symbols = [
        QgsFillSymbol.createSimple({"color": colour, "outline_style": "no"})
        for colour in ("10,20,230,255", "10,230,20,255")
    ]
    categories = [QgsRendererCategory(kind, symbol, "") for kind, symbol in enumerate(symbols, 1)]
    layer.setRenderer(QgsCategorizedSymbolRenderer("kind", categories))


def other_style(layer):
    layer.styleManager().addStyleFromLayer("before")
    layer.styleManager().setCurrentStyle("before")
    by_kind(layer)


def translucent_features(layer):
    layer.setOpacity(0.5)
    layer.setFeatureBlendMode(QPainter.CompositionMode.CompositionMode_Difference)


def flat(layer):
    """One translucent colour, which is the same whatever pixel of it is the nearest."""
    classes = [QgsPalettedRasterRenderer.Class(value, QColor(120, 180, 90)) for value in range(256)]
    layer.setRenderer(QgsPalettedRasterRenderer(layer.dataProvider(), 1, classes))
    layer.setOpacity(0.6)


def take_to_the_top(layer):
    root = QgsProject.instance().layerTreeRoot()
    node = root.findLayer(layer)
    root.insertChildNode(0, node.clone())
    root.removeChildNode(node)


def hold_map_against_qgis():
    """The whole map, of 200 px in Web Mercator about the middle of the shapes."""
    zoom, size = 17, 200
    px = 2.0 * HALF_WORLD_M / (256 << zoom)
    x, y = Transformer.from_crs(32632, 3857, always_xy=True).transform(WEST + 270.0, NORTH - 270.0)
    left, top = round((x + HALF_WORLD_M) / px) - size // 2, round((HALF_WORLD_M - y) / px) - size // 2
    source = LayerSource(take_snapshot(PROJECT_SOURCE, QgsProject.instance()))
    try:
        shown = picture(source, Window(zoom, left, top, size, size)).astype(int)
    finally:
        source.close()
    west, north = left * px - HALF_WORLD_M, HALF_WORLD_M - top * px
    extent = QgsRectangle(west, north - size * px, west + size * px, north)
    layers = QgsProject.instance().layerTreeRoot().layerOrder()
    expected = shown_by_qgis(layers, extent, (size, size), PAPER, "EPSG:3857")[..., :3]
    # Edges of polygons are smoothed.
    assert (np.abs(shown - expected).max(axis=-1) > 2).mean() < 0.02


@pytest.mark.parametrize("below", [True, False])
@pytest.mark.parametrize(
    "change",
    sampled(
        [
            lambda _layer: None,
            by_kind,
            other_style,
            translucent,
            translucent_features,
            multiplied,
            seen_from_near,
            seen_from_afar,
        ],
        3,
    ),
)
def test_map_of_rasters_and_vectors_is_captured_as_qgis_shows_it(tmp_path, change, below):
    raster = layer_of(tmp_path)
    flat(raster)
    change(shapes(raster))
    if below:
        take_to_the_top(raster)
    hold_map_against_qgis()


def test_features_that_a_filter_leaves_out_are_not_captured(tmp_path):
    """Of a file: layers in memory have filters from QGIS 3.26 on."""
    raster = layer_of(tmp_path)
    flat(raster)
    memory, path = shapes(raster), str(tmp_path / "shapes.gpkg")
    QgsVectorFileWriter.writeAsVectorFormatV3(
        memory, path, QgsProject.instance().transformContext(), QgsVectorFileWriter.SaveVectorOptions()
    )
    QgsProject.instance().removeMapLayer(memory)
    layer = QgsProject.instance().addMapLayer(QgsVectorLayer(path, "filtered", "ogr"))
    by_kind(layer)
    assert layer.setSubsetString('"kind" = 2')
    assert layer.featureCount() == 1
    hold_map_against_qgis()


def test_mesh_is_captured_as_qgis_shows_it(tmp_path):
    corners = [(0.0, 0.0, 10.0), (400.0, 0.0, 60.0), (400.0, 400.0, 20.0), (0.0, 400.0, 90.0)]
    lines = ["MESH2D", *(f"ND {at} {WEST + x} {NORTH - y} {z}" for at, (x, y, z) in enumerate(corners, 1))]
    path = tmp_path / "mesh.2dm"
    path.write_text("\n".join([*lines, "E3T 1 1 2 3 1", "E3T 2 1 3 4 1"]) + "\n")
    layer = QgsMeshLayer(str(path), "mesh", "mdal")
    layer.setCrs(QgsCoordinateReferenceSystem("EPSG:32632"))
    QgsProject.instance().addMapLayer(layer)
    settings = layer.rendererSettings()
    settings.setActiveScalarDatasetGroup(0)
    layer.setRendererSettings(settings)
    layer.setBlendMode(QPainter.CompositionMode.CompositionMode_Multiply)
    QgsProject.instance().setBackgroundColor(PAPER)
    hold_map_against_qgis()
