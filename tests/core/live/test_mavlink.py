"""A MAVLink camera, used by MAVSDK's unmodified client, and by hostile ones."""

from __future__ import annotations

import asyncio
import contextlib
import io
import math
import os
import random
import socket
import time
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import urlparse
from urllib.request import url2pathname

import numpy as np
import pytest
from PIL import Image
from terrainav.core.errors import InvalidInput
from terrainav.core.live.encoding import encode

pytest.importorskip("pymavlink", reason="it reads and writes MAVLink")

from pymavlink import mavutil
from pymavlink.dialects.v20 import common
from terrainav.core.live import mavlink
from terrainav.core.live.links import messages, parse_address, parser
from terrainav.core.live.serving import FrameServer

from tests.core.live.scenes import live_camera
from tests.core.live.serving import free_port, served
from tests.core.live.test_following import TO_GEOCENTRIC, geocentric
from tests.core.live.vehicles import HOME, UNIX_S, Vehicle, attitude, path

STREAM = "rtsp://127.0.0.1:8554/camera"
#: Largest distance of a position from one rounded to 1e-7 degrees and a millimetre, and of what velocities in whole
#: centimetres per second add between positions 0.2 s apart.
ROUNDING_M = math.hypot(0.5e-7 * 111_200.0, 0.5e-7 * 76_500.0, 0.0005) + 2.0 * 0.2 * 4.0 / 27.0 * 0.009
PATIENCE_S = 30.0


def serving(folder, video=""):
    """``serve(server, host, port)`` of a camera that writes into a folder; the component is the camera's attribute."""

    @asynccontextmanager
    async def opened(server, host, port):
        server.video = video
        async with mavlink.serve(server, f"udp:{host}:{port}", folder) as component:
            server.camera.component = component
            yield

    return opened


def until(found):
    """Wait for a true value."""
    end = time.monotonic() + PATIENCE_S
    while not (value := found()):
        assert time.monotonic() < end
        time.sleep(0.005)
    return value


class Client:
    """A ground station, or a companion of the vehicle, by MAVSDK."""

    def __init__(self, ground, port):
        from mavsdk.plugins.camera.camera import Camera

        ground.add_any_connection(f"udpout://127.0.0.1:{port}")
        self.system = until(lambda: next((one for one in ground.get_systems() if one.has_camera()), None))
        self.camera, self.infos, self.streams = Camera(self.system), [], []
        self.camera.subscribe_capture_info(lambda info, _: self.infos.append(info))
        self.camera.subscribe_video_stream_info(lambda update, _: self.streams.append(update))
        self.information = until(lambda: self.camera.camera_list().cameras)[0]

    def photograph(self):
        """Take a photograph; returns what is reported of it."""
        count = len(self.infos)
        self.camera.take_photo(self.information.component_id)
        until(lambda: len(self.infos) > count)
        return self.infos[count]


@contextmanager
def ground_station(port):
    mavsdk = pytest.importorskip("mavsdk", reason="its client is the camera's user")
    made = mavsdk.Mavsdk(mavsdk.Configuration.create_with_component_type(mavsdk.ComponentType.GROUND_STATION))
    try:
        yield Client(made, port)
    finally:
        made.destroy()


def photograph_of(info):
    """Bytes of the photograph that is reported."""
    return Path(url2pathname(urlparse(info.file_url).path)).read_bytes()


def geotag(data):
    """Latitude, longitude and height of a photograph."""
    tags = Image.open(io.BytesIO(data)).getexif().get_ifd(0x8825)
    lat, lon = (sum(float(part) / 60**at for at, part in enumerate(tags[name])) for name in (2, 4))
    return lat, lon, float(tags[6])


def error_m(place, time_s):
    lat, lon, height = place
    return float(np.linalg.norm(np.array(TO_GEOCENTRIC.transform(lon, lat, height)) - geocentric(time_s)))


