"""A MAVLink camera with a gimbal, on a vehicle whose poses it follows.

The protocol is that of https://mavlink.io/en/services/camera.html. The vehicle is the first system with an autopilot
that is heard; the camera is a component of it. An exposure is at a whole millisecond of the vehicle's clock, in which
messages count; its photograph waits for the poses that follow.
"""

from __future__ import annotations

import asyncio
import math
import shutil
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from pymavlink.dialects.v20 import common as protocol

from ..errors import InvalidInput, TerrAInavError
from ..storage.files import make_folder, write_new
from .camera import FrameRequest
from .encoding import encode
from .following import Mount, PoseTrack, VehiclePose, heading_deg
from .gimbal import CAPABILITIES, LIMITS_RAD, Gimbal, Sender
from .links import open_link
from .serving import FrameServer
from .telemetry import MESSAGES, Telemetry

#: The camera's component, and the gimbal device that it manages itself.
COMPONENT, GIMBAL = protocol.MAV_COMP_ID_CAMERA, 1
#: Seconds without poses after which the vehicle is lost; longest wait for the poses around an exposure.
LOST_S, PATIENCE_S = 2.0, 1.0
#: Shortest interval between photographs, seconds; most that wait; most whose message can be asked for again.
FASTEST_S, WAITING, REMEMBERED = 0.1, 32, 1_000
#: Bytes that must stay free on the disk.
_SPARE_BYTES = 100 << 20
#: Seconds between attitudes of the gimbal; attitudes to a heartbeat, and to messages that some clients do not ask for.
_TICK_S, _HEARTBEAT, _UNASKED = 0.2, 5, 25
_ACCEPTED, _LATER, _DENIED, _UNSUPPORTED, _FAILED = (
    int(getattr(protocol, f"MAV_RESULT_{name}"))
    for name in ("ACCEPTED", "TEMPORARILY_REJECTED", "DENIED", "UNSUPPORTED", "FAILED")
)


@dataclass(frozen=True)
class _Exposure:
    """What is decided at the moment of an exposure."""

    index: int
    time_ms: int
    mount: Mount


