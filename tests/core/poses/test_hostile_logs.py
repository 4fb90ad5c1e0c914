"""Flight logs that strangers made: however they are nested, damaged or empty, reading them ends with one line.

Each is read by a process of its own, whose memory is bounded, as none of these ended once.
"""

from __future__ import annotations

import struct
import subprocess
import sys

import pytest
from terrainav.core.limits import MAX_LOG_DAMAGE_BYTES, MAX_LOG_DEPTH, MAX_LOG_FIELDS, MAX_LOG_KINDS
from terrainav.core.poses.logs import read_dataflash, read_ulog

from tests.support.logs import FLIGHT, TOPICS, copter, dataflash, flight, ulog
from tests.support.thinning import sampled

resource = pytest.importorskip("resource", reason="Windows bounds no process's memory")
MEMORY_BYTES, PATIENCE_S = 3 << 30, 120
PLACE = "vehicle_global_position"


def message(kind: str, body: bytes, size: int | None = None) -> bytes:
    return struct.pack("<HB", len(body) if size is None else size, ord(kind)) + body


def px4(*messages: bytes) -> bytes:
    return b"ULog\x01\x12\x35\x01" + bytes(8) + message("B", bytes(40)) + b"".join(messages)


def topic(number: int, name: str = PLACE) -> bytes:
    return message("A", struct.pack("<BH", 0, number) + name.encode())


def fields(name: str, columns: str) -> bytes:
    return message("F", f"{name}:{columns}".encode())


def definition(kind: int, length: int, columns: bytes = b"Q", names: bytes = b"TimeUS") -> bytes:
    return b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", kind, length, b"POS", columns, names)


#: Of pyulog, which newer versions of it refuse themselves: they leave the topic out.
HUGE = ("1,000,000,000 fields", f"has no positions ({PLACE})")
WIDE = fields(PLACE, "uint64_t timestamp;uint8_t[60000] x;")
#: What pyulog takes for 1000 and `int` alone reads, and headers that it takes back by a byte before a definition.
PX4 = {
    "underscores": (px4(fields(PLACE, "float[1_000_000_000] x;"), topic(0)), HUGE),
    "a sign": (px4(fields(PLACE, "float[+1000000000] x;"), topic(0)), HUGE),
    "more after the size": (px4(fields(PLACE, "float[1000000000]] x;"), topic(0)), HUGE),
    "behind damage": (
        px4(b"\x20\x4e\0X", bytes(0x4E), fields(PLACE, "float[1000000000] x;"), topic(0), bytes(0x4E20)),
        HUGE,
    ),
    "itself": (px4(fields(PLACE, f"{PLACE} x;"), topic(0)), f"more than {MAX_LOG_DEPTH} deep"),
    "itself many times": (
        px4(fields(PLACE, f"{PLACE}[1000] x;"), topic(0)),
        f"more than {MAX_LOG_DEPTH} deep",
    ),
    "types without fields": (
        px4(fields("a", ""), fields("b", "a x;" * 9000), fields(PLACE, "b x;" * 9000), topic(0)),
        f"{PLACE} has 108,000 fields",
    ),
    "topics": (px4(WIDE, *map(topic, range(60_000))), f"more than {MAX_LOG_FIELDS:,} fields"),
    "topics that are not read": (
        px4(fields("x", "uint8_t[60000] x;"), topic(0, "x") * 60_000),
        f"more than {MAX_LOG_FIELDS:,} fields",
    ),
    "long names": (
        px4(fields("a", "float[1000] x;"), fields(PLACE, f"a[60] {'x' * 60_000};"), topic(0)),
        "more than 255 characters",
    ),
    "definitions": (
        px4(*(fields(f"a{one}", "float x;") for one in range(100_000)), topic(0, "a1")),
        "has no",
    ),
    "nothing in messages": (
        px4(fields(PLACE, "uint64_t timestamp;"), topic(0), b"\0\0D" * 100_000),
        "has no",
    ),
    "zeros": (px4() + bytes(MAX_LOG_DAMAGE_BYTES + 9), "1 MB of it belong to no message"),
    "damage behind a topic": (
        px4(fields(PLACE, "uint64_t timestamp;"), topic(0)) + bytes(MAX_LOG_DAMAGE_BYTES + 9),
        "1 MB of it belong to no message",
    ),
}
BODY = b"\xa3\x95\x01"
ARDUPILOT = {
    "zeros": (bytes(MAX_LOG_DAMAGE_BYTES + 9), "1 MB of it belong to no message"),
    "zeros behind a message": (definition(1, 11) + bytes(MAX_LOG_DAMAGE_BYTES + 9), "1 MB of it"),
    "unknown messages": (definition(1, 11) + b"\xa3\x95\x02" * 600_000, "1 MB of it belong to no message"),
    "no length": (definition(1, 0, b"", b"") + BODY * 20, "messages of kind 1 have 0 bytes"),
    "less than a head": (definition(1, 2) + BODY * 20, "messages of kind 1 have 2 bytes"),
    "definitions without a length": (definition(0x80, 0) * 20, "messages of kind 128 have 0 bytes"),
    # Read as a message by all who go by what is defined at the end.
    "no length within a message": (
        BODY + bytes(94) + definition(2, 200) + b"\xa3\x95\x02" + bytes(40) + definition(2, 0, b"", b"")
        + bytes(65) + definition(1, 140) + b"\xa3\x95\x02" * 40,
        "",
    ),
}  # fmt: skip
WORDS = b"".join(b"%04x\n" % one for one in range(60_000))
TEXT = {
    "words": (
        b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n" + WORDS,
        f"{MAX_LOG_KINDS} words",
    ),
    "lines": (
        b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n" + b"\n" * 1_100_000,
        "1 MB of it",
    ),
}
LOGS = {
    **{f"PX4: {name}": ("a.ulg", *case) for name, case in PX4.items()},
    **{f"ArduPilot: {name}": ("a.bin", *case) for name, case in ARDUPILOT.items()},
    **{f"text: {name}": ("a.log", *case) for name, case in TEXT.items()},
}


