"""What refusals of sources advise: of layers, QGIS's connections, services and backgrounds."""

from __future__ import annotations

import numpy as np
import pytest
from qgis.core import QgsCoordinateReferenceSystem, QgsProject, QgsRasterLayer, QgsSettings, QgsVectorLayer
from qgis.PyQt.QtWidgets import QDialogButtonBox
from terrainav.core.imagery.catalogue import add, described, user_sources
from terrainav.terrainav_plugin.panel.choices import source_choices
from terrainav.terrainav_plugin.panel.source_dialogs import AddSourceDialog, ServiceDialog
from terrainav.terrainav_plugin.qgis_source.connections import SERVICE_PREFIX, connection
from terrainav.terrainav_plugin.qgis_source.snapshot import (
    PROJECT_SOURCE,
    grid_of_layers,
    source_layers,
    source_name,
)
from terrainav.terrainav_plugin.sources import tile_layer_uri

from tests.plugin.remedies.areas import feature
from tests.plugin.test_background import show
from tests.plugin.test_qgis_source import WINDOW, opened, picture, wmts_service
from tests.plugin.test_source_dialogs import in_dialog
from tests.plugin.test_sources_keys import WMS_SETTINGS, XYZ_SETTINGS, connect_xyz
from tests.plugin.transports import PASSWORD, Server
from tests.support import rasters
from tests.support.remedies import Case, remedy
from tests.support.services import wms_document


@pytest.fixture
def project():
    """The project, whose layers go with the test."""
    yield QgsProject.instance()
    QgsProject.instance().clear()


@remedy("qgis_source/snapshot.py", "the map shows no layer: tick one in the Layers panel")
def _nothing_ticked(case: Case) -> None:
    project = case.fixture("project")
    layer = memory_layer(project)
    node = project.layerTreeRoot().findLayer(layer)
    node.setItemVisibilityChecked(False)
    case.refused(lambda: source_layers(PROJECT_SOURCE, project))
    node.setItemVisibilityChecked(True)
    case.follow("tick one in the Layers panel", lambda: source_layers(PROJECT_SOURCE, project) == [layer])


def memory_layer(project):
    layer = QgsVectorLayer("Point?crs=EPSG:4326", "mine", "memory")
    layer.dataProvider().addFeatures([feature("Point (1 1)")])
    layer.updateExtents()
    project.addMapLayer(layer)
    return layer


@remedy(
    "qgis_source/snapshot.py",
    "source {name}: the project has no such layer (any more); choose another source",
)
def _no_such_layer(case: Case) -> None:
    project = case.fixture("project")
    gone, there = memory_layer(project), memory_layer(project)
    name = source_name(gone)
    project.removeMapLayer(gone.id())
    case.refused(lambda: source_layers(name, project))
    case.follow("choose another source", lambda: source_layers(source_name(there), project) == [there])


@remedy("qgis_source/snapshot.py", "layer {name}: shows nothing; repair its data source")
def _broken_layer(case: Case) -> None:
    project = case.fixture("project")
    path = case.tmp_path / "points.geojson"
    path.write_text('{"type": "Point", "coordinates": [10, 35]}')
    layer = QgsVectorLayer(str(path), "mine", "ogr")
    project.addMapLayer(layer)
    layer.setDataSource(str(path) + ".gone", "mine", "ogr")
    case.refused(lambda: source_layers(source_name(layer), project))
    layer.setDataSource(str(path), "mine", "ogr")
    case.follow("repair its data source", lambda: source_layers(source_name(layer), project) == [layer])


@remedy("qgis_source/snapshot.py", "layer {name}: its place on the globe is not known; set its CRS")
def _unknown_place(case: Case) -> None:
    project = case.fixture("project")
    utm = (505_000.0, 2.0, 0.0, 5_317_000.0, 0.0, -2.0)
    path = rasters.write(case.tmp_path / "r.tif", np.ones((3, 8, 8), np.uint8), utm, 4326)
    layer = QgsRasterLayer(str(path), "mine")
    project.addMapLayer(layer)
    case.refused(lambda: grid_of_layers(source_name(layer), project))
    layer.setCrs(QgsCoordinateReferenceSystem("EPSG:32632"))
    case.follow("set its CRS", lambda: grid_of_layers(source_name(layer), project))


