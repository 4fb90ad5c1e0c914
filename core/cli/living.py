"""Serve frames on request on the command line."""

from __future__ import annotations

import argparse
import asyncio
import signal
import sys
from contextlib import closing
from typing import TYPE_CHECKING

from ..errors import InvalidInput
from ..text.plain import printable
from .exits import DONE
from .flying import mission_settings, open_mission_source, requested_heights

if TYPE_CHECKING:
    from ..live.serving import FrameServer

#: Default port of HTTP.
HTTP_PORT = 8421


def run_live(arguments: argparse.Namespace) -> int:
    """Serve frames of a mission's camera until a signal ends it."""
    from ..capture.labels import open_labels
    from ..live.camera import LiveCamera
    from ..live.serving import LOOPBACK, FrameServer

    if arguments.host not in LOOPBACK and not arguments.token:
        raise InvalidInput(
            "host {0}: other machines could ask for frames", arguments.host, remedy="give a token (--token)"
        )
    mission, values = mission_settings(arguments)
    mission = mission.of_first_imagery
    with open_mission_source(mission, values, as_stored=False) as source:
        camera = LiveCamera(mission, source, requested_heights(mission, values), connections=values["connections"])
        camera.labels = open_labels(camera.plan(camera.start._replace(products=mission.products)))
        with closing(FrameServer(camera, arguments.workers)) as server:
            asyncio.run(_serve(server, arguments))
    return DONE


async def _serve(server: FrameServer, arguments: argparse.Namespace) -> None:
    """Serve until SIGINT or SIGTERM."""
    from aiohttp import web

    from ..live.http import application

    runner = web.AppRunner(application(server, arguments.token))
    await runner.setup()
    try:
        site = web.TCPSite(runner, arguments.host, arguments.port)
        try:
            await site.start()
        except OSError as wrong:
            raise InvalidInput(
                "port {0}: cannot be used ({1})", arguments.port, wrong.strerror, remedy="choose another port (--port)"
            ) from wrong
        print(printable(f"live at http://{arguments.host}:{arguments.port}/"), file=sys.stderr, flush=True)
        stopped = asyncio.Event()
        loop = asyncio.get_running_loop()
        for number in (signal.SIGINT, signal.SIGTERM):
            loop.add_signal_handler(number, stopped.set)
        await stopped.wait()
    finally:
        await runner.cleanup()
