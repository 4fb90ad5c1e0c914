"""Calls into C that are left: by who waits for them, by signals, and at the end of the process."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
import time
import warnings

import pytest
from terrainav.core.errors import Cancelled
from terrainav.core.external import native_calls
from terrainav.core.external.native_calls import NativeCall

from tests.support.thinning import sampled

PLACE = "47.8206_11.5450_47.8200_11.5460_60"
#: Two files, of a few bytes, that GDAL reads for many minutes: 400 times the mean over 900 million pixels.
WIDE_PX, TIMES = 30_000, 400
#: Says when GDAL begins to read pixels.
PROGRAM = """
import signal, sys
# Shells have what runs in the background ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
from terrainav.core.cli import main
from terrainav.core.imagery.raster import reading

library = reading.opener()
own = library.read

def read(*arguments):
    print("reading", flush=True)
    return own(*arguments)

library.read = read
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture(autouse=True)
def _no_signals():
    yield
    native_calls.forget_signals()


@pytest.fixture
def slow(tmp_path):
    gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")
    options = ["SPARSE_OK=YES", "TILED=YES", "COMPRESS=DEFLATE"]
    wide = gdal.GetDriverByName("GTiff").Create(
        str(tmp_path / "wide.tif"), WIDE_PX, WIDE_PX, 1, gdal.GDT_Byte, options=options
    )
    wide.FlushCache()
    source = (
        '<SimpleSource resampling="average"><SourceFilename relativeToVRT="1">wide.tif</SourceFilename>'
        f'<SrcRect xOff="0" yOff="0" xSize="{WIDE_PX}" ySize="{WIDE_PX}"/>'
        '<DstRect xOff="0" yOff="0" xSize="1000" ySize="1000"/></SimpleSource>'
    )
    path = tmp_path / "slow.vrt"
    path.write_text(
        '<VRTDataset rasterXSize="1000" rasterYSize="1000"><SRS>EPSG:25832</SRS>'
        "<GeoTransform>690000,1,0,5300000,0,-1</GeoTransform>"
        f'<VRTRasterBand dataType="Byte" band="1">{source * TIMES}</VRTRasterBand></VRTDataset>'
    )
    return path


def test_a_call_gives_what_it_returns_and_raises_what_it_raises():
    assert NativeCall(lambda: 7).result() == 7
    with pytest.raises(ZeroDivisionError):
        NativeCall(lambda: 1 / 0).result()


def test_a_call_is_made_on_another_thread_and_leaves_none():
    other = NativeCall(threading.current_thread).result()
    assert other is not threading.current_thread()
    other.join(60)
    assert not other.is_alive()
    assert not native_calls._under_way()


@pytest.mark.parametrize("is_closed", [True, False])
def test_a_thread_makes_several_calls_until_it_is_closed_or_dropped(is_closed):
    thread, left = native_calls.NativeThread(), []
    made = NativeCall(threading.current_thread, thread).result()
    NativeCall(lambda: native_calls.thread_contexts().callback(left.append, 1), thread).result()
    with pytest.raises(ZeroDivisionError):
        NativeCall(lambda: 1 / 0, thread).result()
    assert NativeCall(threading.current_thread, thread).result() is made
    made.calls.join()
    assert made.is_alive()
    assert not native_calls._under_way()
    assert not left
    if is_closed:
        thread.close()
    del thread
    gc.collect()
    made.join(60)
    assert not made.is_alive()
    assert left == [1]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="Windows does not fork")
def test_a_thread_is_started_anew_in_a_forked_process():
    thread = native_calls.NativeThread()
    NativeCall(lambda: 1, thread).result()
    with warnings.catch_warnings():
        # Python 3.12 warns of threads.
        warnings.simplefilter("ignore")
        child = os.fork()
    if child == 0:
        os._exit(NativeCall(lambda: 7, thread).result())
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
    thread.close()


def test_a_call_that_is_not_wanted_is_left_and_its_result_cleaned_up():
    go_on, cleaned = threading.Event(), threading.Event()
    found = []
    call = NativeCall(lambda: go_on.wait(60) and "result")
    with pytest.raises(Cancelled):
        call.result(lambda: False)
    call.when_ended(lambda results: (found.extend(results), cleaned.set()))
    assert not cleaned.is_set()
    go_on.set()
    assert cleaned.wait(60)
    assert found == ["result"]


def test_what_follows_a_call_that_has_ended_is_done_at_once():
    call, done = NativeCall(lambda: 1), []
    call.when_ended(lambda results: done.append(list(results)))
    call.result()
    call.when_ended(lambda results: done.append(list(results)))
    assert done == [[], []]


def test_calls_are_left_once_the_program_is_asked_to_end():
    go_on = threading.Event()
    native_calls.ask_to_end(signal.SIGINT, 0.0)
    with pytest.raises(Cancelled):
        NativeCall(lambda: go_on.wait(60)).result()
    # What ends in time is kept, so that an image in progress can be finished.
    assert NativeCall(lambda: 7).result() == 7
    native_calls.forget_signals()
    call = NativeCall(lambda: go_on.wait(60))
    threading.Timer(0.5, go_on.set).start()
    assert call.result()


@pytest.mark.skipif(os.name == "nt", reason="Windows ends processes without asking them")
@pytest.mark.parametrize(
    ("arguments", "number", "code"),
    sampled(
        [
            (["plan", "--source", "world", "--elevation", "slow.vrt"], signal.SIGINT, 130),
            (["plan", "--source", "world", "--elevation", "550", "--surface", "slow.vrt"], signal.SIGTERM, 143),
            (["report", "--source", "slow.vrt", "--output", "report"], signal.SIGINT, 130),
            (
                ["capture", "--source", "world", "--elevation", "slow.vrt", "--data-dir", "out"],
                signal.SIGTERM,
                143,
            ),
            (["capture", "--source", "slow.vrt", "--data-dir", "out"], signal.SIGINT, 130),
        ],
        3,
    ),
    ids=["heights", "surface", "report", "heights of a capture", "capture"],
)
def test_signals_are_heard_while_gdal_reads(tmp_path, slow, arguments, number, code):
    command = [sys.executable, "-c", PROGRAM, *arguments, "--coords", PLACE, "--mission", "raster"]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "reading\n", process.stderr.read()
        # By then GDAL is at it.
        time.sleep(1.0)
        process.send_signal(number)
        # GDAL alone would be at work for much longer than this.
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == code
    assert errors.splitlines()[-1].startswith("terrainav: stopped")
    assert "Traceback" not in errors
