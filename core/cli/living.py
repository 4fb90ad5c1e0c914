"""Serve frames on request on the command line."""

from __future__ import annotations

import argparse
import asyncio
import signal
import sys
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack, closing, suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput, Message
from ..live.choices import HTTP_PORT, LOOPBACK
from ..text.plain import printable
from .exits import DONE
from .flying import mission_settings, open_mission_source, requested_heights

if TYPE_CHECKING:
    from ..live.serving import FrameServer


def run_live(arguments: argparse.Namespace) -> int:
    """Serve frames of a mission's camera until a signal ends it."""
    from ..capture.labels import open_labels
    from ..live.camera import LiveCamera
    from ..live.serving import FrameServer

    if arguments.host not in LOOPBACK and not arguments.token:
        raise InvalidInput(
            "host {0}: other machines could ask for frames", arguments.host, remedy="give a token (--token)"
        )
    if all(getattr(arguments, name) is None for name in _INTERFACES if name != "fdm"):
        arguments.http = HTTP_PORT
    mission, values = mission_settings(arguments)
    mission = mission.of_first_imagery
    with open_mission_source(mission, values, as_stored=False) as source:
        heights = requested_heights(mission, values)
        camera = LiveCamera(
            mission, source, heights, connections=values["connections"], accept_terms=arguments.accept_terms
        )
        camera.labels = open_labels(camera.plan(camera.start._replace(products=mission.products)))
        with closing(FrameServer(camera, arguments.workers)) as server:
            asyncio.run(_serve(server, arguments))
    return DONE


async def _serve(server: FrameServer, arguments: argparse.Namespace) -> None:
    """Serve until a signal ends it."""
    stopped = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        with suppress(NotImplementedError):
            # Windows has no handlers here; Ctrl-C ends the loop by itself.
            loop.add_signal_handler(number, stopped.set)
    async with AsyncExitStack() as opened:
        for name, open_interface in _INTERFACES.items():
            port = getattr(arguments, name)
            if port is None:
                continue
            try:
                address = await open_interface(opened, server, arguments, port)
            except OSError as wrong:
                raise InvalidInput(
                    "port {0}: cannot be used ({1})", port, wrong.strerror, remedy="choose another port"
                ) from wrong
            print(printable(f"{name:8s}{address}"), file=sys.stderr, flush=True)
        await stopped.wait()


def _serving(module: str, package: str) -> Any:
    """The function that serves an interface."""
    try:
        return import_module(f"...live.{module}", __name__).serve
    except ModuleNotFoundError as missing:
        raise InvalidInput(
            "live interface {0}: {1} is not installed",
            module,
            package,
            remedy=Message("get it with: pip install 'terrainav[live]'"),
        ) from missing


def _check_here(interface: Message, host: str) -> None:
    """Refuse to serve other machines by an interface without tokens."""
    if host not in LOOPBACK:
        raise InvalidInput("{0} at {1}: has no tokens, so it serves this machine alone", interface, host)


async def _open_http(opened: AsyncExitStack, server: FrameServer, arguments: argparse.Namespace, port: int) -> str:
    """Serve HTTP; returns the address of the page."""
    serve = _serving("http", "aiohttp")
    await opened.enter_async_context(serve(server, arguments.host, port, arguments.token))
    suffix = f"?token={arguments.token}" if arguments.token else ""
    return f"http://{arguments.host}:{port}/{suffix}"


async def _open_airsim(opened: AsyncExitStack, server: FrameServer, arguments: argparse.Namespace, port: int) -> str:
    """Serve AirSim's clients, which have no tokens."""
    _check_here(Message("AirSim's interface"), arguments.host)
    serve = _serving("airsim", "msgpack")
    await opened.enter_async_context(serve(server, arguments.host, port))
    return f"{arguments.host}:{port}"


async def _open_fdm(opened: AsyncExitStack, server: FrameServer, arguments: argparse.Namespace, port: int) -> str:
    """Follow a flight simulator."""
    _check_here(Message("FDM interface"), arguments.host)
    from ..live.flightgear import serve

    await opened.enter_async_context(serve(server, arguments.host, port, arguments.sea_level))
    return f"{arguments.host}:{port}"


async def _open_rtsp(opened: AsyncExitStack, server: FrameServer, arguments: argparse.Namespace, port: int) -> str:
    """Stream video, whose viewers have no tokens."""
    _check_here(Message("video"), arguments.host)
    try:
        rtsp = import_module("...live.rtsp", __name__)
    except (ImportError, ValueError) as missing:
        raise InvalidInput(
            "video: GStreamer's RTSP server or its Python modules are missing",
            remedy=Message("get it with: apt install {0}", "gir1.2-gst-rtsp-server-1.0 python3-gst-1.0"),
        ) from missing
    await opened.enter_async_context(rtsp.serve(server, arguments.host, port))
    return f"rtsp://{arguments.host}:{port}{rtsp.PATH}"


async def _open_mavlink(
    opened: AsyncExitStack, server: FrameServer, arguments: argparse.Namespace, address: str
) -> str:
    """Be the camera of a vehicle."""
    if arguments.photos is None:
        raise InvalidInput("MAVLink camera: has no folder for its photographs", remedy="give one (--photos)")
    serve = _serving("mavlink", "pymavlink")
    folder = Path(arguments.photos)
    await opened.enter_async_context(serve(server, address, folder, sea_level_m=arguments.sea_level))
    return address


#: Interfaces by the name of the option of their port or address.
_INTERFACES: dict[str, Callable[..., Awaitable[str]]] = {
    "http": _open_http,
    "airsim": _open_airsim,
    "mavlink": _open_mavlink,
    "rtsp": _open_rtsp,
    "fdm": _open_fdm,
}
