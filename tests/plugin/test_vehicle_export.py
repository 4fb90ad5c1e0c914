"""A flight is uploaded to a vehicle from the panel's menu: to a peer on loopback that answers MAVLink's protocol."""

from __future__ import annotations

from dataclasses import replace

import pytest
from qgis.PyQt.QtWidgets import QInputDialog
from terrainav.core.mission.export import plan_texts
from terrainav.terrainav_plugin.settings import Settings

from tests.plugin.test_project import choose_in_menu, menu_texts

pytest.importorskip("pymavlink.mavutil")
from tests.core.mission.test_export_vehicle import Vehicle


def send(desk, monkeypatch, address, sortie=None):
    asked = []

    def text(_parent, _title, _label, _mode, proposed):
        asked.append(proposed)
        return address, True

    monkeypatch.setattr(QInputDialog, "getText", text)
    monkeypatch.setattr(QInputDialog, "getInt", lambda *_: (sortie or 0, sortie is not None))
    desk.iface.messageBar().clearWidgets()
    choose_in_menu(desk, "Export to a vehicle…")
    desk.wait(lambda: not desk.session.planner.busy and not desk.session.missions.vehicle_export.busy)
    return asked[0]


def test_a_flight_is_uploaded_and_the_address_is_kept(desk, monkeypatch):
    desk.enter_small_mission()
    desk.wait_planned()
    with Vehicle("tcp") as vehicle:
        assert send(desk, monkeypatch, vehicle.address) == "udp:0.0.0.0:14550"
    assert any(
        f"{vehicle.address}: the vehicle has accepted {len(vehicle.items)} mission items." in text
        for text in desk.messages()
    )
    assert Settings().vehicle == vehicle.address


def test_the_chosen_sortie_is_uploaded(desk, monkeypatch):
    desk.enter_small_mission()
    desk.form.set_state(replace(desk.session.state(), takeoff="35.13, -89.86", split_after="3"))
    plan = desk.wait_planned().plan
    texts, _ = plan_texts(plan)
    assert len(texts) == 2
    with Vehicle("tcp") as vehicle:
        send(desk, monkeypatch, vehicle.address, sortie=1)
    few = len(vehicle.items)
    with Vehicle("tcp") as vehicle:
        send(desk, monkeypatch, vehicle.address, sortie=2)
    assert len(vehicle.items) > few > 3
    with Vehicle("tcp") as vehicle:
        send(desk, monkeypatch, vehicle.address)
    assert vehicle.items == []


def test_what_is_wrong_with_an_address_is_one_line(desk, monkeypatch):
    desk.enter_small_mission()
    desk.wait_planned()
    send(desk, monkeypatch, "somewhere")
    ours = [item.text() for item in desk.iface.messageBar().items() if item.title() == "TerrAInav"]
    assert len(ours) == 1
    assert "must be tcp:HOST:PORT, udp:HOST:PORT or udpout:HOST:PORT" in ours[0]


def test_there_is_nothing_to_upload_without_a_plan(desk):
    menu_texts(desk)
    (action,) = (one for one in desk.session.missions.menu.actions() if "vehicle" in one.text())
    assert not action.isEnabled()
    assert "No area yet" in action.toolTip()
