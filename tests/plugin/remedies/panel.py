"""What the panel advises: of keys, figures, cameras, folders and presses that came too early."""

from __future__ import annotations

import os
import re
from dataclasses import replace

import pytest
from qgis.core import QgsApplication, QgsSettings
from terrainav.core.imagery.catalogue import add, described
from terrainav.core.imagery.http.transport import TransportError
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.cameras import camera_shelf
from terrainav.core.mission.estimate import ONLINE, estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import LONGEST_SIDE
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.credentials import credential_problem, read_key
from terrainav.terrainav_plugin.form import mission_form
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.panel.camera import save_camera
from terrainav.terrainav_plugin.panel.figures import readout
from terrainav.terrainav_plugin.panel.options_page import folder_problem

from tests.plugin.steps import SMALL_BOX
from tests.plugin.transports import MASTER_PASSWORD
from tests.support.remedies import Case, remedy
from tests.support.tileserver import TileServer


def has_key(authcfg):
    return not credential_problem(authcfg, is_key=True) and bool(read_key(authcfg))


@remedy("form/mission_form.py", "no map type: tick one or more")
def _no_map_type(case: Case) -> None:
    state = FormState(**SMALL_BOX, map_types=())
    with pytest.raises(mission_form.FormError) as refused:
        mission_form.mission(state)
    case.says(refused.value.messages["map_types"])
    case.follow("tick one or more", lambda: mission_form.mission(replace(state, map_types=("roadmap",))))


@remedy("form/mission_form.py", "several imageries: tick one map type here, and add the others as imagery")
def _map_types_of_one_of_several(case: Case) -> None:
    state = FormState(**SMALL_BOX, map_types=("satellite", "roadmap"), imageries=("map=world:terrain",))
    with pytest.raises(mission_form.FormError) as refused:
        mission_form.mission(state)
    case.says(refused.value.messages["map_types"])
    one = replace(state, map_types=("satellite",))
    case.follow("tick one map type here", lambda: mission_form.mission(one))
    more = replace(one, imageries=(*one.imageries, "world:roadmap"))
    case.follow("add the others as imagery", lambda: mission_form.mission(more))


@remedy("form/mission_form.py", "this source cannot be one of several: save it under another name first")
def _source_like_a_date(case: Case) -> None:
    state = FormState(**SMALL_BOX, source="ortho@2014.tif", imageries=("map=world",))
    with pytest.raises(mission_form.FormError) as refused:
        mission_form.mission(state)
    case.says(refused.value.messages["imageries"])
    named = replace(state, source="ortho-2014.tif")
    case.follow("save it under another name first", lambda: mission_form.mission(named))


@remedy("credentials.py", "API key: choose a configuration, or press “+” and enter it as password")
def _no_configuration(case: Case) -> None:
    configured = case.fixture("configured")
    case.says(credential_problem("", is_key=True))
    case.follow("choose a configuration", lambda: has_key(configured("the key")))
    # What “+” offers first.
    case.follow("press “+” and enter it as password", lambda: has_key(configured("the key", "new", "")))


@remedy("credentials.py", "authentication configuration {id} does not exist (any more): choose another")
def _configuration_gone(case: Case) -> None:
    configured = case.fixture("configured")
    gone = configured("the key")
    QgsApplication.authManager().removeAuthenticationConfig(gone)
    case.says(credential_problem(gone, is_key=True))
    case.follow("choose another", lambda: has_key(configured("the key")))


@remedy(
    "credentials.py",
    "authentication configuration {id} holds no key: choose a Basic one with the key as password",
)
def _configuration_without_key(case: Case) -> None:
    configured = case.fixture("configured")
    case.says(credential_problem(configured(""), is_key=True))
    case.follow("choose a Basic one with the key as password", lambda: has_key(configured("the key")))


@remedy(
    "credentials.py",
    "QGIS's authentication database is locked: press Capture again and enter its master password",
)
def _database_is_locked(case: Case) -> None:
    desk, authcfg = case.fixture("desk"), case.fixture("configured")("the key")
    manager, entered = QgsApplication.authManager(), []

    class Asking:
        """The manager, where a person answers its question for the master password."""

        def __getattr__(self, name):
            return getattr(manager, name)

        def setMasterPassword(self, _ask):
            return manager.masterPasswordIsSet() or (bool(entered) and manager.setMasterPassword(entered[0], True))

    with TileServer() as server:
        add("keyed", described(server.url_template + "?token={key}"))
        desk.session.source_list.refresh()
        single(desk)
        desk.choose(desk.form.source, "keyed")
        desk.form.key.setConfigId(authcfg)
        desk.wait_planned()
        manager.clearMasterPassword()
        case.monkeypatch.setattr(QgsApplication, "authManager", Asking)
        desk.click(desk.dock.capture)
        case.says(desk.message("key"))
        entered.append(MASTER_PASSWORD)
        case.follow("press Capture again and enter its master password", lambda: captured(desk))
    QgsSettings().remove("TerrAInav/authcfg")


def single(desk):
    """Enter a mission of one image."""
    desk.form.area_editing.set_coordinates("35.14 -89.87 120")
    return desk.wait_planned()


def captured(desk):
    """Press Capture; whether images come of it."""
    desk.click(desk.dock.capture)
    desk.wait(lambda: any(desk.folder.glob("*/meta_data.csv")))
    desk.wait_for_run()
    return any(desk.folder.glob("*/*.tif"))


