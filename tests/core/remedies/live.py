"""What refusals of live interfaces advise."""

from __future__ import annotations

import asyncio
import socket
import sys
from contextlib import closing
from pathlib import Path

import pytest
from terrainav.core.cli.living import _serving
from terrainav.core.imagery.policy import Policy
from terrainav.core.live.encoding import encode
from terrainav.core.live.flightgear import serve
from terrainav.core.live.serving import BusyError, FrameServer

from tests.core.live.scenes import live_camera, random_requests
from tests.core.live.serving import free_port
from tests.core.remedies.files import extra_brings
from tests.support.remedies import Case, remedy
from tests.support.sources import PatternSource

SETUP = Path(__file__).parents[3] / "tools" / "setup.sh"
PLACE = ("--coords", "46.6_8.1_120", "--source", "world")


@remedy("cli/living.py", "host {}: other machines could ask for frames; give a token (--token)")
def _open_to_others(case: Case) -> None:
    case.says(case.run("live", *PLACE, "--host", "0.0.0.0").stderr)
    # The address of no machine here: what is refused then is the port.
    ran = case.run("live", *PLACE, "--host", "203.0.113.9", "--token", "of my own")
    case.follow("give a token (--token)", lambda: "port" in ran.stderr and "token" not in ran.stderr)


@remedy("cli/living.py", "live interface {}: {} is not installed; get it with: pip install 'terrainav[live]'")
def _no_package(case: Case) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.delitem(sys.modules, "terrainav.core.live.http", raising=False)
        patch.setitem(sys.modules, "aiohttp", None)
        case.refused(lambda: _serving("http", "aiohttp"))
    case.follow("get it with: pip install 'terrainav[live]'", lambda: extra_brings("live", "aiohttp"))


@remedy("cli/living.py", "port {}: cannot be used ({}); choose another port")
def _taken_port(case: Case) -> None:
    pytest.importorskip("aiohttp")
    with closing(socket.create_server(("127.0.0.1", 0))) as taken:
        port = taken.getsockname()[1]
        case.says(case.run("live", *PLACE, "--http", str(port)).stderr)
    case.follow("choose another port", lambda: port not in (8421, 41451))


@remedy("live/camera.py", "frame {}: a live camera sees perspectives; choose camera")
def _map_frame(case: Case) -> None:
    case.refused(lambda: live_camera(frame="map"))
    case.follow("choose camera", lambda: live_camera(frame="camera"))


@remedy(
    "live/terms.py", "{}: live frames keep tiles for the next ones, which the terms forbid: {}{}; take another source"
)
def _forbidden_source(case: Case) -> None:
    source = PatternSource(("satellite",))
    source.policy = Policy(cache_allowed=False, terms="nothing may be kept")
    case.refused(lambda: live_camera(source))
    case.follow("take another source", lambda: live_camera(PatternSource(("satellite",))))


@remedy("live/encoding.py", "format {}: cannot hold {}; choose tif")
def _format_for_measures(case: Case) -> None:
    camera = live_camera()
    frame = camera.take(random_requests(1, 1, products=("depth",))[0])
    case.refused(lambda: encode(frame, "depth", "jpg"))
    case.follow("choose tif", lambda: encode(frame, "depth", "tif"))


@remedy("live/serving.py", "busy: {} requests wait; ask again later")
def _busy(case: Case) -> None:
    async def overload(server: FrameServer, count: int) -> None:
        answers = await asyncio.gather(*(server.run(lambda: None) for _ in range(count)), return_exceptions=True)
        for answer in answers:
            if isinstance(answer, BusyError):
                raise answer

    server = FrameServer(live_camera(), most_waiting=2)
    case.refused(lambda: asyncio.run(overload(server, 9)))
    case.follow("ask again later", lambda: asyncio.run(overload(server, 1)))
    server.close()


@remedy("live/serving.py", "follow: no vehicle sends its poses here; give where it sends them (--fdm or --mavlink)")
def _nothing_to_follow(case: Case) -> None:
    server = FrameServer(live_camera())
    case.refused(server.followed)

    async def followed() -> bool:
        async with serve(server, "127.0.0.1", free_port()):
            return server.follows

    case.follow("give where it sends them (--fdm or --mavlink)", lambda: asyncio.run(followed()))
    server.close()


@remedy("cli/living.py", "MAVLink camera: has no folder for its photographs; give one (--photos)")
def _no_folder(case: Case) -> None:
    case.says(case.run("live", *PLACE, "--mavlink").stderr)
    # What is refused then is the address.
    ran = case.run("live", *PLACE, "--photos", str(case.tmp_path / "photos"), "--mavlink", "udp:192.0.2.1:9")
    case.follow("give one (--photos)", lambda: "this machine" in ran.stderr)


@remedy(
    "cli/living.py",
    "video: GStreamer's RTSP server or its Python modules are missing; get it with: "
    "apt install gir1.2-gst-rtsp-server-1.0 python3-gst-1.0",
)
def _no_gstreamer(case: Case) -> None:
    import asyncio
    from argparse import Namespace
    from contextlib import AsyncExitStack

    from terrainav.core.cli.living import _open_rtsp

    async def opened() -> None:
        async with AsyncExitStack() as stack:
            await _open_rtsp(stack, None, Namespace(host="127.0.0.1"), 0)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.delitem(sys.modules, "terrainav.core.live.rtsp", raising=False)
        patch.setitem(sys.modules, "gi", None)
        case.refused(lambda: asyncio.run(opened()))
    case.follow(
        "get it with: apt install gir1.2-gst-rtsp-server-1.0 python3-gst-1.0",
        lambda: "gir1.2-gst-rtsp-server-1.0" in SETUP.read_text(),
    )
