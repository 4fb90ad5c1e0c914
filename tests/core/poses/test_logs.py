"""Flight logs become poses: logs are written here from their formats' descriptions, and read by the peers' readers."""

from __future__ import annotations

import math
import struct
import sys
import warnings

import numpy as np
import pytest
from terrainav.core.dataset.table import Table
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.poses.logs import read_dataflash, read_ulog

from tests.support.command import command
from tests.support.logs import FLIGHT, LEVEL, TOPICS, copter, dataflash, e7, flight, gps, ulog, us

run = pytest.fixture(command, name="run")

#: The position with the flags that newer versions log.
FLAGGED = {
    "vehicle_global_position": (
        "uint64_t timestamp;double lat;double lon;float alt;bool lat_lon_valid;bool alt_valid;uint8_t[2] _padding0;",
        "<Qddf??",
    )
}


def test_a_log_of_px4_is_flown(tmp_path, run):
    pytest.importorskip("pyulog")
    home = [("home_position", 0, 0, 1.0, False), ("home_position", 0, 5, 488.0, True)]
    utc = [("vehicle_gps_position", 0, us(9.0), us(1_700_000_009.0))]
    track = read_ulog(ulog(tmp_path / "flight.ulg", [*home, *flight(FLIGHT), *utc]))
    points, left_out = track.points()
    assert left_out == 1
    assert points.poses == ((47.3001, 8.5, 100.0), (47.3001, 8.5002, 102.0))
    assert points.times_s == (1_700_000_002.0, 1_700_000_003.5)
    np.testing.assert_allclose((points.yaws_deg, points.tilts_deg), ((0.0, 90.0), (0.0, 10.0)), atol=1e-4)
    np.testing.assert_allclose(points.rolls_deg, (0.0, 0.0), atol=1e-4)
    said = run("poses", "read", "flight.ulg", "--every-s", "1", "--nadir", "--output", "p.csv")
    assert said.stdout == "2 poses in p.csv\n1 of 3 positions left out, at or below the ground\n"
    run("capture", "--coords", "p.csv", "--image-px", "32", "--quiet", "--data-dir", "out")
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert table.time_utc == ("2023-11-14T22:13:22.000Z", "2023-11-14T22:13:23.500Z")
    np.testing.assert_allclose(table.yaw_deg, (0.0, 90.0), atol=1e-4)
    assert set(table.tilt_deg) == {0.0}


def test_a_log_without_home_and_time_counts_from_its_beginning(tmp_path):
    pytest.importorskip("pyulog")
    bare = read_ulog(ulog(tmp_path / "bare.ulg", list(flight(FLIGHT))))
    assert bare.ground_m == 488.0
    assert bare.time_s.tolist() == [1.0, 2.0, 3.5]
    # Receivers that have no time yet, and then the topic of the sensor itself.
    early = [
        ("vehicle_gps_position", 0, us(1.0), 0),
        ("sensor_gps", 1, us(1.0), us(5e8)),
        ("sensor_gps", 0, us(1.0), us(1_600_000_001.0)),
    ]
    timed = read_ulog(ulog(tmp_path / "timed.ulg", [*flight(FLIGHT), *early]))
    assert timed.time_s.tolist() == [1_600_000_001.0, 1_600_000_002.0, 1_600_000_003.5]


def test_positions_that_px4_calls_invalid_are_left_out(tmp_path):
    pytest.importorskip("pyulog")
    rows = [("vehicle_global_position", 0, us(at), 1.0, 2.0, 50.0 + at, at > 1, at > 2) for at in range(5)]
    track = read_ulog(ulog(tmp_path / "flags.ulg", rows, {**TOPICS, **FLAGGED}))
    assert track.height_m.tolist() == [53.0, 54.0]
    assert track.attitude_deg is None
    with pytest.raises(InvalidInput, match="has no positions"):
        read_ulog(ulog(tmp_path / "none.ulg", rows[:2], {**TOPICS, **FLAGGED}))