class CameraComponent:
    """The camera as a component of a vehicle; used from one event loop.

    Parameters
    ----------
    server : FrameServer
    folder : Path
        Where photographs are written.
    send : callable
        Sends bytes to all clients.
    sea_level_m : float
        Height of the vehicle's sea level above the ellipsoid.
    clock : callable
        Monotonic time in seconds.
    """

    def __init__(
        self,
        server: FrameServer,
        folder: Path,
        send: Callable[[bytes], None],
        *,
        sea_level_m: float = 0.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.server, self.folder = server, folder
        self.write, self._sea_level_m, self._clock = send, sea_level_m, clock
        self.track = PoseTrack()
        self._telemetry = Telemetry(self.track)
        self.gimbal = Gimbal(Mount(server.camera.start.tilt_deg - 90.0))
        self.mav = protocol.MAVLink(self, srcSystem=1, srcComponent=COMPONENT)
        self.captured: dict[int, Any] = {}
        self._start_s, self._vehicle = clock(), 0
        self._heard, self._tasks, self._interval = asyncio.Event(), set[Any](), _Interval()
        # Photographs of former flights stay.
        self._next = 1 + max((int(one.stem) for one in folder.glob("*.jpg") if one.stem.isdecimal()), default=-1)
        self._waiting, self._last_order = 0, (self.gimbal.control, 0)
        self._commands: dict[int, Callable[[Sequence[float], Sender], int]] = {
            protocol.MAV_CMD_REQUEST_MESSAGE: lambda p, _: self._request(int(p[0]), p[1]),
            protocol.MAV_CMD_IMAGE_START_CAPTURE: self._start_images,
            protocol.MAV_CMD_IMAGE_STOP_CAPTURE: lambda *_: self._stop_images(),
            protocol.MAV_CMD_SET_CAMERA_MODE: lambda p, _: _ACCEPTED if p[1] == protocol.CAMERA_MODE_IMAGE else _DENIED,
            protocol.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW: lambda p, by: self._aim(by, p[:4], int(p[4])),
            protocol.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE: self._configure,
            **{command: partial(self._request_former, number) for command, number in _FORMER.items()},
        }
        self._messages: dict[int, Callable[[], None]] = {
            protocol.MAVLINK_MSG_ID_CAMERA_INFORMATION: self._send_camera,
            protocol.MAVLINK_MSG_ID_CAMERA_SETTINGS: lambda: self.mav.camera_settings_send(
                self._boot_ms(), protocol.CAMERA_MODE_IMAGE
            ),
            protocol.MAVLINK_MSG_ID_STORAGE_INFORMATION: self._send_storage,
            protocol.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS: self._send_status,
            protocol.MAVLINK_MSG_ID_VIDEO_STREAM_INFORMATION: self._send_stream,
            protocol.MAVLINK_MSG_ID_VIDEO_STREAM_STATUS: lambda: self.mav.video_stream_status_send(
                1, *self._stream_figures()
            ),
            protocol.MAVLINK_MSG_ID_GIMBAL_MANAGER_INFORMATION: self._send_gimbal,
            protocol.MAVLINK_MSG_ID_GIMBAL_MANAGER_STATUS: self._send_gimbal_status,
            protocol.MAVLINK_MSG_ID_GIMBAL_DEVICE_INFORMATION: self._send_gimbal_device,
            protocol.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS: self._send_gimbal_attitude,
        }

    def request(self) -> FrameRequest:
        """Request for the frame of the vehicle's last pose; raises InvalidInput without one."""
        pose = self.track.latest()
        return self._asked(pose, self.gimbal.mount(self._clock()))

    def _asked(self, pose: VehiclePose, mount: Mount) -> FrameRequest:
        unix_us = self._telemetry.unix_us(round(pose.time_s * 1000.0))
        return mount.request(pose, unix_us / 1e6, self._sea_level_m)

    def receive(self, message: Any) -> None:
        """Handle a message."""
        kind, sender = message.get_type(), (message.get_srcSystem(), message.get_srcComponent())
        if kind == "HEARTBEAT" and message.autopilot != protocol.MAV_AUTOPILOT_INVALID and not self._vehicle:
            self._vehicle = self.mav.srcSystem = sender[0]
        if kind in MESSAGES:
            if sender[0] == self._vehicle:
                self._telemetry.receive(message, self._clock())
                self._heard.set()
        elif kind in _ORDERS:
            to = message.target_system, message.target_component
            if to[0] in (0, self.mav.srcSystem) and to[1] in (0, COMPONENT):
                self._obey(kind, message, sender)

    def _obey(self, kind: str, message: Any, sender: Sender) -> None:
        if kind in ("COMMAND_LONG", "COMMAND_INT"):
            last = ("param5", "param6", "param7") if kind == "COMMAND_LONG" else ("x", "y", "z")
            names = ("param1", "param2", "param3", "param4", *last)
            do = self._commands.get(message.command)
            if do is None and message.target_component == 0:
                return  # Somebody else's.
            try:
                result = _UNSUPPORTED if do is None else do([getattr(message, name) for name in names], sender)
            except (ValueError, OverflowError):
                # NaN or infinity for a whole number.
                result = _DENIED
            self.mav.command_ack_send(message.command, result, 0, 0, *sender)
        else:
            values = (message.pitch, message.yaw, message.pitch_rate, message.yaw_rate)
            self._aim(sender, [math.degrees(one) for one in values], message.flags)

    # Photographs

    def _start_images(self, values: Sequence[float], sender: Sender) -> int:
        interval_s, count, sequence = values[1], int(values[2]), int(values[3])
        if count < 0 or (count != 1 and not FASTEST_S <= interval_s < math.inf):
            return _DENIED
        if count == 1:
            if sequence and self._last_order == (sender, sequence):
                return _ACCEPTED  # The command again, as its acknowledgement was lost.
            result = self._expose()
            if result == _ACCEPTED:
                self._last_order = (sender, sequence)
            return result
        self._stop_images()
        result = self._expose()
        if result == _ACCEPTED:
            self._interval = _Interval(interval_s, self._run(self._expose_each(interval_s, count - 1)))
        return result

    async def _expose_each(self, interval_s: float, count: int) -> None:
        """Take further photographs at an interval; a count below 0 is no end."""
        due_s = self._clock()
        while count != 0:
            due_s += interval_s
            await asyncio.sleep(max(0.0, due_s - self._clock()))
            self._expose()
            count -= 1
        self._interval = _Interval()

    def _stop_images(self) -> int:
        self._interval.stop()
        self._interval = _Interval()
        return _ACCEPTED

    def _expose(self) -> int:
        """Take a photograph now; returns the result for the acknowledgement."""
        now_s = self._clock()
        if now_s - self.track.last_arrival_s > LOST_S or self._waiting >= WAITING:
            return _LATER
        if self._free_bytes() < _SPARE_BYTES:
            return _FAILED
        time_ms = math.ceil(self.track.time_s(now_s) * 1000.0)
        exposure = _Exposure(self._next, time_ms, self.gimbal.mount(now_s))
        self._next += 1
        self._waiting += 1
        self._run(self._photograph(exposure))
        return _ACCEPTED

    async def _photograph(self, exposure: _Exposure) -> None:
        """Write the photograph of an exposure, and report it."""
        pose, is_taken, path = None, False, self.folder / f"{exposure.index:06d}.jpg"
        try:
            pose = await self._pose(exposure.time_ms / 1000.0)
            make = partial(_written, self.server, self._asked(pose, exposure.mount), path)
            is_taken = await self.server.run(make)
        except TerrAInavError:
            # Reported as a photograph that failed.
            is_taken = False
        finally:
            self._waiting -= 1
        self._report(exposure, pose, path.absolute().as_uri() if is_taken else "")

    async def _pose(self, time_s: float) -> VehiclePose:
        """Pose at a time, once the poses around it are known; InvalidInput after a while without them."""
        end_s = self._clock() + PATIENCE_S
        while self.track.last_s < time_s and (left_s := end_s - self._clock()) > 0.0:
            self._heard.clear()
            with suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._heard.wait(), left_s)
        # The protocol cannot say that a pose is extrapolated.
        return self.track.at(time_s, furthest_s=0.0)

    def _report(self, exposure: _Exposure, pose: VehiclePose | None, address: str) -> None:
        place, quaternion = (0, 0, 0, 0), [0.0] * 4
        if pose is not None:
            alt_mm = round(pose.height_m * 1000.0)
            place = round(pose.lat_deg * 1e7), round(pose.lon_deg * 1e7), alt_mm, alt_mm - self._telemetry.home_alt_mm
            quaternion = exposure.mount.quaternion(pose.quaternion).tolist()
        url = address.encode() if len(address) <= 204 else b""
        report = protocol.MAVLink_camera_image_captured_message(
            exposure.time_ms % (1 << 32),
            self._telemetry.unix_us(exposure.time_ms),
            0,
            *place,
            quaternion,
            exposure.index,
            int(bool(address)),
            url,
        )
        self.captured[exposure.index] = report
        if len(self.captured) > REMEMBERED:
            del self.captured[next(iter(self.captured))]
        self.mav.send(report)

    def _free_bytes(self) -> int:
        return shutil.disk_usage(self.folder).free

    # Messages

    def _send_heartbeat(self) -> None:
        self.mav.heartbeat_send(
            protocol.MAV_TYPE_CAMERA, protocol.MAV_AUTOPILOT_INVALID, 0, 0, protocol.MAV_STATE_ACTIVE
        )

    def announce(self) -> None:
        """Begin to send what clients wait for without asking."""
        self._run(self._announce())

    async def _announce(self) -> None:
        number = 0
        while True:
            self._send_gimbal_attitude()
            if number % _HEARTBEAT == 0:
                self._send_heartbeat()
            if number % _UNASKED == 0:
                self._send_state()
            number += 1
            await asyncio.sleep(_TICK_S)

    def _request_former(self, number: int, values: Sequence[float], _: Sender) -> int:
        # A flag that asks for the message comes first, or after the number of a storage or stream.
        return self._request(number, values[3]) if any(values[:2]) else _ACCEPTED

    def _request(self, number: int, value: float) -> int:
        if number == protocol.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED:
            found = self.captured.get(int(value))
            if found is None:
                return _DENIED
            send: Callable[[], None] | None = partial(self.mav.send, found)
        else:
            send = self._message(number)
        if send is None:
            return _UNSUPPORTED
        asyncio.get_running_loop().call_soon(send)
        return _ACCEPTED

    def _boot_ms(self) -> int:
        return int((self._clock() - self._start_s) * 1000.0) % (1 << 32)

    def _send_camera(self) -> None:
        contract = self.server.camera.contract
        flags = protocol.CAMERA_CAP_FLAGS_CAPTURE_IMAGE
        if self.server.video:
            flags |= protocol.CAMERA_CAP_FLAGS_HAS_VIDEO_STREAM
        self.mav.camera_information_send(
            self._boot_ms(),
            _text("TerrAInav", 32),
            _text("Virtual camera", 32),
            0,
            *[math.nan] * 3,
            contract.width_px,
            contract.height_px,
            0,
            flags,
            0,
            b"",
            GIMBAL,
        )
        self._send_state()

    def _send_state(self) -> None:
        for number in _STATE:
            send = self._message(number)
            if send is not None:
                send()

    def _message(self, number: int) -> Callable[[], None] | None:
        """What sends a message; None for one that the camera lacks."""
        return None if number in _OF_VIDEO and not self.server.video else self._messages.get(number)

    def _send_stream(self) -> None:
        name, address, kind = b"TerrAInav", self.server.video.encode(), protocol.VIDEO_STREAM_TYPE_RTSP
        figures, encoding = self._stream_figures(), protocol.VIDEO_STREAM_ENCODING_H264
        self.mav.video_stream_information_send(1, 1, kind, *figures, name, address, encoding)

    def _stream_figures(self) -> tuple[float, ...]:
        """Flags, rate, width, height, bits per second (0: unknown), rotation, field of view."""
        contract = self.server.camera.contract
        field_deg = math.degrees(2.0 * math.atan(contract.width_px / (2.0 * contract.fx_px)))
        running = protocol.VIDEO_STREAM_STATUS_FLAGS_RUNNING
        return running, 0.0, contract.width_px, contract.height_px, 0, 0, round(field_deg)

    def _send_storage(self) -> None:
        usage = shutil.disk_usage(self.folder)
        mib = [one / (1 << 20) for one in (usage.total, usage.used, usage.free)]
        status = protocol.STORAGE_STATUS_READY
        self.mav.storage_information_send(
            self._boot_ms(), 1, 1, status, *mib, math.nan, math.nan, protocol.STORAGE_TYPE_OTHER
        )

    def _send_status(self) -> None:
        is_set, busy = self._interval.is_set, self._waiting > 0
        free_mib = self._free_bytes() / (1 << 20)
        self.mav.camera_capture_status_send(
            self._boot_ms(), 2 * is_set + busy, 0, self._interval.interval_s, 0, free_mib, self._next
        )

    # Gimbal

    def _heading_deg(self) -> float:
        try:
            return heading_deg(self.track.latest().quaternion)
        except InvalidInput:
            return 0.0

    def _aim(self, sender: Sender, values: Sequence[float], flags: int) -> int:
        """Move the gimbal by pitch, yaw and their rates, degrees; NaN for what stays."""
        if sender != self.gimbal.control or not self.gimbal.move(self._clock(), values, flags, self._heading_deg()):
            return _DENIED
        return _ACCEPTED

    def _configure(self, values: Sequence[float], sender: Sender) -> int:
        """Who controls the gimbal: -1 leaves it, -2 is the sender, -3 releases what the sender has."""
        system, component = int(values[0]), int(values[1])
        if system == component == -2:
            self.gimbal.control = sender
        elif system == component == -3:
            if self.gimbal.control == sender:
                self.gimbal.control = (0, 0)
        elif 0 <= system <= 255 and 0 <= component <= 255:
            self.gimbal.control = system, component
        elif not system == component == -1:
            return _DENIED
        self._send_gimbal_status()
        return _ACCEPTED

    def _send_gimbal(self) -> None:
        self.mav.gimbal_manager_information_send(self._boot_ms(), CAPABILITIES, GIMBAL, *LIMITS_RAD)

    def _send_gimbal_device(self) -> None:
        names = [name.encode() for name in ("TerrAInav", "Virtual gimbal", "")]
        self.mav.gimbal_device_information_send(
            self._boot_ms(), *names, 0, 0, 0, CAPABILITIES, 0, *LIMITS_RAD, gimbal_device_id=GIMBAL
        )

    def _send_gimbal_status(self) -> None:
        self.mav.gimbal_manager_status_send(self._boot_ms(), self.gimbal.flags, GIMBAL, *self.gimbal.control, 0, 0)

    def _send_gimbal_attitude(self) -> None:
        with suppress(InvalidInput):
            turn = self.gimbal.mount(self._clock()).quaternion(self.track.latest().quaternion).tolist()
            flags = self.gimbal.flags | protocol.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME
            rates, heading = [math.nan] * 3, math.radians(self._heading_deg())
            self.mav.gimbal_device_attitude_status_send(
                0, 0, self._boot_ms(), flags, turn, *rates, 0, delta_yaw=heading, gimbal_device_id=GIMBAL
            )

    # Tasks

    def _run(self, work: Awaitable[None]) -> asyncio.Task[None]:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    async def close(self) -> None:
        """Stop what is under way."""
        tasks = list(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


class _Interval(NamedTuple):
    """Photographs at an interval, under way or not."""

    interval_s: float = 0.0
    task: asyncio.Task[None] | None = None

    @property
    def is_set(self) -> bool:
        return self.task is not None

    def stop(self) -> None:
        if self.task is not None:
            self.task.cancel()


#: Messages that ask for something.
_ORDERS = ("COMMAND_LONG", "COMMAND_INT", "GIMBAL_MANAGER_SET_PITCHYAW")
#: Messages of video streams.
_OF_VIDEO = (protocol.MAVLINK_MSG_ID_VIDEO_STREAM_INFORMATION, protocol.MAVLINK_MSG_ID_VIDEO_STREAM_STATUS)
#: Messages that some clients do not ask for, or late.
_STATE = (
    protocol.MAVLINK_MSG_ID_CAMERA_SETTINGS,
    protocol.MAVLINK_MSG_ID_STORAGE_INFORMATION,
    protocol.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS,
    protocol.MAVLINK_MSG_ID_VIDEO_STREAM_INFORMATION,
    protocol.MAVLINK_MSG_ID_GIMBAL_MANAGER_STATUS,
)
#: The protocol's former commands for single messages.
_FORMER = {
    protocol.MAV_CMD_REQUEST_CAMERA_INFORMATION: protocol.MAVLINK_MSG_ID_CAMERA_INFORMATION,
    protocol.MAV_CMD_REQUEST_CAMERA_SETTINGS: protocol.MAVLINK_MSG_ID_CAMERA_SETTINGS,
    protocol.MAV_CMD_REQUEST_STORAGE_INFORMATION: protocol.MAVLINK_MSG_ID_STORAGE_INFORMATION,
    protocol.MAV_CMD_REQUEST_CAMERA_CAPTURE_STATUS: protocol.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS,
    protocol.MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION: protocol.MAVLINK_MSG_ID_VIDEO_STREAM_INFORMATION,
}


def _text(text: str, length: int) -> bytes:
    return text.encode().ljust(length, b"\0")


def _written(server: FrameServer, asked: FrameRequest, path: Path) -> bool:
    """Write the photograph of a request; False if there is a file of its name."""
    return write_new(path, encode(server.camera.take(asked)))


@asynccontextmanager
async def serve(
    server: FrameServer, address: str, folder: Path, *, sea_level_m: float = 0.0
) -> AsyncIterator[CameraComponent]:
    """Be a vehicle's camera until the end of the block.

    Parameters
    ----------
    address : str
        ``udp:HOST:PORT``, where the vehicle calls; ``udpout:HOST:PORT`` or ``tcp:HOST:PORT``, where it is called.
    folder : Path
        Where photographs are written; made if it is missing.

    Raises
    ------
    InvalidInput
        Another address, or one of another machine.
    OSError
        The port cannot be used.
    OutputError
        The folder cannot be made.
    """
    async with open_link(address) as link:
        make_folder(folder)
        component = CameraComponent(server, folder, link.send, sea_level_m=sea_level_m)
        link.receive = component.receive
        component.announce()
        try:
            with server.following(component.request):
                yield component
        finally:
            await component.close()
