"""Video over RTSP, read by FFmpeg: what a frame shows says when it was made."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
import warnings
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("gi", reason="GStreamer streams")
with warnings.catch_warnings():
    # PyGObject's importer is of an older kind.
    warnings.simplefilter("ignore", ImportWarning)
    try:
        from terrainav.core.live import rtsp
    except ValueError as wrong:
        pytest.skip(f"there is no GStreamer: {wrong}", allow_module_level=True)

from tests.core.live.scenes import live_camera
from tests.core.live.serving import served

needs_ffmpeg = pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="FFmpeg reads")
SIDE, BITS = 8, 32


class NumberedCamera:
    """A camera that paints the milliseconds of the clock into its pictures, as a row of black and white squares."""

    def __init__(self, camera):
        self._camera = camera
        self.made = 0

    def __getattr__(self, name):
        return getattr(self._camera, name)

    def take(self, request, wait_s=None):
        frame = self._camera.take(request, wait_s)
        self.made += 1
        number = int(time.time() * 1000.0) % (1 << BITS)
        picture = frame.picture.copy()
        for bit in range(BITS):
            picture[:SIDE, bit * SIDE : (bit + 1) * SIDE] = 255 * (number >> bit & 1)
        return replace(frame, picture=picture)


def number_in(picture):
    squares = picture[:SIDE, : BITS * SIDE].reshape(SIDE, BITS, SIDE, 3)[2:6, :, 2:6].mean(axis=(0, 2, 3))
    return sum(1 << bit for bit, level in enumerate(squares) if level > 127.0)


@needs_ffmpeg
def test_a_reader_sees_each_frame_soon_after_it_was_made():
    camera = NumberedCamera(live_camera(image_px=320))
    with served(camera, rtsp.serve) as port:
        address = f"rtsp://127.0.0.1:{port}{rtsp.PATH}"
        probe = ("ffprobe", "-v", "error", "-rtsp_transport", "tcp", "-show_streams", "-of", "json", address)
        stream = json.loads(subprocess.run(probe, capture_output=True, timeout=60.0, check=True).stdout)["streams"][0]
        assert (stream["codec_name"], stream["width"], stream["height"]) == ("h264", 320, 240)
        reader = ("ffmpeg", "-v", "error", "-fflags", "nobuffer", "-flags", "low_delay", "-rtsp_transport", "tcp")
        output = ("-i", address, "-frames:v", "30", "-pix_fmt", "rgb24", "-f", "rawvideo", "-")
        numbers, delays_s = [], []
        with subprocess.Popen((*reader, *output), stdout=subprocess.PIPE) as run:
            while data := run.stdout.read(320 * 240 * 3):
                numbers.append(number_in(np.frombuffer(data, np.uint8).reshape(240, 320, 3)))
                delays_s.append((int(time.time() * 1000.0) % (1 << BITS) - numbers[-1]) / 1000.0)
            assert run.wait(60.0) == 0
        assert len(numbers) == 30
        assert numbers == sorted(numbers)
        # Each picture is of this run: its clock was read, not made up.
        assert all(0.0 <= delay_s < 60.0 for delay_s in delays_s)


def test_nobody_watching_costs_no_frames():
    camera = NumberedCamera(live_camera(image_px=96))
    with served(camera, rtsp.serve):
        time.sleep(0.5)
        assert camera.made == 0


def test_a_port_in_use_is_told():
    with served(live_camera(image_px=96), rtsp.serve) as port:
        refused = subprocess.run(
            (sys.executable, "-m", "terrainav.core.cli", "live", "--coords", "46.6_8.1_120", "--rtsp", str(port)),
            capture_output=True,
            text=True,
            timeout=120.0,
            check=False,
        )
    assert refused.returncode == 2
    assert f"port {port}: cannot be used" in refused.stderr
