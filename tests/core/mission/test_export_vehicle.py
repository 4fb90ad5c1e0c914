"""A flight is uploaded to a vehicle: a peer on loopback that answers MAVLink's mission protocol, with pymavlink."""

from __future__ import annotations

import json
import math
import socket
import threading

import pytest
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.export import plan_texts, write_plan
from terrainav.core.mission.export.vehicle import upload, vehicle_text
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.command import command

mavutil = pytest.importorskip("pymavlink.mavutil")
MAVLINK = mavutil.mavlink
FIELD = Mission(Box(47.402, 8.500, 47.400, 8.503), 100.0, takeoff=(47.399, 8.499), overlap_along=0.5)
PX4, ARDUPILOT = MAVLINK.MAV_AUTOPILOT_PX4, MAVLINK.MAV_AUTOPILOT_ARDUPILOTMEGA
run = pytest.fixture(command, name="run")


def free_port(kind=socket.SOCK_STREAM):
    with socket.socket(socket.AF_INET, kind) as held:
        held.bind(("127.0.0.1", 0))
        return held.getsockname()[1]


class Vehicle(threading.Thread):
    """Peer that asks for each item, for some of them twice, and then accepts the mission or refuses it."""

    def __init__(self, way, autopilot=PX4, answer=MAVLINK.MAV_MISSION_ACCEPTED, deaf=False, old=False):
        super().__init__(daemon=True)
        self.port = free_port(socket.SOCK_STREAM if way == "tcp" else socket.SOCK_DGRAM)
        self.address = f"{way}:127.0.0.1:{self.port}"
        self._own = {"tcp": "tcpin", "udp": "udpout", "udpout": "udpin"}[way] + f":127.0.0.1:{self.port}"
        self._autopilot, self._answer, self._deaf, self._old = autopilot, answer, deaf, old
        self.items, self.failed, self.ready, self.ended = [], None, threading.Event(), threading.Event()

    def run(self):
        try:
            self._serve()
        except (AssertionError, OSError) as wrong:
            self.failed = wrong

    def _serve(self):
        link = mavutil.mavlink_connection(self._own, source_system=1, source_component=1)
        self.ready.set()
        count, counts_left = None, 2
        while not self.ended.is_set():
            link.mav.heartbeat_send(MAVLINK.MAV_TYPE_QUADROTOR, self._autopilot, 0, 0, MAVLINK.MAV_STATE_STANDBY)
            got = link.recv_match(type=["MISSION_COUNT", "MISSION_ITEM_INT"], blocking=True, timeout=0.05)
            if got is None or self._deaf:
                continue
            if got.get_type() == "MISSION_COUNT":
                counts_left -= 1
                if counts_left:
                    # The first announcement is lost.
                    continue
                count = got.count
                assert (got.target_system, got.target_component) == (1, 1)
                assert got.get_srcSystem() == 255
            elif got.seq == len(self.items):
                self.items.append(got)
                if got.seq % 5 == 2:
                    # An item that was asked for twice comes twice.
                    self._ask(link, got.seq)
            if len(self.items) == count:
                link.mav.mission_ack_send(255, 0, self._answer)
                count = None
            elif count is not None:
                self._ask(link, len(self.items))
        link.close()

    def _ask(self, link, number):
        ask = link.mav.mission_request_send if self._old else link.mav.mission_request_int_send
        ask(255, 0, number)

    def __enter__(self):
        self.start()
        assert self.ready.wait(10.0)
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.join(10.0)
        if self.failed is not None:
            raise self.failed


def expected(text, autopilot):
    """Items of a file: command, frame, parameters, and position in units of 1e-7 degrees."""
    mission = json.loads(text)["mission"]
    items = [(one["command"], one["frame"], one["params"]) for one in mission["items"]]
    if autopilot == ARDUPILOT:
        items = [(16, 0, [0, 0, 0, 0, *mission["plannedHomePosition"]]), *items]
    return items


@pytest.mark.parametrize("way", ["tcp", "udp", "udpout"])
@pytest.mark.parametrize(("autopilot", "old"), [(PX4, False), (ARDUPILOT, True)])
def test_the_vehicle_receives_the_items_of_the_file(tmp_path, way, autopilot, old):
    made = plan(FIELD.replace(trigger="distance"), PixelGrid())
    (text,), _ = plan_texts(made)
    assert text == write_plan(made, tmp_path / "field.plan").files[0].read_text()
    with Vehicle(way, autopilot, old=old) as vehicle:
        assert upload(text, vehicle.address, retry_s=1.0) == len(vehicle.items)
    wanted = expected(text, autopilot)
    assert len(vehicle.items) == len(wanted)
    for number, (got, (code, frame, params)) in enumerate(zip(vehicle.items, wanted)):
        assert (got.seq, got.command, got.frame, got.autocontinue) == (number, code, frame, 1)
        assert got.current == (number == 0)
        for value, param in zip((got.param1, got.param2, got.param3, got.param4), params):
            if param is None:
                assert math.isnan(value) if autopilot == PX4 else value == 0.0
            else:
                assert value == pytest.approx(param, rel=1e-6, abs=1e-6)
        if frame in (0, 3):
            assert got.x / 1e7 == pytest.approx(params[4], abs=6e-8)
            assert got.y / 1e7 == pytest.approx(params[5], abs=6e-8)
        assert got.z == pytest.approx(params[6], rel=1e-6, abs=1e-5)


def test_what_the_vehicle_does_not_do_is_said():
    (text,), _ = plan_texts(plan(FIELD, PixelGrid()))
    refused = pytest.raises(OutputError, match=r"refused the mission \(MAV_MISSION_NO_SPACE\)")
    with Vehicle("tcp", answer=MAVLINK.MAV_MISSION_NO_SPACE) as vehicle, refused:
        upload(text, vehicle.address, retry_s=1.0)
    with Vehicle("tcp", deaf=True) as vehicle, pytest.raises(OutputError, match="did not answer 5 times"):
        upload(text, vehicle.address, retry_s=0.05)
    with pytest.raises(OutputError, match=r"sent no heartbeat within 0\.2 s"):
        upload(text, f"udp:127.0.0.1:{free_port(socket.SOCK_DGRAM)}", heartbeat_s=0.2)
    with pytest.raises(OutputError, match="cannot be reached"):
        upload(text, f"tcp:127.0.0.1:{free_port()}")


@pytest.mark.parametrize("address", ["/dev/ttyUSB0", "COM3", "field.tlog", "tcp:127.0.0.1", "http://localhost:80", ""])
def test_only_addresses_of_the_network_are_opened(address):
    with pytest.raises(InvalidInput, match="must be tcp:HOST:PORT"):
        upload("{}", address)


def test_one_of_several_sorties_is_chosen():
    assert vehicle_text(["a"], None) == "a"
    assert vehicle_text(["a", "b"], 2) == "b"
    for sortie in (None, 0, 3):
        with pytest.raises(InvalidInput, match="flight of 2 sorties: a vehicle takes one; choose one from 1 to 2"):
            vehicle_text(["a", "b"], sortie)


def test_the_command_uploads(run):
    with Vehicle("tcp") as vehicle:
        done = run("plan", "--coords", "47.402_8.500_47.400_8.503_100", "--to-vehicle", vehicle.address)
    assert done.returncode == 0
    assert f"{vehicle.address}: {len(vehicle.items)} items uploaded" in done.stderr
