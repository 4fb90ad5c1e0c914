"""MAVLink's links on this machine: datagrams and streams, with what is no message left out."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from typing import Any

from pymavlink.dialects.v20 import common as protocol

from ..errors import InvalidInput
from ..mission.export.vehicle import ADDRESS
from .choices import LOOPBACK

#: Most clients that are answered, and seconds of silence after which one is forgotten.
_CLIENTS, _SILENT_S = 16, 60.0
#: Most bytes that wait to be read by the other end of a stream.
_WAITING_BYTES = 1 << 20
#: Seconds until a stream that broke is opened again.
_AGAIN_S = 1.0


def parser() -> Any:
    """Parser of MAVLink that passes over what is no message."""
    made = protocol.MAVLink(None)
    made.robust_parsing = True
    return made


def messages(read: Any, data: bytes) -> list[Any]:
    """Messages in what arrived; broken ones are left out."""
    try:
        found = read.parse_buffer(data) or []
    except (protocol.MAVError, ValueError):
        return []
    return [one for one in found if one.get_type() != "BAD_DATA" and not one.get_type().startswith("UNKNOWN")]


def parse_address(address: str) -> tuple[str, str, int]:
    """Kind, host and port of an address; raises InvalidInput unless it is one of this machine."""
    kind, _, place = address.partition(":")
    host, _, port = place.rpartition(":")
    if not ADDRESS.fullmatch(address) or int(port) >= 1 << 16:
        raise InvalidInput("vehicle {0!r}: must be tcp:HOST:PORT, udp:HOST:PORT or udpout:HOST:PORT", address)
    if host not in LOOPBACK:
        raise InvalidInput("vehicle {0!r}: MAVLink has no tokens, so the camera serves this machine alone", address)
    return kind, host, int(port)


class Datagrams(asyncio.DatagramProtocol):
    """Datagrams, to one client or to all that were heard lately."""

    def __init__(self, *, is_call: bool) -> None:
        self._is_call, self._heard_s = is_call, dict[Any, float]()
        self._transport: asyncio.DatagramTransport | None = None
        self.receive: Callable[[Any], None] = lambda _: None

    def connection_made(self, transport: Any) -> None:
        """Keep the transport."""
        self._transport = transport

    def datagram_received(self, data: bytes, addr: Any) -> None:
        """Pass on messages, and remember who sent them."""
        now_s = time.monotonic()
        self._heard_s = {one: at for one, at in self._heard_s.items() if now_s - at < _SILENT_S}
        # A parser of its own, as a broken packet must not swallow the next.
        for message in messages(parser(), data):
            if addr in self._heard_s or len(self._heard_s) < _CLIENTS:
                self._heard_s[addr] = now_s
            self.receive(message)

    def send(self, data: bytes) -> None:
        """Send to all clients."""
        if self._transport is None or self._transport.is_closing():
            return
        for client in (None,) if self._is_call else tuple(self._heard_s):
            self._transport.sendto(data, client)


class Stream:
    """A server of the vehicle's, called again when the connection ends."""

    def __init__(self, host: str, port: int) -> None:
        self._host, self._port = host, port
        self._writer: asyncio.StreamWriter | None = None
        self.receive: Callable[[Any], None] = lambda _: None

    async def run(self) -> None:
        """Call, and call again, until cancelled."""
        while True:
            with suppress(OSError):
                reader, self._writer = await asyncio.open_connection(self._host, self._port)
                try:
                    read = parser()
                    while data := await reader.read(1 << 12):
                        for message in messages(read, data):
                            self.receive(message)
                finally:
                    self._writer.close()
                    self._writer = None
            await asyncio.sleep(_AGAIN_S)

    def send(self, data: bytes) -> None:
        """Send, unless there is no connection."""
        # A vehicle that does not read loses messages, as by datagrams.
        if self._writer is not None and self._writer.transport.get_write_buffer_size() < _WAITING_BYTES:
            self._writer.write(data)


@asynccontextmanager
async def open_link(address: str) -> AsyncIterator[Datagrams | Stream]:
    """Open a link until the end of the block.

    Parameters
    ----------
    address : str
        ``udp:HOST:PORT``, where others call; ``udpout:HOST:PORT`` or ``tcp:HOST:PORT``, where they are called.

    Raises
    ------
    InvalidInput
        Another address, or one of another machine.
    OSError
        The port cannot be used.
    """
    kind, host, port = parse_address(address)
    if kind == "tcp":
        stream = Stream(host, port)
        calling = asyncio.ensure_future(stream.run())
        try:
            yield stream
        finally:
            calling.cancel()
            await asyncio.gather(calling, return_exceptions=True)
        return
    here, there = (None, (host, port)) if kind == "udpout" else ((host, port), None)
    transport, link = await asyncio.get_running_loop().create_datagram_endpoint(
        lambda: Datagrams(is_call=kind == "udpout"), local_addr=here, remote_addr=there
    )
    try:
        yield link
    finally:
        transport.close()
