"""A frame server in a thread of its own, with the interface under test at a free port."""

from __future__ import annotations

import asyncio
import socket
import threading
from contextlib import closing, contextmanager

from terrainav.core.live.serving import FrameServer


def free_port():
    with closing(socket.socket()) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextmanager
def served(camera, serve, *more, **options):
    """Serve a camera by ``serve(server, host, port, *more)``; yields the port."""
    port, started, failures = free_port(), threading.Event(), []
    loop = asyncio.new_event_loop()
    stop = asyncio.Event()

    async def main():
        server = FrameServer(camera, **options)
        try:
            opened = serve(server, "127.0.0.1", port, *more)
            async with await opened if asyncio.iscoroutine(opened) else opened:
                started.set()
                await stop.wait()
        finally:
            server.close()

    def run():
        try:
            loop.run_until_complete(main())
        except Exception as wrong:  # noqa: BLE001 (told to the test)
            failures.append(wrong)
        finally:
            started.set()
            loop.close()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        assert started.wait(60.0)
        assert not failures, failures
        yield port
    finally:
        if not loop.is_closed():
            loop.call_soon_threadsafe(stop.set)
        thread.join(60.0)
        assert not thread.is_alive()
