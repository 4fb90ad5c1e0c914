"""Address of a dataset's folder as entered by the user, and addresses of the files in it.

GDAL signs S3 URLs, each for one file and a few minutes, with the credentials of AWS's tools; QGIS makes the requests,
as it does to web servers.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import NamedTuple
from urllib.parse import quote, urlsplit

from osgeo import gdal

from ...core.addresses import holds_credentials
from ...core.dataset.folder import FOOTPRINTS_FILE, MISSION_FILE, TABLE_FILE
from ...core.errors import InvalidInput, OutputError
from ...core.limits import MAX_HEADER_CHARACTERS
from ..i18n import tr

#: Files of a dataset; the address of such a file stands for the dataset.
_INSIDE = (MISSION_FILE, FOOTPRINTS_FILE, "collection.json", "items.parquet", "croissant.json", "plan.csv")


class DatasetAddress(NamedTuple):
    """Address of a dataset's folder.

    Parameters
    ----------
    url : str
        URL of the folder, without a trailing slash.
    """

    url: str

    @classmethod
    def parse(cls, text: str) -> DatasetAddress:
        """Address of a dataset, from the address of its folder or of a file in it.

        Raises
        ------
        InvalidInput
            The text is not an address, or contains credentials (which the message does not repeat).
        """
        text = text.strip()
        if not text:
            raise InvalidInput(tr("address: is missing; it must be such as https://host/run or s3://bucket/run"))
        if len(text) > MAX_HEADER_CHARACTERS or not text.isprintable():
            raise InvalidInput(
                tr("address: must be of {most} printable characters at most").format(most=MAX_HEADER_CHARACTERS)
            )
        try:
            parts = urlsplit(text)
            scheme, host = parts.scheme.lower(), parts.hostname
        except ValueError:
            scheme, host = "", None
        if scheme not in ("https", "http", "s3"):
            raise InvalidInput(
                tr("address {address}: must begin with https://, http:// or s3://").format(
                    address=f"{scheme}://…" if holds_credentials(text) else text.partition("?")[0].rpartition("@")[2]
                )
            )
        bare = re.split(r"[?#]", text)[0]
        if "@" in parts.netloc or holds_credentials(bare):
            raise InvalidInput(tr("address: contains a user name or password, which belong in QGIS's authentication"))
        if parts.query or parts.fragment:
            raise InvalidInput(tr("address: contains ? or #; must be that of the dataset's folder alone"))
        if not host:
            raise InvalidInput(tr("address {address}: names no server or bucket").format(address=text))
        path = parts.path.rstrip("/")
        folder, _, name = path.rpartition("/")
        if name == TABLE_FILE:
            path = folder.rpartition("/")[0]
        elif name in _INSIDE:
            path = folder
        # Not `hostname`, which is in lower case: bucket names are case-sensitive.
        return cls(f"{scheme}://{parts.netloc}{path}")

    @property
    def name(self) -> str:
        """Last part of the address."""
        parts = urlsplit(self.url)
        return parts.path.rpartition("/")[2] or parts.netloc

    @property
    def server(self) -> str:
        """Scheme and server or bucket, for error messages."""
        parts = urlsplit(self.url)
        return f"{parts.scheme}://{parts.netloc}"

    @property
    def is_s3(self) -> bool:
        """Whether the dataset is in an object store."""
        return self.url.startswith("s3://")

    def file(self, name: str) -> str:
        """Address of a file in the folder, for display; ``name`` may contain folders."""
        return f"{self.url}/{name}"

    def inside(self, name: str) -> DatasetAddress:
        """Address of a subfolder."""
        return DatasetAddress(self.file(name))

    def request_url(self, name: str) -> str:
        """URL for requesting a file now; never show it, as the URL of an object store is signed.

        Raises
        ------
        OutputError
            The endpoint is invalid.
        """
        if not self.is_s3:
            return f"{self.url}/{quote(name)}"
        parts = urlsplit(self.url)
        key = f"{parts.path.lstrip('/')}/{name}".lstrip("/")
        options = _store_options(os.environ)
        if (os.environ.get("AWS_NO_SIGN_REQUEST") or "").lower() not in ("yes", "true", "on", "1"):
            with _gdal_options(options):
                signed = gdal.GetSignedURL(f"/vsis3/{parts.netloc}/{key}", ["EXPIRATION_DELAY=600"])
            if signed:
                return str(signed)
        # There are no credentials: the files may be public.
        return _plain_url(parts.netloc, key, options)


def _store_options(environment: Mapping[str, str]) -> dict[str, str]:
    """GDAL options for the store in AWS's environment variables; empty for Amazon's store."""
    # The variables in which AWS's tools look for another store, in their order.
    names = ("AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT_URL")
    endpoint = next((environment[name] for name in names if environment.get(name)), "")
    if not endpoint or environment.get("AWS_S3_ENDPOINT"):
        return {}
    parts = urlsplit(endpoint)
    if parts.scheme not in ("http", "https") or not parts.netloc or "@" in parts.netloc:
        raise OutputError("environment variable AWS_ENDPOINT_URL: must be such as {0}", "http://host:port")
    return {
        "AWS_S3_ENDPOINT": f"{parts.netloc}{parts.path}".rstrip("/"),
        "AWS_HTTPS": "YES" if parts.scheme == "https" else "NO",
        # Other stores rarely have a host per bucket.
        "AWS_VIRTUAL_HOSTING": "FALSE",
    }


def _plain_url(bucket: str, key: str, options: Mapping[str, str]) -> str:
    def option(name: str) -> str:
        return options.get(name) or os.environ.get(name) or ""

    endpoint = option("AWS_S3_ENDPOINT")
    scheme = "http" if option("AWS_HTTPS").lower() in ("no", "false", "off", "0") else "https"
    if endpoint:
        return f"{scheme}://{endpoint}/{bucket}/{quote(key)}"
    region = option("AWS_REGION") or option("AWS_DEFAULT_REGION")
    host = f"s3.{region}.amazonaws.com" if region else "s3.amazonaws.com"
    return f"https://{host}/{bucket}/{quote(key)}"


@contextmanager
def _gdal_options(options: Mapping[str, str]) -> Iterator[None]:
    """Set GDAL options temporarily, only for this thread if possible (GDAL 3.5), and suppress GDAL's errors."""
    put = getattr(gdal, "SetThreadLocalConfigOption", gdal.SetConfigOption)
    get = getattr(gdal, "GetThreadLocalConfigOption", gdal.GetConfigOption)
    before = {name: get(name) for name in options}
    gdal.PushErrorHandler("CPLQuietErrorHandler")
    try:
        for name, value in options.items():
            put(name, value)
        yield
    finally:
        for name, old in before.items():
            put(name, old)
        gdal.PopErrorHandler()
