"""Flight logs of PX4 and ArduPilot, written from their formats' descriptions."""

from __future__ import annotations

import math
import struct

#: Topics of PX4 as its logs declare them; padding at the end of a message is in its format, and not in its data.
TOPICS = {
    "vehicle_global_position": (
        "uint64_t timestamp;double lat;double lon;float alt;uint8_t[4] _padding0;",
        "<Qddf",
    ),
    "vehicle_attitude": ("uint64_t timestamp;float[4] q;", "<Q4f"),
    "home_position": ("uint64_t timestamp;float alt;bool valid_alt;uint8_t[3] _padding0;", "<Qf?"),
    "vehicle_gps_position": ("uint64_t timestamp;uint64_t time_utc_usec;", "<QQ"),
    "sensor_gps": ("uint64_t timestamp;uint64_t time_utc_usec;", "<QQ"),
}
LEVEL = (1.0, 0.0, 0.0, 0.0)
#: Quaternion, w first, of an aircraft that heads east with its nose 10 degrees up: yaw, then pitch.
EAST_UP = (
    math.cos(math.pi / 4) * math.cos(math.radians(5)),
    -math.sin(math.pi / 4) * math.sin(math.radians(5)),
    math.cos(math.pi / 4) * math.sin(math.radians(5)),
    math.sin(math.pi / 4) * math.cos(math.radians(5)),
)


def us(seconds):
    return round(seconds * 1e6)


def ulog(path, rows, topics=TOPICS):
    """PX4 log of rows (topic, instance, values), as docs.px4.io describes ULog."""
    out = [b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)]

    def message(kind, body):
        out.append(struct.pack("<HB", len(body), ord(kind)) + body)

    message("B", bytes(40))
    for name, (columns, _) in topics.items():
        message("F", f"{name}:{columns}".encode())
    subscriptions = sorted({row[:2] for row in rows}, reverse=True)
    for number, (name, instance) in enumerate(subscriptions):
        message("A", struct.pack("<BH", instance, number) + name.encode())
    for name, instance, *values in rows:
        number = subscriptions.index((name, instance))
        message("D", struct.pack("<H", number) + struct.pack(topics[name][1], *values))
    path.write_bytes(b"".join(out))
    return path


def flight(rows):
    """Rows of a log of (seconds, lat, lon, alt, quaternion)."""
    for seconds, lat, lon, alt, quaternion in rows:
        yield ("vehicle_attitude", 0, us(seconds), *quaternion)
        yield ("vehicle_global_position", 0, us(seconds), lat, lon, alt)


FLIGHT = [
    (1.0, 47.3, 8.5, 488.0, LEVEL),
    (2.0, 47.3001, 8.5, 588.0, LEVEL),
    (3.5, 47.3001, 8.5002, 590.0, EAST_UP),
]


#: Messages of ArduPilot: format, columns and packing.
MESSAGES = {
    "FMT": ("BBnNZ", "Type,Length,Name,Format,Columns", "<BB4s16s64s"),
    "POS": ("QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt", "<Qiifff"),
    "ATT": ("QfffBB", "TimeUS,Roll,Pitch,Yaw,AEKF,I", "<QfffBB"),
    "AHR2": ("QccCfLL", "TimeUS,Roll,Pitch,Yaw,Alt,Lat,Lng", "<QhhHfii"),
    "GPS": ("QBBIHLLf", "TimeUS,I,Status,GMS,GWk,Lat,Lng,Alt", "<QBBIHiif"),
}


def dataflash(path, rows):
    """ArduPilot log of rows (message, values), by the description of its message FMT."""
    kinds = {name: number for number, name in enumerate(MESSAGES, 128)}
    out = []

    def message(name, *values):
        out.append(bytes([0xA3, 0x95, kinds[name]]) + struct.pack(MESSAGES[name][2], *values))

    for name, (form, columns, packing) in MESSAGES.items():
        length = 3 + struct.calcsize(packing)
        message("FMT", kinds[name], length, name.encode(), form.encode(), columns.encode())
    for row in rows:
        message(*row)
    path.write_bytes(b"".join(out))
    return path


def e7(degrees):
    return round(degrees * 1e7)


def gps(seconds, week, week_s, lat=0.0, lng=0.0, alt=0.0, *, status=3, instance=0):
    return (
        *("GPS", us(seconds), instance, status, round(week_s * 1e3), week),
        *(e7(lat), e7(lng), alt),
    )


#: Seconds, place, height, height above home, roll, pitch and yaw.
COPTER = [
    (1.0, -35.36, 149.16, 584.0, 0.0, 0.0, 0.0, 0.0),
    (2.0, -35.3601, 149.16, 684.0, 100.0, 5.0, -3.0, 200.0),
    (3.0, -35.3602, 149.16, 685.0, 101.0, 0.0, 10.0, 90.0),
]


def copter():
    for seconds, lat, lng, alt, above, roll, pitch, yaw in COPTER:
        yield gps(seconds, 2300, 345_600.0 + seconds, lat, lng, alt)
        yield ("ATT", us(seconds), roll, pitch, yaw, 3, 0)
        yield ("POS", us(seconds), e7(lat), e7(lng), alt, above, above)