@remedy(
    "network/worker.py",
    "QGIS's authentication database is locked: enter its master password, then try again",
)
def _locked_under_way(case: Case) -> None:
    server, authcfg = case.fixture("server"), case.fixture("configured")("the password")
    transport = case.fixture("transport_of")(authcfg=authcfg)
    QgsApplication.authManager().clearMasterPassword()
    case.refused(lambda: transport.get(server.url + "/"), TransportError)
    case.follow(
        "enter its master password",
        lambda: QgsApplication.authManager().setMasterPassword(MASTER_PASSWORD, True),
    )
    case.follow("then try again", lambda: transport.get(server.url + "/").status == 200)


FIELDS = Box(35.16, -89.90, 35.115, -89.823)


@remedy(
    "panel/figures.py",
    "{count} requests, but the provider allows {most}: choose a smaller area, a coarser GSD or another source",
)
def _beyond_the_limit(case: Case) -> None:
    def limit(box=FIELDS, source="osm", **options):
        """The line of the limit, and whether the figures say that it is kept."""
        entry = named_source(source).entry
        found = plan(Mission(box, 120.0, source=source, **options), entry.grid())
        lines = dict(readout(found, estimate(found, ONLINE), policy=entry.policy).figures)
        return lines.get("Limit", ""), not entry.policy.stops(found.requests)

    text, kept = limit()
    assert not kept
    case.says(text)
    case.follow("choose a smaller area", lambda: limit(Box(35.16, -89.90, 35.158, -89.898))[1])
    case.follow("a coarser GSD", lambda: limit(gsd_m_per_px=8.0)[1])
    case.follow("another source", lambda: limit(source="s2cloudless")[1])


@remedy(
    "panel/camera.py",
    "These values are not a valid camera: fix the highlighted fields, then save.",
)
def _no_camera(case: Case) -> None:
    case.fixture("desk")
    state = FormState(**SMALL_BOX, aspect="wide", folder="any")
    case.refused(lambda: save_camera("mine", state))
    with pytest.raises(mission_form.FormError) as marked:
        mission_form.mission(state)
    (field,) = marked.value.messages
    state = replace(state, **{field: "3:2"})
    case.follow("fix the highlighted fields", lambda: mission_form.mission(state))
    case.follow("then save.", lambda: save_camera("mine", state))
    assert [preset.name for preset in camera_shelf().entries] == ["mine"]


@remedy("capture/questions.py", "no folder: choose where to save the images")
def _no_folder(case: Case) -> None:
    desk = case.fixture("desk")
    single(desk)
    desk.form.folder.setFilePath("")
    desk.click(desk.dock.capture)
    case.says(desk.message("folder"))
    desk.form.folder.setFilePath(str(desk.folder))
    case.follow("choose where to save the images", lambda: captured(desk))


@remedy("panel/planning.py", "The entries changed while the plan was being computed: press the button again.")
def _changed_meanwhile(case: Case) -> None:
    desk = case.fixture("desk")
    single(desk)
    desk.form.agl.setValue(130.0)
    desk.click(desk.dock.capture)
    desk.form.agl.setValue(140.0)
    case.says("\n".join(desk.messages()))
    assert not desk.folder.exists()
    case.follow("press the button again.", lambda: captured(desk))


@remedy("panel/alignment.py", "The entries changed while the rows were being aligned: press the button again.")
def _changed_while_aligned(case: Case) -> None:
    desk = case.fixture("desk")
    desk.enter_small_mission()
    align = desk.form.flight.align

    def press():
        action = next(one for one in align.menu().actions() if one.objectName() == LONGEST_SIDE)
        action.trigger()
        return not align.isEnabled()

    desk.form.set_state(replace(desk.session.state(), row_azimuth_deg=30.0))
    desk.wait_planned()
    assert press()
    desk.form.agl.setValue(140.0)
    desk.wait(align.isEnabled)
    case.says("\n".join(desk.messages()))
    desk.wait_planned()

    def again():
        press()
        desk.wait(align.isEnabled)
        return desk.session.state().row_azimuth_deg == 90.0

    case.follow("press the button again.", again)


@remedy("panel/figures.py", "Fix the highlighted fields.")
def _marked(case: Case) -> None:
    desk = case.fixture("desk")
    desk.enter_box(**{**SMALL_BOX, "north": "99"})
    desk.wait(lambda: bool(desk.dock.figures.warnings.text()))
    case.says(desk.dock.figures.warnings.text())
    assert "99" in desk.message("north")

    def mend():
        desk.type_text(desk.form.edges["north"], SMALL_BOX["north"])
        return desk.wait_planned() is not None and bool(desk.dock.estimates.text())

    case.follow("Fix the highlighted fields.", mend)


@remedy("panel/figures.py", "fly higher")
def _coarser_source(case: Case) -> None:
    desk = case.fixture("desk")
    desk.enter_small_mission()
    desk.choose(desk.form.source, "esri-world-imagery")
    desk.form.agl.setValue(30.0)
    desk.wait_planned()
    case.says(re.sub("<[^>]*>", "\n", desk.dock.figures.line.text()))

    def follow():
        desk.dock.figures.line.linkActivated.emit("higher")
        return desk.wait_planned().summary.width_px > 630

    case.follow("fly higher", follow)


@remedy("panel/options_page.py", "{folder}: {file} is a file; choose a folder")
def _file_in_place(case: Case) -> None:
    path = case.tmp_path / "file"
    path.write_text("")
    case.says(folder_problem(str(path)))
    case.follow("choose a folder", lambda: not folder_problem(str(case.tmp_path / "folder")))


@remedy("panel/options_page.py", "{folder}: cannot be written to; choose another")
def _not_writable(case: Case) -> None:
    locked = case.tmp_path / "locked"
    locked.mkdir()
    # Who runs the tests may be allowed everything.
    case.monkeypatch.setattr(os, "access", lambda path, _mode: str(path) != str(locked))
    case.says(folder_problem(str(locked)))
    case.follow("choose another", lambda: not folder_problem(str(case.tmp_path / "other")))