def test_mavsdk_takes_a_hundred_photographs_over_a_bad_link(tmp_path):
    """Each geotag is the sender's path at its time within 1 mm."""
    with (
        served(live_camera(), serving(tmp_path)) as port,
        Vehicle(port, late_s=0.08, lost=0.05, fine=True),
        ground_station(port) as client,
    ):
        time.sleep(1.5)
        infos = [client.photograph() for _ in range(100)]
    assert all(one.is_success for one in infos)
    assert [one.index for one in infos] == list(range(100))
    assert len(list(tmp_path.iterdir())) == 100
    for info in infos:
        time_s = info.time_utc_us / 1e6 - UNIX_S
        assert error_m(geotag(photograph_of(info)), time_s) < 1e-3
        assert info.position.latitude_deg == pytest.approx(path(time_s)[0], abs=0.6e-7)
        yaw = math.degrees(attitude(time_s)[2])
        quaternion = [getattr(info.attitude_quaternion, name) for name in "wxyz"]
        half = math.radians(yaw) / 2.0
        expected = np.array([math.cos(half), math.sin(half), -math.cos(half), math.sin(half)]) * math.sqrt(0.5)
        # Between attitudes that are up to 0.3 s apart, the turn is even.
        assert abs(float(np.dot(quaternion, expected))) == pytest.approx(1.0, abs=1e-5)


def test_global_positions_alone_are_as_good_as_their_digits(tmp_path):
    with (
        served(live_camera(), serving(tmp_path)) as port,
        Vehicle(port, late_s=0.08, lost=0.05, seed=3),
        ground_station(port) as client,
    ):
        time.sleep(1.0)
        client.camera.start_photo_interval(client.information.component_id, 0.1)
        until(lambda: len(client.infos) >= 20)
        client.camera.stop_photo_interval(client.information.component_id)
        count = len(until(lambda: client.infos))
        assert client.photograph().is_success
        assert len(client.infos) <= count + 3
    for info in client.infos:
        assert error_m(geotag(photograph_of(info)), info.time_utc_us / 1e6 - UNIX_S) < ROUNDING_M


def test_a_photograph_has_the_bytes_of_its_pose(tmp_path):
    camera = live_camera(tilt_deg=20.0)
    with served(camera, serving(tmp_path)) as port, Vehicle(port), ground_station(port) as client:
        info = client.photograph()
        made = camera.component
        time_s = made.captured[info.index].time_boot_ms / 1000.0
        pose = made.track.at(time_s)
        request = made.gimbal.mount(0.0).request(pose, 0.0)
    assert photograph_of(info) == encode(camera.take(request))
    assert (request.tilt_deg, request.roll_deg) == pytest.approx((20.0, 0.0), abs=1e-9)


def test_mavsdk_knows_the_camera(tmp_path):
    pytest.importorskip("mavsdk", reason="its client is the camera's user")
    from mavsdk.plugins.camera.camera import CameraError, CameraResult, Mode, PhotosRange

    camera = live_camera()
    with (
        served(camera, serving(tmp_path, STREAM)) as port,
        Vehicle(port),
        ground_station(port) as client,
    ):
        about, number = client.information, client.information.component_id
        assert (about.vendor_name, number) == ("TerrAInav", 100)
        size = about.horizontal_resolution_px, about.vertical_resolution_px
        assert size == (camera.contract.width_px, camera.contract.height_px)
        until(lambda: client.streams)
        assert client.camera.get_video_stream_info(number).settings.uri == STREAM
        assert client.camera.get_mode(number) == Mode.PHOTO
        assert client.camera.get_storage(number).available_storage_mib > 0.0
        info = client.photograph()
        assert info.position.relative_altitude_m == pytest.approx(info.position.absolute_altitude_m - HOME[2], abs=2e-3)
        photos = client.camera.list_photos(number, PhotosRange.ALL)
        assert [one.file_url for one in photos] == [info.file_url]
        for ask, result in (
            (lambda: client.camera.set_mode(number, Mode.VIDEO), CameraResult.DENIED),
            (lambda: client.camera.start_video(number), CameraResult.ACTION_UNSUPPORTED),
            (lambda: client.camera.start_photo_interval(number, 0.001), CameraResult.DENIED),
        ):
            with pytest.raises(CameraError) as refused:
                ask()
            assert result.name in str(refused.value)


