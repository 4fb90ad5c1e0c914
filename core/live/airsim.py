"""AirSim's interface: frames over msgpack-RPC for its unmodified clients.

Positions are metres north, east and down of home; a camera looks along its x axis, with y to the right and z down, and
without rotation it looks north and level. One call of ``simGetImages`` has one pose and one stamp for all its images.
"""

from __future__ import annotations

import asyncio
import io
import math
import time
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import msgpack
import numpy as np
from PIL import Image

from ..arrays import Bytes, Floats
from ..errors import InvalidInput, TerrAInavError
from ..geodesy.camera import attitude_from_axes
from ..geodesy.local import LocalFrame
from ..geodesy.quaternions import quaternions_from_matrices, rotation_matrices
from ..mission.parts import INSTANCES
from .camera import FrameRequest, LiveFrame
from .serving import FrameServer

#: Version of the interface that this is, and the oldest of clients that it serves.
VERSION = 4
#: Most bytes of a message, and of images in one call.
_MESSAGE_BYTES, _IMAGES = 1 << 20, 16
#: AirSim's types of images.
SCENE, DEPTH_PLANAR, DEPTH_PERSPECTIVE, SEGMENTATION, SURFACE_NORMALS = 0, 1, 2, 5, 6
#: From north, east, down to east, north, up.
_ENU_OF_NED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
#: The product that each type of image shows.
_PRODUCTS = {SCENE: "", DEPTH_PLANAR: "depth", DEPTH_PERSPECTIVE: "depth", SURFACE_NORMALS: "normals"}
#: Angles of cameras by their names: those of a multirotor of AirSim, which look ahead, down or back.
_LEVEL, _DOWN, _BACK = (1.0, 0.0, 0.0, 0.0), (math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0), (0.0, 0.0, 0.0, 1.0)
_CAMERAS = {
    **dict.fromkeys(("0", "front_center", "1", "front_right", "2", "front_left"), _LEVEL),
    **dict.fromkeys(("3", "bottom_center"), _DOWN),
    **dict.fromkeys(("4", "back_center"), _BACK),
}


@dataclass
class BodyPose:
    """Position in metres and attitude as a quaternion (w, x, y, z), in the axes of what carries it."""

    position_m: Floats = field(default_factory=lambda: np.zeros(3))
    quaternion: Floats = field(default_factory=lambda: np.array(_LEVEL))

    @classmethod
    def read(cls, pose: Any) -> BodyPose:
        """Read AirSim's ``Pose``; raises InvalidInput unless it is one."""
        try:
            position = np.array([pose["position"][f"{axis}_val"] for axis in "xyz"], np.float64)
            quaternion = np.array([pose["orientation"][f"{axis}_val"] for axis in "wxyz"], np.float64)
        except (KeyError, TypeError, ValueError) as wrong:
            raise InvalidInput("pose: must have position and orientation with numbers") from wrong
        length = float(np.linalg.norm(quaternion))
        if not (np.isfinite(position).all() and math.isfinite(length) and length > 1e-6):
            raise InvalidInput("pose: position and orientation must be finite, and the quaternion not zero")
        return cls(position, quaternion / length)

    def on(self, carrier: BodyPose) -> BodyPose:
        """Return the pose in the axes that the carrier's pose is in."""
        turn = carrier.turn
        quaternion = quaternions_from_matrices((turn @ self.turn)[np.newaxis])[0]
        return BodyPose(carrier.position_m + turn @ self.position_m, quaternion)

    @property
    def turn(self) -> Floats:
        """Rotation (3, 3) to the axes of the carrier."""
        found: Floats = rotation_matrices(self.quaternion[np.newaxis])[0]
        return found

    def write(self) -> dict[str, Any]:
        """AirSim's ``Pose``."""
        position = {f"{axis}_val": value for axis, value in zip("xyz", self.position_m.tolist())}
        orientation = {f"{axis}_val": value for axis, value in zip("wxyz", self.quaternion.tolist())}
        return {"position": position, "orientation": orientation}


