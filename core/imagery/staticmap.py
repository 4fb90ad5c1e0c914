"""Google Static Maps: pictures requested by centre.

The service keeps six decimals of a centre. The grid states this, so the windows of a plan have centres of six decimals,
and a picture is georeferenced by the centre exactly as sent.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import os
from functools import partial
from urllib.parse import quote, urlencode, urlsplit

import numpy as np

from ..arrays import PixelValues
from ..errors import InvalidInput, Message
from ..geodesy.frames import Windows, window_centres
from ..geodesy.mercator import PixelGrid
from ..map_types import MAP_TYPES, SATELLITE
from .decode import read_answer
from .entry import CatalogueEntry
from .http.client import Client
from .http.requests_transport import RequestsTransport
from .http.transport import Transport
from .opening import SourceOptions
from .placeholder import Placeholder, Received
from .policy import Policy
from .source import Part, Window
from .tiles import check_zoom

GOOGLE_URL = "https://maps.googleapis.com/maps/api/staticmap"
#: Longest side of a picture, before ``scale``.
MAX_SIZE_PX = 640
#: Decimals of a centre in degrees that the service keeps (0.1 m).
CENTRE_DECIMALS = 6
#: Header of answers of status 200 with a picture other than the requested one.
PLACEHOLDER = Placeholder(header=(("x-staticmap-api-warning", "*"),))


class StaticMapSource:
    """Pictures of Google Static Maps, without labels.

    Parameters
    ----------
    key : str
        API key.
    secret : str or None
        URL signing secret, URL-safe base64 as the Cloud console shows it; None to send requests unsigned.
    scale : int
        1, or 2 for twice the width and height in pixels on the same ground.
    name, title, attribution : str
    policy : Policy
    placeholder : Placeholder
    url : str
        Address of the service.
    client, transport, connections
        As for `XYZSource`.

    Attributes
    ----------
    placeholder, received
        As for `Provided`.
    """

    map_types = MAP_TYPES

    def __init__(
        self,
        key: str,
        secret: str | None = None,
        *,
        scale: int = 1,
        name: str = "google-static",
        title: str = "Google Static Maps",
        attribution: str = "Map data © Google",
        policy: Policy = Policy(),  # noqa: B008 (an immutable value)
        placeholder: Placeholder = PLACEHOLDER,
        url: str = GOOGLE_URL,
        client: Client | None = None,
        transport: Transport | None = None,
        connections: int = 8,
    ) -> None:
        if scale not in (1, 2):
            raise InvalidInput("scale {0}: Static Maps has 1 (tiles of 256 px) and 2 (512 px)", scale)
        self.name, self.title, self.attribution = name, title, attribution
        self.date = ""
        self.policy = policy
        self.placeholder = placeholder
        self.received: Received | None = None
        self.grid = PixelGrid(
            tile_px=256 * scale,
            max_zoom=21,
            native_zoom=21,
            max_size_px=MAX_SIZE_PX,
            centre_decimals=CENTRE_DECIMALS,
        )
        if secret:
            _secret_bytes(secret)
        self._key, self._secret, self._url = key, secret, url
        connections = policy.connections(connections)
        self._client = client or Client(
            transport or RequestsTransport(connections),
            title,
            connections=connections,
            requests_per_s=policy.requests_per_s,
            first_after_s=policy.rest_s,
            secrets=tuple(value for value in (key, secret) if value),
        )

    def __repr__(self) -> str:
        return f"StaticMapSource({self.title!r}, {self.grid})"

    def parts(self, window: Window) -> list[Part]:
        """Return the window as one part, with its left edge within the world: one request gives the whole picture."""
        left_px = window.left_px % self.grid.world_px(window.zoom)
        return [Part(window._replace(left_px=left_px), 0, 0)]

    def fetch(self, map_type: str, part: Window) -> PixelValues:
        """Pixels of a picture, (height_px, width_px, 3) uint8.

        Raises
        ------
        InvalidInput
            The centre of ``part`` has too many decimals, or ``part`` is too large.
        PartError, SourceError, Cancelled
            As for `XYZSource.fetch`.
        """
        lat_deg, lon_deg = self.centre(part)
        what = Message("image at {0},{1} zoom {2}", lat_deg, lon_deg, part.zoom)
        read = partial(read_answer, width_px=part.width_px, height_px=part.height_px, placeholder=self.placeholder)
        response, pixels = self._client.picture(self._request(map_type, part, lat_deg, lon_deg), what, read)
        received = self.received
        if received is not None:
            received(part, response.body)
        return pixels

    def centre(self, part: Window) -> tuple[str, str]:
        """Latitude and longitude of a window's centre, as texts with six decimals, as sent.

        Raises
        ------
        InvalidInput
            The window's centre has more decimals.
        """
        # The noise of float64 pixels is a thousandth of the last decimal; windows planned with another grid deviate by
        # up to half a decimal.
        tolerance_deg = 1e-9
        windows = Windows(*(np.array([value]) for value in part[1:]))
        texts = []
        for values in window_centres(windows, self.grid, part.zoom):
            degrees = float(values[0])
            text = f"{degrees:.{CENTRE_DECIMALS}f}"
            if abs(float(text) - degrees) > tolerance_deg:
                raise InvalidInput(
                    "{0}: its centre {1!r} has more than {2} decimals, which {3} drops",
                    part,
                    degrees,
                    CENTRE_DECIMALS,
                    self.title,
                    remedy="plan with this source's grid",
                )
            texts.append(text.lstrip("-") if float(text) == 0.0 else text)
        return texts[0], texts[1]

    def close(self) -> None:
        """End running requests, which raise `Cancelled`, and free the connections."""
        self._client.close()

    def _request(self, map_type: str, part: Window, lat_deg: str, lon_deg: str) -> str:
        if map_type not in MAP_TYPES:
            raise InvalidInput("map type {0!r}: {1} has {2}", map_type, self.title, ", ".join(MAP_TYPES))
        scale = self.grid.scale
        width, height = part.width_px // scale, part.height_px // scale
        if (
            part.width_px % scale
            or part.height_px % scale
            or min(width, height) < 1
            or max(width, height) > MAX_SIZE_PX
        ):
            raise InvalidInput(
                "image of {0}x{1} px: {2} gives up to {3} px times {4}",
                part.width_px,
                part.height_px,
                self.title,
                MAX_SIZE_PX,
                scale,
            )
        check_zoom(part.zoom, self.grid, self.title)
        query = {
            "center": f"{lat_deg},{lon_deg}",
            "zoom": str(part.zoom),
            "size": f"{width}x{height}",
            "scale": str(scale),
            "maptype": map_type,
            # The default, png8, has 256 colours.
            "format": "png32",
        }
        if map_type != SATELLITE:
            query["style"] = "feature:all|element:labels|visibility:off"
        query["key"] = self._key
        url = f"{self._url}?{urlencode(query, quote_via=quote, safe='')}"
        return sign(url, self._secret) if self._secret else url


def open_entry(entry: CatalogueEntry, _date: str, key: str | None, options: SourceOptions) -> StaticMapSource:
    """Open the source described by an entry, with a key."""
    return StaticMapSource(
        key or "",
        options.secret or (os.environ.get(entry.signing_env) if entry.signing_env else None),
        scale=entry.grid(options.tile_px).scale,
        name=entry.name,
        title=entry.title,
        attribution=entry.attribution,
        policy=entry.policy.shared(options.sharers),
        placeholder=PLACEHOLDER.extended(entry.placeholder.extended(options.placeholders).sha256),
        url=os.environ.get("TERRAINAV_GOOGLE_URL", GOOGLE_URL),
        transport=options.transport,
        connections=options.connections,
    )


def sign(url: str, secret: str) -> str:
    """Append Google's signature of path and query to a URL.

    Source: Google Maps Platform, Digital Signature Guide: HMAC-SHA1, URL-safe base64.

    Parameters
    ----------
    url : str
        Percent-encoded URL.
    secret : str
        Signing secret in URL-safe base64.
    """
    parts = urlsplit(url)
    signed = f"{parts.path}?{parts.query}".encode("ascii")
    digest = hmac.new(_secret_bytes(secret), signed, hashlib.sha1).digest()
    return f"{url}&signature={base64.urlsafe_b64encode(digest).decode('ascii')}"


def _secret_bytes(secret: str) -> bytes:
    padded = secret.strip() + "=" * (-len(secret.strip()) % 4)
    try:
        return base64.b64decode(padded, altchars=b"-_", validate=True)
    except ValueError:
        wrong = InvalidInput("URL signing secret: is not URL-safe base64, as the Google Cloud console shows it")
    # Raised outside `except` so that an error that quotes the secret is not chained.
    raise wrong
