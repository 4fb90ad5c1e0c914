"""Flight logs with something odd in them are read as far as they make sense, and what is left out is counted."""

from __future__ import annotations

import math
from datetime import datetime, timezone

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.poses.logs import read_dataflash, read_ulog

from tests.support.command import command
from tests.support.logs import FLIGHT, TOPICS, dataflash, e7, flight, gps, ulog, us

run = pytest.fixture(command, name="run")

POS = "QLLfff,TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt"


def text_log(path, rows, name="POS", columns=POS):
    """ArduPilot log as text, of one message."""
    form, _, names = columns.partition(",")
    lines = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        f"FMT, 130, 31, {name}, {form}, {names}",
        *(f"{name}, {', '.join(map(str, row))}" for row in rows),
    ]
    path.write_text("\n".join(lines) + "\n")
    return path


def position(at, *, lat=None, time=None):
    """Row of a text log: one position each 0.2 s, 1e-5 degrees apart."""
    place = f"{47.3765 + at * 1e-5:.7f}" if lat is None else lat
    return 1_000_000 + (at if time is None else time) * 200_000, place, "8.5410000", 450 + at, 50 + at, 0


def lats(path):
    return [float(line.split(",")[0]) for line in path.read_text().splitlines()[1:]]


@pytest.mark.parametrize("wrong", ["NaN", "inf", "91.5"])
def test_positions_without_a_place_are_left_out_and_counted(tmp_path, run, wrong):
    pytest.importorskip("pymavlink")
    text_log(tmp_path / "odd.log", [position(at, lat=wrong if at == 4 else None) for at in range(20)])
    said = run("poses", "read", "odd.log", "--agl", "50", "--output", "p.csv")
    assert said.stdout == "19 poses in p.csv\n1 of 20 positions left out, without a place\n"
    kept = [47.3765 + at * 1e-5 for at in range(20) if at != 4]
    assert lats(tmp_path / "p.csv") == pytest.approx(kept, abs=1e-7)


def test_states_of_px4_without_a_place_are_left_out_and_counted(tmp_path):
    pytest.importorskip("pyulog")
    rows = [
        ("vehicle_global_position", 0, us(at), math.nan if at < 3 else 47.0 + at, 8.5, 450.0 + at) for at in range(1, 8)
    ]
    track = read_ulog(ulog(tmp_path / "nan.ulg", rows))
    assert (track.lat_deg.tolist(), track.without_place) == ([50.0, 51.0, 52.0, 53.0, 54.0], 2)
    assert track.ground_m == 453.0
    with pytest.raises(InvalidInput, match="none of its 2 positions has a place and a height"):
        read_ulog(ulog(tmp_path / "none.ulg", rows[:2]))


def test_lines_out_of_order_are_put_in_order(tmp_path):
    pytest.importorskip("pymavlink")
    order = [0, 1, 2, 4, 3, 5, 6, 9, 7, 8, *range(10, 20)]
    track = read_dataflash(text_log(tmp_path / "swapped.log", map(position, order)), text=True)
    np.testing.assert_allclose(track.time_s, 1.0 + 0.2 * np.arange(20))
    np.testing.assert_allclose(track.lat_deg, 47.3765 + 1e-5 * np.arange(20), atol=1e-7)


def test_a_clock_that_starts_again_divides_a_log_into_flights(tmp_path, run):
    pytest.importorskip("pymavlink")
    text_log(tmp_path / "two.log", [position(at, time=at % 10) for at in range(20)])
    read = ("poses", "read", "two.log", "--agl", "50", "--output", "p.csv")
    refused = run(*read).stderr
    assert "its clock starts again at position 11: it holds 2 flights; choose one of them (--flight)" in refused
    for number, first in ((1, 0), (2, 10)):
        assert run(*read, "--flight", str(number)).returncode == 0
        wanted = [47.3765 + at * 1e-5 for at in range(first, first + 10)]
        assert lats(tmp_path / "p.csv") == pytest.approx(wanted, abs=1e-7)
    assert "flight 3 of log two.log: must be from 1 to 2" in run(*read, "--flight", "3").stderr
    other = run("poses", "read", "x.gpx", "--output", "p.csv", "--flight", "1").stderr
    assert "--flight: is for ulog, dataflash, and not for gpx" in other


