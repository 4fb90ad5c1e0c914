"""Poses from flight simulators: packets of pymavlink's own reader and writer, and of JSBSim."""

from __future__ import annotations

import math
import socket
import struct
import time
from contextlib import AsyncExitStack, asynccontextmanager

import pytest
import requests
from terrainav.core.errors import InvalidInput
from terrainav.core.live.camera import FrameRequest
from terrainav.core.live.encoding import encode
from terrainav.core.live.flightgear import PACKET_BYTES, add_packet, serve
from terrainav.core.live.following import PoseTrack, heading_deg
from terrainav.core.live.http import serve as serve_http

from tests.core.live.scenes import HERE, live_camera
from tests.core.live.serving import free_port, served

pytest.importorskip("pymavlink", reason="it reads and writes the same packets")

from pymavlink import fgFDM


def packet(**changes):
    fdm = fgFDM.fgFDM()
    values = {
        "longitude": (HERE[1], "degrees"),
        "latitude": (HERE[0], "degrees"),
        "altitude": (321.0, "meters"),
        "phi": (12.0, "degrees"),
        "theta": (-7.0, "degrees"),
        "psi": (215.0, "degrees"),
        "v_north": (-20.0, "mps"),
        "v_east": (-14.0, "mps"),
        "v_down": (1.5, "mps"),
    }
    for name, (value, units) in {**values, **changes}.items():
        fdm.set(name, value, units=units)
    return fdm.pack()


def test_a_packet_gives_the_pose_that_pymavlink_wrote():
    track = PoseTrack()
    assert len(packet()) == PACKET_BYTES
    add_packet(track, packet(), 100.0)
    pose = track.at(100.0)
    assert (pose.lat_deg, pose.lon_deg, pose.height_m) == pytest.approx((*HERE, 321.0), abs=1e-6)
    w, x, y, z = pose.quaternion
    assert heading_deg(pose.quaternion) == pytest.approx(215.0 - 360.0, abs=1e-5)
    assert math.degrees(math.asin(2.0 * (w * y - z * x))) == pytest.approx(-7.0, abs=1e-5)
    assert math.degrees(math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))) == pytest.approx(12.0, abs=1e-5)
    # 20 m/s to the south for 0.2 s.
    assert (track.at(100.2).lat_deg - HERE[0]) * 111_170.0 == pytest.approx(-4.0, abs=0.01)


@pytest.mark.parametrize(
    "broken",
    [
        b"",
        packet()[:-1],
        packet() + b"\0",
        struct.pack(">I", 25) + packet()[4:],
        struct.pack("<I", 24) + packet()[4:],
        packet()[:8] + struct.pack(">3d", math.nan, 0.8, 100.0) + packet()[32:],
        packet()[:8] + struct.pack(">3d", 0.1, 99.0, 100.0) + packet()[32:],
        packet()[:36] + struct.pack(">3f", math.inf, 0.0, 0.0) + packet()[48:],
    ],
    ids=["empty", "short", "long", "version", "byte order", "nan", "latitude", "attitude"],
)
def test_what_is_no_packet_is_counted_and_left_out(broken):
    track = PoseTrack()
    add_packet(track, broken, 100.0)
    assert track.counts["nonsense"] >= 1
    with pytest.raises(InvalidInput):
        track.at(100.0)


def serve_both(server, host, port):
    """HTTP at the port, and simulators at another, which is kept in the camera."""

    @asynccontextmanager
    async def opened():
        async with AsyncExitStack() as stack:
            server.camera.fdm_port = free_port()
            server.camera.track = await stack.enter_async_context(serve(server, host, server.camera.fdm_port))
            await stack.enter_async_context(serve_http(server, host, port))
            yield

    return opened()