def test_attitudes_are_those_of_the_moments_of_positions(tmp_path):
    pytest.importorskip("pyulog")
    half = math.radians(40.0) / 2.0
    rows = [
        ("vehicle_attitude", 0, us(1.0), *LEVEL),
        # The same rotation by other numbers, and a state of the filter that is none.
        ("vehicle_attitude", 0, us(1.2), 0.0, 0.0, 0.0, 0.0),
        ("vehicle_attitude", 0, us(2.0), -math.cos(half), 0.0, 0.0, -math.sin(half)),
        *(("vehicle_global_position", 0, us(at), 1.0, 2.0, 50.0) for at in (0.5, 1.5, 2.5)),
    ]
    yaw, tilt, _ = read_ulog(ulog(tmp_path / "turn.ulg", rows)).attitude_deg
    np.testing.assert_allclose(yaw, (0.0, 20.0, 40.0), atol=1e-4)
    np.testing.assert_allclose(tilt, 0.0, atol=1e-4)


def test_a_log_of_ardupilot_is_flown(tmp_path):
    pytest.importorskip("pymavlink")
    points, left_out = read_dataflash(dataflash(tmp_path / "log.bin", copter())).points()
    assert left_out == 1
    np.testing.assert_allclose(points.poses, ((-35.3601, 149.16, 100.0), (-35.3602, 149.16, 101.0)), atol=1e-4)
    # GPS week 2300 begins on 2024-02-04; four days later, less 18 leap seconds.
    assert points.times_s[0] == pytest.approx(1_707_004_800.0 + 345_600.0 + 2.0 - 18.0, abs=1e-3)
    np.testing.assert_allclose(points.yaws_deg[1], 90.0, atol=1e-3)
    np.testing.assert_allclose(points.tilts_deg, (-3.0, 10.0), atol=1e-3)
    np.testing.assert_allclose(points.rolls_deg, (5.0, 0.0), atol=1e-3)


def test_the_second_filter_and_the_receiver_stand_in_for_the_first_one(tmp_path):
    pytest.importorskip("pymavlink")
    second = [
        ("AHR2", us(1.0), 0, 0, 0, 0.0, 0, 0),
        ("AHR2", us(2.0), 0, 0, 0, 584.0, e7(-35.36), e7(149.16)),
        ("AHR2", us(3.0), 0, 0, 0, 604.0, e7(-35.36), e7(149.16)),
    ]
    # Week 1930 begins with 2017, and 2017-01-01T00:00:00Z is 18 seconds later.
    receiver = [
        gps(1.0, 0, 0.0, status=1),
        gps(2.0, 1930, 18.0, -35.3, 149.1, 500.0),
        gps(2.1, 1930, 18.1, -35.4, 149.1, 900.0, instance=1),
        gps(3.0, 1930, 19.0, -35.3, 149.1, 540.0),
    ]
    track = read_dataflash(dataflash(tmp_path / "ahr2.bin", [*second, *receiver]))
    assert (track.height_m.tolist(), track.ground_m, track.attitude_deg) == ([584.0, 604.0], 584.0, None)
    bare = read_dataflash(dataflash(tmp_path / "gps.bin", receiver))
    assert bare.height_m.tolist() == [500.0, 540.0]
    assert bare.ground_m == 500.0
    assert bare.time_s.tolist() == pytest.approx([1_483_228_800.0, 1_483_228_801.0], abs=1e-3)
    before = read_dataflash(dataflash(tmp_path / "2016.bin", [gps(2.0, 1929, 0.0, 1.0, 1.0, 5.0)]))
    # 2016-12-25, when GPS was 17 seconds ahead.
    assert before.time_s[0] == 1_482_624_000.0 - 17.0
    with pytest.raises(InvalidInput, match="has no positions"):
        read_dataflash(dataflash(tmp_path / "none.bin", receiver[:1]))


def test_a_log_of_ardupilot_may_be_text(tmp_path, run):
    pytest.importorskip("pymavlink")
    lines = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 129, 35, POS, QLLff, TimeUS,Lat,Lng,Alt,RelAlt",
        "POS, 1000000, -35.36, 149.16, 584.0, 0.0",
        "POS, 2000000, -35.3601, 149.16, 684.0, 100.0",
        "POS, 3000000, -35.3602, 149.16, 685.0, 101.0",
    ]
    (tmp_path / "flight.log").write_text("\n".join(lines) + "\n")
    said = run("poses", "read", "flight.log", "--output", "p.csv")
    assert said.stdout.startswith("2 poses in p.csv\n")
    assert (tmp_path / "p.csv").read_text().splitlines()[1].startswith("-35.3601,149.16,100.0,")


