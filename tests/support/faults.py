"""Faults of tile servers, on demand.

A fault is a function that answers one request in place of the server. Its arguments are the handler and the picture
that the server would have sent.
"""

from __future__ import annotations

import hashlib
import socket
import struct
import time
import zlib
from email.utils import formatdate

import numpy as np

from tests.support.patterns import content_type, to_bytes

QUOTA_WORDS = "You have exceeded your daily request quota for this API."
STALL_S = 30.0
HUGE_BYTES = 200 << 20
BOMB_PX = 40_000
#: Unpacked size of a body, more than the largest body that is read; it is packed to a thousandth.
UNPACKED_MB = 40


def status(code, words="", headers=(), kind="text/plain"):
    """Return a fault that answers a status with a text."""

    def send(handler, _body):
        handler.answer(code, words.encode(), kind, dict(headers))

    return send


def _dated(handler, _body):
    handler.answer(429, b"slow down", "text/plain", {"Retry-After": formatdate(time.time() + 1.0, usegmt=True)})


def _stall(handler, _body):
    handler.server.stalled.wait(STALL_S)
    handler.close_connection = True


def _stall_mid_body(handler, body):
    handler.start(200, content_type(body), len(body))
    handler.wfile.write(body[: len(body) // 2])
    _stall(handler, body)


def _trickle(handler, body):
    handler.start(200, content_type(body), len(body))
    for at in range(len(body)):
        if handler.server.stalled.wait(0.05):
            break
        handler.wfile.write(body[at : at + 1])
    handler.close_connection = True


def _reset(handler, body):
    handler.start(200, content_type(body), len(body))
    handler.wfile.write(body[: len(body) // 2])
    handler.wfile.flush()
    # With this option, closing drops unsent data and sends a reset instead of an end.
    handler.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    handler.close_connection = True


def _short_body(handler, body):
    handler.start(200, content_type(body), len(body))
    handler.wfile.write(body[: len(body) // 2])
    handler.close_connection = True


def _html(handler, _body):
    page = b"<!doctype html><html><head><title>Access blocked</title></head><body>Not a tile</body></html>"
    handler.answer(200, page, "text/html; charset=utf-8")


def _truncated(handler, body):
    half = to_bytes(handler.picture(body), "jpg")
    handler.answer(200, half[: len(half) // 2], "image/jpeg")


def _corrupt_jpeg(handler, body):
    broken = bytearray(to_bytes(handler.picture(body), "jpg"))
    middle = len(broken) // 2
    noise = b"".join(hashlib.sha256(bytes([count])).digest() for count in range(64))
    broken[middle : middle + len(noise)] = noise
    handler.answer(200, bytes(broken), "image/jpeg")


def _corrupt(handler, body):
    broken = bytearray(body)
    middle = len(broken) // 2
    broken[middle : middle + 64] = bytes(byte ^ 0xA5 for byte in broken[middle : middle + 64])
    handler.answer(200, bytes(broken), content_type(body))


def _bad_copy(handler, body):
    """Answer like a proxy with a broken copy, which asks the server only if the request has ``no-cache``."""
    bypassed = "no-cache" in handler.headers.get("Cache-Control", "")
    if bypassed and not any(name.startswith("If-") for name in handler.headers):
        handler.answer(200, body, content_type(body))
    else:
        _corrupt(handler, body)


def _wrong_size(handler, body):
    handler.answer(200, to_bytes(handler.picture(body).resize((100, 120)), "png"), "image/png")


def _flat(handler, body):
    handler.answer(200, flat_placeholder(handler.picture(body).size[0]), "image/png")


def _transparent(handler, body):
    handler.answer(200, to_bytes(handler.picture(body).convert("RGBA").point(lambda _: 0), "png"), "image/png")


def _redirect_loop(handler, _body):
    handler.answer(302, b"", "text/plain", {"Location": handler.path})


def _redirect_to_file(handler, _body):
    handler.answer(302, b"", "text/plain", {"Location": "file:///etc/passwd"})


def _huge(handler, _body):
    handler.start(200, "image/png", HUGE_BYTES)
    chunk = bytes(1 << 16)
    for _ in range(HUGE_BYTES // len(chunk)):
        handler.wfile.write(chunk)


def _bomb(handler, _body):
    handler.answer(200, bomb(), "image/png")


def _gif_bomb(handler, _body):
    handler.answer(200, gif_bomb(), "image/gif")


def _png_without_pixels(handler, body):
    at = body.index(b"IDAT") - 4
    handler.answer(200, body[:at] + body[body.index(b"IEND") - 4 :], "image/png")


def _packed_bomb(handler, _body):
    # A block that does not depend on the others is packed once and repeated.
    packing = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    block = packing.compress(bytes(1 << 20)) + packing.flush(zlib.Z_FULL_FLUSH)
    body = b"\x1f\x8b\x08" + bytes(7) + block * UNPACKED_MB
    handler.answer(200, body, "image/png", {"Content-Encoding": "gzip"})


def _brotli(handler, body):
    handler.answer(200, body, content_type(body), {"Content-Encoding": "br"})


def _redirect_to_nowhere(handler, _body):
    handler.answer(302, b"", "text/plain", {"Location": "http://[::1/"})


def _many_headers(handler, body):
    handler.answer(200, body, content_type(body), {f"X-{count}": "of no use" for count in range(200)})


def flat_placeholder(size_px: int = 256) -> bytes:
    """Encode the placeholder picture that a server sends where it has no imagery."""
    return to_bytes(np.full((size_px, size_px, 3), 204, np.uint8), "png")


def gif_bomb() -> bytes:
    """Encode a GIF of a few bytes whose only frame would take 12.9 GB."""
    screen = struct.pack("<HHBBB", 256, 256, 0, 0, 0)
    frame = b"," + struct.pack("<HHHHB", 0, 0, 65535, 65535, 0x80) + bytes(6)
    return b"GIF89a" + screen + frame + b"\x02\x02\x4c\x01\x00;"


def bomb() -> bytes:
    """Encode a PNG of a few bytes whose header announces 4.8 GB; most of its rows are missing."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", BOMB_PX, BOMB_PX, 8, 2, 0, 0, 0)
    rows = zlib.compress(bytes(1 << 20), 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


FAULTS = {
    **{str(code): status(code) for code in (408, 425, 502, 504)},
    "404": status(404, "no such tile"),
    "410": status(410),
    "204": status(204),
    "401": status(401, "Invalid access token"),
    "403": status(403, "The provided API key is not allowed here"),
    "quota": status(403, f'{{"error": {{"code": 403, "message": "{QUOTA_WORDS}"}}}}', kind="application/json"),
    "quota-in-400": status(400, "OVER_QUERY_LIMIT"),
    "429-seconds": status(429, "slow down", {"Retry-After": "1"}),
    "429-date": _dated,
    "429-hour": status(429, "slow down", {"Retry-After": "3600"}),
    "500": status(500, "oops"),
    "503": status(503, "<html><body><h1>Service Unavailable</h1></body></html>", kind="text/html"),
    "stall": _stall,
    "stall-mid-body": _stall_mid_body,
    "trickle": _trickle,
    "reset": _reset,
    "short-body": _short_body,
    "html": _html,
    "truncated-jpeg": _truncated,
    "corrupt-jpeg": _corrupt_jpeg,
    "corrupt": _corrupt,
    "bad-copy": _bad_copy,
    "wrong-size": _wrong_size,
    "flat": _flat,
    "transparent": _transparent,
    "redirects": _redirect_loop,
    "redirect-to-file": _redirect_to_file,
    "200MB": _huge,
    "bomb": _bomb,
    "gif-bomb": _gif_bomb,
    "png-without-pixels": _png_without_pixels,
    "packed-bomb": _packed_bomb,
    "brotli": _brotli,
    "redirect-to-nowhere": _redirect_to_nowhere,
    "many-headers": _many_headers,
    "deep-json": status(400, "[" * 8000, kind="application/json"),
    "odd-retry-after": status(503, "later", {"Retry-After": "\N{SUPERSCRIPT TWO}"}),
}