def read(path, fast_index: str = "1") -> subprocess.CompletedProcess[str]:
    """Read a log by the command, in a process of its own with little memory."""

    def bounded():
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))

    code = "import sys; from terrainav.core.cli import main; sys.exit(main(sys.argv[1:]))"
    return subprocess.run(
        [sys.executable, "-c", code, "poses", "read", path.name, "--output", "p.csv"],
        check=False, cwd=path.parent, capture_output=True, text=True, timeout=PATIENCE_S, preexec_fn=bounded,
        env={"PYMAVLINK_FAST_INDEX": fast_index, "PATH": "", "TERRAINAV_CONFIG_DIR": str(path.parent), "HOME": "/"},
    )  # fmt: skip


@pytest.mark.parametrize("log", sampled(LOGS, 3))
def test_a_hostile_log_is_refused_in_one_line(tmp_path, log):
    pytest.importorskip("pyulog")
    pytest.importorskip("pymavlink")
    name, body, said = LOGS[log]
    path = tmp_path / name
    path.write_bytes(body)
    # Without and with its module in C pymavlink goes through a binary log in two ways.
    for fast_index in ("0", "1") if name == "a.bin" else ("1",):
        refused = read(path, fast_index)
        assert refused.returncode == 2, refused.stderr
        line = refused.stderr.splitlines()[-1]
        assert any(one in line for one in ((said,) if isinstance(said, str) else said))
        assert "Traceback" not in refused.stderr


@pytest.mark.thorough
def test_a_gigabyte_of_zeros_is_refused(tmp_path):
    pytest.importorskip("pyulog")
    pytest.importorskip("pymavlink")
    for name in ("a.ulg", "a.bin"):
        path = tmp_path / name
        path.write_bytes(px4() if name == "a.ulg" else b"")
        with path.open("r+b") as file:
            file.truncate(10**9)
        refused = read(path)
        assert refused.returncode == 2
        assert "1 MB of it belong to no message" in refused.stderr.splitlines()[-1]


def test_logs_with_some_damage_are_read(tmp_path):
    pytest.importorskip("pyulog")
    pytest.importorskip("pymavlink")
    path = ulog(tmp_path / "flight.ulg", list(flight(FLIGHT)), {**TOPICS, "other": ("uint8_t[500] x;", "")})
    path.write_bytes(path.read_bytes() + bytes(5000))
    assert len(read_ulog(path)) == 3
    path = dataflash(tmp_path / "log.bin", copter())
    data = path.read_bytes()
    path.write_bytes(data + bytes(5000) + data)
    assert len(read_dataflash(path)) == 6
