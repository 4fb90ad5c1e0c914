"""The page of a live camera in a real browser, Chromium."""

from __future__ import annotations

import shutil
import socket

import pytest

pytest.importorskip("aiohttp", reason="it serves HTTP")
pytest.importorskip("playwright", reason="it drives the browser")

from playwright.sync_api import sync_playwright
from terrainav.core.live.http import serve

from tests.core.live.scenes import live_camera
from tests.core.live.serving import served

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium")


@pytest.fixture(scope="module")
def browser():
    with sync_playwright() as driver:
        opened = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-dev-shm-usage"])
        yield opened
        opened.close()


def opened_page(browser, port, query=""):
    page = browser.new_page(viewport={"width": 1200, "height": 850})
    page.faults = []
    page.on("pageerror", lambda wrong: page.faults.append(str(wrong)))
    page.on("requestfailed", lambda request: page.faults.append(request.url))
    page.on("response", lambda answer: answer.ok or page.faults.append(f"{answer.status} {answer.url}"))
    page.goto(f"http://127.0.0.1:{port}/{query}")
    wait_for_frames(page, 1)
    return page


def wait_for_frames(page, count):
    page.wait_for_function(f"Number(document.body.dataset.frames) >= {count}", timeout=60_000)


def pose(page):
    return page.evaluate("({...pose})")


def shown(page):
    """Colours of the picture that the page shows."""
    return page.evaluate(
        """async () => {
            const image = document.getElementById("picture"); await image.decode();
            const canvas = document.createElement("canvas");
            [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
            const context = canvas.getContext("2d"); context.drawImage(image, 0, 0);
            return Array.from(context.getImageData(0, 0, canvas.width, canvas.height).data);
        }"""
    )


@pytest.fixture(scope="module")
def page(browser):
    with served(live_camera(image_px=160), serve) as port:
        page = opened_page(browser, port)
        page.wait_for_function("map !== null", timeout=60_000)
        yield page
        page.close()


@pytest.mark.parametrize(
    ("key", "name"), [("e", "yaw"), ("r", "agl"), ("d", "lon"), ("ArrowUp", "tilt"), ("x", "roll")]
)
def test_keys_move_the_camera_and_the_picture_follows(page, key, name):
    page.evaluate("Object.assign(pose, {yaw: 0})")
    before, picture = pose(page), shown(page)
    frames = page.evaluate("Number(document.body.dataset.frames)")
    page.keyboard.press(key, delay=200.0)
    wait_for_frames(page, frames + 1)
    page.wait_for_function("!waiting && !changed", timeout=60_000)
    after = pose(page)
    assert after[name] > before[name]
    others = set(after) - {name}
    assert {other: after[other] for other in others} == pytest.approx({other: before[other] for other in others})
    assert shown(page) != picture
    assert page.faults == []


def test_a_click_on_the_map_brings_the_camera_there(page):
    before = pose(page)
    box = page.locator("#map").bounding_box()
    page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 0.25 * box["height"])
    after = pose(page)
    assert after["lat"] > before["lat"]
    assert after["lon"] > before["lon"]
    assert page.faults == []


def test_the_page_has_a_name_for_everything_and_says_what_it_shows(page):
    assert page.locator("#attribution").inner_text().startswith("Synthetic (offline)")
    assert page.locator("img").get_attribute("alt")
    assert page.locator("canvas").get_attribute("aria-label")
    assert "Live" in page.locator("[role=status]").inner_text()


def test_a_server_that_ends_is_missed(browser):
    with served(live_camera(image_px=160), serve) as port:
        page = opened_page(browser, port)
    page.wait_for_function("document.getElementById('message').classList.contains('wrong')", timeout=60_000)
    page.close()


def test_the_page_follows_an_aircraft_until_a_key_is_pressed(browser):
    pytest.importorskip("pymavlink", reason="it writes the aircraft's packets")
    from tests.core.live.test_flightgear import packet, serve_both

    camera = live_camera(image_px=160)
    with served(camera, serve_both) as port, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.connect(("127.0.0.1", camera.fdm_port))
        sender.send(packet())
        page = opened_page(browser, port)
        page.wait_for_function("pose.agl > 320.5 && pose.agl < 321.5", timeout=60_000)
        sender.send(packet(altitude=(400.0, "meters")))
        page.wait_for_function("pose.agl > 399.5", timeout=60_000)
        assert page.locator("#follow").is_checked()
        page.keyboard.press("r", delay=300.0)
        page.wait_for_function("!waiting && !changed", timeout=60_000)
        assert not page.locator("#follow").is_checked()
        assert pose(page)["agl"] > 400.5
        assert page.faults == []
        page.close()