def test_mavsdk_turns_the_gimbal(tmp_path):
    pytest.importorskip("mavsdk", reason="its client is the camera's user")
    from mavsdk.plugins.gimbal.gimbal import ControlMode, Gimbal, GimbalError, GimbalMode, SendMode

    with served(live_camera(), serving(tmp_path)) as port, Vehicle(port), ground_station(port) as client:
        gimbal = Gimbal(client.system)
        number = until(lambda: gimbal.gimbal_list().gimbals)[0].gimbal_id

        def aim(pitch, yaw, mode):
            gimbal.set_angles(number, 0.0, pitch, yaw, mode, SendMode.ONCE)

        with pytest.raises(GimbalError):
            aim(-45.0, 0.0, GimbalMode.YAW_FOLLOW)
        gimbal.take_control(number, ControlMode.PRIMARY)
        with pytest.raises(GimbalError):
            aim(60.0, 0.0, GimbalMode.YAW_FOLLOW)
        aim(-30.0, 90.0, GimbalMode.YAW_LOCK)
        assert tilt_and_heading(client.photograph()) == pytest.approx((-30.0, 90.0), abs=1e-3)
        aim(-50.0, 25.0, GimbalMode.YAW_FOLLOW)
        info = client.photograph()
        heading = math.degrees(attitude(info.time_utc_us / 1e6 - UNIX_S)[2])
        assert tilt_and_heading(info) == pytest.approx((-50.0, heading + 25.0), abs=0.05)
        time.sleep(1.0)
        print(gimbal.get_attitude(number), heading)
        gimbal.set_angular_rates(number, 0.0, 20.0, 0.0, GimbalMode.YAW_FOLLOW, SendMode.ONCE)
        until(lambda: gimbal.get_attitude(number).euler_angle_north.pitch_deg > -45.0)
        gimbal.release_control(number)
        with pytest.raises(GimbalError):
            aim(-45.0, 0.0, GimbalMode.YAW_FOLLOW)


def tilt_and_heading(info):
    """Pitch and heading of the view of a reported photograph."""
    w, x, y, z = (getattr(info.attitude_quaternion, name) for name in "wxyz")
    view = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)
    return math.degrees(math.asin(-view[2])), math.degrees(math.atan2(view[1], view[0]))


class Station:
    """A client of plain messages."""

    def __init__(self, port, address="udpout:127.0.0.1:{}"):
        self.link = mavutil.mavlink_connection(address.format(port), source_system=250, dialect="common")

    def command(self, command, *values, component=100):
        """Result that a command is answered with; it is sent again as long as it is not, as the protocol has it."""
        values = (*values, *[0.0] * (7 - len(values)))

        def result():
            self.link.mav.command_long_send(1, component, command, 0, *values)
            found = self.link.recv_match(type="COMMAND_ACK", blocking=True, timeout=1.0)
            return found if found is not None and found.command == command else None

        return until(result).result

    def receive(self, kind):
        message = self.link.recv_match(type=kind, blocking=True, timeout=PATIENCE_S)
        assert message is not None, kind
        return message


@contextmanager
def station(port, address="udpout:127.0.0.1:{}"):
    made = Station(port, address)
    with contextlib.closing(made.link):
        made.link.mav.heartbeat_send(6, 8, 0, 0, 4)
        yield made


NAN = math.nan


@pytest.mark.parametrize(
    ("command", "values", "result"),
    [
        (common.MAV_CMD_VIDEO_START_CAPTURE, (), common.MAV_RESULT_UNSUPPORTED),
        (common.MAV_CMD_STORAGE_FORMAT, (1, 1), common.MAV_RESULT_UNSUPPORTED),
        (common.MAV_CMD_REQUEST_MESSAGE, (1,), common.MAV_RESULT_UNSUPPORTED),
        (common.MAV_CMD_REQUEST_MESSAGE, (NAN,), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_REQUEST_MESSAGE, (math.inf,), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_REQUEST_MESSAGE, (263, 7), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_REQUEST_MESSAGE, (269,), common.MAV_RESULT_UNSUPPORTED),
        (common.MAV_CMD_IMAGE_START_CAPTURE, (0, 0.0, 5), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_IMAGE_START_CAPTURE, (0, NAN, 0), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_IMAGE_START_CAPTURE, (0, 0.0, NAN), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_IMAGE_START_CAPTURE, (0, 0.0, -1), common.MAV_RESULT_DENIED),
        # No vehicle has sent its poses.
        (common.MAV_CMD_IMAGE_START_CAPTURE, (0, 0.0, 1), common.MAV_RESULT_TEMPORARILY_REJECTED),
        (common.MAV_CMD_IMAGE_START_CAPTURE, (0, 1.0, 0), common.MAV_RESULT_TEMPORARILY_REJECTED),
        (common.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, (-45, 0, NAN, NAN), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE, (NAN, NAN), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE, (-7, 3), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_SET_CAMERA_MODE, (0, NAN), common.MAV_RESULT_DENIED),
        (common.MAV_CMD_IMAGE_STOP_CAPTURE, (), common.MAV_RESULT_ACCEPTED),
    ],
)
def test_what_the_camera_cannot_do_is_refused_as_the_protocol_says(tmp_path, command, values, result):
    with served(live_camera(), serving(tmp_path)) as port, station(port) as client:
        assert client.command(command, *values) == result
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("command", "values", "kind"),
    [
        (common.MAV_CMD_REQUEST_CAMERA_INFORMATION, (1,), "CAMERA_INFORMATION"),
        (common.MAV_CMD_REQUEST_CAMERA_SETTINGS, (1,), "CAMERA_SETTINGS"),
        (common.MAV_CMD_REQUEST_STORAGE_INFORMATION, (0, 1), "STORAGE_INFORMATION"),
        (common.MAV_CMD_REQUEST_CAMERA_CAPTURE_STATUS, (1,), "CAMERA_CAPTURE_STATUS"),
        (common.MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION, (1,), "VIDEO_STREAM_INFORMATION"),
        *[
            (common.MAV_CMD_REQUEST_MESSAGE, (getattr(common, f"MAVLINK_MSG_ID_{kind}"),), kind)
            for kind in ("VIDEO_STREAM_STATUS", "GIMBAL_MANAGER_INFORMATION", "GIMBAL_DEVICE_INFORMATION")
        ],
    ],
)
def test_messages_come_when_asked_for(tmp_path, command, values, kind):
    with served(live_camera(), serving(tmp_path, STREAM)) as port, station(port) as client:
        assert client.command(command, *values) == common.MAV_RESULT_ACCEPTED
        client.receive(kind)