@remedy(
    "qgis_source/tiles.py",
    "layer {name}: its service has tiles of {size} px; choose a layer with tiles of 256, 512 or 1024 px",
)
def _odd_tiles(case: Case) -> None:
    def pictured(tile_px):
        with wmts_service(tile_px) as (_, layer):
            source = opened(source_name(layer))
            try:
                return picture(source, WINDOW)
            finally:
                source.close()

    case.refused(lambda: pictured(768))
    case.follow("choose a layer with tiles of 256", lambda: pictured(256).any())
    case.follow("512", lambda: pictured(512).any())
    case.follow("1024 px", lambda: pictured(1024).any())


# --- connections


@pytest.fixture
def connections():
    """Connections of QGIS, which go with the test."""
    yield
    for root in (XYZ_SETTINGS, WMS_SETTINGS):
        QgsSettings().remove(root)


def entry_of(name):
    return connection(f"qgis:xyz/{name}").entry()


@remedy(
    "qgis_source/connections.py",
    "source {name}: QGIS has no such XYZ connection (any more); choose another source",
)
def _no_such_connection(case: Case) -> None:
    case.fixture("connections")
    connect_xyz("there", url="https://a.example/{z}/{x}/{y}.png")
    case.refused(lambda: entry_of("gone"))
    case.follow("choose another source", lambda: entry_of("there"))


@remedy(
    "qgis_source/connections.py",
    "QGIS connection “{name}” holds a user name and password in plain text: give it an authentication configuration "
    "in QGIS's Browser panel",
)
def _plain_password(case: Case) -> None:
    case.fixture("connections")
    connect_xyz("mine", url="https://a.example/{z}/{x}/{y}.png", username="me", password="word")
    case.refused(lambda: entry_of("mine"))
    case.follow(
        "give it an authentication configuration in QGIS's Browser panel",
        lambda: authenticated(case, url="https://a.example/{z}/{x}/{y}.png"),
    )


def authenticated(case, **told):
    """Give the connection a configuration, as QGIS's Browser panel writes it; what QGIS and a capture then send."""
    QgsSettings().remove(XYZ_SETTINGS)
    authcfg = case.fixture("configured")(PASSWORD)
    connect_xyz("mine", authcfg=authcfg, **told)
    entry_of("mine")
    return f"authcfg={authcfg}" in tile_layer_uri("qgis:xyz/mine", "satellite")


@remedy(
    "qgis_source/connections.py",
    "QGIS connection “{name}” holds keys in its address ({keys}), which would end up in files: take them out of it, "
    "and give it an authentication configuration in QGIS's Browser panel",
)
def _several_keys(case: Case) -> None:
    case.fixture("connections")
    url = "https://a.example/{z}/{x}/{y}.png?v=1"
    connect_xyz("mine", url=url + "&app_id=a&app_code=b")
    said = case.refused(lambda: entry_of("mine"))
    assert "app_id, app_code" in said
    assert "=a" not in said
    case.follow(
        "take them out of it, and give it an authentication configuration in QGIS's Browser panel",
        lambda: authenticated(case, url=url),
    )


