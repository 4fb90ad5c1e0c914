"""An S3 store on the loopback: moto's server, which has the protocol of S3."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator
from typing import Any

import pytest
import requests

#: Credentials of the store; tests search output for the secret.
KEY, SECRET = "TESTKEY", "TESTSECRETNOBODYMAYSEE"


@contextlib.contextmanager
def s3_store(monkeypatch: pytest.MonkeyPatch, bucket: str = "data") -> Iterator[str]:
    """Run a store with a bucket, set the environment to use it, and yield the bucket's address."""
    moto = pytest.importorskip("moto.server", reason="needs moto")
    boto3 = pytest.importorskip("boto3", reason="needs boto3")
    s3fs = pytest.importorskip("s3fs", reason="needs s3fs")
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server: Any = moto.ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    try:
        host, port = server.get_host_and_port()
        for name, value in (
            ("AWS_ACCESS_KEY_ID", KEY),
            ("AWS_SECRET_ACCESS_KEY", SECRET),
            ("AWS_DEFAULT_REGION", "us-east-1"),
            ("AWS_ENDPOINT_URL", f"http://{host}:{port}"),
        ):
            monkeypatch.setenv(name, value)
        s3fs.S3FileSystem.clear_instance_cache()
        # Servers of one process share their objects, so start without any.
        requests.post(f"http://{host}:{port}/moto-api/reset", timeout=10).raise_for_status()
        boto3.client("s3").create_bucket(Bucket=bucket)
        yield f"s3://{bucket}"
    finally:
        s3fs.S3FileSystem.clear_instance_cache()
        server.stop()