def test_each_flight_has_its_own_attitudes_and_clock(tmp_path, caplog):
    pytest.importorskip("pymavlink")
    rows = []
    for number, yaw in ((0, 10.0), (1, 200.0)):
        for at in range(10):
            lat = 47.0 + number + at * 1e-5
            rows.append(gps(1.0 + at, 2300 + number, 345_600.0 + at, lat, 8.5, 500.0 + at))
            rows.append(("ATT", us(1.0 + at), 0.0, 0.0, yaw, 3, 0))
            rows.append(("POS", us(1.0 + at), e7(lat), e7(8.5), 500.0 + at, float(at), 0.0))
    path = dataflash(tmp_path / "two.bin", rows)
    for number, yaw in ((1, 10.0), (2, 200.0)):
        track = read_dataflash(path, flight=number)
        np.testing.assert_allclose(track.attitude_deg[0] % 360.0, yaw, atol=1e-3)
        # GPS week 2300 begins on 2024-02-04; less 18 leap seconds.
        begin = 1_707_004_800.0 + (number - 1) * 604_800.0 + 345_600.0 - 18.0
        np.testing.assert_allclose(track.time_s, begin + np.arange(10), atol=1e-3)
        assert track.lat_deg[0] == pytest.approx(46.0 + number, abs=1e-6)
    one = [row for row in rows if row[0] != "ATT"] + [("ATT", us(1.0), 0.0, 0.0, 5.0, 3, 0)]
    assert read_dataflash(dataflash(tmp_path / "one.bin", one), flight=2).attitude_deg is None
    assert "left out the attitudes, whose clock restarts at other times" in caplog.text


def test_the_first_receiver_with_a_fix_counts(tmp_path):
    pytest.importorskip("pymavlink")
    pytest.importorskip("pyulog")
    rows = [gps(at, 0, 0.0, status=1, lat=1.0) for at in (1.0, 2.0, 3.0)]
    rows += [gps(at, 2300, 345_600.0 + at, -35.3, 149.1, 500.0 + at, instance=1) for at in (1.0, 2.0, 3.0)]
    track = read_dataflash(dataflash(tmp_path / "second.bin", rows))
    assert track.height_m.tolist() == [501.0, 502.0, 503.0]
    # The first receiver of a PX4 log counts from 1970 as long as it has no time.
    early = [
        ("sensor_gps", 0, us(1.0), us(500.0)),
        ("sensor_gps", 1, us(1.0), us(1_600_000_001.0)),
    ]
    timed = read_ulog(ulog(tmp_path / "second.ulg", [*flight(FLIGHT), *early]))
    assert timed.time_s.tolist() == [1_600_000_001.0, 1_600_000_002.0, 1_600_000_003.5]


def test_logs_of_before_2015_are_read(tmp_path):
    pytest.importorskip("pymavlink")
    columns = "BIHBcLLeeEefI,Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T"
    rows = []
    for at in range(20):
        place = f"{47.3765 + at * 1e-5:.7f}", "8.5410000", 50, 450 + at
        rows.append((3, 384_000_000 + at * 200, 1750, 9, 1.5, *place, 5, 0, 0, 1000 + at * 200))
    track = read_dataflash(text_log(tmp_path / "2013.log", rows, "GPS", columns), text=True)
    assert track.height_m.tolist() == [450.0 + at for at in range(20)]
    # GPS week 1750 begins on 2013-07-21, when GPS was 16 seconds ahead.
    begin = datetime(2013, 7, 21, tzinfo=timezone.utc).timestamp() + 384_000.0 - 16.0
    np.testing.assert_allclose(track.time_s, begin + 0.2 * np.arange(20), atol=1e-3)


def test_a_clock_in_another_unit_is_refused(tmp_path, run):
    pytest.importorskip("pymavlink")
    text_log(tmp_path / "ms.log", [(1000 + at * 200, *position(at)[1:]) for at in range(20)])
    read = ("poses", "read", "ms.log", "--agl", "50", "--output", "p.csv")
    said = "its 20 times are all within 0.0038 s; they are probably not in microseconds; leave the times out"
    assert said in run(*read).stderr
    assert run(*read, "--times", "none").returncode == 0
    assert (tmp_path / "p.csv").read_text().splitlines()[0] == "lat,lon,agl,yaw"


def test_formats_of_more_fields_than_a_message_holds_are_refused(tmp_path):
    pytest.importorskip("pyulog")
    place = "uint64_t timestamp;double lat;double lon;float alt;a1[1000] y;"
    nested = {"a0": ("float[1000] x;", ""), "a1": ("a0[1000] x;", ""), **TOPICS}
    nested["vehicle_global_position"] = (place, "<Qddf")
    rows = [("vehicle_global_position", 0, us(1.0), 1.0, 2.0, 3.0)]
    with pytest.raises(InvalidInput, match=r"a1 has 1,000,000 fields"):
        read_ulog(ulog(tmp_path / "nest.ulg", rows, nested))
