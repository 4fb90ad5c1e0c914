"""The test server itself: what it says of positions, and by hand."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import requests
from hypothesis import given
from hypothesis import strategies as st

from tests.support.patterns import MODULUS, decode_position, encode_position
from tests.support.tileserver import TileServer

ROOT = Path(__file__).resolve().parents[3]


@given(st.integers(0, 2**31), st.integers(0, 2**31), st.sampled_from(["satellite", "roadmap", "terrain"]))
def test_positions_are_read_back(column, row, map_type):
    picture = encode_position(column + np.arange(5), row + np.arange(3), map_type)
    columns, rows = decode_position(picture, map_type)
    assert np.array_equal(columns, np.tile((column + np.arange(5)) % MODULUS, (3, 1)))
    assert np.array_equal(rows, np.tile((row + np.arange(3)) % MODULUS, (5, 1)).T)


def test_faults_fall_on_the_share_asked_for_and_always_on_the_same():
    with TileServer() as server, requests.Session() as session:
        server.fail("404", share=0.25)
        runs = [[session.get(f"{server.url}/9/{x}/7.png", timeout=10).status_code for x in range(80)] for _ in range(2)]
        assert runs[0] == runs[1]
        assert 8 < runs[0].count(404) < 32
        assert server.connections == 1
        assert set(server.tile_requests.values()) == {2}


@pytest.mark.parametrize("options", [[], ["--paint", "world"]])
def test_by_hand(options):
    command = [sys.executable, "-m", "tests.support.tileserver", "--port", "0", "--quiet", *options]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, env=environment) as running:
        try:
            template = running.stdout.readline().strip()
            answer = requests.get(template.format(z=3, x=1, y=2), timeout=60)
        finally:
            running.terminate()
    assert answer.status_code == 200
    assert answer.headers["Content-Type"] == "image/png"


def test_faults_by_hand_at_a_rate_once_and_until_healed():
    command = [sys.executable, "-m", "tests.support.tileserver", "--port=0", "--quiet", "--controlled"]
    with subprocess.Popen(
        [*command, "--fault=503:0.5:1", "--fault=404"],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as running:
        template = running.stdout.readline().strip()
        running.stdout.readline()

        def tell(command):
            running.stdin.write(command + "\n")
            running.stdin.flush()

        def statuses():
            urls = [template.format(z=6, x=x, y=2) for x in range(40)]
            return [requests.get(url, timeout=60).status_code for url in urls]

        first, second = statuses(), statuses()
        assert set(first) == {503, 404}
        assert set(second) == {404}
        tell("counts")
        counts = json.loads(running.stdout.readline())
        tell("heal")
        tell("counts")
        running.stdout.readline()
        assert set(statuses()) == {200}
        tell("end")
        assert running.stdout.read().startswith("120 requests over ")
    once = first.count(503)
    assert counts["faults"] == {"503": once, "404": 80 - once}
    assert (counts["requests"], counts["unique"], counts["once"]) == (80, 40, 0)
    assert running.returncode == 0
