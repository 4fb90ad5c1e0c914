"""Frames over HTTP and WebSocket, asked for by clients that others wrote."""

from __future__ import annotations

import asyncio
import io
import json
import socket
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import requests
from PIL import Image

pytest.importorskip("aiohttp", reason="it serves HTTP, and asks over WebSockets")

import aiohttp
from terrainav.core.geodesy.contract import CameraContract
from terrainav.core.live.camera import FrameRequest
from terrainav.core.live.encoding import encode
from terrainav.core.live.http import serve

from tests.core.live.scenes import HERE, live_camera
from tests.core.live.serving import served
from tests.support.sources import PatternSource

POSE = {"lat": HERE[0], "lon": HERE[1], "agl": 120.0, "yaw": 30.0, "tilt": 40.0, "roll": -5.0, "time": 1234.5}
REQUEST = FrameRequest(*HERE, 120.0, 30.0, 40.0, -5.0, 1234.5)
TOKEN = "as long as it takes"


@pytest.fixture(scope="module")
def camera():
    return live_camera()


@pytest.fixture(scope="module")
def address(camera):
    with served(camera, serve) as port:
        yield f"http://127.0.0.1:{port}"


def ask(address, path="/frame", **parameters):
    return requests.get(address + path, params=parameters, timeout=60.0)


@pytest.mark.parametrize("image_format", ["jpg", "png", "tif"])
def test_a_frame_is_the_file_of_its_pose(camera, address, image_format):
    answer = ask(address, **POSE, format=image_format)
    assert answer.status_code == 200
    assert answer.content == encode(camera.take(REQUEST), "picture", image_format)
    stated = json.loads(answer.headers["Terrainav-Frame"])
    assert stated["time_s"] == 1234.5
    assert stated["pose"]["yaw_deg"] == 30.0
    width, height = Image.open(io.BytesIO(answer.content)).size
    assert (stated["camera"]["width_px"], stated["camera"]["height_px"]) == (width, height)


def test_depth_comes_as_tiff(camera, address):
    answer = ask(address, **POSE, image="depth", format="tif")
    frame = camera.take(REQUEST._replace(products=("depth",)))
    assert answer.content == encode(frame, "depth", "tif")


def test_the_contract_is_json(camera, address):
    assert CameraContract.from_json(ask(address, "/camera").json()["camera"]) == camera.contract


@pytest.mark.parametrize(
    ("changes", "status", "words"),
    [
        ({"lat": None}, 400, "lat"),
        ({"lat": "north"}, 400, "lat"),
        ({"lat": "nan"}, 400, "number"),
        ({"height": 300.0}, 400, "one of the two"),
        ({"tilt": 999.0}, 400, "tilt"),
        ({"speed": 3.0}, 400, "speed"),
        ({"format": "bmp"}, 400, "bmp"),
        ({"image": "depth"}, 400, "tif"),
        ({"image": "colour"}, 400, "colour"),
        ({"agl": -1.0}, 400, "height"),
    ],
)
def test_wrong_questions_get_one_line(address, changes, status, words):
    asked = {name: value for name, value in {**POSE, **changes}.items() if value is not None}
    answer = ask(address, **asked)
    assert answer.status_code == status
    assert words in answer.json()["error"]
    assert "\n" not in answer.json()["error"]


def test_pages_of_other_origins_are_refused(address):
    answer = requests.get(address + "/camera", headers={"Origin": "http://evil.example"}, timeout=60.0)
    assert answer.status_code == 403
    # A name that another's DNS leads to this machine.
    answer = requests.get(address + "/camera", headers={"Host": "evil.example"}, timeout=60.0)
    assert answer.status_code == 403


