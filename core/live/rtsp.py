"""Video over RTSP in H.264, by GStreamer: one stream of the camera, which all viewers share."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Any

import gi

from ..errors import TerrAInavError
from .camera import LiveFrame
from .serving import FrameServer

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # noqa: E402 (after their versions)

#: Path of the stream.
PATH = "/camera"
#: Frames per second, at most.
RATE_HZ = 15
#: Buffers of an encoder that waits for nothing; each viewer begins at the next key frame, within a second.
_PIPELINE = (
    "( appsrc name=frames is-live=true do-timestamp=true format=time block=false max-buffers=1 leaky-type=downstream "
    "caps=video/x-raw,format=RGB,width={width},height={height},framerate={rate}/1 ! videoconvert ! "
    "video/x-raw,format=I420 ! x264enc tune=zerolatency speed-preset=ultrafast key-int-max={rate} bitrate=4000 ! "
    "rtph264pay name=pay0 pt=96 config-interval=1 )"
)


class _Streaming:
    """GStreamer's server in a thread of its own, and the place where frames go while anybody watches."""

    def __init__(self, server: FrameServer, host: str, port: int) -> None:
        Gst.init(None)
        contract = server.camera.contract
        # H.264 has even sizes.
        self.size = contract.width_px // 2 * 2, contract.height_px // 2 * 2
        self._frames: Any = None
        self._context = GLib.MainContext.new()
        self._loop = GLib.MainLoop.new(self._context, False)
        self._server = GstRtspServer.RTSPServer.new()
        self._server.set_address(host)
        self._server.set_service(str(port))
        factory = GstRtspServer.RTSPMediaFactory.new()
        factory.set_launch(_PIPELINE.format(width=self.size[0], height=self.size[1], rate=RATE_HZ))
        factory.set_shared(True)
        factory.connect("media-configure", self._begin)
        self._server.get_mount_points().add_factory(PATH, factory)
        if not self._server.attach(self._context):
            raise OSError(0, "in use, or not of this machine")
        self._thread = threading.Thread(target=self._loop.run, name="terrainav-rtsp", daemon=True)
        self._thread.start()

    @property
    def is_watched(self) -> bool:
        """Whether anybody watches."""
        return self._frames is not None

    def _begin(self, _factory: Any, media: Any) -> None:
        media.connect("unprepared", self._end)
        self._frames = media.get_element().get_child_by_name("frames")

    def _end(self, _media: Any) -> None:
        self._frames = None

    def push(self, frame: LiveFrame) -> None:
        """Stream a frame."""
        frames, (width, height) = self._frames, self.size
        pixels = frame.picture[:height, :width, :3]
        if pixels.shape[2] == 1:
            pixels = pixels.repeat(3, axis=2)
        if frames is not None:
            frames.emit("push-buffer", Gst.Buffer.new_wrapped(pixels.tobytes()))

    def close(self) -> None:
        """Stop the server."""
        self._loop.quit()
        self._thread.join(10.0)


@asynccontextmanager
async def serve(server: FrameServer, host: str, port: int) -> AsyncIterator[None]:
    """Stream the camera at ``rtsp://HOST:PORT/camera`` until the end of the block: of what it follows, or at rest.

    Raises
    ------
    OSError
        The port cannot be used.
    """
    streaming = _Streaming(server, host, port)

    async def stream() -> None:
        loop, period_s = asyncio.get_running_loop(), 1.0 / RATE_HZ
        while True:
            begun_s = loop.time()
            if streaming.is_watched:
                # A pose that is not known, or imagery that is not there, leaves the last picture.
                with suppress(TerrAInavError):
                    request = server.followed() if server.follows else server.camera.start
                    streaming.push(await server.frame(request, wait_s=period_s))
            await asyncio.sleep(max(begun_s + period_s - loop.time(), 0.0))

    task, server.video = asyncio.ensure_future(stream()), f"rtsp://{host}:{port}{PATH}"
    try:
        yield
    finally:
        task.cancel()
        server.video = ""
        await asyncio.gather(task, return_exceptions=True)
        streaming.close()