@remedy(
    "panel/choices.py",
    "A service with several layers: choose it, then a layer. The layer is saved with your own sources.",
)
def _service_of_layers(case: Case) -> None:
    case.fixture("connections")
    desk = case.fixture("desk")
    crs = "<CRS>EPSG:3857</CRS>"
    with Server() as server:
        layer = f"<Layer><Name>ortho</Name><Title>Orthophoto</Title>{crs}</Layer>"
        body = wms_document("1.3.0", f"{server.url}/wms", f"<Layer><Title>All</Title>{crs}{layer}</Layer>")
        server.answers["/wms"] = (200, {"Content-Type": "text/xml"}, body)
        QgsSettings().setValue(f"{WMS_SETTINGS}/Survey/url", server.url + "/wms")
        choices, _ = source_choices(QgsProject.instance())
        case.says(next(choice.limits for choice in choices if choice.name == SERVICE_PREFIX + "Survey"))
        desk.session.source_list.refresh()

        def choose(dialog):
            desk.wait(lambda: not dialog.notice.text().startswith("Asking"))
            assert dialog.list.count() == 1, dialog.notice.text()
            dialog.list.setCurrentRow(0)
            desk.click(dialog.buttons.button(QDialogButtonBox.StandardButton.Ok))

        wrong = in_dialog(desk, ServiceDialog, choose)
        case.follow("choose it", lambda: desk.choose(desk.form.source, SERVICE_PREFIX + "Survey"))
        assert not wrong, wrong
        case.follow("then a layer", lambda: bool(user_sources()))
    # The dialog closes when the layer is kept.
    (kept,) = user_sources()
    case.follow("The layer is saved with your own sources.", lambda: desk.session.state().source_name == kept.name)


# --- backgrounds


def shown(desk, *chosen):
    """Choose a source and show it on the map."""
    QgsProject.instance().clear()
    desk.choose(desk.form.source, *chosen)
    return show(desk).isValid()


@remedy("sources.py", "{title} has no tiles to show as a background; show another source and come back")
def _no_tiles(case: Case) -> None:
    desk = case.fixture("desk")
    desk.choose(desk.form.source, "google-static")
    desk.click(desk.form.show_on_map)
    case.says("\n".join(desk.messages()))
    case.follow("show another source", lambda: shown(desk, "osm"))
    desk.choose(desk.form.source, "google-static")
    case.follow("and come back", lambda: len(QgsProject.instance().mapLayers()) == 1)


@remedy("sources.py", "{host} needs a key, which would be written into the project file: show another source")
def _keyed(case: Case) -> None:
    desk = case.fixture("desk")
    desk.use_template("https://tiles.example/{z}/{x}/{y}.png?key={key}")
    desk.click(desk.form.show_on_map)
    case.says("\n".join(desk.messages()))
    case.follow("show another source", lambda: shown(desk, "osm"))


@remedy("sources.py", "{title} numbers its zooms differently from QGIS: add its layer with QGIS's Browser panel")
def _other_zooms(case: Case) -> None:
    case.fixture("desk")
    with wmts_service(level="EPSG:3857:{}") as (running, layer):
        levels = [[zoom, f"EPSG:3857:{zoom}"] for zoom in range(20)]
        add("named", {**described(f"{running.url}/tiles/{{z}}/{{x}}/{{y}}.png"), "levels": levels})
        case.refused(lambda: tile_layer_uri("named", "satellite"))
        case.follow("add its layer with QGIS's Browser panel", layer.isValid)


@remedy(
    "sources.py",
    "{title} has tiles in {crs}, which cannot be a background: add its layer with QGIS's Browser panel",
)
def _tiles_of_another_crs(case: Case) -> None:
    case.fixture("desk")
    with wmts_service() as (running, layer):
        plane = {"crs": "EPSG:25832", "west": 0.0, "north": 6e6, "width": 2.0**20, "height": 2.0**20}
        add("named", {**described(f"{running.url}/tiles/{{z}}/{{x}}/{{y}}.png"), "plane": plane})
        case.refused(lambda: tile_layer_uri("named", "satellite"))
        case.follow("add its layer with QGIS's Browser panel", layer.isValid)


@remedy("panel/source_dialogs.py", "“{name}” is taken; choose another name")
def _name_is_taken(case: Case) -> None:
    case.fixture("desk")
    dialog = AddSourceDialog()
    dialog.url.setText("https://tiles.example/{z}/{x}/{y}.png")
    dialog.name.setText("osm")
    case.says(dialog.marks.message("name"))
    dialog.name.setText("mine")

    def accept():
        dialog.accept()
        return dialog.added == "mine"

    case.follow("choose another name", accept)
    dialog.deleteLater()