class AirSim:
    """One simulated vehicle with its cameras, which all clients share.

    Parameters
    ----------
    server : FrameServer
    """

    def __init__(self, server: FrameServer) -> None:
        self.server = server
        start = server.camera.start
        ground = server.camera.plan(start)
        self.home = LocalFrame(start.lat_deg, start.lon_deg, float(ground.ground_m[0]))
        self._first = BodyPose(np.array([0.0, 0.0, -start.up_m]))
        self.vehicle, self.cameras = (
            self._first,
            {name: BodyPose(quaternion=np.array(q)) for name, q in _CAMERAS.items()},
        )
        self._methods: dict[str, Callable[..., Any]] = {
            "ping": lambda: True,
            "getServerVersion": lambda: VERSION,
            "getMinRequiredClientVersion": lambda: VERSION,
            "reset": self._reset,
            "enableApiControl": lambda *_: None,
            "isApiControlEnabled": lambda *_: True,
            "armDisarm": lambda *_: True,
            "simPause": lambda _: None,
            "simIsPaused": lambda: False,
            "listVehicles": lambda: [""],
            "getHomeGeoPoint": self._home,
            "simGetVehiclePose": lambda _="": self.vehicle.write(),
            "simSetVehiclePose": self._set_vehicle,
            "simSetCameraPose": self._set_camera,
            "simGetCameraInfo": self._camera_info,
            "simGetDistortionParams": self._distortion,
            "simListInstanceSegmentationObjects": self._objects,
        }

    async def call(self, method: str, parameters: Sequence[Any]) -> Any:
        """Result of a method.

        Raises
        ------
        TerrAInavError
            The method is unknown, or its parameters or the pose are not valid.
        """
        if method == "simGetImages":
            return await self._images(*parameters)
        if method == "simGetImage":
            name, image_type, *_ = parameters
            asked = {"camera_name": name, "image_type": image_type, "compress": True, "pixels_as_float": False}
            return (await self._images([asked]))[0]["image_data_uint8"]
        found = self._methods.get(method)
        if found is None:
            raise InvalidInput("method {0!r}: is none of a camera's: {1}", method, ", ".join(self._methods))
        try:
            return found(*parameters)
        except TypeError as wrong:
            raise InvalidInput("method {0!r}: takes other parameters ({1})", method, wrong) from wrong

    def _reset(self) -> None:
        self.vehicle = self._first
        self.cameras = {name: BodyPose(quaternion=np.array(q)) for name, q in _CAMERAS.items()}

    def _home(self, _: str = "") -> dict[str, float]:
        home = self.home
        return {"latitude": home.lat_deg, "longitude": home.lon_deg, "altitude": home.height_m}

    def _set_vehicle(self, pose: Any, _ignores_collisions: bool = True, _vehicle: str = "") -> None:
        self.vehicle = BodyPose.read(pose)

    def _set_camera(self, name: str, pose: Any, _vehicle: str = "") -> None:
        self._camera(name)
        self.cameras[name] = BodyPose.read(pose)

    def _camera(self, name: str) -> BodyPose:
        if name not in self.cameras:
            raise InvalidInput("camera {0!r}: must be one of {1}", name, ", ".join(self.cameras))
        return self.cameras[name]

    def _camera_info(self, name: str, _vehicle: str = "") -> dict[str, Any]:
        placed, camera = self._camera(name).on(self.vehicle), self.server.camera.mission.camera
        return {"pose": placed.write(), "fov": camera.horizontal_fov_deg, "proj_mat": {"matrix": self._projection()}}

    def _projection(self) -> list[list[float]]:
        """Projection from metres ahead, right and down to the image's plane, as AirSim states it."""
        contract = self.server.camera.contract
        across, down = 2.0 * contract.fx_px / contract.width_px, 2.0 * contract.fy_px / contract.height_px
        return [[0.0, across, 0.0, 0.0], [0.0, 0.0, -down, 0.0], [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]]

    def _distortion(self, name: str, _vehicle: str = "") -> list[float]:
        self._camera(name)
        values = dict(self.server.camera.contract.distortion)
        return [values.get(one, 0.0) for one in ("k1", "k2", "k3", "p1", "p2")]

    def _objects(self) -> list[str]:
        labels = self.server.camera.labels
        return [] if labels is None else ["-".join(map(str, row[1:])) for row in labels.instance_rows()]

    async def _images(self, asked: Any, _vehicle: str = "") -> list[dict[str, Any]]:
        """Images of one instant: one frame for each camera."""
        if not isinstance(asked, (list, tuple)) or not 0 < len(asked) <= _IMAGES:
            raise InvalidInput("requests: must be a list of 1 to {0} images", _IMAGES)
        stamp_ns, vehicle = time.time_ns(), self.vehicle
        wanted: dict[str, dict[str, None]] = {}
        for one in asked:
            name, kind = _field(one, "camera_name", str), _field(one, "image_type", int)
            product = self._product(kind)
            products = wanted.setdefault(name, {})
            if product:
                products[product] = None
        placed = {name: self._camera(name).on(vehicle) for name in wanted}
        frames = {
            name: await self.server.frame(self.request(placed[name], stamp_ns / 1e9, tuple(products)))
            for name, products in wanted.items()
        }
        make = partial(_responses, asked, frames, placed, stamp_ns)
        return await self.server.run(make)

    def _product(self, kind: int) -> str:
        if kind == SEGMENTATION and self.server.camera.labels is not None:
            return INSTANCES
        if kind not in _PRODUCTS:
            raise InvalidInput(
                "image type {0}: must be scene 0, depth 1 or 2, segmentation 5 (with labels), or normals 6", kind
            )
        return _PRODUCTS[kind]

    def request(self, camera: BodyPose, time_s: float, products: tuple[str, ...] = ()) -> FrameRequest:
        """Request for a frame of a camera placed in the axes of home."""
        north, east, down = camera.position_m.tolist()
        lat, lon, height = (float(at) for at in self.home.geodetic(np.array([east, north, -down])))
        # From north, east, down at home to east, north, up at the camera.
        turn = (
            self.home.rotations(lat, lon) @ np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]) @ camera.turn
        )
        yaw, tilt, roll = (float(angle) for angle in attitude_from_axes(turn[:, 1], -turn[:, 2], turn[:, 0]))
        return FrameRequest(lat, lon, height, yaw, tilt, roll, time_s, products, above_ellipsoid=True)


