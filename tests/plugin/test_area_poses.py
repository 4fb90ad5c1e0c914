"""Trajectories and flight logs of the menu *Area from*: flown as ``terrainav poses read`` makes tables of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from qgis.PyQt.QtWidgets import QApplication, QDialogButtonBox, QFileDialog
from terrainav.core.cli import main
from terrainav.core.errors import Cancelled
from terrainav.core.mission.areas.coords import parse_coords
from terrainav.core.poses.gpx import read_gpx
from terrainav.core.poses.settings import PoseFile
from terrainav.core.text.safe_xml import iterate_elements
from terrainav.terrainav_plugin.area.control import ReadTask
from terrainav.terrainav_plugin.area.dialogs import PosesDialog
from terrainav.terrainav_plugin.area.layers import pose_file
from terrainav.terrainav_plugin.area.xml import xml_elements
from terrainav.terrainav_plugin.form.area import entered_area

from tests.support.logs import FLIGHT, copter, dataflash, flight, ulog
from tests.support.thinning import sampled

GPX = (
    '<?xml version="1.0"?><gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><metadata><time>1999-01-01T00:'
    '00:00Z</time></metadata><wpt lat="1" lon="1"/><trk><trkseg><trkpt lat="35.16" lon="-89.90"><ele>200</ele><time>'
    '2024-06-21T10:30:00Z</time></trkpt><trkpt lon="-89.90" lat="35.161"><ele>210</ele><time>2024-06-21T10:30:10.5Z'
    '</time><extensions><ele>7</ele></extensions></trkpt></trkseg><trkseg><trkpt lat="35.161" lon="-89.898"><ele>205.5'
    "</ele><time>2024-06-21T10:30:30Z</time></trkpt></trkseg></trk></gpx>"
)
DOWN = " ".join(map(str, (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5))))
TUM = f"# timestamp tx ty tz qx qy qz qw\n0.5 0 0 90 1 0 0 0\n1.5 20 10 95 {DOWN}\n3.5 40 20 100 1 0 0 0\n"
KITTI = "1 0 0 0 0 0 1 -90 0 -1 0 0\n1 0 0 0 0 0 1 -90 0 -1 0 50\n"
#: Whose third axis is level: that of a camera which looks up or down would see no ground in one of the two frames.
EUROC = "#timestamp [ns],p_x\n" + "".join(
    f"{at}500000000,{at},0,90,{math.sqrt(0.5)},0,{math.sqrt(0.5)},0\n" for at in (1, 2)
)


def write(path):
    """File of poses, by its ending or its first letter."""
    kind = path.suffix if path.suffix in (".gpx", ".ulg", ".bin") else path.stem
    if kind == ".ulg":
        pytest.importorskip("pyulog")
        return ulog(path, list(flight(FLIGHT)))
    if kind == ".bin":
        pytest.importorskip("pymavlink")
        return dataflash(path, copter())
    path.write_text({".gpx": GPX, "tum": TUM, "kitti": KITTI, "euroc": EUROC}[kind])
    return path


def dialog_of(desk, path, monkeypatch):
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    desk.form.area.area_from.actions_by_name["poses"].trigger()
    return next(one for one in desk.iface.mainWindow().findChildren(PosesDialog) if one.isVisible())


def accept(desk, dialog):
    desk.click(dialog.buttons.button(QDialogButtonBox.StandardButton.Ok))
    desk.wait_for_tasks()
    QApplication.processEvents()


ORIGIN = ("--origin", "35.16", "-89.9", "20")
LOCAL = {"origin_lat": 35.16, "origin_lon": -89.9, "origin_height": 20.0}


@pytest.mark.parametrize(
    ("name", "entered", "options"),
    sampled([
        ("way.gpx", {}, ("--agl", "120")),
        ("way.gpx", {"by_file": True, "ground": 80.0, "interval_in": "every_s", "interval": 15.0},
         ("--ground-height", "80", "--every-s", "15")),
        ("flight.ulg", {"interval_in": ""}, ()),
        ("flight.ulg", {"nadir": True}, ("--nadir", "--every-s", "2")),
        ("log.bin", {"interval_in": "every_m", "interval": 5.0}, ("--every-m", "5")),
        ("tum.txt", LOCAL, ("--format", "tum", *ORIGIN)),
        ("tum.txt", {**LOCAL, "restart": True}, ("--format", "tum", *ORIGIN, "--start", "2024-06-21T10:30:00Z")),
        ("euroc.csv", {**LOCAL, "times": "us"}, ("--format", "euroc", "--body", "urf", *ORIGIN, "--times", "us")),
        ("way.gpx", {"times": "none"}, ("--agl", "120", "--times", "none")),
        ("log.bin", {"interval_in": "", "flight": 1}, ("--flight", "1")),
        ("kitti.txt", LOCAL, ("--format", "kitti", *ORIGIN)),
        ("euroc.csv", {**LOCAL, "body": "flu"}, ("--format", "euroc", "--body", "flu", *ORIGIN)),
        ("euroc.csv", {**LOCAL, "by_value": True, "agl": 300.0, "unit": "ft"},
         ("--format", "euroc", "--body", "urf", *ORIGIN, "--agl", "91.44")),
    ], 2),
)  # fmt: skip
def test_poses_are_flown_as_the_command_reads_them(desk, tmp_path, monkeypatch, screenshot, name, entered, options):
    path = write(tmp_path / name)
    table = tmp_path / "table.csv"
    assert main(["poses", "read", str(path), *options, "--output", str(table)]) == 0
    desk.form.set_state(replace(desk.session.state(), start="2024-06-21T10:30:00Z"))
    dialog = dialog_of(desk, path, monkeypatch)
    for entry, value in entered.items():
        widget = getattr(dialog, entry)
        if entry in ("body", "interval_in", "times", "unit"):
            desk.choose(widget, value)
        elif isinstance(value, bool):
            widget.setChecked(value)
        else:
            widget.setValue(value)
    screenshot(f"poses-{path.suffix[1:]}-{path.stem}", dialog)
    accept(desk, dialog)
    desk.wait(lambda: entered_area(desk.session.state()) is not None)
    area = entered_area(desk.session.state())
    assert area == parse_coords(str(table))[0]
    assert desk.form.agl.value() == pytest.approx(area.poses[0][2], abs=1e-4)
    screenshot(f"poses-flown-{path.stem}")


@pytest.mark.parametrize(
    ("name", "chosen", "asked"),
    [
        ("way.gpx", "gpx", {"restart", "times"}),
        ("flight.ulg", "ulog", {"nadir", "restart", "times", "flight"}),
        ("log.bin", "dataflash", {"nadir", "restart", "times", "flight"}),
        ("tum.txt", "tum", {"_origin", "body", "world", "nadir", "restart", "times"}),
        ("kitti.txt", "kitti", {"_origin", "body", "world", "nadir"}),
        ("euroc.csv", "euroc", {"_origin", "body", "world", "nadir", "restart", "times"}),
    ],
)
def test_no_more_is_asked_than_the_format_leaves_open(desk, tmp_path, monkeypatch, name, chosen, asked):
    dialog = dialog_of(desk, write(tmp_path / name), monkeypatch)
    assert dialog.format.currentData() == chosen
    rows = ("_origin", "body", "world", "nadir", "restart", "times", "flight")
    assert {row for row in rows if getattr(dialog, row).isVisible()} == asked
    dialog.reject()


def test_local_frames_begin_in_the_middle_of_the_map(desk, tmp_path, monkeypatch):
    desk.look_at("EPSG:4326", (7.39, 46.89, 7.41, 46.91))
    dialog = dialog_of(desk, write(tmp_path / "tum.txt"), monkeypatch)
    assert (dialog.origin_lat.value(), dialog.origin_lon.value()) == pytest.approx((46.9, 7.4), abs=1e-6)
    dialog.reject()


def test_what_is_left_out_and_what_is_missing_is_said(desk, tmp_path, monkeypatch):
    accept(desk, dialog_of(desk, write(tmp_path / "flight.ulg"), monkeypatch))
    desk.wait(lambda: any("1 of 3 positions are left out" in text for text in desk.messages()))
    dialog = dialog_of(desk, write(tmp_path / "way.gpx"), monkeypatch)
    dialog.by_file.setChecked(True)
    accept(desk, dialog)
    desk.wait(lambda: any("how high its ground is" in text for text in desk.messages()))
    said = next(text for text in desk.messages() if "how high its ground is" in text)
    assert "give that in the heights of the file, or one height above ground. No area" in said
    assert "--" not in said


def test_a_long_file_can_be_cancelled(desk, tmp_path):
    """Progress and cancelling are those of QGIS's own tasks."""
    path = tmp_path / "tum.txt"
    path.write_text("".join(f"{at} 0 0 90 1 0 0 0\n" for at in range(20_000)))
    task = ReadTask("step", pose_file(str(path), PoseFile("tum", (35.16, -89.9))))
    shares = []
    task.progressChanged.connect(shares.append)
    task.run()
    assert len(task.found.area.poses) == 20_000
    assert shares == sorted(shares)
    assert shares[-1] > 50.0
    cancelled = ReadTask("step", pose_file(str(path), PoseFile("tum", (35.16, -89.9))))
    cancelled.cancel()
    with pytest.raises(Cancelled):
        cancelled.work()


def test_gpx_is_read_by_qt_as_by_lxml():
    pytest.importorskip("lxml")
    for text in (
        GPX,
        GPX.replace("trkpt", "rtept"),
        GPX.replace("<ele>200</ele>", "<ele> <![CDATA[200]]></ele>"),
    ):
        mine, theirs = (read_gpx(text.encode(), "way", reader) for reader in (xml_elements, iterate_elements))
        for name in ("lat_deg", "lon_deg", "height_m", "time_s"):
            np.testing.assert_array_equal(getattr(mine, name), getattr(theirs, name))
        assert mine.height_m.tolist() == [200.0, 210.0, 205.5]