def test_http_follows_the_aircraft():
    camera = live_camera(tilt_deg=30.0)
    with served(camera, serve_both) as port, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        address = f"http://127.0.0.1:{port}"
        assert requests.get(address + "/camera", timeout=60.0).json()["follows"] is True
        nobody = requests.get(address + "/frame?follow=1", timeout=60.0)
        assert nobody.status_code == 400
        for data in (b"rubbish", packet(phi=(0.0, "degrees"), theta=(10.0, "degrees"))):
            sender.sendto(data, ("127.0.0.1", camera.fdm_port))
        end = time.monotonic() + 30.0
        while not camera.track.counts["taken"]:
            assert time.monotonic() < end
            time.sleep(0.01)
        answer = requests.get(address + "/frame?follow=1&format=json", timeout=60.0).json()
        pose = answer["pose"]
        assert (pose["lat_deg"], pose["lon_deg"]) == pytest.approx(HERE, abs=1e-9)
        # The nose is 10 degrees up, and the camera 30 degrees ahead of straight down.
        assert (pose["yaw_deg"], pose["tilt_deg"], pose["roll_deg"]) == pytest.approx((-145.0, 40.0, 0.0), abs=1e-4)
        assert abs(answer["time_s"] - time.time()) < 60.0
        image = requests.get(address + "/frame?follow=1", timeout=60.0).content
        angles = (pose[name] for name in ("yaw_deg", "tilt_deg", "roll_deg"))
        place = pose["lat_deg"], pose["lon_deg"], pose["height_m"]
        assert image == encode(camera.take(FrameRequest(*place, *angles, above_ellipsoid=True)))


def test_without_a_vehicle_following_is_refused():
    with served(live_camera(), serve_http) as port:
        answer = requests.get(f"http://127.0.0.1:{port}/frame?follow=1", timeout=60.0)
        assert answer.status_code == 400
        assert "--fdm" in answer.json()["error"]


def test_jsbsim_sends_what_both_readers_read_alike(tmp_path, monkeypatch):
    jsbsim = pytest.importorskip("jsbsim")
    # Its aircraft writes a table where it is flown.
    monkeypatch.chdir(tmp_path)
    track, sparse, reader, packets = PoseTrack(), PoseTrack(), fgFDM.fgFDM(), []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(30.0)
        port = receiver.getsockname()[1]
        output = tmp_path / "flightgear.xml"
        output.write_text(f'<output name="127.0.0.1" type="FLIGHTGEAR" port="{port}" protocol="UDP" rate="120"/>')
        flight = jsbsim.FGFDMExec(None)
        flight.set_debug_level(0)
        assert flight.load_model("c172x")
        for name, value in {"lat-geod-deg": HERE[0], "long-gc-deg": HERE[1], "h-sl-ft": 3000, "vt-kts": 100}.items():
            flight[f"ic/{name}"] = value
        flight["ic/psi-true-deg"] = 60.0
        assert flight.set_output_directive(str(output))
        assert flight.run_ic()
        for step in range(61):
            assert flight.run()
            data = receiver.recv(1 << 16)
            packets.append((data, step / 120.0))
            add_packet(track, *packets[-1])
            reader.parse(data)
            pose = track.latest()
            assert pose.lat_deg == pytest.approx(reader.get("latitude", units="degrees"), abs=1e-9)
            assert pose.lon_deg == pytest.approx(reader.get("longitude", units="degrees"), abs=1e-9)
            assert pose.height_m == pytest.approx(reader.get("altitude"), abs=1e-3)
            assert heading_deg(pose.quaternion) == pytest.approx(reader.get("psi", units="degrees"), abs=1e-4)
            # JSBSim's own properties, up to the steps of less than half a metre that packets are behind.
            own = flight["position/lat-geod-deg"], flight["position/long-gc-deg"]
            assert (pose.lat_deg, pose.lon_deg) == pytest.approx(own, abs=1e-5)
    assert set(track.counts) == {"taken"}
    # Velocities are those of the path: two packets half a second apart give it as all packets do.
    for data, time_s in packets[:: len(packets) - 1]:
        add_packet(sparse, data, time_s)
    between, whole = sparse.at(0.25), track.at(0.25)
    assert (between.lat_deg, between.lon_deg) == pytest.approx((whole.lat_deg, whole.lon_deg), abs=1e-7)
