"""Frames over HTTP and WebSocket, and the page that shows them."""

from __future__ import annotations

import asyncio
import hmac
import json
import math
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager
from functools import partial
from typing import Any
from urllib.parse import urlsplit

from aiohttp import WSMsgType, web

from ..errors import InvalidInput, TerrAInavError
from ..numbers import real_number
from ..resources import read_text
from ..text.safe_json import parse_json
from .camera import FrameRequest, LiveFrame
from .choices import LOOPBACK
from .encoding import MEDIA_TYPES, PICTURE, encode
from .realtime import RecentPoses, TimedFrame
from .serving import BusyError, FrameServer

#: Most bytes of a message of poses.
_MESSAGE_BYTES = 1 << 16
#: Names of a frame's parameters, and the fields of `FrameRequest` that they give.
_FIELDS = {
    "lat": "lat_deg",
    "lon": "lon_deg",
    "agl": "up_m",
    "height": "up_m",
    "yaw": "yaw_deg",
    "tilt": "tilt_deg",
    "roll": "roll_deg",
    "time": "time_s",
}
_OTHERS = ("image", "format", "deadline_ms", "follow", "id", "token")
#: Values of a parameter that is on.
_YES = ("1", 1, True)
_Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class FrameQuery:
    """A frame and its form, as a client asks for them.

    Parameters
    ----------
    followed : callable
        Request for the frame of a followed vehicle.
    arrived_s : float or None
        Time of the monotonic clock when the query arrived; None for now.
    """

    def __init__(
        self, values: Mapping[str, Any], followed: Callable[[], FrameRequest], arrived_s: float | None = None
    ) -> None:
        unknown = [name for name in values if name not in _FIELDS and name not in _OTHERS]
        if unknown:
            raise InvalidInput("parameter {0!r}: must be one of {1}", unknown[0], ", ".join((*_FIELDS, *_OTHERS[:4])))
        self.image, self.format = str(values.get("image", PICTURE)), str(values.get("format", "jpg"))
        asked = followed() if values.get("follow") in _YES else _asked_pose(values)
        self.request = asked._replace(products=() if self.image == PICTURE else (self.image,))
        deadline = values.get("deadline_ms")
        self.deadline_s = None if deadline is None else _number("deadline_ms", deadline) / 1000.0
        self.arrived_s = time.monotonic() if arrived_s is None else arrived_s

    def encode(self, frame: LiveFrame) -> bytes:
        """Image file of a frame; none for JSON."""
        return b"" if self.format == "json" else encode(frame, self.image, self.format)


def _asked_pose(values: Mapping[str, Any]) -> FrameRequest:
    for name in ("lat", "lon"):
        if name not in values:
            raise InvalidInput("parameter {0}: is missing", name)
    if ("agl" in values) == ("height" in values):
        raise InvalidInput("parameters agl and height: must be one of the two, above ground or the ellipsoid")
    numbers = {field: _number(name, values[name]) for name, field in _FIELDS.items() if name in values}
    return FrameRequest(**numbers, products=(), above_ellipsoid="height" in values)


def _number(name: str, value: Any) -> float:
    try:
        number = real_number(value) if isinstance(value, str) else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InvalidInput("parameter {0} {1!r}: must be a number", name, value)
    return number