def test_what_is_no_log_is_refused_in_one_line(tmp_path, run):
    pytest.importorskip("pyulog")
    pytest.importorskip("pymavlink")
    for name, body in (("torn.ulg", b"ULog, or so it says"), ("empty.bin", b""), ("empty.ulg", b"")):
        (tmp_path / name).write_bytes(body)
        refused = run("poses", "read", name, "--output", "q.csv")
        assert (refused.returncode, refused.stderr.count("\n"), refused.stdout) == (2, 1, "")
    for reader in (read_ulog, read_dataflash):
        with pytest.raises(InvalidInput, match="No such file"):
            reader(tmp_path / "gone")


@pytest.mark.parametrize("reader", [read_ulog, read_dataflash])
def test_reading_a_long_log_says_how_far_it_is_and_can_be_stopped(tmp_path, reader):
    pytest.importorskip("pyulog")
    pytest.importorskip("pymavlink")
    count = 5_000
    if reader is read_ulog:
        rows = ((one / 10.0, 47.3, 8.5, 500.0 + one, LEVEL) for one in range(count))
        path = ulog(tmp_path / "long.ulg", list(flight(rows)))
    else:
        rows = (("POS", us(one / 10.0), e7(1.0), e7(2.0), 500.0 + one, 0.0, 0.0) for one in range(count))
        path = dataflash(tmp_path / "long.bin", rows)
    shares = []
    assert len(reader(path, lambda share: shares.append(share) is None)) == count
    assert shares == sorted(shares)
    assert 0.5 < shares[-1] <= 1.0
    with pytest.raises(Cancelled):
        reader(path, lambda _share: False)


def test_damage_is_one_line(tmp_path, caplog, capsys):
    pytest.importorskip("pyulog")
    path = ulog(tmp_path / "flight.ulg", list(flight(FLIGHT)))
    # Data of a topic that the log does not declare.
    path.write_bytes(path.read_bytes() + struct.pack("<HBHQ", 10, ord("D"), 99, 0))
    assert len(read_ulog(path)) == 3
    assert [record.message.partition(" (")[0] for record in caplog.records] == [f"log {path}: is damaged in places"]
    assert capsys.readouterr().out == ""


def test_damage_that_a_module_in_c_tells_is_one_line(tmp_path, caplog, capfd):
    pytest.importorskip("pymavlink")
    path = dataflash(tmp_path / "log.bin", copter())
    path.write_bytes(path.read_bytes() + bytes(600))
    assert len(read_dataflash(path)) == 3
    assert len(caplog.records) == 1
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("topic", ["vehicle_global_position", "vehicle_attitude", "home_position", "sensor_gps"])
def test_topics_without_what_is_needed_of_them_are_not_there(tmp_path, topic):
    pytest.importorskip("pyulog")
    rows = [row for row in flight(FLIGHT) if row[0] != topic]
    bare = {**TOPICS, topic: ("uint64_t timestamp;float other;", "<Qf")}
    path = ulog(tmp_path / "bare.ulg", [*rows, (topic, 0, us(1.0), 2.0)], bare)
    if topic == "vehicle_global_position":
        with pytest.raises(InvalidInput, match="has no positions"):
            read_ulog(path)
    else:
        track = read_ulog(path)
        assert (track.ground_m, track.time_s[0]) == (488.0, 1.0)
        assert (track.attitude_deg is None) == (topic == "vehicle_attitude")


def test_attitudes_beyond_measure_are_left_out(tmp_path):
    pytest.importorskip("pymavlink")
    rows = [*copter(), ("ATT", us(4.0), math.inf, math.nan, math.inf, 3, 0)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        track = read_dataflash(dataflash(tmp_path / "log.bin", rows))
    assert np.isfinite(track.attitude_deg).all()


@pytest.mark.parametrize(("reader", "module"), [(read_ulog, "pyulog"), (read_dataflash, "pymavlink.DFReader")])
def test_a_reader_that_is_missing_is_named(tmp_path, monkeypatch, reader, module):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(OutputError, match="which reads such files, is not installed; get it with: pip install"):
        reader(tmp_path / "log")