def test_a_repeated_command_takes_one_photograph(tmp_path):
    with served(live_camera(), serving(tmp_path)) as port, Vehicle(port), station(port) as client:
        client.receive("GIMBAL_DEVICE_ATTITUDE_STATUS")  # The camera knows the vehicle's pose.
        for sequence in (5, 5, 6):
            assert client.command(common.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1, sequence) == common.MAV_RESULT_ACCEPTED
        assert [client.receive("CAMERA_IMAGE_CAPTURED").image_index for _ in range(2)] == [0, 1]
        assert client.receive("CAMERA_CAPTURE_STATUS").image_count == 2


def test_a_vehicle_that_vanishes_fails_what_waits_and_refuses_the_next(tmp_path):
    camera = live_camera()
    with served(camera, serving(tmp_path)) as port, station(port) as client:
        with Vehicle(port):
            client.receive("GIMBAL_DEVICE_ATTITUDE_STATUS")
            client.command(common.MAV_CMD_IMAGE_START_CAPTURE, 0, 0.3, 0)
            client.receive("CAMERA_IMAGE_CAPTURED")
        # Those of the time after the vehicle are reported as failed.
        until(lambda: client.receive("CAMERA_IMAGE_CAPTURED").capture_result == 0)
        client.command(common.MAV_CMD_IMAGE_STOP_CAPTURE)
        time.sleep(mavlink.LOST_S)
        assert client.command(common.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1) == common.MAV_RESULT_TEMPORARILY_REJECTED
        # It is back, its clock begins anew.
        with Vehicle(port, boot_s=1.0):
            until(lambda: client.command(common.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1) == common.MAV_RESULT_ACCEPTED)
            until(lambda: client.receive("CAMERA_IMAGE_CAPTURED").time_boot_ms < 500_000)
            assert camera.component.track.counts["restarted"] == 1


def test_photographs_of_former_flights_stay(tmp_path):
    (tmp_path / "000041.jpg").write_bytes(b"of yesterday")
    with served(live_camera(), serving(tmp_path)) as port, Vehicle(port), station(port) as client:
        client.receive("GIMBAL_DEVICE_ATTITUDE_STATUS")
        client.command(common.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1)
        assert client.receive("CAMERA_IMAGE_CAPTURED").image_index == 42
    assert (tmp_path / "000041.jpg").read_bytes() == b"of yesterday"


def test_rubbish_changes_nothing(tmp_path):
    """Random bytes, and messages with random bytes changed, from many places."""
    rng, camera = random.Random(7), live_camera()
    maker = common.MAVLink(None, srcSystem=1, srcComponent=1)
    with served(camera, serving(tmp_path)) as port, station(port) as client:
        for _ in range(20):
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
                for _ in range(50):
                    message = common.MAVLink_command_long_message(1, 100, rng.randrange(1 << 16), 0, *[NAN] * 7)
                    data = bytearray(message.pack(maker))
                    data[rng.randrange(len(data))] = rng.randrange(256)
                    sender.sendto(
                        rng.choice([bytes(data), os.urandom(rng.randrange(300)), bytes(data[:-4])]), ("127.0.0.1", port)
                    )
        assert client.command(common.MAV_CMD_REQUEST_MESSAGE, 259) == common.MAV_RESULT_ACCEPTED
        assert client.receive("CAMERA_INFORMATION").resolution_h == camera.contract.width_px