def _field(values: Any, name: str, kind: type) -> Any:
    if not isinstance(values, Mapping) or not isinstance(values.get(name), kind):
        raise InvalidInput("request: {0} is missing or no {1}", name, kind.__name__)
    return values[name]


def _responses(
    asked: Sequence[Mapping[str, Any]], frames: Mapping[str, LiveFrame], placed: Mapping[str, BodyPose], stamp_ns: int
) -> list[dict[str, Any]]:
    """AirSim's ``ImageResponse`` of each request."""
    return [_response(one, frames[one["camera_name"]], placed[one["camera_name"]], stamp_ns) for one in asked]


def _response(asked: Mapping[str, Any], frame: LiveFrame, placed: BodyPose, stamp_ns: int) -> dict[str, Any]:
    kind, as_float = asked["image_type"], bool(asked.get("pixels_as_float"))
    compressed = bool(asked.get("compress", True)) and not as_float
    colours, values = b"", []
    if as_float or kind in (DEPTH_PLANAR, DEPTH_PERSPECTIVE):
        values, as_float, compressed = _floats(kind, frame), True, False
    else:
        pixels = _colours(kind, frame)
        colours = _png(pixels) if compressed else pixels[..., ::-1].tobytes()
    pose = placed.write()
    return {
        "image_data_uint8": colours,
        "image_data_float": values,
        "camera_position": pose["position"],
        "camera_orientation": pose["orientation"],
        "time_stamp": stamp_ns,
        "message": "",
        "pixels_as_float": as_float,
        "compress": compressed,
        "width": frame.contract.width_px,
        "height": frame.contract.height_px,
        "image_type": kind,
        "annotation_name": "",
    }


def _floats(kind: int, frame: LiveFrame) -> list[float]:
    """Metres to what the pixels show: along the view, or along each pixel's ray; 65504 where they see none."""
    if kind not in (DEPTH_PLANAR, DEPTH_PERSPECTIVE):
        raise InvalidInput("image type {0}: has no floating point values, and depth 1 or 2 have", kind)
    depth = frame.products["depth"][..., 0].astype(np.float64)
    if kind == DEPTH_PERSPECTIVE:
        depth = depth * frame.per_depth
    values: list[float] = np.where(np.isnan(depth), 65504.0, depth).astype(np.float32).ravel().tolist()
    return values


def _colours(kind: int, frame: LiveFrame) -> Bytes:
    """Red, green and blue (h, w, 3) of an image."""
    colours: Bytes
    if kind == SCENE:
        colours = frame.picture[..., :3]
        colours = colours if colours.shape[-1] == 3 else colours[..., :1].repeat(3, axis=-1)
    elif kind == SURFACE_NORMALS:
        normals = frame.products["normals"][..., :3]
        colours = np.where(np.isnan(normals), 0.0, np.rint((normals + 1.0) * 127.5)).astype(np.uint8)
    else:
        ids = frame.products[INSTANCES].astype(np.uint32)
        colours = np.stack([ids >> 16 & 255, ids >> 8 & 255, ids & 255], axis=-1).astype(np.uint8)
    return colours


def _png(pixels: Bytes) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG", compress_level=1)
    return buffer.getvalue()


@asynccontextmanager
async def serve(server: FrameServer, host: str, port: int) -> AsyncIterator[None]:
    """Serve AirSim's clients until the end of the block; raises OSError if the port cannot be used."""
    world = AirSim(server)
    conversations: set[asyncio.Task[None]] = set()

    async def converse(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        unpacker, packer = msgpack.Unpacker(max_buffer_size=_MESSAGE_BYTES), msgpack.Packer()
        try:
            while data := await reader.read(1 << 16):
                unpacker.feed(data)
                for message in unpacker:
                    answer = await _answer(world, message)
                    if answer is not None:
                        writer.write(packer.pack(answer))
                        await writer.drain()
        except (OSError, ValueError, msgpack.exceptions.UnpackException):
            # The client is gone, or sends what is no message.
            pass
        finally:
            writer.close()

    def begin(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        conversation = asyncio.ensure_future(converse(reader, writer))
        conversations.add(conversation)
        conversation.add_done_callback(conversations.discard)

    listening = await asyncio.start_server(begin, host, port)
    try:
        yield
    finally:
        listening.close()
        for conversation in conversations:
            conversation.cancel()
        await asyncio.gather(*conversations, return_exceptions=True)


async def _answer(world: AirSim, message: Any) -> list[Any] | None:
    """Response to a message of msgpack-RPC; None for a notification; ValueError for anything else."""
    kind, *more = message if isinstance(message, list) and len(message) in (3, 4) else (None,)
    if kind not in (0, 2) or not isinstance(more[-2], str) or not isinstance(more[-1], list):
        raise ValueError("no message of msgpack-RPC")
    error, result = None, None
    try:
        result = await world.call(more[-2], more[-1])
    except TerrAInavError as wrong:
        error = str(wrong)
    return [1, more[0], error, result] if kind == 0 else None