def test_a_token_is_needed_where_one_is_set(camera):
    with served(live_camera(), serve, TOKEN) as port:
        address = f"http://127.0.0.1:{port}"
        assert ask(address, "/camera").status_code == 401
        assert ask(address, "/camera", token="no").status_code == 401
        assert ask(address, "/camera", token=TOKEN).status_code == 200
        headers = {"Authorization": f"Bearer {TOKEN}"}
        assert requests.get(address + "/camera", headers=headers, timeout=60.0).status_code == 200


def conversation(address, messages, answers):
    """What the WebSocket answers to messages: JSON, and bytes."""

    async def talk():
        found = []
        async with aiohttp.ClientSession() as session, session.ws_connect(address + "/poses") as sock:
            for message in messages:
                await sock.send_str(message)
            while len(found) < answers:
                message = await sock.receive(timeout=60.0)
                found.append(json.loads(message.data) if message.type is aiohttp.WSMsgType.TEXT else message.data)
        return found

    return asyncio.run(talk())


def test_a_websocket_answers_poses(camera, address):
    about, data = conversation(address, [json.dumps({**POSE, "id": 7})], 2)
    assert about["id"] == 7
    assert data == encode(camera.take(REQUEST))


@pytest.mark.parametrize("message", ["no json", "[]", "{}", json.dumps({**POSE, "tilt": 1e9}), json.dumps({"lat": []})])
def test_a_websocket_refuses_nonsense_and_goes_on(address, message):
    async def talk():
        async with aiohttp.ClientSession() as session, session.ws_connect(address + "/poses") as sock:
            await sock.send_str(message)
            refused = await sock.receive_json(timeout=60.0)
            await sock.send_str(json.dumps({**POSE, "format": "json"}))
            return refused, await sock.receive_json(timeout=60.0)

    refused, answered = asyncio.run(talk())
    assert refused["error"]
    assert answered["pose"]["lat_deg"] == HERE[0]


class StallingSource(PatternSource):
    """Tiles that arrive when they are let go."""

    def __init__(self):
        super().__init__(map_types=("satellite",))
        self.let_go = threading.Event()

    def paint(self, map_type, part):
        assert self.let_go.wait(60.0)
        return super().paint(map_type, part)


def test_fifty_clients_at_once_and_a_source_that_stalls():
    """Each gets its frame or is told to ask again; those that vanish in the middle do no harm."""
    source = StallingSource()
    with served(live_camera(source), serve, most_waiting=8) as port, ThreadPoolExecutor(50) as clients:
        address = f"http://127.0.0.1:{port}"
        waiting = [clients.submit(ask, address, **{**POSE, "yaw": float(number)}) for number in range(50)]
        for _ in range(3):
            with socket.create_connection(("127.0.0.1", port)) as gone:
                gone.sendall(b"GET /frame?lat=46.6&lon=8.1&agl=120 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            with socket.create_connection(("127.0.0.1", port)) as rubbish:
                rubbish.sendall(b"\x00\xff" * 400)
        # The one under way waits for tiles; beyond those that may wait, clients are refused at once.
        refused = [one for one in waiting if one.done()]
        source.let_go.set()
        statuses = [one.result().status_code for one in waiting]
        assert set(statuses) <= {200, 503}
        assert statuses.count(200) >= 1
        assert all(one.result().headers.get("Retry-After") for one in waiting if one.result().status_code == 503)
        assert ask(address, **POSE).status_code == 200
        assert len(refused) <= 50


def test_a_deadline_gives_a_frame_that_says_what_it_lacks():
    source = StallingSource()
    with served(live_camera(source), serve) as port:
        late = ask(f"http://127.0.0.1:{port}", **POSE, deadline_ms=50.0, format="png")
        assert late.status_code == 200
        assert json.loads(late.headers["Terrainav-Frame"])["coarse_share"] == 1.0
        assert not np.asarray(Image.open(io.BytesIO(late.content))).any()
        source.let_go.set()
        whole = ask(f"http://127.0.0.1:{port}", **POSE)
        assert json.loads(whole.headers["Terrainav-Frame"])["coarse_share"] == 0.0