@pytest.mark.parametrize("kind", ["tcp", "udpout"])
def test_the_camera_calls_where_it_is_told_to(tmp_path, kind):
    port = free_port()

    @asynccontextmanager
    async def opened(server, host, _):
        async with mavlink.serve(server, f"{kind}:{host}:{port}", tmp_path):
            yield

    with served(live_camera(), opened):
        if kind == "udpout":
            with contextlib.closing(mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}")) as vehicle:
                assert vehicle.recv_match(type="HEARTBEAT", blocking=True, timeout=PATIENCE_S).type == 30
            return
        for _ in range(2):
            # It calls again when the vehicle hangs up.
            with socket.create_server(("127.0.0.1", port)) as listening:
                listening.settimeout(PATIENCE_S)
                connection, _ = listening.accept()
                connection.settimeout(PATIENCE_S)
                with connection:
                    connection.sendall(b"\xfd rubbish")
                    parser, found = common.MAVLink(None), []
                    while not found:
                        found = parser.parse_buffer(connection.recv(1 << 12)) or []
                    assert found[0].get_srcComponent() == 100


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("serial:/dev/ttyUSB0", "must be"),
        ("udp:127.0.0.1", "must be"),
        ("udp:127.0.0.1:99999", "must be"),
        ("udp:0.0.0.0:14540", "this machine alone"),
        ("tcp:example.org:5760", "this machine alone"),
    ],
)
def test_other_addresses_are_refused(address, words):
    with pytest.raises(InvalidInput, match=words):
        parse_address(address)


#: 32-bit words of extreme values: infinities, NaN, and least and greatest whole numbers.
EXTREMES = [bytes.fromhex(word) for word in "0000807f 000080ff 0000c07f 00000000 ffffffff ffffff7f 00000080".split()]


def random_messages(rng, cls, maker):
    """A message with random fields, some of them extreme, as it arrives; for the camera if it is for anybody."""
    words = [rng.choice(EXTREMES) if rng.random() < 0.3 else rng.randbytes(4) for _ in range(64)]
    message = object.__new__(cls)
    common.MAVLink_message.__init__(message, cls.id, cls.msgname)
    payload = b"".join(words)[: cls.unpacker.size]
    for found in messages(parser(), message._pack(maker, cls.crc_extra, payload)):
        for name, targets in (("target_system", (0, 1)), ("target_component", (0, 100)), ("command", COMMANDS)):
            if name in cls.fieldnames:
                setattr(found, name, rng.choice(targets))
        yield found


COMMANDS = (1, 512, 521, 522, 525, 527, 530, 1000, 1001, 2000, 2001, 2504)


def test_no_message_of_the_protocol_breaks_the_camera(tmp_path):
    """Well-formed messages with random and extreme values, in a loop in which exceptions end the test."""
    rng, camera, sent, broken = random.Random(11), live_camera(), [], []
    followed = ("COMMAND", "GLOBAL_POSITION", "LOCAL_POSITION_NED", "ATTITUDE", "SYSTEM_TIME", "GPS_GLOBAL", "GIMBAL_M")
    kinds = list(common.mavlink_map.values())
    kinds += [cls for cls in kinds if cls.msgname.startswith(followed)] * 20

    async def converse():
        asyncio.get_running_loop().set_exception_handler(lambda _, context: broken.append(context))
        server = FrameServer(camera)
        component = mavlink.CameraComponent(server, tmp_path, sent.append)
        maker = common.MAVLink(None, srcSystem=1, srcComponent=1)
        component.receive(messages(parser(), common.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3).pack(maker))[0])
        for number in range(6000):
            for message in random_messages(rng, rng.choice(kinds), maker):
                component.receive(message)
            if number % 100 == 0:
                for message in Vehicle.messages(SimpleNamespace(boot_s=0.0, fine=True), number / 100.0):
                    component.receive(messages(parser(), message.pack(maker))[0])
                await asyncio.sleep(0.001)
        await component.close()
        server.close()
        return component

    component = asyncio.run(converse())
    assert broken == []
    assert min(component.track.counts[name] for name in ("taken", "nonsense", "stray")) > 0
    assert len(component.captured) <= component._next
    assert sent
