"""The same tile for places far apart: said after a capture, and treated as missing where the user says so."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest
from osgeo import gdal
from terrainav.core.imagery.catalogue import user_sources
from terrainav.terrainav_plugin.panel.options_page import OptionsPage
from terrainav.terrainav_plugin.panel.source_dialogs import AddSourceDialog
from terrainav.terrainav_plugin.settings import Settings

from tests.plugin.steps import SMALL_BOX
from tests.plugin.test_capture import capture, images
from tests.plugin.test_processing import Feedback, run
from tests.plugin.test_processing import provider as _provider  # noqa: F401  (a fixture)
from tests.support.faults import flat_placeholder
from tests.support.tileserver import TileServer

DIGEST = hashlib.sha256(flat_placeholder()).hexdigest()[:16]
OTHER = "0123456789abcdef"


def some_grey(map_type, zoom, x, y, size_px):
    """A placeholder in every seventh column of every sixth row; ground elsewhere, of which no tile is like another."""
    if x % 7 or y % 6:
        return np.random.default_rng((zoom, x, y)).integers(0, 200, (size_px, size_px, 3), np.uint8)
    return np.full((size_px, size_px, 3), 204, np.uint8)


@pytest.fixture
def server():
    with TileServer(some_grey) as running:
        yield running


@pytest.fixture(autouse=True)
def settings():
    yield Settings()
    Settings().placeholders = ""


def grey_images(folder):
    return {
        path.stem
        for path in (folder / "satellite").glob("*.tif")
        if (gdal.Open(str(path)).ReadAsArray() == 204).all(axis=0).any()
    }


def test_it_is_said_and_treated_as_missing_by_a_press(desk, server, settings, screenshot):
    desk.enter_coarse_mission()
    desk.enter_box(**SMALL_BOX)
    desk.use_template(server.url_template)
    total = len(desk.wait_planned().plan)
    capture(desk)
    grey = grey_images(desk.folder)
    assert 3 <= len(grey) < total == len(images(desk))
    (said,) = [text for text in desk.messages() if "the same tile" in text]
    assert said.endswith(f"places and is in {len(grey)} images.")
    assert any("images captured" in text for text in desk.messages())
    screenshot("repeated-tiles")

    desk.click(desk.buttons_in_message_bar()["Treat as missing"])
    desk.wait(lambda: any("could not be captured" in text for text in desk.messages()))
    desk.wait_for_run()
    assert settings.missing_tiles == (DIGEST,)
    # Nothing grey is left, neither as a file nor in the mosaic, and it is not said again.
    assert {path.stem for path in images(desk)} & grey == set()
    assert len(images(desk)) == total - len(grey)
    assert {feature["name"] for feature in desk.layer("Failed images").getFeatures()} == grey
    assert len([text for text in desk.messages() if "the same tile" in text]) == 0
    mosaic = gdal.Open(str(desk.folder / "satellite.vrt"))
    assert not any(f"{name}.tif" in path for path in mosaic.GetFileList() for name in grey)


def test_what_is_treated_as_missing_holds_for_later_captures(desk, server, settings):
    settings.treat_as_missing(OTHER)
    settings.treat_as_missing(DIGEST)
    settings.treat_as_missing(DIGEST)
    assert settings.missing_tiles == (OTHER, DIGEST)
    desk.enter_coarse_mission()
    desk.use_template(server.url_template)
    desk.wait_planned()
    capture(desk)
    assert grey_images(desk.folder) == set()
    assert any("placeholder" in text for text in desk.messages())


def test_the_options_list_it(settings, qtbot, screenshot):
    settings.treat_as_missing(DIGEST)
    page = OptionsPage(None, lambda: None)
    qtbot.addWidget(page)
    assert page.placeholders.text() == DIGEST
    page.placeholders.setText(f"{DIGEST}  {OTHER.upper()}")
    assert page.isValid()
    page.apply()
    assert settings.missing_tiles == (DIGEST, OTHER)
    page.placeholders.setText("grey")
    assert not page.isValid()
    assert "'grey': must be the SHA-256" in page.marks.message("placeholders")
    screenshot("options-placeholders", page)
    page.apply()
    assert settings.missing_tiles == (DIGEST, OTHER)
    page.show_defaults()
    page.apply()
    assert settings.missing_tiles == ()


def test_a_file_of_settings_that_was_edited_badly_does_no_harm(settings):
    settings.placeholders = f"grey, {DIGEST}; {'f' * 80}"
    assert settings.missing_tiles == (DIGEST,)


def test_a_source_of_one_s_own_has_them_as_well(desk, qtbot, screenshot):
    dialog = AddSourceDialog(None)
    qtbot.addWidget(dialog)
    dialog.url.setText("https://tiles.example/{z}/{x}/{y}.png")
    dialog.name.setText("mine")
    dialog.placeholders.setText("grey")
    assert "'grey': must be the SHA-256" in dialog.marks.message("placeholders")
    screenshot("add-source-placeholders", dialog)
    dialog.placeholders.setText(DIGEST)
    dialog.accept()
    assert dialog.added == "mine"
    (entry,) = user_sources()
    assert entry.placeholder.sha256 == (DIGEST,)


@pytest.mark.thorough
def test_processing_says_it_and_does_it(server, tmp_path):
    feedback, folder = Feedback(), tmp_path / "out"
    asked = {
        "COORDS": "35.14_-89.87_35.131_-89.856_120",
        "OTHER_SOURCE": server.url_template,
        "FOLDER": str(folder),
    }
    first = run("capture", feedback, **asked)
    grey = grey_images(folder)
    (said,) = [text for text in feedback.warnings if "the same tile" in text]
    assert f"is in {len(grey)} images" in said
    assert f"enter {DIGEST} under “Tiles to treat as missing”" in said
    again = run("capture", **asked, PLACEHOLDERS=f"{OTHER}, {DIGEST}")
    assert (first["FAILED"], again["FAILED"], again["SKIPPED"]) == (0, len(grey), first["TOTAL"] - len(grey))
    assert grey_images(folder) == set()