def application(server: FrameServer, token: str | None = None) -> web.Application:
    """Application with the page at ``/``, ``/frame``, ``/camera`` and the WebSocket ``/poses``.

    Parameters
    ----------
    token : str or None
        What clients must give, as ``Authorization: Bearer TOKEN`` or ``?token=TOKEN``; none if empty or None.
    """
    page = read_text("live.html")

    @web.middleware
    async def checked(request: web.Request, handler: _Handler) -> web.StreamResponse:
        given = request.headers.get("Authorization", "").removeprefix("Bearer ") or request.query.get("token", "")
        if token and not hmac.compare_digest(given.encode(), token.encode()):
            return _refusal(401, "token: is missing or wrong")
        # Pages of other servers must not use what this machine alone may reach.
        origin = request.headers.get("Origin", f"//{request.host}").partition("//")[2]
        if origin != request.host or not (token or urlsplit(f"//{request.host}").hostname in LOOPBACK):
            return _refusal(403, f"origin {origin}, host {request.host}: only pages of this server may ask")
        try:
            return await handler(request)
        except InvalidInput as wrong:
            return _refusal(400, str(wrong))
        except BusyError as wrong:
            return _refusal(503, str(wrong), {"Retry-After": "1"})
        except TerrAInavError as wrong:
            return _refusal(502, str(wrong))

    async def show_page(_: web.Request) -> web.Response:
        return web.Response(text=page, content_type="text/html")

    async def camera(_: web.Request) -> web.Response:
        return web.json_response(await server.run(lambda: _about(server)))

    async def frame(request: web.Request) -> web.Response:
        asked = FrameQuery(request.query, server.followed)
        made = await server.run(partial(_made, server, asked))
        if asked.format == "json":
            return web.json_response(made.to_json())
        headers = {"Terrainav-Frame": json.dumps(made.to_json()), "Cache-Control": "no-store"}
        return web.Response(body=made.data, content_type=MEDIA_TYPES[asked.format], headers=headers)

    async def poses(request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse(max_msg_size=_MESSAGE_BYTES, heartbeat=30.0)
        await socket.prepare(request)
        await _answer_poses(server, socket)
        return socket

    app = web.Application(middlewares=[checked], client_max_size=_MESSAGE_BYTES)
    app.add_routes(
        [web.get("/", show_page), web.get("/camera", camera), web.get("/frame", frame), web.get("/poses", poses)]
    )
    return app


async def _answer_poses(server: FrameServer, socket: web.WebSocketResponse) -> None:
    """Answer poses: each with JSON, then an image; of poses that arrive meanwhile, only the last is answered."""
    newest: asyncio.Queue[tuple[str, float]] = asyncio.Queue(1)
    recent = RecentPoses()

    async def answer() -> None:
        while True:
            text, arrived_s = await newest.get()
            asked_id = None
            try:
                values = parse_json(text)
                if not isinstance(values, dict):
                    raise InvalidInput("message: must be a JSON object with lat, lon and agl")
                asked_id = values.get("id")
                asked = FrameQuery(values, server.followed, arrived_s)
                made = await server.run(partial(_made, server, asked, recent))
            except TerrAInavError as wrong:
                await socket.send_json({"id": asked_id, "error": str(wrong)})
            else:
                await socket.send_json({"id": asked_id, **made.to_json()})
                if made.data:
                    await socket.send_bytes(made.data)

    answering = asyncio.ensure_future(answer())
    try:
        async for message in socket:
            if message.type is not WSMsgType.TEXT:
                continue
            if newest.full():
                newest.get_nowait()
            newest.put_nowait((message.data, time.monotonic()))
    finally:
        answering.cancel()


def _made(server: FrameServer, asked: FrameQuery, recent: RecentPoses | None = None) -> TimedFrame:
    """Frame and its image file."""
    return server.real_time.frame(asked.request, asked.encode, asked.deadline_s, asked.arrived_s, recent)


def _about(server: FrameServer) -> dict[str, Any]:
    """What the page and clients need to know before the first frame."""
    camera = server.camera
    start = camera.start
    return {
        "camera": camera.contract.to_json(),
        "start": {
            "lat_deg": start.lat_deg,
            "lon_deg": start.lon_deg,
            "agl_m": start.up_m,
            "tilt_deg": start.tilt_deg,
        },
        "products": list(camera.offered),
        "follows": server.follows,
        "source": camera.source.title,
        "attribution": camera.source.attribution,
    }


def _refusal(status: int, text: str, headers: Mapping[str, str] | None = None) -> web.Response:
    return web.json_response({"error": text}, status=status, headers=headers)


@asynccontextmanager
async def serve(server: FrameServer, host: str, port: int, token: str | None = None) -> AsyncIterator[None]:
    """Serve HTTP until the end of the block; raises OSError if the port cannot be used."""
    runner = web.AppRunner(application(server, token), access_log=None, shutdown_timeout=1.0)
    await runner.setup()
    try:
        await web.TCPSite(runner, host, port).start()
        yield
    finally:
        await runner.cleanup()
